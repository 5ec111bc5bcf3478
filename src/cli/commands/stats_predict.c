/* repose stats predict: what predicts a column of a table of runs, out of sample. */
#include <string.h>

#include "stats/stats.h"
#include "cli/cli.h"

#define PREDICT_OPTIONS(X)                                                                                   \
    X(TEXT, x, "", NULL, "", "columns (a or a,b,...) that may predict y")                                    \
    X(TEXT, y, "", NULL, "", "column of y")                                                                  \
    X(TEXT, given, "", "none", "", "column that is a prediction of y by itself, without a fit")              \
    CLI_BY(X, "none", "groups")                                                                              \
    X(INT, folds, "", "10", "[2, 1000]", "parts of a group: each is predicted by the fit to the others")     \
    X(BOOL, other_groups, "", "false", "", "each group is predicted by the fit to the other groups")         \
    CLI_WHERE(X)

CLI_OPTIONS(predict, PREDICT_OPTIONS)

#define PREDICT_COLUMNS                                                                                      \
    "n, correlation, correlation_se, correlation_lo, correlation_hi, skill, skill_se, rms [y], rms_se [y], " \
    "measured [y], measured_se [y], predicted [y], predicted_se [y], error [y], error_se [y], predictor"

/* The rows, and room for a number each. */
typedef struct {
    const predict_options *o;
    cli_groups groups;
    cli_rows of; /* y, then the columns of x, then the one given */
    size_t n_x;
    double *mean, *predicted;
    size_t *fold;
} rows;

static rp_status read_rows(const rp_table *t, rows *r)
{
    const predict_options *o = r->o;
    const cli_choice choice = {.groups = &r->groups};
    const bool given = strcmp(o->given, "none") != 0;
    const size_t size = strlen(o->x) + strlen(o->y) + strlen(o->given) + 3;
    char *names = cli_memory(size, 1);
    snprintf(names, size, given ? "%s,%s,%s" : "%s,%s", o->y, o->x, o->given);
    for (const char *x = o->x; *x; x++) r->n_x += *x == ',';
    r->n_x++;
    RP_TRY(cli_group_rows(t, o->by, '\t', &r->groups));
    RP_TRY(cli_rows_read(t, names, &choice, &r->of));
    r->mean = cli_memory(r->of.n, sizeof *r->mean);
    r->predicted = cli_memory(r->of.n, sizeof *r->predicted);
    r->fold = cli_memory(r->of.n, sizeof *r->fold);
    for (size_t g = 0; g < r->of.n_groups; g++)
        for (size_t i = r->of.first[g]; i < r->of.first[g + 1]; i++)
            r->fold[i] = o->other_groups ? g : (i - r->of.first[g]) % (size_t)o->folds;
    return RP_OK;
}

/* Predictions of all rows by p columns. */
static rp_status predict(const rows *r, size_t p, const double *const x[], double predicted[])
{
    if (r->o->other_groups) return stats_predict(r->of.n, p, x, r->of.column[0], r->fold, predicted);
    for (size_t g = 0; g < r->of.n_groups; g++) {
        const double *part[CLI_MOST_COLUMNS];
        const size_t first = r->of.first[g];
        for (size_t k = 0; k < p; k++) part[k] = x[k] + first;
        RP_TRY(stats_predict(r->of.first[g + 1] - first, p, part, r->of.column[0] + first, r->fold + first,
                             predicted + first));
    }
    return RP_OK;
}

static rp_status print_scores(const rows *r, const char *name, const double x[], const double predicted[])
{
    for (size_t g = 0; g < r->of.n_groups; g++) {
        const size_t first = r->of.first[g];
        stats_prediction s;
        RP_TRY(stats_prediction_score(r->of.first[g + 1] - first, r->of.column[0] + first, x + first,
                                      predicted + first, r->mean + first, &s));
        if (*r->groups.words[g]) printf("%s\t", r->groups.words[g]);
        CLI_ROW_WORD(name, (double)s.n, s.correlation, s.correlation_se, s.correlation_lo, s.correlation_hi,
                     s.skill, s.skill_se, s.rms, s.rms_se, s.measured.mean, s.measured.se, s.predicted.mean,
                     s.predicted.se, s.error.mean, s.error.se);
    }
    return RP_OK;
}

/* Each column by itself, all of them together, and the one given. */
static rp_status print_predictors(const rows *r)
{
    const double *const *x = (const double *const *)&r->of.column[1];
    char *rest = strcpy(cli_memory(strlen(r->o->x), 1), r->o->x);
    for (size_t k = 0; k < r->n_x; k++) {
        RP_TRY(predict(r, 1, &x[k], r->predicted));
        RP_TRY(print_scores(r, strsep(&rest, ","), x[k], r->predicted));
    }
    if (r->n_x > 1) {
        RP_TRY(predict(r, r->n_x, x, r->predicted));
        RP_TRY(print_scores(r, "all", r->predicted, r->predicted));
    }
    return strcmp(r->o->given, "none") != 0 ? print_scores(r, r->o->given, x[r->n_x], x[r->n_x]) : RP_OK;
}

static rp_status predict_table(rp_table *table, void *values)
{
    rows r = {.o = values};
    rp_status status = read_rows(table, &r);
    if (!status) status = predict(&r, 0, NULL, r.mean);
    RP_TRY(rp_prefix(status, "%s: ", table->path));
    cli_table(stdout);
    rp_table_note(stdout, "rows", "%zu used, %zu without result, %zu with nan", r.of.n, r.of.n_failed,
                  r.of.n_nan);
    status = cli_header_by(table, r.o->by, PREDICT_COLUMNS);
    if (!status) status = print_predictors(&r);
    return rp_prefix(status, "%s: ", table->path);
}

const cli_command cmd_stats_predict = {
    "stats predict",
    "what predicts a column, out of sample",
    "TABLE -x COLUMNS -y COLUMN [options]",
    "Predicts y by a straight line in each column of x, and by a linear function of all columns\n"
    "together. Each part of a group is predicted by the least squares of its other parts, so that no\n"
    "value is predicted by a fit that has seen it.\n"
    "\n"
    "correlation: Pearson's, of the column and y, with a 95 % interval; of all columns, of their\n"
    "prediction and y. skill: 1 less the mean square error over that of the mean of the other parts; 0 for "
    "a\n"
    "column that predicts nothing, negative for one that misleads. rms: root mean square error.\n"
    "error: mean of measured less predicted. Rows with nan in a column are left out for all.\n"
    "TABLE (- for standard input): one row per run, as repose sweep export writes.",
    "repose stats predict build/studies/lh_onset_runs.tsv -x bulk_friction_0,scatter -y "
    "theta_t_displacement_deg --by mu",
    predict_params,
    .on_table = predict_table};
