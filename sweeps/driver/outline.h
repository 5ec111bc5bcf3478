/* Close-packed piles of disks on a flat base, as the static solver takes them (statics/equilibrium.h), with
 * what diagonal contacts alone would carry in them. Lengths in sigma, forces in m g, angles in radians.
 * Liffman, Chan & Hughes 1992. */
#ifndef SWEEP_OUTLINE_H
#define SWEEP_OUTLINE_H

#include <stddef.h>

#include "analytic/analytic.h"
#include "statics/equilibrium.h"
#include "stress/stress.h"

typedef struct {
    size_t n, k; /* disks; in the base */
    statics_disk *disks;
    an_force *exact; /* [k] by diagonals alone, of equal disks; NULL if not known */
    double B;        /* base of the same outline and the same weight; NAN if not known */
} sweep_outline;

/* k disks in the base and slopes alpha on both sides, by an_lattice_cut; alpha <= 0 is the full triangle. The
 * disks of a row are `gap` apart, those of the diagonals touch. Errors: RP_BAD_INPUT, RP_NO_MEMORY. Free the
 * outline, which is zero at first, also after an error. */
rp_status sweep_outline_slope(sweep_outline *outline, long k, double gap, double alpha);

/* The same for an outline of n vertices from left to right (an_profile_set), which the base is scaled to. */
rp_status sweep_outline_polygon(sweep_outline *outline, long k, double gap, const an_point *v, size_t n);

void sweep_outline_free(sweep_outline *outline);

/* Unequal disks at the same positions: radii (1 + S z)/2 with z normal, cut at +-3, from the stream (seed,
 * run, RP_PURPOSE_RADII); weights as r^2. Disks of the base stay as they are: wells would hold the squeeze
 * between unequal ones for ever. S in [0, 0.1]. Errors: RP_NO_MEMORY. */
rp_status sweep_outline_disorder(sweep_outline *outline, double S, unsigned long seed, unsigned long run);

/* How far N and H on the base are from diagonals alone. */
typedef struct {
    double N_rms, N_max; /* relative deviation of N */
    double H_ratio;      /* largest H over that of diagonals alone */
    double thrust_ratio; /* sum of H outwards, both halves, over that of diagonals alone */
} sweep_outline_error;
sweep_outline_error sweep_outline_compare(const sweep_outline *outline, const double N[], const double H[]);

/* Profile of the loads N of k disks of the base at x, each even over its disk, for stress_dip.
 * Errors: those of stress_base_profile; RP_NO_MEMORY. */
rp_status sweep_outline_base(size_t k, const double x[], const double N[], stress_base *base);

/* Profile of the continuum triangle of slope alpha, eqs (50), (54), over the base that holds 98 % of its
 * load. alpha in (0, pi/3). Errors: those of an_continuum and stress_base_profile. */
rp_status sweep_outline_triangle(double alpha, double N[STRESS_DIP_BINS]);

/* N of the middle of the base, of the two there if k is even, over the largest. */
double sweep_outline_centre(size_t k, const double N[]);

/* Friction that the base must have at least: largest |H|/N of its disks. INFINITY for a disk that
 * carries H but no N. */
double sweep_outline_friction(size_t k, const double N[], const double H[]);

#endif
