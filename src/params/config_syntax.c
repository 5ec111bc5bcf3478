/* What libconfig's bare "syntax error" leaves out: the token where the text stops to be a parameter file, and
 * what is expected there. The grammar is that of libconfig's manual. */
#include <ctype.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

#include "params/config.h"

enum { MOST_LEVELS = 32 };
typedef enum { KEY, EQUALS, VALUE, AFTER } state;

typedef struct {
    const char *at; /* the token; its first byte is 0 at the end of the file */
    int length, line;
    char before;       /* first byte of the token before it */
    bool open_comment; /* a comment in the last line without its end */
    state state;
    size_t level;
    struct {
        char close;
        int line;
    } open[MOST_LEVELS]; /* open[0]: the file itself, close 0 */
} parser;

static void next_token(parser *p)
{
    p->before = *p->at;
    for (p->at += p->length; *p->at; p->at += p->length) {
        p->length = (int)(rp_config_token_end(p->at) - p->at);
        const bool gap = strchr(" \t\r\f\n#", *p->at) || !strncmp(p->at, "//", 2) || !strncmp(p->at, "/*", 2);
        if (!gap && *p->at != '@') return;
        if (*p->at == '@') p->length = (int)strcspn(p->at, "\n"); /* @include "FILE" */
        p->open_comment = (*p->at == '#' || !strncmp(p->at, "//", 2)) && !p->at[p->length];
        for (int i = 0; i < p->length; i++) p->line += p->at[i] == '\n';
    }
    p->length = 0;
}

static bool is_name(const parser *p)
{
    return isalpha((unsigned char)*p->at) || *p->at == '*';
}

static bool is_scalar(const parser *p)
{
    const bool word = (p->length == 4 && !strncasecmp(p->at, "true", 4)) ||
                      (p->length == 5 && !strncasecmp(p->at, "false", 5));
    return word || *p->at == '"' || isdigit((unsigned char)*p->at) ||
           (*p->at && strchr("+-.", *p->at) && p->length > 1);
}

/* Into a group, list or array, and out of it. */
static bool enter(parser *p)
{
    static const char opening[] = "{[(", closing[] = "}])";
    const char *kind = *p->at ? strchr(opening, *p->at) : NULL;
    if (!kind || p->level + 1 == MOST_LEVELS || p->open[p->level].close == ']') return false;
    p->level++;
    p->open[p->level].close = closing[kind - opening];
    p->open[p->level].line = p->line;
    p->state = *kind == '{' ? KEY : VALUE;
    return true;
}

static bool leave(parser *p)
{
    if (!*p->at || *p->at != p->open[p->level].close) return false;
    p->level--;
    p->state = AFTER;
    return true;
}

static bool go(parser *p, bool fits, state next)
{
    if (fits) p->state = next;
    return fits;
}

/* Does the token fit? */
static bool take(parser *p)
{
    const char c = *p->at, close = p->open[p->level].close;
    const bool in_group = !close || close == '}';
    switch (p->state) {
    case KEY: return go(p, is_name(p), EQUALS) || leave(p);
    case EQUALS: return go(p, c == '=' || c == ':', VALUE);
    case VALUE: return go(p, is_scalar(p), AFTER) || enter(p) || (!in_group && p->before != ',' && leave(p));
    case AFTER:
        if (c == '"' && p->before == '"') return true; /* parts of one text */
        if (in_group) return go(p, c == ';' || c == ',', KEY) || go(p, is_name(p), EQUALS) || leave(p);
        return go(p, c == ',', VALUE) || leave(p);
    }
    return false;
}

static void expected(const parser *p, char *text, size_t size)
{
    const char close = p->open[p->level].close;
    const bool inside = close != '\0', comma = p->before == ',' && isdigit((unsigned char)*p->at);
    char end[64] = "";
    if (inside && (p->state == KEY || p->state == AFTER))
        snprintf(end, sizeof end, " or \"%c\" for line %d", close, p->open[p->level].line);
    switch (p->state) {
    case KEY:
        snprintf(text, size, "a key%s expected%s", end,
                 comma ? "; decimal numbers have a point, no comma" : "");
        break;
    case EQUALS: snprintf(text, size, "\"=\" expected after a key"); break;
    case VALUE:
        snprintf(text, size, "a value expected%s%s", is_name(p) ? "; words stand in quotes" : "",
                 close == ']' && *p->at && strchr("{[(", *p->at) ? "; lists of lists or groups are in ( )"
                                                                 : "");
        break;
    case AFTER:
        snprintf(text, size, "%s%s expected", close && close != '}' ? "\",\"" : "\";\", a key", end);
        break;
    }
}

/* Texts and comments have their ends: rp_config_scan_file has seen to it. */
bool rp_config_syntax(const char *file, char *message, size_t size)
{
    char wanted[160] = "";
    parser p = {.at = file, .line = 1};
    for (next_token(&p);; next_token(&p)) {
        if (!*p.at && !p.level && (p.state == KEY || p.state == AFTER)) break;
        if (!take(&p)) {
            expected(&p, wanted, sizeof wanted);
            break;
        }
    }
    if (p.open_comment && !*wanted)
        snprintf(wanted, sizeof wanted, "an end of line expected after the comment");
    if (!*wanted) return false;
    if (*p.at)
        snprintf(message, size, "at \"%.*s\": %s", p.length < 40 ? p.length : 40, p.at, wanted);
    else
        snprintf(message, size, "at the end of the file: %s", wanted);
    return true;
}
