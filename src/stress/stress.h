/* Stress in a pile from its contact forces, and the pressure on its base. */
#ifndef STRESS_STRESS_H
#define STRESS_STRESS_H

#include <stdbool.h>
#include <stddef.h>

#include "core/status.h"
#include "stats/stats.h"

RP_C_BEGIN

/* The force (fx, fy) on a grain with centre (x, y), by a grain with centre (x_b, y_b) or at that point of a
 * wall. */
typedef struct {
    double x, y, x_b, y_b, fx, fy;
} stress_contact;

/* s_ab, compression positive; the force that the side of a plane to which its normal n points puts on the
 * other is -s_ab n_b. Grains that cannot turn need no balance of torques: xy and yx differ. */
typedef struct {
    double xx, xy, yx, yy;
} stress_tensor;

void stress_tensor_add(stress_tensor *sum, const stress_tensor *s, double factor);

/* nx times ny cells of width dx and height dy, from (x0, y0); cell (i, j) has number j nx + i. */
typedef struct {
    double x0, y0, dx, dy;
    size_t nx, ny;
} stress_grid;

/* Mean stress of each cell, force/length: the sum over contacts of force times branch, as far as the branch
 * lies in the cell, over the cell's area (Goldhirsch 2010 with the cell as the kernel; branches end at
 * walls). Summed over cells that hold all branches, area times stress is the sum of force times branch.
 * Errors: RP_BAD_INPUT (a grid without cells, a number that is not finite). */
rp_status stress_cells(size_t n, const stress_contact contacts[], const stress_grid *grid,
                       stress_tensor stress[]);

/* Mohr's circle of a stress. */
typedef struct {
    double pressure;  /* its centre: mean of the principal stresses of the symmetric part */
    double shear;     /* its radius */
    double couple;    /* (xy - yx)/2, which shifts it: traction without torque balance */
    double direction; /* of the largest compression, from x, in (-pi/2, pi/2] */
    double mobilised; /* greatest angle between traction and normal over all planes, see stress.c; pi/2 where
                         a plane pulls, NaN without stress */
} stress_circle;
stress_circle stress_mohr(const stress_tensor *stress);

/* ---- ensembles of piles (piles.c) ---- */

/* A pile at rest. Lengths, masses and forces in one system of units. */
typedef struct {
    size_t n, n_grains;
    stress_contact *contacts; /* n of them */
    bool *floor, *wall;       /* of each: is it with the floor, is it with a wall? */
    double *x, *y, *m;        /* of the grains: centres, masses */
    double ground;            /* y from which heights count */
} stress_pile;

/* Square cells, round(width/cell) of them to a box 0 < x < width, from the lowest ground up to the highest
 * grain. */
stress_grid stress_grid_over(size_t n, const stress_pile piles[], double width, double cell);

/* Mean of stress_cells over n piles. Errors: those of stress_cells; RP_NO_MEMORY. */
rp_status stress_mean_cells(size_t n, const stress_pile piles[], const stress_grid *grid,
                            stress_tensor mean[]);

/* Force/length in a column of width `size`, mean over piles without tilt. */
typedef struct {
    stats_summary n, h; /* forces of the pile on the floor; h away from the wall at x = 0 */
    double weight;      /* of the grains in the column */
    double through;     /* vertical force on it through its sides */
    double imbalance;   /* n - weight - through: 0 at rest */
} stress_floor;

/* Number of columns from x = 0 to beyond the last grain; *size: width/round(width/cell). */
size_t stress_floor_cells(size_t n, const stress_pile piles[], double width, double cell, double *size);

/* The columns' forces at gravity g. Errors: those of stats_mean; RP_NO_MEMORY. */
rp_status stress_floor_forces(size_t n, const stress_pile piles[], double size, double g, size_t cells,
                              stress_floor forces[]);

/* Forces that rays of inclination phi put on the floor of a wedge of this slope (Lee & Herrmann 1993, section
 * 6), where the column above weighs `weight`: n = weight/(1 - t^2/k) and h = n t/k, t = tan slope, k = tan^2
 * phi. NaN for a slope of phi or more, where no ray leaves through the flank. Angles in rad. */
void stress_wedge(double weight, double slope, double phi, double *n, double *h);

/* ---- pressure on the base of piles, and whether it dips in the middle (dip.c) ---- */

/* Bins of the base: 20 of 0.05 B about the centroid of the load; B is the width about it that holds 98 % of
 * the load. */
enum { STRESS_DIP_BINS = 20 };
/* Their numbers, left to right, as in the names of columns: n_01 to n_20. */
#define STRESS_DIP_BIN_LIST(X)                                                                               \
    X(01)                                                                                                    \
    X(02)                                                                                                    \
    X(03)                                                                                                    \
    X(04) X(05) X(06) X(07) X(08) X(09) X(10) X(11) X(12) X(13) X(14) X(15) X(16) X(17) X(18) X(19) X(20)
typedef struct {
    double centroid, width;    /* of the load; B, lengths of x */
    double N[STRESS_DIP_BINS]; /* pressure in each bin over the mean over the bins */
} stress_base;

/* The profile under one pile, from n contacts with its base: positions, half-widths that a contact's force is
 * spread over evenly (a disk's radius), forces. Errors: RP_NO_RESULT (no load), RP_NO_MEMORY. */
rp_status stress_base_profile(size_t n, const double x[], const double r[], const double N[],
                              stress_base *base);

/* Profile of other loads on the same base: in its bins, over their mean. NaN without load in the bins. */
void stress_base_bins(const stress_base *base, size_t n, const double x[], const double r[], const double N[],
                      double bins[STRESS_DIP_BINS]);

/* D: (mean N where |x - c| < 0.1 B, less that where 0.1 B < |x - c| < 0.3 B) over the mean N. It describes a
 * profile and is no test of a dip, since the outer part reaches down the flanks. */
double stress_dip(const double N[STRESS_DIP_BINS]);

/* Two statistics of a dip; both are negative for one. The middle against its neighbours: mean N where |x - c|
 * < 0.1 B, less that where 0.1 B < |x - c| < 0.2 B, over the mean N. The excess: mean where |x - c| < 0.1 B
 * of N less `rays`, over the mean N; rays is the profile of 60-degree rays under the pile's own outline. */
double stress_middle(const double N[STRESS_DIP_BINS]);
double stress_excess(const double N[STRESS_DIP_BINS], const double rays[STRESS_DIP_BINS]);

/* An ensemble of piles: does the middle dip? Bin k of N lies from k to k + 1 times 0.05 B from the centroid,
 * both sides together. */
typedef struct {
    stats_summary middle, excess; /* pile by pile */
    double p_value;               /* of the mean middle: chance of one as far from 0, by Student's t */
    double p_margin;              /* TOST: largest chance of so small a |mean middle| if it were the margin */
    double below, below_se;       /* share of the piles with middle < 0 */
    double N[STRESS_DIP_BINS / 2], N_se[STRESS_DIP_BINS / 2]; /* mean profile */
} stress_dips;

/* From n profiles one after the other, STRESS_DIP_BINS each, and the excess of each pile. Errors:
 * RP_BAD_INPUT (margin, a number), RP_NO_RESULT (fewer than three piles), RP_NO_MEMORY. */
rp_status stress_dip_ensemble(size_t n, const double profiles[], const double excess[], double margin,
                              stress_dips *dips);

/* Of the middle: dip or peak if p_value < level; none_within_margin if p_margin < level; dip_within_margin or
 * peak_within_margin if both; undecided. */
const char *stress_dip_word(const stress_dips *dips, double level);

RP_C_END

#endif
