/* What libconfig 1.5 reads otherwise than it stands, found in the text before: whole numbers that do not fit
 * an int, which it lets wrap, a comment without its end, which takes the rest of the file, and other files,
 * which a text that is kept would lack. */
#include <ctype.h>
#include <errno.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>

#include "params/config.h"

/* End of a number. *fits: is it no whole number above an int, or with an L above a long long? */
static const char *number_end(const char *p, bool *fits)
{
    const bool hexadecimal = p[0] == '0' && (p[1] == 'x' || p[1] == 'X') && isxdigit((unsigned char)p[2]);
    char *end, *real_end;
    errno = 0;
    const long long value = strtoll(p, &end, hexadecimal ? 16 : 10);
    *fits = errno == 0 && (*end == 'L' || (value >= INT_MIN && value <= INT_MAX));
    strtod(p, &real_end);
    if (real_end == p) return p + 1; /* a point alone */
    if (hexadecimal || real_end == end) return end + strspn(end, "L");
    *fits = true;
    return real_end;
}

/* End of a comment, text, number, name or other character, the tokens of libconfig; NULL for a comment
 * without end. */
static const char *token_end(const char *p, bool *fits)
{
    const char *end;
    if (*p == '#' || strncmp(p, "//", 2) == 0) return p + strcspn(p, "\n");
    if (strncmp(p, "/*", 2) == 0) return (end = strstr(p + 2, "*/")) ? end + 2 : NULL;
    if (*p == '"') {
        for (p++; *p && *p != '"'; p++) p += *p == '\\' && p[1];
        return p + (*p == '"');
    }
    const size_t sign = *p == '+' || *p == '-';
    if (isdigit((unsigned char)p[sign]) || p[sign] == '.') return number_end(p, fits);
    if (!isalpha((unsigned char)*p) && *p != '*') return p + 1;
    while (isalnum((unsigned char)*p) || (*p && strchr("-_*", *p))) p++;
    return p;
}

rp_status rp_config_scan(const char *name, const char *text)
{
    int line = 1;
    for (const char *p = text, *end; *p; p = end) {
        bool fits = true;
        if ((p == text || p[-1] == '\n') && strncmp(p + strspn(p, " \t"), "@include", 8) == 0)
            return rp_fail(RP_BAD_INPUT, "%s:%d: @include: a file must be whole in itself", name, line);
        end = token_end(p, &fits);
        if (!end) return rp_fail(RP_BAD_INPUT, "%s:%d: a comment without */", name, line);
        const int shown = end - p < 40 ? (int)(end - p) : 40;
        if (!fits)
            return rp_fail(RP_BAD_INPUT,
                           "%s:%d: %.*s: whole numbers go up to %d; write %.*s.0 for a larger number", name,
                           line, shown, p, INT_MAX, shown, p);
        for (const char *c = p; c < end; c++) line += *c == '\n';
    }
    return RP_OK;
}
