/* Descriptors of the normal laws, from their rows. */
#include "dem/laws.h"
#include "dem/law.h"

const dem_normal_descriptor dem_normal_descriptors[DEM_NORMAL_N] = {
#define X(id, word, spring, dashpot, k_n, gamma_n, ...)                                                      \
    [id] = {.name = #word,                                                                                   \
            .k_n_unit = k_n,                                                                                 \
            .gamma_n_unit = gamma_n,                                                                         \
            .stiffness = spring##_stiffness,                                                                 \
            .potential = spring##_potential,                                                                 \
            .impact_overlap = spring##_impact_overlap,                                                       \
            .rest_overlap = spring##_rest_overlap,                                                           \
            .damping_rate = dashpot##_rate,                                                                  \
            __VA_ARGS__},
    DEM_NORMAL_LAWS(X)
#undef X
};
