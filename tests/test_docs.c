/* The pages for people, README.md and docs: each command block runs, and prints what the page shows. Blocks
 * of a page run in order, in one temporary folder that looks like the repository's root.
 *
 *   ```sh or ```python             commands; the block must succeed
 *   ```text, right after it        its output and messages: `...` stands for any text within a line, and
 * alone in a line for any lines; blanks are equal to tabs; lines with # are left out. A last command that
 * fails shows its message, `repose ...`. A line `skipped: ...` tells of a part that was left out.
 *   <!-- test: COMMANDS -->        before a block that takes long, or changes the machine: these run in its
 * place */
#include <ctype.h>
#include <unistd.h>

#include "tests/program.h"

#define PAGES(X)                                                                                             \
    X(browser, "docs/browser.md")                                                                            \
    X(readme, "README.md")                                                                                   \
    X(experiments, "docs/experiments.md")                                                                    \
    X(first_pile, "docs/first-pile.md")                                                                      \
    X(grains, "docs/grains.md")                                                                              \
    X(install, "docs/install.md")                                                                            \
    X(performance, "docs/performance.md")                                                                    \
    X(physics, "docs/physics.md")                                                                            \
    X(programs, "docs/programs.md")                                                                          \
    X(scenes, "docs/scenes.md")                                                                              \
    X(sweeps, "docs/sweeps.md")

enum { LONGEST_BLOCK = 1 << 14 };

typedef struct {
    const char *page;
    int line; /* of the fence */
    bool python;
    char commands[LONGEST_BLOCK], instead[1024], expected[LONGEST_BLOCK];
} block;

/* Runs of blanks become one, at the end of a line none. */
static char *squeeze(char *line)
{
    char *to = line;
    for (const char *p = line; *p; p++)
        if (!isspace((unsigned char)*p))
            *to++ = *p;
        else if (to > line && to[-1] != ' ')
            *to++ = ' ';
    if (to > line && to[-1] == ' ') to--;
    *to = '\0';
    return line;
}

/* Whether a line is as shown, where `...` stands for any text. */
static bool line_matches(const char *shown, const char *line)
{
    const char *gap = strstr(shown, "...");
    if (!gap) return strcmp(shown, line) == 0;
    if (strncmp(shown, line, (size_t)(gap - shown)) != 0) return false;
    for (line += gap - shown;; line++) {
        if (line_matches(gap + 3, line)) return true;
        if (!*line) return false;
    }
}

/* The next line, squeezed; NULL at the end. */
static char *next_line(char **text)
{
    char *line = strsep(text, "\n");
    return line && (*text || *line) ? squeeze(line) : NULL;
}

/* How far a command is, once a minute on a machine that is busy. */
static bool is_progress(const char *line)
{
    const size_t n = strlen(line);
    return strncmp(line, "repose ", 7) == 0 && n > 5 && strcmp(line + n - 5, " left") == 0;
}

/* The next line of output that is shown: no provenance, and no progress. */
static char *next_output(char **text)
{
    char *line;
    do line = next_line(text);
    while (line && (*line == '#' || is_progress(line)));
    return line;
}

/* Whether the output is as shown; else the first line shown and missing, or the first one too many. */
static bool output_matches(char *shown, char *output, const char **missing)
{
    bool gap = false;
    for (char *s; (s = next_line(&shown));) {
        if (strcmp(s, "...") == 0) {
            gap = true;
            continue;
        }
        char *line = next_output(&output);
        while (gap && line && !line_matches(s, line)) line = next_output(&output);
        *missing = s;
        if (!line || !line_matches(s, line)) return false;
        gap = false;
    }
    *missing = gap ? NULL : next_output(&output);
    return *missing == NULL;
}

static void run_block(block *b)
{
    const char *missing = NULL;
    if (!b->commands[0]) {
        b->expected[0] = '\0';
        return;
    }
    write_text("block", "%s\n", b->instead[0] ? b->instead : b->commands);
    const int status = shell_line(": >err; cd page; PATH=$PWD/build:$PATH %s ../block >../out 2>&1",
                                  b->python && !b->instead[0] ? "PYTHONPATH=python python3" : "sh -e");
    const bool message = strncmp(b->expected, "repose", 6) == 0 || strstr(b->expected, "\nrepose");
    bool right = status == 0 || (status > 0 && message);
    if (!right) fprintf(stderr, "%s:%d: exit status %d\n%s", b->page, b->line, status, out);
    if (right && b->expected[0] && !(right = output_matches(b->expected, out, &missing))) {
        fprintf(stderr, "%s:%d: the output differs at: %s\n", b->page, b->line, missing);
        slurp("out", out, sizeof out);
        fprintf(stderr, "%s", out);
    }
    CU_ASSERT(right);
    slurp("out", out, sizeof out);
    for (char *text = out, *said; (said = next_line(&text));)
        if (strncmp(said, "skipped: ", 9) == 0) check_skip(check_text("%s: %s", b->page, said + 9));
    b->commands[0] = b->instead[0] = b->expected[0] = '\0';
}

/* Folder `page` of the test's folder: links to the repository's root, and the program in build. */
static void make_folder(void)
{
    char root[512];
    enter();
    CU_ASSERT_PTR_NOT_NULL_FATAL(getcwd(root, sizeof root));
    CU_ASSERT_EQUAL_FATAL(shell_line("{ mkdir page && cd page && ln -s '%s'/* . && rm build && mkdir build "
                                     "&& ln -s \"$REPOSE\" \"$REPORT\" build/; } >out 2>err",
                                     root),
                          0);
    setenv("PYTHONDONTWRITEBYTECODE", "1", 1);
    unsetenv("MAKEFLAGS"), unsetenv("REPOSE_DATA");
}

static void page(const char *path)
{
    static block b;
    char *line = NULL, *to = NULL;
    size_t size = 0;
    FILE *file = fopen(path, "r");
    CU_ASSERT_PTR_NOT_NULL_FATAL(file);
    make_folder();
    b.page = path;
    for (int number = 1; getline(&line, &size, file) > 0; number++) {
        if (to && strncmp(line, "```", 3) == 0) {
            if (to == b.expected) run_block(&b);
            to = NULL;
        } else if (to) {
            CU_ASSERT_FATAL(strlen(to) + strlen(line) < LONGEST_BLOCK);
            strcat(to, line);
        } else if (strncmp(line, "```text", 7) == 0) {
            to = b.expected;
        } else if (*line != '\n') {
            run_block(&b);
            sscanf(line, "<!-- test: %1000[^\n]", b.instead);
            if (strstr(b.instead, " -->")) *strstr(b.instead, " -->") = '\0';
            b.python = strncmp(line, "```python", 9) == 0;
            if (b.python || strncmp(line, "```sh", 5) == 0) to = b.commands, b.line = number;
        }
    }
    run_block(&b);
    free(line);
    fclose(file);
    leave();
}

#define X(name, path)                                                                                        \
    static void name(void)                                                                                   \
    {                                                                                                        \
        if (!CHECK_SKIPS("a page takes minutes, and other suites run its commands")) page(path);             \
    }
PAGES(X)
#undef X

/* Whether a page has this anchor, or a heading of which it is made: lower case, words joined by -. */
static bool has_anchor(const char *page, const char *anchor)
{
    char *line = NULL;
    size_t size = 0;
    bool has = false;
    FILE *file = fopen(page, "r");
    while (file && !has && getline(&line, &size, file) > 0) {
        char *from = line + strspn(line, "#"), *to = line;
        has = strstr(line, check_text("<a id=\"%s\"></a>", anchor)) != NULL;
        if (from == line || has) continue;
        for (from += *from == ' '; *from && *from != '\n'; from++)
            if (isalnum((unsigned char)*from) || strchr(" -_", *from))
                *to++ = *from == ' ' ? '-' : (char)tolower((unsigned char)*from);
        *to = '\0';
        has = strcmp(line, anchor) == 0;
    }
    if (file) fclose(file);
    free(line);
    return has;
}

/* Every file that a line links to exists, seen from the page's folder, and so does the heading in it. */
static bool links_exist(const char *page, char *line)
{
    const char *slash = strrchr(page, '/');
    const int folder = slash ? (int)(slash + 1 - page) : 0;
    bool right = true;
    for (char *to; right && (to = strstr(line, "]("));) {
        to += 2, line = to + strcspn(to, ")#");
        const char *path = line == to ? page : check_text("%.*s%.*s", folder, page, (int)(line - to), to);
        const char *anchor = *line == '#' ? check_text("%.*s", (int)strcspn(line + 1, ")"), line + 1) : NULL;
        right =
            strncmp(to, "http", 4) == 0 || (access(path, R_OK) == 0 && (!anchor || has_anchor(path, anchor)));
        if (!right) fprintf(stderr, "%s: no %s%s%s\n", page, path, anchor ? "#" : "", anchor ? anchor : "");
    }
    return right;
}

static void check_line(const char *page, int number, char *line)
{
#define X(name, path) path,
    static const char *const pages[] = {PAGES(X)};
#undef X
    static bool fence;
    bool listed = false;
    for (size_t k = 0; k < sizeof pages / sizeof *pages; k++) listed |= !strcmp(pages[k], page);
    const char *p = line + strspn(line, " ");
    fence = (fence && number > 1) ^ (strncmp(line, "```", 3) == 0);
    const bool command =
        !fence && p - line >= 4 && (!strncmp(p, "repose ", 7) || !strncmp(p, "make ", 5) || *p == '$');
    CHECK_OR_SAY(!command && (listed || strncmp(line, "```sh", 5) != 0), "%s:%d: no test runs %s", page,
                 number, line);
    CU_ASSERT(links_exist(page, line));
}

/* No command of a page escapes: each stands in a fenced block, of a page in the list above. */
static void every_command(void)
{
    file_lines("docs/*.md", check_line);
    file_lines("README.md", check_line);
    file_lines("paper-repro.md", check_line);
}

/* The suites that the promises name are suites. */
static void promises(void)
{
    make_folder();
    SHELL("sed -n 's/^| [0-9]*\\. .*| \\(`.*`\\) |$/\\1/p' page/docs/guarantees.md >suites && cd page && "
          "[ $(wc -l <../suites) = $(grep -c '^| [0-9]*\\. ' docs/guarantees.md) ] && "
          "grep -o '`[^`]*`' ../suites | tr -d '`' | while read -r s; do "
          "grep -qE \"^CHECK_SUITE[A-Z_]*\\\\($s,\" tests/*.c validation/*.c || "
          "{ echo \"no suite $s\"; exit 1; }; done");
    leave();
}

/* Every number of README's evidence stands on the page that its item names first; counts of statements and
 * the version are those of their sources. */
static void evidence(void)
{
    make_folder();
    SHELL("cd page && counts='[0-9]* reproduced, [0-9]* not reproduced, [0-9]* open' && "
          "{ sed -n '/^## Evidence/,/^## Doc/p' README.md | tr -s '\\n ' '  ' | sed 's/ - \\*/\\n*/g'; echo; "
          "} | "
          "sed 1d >../items && grep -o \"$counts\" ../items >../ours && "
          "grep -o \"$counts\" paper-repro.md | diff - ../ours && [ $(wc -l <../items) = 4 ] && "
          "while read -r item; do page=$(echo \"$item\" | sed 's/^[^(]*(\\([^)]*\\)).*/\\1/'); "
          "for n in $(echo \"$item\" | grep -oE '[0-9]+([.][0-9]+)?'); do "
          "grep -qE \"(^|[^0-9.])$n([^0-9.]|[.]?$|[.][^0-9])\" $page || { echo \"$page: no $n\"; exit 1; }; "
          "done; done <../items && "
          "grep -q \"version $(sed -n 's/^#define RP_VERSION \"\\(.*\\)\"/\\1/p' src/core/version.h),\" "
          "README.md");
    leave();
}

/* What the pages say of frames, corners and heights: tables of a turned box are in the laboratory frame,
 * corners of a circle lie on it and its lowest side is level, and `flanks` takes heights from 0.1 to 0.9. */
static void facts(void)
{
    enter();
    write_text("turn.cfg", "steps = 100; gravity = [0.0, 0.0]; box_turn_deg_per_step = 0.1;\n"
                           "walls = ( { circle = [0.0, 0.0, 2.0]; sides = 5; } );\n"
                           "particles = ( { x = 0.5; y = 0.0; r = 0.1; } );\n");
    GOOD("run turn.cfg --every 100 -o turn");
    scoped_table states = read_table("turn/states.tsv"), walls = read_table("turn/walls.tsv");
    CU_ASSERT_FATAL(states.n_rows == 2 && walls.n_rows == 10);
    CU_ASSERT(cell(&states, 1, "x") == 0.5 && cell(&states, 1, "y") == 0.0);
    bool level = false;
    for (size_t k = 0; k < 5; k++) {
        const double x = cell(&walls, k, "x"), y = cell(&walls, k, "y");
        CHECK_NEAR(x * x + y * y, 4.0, 1e-14);
        level |= y < 0.0 && fabs(cell(&walls, k, "direction_y") - 1.0) < 1e-15;
    }
    CU_ASSERT(level);
    GOOD("params experiment");
    SHELL(
        "sed -n '/of = \"flanks\"/,/of = \"deposit\"/p' out | awk '/^  (from|to) / { printf \"%s \", $4 }' | "
        "grep -x '0.1 0.9 '");
    /* what docs/choices.md lists as defaults */
    GOOD("params repose");
    SHELL("awk '$1 ~ /^(slip|floor|fill|tilt)$/ && !s[$1]++ { printf \"%s=%s \", $1, $4 }' out | "
          "grep -x 'slip=truncated floor=extends fill=auto tilt=gravity '");
    GOOD("params scene");
    SHELL("awk '$1 ~ /^(density|dt)$/ && !s[$1]++ { printf \"%s=%s \", $1, $4 }' out | sort | "
          "grep -E 'density=1.0 ' | grep -E 'dt=5e-5 '");
    leave();
}

static bool same(const char *shown, const char *output)
{
    char a[256], b[256];
    const char *missing;
    strcpy(a, shown), strcpy(b, output);
    return output_matches(a, b, &missing);
}

static void comparison(void)
{
    CU_ASSERT(same("a b\n", "# model 1\na\tb\n") && same("a 1.2...\nb\n", "a\t1.25\nb\n"));
    CU_ASSERT(same("a ...ok\n", "a\t1.25\tok\n") && same("a\n...\nd\n", "a\nb\nc\nd\n"));
    CU_ASSERT(same("a\n...\n", "a\nb\n"));
    CU_ASSERT(same("a\n", "repose sweep: 3 of 12 runs, 0 failed, 1:02 left\na\n") && same("", ""));
    CU_ASSERT_FALSE(same("a 1.2...\n", "a 1.3\n"));
    CU_ASSERT_FALSE(same("a ... ok\n", "a 1 no\n"));
    CU_ASSERT_FALSE(same("a\n", "a\nb\n"));
    CU_ASSERT_FALSE(same("a\nb\n", "a\n"));
    CU_ASSERT_FALSE(same("a\n...\nd\n", "a\nb\n"));
    CU_ASSERT_FALSE(same("a\n...\nd\n", "a\nd\ne\n"));
}

CHECK_SUITE(docs, "docs", comparison, every_command, promises, evidence, facts, browser, readme, experiments,
            first_pile, grains, install, performance, physics, programs, scenes, sweeps)
