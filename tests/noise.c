/* A protocol that costs nothing. */
#include "tests/noise.h"

#include <gsl/gsl_rng.h>
#include <string.h>

#include "core/random.h"

const rp_param noise_schema[] = {{"x", "", RP_REAL, 0, "0.25", "[0, 10]", "shift"}, {0}};
const sweep_output noise_outputs[] = {{"y", "", "x + noise"}, {"z", "", "noise"}, {0}};

rp_status noise_check(const void *params)
{
    (void)params;
    return RP_OK;
}

rp_status noise_run(const void *params, unsigned long seed, unsigned long run, const sweep_tables *tables,
                    sweep_result *result)
{
    (void)tables;
    gsl_rng *r = rp_random_alloc(seed, run, RP_PURPOSE_TEST);
    if (!r) return rp_fail(RP_NO_MEMORY, "noise: out of memory");
    result->values[1] = gsl_rng_uniform(r);
    result->values[0] = *(const double *)params + result->values[1];
    gsl_rng_free(r);
    strcpy(result->status, "ok");
    return RP_OK;
}
