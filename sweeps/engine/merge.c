/* Several stores as one: shards, and stores from elsewhere; the rows of a damaged store. */
#include "sweeps/engine/private.h"

#include <stdlib.h>
#include <string.h>
#include <time.h>

/* The attached store belongs to the plan's protocol and model, and has its columns. */
static rp_status check_source(sweep_store *s, const sweep_plan *plan, const char *path)
{
    char owner[64], model[128];
    long long format;
    RP_TRY(rp_prefix(sweep_sql_number(s, "PRAGMA source.user_version", &format), "%s: ", path));
    if (format != SWEEP_FORMAT)
        return rp_fail(RP_BAD_INPUT, "%s: format %lld, not %d", path, format, SWEEP_FORMAT);
    RP_TRY(rp_prefix(sweep_store_note(s, "source", "protocol", owner, sizeof owner), "%s: ", path));
    RP_TRY(rp_prefix(sweep_store_note(s, "source", "model", model, sizeof model), "%s: ", path));
    if (strcmp(owner, plan->protocol->name) != 0)
        return rp_fail(RP_BAD_INPUT, "%s: holds runs of protocol \"%s\", not \"%s\"", path, owner,
                       plan->protocol->name);
    if (strcmp(model, plan->model) != 0)
        return rp_fail(RP_BAD_INPUT, "%s: made by another model of the physics (%s), not by this one (%s)",
                       path, model, plan->model);
    return sweep_store_check_outputs(s, "source", path, plan->protocol);
}

/* Two results under one key differ: one of the machines is wrong, and nothing says which. */
static rp_status find_conflict(sweep_store *s, const sweep_plan *plan, const char *path)
{
    sqlite3_str *sql = sqlite3_str_new(s->db);
    sqlite3_str_appendall(
        sql, "SELECT s.key, s.parameters, s.pile FROM source.runs s JOIN temp.runs r USING (key) "
             "WHERE s.status NOT IN " RP_MACHINE_STATUS " AND r.status NOT IN " RP_MACHINE_STATUS
             " AND (s.status IS NOT r.status");
    for (const sweep_output *o = plan->protocol->outputs; o->name; o++)
        if (sweep_store_has(s, "source", o->name)) /* one that a row lacks is no other result */
            sqlite3_str_appendf(
                sql, " OR (s.\"%w\" IS NOT r.\"%w\" AND 'text' NOT IN (typeof(s.\"%w\"), typeof(r.\"%w\")))",
                o->name, o->name, o->name, o->name);
    sqlite3_str_appendall(sql, ") LIMIT 1");
    sqlite3_stmt *q = sweep_sql_query_text(s, sql);
    rp_status status = RP_OK;
    if (sqlite3_step(q) == SQLITE_ROW)
        status =
            rp_fail(RP_BAD_INPUT,
                    "%s: another result than in the stores before it, for %s, pile %lld (key %s); "
                    "nothing is merged",
                    path, sqlite3_column_text(q, 1), sqlite3_column_int64(q, 2), sqlite3_column_text(q, 0));
    rp_status read = sweep_sql_finish(s, "compare the stores", q);
    return status ? status : read;
}

/* Copy rows, `which` of them, from one schema to another that lacks their keys. */
static rp_status copy_rows(sweep_store *s, const sweep_plan *plan, const char *from, const char *into,
                           const char *which)
{
    sqlite3_str *sql = sqlite3_str_new(s->db);
    sqlite3_str_appendf(sql, "INSERT OR IGNORE INTO %s.runs (", into);
    sweep_store_columns(NULL, NULL, sql, plan->protocol);
    sqlite3_str_appendall(sql, ") SELECT ");
    sweep_store_columns(s, from, sql, plan->protocol);
    sqlite3_str_appendf(sql, " FROM %s.runs%s", from, which);
    return sweep_sql_text(s, "unite the stores", sql);
}

/* Append the rows of source.runs, or main.runs, to temp.runs; a result replaces a machine's word. */
static rp_status take_rows(sweep_store *s, const sweep_plan *plan, const char *schema)
{
    RP_TRY(sweep_sql(s, "unite the stores",
                     "DELETE FROM temp.runs WHERE status IN " RP_MACHINE_STATUS
                     " AND key IN (SELECT key FROM %s.runs WHERE status NOT IN " RP_MACHINE_STATUS ")",
                     schema));
    return copy_rows(s, plan, schema, "temp", "");
}

rp_status sweep_store_running(sweep_store *s, const char *schema, size_t *running)
{
    char beat[32]; /* a sign of life, given every ten seconds */
    RP_TRY(sweep_store_note(s, schema, "beat", beat, sizeof beat));
    *running += *beat && labs((long)time(NULL) - strtol(beat, NULL, 10)) < 60;
    return RP_OK;
}

static rp_status take_source(sweep_store *s, const sweep_plan *plan, const char *path, bool verify,
                             bool *same, sweep_merged *found)
{
    char hash[33];
    long long before, rows, after;
    RP_TRY(check_source(s, plan, path));
    if (verify) RP_TRY(sweep_store_verify(s, "source", path));
    RP_TRY(sweep_store_check_rows(s, "source", path, plan));
    RP_TRY(sweep_store_note(s, "source", "plan", hash, sizeof hash));
    RP_TRY(sweep_store_running(s, "source", &found->running));
    RP_TRY(find_conflict(s, plan, path));
    RP_TRY(sweep_sql_number(s, "SELECT count(*) FROM temp.runs", &before));
    RP_TRY(sweep_sql_number(s, "SELECT count(*) FROM source.runs", &rows));
    if (strcmp(hash, plan->hash) != 0) {
        *same = false; /* numbers of another plan may meet those of this one */
        RP_TRY(sweep_sql(s, "unite the stores", "DROP INDEX IF EXISTS temp.by_run"));
    }
    RP_TRY(take_rows(s, plan, "source"));
    RP_TRY(sweep_sql_number(s, "SELECT count(*) FROM temp.runs", &after));
    found->stores++;
    found->duplicates += (size_t)(before + rows - after);
    return RP_OK;
}

rp_status sweep_store_unite(sweep_store *s, const sweep_plan *plan, size_t n, char *const paths[],
                            bool verify, sweep_merged *found)
{
    bool same = true;
    long long foreign = 0;
    *found = (sweep_merged){0};
    RP_TRY(sweep_store_running(s, "main", &found->running));
    RP_TRY(sweep_store_make_runs(s, "temp", plan->protocol));
    RP_TRY(take_rows(s, plan, "main"));
    for (size_t i = 0; i < n; i++) {
        char *uri = sweep_store_uri(paths[i], true);
        const rp_status attached = sweep_sql(s, "open a store", "ATTACH %Q AS source", uri);
        sqlite3_free(uri);
        RP_TRY(rp_prefix(attached, "%s: ", paths[i]));
        const rp_status status = take_source(s, plan, paths[i], verify, &same, found),
                        detached = sweep_sql(s, "close a store", "DETACH source");
        RP_TRY(status ? status : detached);
    }
    if (!same) RP_TRY(sweep_store_number(s, plan, NULL));
    RP_TRY(sweep_store_make_runs(s, "temp", plan->protocol)); /* its index, unless it is there */
    RP_TRY(sweep_sql_number(s, "SELECT count(*) FROM temp.runs WHERE run IS NULL", &foreign));
    found->foreign = (size_t)foreign;
    return RP_OK;
}

rp_status sweep_store_merge(sweep_store *s, const sweep_plan *plan, size_t n, char *const paths[],
                            sweep_merged *found)
{
    long long before, after;
    RP_TRY(sweep_store_unite(s, plan, n, paths, true, found));
    RP_TRY(sweep_sql_number(s, "SELECT count(*) FROM main.runs WHERE run IS NOT NULL", &before));
    RP_TRY(sweep_sql(s, "merge the stores", "BEGIN IMMEDIATE"));
    RP_TRY(sweep_store_drop_crashed(s));
    RP_TRY(copy_rows(s, plan, "temp", "main", " WHERE run IS NOT NULL"));
    RP_TRY(sweep_sql(s, "merge the stores", "COMMIT"));
    RP_TRY(sweep_sql_number(s, "SELECT count(*) FROM main.runs WHERE run IS NOT NULL", &after));
    found->taken = (size_t)(after - before);
    return RP_OK;
}

/* Copy the whole rows of a damaged store, one by one; those of damaged pages fail by themselves. */
static rp_status copy_whole_rows(sweep_store *s, const sweep_plan *plan, sweep_store *damaged, size_t *n)
{
    enum {
        MOST_IN_A_ROW = 20000
    }; /* numbers without a row: the end. A lost inner page holds some 4000 rows */
    sqlite3_str *select = sqlite3_str_new(s->db);
    sqlite3_str_appendall(select, "SELECT ");
    sweep_store_columns(damaged, "main", select, plan->protocol);
    sqlite3_str_appendall(select, " FROM runs WHERE rowid = ?");
    sqlite3_stmt *from = sweep_sql_query_text(damaged, select),
                 *into = sweep_store_query_insert(s, plan->protocol);
    const int read = sqlite3_errcode(damaged->db) & 0xff; /* no table left: no row */
    const bool lost = read == SQLITE_CORRUPT || read == SQLITE_NOTADB || read == SQLITE_ERROR;
    rp_status status = into && (from || lost) ? RP_OK : sweep_sql_fail(into ? damaged : s, "read the rows");
    *n = 0;
    for (sqlite3_int64 id = 1, last = 0; from && !status && id - last < MOST_IN_A_ROW; id++) {
        sqlite3_bind_int64(from, 1, id);
        if (sqlite3_step(from) == SQLITE_ROW && sweep_store_row_is_whole(from, plan->protocol)) {
            for (int c = 0; c < sqlite3_column_count(from); c++)
                sqlite3_bind_value(into, c + 1, sqlite3_column_value(from, c));
            sqlite3_bind_null(into, 2); /* its number comes from the plan */
            const int stored = sqlite3_step(into);
            *n += stored == SQLITE_DONE;
            if (stored != SQLITE_DONE && stored != SQLITE_CONSTRAINT)
                status = sweep_sql_fail(s, "write the store");
            sqlite3_reset(into);
            last = id;
        }
        sqlite3_reset(from);
    }
    sqlite3_finalize(from);
    sqlite3_finalize(into);
    return status;
}

static void close_damaged(sweep_store *damaged)
{
    sqlite3_close(damaged->db);
}

rp_status sweep_store_salvage(sweep_store *s, const sweep_plan *plan, const char *path, size_t *n)
{
    RP_ENDS(close_damaged) sweep_store damaged = {0};
    snprintf(damaged.path, sizeof damaged.path, "%s", path);
    if (sqlite3_open_v2(path, &damaged.db, SQLITE_OPEN_READWRITE, NULL) != SQLITE_OK)
        return sweep_sql_fail(&damaged, "open the damaged store");
    /* so told, SQLite reads a file that is shorter than its header says */
    sqlite3_exec(damaged.db, "PRAGMA writable_schema = ON", NULL, NULL, NULL);
    RP_TRY(sweep_sql(s, "write the store", "BEGIN IMMEDIATE"));
    RP_TRY(copy_whole_rows(s, plan, &damaged, n));
    RP_TRY(sweep_store_number(s, plan, NULL));
    return sweep_sql(s, "write the store", "COMMIT");
}
