/* repose stats maximum: expected largest of a number of values. */
#include "cli/derive/derive.h"
#include "stats/stats.h"

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
    rp_table_header(stdout, "n, mean, sd, draws, maximum, maximum_se, " CLI_FAILED_COLUMNS);
    CLI_ROW_WORD(cli_failed(call->arena, table, NULL, 0, NULL, NULL), (double)rows.n, stats.mean, stats.sd,
                 (double)o->draws, largest, se);
    return RP_OK;
}

const cli_command cmd_stats_maximum = {
    "stats maximum",
    "expected largest of a number of values",
    "TABLE --column COLUMN --draws N [options]",
    "Expected largest of N of a column's values, so that maxima of ensembles of different size compare;\n"
    "maximum_se: bootstrap over the values. TABLE (- for standard input): columns by name, or 1, 2, ...\n"
    "without header; rows with nan are left out.",
    "repose stats maximum piles.tsv --column theta_r3_deg --draws 10",
    maximum_params,
    .refuses = "More draws than values: exit status 1.",
    .derives = true,
    .on_table = maximum_of_table};
