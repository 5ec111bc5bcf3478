/* Parts of a pile; see threads.h. */
#include "dem/threads/threads.h"

#include <stdlib.h>
#include <string.h>

/* Of one part alone. */
struct dem_share {
    uint32_t *border; /* pairs of its stretch with a grain of another part */
    size_t n_border, border_capacity, done_capacity;
    uint32_t *done;
    void
        *force; /* forces, or with torques, on the grains from force_from on, as far as its pairs have them */
    size_t force_from, force_capacity;
    size_t *slot, *next; /* for each wall: the part's first slot; as of dem_walls */
    dem_vec *wall_force; /* not all of it, and read by nobody: a run's last step is one thread's */
};

bool dem_threads_divided(const dem_sim *sim)
{
    return sim->team && sim->pairs.n_chunks > 0;
}

rp_status dem_threads_do_parts(dem_sim *sim, dem_task *task)
{
    dem_part all = {.of = 1, .grain_end = sim->grains.n, .pair_end = sim->pairs.n, .done = sim->pairs.done};
    return dem_threads_divided(sim) ? dem_threads_do(sim, task, 0, 1) : task(sim, &all);
}

static inline bool has(const dem_part *part, uint32_t i)
{
    return i >= part->grain && i < part->grain_end;
}

void dem_threads_collect(dem_sim *sim, dem_part *part)
{
    part->collects = sim->team != NULL;
    if (part->collects) sim->pairs = part->found;
    sim->pairs.n = 0;
}

static rp_status gather(dem_sim *sim, dem_part *part)
{
    const dem_pairs *found = &part->found;
    if (found->n == 0) return RP_OK;
    memcpy(sim->pairs.i + part->found_from, found->i, found->n * sizeof *found->i);
    memcpy(sim->pairs.j + part->found_from, found->j, found->n * sizeof *found->j);
    return RP_OK;
}

rp_status dem_threads_gather(dem_sim *sim)
{
    size_t n = 0;
    if (!sim->team) return RP_OK;
    for (size_t t = 0; t < sim->team->n; t++) {
        sim->team->part[t].found_from = n;
        n += sim->team->part[t].found.n;
    }
    sim->pairs.n = 0;
    RP_TRY(dem_pairs_reserve(&sim->pairs, n));
    sim->pairs.n = n;
    return dem_threads_do(sim, gather, 0, 1);
}

/* Stretches of the list with as many pairs each. The grains whose pairs begin there, rounded to groups, are
 * the part's. */
static rp_status set_bounds(dem_sim *sim)
{
    struct dem_team *team = sim->team;
    const size_t groups = sim->grains.n / DEM_GROUP + 1;
    RP_TRY(dem_room("threads", &team->late, sizeof *team->late, groups, &team->late_capacity));
    size_t pair = 0, grain = 0;
    for (size_t t = 0; t < team->n; t++) {
        dem_part *part = &team->part[t];
        part->pair = pair, part->grain = grain;
        pair = part->pair_end = t + 1 == team->n ? sim->pairs.n : sim->pairs.n * (t + 1) / team->n / 64 * 64;
        grain = part->grain_end =
            t + 1 == team->n ? sim->grains.n : sim->pairs.i[pair] / DEM_GROUP * DEM_GROUP;
        part->late = team->late;
    }
    return RP_OK;
}

/* Of the part's stretch, the pairs that other parts need too. */
static rp_status find_border(dem_sim *sim, dem_part *part)
{
    struct dem_share *own = part->share;
    own->n_border = 0;
    for (size_t k = part->pair; k < part->pair_end; k++) {
        if (has(part, sim->pairs.i[k]) && has(part, sim->pairs.j[k])) continue;
        RP_TRY(
            dem_room("threads", &own->border, sizeof *own->border, own->n_border + 1, &own->border_capacity));
        own->border[own->n_border++] = (uint32_t)k;
    }
    return RP_OK;
}

/* Copies of pairs of other stretches; groups that others read; from and to which grain there are pairs. */
static rp_status copy_border(dem_sim *sim, dem_part *part, size_t *from, size_t *to)
{
    const dem_part *all = sim->team->part;
    bool *late = sim->team->late;
    *from = part->grain, *to = part->grain_end;
    part->before.n = part->after.n = 0;
    for (size_t g = *from; g < *to; g += DEM_GROUP) late[g / DEM_GROUP] = false;
    for (size_t t = 0; t < part->of; t++) {
        dem_pairs *copies = t < part->index ? &part->before : &part->after;
        for (size_t b = 0; b < all[t].share->n_border; b++) {
            const uint32_t k = all[t].share->border[b], i = sim->pairs.i[k], j = sim->pairs.j[k];
            const uint32_t low = i < j ? i : j, high = i < j ? j : i;
            if (has(part, i)) late[i / DEM_GROUP] = true;
            if (has(part, j)) late[j / DEM_GROUP] = true;
            if (t != part->index && !has(part, i) && !has(part, j)) continue;
            *from = low < *from ? low : *from;
            *to = high + 1 > *to ? high + 1 : *to;
            if (t != part->index) RP_TRY(dem_pairs_append(copies, &sim->pairs, k));
        }
    }
    dem_pairs_pad(&part->before), dem_pairs_pad(&part->after);
    return RP_OK;
}

static void find_done(dem_sim *sim, dem_part *part, uint32_t *done)
{
    uint32_t least = (uint32_t)part->grain_end;
    for (size_t k = 0; k < part->after.n; k++) {
        const uint32_t i = part->after.i[k], j = part->after.j[k];
        if (has(part, i) && i < least) least = i;
        if (has(part, j) && j < least) least = j;
    }
    if (least < part->grain_end) least = least / DEM_GROUP * DEM_GROUP;
    dem_pairs_find_done(&sim->pairs, (dem_stretch){part->pair, part->pair_end},
                        (dem_stretch){part->grain, least}, done);
    part->done = done;
}

static void find_slots(const dem_sim *sim, const dem_part *part)
{
    for (size_t a = 0; a < sim->def.n_walls; a++) {
        size_t k = sim->walls.start[a];
        while (k < sim->walls.start[a + 1] && sim->walls.slot[k].grain < part->grain) k++;
        part->share->slot[a] = k;
    }
}

void dem_threads_find_slots(dem_sim *sim)
{
    for (size_t t = 0; dem_threads_divided(sim) && t < sim->team->n; t++)
        find_slots(sim, &sim->team->part[t]);
}

static rp_status plan(dem_sim *sim, dem_part *part)
{
    struct dem_share *own = part->share;
    size_t from, to;
    RP_TRY(copy_border(sim, part, &from, &to));
    const size_t size = dem_forces_of(&sim->grains).size,
                 chunks = (part->pair_end - part->pair) / sim->pairs.chunk + 1;
    own->force_from = from / DEM_GROUP * DEM_GROUP;
    if (to - own->force_from > own->force_capacity) {
        free(own->force);
        own->force = dem_array(own->force_capacity = (to - own->force_from) / 8 * 9 + 64, size);
    } else if (to > own->force_from) {
        memset(own->force, 0, (to - own->force_from) * size);
    }
    if (!own->force) return rp_fail(RP_NO_MEMORY, "threads: out of memory");
    RP_TRY(dem_room("threads", &own->done, sizeof *own->done, chunks, &own->done_capacity));
    find_done(sim, part, own->done);
    find_slots(sim, part);
    return RP_OK;
}

void dem_threads_enter(dem_sim *sim, const dem_part *part)
{
    if (!dem_threads_divided(sim)) return;
    const struct dem_share *own = part->share;
    /* not a pointer into the array where it begins before that */
    const uintptr_t force = (uintptr_t)own->force;
    if (sim->grains.force_torque)
        sim->grains.force_torque = (dem_force_torque *)(force - own->force_from * sizeof(dem_force_torque));
    else
        sim->grains.force = (dem_vec *)(force - own->force_from * sizeof(dem_vec));
    memcpy(own->next, own->slot, sim->def.n_walls * sizeof *own->next);
    sim->walls.next = own->next;
    sim->walls.force = own->wall_force;
}

static rp_status take_forces(dem_sim *sim, dem_part *part)
{
    const size_t n = part->grain_end - part->grain;
    dem_sim copy = *sim;
    dem_threads_enter(&copy, part);
    const dem_forces from = dem_forces_of(&sim->grains), to = dem_forces_of(&copy.grains);
    memcpy(to.at + part->grain * to.size, from.at + part->grain * from.size, n * from.size);
    memset(from.at + part->grain * from.size, 0, n * from.size);
    return RP_OK;
}

rp_status dem_threads_divide(dem_sim *sim)
{
    if (!dem_threads_divided(sim)) return RP_OK;
    RP_TRY(set_bounds(sim));
    RP_TRY(dem_threads_do(sim, find_border, 0, 1));
    RP_TRY(dem_threads_do(sim, plan, 0, 1));
    return dem_threads_do(sim, take_forces, 0, 1);
}

/* They touch or not as in their own part, which reports an overlap that is too deep. */
void dem_threads_copies(dem_sim *sim, const dem_pairs *copies)
{
    const bool too_deep = sim->too_deep;
    const dem_pairs all = sim->pairs;
    if (copies->n == 0) return;
    sim->pairs = *copies;
    sim->loops.pairs(sim, 0, copies->n, sim->def.dt);
    sim->pairs = all;
    sim->too_deep = too_deep;
}

static bool start_part(dem_part *part, const dem_sim *sim)
{
    struct dem_share *own = part->share = calloc(1, sizeof *own);
    if (!own) return false;
    part->found.springs_only = true;
    part->before = part->after = (dem_pairs){
        .rotation = sim->pairs.rotation, .rolling = sim->pairs.rolling, .kinds = sim->pairs.kinds};
    own->slot = calloc(2 * (sim->def.n_walls + 1), sizeof *own->slot);
    own->wall_force = calloc(sim->def.n_walls + 1, sizeof *own->wall_force);
    own->next = own->slot + sim->def.n_walls + 1;
    return own->slot && own->wall_force;
}

bool dem_threads_serve(const dem_sim *sim)
{
    return sim->scheme->runs_ahead && !sim->def.hard.on && !sim->ledger && dem_pairs_are_many(&sim->pairs);
}

void dem_threads_start(dem_sim *sim)
{
    if (sim->threads < 2 || sim->times || !dem_threads_serve(sim) ||
        !(sim->team = dem_team_start(sim->threads)))
        return;
    bool good = true;
    for (size_t t = 0; t < sim->team->n; t++) good &= start_part(&sim->team->part[t], sim);
    if (!good || dem_threads_divide(sim)) dem_threads_end(sim);
}

void dem_threads_end(dem_sim *sim)
{
    if (!sim->team) return;
    for (size_t t = 0; t < sim->team->n; t++) {
        dem_part *part = &sim->team->part[t];
        dem_pairs_free(&part->before), dem_pairs_free(&part->after), dem_pairs_free(&part->found);
        if (!part->share) continue;
        free(part->share->border), free(part->share->done), free(part->share->force);
        free(part->share->slot), free(part->share->wall_force), free(part->share);
    }
    dem_team_end(sim->team);
    sim->team = NULL;
}
