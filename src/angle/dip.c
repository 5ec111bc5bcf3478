/* Pressure on the base of piles; see dip.h. */
#include "angle/dip.h"

#include <math.h>
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
static rp_status base_width(size_t n, const double x[], const double N[], double total, ang_base *base)
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

rp_status ang_base_profile(size_t n, const double x[], const double r[], const double N[], ang_base *base)
{
    double total = 0.0, moment = 0.0, inside = 0.0;
    *base = (ang_base){0};
    for (size_t i = 0; i < n; i++) {
        total += N[i];
        moment += N[i] * x[i];
    }
    if (!(total > 0.0)) return rp_fail(RP_NO_RESULT, "base: no load on it");
    base->centroid = moment / total;
    rp_status status = base_width(n, x, N, total, base);
    if (status) return status;
    if (!(base->width > 0.0)) return rp_fail(RP_NO_RESULT, "base: all the load is on one place");
    const double bin = base->width / ANG_DIP_BINS, left = base->centroid - 0.5 * base->width;
    for (size_t i = 0; i < n; i++)
        for (int k = 0; k < ANG_DIP_BINS; k++) {
            const double lo = fmax(x[i] - r[i], left + k * bin), hi = fmin(x[i] + r[i], left + (k + 1) * bin);
            if (hi > lo) base->N[k] += N[i] * (hi - lo) / (2.0 * r[i]);
        }
    for (int k = 0; k < ANG_DIP_BINS; k++) inside += base->N[k];
    for (int k = 0; k < ANG_DIP_BINS; k++) base->N[k] *= ANG_DIP_BINS / inside;
    return RP_OK;
}

double ang_dip(const double N[ANG_DIP_BINS])
{
    double centre = 0.0, shoulders = 0.0, mean = 0.0;
    for (int k = 0; k < ANG_DIP_BINS; k++) {
        const int from_middle = k < ANG_DIP_BINS / 2 ? ANG_DIP_BINS / 2 - 1 - k : k - ANG_DIP_BINS / 2;
        mean += N[k] / ANG_DIP_BINS;
        if (from_middle < 2)
            centre += N[k] / 4.0;
        else if (from_middle < 6)
            shoulders += N[k] / 8.0;
    }
    return (centre - shoulders) / mean;
}
