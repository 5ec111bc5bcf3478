/* Numbers to compare with: random streams, and least squares by GSL. */
#ifndef NUMBERS_H
#define NUMBERS_H

#include <gsl/gsl_rng.h>

#include "core/random.h"

/* A generator of the tests; a scoped_rng is freed at the end of its scope. */
#define scoped_rng __attribute__((cleanup(numbers_end))) gsl_rng
void numbers_end(gsl_rng **rng);
gsl_rng *numbers_of(unsigned long seed, unsigned long run);

/* Its stream, which is the project's. */
rp_random *numbers_stream(const gsl_rng *r);

/* A text that would harm where it is taken for a command, a pattern, a format or a mark: 1 to NUMBERS_TEXT -
 * 1 bytes, none of them in `without`. The commands make a file `hit`. */
enum { NUMBERS_TEXT = 30 };
void numbers_text(gsl_rng *rng, const char *without, char text[NUMBERS_TEXT]);

/* Least squares of y[n] by p columns X[n p], row by row, weights w or NULL: c[p] and covariance[p p]. */
void numbers_fit(size_t n, size_t p, const double X[], const double w[], const double y[], double c[],
                 double covariance[]);

#endif
