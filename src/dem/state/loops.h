/* Loops over pairs, wall slots and grains that have instances for wider instructions. */
#ifndef DEM_KERNELS_H
#define DEM_KERNELS_H

#include "dem/dem.h"
#include "dem/state/vec.h"

/* A step may leave these to do: rebuild the neighbour list, since a grain has moved beyond its margin or a
 * number is not finite; take out grains that left. */
enum { DEM_LIST_OUT = 1, DEM_GRAIN_OUT = 2 };

/* Add the forces of the pairs from..to: the first a multiple of 64, the second too or the number of pairs.
 * All, in turn. */
typedef void dem_pair_kernel(struct dem_sim *sim, size_t from, size_t to, double h);
/* Add the forces of slots k..end of one wall, a whole line at rest, not the ground. */
typedef void dem_line_kernel(struct dem_sim *sim, size_t k, size_t end, double h);

/* Verlet: advance as many as it can of the grains from..to, returns up to where; *left as of dem_step_lists.
 * With speed2 not NULL, margins are not looked at, and *speed2, 0 before, becomes the square of the largest
 * speed, INFINITY for NaN. */
typedef size_t dem_advance_kernel(struct dem_sim *sim, size_t from, size_t to, unsigned *left,
                                  double *speed2);
/* Have as many as it can of the grains from..to moved beyond their margins? Returns up to where; raises
 * *margin2 to the largest square of a margin, *beyond to the largest square of a displacement less that of
 * the margin. */
typedef size_t dem_margin_kernel(const struct dem_sim *sim, size_t from, size_t to, unsigned *left,
                                 double *margin2, double *beyond);
/* Neighbour list: append the pairs of grain i with grains from..to that are nearer than their cutoffs; reads
 * and writes up to 7 more. */
typedef void dem_append_kernel(struct dem_sim *sim, size_t i, size_t from, size_t to);
dem_append_kernel dem_append_pairs; /* where no instance is in use */

/* Hard collisions, see hard.c: predict as many grains as it can, from the first on, returns how many;
 * the next pair that approaches; the next one of grains that have collided, up to DEM_FEW. */
typedef size_t dem_predict_kernel(struct dem_sim *sim, size_t *beyond);
typedef size_t dem_approach_kernel(const struct dem_sim *sim, size_t k, size_t end);
enum { DEM_FEW = 4 };

/* Name, type. */
#define DEM_KERNEL_LIST(X)                                                                                   \
    X(pairs, dem_pair_kernel)                                                                                \
    X(line, dem_line_kernel)                                                                                 \
    X(advance, dem_advance_kernel)                                                                           \
    X(beyond_margin, dem_margin_kernel)                                                                      \
    X(append_pairs, dem_append_kernel)                                                                       \
    X(predict, dem_predict_kernel)                                                                           \
    X(next_approaching, dem_approach_kernel)                                                                 \
    X(next_collided, dem_approach_kernel)

/* The instances in use; NULL for none, save `pairs`. */
typedef struct {
    char name[40];
#define X(name, type) type *name;
    DEM_KERNEL_LIST(X)
#undef X
} dem_kernels;

/* Where processors have the instructions; the pair loop without excess displacements; kernels_wide.inl. */
#define X(name, type) type dem_##name##_avx512, dem_##name##_avx2;
DEM_KERNEL_LIST(X)
#undef X

/* Choose the kernels of the definition. */
void dem_kernels_choose(struct dem_sim *sim);

#endif
