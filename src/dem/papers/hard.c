/* Hard collisions of a run; see method.h. */
#include <math.h>
#include <string.h>

#include "dem/observe/observe.h"
#include "dem/forces/forces.h"
#include "dem/list/list.h"
#include "dem/state/motion.h"

/* Path of a free grain over the coming step, with constant acceleration, for which leapfrog is exact. Times
 * count from the step's start. */
typedef struct {
    dem_vec x, v, a; /* position and velocity of the start */
} path;

static path path_of(const dem_sim *sim, size_t i)
{
    const dem_vec a = dem_is_fixed(sim, i) ? (dem_vec){0.0, 0.0} : dem_acceleration_of(sim, i);
    return (path){sim->grains.motion[i].x, sim->grains.motion[i].v + 0.5 * sim->def.dt * a, a};
}

static dem_body body_at(const dem_sim *sim, size_t i, const path *m, double t)
{
    const dem_vec v = m->v + t * m->a;
    dem_body body = {{v[0], v[1]}, .arm = sim->grains.radius[i], .inverse_mass = sim->grains.inverse_mass[i]};
    if (sim->grains.omega) {
        body.inverse_inertia = sim->grains.inverse_inertia[i];
        body.omega = sim->grains.omega[i] + dem_spin_gain_of(sim, i, 0.5 * sim->def.dt + t);
    }
    return body;
}

/* Change the velocity of grain i at time t from that of body `from` to that of body `to`. The whole step then
 * has the new velocity, from a start that is moved back to match. */
static void redirect(dem_sim *sim, size_t i, const dem_body *from, const dem_body *to, double t)
{
    const dem_vec gain = {to->v[0] - from->v[0], to->v[1] - from->v[1]};
    sim->grains.motion[i].v += gain;
    sim->grains.motion[i].x -= t * gain;
    if (sim->grains.omega) {
        sim->grains.omega[i] += to->omega - from->omega;
        sim->grains.angle[i] -= t * (to->omega - from->omega);
    }
    if (!dem_is_fixed(sim, i)) dem_loops_1.predict(sim, i, i + 1, &(dem_moved){0});
    if (sim->grains.collided[i]) return;
    sim->grains.collided[i] = true;
    for (size_t c = sim->collided.n; c < DEM_FEW; c++) sim->collided.few[c] = (uint32_t)i;
    sim->collided.n++;
}

/* Collide two bodies, unless one step of the acceleration that presses them together is above their closing
 * speed, eq (22). */
static bool collide(dem_sim *sim, dem_body *one, dem_body *two, dem_vec n, double pressing)
{
    const double closing = (one->v[0] - two->v[0]) * n[0] + (one->v[1] - two->v[1]) * n[1];
    const dem_hard *hard = &sim->def.hard;
    dem_impulse impulse;
    if (closing <= sim->def.dt * pressing ||
        !dem_impact(one, two, (double[]){n[0], n[1]}, hard->restitution, hard->mu, &impulse))
        return false;
    sim->count.collisions++;
    return true;
}

/* First time within the step at which |d + v t + a t^2/2| falls to radii; INFINITY for none. Newton's method
 * starts from the straight line between start and end. */
static double time_of_touch(dem_vec d, dem_vec v, dem_vec a, double radii, double dt)
{
    const dem_vec line = v + 0.5 * dt * a;
    const double gap2 = dem_dot(d, d) - radii * radii, b = dem_dot(d, line),
                 root2 = b * b - dem_dot(line, line) * gap2;
    if (!(b < 0.0 && root2 >= 0.0)) return INFINITY;
    double t = gap2 / (sqrt(root2) - b);
    if (t > dt) return INFINITY;
    for (int k = 0; k < 4; k++) { /* the error is dt/8 at first, and falls to round-off */
        const dem_vec separation = d + t * (v + 0.5 * t * a);
        const double slope = 2.0 * dem_dot(separation, v + t * a);
        if (!(slope < 0.0)) return INFINITY; /* it only grazes */
        t -= (dem_dot(separation, separation) - radii * radii) / slope;
    }
    return t >= 0.0 && t <= dt ? t : INFINITY;
}

static void collide_pair(dem_sim *sim, size_t i, size_t j, double radii)
{
    const path m_i = path_of(sim, i), m_j = path_of(sim, j);
    const dem_vec d = m_i.x - m_j.x, v = m_i.v - m_j.v, a = m_i.a - m_j.a;
    const double t = time_of_touch(d, v, a, radii, sim->def.dt);
    if (isinf(t)) return;
    const dem_vec n = (d + t * (v + 0.5 * t * a)) * (-1.0 / radii);
    const dem_body before[2] = {body_at(sim, i, &m_i, t), body_at(sim, j, &m_j, t)};
    dem_body after[2] = {before[0], before[1]};
    if (!collide(sim, &after[0], &after[1], n, dem_dot(a, n))) return;
    if (sim->ledger) dem_ledger_collision(sim, (size_t[]){i, j}, before, after);
    redirect(sim, i, &before[0], &after[0], t);
    redirect(sim, j, &before[1], &after[1], t);
}

/* The corner at the end of a wall counts as the line across the direction to it. */
static void collide_wall(dem_sim *sim, dem_wall_slot slot)
{
    const size_t i = slot.grain;
    dem_touch touch;
    if (!dem_wall_touch(sim, &slot, &touch) || touch.overlap > 0.0) return;
    if (!dem_wall_is_line(&sim->walls.wall[slot.wall]) && dem_wall_yields(sim, &slot, &touch)) return;
    const path m = path_of(sim, i);
    const dem_vec normal = touch.normal;
    const double closing = -dem_dot(m.v - touch.velocity, normal), pressing = -dem_dot(m.a, normal),
                 root2 = closing * closing - 2.0 * pressing * touch.overlap;
    if (!(root2 >= 0.0 && sqrt(root2) + closing > 0.0)) return;
    const double t = -2.0 * touch.overlap / (sqrt(root2) + closing);
    if (t > sim->def.dt) return;
    const dem_body before[2] = {body_at(sim, i, &m, t), {{touch.velocity[0], touch.velocity[1]}}};
    dem_body after[2] = {before[0], before[1]};
    if (!collide(sim, &after[0], &after[1], -normal, pressing)) return;
    if (sim->ledger) dem_ledger_collision(sim, (size_t[]){i, i}, before, after);
    redirect(sim, i, &before[0], &after[0], t);
}

/* The first slot of wall w from k on that may collide: soft contacts with a wall at rest are skipped. */
static size_t next_slot(const dem_sim *sim, size_t w, size_t k, bool collided_only)
{
    const bool rests = dem_wall_rests(sim, w);
    const size_t end = sim->walls.start[w + 1];
    const dem_vec point = sim->walls.line[w].point, direction = sim->walls.line[w].direction;
    for (; k < end; k++) {
        const dem_wall_slot *slot = &sim->walls.slot[k];
        const size_t i = slot->grain;
        if (collided_only && !sim->grains.collided[i]) continue;
        const dem_vec d = sim->grains.motion[i].x - point;
        if (!(rests && sim->grains.radius[i] - slot->side * dem_dot(d, direction) > 0.0)) break;
    }
    return k;
}

static void collide_walls(dem_sim *sim, bool collided_only)
{
    for (size_t w = 0; w < sim->def.n_walls; w++)
        for (size_t k = next_slot(sim, w, sim->walls.start[w], collided_only); k < sim->walls.start[w + 1];
             k = next_slot(sim, w, k + 1, collided_only))
            collide_wall(sim, sim->walls.slot[k]);
}

static void collide_listed(dem_sim *sim, size_t k)
{
    const size_t i = sim->pairs.i[k], j = sim->pairs.j[k];
    const dem_vec d = sim->grains.motion[i].x - sim->grains.motion[j].x;
    const double radii = sim->pairs.radii[k];
    if (dem_dot(d, d) >= radii * radii) collide_pair(sim, i, j, radii);
}

/* Before the first collision only pairs that are apart may touch; later also pairs of grains that have
 * collided. */
static void collide_all(dem_sim *sim)
{
    const size_t n = sim->pairs.n;
    for (size_t k = 0, apart = sim->loops.next_approaching(sim, 0, n);; k++) {
        if (apart < k) apart = sim->loops.next_approaching(sim, k, n);
        k = sim->collided.n > 0 ? sim->loops.next_collided(sim, k, apart) : apart;
        if (k >= n) break;
        collide_listed(sim, k);
    }
    collide_walls(sim, false);
}

/* Only pairs and slots of grains that have collided can change. */
static void collide_again(dem_sim *sim)
{
    const size_t n = sim->pairs.n;
    for (size_t k = sim->loops.next_collided(sim, 0, n); k < n; k = sim->loops.next_collided(sim, k + 1, n))
        collide_listed(sim, k);
    collide_walls(sim, true);
}

/* Predict all grains; gives one that moves beyond its margin, DEM_NOBODY for none. */
static size_t predict_all(dem_sim *sim)
{
    dem_moved moved = {0};
    sim->loops.predict(sim, 0, sim->grains.n, &moved);
    for (size_t k = 0; k < sim->grains.n_fixed; k++)
        sim->grains.next_motion[sim->grains.fixed[k]] = sim->grains.motion[sim->grains.fixed[k]];
    for (size_t i = sim->grains.n; i-- > 0 && moved.left;)
        if (dem_beyond_margin(sim, i, sim->grains.next_motion[i].x)) return i;
    return DEM_NOBODY;
}

/* A collision may send a grain into the next: a few rounds; pairs that still approach then touch softly. */
static rp_status collide_in_step(dem_sim *sim)
{
    enum { ROUNDS = 8 };
    size_t beyond = predict_all(sim);
    for (int renewed = 0; beyond != DEM_NOBODY; renewed++) {
        if (renewed == 2)
            return dem_stop(sim, DEM_FAULT_TOO_FAST, beyond,
                            "moves beyond its margin of the neighbour list, %g, in one step",
                            sqrt(sim->grains.margin2[beyond]));
        RP_TRY(dem_neighbours_renew(sim, renewed > 0));
        beyond = predict_all(sim);
    }
    long before = sim->count.collisions;
    if (sim->collided.n > 0) memset(sim->grains.collided, 0, sim->grains.n * sizeof *sim->grains.collided);
    sim->collided.n = 0;
    collide_all(sim);
    for (int round = 1; round < ROUNDS && sim->count.collisions > before; round++) {
        before = sim->count.collisions;
        collide_again(sim);
    }
    return RP_OK;
}

/* Margins of grains without a collision were checked before. */
static void move(dem_sim *sim, unsigned *left)
{
    dem_motion *const grain = sim->grains.motion;
    double *const omega = sim->grains.omega, *const angle = sim->grains.angle;
    const bool few = sim->collided.n <= DEM_FEW;
    const size_t n = few ? sim->collided.n : sim->grains.n;
    for (size_t c = 0; c < n; c++) {
        const size_t i = few ? sim->collided.few[c] : c;
        *left |= (sim->grains.collided[i] && dem_beyond_margin(sim, i, sim->grains.next_motion[i].x)) *
                 DEM_LIST_OUT;
    }
    sim->grains.motion = sim->grains.next_motion, sim->grains.next_motion = grain;
    sim->grains.omega = sim->grains.next_omega, sim->grains.next_omega = omega;
    sim->grains.angle = sim->grains.next_angle, sim->grains.next_angle = angle;
    for (size_t i = 0; i < sim->grains.n &&
                       (isfinite(sim->def.x_min) || isfinite(sim->def.x_max) || isfinite(sim->def.y_min));
         i++)
        *left |= dem_beyond(sim, sim->grains.motion[i].x) * DEM_GRAIN_OUT;
    const dem_forces forces = dem_forces_of(&sim->grains);
    memset(forces.at, 0, sim->grains.n * forces.size);
    sim->count.grain_steps += (double)sim->grains.n;
}

const dem_collisions dem_collisions_hard = {.collide = collide_in_step, .move = move};
