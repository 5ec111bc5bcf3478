/* Cases of validation: an answer of the simulator against the expected one, within a bound that follows from
 * the method. Cases of one kind are a problem. */
#ifndef CASES_H
#define CASES_H

#include <stddef.h>
#include <stdio.h>

typedef struct {
    const char *problem; /* one word */
    const char *source;  /* of the expected answers */
    const char *bound;   /* why the error is at most that */
    long n;
    double worst; /* error over bound */
    char *rows;
    size_t size;
    FILE *text;
} case_problem;

/* One case: fails unless |observed - expected| <= bound; NaN fails. `format` names the parameters. */
void case_near(case_problem *problem, const char *quantity, double expected, double observed, double bound,
               const char *format, ...) __attribute__((format(printf, 6, 7)));

/* From one case of a grid to the next that is looked at: all in full, every `daily`th else, a fifth of those
 * under the sanitizers. */
int case_stride(int daily);

/* Call last in a suite: fails for a problem without a case. With `check --full -o DIR` it writes
 * DIR/validation_SUITE.tsv, one row a problem, its source and bound in notes, and
 * DIR/validation_SUITE_cases.tsv, one row a case. */
void case_write(const char *suite, case_problem *const problems[], size_t n);

#endif
