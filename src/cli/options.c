/* The command line: options through a parameter schema, groups of commands; see cli.h. */
#include "export/export.h"

#include <ctype.h>
#include <getopt.h>
#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include "params/guess.h"
#include "params/units.h"

enum { MAX_OPTIONS = 40, MAX_NAME = 32, MOST_BYTES = 4096, GENERIC_AT = MOST_BYTES };

/* Options of every command that prints a table. */
#define GENERIC_OPTIONS(X)                                                                                   \
    X(BOOL, json, "", "false", "",                                                                           \
      "print the table as JSON: header lines, units, and rows as objects; nan as null")
CLI_OPTIONS(generic, GENERIC_OPTIONS)

/* The command line that was parsed last. */
static struct {
    const cli_command *command;
    size_t n_options;
    rp_param options[MAX_OPTIONS + 1]; /* with names as they are typed */
    char names[MAX_OPTIONS][MAX_NAME];
    bool given[MAX_OPTIONS];
    _Alignas(max_align_t) char values[MOST_BYTES + sizeof(generic_options)];
    int n_arguments;
    char *const *arguments;
} line;

const char *cli_dashes(const rp_param *option)
{
    return strlen(option->name) == 1 ? "-" : "--";
}

const char *cli_option_text(const rp_param *p, char *text, size_t size)
{
    const bool range = p->range && *p->range, known = p->fallback && *p->fallback && p->type != RP_BOOL;
    snprintf(text, size, "%s%s%s%s%s%s%s%s", p->meaning, *p->unit ? ", " : "", p->unit, range ? "; " : "",
             range ? p->range : "",
             known         ? " (default "
             : p->fallback ? ""
                           : " (required",
             known ? p->fallback : "", known || !p->fallback ? ")" : "");
    return text;
}

/* COLUMNS, or the width of the terminal, or 80; no line that is easy to read has more than 110. */
static int help_width(void)
{
    struct winsize size = {0};
    const char *columns = getenv("COLUMNS");
    long width = columns ? strtol(columns, NULL, 10) : 0;
    if (width <= 0 && ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0) width = size.ws_col;
    return width <= 0 ? 80 : (int)fmin(fmax((double)width, 60.0), 110.0);
}

/* Words of a text from column `at` on, further lines from column `indent` on. */
static int print_words(const char *text, size_t n, int at, int indent)
{
    const int width = help_width();
    for (const char *word = text; word < text + n;) {
        const int length = (int)strcspn(word, " \n");
        if (at > indent && at + 1 + length > width)
            printf("\n%*s", at = indent, "");
        else if (word > text)
            putchar(' '), at++;
        printf("%.*s", length, word);
        at += length;
        word += length + strspn(word + length, " \n");
    }
    return at;
}

/* Paragraphs are filled; lines that begin with a blank keep their form. */
static void print_about(const char *text)
{
    for (const char *p = text; *p;) {
        const char *end = p + strcspn(p, "\n");
        while (*p != ' ' && *p != '\n' && *end && end[1] != '\n' && end[1] != ' ')
            end += 1 + strcspn(end + 1, "\n");
        if (*p == ' ')
            printf("%.*s", (int)(end - p), p);
        else
            print_words(p, (size_t)(end - p), 0, 0);
        putchar('\n');
        p = end + (*end == '\n');
    }
}

static void print_help(const cli_command *c)
{
    const int at = printf("usage: %s %s ", cli_this_program()->name, c->name);
    print_words(c->synopsis, strlen(c->synopsis), at, 7);
    puts("\n");
    print_about(c->about);
    puts("\noptions:");
    for (const rp_param *p = line.options; p->name; p++) {
        char flag[40], text[1024];
        snprintf(flag, sizeof flag, "%s%s", cli_dashes(p), p->name);
        printf("  %-22s ", flag);
        cli_option_text(p, text, sizeof text);
        print_words(text, strlen(text), 25, 25);
        putchar('\n');
    }
    printf("  %-22s this text\n\nexample:\n  %s\n", "--help", c->example);
}

/* Add a schema whose values begin at `offset`, with dashes for underlines. */
static rp_status add_options(const rp_param *schema, size_t offset)
{
    for (const rp_param *p = schema; p && p->name; p++) {
        const size_t n = line.n_options++;
        if (n == MAX_OPTIONS || strlen(p->name) >= MAX_NAME ||
            (offset < GENERIC_AT && offset + p->offset + sizeof(rp_texts) > MOST_BYTES))
            return rp_fail(RP_BROKEN, "%s %s: no room for option %s", cli_this_program()->name,
                           line.command->name, p->name);
        strcpy(line.names[n], p->name);
        for (char *c = line.names[n]; (c = strchr(c, '_'));) *c = '-';
        line.options[n] = *p;
        line.options[n].name = line.names[n];
        line.options[n].offset += offset;
    }
    return RP_OK;
}

rp_status cli_options_of(const cli_command *command, const rp_param **options)
{
    memset(&line, 0, sizeof line);
    line.command = command;
    *options = line.options;
    RP_TRY(add_options(command->protocol, 0));
    if (command->options) RP_TRY(add_options(command->options(), command->protocol_size));
    return command->prints_text ? RP_OK : add_options(generic_params(), GENERIC_AT);
}

static rp_status set_option(size_t i, const char *text)
{
    const rp_param *p = &line.options[i];
    line.given[i] = true;
    return rp_prefix(rp_params_set_text(p, line.values, p->type == RP_BOOL ? "true" : text), "%s",
                     cli_dashes(p));
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
    for (size_t i = 0; i < line.n_options; i++)
        if (!line.options[i].fallback && !line.given[i])
            return rp_fail(RP_USAGE, "%s%s is required (%s); see %s %s --help", cli_dashes(&line.options[i]),
                           line.names[i], line.options[i].meaning, cli_this_program()->name, c->name);
    if (count_fits(c->synopsis, line.n_arguments)) return RP_OK;
    return rp_fail(RP_USAGE, "usage: %s %s %s", cli_this_program()->name, c->name, c->synopsis);
}

/* Index of an option, which there must be. */
static size_t index_of(const char *name)
{
    size_t i = 0;
    while (strcmp(line.names[i], name) != 0) i++;
    return i;
}

/* Names of the commands that work on several processors. */
static void list_parallel(const cli_command *const *c, char *names, size_t size)
{
    for (; *c; c++) {
        const size_t used = strlen(names);
        if ((*c)->group)
            list_parallel((*c)->group, names, size);
        else if ((*c)->options && rp_params_find((*c)->options(), "j"))
            snprintf(names + used, size - used, "%s%s", used ? ", " : "", (*c)->name);
    }
}

static rp_status not_parallel(void)
{
    char names[256] = "";
    list_parallel(cli_this_program()->commands, names, sizeof names);
    return rp_fail(RP_USAGE, "unknown option -j: %s %s works on one processor; -j goes with %s",
                   cli_this_program()->name, line.command->name, names);
}

/* An option that is written with too few or too many dashes is found as well. */
static rp_status unknown_option(const char *text)
{
    char word[64], nearest[96] = "";
    const char *name = text + strspn(text, "-");
    snprintf(word, sizeof word, "%.*s", (int)strcspn(name, "="), name);
    if (strcmp(word, "j") == 0) return not_parallel();
    rp_guess guess = rp_guess_of(word);
    rp_guess_schema(&guess, line.options);
    rp_guess_try(&guess, "help");
    if (*guess.nearest)
        snprintf(nearest, sizeof nearest, " (did you mean %s%s?)", strlen(guess.nearest) == 1 ? "-" : "--",
                 guess.nearest);
    return rp_fail(RP_USAGE, "unknown option %s%s; see %s %s --help", text, nearest, cli_this_program()->name,
                   line.command->name);
}

static rp_status parse(const cli_command *command, int argc, char **argv, bool *done)
{
    struct option longs[MAX_OPTIONS + 2] = {{0}};
    char shorts[3 * MAX_OPTIONS] = ":";
    const rp_param *options;
    rp_status status = cli_options_of(command, &options);
    optind = 0; /* reset the parser (glibc) */
    if (status) return status;
    for (size_t n = 0; n < line.n_options; n++) {
        const rp_param *p = &line.options[n];
        longs[n] = (struct option){p->name, p->type == RP_BOOL ? no_argument : required_argument, NULL,
                                   256 + (int)n};
        if (strlen(p->name) == 1) strcat(strcat(shorts, p->name), p->type == RP_BOOL ? "" : ":");
    }
    longs[line.n_options] = (struct option){"help", no_argument, NULL, 'h'};
    strcat(shorts, "h");
    rp_params_defaults(line.options, line.values);
    opterr = 0;
    for (int c; !status && (c = getopt_long(argc, argv, shorts, longs, NULL)) != -1;) {
        const char letter[] = {'-', (char)(c == '?' ? optopt : c), '\0'};
        if (c == 'h') {
            print_help(command);
            *done = true;
            return RP_OK;
        }
        if (c == '?') /* a letter within a group: getopt has not passed its word yet */
            return unknown_option(optopt > 0 && optopt < 256 ? letter : argv[optind - 1]);
        if (c == ':')
            return rp_fail(RP_USAGE, "option %s needs a value; see %s %s --help", argv[optind - 1],
                           cli_this_program()->name, command->name);
        status = set_option(c < 256 ? index_of(letter + 1) : (size_t)c - 256, optarg);
    }
    line.n_arguments = argc - optind;
    line.arguments = argv + optind;
    return status ? status : check_given(command);
}

const char *cli_argument(int i)
{
    return i < line.n_arguments ? line.arguments[i] : NULL;
}

char *const *cli_arguments(void)
{
    return line.arguments;
}

bool cli_given(const char *name)
{
    return line.given[index_of(name)];
}

long cli_seed(void)
{
    return *(const long *)(line.values + line.options[index_of("seed")].offset);
}

void cli_defaults_in_units(void)
{
    for (size_t i = 0; line.options[i].name; i++)
        if (!line.given[i]) rp_params_default(&line.options[i], line.values);
}

void cli_provenance(FILE *out)
{
    rp_table_provenance(out, cli_command_line());
}

void cli_table(FILE *out)
{
    char text[256];
    cli_provenance(out);
    for (const rp_param *p = line.options; p->name; p++)
        if (p->type != RP_TEXT && p->type != RP_TEXTS && p->offset < GENERIC_AT)
            rp_table_note(out, p->name, "%s%s%s", rp_params_text(p, line.values, text, sizeof text),
                          *p->unit ? " " : "", rp_unit(p->unit));
}

/* Read "0.1,0.25,..." */
static rp_status read_positions(const char *text, double **x, size_t *n)
{
    *n = 1;
    for (const char *p = text; *p; p++) *n += *p == ',';
    *x = cli_memory(*n, sizeof **x);
    for (size_t i = 0; i < *n; i++) {
        char *end;
        (*x)[i] = strtod(text, &end);
        if (end == text || (*end && *end != ',') || !isfinite((*x)[i]))
            return rp_fail(RP_BAD_INPUT, "--at: \"%.40s\": numbers separated by commas expected", text);
        if ((*x)[i] < 0 || (*x)[i] > 1)
            return rp_fail(RP_BAD_INPUT, "--at: x/B = %.15g: out of range, allowed: [0, 1]", (*x)[i]);
        text = end + (*end == ',');
    }
    return RP_OK;
}

rp_status cli_positions(long points, const char *at, double **x, size_t *n)
{
    const bool listed = strcmp(at, "auto") != 0;
    if (listed && points > 0) return rp_fail(RP_USAGE, "give --points or --at, not both");
    if (listed) return read_positions(at, x, n);
    *n = points > 0 ? (size_t)points : 201;
    *x = cli_memory(*n, sizeof **x);
    for (size_t i = 0; i < *n; i++) (*x)[i] = (double)i / (double)(*n - 1);
    return RP_OK;
}

/* The tables of all arguments as one. */
static rp_status read_tables(rp_table **table)
{
    RP_TRY(cli_table_read(cli_data(cli_argument(0)), table));
    for (int i = 1; i < line.n_arguments; i++) {
        rp_table *more;
        RP_TRY(cli_table_read(cli_data(cli_argument(i)), &more));
        RP_TRY(rp_table_append(*table, more));
    }
    return RP_OK;
}

/* Act on the table of the arguments, and there on the rows that --where leaves. */
static rp_status act_on_table(const cli_command *command)
{
    rp_table *table;
    const rp_param *where = rp_params_find(line.options, "where");
    RP_TRY(read_tables(&table));
    const rp_texts *conditions = where ? (const rp_texts *)(line.values + where->offset) : NULL;
    for (size_t i = 0; where && i < conditions->n; i++) RP_TRY(rp_table_where(table, conditions->items[i]));
    return command->on_table(table, line.values);
}

const char *cli_own_name(const cli_command *c)
{
    const char *blank = strrchr(c->name, ' ');
    return blank ? blank + 1 : c->name;
}

rp_status cli_unknown_command(const char *word, const cli_command *const *among, const char *group)
{
    rp_guess guess = rp_guess_of(word);
    for (; *among; among++) rp_guess_try(&guess, cli_own_name(*among));
    return rp_fail(RP_USAGE, "unknown command \"%s\"%s; see %s %s%s--help", word, rp_guess_text(&guess),
                   cli_this_program()->name, group, *group ? " " : "");
}

static rp_status run_of_group(const cli_command *group, int argc, char **argv)
{
    if (argc < 2)
        return rp_fail(RP_USAGE, "a command is missing; see %s %s --help", cli_this_program()->name,
                       group->name);
    for (const cli_command *const *c = group->group; *c; c++)
        if (strcmp(argv[1], cli_own_name(*c)) == 0) return cli_run(*c, argc - 1, argv + 1);
    if (strcmp(argv[1], "--help") != 0 && strcmp(argv[1], "-h") != 0)
        return cli_unknown_command(argv[1], group->group, group->name);
    const char *name = cli_this_program()->name;
    printf("usage: %s %s COMMAND [options]; %s %s COMMAND --help says more\n\n", name, group->name, name,
           group->name);
    for (const cli_command *const *c = group->group; *c; c++)
        printf("  %-10s %s\n", cli_own_name(*c), (*c)->summary);
    return RP_OK;
}

static rp_status act(const cli_command *command)
{
    return command->on_table ? act_on_table(command) : command->act(line.values);
}

/* What is no table is printed as it is. The text is from malloc. */
static rp_status print_as_json(char *text)
{
    rp_table *table;
    int *columns;
    size_t n;
    if (*text != '#' && !strchr(text, '\t')) {
        fputs(text, stdout);
        free(text);
        return RP_OK;
    }
    RP_TRY(cli_table_parse("--json", text, &table));
    RP_TRY(cli_columns(table, "all", &n, &columns));
    return cli_export_json(table, n, columns, stdout);
}

/* Standard output as JSON; a file that the command writes in its place would stay a table. A command that
 * fails has no table. */
static rp_status act_as_json(const cli_command *command)
{
    char *text, message[4096];
    size_t size;
    const rp_param *o = rp_params_find(line.options, "o");
    if (o && o->fallback && strcmp(o->fallback, "-") == 0 &&
        strcmp(*(const char **)(line.values + o->offset), "-") != 0)
        return rp_fail(RP_USAGE,
                       "--json is of standard output; repose export --to json -o FILE writes a file");
    FILE *const out = stdout, *memory = open_memstream(&text, &size);
    if (!memory) return rp_fail(RP_NO_MEMORY, "--json: out of memory");
    stdout = memory; /* glibc: a variable */
    rp_status status = act(command);
    snprintf(message, sizeof message, "%s", rp_message());
    const bool whole = rp_file_finish(stdout, "--json") == RP_OK;
    fclose(stdout);
    stdout = out;
    rp_status printed = whole ? RP_OK : rp_fail(RP_NO_MEMORY, "--json: out of memory");
    if (!printed && (!status || status == RP_NO_RESULT))
        printed = print_as_json(text);
    else
        free(text);
    return status ? rp_fail(status, "%s", message) : printed;
}

rp_status cli_run(const cli_command *command, int argc, char **argv)
{
    bool done = false;
    if (command->group) return run_of_group(command, argc, argv);
    rp_status status = parse(command, argc, argv, &done);
    if (status || done) return status;
    const generic_options *o = (const generic_options *)(line.values + GENERIC_AT);
    return o->json ? act_as_json(command) : act(command);
}
