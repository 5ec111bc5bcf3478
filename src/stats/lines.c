/* Straight lines through points, where they cease to be straight, and the parabola's bend; see stats.h. */
#include <gsl/gsl_cdf.h>
#include <gsl/gsl_errno.h>
#include <gsl/gsl_fit.h>
#include <gsl/gsl_math.h>
#include <gsl/gsl_multifit.h>
#include <gsl/gsl_statistics_double.h>
#include <math.h>
#include <stdlib.h>

#include "stats/stats.h"

static rp_status check_points(size_t n, const double x[], const double y[], const double se[], bool origin)
{
    bool spread = false;
    for (size_t i = 0; i < n; i++) {
        if (!isfinite(x[i]) || !isfinite(y[i]))
            return rp_fail(RP_BAD_INPUT, "point %zu: (%g, %g): finite numbers expected", i + 1, x[i], y[i]);
        if (se && !(se[i] > 0.0 && isfinite(se[i])))
            return rp_fail(RP_BAD_INPUT, "point %zu: standard error = %g: out of range, allowed: (0, inf)",
                           i + 1, se[i]);
        spread = spread || x[i] != (origin ? 0.0 : x[0]);
    }
    if (spread) return RP_OK; /* two different x are two points */
    return rp_fail(RP_NO_RESULT, "no line: %zu points without %s", n,
                   origin ? "an x other than 0" : "two different x");
}

rp_status stats_line_fit(size_t n, const double x[], const double y[], const double se[], bool origin,
                         stats_line *line)
{
    *line = (stats_line){n, 0, NAN, NAN, NAN, NAN, NAN, NAN, NAN};
    RP_TRY(check_points(n, x, y, se, origin));
    double *w = malloc(n * sizeof *w), variance = 0.0, slope_variance;
    if (!w) return rp_fail(RP_NO_MEMORY, "line: out of memory");
    for (size_t i = 0; i < n; i++) w[i] = se ? 1.0 / (se[i] * se[i]) : 1.0;
    line->intercept = line->covariance = 0.0;
    if (origin)
        gsl_fit_wmul(x, 1, w, 1, y, 1, n, &line->slope, &slope_variance, &line->chi2);
    else
        gsl_fit_wlinear(x, 1, w, 1, y, 1, n, &line->intercept, &line->slope, &variance, &line->covariance,
                        &slope_variance, &line->chi2);
    free(w);
    line->dof = n - (origin ? 1 : 2);
    const double scale = se ? 1.0 : line->dof > 0 ? line->chi2 / (double)line->dof : NAN;
    line->covariance *= scale;
    line->slope_se = sqrt(slope_variance * scale);
    line->intercept_se = origin ? 0.0 : sqrt(variance * scale);
    line->p_value = se && line->dof > 0 ? gsl_cdf_chisq_Q(line->chi2, (double)line->dof) : NAN;
    return RP_OK;
}

rp_status stats_linear_fit(stats_linear *f)
{
    gsl_matrix_const_view X = gsl_matrix_const_view_array(f->X, f->n, f->p);
    gsl_vector_const_view w = gsl_vector_const_view_array(f->w ? f->w : f->y, f->n);
    gsl_vector_const_view y = gsl_vector_const_view_array(f->y, f->n);
    gsl_vector_view c = gsl_vector_view_array(f->c, f->p);
    gsl_matrix_view covariance = gsl_matrix_view_array(f->covariance, f->p, f->p);
    gsl_multifit_linear_workspace *work = gsl_multifit_linear_alloc(f->n, f->p);
    if (!work) return rp_fail(RP_NO_MEMORY, "least squares: out of memory");
    const int code = f->w ? gsl_multifit_wlinear_tsvd(&X.matrix, &w.vector, &y.vector, f->tolerance,
                                                      &c.vector, &covariance.matrix, &f->chi2, &f->rank, work)
                          : gsl_multifit_linear_tsvd(&X.matrix, &y.vector, f->tolerance, &c.vector,
                                                     &covariance.matrix, &f->chi2, &f->rank, work);
    gsl_multifit_linear_free(work);
    return code ? rp_fail(RP_BROKEN, "least squares failed: %s", gsl_strerror(code)) : RP_OK;
}

/* x about its first value in units of the range, so that the columns are of one size. */
rp_status stats_bend(size_t n, const double x[], const double y[], const double se[], stats_contrast *bend)
{
    enum { TERMS = 3 };
    stats_line line;
    *bend = (stats_contrast){NAN, NAN, NAN};
    RP_TRY(stats_line_fit(n, x, y, se, false, &line)); /* checks the points */
    double lo, hi, c[TERMS], covariance[TERMS * TERMS];
    gsl_stats_minmax(&lo, &hi, x, 1, n);
    double *X = malloc((TERMS + 1) * n * sizeof *X), *w = X + TERMS * n;
    if (!X) return rp_fail(RP_NO_MEMORY, "parabola: out of memory");
    for (size_t i = 0; i < n; i++) {
        const double u = (x[i] - lo) / (hi - lo);
        w[i] = 1.0 / (se[i] * se[i]);
        for (size_t k = 0; k < TERMS; k++) X[TERMS * i + k] = gsl_pow_int(u, (int)k);
    }
    stats_linear fit = {n, TERMS, X, y, w, 1e-10, c, covariance};
    rp_status status = n < TERMS ? RP_OK : stats_linear_fit(&fit);
    free(X);
    if (!status && fit.rank < TERMS) /* two of three columns are the same where there are two x only */
        status = rp_fail(RP_NO_RESULT, "no parabola: %zu points, at least 3 different x needed", n);
    const double scale = 1.0 / ((hi - lo) * (hi - lo));
    if (!status) *bend = (stats_contrast){c[2] * scale, sqrt(covariance[8]) * scale, INFINITY};
    return status;
}

rp_status stats_successive(size_t n, const double x[], const double y[], const double se[], double level,
                           stats_prefix prefixes[], double *linear_to, double *bend_free_to)
{
    bool linear = true, bend_free = true;
    *linear_to = *bend_free_to = NAN;
    if (n < 3) return rp_fail(RP_NO_RESULT, "%zu points, at least 3 needed", n);
    for (size_t k = 0; k + 3 <= n; k++) {
        stats_prefix *p = &prefixes[k];
        RP_TRY(stats_line_fit(k + 3, x, y, se, false, &p->line));
        RP_TRY(stats_bend(k + 3, x, y, se, &p->bend));
        p->p_bend = stats_contrast_p(&p->bend);
        linear = linear && p->line.p_value >= level;
        bend_free = bend_free && p->p_bend >= level;
        if (linear) *linear_to = x[k + 2];
        if (bend_free) *bend_free_to = x[k + 2];
    }
    return RP_OK;
}
