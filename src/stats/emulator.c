/* Gaussian processes of numbers and factors; see emulator.h. */
#include <gsl/gsl_blas.h>
#include <gsl/gsl_errno.h>
#include <gsl/gsl_linalg.h>
#include <math.h>
#include <nlopt.h>
#include <stdlib.h>
#include <string.h>

#include "stats/emulator.h"

/* Widths of the log-normal prior, and how far from the start an optimum is sought. */
static const double prior_sd = 1.0, reach = 4.0, broad = 10.0;

const char *const stats_kernel_words[] = {
#define X(name, word, meaning) word,
    STATS_KERNEL_LIST(X)};
#undef X

static rp_status no_memory(void)
{
    return rp_fail(RP_NO_MEMORY, "emulator: out of memory");
}

/* ---- kernels ---- */

/* Terms of the covariance of two different settings, and what the kernel's own derivatives need. */
typedef struct {
    double main, kernel;             /* with their amplitudes */
    double square[STATS_MAX_INPUTS]; /* of the distance over the length; 0 or the distance of levels */
} pair_terms;

static double square_of(double v)
{
    return v * v;
}

static pair_terms terms_of(const stats_emulator *e, const double *x, const int *l, const double *y,
                           const int *k)
{
    const size_t n_reals = e->inputs.n_reals, n_factors = e->inputs.n_factors;
    const double *lengths = e->hyper + STATS_HYPERS;
    pair_terms t;
    double product = 0.0, exponent = 0.0;
    for (size_t p = 0; p < n_reals; p++) {
        product += x[p] * y[p];
        if (e->kernel != STATS_SMOOTH) continue;
        t.square[p] = square_of((x[p] - y[p]) * exp(-lengths[p]));
        exponent += 0.5 * t.square[p];
    }
    for (size_t f = 0; f < n_factors; f++) {
        product += l[f] == k[f];
        if (e->kernel != STATS_SMOOTH) continue;
        t.square[n_reals + f] = l[f] == k[f] ? 0.0 : exp(lengths[n_reals + f]);
        exponent += t.square[n_reals + f];
    }
    t.main = exp(2.0 * e->hyper[STATS_HYPER_MAIN]) * product;
    t.kernel = exp(2.0 * e->hyper[STATS_HYPER_KERNEL]) *
               (e->kernel == STATS_SMOOTH ? exp(-exponent) : square_of(product));
    return t;
}

static pair_terms pair_of(const stats_emulator *e, const stats_inputs *a, size_t i, const stats_inputs *b,
                          size_t j)
{
    return terms_of(e, a->x + i * a->n_reals, a->level + i * a->n_factors, b->x + j * b->n_reals,
                    b->level + j * b->n_factors);
}

double stats_emulator_kernel(const stats_emulator *e, const stats_inputs *a, size_t i, const stats_inputs *b,
                             size_t j, bool same)
{
    const pair_terms t = pair_of(e, a, i, b, j);
    return e->constant * e->constant + t.main + t.kernel +
           (same ? exp(2.0 * e->hyper[STATS_HYPER_DEVIATION]) : 0.0);
}

/* ---- covariance of the values ---- */

static rp_status check_inputs(const stats_inputs *in, const double variance[])
{
    if (in->n == 0) return rp_fail(RP_BAD_INPUT, "emulator: no settings");
    if (in->n_reals + in->n_factors > STATS_MAX_INPUTS)
        return rp_fail(RP_BAD_INPUT, "emulator: %zu inputs, at most %d", in->n_reals + in->n_factors,
                       STATS_MAX_INPUTS);
    for (size_t i = 0; i < in->n * in->n_reals; i++)
        if (!isfinite(in->x[i]))
            return rp_fail(RP_BAD_INPUT, "emulator: setting %zu: input = %g: not finite", i / in->n_reals + 1,
                           in->x[i]);
    for (size_t i = 0; i < in->n; i++)
        if (!(variance[i] > 0.0 && isfinite(variance[i])))
            return rp_fail(
                RP_BAD_INPUT,
                "emulator: setting %zu: variance of the noise = %g: out of range, allowed: (0, inf)", i + 1,
                variance[i]);
    return RP_OK;
}

rp_status stats_emulator_make(stats_kernel kernel, const stats_inputs *inputs, const double variance[],
                              double sd, stats_emulator *e)
{
    *e = (stats_emulator){.kernel = kernel, .inputs = *inputs, .variance = variance};
    RP_TRY(check_inputs(inputs, variance));
    if (!(sd > 0.0 && isfinite(sd))) return rp_fail(RP_BAD_INPUT, "emulator: the values have no spread");
    const double n = (double)(inputs->n_reals + inputs->n_factors);
    e->constant = broad * sd;
    e->n_hyper = STATS_HYPERS + (kernel == STATS_SMOOTH ? inputs->n_reals + inputs->n_factors : 0);
    e->hyper[STATS_HYPER_MAIN] = log(0.5 * sd / sqrt(n > 0.0 ? n : 1.0));
    e->hyper[STATS_HYPER_KERNEL] = log(kernel == STATS_SMOOTH ? 0.7 * sd : 0.5 * sd / (n > 0.0 ? n : 1.0));
    e->hyper[STATS_HYPER_DEVIATION] = log(0.2 * sd);
    for (size_t p = 0; p < inputs->n_reals; p++) e->hyper[STATS_HYPERS + p] = log(2.0);
    for (size_t f = 0; f < inputs->n_factors; f++) e->hyper[STATS_HYPERS + inputs->n_reals + f] = log(0.3);
    e->factor = gsl_matrix_alloc(inputs->n, inputs->n);
    return e->factor ? RP_OK : no_memory();
}

void stats_emulator_free(stats_emulator *e)
{
    if (e->factor) gsl_matrix_free(e->factor);
    e->factor = NULL;
}

rp_status stats_emulator_factorise(stats_emulator *e)
{
    const stats_inputs *in = &e->inputs;
    for (size_t i = 0; i < in->n; i++) {
        for (size_t j = 0; j < i; j++)
            gsl_matrix_set(e->factor, i, j, stats_emulator_kernel(e, in, i, in, j, false));
        gsl_matrix_set(e->factor, i, i, stats_emulator_kernel(e, in, i, in, i, true) + e->variance[i]);
    }
    gsl_error_handler_t *old = gsl_set_error_handler_off();
    const int error = gsl_linalg_cholesky_decomp1(e->factor);
    gsl_set_error_handler(old);
    return error ? rp_fail(RP_BROKEN, "emulator: the covariance is not positive definite") : RP_OK;
}

void stats_emulator_weights(const stats_emulator *e, const double y[], double weights[])
{
    const size_t n = e->inputs.n;
    if (weights != y) memcpy(weights, y, n * sizeof *weights);
    gsl_vector_view v = gsl_vector_view_array(weights, n);
    gsl_linalg_cholesky_svx(e->factor, &v.vector);
}

/* ---- evidence ---- */

static double log_evidence(const stats_emulator *e, const double y[], const double weights[])
{
    double sum = -0.5 * (double)e->inputs.n * log(2.0 * M_PI);
    for (size_t i = 0; i < e->inputs.n; i++)
        sum -= 0.5 * y[i] * weights[i] + log(gsl_matrix_get(e->factor, i, i));
    return sum;
}

/* Derivatives: half of the sum over all pairs of (w w' - inverse) times the derivative of the covariance. */
static void add_derivatives(const stats_emulator *e, const gsl_matrix *inverse, const double w[],
                            double gradient[])
{
    const stats_inputs *in = &e->inputs;
    memset(gradient, 0, e->n_hyper * sizeof *gradient);
    for (size_t i = 0; i < in->n; i++)
        for (size_t j = 0; j <= i; j++) {
            const double part = (i == j ? 0.5 : 1.0) * (w[i] * w[j] - gsl_matrix_get(inverse, i, j));
            const pair_terms t = pair_of(e, in, i, in, j);
            gradient[STATS_HYPER_MAIN] += part * 2.0 * t.main;
            gradient[STATS_HYPER_KERNEL] += part * 2.0 * t.kernel;
            if (i == j)
                gradient[STATS_HYPER_DEVIATION] += part * 2.0 * exp(2.0 * e->hyper[STATS_HYPER_DEVIATION]);
            for (size_t p = STATS_HYPERS; p < e->n_hyper; p++)
                gradient[p] += part * t.kernel * t.square[p - STATS_HYPERS] *
                               (p < STATS_HYPERS + in->n_reals ? 1.0 : -1.0);
        }
}

rp_status stats_emulator_evidence(stats_emulator *e, const double y[], double *evidence, double gradient[])
{
    const size_t n = e->inputs.n;
    rp_status status = stats_emulator_factorise(e);
    if (status) return status;
    double *weights = malloc(n * sizeof *weights);
    gsl_matrix *inverse = gradient ? gsl_matrix_alloc(n, n) : NULL;
    if (!weights || (gradient && !inverse)) status = no_memory();
    if (!status) {
        stats_emulator_weights(e, y, weights);
        *evidence = log_evidence(e, y, weights);
    }
    if (!status && gradient) {
        gsl_matrix_memcpy(inverse, e->factor);
        gsl_linalg_cholesky_invert(inverse);
        add_derivatives(e, inverse, weights, gradient);
    }
    if (inverse) gsl_matrix_free(inverse);
    free(weights);
    return status;
}

/* ---- fit ---- */

typedef struct {
    stats_emulator *e;
    const double *y, *start;
    rp_status status;
} problem;

static double objective(unsigned n, const double *hyper, double *gradient, void *data)
{
    problem *s = data;
    double value = -HUGE_VAL;
    memcpy(s->e->hyper, hyper, n * sizeof *hyper);
    if (gradient) memset(gradient, 0, n * sizeof *gradient);
    const rp_status status = stats_emulator_evidence(s->e, s->y, &value, gradient);
    if (status) {
        s->status = status;
        return value;
    }
    for (unsigned p = 0; p < n; p++) {
        const double z = (hyper[p] - s->start[p]) / prior_sd;
        value -= 0.5 * z * z;
        if (gradient) gradient[p] -= z / prior_sd;
    }
    return value;
}

/* From the start to the nearest maximum. A failed line search ends at one, to round-off. */
static rp_status maximise(problem *s)
{
    const unsigned n = (unsigned)s->e->n_hyper;
    double hyper[STATS_HYPERS + STATS_MAX_INPUTS], lo[sizeof hyper / sizeof *hyper],
        hi[sizeof hyper / sizeof *hyper], value;
    for (unsigned p = 0; p < n; p++) {
        hyper[p] = s->start[p];
        lo[p] = hyper[p] - reach;
        hi[p] = hyper[p] + reach;
    }
    nlopt_opt o = nlopt_create(NLOPT_LD_LBFGS, n);
    if (!o) return no_memory();
    nlopt_set_max_objective(o, objective, s);
    nlopt_set_lower_bounds(o, lo);
    nlopt_set_upper_bounds(o, hi);
    nlopt_set_ftol_abs(o, 1e-3); /* of a log evidence: a thousandth is no evidence */
    nlopt_set_maxeval(o, 150);
    const nlopt_result result = nlopt_optimize(o, hyper, &value);
    nlopt_destroy(o);
    if (s->status) return s->status;
    if (result < 0 && result != NLOPT_ROUNDOFF_LIMITED && result != NLOPT_FAILURE)
        return rp_fail(RP_BROKEN, "emulator: maximum not found: %s", nlopt_result_to_string(result));
    memcpy(s->e->hyper, hyper, n * sizeof *hyper);
    return RP_OK;
}

rp_status stats_emulator_fit(stats_emulator *e, const double y[], size_t rows)
{
    stats_emulator part = *e;
    part.inputs.n = rows < e->inputs.n ? rows : e->inputs.n;
    part.factor = gsl_matrix_alloc(part.inputs.n, part.inputs.n);
    if (!part.factor) return no_memory();
    problem s = {&part, y, e->hyper, RP_OK};
    rp_status status = maximise(&s);
    if (!status) memcpy(e->hyper, part.hyper, sizeof e->hyper);
    gsl_matrix_free(part.factor);
    return status ? status : stats_emulator_factorise(e);
}

/* ---- predictions ---- */

rp_status stats_emulator_predict(const stats_emulator *e, const stats_inputs *at, size_t n_y,
                                 const double weights[], double mean[], double covariance[])
{
    const size_t n = e->inputs.n, m = at->n;
    gsl_matrix *cross = gsl_matrix_alloc(n, m);
    if (!cross) return no_memory();
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < m; j++)
            gsl_matrix_set(cross, i, j, stats_emulator_kernel(e, &e->inputs, i, at, j, false));
    for (size_t k = 0; k < n_y; k++)
        for (size_t j = 0; j < m; j++) {
            mean[k * m + j] = 0.0;
            for (size_t i = 0; i < n; i++)
                mean[k * m + j] += gsl_matrix_get(cross, i, j) * weights[k * n + i];
        }
    gsl_blas_dtrsm(CblasLeft, CblasLower, CblasNoTrans, CblasNonUnit, 1.0, e->factor, cross);
    gsl_matrix_view c = gsl_matrix_view_array(covariance, m, m);
    for (size_t i = 0; i < m; i++)
        for (size_t j = 0; j < m; j++) covariance[i * m + j] = stats_emulator_kernel(e, at, i, at, j, i == j);
    gsl_blas_dgemm(CblasTrans, CblasNoTrans, -1.0, cross, cross, 1.0, &c.matrix);
    gsl_matrix_free(cross);
    return RP_OK;
}

/* ---- leave out a group ---- */

/* With P the block of the inverse, the residual is P^-1 times the weights, its covariance P^-1 (Rasmussen &
 * Williams 2006, section 5.4.2, for blocks). Adds the log density of the block's values. */
static rp_status leave_block(const gsl_matrix *inverse, const double y[], const double weights[], size_t from,
                             size_t m, double mean[], double variance[], double *score)
{
    gsl_matrix *block = gsl_matrix_alloc(m, m);
    gsl_vector *residual = gsl_vector_alloc(m);
    if (!block || !residual) {
        if (block) gsl_matrix_free(block);
        if (residual) gsl_vector_free(residual);
        return no_memory();
    }
    gsl_matrix_const_view v = gsl_matrix_const_submatrix(inverse, from, from, m, m);
    gsl_vector_const_view w = gsl_vector_const_view_array(weights + from, m);
    gsl_matrix_memcpy(block, &v.matrix);
    gsl_error_handler_t *old = gsl_set_error_handler_off();
    const int error = gsl_linalg_cholesky_decomp1(block);
    gsl_set_error_handler(old);
    if (!error) {
        gsl_linalg_cholesky_solve(block, &w.vector, residual);
        *score -= 0.5 * (double)m * log(2.0 * M_PI);
        for (size_t i = 0; i < m; i++) {
            *score +=
                log(gsl_matrix_get(block, i, i)) - 0.5 * gsl_vector_get(residual, i) * weights[from + i];
            mean[from + i] = y[from + i] - gsl_vector_get(residual, i);
        }
        gsl_linalg_cholesky_invert(block);
        for (size_t i = 0; i < m; i++) variance[from + i] = gsl_matrix_get(block, i, i);
    }
    gsl_matrix_free(block);
    gsl_vector_free(residual);
    return error ? rp_fail(RP_BROKEN, "emulator: the inverse covariance is not positive definite") : RP_OK;
}

rp_status stats_emulator_leave_out(const stats_emulator *e, const double y[], const size_t group[],
                                   double mean[], double variance[], double *score)
{
    const size_t n = e->inputs.n;
    gsl_matrix *inverse = gsl_matrix_alloc(n, n);
    double *weights = malloc(n * sizeof *weights);
    rp_status status = inverse && weights ? RP_OK : no_memory();
    *score = 0.0;
    if (!status) {
        gsl_matrix_memcpy(inverse, e->factor);
        gsl_linalg_cholesky_invert(inverse);
        stats_emulator_weights(e, y, weights);
    }
    for (size_t from = 0, to; from < n && !status; from = to) {
        for (to = from + 1; to < n && group[to] == group[from];) to++;
        status = leave_block(inverse, y, weights, from, to - from, mean, variance, score);
    }
    if (inverse) gsl_matrix_free(inverse);
    free(weights);
    return status;
}
