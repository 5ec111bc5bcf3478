/* Power of a test, and the number of values that a power needs, from the errors of a pilot. Plain numbers. */
#ifndef STATS_SAMPLESIZE_H
#define STATS_SAMPLESIZE_H

#include "core/status.h"

RP_C_BEGIN

/* A test decides where an estimate lies between `from` and `to` by so many of its standard errors, at both
 * ends: quantile `level` of Student's t if the error is estimated, `known` if it is known. Infinite: no end.
 * The two one-sided tests of equivalence have from = -margin, to = margin. */
typedef struct {
    double from, to, level, known;
} stats_rule;

/* The error of an estimate in a pilot: se, which falls as the root of the number of values; its degrees of
 * freedom, which grow as n - 1 (infinite: se is known); and an error that more values do not change, known,
 * such as that of a published number. */
typedef struct {
    double se, n, dof, fixed;
} stats_pilot;

/* Chance that the test decides with n values, if the truth is `effect`. The estimate is normal, and the
 * square of its estimated error is chi^2. n may be infinite. NaN for a pilot with NaN. */
double stats_power(const stats_rule *rule, const stats_pilot *pilot, double effect, double n);

/* The least whole n >= 2 with at least this power; infinite where the fixed error or the rule allows none,
 * or beyond a thousand million. NaN for a pilot with NaN. */
double stats_sample_size(const stats_rule *rule, const stats_pilot *pilot, double effect, double power);

RP_C_END

#endif
