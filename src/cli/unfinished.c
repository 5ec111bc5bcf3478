/* Folders of unfinished runs; see unfinished.h. */
#include "cli/unfinished.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <signal.h>
#include <stdbool.h>
#include <string.h>
#include <sys/file.h>
#include <unistd.h>
#include <xxhash.h>

#include "core/file.h"
#include "table/table.h"

static const char OWNER[] = "repose run";

/* A file of the unfinished run. */
static const char *path_of(const cli_unfinished *u, const char *name)
{
    return rp_text(u->arena, "%s/unfinished/%s", u->directory, name);
}

static rp_status failed(const char *path)
{
    return rp_fail(RP_IO, "%s: %s", path, strerror(errno));
}

/* One process at a time writes in a folder. */
static rp_status take_lock(const char *directory, const char *path, int *lock)
{
    *lock = open(path, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (*lock < 0) return rp_fail(RP_BAD_INPUT, "%s: no unfinished run: %s", directory, strerror(errno));
    if (flock(*lock, LOCK_EX | LOCK_NB) == 0) return RP_OK;
    close(*lock);
    *lock = -1;
    return rp_fail(RP_IO, "%s: another process runs in this folder", directory);
}

static void close_all(cli_unfinished *u)
{
    for (int k = 0; k < CLI_GROWING; k++) {
        if (u->table[k].file) fclose(u->table[k].file);
        XXH3_freeState(u->table[k].hash);
        u->table[k] = (cli_growing){0};
    }
    if (u->lock >= 0) close(u->lock);
    u->lock = -1;
}

static rp_status enter(cli_unfinished *u)
{
    for (int k = 0; k < CLI_GROWING && u->names; k++) {
        u->table[k].name = u->names[k];
        if (!(u->table[k].hash = XXH3_createState())) return rp_fail(RP_NO_MEMORY, "tables: out of memory");
        XXH3_128bits_reset(u->table[k].hash);
    }
    if (strlen(u->directory) > PATH_MAX - 64)
        return rp_fail(RP_BAD_INPUT, "%.60s...: path too long", u->directory);
    return take_lock(u->directory, path_of(u, ""), &u->lock);
}

static rp_status move_file(const char *from, const char *to)
{
    return rename(from, to) == 0 ? RP_OK : rp_fail(RP_IO, "%s: cannot move: %s", from, strerror(errno));
}

static rp_status remove_file(const char *path, const char *other)
{
    (void)other;
    if (unlink(path) == 0 || errno == ENOENT) return RP_OK;
    return rp_fail(RP_IO, "%s: cannot remove: %s", path, strerror(errno));
}

static rp_status remove_other(const char *path, const char *other)
{
    return remove_file(other, path);
}

/* For each file of a folder, its path and that of the same name in another one. */
static rp_status each_file(const char *folder, const char *other,
                           rp_status (*act)(const char *, const char *))
{
    char first[4400], second[4400];
    rp_status status = RP_OK;
    DIR *files = opendir(folder);
    if (!files) return rp_fail(RP_IO, "%s: cannot read: %s", folder, strerror(errno));
    for (const struct dirent *e; !status && (e = readdir(files));) {
        if (strcmp(e->d_name, ".") == 0 || strcmp(e->d_name, "..") == 0) continue;
        snprintf(first, sizeof first, "%s/%s", folder, e->d_name);
        snprintf(second, sizeof second, "%s/%s", other, e->d_name);
        status = act(first, second);
    }
    closedir(files);
    return status;
}

static rp_status empty_folder(const char *folder)
{
    return each_file(folder, "", remove_file);
}

/* ---- A whole result takes its place
 *
 * One step decides: the folder "unfinished" is renamed "unfinished.moving". From then on the older tables are
 * removed, and only then the new ones move. So DIR never holds tables of two runs, whenever the process is
 * killed; whoever comes next moves the rest. */

/* Snapshots, and temporary files of processes that were killed, are no tables. */
static rp_status remove_own(const char *path, const char *other)
{
    const char *name = strrchr(path, '/') + 1;
    return strncmp(name, "snapshot", 8) == 0 || strstr(name, ".tmp") ? remove_file(path, other) : RP_OK;
}

static rp_status move_rest(const char *directory, const char *folder)
{
    RP_TRY(each_file(folder, directory, remove_own));
    RP_TRY(each_file(folder, directory, remove_other));
    RP_TRY(rp_sync_folder_of(folder));
    RP_TRY(each_file(folder, directory, move_file));
    if (rmdir(folder) != 0) RP_TRY(failed(folder));
    return rp_sync_folder_of(folder);
}

/* Complete a move that another process began. *moved: there was one. */
static rp_status complete_move(const char *directory, bool *moved)
{
    char folder[4400];
    int lock = -1;
    snprintf(folder, sizeof folder, "%s/unfinished.moving", directory);
    *moved = access(folder, F_OK) == 0;
    if (!*moved) return RP_OK;
    rp_status status = take_lock(directory, folder, &lock);
    if (!status) status = move_rest(directory, folder);
    if (lock >= 0) close(lock);
    return status;
}

/* The whole and synced tables of "unfinished" become the result. `lock` is that folder's. */
static rp_status publish(const char *directory, int lock)
{
    char from[4400], to[4400];
    snprintf(from, sizeof from, "%s/unfinished", directory);
    snprintf(to, sizeof to, "%s/unfinished.moving", directory);
    RP_TRY(fsync(lock) == 0 ? move_file(from, to) : failed(from));
    RP_TRY(rp_sync_folder_of(to));
    return move_rest(directory, to);
}

/* A run that can be resumed is not thrown away. */
static rp_status check_vacant(const cli_unfinished *u)
{
    const char *path = path_of(u, "snapshot");
    return access(path, F_OK) != 0
               ? RP_OK
               : rp_fail(RP_BAD_INPUT,
                         "%s: an unfinished run; continue with --resume %s, or remove the folder", path,
                         u->directory);
}

/* Empty tables in the folder; without names what is there, if it can be resumed. */
static rp_status open_tables(cli_unfinished *u)
{
    const rp_status vacant = check_vacant(u);
    if (vacant) return u->names ? vacant : RP_OK;
    RP_TRY(empty_folder(path_of(u, "")));
    for (int k = 0; k < CLI_GROWING && u->names; k++) {
        const char *path = path_of(u, u->names[k]);
        if (!(u->table[k].file = fopen(path, "w+e"))) RP_TRY(failed(path));
    }
    return RP_OK;
}

rp_status cli_unfinished_start(cli_unfinished *u)
{
    bool moved;
    u->lock = -1;
    RP_TRY(rp_make_directory(u->directory));
    RP_TRY(complete_move(u->directory, &moved));
    RP_TRY(rp_make_directory(path_of(u, "")));
    rp_status status = enter(u);
    if (!status) status = open_tables(u);
    if (status) close_all(u);
    return status;
}

/* Take the bytes up to `length` into the hash. */
static rp_status hash_to(cli_growing *t, long length)
{
    char bytes[65536];
    while (t->hashed < length) {
        const size_t most = (size_t)(length - t->hashed);
        const ssize_t n = pread(fileno(t->file), bytes, most < sizeof bytes ? most : sizeof bytes, t->hashed);
        if (n < 0 && errno == EINTR) continue;
        if (n < 0) return failed(t->name);
        if (n == 0) return rp_fail(RP_BAD_INPUT, "%s: shorter than at the snapshot", t->name);
        XXH3_128bits_update(t->hash, bytes, (size_t)n);
        t->hashed += n;
    }
    return RP_OK;
}

static void keep_table(rp_snapshot *s, cli_growing *t, long *length, XXH128_hash_t *hash)
{
    *length = t->hashed;
    *hash = XXH3_128bits_digest(t->hash);
    RP_KEEP(s, *length);
    RP_KEEP(s, *hash);
}

/* Cut a table back to its length at the snapshot. */
static rp_status reopen(cli_unfinished *u, cli_growing *t, long length, XXH128_hash_t hash)
{
    const char *path = path_of(u, t->name);
    if (!(t->file = fopen(path, "r+e")))
        return rp_fail(RP_BAD_INPUT, "%s: cannot open: %s", path, strerror(errno));
    RP_TRY(hash_to(t, length));
    if (!XXH128_isEqual(hash, XXH3_128bits_digest(t->hash)))
        return rp_fail(RP_BAD_INPUT, "%s: not the table that the snapshot was written with", path);
    return ftruncate(fileno(t->file), length) == 0 && fseek(t->file, 0, SEEK_END) == 0 ? RP_OK : failed(path);
}

/* The result is in its place, and nothing of another run is beside it. */
static bool is_whole(const char *directory, const char *table)
{
    char unfinished[4400], whole[4400];
    snprintf(unfinished, sizeof unfinished, "%s/unfinished", directory);
    snprintf(whole, sizeof whole, "%s/%s", directory, table);
    return access(unfinished, F_OK) != 0 && access(whole, F_OK) == 0;
}

rp_status cli_unfinished_resume(cli_unfinished *u, cli_keep *keep, void *context, bool *done)
{
    long length[CLI_GROWING];
    XXH128_hash_t hash[CLI_GROWING];
    rp_snapshot s = {0};
    u->lock = -1;
    rp_status status = complete_move(u->directory, done);
    *done |= !status && is_whole(u->directory, u->names[0]);
    if (status || *done) return status;
    status = enter(u);
    if (!status) status = rp_snapshot_read(&s, path_of(u, "snapshot"), OWNER, u->layout);
    if (!status) {
        for (int k = 0; k < CLI_GROWING; k++) keep_table(&s, &u->table[k], &length[k], &hash[k]);
        keep(&s, context);
        status = rp_snapshot_end(&s);
    }
    for (int k = 0; k < CLI_GROWING && !status; k++) status = reopen(u, &u->table[k], length[k], hash[k]);
    rp_snapshot_free(&s);
    if (status) close_all(u);
    return status;
}

rp_status cli_unfinished_write(cli_unfinished *u, cli_keep *keep, void *context)
{
    const rp_mark mark = rp_arena_mark(u->arena);
    rp_snapshot s = {0};
    rp_status status = RP_OK;
    for (int k = 0; k < CLI_GROWING && !status; k++) {
        cli_growing *t = &u->table[k];
        long length;
        XXH128_hash_t hash;
        const char *path = path_of(u, t->name);
        status = rp_file_finish(t->file, path);
        if (!status) status = hash_to(t, ftell(t->file));
        if (!status && fsync(fileno(t->file)) != 0) status = failed(path);
        keep_table(&s, t, &length, &hash);
    }
    if (!status) {
        keep(&s, context);
        status = rp_snapshot_write(&s, path_of(u, "snapshot"), OWNER, u->layout);
    }
    rp_snapshot_free(&s);
    rp_arena_release(u->arena, mark);
    return status;
}

static rp_status sync_tables(const cli_unfinished *u)
{
    for (int k = 0; k < CLI_GROWING; k++) {
        if (!u->table[k].file) continue;
        RP_TRY(rp_file_finish(u->table[k].file, u->table[k].name));
        if (fsync(fileno(u->table[k].file)) != 0) RP_TRY(failed(u->table[k].name));
    }
    return RP_OK;
}

/* What was computed before a failure: tables whose last line says why, and none that cannot be written. */
static rp_status leave_tables(const cli_unfinished *u, rp_status run)
{
    char why[1024];
    snprintf(why, sizeof why, "%s", rp_message());
    for (int k = 0; k < CLI_GROWING; k++) {
        if (!u->table[k].file) continue;
        rp_table_note(u->table[k].file, "unfinished", "%s", why);
        if (rp_file_finish(u->table[k].file, u->table[k].name)) unlink(path_of(u, u->table[k].name));
    }
    if (rmdir(path_of(u, "")) == 0) return rp_fail(run, "%s", why); /* nothing was written */
    return rp_fail(run, "%s; the tables so far are in %s/unfinished", why, u->directory);
}

rp_status cli_unfinished_end(cli_unfinished *u, bool resumable, rp_status run)
{
    if (u->lock < 0) return run;
    if (!run) run = sync_tables(u);
    if (!run) {
        alarm(0);
        cli_on_stop(SIG_IGN); /* the tables will not be where the message says */
        run = publish(u->directory, u->lock);
    } else if (!resumable) {
        run = leave_tables(u, run);
    }
    close_all(u);
    return run;
}

/* ---- Signals */

/* The message of cli_unfinished_stops, ready for the handler of a signal. */
static char stopped[4200];

static volatile bool *stop_asked;

static void stop(int signal_number)
{
    if (signal_number != SIGALRM && !*stop_asked) {
        *stop_asked = true;
        alarm(10); /* for a run that takes no snapshots */
        return;
    }
    (void)!write(STDERR_FILENO, stopped, strlen(stopped));
    _exit(RP_STOPPED);
}

void cli_unfinished_stops(const char *directory, volatile bool *stop_here)
{
    stop_asked = stop_here;
    signal(SIGALRM, stop);
    snprintf(stopped, sizeof stopped, "repose run: stopped; the tables so far are in %s/unfinished\n",
             directory);
    cli_on_stop(stop);
}

void cli_on_stop(void (*handler)(int))
{
    signal(SIGINT, handler);
    signal(SIGTERM, handler);
    signal(SIGHUP, handler);
}
