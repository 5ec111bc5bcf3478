/* The contact laws of law.inl for one contact at a time. */
#ifndef DEM_LAW_H
#define DEM_LAW_H

#include <math.h>
#include <stdbool.h>

typedef double num;
typedef bool lanes;

static inline num num_of(double a)
{
    return a;
}

static inline num num_sqrt(num a)
{
    return sqrt(a);
}

static inline num num_max(num a, num b)
{
    return a > b ? a : b;
}

static inline num num_limit(num a, num most, lanes *less)
{
    *less = fabs(a) > most;
    return *less ? copysign(most, a) : a;
}

static inline num num_choose(lanes l, num yes, num no)
{
    return l ? yes : no;
}

static inline lanes num_less(num a, num b)
{
    return a < b;
}

#include "dem/law/law.inl"

#endif
