/* Pressure on the base of piles; see stress.h. */
#include "stress/stress.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>

typedef struct {
    double distance, N;
} load;

static int by_distance(const void *a, const void *b)
{
    const double p = ((const load *)a)->distance, q = ((const load *)b)->distance;
    return (p > q) - (p < q);
}

/* Twice the distance from the centroid within which 98 % of the load is. */
static rp_status base_width(size_t n, const double x[], const double N[], double total, stress_base *base)
{
    load *loads = malloc(n * sizeof *loads);
    if (!loads) return rp_fail(RP_NO_MEMORY, "base: out of memory");
    for (size_t i = 0; i < n; i++) loads[i] = (load){fabs(x[i] - base->centroid), N[i]};
    qsort(loads, n, sizeof *loads, by_distance);
    double sum = 0.0;
    for (size_t i = 0; i < n && sum < 0.98 * total; i++) {
        sum += loads[i].N;
        base->width = 2.0 * loads[i].distance;
    }
    free(loads);
    return RP_OK;
}

rp_status stress_base_profile(size_t n, const double x[], const double r[], const double N[],
                              stress_base *base)
{
    double total = 0.0, moment = 0.0;
    *base = (stress_base){0};
    for (size_t i = 0; i < n; i++) {
        total += N[i];
        moment += N[i] * x[i];
    }
    if (!(total > 0.0)) return rp_fail(RP_NO_RESULT, "base: no load on it");
    base->centroid = moment / total;
    rp_status status = base_width(n, x, N, total, base);
    if (status) return status;
    if (!(base->width > 0.0)) return rp_fail(RP_NO_RESULT, "base: all the load is at one position");
    stress_base_bins(base, n, x, r, N, base->N);
    return RP_OK;
}

void stress_base_bins(const stress_base *base, size_t n, const double x[], const double r[], const double N[],
                      double bins[STRESS_DIP_BINS])
{
    const double bin = base->width / STRESS_DIP_BINS, left = base->centroid - 0.5 * base->width;
    double inside = 0.0;
    for (int k = 0; k < STRESS_DIP_BINS; k++) bins[k] = 0.0;
    for (size_t i = 0; i < n; i++)
        for (int k = 0; k < STRESS_DIP_BINS; k++) {
            const double lo = fmax(x[i] - r[i], left + k * bin), hi = fmin(x[i] + r[i], left + (k + 1) * bin);
            if (hi > lo) bins[k] += N[i] * (hi - lo) / (2.0 * r[i]);
        }
    for (int k = 0; k < STRESS_DIP_BINS; k++) inside += bins[k];
    for (int k = 0; k < STRESS_DIP_BINS; k++) bins[k] *= STRESS_DIP_BINS / inside;
}

enum { HALF = STRESS_DIP_BINS / 2, BINS_01 = 2, BINS_02 = 4, BINS_03 = 6 }; /* 0.1 B is two bins, and so on */

/* Mean over the bins from number `from` to before `to`, counted outwards, of both sides. */
static double mean_between(const double N[STRESS_DIP_BINS], int from, int to)
{
    double sum = 0.0;
    for (int k = HALF - to; k < HALF + to; k++)
        if (k < HALF - from || k >= HALF + from) sum += N[k];
    return sum / (2.0 * (to - from));
}

static double mean_load(const double N[STRESS_DIP_BINS])
{
    double mean = 0.0;
    for (int k = 0; k < STRESS_DIP_BINS; k++) mean += N[k] / STRESS_DIP_BINS;
    return mean;
}

double stress_dip(const double N[STRESS_DIP_BINS])
{
    return (mean_between(N, 0, BINS_01) - mean_between(N, BINS_01, BINS_03)) / mean_load(N);
}

double stress_middle(const double N[STRESS_DIP_BINS])
{
    return (mean_between(N, 0, BINS_01) - mean_between(N, BINS_01, BINS_02)) / mean_load(N);
}

double stress_excess(const double N[STRESS_DIP_BINS], const double rays[STRESS_DIP_BINS])
{
    return (mean_between(N, 0, BINS_01) - mean_between(rays, 0, BINS_01)) / mean_load(N);
}

/* Mean D of n piles drawn with replacement, each mirrored or not. */
static double resampled_dip(size_t n, const double profiles[], gsl_rng *rng)
{
    double sum[STRESS_DIP_BINS] = {0.0};
    for (size_t i = 0; i < n; i++) {
        const double *N = profiles + STRESS_DIP_BINS * gsl_rng_uniform_int(rng, n);
        const int mirror = gsl_rng_uniform(rng) < 0.5;
        for (int k = 0; k < STRESS_DIP_BINS; k++) sum[k] += N[mirror ? STRESS_DIP_BINS - 1 - k : k];
    }
    return stress_dip(sum);
}

/* Mean pressure from the centroid outwards; work[n]. */
static rp_status mean_profile(size_t n, const double profiles[], double work[], stress_dips *dips)
{
    rp_status status = RP_OK;
    for (int k = 0; k < STRESS_DIP_BINS / 2 && !status; k++) {
        stats_summary stats;
        for (size_t i = 0; i < n; i++) {
            const double *N = profiles + STRESS_DIP_BINS * i;
            work[i] = 0.5 * (N[STRESS_DIP_BINS / 2 - 1 - k] + N[STRESS_DIP_BINS / 2 + k]);
        }
        status = stats_mean(n, work, &stats);
        dips->N[k] = stats.mean;
        dips->N_se[k] = stats.se;
    }
    return status;
}

/* Mean D under the null distribution, in order. */
static void resample(size_t n, const double profiles[], size_t resamples, gsl_rng *rng, double means[],
                     stress_dips *dips)
{
    const double mean = dips->dip.mean;
    double low = 0.0, far = 0.0;
    for (size_t b = 0; b < resamples; b++) {
        means[b] = resampled_dip(n, profiles, rng) - mean;
        low += means[b] <= mean;
        far += fabs(means[b]) >= fabs(mean);
    }
    const stats_spread spread = stats_resampled(resamples, means);
    dips->null_lo = spread.lo;
    dips->null_hi = spread.hi;
    dips->p_dip = (low + 1.0) / ((double)resamples + 1.0);
    dips->p_value = (far + 1.0) / ((double)resamples + 1.0);
}

rp_status stress_dip_ensemble(size_t n, const double profiles[], const double without[], double margin,
                              size_t resamples, gsl_rng *rng, double means[], stress_dips *dips)
{
    *dips = (stress_dips){0};
    if (n < 3) return rp_fail(RP_NO_RESULT, "dip: %zu piles, at least 3 expected", n);
    if (!(margin > 0.0)) return rp_fail(RP_BAD_INPUT, "margin = %g: out of range, allowed: (0, inf)", margin);
    rp_status status = stats_check_resamples(resamples);
    if (status) return status;
    double *excess = malloc(n * (STRESS_DIP_BINS + 1) * sizeof *excess), *work = excess + n * STRESS_DIP_BINS;
    if (!excess) return rp_fail(RP_NO_MEMORY, "dip: out of memory");
    for (size_t i = 0; i < n * STRESS_DIP_BINS; i++)
        excess[i] = profiles[i] + (without ? 1.0 - without[i] : 0.0);
    for (size_t i = 0; i < n; i++) {
        dips->raw += stress_dip(profiles + i * STRESS_DIP_BINS) / (double)n;
        work[i] = stress_dip(excess + i * STRESS_DIP_BINS);
    }
    status = stats_mean(n, work, &dips->dip);
    if (!status) status = mean_profile(n, profiles, work, dips);
    if (!status) {
        resample(n, excess, resamples, rng, means, dips);
        dips->p_margin =
            stats_contrast_p_margin(&(stats_contrast){dips->dip.mean, dips->dip.se, (double)n - 1.0}, margin);
    }
    free(excess);
    return status;
}

const char *stress_dip_word(const stress_dips *d, double level)
{
    const bool differs = d->p_value < level, within = d->p_margin < level;
    if (!differs) return within ? "none_within_margin" : "undecided";
    if (d->dip.mean < 0.0) return within ? "dip_within_margin" : "dip";
    return within ? "peak_within_margin" : "peak";
}
