/* The choice of the instances of the pair loop and of other loops. */
#include <stdio.h>
#include <string.h>

#include "dem/law/law.h"
#include "dem/state/state.h"

#include "dem/loops/contact.inl"

#include "dem/loops/instances.inl"

static void kernel_baseline(dem_sim *sim, size_t from, size_t to, double h)
{
    run_instance(sim, from, to, h);
}

static void kernel_reference(dem_sim *sim, size_t from, size_t to, double h)
{
    pair_loop(sim, from, to, h, dem_laws_of(&sim->def, &sim->def.material, sim->mu), sim->def.rotation,
              sim->pairs.rolling);
}

/* Each pair is written; those within the cutoffs are kept, without a branch. */
void dem_append_pairs(dem_sim *sim, size_t i, size_t from, size_t to)
{
    const dem_vec x = sim->grains.listed_x[i];
    const double own = sim->grains.cutoff[i], inverse_mass = sim->grains.inverse_mass[i];
    uint32_t *restrict pair_i = sim->pairs.i, *restrict pair_j = sim->pairs.j;
    size_t k = sim->pairs.n;
    for (size_t j = from; j < to; j++) {
        dem_vec d = x - sim->grains.listed_x[j];
        const double cutoff = own + sim->grains.cutoff[j];
        pair_i[k] = (uint32_t)i;
        pair_j[k] = (uint32_t)j;
        /* not where both are fixed */
        k += (dem_dot(d, d) < cutoff * cutoff) & (inverse_mass + sim->grains.inverse_mass[j] > 0.0);
    }
    sim->pairs.n = k;
}

bool dem_kernel_runs(dem_kernel_choice kernel)
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
    case DEM_FAST:
    case DEM_REFERENCE:
    case DEM_BASELINE: return true;
    case DEM_KERNELS: break;
    }
    return false;
}

/* Only the reference adds excess displacements to springs. */
void dem_kernels_choose(dem_sim *sim)
{
    const dem_definition *def = &sim->def;
    const char *with = "baseline";
    const bool excess = sim->scheme->excess && dem_has_spring(def->tangential);
    sim->kernels.pairs = excess || def->kernel == DEM_REFERENCE ? kernel_reference : kernel_baseline;
    if (sim->kernels.pairs == kernel_reference) {
        strcpy(sim->kernels.name, "reference");
        return;
    }
#ifdef __x86_64__
    const bool fast = def->kernel == DEM_FAST;
#define X(name, type) sim->kernels.name = dem_##name##_avx512;
    if (def->kernel == DEM_AVX512 || (fast && dem_kernel_runs(DEM_AVX512))) {
        with = "avx512";
        DEM_KERNEL_LIST(X)
    }
#undef X
#define X(name, type) sim->kernels.name = dem_##name##_avx2;
    else if (def->kernel == DEM_AVX2 || (fast && dem_kernel_runs(DEM_AVX2))) {
        with = "avx2";
        DEM_KERNEL_LIST(X)
    }
#undef X
#endif
    snprintf(sim->kernels.name, sizeof sim->kernels.name, "%s_%s", dem_normal_descriptors[def->normal].name,
             with);
}
