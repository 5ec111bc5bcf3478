/* What the checks of check.h print of a failure. */
#include "tests/check.h"

#include <stdarg.h>

const char *check_text(const char *format, ...)
{
    static char texts[16][4096];
    static unsigned next;
    char *text = texts[next++ % 16];
    va_list args;
    va_start(args, format);
    const int length = vsnprintf(text, sizeof *texts, format, args);
    va_end(args);
    CU_ASSERT_FATAL(length >= 0 && (size_t)length < sizeof *texts);
    return text;
}

void check_all_near(const char *file, int line, const char *rows, double tolerance, size_t n,
                    const double pairs[][2])
{
    for (size_t k = 0; k < n; k++) {
        const bool near = fabs(pairs[k][0] - pairs[k][1]) <= tolerance;
        if (!near)
            fprintf(stderr, "%s:%d: row %zu of %s: %.17g, expected %.17g within %g\n", file, line, k + 1,
                    rows, pairs[k][0], pairs[k][1], tolerance);
        CU_ASSERT(near);
    }
}
