/* The folder DIR/unfinished of a run: its tables, and with snapshots the one from which it resumes. A
 * finished result in DIR stays until the new one is whole, and takes its place; see core/folder.h. DIR never
 * holds tables of two results. */
#ifndef UNFINISHED_H
#define UNFINISHED_H

#include <stdio.h>

#include "core/arena.h"
#include "core/folder.h"
#include "core/snapshot.h"

enum { CLI_GROWING = 4 };

/* A table, and the XXH3-128 of its first bytes. */
typedef struct {
    const char *name;
    FILE *file;
    struct XXH3_state_s *hash;
    long hashed;
} cli_growing;

/* Set by the caller: an arena for paths, the folder DIR, what it then holds, whether it may replace a
 * finished result, the layout of what the caller keeps, and the names of the tables; without names the folder
 * is for a run that writes its own, and may resume from a snapshot there. */
typedef struct {
    rp_arena *arena;
    const char *directory, *holds;
    bool force, resumes;
    uint64_t layout;
    const char *const *names; /* CLI_GROWING, or NULL */
    bool entered;             /* this process is at it */
    cli_growing table[CLI_GROWING];
    rp_folder folder, stage;
} cli_unfinished;

/* The caller's part of a snapshot. */
typedef void cli_keep(rp_snapshot *s, void *context);

/* Make the folder, with empty tables; one that `resumes` stays as it is if it holds a snapshot.
 * cli_unfinished_end follows, and cli_unfinished_free also after an error. Errors: RP_BAD_INPUT (it holds a
 * run that can be resumed, a finished result, or files that are not ours), RP_IO (also: another process is at
 * it), RP_NO_MEMORY. */
rp_status cli_unfinished_start(cli_unfinished *u);

/* The same with the tables as they were at the snapshot, after the caller's part has been read. *done: the
 * run was whole, its result is now in DIR, which `holds` names, and nothing is left to do. Errors: also
 * RP_BAD_INPUT for a snapshot or a table that does not fit. */
rp_status cli_unfinished_resume(cli_unfinished *u, cli_keep *keep, void *context, bool *done);

/* Write a snapshot. Errors: RP_IO; the older one and its tables are then still good. */
rp_status cli_unfinished_write(cli_unfinished *u, cli_keep *keep, void *context);

/* The end of a run, which returns its status `run`. The tables of a whole one move into DIR, instead of what
 * is there. Those of another one stay; unless it is resumable, they say that they are unfinished, and the
 * message where they are. Nothing is done for a folder that was not entered. Errors: RP_IO. */
rp_status cli_unfinished_end(cli_unfinished *u, bool resumable, rp_status run);
void cli_unfinished_free(cli_unfinished *u);

/* SIGINT, SIGTERM and SIGHUP call `handler`, or set *stop; a second one, or ten seconds, then end this
 * process with RP_STOPPED and a message that names the folder. */
void cli_on_stop(void (*handler)(int));
void cli_unfinished_stops(const char *directory, volatile bool *stop);

#endif
