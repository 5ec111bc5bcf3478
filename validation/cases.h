/* Cases of validation: a result of the simulator, the expected result, and a bound that follows from the
 * method. Cases of one kind form a problem. */
#ifndef CASES_H
#define CASES_H

#include "tests/check.h"

typedef struct {
    const char *problem; /* one word */
    const char *source;  /* of the expected results */
    const char *bound;   /* derivation of the bound */
    long n;
    double worst;         /* largest error/bound */
    char parameters[256]; /* of the latest case */
    char *rows;
    size_t size;
    FILE *text;
} case_problem;

/* One case: fails unless |observed - expected| <= bound; NaN fails. At last its parameters, as of printf. */
#define case_near(problem, quantity, expected, observed, bound, ...)                                         \
    case_of(problem, quantity, expected, observed, bound, check_text(__VA_ARGS__))
void case_of(case_problem *problem, const char *quantity, double expected, double observed, double bound,
             const char *parameters);

/* Another quantity of the same case. */
void case_also(case_problem *problem, const char *quantity, double expected, double observed, double bound);

/* Stride over the cases of a grid: 1 in full, `daily` otherwise, five times that under the sanitizers. */
int case_stride(int daily);

/* Call last in a suite: fails for a problem without a case. With `check --full -o DIR` it writes
 * DIR/SUITE/SUITE.tsv, one row a problem, its source and bound in notes, and
 * DIR/SUITE/cases.tsv, one row a case. */
void case_write(const char *suite, case_problem *const problems[], size_t n);

/* The test `cases`, which does so. */
#define CASES(suite, ...)                                                                                    \
    static void cases(void)                                                                                  \
    {                                                                                                        \
        case_problem *const problems[] = {__VA_ARGS__};                                                      \
        case_write(#suite, problems, sizeof problems / sizeof *problems);                                    \
    }

#endif
