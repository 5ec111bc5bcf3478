/* Velocity Verlet in its leapfrog form: v(n+1/2) = v(n-1/2) + dt a(n), x(n+1) = x(n) + dt v(n+1/2).
 * Velocity-dependent forces take the mid-step velocity, which is also the exact increment of the shear
 * spring; their phase lag of dt/2 is of first order, as is everything at a contact that damps on touch. */
#include "dem/sim.h"

/* Spins and angles by the same leapfrog. */
static void integrate_spins(dem_sim *sim)
{
    const double dt = sim->def.dt;
    for (size_t i = 0; i < sim->n; i++) {
        dem_spin *p = &sim->spin[i];
        p->omega += dt * p->inverse_inertia * p->torque;
        p->angle += dt * p->omega;
        p->torque = 0.0;
    }
}

bool dem_integrate(dem_sim *sim)
{
    const double dt = sim->def.dt, x_max = sim->def.x_max, y_min = sim->def.y_min;
    const double reach = 0.25 * sim->skin * sim->skin; /* a pair closes by at most twice skin/2 */
    const dem_vec gravity = sim->gravity;
    dem_record *restrict grain = sim->grain;
    dem_vec *restrict force = sim->force;
    bool stale = false;
    for (size_t i = 0; i < sim->n; i++) {
        dem_vec v = grain[i].v + dt * (force[i] * sim->inverse_mass[i] + gravity);
        dem_vec x = grain[i].x + dt * v, moved = x - sim->ref[i];
        grain[i].v = v;
        grain[i].x = x;
        force[i] = (dem_vec){0.0, 0.0};
        /* written so that NaN counts as moved */
        stale |= !(dem_dot(moved, moved) <= reach) | (x[0] > x_max) | (x[1] < y_min);
    }
    if (sim->spin) integrate_spins(sim);
    sim->grain_steps += (double)sim->n;
    return stale;
}
