/* Parts of protocol `flux` that can be tested by themselves. */
#ifndef SWEEP_PROTOCOL_FLUX_H
#define SWEEP_PROTOCOL_FLUX_H

#include "dem/dem.h"

/* Height of the centre at which a grain of radius r, lowered at x onto n grains and a floor at y = 0, is
 * `gap` away from the first that it meets. */
double sweep_flux_height(size_t n, const dem_state grains[], double x, double r, double gap);

#endif
