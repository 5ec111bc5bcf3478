/* Calibration against closed forms, and on piles drawn from known responses. */
#include <gsl/gsl_cdf.h>
#include <gsl/gsl_fit.h>
#include <gsl/gsl_poly.h>
#include <gsl/gsl_randist.h>
#include <gsl/gsl_sf_psi.h>
#include <gsl/gsl_sort.h>
#include <gsl/gsl_statistics_double.h>
#include <string.h>

#include "stats/stats.h"
#include "stats/calibrate.h"
#include "tests/check.h"
#include "tests/numbers.h"

/* accuracy of the search, relative to the range of the parameter */
static const double search_error = 1e-7;
/* chi2 of 95 % for one degree of freedom */
static const double chi2_95 = 3.841458820694124;
/* a count against its expectation: 4 of its standard errors; seeds are fixed */
static const double sigmas = 4.0;

enum { MAX_PILES = 400 };
static double data[STATS_MAX_PARAMS + STATS_MAX_ANGLES][MAX_PILES];
static stats_ensemble piles;

static void start(size_t n_params, size_t n_angles)
{
    piles = (stats_ensemble){.n_params = n_params, .n_angles = n_angles};
    for (size_t p = 0; p < STATS_MAX_PARAMS; p++) piles.x[p] = data[p];
    for (size_t a = 0; a < STATS_MAX_ANGLES; a++) piles.angle[a] = data[STATS_MAX_PARAMS + a];
}

static void add(double x, double y, double angle_a, double angle_b)
{
    size_t i = piles.n++;
    data[0][i] = x;
    data[1][i] = y;
    data[2][i] = angle_a;
    data[3][i] = angle_b;
}

/* Four piles at x whose mean is `angle` and whose scatter is the same at every x. */
static void add_four(double x, double y, double angle, double scatter)
{
    for (int k = 0; k < 4; k++)
        add(x, y, angle + (k % 2 ? scatter : -scatter), angle + (k / 2 ? scatter : -scatter));
}

/* n points from `first` on, a step apart, on the line a + b x. */
static void start_line(size_t n_angles, int n, double first, double step, double a, double b, double scatter)
{
    start(1, n_angles);
    for (int g = 0; g < n; g++) add_four(first + step * g, 0.0, a + b * (step * g), scatter);
}

static stats_measured measured(double a, double error_a, double b, double error_b)
{
    return (stats_measured){{a, b}, {error_a, error_b}};
}

/* The response of the piles, and the parameters that a measurement gives. */
static stats_calibration fitted;
static stats_calibrated found[STATS_MAX_PARAMS];

static void fit_piles(void)
{
    stats_calibration_free(&fitted);
    CHECK_OK(stats_calibration_fit(&piles, &fitted));
}

static void invert(stats_measured m)
{
    CHECK_OK(stats_calibration_invert(&fitted, &m, found));
}

static stats_calibrated_status invert_status(stats_measured m)
{
    fit_piles();
    invert(m);
    return found[0].status;
}

/* ---- closed forms ---- */

/* A straight line: the value by division, the error by the delta method, the interval by Fieller's theorem.
 */
static void test_line(void)
{
    const double a = 2.385, b = 41.7, z = 19.31, e = 0.83;
    double x[7], y[7], se[7], v;
    start(1, 1);
    for (int g = 0; g < 7; g++) {
        x[g] = 0.05 + 0.11 * g;
        y[g] = a + b * x[g];
        add_four(x[g], 0.0, y[g], 1.37);
    }
    fit_piles();
    CU_ASSERT(fitted.response[0].shape == STATS_POWERS && fitted.response[0].degree[0] == 1 &&
              fitted.response[0].monotone);
    for (int g = 0; g < 7; g++) se[g] = stats_calibration_sd(&fitted, 0, &x[g]) / 2.0;
    CHECK_NEAR(se[0], se[6], 1e-12);
    /* the scatter is unbiased in the logarithm: 1.37 sqrt(4/3) exp((log 1.5 - psi(1.5))/2) */
    CHECK_NEAR(se[3], 0.685 * sqrt(4.0 / 3.0) * exp(0.5 * (log(1.5) - 0.03648997397857652)), 1e-10);
    stats_line line;
    CHECK_OK(stats_line_fit(&(stats_xy){7, x, y, se}, false, &line));
    invert((stats_measured){{z}, {e}});
    double at = (z - a) / b, root[2];
    CHECK_NEAR(found[0].value, at, search_error);
    stats_response_value(&fitted.response[0], &at, &v);
    CHECK_NEAR(v, pow(line.intercept_se, 2) + 2.0 * at * line.covariance + pow(at * line.slope_se, 2), 1e-10);
    CHECK_NEAR(found[0].se, sqrt(e * e + v) / b, 1e-7);
    CU_ASSERT(gsl_poly_solve_quadratic(b * b - chi2_95 * pow(line.slope_se, 2),
                                       -2.0 * b * (z - a) - 2.0 * chi2_95 * line.covariance,
                                       pow(z - a, 2) - chi2_95 * (e * e + pow(line.intercept_se, 2)),
                                       &root[0], &root[1]) == 2);
    CU_ASSERT(found[0].status == STATS_CALIBRATED_OK && found[0].n_solutions == 1);
    CHECK_NEAR(found[0].solutions[0].lower, root[0], search_error);
    CHECK_NEAR(found[0].solutions[0].upper, root[1], search_error);
    /* 4000 resamples know a standard deviation to 1.1 % */
    scoped_rng *rng = numbers_of(1882, 0);
    CHECK_OK(stats_calibration_bootstrap(&piles, &fitted, &(stats_measured){{z}, {e}}, 4000, rng, found));
    /* the bootstrap knows each point's scatter, 1.37 sqrt(4/3), without the correction of the logarithm */
    double plain = v * pow(1.37 * sqrt(4.0 / 3.0) / (2.0 * se[3]), 2);
    CHECK_NEAR(found[0].boot_se / (sqrt(e * e + plain) / b), 1.0, sigmas * 0.0112);
    CHECK_NEAR((found[0].boot_upper - found[0].boot_lower) / (3.92 * found[0].boot_se), 1.0, 0.06);
}

/* Points that scatter about a line by more than their errors: the errors of the line grow, and the lack of
 * fit is added. */
static void test_lack_of_fit(void)
{
    const double e = 0.1;
    double x[8], y[8], se[8], v, at = 0.4385;
    start(1, 1);
    for (int g = 0; g < 8; g++) {
        x[g] = 0.1 * g;
        y[g] = 10.0 + 40.0 * x[g] + (g % 2 ? 1.0 : -1.0);
        add_four(x[g], 0.0, y[g], 1.0);
    }
    fit_piles();
    for (int g = 0; g < 8; g++) se[g] = stats_calibration_sd(&fitted, 0, &x[g]) / 2.0;
    stats_line line;
    CHECK_OK(stats_line_fit(&(stats_xy){8, x, y, se}, false, &line));
    CU_ASSERT(fitted.response[0].degree[0] == 1 && line.chi2 > 12.0);
    CHECK_NEAR(fitted.response[0].chi2, line.chi2, 1e-9 * line.chi2);
    CHECK_NEAR(fitted.response[0].aic, line.chi2 + 2.0 * 2.0, 1e-9 * line.chi2);
    CHECK_NEAR(fitted.response[0].p_value, gsl_cdf_chisq_Q(line.chi2, 6.0), 1e-9);
    double factor = line.chi2 / 6.0;
    stats_response_value(&fitted.response[0], &at, &v);
    double of_line = pow(line.intercept_se, 2) + 2.0 * at * line.covariance + pow(at * line.slope_se, 2);
    CHECK_NEAR(v, factor * of_line + (factor - 1.0) * se[0] * se[0], 1e-10);
    invert((stats_measured){{10.0 + 40.0 * at}, {e}});
    stats_response_value(&fitted.response[0], &found[0].value, &v);
    CHECK_NEAR(found[0].se, sqrt(e * e + v) / line.slope, 1e-7);
}

/* Two angles with correlated noise weigh less than two independent ones: for equal lines
 * and errors the variance is (1 + r)/2 of one angle's. */
static void test_correlated(void)
{
    const double e = 5.0; /* far above the error of the response */
    double se[2];
    for (int opposed = 0; opposed <= 1; opposed++) {
        start(1, 2);
        for (int g = 0; g < 6; g++)
            for (int k = 0; k < 4; k++) {
                double x = 0.1 * g, noise = k % 2 ? 0.1 : -0.1, other = k / 2 ? 0.1 : -0.1;
                /* correlation 0.6 or -0.6 */
                add(x, 0.0, 100.0 * x + noise, 100.0 * x + (opposed ? -0.6 : 0.6) * noise + 0.8 * other);
            }
        fit_piles();
        CHECK_NEAR(fitted.correlation, opposed ? -0.6 : 0.6, 1e-9);
        invert((stats_measured){{25.0, 25.0}, {e, e}});
        se[opposed] = found[0].se;
        /* of errors a and b, the best mean has the variance a^2 b^2 (1 - r^2)/(a^2 + b^2 - 2 r a b) */
        const double a = 5.0, b = 3.0, correlation = opposed ? -0.6 : 0.6;
        invert((stats_measured){{25.0, 25.0}, {a, b}});
        CHECK_NEAR(found[0].se, 0.8 * a * b / sqrt(a * a + b * b - 2.0 * correlation * a * b) / 100.0, 1e-4);
    }
    CHECK_NEAR(se[0], sqrt(0.8) * e / 100.0, 1e-4);
    CHECK_NEAR(se[1], sqrt(0.2) * e / 100.0, 1e-4);
}

/* Slopes of a fit at x by its parameters. */
typedef void slopes_at(const void *form, const double x[], double slopes[]);

/* Variance of the value at x of a fit of n parameters, through the normal equations of all points. */
static double variance_by_slopes(size_t n, slopes_at *slopes_of, const void *form, const double x[])
{
    double X[STATS_MAX_TERMS * MAX_PILES], w[MAX_PILES],
        y[MAX_PILES] = {0.0}, c[STATS_MAX_TERMS], slopes[STATS_MAX_TERMS],
        covariance[STATS_MAX_TERMS * STATS_MAX_TERMS], variance = 0.0;
    for (size_t g = 0; g < fitted.n_points; g++) {
        const stats_point *q = &fitted.point[g];
        w[g] = q->number[0] / pow(stats_calibration_sd(&fitted, 0, q->x), 2.0);
        slopes_of(form, q->x, X + g * n);
    }
    numbers_fit(fitted.n_points, n, X, w, y, c, covariance);
    slopes_of(form, x, slopes);
    for (size_t i = 0; i < n * n; i++) variance += slopes[i / n] * slopes[i % n] * covariance[i];
    return variance;
}

/* a + b f(x/scale). */
typedef struct {
    bool is_tanh;
    double b, scale;
} saturating;

static void slopes_of_saturating(const void *form, const double x[], double slopes[])
{
    const saturating *s = form;
    const double f = s->is_tanh ? tanh(*x / s->scale) : exp(-*x / s->scale);
    slopes[0] = 1.0;
    slopes[1] = f;
    slopes[2] = s->b * (s->is_tanh ? f * f - 1.0 : f) * *x / (s->scale * s->scale);
}

/* Saturating responses, inverted by logarithm and area tangent; the parameter in two units. */
static void test_saturating(void)
{
    const double z = 24.9;
    for (int i = 0; i < 4; i++) {
        const int shape = i % 2 ? STATS_TANH : STATS_EXPONENTIAL;
        const double unit = i / 2 ? 40.0 : 1.0, scale = 0.2713 * unit;
        start(1, 1);
        for (int g = 0; g < 10; g++) {
            double x = (0.05 + 0.08 * g) * unit,
                   s = shape == STATS_TANH ? tanh(x / scale) : 1.0 - exp(-x / scale);
            add_four(x, 0.0, 1.5 + 33.0 * s, 0.02);
        }
        fit_piles();
        CU_ASSERT((int)fitted.response[0].shape == shape && fitted.response[0].degree[0] == 1);
        CHECK_NEAR(fitted.response[0].scale, scale, 1e-6 * unit);
        CU_ASSERT(fitted.response[0].n_terms == 3 && fitted.response[0].dof == 7);
        /* 1, and tanh(x/scale) or exp(-(x - lo)/scale) */
        const bool is_tanh = shape == STATS_TANH;
        CHECK_NEAR(fitted.response[0].coefficients[0], is_tanh ? 1.5 : 1.5 + 33.0, 1e-3);
        CHECK_NEAR(fitted.response[0].coefficients[1], is_tanh ? 33.0 : -33.0 * exp(-fitted.lo[0] / scale),
                   1e-3);
        invert((stats_measured){{z}, {0.1}});
        double s = (z - 1.5) / 33.0, at = 0.385 * unit, v;
        stats_response_value(&fitted.response[0], &at, &v);
        /* the scale is known to 1e-6 of it */
        const saturating form = {is_tanh, 33.0, scale};
        CHECK_NEAR(v / variance_by_slopes(3, slopes_of_saturating, &form, &at), 1.0, 1e-4);
        CHECK_NEAR(found[0].value, scale * (shape == STATS_TANH ? atanh(s) : -log(1.0 - s)), 1e-6 * unit);
    }
}

/* Scatter from points of 2 to 9 piles: a parabola through the logarithms of their variances, each without
 * bias and with the weight of its own error. */
static void test_scatter(void)
{
    enum { POINTS = 8 };
    double X[3 * POINTS], y[POINTS], w[POINTS], c[3], covariance[9];
    start(1, 1);
    for (size_t g = 0; g < POINTS; g++) {
        const double u = -1.0 + 2.0 * (double)g / (POINTS - 1.0), half = 0.5 * ((double)g + 1.0);
        const size_t first = piles.n;
        for (size_t k = 0; k < g + 2; k++)
            add(0.2 + 0.1 * (double)g, 0.0, 10.0 + 3.0 * (double)g + 0.4 * (double)((k * 3 + g * g) % 7),
                0.0);
        y[g] = log(gsl_stats_variance(data[2] + first, 1, g + 2)) - gsl_sf_psi(half) + log(half);
        w[g] = 1.0 / gsl_sf_psi_1(half);
        for (size_t i = 0; i < 3; i++) X[3 * g + i] = pow(u, (double)i);
    }
    numbers_fit(POINTS, 3, X, w, y, c, covariance);
    fit_piles();
    for (double u = -1.0; u < 1.1; u += 0.4) {
        const double x = 0.2 + 0.35 * (u + 1.0);
        CHECK_NEAR(stats_calibration_sd(&fitted, 0, &x), exp(0.5 * (c[0] + u * c[1] + u * u * c[2])), 1e-10);
    }
}

/* Two angles that are planes; the scatter of the second is a part of the first's and one of its own. */
static double plane(int a, const double x[])
{
    return a ? 1.0 + 30.0 * x[0] - 14.0 * x[1] : 3.0 + 25.0 * x[0] + 20.0 * x[1];
}

static void start_planes(double shared, double own)
{
    start(2, 2);
    for (int i = 0; i < 48; i++) {
        const double x[2] = {0.1 + 0.2 * (i / 12), 0.15 * (i / 4 % 3)}, noise = i % 2 ? 0.5 : -0.5,
                     other = i / 2 % 2 ? 0.5 : -0.5;
        add(x[0], x[1], plane(0, x) + noise, plane(1, x) + shared * noise + own * other);
    }
}

/* Two parameters from two angles that are planes. */
static void test_two_parameters(void)
{
    start_planes(0.0, 1.0);
    fit_piles();
    CHECK_NEAR(fitted.correlation, 0.0, 1e-12);
    const double x[2] = {0.3739, 0.1187}, e = 0.385;
    stats_measured m = measured(plane(0, x), e, plane(1, x), e);
    invert(m);
    CHECK_NEAR(found[0].value, x[0], 1e-6);
    CHECK_NEAR(found[1].value, x[1], 1e-6);
    /* delta method: inverse of [[25, 20], [30, -14]], determinant -950 */
    double va, vb;
    stats_response_value(&fitted.response[0], x, &va);
    stats_response_value(&fitted.response[1], x, &vb);
    va += e * e, vb += e * e;
    CHECK_NEAR(found[0].se, sqrt(14.0 * 14.0 * va + 20.0 * 20.0 * vb) / 950.0, 1e-6);
    CHECK_NEAR(found[1].se, sqrt(30.0 * 30.0 * va + 25.0 * 25.0 * vb) / 950.0, 1e-6);
    /* the profile of planes is nearly a parabola: half width 1.96 se, but for the variance that changes with
     * x */
    for (int p = 0; p < 2; p++) {
        CU_ASSERT(found[p].status == STATS_CALIBRATED_OK);
        CHECK_NEAR((found[p].solutions[0].upper - found[p].solutions[0].lower) / (3.92 * found[p].se), 1.0,
                   0.02);
    }
    /* 400 resamples know a standard deviation to 3.5 %; the errors of the measurement are far above those of
     * the response, so that the bootstrap's is the delta method's */
    scoped_rng *rng = numbers_of(64, 0);
    m = measured(m.angle[0], 6.0 * e, m.angle[1], 4.0 * e);
    invert(m);
    CHECK_OK(stats_calibration_bootstrap(&piles, &fitted, &m, 400, rng, found));
    for (int p = 0; p < 2; p++) CHECK_NEAR(found[p].boot_se / found[p].se, 1.0, sigmas * 0.0354);
    m = measured(m.angle[0], e, m.angle[1], e);
    piles.n_angles = 1; /* one angle determines a line in the plane, and limits from its ends */
    CU_ASSERT(invert_status(m) == STATS_CALIBRATED_UNDERDETERMINED);
}

/* The inverse of the two planes takes correlated errors with it: (J^-1 V J^-T), J = [[25, 20], [30, -14]]. */
static void test_two_correlated(void)
{
    const double x[2] = {0.3739, 0.1187}, e[2] = {0.385, 0.2}, at[2] = {17.0, 12.0};
    double v[2];
    start_planes(0.6, 0.8);
    fit_piles();
    CHECK_NEAR(fitted.correlation, 0.6, 1e-9);
    invert(measured(plane(0, x), e[0], plane(1, x), e[1]));
    for (size_t a = 0; a < 2; a++) stats_response_value(&fitted.response[a], x, &v[a]);
    const double both = 0.6 * (sqrt(v[0] * v[1]) + e[0] * e[1]);
    for (size_t a = 0; a < 2; a++) v[a] += e[a] * e[a];
    CHECK_NEAR(found[0].se, sqrt(14.0 * 14.0 * v[0] + 2.0 * 14.0 * 20.0 * both + 20.0 * 20.0 * v[1]) / 950.0,
               1e-6);
    CHECK_NEAR(found[1].se, sqrt(30.0 * 30.0 * v[0] - 2.0 * 30.0 * 25.0 * both + 25.0 * 25.0 * v[1]) / 950.0,
               1e-6);
    /* an angle that no pile has: the best point is in the range, and nothing is known of either parameter */
    invert((stats_measured){{at[0] + 30.0, at[1]}, {0.1, 0.1}});
    for (int p = 0; p < 2; p++)
        CU_ASSERT(found[p].status == STATS_CALIBRATED_NO_MATCH && found[p].n_solutions == 0 &&
                  isnan(found[p].value));
}

/* The same resamples as the library's: at each point the piles drawn anew, then the error of the angle. The
 * points lie on a line and weigh the same, some have a pile without the angle. */
static void test_bootstrap(void)
{
    enum { POINTS = 6, EACH = 5, B = 40 };
    const double z = 19.0, e = 0.4, low = 0.1, step = 0.1;
    double value[B];
    start(1, 1);
    for (int g = 0; g < POINTS; g++)
        for (int k = 0; k < EACH; k++)
            add(low + step * g, 0.0,
                k == 2 ? NAN : 8.0 + 30.0 * step * g + (k % 2 ? 0.7 : -0.7) * (k < 2 ? 1.0 : 0.5), 0.0);
    fit_piles();
    invert((stats_measured){{z}, {e}});
    scoped_rng *rng = numbers_of(65, 0), *same = gsl_rng_clone(rng);
    CHECK_OK(stats_calibration_bootstrap(&piles, &fitted, &(stats_measured){{z}, {e}}, B, rng, found));
    for (int b = 0; b < B; b++) {
        double x[POINTS], y[POINTS], draw[2], c0, c1, v00, v01, v11, rest;
        for (int g = 0; g < POINTS; g++) {
            double sum = 0.0, mean = 0.0;
            int n = 0;
            for (int k = 0; k < EACH; k++) {
                const double drawn = data[2][g * EACH + (int)gsl_rng_uniform_int(same, EACH)],
                             own = data[2][g * EACH + k];
                if (!isnan(own)) mean += own / (EACH - 1.0);
                if (!isnan(drawn)) sum += drawn, n++;
            }
            x[g] = low + step * g; /* the spread of resampled means has n, not n - 1, below the root */
            y[g] = mean + sqrt((EACH - 1.0) / (EACH - 2.0)) * ((n ? sum / n : mean) - mean);
        }
        gsl_ran_bivariate_gaussian(same, 1.0, 1.0, 0.0, &draw[0], &draw[1]);
        gsl_fit_linear(x, 1, y, 1, POINTS, &c0, &c1, &v00, &v01, &v11, &rest);
        value[b] = (z + draw[0] * e - c0) / c1;
    }
    gsl_sort(value, 1, B);
    CHECK_NEAR(found[0].boot_se, gsl_stats_sd(value, 1, B), 1e-6);
    CHECK_NEAR(found[0].boot_lower, gsl_stats_quantile_from_sorted_data(value, 1, B, 0.025), 1e-6);
    CHECK_NEAR(found[0].boot_upper, gsl_stats_quantile_from_sorted_data(value, 1, B, 0.975), 1e-6);
}

/* ---- forms of two parameters ---- */

/* Value of a form with coefficients 1, -1/2, 1/3, ...: of the first parameter 1, saturation and itself, or
 * powers; of the second powers; each from -1 to 1. */
static double form_value(int shape, size_t first, size_t second, double scale, double u, double v)
{
    const double x = 0.2 + 0.5 * (u + 1.0);
    double sum = 0.0;
    int n = 0;
    for (size_t i = 0; i <= first; i++)
        for (size_t j = 0; j <= second; j++, n++) {
            const double f = i == 0                  ? 1.0
                             : shape == STATS_POWERS ? pow(u, (double)i)
                             : i == 2                ? u
                             : shape == STATS_TANH   ? tanh(x / scale)
                                                     : exp((0.2 - x) / scale);
            sum += 30.0 * (n % 2 ? -1.0 : 1.0) / (n + 1.0) * f * pow(v, (double)j);
        }
    return sum;
}

/* By differences, of all coefficients and the scale. */
static void slopes_by_differences(const void *form, const double x[], double slopes[])
{
    const stats_response_fit *fit = form;
    const double h = 1e-5;
    for (size_t i = 0; i < fit->n_terms; i++) {
        stats_response_fit up = *fit, down = *fit;
        if (i + 1 == fit->n_terms && fit->shape != STATS_POWERS)
            up.scale += h, down.scale -= h;
        else
            up.coefficients[i] += h, down.coefficients[i] -= h;
        slopes[i] = (stats_response_value(&up, x, NULL) - stats_response_value(&down, x, NULL)) / (2.0 * h);
    }
}

/* Means exactly on a form are fitted by that form, whose values and variances between the points are its own.
 */
static void test_forms(void)
{
    static const size_t degrees[][2] = {{1, 1}, {2, 1}, {1, 2}, {2, 2}, {3, 1}, {4, 2}};
    for (int shape = STATS_POWERS; shape <= STATS_TANH; shape++)
        for (size_t d = 0; d < (shape == STATS_POWERS ? 6 : 4); d++) {
            const size_t first = degrees[d][0], second = degrees[d][1];
            const double scale = 0.31;
            start(2, 1);
            for (int i = 0; i < 7; i++)
                for (int j = 0; j < 4; j++)
                    add_four(0.2 + i / 6.0, 0.5 + 0.1 * j,
                             form_value(shape, first, second, scale, i / 3.0 - 1.0, j / 1.5 - 1.0), 0.01);
            fit_piles();
            const stats_response_fit *r = &fitted.response[0];
            CU_ASSERT((int)r->shape == shape && r->degree[0] == first && r->degree[1] == second);
            CU_ASSERT(r->n_terms == (first + 1) * (second + 1) + (shape != STATS_POWERS) &&
                      r->n_points == 28);
            CU_ASSERT(r->dof == r->n_points - r->n_terms && r->discrepancy < 1e-12);
            for (int k = 0; k < 5; k++) {
                const double u = -0.9 + 0.4 * k, v = 0.8 - 0.35 * k,
                             x[2] = {0.2 + 0.5 * (u + 1.0), 0.5 + 0.15 * (v + 1.0)};
                double variance;
                CHECK_NEAR(stats_response_value(r, x, &variance),
                           form_value(shape, first, second, scale, u, v), 1e-5);
                CHECK_NEAR(variance / variance_by_slopes(r->n_terms, slopes_by_differences, r, x), 1.0, 1e-4);
            }
        }
}

/* ---- parameters that the piles do not identify ---- */

/* Piles on a line, and a measurement. A fall: an angle above all is to be sought below the lower end. Two
 * angles that rise: the first gives 0.2, the second 0.4; where both are above all the best is the end of the
 * range, which of two angles says nothing. */
static void test_unidentified(void)
{
    static const struct {
        size_t n_angles;
        double first, a, b;
        stats_measured measured;
        stats_calibrated_status status;
        double lower, upper; /* where no pile has the angle */
    } cases[] = {{1, 0.2, 10.0, 20.0, {{15.0}, {0.5}}, STATS_CALIBRATED_OK, NAN, NAN},
                 {1, 0.2, 10.0, 20.0, {{19.6}, {0.5}}, STATS_CALIBRATED_AT_LEAST, NAN, NAN},
                 {1, 0.2, 10.0, 20.0, {{10.3}, {0.5}}, STATS_CALIBRATED_AT_MOST, NAN, NAN},
                 {1, 0.2, 10.0, 20.0, {{15.0}, {9.0}}, STATS_CALIBRATED_NOT_IDENTIFIED, NAN, NAN},
                 {1, 0.2, 10.0, 20.0, {{27.0}, {0.5}}, STATS_CALIBRATED_ABOVE_RANGE, 0.2 + 0.1 * 5, NAN},
                 {1, 0.2, 10.0, 20.0, {{3.0}, {0.5}}, STATS_CALIBRATED_BELOW_RANGE, NAN, 0.2},
                 {1, 0.2, 30.0, -20.0, {{37.0}, {0.5}}, STATS_CALIBRATED_ABOVE_RANGE, NAN, 0.2},
                 {2, 0.0, 10.0, 20.0, {{14.0, 14.0}, {0.5, 0.5}}, STATS_CALIBRATED_OK, NAN, NAN},
                 {2, 0.0, 10.0, 20.0, {{14.0, 18.0}, {0.5, 0.5}}, STATS_CALIBRATED_NO_MATCH, NAN, NAN},
                 {2, 0.0, 10.0, 20.0, {{40.0, 30.0}, {0.5, 0.5}}, STATS_CALIBRATED_NO_MATCH, NAN, NAN}};
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        start_line(cases[k].n_angles, 6, cases[k].first, 0.1, cases[k].a, cases[k].b, 1.0);
        CU_ASSERT(invert_status(cases[k].measured) == cases[k].status);
        const double limits[2] = {found[0].solutions[0].lower, found[0].solutions[0].upper},
                     expected[2] = {cases[k].lower, cases[k].upper};
        CU_ASSERT(cases[k].status != STATS_CALIBRATED_NO_MATCH || found[0].n_solutions == 0);
        if (cases[k].status < STATS_CALIBRATED_ABOVE_RANGE) continue;
        CU_ASSERT(isnan(found[0].value));
        for (int i = 0; i < 2; i++)
            CU_ASSERT(isnan(expected[i]) ? isnan(limits[i]) : limits[i] == expected[i]);
    }
    /* chi2 of one degree of freedom is above 6.63 with a chance of 1 %; an error of 10 is all there is, so
     * that for angles 15 +- d it is d^2/50 */
    CU_ASSERT(invert_status(measured(15.0 + 18.0, 10.0, 15.0 - 18.0, 10.0)) != STATS_CALIBRATED_NO_MATCH);
    CU_ASSERT(invert_status(measured(15.0 + 18.6, 10.0, 15.0 - 18.6, 10.0)) == STATS_CALIBRATED_NO_MATCH);
}

/* A response with a maximum: both flanks match an angle, none matches above it. */
static void test_maximum(void)
{
    start(1, 1);
    for (int g = 0; g < 9; g++) add_four(0.1 * g, 0.0, 30.0 - 100.0 * pow(0.1 * g - 0.385, 2), 0.5);
    CU_ASSERT(invert_status(measured(25.0, 0.3, 0.0, 0.0)) == STATS_CALIBRATED_SEVERAL);
    CU_ASSERT(!fitted.response[0].monotone && found[0].n_solutions == 2 && isnan(found[0].value));
    CHECK_NEAR(found[0].solutions[0].value, 0.385 - sqrt(0.05), 1e-6);
    CHECK_NEAR(found[0].solutions[1].value, 0.385 + sqrt(0.05), 1e-6);
    CU_ASSERT(found[0].solutions[0].upper < found[0].solutions[1].lower);
    CU_ASSERT(invert_status(measured(35.0, 0.3, 0.0, 0.0)) == STATS_CALIBRATED_ABOVE_RANGE);
    CU_ASSERT(invert_status(measured(8.0, 0.3, 0.0, 0.0)) == STATS_CALIBRATED_BELOW_RANGE);
    CU_ASSERT(invert_status(measured(30.0, 0.3, 0.0, 0.0)) == STATS_CALIBRATED_OK);
    const stats_reach reach = stats_calibration_reach(&fitted, 0);
    /* half the distance of two samples off the top */
    CHECK_NEAR(reach.angle[1], 30.0, 100.0 * pow(0.8 / 128.0, 2));
    CHECK_NEAR(reach.at[1][0], 0.385, 0.8 / 128.0);
    CHECK_NEAR(reach.angle[0], 30.0 - 100.0 * pow(0.8 - 0.385, 2), 1e-6);
    CU_ASSERT(reach.at[0][0] == fitted.hi[0]);
}

/* An interval far narrower than the scanned values are apart, at different parts of their distance. */
static void test_narrow(void)
{
    start_line(1, 6, 0.0, 0.2, 10.0, 20.0, 1e-3);
    fit_piles();
    for (int k = 1; k < 10; k++) {
        const double x = (200.0 + 0.1 * k) / 400.0;
        invert((stats_measured){{10.0 + 20.0 * x}, {1e-4}});
        CU_ASSERT(found[0].status == STATS_CALIBRATED_OK &&
                  found[0].solutions[0].upper - found[0].solutions[0].lower < 4e-4);
        CHECK_NEAR(found[0].value, x, search_error);
    }
}

/* Any table of piles has an answer or an error of its own, and never a broken invariant. */
static void test_random_tables(void)
{
    const int n = check_fast() ? 40 : 250;
    scoped_rng *rng = numbers_of(2214, 0);
    int n_found = 0;
    for (int table = 0; table < n; table++) {
        const size_t n_points = 4 + gsl_rng_uniform_int(rng, 7), n_each = 2 + gsl_rng_uniform_int(rng, 6);
        const double unit = pow(10.0, gsl_ran_flat(rng, -2.0, 2.0)),
                     sd = pow(10.0, gsl_ran_flat(rng, -2.0, 0.5));
        const double slope = gsl_ran_flat(rng, -30.0, 40.0), bend = gsl_ran_flat(rng, 0.1, 1.5);
        start(1, 1 + gsl_rng_uniform_int(rng, 2));
        for (size_t g = 1; g <= n_points; g++)
            for (size_t k = 0; k < n_each; k++) {
                const double x = (double)g / (double)n_points, e = gsl_ran_gaussian(rng, sd);
                const double other = gsl_rng_uniform(rng) < 0.5 ? e : gsl_ran_gaussian(rng, sd);
                const double angle = table % 2 ? slope * tanh(x / bend) : gsl_ran_flat(rng, 0.0, 40.0);
                add(x * unit, 0.0, angle + e, 5.0 + 14.0 * x + (table % 3 ? other : e));
            }
        const stats_measured m = measured(gsl_ran_flat(rng, 0.0, 40.0), 1.0, 12.0, 0.5);
        fit_piles();
        invert(m);
        CHECK_OK(stats_calibration_bootstrap(&piles, &fitted, &m, 2, rng, found));
        n_found += found[0].n_solutions > 0;
        CU_ASSERT(found[0].n_solutions > 0 || found[0].status >= STATS_CALIBRATED_ABOVE_RANGE);
    }
    CU_ASSERT(n_found > n / 2);
}

/* ---- coverage ---- */

static double truth_r(double x)
{
    return 34.0 * tanh(x / 0.31);
}

static double truth_t(double x)
{
    return 2.0 + 14.0 * x;
}

/* Realistic piles: scatter that grows with x, and second angles correlated with the first.
 */
static void draw_piles(gsl_rng *rng, size_t n_angles)
{
    start(1, n_angles);
    for (int g = 0; g < 10; g++)
        for (int k = 0; k < 8; k++) {
            double x = 0.05 + 0.06 * g, a, b;
            gsl_ran_bivariate_gaussian(rng, 1.5 + x, 0.4 + x, 0.5, &a, &b);
            add(x, 0.0, truth_r(x) + a, truth_t(x) + b);
        }
}

static bool covers(const stats_calibrated *r, double truth)
{
    bool in = false;
    for (size_t i = 0; i < r->n_solutions; i++)
        in |= !(truth < r->solutions[i].lower || truth > r->solutions[i].upper);
    return in;
}

/* True parameters in the inner part of the range; measured with an error about that of the response's points.
 */
static size_t count_covered(size_t n_angles, size_t n_cases)
{
    scoped_rng *rng = numbers_of(1787, (unsigned long)n_angles);
    size_t covered = 0;
    for (size_t k = 0; k < n_cases; k++) {
        draw_piles(rng, n_angles);
        double x = 0.1 + 0.3 * gsl_rng_uniform(rng), a, b;
        gsl_ran_bivariate_gaussian(rng, 0.6, 0.3, 0.5, &a, &b);
        stats_measured m = measured(truth_r(x) + a, 0.6, truth_t(x) + b, 0.3);
        fit_piles();
        invert(m);
        covered += covers(&found[0], x);
    }
    return covered;
}

/* The truth lies in 95 % +- 4 standard errors of n intervals, plus at most 2 % for the allowance for lack of
 * fit. */
static void test_coverage(void)
{
    const size_t n = check_fast() ? 60 : 400;
    const double error = sigmas * sqrt(0.95 * 0.05 / (double)n);
    for (size_t n_angles = 1; n_angles <= 2; n_angles++) {
        double share = (double)count_covered(n_angles, n) / (double)n;
        CHECK_NEAR(share, 0.96, 0.01 + error);
    }
}

/* The angle of another parameter is not covered; of two parameters, each has an interval of its own. */
static void test_uncovered(void)
{
    scoped_rng *rng = numbers_of(1993, 0);
    draw_piles(rng, 1);
    fit_piles();
    for (int k = 0; k < 3; k++) {
        const double x = k < 2 ? 0.15 + 0.03 * k : 0.5, e = stats_calibration_sd(&fitted, 0, &x);
        invert((stats_measured){{truth_r(0.5)}, {e}});
        CU_ASSERT(covers(&found[0], x) == (k == 2));
    }
    start_planes(0.0, 0.6);
    fit_piles();
    /* 25 dx + 20 dy = 3 and 30 dx - 14 dy = 3.6: the first parameter is off by 0.12, the second is not */
    for (int shifted = 0; shifted < 2; shifted++) {
        const double x[2] = {0.47, 0.21}, shift = shifted ? 3.0 : 0.0;
        invert(measured(plane(0, x) + shift, stats_calibration_sd(&fitted, 0, x) / sqrt(5.0),
                        plane(1, x) + 1.2 * shift, stats_calibration_sd(&fitted, 1, x) / sqrt(5.0)));
        CU_ASSERT(covers(&found[0], x[0]) == !shifted && covers(&found[1], x[1]));
    }
}

/* Angles that scatter in step, or against one another: their covariance keeps an inverse. */
static void test_full_correlation(void)
{
    for (int sign = -1; sign < 2; sign += 2) {
        start(1, 2);
        for (int g = 0; g < 6; g++)
            for (int k = 0; k < 4; k++) add(0.1 * g, 0.0, 10.0 * g + 0.1 * k, 5.0 * g + 0.2 * sign * k);
        fit_piles();
        CHECK_NEAR(fitted.correlation, 0.999 * sign, 1e-12);
    }
}

/* Means exactly on a parabola: four points are too few for its three terms, five are enough. */
static void test_terms_of_points(void)
{
    for (int n = 4; n < 6; n++) {
        start(1, 1);
        for (int g = 0; g < n; g++) add_four(0.1 * g, 0.0, 10.0 + 8.0 * g + 1.5 * g * g, 0.01);
        fit_piles();
        CU_ASSERT(fitted.response[0].n_points == (size_t)n && fitted.response[0].n_terms == (size_t)n - 2);
    }
}

/* A parameter that is 1000 larger, or in a unit a thousand times as large, has limits that are so, as exactly
 * as the search finds them. */
static void test_offset(void)
{
    static const struct {
        double first, unit;
    } cases[] = {{0.0, 1.0}, {1000.0, 1.0}, {0.0, 1e-3}};
    double limits[3][2], value[3], se[3];
    for (int k = 0; k < 3; k++) {
        start_line(1, 6, cases[k].first, 0.1 * cases[k].unit, 10.0, 20.0 / cases[k].unit, 1.0);
        fit_piles();
        invert((stats_measured){{15.0}, {0.5}});
        limits[k][0] = (found[0].solutions[0].lower - cases[k].first) / cases[k].unit;
        limits[k][1] = (found[0].solutions[0].upper - cases[k].first) / cases[k].unit;
        value[k] = found[0].value - cases[k].first;
        se[k] = found[0].se;
        for (int i = 0; i < 2; i++) CHECK_NEAR(limits[k][i], limits[0][i], 2e-9);
    }
    CHECK_NEAR(value[1], value[0], search_error);
    CHECK_NEAR(se[1], se[0], search_error);
}

/* A parabola turns below the range, above it, or just within: the first two rise or fall throughout. */
static void test_turns(void)
{
    static const double turn[] = {0.28, 0.92, 0.34, 0.86};
    for (int k = 0; k < 4; k++) {
        start(1, 1);
        for (int g = 0; g < 7; g++) {
            const double x = 0.3 + 0.1 * g;
            add_four(x, 0.0, 10.0 + 100.0 * pow(x - turn[k], 2.0), 0.01);
        }
        fit_piles();
        CU_ASSERT(fitted.response[0].degree[0] == 2 && fitted.response[0].monotone == (k < 2));
    }
}

/* ---- the search ---- */

enum { CELLS = 5, MOST_SEEN = 20000 };
typedef struct {
    double at[MOST_SEEN][2];
    size_t n;
    double lowest[2]; /* place of a narrow well */
} seen;

static double bowl_and_well(const double x[], void *context)
{
    seen *s = context;
    if (s->n < MOST_SEEN) memcpy(s->at[s->n++], x, sizeof s->at[0]);
    const double away = pow(x[0] - s->lowest[0], 2) + pow(x[1] - s->lowest[1], 2);
    return 0.001 * (x[0] * x[0] + x[1] * x[1]) + fmin(away, 0.5);
}

/* The box is scanned first, by points whose distance is a part of its sides, its ends among them; the least
 * of them leads to the narrow well, wherever that is, and nowhere is the box left. A side without length is
 * held. */
static void test_least(void)
{
    static const double lo[2] = {-1.0, 2.0}, hi[2] = {9.0, 4.0};
    static seen s;
    for (int held = -1; held < 2; held++)
        for (int k = 0; k < 4; k++) {
            double high[2] = {hi[0], hi[1]}, x[2], value;
            if (held >= 0) high[held] = lo[held];
            s = (seen){.lowest = {k % 2 ? high[0] : lo[0], k / 2 ? high[1] : lo[1]}};
            CHECK_OK(stats_least(bowl_and_well, &s, 2, lo, high, CELLS, x, &value));
            const int n[2] = {held == 0 ? 0 : CELLS, held == 1 ? 0 : CELLS};
            size_t scanned = 0;
            for (int i = 0; i <= n[0]; i++)
                for (int j = 0; j <= n[1]; j++, scanned++) {
                    CHECK_NEAR(s.at[scanned][0], lo[0] + (high[0] - lo[0]) * i / CELLS, 1e-12);
                    CHECK_NEAR(s.at[scanned][1], lo[1] + (high[1] - lo[1]) * j / CELLS, 1e-12);
                }
            for (size_t i = 0; i < s.n; i++)
                for (int p = 0; p < 2; p++) CU_ASSERT(s.at[i][p] >= lo[p] && s.at[i][p] <= high[p]);
            /* of a parabola 1.001 x^2 - 2 c x: its minimum, or the box's end before it */
            for (int p = 0; p < 2; p++)
                CHECK_NEAR(x[p], fmin(fmax(s.lowest[p] / 1.001, lo[p]), high[p]), 1e-6);
            CHECK_NEAR(value, bowl_and_well(x, &s), 1e-12);
        }
    double x[2], value; /* a box that is none */
    CHECK_FAILS(
        stats_least(bowl_and_well, &s, 2, (double[]){0.0, 1.0}, (double[]){1.0, 0.0}, CELLS, x, &value),
        RP_BROKEN, "minimum not found: ");
}

/* ---- bad input ---- */

static void fit_fails(const char *text)
{
    stats_calibration_free(&fitted);
    CHECK_FAILS(stats_calibration_fit(&piles, &fitted), RP_BAD_INPUT, text);
}

static void test_bad_piles(void)
{
    start_line(1, 3, 0.0, 0.1, 10.0, 10.0, 1.0);
    fit_fails("3 points with piles, at least 4");
    add(0.35, 0.0, 12.0, 0.0);
    fit_fails("parameter 0.35: angle 1 of 1 piles");
    add(0.35, 0.0, 12.0, 0.0);
    fit_fails("parameter 0.35: angle 1 is the same");
    add(NAN, 0.0, 12.0, 0.0);
    fit_fails("pile 15: parameter = nan");
    start(2, 1);
    for (int g = 0; g < 9; g++) add_four(0.1 * (g % 3), g == 8 ? 7.0 : g / 3, 10.0 + g, 1.0);
    fit_fails("a full grid needed");
    static const struct {
        size_t n_params, n_angles;
        double pile[4];
        const char *text;
    } cases[] = {{3, 1, {0}, "parameters = 3"},
                 {0, 1, {0}, "parameters = 0"},
                 {1, 3, {0}, "angles = 3"},
                 {1, 0, {0}, "angles = 0"},
                 {1, 2, {0.1, 0.0, 12.0, -INFINITY}, "pile 1: angle = -inf"},
                 {2, 2, {0.1, NAN, 12.0, 3.0}, "pile 1: parameter = nan"},
                 {1, 2, {0.1, 0.0, INFINITY, 3.0}, "pile 1: angle = inf"}};
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        start(cases[k].n_params, cases[k].n_angles);
        if (k > 3) add(cases[k].pile[0], cases[k].pile[1], cases[k].pile[2], cases[k].pile[3]);
        fit_fails(cases[k].text);
    }
    /* two parameters: 8 points at least, and two values of each */
    static const int rows[3] = {2, 2, 1}, columns[3] = {4, 3, 8};
    static const char *const texts[3] = {NULL, "6 points with piles, at least 8",
                                         "1 x 8 values of two parameters"};
    for (int k = 0; k < 3; k++) {
        start(2, 1);
        for (int i = 0; i < rows[k]; i++)
            for (int j = 0; j < columns[k]; j++) add_four(0.1 * i, 0.1 * j, 10.0 + i + j, 1.0);
        if (texts[k])
            fit_fails(texts[k]);
        else
            fit_piles();
    }
}

static void test_bad_measurements(void)
{
    static const struct {
        stats_measured measured;
        const char *text;
    } cases[] = {{{{12.0, 12.0}, {-0.1, 0.1}}, "error of angle 1 = -0.1"},
                 {{{NAN, 12.0}, {0.1, 0.1}}, "angle 1 = nan"},
                 {{{12.0, INFINITY}, {0.1, 0.1}}, "angle 2 = inf"},
                 {{{12.0, 12.0}, {0.1, INFINITY}}, "error of angle 2 = inf"}};
    start_line(2, 5, 0.0, 0.1, 10.0, 10.0, 1.0);
    fit_piles();
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++)
        CHECK_FAILS(stats_calibration_invert(&fitted, &cases[k].measured, found), RP_BAD_INPUT,
                    cases[k].text);
    CHECK_FAILS(stats_calibration_bootstrap(&piles, &fitted, &cases[0].measured, 1, NULL, found),
                RP_BAD_INPUT, "resamples = 1");
}

void suite_calibrate(void)
{
    static const check_case cases[] = {{"least value in a box", test_least},
                                       {"a straight line: Fieller's interval", test_line},
                                       {"lack of fit", test_lack_of_fit},
                                       {"correlated angles", test_correlated},
                                       {"saturating responses", test_saturating},
                                       {"scatter of piles", test_scatter},
                                       {"two parameters, two angles", test_two_parameters},
                                       {"two parameters, correlated angles", test_two_correlated},
                                       {"resamples of piles, by hand", test_bootstrap},
                                       {"forms of two parameters", test_forms},
                                       {"parameters not identified", test_unidentified},
                                       {"a response with a maximum", test_maximum},
                                       {"an interval narrower than the scan", test_narrow},
                                       {"random tables", test_random_tables},
                                       {"coverage", test_coverage},
                                       {"angles of other parameters", test_uncovered},
                                       {"fully correlated angles", test_full_correlation},
                                       {"terms that a number of points allows", test_terms_of_points},
                                       {"where a response turns", test_turns},
                                       {"a parameter far from 0", test_offset},
                                       {"piles that have no response", test_bad_piles},
                                       {"measurements that can not be", test_bad_measurements},
                                       {0}};
    check_register("calibration", cases);
}
