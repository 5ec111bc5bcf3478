/* Straight lines through points, and least squares by columns; see stats.h. */
#include "core/arena.h"

#include <gsl/gsl_cdf.h>
#include <math.h>
#include <string.h>

#include "stats/stats.h"

static const char TOO_LARGE[] = "no line: numbers so large or small that their squares overflow";

static rp_status check_points(const stats_xy *p, bool origin)
{
    const double other = origin || p->n == 0 ? 0.0 : p->x[0], round_off = 1e-12 * fabs(other);
    bool spread = false;
    double x = 0.0, y = 0.0;
    for (size_t i = 0; i < p->n; i++) {
        if (!isfinite(p->x[i]) || !isfinite(p->y[i]))
            return rp_fail(RP_BAD_INPUT, "point %zu: (%g, %g): finite numbers expected", i + 1, p->x[i],
                           p->y[i]);
        if (p->se && !(p->se[i] > 0.0 && isfinite(p->se[i])))
            return rp_fail(RP_BAD_INPUT, "point %zu: standard error = %g: out of range, allowed: (0, inf)",
                           i + 1, p->se[i]);
        spread = spread || fabs(p->x[i] - other) > round_off;
        x = fmax(x, fabs(p->x[i])), y = fmax(y, fabs(p->y[i]));
    }
    const double large = 1e130; /* differences of numbers of its inverse still have exact squares */
    if (fmax(x, y) > large || (x > 0.0 && x < 1.0 / large) || (y > 0.0 && y < 1.0 / large))
        return rp_fail(RP_NO_RESULT, TOO_LARGE);
    if (spread) return RP_OK; /* two different x are two points */
    return rp_fail(RP_NO_RESULT, "no line: %zu points without %s", p->n,
                   origin ? "an x other than 0" : "two different x");
}

static double weight(const stats_xy *p, size_t i)
{
    return p->se ? 1.0 / (p->se[i] * p->se[i]) : 1.0;
}

/* By running means, in the order of GSL's fit, whose builds for some processors fuse products and sums. */
rp_status stats_line_fit(const stats_xy *p, bool origin, stats_line *line)
{
    const size_t n = p->n;
    *line = (stats_line){n, 0, NAN, NAN, NAN, NAN, NAN, NAN, NAN};
    RP_TRY(check_points(p, origin));
    double x = 0.0, y = 0.0, xx = 0.0, xy = 0.0,
           sum; /* weighted means of x, y; then of products about these */
    sum = 0.0;
    for (size_t i = 0; i < n; i++) {
        const double w = weight(p, i), share = w / (sum += w);
        x += (p->x[i] - x) * share;
        y += (p->y[i] - y) * share;
    }
    sum = 0.0;
    for (size_t i = 0; i < n; i++) {
        const double w = weight(p, i), share = w / (sum += w), dx = p->x[i] - x, dy = p->y[i] - y;
        xx += (dx * dx - xx) * share;
        xy += (dx * dy - xy) * share;
    }
    const double along = origin ? x * x + xx : xx, slope = (origin ? x * y + xy : xy) / along;
    line->slope = slope;
    line->intercept = origin ? 0.0 : y - x * slope;
    line->chi2 = 0.0;
    for (size_t i = 0; i < n; i++) {
        const double left = (origin ? y - slope * x : 0.0) + (p->y[i] - y - slope * (p->x[i] - x));
        line->chi2 += weight(p, i) * (left * left);
    }
    line->dof = n - (origin ? 1 : 2);
    const double scale = p->se ? 1.0 : line->dof > 0 ? line->chi2 / (double)line->dof : NAN;
    line->covariance = origin ? 0.0 : -x / (sum * xx) * scale;
    line->slope_se = sqrt(1.0 / (sum * along) * scale);
    line->intercept_se = origin ? 0.0 : sqrt(1.0 / sum * (1.0 + x * x / xx) * scale);
    line->p_value = p->se && line->dof > 0 ? gsl_cdf_chisq_Q(line->chi2, (double)line->dof) : NAN;
    if (isfinite(line->slope + line->intercept + line->chi2)) return RP_OK;
    return rp_fail(RP_NO_RESULT, TOO_LARGE);
}

static double product(size_t n, const double a[], const double b[])
{
    double sum = 0.0;
    for (size_t i = 0; i < n; i++) sum += a[i] * b[i];
    return sum;
}

/* By Gram and Schmidt's modified scheme: y, too, becomes what the columns before it leave. A column of which
 * these leave nothing has the coefficient 0. */
rp_status stats_linear_fit(stats_linear *f)
{
    if (f->p < 1 || f->p > f->n || !(f->tolerance > 0.0))
        return rp_fail(RP_BAD_INPUT,
                       "least squares: %zu values, %zu columns, tolerance %g: 1 <= columns <= values "
                       "and a tolerance above 0 expected",
                       f->n, f->p, f->tolerance);
    RP_TRY(stats_check_finite(f->n * f->p, f->X));
    RP_TRY(stats_check_finite(f->n, f->y));
    RP_SCOPE(arena);
    const size_t n = f->n, p = f->p;
    double *Q, *R, *own, *power;
    RP_NEW(&arena, Q, (p + 1) * n); /* its rows are X's columns, and y */
    RP_NEW(&arena, R, (p + 1) * (p + 1));
    RP_NEW(&arena, own, p + 1); /* a row of R's inverse */
    RP_NEW(&arena, power, p + 1);
    f->rank = 0;
    for (size_t j = 0; j <= p; j++) {
        double *q = &Q[j * n];
        for (size_t i = 0; i < n; i++)
            q[i] = (f->w ? sqrt(f->w[i]) : 1.0) * (j < p ? f->X[i * p + j] : f->y[i]);
        const double whole = product(n, q, q);
        for (size_t k = 0; k < j; k++) {
            if (!(power[k] > 0.0)) continue;
            const double part = R[k * (p + 1) + j] = product(n, q, &Q[k * n]) / power[k];
            for (size_t i = 0; i < n; i++) q[i] -= part * Q[k * n + i];
        }
        power[j] = product(n, q, q);
        if (j < p && !(power[j] > f->tolerance * f->tolerance * whole)) power[j] = 0.0;
        f->rank += j < p && power[j] > 0.0;
    }
    f->chi2 = power[p];
    memset(f->c, 0, p * sizeof *f->c), memset(f->covariance, 0, p * p * sizeof *f->c);
    const double scale = f->w ? 1.0 : f->chi2 / (double)(n - f->rank);
    for (size_t k = 0; k < p; k++) {
        if (!(power[k] > 0.0)) continue;
        own[k] = 1.0;
        for (size_t i = k; i-- > 0;) {
            own[i] = 0.0;
            for (size_t l = i + 1; l <= k && power[i] > 0.0; l++) own[i] -= R[i * (p + 1) + l] * own[l];
        }
        for (size_t i = 0; i <= k; i++) {
            f->c[i] += own[i] * R[k * (p + 1) + p];
            for (size_t j = 0; j <= k; j++) f->covariance[i * p + j] += own[i] * own[j] / power[k] * scale;
        }
    }
    return RP_OK;
}
