/* Static friction of the ground; see dem_ground. */
#ifndef DEM_GROUND_H
#define DEM_GROUND_H

#include "dem/walls.h"

bool dem_is_ground(const dem_sim *sim, const dem_wall_slot *slot);

/* Displacement of a grain in its well, and the force along the ground's tangent that this gives. */
double dem_ground_displacement(const dem_sim *sim, const dem_wall_slot *slot);
double dem_ground_force(const dem_sim *sim, const dem_wall_slot *slot, double normal_force);

/* Set or break the well of a contact under forces of the contact `f` and of the pairs, and give the well's
 * force. */
dem_vec dem_ground_hold(const dem_sim *sim, dem_wall_slot *slot, double normal_force, dem_vec f,
                        dem_vec ground_velocity);

#endif
