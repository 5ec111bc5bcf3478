/* Instances of the pair loop, one for each law and feature, from one list. */
#include <math.h>
#include <string.h>

#include "dem/integrator.h"
#include "dem/law_normal.h"
#include "dem/law_shear.h"

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
#define KERNELS(X)                                                                                           \
    FRICTIONLESS(X, hertz_none_pull, DEM_HERTZ, true)                                                        \
    FRICTIONLESS(X, hertz_none_push, DEM_HERTZ, false)                                                       \
    FRICTIONLESS(X, linear_none_pull, DEM_LINEAR, true)                                                      \
    FRICTIONLESS(X, linear_none_push, DEM_LINEAR, false)                                                     \
    PLAIN(X, hertz_truncated_pull, DEM_HERTZ, DEM_SPRING, DEM_TRUNCATED, true)                               \
    PLAIN(X, hertz_truncated_push, DEM_HERTZ, DEM_SPRING, DEM_TRUNCATED, false)                              \
    PLAIN(X, hertz_total_pull, DEM_HERTZ, DEM_SPRING, DEM_TOTAL, true)                                       \
    PLAIN(X, hertz_total_push, DEM_HERTZ, DEM_SPRING, DEM_TOTAL, false)                                      \
    PLAIN(X, linear_truncated_pull, DEM_LINEAR, DEM_SPRING, DEM_TRUNCATED, true)                             \
    PLAIN(X, linear_truncated_push, DEM_LINEAR, DEM_SPRING, DEM_TRUNCATED, false)                            \
    PLAIN(X, linear_total_pull, DEM_LINEAR, DEM_SPRING, DEM_TOTAL, true)                                     \
    PLAIN(X, linear_total_push, DEM_LINEAR, DEM_SPRING, DEM_TOTAL, false)                                    \
    INSIDE(X, hertz_inside, DEM_HERTZ)                                                                       \
    INSIDE(X, linear_inside, DEM_LINEAR)                                                                     \
    ROTATING(X, hertz_rotating, DEM_HERTZ, false)                                                            \
    ROTATING(X, linear_rotating, DEM_LINEAR, false)                                                          \
    ROTATING(X, hertz_rolling, DEM_HERTZ, true)                                                              \
    ROTATING(X, linear_rolling, DEM_LINEAR, true)                                                            \
    SLIP_ROLL(X, hertz_slip, DEM_HERTZ, false, false)                                                        \
    SLIP_ROLL(X, linear_slip, DEM_LINEAR, false, false)                                                      \
    SLIP_ROLL(X, hertz_slip_roll, DEM_HERTZ, true, false)                                                    \
    SLIP_ROLL(X, linear_slip_roll, DEM_LINEAR, true, false)                                                  \
    SLIP_ROLL(X, hertz_slip_rolling, DEM_HERTZ, true, true)                                                  \
    SLIP_ROLL(X, linear_slip_rolling, DEM_LINEAR, true, true)

#define X(name, ...)                                                                                         \
    static void kernel_##name(dem_sim *sim, size_t from, size_t to, double h)                                \
    {                                                                                                        \
        pair_loop(sim, from, to, h, __VA_ARGS__, false);                                                     \
    }
KERNELS(X)
#undef X

static void kernel_reference(dem_sim *sim, size_t from, size_t to, double h)
{
    const dem_definition *def = &sim->def;
    pair_loop(sim, from, to, h, def->normal, def->tangential, def->slip, def->tension, def->damping,
              def->rotation, sim->rolling, sim->gear != NULL);
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
    const dem_definition *def = &sim->def;
    const bool avx512 = def->kernel == DEM_AVX512 || (def->kernel == DEM_FAST && dem_kernel_runs(DEM_AVX512));
    const bool avx2 = def->kernel == DEM_AVX2 || (def->kernel == DEM_FAST && dem_kernel_runs(DEM_AVX2));
    if (!avx512 && !avx2) return;
    sim->near = avx512 ? dem_near_avx512 : dem_near_avx2;
    sim->foresee = avx512 ? dem_foresee_avx512 : dem_foresee_avx2;
    sim->closing = avx512 ? dem_closing_avx512 : dem_closing_avx2;
    sim->deflected = avx512 ? dem_deflected_avx512 : dem_deflected_avx2;
    sim->line = avx512 ? dem_line_avx512 : dem_line_avx2;
    sim->advance = avx512 ? dem_advance_avx512 : dem_advance_avx2;
    sim->stray = avx512 ? dem_stray_avx512 : dem_stray_avx2;
    sim->kernel = avx512 ? dem_kernel_avx512 : dem_kernel_avx2;
    strcat(sim->kernel_name, avx512 ? "_avx512" : "_avx2");
#else
    (void)sim;
#endif
}

void dem_kernel_choose(dem_sim *sim)
{
    const dem_definition *def = &sim->def;
    const struct {
        const char *name;
        dem_kernel *kernel;
        int normal, tangential, slip;
        bool tension;
        int damping;
        bool rotation, rolling;
    } list[] = {
#define X(name, ...) {#name, kernel_##name, __VA_ARGS__},
        KERNELS(X)
#undef X
    };
    sim->kernel = kernel_reference;
    strcpy(sim->kernel_name, "reference");
    if (sim->scheme->excess && def->tangential == DEM_SPRING) return; /* only the reference knows of it */
    for (size_t i = 0; i < sizeof list / sizeof *list && def->kernel != DEM_REFERENCE; i++)
        if (list[i].normal == def->normal && list[i].tangential == def->tangential &&
            list[i].slip == def->slip && list[i].tension == def->tension && list[i].damping == def->damping &&
            list[i].rotation == def->rotation && list[i].rolling == sim->rolling) {
            sim->kernel = list[i].kernel;
            strcpy(sim->kernel_name, list[i].name);
            choose_wide(sim);
            return;
        }
}
