/* Importance sampling of the choices that a publication leaves open; see forensics.h. */
#include <gsl/gsl_blas.h>
#include <gsl/gsl_cdf.h>
#include <gsl/gsl_errno.h>
#include <gsl/gsl_linalg.h>
#include <gsl/gsl_randist.h>
#include <gsl/gsl_sf_erf.h>
#include <gsl/gsl_sort.h>
#include <math.h>
#include <stdlib.h>

#include "stats/forensics.h"

enum { MOST_POINTS = 64 };

static unsigned level_of(unsigned latent, int which)
{
    return latent >> which & 1u;
}

/* ---- likelihood ---- */

double stats_published_variance(const stats_published *number, unsigned reading)
{
    return number->error * number->error / (reading ? number->samples : 1.0);
}

double stats_common_variance(double shift, unsigned latent)
{
    return level_of(latent, STATS_LATENT_shift) ? shift * shift : 0.0;
}

/* The Cholesky factor of the covariance of the numbers, and their differences from the prediction over it. */
static rp_status whiten(size_t n, const stats_published numbers[], const double mean[],
                        const double covariance[], double scale, double common, unsigned reading,
                        double block[], double r[])
{
    for (size_t i = 0; i < n; i++) {
        for (size_t k = 0; k < n; k++) block[i * n + k] = scale * covariance[i * n + k] + common;
        block[i * n + i] += stats_published_variance(&numbers[i], reading);
        r[i] = numbers[i].value - mean[i];
    }
    gsl_matrix_view factor = gsl_matrix_view_array(block, n, n);
    gsl_vector_view v = gsl_vector_view_array(r, n);
    gsl_error_handler_t *old = gsl_set_error_handler_off();
    const int error = gsl_linalg_cholesky_decomp1(&factor.matrix);
    gsl_set_error_handler(old);
    if (error)
        return rp_fail(RP_BROKEN, "forensics: the covariance of a prediction is not positive definite");
    gsl_blas_dtrsv(CblasLower, CblasNoTrans, CblasNonUnit, &factor.matrix, &v.vector);
    return RP_OK;
}

rp_status stats_common_error(size_t n, const stats_published numbers[], const double mean[],
                             const double covariance[], double scale, double shift, unsigned latent,
                             double *error, double *variance)
{
    double block[MOST_POINTS * MOST_POINTS], r[MOST_POINTS], ones[MOST_POINTS], product = 0.0, square = 0.0;
    const double common = stats_common_variance(shift, latent);
    RP_TRY(whiten(n, numbers, mean, covariance, scale, common, level_of(latent, STATS_LATENT_reading), block,
                  r));
    gsl_matrix_view factor = gsl_matrix_view_array(block, n, n);
    gsl_vector_view v = gsl_vector_view_array(ones, n);
    for (size_t i = 0; i < n; i++) ones[i] = 1.0;
    gsl_blas_dtrsv(CblasLower, CblasNoTrans, CblasNonUnit, &factor.matrix, &v.vector);
    for (size_t i = 0; i < n; i++) product += ones[i] * r[i], square += ones[i] * ones[i];
    *error = common * product;
    *variance = common * (1.0 - common * square);
    return RP_OK;
}

rp_status stats_log_likelihood(size_t n, const stats_published numbers[], const double mean[],
                               const double covariance[], double scale, double shift, unsigned latent,
                               double *log_likelihood, double *chi2)
{
    double block[MOST_POINTS * MOST_POINTS], r[MOST_POINTS], sum = 0.0;
    RP_TRY(whiten(n, numbers, mean, covariance, scale, stats_common_variance(shift, latent),
                  level_of(latent, STATS_LATENT_reading), block, r));
    *log_likelihood = -0.5 * (double)n * log(2.0 * M_PI);
    for (size_t i = 0; i < n; i++) {
        sum += r[i] * r[i];
        *log_likelihood -= log(block[i * n + i]);
    }
    *log_likelihood -= 0.5 * sum;
    if (chi2) *chi2 = sum;
    return RP_OK;
}

static rp_status check_numbers(const stats_predictions *m, const stats_published numbers[])
{
    if (m->n_points < 1 || m->n_points > MOST_POINTS)
        return rp_fail(RP_BAD_INPUT, "published numbers: %zu: out of range, allowed: [1, %d]", m->n_points,
                       MOST_POINTS);
    for (size_t k = 0; k < m->n_points; k++)
        if (!isfinite(numbers[k].value) || !(numbers[k].error > 0.0 && isfinite(numbers[k].error)) ||
            !(numbers[k].samples >= 1.0 && isfinite(numbers[k].samples)))
            return rp_fail(
                RP_BAD_INPUT,
                "published number %zu: %g +- %g of %g samples: a finite value with a positive error "
                "and its samples expected",
                k + 1, numbers[k].value, numbers[k].error, numbers[k].samples);
    return RP_OK;
}

/* ---- posterior ---- */

static size_t index_of(const stats_posterior *p, size_t draw, size_t surface, unsigned latent)
{
    return (draw * p->n_surfaces + surface) * STATS_LATENT_LEVELS + latent;
}

/* Logarithms of all likelihoods, and the chi^2 of each. */
static rp_status find_likelihoods(const stats_predictions *m, const stats_published numbers[],
                                  stats_posterior *p, double chi2[])
{
    for (size_t d = 0; d < m->n_draws; d++)
        for (size_t s = 0; s < m->n_surfaces; s++)
            for (unsigned latent = 0; latent < STATS_LATENT_LEVELS; latent++) {
                const size_t i = index_of(p, d, s, latent);
                RP_TRY(stats_log_likelihood(m->n_points, numbers,
                                            m->mean + (d * m->n_surfaces + s) * m->n_points,
                                            m->covariance + d * m->n_points * m->n_points, m->scale[s],
                                            m->shift, latent, &p->share[i], &chi2[i]));
                if (level_of(latent, STATS_LATENT_stop)) p->share[i] += m->log_complete[d];
            }
    return RP_OK;
}

/* From logarithms of likelihoods to weights, with what follows of them. */
static rp_status normalise(const stats_predictions *m, const double chi2[], stats_posterior *p)
{
    const size_t n = p->n_draws * p->n_surfaces * STATS_LATENT_LEVELS, each = n / p->n_draws;
    double top = -INFINITY, total = 0.0, squares = 0.0;
    for (size_t i = 0; i < n; i++) top = fmax(top, p->share[i]);
    if (!isfinite(top)) return rp_fail(RP_NO_RESULT, "forensics: no draw agrees with the published numbers");
    for (size_t i = 0; i < n; i++) total += p->share[i] = exp(p->share[i] - top);
    p->log_evidence = top + log(total / (double)n);
    p->p_value = 0.0;
    for (size_t d = 0; d < p->n_draws; d++) {
        double weight = 0.0;
        for (size_t i = d * each; i < (d + 1) * each; i++) {
            weight += p->share[i] /= total;
            p->p_value += p->share[i] * gsl_cdf_chisq_Q(chi2[i], (double)m->n_points);
        }
        squares += weight * weight;
    }
    p->effective = 1.0 / squares;
    return RP_OK;
}

rp_status stats_posterior_make(const stats_predictions *m, const stats_published numbers[],
                               stats_posterior *p)
{
    *p = (stats_posterior){.n_draws = m->n_draws, .n_surfaces = m->n_surfaces};
    rp_status status = check_numbers(m, numbers);
    if (status) return status;
    const size_t n = m->n_draws * m->n_surfaces * STATS_LATENT_LEVELS;
    p->share = malloc((n + 1) * sizeof *p->share);
    double *chi2 = malloc((n + 1) * sizeof *chi2);
    if (!p->share || !chi2) status = rp_fail(RP_NO_MEMORY, "forensics: out of memory");
    if (!status) status = find_likelihoods(m, numbers, p, chi2);
    if (!status) status = normalise(m, chi2, p);
    free(chi2);
    return status;
}

void stats_posterior_free(stats_posterior *p)
{
    free(p->share);
    p->share = NULL;
}

double stats_posterior_draws(const stats_posterior *p, int latent, unsigned level, double weight[])
{
    double sum = 0.0;
    for (size_t d = 0; d < p->n_draws; d++) {
        weight[d] = 0.0;
        for (size_t s = 0; s < p->n_surfaces; s++)
            for (unsigned k = 0; k < STATS_LATENT_LEVELS; k++)
                if (latent < 0 || level_of(k, latent) == level) weight[d] += p->share[index_of(p, d, s, k)];
        sum += weight[d];
    }
    return sum;
}

double stats_posterior_surface(const stats_posterior *p, size_t surface)
{
    double sum = 0.0;
    for (size_t d = 0; d < p->n_draws; d++)
        for (unsigned k = 0; k < STATS_LATENT_LEVELS; k++) sum += p->share[index_of(p, d, surface, k)];
    return sum;
}

double stats_bayes_factor(double prior, double share)
{
    return share / (1.0 - share) * (1.0 - prior) / prior;
}

double stats_weighted_quantile(size_t n, const double x[], const double weight[], double q, size_t order[])
{
    double total = 0.0, sum = 0.0;
    for (size_t i = 0; i < n; i++) total += weight[i];
    if (!(total > 0.0)) return NAN;
    gsl_sort_index(order, x, 1, n);
    for (size_t i = 0; i < n; i++)
        if ((sum += weight[order[i]]) >= q * total) return x[order[i]];
    return x[order[n - 1]];
}

/* ---- runs without a number ---- */

double stats_log_normal_chance(double mean, double variance)
{
    return gsl_sf_log_erfc(-mean / sqrt(2.0 * (1.0 + variance))) - M_LN2;
}

void stats_probit(double k, double n, double *deviate, double *variance)
{
    const double p = (k + 0.5) / (n + 1.0);
    *deviate = gsl_cdf_ugaussian_Pinv(p);
    *variance = p * (1.0 - p) / (n + 1.0) / pow(gsl_ran_ugaussian_pdf(*deviate), 2.0);
}
