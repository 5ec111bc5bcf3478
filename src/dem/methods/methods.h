/* What the methods share: parts of a step, grains that run ahead; gravity. */
#ifndef DEM_METHODS_H
#define DEM_METHODS_H

#include "dem/state/state.h"

/* ---- Parts of a step that integrators share, in this order; step.c ---- */

/* Once grains are where the step takes them: count it, and rebuild the neighbour list or take grains out as
 * `left` asks. Errors: RP_BROKEN, RP_NO_MEMORY. */
rp_status dem_step_lists(dem_sim *sim, unsigned left);

/* All forces, checks of overlaps, and the ledger's notes. Errors: RP_BROKEN, RP_NO_MEMORY. */
rp_status dem_step_forces(dem_sim *sim);

/* An overlap beyond the smallest radius was seen, of the pairs or of the grains with a wall: stop if it is
 * beyond the smaller of its own two. Errors: RP_BROKEN. */
rp_status dem_check_overlaps(dem_sim *sim, dem_stretch pairs, dem_stretch grains);

/* Gravity and its turn are the definition's; turn gravity by a step's angle if it turns now; gravity.c. */
void dem_gravity_start(dem_sim *sim);
void dem_gravity_advance(dem_sim *sim);

/* ---- Steps in which grains may run ahead; ahead.c. In a pile larger than the cache, grains go on to the
 * next step while they are in it, before the forces on all the others are there. In threads, each moves its
 * own part. ---- */

/* Move the grains by sim->loops.advance; *left as of dem_step_lists. Those that are ahead have gone already.
 */
rp_status dem_ahead_move(dem_sim *sim, unsigned *left);

/* The forces after that, and of a step that is not the last one the next step of grains that may run ahead.
 * Errors: as dem_step_forces. */
rp_status dem_ahead_forces(dem_sim *sim, bool last);

#endif
