/* What response.c, calibrate.c and planted.c share. */
#ifndef ANG_CALIBRATE_PRIVATE_H
#define ANG_CALIBRATE_PRIVATE_H

#include <nlopt.h>

#include "angle/calibrate.h"

/* Minimum of f over a box, from x, where it is left (n = 1 or 2). A side with lo = hi is held.
 * Errors: RP_NO_MEMORY, RP_BROKEN. */
rp_status ang_descend(nlopt_func f, void *data, unsigned n, const double lo[], const double hi[], double x[],
                      double *value);

/* Sort piles into points: c->x, c->mean, c->sd, c->number; point_of[pile], its number (may be NULL).
 * Errors: RP_BAD_INPUT, RP_NO_MEMORY. */
rp_status ang_points_make(const ang_ensemble *piles, size_t point_of[], ang_calibration *c);

/* Fit the coefficients of a response, whose form is set, to the means y[] of the points.
 * Errors: RP_NO_RESULT (the scale is not determined), RP_NO_MEMORY, RP_BROKEN. */
rp_status ang_response_solve(ang_response_fit *r, const ang_calibration *c, size_t angle, const double y[]);

#endif
