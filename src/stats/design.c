/* Designs of numbers and factors; see forensics.h. */
#include <gsl/gsl_qrng.h>
#include <gsl/gsl_randist.h>
#include <gsl/gsl_sort.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>

#include "stats/forensics.h"

enum { SOBOL_BITS = 30 };

rp_status stats_design(size_t n, size_t n_reals, double u[], size_t n_factors, const size_t n_levels[],
                       size_t level[], gsl_rng *rng)
{
    uint32_t shift[STATS_DESIGN_REALS];
    double point[STATS_DESIGN_REALS];
    if (n_reals < 1 || n_reals > STATS_DESIGN_REALS)
        return rp_fail(RP_BAD_INPUT, "design: %zu numbers: out of range, allowed: [1, %d]", n_reals,
                       STATS_DESIGN_REALS);
    gsl_qrng *sobol = gsl_qrng_alloc(gsl_qrng_sobol, (unsigned)n_reals);
    if (!sobol) return rp_fail(RP_NO_MEMORY, "design: out of memory");
    for (size_t p = 0; p < n_reals; p++) shift[p] = (uint32_t)gsl_rng_uniform_int(rng, 1ul << SOBOL_BITS);
    for (size_t i = 0; i < n; i++) {
        gsl_qrng_get(sobol, point);
        for (size_t p = 0; p < n_reals; p++) {
            const uint32_t bits = (uint32_t)ldexp(point[p], SOBOL_BITS) ^ shift[p];
            u[i * n_reals + p] = ldexp((double)bits + 0.5, -SOBOL_BITS);
        }
    }
    gsl_qrng_free(sobol);
    for (size_t f = 0; f < n_factors; f++) {
        for (size_t i = 0; i < n; i++) level[f * n + i] = i % n_levels[f];
        gsl_ran_shuffle(rng, level + f * n, n, sizeof *level);
    }
    return RP_OK;
}

rp_status stats_sample(size_t n, const double weight[], size_t k, size_t index[], gsl_rng *rng)
{
    size_t n_weighed = 0;
    double *key = malloc((n + 1) * sizeof *key);
    if (!key) return rp_fail(RP_NO_MEMORY, "sample: out of memory");
    for (size_t i = 0; i < n; i++) {
        n_weighed += weight[i] > 0.0;
        key[i] = log(gsl_rng_uniform_pos(rng)) / weight[i];
    }
    if (n_weighed >= k) gsl_sort_largest_index(index, k, key, 1, n);
    free(key);
    return n_weighed >= k ? RP_OK
                          : rp_fail(RP_NO_RESULT, "%zu draws have a weight, %zu expected", n_weighed, k);
}
