/* Parameters of piles that are tilted; see tilted.h. */
#include "sweeps/protocols/tilted.h"

#include <stddef.h>

#include "sweeps/engine/keep.h"
#include "sweeps/engine/physics.h"

#define AT(field) offsetof(sweep_tilted, field)

/* clang-format off */
const rp_param sweep_tilted_schema[] = {
    SWEEP_BOX_PHYSICS
    SWEEP_BOX_WIDTH_ROW
    SWEEP_BOX_COUNT_ROWS
    SWEEP_BOX_WALL_ROWS
    SWEEP_BOX_OPENING_ROWS
    SWEEP_BOX_FILL_STEPS_ROW
    SWEEP_BOX_REST_ROWS
    SWEEP_BOX_MAX_STEPS_ROW
    {"tilt_rate_deg", "degree", RP_REAL, AT(tilt_rate_deg), "1e-3", "[1e-6, 0.01]", "turn of gravity a step"},
    SWEEP_BOX_SURFACE_ROWS
    {0}};
/* clang-format on */

rp_status sweep_tilted_check(const void *params)
{
    const sweep_tilted *p = params;
    RP_TRY(sweep_box_check_fill(&p->box));
    return p->box.physics.slip == DEM_TOTAL
               ? rp_fail(RP_BAD_INPUT, "slip = \"total\": the untruncated spring never comes to rest")
               : RP_OK;
}

rp_status sweep_tilted_phases(sweep_box_run *run, size_t n, rp_status (*const phases[])(void *experiment),
                              void *experiment)
{
    size_t phase = 0;
    rp_status status = RP_OK;
    SWEEP_ENTER(run->keep, phase);
    for (; phase < SWEEP_BOX_PHASES + n && !status; phase++)
        status = phase < SWEEP_BOX_PHASES ? sweep_box_phase(run, phase)
                                          : phases[phase - SWEEP_BOX_PHASES](experiment);
    return status;
}

rp_status sweep_tilted_fingerprint(rp_status (*run_one)(const void *params, unsigned long seed,
                                                        unsigned long run, const sweep_tables *tables,
                                                        sweep_result *result),
                                   const sweep_output outputs[], const char *hashed, char digits[33])
{
    sweep_tilted p = {0}; /* the schema has not every field of the box */
    sweep_result result;
    rp_params_defaults(sweep_tilted_schema, &p);
    p.box.W = 2.0;
    p.box.H = 1.0;
    p.box.fill_steps = 1500;
    p.box.rest_energy = 1e-3;
    p.box.rest_force = 1e3;
    p.tilt_rate_deg = 0.01;
    RP_TRY(run_one(&p, 1, 0, NULL, &result));
    sweep_results_digits(1, &result, outputs, hashed, digits);
    return sweep_physics_add(digits);
}
