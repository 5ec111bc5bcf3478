/* The arrays of the grains; see grains.h. */
#include "dem/state/state.h"

#include <stdlib.h>
#include <string.h>

enum { PADDING = 8 }; /* kernels read up to 7 entries beyond the last grain */

rp_status dem_grains_reserve(const dem_sim *sim, size_t capacity, bool states, dem_grains *grains)
{
    const dem_definition *def = &sim->def;
    const dem_scheme *scheme = sim->scheme;
    const size_t n = capacity + PADDING;
    bool good = states || dem_array_grow(&grains->slack, sizeof *grains->slack, 0, n / DEM_GROUP + 1);
#define X(type, name, need, role)                                                                            \
    if ((need) && (role == DEM_STATE || !states))                                                            \
        good = good && dem_array_grow(&grains->name, sizeof(type), grains->n, n);
    DEM_GRAIN_ARRAYS(X)
#undef X
    if (!good) return rp_fail(RP_NO_MEMORY, "%zu particles: out of memory", capacity);
    grains->capacity = capacity;
    return RP_OK;
}

void dem_grains_free(dem_grains *grains)
{
    free(grains->slack);
#define X(type, name, need, role) free(grains->name);
    DEM_GRAIN_ARRAYS(X)
#undef X
}

void dem_grains_put(const dem_grains *grains, const uint32_t *to, dem_grains *sorted, size_t from, size_t end)
{
#define X(type, name, need, role)                                                                            \
    if (role == DEM_STATE && grains->name)                                                                   \
        for (size_t i = from; i < end; i++)                                                                  \
            if (to[i] != DEM_NOWHERE) sorted->name[to[i]] = grains->name[i];
    DEM_GRAIN_ARRAYS(X)
#undef X
}

void dem_grains_take(dem_grains *grains, dem_grains *sorted, size_t n)
{
#define X(type, name, need, role)                                                                            \
    if (role == DEM_STATE) {                                                                                 \
        type *const old = grains->name;                                                                      \
        grains->name = sorted->name, sorted->name = old;                                                     \
    }
    DEM_GRAIN_ARRAYS(X)
#undef X
    grains->n = n;
}

void dem_grains_clear(dem_grains *grains, size_t i)
{
#define X(type, name, need, role)                                                                            \
    if (grains->name && role != DEM_INDEX) memset(&grains->name[i], 0, sizeof(type));
    DEM_GRAIN_ARRAYS(X)
#undef X
}

void dem_grains_move(dem_grains *grains, size_t i, size_t to)
{
#define X(type, name, need, role)                                                                            \
    if (grains->name && (role == DEM_STATE || role == DEM_LISTED)) grains->name[to] = grains->name[i];
    DEM_GRAIN_ARRAYS(X)
#undef X
}
