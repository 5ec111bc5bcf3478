/* Emulators of the runs of a design, and their predictions for draws of the choices; see forensics.h. */
#include <math.h>
#include <stdint.h>
#include <string.h>

#include "cli/cli.h"
#include "cli/forensics.h"

/* Cells that decide the hyperparameters: their cost grows with the cube. The first settings of Sobol's
 * sequence fill the space as all do. */
enum { FIT_CELLS = 400 };

/* The group of all settings after the first sweep. */
static const size_t LATER = SIZE_MAX;

/* ---- inputs ---- */

static size_t count_inputs(const forensics_study *s)
{
    size_t n = 0;
    for (size_t g = 0; g < SWEEP_N_GROUPS; g++) n += s->varies[g];
    return n;
}

/* The groups that vary, from -1 to 1 over the range of the cells. */
static void set_inputs(const forensics_study *s, const double group[], double x[])
{
    for (size_t g = 0; g < SWEEP_N_GROUPS; g++)
        if (s->varies[g])
            *x++ = (2.0 * forensics_scaled(g, group[g]) - s->lo[g] - s->hi[g]) / (s->hi[g] - s->lo[g]);
}

/* The cells for which use[c] is a number. */
static stats_inputs take_cells(const forensics_study *s, const double use[], forensics_emulator *m)
{
    const size_t n_reals = count_inputs(s);
    m->x = cli_memory(s->n_cells * n_reals, sizeof *m->x);
    m->level = cli_memory(s->n_cells * s->n_factors, sizeof *m->level);
    m->variance = cli_memory(s->n_cells, sizeof *m->variance);
    m->group = cli_memory(s->n_cells, sizeof *m->group);
    m->n = 0;
    for (size_t c = 0; c < s->n_cells; c++) {
        if (!isfinite(use[c])) continue;
        const size_t row = s->first[s->setting[c]];
        set_inputs(s, s->group + c * SWEEP_N_GROUPS, m->x + m->n * n_reals);
        for (size_t f = 0; f < s->n_factors; f++)
            m->level[m->n * s->n_factors + f] = (int)s->factors[f].levels.of_row[row];
        m->group[m->n++] = row < s->n_first ? s->setting[c] : LATER;
    }
    return (stats_inputs){m->n, n_reals, s->n_factors, m->x, m->level};
}

/* The values of the same cells less their mean; a cell that lacks a value has the mean. */
static double *centred(const forensics_study *s, const double use[], const double value[], double *centre)
{
    double *y = cli_memory(s->n_cells, sizeof *y), sum = 0.0, number = 0.0;
    size_t n = 0;
    for (size_t c = 0; c < s->n_cells; c++)
        if (isfinite(use[c]) && isfinite(value[c])) sum += value[c], number++;
    *centre = number > 0.0 ? sum / number : 0.0;
    for (size_t c = 0; c < s->n_cells; c++)
        if (isfinite(use[c])) y[n++] = isfinite(value[c]) ? value[c] - *centre : 0.0;
    return y;
}

static double root_mean_square(size_t n, const double v[])
{
    double sum = 0.0;
    for (size_t i = 0; i < n; i++) sum += v[i] * v[i];
    return sqrt(sum / (double)n);
}

/* ---- emulators ---- */

/* Values beside the predictions made without them, of the first sweep's settings or of the later ones. */
static forensics_left_out compare_left_out(const forensics_emulator *m, bool later, const double y[],
                                           const double mean[], const double variance[])
{
    const double quantile = 1.959963984540054; /* of 95 % */
    double n = 0.0, sum = 0.0, squares = 0.0, noise = 0.0, error = 0.0, stated = 0.0, covered = 0.0;
    for (size_t i = 0; i < m->n; i++) {
        if ((m->group[i] == LATER) != later) continue;
        const double r = y[i] - mean[i];
        n++;
        sum += y[i];
        squares += y[i] * y[i];
        noise += m->variance[i];
        error += r * r;
        stated += variance[i];
        covered += fabs(r) <= quantile * sqrt(variance[i]);
    }
    return (forensics_left_out){(size_t)n,        sqrt(squares / n - sum * sum / (n * n)),
                                sqrt(noise / n),  sqrt(error / n),
                                sqrt(stated / n), covered / n};
}

/* Fit by one kernel, and note what it predicts of cells that are left out. */
static rp_status try_kernel(forensics_emulator *m, stats_kernel kernel, const stats_inputs *in,
                            const double y[], stats_emulator *e)
{
    double *mean = cli_memory(m->n, sizeof *mean), *variance = cli_memory(m->n, sizeof *variance);
    RP_TRY(stats_emulator_make(kernel, in, m->variance, m->spread, e));
    RP_TRY(stats_emulator_fit(e, y, FIT_CELLS));
    RP_TRY(stats_emulator_leave_out(e, y, m->group, mean, variance, &m->of[kernel].score));
    m->of[kernel].setting = compare_left_out(m, false, y, mean, variance);
    m->of[kernel].sweep = compare_left_out(m, true, y, mean, variance);
    return RP_OK;
}

/* Both kernels; the one that predicts better is kept. */
static rp_status choose_kernel(forensics_emulator *m, const stats_inputs *in, const double y[])
{
    rp_status status = try_kernel(m, STATS_SMOOTH, in, y, &m->e);
    stats_emulator other = {0};
    if (!status) status = try_kernel(m, STATS_QUADRATIC, in, y, &other);
    m->kernel =
        !status && m->of[STATS_QUADRATIC].score > m->of[STATS_SMOOTH].score ? STATS_QUADRATIC : STATS_SMOOTH;
    if (m->kernel == STATS_QUADRATIC) {
        const stats_emulator kept = other;
        other = m->e;
        m->e = kept;
    }
    stats_emulator_free(&other);
    return status;
}

/* Weights of all stems and surfaces. They share the covariance of the first, up to a factor. */
static void weigh(const forensics_study *s, forensics_emulator *m)
{
    const size_t n_sets = s->claims->n_stems * FORENSICS_SURFACES;
    double first = 0.0;
    m->weights = cli_memory(n_sets * m->n, sizeof *m->weights);
    m->centre = cli_memory(n_sets, sizeof *m->centre);
    m->scale = cli_memory(n_sets, sizeof *m->scale);
    for (size_t k = 0; k < n_sets; k++) {
        const double *y = centred(s, s->mean, s->mean + k * s->n_cells, &m->centre[k]);
        double *w = m->weights + k * m->n, sum = 0.0;
        stats_emulator_weights(&m->e, y, w);
        for (size_t i = 0; i < m->n; i++) sum += y[i] * w[i];
        if (k == 0) first = sum;
        m->scale[k] = sum / first;
    }
}

rp_status forensics_emulate(const forensics_study *s, forensics_emulator *m)
{
    double centre;
    *m = (forensics_emulator){0};
    const stats_inputs in = take_cells(s, s->mean, m);
    const double *y = centred(s, s->mean, s->mean, &centre);
    double sum = 0.0;
    for (size_t c = 0, i = 0; c < s->n_cells; c++)
        if (isfinite(s->mean[c])) sum += m->variance[i++] = s->variance[c];
    m->spread = root_mean_square(m->n, y);
    m->noise = sqrt(sum / (double)m->n);
    RP_TRY(choose_kernel(m, &in, y));
    weigh(s, m);
    return RP_OK;
}

rp_status forensics_emulate_completion(const forensics_study *s, forensics_emulator *m)
{
    double *value = cli_memory(s->n_cells, sizeof *value);
    *m = (forensics_emulator){0};
    const stats_inputs in = take_cells(s, s->runs_of, m); /* all */
    for (size_t c = 0; c < s->n_cells; c++) stats_probit(s->ok[c], s->runs_of[c], &value[c], &m->variance[c]);
    m->centre = cli_memory(1, sizeof *m->centre);
    m->weights = cli_memory(m->n, sizeof *m->weights);
    const double *y = centred(s, s->runs_of, value, m->centre);
    m->spread = root_mean_square(m->n, y);
    RP_TRY(choose_kernel(m, &in, y));
    stats_emulator_weights(&m->e, y, m->weights);
    return RP_OK;
}

/* ---- draws ---- */

/* The groups of a draw at the base. */
static void set_groups(const forensics_study *s, const double u[], double value[])
{
    for (size_t g = 0; g < SWEEP_N_GROUPS; g++) {
        const double lo = forensics_scaled(g, sweep_groups[g].lo),
                     hi = forensics_scaled(g, sweep_groups[g].hi);
        value[g] = s->is_choice[g] ? forensics_unscaled(g, lo + (hi - lo) * *u++) : s->base[g];
    }
}

rp_status forensics_draw_params(const forensics_study *s, const forensics_draws *draws, size_t d,
                                void *params)
{
    repose_params_copy(params, draws->base);
    for (size_t f = 0; f < s->n_factors; f++)
        RP_TRY(repose_params_set(params, s->factors[f].name,
                                 s->factors[f].levels.words[draws->level[f * draws->n + d]]));
    sweep_groups_apply(draws->value + d * SWEEP_N_GROUPS, params);
    return RP_OK;
}

/* Inputs of a draw at all points. */
static rp_status set_points(const forensics_study *s, const void *params, void *work, const int level[],
                            double x[], int levels[])
{
    const size_t n_reals = count_inputs(s);
    for (size_t k = 0; k < s->claims->n_points; k++) {
        double group[SWEEP_N_GROUPS];
        repose_params_copy(work, params);
        RP_TRY(repose_params_at(work, &s->claims->points[k]));
        sweep_groups_of(work, group);
        set_inputs(s, group, x + k * n_reals);
        memcpy(levels + k * s->n_factors, level, s->n_factors * sizeof *level);
    }
    return RP_OK;
}

static rp_status predict(const forensics_study *s, const forensics_emulator *angles,
                         const forensics_emulator *completion, const stats_inputs *at, size_t d,
                         forensics_draws *draws)
{
    const size_t n = at->n;
    double *mean = draws->mean + d * draws->n_sets * n, z[FORENSICS_CLAIMS],
           block[FORENSICS_CLAIMS * FORENSICS_CLAIMS];
    RP_TRY(stats_emulator_predict(&angles->e, at, draws->n_sets, angles->weights, mean,
                                  draws->covariance + d * n * n));
    for (size_t k = 0; k < draws->n_sets * n; k++) mean[k] += angles->centre[k / n];
    if (!completion) return RP_OK;
    RP_TRY(stats_emulator_predict(&completion->e, at, 1, completion->weights, z, block));
    for (size_t i = 0; i < s->claims->n; i++) {
        const size_t k = s->claims->claims[i].point;
        if (!s->claims->claims[i].held)
            draws->log_complete[d] += stats_log_normal_chance(z[k] + *completion->centre, block[k * n + k]);
    }
    return RP_OK;
}

rp_status forensics_draw(const forensics_study *s, const forensics_emulator *angles,
                         const forensics_emulator *completion, size_t n, gsl_rng *rng, forensics_draws *draws)
{
    const size_t k = s->claims->n_points, n_reals = count_inputs(s);
    size_t n_choices = 0, n_levels[FORENSICS_FACTORS];
    for (size_t g = 0; g < SWEEP_N_GROUPS; g++) n_choices += s->is_choice[g];
    for (size_t f = 0; f < s->n_factors; f++) n_levels[f] = s->factors[f].levels.n_groups;
    *draws = (forensics_draws){.n = n, .n_sets = s->claims->n_stems * FORENSICS_SURFACES};
    draws->value = cli_memory(n * SWEEP_N_GROUPS, sizeof *draws->value);
    draws->mass = cli_memory(n, sizeof *draws->mass);
    draws->gravity = cli_memory(n, sizeof *draws->gravity);
    draws->level = cli_memory(n * s->n_factors, sizeof *draws->level);
    draws->mean = cli_memory(n * draws->n_sets * k, sizeof *draws->mean);
    draws->covariance = cli_memory(n * k * k, sizeof *draws->covariance);
    draws->log_complete = cli_memory(n, sizeof *draws->log_complete);
    double *u = cli_memory(n * n_choices, sizeof *u), *x = cli_memory(k * n_reals, sizeof *x);
    int *levels = cli_memory(k * s->n_factors, sizeof *levels), level[FORENSICS_FACTORS];
    void *params = repose_params_new(), *work = repose_params_new();
    draws->base = repose_params_new();
    RP_TRY(forensics_study_params(s, 0, draws->base));
    RP_TRY(stats_design(n, n_choices, u, s->n_factors, n_levels, draws->level, rng));
    for (size_t d = 0; d < n; d++) {
        for (size_t f = 0; f < s->n_factors; f++) level[f] = (int)draws->level[f * n + d];
        set_groups(s, u + d * n_choices, draws->value + d * SWEEP_N_GROUPS);
        RP_TRY(forensics_draw_params(s, draws, d, params));
        sweep_groups_weight(params, &draws->mass[d], &draws->gravity[d]);
        RP_TRY(set_points(s, params, work, level, x, levels));
        const stats_inputs at = {k, n_reals, s->n_factors, x, levels};
        RP_TRY(predict(s, angles, completion, &at, d, draws));
    }
    return RP_OK;
}
