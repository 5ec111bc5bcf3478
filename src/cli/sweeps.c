/* What several commands do with a sweep; see cli.h. */
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "cli/cli.h"
#include "cli/progress.h"
#include "core/clock.h"

rp_status cli_sweep_plan(const char *file, const char *directory, size_t replicas, bool quiet,
                         sweep_counts *counts)
{
    cli_progress progress = cli_progress_start(quiet, isatty(STDERR_FILENO), rp_clock(), 0, 0);
    const rp_status status = sweep_prepare_seen(file, directory, replicas, sweep_protocols,
                                                cli_progress_planning, &progress, counts);
    if (progress.drawn) fputc('\n', stderr);
    return status;
}

rp_status cli_sweep_run(const char *dir, sweep_options options, bool quiet, sweep_counts *counts)
{
    cli_progress progress;
    if (options.workers < 1) options.workers = (int)sysconf(_SC_NPROCESSORS_ONLN);
    cli_sweep_progress(&options, quiet, &progress);
    rp_status status = sweep_run(dir, sweep_protocols, &options, counts);
    if (progress.drawn) fputc('\n', stderr);
    return status;
}

void cli_result_row(const cli_call *call, const rp_param *schema, const void *parameters,
                    const sweep_output *outputs, const sweep_result *result)
{
    const char *columns[40 + SWEEP_MAX_OUTPUTS + 1][2];
    char text[64];
    size_t n = 0, n_outputs = 0;
    for (const rp_param *p = schema; p && p->name; p++, n++) columns[n][0] = p->name, columns[n][1] = p->unit;
    for (const sweep_output *p = outputs; p->name; p++, n++, n_outputs++)
        columns[n][0] = p->name, columns[n][1] = p->unit;
    columns[n][0] = "status", columns[n][1] = "";
    rp_table_columns(call->out, call->units, n + 1, (const char *const(*)[2])columns);
    for (const rp_param *p = schema; p && p->name; p++)
        fprintf(call->out, "%s\t", *rp_params_text(p, parameters, text, sizeof text) ? text : "nan");
    rp_table_row_word(call->out, n_outputs, result->values, result->status);
}

void cli_print_counts(const cli_call *call, const sweep_counts *counts)
{
    rp_table_note(call->out, "planned", "%zu", counts->planned);
    rp_table_note(call->out, "stored", "%zu", counts->stored);
    rp_table_note(call->out, "missing", "%zu", counts->planned - counts->stored);
    if (sweep_count_aborted(counts) > 0)
        rp_table_note(call->out, "aborted", "%zu, to be tried again", sweep_count_aborted(counts));
    rp_table_columns(call->out, RP_CGS, 2, (const char *const[][2]){{"status", ""}, {"runs", ""}});
    for (size_t i = 0; i < counts->words.n; i++)
        fprintf(call->out, "%s\t%.0f\n", counts->words.of[i].word, counts->words.of[i].times);
}

rp_status cli_sweep_export(const cli_call *call, const char *dir, unsigned what, const char *path,
                           bool replace, sweep_counts *counts)
{
    FILE *out;
    if (strcmp(path, "-") == 0)
        return sweep_export(dir, sweep_protocols, what, call->line, counts, call->out);
    RP_TRY(rp_file_open(path, replace, &out));
    return rp_file_close(path, out, sweep_export(dir, sweep_protocols, what, call->line, counts, out));
}

rp_status cli_sweep_table(const cli_call *call, const char *path, unsigned what, rp_table **table,
                          sweep_counts *counts)
{
    char *text;
    size_t size;
    FILE *out = open_memstream(&text, &size);
    if (!out) return rp_fail(RP_NO_MEMORY, "%s: out of memory", path);
    const rp_status status = sweep_export(path, sweep_protocols, what, call->line, counts, out);
    fclose(out);
    if (status) return free(text), status;
    return rp_table_keep(call->arena, path, text, table);
}

rp_status cli_claim_sweep(const char *directory, const char *file, bool force)
{
    char sweep[256];
    rp_status status = sweep_source(directory, sweep);
    if (status || force || !*sweep || strcmp(basename(sweep), basename(file)) == 0)
        return force ? RP_OK : status;
    return rp_fail(
        RP_BAD_INPUT,
        "%s: holds the sweep %s; give another folder, or --force to plan %s there (stored runs are kept)",
        directory, sweep, file);
}
