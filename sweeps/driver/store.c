/* The store of a sweep: one SQLite file, one writer. Tables:
 *   sweep  name, value: protocol, sweep file, seed, replicas, model
 *   plan   one row a planned run: run, key, point, replica
 *   runs   one row a finished run: run, status, message, seconds, seed, model, key, program,
 *          pile (number of its random streams), then a column for each
 *          parameter and output of the protocol; an output without a value is NULL
 * Planning again replaces `plan` only. An open store is the parent's alone: no worker touches it. */
#include "sweeps/driver/private.h"

#include <math.h>
#include <sqlite3.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include "core/version.h"

/* How long a writer waits for those who read, and the reverse. */
enum { BUSY_MS = 60000 };

struct sweep_store {
    sqlite3 *db;
    sqlite3_stmt *insert;
    char path[4096];
};

static rp_status fail(const sweep_store *s, const char *what)
{
    return rp_fail(RP_IO, "%s: cannot %s: %s", s->path, what, sqlite3_errmsg(s->db));
}

static rp_status execute(sweep_store *s, const char *what, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    char *sql = sqlite3_vmprintf(format, args);
    va_end(args);
    int rc = sql ? sqlite3_exec(s->db, sql, NULL, NULL, NULL) : SQLITE_NOMEM;
    sqlite3_free(sql);
    return rc == SQLITE_OK ? RP_OK : fail(s, what);
}

/* NULL for a statement that cannot be prepared: its first step fails, and `finish` says why. */
static sqlite3_stmt *query(sweep_store *s, const char *sql)
{
    sqlite3_stmt *statement = NULL;
    sqlite3_prepare_v2(s->db, sql, -1, &statement, NULL);
    return statement;
}

/* The same of a text, which is freed. */
static sqlite3_stmt *query_text(sweep_store *s, sqlite3_str *text)
{
    char *sql = sqlite3_str_finish(text);
    sqlite3_stmt *statement = query(s, sql);
    sqlite3_free(sql);
    return statement;
}

/* End a query. Errors: RP_IO if one of its steps failed. */
static rp_status finish(sweep_store *s, const char *what, sqlite3_stmt *q)
{
    const bool prepared = q != NULL;
    return sqlite3_finalize(q) == SQLITE_OK && prepared ? RP_OK : fail(s, what);
}

rp_status sweep_store_open(const char *dir, sweep_store_mode mode, sweep_store **store)
{
    sweep_store *s = *store = calloc(1, sizeof **store);
    if (!s) return rp_fail(RP_NO_MEMORY, "%s: out of memory", dir);
    snprintf(s->path, sizeof s->path, "%s/store.sqlite", dir);
    int flags = SQLITE_OPEN_READWRITE | (mode == SWEEP_STORE_CREATE ? SQLITE_OPEN_CREATE : 0);
    if (sqlite3_open_v2(s->path, &s->db, flags, NULL) != SQLITE_OK) return fail(s, "open the store");
    sqlite3_busy_timeout(s->db, BUSY_MS);
    /* the first look says whether it is a database at all; within a transaction, all see what it sees */
    return execute(s, "read the store", "%s SELECT count(*) FROM sqlite_schema",
                   mode == SWEEP_STORE_READ ? "BEGIN;" : "");
}

void sweep_store_close(sweep_store *store)
{
    if (!store) return;
    sqlite3_finalize(store->insert);
    sqlite3_close(store->db);
    free(store);
}

/* A text; empty for what a damaged store lacks. */
static const char *column_text(sqlite3_stmt *q, int column)
{
    const char *text = (const char *)sqlite3_column_text(q, column);
    return text ? text : "";
}

rp_status sweep_store_note(sweep_store *s, const char *name, char *buffer, size_t size)
{
    sqlite3_stmt *q = query(s, "SELECT value FROM sweep WHERE name = ?");
    buffer[0] = '\0';
    sqlite3_bind_text(q, 1, name, -1, SQLITE_STATIC);
    if (sqlite3_step(q) == SQLITE_ROW) snprintf(buffer, size, "%s", column_text(q, 0));
    return finish(s, "read the store", q);
}

/* A column of `runs`, unless it is there already. */
static rp_status add_column(sweep_store *s, const char *name, const char *type)
{
    if (sqlite3_table_column_metadata(s->db, NULL, "runs", name, NULL, NULL, NULL, NULL, NULL) == SQLITE_OK)
        return RP_OK;
    return execute(s, "write the store", "ALTER TABLE runs ADD COLUMN \"%w\" %s", name, type);
}

static rp_status make_tables(sweep_store *s, const sweep_protocol *protocol)
{
    rp_status status =
        execute(s, "write the store",
                "CREATE TABLE IF NOT EXISTS sweep (name TEXT PRIMARY KEY, value TEXT NOT NULL);"
                "CREATE TABLE IF NOT EXISTS plan (run INTEGER PRIMARY KEY, key TEXT NOT NULL UNIQUE,"
                " point INTEGER, replica INTEGER);"
                "CREATE TABLE IF NOT EXISTS runs (run INTEGER, status TEXT NOT NULL, message TEXT,"
                " seconds REAL, seed INTEGER, model INTEGER, key TEXT NOT NULL PRIMARY KEY)");
    if (!status) status = add_column(s, "program", "TEXT");
    if (!status) status = add_column(s, "pile", "INTEGER");
    for (const rp_param *p = protocol->schema; !status && p->name; p++)
        status = add_column(s, p->name, p->type == RP_REAL ? "REAL" : p->type == RP_INT ? "INTEGER" : "TEXT");
    for (const sweep_output *o = protocol->outputs; !status && o->name; o++)
        status = add_column(s, o->name, "REAL");
    return status;
}

static rp_status write_runs(sweep_store *s, const sweep_plan *plan)
{
    rp_status status = execute(s, "write the store", "DELETE FROM plan");
    for (size_t r = 0; !status && r < plan->n_runs; r++)
        status = execute(s, "write the store",
                         "INSERT INTO plan (run, key, point, replica) VALUES (%llu, %Q, %llu, %llu)",
                         (unsigned long long)r, plan->keys[r], (unsigned long long)(r / plan->replicas),
                         (unsigned long long)(r % plan->replicas));
    return status;
}

rp_status sweep_store_write_plan(sweep_store *s, const sweep_plan *plan, const char *file)
{
    char owner[64] = "";
    rp_status status = execute(s, "write the store", "BEGIN IMMEDIATE");
    if (status) return status;
    status = make_tables(s, plan->protocol);
    if (!status) status = sweep_store_note(s, "protocol", owner, sizeof owner);
    if (!status && *owner && strcmp(owner, plan->protocol->name) != 0)
        status =
            rp_fail(RP_BAD_INPUT, "%s: holds runs of protocol \"%s\", not \"%s\"; plan in another folder",
                    s->path, owner, plan->protocol->name);
    if (!status) status = write_runs(s, plan);
    if (!status)
        status = execute(s, "write the store",
                         "REPLACE INTO sweep VALUES ('protocol', %Q), ('file', %Q), ('seed', '%lu'),"
                         " ('replicas', '%llu'), ('model', '%d');"
                         "COMMIT",
                         plan->protocol->name, file, plan->seed, (unsigned long long)plan->replicas,
                         RP_MODEL_VERSION);
    if (status) sqlite3_exec(s->db, "ROLLBACK", NULL, NULL, NULL);
    return status;
}

rp_status sweep_store_check_plan(sweep_store *s, const sweep_plan *plan)
{
    sqlite3_stmt *q = query(s, "SELECT run, key FROM plan ORDER BY run");
    size_t n = 0;
    bool same = true;
    for (; same && sqlite3_step(q) == SQLITE_ROW; n++)
        same = n < plan->n_runs && sqlite3_column_int64(q, 0) == (sqlite3_int64)n &&
               strcmp(column_text(q, 1), plan->keys[n]) == 0;
    rp_status status = finish(s, "read the plan", q);
    if (status) return status;
    if (!same || n != plan->n_runs)
        return rp_fail(RP_BAD_INPUT,
                       "%s: the plan is not that of sweep.cfg and this version of the program; "
                       "plan again with `repose sweep plan` (stored rows are kept)",
                       s->path);
    return RP_OK;
}

rp_status sweep_store_makers(sweep_store *s, void (*visit)(const char *program, size_t runs, void *context),
                             void *context)
{
    sqlite3_stmt *q = query(
        s, "SELECT program, count(*) FROM plan JOIN runs USING (key) GROUP BY program ORDER BY program");
    while (sqlite3_step(q) == SQLITE_ROW)
        visit((const char *)sqlite3_column_text(q, 0), (size_t)sqlite3_column_int64(q, 1), context);
    return finish(s, "read the rows", q);
}

rp_status sweep_store_missing(sweep_store *s, const sweep_plan *plan, size_t **missing, size_t *n)
{
    *n = 0;
    *missing = malloc(plan->n_runs * sizeof **missing);
    if (!*missing) return rp_fail(RP_NO_MEMORY, "%s: out of memory", s->path);
    rp_status status = execute(s, "write the store",
                               "DELETE FROM runs WHERE status = 'crashed' AND key IN (SELECT key FROM plan)");
    if (status) return status;
    sqlite3_stmt *q = query(s, "SELECT run FROM plan WHERE key NOT IN (SELECT key FROM runs) ORDER BY run");
    while (sqlite3_step(q) == SQLITE_ROW && *n < plan->n_runs)
        (*missing)[(*n)++] = (size_t)sqlite3_column_int64(q, 0);
    return finish(s, "read the store", q);
}

/* The part of every row that the plan and the program say is in the statement. */
static sqlite3_stmt *query_insert(sweep_store *s, const sweep_plan *plan)
{
    sqlite3_str *sql = sqlite3_str_new(s->db);
    size_t n = 6;
    sqlite3_str_appendall(sql,
                          "INSERT INTO runs (seed, model, program, run, status, message, seconds, pile, key");
    for (const rp_param *p = plan->protocol->schema; p->name; p++, n++)
        sqlite3_str_appendf(sql, ", \"%w\"", p->name);
    for (const sweep_output *o = plan->protocol->outputs; o->name; o++, n++)
        sqlite3_str_appendf(sql, ", \"%w\"", o->name);
    sqlite3_str_appendf(sql, ") VALUES (%lu, %d, 'repose %q, commit %q, %q'", plan->seed, RP_MODEL_VERSION,
                        RP_VERSION, rp_build_commit, rp_build_compiler);
    while (n--) sqlite3_str_appendall(sql, ", ?");
    sqlite3_str_appendall(sql, ")");
    return query_text(s, sql);
}

rp_status sweep_store_insert(sweep_store *s, const sweep_plan *plan, const sweep_row *row)
{
    if (!s->insert) s->insert = query_insert(s, plan);
    int column = 0;
    char text[256];
    sqlite3_stmt *q = s->insert;
    sqlite3_bind_int64(q, ++column, (sqlite3_int64)row->run);
    sqlite3_bind_text(q, ++column, row->result.status, -1, SQLITE_STATIC);
    sqlite3_bind_text(q, ++column, row->result.message, -1, SQLITE_STATIC);
    sqlite3_bind_double(q, ++column, row->seconds);
    sqlite3_bind_int64(q, ++column, (sqlite3_int64)sweep_plan_pile(plan, row->run));
    sqlite3_bind_text(q, ++column, plan->keys[row->run], -1, SQLITE_STATIC);
    /* as texts: the column's type makes numbers of those that are numbers */
    for (const rp_param *p = plan->protocol->schema; p->name; p++)
        sqlite3_bind_text(
            q, ++column,
            rp_params_text(p, sweep_plan_point(plan, row->run / plan->replicas), text, sizeof text), -1,
            SQLITE_TRANSIENT);
    for (size_t i = 0; plan->protocol->outputs[i].name; i++)
        sqlite3_bind_double(q, ++column, row->result.values[i]); /* NaN becomes NULL */
    rp_status status = RP_OK;
    if (sqlite3_step(q) != SQLITE_DONE)
        status = rp_fail(RP_IO, "%s: cannot store run %zu: %s; the rows stored before are kept", s->path,
                         row->run, sqlite3_errmsg(s->db));
    sqlite3_reset(q);
    return status;
}

rp_status sweep_store_count(sweep_store *s, const sweep_plan *plan, sweep_counts *counts)
{
    *counts = (sweep_counts){.points = plan->n_points, .replicas = plan->replicas, .planned = plan->n_runs};
    sqlite3_stmt *q =
        query(s, "SELECT status, count(*) FROM plan JOIN runs USING (key) GROUP BY status ORDER BY status");
    while (sqlite3_step(q) == SQLITE_ROW && counts->n_words < SWEEP_MAX_WORDS) {
        size_t i = counts->n_words++, runs = (size_t)sqlite3_column_int64(q, 1);
        snprintf(counts->words[i].status, sizeof counts->words[i].status, "%s", column_text(q, 0));
        counts->words[i].runs = runs;
        counts->stored += runs;
        if (!sweep_is_result(counts->words[i].status)) counts->failed += runs;
    }
    return finish(s, "count the rows", q);
}

static double column_number(sqlite3_stmt *q, int column)
{
    return sqlite3_column_type(q, column) == SQLITE_NULL ? NAN : sqlite3_column_double(q, column);
}

rp_status sweep_store_visit(sweep_store *s, const sweep_plan *plan,
                            rp_status (*visit)(const sweep_row *row, void *context), void *context)
{
    sqlite3_str *sql = sqlite3_str_new(s->db);
    sqlite3_str_appendall(sql, "SELECT plan.run, runs.status, runs.seconds");
    for (const sweep_output *o = plan->protocol->outputs; o->name; o++)
        sqlite3_str_appendf(sql, ", runs.\"%w\"", o->name);
    sqlite3_str_appendall(sql, " FROM plan JOIN runs USING (key) ORDER BY plan.run");
    sqlite3_stmt *q = query_text(s, sql);
    rp_status status = RP_OK;
    while (!status && sqlite3_step(q) == SQLITE_ROW) {
        sweep_row row = {.run = (size_t)sqlite3_column_int64(q, 0), .seconds = column_number(q, 2)};
        snprintf(row.result.status, sizeof row.result.status, "%s", column_text(q, 1));
        for (int i = 0; plan->protocol->outputs[i].name; i++) row.result.values[i] = column_number(q, 3 + i);
        status = visit(&row, context);
    }
    rp_status read = finish(s, "read the rows", q);
    return status ? status : read;
}
