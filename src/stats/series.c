/* Statistics of one series in time, whose values are correlated; see stats.h. */
#include <gsl/gsl_math.h>
#include <math.h>
#include <string.h>

#include "stats/stats.h"

/* Fewest blocks from which a variance is taken: its relative error is then 0.8. Below FEW of them it is
 * widened. Fewest values, and independent ones: of fewer, where a plateau is met, it is met by chance. */
static const size_t LEAST_BLOCKS = 4, LEAST_VALUES = 16, FEW = 20;

/* Correlation of neighbours. */
static double neighbours(const double v[], const stats_summary *of)
{
    double sum = 0.0;
    for (size_t i = 1; i < of->n && of->sd > 0.0; i++)
        sum += (v[i - 1] - of->mean) / of->sd * ((v[i] - of->mean) / of->sd);
    return sum / (double)(of->n - 1);
}

rp_status stats_blocking(size_t n, const double v[], double work[], stats_series *series)
{
    *series = (stats_series){n, NAN, NAN, NAN, NAN, NAN, 0};
    const double count = (double)n;
    stats_summary all, means;
    RP_TRY(stats_mean(n, v, &all));
    series->mean = all.mean;
    series->sd = all.sd;
    if (n < LEAST_VALUES) return rp_fail(RP_NO_RESULT, "%zu values: at least %zu needed", n, LEAST_VALUES);
    memcpy(work, v, n * sizeof *work);
    rp_status status = RP_OK;
    double block = 1.0, most = 0.0; /* of the ratios of variances that correlations of neighbours tell */
    for (size_t blocks = n; !status && blocks >= LEAST_BLOCKS; block *= 2.0) {
        status = stats_mean(blocks, work, &means);
        double ratio = all.se > 0.0 ? gsl_pow_2(means.se / all.se) : 1.0;
        if (blocks >= LEAST_VALUES) {
            const double r = neighbours(work, &means);
            most = fmax(most, ratio * (1.0 + r) / (1.0 - r));
            if (count < (double)LEAST_VALUES * most) break;
        }
        if (block * block * block > 2.0 * count * ratio * ratio) {
            if (blocks < FEW) ratio = fmax(ratio, most);
            series->se = blocks < FEW ? fmax(means.se, all.se * sqrt(most)) : means.se;
            series->se_error = series->se / sqrt(2.0 * (double)(blocks - 1));
            series->tau = 0.5 * ratio;
            series->block = (size_t)block;
            return RP_OK;
        }
        blocks /= 2; /* an odd one at the end is left out */
        for (size_t i = 0; i < blocks; i++) work[i] = 0.5 * work[2 * i] + 0.5 * work[2 * i + 1];
    }
    return status ? status
                  : rp_fail(RP_NO_RESULT,
                            "no plateau: %zu values are too few for their correlation, some %.2g needed", n,
                            fmax((double)LEAST_VALUES * most, 2.0 * count));
}

rp_status stats_level_off(size_t n, const double v[], size_t *from)
{
    *from = 0;
    RP_TRY(stats_check_finite(n, v));
    if (n < LEAST_BLOCKS) return rp_fail(RP_NO_RESULT, "%zu values: at least %zu needed", n, LEAST_BLOCKS);
    /* from the end backwards, mean and scatter of what has been passed (Welford 1962) */
    double most = 0.0;
    for (size_t i = 0; i < n; i++) most = fmax(most, fabs(v[i]));
    const double unit = stats_unit(most);
    double mean = v[n - 1] / unit, squares = 0.0, least = INFINITY;
    for (size_t i = n - 1; i-- > 0;) {
        const double kept = (double)(n - i), value = v[i] / unit, d = value - mean;
        mean += d / kept;
        squares += d * (value - mean);
        if (i > n / 2 || squares / (kept * kept) > least) continue;
        least = squares / (kept * kept);
        *from = i;
    }
    if (*from < n / 2) return RP_OK;
    return rp_fail(RP_NO_RESULT, "the series of %zu values has not levelled off before its second half", n);
}
