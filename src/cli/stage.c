/* A folder of tables that only a whole result replaces; see cli.h. */
#include <dirent.h>
#include <errno.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "cli/cli.h"

/* Its message, ready for the handler of a signal. */
static char stopped[4200];

/* Move the files of folder `from` into `to`, or without `to` remove them. */
static rp_status move_files(const char *from, const char *to)
{
    char old[4400], new[4400];
    rp_status status = RP_OK;
    DIR *folder = opendir(from);
    if (!folder) return rp_fail(RP_IO, "%s: cannot read: %s", from, strerror(errno));
    for (const struct dirent *e; !status && (e = readdir(folder));) {
        if (strcmp(e->d_name, ".") == 0 || strcmp(e->d_name, "..") == 0) continue;
        snprintf(old, sizeof old, "%s/%s", from, e->d_name);
        if (to) snprintf(new, sizeof new, "%s/%s", to, e->d_name);
        if ((to ? rename(old, new) : unlink(old)) != 0)
            status = rp_fail(RP_IO, "%s: cannot %s: %s", old, to ? "move" : "remove", strerror(errno));
    }
    closedir(folder);
    return status;
}

rp_status cli_stage_open(const char *directory, char stage[4096])
{
    if (snprintf(stage, 4096, "%s/unfinished", directory) >= 4096)
        return rp_fail(RP_BAD_INPUT, "%.60s...: path too long", directory);
    rp_status status = rp_make_directory(directory);
    if (!status) status = rp_make_directory(stage);
    return status ? status : move_files(stage, NULL);
}

rp_status cli_stage_close(const char *directory, const char *stage, rp_status run)
{
    if (run) {
        char why[1024];
        if (rmdir(stage) == 0) return run; /* nothing was written */
        snprintf(why, sizeof why, "%s", rp_message());
        return rp_fail(run, "%s; the tables so far are in %s", why, stage);
    }
    rp_status status = move_files(stage, directory);
    rmdir(stage);
    return status;
}

static void stop(int signal_number)
{
    (void)signal_number;
    (void)!write(STDERR_FILENO, stopped, strlen(stopped));
    _exit(RP_STOPPED);
}

void cli_stage_stops(const char *stage)
{
    snprintf(stopped, sizeof stopped, "repose run: stopped; the tables so far are in %s\n", stage);
    cli_on_stop(stop);
}

void cli_on_stop(void (*handler)(int))
{
    signal(SIGINT, handler);
    signal(SIGTERM, handler);
    signal(SIGHUP, handler);
}
