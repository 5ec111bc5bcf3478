/* Verlet neighbour list. Grains are sorted by square cells, see search.c. Each grain has a margin: its
 * largest displacement until the list is rebuilt. Pairs nearer than the sum of their cutoffs (radius and
 * margin) are listed, and grains nearer to a wall than their cutoff. A rebuilding keeps the springs of
 * touching contacts and depends on the state alone. With hard collisions, few grains beyond their margins get
 * new pairs at the end of the list. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dem/forces/forces.h"
#include "dem/list/list.h"
#include "dem/threads/threads.h"

static rp_status no_memory(void)
{
    return rp_fail(RP_NO_MEMORY, "neighbour list: out of memory");
}

/* Margin of a grain: half a given skin, else STEPS steps at its speed, within bounds in mean radii. A few
 * fast grains then neither make rebuildings frequent nor give all others distant pairs. */
static double margin(const dem_sim *sim, double speed)
{
    const bool hard = sim->def.hard.on; /* few disks fall onto many at rest */
    const double STEPS = hard ? 50.0 : 25.0, LEAST = 0.08, MOST = hard ? 1.5 : 1.0;
    return sim->list.even_margins ? 0.5 * sim->list.skin
                                  : fmin(LEAST * sim->start.radius_mean + STEPS * sim->def.dt * speed,
                                         MOST * sim->start.radius_mean);
}

/* Of cells that hold the widest pair, at this largest speed. */
static double cell_size(const dem_sim *sim, double speed)
{
    return 2.0 * (sim->r_max + margin(sim, speed));
}

/* Work space for these cells and so many grains. */
static rp_status reserve(dem_sim *sim, dem_cells cells, size_t capacity)
{
    if (!sim->list.work && !(sim->list.work = calloc(1, sizeof *sim->list.work))) return no_memory();
    struct dem_list_work *w = sim->list.work;
    w->held.rolling = sim->pairs.rolling, w->held.springs_only = true;
    RP_TRY(dem_grains_reserve(sim, capacity, true, &w->spare));
    if (!(cells.start = calloc(cells.columns * cells.rows + 1, sizeof *cells.start))) return no_memory();
    free(w->cells.start);
    w->cells = cells;
    return RP_OK;
}

rp_status dem_neighbours_alloc(dem_sim *sim)
{
    dem_cells cells = {0};
    dem_cells_choose(sim, cell_size(sim, 0.0), &cells);
    return reserve(sim, cells, sim->grains.capacity);
}

rp_status dem_neighbours_grow(dem_sim *sim, size_t capacity)
{
    dem_cells cells = sim->list.work->cells;
    while (4 * cells.columns * cells.rows < sim->grains.n)
        *(cells.columns < cells.rows ? &cells.columns : &cells.rows) *= 2;
    return reserve(sim, cells, capacity);
}

void dem_neighbours_keep(rp_snapshot *s, dem_sim *sim)
{
    dem_cells cells = {0};
    if (!s->reading) cells = sim->list.work->cells;
    RP_KEEP(s, cells.columns);
    RP_KEEP(s, cells.rows);
    rp_keep_check(s, dem_cells_are_possible(&cells, sim->grains.last_id), "impossible cells");
    if (!s->status && s->reading) s->status = reserve(sim, cells, sim->grains.capacity);
}

void dem_neighbours_free(dem_sim *sim)
{
    struct dem_list_work *w = sim->list.work;
    if (!w) return;
    dem_grains_free(&w->spare);
    dem_pairs_free(&w->held);
    free(w->cells.start), free(w->apart), free(w->wall_slot), free(w);
    dem_sizes_free(sim->list.sizes);
    sim->list.work = NULL, sim->list.sizes = NULL;
}

/* Faults of a grain that a rebuilding finds; raises list.fastest to its speed. */
static rp_status check_grain(dem_sim *sim, size_t i)
{
    const double size = 2.0 * sim->r_max + sim->list.skin;
    dem_vec x = sim->grains.motion[i].x, v = sim->grains.motion[i].v;
    if (!isfinite(x[0] + x[1] + v[0] + v[1]))
        return dem_stop(sim, DEM_FAULT_NON_FINITE, i, "a number is not finite");
    const double speed = sqrt(dem_dot(v, v)), travel = speed * sim->def.dt;
    sim->list.fastest = fmax(sim->list.fastest, speed);
    if (travel > sim->grains.radius[i])
        return dem_stop(sim, DEM_FAULT_TOO_FAST, i, "moves %g in one step, its radius is %g", travel,
                        sim->grains.radius[i]);
    if (fabs(x[0]) > 1e9 * size || fabs(x[1]) > 1e9 * size)
        return dem_stop(sim, DEM_FAULT_LEAKED, i, "far away at x = %g, y = %g", x[0], x[1]);
    for (size_t k = 0; k < sim->def.n_walls && sim->grains.inverse_mass[i] > 0.0; k++) {
        const dem_wall_line *line = &sim->walls.line[k];
        if (!(dem_dot(x - line->point, line->direction) < 0.0)) continue;
        if (dem_wall_is_line(&sim->walls.wall[k]) && !dem_wall_opens(sim, k))
            return dem_stop(sim, DEM_FAULT_LEAKED, i, "behind wall %zu at x = %g, y = %g", k + 1, x[0], x[1]);
    }
    return RP_OK;
}

static rp_status check_grains(dem_sim *sim, dem_part *part)
{
    for (size_t i = part->from; i < part->to; i++) RP_TRY(check_grain(sim, i));
    return RP_OK;
}

static double speed_of(const dem_motion *grain)
{
    return sqrt(dem_dot(grain->v, grain->v));
}

/* Let the position of a grain in the list be that of now, with the margin of this speed. */
static void mark_grain(dem_sim *sim, size_t i, double speed)
{
    const double most = margin(sim, speed);
    sim->grains.listed_x[i] = sim->grains.motion[i].x;
    sim->grains.margin2[i] = most * most;
    sim->grains.cutoff[i] = sim->grains.radius[i] + most;
    sim->grains.slack[i / DEM_GROUP] = 0.0;
}

static rp_status move_grains(dem_sim *sim, dem_part *part)
{
    dem_grains_put(&sim->grains, sim->grains.moved_to, &sim->list.work->spare, part->from, part->to);
    return RP_OK;
}

static rp_status mark_grains(dem_sim *sim, dem_part *part)
{
    for (size_t i = part->from; i < part->to; i++) {
        const dem_vec x = sim->grains.motion[i].x;
        mark_grain(sim, i, speed_of(&sim->grains.motion[i]));
        sim->grains.held[i] = DEM_NOWHERE;
        sim->list.far2 = fmax(sim->list.far2, dem_dot(x, x));
    }
    return RP_OK;
}

/* Drop the grains that left; sort the others by cells that hold the widest pair. */
static rp_status sort_grains(dem_sim *sim)
{
    dem_cells *const cells = &sim->list.work->cells;
    RP_TRY(dem_cells_sort(sim, cell_size(sim, sim->list.fastest)));
    RP_TRY(dem_threads_do(sim, move_grains, sim->grains.n, 1));
    dem_grains_take(&sim->grains, &sim->list.work->spare, cells->start[cells->columns * cells->rows]);
    sim->grains.n_fixed = 0;
    for (size_t i = 0; i < sim->grains.n; i++)
        if (dem_is_fixed(sim, i)) sim->grains.fixed[sim->grains.n_fixed++] = (uint32_t)i;
    sim->list.far2 = 0.0;
    return dem_threads_do(sim, mark_grains, sim->grains.n, DEM_GROUP);
}

/* Round-off of a position at this squared distance from the origin, at most. */
static double round_off(const dem_sim *sim, double far2)
{
    return 1e-15 * (sqrt(far2) + sim->list.skin);
}

/* Keep the springs of touching pairs of the part's share of the old list. The order of a chain does not
 * matter. */
static rp_status hold_part(dem_sim *sim, dem_part *part)
{
    const dem_pairs *pairs = &sim->pairs;
    dem_pairs *held = &sim->list.work->held;
    uint32_t n = (uint32_t)dem_count_touching_below(pairs, part->from), *const first = sim->grains.held;
    DEM_EACH_TOUCHING_OF(pairs, part->from, part->to, k)
    {
        const uint32_t a = sim->grains.moved_to[pairs->i[k]], b = sim->grains.moved_to[pairs->j[k]];
        if (a == DEM_NOWHERE || b == DEM_NOWHERE) continue;
        uint32_t *const low = &first[a < b ? a : b];
        dem_pairs_take_springs(held, n, pairs, k, a > b);
        held->j[n] = a < b ? b : a;
        if (part->of > 1)
            held->i[n] = __atomic_exchange_n(low, n, __ATOMIC_RELAXED);
        else
            held->i[n] = *low, *low = n;
        n++;
    }
    return RP_OK;
}

/* Give pair k of grains a and b the springs it held before. */
static void restore_springs(dem_sim *sim, size_t k, uint32_t a, uint32_t b)
{
    const dem_pairs *held = &sim->list.work->held;
    uint32_t at = sim->grains.held[a < b ? a : b];
    while (at != DEM_NOWHERE && held->j[at] != (a < b ? b : a)) at = held->i[at];
    if (at != DEM_NOWHERE) dem_pairs_take_springs(&sim->pairs, k, held, at, a > b);
}

/* Fill in the other entries of the pairs k..end; springs are 0. */
static void complete_pairs(dem_sim *sim, size_t k, size_t end)
{
    const dem_grains *g = &sim->grains;
    dem_pairs *pairs = &sim->pairs;
    for (; k < end; k++) {
        const size_t i = pairs->i[k], j = pairs->j[k];
        const double radii = g->radius[i] + g->radius[j], m_i = g->mass[i], m_j = g->mass[j];
        pairs->radii[k] = radii;
        pairs->m_eff[k] = dem_is_fixed(sim, i) ? m_j : dem_is_fixed(sim, j) ? m_i : m_i * m_j / (m_i + m_j);
        pairs->r_eff[k] = g->radius[i] * g->radius[j] / radii;
        if (pairs->kinds) pairs->entry[k] = (uint32_t)(g->kind[j] * sim->def.n_kinds + g->kind[i]);
        if (pairs->rotation) pairs->radius_i[k] = g->radius[i], pairs->radius_j[k] = g->radius[j];
#define X(type, name, need, share, role)                                                                     \
    if (role != DEM_MADE && pairs->name) pairs->name[k] = 0;
        DEM_PAIR_ARRAYS(X)
#undef X
    }
}

/* Of the pairs k..end, k a multiple of 64. */
static void find_touching(dem_sim *sim, size_t k, size_t end)
{
    uint64_t *restrict touching = sim->pairs.touching, word = 0;
    for (; k < end; k++) {
        dem_vec d = sim->grains.motion[sim->pairs.i[k]].x - sim->grains.motion[sim->pairs.j[k]].x;
        dem_note(touching, k, dem_dot(d, d) < sim->pairs.radii[k] * sim->pairs.radii[k], &word);
    }
}

/* Touching pairs first, both parts in their order. A block of the pair loop is then full of touching pairs or
 * skipped. */
static rp_status part_pairs(dem_sim *sim)
{
    struct dem_list_work *w = sim->list.work;
    RP_TRY(dem_room("neighbour list", &w->apart, 2 * sizeof *w->apart, sim->pairs.n, &w->apart_capacity));
    size_t touching = 0, apart = 0;
    for (size_t k = 0; k < sim->pairs.n; k++) {
        const uint32_t i = sim->pairs.i[k], j = sim->pairs.j[k];
        const dem_vec d = sim->grains.motion[i].x - sim->grains.motion[j].x;
        const double radii = sim->grains.radius[i] + sim->grains.radius[j];
        if (dem_dot(d, d) < radii * radii) {
            sim->pairs.i[touching] = i;
            sim->pairs.j[touching++] = j;
        } else {
            w->apart[2 * apart] = i;
            w->apart[2 * apart++ + 1] = j;
        }
    }
    for (size_t k = 0; k < apart; k++) {
        sim->pairs.i[touching + k] = w->apart[2 * k];
        sim->pairs.j[touching + k] = w->apart[2 * k + 1];
    }
    return RP_OK;
}

/* The part's share of the new list. */
static rp_status complete_part(dem_sim *sim, dem_part *part)
{
    complete_pairs(sim, part->from, part->to);
    find_touching(sim, part->from, part->to);
    DEM_EACH_TOUCHING_OF(&sim->pairs, part->from, part->to, k)
    restore_springs(sim, k, sim->pairs.i[k], sim->pairs.j[k]);
    return RP_OK;
}

/* May grain i touch wall k until the next rebuilding? A wall that is gone touches none. */
static bool is_near_wall(const dem_sim *sim, size_t k, size_t i)
{
    const dem_wall *wall = &sim->walls.wall[k];
    const dem_wall_line *line = &sim->walls.line[k];
    const bool turns = sim->def.box_turn_per_step != 0.0 && sim->step >= sim->walls.turn_from_step;
    const double more = line->moves ? sim->walls.margin : turns ? 0.5 * sim->list.skin : 0.0;
    if (dem_wall_is_gone(sim, k)) return false;
    const dem_vec d = sim->grains.listed_x[i] - line->point;
    const double most = sim->grains.cutoff[i] + more, along = dem_dot(d, dem_clockwise(line->direction));
    return fabs(dem_dot(d, line->direction)) < most && !dem_is_fixed(sim, i) &&
           along >= wall->extent[0] - most && along <= wall->extent[1] + most;
}

/* Grains near any wall. */
static rp_status find_near_walls(dem_sim *sim, dem_part *part)
{
    for (size_t i = part->from; i < part->to; i++) {
        bool near = false;
        for (size_t k = 0; k < sim->def.n_walls && !near; k++) near = is_near_wall(sim, k, i);
        sim->grains.cell[i] = near;
    }
    return RP_OK;
}

/* Slots of grains near walls. */
static rp_status find_wall_slots(dem_sim *sim)
{
    struct dem_list_work *w = sim->list.work;
    const size_t n_old = sim->walls.n_slots;
    uint32_t *const near = sim->grains.cell;
    size_t n_near = 0;
    memset(sim->grains.held_slot, 0xff, sim->grains.n * sizeof *sim->grains.held_slot);
    RP_TRY(dem_room("neighbour list", &w->wall_slot, sizeof *w->wall_slot, n_old, &w->wall_capacity));
    if (n_old) memcpy(w->wall_slot, sim->walls.slot, n_old * sizeof *w->wall_slot);
    RP_TRY(dem_threads_do(sim, find_near_walls, sim->grains.n, 1));
    for (uint32_t i = 0; i < sim->grains.n; i++)
        if (near[i]) near[n_near++] = i;
    sim->walls.n_slots = 0;
    for (uint32_t k = 0; k < sim->def.n_walls; k++) {
        for (uint32_t s = 0; s < n_old; s++)
            if (w->wall_slot[s].wall == k && sim->grains.moved_to[w->wall_slot[s].grain] != DEM_NOWHERE)
                sim->grains.held_slot[sim->grains.moved_to[w->wall_slot[s].grain]] = s;
        for (size_t m = 0; m < n_near; m++) {
            const uint32_t i = near[m], held = sim->grains.held_slot[i];
            sim->grains.held_slot[i] = DEM_NOWHERE;
            if (!is_near_wall(sim, k, i)) continue;
            RP_TRY(dem_room("neighbour list", &sim->walls.slot, sizeof *sim->walls.slot,
                            sim->walls.n_slots + 1, &sim->walls.capacity));
            const dem_vec d = sim->grains.listed_x[i] - sim->walls.line[k].point;
            const bool behind = dem_dot(d, sim->walls.line[k].direction) < 0.0;
            dem_wall_slot *slot = &sim->walls.slot[sim->walls.n_slots++];
            *slot = held != DEM_NOWHERE ? w->wall_slot[held] : (dem_wall_slot){.side = behind ? -1.0 : 1.0};
            slot->wall = k;
            slot->grain = i;
        }
    }
    dem_walls_link(&sim->walls, sim->def.n_walls, sim->grains.n, sim->grains.held_slot);
    return RP_OK;
}

rp_status dem_neighbours_rebuild(dem_sim *sim)
{
    dem_neighbours_close_gaps(sim);
    sim->list.fastest = 0.0;
    RP_TRY(dem_threads_do(sim, check_grains, sim->grains.n, 1));
    sim->count.rebuilds++;
    RP_TRY(sort_grains(sim));
    dem_walls_limit(sim, sqrt(sim->list.far2));
    sim->list.round_off = round_off(sim, sim->list.far2);
    RP_TRY(dem_pairs_reserve(&sim->list.work->held, dem_count_touching(&sim->pairs)));
    RP_TRY(dem_threads_do(sim, hold_part, sim->pairs.n, 64));
    RP_TRY(dem_cells_find_pairs(sim));
    if (sim->def.hard.on) RP_TRY(part_pairs(sim));
    RP_TRY(dem_threads_do(sim, complete_part, sim->pairs.n, 64));
    dem_pairs_pad(&sim->pairs);
    RP_TRY(find_wall_slots(sim));
    RP_TRY(dem_pairs_plan_chunks(&sim->pairs, sim->grains.n));
    return dem_threads_divide(sim);
}

/* Remove the pairs of grain i that are beyond their cutoffs, and append those not yet listed. Touching pairs
 * stay, with their springs. `listed` holds numbers below `mark`. */
static rp_status renew_pairs(dem_sim *sim, uint32_t i, uint32_t *listed, uint32_t mark)
{
    listed[i] = mark;
    for (size_t k = 0; k < sim->pairs.n;) {
        const uint32_t a = sim->pairs.i[k], b = sim->pairs.j[k], j = a == i ? b : a;
        if (a != i && b != i) {
            k++;
            continue;
        }
        const dem_vec d = sim->grains.listed_x[i] - sim->grains.listed_x[j];
        const double cutoff = sim->grains.cutoff[i] + sim->grains.cutoff[j];
        if (dem_dot(d, d) < cutoff * cutoff)
            listed[j] = mark, k++;
        else
            dem_pairs_remove(&sim->pairs, k);
    }
    RP_TRY(dem_pairs_reserve(&sim->pairs, sim->grains.n));
    const size_t from = sim->pairs.n;
    sim->loops.append(sim, i, 0, sim->grains.n);
    size_t n = from;
    for (size_t k = from; k < sim->pairs.n; k++) {
        sim->pairs.j[n] = sim->pairs.j[k];
        n += listed[sim->pairs.j[k]] != mark;
    }
    sim->pairs.n = n;
    complete_pairs(sim, from, sim->pairs.n);
    return RP_OK;
}

/* Grains that have moved, or will move in the coming step, by half their margin get new listed positions and
 * margins. All others stay within theirs. A rebuilding takes as long as the pairs of some ten grains, and
 * replaces the wide margins of grains that were fast. */
rp_status dem_neighbours_renew(dem_sim *sim, bool accelerates)
{
    enum { FEW = 8 };
    uint32_t moved[FEW];
    size_t n = 0;
    for (size_t i = 0; i < sim->grains.n; i++) {
        const dem_vec d = sim->grains.motion[i].x - sim->grains.listed_x[i];
        const dem_vec next = 1.01 * sim->def.dt * sim->grains.next_motion[i].v;
        const double d2 = dem_dot(d, d), next2 = dem_dot(next, next);
        /* so that NaN counts as moved */
        if ((4.0 * d2 <= sim->grains.margin2[i]) & (4.0 * next2 <= sim->grains.margin2[i])) continue;
        if (n == FEW) return dem_neighbours_rebuild(sim);
        moved[n++] = (uint32_t)i;
    }
    for (size_t m = 0; m < n; m++) RP_TRY(check_grain(sim, moved[m]));
    for (size_t m = 0; m < n; m++) {
        const dem_vec x = sim->grains.motion[moved[m]].x;
        const dem_motion *now = &sim->grains.motion[moved[m]], *next = &sim->grains.next_motion[moved[m]];
        mark_grain(sim, moved[m], accelerates ? fmax(speed_of(now), speed_of(next)) : speed_of(now));
        sim->list.round_off = fmax(sim->list.round_off, round_off(sim, dem_dot(x, x)));
    }
    memset(sim->grains.cell, 0, sim->grains.n * sizeof *sim->grains.cell);
    for (size_t m = 0; m < n; m++) RP_TRY(renew_pairs(sim, moved[m], sim->grains.cell, (uint32_t)m + 1));
    dem_pairs_pad(&sim->pairs);
    find_touching(sim, 0, sim->pairs.n);
    for (uint32_t i = 0; i < sim->grains.n; i++) sim->grains.moved_to[i] = i;
    return find_wall_slots(sim);
}
