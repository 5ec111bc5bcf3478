/* Threads of a run, and the parts that they work on. They live as long as a dem_run: nothing of them is in a
 * clone, a snapshot or a process that is forked. */
#ifndef DEM_TEAM_H
#define DEM_TEAM_H

#include "dem/state/state.h"

/* What one thread works on: of a divided pile, grains from a multiple of DEM_GROUP on, pairs from a multiple
 * of 64 on; else shares of arrays. */
typedef struct {
    size_t index, of;
    size_t grain, grain_end, pair, pair_end;
    const uint32_t *done; /* as dem_pairs has it, for the chunks of these pairs and the grains of the part */
    const bool *late;     /* groups of grains that another part reads; NULL: none */
    dem_pairs before, after; /* copies of pairs of the parts before and after with grains of this one */

    /* a task that makes new pairs: these, from number found_from on in the list */
    bool collects;
    dem_pairs found;
    size_t found_from;
    struct dem_share *share; /* the rest of the part; parts.c */
} dem_part;

/* Work on a part. `sim` is a copy for the task, of the same arrays: results are what it writes into them, and
 * the fields too_deep, ahead_left, list.fastest and list.far2. */
typedef rp_status dem_task(dem_sim *sim, dem_part *part);

struct dem_team {
    size_t n;              /* parts; the caller of a task works on the first */
    dem_part *part;        /* [n] */
    struct dem_crew *crew; /* the threads */
    bool *late;            /* of the parts */
    size_t late_capacity;
};

/* A team of up to n threads, NULL without memory or threads; its parts are all 0 but `index` and `of`. */
struct dem_team *dem_team_start(size_t n);
void dem_team_end(struct dem_team *team);

/* The task at once for each thread, or without threads for a part that is all: of shares of some arrays, or
 * of the parts of a divided pile. Errors: those of the task, of the first part that has one. */
rp_status dem_threads_do(dem_sim *sim, dem_task *task);

/* The part's share of n things, from and to a multiple of `unit` or the end. */
static inline size_t dem_share_start(const dem_part *part, size_t n, size_t unit)
{
    return n * part->index / part->of / unit * unit;
}

static inline size_t dem_share_end(const dem_part *part, size_t n, size_t unit)
{
    return part->index + 1 == part->of ? n : n * (part->index + 1) / part->of / unit * unit;
}

#endif
