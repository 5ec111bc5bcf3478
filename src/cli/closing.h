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

/* Looks in a row that found the grains of a run at rest, by dem_at_rest to DEM_REST_ENERGY and
 * DEM_REST_FORCE. They end with the run of so many steps; a run of fewer than 5000 has them closer together,
 * one below 10 none. */
typedef struct {
    long steps, passed;
} cli_rest;
long cli_rest_next(const cli_rest *rest, long step); /* steps from `step` to the next look, or to the end */
rp_status cli_rest_look(rp_arena *arena, const dem_sim *sim, cli_rest *rest); /* if this step has one */

/* Energy without source must not grow. Samples of the first and of the last quarter of a long run are
 * compared: a step near the limit of stability heats a scene with little damping, slowly, endlessly. A growth
 * is told on standard error and in the table of states, unless a grain has left with its energy. */
typedef struct {
    long every; /* steps; 0: no such scene */
    size_t n, grains;
    double first, last, scale;
} cli_growth;
cli_growth cli_growth_of(const dem_scene *scene, const dem_sim *sim);
long cli_growth_next(const cli_growth *g, long step); /* steps from `step` to the next sample */
void cli_growth_look(cli_growth *g, const dem_sim *sim);
void cli_growth_report(const cli_growth *g, const dem_sim *sim, FILE *states);

/* The closing line on standard error: grains, steps, at rest or not, of a pile at rest its slope, and where
 * the tables are; directory "": on standard output. */
void cli_close_run(rp_arena *arena, const dem_sim *sim, const cli_rest *rest, const char *directory);

/* Say on standard error if so many threads have no use for the simulation as it is. */
void cli_tell_threads(const dem_sim *sim, const char *command, long threads);

/* The end of that line, in which the end of a line in a folder's name is a blank. */
void cli_close_line(const char *directory);

#endif
