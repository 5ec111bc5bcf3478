/* Cells of tables by name; see cells.h. */
#include "report/cells.h"
#include "cli/cli.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

rp_status cli_split(const char *text, cli_words *words)
{
    words->n = 0;
    if (strlen(text) >= sizeof words->text) return rp_fail(RP_BAD_INPUT, "\"%.40s...\": too long", text);
    strcpy(words->text, text);
    for (char *save, *word = strtok_r(words->text, " ", &save); word; word = strtok_r(NULL, " ", &save)) {
        if (words->n == CLI_MAX_WORDS)
            return rp_fail(RP_BAD_INPUT, "\"%.40s...\": more than %d words", text, CLI_MAX_WORDS);
        words->words[words->n++] = word;
    }
    return RP_OK;
}

static bool text_equals(const char *cell, const char *wanted)
{
    char *end_a, *end_b;
    const double a = strtod(cell, &end_a), b = strtod(wanted, &end_b);
    if (strcmp(cell, wanted) == 0) return true;
    if (*end_a || !*cell) return false;
    if (*end_b == ':' && end_b > wanted) return a >= b && a <= strtod(end_b + 1, NULL);
    return !*end_b && fabs(a - b) <= 1e-12 * fabs(b);
}

/* The row with the smallest or the largest number of a column, the first of equal ones. */
static bool is_extreme(const rp_table *table, size_t row, int column, double sign)
{
    const double value = sign * strtod(cli_text(table, row, column), NULL);
    bool is = isfinite(value);
    for (size_t r = 0; r < table->n_rows && is; r++) {
        const double other = sign * strtod(cli_text(table, r, column), NULL);
        is = !(other > value || (other == value && r < row));
    }
    return is;
}

rp_status cli_row_matches(const rp_table *table, size_t row, const cli_words *words, int first, int last,
                          bool *matches)
{
    *matches = true;
    for (int w = first; w < last && *matches; w++) {
        char key[128];
        const char *equals = strchr(words->words[w], '=');
        if (!equals) return rp_fail(RP_BAD_INPUT, "\"%s\": key=value expected", words->words[w]);
        snprintf(key, sizeof key, "%.*s", (int)(equals - words->words[w]), words->words[w]);
        int column;
        RP_TRY(rp_table_find(table, key, NULL, &column));
        *matches = strcmp(equals, "=smallest") == 0  ? is_extreme(table, row, column, -1.0)
                   : strcmp(equals, "=largest") == 0 ? is_extreme(table, row, column, 1.0)
                                                     : text_equals(cli_text(table, row, column), equals + 1);
    }
    return RP_OK;
}

bool cli_find_table(const char *folders, const char *name, char path[4096])
{
    for (const char *folder = folders;; folder = strchr(folder, ',') + 1) {
        snprintf(path, 4096, "%.*s/%s.tsv", (int)strcspn(folder, ","), folder, name);
        if (access(path, F_OK) == 0) return true;
        if (!strchr(folder, ',')) return false;
    }
}

static bool read_sweep(const char *path, cli_sweep *sweep)
{
    rp_table *t;
    if (cli_table_read(path, &t)) return false;
    const char *failed = rp_table_find_note(t, "failed");
    snprintf(sweep->failed, sizeof sweep->failed, "%s", failed && strtod(failed, NULL) > 0.0 ? failed : "");
    return rp_table_find_note(t, "sweep");
}

bool cli_find_sweep(const char *folders, const char *table, cli_sweep *sweep)
{
    char path[4096];
    snprintf(sweep->name, sizeof sweep->name, "%.*s", (int)strcspn(table, " "), table);
    for (char *end = sweep->name + strlen(sweep->name); end; end = strrchr(sweep->name, '_')) {
        *end = '\0';
        if (cli_find_table(folders, sweep->name, path) && read_sweep(path, sweep)) return true;
    }
    return false;
}

rp_status cli_cell_find(const char *folders, const char *reference, cli_cell *cell)
{
    *cell = (cli_cell){0};
    RP_TRY(cli_split(reference, &cell->words));
    const cli_words *w = &cell->words;
    if (w->n < 2) return rp_fail(RP_BAD_INPUT, "\"%s\": a table and a column expected", reference);
    cell->column = w->words[w->n - 1];
    cell->missing = !cli_find_table(folders, w->words[0], cell->path);
    if (cell->missing) return RP_OK;
    RP_TRY(cli_table_read(cell->path, &cell->table));
    size_t found = 0;
    for (size_t r = 0; r < cell->table->n_rows; r++) {
        bool matches;
        RP_TRY(cli_row_matches(cell->table, r, w, 1, w->n - 1, &matches));
        if (!matches) continue;
        cell->row = r;
        found++;
    }
    if (found == 1 || cell->column[0] == '#') return RP_OK;
    return rp_fail(RP_BAD_INPUT, "%s: %zu rows for \"%s\", one expected", cell->path, found, reference);
}

const char *cli_cell_text(const cli_cell *cell, const char *column)
{
    const int c = rp_table_column(cell->table, column);
    if (*column == '#') return rp_table_find_note(cell->table, column + 1);
    return c < 0 ? NULL : cli_text(cell->table, cell->row, c);
}

rp_status cli_cell_column(const cli_cell *cell, const char *column, double *value)
{
    const int c = rp_table_column(cell->table, column);
    *value = NAN;
    return c < 0 ? RP_OK : rp_table_number(cell->table, cell->row, c, true, value);
}

/* The number that the header line "# KEY: text" starts with. */
static rp_status note_number(const cli_cell *cell, stats_number *number)
{
    char *end;
    const char *text = cli_cell_text(cell, cell->column);
    *number = (stats_number){text ? strtod(text, &end) : NAN, 0.0};
    if (text && end != text) return RP_OK;
    return rp_fail(RP_BAD_INPUT, "%s: no header line \"%s\" with a number", cell->path, cell->column + 1);
}

bool cli_cell_is_deviation(const cli_cell *cell)
{
    return cli_ends_in(cell->column, "_sd");
}

/* The error of a standard deviation of the table's values: column NAME_sd of NAME_n or n values. */
static rp_status deviation_error(const cli_cell *cell, stats_number *sd)
{
    char own[160];
    double n = NAN;
    snprintf(own, sizeof own, "%.*s_n", (int)strlen(cell->column) - 3, cell->column);
    const char *column = cli_cell_text(cell, own) ? own : "n";
    RP_TRY(cli_cell_column(cell, column, &n));
    sd->se = stats_deviation_error(sd->value, n);
    return RP_OK;
}

rp_status cli_cell_number(const cli_cell *cell, stats_number *number)
{
    const char *name = cell->column;
    if (*name == '#') return note_number(cell, number);
    char mean[160], error[160];
    snprintf(mean, sizeof mean, "%s_mean", name);
    snprintf(error, sizeof error, "%s_se", name);
    if (!cli_cell_text(cell, mean)) snprintf(mean, sizeof mean, "%s", name);
    if (!cli_cell_text(cell, error) && cli_ends_in(name, "_deg"))
        snprintf(error, sizeof error, "%.*s_se_deg", (int)(strlen(name) - strlen("_deg")), name);
    if (!cli_cell_text(cell, mean)) return rp_table_find(cell->table, name, NULL, &(int){0});
    number->se = 0.0;
    RP_TRY(cli_cell_column(cell, mean, &number->value));
    if (cli_cell_text(cell, error)) return cli_cell_column(cell, error, &number->se);
    return cli_cell_is_deviation(cell) ? deviation_error(cell, number) : RP_OK;
}

int cli_decimals(double se)
{
    const int decimals = 1 - (int)floor(log10(se));
    return decimals < 0 ? 0 : decimals;
}

void cli_print_number(FILE *out, stats_number number)
{
    if (isnan(number.value)) {
        fputs("not known", out);
    } else if (isinf(number.value)) {
        fprintf(out, "%g", number.value);
    } else if (isnan(number.se)) {
        fprintf(out, "%.3g (error not known)", number.value);
    } else if (number.se == 0.0) {
        fprintf(out, "%.4g", number.value);
    } else {
        const int decimals = cli_decimals(number.se);
        fprintf(out, "%.*f ± %.*f", decimals, number.value, decimals, number.se);
    }
}

rp_status cli_print_text(FILE *out, const char *text, const char *format)
{
    /* precision and letter alone are taken from the format, so that it cannot be a harmful one */
    int precision = 3, used = 0;
    char letter = 'g', *end;
    if (format && (sscanf(format, "%%.%1d%c%n", &precision, &letter, &used) != 2 || format[used] ||
                   !strchr("fg", letter)))
        return rp_fail(RP_BAD_INPUT, "\"%s\": a format such as %%.3g or %%.0f expected", format);
    const double value = strtod(text, &end);
    if (*end || (!format && !text[strspn(text, "0123456789")]))
        fputs(text, out);
    else
        fprintf(out, letter == 'f' ? "%.*f" : "%.*g", precision, value);
    return RP_OK;
}
