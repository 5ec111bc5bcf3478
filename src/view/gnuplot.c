/* A gnuplot that reads its commands from this process; see view.h. */
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "view/view.h"

extern char **environ;

enum { NO_WINDOW = 3 }; /* exit status of gnuplot */
const char view_gnuplot_window[] = "if (GPVAL_TERM eq 'unknown' || GPVAL_TERM eq 'dumb') exit status 3\n";

bool view_has_screen(void)
{
    const char *x = getenv("DISPLAY"), *wayland = getenv("WAYLAND_DISPLAY");
    return (x && *x) || (wayland && *wayland);
}

rp_status view_gnuplot_open(view_gnuplot *g, char *const arguments[], const char *package, FILE *out)
{
    int ends[2];
    g->name = arguments[0];
    posix_spawn_file_actions_t actions;
    if (pipe2(ends, O_CLOEXEC) != 0) return rp_fail(RP_IO, "%s: %s", arguments[0], strerror(errno));
    if (out) fflush(out);
    signal(SIGPIPE, SIG_IGN);
    setenv("LC_ALL", "C.UTF-8", 1); /* where no locale is set, gnuplot warns of a degree sign */
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, ends[0], STDIN_FILENO);
    if (out && fileno(out) != STDOUT_FILENO)
        posix_spawn_file_actions_adddup2(&actions, fileno(out), STDOUT_FILENO);
    if ((g->errors = tmpfile())) posix_spawn_file_actions_adddup2(&actions, fileno(g->errors), STDERR_FILENO);
    const int error = posix_spawnp(&g->pid, arguments[0], &actions, NULL, arguments, environ);
    posix_spawn_file_actions_destroy(&actions);
    close(ends[0]);
    g->in = fdopen(ends[1], "w");
    if (error == 0 && g->in) return RP_OK;
    if (g->in)
        fclose(g->in);
    else
        close(ends[1]);
    if (g->errors) fclose(g->errors);
    return rp_fail(RP_NO_RESULT, "%s: cannot start: %s; Debian has it in the package %s", arguments[0],
                   strerror(error ? error : errno), package);
}

rp_status view_gnuplot_close(view_gnuplot *g)
{
    int status = 0;
    char text[400] = "";
    const bool failed = ferror(g->in) != 0 || fclose(g->in) != 0;
    while (waitpid(g->pid, &status, 0) < 0 && errno == EINTR) continue;
    if (g->errors) {
        rewind(g->errors);
        text[fread(text, 1, sizeof text - 1, g->errors)] = '\0';
        fclose(g->errors);
    }
    for (char *c = text; (c = strpbrk(c, "\n\t"));) *c = ' ';
    if (WIFEXITED(status) && WEXITSTATUS(status) == NO_WINDOW)
        return rp_fail(RP_NO_RESULT,
                       "this gnuplot opens no window; Debian's package gnuplot-qt does, -o FILE needs none");
    return !failed && status == 0 ? RP_OK
                                  : rp_fail(RP_IO, "%s failed: %s", g->name, text + strspn(text, " "));
}
