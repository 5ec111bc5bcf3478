/* Command-line options through a parameter schema; see cli.h. */
#include "cli/cli.h"

#include <getopt.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MAX_OPTIONS = 40 };

static bool given[MAX_OPTIONS]; /* of the command that was parsed last */

static const char *dashes(const rp_param *option)
{
    return strlen(option->name) == 1 ? "-" : "--";
}

static void print_help(const cli_command *c)
{
    printf("usage: repose %s %s\n\n%s\n\noptions:\n", c->name, c->synopsis, c->about);
    for (const rp_param *p = c->options; p->name; p++) {
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

rp_status cli_parse(const cli_command *command, int argc, char **argv, void *values, const char **arguments,
                    int *n_arguments, bool *done)
{
    struct option longs[MAX_OPTIONS + 2] = {{0}};
    char shorts[3 * MAX_OPTIONS] = ":";
    int n = 0;
    memset(given, 0, sizeof given);
    for (const rp_param *p = command->options; p->name && n < MAX_OPTIONS; p++, n++) {
        longs[n] =
            (struct option){p->name, p->type == RP_BOOL ? no_argument : required_argument, NULL, 256 + n};
        if (strlen(p->name) == 1) strcat(strcat(shorts, p->name), p->type == RP_BOOL ? "" : ":");
    }
    longs[n] = (struct option){"help", no_argument, NULL, 'h'};
    strcat(shorts, "h");
    rp_params_defaults(command->options, values);
    *done = false;
    *n_arguments = 0;
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
    for (int i = 0; i < n; i++)
        if (!command->options[i].fallback && !given[i])
            return rp_fail(RP_USAGE, "%s%s is required (%s); see repose %s --help",
                           dashes(&command->options[i]), command->options[i].name,
                           command->options[i].meaning, command->name);
    *n_arguments = argc - optind;
    if (*n_arguments < command->min_arguments || *n_arguments > command->max_arguments)
        return rp_fail(RP_USAGE, "usage: repose %s %s", command->name, command->synopsis);
    for (int i = 0; i < *n_arguments; i++) arguments[i] = argv[optind + i];
    return RP_OK;
}

bool cli_given(const cli_command *command, const char *name)
{
    int index = 0;
    while (strcmp(command->options[index].name, name) != 0) index++;
    return given[index];
}

rp_status cli_plain(const cli_command *command, int argc, char **argv, void *values,
                    rp_status (*act)(const void *values))
{
    int n;
    bool done;
    rp_status status = cli_parse(command, argc, argv, values, NULL, &n, &done);
    return status || done ? status : act(values);
}

rp_status cli_table_read(const cli_command *command, const void *values, const char *path, rp_table *table)
{
    const rp_param *where = rp_params_find(command->options, "where");
    rp_status status = rp_table_read(path, table);
    if (!where) return status;
    const rp_texts *conditions = (const rp_texts *)((const char *)values + where->offset);
    for (size_t i = 0; i < conditions->n && !status; i++)
        status = rp_table_where(table, conditions->items[i]);
    return status;
}

rp_status cli_with_table(const cli_command *command, int argc, char **argv, void *values,
                         rp_status (*act)(rp_table *table, const void *values))
{
    const char *file;
    int n;
    bool done;
    rp_table table;
    rp_status status = cli_parse(command, argc, argv, values, &file, &n, &done);
    if (status || done) return status;
    status = cli_table_read(command, values, file, &table);
    if (!status) status = act(&table, values);
    rp_table_free(&table);
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

rp_status cli_dispatch(const char *group, const cli_subcommand list[], int argc, char **argv)
{
    if (argc < 2) return rp_fail(RP_USAGE, "a command is missing; see repose %s --help", group);
    for (const cli_subcommand *c = list; c->name; c++)
        if (strcmp(argv[1], c->name) == 0) return c->function(argc - 1, argv + 1);
    if (strcmp(argv[1], "--help") != 0)
        return rp_fail(RP_USAGE, "unknown command \"%s\"; see repose %s --help", argv[1], group);
    printf("usage: repose %s COMMAND [options]; repose %s COMMAND --help says more\n\n", group, group);
    for (const cli_subcommand *c = list; c->name; c++) printf("  %-10s %s\n", c->name, c->summary);
    return RP_OK;
}
