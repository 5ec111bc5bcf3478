/* Changes between steps. Laws, coefficients and time step that change while the grains stay: a simulation of
 * the new ones begins where the old one is, with its contacts. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/arena.h"
#include "dem/forces/forces.h"
#include "dem/list/list.h"
#include "dem/methods/methods.h"
#include "dem/observe/observe.h"
#include "dem/setup/definition.h"

/* Which grains are left out; NULL: none. */
typedef struct {
    dem_in_region *in;
    const void *region;
} choice;

/* Its grains in the order of their ids, but for those that are left out; ids[k] is that of number k. */
static rp_status copy_grains(rp_arena *arena, const dem_sim *sim, const choice *out, dem_definition *def,
                             uint32_t ids[])
{
    const size_t n = dem_count(sim);
    dem_state *states;
    dem_grain *grains;
    RP_NEW(arena, states, n);
    RP_NEW(arena, grains, n);
    RP_TRY(dem_states(sim, states));
    def->grains = grains, def->n_grains = 0, def->lines = NULL;
    for (const dem_state *s = states; s < states + n; s++) {
        if (out->in && out->in(out->region, s->id, s->x, s->y)) continue;
        ids[def->n_grains] = s->id;
        grains[def->n_grains++] =
            (dem_grain){s->x, s->y, s->r, s->m, s->vx, s->vy, s->angle, s->omega, s->fixed, s->kind};
    }
    return RP_OK;
}

/* Its contacts, by the numbers of the grains. */
static rp_status copy_contacts(rp_arena *arena, const dem_sim *sim, dem_definition *def, const uint32_t ids[])
{
    dem_contact *contacts;
    uint32_t *number; /* of each id, from 1; 0: left out, or a wall */
    size_t n;
    RP_NEW(arena, number, sim->grains.last_id + 1);
    for (size_t k = 0; k < def->n_grains; k++) number[ids[k]] = (uint32_t)k + 1;
    RP_TRY(dem_contacts(sim, &contacts, &n));
    if (!rp_arena_keep(arena, contacts, free)) return RP_NO_MEMORY;
    def->contacts = contacts, def->n_contacts = 0;
    for (size_t k = 0; k < n; k++) {
        dem_contact c = contacts[k];
        const bool wall = c.id_b == 0;
        c.id_a = number[c.id_a], c.id_b = number[c.id_b];
        if (c.id_a && (wall || c.id_b)) contacts[def->n_contacts++] = c;
    }
    return RP_OK;
}

/* Its walls where they are now, with the coefficients of the definition. One that is gone stays so. */
static rp_status copy_walls(rp_arena *arena, const dem_sim *sim, dem_definition *def)
{
    dem_wall *walls;
    RP_NEW(arena, walls, sim->def.n_walls);
    for (size_t w = 0; w < sim->def.n_walls; w++) {
        const dem_wall_state now = dem_wall_now(sim, w);
        dem_wall *wall = &walls[w];
        *wall = sim->walls.wall[w];
        wall->material = dem_walls_of(def)[w].material;
        memcpy(wall->point, now.point, sizeof wall->point);
        memcpy(wall->direction, now.direction, sizeof wall->direction);
        memcpy(wall->pivot, now.pivot, sizeof wall->pivot);
        if (!now.open) continue;
        wall->open_at_step = 0;
        if (now.ends[0] < now.ends[1])
            wall->extent[0] = now.ends[0];
        else
            wall->open_speed = INFINITY;
    }
    def->wall_list = walls, def->n_walls = sim->def.n_walls;
    return RP_OK;
}

/* What goes on from one to the other. */
static void go_on(dem_sim *made, const dem_sim *old, const uint32_t ids[])
{
    for (size_t i = 0; i < made->grains.n; i++) made->grains.id[i] = ids[made->grains.id[i] - 1];
    made->grains.last_id = old->grains.last_id;
    made->step = made->step0 = old->step;
    made->time0 = dem_time(old);
    made->gravity_norm = old->gravity_norm;
    made->count.rebuilds += old->count.rebuilds, made->count.collisions += old->count.collisions;
    made->count.grain_steps += old->count.grain_steps, made->count.iterations += old->count.iterations;
    made->threads = old->threads;
    made->walls.least_stride = old->walls.least_stride;
    for (size_t w = 0; w < made->def.n_walls; w++) {
        made->walls.line[w].since = made->step;
        made->walls.line[w].angle = dem_wall_now(old, w).angle;
        if (made->walls.wall[w].open_at_step == 0) made->walls.wall[w].open_at_step = made->step;
    }
}

static rp_status renew(dem_sim **sim, const dem_definition *laws, const choice *out)
{
    dem_sim *old = *sim, *made;
    dem_definition def = *laws;
    dem_ledger sum;
    uint32_t *ids;
    RP_SCOPE(arena);
    if (laws->n_walls != old->def.n_walls)
        return rp_fail(RP_BAD_INPUT, "%zu walls: there are %zu, which stay", laws->n_walls, old->def.n_walls);
    if (old->def.box_turn_per_step != 0.0 || old->walls.turn[1] != 0.0)
        return rp_fail(RP_BAD_INPUT, "laws, dt and grains can't be changed in a box that turns");
    RP_NEW(&arena, ids, dem_count(old));
    RP_TRY(copy_grains(&arena, old, out, &def, ids));
    RP_TRY(copy_contacts(&arena, old, &def, ids));
    RP_TRY(copy_walls(&arena, old, &def));
    def.radius_to_come = old->start.radius_mean, def.mass_to_come = old->start.mass_mean;
    dem_gravity(old, def.gravity);
    def.turn_per_step = old->def.turn_per_step, def.turn_from_step = old->def.turn_from_step;
    def.box_turn_per_step = 0.0;
    RP_TRY(dem_create(&def, &made));
    const double before = dem_energy_now(old);
    go_on(made, old, ids);
    if (made->ledger && dem_ledger_read(old, &sum)) {
        const rp_status status = dem_ledger_go_on(made, &sum, before, ids, out->in != NULL);
        if (status) return dem_free(made), status;
    }
    dem_free(old);
    *sim = made;
    return RP_OK;
}

rp_status dem_change(dem_sim **sim, const dem_definition *laws)
{
    return renew(sim, laws, &(choice){0});
}

rp_status dem_remove(dem_sim **sim, dem_in_region *in, const void *region)
{
    return renew(sim, &(*sim)->def, &(choice){in, region});
}

static rp_status check_number(const dem_sim *sim, size_t wall)
{
    if (wall < sim->def.n_walls) return RP_OK;
    return rp_fail(RP_BAD_INPUT, "wall %zu: there are %zu", wall + 1, sim->def.n_walls);
}

rp_status dem_wall_open(dem_sim *sim, size_t wall, double speed)
{
    RP_TRY(check_number(sim, wall));
    dem_wall next = sim->walls.wall[wall];
    double ends[2];
    const bool left = dem_wall_ends(sim, wall, ends), same = next.open_speed == speed;
    next.open_at_step = sim->step + 1, next.open_speed = speed;
    if (sim->def.ground.wall == (long)wall + 1)
        return rp_fail(RP_BAD_INPUT, "wall %zu: the ground can't open", wall + 1);
    if (dem_wall_opens(sim, wall)) next.extent[0] = ends[0];
    RP_TRY(rp_prefix(dem_wall_check(&next), "wall %zu: ", wall + 1));
    if (!left || (same && dem_wall_opens(sim, wall))) return RP_OK;
    sim->walls.wall[wall] = next;
    sim->walls.line[wall].plain = false;
    return RP_OK;
}

/* Is a motion one that this wall can have? */
static rp_status check_motion(const dem_sim *sim, size_t w, const dem_wall *wall, double *way)
{
    dem_definition def = sim->def;
    double r_min = INFINITY;
    def.n_grains = 0; /* those of a line's reach are not known before it moves */
    *way = dem_wall_speed(&def, wall) * def.dt;
    for (size_t i = 0; i < sim->grains.n; i++) r_min = fmin(r_min, sim->grains.radius[i]);
    RP_TRY(dem_wall_check(wall));
    if (def.ground.wall == (long)w + 1) return rp_fail(RP_BAD_INPUT, "the ground can't move");
    if (def.integrator == DEM_IMPLICIT)
        return rp_fail(RP_BAD_INPUT, "the integrator implicit needs walls that stand");
    if (sim->walls.turn[1] != 0.0) def.box_turn_per_step = sim->walls.turn[1]; /* it has turned */
    RP_TRY(dem_motion_check(&def, wall));
    return dem_way_check(*way, r_min);
}

rp_status dem_wall_move(dem_sim *sim, size_t w, const double velocity[2], double omega)
{
    RP_TRY(check_number(sim, w));
    const dem_wall *wall = &sim->walls.wall[w];
    const dem_wall_line *line = &sim->walls.line[w];
    dem_wall next = *wall;
    double way, r = fmin(sim->r_min, sim->start.radius_mean);
    if (velocity) memcpy(next.velocity, velocity, sizeof next.velocity);
    if (!isnan(omega)) next.omega = omega;
    if (next.velocity[0] == wall->velocity[0] && next.velocity[1] == wall->velocity[1] &&
        next.omega == wall->omega)
        return RP_OK;
    for (int c = 0; c < 2 && line->moves; c++)
        next.point[c] = line->point[c], next.direction[c] = line->direction[c],
        next.pivot[c] = line->pivot[c];
    RP_TRY(rp_prefix(check_motion(sim, w, &next, &way), "wall %zu: ", w + 1));
    for (size_t k = 0; k < sim->def.n_walls; k++) {
        if (!dem_wall_is_line(wall) && !dem_wall_is_line(&sim->walls.wall[k])) continue;
        dem_wall other = sim->walls.wall[k];
        memcpy(other.point, &sim->walls.line[k].point, sizeof other.point);
        memcpy(other.direction, &sim->walls.line[k].direction, sizeof other.direction);
        RP_TRY(dem_hidden_check(&sim->def, w, &next, k, &other, r));
        RP_TRY(dem_hidden_check(&sim->def, k, &other, w, &next, r));
    }
    dem_wall_go_on(sim, w, &next, way);
    return RP_OK;
}

rp_status dem_halt(dem_sim *sim)
{
    const double before = dem_energy_now(sim);
    for (size_t i = 0; i < sim->grains.n; i++) {
        *dem_force(sim, i) = sim->grains.motion[i].v = (dem_vec){0.0, 0.0};
        if (sim->grains.force_torque) sim->grains.force_torque[i].torque = 0.0;
        if (sim->grains.omega) sim->grains.omega[i] = 0.0;
    }
    sim->loops.pairs(sim, 0, sim->pairs.n, 0.0);
    dem_walls_apply(sim, 0, sim->grains.n, 0.0);
    if (sim->ledger) RP_TRY(dem_ledger_forces(sim, 0.0));
    if (sim->scheme->start) sim->scheme->start(sim, 0);
    if (sim->ledger) dem_ledger_halt(sim, before);
    return RP_OK;
}
