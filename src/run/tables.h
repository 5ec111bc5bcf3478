/* The tables of a run, for run.c. */
#ifndef RUN_TABLES_H
#define RUN_TABLES_H

#include "run/run.h"

/* Those that grow: open them, new or as a snapshot will say; their first lines, and the frame of the start.
 */
rp_status run_open_tables(run_driver *d, bool there);
rp_status run_begin_tables(run_driver *d, bool there);
void run_close_tables(run_driver *d);

/* How long they are, into a snapshot or as it says: what came later goes. */
rp_status run_keep_tables(run_driver *d, rp_snapshot *s);

/* Rows of the tables whose turn it is: at this step, at a stage's end, or, the last, of all. */
rp_status run_write_frames(run_driver *d, bool stage, bool last);

/* Tables of the phases that have ended since the last time; all that a run has besides, at its end. */
rp_status run_write_stages(run_driver *d);
rp_status run_write_end(run_driver *d);

#endif
