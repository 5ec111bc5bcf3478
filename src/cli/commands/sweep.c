/* repose sweep plan|run|status|merge|export|digest|make */
#include "cli/cli.h"
#include "cli/progress.h"
#include "core/plain.h"

#define PLAN_OPTIONS(X)                                                                                      \
    X(TEXT, o, "", NULL, "", "folder of the sweep; created if missing")                                      \
    X(INT, replicas, "", "auto", "[1, 1000000] | auto", "runs per grid point; auto: the number in the file") \
    CLI_FORCE(X)

CLI_OPTIONS(plan, PLAN_OPTIONS)

static rp_status act_plan(cli_call *call, const void *values)
{
    const plan_options *o = values;
    sweep_counts counts;
    RP_TRY(cli_claim_sweep(o->o, cli_argument(call, 0), o->force));
    RP_TRY(cli_sweep_plan(cli_data(call->arena, cli_argument(call, 0)), o->o,
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
    "Check a sweep file and every point of its grid, and plan its runs in a folder. Planning again after a "
    "change, or for more replicas, keeps all stored runs and reuses those that match. A folder with a sweep "
    "of another name, or with a run, is refused without --force. The file (libconfig syntax):\n"
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

#define RUN_OPTIONS(X)                                                                                       \
    CLI_QUIET(X)                                                                                             \
    CLI_WORKERS(X)                                                                                           \
    CLI_LIMITS(X)                                                                                            \
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
    if (!status || status == RP_NO_RESULT) cli_print_counts(call, &counts);
    return status;
}

static const cli_command run = {
    "sweep run",
    "run what is planned and not yet stored",
    "DIR [-j N] [--mem MB] [--time S] [--shard I/N] [--snapshot S]",
    "Make all runs of a planned sweep that are not stored yet; each run is stored when it ends. After a "
    "stop, even by SIGKILL, the same command resumes. Long runs resume from their last snapshots (all "
    "protocols but pile), with the same bits; SIGINT, SIGTERM and SIGHUP write these, a second signal ends "
    "the sweep at once. Exit status 0 if every run is stored with its outcome; 75 if stopped; 1 while runs "
    "are aborted, which the same command tries again: status crashed (its worker died, three times), "
    "no_memory, time_limit. With --shard, machines that share the folder, or have copies of it, each make a "
    "part; `sweep merge` unites the parts.",
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
    if (isfinite(left)) rp_table_note(call->out, "left", "%.3g s of one core", left);
    cli_print_counts(call, &counts);
    return RP_OK;
}

static const cli_command status_of = {
    "sweep status",
    "numbers of stored runs and of each status",
    "DIR",
    "Numbers of planned, stored and missing runs, and of runs with each status, with all shards in the "
    "folder; the time left.",
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
    "take the rows of shards and of other stores",
    "DIR...",
    "Take the rows of the shards of the first folder, or of the further folders and stores, into its store. "
    "Refused, with nothing taken: two results of the same run that differ; a store of another protocol or "
    "another model of the physics. Exit status 1 while runs are missing.",
    "repose sweep merge build/sweeps/lh3",
    NULL,
    .refuses = "Two results of the same run that differ; a store of another protocol or another model of the "
               "physics.\nNothing is taken then.",
    .act = act_merge};

#define EXPORT_OPTIONS(X)                                                                                    \
    X(TEXT, o, "", "-", "", "file to write; - is standard output")                                           \
    X(BOOL, reduce, "", "false", "",                                                                         \
      "one row per grid point: mean, sd, se, 95 % interval (Student's t) and n of each output")              \
    CLI_FORCE(X)

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
    "Write the stored runs as a table, one row per run in the order of the plan. With --reduce, a run whose "
    "status starts with \"ok\" counts as a result (column n), any other as failed (n_failed). Runs that are "
    "aborted (see sweep run) are among the failed; the header then has their number. While runs are missing "
    "or aborted, the table has the others, and the exit status is 1.",
    "repose sweep export build/sweeps/lh3 --reduce -o build/tables/lh3.tsv",
    export_params,
    .refuses = "A file that is there, without --force.",
    .act = act_export};

static rp_status act_digest(cli_call *call, const void *values)
{
    (void)values;
    char text[33];
    size_t rows;
    RP_TRY(sweep_digest(cli_argument(call, 0), sweep_protocols, text, &rows));
    return fprintf(call->out, "%s\t%zu\n", text, rows), RP_OK;
}

static const cli_command digest = {
    "sweep digest",
    "print a digest of all results",
    "DIR",
    "Digest (XXH3-128) of key, status and outputs of all rows, and the number of rows. The digest does not "
    "depend on the number of workers or on interruptions. Exit status 1 while rows are missing.",
    "repose sweep digest build/sweeps/lh3",
    NULL,
    .refuses = "A folder without a planned sweep.",
    .act = act_digest};

static const cli_command *const commands[] = {&plan,   &run,    &status_of,      &merge,
                                              &export, &digest, &cmd_sweep_make, NULL};
const cli_command cmd_sweep = {"sweep", "plan, run and read parameter sweeps", .group = commands};
