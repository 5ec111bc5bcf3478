/* The neighbour list; dem_neighbours_rebuild is in dem.h. */
#ifndef DEM_LIST_H
#define DEM_LIST_H

#include "dem/state/state.h"

/* Work space of a simulation, or of the copy of another, for its capacity of grains. Errors: RP_NO_MEMORY. */
rp_status dem_neighbours_alloc(dem_sim *sim, const dem_sim *like);
void dem_neighbours_free(dem_sim *sim);

/* Its part of a snapshot; a reading makes the work space. */
void dem_neighbours_keep(rp_snapshot *s, dem_sim *sim);

/* For hard collisions: let every grain's margin hold its displacement of the coming step. Few grains get
 * their part of the list anew, else all of it is rebuilt. The margin follows a grain's speed now. If that was
 * too small for a slow grain that a fast one has hit in a soft contact (accelerates), the speed that it is
 * about to have counts. Errors: RP_BROKEN, RP_NO_MEMORY. */
rp_status dem_neighbours_renew(dem_sim *sim, bool accelerates);

/* Take out the grains that left, with their pairs and wall slots, and keep the list as it is; removal.c. In a
 * large pile, they stay in the arrays of grains and pairs until the second function: of the rebuilding and of
 * the end of a run. */
void dem_neighbours_drop(dem_sim *sim);
void dem_neighbours_close_gaps(dem_sim *sim);

#endif
