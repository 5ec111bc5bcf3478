/* Folders that the program makes, and which of the files there are its own. All else belongs to people.
 *
 * Such a folder has a marker, the file .repose: what the folder holds, and the names of the program's own
 * files, with the XXH3-128 of those that are finished. Only these are replaced or removed, and a finished
 * one only while it is what was written. No link is followed. A result grows in the folder "unfinished",
 * which has a marker of its own kind: whatever rp_file_open and rp_folder_make write there is its own. */
#ifndef RP_FOLDER_H
#define RP_FOLDER_H

#include <stdbool.h>
#include <stdio.h>

#include "core/status.h"

RP_C_BEGIN

/* What becomes of an own file: it stays; it is removed when the result takes its place; it comes from
 * "unfinished", as part of the result. */
enum { RP_OWN_STAYS = '=', RP_OWN_GOES = '-', RP_OWN_COMES = '+' };

typedef struct {
    char *name;
    char act, sum[33]; /* RP_OWN_..., checksum */
} rp_own;

typedef struct {
    char path[4096];    /* for messages */
    int file;           /* descriptor; 0: not open */
    bool marked, parts; /* it has a marker; one that rp_file_open adds to */
    char holds[2048];
    size_t n;
    rp_own *own;
} rp_folder;

/* Open a folder and read its marker; enter: lock it too. rp_folder_close follows, also after an error.
 * Errors: RP_IO (also: locked by another process), RP_BAD_INPUT (a file .repose that is no marker; entered:
 * the folder "unfinished" of a run), RP_NO_MEMORY. */
rp_status rp_folder_open(const char *path, rp_folder *f);
rp_status rp_folder_enter(const char *path, rp_folder *f);
void rp_folder_close(rp_folder *f);

/* Such an own file, whatever it holds, of which this becomes (0: anything), or NULL. List one. Write the
 * marker, on the disk when this returns. */
rp_own *rp_folder_find(const rp_folder *f, const char *name, char act);
rp_status rp_folder_list(rp_folder *f, const char *name, char act);
rp_status rp_folder_write(rp_folder *f);

/* Only a marker is in it. The start, end or signature of a file shows that the program wrote it. */
bool rp_folder_empty(const rp_folder *f);
bool rp_folder_shows(const rp_folder *f, const char *name);

/* Is a name free for a file of the program: nothing is there, or an own file as it was left? Errors:
 * RP_BAD_INPUT, with what to do. */
rp_status rp_folder_check(const rp_folder *f, const char *name);

/* Refuse a folder that holds a sweep or, unless `force`, a finished result, and one that holds what an older
 * version may have made. Errors: RP_BAD_INPUT, with what to do. */
rp_status rp_folder_vacant(const rp_folder *f, bool force);

/* The folder "unfinished" in f, made on demand; not open where it is not there. */
rp_status rp_folder_stage(rp_folder *f, bool make, rp_folder *stage);

/* Remove the own files of a folder, and its marker unless others are left; of a folder in f, and then the
 * empty folder. */
rp_status rp_folder_clear(rp_folder *f);
rp_status rp_folder_remove(const rp_folder *f, const char *name);

/* Open a file of this folder by the flags of open(2), none of another folder. */
rp_status rp_folder_file(const rp_folder *f, const char *name, int flags, FILE **file);

/* The synced files of "unfinished" become the result of f, and the older one goes, when its marker is
 * written. A process that is killed later leaves the rest to rp_folder_settle, with *moved. Until then f has
 * the older result. */
rp_status rp_folder_publish(rp_folder *f);
rp_status rp_folder_settle(rp_folder *f, bool *moved);

/* Make a folder with a marker, for files that rp_file_open writes; one that is there stays as it is. */
rp_status rp_folder_make(const char *path);

/* For rp_file_open: may it write this path, by this temporary name? Not over a file unless its marker lists
 * it, or rp_folder_shows; over a file of a result or a sweep only as its `owner`. Errors: RP_BAD_INPUT. */
rp_status rp_folder_admit(const char *path, const char *temporary, bool owner);

/* Is a file that the marker of its folder lists, with a checksum, still that one? Other files are not looked
 * at. Errors: RP_BAD_INPUT. */
rp_status rp_folder_fits(const char *path);

/* Sign a file of a format without a header, whole and flushed, by an attribute of it. Where the file system
 * has none, the program does not replace the file later. */
void rp_folder_sign(FILE *whole);

RP_C_END

#endif
