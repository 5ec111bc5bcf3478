/* The angle toolkit: slopes of a pile's surface, the angles at which theory lets it stand and slide, and
 * ensemble statistics. Plain arrays in, plain numbers out; angles in radians, every length in one unit.
 *
 * Theory: Lee & Herrmann 1993, section 6. Equations (3) and (4) compare the force of the pile on a grain of
 * the base with Coulomb's law; that force is taken along two rays of inclination phi (pi/3 for a
 * close-packed pile). So mu is the friction of the base, and both rays must leave through the same flank. */
#ifndef ANG_ANGLE_H
#define ANG_ANGLE_H

#include <gsl/gsl_rng.h>
#include <stdbool.h>
#include <stddef.h>

#include "core/status.h"

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

const char *ang_form_word(ang_form form);
const char *ang_tilt_word(ang_tilt_status status);

/* Equation (3) for any inclination of the rays: tan theta_ms = mu tan^2 phi. mu in [0, inf], where infinity
 * gives pi/2; phi in (0, pi/2). *extrapolated (may be NULL) is true if theta_ms >= phi: then a pile whose
 * flank is as steep as the rays stands, and (3) goes beyond its derivation. Errors: RP_BAD_INPUT. */
rp_status ang_marginal(double mu, double phi, double *theta_ms, bool *extrapolated);

/* Friction that a pile of slope theta_r needs at the tilt theta_t: the right side of (4).
 * theta_r in [0, phi), theta_t in [0, limit of the form), phi in (0, pi/2). Errors: RP_BAD_INPUT. */
rp_status ang_friction(ang_form form, double theta_r, double theta_t, double phi, double *mu);

/* The tilt theta_t at which (4) asks for the friction mu. mu in [0, inf], theta_r in [0, pi/2), phi in
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

/* All readings, in the order of ang_height and, fastest, ang_empty, as X(height, empty). */
#define ANG_SURFACES(X)                                                                                      \
    X(centre, zero) X(centre, skip) X(raw_centre, zero) X(raw_centre, skip) X(top, zero) X(top, skip)

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

/* Slopes by the three methods of Lee & Herrmann 1993, section 3: (1) first to last cell, (2) straight line,
 * (3) parabola through the running sum of h. Each is a linear combination of the heights, whose error is
 * propagated from the scatter of h about its least-squares line. h[n] are the heights of the cells
 * column[n] (ascending; NULL: 0, 1, ...) of width `cell`; n >= 3.
 * Errors: RP_BAD_INPUT. */
rp_status ang_slopes(size_t n, const size_t column[], const double h[], double cell, ang_parabola parabola,
                     ang_slope slopes[ANG_N_METHODS]);

/* ---- ensembles (ensemble.c) ---- */

/* sd, se and the 95 % interval (Student's t) are NaN for n = 1. */
typedef struct {
    size_t n;
    double mean, sd, se, lo, hi;
} ang_stats;

/* Errors: RP_NO_RESULT for n = 0, RP_BAD_INPUT for a value that is not finite; then every field is NaN. */
rp_status ang_mean(size_t n, const double v[], ang_stats *stats);

/* The same for a[i] + factor b[i]: paired differences (-1) and sums (+1). */
rp_status ang_paired(size_t n, const double a[], double factor, const double b[], ang_stats *stats);

/* Percentile bootstrap interval of the mean at `level` in (0, 1), from n_resamples >= 2 resamples;
 * means[n_resamples] is work space. NaN for n = 1. Errors: RP_NO_RESULT for n = 0, RP_BAD_INPUT. */
rp_status ang_bootstrap(size_t n, const double v[], double level, size_t n_resamples, gsl_rng *rng,
                        double means[], double *lo, double *hi);

/* y = intercept + slope x with weights 1/se^2; the se are taken at their word, not rescaled by chi2.
 * p_value: chance of a larger chi2; NaN without degrees of freedom. */
typedef struct {
    size_t n, dof;
    double slope, intercept, slope_se, intercept_se, covariance, chi2, p_value;
} ang_line;

/* Straight line, or with `origin` the line through (0, 0), whose intercept and its errors are 0.
 * se > 0. Errors: RP_NO_RESULT for fewer points than coefficients or no spread in x, RP_BAD_INPUT. */
rp_status ang_line_fit(size_t n, const double x[], const double y[], const double se[], bool origin,
                       ang_line *line);

/* ---- one series in time (series.c) ---- */

typedef struct {
    size_t n;
    double mean, sd;
    double se, se_error; /* standard error of the mean, and the standard error of that */
    double tau;          /* integrated correlation time in samples; 1/2 if uncorrelated: n/(2 tau) count */
    size_t block;        /* samples in a block on the plateau */
} ang_series;

/* Mean of a correlated series by blocking (Flyvbjerg & Petersen 1989): neighbours are averaged, again and
 * again, until the blocks' scatter gives a standard error that no longer grows. That plateau is taken to be
 * the first block length B with B^3 > 2 n (se_B/se_1)^4, where the error that is left in se_B by correlation
 * between blocks equals its statistical one (Lee et al. 2011). work[n] is work space.
 * Errors: RP_BAD_INPUT for a value that is not finite; RP_NO_RESULT for n < 4 and where fewer than four
 * blocks of such a length fit in (mean and sd are set): the series is too short for its correlation. */
rp_status ang_blocking(size_t n, const double v[], double work[], ang_series *series);

/* Where a series levels off: the start `from`, 0 <= from < n/2, that makes the standard error of the mean of
 * the rest smallest as if it were uncorrelated, sum (v - mean)^2/(n - from)^2 (MSER, White 1997).
 * Errors: RP_BAD_INPUT; RP_NO_RESULT for n < 4, and for one that still goes at half its length. */
rp_status ang_level_off(size_t n, const double v[], size_t *from);

/* Expected largest of `draws` of the n values, drawn without repeating one: without bias for independent
 * values, so that ensembles of different size can be compared. work[n] is work space.
 * Errors: RP_BAD_INPUT; RP_NO_RESULT for draws > n. */
rp_status ang_expected_maximum(size_t n, const double v[], size_t draws, double work[], double *maximum);

/* ---- trends, and that there is none (trend.c) ---- */

/* An estimate with its standard error and the degrees of freedom of that; infinite: the error is known. */
typedef struct {
    double value, se, dof;
} ang_contrast;

/* Interval that covers the truth in the share `level` of all cases. */
void ang_contrast_interval(const ang_contrast *c, double level, double *lo, double *hi);

/* Two-sided chance of such a value, or a larger one, if the truth is 0. */
double ang_contrast_p(const ang_contrast *c);

/* Two one-sided tests (TOST): chance of a value as small if the truth is `margin` or more, either way. Below
 * 0.05 just where the interval of 90 % lies within the margin. */
double ang_contrast_p_margin(const ang_contrast *c, double margin);

/* y against x. NaN where there are too few values; `bend` needs three different x. */
typedef struct {
    size_t n, n_x;          /* values used, different x */
    double from, to;        /* least and largest x */
    ang_contrast slope;     /* of the straight line of least squares */
    ang_contrast intercept; /* of the same, at x = 0 */
    ang_contrast bend;      /* coefficient of x^2 of the parabola of least squares */
    ang_contrast change;    /* of the line over the whole range of x */
    ang_contrast pair;      /* the largest difference between the means at two x: larger x less smaller x */
    double p_margin;        /* ang_contrast_p_margin of the change */
    double p_pairs;         /* the largest ang_contrast_p_margin over all pairs of x */
} ang_trend;

/* Least squares on n values at two different x or more; errors from the scatter at each x
 * (Welch-Satterthwaite), so that it may differ between the x, and a curve does not count as scatter. Where
 * an x has one value only, from the scatter about the line. With `pile` (else NULL), values of the same
 * pile are compared: each contrast is taken pile by pile and then averaged. Piles that lack a value at one
 * of the x are left out. Each value has the weight x^power, 0 for ordinary least squares: fixed weights, so
 * that errors stay exact. margin > 0: the largest change that counts as none.
 * Errors: RP_NO_RESULT (fewer than 3 values, 2 x, or 2 whole piles), RP_BAD_INPUT (a value that is not
 * finite, x <= 0 with a power, two values of a pile at one x), RP_NO_MEMORY. */
rp_status ang_trend_fit(size_t n, const double x[], const double y[], const double pile[], double power,
                        double margin, ang_trend *trend);

/* What tests at `level` say: falls or rises if p_value (corrected or not) is below it,
 * no_dependence_within_margin if p_margin is, falls_within_margin or rises_within_margin if both, undecided
 * if none. p_pairs, which asks for far more, has no part in it. */
const char *ang_trend_word(const ang_trend *trend, double p_value, double level);

/* Holm's correction for n tests; NaN is no test. */
void ang_holm(size_t n, const double p[], double corrected[]);

/* Coefficient of x^2 of the parabola through points with known errors, as in ang_line_fit.
 * Errors: those of ang_line_fit, RP_NO_RESULT for fewer than three different x. */
rp_status ang_bend(size_t n, const double x[], const double y[], const double se[], ang_contrast *bend);

/* ---- piles against theory (compare.c) ---- */

/* Standard errors are bootstrapped over piles. */
typedef struct {
    double value, se;
} ang_estimate;

/* Piles of one friction coefficient against (3) and (4). Estimates are NaN where the form has no theta_t. */
typedef struct {
    ang_stats theta_r, theta_t, theta_rt; /* rt: the sum, pile by pile */
    double theta_ms;                      /* (3) */
    ang_estimate diff_ms;                 /* theta_rt - theta_ms */
    size_t n_unstable;                    /* piles steeper than theta_ms */
    size_t n_lost;                        /* resamples without theta_t, left out (the worst form's) */
    struct {
        ang_tilt_status status;
        ang_estimate theta_t;  /* (4) at the mean theta_r */
        ang_estimate diff;     /* mean measured theta_t minus that */
        ang_estimate theta_rt; /* mean theta_r plus that */
        /* magnitude of diff less that of diff_ms, and the same with each over its measured angle: negative
         * where (4) is nearer to the measurement than (3), the claim of Fig. 7 */
        ang_estimate gain, gain_relative;
    } form[ANG_N_FORMS];
} ang_comparison;

/* theta_r[n], theta_t[n]: measured, one pile an index; mu in [0, inf], phi in (0, pi/2), n_resamples >= 2.
 * Standard errors are NaN for n = 1. Errors: RP_NO_RESULT for n = 0, those of ang_mean and ang_tilt. */
rp_status ang_compare(size_t n, const double theta_r[], const double theta_t[], double mu, double phi,
                      size_t n_resamples, gsl_rng *rng, ang_comparison *comparison);

/* ---- inclination of the rays, fitted to piles (phi.c) ---- */

/* Piles of one friction coefficient: theta_r[n] and theta_t[n], one pile an index. Borrowed. */
typedef struct {
    double mu; /* (0, inf) */
    size_t n;  /* at least ANG_PHI_PILES */
    const double *theta_r, *theta_t;
} ang_piles;

enum { ANG_PHI_PILES = 5 };

/* What phi is fitted to: (3) at theta_r + theta_t, or (4) in a form whose forces balance; and by how much phi
 * of (4) exceeds that of (3), on the same piles. */
typedef enum {
    ANG_AGAINST_MARGINAL,
    ANG_AGAINST_BALANCED,
    ANG_AGAINST_LATTICE,
    ANG_BALANCED_LESS_MARGINAL,
    ANG_LATTICE_LESS_MARGINAL,
    ANG_N_AGAINST
} ang_against;

typedef struct {
    double phi;              /* or the difference of two */
    double lo, hi;           /* 95 % by the profile of chi2: a rise by 3.84; NaN for a difference */
    double boot_lo, boot_hi; /* 95 % by bootstrap over piles, percentiles */
    /* chi2 of one phi for all groups, its degrees of freedom, and the chance of a larger one (NaN without
     * dof); of a difference: of none, by its bootstrapped error */
    double chi2, p_value;
    size_t dof;
    bool lo_open, hi_open; /* no rise by 3.84 before phi ends: the data give no bound on this side */
} ang_phi;

const char *ang_against_word(ang_against against);

/* How far phi is from the piles: minus twice the logarithm of the likelihood ratio, see phi.c. `against` is
 * an equation; phi in (theta_r + theta_t of every mean, pi/2): the flank of a failing pile is less steep than
 * the rays. Errors: RP_BAD_INPUT (a value, fewer than ANG_PHI_PILES piles), RP_NO_RESULT (piles without
 * spread). */
rp_status ang_phi_misfit(size_t n_groups, const ang_piles groups[], ang_against against, double phi,
                         double *chi2);

/* The phi that serves all groups best, against each equation, and the differences. n_resamples >= 2.
 * Errors: as ang_phi_misfit; RP_NO_RESULT for no groups or piles steeper than any ray; RP_NO_MEMORY;
 * RP_BROKEN (NLopt). */
rp_status ang_phi_fit(size_t n_groups, const ang_piles groups[], size_t n_resamples, gsl_rng *rng,
                      ang_phi fit[ANG_N_AGAINST]);

/* ---- measured stress (stress.c) ---- */

/* The force (fx, fy) on a grain with centre (x, y), by a grain with centre (x_b, y_b) or at that point of a
 * wall. */
typedef struct {
    double x, y, x_b, y_b, fx, fy;
} ang_contact;

/* s_ab, compression positive; the force that the side of a plane to which its normal n points puts on the
 * other is -s_ab n_b. Grains that cannot turn need no balance of torques: xy and yx differ. */
typedef struct {
    double xx, xy, yx, yy;
} ang_tensor;

/* nx times ny cells of width dx and height dy, from (x0, y0); cell (i, j) has number j nx + i. */
typedef struct {
    double x0, y0, dx, dy;
    size_t nx, ny;
} ang_grid;

/* Mean stress of each cell, force/length: the sum over contacts of force times branch, as far as the branch
 * lies in the cell, over the cell's area (Goldhirsch 2010 with the cell as the kernel; branches end at
 * walls). Summed over cells that hold all branches, area times stress is the sum of force times branch.
 * Errors: RP_BAD_INPUT (a grid without cells, a number that is not finite). */
rp_status ang_stress_cells(size_t n, const ang_contact contacts[], const ang_grid *grid, ang_tensor stress[]);

/* Mohr's circle of a stress. */
typedef struct {
    double pressure;  /* its centre: mean of the principal stresses of the symmetric part */
    double shear;     /* its radius */
    double couple;    /* (xy - yx)/2, which shifts it: traction without torque balance */
    double direction; /* of the largest compression, from x, in (-pi/2, pi/2] */
    double mobilised; /* greatest angle between traction and normal over all planes, see stress.c; pi/2 where
                         a plane pulls, NaN without stress */
} ang_mohr;
ang_mohr ang_stress_mohr(const ang_tensor *stress);

/* Response of a pile to tilt, per weight of the pile normal to the floor. With t = tan of the tilt: floor
 * forces n[0] + n[1] t (normal) and h[0] + h[1] t (along it, by the pile, down the tilt), and the stress
 * s[0] + s[1] t in the pile, up to a factor. */
typedef struct {
    double n[2], h[2];
    ang_tensor s[2];
} ang_response;

/* Tilt at which the floor has to give the friction mu, h = mu n; negative if it already does more. NaN if it
 * never comes to that below pi/2. */
double ang_floor_tilt(const ang_response *response, double mu);

/* Tilt nearest to 0 at which the stress mobilises the angle `friction`, with this sign; within +-pi/4, NaN if
 * there is none. */
double ang_bulk_tilt(const ang_response *response, double friction);

/* Mobilised angle at a tilt. */
double ang_bulk_mobilised(const ang_response *response, double tilt);

typedef struct {
    double value, se, lo, hi; /* error and 95 % interval by bootstrap over piles; NaN if a tenth of it is */
} ang_interval;

/* Critical tilts of the mean response of n piles of one mu, beside the tilt at which they moved. Frictions
 * are the tangents of mobilised angles. */
#define ANG_CRITICAL_LIST(X)                                                                                 \
    X(floor_friction_0, false) /* on the floor, without tilt */                                              \
    X(bulk_friction_0, false)  /* inside, without tilt */                                                    \
    X(floor_tilt, true)        /* the floor's friction comes to mu */                                        \
    X(bulk_tilt, true)         /* that inside comes to mu; negative: is beyond it without tilt */            \
    X(theta_t, true)           /* measured */                                                                \
    X(floor_less, true)        /* floor_tilt less measured */                                                \
    X(floor_friction_t, false) /* on the floor, at the measured theta_t */                                   \
    X(bulk_friction_t, false)  /* inside, at the measured theta_t */                                         \
    X(rank, false)             /* Spearman's correlation of the piles' own floor_tilt and theta_t */
typedef struct {
#define X(name, angle) ang_interval name;
    ANG_CRITICAL_LIST(X)
#undef X
} ang_critical;

/* Errors: RP_NO_RESULT for n < 3, RP_BAD_INPUT for a number that is not finite or n_resamples < 2,
 * RP_NO_MEMORY. */
rp_status ang_critical_tilts(size_t n, const ang_response responses[], const double theta_t[], double mu,
                             size_t n_resamples, gsl_rng *rng, ang_critical *critical);

/* ---- published numbers against combinations of unsaid choices (forensics.c) ---- */

/* One published statement about a number y that a model predicts. */
typedef struct {
    enum { ANG_CLAIM_VALUE, ANG_CLAIM_SIGN } kind;
    double value; /* VALUE: the number published; SIGN: -1 where y is said to be negative, +1 positive */
    double error; /* the published +-, known up to a scale common to all claims */
} ang_claim;

/* Logarithm of the likelihood of the claims if the model gives y[k] +- se[k], averaged over the scale of the
 * published errors, log-uniform from 1/5 to 2. */
double ang_claims_log_likelihood(size_t n, const ang_claim claims[], const double y[], const double se[]);

/* p_value: the share of data that the combination itself would publish with at most this likelihood;
 * excluded: the likelihood is below `limit`, which a share `level` of those data is. A combination with a
 * y that is not finite is not `complete`, and excluded. */
typedef struct {
    bool complete, excluded;
    double log_likelihood, limit, p_value;
} ang_agreement;

/* Combinations that pass claims put together from the numbers of unrelated combinations: how many on average,
 * and in which share of the draws at least as many as pass the claims themselves. */
typedef struct {
    double mean, as_many;
} ang_chance;

/* Judge combinations by the numbers y[c * n + k] +- se[c * n + k] that combination c gives for claim k, by
 * n_draws simulated publications each, and count chance in n_chance draws (0: NaN).
 * Errors: RP_NO_RESULT (no claims), RP_BAD_INPUT, RP_NO_MEMORY. */
rp_status ang_claims_judge(size_t n_combinations, size_t n, const ang_claim claims[], const double y[],
                           const double se[], double level, size_t n_draws, size_t n_chance, gsl_rng *rng,
                           ang_agreement agreement[], ang_chance *chance);

/* Change of y from a factor's level 0 to another; 95 % interval and p-value by Student's t. */
typedef struct {
    double effect, se, lo, hi, p_value;
} ang_effect;

/* Main effects by least squares: y[i] of combination i with factor f at level[i * n_factors + f] <
 * n_levels[f]. effects[]: levels 1, 2, ... of factor 0, then of factor 1, ... The residual, *residual_sd,
 * holds noise and whatever the factors do together. Errors: RP_NO_RESULT for too few combinations or
 * factors that they do not tell apart, RP_NO_MEMORY. */
rp_status ang_effects(size_t n, size_t n_factors, const size_t level[], const size_t n_levels[],
                      const double y[], ang_effect effects[], double *residual_sd);

#endif
