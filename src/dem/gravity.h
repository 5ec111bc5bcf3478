/* Gravity of a simulation; gravity.c. */
#ifndef DEM_GRAVITY_H
#define DEM_GRAVITY_H

#include "dem/dem.h"

/* Gravity and its turn are the definition's. */
void dem_gravity_start(dem_sim *sim);

/* Turn gravity by a step's angle if it turns now. */
void dem_gravity_advance(dem_sim *sim);

/* sin and cos by + - * / alone, |angle| < 1: the same bits on every processor. */
void dem_sine_cosine(double angle, double *sine, double *cosine);

#endif
