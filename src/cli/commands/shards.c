/* repose sweep merge|slurm: several stores of one sweep. */
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "cli/cli.h"

static rp_status act_merge(cli_call *call, const void *values)
{
    (void)values;
    sweep_counts counts;
    int n = 0;
    while (cli_argument(call, n + 1)) n++;
    RP_TRY(sweep_merge(cli_argument(call, 0), sweep_protocols, (size_t)n, call->arguments + 1, &counts));
    if (n > 0) RP_TRY(sweep_status(cli_argument(call, 0), sweep_protocols, &counts)); /* its own shards too */
    if (*counts.shards) rp_table_note(stdout, "shards with missing runs", "%s", counts.shards);
    cli_print_counts(&counts);
    return sweep_check_whole(cli_argument(call, 0), &counts);
}

const cli_command cmd_sweep_merge = {
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

#define SLURM_OPTIONS(X)                                                                                     \
    X(INT, shards, "", NULL, "[1, 100000]", "jobs of the array")                                             \
    X(INT, j, "", "1", "[1, 4096]", "worker processes of each job, and its processors")                      \
    X(TEXT, time, "", "1:00:00", "", "longest time of a job, as sbatch takes it")                            \
    X(TEXT, mem, "", "1G", "", "memory of each processor")                                                   \
    CLI_FORCE(X)

CLI_OPTIONS(slurm, SLURM_OPTIONS)

enum { MOST_TASKS = 1000 }; /* of an array: Slurm's MaxArraySize is 1001 where no one has set it */

/* The job is told before its time is out, then ends its processes and queues again; a cancelled one ends. */
static const char array_script[] =
    "#!/bin/bash\n"
    "# Makes what is missing of a sweep, written by repose sweep slurm; submit it again to resume.\n"
    "#SBATCH --job-name=repose\n"
    "#SBATCH --array=1-%ld\n"
    "#SBATCH --cpus-per-task=%ld\n"
    "#SBATCH --time=%s\n"
    "#SBATCH --mem-per-cpu=%s\n"
    "#SBATCH --signal=B:USR1@120\n"
    "#SBATCH --requeue\n"
    "#SBATCH --output=/dev/null\n" /* a pattern there, so that a folder's name is none */
    "exec >>%s/shards/$SLURM_ARRAY_TASK_ID-of-%ld.log 2>&1\n"
    "%s sweep run %s --shard $SLURM_ARRAY_TASK_ID/%ld -j %ld &\n"
    "late=\n"
    "trap 'late=yes; kill -TERM %%1' USR1\n"
    "trap 'kill -TERM %%1' TERM\n"
    "wait %%1; status=$?\n"
    "while [ $status -gt 128 ]; do wait %%1; status=$?; done # a signal ends a wait, not the process\n"
    "if [ \"$late\" ] && [ $status = 75 ]; then\n"
    "  scontrol requeue \"${SLURM_ARRAY_JOB_ID}_$SLURM_ARRAY_TASK_ID\"\n"
    "fi\n"
    "exit $status\n";

/* A word for the shell that stands for this text, whatever is in it. */
static const char *quoted(rp_arena *arena, const char *text)
{
    static const char plain[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_./+-=:@,%";
    if (*text && !text[strspn(text, plain)]) return text;
    const char *word = "'";
    for (size_t n; *text; text += n + (text[n] == '\'')) {
        n = strcspn(text, "'");
        word = rp_text(arena, "%s%.*s%s", word, (int)n, text, text[n] ? "'\\''" : "");
    }
    return rp_text(arena, "%s'", word);
}

static rp_status act_slurm(cli_call *call, const void *values)
{
    const slurm_options *o = values;
    char dir[PATH_MAX], self[PATH_MAX];
    const char *shards, *path;
    FILE *out;
    if (!realpath(cli_argument(call, 0), dir) || !rp_program(self, sizeof self))
        return rp_fail(RP_BAD_INPUT, "%s: no such folder", cli_argument(call, 0));
    if (!rp_is_in(dir, "sweep.cfg"))
        return rp_fail(RP_BAD_INPUT, "%s: no sweep.cfg; `repose sweep plan` makes it", cli_argument(call, 0));
    if (o->shards > MOST_TASKS)
        return rp_fail(
            RP_BAD_INPUT,
            "--shards %ld: Slurm takes arrays of up to %d tasks, unless its MaxArraySize is raised; "
            "give --shards %d at most, and each more processors with -j",
            o->shards, MOST_TASKS, MOST_TASKS);
    if (o->time[strspn(o->time, "0123456789:-")] || o->mem[strspn(o->mem, "0123456789KMGT")])
        return rp_fail(RP_BAD_INPUT, "--time 1:00:00 and --mem 1G expected");
    RP_TRY(rp_path(call->arena, &shards, "%s/shards", dir));
    RP_TRY(rp_path(call->arena, &path, "%s/array.sh", dir));
    RP_TRY(rp_file_open(path, o->force, &out));
    const char *folder = quoted(call->arena, dir), *program = quoted(call->arena, self),
               *script = rp_text(call->arena, array_script, o->shards, o->j, o->time, o->mem, folder,
                                 o->shards, program, folder, o->shards, o->j);
    fputs(script, out);
    RP_TRY(rp_file_close(path, out, rp_make_directory(shards)));
    printf(
        "sbatch %s\nparallel -q --sshlogin HOST1,HOST2 %s sweep run %s --shard {}/%ld -j %ld ::: $(seq %ld)\n"
        "repose sweep merge %s\n",
        quoted(call->arena, path), program, folder, o->shards, o->j, o->shards, folder);
    return RP_OK;
}

const cli_command cmd_sweep_slurm = {
    "sweep slurm",
    "write a job array for Slurm",
    "DIR --shards N [-j N] [--time T] [--mem M]",
    "Write DIR/array.sh, a job array for Slurm with a shard a job, and print the commands that submit it, "
    "that do the same by GNU parallel over ssh, and that unite the shards. The folder is one that all "
    "machines share.",
    "repose sweep slurm build/sweeps/lh3 --shards 8 --time 0:30:00",
    slurm_params,
    .refuses =
        "A folder without a sweep; times and sizes that sbatch would not take; more than 1000 shards,\n"
        "the usual limit of an array: give each more processors (-j); an array.sh of other options, or "
        "changed.",
    .prints_text = true,
    .act = act_slurm};
