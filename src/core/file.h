/* Files read whole and written whole, and folders. */
#ifndef RP_FILE_H
#define RP_FILE_H

#include <stdbool.h>
#include <stdio.h>

#include "core/arena.h"

RP_C_BEGIN

/* Flush and report any error of writing; `name` is for the message. Errors: RP_IO. */
rp_status rp_file_finish(FILE *out, const char *name);

/* The same, and its bytes are on the disk. */
rp_status rp_file_sync(FILE *out, const char *name);

/* Open `path` for writing under a temporary name, in place of what a killed process left there; rp_file_close
 * renames the complete file once it is on the disk, or removes it if `keep` is not RP_OK. "-" is standard
 * output. Errors: RP_IO (also: another process writes it), RP_BAD_INPUT (too long; a file or a link is there,
 * which is not to be replaced). */
rp_status rp_file_open(const char *path, bool replace, FILE **out);
rp_status rp_file_close(const char *path, FILE *out, rp_status keep);

/* Close a file, and before it the one beside it, which has its name only if this one is whole. */
rp_status rp_file_close_both(const char *path, FILE *out, const char *beside, FILE *other);

/* Is this such a temporary name? Before `path` is opened: has a process that was killed left its part? It may
 * have named the file beside it. */
bool rp_file_is_temporary(const char *name);
bool rp_file_was_begun(const char *path);

/* Is something there, or may it be? Only "no such file" is a no: what else is wrong shows when it is opened.
 */
bool rp_is_there(const char *path);

/* Write the folder of a file to the disk, so that a new name in it survives a power cut. */
bool rp_file_sync_folder(const char *path);

/* The whole text of a file ("-": standard input); free it, also after an error.
 * Errors: RP_BAD_INPUT (cannot be read, more than 1 GB, a byte 0), RP_NO_MEMORY. */
rp_status rp_file_read(const char *path, char **text);

/* A file that the program brings along, as "sweeps/lh/lh3.cfg", by this name in the current folder; else in
 * the data folder. That is the one REPOSE_DATA names; where it is not set, ../share/repose next to the
 * program, or the source that the program was built in. The name itself where there is no such file. */
const char *rp_data(rp_arena *arena, const char *name);

/* Does a text, as a file's name, end in these letters? */
bool rp_ends_in(const char *text, const char *end);

/* The same for a name in a folder. */
bool rp_is_in(const char *folder, const char *name);

/* Paths; zero is an empty list. Add FOLDER/NAME (folder NULL: the name alone), or what is in a folder and
 * `wanted` by its name, in the order of the names, nothing where there is no such folder. Names are literal.
 * Errors: RP_NO_MEMORY, RP_IO. */
typedef struct {
    size_t n;
    char **path;
} rp_paths;
rp_status rp_paths_add(rp_paths *paths, const char *folder, const char *name);
rp_status rp_paths_in(rp_paths *paths, const char *folder, bool (*wanted)(const char *name));
void rp_paths_free(rp_paths *paths);

/* Make a directory and its parents. Errors: RP_IO. */
rp_status rp_make_directory(const char *path);

RP_C_END

#endif
