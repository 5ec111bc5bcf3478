/* The sweep driver with toy protocols: plans, resume, crashes, determinism, tables, and every bad input. */
#include <fcntl.h>
#include <limits.h>
#include <signal.h>
#include <sqlite3.h>
#include <strings.h>
#include <sys/resource.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>
#include <xxhash.h>

#include "core/clock.h"
#include "core/file.h"
#include "core/version.h"
#include "dem/scene/text.h"
#include "sweeps/engine/private.h"
#include "sweeps/engine/physics.h"
#include "tests/faults.h"
#include "tests/protocol.h"
#include "tests/folder.h"
#include "tests/numbers.h"

/* The toy protocol: y = x + k + noise from the stream of the run. */
enum { PLAIN, SLOW, CRASH, HALF_NO_PILE, BREAK, TAKE, SLEEP };
typedef struct {
    double x, mass;
    long k;
    bool odd;
    int mode;
    const char *picks;
} toy;

static const rp_param toy_schema[] = {
    {"x", "cm", RP_REAL, offsetof(toy, x), "0.25", "[-10, 10]", "shift"},
    {"mass", "g", RP_REAL, offsetof(toy, mass), "infinite", "(0, inf) | infinite", "not used"},
    {"k", "", RP_INT, offsetof(toy, k), "3", "[0, 100] | auto", "second shift"},
    {"odd", "", RP_BOOL, offsetof(toy, odd), "false", "", "not used"},
    {"mode", "", RP_CHOICE, offsetof(toy, mode), "plain",
     "plain | slow | crash | half_no_pile | break | take | sleep", "conduct"},
    {"picks", "", RP_TEXT, offsetof(toy, picks), "", "", "not used"},
    {0}};

static const sweep_output toy_outputs[] = {
    {"y_deg", "deg", "x + k + noise"}, {"never", "s", "has no value"}, {0}};

/* Shared with the workers; while it is set, slow runs from number 20 on wait, so that a sweep to be
 * interrupted cannot end first. */
static volatile int *hold, *made; /* shared with the workers: whether runs wait; their number */

static volatile int *shared_number(void)
{
    void *page = mmap(NULL, sizeof(int), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    CU_ASSERT_FATAL(page != MAP_FAILED);
    return page;
}

/* In a quiet moment no run crashes; what the words of results end with. */
static bool calm;
static char ending[4];

static rp_status toy_check(const void *params)
{
    const toy *p = params;
    return p->x == 9.5 ? rp_fail(RP_BAD_INPUT, "x = 9.5: refused by the toy") : RP_OK;
}

/* So many bytes, and how many files are open beyond the three of every process. */
static rp_status take_memory(size_t bytes, sweep_result *result)
{
    volatile char *taken = malloc(bytes);
    if (!taken) return rp_fail(RP_NO_MEMORY, "toy: out of memory");
    *taken = 1;
    free((void *)taken);
    result->values[0] = 0.0;
    for (int i = 3; i < 256; i++) result->values[0] += fcntl(i, F_GETFD) != -1;
    return RP_OK;
}

static rp_status toy_run(const void *params, unsigned long seed, unsigned long run,
                         const sweep_tables *tables, sweep_result *result)
{
    (void)tables;
    const toy *p = params;
    scoped_rng *r = numbers_of(seed, run);
    result->values[0] = p->x + (double)p->k + gsl_rng_uniform(r);
    snprintf(result->status, sizeof result->status, "%s%s", run % 2 ? "ok" : "ok_fixed_time", ending);
    if (p->mode == SLOW) usleep(5000);
    if (made) ++*made;
    while (p->mode == SLOW && hold && *hold && run >= 10) usleep(1000);
    if (p->mode == CRASH && run % 3 == 1 && !calm) abort();
    if (p->mode == HALF_NO_PILE && run % 2) snprintf(result->status, sizeof result->status, "no_pile");
    if (p->mode == SLEEP) usleep(500000);
    if (p->mode == TAKE) return take_memory((size_t)p->k * 1000000, result);
    return p->mode == BREAK && run == 3 ? rp_fail(RP_BROKEN, "planted failure") : RP_OK;
}

static rp_status toy_fingerprint(char digits[33])
{
    memset(digits, 'a', 32);
    digits[32] = '\0';
    return RP_OK;
}

#define TOY(NAME, FINGERPRINT)                                                                               \
    {                                                                                                        \
        .name = NAME, .about = "toy", .schema = toy_schema, .params_size = sizeof(toy),                      \
        .outputs = toy_outputs, .check = toy_check, .run = toy_run, .fingerprint = FINGERPRINT               \
    }
static const sweep_protocol toy_protocol = TOY("toy", NULL), other_protocol = TOY("other", NULL),
                            changed_protocol = TOY("toy", toy_fingerprint);
static const sweep_protocol *const toys[] = {&toy_protocol, &other_protocol, NULL},
                                   *const changed[] = {&changed_protocol,
                                                       NULL}; /* the same with other bits */

/* One folder for each test: `base` holds s.cfg and the sweep `dir`. */
static char base[FOLDER_PATH], file[96], dir[96], store[128], other[96]; /* `other`: of a second sweep */
static char *const others[] = {other};

/* What the latest call has counted. */
static sweep_counts c;
static sweep_merged m;

static long size_of(const char *path)
{
    struct stat found;
    return stat(path, &found) == 0 ? (long)found.st_size : -1;
}

static void clean(void)
{
    if (*base) folder_remove(base);
    *base = '\0';
}

/* The sweep file anew, of the toy. */
static void write_sweep(const char *text)
{
    file_print(file, "protocol = \"toy\"; %s", text);
}

/* A new folder with this sweep file, in place of the test's last one. */
static void fresh(const char *text)
{
    clean();
    folder_make("sweep", base);
    snprintf(file, sizeof file, "%s/s.cfg", base);
    snprintf(dir, sizeof dir, "%s/deep/d", base);
    snprintf(store, sizeof store, "%s/store.sqlite", dir);
    snprintf(other, sizeof other, "%s/other", base);
    write_sweep(text);
}

static rp_status prepare(void)
{
    return sweep_prepare(file, dir, 0, toys, NULL, &c);
}

static rp_status run_in(const char *folder, int workers)
{
    return sweep_run(folder, toys, &(sweep_options){.workers = workers}, &c);
}

static rp_status run(int workers)
{
    return run_in(dir, workers);
}

/* How many runs are stored, and what else the status counts. */
static size_t stored(void)
{
    CHECK_OK(sweep_status(dir, toys, &c));
    return c.stored;
}

/* A new folder with the plan of this text, and with all its runs made by so many workers. */
static void planned(const char *text)
{
    fresh(text);
    CHECK_OK(prepare());
}

static void made_by(int workers, const char *text)
{
    planned(text);
    CHECK_OK(run(workers));
}

/* The digest of the sweep in `dir`; empty, and a failed assertion, if there is none. */
static const char *digest(size_t rows)
{
    static char texts[4][33];
    static unsigned next;
    char *text = texts[next++ % 4];
    size_t n = 0;
    text[0] = '\0';
    CHECK_OK(sweep_digest(dir, toys, text, &n));
    CU_ASSERT(n == rows);
    return text;
}

static void sql_in(const char *path, const char *text)
{
    sqlite3 *db;
    CU_ASSERT(sqlite3_open(path, &db) == SQLITE_OK && sqlite3_exec(db, text, NULL, NULL, NULL) == SQLITE_OK);
    sqlite3_close(db);
}

static void sql(const char *text)
{
    sql_in(store, text);
}

/* A query of the store, and its end. */
static sqlite3_stmt *query(const char *text)
{
    sqlite3 *db;
    sqlite3_stmt *q = NULL;
    CU_ASSERT(sqlite3_open(store, &db) == SQLITE_OK);
    CU_ASSERT(sqlite3_prepare_v2(db, text, -1, &q, NULL) == SQLITE_OK);
    return q;
}

static void finish(sqlite3_stmt *q)
{
    sqlite3 *db = sqlite3_db_handle(q);
    sqlite3_finalize(q);
    sqlite3_close(db);
}

static sqlite3_int64 sql_number(const char *text)
{
    sqlite3_stmt *q = query(text);
    CU_ASSERT(sqlite3_step(q) == SQLITE_ROW);
    sqlite3_int64 n = sqlite3_column_int64(q, 0);
    finish(q);
    return n;
}

#define scoped_table __attribute__((cleanup(rp_table_free))) rp_table

static rp_table exported(unsigned what)
{
    rp_table t;
    CHECK_OK(rp_table_parse("table", protocol_export(dir, toys, what), &t));
    return t;
}

static const char *cell(const rp_table *t, size_t row, const char *name)
{
    const int column = rp_table_column(t, name);
    CU_ASSERT_FATAL(column >= 0 && row < t->n_rows);
    return t->cells[row * t->n_columns + (size_t)column];
}

static double number(const rp_table *t, size_t row, const char *name)
{
    return strtod(cell(t, row, name), NULL);
}

/* Store a row in a folder as the driver does. */
static rp_status put_row_in(const char *folder, const sweep_row *row)
{
    RP_ENDS(sweep_plan_free) sweep_plan plan;
    sweep_store *opened = NULL;
    rp_status status = sweep_plan_read(folder_path(folder, "sweep.cfg"), toys, &plan);
    if (!status) status = sweep_store_open(folder_path(folder, "store.sqlite"), SWEEP_WRITE, &opened);
    if (!status) status = sweep_store_insert(opened, &plan, row);
    sweep_store_close(opened);
    return status;
}

static rp_status put_row(const sweep_row *row)
{
    return put_row_in(dir, row);
}

/* The expected results of the toy protocol, in every bit. */
static double expected(double x, long k, unsigned long seed, unsigned long run_index)
{
    scoped_rng *r = numbers_of(seed, run_index);
    return x + (double)k + gsl_rng_uniform(r);
}

static void test_order(void)
{
    planned("replicas = 3; seed = 77; fixed = { picks = \"green\"; odd = true; };"
            "piles = \"shared\"; grid = { x = [0.125, 2.385]; k = (5, \"auto\"); };");
    CU_ASSERT(c.planned == 12 && c.points == 4 && c.replicas == 3 && c.stored == 0);
    CHECK_OK(run(2));
    CU_ASSERT(c.stored == 12 && c.failed == 0 && c.words.n == 2);
    scoped_table t = exported(SWEEP_RUNS);
    CU_ASSERT_FATAL(t.n_rows == 12);
    const char *names = "run status x k replica pile y_deg never seconds";
    size_t n = 0;
    for (char name[128]; check_word(&names, " ", name);) CU_ASSERT(rp_table_column(&t, name) == (int)n++);
    CU_ASSERT(t.n_columns == n);
    for (size_t r = 0; r < 12; r++) { /* the last list fastest, replicas innermost */
        double x = r < 6 ? 0.125 : 2.385;
        bool five = r % 6 < 3;
        CU_ASSERT(number(&t, r, "run") == (double)(r) && number(&t, r, "x") == x);
        CU_ASSERT_STRING_EQUAL(cell(&t, r, "k"), five ? "5" : "auto");
        CU_ASSERT(number(&t, r, "replica") == (double)(r % 3) && number(&t, r, "pile") == (double)(r % 3));
        CU_ASSERT(number(&t, r, "y_deg") == expected(x, five ? 5 : -1, 77, r % 3));
        CU_ASSERT_STRING_EQUAL(cell(&t, r, "never"), "nan");
    }
    /* the store has the same values when opened directly */
    CU_ASSERT(
        sql_number("SELECT count(*) FROM runs WHERE parameters = '{\"odd\":\"true\",\"picks\":\"green\","
                   "\"x\":2.385,\"k\":\"auto\"}' AND never IS NULL AND pile < 3") == 3);
}

#define X "(parameters ->> 'x')"
#define K "(parameters ->> 'k')"

/* Lists that go together, alone and in groups of which the last is the fastest. */
static void test_bundles(void)
{
    made_by(1, "replicas = 1; zip = true; grid = { x = [0.5, 1.5, 2.5]; k = [9, 8, 7]; };");
    CU_ASSERT(c.planned == 3);
    CU_ASSERT(sql_number("SELECT 2 * sum(" X " * " K ") FROM runs") == 68); /* 2 (4.5 + 12 + 17.5) */
    made_by(1, "replicas = 1;\n"
               "grid = ( { x = [0.5, 1.5, 2.5]; k = [9, 8, 7]; }, { mass = [1.0, 3.0]; } );");
    CU_ASSERT(c.planned == 6);
    CU_ASSERT(sql_number("SELECT 2 * sum(" X " * " K " * (parameters ->> 'mass')) FROM runs") ==
              68 * (1 + 3));
    CU_ASSERT(sql_number("SELECT 2 * " X " * (parameters ->> 'mass') FROM runs WHERE run = 3") == 9);
}

/* Replica k of every grid point has the same streams, those of the file's seed. */
static void test_shared_piles(void)
{
    made_by(1, "replicas = 3; seed = 77; grid = { x = [0.125, 2.385]; };");
    const char *own = digest(6);
    write_sweep("replicas = 3; seed = 77; piles = \"shared\";grid = { x = [0.125, 2.385]; };");
    CHECK_OK(prepare());
    CU_ASSERT(c.planned == 6 && c.stored == 0);
    CHECK_OK(run(2));
    CU_ASSERT_STRING_NOT_EQUAL(digest(6), own);
    scoped_table t = exported(SWEEP_RUNS);
    CU_ASSERT_FATAL(t.n_rows == 6);
    for (size_t r = 0; r < 6; r++) {
        CU_ASSERT(number(&t, r, "run") == (double)(r) && number(&t, r, "pile") == (double)(r % 3));
        CU_ASSERT(number(&t, r, "y_deg") == expected(r < 3 ? 0.125 : 2.385, 3, 77, r % 3));
    }
    CU_ASSERT(sql_number("SELECT count(*) FROM runs WHERE pile = run % 3") == 6);
    CU_ASSERT(sql_number("SELECT count(DISTINCT pile) FROM runs WHERE run IS NULL") == 6);
}

/* The noise of the run with these values, or NaN: y - x - k. */
static double noise(const rp_table *t, const char *x, const char *k, const char *replica)
{
    for (size_t r = 0; r < t->n_rows; r++)
        if (strcmp(cell(t, r, "x"), x) == 0 && strcmp(cell(t, r, "replica"), replica) == 0 &&
            (!k || strcmp(cell(t, r, "k"), k) == 0))
            return number(t, r, "y_deg");
    return NAN;
}

/* Plans that differ in one value, wherever it stands, have other digests: a store then numbers runs anew. */
static void test_digest_of_plan(void)
{
    static const char text[] =
        "replicas = 3; seed = 7; fixed = { mass = 2.0; }; grid = { x = [0.5, 1.5, 2.5]; k = [9, 8, 7]; };";
    static const char *const changes[][2] = {
        {"", ""},
        {"replicas = 3", "replicas = 4"},
        {"seed = 7", "seed = 8"},
        {"mass = 2.0", "mass = 3.0"},
        {"x = [0.5", "x = [0.6"},
        {"1.5", "1.6"},
        {"2.5]", "2.6]"},
        {"[9", "[5"},
        {"8", "5"},
        {"7]", "5]"},
        {"x = [0.5, 1.5, 2.5]; k = [9, 8, 7];", "k = [9, 8, 7]; x = [0.5, 1.5, 2.5];"},
        {"grid", "piles = \"shared\"; grid"}};
    enum { N = sizeof changes / sizeof *changes };
    char digests[N][33];
    fresh("");
    for (size_t i = 0; i < N; i++) {
        RP_ENDS(sweep_plan_free) sweep_plan plan;
        write_sweep(check_changed(text, changes[i][0], changes[i][1]));
        CHECK_OK(sweep_plan_read(file, toys, &plan));
        memcpy(digests[i], plan.hash, sizeof digests[i]);
        for (size_t j = 0; j < i; j++) CU_ASSERT_STRING_NOT_EQUAL(digests[i], digests[j]);
    }
}

/* A stored run is that of its values and replica, wherever its point stands in the grid: put in between,
 * append, permute, take a parameter from fixed into the grid, group lists anew, ask for more replicas. */
static void test_growing(void)
{
    static const struct {
        const char *text;
        size_t planned, stored;
        const char *k;
    } steps[] = {
        {"replicas = 3; grid = { x = [0.125, 2.385]; };", 6, 0, NULL},
        {"replicas = 3; grid = { x = [0.125, 1.5, 2.385]; };", 9, 6, NULL},
        {"replicas = 3; grid = { x = [0.125, 1.5, 2.385, 7.5]; };", 12, 9, NULL},
        {"replicas = 3; grid = { x = [7.5, 2.385, 0.125, 1.5]; };", 12, 12, NULL},
        {"replicas = 5; grid = { x = [7.5, 2.385, 0.125, 1.5]; };", 20, 12, NULL},
        {"replicas = 5; grid = { x = [7.5, 2.385, 0.125, 1.5]; k = [3, 4]; };", 40, 20, "3"},
        {"replicas = 5; grid = { k = [4, 3]; x = [7.5, 2.385, 0.125, 1.5]; };", 40, 40, "3"},
        {"replicas = 5; grid = ({ k = [4, 3]; x = [1.5, 2.385]; }, { odd = [false, true]; });", 20, 10, "3"},
        {"replicas = 2; fixed = { k = 3; }; grid = { x = [0.125, 2.385]; };", 4, 4, NULL}};
    fresh("");
    double first = NAN;
    for (size_t i = 0; i < sizeof steps / sizeof *steps; i++) {
        file_print(file, "protocol = \"toy\"; seed = 77; %s", steps[i].text);
        CHECK_OK(prepare());
        CU_ASSERT(c.planned == steps[i].planned && c.stored == steps[i].stored);
        CHECK_OK(run(2));
        CU_ASSERT(c.stored == c.planned);
        scoped_table t = exported(SWEEP_RUNS);
        if (i == 0) first = noise(&t, "2.385", NULL, "1");
        CU_ASSERT(noise(&t, "2.385", steps[i].k, "1") == first);
    }
    CU_ASSERT(sql_number("SELECT count(DISTINCT y_deg - coalesce(parameters ->> 'k', 3)"
                         " - (parameters ->> 'x')) = count(*) FROM runs") == 1); /* no two share a stream */
    CHECK_FAILS(sweep_prepare(file, dir, 5000001, toys, NULL, &c), RP_BAD_INPUT, "allowed: [1, 5000000]");
}

/* Student's t for 3 degrees of freedom at 97.5 %: 3.182446305284263 (tables). */
static void test_reduce(void)
{
    made_by(2, "replicas = 8; piles = \"shared\";grid = { mode = [\"half_no_pile\"]; x = [1.25, 2.75]; };");
    sql("DELETE FROM runs WHERE run = 14"); /* one result of the second point is missing */
    scoped_table t = exported(SWEEP_POINTS);
    CU_ASSERT_FATAL(t.n_rows == 2);
    double y[4], mean = 0.0, square = 0.0;
    for (size_t i = 0; i < 4; i++) mean += (y[i] = expected(1.25, 3, 1993, 2 * i)) / 4.0;
    for (size_t i = 0; i < 4; i++) square += (y[i] - mean) * (y[i] - mean);
    double sd = sqrt(square / 3.0), half = 3.182446305284263 * sd / 2.0;
    const double tolerance = 1e-13; /* a few roundings of numbers near 5, and of the quantile */
    CU_ASSERT_STRING_EQUAL(cell(&t, 0, "mode"), "half_no_pile");
    CHECK_EACH(number(&t, 0, NAME), tolerance, {"y_deg_mean", mean}, {"y_deg_sd", sd}, {"y_deg_se", sd / 2.0},
               {"y_deg_lo95", mean - half}, {"y_deg_hi95", mean + half});
    CHECK_EACH(number(&t, 0, NAME), 0.0, {"y_deg_n", 4.0}, {"never_n", 0.0}, {"n", 4.0}, {"n_failed", 4.0});
    CU_ASSERT_STRING_EQUAL(cell(&t, 0, "never_mean"), "nan");
    CHECK_EACH(number(&t, 1, NAME), 0.0, {"x", 2.75}, {"n", 3.0});
    scoped char *text = protocol_export(dir, toys, SWEEP_POINTS);
    CHECK_PARTS(text, /* numbers n have no unit */
                "# units: 1\tcm\tdeg\tdeg\tdeg\tdeg\tdeg\t1\ts\ts\ts\ts\ts\t1\t1\t1\t1\n",
                "# missing: 1 of 16\n", "# failed: 8 of 15 (no_pile 8)\n", "# command: the command\n",
                "s.cfg, protocol toy, seed 1993, 2 grid points x 8 replicas, shared piles\n", "# k: 3\n");
    CU_ASSERT_PTR_NULL(strstr(text, "# x: "));
    CHECK_FAILS(sweep_digest(dir, toys, (char[33]){0}, &(size_t){0}), RP_NO_RESULT,
                "1 of 16 runs are missing");
}

/* A result is a row whose status begins with ok; whatever else ended a run, its numbers count nowhere. */
static void test_statuses(void)
{
    static const char *const words[] = {"ok",          "ok_fixed_time", /* the results */
                                        "not_at_rest", "no_pile",       "leaked",     "overlap", "crashed",
                                        "not_level",   "no_response",   "not_solved", "broken",  "not_ok"};
    made_by(1, "replicas = 4; piles = \"shared\"; fixed = { x = 2.385; };");
    for (size_t k = 0; k < sizeof words / sizeof *words; k++) {
        sweep_row row = {.run = 1, .seconds = 1.0, .result.values = {expected(2.385, 3, 1993, 1), NAN}};
        const bool result = k < 2;
        snprintf(row.result.status, sizeof row.result.status, "%s", words[k]);
        sql("DELETE FROM runs WHERE run = 1");
        CHECK_OK(put_row(&row));
        CU_ASSERT(stored() == 4 && c.failed == (result ? 0 : 1));
        scoped_table t = exported(SWEEP_POINTS);
        const double results = result ? 4.0 : 3.0;
        CHECK_EACH(number(&t, 0, NAME), 0.0, {"n", results}, {"y_deg_n", results},
                   {"n_failed", 4.0 - results});
        double mean = 0.0;
        for (unsigned long i = 0; i < 4; i++)
            if (result || i != 1) mean += expected(2.385, 3, 1993, i) / results;
        CHECK_NEAR(number(&t, 0, "y_deg_mean"), mean, 1e-13);
    }
}

/* A run is stored once: a second result under the same key is refused, and the first stays. */
static void test_stored_once(void)
{
    const sweep_row row = {.run = 2, .seconds = 1.0, .result = {.status = "ok", .values = {99.0, 98.0}}};
    made_by(1, "replicas = 4; fixed = { x = 2.385; };");
    const char *before = digest(4);
    CHECK_FAILS(put_row(&row), RP_IO, "cannot store run 2");
    CU_ASSERT_STRING_EQUAL(digest(4), before);
    CU_ASSERT(sql_number("SELECT count(*) FROM runs WHERE y_deg = 99") == 0);
}

#define SLOW_SWEEP                                                                                           \
    "replicas = 15; piles = \"shared\"; fixed = { mode = \"slow\"; }; grid = { x = "                         \
    "[0.125, 2.385]; };"
enum { SLOW_RUNS = 30 };

/* Run the sweep in a separate process, and send it `signal` once `rows` rows are stored. */
static int interrupted(int signal, size_t rows)
{
    int end = 0;
    hold = shared_number();
    c.stored = 0;
    *hold = 1;
    pid_t child = fork();
    if (child == 0) _exit((int)run(2));
    while (c.stored < rows && waitpid(child, &end, WNOHANG) == 0) {
        CHECK_OK(sweep_status(dir, toys, &c));
        usleep(2000);
    }
    kill(child, signal);
    *hold = 0;
    waitpid(child, &end, 0);
    return end;
}

/* Rows are the same rows afterwards: their times are in their sums. */
#define KEEP "CREATE TABLE kept AS SELECT key, sum FROM runs"
#define KEPT "SELECT count(*) FROM runs JOIN kept USING (key, sum)"

static void test_digest(void)
{
    made_by(1, SLOW_SWEEP);
    const char *one = digest(SLOW_RUNS);
    made_by(2, SLOW_SWEEP);
    CU_ASSERT_STRING_EQUAL(digest(SLOW_RUNS), one);

    planned(SLOW_SWEEP);
    int end = interrupted(SIGKILL, 4);
    CU_ASSERT(WIFSIGNALED(end) && WTERMSIG(end) == SIGKILL && stored() >= 4 && c.stored < SLOW_RUNS);
    const size_t first = c.stored;
    sql(KEEP);
    CHECK_OK(run(2));
    CU_ASSERT_STRING_EQUAL(digest(SLOW_RUNS), one);
    CU_ASSERT(sql_number(KEPT) == (sqlite3_int64)first);

    sql("DELETE FROM runs WHERE run >= 5");
    end = interrupted(SIGTERM, 9);
    CU_ASSERT(WIFEXITED(end) && WEXITSTATUS(end) == RP_STOPPED && stored() >= 9 && c.stored < SLOW_RUNS);
    CHECK_OK(run(3));
    CU_ASSERT_STRING_EQUAL(digest(SLOW_RUNS), one);
}

/* Workers that outlive the parent would continue, and could hold the lock. */
static size_t stored_before; /* the drive */

static void count_calls(const sweep_progress *p, void *context)
{
    size_t *calls = context;
    CU_ASSERT(p->planned == SLOW_RUNS && p->stored <= p->planned && p->failed == 0);
    CU_ASSERT(isnan(p->left) ? p->stored == stored_before : p->left >= 0.0);
    CU_ASSERT(p->stored < p->planned || p->left == 0.0);
    const double finished = (double)(p->stored - stored_before), left = (double)(p->planned - p->stored);
    CU_ASSERT(p->elapsed >= 0.0 && isfinite(p->elapsed));
    if (finished > 0.0) CHECK_NEAR(p->left, p->elapsed * left / finished, 1e-12);
    if (++*calls == 3) raise(SIGINT); /* blocked: seen by the pool, not by this process */
}

static void test_stop(void)
{
    planned(SLOW_SWEEP);
    made = shared_number();
    size_t calls = 0;
    sweep_options o = {.workers = 1, .watch = count_calls, .context = &calls};
    CHECK_FAILS(sweep_run(dir, toys, &o, &c), RP_STOPPED, " of 30 stored; run again to resume");
    CU_ASSERT(stored() > 0 && c.stored < SLOW_RUNS);
    CU_ASSERT(c.stored == (size_t)*made);        /* the run that a worker was at has ended, and is there */
    CU_ASSERT(waitpid(-1, NULL, WNOHANG) == -1); /* no worker is left */
    o.workers = 2;
    stored_before = c.stored;
    CHECK_OK(sweep_run(dir, toys, &o, &c));
    CU_ASSERT(c.stored == SLOW_RUNS && waitpid(-1, NULL, WNOHANG) == -1);
    size_t before = calls;
    CHECK_OK(sweep_run(dir, toys, &o, &c)); /* nothing to do */
    CU_ASSERT(calls == before && c.stored == SLOW_RUNS);
    sql("DELETE FROM sweep"); /* as it is before a plan has been entered */
    CHECK_FAILS(sweep_status(dir, toys, &c), RP_BAD_INPUT, "plan again with");
}

static void test_crash(void)
{
    planned("replicas = 10; piles = \"shared\"; fixed = { mode = \"crash\"; };");
    CHECK_FAILS(run(2), RP_NO_RESULT, "3 of 10 runs were aborted (crashed 3); the same command retries them");
    CU_ASSERT(c.stored == 10 && c.failed == 3 && c.words.of[0].times == 3.0);
    CHECK_FAILS(sweep_digest(dir, toys, (char[33]){0}, &(size_t){0}), RP_NO_RESULT,
                ": 3 of 10 runs were aborted");
    CU_ASSERT_STRING_EQUAL(c.words.of[0].word, "crashed");
    CU_ASSERT(sql_number("SELECT count(*) FROM runs WHERE status = 'crashed' AND run % 3 = 1 AND y_deg IS "
                         "NULL AND message = 'worker ended by signal 6 (Aborted)'") == 3);
    /* a crash may be the machine's fault: only crashed runs are repeated */
    sql(KEEP " WHERE status <> 'crashed'");
    CHECK_FAILS(run(1), RP_NO_RESULT, "crashed 3");
    CU_ASSERT(c.stored == 10 && c.failed == 3 && sql_number(KEPT) == 7);
    /* an error of the protocol, in contrast, stops the sweep; stored runs stay */
    planned("replicas = 6; piles = \"shared\"; fixed = { mode = \"break\"; };\n"
            "grid = { x = [0.5, 1.5, 2.5, 3.5]; };");
    CHECK_FAILS(run(1), RP_BROKEN, "run 3 (x = 0.5): planted failure");
    CU_ASSERT(stored() == 3);
}

/* A run may take what its limit says beyond what the process has; a worker has its socket alone, and no other
 * worker's, nor the store or the lock. */
static void test_limits(void)
{
    static const double limits[] = {0.0, INFINITY, 34.0, 26.0, 0.5};
    for (size_t k = 0; k < sizeof limits / sizeof *limits; k++) {
        const bool fails = limits[k] > 0.0 && limits[k] < 30.0;
        const sweep_options o = {.workers = 2, .memory = limits[k]};
        if (isnormal(limits[k]) && check_fast()) continue; /* a sanitizer takes memory of its own */
        planned("replicas = 4; fixed = { mode = \"take\"; k = 30; };");
        CHECK_FAILS_IF(fails, sweep_run(dir, toys, &o, &c), RP_NO_RESULT, "(no_memory 4)");
        CU_ASSERT(fails || sql_number("SELECT count(*) FROM runs WHERE y_deg = 1") == 4);
    }
}

/* A run that is shorter than the limits of time is no failure, nor one that waits for a while. */
static void test_within_limits(void)
{
    planned("replicas = 2; fixed = { mode = \"sleep\"; };");
    CHECK_OK(sweep_run(dir, toys, &(sweep_options){.workers = 2, .time = 30.0, .patience = 30.0}, &c));
    CU_ASSERT(c.stored == 2 && c.failed == 0);
}

/* All workers that are busy end their runs when a drive is stopped. */
static void interrupt(const sweep_progress *p, void *context)
{
    size_t *calls = context;
    if (p->planned == 4 && ++*calls == 1) raise(SIGINT);
}

static void test_stop_of_all(void)
{
    size_t calls = 0;
    planned("replicas = 4; fixed = { mode = \"sleep\"; };");
    const sweep_options o = {.workers = 2, .watch = interrupt, .context = &calls};
    CHECK_FAILS(sweep_run(dir, toys, &o, &c), RP_STOPPED, "stopped: 2 of 4 stored");
    CU_ASSERT_EQUAL(stored(), 2);
}

/* A shard, or the folder of another machine, that a killed process or a broken copy left half made is named
 * and left out; the others are read. */
static void test_half_made(void)
{
    enum { EMPTY, NO_TABLE, CUT, FOLDER, KINDS };
    size_t size;
    fresh("replicas = 4;");
    CHECK_OK(rp_make_directory(dir));
    file_write(store, "", 0);
    CHECK_FAILS(sweep_status(dir, toys, &c), RP_BAD_INPUT, "sweep.cfg: cannot read");
    for (int kind = 0; kind < KINDS; kind++)
        for (int named = 0; named < 2; named++) {
            const sweep_options second = {.workers = 1, .shard = 2, .shards = 2};
            CHECK_OK(prepare());
            CHECK_OK(sweep_run(dir, toys, &second, &c));
            const char *folder = named ? other : folder_path(dir, "shards"),
                       *path = folder_path(folder, named ? "store.sqlite" : "1-of-2.sqlite");
            mkdir(folder, 0777);
            if (kind == FOLDER) mkdir(path, 0777);
            if (kind == EMPTY) file_write(path, "", 0);
            if (kind == NO_TABLE) sql_in(path, "CREATE TABLE a (b); DROP TABLE a");
            scoped char *bytes = file_read(store, &size);
            if (kind == CUT) file_write(path, bytes, 60);
            CU_ASSERT(stored() == 2 && (named || strstr(c.skipped, "/shards/1-of-2.sqlite")));
            CU_ASSERT_STRING_EQUAL(c.shards, "1 of 2");
            scoped char *text = protocol_export(dir, toys, SWEEP_RUNS);
            CU_ASSERT(*text && named == !strstr(text, "# left out, no stores yet: /tmp/"));
            char *const both[] = {other, (char *)folder_path(dir, "shards/2-of-2.sqlite")};
            CHECK_OK(sweep_merge(dir, toys, named ? 2 : 0, both, &m, &c));
            CU_ASSERT(m.stores == 1 && c.stored == 2 && strstr(c.skipped, path));
            if (named) CHECK_FAILS(sweep_merge(dir, toys, 1, others, &m, &c), RP_BAD_INPUT, "none yet: ");
            CHECK_OK(run(1));
            CU_ASSERT(c.stored == 4 && (named || strstr(c.skipped, path)));
            folder_remove(dir), folder_remove(other);
        }
}

/* One row of a store is another than its checksum says: no reader takes it, in the sweep's store, in a shard
 * or in another machine's, under its number, under that of another run, and without. */
static void test_damaged_rows(void)
{
    static const char *const damages[] = {"UPDATE runs SET y_deg = y_deg + 1e-15 WHERE run = 4",
                                          "UPDATE runs SET status = 'no_pile' WHERE run = 4",
                                          "UPDATE runs SET program = CAST(program AS BLOB) WHERE run = 4",
                                          "UPDATE runs SET run = 44 WHERE run = 4",
                                          "UPDATE runs SET key = 'a' || substr(key, 2) WHERE run = 4",
                                          "UPDATE runs SET run = NULL, y_deg = 3 WHERE run = 4"};
    static const char message[] = "is damaged (checksum); `repose sweep salvage` keeps the whole rows";
    for (size_t k = 0; k < sizeof damages / sizeof *damages; k++)
        for (int where = 0; where < 3; where++) {
            made_by(1, "replicas = 8; grid = { x = [0.125, 2.385]; };");
            CHECK_OK(sweep_prepare(file, other, 0, toys, NULL, &c));
            if (where == 0) CHECK_OK(run_in(other, 1));
            const sweep_options half = {.workers = 1, .shard = 1, .shards = 2}; /* runs 0, 2, 4 ... */
            if (where == 1) sql("DELETE FROM runs");
            if (where > 0) CHECK_OK(sweep_run(where == 1 ? dir : other, toys, &half, &c));
            const char *path =
                folder_path(where == 2 ? other : dir, where ? "shards/1-of-2.sqlite" : "store.sqlite");
            sql_in(path, damages[k]);
            if (where < 2) {
                CHECK_FAILS(sweep_status(dir, toys, &c), RP_IO, message);
                CHECK_FAILS(sweep_digest(dir, toys, (char[33]){0}, &(size_t){0}), RP_IO, message);
                CHECK_FAILS(sweep_export(dir, toys, SWEEP_RUNS, NULL, NULL, stdout), RP_IO, message);
                CHECK_FAILS(run(1), RP_IO, message);
                CHECK_FAILS(sweep_run(dir, toys, &half, &c), RP_IO, message);
            }
            CHECK_FAILS(sweep_merge(dir, toys, where != 1, others, &m, &c), RP_IO, message);
            CU_ASSERT(sql_number("SELECT count(*) FROM runs") == (where == 1 ? 0 : 16));
            CU_ASSERT(strncmp(rp_message(), path, strlen(path)) == 0);
        }
}

/* Rows keep the name of the program that made them, when they are merged too, and a table counts them. */
static void test_makers(void)
{
    static const char program[] = "repose 0.1.9, commit 0123abc-dirty, gcc 9";
    planned("replicas = 4; fixed = { x = 2.385; };");
    CHECK_OK(sweep_prepare(file, other, 0, toys, NULL, &c));
    RP_ENDS(sweep_plan_free) sweep_plan plan;
    sweep_store *opened;
    CHECK_OK(sweep_plan_read(file, toys, &plan));
    CHECK_OK(sweep_store_open(folder_path(other, "store.sqlite"), SWEEP_WRITE, &opened));
    for (size_t k = 0; k < 2; k++) { /* two rows by another program, as one of another commit writes them */
        strcpy(opened->program, program);
        const sweep_row row = {.run = k, .seconds = 1.0, .result = {.status = "ok", .values = {1.0, NAN}}};
        CHECK_OK(sweep_store_insert(opened, &plan, &row));
    }
    sweep_store_close(opened);
    CHECK_OK(sweep_merge(dir, toys, 1, others, &m, &c));
    CHECK_OK(run(1));
    scoped char *text = protocol_export(dir, toys, SWEEP_RUNS);
    const char *plain = check_text("# runs made by: repose %s, commit %s, %s (2)\n", RP_VERSION,
                                   rp_build_commit, rp_build_compiler);
    CHECK_PARTS(text, "# runs made by: repose 0.1.9, commit 0123abc-dirty, gcc 9 (2)\n", plain);
}

/* Runs that crashed are made again, and forgotten then; those of another plan stay. */
static void test_crashed_of_another_plan(void)
{
    static const char crashed[] = "SELECT count(*) FROM runs WHERE status = 'crashed' AND run IS NULL";
    planned("replicas = 4; piles = \"shared\"; fixed = { mode = \"crash\"; };");
    CHECK_FAILS(run(1), RP_NO_RESULT, "crashed 1");
    write_sweep("replicas = 4; piles = \"shared\"; fixed = { x = 2.385; };");
    CHECK_OK(prepare());
    CHECK_OK(run(1));
    CU_ASSERT(sql_number(crashed) == 1);
    CHECK_OK(sweep_prepare(file, other, 0, toys, NULL, &c));
    CHECK_OK(run_in(other, 1));
    CHECK_OK(sweep_merge(dir, toys, 1, others, &m, &c));
    CU_ASSERT(m.duplicates == 4 && sql_number(crashed) == 1);
}

/* Files and folders that may only be read: a finished sweep, and its shards, are read all the same. */
static void test_read_only(void)
{
    static const char *const names[] = {"sweep.cfg", "store.sqlite", "lock", "shards/2-of-3.sqlite", "shards",
                                        ""};
    made_by(1, "replicas = 6;");
    const sweep_options shard = {.workers = 1, .shard = 2, .shards = 3};
    sql("DELETE FROM runs WHERE run IN (1, 4)");
    CHECK_OK(sweep_run(dir, toys, &shard, &c));
    const char *right = digest(6);
    chmod(base, 0755);
    for (int closed = 1; closed >= 0; closed--) { /* the folders too, or the files alone */
        for (size_t k = 0; k < sizeof names / sizeof *names; k++)
            chmod(folder_path(dir, names[k]), k < 4 ? 0444 : closed ? 0555 : 0777);
        const pid_t child = fork();
        if (child == 0) {
            size_t n;
            char found[33];
            if (geteuid() == 0 && setresuid(65534, 65534, 65534) != 0) _exit(9);
            const bool good = sweep_status(dir, toys, &c) == RP_OK && c.stored == 6 &&
                              sweep_digest(dir, toys, found, &n) == RP_OK && strcmp(found, right) == 0 &&
                              *protocol_export(dir, toys, SWEEP_RUNS);
            if (!good) fprintf(stderr, "read-only: %s\n", rp_message());
            _exit(!good);
        }
        int end = 0;
        waitpid(child, &end, 0);
        CU_ASSERT_EQUAL(end, 0);
    }
    for (size_t k = 0; k < sizeof names / sizeof *names; k++) chmod(folder_path(dir, names[k]), 0777);
}

/* Names of folders are literal, also where SQLite takes names for addresses and shells for patterns. */
static void test_literal_names(void)
{
    static const char *const names[] = {"x[1]",   "y?z*",           "a%20b#c?mode=memory", "it's; \"q\"",
                                        "file:d", "file:d?mode=ro", "localhost",           "\xc3\xa9 \xff"};
    char before[PATH_MAX], right[33] = "";
    folder_make_in_memory("sweep", base);
    CU_ASSERT_FATAL(getcwd(before, sizeof before) && chdir(base) == 0);
    file_print("s.cfg", "protocol = \"toy\"; replicas = 6;");
    mkdir("x1", 0777);
    for (size_t k = 0; k < sizeof names / sizeof *names; k++) {
        char found[33];
        size_t n;
        CHECK_OK(sweep_prepare("s.cfg", names[k], 0, toys, NULL, &c));
        for (int i = 1; i <= 2; i++)
            CHECK_OK(sweep_run(names[k], toys, &(sweep_options){.workers = 1, .shard = i, .shards = 2}, &c));
        CHECK_OK(sweep_status(names[k], toys, &c));
        CHECK_OK(sweep_merge(names[k], toys, 0, NULL, &m, &c));
        CU_ASSERT(m.stores == 2 && m.taken == 6);
        CHECK_OK(sweep_digest(names[k], toys, k ? found : right, &n));
        CU_ASSERT(k == 0 || strcmp(found, right) == 0);
        CU_ASSERT(size_of(folder_path(names[k], "shards/2-of-2.sqlite")) > 0);
        CU_ASSERT(size_of(folder_path(names[k], "store.sqlite")) > 0);
    }
    /* random ones: the folder, and nothing else, is there */
    scoped_rng *rng = numbers_of(2385, 10);
    for (int k = 0; k < (check_fast() ? 100 : 1000); k++) {
        char name[NUMBERS_TEXT + 2] = "d/";
        numbers_text(rng, "/", name + 2);
        if (strspn(name + 2, ".") == strlen(name + 2)) continue;
        CHECK_OK(sweep_prepare("s.cfg", name, 0, toys, NULL, &c));
        CHECK_OK(sweep_status(name, toys, &c));
        CU_ASSERT(size_of(folder_path(name, "store.sqlite")) > 0);
        folder_remove(name);
        CU_ASSERT(rmdir("d") == 0);
    }
    CU_ASSERT(access("hit", F_OK) != 0);
    CU_ASSERT(rmdir("x1") == 0 && access("d", F_OK) != 0 && access("a b", F_OK) != 0);
    CU_ASSERT(chdir(before) == 0);
}

/* A snapshot that a killed drive left goes once all runs are stored; others, known by their names, do not. */
static void test_left_snapshots(void)
{
    static const char key[] = "0123456789abcdef0123456789abcdef";
    static const struct {
        const char *format;
        bool own;
        const char *text;
    } files[] = {{"%s", true, "repose snapshot\n"},
                 {"%s.new", true, "repose snapshot\n"},
                 {"photo.png", false, ""},
                 {"%s0", false, "repose snapshot\n"},
                 {"%.31s", false, "repose snapshot\n"},
                 {"1%.31s", true, "repose snapshot\n"}};
    planned("replicas = 4; fixed = { mode = \"crash\"; }; piles = \"shared\";");
    const char *in = folder_path(dir, "snapshots");
    mkdir(in, 0777);
    for (int done = 0; done < 2; done++) {
        for (int checks = 0; checks < 2; checks++) {
            for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
                const char *name = check_text(files[i].format, key);
                if (checks)
                    CU_ASSERT((access(folder_path(in, name), F_OK) != 0) == (done && files[i].own))
                else
                    file_write(folder_path(in, name), files[i].text, strlen(files[i].text));
            }
            calm = done;
            if (!checks) CU_ASSERT(run(1) == (done ? RP_OK : RP_NO_RESULT));
        }
    }
    calm = false;
}

static void test_plan_again(void)
{
    made_by(1, "replicas = 2; grid = { x = [0.5, 1.5, 2.5]; };");
    write_sweep("replicas = 2; grid = { x = [0.5, 1.75, 2.5, 3.5]; };");
    CHECK_OK(prepare());
    CU_ASSERT(c.planned == 8 && c.stored == 4); /* x = 1.5 is no longer planned, but stays in the store */
    CU_ASSERT(sql_number("SELECT count(*) FROM runs") == 6);
    scoped_table t = exported(SWEEP_RUNS);
    CU_ASSERT(t.n_rows == 4);
    sql(KEEP);
    CHECK_OK(run(2));
    CU_ASSERT(c.stored == 8 && sql_number(KEPT) == 6);
    write_sweep("replicas = 2; seed = 1994; grid = { x = [0.5, 1.75, 2.5, 3.5]; };");
    CHECK_OK(prepare());
    CU_ASSERT(c.stored == 0); /* another seed, other results */
    write_sweep("replicas = 2; grid = { x = [0.5, 1.75, 2.5, 3.5]; };");
    CHECK_OK(sweep_prepare(file, dir, 0, changed, NULL, &c)); /* no stored run matches */
    CU_ASSERT(c.planned == 8 && c.stored == 0);
    CHECK_OK(prepare());
    CU_ASSERT(c.stored == 8);
    file_print(file, "protocol = \"other\"; replicas = 2;");
    CHECK_FAILS(prepare(), RP_BAD_INPUT, "holds runs of protocol \"toy\", not \"other\"");
    CHECK_OK(sweep_status(dir, toys, &c)); /* and the refused plan changed nothing */
    CU_ASSERT(c.planned == 8);
    /* a copy of the file that was edited in place */
    const char *copy = folder_path(dir, "sweep.cfg");
    file_print(copy, "protocol = \"toy\"; replicas = 2; grid = { x = [0.5]; };");
    CHECK_FAILS(sweep_status(dir, toys, &c), RP_BAD_INPUT, "plan again");
    CHECK_FAILS(run(1), RP_BAD_INPUT, "plan again");
    CHECK_OK(sweep_prepare(copy, dir, 0, toys, NULL, &c)); /* the folder's own file can be planned */
    CU_ASSERT(c.planned == 2);
    /* an output that the store has no column for yet */
    sql("DELETE FROM runs; ALTER TABLE runs DROP COLUMN never");
    CHECK_FAILS(run(1), RP_IO, "never");
    CHECK_OK(sweep_prepare(copy, dir, 0, toys, NULL, &c));
    CHECK_OK(run(1));
}

/* The toy protocol with an output before its own. */
static const sweep_output further_outputs[] = {
    {"further", "", "later"}, {"y_deg", "deg", "x + k + noise"}, {"never", "s", "has no value"}, {0}};

static rp_status further_run(const void *params, unsigned long seed, unsigned long run,
                             const sweep_tables *tables, sweep_result *result)
{
    const rp_status status = toy_run(params, seed, run, tables, result);
    result->values[1] = result->values[0];
    result->values[0] = 2.385;
    return status;
}

/* A protocol gets a further output: its runs stay stored, the new ones have its value, and a table says how
 * many lack it. A store without its column can be merged. A program without this output refuses the store. */
static void test_further_output(void)
{
    sweep_protocol further = toy_protocol;
    further.outputs = further_outputs;
    further.run = further_run;
    const sweep_protocol *const later[] = {&further, NULL};
    const sweep_options one = {.workers = 1};
    char found[33];
    size_t rows;
    made_by(1, "replicas = 2; grid = { x = [0.5, 1.5]; };");
    CHECK_FAILS(sweep_status(dir, later, &c), RP_BAD_INPUT, "plan again");
    CHECK_OK(sweep_prepare(file, other, 0, toys, NULL, &c));
    CHECK_OK(sweep_run(other, toys, &one, &c));
    CHECK_OK(sweep_prepare(file, dir, 3, later, NULL, &c));
    CU_ASSERT(c.planned == 6 && c.stored == 4);
    sql(KEEP);
    CHECK_OK(sweep_run(dir, later, &one, &c));
    CU_ASSERT(c.stored == 6 && sql_number(KEPT) == 4);
    CU_ASSERT(sql_number("SELECT count(*) FROM runs WHERE further = 2.385") == 2);
    CU_ASSERT(sql_number("SELECT count(*) FROM runs WHERE further = 'none' AND never IS NULL") == 4);
    CHECK_OK(sweep_digest(dir, later, found, &rows));
    CU_ASSERT(rows == 6);
    scoped char *text = protocol_export(dir, later, SWEEP_RUNS);
    CHECK_PARTS(text, "# no value: further of 4 runs, stored before the program had this output\n", "\tnan\t",
                "\t2.385\t");
    CHECK_OK(sweep_merge(dir, later, 1, (char *const[]){other}, &m, &c));
    CU_ASSERT(m.duplicates == 4 && m.taken == 0);
    CHECK_OK(sweep_prepare(file, other, 0, later, NULL, &c));
    CU_ASSERT(c.planned == 4 && c.stored == 4);
    sql("DELETE FROM runs WHERE further = 'none'");
    CHECK_OK(sweep_merge(dir, later, 1, (char *const[]){other}, &m, &c));
    CU_ASSERT(m.taken == 4 && c.stored == 6);
    CHECK_FAILS(sweep_prepare(file, dir, 0, toys, NULL, &c), RP_BAD_INPUT,
                "its runs have the output further, which the text, or this version of the program, lacks; "
                "plan in another folder");
    CHECK_OK(sweep_status(dir, later, &c)); /* and the refused plan changed nothing */
}

/* A sweep file that is refused with this message, and makes no folder. */
static void check_bad(const char *before, size_t n, const char *const cases[][2])
{
    for (size_t i = 0; i < n; i++) {
        fresh("");
        file_print(file, "%s%s", before, cases[i][0]);
        file_print(folder_path(base, "more.cfg"), "replicas = 2;");
        CHECK_FAILS(prepare(), RP_BAD_INPUT, cases[i][1]);
        CU_ASSERT(access(dir, F_OK) != 0);
    }
}

static void test_bad_files(void)
{
    static const char *const
        whole[][2] = {{"replicas = 2;",
                       "s.cfg: protocol or experiment: missing (kind of experiment), allowed: toy | other"},
                      {"protocol = \"sand\";",
                       "s.cfg:1: protocol = \"sand\": unknown word, allowed: toy | other"},
                      {"protocol = 4;", "s.cfg:1: protocol = 4: a word expected"},
                      {"protocol = \"toy\"; grid = { k = [1, 2]; x = [0.5, 1.5, 0.50]; };",
                       "s.cfg:1: grid point k = 1, x = 0.5: appears twice in the grid"},
                      {"protocol = \"toy\"; zip = true; grid = { k = [1, 2, 1]; x = [0.5, 1.5, 0.5]; };",
                       "s.cfg:1: grid point k = 1, x = 0.5: appears twice in the grid"},
                      {"protocol = \"toy\"\n\nfixed = {", "s.cfg:3: syntax error"},
                      {"protocol = \"toi\";", "unknown word, allowed: toy | other (did you mean \"toy\"?)"}},
        *const parts[][2] = {
            {"replicas = 0;", "s.cfg:2: replicas = 0: out of range, allowed: [1, 1000000]"},
            {"replicas = 2.5;", "s.cfg:2: replicas = 2.5: a whole number expected"},
            {"seed = -1;", "s.cfg:2: seed = -1: out of range"},
            {"seed = 4294967296;", "s.cfg:2: 4294967296: whole numbers go up to"},
            {"zip = 1;", "s.cfg:2: zip = 1: true or false expected"},
            {"piles = \"mine\";", "s.cfg:2: piles = \"mine\": unknown word, allowed: own | shared"},
            {"piles = true;", "s.cfg:2: piles = true: a word expected"},
            {"speed = 1;", "s.cfg:2: speed: unknown key"},
            {"protocol = \"toy\";", "s.cfg:2: duplicate"},
            {"fixed = [1];", "s.cfg:2: fixed: a group"},
            {"grid = 3;", "s.cfg:2: grid: a group"},
            {"fixed = { z = 1; };",
             "s.cfg:2: fixed.z: unknown key; allowed: x mass k odd mode picks; see repose params toy"},
            {"fixed = { x = 11; };", "s.cfg:2: fixed.x = 11: out of range, allowed: [-10, 10] cm"},
            {"fixed = { x = \"a\"; };", "s.cfg:2: fixed.x = \"a\": a number expected"},
            {"fixed = { x = 1e400; };", "s.cfg:2: fixed.x = inf: a finite number"},
            {"fixed = { x = [1.0, 2.0]; };", "s.cfg:2: fixed.x: one value expected, not a list"},
            {"fixed = { mode = \"blue\"; };", "s.cfg:2: fixed.mode = \"blue\": unknown word"},
            {"grid = { z = [1]; };", "s.cfg:2: grid.z: unknown key"},
            {"grid = { mas = [1]; };", "s.cfg:2: grid.mas: unknown key (did you mean \"mass\"?)"},
            {"replica = 2;", "s.cfg:2: replica: unknown key (did you mean \"replicas\"?); "
                             "allowed: protocol experiment replicas study seed"},
            {"grid = { x = 1.0; };", "s.cfg:2: x: a list"},
            {"grid = { x = [ ]; };", "s.cfg:2: x: a list"},
            {"grid = { x = [0, 0.1]; };", "s.cfg:2: mismatched element type in array: [ ] holds"},
            {"grid = { x = (0.5,\n -11); };", "s.cfg:3: grid.x = -11: out of range"},
            {"grid = { x = ((0.5)); };", "s.cfg:2: grid.x: one value expected"},
            {"grid = { picks = [\"red\"]; };", "s.cfg:2: picks: cannot vary"},
            {"fixed = { x = 1; };\ngrid = { x = [1]; };", "s.cfg:3: x: appears under fixed and"},
            {"grid = ( { x = [1, 2]; },\n { x = [1]; } );", "s.cfg:3: x: appears twice"},
            {"grid = ( 3 );", "s.cfg:2: grid: groups"},
            {"zip = true;\ngrid = ( { x = [1]; } );", "s.cfg:3: grid: zip = true is for"},
            {"zip = true;\ngrid = { x = [1, 2];\n k = [1]; };",
             "s.cfg:4: k: 1 values; lists that go together"},
            {"replicas = 1000000;\ngrid = { k = [1,2,3,4,5,6,7,8,9,10,11]; };", "too many runs"},
            {"grid = { k = [1, 2]; x = [0.5, 9.5]; };",
             "s.cfg: grid point k = 1, x = 9.5: x = 9.5: refused by the toy"},
            {"fixed = { x = 9.5; };", "s.cfg: parameters: x = 9.5: refused by the toy"},
            {"@include \"more.cfg\"\n", "s.cfg:2: @include"}};
    check_bad("", sizeof whole / sizeof *whole, whole);
    check_bad("protocol = \"toy\";\n", sizeof parts / sizeof *parts, parts);
    fresh("");
    unlink(file);
    CHECK_FAILS(prepare(), RP_BAD_INPUT, "s.cfg: cannot read: No such file");
    CHECK_FAILS(sweep_prepare(base, dir, 0, toys, NULL, &c), RP_BAD_INPUT, "is a directory");
}

#define SMALL_SWEEP "replicas = 40; fixed = { x = 2.385; };"

static void test_bad_folders(void)
{
    fresh(SMALL_SWEEP);
    CHECK_FAILS(run(1), RP_BAD_INPUT, "no such folder");
    CHECK_FAILS(sweep_status(dir, toys, &c), RP_BAD_INPUT, "sweep.cfg: cannot read");
    CHECK_FAILS(sweep_digest(dir, toys, (char[33]){0}, &(size_t){0}), RP_BAD_INPUT, "sweep.cfg: cannot read");
    CHECK_FAILS(sweep_export(dir, toys, SWEEP_POINTS, NULL, NULL, stdout), RP_BAD_INPUT,
                "sweep.cfg: cannot read");
    CHECK_FAILS(sweep_prepare(file, folder_path(file, "d"), 0, toys, NULL, &c), RP_IO,
                "cannot make the directory"); /* below a regular file */
    CHECK_OK(prepare());
    CHECK_FAILS(run(0), RP_BAD_INPUT, "workers = 0");
    const sweep_output *outputs;
    sweep_result result;
    const sweep_tables tables = {base, 1, NULL};
    RP_SCOPE(arena);
    CHECK_FAILS(sweep_trace(file, toys, 40, &tables, &arena, &outputs, &result), RP_BAD_INPUT,
                "allowed: [0, 39]");
    unlink(store);
    CHECK_FAILS(run(1), RP_IO, "store.sqlite: cannot open the store");
    mkdir(store, 0777);
    CHECK_FAILS(run(1), RP_IO, "store.sqlite: cannot open the store");
    CHECK_FAILS(prepare(), RP_IO, "store.sqlite: cannot open the store");
    rmdir(store);
    file_print(store, "this is not a database, although it is long enough to be taken for one at first sight "
                      "by a program that looks at the size only, which must be refused all the same.");
    CHECK_FAILS(sweep_status(dir, toys, &c), RP_IO,
                "store.sqlite: cannot read the store: file is not a database");
    CHECK_FAILS(run(1), RP_IO, "file is not a database");
    CHECK_FAILS(prepare(), RP_IO, "file is not a database");
    file_write(store, "", 0);
    CHECK_FAILS(sweep_status(dir, toys, &c), RP_BAD_INPUT, "plan again with `repose sweep plan`");
    CHECK_OK(prepare());
    FILE *full = fopen("/dev/full", "w");
    CU_ASSERT_PTR_NOT_NULL_FATAL(full);
    CHECK_FAILS(sweep_export(dir, toys, SWEEP_RUNS, NULL, NULL, full), RP_IO, "No space left on device");
    fclose(full);
}

/* The lock file counts drives that failed, one after another; a whole one begins anew. */
static void test_failed_drives(void)
{
    planned("replicas = 6; piles = \"shared\"; fixed = { mode = \"break\"; };");
    const char *path = folder_path(dir, "lock");
    for (int k = 1; k < 4; k++) {
        CHECK_FAILS(run(1), RP_BROKEN, "planted failure");
        size_t n;
        scoped unsigned char *count = file_read(path, &n);
        CU_ASSERT(n == 1 && *count == k);
    }
    write_sweep("replicas = 6;");
    CHECK_OK(prepare());
    CHECK_OK(run(1));
    CU_ASSERT(size_of(path) == 0);
}

/* A process that locks a file, and lives until it is killed. */
static pid_t start_holder(const char *path)
{
    int ready[2];
    char byte = 0;
    CU_ASSERT_FATAL(pipe(ready) == 0);
    const pid_t holder = fork();
    if (holder == 0) {
        const int lock = open(path, O_RDWR);
        byte = (char)fcntl(lock, F_SETLK, &(struct flock){.l_type = F_WRLCK, .l_whence = SEEK_SET});
        if (write(ready[1], &byte, 1) == 1) pause();
        _exit(1);
    }
    CU_ASSERT(read(ready[0], &byte, 1) == 1 && byte == 0);
    close(ready[0]);
    close(ready[1]);
    return holder;
}

static void test_lock(void)
{
    planned(SMALL_SWEEP);
    const char *path = folder_path(dir, "lock");
    const pid_t holder = start_holder(path); /* a second process on the same sweep is refused */
    CHECK_FAILS(run(1), RP_IO, "another process runs or plans this sweep");
    CHECK_FAILS(prepare(), RP_IO, "another process runs or plans this sweep");
    CHECK_OK(sweep_status(dir, toys, &c)); /* readers do not wait */
    kill(holder, SIGKILL);
    waitpid(holder, NULL, 0);
    CHECK_OK(run(1));
    unlink(path);
    mkdir(path, 0777);
    CHECK_FAILS(run(1), RP_IO, "lock: cannot write");
}

/* The digest has the whole word of each status. */
static void test_digest_of_words(void)
{
    const char *digests[3];
    for (int k = 0; k < 3; k++) {
        strcpy(ending, k == 1 ? "_b" : "_a");
        made_by(1, SMALL_SWEEP);
        digests[k] = digest(40);
    }
    *ending = 0;
    CU_ASSERT(strcmp(digests[0], digests[1]) != 0 && strcmp(digests[0], digests[2]) == 0);
}

/* ---- shards ---- */

#define GRID_SWEEP "replicas = 5; seed = 77; grid = { x = [0.125, 1.5, 2.385]; k = [3, 4, 5]; };"
enum { GRID_RUNS = 45 };

static rp_status run_shard(int shard, int shards)
{
    sweep_options o = {.workers = 1, .shard = shard, .shards = shards};
    rp_status status = sweep_run(dir, toys, &o, &c);
    size_t own = 0; /* every so many runs */
    for (int run = 0; run < GRID_RUNS; run++) own += run % shards == shard - 1;
    CU_ASSERT(status || (c.stored == own && c.planned == own));
    return status;
}

/* Shards in any order, some before and some after others were merged, give the digest of one process. */
static void test_shards(void)
{
    static const int orders[][9] = {{1, 1}, {3, 2, 3, 1}, {8, 3, 8, 1, 4, 2, 7, 5, 6}};
    made_by(2, GRID_SWEEP);
    const char *whole = digest(GRID_RUNS);
    for (size_t i = 0; i < sizeof orders / sizeof *orders; i++) {
        const int n = orders[i][0];
        planned(GRID_SWEEP);
        for (int k = 1; k < n; k++) {
            CHECK_OK(run_shard(orders[i][k], n));
            CHECK_OK(sweep_status(dir, toys, &c));
            if (n == 8 && k == 4) CU_ASSERT_STRING_EQUAL(c.shards, "2,5-7 of 8");
        }
        CHECK_OK(sweep_status(dir, toys, &c));
        char list[32] = "";
        if (n > 1) snprintf(list, sizeof list, "%d of %d", orders[i][n], n);
        CU_ASSERT_STRING_EQUAL(c.shards, list);
        if (n == 8) {
            CHECK_OK(sweep_merge(dir, toys, 0, NULL, &m, &c));
            CU_ASSERT(m.stores == 7 && m.taken == c.stored && m.duplicates == 0 && m.foreign == 0);
            CU_ASSERT_STRING_EQUAL(c.shards, list);
        }
        CHECK_OK(run_shard(orders[i][n], n));
        CU_ASSERT_STRING_EQUAL(digest(GRID_RUNS), whole); /* not merged yet */
        made = shared_number();
        CHECK_OK(run(1));
        CU_ASSERT(*made == 0); /* the shards have all of them */
        munmap((void *)made, sizeof *made);
        made = NULL;
        CHECK_OK(sweep_merge(dir, toys, 0, NULL, &m, &c));
        CU_ASSERT(c.stored == GRID_RUNS && m.stores == (size_t)n && !*c.shards);
        CHECK_OK(run_shard(1, n)); /* nothing to do */
        CU_ASSERT_STRING_EQUAL(digest(GRID_RUNS), whole);
    }
    planned("replicas = 3; seed = 77; grid = { x = [0.125]; };"); /* run 0 alone is left */
    for (int k = 2; k < 4; k++)
        CHECK_OK(sweep_run(dir, toys, &(sweep_options){.workers = 1, .shard = k, .shards = 3}, &c));
    CHECK_OK(sweep_status(dir, toys, &c));
    CU_ASSERT_STRING_EQUAL(c.shards, "1 of 3");
    planned(GRID_SWEEP);
    CHECK_FAILS(run_shard(4, 3), RP_BAD_INPUT, "shard = 4/3: out of range");
    CHECK_FAILS(sweep_merge(dir, toys, 0, NULL, &m, &c), RP_BAD_INPUT, "no shards, and no other store");
}

/* Folders made apart: the rows that both plans have count once; two results of one run refuse each other. */
static void test_merge(void)
{
    fresh(GRID_SWEEP);
    char *path = (char *)folder_path(other, "store.sqlite");
    write_sweep("replicas = 5; seed = 77; grid = { x = [0.125, 7.0]; k = [4, 3]; };");
    CHECK_OK(sweep_prepare(file, other, 0, toys, NULL, &c));
    CHECK_OK(run_in(other, 1));
    write_sweep(GRID_SWEEP);
    CHECK_OK(prepare());
    CHECK_OK(run_shard(2, 3));
    CHECK_OK(sweep_merge(dir, toys, 1, others, &m, &c));
    CU_ASSERT(m.stores == 1 && m.taken == 10 && m.foreign == 10 && m.duplicates == 0);
    CHECK_OK(sweep_merge(dir, toys, 1, others, &m, &c));
    CU_ASSERT(m.taken == 0 && m.duplicates == 10 && c.stored == 10);
    /* the first run of both with another result, and one that crashed */
    sweep_row row = {.run = 3, .seconds = 1.0, .result = {.status = "ok", .values = {NAN, NAN}}};
    sql_in(path, "DELETE FROM runs WHERE run = 3");
    row.result.values[0] = 2.385;
    CHECK_OK(put_row_in(other, &row));
    CHECK_FAILS(sweep_merge(dir, toys, 1, others, &m, &c), RP_BAD_INPUT, "another result than in the stores");
    CHECK_OK(sweep_status(dir, toys, &c));
    CU_ASSERT(c.stored ==
              22); /* 15 of the shard, 10 of the other, 3 of both: the refused merge took nothing */
    sql_in(path, "DELETE FROM runs WHERE run = 3");
    row.result.values[0] = NAN;
    strcpy(row.result.status, "crashed");
    CHECK_OK(put_row_in(other, &row));
    CHECK_OK(sweep_merge(dir, toys, 1, others, &m, &c)); /* a crash is no result */
    CHECK_OK(sweep_prepare(file, other, 0, changed, NULL, &c));
    CHECK_FAILS(sweep_merge(dir, toys, 1, others, &m, &c), RP_BAD_INPUT, "another model of the physics");
    file_print(path, "not a store");
    char *const files[] = {path};
    CHECK_FAILS(sweep_merge(dir, toys, 1, files, &m, &c), RP_IO, "not a database");
    CHECK_FAILS(sweep_merge(dir, toys, 1, others, &m, &c), RP_BAD_INPUT, "other/store.sqlite");
    unlink(path);
    CHECK_FAILS(sweep_merge(dir, toys, 1, files, &m, &c), RP_BAD_INPUT, "no store");
}

/* A run that crashed in one store and not in the other: the result counts, whichever takes the other. */
static void test_merge_of_crashed(void)
{
    for (int way = 0; way < 2; way++) {
        planned("replicas = 10; piles = \"shared\"; fixed = { mode = \"crash\"; };");
        CHECK_OK(sweep_prepare(file, other, 0, toys, NULL, &c));
        for (int k = 0; k < 2; k++) {
            calm = k == way;
            const rp_status status = sweep_run(k ? other : dir, toys, &(sweep_options){.workers = 1}, &c);
            CU_ASSERT(status == (calm ? RP_OK : RP_NO_RESULT) && sweep_count_aborted(&c) == (calm ? 0 : 3));
        }
        calm = false;
        CHECK_OK(sweep_merge(dir, toys, 1, others, &m, &c));
        CU_ASSERT(c.stored == 10 && c.failed == 0 && sweep_count_aborted(&c) == 0 && m.duplicates == 10);
        digest(10);
    }
}

/* ---- damage ---- */

/* One byte of the store changed anywhere: the export is refused, or has not changed. */
static void test_flips(void)
{
    enum { FLIPS = 400 };
    made_by(2, GRID_SWEEP);
    size_t size, refused = 0, silent = 0;
    scoped char *bytes = file_read(store, &size), *right = protocol_export(dir, toys, SWEEP_RUNS);
    CU_ASSERT(strlen(right) > 0);
    for (size_t i = 0; i < FLIPS; i++) {
        const size_t at = i * size / FLIPS + i % 97;
        const char before = bytes[at < size ? at : i], mask = (char)(1 << i % 8);
        bytes[at < size ? at : i] = before ^ mask;
        file_write(store, bytes, size);
        bytes[at < size ? at : i] = before;
        scoped char *text = protocol_export(dir, toys, SWEEP_RUNS);
        refused += !*text;
        silent += *text && strcmp(text, right) != 0;
    }
    CU_ASSERT(silent == 0 && refused > FLIPS / 4);
    if (silent) fprintf(stderr, "flips: %zu of %d silent\n", silent, FLIPS);
}

/* A truncated store: the rows that are whole are kept, the others are made again. */
static void test_salvage(void)
{
    made_by(2, "replicas = 300; seed = 77; grid = { x = [0.125, 1.5]; };");
    char right[33];
    strcpy(right, digest(600));
    size_t size, n, most = 0;
    scoped char *bytes = file_read(store, &size);
    const char *kept = folder_path(dir, "damaged.sqlite");
    for (int part = 3; part <= 9; part += 2) {
        file_write(store, bytes, size * (size_t)part / 10);
        CHECK_FAILS(sweep_export(dir, toys, SWEEP_RUNS, NULL, NULL, stdout), RP_IO, "store.sqlite");
        CHECK_OK(sweep_salvage(dir, toys, &n));
        CU_ASSERT(n < 600 && n >= most);
        CU_ASSERT(stored() == n); /* under their keys */
        most = n;
        CHECK_FAILS(sweep_salvage(dir, toys, &n), RP_BAD_INPUT, "kept of an earlier salvage");
        CHECK_OK(run(1));
        CU_ASSERT_STRING_EQUAL(digest(600), right);
        unlink(kept);
    }
    CU_ASSERT(most > 200);
}

/* Rows with long gaps before them, as lost pages leave them. */
static void test_salvage_gaps(void)
{
    size_t n;
    made_by(1, "replicas = 6; fixed = { x = 2.385; };");
    static const struct {
        const char *gap;
        size_t rows;
    } cases[] = {{"UPDATE runs SET rowid = rowid + 15000 WHERE rowid > 2;"
                  "UPDATE runs SET rowid = rowid + 15000 WHERE rowid > 15004",
                  6},
                 {"UPDATE runs SET rowid = rowid + 19998 WHERE rowid > 4", 6},
                 {"UPDATE runs SET rowid = rowid + 19999 WHERE rowid > 4", 4}}; /* no page holds as many */
    const char *kept = folder_path(dir, "damaged.sqlite");
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        sql(cases[k].gap);
        CHECK_OK(sweep_salvage(dir, toys, &n));
        CU_ASSERT_EQUAL(n, cases[k].rows);
        unlink(kept);
    }
}

/* Keys name stored runs for ever: these are of model version 3, whose number is in them. */
static void test_known_keys(void)
{
    static const struct {
        size_t run;
        const char *key;
        sweep_stream stream;
    } known[] = {{0, "08f14082c37571055360c1117678b2d8", {1811074078, 1036491614, 2173680461725484}},
                 {7, "85ad8f17f7b2b0004feb785eb4895c55", {285264182, 1505012168, 3156239277690893}},
                 {11, "6fe9683e0227a1056ee22c21ebd10978", {971569046, 562762702, 1180198924689040}}};
    char text[256];
    RP_ENDS(sweep_plan_free) sweep_plan plan;
    fresh(
        "replicas = 2; seed = 77; fixed = { k = 5; odd = true; };\n"
        "grid = ( { x = [0.5, -1.5]; mass = [1.0, 2.5]; }, { mode = [\"plain\", \"slow\", \"crash\"]; } );");
    CHECK_OK(sweep_plan_read(file, toys, &plan));
    CU_ASSERT(plan.n_points == 6 && plan.n_runs == 12);
    CU_ASSERT_STRING_EQUAL(plan.hash, "75c69abac8fb4d6eb75788b4acd85d41");
    for (size_t k = 0; k < sizeof known / sizeof *known; k++) {
        char key[33];
        sweep_plan_key(&plan, known[k].run, key);
        CU_ASSERT_STRING_EQUAL(key, known[k].key);
        const sweep_stream s = sweep_plan_stream(&plan, known[k].run);
        CU_ASSERT(s.seed == known[k].stream.seed && s.run == known[k].stream.run);
        CU_ASSERT_EQUAL(s.pile, known[k].stream.pile);
    }
    CU_ASSERT_STRING_EQUAL(sweep_plan_describe(&plan, 4, text, sizeof text),
                           "x = -1.5, mass = 2.5, mode = slow");
    CU_ASSERT_STRING_EQUAL(sweep_plan_parameters(&plan, 4, text, sizeof text),
                           "{\"k\":5,\"odd\":\"true\",\"x\":-1.5,\"mass\":2.5,\"mode\":\"slow\"}");
}

/* The digest is that of parameters and streams, status and outputs of the rows in their order, a missing
 * value as NAN. It is the same of another model with the same results. */
static void test_digest_of_rows(void)
{
    char expected[33], setting[33];
    RP_ENDS(sweep_plan_free) sweep_plan plan;
    size_t n = 0;
    made_by(1, "replicas = 5; seed = 77; grid = { x = [0.125, -1.5]; };");
    sqlite3_stmt *q = query("SELECT status, y_deg, never FROM runs ORDER BY run");
    XXH3_state_t *hash = XXH3_createState();
    XXH3_128bits_reset(hash);
    CHECK_OK(sweep_plan_read(file, toys, &plan));
    while (sqlite3_step(q) == SQLITE_ROW) {
        const char *status = (const char *)sqlite3_column_text(q, 0);
        CU_ASSERT(sqlite3_column_type(q, 2) == SQLITE_NULL);
        const double values[] = {sqlite3_column_double(q, 1), NAN};
        sweep_plan_setting(&plan, n++, setting);
        XXH3_128bits_update(hash, setting, 33);
        XXH3_128bits_update(hash, status, strlen(status) + 1);
        XXH3_128bits_update(hash, values, sizeof values);
    }
    finish(q);
    rp_hash_digits(XXH3_128bits_digest(hash), expected);
    XXH3_freeState(hash);
    CU_ASSERT_STRING_EQUAL(digest(10), expected);
    CHECK_OK(sweep_prepare(file, dir, 0, changed, NULL, &c));
    CU_ASSERT(c.stored == 0);
    CHECK_OK(sweep_run(dir, changed, &(sweep_options){.workers = 1}, &c));
    CHECK_OK(sweep_digest(dir, changed, setting, &n));
    CU_ASSERT_STRING_EQUAL(setting, expected);
}

/* Every column of the rows, and their sums, from what the plan and the protocol say. */
static void check_columns(sqlite3_stmt *q, const sweep_plan *plan, size_t run)
{
    char parameters[512];
    const sweep_stream stream = sweep_plan_stream(plan, run);
    sqlite3_int64 whole[3];
    for (int i = 0; i < 3; i++) whole[i] = sqlite3_column_int64(q, 5 + i);
    CU_ASSERT(whole[0] == (sqlite3_int64)stream.seed && whole[2] == (sqlite3_int64)stream.pile);
    CU_ASSERT(whole[1] == RP_MODEL_VERSION);
    XXH64_hash_t sum = XXH3_64bits(whole, sizeof whole);
    for (int i = 0; i < 5; i++) {
        const char *text = (const char *)sqlite3_column_text(q, i);
        sum = XXH3_64bits_withSeed(text, strlen(text), sum + (XXH64_hash_t)i);
    }
    const double value = sqlite3_column_double(q, 9), seconds = sqlite3_column_double(q, 8);
    sum = XXH3_64bits_withSeed(&seconds, sizeof seconds, XXH3_64bits_withSeed("seconds", 7, sum));
    sum += XXH3_64bits_withSeed(&value, sizeof value, XXH3_64bits("y_deg", 5)); /* `never` adds nothing */
    CU_ASSERT(sqlite3_column_int64(q, 10) == (sqlite3_int64)sum && seconds == 0.125);
    CU_ASSERT_STRING_EQUAL((const char *)sqlite3_column_text(q, 1), run % 2 ? "ok" : "ok_fixed_time");
    CU_ASSERT_STRING_EQUAL((const char *)sqlite3_column_text(q, 2), "");
    CU_ASSERT(strncmp((const char *)sqlite3_column_text(q, 3), "repose ", 7) == 0);
    sweep_plan_parameters(plan, run / plan->replicas, parameters, sizeof parameters);
    CU_ASSERT_STRING_EQUAL((const char *)sqlite3_column_text(q, 4), parameters);
}

static void test_stored_columns(void)
{
    RP_ENDS(sweep_plan_free) sweep_plan plan;
    fault_monotonic_tick = 0.125; /* a run has one look at the clock at its start, and one at its end */
    made_by(1, "replicas = 2; seed = 77; piles = \"shared\"; grid = { x = [0.125, -1.5]; };");
    fault_monotonic_tick = 0.0;
    CHECK_OK(sweep_plan_read(file, toys, &plan));
    sqlite3_stmt *q = query("SELECT key, status, message, program, parameters, seed, model, pile, seconds, "
                            "y_deg, sum FROM runs ORDER BY run");
    size_t n = 0;
    while (sqlite3_step(q) == SQLITE_ROW) check_columns(q, &plan, n++);
    finish(q);
    CU_ASSERT_EQUAL(n, 4);
}

/* A store is being written if its last sign of life is less than a minute old, by any clock. */
static void test_running(void)
{
    static const struct {
        long since;
        size_t running;
    } cases[] = {{0, 1}, {57, 1}, {60, 0}, {-57, 1}, {-63, 0}, {1000000, 0}};
    made_by(1, "replicas = 2; fixed = { x = 2.385; };");
    CHECK_OK(sweep_status(dir, toys, &c));
    CU_ASSERT_EQUAL(c.running, 0);
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        const char *beat = check_text("%ld", (long)time(NULL) - cases[k].since);
        sql(check_text("REPLACE INTO sweep VALUES ('beat', '%s', %lld)", beat,
                       (long long)XXH3_64bits_withSeed(beat, strlen(beat), XXH3_64bits("beat", 4))));
        CHECK_OK(sweep_status(dir, toys, &c));
        CU_ASSERT_EQUAL(c.running, cases[k].running);
    }
}

/* ---- recipes ---- */

/* A file has runs, or models alone; commands that older ones had as tables are refused. */
static void test_recipes(void)
{
    static const struct {
        const char *text, *message;
        size_t study;
    } cases[] = {{"protocol = \"toy\"; study = 60; derive = ();", NULL, 60},
                 {"protocol = \"toy\"; study = -1;", NULL, 0},
                 {"model = ();", NULL, 0},
                 {"tables = [\"s = tent\"];", "s.cfg:1: tables: commands of 0.1.0 are gone; instead: ", 0},
                 {"model = (); grid = {};", "s.cfg:1: grid: unknown key", 0},
                 {"study = 3;", "neither a protocol nor an experiment nor a model", 0}};
    fresh("");
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        RP_ENDS(sweep_recipe_free) sweep_recipe r;
        file_print(file, "%s", cases[k].text);
        CHECK_FAILS_IF(cases[k].message, sweep_recipe_read(file, &r), RP_BAD_INPUT, cases[k].message);
        CU_ASSERT_STRING_EQUAL(r.name, "s");
        CU_ASSERT(cases[k].message || r.study == cases[k].study);
        CU_ASSERT(cases[k].message || r.has_runs == (strncmp(cases[k].text, "protocol", 8) == 0));
    }
}

/* A file that may not grow, as on a full disk: the run ends with a message, and the stored rows stay. */
static void test_full_disk(void)
{
    planned("replicas = 2000; fixed = { x = 2.385; };");
    struct stat info;
    CU_ASSERT(stat(store, &info) == 0);
    int pipes[2];
    CU_ASSERT(pipe(pipes) == 0);
    pid_t child = fork();
    if (child == 0) {
        struct rlimit limit = {(rlim_t)info.st_size + 8192, (rlim_t)info.st_size + 8192};
        signal(SIGXFSZ, SIG_IGN);
        setrlimit(RLIMIT_FSIZE, &limit);
        rp_status status = run(1);
        if (write(pipes[1], rp_message(), strlen(rp_message()) + 1) < 0) _exit(1);
        _exit((int)status);
    }
    char message[1024] = "";
    int end;
    waitpid(child, &end, 0);
    CU_ASSERT(read(pipes[0], message, sizeof message - 1) > 0);
    CU_ASSERT(WIFEXITED(end) && WEXITSTATUS(end) == RP_IO);
    CU_ASSERT_PTR_NOT_NULL(strstr(message, "store.sqlite: cannot store "));
    close(pipes[0]);
    close(pipes[1]);
    CU_ASSERT(stored() > 0 && c.stored < 2000);
    sql("UPDATE runs SET message = 'writable' WHERE run = 0"); /* the store is intact */
    CU_ASSERT(sql_number("SELECT count(*) FROM pragma_integrity_check WHERE integrity_check = 'ok'") == 1);
}

/* Every parameter of the list of dem/law/parameters.h is known to sweeps of texts and, by its key, scenes. */
static void test_physics(void)
{
    static const struct {
        const char *name, *key, *fallback, *range;
    } list[] = {
#define ROW(...)                                                        ROW_OF(__VA_ARGS__)
#define ROW_OF(kind, type, name, key, unit, fallback, range, also, ...) {#name, key, fallback, range also},
        DEM_PHYSICS(ROW)};
    for (size_t i = 0; i < sizeof list / sizeof *list; i++) {
        bool in_scene = false;
        const dem_named_key *named = dem_named_keys;
        for (const dem_scene_group *g = dem_scene_schemas; g->name && !in_scene; g++)
            in_scene = rp_params_find(g->schema, list[i].key) != NULL;
        CU_ASSERT(in_scene);
        while (named->key && strcmp(named->param.name, list[i].name) != 0) named++;
        CU_ASSERT_PTR_NOT_NULL_FATAL(named->key);
        CU_ASSERT(strcmp(named->param.fallback, list[i].fallback) == 0 &&
                  strcmp(named->param.range, list[i].range) == 0);
    }
    CU_ASSERT_STRING_EQUAL(rp_params_find(protocol_of(&sweep_protocol_repose)->schema, "mu")->fallback,
                           "0.2");
    CU_ASSERT_STRING_EQUAL(rp_params_find(protocol_of(&sweep_protocol_drop)->schema, "mu")->fallback, "0.5");
}

/* Words and numbers that the short runs of the physics try, and whether one differs from its law's run. */
typedef struct {
    size_t n;
    char law[33];
    struct {
        char key[32], word[32];
        bool differs;
    } tried[96];
} trials;

static rp_status note_trial(const sweep_physics_run *r, void *context)
{
    trials *t = context;
    if (!r->key) {
        memcpy(t->law, r->digits, sizeof t->law);
        return RP_OK;
    }
    size_t i = 0;
    while (i < t->n && (strcmp(t->tried[i].key, r->key) != 0 || strcmp(t->tried[i].word, r->word) != 0)) i++;
    CU_ASSERT_FATAL(i < sizeof t->tried / sizeof *t->tried);
    if (i == t->n) t->n++;
    snprintf(t->tried[i].key, sizeof t->tried[i].key, "%s", r->key);
    snprintf(t->tried[i].word, sizeof t->tried[i].word, "%s", r->word);
    t->tried[i].differs |= strcmp(r->digits, t->law) != 0;
    return RP_OK;
}

static size_t count_trials(const trials *t, const char *key)
{
    size_t n = 0;
    for (size_t i = 0; i < t->n; i++) n += strcmp(t->tried[i].key, key) == 0 && t->tried[i].differs;
    return n;
}

/* Changed physics of any law, damping, rolling, well or method gives new keys: the short runs of a
 * fingerprint use each word of each list, from the schema, and each makes a run another one. */
static void test_fingerprint_words(void)
{
    trials t = {0};
    char first[33] = "", second[33] = "", word[64];
    CHECK_OK(sweep_physics_runs(note_trial, &t));
    for (size_t i = 0; i < t.n; i++)
        CHECK_OR_SAY(t.tried[i].differs, "%s = %s changes no run", t.tried[i].key, t.tried[i].word);
    for (const dem_named_key *k = dem_named_keys; k->key; k++) {
        const rp_param *p = &k->param;
        const bool choice = p->type == RP_CHOICE || p->type == RP_BOOL;
        size_t words = p->type == RP_BOOL ? 2 : 0;
        while (p->type == RP_CHOICE && *rp_word_at(p->range, (int)words, word, sizeof word)) words++;
        if (choice) CU_ASSERT(count_trials(&t, p->name) + 1 >= words);
    }
    CU_ASSERT(count_trials(&t, "set") + 1 == 3 && count_trials(&t, "hard") == 1);
    CU_ASSERT(count_trials(&t, "integrator") + 1 == DEM_INTEGRATORS && count_trials(&t, "solver") == 1);
    CU_ASSERT(count_trials(&t, "normal") + 1 == DEM_NORMAL_N && count_trials(&t, "restitution") == 1);
    CU_ASSERT(count_trials(&t, "k_roll") == 1 && count_trials(&t, "gamma_roll") == 1);
    CHECK_OK(sweep_physics_add(first));
    CHECK_OK(sweep_physics_add(second));
    CU_ASSERT_STRING_EQUAL(first, second);
    second[0] = '0';
    CHECK_OK(sweep_physics_add(second));
    CU_ASSERT_STRING_NOT_EQUAL(first, second);
}

/* A result begins without a value. */
static void test_cleared(void)
{
    sweep_result r;
    memset(&r, 0, sizeof r);
    sweep_result_clear(&r);
    CU_ASSERT_STRING_EQUAL(r.status, "");
    for (int k = 0; k < SWEEP_MAX_OUTPUTS; k++) CU_ASSERT(isnan(r.values[k]));
}

/* Names become columns of one table, in which SQLite ignores case. */
static void test_columns(void)
{
    static const char *const taken[] = {"run",   "status", "message", "seconds", "seed",
                                        "model", "key",    "replica", "pile",    "program"};
    for (const sweep_protocol *const *p = sweep_protocols; *p; p++) {
        const char *names[256];
        size_t n = 0;
        for (size_t i = 0; i < sizeof taken / sizeof *taken; i++) names[n++] = taken[i];
        for (size_t i = 0; (*p)->schema[i].name && n < 200; i++) names[n++] = (*p)->schema[i].name;
        for (const rp_param *q = (*p)->schema; q->name; q++) CU_ASSERT_PTR_NOT_NULL(q->fallback);
        size_t outputs = 0;
        for (; (*p)->outputs[outputs].name && n < 256; outputs++) names[n++] = (*p)->outputs[outputs].name;
        CU_ASSERT((outputs > 0 || (*p)->text) && outputs <= SWEEP_MAX_OUTPUTS);
        for (size_t i = 0; i < n; i++)
            for (size_t j = 0; j < i; j++) CU_ASSERT(strcasecmp(names[i], names[j]) != 0);
    }
}

CHECK_SUITE_WITHIN(sweep, "sweep", NULL, clean, test_order, test_bundles, test_shared_piles,
                   test_digest_of_plan, test_growing, test_reduce, test_statuses, test_stored_once,
                   test_digest, test_stop, test_crash, test_plan_again, test_further_output,
                   test_fingerprint_words, test_bad_files, test_bad_folders, test_limits, test_failed_drives,
                   test_within_limits, test_half_made, test_damaged_rows, test_makers,
                   test_crashed_of_another_plan, test_read_only, test_literal_names, test_left_snapshots,
                   test_stop_of_all, test_lock, test_full_disk, test_shards, test_digest_of_words, test_merge,
                   test_merge_of_crashed, test_flips, test_salvage, test_salvage_gaps, test_known_keys,
                   test_digest_of_rows, test_stored_columns, test_running, test_recipes, test_physics,
                   test_cleared, test_columns)
