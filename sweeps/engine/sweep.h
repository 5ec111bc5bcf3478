/* The sweep driver: repeats one protocol over a grid of parameters, each grid point `replicas` times.
 *
 * A sweep lives in a folder: sweep.cfg (a copy of the sweep file) and store.sqlite (one row a
 * finished run). The runs follow from the file. The store is a dictionary: a row's key is a hash of
 * parameters, random streams and the model of the physics (rp_model), and what is stored under a key is never
 * computed again. A row stays valid when the protocol gets a further output, which it has no value of.
 *
 * Sweep file (libconfig): protocol, replicas, seed, zip, piles, fixed = { key = value; }, grid = { key = [
 * ... ]; }. The grid is the product of its lists, the last one fastest (with zip = true, lists of equal
 * length go together); or it is a list of groups, ( { ... }, { ... } ): the product of the groups, the lists
 * of one group going together. Replicas are innermost. Runs are numbered from 0. The number is that of the
 * run's random streams, or with piles = "shared" the replica's: then grid points start from the same grains,
 * and their differences can be taken pile by pile.
 *
 * More settings are for `repose sweep make`: study, the replicas of a larger ensemble, and derive, trace and
 * model, tables that are made of the runs, of single runs, and of models. A file without a protocol has
 * models alone.
 *
 * `protocols` is the list of those that a file may name, ended by NULL. Common errors: RP_BAD_INPUT (the
 * sweep file, or a plan that does not match it), RP_IO (folder or store; rows already stored are kept). */
#ifndef SWEEP_SWEEP_H
#define SWEEP_SWEEP_H

#include <libconfig.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

#include "sweeps/engine/protocol.h"
#include "table/columns.h"

RP_C_BEGIN

/* How far a sweep is. A result is a row whose status starts with "ok"; the others are failed. */
typedef struct {
    size_t points, replicas, planned, stored, failed;
    double seconds; /* of a run, on average; NaN without any */
    rp_tally words; /* by status, in alphabetical order */
} sweep_counts;

/* "no_pile 6, overlap 2": the words for which `wanted`. Returns `text`. */
const char *sweep_words(const rp_tally *words, bool (*wanted)(const char *status), char text[1024]);
bool sweep_is_failed(const char *status);

/* What a watcher is shown: after each row, and several times a second in between. */
typedef struct {
    size_t planned, stored, failed;
    double elapsed, left; /* s; `left` is NaN until a run has finished */
} sweep_progress;

typedef struct {
    int workers;                                                  /* processes, at least 1 */
    int shard, shards;                                            /* part 1 to n of n; 0, 0: whole */
    void (*watch)(const sweep_progress *progress, void *context); /* may be NULL */
    void *context;
    double memory, time; /* of one run: MB (1e6 bytes) and s; 0 or infinite: no limit */
    /* One line on a run that failed, when it does; may be NULL. */
    void (*report)(void *context, const char *format, ...) __attribute__((format(printf, 2, 3)));
    double snapshot; /* processor seconds from one snapshot of a run to the next, in DIR/snapshots; 0: none */
} sweep_options;

/* What `repose sweep make` reads of a sweep's file, beside the plan: settings derive, trace, model. */
typedef struct {
    char name[64]; /* the file's, without folder and ending */
    bool has_runs; /* false: models alone */
    size_t study;  /* replicas of the larger ensemble; 0: as many as else */
    config_t config;
} sweep_recipe;

/* Read a recipe. Afterwards sweep_recipe_free, also after an error. Errors: RP_BAD_INPUT. */
rp_status sweep_recipe_read(const char *file, sweep_recipe *recipe);
void sweep_recipe_free(sweep_recipe *recipe);

/* Check the sweep `file` and every one of its grid points, and make the folder `dir` or plan again in it.
 * `replicas` instead of the file's, unless 0: runs that both have are the same runs. Nothing is made unless
 * the whole file is good. Errors: RP_BAD_INPUT, RP_IO, RP_NO_MEMORY. */
rp_status sweep_prepare(const char *file, const char *dir, size_t replicas,
                        const sweep_protocol *const *protocols, sweep_counts *counts);

/* The same, with a look at the number of grid points after each that is checked. */
typedef void sweep_planning(void *context, size_t checked, size_t points);
rp_status sweep_prepare_seen(const char *file, const char *dir, size_t replicas,
                             const sweep_protocol *const *protocols, sweep_planning *look, void *context,
                             sweep_counts *counts);

/* Make the runs that are not stored yet, each in a worker process; one row is committed a finished run. A
 * run whose worker dies is tried three times. It is then a row with status "crashed", one beyond a
 * limit "no_memory" or "time_limit", with the cause in its message: RP_NO_RESULT, and the next call tries
 * these runs again. SIGINT, SIGTERM and SIGHUP stop the sweep: runs in progress have ten seconds to end or to
 * write a snapshot, a second signal ends them at once: RP_STOPPED. RP_OK when every row is stored
 * with an outcome, whatever it is. Errors: RP_BAD_INPUT, RP_IO (also: another process runs this sweep),
 * RP_NO_MEMORY, or a protocol's own. */
rp_status sweep_run(const char *dir, const sweep_protocol *const *protocols, const sweep_options *options,
                    sweep_counts *counts);

/* Take into the folder's store the rows of its shards or, if any are named, of other stores and folders.
 * Nothing is taken if two stores differ in a result, or if one is of another model.
 * Errors: RP_BAD_INPUT, RP_IO, RP_NO_MEMORY. */
rp_status sweep_merge(const char *dir, const sweep_protocol *const *protocols, size_t n, char *const paths[],
                      sweep_counts *counts);

/* Runs that the machine or a limit ended. Errors: RP_NO_RESULT while there is one. */
size_t sweep_count_aborted(const sweep_counts *counts);
rp_status sweep_check_aborted(const sweep_counts *counts);

/* Is every run of the sweep in `dir` stored with an outcome? Errors: RP_NO_RESULT (missing, aborted). */
rp_status sweep_check_whole(const char *dir, const sweep_counts *counts);

/* Count what is stored, in the folder's store and its shards. Errors: RP_BAD_INPUT, RP_IO, RP_NO_MEMORY. */
rp_status sweep_status(const char *dir, const sweep_protocol *const *protocols, sweep_counts *counts);

/* Name of the sweep file that the folder was planned by, as it was given; "" for a folder without a sweep.
 * Errors: RP_BAD_INPUT, RP_IO. */
rp_status sweep_source(const char *dir, char file[256]);

/* Write a table of what is stored: one row a run or, with SWEEP_POINTS, one row a grid point with mean,
 * standard deviation, standard error, 95 % interval (Student's t) and number of the finite values of each
 * output, over the rows with a result. With SWEEP_PARAMETERS the parameters that all runs share are columns
 * too, "-" for an empty one. `command` is for the header and may be NULL; so may `counts`, of the rows that
 * the table is made of. sweep_columns: its columns, before any run, of a sweep's file. sweep_has: may its
 * `fixed` and `grid` name this parameter?
 * Errors: RP_BAD_INPUT, RP_IO, RP_NO_MEMORY. */
enum { SWEEP_RUNS = 0, SWEEP_POINTS = 1, SWEEP_PARAMETERS = 2 };
rp_status sweep_export(const char *dir, const sweep_protocol *const *protocols, unsigned what,
                       const char *command, sweep_counts *counts, FILE *out);
rp_status sweep_columns(rp_arena *arena, const char *file, const sweep_protocol *const *protocols,
                        unsigned what, rp_table **table);
rp_status sweep_has(const char *file, const sweep_protocol *const *protocols, const char *name, bool *has);

/* XXH3-128 over parameters, streams, status and bits of the outputs of all rows in the order of the plan, as
 * 32 hexadecimal digits and NUL. Independent of workers, interruptions, times and host, and of the model
 * where that leaves the bits.
 * Errors: RP_NO_RESULT (rows are missing or aborted), RP_BAD_INPUT, RP_IO, RP_NO_MEMORY. */
rp_status sweep_digest(const char *dir, const sweep_protocol *const *protocols, char digest[33],
                       size_t *n_rows);

/* Run number `row` of a sweep `file`, to be made again; it lives in the arena. Errors: RP_BAD_INPUT (the
 * file, a row it does not have). */
typedef struct {
    const sweep_protocol *protocol;
    const void *params;
    unsigned long seed, stream;
} sweep_again;
rp_status sweep_read_again(const char *file, const sweep_protocol *const *protocols, size_t row,
                           rp_arena *arena, sweep_again *again);

RP_C_END

#endif
