/* Calibration: from measured angles of a pile back to the parameters of its grains.
 *
 * The response, angle against parameter, is fitted to simulated piles; then those parameters are sought at
 * which the response agrees with the measurement. One or two parameters, one or two angles; any unit of
 * angle, the same throughout. What is found holds for the model and the protocol of the piles, and for no
 * other. */
#ifndef STATS_CALIBRATE_H
#define STATS_CALIBRATE_H

#include <gsl/gsl_rng.h>
#include <stdbool.h>
#include <stddef.h>

#include "core/status.h"

RP_C_BEGIN

enum {
    STATS_MAX_PARAMS = 2,
    STATS_MAX_ANGLES = 2,
    STATS_MAX_TERMS = 16,
    STATS_SD_TERMS = 5,
    STATS_MAX_SOLUTIONS = 4
};

/* n piles: parameters x[p][pile] and angles angle[a][pile], NaN where a pile has no such angle. */
typedef struct {
    size_t n, n_params, n_angles;
    const double *x[STATS_MAX_PARAMS], *angle[STATS_MAX_ANGLES];
} stats_ensemble;

typedef enum { STATS_POWERS, STATS_EXPONENTIAL, STATS_TANH } stats_shape;

/* One angle against the parameters: a sum of terms f_i(x) y^j, with x the first parameter and y the second,
 * each taken from -1 to 1 over its range in powers. f_i, i up to the degree: powers of x; or 1, exp(-(x -
 * lo)/scale), x; or 1, tanh(x/scale), x. */
typedef struct {
    stats_shape shape;
    size_t degree[STATS_MAX_PARAMS]; /* of a parameter that there is not: 0 */
    size_t n_points, n_terms, dof;
    double lo[STATS_MAX_PARAMS], hi[STATS_MAX_PARAMS]; /* range of the piles' parameters */
    double scale;
    double coefficients[STATS_MAX_TERMS], covariance[STATS_MAX_TERMS * STATS_MAX_TERMS];
    double chi2, p_value, aic;
    /* variance of the response about the form, for lack of fit: the excess of chi2/dof over 1 in units of the
     * points' own variance n_points/sum(weights); the covariance grows by the factor chi2/dof */
    double discrepancy;
    bool monotone; /* in the first parameter; true with two parameters, not tested there */
} stats_response_fit;

/* Piles with equal parameters x: mean, sd and number of those that have the angle. */
typedef struct {
    double x[STATS_MAX_PARAMS], mean[STATS_MAX_ANGLES], sd[STATS_MAX_ANGLES], number[STATS_MAX_ANGLES];
    size_t first; /* its piles are pile[first] and so on, up to the next point's first */
} stats_point;

/* The responses of all angles, and the points behind them. */
typedef struct {
    size_t n_params, n_angles, n_points;
    double lo[STATS_MAX_PARAMS], hi[STATS_MAX_PARAMS]; /* range of the piles' parameters */
    stats_response_fit response[STATS_MAX_ANGLES];
    double log_variance[STATS_MAX_ANGLES][STATS_SD_TERMS]; /* of piles: 1, x, x^2, y, y^2 */
    double correlation;                                    /* of the two angles of a pile, within its point */
    stats_point *point;                                    /* n_points, and one more that ends them */
    size_t *pile;
} stats_calibration;

/* What was measured; error: its standard error, >= 0. Two angles are of the same piles: their errors are as
 * correlated as the angles of simulated piles. */
typedef struct {
    double angle[STATS_MAX_ANGLES], error[STATS_MAX_ANGLES];
} stats_measured;

#define STATS_CALIBRATED_LIST(X)                                                                             \
    X(OK, "ok", "found, with an interval inside the response's range")                                       \
    X(AT_LEAST, "at_least", "the interval reaches the upper end of the range: only the lower limit holds")   \
    X(AT_MOST, "at_most", "the interval reaches the lower end of the range: only the upper limit holds")     \
    X(NOT_IDENTIFIED, "not_identified", "every value of the range agrees with the measurement")              \
    X(SEVERAL, "several", "separate intervals agree with the measurement")                                   \
    X(UNDERDETERMINED, "underdetermined", "more parameters than angles: limits, no value")                   \
    X(ABOVE_RANGE, "above_range", "the angle is larger than the response anywhere in the range")             \
    X(BELOW_RANGE, "below_range", "the angle is smaller than the response anywhere in the range")            \
    X(NO_MATCH, "no_match", "no parameters of the range give both angles together")

typedef enum {
#define X(name, word, meaning) STATS_CALIBRATED_##name,
    STATS_CALIBRATED_LIST(X)
#undef X
} stats_calibrated_status;

/* One parameter. Each solution has its 95 % interval; a limit that the range cuts off is NaN, and so is
 * the first solution where there is none. se: by the delta method. boot_*: standard error and percentile
 * interval of the bootstrap, a check of both. */
typedef struct {
    stats_calibrated_status status;
    double value, se;
    size_t n_solutions;
    struct {
        double value, lower, upper;
    } solutions[STATS_MAX_SOLUTIONS];
    double boot_se, boot_lower, boot_upper;
} stats_calibrated;

extern const char *const stats_calibrated_words[];
extern const char *const stats_calibrated_meanings[];
extern const char *const stats_shape_words[];

/* Fit the coefficients of a response, whose form is set, to y[] at the points; NULL: their means.
 * Errors: RP_NO_RESULT (the scale is not determined), RP_NO_MEMORY, RP_BROKEN. */
rp_status stats_response_solve(stats_response_fit *r, const stats_calibration *c, size_t angle,
                               const double y[]);

/* Fit the responses: least squares with the weights n/SD^2 of the points, SD from stats_calibration_sd. The
 * form with the least AIC, chi2 + 2k with k coefficients, is taken (the points' errors are known, of their
 * piles, so few points need no correction): powers up to the fourth, exponential, tanh (the second
 * parameter: powers up to the second). With one parameter a form that rises or falls throughout goes before
 * any other whose AIC is not better by more than 6. Free with stats_calibration_free, also after an error.
 * Errors: RP_BAD_INPUT (fewer than 4 points with piles, a point with one pile or without spread, parameters
 * that do not fill a rectangle), RP_NO_MEMORY, RP_BROKEN. */
rp_status stats_calibration_fit(const stats_ensemble *piles, stats_calibration *c);
void stats_calibration_free(stats_calibration *c);

/* The fitted angle at x, and the variance of the fit and of the discrepancy; NULL: not asked for. */
double stats_response_value(const stats_response_fit *response, const double x[], double *variance);

/* The least and the largest fitted angle over the whole range of the parameters, and where they are. */
typedef struct {
    double angle[2], at[2][STATS_MAX_PARAMS];
} stats_reach;
stats_reach stats_calibration_reach(const stats_calibration *c, size_t angle);

/* SD of an angle over piles at x: a parabola in each parameter through the logarithms of the points'
 * variances, since the variance of a dozen piles alone is too uncertain for a weight. */
double stats_calibration_sd(const stats_calibration *c, size_t angle, const double x[]);

/* Find the parameters. chi2(x) compares angle and response, with the variances of both. The 95 % interval of
 * a parameter holds the values at which the smallest chi2 over the other one exceeds the least of all by at
 * most 3.84. There is no match at all if the least chi2 has a chance below 1 %. Errors: RP_BAD_INPUT,
 * RP_BROKEN. */
rp_status stats_calibration_invert(const stats_calibration *c, const stats_measured *measured,
                                   stats_calibrated result[]);

/* Fill in boot_* of the parameters that have a value: piles of each point are drawn anew, the response, of
 * the same form, is fitted anew, and the measurement is drawn from its error. n_resamples >= 2. Errors:
 * RP_BAD_INPUT, RP_NO_MEMORY, RP_BROKEN. */
rp_status stats_calibration_bootstrap(const stats_ensemble *piles, const stats_calibration *c,
                                      const stats_measured *measured, size_t n_resamples, gsl_rng *rng,
                                      stats_calibrated result[]);

RP_C_END

#endif
