/* The result of a run: files that grow in DIR.part, beside a snapshot from which the same command goes on. */
#ifndef CLI_RESULT_H
#define CLI_RESULT_H

#include "core/folder.h"

enum { CLI_SNAPSHOT = 60 }; /* processor time between two snapshots, s */

/* Begin a result, empty unless *snapshot, the path of the snapshot, is there. Errors: those of
 * rp_folder_begin. */
rp_status cli_result_begin(rp_arena *arena, const char *directory, const char *holds, bool force,
                           rp_folder *folder, const char **snapshot);

/* The end of a run with the status `run`, which is returned: files of a good one become the result. */
rp_status cli_result_end(rp_folder *folder, rp_status run);

/* SIGINT, SIGTERM and SIGHUP set *stop; a second one ends the process. */
void cli_on_stop(volatile bool *stop);

#endif
