/* Pressure on the base of piles; see stress.h. */
#include "core/arena.h"
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
    RP_SCOPE(memory);
    load *loads;
    RP_NEW(&memory, loads, n);
    for (size_t i = 0; i < n; i++) loads[i] = (load){fabs(x[i] - base->centroid), N[i]};
    qsort(loads, n, sizeof *loads, by_distance);
    double sum = 0.0;
    for (size_t i = 0; i < n && sum < 0.98 * total; i++) {
        sum += loads[i].N;
        base->width = 2.0 * loads[i].distance;
    }
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
    if (!(base->width > 1e-12 * fabs(base->centroid)))
        return rp_fail(RP_NO_RESULT, "base: all the load is at one position");
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

/* Binomial; with a pile more on either side, so that a share of 0 or 1 has an error too (Agresti & Coull). */
static double share_se(double share, size_t n)
{
    const double q = (share * (double)n + 1.0) / ((double)n + 2.0);
    return sqrt(q * (1.0 - q) / (double)n);
}

rp_status stress_dip_ensemble(size_t n, const double profiles[], const double excess[], double margin,
                              stress_dips *d)
{
    RP_SCOPE(memory);
    double *v; /* a number of each pile */
    stats_summary bin;
    *d = (stress_dips){0};
    if (n < 3) return rp_fail(RP_NO_RESULT, "dip: %zu piles, at least 3 expected", n);
    if (!(margin > 0.0)) return rp_fail(RP_BAD_INPUT, "margin = %g: out of range, allowed: (0, inf)", margin);
    RP_NEW(&memory, v, n);
    for (size_t k = 0; k < HALF; k++) {
        for (size_t i = 0; i < n; i++) {
            const double *N = profiles + i * STRESS_DIP_BINS;
            v[i] = 0.5 * (N[HALF - 1 - k] + N[HALF + k]);
        }
        RP_TRY(stats_mean(n, v, &bin));
        d->N[k] = bin.mean;
        d->N_se[k] = bin.se;
    }
    for (size_t i = 0; i < n; i++) {
        v[i] = stress_middle(profiles + i * STRESS_DIP_BINS);
        d->below += (v[i] < 0.0) / (double)n;
    }
    d->below_se = share_se(d->below, n);
    RP_TRY(stats_mean(n, v, &d->middle));
    RP_TRY(stats_mean(n, excess, &d->excess));
    const stats_contrast middle = {d->middle.mean, d->middle.se, (double)n - 1.0};
    d->p_value = stats_contrast_p(&middle);
    d->p_margin = stats_contrast_p_margin(&middle, margin);
    return RP_OK;
}

const char *stress_dip_word(const stress_dips *d, double level)
{
    const bool differs = d->p_value < level, within = d->p_margin < level;
    if (!differs) return within ? "none_within_margin" : "undecided";
    if (d->middle.mean < 0.0) return within ? "dip_within_margin" : "dip";
    return within ? "peak_within_margin" : "peak";
}
