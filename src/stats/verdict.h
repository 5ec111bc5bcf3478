/* Verdicts on published claims. Plain numbers in, one word out: whatever says "reproduced" asks here.
 *
 * Every test but the bounds on exact numbers has three outcomes, so that too few piles give `undecided` and
 * never `reproduced`. Two standard errors decide on numbers, 5 % on p-values. */
#ifndef STATS_VERDICT_H
#define STATS_VERDICT_H

#include <stdbool.h>
#include <stddef.h>

#include "core/status.h"

RP_C_BEGIN

typedef enum {
    STATS_REPRODUCED,
    STATS_NOT_REPRODUCED,
    STATS_UNDECIDED,
    STATS_UNTESTABLE,
    STATS_BY_EYE,  /* a picture without a number */
    STATS_NO_DATA, /* the table that answers is not there */
    STATS_VERDICTS
} stats_verdict;

/* "reproduced", "not reproduced", "undecided", "can't be tested", "by eye", "no data". */
extern const char *const stats_verdict_texts[];

/* A number and its standard error: 0 for an exact number, NaN for an unknown error. */
typedef struct {
    double value, se;
} stats_number;

/* The mean of n values, its standard error scaled so that two of it are the 95 % interval by Student's t: the
 * scatter of few values is itself uncertain. n < 2 or NaN, not a mean of values: unchanged. */
stats_number stats_of_few(stats_number mean, double n);

/* Standard error of the standard deviation of n values with a normal distribution, sd/sqrt(2 (n - 1)); NaN
 * for n < 2. */
double stats_deviation_error(double sd, double n);

/* Ours against a published number whose printed +- may be a standard error or a standard deviation. */
typedef struct {
    stats_verdict verdict; /* of both readings; undecided where they differ */
    stats_verdict error;   /* read as a standard error */
    stats_verdict
        deviation; /* read as a standard deviation of `samples` values; same as error without samples */
    double z_error, z_deviation; /* difference over its standard error */
} stats_match;

/* Agreement: not reproduced where the two differ by more than two standard errors of the difference;
 * reproduced where they do not, and two standard errors are at most `margin`: a test that could not see a
 * difference of `margin` is undecided. samples = 0: one reading; margin = INFINITY: any error will do. */
stats_match stats_agree(stats_number ours, stats_number published, double samples, double margin);

/* Chance of a difference of |z| standard errors if there is none; and the same match with these chances, of
 * each reading, corrected for other tests: a difference that is then not significant is undecided. */
double stats_agree_p(double z);
stats_match stats_agree_by_p(stats_match match, double p_error, double p_deviation);

/* Inequality: a above b (sign = 1) or below it (-1) by more than two standard errors of the difference. Not
 * reproduced if the opposite is, or if the 90 % interval of the difference lies within +-margin; INFINITY: no
 * margin. */
stats_verdict stats_exceed(stats_number a, stats_number b, int sign, double margin);

/* Chance of so large a difference if there is none, and of so small a one if the true one is the margin, NaN
 * for exact numbers; and the same verdict with these chances corrected for other tests: a difference is
 * significant where its chance is below that of two standard errors. */
double stats_exceed_p(stats_number a, stats_number b);
double stats_exceed_p_margin(stats_number a, stats_number b, double margin);
stats_verdict stats_exceed_by_p(stats_number a, stats_number b, int sign, double p, double p_margin);

/* A number without an error at least (sign = 1) or at most (-1) the limit. NaN: undecided. */
stats_verdict stats_bound(double value, double limit, int sign);

/* Change of a quantity over the range of what it may depend on: 90 % interval, p-value of no change. */
typedef struct {
    double lo90, hi90, p_value;
} stats_change;

/* Equivalence: reproduced if the 90 % interval lies within +-margin (two one-sided tests at 5 %); not
 * reproduced if it does not and there is a change; else undecided. */
stats_verdict stats_equivalent(const stats_change *change, double margin);

/* The same by p-values that are corrected for other tests: of a change as small if the true one is the
 * margin, and of no change. */
stats_verdict stats_equivalent_by_p(double p_margin, double p_value);

/* Trend: a significant rise (sign = 1) or fall (-1). Not reproduced if the opposite is significant, or if no
 * change is and the 90 % interval lies within +-margin. */
stats_verdict stats_trends(const stats_change *change, int sign, double margin);

/* One number behind n published ones, by chi^2: reproduced if p >= 5 %, under both readings of the +-.
 * Verdicts and, as z_error and z_deviation, the p-values. samples = 0: one reading. */
stats_match stats_constant(size_t n, const stats_number published[], double samples);

/* Order of magnitude: reproduced if the quotient lies within `factor` of 1 by two standard errors, not
 * reproduced if it lies outside by as much. factor > 1. */
stats_verdict stats_order(stats_number quotient, double factor);

/* a/b with independent errors. */
stats_number stats_quotient(stats_number a, stats_number b);

/* Whether its own data reject a fit, by the chance of a larger chi^2: p_fit < 5 %. NaN, no such chance:
 * false. */
bool stats_fit_rejected(double p_fit);

/* How many of each verdict. */
void stats_count_verdicts(size_t n, const stats_verdict verdicts[], size_t counts[STATS_VERDICTS]);

RP_C_END

#endif
