/* A protocol that costs nothing. */
#include "tests/noise.h"

#include <string.h>

#include "tests/numbers.h"

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
    scoped_rng *r = numbers_of(seed, run);
    if (!r) return rp_fail(RP_NO_MEMORY, "noise: out of memory");
    result->values[1] = gsl_rng_uniform(r);
    result->values[0] = *(const double *)params + result->values[1];
    strcpy(result->status, "ok");
    return RP_OK;
}
