/* From the words of a command line to the command, and the main function of a program; see cli.h. */
#include "cli/cli.h"

#include <signal.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include "core/plain.h"
#include "core/version.h"
#include "table/where.h"
#include "params/guess.h"

rp_status cli_unknown_command(const cli_program *program, const char *word, const cli_command *group)
{
    rp_guess guess = rp_guess_of(word);
    for (const cli_command *const *c = group ? group->group : program->commands; c && *c; c++)
        rp_guess_try(&guess, cli_own_name(*c));
    return rp_fail(RP_USAGE, "unknown command \"%s\"%s; see %s %s%s--help", word, rp_guess_text(&guess),
                   program->name, group ? group->name : "", group ? " " : "");
}

const cli_command *cli_find(const cli_command *const *among, const char *word)
{
    while (*among && strcmp(cli_own_name(*among), word) != 0) among++;
    return *among;
}

void cli_overview(const cli_program *program, const cli_command *group, FILE *out)
{
    const char *name = program->name, *of = group ? group->name : "", *blank = group ? " " : "";
    if (!group) fprintf(out, "%s %s: %s.\n\n", program->title, RP_VERSION, program->about);
    fprintf(out, "usage: %s %s%sCOMMAND [options]; %s %s%sCOMMAND --help says more\n\n", name, of, blank,
            name, of, blank);
    for (const cli_command *const *c = group ? group->group : program->commands; *c; c++)
        fprintf(out, "  %-11s %s\n", cli_own_name(*c), (*c)->summary);
}

/* The command of a group, or for NULL of the program, that argv[1] names. */
static rp_status run_among(cli_call *call, const cli_command *group, int argc, char **argv)
{
    const cli_program *program = call->program;
    if (argc < 2)
        return rp_fail(RP_USAGE, "a command is missing; see %s %s --help", program->name, group->name);
    const char *word = argv[1];
    const cli_command *command = cli_find(group ? group->group : program->commands, word);
    if (command) return cli_run(call, command, argc - 1, argv + 1);
    if (strcmp(word, "--help") == 0 || strcmp(word, "-h") == 0)
        cli_overview(program, group, call->out);
    else if (!group && (strcmp(word, "--version") == 0 || strcmp(word, "-V") == 0))
        fprintf(call->out, "%s %s (commit %s)\n", program->name, RP_VERSION, rp_build_commit);
    else
        return cli_unknown_command(program, word, group);
    return RP_OK;
}

void cli_sources(cli_call *call, const rp_table *table)
{
    for (const char *n = NULL; (n = rp_table_next_note(table, "source", n));)
        call->lineage = rp_text(call->arena, "%s# source: %s\n", call->lineage ? call->lineage : "", n);
}

/* The tables of all arguments as one. */
static rp_status read_tables(const cli_call *call, rp_table **table)
{
    rp_table *next;
    for (int i = 0; i < call->n_arguments; i++) {
        RP_TRY(rp_table_load(call->arena, rp_data(call->arena, cli_argument(call, i)), &next));
        if (*table) RP_TRY(rp_table_append(*table, next));
        if (!*table) *table = next;
    }
    return RP_OK;
}

static rp_status act(cli_call *call, rp_table *table)
{
    const cli_command *command = call->command;
    if (!command->on_table) return command->act(call, call->values);
    const rp_texts *where = cli_value(call, "where");
    if (!table) {
        RP_TRY(read_tables(call, &table));
        cli_sources(call, table);
    }
    call->units = rp_table_units(table);
    for (size_t i = 0; where && i < where->n; i++) RP_TRY(rp_table_where(table, where->items[i]));
    return command->on_table(call, table, call->values);
}

rp_status cli_act_into(cli_call *call, rp_table *table, FILE *out)
{
    FILE *const before = call->out;
    call->out = out;
    const rp_status status = act(call, table);
    call->out = before;
    return status;
}

rp_status cli_run(cli_call *call, const cli_command *command, int argc, char **argv)
{
    bool helped;
    if (command->group) return run_among(call, command, argc, argv);
    RP_TRY(cli_parse(call, command, argc, argv, &helped));
    if (helped) return RP_OK;
    return act(call, NULL);
}

void cli_say(const char *format, ...)
{
    char text[RP_MESSAGE];
    va_list args;
    va_start(args, format);
    rp_plain_print(text, format, args);
    va_end(args);
    fprintf(stderr, "%s\n", text);
}

/* ---- a program ---- */

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

int cli_main(const cli_program *program, int argc, char **argv)
{
    signal(SIGXFSZ, SIG_IGN); /* a file that reaches the limit of its size is a failed write */
    rp_arena arena = {.exhausted = exhausted};
    cli_call call = {.arena = &arena,
                     .program = program,
                     .out = stdout,
                     .line = line_of(&arena, program->name, argc, argv)};
    const bool named = argc > 1 && cli_find(program->commands, argv[1]);
    if (argc < 2) cli_overview(program, NULL, stderr);
    rp_status status = argc < 2 ? RP_USAGE : rp_build_check();
    if (!status) status = run_among(&call, NULL, argc, argv);
    /* a failed write is an error, and a failure has one message */
    if (!status) status = rp_file_finish(call.out, "standard output");
    if (status && argc > 1)
        cli_say("%s%s%s: %s", program->name, named ? " " : "", named ? argv[1] : "", rp_message());
    rp_arena_release(&arena, NULL);
    return (int)status;
}
