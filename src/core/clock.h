/* Wall and processor time and memory, for run times and progress; no result depends on them. */
#ifndef RP_CLOCK_H
#define RP_CLOCK_H

#include <sys/resource.h>
#include <time.h>

/* Seconds since a fixed moment in the past. */
static inline double rp_clock(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* Processor time of this process so far, seconds. */
static inline double rp_cpu_clock(void)
{
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* Peak memory of this process so far, MB (1e6 bytes). */
static inline double rp_peak_memory(void)
{
    struct rusage usage;
    getrusage(RUSAGE_SELF, &usage);
    return (double)usage.ru_maxrss * 1024e-6;
}

#endif
