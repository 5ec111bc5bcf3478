/* Choices that a publication leaves open: likelihoods and posteriors in closed form, designs, planted truths.
 */
#include <gsl/gsl_randist.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "core/random.h"
#include "stats/emulator.h"
#include "stats/forensics.h"
#include "dem/dem.h"
#include "stats/stats.h"
#include "sweeps/engine/groups.h"
#include "sweeps/protocols/protocols.h"
#include "tests/check.h"
#include "tests/planted.h"
#include "tests/program.h"

enum { READING = 1 << STATS_LATENT_reading, SHIFT = 1 << STATS_LATENT_shift, STOP = 1 << STATS_LATENT_stop };

/* One number and two, by the normal density with the determinant of a matrix of two rows. */
static void test_likelihood(void)
{
    const stats_published numbers[2] = {{2.385, 0.7, 9.0}, {1.1, 0.4, 16.0}};
    const double mean[2] = {2.0, 1.9}, covariance[4] = {0.09, 0.02, 0.02, 0.16}, shift = 0.6, scale = 1.3;
    for (unsigned latent = 0; latent < STATS_LATENT_LEVELS; latent++) {
        const double own[2] = {latent & READING ? 0.49 / 9.0 : 0.49, latent & READING ? 0.01 : 0.16},
                     common = latent & SHIFT ? 0.36 : 0.0, a = scale * 0.09 + own[0] + common,
                     b = scale * 0.02 + common, c = scale * 0.16 + own[1] + common, det = a * c - b * b,
                     r = 0.385, s = -0.8;
        double log_likelihood, chi2;
        CHECK_OK(
            stats_log_likelihood(2, numbers, mean, covariance, scale, shift, latent, &log_likelihood, &chi2));
        CHECK_NEAR(chi2, (c * r * r - 2.0 * b * r * s + a * s * s) / det, 1e-10);
        CHECK_NEAR(log_likelihood, -0.5 * chi2 - 0.5 * log(det) - log(2.0 * M_PI), 1e-10);
        CHECK_OK(
            stats_log_likelihood(1, numbers, mean, covariance, scale, shift, latent, &log_likelihood, NULL));
        CHECK_NEAR(log_likelihood, -0.5 * (r * r / a + log(2.0 * M_PI * a)), 1e-10);
    }
    double error, variance;
    for (unsigned latent = 0; latent < STATS_LATENT_LEVELS; latent++) {
        /* the other way round: the precisions of the numbers and of the error's prior add up */
        const double own[2] = {latent & READING ? 0.49 / 9.0 : 0.49, latent & READING ? 0.01 : 0.16},
                     a = scale * 0.09 + own[0], b = scale * 0.02, c = scale * 0.16 + own[1],
                     det = a * c - b * b, of_both = (a + c - 2.0 * b) / det,
                     pull = ((c - b) * 0.385 + (a - b) * -0.8) / det,
                     expected = latent & SHIFT ? 1.0 / (1.0 / 0.36 + of_both) : 0.0;
        CHECK_OK(stats_common_error(2, numbers, mean, covariance, scale, shift, latent, &error, &variance));
        CHECK_NEAR(variance, expected, 1e-12);
        CHECK_NEAR(error, expected * pull, 1e-12);
    }
    const double impossible[4] = {1.0, 9.0, 9.0, 1.0};
    double unused;
    CHECK_FAILS(stats_log_likelihood(2, numbers, mean, impossible, scale, shift, 0, &unused, NULL), RP_BROKEN,
                "not positive definite");
}

/* Three draws and two surfaces whose likelihoods are known. */
static void test_posterior(void)
{
    const stats_published number = {1.0, 0.5, 4.0};
    const double mean[6] = {1.0, 2.0, 1.5, 0.5, 3.0, 1.2}, covariance[3] = {0.1, 0.2, 0.3},
                 scale[2] = {1.0, 2.0}, complete[3] = {0.0, -1.0, -1e4};
    const stats_predictions model = {3, 2, 1, mean, covariance, scale, complete, 0.7};
    stats_posterior p;
    CHECK_OK(stats_posterior_make(&model, &number, &p));
    double total = 0.0, chance = 0.0, draws[3] = {0.0}, surface = 0.0, shift = 0.0, theirs[3] = {0.0};
    for (int d = 0; d < 3; d++)
        for (int s = 0; s < 2; s++)
            for (unsigned latent = 0; latent < STATS_LATENT_LEVELS; latent++) {
                const double v = scale[s] * covariance[d] + (latent & READING ? 0.0625 : 0.25) +
                                 (latent & SHIFT ? 0.49 : 0.0),
                             r = 1.0 - mean[2 * d + s],
                             l = exp(-0.5 * r * r / v + (latent & STOP ? complete[d] : 0.0)) /
                                 sqrt(2.0 * M_PI * v);
                total += l, draws[d] += l;
                chance += l * erfc(fabs(r) / sqrt(2.0 * v));
                surface += s == 1 ? l : 0.0;
                shift += latent & SHIFT ? l : 0.0;
                theirs[d] += latent & STOP ? l : 0.0;
            }
    double weight[3], squares = 0.0;
    CHECK_NEAR(stats_posterior_draws(&p, -1, 0, weight), 1.0, 1e-12);
    for (int d = 0; d < 3; d++) {
        CHECK_NEAR(weight[d], draws[d] / total, 1e-12);
        squares += weight[d] * weight[d];
    }
    CHECK_NEAR(p.effective, 1.0 / squares, 1e-9);
    CHECK_NEAR(p.log_evidence, log(total / (6.0 * STATS_LATENT_LEVELS)), 1e-12);
    CHECK_NEAR(p.p_value, chance / total, 1e-12);
    CHECK_NEAR(stats_posterior_surface(&p, 1), surface / total, 1e-12);
    CHECK_NEAR(stats_posterior_draws(&p, STATS_LATENT_shift, 1, weight), shift / total, 1e-12);
    stats_posterior_draws(&p, STATS_LATENT_stop, 1, weight);
    for (int d = 0; d < 3; d++) CHECK_NEAR(weight[d], theirs[d] / total, 1e-12);
    CHECK_NEAR(weight[2], 0.0, 0.0); /* no run has a result: no number could be published */
    stats_posterior_free(&p);
}

/* A sure result changes nothing; an impossible one excludes; ignorance halves. */
static void test_censored(void)
{
    CHECK_NEAR(stats_log_normal_chance(40.0, 1.0), 0.0, 1e-12);
    CHECK_NEAR(stats_log_normal_chance(0.3, 0.0), log(0.5 * erfc(-0.3 / sqrt(2.0))), 1e-12);
    CHECK_NEAR(stats_log_normal_chance(3.0, 1e12), log(0.5), 1e-5);
    CU_ASSERT(stats_log_normal_chance(-40.0, 0.0) < -800.0 && isfinite(stats_log_normal_chance(-40.0, 0.0)));
    double z, variance, all, none, unused;
    stats_probit(5.0, 10.0, &z, &variance);
    CHECK_NEAR(z, 0.0, 1e-12);
    CHECK_NEAR(variance, 0.25 / 11.0 * 2.0 * M_PI, 1e-12);
    stats_probit(10.0, 10.0, &all, &unused);
    stats_probit(0.0, 10.0, &none, &unused);
    CHECK_NEAR(all, -none, 1e-12);
    CHECK_NEAR(0.5 * erfc(none / sqrt(2.0)), 10.5 / 11.0, 1e-12);
}

static void test_weighted(void)
{
    const double x[5] = {3.0, 1.0, 2.0, 5.0, 4.0}, w[5] = {0.1, 0.3, 0.2, 0.3, 0.1}, nothing[5] = {0.0};
    size_t order[5];
    CHECK_NEAR(stats_weighted_quantile(5, x, w, 0.29, order), 1.0, 0.0);
    CHECK_NEAR(stats_weighted_quantile(5, x, w, 0.31, order), 2.0, 0.0);
    CHECK_NEAR(stats_weighted_quantile(5, x, w, 0.55, order), 3.0, 0.0);
    CHECK_NEAR(stats_weighted_quantile(5, x, w, 1.0, order), 5.0, 0.0);
    CU_ASSERT(isnan(stats_weighted_quantile(5, x, nothing, 0.5, order)));
    CHECK_NEAR(stats_bayes_factor(0.2, 0.2), 1.0, 1e-12);
    CHECK_NEAR(stats_bayes_factor(0.25, 0.75), 9.0, 1e-12);
}

/* Draws come by their weights, each once: the first in proportion to them, all that have one if so many are
 * asked for. */
static void test_sample(void)
{
    enum { N = 4, TIMES = 4000 };
    const double weight[N] = {0.1, 0.0, 0.2, 0.7};
    double first[N] = {0.0};
    size_t index[N];
    gsl_rng *rng = rp_random_alloc(43, 0, RP_PURPOSE_TEST);
    for (size_t k = 0; k < TIMES; k++) {
        CHECK_OK(stats_sample(N, weight, 1, index, rng));
        first[index[0]] += 1.0 / TIMES;
        CHECK_OK(stats_sample(N, weight, 3, index, rng));
        CU_ASSERT(index[0] + index[1] + index[2] == 0 + 2 + 3 && index[0] != index[1] &&
                  index[1] != index[2] && index[0] != index[2]);
    }
    for (size_t i = 0; i < N; i++) /* 4.5 standard deviations */
        CHECK_NEAR(first[i], weight[i], 4.5 * sqrt(weight[i] * (1.0 - weight[i]) / TIMES));
    CHECK_FAILS(stats_sample(N, weight, 4, index, rng), RP_NO_RESULT, "3 draws have a weight, 4 expected");
    gsl_rng_free(rng);
}

/* Each number is spread evenly: of 64 equal bins at most one is empty, since the sequence lacks its first
 * point. Each level stands as often as any other, to one. The seed decides the design. */
static void test_design(void)
{
    enum { N = 64, REALS = 6, FACTORS = 2 };
    static double u[N * REALS], again[N * REALS];
    size_t level[FACTORS * N], unused[FACTORS * N];
    const size_t n_levels[FACTORS] = {3, 2};
    for (int k = 0; k < 3; k++) {
        gsl_rng *rng = rp_random_alloc(k < 2 ? 41 : 42, 0, RP_PURPOSE_TEST);
        CHECK_OK(stats_design(N, REALS, k ? again : u, FACTORS, n_levels, k ? unused : level, rng));
        gsl_rng_free(rng);
        if (k)
            CU_ASSERT((memcmp(u, again, sizeof u) == 0 && memcmp(level, unused, sizeof level) == 0) ==
                      (k == 1));
    }
    for (size_t p = 0; p < REALS; p++) {
        bool seen[N] = {false};
        int empty = 0;
        for (size_t i = 0; i < N; i++) {
            CU_ASSERT_FATAL(u[i * REALS + p] > 0.0 && u[i * REALS + p] < 1.0);
            CU_ASSERT(fmod(ldexp(u[i * REALS + p], 30), 1.0) == 0.5); /* the middle of one of 2^30 parts */
            seen[(int)(N * u[i * REALS + p])] = true;
        }
        for (size_t i = 0; i < N; i++) empty += !seen[i];
        CU_ASSERT(empty <= 1);
    }
    for (size_t f = 0; f < FACTORS; f++)
        for (size_t l = 0; l < n_levels[f]; l++) {
            size_t n = 0;
            for (size_t i = 0; i < N; i++) n += level[f * N + i] == l;
            CU_ASSERT(n == N / n_levels[f] || n == N / n_levels[f] + 1);
        }
    gsl_rng *rng = rp_random_alloc(41, 0, RP_PURPOSE_TEST);
    CHECK_OK(stats_design(N / 4, 16, u, 0, NULL, NULL, rng));
    CHECK_OK(stats_design(N, 1, u, 0, NULL, NULL, rng));
    CHECK_FAILS(stats_design(N, 17, u, 0, NULL, NULL, rng), RP_BAD_INPUT, "17 numbers");
    CHECK_FAILS(stats_design(N, 0, u, 0, NULL, NULL, rng), RP_BAD_INPUT, "0 numbers");
    gsl_rng_free(rng);
}

static void test_errors(void)
{
    const double mean = 1.0, covariance = 1.0, scale = 1.0, complete = 0.0, never = -INFINITY,
                 nowhere = 1e200;
    stats_predictions model = {1, 1, 1, &mean, &covariance, &scale, &complete, 1.0};
    static const stats_published bad[] = {
        {NAN, 1.0, 2.0}, {1.0, 0.0, 2.0}, {1.0, INFINITY, 2.0}, {1.0, 1.0, 0.0}, {1.0, 1.0, NAN}};
    const stats_published good = {1.0, 1.0, 2.0};
    stats_posterior p;
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        CHECK_FAILS(stats_posterior_make(&model, &bad[i], &p), RP_BAD_INPUT, "published number 1");
        stats_posterior_free(&p);
    }
    model.n_points = 0;
    CHECK_FAILS(stats_posterior_make(&model, &good, &p), RP_BAD_INPUT, "published numbers: 0");
    stats_posterior_free(&p);
    model.n_points = 1;
    model.mean = &nowhere;
    CHECK_FAILS(stats_posterior_make(&model, &good, &p), RP_NO_RESULT, "no draw agrees");
    stats_posterior_free(&p);
    model.mean = &mean;
    model.log_complete = &never; /* where the stop is theirs only */
    CHECK_OK(stats_posterior_make(&model, &good, &p));
    CHECK_NEAR(stats_posterior_draws(&p, STATS_LATENT_stop, 0, (double[1]){0}), 1.0, 1e-12);
    stats_posterior_free(&p);
}

/* ---- planted truths ---- */

enum { REALS = 3, POINTS = 3, SETTINGS = 50, DRAWS = 2000, TRUTHS = 50 };

/* A cheap simulator: at point k, of three numbers in (-1, 1) and a factor of two levels. */
static double simulate(const double x[], int level, int k)
{
    return 18.0 + 2.5 * x[0] * (1.0 - 0.4 * k) + 1.2 * sin(2.0 * x[1] + k) -
           1.5 * level * (k == 1 ? -1.0 : 1.0) + 0.5 * x[0] * x[1];
}

/* Inputs of all points at the settings of a design: its numbers, the point, the factor. */
static void make_rows(size_t n, const double u[], const size_t factor[], double x[], int level[])
{
    for (size_t i = 0; i < n; i++)
        for (int k = 0; k < POINTS; k++) {
            for (int p = 0; p < REALS; p++)
                x[(i * POINTS + k) * (REALS + 1) + p] = 2.0 * u[i * REALS + p] - 1.0;
            x[(i * POINTS + k) * (REALS + 1) + REALS] = k - 1.0;
            level[i * POINTS + k] = (int)factor[i];
        }
}

typedef struct {
    double x[DRAWS * POINTS * (REALS + 1)], mean[DRAWS * POINTS], covariance[DRAWS * POINTS * POINTS];
    int level[DRAWS * POINTS];
} planted_draws;

/* Emulate runs with a noise of 0.8 degrees a mean, then predict draws. */
static void emulate(planted_draws *draws, gsl_rng *rng)
{
    static double u[DRAWS * REALS], x[SETTINGS * POINTS * (REALS + 1)], y[SETTINGS * POINTS],
        variance[SETTINGS * POINTS];
    static int level[SETTINGS * POINTS];
    size_t factor[DRAWS], two = 2, n = SETTINGS * POINTS;
    CHECK_OK(stats_design(SETTINGS, REALS, u, 1, &two, factor, rng));
    make_rows(SETTINGS, u, factor, x, level);
    for (size_t i = 0; i < n; i++) {
        variance[i] = 0.64;
        y[i] = simulate(x + i * (REALS + 1), level[i], (int)(i % POINTS)) - 18.0 + gsl_ran_gaussian(rng, 0.8);
    }
    const stats_inputs in = {n, REALS + 1, 1, x, level};
    stats_emulator e;
    CHECK_OK(stats_emulator_make(STATS_SMOOTH, &in, variance, 2.0, &e));
    CHECK_OK(stats_emulator_fit(&e, y, n));
    stats_emulator_weights(&e, y, y);
    CHECK_OK(stats_design(DRAWS, REALS, u, 1, &two, factor, rng));
    make_rows(DRAWS, u, factor, draws->x, draws->level);
    for (size_t d = 0; d < DRAWS; d++) {
        const stats_inputs at = {POINTS, REALS + 1, 1, draws->x + d * POINTS * (REALS + 1),
                                 draws->level + d * POINTS};
        CHECK_OK(stats_emulator_predict(&e, &at, 1, y, draws->mean + d * POINTS,
                                        draws->covariance + d * POINTS * POINTS));
        for (int k = 0; k < POINTS; k++) draws->mean[d * POINTS + k] += 18.0;
    }
    stats_emulator_free(&e);
}

/* The stated 95 % intervals hold the truth in 43 to 50 of 50 cases: fewer have a chance of 1 %, for each of
 * the three numbers, if all is right. The level that published has the larger share on average. */
static void test_truths(void)
{
    static planted_draws draws;
    static double scale = 1.0, complete[DRAWS], value[DRAWS], weight[DRAWS];
    static size_t order[DRAWS];
    gsl_rng *rng = rp_random_alloc(51, 0, RP_PURPOSE_TEST);
    int covered[REALS] = {0};
    double share = 0.0;
    emulate(&draws, rng);
    const stats_predictions model = {DRAWS, 1, POINTS, draws.mean, draws.covariance, &scale, complete, 1.0};
    for (int t = 0; t < TRUTHS; t++) {
        double truth[REALS];
        const int level = t % 2;
        stats_published numbers[POINTS];
        const double shift = gsl_rng_uniform(rng) < 0.5 ? gsl_ran_gaussian(rng, 1.0) : 0.0;
        const bool deviation = gsl_rng_uniform(rng) < 0.5;
        for (int p = 0; p < REALS; p++) truth[p] = 2.0 * gsl_rng_uniform(rng) - 1.0;
        for (int k = 0; k < POINTS; k++)
            numbers[k] = (stats_published){simulate(truth, level, k) + shift +
                                               gsl_ran_gaussian(rng, deviation ? 0.7 / sqrt(20.0) : 0.7),
                                           0.7, 20.0};
        stats_posterior p;
        CHECK_OK(stats_posterior_make(&model, numbers, &p));
        stats_posterior_draws(&p, -1, 0, weight);
        for (int r = 0; r < REALS; r++) {
            for (size_t d = 0; d < DRAWS; d++) value[d] = draws.x[d * POINTS * (REALS + 1) + r];
            covered[r] += stats_weighted_quantile(DRAWS, value, weight, 0.025, order) <= truth[r] &&
                          stats_weighted_quantile(DRAWS, value, weight, 0.975, order) >= truth[r];
        }
        for (size_t d = 0; d < DRAWS; d++)
            share += draws.level[d * POINTS] == level ? weight[d] / TRUTHS : 0.0;
        stats_posterior_free(&p);
    }
    gsl_rng_free(rng);
    for (int r = 0; r < REALS; r++) CU_ASSERT(covered[r] >= 43);
    CU_ASSERT(share > 0.6);
}

/* ---- groups ---- */

/* Each group by its formula, from parameters that are no power of one another, and back: the open groups of
 * another pile, put into these parameters, are found in them again. */
static void test_groups(void)
{
    static const char *const given[][2] = {{"k_n", "3e5"},     {"k_s", "2e4"},      {"gamma_n", "350"},
                                           {"mu", "0.3"},      {"mu_wall", "0.12"}, {"mu_floor", "0.45"},
                                           {"open", "7"},      {"stop", "steps"},   {"relax_steps", "30000"},
                                           {"density", "1.7"}, {"g", "700"},        {"W", "3"},
                                           {"H", "5"},         {"dt", "4e-5"},      {"radius_mean", "0.12"}};
    static const double open[] = {3e4, 12.0, 0.7, 1.9, 130.0, 23.0};
    const sweep_protocol *p = &sweep_protocol_repose;
    void *params = calloc(1, p->params_size);
    double v[SWEEP_N_GROUPS], again[SWEEP_N_GROUPS], mass, gravity;
    rp_params_defaults(p->schema, params);
    for (size_t i = 0; i < sizeof given / sizeof *given; i++)
        CHECK_OK(rp_params_set_text(rp_params_find(p->schema, given[i][0]), params, given[i][1]));
    sweep_groups_of(params, v);
    sweep_groups_weight(params, &mass, &gravity);
    const double d = 0.24, t = sqrt(d / 700.0), weight = 4.0 / 3.0 * M_PI * pow(0.12, 3.0) * 1.7 * 700.0;
    CHECK_NEAR(mass * gravity, weight, 1e-12 * weight);
    const struct {
        size_t group;
        double expected;
    } groups[] = {{SWEEP_GROUP_stiffness, 3e5 * pow(d, 1.5) / weight},
                  {SWEEP_GROUP_damping_rate, 350.0 * t},
                  {SWEEP_GROUP_wall_friction, 0.4},
                  {SWEEP_GROUP_floor_friction, 1.5},
                  {SWEEP_GROUP_pause, 30000.0 * 4e-5 / t},
                  {SWEEP_GROUP_opening, 7.0 * t / d},
                  {SWEEP_GROUP_shear_stiffness, 2e4 * d / weight},
                  {SWEEP_GROUP_friction, 0.3},
                  {SWEEP_GROUP_width, 3.0 / d},
                  {SWEEP_GROUP_height, 5.0 / d}};
    CU_ASSERT(sizeof groups / sizeof *groups == SWEEP_N_GROUPS);
    for (size_t i = 0; i < SWEEP_N_GROUPS; i++)
        CHECK_NEAR(v[groups[i].group], groups[i].expected, 1e-12 * groups[i].expected);
    memcpy(v, open, sizeof open); /* the open groups come first */
    sweep_groups_apply(v, params);
    sweep_groups_of(params, again);
    for (size_t g = 0; g < sizeof open / sizeof *open; g++)
        CHECK_NEAR(again[g], open[g], (g == SWEEP_GROUP_pause ? 1e-3 : 1e-12) * open[g]); /* whole steps */
    free(params);
}

/* ---- the command ---- */

static size_t row_of(const rp_table *t, const char *choice, const char *level, const char *given)
{
    for (size_t i = 0; i < t->n_rows; i++)
        if (!strcmp(word(t, i, "choice"), choice) && !strcmp(word(t, i, "level"), level) &&
            !strcmp(word(t, i, "given"), given))
            return i;
    CU_FAIL("no such row");
    return 0;
}

static void check_inside(const rp_table *t, const char *choice, const char *given, double truth)
{
    const size_t i = row_of(t, choice, "-", given);
    CU_ASSERT(cell(t, i, "lower") < truth && truth < cell(t, i, "upper"));
    CU_ASSERT(cell(t, i, "lower") < cell(t, i, "median") && cell(t, i, "median") < cell(t, i, "upper"));
}

/* The truth that planted_write published is found from its table, by the command, and twice to the bit. */
static void test_command(void)
{
    static char first[sizeof out];
    enter();
    planted_write("", 60, false);
    GOOD("forensics runs.tsv --claims claims.tsv --draws 1000");
    strcpy(first, out);
    rp_table t = read_table("out");
    const double stiffness = planted_stiffness(2.0, 500.0, 1e6), damping = planted_damping(500.0, 500.0);
    check_inside(&t, "stiffness", "all", stiffness);
    check_inside(&t, "stiffness", "shift=none", stiffness);
    check_inside(&t, "stiffness", "shift=common", stiffness);
    check_inside(&t, "damping_rate", "all", damping);
    check_inside(&t, "grain_mass", "all", 8e-3 * M_PI / 3.0);
    check_inside(&t, "gravity", "all", 500.0);
    CU_ASSERT(cell(&t, row_of(&t, "stiffness", "-", "shift=none"), "width") <
              cell(&t, row_of(&t, "stiffness", "-", "shift=common"), "width"));
    CU_ASSERT(cell(&t, row_of(&t, "stiffness", "-", "all"), "width") < 0.8);
    CU_ASSERT(cell(&t, row_of(&t, "damping_rate", "-", "emulator=exact"), "width") <
              cell(&t, row_of(&t, "damping_rate", "-", "all"), "width"));
    const size_t total = row_of(&t, "slip", "total", "-");
    CHECK_NEAR(cell(&t, total, "share") + cell(&t, row_of(&t, "slip", "truncated", "-"), "share"), 1.0,
               1e-12);
    const double exact = cell(&t, row_of(&t, "slip", "total", "emulator=exact"), "share");
    CHECK_NEAR(exact + cell(&t, row_of(&t, "slip", "truncated", "emulator=exact"), "share"), 1.0, 1e-12);
    CU_ASSERT(exact > 0.5 && exact != cell(&t, total, "share"));
    CU_ASSERT(cell(&t, total, "share") > 0.5 && cell(&t, total, "bayes_factor") > 1.0);
    CU_ASSERT(cell(&t, row_of(&t, "surface", "centre_zero_origin", "-"), "share") < 0.01);
    rp_table_free(&t);
    GOOD("forensics runs.tsv --claims claims.tsv --draws 1000");
    CU_ASSERT_STRING_EQUAL(out, first);
    GOOD("forensics runs.tsv --claims claims.tsv --draws 1000 --report numbers");
    t = read_table("out");
    CU_ASSERT(t.n_rows == 4);
    for (size_t i = 0; i < t.n_rows; i++) {
        CHECK_NEAR(cell(&t, i, "predicted_deg"), cell(&t, i, "published_deg"), 0.8);
        CU_ASSERT(cell(&t, i, "predicted_sd_deg") < cell(&t, i, "prior_sd_deg"));
        CU_ASSERT(cell(&t, i, "p_value") > 0.05 && cell(&t, i, "p_value") <= 1.0);
    }
    CU_ASSERT_STRING_EQUAL(word(&t, 3, "role"), "held_out");
    rp_table_free(&t);
    leave();
}

/* The means of each setting and point of runs.tsv, in the form of `sweep export --reduce`. */
static void write_reduced(void)
{
    enum { PARAMETERS = 6 }; /* and the status before them */
    rp_table t = read_table("runs.tsv");
    char path[256];
    path_of("reduced.tsv", path);
    FILE *file = fopen(path, "w");
    CU_ASSERT_PTR_NOT_NULL_FATAL(file);
    fputs("# mu: 0.2\n# shape: sphere\n# n\tn_failed", file);
    for (size_t c = 1; c < PARAMETERS; c++) fprintf(file, "\t%s", t.names[c]);
    for (size_t c = PARAMETERS; c < t.n_columns; c++)
        fprintf(file, "\t%s_mean\t%s_sd\t%s_n", t.names[c], t.names[c], t.names[c]);
    for (size_t row = 0; row < t.n_rows; row += PLANTED_PILES) {
        const int n = strcmp(word(&t, row, "status"), "ok") == 0 ? PLANTED_PILES : 0;
        fprintf(file, "\n%d\t%d", n, PLANTED_PILES - n);
        for (size_t c = 1; c < PARAMETERS; c++) fprintf(file, "\t%s", word(&t, row, t.names[c]));
        for (size_t c = PARAMETERS; c < t.n_columns; c++) {
            double v[PLANTED_PILES];
            stats_summary s;
            for (size_t k = 0; k < PLANTED_PILES; k++) v[k] = cell(&t, row + k, t.names[c]);
            CHECK_OK(stats_mean(PLANTED_PILES, v, &s));
            fprintf(file, "\t%.17g\t%.17g\t%d", n ? s.mean : NAN, n ? s.sd : NAN, n);
        }
    }
    fputc('\n', file);
    fclose(file);
    rp_table_free(&t);
}

/* Means over the runs of a setting and point say what the runs say; and numbers that are all too large by 3
 * degrees share that error with the number that is held out. */
static void test_reduced(void)
{
    enter();
    planted_write("", 60, true);
    GOOD("forensics runs.tsv --claims claims.tsv --draws 300");
    rp_table runs = read_table("out");
    write_reduced();
    GOOD("forensics reduced.tsv --claims claims.tsv --draws 300");
    rp_table reduced = read_table("out");
    CU_ASSERT_FATAL(runs.n_rows == reduced.n_rows);
    for (size_t i = 0; i < runs.n_rows; i++)
        if (!isnan(cell(&runs, i, "median")))
            CHECK_NEAR(cell(&reduced, i, "median") / cell(&runs, i, "median"), 1.0, 1e-9);
        else
            CHECK_NEAR(cell(&reduced, i, "share"), cell(&runs, i, "share"), 1e-9);
    const size_t ours = row_of(&runs, "stiffness", "-", "stop=ours"),
                 theirs = row_of(&runs, "stiffness", "-", "stop=theirs"),
                 prior = row_of(&runs, "stiffness", "-", "prior");
    CU_ASSERT(cell(&runs, ours, "median") != cell(&runs, theirs, "median"));
    CHECK_NEAR(cell(&runs, prior, "width"), 1.0, 0.05);
    rp_table_free(&runs);
    rp_table_free(&reduced);
    planted_write("", 60, false);
    CU_ASSERT(shell("awk -F'\t' -v OFS='\t' '/^[a-z]/ && $1 != \"id\" { $7 += 3 } { print }' claims.tsv "
                    ">shifted.tsv") == 0);
    GOOD("forensics runs.tsv --claims shifted.tsv --draws 1000 --report numbers");
    rp_table numbers = read_table("out");
    CU_ASSERT(cell(&numbers, 3, "p_value") > 0.5); /* 0.2 if it had an error of its own */
    rp_table_free(&numbers);
    leave();
}

/* What the header says of the emulator is what its own report says of the better kernel. */
static void test_notes(void)
{
    enter();
    planted_write("", 60, false);
    GOOD("forensics runs.tsv --claims claims.tsv --draws 200 --report emulator");
    rp_table t = read_table("out");
    char expected[256];
    CU_ASSERT_FATAL(t.n_rows == 2);
    const size_t used = strcmp(word(&t, 0, "used"), "yes") == 0 ? 0 : 1;
    CU_ASSERT(strcmp(word(&t, used, "used"), "yes") == 0 && strcmp(word(&t, 1 - used, "used"), "no") == 0);
    snprintf(expected, sizeof expected,
             "# emulator: %s; leaving out a setting: %.2g degrees rms, noise of the piles %.2g\n",
             word(&t, used, "kernel"), cell(&t, used, "rms_left_out"), cell(&t, used, "noise"));
    CU_ASSERT(strstr(out, expected) != NULL);
    CU_ASSERT(
        strstr(out, "# settings: 60, at 3 points; 0 of 180 have fewer than two piles with a result\n") !=
        NULL);
    /* four piles of each cell scatter by 0.4 and 0.6 degrees to both sides */
    CHECK_NEAR(cell(&t, used, "noise"), sqrt((0.16 + 0.16 + 0.36 + 0.36) / 3.0 / 4.0), 1e-6);
    CU_ASSERT(cell(&t, used, "rms_left_out") < cell(&t, used, "spread"));
    const double error = atof(strstr(out, "# model_error: ") + strlen("# model_error: "));
    CU_ASSERT(error > 0.0 && error < cell(&t, used, "noise")); /* of the four piles of a setting */
    rp_table_free(&t);
    leave();
}

/* A second design is of the posterior: its settings lie nearer to the truth that was published than those of
 * the first, in units of the prior's range, and a sweep can run them. */
static void test_second_design(void)
{
    enum { N = 20 };
    enter();
    planted_write("", 60, false);
    double squares = 0.0;
    int n_total = 0;
    GOOD("forensics runs.tsv --claims claims.tsv --shift-deg 0.1 --draws 1000 --design %d", N);
    const char *g = strstr(out, " g = (") + strlen(" g = (");
    for (char *end; *g == ' ' || *g == '\n' || *g == ','; g = end + (*end == ',')) {
        const double damping = planted_damping(strtod(g, &end), 500.0);
        if (end == g) break;
        squares += pow(log(damping / planted_damping(500.0, 500.0)) / log(50.0 / 3.0), 2.0) / N;
    }
    for (const char *word = out; (word = strstr(word, "\"total\"")); word++) n_total++;
    CU_ASSERT(squares > 0.0 && sqrt(squares) < 0.22); /* that of the prior is 0.29 or more */
    CU_ASSERT(n_total > 14);                          /* as the truth */
    write_text("second.cfg", "protocol = \"repose\"; replicas = 1; fixed = { stop = \"steps\"; };\n%s", out);
    GOOD("sweep plan second.cfg -o second");
    CU_ASSERT(strstr(out, "second: 60 runs (60 grid points") != NULL);
    CU_ASSERT(shell("sed 's/total/frob/' runs.tsv >bad.tsv") == 0);
    FAILS(65, "frob", "forensics bad.tsv --claims claims.tsv --draws 200 --design 5");
    FAILS(1, "draws have a weight, 150 expected",
          "forensics runs.tsv --claims claims.tsv --draws 100 --design 150");
    leave();
}

/* Runs in two tables are those in one; what the first alone predicts of the second stands beside it. Angles
 * of the second that are 5 degrees larger are so much beyond the prediction, since none of its settings takes
 * part. */
static void test_two_sweeps(void)
{
    static char whole[sizeof out];
    enter();
    planted_write("", 60, false);
    GOOD("forensics runs.tsv --claims claims.tsv --draws 300");
    strcpy(whole, strstr(out, "# settings"));
    CU_ASSERT(
        shell("head -n 543 runs.tsv >first.tsv; (head -n 3 runs.tsv; tail -n +544 runs.tsv) >later.tsv; "
              "awk -F'\t' -v OFS='\t' 'NR > 3 { for (i = 7; i <= NF; i++) $i += 5 } 1' later.tsv "
              ">shifted.tsv") == 0);
    GOOD("forensics first.tsv later.tsv --claims claims.tsv --draws 300");
    const char *rows = strchr(strstr(out, "# effective"), '\n'),
               *same = strchr(strstr(whole, "# effective"), '\n');
    CU_ASSERT_STRING_EQUAL(rows, same);
    double rms[2];
    for (int k = 0; k < 2; k++) {
        GOOD("forensics first.tsv %s.tsv --claims claims.tsv --draws 200 --report emulator",
             k ? "shifted" : "later");
        rp_table t = read_table("out");
        CU_ASSERT_FATAL(t.n_rows == 4);
        const size_t used = strcmp(word(&t, 0, "used"), "yes") == 0 ? 1 : 3;
        CU_ASSERT(strcmp(word(&t, used, "left_out"), "sweep") == 0 && cell(&t, used, "cells") == 45.0 &&
                  cell(&t, used - 1, "cells") == 135.0);
        CU_ASSERT(k ? cell(&t, used, "covered") < 0.5 : cell(&t, used, "covered") > 0.8);
        rms[k] = cell(&t, used, "rms_left_out");
        if (k == 0)
            CHECK_NEAR(cell(&t, used, "stated"), hypot(cell(&t, used, "noise"), 0.05), 0.05); /* by both */
        CU_ASSERT(cell(&t, used, "spread") != cell(&t, used - 1, "spread")); /* each of its own cells */
        rp_table_free(&t);
    }
    CU_ASSERT(rms[0] < 1.0);
    CHECK_NEAR(rms[1], 5.0, 1.0);
    leave();
}

/* A number was published where our runs stop: the reading that they would have stopped there too has little
 * left. Without such runs both readings are one. */
static void test_stops(void)
{
    for (int stops = 0; stops < 2; stops++) {
        enter();
        planted_write("", 60, stops);
        GOOD("forensics runs.tsv --claims claims.tsv --draws 500");
        CU_ASSERT((strstr(out, "; 0 of 180 have fewer") == NULL) == stops);
        rp_table t = read_table("out");
        const double share = cell(&t, row_of(&t, "stop", "theirs", "-"), "share");
        CU_ASSERT(stops ? share < 0.3 : fabs(share - 0.5) < 1e-9);
        rp_table_free(&t);
        GOOD("forensics runs.tsv --claims claims.tsv --draws 500 --report emulator");
        t = read_table("out");
        CU_ASSERT_FATAL(t.n_rows == (stops ? 4 : 2));
        CU_ASSERT(!stops ||
                  (strcmp(word(&t, 2, "quantity"), "completion") == 0 && cell(&t, 2, "cells") == 180.0));
        CU_ASSERT((cell(&t, 0, "cells") < 180.0) == stops);
        rp_table_free(&t);
        leave();
    }
}

static void test_command_errors(void)
{
    static const struct {
        const char *file, *change;
        int status;
        const char *text;
    } cases[] = {
        {"claims", "sed 's/0.3\t20\t2/-\t20\t2/'", 65, "claim base: a published number with its error"},
        {"claims", "sed 's/k_n=1e5/H=4/'", 65, "claim soft: \"H=4\": not among the keys"},
        {"claims", "sed 's/# at: /# at: frob=1 /'", 65, "at: frob: no parameter of repose"},
        {"claims", "sed 's/# at: /# at: frob /'", 65, "\"frob\": key=value expected"},
        {"claims", "sed '/# at/d'", 65, "no header line \"at\""},
        {"claims", "sed 's/theta_r3 gamma/theta_r2 gamma/'", 65, "are of one column, theta_r3"},
        {"claims", "sed 's/held theta_r1/held/'", 65, "claim first: \"held\": a column expected"},
        {"claims", "sed 's/held theta_r1/-/; s/theta_r3[^\t]*/-/'", 1, "bad.tsv: no claims"},
        {"claims", "sed 's/held theta_r1/held theta_r9/'", 65, "no column \"theta_r9_deg\""},
        {"runs", "sed 's/slip/slap/; s/density/thing/; s/\tg\t/\th\t/'", 65, "no column of a choice"},
        {"runs", "head -n 16", 1, "3 settings and points with two results, at least 8 expected"},
        {"runs", "sed 's/truncated/trunk/'", 65, "slip"},
        {"runs",
         "awk -F'\t' -v OFS='\t' '{ $4 = /^#/ ? \"radius_width\" : NR / 1e4; print }' | "
         "sed 's/^# mu.*//; s/^# shape.*//'",
         65, "no factor"},
        {"runs",
         "awk -F'\t' -v OFS='\t' '{ $4 = /^# status/ ? \"open\" : NR % 24 < 12 ? \"instant\" : 50; print }' "
         "| "
         "sed 's/^# mu.*//; s/^# shape.*//'",
         65, "group opening"}};
    enter();
    planted_write("", 20, false);
    FAILS(64, "RUNS or --design N expected", "forensics --claims claims.tsv");
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        char line[512];
        const bool claims = strcmp(cases[k].file, "claims") == 0;
        snprintf(line, sizeof line, "cat %s.tsv | %s >bad.tsv", cases[k].file, cases[k].change);
        CU_ASSERT(shell(line) == 0);
        FAILS(cases[k].status, cases[k].text,
              claims ? "forensics runs.tsv --claims bad.tsv" : "forensics bad.tsv --claims claims.tsv");
    }
    CU_ASSERT(shell("sed 's/0.3\t20\t2/0.3\t1\t2/' claims.tsv >single.tsv") == 0);
    GOOD("forensics runs.tsv --claims single.tsv --draws 200 --report numbers"); /* of one sample each */
    leave();
}

/* Points of the numbers, as the design prints them: each once, in the order of the claims but those held out,
 * with the keys of the header; names that begin alike are different keys. */
static void test_points(void)
{
    static const char *const claims[] = {"held theta_r1 slip=total",
                                         "theta_r3",
                                         "theta_r3 k_n=1e5",
                                         "theta_r3 k_s=3e4 gamma_n=9",
                                         "theta_r3 gamma_n=9 k_s=3e4",
                                         "held theta_r2 k_n=1e5",
                                         "held theta_r3 mu_roll=0.1 k_n=1e5"};
    enum { N_CLAIMS = sizeof claims / sizeof *claims };
    char text[8192] =
        "# at: k_n=1e6 k_s=2e4 gamma_n=500 mu=0.2 mu_roll=0 slip=truncated\n# id\tof\tpaper\tplace\tsection\t"
        "test\tpublished\tpublished_se\tsamples\tmargin\tfamily\tanswer\tagainst\tforensics\tstatement\t"
        "note\n",
         rows[8192] = "";
    enter();
    for (int k = 0; k < N_CLAIMS; k++)
        snprintf(text + strlen(text), sizeof text - strlen(text),
                 "c%d\t-\tlh\t-\tall\tagrees\t20\t0.3\t1\t2\t-\tt v\t-\t%s\ta\t-\n", k, claims[k]);
    write_text("claims.tsv", "%s", text);
    GOOD("forensics --design 3 --claims claims.tsv");
    CU_ASSERT_PTR_NOT_NULL(strstr(out,
                                  "    {\n"
                                  "      k_n = ( 1e6, 1e5, 1e6, 1e6, 1e5 );\n"
                                  "      k_s = ( 2e4, 2e4, 3e4, 2e4, 2e4 );\n"
                                  "      gamma_n = ( 500, 500, 9, 500, 500 );\n"
                                  "      mu = ( 0.2, 0.2, 0.2, 0.2, 0.2 );\n"
                                  "      mu_roll = ( 0, 0, 0, 0, 0.1 );\n"
                                  "      slip = ( \"truncated\", \"truncated\", \"truncated\", \"total\", "
                                  "\"truncated\" );\n    }\n);\n"));
    /* 24 numbers of four columns are the most */
    *strstr(text, "c0\t") = '\0';
    for (int k = 0; k < 25; k++) {
        static const char *const columns[] = {"theta_r3", "held theta_r1", "held theta_r2",
                                              "held theta_r3_top_zero"};
        snprintf(rows + strlen(rows), sizeof rows - strlen(rows),
                 "c%d\t-\tlh\t-\tall\tagrees\t20\t0.3\t1\t2\t-\tt v\t-\t%s mu=0.%d\ta\t-\n", k,
                 columns[k % 4], k + 10);
        if (k < 23) continue;
        write_text("claims.tsv", "%s%s", text, rows);
        if (k == 23) CU_ASSERT(run("forensics --design 2 --claims claims.tsv") == 0);
        if (k == 24) FAILS(65, "at most 24 claims", "forensics --design 2 --claims claims.tsv");
    }
    write_text("claims.tsv", "%s%.*s%s", text, (int)(strstr(rows, "c4\t") - rows), rows,
               "d\t-\tlh\t-\tall\tagrees\t20\t0.3\t1\t2\t-\tt v\t-\theld theta_x\ta\t-\n");
    FAILS(65, "claim d: theta_x: at most 4 columns", "forensics --design 2 --claims claims.tsv");
    leave();
}

/* The grid of a file is what a command prints. */
static void check_grid(const char *root, const char *name, const char *command)
{
    static char text[1 << 16];
    char path[600];
    snprintf(path, sizeof path, "%s/sweeps/studies/%s.cfg", root, name);
    FILE *file = fopen(path, "r");
    CU_ASSERT_PTR_NOT_NULL_FATAL(file);
    text[fread(text, 1, sizeof text - 1, file)] = '\0';
    fclose(file);
    GOOD("%s --claims %s/report/claims.tsv", command, root);
    CU_ASSERT(strncmp(out, "grid = (", 8) == 0 && strstr(text, out) != NULL);
}

/* The designs of the studies are what the command prints, and each of their settings is allowed. */
static void test_study(void)
{
    char root[512], command[600];
    CU_ASSERT_PTR_NOT_NULL_FATAL(getcwd(root, sizeof root));
    enter();
    check_grid(root, "lh_forensics", "forensics --design 200 --seed 1993");
    snprintf(command, sizeof command, "forensics %s/results/lh_forensics.tsv --draws 1000 --design 40", root);
    check_grid(root, "lh_forensics_posterior", command);
    write_text("small.cfg", "protocol = \"repose\"; replicas = 1; fixed = { stop = \"steps\"; };\n");
    planted_write("", 4, false);
    /* the time step is that of the stiffest point, whichever it is */
    static const char *const stiff[] = {"s/k_n=1e5/k_n=1e8/", "s/gamma_n=100/k_n=1e8/",
                                        "s/at: k_n=1e6/at: k_n=1e8/"};
    for (size_t k = 0; k < sizeof stiff / sizeof *stiff; k++) {
        char line[256];
        snprintf(line, sizeof line,
                 "sed '%s' claims.tsv >stiff.tsv; (cat small.cfg; $REPOSE forensics --design 12 --claims "
                 "stiff.tsv) "
                 ">stiff.cfg",
                 stiff[k]);
        shell(line);
        GOOD("sweep plan stiff.cfg -o stiff_%zu", k);
        CU_ASSERT(strstr(err, "36 runs") || strstr(out, "36 runs"));
    }
    leave();
}

void suite_forensics(void)
{
    static const check_case cases[] = {
        {"likelihood of published numbers", test_likelihood},
        {"posterior of draws", test_posterior},
        {"limits of runs without a number", test_censored},
        {"weighted quantiles and Bayes factors", test_weighted},
        {"designs", test_design},
        {"draws by their weights", test_sample},
        {"errors of posteriors", test_errors},
        {"planted truths", test_truths},
        {"groups", test_groups},
        {"planted runs, by the command", test_command},
        {"means in place of runs, and a common error", test_reduced},
        {"header of the command", test_notes},
        {"a design from the posterior", test_second_design},
        {"runs of two sweeps", test_two_sweeps},
        {"runs that stop, by the command", test_stops},
        {"errors of the command", test_command_errors},
        {"points of published numbers", test_points},
        {"the design of the study", test_study},
        {NULL, NULL},
    };
    check_register("forensics", cases);
}
