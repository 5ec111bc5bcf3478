/* Hard collisions of a run, of bodies.h. Bodies that would touch in the coming step collide at the moment of
 * touch if they close fast; otherwise a soft contact forms. */
#ifndef DEM_HARD_H
#define DEM_HARD_H

#include "dem/dem.h"

/* Hard collisions of the coming step, before it; then that step. *left as of dem_step_lists. Errors:
 * RP_BROKEN, RP_NO_MEMORY. */
rp_status dem_hard_apply(dem_sim *sim);
rp_status dem_hard_move(dem_sim *sim, unsigned *left);

#endif
