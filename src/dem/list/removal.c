/* Grains that leave the scene. The last grain takes the place of one that left, in one order whatever the
 * size of the pile. In a large one, that would end the order of grains which chunks and threads need: there,
 * gaps are closed by the next rebuilding of the list or at the end of the run. Until then a grain that left
 * is held far from all others. */
#include <math.h>

#include "dem/list/list.h"
#include "dem/threads/threads.h"

/* May grains that left stay in the arrays for some steps? */
static bool may_stay(const dem_sim *sim)
{
    return sim->pairs.n_chunks > 0 && sim->scheme->runs_ahead && !sim->def.hard.on && !sim->ledger &&
           sim->def.box_turn_per_step == 0.0;
}

/* The grains that left, from the last place to the first: how many. */
static size_t find_left(const dem_sim *sim, uint32_t *left)
{
    const dem_grains *g = &sim->grains;
    const bool noted = may_stay(sim);
    size_t n = 0;
    for (size_t group = g->n / DEM_GROUP + 1; group-- > 0;) {
        if (noted && g->slack[group] != DEM_SLACK_OUT) continue;
        const size_t first = group * DEM_GROUP, end = first + DEM_GROUP < g->n ? first + DEM_GROUP : g->n;
        for (size_t i = end; i-- > first;) {
            if (g->moved_to[i] == DEM_NOWHERE || !dem_beyond(sim, g->motion[i].x)) continue;
            size_t k = n++;
            for (; k > 0 && g->moved_to[left[k - 1]] < g->moved_to[i]; k--) left[k] = left[k - 1];
            left[k] = (uint32_t)i;
        }
    }
    return n;
}

/* The last grain takes the place of grain i. */
static void take_out(dem_grains *g, uint32_t i)
{
    uint32_t *const place = g->moved_to, *const at = g->held;
    const uint32_t last = at[g->n - ++g->n_gone];
    at[place[i]] = last;
    place[last] = place[i];
    place[i] = DEM_NOWHERE;
}

/* Beyond the reach of its listed pairs, and held there as a fixed grain is. A margin is at most r_max and
 * half a skin; a pair is listed within both cutoffs, the other grain moves by its margin, and then may touch:
 * together 7 r_max and 1.5 skins. Two that left stay as they were to each other. */
static void put_away(dem_sim *sim, uint32_t i)
{
    dem_grains *g = &sim->grains;
    g->listed_x[i][1] += 8.0 * (sim->r_max + sim->list.skin);
    g->fixed[g->n_fixed++] = i;
    dem_hold_grain(sim, i);
}

static void drop_slots(dem_sim *sim)
{
    size_t n = 0;
    for (size_t k = 0; k < sim->walls.n_slots; k++)
        if (sim->grains.moved_to[sim->walls.slot[k].grain] != DEM_NOWHERE)
            sim->walls.slot[n++] = sim->walls.slot[k];
    if (n == sim->walls.n_slots) return;
    sim->walls.n_slots = n;
    dem_walls_link(&sim->walls, sim->def.n_walls, sim->grains.n, sim->grains.held_slot);
    dem_threads_find_slots(sim);
}

void dem_neighbours_drop(dem_sim *sim)
{
    dem_grains *g = &sim->grains;
    for (uint32_t i = 0; i < g->n && g->n_gone == 0; i++) g->moved_to[i] = g->held[i] = i;
    const size_t n = find_left(sim, g->cell);
    for (size_t m = 0; m < n; m++) take_out(g, g->cell[m]);
    drop_slots(sim);
    if (!may_stay(sim))
        dem_neighbours_close_gaps(sim);
    else
        for (size_t m = 0; m < n; m++) put_away(sim, g->cell[m]);
}

/* A pair of a grain that left becomes a pair of grain 0 with itself, which does not touch: two that left
 * together may still have touched. */
static void rename_pairs(dem_pairs *pairs, const uint32_t *place)
{
    for (size_t k = 0; k < pairs->n; k++) {
        const uint32_t i = place[pairs->i[k]], j = place[pairs->j[k]];
        const bool gone = i == DEM_NOWHERE || j == DEM_NOWHERE;
        pairs->i[k] = gone ? 0 : i;
        pairs->j[k] = gone ? 0 : j;
        if (gone) pairs->radii[k] = 0.0, pairs->touching[k / 64] &= ~(1ull << k % 64);
    }
}

void dem_neighbours_close_gaps(dem_sim *sim)
{
    dem_grains *g = &sim->grains;
    const uint32_t *place = g->moved_to;
    const size_t n = g->n - g->n_gone, n_fixed = g->n_fixed;
    if (g->n_gone == 0) return;
    rename_pairs(&sim->pairs, place);
    for (size_t k = 0; k < sim->walls.n_slots; k++)
        sim->walls.slot[k].grain = place[sim->walls.slot[k].grain];
    g->n_fixed = 0;
    for (size_t k = 0; k < n_fixed; k++)
        if (place[g->fixed[k]] != DEM_NOWHERE) g->fixed[g->n_fixed++] = place[g->fixed[k]];
    /* only grains from n on have taken the place of others */
    for (size_t i = n; i < g->n; i++)
        if (place[i] != DEM_NOWHERE) dem_grains_move(g, i, place[i]);
    g->n = n, g->n_gone = 0;
    sim->pairs.n_chunks = 0; /* grains are no longer in the order of the list */
}
