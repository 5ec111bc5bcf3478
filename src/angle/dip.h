/* Mean pressure on the base of piles, and whether it dips in the middle. */
#ifndef ANG_DIP_H
#define ANG_DIP_H

#include <stddef.h>

#include "core/status.h"

/* Bins of the base: 20 of 0.05 B about the centroid of the load; B is the width about it that holds 98 % of
 * the load. */
enum { ANG_DIP_BINS = 20 };
typedef struct {
    double centroid, width; /* of the load; B, lengths of x */
    double N[ANG_DIP_BINS]; /* pressure in each bin over the mean over the bins */
} ang_base;

/* The profile under one pile, from n contacts with its base: places, half-widths that a contact's force is
 * spread over evenly (a disk's radius), forces. Errors: RP_NO_RESULT (no load), RP_NO_MEMORY. */
rp_status ang_base_profile(size_t n, const double x[], const double r[], const double N[], ang_base *base);

/* (Mean N where |x - c| < 0.1 B, less that where 0.1 B < |x - c| < 0.3 B) over the mean N; below 0 is a dip.
 */
double ang_dip(const double N[ANG_DIP_BINS]);

#endif
