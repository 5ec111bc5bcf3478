/* repose stats fit: straight lines through the points of a table. */
#include <gsl/gsl_statistics_double.h>
#include <string.h>

#include "stats/stats.h"
#include "cli/derive/derive.h"

enum { SCALE_LINEAR, SCALE_LOG };

#define FIT_OPTIONS(X)                                                                                       \
    X(TEXT, x, "", NULL, "", "column of x")                                                                  \
    X(TEXT, y, "", NULL, "", "column of y")                                                                  \
    X(TEXT, se, "", "none", "", "column of the standard errors of y")                                        \
    CLI_RANGE(X, "x")                                                                                        \
    X(CHOICE, scale, "", "linear", "linear | log",                                                           \
      "straight line in x and y, or in their natural logarithms: a power law")                               \
    CLI_WHERE(X)

CLI_OPTIONS(fit, FIT_OPTIONS)

/* Numbers of column c of the rows, all of which must be positive, or their logarithms. */
static rp_status check_positive(const rp_table *t, const rp_rows *rows, int c, const char *name,
                                bool logarithms)
{
    double *v = rows->column[c];
    for (size_t i = 0; i < rows->n; i++) {
        if (!(v[i] > 0.0))
            return rp_fail(RP_BAD_INPUT, "%s:%zu: %s = %g: out of range%s, allowed: (0, inf)",
                           RP_PLACE(t, rows->row[i]), name, v[i], logarithms ? " of this scale" : "");
        if (logarithms) v[i] = log(v[i]);
    }
    return RP_OK;
}

static rp_status print_fit(const cli_call *call, const stats_xy *points, bool logarithms,
                           const double range[2], const char *failed)
{
    const int n_lines = logarithms ? 1 : 2; /* the line through the origin would be that through (1, 1) */
    stats_line lines[2];
    for (int i = 0; i < n_lines; i++) RP_TRY(stats_line_fit(points, i == 1, &lines[i]));
    if (lines[0].dof == 0)
        rp_table_note(call->out, "errors", "%s; at least 3 rows needed",
                      points->se ? "p_value is nan" : "nan");
    rp_table_header(call->out, call->units,
                    "slope [y/x], slope_se [y/x], intercept [y], intercept_se [y], covariance [y^2/x], chi2, "
                    "dof, p_value, n, x_from [x], x_to [x], residual [y], " RP_FAILED_COLUMNS ", line");
    for (int i = 0; i < n_lines; i++) {
        const stats_line *l = &lines[i];
        double residual = 0.0;
        for (size_t k = 0; k < points->n; k++)
            residual = fmax(residual, fabs(points->y[k] - l->intercept - l->slope * points->x[k]));
        CLI_ROW_WORD(rp_text(call->arena, "%s\t%s", failed, i == 1 ? "origin" : "free"), l->slope,
                     l->slope_se, l->intercept, l->intercept_se, l->covariance, l->chi2, (double)l->dof,
                     l->p_value, (double)l->n, range[0], range[1], residual);
    }
    return RP_OK;
}

static rp_status fit_table(cli_call *call, rp_table *table, const void *values)
{
    const fit_options *o = values;
    const bool weighted = strcmp(o->se, "none") != 0, logarithms = o->scale == SCALE_LOG;
    const rp_choice choice = {.any_status = true, .range = CLI_RANGE_OF(o)};
    rp_rows rows;
    if (logarithms && weighted)
        return rp_fail(RP_USAGE, "--scale log takes no --se: give one of them; see repose stats fit --help");
    RP_TRY(rp_one_column("-x", o->x));
    RP_TRY(rp_one_column("-y", o->y));
    RP_TRY(rp_one_column("--se", o->se));
    const char *names =
        rp_text(call->arena, "%s,%s%s%s", o->x, o->y, weighted ? "," : "", weighted ? o->se : "");
    RP_TRY(rp_rows_read(call->arena, table, names, &choice, &rows));
    if (weighted) RP_TRY(check_positive(table, &rows, 2, o->se, false));
    double *x = rows.column[0], *y = rows.column[1];
    double range[2];
    const char *failed = rp_failed_text(call->arena, table, NULL, 0, o->x, choice.range);
    cli_table(call, call->out);
    rp_table_note(call->out, "rows", "%zu used, %zu left out for nan, %zu outside the range of x", rows.n,
                  rows.n_nan, rows.n_outside);
    gsl_stats_minmax(&range[0], &range[1], x, 1, rows.n);
    if (logarithms) RP_TRY(check_positive(table, &rows, 0, o->x, true));
    if (logarithms) RP_TRY(check_positive(table, &rows, 1, o->y, true));
    const stats_xy points = {rows.n, x, y, rows.column[2]};
    return rp_prefix(print_fit(call, &points, logarithms, range, failed), "%s: ", table->path);
}

const cli_command cmd_stats_fit = {
    "stats fit",
    "straight line or power law through a table",
    "TABLE -x COLUMN -y COLUMN [options]",
    "Fits the straight line y = intercept + slope x by least squares, and the line through the origin. With "
    "--se, weights are 1/se^2, and errors follow from se without rescaling; p_value is the probability of a "
    "larger chi2. Without --se, all weights are equal, and errors follow from the scatter about the line. "
    "residual is the largest distance of a point from the line. TABLE (- for standard input) has columns by "
    "name, or 1, 2, ... if it has no header; rows with nan are left out.",
    "repose stats fit build/tables/lh3.tsv -x mu -y theta_r3_deg_mean --se theta_r3_deg_se --to 0.2",
    fit_params,
    .refuses = "--scale log together with --se, or with a number that is not positive.",
    .derives = true,
    .on_table = fit_table};
