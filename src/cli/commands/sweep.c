/* repose sweep plan|run|status|merge|export|digest|make */
#include "cli/cli.h"
#include "cli/progress.h"
#include "core/plain.h"

#define PLAN_OPTIONS(X)                                                                                      \
    X(TEXT, o, "", NULL, "", "folder of the sweep; created if missing")                                      \
    X(INT, replicas, "", "auto", "[1, 1000000] | auto", "runs per grid point; auto: the number in the file") \
    CLI_FORCE(X, "use the folder even if it holds a different sweep")

CLI_OPTIONS(plan, PLAN_OPTIONS)

static rp_status act_plan(cli_call *call, const void *values)
{
    const plan_options *o = values;
    sweep_counts counts;
    RP_TRY(cli_claim_sweep(o->o, cli_argument(call, 0), o->force));
    RP_TRY(cli_sweep_plan(rp_data(call->arena, cli_argument(call, 0)), o->o,
                          o->replicas > 0 ? (size_t)o->replicas : 0, false, &counts));
    fprintf(call->out, "%s: %zu runs (%zu grid points x %zu replicas), %zu already stored\n",
            rp_plain(rp_text(call->arena, "%s", o->o)), counts.planned, counts.points, counts.replicas,
            counts.stored);
    return RP_OK;
}

static const cli_command plan = {
    "sweep plan",
    "check a sweep file and plan its runs in a folder",
    "FILE -o DIR [--replicas N] [--force]",
    "Checks a sweep file and every point of its grid, and plans its runs in a folder. Planning again after a "
    "change, or for more replicas, keeps all stored runs and uses those that match. The file (libconfig "
    "syntax):\n"
    "\n"
    "  protocol = \"repose\";  replicas = 20;  seed = 1993;   # runs per grid point; seed: 0 to 2147483647\n"
    "  fixed = { W = 4.0; };                               # keys: repose params repose\n"
    "  grid  = { mu = [0.1, 0.2]; k_n = [1.0e5, 1.0e6]; }; # all combinations; with zip = true, pairs\n"
    "  piles = \"own\";                                      # or shared: the same piles at every grid "
    "point\n"
    "  units = \"cgs\";                                      # or si, sigma: for the file and the tables",
    "repose sweep plan sweeps/lh/lh3.cfg -o build/sweeps/lh3",
    plan_params,
    .refuses =
        "A folder with a sweep of a different name, or with a run: use a different folder, or --force.\n"
        "An unknown key, a value out of range, and a grid point that cannot run. Nothing is planned then.",
    .act = act_plan};

#define RUN_OPTIONS(X)                                                                                       \
    CLI_QUIET(X)                                                                                             \
    CLI_WORKERS(X)                                                                                           \
    CLI_LIMITS(X)                                                                                            \
    X(TEXT, shard, "", "", "",                                                                               \
      "make only a fraction of the runs, I/N with I from 1 to N, in a store of its own")                     \
    X(REAL, snapshot, "s", "60", "[0, inf)",                                                                 \
      "processor time between snapshots of a run, in DIR/snapshots; 0: none")

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
    if (!status || status == RP_NO_RESULT) cli_print_counts(call, &counts);
    return status;
}

static const cli_command run = {
    "sweep run",
    "make the planned runs that are not stored yet",
    "DIR [-j N] [--mem MB] [--time S] [--shard I/N] [--snapshot S]",
    "Makes all runs of a planned sweep that are not stored yet, and stores each run when it ends. After a "
    "stop, even by SIGKILL, the same command continues. Long runs continue from their last snapshots (with "
    "all protocols but pile), with bitwise identical results. SIGINT, SIGTERM and SIGHUP write these "
    "snapshots; a second signal ends the sweep at once.\n"
    "\n"
    "The exit status is 0 if every run is stored with a result, 75 after a stop, and 1 while runs are "
    "aborted. The same command tries these again; their status is crashed (the worker died three times), "
    "no_memory or time_limit.\n"
    "\n"
    "With --shard, machines that share the folder, or have copies of it, each make a fraction of the runs; "
    "`repose sweep merge` unites them.",
    "repose sweep run build/sweeps/lh3 -j 2",
    run_params,
    .refuses =
        "A folder without a planned sweep, and one in which a different process runs or plans the sweep.",
    .act = act_run};

static rp_status act_status_of(cli_call *call, const void *values)
{
    (void)values;
    sweep_counts counts;
    RP_TRY(sweep_status(cli_argument(call, 0), sweep_protocols, &counts));
    const double left = counts.seconds * (double)(counts.planned - counts.stored);
    if (isfinite(left)) rp_table_note(call->out, "left", "%.3g s of one core", left);
    cli_print_counts(call, &counts);
    return RP_OK;
}

static const cli_command status_of = {
    "sweep status",
    "count the stored runs, and those of each status",
    "DIR",
    "Prints the numbers of planned, stored and missing runs, including all shards in the folder, the number "
    "of runs with each status, and the time left.",
    "repose sweep status build/sweeps/lh3",
    NULL,
    .refuses = "A folder without a planned sweep.",
    .act = act_status_of};

static rp_status act_merge(cli_call *call, const void *values)
{
    (void)values;
    sweep_counts counts;
    int n = 0;
    while (cli_argument(call, n + 1)) n++;
    RP_TRY(sweep_merge(cli_argument(call, 0), sweep_protocols, (size_t)n, call->arguments + 1, &counts));
    if (n > 0) RP_TRY(sweep_status(cli_argument(call, 0), sweep_protocols, &counts)); /* its own shards too */
    cli_print_counts(call, &counts);
    return sweep_check_whole(cli_argument(call, 0), &counts);
}

static const cli_command merge = {
    "sweep merge",
    "merge the runs of shards and of other stores",
    "DIR...",
    "Copies the runs of the shards in the first folder, or of the other folders and stores, into the store "
    "of the first folder. The exit status is 1 while runs are missing.",
    "repose sweep merge build/sweeps/lh3",
    NULL,
    .refuses = "Different results for the same run; a store from a different protocol or version of the "
               "physics. Nothing is merged then.",
    .act = act_merge};

#define EXPORT_OPTIONS(X)                                                                                    \
    X(TEXT, o, "", "-", "", "file to write; - is standard output")                                           \
    X(BOOL, reduce, "", "false", "",                                                                         \
      "one row per grid point: mean, sd, se, 95 % interval (Student's t) and n of each output")              \
    CLI_FORCE(X, "replace an existing file")

CLI_OPTIONS(export, EXPORT_OPTIONS)

static rp_status act_export(cli_call *call, const void *values)
{
    const export_options *o = values;
    sweep_counts counts;
    RP_TRY(cli_sweep_export(call, cli_argument(call, 0), o->reduce ? SWEEP_POINTS : SWEEP_RUNS, o->o,
                            o->force, &counts));
    return rp_prefix(sweep_check_whole(cli_argument(call, 0), &counts), "the table is not whole: ");
}

static const cli_command export = {
    "sweep export",
    "write the runs, or their statistics, as a table",
    "DIR [--reduce] [-o FILE]",
    "Writes the stored runs as a table, one row for each run in the order of the plan. With --reduce, a run "
    "whose status starts with \"ok\" counts as a result (column n), and any other as failed (n_failed). "
    "Aborted runs (see `repose sweep run`) count as failed; the header then has their number. While runs are "
    "missing or aborted, the table has the other runs, and the exit status is 1.",
    "repose sweep export build/sweeps/lh3 --reduce -o build/tables/lh3.tsv",
    export_params,
    .refuses = "A file that exists, without --force.",
    .act = act_export};

static rp_status act_digest(cli_call *call, const void *values)
{
    (void)values;
    char text[33];
    size_t rows;
    RP_TRY(sweep_digest(cli_argument(call, 0), sweep_protocols, text, &rows));
    return fprintf(call->out, "%s\t%zu\n", text, rows), RP_OK;
}

static const cli_command digest = {"sweep digest",
                                   "print a digest of all results",
                                   "DIR",
                                   "Prints a digest (XXH3-128) of key, status and outputs of all runs, and "
                                   "the number of runs. The digest does not depend on the number of workers "
                                   "or on interruptions. The exit status is 1 while runs are missing.",
                                   "repose sweep digest build/sweeps/lh3",
                                   NULL,
                                   .refuses = "A folder without a planned sweep.",
                                   .act = act_digest};

static const cli_command *const commands[] = {&plan,   &run,    &status_of,      &merge,
                                              &export, &digest, &cmd_sweep_make, NULL};
const cli_command cmd_sweep = {"sweep", "plan, run and read parameter sweeps", .group = commands};
