/* The response of an angle to parameters: points from piles, and the form that fits them; see calibrate.h. */
#include <gsl/gsl_cdf.h>
#include <gsl/gsl_machine.h>
#include <gsl/gsl_sf_psi.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "stats/calibrate.h"
#include "stats/stats.h"

/* How much better, in AIC, a form must be that does not rise or fall throughout. */
static const double monotone_credit = 6.0;

const char *const stats_shape_words[] = {"powers", "exponential", "tanh"};

/* ---- points ---- */

static bool same_point(const stats_ensemble *piles, size_t i, size_t k)
{
    for (size_t p = 0; p < piles->n_params; p++)
        if (piles->x[p][i] != piles->x[p][k]) return false;
    return true;
}

/* Sort the piles by point, points in the order of their first piles, and find the range of the parameters. */
static void sort_piles(const stats_ensemble *piles, stats_calibration *c)
{
    size_t sorted = 0;
    for (size_t i = 0; i < piles->n; i++) {
        size_t g = 0;
        while (g < c->n_points && !same_point(piles, c->pile[c->point[g].first], i)) g++;
        if (g < c->n_points) continue;
        c->point[c->n_points++].first = sorted;
        for (size_t k = i; k < piles->n; k++)
            if (same_point(piles, i, k)) c->pile[sorted++] = k;
        for (size_t p = 0; p < c->n_params; p++) {
            const double x = c->point[g].x[p] = piles->x[p][i];
            c->lo[p] = g ? fmin(c->lo[p], x) : x;
            c->hi[p] = g ? fmax(c->hi[p], x) : x;
        }
    }
    c->point[c->n_points].first = sorted;
}

/* Means and standard deviations of the piles that have the angle; work[piles->n]. */
static void point_moments(const stats_ensemble *piles, const stats_calibration *c, double work[])
{
    for (stats_point *q = c->point; q < c->point + c->n_points; q++)
        for (size_t a = 0; a < c->n_angles; a++) {
            stats_summary stats;
            size_t n = 0;
            for (size_t k = q->first; k < q[1].first; k++)
                if (!isnan(piles->angle[a][c->pile[k]])) work[n++] = piles->angle[a][c->pile[k]];
            (void)stats_mean(n, work, &stats); /* nan without piles */
            q->number[a] = (double)n;
            q->mean[a] = stats.mean;
            q->sd[a] = stats.sd;
        }
}

/* Correlation of the two angles' deviations from their points. It stays below 1, as few piles may not show:
 * the covariance of the two must have an inverse. */
static double correlation(const stats_ensemble *piles, const stats_calibration *c)
{
    const double most = 0.999;
    double sum[3] = {0.0};
    for (const stats_point *q = c->point; q < c->point + c->n_points; q++)
        for (size_t k = q->first; k < q[1].first; k++) {
            double d[2];
            for (size_t a = 0; a < 2; a++) d[a] = (piles->angle[a][c->pile[k]] - q->mean[a]) / q->sd[a];
            for (size_t a = 0; isfinite(d[0] * d[1]) && a < 3; a++) sum[a] += d[a / 2] * d[(a + 1) / 2];
        }
    return sum[1] != 0.0 ? fmax(fmin(sum[1] / sqrt(sum[0] * sum[2]), most), -most) : 0.0;
}

static rp_status check_piles(const stats_ensemble *piles)
{
    if (piles->n_params < 1 || piles->n_params > STATS_MAX_PARAMS)
        return rp_fail(RP_BAD_INPUT, "parameters = %zu: out of range, allowed: [1, %d]", piles->n_params,
                       STATS_MAX_PARAMS);
    if (piles->n_angles < 1 || piles->n_angles > STATS_MAX_ANGLES)
        return rp_fail(RP_BAD_INPUT, "angles = %zu: out of range, allowed: [1, %d]", piles->n_angles,
                       STATS_MAX_ANGLES);
    for (size_t i = 0; i < piles->n; i++) {
        for (size_t p = 0; p < piles->n_params; p++)
            if (!isfinite(piles->x[p][i]))
                return rp_fail(RP_BAD_INPUT, "pile %zu: parameter = %g: not finite", i + 1, piles->x[p][i]);
        for (size_t a = 0; a < piles->n_angles; a++)
            if (isinf(piles->angle[a][i]))
                return rp_fail(RP_BAD_INPUT, "pile %zu: angle = %g: not finite", i + 1, piles->angle[a][i]);
    }
    return RP_OK;
}

static rp_status make_points(const stats_ensemble *piles, stats_calibration *c)
{
    *c = (stats_calibration){.n_params = piles->n_params, .n_angles = piles->n_angles};
    RP_TRY(check_piles(piles));
    double *work = malloc((piles->n + 1) * sizeof *work);
    c->point = calloc(piles->n + 1, sizeof *c->point);
    c->pile = calloc(piles->n + 1, sizeof *c->pile);
    const bool made = work && c->point && c->pile;
    if (made) {
        sort_piles(piles, c);
        point_moments(piles, c, work);
        if (c->n_angles == 2) c->correlation = correlation(piles, c);
    }
    free(work);
    return made ? RP_OK : rp_fail(RP_NO_MEMORY, "calibrate: out of memory");
}

void stats_calibration_free(stats_calibration *c)
{
    free(c->point);
    free(c->pile);
    *c = (stats_calibration){0};
}

static rp_status check_spread(const stats_calibration *c)
{
    for (size_t a = 0; a < c->n_angles; a++)
        for (const stats_point *q = c->point; q < c->point + c->n_points; q++) {
            if (q->number[a] < 2.0)
                return rp_fail(RP_BAD_INPUT, "parameter %g: angle %zu of %g piles, at least 2 needed",
                               q->x[0], a + 1, q->number[a]);
            if (!(q->sd[a] > 0.0))
                return rp_fail(RP_BAD_INPUT, "parameter %g: angle %zu is the same in all piles", q->x[0],
                               a + 1);
        }
    return RP_OK;
}

/* Two parameters: as many points as pairs of their values. */
static rp_status check_rectangle(const stats_calibration *c)
{
    size_t n[2] = {0, 0};
    if (c->n_params == 1) return RP_OK;
    for (size_t p = 0; p < 2; p++)
        for (size_t g = 0, before; g < c->n_points; g++) {
            for (before = 0; before < g && c->point[before].x[p] != c->point[g].x[p]; before++) continue;
            n[p] += before == g;
        }
    if (n[0] > 1 && n[1] > 1 && n[0] * n[1] == c->n_points) return RP_OK;
    return rp_fail(RP_BAD_INPUT, "%zu x %zu values of two parameters in %zu points: a full grid needed", n[0],
                   n[1], c->n_points);
}

/* ---- scatter of piles ---- */

/* x from -1 to 1 over its range; 0 for a parameter that there is not. */
static double unit(double x, double lo, double hi)
{
    return hi > lo ? (2.0 * x - lo - hi) / (hi - lo) : 0.0;
}

/* 1, x, x^2 and, with two parameters, y, y^2, each parameter from -1 to 1. */
static size_t scatter_terms(const stats_calibration *c, const double x[], double terms[STATS_SD_TERMS])
{
    size_t n = 1;
    terms[0] = 1.0;
    for (size_t p = 0; p < c->n_params; p++, n += 2) {
        terms[n] = unit(x[p], c->lo[p], c->hi[p]);
        terms[n + 1] = terms[n] * terms[n];
    }
    return n;
}

/* The variance of n normal values has a logarithm with mean log(sigma^2) + psi(v/2) - log(v/2) and variance
 * psi'(v/2), v = n - 1. */
static rp_status fit_scatter(stats_calibration *c, size_t angle)
{
    const size_t n = 2 * c->n_params + 1, points = c->n_points;
    double covariance[STATS_SD_TERMS * STATS_SD_TERMS];
    double *X = malloc(points * (n + 2) * sizeof *X), *y = X + points * n, *weights = y + points;
    if (!X) return rp_fail(RP_NO_MEMORY, "calibrate: out of memory");
    for (size_t g = 0; g < points; g++) {
        const stats_point *q = &c->point[g];
        const double half = 0.5 * (q->number[angle] - 1.0);
        scatter_terms(c, q->x, X + g * n);
        y[g] = 2.0 * log(q->sd[angle]) - gsl_sf_psi(half) + log(half);
        weights[g] = 1.0 / gsl_sf_psi_1(half);
    }
    const rp_status status = stats_linear_fit(
        &(stats_linear){points, n, X, y, weights, GSL_DBL_EPSILON, c->log_variance[angle], covariance});
    free(X);
    return status;
}

double stats_calibration_sd(const stats_calibration *c, size_t angle, const double x[])
{
    double terms[STATS_SD_TERMS], sum = 0.0;
    size_t n = scatter_terms(c, x, terms);
    for (size_t i = 0; i < n; i++) sum += c->log_variance[angle][i] * terms[i];
    return exp(0.5 * sum);
}

/* ---- forms ---- */

/* f_1 of a saturating shape and its derivative by the scale. */
static double saturation(const stats_response_fit *r, double x, double *by_scale)
{
    double t = (r->shape == STATS_TANH ? x : x - r->lo[0]) / r->scale;
    double f = r->shape == STATS_TANH ? tanh(t) : exp(-t);
    *by_scale = r->shape == STATS_TANH ? -t / r->scale * (1.0 - f * f) : t / r->scale * f;
    return f;
}

/* The terms at x, and for a saturating shape one more, the derivative of the sum by the scale. */
static void terms_at(const stats_response_fit *r, const double x[], double terms[STATS_MAX_TERMS])
{
    const double first_unit = unit(x[0], r->lo[0], r->hi[0]),
                 second_unit = r->degree[1] > 0 ? unit(x[1], r->lo[1], r->hi[1]) : 0.0;
    double first = 1.0, by_scale = 0.0;
    size_t n = 0, n_second = r->degree[1] + 1;
    for (size_t i = 0; i <= r->degree[0]; i++) {
        double term = first;
        for (size_t j = 0; j < n_second; j++, term *= second_unit) terms[n++] = term;
        first = r->shape == STATS_POWERS ? first * first_unit
                : i == 0                 ? saturation(r, x[0], &by_scale)
                                         : first_unit;
    }
    if (r->shape == STATS_POWERS) return;
    double term = by_scale;
    terms[n] = 0.0;
    for (size_t j = 0; j < n_second; j++, term *= second_unit)
        terms[n] += r->coefficients[n_second + j] * term;
}

static size_t n_linear(const stats_response_fit *r)
{
    return (r->degree[0] + 1) * (r->degree[1] + 1);
}

double stats_response_value(const stats_response_fit *r, const double x[], double *variance)
{
    double terms[STATS_MAX_TERMS], value = 0.0;
    terms_at(r, x, terms);
    for (size_t i = 0; i < n_linear(r); i++) value += r->coefficients[i] * terms[i];
    if (!variance) return value;
    *variance = r->discrepancy;
    for (size_t i = 0; i < r->n_terms; i++)
        for (size_t j = 0; j < r->n_terms; j++)
            *variance += terms[i] * terms[j] * r->covariance[i * r->n_terms + j];
    return value;
}

stats_reach stats_calibration_reach(const stats_calibration *c, size_t angle)
{
    enum { SAMPLES = 65 };
    const size_t rows = c->n_params > 1 ? SAMPLES : 1;
    stats_reach reach = {.angle = {INFINITY, -INFINITY}};
    for (size_t i = 0; i < SAMPLES * rows; i++) {
        const double part[] = {(double)(i % SAMPLES) / (SAMPLES - 1), (double)(i / SAMPLES) / (SAMPLES - 1)};
        double x[STATS_MAX_PARAMS] = {0};
        for (size_t p = 0; p < c->n_params; p++) x[p] = (1.0 - part[p]) * c->lo[p] + part[p] * c->hi[p];
        const double value = stats_response_value(&c->response[angle], x, NULL);
        for (int most = 0; most < 2; most++)
            if (most ? value > reach.angle[1] : value < reach.angle[0]) {
                reach.angle[most] = value;
                memcpy(reach.at[most], x, sizeof x);
            }
    }
    return reach;
}

/* ---- least squares ---- */

typedef struct {
    stats_response_fit *r;
    const stats_calibration *c;
    size_t n;                /* terms */
    double *weights, *y, *X; /* y: at the points */
} problem;

/* Coefficients at the present scale, their covariance (n rows of n) and chi2. */
static rp_status solve_linear(problem *s, double coefficients[STATS_MAX_TERMS])
{
    stats_response_fit *r = s->r;
    double terms[STATS_MAX_TERMS];
    for (size_t g = 0; g < s->c->n_points; g++) {
        terms_at(r, s->c->point[g].x, terms);
        memcpy(s->X + g * s->n, terms, s->n * sizeof *terms);
    }
    stats_linear fit = {s->c->n_points,  s->n,         s->X,         s->y, s->weights,
                        GSL_DBL_EPSILON, coefficients, r->covariance};
    const rp_status status = stats_linear_fit(&fit);
    r->chi2 = fit.chi2;
    return status;
}

static double chi2_of_scale(const double log_scale[], void *data)
{
    problem *s = data;
    s->r->scale = exp(*log_scale);
    return solve_linear(s, s->r->coefficients) ? HUGE_VAL : s->r->chi2;
}

/* The scale is sought from a twentieth of the range to three ranges: beyond these the form is a step or a
 * straight line, and a scale that ends there is not determined. */
static rp_status find_scale(problem *s)
{
    const double range = s->r->hi[0] - s->r->lo[0];
    const double lo[2] = {log(0.05 * range)}, hi[2] = {log(3.0 * range)};
    double at[2], value;
    RP_TRY(stats_least(chi2_of_scale, s, 2, lo, hi, 12, at, &value));
    if (!(isfinite(value) && *at > *lo + 1e-6 && *at < *hi - 1e-6))
        return rp_fail(RP_NO_RESULT, "scale: not determined by the points");
    chi2_of_scale(at, s);
    return RP_OK;
}

/* Errors of the fit: the covariance of all coefficients, the scale among them. */
static void take_errors(problem *s)
{
    stats_response_fit *r = s->r;
    r->n_terms = s->n;
    r->n_points = s->c->n_points;
    r->dof = r->n_points - r->n_terms;
    double n = (double)r->n_points, dof = (double)r->dof;
    r->aic = r->chi2 + 2.0 * (double)r->n_terms;
    r->p_value = gsl_cdf_chisq_Q(r->chi2, dof);
    const double inflation = fmax(1.0, r->chi2 / dof);
    double sum = 0.0;
    for (size_t g = 0; g < r->n_points; g++) sum += s->weights[g];
    r->discrepancy = (inflation - 1.0) * n / sum;
    for (size_t i = 0; i < s->n * s->n; i++) r->covariance[i] *= inflation;
}

rp_status stats_response_solve(stats_response_fit *r, const stats_calibration *c, size_t angle,
                               const double y[])
{
    const bool saturating = r->shape != STATS_POWERS;
    problem s = {.r = r, .c = c, .n = n_linear(r)};
    s.weights = malloc(c->n_points * (s.n + 3) * sizeof *s.weights);
    if (!s.weights) return rp_fail(RP_NO_MEMORY, "calibrate: out of memory");
    s.y = s.weights + c->n_points;
    s.X = s.y + c->n_points;
    for (size_t g = 0; g < c->n_points; g++) {
        s.y[g] = y ? y[g] : c->point[g].mean[angle];
        const double sd = stats_calibration_sd(c, angle, c->point[g].x);
        s.weights[g] = c->point[g].number[angle] / (sd * sd);
    }
    rp_status status = saturating ? find_scale(&s) : solve_linear(&s, r->coefficients);
    s.n += saturating; /* the same minimum, with the scale as one more term */
    if (!status && saturating) status = solve_linear(&s, (double[STATS_MAX_TERMS]){0.0});
    if (!status) take_errors(&s);
    free(s.weights);
    return status;
}

/* ---- choice of the form ---- */

/* In the first parameter; with two parameters it is not tested. */
static bool is_monotone(const stats_response_fit *r)
{
    const int n = r->degree[1] == 0 ? 200 : 0;
    bool up = true, down = true;
    double last = 0.0;
    for (int i = 0; i <= n && n > 0; i++) {
        double x = r->lo[0] + (r->hi[0] - r->lo[0]) * i / n;
        double value = stats_response_value(r, &x, NULL);
        up = up && (i == 0 || value > last);
        down = down && (i == 0 || value < last);
        last = value;
    }
    return up || down;
}

/* Keep `r` where it is better than what is there. */
static void consider(const stats_response_fit *r, stats_response_fit *best, stats_response_fit *best_monotone)
{
    if (r->aic < best->aic) *best = *r;
    if (r->monotone && r->aic < best_monotone->aic) *best_monotone = *r;
}

static rp_status choose_form(stats_calibration *c, size_t angle)
{
    stats_response_fit blank = {.aic = HUGE_VAL};
    memcpy(blank.lo, c->lo, sizeof blank.lo);
    memcpy(blank.hi, c->hi, sizeof blank.hi);
    stats_response_fit best = blank, best_monotone = blank;
    for (int shape = STATS_POWERS; shape <= STATS_TANH; shape++)
        for (size_t i = 1; i <= (shape == STATS_POWERS ? 4 : 2); i++)
            for (size_t j = c->n_params - 1; j <= 2 * (c->n_params - 1); j++) {
                stats_response_fit r = blank;
                r.shape = (stats_shape)shape;
                r.degree[0] = i;
                r.degree[1] = j;
                if (n_linear(&r) + (shape != STATS_POWERS) + 2 > c->n_points)
                    continue; /* a point at least beyond those that any form meets */
                rp_status status = stats_response_solve(&r, c, angle, NULL);
                if (status == RP_NO_RESULT) continue;
                if (status) return status;
                r.monotone = is_monotone(&r);
                consider(&r, &best, &best_monotone);
            }
    c->response[angle] = best_monotone.aic <= best.aic + monotone_credit ? best_monotone : best;
    return RP_OK;
}

rp_status stats_calibration_fit(const stats_ensemble *piles, stats_calibration *c)
{
    RP_TRY(make_points(piles, c));
    if (c->n_points < 4 * c->n_params)
        return rp_fail(RP_BAD_INPUT, "%zu points with piles, at least %zu needed for a response", c->n_points,
                       4 * c->n_params);
    RP_TRY(check_spread(c));
    RP_TRY(check_rectangle(c));
    for (size_t a = 0; a < c->n_angles; a++) {
        RP_TRY(fit_scatter(c, a));
        RP_TRY(choose_form(c, a));
    }
    return RP_OK;
}
