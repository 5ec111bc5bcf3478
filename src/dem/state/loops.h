/* Loops over pairs, wall slots and grains, each written once for several widths: loops/loops.inl. */
#ifndef DEM_LOOPS_H
#define DEM_LOOPS_H

#include "dem/dem.h"
#include "dem/state/vec.h"

/* A step may leave these to do: rebuild the neighbour list, since a grain has moved beyond its margin or a
 * number is not finite; take out grains that left. */
enum { DEM_LIST_OUT = 1, DEM_GRAIN_OUT = 2 };

/* What loops over grains have seen so far: that; largest square of a speed, INFINITY for NaN; of a margin; of
 * a displacement less that of the margin. */
typedef struct {
    unsigned left;
    double speed2, margin2, beyond;
} dem_moved;

/* Up to so many grains that have collided in a step are found in the list of pairs by their indices. */
enum { DEM_FEW = 4 };

/* Arrays of grains, and of pairs, have up to 7 entries behind the last one that these read or write. */
typedef struct {
    const char *word;
    bool general;  /* laws known at run time alone, and no short cut: grains do not run ahead */
    char name[40]; /* in a simulation: that, after the name of its normal law */

    /* Add the forces of the pairs from..to: the first a multiple of 64, the second too or the number of
     * pairs. All, in turn. */
    void (*pairs)(dem_sim *sim, size_t from, size_t to, double h);
    /* Add the forces of slots k..end of one wall, a whole line at rest, not the ground. */
    void (*line)(dem_sim *sim, size_t k, size_t end, double h);
    /* Both where kinds have coefficients of their own. */
    void (*mixed_pairs)(dem_sim *sim, size_t from, size_t to, double h);
    void (*mixed_line)(dem_sim *sim, size_t k, size_t end, double h);

    /* Verlet: advance the grains from..to by a step and clear their forces. In a pile with chunks, margins
     * are not looked at, and speed2 is found. */
    void (*advance)(dem_sim *sim, size_t from, size_t to, dem_moved *moved);
    /* Look at the margins of the grains from..to. */
    void (*margins)(const dem_sim *sim, size_t from, size_t to, dem_moved *moved);
    /* Hard collisions: where the coming step takes the grains from..to without one, as if none were fixed. */
    void (*predict)(dem_sim *sim, size_t from, size_t to, dem_moved *moved);

    /* Neighbour list: append the pairs of grain i with grains from..to that are nearer than their cutoffs. */
    void (*append)(dem_sim *sim, size_t i, size_t from, size_t to);
    /* Hard collisions: the first pair from k on that may touch in the coming step and is apart before, or
     * `end`; the first that may touch and has a grain that has collided in this step. */
    size_t (*next_approaching)(const dem_sim *sim, size_t k, size_t end);
    size_t (*next_collided)(const dem_sim *sim, size_t k, size_t end);
} dem_loops;

/* By one; with laws known at run time alone, and displacements in excess of v dt; by four and eight, where
 * processors have the instructions. */
extern const dem_loops dem_loops_1, dem_loops_reference, dem_loops_4, dem_loops_8;

/* Choose the loops of the definition. */
void dem_loops_choose(dem_sim *sim);

#endif
