/* repose stats: statistics of tables on the command line. */
#include <string.h>

#include "stats/stats.h"
#include "cli/cli.h"

/* ---- maximum ---- */

#define MAXIMUM_OPTIONS(X)                                                                                   \
    X(TEXT, column, "", NULL, "", "column of the values")                                                    \
    X(INT, draws, "", NULL, "[1, 10000000]", "number of values that the maximum is taken of")                \
    X(INT, bootstrap, "", "2000", "[2, 10000000]", "resamples of the values")                                \
    CLI_SEED(X, "1993", "seed of the resamples")                                                             \
    CLI_WHERE(X)

CLI_OPTIONS(maximum, MAXIMUM_OPTIONS)

static rp_status maximum_of_table(cli_call *call, rp_table *table, const void *values)
{
    const maximum_options *o = values;
    const size_t draws = (size_t)o->draws, resamples = (size_t)o->bootstrap;
    rp_rows rows;
    stats_summary stats;
    double largest, se;
    RP_TRY(rp_rows_read(call->arena, table, o->column, &(rp_choice){.any_status = true}, &rows));
    cli_table(call, stdout);
    rp_table_note(stdout, "rows", "%zu used, %zu left out for nan", rows.n, rows.n_nan);
    const double *v = rows.column[0];
    double *work = rp_arena_memory(call->arena, 2 * rows.n + resamples, sizeof *work);
    rp_status status = stats_mean(rows.n, v, &stats);
    if (!status) status = stats_expected_maximum(rows.n, v, draws, work, &largest);
    if (!status) status = stats_maximum_error(rows.n, v, draws, resamples, cli_random(call, 0), work, &se);
    RP_TRY(rp_prefix(status, "%s: ", table->path));
    rp_table_header(stdout, "n, mean, sd, draws, maximum, maximum_se");
    CLI_ROW((double)rows.n, stats.mean, stats.sd, (double)o->draws, largest, se);
    return RP_OK;
}

static const cli_command maximum = {
    "stats maximum",
    "expected largest of a number of values",
    "TABLE --column COLUMN --draws N [options]",
    "Expected largest of N of a column's values, so that maxima of ensembles of different size compare;\n"
    "maximum_se: bootstrap over the values. TABLE (- for standard input): columns by name, or 1, 2, ...\n"
    "without header; rows with nan are left out.",
    "repose stats maximum piles.tsv --column theta_r3_deg --draws 10",
    maximum_params,
    .refuses = "More draws than values: exit status 1.",
    .on_table = maximum_of_table};

/* ---- correlation ---- */

#define CORRELATION_OPTIONS(X)                                                                               \
    X(TEXT, x, "", NULL, "", "columns (a or a,b,...) that may be correlated with y")                         \
    X(TEXT, y, "", NULL, "", "column of y")                                                                  \
    CLI_BY(X, "none", "groups")                                                                              \
    CLI_WHERE(X)

CLI_OPTIONS(correlation, CORRELATION_OPTIONS)

/* A row for each group of the rows, y before the columns of x. */
static rp_status print_correlations(const rp_groups *groups, const rp_rows *rows, size_t x, const char *name)
{
    for (size_t g = 0; g < rows->n_groups; g++) {
        const size_t first = rows->first[g];
        stats_correlation c;
        RP_TRY(stats_correlate(rows->first[g + 1] - first, rows->column[x] + first, rows->column[0] + first,
                               &c));
        if (*groups->words[g]) printf("%s\t", groups->words[g]);
        CLI_ROW_WORD(name, (double)c.n, c.value, c.se, c.lo, c.hi);
    }
    return RP_OK;
}

static rp_status correlation_of_table(cli_call *call, rp_table *table, const void *values)
{
    const correlation_options *o = values;
    const size_t size = strlen(o->x) + strlen(o->y) + 2;
    char *names = rp_arena_memory(call->arena, size, 1), *rest = names;
    rp_groups groups;
    rp_rows rows;
    snprintf(names, size, "%s,%s", o->y, o->x);
    RP_TRY(rp_group_rows(call->arena, table, o->by, '\t', &groups));
    RP_TRY(rp_rows_read(call->arena, table, names, &(rp_choice){.groups = &groups}, &rows));
    cli_table(call, stdout);
    rp_table_note(stdout, "rows", "%zu used, %zu without result, %zu with nan", rows.n, rows.n_failed,
                  rows.n_nan);
    rp_status status = rp_header_by(
        table, o->by, "n, correlation, correlation_se, correlation_lo, correlation_hi, quantity");
    strsep(&rest, ",");
    for (size_t x = 1; rest && !status; x++)
        status = print_correlations(&groups, &rows, x, strsep(&rest, ","));
    return rp_prefix(status, "%s: ", table->path);
}

static const cli_command correlation = {
    "stats correlation",
    "correlation of columns, over runs",
    "TABLE -x COLUMNS -y COLUMN [options]",
    "Pearson's correlation of each column of x with y, one row a column and group, with its 95 % interval\n"
    "by Fisher's transformation. Rows with nan in a column are left out for all. TABLE (- for standard\n"
    "input): one row per run, as repose sweep export writes.",
    "repose stats correlation build/studies/lh_onset_runs.tsv -x bulk_friction_0,limit_probe -y "
    "theta_t_displacement_deg --by mu",
    correlation_params,
    .refuses = "Fewer than 4 rows in a group: exit status 1.",
    .on_table = correlation_of_table};

/* ---- select ---- */

#define SELECT_OPTIONS(X)                                                                                    \
    X(TEXT, columns, "", "all", "", "columns (a or a,b,...) to print")                                       \
    X(BOOL, bare, "", "false", "", "print the rows without a header")                                        \
    CLI_WHERE(X)

CLI_OPTIONS(select, SELECT_OPTIONS)

static void print_selected_header(const cli_call *call, const rp_table *t, size_t n, const int columns[])
{
    char(*units)[32] = rp_arena_memory(call->arena, n, sizeof *units),
    (*numbers)[12] = rp_arena_memory(call->arena, n, sizeof *numbers);
    const char *(*header)[2] = rp_arena_memory(call->arena, n, sizeof *header);
    for (size_t c = 0; c < n; c++) {
        rp_column_unit(t, columns[c], units[c]);
        snprintf(numbers[c], sizeof numbers[c], "%d", columns[c] + 1);
        header[c][0] = t->names[columns[c]] ? t->names[columns[c]] : numbers[c];
        header[c][1] = units[c];
    }
    cli_provenance(call, stdout);
    rp_table_columns(stdout, n, (const char *const(*)[2])header);
}

static rp_status select_of_table(cli_call *call, rp_table *t, const void *options)
{
    const select_options *o = options;
    int *columns;
    size_t n;
    RP_TRY(rp_columns(call->arena, t, o->columns, &n, &columns));
    if (!o->bare) print_selected_header(call, t, n, columns);
    for (size_t i = 0; i < t->n_rows; i++)
        for (size_t c = 0; c < n; c++) printf("%s%s", rp_cell(t, i, columns[c]), c + 1 < n ? "\t" : "\n");
    return RP_OK;
}

static const cli_command select_rows = {
    "stats select",
    "rows and columns of a table",
    "TABLE [options]",
    "Rows and columns of a table, its cells unchanged. TABLE (- for standard input); several tables\n"
    "with the same columns, one after the other, are read as one.",
    "repose stats select build/tables/li_disorder_runs.tsv --where 'eps<1e-5' --columns disorder,D",
    select_params,
    .refuses = "A column that the table lacks.",
    .on_table = select_of_table};

/* ---- group ---- */

static const cli_command *const commands[] = {
    &cmd_stats_fit, &cmd_stats_trend, &cmd_stats_size, &maximum, &correlation, &select_rows, NULL};
const cli_command cmd_stats = {"stats", "lines, trends, limits and correlations from tables of runs",
                               .group = commands};
