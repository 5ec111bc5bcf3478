/* Gravity that is set, or turns. */

#include <math.h>

#include "core/elementary.h"
#include "dem/observe/observe.h"
#include "dem/methods/methods.h"

static void set(dem_sim *sim, const double g[2])
{
    sim->gravity = dem_vec_of(g);
    sim->gravity_norm = sqrt(dem_dot(sim->gravity, sim->gravity));
}

void dem_gravity_start(dem_sim *sim)
{
    set(sim, sim->def.gravity);
    dem_sine_cosine(sim->def.turn_per_step, &sim->turn_sin, &sim->turn_cos);
}

rp_status dem_gravity_turn(dem_sim *sim, double radians_per_step)
{
    RP_TRY(rp_check_range("turn of gravity", radians_per_step, -1.0, 1.0, "[-1, 1]"));
    sim->def.turn_per_step = radians_per_step;
    sim->def.turn_from_step = sim->step;
    dem_sine_cosine(radians_per_step, &sim->turn_sin, &sim->turn_cos);
    return RP_OK;
}

rp_status dem_gravity_set(dem_sim *sim, const double g[2])
{
    if (!isfinite(g[0]) || !isfinite(g[1]))
        return rp_fail(RP_BAD_INPUT, "gravity = [%g, %g]: must be finite", g[0], g[1]);
    dem_vec before = sim->gravity;
    set(sim, g);
    if (sim->scheme->gravity) sim->scheme->gravity(sim, sim->gravity - before);
    if (sim->ledger) dem_ledger_gravity(sim);
    return RP_OK;
}

void dem_gravity_advance(dem_sim *sim)
{
    if (sim->def.turn_per_step == 0.0 || sim->step < sim->def.turn_from_step) return;
    dem_vec g = sim->gravity;
    g = sim->turn_cos * g + sim->turn_sin * (dem_vec){-g[1], g[0]};
    double norm = sqrt(dem_dot(g, g));
    sim->gravity = norm > 0.0 ? g * (sim->gravity_norm / norm) : g;
    if (sim->ledger) dem_ledger_gravity(sim);
}

void dem_gravity(const dem_sim *sim, double gravity[2])
{
    gravity[0] = sim->gravity[0];
    gravity[1] = sim->gravity[1];
}
