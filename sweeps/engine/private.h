/* What the files of the sweep driver share: the plan, the store, the pool. See sweep.h. */
#ifndef SWEEP_PRIVATE_H
#define SWEEP_PRIVATE_H

#include <libconfig.h>
#include <sqlite3.h>

#include "core/arena.h"
#include "sweeps/engine/experiment.h"
#include "sweeps/engine/sweep.h"

/* One list of the grid. Lists of one bundle go together; the bundles make the product. */
typedef struct {
    const rp_param *param;
    const config_setting_t *list;
    size_t n, bundle;
    bool first; /* of its bundle */
} sweep_axis;

/* The grid point whose values a plan holds at the moment. */
typedef struct {
    size_t point;
    /* Sum over its parameters, which gives the streams; and what stands for them in keys: the same, but of a
     * text all that its numbers depend on. */
    XXH128_hash_t settings, hash;
    _Alignas(max_align_t) char values[];
} sweep_position;

/* A sweep file. Run r has grid point r / replicas and replica r % replicas. Points are made when they are
 * asked for: the memory does not grow with the number of runs. */
typedef struct {
    const sweep_protocol *protocol;
    unsigned long seed;
    bool shared_piles;
    size_t replicas, n_points, n_runs, n_axes;
    sweep_axis *axes; /* in the order of the file */
    sweep_position *at;
    XXH128_hash_t fixed_hash, points_hash;       /* sum over the parameters that no axis varies; of all */
    char model[128], hash[33], fixed_json[4096]; /* the last without its closing brace */
    char *text;      /* of the file; with an experiment it names the folder's copy */
    config_t config; /* owns the texts among the parameters */
} sweep_plan;

/* The random streams of a run; `pile` is one number that stands for them. */
typedef struct {
    unsigned long seed, run, pile;
} sweep_stream;

/* One finished run; what the store has besides follows from the plan. */
typedef struct {
    size_t run;
    rp_status status; /* what the protocol returned; its message is in result.message */
    double seconds;
    sweep_result result;
    char key[33];
    const char *program, *parameters;
    sqlite3_int64 seed, model, pile;
} sweep_row;

/* One SQLite file; see store.c. */
typedef struct {
    sqlite3 *db;
    sqlite3_stmt *insert;
    double committed, beaten;      /* rp_clock; 0: never */
    bool writes, pending;          /* rows that are not committed yet */
    char path[4096], skipped[256]; /* the latter: shards that no process has made yet */
    char program[256];             /* of new rows */
} sweep_store;

enum { SWEEP_FORMAT = 4 }; /* of a store */
typedef enum { SWEEP_READ, SWEEP_WRITE, SWEEP_CREATE } sweep_access;

/* Read a sweep file, and check each value by itself. Afterwards sweep_plan_free, also after an error. */
rp_status sweep_plan_read(const char *file, const sweep_protocol *const *protocols, sweep_plan *plan);
void sweep_plan_free(sweep_plan *plan);

/* Ask the protocol whether it can run a grid point. Errors: RP_BAD_INPUT. */
rp_status sweep_plan_check_point(const sweep_plan *plan, const char *file, size_t point);

/* Another number of replicas than the file's. Those that both numbers have keep their piles and keys.
 * Errors: RP_BAD_INPUT. */
rp_status sweep_plan_replicate(sweep_plan *plan, size_t replicas);

/* A parameter that `fixed` and `grid` may name, of the physics though the text has no let of it; NULL: none.
 */
const rp_param *sweep_plan_param(const sweep_plan *plan, const char *name);

/* Does the grid vary this parameter? */
bool sweep_plan_is_axis(const sweep_plan *plan, const rp_param *param);

/* Parameters of a grid point, until the next call with another. */
const void *sweep_plan_point(const sweep_plan *plan, size_t point);

/* Streams of a run: they depend on the seed, the values of its parameters and its replica, or, with shared
 * piles, on seed and replica alone; never on the place in the grid. */
sweep_stream sweep_plan_stream(const sweep_plan *plan, size_t run);

/* Make a run, as its protocol does. */
rp_status sweep_plan_run(const sweep_plan *plan, size_t run, const sweep_tables *tables,
                         sweep_result *result);

/* Key of a run: a hash of parameters, streams and model. And a hash without the model, whose bits may be the
 * same in another one. */
void sweep_plan_key(const sweep_plan *plan, size_t run, char key[33]);
void sweep_plan_setting(const sweep_plan *plan, size_t run, char digits[33]);

/* "mu = 0.2, W = 4" of a grid point; returns `buffer`. */
const char *sweep_plan_describe(const sweep_plan *plan, size_t point, char *buffer, size_t size);

/* "{"mu":0.2,"W":4}": what the file fixes and the grid's values. `size` is 8192 or more; returns `buffer`. */
const char *sweep_plan_parameters(const sweep_plan *plan, size_t point, char *buffer, size_t size);

/* Open a store: to read it; to write; to write, made if there is none. Afterwards sweep_store_close, also
 * after an error. All functions of the store fail with RP_IO, and what is committed stays. */
rp_status sweep_store_open(const char *path, sweep_access access, sweep_store **store);
void sweep_store_close(sweep_store *store);

/* SQLite's name of a store, in which every letter of the path is literal; sqlite3_free it. To read a store
 * where nothing can be written, and no writer has left a file, SQLite is told that it does not change. */
char *sweep_store_uri(const char *path, bool reads);

/* Has a process made a store of this file? A killed one may have left it empty, or a copy broken off. */
bool sweep_store_is_made(const char *path);

/* Is every page of this store ("main"), or of an attached one, sound? */
rp_status sweep_store_verify(sweep_store *store, const char *schema, const char *path);

/* Check each row of this store, or of an attached one, against its checksum and the key of its number. */
rp_status sweep_store_check_rows(sweep_store *store, const char *schema, const char *path,
                                 const sweep_plan *plan);

/* Replace the plan, keeping all rows; those of the plan before, unless NULL, that have what the runs of this
 * one measure are theirs too. `file` is noted as its origin.
 * Errors: RP_BAD_INPUT if the store belongs to another protocol. */
rp_status sweep_store_write_plan(sweep_store *store, const sweep_plan *plan, const sweep_plan *before,
                                 const char *file, sweep_watch *watch);

/* A note of this store ("main") or of an attached one, "" if it has none: protocol, file (name of the sweep
 * file as it was given), seed, replicas, model, plan, beat. Errors: RP_IO, also for a wrong checksum. */
rp_status sweep_store_note(sweep_store *store, const char *schema, const char *name, char *buffer,
                           size_t size);

/* Forget planned runs that the machine ended: they are made again. */
rp_status sweep_store_drop_crashed(sweep_store *store);

/* Set the bit of each planned run that is stored: bit r % 8 of done[r / 8]. */
rp_status sweep_store_mark(sweep_store *store, size_t n_runs, unsigned char *done);

/* Add a row. It is committed with others, at the latest in the second sweep_store_tick from now. */
rp_status sweep_store_insert(sweep_store *store, const sweep_plan *plan, const sweep_row *row);

/* To be called at least once a second while rows are written: commits them in groups, and notes that the
 * writer lives. */
rp_status sweep_store_tick(sweep_store *store);
rp_status sweep_store_commit(sweep_store *store);

rp_status sweep_store_count(sweep_store *store, const sweep_plan *plan, sweep_counts *counts);

/* Call `visit` for each stored row of the plan, in the order of the plan, until one fails. A row whose
 * checksum or key is wrong is an error. */
rp_status sweep_store_visit(sweep_store *store, const sweep_plan *plan,
                            rp_status (*visit)(const sweep_row *row, void *context), void *context);

/* Statements, for store.c, merge.c and reduce.c. A query that cannot be prepared is NULL: its first step
 * fails, and finish says why; the functions of a text free it; number is the first column of the first row;
 * columns are those of a row in the order in which it is bound and read, 'none' for an output that this
 * schema of the store, unless NULL, has none of. */
rp_status sweep_sql_fail(const sweep_store *store, const char *what);
rp_status sweep_sql(sweep_store *store, const char *what, const char *format, ...);
rp_status sweep_sql_text(sweep_store *store, const char *what, sqlite3_str *text);
sqlite3_stmt *sweep_sql_query(sweep_store *store, const char *format, ...);
sqlite3_stmt *sweep_sql_query_text(sweep_store *store, sqlite3_str *text);
rp_status sweep_sql_finish(sweep_store *store, const char *what, sqlite3_stmt *query);
rp_status sweep_sql_number(sweep_store *store, const char *sql, long long *number);
void sweep_store_columns(const sweep_store *store, const char *schema, sqlite3_str *sql,
                         const sweep_protocol *protocol);
sqlite3_stmt *sweep_store_query_insert(sweep_store *store, const sweep_protocol *protocol);
bool sweep_store_row_is_whole(sqlite3_stmt *row, const sweep_protocol *protocol);
rp_status sweep_store_make_runs(sweep_store *store, const char *schema, const sweep_protocol *protocol);

/* Has the table `runs` the column of this output? `schema` may be NULL, as in a query without one. */
bool sweep_store_has(const sweep_store *store, const char *schema, const char *output);

/* Refuse a store with outputs that the protocol has no more: its rows have sums with them.
 * Errors: RP_BAD_INPUT. */
rp_status sweep_store_check_outputs(sweep_store *store, const char *schema, const char *path,
                                    const sweep_protocol *protocol);

/* Give each row of the table `runs` its number in the plan. */
rp_status sweep_store_number(sweep_store *store, const sweep_plan *plan, sweep_watch *watch);

/* Count a store, of this schema, to which a process writes: with a sign of life in the last minute. */
rp_status sweep_store_running(sweep_store *store, const char *schema, size_t *running);

/* From now on the table `runs` of `store` is, for this process alone, its own rows with those of the stores
 * `paths`. With `verify` the files are read whole. Errors: RP_BAD_INPUT (another model or protocol; two
 * stores that differ in a result), RP_IO. */
rp_status sweep_store_unite(sweep_store *store, const sweep_plan *plan, size_t n, char *const paths[],
                            bool verify, sweep_merged *found);

/* Unite, and add to the store itself what the others have of the plan. */
rp_status sweep_store_merge(sweep_store *store, const sweep_plan *plan, size_t n, char *const paths[],
                            sweep_merged *found);

/* Copy the whole rows of a damaged store, and number them. *n is how many there are. Errors: RP_IO. */
rp_status sweep_store_salvage(sweep_store *store, const sweep_plan *plan, const char *damaged, size_t *n);

/* A sweep's folder, opened for reading or, under a lock, for writing. */
typedef struct {
    rp_arena memory;
    const char *dir, *cfg, *experiment, *sqlite, *snapshots, *shards; /* names */
    sweep_plan plan;
    sweep_store *store;
    sweep_merged found; /* of the shards */
    int lock;           /* descriptor, or -1 */
} sweep_folder;

/* Read the plan of a sweep's folder and open its store, with its shards as one. Afterwards
 * sweep_folder_close, also after an error. */
rp_status sweep_folder_read(const char *dir, const sweep_protocol *const *protocols, bool verify,
                            sweep_folder *folder);
void sweep_folder_close(sweep_folder *folder);

/* Make the runs todo[0..n), which is changed, and store them. `counts` is what was stored before; in the lock
 * file of the folder drives that failed are counted. */
rp_status sweep_pool_run(const sweep_folder *folder, size_t todo[], size_t n, const sweep_options *options,
                         const sweep_counts *counts);

#endif
