/* What the end of a run says: at rest or not, and the slope of the pile. */
#ifndef CLI_CLOSING_H
#define CLI_CLOSING_H

#include "angle/angle.h"
#include "cli/progress.h"
#include "run/run.h"

/* theta_R by method 3 of a pile that falls to one side (ang_one_sided), and the range of x that it takes:
 * from the standing wall to an upright one that has opened, or over all grains. NaN also unless gravity
 * points down. Errors: RP_NO_MEMORY. */
typedef struct {
    ang_slope theta_r;
    double x[2];
} cli_slope;
rp_status cli_slope_of(rp_arena *arena, const dem_sim *sim, cli_slope *slope);

/* Who looks on at a run, for its sinks: its progress; what is to be said once, of threads that have no use
 * and of shear forces beyond friction; and of a scene without phases
 * - whether it is at rest, by dem_at_rest to DEM_REST_ENERGY and DEM_REST_FORCE, in looks that end with the
 * run; a run of fewer than 5000 steps has them closer together, one below 10 none;
 * - whether its energy grows without a source: a step near the limit of stability heats a scene with little
 *   damping, slowly, endlessly. Samples of the first and of the last quarter of a long run are compared; a
 * growth is told on standard error and in the table of states, unless a grain has left with its energy. */
typedef struct {
    rp_arena *arena;
    bool quiet, begun, over_friction;
    long threads;
    cli_progress progress;
    long steps;  /* of a scene without phases; else 0 */
    long rested; /* looks in a row that found it at rest */
    struct {
        long every; /* steps; 0: a scene with a source */
        size_t n, grains;
        double first, last, scale;
    } energy;
} cli_looks;
void cli_looks_scene(cli_looks *looks, const dem_scene *scene, const dem_sim *sim); /* without phases */
long cli_looks_next(const void *looks, long step);
rp_status cli_looks_at(void *looks, const exp_run *run);
void cli_looks_at_frame(void *looks, const exp_run *run);
void cli_looks_keep(rp_snapshot *s, void *looks);

/* The closing line on standard error: grains, steps, at rest or not, of a pile at rest its slope, and where
 * the tables are; directory "": on standard output. And what is to be said of its energy. */
void cli_close_run(const cli_looks *looks, const dem_sim *sim, const char *directory);
void cli_close_energy(const cli_looks *looks, const dem_sim *sim, FILE *states);

/* Say on standard error if so many threads have no use for the simulation as it is. */
void cli_tell_threads(const dem_sim *sim, const char *command, long threads);

/* A line of such an end; without a folder: what is printed. */
void cli_close_line(const char *said, const char *directory, const char *printed);

#endif
