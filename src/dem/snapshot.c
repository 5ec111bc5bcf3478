/* Snapshots of a simulation, in a file or, for a clone, in memory; see dem_keep in dem.h and core/snapshot.h.
 *
 * Arrays follow the lists of grains.h and pairs.h, so that a new array is kept without a line here; the rest
 * is `dem_sim` itself, without its pointers. Neighbour lists are kept as they are: their order is that of the
 * sums. Work space of an integrator belongs to a step, or follows from the lists, and is made anew. */
#include <stdlib.h>
#include <string.h>
#include <xxhash.h>

#include "core/snapshot.h"
#include "dem/list/list.h"
#include "dem/observe/observe.h"
#include "dem/setup/definition.h"

uint64_t dem_keep_layout(void)
{
    static const size_t sizes[] = {sizeof(dem_sim),
                                   sizeof(dem_wall_slot),
                                   sizeof(dem_wall),
                                   sizeof(dem_wall_line),
                                   sizeof(dem_ledger),
#define X(type, name, need, role) sizeof(type), role,
                                   DEM_GRAIN_ARRAYS(X)
#undef X
#define X(type, name, need, share, role) sizeof(type), share,
                                       DEM_PAIR_ARRAYS(X)
#undef X
    };
    static const char names[] =
#define X(type, name, ...) #type " " #name " "
        DEM_GRAIN_ARRAYS(X) DEM_PAIR_ARRAYS(X);
#undef X
    return XXH3_64bits_withSeed(names, sizeof names, XXH3_64bits(sizes, sizeof sizes));
}

/* Counts, words and definition of a state from a file. What they hold of physics is checked as for a start.
 */
static void check_numbers(rp_snapshot *s, const dem_sim *sim)
{
    const dem_definition *def = &sim->def;
    const unsigned words[][2] = {{def->kernel, DEM_KERNELS},
                                 {def->implicit.solver, DEM_SOLVER_SOR + 1},
                                 {def->ground.set, DEM_WELL_AGAIN + 1},
                                 {def->units, RP_SIGMA + 1}};
    if (s->status || !s->path) return;
    bool known = dem_words_known(def);
    for (size_t k = 0; k < sizeof words / sizeof *words; k++) known &= words[k][0] < words[k][1];
    const bool *const bools[] = {&def->hard.on, &def->ledger, &sim->list.even_margins, &sim->too_deep};
    for (size_t k = 0; k < sizeof bools / sizeof *bools; k++) known &= rp_keep_bool(bools[k]);
    rp_keep_check(s, known, "unknown words in its definition");
    if (s->status) return;
    s->status = rp_prefix(dem_laws_check(def), "%s: ", s->path);
    /* capacity doubles whenever it is used up */
    const dem_grains *g = &sim->grains;
    rp_keep_check(s,
                  g->n <= g->capacity && g->capacity <= 2 * (size_t)g->last_id && g->n_fixed <= g->n &&
                      g->n_gone == 0 && g->n <= s->n / sizeof(dem_motion) &&
                      sim->pairs.n <= s->n / sizeof(uint64_t) && sim->pairs.chunk > 0 &&
                      sim->pairs.chunk % 64 == 0,
                  "impossible numbers of grains, pairs or wall contacts");
}

static void keep_grains(rp_snapshot *s, dem_sim *sim)
{
    dem_grains *const g = &sim->grains;
    if (s->reading) s->status = dem_grains_reserve(sim, g->capacity, false, g);
#define X(type, name, need, role)                                                                            \
    if (!s->status && g->name && role != DEM_OF_STEP) rp_keep(s, g->name, g->n * sizeof(type));
    DEM_GRAIN_ARRAYS(X)
#undef X
    bool exist = !s->status;
    for (size_t i = 0; i < g->n && exist; i++) exist = g->id[i] >= 1 && g->id[i] <= g->last_id;
    for (size_t k = 0; k < g->n_fixed && exist; k++) exist = g->fixed[k] < g->n;
    for (size_t i = 0; i < g->n && exist && g->kind; i++) exist = g->kind[i] < sim->def.n_kinds;
    rp_keep_check(s, exist, "grains that do not exist");
}

static void keep_pairs(rp_snapshot *s, dem_sim *sim)
{
    dem_pairs *const p = &sim->pairs;
    const size_t n = p->n;
    bool in_order = p->n_chunks > 0, exist = true;
    RP_KEEP(s, in_order);
    rp_keep_check(s, rp_keep_bool(&in_order), "unknown words in its pairs");
    if (s->reading && !s->status) {
        *p = (dem_pairs){.rotation = sim->def.rotation,
                         .rolling = dem_has_rolling(&sim->def),
                         .kinds = sim->def.pairs != NULL,
                         .chunk = p->chunk};
        s->status = dem_pairs_reserve(p, n + 1);
        p->n = n;
    }
#define X(type, name, need, share, role)                                                                     \
    if (!s->status && p->name) rp_keep(s, p->name, (n + share - 1) / share * sizeof(type));
    DEM_PAIR_ARRAYS(X)
#undef X
    for (size_t k = 0; k < n && exist && !s->status; k++)
        exist = p->i[k] < sim->grains.n && p->j[k] < sim->grains.n;
    rp_keep_check(s, exist, "pairs of grains that do not exist");
    if (s->status || !s->reading) return;
    dem_pairs_pad(p);
    if (in_order) s->status = dem_pairs_plan_chunks(p, sim->grains.n);
}

static void keep_kinds(rp_snapshot *s, dem_sim *sim)
{
    dem_definition *def = &sim->def;
    bool pairs = def->pairs != NULL, known = true;
    RP_KEEP(s, pairs);
    rp_keep_check(s,
                  rp_keep_bool(&pairs) && def->n_kinds <= DEM_MOST_KINDS &&
                      (!pairs || dem_pair_count(def) <= s->n / sizeof *def->pairs),
                  "impossible numbers of kinds");
    if (s->reading && !s->status) s->status = dem_kinds_alloc(def, pairs);
    if (s->status) return;
    rp_keep(s, (dem_kind *)def->kinds, def->n_kinds * sizeof *def->kinds);
    if (pairs) rp_keep(s, (dem_material *)def->pairs, dem_pair_count(def) * sizeof *def->pairs);
    for (size_t k = 0; k < def->n_kinds; k++) known &= memchr(def->kinds[k].name, 0, DEM_NAME_BYTES) != NULL;
    rp_keep_check(s, known, "unknown words in its kinds");
}

/* All of the walls but their slots. */
static void keep_wall_list(rp_snapshot *s, dem_sim *sim)
{
    const size_t n = sim->def.n_walls;
    dem_walls *const w = &sim->walls;
    rp_keep_check(s, n <= s->n / sizeof *w->wall && w->n_slots <= s->n / sizeof *w->slot,
                  "impossible numbers of walls");
    if (s->reading && !s->status) s->status = dem_walls_alloc(w, n);
    if (s->status) return;
    sim->def.wall_list = w->wall;
    rp_keep(s, w->wall, n * sizeof *w->wall);
    rp_keep(s, w->line, n * sizeof *w->line);
    rp_keep(s, w->force, n * sizeof *w->force);
    rp_keep(s, w->next, n * sizeof *w->next);
    rp_keep(s, w->start, (n + 1) * sizeof *w->start);
    bool known = true;
    for (size_t k = 0; k < n && !s->status; k++)
        known &= rp_keep_bool(&w->line[k].moves) && rp_keep_bool(&w->line[k].plain);
    rp_keep_check(s, known, "unknown words in its walls");
}

static void keep_walls(rp_snapshot *s, dem_sim *sim)
{
    dem_walls *const w = &sim->walls;
    bool exist = true;
    if (!s->status) rp_keep(s, w->slot, w->n_slots * sizeof *w->slot);
    if (s->status || !s->reading) return;
    for (size_t k = 0; k < w->n_slots && exist; k++)
        exist = w->slot[k].wall < sim->def.n_walls && w->slot[k].grain < sim->grains.n &&
                w->slot[k].next < w->n_slots && w->slot[w->slot[k].next].grain == w->slot[k].grain &&
                w->slot[k].well <= DEM_WELL_BROKEN;
    for (size_t k = 0; k < sim->def.n_walls && exist; k++) exist = w->start[k] <= w->start[k + 1];
    rp_keep_check(s, exist && w->start[sim->def.n_walls] <= w->n_slots, "impossible contacts with walls");
}

/* Without pointers, and what a step leaves for itself. */
static void strip(dem_sim *state)
{
    state->grains.slack = NULL;
#define X(type, name, ...) state->grains.name = NULL;
    DEM_GRAIN_ARRAYS(X)
#undef X
    state->pairs.done = NULL;
#define X(type, name, ...) state->pairs.name = NULL;
    DEM_PAIR_ARRAYS(X)
#undef X
    state->walls.slot = NULL;
#define X(type, name) state->walls.name = NULL;
    DEM_WALL_ARRAYS(X)
#undef X
    state->def.wall_list = NULL, state->def.kinds = NULL, state->def.pairs = NULL;
    state->work = NULL, state->list.work = NULL, state->list.sizes = NULL, state->ledger = NULL;
    state->team = NULL, state->scheme = NULL, state->hard = NULL, state->times = NULL;
    state->loops = (dem_loops){0};
    state->threads = 0;
    state->pairs.capacity = state->pairs.chunk_capacity = state->walls.capacity = 0;
    state->ahead = false, state->ahead_left = 0;
    state->collided.n = 0;
}

void dem_keep(rp_snapshot *s, dem_sim **sim)
{
    dem_sim state = {0}, *c = *sim;
    if (!s->reading) {
        state = *c;
        strip(&state);
    }
    RP_KEEP(s, state);
    if (s->reading) {
        *sim = NULL;
        strip(&state);
        keep_wall_list(s, &state);
        keep_kinds(s, &state);
        check_numbers(s, &state);
        if (!s->status && !(c = malloc(sizeof *c)))
            s->status = rp_fail(RP_NO_MEMORY, "simulation: out of memory");
        if (s->status) {
            dem_walls_free(&state.walls);
            dem_kinds_free(&state.def);
            return;
        }
        *sim = c;
        *c = state;
        c->scheme = dem_schemes[c->def.integrator];
        c->hard = c->def.hard.on ? dem_hard_collisions : NULL;
        dem_loops_choose(c);
    }
    if (!s->reading) keep_wall_list(s, c), keep_kinds(s, c);
    keep_grains(s, c);
    keep_pairs(s, c);
    keep_walls(s, c);
    if (!s->status) dem_neighbours_keep(s, c);
    dem_ledger_keep(s, c);
    if (!s->reading || !s->status) return;
    dem_free(c);
    *sim = NULL;
}

rp_status dem_clone(const dem_sim *sim, dem_sim **copy)
{
    rp_snapshot s = {0};
    dem_sim *original = (dem_sim *)sim; /* which a writing only reads */
    *copy = NULL;
    dem_keep(&s, &original);
    s.reading = true;
    if (!s.status) dem_keep(&s, copy);
    const rp_status status = s.status;
    rp_snapshot_free(&s);
    if (!status) (*copy)->threads = sim->threads;
    return status;
}
