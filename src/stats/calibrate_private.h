/* What response.c, calibrate.c and planted.c share. */
#ifndef STATS_CALIBRATE_PRIVATE_H
#define STATS_CALIBRATE_PRIVATE_H

#include <nlopt.h>

#include "stats/calibrate.h"

/* Minimum of f over a box, from x, where it is left (n = 1 or 2). A side with lo = hi is held.
 * Errors: RP_NO_MEMORY, RP_BROKEN. */
rp_status stats_descend(nlopt_func f, void *data, unsigned n, const double lo[], const double hi[],
                        double x[], double *value);

/* Sort piles into points: c->x, c->mean, c->sd, c->number; point_of[pile], its number (may be NULL).
 * Errors: RP_BAD_INPUT, RP_NO_MEMORY. */
rp_status stats_points_make(const stats_ensemble *piles, size_t point_of[], stats_calibration *c);

/* Fit the coefficients of a response, whose form is set, to the means y[] of the points.
 * Errors: RP_NO_RESULT (the scale is not determined), RP_NO_MEMORY, RP_BROKEN. */
rp_status stats_response_solve(stats_response_fit *r, const stats_calibration *c, size_t angle,
                               const double y[]);

#endif
