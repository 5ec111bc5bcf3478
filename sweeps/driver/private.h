/* What the files of the sweep driver share: the plan, the store, the pool. See sweep.h. */
#ifndef SWEEP_PRIVATE_H
#define SWEEP_PRIVATE_H

#include <libconfig.h>

#include "sweeps/driver/sweep.h"

/* A sweep file, expanded. Run r has grid point r / replicas and replica r % replicas. */
typedef struct {
    const sweep_protocol *protocol;
    unsigned long seed;
    bool shared_piles;
    size_t replicas, n_points, n_runs, n_axes;
    size_t block;          /* replicas as the file says */
    const rp_param **axes; /* the parameters under `grid`, in the order of the file */
    char *points;          /* n_points structures of protocol->params_size bytes */
    char (*keys)[33];      /* of the runs */
    char *text;            /* of the file */
    config_t config;       /* owns the texts among the parameters */
} sweep_plan;

/* One finished run. */
typedef struct {
    size_t run;
    rp_status status; /* what the protocol returned; its message is in result.message */
    double seconds;
    sweep_result result;
} sweep_row;

typedef struct sweep_store sweep_store;

/* Read and check a sweep file. Afterwards sweep_plan_free, also after an error. */
rp_status sweep_plan_read(const char *file, const sweep_protocol *const *protocols, sweep_plan *plan);
void sweep_plan_free(sweep_plan *plan);

/* Another number of replicas than the file's. Those that both numbers have keep their piles and keys.
 * Errors: RP_BAD_INPUT, RP_NO_MEMORY. */
rp_status sweep_plan_replicate(sweep_plan *plan, size_t replicas);

/* Parameters of a grid point. */
const void *sweep_plan_point(const sweep_plan *plan, size_t point);

/* Number of the random streams of a run. */
unsigned long sweep_plan_pile(const sweep_plan *plan, size_t run);

/* "mu = 0.2, W = 4" of a grid point; returns `buffer`. */
const char *sweep_plan_describe(const sweep_plan *plan, size_t point, char *buffer, size_t size);

/* Open a folder's store: to read it as it is now, whoever writes; to write; to write, made if there is none.
 * Afterwards sweep_store_close, also after an error. All functions of the store fail with RP_IO, and what is
 * committed stays. */
typedef enum { SWEEP_STORE_READ, SWEEP_STORE_WRITE, SWEEP_STORE_CREATE } sweep_store_mode;
rp_status sweep_store_open(const char *dir, sweep_store_mode mode, sweep_store **store);
void sweep_store_close(sweep_store *store);

/* Replace the plan, keeping all rows. `file` is noted as its origin.
 * Errors: RP_BAD_INPUT if the store belongs to another protocol. */
rp_status sweep_store_write_plan(sweep_store *store, const sweep_plan *plan, const char *file);

/* Errors: RP_BAD_INPUT if the stored plan is not `plan`. */
rp_status sweep_store_check_plan(sweep_store *store, const sweep_plan *plan);

/* A value of the stored plan by its name: "file", the sweep file as it was given, or "replicas". Empty where
 * there is none. */
rp_status sweep_store_note(sweep_store *store, const char *name, char *buffer, size_t size);

/* Show the programs that made the planned runs, and how many each. */
rp_status sweep_store_makers(sweep_store *store,
                             void (*visit)(const char *program, size_t runs, void *context), void *context);

/* Numbers of the planned runs that are not stored, in order; free *missing. Aborted runs are forgotten. */
rp_status sweep_store_missing(sweep_store *store, const sweep_plan *plan, size_t **missing, size_t *n);

rp_status sweep_store_insert(sweep_store *store, const sweep_plan *plan, const sweep_row *row);

rp_status sweep_store_count(sweep_store *store, const sweep_plan *plan, sweep_counts *counts);

/* Call `visit` for each stored row of the plan, in the order of the plan, until one fails. */
rp_status sweep_store_visit(sweep_store *store, const sweep_plan *plan,
                            rp_status (*visit)(const sweep_row *row, void *context), void *context);

/* Make the runs todo[0..n) and store them; `todo` is left in another order. `lock` is the lock file, in
 * which drives that failed are counted, `counts` what was stored before. */
rp_status sweep_pool_run(const sweep_plan *plan, sweep_store *store, size_t *todo, size_t n, int lock,
                         const sweep_options *options, const sweep_counts *counts);

/* A sweep's folder, opened for reading or, under its lock, for writing. */
typedef struct {
    sweep_plan plan;
    sweep_store *store;
    int lock; /* descriptor, or -1 */
} sweep_folder;

/* Read the plan of a sweep's folder and open its store. Afterwards sweep_folder_close, also after an error.
 */
rp_status sweep_folder_open(const char *dir, const sweep_protocol *const *protocols, bool write,
                            sweep_folder *folder);
void sweep_folder_close(sweep_folder *folder);

/* Is this the status of a run that the machine ended, or a limit? It has no outcome, and the next drive tries
 * it again. Errors of sweep_check_aborted: RP_NO_RESULT while there is such a run. */
#define SWEEP_ABORTED "'crashed', 'no_memory', 'time_limit'"
bool sweep_is_aborted(const char *status);
rp_status sweep_check_aborted(const sweep_counts *counts);

#endif
