/* Moments of an ensemble, correlation, spread of resamples; see stats.h. */
#include <gsl/gsl_cdf.h>
#include <gsl/gsl_sort.h>
#include <gsl/gsl_statistics_double.h>
#include <math.h>

#include "stats/stats.h"

static const double confidence = 0.95;
/* of a standard deviation: sums of its squares are still exact, and those of its inverse finite */
static const double SMALL = 1e-145;

rp_status stats_check_finite(size_t n, const double v[])
{
    for (size_t i = 0; i < n; i++)
        if (!isfinite(v[i])) return rp_fail(RP_BAD_INPUT, "value %zu = %g: not finite", i + 1, v[i]);
    return RP_OK;
}

double stats_unit(double most)
{
    return most > 0.0 && isfinite(most) ? ldexp(1.0, ilogb(most)) : 1.0;
}

/* Errors of a mean from the squares about it, in a unit. */
static void set_errors(double squares, double unit, stats_summary *stats)
{
    const double n = (double)stats->n;
    stats->sd = sqrt(squares / (n - 1.0)) * unit;
    stats->se = stats->sd / sqrt(n);
    const double half = gsl_cdf_tdist_Qinv(0.5 * (1.0 - confidence), n - 1.0) * stats->se;
    stats->lo = stats->mean - half;
    stats->hi = stats->mean + half;
}

/* Sums are taken about the first value, so that equal values have no spread at all. */
rp_status stats_paired(size_t n, const double a[], double factor, const double b[], stats_summary *stats)
{
    *stats = (stats_summary){n, NAN, NAN, NAN, NAN, NAN};
    if (n == 0) return rp_fail(RP_NO_RESULT, "no values");
    RP_TRY(stats_check_finite(n, a));
    if (b) RP_TRY(stats_check_finite(n, b));
    double first = a[0] + (b ? factor * b[0] : 0.0), sum = 0.0, squares = 0.0, most = 0.0;
    for (size_t i = 0; i < n; i++) sum += a[i] + (b ? factor * b[i] : 0.0) - first;
    const double mean = first + sum / (double)n;
    for (size_t i = 0; i < n; i++) most = fmax(most, fabs(a[i] + (b ? factor * b[i] : 0.0) - mean));
    if (!isfinite(sum) || !isfinite(most))
        return rp_fail(RP_NO_RESULT, "values so large that their sum overflows");
    stats->mean = mean;
    if (n == 1) return RP_OK;
    const double unit = stats_unit(most);
    for (size_t i = 0; i < n; i++) {
        double d = (a[i] + (b ? factor * b[i] : 0.0) - mean) / unit;
        squares += d * d;
    }
    set_errors(squares, unit, stats);
    return RP_OK;
}

stats_summary stats_pooled(size_t n, const stats_summary parts[])
{
    stats_summary all = {0, NAN, NAN, NAN, NAN, NAN};
    double sum = 0.0, squares = 0.0;
    for (size_t i = 0; i < n; i++) {
        all.n += parts[i].n;
        sum += (double)parts[i].n * parts[i].mean;
    }
    all.mean = sum / (double)all.n;
    for (size_t i = 0; i < n; i++) {
        const double d = parts[i].mean - all.mean, own = parts[i].n > 1 ? parts[i].sd : 0.0;
        squares += ((double)parts[i].n - 1.0) * own * own + (double)parts[i].n * d * d;
    }
    if (all.n > 1) set_errors(squares, 1.0, &all);
    return all;
}

rp_status stats_mean(size_t n, const double v[], stats_summary *stats)
{
    return stats_paired(n, v, NAN, NULL, stats);
}

rp_status stats_correlate(size_t n, const double x[], const double y[], stats_correlation *c)
{
    const double quantile = 1.959963984540054, m = (double)n; /* normal, 97.5 % */
    *c = (stats_correlation){n, NAN, NAN, NAN, NAN};
    if (n < 4) return rp_fail(RP_NO_RESULT, "%zu values, at least 4 needed", n);
    stats_summary of[2];
    RP_TRY(stats_mean(n, x, &of[0]));
    RP_TRY(stats_mean(n, y, &of[1]));
    const double r = gsl_stats_correlation(x, 1, y, 1, n), least = fmin(of[0].sd, of[1].sd);
    if (isnan(r) || least < SMALL || fmax(of[0].sd, of[1].sd) > 1.0 / SMALL)
        return rp_fail(RP_NO_RESULT, "no correlation: a column whose values are all equal, or overflow");
    c->value = fmax(-1.0, fmin(1.0, r)); /* round-off of values on a line */
    c->se = (1.0 - c->value * c->value) / sqrt(m - 1.0);
    const double z = atanh(c->value), half = quantile / sqrt(m - 3.0);
    c->lo = tanh(z - half);
    c->hi = tanh(z + half);
    return RP_OK;
}

double stats_resampled(size_t n, double sample[], size_t *used)
{
    size_t found = 0;
    for (size_t k = 0; k < n; k++)
        if (!isnan(sample[k])) sample[found++] = sample[k];
    *used = found;
    if (found < 2) return NAN;
    gsl_sort(sample, 1, found);
    return gsl_stats_sd(sample, 1, found);
}
