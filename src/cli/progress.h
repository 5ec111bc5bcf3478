/* The progress of a run, of a sweep, and of its preparation. */
#ifndef CLI_PROGRESS_H
#define CLI_PROGRESS_H

#include <stdbool.h>
#include <stdio.h>

#include "sweeps/engine/sweep.h"

/* Progress on standard error: a bar with the time left on a terminal, else a line a minute. Times are in
 * seconds, of any clock. */
typedef struct {
    bool quiet, terminal, drawn;
    double started, next;
    long from, to;
} cli_progress;
cli_progress cli_progress_start(bool quiet, bool terminal, double now, long from, long to);
void cli_progress_show(cli_progress *p, double now, long step, FILE *out);

/* The same of a run whose length is not known: where it is; NULL: it has ended. */
void cli_progress_tell(cli_progress *p, double now, const char *where, FILE *out);

/* That of planning a sweep. */
void cli_progress_planning(void *progress, size_t checked, size_t points);

/* That of a sweep, in its own time, and a line for each run that fails. */
void cli_sweep_progress(sweep_options *options, bool quiet, cli_progress *p);

#endif
