/* Properties that hold for every input of a range, tried on seeded random ones. What fails is made simpler as
 * long as it still fails, and then printed. */
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

/* By how much the inputs x break the property, in units of what is allowed: it holds up to 1; NaN fails. */
typedef double property_excess(const double x[]);

typedef struct {
    const char *name;
    property_excess *excess;
    property_input input[PROPERTY_INPUTS]; /* as many as have a name */
} property;

/* Try the first n inputs of the stream of `seed`; false: one fails, and x is it, made as simple as it gets:
 * each input at the whole number of its range nearest to 0, or with few digits near to it. */
bool property_holds(const property *p, unsigned long seed, int n, double x[PROPERTY_INPUTS]);

/* The same as a test, which prints what fails. */
void property_check(const property *p, unsigned long seed, int n);

#endif
