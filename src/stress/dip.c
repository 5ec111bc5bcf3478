/* Pressure on the base of piles; see stress.h. */
#include "stress/stress.h"

#include <gsl/gsl_sort.h>
#include <gsl/gsl_statistics_double.h>
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
    RP_TRY(base_width(n, x, N, total, base));
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

/* ---- ensembles ---- */

/* What an ensemble knows of its piles, a column each: mean pressure of both sides, from the middle outwards;
 * its rise from within 0.1 B to each bin up to 0.3 B; the excess; the middle against its neighbours, the same
 * of the difference between the sides, and the noise that follows from that difference. */
enum {
    RISE = HALF,
    RISES = BINS_03 - BINS_01,
    EXCESS = RISE + RISES,
    MIDDLE,
    N_SUMMARIES,
    SIDES = N_SUMMARIES,
    NOISE,
    N_COLUMNS
};

typedef struct {
    size_t n;
    double *v; /* [N_COLUMNS][n] */
    stats_summary stats[N_SUMMARIES];
} ensemble;

/* The half difference of the sides has the noise of their mean: the sides of a pile are alike but for noise.
 * Blocks of 0.1 B up to 0.4 B; the middle against its neighbours is the difference of two of them. */
static void add_pile(ensemble *e, size_t i, const double N[STRESS_DIP_BINS], double excess)
{
    enum { BLOCKS = 4, BLOCK = BINS_01 };
    double *v = e->v + i, block[BLOCKS] = {0.0}, squares = 0.0;
    const size_t n = e->n;
    for (int k = 0; k < HALF; k++) v[(size_t)k * n] = 0.5 * (N[HALF - 1 - k] + N[HALF + k]);
    for (int k = 0; k < RISES; k++)
        v[(size_t)(RISE + k) * n] = v[(size_t)(BINS_01 + k) * n] - mean_between(N, 0, BINS_01);
    for (int k = 0; k < BLOCKS * BLOCK; k++)
        block[k / BLOCK] += 0.5 * (N[HALF - 1 - k] - N[HALF + k]) / BLOCK;
    for (int k = 0; k < BLOCKS; k++) squares += block[k] * block[k];
    v[EXCESS * n] = excess;
    v[MIDDLE * n] = stress_middle(N);
    v[SIDES * n] = (block[0] - block[1]) / mean_load(N);
    v[NOISE * n] = sqrt(2.0 * squares / BLOCKS) / mean_load(N);
}

/* In standard errors; infinite without any. */
static double over_error(double difference, double se)
{
    return se > 0.0 ? difference / se : difference == 0.0 ? 0.0 : copysign(INFINITY, difference);
}

/* Is this middle below its neighbours by more than noise, at 5 % for a single pile? Noise has four blocks. */
static bool is_below(double middle, double noise)
{
    const double STUDENT = 2.1318467863266495; /* 95 % of t with four degrees of freedom */
    return middle < -STUDENT * noise;
}

/* Largest rise from the middle to a bin beside it. */
static double largest_rise(const ensemble *e, const double means[])
{
    double most = -INFINITY;
    for (int k = RISE; k < EXCESS; k++) most = fmax(most, over_error(means[k], e->stats[k].se));
    return most;
}

/* Share of n piles without a dip that are below by more than noise: differences between the sides of piles of
 * the pool, mirrored or not, beside the noise of others. */
static double share_of_null(const ensemble *e, const size_t pool[], gsl_rng *rng)
{
    const double *sides = e->v + SIDES * e->n, *noise = e->v + NOISE * e->n;
    size_t below = 0;
    for (size_t i = 0; i < e->n; i++) {
        const double middle = sides[pool[gsl_rng_uniform_int(rng, e->n)]];
        const bool mirror = gsl_rng_uniform(rng) < 0.5;
        below += is_below(mirror ? -middle : middle, noise[pool[gsl_rng_uniform_int(rng, e->n)]]);
    }
    return (double)below / (double)e->n;
}

/* One ensemble of as many piles, drawn with replacement: the means of the columns less those of the piles,
 * widened to an unbiased variance. */
static void draw(const ensemble *e, size_t pool[], double means[], gsl_rng *rng)
{
    const double n = (double)e->n, widen = sqrt(n / (n - 1.0));
    for (size_t i = 0; i < e->n; i++) pool[i] = gsl_rng_uniform_int(rng, e->n);
    for (int c = 0; c < N_SUMMARIES; c++) {
        means[c] = 0.0;
        for (size_t i = 0; i < e->n; i++) means[c] += e->v[(size_t)c * e->n + pool[i]] / n;
        means[c] = widen * (means[c] - e->stats[c].mean);
    }
}

/* Null distributions. work: 3 resamples. */
static void resample(const ensemble *e, size_t resamples, gsl_rng *rng, size_t pool[], double work[],
                     stress_dips *d)
{
    double own[N_SUMMARIES], means[N_SUMMARIES] = {0.0}, low = 0.0, far = 0.0, rises = 0.0, shares = 0.0;
    double *excess = work, *share = work + resamples, *band = work + 2 * resamples;
    for (int c = 0; c < N_SUMMARIES; c++) own[c] = e->stats[c].mean;
    const double rise = largest_rise(e, own);
    for (size_t b = 0; b < resamples; b++) {
        draw(e, pool, means, rng);
        excess[b] = means[EXCESS];
        low += excess[b] <= d->excess.mean;
        far += fabs(excess[b]) >= fabs(d->excess.mean);
        rises += largest_rise(e, means) >= rise;
        share[b] = share_of_null(e, pool, rng);
        shares += share[b] >= d->share;
        band[b] = 0.0;
        for (int k = 0; k < HALF; k++) band[b] = fmax(band[b], fabs(over_error(means[k], e->stats[k].se)));
    }
    const double all = (double)resamples + 1.0;
    d->p_dip = (low + 1.0) / all;
    d->p_value = (far + 1.0) / all;
    d->p_profile = (rises + 1.0) / all;
    d->p_share = (shares + 1.0) / all;
    const stats_spread spread = stats_resampled(resamples, excess);
    d->null_lo = spread.lo;
    d->null_hi = spread.hi;
    d->share_null = gsl_stats_mean(share, 1, resamples);
    const double binomial = d->share_null * (1.0 - d->share_null) / (double)e->n;
    d->share_null_se = sqrt(fmax(gsl_stats_variance(share, 1, resamples) - binomial, 0.0));
    gsl_sort(band, 1, resamples);
    d->N_t = gsl_stats_quantile_from_sorted_data(band, 1, resamples, 0.95);
}

/* Binomial; with a pile more on either side, so that a share of 0 or 1 has an error too (Agresti & Coull). */
static double share_se(double share, size_t n)
{
    const double q = (share * (double)n + 1.0) / ((double)n + 2.0);
    return sqrt(q * (1.0 - q) / (double)n);
}

static rp_status summarise(ensemble *e, double margin, stress_dips *d)
{
    const size_t n = e->n;
    for (size_t c = 0; c < N_SUMMARIES; c++) RP_TRY(stats_mean(n, e->v + c * n, &e->stats[c]));
    for (int k = 0; k < HALF; k++) {
        d->N[k] = e->stats[k].mean;
        d->N_se[k] = e->stats[k].se;
    }
    d->excess = e->stats[EXCESS];
    d->middle = e->stats[MIDDLE];
    d->p_margin =
        stats_contrast_p_margin(&(stats_contrast){d->excess.mean, d->excess.se, (double)n - 1.0}, margin);
    for (size_t i = 0; i < n; i++) {
        const double middle = e->v[MIDDLE * n + i];
        d->below += (middle < 0.0) / (double)n;
        d->share += is_below(middle, e->v[NOISE * n + i]) / (double)n;
    }
    d->below_se = share_se(d->below, n);
    d->share_se = share_se(d->share, n);
    return RP_OK;
}

rp_status stress_dip_ensemble(size_t n, const double profiles[], const double excess[], double margin,
                              size_t resamples, gsl_rng *rng, stress_dips *d)
{
    *d = (stress_dips){0};
    if (n < 3) return rp_fail(RP_NO_RESULT, "dip: %zu piles, at least 3 expected", n);
    if (!(margin > 0.0)) return rp_fail(RP_BAD_INPUT, "margin = %g: out of range, allowed: (0, inf)", margin);
    rp_status status = stats_check_resamples(resamples);
    if (status) return status;
    ensemble e = {.n = n, .v = malloc((N_COLUMNS * n + 3 * resamples) * sizeof *e.v)};
    size_t *pool = malloc(n * sizeof *pool);
    if (!e.v || !pool) status = rp_fail(RP_NO_MEMORY, "dip: out of memory");
    for (size_t i = 0; i < n && !status; i++) add_pile(&e, i, profiles + i * STRESS_DIP_BINS, excess[i]);
    if (!status) status = summarise(&e, margin, d);
    if (!status) resample(&e, resamples, rng, pool, e.v + N_COLUMNS * n, d);
    free(e.v);
    free(pool);
    return status;
}

const char *stress_dip_word(const stress_dips *d, double level)
{
    const bool differs = d->p_value < level, within = d->p_margin < level;
    if (!differs) return within ? "none_within_margin" : "undecided";
    if (d->excess.mean < 0.0) return within ? "dip_within_margin" : "dip";
    return within ? "peak_within_margin" : "peak";
}
