/* Limit of infinite size with a free exponent; see stats.h. For a given exponent p the model is a straight
 * line in x^-p, so that only p is searched for. */
#include <gsl/gsl_cdf.h>
#include <math.h>
#include <stdlib.h>

#include "stats/stats.h"

/* Exponents that are tried. Below the least of them x^-p is a logarithm within the errors of any table; above
 * the largest, a step between the two smallest of sizes that differ by a half. */
static const double least_tried = 0.005, largest_tried = 8.0;
enum { TRIED = 400 };

typedef struct {
    double x, y, se;
} mean_at;

typedef struct {
    size_t n;
    double dof;             /* of the errors: of the smallest ensemble, on the safe side */
    double *x, *y, *se, *u; /* of the means; u is what the line is straight in */
    double from, to;        /* exponents */
    bool logarithm;         /* p may be 0, where the line is straight in log x */
    double p[TRIED];
    stats_line lines[TRIED], at_zero;
    double least; /* chi2 of the best fit */
    rp_status status;
} search;

static rp_status fit_line(search *s, double p, stats_line *line)
{
    for (size_t i = 0; i < s->n; i++) s->u[i] = p > 0.0 ? pow(s->x[i] / s->x[0], -p) : log(s->x[i]);
    return stats_line_fit(&(stats_xy){s->n, s->u, s->y, s->se}, false, line);
}

static double chi2_of(const double p[], void *data)
{
    search *s = data;
    stats_line line;
    const rp_status status = fit_line(s, p[0], &line);
    if (status) s->status = status;
    return status ? HUGE_VAL : line.chi2;
}

static int by_x(const void *a, const void *b)
{
    const mean_at *p = a, *q = b;
    return (p->x > q->x) - (p->x < q->x);
}

/* The mean at each x, with its error. points[n] is sorted, work[n] is work space. */
static rp_status find_means(size_t n, mean_at points[], double work[], search *s)
{
    s->dof = INFINITY;
    qsort(points, n, sizeof *points, by_x);
    for (size_t first = 0, k; first < n; first += k) {
        stats_summary mean;
        for (k = 0; first + k < n && points[first + k].x == points[first].x; k++)
            work[k] = points[first + k].y;
        RP_TRY(stats_mean(k, work, &mean));
        if (k < 2)
            return rp_fail(RP_NO_RESULT, "no limit: one value at x = %g, two needed for its error",
                           points[first].x);
        s->x[s->n] = points[first].x;
        s->y[s->n] = mean.mean;
        s->se[s->n++] = mean.se;
        s->dof = fmin(s->dof, (double)k - 1.0);
    }
    if (s->n < 3) return rp_fail(RP_NO_RESULT, "no limit: %zu different x, at least 3 needed", s->n);
    return RP_OK;
}

static rp_status try_exponents(search *s)
{
    const double ratio = pow(s->to / s->from, 1.0 / (TRIED - 1));
    s->least = HUGE_VAL;
    for (int k = 0; k < TRIED; k++) {
        s->p[k] = s->from * pow(ratio, k);
        RP_TRY(fit_line(s, s->p[k], &s->lines[k]));
        s->least = fmin(s->least, s->lines[k].chi2);
    }
    return fit_line(s, 0.0, &s->at_zero);
}

/* The limits L whose chi2, at the best p for each, exceeds the least by no more than the square of Student's
 * t. Of a line, chi2 grows by ((L - intercept)/error)^2. */
static void find_interval(const search *s, double t, double *lo, double *hi, stats_limit *limit)
{
    const double most = s->least + t * t;
    *lo = INFINITY, *hi = -INFINITY;
    limit->exponent_lo = INFINITY, limit->exponent_hi = -INFINITY;
    for (int k = 0; k < TRIED; k++) {
        const stats_line *l = &s->lines[k];
        if (l->chi2 > most) continue;
        const double half = l->intercept_se * sqrt(most - l->chi2);
        *lo = fmin(*lo, l->intercept - half);
        *hi = fmax(*hi, l->intercept + half);
        /* the truth may lie up to the next exponent, which is refused */
        limit->exponent_lo = fmin(limit->exponent_lo, s->p[k > 0 ? k - 1 : 0]);
        limit->exponent_hi = fmax(limit->exponent_hi, k < TRIED - 1 ? s->p[k + 1] : INFINITY);
    }
    if (!s->logarithm || s->at_zero.chi2 > most) return;
    const double half = s->at_zero.slope_se * sqrt(most - s->at_zero.chi2);
    limit->exponent_lo = 0.0;
    if (s->at_zero.slope - half < 0.0) *lo = -INFINITY;
    if (s->at_zero.slope + half > 0.0) *hi = INFINITY;
}

/* Chance of a limit as far from 0 if it is 0. */
static double chance_of_zero(const search *s)
{
    double least = HUGE_VAL;
    for (int k = 0; k < TRIED; k++) {
        const double z = s->lines[k].intercept / s->lines[k].intercept_se;
        least = fmin(least, s->lines[k].chi2 + z * z);
    }
    return 2.0 * gsl_cdf_tdist_Q(sqrt(fmax(0.0, least - s->least)), s->dof);
}

static rp_status find_limit(search *s, stats_limit *limit)
{
    double p[2], value;
    stats_line line;
    const double lo[2] = {s->from, 0.0}, hi[2] = {s->to, 0.0};
    RP_TRY(try_exponents(s));
    RP_TRY(stats_least(chi2_of, s, lo, hi, TRIED, p, &value));
    RP_TRY(s->status);
    RP_TRY(fit_line(s, p[0], &line));
    s->least = fmin(s->least, value);
    limit->exponent = p[0];
    limit->limit = line.intercept;
    limit->c = line.slope * pow(s->x[0], p[0]);
    if (s->logarithm && s->at_zero.chi2 <= s->least) {
        s->least = s->at_zero.chi2;
        limit->exponent = 0.0;
        limit->limit = s->at_zero.slope < 0.0 ? -INFINITY : INFINITY;
        limit->c = NAN;
    }
    limit->chi2 = s->least;
    limit->p_fit = s->n > 3 ? gsl_cdf_chisq_Q(s->least, (double)s->n - 3.0) : NAN;
    limit->p_value = chance_of_zero(s);
    const double t = gsl_cdf_tdist_Qinv(0.025, s->dof);
    find_interval(s, gsl_cdf_tdist_Qinv(0.05, s->dof), &limit->lo90, &limit->hi90, limit);
    find_interval(s, t, &limit->lo, &limit->hi, limit);
    const double half = fmax(limit->hi - limit->limit, limit->limit - limit->lo);
    limit->se = isfinite(half) ? half / t : NAN;
    return RP_OK;
}

rp_status stats_limit_fit(size_t n, const double x[], const double y[], double least_exponent,
                          stats_limit *limit)
{
    *limit =
        (stats_limit){n, 0, NAN, NAN, NAN, NAN, NAN, NAN, NAN, NAN, NAN, NAN, NAN, NAN, NAN, NAN, NAN, NAN};
    if (!(least_exponent >= 0.0 && least_exponent < largest_tried))
        return rp_fail(RP_BAD_INPUT, "least exponent = %g: out of range, allowed: [0, %g)", least_exponent,
                       largest_tried);
    search *s = calloc(1, sizeof *s);
    mean_at *points = calloc(n + 1, sizeof *points);
    double *work = calloc(5 * n + 1, sizeof *work);
    rp_status status = s && points && work ? RP_OK : rp_fail(RP_NO_MEMORY, "limit: out of memory");
    for (size_t i = 0; i < n && !status; i++) {
        points[i] = (mean_at){x[i], y[i], 0.0};
        if (!(x[i] > 0.0 && isfinite(x[i]) && isfinite(y[i])))
            status = rp_fail(RP_BAD_INPUT, "value %zu: (%g, %g): finite numbers and x > 0 expected", i + 1,
                             x[i], y[i]);
    }
    if (!status) {
        s->x = work + n, s->y = work + 2 * n, s->se = work + 3 * n, s->u = work + 4 * n;
        s->from = fmax(least_exponent, least_tried);
        s->to = largest_tried;
        s->logarithm = least_exponent == 0.0;
        status = find_means(n, points, work, s);
        if (!status) status = find_limit(s, limit);
        limit->n_x = s->n;
        limit->from = s->n ? s->x[0] : NAN;
        limit->to = s->n ? s->x[s->n - 1] : NAN;
        limit->dof = s->dof;
    }
    free(s);
    free(points);
    free(work);
    return status;
}
