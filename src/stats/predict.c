/* Predictions of values that the fit has not seen; see stats.h. */
#include <gsl/gsl_machine.h>
#include <gsl/gsl_math.h>
#include <gsl/gsl_statistics_double.h>
#include <math.h>
#include <stdlib.h>

#include "stats/stats.h"

/* Fit to the rows of the other folds, predict those of `fold`. X[n (p + 1)], row after row, is work space. */
static rp_status predict_fold(size_t n, size_t p, const double *const x[], const double y[],
                              const size_t fold[], size_t now, double X[], double predicted[])
{
    const size_t terms = p + 1;
    double *v = X + n * terms, *c = v + n, *covariance = c + terms, chi2;
    size_t used = 0, rank;
    for (size_t i = 0; i < n; i++) {
        if (fold[i] == now) continue;
        X[used * terms] = 1.0;
        for (size_t k = 0; k < p; k++) X[used * terms + 1 + k] = x[k][i];
        v[used++] = y[i];
    }
    if (used <= terms)
        return rp_fail(RP_NO_RESULT, "%zu values outside a fold, more than %zu needed", used, terms);
    rp_status status = stats_multifit(used, terms, X, NULL, v, GSL_DBL_EPSILON, c, covariance, &chi2, &rank);
    for (size_t i = 0; i < n && !status; i++) {
        if (fold[i] != now) continue;
        predicted[i] = c[0];
        for (size_t k = 0; k < p; k++) predicted[i] += c[1 + k] * x[k][i];
    }
    return status;
}

rp_status stats_predict(size_t n, size_t p, const double *const x[], const double y[], const size_t fold[],
                        double predicted[])
{
    size_t folds = 0;
    for (size_t i = 0; i < n; i++) {
        folds = fold[i] >= folds ? fold[i] + 1 : folds;
        bool finite = isfinite(y[i]);
        for (size_t k = 0; k < p; k++) finite = finite && isfinite(x[k][i]);
        if (!finite) return rp_fail(RP_BAD_INPUT, "value %zu: finite numbers expected", i + 1);
    }
    if (folds < 2) return rp_fail(RP_BAD_INPUT, "%zu folds, at least 2 needed", folds);
    double *X = malloc((n * (p + 2) + (p + 1) * (p + 2)) * sizeof *X);
    if (!X) return rp_fail(RP_NO_MEMORY, "prediction: out of memory");
    rp_status status = RP_OK;
    for (size_t f = 0; f < folds && !status; f++) status = predict_fold(n, p, x, y, fold, f, X, predicted);
    free(X);
    return status;
}

rp_status stats_prediction_score(size_t n, const double y[], const double x[], const double predicted[],
                                 const double mean[], stats_prediction *s)
{
    const double quantile = 1.959963984540054, m = (double)n; /* normal, 97.5 % */
    double squares = 0.0, base = 0.0, scatter = 0.0, fourth = 0.0;
    *s = (stats_prediction){.n = n};
    if (n < 4) return rp_fail(RP_NO_RESULT, "%zu values, at least 4 needed", n);
    s->correlation = gsl_stats_correlation(x, 1, y, 1, n);
    const double z = atanh(s->correlation), z_se = 1.0 / sqrt(m - 3.0);
    s->correlation_se = (1.0 - gsl_pow_2(s->correlation)) / sqrt(m - 1.0);
    s->correlation_lo = tanh(z - quantile * z_se);
    s->correlation_hi = tanh(z + quantile * z_se);
    for (size_t i = 0; i < n; i++) {
        squares += gsl_pow_2(y[i] - predicted[i]) / m;
        base += gsl_pow_2(y[i] - mean[i]) / m;
    }
    s->skill = 1.0 - squares / base;
    s->rms = sqrt(squares);
    for (size_t i = 0; i < n; i++) {
        const double e = gsl_pow_2(y[i] - predicted[i]), e_mean = gsl_pow_2(y[i] - mean[i]);
        scatter += gsl_pow_2(e_mean - e - s->skill * e_mean) / (m - 1.0);
        fourth += gsl_pow_2(e - squares) / (m - 1.0);
    }
    s->skill_se = sqrt(scatter / m) / base;
    s->rms_se = 0.5 * sqrt(fourth / m) / s->rms;
    rp_status status = stats_mean(n, y, &s->measured);
    if (!status) status = stats_mean(n, predicted, &s->predicted);
    return status ? status : stats_paired(n, y, -1.0, predicted, &s->error);
}
