/* Instances of the pair loop, one for each law and feature, from one list. */
#include <math.h>
#include <string.h>

#include "dem/integrator.h"
#include "dem/law.h"
#include "dem/sim.h"

#include "dem/contact.inl"

/* name, normal law, tangential law, slip, tension, damping, rotation, rolling. What an instance need not
 * know, or rarely meets, it reads from the definition. */
#define AS_IT_IS(field) sim->def.field
#define PLAIN(X, name, normal, tangential, slip, tension)                                                    \
    X(name, normal, tangential, slip, tension, DEM_DAMPING_OUTSIDE, false, false)
#define FRICTIONLESS(X, name, normal, tension)                                                               \
    X(name, normal, DEM_NONE, AS_IT_IS(slip), tension, AS_IT_IS(damping), AS_IT_IS(rotation), false)
#define INSIDE(X, name, normal)                                                                              \
    X(name, normal, DEM_SPRING, AS_IT_IS(slip), AS_IT_IS(tension), DEM_DAMPING_INSIDE, false, false)
#define ROTATING(X, name, normal, rolling)                                                                   \
    X(name, normal, DEM_SPRING, AS_IT_IS(slip), AS_IT_IS(tension), AS_IT_IS(damping), true, rolling)
#define SLIP_ROLL(X, name, normal, rotation, rolling)                                                        \
    X(name, normal, DEM_SLIP_ROLL, AS_IT_IS(slip), AS_IT_IS(tension), AS_IT_IS(damping), rotation, rolling)
#define OF_LAW(id, word, ...)                                                                                \
    FRICTIONLESS(X, word##_none_pull, id, true)                                                              \
    FRICTIONLESS(X, word##_none_push, id, false)                                                             \
    PLAIN(X, word##_truncated_pull, id, DEM_SPRING, DEM_TRUNCATED, true)                                     \
    PLAIN(X, word##_truncated_push, id, DEM_SPRING, DEM_TRUNCATED, false)                                    \
    PLAIN(X, word##_total_pull, id, DEM_SPRING, DEM_TOTAL, true)                                             \
    PLAIN(X, word##_total_push, id, DEM_SPRING, DEM_TOTAL, false)                                            \
    INSIDE(X, word##_inside, id)                                                                             \
    ROTATING(X, word##_rotating, id, false)                                                                  \
    ROTATING(X, word##_rolling, id, true)                                                                    \
    SLIP_ROLL(X, word##_slip, id, false, false)                                                              \
    SLIP_ROLL(X, word##_slip_roll, id, true, false)                                                          \
    SLIP_ROLL(X, word##_slip_rolling, id, true, true)
#define KERNELS DEM_NORMAL_LAWS(OF_LAW)

#define X(name, ...)                                                                                         \
    static void kernel_##name(dem_sim *sim, size_t from, size_t to, double h)                                \
    {                                                                                                        \
        pair_loop(sim, from, to, h, __VA_ARGS__, false);                                                     \
    }
KERNELS
#undef X

static void kernel_reference(dem_sim *sim, size_t from, size_t to, double h)
{
    const dem_definition *def = &sim->def;
    pair_loop(sim, from, to, h, def->normal, def->tangential, def->slip, def->tension, def->damping,
              def->rotation, sim->pairs.rolling, sim->grains.excess != NULL);
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

/* Put the widest instances that the definition allows and the processor can run in place of the baseline. */
static void choose_wide(dem_sim *sim)
{
#ifdef __x86_64__
    const dem_definition *def = &sim->def;
    const bool avx512 = def->kernel == DEM_AVX512 || (def->kernel == DEM_FAST && dem_kernel_runs(DEM_AVX512));
    const bool avx2 = def->kernel == DEM_AVX2 || (def->kernel == DEM_FAST && dem_kernel_runs(DEM_AVX2));
    if (!avx512 && !avx2) return;
#define X(name, type) sim->kernels.name = avx512 ? dem_##name##_avx512 : dem_##name##_avx2;
    DEM_KERNEL_LIST(X)
#undef X
    strcat(sim->kernels.name, avx512 ? "_avx512" : "_avx2");
#else
    (void)sim;
#endif
}

void dem_kernels_choose(dem_sim *sim)
{
    const dem_definition *def = &sim->def;
    const struct {
        const char *name;
        dem_pair_kernel *kernel;
        dem_normal_law normal;
        dem_tangential_law tangential;
        dem_slip slip;
        bool tension;
        dem_damping damping;
        bool rotation, rolling;
    } list[] = {
#define X(name, ...) {#name, kernel_##name, __VA_ARGS__},
        KERNELS
#undef X
    };
    sim->kernels.pairs = kernel_reference;
    strcpy(sim->kernels.name, "reference");
    if (sim->scheme->excess && dem_has_spring(def->tangential)) return; /* only the reference knows of it */
    for (size_t i = 0; i < sizeof list / sizeof *list && def->kernel != DEM_REFERENCE; i++)
        if (list[i].normal == def->normal && list[i].tangential == def->tangential &&
            list[i].slip == def->slip && list[i].tension == def->tension && list[i].damping == def->damping &&
            list[i].rotation == def->rotation && list[i].rolling == sim->pairs.rolling) {
            sim->kernels.pairs = list[i].kernel;
            strcpy(sim->kernels.name, list[i].name);
            choose_wide(sim);
            return;
        }
}
