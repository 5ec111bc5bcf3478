/* Labels of units against what they stand for. */
#ifndef LABELS_H
#define LABELS_H

#include <stdbool.h>

/* Powers of length, mass and time of a label, such as "dyn/cm^1.5", "kg/m^3" or "rad (g/sigma)^0.5"; `sigma`:
 * of that system, in which m is a mass and g gravity. False: it has another word. */
bool label_powers(const char *label, bool sigma, double powers[3]);

#endif
