/* Trends and their absence: closed forms, GSL's fits, and planted cases. */
#include <gsl/gsl_cdf.h>
#include <gsl/gsl_fit.h>
#include <gsl/gsl_randist.h>

#include "stats/stats.h"
#include "tests/check.h"
#include "tests/numbers.h"

/* sums of some 30 terms of order 1 to 10, with cancellation */
static const double sum_error = 1e-12;
/* a share of planted cases against its expectation: 4 of its standard errors; seeds are fixed */
static const double sigmas = 4.0;

static double share_error(double share, int cases)
{
    return sigmas * sqrt(share * (1.0 - share) / cases);
}

/* With a margin of 1. */
static rp_status trend_of(size_t n, const double x[], const double y[], const double pile[], double power,
                          stats_trend *trend)
{
    return stats_trend_fit(&(stats_sample){n, x, y, pile, power, false, 1.0}, trend);
}

enum { N = 11 };
static const double xs[N] = {1.5, 2.385, 2.5, 3.1, 3.485, 4.0, 4.77, 5.1, 6.2, 7.31, 8.0};
static const double ys[N] = {19.2, 18.7, 20.1, 17.3, 18.85, 16.2, 17.77, 17.0, 15.1, 16.4, 15.9};

/* One value per x: straight line and parabola of the textbook, without weights, with those of known errors
 * and with x^2; and the line in log10 x with the weights of x itself. */
static void test_single_values(void)
{
    double lines[2 * N], log_lines[2 * N], logs[N], parabolas[3 * N], weights[N], c[3], cov[9];
    stats_trend t;
    for (size_t i = 0; i < N; i++) {
        logs[i] = log10(xs[i]);
        for (size_t k = 0; k < 2; k++) lines[2 * i + k] = pow(xs[i], (double)k);
        for (size_t k = 0; k < 2; k++) log_lines[2 * i + k] = pow(logs[i], (double)k);
        for (size_t k = 0; k < 3; k++) parabolas[3 * i + k] = pow(xs[i], (double)k);
        weights[i] = xs[i] * xs[i];
    }
    CHECK_OK(trend_of(N, xs, ys, NULL, 0.0, &t));
    numbers_fit(N, 2, lines, NULL, ys, c, cov);
    CHECK_PAIRS(sum_error, {t.slope.value, c[1]}, {t.slope.se, sqrt(cov[3])}, {t.intercept.value, c[0]},
                {t.intercept.se, sqrt(cov[0])},
                {stats_contrast_p(&t.change), 2.0 * gsl_cdf_tdist_P(c[1] / sqrt(cov[3]), N - 2.0)});
    CHECK_NEAR(t.slope.dof, N - 2.0, 0.0);
    CHECK_NEAR(t.change.value, 6.5 * c[1], 10.0 * sum_error);
    numbers_fit(N, 3, parabolas, NULL, ys, c, cov);
    CHECK_NEAR(t.bend.value, c[2], sum_error);
    for (int log10_x = 0; log10_x < 2; log10_x++) {
        CHECK_OK(stats_trend_fit(&(stats_sample){N, log10_x ? logs : xs, ys, NULL, 2.0, log10_x, 1.0}, &t));
        numbers_fit(N, 2, log10_x ? log_lines : lines, weights, ys, c, cov);
        CHECK_PAIRS(sum_error, {t.slope.value, c[1]}, {t.intercept.value, c[0]});
        numbers_fit(N, 3, parabolas, weights, ys, c, cov);
        if (!log10_x) CHECK_NEAR(t.bend.value, c[2], sum_error);
    }
}

/* Two x: Welch's test, and the paired one. The order of the values does not matter. */
static void test_two_x(void)
{
    const double x[] = {4, 2, 4, 2, 2, 4, 2}, y[] = {18.1, 17.2, 19.9, 16.1, 18.4, 18.8, 19.3};
    const double pile[] = {0, 2, 7, 7, 0, 2, 5}; /* 5 has no value at x = 4 */
    const double low[] = {17.2, 16.1, 18.4, 19.3}, high[] = {18.1, 19.9, 18.8};
    const double low_paired[] = {18.4, 17.2, 16.1}, high_paired[] = {18.1, 18.8, 19.9};
    stats_trend t;
    stats_summary a, b, d;
    CHECK_OK(trend_of(7, x, y, NULL, 0.0, &t));
    CHECK_OK(stats_mean(4, low, &a));
    CHECK_OK(stats_mean(3, high, &b));
    const double va = a.se * a.se, vb = b.se * b.se;
    CHECK_PAIRS(sum_error, {t.change.value, b.mean - a.mean}, {t.change.se, sqrt(va + vb)},
                {t.intercept.value, a.mean - 2.0 * t.slope.value}, {t.pair.value, t.change.value},
                {t.p_pairs, t.p_margin});
    CHECK_NEAR(t.change.dof, (va + vb) * (va + vb) / (va * va / 3.0 + vb * vb / 2.0), 1e2 * sum_error);
    CU_ASSERT(t.n == 7 && t.n_x == 2 && t.from == 2.0 && t.to == 4.0 && isnan(t.bend.value));
    CHECK_OK(trend_of(7, x, y, pile, 0.0, &t));
    CHECK_OK(stats_paired(3, high_paired, -1.0, low_paired, &d));
    double lo, hi;
    stats_contrast_interval(&t.change, 0.95, &lo, &hi);
    CHECK_PAIRS(sum_error, {t.change.value, d.mean}, {t.change.se, d.se}, {lo, d.lo}, {hi, d.hi});
    CHECK_NEAR(t.change.dof, 2.0, 0.0);
    CU_ASSERT(t.n == 6);
}

/* Rows in another order have the same bits, paired or not. */
static void test_order_of_rows(void)
{
    enum { ROWS = 24 };
    size_t order[ROWS];
    stats_trend first, t;
    scoped_rng *rng = numbers_of(5, 0);
    double value[ROWS];
    for (size_t i = 0; i < ROWS; i++) order[i] = i, value[i] = gsl_ran_gaussian(rng, 3.0);
    for (int k = 0; k < 60; k++) {
        double x[ROWS], y[ROWS], pile[ROWS];
        for (size_t i = 0; i < ROWS; i++)
            x[i] = 1.0 + (double)(order[i] % 3), y[i] = value[order[i]], pile[i] = (double)(order[i] / 3);
        if (k % 30 == 0) CHECK_OK(trend_of(ROWS, x, y, k < 30 ? NULL : pile, 0.0, &first));
        CHECK_OK(trend_of(ROWS, x, y, k < 30 ? NULL : pile, 0.0, &t));
        CU_ASSERT(t.slope.value == first.slope.value && t.slope.se == first.slope.se && t.n == first.n);
        CU_ASSERT(t.bend.value == first.bend.value && t.pair.value == first.pair.value &&
                  t.p_pairs == first.p_pairs);
        gsl_ran_shuffle(rng, order, ROWS, sizeof *order);
    }
}

/* Units change no verdict, however large. */
static void test_units(void)
{
    const double x[] = {1, 1, 2, 2, 3, 3}, y[] = {1, 2, 2, 3, 3, 5};
    stats_trend one, t;
    CHECK_OK(trend_of(6, x, y, NULL, 0.0, &one));
    for (double unit = 1e-300; unit < 1e301; unit *= 1e150)
        for (int which = 0; which < 2; which++) {
            double scaled[6];
            for (int i = 0; i < 6; i++) scaled[i] = (which ? y : x)[i] * unit;
            CHECK_OK(trend_of(6, which ? x : scaled, which ? scaled : y, NULL, 0.0, &t));
            CHECK_NEAR(t.change.value / (which ? unit : 1.0), one.change.value, sum_error);
            CHECK_PAIRS(sum_error, {t.change.dof, one.change.dof},
                        {stats_contrast_p(&t.change), stats_contrast_p(&one.change)});
            CU_ASSERT(isnan(t.bend.se) || t.bend.se > 0.0);
        }
    CHECK_FAILS(trend_of(6, (double[]){1e-100, 1e-100, 2e-100, 2e-100, 3e-100, 3e-100}, y, NULL, -10.0, &t),
                RP_NO_RESULT, "weights x^-10 overflow");
}

/* TOST is equivalent to the 90 % interval. */
static void test_tost_is_interval(void)
{
    for (double value = -2.1; value < 2.1; value += 0.0385)
        for (double dof = 2.0; dof < 40.0; dof += 7.1) {
            const stats_contrast c = {value, 0.385, dof};
            double lo, hi;
            stats_contrast_interval(&c, 0.9, &lo, &hi);
            CU_ASSERT((stats_contrast_p_margin(&c, 1.0) < 0.05) == (lo > -1.0 && hi < 1.0));
            stats_contrast_interval(&c, 0.95, &lo, &hi);
            CU_ASSERT((stats_contrast_p(&c) < 0.05) == (lo > 0.0 || hi < 0.0));
        }
    const stats_contrast none = {0.0, 0.0, 3.0}, certain = {-1.2, 0.0, 3.0}; /* no scatter at all */
    CHECK_PAIRS(0.0, {stats_contrast_p(&none), 1.0}, {stats_contrast_p_margin(&none, 1.0), 0.0},
                {stats_contrast_p(&certain), 0.0}, {stats_contrast_p_margin(&certain, 1.0), 1.0});
}

enum { X = 4, PILES = 7, CASES = 1000 };
enum { BY_X, SINGLE, PAIRED, WEIGHTED, N_KINDS };

/* One planted set: a straight line of the given change over 2..8, scatter that triples from the least to the
 * largest x (SINGLE: it is the same), and, PAIRED, piles that differ far more. `hump` is added at x = 4. */
static void plant(gsl_rng *rng, int kind, double change, double hump, stats_trend *t)
{
    double x[X * PILES], y[X * PILES], pile[X * PILES];
    const size_t piles = kind == SINGLE ? 2 : PILES;
    size_t n = 0;
    for (size_t k = 0; k < piles; k++) {
        const double offset = kind == PAIRED ? 20.0 * gsl_ran_ugaussian(rng) : 0.0;
        for (size_t j = 0; j < X; j++, n++) {
            x[n] = 2.0 + 2.0 * (double)j + (kind == SINGLE && k == 1 ? 0.01 * (double)(j % 3) : 0.0);
            y[n] = 18.0 + change * (x[n] - 2.0) / 6.0 + (j == 1 ? hump : 0.0) + offset +
                   (kind == SINGLE ? 0.385 : 0.3 * x[n] - 0.3) * gsl_ran_ugaussian(rng);
            pile[n] = (double)k;
        }
    }
    CHECK_OK(trend_of(n, x, y, kind == PAIRED ? pile : NULL, kind == WEIGHTED ? -2.0 : 0.0, t));
}

static void test_coverage(void)
{
    scoped_rng *rng = numbers_of(11, 0);
    for (int kind = 0; kind < N_KINDS; kind++) {
        int covered[2] = {0, 0}, found = 0;
        for (int i = 0; i < CASES; i++) {
            stats_trend t;
            double lo, hi;
            plant(rng, kind, 1.385, 0.0, &t);
            stats_contrast_interval(&t.change, 0.95, &lo, &hi);
            covered[0] += lo <= 1.385 * (t.to - t.from) / 6.0 && hi >= 1.385 * (t.to - t.from) / 6.0;
            stats_contrast_interval(&t.intercept, 0.95, &lo, &hi);
            covered[1] += lo <= 18.0 - 1.385 / 3.0 && hi >= 18.0 - 1.385 / 3.0;
            plant(rng, kind, 0.0, 0.0, &t);
            found += stats_contrast_p(&t.change) < 0.05;
        }
        /* PAIRED: the intercept is known through the piles' offsets only, but covered as well */
        CHECK_NEAR((double)covered[0] / CASES, 0.95, share_error(0.95, CASES));
        CHECK_NEAR((double)covered[1] / CASES, 0.95, share_error(0.95, CASES));
        CHECK_NEAR((double)found / CASES, 0.05, share_error(0.05, CASES));
    }
}

/* The result is the largest difference of all pairs, with the sign for increasing x. */
static void test_pairs(void)
{
    const double x[] = {2, 2, 4, 4, 6, 6}, y[] = {18.0, 18.2, 16.6, 16.8, 17.6, 17.8};
    stats_trend t;
    CHECK_OK(trend_of(6, x, y, NULL, 0.0, &t));
    CHECK_PAIRS(sum_error, {t.pair.value, -1.4}, {t.pair.se, sqrt(0.02)},
                {t.p_pairs, stats_contrast_p_margin(&t.pair, 1.0)});
    CU_ASSERT(t.p_pairs > 0.9 && t.p_margin < 0.05);
}

/* At the margin TOST says "no dependence" in no more than 5 % of the cases, with a trend as with a hump. */
static void test_tost_size(void)
{
    scoped_rng *rng = numbers_of(12, 0);
    for (int kind = 0; kind < N_KINDS; kind += PAIRED) {
        int trend = 0, pairs = 0, flat = 0;
        for (int i = 0; i < CASES; i++) {
            stats_trend t;
            plant(rng, kind, i % 2 ? 1.0 : -1.0, 0.0, &t);
            trend += t.p_margin < 0.05;
            plant(rng, kind, 0.0, 1.0, &t);
            pairs += t.p_pairs < 0.05;
            plant(rng, kind, 0.0, 0.0, &t);
            flat += t.p_margin < 0.05;
        }
        CU_ASSERT(trend <= CASES * (0.05 + share_error(0.05, CASES)));
        CU_ASSERT(pairs <= CASES * (0.05 + share_error(0.05, CASES)) && flat > trend);
    }
}

static void test_holm(void)
{
    static const struct {
        size_t n;
        double p[5], corrected[5];
    } cases[] = {{5, {0.01, 0.04, NAN, 0.03, 0.005}, {0.03, 0.06, NAN, 0.06, 0.02}},
                 {3, {0.02, 0.02, 0.9}, {0.06, 0.06, 0.9}},
                 {3, {0.6, 0.4, 0.8}, {1.0, 1.0, 1.0}}}; /* chances end at 1 */
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        double found[5];
        stats_holm(cases[k].n, cases[k].p, found);
        for (size_t i = 0; i < cases[k].n; i++) {
            const double expected = cases[k].corrected[i];
            CU_ASSERT(isnan(expected) ? isnan(found[i]) : fabs(found[i] - expected) <= sum_error);
        }
    }
}

static void test_words(void)
{
    static const struct {
        double change, p, p_margin;
        const char *word;
    } cases[] = {{-3.0, 0.01, 0.9, "falls"},
                 {3.0, 0.01, 0.9, "rises"},
                 {-0.3, 0.01, 0.01, "falls_within_margin"},
                 {0.3, 0.01, 0.01, "rises_within_margin"},
                 {0.1, 0.4, 0.01, "no_dependence_within_margin"},
                 {0.1, 0.4, 0.2, "undecided"}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const stats_trend t = {.change = {cases[i].change, 1.0, 9.0}, .p_margin = cases[i].p_margin};
        CU_ASSERT_STRING_EQUAL(stats_trend_word(&t, cases[i].p, 0.05), cases[i].word);
    }
}

static void test_trend_errors(void)
{
    const double twice[] = {2, 2, 4, 4}, same[] = {2, 2, 2, 2}, y[] = {1, 2, 3, 4.5}, piles[] = {0, 1, 0, 1};
    const double repeated[] = {0, 0, 0, 1}, apart[] = {0, 1, 2, 3}, bad[] = {1, INFINITY, 3, 4};
    stats_trend t;
    CHECK_FAILS(trend_of(0, twice, y, NULL, 0.0, &t), RP_NO_RESULT, "0 values");
    CHECK_FAILS(trend_of(0, twice, y, piles, 0.0, &t), RP_NO_RESULT, "0 values");
    CHECK_FAILS(trend_of(2, xs, y, NULL, 0.0, &t), RP_NO_RESULT, "2 values");
    CU_ASSERT(isnan(t.slope.value) && isnan(t.p_margin) && isnan(t.p_pairs));
    CHECK_FAILS(trend_of(4, same, y, NULL, 0.0, &t), RP_NO_RESULT, "1 different x");
    CHECK_FAILS(trend_of(4, twice, bad, NULL, 0.0, &t), RP_BAD_INPUT, "value 2: (2, inf) of pile 0");
    CHECK_FAILS(trend_of(4, bad, y, NULL, 0.0, &t), RP_BAD_INPUT, "value 2: (inf, 2) of pile 0");
    CHECK_FAILS(trend_of(4, twice, y, bad, 0.0, &t), RP_BAD_INPUT, "value 2: (2, 2) of pile inf");
    CHECK_FAILS(trend_of(4, twice, y, repeated, 0.0, &t), RP_BAD_INPUT, "pile 0: two values at x = 2");
    CHECK_FAILS(trend_of(4, twice, y, apart, 0.0, &t), RP_NO_RESULT, "0 values of whole piles");
    CHECK_FAILS(stats_trend_fit(&(stats_sample){.n = 4, .x = twice, .y = y}, &t), RP_BAD_INPUT, "margin = 0");
    CHECK_FAILS(stats_trend_fit(&(stats_sample){.n = 4, .x = twice, .y = y, .margin = NAN}, &t), RP_BAD_INPUT,
                "margin = ");
    CHECK_FAILS(trend_of(4, apart, y, NULL, 2.0, &t), RP_BAD_INPUT, "value 1: x = 0");
    CHECK_FAILS(trend_of(4, apart, y, NULL, 1.0, &t), RP_BAD_INPUT, "value 1: x = 0");
    CHECK_OK(trend_of(4, apart, y, NULL, 0.0, &t)); /* without weights any x will do */
    CHECK_OK(stats_trend_fit(&(stats_sample){4, apart, y, NULL, 2.0, true, 1.0},
                             &t)); /* nor with weights of 10^x */
    CHECK_OK(trend_of(4, twice, y, piles, 0.0, &t));
}

/* ---- settings compared ---- */

/* Against the line by GSL: the slope over the spreads. */
static void test_correlation(void)
{
    enum { COUNT = 9 };
    const double x[COUNT] = {0.3, 1.1, 1.9, 2.2, 3.7, 4.1, 5.6, 6.2, 7.9},
                 y[COUNT] = {1.2, 0.7, 2.9, 2.1, 4.4, 3.2, 5.1, 6.6, 6.9};
    double c0, c1, v[4];
    stats_summary of_x, of_y;
    stats_correlation c;
    gsl_fit_linear(x, 1, y, 1, COUNT, &c0, &c1, &v[0], &v[1], &v[2], &v[3]);
    CHECK_OK(stats_mean(COUNT, x, &of_x));
    CHECK_OK(stats_mean(COUNT, y, &of_y));
    CHECK_OK(stats_correlate(COUNT, x, y, &c));
    CU_ASSERT(c.n == COUNT);
    CHECK_NEAR(c.value, c1 * of_x.sd / of_y.sd, sum_error);
    CHECK_NEAR(c.se, (1.0 - c.value * c.value) / sqrt(COUNT - 1.0), sum_error);
    const double z = atanh(c.value), z_off = 1.959963984540054 / sqrt(COUNT - 3.0);
    CHECK_PAIRS(1e-12, {atanh(c.lo), z - z_off}, {atanh(c.hi), z + z_off});
    CHECK_OK(stats_correlate(4, x, y, &c)); /* the fewest */
    CHECK_OK(stats_correlate(4, (double[]){1.0, 4.0, 5.0, 6.0}, (double[]){0.7, 2.8, 3.5, 6.0 * 0.7}, &c));
    CU_ASSERT(c.value <= 1.0 && c.lo > 0.99); /* a line, whatever the round-off */
    CHECK_FAILS(stats_correlate(3, x, y, &c), RP_NO_RESULT, "3 values");
    CHECK_FAILS(stats_correlate(4, (double[]){1e200, 3e200, 2e200, 5e200}, y, &c), RP_NO_RESULT, "overflow");
    CHECK_FAILS(stats_correlate(4, (double[]){1e-200, 3e-200, 2e-200, 5e-200}, y, &c), RP_NO_RESULT,
                "overflow");
    CU_ASSERT(isnan(c.value) && isnan(c.se) && isnan(c.lo) && isnan(c.hi));
    CHECK_FAILS(stats_correlate(4, (double[]){1.0, NAN, 2.0, 3.0}, y, &c), RP_BAD_INPUT, "value 2");
    CHECK_FAILS(stats_correlate(4, x, (double[]){1.0, 2.0, NAN, 3.0}, &c), RP_BAD_INPUT, "value 3");
    double found[4], covariance[16];
    stats_linear fit = {
        .n = 1, .p = 2, .X = x, .y = y, .tolerance = 1e-12, .c = found, .covariance = covariance};
    CHECK_FAILS(stats_linear_fit(&fit), RP_BAD_INPUT, "1 values, 2 columns");
    fit.n = 4, fit.X = (double[]){1.0, 1.0, 1.0, 2.0, 1.0, NAN, 1.0, 3.0};
    CHECK_FAILS(stats_linear_fit(&fit), RP_BAD_INPUT, "value 6");
    fit.X = x, fit.tolerance = 0.0;
    CHECK_FAILS(stats_linear_fit(&fit), RP_BAD_INPUT, "tolerance 0");
}

/* Planted: y = x + noise of the same spread has a correlation of 1/sqrt 2, which intervals of 95 % hold in as
 * many of the cases, within 4 standard errors of a share, sqrt(0.95 0.05/300) = 0.0126. The error is that of
 * the values over the cases, known to 1/sqrt(2 300) = 4 %. */
static void test_planted_correlation(void)
{
    enum { COUNT = 150, ENSEMBLES = 300 };
    scoped_rng *rng = numbers_of(1993, 13);
    double x[COUNT], y[COUNT], values[ENSEMBLES], held = 0.0, se = 0.0;
    stats_correlation c;
    stats_summary of;
    for (int k = 0; k < ENSEMBLES; k++) {
        for (size_t i = 0; i < COUNT; i++) {
            x[i] = gsl_ran_gaussian(rng, 1.0);
            y[i] = x[i] + gsl_ran_gaussian(rng, 1.0);
        }
        CHECK_OK(stats_correlate(COUNT, x, y, &c));
        held += c.lo < M_SQRT1_2 && M_SQRT1_2 < c.hi;
        se += c.se / ENSEMBLES;
        values[k] = c.value;
    }
    CHECK_OK(stats_mean(ENSEMBLES, values, &of));
    CHECK_NEAR(held / ENSEMBLES, 0.95, 0.05);
    CHECK_NEAR(se / of.sd, 1.0, 4.0 * 0.041);
}

/* Parts of a sample, put together by their summaries, have the summary of the whole. */
static void test_pooled(void)
{
    enum { COUNT = 9, PARTS = 3 };
    static const double v[COUNT] = {1.2, 0.7, 2.9, 2.1, 4.4, 3.2, -5.1, 6.6, 6.9};
    static const size_t first[PARTS + 1] = {0, 4, 5, COUNT}; /* the second one a single value */
    stats_summary parts[PARTS], whole;
    for (size_t k = 0; k < PARTS; k++) CHECK_OK(stats_mean(first[k + 1] - first[k], v + first[k], &parts[k]));
    for (size_t n = 1; n <= PARTS; n++) {
        const stats_summary all = stats_pooled(n, parts);
        CHECK_OK(stats_mean(first[n], v, &whole));
        CU_ASSERT(all.n == whole.n);
        CHECK_PAIRS(sum_error, {all.mean, whole.mean}, {all.sd, whole.sd}, {all.se, whole.se});
    }
    const stats_summary one = stats_pooled(1, &parts[1]);
    CU_ASSERT(one.n == 1 && one.mean == v[4] && isnan(one.sd) && isnan(one.se));
}

/* Two resamples with a result are the fewest that have a spread. */
static void test_resampled(void)
{
    double two[] = {5.0, NAN, 3.0}, one[] = {NAN, 5.0};
    size_t n;
    CHECK_NEAR(stats_resampled(3, two, &n), sqrt(2.0), sum_error);
    CU_ASSERT(n == 2 && isnan(stats_resampled(2, one, &n)) && n == 1);
}

CHECK_SUITE(trend, "trend", test_single_values, test_two_x, test_order_of_rows, test_units,
            test_tost_is_interval, test_coverage, test_pairs, test_tost_size, test_holm, test_words,
            test_trend_errors, test_correlation, test_planted_correlation, test_pooled, test_resampled)
