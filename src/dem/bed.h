/* Grains of which most are asleep: a pile that is built grain by grain, at the cost of what moves.
 *
 * A grain asleep keeps its place and its contacts with their springs. Steps are made by a simulation of the
 * grains awake, to which those asleep nearby are fixed grains. A grain falls asleep after it has been slow
 * and in balance for a while, and wakes when what it carries is out of balance, or when it is about to be
 * hit. So asleep no grain is farther from balance than `wake_force`; a simulation of all, dem_bed_sim,
 * relaxes what is left. Deterministic, without functions of the C library but sqrt and floor. */
#ifndef DEM_BED_H
#define DEM_BED_H

#include "dem/dem.h"

typedef struct {
    bool sleep;         /* false: all stay awake, to compare with */
    double sleep_speed; /* slower than this, */
    double sleep_force; /* with a net force below this, torque below it times the radius, */
    double sleep_time;  /* for this long, a grain falls asleep */
    double wake_force;  /* net force, or torque over radius, at which it wakes; above sleep_force */
    double wake_speed;  /* speed of what comes to hit it, from which it wakes beforehand */
    double x_limit;     /* a grain with |x| beyond is taken out */
    size_t most;        /* grains */
} dem_bed_options;

typedef struct dem_bed dem_bed;

/* An empty bed. `scene`: laws, gravity and walls, whose grains and skin do not count; no walls that open or
 * turn. Errors: RP_NO_MEMORY. */
rp_status dem_bed_create(const dem_definition *scene, const dem_bed_options *options, dem_bed **bed);
void dem_bed_free(dem_bed *bed);

/* One more grain, awake; ids count from 1. Errors: RP_BAD_INPUT (there are `most`). */
rp_status dem_bed_add(dem_bed *bed, const dem_grain *grain);

/* Advance until nothing moves: all are asleep, or, where they do not sleep, all could. After `most` steps
 * what is awake is put to sleep as it is, and *rest is false. Errors: those of dem_create and dem_run;
 * RP_BROKEN also for a grain with too many contacts. */
rp_status dem_bed_run(dem_bed *bed, long most, bool *rest);

long dem_bed_steps(const dem_bed *bed);
double dem_bed_grain_steps(const dem_bed *bed); /* sum over them of the grains awake */
size_t dem_bed_count(const dem_bed *bed);       /* ids given, those taken out included */

/* A grain as it is; NULL if it was taken out. */
const dem_grain *dem_bed_grain(const dem_bed *bed, uint32_t id);

/* Height of the centre at which a grain of radius r, lowered at x onto a floor y = 0 and what lies on it, is
 * `gap` away from the first that it meets. */
double dem_bed_height(const dem_bed *bed, double x, double r, double gap);

/* A simulation of all grains, awake, at rest, and with the springs of their contacts; its ids count those
 * that are left. Errors: those of dem_create. */
rp_status dem_bed_sim(const dem_bed *bed, dem_sim **sim);

#endif
