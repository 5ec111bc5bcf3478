/* repose sweep plan|run|status|merge|export|digest|make|slurm|salvage */

#include <errno.h>
#include <glob.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

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
    const char *o, *tables, *shard, *time, *mem;
    long j, replicas, shards;
    bool reduce, study;
} options;

static const rp_param plan_options[] = {
    {"o", "", RP_TEXT, offsetof(options, o), NULL, "", "folder of the sweep; created if missing"},
    {"replicas", "", RP_INT, offsetof(options, replicas), "auto", "[1, 1000000] | auto",
     "runs per grid point; auto: the number in the file"},
    {0}};

static rp_status act_plan(const void *values)
{
    const options *o = values;
    sweep_counts counts;
    rp_status status = sweep_prepare(cli_argument(0), o->o, o->replicas > 0 ? (size_t)o->replicas : 0,
                                     sweep_protocols, cli_watch(), &counts);
    if (!status)
        printf("%s: %zu runs (%zu grid points x %zu replicas), %zu already stored\n", o->o, counts.planned,
               counts.points, counts.replicas, counts.stored);
    return status;
}

static const cli_command plan = {
    "sweep plan",
    "check a sweep file and plan its runs in a folder",
    "FILE -o DIR [--replicas N]",
    "Check a sweep file and every point of its grid, and plan its runs in a folder. Planning again\n"
    "after a change, or for more replicas, keeps all stored runs and reuses those that match. The file\n"
    "(libconfig syntax):\n"
    "\n"
    "  protocol = \"repose\";  replicas = 20;  seed = 1993;   # runs per grid point; seed: 0 to 2147483647\n"
    "  fixed = { W = 4.0; };                               # keys: repose params repose\n"
    "  grid  = { mu = [0.1, 0.2]; k_n = [1.0e5, 1.0e6]; }; # the product; with zip = true, in pairs\n"
    "  piles = \"own\";                                      # shared: the same piles at every grid point",
    "repose sweep plan sweeps/lh/lh3.cfg -o build/sweeps/lh3",
    plan_options,
    .act = act_plan};

static const rp_param run_options[] = {CLI_WORKERS(options),
                                       {"shard", "", RP_TEXT, offsetof(options, shard), "", "",
                                        "part of the runs, I/N with I from 1 to N, in a store of its own"},
                                       {0}};

/* "3/8" */
static rp_status read_shard(const char *text, int *shard, int *shards)
{
    int used = 0;
    *shard = *shards = 0;
    if (!*text || (sscanf(text, "%6d/%6d%n", shard, shards, &used) == 2 && !text[used] && *shards > 0))
        return RP_OK;
    return rp_fail(RP_BAD_INPUT, "--shard %s: I/N expected, as in 3/8", text);
}

static rp_status act_run(const void *values)
{
    const options *o = values;
    sweep_counts counts;
    int shard, shards;
    rp_status status = read_shard(o->shard, &shard, &shards);
    if (!status) status = cli_sweep_run(cli_argument(0), o->j, shard, shards, &counts);
    if (!status) print_counts(&counts);
    return status;
}

static const cli_command run = {
    "sweep run",
    "run what is planned and not yet stored",
    "DIR [-j N] [--shard I/N]",
    "Make all runs of a planned sweep that are not stored yet; each run is stored when it ends. After a\n"
    "stop, even by SIGKILL, only the runs in progress are lost; the same command resumes. Exit status 0\n"
    "if every run is stored, whatever its status; 75 if stopped. With --shard, machines that share the\n"
    "folder, or have copies of it, each make a part; `sweep merge` unites the parts.",
    "repose sweep run build/sweeps/lh3 -j 2",
    run_options,
    .act = act_run};

static rp_status act_status_of(const void *values)
{
    (void)values;
    sweep_counts counts;
    rp_status status = sweep_status(cli_argument(0), sweep_protocols, &counts);
    if (status) return status;
    const double left = counts.seconds * (double)(counts.planned - counts.stored);
    rp_table_note(stdout, "running", "%zu", counts.running);
    if (isfinite(left)) rp_table_note(stdout, "left", "%.3g s of one core", left);
    if (*counts.shards) rp_table_note(stdout, "shards with missing runs", "%s", counts.shards);
    print_counts(&counts);
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
    .act = act_status_of};

static rp_status act_merge(const void *values)
{
    (void)values;
    sweep_counts counts;
    sweep_merged merged = {0};
    int n = 0;
    while (cli_argument(n + 1)) n++;
    rp_status status =
        sweep_merge(cli_argument(0), sweep_protocols, (size_t)n, cli_arguments() + 1, &merged, &counts);
    if (status) return status;
    rp_table_note(stdout, "merged",
                  "%zu rows of %zu stores, %zu duplicates, %zu rows of other plans left out", merged.taken,
                  merged.stores, merged.duplicates, merged.foreign);
    if (*counts.shards) rp_table_note(stdout, "shards with missing runs", "%s", counts.shards);
    print_counts(&counts);
    return counts.stored < counts.planned
               ? rp_fail(RP_NO_RESULT, "%s: %zu of %zu runs are missing", cli_argument(0),
                         counts.planned - counts.stored, counts.planned)
               : RP_OK;
}

static const cli_command merge = {
    "sweep merge",
    "take the rows of shards and of other stores",
    "DIR...",
    "Take the rows of the shards of the first folder, or of the further folders and stores, into its\n"
    "store. Refused, with nothing taken: two results of the same run that differ; a store of another "
    "protocol\n"
    "or another model of the physics; a damaged store. Exit status 1 while runs are missing.",
    "repose sweep merge build/sweeps/lh3",
    NULL,
    .act = act_merge};

static const rp_param slurm_options[] = {
    {"shards", "", RP_INT, offsetof(options, shards), NULL, "[1, 100000]", "jobs of the array"},
    {"j", "", RP_INT, offsetof(options, j), "1", "[1, 4096]", "processors of each job, and its workers"},
    {"time", "", RP_TEXT, offsetof(options, time), "1:00:00", "",
     "longest time of a job, as sbatch takes it"},
    {"mem", "", RP_TEXT, offsetof(options, mem), "1G", "", "memory of each processor"},
    {0}};

static const char array_script[] =
    "#!/bin/bash\n"
    "# Runs what is missing of a sweep; submit again to resume. A job that is about to run out of time is "
    "told\n"
    "# two minutes before, stores what is done, and is queued again.\n"
    "#SBATCH --job-name=repose\n"
    "#SBATCH --array=1-%ld\n"
    "#SBATCH --cpus-per-task=%ld\n"
    "#SBATCH --time=%s\n"
    "#SBATCH --mem-per-cpu=%s\n"
    "#SBATCH --signal=B:TERM@120\n"
    "#SBATCH --requeue\n"
    "#SBATCH --open-mode=append\n"
    "#SBATCH --output=%s/shards/%%a-of-%ld.log\n"
    "'%s' sweep run '%s' --shard $SLURM_ARRAY_TASK_ID/%ld -j %ld &\n"
    "trap 'kill -TERM %%1' TERM\n"
    "wait %%1; status=$?\n"
    "if [ $status -gt 128 ]; then wait %%1; status=$?; fi # the signal ended the first wait\n"
    "if [ $status = 75 ]; then scontrol requeue \"${SLURM_ARRAY_JOB_ID}_$SLURM_ARRAY_TASK_ID\"; fi\n"
    "exit $status\n";

static rp_status act_slurm(const void *values)
{
    const options *o = values;
    char *dir = realpath(cli_argument(0), NULL), *self = realpath("/proc/self/exe", NULL), path[4096];
    FILE *out = NULL;
    rp_status status = dir && self ? RP_OK : rp_fail(RP_BAD_INPUT, "%s: no such folder", cli_argument(0));
    if (!status && (strpbrk(dir, "'\n%") || strpbrk(self, "'\n%") ||
                    o->time[strspn(o->time, "0123456789:-")] || o->mem[strspn(o->mem, "0123456789KMGT")]))
        status = rp_fail(RP_BAD_INPUT, "--time 1:00:00 and --mem 1G expected, and a folder without ' and %%");
    snprintf(path, sizeof path, "%s/shards", status ? "" : dir);
    if (!status) status = rp_make_directory(path);
    snprintf(path, sizeof path, "%s/array.sh", status ? "" : dir);
    if (!status) status = rp_file_open(path, &out);
    if (!status) {
        fprintf(out, array_script, o->shards, o->j, o->time, o->mem, dir, o->shards, self, dir, o->shards,
                o->j);
        status = rp_file_close(path, out, RP_OK);
    }
    if (!status)
        printf("sbatch %s\nparallel --sshlogin HOST1,HOST2 %s sweep run %s --shard {}/%ld -j %ld ::: $(seq "
               "%ld)\n"
               "repose sweep merge %s\n",
               path, self, dir, o->shards, o->j, o->shards, dir);
    free(dir);
    free(self);
    return status;
}

static const cli_command slurm = {
    "sweep slurm",
    "write a job array for Slurm",
    "DIR --shards N [-j N] [--time T] [--mem M]",
    "Write DIR/array.sh, a job array for Slurm with a shard a job, and print the commands that submit it,\n"
    "that do the same by GNU parallel over ssh, and that unite the shards. The folder is one that all\n"
    "machines share.",
    "repose sweep slurm build/sweeps/lh3 --shards 8 --time 0:30:00",
    slurm_options,
    .act = act_slurm};

static rp_status act_salvage(const void *values)
{
    (void)values;
    size_t n = 0;
    rp_status status = sweep_salvage(cli_argument(0), sweep_protocols, &n);
    if (!status) printf("%s: %zu whole rows; the damaged store is damaged.sqlite\n", cli_argument(0), n);
    return status;
}

static const cli_command salvage = {
    "sweep salvage",
    "get the whole rows out of a damaged store",
    "DIR",
    "Put a new store in place of a damaged or truncated one, with all rows whose checksum is right. The\n"
    "damaged file is kept as DIR/damaged.sqlite; `sweep run` makes the lost runs again.",
    "repose sweep salvage build/sweeps/lh3",
    NULL,
    .act = act_salvage};

static const rp_param export_options[] = {
    {"o", "", RP_TEXT, offsetof(options, o), "-", "", "file to write; - is standard output"},
    {"reduce", "", RP_BOOL, offsetof(options, reduce), "false", "",
     "one row per grid point: mean, sd, se, 95 % interval (Student's t) and n of each output"},
    {0}};

static rp_status act_export(const void *values)
{
    const options *o = values;
    FILE *out;
    rp_status status = rp_file_open(o->o, &out);
    if (status) return status;
    status = sweep_export(cli_argument(0), sweep_protocols, o->reduce, cli_command_line(), out);
    return rp_file_close(o->o, out, status);
}

static const cli_command export = {
    "sweep export",
    "write the runs, or their statistics, as a table",
    "DIR [--reduce] [-o FILE]",
    "Write the stored runs as a table, one row per run in the order of the plan. With --reduce, a run\n"
    "whose status starts with \"ok\" counts as a result (column n), any other as failed (n_failed).",
    "repose sweep export build/sweeps/lh3 --reduce -o build/tables/lh3.tsv",
    export_options,
    .act = act_export};

static rp_status act_digest(const void *values)
{
    (void)values;
    char text[33];
    size_t rows;
    rp_status status = sweep_digest(cli_argument(0), sweep_protocols, text, &rows);
    if (!status) printf("%s\t%zu\n", text, rows);
    return status;
}

static const cli_command digest = {
    "sweep digest",
    "print a digest of all results",
    "DIR",
    "Digest (XXH3-128) of key, status and outputs of all rows, and the number of rows. The digest does\n"
    "not depend on the number of workers or on interruptions. Exit status 1 while rows are missing.",
    "repose sweep digest build/sweeps/lh3",
    NULL,
    .act = act_digest};

/* In the child: this program with the words of `command`, standard output in `out`. @ is the tables' folder,
 * and * stands for what is there. */
static void become(const char *command, const char *tables, FILE *out)
{
    glob_t words = {0};
    char *text = strdup(command), *save;
    if (!text || glob("repose", GLOB_NOCHECK, NULL, &words)) _exit(RP_NO_MEMORY);
    for (char *word = strtok_r(text, " ", &save); word; word = strtok_r(NULL, " ", &save)) {
        char full[4096];
        snprintf(full, sizeof full, "%s%s", *word == '@' ? tables : "", *word == '@' ? word + 1 : word);
        if (glob(full, GLOB_NOCHECK | GLOB_APPEND, NULL, &words)) _exit(RP_NO_MEMORY);
    }
    if (dup2(fileno(out), STDOUT_FILENO) >= 0) execv("/proc/self/exe", words.gl_pathv);
    _exit(RP_IO);
}

/* Make one derived table. A command that finds no result is an answer too, if it prints a table. */
static rp_status make_table(const sweep_table *table, const char *tables)
{
    char path[4096];
    FILE *out;
    int code = 0;
    snprintf(path, sizeof path, "%s/%s.tsv", tables, table->name);
    rp_status status = rp_file_open(path, &out);
    if (status) return status;
    const pid_t child = fork();
    if (child == 0) become(table->command, tables, out);
    while (child > 0 && waitpid(child, &code, 0) < 0 && errno == EINTR) {
    }
    if (child < 0 || !WIFEXITED(code))
        status = rp_fail(RP_STOPPED, "%s: repose %s: stopped", table->name, table->command);
    else if (WEXITSTATUS(code) > RP_NO_RESULT)
        status = rp_fail((rp_status)WEXITSTATUS(code), "%s: repose %s: exit status %d", table->name,
                         table->command, WEXITSTATUS(code));
    return rp_file_close(path, out, status);
}

static rp_status export_to(const options *o, const char *name, const char *suffix, bool reduce)
{
    char path[4096];
    FILE *out;
    snprintf(path, sizeof path, "%s/%s%s.tsv", o->tables, name, suffix);
    rp_status status = rp_file_open(path, &out);
    if (!status) status = sweep_export(o->o, sweep_protocols, reduce, cli_command_line(), out);
    return out ? rp_file_close(path, out, status) : status;
}

static rp_status make_runs(const options *o, const sweep_recipe *recipe)
{
    size_t replicas = o->replicas > 0 ? (size_t)o->replicas : o->study ? recipe->study : 0;
    sweep_counts counts;
    rp_status status = sweep_prepare(cli_argument(0), o->o, replicas, sweep_protocols, cli_watch(), &counts);
    if (!status) status = cli_sweep_run(o->o, o->j, 0, 0, &counts);
    if (!status) status = export_to(o, recipe->name, "_runs", false);
    if (!status) status = export_to(o, recipe->name, "", true);
    return status;
}

static const rp_param make_options[] = {
    {"o", "", RP_TEXT, offsetof(options, o), NULL, "", "folder of the sweep; created if missing"},
    {"tables", "", RP_TEXT, offsetof(options, tables), "build/tables", "", "folder of the tables"},
    CLI_WORKERS(options),
    {"replicas", "", RP_INT, offsetof(options, replicas), "auto", "[1, 1000000] | auto",
     "runs per grid point; auto: the number in the file"},
    {"study", "", RP_BOOL, offsetof(options, study), "false", "",
     "runs per grid point: the number `study` of the file"},
    {0}};

static rp_status act_make(const void *values)
{
    const options *o = values;
    sweep_recipe recipe;
    rp_status status = sweep_recipe_read(cli_argument(0), &recipe);
    if (!status) status = rp_make_directory(o->tables);
    if (!status && recipe.has_runs) status = make_runs(o, &recipe);
    for (size_t i = 0; !status && i < recipe.n_tables; i++) status = make_table(&recipe.tables[i], o->tables);
    sweep_recipe_free(&recipe);
    return status;
}

static const cli_command make = {
    "sweep make",
    "plan, run, and write all tables of the sweep file",
    "FILE -o DIR [--tables DIR] [-j N] [--replicas N | --study]",
    "Plan a sweep, make its missing runs, and write its tables: NAME_runs.tsv, NAME.tsv, one row per\n"
    "grid point, and those that the file derives from them, in order. @ is the folder of the tables:\n"
    "\n"
    "  study  = 60;                                        # runs per grid point with --study\n"
    "  tables = [\"lh3_phi = angle phi @/lh3_runs.tsv\"];     # NAME = COMMAND of repose\n"
    "\n"
    "A file without a protocol has tables alone.",
    "repose sweep make sweeps/li/tent.cfg -o build/sweeps/tent",
    make_options,
    .act = act_make};

static const cli_command *const commands[] = {&plan,   &run,  &status_of, &merge,   &export,
                                              &digest, &make, &slurm,     &salvage, NULL};
const cli_command cmd_sweep = {"sweep", "plan, run and read parameter sweeps", .group = commands};
