/* Columns of a table as arrays of numbers, groups of rows; see cli.h. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cli/cli.h"

rp_status cli_find_columns(const rp_table *table, size_t n, const char *const names[], int columns[])
{
    for (size_t c = 0; c < n; c++)
        if ((columns[c] = rp_table_column(table, names[c])) < 0)
            return rp_fail(RP_BAD_INPUT, "%s: no column \"%s\"", table->path, names[c]);
    return RP_OK;
}

rp_status cli_read_columns(const rp_table *table, size_t n, const int columns[], int missing_ok,
                           double **block)
{
    *block = malloc((n * table->n_rows + 1) * sizeof **block);
    if (!*block) return rp_fail(RP_NO_MEMORY, "%s: out of memory", table->path);
    for (size_t c = 0; c < n; c++)
        for (size_t i = 0; columns[c] >= 0 && i < table->n_rows; i++) {
            rp_status status =
                rp_table_number(table, i, columns[c], missing_ok, *block + c * table->n_rows + i);
            if (status) return status;
        }
    return RP_OK;
}

enum { MOST_BY = 24 };

rp_status cli_column_list(const rp_table *table, const char *names, size_t most, size_t *n, int columns[])
{
    *n = 0;
    for (const char *name = names; *name; name += strcspn(name, ","), name += *name == ',') {
        char word[64];
        if (*n == most) return rp_fail(RP_BAD_INPUT, "\"%s\": at most %zu columns", names, most);
        snprintf(word, sizeof word, "%.*s", (int)strcspn(name, ","), name);
        rp_status status = cli_find_columns(table, 1, (const char *const[]){word}, &columns[(*n)++]);
        if (status) return status;
    }
    return *n > 0 ? RP_OK : rp_fail(RP_BAD_INPUT, "\"%s\": a column expected", names);
}

rp_status cli_read_named(const rp_table *table, const char *names, int missing_ok, double **block)
{
    int columns[CLI_MOST_COLUMNS];
    size_t n;
    rp_status status = cli_column_list(table, names, CLI_MOST_COLUMNS, &n, columns);
    return status ? status : cli_read_columns(table, n, columns, missing_ok, block);
}

rp_status cli_read_file(const char *path, const char *names, double **block, size_t *n_rows)
{
    rp_table table;
    rp_status status = rp_table_read(path, &table);
    if (!status) status = cli_read_named(&table, names, false, block);
    *n_rows = table.n_rows;
    rp_table_free(&table);
    return status;
}

/* Rows of numbers by the first; the last is the row's index. */
static size_t row_length;

static int by_first(const void *a, const void *b)
{
    const double *p = a, *q = b;
    return p[0] != q[0] ? (p[0] > q[0]) - (p[0] < q[0])
                        : (p[row_length - 1] > q[row_length - 1]) - (p[row_length - 1] < q[row_length - 1]);
}

rp_status cli_rows_read(const rp_table *t, const char *names, bool grouped, cli_rows *r)
{
    int columns[CLI_MOST_COLUMNS];
    const int word = rp_table_column(t, "status");
    size_t k;
    *r = (cli_rows){0};
    rp_status status = cli_column_list(t, names, CLI_MOST_COLUMNS, &k, columns);
    if (status) return status;
    row_length = k + 1;
    double *rows = malloc((t->n_rows + 1) * row_length * sizeof *rows);
    r->column[0] = malloc((t->n_rows * k + 1) * sizeof **r->column);
    if (!rows || !r->column[0]) status = rp_fail(RP_NO_MEMORY, "%s: out of memory", t->path);
    for (size_t i = 0; i < t->n_rows && !status; i++) {
        double *row = rows + r->n * row_length;
        bool missing = word >= 0 && strncmp(t->cells[i * t->n_columns + (size_t)word], "ok", 2) != 0;
        for (size_t c = 0; c < k && !missing && !status; c++) {
            status = rp_table_number(t, i, columns[c], true, &row[c]);
            missing = grouped && isnan(row[c]);
        }
        row[k] = (double)i;
        r->n += !missing;
    }
    if (!status && r->n == 0)
        status = rp_fail(RP_NO_RESULT, "%s: no row with status ok and numbers for %s", t->path, names);
    if (!status && grouped) qsort(rows, r->n, row_length * sizeof *rows, by_first);
    for (size_t c = 0; c < k && !status; c++) {
        r->column[c] = r->column[0] + c * r->n;
        for (size_t i = 0; i < r->n; i++) r->column[c][i] = rows[i * row_length + c];
    }
    free(rows);
    return status;
}

void cli_rows_free(cli_rows *r)
{
    free(r->column[0]);
}

size_t cli_rows_end(const cli_rows *r, size_t first)
{
    size_t end = first;
    while (end < r->n && r->column[0][end] == r->column[0][first]) end++;
    return end;
}

void cli_rows_note(const rp_table *table, const cli_rows *rows)
{
    rp_table_note(stdout, "rows", "%zu used, %zu left out", rows->n, table->n_rows - rows->n);
}

void cli_column_unit(const rp_table *table, int column, char unit[32])
{
    const char *units = rp_table_find_note(table, "units");
    for (int c = 0; units && c < column; c++) units = (units = strchr(units, '\t')) ? units + 1 : NULL;
    const int length = units ? (int)strcspn(units, "\t\r") : 0;
    snprintf(unit, 32, "%.*s", length ? length : 1, length ? units : "1");
}

rp_status cli_header_by(const rp_table *table, const char *by, const char *own)
{
    char text[4096], unit[32];
    int columns[MOST_BY];
    size_t n = 0, used = 0;
    rp_status status = strcmp(by, "none") ? cli_column_list(table, by, MOST_BY, &n, columns) : RP_OK;
    for (size_t i = 0; i < n && !status; i++) {
        const char *name = table->names[columns[i]];
        cli_column_unit(table, columns[i], unit);
        used += (size_t)snprintf(text + used, sizeof text - used, "%.100s [%s], ", name ? name : "1", unit);
    }
    snprintf(text + used, sizeof text - used, "%s", own);
    if (!status) rp_table_header(stdout, text);
    return status;
}

rp_status cli_group_rows(const rp_table *t, const char *by, char separator, cli_groups *g)
{
    const bool grouped = strcmp(by, "none") != 0;
    size_t n_by = 0, length = 1;
    int columns[MOST_BY];
    *g = (cli_groups){0};
    rp_status status = grouped ? cli_column_list(t, by, MOST_BY, &n_by, columns) : RP_OK;
    if (status) return status;
    for (size_t i = 0; i < t->n_rows; i++)
        for (size_t k = 0; k < n_by; k++)
            length += strlen(t->cells[i * t->n_columns + (size_t)columns[k]]) + 1;
    g->labels = malloc(length + t->n_rows);
    g->of_row = malloc((t->n_rows + 1) * sizeof *g->of_row);
    g->words = malloc((t->n_rows + 1) * sizeof *g->words);
    if (!(g->labels && g->of_row && g->words)) return rp_fail(RP_NO_MEMORY, "%s: out of memory", t->path);
    char *label = g->labels;
    for (size_t i = 0; i < t->n_rows; i++) {
        char *end = label;
        *end = '\0';
        for (size_t k = 0; k < n_by; k++) {
            if (k) *end++ = separator;
            end = stpcpy(end, t->cells[i * t->n_columns + (size_t)columns[k]]);
        }
        size_t group = 0;
        while (group < g->n_groups && strcmp(g->words[group], label) != 0) group++;
        g->of_row[i] = group;
        if (group < g->n_groups) continue; /* the label's bytes are used again */
        g->words[g->n_groups++] = label;
        label = end + 1;
    }
    return RP_OK;
}

void cli_groups_free(cli_groups *g)
{
    free(g->labels);
    free(g->of_row);
    free(g->words);
    *g = (cli_groups){0};
}
