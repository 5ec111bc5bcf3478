/* The program `repose`: finds the subcommand, prints its failure, and turns its status into the exit status.
 */
#include <signal.h>
#include <stdlib.h>
#include <string.h>

#include <gsl/gsl_errno.h>

#include "cli/cli.h"
#include "core/version.h"

#define X(name) &cmd_##name,
static const cli_command *const commands[] = {CLI_COMMANDS(X)};
#undef X

static char command_line[4096];

const char *cli_command_line(void)
{
    return command_line;
}

static void print_overview(FILE *out)
{
    fprintf(out,
            "Repose %s: forces in and under piles of grains, and the angles at which piles are stable and "
            "fail.\n\n"
            "usage: repose COMMAND [options]; repose COMMAND --help says more\n\n",
            RP_VERSION);
    for (size_t i = 0; i < sizeof commands / sizeof *commands; i++)
        fprintf(out, "  %-10s %s\n", commands[i]->name, commands[i]->summary);
}

/* Flush standard output, since a failed write is an error; a failure has one message. */
static int finish(const char *command, rp_status status)
{
    if (!status) status = rp_table_finish(stdout, "standard output");
    if (status) fprintf(stderr, "repose%s%s: %s\n", *command ? " " : "", command, rp_message());
    return (int)status;
}

int main(int argc, char **argv)
{
    signal(SIGXFSZ, SIG_IGN);    /* a file that reaches the limit of its size is a failed write */
    gsl_set_error_handler_off(); /* each caller of GSL checks the returned status */
    size_t used = (size_t)snprintf(command_line, sizeof command_line, "repose");
    for (int i = 1; i < argc && used < sizeof command_line; i++)
        used += (size_t)snprintf(command_line + used, sizeof command_line - used, " %s", argv[i]);
    if (argc < 2) {
        print_overview(stderr);
        return RP_USAGE;
    }
    if (strcmp(argv[1], "--help") == 0 || strcmp(argv[1], "help") == 0) {
        print_overview(stdout);
        return finish("", RP_OK);
    }
    if (strcmp(argv[1], "--version") == 0) {
        printf("repose %s (commit %s)\n", RP_VERSION, rp_build_commit);
        return finish("", RP_OK);
    }
    for (size_t i = 0; i < sizeof commands / sizeof *commands; i++)
        if (strcmp(argv[1], commands[i]->name) == 0)
            return finish(argv[1], cli_run(commands[i], argc - 1, argv + 1));
    return finish("", rp_fail(RP_USAGE, "unknown command \"%s\"; see repose --help", argv[1]));
}
