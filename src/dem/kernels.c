/* Instances of the pair loop, one for each law and feature, from one list. */
#include <math.h>
#include <string.h>

#include "dem/law_normal.h"
#include "dem/law_shear.h"
#include "dem/sim.h"

#include "dem/contact.inl"

/* name, normal law, tangential law, slip, tension */
#define KERNELS(X)                                                                                           \
    X(hertz_none_pull, DEM_HERTZ, DEM_NONE, DEM_TRUNCATED, true)                                             \
    X(hertz_none_push, DEM_HERTZ, DEM_NONE, DEM_TRUNCATED, false)                                            \
    X(hertz_truncated_pull, DEM_HERTZ, DEM_SPRING, DEM_TRUNCATED, true)                                      \
    X(hertz_truncated_push, DEM_HERTZ, DEM_SPRING, DEM_TRUNCATED, false)                                     \
    X(hertz_total_pull, DEM_HERTZ, DEM_SPRING, DEM_TOTAL, true)                                              \
    X(hertz_total_push, DEM_HERTZ, DEM_SPRING, DEM_TOTAL, false)                                             \
    X(linear_none_pull, DEM_LINEAR, DEM_NONE, DEM_TRUNCATED, true)                                           \
    X(linear_none_push, DEM_LINEAR, DEM_NONE, DEM_TRUNCATED, false)                                          \
    X(linear_truncated_pull, DEM_LINEAR, DEM_SPRING, DEM_TRUNCATED, true)                                    \
    X(linear_truncated_push, DEM_LINEAR, DEM_SPRING, DEM_TRUNCATED, false)                                   \
    X(linear_total_pull, DEM_LINEAR, DEM_SPRING, DEM_TOTAL, true)                                            \
    X(linear_total_push, DEM_LINEAR, DEM_SPRING, DEM_TOTAL, false)

#define X(name, normal, tangential, slip, tension)                                                           \
    static void kernel_##name(dem_sim *sim, double h)                                                        \
    {                                                                                                        \
        pair_loop(sim, h, normal, tangential, slip, tension);                                                \
    }
KERNELS(X)
#undef X

static void kernel_reference(dem_sim *sim, double h)
{
    pair_loop(sim, h, sim->def.normal, sim->def.tangential, sim->def.slip, sim->def.tension);
}

bool dem_kernel_runs(int kernel)
{
    switch (kernel) {
#ifdef __x86_64__
    case DEM_AVX512:
        return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
               __builtin_cpu_supports("avx512vl");
    case DEM_AVX2: return __builtin_cpu_supports("avx2");
#else
    case DEM_AVX512:
    case DEM_AVX2: return false;
#endif
    default: return true;
    }
}

/* Put the widest instances that the definition allows and the processor can run in place of the baseline. */
static void choose_wide(dem_sim *sim)
{
#ifdef __x86_64__
    int kernel = sim->def.kernel;
    if (kernel == DEM_FAST) kernel = dem_kernel_runs(DEM_AVX512) ? DEM_AVX512 : DEM_AVX2;
    if (kernel == DEM_AVX512 && dem_kernel_runs(kernel)) dem_kernel_choose_avx512(sim);
    if (kernel == DEM_AVX2 && dem_kernel_runs(kernel)) dem_kernel_choose_avx2(sim);
#else
    (void)sim;
#endif
}

void dem_kernel_choose(dem_sim *sim)
{
    static const struct {
        const char *name;
        dem_kernel *kernel;
        int normal, tangential, slip;
        bool tension;
    } list[] = {
#define X(name, normal, tangential, slip, tension) {#name, kernel_##name, normal, tangential, slip, tension},
        KERNELS(X)
#undef X
    };
    const dem_definition *def = &sim->def;
    sim->kernel = kernel_reference;
    sim->kernel_name = "reference";
    for (size_t i = 0; i < sizeof list / sizeof *list && def->kernel != DEM_REFERENCE; i++)
        if (list[i].normal == def->normal && list[i].tangential == def->tangential &&
            (def->tangential == DEM_NONE || list[i].slip == def->slip) && list[i].tension == def->tension) {
            sim->kernel = list[i].kernel;
            sim->kernel_name = list[i].name;
            choose_wide(sim);
            return;
        }
}
