/* What a program of commands does: finds the command, prints its failure, turns its status into the exit
 * status, and frees what the command has made. */
#include <limits.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <gsl/gsl_errno.h>

#include "cli/cli.h"
#include "params/units.h"
#include "core/random.h"
#include "core/version.h"

static const cli_program no_program = {"repose", (const cli_command *const[]){NULL}, NULL},
                         *this_program = &no_program;
static char command_line[4096];

const cli_program *cli_this_program(void)
{
    return this_program;
}

const char *cli_command_line(void)
{
    return command_line;
}

void cli_command_line_set(const char *text)
{
    snprintf(command_line, sizeof command_line, "%s", text);
}

/* What is freed after the subcommand, the latest first. */
static struct {
    void *thing;
    void (*release)(void *);
} * kept;
static size_t n_kept;

static void *keep(void *thing, void (*release)(void *))
{
    kept = thing ? realloc(kept, (n_kept + 1) * sizeof *kept) : NULL;
    if (!kept) {
        fprintf(stderr, "%s: out of memory\n", this_program->name);
        exit(RP_NO_MEMORY);
    }
    kept[n_kept].thing = thing;
    kept[n_kept++].release = release;
    return thing;
}

size_t cli_mark(void)
{
    return n_kept;
}

void cli_release(size_t mark)
{
    while (n_kept > mark) n_kept--, kept[n_kept].release(kept[n_kept].thing);
}

static void free_generator(void *rng)
{
    gsl_rng_free(rng);
}

static void free_table(void *table)
{
    rp_table_free(table);
}

void *cli_memory(size_t n, size_t size)
{
    return keep(calloc(n + 1, size), free);
}

gsl_rng *cli_random(unsigned long run)
{
    return keep(rp_random_alloc((unsigned long)cli_seed(), run, RP_PURPOSE_BOOTSTRAP), free_generator);
}

rp_status cli_table_read(const char *path, rp_table **table)
{
    *table = keep(cli_memory(1, sizeof **table), free_table);
    const rp_status status = rp_table_read(path, *table);
    rp_units_set(rp_units_find(status ? NULL : rp_table_find_note(*table, "system")));
    return status;
}

rp_status cli_table_parse(const char *name, char *text, rp_table **table)
{
    *table = keep(cli_memory(1, sizeof **table), free_table);
    return rp_table_parse(name, text, *table);
}

rp_status cli_texts_read(const char *path, rp_table **table)
{
    *table = keep(cli_memory(1, sizeof **table), free_table);
    return rp_table_read_texts(path, *table);
}

/* Folders of data beside the program: where it is installed, then the source above its build folder. */
static const char *const beside[] = {"../share/repose", "..", "../.."};

/* The program's folder; "" where the system does not tell. */
static void find_program(char folder[PATH_MAX])
{
    const ssize_t n = readlink("/proc/self/exe", folder, PATH_MAX - 1);
    folder[n > 0 ? n : 0] = '\0';
    char *slash = strrchr(folder, '/');
    if (slash) *slash = '\0';
}

static bool exists_in(const char *folder, const char *sub, const char *name, char path[PATH_MAX])
{
    char text[3 * PATH_MAX];
    snprintf(text, sizeof text, "%s/%s/%s", folder, sub, name);
    return realpath(text, path) != NULL;
}

bool cli_ends_in(const char *text, const char *end)
{
    return strlen(text) >= strlen(end) && strcmp(text + strlen(text) - strlen(end), end) == 0;
}

const char *cli_data(const char *name)
{
    char path[PATH_MAX], program[PATH_MAX];
    const char *folder = getenv("REPOSE_DATA");
    bool found = false;
    if (*name == '/' || access(name, F_OK) == 0) return name;
    if (folder && *folder) {
        found = exists_in(folder, ".", name, path);
    } else {
        find_program(program);
        for (size_t i = 0; i < N_OF(beside) && !found && *program; i++)
            found = exists_in(program, beside[i], name, path);
    }
    return found ? strcpy(cli_memory(strlen(path) + 1, 1), path) : name;
}

/* Flush standard output, since a failed write is an error; a failure has one message. */
static int finish(const char *command, rp_status status)
{
    if (!status) status = rp_file_finish(stdout, "standard output");
    if (status)
        fprintf(stderr, "%s%s%s: %s\n", this_program->name, *command ? " " : "", command, rp_message());
    cli_release(0);
    free(kept), kept = NULL;
    return (int)status;
}

int cli_main(const cli_program *program, int argc, char **argv)
{
    this_program = program;
    signal(SIGXFSZ, SIG_IGN);    /* a file that reaches the limit of its size is a failed write */
    gsl_set_error_handler_off(); /* each caller of GSL checks the returned status */
    size_t used = (size_t)snprintf(command_line, sizeof command_line, "%s", this_program->name);
    for (int i = 1; i < argc && used < sizeof command_line; i++)
        used += (size_t)snprintf(command_line + used, sizeof command_line - used, " %s", argv[i]);
    if (argc < 2) {
        this_program->overview(stderr);
        return RP_USAGE;
    }
    if (strcmp(argv[1], "--help") == 0 || strcmp(argv[1], "-h") == 0) {
        this_program->overview(stdout);
        return finish("", RP_OK);
    }
    if (strcmp(argv[1], "--version") == 0 || strcmp(argv[1], "-V") == 0) {
        printf("%s %s (commit %s)\n", this_program->name, RP_VERSION, rp_build_commit);
        return finish("", RP_OK);
    }
    for (const cli_command *const *c = this_program->commands; *c; c++)
        if (strcmp(argv[1], (*c)->name) == 0) return finish(argv[1], cli_run(*c, argc - 1, argv + 1));
    return finish("", cli_unknown_command(argv[1], this_program->commands, ""));
}
