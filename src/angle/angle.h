/* The angle toolkit: slopes of a pile's surface, and the angles up to which it is stable by theory.
 * Plain arrays in, plain numbers out; angles in radians, every length in one unit.
 *
 * Theory: Lee & Herrmann 1993, section 6. Equations (3) and (4) compare the force of the pile on a grain of
 * the base with Coulomb's law; that force is taken along two rays of inclination phi (pi/3 for a
 * close-packed pile). So mu is the friction of the base, and both rays must leave through the same flank. */
#ifndef ANG_ANGLE_H
#define ANG_ANGLE_H

#include <stdbool.h>
#include <stddef.h>

#include "core/random.h"
#include "core/status.h"
#include "stats/stats.h"

RP_C_BEGIN

/* ---- marginal stability and tilt (criterion.c) ---- */

/* How the rays carry the weight when the pile is tilted by theta_T. */
#define ANG_FORM_WORDS "balanced | lattice | sine | printed"
typedef enum {
    ANG_BALANCED, /* rays fixed to gravity, weighted with the widths of their beams: forces balance */
    ANG_LATTICE,  /* rays fixed to the tilted lattice, weight resolved along them: forces balance */
    ANG_SINE,     /* (4) with the tangents of (4b) read as sines, the evident intent */
    ANG_PRINTED,  /* (4) as printed; disagrees with (3) at theta_T = 0 */
    ANG_N_FORMS
} ang_form;

typedef enum {
    ANG_TILT_OK,               /* theta_t found */
    ANG_TILT_OK_PULLING,       /* found, but at theta_t one ray of the lattice form pulls: grains do not */
    ANG_TILT_ALREADY_UNSTABLE, /* theta_r exceeds theta_ms of (3): slides without tilt */
    ANG_TILT_NO_SLIDE,         /* friction holds at every tilt below `limit`, where the form ends */
    ANG_TILT_RAYS_MISS,        /* theta_r >= phi: the upper ray never leaves the pile, no theory */
    ANG_TILT_NO_PILE           /* a mean theta_r below 0, of piles compared with theory */
} ang_tilt_status;

typedef struct {
    ang_tilt_status status;
    double theta_t;  /* tilt at which the pile slides; NaN unless found */
    double theta_ms; /* equation (3) */
    double margin;   /* theta_ms - theta_r; negative if the pile already slides */
    double limit;    /* tilt at which the form ends (a ray runs along the flank; lattice: pi/2) */
} ang_tilt_result;

extern const char *const ang_form_words[];
extern const char *const ang_tilt_words[];

/* Equation (3) for any inclination of the rays: tan theta_ms = mu tan^2 phi. mu in [0, inf], where infinity
 * gives pi/2; phi in (0, pi/2). *extrapolated (may be NULL) is true if theta_ms >= phi: then a pile whose
 * flank is as steep as the rays is stable, and (3) is extrapolated beyond its derivation. Errors:
 * RP_BAD_INPUT. */
rp_status ang_marginal(double mu, double phi, double *theta_ms, bool *extrapolated);

/* Friction that a pile of slope theta_r needs at the tilt theta_t: the right side of (4).
 * theta_r in [0, phi), theta_t in [0, limit of the form), phi in (0, pi/2). Errors: RP_BAD_INPUT. */
rp_status ang_friction(ang_form form, double theta_r, double theta_t, double phi, double *mu);

/* The tilt theta_t at which (4) needs the friction mu. mu in [0, inf], theta_r in [0, pi/2), phi in
 * (0, pi/2). A pile without such a tilt is a result, not an error: see result->status.
 * Errors: RP_BAD_INPUT, RP_NO_MEMORY (a GSL solver is allocated), RP_BROKEN. */
rp_status ang_tilt(ang_form form, double mu, double theta_r, double phi, ang_tilt_result *result);

/* ---- surface and slopes (surface.c) ---- */

#define ANG_HEIGHT_WORDS "centre | raw_centre | top"
typedef enum {
    ANG_CENTRE,     /* highest centre minus half the nominal diameter, at least 0 */
    ANG_RAW_CENTRE, /* highest centre */
    ANG_TOP         /* highest point, centre plus radius */
} ang_height;

#define ANG_EMPTY_WORDS "zero | skip"
typedef enum {
    ANG_EMPTY_ZERO, /* an empty cell has height 0 */
    ANG_EMPTY_SKIP  /* an empty cell is left out */
} ang_empty;

#define ANG_PARABOLA_WORDS "free | origin"
typedef enum {
    ANG_PARABOLA_FREE,  /* three coefficients */
    ANG_PARABOLA_ORIGIN /* through 0 where the sum starts, the left edge of the first cell */
} ang_parabola;

typedef struct {
    double diameter; /* nominal diameter d of a grain */
    ang_height height;
    ang_empty empty;
    ang_parabola parabola;
} ang_options;

#define ANG_OPTIONS_DEFAULT ((ang_options){0.2, ANG_CENTRE, ANG_EMPTY_ZERO, ANG_PARABOLA_FREE})

enum { ANG_MIN_OCCUPIED = 5, ANG_N_METHODS = 3 };

/* Slope, positive where the surface falls to the right; theta = atan(slope); standard errors of both. */
typedef struct {
    double slope, slope_se, theta, theta_se;
} ang_slope;

/* The surface of one pile: its cells, numbered from the left, that count, and their heights. */
typedef struct {
    size_t n_cells, n_occupied;
    double cell;    /* width of a cell: width of the box / n_cells */
    size_t n;       /* cells in use */
    size_t *column; /* number of each, ascending */
    double *h;      /* height of each */
} ang_surface;

/* h(x) of n grains with centres (x, y) and radii r (NULL allowed unless ANG_TOP) in a box 0 <= x < width.
 * round(width/diameter) cells; a grain belongs to the cell of its centre, others are left out. Free with
 * ang_surface_free, also after an error.
 * Errors: RP_BAD_INPUT; RP_NO_RESULT for fewer than ANG_MIN_OCCUPIED occupied cells (n_cells and n_occupied
 * are set); RP_NO_MEMORY. */
rp_status ang_surface_make(size_t n, const double x[], const double y[], const double r[], double width,
                           const ang_options *options, ang_surface *surface);
void ang_surface_free(ang_surface *surface);

/* theta_R by method 3 of a pile whose surface falls to one side: n grains of the mean diameter, centres (x,
 * y) over the ground y = 0, of which those between ends[0] and ends[1] count. The slopes by all three
 * methods, seen from the left or from the right, exceed three times their errors; else, and with grains in
 * fewer than half of the cells, NaN. Errors: RP_NO_MEMORY. */
rp_status ang_one_sided(size_t n, const double x[], const double y[], const double ends[2], double diameter,
                        ang_slope *slope);

/* Slopes by the three methods of Lee & Herrmann 1993, section 3: (1) first to last cell, (2) straight line,
 * (3) parabola through the running sum of h. Each is a linear combination of the heights, whose error is
 * propagated from the scatter of h about its least-squares line. h[n] are the heights of the cells
 * column[n] (ascending; NULL: 0, 1, ...) of width `cell`; n >= 3.
 * Errors: RP_BAD_INPUT, RP_NO_RESULT (overflow), RP_NO_MEMORY. */
rp_status ang_slopes(size_t n, const size_t column[], const double h[], double cell, ang_parabola parabola,
                     ang_slope slopes[ANG_N_METHODS]);

typedef struct {
    size_t n, n_flanks, n_flank[2]; /* points of the surface, of each flank from left to right */
    size_t n_stray;                 /* points that were left out */
    ang_slope flank[2][ANG_N_METHODS], mean[ANG_N_METHODS]; /* mean: of the steepness of two */
} ang_pile;

/* The flanks of the pile among n > 0 points with x in a range, wherever it is and whatever its ground: an
 * outline or all grains, in any order. A point below another by more than 57 degrees is inside, the others
 * are the surface. A flank is what lies between its lowest and its highest tenth, so that ground before and
 * behind does not count; the sum of method 3 is the area below it. Where there is no pile with them, a
 * hundredth of the points at either end, beyond a gap in x, are left out. Errors: RP_NO_RESULT with none or
 * more than two, with fewer than 4 points on one, or one no steeper than 3 of its errors; RP_NO_MEMORY. */
rp_status ang_pile_find(size_t n, const double x[], const double y[], const double range[2], ang_pile *pile);

/* ---- piles against theory (compare.c) ---- */

/* Piles of one friction coefficient: theta_r[n] and theta_t[n], one pile an index. Borrowed. */
typedef struct {
    double mu;
    size_t n;
    const double *theta_r, *theta_t;
} ang_piles;

/* Piles of one friction coefficient against (3) and (4), standard errors bootstrapped over piles. Estimates
 * are NaN where the form has no theta_t. */
typedef struct {
    stats_summary theta_r, theta_t, theta_rt; /* rt: the sum, pile by pile */
    double theta_ms;                          /* (3) */
    stats_number diff_ms;                     /* theta_rt - theta_ms */
    size_t n_unstable;                        /* piles steeper than theta_ms */
    size_t n_lost;                            /* resamples without theta_t, left out (the worst form's) */
    struct {
        ang_tilt_status status;
        stats_number theta_t;  /* (4) at the mean theta_r */
        stats_number diff;     /* mean measured theta_t minus that */
        stats_number theta_rt; /* mean theta_r plus that */
        /* magnitude of diff less that of diff_ms, and the same with each over its measured angle: negative
         * where (4) is nearer to the measurement than (3), the claim of Fig. 7 */
        stats_number gain, gain_relative;
    } form[ANG_N_FORMS];
} ang_comparison;

/* piles->mu in [0, inf], phi in (0, pi/2), n_resamples >= 2. Standard errors are NaN for a single pile.
 * Errors: RP_NO_RESULT without piles, those of stats_mean and ang_tilt. */
rp_status ang_compare(const ang_piles *piles, double phi, size_t n_resamples, rp_random *rng,
                      ang_comparison *comparison);

RP_C_END

#endif
