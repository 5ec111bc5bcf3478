/* Drills: what can go wrong while a sweep runs is done to it on purpose, at events and not at times. Each
 * drill ends in nothing lost, none double, and the digest of a run that nothing disturbed. RP_DRILL=N is the
 * long form, with N kills.
 *
 * The functions of the C library that shall fail are defined in faults.c, for the program and its libraries
 * alike. They do as usual until a drill orders a failure. */
#include <errno.h>
#include <signal.h>
#include <stdarg.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "core/clock.h"
#include "tests/faults.h"
#include "tests/folder.h"
#include "tests/noise.h"
#include "tests/protocol.h"

/* ---- A protocol that misbehaves, and its sweep */

/* Conduct of one run of the sweep, and how often; shared with the workers. */
typedef enum { PLAIN, HANGS, SPINS, DIES, HUNGRY } conduct;
static struct {
    volatile conduct as;
    volatile long times;
    volatile double bad_x;
    volatile unsigned long bad_run;
    volatile pid_t bad; /* the worker that misbehaves */
    volatile unsigned long turns;
} * shared;

enum { RUNS = 80, GROWN = 150 };

static rp_status misbehave(void)
{
    enum { HUGE_BYTES = 800000000 };
    if (shared->times-- <= 0) return RP_OK;
    shared->bad = getpid();
    switch (shared->as) {
    case HANGS: pause(); break;
    case SPINS:
        while (shared->as == SPINS) shared->turns++;
        break;
    case DIES: abort();
    case HUNGRY: {
        void *volatile bytes = malloc(HUGE_BYTES);
        if (!bytes) return rp_fail(RP_NO_MEMORY, "drill: out of memory");
        free(bytes);
        break;
    }
    case PLAIN: break;
    }
    return RP_OK;
}

static rp_status run_one(const void *params, unsigned long seed, unsigned long run,
                         const sweep_tables *tables, sweep_result *result)
{
    const double x = *(const double *)params;
    const rp_status status = noise_run(params, seed, run, tables, result);
    if (status) return status;
    return x == shared->bad_x && run == shared->bad_run ? misbehave() : RP_OK;
}

static const sweep_protocol protocol = NOISE_PROTOCOL("drill", run_one);
static const sweep_protocol *const protocols[] = {&protocol, NULL};

static char base[FOLDER_PATH], file[96], grown[96], dir[96];
static char undisturbed[33], undisturbed_grown[33];

static void leave(void)
{
    folder_remove(base);
    munmap(shared, sizeof *shared);
    shared = NULL;
}

static rp_status plan(const char *of)
{
    return sweep_prepare(of, dir, 0, protocols, &(sweep_counts){0});
}

/* The sweep in a new folder. */
static void afresh(void)
{
    folder_remove(dir);
    CHECK_OK(plan(file));
}

static rp_status drive(sweep_options options, sweep_counts *counts)
{
    if (options.workers == 0) options.workers = 2;
    return sweep_run(dir, protocols, &options, counts ? counts : &(sweep_counts){0});
}

/* A second passes for the driver at each of its looks at the one worker that misbehaves, and no time else; a
 * worker that spins has had the processor meanwhile. */
static unsigned long turns_seen;

static void pass_time(const sweep_progress *progress, void *context)
{
    (void)progress, (void)context;
    const bool turns = shared->turns != turns_seen;
    if (shared->bad == 0 || kill(shared->bad, 0) != 0 || (shared->as == SPINS && !turns)) return;
    turns_seen = shared->turns;
    fault_monotonic_clock++;
}

static rp_status drive_in_time(sweep_options options, sweep_counts *counts)
{
    options.workers = 1, options.watch = pass_time;
    shared->bad = 0;
    fault_monotonic_tick = 1e-9;
    const rp_status status = drive(options, counts);
    fault_monotonic_tick = 0.0, fault_monotonic_clock = 0;
    return status;
}

/* A drive in a process of its own. */
static pid_t start_driver(sweep_options options)
{
    const pid_t parent = getpid(), child = fork();
    if (child != 0) return child;
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != parent) _exit(1);
    _exit((int)drive(options, NULL));
}

/* Exit status, or 128 and the signal. */
static int end_of(pid_t child)
{
    int end = 0;
    while (waitpid(child, &end, 0) < 0 && errno == EINTR) continue;
    return WIFEXITED(end) ? WEXITSTATUS(end) : 128 + WTERMSIG(end);
}

static size_t stored(void)
{
    sweep_counts c = {0};
    CHECK_OK(sweep_status(dir, protocols, &c));
    return c.stored;
}

/* Nothing lost, none double, same digest. */
static void check_whole_of(size_t runs, const char *right)
{
    char digest[33] = "";
    size_t n = 0;
    CHECK_OK(sweep_digest(dir, protocols, digest, &n));
    CU_ASSERT(n == runs);
    CU_ASSERT_STRING_EQUAL(digest, right);
}

static void check_whole(void)
{
    check_whole_of(RUNS, undisturbed);
}

/* Plan and run what is left. */
static void conclude(void)
{
    shared->as = PLAIN;
    CHECK_OK(plan(file));
    CHECK_OK(drive((sweep_options){0}, NULL));
    check_whole();
}

static void enter(void)
{
    folder_make_in_memory("drill", base);
    snprintf(file, sizeof file, "%s/s.cfg", base);
    snprintf(grown, sizeof grown, "%s/g.cfg", base);
    snprintf(dir, sizeof dir, "%s/d", base);
    file_print(file, "protocol = \"drill\"; piles = \"shared\"; replicas = %d; grid = { x = [1.0, 2.0]; };\n",
               RUNS / 2);
    file_print(grown,
               "protocol = \"drill\"; piles = \"shared\"; replicas = %d; grid = { x = [3.0, 1.0, 2.0]; };\n",
               GROWN / 3);
    shared = mmap(NULL, sizeof *shared, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    CU_ASSERT_FATAL(shared != MAP_FAILED);
    shared->bad_x = 1.0;
    shared->bad_run = 7;
    const char *const files[] = {file, grown};
    for (int k = 1; k >= 0; k--) {
        size_t n;
        folder_remove(dir);
        CHECK_OK(plan(files[k]));
        CHECK_OK(drive((sweep_options){.workers = 1}, NULL));
        CHECK_OK(sweep_digest(dir, protocols, k ? undisturbed_grown : undisturbed, &n));
    }
    afresh();
}

/* Number of kills of the long form, or what a test for every day takes. */
static long size_of_drill(long usual)
{
    const char *text = getenv("RP_DRILL");
    return text ? strtol(text, NULL, 10) : usual;
}

static unsigned draw(unsigned n)
{
    static uint64_t state = 88172645463325252u;
    state ^= state << 13;
    state ^= state >> 7;
    state ^= state << 17;
    return (unsigned)(state % n);
}

/* ---- Kills */

/* A row has come back: the clock advances now and then, so that groups of every size are committed, and after
 * so many rows the driver is killed. */
static void kill_at_row(const sweep_progress *p, void *context)
{
    size_t *left = context;
    static size_t last;
    if (p->stored != last && *left > 0 && --*left == 0) raise(SIGKILL);
    if (p->stored != last && draw(2)) fault_monotonic_clock++;
    last = p->stored;
}

/* A drive that is killed by SIGKILL: after some rows, or before some commit, which is the removal of the
 * journal. Whatever was stored stays. */
static void kill_drive(sweep_options options)
{
    const size_t before = stored();
    size_t rows = draw(2) ? 1 + draw(7) : 0;
    const long commit = rows ? 0 : 1 + draw(4);
    const pid_t child = fork();
    options.watch = kill_at_row, options.context = &rows;
    if (child == 0) {
        if (commit) fault_signal(SIGKILL, "-journal", commit);
        _exit((int)drive(options, NULL));
    }
    CU_ASSERT(end_of(child) == 128 + SIGKILL);
    CU_ASSERT(stored() >= before);
}

/* Killed ten times, grown, made in three shards that are killed too, and merged. */
static void test_killed(void)
{
    for (long kills = size_of_drill(10), k = 0; k < kills; k++) {
        if (stored() + 20 > RUNS) {
            conclude();
            afresh();
        }
        kill_drive((sweep_options){.workers = 1 + (int)draw(3)});
    }
    const size_t before = stored();
    CU_ASSERT(before > 0);
    CHECK_OK(plan(grown));
    CU_ASSERT(stored() == before);
    for (int shard = 3; shard > 0; shard--) {
        const sweep_options part = {.workers = 2, .shard = shard, .shards = 3};
        kill_drive(part);
        CHECK_OK(drive(part, NULL));
    }
    check_whole_of(GROWN, undisturbed_grown);
    CHECK_OK(sweep_merge(dir, protocols, 0, NULL, &(sweep_counts){0}));
    folder_remove(folder_path(dir, "shards"));
    check_whole_of(GROWN, undisturbed_grown);
    conclude(); /* with fewer values and replicas the same runs, none of which is made */
    afresh();
}

/* ---- Failures */

/* The k-th call fails, in the driver and in each worker, or all calls from there on. Did it matter? */
static bool inject(fault kind, long call, bool persistent)
{
    folder_remove(dir);
    const pid_t child = fork();
    if (child == 0) {
        fault_order(kind, call, persistent);
        rp_status status = plan(file);
        _exit((int)(status ? status : drive((sweep_options){0}, NULL)));
    }
    const int end = end_of(child);
    /* libraries end a process without memory */
    const bool expected = end == RP_OK || end == RP_IO || (end == RP_NO_RESULT && kind == FAULT_SEND) ||
                          (end == RP_BAD_INPUT && kind == FAULT_FILE),
               without = end == RP_NO_RESULT || end == RP_NO_MEMORY || end == RP_BAD_INPUT ||
                         end == 128 + SIGSEGV || end == 128 + SIGABRT;
    CHECK_OR_SAY(expected || (kind == FAULT_MALLOC && without), "fault %d of call %ld: %d", (int)kind, call,
                 end);
    conclude();
    return end != RP_OK;
}

static void test_faults(void)
{
    const bool all = getenv("RP_DRILL") != NULL;
    for (fault kind = 0; kind < N_FAULTS; kind++) {
        if (!fault_possible(kind)) continue;
        const long most = kind == FAULT_FORK     ? 3
                          : kind == FAULT_MALLOC ? 2000
                                                 : 300,
                   step = all ? 1 + most / 50 : 1 + most / 4;
        bool mattered = false;
        for (long call = 1; call <= most; call += step)
            for (int persistent = 0; persistent < 2; persistent++) mattered |= inject(kind, call, persistent);
        CU_ASSERT(mattered);
    }
}

/* What was said last. */
static char told[512];

static void tell(void *context, const char *format, ...)
{
    va_list args;
    (void)context;
    va_start(args, format);
    vsnprintf(told, sizeof told, format, args);
    va_end(args);
}

/* A row of this status, for this cause, and nothing else amiss; without the trouble the same digest. */
static void check_aborted(conduct as, sweep_options options, const char *status, const char *cause)
{
    sweep_counts c = {0};
    char digest[33];
    size_t n;
    shared->as = as;
    shared->times = 99;
    options.report = tell;
    CHECK_FAILS((as == HANGS || as == SPINS ? drive_in_time : drive)(options, &c), RP_NO_RESULT, status);
    CHECK_PARTS(told, check_text("): %s; %s", cause, status));
    CU_ASSERT(c.stored == RUNS && c.failed == 1);
    CHECK_FAILS(sweep_digest(dir, protocols, digest, &n), RP_NO_RESULT, " runs were aborted (");
    conclude();
    afresh();
}

static void test_hung_and_hungry(void)
{
    static const struct {
        conduct as;
        sweep_options options;
        const char *status, *cause;
    } cases[] = {
        {DIES, {0}, "crashed", "worker ended by signal 6 (Aborted)"},
        {HANGS, {.time = 0.5}, "time_limit", "ended after 1 s, the limit of time is 0.5 s"},
        /* it gets on */
        {SPINS, {.time = 2.5}, "time_limit", "ended after 3 s, the limit of time is 2.5 s"},
#ifndef __SANITIZE_ADDRESS__
        {HUNGRY, {.memory = 400.0}, "no_memory", "drill: out of memory"},
#endif
    };
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++)
        check_aborted(cases[k].as, cases[k].options, cases[k].status, cases[k].cause);
    /* what passes within three tries leaves no trace */
    shared->as = DIES;
    shared->times = 2;
    CHECK_OK(drive((sweep_options){0}, NULL));
    check_whole();
    afresh();
    /* of short runs, which go out in batches, the one that is bad is blamed, and no other */
    shared->bad_x = 2.0, shared->bad_run = 20;
    for (size_t k = 0; k < 2; k++)
        check_aborted(cases[k].as, cases[k].options, cases[k].status, cases[k].cause);
}

/* A driver that has stored all runs but the bad one. */
static pid_t start_and_wait(conduct as)
{
    shared->as = as;
    shared->times = 99;
    const pid_t driver = start_driver((sweep_options){0});
    while (stored() < RUNS - 1) usleep(10000);
    return driver;
}

/* A stop waits for a run that ends soon. A second signal ends one that does not. */
static void test_stops(void)
{
    pid_t driver = start_and_wait(SPINS);
    kill(driver, SIGTERM);
    while (!fault_signals_seen(driver)) usleep(1000);
    shared->as = PLAIN;
    CU_ASSERT(end_of(driver) == RP_OK);
    check_whole();
    afresh();
    fault_monotonic_tick =
        0.01; /* one signal alone: ten seconds, which are then a thousand looks at the clock */
    driver = start_and_wait(HANGS);
    fault_monotonic_tick = 0.0;
    kill(driver, SIGTERM);
    kill(driver, SIGINT);
    CU_ASSERT(end_of(driver) == RP_STOPPED);
    conclude();
}

/* A second driver is refused while the first one has the lock, and changes nothing. */
static void test_doubled(void)
{
    const pid_t driver = start_and_wait(SPINS);
    shared->times = 0; /* for a second one the bad run is none */
    CHECK_FAILS(drive((sweep_options){0}, NULL), RP_IO, "another process runs or plans this sweep");
    CHECK_FAILS(plan(grown), RP_IO, "another process runs or plans this sweep");
    shared->as = PLAIN;
    CU_ASSERT(end_of(driver) == RP_OK);
    check_whole();
}

static void turn_clock(const sweep_progress *progress, void *context)
{
    (void)progress, (void)context;
    fault_monotonic_clock += 100000; /* as after a suspended machine woke up */
}

static void test_clock(void)
{
    CHECK_OK(drive((sweep_options){.watch = turn_clock, .time = 3600.0}, NULL));
    fault_monotonic_clock = 0;
    check_whole();
}

/* A folder that may not be written: an error, and nothing changes. */
static void test_read_only(void)
{
    static const char *const names[] = {"store.sqlite", "lock", "sweep.cfg", ""};
    kill_drive((sweep_options){0});
    for (int k = 0; k < 4; k++) chmod(folder_path(dir, names[k]), *names[k] ? 0444 : 0555);
    chmod(base, 0755);
    const pid_t child = fork();
    if (child == 0) {
        if (geteuid() == 0 && setresuid(65534, 65534, 65534) != 0) _exit(1);
        _exit((int)drive((sweep_options){0}, NULL));
    }
    CU_ASSERT(end_of(child) == RP_IO);
    for (int k = 3; k >= 0; k--) chmod(folder_path(dir, names[k]), *names[k] ? 0644 : 0755);
    conclude();
}

CHECK_SUITE_WITHIN(drill, "drill", enter, leave, test_killed, test_faults, test_hung_and_hungry, test_stops,
                   test_doubled, test_clock, test_read_only)
