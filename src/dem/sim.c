/* Life of a simulation: start, grains that are put in, end. */
#include "dem/state/state.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "dem/forces/forces.h"
#include "dem/list/list.h"
#include "dem/methods/methods.h"
#include "dem/observe/observe.h"
#include "dem/setup/definition.h"

/* Pairs of a chunk: some 3000 grains. Their data of a step fit into the second cache. */
enum { CHUNK = 8192 };

/* Of pairs, a grain and rebuilding: as long as the search by size takes. */
enum { MOST_TESTS = 250 };

/* List the contacts of the start; the first rebuilding keeps the springs of the pairs that touch. */
static rp_status list_contacts(dem_sim *sim, size_t n, const dem_contact *contacts)
{
    dem_pairs *const pairs = &sim->pairs;
    dem_walls *const walls = &sim->walls;
    if (n == 0) return RP_OK;
    RP_TRY(dem_pairs_reserve(pairs, n));
    RP_TRY(dem_room("springs of the start", &walls->slot, sizeof *walls->slot, n, &walls->capacity));
    for (size_t k = 0; k < n; k++) {
        const dem_contact *c = &contacts[k];
        const uint32_t a = c->id_a - 1, w = (uint32_t)c->wall;
        if (c->id_b > 0) {
            pairs->i[pairs->n] = a, pairs->j[pairs->n] = c->id_b - 1;
            pairs->spring[pairs->n] = c->shear_spring;
            if (pairs->roll) pairs->roll[pairs->n] = c->rolling_spring;
            pairs->touching[pairs->n / 64] |= 1ull << pairs->n % 64;
            pairs->n++;
            continue;
        }
        const double distance =
            dem_dot(sim->grains.motion[a].x - walls->line[w].point, walls->line[w].direction);
        dem_wall_slot slot = {w, a, .roll = c->rolling_spring, .well = c->well};
        slot.side = distance < 0.0 ? -1.0 : 1.0;
        if (c->well == DEM_WELL_NONE)
            slot.spring = c->shear_spring;
        else
            slot.rest = dem_ground_displacement(sim, &slot) - c->shear_spring;
        walls->slot[walls->n_slots++] = slot;
    }
    return RP_OK;
}

/* Forces of the start, with velocities and springs of the start; then the integrator's own start. */
static rp_status start_forces(dem_sim *sim, const dem_definition *def)
{
    RP_TRY(list_contacts(sim, def->n_contacts, def->contacts));
    RP_TRY(dem_neighbours_rebuild(sim));
    sim->loops.pairs(sim, 0, sim->pairs.n, 0.0);
    dem_walls_apply(sim, 0, sim->grains.n, 0.0);
    if (def->lines) RP_TRY(dem_check_listed(sim, def->lines));
    if (sim->too_deep)
        RP_TRY(dem_check_overlaps(sim, (dem_stretch){0, sim->pairs.n}, (dem_stretch){0, sim->grains.n}));
    RP_TRY(dem_check_start_overlaps(sim));
    if (sim->ledger) RP_TRY(dem_ledger_forces(sim, 0.0));
    if (sim->scheme->start) sim->scheme->start(sim, 0);
    if (sim->ledger) dem_ledger_start(sim);
    return RP_OK;
}

/* Let an entry of zeros be the grain that the definition describes, all but its id. */
static void put_grain(dem_sim *sim, size_t i, const dem_grain *p)
{
    dem_grains *const g = &sim->grains;
    g->motion[i] = (dem_motion){{p->x, p->y}, {p->vx, p->vy}};
    g->radius[i] = p->r;
    g->mass[i] = p->m;
    g->inverse_mass[i] = p->fixed ? 0.0 : 1.0 / p->m;
    if (g->kind) g->kind[i] = p->kind;
    if (!g->omega) return;
    g->angle[i] = p->angle;
    g->omega[i] = p->omega;
    g->inverse_inertia[i] = p->fixed ? 0.0 : 1.0 / dem_inertia(sim->def.shape, p->m, p->r);
}

static void note_radius(dem_sim *sim, double r)
{
    sim->r_min = fmin(sim->r_min, r);
    sim->r_max = fmax(sim->r_max, r);
}

static void put_grains(dem_sim *sim, const dem_definition *def)
{
    const double n = (double)def->n_grains;
    sim->grains.n = def->n_grains;
    sim->grains.last_id = (uint32_t)def->n_grains;
    sim->r_min = INFINITY;
    if (sim->grains.n == 0)
        sim->start.radius_mean = def->radius_to_come, sim->start.mass_mean = def->mass_to_come;
    for (size_t i = 0; i < sim->grains.n; i++) {
        const dem_grain *p = &def->grains[i];
        put_grain(sim, i, p);
        note_radius(sim, p->r);
        sim->grains.id[i] = (uint32_t)i + 1;
        sim->start.radius_mean += p->r / n;
        sim->start.mass_mean += p->m / n;
    }
}

static rp_status fill_in(dem_sim *sim, const dem_definition *def)
{
    sim->def = *def;
    sim->def.grains = NULL;
    sim->def.contacts = NULL;
    sim->def.n_contacts = 0;
    sim->def.lines = NULL;
    RP_TRY(dem_kinds_copy(def, &sim->def));
    sim->scheme = dem_schemes[def->integrator];
    if (def->hard.on) sim->hard = dem_hard_collisions;
    dem_finite_limits(&sim->def.material);
    for (size_t k = 0; def->pairs && k < dem_pair_count(def); k++)
        dem_finite_limits((dem_material *)&sim->def.pairs[k]);
    sim->pairs.kinds = def->pairs != NULL;
    sim->pairs.rotation = def->rotation;
    sim->pairs.rolling = dem_has_rolling(def);
    sim->pairs.chunk = CHUNK;
    dem_gravity_start(sim);
    dem_loops_choose(sim);
    RP_TRY(dem_grains_reserve(sim, def->n_grains, false, &sim->grains));
    put_grains(sim, def);
    RP_TRY(dem_walls_place(sim, def));
    sim->list.skin = def->skin > 0.0 ? def->skin : 0.4 * sim->start.radius_mean;
    sim->list.even_margins = def->skin > 0.0 || sim->scheme->even_margins;
    sim->list.most_tests = MOST_TESTS;
    sim->start.speed = dem_impact_speed(def);
    sim->start.dt_limit = dem_time_step_limit(def, sim->start.dt_limit_of);
    RP_TRY(dem_neighbours_alloc(sim));
    if (def->ledger) RP_TRY(dem_ledger_alloc(sim));
    return start_forces(sim, def);
}

/* Words of a scene file, which a caller gives as numbers. */
static rp_status check_choices(const dem_definition *def)
{
    const struct {
        const char *name;
        unsigned value, n;
    } choices[] = {{"integrator", def->integrator, DEM_INTEGRATORS},
                   {"normal", def->normal, DEM_NORMAL_N},
                   {"tangential", def->tangential, DEM_TANGENTIAL_N},
                   {"kernel", def->kernel, DEM_KERNELS},
                   {"slip", def->slip, DEM_SLIPS(DEM_ONE)},
                   {"damping", def->damping, DEM_DAMPINGS(DEM_ONE)},
                   {"rolling", def->rolling, DEM_ROLLING_N},
                   {"rolling_arm", def->rolling_arm, DEM_ARMS(DEM_ONE)},
                   {"shape", def->shape, DEM_SHAPES(DEM_ONE)},
                   {"solver", def->implicit.solver, DEM_SOLVERS(DEM_ONE)},
                   {"ground.set", def->ground.set, DEM_WELL_SETS(DEM_ONE)}};
    for (size_t k = 0; k < sizeof choices / sizeof *choices; k++)
        if (choices[k].value >= choices[k].n)
            return rp_fail(RP_BAD_INPUT, "%s = %d: no such choice", choices[k].name, (int)choices[k].value);
    if (!dem_schemes[def->integrator] || (def->hard.on && !dem_hard_collisions))
        return rp_fail(RP_BAD_INPUT, "%s: this program is built without it",
                       def->hard.on ? "hard" : "integrator");
    return RP_OK;
}

rp_status dem_create(const dem_definition *def, dem_sim **sim)
{
    *sim = NULL;
    RP_TRY(check_choices(def));
    if ((def->n_grains && !def->grains) || (def->n_contacts && !def->contacts))
        return rp_fail(RP_BAD_INPUT, "%s: NULL", def->n_grains && !def->grains ? "grains" : "contacts");
    dem_definition own = *def;
    rp_status status = dem_physics_resolve(&own);
    if (!status) status = dem_definition_check(&own);
    dem_sim *s = status ? NULL : calloc(1, sizeof *s);
    if (!status) status = s ? fill_in(s, &own) : rp_fail(RP_NO_MEMORY, "simulation: out of memory");
    dem_physics_free(&own, def);
    if (status) {
        dem_free(s);
        return status == RP_BROKEN ? RP_BAD_INPUT : status; /* a fault at the start is the definition's */
    }
    *sim = s;
    return RP_OK;
}

static rp_status check_new_grain(const dem_sim *sim, const dem_grain *p)
{
    dem_grain boxed = *p;
    dem_box_frame(sim, &boxed.x, &boxed.y);
    RP_TRY(dem_grain_check(&sim->def, &boxed));
    RP_TRY(dem_kinds_check(
        &(dem_definition){.n_kinds = sim->def.n_kinds, .kinds = sim->def.kinds, .n_grains = 1, .grains = p}));
    if (p->fixed) return rp_fail(RP_BAD_INPUT, "a fixed grain must be there from the start");
    dem_definition def = sim->def;
    def.grains = (dem_grain[]){*p, *p};
    def.n_grains = 2;
    dem_limit_name what;
    double limit = dem_time_step_limit(&def, what);
    if (def.dt > limit) {
        (void)dem_refuse_step(&def, limit, what);
        return RP_TOO_FAST;
    }
    for (size_t i = 0; i < sim->grains.n; i++) {
        dem_vec d = sim->grains.motion[i].x - (dem_vec){p->x, p->y};
        double radii = sim->grains.radius[i] + p->r;
        if (dem_dot(d, d) < radii * radii)
            return rp_fail(RP_NO_ROOM, "x = %g, y = %g: touches grain %u", p->x, p->y, sim->grains.id[i]);
    }
    return RP_OK;
}

/* Does grain i touch a wall, or lie behind a whole line? */
static rp_status check_new_walls(const dem_sim *sim, size_t i)
{
    const dem_vec x = sim->grains.motion[i].x;
    for (uint32_t k = 0; k < sim->def.n_walls; k++) {
        const bool line = dem_wall_is_line(&sim->walls.wall[k]),
                   behind = dem_dot(x - sim->walls.line[k].point, sim->walls.line[k].direction) < 0.0;
        dem_wall_slot slot = {.wall = k, .grain = (uint32_t)i, .side = behind && !line ? -1.0 : 1.0};
        dem_touch touch;
        if (dem_wall_touch(sim, &slot, &touch) && touch.overlap > 0.0)
            return rp_fail(RP_NO_ROOM, "x = %g, y = %g: touches wall %u", x[0], x[1], k + 1);
    }
    return RP_OK;
}

rp_status dem_add(dem_sim *sim, const dem_grain *grain, uint32_t *id)
{
    RP_TRY(rp_prefix(check_new_grain(sim, grain), "new particle: "));
    if (sim->grains.n == sim->grains.capacity) {
        const size_t capacity = sim->grains.capacity ? 2 * sim->grains.capacity : 1;
        RP_TRY(dem_neighbours_grow(sim, capacity));
        RP_TRY(dem_grains_reserve(sim, capacity, false, &sim->grains));
    }
    dem_grains_clear(&sim->grains, sim->grains.n);
    put_grain(sim, sim->grains.n, grain);
    RP_TRY(rp_prefix(check_new_walls(sim, sim->grains.n), "new particle: "));
    if (sim->ledger) RP_TRY(dem_ledger_add(sim, grain));
    note_radius(sim, grain->r);
    sim->grains.id[sim->grains.n++] = ++sim->grains.last_id;
    if (sim->scheme->start) sim->scheme->start(sim, sim->grains.n - 1);
    if (id) *id = sim->grains.last_id;
    return dem_neighbours_rebuild(sim);
}

void dem_free(dem_sim *sim)
{
    if (!sim) return;
    if (sim->work) sim->scheme->free(sim);
    dem_neighbours_free(sim);
    dem_ledger_free(sim);
    dem_grains_free(&sim->grains);
    dem_pairs_free(&sim->pairs);
    dem_walls_free(&sim->walls);
    dem_kinds_free(&sim->def);
    free(sim);
}

dem_fault dem_sim_fault(const dem_sim *sim)
{
    return sim->fault;
}

rp_units dem_units(const dem_sim *sim)
{
    return sim->def.units;
}

long dem_step(const dem_sim *sim)
{
    return sim->step;
}

double dem_time(const dem_sim *sim)
{
    return sim->time0 + (double)(sim->step - sim->step0) * sim->def.dt;
}

size_t dem_count(const dem_sim *sim)
{
    return sim->grains.n;
}

void dem_threads(dem_sim *sim, size_t n)
{
    sim->threads = n;
}

size_t dem_kind_count(const dem_sim *sim)
{
    return sim->def.n_kinds;
}

const char *dem_kind_name(const dem_sim *sim, size_t kind)
{
    return sim->def.kinds[kind].name;
}

const char *dem_kernel_name(const dem_sim *sim)
{
    return sim->loops.name;
}
