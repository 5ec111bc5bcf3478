/* Statistics of one series in time, whose values are correlated; see stats.h. */
#include <math.h>
#include <string.h>

#include "stats/stats.h"

/* Fewest blocks from which a variance is taken: its relative error is then 0.8. */
static const size_t LEAST_BLOCKS = 4;

/* Sum of squares about the mean. Sums are taken about the first value, so that equal values have none. */
static double scatter(size_t n, const double v[], double *mean)
{
    double sum = 0.0, squares = 0.0;
    for (size_t i = 0; i < n; i++) sum += v[i] - v[0];
    *mean = v[0] + sum / (double)n;
    for (size_t i = 0; i < n; i++) squares += (v[i] - *mean) * (v[i] - *mean);
    return squares;
}

rp_status stats_blocking(size_t n, const double v[], double work[], stats_series *series)
{
    *series = (stats_series){n, NAN, NAN, NAN, NAN, NAN, 0};
    rp_status status = stats_check_finite(n, v);
    if (status) return status;
    if (n < LEAST_BLOCKS) return rp_fail(RP_NO_RESULT, "%zu values: at least %zu needed", n, LEAST_BLOCKS);
    const double squares = scatter(n, v, &series->mean), count = (double)n;
    series->sd = sqrt(squares / (count - 1.0));
    memcpy(work, v, n * sizeof *work);
    double block = 1.0;
    for (size_t blocks = n; blocks >= LEAST_BLOCKS; block *= 2.0) {
        double mean, more = (double)(blocks - 1), variance = scatter(blocks, work, &mean);
        variance /= (double)blocks * more;
        double ratio = squares > 0.0 ? variance / (squares / count / (count - 1.0)) : 1.0;
        if (block * block * block > 2.0 * count * ratio * ratio) {
            series->se = sqrt(variance);
            series->se_error = series->se / sqrt(2.0 * more);
            series->tau = 0.5 * ratio;
            series->block = (size_t)block;
            return RP_OK;
        }
        blocks /= 2; /* an odd one at the end is left out */
        for (size_t i = 0; i < blocks; i++) work[i] = 0.5 * (work[2 * i] + work[2 * i + 1]);
    }
    return rp_fail(RP_NO_RESULT, "no plateau: %zu values are too few for their correlation", n);
}

rp_status stats_level_off(size_t n, const double v[], size_t *from)
{
    *from = 0;
    rp_status status = stats_check_finite(n, v);
    if (status) return status;
    if (n < LEAST_BLOCKS) return rp_fail(RP_NO_RESULT, "%zu values: at least %zu needed", n, LEAST_BLOCKS);
    /* from the end backwards, mean and scatter of what has been passed (Welford 1962) */
    double mean = 0.0, squares = 0.0, least = INFINITY;
    for (size_t i = n; i-- > 0;) {
        const double kept = (double)(n - i), d = v[i] - mean;
        mean += d / kept;
        squares += d * (v[i] - mean);
        if (i > n / 2 || squares / (kept * kept) > least) continue;
        least = squares / (kept * kept);
        *from = i;
    }
    return *from < n / 2 ? RP_OK
                         : rp_fail(RP_NO_RESULT,
                                   "the series of %zu values has not levelled off before its "
                                   "second half",
                                   n);
}
