/* The methods of a program of the core alone, as `make standalone` builds it. */
#include "dem/state/method.h"

const dem_scheme *const dem_schemes[DEM_INTEGRATORS] = {[DEM_VERLET] = &dem_scheme_verlet};
const dem_collisions *const dem_hard_collisions = NULL;
