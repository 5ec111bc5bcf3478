/* The list of the integrators. */
#include "dem/state/method.h"

const dem_scheme *const dem_schemes[DEM_INTEGRATORS] = {
#define X(name, word, text) [name] = &dem_scheme_##word,
    DEM_INTEGRATOR_LIST(X)
#undef X
};
