/* The result of a run; see result.h. */
#include "cli/result.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <string.h>
#include <unistd.h>

#include "core/clock.h"
#include "core/file.h"

static const char OWNER[] = "repose run";

static rp_status path_of(const cli_result *r, rp_arena *arena, const char *name, const char **path)
{
    return rp_path(arena, path, "%s/%s", r->folder.part, name);
}

static rp_status failed(const char *path)
{
    return rp_fail(RP_IO, "%s: %s", path, strerror(errno));
}

static rp_status open_tables(cli_result *r, rp_arena *arena, int flags)
{
    const char *path;
    for (int k = 0; r->names && k < CLI_GROWING; k++) {
        RP_TRY(path_of(r, arena, r->names[k], &path));
        const int file = open(path, O_RDWR | O_NOFOLLOW | O_CLOEXEC | flags, 0666);
        if (file < 0 || !(r->table[k] = fdopen(file, "r+"))) return failed(path);
    }
    return RP_OK;
}

/* How long the tables are, then the caller's part. What came later goes. */
static rp_status keep_all(cli_result *r, rp_snapshot *s)
{
    for (int k = 0; k < CLI_GROWING; k++) {
        long length = s->reading ? 0 : ftell(r->table[k]);
        RP_KEEP(s, length);
        if (!s->reading || s->status) continue;
        if (lseek(fileno(r->table[k]), 0, SEEK_END) < length)
            return rp_fail(RP_BAD_INPUT, "%s: shorter than at the snapshot", r->names[k]);
        if (ftruncate(fileno(r->table[k]), length) != 0 || fseek(r->table[k], 0, SEEK_END) != 0)
            return failed(r->names[k]);
    }
    r->keep(s, r->context);
    return s->reading ? rp_snapshot_end(s) : s->status;
}

static rp_status resume(cli_result *r, rp_arena *arena, const char *snapshot)
{
    RP_ENDS(rp_snapshot_free) rp_snapshot s = {0};
    RP_TRY(rp_snapshot_read(&s, snapshot, OWNER, r->layout));
    RP_TRY(open_tables(r, arena, 0));
    return keep_all(r, &s);
}

rp_status cli_result_begin(cli_result *r, rp_arena *arena, const char *directory, const char *holds,
                           bool force, bool *resumed)
{
    const char *snapshot;
    RP_TRY(rp_folder_begin(arena, directory, holds, force, &r->folder));
    RP_TRY(path_of(r, arena, "snapshot", &snapshot));
    r->next = rp_cpu_clock() + CLI_SNAPSHOT;
    *resumed = access(snapshot, F_OK) == 0;
    if (!*resumed) RP_TRY(rp_folder_clear(&r->folder));
    if (!*resumed) return open_tables(r, arena, O_CREAT | O_EXCL);
    const rp_status status = r->names ? resume(r, arena, snapshot) : RP_OK;
    char why[1024];
    snprintf(why, sizeof why, "%s", rp_message());
    return status ? rp_fail(status, "%s; remove %s to begin anew", why, r->folder.part) : RP_OK;
}

static rp_status sync_tables(const cli_result *r)
{
    for (int k = 0; k < CLI_GROWING; k++) {
        if (!r->table[k]) continue;
        RP_TRY(rp_file_finish(r->table[k], r->names[k]));
        if (fsync(fileno(r->table[k])) != 0) return failed(r->names[k]);
    }
    return RP_OK;
}

rp_status cli_result_keep(cli_result *r, bool now)
{
    RP_SCOPE(memory);
    RP_ENDS(rp_snapshot_free) rp_snapshot s = {0};
    const char *snapshot;
    if (r->folder.lock == 0 || (!now && rp_cpu_clock() < r->next)) return RP_OK;
    RP_TRY(path_of(r, &memory, "snapshot", &snapshot));
    RP_TRY(sync_tables(r));
    RP_TRY(keep_all(r, &s));
    RP_TRY(rp_snapshot_write(&s, snapshot, OWNER, r->layout));
    r->next = rp_cpu_clock() + CLI_SNAPSHOT;
    return RP_OK;
}

rp_status cli_result_end(cli_result *r, rp_status run)
{
    char why[1024];
    if (!run) run = sync_tables(r);
    if (!run) return rp_folder_publish(&r->folder);
    if (rp_folder_is_empty(&r->folder)) return run;
    snprintf(why, sizeof why, "%s", rp_message());
    return run == RP_STOPPED ? rp_fail(run, "%s; the same command continues", why)
                             : rp_fail(run, "%s; the tables so far are in %s", why, r->folder.part);
}

void cli_result_free(cli_result *r)
{
    for (int k = 0; k < CLI_GROWING; k++)
        if (r->folder.part && r->table[k]) fclose(r->table[k]); /* else standard output */
    rp_folder_end(&r->folder);
}

static volatile bool *stop_asked;

static void stop(int signal_number)
{
    (void)signal_number;
    *stop_asked = true;
}

void cli_on_stop(volatile bool *asked)
{
    static const int signals[] = {SIGINT, SIGTERM, SIGHUP};
    struct sigaction now, act = {.sa_handler = stop, .sa_flags = (int)SA_RESETHAND};
    stop_asked = asked;
    for (int k = 0; k < 3; k++) /* not of nohup */
        if (sigaction(signals[k], NULL, &now) == 0 && now.sa_handler != SIG_IGN)
            sigaction(signals[k], &act, NULL);
}
