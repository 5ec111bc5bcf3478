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
    XXH128_hash_t settings; /* sum over its parameters, which gives the streams */
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
    XXH128_hash_t fixed_hash; /* sum over the parameters that no axis varies */
    XXH128_hash_t *hashes; /* of each point, what stands for its parameters in keys; 0: not asked for yet */
    char model[128], fixed_json[4096]; /* the latter without its closing brace */
    char *text;                        /* of the file */
    config_t config;                   /* owns the texts among the parameters */
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
    sweep_result result; /* of a stored row without its message */
    const char *program; /* that made it; of a stored row alone, while it is visited */
} sweep_row;

/* One SQLite file; see store.c. */
typedef struct {
    sqlite3 *db;
    sqlite3_stmt *insert, *find;
    double committed; /* rp_clock; 0: never */
    bool pending;     /* rows that are not committed yet */
    bool empty;       /* a file that has just been made, without tables */
    char path[4096];
} sweep_store;

/* Read a sweep file, and check each value by itself. Afterwards sweep_plan_free, also after an error. */
rp_status sweep_plan_read(const char *file, const sweep_protocol *const *protocols, sweep_plan *plan);
void sweep_plan_free(sweep_plan *plan);

/* Ask the protocol whether it can run a grid point. Errors: RP_BAD_INPUT. */
rp_status sweep_plan_check_point(const sweep_plan *plan, const char *file, size_t point);

/* Another number of replicas than the file's, in its text too. Those that both numbers have keep their piles
 * and keys. Errors: RP_BAD_INPUT. */
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

/* Open a store: to read it; to write, an empty one if there is none. Afterwards sweep_store_close, also after
 * an error. All functions of the store fail with RP_IO, and what is committed stays. */
rp_status sweep_store_open(const char *path, bool writes, sweep_store **store);
void sweep_store_close(sweep_store *store);

/* What a store says of itself: protocol, file, model; "" of what it does not say. Writing them makes an empty
 * store one. Errors: RP_BAD_INPUT if the store belongs to another protocol. */
rp_status sweep_store_note(sweep_store *store, const char *name, char *value, size_t size);
rp_status sweep_store_write_notes(sweep_store *store, const sweep_plan *plan, const char *file);

/* Forget runs that the machine ended: they are made again. */
rp_status sweep_store_drop_aborted(sweep_store *store);

/* Add a row. It is committed with others, by sweep_store_tick, which is to be called at least once a second.
 */
rp_status sweep_store_insert(sweep_store *store, const sweep_plan *plan, const sweep_row *row);
rp_status sweep_store_tick(sweep_store *store);
rp_status sweep_store_commit(sweep_store *store);

/* Call `visit` for each run of the plan that is stored, in order, until one fails; with the values of its
 * outputs only if they are wanted. */
rp_status sweep_store_visit(sweep_store *store, const sweep_plan *plan, bool values,
                            rp_status (*visit)(const sweep_row *row, void *context), void *context);
rp_status sweep_store_count(sweep_store *store, const sweep_plan *plan, sweep_counts *counts);

/* From now on the rows are those that this store has now, with those of the stores `paths`, for this process
 * alone and whoever writes; part: no longer. merge: keep them, all or none. Errors: RP_BAD_INPUT (another
 * model; another result of the same run), RP_IO. */
rp_status sweep_store_unite(sweep_store *store, const sweep_plan *plan, size_t n, char *const paths[]);
rp_status sweep_store_part(sweep_store *store);
rp_status sweep_store_merge(sweep_store *store, const sweep_plan *plan, size_t n, char *const paths[]);

/* A sweep's folder, opened for reading or, under a lock, for writing. */
typedef struct {
    rp_arena memory;
    const char *dir, *cfg, *experiment, *sqlite, *snapshots, *shards; /* names */
    sweep_plan plan;
    sweep_store *store;
    int lock; /* descriptor, or -1 */
} sweep_folder;

/* Read the plan of a sweep's folder and open its store, with its shards as one. Afterwards
 * sweep_folder_close, also after an error. */
rp_status sweep_folder_read(const char *dir, const sweep_protocol *const *protocols, sweep_folder *folder);
void sweep_folder_close(sweep_folder *folder);

/* Make the runs todo[0..n), which is changed, and store them. `counts` is what was stored before. */
rp_status sweep_pool_run(const sweep_folder *folder, size_t todo[], size_t n, const sweep_options *options,
                         const sweep_counts *counts);

#endif
