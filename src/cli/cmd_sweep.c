/* repose sweep plan|run|status|export|digest */
#include "cli/progress.h"

#include <string.h>

#include "cli/cli.h"

static void print_counts(const sweep_counts *counts)
{
    rp_table_note(stdout, "planned", "%zu", counts->planned);
    rp_table_note(stdout, "stored", "%zu", counts->stored);
    rp_table_note(stdout, "missing", "%zu", counts->planned - counts->stored);
    rp_table_columns(stdout, 2, (const char *const[][2]){{"status", ""}, {"runs", ""}});
    for (size_t i = 0; i < counts->n_words; i++)
        printf("%s\t%zu\n", counts->words[i].status, counts->words[i].runs);
}

typedef struct {
    const char *argument; /* FILE or DIR */
    const char *o;
    long j, replicas;
    bool reduce;
} options;

static const rp_param no_options[] = {{0}};

static rp_status parse(const cli_command *command, int argc, char **argv, options *o, bool *done)
{
    int n;
    return cli_parse(command, argc, argv, o, &o->argument, &n, done);
}

static rp_status plan(int argc, char **argv)
{
    static const rp_param schema[] = {
        {"o", "", RP_TEXT, offsetof(options, o), NULL, "", "folder of the sweep; created if missing"},
        {"replicas", "", RP_INT, offsetof(options, replicas), "auto", "[1, 1000000] | auto",
         "runs per grid point; auto: as in the file"},
        {0}};
    static const cli_command command = {
        "sweep plan",
        "FILE -o DIR [--replicas N]",
        "Check a sweep file and every point of its grid, and plan its runs in a folder. Planning again\n"
        "after a change, or for more replicas, keeps all stored runs and reuses those that match. The file "
        "(libconfig syntax):\n\n"
        "  protocol = \"repose\";  replicas = 20;  seed = 1993;   # runs per grid point; seed: 0 to "
        "2147483647\n"
        "  fixed = { W = 4.0; };                               # keys: repose params repose\n"
        "  grid  = { mu = [0.1, 0.2]; k_n = [1.0e5, 1.0e6]; }; # the product; with zip = true, in pairs\n"
        "  piles = \"own\";                                      # shared: the same piles at every grid "
        "point",
        "repose sweep plan sweeps/lh/lh3.cfg -o build/sweeps/lh3",
        schema,
        1,
        1};
    options o;
    bool done;
    rp_status status = parse(&command, argc, argv, &o, &done);
    if (status || done) return status;
    sweep_counts counts;
    status =
        sweep_prepare(o.argument, o.o, o.replicas > 0 ? (size_t)o.replicas : 0, sweep_protocols, &counts);
    if (!status)
        printf("%s: %zu runs (%zu grid points x %zu replicas), %zu already stored\n", o.o, counts.planned,
               counts.points, counts.replicas, counts.stored);
    return status;
}

static rp_status run(int argc, char **argv)
{
    static const rp_param schema[] = {{"j", "", RP_INT, offsetof(options, j), "auto", "[1, 4096] | auto",
                                       "worker processes; auto: one per processor"},
                                      {0}};
    static const cli_command command = {
        "sweep run",
        "DIR [-j N]",
        "Make all runs of a planned sweep that are not stored yet; each run is stored when it ends. After a\n"
        "stop, even by SIGKILL, only the runs in progress are lost; the same command resumes. Exit status 0\n"
        "if every run is stored, whatever its status; 75 if stopped.",
        "repose sweep run build/sweeps/lh3 -j 2",
        schema,
        1,
        1};
    options o;
    bool done;
    rp_status status = parse(&command, argc, argv, &o, &done);
    if (status || done) return status;
    sweep_counts counts;
    status = cli_sweep_run(o.argument, o.j, &counts);
    if (!status) print_counts(&counts);
    return status;
}

static rp_status status_of(int argc, char **argv)
{
    static const cli_command command = {
        "sweep status",
        "DIR",
        "Numbers of planned, stored and missing runs, and of runs with each status.",
        "repose sweep status build/sweeps/lh3",
        no_options,
        1,
        1};
    options o;
    bool done;
    rp_status status = parse(&command, argc, argv, &o, &done);
    if (status || done) return status;
    sweep_counts counts;
    status = sweep_status(o.argument, sweep_protocols, &counts);
    if (!status) print_counts(&counts);
    return status;
}

static rp_status export(int argc, char **argv)
{
    static const rp_param schema[] = {
        {"o", "", RP_TEXT, offsetof(options, o), "-", "", "file to write; - is standard output"},
        {"reduce", "", RP_BOOL, offsetof(options, reduce), "false", "",
         "one row per grid point: mean, sd, se, 95 % interval (Student's t) and n of each output"},
        {0}};
    static const cli_command command = {
        "sweep export",
        "DIR [--reduce] [-o FILE]",
        "Write the stored runs as a table, one row per run in the order of the plan. With --reduce, a run\n"
        "whose status starts with \"ok\" counts as a result (column n), any other as failed (n_failed).",
        "repose sweep export build/sweeps/lh3 --reduce -o build/tables/lh3.tsv",
        schema,
        1,
        1};
    options o;
    bool done;
    FILE *out;
    rp_status status = parse(&command, argc, argv, &o, &done);
    if (status || done) return status;
    status = rp_file_open(o.o, &out);
    if (status) return status;
    status = sweep_export(o.argument, sweep_protocols, o.reduce, cli_command_line(), out);
    return rp_file_close(o.o, out, status);
}

static rp_status digest(int argc, char **argv)
{
    static const cli_command command = {
        "sweep digest",
        "DIR",
        "Digest (XXH3-128) of key, status and outputs of all rows, and the number of rows. The digest does "
        "not\n"
        "depend on the number of workers or on interruptions. Exit status 1 while rows are missing.",
        "repose sweep digest build/sweeps/lh3",
        no_options,
        1,
        1};
    options o;
    bool done;
    rp_status status = parse(&command, argc, argv, &o, &done);
    if (status || done) return status;
    char text[33];
    size_t rows;
    status = sweep_digest(o.argument, sweep_protocols, text, &rows);
    if (!status) printf("%s\t%zu\n", text, rows);
    return status;
}

rp_status cmd_sweep(int argc, char **argv)
{
    static const struct {
        const char *name;
        rp_status (*function)(int, char **);
        const char *summary;
    } actions[] = {{"plan", plan, "check a sweep file and plan its runs in a folder"},
                   {"run", run, "make the missing runs"},
                   {"status", status_of, "numbers of stored runs and of each status"},
                   {"export", export, "write the runs, or their statistics, as a table"},
                   {"digest", digest, "print a digest of all results"}};
    const char *name = argc > 1 ? argv[1] : "";
    for (size_t i = 0; i < sizeof actions / sizeof *actions; i++)
        if (strcmp(name, actions[i].name) == 0) return actions[i].function(argc - 1, argv + 1);
    if (strcmp(name, "--help") != 0)
        return rp_fail(RP_USAGE, "\"%s\": unknown action; plan, run, status, export or digest expected",
                       name);
    printf("usage: repose sweep ACTION ...; repose sweep ACTION --help says more\n\n");
    for (size_t i = 0; i < sizeof actions / sizeof *actions; i++)
        printf("  %-8s %s\n", actions[i].name, actions[i].summary);
    return RP_OK;
}
