/* repose stats: statistics of tables on the command line. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "stats/stats.h"
#include "cli/cli.h"
#include "core/random.h"

#define N_OF(array) (sizeof(array) / sizeof *(array))

/* ---- maximum ---- */

typedef struct {
    const char *column;
    long draws, bootstrap, seed;
    rp_texts where;
} maximum_options;

static const rp_param maximum_params[] = {
    {"column", "", RP_TEXT, offsetof(maximum_options, column), NULL, "", "column of the values"},
    {"draws", "", RP_INT, offsetof(maximum_options, draws), NULL, "[1, 10000000]",
     "number of values that the maximum is taken of"},
    {"bootstrap", "", RP_INT, offsetof(maximum_options, bootstrap), "2000", "[2, 10000000]",
     "resamples of the values"},
    CLI_SEED(maximum_options, "1993", "seed of the resamples"),
    CLI_WHERE(maximum_options),
    {0}};

static rp_status print_maximum(size_t n, const double v[], double work[], const maximum_options *o)
{
    stats_summary stats;
    double largest, se = NAN;
    gsl_rng *rng = rp_random_alloc((unsigned long)o->seed, 0, RP_PURPOSE_BOOTSTRAP);
    rp_status status = rng ? stats_mean(n, v, &stats) : rp_fail(RP_NO_MEMORY, "maximum: out of memory");
    if (!status) status = stats_expected_maximum(n, v, (size_t)o->draws, work, &largest);
    if (!status) status = stats_maximum_error(n, v, (size_t)o->draws, (size_t)o->bootstrap, rng, work, &se);
    if (rng) gsl_rng_free(rng);
    if (status) return status;
    rp_table_header(stdout, "n, mean, sd, draws, maximum, maximum_se");
    CLI_ROW((double)n, stats.mean, stats.sd, (double)o->draws, largest, se);
    return RP_OK;
}

static rp_status maximum_of_table(rp_table *table, const void *options)
{
    const maximum_options *o = options;
    double *values = NULL;
    rp_status status = cli_read_named(table, o->column, 1, &values);
    double *work = malloc((2 * table->n_rows + (size_t)o->bootstrap) * sizeof *work);
    if (!status && !work) status = rp_fail(RP_NO_MEMORY, "%s: out of memory", table->path);
    if (!status) {
        size_t n = 0;
        for (size_t i = 0; i < table->n_rows; i++)
            if (!isnan(values[i])) values[n++] = values[i];
        cli_table(stdout, maximum_params, o);
        rp_table_note(stdout, "rows", "%zu used, %zu left out for nan", n, table->n_rows - n);
        status = print_maximum(n, values, work, o);
        if (status) rp_prefix(status, "%s: ", table->path);
    }
    free(work);
    free(values);
    return status;
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

typedef struct {
    const char *columns;
    bool bare;
    rp_texts where;
} select_options;

static const rp_param select_params[] = {
    {"columns", "", RP_TEXT, offsetof(select_options, columns), "all", "", "columns (a or a,b,...) to print"},
    {"bare", "", RP_BOOL, offsetof(select_options, bare), "false", "", "print the rows without a header"},
    CLI_WHERE(select_options),
    {0}};

enum { MOST_COLUMNS = 1024 };

static void print_selected_header(const rp_table *t, size_t n, const int columns[])
{
    static char units[MOST_COLUMNS][32];
    static const char *header[MOST_COLUMNS][2];
    for (size_t c = 0; c < n; c++) {
        cli_column_unit(t, columns[c], units[c]);
        header[c][0] = t->names[columns[c]];
        header[c][1] = units[c];
    }
    cli_table(stdout, NULL, NULL);
    if (t->names[0]) rp_table_columns(stdout, n, (const char *const(*)[2])header);
}

static rp_status select_of_table(rp_table *t, const void *options)
{
    const select_options *o = options;
    static int columns[MOST_COLUMNS];
    size_t n = t->n_columns;
    if (n > MOST_COLUMNS)
        return rp_fail(RP_BAD_INPUT, "%s: %zu columns, at most %d", t->path, n, MOST_COLUMNS);
    for (size_t c = 0; c < n; c++) columns[c] = (int)c;
    rp_status status = RP_OK;
    if (strcmp(o->columns, "all") != 0) status = cli_column_list(t, o->columns, MOST_COLUMNS, &n, columns);
    if (status) return status;
    if (!o->bare) print_selected_header(t, n, columns);
    for (size_t i = 0; i < t->n_rows; i++)
        for (size_t c = 0; c < n; c++)
            printf("%s%s", t->cells[i * t->n_columns + (size_t)columns[c]], c + 1 < n ? "\t" : "\n");
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
    &cmd_stats_fit,       &cmd_stats_trend, &cmd_stats_size, &maximum,
    &cmd_stats_threshold, &cmd_stats_cost,  &select_rows,    NULL};
const cli_command cmd_stats = {"stats", "lines, trends, thresholds and costs from tables of runs",
                               .group = commands};
