/* Radii of a fill: its law, whose shares may be of number, area or mass. */
#ifndef DEM_RADII_H
#define DEM_RADII_H

#include "core/random.h"
#include "dem/scene/fill.h"

/* Grains of a spacing of their own may overlap by this part of their radii: of a lattice whose sizes scatter.
 */
#define DEM_SPACING_OVERLAP 0.1

/* One radius, between radius_min and radius_max where those cut the law; of a table one of its radii. */
double dem_radius_draw(const dem_fill *fill, rp_random *radii);

/* Of the mean grain, by the law's own shares and before the cut. */
double dem_radius_mean(const dem_fill *fill);

/* Refuse a law that has no radius, as dem_radius_check; of a table radii and shares that are none. Errors:
 * RP_BAD_INPUT. */
rp_status dem_radii_check(const dem_fill *fill);

/* The smallest and the largest radius that can come. */
double dem_radius_least(const dem_fill *fill);
double dem_radius_most(const dem_fill *fill);

#endif
