/* `repose report`: a text with places that are filled from tables, so that no number is typed in.
 *
 * A place reads {{word table key=value column ...}}. The row of build/tables/<table>.tsv is the one whose
 * cells equal all key=value given (numbers compare as numbers).
 *   {{value T k=v COL}}            value +- standard error, from COL_mean and COL_se, or COL and its _se
 * column
 *   {{cell T k=v COL FORMAT}}      the cell itself, printed with the format given (%.Ng or %.Nf); without one
 *                                  a count as it stands, else with %.3g
 *   {{difference T k=v COL @T2 k=v COL}}  value less that of another table, of other runs, +- both errors
 *   {{agree T k=v COL PAPER SE}}   verdict: within two standard errors of the paper's value?
 *   {{above T k=v COL LIMIT}}      verdict: above LIMIT by more than two standard errors?
 *   {{below T k=v COL LIMIT}}      the same, below
 *   {{least T k=v COL LIMIT}}      verdict on a cell without error, such as a p-value: at least LIMIT?
 *   {{holds T k=v COL TEXT|TEXT}}  verdict on a word: does it contain one of the texts? undecided stays
 *   {{note T KEY}}                 a header line of the table
 * A value or an error that is nan is not known, and a verdict on it undecided.
 * In place of LIMIT, @COL takes the magnitude of another quantity of the same row, with its standard error,
 * and
 * @TABLE k=v COL, as the last words, that of another table.
 */
#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "cli/cli.h"

enum { MAX_WORDS = 12 };

typedef struct {
    const char *tables, *output, *missing;
} report_options;

static const rp_param options[] = {
    {"tables", "", RP_TEXT, offsetof(report_options, tables), "build/tables", "", "folder of the tables"},
    {"missing", "", RP_TEXT, offsetof(report_options, missing), "", "",
     "what stands where a table has not been made; empty: that is an error"},
    {"o", "", RP_TEXT, offsetof(report_options, output), "-", "", "file to write; - is standard output"},
    {0}};

static const cli_command command = {
    "report",
    "TEMPLATE [--tables DIR] [--missing TEXT] [-o FILE]",
    "Fill the places {{word table key=value column ...}} of a text from tables: value, cell, difference,\n"
    "agree, above, below, least, holds, note. A verdict compares with two standard errors.",
    "repose report figures/paper-repro.md.in -o paper-repro.md",
    options,
    1,
    1};

/* One place in the text, split into words. */
typedef struct {
    const char *tables, *missing;
    char *words[MAX_WORDS];
    int n;
} place;

static rp_status read_table(const place *p, char path[4096], rp_table *table)
{
    if (p->n < 3) return rp_fail(RP_BAD_INPUT, "{{%s ...}}: table and column expected", p->words[0]);
    snprintf(path, 4096, "%s/%s.tsv", p->tables, p->words[1]);
    return rp_table_read(path, table);
}

static bool cell_equals(const char *cell, const char *wanted)
{
    char *end_a, *end_b;
    double a = strtod(cell, &end_a), b = strtod(wanted, &end_b);
    return strcmp(cell, wanted) == 0 || (!*end_a && !*end_b && *cell && fabs(a - b) <= 1e-12 * fabs(b));
}

/* The row that the key=value words choose, and the number of the word after them. */
static rp_status find_row(const place *p, const rp_table *t, size_t *row, int *next)
{
    *next = 2;
    while (*next < p->n && strchr(p->words[*next], '=')) ++*next;
    size_t found = 0;
    for (size_t r = 0; r < t->n_rows; r++) {
        bool all = true;
        for (int w = 2; w < *next && all; w++) {
            char key[128];
            snprintf(key, sizeof key, "%.*s", (int)strcspn(p->words[w], "="), p->words[w]);
            int column = rp_table_column(t, key);
            if (column < 0) return rp_fail(RP_BAD_INPUT, "%s: no column %s", t->path, key);
            all = cell_equals(t->cells[r * t->n_columns + (size_t)column], strchr(p->words[w], '=') + 1);
        }
        if (!all) continue;
        *row = r;
        found++;
    }
    return found == 1 ? RP_OK
                      : rp_fail(RP_BAD_INPUT, "%s: %zu rows with %s, one expected", t->path, found,
                                *next > 2 ? p->words[2] : "no key");
}

/* Value and standard error of a quantity: NAME_mean, NAME_se, or NAME_deg, NAME_se_deg, or NAME, NAME_se; a
 * quantity without a column for its error is exact. */
static rp_status find_value(const rp_table *t, size_t row, const char *name, double *value, double *se)
{
    char mean[160], error[160];
    snprintf(mean, sizeof mean, "%s_mean", name);
    snprintf(error, sizeof error, "%s_se", name);
    if (rp_table_column(t, mean) < 0) snprintf(mean, sizeof mean, "%s", name);
    size_t n = strlen(name);
    if (rp_table_column(t, error) < 0 && n > 4 && strcmp(name + n - 4, "_deg") == 0)
        snprintf(error, sizeof error, "%.*s_se_deg", (int)n - 4, name);
    int value_column = rp_table_column(t, mean), error_column = rp_table_column(t, error);
    if (value_column < 0) return rp_fail(RP_BAD_INPUT, "%s: no column %s", t->path, mean);
    rp_status status = rp_table_number(t, row, value_column, true, value);
    *se = 0.0;
    return status || error_column < 0 ? status : rp_table_number(t, row, error_column, true, se);
}

/* Two significant digits of the error decide. A small ensemble may know neither. */
static void print_value(FILE *out, double value, double se)
{
    if (isnan(value)) {
        fputs("not known", out);
        return;
    }
    if (isnan(se)) {
        fprintf(out, "%.3g (error not known)", value);
        return;
    }
    int decimals = se > 0.0 ? 1 - (int)floor(log10(se)) : 3;
    if (decimals < 0) decimals = 0;
    fprintf(out, "%.*f ± %.*f", decimals, value, decimals, se);
}

static rp_status number_word(const place *p, int index, double *number)
{
    char *end;
    if (index >= p->n) return rp_fail(RP_BAD_INPUT, "{{%s ...}}: a number is missing", p->words[0]);
    *number = strtod(p->words[index], &end);
    return *end ? rp_fail(RP_BAD_INPUT, "{{%s ...}}: \"%s\" is not a number", p->words[0], p->words[index])
                : RP_OK;
}

/* The limit that the words from `at` on name: @COL of the same row, @TABLE key=value ... COL of another
 * table, or a number. */
static rp_status find_limit(const place *p, int at, const rp_table *t, size_t row, double *limit, double *se)
{
    *se = 0.0;
    if (at >= p->n || p->words[at][0] != '@') return number_word(p, at, limit);
    if (at + 1 == p->n) return find_value(t, row, p->words[at] + 1, limit, se);
    place other = {.tables = p->tables, .n = 1 + p->n - at, .words = {p->words[0], p->words[at] + 1}};
    for (int w = at + 1; w < p->n; w++) other.words[2 + w - at - 1] = p->words[w];
    char path[4096];
    rp_table table = {0};
    int next;
    rp_status status = read_table(&other, path, &table);
    if (!status) status = find_row(&other, &table, &row, &next);
    if (!status && next >= other.n)
        status = rp_fail(RP_BAD_INPUT, "{{%s ... %s ...}}: no column", p->words[0], p->words[at]);
    if (!status) status = find_value(&table, row, other.words[next], limit, se);
    rp_table_free(&table);
    return status;
}

static rp_status print_difference(const place *p, int next, const rp_table *t, size_t row, FILE *out)
{
    double value, se, less, less_se;
    rp_status status = find_value(t, row, p->words[next], &value, &se);
    if (!status) status = find_limit(p, next + 1, t, row, &less, &less_se);
    if (!status) print_value(out, value - less, hypot(se, less_se));
    return status;
}

static rp_status print_verdict(const place *p, int next, const rp_table *t, size_t row, FILE *out)
{
    double value, se = 0.0, limit = 0.0, limit_se = 0.0;
    rp_status status = find_limit(p, next + 1, t, row, &limit, &limit_se);
    if (status) return status;
    if (p->words[next + 1][0] == '@') limit = fabs(limit);
    if (strcmp(p->words[0], "least") == 0) {
        int column = rp_table_column(t, p->words[next]);
        if (column < 0) return rp_fail(RP_BAD_INPUT, "%s: no column %s", t->path, p->words[next]);
        status = rp_table_number(t, row, column, true, &value);
        if (!status)
            fputs(isnan(value) ? "undecided" : value >= limit ? "reproduced" : "not reproduced", out);
        return status;
    }
    status = find_value(t, row, p->words[next], &value, &se);
    if (!status && strcmp(p->words[0], "agree") == 0) status = number_word(p, next + 2, &limit_se);
    if (status) return status;
    double difference = value - limit, error = hypot(se, limit_se);
    if (isnan(difference) || isnan(error)) {
        fputs("undecided", out);
    } else if (strcmp(p->words[0], "agree") == 0) {
        fputs(fabs(difference) <= 2.0 * error ? "reproduced" : "not reproduced", out);
        fprintf(out, " (differs by %+.1f standard errors)", difference / error);
    } else {
        double sign = strcmp(p->words[0], "above") == 0 ? 1.0 : -1.0;
        fputs(sign * difference > 2.0 * error    ? "reproduced"
              : sign * difference < -2.0 * error ? "not reproduced"
                                                 : "undecided",
              out);
    }
    return RP_OK;
}

static rp_status print_holds(const place *p, int next, const rp_table *t, size_t row, FILE *out)
{
    int column = rp_table_column(t, p->words[next]);
    if (column < 0) return rp_fail(RP_BAD_INPUT, "%s: no column %s", t->path, p->words[next]);
    if (next + 1 >= p->n) return rp_fail(RP_BAD_INPUT, "{{holds ...}}: a text is missing");
    const char *cell = t->cells[row * t->n_columns + (size_t)column];
    bool holds = false;
    for (char *save, *text = strtok_r(p->words[next + 1], "|", &save); text;
         text = strtok_r(NULL, "|", &save))
        holds |= strstr(cell, text) != NULL;
    fputs(holds                            ? "reproduced"
          : strcmp(cell, "undecided") == 0 ? cell
          : strcmp(cell, "no_result") == 0 ? "can't be tested: no result"
                                           : "not reproduced",
          out);
    return RP_OK;
}

static rp_status print_cell(const place *p, int next, const rp_table *t, size_t row, FILE *out)
{
    int column = rp_table_column(t, p->words[next]);
    if (column < 0) return rp_fail(RP_BAD_INPUT, "%s: no column %s", t->path, p->words[next]);
    const char *cell = t->cells[row * t->n_columns + (size_t)column];
    /* precision and letter alone are taken from the text, so that it cannot be a harmful format */
    const char *format = next + 1 < p->n ? p->words[next + 1] : "%.3g";
    int precision = 3, used = 0;
    char letter = 'g', *end;
    if (sscanf(format, "%%.%1d%c%n", &precision, &letter, &used) != 2 || format[used] ||
        !strchr("fg", letter))
        return rp_fail(RP_BAD_INPUT, "{{cell ...}}: \"%s\": a format such as %%.3g or %%.0f expected",
                       format);
    const bool whole = next + 1 == p->n && !cell[strspn(cell, "0123456789")]; /* a count is not rounded */
    double value = strtod(cell, &end);
    if (*end || whole)
        fputs(cell, out);
    else
        fprintf(out, letter == 'f' ? "%.*f" : "%.*g", precision, value);
    return RP_OK;
}

/* The header line "# KEY: text" of a table. */
static rp_status print_note(const place *p, FILE *out)
{
    char path[4096], line[1024];
    if (p->n != 3) return rp_fail(RP_BAD_INPUT, "{{note ...}}: table and key expected");
    snprintf(path, sizeof path, "%s/%s.tsv", p->tables, p->words[1]);
    FILE *in = fopen(path, "r");
    if (!in) return rp_fail(RP_BAD_INPUT, "%s: cannot read", path);
    size_t n = strlen(p->words[2]);
    bool found = false;
    while (!found && fgets(line, sizeof line, in)) {
        found = line[0] == '#' && strncmp(line + 2, p->words[2], n) == 0 && line[2 + n] == ':';
        if (found) fprintf(out, "%.*s", (int)strcspn(line + 4 + n, "\n"), line + 4 + n);
    }
    fclose(in);
    return found ? RP_OK : rp_fail(RP_BAD_INPUT, "%s: no header line \"%s\"", path, p->words[2]);
}

static rp_status fill_place(const place *p, FILE *out)
{
    static const char *const verdicts[] = {"agree", "above", "below", "least"};
    if (p->n > 0 && strcmp(p->words[0], "note") == 0) return print_note(p, out);
    char path[4096];
    rp_table table = {0};
    size_t row = 0;
    int next = 0;
    rp_status status = p->n > 0 ? read_table(p, path, &table) : rp_fail(RP_BAD_INPUT, "{{}}: empty");
    if (!status) status = find_row(p, &table, &row, &next);
    if (!status && next >= p->n)
        status = rp_fail(RP_BAD_INPUT, "{{%s %s ...}}: no column", p->words[0], p->words[1]);
    if (!status) {
        bool known = false;
        for (size_t v = 0; v < sizeof verdicts / sizeof *verdicts; v++)
            known |= strcmp(p->words[0], verdicts[v]) == 0;
        double value, se;
        if (known)
            status = print_verdict(p, next, &table, row, out);
        else if (strcmp(p->words[0], "holds") == 0)
            status = print_holds(p, next, &table, row, out);
        else if (strcmp(p->words[0], "difference") == 0)
            status = print_difference(p, next, &table, row, out);
        else if (strcmp(p->words[0], "cell") == 0)
            status = print_cell(p, next, &table, row, out);
        else if (strcmp(p->words[0], "value") != 0)
            status = rp_fail(RP_BAD_INPUT, "{{%s ...}}: unknown word", p->words[0]);
        else if (!(status = find_value(&table, row, p->words[next], &value, &se)))
            print_value(out, value, se);
    }
    rp_table_free(&table);
    return status;
}

/* Put the text for missing tables in the place, if that is wanted and its table is missing. */
static bool fill_missing(const place *p, FILE *out)
{
    char path[4096];
    if (!*p->missing || p->n < 2) return false;
    snprintf(path, sizeof path, "%s/%s.tsv", p->tables, p->words[1]);
    if (access(path, F_OK) == 0) return false;
    fputs(p->missing, out);
    return true;
}

static rp_status fill_line(char *line, const report_options *o, FILE *out)
{
    for (char *open; (open = strstr(line, "{{"));) {
        char *close = strstr(open, "}}");
        if (!close) return rp_fail(RP_BAD_INPUT, "{{ without }} in the same line");
        fwrite(line, 1, (size_t)(open - line), out);
        *close = '\0';
        place p = {.tables = o->tables, .missing = o->missing};
        for (char *save, *word = strtok_r(open + 2, " ", &save); word && p.n < MAX_WORDS;
             word = strtok_r(NULL, " ", &save))
            p.words[p.n++] = word;
        rp_status status = fill_missing(&p, out) ? RP_OK : fill_place(&p, out);
        if (status) return status;
        line = close + 2;
    }
    fputs(line, out);
    return RP_OK;
}

rp_status cmd_report(int argc, char **argv)
{
    report_options o;
    const char *path;
    int n;
    bool done;
    rp_status status = cli_parse(&command, argc, argv, &o, &path, &n, &done);
    if (status || done) return status;
    FILE *in = fopen(path, "r"), *out;
    if (!in) return rp_fail(RP_BAD_INPUT, "%s: cannot read", path);
    if ((status = rp_file_open(o.output, &out)) != RP_OK) {
        fclose(in);
        return status;
    }
    char *line = NULL;
    size_t room = 0;
    for (int number = 1; !status && getline(&line, &room, in) >= 0; number++)
        if ((status = fill_line(line, &o, out)) != RP_OK) rp_prefix(status, "%s:%d: ", path, number);
    free(line);
    fclose(in);
    return rp_file_close(o.output, out, status);
}
