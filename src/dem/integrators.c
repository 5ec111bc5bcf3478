/* Time integration.
 *
 * Velocity Verlet in its leapfrog form: v(n+1/2) = v(n-1/2) + dt a(n), x(n+1) = x(n) + dt v(n+1/2).
 * Velocity-dependent forces take the mid-step velocity, which is also the exact increment of the shear
 * spring; their phase lag of dt/2 is of first order, as is everything at a contact that damps on touch.
 *
 * Gear's predictor-corrector of fifth order, six values: Allen & Tildesley, Computer Simulation of Liquids
 * (1987), appendix E, for an equation of second order whose forces depend on velocities. Forces are taken
 * once a step, at predicted places and velocities of the full step. A shear spring grows by the way from one
 * such place to the next: it is then a function of places, as the overlap is, where the sum of predicted
 * v dt would lead by half a step and add k_s dt/2 of viscous damping. Derivatives 3 to 5 start at 0, which
 * is exact for grains that touch nothing. */
#include <math.h>

#include "dem/sim.h"

/* Spins and angles by the same leapfrog, of the grains i..to. */
static void integrate_spins(dem_sim *sim, size_t i, size_t to)
{
    const double dt = sim->def.dt;
    for (; i < to; i++) {
        sim->omega[i] += dt * sim->inverse_inertia[i] * sim->push[i].torque;
        sim->angle[i] += dt * sim->omega[i];
        sim->push[i].torque = 0.0;
    }
}

static const double correct_x = 3.0 / 16.0, correct_v = 251.0 / 360.0;
static const double correct_q[4] = {1.0, 11.0 / 18.0, 1.0 / 6.0, 1.0 / 60.0};

/* Put fixed grains back to where they were at the last rebuilding, as ever. */
static void hold_fixed(dem_sim *sim)
{
    for (size_t k = 0; k < sim->n_fixed; k++) {
        const uint32_t i = sim->fixed[k];
        sim->grain[i] = (dem_record){sim->ref[i], {0.0, 0.0}};
        if (sim->gear) sim->gear[i] = (dem_gear){0};
    }
}

static dem_vec acceleration(const dem_sim *sim, size_t i)
{
    return *dem_force(sim, i) * sim->inverse_mass[i] + sim->gravity;
}

static inline void predict(dem_record *grain, dem_gear *gear, double dt)
{
    dem_vec *q = gear->q;
    dem_vec curve = q[0] + q[1] + q[2] + q[3];
    dem_vec gain = 2.0 * q[0] + 3.0 * q[1] + 4.0 * q[2] + 5.0 * q[3]; /* of v dt */
    grain->x += grain->v * dt + curve;
    grain->v += gain / dt;
    gear->slide += curve - gain;
    q[0] += 3.0 * q[1] + 6.0 * q[2] + 10.0 * q[3];
    q[1] += 4.0 * q[2] + 10.0 * q[3];
    q[2] += 5.0 * q[3];
}

/* As dem_advance, of all of them. */
static void advance(dem_sim *sim, size_t from, size_t to, unsigned *left, double *speed2)
{
    const bool turned = sim->box_angle != 0.0;
    const double dt = sim->def.dt;
    const double x_max = turned ? INFINITY : sim->def.x_max, y_min = turned ? -INFINITY : sim->def.y_min;
    const dem_vec gravity = sim->gravity;
    dem_record *restrict grain = sim->grain;
    dem_gear *restrict gear = sim->gear;
    dem_vec *restrict force = dem_force(sim, 0);
    const size_t stride = sim->push ? sizeof *sim->push / sizeof *force : 1;
    const size_t advanced = sim->advance ? sim->advance(sim, from, to, left, speed2) : from;
    for (size_t i = advanced; i < to; i++) {
        if (gear) {
            predict(&grain[i], &gear[i], dt);
        } else {
            grain[i].v += dt * (force[stride * i] * sim->inverse_mass[i] + gravity);
            grain[i].x += dt * grain[i].v;
        }
        force[stride * i] = (dem_vec){0.0, 0.0};
        const dem_vec x = grain[i].x, moved = speed2 ? grain[i].v : x - sim->ref[i];
        const double moved2 = dem_dot(moved, moved);
        if (speed2)
            *speed2 = moved2 <= *speed2 ? *speed2 : isnan(moved2) ? INFINITY : moved2;
        else
            *left |= !(moved2 <= sim->margin2[i]) * DEM_LIST_OUT; /* so that NaN counts as moved */
        *left |= ((x[0] > x_max) | (x[1] < y_min)) * DEM_GRAIN_OUT;
    }
    for (size_t i = from; i < to && turned; i++) *left |= dem_beyond(sim, grain[i].x) * DEM_GRAIN_OUT;
    if (sim->omega) integrate_spins(sim, advanced, to);
}

/* Look whether grains of a group have left their margins, and how far they may go until one can. A way d
 * leaves m - d >= (m^2 - d^2) / (2 m) of a margin m. */
static unsigned measure_slack(dem_sim *sim, size_t from, size_t to)
{
    unsigned left = 0;
    double margin2 = 0.0, beyond = -INFINITY;
    for (size_t i = sim->stray ? sim->stray(sim, from, to, &left, &margin2, &beyond) : from; i < to; i++) {
        const dem_vec moved = sim->grain[i].x - sim->ref[i];
        const double way2 = dem_dot(moved, moved);
        left |= !(way2 <= sim->margin2[i]) * DEM_LIST_OUT; /* so that NaN counts as moved */
        margin2 = fmax(margin2, sim->margin2[i]);
        beyond = fmax(beyond, way2 - sim->margin2[i]);
    }
    sim->slack[from / DEM_GROUP] = -0.5 * beyond / sqrt(margin2) - 1e-9 * sqrt(margin2);
    return left;
}

/* In a pile larger than the cache, margins are looked at only where they may have been used up. Where it is
 * not, and in flow, where that often is so, to look at once costs less. */
unsigned dem_integrate(dem_sim *sim, size_t from, size_t to)
{
    const bool large = sim->n_chunks > 0 && !sim->gear; /* Gear's places go otherwise */
    unsigned left = 0;
    sim->grain_steps += (double)(to - from);
    if (!large) advance(sim, from, to, &left, NULL);
    for (size_t end; large && from < to; from = end) {
        double speed2 = 0.0, *slack = &sim->slack[from / DEM_GROUP];
        end = from + DEM_GROUP < to ? from + DEM_GROUP : to;
        advance(sim, from, end, &left, &speed2);
        *slack -= 1.000001 * sim->def.dt * sqrt(speed2) + sim->round_off;
        if (!(*slack > 0.0)) left |= measure_slack(sim, from, end);
    }
    if (to == sim->n) hold_fixed(sim);
    return left;
}

void dem_integrate_correct(dem_sim *sim)
{
    const double dt = sim->def.dt;
    for (size_t i = 0; i < sim->n; i++) {
        dem_gear *g = &sim->gear[i];
        dem_vec error = 0.5 * dt * dt * acceleration(sim, i) - g->q[0];
        g->slide = correct_x * error;
        sim->grain[i].x += g->slide;
        sim->grain[i].v += correct_v / dt * error;
        for (int k = 0; k < 4; k++) g->q[k] += correct_q[k] * error;
    }
    hold_fixed(sim);
}

void dem_integrate_start(dem_sim *sim, size_t from)
{
    const double dt = sim->def.dt;
    if (sim->implicit) return;
    for (size_t i = from; i < sim->n; i++)
        if (sim->gear)
            sim->gear[i] = (dem_gear){.q[0] = 0.5 * dt * dt * acceleration(sim, i)};
        else
            sim->grain[i].v -= 0.5 * dt * acceleration(sim, i);
    for (size_t i = from; i < sim->n && sim->omega; i++)
        sim->omega[i] -= 0.5 * dt * sim->inverse_inertia[i] * sim->push[i].torque;
    hold_fixed(sim);
}

/* Velocities of the full step stay as they are. */
void dem_integrate_gravity(dem_sim *sim, dem_vec change)
{
    const double dt = sim->def.dt;
    if (sim->implicit) return;
    for (size_t i = 0; i < sim->n; i++)
        if (sim->gear)
            sim->gear[i].q[0] += 0.5 * dt * dt * change;
        else
            sim->grain[i].v -= 0.5 * dt * change;
    hold_fixed(sim);
}
