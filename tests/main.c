/* Runs the tests, each in its own process, and fails unless all registered tests ran and passed.
 *
 *   check [SUITE ...]                     every suite, or those named, at the size for every day
 *   check --test TEXT [SUITE ...]         the tests whose names contain TEXT
 *   check -j N                            N tests at a time
 *   check --full [-o DIR] [SUITE ...]     the validation suites at full size, with their tables
 *   check --stop [SUITE ...]              ends at the first test that fails
 *
 * Hence no test needs another one before it, and a crash is the failure of one test. Tests that sum up their
 * suite are the exception: their suite is one process. */
#include <errno.h>
#include <getopt.h>
#include <gsl/gsl_errno.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "core/clock.h"
#include "core/file.h"
#include "table/table.h"
#include "tests/check.h"

static int broken_registrations;
static bool full, stop, every_test_named;
static const char *folder, *only;

/* Those of the registered suites whose last test reads what the others left. */
static CU_pSuite joint[64];
static size_t n_joint;

static bool is_joint(CU_pSuite suite)
{
    for (size_t i = 0; i < n_joint; i++)
        if (joint[i] == suite) return true;
    return false;
}

static bool is_wanted(const char *name)
{
    return !only || strstr(name, only);
}

/* The name that a list "test_one, two, ..." begins with, as that of a test; returns the rest of the list. */
static const char *first_name(const char *names, char name[static 128])
{
    const size_t from = strncmp(names, "test_", 5) == 0 ? 5 : 0, to = strcspn(names, ",");
    snprintf(name, 128, "%.*s", (int)(to - from), names + from);
    for (char *c = name; *c; c++)
        if (*c == '_') *c = ' ';
    return names + to + strspn(names + to, ", ");
}

void check_suite(const char *suite, check_test *before, check_test *after, bool summed, const char *names,
                 check_test *const tests[])
{
    CU_pSuite s = NULL;
    char name[128];
    const char *last = strrchr(names, ' ');
    first_name(last ? last + 1 : names, name);
    const bool all = summed && is_wanted(name);
    while (*names) {
        names = first_name(names, name);
        check_test *const test = *tests++;
        if (!all && (!is_wanted(name) || (summed && !*names))) continue;
        if (!s) s = CU_add_suite_with_setup_and_teardown(suite, NULL, NULL, before, after);
        if (!s || !CU_add_test(s, name, test)) broken_registrations++;
    }
    if (all && n_joint < sizeof joint / sizeof *joint) joint[n_joint++] = s;
}

void check_free(void *pointer)
{
    free(*(void **)pointer);
}

bool check_fast(void)
{
    return getenv("RP_CHECK_FAST") != NULL;
}

static const char SKIPPED[] = "  skipped ";
static size_t skipped;

void check_skip(const char *reason)
{
    fprintf(stderr, "%s%s: %s\n", SKIPPED, CU_get_current_test()->pName, reason);
}

static bool left_out; /* the test that runs */
static unsigned n_left_out;

void check_skip_test(const char *reason)
{
    if (!left_out) n_left_out++;
    left_out = true;
    check_skip(reason);
}

bool check_full(void)
{
    return full;
}

void check_parts(const char *file, int line, const char *text, const char *const parts[])
{
    for (; *parts; parts++)
        CHECK_OR_SAY(strstr(text, *parts) != NULL, "%s:%d: no \"%s\" in \"%.2000s\"", file, line, *parts,
                     text);
}

bool check_word(const char **text, const char *between, char word[static 128])
{
    const char *from = *text + strspn(*text, between);
    const size_t length = strcspn(from, between);
    snprintf(word, 128, "%.*s", (int)length, from);
    *text = from + length;
    return length > 0;
}

/* The tables that are open. */
static struct {
    FILE *file;
    char path[512];
} opened[8];

FILE *check_table(const char *name, const char *columns)
{
    const char *table = strchr(name, '_');
    const int suite = (int)strcspn(name, "_");
    size_t i = 0;
    if (!full || !folder) return NULL;
    while (opened[i].file) i++;
    CHECK_OK(rp_make_directory(check_text("%s/%.*s", folder, suite, name)));
    snprintf(opened[i].path, 512, "%s/%.*s/%s.tsv", folder, suite, name, table ? table + 1 : name);
    CHECK_OK(rp_file_open(opened[i].path, true, &opened[i].file));
    if (opened[i].file) rp_table_provenance(opened[i].file, RP_CGS, "check --full");
    if (opened[i].file && columns) rp_table_header(opened[i].file, RP_CGS, columns);
    return opened[i].file;
}

void check_row(FILE *table, size_t n, const double values[], const char *word)
{
    if (table && word) rp_table_row_word(table, n, values, word);
    if (table && !word) rp_table_row(table, n, values);
}

void check_table_close(FILE **table)
{
    size_t i = 0;
    if (!*table) return;
    while (opened[i].file != *table) i++;
    CHECK_OK(rp_file_close(opened[i].path, *table, rp_file_finish(*table, opened[i].path)));
    *table = opened[i].file = NULL;
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

/* A test, or a whole suite, and the process that runs it. */
typedef struct {
    CU_pSuite suite;
    CU_pTest test; /* NULL: all of the suite */
    pid_t pid;
    FILE *output;
    CU_RunSummary *summary; /* shared with the process */
} run;

static double test_begin;

static void test_starts(const CU_pTest test, const CU_pSuite suite)
{
    (void)test, (void)suite;
    left_out = false;
    test_begin = rp_clock();
}

static void test_ends(const CU_pTest test, const CU_pSuite suite, const CU_pFailureRecord failures)
{
    if (failures || (every_test_named && !left_out))
        printf("  %s  %s: %s, %.2f s\n", failures ? "FAILED" : "passed", suite->pName, test->pName,
               rp_clock() - test_begin);
    for (CU_pFailureRecord f = failures; f; f = f->pNext)
        printf("          %s:%u: %s\n", f->strFileName, f->uiLineNumber, f->strCondition);
    if (!failures || !stop) return;
    printf("check: stopped by %s: %s\n", suite->pName, test->pName);
    fflush(stdout);
    _Exit(EXIT_FAILURE);
}

/* In the child: run, and leave the counts in shared memory. */
static void run_alone(const run *r, pid_t parent)
{
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != parent) _Exit(EXIT_FAILURE);
    dup2(fileno(r->output), STDOUT_FILENO);
    dup2(fileno(r->output), STDERR_FILENO);
    CU_set_test_start_handler(test_starts);
    CU_set_test_complete_handler(test_ends);
    if (r->test)
        CU_run_test(r->suite, r->test);
    else
        CU_run_suite(r->suite);
    *r->summary = *CU_get_run_summary();
    r->summary->nTestsInactive = n_left_out;
    CU_cleanup_registry();
    exit(EXIT_SUCCESS);
}

static bool start(run *r)
{
    if (!r->test || r->suite->pTest == r->test)
        printf("Suite: %s, %u tests\n", r->suite->pName, r->suite->uiNumberOfTests);
    fflush(NULL); /* the child would write what is buffered again */
    r->output = tmpfile();
    const pid_t parent = getpid();
    r->pid = r->output ? fork() : -1;
    if (r->pid == 0) run_alone(r, parent);
    if (r->pid < 0) perror("check");
    return r->pid > 0;
}

/* Count what has ended, and show what it printed. False if it failed. */
static bool finish(run *r, int status)
{
    CU_RunSummary *sum = CU_get_run_summary();
    const unsigned tests = r->test ? 1 : r->suite->uiNumberOfTests;
    const bool ended = WIFEXITED(status) && WEXITSTATUS(status) == 0 && r->summary->nTestsRun == tests;
    sum->nTestsRun += tests - r->summary->nTestsInactive;
    sum->nTestsInactive += r->summary->nTestsInactive;
    sum->nTestsFailed += ended ? r->summary->nTestsFailed : tests;
    sum->nAsserts += r->summary->nAsserts;
    sum->nAssertsFailed += r->summary->nAssertsFailed;
    sum->nFailureRecords += r->summary->nFailureRecords + !ended;
    rewind(r->output);
    for (char line[4096]; fgets(line, sizeof line, r->output);) {
        skipped += strncmp(line, SKIPPED, sizeof SKIPPED - 1) == 0;
        fputs(line, stdout);
    }
    fclose(r->output);
    r->output = NULL;
    if (!ended)
        printf("  FAILED  %s: %s: %s\n", r->suite->pName, r->test ? r->test->pName : "all tests",
               WIFSIGNALED(status) ? strsignal(WTERMSIG(status))
                                   : "ended early, or with a status other than 0");
    return ended && r->summary->nTestsFailed == 0 && r->summary->nFailureRecords == 0;
}

/* Run them all, `jobs` at a time. False if one could not be started, or failed when that is to stop all. */
static bool run_all(run *runs, size_t n, size_t jobs)
{
    size_t started = 0, running = 0;
    while (started < n || running) {
        if (started < n && running < jobs) {
            if (!start(&runs[started])) return false;
            started++, running++;
            continue;
        }
        int status;
        pid_t pid = wait(&status);
        if (pid < 0 && errno != EINTR) return false;
        for (size_t i = 0; i < started; i++) {
            if (runs[i].pid != pid || !runs[i].output) continue;
            running--;
            if (!finish(&runs[i], status) && stop) return false;
        }
    }
    return true;
}

/* All registered tests and joint suites, in order; free *runs. */
static size_t list_runs(run **runs)
{
    CU_pTestRegistry all = CU_get_registry();
    const size_t n = all->uiNumberOfTests;
    CU_RunSummary *shared =
        mmap(NULL, (n + 1) * sizeof *shared, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    size_t k = 0;
    *runs = calloc(n + 1, sizeof **runs);
    if (!*runs || shared == MAP_FAILED) return 0;
    for (CU_pSuite s = all->pSuite; s; s = s->pNext) {
        if (is_joint(s)) (*runs)[k] = (run){.suite = s, .summary = &shared[k]}, k++;
        for (CU_pTest t = is_joint(s) ? NULL : s->pTest; t; t = t->pNext, k++)
            (*runs)[k] = (run){.suite = s, .test = t, .summary = &shared[k]};
    }
    return k;
}

int main(int argc, char **argv)
{
    static const struct option options[] = {{"full", no_argument, NULL, 'f'},
                                            {"stop", no_argument, NULL, 's'},
                                            {"test", required_argument, NULL, 't'},
                                            {NULL, 0, NULL, 0}};
    long jobs = 1;
    signal(SIGHUP, SIG_DFL);        /* under nohup too: tests stop programs by it */
    setenv("LC_ALL", "C.UTF-8", 1); /* of all programs that tests start, whatever the user's is */
    for (int c; (c = getopt_long(argc, argv, "o:j:", options, NULL)) != -1;) {
        if (c == '?') return 64;
        full |= c == 'f';
        stop |= c == 's';
        if (c == 't') only = optarg;
        if (c == 'o') folder = optarg;
        if (c == 'j') jobs = strtol(optarg, NULL, 10);
    }
    if (jobs < 1) return 64;
    every_test_named = only || optind < argc;
    gsl_set_error_handler_off();
    if (CU_initialize_registry() != CUE_SUCCESS) return EXIT_FAILURE;
    if (!add_suites(argc - optind, argv + optind)) return 64;
    const unsigned registered = CU_get_registry()->uiNumberOfTests;
    if (registered == 0) fprintf(stderr, "check: no test's name contains \"%s\"\n", only ? only : "");
    scoped run *runs = NULL;
    const double begin = rp_clock();
    const size_t n = list_runs(&runs);
    CU_RunSummary *sum = CU_get_run_summary();
    const bool complete = run_all(runs, n, (size_t)jobs);
    sum->ElapsedTime = rp_clock() - begin;
    sum->nSuitesRun = CU_get_registry()->uiNumberOfSuites;
    if (complete)
        printf("%21s%7zu tests or parts of them\n", "skipped", skipped), CU_print_run_results(stdout);
    bool good = complete && broken_registrations == 0 && sum->nTestsFailed == 0 &&
                sum->nFailureRecords == 0 && sum->nTestsRun + sum->nTestsInactive == registered &&
                registered > 0;
    CU_cleanup_registry();
    return good ? EXIT_SUCCESS : EXIT_FAILURE;
}
