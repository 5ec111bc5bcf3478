/* Parts of one large pile, one for each thread. A part sums the forces on its own grains, from its stretch of
 * the list and from copies of the other pairs that these grains have. It takes all of them in the order of
 * the list, so that each sum has the bits of one thread. */
#ifndef DEM_PARTS_H
#define DEM_PARTS_H

#include "dem/threads/team.h"

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
