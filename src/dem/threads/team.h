/* Threads in one large pile. The grains of a pile are divided into parts, one for each thread. A part sums
 * the forces on its own grains, from its stretch of the list and from copies of the other pairs that these
 * grains have. It takes all of them in the order of the list, so that each sum has the bits of one thread. */
#ifndef DEM_THREADS_H
#define DEM_THREADS_H

#include "dem/state/pairs.h"

struct dem_sim;

/* What one thread works on: grains from a multiple of DEM_GROUP on, pairs from a multiple of 64 on. */
typedef struct {
    size_t index, of;
    size_t grain, grain_end, pair, pair_end;
    const uint32_t *done; /* as dem_pairs has it, for the chunks of these pairs and the grains of the part */
    const bool *late;     /* groups of grains that another part reads; NULL: none */
    dem_pairs before, after; /* copies of pairs of the parts before and after with grains of this one */
} dem_part;

/* Work on a part. `sim` is a copy for the task, of the same arrays: results are what it writes into them, and
 * the fields too_deep, ahead_left, list.fastest and list.far2. */
typedef rp_status dem_task(struct dem_sim *sim, dem_part *part);

/* For the steps of a run that is large enough, start the threads that sim->threads asks for and divide the
 * pile. Without memory or threads, the run goes on with one. */
void dem_threads_start(struct dem_sim *sim);
void dem_threads_end(struct dem_sim *sim);

/* The task at once for each thread, or without threads for a part that is all: of shares of some arrays, or
 * of the parts of a divided pile. Errors: those of the task, of the first part that has one. */
rp_status dem_threads_do(struct dem_sim *sim, dem_task *task);
rp_status dem_threads_do_parts(struct dem_sim *sim, dem_task *task);

/* Divide the pile by a new list; its forces move to the parts. Errors: RP_NO_MEMORY. */
rp_status dem_threads_divide(struct dem_sim *sim);

/* Find the parts' wall slots again, where some have gone. */
void dem_threads_find_slots(struct dem_sim *sim);

/* Are there threads, and is the pile as they have divided it? */
bool dem_threads_divided(const struct dem_sim *sim);

/* In a task that makes new pairs: let `sim` have an empty list of the part's own. Then put these lists one
 * after another: grains of the pairs alone. Errors: RP_NO_MEMORY. */
void dem_threads_collect(struct dem_sim *sim, const dem_part *part);
rp_status dem_threads_gather(struct dem_sim *sim);

/* In a task of a divided pile: let `sim` have the part's forces and wall slots. Add the forces of copies. */
void dem_threads_enter(struct dem_sim *sim, const dem_part *part);
void dem_threads_copies(struct dem_sim *sim, const dem_pairs *copies);

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
