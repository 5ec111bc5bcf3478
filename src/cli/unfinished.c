/* Folders of unfinished runs; see unfinished.h. */
#include "cli/unfinished.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <string.h>
#include <sys/stat.h>
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

void cli_unfinished_free(cli_unfinished *u)
{
    for (int k = 0; k < CLI_GROWING; k++) {
        if (u->table[k].hash && u->table[k].file) fclose(u->table[k].file);
        XXH3_freeState(u->table[k].hash);
    }
    rp_folder_close(&u->stage);
    rp_folder_close(&u->folder);
}

static rp_status open_table(cli_unfinished *u, int k, int flags)
{
    cli_growing *t = &u->table[k];
    t->name = u->names[k];
    if (!(t->hash = XXH3_createState())) return rp_fail(RP_NO_MEMORY, "tables: out of memory");
    XXH3_128bits_reset(t->hash);
    return rp_folder_file(&u->stage, t->name, flags, &t->file);
}

/* A run that can be resumed is not thrown away; a sweep's row resumes by itself. */
static rp_status open_tables(cli_unfinished *u)
{
    const int n = u->names ? CLI_GROWING : 0;
    const bool scene = rp_folder_find(&u->stage, "states.tsv", 0);
    if (rp_is_in(u->stage.path, "snapshot"))
        return u->resumes && !scene
                   ? RP_OK
                   : rp_fail(RP_BAD_INPUT, "%s: an unfinished run; continue with %s%s, or remove the folder",
                             path_of(u, "snapshot"), scene ? "--resume " : "the command that began it, of ",
                             scene ? u->directory : u->stage.holds);
    RP_TRY(rp_folder_clear(&u->stage));
    for (int k = 0; k < n; k++) RP_TRY(rp_folder_list(&u->stage, u->names[k], RP_OWN_STAYS));
    RP_TRY(rp_folder_list(&u->stage, "snapshot", RP_OWN_GOES));
    RP_TRY(rp_folder_list(&u->stage, "snapshot.new", RP_OWN_GOES));
    snprintf(u->stage.holds, sizeof u->stage.holds, "%s", u->holds);
    RP_TRY(rp_folder_write(&u->stage));
    for (int k = 0; k < n; k++) RP_TRY(open_table(u, k, O_RDWR | O_CREAT | O_EXCL));
    return RP_OK;
}

rp_status cli_unfinished_start(cli_unfinished *u)
{
    bool moved;
    RP_TRY(rp_make_directory(u->directory));
    RP_TRY(rp_folder_enter(u->directory, &u->folder));
    RP_TRY(rp_folder_settle(&u->folder, &moved));
    RP_TRY(rp_folder_vacant(&u->folder, u->force));
    for (int k = 0; k < CLI_GROWING && u->names; k++) RP_TRY(rp_folder_check(&u->folder, u->names[k]));
    RP_TRY(rp_folder_stage(&u->folder, true, &u->stage));
    RP_TRY(open_tables(u));
    u->entered = true;
    return RP_OK;
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
        if (memchr(bytes, '\0', (size_t)n)) return rp_fail(RP_IO, "%s: cut by another program", t->name);
        XXH3_128bits_update(t->hash, bytes, (size_t)n);
        t->hashed += n;
    }
    return RP_OK;
}

/* The tables as they were at the snapshot, and that they are these; then the caller's part. */
static rp_status keep_all(cli_unfinished *u, rp_snapshot *s, cli_keep *keep, void *context)
{
    long length[CLI_GROWING];
    XXH128_hash_t hash[CLI_GROWING];
    for (int k = 0; k < CLI_GROWING; k++) {
        if (!s->reading) length[k] = u->table[k].hashed, hash[k] = XXH3_128bits_digest(u->table[k].hash);
        RP_KEEP(s, length[k]);
        RP_KEEP(s, hash[k]);
    }
    keep(s, context);
    if (!s->reading) return RP_OK;
    RP_TRY(rp_snapshot_end(s));
    for (int k = 0; k < CLI_GROWING; k++) {
        const char *path = path_of(u, u->names[k]);
        if (open_table(u, k, O_RDWR))
            return rp_fail(RP_BAD_INPUT, "%s: cannot open: %s", path, strerror(errno));
        cli_growing *t = &u->table[k];
        RP_TRY(hash_to(t, length[k]));
        if (!XXH128_isEqual(hash[k], XXH3_128bits_digest(t->hash)))
            return rp_fail(RP_BAD_INPUT, "%s: not the table that the snapshot was written with", path);
        /* what came later goes */
        if (ftruncate(fileno(t->file), length[k]) != 0 || fseek(t->file, 0, SEEK_END) != 0)
            return failed(path);
    }
    return RP_OK;
}

rp_status cli_unfinished_resume(cli_unfinished *u, cli_keep *keep, void *context, bool *done)
{
    RP_ENDS(rp_snapshot_free) rp_snapshot s = {0};
    *done = false;
    if (access(u->directory, F_OK) != 0) return rp_fail(RP_BAD_INPUT, "%s: no unfinished run", u->directory);
    RP_TRY(rp_folder_enter(u->directory, &u->folder));
    RP_TRY(rp_folder_settle(&u->folder, done));
    RP_TRY(rp_folder_stage(&u->folder, false, &u->stage));
    u->holds = u->folder.holds;
    const rp_own *table = rp_folder_find(&u->folder, u->names[0], 0);
    *done |= table && u->stage.n == 0;
    if (*done) return RP_OK;
    if (!u->stage.marked) return rp_fail(RP_BAD_INPUT, "%s: no unfinished run", u->directory);
    if (!rp_folder_find(&u->stage, u->names[0], 0))
        return rp_fail(RP_BAD_INPUT,
                       "%s: no unfinished run of a scene; the command that began it continues %s",
                       u->directory, u->stage.holds);
    RP_TRY(rp_snapshot_read(&s, path_of(u, "snapshot"), OWNER, u->layout));
    RP_TRY(keep_all(u, &s, keep, context));
    u->entered = true;
    return RP_OK;
}

/* On the disk, those that are open. */
static rp_status sync_tables(const cli_unfinished *u)
{
    for (const cli_growing *t = u->table; t < u->table + CLI_GROWING; t++) {
        if (!t->file) continue;
        const char *path = path_of(u, t->name);
        RP_TRY(rp_file_finish(t->file, path));
        if (fsync(fileno(t->file)) != 0) return failed(path);
    }
    return RP_OK;
}

rp_status cli_unfinished_write(cli_unfinished *u, cli_keep *keep, void *context)
{
    RP_ENDS(rp_snapshot_free) rp_snapshot s = {0};
    const rp_mark mark = rp_arena_mark(u->arena);
    RP_TRY(sync_tables(u));
    for (int k = 0; k < CLI_GROWING; k++) RP_TRY(hash_to(&u->table[k], ftell(u->table[k].file)));
    RP_TRY(keep_all(u, &s, keep, context));
    RP_TRY(rp_snapshot_write(&s, path_of(u, "snapshot"), OWNER, u->layout));
    rp_arena_release(u->arena, mark);
    return RP_OK;
}

/* The open tables are what was written: in their place, as long, with the same bytes up to the snapshot, and
 * without the holes of one that was cut. */
static rp_status check_tables(const cli_unfinished *u)
{
    for (int k = 0; k < CLI_GROWING; k++) {
        cli_growing t = u->table[k];
        struct stat here, there;
        if (!t.file) continue;
        const XXH128_hash_t hash = XXH3_128bits_digest(t.hash);
        const long hashed = t.hashed, written = ftell(t.file);
        bool same = fstat(fileno(t.file), &here) == 0 && here.st_size == written &&
                    fstatat(u->stage.file, t.name, &there, AT_SYMLINK_NOFOLLOW) == 0 &&
                    here.st_dev == there.st_dev && here.st_ino == there.st_ino;
        XXH3_128bits_reset(t.hash);
        t.hashed = 0;
        same = same && hash_to(&t, hashed) == RP_OK && XXH128_isEqual(hash, XXH3_128bits_digest(t.hash)) &&
               hash_to(&t, written) == RP_OK;
        if (!same)
            return rp_fail(RP_IO,
                           "%s: removed or changed by another program while the run wrote it; remove the "
                           "folder, and run again",
                           path_of(u, t.name));
    }
    return RP_OK;
}

/* What was computed before a failure: tables whose last line says why, and none that cannot be written. */
static rp_status leave_tables(cli_unfinished *u, rp_status run)
{
    char why[1024];
    snprintf(why, sizeof why, "%s", rp_message());
    for (int k = 0; k < CLI_GROWING; k++) {
        if (!u->table[k].file) continue;
        rp_table_note(u->table[k].file, "unfinished", "%s", why);
        if (rp_file_finish(u->table[k].file, u->table[k].name)) unlink(path_of(u, u->table[k].name));
    }
    if (rp_folder_empty(&u->stage) && rp_folder_remove(&u->folder, "unfinished") == RP_OK) {
        if (u->folder.n == 1) (void)rp_folder_clear(&u->folder); /* nothing else was in it */
        return rp_fail(run, "%s", why);
    }
    return rp_fail(run, "%s; the tables so far are in %s/unfinished", why, u->directory);
}

rp_status cli_unfinished_end(cli_unfinished *u, bool resumable, rp_status run)
{
    if (!u->entered) return run;
    if (!run) run = sync_tables(u);
    if (!run) run = check_tables(u);
    if (!run) {
        alarm(0);
        cli_on_stop(SIG_IGN); /* the tables will not be where the message says */
        run = rp_folder_publish(&u->folder);
    } else if (!resumable) {
        run = leave_tables(u, run);
    }
    u->entered = false;
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
    if (signal(SIGHUP, handler) == SIG_IGN) signal(SIGHUP, SIG_IGN); /* nohup */
}
