/* Moments of an ensemble and straight lines; see stats.h. */
#include <gsl/gsl_cdf.h>
#include <gsl/gsl_fit.h>
#include <math.h>
#include <stdlib.h>

#include "stats/stats.h"

static const double confidence = 0.95;

static rp_status check_values(size_t n, const double v[])
{
    if (n == 0) return rp_fail(RP_NO_RESULT, "no values");
    for (size_t i = 0; i < n; i++)
        if (!isfinite(v[i])) return rp_fail(RP_BAD_INPUT, "value %zu = %g: not finite", i + 1, v[i]);
    return RP_OK;
}

/* Sums are taken about the first value, so that equal values have no spread at all. */
rp_status stats_paired(size_t n, const double a[], double factor, const double b[], stats_summary *stats)
{
    *stats = (stats_summary){n, NAN, NAN, NAN, NAN, NAN};
    rp_status status = check_values(n, a);
    if (!status && b) status = check_values(n, b);
    if (status) return status;
    double first = a[0] + (b ? factor * b[0] : 0.0), sum = 0.0, squares = 0.0;
    for (size_t i = 0; i < n; i++) sum += a[i] + (b ? factor * b[i] : 0.0) - first;
    stats->mean = first + sum / (double)n;
    if (n == 1) return RP_OK;
    for (size_t i = 0; i < n; i++) {
        double d = a[i] + (b ? factor * b[i] : 0.0) - stats->mean;
        squares += d * d;
    }
    stats->sd = sqrt(squares / (double)(n - 1));
    stats->se = stats->sd / sqrt((double)n);
    double half = gsl_cdf_tdist_Qinv(0.5 * (1.0 - confidence), (double)(n - 1)) * stats->se;
    stats->lo = stats->mean - half;
    stats->hi = stats->mean + half;
    return RP_OK;
}

rp_status stats_mean(size_t n, const double v[], stats_summary *stats)
{
    return stats_paired(n, v, 0.0, NULL, stats);
}

static rp_status check_points(size_t n, const double x[], const double y[], const double se[], bool origin)
{
    bool spread = false;
    for (size_t i = 0; i < n; i++) {
        if (!isfinite(x[i]) || !isfinite(y[i]))
            return rp_fail(RP_BAD_INPUT, "point %zu: (%g, %g): finite numbers expected", i + 1, x[i], y[i]);
        if (se && !(se[i] > 0.0 && isfinite(se[i])))
            return rp_fail(RP_BAD_INPUT, "point %zu: standard error = %g: out of range, allowed: (0, inf)",
                           i + 1, se[i]);
        spread = spread || x[i] != (origin ? 0.0 : x[0]);
    }
    if (spread) return RP_OK; /* two different x are two points */
    return rp_fail(RP_NO_RESULT, "no line: %zu points without %s", n,
                   origin ? "an x other than 0" : "two different x");
}

rp_status stats_line_fit(size_t n, const double x[], const double y[], const double se[], bool origin,
                         stats_line *line)
{
    *line = (stats_line){n, 0, NAN, NAN, NAN, NAN, NAN, NAN, NAN};
    rp_status status = check_points(n, x, y, se, origin);
    if (status) return status;
    double *w = malloc(n * sizeof *w), variance = 0.0, slope_variance;
    if (!w) return rp_fail(RP_NO_MEMORY, "line: out of memory");
    for (size_t i = 0; i < n; i++) w[i] = se ? 1.0 / (se[i] * se[i]) : 1.0;
    line->intercept = line->covariance = 0.0;
    if (origin)
        gsl_fit_wmul(x, 1, w, 1, y, 1, n, &line->slope, &slope_variance, &line->chi2);
    else
        gsl_fit_wlinear(x, 1, w, 1, y, 1, n, &line->intercept, &line->slope, &variance, &line->covariance,
                        &slope_variance, &line->chi2);
    free(w);
    line->dof = n - (origin ? 1 : 2);
    const double scale = se ? 1.0 : line->dof > 0 ? line->chi2 / (double)line->dof : NAN;
    line->covariance *= scale;
    line->slope_se = sqrt(slope_variance * scale);
    line->intercept_se = origin ? 0.0 : sqrt(variance * scale);
    line->p_value = se && line->dof > 0 ? gsl_cdf_chisq_Q(line->chi2, (double)line->dof) : NAN;
    return RP_OK;
}
