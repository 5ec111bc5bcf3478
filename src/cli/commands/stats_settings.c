/* repose stats threshold, repose stats cost: settings of a sweep compared by its runs. */
#include <string.h>

#include "stats/stats.h"
#include "cli/cli.h"

/* ---- threshold ---- */

#define THRESHOLD_OPTIONS(X)                                                                                 \
    X(TEXT, x, "", NULL, "", "column of x")                                                                  \
    CLI_BY(X, "none", "groups")                                                                              \
    X(TEXT, most, "", "none", "", "column whose largest number among rows with result is printed too")       \
    CLI_WHERE(X)

CLI_OPTIONS(threshold, THRESHOLD_OPTIONS)

static rp_status threshold_of_table(rp_table *t, void *values)
{
    const threshold_options *o = values;
    const bool most = strcmp(o->most, "none") != 0;
    char own[256], unit[32], names[256];
    int x_column, status_column;
    cli_groups groups;
    cli_rows rows;
    snprintf(names, sizeof names, most ? "%s,%s" : "%s", o->x, o->most);
    RP_TRY(cli_find_column(t, o->x, &x_column));
    RP_TRY(cli_find_column(t, "status", &status_column));
    RP_TRY(cli_group_rows(t, o->by, '\t', &groups));
    const cli_choice choice = {.any_status = true, .any_number = true, .groups = &groups};
    RP_TRY(cli_rows_read(t, names, &choice, &rows));
    bool *holds = cli_memory(rows.n, sizeof *holds);
    cli_column_unit(t, x_column, unit);
    snprintf(own, sizeof own, "n, unstable_%s [%s], stable_%s [%s], mixed%s%s", o->x, unit, o->x, unit,
             most ? ", " : "", most ? o->most : "");
    cli_table(stdout);
    RP_TRY(cli_header_by(t, o->by, own));
    for (size_t g = 0; g < rows.n_groups; g++) {
        const size_t first = rows.first[g], n = rows.first[g + 1] - first;
        stats_threshold threshold;
        double largest = 0.0;
        for (size_t i = first; i < first + n; i++) {
            holds[i] = strcmp(cli_text(t, rows.row[i], status_column), "ok") == 0;
            if (most && holds[i]) largest = fmax(largest, rows.column[1][i]);
        }
        stats_threshold_find(n, rows.column[0] + first, holds + first, &threshold);
        if (*groups.words[g]) printf("%s\t", groups.words[g]);
        rp_table_row(stdout, most ? 5 : 4,
                     (double[]){(double)n, threshold.fails_to, threshold.holds_from, (double)threshold.mixed,
                                largest});
    }
    return RP_OK;
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

#define COST_OPTIONS(X)                                                                                      \
    X(TEXT, y, "", NULL, "", "column of y")                                                                  \
    CLI_BY(X, NULL, "settings")                                                                              \
    X(TEXT, size, "", "none", "", "columns that decide how long a step takes: the width of the box")         \
    CLI_WHERE(X)

CLI_OPTIONS(cost, COST_OPTIONS)

static rp_status print_costs(const rp_table *t, const cost_options *o, const cli_groups *g,
                             const stats_cost costs[], int y_column)
{
    char own[256], unit[32];
    cli_column_unit(t, y_column, unit);
    snprintf(own, sizeof own, "n, mean [%s], sd [%s], bias [%s], bias_se [%s], seconds [s], cost [s], front",
             unit, unit, unit, unit);
    cli_table(stdout);
    RP_TRY(cli_header_by(t, o->by, own));
    for (size_t s = 0; s < g->n_groups; s++) {
        const stats_cost *c = &costs[s];
        printf("%s\t", g->words[s]);
        CLI_ROW((double)c->n, c->mean, c->sd, c->bias, c->bias_se, c->seconds, c->cost, c->front);
    }
    return RP_OK;
}

static rp_status cost_of_table(rp_table *t, void *values)
{
    const cost_options *o = values;
    char names[256];
    int y_column;
    double *v = NULL;
    cli_groups settings, sizes;
    RP_TRY(rp_table_where(t, "status=ok"));
    if (t->n_rows == 0) return rp_fail(RP_NO_RESULT, "%s: no row with status ok", t->path);
    snprintf(names, sizeof names, "%s,replica,seconds,steps", o->y);
    RP_TRY(cli_read_columns(t, names, &v));
    RP_TRY(cli_find_column(t, o->y, &y_column));
    RP_TRY(cli_group_rows(t, o->by, '\t', &settings));
    RP_TRY(cli_group_rows(t, o->size, '\t', &sizes));
    const size_t n = t->n_rows;
    stats_cost_run *runs = cli_memory(n, sizeof *runs);
    stats_cost *costs = cli_memory(settings.n_groups, sizeof *costs);
    for (size_t i = 0; i < n; i++)
        runs[i] =
            (stats_cost_run){settings.of_row[i], sizes.of_row[i], v[n + i], v[i], v[2 * n + i], v[3 * n + i]};
    RP_TRY(stats_costs(n, runs, settings.n_groups, settings.n_groups - 1, costs));
    return print_costs(t, o, &settings, costs, y_column);
}

const cli_command cmd_stats_cost = {
    "stats cost",
    "time that a standard error of 1 takes, by setting",
    "TABLE -y COLUMN --by COLUMNS [options]",
    "Time that a standard error of 1 in y takes, one row a setting. sd: of y over its runs; bias: mean\n"
    "difference to the setting of the last row, on the same replicas; seconds: for a mean run, the\n"
    "least time of a step over all runs of one size times its steps; cost: sd^2 seconds; front: 1 where\n"
    "no other setting has both less cost and less bias. TABLE (- for standard input): one row a run,\n"
    "columns replica, seconds, steps, status; rows whose status is not ok are left\n"
    "out.",
    "repose stats cost build/tables/val_cost_runs.tsv -y theta_r3_deg --by W,dt,rest_energy --size W",
    cost_params,
    .on_table = cost_of_table};
