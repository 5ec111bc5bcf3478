/* All methods. */
#include "dem/state/method.h"

const dem_scheme *const dem_schemes[DEM_INTEGRATORS] = {
#define X(id, word, manual, scheme) [id] = &scheme,
    DEM_INTEGRATOR_LIST(X)
#undef X
};

const dem_collisions *const dem_hard_collisions = &dem_collisions_hard;
