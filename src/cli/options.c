/* Command-line options through a parameter schema; see cli.h. */
#include "cli/cli.h"

#include <ctype.h>
#include <getopt.h>
#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

enum { MAX_OPTIONS = 40 };

/* Of the command line that was parsed last. */
static bool given[MAX_OPTIONS];
static const cli_command *parsed;
static int n_arguments;
static char *const *arguments;

static const char *dashes(const rp_param *option)
{
    return strlen(option->name) == 1 ? "-" : "--";
}

static void print_help(const cli_command *c)
{
    printf("usage: repose %s %s\n\n%s\n\noptions:\n", c->name, c->synopsis, c->about);
    for (const rp_param *p = c->options; p && p->name; p++) {
        char flag[40];
        snprintf(flag, sizeof flag, "%s%s", dashes(p), p->name);
        printf("  %-22s %s", flag, p->meaning);
        if (*p->unit) printf(", %s", p->unit);
        if (p->range && *p->range) printf("; %s", p->range);
        if (!p->fallback)
            printf(" (required)");
        else if (*p->fallback && p->type != RP_BOOL)
            printf(" (default %s)", p->fallback);
        putchar('\n');
    }
    printf("  %-22s this text\n\nexample:\n  %s\n", "--help", c->example);
}

static rp_status set_option(const rp_param *param, void *values, const char *text)
{
    rp_status status = rp_params_set_text(param, values, param->type == RP_BOOL ? "true" : text);
    return status ? rp_prefix(status, "%s", dashes(param)) : RP_OK;
}

/* Fewest and most arguments, from the synopsis. */
static bool count_fits(const char *synopsis, int n)
{
    const bool optional = *synopsis == '[';
    const char *word = synopsis + optional;
    if (!isupper(*word)) return n == 0;
    return (optional || n > 0) && (n <= 1 || word[strcspn(word, " .")] == '.');
}

static rp_status check_given(const cli_command *c)
{
    for (int i = 0; c->options && c->options[i].name; i++)
        if (!c->options[i].fallback && !given[i])
            return rp_fail(RP_USAGE, "%s%s is required (%s); see repose %s --help", dashes(&c->options[i]),
                           c->options[i].name, c->options[i].meaning, c->name);
    return count_fits(c->synopsis, n_arguments)
               ? RP_OK
               : rp_fail(RP_USAGE, "usage: repose %s %s", c->name, c->synopsis);
}

static rp_status parse(const cli_command *command, int argc, char **argv, void *values, bool *done)
{
    struct option longs[MAX_OPTIONS + 2] = {{0}};
    char shorts[3 * MAX_OPTIONS] = ":";
    int n = 0;
    memset(given, 0, sizeof given);
    parsed = command;
    for (const rp_param *p = command->options; p && p->name && n < MAX_OPTIONS; p++, n++) {
        longs[n] =
            (struct option){p->name, p->type == RP_BOOL ? no_argument : required_argument, NULL, 256 + n};
        if (strlen(p->name) == 1) strcat(strcat(shorts, p->name), p->type == RP_BOOL ? "" : ":");
    }
    longs[n] = (struct option){"help", no_argument, NULL, 'h'};
    strcat(shorts, "h");
    if (command->options) rp_params_defaults(command->options, values);
    optind = 0; /* reset the parser (glibc) */
    opterr = 0;
    for (int c; (c = getopt_long(argc, argv, shorts, longs, NULL)) != -1;) {
        if (c == 'h') {
            print_help(command);
            *done = true;
            return RP_OK;
        }
        if (c == '?') {
            /* a letter within a group: getopt has not passed its word yet */
            const char letter[] = {'-', (char)optopt, '\0'};
            return rp_fail(RP_USAGE, "unknown option %s; see repose %s --help",
                           optopt > 0 && optopt < 256 ? letter : argv[optind - 1], command->name);
        }
        if (c == ':')
            return rp_fail(RP_USAGE, "option %s needs a value; see repose %s --help", argv[optind - 1],
                           command->name);
        int index = c - 256;
        if (c < 256)
            for (index = 0; command->options[index].name[0] != c || command->options[index].name[1]; index++)
                continue;
        given[index] = true;
        rp_status status = set_option(&command->options[index], values, optarg);
        if (status) return status;
    }
    n_arguments = argc - optind;
    arguments = argv + optind;
    return check_given(command);
}

const char *cli_argument(int i)
{
    return i < n_arguments ? arguments[i] : NULL;
}

char *const *cli_arguments(void)
{
    return arguments;
}

bool cli_given(const char *name)
{
    int index = 0;
    while (strcmp(parsed->options[index].name, name) != 0) index++;
    return given[index];
}

rp_status cli_table_read(const cli_command *command, const void *values, const char *path, rp_table *table)
{
    const rp_param *where = command->options ? rp_params_find(command->options, "where") : NULL;
    rp_status status = rp_table_read(path, table);
    if (!where) return status;
    const rp_texts *conditions = (const rp_texts *)((const char *)values + where->offset);
    for (size_t i = 0; i < conditions->n && !status; i++)
        status = rp_table_where(table, conditions->items[i]);
    return status;
}

void cli_table(FILE *out, const rp_param *schema, const void *values)
{
    char text[256];
    rp_table_provenance(out, cli_command_line());
    for (; schema && schema->name; schema++)
        if (schema->type != RP_TEXT && schema->type != RP_TEXTS)
            rp_table_note(out, schema->name, "%s%s%s", rp_params_text(schema, values, text, sizeof text),
                          *schema->unit ? " " : "", schema->unit);
}

rp_status cli_numbers(const char *option, const char *text, double **numbers, size_t *n)
{
    *n = 1;
    for (const char *p = text; *p; p++) *n += *p == ',';
    *numbers = malloc(*n * sizeof **numbers);
    if (!*numbers) return rp_fail(RP_NO_MEMORY, "%s: out of memory", option);
    for (size_t i = 0; i < *n; i++) {
        char *end;
        (*numbers)[i] = strtod(text, &end);
        if (end == text || (*end && *end != ',') || !isfinite((*numbers)[i])) {
            free(*numbers);
            *numbers = NULL;
            return rp_fail(RP_BAD_INPUT, "%s: \"%.40s\": numbers separated by commas expected", option, text);
        }
        text = end + (*end == ',');
    }
    return RP_OK;
}

static rp_status read_positions(const char *text, double **x, size_t *n)
{
    rp_status status = cli_numbers("--at", text, x, n);
    for (size_t i = 0; !status && i < *n; i++)
        if ((*x)[i] < 0 || (*x)[i] > 1) {
            status = rp_fail(RP_BAD_INPUT, "--at: x/B = %.15g: out of range, allowed: [0, 1]", (*x)[i]);
            free(*x);
            *x = NULL;
        }
    return status;
}

rp_status cli_positions_read(const cli_positions *asked, double **x, size_t *n)
{
    bool listed = strcmp(asked->at, "auto") != 0;
    if (listed && asked->points > 0) return rp_fail(RP_USAGE, "give --points or --at, not both");
    if (listed) return read_positions(asked->at, x, n);
    *n = asked->points > 0 ? (size_t)asked->points : 201;
    *x = malloc(*n * sizeof **x);
    if (!*x) return rp_fail(RP_NO_MEMORY, "--points %zu: out of memory", *n);
    for (size_t i = 0; i < *n; i++) (*x)[i] = (double)i / (double)(*n - 1);
    return RP_OK;
}

static rp_status act_on_table(const cli_command *command, const void *values)
{
    rp_table table;
    rp_status status = cli_table_read(command, values, cli_argument(0), &table);
    if (!status) status = command->on_table(&table, values);
    rp_table_free(&table);
    return status;
}

/* The last word of a command's name is the one to type. */
static const char *own_name(const cli_command *c)
{
    const char *blank = strrchr(c->name, ' ');
    return blank ? blank + 1 : c->name;
}

static rp_status run_of_group(const cli_command *group, int argc, char **argv)
{
    if (argc < 2) return rp_fail(RP_USAGE, "a command is missing; see repose %s --help", group->name);
    for (const cli_command *const *c = group->group; *c; c++)
        if (strcmp(argv[1], own_name(*c)) == 0) return cli_run(*c, argc - 1, argv + 1);
    if (strcmp(argv[1], "--help") != 0)
        return rp_fail(RP_USAGE, "unknown command \"%s\"; see repose %s --help", argv[1], group->name);
    printf("usage: repose %s COMMAND [options]; repose %s COMMAND --help says more\n\n", group->name,
           group->name);
    for (const cli_command *const *c = group->group; *c; c++)
        printf("  %-10s %s\n", own_name(*c), (*c)->summary);
    return RP_OK;
}

rp_status cli_run(const cli_command *command, int argc, char **argv)
{
    enum { MOST_BYTES = 4096 };
    _Alignas(max_align_t) char values[MOST_BYTES] = {0};
    bool done = false;
    if (command->run) return command->run(argc, argv);
    if (command->group) return run_of_group(command, argc, argv);
    for (const rp_param *p = command->options; p && p->name; p++)
        if (p->offset + sizeof(rp_texts) > MOST_BYTES)
            return rp_fail(RP_BROKEN, "repose %s: values of more than %d bytes", command->name, MOST_BYTES);
    rp_status status = parse(command, argc, argv, values, &done);
    if (status || done) return status;
    return command->on_table ? act_on_table(command, values) : command->act(values);
}
