/* Emulators of noisy functions: closed forms, derivatives, predictions of what was left out. */
#include <gsl/gsl_linalg.h>
#include <gsl/gsl_randist.h>
#include <math.h>
#include <string.h>

#include "core/random.h"
#include "stats/emulator.h"
#include "tests/check.h"

enum { N = 60, REALS = 3, FACTORS = 2, GROUP = 3 };

/* Settings at random, with levels 0 to 2 and 0 to 1. */
static struct {
    double x[N * REALS], variance[N], y[N];
    int level[N * FACTORS];
    size_t group[N];
} data;

static stats_inputs make_inputs(size_t n, unsigned long run)
{
    gsl_rng *rng = rp_random_alloc(21, run, RP_PURPOSE_TEST);
    for (size_t i = 0; i < N; i++) {
        for (size_t p = 0; p < REALS; p++) data.x[i * REALS + p] = 2.0 * gsl_rng_uniform(rng) - 1.0;
        data.level[i * FACTORS] = (int)gsl_rng_uniform_int(rng, 3);
        data.level[i * FACTORS + 1] = (int)gsl_rng_uniform_int(rng, 2);
        data.variance[i] = 0.04 + 0.02 * gsl_rng_uniform(rng);
        data.y[i] = sin(2.3 * data.x[i * REALS]) + 0.7 * data.x[i * REALS + 1] +
                    0.4 * data.level[i * FACTORS + 1] + gsl_ran_gaussian(rng, sqrt(data.variance[i]));
        data.group[i] = i / GROUP;
    }
    gsl_rng_free(rng);
    return (stats_inputs){n, REALS, FACTORS, data.x, data.level};
}

/* One value: mean k/(K + v) y and variance K - k^2/(K + v). Two values: Cramer's rule. */
static void test_closed_form(void)
{
    for (stats_kernel kernel = 0; kernel < STATS_KERNELS; kernel++)
        for (size_t n = 1; n <= 2; n++) {
            const stats_inputs in = make_inputs(n, 1),
                               at = {1, REALS, FACTORS, data.x + 5 * REALS, data.level + 5 * FACTORS};
            stats_emulator e;
            double w[2], mean, variance;
            CHECK_OK(stats_emulator_make(kernel, &in, data.variance, 0.8, &e));
            CHECK_OK(stats_emulator_factorise(&e));
            stats_emulator_weights(&e, data.y, w);
            CHECK_OK(stats_emulator_predict(&e, &at, 1, w, &mean, &variance));
            const double a = stats_emulator_kernel(&e, &in, 0, &in, 0, true) + data.variance[0],
                         b = n == 2 ? stats_emulator_kernel(&e, &in, 0, &in, 1, false) : 0.0,
                         c = n == 2 ? stats_emulator_kernel(&e, &in, 1, &in, 1, true) + data.variance[1]
                                    : 1.0,
                         k = stats_emulator_kernel(&e, &in, 0, &at, 0, false),
                         l = n == 2 ? stats_emulator_kernel(&e, &in, 1, &at, 0, false) : 0.0,
                         det = a * c - b * b;
            CHECK_NEAR(mean, (data.y[0] * (c * k - b * l) + data.y[1] * (a * l - b * k)) / det, 1e-10);
            CHECK_NEAR(variance,
                       stats_emulator_kernel(&e, &at, 0, &at, 0, true) -
                           (k * (c * k - b * l) + l * (a * l - b * k)) / det,
                       1e-10);
            stats_emulator_free(&e);
        }
}

/* Several sets of values at several settings at once are those of each set alone, at each setting alone. */
static void test_sets(void)
{
    enum { SETS = 3, AT = 4 };
    const stats_inputs in = make_inputs(N - AT, 8),
                       at = {AT, REALS, FACTORS, data.x + (N - AT) * REALS, data.level + (N - AT) * FACTORS};
    double w[SETS * N], y[N], mean[SETS * AT], covariance[AT * AT], one, variance;
    stats_emulator e;
    CHECK_OK(stats_emulator_make(STATS_SMOOTH, &in, data.variance, 0.8, &e));
    CHECK_OK(stats_emulator_factorise(&e));
    for (size_t k = 0; k < SETS; k++) {
        for (size_t i = 0; i < in.n; i++) y[i] = data.y[i] + (double)(k * (i % 5));
        stats_emulator_weights(&e, y, w + k * in.n);
    }
    CHECK_OK(stats_emulator_predict(&e, &at, SETS, w, mean, covariance));
    for (size_t j = 0; j < AT; j++) {
        const stats_inputs alone = {1, REALS, FACTORS, at.x + j * REALS, at.level + j * FACTORS};
        for (size_t k = 0; k < SETS; k++) {
            CHECK_OK(stats_emulator_predict(&e, &alone, 1, w + k * in.n, &one, &variance));
            CHECK_NEAR(mean[k * AT + j], one, 1e-12);
            CHECK_NEAR(covariance[j * AT + j], variance, 1e-12);
        }
        for (size_t i = 0; i < j; i++) { /* the same both ways, and no more than both allow */
            CHECK_NEAR(covariance[i * AT + j], covariance[j * AT + i], 1e-12);
            CU_ASSERT(pow(covariance[i * AT + j], 2.0) < covariance[i * AT + i] * covariance[j * AT + j]);
        }
    }
    stats_emulator_free(&e);
}

/* The kernels themselves, by their formulas. */
static void test_kernels(void)
{
    const stats_inputs in = make_inputs(2, 2);
    stats_emulator e;
    const double *x = data.x, *y = data.x + REALS;
    double product = 0.0, exponent = 0.0;
    CHECK_OK(stats_emulator_make(STATS_SMOOTH, &in, data.variance, 0.8, &e));
    const double constant = e.constant * e.constant, main = exp(2.0 * e.hyper[STATS_HYPER_MAIN]),
                 amplitude = exp(2.0 * e.hyper[STATS_HYPER_KERNEL]);
    data.level[0] = data.level[FACTORS] = 2;
    data.level[1] = 0, data.level[FACTORS + 1] = 1;
    for (size_t p = 0; p < REALS; p++) {
        e.hyper[STATS_HYPERS + p] = log(0.5 + (double)p);
        product += x[p] * y[p];
        exponent += 0.5 * pow((x[p] - y[p]) / (0.5 + (double)p), 2.0);
    }
    e.hyper[STATS_HYPERS + REALS + 1] = log(0.7);
    CHECK_NEAR(stats_emulator_kernel(&e, &in, 0, &in, 1, false),
               constant + main * (product + 1.0) + amplitude * exp(-exponent - 0.7), 1e-12);
    CHECK_NEAR(stats_emulator_kernel(&e, &in, 0, &in, 1, true) -
                   stats_emulator_kernel(&e, &in, 0, &in, 1, false),
               exp(2.0 * e.hyper[STATS_HYPER_DEVIATION]), 1e-12);
    stats_emulator_free(&e);
    CHECK_OK(stats_emulator_make(STATS_QUADRATIC, &in, data.variance, 0.8, &e));
    CHECK_NEAR(stats_emulator_kernel(&e, &in, 0, &in, 1, false),
               e.constant * e.constant + exp(2.0 * e.hyper[STATS_HYPER_MAIN]) * (product + 1.0) +
                   exp(2.0 * e.hyper[STATS_HYPER_KERNEL]) * pow(product + 1.0, 2.0),
               1e-12);
    stats_emulator_free(&e);
}

/* A kernel of factors alone, over all combinations of three and two levels, has a Cholesky factor. */
static void test_factors_are_positive(void)
{
    static const int level[] = {0, 0, 0, 1, 1, 0, 1, 1, 2, 0, 2, 1};
    double variance[6];
    const stats_inputs in = {6, 0, 2, NULL, level};
    for (size_t i = 0; i < 6; i++) variance[i] = 1e-9;
    for (int k = 0; k < 4; k++) {
        stats_emulator e;
        CHECK_OK(stats_emulator_make(STATS_SMOOTH, &in, variance, 1.0, &e));
        e.hyper[STATS_HYPER_DEVIATION] = log(1e-6);
        e.hyper[STATS_HYPERS] = log(pow(10.0, -k));
        e.hyper[STATS_HYPERS + 1] = log(pow(10.0, k - 2));
        CHECK_OK(stats_emulator_factorise(&e));
        for (size_t i = 0; i < 6; i++) CU_ASSERT(gsl_matrix_get(e.factor, i, i) > 0.0);
        stats_emulator_free(&e);
    }
}

/* Derivatives of the evidence against differences over 2e-4, whose error is of the order of 1e-8 times the
 * third derivative. The evidence itself against the density of a normal vector of one value. */
static void test_evidence(void)
{
    const double h = 1e-4;
    for (stats_kernel kernel = 0; kernel < STATS_KERNELS; kernel++) {
        const stats_inputs in = make_inputs(N, 3);
        double gradient[STATS_HYPERS + REALS + FACTORS], up, down, unused;
        stats_emulator e;
        CHECK_OK(stats_emulator_make(kernel, &in, data.variance, 0.8, &e));
        CHECK_OK(stats_emulator_evidence(&e, data.y, &unused, gradient));
        for (size_t p = 0; p < e.n_hyper; p++) {
            const double at = e.hyper[p];
            e.hyper[p] = at + h;
            CHECK_OK(stats_emulator_evidence(&e, data.y, &up, NULL));
            e.hyper[p] = at - h;
            CHECK_OK(stats_emulator_evidence(&e, data.y, &down, NULL));
            e.hyper[p] = at;
            CHECK_NEAR(gradient[p], (up - down) / (2.0 * h), 1e-5 * (1.0 + fabs(gradient[p])));
        }
        stats_emulator_free(&e);
        const stats_inputs one = make_inputs(1, 3);
        CHECK_OK(stats_emulator_make(kernel, &one, data.variance, 0.8, &e));
        CHECK_OK(stats_emulator_evidence(&e, data.y, &up, NULL));
        const double v = stats_emulator_kernel(&e, &one, 0, &one, 0, true) + data.variance[0];
        CHECK_NEAR(up, -0.5 * (data.y[0] * data.y[0] / v + log(2.0 * M_PI * v)), 1e-12);
        stats_emulator_free(&e);
    }
}

/* The formula for groups that are left out against emulators without them. */
static void test_leave_out(void)
{
    for (stats_kernel kernel = 0; kernel < STATS_KERNELS; kernel++) {
        const stats_inputs in = make_inputs(N, 4);
        double mean[N], variance[N], score, w[N], m[GROUP], c[GROUP * GROUP], sum = 0.0;
        stats_emulator e;
        CHECK_OK(stats_emulator_make(kernel, &in, data.variance, 0.8, &e));
        CHECK_OK(stats_emulator_factorise(&e));
        CHECK_OK(stats_emulator_leave_out(&e, data.y, data.group, mean, variance, &score));
        stats_emulator_free(&e);
        for (size_t g = 0; g < N; g += GROUP) {
            make_inputs(N, 4);
            double x[GROUP * REALS], noise[GROUP], y[GROUP];
            int level[GROUP * FACTORS];
            memcpy(x, data.x + g * REALS, sizeof x);
            memcpy(level, data.level + g * FACTORS, sizeof level);
            memcpy(noise, data.variance + g, sizeof noise);
            memcpy(y, data.y + g, sizeof y);
            const size_t rest = N - GROUP - g;
            memmove(data.x + g * REALS, data.x + (g + GROUP) * REALS, rest * REALS * sizeof *x);
            memmove(data.level + g * FACTORS, data.level + (g + GROUP) * FACTORS,
                    rest * FACTORS * sizeof *level);
            memmove(data.variance + g, data.variance + g + GROUP, rest * sizeof *noise);
            memmove(data.y + g, data.y + g + GROUP, rest * sizeof *y);
            const stats_inputs others = {N - GROUP, REALS, FACTORS, data.x, data.level},
                               own = {GROUP, REALS, FACTORS, x, level};
            CHECK_OK(stats_emulator_make(kernel, &others, data.variance, 0.8, &e));
            CHECK_OK(stats_emulator_factorise(&e));
            stats_emulator_weights(&e, data.y, w);
            CHECK_OK(stats_emulator_predict(&e, &own, 1, w, m, c));
            gsl_matrix_view block = gsl_matrix_view_array(c, GROUP, GROUP);
            for (size_t i = 0; i < GROUP; i++) {
                c[i * GROUP + i] += noise[i];
                CHECK_NEAR(mean[g + i], m[i], 1e-8);
                CHECK_NEAR(variance[g + i], c[i * GROUP + i], 1e-8);
            }
            gsl_linalg_cholesky_decomp1(&block.matrix);
            gsl_vector *r = gsl_vector_alloc(GROUP), *s = gsl_vector_alloc(GROUP);
            for (size_t i = 0; i < GROUP; i++) {
                gsl_vector_set(r, i, y[i] - m[i]);
                sum -= 0.5 * log(2.0 * M_PI) + log(gsl_matrix_get(&block.matrix, i, i));
            }
            gsl_linalg_cholesky_solve(&block.matrix, r, s);
            for (size_t i = 0; i < GROUP; i++) sum -= 0.5 * gsl_vector_get(r, i) * gsl_vector_get(s, i);
            gsl_vector_free(r);
            gsl_vector_free(s);
            stats_emulator_free(&e);
        }
        CHECK_NEAR(score, sum, 1e-6);
    }
}

/* Where an emulator of values with a standard deviation of 0.8 starts, of five inputs, three of them numbers.
 * A fit ends where the evidence falls as fast as the log-normal prior about the start rises, whose width
 * is 1. */
static void test_start(void)
{
    for (stats_kernel kernel = 0; kernel < STATS_KERNELS; kernel++) {
        const stats_inputs in = make_inputs(N, 9);
        const bool smooth = kernel == STATS_SMOOTH;
        const double start[] = {log(0.4 / sqrt(5.0)),
                                smooth ? log(0.56) : log(0.08),
                                log(0.16),
                                log(2.0),
                                log(2.0),
                                log(2.0),
                                log(0.3),
                                log(0.3)};
        double gradient[STATS_HYPERS + REALS + FACTORS], evidence, moved = 0.0;
        stats_emulator e;
        CHECK_OK(stats_emulator_make(kernel, &in, data.variance, 0.8, &e));
        CU_ASSERT(e.n_hyper == (smooth ? 8 : 3));
        CHECK_NEAR(e.constant, 8.0, 1e-14);
        for (size_t p = 0; p < e.n_hyper; p++) CHECK_NEAR(e.hyper[p], start[p], 1e-14);
        CHECK_OK(stats_emulator_fit(&e, data.y, N));
        CHECK_OK(stats_emulator_evidence(&e, data.y, &evidence, gradient));
        for (size_t p = 0; p < e.n_hyper; p++) {
            CHECK_NEAR(gradient[p], e.hyper[p] - start[p],
                       0.1); /* the search ends within 1e-3 of the maximum */
            moved = fmax(moved, fabs(e.hyper[p] - start[p]));
        }
        CU_ASSERT(moved > 0.5 && moved < 4.0);
        stats_emulator_free(&e);
    }
}

/* A fit raises the evidence, finds the input that does nothing, and predicts: errors of what is left out are
 * little more than the noise, 0.22, of values that vary by 0.9. */
static void test_fit(void)
{
    const stats_inputs in = make_inputs(N, 5);
    double before, after, mean[N], variance[N], score, squares = 0.0;
    int covered = 0;
    stats_emulator e;
    CHECK_OK(stats_emulator_make(STATS_SMOOTH, &in, data.variance, 0.9, &e));
    CHECK_OK(stats_emulator_evidence(&e, data.y, &before, NULL));
    CHECK_OK(stats_emulator_fit(&e, data.y, N));
    CHECK_OK(stats_emulator_evidence(&e, data.y, &after, NULL));
    CU_ASSERT(after > before + 1.0);
    CU_ASSERT(e.hyper[STATS_HYPERS + 2] > e.hyper[STATS_HYPERS] + 0.5);
    CHECK_OK(stats_emulator_leave_out(&e, data.y, data.group, mean, variance, &score));
    for (size_t i = 0; i < N; i++) {
        squares += pow(data.y[i] - mean[i], 2.0);
        covered += fabs(data.y[i] - mean[i]) < 1.96 * sqrt(variance[i]);
    }
    CU_ASSERT(sqrt(squares / N) < 0.35);
    CU_ASSERT(covered >= 50); /* 57 expected, with a standard deviation of 1.7 */
    /* hyperparameters from a part of the settings, factor of all */
    CHECK_OK(stats_emulator_fit(&e, data.y, N / 2));
    double w[N], at_first, own;
    const stats_inputs first = {1, REALS, FACTORS, data.x, data.level};
    stats_emulator_weights(&e, data.y, w);
    CHECK_OK(stats_emulator_predict(&e, &first, 1, w, &at_first, &own));
    CHECK_NEAR(at_first, data.y[0], 0.8); /* four standard deviations of the noise */
    stats_emulator_free(&e);
}

/* Each kernel predicts its own kind of function better than the other does. */
static void test_better_kernel(void)
{
    for (int wave = 0; wave < 2; wave++) {
        const stats_inputs in = make_inputs(N, 6);
        double mean[N], variance[N], score[STATS_KERNELS];
        for (size_t i = 0; i < N; i++) {
            const double *x = data.x + i * REALS;
            data.variance[i] = 1e-4;
            data.y[i] = wave ? sin(6.0 * x[0])
                             : x[0] * x[1] + 0.8 * x[2] * (data.level[i * FACTORS] == 1) - x[1] * x[1];
        }
        for (stats_kernel kernel = 0; kernel < STATS_KERNELS; kernel++) {
            stats_emulator e;
            CHECK_OK(stats_emulator_make(kernel, &in, data.variance, 0.6, &e));
            CHECK_OK(stats_emulator_fit(&e, data.y, N));
            CHECK_OK(stats_emulator_leave_out(&e, data.y, data.group, mean, variance, &score[kernel]));
            stats_emulator_free(&e);
        }
        CU_ASSERT((score[STATS_SMOOTH] > score[STATS_QUADRATIC]) == (wave == 1));
    }
}

static void test_errors(void)
{
    stats_emulator e;
    stats_inputs in = make_inputs(0, 7);
    CHECK_FAILS(stats_emulator_make(STATS_SMOOTH, &in, data.variance, 1.0, &e), RP_BAD_INPUT, "no settings");
    in = make_inputs(2, 7);
    in.n_reals = STATS_MAX_INPUTS;
    CHECK_FAILS(stats_emulator_make(STATS_SMOOTH, &in, data.variance, 1.0, &e), RP_BAD_INPUT, "42 inputs");
    in = make_inputs(2, 7);
    CHECK_FAILS(stats_emulator_make(STATS_SMOOTH, &in, data.variance, 0.0, &e), RP_BAD_INPUT, "no spread");
    data.x[REALS] = NAN;
    CHECK_FAILS(stats_emulator_make(STATS_SMOOTH, &in, data.variance, 1.0, &e), RP_BAD_INPUT,
                "setting 2: input = nan");
    in = make_inputs(2, 7);
    data.variance[0] = INFINITY;
    CHECK_FAILS(stats_emulator_make(STATS_SMOOTH, &in, data.variance, 1.0, &e), RP_BAD_INPUT,
                "setting 1: variance of the noise = inf");
    data.x[0] = INFINITY;
    CHECK_FAILS(stats_emulator_make(STATS_SMOOTH, &in, data.variance, 1.0, &e), RP_BAD_INPUT,
                "setting 1: input = inf");
    in = make_inputs(2, 7);
    data.x[2 * REALS - 1] = NAN;
    CHECK_FAILS(stats_emulator_make(STATS_SMOOTH, &in, data.variance, 1.0, &e), RP_BAD_INPUT,
                "setting 2: input = nan");
    CHECK_FAILS(stats_emulator_make(STATS_SMOOTH, &in, data.variance, INFINITY, &e), RP_BAD_INPUT, "");
    in = make_inputs(2, 7);
    data.variance[1] = 0.0;
    CHECK_FAILS(stats_emulator_make(STATS_SMOOTH, &in, data.variance, 1.0, &e), RP_BAD_INPUT,
                "setting 2: variance of the noise = 0");
    /* twice the same setting without noise */
    memcpy(data.x + REALS, data.x, REALS * sizeof *data.x);
    memcpy(data.level + FACTORS, data.level, FACTORS * sizeof *data.level);
    data.variance[0] = data.variance[1] = 1e-300;
    CHECK_OK(stats_emulator_make(STATS_SMOOTH, &in, data.variance, 1.0, &e));
    e.hyper[STATS_HYPER_DEVIATION] = -100.0;
    CHECK_FAILS(stats_emulator_factorise(&e), RP_BROKEN, "not positive definite");
    double unused;
    CHECK_FAILS(stats_emulator_evidence(&e, data.y, &unused, NULL), RP_BROKEN, "not positive definite");
    CHECK_FAILS(stats_emulator_fit(&e, data.y, 2), RP_BROKEN, "not positive definite");
    stats_emulator_free(&e);
}

void suite_emulator(void)
{
    static const check_case cases[] = {
        {"posterior of one and of two values", test_closed_form},
        {"several sets of values at several settings", test_sets},
        {"kernels", test_kernels},
        {"kernels of factors are positive definite", test_factors_are_positive},
        {"evidence and its derivatives", test_evidence},
        {"a group left out, against an emulator without it", test_leave_out},
        {"start of a fit, and its end", test_start},
        {"fit", test_fit},
        {"the better kernel", test_better_kernel},
        {"errors of emulators", test_errors},
        {NULL, NULL},
    };
    check_register("emulator", cases);
}
