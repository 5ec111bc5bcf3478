/* Static friction of the ground: a well around the position where a grain came to rest. Liffman, Chan &
 * Hughes 1992, eqs (30) and (33), with the sign that pulls back (their F_x is -F_t on the ground) and the
 * middle of a step as (x_k + x_(k+1))/2, which for an explicit scheme is the position itself. The well is as
 * deep as N is large at the moment, so it conserves energy only while N is constant. */
#include <math.h>

#include "dem/forces/forces.h"
#include "dem/state/motion.h"

static double along(const dem_sim *sim, const dem_wall_slot *slot, dem_vec v)
{
    return dem_dot(v, dem_clockwise(sim->walls.line[slot->wall].direction));
}

double dem_ground_displacement(const dem_sim *sim, const dem_wall_slot *slot)
{
    return along(sim, slot, sim->grains.motion[slot->grain].x - sim->walls.line[slot->wall].point) -
           slot->rest;
}

double dem_ground_force(const dem_sim *sim, const dem_wall_slot *slot, double normal_force)
{
    if (slot->well != DEM_WELL_HOLDS) return 0.0;
    const dem_ground *g = &sim->def.ground;
    return -g->mu_static * fmax(normal_force, 0.0) / g->a * dem_ground_displacement(sim, slot);
}

bool dem_is_ground(const dem_sim *sim, const dem_wall_slot *slot)
{
    return (int)slot->wall + 1 == sim->def.ground.wall;
}

/* See dem_ground. */
static bool comes_to_rest(const dem_sim *sim, const dem_wall_slot *slot, double normal_force, dem_vec f,
                          dem_vec ground_velocity)
{
    const size_t i = slot->grain;
    const double v = along(sim, slot, sim->grains.motion[i].v - ground_velocity);
    const dem_equation e = dem_equation_of(sim);
    const double drive = along(
        sim, slot,
        dem_acceleration(&e, *dem_force(sim, i) + f, sim->grains.inverse_mass[i], sim->grains.motion[i].v));
    double twice = sim->grains.mass[i] * v * v; /* its kinetic energy; a spin may turn into speed */
    if (sim->grains.omega)
        twice += sim->grains.omega[i] * sim->grains.omega[i] / sim->grains.inverse_inertia[i];
    return v * drive <= 0.0 && twice <= sim->def.ground.mu_static * normal_force * sim->def.ground.a;
}

dem_vec dem_ground_hold(const dem_sim *sim, dem_wall_slot *slot, double normal_force, dem_vec f,
                        dem_vec ground_velocity)
{
    const dem_ground *g = &sim->def.ground;
    if (slot->well == DEM_WELL_HOLDS && fabs(dem_ground_displacement(sim, slot)) > g->a)
        slot->well = DEM_WELL_BROKEN;
    const bool may =
        slot->well == DEM_WELL_NONE || (slot->well == DEM_WELL_BROKEN && g->set == DEM_WELL_AGAIN);
    if (may && (g->set == DEM_WELL_TOUCH || comes_to_rest(sim, slot, normal_force, f, ground_velocity))) {
        slot->rest = 0.0;
        slot->rest = dem_ground_displacement(sim, slot);
        slot->well = DEM_WELL_HOLDS;
    }
    return dem_ground_force(sim, slot, normal_force) * dem_clockwise(sim->walls.line[slot->wall].direction);
}
