/* What the end of a run says: at rest or not, and the slope of the pile. */
#ifndef CLI_CLOSING_H
#define CLI_CLOSING_H

#include "angle/angle.h"
#include "core/arena.h"
#include "dem/scene/scene.h"

/* theta_R by method 3 of a pile that falls to one side (ang_one_sided), and the range of x that it takes:
 * from the standing wall to an upright one that has opened, or over all grains. NaN also unless gravity
 * points down. Errors: RP_NO_MEMORY. */
typedef struct {
    ang_slope theta_r;
    double x[2];
} cli_slope;
rp_status cli_slope_of(rp_arena *arena, const dem_sim *sim, cli_slope *slope);

/* The closing line on standard error: grains, steps, at rest by dem_at_rest to 1e-7 m g d and 1e-2 m g or
 * not, of a pile at rest its slope, and where the tables are; directory "": on standard output. */
void cli_close_run(rp_arena *arena, const dem_sim *sim, const char *directory);

/* The end of that line, in which the end of a line in a folder's name is a blank. */
void cli_close_line(const char *directory);

#endif
