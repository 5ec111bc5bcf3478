/* Velocity Verlet in its leapfrog form: v(n+1/2) = v(n-1/2) + dt a(n), x(n+1) = x(n) + dt v(n+1/2).
 * Velocity-dependent forces take the mid-step velocity, which is also the exact increment of the shear
 * spring; their phase lag of dt/2 is of first order, as is everything at a contact that damps on touch. */
#include <math.h>

#include "dem/methods/hard.h"
#include "dem/forces/forces.h"
#include "dem/methods/step.h"
#include "dem/threads/team.h"
#include "dem/state/motion.h"

/* Spins and angles by the same leapfrog, of the grains i..to. */
static void integrate_spins(dem_sim *sim, size_t i, size_t to)
{
    const dem_equation e = dem_equation_of(sim);
    for (; i < to; i++) {
        dem_leap_spin(&e, sim->grains.force_torque[i].torque, sim->grains.inverse_inertia[i],
                      &sim->grains.angle[i], &sim->grains.omega[i]);
        sim->grains.force_torque[i].torque = 0.0;
    }
}

/* As dem_advance_kernel, of all grains from..to. */
static void advance(dem_sim *sim, size_t from, size_t to, unsigned *left, double *speed2)
{
    const bool turned = sim->walls.angle != 0.0;
    const dem_equation e = dem_equation_of(sim);
    const double x_max = turned ? INFINITY : sim->def.x_max, y_min = turned ? -INFINITY : sim->def.y_min;
    dem_motion *restrict grain = sim->grains.motion;
    dem_vec *restrict force = dem_force(sim, 0);
    const size_t stride = sim->grains.force_torque ? sizeof *sim->grains.force_torque / sizeof *force : 1;
    const size_t advanced = sim->kernels.advance ? sim->kernels.advance(sim, from, to, left, speed2) : from;
    for (size_t i = advanced; i < to; i++) {
        const double inverse_mass = sim->grains.inverse_mass[i];
        dem_leap(&e, force[stride * i], (dem_vec){inverse_mass, inverse_mass}, &grain[i].x, &grain[i].v);
        force[stride * i] = (dem_vec){0.0, 0.0};
        const dem_vec x = grain[i].x, moved = speed2 ? grain[i].v : x - sim->grains.listed_x[i];
        const double moved2 = dem_dot(moved, moved);
        if (speed2)
            *speed2 = moved2 <= *speed2 ? *speed2 : isnan(moved2) ? INFINITY : moved2;
        else
            *left |= !(moved2 <= sim->grains.margin2[i]) * DEM_LIST_OUT; /* so that NaN counts as moved */
        *left |= ((x[0] > x_max) | (x[1] < y_min)) * DEM_GRAIN_OUT;
    }
    for (size_t i = from; i < to && turned; i++) *left |= dem_beyond(sim, grain[i].x) * DEM_GRAIN_OUT;
    if (sim->grains.omega) integrate_spins(sim, advanced, to);
}

/* Has a grain of a group moved beyond its margin, and how far may they go until one can? A displacement d
 * leaves m - d >= (m^2 - d^2) / (2 m) of a margin m. */
static unsigned measure_slack(dem_sim *sim, size_t from, size_t to)
{
    unsigned left = 0;
    double margin2 = 0.0, beyond = -INFINITY;
    for (size_t i = sim->kernels.beyond_margin
                        ? sim->kernels.beyond_margin(sim, from, to, &left, &margin2, &beyond)
                        : from;
         i < to; i++) {
        const dem_vec moved = sim->grains.motion[i].x - sim->grains.listed_x[i];
        const double moved2 = dem_dot(moved, moved);
        left |= !(moved2 <= sim->grains.margin2[i]) * DEM_LIST_OUT; /* so that NaN counts as moved */
        margin2 = fmax(margin2, sim->grains.margin2[i]);
        beyond = fmax(beyond, moved2 - sim->grains.margin2[i]);
    }
    sim->grains.slack[from / DEM_GROUP] = -0.5 * beyond / sqrt(margin2) - 1e-9 * sqrt(margin2);
    return left;
}

/* Advance the grains from..to by a step, `from` a multiple of DEM_GROUP, and clear their forces. Gives
 * DEM_LIST_OUT and DEM_GRAIN_OUT. In a pile larger than the cache, margins are checked only where they may be
 * used up. In a smaller one, checking all costs less. */
static unsigned move(dem_sim *sim, size_t from, size_t to)
{
    const bool large = sim->pairs.n_chunks > 0;
    unsigned left = 0;
    if (!large) advance(sim, from, to, &left, NULL);
    for (size_t end; large && from < to; from = end) {
        double speed2 = 0.0, *slack = &sim->grains.slack[from / DEM_GROUP];
        unsigned out = 0;
        end = from + DEM_GROUP < to ? from + DEM_GROUP : to;
        advance(sim, from, end, &out, &speed2);
        *slack -= 1.000001 * sim->def.dt * sqrt(speed2) + sim->list.round_off;
        if (!(*slack > 0.0)) left |= measure_slack(sim, from, end);
        if (out) *slack = DEM_SLACK_OUT;
        left |= out;
    }
    return left;
}

/* Move the grains from..to of a part in groups that other parts read, or in the others. */
static void move_groups(dem_sim *sim, const dem_part *part, size_t from, size_t to, bool late)
{
    for (size_t end; from < to; from = end) {
        bool is_late = false;
        if (!part->late) {
            end = to;
        } else {
            is_late = part->late[from / DEM_GROUP];
            for (end = from; end < to && part->late[end / DEM_GROUP] == is_late;) end += DEM_GROUP;
            end = end < to ? end : to;
        }
        if (is_late == late) sim->ahead_left |= move(sim, from, end);
    }
}

static void hold_fixed(dem_sim *sim, const dem_part *part, bool late)
{
    for (size_t k = 0; k < sim->grains.n_fixed; k++) {
        const size_t i = sim->grains.fixed[k];
        if (i >= part->grain && i < part->grain_end && (part->late && part->late[i / DEM_GROUP]) == late)
            dem_hold_grain(sim, i);
    }
}

static rp_status move_late(dem_sim *sim, dem_part *part)
{
    dem_threads_enter(sim, part);
    move_groups(sim, part, part->grain, part->grain_end, true);
    hold_fixed(sim, part, true);
    return RP_OK;
}

static rp_status move_part(dem_sim *sim, dem_part *part)
{
    dem_threads_enter(sim, part);
    move_groups(sim, part, part->grain, part->grain_end, false);
    hold_fixed(sim, part, false);
    return part->late ? move_late(sim, part) : RP_OK;
}

/* May grains go on before the forces on all the others are there? */
static bool may_run_ahead(const dem_sim *sim)
{
    const dem_definition *def = &sim->def;
    return sim->pairs.n_chunks > 0 && def->kernel != DEM_REFERENCE && !def->hard.on && !sim->ledger &&
           !sim->times && def->turn_per_step == 0.0 && def->box_turn_per_step == 0.0 &&
           sim->walls.n_moving == 0;
}

/* The forces of the walls on the grains from..to of a part, after those of pairs k..end; then their next
 * step, if they run ahead. */
static rp_status finish_grains(dem_sim *sim, const dem_part *part, size_t k, size_t end, size_t from,
                               size_t to)
{
    dem_walls_apply(sim, from, to, sim->def.dt);
    if (sim->too_deep) RP_TRY(dem_check_overlaps(sim, k, end, from, part->grain_end));
    if (sim->ahead) move_groups(sim, part, from, to, false);
    return RP_OK;
}

/* The forces on a part, and the next step of the grains behind them while these are in the cache. */
static rp_status sum_part(dem_sim *sim, dem_part *part)
{
    dem_threads_enter(sim, part);
    size_t k = part->pair, i = part->grain;
    dem_threads_copies(sim, &part->before);
    for (size_t c = 0, end; k < part->pair_end; c++, k = end) {
        end = k + sim->pairs.chunk < part->pair_end ? k + sim->pairs.chunk : part->pair_end;
        sim->kernels.pairs(sim, k, end, sim->def.dt);
        RP_TRY(finish_grains(sim, part, k, end, i, part->done[c]));
        i = part->done[c];
    }
    dem_threads_copies(sim, &part->after);
    if (i < part->grain_end) RP_TRY(finish_grains(sim, part, k, k, i, part->grain_end));
    if (sim->ahead) hold_fixed(sim, part, false);
    return RP_OK;
}

/* The forces of a step that is not the last one, and the next step of grains that run ahead. */
static rp_status sum_all(dem_sim *sim)
{
    sim->ahead_left = 0;
    sim->ahead = may_run_ahead(sim);
    if (!sim->ahead && !dem_threads_divided(sim)) return dem_step_forces(sim);
    RP_TRY(dem_threads_do_parts(sim, sum_part));
    if (!sim->ahead) return RP_OK;
    sim->count.grain_steps += (double)(sim->grains.n - sim->grains.n_gone);
    return dem_threads_divided(sim) ? dem_threads_do_parts(sim, move_late) : RP_OK;
}

static rp_status step(dem_sim *sim, bool last)
{
    const bool hard = sim->def.hard.on, ahead = sim->ahead;
    rp_status status = hard ? dem_hard_apply(sim) : RP_OK;
    if (status) return status;
    dem_walls_move(sim);
    sim->ahead = false;
    if (!hard && !ahead) {
        sim->count.grain_steps += (double)(sim->grains.n - sim->grains.n_gone);
        sim->ahead_left = 0;
        RP_TRY(dem_threads_do_parts(sim, move_part));
    }
    RP_TRY(dem_step_lists(sim, hard ? dem_hard_move(sim) : sim->ahead_left));
    return last ? dem_step_forces(sim) : sum_all(sim);
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
    return load == DEM_AT_REST
               ? INFINITY
               : dem_half_step_limit(rates,
                                     dem_normal_descriptors[def->normal].constant_stiffness ? 0.95 : 0.85);
}

const dem_scheme dem_scheme_verlet = {
    .name = "verlet",
    .order = {2, 1}, /* it damps by the velocity of half a step before */
    .rotation = true,
    .hard = true,
    .runs_ahead = true,
    .step_limit = step_limit,
    .start = start,
    .gravity = change_gravity,
    .step = step,
    .velocity = velocity,
    .spin = spin,
};
