/* Snapshots of one run of a sweep, from which a later process continues with the same bits.
 *
 * A run enters the variables that its course depends on as it comes to them, outermost first, and leaves them
 * in the reverse order. A snapshot holds all that are entered. A process that resumes enters them in the same
 * order and gets their values, so that it comes to the place of the snapshot: loops start where they were,
 * and what a restored value says is done is not done again. Without a handle (NULL) nothing is kept. */
#ifndef SWEEP_KEEP_H
#define SWEEP_KEEP_H

#include <stdio.h>

#include "core/snapshot.h"
#include "dem/dem.h"

enum { SWEEP_KEEP_MOST = 32 };

typedef struct sweep_keep {
    const char *path, *key; /* file; of the run */
    double interval, next;  /* processor time, s: from one snapshot to the next; of the next */
    double looked;          /* at the clock, which costs as much as a step of a small pile: then that many */
    int pause, skipped;     /* looks are skipped, more where they follow each other within 10 ms */
    const volatile bool *stop; /* NULL, or of which true asks for a snapshot now, and for the run's end */
    rp_snapshot source; /* that is resumed from; its data have been used up once its run is at its place */
    size_t n;
    struct {
        void *data;
        size_t size;                           /* 0: a dem_sim *; SIZE_MAX: a FILE */
        void (*by)(rp_snapshot *, void *data); /* instead of all that */
    } entered[SWEEP_KEEP_MOST];
} sweep_keep;

/* Prepare for a run whose path, key, interval and stop are set: with `look`, read its snapshot if there is a
 * good one, else the run starts anew. `why` gets the reason why one was refused, or "". sweep_keep_end
 * follows; it removes the file if the run is done.
 */
void sweep_keep_begin(sweep_keep *k, bool look, char *why, size_t size);
void sweep_keep_end(sweep_keep *k, bool done);

/* Remove the snapshot of a run, and one that was being written. */
/* Is this the name of a snapshot, or of one in the making? */
bool sweep_keep_is_name(const char *name);

void sweep_keep_remove(const char *path);

/* Whether there are variables yet to be entered before the run is at the place of its snapshot. */
bool sweep_keep_resumes(const sweep_keep *k);

/* Enter a variable, or a simulation, which may be NULL. True if its value is the caller's, false if it is now
 * that of the snapshot. Leave the last n. */
bool sweep_keep_enter(sweep_keep *k, void *data, size_t size);
bool sweep_keep_enter_sim(sweep_keep *k, dem_sim **sim);

/* Enter a table in the making, of rp_file_open: its text so far is that of the snapshot. */
bool sweep_keep_enter_file(sweep_keep *k, FILE *file);

/* Enter what a function writes and reads. */
bool sweep_keep_enter_by(sweep_keep *k, void (*by)(rp_snapshot *s, void *data), void *data);
void sweep_keep_leave(sweep_keep *k, size_t n);
#define SWEEP_ENTER(k, variable) sweep_keep_enter(k, &(variable), sizeof(variable))

/* Between two pieces of work: write a snapshot if one is due. Errors: RP_STOPPED (asked to stop; the snapshot
 * is written), those of rp_snapshot_write, and of the values that were to be restored. */
rp_status sweep_keep_look(sweep_keep *k);

#endif
