/* Stepping, and why it stops. */

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#ifdef __SSE2__
#include <xmmintrin.h>
#define get_mode _mm_getcsr
#define set_mode _mm_setcsr
#else
#define get_mode()     0
#define set_mode(mode) (void)(mode)
#endif

#include "core/clock.h"
#include "dem/setup/definition.h"
#include "dem/observe/ledger.h"
#include "dem/state/state.h"

rp_status dem_stop(dem_sim *sim, dem_fault fault, size_t grain, const char *format, ...)
{
    char text[256];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    sim->fault = fault;
    return rp_fail(RP_BROKEN, "%s at step %ld: grain %u: %s", dem_fault_text(fault), sim->step,
                   sim->grains.id[grain], text);
}

rp_status dem_check_overlaps(dem_sim *sim, size_t k, size_t to, size_t from, size_t end)
{
    sim->too_deep = false;
    for (; k < to; k++) {
        if (!dem_touches(&sim->pairs, k)) continue;
        const size_t i = sim->pairs.i[k], j = sim->pairs.j[k];
        dem_vec d = sim->grains.motion[i].x - sim->grains.motion[j].x;
        double overlap = sim->pairs.radii[k] - sqrt(dem_dot(d, d)),
               smaller = fmin(sim->grains.radius[i], sim->grains.radius[j]);
        if (!(overlap <= smaller))
            return dem_stop(sim, isfinite(overlap) ? DEM_FAULT_OVERLAP : DEM_FAULT_NON_FINITE, i,
                            "overlap %g with grain %u, beyond the smaller radius %g", overlap,
                            sim->grains.id[j], smaller);
    }
    for (size_t s = 0; s < sim->walls.n_slots; s++) {
        dem_vec normal, velocity;
        double overlap;
        dem_wall_slot slot = sim->walls.slot[s];
        if (slot.grain >= from && slot.grain < end &&
            dem_wall_touch(sim, &slot, &normal, &overlap, &velocity) &&
            !(overlap <= sim->grains.radius[slot.grain]))
            return dem_stop(sim, isfinite(overlap) ? DEM_FAULT_LEAKED : DEM_FAULT_NON_FINITE, slot.grain,
                            "its centre passed wall %u (overlap %g)", slot.wall + 1, overlap);
    }
    return RP_OK;
}

/* Give the time since the last reading to a phase. */
static inline void lap(dem_sim *sim, double *phase)
{
    const double now = rp_clock();
    *phase += now - sim->clock;
    sim->clock = now;
}

rp_status dem_step_lists(dem_sim *sim, unsigned left)
{
    rp_status status = RP_OK;
    sim->step++;
    if (sim->times) lap(sim, &sim->times->integration);
    if (left & DEM_LIST_OUT || sim->walls.swept > sim->walls.sweep_limit)
        status = dem_neighbours_rebuild(sim);
    else if (left)
        dem_neighbours_drop(sim);
    if (sim->times) lap(sim, &sim->times->lists);
    return status;
}

rp_status dem_step_forces(dem_sim *sim)
{
    const double h = sim->def.dt;
    rp_status status;
    sim->kernels.pairs(sim, 0, sim->pairs.n, h);
    if (sim->times) lap(sim, &sim->times->contacts);
    dem_walls_apply(sim, 0, sim->grains.n, h);
    if (sim->too_deep && (status = dem_check_overlaps(sim, 0, sim->pairs.n, 0, sim->grains.n)) != RP_OK)
        return status;
    if (sim->times) lap(sim, &sim->times->walls);
    return sim->ledger ? dem_ledger_forces(sim, h) : RP_OK;
}

static rp_status advance(dem_sim *sim, long steps)
{
    /* the box may turn since the start */
    if (sim->grains.n_fixed > 0 && sim->def.box_turn_per_step != 0.0) return dem_refuse_turn();
    rp_status status = dem_scheme_check(&sim->def);
    if (!status) dem_threads_start(sim);
    for (; steps > 0 && !status; steps--) {
        dem_gravity_advance(sim);
        status = sim->scheme->step(sim, steps == 1);
        if (!status && sim->ledger) dem_ledger_step(sim);
    }
    dem_threads_end(sim);
    dem_neighbours_close_gaps(sim);
    return status;
}

/* Within a run, numbers below the smallest normal one, 2.2e-308, count as 0. Speeds and springs of a disk
 * that lies alone shrink for ever, and each operation on such a number takes the processor some 150 cycles.
 */
rp_status dem_run(dem_sim *sim, long steps)
{
    enum { RESULTS = 0x8000, OPERANDS = 0x40 };
    const unsigned mode = get_mode();
    set_mode(mode | RESULTS | OPERANDS);
    rp_status status = advance(sim, steps);
    set_mode(mode);
    return status;
}

rp_status dem_run_timed(dem_sim *sim, long steps, dem_phases *times)
{
    sim->times = times;
    sim->clock = rp_clock();
    rp_status status = dem_run(sim, steps);
    sim->times = NULL;
    return status;
}
