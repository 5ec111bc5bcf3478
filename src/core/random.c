/* Counter-based random streams; see random.h. */
#include "core/random.h"

#include <Random123/philox.h>
#include <math.h>
#include <string.h>

rp_random rp_random_of(unsigned long seed, unsigned long run, rp_purpose purpose)
{
    return (rp_random){
        .counter = {0, 0, (uint32_t)run, (uint32_t)purpose}, .key = {(uint32_t)seed, 0}, .used = 4};
}

rp_random *rp_random_in(rp_arena *memory, unsigned long seed, unsigned long run, rp_purpose purpose)
{
    rp_random *r = rp_arena_memory(memory, 1, sizeof *r);
    if (r) *r = rp_random_of(seed, run, purpose);
    return r;
}

bool rp_random_is_whole(const rp_random *r)
{
    return r->used <= 4;
}

uint32_t rp_random_word(rp_random *r)
{
    if (r->used == 4) {
        philox4x32_ctr_t counter;
        philox4x32_key_t key;
        memcpy(counter.v, r->counter, sizeof r->counter);
        memcpy(key.v, r->key, sizeof r->key);
        counter = philox4x32(counter, key);
        memcpy(r->block, counter.v, sizeof r->block);
        if (++r->counter[0] == 0) ++r->counter[1];
        r->used = 0;
    }
    return r->block[r->used++];
}

double rp_random_uniform(rp_random *r)
{
    const uint64_t high = rp_random_word(r) >> 5, low = rp_random_word(r) >> 6; /* 27 + 26 bits */
    return (double)(high << 26 | low) * (1.0 / 9007199254740992.0);
}

/* Every number has as many of the words; those left over are drawn again. */
size_t rp_random_below(rp_random *r, size_t n)
{
    const size_t share = UINT32_MAX / n;
    size_t k;
    do k = rp_random_word(r) / share;
    while (k >= n);
    return k;
}

/* True with probability exp(-x), 0 <= x <= 1: the run x > u1 > u2 > ... has even length with it. */
static bool accept_exp_unit(rp_random *r, double x)
{
    bool even = true;
    for (double last = x, u; (u = rp_random_uniform(r)) < last; last = u) even = !even;
    return even;
}

static bool accept_exp(rp_random *r, double x)
{
    for (; x > 1.0; x -= 1.0)
        if (!accept_exp_unit(r, 1.0)) return false;
    return accept_exp_unit(r, x);
}

double rp_random_cut_normal(rp_random *r, double mean, double width, double lo, double hi)
{
    if (width <= 0.0) return mean;
    double a = fmax((lo - mean) / width, -8.0), b = fmin((hi - mean) / width, 8.0);
    if (!(a <= b)) return NAN;
    for (;;) {
        double z = a + (b - a) * rp_random_uniform(r);
        if (accept_exp(r, 0.5 * z * z)) return mean + width * z;
    }
}
