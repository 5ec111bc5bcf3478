/* Lists the mutants of C files, for tests/mutate.sh: one sign, factor, index or comparison changed at a time.
 *
 *   mutants EXCEPTIONS SEED FILE ...    a row each: file, line, kind, original, mutant, and the outcome if it
 * survives: "equivalent" if EXCEPTIONS has it, else "survived"
 *
 * The rows come in the order in which to try them: by turns from each kind in each file, within these at
 * random, by their text and the seed. Status 2: a line of EXCEPTIONS is no mutant, or a file cannot be read.
 *
 * A comparison is turned round; with a whole number its limit is let in or out too, which among measured
 * numbers changes nothing. Of what writes and reads results two neighbours of a list change places, the words
 * of a choice, the sense of a query; of a figure a column becomes another, within `using`. Left alone:
 * comments, strings, help, messages of errors, the preprocessor, enumerations, named constants, sizes of
 * memory and what follows where it is short. Binary operators are known by the blanks that the format puts
 * around them. */
#include <ctype.h>
#include <regex.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define TYPE     "(double|size_t|long|int|bool|char|num|lanes|[a-z]+_[a-z_]+)"
#define DECLARES "^([a-z]| *(static |const )*" TYPE " [*]?(const )?[][A-Za-z0-9_, ]+\\[)"
/* a line of a command's help */
#define HELP "^ *\".*[\\]n\"|^ *([.][a-z]+ = )?\".* (a|of|the|with|and|or|is|are|in|by|needs) "
#define LEAVE                                                                                                \
    "alloc\\(|_memory\\(|RP_NEW\\(|no_memory\\(|(capacity|room) = |[+][+]\\) "                               \
    "[a-z_]*free[a-z_]*\\(|madvise\\(|RP_NO_MEMORY|static_assert|"                                           \
    "if \\((![a-z_>-]+ \\|\\| )+![a-z_>-]+\\)"

typedef struct {
    char *file, *original, *mutant;
    const char *kind;
    size_t line, twin; /* number among the equal lines of the file */
    uint64_t random;
    size_t turn;
    bool excepted;
} entry;

static struct {
    entry *all;
    size_t n, capacity;
    uint64_t seed;
} list;

/* A line: as it is, and with what is not to change blanked, all else in its place. */
static struct {
    char *file, text[4096], code[4096];
    size_t number, twin;
    bool in_comment, in_message, in_definition, in_directive, is_loop;
    bool is_figure, is_result; /* of the file: gnuplot's; code that writes or reads results */
    char quote;
} at_line;

static void *checked(void *memory)
{
    if (memory) return memory;
    fprintf(stderr, "mutants: out of memory\n");
    exit(2);
}

static char *trimmed(const char *text)
{
    const size_t from = strspn(text, " ");
    size_t to = strlen(text);
    while (to > from && text[to - 1] == ' ') to--;
    return checked(strndup(text + from, to - from));
}

static bool matches(const char *pattern, const char *text, regmatch_t *where)
{
    enum { MOST = 32 };
    static const char *patterns[MOST];
    static regex_t compiled[MOST];
    size_t i = 0;
    while (i < MOST && patterns[i] && patterns[i] != pattern) i++;
    if (i == MOST || (!patterns[i] && regcomp(&compiled[i], pattern, REG_EXTENDED) != 0)) {
        fprintf(stderr, "mutants: bad expression: %s\n", pattern);
        exit(2);
    }
    patterns[i] = pattern;
    return regexec(&compiled[i], text, where ? 1 : 0, where, 0) == 0;
}

/* FNV-1a, mixed. */
static uint64_t random_of(const char *text, uint64_t h)
{
    while (*text) h = (h ^ (unsigned char)*text++) * UINT64_C(0x100000001b3);
    h = (h ^ h >> 33) * UINT64_C(0xff51afd7ed558ccd);
    return h ^ h >> 33;
}

/* Offer the line with `len` characters from `from` replaced. */
static void offer(const char *kind, size_t from, size_t len, const char *with)
{
    char text[sizeof at_line.text + 64];
    snprintf(text, sizeof text, "%.*s%s%s", (int)from, at_line.text, with, at_line.text + from + len);
    if (strcmp(text, at_line.text) == 0) return;
    if (list.n == list.capacity)
        list.all = checked(realloc(list.all, (list.capacity = 2 * list.capacity + 64) * sizeof *list.all));
    list.all[list.n++] = (entry){
        .file = at_line.file,
        .line = at_line.number,
        .twin = at_line.twin,
        .kind = kind,
        .original = trimmed(at_line.text),
        .mutant = trimmed(text),
        .random = random_of(text, random_of(at_line.file, from + (at_line.twin << 16) + (list.seed << 32)))};
}

static void change_operator(size_t from, size_t len)
{
    static const char *const pairs[][3] = {{"+", "-", "sign"},         {"+=", "-=", "sign"},
                                           {"*", "/", "factor"},       {"*=", "/=", "factor"},
                                           {"<", ">=", "comparison"},  {">", "<=", "comparison"},
                                           {"==", "!=", "comparison"}, {"&&", "||", "comparison"}};
    const char *word = at_line.code + from + 1;
    size_t before = from; /* a size of memory, as in `sizeof text - used`, is no number of the model */
    while (before > 0 &&
           (isalnum((unsigned char)at_line.code[before - 1]) || strchr("_.>-*", at_line.code[before - 1])))
        before--;
    if (before >= 7 && strncmp(at_line.code + before - 7, "sizeof ", 7) == 0) return;
    if (strstr(at_line.text, "snprintf(") && strstr(word, "used") == word + 2) return;
    if (at_line.is_loop && strchr("<>", *word)) return; /* past the end is what the sanitizers are for */
    for (size_t i = 0; i < sizeof pairs / sizeof *pairs; i++)
        for (size_t k = 0; k < 2; k++)
            if (strlen(pairs[i][k]) == len - 2 && strncmp(word, pairs[i][k], len - 2) == 0)
                offer(pairs[i][2], from + 1, len - 2, pairs[i][1 - k]);
}

static void end_early(size_t from, size_t len)
{
    if (strncmp(at_line.code + from, "used", 4) != 0) /* of a text's memory */
        offer("index", from + len - 3, 3, " + 1 < ");
}

static void start_late(size_t from, size_t len)
{
    offer("index", from + len - 2, 1, "1");
}

static void move_limit(size_t from, size_t len)
{
    (void)len;
    const char *word = at_line.code + from + 1;
    const bool is_in = word[1] == '=';
    offer("comparison", from + 1, is_in ? 2 : 1, (char[]){word[0], is_in ? 0 : '=', 0});
}

static void count_back(size_t from, size_t len)
{
    (void)len;
    offer("sign", from + 1, 2, at_line.code[from + 1] == '+' ? "--" : "++");
}

static void drop_minus(size_t from, size_t len)
{
    offer("sign", from + len - 2, 1, "");
}

/* A whole number plus 1; any other times 1.2. */
static void change_number(size_t from, size_t len)
{
    if (at_line.is_loop && from > 0 && at_line.code[from - 1] == '<') return;
    while (!isdigit((unsigned char)at_line.code[from])) from++, len--;
    const size_t n = strspn(at_line.code + from, "0123456789.");
    const bool has_point = memchr(at_line.code + from, '.', n) != NULL;
    const double old = strtod(at_line.code + from, NULL);
    const double new = old == (double)(long)old ? old + 1 : 1.2 * old;
    char text[32];
    snprintf(text, sizeof text, has_point && new == (double)(long)new ? "%.1f" : "%.15g", new);
    offer("factor", from, n, text);
}

static void change_index(size_t from, size_t len)
{
    const char *word = at_line.code + from + 1;
    char text[256];
    if (strspn(word, "0123456789") == len - 2)
        snprintf(text, sizeof text, "%ld", strtol(word, NULL, 10) > 0 ? strtol(word, NULL, 10) - 1 : 1);
    else
        snprintf(text, sizeof text, "%.*s + 1", (int)len - 2, word);
    offer("index", from + 1, len - 2, text);
}

/* The two items "A, B" change places. */
static void change_order(size_t from, size_t len)
{
    const char *a = at_line.text + from + 1, *end = at_line.text + from + len - 1;
    const char *comma = strstr(a, ", ");
    static const char *const symmetric[] = {"strcmp", "strncmp", "fmax", "fmin", "hypot"};
    char text[512];
    if (!comma || comma >= end) return;
    for (size_t i = 0; i < sizeof symmetric / sizeof *symmetric; i++) {
        const size_t n = strlen(symmetric[i]);
        if (from >= n && strncmp(at_line.text + from - n, symmetric[i], n) == 0) return;
    }
    const int n_a = (int)(comma - a), n_b = (int)(end - comma) - 2;
    if (n_a == n_b && strncmp(a, comma + 2, (size_t)n_a) == 0) return;
    snprintf(text, sizeof text, "%.*s, %.*s", n_b, comma + 2, n_a, a);
    offer("order", from + 1, len - 2, text);
}

/* The words "A" : "B" of a choice change places. */
static void change_words(size_t from, size_t len)
{
    const char *a = at_line.text + from, *colon = strstr(a, " : ");
    char text[512];
    const int n_a = (int)(colon - a), n_b = (int)len - n_a - 3;
    snprintf(text, sizeof text, "%.*s : %.*s", n_b, colon + 3, n_a, a);
    offer("word", from, len, text);
}

static void change_query(size_t from, size_t len)
{
    static const char *const pairs[][2] = {{"NOT IN", "IN"},
                                           {"INSERT INTO", "INSERT OR REPLACE INTO"},
                                           {"ORDER BY", "GROUP BY"},
                                           {"USING (key)", "USING (run)"}};
    for (size_t i = 0; i < sizeof pairs / sizeof *pairs; i++)
        if (strlen(pairs[i][0]) == len && strncmp(at_line.text + from, pairs[i][0], len) == 0)
            offer("query", from, len, pairs[i][1]);
}

/* A column of a figure becomes one that is near to it. */
static void change_column(size_t from, size_t len)
{
    static const char *const pairs[] = {
        "r3",     "r2",     "r2",           "r3",      "_mean",   "_sd",       "_se", "_sd", "displacement",
        "energy", "energy", "displacement", "N",       "H",       "H",         "N",   "x",   "y",
        "y",      "x",      "strongest",    "weakest", "weakest", "strongest", "mu",  "W"};
    char name[256], text[512];
    snprintf(name, sizeof name, "%.*s", (int)len, at_line.text + from);
    for (size_t i = 0; i < sizeof pairs / sizeof *pairs; i += 2) {
        const char *at = strstr(name, pairs[i]);
        if (!at) continue;
        snprintf(text, sizeof text, "%.*s%s%s", (int)(at - name), name, pairs[i + 1], at + strlen(pairs[i]));
        offer("column", from, len, text);
        return;
    }
    offer("column", from, len, "'n'");
}

enum { IN_LOOPS = 1, ELSEWHERE = 2, ANYWHERE = 3 };

static const struct {
    const char *pattern;
    void (*change)(size_t from, size_t len);
    int where; /* heads of loops, or other lines */
} changes[] = {{" ([-+*/<>]|<=|>=|==|!=|&&|[|][|]|[-+*/]=) ", change_operator, ANYWHERE},
               {"[a-z_]+ < ", end_early, IN_LOOPS},
               {"for \\([a-z_]+ [a-z_]+ = 0;", start_late, IN_LOOPS},
               {" [<>]=? [1-9][0-9]*[ ;,)]", move_limit, ELSEWHERE},
               {"[a-z_)](\\+\\+|--)[^+-]", count_back, ELSEWHERE},
               {"([ (,{]|return )-[a-zA-Z_(]", drop_minus, ANYWHERE},
               {"[ (][0-9]+[.][0-9]+[ ;,)]", change_number, ANYWHERE},
               {"[ (][0-9]+ [*/] ", change_number, ANYWHERE},
               {"[*/] [0-9]+[ ;,)]", change_number, ANYWHERE},
               {"[[][a-z0-9_]+[]]", change_index, ANYWHERE}};

/* Blank what is not to change, a comment by tabs; it, a string or a message may go on in the next line. */
static void blank(void)
{
    const char *text = at_line.text;
    char *code = at_line.code;
    const size_t n = strlen(text);
    for (size_t i = 0; i < n; i++) {
        char c = text[i];
        size_t skipped = 0;
        if (at_line.in_comment) {
            at_line.in_comment = strncmp(text + i, "*/", 2) != 0;
            skipped = !at_line.in_comment, c = '\t';
        } else if (at_line.quote) {
            skipped = c == '\\';
            if (c == at_line.quote) at_line.quote = 0;
            c = ' ';
        } else if (strncmp(text + i, "/*", 2) == 0) {
            at_line.in_comment = true;
            skipped = 1, c = '\t';
        } else if (c == '"' || c == '\'') {
            at_line.quote = c;
            c = ' ';
        } else if (strncmp(text + i, "rp_fail(", 8) == 0)
            at_line.in_message = true;
        if (c == ';') at_line.in_message = false;
        *code++ = at_line.in_message ? ' ' : c;
        if (skipped && i + 1 < n) *code++ = c, i++;
    }
    strcpy(code, " "); /* an operator or a number at the end of a line has a blank after it as well */
}

/* A line of the preprocessor, or of an enumeration, a structure or a named constant. */
static bool is_definition(void)
{
    const char *code = at_line.code;
    const bool is_directive = at_line.in_directive || code[strspn(code, " ")] == '#';
    at_line.in_directive = is_directive && matches("\\\\ $", code, NULL);
    if (matches("^(typedef )?(enum|struct)( [a-z_]+)? \\{|^static const " TYPE " [A-Z_]+ =", code, NULL))
        at_line.in_definition = true;
    const bool is = is_directive || at_line.in_definition;
    if (strchr(code, ';') && strncmp(code, "    ", 4) != 0) at_line.in_definition = false;
    return is;
}

#define ITEM "[A-Za-z_0-9.>*&-]+([[][a-z0-9_ +*]+[]])?"

/* Changes of the text itself, strings included. */
static void mutate_text(void)
{
    static const struct {
        const char *pattern;
        void (*change)(size_t from, size_t len);
        bool in_figures;
    } texts[] = {{"[ ({]" ITEM ", " ITEM "[,)}]", change_order, false},
                 {"\"[a-z_ ]+\" : \"[a-z_ ]+\"", change_words, false},
                 {"NOT IN|INSERT INTO|ORDER BY|USING \\(key\\)", change_query, false},
                 {"'[A-Za-z_0-9/()*]+'", change_column, true}};
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        regmatch_t m;
        if (texts[i].in_figures != at_line.is_figure) continue;
        for (size_t from = 0; matches(texts[i].pattern, at_line.text + from, &m);) {
            from += (size_t)m.rm_so;
            const size_t len = (size_t)(m.rm_eo - m.rm_so);
            if (at_line.code[from + 1] != '\t') texts[i].change(from, len);
            from += len - 1;
        }
    }
}

/* In a figure only what is between `using` and `with` is data; the rest is marked by tabs. */
static void keep_using(void)
{
    const char *using = strstr(at_line.text, "using"), *with = using ? strstr(using, " with ") : NULL;
    const size_t n = strlen(at_line.code);
    const size_t from = using ? (size_t)(using - at_line.text) + strlen("using") : n,
                 to = with ? (size_t)(with - at_line.text) : n;
    for (size_t i = 0; i < n; i++)
        if (i < from || i >= to) at_line.code[i] = '\t';
}

static void mutate_line(void)
{
    const bool was_message = at_line.in_message;
    blank();
    if (at_line.is_figure) keep_using();
    if (was_message || strstr(at_line.text, "rp_fail(")) return;
    if (is_definition() || matches(LEAVE, at_line.text, NULL)) return;
    const char *code = at_line.code;
    at_line.is_loop = strstr(code, "for (") != NULL;
    const size_t declared = matches(DECLARES, code, NULL) ? strcspn(code, "=") : 0; /* sizes up to there */
    if (at_line.is_figure || (at_line.is_result && !matches(HELP, at_line.text, NULL))) mutate_text();
    for (size_t i = 0; i < sizeof changes / sizeof *changes; i++) {
        if (!(changes[i].where & (at_line.is_loop ? IN_LOOPS : ELSEWHERE))) continue;
        regmatch_t m;
        for (size_t from = declared; matches(changes[i].pattern, code + from, &m);) {
            const size_t len = (size_t)(m.rm_eo - m.rm_so);
            from += (size_t)m.rm_so;
            changes[i].change(from, len);
            from += len - 1; /* the blank after it may be the next one's */
        }
    }
}

static FILE *opened(const char *path)
{
    FILE *in = fopen(path, "r");
    if (in) return in;
    perror(path);
    exit(2);
}

static void mutate_file(char *path)
{
    FILE *in = opened(path);
    char **before = NULL;
    memset(&at_line, 0, sizeof at_line);
    at_line.file = path;
    at_line.is_figure = strncmp(path, "figures/", 8) == 0;
    at_line.is_result = strncmp(path, "src/cli/", 8) == 0 || strstr(path, "/output.c") ||
                        strstr(path, "_tables.c") || strstr(path, "/store.c") || strstr(path, "/reduce.c") ||
                        strstr(path, "/cases.c");
    while (fgets(at_line.text, sizeof at_line.text - 2, in)) {
        at_line.text[strcspn(at_line.text, "\n")] = 0;
        before = checked(realloc(before, (at_line.number + 1) * sizeof *before));
        before[at_line.number] = trimmed(at_line.text);
        at_line.twin = 0;
        for (size_t i = 0; i <= at_line.number; i++)
            at_line.twin += strcmp(before[i], before[at_line.number]) == 0;
        at_line.number++;
        mutate_line();
    }
    for (size_t i = 0; i < at_line.number; i++) free(before[i]);
    free(before);
    fclose(in);
}

/* Mark what the file excepts: path, number among equal lines, line, mutant, reason; false if one is none. */
static bool read_exceptions(const char *path)
{
    FILE *in = opened(path);
    char line[4096];
    bool good = true;
    for (size_t number = 1; fgets(line, sizeof line, in); number++) {
        if (line[0] == '#') continue;
        char *rest = line, *field[5];
        for (size_t k = 0; k < 5; k++) field[k] = rest ? strsep(&rest, "\t\n") : "";
        bool found = false;
        for (entry *e = list.all; *field[4] && e < list.all + list.n; e++)
            if (strcmp(e->file, field[0]) == 0 && e->twin == strtoul(field[1], NULL, 10) &&
                strcmp(e->original, field[2]) == 0 && strcmp(e->mutant, field[3]) == 0)
                found = e->excepted = true;
        if (!found)
            fprintf(stderr, "%s:%zu: no such mutant, or no reason: %s: %s\n", path, number, field[0],
                    field[3]);
        good &= found;
    }
    fclose(in);
    return good;
}

static int compare(const entry *a, const entry *b, bool by_group)
{
    int order = by_group ? strcmp(a->file, b->file) : (a->turn > b->turn) - (a->turn < b->turn);
    if (!order && by_group) order = strcmp(a->kind, b->kind);
    return order ? order : (a->random > b->random) - (a->random < b->random);
}

static int by_group(const void *a, const void *b)
{
    return compare(a, b, true);
}

static int by_turn(const void *a, const void *b)
{
    return compare(a, b, false);
}

int main(int n, char **arguments)
{
    if (n < 4) {
        fprintf(stderr, "usage: mutants EXCEPTIONS SEED FILE ...\n");
        return 2;
    }
    list.seed = strtoull(arguments[2], NULL, 10);
    for (int i = 3; i < n; i++) mutate_file(arguments[i]);
    if (!read_exceptions(arguments[1])) return 2;
    qsort(list.all, list.n, sizeof *list.all, by_group);
    for (size_t i = 1; i < list.n; i++) {
        entry *e = list.all + i;
        if (strcmp(e->file, e[-1].file) == 0 && strcmp(e->kind, e[-1].kind) == 0) e->turn = e[-1].turn + 1;
    }
    qsort(list.all, list.n, sizeof *list.all, by_turn);
    for (const entry *e = list.all; e < list.all + list.n; e++)
        printf("%s\t%zu\t%s\t%s\t%s\t%s\n", e->file, e->line, e->kind, e->original, e->mutant,
               e->excepted ? "equivalent" : "survived");
    return 0;
}
