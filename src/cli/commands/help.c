/* repose help: help on a command; the manual and completion of the shell, from the commands' own texts,
 * option lists and schemas. */
#include <string.h>

#include "cli/cli.h"
#include "core/version.h"
#include "dem/scene/scene.h"
#include "sweeps/engine/experiment.h"

#define HELP_OPTIONS(X)                                                                                      \
    X(BOOL, markdown, "", "false", "", "print the manual of all commands and keys in pandoc's Markdown")     \
    X(BOOL, completion, "", "false", "", "print the completion for bash")

CLI_OPTIONS(help, HELP_OPTIONS)

static const char about_data[] =
    "An example, sweep or table of the program, such as sweeps/lh/lh3.cfg, is looked for in the current\n"
    "folder first, then in the folder that the environment variable REPOSE_DATA names. If REPOSE_DATA is\n"
    "not set, that is ../share/repose, relative to the program's folder, or the source folder if the\n"
    "program is in its `build`.\n";

/* ---- manual, as pandoc's Markdown ---- */

/* n bytes of a text that stand as they are: marks of Markdown are escaped. */
static void put_part(FILE *out, const char *text, size_t n)
{
    for (const char *c = text; c < text + n; c++) {
        if (strchr("\\`*_{}[]<>#~^$@|+!&-", *c)) fputc('\\', out);
        fputc(*c, out);
    }
}

static void put(FILE *out, const char *text)
{
    put_part(out, text, strlen(text));
}

/* Lines that begin with a blank keep their form, the others are filled. */
static void put_lines(FILE *out, const char *text)
{
    bool kept = false;
    for (size_t n; *text; text += n + (text[n] == '\n')) {
        n = strcspn(text, "\n");
        if (n > 0 && kept != (*text == ' ')) kept = !kept, fputc('\n', out);
        if (kept)
            fprintf(out, "    %.*s", (int)n, text);
        else
            put_part(out, text, n);
        fputc('\n', out);
    }
    fputc('\n', out);
}

static void put_title(FILE *out, int depth, const char *before, const char *name)
{
    fprintf(out, "%.*s %s", depth, "###", before);
    put(out, name);
    fputs("\n\n", out);
}

static void put_item(FILE *out, const char *before, const char *name, const char *text)
{
    fprintf(out, "**%s", before);
    put(out, name);
    fputs("**\n:   ", out);
    put(out, text);
    fputs("\n\n", out);
}

/* Each parameter, and what each word of a choice stands for. */
static void put_schema(FILE *out, rp_arena *arena, const rp_param *schema)
{
    char word[64];
    for (const rp_param *p = schema; p->name; p++) {
        put_item(out, "", p->name, cli_option_text(arena, p));
        for (int k = 0; p->manual && *rp_word_at(p->range, k, word, sizeof word); k++) {
            fputs("    *", out);
            put(out, word);
            fputs("*: ", out);
            put(out, p->manual[k]);
            fputs("\n\n", out);
        }
    }
}

static void put_command(cli_call call, const cli_command *c)
{
    FILE *const out = call.out;
    put_title(out, 2, "repose ", c->name);
    if (c->group) {
        put(out, c->summary);
        fputs("\n\n", out);
        for (const cli_command *const *g = c->group; *g; g++) put_command(call, *g);
        return;
    }
    cli_options_of(&call, c);
    for (const char *line = c->synopsis, *end; *line; line = end + (*end == '\n')) {
        end = line + strcspn(line, "\n");
        fprintf(out, "**repose %s** ", c->name);
        put_part(out, line, (size_t)(end - line));
        fputs("\n\n", out);
    }
    put_lines(out, c->about);
    for (const rp_param *p = call.options; p->name; p++)
        put_item(out, strlen(p->name) == 1 ? "\\-" : "\\-\\-", p->name, cli_option_text(call.arena, p));
    fputs("Refuses: ", out);
    put_lines(out, c->refuses);
    fprintf(out, "Example:\n\n    %s\n\n", c->example);
}

static void put_protocol(FILE *out, rp_arena *arena, const sweep_protocol *p)
{
    put_title(out, 2, "Protocol ", p->name);
    put_lines(out, p->about);
    put_schema(out, arena, p->schema);
    put_title(out, 3, "Outputs of protocol ", p->name);
    for (const sweep_output *o = p->outputs; o->name; o++)
        put_item(out, "", o->name, rp_text(arena, "%s%s%s", o->meaning, *o->unit ? ", " : "", o->unit));
}

static rp_status print_manual(const cli_call *call)
{
    FILE *const out = call->out;
    const cli_program *program = call->program;
    fprintf(out,
            "%% REPOSE(1) Repose %s | User Commands\n\n# NAME\n\nrepose \\- %s\n\n# SYNOPSIS\n\n"
            "**repose** *COMMAND* [options]\n\n# COMMANDS\n\n",
            RP_VERSION, program->about);
    for (const cli_command *const *c = program->commands; *c; c++) put_command(*call, *c);
    put_title(out, 1, "", "KEYS OF A SCENE FILE");
    for (const dem_scene_group *g = dem_scene_schemas; g->name; g++) {
        put_title(out, 2, "", g->name);
        put_lines(out, g->manual);
        put_schema(out, call->arena, g->schema);
    }
    put_title(out, 1, "", "KEYS AND OUTPUTS OF A SWEEP'S PROTOCOL");
    for (const sweep_protocol *const *p = sweep_protocols; *p; p++) {
        const sweep_protocol *opened;
        const rp_status status = sweep_protocol_open(*p, NULL, NULL, &opened);
        if (!status) put_protocol(out, call->arena, opened);
        sweep_protocol_close(opened);
        RP_TRY(status);
    }
    put_title(out, 1, "", "EXIT STATUS");
#define X(name, code, text) put_item(out, "", #code, text);
    RP_STATUS_LIST(X)
#undef X
    put_title(out, 1, "", "FILES");
    put_lines(out, about_data);
    return RP_OK;
}

/* ---- completion ---- */

/* What follows the words typed so far, which are a pattern of bash's `case`. The values of an option come
 * before the options, and commands before their group. */
static void complete(cli_call call, const cli_command *c)
{
    if (c->group) {
        for (const cli_command *const *g = c->group; *g; g++) complete(call, *g);
        fprintf(call.out, "    '%s ') words='", c->name);
        for (const cli_command *const *g = c->group; *g; g++) fprintf(call.out, "%s ", cli_own_name(*g));
        fputs(*c->name ? "--help' ;;\n" : "--help --version' ;;\n", call.out);
        return;
    }
    cli_options_of(&call, c);
    for (const rp_param *p = call.options; p->name; p++) {
        if (p->type == RP_BOOL) continue;
        fprintf(call.out, "    '%s'*' %s%s ') words='", c->name, cli_dashes(p), p->name);
        for (const char *r = p->type == RP_CHOICE ? p->range : ""; *r; r++)
            if (*r != '|') fputc(*r, call.out);
        fputs("' ;;\n", call.out);
    }
    fprintf(call.out, "    '%s '*) words='", c->name);
    if (c == &cmd_help)
        for (const cli_command *const *g = call.program->commands; *g; g++)
            fprintf(call.out, "%s ", (*g)->name);
    for (const rp_param *p = call.options; p->name; p++) fprintf(call.out, "%s%s ", cli_dashes(p), p->name);
    fputs("--help' ;;\n", call.out);
}

static void print_completion(const cli_call *call)
{
    const cli_command all = {.name = "", .group = call->program->commands};
    fputs("# Completion of repose, from `repose help --completion`; names of files where no word fits.\n"
          "_repose()\n{\n    local words=\n    case \"${COMP_WORDS[*]:1:COMP_CWORD-1} \" in\n",
          call->out);
    complete(*call, &all);
    fputs("    esac\n"
          "    mapfile -t COMPREPLY < <(compgen -W \"$words\" -- \"${COMP_WORDS[COMP_CWORD]}\")\n}\n"
          "complete -o bashdefault -o default -F _repose repose\n",
          call->out);
}

/* ---- help ---- */

/* Help of the command that the arguments name, word by word; or what the summary of this one names. */
static rp_status help_on(cli_call call)
{
    const cli_command *found = NULL;
    char option[] = "--help";
    if (strcmp(*call.arguments, "manual") == 0 && !call.arguments[1]) return print_manual(&call);
    if (strcmp(*call.arguments, "completion") == 0 && !call.arguments[1])
        return print_completion(&call), RP_OK;
    for (char *const *word = call.arguments; *word; word++) {
        const cli_command *const *among = found ? found->group : call.program->commands,
                                 *next = among ? cli_find(among, *word) : NULL;
        if (!next) return cli_unknown_command(call.program, *word, found);
        found = next;
    }
    return cli_run(&call, found, 2, (char *[]){option, option, NULL});
}

static rp_status act_help(cli_call *call, const void *values)
{
    const help_options *o = values;
    if (cli_argument(call, 0)) return help_on(*call);
    if (o->markdown) return print_manual(call);
    if (o->completion) return print_completion(call), RP_OK;
    cli_overview(call->program, NULL, call->out);
    fprintf(call->out, "\n%s", about_data);
    return RP_OK;
}

const cli_command cmd_help = {
    "help",
    "print the help of a command; --markdown: the manual; --completion: for bash",
    "[COMMAND...] [--markdown | --completion]",
    "Prints the help of a command. Without a command, it prints the list of commands, and where the program "
    "looks for its own files. --markdown prints the manual of all commands, keys of scene files, and "
    "parameters and outputs of protocols; pandoc makes a manual page or a web page of it. --completion "
    "prints the completion for bash, which `source` reads; `make install` installs it.",
    "repose help sweep plan",
    help_params,
    .refuses = "A name that is no command; the message names the nearest one.",
    .act = act_help};
