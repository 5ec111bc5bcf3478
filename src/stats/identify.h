/* Parameters of a simulation from numbers that were measured: one to three names, several numbers.
 *
 * Runs at the points of a Sobol sequence give each number as a full quadratic of the names (of one name a
 * cubic), of a higher degree where the runs ask for it, by least squares with the scatter of the runs at
 * equal points. Where these agree with what was measured, a smaller box gets further points, until it no
 * longer shrinks, the form fits, and the fit's error is small. Of a form that the runs reject nothing is
 * told. The answer holds for the model that ran, and no other. */
#ifndef STATS_IDENTIFY_H
#define STATS_IDENTIFY_H

#include <stdbool.h>
#include <stddef.h>

#include "core/status.h"

RP_C_BEGIN

enum { STATS_NAMES = 3, STATS_NUMBERS = 16, STATS_TERMS = 36 };

/* What runs give at a point, of one number: how many had it, their mean, and sum of squares about it. */
typedef struct {
    double n, mean, squares;
} stats_runs;

#define STATS_IDENTIFIED_LIST(X)                                                                             \
    X(OK, "ok", "determined, with an interval inside the range")                                             \
    X(AT_LEAST, "at_least", "the interval reaches the upper end of the range: only the lower limit holds")   \
    X(AT_MOST, "at_most", "the interval reaches the lower end of the range: only the upper limit holds")     \
    X(NOT_IDENTIFIED, "not_identified", "the interval covers nine tenths of the range or more")              \
    X(SEVERAL, "several", "separate intervals agree with what was measured")                                 \
    X(BUDGET, "budget",                                                                                      \
      "the allowed runs are made without convergence: the interval is what is known so far")                 \
    X(ABOVE_RANGE, "above_range", "the measured value is larger than the fitted one anywhere in the range")  \
    X(BELOW_RANGE, "below_range", "the measured value is smaller than the fitted one anywhere in the range") \
    X(BENT, "bent", "the runs bend more than the polynomial can follow: nothing is known yet")               \
    X(NO_MATCH, "no_match", "no values in the range give all measured values together")                      \
    X(NO_RUNS, "no_runs", "the runs nearest to the best values failed, or lack a measure")
typedef enum {
#define X(name, word, meaning) STATS_IDENTIFIED_##name,
    STATS_IDENTIFIED_LIST(X)
#undef X
} stats_identified;
extern const char *const stats_identified_words[], *const stats_identified_meanings[];

/* An interval of a name, and the best value in it. */
enum { STATS_INTERVALS = 4 };
typedef struct {
    double value, lower, upper;
} stats_interval;

typedef struct {
    stats_identified status[STATS_NAMES];
    double x[STATS_NAMES], se[STATS_NAMES];
    double lo[STATS_NAMES], hi[STATS_NAMES]; /* the range, less ends where no run has the numbers */
    /* of 95 %, from below; own: the one that holds x */
    size_t n_intervals[STATS_NAMES];
    stats_interval interval[STATS_NAMES][STATS_INTERVALS], own[STATS_NAMES];
    double correlation[STATS_NAMES][STATS_NAMES];
    double ends[2][STATS_NAMES]; /* the best places at both ends of the widest interval */
    double chi2;
    size_t dof; /* numbers less names, at least 0 */
    /* each number: what the fit gives there, its error and the form's lack of fit, p of that */
    double fitted[STATS_NUMBERS], fit_error[STATS_NUMBERS], p_value[STATS_NUMBERS];
    double reach[STATS_NUMBERS][2]; /* least and largest mean of a point */
    size_t n_next;                  /* runs that the next stage would have taken, where the budget ended it */
    /* failed: points without a run that has every number; repeated: points with several runs */
    size_t stages, n_points, n_failed, n_repeated, n_runs;
    size_t tried, recovered; /* design points that are left out, and found again */
    /* the combination of the names that is determined best: sum of weight x = value +- error, if what agrees
     * is not bent, and not at an end of a range */
    bool determined;
    double weight[STATS_NAMES], sum, sum_error;
} stats_answer;

typedef struct {
    size_t n_names, n_numbers, n_groups;
    double lo[STATS_NAMES], hi[STATS_NAMES];
    /* measured values, their standard errors; group[k]: which runs give number k */
    double value[STATS_NUMBERS], error[STATS_NUMBERS];
    size_t group[STATS_NUMBERS];
    bool fixed_runs; /* there are no further ones: `run` is called once, and says how many points it has */
    size_t budget;   /* most runs */
    bool leave_out;  /* look for each design point by the others: takes longest */
    void *host;
    /* May a point be asked for? NULL: any of the ranges. */
    bool (*allowed)(void *host, const double x[]);
    /* Make the runs of a stage, from 0: n points of n_names coordinates each, replicas[group] at each.
     * *runs becomes an array of the host's, which lives until the next call: number k at a point is runs[k n
     * + point]. With fixed_runs: *n and *x are the host's own too. */
    rp_status (*run)(void *host, size_t stage, size_t *n, const double **x, const size_t replicas[],
                     stats_runs **runs);
    /* What is known after a stage. NULL: nobody asks. */
    void (*tell)(void *host, const stats_answer *so_far);
} stats_quest;

/* Points of the first stage, and its runs of all groups. Errors: RP_BAD_INPUT (beyond the budget). */
rp_status stats_first_stage(const stats_quest *quest, size_t *points, size_t *runs);

/* Errors: RP_BAD_INPUT (numbers of names or numbers, no range, a value, an error of 0, too few points),
 * RP_NO_RESULT (too few points with numbers), RP_NO_MEMORY, RP_BROKEN, those of `run`. A budget that ends the
 * search is a status. */
rp_status stats_identify(const stats_quest *quest, stats_answer *answer);

RP_C_END

#endif
