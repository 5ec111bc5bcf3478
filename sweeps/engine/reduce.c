/* From the store to tables: rows, grid points with their statistics, and the digest. */
#include "table/columns.h"
#include "sweeps/engine/private.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <xxhash.h>

#include "stats/stats.h"
#include "params/units.h"
#include "core/file.h"
#include "table/table.h"

typedef struct {
    const sweep_plan *plan;
    FILE *out;
    unsigned what;
    size_t n_outputs;
    /* the grid point that is being gathered */
    size_t point, n_rows, n_results;
    rp_tally causes;  /* of those without a result */
    size_t *n_finite; /* of each output */
    double *finite;   /* n_outputs x replicas */
    bool single;      /* a mean of one result */
} table;

/* Of the rows that are stored. */
typedef struct {
    const sweep_plan *plan;
    XXH3_state_t *state;
    size_t n_rows, n_outputs, n_makers, n_short; /* short: results with a standard error that is nan */
    double seconds;
    char text[33];
    struct {
        char program[256];
        size_t runs;
    } makers[32];
} digester;

static void add_maker(digester *d, const char *program)
{
    const size_t most = sizeof d->makers / sizeof *d->makers;
    size_t i = 0;
    while (i < d->n_makers && strcmp(d->makers[i].program, program) != 0) i++;
    if (i == most) return;
    if (i == d->n_makers)
        snprintf(d->makers[d->n_makers++].program, sizeof d->makers[i].program, "%s", program);
    d->makers[i].runs++;
}

static rp_status digest_row(const sweep_row *row, void *context)
{
    digester *d = context;
    char setting[33];
    sweep_plan_setting(d->plan, row->run, setting);
    XXH3_128bits_update(d->state, setting, sizeof setting);
    XXH3_128bits_update(d->state, row->result.status, strlen(row->result.status) + 1);
    XXH3_128bits_update(d->state, row->result.values, d->n_outputs * sizeof *row->result.values);
    if (isfinite(row->seconds)) d->seconds += row->seconds;
    if (row->program) add_maker(d, row->program);
    bool is_short = false;
    for (size_t i = 0; i < d->n_outputs && rp_is_result(row->result.status); i++)
        is_short |= isnan(row->result.values[i]) && rp_ends_in(d->plan->protocol->outputs[i].name, "_se");
    d->n_short += is_short;
    d->n_rows++;
    return RP_OK;
}

static rp_status find_digest(const sweep_plan *plan, sweep_store *store, digester *d)
{
    *d = (digester){
        .plan = plan, .state = XXH3_createState(), .n_outputs = sweep_count_outputs(plan->protocol)};
    XXH3_128bits_reset(d->state);
    rp_status status = sweep_store_visit(store, plan, true, digest_row, d);
    rp_hash_digits(XXH3_128bits_digest(d->state), d->text);
    XXH3_freeState(d->state);
    return status;
}

/* "8 of 15 (no_pile 6, overlap 2)": runs without a result, and why. */
static void note_failed(const sweep_counts *counts, FILE *out)
{
    char causes[1024];
    sweep_words(&counts->words, sweep_is_failed, causes);
    rp_table_note(out, "failed", *causes ? "%zu of %zu (%s)" : "%zu of %zu", counts->failed, counts->stored,
                  causes);
}

static rp_status write_head(const sweep_plan *plan, sweep_store *store, const char *command,
                            sweep_counts *counts, FILE *out)
{
    char text[256];
    digester digest;
    RP_TRY(sweep_store_note(store, "file", text, sizeof text));
    const char *name = basename(text);
    RP_TRY(sweep_store_count(store, plan, counts));
    RP_TRY(find_digest(plan, store, &digest));
    rp_table_provenance(out, plan->protocol->units, command);
    rp_table_note(out, "sweep", "%s, protocol %s, seed %lu, %zu grid points x %zu replicas%s", text,
                  plan->protocol->name, plan->seed, plan->n_points, plan->replicas,
                  plan->shared_piles ? ", shared piles" : "");
    for (size_t i = 0; i < digest.n_makers; i++)
        rp_table_note(out, "runs made by", "%s (%zu)", digest.makers[i].program, digest.makers[i].runs);
    rp_table_note(out, "source", "%.*s %s %zu", (int)strcspn(name, "."), name, digest.text, digest.n_rows);
    rp_table_note(out, "missing", "%zu of %zu", counts->planned - counts->stored, counts->planned);
    note_failed(counts, out);
    if (digest.n_short > 0)
        rp_table_note(out, "short series",
                      "%zu runs have nan as an _se; after repose run FILE --row N -o DIR, repose run "
                      "DIR/scene.cfg says why",
                      digest.n_short);
    if (sweep_count_aborted(counts) > 0)
        rp_table_note(out, "aborted", "%zu of the failed, to be tried again", sweep_count_aborted(counts));
    rp_table_note(out, "run_time", "%.1f s", digest.seconds);
    for (const rp_param *p = plan->protocol->schema; p->name; p++)
        if (!sweep_plan_is_axis(plan, p))
            rp_table_note(out, p->name, "%s%s%s",
                          rp_params_text(p, sweep_plan_point(plan, 0), text, sizeof text),
                          *p->unit ? " " : "", rp_unit(plan->protocol->units, p->unit));
    return RP_OK;
}

static void add_column(FILE *list, const char *name, const char *suffix, const char *unit)
{
    fprintf(list, "%s%s%s", name, *suffix ? "_" : "", suffix);
    fprintf(list, *unit ? " [%s], " : "%s, ", unit);
}

static rp_status write_columns(const table *t)
{
    const bool reduce = t->what & SWEEP_POINTS;
    const sweep_output *o = t->plan->protocol->outputs;
    char *text = NULL;
    size_t size;
    FILE *list = open_memstream(&text, &size);
    if (!list) return rp_fail(RP_NO_MEMORY, "table: out of memory");
    if (!reduce) fputs("run, status, ", list);
    for (size_t a = 0; a < t->plan->n_axes; a++)
        add_column(list, t->plan->axes[a].param->name, "", t->plan->axes[a].param->unit);
    for (const rp_param *p = t->plan->protocol->schema; t->what & SWEEP_PARAMETERS && p->name; p++)
        if (!sweep_plan_is_axis(t->plan, p)) add_column(list, p->name, "", p->unit);
    if (!reduce) fputs("replica, pile, ", list);
    for (size_t i = 0; i < t->n_outputs; i++)
        for (size_t k = 0; k < (reduce ? SWEEP_STATISTICS : 1); k++)
            add_column(list, o[i].name, reduce ? sweep_statistics[k] : "",
                       reduce && k == SWEEP_STATISTICS - 1 ? "" : o[i].unit);
    fputs(reduce ? "n, n_failed, failed_for" : "seconds [s]", list);
    fclose(list);
    rp_table_header(t->out, t->plan->protocol->units, text);
    free(text);
    return RP_OK;
}

static void write_parameter(FILE *out, const rp_param *param, const void *values)
{
    char text[256];
    rp_params_text(param, values, text, sizeof text);
    fprintf(out, "%s\t", *text ? text : "-");
}

static void write_parameters(const table *t, size_t point)
{
    const void *values = sweep_plan_point(t->plan, point);
    for (size_t a = 0; a < t->plan->n_axes; a++) write_parameter(t->out, t->plan->axes[a].param, values);
    for (const rp_param *p = t->plan->protocol->schema; t->what & SWEEP_PARAMETERS && p->name; p++)
        if (!sweep_plan_is_axis(t->plan, p)) write_parameter(t->out, p, values);
}

static rp_status write_run(const sweep_row *row, void *context)
{
    const table *t = context;
    double values[SWEEP_MAX_OUTPUTS + 1];
    fprintf(t->out, "%zu\t%s\t", row->run, row->result.status);
    write_parameters(t, row->run / t->plan->replicas);
    fprintf(t->out, "%zu\t%lu\t", row->run % t->plan->replicas, sweep_plan_stream(t->plan, row->run).pile);
    memcpy(values, row->result.values, t->n_outputs * sizeof *values);
    values[t->n_outputs] = row->seconds;
    rp_table_row(t->out, t->n_outputs + 1, values);
    return RP_OK;
}

/* Write the gathered grid point, unless none of its runs is stored, and start afresh. */
static void write_point(table *t)
{
    double values[SWEEP_MAX_OUTPUTS * SWEEP_STATISTICS + 2];
    char causes[1024];
    size_t n = 0;
    for (size_t i = 0; i < t->n_outputs; i++, n += SWEEP_STATISTICS) {
        stats_summary a;
        stats_mean(t->n_finite[i], t->finite + i * t->plan->replicas, &a); /* NaN without values */
        t->single |= t->n_rows > 0 && a.n == 1;
        memcpy(values + n, (double[]){a.mean, a.sd, a.se, a.lo, a.hi, (double)a.n},
               SWEEP_STATISTICS * sizeof *values);
    }
    values[n++] = (double)t->n_results;
    values[n++] = (double)(t->n_rows - t->n_results);
    if (t->n_rows > 0) {
        write_parameters(t, t->point);
        rp_tally_text(&t->causes, causes);
        rp_table_row_word(t->out, n, values, causes);
    }
    t->n_rows = t->n_results = 0;
    t->causes = (rp_tally){0};
    memset(t->n_finite, 0, t->n_outputs * sizeof *t->n_finite);
}

static rp_status gather(const sweep_row *row, void *context)
{
    table *t = context;
    size_t point = row->run / t->plan->replicas;
    if (point != t->point) write_point(t);
    t->point = point;
    t->n_rows++;
    if (!rp_is_result(row->result.status))
        return rp_tally_add(&t->causes, row->result.status, strlen(row->result.status), 1.0), RP_OK;
    t->n_results++;
    for (size_t i = 0; i < t->n_outputs; i++)
        if (isfinite(row->result.values[i]))
            t->finite[i * t->plan->replicas + t->n_finite[i]++] = row->result.values[i];
    return RP_OK;
}

static rp_status write_reduced(table *t, sweep_store *store)
{
    RP_SCOPE(memory);
    RP_NEW(&memory, t->n_finite, t->n_outputs);
    RP_NEW(&memory, t->finite, t->n_outputs * t->plan->replicas);
    FILE *const out = t->out;
    char *rows = NULL;
    size_t size;
    t->out = open_memstream(&rows, &size); /* the header says what the rows lack */
    rp_status status = t->out ? sweep_store_visit(store, t->plan, true, gather, t) : RP_NO_MEMORY;
    if (!status) write_point(t);
    if (t->out && fclose(t->out)) status = rp_fail(RP_NO_MEMORY, "table: out of memory");
    t->out = out;
    if (!status && t->single)
        rp_table_note(out, "errors", "nan where a mean is of one result; at least 2 needed");
    if (!status) status = write_columns(t);
    if (!status) fwrite(rows, 1, size, out);
    free(rows);
    return status;
}

rp_status sweep_export(const char *dir, const sweep_protocol *const *protocols, unsigned what,
                       const char *command, sweep_counts *counts, FILE *out)
{
    RP_ENDS(sweep_folder_close) sweep_folder f;
    sweep_counts unused;
    RP_TRY(sweep_folder_read(dir, protocols, &f));
    table t = {.plan = &f.plan, .out = out, .what = what, .n_outputs = sweep_count_outputs(f.plan.protocol)};
    RP_TRY(write_head(&f.plan, f.store, command, counts ? counts : &unused, out));
    if (!(what & SWEEP_POINTS)) RP_TRY(write_columns(&t));
    RP_TRY(what & SWEEP_POINTS ? write_reduced(&t, f.store)
                               : sweep_store_visit(f.store, &f.plan, true, write_run, &t));
    return rp_file_finish(out, "table");
}

rp_status sweep_columns(rp_arena *arena, const char *file, const sweep_protocol *const *protocols,
                        unsigned what, rp_table **columns)
{
    RP_ENDS(sweep_plan_free) sweep_plan plan;
    char *text;
    size_t size;
    RP_TRY(sweep_plan_read(file, protocols, &plan));
    FILE *out = open_memstream(&text, &size);
    if (!out) return rp_fail(RP_NO_MEMORY, "%s: out of memory", file);
    const rp_status status = write_columns(
        &(table){.plan = &plan, .out = out, .what = what, .n_outputs = sweep_count_outputs(plan.protocol)});
    fclose(out);
    if (status) return free(text), status;
    return rp_table_keep(arena, what & SWEEP_POINTS ? "points" : "runs", text, columns);
}

rp_status sweep_has(const char *file, const sweep_protocol *const *protocols, const char *name, bool *has)
{
    RP_ENDS(sweep_plan_free) sweep_plan plan;
    RP_TRY(sweep_plan_read(file, protocols, &plan));
    *has = sweep_plan_param(&plan, name) != NULL;
    return RP_OK;
}

rp_status sweep_digest(const char *dir, const sweep_protocol *const *protocols, char digest[33],
                       size_t *n_rows)
{
    RP_ENDS(sweep_folder_close) sweep_folder f;
    digester d;
    sweep_counts counts;
    RP_TRY(sweep_folder_read(dir, protocols, &f));
    RP_TRY(find_digest(&f.plan, f.store, &d));
    memcpy(digest, d.text, sizeof d.text);
    *n_rows = d.n_rows;
    RP_TRY(sweep_store_count(f.store, &f.plan, &counts));
    return rp_prefix(sweep_check_whole(dir, &counts), "no digest: ");
}
