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
        pair_loop(sim, h, normal, tangential, slip, tension, false);                                         \
    }
KERNELS(X)
#undef X

static void kernel_reference(dem_sim *sim, double h)
{
    pair_loop(sim, h, sim->def.normal, sim->def.tangential, sim->def.slip, sim->def.tension,
              sim->gear != NULL);
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
    if (def->integrator == DEM_GEAR5 && def->tangential == DEM_SPRING) return; /* it has no instances */
    for (size_t i = 0; i < sizeof list / sizeof *list && !def->reference_kernel; i++)
        if (list[i].normal == def->normal && list[i].tangential == def->tangential &&
            (def->tangential == DEM_NONE || list[i].slip == def->slip) && list[i].tension == def->tension) {
            sim->kernel = list[i].kernel;
            sim->kernel_name = list[i].name;
            return;
        }
}
