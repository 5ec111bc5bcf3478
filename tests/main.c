/* Runs the suites and fails unless all registered tests ran and passed.
 *
 *   check [SUITE ...]                     every suite, or those named, at the size for every day
 *   check --full [-o DIR] [SUITE ...]     the validation suites at full size, with their tables
 *   check --stop [SUITE ...]              ends at the first test that fails */
#include <CUnit/Basic.h>
#include <getopt.h>
#include <gsl/gsl_errno.h>
#include <stdlib.h>
#include <string.h>

#include "core/table.h"
#include "tests/check.h"

static int broken_registrations;
static bool full, stop;
static const char *folder;

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

bool check_full(void)
{
    return full;
}

static void table_path(const char *name, char path[static 512])
{
    snprintf(path, 512, "%s/validation_%s.tsv", folder, name);
}

FILE *check_table(const char *name)
{
    FILE *out = NULL;
    if (!full || !folder) return NULL;
    char path[512];
    table_path(name, path);
    CHECK_OK(rp_make_directory(folder));
    CHECK_OK(rp_file_open(path, &out));
    if (out) rp_table_provenance(out, "check --full");
    return out;
}

void check_table_close(FILE *table, const char *name)
{
    if (!table) return;
    char path[512];
    table_path(name, path);
    CHECK_OK(rp_file_close(path, table, rp_table_finish(table, path)));
}

static void stop_after_failure(const CU_pTest test, const CU_pSuite suite, const CU_pFailureRecord failure)
{
    if (!failure) return;
    printf("check: stopped by %s: %s\n", suite->pName, test->pName);
    fflush(stdout);
    _Exit(EXIT_FAILURE);
}

typedef struct {
    const char *name;
    void (*add)(void);
    bool validation;
} suite_entry;

static const suite_entry suites[] = {
#define X(suite) {#suite, suite, false},
    CHECK_UNIT(X)
#undef X
#define X(suite) {#suite, suite, true},
        CHECK_VALIDATION(X)
#undef X
};

/* Those named, or all there are: of validation alone if that is asked for in full. False: no such suite. */
static bool add_suites(int n_names, char **names)
{
    const size_t n = sizeof suites / sizeof *suites;
    for (size_t i = 0; i < n && n_names == 0; i++)
        if (suites[i].validation || !full) suites[i].add();
    for (int k = 0; k < n_names; k++) {
        size_t i = 0;
        while (i < n && strcmp(suites[i].name + strlen("suite_"), names[k]) != 0) i++;
        if (i == n) {
            fprintf(stderr, "check: no suite %s; there are:", names[k]);
            for (i = 0; i < n; i++) fprintf(stderr, " %s", suites[i].name + strlen("suite_"));
            fputc('\n', stderr);
            return false;
        }
        suites[i].add();
    }
    return true;
}

int main(int argc, char **argv)
{
    static const struct option options[] = {
        {"full", no_argument, NULL, 'f'}, {"stop", no_argument, NULL, 's'}, {NULL, 0, NULL, 0}};
    for (int c; (c = getopt_long(argc, argv, "o:", options, NULL)) != -1;) {
        if (c == '?') return 64;
        full |= c == 'f';
        stop |= c == 's';
        if (c == 'o') folder = optarg;
    }
    gsl_set_error_handler_off();
    if (CU_initialize_registry() != CUE_SUCCESS) return EXIT_FAILURE;
    if (!add_suites(argc - optind, argv + optind)) return 64;
    unsigned registered = CU_get_registry()->uiNumberOfTests;
    CU_basic_set_mode(CU_BRM_NORMAL);
    if (stop) {
        CU_set_test_complete_handler(stop_after_failure);
        CU_run_all_tests();
    } else {
        CU_basic_run_tests();
    }
    /* CU_basic_run_tests returns 0 also with failing assertions */
    bool good = broken_registrations == 0 && CU_get_number_of_failures() == 0 &&
                CU_get_number_of_suites_failed() == 0 && CU_get_number_of_tests_run() == registered &&
                registered > 0;
    CU_cleanup_registry();
    return good ? EXIT_SUCCESS : EXIT_FAILURE;
}
