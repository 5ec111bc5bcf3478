/* repose stats threshold, repose stats cost: settings of a sweep compared by its runs. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "stats/stats.h"
#include "cli/cli.h"

#define N_OF(array) (sizeof(array) / sizeof *(array))

/* ---- threshold ---- */

typedef struct {
    const char *x, *by, *most;
    rp_texts where;
} threshold_options;

static const rp_param threshold_params[] = {
    CLI_TEXT(threshold_options, x, NULL, "column of x"),
    CLI_BY(threshold_options, "none", "groups"),
    {"most", "", RP_TEXT, offsetof(threshold_options, most), "none", "",
     "column whose largest number among rows with result is printed too"},
    CLI_WHERE(threshold_options),
    {0}};

static rp_status print_thresholds(const rp_table *t, const threshold_options *o, const cli_groups *g,
                                  const double *block, const int columns[2], int status_column)
{
    char own[256], unit[32];
    const size_t n = t->n_rows;
    const bool most = columns[1] >= 0, grouped = strcmp(o->by, "none") != 0;
    double *x = malloc((n + 1) * sizeof *x);
    bool *holds = malloc((n + 1) * sizeof *holds);
    rp_status status = x && holds ? RP_OK : rp_fail(RP_NO_MEMORY, "threshold: out of memory");
    cli_column_unit(t, columns[0], unit);
    snprintf(own, sizeof own, "n, unstable_%s [%s], stable_%s [%s], mixed%s%s", o->x, unit, o->x, unit,
             most ? ", " : "", most ? o->most : "");
    cli_table(stdout, threshold_params, o);
    if (!status) status = cli_header_by(t, o->by, own);
    for (size_t k = 0; k < g->n_groups && !status; k++) {
        stats_threshold threshold;
        double largest = 0.0;
        size_t used = 0;
        for (size_t i = 0; i < n; i++) {
            if (g->of_row[i] != k) continue;
            holds[used] = strcmp(t->cells[i * t->n_columns + (size_t)status_column], "ok") == 0;
            if (most && holds[used]) largest = fmax(largest, block[n + i]);
            x[used++] = block[i];
        }
        stats_threshold_find(used, x, holds, &threshold);
        if (grouped) printf("%s\t", g->words[k]);
        rp_table_row(stdout, most ? 5 : 4,
                     (double[]){(double)used, threshold.fails_to, threshold.holds_from,
                                (double)threshold.mixed, largest});
    }
    free(x);
    free(holds);
    return status;
}

static rp_status threshold_of_table(rp_table *t, const void *values)
{
    const threshold_options *o = values;
    const bool most = strcmp(o->most, "none") != 0;
    const char *const names[] = {o->x, o->most};
    int columns[2] = {-1, -1}, status_column;
    double *block = NULL;
    cli_groups groups = {0};
    rp_status status = cli_find_columns(t, most ? 2 : 1, names, columns);
    if (!status) status = cli_find_columns(t, 1, (const char *const[]){"status"}, &status_column);
    if (!status) status = cli_group_rows(t, o->by, '\t', &groups);
    if (!status) status = cli_read_columns(t, 2, columns, 1, &block);
    if (!status) status = print_thresholds(t, o, &groups, block, columns, status_column);
    cli_groups_free(&groups);
    free(block);
    return status;
}

const cli_command cmd_stats_threshold = {
    "stats threshold",
    "where runs cease to fail as a parameter grows",
    "TABLE -x COLUMN [options]",
    "Where runs cease to fail as x grows, one row a group: unstable_x, the largest x of a row whose status\n"
    "is not ok; stable_x, the smallest x of one whose status is ok (x is the column's name); nan where\n"
    "there is no such row. mixed: rows with status ok below unstable_x. TABLE (- for standard input): one\n"
    "row a run.",
    "repose stats threshold build/tables/li_smooth_runs.tsv -x mu --by alpha_deg,well",
    threshold_params,
    .on_table = threshold_of_table};

/* ---- cost ---- */

typedef struct {
    const char *y, *by, *size;
    rp_texts where;
} cost_options;

static const rp_param cost_params[] = {CLI_TEXT(cost_options, y, NULL, "column of y"),
                                       CLI_BY(cost_options, NULL, "settings"),
                                       {"size", "", RP_TEXT, offsetof(cost_options, size), "none", "",
                                        "columns that decide how long a step takes: the width of the box"},
                                       CLI_WHERE(cost_options),
                                       {0}};

static rp_status print_costs(const rp_table *t, const cost_options *o, const cli_groups *g,
                             const stats_cost costs[], int y_column)
{
    char own[256], unit[32];
    cli_column_unit(t, y_column, unit);
    snprintf(own, sizeof own, "n, mean [%s], sd [%s], bias [%s], bias_se [%s], seconds [s], cost [s], front",
             unit, unit, unit, unit);
    cli_table(stdout, cost_params, o);
    rp_status status = cli_header_by(t, o->by, own);
    for (size_t s = 0; s < g->n_groups && !status; s++) {
        const stats_cost *c = &costs[s];
        printf("%s\t", g->words[s]);
        CLI_ROW((double)c->n, c->mean, c->sd, c->bias, c->bias_se, c->seconds, c->cost, c->front);
    }
    return status;
}

static rp_status cost_of_table(rp_table *t, const void *values)
{
    const cost_options *o = values;
    const char *const names[] = {o->y, "replica", "seconds", "steps"};
    int columns[N_OF(names)];
    double *block = NULL;
    cli_groups settings = {0}, sizes = {0};
    rp_status status = rp_table_where(t, "status=ok");
    if (!status && t->n_rows == 0) status = rp_fail(RP_NO_RESULT, "%s: no row with status ok", t->path);
    if (!status) status = cli_find_columns(t, N_OF(names), names, columns);
    if (!status) status = cli_group_rows(t, o->by, '\t', &settings);
    if (!status) status = cli_group_rows(t, o->size, '\t', &sizes);
    if (!status) status = cli_read_columns(t, N_OF(names), columns, 0, &block);
    const size_t n = t->n_rows;
    stats_cost_run *runs = malloc((n + 1) * sizeof *runs);
    stats_cost *costs = malloc((settings.n_groups + 1) * sizeof *costs);
    if (!status && !(runs && costs)) status = rp_fail(RP_NO_MEMORY, "cost: out of memory");
    for (size_t i = 0; i < n && !status; i++)
        runs[i] = (stats_cost_run){settings.of_row[i], sizes.of_row[i],  block[n + i],
                                   block[i],           block[2 * n + i], block[3 * n + i]};
    if (!status) status = stats_costs(n, runs, settings.n_groups, settings.n_groups - 1, costs);
    if (!status) status = print_costs(t, o, &settings, costs, columns[0]);
    free(runs);
    free(costs);
    cli_groups_free(&settings);
    cli_groups_free(&sizes);
    free(block);
    return status;
}

const cli_command cmd_stats_cost = {
    "stats cost",
    "time that a standard error of 1 takes, by setting",
    "TABLE -y COLUMN --by COLUMNS [options]",
    "Time that a standard error of 1 in y takes, one row a setting. sd: of y over its runs; bias: mean\n"
    "difference to the setting of the last row, on the same replicas; seconds: for a mean run, the\n"
    "least time of a step over all runs of one size times its steps; cost: sd^2 seconds; front: 1 where\n"
    "no other setting has both less cost and less bias. TABLE (- for standard input): one row a run,\n"
    "columns replica, seconds, steps, status; rows whose status is not ok are left out.",
    "repose stats cost build/tables/val_cost_runs.tsv -y theta_r3_deg --by W,dt,rest_energy --size W",
    cost_params,
    .on_table = cost_of_table};
