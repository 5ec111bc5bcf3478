/* `repose forensics` a second time: the tables of its reports from the runs themselves, by the libraries
 * alone. Some cells lack piles; every surface has angles of its own. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "angle/angle.h"
#include "core/random.h"
#include "stats/emulator.h"
#include "stats/forensics.h"
#include "sweeps/engine/groups.h"
#include "sweeps/protocols/protocols.h"
#include "tests/check.h"
#include "tests/program.h"

/* Two steps of NLopt from inputs that differ in their last bits. */
static const double search = 1e-6;
static const double deg = M_PI / 180.0;

enum {
    SETTINGS = 30,
    POINTS = 4,
    CELLS = SETTINGS * POINTS,
    PILES = 4,
    USED = 3, /* published numbers but the one held out, which has the last point to itself */
    FACTORS = 2,
    STEMS = 2,
    SURFACES = 12,
    SETS = STEMS * SURFACES,
    REALS = SWEEP_N_GROUPS,
    DRAWS = 120,
    SEED = 29
};
static const double shift = 3.0 * M_PI / 180.0;
static const char *const slips[] = {"truncated", "total"}, *const floors[] = {"extends", "ends", "absorbs"};
static const size_t n_levels[FACTORS] = {2, 3};
static const char *const stems[STEMS] = {"theta_r3", "theta_r1"};
static const struct {
    const char *k_n, *gamma_n, *mu;
} points[POINTS] = {
    {"1e6", "500", "0.2"}, {"1e5", "500", "0.2"}, {"1e6", "500", "0.3"}, {"1e6", "100", "0.2"}};
static const stats_published published[POINTS] = {
    {18.7, 1.1, 9.0}, {16.1, 0.9, 16.0}, {21.3, 1.3, 25.0}, {17.4, 0.8, 4.0}};

#define SURFACE(height, empty) #height "_" #empty, #height "_" #empty "_origin",
static const char *const surfaces[SURFACES] = {ANG_SURFACES(SURFACE)};

/* ---- runs ---- */

static double density_of(size_t setting)
{
    return 0.6 * pow(9.0, fmod(0.618 * (double)setting, 1.0));
}

static double g_of(size_t setting)
{
    return 150.0 * pow(12.0, fmod(0.4142 * (double)setting, 1.0));
}

static size_t level_of(size_t factor, size_t setting)
{
    return factor ? setting % 3 : setting / 3 % 2;
}

/* How many of a cell's piles have a result. */
static size_t found_of(size_t cell)
{
    return cell % 17 == 5 ? 0 : cell % 19 == 7 ? 1 : cell % 13 == 2 ? 2 : cell % 11 == 3 ? 3 : PILES;
}

static bool has_angle(size_t cell, size_t pile, size_t stem)
{
    return pile == 0 || cell % 23 != (stem ? 9 : 4);
}

/* Degrees, of a pile by a surface. */
static double angle_of(size_t cell, size_t pile, size_t stem, size_t surface)
{
    const size_t setting = cell / POINTS, point = cell % POINTS;
    const double a = log(density_of(setting)), b = log(g_of(setting) / 400.0), s = (double)surface;
    return 18.0 + 1.3 * a - 0.9 * b + 0.4 * a * b + 2.0 * sin(a + (double)point) -
           (double)level_of(0, setting) + 0.7 * (double)level_of(1, setting) + (point == 2 ? 3.0 : 0.0) +
           (stem ? 1.0 + 0.2 * b : 0.0) + 0.1 * s * cos(s + 2.0 * a + b) +
           0.3 * (double)((pile * 7 + cell * 3) % 5) + 0.05 * s * (double)(pile % 2);
}

/* The angles of a cell, radians, and how many there are: some piles with a result have no angle by one
 * method. */
static size_t values_of(size_t cell, size_t set, double values[PILES])
{
    const size_t stem = set / SURFACES, v = set % SURFACES;
    size_t n = 0;
    for (size_t pile = 0; pile < found_of(cell); pile++)
        if (has_angle(cell, pile, stem)) values[n++] = angle_of(cell, pile, stem, stem ? v - v % 2 : v) * deg;
    return n;
}

static void write_files(void)
{
    char path[256];
    path_of("runs.tsv", path);
    FILE *file = fopen(path, "w");
    CU_ASSERT_PTR_NOT_NULL_FATAL(file);
    fputs("# shape: sphere\n# status\tdensity\tg\tslip\tfloor\tk_n\tgamma_n\tmu", file);
    for (size_t v = 0; v < SURFACES; v++)
        for (size_t stem = 0; stem < STEMS; stem++)
            fprintf(file, "\t%s%s%s_deg", stems[stem], v ? "_" : "", v ? surfaces[v] : "");
    for (size_t i = 0; i < CELLS * PILES; i++) {
        const size_t cell = i / PILES, pile = i % PILES, setting = cell / POINTS, k = cell % POINTS;
        fprintf(file, "\n%s\t%.17g\t%.17g\t%s\t%s\t%s\t%s\t%s", pile < found_of(cell) ? "ok" : "overlap",
                density_of(setting), g_of(setting), slips[level_of(0, setting)], floors[level_of(1, setting)],
                points[k].k_n, points[k].gamma_n, points[k].mu);
        for (size_t v = 0; v < SURFACES; v++) /* of method 1 no surface is of the parabola */
            for (size_t stem = 0; stem < STEMS; stem++)
                fprintf(file, "\t%.17g",
                        has_angle(cell, pile, stem) ? angle_of(cell, pile, stem, stem ? v - v % 2 : v) : NAN);
    }
    fputc('\n', file);
    fclose(file);
    write_text(
        "claims.tsv",
        "# at: k_n=1e6 gamma_n=500 mu=0.2\n# id\tof\tpaper\tplace\tsection\ttest\tpublished\tpublished_se\t"
        "samples\tmargin\tfamily\tanswer\tagainst\tforensics\tstatement\tnote\n"
        "last\t-\tlh\t-\tall\tagrees\t17.4\t0.8\t4\t2\t-\tt v\t-\theld theta_r1 gamma_n=100\td\t-\n"
        "base\t-\tlh\t-\tall\tagrees\t18.7\t1.1\t9\t2\t-\tt v\t-\ttheta_r3\ta\t-\n"
        "soft\t-\tlh\t-\tall\tagrees\t16.1\t0.9\t16\t2\t-\tt v\t-\ttheta_r3 k_n=1e5\tb\t-\n"
        "rough\t-\tlh\t-\tall\tagrees\t21.3\t1.3\t25\t2\t-\tt v\t-\ttheta_r3 mu=0.3\tc\t-\n");
}

/* ---- emulators ---- */

static struct {
    double group[CELLS][REALS], base[REALS], lo[REALS], hi[REALS]; /* lo, hi on the group's scale */
    bool varies[REALS], is_choice[REALS];
    size_t n_reals;
    double mean[SETS][CELLS], variance[CELLS], ok[CELLS]; /* radians */
} study;

static double scaled(size_t g, double v)
{
    return sweep_groups[g].logarithmic ? log(v) : v;
}

static void set_key(void *params, const char *key, const char *text)
{
    CHECK_OK(rp_params_set_text(rp_params_find(sweep_protocol_repose.schema, key), params, text));
}

static void set_point(void *params, size_t k)
{
    set_key(params, "k_n", points[k].k_n);
    set_key(params, "gamma_n", points[k].gamma_n);
    set_key(params, "mu", points[k].mu);
}

static void *params_of(size_t setting, size_t point)
{
    char text[64];
    void *params = calloc(1, sweep_protocol_repose.params_size);
    rp_params_defaults(sweep_protocol_repose.schema, params);
    snprintf(text, sizeof text, "%.17g", density_of(setting));
    set_key(params, "density", text);
    snprintf(text, sizeof text, "%.17g", g_of(setting));
    set_key(params, "g", text);
    set_key(params, "slip", slips[level_of(0, setting)]);
    set_key(params, "floor", floors[level_of(1, setting)]);
    set_point(params, point);
    return params;
}

/* Groups of all cells, their ranges, and which of them are choices. */
static void find_groups(void)
{
    double base[SETTINGS][REALS];
    memset(&study, 0, sizeof study);
    for (size_t c = 0; c < CELLS; c++) {
        void *params = params_of(c / POINTS, c % POINTS);
        sweep_groups_of(params, study.group[c]);
        if (c % POINTS == 0) memcpy(base[c / POINTS], study.group[c], sizeof base[0]);
        free(params);
    }
    memcpy(study.base, base[0], sizeof study.base);
    for (size_t g = 0; g < REALS; g++) {
        double lo = INFINITY, hi = -INFINITY;
        study.lo[g] = INFINITY, study.hi[g] = -INFINITY;
        for (size_t c = 0; c < CELLS; c++) {
            study.lo[g] = fmin(study.lo[g], scaled(g, study.group[c][g]));
            study.hi[g] = fmax(study.hi[g], scaled(g, study.group[c][g]));
        }
        for (size_t i = 0; i < SETTINGS; i++)
            lo = fmin(lo, scaled(g, base[i][g])), hi = fmax(hi, scaled(g, base[i][g]));
        study.varies[g] = study.hi[g] - study.lo[g] > 0.01;
        study.is_choice[g] = hi - lo > 0.01 && sweep_groups[g].lo < sweep_groups[g].hi;
        study.n_reals += study.varies[g];
    }
    CU_ASSERT(study.is_choice[SWEEP_GROUP_stiffness] && study.is_choice[SWEEP_GROUP_damping_rate] &&
              !study.is_choice[SWEEP_GROUP_friction] && study.varies[SWEEP_GROUP_friction] &&
              study.n_reals == 4);
}

/* Means of a cell with two results or more; the piles' variance is one for each point, by the first set. */
static void find_means(void)
{
    double squares[POINTS] = {0.0}, dof[POINTS] = {0.0}, number[CELLS], v[PILES];
    for (size_t set = 0; set < SETS; set++)
        for (size_t c = 0; c < CELLS; c++) {
            const size_t n = values_of(c, set, v);
            double sum = 0.0;
            for (size_t p = 0; p < n; p++) sum += v[p];
            study.mean[set][c] = n > 1 ? sum / (double)n : NAN;
            study.ok[c] = (double)found_of(c);
            if (set == 0) number[c] = (double)n;
            if (set > 0 || n < 2) continue;
            for (size_t p = 0; p < n; p++) squares[c % POINTS] += pow(v[p] - study.mean[0][c], 2.0);
            dof[c % POINTS] += (double)n - 1.0;
        }
    for (size_t c = 0; c < CELLS; c++) study.variance[c] = squares[c % POINTS] / dof[c % POINTS] / number[c];
}

typedef struct {
    stats_inputs in;
    double x[CELLS * REALS], variance[CELLS], y[CELLS], spread, centre;
    int level[CELLS * FACTORS];
    size_t group[CELLS];
    double rms[STATS_KERNELS], stated[STATS_KERNELS], score[STATS_KERNELS], covered[STATS_KERNELS], noise;
    stats_kernel kernel;
    stats_emulator e;
} emulated;

static void set_inputs(const double group[], double x[])
{
    for (size_t g = 0; g < REALS; g++)
        if (study.varies[g])
            *x++ = 2.0 * (scaled(g, group[g]) - study.lo[g]) / (study.hi[g] - study.lo[g]) - 1.0;
}

/* Fit both kernels to the cells whose value is a number, and keep the better one. */
static void emulate(const double value[], const double variance[], emulated *m)
{
    size_t n = 0;
    double mean[CELLS], of[CELLS], sum = 0.0, squares = 0.0;
    for (size_t c = 0; c < CELLS; c++) {
        if (isnan(value[c])) continue;
        set_inputs(study.group[c], m->x + n * study.n_reals);
        for (size_t f = 0; f < FACTORS; f++) m->level[n * FACTORS + f] = (int)level_of(f, c / POINTS);
        m->variance[n] = variance[c], m->group[n] = c / POINTS, m->y[n++] = value[c];
        sum += value[c];
    }
    m->centre = sum / (double)n;
    m->noise = 0.0;
    for (size_t i = 0; i < n; i++) m->y[i] -= m->centre, squares += m->y[i] * m->y[i];
    for (size_t i = 0; i < n; i++) m->noise += m->variance[i] / (double)n;
    m->noise = sqrt(m->noise);
    m->spread = sqrt(squares / (double)n);
    m->in = (stats_inputs){n, study.n_reals, FACTORS, m->x, m->level};
    for (int kernel = STATS_KERNELS - 1; kernel >= 0; kernel--) {
        stats_emulator e;
        CHECK_OK(stats_emulator_make((stats_kernel)kernel, &m->in, m->variance, m->spread, &e));
        CHECK_OK(stats_emulator_fit(&e, m->y, 400));
        CHECK_OK(stats_emulator_leave_out(&e, m->y, m->group, mean, of, &m->score[kernel]));
        m->rms[kernel] = m->stated[kernel] = m->covered[kernel] = 0.0;
        for (size_t i = 0; i < n; i++) {
            m->rms[kernel] += pow(m->y[i] - mean[i], 2.0) / (double)n;
            m->stated[kernel] += of[i] / (double)n;
            m->covered[kernel] += (fabs(m->y[i] - mean[i]) <= 1.959963984540054 * sqrt(of[i])) / (double)n;
        }
        m->rms[kernel] = sqrt(m->rms[kernel]);
        m->stated[kernel] = sqrt(m->stated[kernel]);
        if (kernel == 0 && m->score[1] > m->score[0]) {
            stats_emulator_free(&e);
        } else {
            if (kernel == 0) stats_emulator_free(&m->e);
            m->e = e, m->kernel = (stats_kernel)kernel;
        }
    }
}

static emulated angles, completion;

/* What the report says of one quantity, in rows from `row` on. */
static void check_quantity(checked *c, size_t row, const char *quantity, const emulated *m, double unit)
{
    for (size_t k = 0; k < STATS_KERNELS; k++) {
        at(c, row + k, "quantity"), at(c, row + k, "kernel"), at(c, row + k, "used");
        CU_ASSERT_STRING_EQUAL(word(&c->t, row + k, "quantity"), quantity);
        at(c, row + k, "left_out");
        CU_ASSERT_STRING_EQUAL(word(&c->t, row + k, "left_out"), "setting");
        CU_ASSERT_STRING_EQUAL(word(&c->t, row + k, "kernel"), stats_kernel_words[k]);
        CU_ASSERT_STRING_EQUAL(word(&c->t, row + k, "used"), k == m->kernel ? "yes" : "no");
        CHECK_NEAR(at(c, row + k, "cells"), (double)m->in.n, 0.0);
        CHECK_NEAR(at(c, row + k, "spread"), m->spread / unit, search);
        CHECK_NEAR(at(c, row + k, "noise"), m->noise / unit, search);
        CHECK_NEAR(at(c, row + k, "rms_left_out"), m->rms[k] / unit, search);
        CHECK_NEAR(at(c, row + k, "stated"), m->stated[k] / unit, search);
        CHECK_NEAR(at(c, row + k, "score"), m->score[k], 1e3 * search);
        CHECK_NEAR(at(c, row + k, "covered"), m->covered[k], 1e-12);
    }
}

static void find_emulators(void)
{
    double value[CELLS], variance[CELLS];
    find_groups();
    find_means();
    emulate(study.mean[0], study.variance, &angles);
    for (size_t c = 0; c < CELLS; c++) stats_probit(study.ok[c], PILES, &value[c], &variance[c]);
    emulate(value, variance, &completion);
}

/* ---- draws ---- */

static struct {
    double value[DRAWS][REALS], mass[DRAWS], gravity[DRAWS], log_complete[DRAWS];
    size_t level[FACTORS * DRAWS];
    double mean[DRAWS][SETS][POINTS], covariance[DRAWS][POINTS * POINTS], scale[SETS];
    double used_mean[DRAWS][SURFACES][USED], used_covariance[DRAWS][USED * USED];
    stats_published numbers[POINTS];
    stats_predictions model;
    stats_posterior posterior, exact; /* exact: of an emulator without covariance */
} draws;

/* Weights of all sets on the covariance of the first, which theirs is but for a factor. */
static void find_weights(double weights[SETS][CELLS], double centre[SETS])
{
    double first = 0.0;
    for (size_t set = 0; set < SETS; set++) {
        double y[CELLS], sum = 0.0, with = 0.0;
        size_t n = 0;
        centre[set] = 0.0;
        for (size_t c = 0; c < CELLS; c++) {
            if (isnan(study.mean[0][c])) continue;
            y[n++] = study.mean[set][c];
            if (!isnan(study.mean[set][c])) centre[set] += study.mean[set][c], with++;
        }
        centre[set] /= with;
        for (size_t i = 0; i < n; i++) y[i] = isnan(y[i]) ? 0.0 : y[i] - centre[set];
        stats_emulator_weights(&angles.e, y, (double *)weights + set * n); /* one set after the other */
        for (size_t i = 0; i < n; i++) sum += y[i] * ((double *)weights)[set * n + i];
        if (set == 0) first = sum;
        draws.scale[set] = sum / first;
    }
}

static void predict_draw(size_t d, void *params, double weights[SETS][CELLS], const double centre[],
                         const double of_completion[])
{
    double x[POINTS * REALS], z[POINTS], covariance[POINTS * POINTS], group[REALS];
    int level[POINTS * FACTORS];
    const stats_inputs in = {POINTS, study.n_reals, FACTORS, x, level};
    for (size_t k = 0; k < POINTS; k++) {
        void *here = malloc(sweep_protocol_repose.params_size);
        memcpy(here, params, sweep_protocol_repose.params_size);
        set_point(here, k);
        sweep_groups_of(here, group);
        set_inputs(group, x + k * study.n_reals);
        for (size_t f = 0; f < FACTORS; f++) level[k * FACTORS + f] = (int)draws.level[f * DRAWS + d];
        free(here);
    }
    CHECK_OK(stats_emulator_predict(&angles.e, &in, SETS, (double *)weights, (double *)draws.mean[d],
                                    draws.covariance[d]));
    for (size_t set = 0; set < SETS; set++)
        for (size_t k = 0; k < POINTS; k++) draws.mean[d][set][k] += centre[set];
    CHECK_OK(stats_emulator_predict(&completion.e, &in, 1, of_completion, z, covariance));
    draws.log_complete[d] = 0.0;
    for (size_t k = 0; k < USED; k++)
        draws.log_complete[d] +=
            stats_log_normal_chance(z[k] + completion.centre, covariance[k * POINTS + k]);
}

/* Groups of each draw by the design, in the order of the groups; what is no choice is as in the first
 * setting. */
static void find_draws(void)
{
    static double weights[SETS][CELLS], u[2 * DRAWS], of_completion[CELLS];
    double centre[SETS];
    gsl_rng *rng = rp_random_alloc(SEED, 0, RP_PURPOSE_BOOTSTRAP);
    CHECK_OK(stats_design(DRAWS, 2, u, FACTORS, n_levels, draws.level, rng));
    gsl_rng_free(rng);
    find_weights(weights, centre);
    stats_emulator_weights(&completion.e, completion.y, of_completion);
    for (size_t d = 0; d < DRAWS; d++) {
        void *params = params_of(0, 0);
        set_key(params, "slip", slips[draws.level[d]]);
        set_key(params, "floor", floors[draws.level[DRAWS + d]]);
        for (size_t g = 0, k = 0; g < REALS; g++) {
            const double lo = sweep_groups[g].lo, hi = sweep_groups[g].hi;
            draws.value[d][g] = study.is_choice[g] ? lo * pow(hi / lo, u[2 * d + k])
                                                   : study.base[g]; /* both choices are logarithmic */
            k += study.is_choice[g];
        }
        sweep_groups_apply(draws.value[d], params);
        sweep_groups_weight(params, &draws.mass[d], &draws.gravity[d]);
        predict_draw(d, params, weights, centre, of_completion);
        free(params);
    }
}

static void find_posterior(void)
{
    for (size_t k = 0; k < POINTS; k++)
        draws.numbers[k] =
            (stats_published){published[k].value * deg, published[k].error * deg, published[k].samples};
    for (size_t d = 0; d < DRAWS; d++)
        for (size_t k = 0; k < USED; k++) {
            for (size_t v = 0; v < SURFACES; v++) draws.used_mean[d][v][k] = draws.mean[d][v][k];
            for (size_t j = 0; j < USED; j++)
                draws.used_covariance[d][k * USED + j] = draws.covariance[d][k * POINTS + j];
        }
    draws.model = (stats_predictions){
        DRAWS,       SURFACES,           USED, (double *)draws.used_mean, (double *)draws.used_covariance,
        draws.scale, draws.log_complete, shift};
    CHECK_OK(stats_posterior_make(&draws.model, draws.numbers, &draws.posterior));
    static const double none[DRAWS * USED * USED];
    stats_predictions exact = draws.model;
    exact.covariance = none;
    CHECK_OK(stats_posterior_make(&exact, draws.numbers, &draws.exact));
}

/* ---- reports ---- */

#define COMMAND "forensics runs.tsv --claims claims.tsv --draws 120 --seed 29 --shift-deg 3"

/* Mean, standard deviation and chance of a number over all shares; before the numbers all shares are equal,
 * and an error that they have in common is not known from the others. */
static void predict_number(size_t point, bool before, double *mean, double *sd, double *chance)
{
    const stats_published *number = &draws.numbers[point];
    const bool held = point == USED;
    const double *share = draws.posterior.share;
    double sums[3] = {0.0};
    for (size_t d = 0; d < DRAWS; d++)
        for (size_t v = 0; v < SURFACES; v++)
            for (unsigned latent = 0; latent < STATS_LATENT_LEVELS; latent++) {
                const double w = before ? 1.0 / (DRAWS * SURFACES * STATS_LATENT_LEVELS) : *share++;
                const size_t set = held ? SURFACES + v : v;
                double m = draws.mean[d][set][point], error = 0.0, of_error = 0.0, p = 0.0,
                       variance = draws.scale[set] * draws.covariance[d][point * POINTS + point];
                if (held && !before)
                    CHECK_OK(stats_common_error(USED, draws.numbers, draws.used_mean[d][v],
                                                draws.used_covariance[d], draws.scale[v], shift, latent,
                                                &error, &of_error));
                m += error, variance += of_error;
                for (unsigned reading = 0; reading < 2; reading++) {
                    const bool own = (latent >> STATS_LATENT_reading & 1u) == reading,
                               common = (latent >> STATS_LATENT_shift & 1u) && !(held && !before);
                    const double weight = held && !before ? 0.5 : own,
                                 total = variance + (common ? shift * shift : 0.0) +
                                         pow(number->error, 2.0) / (reading ? number->samples : 1.0);
                    p += weight * erfc(fabs(number->value - m) / sqrt(2.0 * total));
                }
                sums[0] += w * m, sums[1] += w * (m * m + variance), sums[2] += w * p;
            }
    *mean = sums[0] / deg, *sd = sqrt(sums[1] - sums[0] * sums[0]) / deg, *chance = sums[2];
}

static void check_numbers(void)
{
    static const char *const names[POINTS] = {"base", "soft", "rough", "last"};
    checked c = CHECKED_RUN(POINTS, COMMAND " --report numbers");
    for (size_t k = 0; k < POINTS; k++) {
        double mean, sd, chance, unused;
        at(&c, k, "claim"), at(&c, k, "role"), at(&c, k, "column");
        CU_ASSERT_STRING_EQUAL(word(&c.t, k, "claim"), names[k]);
        CU_ASSERT_STRING_EQUAL(word(&c.t, k, "role"), k < USED ? "used" : "held_out");
        CU_ASSERT_STRING_EQUAL(word(&c.t, k, "column"), stems[k == USED]);
        CHECK_NEAR(at(&c, k, "published_deg"), published[k].value, 1e-12);
        CHECK_NEAR(at(&c, k, "published_se_deg"), published[k].error, 1e-12);
        CHECK_NEAR(at(&c, k, "samples"), published[k].samples, 0.0);
        predict_number(k, false, &mean, &sd, &chance);
        CHECK_NEAR(at(&c, k, "predicted_deg"), mean, 10.0 * search);
        CHECK_NEAR(at(&c, k, "predicted_sd_deg"), sd, 10.0 * search);
        CHECK_NEAR(at(&c, k, "p_value"), chance, 10.0 * search);
        predict_number(k, true, &mean, &sd, &unused);
        CHECK_NEAR(at(&c, k, "prior_deg"), mean, 10.0 * search);
        CHECK_NEAR(at(&c, k, "prior_sd_deg"), sd, 10.0 * search);
    }
    checked_end(&c);
}

/* Quantiles of a number over all weights, those of each level of two latents, of an emulator without error,
 * and equal ones. */
static void check_number(checked *c, size_t *row, const char *choice, const double value[], size_t group)
{
    static const char *const given[] = {"all",         "shift=none",     "shift=common", "stop=ours",
                                        "stop=theirs", "emulator=exact", "prior"};
    static const int latent[] = {-1, STATS_LATENT_shift, STATS_LATENT_shift, STATS_LATENT_stop,
                                 STATS_LATENT_stop};
    size_t order[DRAWS];
    for (size_t k = 0; k < 7; k++, ++*row) {
        double w[DRAWS], q[3];
        if (k < 5) stats_posterior_draws(&draws.posterior, latent[k], k % 2 ? 0 : 1, w);
        if (k == 5) stats_posterior_draws(&draws.exact, -1, 0, w);
        for (size_t d = 0; d < DRAWS && k == 6; d++) w[d] = 1.0;
        for (int i = 0; i < 3; i++)
            q[i] = stats_weighted_quantile(DRAWS, value, w, i == 0 ? 0.025 : i == 1 ? 0.5 : 0.975, order);
        CU_ASSERT_STRING_EQUAL(word(&c->t, *row, "choice"), choice);
        CU_ASSERT_STRING_EQUAL(word(&c->t, *row, "level"), "-");
        CU_ASSERT_STRING_EQUAL(word(&c->t, *row, "given"), given[k]);
        CHECK_NEAR(at(c, *row, "lower") / q[0], 1.0, 1e-9);
        CHECK_NEAR(at(c, *row, "median") / q[1], 1.0, 1e-9);
        CHECK_NEAR(at(c, *row, "upper") / q[2], 1.0, 1e-9);
        if (group < REALS)
            CHECK_NEAR(at(c, *row, "width"),
                       log(q[2] / q[0]) / log(sweep_groups[group].hi / sweep_groups[group].lo) / 0.95, 1e-9);
        else
            CU_ASSERT(isnan(at(c, *row, "width")));
        CU_ASSERT(isnan(at(c, *row, "share")) && isnan(at(c, *row, "prior")) &&
                  isnan(at(c, *row, "bayes_factor")));
    }
}

static void check_share(checked *c, size_t *row, const char *choice, const char *level, const char *given,
                        double prior, double share)
{
    CU_ASSERT_STRING_EQUAL(word(&c->t, *row, "choice"), choice);
    CU_ASSERT_STRING_EQUAL(word(&c->t, *row, "level"), level);
    CU_ASSERT_STRING_EQUAL(word(&c->t, *row, "given"), given);
    CHECK_NEAR(at(c, *row, "prior"), prior, 1e-12);
    CHECK_NEAR(at(c, *row, "share"), share, search);
    CHECK_NEAR(at(c, *row, "bayes_factor") / (share / (1.0 - share) * (1.0 - prior) / prior), 1.0, 1e-3);
    ++*row;
}

static void check_choices(void)
{
    static const char *const latents[][3] = {
        {"reading", "error", "deviation"}, {"shift", "none", "common"}, {"stop", "ours", "theirs"}};
    checked c = CHECKED_RUN(4 * 7 + 2 * 5 + SURFACES + 6, COMMAND);
    size_t row = 0;
    double value[DRAWS], w[DRAWS];
    at(&c, 0, "choice"), at(&c, 0, "level"), at(&c, 0, "given");
    for (size_t g = 0; g < REALS; g++) {
        if (!study.is_choice[g]) continue;
        for (size_t d = 0; d < DRAWS; d++) value[d] = draws.value[d][g];
        check_number(&c, &row, sweep_groups[g].name, value, g);
    }
    check_number(&c, &row, "grain_mass", draws.mass, REALS);
    check_number(&c, &row, "gravity", draws.gravity, REALS);
    for (size_t f = 0; f < FACTORS; f++)
        for (int exact = 0; exact < 2; exact++) {
            stats_posterior_draws(exact ? &draws.exact : &draws.posterior, -1, 0, w);
            for (size_t l = 0; l < n_levels[f]; l++) {
                double prior = 0.0, share = 0.0;
                for (size_t d = 0; d < DRAWS; d++)
                    if (draws.level[f * DRAWS + d] == l) prior += 1.0 / DRAWS, share += w[d];
                check_share(&c, &row, f ? "floor" : "slip", f ? floors[l] : slips[l],
                            exact ? "emulator=exact" : "-", prior, share);
            }
        }
    for (size_t v = 0; v < SURFACES; v++)
        check_share(&c, &row, "surface", surfaces[v], "-", 1.0 / SURFACES,
                    stats_posterior_surface(&draws.posterior, v));
    for (int k = 0; k < STATS_LATENTS; k++)
        for (unsigned l = 0; l < 2; l++)
            check_share(&c, &row, latents[k][0], latents[k][1 + l], "-", 0.5,
                        stats_posterior_draws(&draws.posterior, k, l, w));
    checked_end(&c);
}

/* Shares of the posterior in 20 equal bins, over the prior's. */
static void check_density(void)
{
    enum { BINS = 20 };
    static const char *const columns[3] = {"all", "none", "common"};
    checked c = CHECKED_RUN(2 * BINS, COMMAND " --report density");
    for (size_t g = 0, row = 0; g < REALS; g++) {
        const double lo = sweep_groups[g].lo, hi = sweep_groups[g].hi;
        if (!study.is_choice[g]) continue;
        for (int bin = 0; bin < BINS; bin++, row++) {
            const double from = lo * pow(hi / lo, bin / 20.0), to = lo * pow(hi / lo, (bin + 1) / 20.0);
            at(&c, row, "choice");
            CU_ASSERT_STRING_EQUAL(word(&c.t, row, "choice"), sweep_groups[g].name);
            CHECK_NEAR(at(&c, row, "value") / sqrt(from * to), 1.0, 1e-9);
            for (int k = 0; k < 3; k++) {
                double w[DRAWS], in = 0.0;
                const double total =
                    stats_posterior_draws(&draws.posterior, k ? STATS_LATENT_shift : -1, k == 2, w);
                for (size_t d = 0; d < DRAWS; d++)
                    if (draws.value[d][g] >= from && draws.value[d][g] < to) in += w[d];
                CHECK_NEAR(at(&c, row, columns[k]), BINS * in / total, 100.0 * search);
            }
        }
    }
    checked_end(&c);
}

static void check_emulators(void)
{
    double w[DRAWS], squares = 0.0;
    size_t without = 0;
    char line[256];
    for (size_t c = 0; c < CELLS; c++) without += isnan(study.mean[0][c]);
    stats_posterior_draws(&draws.posterior, -1, 0, w);
    for (size_t d = 0; d < DRAWS; d++)
        for (size_t k = 0; k < USED; k++) squares += w[d] * draws.used_covariance[d][k * USED + k] / USED;
    checked c = CHECKED_RUN(2 * STATS_KERNELS, COMMAND " --report emulator");
    check_quantity(&c, 0, "theta_r3", &angles, deg);
    check_quantity(&c, STATS_KERNELS, "completion", &completion, 1.0);
    snprintf(line, sizeof line,
             "# settings: %d, at %d points; %zu of %d have fewer than two piles with a result\n", SETTINGS,
             POINTS, without, CELLS);
    CU_ASSERT_PTR_NOT_NULL(strstr(out, line));
    CHECK_NEAR(strtod(rp_table_find_note(&c.t, "model_error"), NULL) / (sqrt(squares) / deg), 1.0, 6e-2);
    CHECK_NEAR(strtod(rp_table_find_note(&c.t, "effective_draws"), NULL), draws.posterior.effective, 0.51);
    CHECK_NEAR(strtod(rp_table_find_note(&c.t, "log_evidence"), NULL), draws.posterior.log_evidence, 1e-4);
    CHECK_NEAR(strtod(rp_table_find_note(&c.t, "p_value"), NULL) / draws.posterior.p_value, 1.0, 6e-3);
    checked_end(&c);
}

static void test_reports(void)
{
    enter();
    write_files();
    find_emulators();
    find_draws();
    find_posterior();
    check_emulators();
    check_numbers();
    check_choices();
    check_density();
    stats_posterior_free(&draws.posterior);
    stats_posterior_free(&draws.exact);
    stats_emulator_free(&angles.e);
    stats_emulator_free(&completion.e);
    leave();
}

void suite_inference(void)
{
    static const check_case cases[] = {{"reports of forensics, by the libraries", test_reports},
                                       {NULL, NULL}};
    check_register("inference", cases);
}
