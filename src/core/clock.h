/* Wall time, for run times and progress; no result depends on it. */
#ifndef RP_CLOCK_H
#define RP_CLOCK_H

#include <time.h>

/* Seconds since some moment in the past. */
static inline double rp_clock(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

#endif
