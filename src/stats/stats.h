/* Statistics of plain arrays of numbers: ensembles, straight lines, series in time, trends, equivalence. */
#ifndef STATS_STATS_H
#define STATS_STATS_H

#include <stdbool.h>
#include <stddef.h>

#include "core/status.h"

RP_C_BEGIN

/* A number and its standard error: 0 for an exact number, NaN for an unknown error. */
typedef struct {
    double value, se;
} stats_number;

/* ---- ensembles (ensemble.c) ---- */

/* sd, se and the 95 % interval (Student's t) are NaN for n = 1. */
typedef struct {
    size_t n;
    double mean, sd, se, lo, hi;
} stats_summary;

/* Errors: RP_BAD_INPUT for a value that is not finite. */
rp_status stats_check_finite(size_t n, const double v[]);

/* The power of two next below a magnitude, or 1: divided by it, squares neither overflow nor vanish. */
double stats_unit(double most);

/* Errors: RP_NO_RESULT for n = 0 or a sum that overflows, RP_BAD_INPUT for a value that is not finite; then
 * every field is NaN. */
rp_status stats_mean(size_t n, const double v[], stats_summary *stats);

/* The same for a[i] + factor b[i]: paired differences (-1) and sums (+1). */
rp_status stats_paired(size_t n, const double a[], double factor, const double b[], stats_summary *stats);

/* The summary of all values of n ensembles, from theirs. */
stats_summary stats_pooled(size_t n, const stats_summary parts[]);

/* Pearson's correlation of n pairs; the 95 % interval by Fisher's transformation. */
typedef struct {
    size_t n;
    double value, se, lo, hi;
} stats_correlation;

/* Errors: RP_NO_RESULT for n < 4, values that are all equal, or squares that overflow, RP_BAD_INPUT for a
 * value that is not finite. */
rp_status stats_correlate(size_t n, const double x[], const double y[], stats_correlation *correlation);

/* Standard deviation of a statistic over its resamples sample[n], of which NaN is left out, and *used counts
 * the others, sorted to the front; NaN below two of them. */
double stats_resampled(size_t n, double sample[], size_t *used);

/* ---- one series in time (series.c) ---- */

typedef struct {
    size_t n;
    double mean, sd;
    double se, se_error; /* standard error of the mean, and the standard error of that */
    double tau;          /* integrated correlation time in samples; 1/2 if uncorrelated: n/(2 tau) count */
    size_t block;        /* samples in a block on the plateau */
} stats_series;

/* Mean of a correlated series by blocking (Flyvbjerg & Petersen 1989): neighbours are averaged, again and
 * again, until the blocks' scatter gives a standard error that no longer grows. That plateau is taken to be
 * the first block length B with B^3 > 2 n (se_B/se_1)^4, where the error that is left in se_B by correlation
 * between blocks equals its statistical one (Lee et al. 2011). work[n] is work space. The interval of 95 % is
 * that of Student's t with a degree of freedom less than the n/block blocks.
 * Neighbours of correlation r tell by themselves that se is se_B sqrt((1 + r)/(1 - r)). The largest of these,
 * over the lengths up to the plateau of which 16 blocks fit in, says whether the series is too short: fewer
 * than 16 values are independent. Of fewer than 20 blocks, se is not below it.
 * Errors: RP_BAD_INPUT for a value that is not finite; RP_NO_RESULT (mean and, of two values or more, sd are
 * set) for fewer than 16 values, for fewer than 16 independent ones, and where fewer than four blocks fit in:
 * the series is too short for its correlation. */
rp_status stats_blocking(size_t n, const double v[], double work[], stats_series *series);

/* Where a series levels off: the start `from`, 0 <= from < n/2, that makes the standard error of the mean of
 * the rest smallest as if it were uncorrelated, sum (v - mean)^2/(n - from)^2 (MSER, White 1997).
 * Errors: RP_BAD_INPUT; RP_NO_RESULT for n < 4, and for one that still goes at half its length. */
rp_status stats_level_off(size_t n, const double v[], size_t *from);

/* ---- trends, and that there is none (trend.c) ---- */

/* An estimate with its standard error and the degrees of freedom of that; infinite: the error is known. */
typedef struct {
    double value, se, dof;
} stats_contrast;

/* Interval that covers the truth in the share `level` of all cases. */
void stats_contrast_interval(const stats_contrast *c, double level, double *lo, double *hi);

/* Two-sided chance of such a value, or a larger one, if the truth is 0. */
double stats_contrast_p(const stats_contrast *c);

/* Two one-sided tests (TOST): chance of a value as small if the truth is `margin` or more, either way. Below
 * 0.05 just where the interval of 90 % lies within the margin. */
double stats_contrast_p_margin(const stats_contrast *c, double margin);

/* y against x. NaN where there are too few values; `bend` needs three different x. */
typedef struct {
    size_t n, n_x;            /* values used, different x */
    double from, to;          /* least and largest x */
    stats_contrast slope;     /* of the straight line of least squares */
    stats_contrast intercept; /* of the same, at x = 0 */
    stats_contrast bend;      /* coefficient of x^2 of the parabola of least squares */
    stats_contrast change;    /* of the line over the whole range of x */
    stats_contrast pair;      /* the largest difference between the means at two x: larger x less smaller x */
    double p_margin;          /* stats_contrast_p_margin of the change */
    double p_pairs;           /* the largest stats_contrast_p_margin over all pairs of x */
} stats_trend;

/* n values y at x. */
typedef struct {
    size_t n;
    const double *x, *y;
    const double *pile; /* of each value; NULL: values are independent */
    double power;       /* of x, in the weights; 0: ordinary least squares */
    bool log10_x;       /* x are logarithms to base 10, and the weights 10^(power x): any finite x will do */
    double margin;      /* > 0: the largest change that counts as none */
} stats_sample;

/* Least squares on values at two different x or more; errors from the scatter at each x
 * (Welch-Satterthwaite), so that it may differ between the x, and a curve does not count as scatter. Where
 * an x has one value only, from the scatter about the line. Values of the same pile are compared: each
 * contrast is taken pile by pile and then averaged. Piles that lack a value at one of the x are left out. The
 * weights are fixed, so that errors stay exact.
 * Errors: RP_NO_RESULT (fewer than 3 values, 2 x, or 2 whole piles), RP_BAD_INPUT (a value that is not
 * finite, x <= 0 with a power, two values of a pile at one x), RP_NO_MEMORY. */
rp_status stats_trend_fit(const stats_sample *sample, stats_trend *trend);

/* What tests at `level` say: falls or rises if p_value (corrected or not) is below it,
 * no_dependence_within_margin if p_margin is, falls_within_margin or rises_within_margin if both, undecided
 * if none. p_pairs, a far stricter test, is not used. */
const char *stats_trend_word(const stats_trend *trend, double p_value, double level);

/* Holm's correction for n tests; NaN is no test. */
void stats_holm(size_t n, const double p[], double corrected[]);

/* ---- straight lines (lines.c) ---- */

/* n points (x, y). se: standard errors of y, > 0; NULL: not known, all weights are equal. */
typedef struct {
    size_t n;
    const double *x, *y, *se;
} stats_xy;

/* y = intercept + slope x. chi2: sum of squared residuals over se^2, or over 1 without se.
 * p_value: chance of a larger chi2; NaN without se or degrees of freedom. */
typedef struct {
    size_t n, dof;
    double slope, intercept, slope_se, intercept_se, covariance, chi2, p_value;
} stats_line;

/* Straight line by least squares, or with `origin` the line through (0, 0), whose intercept and its errors
 * are 0. Weights 1/se^2; errors follow from se and are not rescaled, or without se from the scatter about the
 * line. Errors: RP_NO_RESULT for fewer points than coefficients, no spread in x, or overflow, RP_BAD_INPUT,
 * RP_NO_MEMORY. */
rp_status stats_line_fit(const stats_xy *points, bool origin, stats_line *line);

/* Least squares of y[n] by p <= n columns, X[n p] row after row. */
typedef struct {
    size_t n, p;
    const double *X, *y;
    const double *w;  /* weights; NULL: all are equal, and errors follow from the scatter */
    double tolerance; /* of a column: if those before it leave more, it counts in the rank */
    /* found: coefficients c[p] and covariance[p p], whose memory is the caller's; chi2 and rank of X */
    double *c, *covariance, chi2;
    size_t rank;
} stats_linear;

/* Errors: RP_BAD_INPUT (p > n, a value that is not finite, a tolerance of 0), RP_NO_MEMORY. */
rp_status stats_linear_fit(stats_linear *fit);

/* ---- least value of a function (least.c) ---- */

typedef double stats_function(const double x[], void *data);

typedef struct {
    stats_function *f;
    void *data;
    size_t n;              /* dimensions, up to three */
    const double *lo, *hi; /* of each; a side with lo = hi is held */
    int cells;             /* of the grid, a side */
    const double *guess;   /* a place near to the least, but for held sides; NULL: unknown */
} stats_minimum;

/* Least value over the box: downhill from the best of the grid, and from the guess or, without one, from the
 * middles of the halves of all sides. Sets x[n] and *value. Errors: RP_BAD_INPUT (n, cells, an end
 * that is not finite). */
rp_status stats_least(const stats_minimum *m, double x[], double *value);

RP_C_END

#endif
