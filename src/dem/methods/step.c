/* Parts of a step; see methods.h. */
#include "dem/methods/methods.h"

#include <math.h>
#include <stdio.h>

#include "core/clock.h"
#include "dem/forces/forces.h"
#include "dem/list/list.h"
#include "dem/observe/observe.h"

/* What a too deep overlap follows from. */
static const char *speed_text(const dem_sim *sim, dem_vec v, char text[128])
{
    snprintf(text, 128, "speed %.3g and dt = %g: a larger k_n, a smaller dt or less speed is needed",
             sqrt(dem_dot(v, v)), sim->def.dt);
    return text;
}

rp_status dem_check_overlaps(dem_sim *sim, dem_stretch pairs, dem_stretch grains)
{
    sim->too_deep = false;
    for (size_t k = pairs.from; k < pairs.to; k++) {
        if (!dem_touches(&sim->pairs, k)) continue;
        const size_t i = sim->pairs.i[k], j = sim->pairs.j[k];
        dem_vec d = sim->grains.motion[i].x - sim->grains.motion[j].x;
        double overlap = sim->pairs.radii[k] - sqrt(dem_dot(d, d)),
               smaller = fmin(sim->grains.radius[i], sim->grains.radius[j]);
        if (!(overlap <= smaller))
            return dem_stop(
                sim, isfinite(overlap) ? DEM_FAULT_OVERLAP : DEM_FAULT_NON_FINITE, i,
                "overlap %g with grain %u, beyond the smaller radius %g, at %s", overlap, sim->grains.id[j],
                smaller, speed_text(sim, sim->grains.motion[i].v - sim->grains.motion[j].v, (char[128]){0}));
    }
    for (size_t s = 0; s < sim->walls.n_slots; s++) {
        dem_touch touch;
        dem_wall_slot slot = sim->walls.slot[s];
        if (slot.grain >= grains.from && slot.grain < grains.to && dem_wall_touch(sim, &slot, &touch) &&
            !(touch.overlap <= sim->grains.radius[slot.grain]))
            return dem_stop(sim, isfinite(touch.overlap) ? DEM_FAULT_LEAKED : DEM_FAULT_NON_FINITE,
                            slot.grain, "its centre passed wall %u (overlap %g), at %s", slot.wall + 1,
                            touch.overlap, speed_text(sim, sim->grains.motion[slot.grain].v, (char[128]){0}));
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
    sim->loops.pairs(sim, 0, sim->pairs.n, h);
    if (sim->times) lap(sim, &sim->times->contacts);
    dem_walls_apply(sim, 0, sim->grains.n, h);
    if (sim->too_deep)
        RP_TRY(dem_check_overlaps(sim, (dem_stretch){0, sim->pairs.n}, (dem_stretch){0, sim->grains.n}));
    if (sim->times) lap(sim, &sim->times->walls);
    return sim->ledger ? dem_ledger_forces(sim, h) : RP_OK;
}
