/* A lattice pile on wells of friction, solved for, and the same pile as a scene that can come to rest.
 * Lengths in diameters, masses in those of a disk, g = 1. */
#ifndef HEAP_H
#define HEAP_H

#include "dem/dem.h"
#include "statics/equilibrium.h"

typedef struct {
    size_t n, k; /* disks; in the base */
    double eps;
    dem_grain *grains;  /* so deep in the ground that the base has its wells from the start */
    statics_pile *pile; /* at its equilibrium */
    statics_result result;
    double *N, *H, *u;
} heap;

/* Slopes of alpha; the equilibrium is reached in `load_steps`. No well is broken, and it is stable, or the
 * test fails. */
heap heap_solved(long k, double alpha_deg, double eps, long load_steps);
void heap_free(heap *h);

/* Its grains without weight; gamma and 1/dt in units of sqrt(K_s/m). */
dem_definition heap_scene(const heap *h, int integrator, double gamma, double dt);

/* Raise the weight to g in twenty steps, over `steps` of time. */
void heap_load(dem_sim *sim, long steps);

#endif
