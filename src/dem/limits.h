/* The largest time step; dem_time_step_limit is in dem.h. */
#ifndef DEM_LIMITS_H
#define DEM_LIMITS_H

#include "dem/dem.h"

/* Speed of an impact to come: the largest closing speed at the start and a fall from the highest grain to
 * the lowest grain or wall. */
double dem_impact_speed(const dem_definition *def);

/* Contacts that the start has may be stiffer than any impact to come. Errors: RP_BAD_INPUT. */
rp_status dem_check_start_overlaps(const dem_sim *sim);

#endif
