/* repose stats fit: straight lines through the points of a table. */
#include <gsl/gsl_permute_double.h>
#include <gsl/gsl_sort.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "stats/stats.h"
#include "cli/cli.h"

#define N_OF(array) (sizeof(array) / sizeof *(array))

enum { SCALE_LINEAR, SCALE_LOG };

typedef struct {
    const char *x, *y, *se;
    double from, to, level;
    int scale;
    bool successive;
    rp_texts where;
} fit_options;

static const rp_param fit_params[] = {
    {"x", "", RP_TEXT, offsetof(fit_options, x), NULL, "", "column of x"},
    {"y", "", RP_TEXT, offsetof(fit_options, y), NULL, "", "column of y"},
    {"se", "", RP_TEXT, offsetof(fit_options, se), "none", "", "column of the standard errors of y"},
    CLI_RANGE(fit_options, "x"),
    {"scale", "", RP_CHOICE, offsetof(fit_options, scale), "linear", "linear | log",
     "straight line in x and y, or in their natural logarithms: a power law"},
    {"successive", "", RP_BOOL, offsetof(fit_options, successive), "false", "",
     "where linearity ends: one row for the first three points, the first four, ..."},
    {"level", "", RP_REAL, offsetof(fit_options, level), "0.05", "(0, 1)",
     "smallest p with which a line is accepted, for --successive"},
    CLI_WHERE(fit_options),
    {0}};

/* Pack the usable points of the blocks x, y, se of n values each to their fronts. */
static size_t select_points(size_t n, double *block, const fit_options *o, size_t *n_missing)
{
    size_t used = 0;
    *n_missing = 0;
    for (size_t i = 0; i < n; i++) {
        double x = block[i], y = block[n + i], se = block[2 * n + i];
        bool missing = isnan(x) || isnan(y) || isnan(se);
        *n_missing += missing;
        if (missing || x < o->from || x > o->to) continue;
        block[used] = x;
        block[n + used] = y;
        block[2 * n + used++] = se;
    }
    return used;
}

static rp_status take_logarithms(const rp_table *t, size_t n, double v[], const char *name)
{
    for (size_t i = 0; i < n; i++) {
        if (!(v[i] > 0.0))
            return rp_fail(RP_BAD_INPUT, "%s: %s = %g: out of range of this scale, allowed: (0, inf)",
                           t->path, name, v[i]);
        v[i] = log(v[i]);
    }
    return RP_OK;
}

/* The points in order of x: blocks of n values, of which `used` count. */
static rp_status sort_points(size_t n, size_t used, double *block)
{
    size_t *order = malloc((used + 1) * sizeof *order);
    if (!order) return rp_fail(RP_NO_MEMORY, "fit: out of memory");
    gsl_sort_index(order, block, 1, used);
    for (size_t c = 0; c < 3; c++) gsl_permute(order, block + c * n, 1, used);
    free(order);
    return RP_OK;
}

static rp_status print_successive(size_t n, const double x[], const double y[], const double se[],
                                  double level)
{
    double linear_to, bend_free_to;
    stats_prefix *fits = malloc((n + 1) * sizeof *fits);
    if (!fits) return rp_fail(RP_NO_MEMORY, "fit: out of memory");
    rp_status status = stats_successive(n, x, y, se, level, fits, &linear_to, &bend_free_to);
    if (!status) {
        rp_table_note(stdout, "linear_to", "%g", linear_to);
        rp_table_note(stdout, "bend_free_to", "%g", bend_free_to);
        rp_table_header(
            stdout, "x_to [x], n, slope [y/x], slope_se [y/x], intercept [y], intercept_se [y], chi2, dof, "
                    "p_value, bend [y/x^2], bend_se [y/x^2], p_bend, status");
    }
    for (size_t k = 0; k + 3 <= n && !status; k++) {
        const stats_line *l = &fits[k].line;
        const stats_contrast *bend = &fits[k].bend;
        CLI_ROW_WORD(l->p_value < level || fits[k].p_bend < level ? "curved" : "ok", x[k + 2], (double)l->n,
                     l->slope, l->slope_se, l->intercept, l->intercept_se, l->chi2, (double)l->dof,
                     l->p_value, bend->value, bend->se, fits[k].p_bend);
    }
    free(fits);
    return status;
}

static rp_status print_fit(size_t n, const double x[], const double y[], const double se[], bool logarithms,
                           const double range[2])
{
    const int n_lines = logarithms ? 1 : 2; /* the line through the origin would be that through (1, 1) */
    stats_line lines[2];
    for (int i = 0; i < n_lines; i++) {
        rp_status status = stats_line_fit(n, x, y, se, i == 1, &lines[i]);
        if (status) return status;
    }
    rp_table_header(stdout,
                    "slope [y/x], slope_se [y/x], intercept [y], intercept_se [y], covariance [y^2/x], chi2, "
                    "dof, p_value, n, x_from [x], x_to [x], line");
    for (int i = 0; i < n_lines; i++) {
        const stats_line *l = &lines[i];
        CLI_ROW_WORD(i == 1 ? "origin" : "free", l->slope, l->slope_se, l->intercept, l->intercept_se,
                     l->covariance, l->chi2, (double)l->dof, l->p_value, (double)l->n, range[0], range[1]);
    }
    return RP_OK;
}

static rp_status fit_table(rp_table *table, const void *values)
{
    const fit_options *o = values;
    const bool weighted = strcmp(o->se, "none") != 0, logarithms = o->scale == SCALE_LOG;
    const char *const names[] = {o->x, o->y, o->se};
    int columns[3] = {-1, -1, -1};
    double *block = NULL;
    size_t n = table->n_rows, missing;
    if (o->successive && !weighted)
        return rp_fail(RP_USAGE, "--successive needs --se; see repose stats fit --help");
    if (logarithms && weighted)
        return rp_fail(RP_USAGE,
                       "--scale log is without --se: give one of them; see repose stats fit --help");
    rp_status status = cli_find_columns(table, weighted ? 3 : 2, names, columns);
    if (!status) status = cli_read_columns(table, 3, columns, 1, &block);
    for (size_t i = 0; i < n && !status && !weighted; i++) block[2 * n + i] = 1.0;
    if (!status) {
        size_t used = select_points(n, block, o, &missing);
        double *x = block, *y = block + n, *se = weighted ? block + 2 * n : NULL;
        cli_table(stdout, fit_params, o);
        rp_table_note(stdout, "rows", "%zu used, %zu left out for nan, %zu outside the range of x", used,
                      missing, n - used - missing);
        double range[2] = {NAN, NAN};
        for (size_t i = 0; i < used; i++) range[0] = fmin(range[0], x[i]), range[1] = fmax(range[1], x[i]);
        if (logarithms) status = take_logarithms(table, used, x, o->x);
        if (logarithms && !status) status = take_logarithms(table, used, y, o->y);
        if (o->successive) status = sort_points(n, used, block);
        if (!status)
            status = o->successive ? print_successive(used, x, y, se, o->level)
                                   : print_fit(used, x, y, se, logarithms, range);
        if (status) rp_prefix(status, "%s: ", table->path);
    }
    free(block);
    return status;
}

const cli_command cmd_stats_fit = {
    "stats fit",
    "straight line or power law through a table",
    "TABLE -x COLUMN -y COLUMN [options]",
    "Straight line y = intercept + slope x by least squares, and the line through the origin.\n"
    "With --se the weights are 1/se^2, and errors follow from se, not rescaled; p_value: chance of a\n"
    "larger chi2. Without, all weights are equal, and errors follow from the scatter about the line.\n"
    "--successive orders the points by x and adds one after the other. bend: coefficient of x^2 of the\n"
    "parabola, p_bend its two-sided p. linear_to, bend_free_to (header): largest x up to which every\n"
    "line has p_value, or p_bend, of at least --level; nan if there is none.\n"
    "TABLE (- for standard input): columns by name, or 1, 2, ... without header; rows with nan are left\n"
    "out.",
    "repose stats fit build/tables/lh3.tsv -x mu -y theta_r3_deg_mean --se theta_r3_deg_se --to 0.2",
    fit_params,
    .on_table = fit_table};
