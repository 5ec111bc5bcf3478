/* Random streams, and least squares by GSL; see numbers.h. */
#include <gsl/gsl_multifit.h>

#include "core/random.h"
#include "tests/check.h"
#include "tests/numbers.h"

void numbers_end(gsl_rng **rng)
{
    gsl_rng_free(*rng);
}

gsl_rng *numbers_of(unsigned long seed, unsigned long run)
{
    return rp_random_alloc(seed, run, RP_PURPOSE_TEST);
}

void numbers_fit(size_t n, size_t p, const double X[], const double w[], const double y[], double c[],
                 double covariance[])
{
    gsl_matrix_const_view columns = gsl_matrix_const_view_array(X, n, p);
    gsl_vector_const_view values = gsl_vector_const_view_array(y, n),
                          weights = gsl_vector_const_view_array(w ? w : y, n);
    gsl_vector_view found = gsl_vector_view_array(c, p);
    gsl_matrix_view errors = gsl_matrix_view_array(covariance, p, p);
    gsl_multifit_linear_workspace *work = gsl_multifit_linear_alloc(n, p);
    double chi2;
    const int code =
        w ? gsl_multifit_wlinear(&columns.matrix, &weights.vector, &values.vector, &found.vector,
                                 &errors.matrix, &chi2, work)
          : gsl_multifit_linear(&columns.matrix, &values.vector, &found.vector, &errors.matrix, &chi2, work);
    CU_ASSERT(code == 0);
    gsl_multifit_linear_free(work);
}
