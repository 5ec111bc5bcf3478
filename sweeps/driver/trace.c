/* One run of a sweep again, with its tables; see sweep.h. */
#include "sweeps/driver/private.h"

rp_status sweep_trace(const char *file, const sweep_protocol *const *protocols, size_t row,
                      const sweep_tables *tables, const sweep_protocol **protocol, sweep_result *result)
{
    sweep_plan plan;
    rp_status status = sweep_plan_read(file, protocols, &plan);
    *protocol = plan.protocol;
    if (!status && row >= plan.n_runs)
        status = rp_fail(RP_BAD_INPUT, "row = %zu: out of range, allowed: [0, %zu], the runs of %s", row,
                         plan.n_runs - 1, file);
    if (!status)
        status = plan.protocol->run(sweep_plan_point(&plan, row / plan.replicas), plan.seed,
                                    sweep_plan_pile(&plan, row), tables, result);
    sweep_plan_free(&plan);
    return status;
}
