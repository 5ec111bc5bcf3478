/* Verdicts on published claims. Plain numbers in, one word out: whatever says "reproduced" asks here.
 *
 * Every test but the bounds on exact numbers has three outcomes, so that too few piles leave a claim open and
 * never reproduce it. Two standard errors decide on numbers, 5 % on p-values; what has no finite interval
 * decides nothing. */
#ifndef REPORT_VERDICT_H
#define REPORT_VERDICT_H

#include <stdbool.h>
#include <stddef.h>

#include "stats/stats.h"

typedef enum {
    REPORT_REPRODUCED,
    REPORT_NOT_REPRODUCED,
    REPORT_OPEN,
    REPORT_NO_DATA, /* the table that answers is not there */
    REPORT_VERDICTS
} report_verdict;

/* "reproduced", "not reproduced", "open", "no data"; of a claim of our own "supported", "not supported". */
const char *report_verdict_text(report_verdict verdict, bool own);

/* The mean of n values, its standard error scaled so that two of it are the 95 % interval by Student's t: the
 * scatter of few values is itself uncertain. n < 2 or NaN, not a mean of values: unchanged. */
stats_number report_of_few(stats_number mean, double n);

/* Standard error of the standard deviation of n values with a normal distribution, sd/sqrt(2 (n - 1)); NaN
 * for n < 2. */
double report_deviation_error(double sd, double n);

/* Chances that decide: of such a difference or change if there is none (of an equivalence: if it is the
 * margin), and of one as small if the truth is the margin. NaN: no such test. The tests below take those that
 * a correction for other tests has raised; NULL: each by itself. */
typedef struct {
    double effect, margin;
} report_chances;

/* Agreement: not reproduced where the two differ by more than two standard errors of the difference;
 * reproduced where they do not, and two standard errors are at most `margin`: a test that could not see a
 * difference of `margin` leaves it open, and so does a difference that the correction makes too likely.
 * margin = INFINITY: any error will do. *z: difference over its standard error. */
report_verdict report_agree(stats_number ours, stats_number published, double margin,
                            const report_chances *raised, double *z);

/* Chance of a difference of |z| standard errors if there is none. */
double report_agree_p(double z);

/* Inequality: a above b (sign = 1) or below it (-1) by more than two standard errors of the difference. Not
 * reproduced if the opposite is, or if there is no such difference and one as large as the margin is excluded
 * at 5 %. One that is sure, where the margin is excluded: open. Exact numbers need no chances. */
report_verdict report_exceed(stats_number a, stats_number b, int sign, const report_chances *p);

/* Its chances: of so large a difference, of either sign, if there is none, and of so small a one, or of one
 * against the inequality, if the true one is the margin; NaN for exact numbers, and for a margin of INFINITY.
 */
double report_exceed_p(stats_number a, stats_number b);
double report_exceed_p_margin(stats_number a, stats_number b, int sign, double margin);

/* A number without an error at least (sign = 1) or at most (-1) the limit. Not finite: open. */
report_verdict report_bound(double value, double limit, int sign);

/* Change of a quantity over the range of what it may depend on: 90 % interval, p-value of no change. */
typedef struct {
    double lo90, hi90, p_value;
} report_change;

/* Equivalence: reproduced if the 90 % interval lies within +-margin (two one-sided tests at 5 %), not
 * reproduced if it lies beyond, else open. */
report_verdict report_equivalent(const report_change *change, double margin, const report_chances *raised);

/* Trend: a significant rise (sign = 1) or fall (-1). Not reproduced if the opposite is significant, or if no
 * change is, and one as large as the margin is excluded: the 90 % interval ends before it. A rise or fall
 * that is significant, where the margin is excluded: open. */
report_verdict report_trends(const report_change *change, int sign, double margin,
                             const report_chances *raised);

/* Order of magnitude: reproduced if the quotient lies within `factor` of 1 by two standard errors, not
 * reproduced if it lies outside by as much. factor > 1. */
report_verdict report_order(stats_number quotient, double factor);

/* a/b with independent errors. */
stats_number report_quotient(stats_number a, stats_number b);

/* n differences from published numbers together: chi^2 and its chance, whose 5 % decide; the shift that all
 * have in common, what it leaves of chi^2, and the chance of that. NaN, and open, where one is not known. */
typedef struct {
    double chi2, p, left, p_left;
    stats_number shift;
    report_verdict verdict;
} report_together;
report_together report_joint(size_t n, const stats_number differences[]);

#endif
