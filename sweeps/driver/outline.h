/* Close-packed heaps of disks on a flat base, as the static solver takes them (dem/equilibrium.h), with what
 * diagonal contacts alone would carry in them. Lengths in sigma, forces in m g, angles in radians.
 * Liffman, Chan & Hughes 1992. */
#ifndef SWEEP_OUTLINE_H
#define SWEEP_OUTLINE_H

#include <stddef.h>

#include "analytic/analytic.h"
#include "statics/equilibrium.h"

typedef struct {
    size_t n, k; /* disks; in the base */
    statics_disk *disks;
    an_force *exact; /* [k] by diagonals alone, of equal disks; NULL if not known */
    double B;        /* base of the same outline and the same weight; NAN if not known */
} sweep_outline;

/* k disks in the base and slopes alpha on both sides, by an_lattice_cut; alpha <= 0 is the full triangle. The
 * disks of a row are `gap` apart, those of the diagonals touch. Errors: RP_BAD_INPUT, RP_NO_MEMORY. Free the
 * heap, which is zero at first, also after an error. */
rp_status sweep_outline_slope(sweep_outline *heap, long k, double gap, double alpha);

/* The same for an outline of n vertices from left to right (an_profile_set), which the base is scaled to. */
rp_status sweep_outline_polygon(sweep_outline *heap, long k, double gap, const an_point *v, size_t n);

void sweep_outline_free(sweep_outline *heap);

/* Unequal disks on the same places: radii (1 + S z)/2 with z normal, cut at +-3, from the stream (seed, run,
 * RP_PURPOSE_RADII); weights as r^2. Disks of the base stay as they are: wells would hold the squeeze between
 * unequal ones for ever. S in [0, 0.1]. Errors: RP_NO_MEMORY. */
rp_status sweep_outline_disorder(sweep_outline *heap, double S, unsigned long seed, unsigned long run);

/* How far N and H on the base are from diagonals alone. */
typedef struct {
    double N_rms, N_max; /* relative deviation of N */
    double H_ratio;      /* largest H over that of diagonals alone */
    double thrust_ratio; /* sum of H outwards, both halves, over that of diagonals alone */
} sweep_outline_error;
sweep_outline_error sweep_outline_compare(const sweep_outline *heap, const double N[], const double H[]);

/* The dip D = (mean N over |x - c| < 0.1 b less mean N over 0.1 b to 0.3 b on both sides)/mean N over b, of
 * the loads N of disks at x, from left to right, each taken as even over the base up to half-way to its
 * neighbours: c is their centroid, and b the part of the base that holds 98 % of them, 1 % being left out on
 * each side. A negative D is a dip; without one D is 0 only where N is flat out to 0.3 b, and positive (0.1
 * under 30 degrees, 0.25 under 20) where flanks begin within it. NAN for less than two disks. */
double sweep_outline_dip(size_t k, const double x[], const double N[]);

/* N of the middle of the base, of the two there if k is even, over the largest. */
double sweep_outline_centre(size_t k, const double N[]);

/* Friction that the base must have at least: largest |H|/N of its disks. INFINITY where one is pushed that
 * nothing presses down. */
double sweep_outline_friction(size_t k, const double N[], const double H[]);

#endif
