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

#include "params/config.h"
#include "table/table.h"

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

/* End of the number at `p`, or `p` if there is none. */
static const char *number_end(const char *p, bool *whole, bool *fits)
{
    const size_t sign = *p == '+' || *p == '-';
    const bool hexadecimal = p[0] == '0' && (p[1] == 'x' || p[1] == 'X') && isxdigit((unsigned char)p[2]);
    char *end, *real_end;
    if (!isdigit((unsigned char)p[sign]) && p[sign] != '.') return p;
    errno = 0;
    const long long value = strtoll(p, &end, hexadecimal ? 16 : 10);
    *fits = errno == 0 && (*end == 'L' || (value >= INT_MIN && value <= INT_MAX));
    strtod(p, &real_end);
    *whole = hexadecimal || real_end == end;
    if (!*whole) return real_end;
    return end + strspn(end, "L");
}

static const char *text_end(const char *p)
{
    for (p++; *p && *p != '"'; p++)
        if (*p == '\\' && p[1]) p++;
    return *p ? p + 1 : p;
}

/* End of a gap, comment, text, name or other character. */
static const char *token_end(const char *p)
{
    const char *end;
    if (strchr(" \t\r\f", *p)) return p + strspn(p, " \t\r\f");
    if (*p == '#' || strncmp(p, "//", 2) == 0) return p + strcspn(p, "\n");
    if (strncmp(p, "/*", 2) == 0) return (end = strstr(p + 2, "*/")) ? end + 2 : p + strlen(p);
    if (*p == '"') return text_end(p);
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

const char *rp_config_token_end(const char *p)
{
    bool whole, fits;
    const char *end = number_end(p, &whole, &fits);
    return end == p ? token_end(p) : end;
}

static rp_status scan_included(scan *s, const char *name, size_t length)
{
    char path[PATH_MAX];
    if (name[length] != '"') return rp_fail(RP_BAD_INPUT, "@include: a plain name in quotes expected");
    if (s->files == MOST_FILES)
        return rp_fail(RP_BAD_INPUT, "@include: more than %d files within one another", MOST_FILES);
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

/* Does a text or comment have its end? libconfig takes the rest of the file for its content, and is silent.
 */
static bool is_closed(const char *start, const char *end)
{
    if (*start == '"') {
        while (++start < end && *start != '"') start += *start == '\\';
        return start < end;
    }
    return strncmp(start, "/*", 2) != 0 || (end - start > 3 && end[-2] == '*' && end[-1] == '/');
}

static rp_status scan_token(scan *s, const char *text, const char **p)
{
    bool whole = false, fits = true;
    const char *start = *p, *name = start == text || start[-1] == '\n' ? included(start) : NULL;
    if (name) {
        const size_t length = strcspn(name, "\"\\");
        *p = name + length + (name[length] == '"');
        return scan_included(s, name, length);
    }
    *p = number_end(start, &whole, &fits);
    if (*p == start) *p = token_end(start);
    if (*p - start > MOST_IN_TOKEN)
        return rp_fail(RP_BAD_INPUT, "a text, comment, gap, name or number of more than %d bytes",
                       MOST_IN_TOKEN);
    if (!is_closed(start, *p))
        return rp_fail(RP_BAD_INPUT, "a %s",
                       *start == '"' ? "text without its closing quote" : "comment without */");
    if (!whole || fits) return whole ? RP_OK : count(s, *start);
    const int shown = (int)(*p - start) < 40 ? (int)(*p - start) : 40;
    return rp_fail(RP_BAD_INPUT, "%.*s: whole numbers go up to %d; write %.*s.0 for a larger number", shown,
                   start, INT_MAX, shown, start);
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
