/* Folders of results; see folder.h. The lines of the marker: HEAD; what the folder holds; the name of each
 * file of a whole result, which it lists before the snapshot goes, and the folder gets its name. */
#include "core/folder.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/file.h"

static const char HEAD[] = "repose result 1\n", MARKER[] = ".repose", SNAPSHOT[] = "snapshot";
enum { MOST_PATH = 4096 + 32 };

static rp_status failed(const char *path)
{
    return rp_fail(RP_IO, "%s: %s", path, strerror(errno));
}

static const char *in(const char *folder, const char *name, char path[MOST_PATH])
{
    snprintf(path, MOST_PATH, "%s/%s", folder, name);
    return path;
}

static bool is_any(const char *name)
{
    return *name != '\0';
}

static bool is_file(const char *name)
{
    return strcmp(name, MARKER) != 0;
}

static bool is_snapshot(const char *name)
{
    return strcmp(name, SNAPSHOT) == 0 ||
           strcmp(name, "snapshot.new") == 0; /* of a process that was killed */
}

static bool is_result(const char *name)
{
    return is_file(name) && !is_snapshot(name);
}

/* ---- the marker ---- */

/* *holds: its second line and those after it, to be freed; "" if there is no marker. */
static rp_status read_marker(const char *folder, char **holds)
{
    char path[MOST_PATH], *text = NULL;
    *holds = NULL;
    if (rp_is_in(folder, MARKER)) RP_TRY(rp_file_read(in(folder, MARKER, path), &text));
    const bool ours = text && strncmp(text, HEAD, sizeof HEAD - 1) == 0, none = !text;
    if (ours || none) *holds = strdup(ours ? text + sizeof HEAD - 1 : "");
    free(text);
    if (*holds) return RP_OK;
    return ours || none
               ? rp_fail(RP_NO_MEMORY, "%s: out of memory", folder)
               : rp_fail(RP_BAD_INPUT,
                         "%s: not of this version of the program (%s says so); move it away, or give "
                         "another folder",
                         folder, MARKER);
}

static rp_status write_marker(const char *folder, const char *holds, const rp_paths *files)
{
    char path[MOST_PATH];
    FILE *out;
    RP_TRY(rp_file_open(in(folder, MARKER, path), true, &out));
    fprintf(out, "%s%s\n", HEAD, holds);
    for (size_t i = 0; files && i < files->n; i++) fprintf(out, "%s\n", basename(files->path[i]));
    return rp_file_close(path, out, RP_OK);
}

static bool lists(const char *holds, const char *name)
{
    const size_t n = strlen(name);
    for (const char *line = strchr(holds, '\n'); line; line = strchr(line + 1, '\n'))
        if (strncmp(line + 1, name, n) == 0 && line[1 + n] == '\n') return !strchr(name, '\n');
    return false;
}

static int first_line(const char *holds)
{
    return (int)strcspn(holds, "\n");
}

static bool is_whole(const char *holds)
{
    return holds[first_line(holds)] && holds[first_line(holds) + 1];
}

static bool is_of(const char *holds, const char *what)
{
    return (size_t)first_line(holds) == strlen(what) && strncmp(holds, what, strlen(what)) == 0;
}

/* ---- folders ---- */

/* May a result take this name: is nothing there, or an empty folder, or by force another result? */
static rp_status check_free(const char *path, bool force)
{
    RP_ENDS(rp_paths_free) rp_paths files = {0};
    struct stat info;
    char *holds;
    if (lstat(path, &info) != 0) return errno == ENOENT ? RP_OK : failed(path);
    if (!S_ISDIR(info.st_mode))
        return rp_fail(RP_BAD_INPUT, "%s: not a folder; move it away, or give another name", path);
    RP_TRY(rp_paths_in(&files, path, is_any));
    if (files.n == 0) return RP_OK;
    RP_TRY(read_marker(path, &holds));
    rp_status status =
        !*holds || force
            ? RP_OK
            : rp_fail(RP_BAD_INPUT, "%s: holds %.*s; give another folder, or --force to replace it", path,
                      first_line(holds), holds);
    for (size_t i = 0; !status && i < files.n; i++) {
        const char *name = basename(files.path[i]);
        if ((is_file(name) || !*holds) && !lists(holds, name))
            status = rp_fail(RP_BAD_INPUT,
                             "%s: not of a result of this program; move it away, or give another folder",
                             files.path[i]);
    }
    free(holds);
    return status;
}

/* A snapshot may be a folder. */
static rp_status clear(const char *folder, bool (*which)(const char *name))
{
    RP_ENDS(rp_paths_free) rp_paths files = {0};
    RP_TRY(rp_paths_in(&files, folder, which));
    for (size_t i = 0; i < files.n; i++) {
        if (unlink(files.path[i]) == 0) continue;
        if (errno != EISDIR) return failed(files.path[i]);
        RP_TRY(clear(files.path[i], is_any));
        if (rmdir(files.path[i]) != 0) return failed(files.path[i]);
    }
    return RP_OK;
}

/* The marker goes last: what is left by a kill is still known. */
static rp_status remove_folder(const char *folder)
{
    char marker[MOST_PATH];
    RP_TRY(clear(folder, is_file));
    unlink(in(folder, MARKER, marker));
    return rmdir(folder) == 0 ? RP_OK : failed(folder);
}

static bool has_it(const rp_folder *f)
{
    char *holds;
    const bool has = read_marker(f->path, &holds) == RP_OK && is_of(holds, f->holds);
    free(holds);
    return has;
}

/* DIR.part is new, of the same result, or of another one that gives way; empty unless there is a snapshot.
 * *whole: it lacks its name alone, and is not what another process has just replaced. */
static rp_status enter(const rp_folder *f, bool *whole)
{
    RP_ENDS(rp_paths_free) rp_paths files = {0};
    char *holds;
    RP_TRY(clear(f->part, rp_file_is_temporary)); /* of processes that were killed */
    RP_TRY(rp_paths_in(&files, f->part, is_any));
    RP_TRY(read_marker(f->part, &holds));
    const bool same = is_of(holds, f->holds), listed = is_whole(holds), begun = rp_is_in(f->part, SNAPSHOT);
    rp_status status = RP_OK;
    *whole = listed && (!rp_is_there(f->path) || (same && !has_it(f)));
    if (!*holds && files.n > 0)
        status = rp_fail(RP_BAD_INPUT, "%s: no result of this program; move it away, or give another folder",
                         f->part);
    else if (!same && !*whole && begun && !f->force)
        status =
            rp_fail(RP_BAD_INPUT,
                    "%s: holds %.*s, unfinished; the command that began it continues, --force replaces it; "
                    "this one makes %s",
                    f->part, first_line(holds), holds, f->holds);
    free(holds);
    if (status || *whole || (same && !listed && begun)) return status;
    RP_TRY(clear(f->part, is_file));
    return write_marker(f->part, f->holds, NULL);
}

/* The folder is still that of the path, once it is locked: not one that has been published. */
static bool is_there(const rp_folder *f)
{
    struct stat here, there;
    return fstat(f->lock, &here) == 0 && lstat(f->part, &there) == 0 && here.st_dev == there.st_dev &&
           here.st_ino == there.st_ino;
}

static void unlock(rp_folder *f)
{
    close(f->lock);
    f->lock = 0;
}

static rp_status lock_part(rp_folder *f)
{
    const int file = open(f->part, O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
    if (file < 0) return failed(f->part);
    f->lock = file;
    if (flock(file, LOCK_EX | LOCK_NB) == 0 && is_there(f)) return RP_OK;
    unlock(f);
    return rp_fail(RP_IO, "%s: another process runs in this folder", f->part);
}

/* Remove a result that has been replaced, if it is there. */
static rp_status drop(const char *path)
{
    RP_TRY(check_free(path, true));
    return rp_is_there(path) ? remove_folder(path) : RP_OK;
}

/* What had the name is then in DIR.part or, where the file system has no exchange, as NFS, in `aside`: for a
 * moment no result has the name. */
static rp_status take_name(const rp_folder *f, const char *aside)
{
    if (rename(f->part, f->path) == 0 ||
        renameat2(AT_FDCWD, f->part, AT_FDCWD, f->path, RENAME_EXCHANGE) == 0)
        return RP_OK;
    if (errno == EINVAL || errno == ENOSYS) {
        RP_TRY(drop(aside));
        if (rename(f->path, aside) == 0 && rename(f->part, f->path) == 0) return RP_OK;
    }
    return rp_fail(RP_IO, "%s: %s; the whole result is in %s", f->path, strerror(errno), f->part);
}

/* Of what the marker lists. A kill leaves either a snapshot to go on from, or a whole result. */
static rp_status give_name(rp_folder *f)
{
    char aside[MOST_PATH - 16];
    if (fsync(f->lock) != 0) return failed(f->part);
    RP_TRY(clear(f->part, is_snapshot));
    if (fsync(f->lock) != 0) return failed(f->part);
    snprintf(aside, sizeof aside, "%s.old", f->part);
    RP_TRY(take_name(f, aside));
    if (!rp_file_sync_folder(f->path)) return failed(f->path);
    unlock(f);
    RP_TRY(drop(f->part));
    return drop(aside);
}

rp_status rp_folder_publish(rp_folder *f)
{
    RP_ENDS(rp_paths_free) rp_paths files = {0};
    RP_TRY(check_free(f->path, f->force));
    RP_TRY(rp_paths_in(&files, f->part, is_result));
    RP_TRY(write_marker(f->part, f->holds, &files));
    return give_name(f);
}

rp_status rp_folder_begin(rp_arena *arena, const char *path, const char *holds, bool force, rp_folder *f)
{
    size_t n = strlen(path);
    while (n > 1 && path[n - 1] == '/') n--;
    *f = (rp_folder){.force = force};
    RP_TRY(rp_path(arena, &f->path, "%.*s", (int)n, path));
    RP_TRY(rp_path(arena, &f->part, "%s.part", f->path));
    RP_TRY(rp_path(arena, &f->snapshot, "%s/%s", f->part, SNAPSHOT));
    char *line = rp_text(arena, "%s", holds), *name = basename(f->path);
    if (!line) return RP_NO_MEMORY;
    for (char *c = line; (c = strchr(c, '\n'));) *c = ' ';
    f->holds = line;
    if (!*name || strcmp(name, ".") == 0 || strcmp(name, "..") == 0)
        return rp_fail(RP_BAD_INPUT, "%s: give a folder by its name", path);
    bool whole = false;
    RP_TRY(check_free(f->path, force));
    RP_TRY(rp_make_directory(f->part));
    RP_TRY(lock_part(f));
    RP_TRY(enter(f, &whole));
    if (!whole) return RP_OK;
    RP_TRY(give_name(f));
    return rp_folder_begin(arena, path, holds, force, f); /* which is taken now */
}

bool rp_folder_is_empty(const rp_folder *f)
{
    RP_ENDS(rp_paths_free) rp_paths files = {0};
    return rp_paths_in(&files, f->part, is_file) == RP_OK && files.n == 0;
}

void rp_folder_end(rp_folder *f)
{
    if (f->lock == 0) return;
    if (is_there(f) && rp_folder_is_empty(f)) (void)remove_folder(f->part);
    unlock(f);
}

rp_status rp_folder_own(const char *path, const char *what, bool force)
{
    RP_ENDS(rp_paths_free) rp_paths files = {0};
    char *holds;
    RP_TRY(rp_make_directory(path));
    RP_TRY(rp_paths_in(&files, path, is_any));
    RP_TRY(read_marker(path, &holds));
    const bool same = is_of(holds, what), gives_way = *holds && !is_whole(holds);
    rp_status status = RP_OK;
    if (!same && files.n > 0 && !(gives_way && force))
        status = rp_fail(RP_BAD_INPUT, "%s: holds %.*s; give another folder%s", path,
                         *holds ? first_line(holds) : INT_MAX, *holds ? holds : "other files",
                         gives_way ? ", or --force" : "");
    free(holds);
    return status || same ? status : write_marker(path, what, NULL);
}
