/* The store of a sweep: a dictionary from key to row, a SQLite file with one writer. Tables:
 *   sweep  name, value: protocol, file (name of the sweep file as it was given), model
 *   runs   key, status, message, seconds, parameters (JSON: those that the file gives), results (JSON: an
 *          output without a value is null; the name of a measure has the hash of its text), program; a row
 *          a finished run
 * A row that lacks an output, of a measure that is new in the text, is run again and keeps what it has. Where
 * a measure without a value gives the status, the row holds for all its measures together. Which runs there
 * are follows from the sweep's file, and the store is asked for them by key. Rows are committed in groups of
 * a quarter of a second, each synced to the disk. An open store is the parent's alone: no worker touches it.
 * Its rollback journal works on file systems of several machines too. */
#include "sweeps/engine/private.h"

#include <inttypes.h>
#include <jansson.h>
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include "core/clock.h"
#include "core/plain.h"
#include "core/version.h"
#include "table/columns.h"

enum { FORMAT = 5, PATIENCE_MS = 60000 };
static const double GROUP_SECONDS = 0.25;
#define COLUMNS "key, status, message, seconds, parameters, results, program"
/* In results whose status is of all these measures together, of which there is the hash. */
#define WITH "\"* %016" PRIx64 "\":null"
/* Of a row that is there and another under its key: the status of both is of the run itself; the other has
 * something new, or its status is of the run where this one's is of measures, or the other way round. */
#define TOGETHER(results) "(" results " LIKE '%%\"* %%')"
#define BOTH_ALONE        "NOT (" TOGETHER("results") " OR " TOGETHER("excluded.results") ")"
#define NEW                                                                                                  \
    "excluded.status NOT IN " RP_MACHINE_STATUS " AND (" TOGETHER("results") " <> " TOGETHER(                \
        "excluded.results") " OR EXISTS (SELECT key FROM json_each(excluded.results) EXCEPT SELECT key "     \
                            "FROM json_each(results)))"
/* Of a row that is there, what the other has of results besides. */
#define UNITES                                                                                               \
    " ON CONFLICT (key) DO UPDATE SET results = unite(results, excluded.results) WHERE " NEW " AND"          \
    " " BOTH_ALONE

static rp_status failed(const sweep_store *s)
{
    return rp_fail(RP_IO, "%s: %s", s->path, sqlite3_errmsg(s->db));
}

static rp_status run_sql(sweep_store *s, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    char *sql = sqlite3_vmprintf(format, args);
    va_end(args);
    const int rc = sql ? sqlite3_exec(s->db, sql, NULL, NULL, NULL) : SQLITE_NOMEM;
    sqlite3_free(sql);
    return rc == SQLITE_OK ? RP_OK : failed(s);
}

/* The name that SQLite does not take for an address. */
#define LITERAL(path) *(path) == '/' ? "" : "./", path

/* The first cell of the first row as a text, "" without. */
static rp_status ask(sweep_store *s, char *text, size_t size, const char *format, ...)
{
    va_list args;
    sqlite3_stmt *q = NULL;
    va_start(args, format);
    char *sql = sqlite3_vmprintf(format, args);
    va_end(args);
    sqlite3_prepare_v2(s->db, sql, -1, &q, NULL);
    const char *cell = sqlite3_step(q) == SQLITE_ROW ? (const char *)sqlite3_column_text(q, 0) : NULL;
    snprintf(text, size, "%s", cell ? cell : "");
    sqlite3_free(sql);
    return q && sqlite3_finalize(q) == SQLITE_OK ? RP_OK : failed(s);
}

/* A store of this format, main or attached; *empty: a file in which nothing has been written yet. */
static rp_status check_format(sweep_store *s, const char *schema, bool *empty)
{
    char tables[32], format[32];
    RP_TRY(ask(s, tables, sizeof tables, "SELECT count(*) FROM %s.sqlite_schema", schema));
    RP_TRY(ask(s, format, sizeof format, "PRAGMA %s.user_version", schema));
    *empty = strcmp(tables, "0") == 0;
    return *empty || atoi(format) == FORMAT
               ? RP_OK
               : rp_fail(RP_BAD_INPUT, "%s: a store of format %s, not %d: plan in another folder", s->path,
                         format, FORMAT);
}

/* SQL: the results of both; of one name the first's. */
static void unite_results(sqlite3_context *context, int n, sqlite3_value **texts)
{
    json_t *all = json_loads((const char *)sqlite3_value_text(texts[0]), JSON_DECODE_INT_AS_REAL, NULL),
           *more = json_loads((const char *)sqlite3_value_text(texts[1]), JSON_DECODE_INT_AS_REAL, NULL);
    (void)n;
    json_object_update_missing(all, more);
    char *text = json_dumps(all, JSON_COMPACT | JSON_REAL_PRECISION(17));
    if (text)
        sqlite3_result_text(context, text, -1, free);
    else
        sqlite3_result_error(context, "results are no JSON", -1);
    json_decref(all);
    json_decref(more);
}

rp_status sweep_store_open(const char *path, bool writes, sweep_store **store)
{
    sweep_store *s = *store = calloc(1, sizeof **store);
    if (!s) return rp_fail(RP_NO_MEMORY, "%s: out of memory", path);
    snprintf(s->path, sizeof s->path, "%s", path);
    /* a reader too takes back what a writer that was killed left half done */
    const int flags = SQLITE_OPEN_READWRITE | SQLITE_OPEN_NOMUTEX | (writes ? SQLITE_OPEN_CREATE : 0);
    char *name = sqlite3_mprintf("%s%s", LITERAL(path));
    const int opened = sqlite3_open_v2(name, &s->db, flags, NULL);
    sqlite3_free(name);
    if (opened != SQLITE_OK) return failed(s);
    sqlite3_busy_timeout(s->db, PATIENCE_MS);
    sqlite3_create_function(s->db, "unite", 2, SQLITE_UTF8 | SQLITE_DETERMINISTIC, NULL, unite_results, NULL,
                            NULL);
    RP_TRY(check_format(s, "main", &s->empty));
    /* EXTRA: the removal of the journal, which is the commit, reaches the disk too. Keys come in no order:
     * 64 MB hold the index of a million rows. */
    return writes ? run_sql(s, "PRAGMA synchronous = EXTRA; PRAGMA cache_size = -64000") : RP_OK;
}

void sweep_store_close(sweep_store *s)
{
    if (!s) return;
    sweep_store_commit(s); /* what a failure left */
    sqlite3_finalize(s->insert);
    sqlite3_finalize(s->find);
    sqlite3_close(s->db);
    free(s);
}

rp_status sweep_store_note(sweep_store *s, const char *name, char *value, size_t size)
{
    *value = '\0';
    return s->empty ? RP_OK : ask(s, value, size, "SELECT value FROM main.sweep WHERE name = %Q", name);
}

rp_status sweep_store_write_notes(sweep_store *s, const sweep_plan *plan, const char *file)
{
    char owner[64];
    RP_TRY(sweep_store_note(s, "protocol", owner, sizeof owner));
    if (*owner && strcmp(owner, plan->protocol->name) != 0)
        return rp_fail(RP_BAD_INPUT, "%s: holds runs of protocol \"%s\", not \"%s\"; plan in another folder",
                       s->path, owner, plan->protocol->name);
    s->empty = false;
    return run_sql(
        s,
        "BEGIN IMMEDIATE; PRAGMA user_version = %d;"
        "CREATE TABLE IF NOT EXISTS sweep (name TEXT PRIMARY KEY, value TEXT NOT NULL);"
        "CREATE TABLE IF NOT EXISTS runs (key TEXT PRIMARY KEY, status TEXT NOT NULL, message TEXT,"
        " seconds REAL, parameters TEXT, results TEXT, program TEXT);"
        "REPLACE INTO sweep VALUES ('protocol', %Q), ('file', %Q), ('model', %Q); COMMIT",
        FORMAT, plan->protocol->name, file, plan->model);
}

/* ---- rows ---- */

static char *results_text(const sweep_output outputs[], const sweep_result *result)
{
    const double *values = result->values;
    sqlite3_str *text = sqlite3_str_new(NULL);
    for (size_t i = 0; outputs[i].name; i++) {
        const double v = values[i] + 0.0; /* no minus of a zero */
        char number[32];
        snprintf(number, sizeof number, "%.17g", v);
        sqlite3_str_appendf(text, isinf(v) ? "%s\"%s\":\"%s\"" : "%s\"%s\":%s", i > 0 ? "," : "{",
                            sweep_output_stored(&outputs[i]), isnan(v) ? "null" : number);
    }
    if (result->of_measures)
        sqlite3_str_appendf(text, "%s" WITH, sqlite3_str_length(text) ? "," : "{",
                            sweep_outputs_hash(outputs));
    sqlite3_str_appendall(text, sqlite3_str_length(text) ? "}" : "{}");
    return sqlite3_str_finish(text);
}

static bool has_all(const char *text, const sweep_output outputs[])
{
    char name[320];
    bool all = text != NULL;
    snprintf(name, sizeof name, WITH, sweep_outputs_hash(outputs));
    if (all && strstr(text, "\"* ")) return strstr(text, name) != NULL;
    for (size_t i = 0; all && outputs[i].name; i++) {
        snprintf(name, sizeof name, "\"%s\":", sweep_output_stored(&outputs[i]));
        all = strstr(text, name) != NULL;
    }
    return all;
}

/* NaN for null. */
static bool read_results(const char *text, const sweep_output outputs[], double values[])
{
    json_t *all = text ? json_loads(text, JSON_DECODE_INT_AS_REAL, NULL) : NULL;
    for (size_t i = 0; outputs[i].name; i++) {
        const json_t *v = json_object_get(all, sweep_output_stored(&outputs[i]));
        values[i] = json_is_real(v)     ? json_real_value(v)
                    : json_is_string(v) ? strtod(json_string_value(v), NULL)
                                        : NAN;
    }
    const bool read = json_is_object(all);
    json_decref(all);
    return read;
}

rp_status sweep_store_insert(sweep_store *s, const sweep_plan *plan, const sweep_row *row)
{
    static const char sql[] =
        "INSERT INTO main.runs (" COLUMNS ") VALUES (?, ?, ?, ?, ?, ?, ?) ON CONFLICT (key) DO UPDATE SET"
        " status = excluded.status, message = excluded.message, seconds = excluded.seconds,"
        " results = iif(" BOTH_ALONE ", unite(excluded.results, results), excluded.results),"
        " program = excluded.program WHERE " NEW;
    char key[33], parameters[8192], program[256];
    if (!s->insert && sqlite3_prepare_v2(s->db, sql, -1, &s->insert, NULL) != SQLITE_OK) return failed(s);
    if (!s->pending) RP_TRY(run_sql(s, "BEGIN IMMEDIATE"));
    s->pending = true;
    sweep_plan_key(plan, row->run, key);
    sweep_plan_parameters(plan, row->run / plan->replicas, parameters, sizeof parameters);
    snprintf(program, sizeof program, "repose %s, commit %s, %s", RP_VERSION, rp_build_commit,
             rp_build_compiler);
    sqlite3_bind_text(s->insert, 1, key, -1, SQLITE_STATIC);
    sqlite3_bind_text(s->insert, 2, row->result.status, -1, SQLITE_STATIC);
    sqlite3_bind_text(s->insert, 3, row->result.message, -1, SQLITE_STATIC);
    sqlite3_bind_double(s->insert, 4, row->seconds);
    sqlite3_bind_text(s->insert, 5, parameters, -1, SQLITE_STATIC);
    sqlite3_bind_text(s->insert, 6, results_text(plan->protocol->outputs, &row->result), -1, sqlite3_free);
    sqlite3_bind_text(s->insert, 7, program, -1, SQLITE_STATIC);
    const bool stored = sqlite3_step(s->insert) == SQLITE_DONE &&
                        (sqlite3_changes(s->db) == 1 || sweep_is_aborted(row->result.status));
    sqlite3_reset(s->insert);
    return stored ? sweep_store_tick(s)
                  : rp_fail(RP_IO, "%s: cannot store run %zu: %s; the rows stored before are kept", s->path,
                            row->run, sqlite3_errmsg(s->db));
}

rp_status sweep_store_commit(sweep_store *s)
{
    if (!s->pending) return RP_OK;
    s->pending = false;
    s->committed = rp_clock();
    return sqlite3_exec(s->db, "COMMIT", NULL, NULL, NULL) == SQLITE_OK
               ? RP_OK
               : rp_fail(RP_IO, "%s: cannot store the latest rows: %s; those stored before are kept", s->path,
                         sqlite3_errmsg(s->db));
}

rp_status sweep_store_tick(sweep_store *s)
{
    return s->pending && rp_clock() - s->committed >= GROUP_SECONDS ? sweep_store_commit(s) : RP_OK;
}

rp_status sweep_store_drop_aborted(sweep_store *s)
{
    return run_sql(s, "DELETE FROM main.runs WHERE status IN " RP_MACHINE_STATUS);
}

/* The row that was found; values, which are most of the work, where they are wanted. */
static rp_status read_row(sweep_store *s, const sweep_plan *plan, size_t run, bool values, sweep_row *row)
{
    const char *status = (const char *)sqlite3_column_text(s->find, 0);
    *row = (sweep_row){.run = run,
                       .seconds = sqlite3_column_double(s->find, 1),
                       .program = (const char *)sqlite3_column_text(s->find, 3)};
    snprintf(row->result.status, sizeof row->result.status, "%s", status ? status : "");
    rp_plain(row->result.status); /* of a store of anyone's */
    return !values || read_results((const char *)sqlite3_column_text(s->find, 2), plan->protocol->outputs,
                                   row->result.values)
               ? RP_OK
               : rp_fail(RP_IO, "%s: the results of run %zu are no JSON", s->path, run);
}

rp_status sweep_store_visit(sweep_store *s, const sweep_plan *plan, bool values,
                            rp_status (*visit)(const sweep_row *row, void *context), void *context)
{
    /* of stores that are united, else of this one */
    static const char sql[] = "SELECT status, seconds, results, program FROM runs WHERE key = ?";
    rp_status status = RP_OK;
    if (!s->find && sqlite3_prepare_v2(s->db, sql, -1, &s->find, NULL) != SQLITE_OK) return failed(s);
    RP_TRY(run_sql(s, "SAVEPOINT visit")); /* else each query takes and leaves the lock of the file */
    for (size_t r = 0; r < plan->n_runs && !status; r++) {
        char key[33];
        sweep_row row;
        sweep_plan_key(plan, r, key);
        sqlite3_bind_text(s->find, 1, key, -1, SQLITE_STATIC);
        const int rc = sqlite3_step(s->find);
        const bool whole = rc == SQLITE_ROW &&
                           has_all((const char *)sqlite3_column_text(s->find, 2), plan->protocol->outputs);
        if (whole) status = read_row(s, plan, r, values, &row);
        if (whole && !status) status = visit(&row, context);
        if (rc != SQLITE_ROW && rc != SQLITE_DONE) status = failed(s);
        sqlite3_reset(s->find);
    }
    const rp_status ended = run_sql(s, "RELEASE visit");
    return status ? status : ended;
}

static rp_status count_row(const sweep_row *row, void *context)
{
    sweep_counts *c = context;
    rp_tally_add(&c->words, row->result.status, strlen(row->result.status), 1.0);
    c->stored++;
    c->failed += !rp_is_result(row->result.status);
    c->seconds += row->seconds;
    return RP_OK;
}

static int by_word(const void *a, const void *b)
{
    return strcmp(a, b);
}

rp_status sweep_store_count(sweep_store *s, const sweep_plan *plan, sweep_counts *counts)
{
    *counts = (sweep_counts){.points = plan->n_points, .replicas = plan->replicas, .planned = plan->n_runs};
    RP_TRY(sweep_store_visit(s, plan, false, count_row, counts));
    counts->seconds /= (double)counts->stored;
    qsort(counts->words.of, counts->words.n, sizeof *counts->words.of, by_word); /* the word comes first */
    return RP_OK;
}

/* ---- several stores as one ---- */

/* Two results under one key differ: one of the machines is wrong, and nothing says which. An output that a
 * row lacks is no other result. */
static rp_status find_conflict(sweep_store *s)
{
    char text[1024];
    RP_TRY(ask(s, text, sizeof text,
               "SELECT s.parameters || ', key ' || key FROM source.runs s JOIN temp.runs r USING (key)"
               " WHERE s.status NOT IN " RP_MACHINE_STATUS " AND r.status NOT IN " RP_MACHINE_STATUS
               " AND (s.status <> r.status OR (s.results <> r.results AND EXISTS (SELECT 1 FROM"
               " json_each(s.results) a JOIN json_each(r.results) b ON a.key = b.key"
               " WHERE a.value IS NOT b.value))) LIMIT 1"));
    return *text ? rp_fail(RP_BAD_INPUT, "%s: a different result than in the stores before it, for %s",
                           s->path, text)
                 : RP_OK;
}

/* Add the rows of the attached store, which messages name; a result replaces a machine's word. */
static rp_status take_source(sweep_store *s, const sweep_plan *plan)
{
    char model[128];
    bool empty;
    RP_TRY(check_format(s, "source", &empty));
    if (empty) return RP_OK;
    RP_TRY(ask(s, model, sizeof model, "SELECT value FROM source.sweep WHERE name = 'model'"));
    if (strcmp(model, plan->model) != 0)
        return rp_fail(RP_BAD_INPUT,
                       "%s: made with a different model of the physics (%s), not with this one (%s)", s->path,
                       model, plan->model);
    RP_TRY(find_conflict(s));
    return run_sql(s, "DELETE FROM temp.runs WHERE status IN " RP_MACHINE_STATUS
                      " AND key IN (SELECT key FROM source.runs WHERE status NOT IN " RP_MACHINE_STATUS ");"
                      "INSERT INTO temp.runs SELECT " COLUMNS " FROM source.runs WHERE true" UNITES);
}

rp_status sweep_store_unite(sweep_store *s, const sweep_plan *plan, size_t n, char *const paths[])
{
    RP_TRY(run_sql(s, "CREATE TEMP TABLE runs AS SELECT " COLUMNS " FROM main.runs;"
                      "CREATE UNIQUE INDEX temp.by_key ON runs (key)"));
    for (size_t i = 0; i < n; i++) {
        sweep_store source = {.db = s->db};
        snprintf(source.path, sizeof source.path, "%s", paths[i]);
        RP_TRY(run_sql(&source, "ATTACH '%q%q' AS source", LITERAL(paths[i])));
        RP_TRY(take_source(&source, plan));
        RP_TRY(run_sql(&source, "DETACH source"));
    }
    return RP_OK;
}

rp_status sweep_store_part(sweep_store *s)
{
    return run_sql(s, "DROP TABLE temp.runs");
}

rp_status sweep_store_merge(sweep_store *s, const sweep_plan *plan, size_t n, char *const paths[])
{
    RP_TRY(sweep_store_unite(s, plan, n, paths));
    RP_TRY(run_sql(s,
                   "BEGIN IMMEDIATE; DELETE FROM main.runs WHERE status IN " RP_MACHINE_STATUS ";"
                   "INSERT INTO main.runs SELECT " COLUMNS " FROM temp.runs WHERE true" UNITES "; COMMIT"));
    return sweep_store_part(s);
}
