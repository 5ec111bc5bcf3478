/* Published numbers against combinations of choices that a publication leaves open. */
#ifndef STATS_FORENSICS_H
#define STATS_FORENSICS_H

#include <gsl/gsl_rng.h>
#include <stdbool.h>
#include <stddef.h>

#include "core/status.h"

RP_C_BEGIN

/* One published statement about a number y that a model predicts. */
typedef struct {
    enum { STATS_CLAIM_VALUE, STATS_CLAIM_SIGN } kind;
    double value; /* VALUE: the number published; SIGN: -1 where y is said to be negative, +1 positive */
    double error; /* the published +-, known up to a scale common to all claims; 0 for a sign without one */
} stats_claim;

/* Logarithm of the likelihood of the claims if the model gives y[k] +- se[k], averaged over the scale of the
 * published errors, log-uniform from 1/5 to 2. */
double stats_claims_log_likelihood(size_t n, const stats_claim claims[], const double y[], const double se[]);

/* p_value: the share of data that the combination itself would publish with at most this likelihood;
 * excluded: the likelihood is below `limit`, which a share `level` of those data is. A combination with a
 * y that is not finite is not `complete`, and excluded. */
typedef struct {
    bool complete, excluded;
    double log_likelihood, limit, p_value;
} stats_agreement;

/* Combinations that pass claims put together from the numbers of unrelated combinations: how many on average,
 * and in which share of the draws at least as many as pass the claims themselves. */
typedef struct {
    double mean, as_many;
} stats_chance;

/* Judge combinations by the numbers y[c * n + k] +- se[c * n + k] that combination c gives for claim k, by
 * n_draws simulated publications each, and count chance in n_chance draws (0: NaN).
 * Errors: RP_NO_RESULT (no claims), RP_BAD_INPUT, RP_NO_MEMORY. */
rp_status stats_claims_judge(size_t n_combinations, size_t n, const stats_claim claims[], const double y[],
                             const double se[], double level, size_t n_draws, size_t n_chance, gsl_rng *rng,
                             stats_agreement agreement[], stats_chance *chance);

/* Change of y from a factor's level 0 to another; 95 % interval and p-value by Student's t. */
typedef struct {
    double effect, se, lo, hi, p_value;
} stats_effect;

/* Main effects by least squares: y[i] of combination i with factor f at level[i * n_factors + f] <
 * n_levels[f]. effects[]: levels 1, 2, ... of factor 0, then of factor 1, ... The residual, *residual_sd,
 * holds noise and whatever the factors do together. Errors: RP_NO_RESULT for too few combinations or
 * indistinguishable factors, RP_NO_MEMORY. */
rp_status stats_effects(size_t n, size_t n_factors, const size_t level[], const size_t n_levels[],
                        const double y[], stats_effect effects[], double *residual_sd);

RP_C_END

#endif
