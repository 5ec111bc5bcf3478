/* Analytic force models for a pile of equal close-packed disks on a flat base.
 * K. Liffman, D. Y. C. Chan and B. D. Hughes, Powder Technology 72 (1992) 255: "Liffman, Chan & Hughes 1992".
 *
 * All models share one assumption: contacts carry force along the two diagonals of the packing only, not
 * between neighbours of a row. Each disk rests on the two below it, and the pile is statically determinate. N
 * is the normal force of the ground on the pile. H is the horizontal force of the pile on the ground,
 * positive to the right, so H < 0 at the left toe. Angles are in radians; x runs from left to right.
 *
 * Functions return RP_OK, or RP_BAD_INPUT for arguments outside the stated ranges; NaN is outside every
 * range. Results are written only on success. Nothing is allocated. */
#ifndef ANALYTIC_H
#define ANALYTIC_H

#include <stddef.h>

#include "core/status.h"

RP_C_BEGIN

typedef struct {
    double N, H;
} an_force;

/* ---- Lattice, equations (37)-(44). Forces in m g.
 *
 * theta is the angle of the diagonals to the vertical: pi/6 where the disks of a row touch, up to pi/3, where
 * disks two rows apart touch. Lengths are in disk diameters sigma, so the disks of a row are 2 sin(theta)
 * apart. */

enum {
    AN_LAYERS_MAX = 1000000, /* disks in the base, closed form and counts */
    AN_RECURSION_MAX = 10000 /* disks in the base, recursion */
};

/* Base disk i = 1..k, from the left, of the full triangle of k layers: equations (42), (43), and (44) at
 * theta = pi/6. k in 1..AN_LAYERS_MAX, theta in [pi/6, pi/3]. */
rp_status an_lattice_triangle(long k, double theta, long i, an_force *force);

/* A stepped outline is given by up[0..k-1]: the number of disks, the base disk included, on the diagonal that
 * rises to the right from each of the k base disks. Disk j of diagonal s rests on disks j-1 of diagonals s
 * and s+1, so up[s] >= 1, up[s] <= up[s+1] + 1 and up[k-1] = 1: any pile in which each disk has both
 * supports, with any number of peaks. */

/* The pile with k base disks whose two flanks are cut out of the lattice at the angle alpha: the disk at
 * height h stays if it is at least h cot(alpha) (to a tie tolerance of 1e-9) inside the outermost base disks.
 * The paper states no rule; this one gives the published 1035, 360 and 5490 disks.
 * k in 1..AN_LAYERS_MAX, alpha in (0, pi/2 - theta]; the upper end is the full triangle. */
rp_status an_lattice_cut(long k, double theta, double alpha, long up[]);

/* Forces on all k base disks under a stepped outline, in closed form:
 * N = (n_ul + n_ur)/2, H = tan(theta) (n_ul - n_ur)/2 where n_ul and n_ur are the numbers of disks on the
 * diagonals that rise to the left and to the right. k in 1..AN_LAYERS_MAX. */
rp_status an_lattice_counts(long k, const long up[], double theta, an_force force[]);

/* The same forces, by solving (37), (38) disk by disk from the top. k in 1..AN_RECURSION_MAX; k^2 steps at
 * most. */
rp_status an_lattice_recursion(long k, const long up[], double theta, an_force force[]);

/* Base length B, in sigma, of the triangle with slopes alpha that weighs as much as `disks` disks. With it,
 * and x/B = 1/2 + (i - (k+1)/2) 2 sin(theta)/B, the mean of N/(chi g B) over a cut pile agrees with the
 * continuum to order 1/k^2; B = k diameters leaves a deviation of order 1/k that changes sign with alpha. */
double an_lattice_base(double disks, double theta, double alpha);

/* ---- Continuum, equations (49)-(59): triangular outline, slopes alpha in (0, pi/3).
 * Lengths in B, forces in chi g B, where chi is the mass per length of a diagonal: m/sigma by (60). */

/* Forces at x in [0, 1]. (The text before (49) says theta = pi/3 where its formulas have pi/6.) */
rp_status an_continuum(double alpha, double x, an_force *force);

/* x_c: N and H change slope at x_c and 1 - x_c. */
rp_status an_continuum_kink(double alpha, double *x_c);

/* ---- Profiles: the continuum under any polygonal outline, by (52), (53) with numerical chords. */

typedef struct {
    double x, y;
} an_point;

typedef struct {
    size_t n;
    const an_point *v; /* borrowed */
} an_profile;

/* An outline of n >= 3 vertices from left to right, in any unit of length: x increasing, y >= 0 with y = 0 at
 * both ends, all slopes less steep than 60 degrees, so that each diagonal leaves the pile once. */
rp_status an_profile_set(an_profile *profile, const an_point *v, size_t n);

/* At x in [v[0].x, v[n-1].x]: the lengths of the diagonals that rise from the base to the left (l[0], the
 * paper's l_1) and to the right (l[1]), and the height of the outline; in the unit of the vertices. */
rp_status an_profile_chords(const an_profile *profile, double x, double l[2]);
rp_status an_profile_height(const an_profile *profile, double x, double *y);

/* Forces at x, in chi g B with B = v[n-1].x - v[0].x. Relative error about 1e-16/(60 degrees - slope). */
rp_status an_profile_force(const an_profile *profile, double x, an_force *force);

/* The largest N, in chi g B, and its first position in the unit of the vertices. N is piecewise linear in x,
 * with kinks where a ray ends on a vertex; its maximum is at such a kink. */
rp_status an_profile_largest(const an_profile *profile, double *x, double *N);

/* The tent of Fig. 18 as an outline with B = 1: slope alpha_1 from each edge to x_1, alpha_2 from there to
 * the middle. Angles in (0, pi/3), x_1 in (0, 1/2). */
rp_status an_tent(double alpha_1, double alpha_2, double x_1, an_point v[5]);

RP_C_END

#endif
