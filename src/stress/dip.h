/* Mean pressure on the base of piles, and whether it dips in the middle. */
#ifndef STRESS_DIP_H
#define STRESS_DIP_H

#include <gsl/gsl_rng.h>
#include <stddef.h>

#include "stats/stats.h"

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

/* (Mean N where |x - c| < 0.1 B, less that where 0.1 B < |x - c| < 0.3 B) over the mean N; below 0 is a dip.
 */
double stress_dip(const double N[STRESS_DIP_BINS]);

/* D of an ensemble of piles. */
typedef struct {
    double raw;                    /* mean D of the profiles */
    stats_summary dip;             /* pile by pile: D, or its excess over that of the profile without dip */
    double null_lo, null_hi;       /* 95 % of the mean D of as many piles without dip */
    double p_value, p_dip;         /* chance of a mean D as far from 0, and as low, without dip */
    double p_margin;               /* TOST: largest chance of so small a |mean D| if it were the margin */
    double N[STRESS_DIP_BINS / 2]; /* mean pressure from the centroid outwards, both sides, over the mean */
    double N_se[STRESS_DIP_BINS / 2];
} stress_dips;

/* From n profiles one after the other, STRESS_DIP_BINS each, and what each pile would have without a dip
 * (NULL: a flat profile). D is linear in the profile: the excess is D of the difference about the same mean.
 * The null distribution is that of the same piles, drawn with replacement, each mirrored or not at random,
 * with their mean D taken off. Mirroring gives the mean profile two equal sides.
 * `resamples` values of `means` are work space. Errors: RP_BAD_INPUT (margin, resamples, a number),
 * RP_NO_RESULT (fewer than three piles), RP_NO_MEMORY. */
rp_status stress_dip_ensemble(size_t n, const double profiles[], const double without[], double margin,
                              size_t resamples, gsl_rng *rng, double means[], stress_dips *dips);

/* dip or peak if p_value < level; none_within_margin if p_margin < level; dip_within_margin or
 * peak_within_margin if both; undecided. */
const char *stress_dip_word(const stress_dips *dips, double level);

#endif
