/* The sweep driver with toy protocols: plans, resume, crashes, determinism, tables, and every bad input. */
#include <fcntl.h>
#include <limits.h>
#include <signal.h>
#include <sqlite3.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>
#include <xxhash.h>

#include "core/file.h"
#include "core/version.h"
#include "dem/scene/text.h"
#include "sweeps/engine/private.h"
#include "table/columns.h"
#include "tests/faults.h"
#include "tests/protocol.h"
#include "tests/folder.h"
#include "tests/numbers.h"

/* The toy protocol: y = x + k + noise from the stream of the run. */
enum { PLAIN, WAIT, CRASH, HALF_NO_PILE, BREAK, TAKE };
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
     "plain | wait | crash | half_no_pile | break | take", "conduct"},
    {"picks", "", RP_TEXT, offsetof(toy, picks), "", "", "not used"},
    {0}};

static const sweep_output toy_outputs[] = {
    {"y_deg", "deg", "x + k + noise"}, {"never", "s", "has no value"}, {0}};

static volatile int *made; /* the number of runs made, shared with the workers */

static volatile int *shared_number(void)
{
    void *page = mmap(NULL, sizeof(int), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    CU_ASSERT_FATAL(page != MAP_FAILED);
    return page;
}

static bool calm; /* no run crashes */

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
    const toy *p = params;
    scoped_rng *r = numbers_of(seed, run);
    result->values[0] = p->x + (double)p->k + gsl_rng_uniform(r);
    snprintf(result->status, sizeof result->status, "%s", run % 2 ? "ok" : "ok_fixed_time");
    if (made) __atomic_add_fetch(made, 1, __ATOMIC_RELAXED);
    if (p->mode == CRASH && run % 3 == 1 && !calm) abort();
    if (p->mode == HALF_NO_PILE && run % 2) snprintf(result->status, sizeof result->status, "no_pile");
    while (p->mode == WAIT && !*tables->stop) usleep(1000);
    if (p->mode == TAKE) return take_memory((size_t)p->k * 1000000, result);
    return p->mode == BREAK && run == 3 ? rp_fail(RP_BROKEN, "planted failure") : RP_OK;
}

#define TOY(NAME)                                                                                            \
    {                                                                                                        \
        .name = NAME, .about = "toy", .schema = toy_schema, .params_size = sizeof(toy),                      \
        .outputs = toy_outputs, .check = toy_check, .run = toy_run                                           \
    }
static const sweep_protocol toy_protocol = TOY("toy"), other_protocol = TOY("other");
static const sweep_protocol *const toys[] = {&toy_protocol, &other_protocol, NULL};

/* One folder for each test: `base` holds s.cfg and the sweep `dir`. */
static char base[FOLDER_PATH], file[96], dir[96], store[128], other[96]; /* `other`: of a second sweep */
static char *const others[] = {other};

/* What the latest call has counted. */
static sweep_counts c;

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
    return sweep_prepare(file, dir, 0, toys, &c);
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

/* Forget so many stored runs from a number on. */
static void forget_runs(size_t from, size_t n)
{
    RP_ENDS(sweep_plan_free) sweep_plan plan;
    CHECK_OK(sweep_plan_read(folder_path(dir, "sweep.cfg"), toys, &plan));
    for (size_t r = from; r < from + n && r < plan.n_runs; r++) {
        char key[33];
        sweep_plan_key(&plan, r, key);
        sql(check_text("DELETE FROM runs WHERE key = '%s'", key));
    }
}

/* Store a row in a folder as the driver does. */
static rp_status put_row_in(const char *folder, const sweep_row *row)
{
    RP_ENDS(sweep_plan_free) sweep_plan plan;
    sweep_store *opened = NULL;
    rp_status status = sweep_plan_read(folder_path(folder, "sweep.cfg"), toys, &plan);
    if (!status) status = sweep_store_open(folder_path(folder, "store.sqlite"), true, &opened);
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
                   "\"x\":2.385,\"k\":\"auto\"}' AND results ->> 'never' IS NULL") == 3);
}

#define Y "(results ->> 'y_deg')"
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
    scoped_table t = exported(SWEEP_RUNS);
    CU_ASSERT(number(&t, 3, "x") == 1.5 && number(&t, 3, "mass") == 3.0);
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
    CU_ASSERT(sql_number("SELECT count(DISTINCT " Y " - coalesce(parameters ->> 'k', 3)"
                         " - (parameters ->> 'x')) = count(*) FROM runs") == 1); /* no two share a stream */
    CHECK_FAILS(sweep_prepare(file, dir, 5000001, toys, &c), RP_BAD_INPUT, "allowed: [1, 5000000]");
}

/* Student's t for 3 degrees of freedom at 97.5 %: 3.182446305284263 (tables). */
static void test_reduce(void)
{
    made_by(2, "replicas = 8; piles = \"shared\";grid = { mode = [\"half_no_pile\"]; x = [1.25, 2.75]; };");
    forget_runs(14, 1); /* one result of the second point is missing */
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
        forget_runs(1, 1);
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
    sweep_row row = {.run = 2, .seconds = 1.0, .result = {.status = "ok", .values = {99.0, 98.0}}};
    made_by(1, "replicas = 4; fixed = { x = 2.385; };");
    const char *before = digest(4);
    CHECK_FAILS(put_row(&row), RP_IO, "cannot store run 2");
    strcpy(row.result.status, "limit"); /* a text's own word, and a part of one of the machine's */
    CHECK_FAILS(put_row(&row), RP_IO, "cannot store run 2");
    CU_ASSERT_STRING_EQUAL(digest(4), before);
    CU_ASSERT(sql_number("SELECT count(*) FROM runs WHERE " Y " = 99") == 0);
}

enum { RUNS = 30 };

/* Rows are the same rows afterwards, with their times. */
#define KEEP "CREATE TABLE kept AS SELECT key, seconds, results FROM runs"
#define KEPT "SELECT count(*) FROM runs JOIN kept USING (key, seconds, results)"

/* Workers that outlive the parent would continue, and could hold the lock. */
static size_t stored_before; /* the drive */

static void count_calls(const sweep_progress *p, void *context)
{
    size_t *calls = context;
    CU_ASSERT(p->planned == RUNS && p->stored <= p->planned && p->failed == 0);
    CU_ASSERT(isnan(p->left) ? p->stored == stored_before : p->left >= 0.0);
    CU_ASSERT(p->stored < p->planned || p->left == 0.0);
    const double finished = (double)(p->stored - stored_before), left = (double)(p->planned - p->stored);
    CU_ASSERT(p->elapsed >= 0.0 && isfinite(p->elapsed));
    if (finished > 0.0) CHECK_NEAR(p->left, p->elapsed * left / finished, 1e-12);
    if (++*calls == 3) raise(SIGINT); /* blocked: seen by the pool, not by this process */
}

static void test_stop(void)
{
    planned("replicas = 15; piles = \"shared\"; grid = { x = [0.125, 2.385]; };");
    made = shared_number();
    size_t calls = 0;
    sweep_options o = {.workers = 1, .watch = count_calls, .context = &calls};
    CHECK_FAILS(sweep_run(dir, toys, &o, &c), RP_STOPPED, " of 30 stored; run again to resume");
    CU_ASSERT(stored() > 0 && c.stored < RUNS);
    CU_ASSERT(c.stored == (size_t)*made);        /* the run that a worker was at has ended, and is there */
    CU_ASSERT(waitpid(-1, NULL, WNOHANG) == -1); /* no worker is left */
    o.workers = 2;
    stored_before = c.stored;
    CHECK_OK(sweep_run(dir, toys, &o, &c));
    CU_ASSERT(c.stored == RUNS && waitpid(-1, NULL, WNOHANG) == -1);
    CU_ASSERT(*made == RUNS); /* none of them twice */
    size_t before = calls;
    CHECK_OK(sweep_run(dir, toys, &o, &c)); /* nothing to do */
    CU_ASSERT(calls == before && c.stored == RUNS);
    sql("DELETE FROM sweep"); /* as it is before a plan has been entered */
    CHECK_FAILS(sweep_status(dir, toys, &c), RP_BAD_INPUT, "holds no sweep");
}

static void test_crash(void)
{
    planned("replicas = 10; piles = \"shared\"; fixed = { mode = \"crash\"; };");
    CHECK_FAILS(run(2), RP_NO_RESULT, "3 of 10 runs were aborted (crashed 3); the same command retries them");
    CU_ASSERT(c.stored == 10 && c.failed == 3 && c.words.of[0].times == 3.0);
    CHECK_FAILS(sweep_digest(dir, toys, (char[33]){0}, &(size_t){0}), RP_NO_RESULT,
                ": 3 of 10 runs were aborted");
    CU_ASSERT_STRING_EQUAL(c.words.of[0].word, "crashed");
    CU_ASSERT(sql_number("SELECT count(*) FROM runs WHERE status = 'crashed' AND " Y
                         " IS NULL AND message = 'worker ended by signal 6 (Aborted)'") == 3);
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
        CU_ASSERT(fails || sql_number("SELECT count(*) FROM runs WHERE " Y " = 1") == 4);
    }
}

/* All workers that are busy end their runs when a drive is stopped; until then they do not. */
static void interrupt(const sweep_progress *p, void *context)
{
    size_t *calls = context;
    if (p->planned == 4 && ++*calls == 1) raise(SIGINT);
}

static void test_stop_of_all(void)
{
    size_t calls = 0;
    planned("replicas = 4; fixed = { mode = \"wait\"; };");
    const sweep_options o = {.workers = 2, .snapshot = 1e9, .watch = interrupt, .context = &calls};
    CHECK_FAILS(sweep_run(dir, toys, &o, &c), RP_STOPPED, "stopped: 2 of 4 stored");
    CU_ASSERT_EQUAL(stored(), 2);
}

/* A shard that a process left when it had only just made the file has no rows yet. */
static void test_half_made(void)
{
    const sweep_options second = {.workers = 1, .shard = 2, .shards = 2};
    fresh("replicas = 4;");
    CHECK_OK(rp_make_directory(dir));
    file_write(store, "", 0);
    CHECK_FAILS(sweep_status(dir, toys, &c), RP_BAD_INPUT, "sweep.cfg: cannot read");
    CHECK_OK(prepare());
    CHECK_OK(sweep_run(dir, toys, &second, &c));
    file_write(folder_path(dir, "shards/1-of-2.sqlite"), "", 0);
    CU_ASSERT(stored() == 2);
    CHECK_OK(sweep_merge(dir, toys, 0, NULL, &c));
    CU_ASSERT(c.stored == 2);
    CHECK_OK(sweep_run(dir, toys, &(sweep_options){.workers = 1, .shard = 1, .shards = 2}, &c));
    CU_ASSERT(stored() == 4);
}

/* Rows keep the name of the program that made them, when they are merged too, and a table counts those of its
 * runs. */
static void test_makers(void)
{
    static const char program[] = "repose 0.1.9, commit 0123abc-dirty, gcc 9";
    planned("replicas = 6; fixed = { x = 2.385; };");
    CHECK_OK(sweep_prepare(file, other, 0, toys, &c));
    for (size_t k = 0; k < 3; k++) {
        const sweep_row row = {.run = k, .seconds = 1.0, .result = {.status = "ok", .values = {1.0, NAN}}};
        CHECK_OK(put_row_in(other, &row));
    }
    sql_in(folder_path(other, "store.sqlite"), check_text("UPDATE runs SET program = '%s'", program));
    CHECK_OK(sweep_merge(dir, toys, 1, others, &c));
    CHECK_OK(run(1));
    CHECK_OK(sweep_prepare(file, dir, 4, toys, &c)); /* two of the runs are planned no more */
    scoped char *text = protocol_export(dir, toys, SWEEP_RUNS);
    const char *plain = check_text("# runs made by: repose %s, commit %s, %s (1)\n", RP_VERSION,
                                   rp_build_commit, rp_build_compiler);
    CHECK_PARTS(text, "# runs made by: repose 0.1.9, commit 0123abc-dirty, gcc 9 (3)\n", plain);
}

/* Files and folders that may only be read: a finished sweep, and its shards, are read all the same. */
static void test_read_only(void)
{
    static const char *const names[] = {"sweep.cfg", "store.sqlite", "lock", "shards/2-of-3.sqlite", "shards",
                                        ""};
    made_by(1, "replicas = 6;");
    const sweep_options shard = {.workers = 1, .shard = 2, .shards = 3};
    forget_runs(1, 1), forget_runs(4, 1);
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
        CHECK_OK(sweep_prepare("s.cfg", names[k], 0, toys, &c));
        for (int i = 1; i <= 2; i++)
            CHECK_OK(sweep_run(names[k], toys, &(sweep_options){.workers = 1, .shard = i, .shards = 2}, &c));
        CHECK_OK(sweep_status(names[k], toys, &c));
        CHECK_OK(sweep_merge(names[k], toys, 0, NULL, &c));
        CU_ASSERT(c.stored == 6);
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
        CHECK_OK(sweep_prepare("s.cfg", name, 0, toys, &c));
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
    CHECK_OK(prepare());
    CU_ASSERT(c.stored == 8);
    file_print(file, "protocol = \"other\"; replicas = 2;");
    CHECK_FAILS(prepare(), RP_BAD_INPUT, "holds runs of protocol \"toy\", not \"other\"");
    CHECK_OK(sweep_status(dir, toys, &c)); /* and the refused plan changed nothing */
    CU_ASSERT(c.planned == 8);
    /* the runs are those of the folder's own file, whoever wrote it */
    const char *copy = folder_path(dir, "sweep.cfg");
    file_print(copy, "protocol = \"toy\"; replicas = 2; grid = { x = [0.5, 1.25]; };");
    CU_ASSERT(stored() == 2 && c.planned == 4);
    CHECK_OK(run(1));
    CU_ASSERT(c.stored == 4);
    CHECK_OK(sweep_prepare(copy, dir, 0, toys, &c));
    CU_ASSERT(c.planned == 4 && c.stored == 4);
}

/* Another number of replicas stands in the folder's copy of the file, wherever that has its own. */
static void test_replicas(void)
{
    static const char *const texts[][2] = {
        {"protocol = \"toy\"; replicas = 2; seed = 3;", "protocol = \"toy\"; replicas = 7; seed = 3;"},
        {"/* replicas */\nprotocol = \"toy\"\nreplicas:2 seed=3",
         "/* replicas */\nprotocol = \"toy\"\nreplicas:7 seed=3"},
        {"protocol = \"toy\";", "replicas = 7;\nprotocol = \"toy\";"}};
    for (size_t k = 0; k < sizeof texts / sizeof *texts; k++) {
        size_t n;
        fresh("");
        file_print(file, "%s", texts[k][0]);
        CHECK_OK(sweep_prepare(file, dir, 7, toys, &c));
        scoped char *copy = file_read(folder_path(dir, "sweep.cfg"), &n);
        CU_ASSERT_STRING_EQUAL(copy, texts[k][1]);
        CU_ASSERT(stored() == 0 && c.planned == 7);
    }
}

/* Another model of the physics makes a store's rows those of others: no command takes them for its own. */
static void test_models(void)
{
    static const char foreign[] = "UPDATE sweep SET value = 'toy 3' WHERE name = 'model';"
                                  "UPDATE runs SET key = 'a' || substr(key, 2)";
    char text[32], model[64];
    planned("replicas = 4; fixed = { x = 2.385; };");
    CHECK_OK(sweep_prepare(file, other, 0, toys, &c));
    CHECK_OK(run_in(other, 1));
    sql_in(folder_path(other, "store.sqlite"), foreign);
    snprintf(model, sizeof model, "(toy 3), not with this one (toy %s)", rp_model(text));
    CHECK_FAILS(sweep_merge(dir, toys, 1, others, &c), RP_BAD_INPUT, model);
    CHECK_FAILS(sweep_status(other, toys, &c), RP_BAD_INPUT,
                "planned with another model of the physics (toy 3)");
    CHECK_FAILS(run_in(other, 1), RP_BAD_INPUT, "plan again with `repose sweep plan`");
    CHECK_OK(sweep_prepare(file, other, 0, toys, &c));
    CU_ASSERT(c.stored == 0);
    CHECK_OK(run_in(other, 1));
    sql_in(folder_path(other, "store.sqlite"), "PRAGMA user_version = 4");
    CHECK_FAILS(sweep_status(other, toys, &c), RP_BAD_INPUT,
                "a store of format 4, not 5: plan in another folder");
    CHECK_FAILS(sweep_prepare(file, other, 0, toys, &c), RP_BAD_INPUT, "a store of format 4");
    CHECK_FAILS(sweep_merge(dir, toys, 1, others, &c), RP_BAD_INPUT,
                "other/store.sqlite: a store of format 4");
    CU_ASSERT(sql_number("SELECT count(*) FROM runs") == 0);
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

/* A protocol gets a further output: its runs are made again, and keep what they have. A row that lacks it is
 * no other result. */
static void test_further_output(void)
{
    sweep_protocol further = toy_protocol;
    further.outputs = further_outputs;
    further.run = further_run;
    const sweep_protocol *const later[] = {&further, NULL};
    const sweep_options one = {.workers = 1};
    made_by(1, "replicas = 2; grid = { x = [0.5, 1.5]; };");
    CHECK_OK(sweep_prepare(file, other, 0, toys, &c));
    CHECK_OK(run_in(other, 1));
    CHECK_OK(sweep_prepare(file, dir, 3, later, &c));
    CU_ASSERT(c.planned == 6 && c.stored == 0);
    CHECK_OK(sweep_run(dir, later, &one, &c));
    CU_ASSERT(c.stored == 6);
    CU_ASSERT(sql_number("SELECT count(*) FROM runs WHERE results LIKE '%y_deg%' AND results LIKE "
                         "'%further\":2.38%'") == 6);
    CHECK_OK(sweep_merge(dir, later, 1, others, &c));
    CU_ASSERT(c.stored == 6);
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
    CHECK_FAILS(sweep_prepare(base, dir, 0, toys, &c), RP_BAD_INPUT, "is a directory");
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
    CHECK_FAILS(sweep_prepare(file, folder_path(file, "d"), 0, toys, &c), RP_IO,
                "cannot make the directory"); /* below a regular file */
    CHECK_OK(prepare());
    CHECK_FAILS(run(0), RP_BAD_INPUT, "workers = 0");
    RP_SCOPE(arena);
    CHECK_FAILS(sweep_read_again(file, toys, 40, &arena, &(sweep_again){0}), RP_BAD_INPUT,
                "allowed: [0, 39]");
    unlink(store);
    CHECK_FAILS(run(1), RP_BAD_INPUT, "store.sqlite: no store; `repose sweep plan` makes it");
    mkdir(store, 0777);
    CHECK_FAILS(run(1), RP_IO, "store.sqlite: unable to open database file");
    CHECK_FAILS(prepare(), RP_IO, "store.sqlite: unable to open database file");
    rmdir(store);
    file_print(store, "this is not a database, although it is long enough to be taken for one at first sight "
                      "by a program that looks at the size only, which must be refused all the same.");
    CHECK_FAILS(sweep_status(dir, toys, &c), RP_IO, "store.sqlite: file is not a database");
    CHECK_FAILS(run(1), RP_IO, "file is not a database");
    CHECK_FAILS(prepare(), RP_IO, "file is not a database");
    file_write(store, "", 0);
    CHECK_FAILS(sweep_status(dir, toys, &c), RP_BAD_INPUT, "holds no sweep; `repose sweep plan` makes it");
    CHECK_OK(prepare());
    FILE *full = fopen("/dev/full", "w");
    CU_ASSERT_PTR_NOT_NULL_FATAL(full);
    CHECK_FAILS(sweep_export(dir, toys, SWEEP_RUNS, NULL, NULL, full), RP_IO, "No space left on device");
    fclose(full);
    unlink(folder_path(dir, "lock"));
    mkdir(folder_path(dir, "lock"), 0777);
    CHECK_FAILS(run(1), RP_IO, "lock: cannot write");
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
        for (int k = 1; k < n; k++) CHECK_OK(run_shard(orders[i][k], n));
        if (n == 8) CHECK_OK(sweep_merge(dir, toys, 0, NULL, &c));
        CHECK_OK(run_shard(orders[i][n], n));
        CU_ASSERT_STRING_EQUAL(digest(GRID_RUNS), whole); /* not merged yet */
        made = shared_number();
        CHECK_OK(run(1));
        CU_ASSERT(*made == 0); /* the shards have all of them */
        munmap((void *)made, sizeof *made);
        made = NULL;
        CHECK_OK(sweep_merge(dir, toys, 0, NULL, &c));
        CU_ASSERT(c.stored == GRID_RUNS);
        CHECK_OK(run_shard(1, n)); /* nothing to do */
        CU_ASSERT_STRING_EQUAL(digest(GRID_RUNS), whole);
    }
    planned(GRID_SWEEP);
    CHECK_FAILS(run_shard(4, 3), RP_BAD_INPUT, "shard = 4/3: out of range");
    CHECK_FAILS(sweep_merge(dir, toys, 0, NULL, &c), RP_BAD_INPUT, "no shards, and no other store");
}

/* Folders made apart: the rows that both plans have count once; two results of one run refuse each other, and
 * then nothing is taken, of other sources neither. */
static void test_merge(void)
{
    fresh(GRID_SWEEP);
    char *path = strdup(folder_path(other, "store.sqlite")), *third = strdup(folder_path(base, "third"));
    write_sweep("replicas = 5; seed = 77; grid = { x = [0.125, 7.0]; k = [4, 3]; };");
    CHECK_OK(sweep_prepare(file, other, 0, toys, &c));
    CHECK_OK(run_in(other, 1));
    write_sweep(GRID_SWEEP);
    CHECK_OK(prepare());
    CHECK_OK(run_shard(2, 3));
    CHECK_OK(sweep_merge(dir, toys, 1, others, &c));
    CU_ASSERT(c.stored == 10);
    CHECK_OK(sweep_merge(dir, toys, 1, others, &c));
    CU_ASSERT(c.stored == 10 && stored() == 22); /* 15 of the shard, 10 of the other, 3 of both */
    /* the first run of both with another result, beside a store with more runs */
    CHECK_OK(sweep_prepare(file, third, 0, toys, &c));
    CHECK_OK(run_in(third, 1));
    char result[128], *const both[] = {third, other};
    snprintf(result, sizeof result,
             "UPDATE runs SET results = '{\"y_deg\":2.385,\"never\":null}' WHERE " K " = 3 AND " X
             " = 0.125");
    sql_in(path, result);
    CHECK_FAILS(sweep_merge(dir, toys, 2, both, &c), RP_BAD_INPUT, "a different result than in the stores");
    CU_ASSERT(stored() == 22);
    sql_in(path, "UPDATE runs SET status = 'crashed'");
    CHECK_OK(sweep_merge(dir, toys, 2, both, &c)); /* a crash is no result */
    CU_ASSERT(c.stored == GRID_RUNS && c.failed == 0);
    file_print(path, "not a store");
    char *const files[] = {path};
    CHECK_FAILS(sweep_merge(dir, toys, 1, files, &c), RP_IO, "other/store.sqlite: file is not a database");
    unlink(path);
    CHECK_FAILS(sweep_merge(dir, toys, 1, files, &c), RP_BAD_INPUT, "no store");
    CHECK_FAILS(sweep_merge(dir, toys, 1, others, &c), RP_BAD_INPUT, "other/store.sqlite: no store");
    free(path), free(third);
}

/* A run that crashed in one store and not in the other: the result counts, whichever takes the other. */
static void test_merge_of_crashed(void)
{
    for (int way = 0; way < 2; way++) {
        planned("replicas = 10; piles = \"shared\"; fixed = { mode = \"crash\"; };");
        CHECK_OK(sweep_prepare(file, other, 0, toys, &c));
        for (int k = 0; k < 2; k++) {
            calm = k == way;
            const rp_status status = sweep_run(k ? other : dir, toys, &(sweep_options){.workers = 1}, &c);
            CU_ASSERT(status == (calm ? RP_OK : RP_NO_RESULT) && sweep_count_aborted(&c) == (calm ? 0 : 3));
        }
        calm = false;
        CHECK_OK(sweep_merge(dir, toys, 1, others, &c));
        CU_ASSERT(c.stored == 10 && c.failed == 0 && sweep_count_aborted(&c) == 0);
        digest(10);
    }
}

/* Keys name stored runs for ever: these are of a model whose name is in them. */
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
        "grid = ( { x = [0.5, -1.5]; mass = [1.0, 2.5]; }, { mode = [\"plain\", \"wait\", \"crash\"]; } );");
    CHECK_OK(sweep_plan_read(file, toys, &plan));
    CU_ASSERT(plan.n_points == 6 && plan.n_runs == 12);
    strcpy(plan.model, "toy 4 ");
    for (size_t k = 0; k < sizeof known / sizeof *known; k++) {
        char key[33];
        sweep_plan_key(&plan, known[k].run, key);
        CU_ASSERT_STRING_EQUAL(key, known[k].key);
        const sweep_stream s = sweep_plan_stream(&plan, known[k].run);
        CU_ASSERT(s.seed == known[k].stream.seed && s.run == known[k].stream.run);
        CU_ASSERT_EQUAL(s.pile, known[k].stream.pile);
    }
    CU_ASSERT_STRING_EQUAL(sweep_plan_describe(&plan, 4, text, sizeof text),
                           "x = -1.5, mass = 2.5, mode = wait");
    CU_ASSERT_STRING_EQUAL(sweep_plan_parameters(&plan, 4, text, sizeof text),
                           "{\"k\":5,\"odd\":\"true\",\"x\":-1.5,\"mass\":2.5,\"mode\":\"wait\"}");
}

/* The digest is that of parameters and streams, status and outputs of the rows in their order, a missing
 * value as NAN. What stands there for parameters and streams is the same in another model, and no key is. */
static void test_digest_of_rows(void)
{
    char expected[33], setting[33], key[33], then[33];
    RP_ENDS(sweep_plan_free) sweep_plan plan;
    made_by(1, "replicas = 5; seed = 77; grid = { x = [0.125, -1.5]; };");
    scoped_table t = exported(SWEEP_RUNS);
    XXH3_state_t *hash = XXH3_createState();
    XXH3_128bits_reset(hash);
    CHECK_OK(sweep_plan_read(file, toys, &plan));
    sweep_plan_key(&plan, 0, then);
    strcat(plan.model, " another");
    for (size_t r = 0; r < t.n_rows; r++) {
        const char *status = cell(&t, r, "status");
        const double values[] = {number(&t, r, "y_deg"), NAN};
        sweep_plan_setting(&plan, r, setting);
        XXH3_128bits_update(hash, setting, 33);
        XXH3_128bits_update(hash, status, strlen(status) + 1);
        XXH3_128bits_update(hash, values, sizeof values);
    }
    rp_hash_digits(XXH3_128bits_digest(hash), expected);
    XXH3_freeState(hash);
    CU_ASSERT_STRING_EQUAL(digest(10), expected);
    sweep_plan_key(&plan, 0, key);
    CU_ASSERT_STRING_NOT_EQUAL(key, then);
}

/* Every column of the rows, from what the plan and the protocol say. */
static void test_stored_columns(void)
{
    RP_ENDS(sweep_plan_free) sweep_plan plan;
    fault_monotonic_tick = 0.125; /* a run has one look at the clock at its start, and one at its end */
    made_by(1, "replicas = 2; seed = 77; piles = \"shared\"; grid = { x = [0.125, -1.5]; };");
    fault_monotonic_tick = 0.0;
    CHECK_OK(sweep_plan_read(file, toys, &plan));
    for (size_t run = 0; run < plan.n_runs; run++) {
        char key[33], parameters[512], results[128];
        sweep_plan_key(&plan, run, key);
        sqlite3_stmt *q = query(check_text("SELECT status, message, program, parameters, results, seconds"
                                           " FROM runs WHERE key = '%s'",
                                           key));
        CU_ASSERT_FATAL(sqlite3_step(q) == SQLITE_ROW);
        const double y = expected(run < 2 ? 0.125 : -1.5, 3, 77, run % 2);
        snprintf(results, sizeof results, "{\"y_deg\":%.17g,\"never\":null}", y);
        sweep_plan_parameters(&plan, run / plan.replicas, parameters, sizeof parameters);
        const char *const columns[] = {run % 2 ? "ok" : "ok_fixed_time", "", NULL, parameters, results};
        for (int k = 0; k < 5; k++)
            if (columns[k]) CU_ASSERT_STRING_EQUAL((const char *)sqlite3_column_text(q, k), columns[k]);
        CU_ASSERT(strncmp((const char *)sqlite3_column_text(q, 2), "repose ", 7) == 0);
        CU_ASSERT(sqlite3_column_double(q, 5) == 0.125);
        finish(q);
    }
}

/* ---- recipes ---- */

/* A file has runs, or models alone. */
static void test_recipes(void)
{
    static const struct {
        const char *text, *message;
        size_t study;
    } cases[] = {{"protocol = \"toy\"; study = 60; derive = ();", NULL, 60},
                 {"protocol = \"toy\"; study = -1;", NULL, 0},
                 {"model = ();", NULL, 0},
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

/* A result begins without a value. */
static void test_cleared(void)
{
    sweep_result r;
    memset(&r, 0, sizeof r);
    sweep_result_clear(&r);
    CU_ASSERT_STRING_EQUAL(r.status, "");
    for (int k = 0; k < SWEEP_MAX_OUTPUTS; k++) CU_ASSERT(isnan(r.values[k]));
}

/* Names become columns of one table. */
static void test_columns(void)
{
    for (const sweep_protocol *const *p = sweep_protocols; *p; p++) {
        const char *names[256];
        size_t n = 0, outputs = 0;
        for (const rp_param *q = (*p)->schema; q->name && n < 200; q++) names[n++] = q->name;
        for (const rp_param *q = (*p)->schema; q->name; q++) CU_ASSERT_PTR_NOT_NULL(q->fallback);
        for (; (*p)->outputs[outputs].name && n < 256; outputs++) names[n++] = (*p)->outputs[outputs].name;
        CU_ASSERT((outputs > 0 || (*p)->text) && outputs <= SWEEP_MAX_OUTPUTS);
        for (size_t i = 0; i < n; i++) {
            CU_ASSERT(rp_word_index(RP_SWEEP_COLUMNS, names[i]) < 0);
            for (size_t j = 0; j < i; j++) CU_ASSERT(strcmp(names[i], names[j]) != 0);
        }
    }
}

static void count_points(void *context, size_t checked, size_t points)
{
    size_t *const seen = context;
    CU_ASSERT(checked == ++*seen && checked <= points);
}

/* Planning tells of each grid point. */
static void test_planning_seen(void)
{
    size_t seen = 0;
    sweep_counts counts;
    fresh("replicas = 2; grid = { x = [1.0, 2.0, 3.0]; };");
    CHECK_OK(sweep_prepare_seen(file, dir, 0, toys, count_points, &seen, &counts));
    CU_ASSERT(seen == counts.points && seen > 1);
}

CHECK_SUITE_WITHIN(sweep, "sweep", NULL, clean, test_order, test_bundles, test_growing, test_reduce,
                   test_statuses, test_stored_once, test_stop, test_crash, test_plan_again, test_replicas,
                   test_models, test_further_output, test_bad_files, test_bad_folders, test_limits,
                   test_half_made, test_makers, test_read_only, test_literal_names, test_left_snapshots,
                   test_stop_of_all, test_shards, test_merge, test_merge_of_crashed, test_known_keys,
                   test_digest_of_rows, test_stored_columns, test_recipes, test_physics, test_cleared,
                   test_columns, test_planning_seen)
