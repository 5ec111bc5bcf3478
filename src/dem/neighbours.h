/* Neighbour list; neighbours.c. dem_neighbours_rebuild is in dem.h. */
#ifndef DEM_NEIGHBOURS_H
#define DEM_NEIGHBOURS_H

#include "core/snapshot.h"
#include "dem/dem.h"

/* Work space of a simulation, or of the copy of another, for its capacity of grains. Errors: RP_NO_MEMORY. */
rp_status dem_neighbours_alloc(dem_sim *sim, const dem_sim *like);
void dem_neighbours_free(dem_sim *sim);

/* Its part of a snapshot; a reading makes the work space. */
void dem_neighbours_keep(rp_snapshot *s, dem_sim *sim);

/* For hard collisions: let every grain's margin hold its displacement of the coming step. Few grains get
 * their part of the list anew, else all of it is rebuilt. Errors: RP_BROKEN, RP_NO_MEMORY. */
rp_status dem_neighbours_renew(dem_sim *sim);

/* Take out the grains that left, with their pairs and wall slots, and keep the list as it is. */
void dem_neighbours_drop(dem_sim *sim);

#endif
