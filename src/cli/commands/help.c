/* repose help: help on a command; manual pages and completion of the shell, from the commands' own texts,
 * option lists and schemas. */
#include <string.h>

#include "cli/command.h"
#include "core/version.h"
#include "dem/scene/scene.h"

#define HELP_OPTIONS(X)                                                                                      \
    X(TEXT, man, "", "", "", "folder that gets the manual pages, one per command")                           \
    X(BOOL, completion, "", "false", "", "print the completion of bash")

CLI_OPTIONS(help, HELP_OPTIONS)

static const char about_data[] =
    "An example, sweep or table that the program brings along, as sweeps/lh/lh3.cfg, is looked for in the\n"
    "current folder first. Then comes the folder that REPOSE_DATA names. Where REPOSE_DATA is not set, it\n"
    "is\n"
    "../share/repose beside the program, or the source that the program was built in.\n";

/* ---- manual pages ---- */

/* Text for troff: dashes to be copied, no requests. */
static void put(FILE *out, const char *text)
{
    if (*text == '.' || *text == '\'') fputs("\\&", out);
    for (; *text; text++) {
        if (*text == '\\')
            fputs("\\e", out);
        else if (*text == '-')
            fputs("\\-", out);
        else
            fputc(*text, out);
    }
}

static void put_line(FILE *out, const char *request, const char *text)
{
    fputs(request, out);
    put(out, text);
    fputc('\n', out);
}

/* Lines that begin with a blank keep their form, the others are filled. */
static void put_lines(FILE *out, const char *text)
{
    bool kept = false;
    for (const char *line = text, *end; *line; line = *end ? end + 1 : end) {
        char copy[1024];
        end = line + strcspn(line, "\n");
        snprintf(copy, sizeof copy, "%.*s", (int)(end - line), line);
        if (*copy && kept != (*copy == ' ')) {
            kept = !kept;
            fputs(kept ? ".nf\n" : ".fi\n", out);
        }
        put_line(out, "", *copy ? copy : kept ? " " : "\n.PP");
    }
    if (kept) fputs(".fi\n", out);
}

static void put_item(FILE *out, const char *dashes, const char *name, const char *text)
{
    fputs(".TP\n.B ", out);
    put(out, dashes);
    put_line(out, "", name);
    put_line(out, "", text);
}

static void put_schema(FILE *out, const char *title, const char *name, const rp_param *schema)
{
    char text[1024];
    fprintf(out, ".SS %s %s\n", title, name);
    for (const rp_param *p = schema; p->name; p++)
        put_item(out, "", p->name, cli_option_text(p, text, sizeof text));
}

/* Keys of scene files and sweeps. */
static void put_schemas(FILE *out)
{
    fputs(".SH KEYS\n", out);
    for (const dem_scene_group *g = dem_scene_schemas; g->name; g++)
        put_schema(out, "Scene file:", g->name, g->schema);
    for (const sweep_protocol *const *p = sweep_protocols; *p; p++) {
        put_schema(out, "Protocol", (*p)->name, (*p)->schema);
        fprintf(out, ".SS Outputs of protocol %s\n", (*p)->name);
        for (const sweep_output *o = (*p)->outputs; o->name; o++) {
            char text[1024];
            snprintf(text, sizeof text, "%s%s%s", o->meaning, *o->unit ? ", " : "", o->unit);
            put_item(out, "", o->name, text);
        }
    }
}

static void put_head(FILE *out, const char *page, const char *summary)
{
    fprintf(out, ".TH %s 1 \"\" \"Repose %s\" \"User Commands\"\n.SH NAME\n", page, RP_VERSION);
    put(out, page);
    put_line(out, " \\- ", summary);
    fputs(".SH SYNOPSIS\n.B repose", out);
}

/* "repose-sweep-plan", the page of "sweep plan". */
static void page_name(const cli_command *c, char page[64])
{
    snprintf(page, 64, "repose-%s", c->name);
    for (char *blank; (blank = strchr(page, ' '));) *blank = '-';
}

static void put_command(cli_call call, FILE *out, const cli_command *c)
{
    char text[1024];
    cli_options_of(&call, c);
    put_line(out, " ", c->name);
    put_line(out, "", c->synopsis);
    fputs(".SH DESCRIPTION\n", out);
    put_lines(out, c->about);
    fputs(".SH OPTIONS\n", out);
    for (const rp_param *p = call.options; p->name; p++)
        put_item(out, cli_dashes(p), p->name, cli_option_text(p, text, sizeof text));
    put_item(out, "--", "help", "this text");
    if (c == &cmd_params) put_schemas(out);
    fputs(".SH EXAMPLE\n.nf\n", out);
    put_line(out, "", c->example);
    fputs(".fi\n", out);
}

static rp_status write_page(const cli_call *call, const char *folder, const cli_command *c);

static rp_status put_group(const cli_call *call, FILE *out, const char *folder,
                           const cli_command *const *group)
{
    fputs(".SH COMMANDS\n", out);
    for (; *group; group++) {
        char page[64];
        page_name(*group, page);
        fputs(".TP\n.BR ", out);
        put(out, page);
        put_line(out, " (1)\n", (*group)->summary);
        RP_TRY(write_page(call, folder, *group));
    }
    return RP_OK;
}

static rp_status write_page(const cli_call *call, const char *folder, const cli_command *c)
{
    char path[4096], page[64];
    FILE *out;
    page_name(c, page);
    snprintf(path, sizeof path, "%s/%s.1", folder, page);
    rp_status status = RP_OK;
    RP_TRY(rp_file_open(path, &out));
    put_head(out, page, c->summary);
    if (c->group) {
        put_line(out, " ", c->name);
        fputs(".I COMMAND\n[options]\n", out);
        status = put_group(call, out, folder, c->group);
    } else {
        put_command(*call, out, c);
    }
    fputs(".SH SEE ALSO\n.BR repose (1)\n", out);
    return rp_file_close(path, out, status);
}

static rp_status write_manual(const cli_call *call, const char *folder)
{
    char path[4096];
    FILE *out;
    snprintf(path, sizeof path, "%s/repose.1", folder);
    RP_TRY(rp_make_directory(folder));
    RP_TRY(rp_file_open(path, &out));
    put_head(out, "repose", call->program->about);
    fputs("\n.I COMMAND\n[options]\n", out);
    rp_status status = put_group(call, out, folder, call->program->commands);
    fputs(".SH EXIT STATUS\n", out);
#define X(name, code, text) put_item(out, "", #code, text);
    RP_STATUS_LIST(X)
#undef X
    fputs(".SH FILES\n", out);
    put_lines(out, about_data);
    return rp_file_close(path, out, status);
}

/* ---- completion ---- */

/* What follows the words typed so far, which are a pattern of bash's `case`. The values of an option come
 * before the options, and commands before their group. */
static void complete(cli_call call, const cli_command *c)
{
    if (c->group) {
        for (const cli_command *const *g = c->group; *g; g++) complete(call, *g);
        printf("    '%s ') words='", c->name);
        for (const cli_command *const *g = c->group; *g; g++) printf("%s ", cli_own_name(*g));
        puts("--help' ;;");
        return;
    }
    cli_options_of(&call, c);
    for (const rp_param *p = call.options; p->name; p++) {
        if (p->type == RP_BOOL) continue;
        printf("    '%s'*' %s%s ') words='", c->name, cli_dashes(p), p->name);
        for (const char *r = p->type == RP_CHOICE || p->type == RP_FLAGS ? p->range : ""; *r; r++)
            if (*r != '|') putchar(*r);
        puts("' ;;");
    }
    printf("    '%s '*) words='", c->name);
    if (c == &cmd_help)
        for (const cli_command *const *g = call.program->commands; *g; g++) printf("%s ", (*g)->name);
    for (const rp_param *p = call.options; p->name; p++) printf("%s%s ", cli_dashes(p), p->name);
    puts("--help' ;;");
}

static void print_completion(const cli_call *call)
{
    puts("# Completion of repose, from `repose help --completion`; names of files where no word fits.\n"
         "_repose()\n{\n    local words=\n    case \"${COMP_WORDS[*]:1:COMP_CWORD-1} \" in");
    for (const cli_command *const *c = call->program->commands; *c; c++) complete(*call, *c);
    fputs("    ' ') words='", stdout);
    for (const cli_command *const *c = call->program->commands; *c; c++) printf("%s ", (*c)->name);
    puts("--help --version' ;;\n    esac\n"
         "    mapfile -t COMPREPLY < <(compgen -W \"$words\" -- \"${COMP_WORDS[COMP_CWORD]}\")\n}\n"
         "complete -o bashdefault -o default -F _repose repose");
}

/* ---- help ---- */

/* Help of the command that the arguments name, word by word. */
static rp_status help_on(cli_call call)
{
    const cli_command *const *among = call.program->commands, *found = NULL;
    static const cli_command *const none[] = {NULL};
    char option[] = "--help";
    for (char *const *word = call.arguments; *word; word++) {
        const cli_command *next = cli_find(among, *word);
        if (!next) return cli_unknown_command(call.program, *word, found);
        found = next;
        among = found->group ? found->group : none;
    }
    return cli_run(&call, found, 2, (char *[]){option, option, NULL});
}

static rp_status act_help(cli_call *call, const void *values)
{
    const help_options *o = values;
    if (*o->man) return write_manual(call, o->man);
    if (cli_argument(call, 0)) return help_on(*call);
    if (o->completion) {
        print_completion(call);
        return RP_OK;
    }
    cli_overview(call->program, stdout);
    printf("\n%s", about_data);
    return RP_OK;
}

const cli_command cmd_help = {
    "help",
    "help on a command; manual pages, completion of the shell",
    "[COMMAND...] [--man DIR | --completion]",
    "Prints the help of a command, or without one the list of commands and where the program's own files\n"
    "are looked for. --man writes a manual page per command into a folder; --completion prints the\n"
    "completion of bash, to be read by `source`. `make install` installs both.",
    "repose help sweep plan",
    help_params,
    .prints_text = true,
    .act = act_help};
