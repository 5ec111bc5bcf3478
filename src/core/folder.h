/* Folders of results. A result grows in DIR.part and gets its name when it is whole. DIR/.repose then says
 * what it is, and lists its files. Such a folder is replaced by force alone, and only where that list has all
 * that is in it. No link is followed. */
#ifndef RP_FOLDER_H
#define RP_FOLDER_H

#include <stdbool.h>
#include <stddef.h>

#include "core/arena.h"

RP_C_BEGIN

/* A result in the making. */
typedef struct {
    const char *path, *part, *holds; /* DIR, DIR.part, what it is, in a line */
    const char *snapshot;            /* a file or folder of DIR.part from which the same command goes on */
    bool force;
    int lock; /* descriptor of DIR.part; 0: not begun, or published */
} rp_folder;

/* Begin a result, or go on with it: DIR.part is empty, or has the files and the snapshot of a process that
 * was stopped. rp_folder_end follows, also after an error. Errors: RP_BAD_INPUT (DIR is not free; DIR.part
 * has another result, with a snapshot and without `force`, or other files), RP_IO (also: another process is
 * at it), RP_NO_MEMORY. */
rp_status rp_folder_begin(rp_arena *arena, const char *path, const char *holds, bool force, rp_folder *f);

/* Has DIR.part no file but its marker? */
bool rp_folder_is_empty(const rp_folder *f);

/* DIR.part, whose files are whole and synced, becomes DIR, without the snapshot. Errors: those of
 * rp_folder_begin; DIR.part then stays, and gets its name when it is begun again. */
rp_status rp_folder_publish(rp_folder *f);

/* Close it. DIR.part goes if it is empty. */
void rp_folder_end(rp_folder *f);

/* Make a folder of files that are made anew each time, as tables of a sweep, unless it is there. Errors:
 * RP_BAD_INPUT (it is not empty, and no such folder; by `force`, of other such files), RP_IO, RP_NO_MEMORY.
 */
rp_status rp_folder_own(const char *path, const char *holds, bool force);

RP_C_END

#endif
