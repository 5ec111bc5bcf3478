/* A table of runs whose angles are a known function of the open choices, and numbers published of one choice.
 */
#ifndef PLANTED_H
#define PLANTED_H

#include <stdbool.h>
#include <stddef.h>

/* Angle in degrees, of the groups of sweeps/engine/groups.h at the point and of slip = "total". */
double planted_angle(double stiffness, double damping, int total);

enum { PLANTED_POINTS = 3, PLANTED_PILES = 4 };
extern const double planted_k_n[PLANTED_POINTS], planted_gamma_n[PLANTED_POINTS];

/* Groups of density, g, k_n and gamma_n. */
double planted_stiffness(double density, double g, double k_n);
double planted_damping(double g, double gamma_n);

/* PREFIXruns.tsv of n settings, and PREFIXclaims.tsv of the choice density = 2, g = 500, slip = "total":
 * numbers with
 * +- 0.3 at three points, and one that is held out. With `stops` the runs of the second point, where k_n =
 * 1e5, have no result below a stiffness of 4e3, that of the choice among them. The surfaces of a parabola
 * through the origin have 9 degrees more. */
void planted_write(const char *prefix, size_t n, bool stops);

#endif
