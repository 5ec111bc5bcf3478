/* Threads of a run, and the parts that they work on. They live as long as a dem_run: nothing of them is in a
 * clone, a snapshot or a process that is forked. */
#ifndef DEM_THREADS_H
#define DEM_THREADS_H

#include "dem/state/state.h"

/* What one thread works on: of a divided pile, grains from a multiple of DEM_GROUP on, pairs from a multiple
 * of 64 on; else shares of arrays. */
typedef struct {
    size_t index, of;
    size_t from, to; /* of the things that a task shares */
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

/* The task at once for each thread, or without threads for a part that is all: of its share of n things, from
 * and to a multiple of `unit` or the end; or with n = 0, of its part of a divided pile. Errors: those of the
 * task, of the first part that has one. */
rp_status dem_threads_do(dem_sim *sim, dem_task *task, size_t n, size_t unit);

/* ---- Parts of one large pile, one for each thread; parts.c. A part sums the forces on its own grains, from
 * its stretch of the list and from copies of the other pairs that these grains have. It takes all of them in
 * the order of the list, so that each sum has the bits of one thread. ---- */

/* For the steps of a run that is large enough, start the threads that sim->threads asks for and divide the
 * pile. Without memory or threads, the run continues with one. */
void dem_threads_start(dem_sim *sim);
void dem_threads_end(dem_sim *sim);

/* A task for each part of a divided pile, or for a part that is all of it. Errors: as dem_threads_do. */
rp_status dem_threads_do_parts(dem_sim *sim, dem_task *task);

/* Divide the pile by a new list; its forces move to the parts. Errors: RP_NO_MEMORY. */
rp_status dem_threads_divide(dem_sim *sim);

/* Find the parts' wall slots again, where some have gone. */
void dem_threads_find_slots(dem_sim *sim);

/* Are there threads, and is the pile as they have divided it? */
bool dem_threads_divided(const dem_sim *sim);

/* In a task that makes new pairs: let `sim` have an empty list of the part's own. Then put these lists one
 * after another: grains of the pairs alone. Errors: RP_NO_MEMORY. */
void dem_threads_collect(dem_sim *sim, dem_part *part);
rp_status dem_threads_gather(dem_sim *sim);

/* In a task of a divided pile: let `sim` have the part's forces and wall slots. Add the forces of copies. */
void dem_threads_enter(dem_sim *sim, const dem_part *part);
void dem_threads_copies(dem_sim *sim, const dem_pairs *copies);

#endif
