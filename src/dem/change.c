/* Laws, coefficients and time step that change while the grains stay: a simulation of the new ones begins
 * where the old one is, with its contacts. */
#include <stdlib.h>
#include <string.h>

#include "dem/forces/forces.h"
#include "dem/list/list.h"
#include "dem/methods/step.h"
#include "dem/observe/ledger.h"
#include "dem/setup/definition.h"

/* Which grains are left out; NULL: none. */
typedef struct {
    bool (*in)(const void *region, uint32_t id, double x, double y);
    const void *region;
} choice;

/* The grains in the order of their ids; ids[k] is that of number k. */
static dem_grain *grains_of(const dem_sim *sim, const choice *out, uint32_t ids[], size_t *left)
{
    const size_t n = dem_count(sim);
    dem_state *states = malloc((n + 1) * sizeof *states);
    dem_grain *grains = malloc((n + 1) * sizeof *grains);
    if (states && grains && dem_states(sim, states) == RP_OK) {
        *left = 0;
        for (size_t i = 0; i < n; i++) {
            const dem_state *s = &states[i];
            if (out->in && out->in(out->region, s->id, s->x, s->y)) continue;
            ids[*left] = s->id;
            grains[(*left)++] =
                (dem_grain){s->x, s->y, s->r, s->m, s->vx, s->vy, s->angle, s->omega, s->fixed};
        }
    } else {
        free(grains);
        grains = NULL;
    }
    free(states);
    return grains;
}

static int by_id(const void *a, const void *b)
{
    const uint32_t p = *(const uint32_t *)a, q = *(const uint32_t *)b;
    return (p > q) - (p < q);
}

static uint32_t number_of(uint32_t id, const uint32_t ids[], size_t n)
{
    const uint32_t *at = id ? bsearch(&id, ids, n, sizeof *ids, by_id) : NULL;
    return at ? (uint32_t)(at - ids) + 1 : 0;
}

/* The walls where they are now, with other coefficients. One that is gone stays so. */
static void walls_of(const dem_sim *sim, const dem_definition *laws, dem_wall walls[])
{
    for (size_t w = 0; w < sim->def.n_walls; w++) {
        const dem_wall_state now = dem_wall_now(sim, w);
        dem_wall *wall = &walls[w];
        *wall = sim->walls.wall[w];
        wall->material = dem_walls_of(laws)[w].material;
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

static rp_status make(const dem_sim *old, const dem_definition *laws, const choice *out, dem_wall *walls,
                      uint32_t *ids, dem_contact *contacts, size_t n_contacts, dem_sim **made)
{
    dem_definition def = *laws;
    size_t n = 0, kept = 0;
    dem_grain *grains = grains_of(old, out, ids, &n);
    if (!grains) return rp_fail(RP_NO_MEMORY, "simulation: out of memory");
    def.n_grains = n;
    def.radius_to_come = old->start.radius_mean;
    walls_of(old, laws, walls);
    def.wall_list = walls, def.n_walls = old->def.n_walls;
    dem_gravity(old, def.gravity);
    def.turn_per_step = old->def.turn_per_step, def.turn_from_step = old->def.turn_from_step;
    def.box_turn_per_step = 0.0;
    def.grains = grains, def.lines = NULL;
    for (size_t k = 0; k < n_contacts; k++) {
        dem_contact c = contacts[k];
        const bool wall = c.id_b == 0;
        c.id_a = number_of(c.id_a, ids, n), c.id_b = number_of(c.id_b, ids, n);
        if (c.id_a && (wall || c.id_b)) contacts[kept++] = c;
    }
    def.contacts = contacts, def.n_contacts = kept;
    rp_status status = dem_create(&def, made);
    free(grains);
    return status;
}

static double energy_of(const dem_energy *e)
{
    return e->kinetic + e->elastic + e->gravity + e->rotational;
}

static rp_status renew(dem_sim **sim, const dem_definition *laws, const choice *out)
{
    dem_sim *old = *sim, *made = NULL;
    dem_contact *contacts = NULL;
    size_t n_contacts = 0;
    dem_energy before;
    if (old->def.box_turn_per_step != 0.0 || old->walls.turn[1] != 0.0)
        return rp_fail(RP_BAD_INPUT, "laws, dt and grains can't be changed in a box that turns");
    uint32_t *ids = malloc((dem_count(old) + 1) * sizeof *ids);
    dem_wall *walls = malloc((old->def.n_walls + 1) * sizeof *walls);
    rp_status status = ids && walls ? dem_contacts(old, &contacts, &n_contacts)
                                    : rp_fail(RP_NO_MEMORY, "simulation: out of memory");
    if (!status) status = make(old, laws, out, walls, ids, contacts, n_contacts, &made);
    if (!status) {
        dem_energies(old, &before);
        go_on(made, old, ids);
        dem_ledger sum;
        if (made->ledger && dem_ledger_read(old, &sum))
            status = dem_ledger_go_on(made, &sum, energy_of(&before), ids);
    }
    free(ids), free(walls), free(contacts);
    if (status) return dem_free(made), status;
    dem_free(old);
    *sim = made;
    return RP_OK;
}

rp_status dem_change(dem_sim **sim, const dem_definition *laws)
{
    return renew(sim, laws, &(choice){0});
}

rp_status dem_remove(dem_sim **sim, bool (*in)(const void *region, uint32_t id, double x, double y),
                     const void *region)
{
    return renew(sim, &(*sim)->def, &(choice){in, region});
}

rp_status dem_halt(dem_sim *sim)
{
    dem_energy before;
    dem_energies(sim, &before);
    for (size_t i = 0; i < sim->grains.n; i++) {
        *dem_force(sim, i) = sim->grains.motion[i].v = (dem_vec){0.0, 0.0};
        if (sim->grains.force_torque) sim->grains.force_torque[i].torque = 0.0;
        if (sim->grains.omega) sim->grains.omega[i] = 0.0;
    }
    sim->loops.pairs(sim, 0, sim->pairs.n, 0.0);
    dem_walls_apply(sim, 0, sim->grains.n, 0.0);
    if (sim->ledger) RP_TRY(dem_ledger_forces(sim, 0.0));
    if (sim->scheme->start) sim->scheme->start(sim, 0);
    if (sim->ledger) dem_ledger_halt(sim, energy_of(&before));
    return RP_OK;
}
