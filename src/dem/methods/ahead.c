/* Grains that run ahead; see methods.h. */
#include "dem/methods/methods.h"

#include <math.h>

#include "dem/forces/forces.h"
#include "dem/threads/threads.h"

/* Has a grain of a group moved beyond its margin, and how far may they go until one can? A displacement d
 * leaves m - d >= (m^2 - d^2) / (2 m) of a margin m. */
static unsigned measure_slack(dem_sim *sim, size_t from, size_t to)
{
    dem_moved moved = {.beyond = -INFINITY};
    sim->loops.margins(sim, from, to, &moved);
    const double margin = sqrt(moved.margin2);
    sim->grains.slack[from / DEM_GROUP] = -0.5 * moved.beyond / margin - 1e-9 * margin;
    return moved.left;
}

/* Advance the grains from..to by a step, `from` a multiple of DEM_GROUP. Gives DEM_LIST_OUT and
 * DEM_GRAIN_OUT. In a pile larger than the cache, margins are looked at only where they may be used up. In a
 * smaller one, looking at all costs less. */
static unsigned move(dem_sim *sim, size_t from, size_t to)
{
    dem_moved all = {0};
    if (sim->pairs.n_chunks == 0) {
        sim->loops.advance(sim, from, to, &all);
        return all.left;
    }
    for (size_t end; from < to; from = end) {
        dem_moved moved = {0};
        double *slack = &sim->grains.slack[from / DEM_GROUP];
        end = from + DEM_GROUP < to ? from + DEM_GROUP : to;
        sim->loops.advance(sim, from, end, &moved);
        *slack -= 1.000001 * sim->def.dt * sqrt(moved.speed2) + sim->list.round_off;
        if (!(*slack > 0.0)) all.left |= measure_slack(sim, from, end);
        if (moved.left) *slack = DEM_SLACK_OUT;
        all.left |= moved.left;
    }
    return all.left;
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

static void count_step(dem_sim *sim)
{
    sim->count.grain_steps += (double)(sim->grains.n - sim->grains.n_gone);
}

rp_status dem_ahead_move(dem_sim *sim, unsigned *left)
{
    if (!sim->ahead) {
        sim->ahead_left = 0;
        count_step(sim);
        RP_TRY(dem_threads_do_parts(sim, move_part));
    }
    sim->ahead = false;
    *left = sim->ahead_left;
    return RP_OK;
}

/* May grains go on before the forces on all the others are there? */
static bool may_run_ahead(const dem_sim *sim)
{
    const dem_definition *def = &sim->def;
    return sim->pairs.n_chunks > 0 && !sim->loops.general && !def->hard.on && !sim->ledger && !sim->times &&
           def->turn_per_step == 0.0 && def->box_turn_per_step == 0.0 && sim->walls.n_moving == 0;
}

/* The forces of the walls on a part's grains from `from` to `to`, after those of its pairs; then their next
 * step, if they run ahead. */
static rp_status finish_grains(dem_sim *sim, const dem_part *part, dem_stretch pairs, dem_stretch grains)
{
    dem_walls_apply(sim, grains.from, grains.to, sim->def.dt);
    if (sim->too_deep) RP_TRY(dem_check_overlaps(sim, pairs, (dem_stretch){grains.from, part->grain_end}));
    if (sim->ahead) move_groups(sim, part, grains.from, grains.to, false);
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
        sim->loops.pairs(sim, k, end, sim->def.dt);
        RP_TRY(finish_grains(sim, part, (dem_stretch){k, end}, (dem_stretch){i, part->done[c]}));
        i = part->done[c];
    }
    dem_threads_copies(sim, &part->after);
    if (i < part->grain_end)
        RP_TRY(finish_grains(sim, part, (dem_stretch){k, k}, (dem_stretch){i, part->grain_end}));
    if (sim->ahead) hold_fixed(sim, part, false);
    return RP_OK;
}

rp_status dem_ahead_forces(dem_sim *sim, bool last)
{
    sim->ahead_left = 0;
    sim->ahead = !last && may_run_ahead(sim);
    if (last || (!sim->ahead && !dem_threads_divided(sim))) return dem_step_forces(sim);
    RP_TRY(dem_threads_do_parts(sim, sum_part));
    if (!sim->ahead) return RP_OK;
    count_step(sim);
    return dem_threads_divided(sim) ? dem_threads_do_parts(sim, move_late) : RP_OK;
}
