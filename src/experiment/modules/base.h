/* The load on a pile's base. */
#ifndef EXP_BASE_H
#define EXP_BASE_H

#include "core/status.h"
#include "stress/stress.h"

/* Profile that rays of 60 degrees put on this base under the outline of a pile of disks of mean diameter 1:
 * the highest points of columns of that width, where disks have their highest points (x, top), joined by
 * straight lines. Steps steeper than rays are filled. Errors: RP_NO_MEMORY, RP_BAD_INPUT (not finite). */
rp_status exp_outline_rays(size_t n, const double x[], const double top[], const stress_base *base,
                           double N[STRESS_DIP_BINS]);

#endif
