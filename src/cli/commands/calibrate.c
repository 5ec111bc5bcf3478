/* repose calibrate: from a measured angle of repose, and a tilting angle, to the friction that gives it. */
#include <string.h>

#include "stats/calibrate.h"
#include "cli/cli.h"

#define CALIBRATE_OPTIONS(X)                                                                                 \
    X(REAL, theta_r_deg, "deg", "none", "(-90, 90) | none", "measured angle of repose, by method 3")         \
    X(REAL, error_deg, "deg", "none", "[0, 90) | none", "its standard error")                                \
    X(REAL, theta_t_deg, "deg", "none", "[0, 90) | none", "measured tilt at which the pile moves")           \
    X(REAL, theta_t_error_deg, "deg", "none", "[0, 90) | none", "its standard error")                        \
    X(TEXT, fit, "", "mu", "",                                                                               \
      "parameter sought, or two (mu,mu_roll); the piles must vary these and no others")                      \
    X(TEXT, sweep, "", "sweeps/studies/calibrate.cfg", "", "sweep file of the piles that give the response") \
    X(TEXT, o, "", "calibrate", "", "folder of that sweep; runs that it holds are not made again")           \
    X(TEXT, runs, "", "", "", "table of piles in place of a sweep, as repose sweep export writes")           \
    CLI_FORCE(X)                                                                                             \
    CLI_QUIET(X)                                                                                             \
    CLI_WORKERS(X)                                                                                           \
    X(INT, bootstrap, "", "500", "[2, 100000]", "resamples of the piles, to check error and interval")       \
    X(INT, verify, "", "0", "[0, 100000]", "in place of a measurement, so many cases whose truth is known")  \
    X(TEXT, planted, "", "sweeps/studies/calibrate_planted.cfg", "",                                         \
      "their piles: a sweep file (.cfg, run in the folder -o with _planted added), a table, or hold-out: "   \
      "half of the response's own")                                                                          \
    X(BOOL, response, "", "false", "",                                                                       \
      "in place of a measurement, the fitted angles over the range of --fit")                                \
    CLI_SEED(X, "1993", "seed of the resamples and of hold-out")

CLI_OPTIONS(calibrate, CALIBRATE_OPTIONS)

enum { N_ANGLES = 2 };
static const char *const angle_names[N_ANGLES] = {"theta_r", "theta_t"};
static const char *const angle_columns[N_ANGLES] = {"theta_r3_deg", "theta_t_displacement_deg"};

/* ---- piles ---- */

typedef struct {
    rp_table *table;
    char path[4096];
    const char *params[STATS_MAX_PARAMS]; /* names */
    stats_ensemble piles;                 /* with result; their angles are these: */
    const double *angle[N_ANGLES];        /* NULL for one that no pile has */
} source;

/* Run what is missing of a sweep and leave its rows as a table in its folder. */
static rp_status run_sweep(const cli_call *call, const char *file, const char *folder,
                           const calibrate_options *o, char path[4096])
{
    sweep_counts counts;
    RP_TRY(cli_claim_sweep(folder, file, o->force));
    RP_TRY(sweep_prepare(file, folder, 0, sweep_protocols, NULL, &counts));
    if (!o->quiet && counts.stored < counts.planned)
        fprintf(stderr, "repose calibrate: makes %zu piles, once, and keeps them in the folder %s\n",
                counts.planned - counts.stored, folder);
    RP_TRY(cli_sweep_run(folder, (sweep_options){.workers = (int)o->j, .snapshot = CLI_SNAPSHOT}, o->quiet,
                         &counts));
    snprintf(path, 4096, "%s/runs.tsv", folder);
    return cli_sweep_export(call, folder, SWEEP_RUNS, path, NULL);
}

/* The names under --fit, one or two, as column numbers. */
static rp_status find_fit(const rp_table *t, const char *fit, size_t *n, int columns[STATS_MAX_PARAMS])
{
    rp_status status = cli_column_list(t, fit, STATS_MAX_PARAMS, n, columns);
    if (status) {
        char why[512];
        snprintf(why, sizeof why, "%s", rp_message());
        return rp_fail(status, "%s; the piles must vary each parameter", why);
    }
    if (*n < 2 || columns[0] != columns[1]) return RP_OK;
    return rp_fail(RP_BAD_INPUT, "--fit = \"%s\": the same parameter twice", fit);
}

/* The response is a function of the parameters sought: nothing else may vary. */
static rp_status refuse_others(const rp_table *t, size_t n, const int columns[])
{
    for (const rp_param *p = sweep_protocol_repose.schema; p->name; p++) {
        int c = rp_table_column(t, p->name);
        if (c < 0 || c == columns[0] || (n > 1 && c == columns[1])) continue;
        for (size_t i = 1; i < t->n_rows; i++)
            if (strcmp(cli_text(t, i, c), cli_text(t, 0, c)) != 0)
                return rp_fail(RP_BAD_INPUT, "%s:%zu: %s varies too, and is not under --fit",
                               t->places[i].path, t->places[i].line, p->name);
    }
    return RP_OK;
}

/* Is an angle in the table for any pile? A protocol that did not measure it leaves nan. */
static bool has_values(size_t n, const double angle[])
{
    for (size_t i = 0; i < n; i++)
        if (!isnan(angle[i])) return true;
    return false;
}

/* Columns of the rows with result: parameters first, then the angles that there are. */
static rp_status read_piles(rp_arena *arena, source *s, const char *fit)
{
    const rp_table *t = s->table;
    char names[256];
    int columns[STATS_MAX_PARAMS];
    cli_rows rows;
    size_t n_params, used = (size_t)snprintf(names, sizeof names, "%.128s", fit);
    RP_TRY(find_fit(t, fit, &n_params, columns));
    RP_TRY(refuse_others(t, n_params, columns));
    for (size_t a = 0; a < N_ANGLES; a++)
        if (rp_table_column(t, angle_columns[a]) >= 0)
            used += (size_t)snprintf(names + used, sizeof names - used, ",%s", angle_columns[a]);
    RP_TRY(cli_rows_read(arena, t, names, &(cli_choice){.any_number = true}, &rows));
    s->piles.n = rows.n;
    s->piles.n_params = n_params;
    for (size_t p = 0; p < n_params; p++) {
        s->piles.x[p] = rows.column[p];
        s->params[p] = t->names[columns[p]];
    }
    for (size_t a = 0, c = n_params; a < N_ANGLES; a++) {
        if (rp_table_column(t, angle_columns[a]) < 0) continue;
        const double *angle = rows.column[c++];
        s->angle[a] = has_values(rows.n, angle) ? angle : NULL;
    }
    return RP_OK;
}

/* The a-th angle of `mask` (bit a for angle a). */
static size_t angle_of(unsigned mask, size_t a)
{
    return mask == 2 ? 1 : a;
}

/* The piles with the angles of `mask`; false if one of them is missing. */
static bool choose_angles(const source *s, unsigned mask, stats_ensemble *piles)
{
    *piles = s->piles;
    piles->n_angles = 0;
    for (size_t a = 0; a < N_ANGLES; a++) {
        if (!(mask & 1u << a)) continue;
        if (!s->angle[a]) return false;
        piles->angle[piles->n_angles++] = s->angle[a];
    }
    return true;
}

static rp_status open_source(const cli_call *call, const char *sweep, const char *folder, const char *table,
                             const calibrate_options *o, source *s)
{
    if (table)
        snprintf(s->path, sizeof s->path, "%s", table);
    else
        RP_TRY(run_sweep(call, cli_data(call->arena, sweep), folder, o, s->path));
    RP_TRY(cli_table_read(call->arena, s->path, &s->table));
    return read_piles(call->arena, s, o->fit);
}

/* ---- what the answer holds for ---- */

static void note_piles(const char *key, const source *s)
{
    const char *sweep = rp_table_find_note(s->table, "sweep");
    rp_table_note(stdout, key, "%s; %zu piles used, %zu rows without result", sweep ? sweep : s->path,
                  s->piles.n, s->table->n_rows - s->piles.n);
}

/* Model and protocol from the header of the piles' table. */
static void note_scope(const source *s)
{
    const char *rotation = rp_table_find_note(s->table, "rotation"), *text;
    size_t known = 0;
    rp_table_note(
        stdout, "holds for",
        "two-dimensional piles in a box whose right wall is removed; grains %s; theta_r by method 3, "
        "theta_t by displacement; the parameters that follow",
        rp_table_column(s->table, "rotation") >= 0 || (rotation && strcmp(rotation, "true") == 0)
            ? "rotate"
            : "do not rotate");
    for (const rp_param *p = sweep_protocol_repose.schema; p->name; p++)
        if ((text = rp_table_find_note(s->table, p->name))) {
            rp_table_note(stdout, p->name, "%s", text);
            known++;
        }
    if (!known) rp_table_note(stdout, "parameters", "unknown: the table of piles does not name them");
    rp_table_note(stdout, "not for",
                  "other models, protocols or sizes: the answer does not carry over to them");
}

/* "theta_r from 10 to 35 degrees and theta_t ..., for 0.1 <= mu <= 0.6" */
static void reach_text(const source *s, const stats_calibration *c, unsigned mask, char *text, size_t size)
{
    size_t used = 0;
    for (size_t a = 0; a < c->n_angles; a++) {
        double reach[2], at[2][STATS_MAX_PARAMS];
        stats_calibration_reach(c, a, reach, at);
        used += (size_t)snprintf(text + used, size - used, "%s%s from %.3g to %.3g degrees",
                                 used ? " and " : "", angle_names[angle_of(mask, a)], reach[0], reach[1]);
    }
    for (size_t p = 0; p < c->n_params; p++)
        used += (size_t)snprintf(text + used, size - used, "%s%g <= %.40s <= %g", p ? ", " : ", for ",
                                 c->lo[p], s->params[p], c->hi[p]);
}

static void note_responses(const source *s, const stats_calibration *c, unsigned mask)
{
    char reach[512];
    for (size_t a = 0; a < c->n_angles; a++) {
        const stats_response_fit *r = &c->response[a];
        rp_table_note(stdout, "response",
                      "%s: %s, degree %zu%s, %zu coefficients, %zu points, chi2 = %.3g, p = %.2g, "
                      "discrepancy %.2g deg%s",
                      angle_names[angle_of(mask, a)], stats_shape_words[r->shape], r->degree[0],
                      r->degree[1] == 1   ? " and 1"
                      : r->degree[1] == 2 ? " and 2"
                                          : "",
                      r->n_terms, r->n_points, r->chi2, r->p_value, sqrt(r->discrepancy),
                      r->monotone ? "" : ", not monotone");
    }
    reach_text(s, c, mask, reach, sizeof reach);
    rp_table_note(stdout, "reach", "%s", reach);
    for (size_t p = 0; p < c->n_params; p++) rp_table_note(stdout, "range", "%g to %g", c->lo[p], c->hi[p]);
    if (c->n_angles == 2) rp_table_note(stdout, "correlation of the angles", "%.2f", c->correlation);
}

static void print_head(const cli_call *call, const source *s, const stats_calibration *c, unsigned mask)
{
    cli_table(call, stdout);
    note_piles("piles", s);
    note_responses(s, c, mask);
    note_scope(s);
}

/* ---- a measurement ---- */

/* Of all solutions together; NaN without one. */
static double lower_limit(const stats_calibrated *f)
{
    return f->n_solutions ? f->solutions[0].lower : NAN;
}

static double upper_limit(const stats_calibrated *f)
{
    return f->n_solutions ? f->solutions[f->n_solutions - 1].upper : NAN;
}

static void print_found(const source *s, const stats_calibrated found[])
{
    rp_table_header(stdout, "parameter, value, se, lower, upper, boot_se, boot_lower, boot_upper, status");
    for (size_t p = 0; p < s->piles.n_params; p++)
        for (size_t k = 0; k < (found[p].n_solutions ? found[p].n_solutions : 1); k++) {
            const stats_calibrated *f = &found[p];
            bool none = f->n_solutions == 0;
            printf("%s\t", s->params[p]);
            CLI_ROW_WORD(stats_calibrated_words[f->status], none ? NAN : f->solutions[k].value, f->se,
                         none ? NAN : f->solutions[k].lower, none ? NAN : f->solutions[k].upper, f->boot_se,
                         f->boot_lower, f->boot_upper);
        }
}

/* What would make these piles reach the measurement: more of the range where the response is largest, or
 * smallest, at an end. Near its end the response may be flat. */
static const char *how_to_extend(const source *s, const stats_calibration *c, stats_calibrated_status why,
                                 char text[256])
{
    const bool above = why == STATS_CALIBRATED_ABOVE_RANGE;
    if (c->n_params > 1 || why == STATS_CALIBRATED_NO_MATCH) {
        snprintf(text, 256, "piles of other %s (--sweep), or of another parameter (--fit), may reach further",
                 s->params[0]);
        return text;
    }
    double reach[2], at[2][STATS_MAX_PARAMS], variance;
    stats_calibration_reach(c, 0, reach, at);
    const double x = at[above][0], inward = 0.1 * (c->hi[0] - c->lo[0]);
    const bool inside = x > c->lo[0] && x < c->hi[0], upper = x == c->hi[0];
    const double near =
        stats_response_value(&c->response[0], &(double){upper ? x - inward : x + inward}, &variance);
    if (inside)
        snprintf(text, 256,
                 "the angle is %s within the range, near %s = %.3g: vary another parameter (--fit)",
                 above ? "largest" : "smallest", s->params[0], x);
    else if (fabs(reach[above] - near) < 0.02 * (reach[1] - reach[0]))
        snprintf(text, 256, "the angle hardly changes near %s = %g: vary another parameter (--fit)",
                 s->params[0], x);
    else
        snprintf(text, 256, "piles with %s %s %g (--sweep) extend it", s->params[0],
                 upper ? "above" : "below", x);
    return text;
}

/* A match with an angle that no response reaches rests on the scatter and the discrepancy alone. */
static void warn_outside(const stats_calibration *c, unsigned mask, const stats_measured *m)
{
    for (size_t a = 0; a < c->n_angles; a++) {
        double reach[2], at[2][STATS_MAX_PARAMS];
        stats_calibration_reach(c, a, reach, at);
        if (m->angle[a] < reach[0] || m->angle[a] > reach[1])
            fprintf(stderr,
                    "repose calibrate: %s = %g degrees lies outside what the response reaches, %.3g to %.3g: "
                    "the answer rests on the errors alone\n",
                    angle_names[angle_of(mask, a)], m->angle[a], reach[0], reach[1]);
    }
}

/* Exit status 1 and what is known, for the first parameter that is not found. */
static rp_status conclude(const source *s, const stats_calibration *c, unsigned mask,
                          const stats_calibrated found[])
{
    char text[128] = "", reach[512], extend[256];
    for (size_t p = 0; p < s->piles.n_params; p++) {
        const stats_calibrated *f = &found[p];
        const char *name = s->params[p];
        if (f->status == STATS_CALIBRATED_OK) continue;
        const double lower = lower_limit(f), upper = upper_limit(f);
        if (!isnan(lower) && !isnan(upper))
            snprintf(text, sizeof text, "; %g <= %s <= %g", lower, name, upper);
        else if (!isnan(lower))
            snprintf(text, sizeof text, "; %s >= %g", name, lower);
        else if (!isnan(upper))
            snprintf(text, sizeof text, "; %s <= %g", name, upper);
        if (f->status >= STATS_CALIBRATED_ABOVE_RANGE) {
            reach_text(s, c, mask, reach, sizeof reach);
            return rp_fail(RP_NO_RESULT, "%s: %s: %s%s; these piles reach %s; %s", name,
                           stats_calibrated_words[f->status], stats_calibrated_meanings[f->status], text,
                           reach, how_to_extend(s, c, f->status, extend));
        }
        return rp_fail(RP_NO_RESULT, "%s: %s: %s%s", name, stats_calibrated_words[f->status],
                       stats_calibrated_meanings[f->status], text);
    }
    return RP_OK;
}

static rp_status calibrate(const cli_call *call, const source *s, const calibrate_options *o)
{
    const double angles[N_ANGLES] = {o->theta_r_deg, o->theta_t_deg};
    const double errors[N_ANGLES] = {o->error_deg, o->theta_t_error_deg};
    unsigned mask = 0;
    stats_measured m;
    size_t n = 0;
    for (size_t a = 0; a < N_ANGLES; a++)
        if (!isinf(angles[a])) {
            mask |= 1u << a;
            m.angle[n] = angles[a];
            m.error[n++] = errors[a];
            if (!s->angle[a])
                return rp_fail(RP_BAD_INPUT, "%s: no values of \"%s\"", s->path, angle_columns[a]);
        }
    stats_ensemble piles;
    stats_calibration c;
    stats_calibrated found[STATS_MAX_PARAMS];
    choose_angles(s, mask, &piles);
    rp_status status = rp_prefix(stats_calibration_fit(&piles, &c), "%s: ", s->path);
    if (!status) status = stats_calibration_invert(&c, &m, found);
    if (!status)
        status =
            stats_calibration_bootstrap(&piles, &c, &m, (size_t)o->bootstrap, cli_random(call, 0), found);
    if (!status) {
        print_head(call, s, &c, mask);
        print_found(s, found);
        status = conclude(s, &c, mask, found);
        if (!status) warn_outside(&c, mask, &m);
    }
    stats_calibration_free(&c);
    return status;
}

/* ---- the response ---- */

/* A row for each of 21 values of the parameter, or of 11 values each of two. */
static void print_response_rows(const stats_calibration *c)
{
    const size_t side = c->n_params > 1 ? 11 : 21, n = c->n_params > 1 ? side * side : side;
    for (size_t i = 0; i < n; i++) {
        const size_t step[] = {c->n_params > 1 ? i / side : i, i % side};
        double row[STATS_MAX_PARAMS + 3 * N_ANGLES], x[STATS_MAX_PARAMS], variance;
        size_t used = 0;
        for (size_t p = 0; p < c->n_params; p++)
            row[used++] = x[p] = c->lo[p] + (double)step[p] / (double)(side - 1) * (c->hi[p] - c->lo[p]);
        for (size_t a = 0; a < c->n_angles; a++) {
            row[used++] = stats_response_value(&c->response[a], x, &variance);
            row[used++] = sqrt(variance);
            row[used++] = stats_calibration_sd(c, a, x);
        }
        rp_table_row(stdout, used, row);
    }
}

static rp_status print_response(const cli_call *call, const source *s)
{
    char header[512] = "";
    size_t used = 0;
    unsigned mask = 0;
    stats_ensemble piles;
    stats_calibration c;
    for (size_t a = 0; a < N_ANGLES; a++) mask |= s->angle[a] ? 1u << a : 0u;
    if (!mask) return rp_fail(RP_BAD_INPUT, "%s: no values of \"%s\"", s->path, angle_columns[0]);
    choose_angles(s, mask, &piles);
    rp_status status = rp_prefix(stats_calibration_fit(&piles, &c), "%s: ", s->path);
    for (size_t p = 0; p < s->piles.n_params; p++)
        used += (size_t)snprintf(header + used, sizeof header - used, "%.64s, ", s->params[p]);
    for (size_t a = 0; a < piles.n_angles; a++) {
        const char *name = angle_names[angle_of(mask, a)];
        used += (size_t)snprintf(header + used, sizeof header - used,
                                 "%s%s_deg [deg], %s_fit_se_deg [deg], %s_sd_deg [deg]", a ? ", " : "", name,
                                 name, name);
    }
    if (!status) {
        print_head(call, s, &c, mask);
        rp_table_header(stdout, header);
        print_response_rows(&c);
    }
    stats_calibration_free(&c);
    return status;
}

/* ---- cases whose truth is known ---- */

typedef struct {
    size_t n;
    unsigned mask;
    stats_case *cases;
} trial;

static const char *mask_word(unsigned mask)
{
    return mask == 3 ? "both" : angle_names[mask == 2];
}

static rp_status make_trial(const cli_call *call, const source *response, const source *planted,
                            const calibrate_options *o, unsigned mask, trial *t)
{
    stats_ensemble fit, piles;
    stats_calibration c = {0};
    *t = (trial){.mask = mask};
    bool whole = choose_angles(response, mask, &fit) && (!planted || choose_angles(planted, mask, &piles));
    if (!whole || fit.n_params > fit.n_angles) return RP_OK; /* an angle that was not measured, or too few */
    t->cases = rp_arena_memory(call->arena, (size_t)o->verify, sizeof *t->cases);
    rp_status status;
    if (planted) {
        status = stats_calibration_fit(&fit, &c);
        if (!status) note_responses(response, &c, mask);
        if (!status) status = stats_calibration_planted(&c, &piles, (size_t)o->verify, t->cases, &t->n);
    } else {
        status = stats_calibration_holdout(&fit, (size_t)o->verify, cli_random(call, mask), t->cases);
        t->n = (size_t)o->verify;
    }
    stats_calibration_free(&c);
    return status;
}

/* A line for each parameter; false if fewer than 90 % of its intervals hold the truth. */
static bool note_coverage(const trial *t, const source *s)
{
    bool good = true;
    char key[128];
    for (size_t p = 0; p < s->piles.n_params && t->n > 0; p++) {
        size_t covered = 0, ok_covered = 0, counts[STATS_CALIBRATED_NO_MATCH + 1] = {0};
        double sum = 0.0;
        for (size_t k = 0; k < t->n; k++) {
            const stats_calibrated *f = &t->cases[k].found[p];
            covered += t->cases[k].covered[p];
            counts[f->status]++;
            if (f->status != STATS_CALIBRATED_OK) continue;
            ok_covered += t->cases[k].covered[p];
            sum += f->solutions[0].upper - f->solutions[0].lower;
        }
        snprintf(key, sizeof key, "covered_%s_%s", mask_word(t->mask), s->params[p]);
        rp_table_note(stdout, key, "%zu of %zu", covered, t->n);
        snprintf(key, sizeof key, "found_%s_%s", mask_word(t->mask), s->params[p]);
        rp_table_note(stdout, key, "%zu of %zu with two limits, %zu of them cover; mean width %.3g",
                      counts[STATS_CALIBRATED_OK], t->n, ok_covered,
                      sum / (double)counts[STATS_CALIBRATED_OK]);
        for (int i = 1; i <= STATS_CALIBRATED_NO_MATCH; i++)
            if (counts[i] > 0) {
                snprintf(key, sizeof key, "%s_%s_%s", stats_calibrated_words[i], mask_word(t->mask),
                         s->params[p]);
                rp_table_note(stdout, key, "%zu of %zu", counts[i], t->n);
            }
        good = good && 10 * covered >= 9 * t->n;
    }
    return good;
}

static void print_cases(const trial *t, const source *s)
{
    for (size_t k = 0; k < t->n; k++)
        for (size_t p = 0; p < s->piles.n_params; p++) {
            const stats_case *c = &t->cases[k];
            const stats_calibrated *f = &c->found[p];
            double angle[N_ANGLES] = {NAN, NAN}, error[N_ANGLES] = {NAN, NAN};
            for (size_t a = 0, i = 0; a < N_ANGLES; a++)
                if (t->mask & 1u << a) angle[a] = c->measured.angle[i], error[a] = c->measured.error[i++];
            printf("%s\t%s\t", mask_word(t->mask), s->params[p]);
            CLI_ROW_WORD(stats_calibrated_words[f->status], c->truth[p], angle[0], error[0], angle[1],
                         error[1], f->value, f->se, lower_limit(f), upper_limit(f), c->covered[p]);
        }
}

static rp_status verify(const cli_call *call, const source *response, const source *planted,
                        const calibrate_options *o)
{
    trial trials[3] = {{0}};
    bool good = true;
    size_t n = 0;
    cli_table(call, stdout);
    note_piles("piles", response);
    if (planted) note_piles("planted piles", planted);
    note_scope(response);
    for (unsigned mask = 1; mask <= 3; mask++) {
        RP_TRY(make_trial(call, response, planted, o, mask, &trials[mask - 1]));
        good = note_coverage(&trials[mask - 1], response) && good;
        n += trials[mask - 1].n;
    }
    rp_table_header(stdout,
                    "angles, parameter, truth, theta_r_deg [deg], error_deg [deg], theta_t_deg [deg], "
                    "theta_t_error_deg [deg], value, se, lower, upper, covered, status");
    for (int i = 0; i < 3; i++) print_cases(&trials[i], response);
    if (n == 0) return rp_fail(RP_BAD_INPUT, "verify: no angle that response and planted piles have");
    if (!good) return rp_fail(RP_NO_RESULT, "verify: fewer than 90 %% of the intervals hold the truth");
    return RP_OK;
}

/* ---- command ---- */

static rp_status check_options(const cli_call *call, const calibrate_options *o)
{
    static const char *const names[N_ANGLES][2] = {{"theta-r-deg", "error-deg"},
                                                   {"theta-t-deg", "theta-t-error-deg"}};
    bool any = false;
    for (int i = 0; i < N_ANGLES; i++) {
        const bool angle = cli_given(call, names[i][0]), error = cli_given(call, names[i][1]);
        any |= angle;
        if (angle != error) return rp_fail(RP_USAGE, "--%s needs --%s", names[i][error], names[i][angle]);
    }
    if (any + (o->verify > 0) + o->response != 1)
        return rp_fail(RP_USAGE, "%s; see repose calibrate --help",
                       any || o->response ? "a measured angle, --verify or --response, not both"
                                          : "--theta-r-deg or --theta-t-deg is required");
    return RP_OK;
}

static rp_status verify_sources(const cli_call *call, const source *response, const calibrate_options *o)
{
    source planted = {0};
    char folder[4096];
    if (strcmp(o->planted, "hold-out") == 0) return verify(call, response, NULL, o);
    const bool is_sweep = strlen(o->planted) > strlen(".cfg") && rp_ends_in(o->planted, ".cfg");
    snprintf(folder, sizeof folder, "%s_planted", o->o);
    RP_TRY(open_source(call, o->planted, folder, is_sweep ? NULL : o->planted, o, &planted));
    return verify(call, response, &planted, o);
}

static rp_status answer(cli_call *call, const void *values)
{
    const calibrate_options *o = values;
    source response = {0};
    RP_TRY(check_options(call, o));
    RP_TRY(open_source(call, o->sweep, o->o, *o->runs ? o->runs : NULL, o, &response));
    if (o->response) return print_response(call, &response);
    return o->verify > 0 ? verify_sources(call, &response, o) : calibrate(call, &response, o);
}

const cli_command cmd_calibrate = {
    "calibrate",
    "friction that gives a measured angle of repose, with its interval",
    "--theta-r-deg ANGLE --error-deg SE [options]",
    "Finds the friction that gives a measured angle. Piles are simulated over a range of friction; this\n"
    "takes some minutes the first time. The piles stay in the folder -o of the current one, and the next\n"
    "call from there takes no time. The mean angles, weighted by their errors, are fitted by powers or a\n"
    "saturating form, whichever has the least AIC. The fit is inverted.\n"
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
    "The answer holds for the model and protocol that the header names: two-dimensional piles in a box\n"
    "opened on one side. It does not carry over to another model, protocol or size.\n"
    "\n"
    "The header has the range of angles that the piles reach; so has the message of above_range,\n"
    "below_range and no_match, with what would extend it. --response prints the fitted angle, the standard\n"
    "error of the fit and the standard deviation of one pile, over the range of friction.\n"
    "\n"
    "--verify prints one row per case; the exit status is 1 if fewer than 90 % of the intervals contain\n"
    "the truth.",
    "repose calibrate --theta-r-deg 25 --error-deg 1",
    calibrate_params,
    .act = answer};
