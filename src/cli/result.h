/* The result of a run: tables that grow in DIR.part, beside a snapshot from which the same command goes on.
 */
#ifndef CLI_RESULT_H
#define CLI_RESULT_H

#include <stdio.h>

#include "core/folder.h"
#include "core/snapshot.h"

enum { CLI_GROWING = 4, CLI_SNAPSHOT = 60 }; /* the latter: processor time between two snapshots, s */

/* Set by the caller: names of the tables, or NULL for a run that writes its own; what it keeps, by `keep`,
 * with its layout. */
typedef struct {
    const char *const *names; /* CLI_GROWING */
    void (*keep)(rp_snapshot *s, void *context);
    void *context;
    uint64_t layout;
    rp_folder folder;
    FILE *table[CLI_GROWING];
    double next; /* of the next snapshot, of rp_cpu_clock */
} cli_result;

/* Begin with empty tables, or, *resumed, with those of the snapshot. cli_result_free follows, also after an
 * error. Errors: those of rp_folder_begin; RP_BAD_INPUT (a snapshot or a table that does not fit). */
rp_status cli_result_begin(cli_result *r, rp_arena *arena, const char *directory, const char *holds,
                           bool force, bool *resumed);

/* Write a snapshot if one is due, or `now`. Errors: RP_IO; the one before is then still good. */
rp_status cli_result_keep(cli_result *r, bool now);

/* The end of a run with the status `run`, which is returned: tables of a good one become the result. */
rp_status cli_result_end(cli_result *r, rp_status run);
void cli_result_free(cli_result *r);

/* SIGINT, SIGTERM and SIGHUP set *stop; a second one ends the process. */
void cli_on_stop(volatile bool *stop);

#endif
