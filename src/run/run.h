/* One run, from its text to its end, with what it leaves on the way: tables, and snapshots from which another
 * process goes on with the same bits. `repose run`, each row of a sweep, and so each stage of a calibration
 * are this run, with other sinks. */
#ifndef RUN_RUN_H
#define RUN_RUN_H

#include "core/arena.h"
#include "experiment/experiment.h"

enum { RUN_SNAPSHOT = 60 }; /* processor time between two snapshots, s */
enum { RUN_STATES, RUN_ENERGY, RUN_CONTACTS, RUN_WALLS, RUN_TABLES };

/* What a run leaves and whom it tells; zero: nothing, nobody. */
typedef struct {
    /* Tables in a folder that is there: rows of a frame each so many steps (as dem_intervals), at the ends of
     * phases and of the run; or `stages`, as of a sweep's row: energies each so many steps, and tables of
     * each end of a phase by themselves. Without a folder `states` gets the frames of states. `header` writes
     * the first lines of each table. */
    const char *folder;
    bool stages;
    FILE *states;
    long every[RUN_TABLES];
    void (*header)(const void *of, rp_units units, FILE *out);
    const void *of;
    /* Snapshots: a file, each so many seconds of processor time and when *stop asks for the run's end; whose
     * they are, up to 39 bytes. */
    const char *snapshot, *owner;
    double interval;
    const volatile bool *stop;
    /* A host that looks on: steps from one to the next that it wants to see; each time the run has gone on;
     * before a frame of contacts, of the end of a phase or of the run; what a snapshot holds of its own. Each
     * may be NULL. */
    void *host;
    long (*next)(const void *host, long step);
    rp_status (*look)(void *host, const exp_run *run);
    void (*frame)(void *host, const exp_run *run);
    void (*keep)(rp_snapshot *s, void *host);
} run_sinks;

typedef struct {
    exp_plan *plan; /* borrowed */
    exp_run *run;
    unsigned long seed, stream;
    size_t threads; /* 1, or as set after the start */
    run_sinks to;
    FILE *table[RUN_TABLES];  /* NULL: none */
    long written[RUN_TABLES]; /* steps of the last frames: a phase may have none */
    long *passes;             /* of phases, whose tables are there */
    rp_arena memory;
    double next, work; /* processor time of the next snapshot; grains times steps since the clock was read */
} run_driver;

/* The key of a run with these streams, and of what it measures, but for the model. Errors: those of exp_key.
 */
rp_status run_key(const exp_plan *plan, unsigned long seed, unsigned long stream, char digits[33]);

/* Start a run with these streams, without sinks. run_free follows, also after an error. Errors: those of
 * exp_start. */
rp_status run_start(exp_plan *plan, unsigned long seed, unsigned long stream, run_driver *d);

/* Give it its sinks, once: new tables, or *resumed from the snapshot that is there, with tables as they were
 * then. Errors: RP_IO; RP_BAD_INPUT (a snapshot or a table that does not fit: the run is then of no use). */
rp_status run_open(run_driver *d, const run_sinks *to, bool *resumed);

/* Go on to the end, and leave the tables of the end. Errors: RP_STOPPED (asked to stop; a snapshot is there),
 * RP_IO, those of exp_advance. What the run ends with is no error. */
rp_status run_finish(run_driver *d);
rp_status run_sync(const run_driver *d); /* the tables that grew, to the disk */
void run_free(run_driver *d);

/* Its end, lets, phases and measures, a row each, as a table without its first lines. */
void run_write_measures(const run_driver *d, FILE *out);

/* Of a run without a snapshot any more: remove what is there of it. */
void run_forget(const char *snapshot);

#endif
