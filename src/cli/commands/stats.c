/* repose stats: statistics of tables on the command line. */
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

static rp_status maximum_of_table(rp_table *table, void *values)
{
    const maximum_options *o = values;
    const size_t draws = (size_t)o->draws, resamples = (size_t)o->bootstrap;
    cli_rows rows;
    stats_summary stats;
    double largest, se;
    RP_TRY(cli_rows_read(table, o->column, &(cli_choice){.any_status = true}, &rows));
    cli_table(stdout);
    rp_table_note(stdout, "rows", "%zu used, %zu left out for nan", rows.n, rows.n_nan);
    const double *v = rows.column[0];
    double *work = cli_memory(2 * rows.n + resamples, sizeof *work);
    rp_status status = stats_mean(rows.n, v, &stats);
    if (!status) status = stats_expected_maximum(rows.n, v, draws, work, &largest);
    if (!status) status = stats_maximum_error(rows.n, v, draws, resamples, cli_random(0), work, &se);
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
    .on_table = maximum_of_table};

/* ---- select ---- */

#define SELECT_OPTIONS(X)                                                                                    \
    X(TEXT, columns, "", "all", "", "columns (a or a,b,...) to print")                                       \
    X(BOOL, bare, "", "false", "", "print the rows without a header")                                        \
    CLI_WHERE(X)

CLI_OPTIONS(select, SELECT_OPTIONS)

static void print_selected_header(const rp_table *t, size_t n, const int columns[])
{
    char(*units)[32] = cli_memory(n, sizeof *units), (*numbers)[12] = cli_memory(n, sizeof *numbers);
    const char *(*header)[2] = cli_memory(n, sizeof *header);
    for (size_t c = 0; c < n; c++) {
        cli_column_unit(t, columns[c], units[c]);
        snprintf(numbers[c], sizeof numbers[c], "%d", columns[c] + 1);
        header[c][0] = t->names[columns[c]] ? t->names[columns[c]] : numbers[c];
        header[c][1] = units[c];
    }
    cli_provenance(stdout);
    rp_table_columns(stdout, n, (const char *const(*)[2])header);
}

static rp_status select_of_table(rp_table *t, void *options)
{
    const select_options *o = options;
    int *columns;
    size_t n;
    RP_TRY(cli_columns(t, o->columns, &n, &columns));
    if (!o->bare) print_selected_header(t, n, columns);
    for (size_t i = 0; i < t->n_rows; i++)
        for (size_t c = 0; c < n; c++) printf("%s%s", cli_text(t, i, columns[c]), c + 1 < n ? "\t" : "\n");
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
    .on_table = select_of_table};

/* ---- group ---- */

static const cli_command *const commands[] = {
    &cmd_stats_fit,         &cmd_stats_trend,     &cmd_stats_size, &cmd_stats_predict, &maximum,
    &cmd_stats_oscillation, &cmd_stats_threshold, &cmd_stats_cost, &select_rows,       NULL};
const cli_command cmd_stats = {"stats", "lines, trends, thresholds and costs from tables of runs",
                               .group = commands};
