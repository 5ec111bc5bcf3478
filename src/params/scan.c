/* What libconfig 1.5 does not refuse by itself, found in the text before libconfig reads it: whole numbers
 * that do not fit an int, which it lets wrap, texts and comments without an end, which take the rest of the
 * file, and sizes for which its time grows with the square. The tokens are those of libconfig's scanner,
 * included files as well. */
#include <ctype.h>
#include <errno.h>
#include <limits.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "core/file.h"
#include "params/config.h"

/* libconfig looks for twins of a key in its whole group, and goes back to the start of a token at every 8 kB.
 */
enum { MOST_BYTES = 64 << 20, MOST_IN_TOKEN = 65536, MOST_KEYS = 1000, MOST_LEVELS = 32, MOST_FILES = 10 };

typedef struct {
    const char *folder; /* of included files; NULL: the current one */
    size_t bytes;       /* read so far */
    int files;          /* open: the first, and those that include one another */
    size_t level, keys[MOST_LEVELS];
} scan;

static rp_status scan_file(scan *s, const char *path);

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

/* End of a gap, comment, text, number, name or other character; NULL for a text or comment without its end.
 */
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

/* Beginning of the name in `@include "name"` at the start of a line, or NULL. */
static const char *included(const char *p)
{
    p += strspn(p, " \t");
    if (strncmp(p, "@include", 8) != 0) return NULL;
    const size_t gap = strspn(p + 8, " \t");
    return gap && p[8 + gap] == '"' ? p + 8 + gap + 1 : NULL;
}

static rp_status scan_included(scan *s, const char *name, const char **end)
{
    char path[PATH_MAX];
    const size_t length = strcspn(name, "\"\\");
    if (name[length] != '"') return rp_fail(RP_BAD_INPUT, "@include: a plain name in quotes expected");
    if (s->files == MOST_FILES)
        return rp_fail(RP_BAD_INPUT, "@include: more than %d files within one another", MOST_FILES);
    *end = name + length + 1;
    snprintf(path, sizeof path, "%s%s%.*s", s->folder ? s->folder : "", s->folder ? "/" : "", (int)length,
             name);
    return scan_file(s, path);
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
    const char *start = *p, *name = start == text || start[-1] == '\n' ? included(start) : NULL;
    if (name) return scan_included(s, name, p);
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

static rp_status scan_text(scan *s, const char *name, const char *text)
{
    int line = 1;
    for (const char *p = text; *p;) {
        const char *start = p;
        RP_TRY(rp_prefix(scan_token(s, text, &p), "%s:%d: ", name, line));
        for (; start < p; start++) line += *start == '\n';
    }
    return RP_OK;
}

static rp_status scan_file(scan *s, const char *path)
{
    struct stat info;
    char *text = NULL;
    const bool known = stat(path, &info) == 0;
    if (known && !S_ISREG(info.st_mode))
        return rp_fail(RP_BAD_INPUT, "%s: %s, a parameter file expected", path,
                       S_ISDIR(info.st_mode) ? "is a directory" : "is no regular file");
    if (known && info.st_size > (off_t)(MOST_BYTES - s->bytes))
        return rp_fail(RP_BAD_INPUT, "%s: more than %d MB", path, MOST_BYTES >> 20);
    rp_status status = rp_file_read(path, &text);
    if (!status) {
        s->bytes += strlen(text);
        s->files++;
        status = scan_text(s, path, text);
        s->files--;
    }
    free(text);
    return status;
}

rp_status rp_config_scan_file(const char *path, const char *folder)
{
    return scan_file(&(scan){.folder = folder}, path);
}

rp_status rp_config_scan_text(const char *name, const char *text)
{
    return scan_text(&(scan){0}, name, text);
}
