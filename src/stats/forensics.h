/* Inference of choices that a publication leaves open, from the numbers that it gives.
 *
 * A model predicts the published numbers for draws of the choices from their prior, with the covariance of
 * its own error. The likelihood of the published numbers weights the draws: importance sampling, in which
 * what the publication means by its numbers is summed over. */
#ifndef STATS_FORENSICS_H
#define STATS_FORENSICS_H

#include <gsl/gsl_rng.h>
#include <stddef.h>

#include "core/status.h"

RP_C_BEGIN

/* A published number, its +- and the number of samples behind it. */
typedef struct {
    double value, error, samples;
} stats_published;

/* What a publication leaves open about its numbers, each with equal prior: name, levels, meaning. */
#define STATS_LATENT_LIST(X)                                                                                 \
    X(reading, "error | deviation", "the published +- is a standard error, or a standard deviation")         \
    X(shift, "none | common", "the numbers share an error of their own, or not")                             \
    X(stop, "ours | theirs", "runs that stop would not have stopped there, or give no number to publish")
enum {
#define X(name, levels, meaning) STATS_LATENT_##name,
    STATS_LATENT_LIST(X)
#undef X
        STATS_LATENTS,
    STATS_LATENT_LEVELS = 1 << STATS_LATENTS
};

/* Predictions for n_draws draws of the choices, n_surfaces definitions of the measured quantity, which is one
 * more thing left open, and n_points numbers. covariance: of the first definition; the others have
 * it times scale[surface]. log_complete: logarithm of the chance that a draw gives all numbers. */
typedef struct {
    size_t n_draws, n_surfaces, n_points;
    const double *mean;       /* [draw][surface][point] */
    const double *covariance; /* [draw][point][point] */
    const double *scale, *log_complete;
    double shift; /* standard deviation of a common error */
} stats_predictions;

/* Weights of the draws and of all that is left open about the numbers, of sum 1:
 * share[draw][surface][latent], where bit k of the latent is the level of the k-th in the list. log_evidence:
 * of the mean likelihood over the prior; effective: number of independent draws that are worth as much, 1/sum
 * of squared weights of draws; p_value: chance that the model gives numbers as unlikely as the published
 * ones. */
typedef struct {
    size_t n_draws, n_surfaces;
    double *share;
    double log_evidence, effective, p_value;
} stats_posterior;

/* Errors: RP_BAD_INPUT (a number or error that is not finite, an error or a number of samples that is not
 * positive), RP_NO_RESULT (no draw has a likelihood above 0), RP_BROKEN, RP_NO_MEMORY. Free with
 * stats_posterior_free, also after an error. */
rp_status stats_posterior_make(const stats_predictions *model, const stats_published numbers[],
                               stats_posterior *p);
void stats_posterior_free(stats_posterior *p);

/* Logarithm of the likelihood of the numbers for one prediction: a normal density with the covariance of the
 * model, the published error as `latent` reads it, and a common error where it has one. *chi2 (may be NULL):
 * the exponent, -2 times. Errors: RP_BROKEN. */
rp_status stats_log_likelihood(size_t n, const stats_published numbers[], const double mean[],
                               const double covariance[], double scale, double shift, unsigned latent,
                               double *log_likelihood, double *chi2);

/* Mean and variance of the error that all numbers share, given the numbers and one prediction of them; 0 and
 * 0 where `latent` has none. Errors: RP_BROKEN. */
rp_status stats_common_error(size_t n, const stats_published numbers[], const double mean[],
                             const double covariance[], double scale, double shift, unsigned latent,
                             double *error, double *variance);

/* Variance of the error that all numbers share, and of a published +-, as the latents
 * understand them. */
double stats_common_variance(double shift, unsigned latent);
double stats_published_variance(const stats_published *number, unsigned reading);

/* Weights of the draws, weight[n_draws], given a level of a latent, or in all (latent < 0); their sum is the
 * posterior share of that level. */
double stats_posterior_draws(const stats_posterior *p, int latent, unsigned level, double weight[]);

/* Posterior share of a surface. */
double stats_posterior_surface(const stats_posterior *p, size_t surface);

/* Evidence of a level for that of all others, from shares before and after; infinite for a share of 1. */
double stats_bayes_factor(double prior, double share);

/* Value that a share q of the weights lies below. order[n]: work space. Errors: none; NaN for no weight. */
double stats_weighted_quantile(size_t n, const double x[], const double weight[], double q, size_t order[]);

/* k different ones of n draws, each next one with a chance in proportion to its weight (Efraimidis & Spirakis
 * 2006): index[k]. Errors: RP_NO_RESULT (fewer than k draws of a weight), RP_NO_MEMORY. */
rp_status stats_sample(size_t n, const double weight[], size_t k, size_t index[], gsl_rng *rng);

/* Logarithm of the chance of a standard normal below z, if z is normal: mean and variance. */
double stats_log_normal_chance(double mean, double variance);

/* A chance as a normal deviate, with its variance, from k of n cases. Half a case more of each kind keeps it
 * finite. */
void stats_probit(double k, double n, double *deviate, double *variance);

/* A design of n settings: numbers u[i * n_reals + p] in (0, 1) by Sobol's sequence, scrambled by a random
 * digital shift; levels level[f * n + i], each equally often (to one), in random order.
 * Errors: RP_BAD_INPUT, RP_NO_MEMORY. */
enum { STATS_DESIGN_REALS = 16 };
rp_status stats_design(size_t n, size_t n_reals, double u[], size_t n_factors, const size_t n_levels[],
                       size_t level[], gsl_rng *rng);

RP_C_END

#endif
