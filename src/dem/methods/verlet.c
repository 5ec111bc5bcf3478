/* Velocity Verlet in its leapfrog form: v(n+1/2) = v(n-1/2) + dt a(n), x(n+1) = x(n) + dt v(n+1/2).
 * Velocity-dependent forces take the mid-step velocity, which is also the exact increment of the shear
 * spring; their phase lag of dt/2 is of first order, as is everything at a contact that damps on touch. */
#include <math.h>

#include "dem/forces/forces.h"
#include "dem/methods/methods.h"
#include "dem/state/motion.h"

static rp_status step(dem_sim *sim, bool last)
{
    unsigned left = 0;
    if (sim->hard) RP_TRY(sim->hard->collide(sim));
    dem_walls_move(sim);
    if (sim->hard)
        sim->hard->move(sim, &left);
    else
        RP_TRY(dem_ahead_move(sim, &left));
    RP_TRY(dem_step_lists(sim, left));
    return dem_ahead_forces(sim, last);
}

static void start(dem_sim *sim, size_t from)
{
    const double dt = sim->def.dt;
    for (size_t i = from; i < sim->grains.n; i++)
        sim->grains.motion[i].v -= 0.5 * dt * dem_acceleration_of(sim, i);
    for (size_t i = from; i < sim->grains.n && sim->grains.omega; i++)
        sim->grains.omega[i] -= dem_spin_gain_of(sim, i, 0.5 * dt);
    dem_hold_fixed(sim);
}

static void change_gravity(dem_sim *sim, dem_vec change)
{
    for (size_t i = 0; i < sim->grains.n; i++) sim->grains.motion[i].v -= 0.5 * sim->def.dt * change;
    dem_hold_fixed(sim);
}

static dem_vec velocity(const dem_sim *sim, size_t i)
{
    return sim->grains.motion[i].v + 0.5 * sim->def.dt * dem_acceleration_of(sim, i);
}

static double spin(const dem_sim *sim, size_t i)
{
    return sim->grains.omega[i] + dem_spin_gain_of(sim, i, 0.5 * sim->def.dt);
}

/* Of the root, 0.95 are allowed where the stiffness is known, and 0.85 of others, whose contacts may
 * become deeper than foreseen: without damping about 1/omega. */
static double step_limit(const dem_definition *def, dem_rates rates, dem_load load)
{
    return load == DEM_AT_REST || load == DEM_OF_MANY
               ? INFINITY
               : dem_half_step_limit(rates,
                                     dem_normal_descriptors[def->normal].constant_stiffness ? 0.95 : 0.85);
}

/* A contact begins and ends within a step: with a = (omega dt)^2 an undamped impact gains up to 0.022 a^2 of
 * its energy in the mean, with Hertz' law a tenth, where damping takes pi gamma/omega. Allowed are
 * 0.14 % of that, contacts of many grains add up, and 0.07 a, since the dashpot lags and takes more. Where
 * springs of k_s = k_n stick and slip, seven times as much comes in: measured in lattices that fall. */
static double impact_limit(const dem_definition *def, double damping, double shear)
{
    const double much = dem_normal_descriptors[def->normal].constant_stiffness ? 1.0 : 13.0,
                 g = much * damping / (1.0 + 6.0 * fmin(shear, 1.0));
    return sqrt(5.0 * g + sqrt(25.0 * g * g + 0.2 * g)); /* a^2 = g (0.2 + 10 a) */
}

const dem_scheme dem_scheme_verlet = {
    .name = "verlet",
    .order = {2, 1}, /* it damps by the velocity of half a step before */
    .rotation = true,
    .hard = true,
    .runs_ahead = true,
    .step_limit = step_limit,
    .impact_limit = impact_limit,
    .start = start,
    .gravity = change_gravity,
    .step = step,
    .velocity = velocity,
    .spin = spin,
};
