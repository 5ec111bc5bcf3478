/* Properties that hold for every input of a range, tested on seeded random inputs. A failing input is
 * simplified as long as it still fails, and then printed. */
#ifndef PROPERTY_H
#define PROPERTY_H

#include <stdbool.h>

enum { PROPERTY_INPUTS = 12 };

/* An input, uniform in [lo, hi], or one of the whole numbers there. */
typedef struct {
    const char *name;
    double lo, hi;
    bool whole;
} property_input;

/* Deviation of the inputs x from the property, in units of the tolerance: it holds up to 1; NaN fails. */
typedef double property_excess(const double x[]);

typedef struct {
    const char *name;
    property_excess *excess;
    property_input input[PROPERTY_INPUTS]; /* inputs with a name */
} property;

/* Test the first n inputs of the stream of `seed`. False: x is a failing input, simplified: each value is the
 * whole number of its range nearest to 0, or has few digits. */
bool property_holds(const property *p, unsigned long seed, int n, double x[PROPERTY_INPUTS]);

/* The same as a test that prints the failing input. */
void property_check(const property *p, unsigned long seed, int n);

#endif
