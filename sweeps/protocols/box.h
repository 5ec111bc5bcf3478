/* The box of Lee & Herrmann 1993 as protocols share it: parameters of materials, grains, walls and surface,
 * the scene that they make, and a run in it: advance, test for rest, measure the surface, write tables. */
#ifndef SWEEP_BOX_H
#define SWEEP_BOX_H

#include <stdbool.h>

#include "angle/angle.h"
#include "dem/scene/scene.h"
#include "sweeps/engine/keep.h"
#include "sweeps/engine/protocol.h"

enum { SWEEP_FLOOR_EXTENDS, SWEEP_FLOOR_ENDS, SWEEP_FLOOR_ABSORBS };

/* cgs; a negative value stands for "auto". */
typedef struct {
    dem_physics physics;
    double W, mu_wall, mu_floor, k_n_wall;
    double radius_mean, radius_width, radius_min, radius_max, g, open;
    double rest_energy, rest_force;
    int floor, height, empty, parabola;
    double H; /* of the boxes that a fill makes: height that the grains are counted for, */
    long N, fill_steps, max_steps; /* their number, least steps of filling, most steps of a phase */
    bool floor_grains;
} sweep_box;

/* A protocol of the box has a structure of parameters that begins with a sweep_box. Its schema starts with
 * SWEEP_BOX_PHYSICS, which brings all of dem/law/parameters.h, with friction as the paper's box has it. Of
 * the other rows it takes those it offers, and sets the fields of the others itself. */
#define SWEEP_PHYSICS_ROW(...) DEM_NAME_ROW(sweep_box, physics., __VA_ARGS__)
#define SWEEP_RADIUS_ROW(...)  DEM_NAME_ROW(sweep_box, , __VA_ARGS__)
#define SWEEP_BOX_PHYSICS                                                                                    \
    DEM_PHYSICS_FROM(SWEEP_PHYSICS_ROW, "spring", "0.2") DEM_RADIUS_PARAMS(SWEEP_RADIUS_ROW)

#define SWEEP_ROW(field, unit, type, fallback, range, meaning)                                               \
    {#field, unit, type, offsetof(sweep_box, field), fallback, range, meaning},

#define SWEEP_BOX_WIDTH_ROW SWEEP_ROW(W, "cm", RP_REAL, "4.0", "(0, 1000]", "width of the box")

#define SWEEP_BOX_COUNT_ROWS                                                                                 \
    SWEEP_ROW(H, "cm", RP_REAL, "4.0", "(0, 1000]", "height that the grains are counted for")                \
    SWEEP_ROW(N, "", RP_INT, "auto", "[1, 10000000] | auto", "number of grains; auto: W H / d^2")

#define SWEEP_BOX_FILL_STEPS_ROW                                                                             \
    SWEEP_ROW(fill_steps, "", RP_INT, "30000", "[1, 1000000000]", "least steps of filling")

#define SWEEP_BOX_MAX_STEPS_ROW                                                                              \
    SWEEP_ROW(max_steps, "", RP_INT, "auto", "[5000, 2000000000] | auto",                                    \
              "most steps a phase; auto: 4e5, times 500/gamma_n and (H/4)^2 where these exceed 1")

#define SWEEP_BOX_WALL_ROWS                                                                                  \
    SWEEP_ROW(mu_wall, "", RP_REAL, "auto", "[0, inf) | infinite | auto",                                    \
              "friction of the side walls; auto: mu")                                                        \
    SWEEP_ROW(mu_floor, "", RP_REAL, "auto", "[0, inf) | infinite | auto",                                   \
              "friction of the floor; auto: mu")                                                             \
    SWEEP_ROW(k_n_wall, "dyn/cm^1.5", RP_REAL, "auto", "(0, inf) | auto",                                    \
              "normal stiffness of floor and walls; auto: 2 k_n")                                            \
    SWEEP_ROW(g, "cm/s^2", RP_REAL, "981.0", "(0, inf)", "gravity")

#define SWEEP_BOX_OPENING_ROWS                                                                               \
    SWEEP_ROW(floor, "", RP_CHOICE, "extends", "extends | ends | absorbs",                                   \
              "beyond the opening: extends (out at 3 W), ends in a corner at W, or takes grains out at W")   \
    SWEEP_ROW(open, "cm/s", RP_REAL, "instant", "(0, inf) | instant",                                        \
              "speed at which the right wall is lifted")

#define SWEEP_TEXT(number)  SWEEP_TEXT_(number)
#define SWEEP_TEXT_(number) #number
#define SWEEP_BOX_REST_ROWS                                                                                  \
    SWEEP_ROW(rest_energy, "m g d", RP_REAL, SWEEP_TEXT(DEM_REST_ENERGY), "(0, inf)",                        \
              "at rest: mean kinetic energy below")                                                          \
    SWEEP_ROW(rest_force, "m g", RP_REAL, SWEEP_TEXT(DEM_REST_FORCE), "(0, inf)",                            \
              "at rest: largest net force below")

#define SWEEP_BOX_SURFACE_ROWS                                                                               \
    SWEEP_ROW(height, "", RP_CHOICE, "centre", ANG_HEIGHT_WORDS,                                             \
              "h of a cell: highest centre less d/2, highest centre, highest point")                         \
    SWEEP_ROW(empty, "", RP_CHOICE, "zero", ANG_EMPTY_WORDS, "empty cells: height 0, or left out")           \
    SWEEP_ROW(parabola, "", RP_CHOICE, "free", ANG_PARABOLA_WORDS, "of method 3")

/* The scene of the box, closed, empty and without a fill. Where the floor is of grains, its wall lies below
 * them; the protocol adds them. */
void sweep_box_scene(const sweep_box *box, dem_scene *scene);

/* The grains of such a floor, from x = 0 to where it ends, as many as fit to the nearest; 0 without.
 * `grains` may be NULL, to count them. */
size_t sweep_box_floor(const sweep_box *box, dem_grain *grains);

/* Refuse a box that cannot work. `drop`: greatest height that a grain falls from.
 * Errors: RP_BAD_INPUT. */
rp_status sweep_box_check(const sweep_box *box, double drop);

/* Largest time step for the lightest grain that can be drawn, falling from `drop`. `what` as in
 * dem_time_step_limit. */
double sweep_box_step_limit(const sweep_box *box, double drop, const char **what);

/* One run in the making. */
typedef struct {
    const sweep_box *box;
    const sweep_tables *tables; /* NULL: none */
    sweep_keep *keep;           /* NULL: none */
    sweep_result *result;
    dem_scene scene;   /* from sweep_box_scene; the protocol adds fill or grains, freed by sweep_box_end */
    dem_sim *sim;      /* NULL until the protocol starts it; of a resumed run, as it was */
    dem_sim *rested;   /* a copy of the pile at rest, for another tilt; NULL: none */
    long steps_before; /* of tilts before that */
    double d, mg;      /* nominal diameter; weight of a grain of the mean radius */
    long max_steps;    /* most steps that sweep_box_settle waits */
    double cells;      /* occupied when the surface was looked at last; NaN before */
    dem_state *states; /* room for the most grains */
    double *work;      /* and for 3 numbers each */
    size_t most;       /* number of these */
    size_t n_noted;    /* by sweep_box_note: grains in the pile, */
    double *x, *y;     /* [1 + most] by id from 1 on, in the box's frame; NaN for grains outside the pile */
    sweep_file energy;
} sweep_box_run;

/* Clear the result, make the scene and room for `most` grains at a time. Afterwards sweep_box_end with what
 * came of the run, also after an error; it returns RP_OK for RP_NO_RESULT, whose word is in the result.
 * Errors: RP_NO_MEMORY, RP_IO. */
rp_status sweep_box_begin(sweep_box_run *run, const sweep_box *box, size_t most, const sweep_tables *tables,
                          sweep_result *result);
rp_status sweep_box_end(sweep_box_run *run, rp_status status);

/* Start the simulation of run->scene. Errors: RP_NO_RESULT with the word no_room. */
rp_status sweep_box_start(sweep_box_run *run);

/* Advance. Errors: RP_NO_RESULT, with its word, for a fault of the simulation. */
rp_status sweep_box_advance(sweep_box_run *run, long steps);

/* How far from rest the grains over the box's floor are, 0 < x < W, and whether that counts as rest. */
rp_status sweep_box_rest(const sweep_box_run *run, dem_rest *rest, bool *quiet);

/* Test for rest every 500 steps until 10 tests in a row pass; with `pile`, only while there are cells enough
 * for a slope. `phase` is for the message. Errors: RP_NO_RESULT with the word not_at_rest, or no_pile. */
rp_status sweep_box_settle(sweep_box_run *run, const char *phase, bool pile);

/* Open the right wall and advance by `steps`, or if steps < 1 by 5000 and then until the pile is at rest. The
 * run ends with the word no_pile once too few cells are left for a slope. */
rp_status sweep_box_open(sweep_box_run *run, long steps);

/* The same as phases of a protocol, 0 to SWEEP_BOX_PHASES - 1: start, fall for box->fill_steps, filling to
 * rest, opening and rest. Errors: as of these functions. */
enum { SWEEP_BOX_PHASES = 4 };
rp_status sweep_box_phase(sweep_box_run *run, size_t phase);

/* How the box's parameters say that a surface is measured. */
ang_options sweep_box_options(const sweep_box *box);

/* The surface of the present state, fixed grains left out. Afterwards ang_surface_free, also after an error.
 * Errors: RP_NO_RESULT with the word no_pile. */
rp_status sweep_box_surface(sweep_box_run *run, const ang_options *options, ang_surface *surface);

/* The slopes of the present state, by the box's options. Errors: as sweep_box_surface. Grains that lie flat
 * on a smooth floor are no pile of angle 0, since any slope would have flowed out: sweep_box_pile_slopes then
 * fails with the word no_pile. */
rp_status sweep_box_slopes(sweep_box_run *run, ang_slope slopes[ANG_N_METHODS]);
rp_status sweep_box_pile_slopes(sweep_box_run *run, ang_slope slopes[ANG_N_METHODS]);

/* Slope of the straight line through n neighbouring cells in use from `from` on; fewer than three set none.
 */
rp_status sweep_box_line(const ang_surface *surface, size_t from, size_t n, double *theta_deg);

/* Check a box that is filled from W x 2 H: by N grains, or for N < 1 by as many as W H holds squares of the
 * diameter d. Errors: RP_BAD_INPUT. */
rp_status sweep_box_check_fill(const sweep_box *box);

/* sweep_box_begin with room for the grains of such a box and of its floor, with the fill of the random
 * streams (seed, stream), and with max_steps; for less than 1: 4e5, times 500/gamma_n and the square of the
 * number of rows over 20 where these exceed 1. Errors: as sweep_box_begin. */
rp_status sweep_box_begin_filled(sweep_box_run *run, const sweep_box *box, unsigned long seed,
                                 unsigned long stream, const sweep_tables *tables, sweep_result *result);

/* Note the positions of the grains of the pile, 0 < x < W, none of them fixed. */
rp_status sweep_box_note(sweep_box_run *run);

/* Number of these grains, with at least `contacts` contacts, that are further than `reach` from their
 * positions; grains that have left the scene count. */
rp_status sweep_box_moved(sweep_box_run *run, double reach, int contacts, size_t *moved);

/* Continue from the pile at rest, unless that is done. Steps in all, with those of tilts before. */
void sweep_box_go_back(sweep_box_run *run);
double sweep_box_steps(const sweep_box_run *run);

/* Onset by displacement: 5 % of these grains are further than 0.1 d from their positions. */
rp_status sweep_box_onset(sweep_box_run *run, bool *moves);

/* Turn gravity, or with `box` the walls, by `rate_deg` a step until the pile moves, at most by 60 degrees.
 * Sets the turned angle, in degrees, at the onset by displacement and, unless NULL, by kinetic energy: above
 * 1e-5 m g d and ten times the elastic sway that the start excites, the largest within half a degree. What
 * does not occur keeps its value. */
rp_status sweep_box_tilt(sweep_box_run *run, bool box, double rate_deg, double *displacement_deg,
                         double *energy_deg);

double sweep_degrees(double radians);

/* Height of the centre at which a grain of radius r, lowered at x onto n grains and a floor at y = 0, is
 * `gap` away from the first obstacle. */
double sweep_touch_height(size_t n, const dem_state grains[], double x, double r, double gap);

/* Hash of all positions and velocities. */
void sweep_states_digits(size_t n, const dem_state states[], char digits[33]);

#endif
