/* repose calibrate: names of experiments from numbers that were measured. */
#include "cli/cli.h"
#include "core/elementary.h"
#include "core/version.h"
#include "run/run.h"
#include "sweeps/engine/calibrate.h"

#define CALIBRATE_OPTIONS(X)                                                                                 \
    X(REAL, theta_r_deg, "deg", "none", "(-90, 90) | none",                                                  \
      "measured angle of repose, by method 3 of repose angle slope")                                         \
    X(REAL, error_deg, "deg", "none", "(0, 90) | none", "standard error of --theta-r-deg")                   \
    X(REAL, theta_t_deg, "deg", "none", "[0, 90) | none", "measured tilt at which the pile moves")           \
    X(REAL, theta_t_error_deg, "deg", "none", "(0, 90) | none", "standard error of --theta-t-deg")           \
    X(TEXT, o, "", "calibrate", "", "folder for the answer and the tables of the runs")                      \
    X(INT, budget, "", "auto", "[1, 10000000] | auto",                                                       \
      "largest number of runs; auto: `budget` of the file, otherwise 1000")                                  \
    X(BOOL, dry_run, "", "false", "", "check the file, and print what the first stage needs")                \
    CLI_FORCE(X, "replace a finished result in the folder")                                                  \
    CLI_QUIET(X)                                                                                             \
    CLI_WORKERS(X)

CLI_OPTIONS(calibrate, CALIBRATE_OPTIONS)

typedef struct {
    const calibrate_options *o;
    bool made; /* runs of the last stage, now */
} calibration;

/* ---- runs ---- */

/* Of a stage and a group; those that are stored are not made again. */
static rp_status run_sweep(const sweep_problem *problem, size_t stage, const char *source, const char *dir,
                           sweep_counts *counts)
{
    calibration *c = problem->context;
    c->made |= counts->stored < counts->planned;
    if (!c->o->quiet && counts->stored < counts->planned)
        cli_say("repose calibrate: stage %zu, %s: %zu points, %zu runs each", stage + 1, source,
                counts->points, counts->replicas);
    return cli_sweep_run(dir, (sweep_options){.workers = (int)c->o->j, .snapshot = RUN_SNAPSHOT}, c->o->quiet,
                         counts);
}

/* ---- the answer ---- */

/* "; determined is mu + 1.9 mu_roll = 0.5 +- 0.01; best to separate the names: width of FILE" */
static const char *apart(const sweep_problem *s, const stats_answer *a)
{
    const char *other = sweep_problem_separator(s, a),
               *sum = a->determined ? rp_text(s->arena, "; determined is %s = %.5g +- %.2g",
                                              sweep_problem_combination(s, a), a->sum, a->sum_error)
                                    : "";
    return rp_text(s->arena, "%s; %s%s", sum,
                   other ? "best measure to separate the variables: "
                         : "no other measure of these runs separates the variables",
                   other ? other : "");
}

/* Is it the names that the numbers can't tell, rather than their range? */
static bool is_unseparated(const sweep_problem *s, stats_identified status)
{
    return s->quest.n_names > 1 &&
           (status == STATS_IDENTIFIED_NOT_IDENTIFIED || status == STATS_IDENTIFIED_SEVERAL ||
            status == STATS_IDENTIFIED_BUDGET || status == STATS_IDENTIFIED_BENT);
}

/* "repose calibrate: after stage 1: mu 0.2 to 0.4", after runs that were made now. */
static void tell(void *host, const stats_answer *a)
{
    const sweep_problem *s = host;
    calibration *c = s->context;
    bool unseparated = false;
    if (c->o->quiet || !c->made) return;
    c->made = false;
    const char *said = rp_text(s->arena, "repose calibrate: after stage %zu:", a->stages);
    for (size_t p = 0; p < s->quest.n_names; p++) {
        const size_t n = a->n_intervals[p];
        const stats_identified status = a->status[p];
        unseparated |= is_unseparated(s, status) && status != STATS_IDENTIFIED_BUDGET;
        said = rp_text(s->arena, "%s%s %s ", said, p ? "," : "", s->name[p]);
        if (n > 0)
            said = rp_text(s->arena, "%s%.3g to %.3g", said, a->interval[p][0].lower,
                           a->interval[p][n - 1].upper);
        if (status != STATS_IDENTIFIED_BUDGET)
            said = rp_text(s->arena, "%s%s%s", said, n > 0 ? ", " : "", stats_identified_words[status]);
    }
    cli_say("%s%s", said, unseparated ? apart(s, a) : "");
}

/* "p <= 0.5, q >= 0.1": ends that the ranges have lost; "" without. */
static const char *cut_ends(const sweep_problem *s, const stats_answer *a)
{
    const char *text = "";
    for (size_t p = 0; p < 2 * s->quest.n_names; p++) {
        const double end = p % 2 ? a->hi[p / 2] : a->lo[p / 2];
        if (end != (p % 2 ? s->quest.hi : s->quest.lo)[p / 2])
            text = rp_text(s->arena, "%s%s%s %s %.4g", text, *text ? ", " : "", s->name[p / 2],
                           p % 2 ? "<=" : ">=", end);
    }
    return text;
}

static void print_answer(const cli_call *call, const sweep_problem *s, const stats_answer *a)
{
    char text[1024];
    const bool bent = a->status[0] == STATS_IDENTIFIED_BENT;
    cli_provenance(call, call->out);
    rp_table_note(call->out, "runs", "%zu at %zu points, %zu of them without some measure, %s", a->n_runs,
                  a->n_points, a->n_failed,
                  !s->quest.fixed_runs ? rp_text(call->arena, "in %zu stages", a->stages)
                  : a->n_repeated > 0  ? rp_text(call->arena, "%zu repeated", a->n_repeated)
                                       : "none repeated, so that scatter cannot be told from lack of fit");
    if (*sweep_words(&s->words, sweep_is_failed, text))
        rp_table_note(call->out, "failed", "%s: the measures are from the other runs", text);
    if (*cut_ends(s, a))
        rp_table_note(call->out, "range", "%s: only there do the runs have all measures", cut_ends(s, a));
    rp_table_note(call->out, "chi2", "%.3g over %zu", a->chi2, a->dof);
    for (size_t k = 0; k < s->quest.n_numbers; k++) {
        const sweep_measured *m = &s->number[k];
        const double d = (m->value - a->fitted[k]) / rp_hypot(s->quest.error[k], a->fit_error[k]);
        rp_table_note(call->out, m->of, "measured %.6g +- %.3g%s; form p = %s; runs reach %.6g to %.6g",
                      m->value, s->quest.error[k],
                      bent ? ""
                           : rp_text(call->arena, ", fitted %.6g +- %.3g, residual %.2g", a->fitted[k],
                                     a->fit_error[k], d),
                      isnan(a->p_value[k]) ? "not known" : rp_text(call->arena, "%.2g", a->p_value[k]),
                      a->reach[k][0], a->reach[k][1]);
    }
    for (size_t p = 1; p < s->quest.n_names && !bent; p++)
        for (size_t q = 0; q < p; q++)
            rp_table_note(call->out, "correlation", "%s and %s: %.2f", s->name[q], s->name[p],
                          a->correlation[q][p]);
    if (s->quest.n_names > 1)
        rp_table_note(call->out, "determined", "%s",
                      a->determined ? rp_text(call->arena, "%s = %.5g +- %.2g",
                                              sweep_problem_combination(s, a), a->sum, a->sum_error)
                      : bent        ? "unknown, because the runs bend too much"
                             : "unknown, because the best values lie at an end of their range, or the region "
                               "that agrees is curved");
    rp_table_note(call->out, "left out", "%zu of %zu points are recovered from the others", a->recovered,
                  a->tried);
    rp_table_note(call->out, "holds for", "the experiments that ran, and not for a different model");
    rp_table_header(call->out, call->units, "parameter, value, se, lower, upper, status");
    for (size_t p = 0; p < s->quest.n_names; p++) {
        const size_t n = a->n_intervals[p];
        for (size_t k = 0; k == 0 || k < n; k++) {
            const stats_interval *i = n > 1 ? &a->interval[p][k] : &a->own[p];
            fprintf(call->out, "%s\t", s->name[p]);
            CLI_ROW_WORD(stats_identified_words[a->status[p]], n > 1 ? i->value : a->x[p], a->se[p], i->lower,
                         i->upper);
        }
    }
}

/* A name that is not found, with what is known of it. */
static rp_status conclude(const sweep_problem *s, const stats_answer *a)
{
    size_t p = 0;
    while (p < s->quest.n_names && a->status[p] != STATS_IDENTIFIED_NOT_IDENTIFIED) p++;
    if (p == s->quest.n_names)
        for (p = 0; p < s->quest.n_names && a->status[p] == STATS_IDENTIFIED_OK;) p++;
    if (p == s->quest.n_names) return RP_OK;
    const stats_identified status = a->status[p];
    const char *more = "";
    if (is_unseparated(s, status)) more = apart(s, a);
    if (status == STATS_IDENTIFIED_ABOVE_RANGE || status == STATS_IDENTIFIED_BELOW_RANGE)
        more = rp_text(s->arena, "; the runs reach %.3g to %.3g, for %g <= %s <= %g", a->reach[0][0],
                       a->reach[0][1], a->lo[0], s->name[0], a->hi[0]);
    if (*cut_ends(s, a))
        more = rp_text(s->arena, "%s; the runs have all measures only for %s", more, cut_ends(s, a));
    if (a->n_next > 0)
        more =
            rp_text(s->arena,
                    "%s; %zu of %zu runs are made, and the next stage needs %zu more: give a larger --budget",
                    more, a->n_runs, s->quest.budget, a->n_next);
    return rp_fail(RP_NO_RESULT, "%s: %s: %s%s", s->name[p], stats_identified_words[status],
                   stats_identified_meanings[status], more);
}

static rp_status plan_alone(const cli_call *call, const sweep_problem *s)
{
    size_t points, runs;
    RP_TRY(rp_prefix(stats_first_stage(&s->quest, &points, &runs), "%s: ", s->path));
    cli_provenance(call, call->out);
    rp_table_note(call->out, "first stage", "%zu points, %zu runs; at most %zu in all", points, runs,
                  s->quest.budget);
    rp_table_header(call->out, call->units, "number, group, value, error");
    for (size_t k = 0; k < s->quest.n_numbers; k++) {
        fprintf(call->out, "%s\t", s->number[k].of);
        CLI_ROW((double)s->quest.group[k] + 1.0, s->quest.value[k], s->quest.error[k]);
    }
    return RP_OK;
}

/* ---- the call ---- */

/* A friction whose piles have these angles, as a file: to look at, and to change a copy of. */
static rp_status write_angles(const cli_call *call, const calibrate_options *o, const char **text)
{
    const struct {
        const char *option, *error_option, *of;
        double value, error;
    } angles[] = {{"theta-r-deg", "error-deg", "theta_r3_deg", o->theta_r_deg, o->error_deg},
                  {"theta-t-deg", "theta-t-error-deg", "theta_t_displacement_deg", o->theta_t_deg,
                   o->theta_t_error_deg}};
    const char *numbers = "";
    for (int k = 0; k < 2; k++) {
        const bool valued = !isinf(angles[k].value), has_error = !isinf(angles[k].error);
        if (valued != has_error)
            return rp_fail(RP_USAGE, "--%s needs --%s", valued ? angles[k].option : angles[k].error_option,
                           valued ? angles[k].error_option : angles[k].option);
        if (valued)
            numbers = rp_text(call->arena,
                              "%s%s  { protocol = \"repose\"; of = \"%s\"; value = %.17e; error = %.17e;\n"
                              "    fixed = { W = 4.0; H = 4.0; floor = \"extends\"; slip = \"truncated\"; "
                              "theta_t = true; }; }",
                              numbers, *numbers ? ",\n" : "", angles[k].of, angles[k].value, angles[k].error);
    }
    if (!*numbers)
        return rp_fail(RP_USAGE, "FILE.cfg, --theta-r-deg or --theta-t-deg is required; see repose calibrate "
                                 "--help");
    *text = rp_text(call->arena,
                    "# program: repose %s\n"
                    "# Friction of a box that is opened on one side, from the angles of the pile.\n"
                    "fit = { mu = [0.05, 0.8]; };\nmeasured = (\n%s );\n",
                    RP_VERSION, numbers);
    return RP_OK;
}

static rp_status write_file(const cli_call *call, const char *folder, const char *name, const char *text,
                            const sweep_problem *s, const stats_answer *a)
{
    const char *path;
    cli_call into = *call;
    RP_TRY(rp_path(call->arena, &path, "%s/%s", folder, name));
    RP_TRY(rp_file_open(path, true, &into.out));
    if (text)
        fputs(text, into.out);
    else
        print_answer(&into, s, a);
    return rp_file_close(path, into.out, RP_OK);
}

/* Grows in DIR.part, and gets its name when it is whole: not where --budget would give more. */
static rp_status solve(const cli_call *call, sweep_problem *s, const char *text, stats_answer *a)
{
    const calibrate_options *o = call->values;
    RP_ENDS(rp_folder_end) rp_folder f = {0};
    if (s->quest.fixed_runs) return sweep_problem_solve(s, NULL, NULL, a);
    RP_TRY(rp_folder_begin(call->arena, o->o, rp_text(call->arena, "%s, key %s", s->path, s->key), o->force,
                           &f));
    RP_TRY(sweep_problem_solve(s, f.part, f.snapshot, a));
    if (a->n_next > 0) return RP_OK;
    if (text) RP_TRY(write_file(call, f.part, "angle.cfg", text, s, a));
    RP_TRY(write_file(call, f.part, "answer.tsv", NULL, s, a));
    return rp_folder_publish(&f);
}

static rp_status calibrate(cli_call *call, const void *values)
{
    const calibrate_options *o = values;
    const char *file = cli_argument(call, 0), *text = NULL;
    if (file && (!isinf(o->theta_r_deg) || !isinf(o->error_deg) || !isinf(o->theta_t_deg) ||
                 !isinf(o->theta_t_error_deg)))
        return rp_fail(RP_USAGE, "%s says what is measured: no --theta-r-deg and no --theta-t-deg", file);
    if (!file) RP_TRY(write_angles(call, o, &text));
    calibration c = {.o = o};
    RP_ENDS(sweep_problem_free)
    sweep_problem s = {.arena = call->arena,
                       .path = text ? "angle.cfg" : rp_data(call->arena, file),
                       .protocols = sweep_protocols,
                       .command = call->line,
                       .run = run_sweep,
                       .context = &c,
                       .quest.tell = tell};
    stats_answer a;
    RP_TRY(sweep_problem_read(&s, text));
    if (o->budget > 0) s.quest.budget = (size_t)o->budget;
    if (o->dry_run) return plan_alone(call, &s);
    RP_TRY(solve(call, &s, text, &a));
    print_answer(call, &s, &a);
    return conclude(&s, &a);
}

const cli_command cmd_calibrate = {
    "calibrate",
    "find the parameters that give measured values, with intervals",
    "--theta-r-deg ANGLE --error-deg SE [options]\n"
    "FILE.cfg [-o DIR] [--budget RUNS] [--dry-run]",
    "--theta-r-deg: finds the coefficient of friction mu with which the pile that is left when a box is "
    "opened on one side has this angle of repose, and with --theta-t-deg also this tilting angle. "
    "DIR/angle.cfg is the fit file that it uses; for different piles, change a copy of it.\n"
    "\n"
    "FILE.cfg: determines up to three `let` variables of experiments from measured values. The file has fit "
    "= { NAME = [from, to]; } and measured = ( { experiment, of, value, error } ), where `of` is a column of "
    "the experiment's sweep. It may have fixed = { ... }, model_error, where = \"CONDITION\" on the "
    "variables, seed and budget, and `protocol` instead of `experiment`, or `runs`, a table of runs of a "
    "different program. Each measure is fitted by a polynomial in the variables over the runs of a design, "
    "with more terms if the runs need them. Where the fit agrees with the measured values, a smaller "
    "parameter region gets more runs, until convergence. The first stage takes 24 runs of each experiment "
    "for one variable, 40 for two, and 56 for three. Each stage ends with a line that says what is known.\n"
    "\n"
    "The result grows in DIR.part, which is renamed to DIR when it is complete. It has answer.tsv, and for "
    "each stage and experiment a sweep file, such as stage_1_1.cfg, and the table of its runs. After a stop "
    "or a kill the same command continues; after the status budget it continues with a larger --budget.\n"
    "\n"
    "The answer has a row for each variable: its best value, the standard error se, and the 95 % interval "
    "from lower to upper, which covers measurement error, run scatter and lack of fit (a profile interval of "
    "chi2). If separate intervals agree with the measured values, each has a row. The header has for each "
    "measure:\n"
    "  residual    measured minus fitted value, over the standard error of both\n"
    "  form p      probability that the means of the runs lie this far from the fitted\n"
    "              polynomial by chance; distances below a tenth of the measurement\n"
    "              error are ignored. Below 0.01 the polynomial is rejected, and no\n"
    "              value is printed. Not known without repeated runs\n"
    "  runs reach  smallest and largest mean of the measure at any design point\n"
    "It also has the correlations of the variables, the combination of the variables that is determined "
    "best, and how many design points are recovered if they are left out of the fit one by one.\n"
    "\n"
    "status is one of\n"
#define X(name, word, meaning) "  " word ": " meaning "\n"
    STATS_IDENTIFIED_LIST(X)
#undef X
        "The exit status is 1 unless the status is ok. The answer holds for the experiments that ran, and "
        "not for a different model, protocol or size.",
    "repose calibrate fit.cfg -o found",
    calibrate_params,
    .refuses = "A folder with a finished result, without --force; a folder with other files.\n"
               "An angle without its standard error; a column that the runs do not have; a variable that no "
               "experiment has.",
    .act = calibrate};
