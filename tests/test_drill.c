/* Drills: what can go wrong while a sweep runs is done to it on purpose. Each drill ends in nothing lost,
 * none double, and the digest of a run that nothing disturbed. RP_DRILL=N is the long form, with N kills.
 *
 * The functions of the C library that shall fail are defined here, for the program and its libraries alike.
 * They do as usual until a drill orders a failure. */
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

/* Conduct of one run of the sweep, and how often; shared with the workers. The others take some time. */
typedef enum { PLAIN, HANGS, SPINS, DIES, HUNGRY, ENDS_DRIVER } conduct;
static struct {
    volatile conduct as;
    volatile long times;
    volatile useconds_t pace;
    volatile double bad_x;
    volatile unsigned long bad_run;
} * shared;

enum { RUNS = 80 };

static rp_status misbehave(void)
{
    enum { HUGE_BYTES = 800000000 };
    if (shared->times-- <= 0) return RP_OK;
    switch (shared->as) {
    case HANGS: pause(); break;
    case SPINS:
        while (shared->as == SPINS) continue;
        break;
    case DIES: abort();
    case HUNGRY: {
        void *volatile bytes = malloc(HUGE_BYTES);
        if (!bytes) return rp_fail(RP_NO_MEMORY, "drill: out of memory");
        free(bytes);
        break;
    }
    case ENDS_DRIVER:
        kill(getppid(), SIGKILL);
        pause();
        break;
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
    usleep(shared->pace);
    return x == shared->bad_x && run == shared->bad_run ? misbehave() : RP_OK;
}

static const sweep_protocol protocol = NOISE_PROTOCOL("drill", run_one);
static const sweep_protocol *const protocols[] = {&protocol, NULL};

static char base[FOLDER_PATH], file[96], dir[96];
static char undisturbed[33];

static void leave(void)
{
    folder_remove(base);
    munmap(shared, sizeof *shared);
    shared = NULL;
}

static rp_status plan(void)
{
    return sweep_prepare(file, dir, 0, protocols, NULL, &(sweep_counts){0});
}

/* The sweep in a new folder. */
static void afresh(void)
{
    folder_remove(dir);
    CHECK_OK(plan());
}

static rp_status drive(sweep_options options, sweep_counts *counts)
{
    if (options.workers == 0) options.workers = 2;
    return sweep_run(dir, protocols, &options, counts ? counts : &(sweep_counts){0});
}

/* A drive in a process of its own. */
static pid_t start_driver(sweep_options options)
{
    const pid_t parent = getpid(), child = fork();
    if (child != 0) return child;
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != parent) _exit(1);
    setpgid(0, 0);
    _exit((int)drive(options, NULL));
}

/* Exit status, or 128 and the signal. */
static int end_of(pid_t child)
{
    int end = 0;
    while (waitpid(child, &end, 0) < 0 && errno == EINTR) continue;
    return WIFEXITED(end) ? WEXITSTATUS(end) : 128 + WTERMSIG(end);
}

/* Nothing lost, none double, same digest. */
static void check_whole(void)
{
    char digest[33] = "";
    size_t n = 0;
    CHECK_OK(sweep_digest(dir, protocols, digest, &n));
    CU_ASSERT(n == RUNS);
    CU_ASSERT_STRING_EQUAL(digest, undisturbed);
    RP_ENDS(rp_table_free) rp_table t;
    CHECK_OK(rp_table_parse("runs", protocol_export(dir, protocols, SWEEP_RUNS), &t));
    CU_ASSERT(t.n_rows == RUNS);
    const int column = rp_table_column(&t, "run");
    CU_ASSERT_FATAL(column >= 0);
    for (size_t i = 0; i < t.n_rows; i++)
        CU_ASSERT(strtoul(t.cells[i * t.n_columns + (size_t)column], NULL, 10) == i);
}

/* Plan and run what is left. */
static void conclude(void)
{
    shared->as = PLAIN;
    CHECK_OK(plan());
    CHECK_OK(drive((sweep_options){0}, NULL));
    check_whole();
}

static void enter(void)
{
    folder_make_in_memory("drill", base);
    snprintf(file, sizeof file, "%s/s.cfg", base);
    snprintf(dir, sizeof dir, "%s/d", base);
    file_print(file, "protocol = \"drill\"; piles = \"shared\"; replicas = %d; grid = { x = [1.0, 2.0]; };\n",
               RUNS / 2);
    shared = mmap(NULL, sizeof *shared, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    CU_ASSERT_FATAL(shared != MAP_FAILED);
    shared->pace = 1000;
    shared->bad_x = 1.0;
    shared->bad_run = 7;
    size_t n;
    CHECK_OK(plan());
    CHECK_OK(drive((sweep_options){.workers = 1}, NULL));
    CHECK_OK(sweep_digest(dir, protocols, undisturbed, &n));
    afresh();
}

/* Number of kills of the long form, or what a test for every day takes. */
static long size_of_drill(long usual)
{
    const char *text = getenv("RP_DRILL");
    return text ? strtol(text, NULL, 10) : check_fast() ? usual / 4 + 1 : usual;
}

static unsigned draw(unsigned n)
{
    static uint64_t state = 88172645463325252u;
    state ^= state << 13;
    state ^= state >> 7;
    state ^= state << 17;
    return (unsigned)(state % n);
}

/* A child of the driver, or 0. */
static pid_t find_worker(pid_t driver)
{
    pid_t found[16];
    unsigned n = 0;
    FILE *in = fopen(check_text("/proc/%d/task/%d/children", (int)driver, (int)driver), "r");
    while (in && n < 16 && fscanf(in, "%d", &found[n]) == 1) n++;
    if (in) fclose(in);
    return n ? found[draw(n)] : 0;
}

/* ---- Drills */

/* Signals to drivers, workers and groups at random times, drivers stopped, and a second driver. */
static void test_kills(void)
{
    const long kills = size_of_drill(40);
    static const int signals[] = {SIGKILL, SIGKILL, SIGTERM, SIGINT, SIGHUP, SIGABRT};
    sweep_counts c = {0};
    long whole = 0, sent = 0;
    while (sent < kills) {
        const pid_t driver = start_driver((sweep_options){.workers = 1 + (int)draw(3)});
        CU_ASSERT_FATAL(driver > 0);
        usleep(draw(60000));
        const int signal_number = signals[draw(sizeof signals / sizeof *signals)];
        const unsigned whom = draw(5);
        const pid_t second = whom == 4 ? start_driver((sweep_options){0}) : 0;
        if (whom == 3) kill(driver, SIGSTOP);
        for (unsigned k = draw(3) + 1; whom == 1 && k > 0; k--, usleep(draw(20000))) {
            const pid_t worker = find_worker(driver);
            sent += worker > 0 && kill(worker, SIGKILL) == 0;
        }
        siginfo_t ended = {0};
        waitid(P_PID, (id_t)driver, &ended, WEXITED | WNOHANG | WNOWAIT);
        sent += kill(whom == 2 ? -driver : driver, signal_number) == 0 && ended.si_pid == 0;
        if (whom == 3) kill(driver, SIGCONT);
        const int end = end_of(driver);
        const bool fatal = signal_number == SIGKILL || signal_number == SIGABRT;
        CHECK_OR_SAY(end == RP_OK || end == 128 + signal_number || (end == RP_STOPPED && !fatal) ||
                         (end == RP_NO_RESULT && whom == 1) || (end == RP_IO && second),
                     "after signal %d, to %u: %d", signal_number, whom, end);
        if (second) end_of(second);
        CHECK_OK(sweep_status(dir, protocols, &c));
        CU_ASSERT(end != RP_OK || c.stored == RUNS);
        if (c.stored < RUNS) continue;
        conclude();
        afresh();
        whole++;
    }
    conclude();
    if (getenv("RP_DRILL")) fprintf(stderr, "drill: %ld signals, %ld whole sweeps\n", sent, whole + 1);
}

/* The k-th call fails, in the driver and in each worker, or all calls from there on. Did it matter? */
static bool inject(fault kind, long call, bool persistent)
{
    folder_remove(dir);
    const pid_t child = fork();
    if (child == 0) {
        fault_order(kind, call, persistent);
        rp_status status = plan();
        _exit((int)(status ? status : drive((sweep_options){.patience = 1.0}, NULL)));
    }
    const int end = end_of(child);
    /* libraries end a process without memory */
    const bool expected = end == RP_OK || end == RP_NO_RESULT || end == RP_IO,
               without =
                   end == RP_NO_MEMORY || end == RP_BAD_INPUT || end == 128 + SIGSEGV || end == 128 + SIGABRT;
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

/* A row of this status and nothing else amiss; without the trouble the same digest. */
static void check_aborted(conduct as, long times, sweep_options options, const char *status)
{
    sweep_counts c = {0};
    shared->as = as;
    shared->times = times;
    CHECK_FAILS(drive(options, &c), RP_NO_RESULT, status);
    CU_ASSERT(c.stored == RUNS && c.failed == 1);
    char digest[33];
    size_t n;
    CHECK_FAILS(sweep_digest(dir, protocols, digest, &n), RP_NO_RESULT, " runs were aborted (");
    conclude();
    afresh();
}

/* Limits of time that a healthy worker keeps, however busy the machine is. */
static const sweep_options impatient = {.patience = 2.0};

static void test_hung_and_hungry(void)
{
    check_aborted(DIES, 99, impatient, "crashed");
    check_aborted(HANGS, 99, impatient, "crashed");
    check_aborted(HANGS, 99, (sweep_options){.time = 2.0}, "time_limit");
    check_aborted(SPINS, 99, (sweep_options){.time = 4.0, .patience = 2.0}, "time_limit"); /* it gets on */
#ifndef __SANITIZE_ADDRESS__
    check_aborted(HUNGRY, 99, (sweep_options){.memory = 400.0}, "no_memory");
#endif
    /* what passes within three tries leaves no trace */
    static const conduct passing[] = {DIES, HANGS};
    for (int k = 0; k < 2; k++) {
        shared->as = passing[k];
        shared->times = 2;
        CHECK_OK(drive(impatient, NULL));
        check_whole();
        afresh();
    }
}

/* Short runs go out in batches. The one that is bad, amid a batch, is blamed, and no other. */
static void test_batches(void)
{
    shared->pace = 0;
    shared->bad_x = 2.0;
    shared->bad_run = 20;
    check_aborted(DIES, 99, impatient, "crashed");
    check_aborted(HANGS, 99, (sweep_options){.time = 2.0}, "time_limit");
}

/* A run that takes far longer than the others is named; it ends when it is. */
static void free_the_slow(void *context, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    vsnprintf(context, 512, format, args);
    va_end(args);
    shared->as = PLAIN;
}

static void test_slow_run(void)
{
    char text[512] = "";
    double median = NAN, slow = NAN;
    shared->pace = 20000; /* so long the others take at least */
    shared->as = SPINS;
    shared->times = 1;
    CHECK_OK(drive((sweep_options){.slow = 0.5, .report = free_the_slow, .context = text}, NULL));
    CU_ASSERT(sscanf(text, "run 7 (x = 1): at work for %lf s", &slow) == 1);
    const char *others = strstr(text, "the median of the others is ");
    CU_ASSERT(others && sscanf(others, "%*[^0-9]%lf", &median) == 1 && median >= 0.02);
    CU_ASSERT(slow > 0.5 && slow > 99.0 * median); /* three digits of each */
    check_whole();
}

/* A driver that has stored all runs but the bad one. */
static pid_t start_and_wait(conduct as)
{
    sweep_counts c = {0};
    shared->as = as;
    shared->times = 99;
    const pid_t driver = start_driver((sweep_options){0});
    for (; c.stored < RUNS - 1; usleep(10000)) CHECK_OK(sweep_status(dir, protocols, &c));
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
    const double begin = rp_clock();
    kill(driver, SIGTERM);
    kill(driver, SIGINT);
    CU_ASSERT(end_of(driver) == RP_STOPPED);
    CU_ASSERT(rp_clock() - begin < 40.0); /* four looks a second */
    conclude();
}

/* A worker that someone stops, and forgets. */
static void test_stopped_worker(void)
{
    const pid_t driver = start_driver(impatient);
    pid_t worker = 0;
    while (worker <= 0) worker = find_worker(driver);
    kill(worker, SIGSTOP);
    CU_ASSERT(end_of(driver) == RP_OK);
    check_whole();
}

/* A run that always ends its driver keeps the other runs from being made in order only. */
static void test_deadly_run(void)
{
    sweep_counts c = {0};
    shared->as = ENDS_DRIVER;
    shared->times = 99;
    for (int drives = 0; drives < 25 && c.stored < RUNS - 1; drives++) {
        CU_ASSERT(end_of(start_driver((sweep_options){.workers = 1})) == 128 + SIGKILL);
        CHECK_OK(sweep_status(dir, protocols, &c));
    }
    CU_ASSERT(c.stored == RUNS - 1);
    conclude();
}

/* Two drivers at once: one does all, the other is refused. */
static void test_doubled(void)
{
    for (long k = size_of_drill(4) / 20 + 2; k > 0; k--) {
        const pid_t a = start_driver((sweep_options){0}), b = start_driver((sweep_options){0});
        const int end_a = end_of(a), end_b = end_of(b);
        CU_ASSERT((end_a == RP_OK || end_a == RP_IO) && (end_b == RP_OK || end_b == RP_IO));
        CU_ASSERT(end_a == RP_OK || end_b == RP_OK);
        check_whole();
        afresh();
    }
}

static void turn_clocks(const sweep_progress *progress, void *context)
{
    (void)progress, (void)context;
    fault_wall_clock = fault_wall_clock > 0 ? -1000000000 : 1000000000;
    fault_monotonic_clock += 100000; /* as after a suspended machine woke up */
}

static void test_clocks(void)
{
    CHECK_OK(drive((sweep_options){.watch = turn_clocks, .time = 3600.0}, NULL));
    fault_wall_clock = fault_monotonic_clock = 0;
    check_whole();
}

/* A folder that may not be written: an error, and nothing changes. */
static void test_read_only(void)
{
    const pid_t driver = start_driver((sweep_options){0});
    usleep(60000);
    kill(driver, SIGTERM);
    end_of(driver);
    static const char *const names[] = {"store.sqlite", "lock", "sweep.cfg", ""};
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

/* One byte of the store or of the sweep's file is another: refused, or of no effect. */
static void test_flips(void)
{
    static const char *const names[] = {"store.sqlite", "sweep.cfg"};
    char digest[33];
    long noticed = 0;
    CHECK_OK(drive((sweep_options){0}, NULL));
    scoped char *good = protocol_export(dir, protocols, SWEEP_RUNS);
    CU_ASSERT_FATAL(*good);
    for (long k = size_of_drill(60); k > 0; k--) {
        const char *path = folder_path(dir, names[k % 8 == 0]);
        size_t size, n;
        scoped char *bytes = file_read(path, &size);
        const size_t at = draw((unsigned)size);
        const char before = bytes[at];
        bytes[at] ^= (char)(1u << draw(8));
        file_write(path, bytes, size);
        if (sweep_digest(dir, protocols, digest, &n))
            noticed++;
        else
            CU_ASSERT_STRING_EQUAL(digest, undisturbed);
        scoped char *text = protocol_export(dir, protocols, SWEEP_RUNS);
        CU_ASSERT(!*text || strcmp(text, good) == 0);
        bytes[at] = before;
        file_write(path, bytes, size);
    }
    CU_ASSERT(noticed > 0);
    check_whole();
}

/* A store that lost its end: what is whole comes back, and the rest is made again. */
static void test_truncated(void)
{
    struct stat info;
    for (long k = size_of_drill(6) / 20 + 4; k > 0; k--) {
        CHECK_OK(drive((sweep_options){0}, NULL));
        const char *path = folder_path(dir, "store.sqlite");
        CU_ASSERT(stat(path, &info) == 0);
        CU_ASSERT(truncate(path, draw((unsigned)info.st_size)) == 0);
        size_t rows = 0;
        CHECK_OK(sweep_salvage(dir, protocols, &rows));
        CU_ASSERT(rows <= RUNS);
        conclude();
        afresh();
    }
}

/* Shards in any order, killed and resumed, each started twice; merged in any order. */
static void test_shards(void)
{
    static const int parts[] = {1, 3, 8};
    for (int k = 0; k < 3; k++) {
        char paths[8][160], *list[8];
        sweep_counts c;
        sweep_merged merged;
        for (int i = 0; i < parts[k]; i++) {
            const sweep_options options = {.workers = 2, .shard = 1 + (i + 1) % parts[k], .shards = parts[k]};
            const pid_t killed = start_driver(options);
            usleep(draw(30000));
            kill(killed, SIGKILL);
            end_of(killed);
            const pid_t a = start_driver(options), b = start_driver(options);
            const int end_a = end_of(a), end_b = end_of(b);
            CU_ASSERT((end_a == RP_OK || end_a == RP_IO) && (end_b == RP_OK || end_b == RP_IO));
            CU_ASSERT(end_a == RP_OK || end_b == RP_OK);
            snprintf(paths[i], sizeof paths[i], "%s/shards/%d-of-%d.sqlite", dir, options.shard, parts[k]);
            list[i] = paths[i];
        }
        check_whole(); /* before any merge */
        for (unsigned i = (unsigned)parts[k]; i-- > 1;) {
            const unsigned other = draw(i + 1);
            char *kept = list[i];
            list[i] = list[other];
            list[other] = kept;
        }
        CHECK_OK(sweep_merge(dir, protocols, (size_t)parts[k], list, &merged, &c));
        CU_ASSERT(merged.taken == RUNS && c.stored == RUNS);
        check_whole();
        afresh();
    }
}

CHECK_SUITE_WITHIN(drill, "drill", enter, leave, test_kills, test_faults, test_hung_and_hungry, test_batches,
                   test_slow_run, test_stops, test_stopped_worker, test_deadly_run, test_doubled, test_clocks,
                   test_read_only, test_flips, test_truncated, test_shards)
