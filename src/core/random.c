/* Counter-based random streams; see random.h. */
#include "core/random.h"

#include <Random123/philox.h>
#include <math.h>
#include <stdint.h>

typedef struct {
    philox4x32_ctr_t counter; /* block number (64 bits), run, purpose */
    philox4x32_key_t key;     /* campaign seed, 0 */
    philox4x32_ctr_t block;
    unsigned used; /* 32-bit words of the block already given */
} philox_state;

static void philox_name(philox_state *s, uint32_t seed, uint32_t run, uint32_t purpose)
{
    *s = (philox_state){.counter.v = {0, 0, run, purpose}, .key.v = {seed, 0}, .used = 4};
}

static void philox_set(void *state, unsigned long seed)
{
    philox_name(state, (uint32_t)seed, 0, 0);
}

static unsigned long philox_get(void *state)
{
    philox_state *s = state;
    if (s->used == 4) {
        s->block = philox4x32(s->counter, s->key);
        if (++s->counter.v[0] == 0) ++s->counter.v[1];
        s->used = 0;
    }
    return s->block.v[s->used++];
}

static double philox_get_double(void *state)
{
    uint64_t high = philox_get(state) >> 5, low = philox_get(state) >> 6; /* 27 + 26 bits */
    return (double)(high << 26 | low) * (1.0 / 9007199254740992.0);
}

static const gsl_rng_type philox_type = {"philox4x32", 0xffffffffUL,     0, sizeof(philox_state), philox_set,
                                         philox_get,   philox_get_double};

const gsl_rng_type *rp_rng_philox = &philox_type;

gsl_rng *rp_random_alloc(unsigned long seed, unsigned long run, rp_purpose purpose)
{
    gsl_rng *r = gsl_rng_alloc(rp_rng_philox);
    if (r) philox_name(gsl_rng_state(r), (uint32_t)seed, (uint32_t)run, (uint32_t)purpose);
    return r;
}

static void end(void *stream)
{
    gsl_rng_free(stream);
}

gsl_rng *rp_random_in(rp_arena *memory, unsigned long seed, unsigned long run, rp_purpose purpose)
{
    return rp_arena_keep(memory, rp_random_alloc(seed, run, purpose), end);
}

bool rp_random_is_whole(const gsl_rng *r)
{
    return ((const philox_state *)gsl_rng_state(r))->used <= 4;
}

/* True with probability exp(-x), 0 <= x <= 1: the run x > u1 > u2 > ... has even length with it. */
static bool accept_exp_unit(gsl_rng *r, double x)
{
    bool even = true;
    for (double last = x, u; (u = gsl_rng_uniform(r)) < last; last = u) even = !even;
    return even;
}

static bool accept_exp(gsl_rng *r, double x)
{
    for (; x > 1.0; x -= 1.0)
        if (!accept_exp_unit(r, 1.0)) return false;
    return accept_exp_unit(r, x);
}

double rp_random_cut_normal(gsl_rng *r, double mean, double width, double lo, double hi)
{
    if (width <= 0.0) return mean;
    double a = fmax((lo - mean) / width, -8.0), b = fmin((hi - mean) / width, 8.0);
    if (!(a <= b)) return NAN;
    for (;;) {
        double z = a + (b - a) * gsl_rng_uniform(r);
        if (accept_exp(r, 0.5 * z * z)) return mean + width * z;
    }
}
