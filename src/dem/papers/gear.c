/* Gear's predictor-corrector of fifth order, six values: Allen & Tildesley, Computer Simulation of Liquids
 * (1987), appendix E, for an equation of second order whose forces depend on velocities. Forces are taken
 * once a step, at predicted positions and velocities of the full step. A shear spring grows by the
 * displacement from one such position to the next: it is then a function of positions, as the overlap is,
 * where the sum of predicted v dt would lead by half a step and add k_s dt/2 of viscous damping. Derivatives
 * 3 to 5 start at 0, which is exact for grains that touch nothing. */
#include <math.h>

#include "core/elementary.h"
#include "dem/forces/forces.h"
#include "dem/methods/methods.h"
#include "dem/state/motion.h"

static const double correct_x = 3.0 / 16.0, correct_v = 251.0 / 360.0;
static const double correct_q[4] = {1.0, 11.0 / 18.0, 1.0 / 6.0, 1.0 / 60.0};

/* What it keeps: derivatives 2 to 5, x^(k) dt^k/k!. */
typedef struct {
    dem_vec q[4];
} gear;
_Static_assert(sizeof(gear) <= sizeof(dem_own), "room of an integrator");

static inline gear *gear_of(const dem_sim *sim, size_t i)
{
    return (gear *)&sim->grains.own[i];
}

static void hold_fixed(dem_sim *sim)
{
    dem_hold_fixed(sim);
    for (size_t k = 0; k < sim->grains.n_fixed; k++) {
        *gear_of(sim, sim->grains.fixed[k]) = (gear){0};
        sim->grains.excess[sim->grains.fixed[k]] = (dem_vec){0.0, 0.0};
    }
}

static unsigned predict(dem_sim *sim)
{
    const double dt = sim->def.dt;
    unsigned left = 0;
    for (size_t i = 0; i < sim->grains.n; i++) {
        dem_motion *grain = &sim->grains.motion[i];
        dem_vec *q = gear_of(sim, i)->q;
        const dem_vec curve = q[0] + q[1] + q[2] + q[3];
        const dem_vec gain = 2.0 * q[0] + 3.0 * q[1] + 4.0 * q[2] + 5.0 * q[3]; /* of v dt */
        grain->x += grain->v * dt + curve;
        grain->v += gain / dt;
        sim->grains.excess[i] += curve - gain;
        q[0] += 3.0 * q[1] + 6.0 * q[2] + 10.0 * q[3];
        q[1] += 4.0 * q[2] + 10.0 * q[3];
        q[2] += 5.0 * q[3];
        *dem_force(sim, i) = (dem_vec){0.0, 0.0};
        left |=
            dem_beyond_margin(sim, i, grain->x) * DEM_LIST_OUT | dem_beyond(sim, grain->x) * DEM_GRAIN_OUT;
    }
    sim->count.grain_steps += (double)sim->grains.n;
    hold_fixed(sim);
    return left;
}

static void correct(dem_sim *sim)
{
    const double dt = sim->def.dt;
    for (size_t i = 0; i < sim->grains.n; i++) {
        gear *g = gear_of(sim, i);
        dem_vec error = 0.5 * dt * dt * dem_acceleration_of(sim, i) - g->q[0];
        sim->grains.excess[i] = correct_x * error;
        sim->grains.motion[i].x += sim->grains.excess[i];
        sim->grains.motion[i].v += correct_v / dt * error;
        for (int k = 0; k < 4; k++) g->q[k] += correct_q[k] * error;
    }
    hold_fixed(sim);
}

static rp_status step(dem_sim *sim, bool last)
{
    (void)last;
    dem_walls_move(sim);
    RP_TRY(dem_step_lists(sim, predict(sim)));
    RP_TRY(dem_step_forces(sim));
    correct(sim);
    return RP_OK;
}

static void start(dem_sim *sim, size_t from)
{
    const double dt = sim->def.dt;
    for (size_t i = from; i < sim->grains.n; i++)
        *gear_of(sim, i) = (gear){.q[0] = 0.5 * dt * dt * dem_acceleration_of(sim, i)};
    hold_fixed(sim);
}

static void change_gravity(dem_sim *sim, dem_vec change)
{
    const double dt = sim->def.dt;
    for (size_t i = 0; i < sim->grains.n; i++) gear_of(sim, i)->q[0] += 0.5 * dt * dt * change;
    hold_fixed(sim);
}

/* Where damping rules, a scheme of one force evaluation a step is as stable as its predictor, gamma dt <
 * 90/551 (Adams-Bashforth), with the damping of three contacts on a grain. Without damping a mode loses
 * energy below omega dt = 0.33 and gains above it, 0.5 % a period at 0.5, which damping outweighs. A
 * packing's modes are free of growth below 1/hypot(18.4 gamma, 3 omega) or a little less.
 *
 * Two of the lightest grains bear less than a column: in boxes of 110 to 440 grains with k_n of 1e5 to 1e7,
 * gamma_n of 50 to 1000, also linear, they begin to rattle for ever between 1.0 and 1.2 times 1/hypot(18.4
 * gamma, 2 omega); of 60 and 200, three each, gamma_n of 50 to 4500, none does at 1.05. */
static double step_limit(const dem_definition *def, dem_rates rates, dem_load load)
{
    (void)def;
    const double springs = load == DEM_AT_REST || load == DEM_OF_MANY ? 2.0 : 3.0,
                 rate = rp_hypot(3.0 * rates.gamma * 551.0 / 90.0, springs * sqrt(rates.omega2)),
                 own = rate > 0.0 ? 1.0 / rate : INFINITY;
    switch (load) {
    case DEM_AT_REST: return own;
    case DEM_OF_MANY: return 0.8 * own; /* equal grains gain more than they lose at 0.9 */
    case DEM_AT_START: return fmin(dem_half_step_limit(rates, 0.85), 0.85 * own);
    case DEM_AT_IMPACT: break;
    }
    return dem_half_step_limit(rates, 0.85);
}

/* Undamped impacts gain 0.36 (omega dt)^6 of their energy in the mean, with any law, where damping takes pi
 * gamma/omega. Of what beds and lattices that fall bear; with a linear spring, as stiff at once, less, and
 * least where springs stick and slip. */
static double impact_limit(const dem_definition *def, double damping, double shear)
{
    const bool constant = dem_normal_descriptors[def->normal].constant_stiffness;
    return rp_pow((constant ? 1.5 / (1.0 + fmin(shear, 1.0)) : 3.2) * damping, 1.0 / 3.0);
}

const dem_scheme dem_scheme_gear5 = {
    .name = "gear5",
    .order = {4, 2}, /* until a third derivative that starts at 0 is wrong */
    .excess = true,
    .own = sizeof(gear),
    .step_limit = step_limit,
    .impact_limit = impact_limit,
    .start = start,
    .gravity = change_gravity,
    .step = step,
};
