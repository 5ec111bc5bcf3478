/* What the checks of check.h print of a failure. */
#include "tests/check.h"

#include <stdarg.h>

const char *check_text(const char *format, ...)
{
    static char *texts[1024];
    static unsigned next;
    char **text = &texts[next++ % (sizeof texts / sizeof *texts)];
    va_list args;
    free(*text);
    va_start(args, format);
    CU_ASSERT_FATAL(vasprintf(text, format, args) >= 0);
    va_end(args);
    return *text;
}

const char *check_changed(const char *text, const char *from, const char *to)
{
    const char *at = strstr(text, from);
    CU_ASSERT_PTR_NOT_NULL_FATAL(at);
    return check_text("%.*s%s%s", (int)(at - text), text, to, at + strlen(from));
}

bool check_near(const char *file, int line, const char *what, double a, double b, double tolerance)
{
    const bool near = fabs(a - b) <= tolerance;
    if (!near)
        fprintf(stderr, "%s:%d: %s = %.17g, expected %.17g within %g\n", file, line, what, a, b, tolerance);
    return near;
}

void check_pairs(const char *file, int line, const char *rows, double tolerance, size_t n,
                 const double pairs[][2])
{
    for (size_t k = 0; k < n; k++)
        CHECK_OR_SAY(fabs(pairs[k][0] - pairs[k][1]) <= tolerance,
                     "%s:%d: row %zu of %s = %.17g, expected %.17g within %g", file, line, k + 1, rows,
                     pairs[k][0], pairs[k][1], tolerance);
}

bool check_status(const char *file, int line, const char *call, rp_status got, rp_status expected,
                  const char *text)
{
    const bool right = got == expected && strstr(rp_message(), text) != NULL;
    if (!right)
        fprintf(stderr, "%s:%d: %s: status %d, message \"%s\"; expected %d, \"%s\"\n", file, line, call,
                (int)got, rp_message(), (int)expected, text);
    return right;
}
