/* The result of a run; see result.h. */
#include "cli/result.h"

#include <signal.h>
#include <unistd.h>

#include "core/file.h"

rp_status cli_result_begin(rp_arena *arena, const char *directory, const char *holds, bool force,
                           rp_folder *folder, const char **snapshot)
{
    RP_TRY(rp_folder_begin(arena, directory, holds, force, folder));
    RP_TRY(rp_path(arena, snapshot, "%s/snapshot", folder->part));
    return access(*snapshot, F_OK) == 0 ? RP_OK : rp_folder_clear(folder);
}

rp_status cli_result_end(rp_folder *folder, rp_status run)
{
    char why[1024];
    if (!run) return rp_folder_publish(folder);
    if (rp_folder_is_empty(folder)) return run;
    snprintf(why, sizeof why, "%s", rp_message());
    return run == RP_STOPPED ? rp_fail(run, "%s; the same command continues", why)
                             : rp_fail(run, "%s; the tables so far are in %s", why, folder->part);
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
