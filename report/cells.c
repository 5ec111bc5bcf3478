/* Cells of tables by name; see cells.h. */
#include "report/cells.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/file.h"
#include "report/verdict.h"

report_words report_split(rp_arena *arena, const char *text)
{
    char *copy = rp_text(arena, "%s", text), *save;
    report_words words = {.word = rp_arena_memory(arena, strlen(text), sizeof *words.word)};
    for (char *word = strtok_r(copy, " ", &save); word; word = strtok_r(NULL, " ", &save))
        words.word[words.n++] = word;
    return words;
}

/* ---- tables ---- */

struct report_read {
    struct report_read *before;
    const char *name;
    rp_table *table;
};

rp_status report_table(report_tables *tables, const char *name, const rp_table **table)
{
    rp_arena *arena = tables->arena;
    *table = NULL;
    for (struct report_read *r = tables->read; r && !*table; r = r->before)
        if (strcmp(r->name, name) == 0) *table = r->table;
    for (const char *folder = tables->folders; folder && !*table; folder = strchr(folder, ',')) {
        const char *path;
        folder += *folder == ',';
        RP_TRY(rp_path(arena, &path, "%.*s/%s.tsv", (int)strcspn(folder, ","), folder, name));
        if (!rp_is_there(path)) continue;
        struct report_read *read = rp_arena_memory(arena, 1, sizeof *read);
        *read = (struct report_read){tables->read, rp_text(arena, "%s", name), NULL};
        RP_TRY(rp_table_keep(arena, path, NULL, &read->table));
        tables->read = read;
        *table = read->table;
    }
    return RP_OK;
}

/* ---- references ---- */

rp_status report_reference_read(rp_arena *arena, const char *text, report_reference **reference)
{
    const char *less = strstr(text, " less ");
    report_reference *first = NULL, **at = &first;
    text = less ? rp_text(arena, "%.*s", (int)(less - text), text) : text;
    for (const char *end; text; text = end ? end + 3 : NULL, at = &(*at)->next) {
        text += strspn(text, " ");
        end = strstr(text, " + ");
        report_reference *r = *at = rp_arena_memory(arena, 1, sizeof *r);
        r->text = end ? rp_text(arena, "%.*s", (int)(end - text), text) : text;
        const report_words w = report_split(arena, r->text);
        if (w.n < 2) return rp_fail(RP_BAD_INPUT, "\"%s\": a table and a column expected", r->text);
        r->table = w.word[0];
        r->column = w.word[w.n - 1];
        r->n = (size_t)w.n - 2;
        r->conditions = rp_arena_memory(arena, r->n, sizeof *r->conditions);
        for (size_t i = 0; i < r->n; i++) r->conditions[i] = w.word[i + 1];
    }
    *reference = first;
    return less ? report_reference_read(arena, less + 6, &first->less) : RP_OK;
}

rp_status report_rows(report_tables *tables, const report_reference *r, const rp_table **table, bool **rows)
{
    RP_TRY(report_table(tables, r->table, table));
    if (!*table) return RP_OK;
    *rows = rp_arena_memory(tables->arena, (*table)->n_rows, sizeof **rows);
    memset(*rows, true, (*table)->n_rows);
    for (size_t i = 0; i < r->n; i++) RP_TRY(rp_rows_mark(*table, r->conditions[i], *rows));
    return RP_OK;
}

/* ---- cells ---- */

rp_status report_cell_find(report_tables *tables, const report_reference *reference, report_cell *cell)
{
    bool *rows;
    size_t found = 0;
    *cell = (report_cell){.column = reference->column};
    RP_TRY(report_rows(tables, reference, &cell->table, &rows));
    if (!cell->table) return RP_OK;
    for (size_t row = 0; row < cell->table->n_rows; row++)
        if (rows[row]) cell->row = row, found++;
    if (found == 1 || *cell->column == '#') return RP_OK;
    return rp_fail(RP_BAD_INPUT, "%s: %zu rows for \"%s\", one expected", cell->table->path, found,
                   reference->text);
}

const char *report_cell_text(const report_cell *cell, const char *column)
{
    if (*column == '#') return rp_table_find_note(cell->table, column + 1);
    const int c = rp_table_column(cell->table, column);
    return c < 0 ? NULL : rp_cell(cell->table, cell->row, c);
}

rp_status report_cell_column(const report_cell *cell, const char *column, double *value)
{
    const int c = rp_table_column(cell->table, column);
    *value = NAN;
    return c < 0 ? RP_OK : rp_table_number(cell->table, cell->row, c, true, value);
}

/* ---- numbers ---- */

/* Length of the name of the cell's column, without this ending. */
static size_t stem(const report_cell *cell, const char *end)
{
    return strlen(cell->column) - (rp_ends_in(cell->column, end) ? strlen(end) : 0);
}

/* The column with another ending instead of `end`; NULL where the table has none. */
static const char *beside(const report_cell *cell, const char *end, const char *ending)
{
    const size_t kept = stem(cell, end);
    char *const *names = cell->table->names;
    for (size_t c = 0; c < cell->table->n_columns; c++)
        if (strncmp(names[c], cell->column, kept) == 0 && strcmp(names[c] + kept, ending) == 0)
            return names[c];
    return NULL;
}

/* The number that the header line "# KEY: text" starts with. */
static rp_status read_note(const report_cell *cell, stats_number *number)
{
    char *end;
    const char *text = report_cell_text(cell, cell->column);
    *number = (stats_number){text ? strtod(text, &end) : NAN, 0.0};
    if (text && end != text) return RP_OK;
    return rp_fail(RP_BAD_INPUT, "%s: no header line \"%s\" with a number", cell->table->path,
                   cell->column + 1);
}

/* How much the scatter about a line exceeds what the errors of its points tell, 1 where it does not; the
 * number of values whose scatter has as many degrees of freedom, NaN where it does not. */
static rp_status read_misfit(const report_cell *cell, double *factor, double *values)
{
    double chi2, dof;
    RP_TRY(report_cell_column(cell, "chi2", &chi2));
    RP_TRY(report_cell_column(cell, "dof", &dof));
    const bool misses = chi2 > dof && dof > 0.0;
    *factor = misses ? sqrt(chi2 / dof) : 1.0, *values = misses ? dof + 1.0 : NAN;
    return RP_OK;
}

/* NAME_mean and NAME_se, or NAME_deg and NAME_se_deg, or NAME and NAME_se; how many values the error is from,
 * NaN where it is not from their scatter. */
static rp_status read_value(const report_cell *cell, double n, stats_number *number, double *values)
{
    const char *mean = beside(cell, "", "_mean"), *error = beside(cell, "", "_se");
    if (!mean) RP_TRY(rp_table_find(cell->table, cell->column, NULL, &(int){0}));
    if (!error && rp_ends_in(cell->column, "_deg")) error = beside(cell, "_deg", "_se_deg");
    RP_TRY(report_cell_column(cell, mean ? mean : cell->column, &number->value));
    number->se = rp_ends_in(cell->column, "_sd") ? report_deviation_error(number->value, n) : 0.0;
    if (!error) return RP_OK;
    double misfit;
    RP_TRY(read_misfit(cell, &misfit, values));
    if (mean) *values = n;
    RP_TRY(report_cell_column(cell, error, &number->se));
    return number->se *= misfit, RP_OK;
}

rp_status report_cell_number(const report_cell *cell, report_number *number)
{
    const char *n = beside(cell, "_sd", "_n");
    double values = NAN;
    RP_TRY(report_cell_column(cell, n ? n : "n", &number->n));
    RP_TRY(*cell->column == '#' ? read_note(cell, &number->shown)
                                : read_value(cell, number->n, &number->shown, &values));
    number->tested = report_of_few(number->shown, values);
    return RP_OK;
}

/* Mean, standard deviation and number of the values. */
static rp_status read_summary(const report_cell *cell, stats_summary *values)
{
    static const char *const endings[] = {"_mean", "_sd", "_n"};
    double numbers[3] = {NAN, NAN, NAN};
    for (size_t k = 0; k < 3; k++) {
        const char *column = beside(cell, "_sd", endings[k]);
        if (column) RP_TRY(report_cell_column(cell, column, &numbers[k]));
        if (isnan(numbers[k]))
            return rp_fail(RP_BAD_INPUT, "%s: no column %.*s%s with a number", cell->table->path,
                           (int)stem(cell, "_sd"), cell->column, endings[k]);
    }
    *values = (stats_summary){.mean = numbers[0], .sd = numbers[1], .n = (size_t)numbers[2]};
    return RP_OK;
}

/* The mean of fitted numbers, which are of no values, weighted by their errors. */
static rp_status read_weighted(size_t n, const report_cell cells[], report_number *number)
{
    double weights = 0.0, sum = 0.0;
    for (size_t k = 0; k < n; k++) {
        report_number one;
        RP_TRY(report_cell_number(&cells[k], &one));
        const double weight = 1.0 / (one.shown.se * one.shown.se);
        weights += weight;
        sum += weight * one.shown.value;
    }
    number->n = NAN;
    number->shown = number->tested = (stats_number){sum / weights, 1.0 / sqrt(weights)};
    return RP_OK;
}

/* The mean of all values of several cells; of columns NAME_sd, their standard deviation. */
static rp_status read_pooled(rp_arena *arena, size_t n, const report_cell cells[], report_number *number)
{
    stats_summary *parts = rp_arena_memory(arena, n, sizeof *parts);
    for (size_t k = 0; k < n; k++) RP_TRY(read_summary(&cells[k], &parts[k]));
    const stats_summary all = stats_pooled(n, parts);
    const bool deviation = rp_ends_in(cells[n - 1].column, "_sd");
    number->n = (double)all.n;
    number->shown = deviation ? (stats_number){all.sd, report_deviation_error(all.sd, number->n)}
                              : (stats_number){all.mean, all.se};
    number->tested = deviation ? number->shown : report_of_few(number->shown, number->n);
    return RP_OK;
}

stats_number report_difference(stats_number a, stats_number b)
{
    return (stats_number){a.value - b.value, hypot(a.se, b.se)};
}

rp_status report_number_find(report_tables *tables, const report_reference *reference, report_cell *cell,
                             report_number *number, bool *missing)
{
    report_number less;
    size_t n = 0;
    *number = (report_number){0};
    for (const report_reference *r = reference; r; r = r->next) n++;
    report_cell *cells = rp_arena_memory(tables->arena, n, sizeof *cells);
    n = 0;
    for (const report_reference *r = reference; r; r = r->next, n++) {
        RP_TRY(report_cell_find(tables, r, &cells[n]));
        *missing |= !cells[n].table;
    }
    if (*missing) return RP_OK;
    *cell = cells[n - 1];
    RP_TRY(n == 1                        ? report_cell_number(cell, number)
           : beside(cells, "_sd", "_sd") ? read_pooled(tables->arena, n, cells, number)
                                         : read_weighted(n, cells, number));
    if (!reference->less) return RP_OK;
    RP_TRY(report_number_find(tables, reference->less, cell, &less, missing));
    number->shown = report_difference(number->shown, less.shown);
    number->tested = report_difference(number->tested, less.tested);
    return RP_OK;
}

/* ---- numbers as text ---- */

int report_decimals(double se)
{
    const int decimals = 1 - (int)floor(log10(se));
    return decimals < 0 ? 0 : decimals;
}

const char *report_number_text(rp_arena *arena, stats_number number)
{
    if (isnan(number.value)) return "not known";
    if (isinf(number.value)) return rp_text(arena, "%g", number.value);
    if (isnan(number.se)) return rp_text(arena, "%.3g (error not known)", number.value);
    if (number.se == 0.0) return rp_text(arena, "%.4g", number.value);
    const int decimals = report_decimals(number.se);
    return rp_text(arena, "%.*f ± %.*f", decimals, number.value, decimals, number.se);
}
