/* The choice of the loops' width. */
#include <stdio.h>
#include <string.h>

#include "dem/state/state.h"

static const dem_loops *const loops_of[DEM_KERNELS] = {
    [DEM_REFERENCE] = &dem_loops_reference,
    [DEM_BASELINE] = &dem_loops_1,
#ifdef __x86_64__
    [DEM_AVX2] = &dem_loops_4,
    [DEM_AVX512] = &dem_loops_8,
#endif
};

bool dem_kernel_runs(dem_kernel_choice kernel)
{
#ifdef __x86_64__
    if (kernel == DEM_AVX512)
        return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
               __builtin_cpu_supports("avx512vl");
    if (kernel == DEM_AVX2) return __builtin_cpu_supports("avx2");
#endif
    return kernel == DEM_FAST || loops_of[kernel];
}

void dem_loops_choose(dem_sim *sim)
{
    dem_kernel_choice kernel = sim->def.kernel;
    if (kernel == DEM_FAST)
        for (kernel = DEM_KERNELS - 1; !dem_kernel_runs(kernel);) kernel--;
    if (sim->scheme->excess && dem_has_spring(sim->def.tangential)) kernel = DEM_REFERENCE;
    sim->loops = *loops_of[kernel];
    if (sim->def.pairs) sim->loops.pairs = sim->loops.mixed_pairs, sim->loops.line = sim->loops.mixed_line;
    if (sim->loops.general)
        strcpy(sim->loops.name, sim->loops.word);
    else
        snprintf(sim->loops.name, sizeof sim->loops.name, "%s_%s",
                 dem_normal_descriptors[sim->def.normal].name, sim->loops.word);
}
