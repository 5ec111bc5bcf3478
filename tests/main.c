/* Runs every suite and fails unless all registered tests ran and passed. */
#include <CUnit/Basic.h>
#include <gsl/gsl_errno.h>
#include <stdlib.h>

#include "tests/check.h"

static int broken_registrations;

void check_register(const char *suite, const check_case *cases)
{
    CU_pSuite s = CU_add_suite(suite, NULL, NULL);
    if (!s) broken_registrations++;
    for (; s && cases->name; cases++)
        if (!CU_add_test(s, cases->name, cases->function)) broken_registrations++;
}

bool check_fast(void)
{
    return getenv("RP_CHECK_FAST") != NULL;
}

int main(void)
{
    gsl_set_error_handler_off();
    if (CU_initialize_registry() != CUE_SUCCESS) return EXIT_FAILURE;
#define X(suite) suite();
    CHECK_SUITES(X)
#undef X
    unsigned registered = CU_get_registry()->uiNumberOfTests;
    CU_basic_set_mode(CU_BRM_NORMAL);
    CU_basic_run_tests();
    /* CU_basic_run_tests returns 0 also with failing assertions */
    bool good = broken_registrations == 0 && CU_get_number_of_failures() == 0 &&
                CU_get_number_of_suites_failed() == 0 && CU_get_number_of_tests_run() == registered &&
                registered > 0;
    CU_cleanup_registry();
    return good ? EXIT_SUCCESS : EXIT_FAILURE;
}
