/* repose calibrate: from a measured angle of repose, and a tilting angle, to the friction that gives it. */
#include <string.h>
#include <unistd.h>

#include "stats/calibrate.h"
#include "cli/commands/identify.h"

#define CALIBRATE_OPTIONS(X)                                                                                 \
    X(REAL, theta_r_deg, "deg", "none", "(-90, 90) | none", "measured angle of repose, by method 3")         \
    X(REAL, error_deg, "deg", "none", "[0, 90) | none", "its standard error")                                \
    X(REAL, theta_t_deg, "deg", "none", "[0, 90) | none", "measured tilt at which the pile moves")           \
    X(REAL, theta_t_error_deg, "deg", "none", "[0, 90) | none", "its standard error")                        \
    X(TEXT, fit, "", "mu", "",                                                                               \
      "parameter to find, or two (mu,mu_roll); the piles must vary these and no others")                     \
    X(TEXT, sweep, "", "sweeps/studies/calibrate.cfg", "", "sweep file of the simulated piles")              \
    X(TEXT, o, "", "calibrate", "", "folder of that sweep; stored runs are not made again")                  \
    X(INT, budget, "", "auto", "[1, 10000000] | auto", "most runs, of FILE; auto: the file's")               \
    X(BOOL, dry_run, "", "false", "", "check FILE, and say what the first stage needs")                      \
    X(TEXT, runs, "", "", "", "table of piles instead of a sweep, as repose sweep export writes it")         \
    CLI_FORCE(X)                                                                                             \
    CLI_QUIET(X)                                                                                             \
    CLI_WORKERS(X)                                                                                           \
    X(INT, bootstrap, "", "500", "[2, 100000]", "resamples of the piles, to check error and interval")       \
    CLI_SEED(X, "1993", "seed of the resamples")

CLI_OPTIONS(calibrate, CALIBRATE_OPTIONS)

typedef struct {
    const char *name, *column, *option, *error_option;
} angle_kind;

static const angle_kind kinds[STATS_MAX_ANGLES] = {
    {"theta_r", "theta_r3_deg", "theta-r-deg", "error-deg"},
    {"theta_t", "theta_t_displacement_deg", "theta-t-deg", "theta-t-error-deg"}};

typedef struct {
    const cli_call *call;
    size_t n_angles; /* measured */
    const angle_kind *angle[STATS_MAX_ANGLES];
    stats_measured measured;
    const char *path; /* of the table of piles */
    rp_table *table;
    const char *param[STATS_MAX_PARAMS];
    stats_ensemble piles; /* those with a result */
    stats_calibration fit;
    stats_calibrated found[STATS_MAX_PARAMS];
} problem;

static rp_status read_measured(const calibrate_options *o, problem *s)
{
    const double values[][2] = {{o->theta_r_deg, o->error_deg}, {o->theta_t_deg, o->theta_t_error_deg}};
    for (size_t a = 0; a < STATS_MAX_ANGLES; a++) {
        const bool angle = !isinf(values[a][0]), error = !isinf(values[a][1]);
        const angle_kind *k = &kinds[a];
        if (angle != error)
            return rp_fail(RP_USAGE, "--%s needs --%s", angle ? k->option : k->error_option,
                           angle ? k->error_option : k->option);
        if (!angle) continue;
        s->measured.angle[s->n_angles] = values[a][0];
        s->measured.error[s->n_angles] = values[a][1];
        s->angle[s->n_angles++] = k;
    }
    if (s->n_angles > 0) return RP_OK;
    return rp_fail(RP_USAGE, "--%s or --%s is required; see repose calibrate --help", kinds[0].option,
                   kinds[1].option);
}

/* ---- piles ---- */

/* Make the runs that the sweep lacks, and write all runs as a table into its folder. One that may only be
 * read has them all. */
static rp_status run_sweep(const calibrate_options *o, problem *s)
{
    const char *file = cli_data(s->call->arena, o->sweep);
    sweep_counts counts;
    if (access(o->o, F_OK) == 0 && access(o->o, W_OK) != 0) {
        s->path = o->o;
        RP_TRY(sweep_check_done(file, o->o, sweep_protocols));
        return cli_sweep_table(s->call, o->o, SWEEP_RUNS, &s->table, &counts);
    }
    RP_TRY(cli_claim_sweep(o->o, file, o->force));
    RP_TRY(sweep_prepare(file, o->o, 0, sweep_protocols, NULL, &counts));
    if (!o->quiet && counts.stored < counts.planned)
        fprintf(stderr, "repose calibrate: makes %zu piles, once, and keeps them in the folder %s\n",
                counts.planned - counts.stored, o->o);
    RP_TRY(cli_sweep_run(o->o, (sweep_options){.workers = (int)o->j, .snapshot = CLI_SNAPSHOT}, o->quiet,
                         &counts));
    RP_TRY(rp_path(s->call->arena, &s->path, "%s/runs.tsv", o->o));
    return cli_sweep_export(s->call, o->o, SWEEP_RUNS, s->path, NULL);
}

/* The parameters of --fit: one or two columns, and no other parameter may vary. */
static rp_status find_params(const char *fit, problem *s)
{
    const rp_table *t = s->table;
    int columns[STATS_MAX_PARAMS];
    size_t n;
    const rp_status status = rp_column_list(t, fit, STATS_MAX_PARAMS, &n, columns);
    if (status)
        return rp_fail(status, "%s; the piles must vary each parameter",
                       rp_text(s->call->arena, "%s", rp_message()));
    if (n > 1 && columns[0] == columns[1])
        return rp_fail(RP_BAD_INPUT, "--fit = \"%s\": the same parameter twice", fit);
    s->piles.n_params = n;
    for (size_t p = 0; p < n; p++) s->param[p] = t->names[columns[p]];
    for (const rp_param *p = sweep_protocol_repose.schema; p->name; p++) {
        const int c = rp_table_column(t, p->name);
        if (c < 0 || c == columns[0] || c == columns[n - 1]) continue;
        for (size_t i = 1; i < t->n_rows; i++)
            if (strcmp(rp_cell(t, i, c), rp_cell(t, 0, c)) != 0)
                return rp_fail(RP_BAD_INPUT, "%s:%zu: %s varies too, and is not under --fit",
                               t->places[i].path, t->places[i].line, p->name);
    }
    return RP_OK;
}

/* Parameters and measured angles of the piles with a result. A protocol that did not measure an angle leaves
 * nan in every row. */
static rp_status read_piles(const char *fit, problem *s)
{
    const char *names = fit;
    rp_rows rows;
    for (size_t a = 0; a < s->n_angles; a++) {
        if (rp_table_column(s->table, s->angle[a]->column) < 0)
            return rp_fail(RP_BAD_INPUT, "%s: no values of \"%s\"", s->path, s->angle[a]->column);
        names = rp_text(s->call->arena, "%s,%s", names, s->angle[a]->column);
    }
    RP_TRY(rp_rows_read(s->call->arena, s->table, names, &(rp_choice){.any_number = true}, &rows));
    s->piles.n = rows.n;
    s->piles.n_angles = s->n_angles;
    for (size_t p = 0; p < s->piles.n_params; p++) s->piles.x[p] = rows.column[p];
    for (size_t a = 0; a < s->n_angles; a++) {
        s->piles.angle[a] = rows.column[s->piles.n_params + a];
        size_t n = 0;
        while (n < rows.n && isnan(s->piles.angle[a][n])) n++;
        if (n == rows.n)
            return rp_fail(RP_BAD_INPUT, "%s: no values of \"%s\"", s->path, s->angle[a]->column);
    }
    return RP_OK;
}

/* ---- the answer ---- */

/* "theta_r from 10 to 35 degrees and theta_t ..., for 0.1 <= mu <= 0.6" */
static const char *reach_text(const problem *s)
{
    const stats_calibration *c = &s->fit;
    const char *text = "";
    for (size_t a = 0; a < c->n_angles; a++) {
        const stats_reach reach = stats_calibration_reach(c, a);
        text = rp_text(s->call->arena, "%s%s%s from %.3g to %.3g degrees", text, a ? " and " : "",
                       s->angle[a]->name, reach.angle[0], reach.angle[1]);
    }
    for (size_t p = 0; p < c->n_params; p++)
        text = rp_text(s->call->arena, "%s%s%g <= %s <= %g", text, p ? ", " : ", for ", c->lo[p], s->param[p],
                       c->hi[p]);
    return text;
}

/* Where the answer holds: model and protocol from the header of the piles' table. */
static void note_scope(const rp_table *t)
{
    const char *rotation = rp_table_find_note(t, "rotation"), *text;
    const bool rotate = rp_table_column(t, "rotation") >= 0 || (rotation && strcmp(rotation, "true") == 0);
    bool known = false;
    rp_table_note(
        stdout, "holds for",
        "two-dimensional piles in a box whose right wall is removed; grains %s; theta_r by method 3, "
        "theta_t by displacement; the parameters that follow",
        rotate ? "rotate" : "do not rotate");
    for (const rp_param *p = sweep_protocol_repose.schema; p->name; p++)
        if ((text = rp_table_find_note(t, p->name))) {
            rp_table_note(stdout, p->name, "%s", text);
            known = true;
        }
    if (!known) rp_table_note(stdout, "parameters", "unknown: the table of piles does not name them");
    rp_table_note(stdout, "not for",
                  "other models, protocols or sizes: the answer does not carry over to them");
}

static void print_head(const problem *s)
{
    static const char *const second_degree[] = {"", " and 1", " and 2"};
    const stats_calibration *c = &s->fit;
    const char *sweep = rp_table_find_note(s->table, "sweep");
    cli_table(s->call, stdout);
    rp_table_note(stdout, "piles", "%s; %zu piles used, %zu rows without result", sweep ? sweep : s->path,
                  s->piles.n, s->table->n_rows - s->piles.n);
    for (size_t a = 0; a < c->n_angles; a++) {
        const stats_response_fit *r = &c->response[a];
        rp_table_note(stdout, "response",
                      "%s: %s, degree %zu%s, %zu coefficients, %zu points, chi2 = %.3g, p = %.2g, "
                      "discrepancy %.2g deg%s",
                      s->angle[a]->name, stats_shape_words[r->shape], r->degree[0],
                      second_degree[r->degree[1]], r->n_terms, r->n_points, r->chi2, r->p_value,
                      sqrt(r->discrepancy), r->monotone ? "" : ", not monotone");
    }
    rp_table_note(stdout, "reach", "%s", reach_text(s));
    for (size_t p = 0; p < c->n_params; p++) rp_table_note(stdout, "range", "%g to %g", c->lo[p], c->hi[p]);
    if (c->n_angles == 2) rp_table_note(stdout, "correlation of the angles", "%.2f", c->correlation);
    note_scope(s->table);
}

static void print_found(const problem *s)
{
    rp_table_header(stdout, "parameter, value, se, lower, upper, boot_se, boot_lower, boot_upper, status");
    for (size_t p = 0; p < s->piles.n_params; p++) {
        const stats_calibrated *f = &s->found[p];
        for (size_t k = 0; k == 0 || k < f->n_solutions; k++) {
            printf("%s\t", s->param[p]);
            CLI_ROW_WORD(stats_calibrated_words[f->status], f->solutions[k].value, f->se,
                         f->solutions[k].lower, f->solutions[k].upper, f->boot_se, f->boot_lower,
                         f->boot_upper);
        }
    }
}

/* What would make these piles reach the measurement: more of the range where the response is largest, or
 * smallest, at an end. Near its end the response may be flat. */
static const char *how_to_extend(const problem *s, stats_calibrated_status why)
{
    const stats_calibration *c = &s->fit;
    const bool above = why == STATS_CALIBRATED_ABOVE_RANGE;
    const char *name = s->param[0];
    if (c->n_params > 1 || why == STATS_CALIBRATED_NO_MATCH)
        return rp_text(s->call->arena,
                       "piles of other %s (--sweep), or of another parameter (--fit), may reach further",
                       name);
    const stats_reach reach = stats_calibration_reach(c, 0);
    const double x = reach.at[above][0], inward = 0.1 * (c->hi[0] - c->lo[0]);
    const bool upper = x == c->hi[0];
    if (x > c->lo[0] && x < c->hi[0])
        return rp_text(s->call->arena,
                       "the angle is %s within the range, near %s = %.3g: vary another parameter (--fit)",
                       above ? "largest" : "smallest", name, x);
    const double near =
        stats_response_value(&c->response[0], &(double){upper ? x - inward : x + inward}, NULL);
    if (fabs(reach.angle[above] - near) < 0.02 * (reach.angle[1] - reach.angle[0]))
        return rp_text(s->call->arena,
                       "the angle hardly changes near %s = %g: vary another parameter (--fit)", name, x);
    return rp_text(s->call->arena, "piles with %s %s %g (--sweep) extend it", name, upper ? "above" : "below",
                   x);
}

/* A match with an angle that no response reaches rests on the scatter and the discrepancy alone. */
static void warn_outside(const problem *s)
{
    for (size_t a = 0; a < s->n_angles; a++) {
        const double angle = s->measured.angle[a];
        const stats_reach reach = stats_calibration_reach(&s->fit, a);
        if (angle < reach.angle[0] || angle > reach.angle[1])
            fprintf(stderr,
                    "repose calibrate: %s = %g degrees lies outside what the response reaches, %.3g to %.3g: "
                    "the answer rests on the errors alone\n",
                    s->angle[a]->name, angle, reach.angle[0], reach.angle[1]);
    }
}

/* Limits of all solutions together: "; 0.1 <= mu <= 0.3", "; mu >= 0.1" or "". */
static const char *limits_text(const problem *s, size_t p)
{
    const stats_calibrated *f = &s->found[p];
    const double lower = f->solutions[0].lower,
                 upper = f->solutions[f->n_solutions ? f->n_solutions - 1 : 0].upper;
    const char *name = s->param[p];
    if (!isnan(lower) && !isnan(upper))
        return rp_text(s->call->arena, "; %g <= %s <= %g", lower, name, upper);
    if (!isnan(lower)) return rp_text(s->call->arena, "; %s >= %g", name, lower);
    return isnan(upper) ? "" : rp_text(s->call->arena, "; %s <= %g", name, upper);
}

/* Exit status 1 and what is known, for the first parameter that is not found. */
static rp_status conclude(const problem *s)
{
    size_t p = 0;
    while (p < s->piles.n_params && s->found[p].status == STATS_CALIBRATED_OK) p++;
    if (p == s->piles.n_params) {
        warn_outside(s);
        return RP_OK;
    }
    const stats_calibrated_status status = s->found[p].status;
    const char *extend = "";
    if (status >= STATS_CALIBRATED_ABOVE_RANGE)
        extend =
            rp_text(s->call->arena, "; these piles reach %s; %s", reach_text(s), how_to_extend(s, status));
    return rp_fail(RP_NO_RESULT, "%s: %s: %s%s%s", s->param[p], stats_calibrated_words[status],
                   stats_calibrated_meanings[status], limits_text(s, p), extend);
}

static rp_status invert(const calibrate_options *o, problem *s)
{
    RP_TRY(rp_prefix(stats_calibration_fit(&s->piles, &s->fit), "%s: ", s->path));
    RP_TRY(stats_calibration_invert(&s->fit, &s->measured, s->found));
    RP_TRY(stats_calibration_bootstrap(&s->piles, &s->fit, &s->measured, (size_t)o->bootstrap,
                                       cli_random(s->call, 0), s->found));
    print_head(s);
    print_found(s);
    return conclude(s);
}

static rp_status calibrate(cli_call *call, const void *values)
{
    const calibrate_options *o = values;
    problem s = {.call = call, .path = o->runs};
    const char *file = cli_argument(call, 0);
    if (file && (!isinf(o->theta_r_deg) || !isinf(o->theta_t_deg) || *o->runs || cli_given(call, "fit")))
        return rp_fail(
            RP_USAGE, "%s says what is measured and fitted: no --theta-r-deg, --theta-t-deg, --fit or --runs",
            file);
    if (file)
        return cli_identify(call, cli_data(call->arena, file),
                            &(calibrate_text_options){o->o, o->budget, o->j, o->quiet, o->force, o->dry_run});
    RP_TRY(read_measured(o, &s));
    if (!*o->runs) RP_TRY(run_sweep(o, &s));
    if (!s.table) RP_TRY(rp_table_load(call->arena, s.path, &s.table));
    RP_TRY(find_params(o->fit, &s));
    RP_TRY(read_piles(o->fit, &s));
    const rp_status status = invert(o, &s);
    stats_calibration_free(&s.fit);
    return status;
}

const cli_command cmd_calibrate = {
    "calibrate",
    "parameters that give measured numbers, with their intervals",
    "FILE.cfg [-o DIR] [--budget RUNS] [--dry-run]\n"
    "--theta-r-deg ANGLE --error-deg SE [options]",
    "FILE.cfg: find up to three names of experiments (`let`) from several measured numbers. It has\n"
    "fit = { NAME = [from, to]; } and measured = ( { experiment, of, value, error } ), where `of` is a "
    "column of the\n"
    "experiment's sweep, and if wanted fixed = { ... }, model_error, protocol instead of experiment, or "
    "runs, a table\n"
    "of another program; where = \"CONDITION\" of the names, seed, budget. Each number is fitted by a "
    "quadratic of the\n"
    "names over the runs of a design; where that agrees with the measurements, a smaller box gets more runs, "
    "until the\n"
    "answer is settled. Each stage is a sweep in DIR: the same command continues. The interval is of 95 %, "
    "by profiles\n"
    "of chi2. The header has each number's residual, correlations, the combination of the names that is "
    "determined\n"
    "best, and how many points of the design the others find again. status is ok, at_least, at_most, "
    "not_identified\n"
    "(nine tenths of the range agree), no_match, or budget (not settled yet); exit status 1 unless ok.\n"
    "\n"
    "--theta-r-deg: the friction of a box that gives a measured angle. Piles are simulated over a range of "
    "friction, and\n"
    "their mean angles are fitted by powers or a saturating form, whichever has the least AIC. The fit is\n"
    "inverted. The first call simulates for some minutes; the folder -o keeps the piles for the next one.\n"
    "\n"
    "lower and upper bound the 95 % interval. The interval contains the error of the measurement, the\n"
    "error of the fit, and its lack of fit. se is the standard error by the delta method. boot_se,\n"
    "boot_lower and boot_upper come from a bootstrap over piles, as a check.\n"
    "\n"
    "status is ok, or\n"
    "  several          several intervals agree with the angle, one row each\n"
    "  at_least         the upper end of the interval lies beyond the simulated range\n"
    "  at_most          the lower end lies beyond it\n"
    "  not_identified   every friction of the range agrees\n"
    "  above_range      the angle is larger than the fitted one anywhere in the range\n"
    "  below_range      the angle is smaller than the fitted one anywhere in the range\n"
    "  no_match         no friction agrees with both angles together\n"
    "  underdetermined  two parameters are sought from one angle\n"
    "The exit status is 1 unless the status is ok.\n"
    "\n"
    "The header names the range of angles that the piles reach. The message of above_range, below_range\n"
    "and no_match names it too, and says what would extend it.\n"
    "\n"
    "The answer holds for the model and protocol that the header names: two-dimensional piles in a box\n"
    "opened on one side. It does not carry over to another model, protocol or size.",
    "repose calibrate --theta-r-deg 25 --error-deg 1",
    calibrate_params,
    .refuses = "An angle without its standard error; piles that do not vary what is sought, or vary "
               "something else.\n"
               "An answer whose status is not ok: exit status 1.",
    .act = calibrate};
