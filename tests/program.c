/* The program from the shell; see program.h. */
#include "tests/program.h"

#include <fcntl.h>
#include <limits.h>
#include <stdarg.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/faults.h"

static char folder[FOLDER_PATH], program[PATH_MAX], beside[PATH_MAX];
static const char *last; /* name of the program that ran last */
char out[1 << 20], err[1 << 14];

void leave(void)
{
    folder_remove(folder);
}

void enter(void)
{
    const char *name = getenv("REPOSE");
    folder_make("cli", folder);
    if (!realpath(name ? name : "build/repose", program)) {
        leave();
        CU_FAIL_FATAL("no program; REPOSE=path of the program");
    }
    snprintf(beside, sizeof beside, "%.*s/report", (int)(strrchr(program, '/') - program), program);
    setenv("REPOSE_DATA", folder, 1); /* no file of the source by chance */
    fclose(file_of("out")), fclose(file_of("err"));
}

const char *path_of(const char *name)
{
    return folder_path(folder, name);
}

FILE *file_of(const char *name)
{
    FILE *file = fopen(path_of(name), "w");
    CU_ASSERT_PTR_NOT_NULL_FATAL(file);
    return file;
}

void slurp(const char *name, char *text, size_t size)
{
    FILE *file = fopen(path_of(name), "r");
    size_t n = file ? fread(text, 1, size - 1, file) : 0;
    text[n] = '\0';
    CU_ASSERT(file && n < size - 1);
    if (file) fclose(file);
}

int shell(const char *text)
{
    int status = system(check_text("cd %s; REPOSE='%s' REPORT='%s'; %s", folder, program, beside, text));
    slurp("out", out, sizeof out);
    slurp("err", err, sizeof err);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

void holds_in_tree(const char *line)
{
    const int status = shell_line("to=$PWD; { cd \"$OLDPWD\" && %s; } >$to/out 2>$to/err", line);
    CHECK_OR_SAY(status == 0, "%s%s", out, err);
}

int run_program(const char *name, const char *begin, const char *words)
{
    last = name;
    return shell(check_text("exec \"$%s\" >out 2>err %s", begin, words));
}

int run(const char *format, ...)
{
    scoped char *words = NULL;
    va_list args;
    va_start(args, format);
    CU_ASSERT_FATAL(vasprintf(&words, format, args) >= 0);
    va_end(args);
    return run_program("repose", "REPOSE", words);
}

int repose_main(int argc, char **argv); /* of tests/fuzz/targets.c */

int run_forked(const char *words, void (*begin)(void))
{
    char word[20][128], *line[21] = {"repose"};
    int n = 1, end = 0;
    while (n < 20 && check_word(&words, " ", word[n])) line[n] = word[n], n++;
    const pid_t child = fork();
    if (child == 0) {
        if (!freopen("out", "w", stdout) || !freopen("err", "w", stderr)) _exit(99);
        begin();
        exit(repose_main(n, line));
    }
    CU_ASSERT_FATAL(waitpid(child, &end, 0) == child);
    return WIFEXITED(end) ? WEXITSTATUS(end) : 128 + WTERMSIG(end);
}

int run_begun(const char *words, void (*begin)(void))
{
    const int before = open(".", O_PATH | O_DIRECTORY);
    CU_ASSERT_FATAL(before >= 0 && chdir(folder) == 0);
    const int end = run_forked(words, begin);
    CU_ASSERT_FATAL(fchdir(before) == 0);
    close(before);
    last = "repose";
    slurp("out", out, sizeof out);
    slurp("err", err, sizeof err);
    return end;
}

/* Of run_signalled. */
static struct {
    int signal;
    const char *part;
    long n;
    double tick;
} ordered;

static void order_signal(void)
{
    fault_tick = ordered.tick;
    fault_signal(ordered.signal, ordered.part, ordered.n);
}

int run_signalled(int signal, const char *part, long n, const char *words)
{
    ordered.signal = signal, ordered.part = part, ordered.n = n, ordered.tick = 1.0;
    return run_begun(words, order_signal);
}

int run_by_minutes(int signal, const char *part, long n, const char *words)
{
    ordered.signal = signal, ordered.part = part, ordered.n = n, ordered.tick = 60.0;
    return run_begun(words, order_signal);
}

/* The line that ends a run. */
static bool is_closing_line(const char *text)
{
    const char *end = strchr(text, '\n');
    return strncmp(text, "repose run: ", 12) == 0 && end && !end[1] &&
           (strstr(text, "; tables in ") || strstr(text, " on standard output\n"));
}

bool good(const char *file, int line, int status)
{
    bool right = status == 0 && (err[0] == '\0' || is_closing_line(err));
    if (!right) fprintf(stderr, "%s:%d: exit status %d, message \"%s\"\n", file, line, status, err);
    return right;
}

bool failed(const char *file, int line, int status, int expected, const char *text)
{
    const char *end = strchr(err, '\n');
    bool right = status == expected && strncmp(err, last, strlen(last)) == 0 && end && end[1] == '\0' &&
                 strstr(err, text);
    if (!right)
        fprintf(stderr, "%s:%d: exit status %d, message \"%s\"; expected %d, \"%s\"\n", file, line, status,
                err, expected, text);
    return right;
}

bool prints(const char *file, int line, int status, const char *text)
{
    const bool right = good(file, line, status), there = strstr(out, text) != NULL;
    if (right && !there) fprintf(stderr, "%s:%d: does not print \"%s\"\n", file, line, text);
    return right && there;
}

bool prints_all(const char *file, int line, int status, const char *text)
{
    const bool right = good(file, line, status), same = strcmp(out, text) == 0;
    if (right && !same) fprintf(stderr, "%s:%d: prints:\n%sexpected:\n%s", file, line, out, text);
    return right && same;
}

void check_failures(size_t n, const failure list[])
{
    for (size_t i = 0; i < n; i++) {
        FAILS(list[i].status, list[i].text, "%s", list[i].words);
        CU_ASSERT(out[0] == '\0');
    }
}

void check_refused_texts(size_t n, const char *const list[][2], const char *file, const char *words)
{
    for (size_t i = 0; i < n; i++) {
        write_text(file, "%s\n", list[i][0]);
        check_failures(1, &(failure){65, list[i][1], words});
    }
}

rp_table read_table(const char *name)
{
    static char path[256];
    rp_table table = {0};
    snprintf(path, sizeof path, "%s", path_of(name));
    CHECK_OK(rp_table_read(path, &table));
    return table;
}

void replace_table(rp_table *table, rp_table by)
{
    rp_table_free(table);
    *table = by;
}

void read_again(rp_table *table, const char *name)
{
    replace_table(table, read_table(name));
}

void check_cells(int line, size_t n, const cell_says cells[])
{
    scoped_table t = read_table("out");
    for (size_t k = 0; k < n; k++) {
        size_t row = 0;
        while (row < t.n_rows && strcmp(t.cells[row * t.n_columns], cells[k].begin) != 0) row++;
        const char *found = row < t.n_rows ? word(&t, row, cells[k].column) : "no such row";
        CHECK_OR_SAY(strcmp(found, cells[k].expected) == 0, "line %d: %s: %s, expected %s", line,
                     cells[k].begin, found, cells[k].expected);
    }
}

rp_table table_of(const char *file, int line, int status)
{
    CU_ASSERT(good(file, line, status));
    return read_table("out");
}

const char *word(const rp_table *t, size_t row, const char *column)
{
    int c = rp_table_column(t, column);
    bool there = c >= 0 && row < t->n_rows;
    CHECK_OR_SAY(there, "%s: no row %zu of column %s", t->path, row, column);
    return there ? t->cells[row * t->n_columns + (size_t)c] : "";
}

double cell(const rp_table *t, size_t row, const char *column)
{
    const char *text = word(t, row, column);
    return *text ? strtod(text, NULL) : NAN;
}

checked checked_read(const char *name)
{
    checked c = {.t = read_table(name)};
    CU_ASSERT_FATAL(c.t.n_columns <= CHECKED_COLUMNS);
    return c;
}

checked checked_run(const char *file, int line, size_t n_rows, int status)
{
    CU_ASSERT(good(file, line, status));
    checked c = checked_read("out");
    CU_ASSERT_FATAL(c.t.n_rows == n_rows);
    return c;
}

double at(checked *c, size_t row, const char *column)
{
    const int k = rp_table_column(&c->t, column);
    if (k >= 0) c->read[k] = true;
    return cell(&c->t, row, column);
}

const char *checked_word(checked *c, size_t row, const char *column)
{
    (void)at(c, row, column);
    return word(&c->t, row, column);
}

void checked_row(checked *c, size_t row, size_t n, const check_value values[], double tolerance)
{
    for (size_t k = 0; k < n; k++) {
        const double found = at(c, row, values[k].name), value = values[k].value;
        CU_ASSERT(isnan(found) == isnan(value));
        if (!isnan(value)) CHECK_NEAR(found, value, tolerance * (1.0 + fabs(value)));
    }
}

void checked_end(checked *c)
{
    for (size_t k = 0; k < c->t.n_columns; k++)
        CHECK_OR_SAY(c->read[k], "%s: column %s is not checked", c->t.path, c->t.names[k]);
    rp_table_free(&c->t);
}

bool equal_tables(const char *name_a, const char *name_b)
{
    scoped_table a = read_table(name_a), b = read_table(name_b);
    bool equal = a.n_rows > 0 && a.n_rows == b.n_rows && a.n_columns == b.n_columns;
    for (size_t i = 0; equal && i < a.n_rows * a.n_columns; i++) equal = strcmp(a.cells[i], b.cells[i]) == 0;
    return equal;
}

const char *beyond_range(const rp_param *p, bool upper)
{
    char *middle;
    if ((p->type != RP_REAL && p->type != RP_INT) || !strchr("[(", *p->range)) return "";
    const double lo = strtod(p->range + 1, &middle), hi = strtod(middle + 1, NULL), at = upper ? hi : lo;
    if (isinf(at) || fabs(at) > 2e9) return "";
    return check_text(p->type == RP_INT ? "%.0f" : "%.9f",
                      at + (upper ? 1.0 : -1.0) * (p->type == RP_INT ? 1.0 : 1e-3 * fmax(1.0, fabs(at))));
}
