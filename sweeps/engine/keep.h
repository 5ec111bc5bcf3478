/* Snapshots of one run of a sweep, from which a later process continues with the same bits. A snapshot holds
 * what one function writes, and reads again. Without a handle (NULL) nothing is kept. */
#ifndef SWEEP_KEEP_H
#define SWEEP_KEEP_H

#include <stdio.h>

#include "core/snapshot.h"
#include "dem/dem.h"

typedef struct sweep_keep {
    const char *path, *key; /* file; of the run */
    double interval, next;  /* processor time, s: from one snapshot to the next; of the next */
    double looked;          /* at the clock, which costs as much as a step of a small pile: then that many */
    int pause, skipped;     /* looks are skipped, more where they follow each other within 10 ms */
    const volatile bool *stop; /* NULL, or of which true asks for a snapshot now, and for the run's end */
    rp_snapshot source;        /* that is resumed from */
    void (*by)(rp_snapshot *, void *data);
    void *data;
} sweep_keep;

/* Prepare for a run whose path, key, interval and stop are set: read its snapshot if there is a good one,
 * else the run starts anew. `why` gets the reason why one was refused, or "". sweep_keep_end follows; it
 * removes the file if the run is done. */
void sweep_keep_begin(sweep_keep *k, char *why, size_t size);
void sweep_keep_end(sweep_keep *k, bool done);

/* Is this the name of a snapshot, or of one in the making? */
bool sweep_keep_is_name(const char *name);

/* Remove the snapshot of a run, and one that was being written. */
void sweep_keep_remove(const char *path);

/* What snapshots hold from now on, and is read if there is one to resume from. Errors: those of `by`. */
rp_status sweep_keep_resume(sweep_keep *k, void (*by)(rp_snapshot *, void *data), void *data);

/* A table in the making, of rp_file_open: the text so far. */
void sweep_keep_file(rp_snapshot *s, FILE *file);

/* Between two pieces of work: write a snapshot if one is due. Errors: RP_STOPPED (asked to stop; the snapshot
 * is written), those of rp_snapshot_write. */
rp_status sweep_keep_look(sweep_keep *k);

#endif
