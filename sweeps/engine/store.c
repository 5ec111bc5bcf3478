/* The store of a sweep: SQLite files, each with one writer. Tables:
 *   sweep  name, value, sum: protocol, sweep file, replicas, model, hash of the plan; sum is a checksum
 *   runs   one row a finished run: key, run (its number in the plan; NULL: of another plan), status,
 *          message, seconds, seed, model, program, pile, parameters (JSON: those that the file
 *          gives), a column for each output (NULL: no value; 'none': stored before the program had this
 *          output), sum (checksum of all but `run`)
 *   "runs of a, b"  those of an experiment whose text had the measures a and b, and now has others
 * Planning again renumbers the rows, and removes none. Rows are committed in groups of a quarter of a second,
 * each synced to the disk. An open store is the parent's alone: no worker touches it. */
#include "table/columns.h"
#include "sweeps/engine/private.h"

#include <ctype.h>
#include <libgen.h>
#include <math.h>
#include <signal.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/vfs.h>
#include <time.h>
#include <unistd.h>

#include "core/clock.h"
#include "core/version.h"

static const double GROUP_SECONDS = 0.25, BEAT_SECONDS = 10.0;

rp_status sweep_sql_fail(const sweep_store *s, const char *what)
{
    return rp_fail(RP_IO, "%s: cannot %s: %s", s->path, what, sqlite3_errmsg(s->db));
}

rp_status sweep_sql_text(sweep_store *s, const char *what, sqlite3_str *text)
{
    char *sql = sqlite3_str_finish(text);
    int rc = sql ? sqlite3_exec(s->db, sql, NULL, NULL, NULL) : SQLITE_NOMEM;
    sqlite3_free(sql);
    return rc == SQLITE_OK ? RP_OK : sweep_sql_fail(s, what);
}

rp_status sweep_sql(sweep_store *s, const char *what, const char *format, ...)
{
    sqlite3_str *text = sqlite3_str_new(s->db);
    va_list args;
    va_start(args, format);
    sqlite3_str_vappendf(text, format, args);
    va_end(args);
    return sweep_sql_text(s, what, text);
}

sqlite3_stmt *sweep_sql_query_text(sweep_store *s, sqlite3_str *text)
{
    char *sql = sqlite3_str_finish(text);
    sqlite3_stmt *statement = NULL;
    sqlite3_prepare_v2(s->db, sql, -1, &statement, NULL);
    sqlite3_free(sql);
    return statement;
}

sqlite3_stmt *sweep_sql_query(sweep_store *s, const char *format, ...)
{
    sqlite3_str *text = sqlite3_str_new(s->db);
    va_list args;
    va_start(args, format);
    sqlite3_str_vappendf(text, format, args);
    va_end(args);
    return sweep_sql_query_text(s, text);
}

rp_status sweep_sql_finish(sweep_store *s, const char *what, sqlite3_stmt *q)
{
    const bool prepared = q != NULL;
    return sqlite3_finalize(q) == SQLITE_OK && prepared ? RP_OK : sweep_sql_fail(s, what);
}

rp_status sweep_sql_number(sweep_store *s, const char *sql, long long *number)
{
    sqlite3_stmt *q = sweep_sql_query(s, "%s", sql);
    *number = sqlite3_step(q) == SQLITE_ROW ? sqlite3_column_int64(q, 0) : 0;
    return sweep_sql_finish(s, "read the store", q);
}

/* ---- opening ---- */

/* Whoever reads or writes is waited for, unless this process is told to stop. */
static int wait_for_others(void *context, int tries)
{
    (void)context, (void)tries;
    sigset_t pending;
    sigpending(&pending);
    if (sigismember(&pending, SIGINT) || sigismember(&pending, SIGTERM) || sigismember(&pending, SIGHUP))
        return 0;
    usleep(20000);
    return 1;
}

/* File systems of several machines, where SQLite's shared memory for WAL does not work: statfs(2). */
static bool is_shared(const char *dir)
{
    static const unsigned magic[] = {0x6969 /* NFS */,      0xff534d42 /* CIFS */,
                                     0xfe534d42 /* SMB2 */, 0x0bd00bd0 /* Lustre */,
                                     0x47504653 /* GPFS */, 0x65735546 /* FUSE */,
                                     0x00c36400 /* Ceph */, 0x5346414f /* AFS */,
                                     0x01021997 /* 9P */,   0x19830326 /* BeeGFS */};
    struct statfs info;
    if (statfs(dir, &info) != 0) return false;
    for (size_t i = 0; i < sizeof magic / sizeof *magic; i++)
        if ((unsigned)info.f_type == magic[i]) return true;
    return false;
}

/* Is it a store, and of this format? An empty file becomes one. */
static rp_status check_format(sweep_store *s)
{
    long long tables, format;
    RP_TRY(sweep_sql_number(s, "SELECT count(*) FROM sqlite_schema", &tables));
    RP_TRY(sweep_sql_number(s, "PRAGMA user_version", &format));
    if (tables > 0 && format != SWEEP_FORMAT)
        return rp_fail(RP_BAD_INPUT,
                       "%s: a store of format %lld; this version reads and writes format %d: plan in "
                       "another folder",
                       s->path, format, SWEEP_FORMAT);
    return RP_OK;
}

char *sweep_store_uri(const char *path, bool reads)
{
    char beside[4096 + 16];
    sqlite3_str *uri = sqlite3_str_new(NULL);
    sqlite3_str_appendall(uri, *path == '/' ? "file://" : "file:");
    for (const char *c = path; *c; c++)
        sqlite3_str_appendf(uri, isalnum((unsigned char)*c) || strchr("/._-", *c) ? "%c" : "%%%02X",
                            (unsigned char)*c);
    for (int i = 0; i < 2; i++) {
        snprintf(beside, sizeof beside, "%s%s", path, i ? "-journal" : "-wal");
        reads &= access(beside, F_OK) != 0;
    }
    /* SQLite has no place for such files */
    if (reads && access(dirname(beside), W_OK) != 0) sqlite3_str_appendall(uri, "?immutable=1");
    return sqlite3_str_finish(uri);
}

rp_status sweep_store_open(const char *path, sweep_access access, sweep_store **store)
{
    sweep_store *s = *store = calloc(1, sizeof **store);
    if (!s) return rp_fail(RP_NO_MEMORY, "%s: out of memory", path);
    snprintf(s->path, sizeof s->path, "%s", path);
    snprintf(s->program, sizeof s->program, "repose %s, commit %s, %s", RP_VERSION, rp_build_commit,
             rp_build_compiler);
    s->writes = access != SWEEP_READ;
    const int flags = SQLITE_OPEN_READWRITE | SQLITE_OPEN_URI | SQLITE_OPEN_NOMUTEX |
                      (access == SWEEP_CREATE ? SQLITE_OPEN_CREATE : 0);
    char *uri = sweep_store_uri(path, !s->writes);
    const int opened = uri ? sqlite3_open_v2(uri, &s->db, flags, NULL) : SQLITE_NOMEM;
    sqlite3_free(uri);
    if (opened != SQLITE_OK) return sweep_sql_fail(s, "open the store");
    sqlite3_busy_handler(s->db, wait_for_others, NULL);
    RP_TRY(check_format(s));
    /* EXTRA: the removal of a rollback journal, which is the commit, reaches the disk too. Keys come in no
     * order: 64 MB hold the index of a million rows, and the log is copied into the file at the same size. */
    if (s->writes)
        RP_TRY(sweep_sql(s, "write the store",
                         "PRAGMA journal_mode = %s; PRAGMA synchronous = EXTRA; PRAGMA cache_size = -64000; "
                         "PRAGMA wal_autocheckpoint = 16000",
                         is_shared(path) ? "DELETE" : "WAL"));
    return RP_OK;
}

bool sweep_store_is_made(const char *path)
{
    enum { HEADER = 100 }; /* bytes, of every file of SQLite */
    sweep_store *s;
    char hash[33];
    struct stat info;
    if (stat(path, &info) != 0 || !S_ISREG(info.st_mode) || info.st_size < HEADER) return false;
    rp_status status = sweep_store_open(path, SWEEP_READ, &s);
    if (!status) status = sweep_store_note(s, "main", "plan", hash, sizeof hash);
    sweep_store_close(s);
    return status || *hash; /* whoever reads it says what is wrong */
}

void sweep_store_close(sweep_store *s)
{
    if (!s) return;
    if (s->db && s->writes) {
        sqlite3_exec(s->db, s->pending ? "COMMIT" : "ROLLBACK", NULL, NULL, NULL); /* what a failure left */
        sqlite3_exec(s->db, "DELETE FROM sweep WHERE name = 'beat'", NULL, NULL, NULL);
    }
    sqlite3_finalize(s->insert);
    sqlite3_close(s->db);
    free(s);
}

/* ---- notes ---- */

static sqlite3_int64 note_sum(const char *name, const char *value)
{
    return (sqlite3_int64)XXH3_64bits_withSeed(value, strlen(value), XXH3_64bits(name, strlen(name)));
}

static rp_status set_note(sweep_store *s, const char *name, const char *value)
{
    return sweep_sql(s, "write the store", "REPLACE INTO sweep VALUES (%Q, %Q, %lld)", name, value,
                     (long long)note_sum(name, value));
}

rp_status sweep_store_note(sweep_store *s, const char *schema, const char *name, char *buffer, size_t size)
{
    buffer[0] = '\0';
    /* a process that was killed may leave a store without a table */
    if (sqlite3_table_column_metadata(s->db, schema, "sweep", "sum", NULL, NULL, NULL, NULL, NULL) !=
            SQLITE_OK &&
        sqlite3_errcode(s->db) == SQLITE_ERROR)
        return RP_OK;
    sqlite3_stmt *q = sweep_sql_query(s, "SELECT value, sum FROM %s.sweep WHERE name = %Q", schema, name);
    bool damaged = false;
    if (sqlite3_step(q) == SQLITE_ROW) {
        const char *value = (const char *)sqlite3_column_text(q, 0);
        damaged = !value || note_sum(name, value) != sqlite3_column_int64(q, 1);
        snprintf(buffer, size, "%s", value ? value : "");
    }
    rp_status status = sweep_sql_finish(s, "read the store", q);
    return damaged ? rp_fail(RP_IO, "%s: the note \"%s\" is damaged (checksum)", s->path, name) : status;
}

/* ---- the plan ---- */

enum { N_COLUMNS = 11 }; /* before the outputs */

bool sweep_store_has(const sweep_store *s, const char *schema, const char *name)
{
    return sqlite3_table_column_metadata(s->db, schema, "runs", name, NULL, NULL, NULL, NULL, NULL) ==
           SQLITE_OK;
}

rp_status sweep_store_make_runs(sweep_store *s, const char *schema, const sweep_protocol *protocol)
{
    RP_TRY(sweep_sql(
        s, "write the store",
        "CREATE TABLE IF NOT EXISTS %s.runs (key TEXT PRIMARY KEY, run INTEGER, status TEXT NOT NULL,"
        " message TEXT, seconds REAL, seed INTEGER, model INTEGER, program TEXT, pile INTEGER,"
        " parameters TEXT, sum INTEGER);"
        "CREATE UNIQUE INDEX IF NOT EXISTS %s.by_run ON runs (run) WHERE run IS NOT NULL;"
        "CREATE INDEX IF NOT EXISTS %s.by_status ON runs (status) WHERE run IS NOT NULL",
        schema, schema, schema));
    for (const sweep_output *o = protocol->outputs; o->name; o++)
        if (!sweep_store_has(s, schema, o->name))
            RP_TRY(sweep_sql(s, "write the store",
                             "ALTER TABLE %s.runs ADD COLUMN \"%w\" REAL DEFAULT 'none'", schema, o->name));
    return RP_OK;
}

rp_status sweep_store_check_outputs(sweep_store *s, const char *schema, const char *path,
                                    const sweep_protocol *protocol)
{
    rp_status status = RP_OK;
    sqlite3_stmt *q = sweep_sql_query(s, "SELECT name FROM pragma_table_info('runs', %Q) WHERE cid >= %d",
                                      schema, N_COLUMNS);
    while (!status && sqlite3_step(q) == SQLITE_ROW) {
        const char *name = (const char *)sqlite3_column_text(q, 0);
        const sweep_output *o = protocol->outputs;
        while (o->name && strcmp(o->name, name) != 0) o++;
        if (!o->name)
            status = rp_fail(RP_BAD_INPUT,
                             "%s: its runs have the output %s, which the text, or this version of the "
                             "program, lacks; plan in another folder",
                             path, name);
    }
    rp_status read = sweep_sql_finish(s, "read the store", q);
    return status ? status : read;
}

/* With other measures an experiment has other runs. Those of before stay in a table of their own, whose name
 * is told, and are the runs again once the text has their measures. */
static rp_status set_aside(sweep_store *s, const sweep_protocol *protocol, rp_arena *arena,
                           const char **table)
{
    bool lacks = false;
    sqlite3_str *names = sqlite3_str_new(s->db);
    for (const sweep_output *o = protocol->outputs; o->name; o++) {
        sqlite3_str_appendf(names, "%s%s", sqlite3_str_length(names) ? ", " : "", o->name);
        lacks |= !sweep_store_has(s, "main", o->name);
    }
    char *now = sqlite3_str_finish(names);
    sqlite3_stmt *q = sweep_sql_query(
        s, "SELECT group_concat(name, ', '), count(*) FROM pragma_table_info('runs', 'main') WHERE cid >= %d",
        N_COLUMNS);
    rp_status status = RP_OK;
    if (now && sqlite3_step(q) == SQLITE_ROW && sqlite3_column_int64(q, 1) > 0 &&
        (lacks || sqlite3_column_int64(q, 1) != (sqlite3_int64)sweep_count_outputs(protocol))) {
        char *before = sqlite3_mprintf("%s", sqlite3_column_text(q, 0));
        sqlite3_reset(q);
        status = sweep_sql(s, "write the store",
                           "DROP INDEX main.by_run; DROP INDEX main.by_status;"
                           "ALTER TABLE main.runs RENAME TO \"runs of %w\"",
                           before);
        *table = rp_text(arena, "runs of %s", before);
        sqlite3_free(before);
        char *aside = sqlite3_mprintf("runs of %s", now);
        if (!status && aside &&
            sqlite3_table_column_metadata(s->db, "main", aside, "key", NULL, NULL, NULL, NULL, NULL) ==
                SQLITE_OK)
            status = sweep_sql(s, "write the store", "ALTER TABLE main.\"%w\" RENAME TO runs", aside);
        sqlite3_free(aside);
    }
    sqlite3_free(now);
    const rp_status read = sweep_sql_finish(s, "read the store", q);
    return status ? status : read;
}

rp_status sweep_store_number(sweep_store *s, const sweep_plan *plan, sweep_watch *watch)
{
    long long rows;
    RP_TRY(sweep_sql(s, "write the store", "UPDATE runs SET run = NULL WHERE run IS NOT NULL"));
    RP_TRY(sweep_sql_number(s, "SELECT count(*) FROM runs", &rows));
    if (rows == 0) return RP_OK;
    sqlite3_stmt *q = sweep_sql_query(s, "UPDATE runs SET run = ? WHERE key = ?");
    char key[33];
    for (size_t r = 0; r < plan->n_runs; r++) {
        sweep_plan_key(plan, r, key);
        sqlite3_bind_int64(q, 1, (sqlite3_int64)r);
        sqlite3_bind_text(q, 2, key, -1, SQLITE_STATIC);
        if (sqlite3_step(q) != SQLITE_DONE) break;
        sqlite3_reset(q);
        if (watch) watch("rows looked up", r + 1, plan->n_runs);
    }
    return sweep_sql_finish(s, "write the store", q);
}

/* ---- writing rows ---- */

/* The store keeps no NaN's payload, and no minus of a zero. */
static XXH64_hash_t hash_value(const char *name, double value, XXH64_hash_t seed)
{
    const double v = value + 0.0;
    return isnan(v) ? seed
                    : XXH3_64bits_withSeed(&v, sizeof v, XXH3_64bits_withSeed(name, strlen(name), seed));
}

/* Values are summed by the names of their outputs: an output without a value, or a new one, adds nothing. */
static sqlite3_int64 sum_of(const sweep_row *r, const sweep_output outputs[])
{
    const char *const texts[] = {r->key, r->result.status, r->result.message, r->program, r->parameters};
    const sqlite3_int64 whole[] = {r->seed, r->model, r->pile};
    XXH64_hash_t sum = XXH3_64bits(whole, sizeof whole);
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++)
        sum = XXH3_64bits_withSeed(texts[i], strlen(texts[i]), sum + i);
    sum = hash_value("seconds", r->seconds, sum);
    for (size_t i = 0; outputs[i].name; i++) sum += hash_value(outputs[i].name, r->result.values[i], 0);
    return (sqlite3_int64)sum;
}

void sweep_store_columns(const sweep_store *s, const char *schema, sqlite3_str *sql,
                         const sweep_protocol *protocol)
{
    sqlite3_str_appendall(sql,
                          "key, run, status, message, seconds, seed, model, program, pile, parameters, sum");
    for (const sweep_output *o = protocol->outputs; o->name; o++)
        sqlite3_str_appendf(sql, !s || sweep_store_has(s, schema, o->name) ? ", \"%w\"" : ", 'none'",
                            o->name);
}

sqlite3_stmt *sweep_store_query_insert(sweep_store *s, const sweep_protocol *protocol)
{
    sqlite3_str *sql = sqlite3_str_new(s->db);
    sqlite3_str_appendall(sql, "INSERT INTO main.runs (");
    sweep_store_columns(NULL, NULL, sql, protocol);
    sqlite3_str_appendall(sql, ") VALUES (?");
    for (size_t n = N_COLUMNS + sweep_count_outputs(protocol); --n > 0;) sqlite3_str_appendall(sql, ", ?");
    sqlite3_str_appendall(sql, ")");
    return sweep_sql_query_text(s, sql);
}

static void bind_row(sqlite3_stmt *q, const sweep_row *r, const sweep_output outputs[])
{
    int column = 0;
    sqlite3_bind_text(q, ++column, r->key, -1, SQLITE_STATIC);
    sqlite3_bind_int64(q, ++column, (sqlite3_int64)r->run);
    sqlite3_bind_text(q, ++column, r->result.status, -1, SQLITE_STATIC);
    sqlite3_bind_text(q, ++column, r->result.message, -1, SQLITE_STATIC);
    sqlite3_bind_double(q, ++column, r->seconds);
    sqlite3_bind_int64(q, ++column, r->seed);
    sqlite3_bind_int64(q, ++column, r->model);
    sqlite3_bind_text(q, ++column, r->program, -1, SQLITE_STATIC);
    sqlite3_bind_int64(q, ++column, r->pile);
    sqlite3_bind_text(q, ++column, r->parameters, -1, SQLITE_STATIC);
    sqlite3_bind_int64(q, ++column, sum_of(r, outputs));
    for (size_t i = 0; outputs[i].name; i++) /* NaN: NULL */
        sqlite3_bind_double(q, ++column, r->result.values[i]);
}

rp_status sweep_store_insert(sweep_store *s, const sweep_plan *plan, const sweep_row *made)
{
    if (!s->insert && !(s->insert = sweep_store_query_insert(s, plan->protocol)))
        return sweep_sql_fail(s, "write the store");
    if (!s->pending) RP_TRY(sweep_sql(s, "write the store", "BEGIN IMMEDIATE"));
    char parameters[8192];
    sweep_row row = *made;
    const sweep_stream stream = sweep_plan_stream(plan, row.run);
    row.seed = (sqlite3_int64)stream.seed;
    row.model = RP_MODEL_VERSION;
    row.pile = (sqlite3_int64)stream.pile;
    row.program = s->program;
    row.parameters = sweep_plan_parameters(plan, row.run / plan->replicas, parameters, sizeof parameters);
    sweep_plan_key(plan, row.run, row.key);
    s->pending = true;
    bind_row(s->insert, &row, plan->protocol->outputs);
    const bool stored = sqlite3_step(s->insert) == SQLITE_DONE;
    sqlite3_reset(s->insert);
    return stored ? sweep_store_tick(s)
                  : rp_fail(RP_IO, "%s: cannot store run %zu: %s; the rows stored before are kept", s->path,
                            row.run, sqlite3_errmsg(s->db));
}

rp_status sweep_store_commit(sweep_store *s)
{
    if (!s->pending) return RP_OK;
    s->pending = false;
    s->committed = rp_clock();
    return sweep_sql(s, "store the latest rows; those stored before are kept", "COMMIT");
}

rp_status sweep_store_tick(sweep_store *s)
{
    const double now = rp_clock();
    rp_status status = s->pending && now - s->committed >= GROUP_SECONDS ? sweep_store_commit(s) : RP_OK;
    if (status || (s->beaten > 0.0 && now - s->beaten < BEAT_SECONDS)) return status;
    char text[64];
    s->beaten = now;
    snprintf(text, sizeof text, "%lld", (long long)time(NULL));
    return set_note(s, "beat", text);
}

/* ---- reading rows ---- */

rp_status sweep_store_verify(sweep_store *s, const char *schema, const char *path)
{
    char text[256];
    sqlite3_stmt *q = sweep_sql_query(s, "PRAGMA %s.integrity_check(1)", schema);
    const int rc = sqlite3_step(q);
    snprintf(text, sizeof text, "%s",
             rc == SQLITE_ROW ? (const char *)sqlite3_column_text(q, 0) : sqlite3_errmsg(s->db));
    sqlite3_finalize(q);
    return strcmp(text, "ok") == 0
               ? RP_OK
               : rp_fail(RP_IO, "%s: damaged (%s); `repose sweep salvage` keeps the whole rows", path, text);
}

rp_status sweep_store_drop_crashed(sweep_store *s)
{
    return sweep_sql(s, "write the store",
                     "DELETE FROM main.runs WHERE status IN " RP_MACHINE_STATUS " AND run IS NOT NULL");
}

rp_status sweep_store_mark(sweep_store *s, size_t n_runs, unsigned char *done)
{
    sqlite3_stmt *q =
        sweep_sql_query(s, "SELECT run FROM runs WHERE run IS NOT NULL AND status NOT IN " RP_MACHINE_STATUS);
    while (sqlite3_step(q) == SQLITE_ROW) {
        const size_t run = (size_t)sqlite3_column_int64(q, 0);
        if (run < n_runs) done[run / 8] |= (unsigned char)(1u << run % 8);
    }
    return sweep_sql_finish(s, "read the store", q);
}

/* NaN for NULL and for 'none'. */
static double column_number(sqlite3_stmt *q, int column)
{
    const int type = sqlite3_column_type(q, column);
    return type == SQLITE_FLOAT || type == SQLITE_INTEGER ? sqlite3_column_double(q, column) : NAN;
}

rp_status sweep_store_count(sweep_store *s, const sweep_plan *plan, sweep_counts *counts)
{
    *counts = (sweep_counts){.points = plan->n_points, .replicas = plan->replicas, .planned = plan->n_runs};
    memcpy(counts->skipped, s->skipped, sizeof s->skipped);
    sqlite3_stmt *q = sweep_sql_query(
        s, "SELECT status, count(*) FROM runs WHERE run IS NOT NULL GROUP BY status ORDER BY status");
    while (sqlite3_step(q) == SQLITE_ROW) {
        const char *word = (const char *)sqlite3_column_text(q, 0);
        const size_t runs = (size_t)sqlite3_column_int64(q, 1);
        rp_tally_add(&counts->words, word, strlen(word), (double)runs);
        counts->stored += runs;
        if (!rp_is_result(word)) counts->failed += runs;
    }
    RP_TRY(sweep_sql_finish(s, "count the rows", q));
    q = sweep_sql_query(s,
                        "SELECT avg(seconds) FROM (SELECT seconds FROM runs ORDER BY rowid DESC LIMIT 1000)");
    counts->seconds = sqlite3_step(q) == SQLITE_ROW ? column_number(q, 0) : NAN;
    return sweep_sql_finish(s, "read the store", q);
}

/* A text of which a changed byte made a blob is none: SQL takes the two for different ones. */
static const char *column_text(sqlite3_stmt *q, int column)
{
    const bool blob = sqlite3_column_type(q, column) == SQLITE_BLOB;
    const char *text = (const char *)sqlite3_column_text(q, column);
    return text && !blob ? text : "";
}

/* The row that is read, until the next step; false if its sum is wrong. */
static bool take_row(sqlite3_stmt *q, const sweep_output outputs[], sweep_row *r)
{
    *r = (sweep_row){.run = (size_t)sqlite3_column_int64(q, 1),
                     .seconds = column_number(q, 4),
                     .seed = sqlite3_column_int64(q, 5),
                     .model = sqlite3_column_int64(q, 6),
                     .program = column_text(q, 7),
                     .pile = sqlite3_column_int64(q, 8),
                     .parameters = column_text(q, 9)};
    snprintf(r->key, sizeof r->key, "%s", column_text(q, 0));
    snprintf(r->result.status, sizeof r->result.status, "%s", column_text(q, 2));
    snprintf(r->result.message, sizeof r->result.message, "%s", column_text(q, 3));
    for (int i = 0; outputs[i].name; i++) r->result.values[i] = column_number(q, N_COLUMNS + i);
    return sum_of(r, outputs) == sqlite3_column_int64(q, 10);
}

bool sweep_store_row_is_whole(sqlite3_stmt *q, const sweep_protocol *protocol)
{
    sweep_row row;
    return take_row(q, protocol->outputs, &row);
}

/* The row that is read, checked against its sum and, in a store of the same plan, against the key of its
 * number. */
static rp_status read_row(const char *path, const sweep_plan *plan, bool same, sqlite3_stmt *q,
                          sweep_row *row)
{
    char key[33] = "";
    const bool whole = take_row(q, plan->protocol->outputs, row),
               numbered = same && sqlite3_column_type(q, 1) != SQLITE_NULL;
    if (row->run < plan->n_runs) sweep_plan_key(plan, row->run, key);
    if (whole && (!numbered || strcmp(key, row->key) == 0)) return RP_OK;
    snprintf(key, sizeof key, "run %zu", row->run);
    return rp_fail(RP_IO,
                   "%s: the row of %s is damaged (checksum); `repose sweep salvage` keeps the whole rows",
                   path, numbered ? key : "another plan's run");
}

/* Read and check the rows of this plan, in their order, or all those of a schema; `visit` may be NULL. */
static rp_status read_rows(sweep_store *s, const char *schema, const char *path, const sweep_plan *plan,
                           bool same, rp_status (*visit)(const sweep_row *row, void *context), void *context)
{
    sqlite3_str *sql = sqlite3_str_new(s->db);
    sqlite3_str_appendall(sql, "SELECT ");
    sweep_store_columns(s, schema, sql, plan->protocol);
    sqlite3_str_appendf(sql, schema ? " FROM %s.runs" : " FROM runs WHERE run IS NOT NULL ORDER BY run",
                        schema);
    sqlite3_stmt *q = sweep_sql_query_text(s, sql);
    rp_status status = RP_OK;
    while (!status && sqlite3_step(q) == SQLITE_ROW) {
        sweep_row row;
        status = read_row(path, plan, same, q, &row);
        if (!status && visit) status = visit(&row, context);
    }
    rp_status read = sweep_sql_finish(s, "read the rows", q);
    return status ? status : read;
}

rp_status sweep_store_visit(sweep_store *s, const sweep_plan *plan,
                            rp_status (*visit)(const sweep_row *row, void *context), void *context)
{
    return read_rows(s, NULL, s->path, plan, true, visit, context);
}

rp_status sweep_store_check_rows(sweep_store *s, const char *schema, const char *path, const sweep_plan *plan)
{
    char hash[33];
    RP_TRY(sweep_store_note(s, schema, "plan", hash, sizeof hash));
    return read_rows(s, schema, path, plan, strcmp(hash, plan->hash) == 0, NULL, NULL);
}

/* ---- planning ---- */

typedef struct {
    XXH128_hash_t hash;
    size_t point;
} entry;

/* The grid points of the plan before in the order of what their runs have of these outputs; NULL: they lack
 * one. */
static entry *sort_points(const sweep_plan *before, const sweep_output outputs[], rp_arena *arena)
{
    entry *e = rp_arena_memory(arena, before->n_points, sizeof *e);
    for (size_t p = 0; p < before->n_points && e; p++) {
        e[p].point = p;
        if (!before->protocol->hash(sweep_plan_point(before, p), outputs, &e[p].hash)) return NULL;
    }
    if (e) qsort(e, before->n_points, sizeof *e, XXH128_cmp);
    return e;
}

/* A row of the plan before as that of this run. */
static rp_status take_as(sweep_store *s, sweep_row *row, const sweep_plan *before, const sweep_plan *plan,
                         size_t run, sqlite3_stmt *into)
{
    char parameters[8192];
    const sweep_row of = *row;
    row->run = run;
    row->parameters = sweep_plan_parameters(plan, run / plan->replicas, parameters, sizeof parameters);
    sweep_plan_key(plan, run, row->key);
    for (size_t k = 0; plan->protocol->outputs[k].name; k++)
        for (size_t j = 0; before->protocol->outputs[j].name; j++)
            if (strcmp(plan->protocol->outputs[k].name, before->protocol->outputs[j].name) == 0)
                row->result.values[k] = of.result.values[j];
    bind_row(into, row, plan->protocol->outputs);
    sqlite3_bind_null(into, 2); /* numbers are given later */
    const int stored = sqlite3_step(into);
    sqlite3_reset(into);
    return stored == SQLITE_DONE || stored == SQLITE_CONSTRAINT ? RP_OK
                                                                : sweep_sql_fail(s, "write the store");
}

/* Results of the plan before, with all that this one measures and more: the same runs, under other keys. */
static rp_status take_over(sweep_store *s, const sweep_plan *before, const char *table,
                           const sweep_plan *plan, rp_arena *arena)
{
    const sweep_output *outputs = plan->protocol->outputs;
    const entry *e = sort_points(before, outputs, arena), *at;
    entry wanted;
    rp_status status = RP_OK;
    if (!e) return RP_OK;
    sqlite3_str *sql = sqlite3_str_new(s->db);
    sqlite3_str_appendall(sql, "SELECT ");
    sweep_store_columns(NULL, NULL, sql, before->protocol);
    sqlite3_str_appendf(sql, " FROM main.\"%w\" WHERE key = ?", table);
    sqlite3_stmt *from = sweep_sql_query_text(s, sql), *into = sweep_store_query_insert(s, plan->protocol);
    if (!from) return sqlite3_finalize(into), RP_OK; /* of a process that was killed: other columns */
    for (size_t r = 0; into && !status && r < plan->n_runs; r++) {
        const size_t replica = r % plan->replicas;
        if (replica == 0 &&
            !plan->protocol->hash(sweep_plan_point(plan, r / plan->replicas), outputs, &wanted.hash))
            break;
        at = bsearch(&wanted, e, before->n_points, sizeof *e, XXH128_cmp);
        if (!at) continue;
        const size_t run = at->point * before->replicas + replica;
        const sweep_stream now = sweep_plan_stream(plan, r), then = sweep_plan_stream(before, run);
        char key[33];
        sweep_row row;
        if (now.seed != then.seed || now.run != then.run) continue;
        sweep_plan_key(before, run, key);
        sqlite3_bind_text(from, 1, key, -1, SQLITE_STATIC);
        if (sqlite3_step(from) == SQLITE_ROW && take_row(from, before->protocol->outputs, &row) &&
            rp_is_result(row.result.status))
            status = take_as(s, &row, before, plan, r, into);
        sqlite3_reset(from);
    }
    sqlite3_finalize(into);
    const rp_status read = sweep_sql_finish(s, "read the rows", from);
    return status ? status : read;
}

static rp_status write_notes(sweep_store *s, const sweep_plan *plan, const char *file)
{
    char replicas[32], seed[32];
    snprintf(replicas, sizeof replicas, "%zu", plan->replicas);
    snprintf(seed, sizeof seed, "%lu", plan->seed);
    const char *const notes[][2] = {{"protocol", plan->protocol->name},
                                    {"file", file},
                                    {"seed", seed},
                                    {"replicas", replicas},
                                    {"model", plan->model},
                                    {"plan", plan->hash}};
    for (size_t i = 0; i < sizeof notes / sizeof *notes; i++) RP_TRY(set_note(s, notes[i][0], notes[i][1]));
    return RP_OK;
}

rp_status sweep_store_write_plan(sweep_store *s, const sweep_plan *plan, const sweep_plan *before,
                                 const char *file, sweep_watch *watch)
{
    RP_SCOPE(arena);
    const char *table = "runs";
    char owner[64] = "", hash[33] = "";
    RP_TRY(sweep_sql(s, "write the store",
                     "BEGIN IMMEDIATE; PRAGMA user_version = %d; CREATE TABLE IF NOT EXISTS sweep"
                     " (name TEXT PRIMARY KEY, value TEXT NOT NULL, sum INTEGER)",
                     SWEEP_FORMAT));
    if (plan->protocol->context) RP_TRY(set_aside(s, plan->protocol, &arena, &table));
    RP_TRY(sweep_store_make_runs(s, "main", plan->protocol));
    RP_TRY(sweep_store_check_outputs(s, "main", s->path, plan->protocol));
    RP_TRY(sweep_store_note(s, "main", "protocol", owner, sizeof owner));
    RP_TRY(sweep_store_note(s, "main", "plan", hash, sizeof hash));
    if (*owner && strcmp(owner, plan->protocol->name) != 0)
        return rp_fail(RP_BAD_INPUT, "%s: holds runs of protocol \"%s\", not \"%s\"; plan in another folder",
                       s->path, owner, plan->protocol->name);
    if (before && table) RP_TRY(take_over(s, before, table, plan, &arena));
    if (strcmp(hash, plan->hash) != 0) RP_TRY(sweep_store_number(s, plan, watch));
    RP_TRY(write_notes(s, plan, file));
    return sweep_sql(s, "write the store", "COMMIT");
}
