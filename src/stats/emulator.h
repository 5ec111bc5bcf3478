/* Emulation: a smooth function of numbers and of factors, learnt from noisy values at a few settings.
 *
 * The function is a Gaussian process: a constant of broad prior, main effects, a part by its kernel, and an
 * independent deviation of each setting. The noise of each value is known. Rasmussen & Williams 2006,
 * chapters 2, 4 and 5. A quadratic regression is the process whose kernel is a square of inner products. */
#ifndef STATS_EMULATOR_H
#define STATS_EMULATOR_H

#include <gsl/gsl_matrix.h>
#include <stdbool.h>
#include <stddef.h>

#include "core/status.h"

RP_C_BEGIN

/* Name, word, meaning. */
#define STATS_KERNEL_LIST(X)                                                                                 \
    X(SMOOTH, "smooth", "squared exponential, a length for each number, a correlation for each factor")      \
    X(QUADRATIC, "quadratic", "regression by products of two inputs")
typedef enum {
#define X(name, word, meaning) STATS_##name,
    STATS_KERNEL_LIST(X) STATS_KERNELS
#undef X
} stats_kernel;
extern const char *const stats_kernel_words[];

/* n settings: numbers x[i * n_reals], from about -1 to 1, and levels level[i * n_factors]. */
typedef struct {
    size_t n, n_reals, n_factors;
    const double *x;
    const int *level;
} stats_inputs;

/* Logarithms of: amplitudes of the main effects and of the kernel, standard deviation of the deviations;
 * for SMOOTH then a length for each number, and for each factor the distance of two levels, whose correlation
 * is exp(-distance). */
enum { STATS_MAX_INPUTS = 40, STATS_HYPER_MAIN = 0, STATS_HYPER_KERNEL, STATS_HYPER_DEVIATION, STATS_HYPERS };
typedef struct {
    stats_kernel kernel;
    double constant; /* amplitude of the constant, not fitted */
    size_t n_hyper;
    double hyper[STATS_HYPERS + STATS_MAX_INPUTS];
    stats_inputs inputs;    /* borrowed */
    const double *variance; /* of the noise, borrowed */
    gsl_matrix *factor;     /* Cholesky factor of the covariance of the values */
} stats_emulator;

/* Start an emulator whose hyperparameters suit values of this standard deviation. Errors: RP_BAD_INPUT (no
 * settings, too many inputs, a number that is not finite, a variance that is not positive), RP_NO_MEMORY. */
rp_status stats_emulator_make(stats_kernel kernel, const stats_inputs *inputs, const double variance[],
                              double sd, stats_emulator *e);
void stats_emulator_free(stats_emulator *e);

/* Covariance of the function at two settings, a of one and b of another list; `same`: they are one setting.
 */
double stats_emulator_kernel(const stats_emulator *e, const stats_inputs *a, size_t i, const stats_inputs *b,
                             size_t j, bool same);

/* Factorise for the present hyperparameters. Errors: RP_BROKEN, where the covariance is not positive
 * definite. */
rp_status stats_emulator_factorise(stats_emulator *e);

/* Logarithm of the evidence of y[n], and its derivatives by the hyperparameters (may be NULL). Factorises.
 * Errors: those of stats_emulator_factorise, RP_NO_MEMORY. */
rp_status stats_emulator_evidence(stats_emulator *e, const double y[], double *evidence, double gradient[]);

/* Maximise the evidence, with a log-normal prior of each hyperparameter about its start, on the first
 * `rows` settings; then factorise with all. Errors: the same. */
rp_status stats_emulator_fit(stats_emulator *e, const double y[], size_t rows);

/* weights[n], the inverse of the covariance times y. */
void stats_emulator_weights(const stats_emulator *e, const double y[], double weights[]);

/* Mean of the function at m settings for each of n_y sets of weights, mean[k * m + i], and its covariance
 * [m m]. Errors: RP_NO_MEMORY. */
rp_status stats_emulator_predict(const stats_emulator *e, const stats_inputs *at, size_t n_y,
                                 const double weights[], double mean[], double covariance[]);

/* What the other groups of settings predict of each value y: its mean and variance, noise included; group[i]
 * are equal for settings that are left out together and stand together. *score: logarithm of the predictive
 * density of the groups, summed. Errors: RP_NO_MEMORY, RP_BROKEN. */
rp_status stats_emulator_leave_out(const stats_emulator *e, const double y[], const size_t group[],
                                   double mean[], double variance[], double *score);

RP_C_END

#endif
