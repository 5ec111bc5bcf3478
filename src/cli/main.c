/* The main function of a program of commands: finds the command, prints its failure, turns its status into
 * the exit status. */
#include <signal.h>
#include <stdlib.h>
#include <string.h>

#include <gsl/gsl_errno.h>

#include "cli/command.h"
#include "core/file.h"
#include "core/version.h"

static void exhausted(void)
{
    fputs("out of memory\n", stderr);
    exit(RP_NO_MEMORY);
}

/* "repose run scene.cfg" */
static char *line_of(rp_arena *arena, const char *name, int argc, char *const argv[])
{
    size_t size = strlen(name) + 1;
    for (int i = 1; i < argc; i++) size += strlen(argv[i]) + 1;
    char *line = strcpy(rp_arena_memory(arena, size, 1), name), *end = line;
    for (int i = 1; i < argc; i++) end = stpcpy(stpcpy(end + strlen(end), " "), argv[i]);
    return line;
}

static rp_status run(cli_call *call, int argc, char **argv, const char **name)
{
    const cli_program *program = call->program;
    const char *word = argv[1];
    const cli_command *command = cli_find(program->commands, word);
    if (command) {
        *name = word;
        return cli_run(call, command, argc - 1, argv + 1);
    }
    if (strcmp(word, "--help") == 0 || strcmp(word, "-h") == 0)
        cli_overview(program, stdout);
    else if (strcmp(word, "--version") == 0 || strcmp(word, "-V") == 0)
        printf("%s %s (commit %s)\n", program->name, RP_VERSION, rp_build_commit);
    else
        return cli_unknown_command(program, word, NULL);
    return RP_OK;
}

int cli_main(const cli_program *program, int argc, char **argv)
{
    signal(SIGXFSZ, SIG_IGN);    /* a file that reaches the limit of its size is a failed write */
    gsl_set_error_handler_off(); /* each caller of GSL checks the returned status */
    rp_arena arena = {.exhausted = exhausted};
    const char *name = "";
    cli_call call = {.arena = &arena, .program = program, .line = line_of(&arena, program->name, argc, argv)};
    if (argc < 2) cli_overview(program, stderr);
    rp_status status = argc < 2 ? RP_USAGE : run(&call, argc, argv, &name);
    /* a failed write is an error, and a failure has one message */
    if (!status) status = rp_file_finish(stdout, "standard output");
    if (status && argc > 1)
        fprintf(stderr, "%s%s%s: %s\n", program->name, *name ? " " : "", name, rp_message());
    rp_arena_release(&arena, NULL);
    return (int)status;
}
