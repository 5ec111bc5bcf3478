/* Parts of a step that integrators share, in this order; gravity. */
#ifndef DEM_STEP_H
#define DEM_STEP_H

#include "dem/state/state.h"

/* Once grains are where the step takes them: count it, and rebuild the neighbour list or take grains out as
 * `left` asks. Errors: RP_BROKEN, RP_NO_MEMORY. */
rp_status dem_step_lists(dem_sim *sim, unsigned left);

/* All forces, checks of overlaps, and the ledger's notes. Errors: RP_BROKEN, RP_NO_MEMORY. */
rp_status dem_step_forces(dem_sim *sim);

/* An overlap beyond the smallest radius was seen, of the pairs or of the grains with a wall: stop if it is
 * beyond the smaller of its own two. Errors: RP_BROKEN. */
rp_status dem_check_overlaps(dem_sim *sim, dem_stretch pairs, dem_stretch grains);

/* Gravity and its turn are the definition's; turn gravity by a step's angle if it turns now. */
void dem_gravity_start(dem_sim *sim);
void dem_gravity_advance(dem_sim *sim);

#endif
