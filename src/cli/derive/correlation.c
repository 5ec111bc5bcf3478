/* repose stats correlation: correlation of columns, over runs. */
#include <string.h>

#include "cli/derive/derive.h"
#include "stats/stats.h"

#define CORRELATION_OPTIONS(X)                                                                               \
    X(TEXT, x, "", NULL, "", "columns (a or a,b,...) that may be correlated with y")                         \
    X(TEXT, y, "", NULL, "", "column of y")                                                                  \
    CLI_BY(X, "none", "groups")                                                                              \
    CLI_WHERE(X)

CLI_OPTIONS(correlation, CORRELATION_OPTIONS)

/* A row for each group of the rows, y before the columns of x; *found: one has a result, else it is the
 * status. */
static rp_status print_correlations(const cli_call *call, const rp_table *table, const rp_groups *groups,
                                    const rp_rows *rows, size_t x, const char *name, bool *found)
{
    rp_status status = RP_OK;
    for (size_t g = 0; g < rows->n_groups; g++) {
        const size_t first = rows->first[g];
        stats_correlation c;
        status =
            stats_correlate(rows->first[g + 1] - first, rows->column[x] + first, rows->column[0] + first, &c);
        if (status && c.n < 4)
            return rp_prefix(status, "%s%s", groups->words[g], *groups->words[g] ? ": " : "");
        *found = *found || !status;
        if (*groups->words[g]) fprintf(call->out, "%s\t", groups->words[g]);
        const char *failed = rp_failed_text(call->arena, table, groups, g, NULL, NULL);
        CLI_ROW_WORD(rp_text(call->arena, "%s\t%s", failed, name), (double)c.n, c.value, c.se, c.lo, c.hi);
    }
    return *found ? RP_OK : status;
}

static rp_status correlation_of_table(cli_call *call, rp_table *table, const void *values)
{
    const correlation_options *o = values;
    char *names = rp_text(call->arena, "%s,%s", o->y, o->x), *rest = names;
    rp_groups groups;
    rp_rows rows;
    RP_TRY(rp_one_column("-y", o->y));
    RP_TRY(rp_group_rows(call->arena, table, o->by, '\t', &groups));
    RP_TRY(rp_rows_read(call->arena, table, names, &(rp_choice){.groups = &groups}, &rows));
    cli_table(call, call->out);
    rp_table_note(call->out, "rows", "%zu used, %zu without result, %zu with nan", rows.n, rows.n_failed,
                  rows.n_nan);
    rp_status status = rp_header_by(
        table, o->by,
        "n, correlation, correlation_se, correlation_lo, correlation_hi, " RP_FAILED_COLUMNS ", quantity",
        call->out);
    strsep(&rest, ",");
    bool found = false;
    for (size_t x = 1; rest && (!status || status == RP_NO_RESULT); x++)
        status = print_correlations(call, table, &groups, &rows, x, strsep(&rest, ","), &found);
    return rp_prefix(status, "%s: ", table->path);
}

const cli_command cmd_stats_correlation = {
    "stats correlation",
    "correlation of columns over runs",
    "TABLE -x COLUMNS -y COLUMN [options]",
    "Pearson's correlation of each column of x with y, with its 95 % interval by Fisher's transformation, "
    "one row for each column and group. A row with nan in one of the columns is left out for all. TABLE (- "
    "for standard input) has one row for each run, as `repose sweep export` writes it.",
    "repose stats correlation build/studies/lh_onset_runs.tsv -x bulk_friction_0,limit_probe -y "
    "theta_t_displacement_deg --by mu",
    correlation_params,
    .refuses = "Fewer than 4 rows in a group, or no column that varies: exit status 1.",
    .derives = true,
    .on_table = correlation_of_table};
