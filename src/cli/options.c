/* Options of a command through its parameter schema, and its help; see cli.h. */
#include <ctype.h>
#include <getopt.h>
#include <stdlib.h>
#include <string.h>

#include "cli/cli.h"
#include "params/guess.h"

const char *cli_dashes(const rp_param *option)
{
    return strlen(option->name) == 1 ? "-" : "--";
}

const char *cli_option_text(rp_arena *arena, const rp_param *p)
{
    const char *separator = p->range && *p->range ? "; " : "", *open = "", *close = "";
    const bool known = p->fallback && *p->fallback && p->type != RP_BOOL;
    if (known) open = " (default ", close = ")";
    if (!p->fallback) open = " (required)";
    const int said = (int)strcspn(p->meaning, ";"); /* what it is, then its unit, then what its words mean */
    return rp_text(arena, "%.*s%s%s%s%s%s%s%s%s%s", said, p->meaning, *p->unit ? " [" : "", p->unit,
                   *p->unit ? "]" : "", p->meaning + said, separator, *separator ? p->range : "", open,
                   known ? p->fallback : "", close);
}

const char *cli_own_name(const cli_command *c)
{
    const char *blank = strrchr(c->name, ' ');
    return blank ? blank + 1 : c->name;
}

/* ---- help ---- */

enum { WIDTH = 80 };

/* Words of a text from column `at` on, further lines from column `indent` on. */
static int print_words(FILE *out, const char *text, size_t n, int at, int indent)
{
    for (const char *word = text; word < text + n;) {
        const int length = (int)strcspn(word, " \n");
        if (at > indent && at + 1 + length > WIDTH)
            fprintf(out, "\n%*s", at = indent, "");
        else if (word > text)
            fputc(' ', out), at++;
        fprintf(out, "%.*s", length, word);
        at += length;
        word += length + strspn(word + length, " \n");
    }
    return at;
}

/* Paragraphs are filled; lines that begin with a blank keep their form. */
static void print_about(FILE *out, const char *text)
{
    for (const char *p = text; *p;) {
        const char *end = p + strcspn(p, "\n");
        while (*p != ' ' && *p != '\n' && *end && end[1] != '\n' && end[1] != ' ')
            end += 1 + strcspn(end + 1, "\n");
        if (*p == ' ')
            fprintf(out, "%.*s", (int)(end - p), p);
        else
            print_words(out, p, (size_t)(end - p), 0, 0);
        fputc('\n', out);
        p = end + (*end == '\n');
    }
}

/* Lines, each filled and begun with these words; from the second on the first of them is blank. */
static void print_lines(FILE *out, const char *text, const char *first, const char *second)
{
    const int indent = (int)strlen(first);
    for (const char *line = text; *line; first = "") {
        const size_t n = strcspn(line, "\n");
        print_words(out, line, n, fprintf(out, "%-*s%s", indent, first, second), indent + (*second ? 4 : 2));
        fputc('\n', out);
        line += n + (line[n] == '\n');
    }
}

static void print_help(const cli_call *call)
{
    const cli_command *c = call->command;
    print_lines(call->out, c->synopsis,
                "usage: ", rp_text(call->arena, "%s %s ", call->program->name, c->name));
    fputc('\n', call->out);
    print_about(call->out, c->about);
    fputs("\noptions:\n", call->out);
    for (const rp_param *p = call->options; p->name; p++) {
        const char *text = cli_option_text(call->arena, p);
        fprintf(call->out, "  %-22s ", rp_text(call->arena, "%s%s", cli_dashes(p), p->name));
        print_words(call->out, text, strlen(text), 25, 25);
        fputc('\n', call->out);
    }
    fprintf(call->out, "  %-22s this text\n\n", "--help");
    fputs("refuses:\n", call->out);
    print_lines(call->out, c->refuses, "  ", "");
    fprintf(call->out, "\nexample:\n  %s\n", c->example);
}

/* ---- the options of a command ---- */

/* Room for the values of a schema. */
static size_t size_of(const rp_param *schema)
{
    size_t size = 0;
    for (const rp_param *p = schema; p && p->name; p++)
        if (p->offset + sizeof(rp_texts) > size) size = p->offset + sizeof(rp_texts);
    return (size / sizeof(max_align_t) + 1) * sizeof(max_align_t);
}

static size_t count(const rp_param *schema)
{
    size_t n = 0;
    while (schema && schema[n].name) n++;
    return n;
}

void cli_options_of(cli_call *call, const cli_command *command)
{
    const rp_param *const lists[] = {command->protocol, command->options ? command->options() : NULL};
    const size_t at[] = {0, command->protocol_size};
    size_t n = 0;
    for (size_t k = 0; k < N_OF(lists); k++) n += count(lists[k]);
    call->command = command;
    call->options = rp_arena_memory(call->arena, n, sizeof *call->options);
    call->given = rp_arena_memory(call->arena, n, sizeof *call->given);
    call->values = rp_arena_memory(call->arena, at[1] + size_of(lists[1]), 1);
    rp_param *to = call->options;
    for (size_t k = 0; k < N_OF(lists); k++)
        for (const rp_param *p = lists[k]; p && p->name; p++, to++) {
            char *name = rp_text(call->arena, "%s", p->name); /* with dashes for underlines */
            for (char *c = name; (c = strchr(c, '_'));) *c = '-';
            *to = *p;
            to->name = name;
            to->offset += at[k];
        }
    rp_params_defaults(call->options, RP_CGS, call->values);
}

/* ---- the command line ---- */

/* Do so many arguments go with a line of the synopsis? */
static bool count_fits(const char *line, int n)
{
    const bool optional = *line == '[';
    const char *word = line + optional, *next = strchr(line, '\n');
    const bool many = strncmp(word + strcspn(word, " ."), "...", 3) == 0;
    const bool fits = !isupper(*word) ? n == 0 : (optional || n > 0) && (n <= 1 || many);
    return fits || (next && count_fits(next + 1, n));
}

static rp_status check_given(const cli_call *call)
{
    const cli_command *c = call->command;
    for (size_t i = 0; call->options[i].name; i++)
        if (!call->options[i].fallback && !call->given[i])
            return rp_fail(RP_USAGE, "%s%s is required (%s); see %s %s --help", cli_dashes(&call->options[i]),
                           call->options[i].name, call->options[i].meaning, call->program->name, c->name);
    for (int i = 1; i < call->n_arguments; i++) /* it would count twice */
        for (int k = 0; k < i; k++)
            if (strcmp(call->arguments[i], call->arguments[k]) == 0)
                return rp_fail(RP_USAGE, "%s: given twice", call->arguments[i]);
    if (count_fits(c->synopsis, call->n_arguments)) return RP_OK;
    rp_status status = rp_fail(RP_USAGE, "usage: %s %s %.*s; see %s %s --help", call->program->name, c->name,
                               (int)strcspn(c->synopsis, "\n"), c->synopsis, call->program->name, c->name);
    for (int n = call->n_arguments - 1; n >= 0; n--)
        if (count_fits(c->synopsis, n))
            return rp_prefix(status, "\"%s\": one argument too many; ", call->arguments[n]);
    return status;
}

/* An option that is written with too few or too many dashes is found as well. */
static rp_status unknown_option(const cli_call *call, const char *text)
{
    char word[64], nearest[96] = "";
    const char *name = text + strspn(text, "-");
    snprintf(word, sizeof word, "%.*s", (int)strcspn(name, "="), name);
    rp_guess guess = rp_guess_of(word);
    rp_guess_schema(&guess, call->options);
    rp_guess_try(&guess, "help");
    if (*guess.nearest)
        snprintf(nearest, sizeof nearest, " (did you mean %s%s?)", strlen(guess.nearest) == 1 ? "-" : "--",
                 guess.nearest);
    return rp_fail(RP_USAGE, "unknown option %s%s; see %s %s --help", text, nearest, call->program->name,
                   call->command->name);
}

/* getopt's letters and words for the options, and --help. */
static const char *letters_of(const cli_call *call, struct option longs[])
{
    size_t n = 0;
    for (; call->options[n].name; n++) {
        const rp_param *p = &call->options[n];
        longs[n] = (struct option){p->name, p->type == RP_BOOL ? no_argument : required_argument, NULL,
                                   256 + (int)n};
    }
    longs[n] = (struct option){"help", no_argument, NULL, 'h'};
    char *letters = strcpy(rp_arena_memory(call->arena, 2 * n + 3, 1), ":h");
    for (const rp_param *p = call->options; p->name; p++)
        if (strlen(p->name) == 1) strcat(strcat(letters, p->name), p->type == RP_BOOL ? "" : ":");
    return letters;
}

rp_status cli_parse(cli_call *call, const cli_command *command, int argc, char **argv, bool *helped)
{
    cli_options_of(call, command);
    struct option *longs = rp_arena_memory(call->arena, count(call->options) + 1, sizeof *longs);
    const char *letters = letters_of(call, longs);
    rp_status status = RP_OK;
    *helped = false;
    optind = 0; /* reset the parser (glibc) */
    opterr = 0;
    for (int c; !status && (c = getopt_long(argc, argv, letters, longs, NULL)) != -1;) {
        const char letter[] = {'-', (char)(c == '?' ? optopt : c), '\0'};
        if (c == 'h') {
            print_help(call);
            *helped = true;
            return RP_OK;
        }
        if (c == '?') /* a letter within a group: getopt has not passed its word yet */
            return unknown_option(call, optopt > 0 && optopt < 256 ? letter : argv[optind - 1]);
        if (c == ':')
            return rp_fail(RP_USAGE, "option %s needs a value; see %s %s --help", argv[optind - 1],
                           call->program->name, command->name);
        const rp_param *p = c < 256 ? rp_params_find(call->options, letter + 1) : &call->options[c - 256];
        if (p->type == RP_TEXT && !*optarg && (!p->fallback || !*p->fallback)) /* as of -o "$unset" */
            return rp_fail(RP_USAGE, "%s%s is empty; leave it out, or give a value", cli_dashes(p), p->name);
        call->given[p - call->options] = true;
        status = rp_params_set_text(p, RP_CGS, call->values, p->type == RP_BOOL ? "true" : optarg);
        rp_prefix(status, "%s", cli_dashes(p));
    }
    call->n_arguments = argc - optind;
    call->arguments = argv + optind;
    return status ? status : check_given(call);
}
