/* What libconfig 1.5 does not refuse by itself, found in the text before libconfig reads it: whole numbers
 * that do not fit an int, which it lets wrap, texts and comments without an end, which take the rest of the
 * file, other files that it would include, and sizes for which its time grows with the square. The tokens are
 * those of libconfig's scanner. */
#include <ctype.h>
#include <errno.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "core/file.h"
#include "params/config.h"

/* libconfig looks for twins of a key in its whole group, and goes back to a token's start at every 8 kB. */
enum { MOST_BYTES = 64 << 20, MOST_IN_TOKEN = 65536, MOST_KEYS = 1000, MOST_LEVELS = 32 };

typedef struct {
    size_t level, keys[MOST_LEVELS];
} scan;

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

/* End of a gap, comment, text, number, name or other character; NULL for a text or comment without end. */
static const char *token_end(const char *p, bool *fits)
{
    const char *end;
    if (strchr(" \t\r\f", *p)) return p + strspn(p, " \t\r\f");
    if (*p == '#' || strncmp(p, "//", 2) == 0) return strchr(p, '\n');
    if (strncmp(p, "/*", 2) == 0) return (end = strstr(p + 2, "*/")) ? end + 2 : NULL;
    if (*p == '"') {
        for (p++; *p && *p != '"'; p++) p += *p == '\\' && p[1];
        return *p ? p + 1 : NULL;
    }
    const size_t sign = *p == '+' || *p == '-';
    if (isdigit((unsigned char)p[sign]) || p[sign] == '.') return number_end(p, fits);
    if (!isalpha((unsigned char)*p) && *p != '*') return p + 1;
    while (isalnum((unsigned char)*p) || (*p && strchr("-_*", *p))) p++;
    return p;
}

/* Groups, lists and the number of keys in each. */
static rp_status count(scan *s, char c)
{
    if (strchr("{[(", c)) {
        if (++s->level == MOST_LEVELS)
            return rp_fail(RP_BAD_INPUT, "more than %d groups and lists within one another", MOST_LEVELS - 1);
        s->keys[s->level] = 0;
    } else if (strchr("}])", c)) {
        s->level -= s->level > 0;
    } else if ((c == '=' || c == ':') && ++s->keys[s->level] > MOST_KEYS) {
        return rp_fail(RP_BAD_INPUT, "more than %d keys in one group", MOST_KEYS);
    }
    return RP_OK;
}

static rp_status scan_token(scan *s, const char *text, const char **p)
{
    bool fits = true;
    const char *start = *p;
    if ((start == text || start[-1] == '\n') && strncmp(start + strspn(start, " \t"), "@include", 8) == 0)
        return rp_fail(RP_BAD_INPUT, "@include: a file must be whole in itself");
    *p = token_end(start, &fits);
    if ((*p ? *p : start + strlen(start)) - start > MOST_IN_TOKEN)
        return rp_fail(RP_BAD_INPUT, "a text, comment, gap, name or number of more than %d bytes",
                       MOST_IN_TOKEN);
    if (!*p)
        return rp_fail(RP_BAD_INPUT, "a %s",
                       *start == '"'                  ? "text without its closing quote"
                       : strncmp(start, "/*", 2) == 0 ? "comment without */"
                                                      : "comment without the end of its line");
    const int shown = *p - start < 40 ? (int)(*p - start) : 40;
    return fits ? count(s, *start)
                : rp_fail(RP_BAD_INPUT, "%.*s: whole numbers go up to %d; write %.*s.0 for a larger number",
                          shown, start, INT_MAX, shown, start);
}

/* Numbers from the first line on, or from the second, below their names; comments aside. */
static bool is_table(const char *p)
{
    for (int lines = 0; lines < 2;) {
        p += strspn(p, " \t\r\n\"");
        const size_t n = strcspn(p, "\n");
        if (*p != '#') {
            lines++;
            if (strcspn(p, "={:*") < n) return false;
            if (isdigit((unsigned char)p[strspn(p, "+-.")])) return true;
        }
        p += n;
    }
    return false;
}

rp_status rp_config_scan_text(const char *name, const char *text)
{
    scan s = {0};
    int line = 1;
    const bool marked = strncmp(text, "\xef\xbb\xbf", 3) == 0;
    if (is_table(text + 3 * marked))
        return rp_fail(
            RP_BAD_INPUT,
            "%s: is a table of numbers; a scene, experiment or sweep is a text of parameters, key = "
            "value, as `repose params scene` lists them; a scene reads its grains from a table with "
            "particles_file = \"%s\";",
            name, name);
    if (marked)
        return rp_fail(RP_BAD_INPUT, "%s:1: begins with a byte-order mark; save it as UTF-8 without one",
                       name);
    for (const char *p = text; *p;) {
        const char *start = p;
        RP_TRY(rp_prefix(scan_token(&s, text, &p), "%s:%d: ", name, line));
        for (; start < p; start++) line += *start == '\n';
    }
    return RP_OK;
}

rp_status rp_config_scan_file(const char *path)
{
    struct stat info;
    char *text = NULL;
    const bool known = stat(path, &info) == 0;
    if (known && !S_ISREG(info.st_mode))
        return rp_fail(RP_BAD_INPUT, "%s: %s, a parameter file expected", path,
                       S_ISDIR(info.st_mode) ? "is a directory" : "is no regular file");
    if (known && info.st_size > MOST_BYTES)
        return rp_fail(RP_BAD_INPUT, "%s: more than %d MB", path, MOST_BYTES >> 20);
    rp_status status = rp_file_read(path, &text);
    if (!status) status = rp_config_scan_text(path, text);
    free(text);
    return status;
}
