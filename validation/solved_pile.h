/* A lattice pile on friction wells: its static solution, and the same pile as a scene for the simulator.
 * Units: diameter and mass of a disk, g = 1. */
#ifndef SOLVED_PILE_H
#define SOLVED_PILE_H

#include "dem/dem.h"
#include "statics/equilibrium.h"

typedef struct {
    size_t n, k; /* disks; in the base */
    double eps;
    dem_grain
        *grains; /* base disks overlap the ground by round-off, so that their wells exist from the start */
    statics_pile *equilibrium; /* the static solution */
    statics_result result;
    double *N, *H, *u;
} solved_pile;

/* Slopes of alpha, loaded in `load_steps`. The test fails if a well breaks or the solution is unstable. */
solved_pile solved_pile_make(long k, double alpha_deg, double eps, long load_steps);
void solved_pile_free(solved_pile *pile);

/* Scene with the grains of the pile, without weight; gamma and 1/dt in units of sqrt(K_s/m). */
dem_definition solved_pile_scene(const solved_pile *pile, int integrator, double gamma, double dt);

/* Raise gravity to g in twenty increments, over `steps` time steps. */
void solved_pile_load(dem_sim *sim, long steps);

#endif
