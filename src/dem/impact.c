/* Hard collisions; see impact.h. In a run, what would come to touch in the coming step collides at the moment
 * of touching, if it comes fast; else a soft contact forms. */
#include "dem/impact.h"

#include <math.h>

#include "dem/sim.h"

/* (6), (13) and (14): the impulse (p_x, p_y), and the turn that its tangential part gives either body alike.
 */
static void push(dem_body *body, double p_x, double p_y, double p_t)
{
    body->v[0] += body->inverse_mass * p_x;
    body->v[1] += body->inverse_mass * p_y;
    body->omega += body->inverse_inertia * body->arm * p_t;
}

bool dem_impact(dem_body *one, dem_body *two, const double n[2], double restitution, double mu,
                dem_impulse *impulse)
{
    const double vx = one->v[0] - two->v[0], vy = one->v[1] - two->v[1];
    const double v_n = vx * n[0] + vy * n[1];
    if (!(v_n > 0.0)) return false;
    /* (9) with (17), (18) */
    const double v_t = vy * n[0] - vx * n[1] + one->arm * one->omega + two->arm * two->omega;
    const double inverse_n = one->inverse_mass + two->inverse_mass;
    const double inverse_t =
        inverse_n + one->arm * one->arm * one->inverse_inertia + two->arm * two->arm * two->inverse_inertia;
    const double p_n = -(1.0 + restitution) * v_n / inverse_n; /* (12) */
    const double no_slip = -v_t / inverse_t, most = -mu * p_n; /* (16); (7) as a magnitude */
    impulse->slips = fabs(no_slip) > most;                     /* (19) */
    const double p_t = impulse->slips ? copysign(most, no_slip) : no_slip;
    impulse->normal = p_n;
    impulse->tangential = p_t;
    const double p_x = p_n * n[0] - p_t * n[1], p_y = p_n * n[1] + p_t * n[0]; /* (20), (21) */
    push(one, p_x, p_y, p_t);
    push(two, -p_x, -p_y, p_t);
    return true;
}

/* A grain as the coming step's kick will leave it, and its acceleration. */
static dem_body kicked(const dem_sim *sim, size_t i, dem_vec *acceleration)
{
    const double dt = sim->def.dt, inverse_mass = sim->inverse_mass[i];
    *acceleration = inverse_mass > 0.0 ? sim->force[i] * inverse_mass + sim->gravity : (dem_vec){0.0, 0.0};
    const dem_vec v = sim->grain[i].v + dt * *acceleration;
    dem_body body = {{v[0], v[1]}, .arm = sim->radius[i], .inverse_mass = inverse_mass};
    if (sim->spin) {
        const dem_spin *p = &sim->spin[i];
        body.omega = p->omega + dt * p->inverse_inertia * p->torque;
        body.inverse_inertia = p->inverse_inertia;
    }
    return body;
}

/* Let grain i, at the time t of the coming step, go from one motion to another: the place that it starts the
 * step from is moved to where the new motion leads back to. */
static void deflect(dem_sim *sim, size_t i, const dem_body *from, const dem_body *to, double t)
{
    const dem_vec gain = {to->v[0] - from->v[0], to->v[1] - from->v[1]};
    sim->grain[i].v += gain;
    sim->grain[i].x -= t * gain;
    if (!sim->spin) return;
    sim->spin[i].omega += to->omega - from->omega;
    sim->spin[i].angle -= t * (to->omega - from->omega);
}

static bool collide(dem_sim *sim, dem_body *one, dem_body *two, dem_vec n)
{
    dem_impulse impulse;
    if (!dem_impact(one, two, (double[]){n[0], n[1]}, sim->def.hard.restitution, sim->def.hard.mu, &impulse))
        return false;
    sim->collisions++;
    return true;
}

/* Eq (22), of a closing speed: does a step's acceleration together make it up? */
static bool is_soft(const dem_sim *sim, double closing, double pressing)
{
    return closing <= sim->def.dt * pressing;
}

static bool collide_pair(dem_sim *sim, size_t i, size_t j, double reach)
{
    const dem_vec d = sim->grain[i].x - sim->grain[j].x;
    const double gap2 = dem_dot(d, d) - reach * reach;
    if (gap2 < 0.0) return false; /* a soft contact */
    dem_vec a_i, a_j;
    const dem_body before_i = kicked(sim, i, &a_i), before_j = kicked(sim, j, &a_j);
    const dem_vec v = {before_i.v[0] - before_j.v[0], before_i.v[1] - before_j.v[1]};
    /* first time at which |d + v t| = reach */
    const double b = dem_dot(d, v), root2 = b * b - dem_dot(v, v) * gap2;
    if (!(b < 0.0 && root2 >= 0.0)) return false;
    const double t = gap2 / (sqrt(root2) - b);
    if (t >= sim->def.dt) return false;
    const dem_vec n = (d + t * v) * (-1.0 / reach);
    if (is_soft(sim, dem_dot(v, n), dem_dot(a_i - a_j, n))) return false;
    dem_body after_i = before_i, after_j = before_j;
    if (!collide(sim, &after_i, &after_j, n)) return false;
    deflect(sim, i, &before_i, &after_i, t);
    deflect(sim, j, &before_j, &after_j, t);
    return true;
}

/* The corner at the end of a wall counts as the line across the direction to it. */
static bool collide_wall(dem_sim *sim, dem_wall_slot slot)
{
    const size_t i = slot.grain;
    dem_vec normal, wall_velocity, a;
    double overlap;
    if (!dem_wall_touch(sim, &slot, &normal, &overlap, &wall_velocity) || overlap > 0.0) return false;
    const dem_body before = kicked(sim, i, &a);
    const double closing = -dem_dot((dem_vec){before.v[0], before.v[1]} - wall_velocity, normal);
    if (!(closing * sim->def.dt > -overlap) || is_soft(sim, closing, -dem_dot(a, normal))) return false;
    dem_body after = before, wall = {{wall_velocity[0], wall_velocity[1]}};
    if (!collide(sim, &after, &wall, -normal)) return false;
    deflect(sim, i, &before, &after, -overlap / closing);
    return true;
}

static bool collide_all(dem_sim *sim)
{
    bool any = false;
    for (size_t k = 0; k < sim->n_pairs; k++)
        any |= collide_pair(sim, sim->pair_i[k], sim->pair_j[k], sim->pair_radii[k]);
    for (size_t k = 0; k < sim->n_wall_slots; k++) any |= collide_wall(sim, sim->wall_slot[k]);
    return any;
}

/* First grain that the coming step brings to where the neighbour list may lack a pair of its; n for none. */
static size_t beyond_list(const dem_sim *sim)
{
    size_t i = 0;
    for (; i < sim->n; i++) {
        dem_vec a;
        const dem_body body = kicked(sim, i, &a);
        const dem_vec moved = sim->grain[i].x + sim->def.dt * (dem_vec){body.v[0], body.v[1]} - sim->ref[i];
        if (!(dem_dot(moved, moved) <= 0.25 * sim->skin * sim->skin)) break;
    }
    return i;
}

/* A collision may send a grain into the next: a few rounds, then what still closes meets softly. */
rp_status dem_impacts_apply(dem_sim *sim)
{
    enum { ROUNDS = 8 };
    if (beyond_list(sim) < sim->n) {
        rp_status status = dem_neighbours_rebuild(sim);
        const size_t i = status ? sim->n : beyond_list(sim);
        if (status || i < sim->n)
            return status ? status
                          : dem_stop(sim, DEM_FAULT_TOO_FAST, i,
                                     "moves beyond half the skin of the neighbour list, %g, in one step",
                                     0.5 * sim->skin);
    }
    for (int round = 0; round < ROUNDS && collide_all(sim); round++) {
    }
    return RP_OK;
}
