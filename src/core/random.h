/* Counter-based random streams, Philox4x32-10 of Random123.
 *
 * A stream is named by (campaign seed, run, purpose): no two runs share a stream, and the order of the runs
 * does not matter. Salmon, Moraes, Dror & Shaw 2011. */
#ifndef RP_RANDOM_H
#define RP_RANDOM_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

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

/* A stream, which is copied as any value: the copy gives the same numbers. */
typedef struct {
    uint32_t counter[4]; /* block number (64 bits), run, purpose */
    uint32_t key[2];     /* campaign seed, 0 */
    uint32_t block[4];
    uint32_t used; /* words of the block already given */
} rp_random;

/* Stream (seed, run, purpose), each below 2^32; or one that lives as long as an arena, NULL without memory.
 */
rp_random rp_random_of(unsigned long seed, unsigned long run, rp_purpose purpose);
rp_random *rp_random_in(rp_arena *memory, unsigned long seed, unsigned long run, rp_purpose purpose);

/* Is a state that was read one that a stream can have? */
bool rp_random_is_whole(const rp_random *r);

/* The next 32 bits; a number in [0, 1), of 53 bits; a whole number below n, 1 <= n < 2^32. */
uint32_t rp_random_word(rp_random *r);
double rp_random_uniform(rp_random *r);
size_t rp_random_below(rp_random *r, size_t n);

/* Normal deviate of the given mean and standard deviation `width`, drawn again until it lies in [lo, hi], lo
 * < hi. Only + - * / are used, so that every processor and C library gives the same bits: a uniform proposal
 * accepted with probability exp(-z^2/2) by von Neumann's comparison method (Forsythe 1972). The distribution
 * ends at 8 standard deviations: NaN where lo or hi leaves nothing of it. width = 0 gives the mean. */
double rp_random_cut_normal(rp_random *r, double mean, double width, double lo, double hi);

RP_C_END

#endif
