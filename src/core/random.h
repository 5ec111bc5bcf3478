/* Counter-based random streams (Philox4x32-10 of Random123) as a GSL generator.
 *
 * A stream is named by (campaign seed, run, purpose): no two runs share a stream, and the order of the runs
 * does not matter. Salmon, Moraes, Dror & Shaw 2011. */
#ifndef RP_RANDOM_H
#define RP_RANDOM_H

#include <stdbool.h>

#include <gsl/gsl_rng.h>

#include "core/arena.h"

RP_C_BEGIN

/* Purpose of a stream; a new purpose is a new line, never a reused one. */
typedef enum {
    RP_PURPOSE_RADII = 1,
    RP_PURPOSE_PLACES = 2,
    RP_PURPOSE_BOOTSTRAP = 3,
    RP_PURPOSE_TEST = 4,
    RP_PURPOSE_DIRECTION = 5,
    RP_PURPOSE_FILLS = 1000 /* and the numbers after: two of each fill of a scene after its first */
} rp_purpose;

/* The generator type. gsl_rng_set(r, seed) gives stream (seed, 0, 0). */
extern const gsl_rng_type *rp_rng_philox;

/* New stream (seed, run, purpose), each below 2^32; free with gsl_rng_free, or one that ends with an arena.
 * NULL when out of memory. */
gsl_rng *rp_random_alloc(unsigned long seed, unsigned long run, rp_purpose purpose);
gsl_rng *rp_random_in(rp_arena *memory, unsigned long seed, unsigned long run, rp_purpose purpose);

/* Is a state that was read one that a stream can have? */
bool rp_random_is_whole(const gsl_rng *r);

/* Normal deviate of the given mean and standard deviation `width`, drawn again until it lies in [lo, hi], lo
 * < hi. Only + - * / are used, so that every processor and C library gives the same bits: a uniform proposal
 * accepted with probability exp(-z^2/2) by von Neumann's comparison method (Forsythe 1972). The distribution
 * ends at 8 standard deviations: NaN where lo or hi leaves nothing of it. width = 0 gives the mean. */
double rp_random_cut_normal(gsl_rng *r, double mean, double width, double lo, double hi);

RP_C_END

#endif
