/* Statistics of an ensemble: moments, bootstrap, straight lines; see angle.h. */
#include <gsl/gsl_cdf.h>
#include <gsl/gsl_sort.h>
#include <gsl/gsl_statistics_double.h>
#include <math.h>

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

rp_status stats_bootstrap(size_t n, const double v[], double level, size_t n_resamples, gsl_rng *rng,
                          double means[], double *lo, double *hi)
{
    *lo = *hi = NAN;
    rp_status status = check_values(n, v);
    if (status) return status;
    if (!(level > 0.0 && level < 1.0))
        return rp_fail(RP_BAD_INPUT, "level = %g: out of range, allowed: (0, 1)", level);
    if (n_resamples < 2)
        return rp_fail(RP_BAD_INPUT, "resamples = %zu: out of range, allowed: [2, inf)", n_resamples);
    if (n == 1) return RP_OK;
    for (size_t k = 0; k < n_resamples; k++) {
        double sum = 0.0;
        for (size_t i = 0; i < n; i++) sum += v[gsl_rng_uniform_int(rng, n)] - v[0];
        means[k] = v[0] + sum / (double)n;
    }
    gsl_sort(means, 1, n_resamples);
    *lo = gsl_stats_quantile_from_sorted_data(means, 1, n_resamples, 0.5 * (1.0 - level));
    *hi = gsl_stats_quantile_from_sorted_data(means, 1, n_resamples, 0.5 * (1.0 + level));
    return RP_OK;
}

static rp_status check_points(size_t n, const double x[], const double y[], const double se[], bool origin)
{
    bool spread = false;
    for (size_t i = 0; i < n; i++) {
        if (!isfinite(x[i]) || !isfinite(y[i]))
            return rp_fail(RP_BAD_INPUT, "point %zu: (%g, %g): finite numbers expected", i + 1, x[i], y[i]);
        if (!(se[i] > 0.0 && isfinite(se[i])))
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
    double sw = 0.0, x_mean = 0.0, y_mean = 0.0, sxx = 0.0, sxy = 0.0, chi2 = 0.0;
    for (size_t i = 0; i < n; i++) sw += 1.0 / (se[i] * se[i]);
    for (size_t i = 0; i < n && !origin; i++) {
        x_mean += x[i] / (se[i] * se[i] * sw);
        y_mean += y[i] / (se[i] * se[i] * sw);
    }
    for (size_t i = 0; i < n; i++) {
        double dx = (x[i] - x_mean) / se[i];
        sxx += dx * dx;
        sxy += dx * (y[i] - y_mean) / se[i];
    }
    double slope = sxy / sxx;
    for (size_t i = 0; i < n; i++) {
        double rest = (y[i] - y_mean - slope * (x[i] - x_mean)) / se[i];
        chi2 += rest * rest;
    }
    line->dof = n - (origin ? 1 : 2);
    line->slope = slope;
    line->slope_se = sqrt(1.0 / sxx);
    line->intercept = origin ? 0.0 : y_mean - slope * x_mean;
    line->intercept_se = origin ? 0.0 : sqrt(1.0 / sw + x_mean * x_mean / sxx);
    line->covariance = origin ? 0.0 : -x_mean / sxx;
    line->chi2 = chi2;
    line->p_value = line->dof > 0 ? gsl_cdf_chisq_Q(chi2, (double)line->dof) : NAN;
    return RP_OK;
}
