/* repose sweep plan|run|status|export|digest|make */

#include <errno.h>
#include <signal.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "cli/cli.h"
#include "cli/progress.h"
#include "params/config.h"
#include "params/units.h"

static void warn_of(const char *path, const config_setting_t *group)
{
    const config_setting_t *g = group ? config_setting_get_member(group, "g") : NULL;
    if (g)
        cli_warn_gravity(path, config_setting_is_aggregate(g) ? config_setting_get_float_elem(g, 0)
                                                              : config_setting_get_float(g));
}

static void warn_sweep(const char *path)
{
    config_t config;
    if (rp_config_read(path, &config) == RP_OK) {
        const config_setting_t *root = config_root_setting(&config),
                               *grid = config_setting_get_member(root, "grid");
        warn_of(path, config_setting_get_member(root, "fixed"));
        if (grid && config_setting_is_group(grid)) warn_of(path, grid);
        for (int i = 0; grid && config_setting_is_list(grid) && i < config_setting_length(grid); i++)
            warn_of(path, config_setting_get_elem(grid, (unsigned)i));
    }
    config_destroy(&config);
}

#define PLAN_OPTIONS(X)                                                                                      \
    X(TEXT, o, "", NULL, "", "folder of the sweep; created if missing")                                      \
    X(INT, replicas, "", "auto", "[1, 1000000] | auto", "runs per grid point; auto: the number in the file") \
    CLI_QUIET(X)                                                                                             \
    CLI_FORCE(X)

CLI_OPTIONS(plan, PLAN_OPTIONS)

static void print_planned(const cli_call *call, const char *dir, const sweep_counts *counts)
{
    if (!cli_given(call, "json")) {
        printf("%s: %zu runs (%zu grid points x %zu replicas), %zu already stored\n", dir, counts->planned,
               counts->points, counts->replicas, counts->stored);
        return;
    }
    cli_provenance(call, stdout);
    rp_table_note(stdout, "folder", "%s", dir);
    rp_table_header(stdout, "runs, points, replicas, stored");
    CLI_ROW((double)counts->planned, (double)counts->points, (double)counts->replicas,
            (double)counts->stored);
}

static rp_status act_plan(cli_call *call, const void *values)
{
    const plan_options *o = values;
    sweep_counts counts;
    RP_TRY(cli_claim_sweep(o->o, cli_argument(call, 0), o->force));
    RP_TRY(sweep_prepare(cli_data(call->arena, cli_argument(call, 0)), o->o,
                         o->replicas > 0 ? (size_t)o->replicas : 0, sweep_protocols, cli_watch(o->quiet),
                         &counts));
    warn_sweep(cli_data(call->arena, cli_argument(call, 0)));
    print_planned(call, o->o, &counts);
    return RP_OK;
}

static const cli_command plan = {
    "sweep plan",
    "check a sweep file and plan its runs in a folder",
    "FILE -o DIR [--replicas N] [--quiet] [--force]",
    "Check a sweep file and every point of its grid, and plan its runs in a folder. Planning again\n"
    "after a change, or for more replicas, keeps all stored runs and reuses those that match. A folder with\n"
    "a sweep of another name, or with a run, is refused without --force. The file (libconfig syntax):\n"
    "\n"
    "  protocol = \"repose\";  replicas = 20;  seed = 1993;   # runs per grid point; seed: 0 to 2147483647\n"
    "  fixed = { W = 4.0; };                               # keys: repose params repose\n"
    "  grid  = { mu = [0.1, 0.2]; k_n = [1.0e5, 1.0e6]; }; # the product; with zip = true, in pairs\n"
    "  piles = \"own\";                                      # shared: the same piles at every grid point\n"
    "  units = \"cgs\";                                      # or si, sigma: of the numbers and the tables",
    "repose sweep plan sweeps/lh/lh3.cfg -o build/sweeps/lh3",
    plan_params,
    .refuses = "A folder with another sweep, or with a run: give another one, or --force.\n"
               "An unknown key, a value out of range, and a point of the grid that cannot run. Nothing is "
               "planned then.",
    .act = act_plan};

#define LIMITS(X)                                                                                            \
    X(REAL, mem, "MB", "infinite", "(0, inf) | infinite", "memory that one run may take")                    \
    X(REAL, time, "s", "infinite", "(0, inf) | infinite", "time that one run may take")

#define RUN_OPTIONS(X)                                                                                       \
    CLI_QUIET(X)                                                                                             \
    CLI_WORKERS(X)                                                                                           \
    LIMITS(X)                                                                                                \
    X(TEXT, shard, "", "", "", "part of the runs, I/N with I from 1 to N, in a store of its own")            \
    X(REAL, snapshot, "s", "60", "[0, inf)",                                                                 \
      "processor time from one snapshot of a run to the next, in DIR/snapshots; 0: none")

CLI_OPTIONS(run, RUN_OPTIONS)

/* "3/8" */
static rp_status read_shard(const char *text, int *shard, int *shards)
{
    int used = 0;
    *shard = *shards = 0;
    if (!*text || (sscanf(text, "%6d/%6d%n", shard, shards, &used) == 2 && !text[used] && *shards > 0))
        return RP_OK;
    return rp_fail(RP_BAD_INPUT, "--shard %s: I/N expected, as in 3/8", text);
}

static rp_status act_run(cli_call *call, const void *values)
{
    const run_options *o = values;
    sweep_counts counts;
    sweep_options options = {
        .workers = (int)o->j, .memory = o->mem, .time = o->time, .snapshot = o->snapshot};
    rp_status status = read_shard(o->shard, &options.shard, &options.shards);
    if (!status) status = cli_sweep_run(cli_argument(call, 0), options, o->quiet, &counts);
    if (!status || status == RP_NO_RESULT) cli_print_counts(&counts);
    return status;
}

static const cli_command run = {
    "sweep run",
    "run what is planned and not yet stored",
    "DIR [-j N] [--mem MB] [--time S] [--shard I/N] [--snapshot S]",
    "Make all runs of a planned sweep that are not stored yet; each run is stored when it ends. After a\n"
    "stop, even by SIGKILL, the same command resumes. Long runs resume from their last snapshots (all\n"
    "protocols but pile), with the same bits; SIGINT, SIGTERM and SIGHUP write these, a second signal ends\n"
    "the sweep at once. Exit status 0 if every run is stored with its outcome; 75 if\n"
    "stopped; 1 while runs are aborted, which the same command tries again: status crashed (its worker died\n"
    "or hung, three times), no_memory, time_limit.\n"
    "With --shard, machines that share the folder, or have copies of it, each make a part; `sweep merge`\n"
    "unites the parts.",
    "repose sweep run build/sweeps/lh3 -j 2",
    run_params,
    .refuses = "A folder without a planned sweep, and one in which another process runs or plans it.",
    .act = act_run};

static rp_status act_status_of(cli_call *call, const void *values)
{
    (void)values;
    sweep_counts counts;
    RP_TRY(sweep_status(cli_argument(call, 0), sweep_protocols, &counts));
    const double left = counts.seconds * (double)(counts.planned - counts.stored);
    rp_table_note(stdout, "running", "%zu", counts.running);
    if (isfinite(left)) rp_table_note(stdout, "left", "%.3g s of one core", left);
    if (*counts.shards) rp_table_note(stdout, "shards with missing runs", "%s", counts.shards);
    cli_print_counts(&counts);
    return RP_OK;
}

static const cli_command status_of = {
    "sweep status",
    "numbers of stored runs and of each status",
    "DIR",
    "Numbers of planned, stored and missing runs, and of runs with each status, with all shards in the\n"
    "folder; processes that write to it, the time left, and the shards with missing runs as a list for\n"
    "an array of jobs.",
    "repose sweep status build/sweeps/lh3",
    NULL,
    .refuses = "A folder without a planned sweep.",
    .act = act_status_of};

#define EXPORT_OPTIONS(X)                                                                                    \
    X(TEXT, o, "", "-", "", "file to write; - is standard output")                                           \
    X(BOOL, reduce, "", "false", "",                                                                         \
      "one row per grid point: mean, sd, se, 95 % interval (Student's t) and n of each output")

CLI_OPTIONS(export, EXPORT_OPTIONS)

static rp_status act_export(cli_call *call, const void *values)
{
    const export_options *o = values;
    sweep_counts counts;
    RP_TRY(sweep_check_output(cli_argument(call, 0), o->o));
    RP_TRY(
        cli_sweep_export(call, cli_argument(call, 0), o->reduce ? SWEEP_POINTS : SWEEP_RUNS, o->o, &counts));
    return cli_check_whole(cli_argument(call, 0), &counts);
}

static const cli_command export = {
    "sweep export",
    "write the runs, or their statistics, as a table",
    "DIR [--reduce] [-o FILE]",
    "Write the stored runs as a table, one row per run in the order of the plan. With --reduce, a run\n"
    "whose status starts with \"ok\" counts as a result (column n), any other as failed (n_failed). Runs\n"
    "that are aborted (see sweep run) are among the failed; the header then has their number. While runs\n"
    "are missing or aborted, the table has the others, and the exit status is 1.",
    "repose sweep export build/sweeps/lh3 --reduce -o build/tables/lh3.tsv",
    export_params,
    .refuses = "An output that is a file of the sweep itself.",
    .act = act_export};

static rp_status act_digest(cli_call *call, const void *values)
{
    (void)values;
    char text[33];
    size_t rows;
    RP_TRY(sweep_digest(cli_argument(call, 0), sweep_protocols, text, &rows));
    if (!cli_given(call, "json")) return printf("%s\t%zu\n", text, rows), RP_OK;
    cli_provenance(call, stdout);
    rp_table_note(stdout, "digest", "%s", text); /* a note is a text, even of digits alone */
    rp_table_header(stdout, "runs");
    CLI_ROW((double)rows);
    return RP_OK;
}

static const cli_command digest = {
    "sweep digest",
    "print a digest of all results",
    "DIR",
    "Digest (XXH3-128) of key, status and outputs of all rows, and the number of rows. The digest does\n"
    "not depend on the number of workers or on interruptions. Exit status 1 while rows are missing. With\n"
    "--json, the digest is among the notes.",
    "repose sweep digest build/sweeps/lh3",
    NULL,
    .refuses = "A folder without a planned sweep.",
    .act = act_digest};

static bool is_shown(const char *name)
{
    return *name != '.';
}

/* Add a word of a table's command. @ is the folder of the tables; a part * of the path stands for each folder
 * there that has the rest of the path. */
static rp_status add_word(rp_arena *arena, const char *word, const char *tables, rp_paths *words)
{
    const bool at = *word == '@';
    const char *star = strstr(word, "/*/"), *rest = star ? star + strlen("/*/") : "";
    const size_t before = words->n, length = star ? (size_t)(star - word) : strlen(word);
    const char *folder = rp_text(arena, "%s%.*s", at ? tables : "", (int)length - at, word + at);
    rp_paths found = {0};
    rp_status status = star ? rp_paths_in(&found, folder, is_shown) : RP_OK;
    for (size_t i = 0; !status && i < found.n; i++)
        if (rp_is_in(found.path[i], rest)) status = rp_paths_add(words, found.path[i], rest);
    rp_paths_free(&found);
    if (status || words->n > before) return status;
    return rp_paths_add(words, NULL, rp_text(arena, "%s%s", folder, star ? star : ""));
}

/* Make one derived table. A command that finds no result is an answer too, if it prints a table. */
static rp_status make_table(rp_arena *arena, const sweep_table *table, const char *tables)
{
    const char *path;
    FILE *out;
    int code = SIGKILL; /* unless it has ended by itself */
    rp_paths words = {0};
    char *save, *text = rp_text(arena, "repose %s", table->command);
    rp_status status = RP_OK;
    RP_TRY(rp_path(arena, &path, "%s/%s.tsv", tables, table->name));
    RP_TRY(rp_file_open(path, &out));
    for (char *word = strtok_r(text, " ", &save); !status && word; word = strtok_r(NULL, " ", &save))
        status = add_word(arena, word, tables, &words);
    /* the folder of a run or a pile is made anew with its table */
    const bool folder = strncmp(table->command, "run ", 4) == 0 || strncmp(table->command, "pile ", 5) == 0;
    if (!status && folder && strstr(table->command, " -o @"))
        status = add_word(arena, "--force", tables, &words);
    char **argv = rp_arena_memory(arena, words.n, sizeof *argv); /* and the NULL that ends them */
    memcpy(argv, words.path, words.n * sizeof *argv);
    const pid_t child = status ? -1 : fork();
    if (child == 0) {
        if (dup2(fileno(out), STDOUT_FILENO) >= 0) execv("/proc/self/exe", argv);
        _exit(RP_IO);
    }
    while (child > 0 && waitpid(child, &code, 0) < 0 && errno == EINTR) {
    }
    rp_paths_free(&words);
    if (!status && !WIFEXITED(code))
        status = rp_fail(RP_STOPPED, "%s: repose %s: stopped", table->name, table->command);
    else if (WEXITSTATUS(code) > RP_NO_RESULT)
        status = rp_fail((rp_status)WEXITSTATUS(code), "%s: repose %s: exit status %d", table->name,
                         table->command, WEXITSTATUS(code));
    return rp_file_close(path, out, status);
}

#define MAKE_OPTIONS(X)                                                                                      \
    X(TEXT, o, "", NULL, "", "folder of the sweep; created if missing")                                      \
    X(TEXT, tables, "", "build/tables", "", "folder of the tables")                                          \
    CLI_WORKERS(X)                                                                                           \
    LIMITS(X)                                                                                                \
    X(INT, replicas, "", "auto", "[1, 1000000] | auto", "runs per grid point; auto: the number in the file") \
    X(BOOL, study, "", "false", "", "runs per grid point: the number `study` of the file")                   \
    CLI_QUIET(X)                                                                                             \
    CLI_FORCE(X)

CLI_OPTIONS(make, MAKE_OPTIONS)

static rp_status export_to(const cli_call *call, const make_options *o, const char *name, const char *suffix,
                           unsigned what)
{
    const char *path;
    RP_TRY(rp_path(call->arena, &path, "%s/%s%s.tsv", o->tables, name, suffix));
    return cli_sweep_export(call, o->o, what, path, NULL);
}

/* "lh3: 80 runs: 78 ok, 2 not_at_rest" */
static void print_summary(const char *name, const sweep_counts *counts)
{
    printf("%s: %zu runs", name, counts->stored);
    for (size_t i = 0; i < counts->n_words; i++)
        printf("%s %zu %s", i ? "," : ":", counts->words[i].runs, counts->words[i].status);
    putchar('\n');
    fflush(stdout); /* before what the commands of tables write */
}

static rp_status make_runs(const cli_call *call, const make_options *o, const char *file,
                           const sweep_recipe *recipe)
{
    size_t replicas = o->replicas > 0 ? (size_t)o->replicas : o->study ? recipe->study : 0;
    sweep_counts counts;
    const sweep_options options = {
        .workers = (int)o->j, .memory = o->mem, .time = o->time, .snapshot = CLI_SNAPSHOT};
    RP_TRY(cli_claim_sweep(o->o, file, o->force));
    RP_TRY(sweep_prepare(file, o->o, replicas, sweep_protocols, cli_watch(o->quiet), &counts));
    warn_sweep(file);
    const rp_status status = cli_sweep_run(o->o, options, o->quiet, &counts);
    if (!status || status == RP_NO_RESULT) print_summary(recipe->name, &counts);
    RP_TRY(status);
    RP_TRY(export_to(call, o, recipe->name, "_runs", SWEEP_RUNS));
    return export_to(call, o, recipe->name, "", SWEEP_POINTS);
}

static rp_status act_make(cli_call *call, const void *values)
{
    const make_options *o = values;
    sweep_recipe recipe;
    const char *file = cli_data(call->arena, cli_argument(call, 0));
    rp_status status = sweep_recipe_read(file, &recipe);
    if (!status) status = rp_make_directory(o->tables);
    if (!status && recipe.has_runs) status = make_runs(call, o, file, &recipe);
    for (size_t i = 0; !status && i < recipe.n_tables; i++)
        status = make_table(call->arena, &recipe.tables[i], o->tables);
    sweep_recipe_free(&recipe);
    return status;
}

static const cli_command make = {
    "sweep make",
    "plan, run, and write all tables of the sweep file",
    "FILE -o DIR [--tables DIR] [-j N] [--mem MB] [--time S] [--replicas N | --study] [--quiet] [--force]",
    "Plan a sweep, make its missing runs, and write its tables: NAME_runs.tsv, NAME.tsv, one row per\n"
    "grid point, and those that the file derives from them, in order. @ is the folder of the tables:\n"
    "\n"
    "  study  = 60;                                        # runs per grid point with --study\n"
    "  tables = [\"lh3_phi = angle phi @/lh3_runs.tsv\"];     # NAME = COMMAND of repose\n"
    "\n"
    "A file without a protocol has tables alone.",
    "repose sweep make sweeps/li/tent.cfg -o build/sweeps/tent",
    make_params,
    .refuses = "What `repose sweep plan` and `repose sweep run` refuse; a table whose command fails.",
    .prints_text = true,
    .act = act_make};

static const cli_command *const commands[] = {&plan,   &run,  &status_of,       &cmd_sweep_merge,   &export,
                                              &digest, &make, &cmd_sweep_slurm, &cmd_sweep_salvage, NULL};
const cli_command cmd_sweep = {"sweep", "plan, run and read parameter sweeps", .group = commands};
