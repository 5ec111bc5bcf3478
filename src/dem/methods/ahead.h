/* Steps in which grains may run ahead. In a pile larger than the cache, grains go on to the next step while
 * they are in it, before the forces on all the others are there. In threads, each moves its own part. */
#ifndef DEM_AHEAD_H
#define DEM_AHEAD_H

#include "dem/state/state.h"

/* Move the grains by sim->loops.advance; *left as of dem_step_lists. Those that are ahead have gone already.
 */
rp_status dem_ahead_move(dem_sim *sim, unsigned *left);

/* The forces after that, and of a step that is not the last one the next step of grains that may run ahead.
 * Errors: as dem_step_forces. */
rp_status dem_ahead_forces(dem_sim *sim, bool last);

#endif
