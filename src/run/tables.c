/* Tables of a run; see tables.h. */
#include "run/tables.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <math.h>
#include <string.h>
#include <unistd.h>

#include "core/file.h"
#include "table/table.h"

static const char *const files[RUN_TABLES] = {"states.tsv", "energy.tsv", "contacts.tsv", "walls.tsv"};

static rp_status failed(const char *path)
{
    return rp_fail(RP_IO, "%s: %s", path, strerror(errno));
}

static rp_units units_of(const run_driver *d)
{
    return exp_scene(d->plan)->def.units;
}

static bool grows(const run_driver *d, int k)
{
    return d->to.folder && (!d->to.stages || k == RUN_ENERGY);
}

rp_status run_open_tables(run_driver *d, bool there)
{
    const int flags = O_RDWR | O_NOFOLLOW | O_CLOEXEC | (there ? 0 : O_CREAT | O_EXCL);
    for (int k = 0; k < RUN_TABLES; k++) {
        const char *path;
        if (!grows(d, k)) continue;
        RP_TRY(rp_path(&d->memory, &path, "%s/%s", d->to.folder, files[k]));
        const int file = open(path, flags, 0666);
        if (file < 0 || !(d->table[k] = fdopen(file, "r+"))) return failed(path);
    }
    if (d->to.states && !d->to.folder) d->table[RUN_STATES] = d->to.states;
    return RP_OK;
}

void run_close_tables(run_driver *d)
{
    for (int k = 0; k < RUN_TABLES; k++)
        if (grows(d, k) && d->table[k]) fclose(d->table[k]);
}

rp_status run_begin_tables(run_driver *d, bool there)
{
    const size_t n = exp_phase_count(d->plan);
    RP_NEW(&d->memory, d->passes, n);
    for (size_t k = 0; k < n; k++) d->passes[k] = exp_phase_at(d->run, k).passes;
    if (there || !exp_sim(d->run)) return RP_OK;
    for (int k = 0; k < RUN_TABLES; k++) {
        FILE *const out = d->table[k];
        d->written[k] = d->to.stages ? 0 : -1; /* a row of a sweep has no frame of the start */
        if (!out) continue;
        d->to.header(d->to.of, units_of(d), out);
        if (k == RUN_STATES) dem_write_notes(exp_sim(d->run), out);
        dem_write_columns((dem_table)k, exp_sim(d->run), out);
    }
    return run_write_frames(d, false, false);
}

rp_status run_sync(const run_driver *d)
{
    for (int k = 0; k < RUN_TABLES; k++) {
        if (!d->table[k]) continue;
        RP_TRY(rp_file_finish(d->table[k], files[k]));
        if (grows(d, k) && fsync(fileno(d->table[k])) != 0) return failed(files[k]);
    }
    return RP_OK;
}

rp_status run_keep_tables(run_driver *d, rp_snapshot *s)
{
    for (int k = 0; k < RUN_TABLES; k++) {
        FILE *const table = grows(d, k) ? d->table[k] : NULL;
        long length = s->reading || !table ? 0 : ftell(table);
        RP_KEEP(s, length);
        if (!s->reading || s->status || !table) continue;
        if (lseek(fileno(table), 0, SEEK_END) < length)
            return rp_fail(RP_BAD_INPUT, "%s: shorter than at the snapshot", files[k]);
        if (ftruncate(fileno(table), length) != 0 || fseek(table, 0, SEEK_END) != 0) return failed(files[k]);
    }
    return s->status;
}

rp_status run_write_frames(run_driver *d, bool stage, bool last)
{
    const long *every = d->to.every, step = exp_steps(d->run);
    const bool turn = every[RUN_CONTACTS] > 0 && step % every[RUN_CONTACTS] == 0;
    if (d->to.frame && (stage || last || turn)) d->to.frame(d->to.host, d->run);
    for (int k = 0; k < RUN_TABLES; k++) {
        const bool end = (stage || last) && !d->to.stages,
                   due = every[k] && (end || (every[k] > 0 && step % every[k] == 0));
        if (!due || !d->table[k] || d->written[k] == step) continue;
        RP_TRY(dem_write_rows((dem_table)k, exp_sim(d->run), step, d->table[k]));
        d->written[k] = step;
    }
    return RP_OK;
}

/* ---- tables that are written at once ---- */

typedef struct {
    const char *path;
    FILE *out;
} table;

static rp_status begin(run_driver *d, const char *name, table *t)
{
    RP_TRY(rp_path(&d->memory, &t->path, "%s/%s", d->to.folder, name));
    RP_TRY(rp_file_open(t->path, true, &t->out));
    d->to.header(d->to.of, units_of(d), t->out);
    return RP_OK;
}

/* The present state, as STAGE_grains.tsv and so on. */
static rp_status write_state(run_driver *d, const char *stage)
{
    static const struct {
        const char *name;
        dem_table table;
    } list[] = {{"grains", DEM_TABLE_STATES}, {"contacts", DEM_TABLE_CONTACTS}, {"walls", DEM_TABLE_WALLS}};
    for (size_t i = 0; i < sizeof list / sizeof *list; i++) {
        char name[64];
        table t;
        snprintf(name, sizeof name, "%s_%s.tsv", stage, list[i].name);
        RP_TRY(begin(d, name, &t));
        dem_write_columns(list[i].table, exp_sim(d->run), t.out);
        RP_TRY(rp_file_close(t.path, t.out,
                             dem_write_rows(list[i].table, exp_sim(d->run), exp_steps(d->run), t.out)));
    }
    return RP_OK;
}

rp_status run_write_stages(run_driver *d)
{
    for (size_t k = 0; k < exp_phase_count(d->plan); k++) {
        const exp_passed p = exp_phase_at(d->run, k);
        char stage[64];
        if (p.passes == d->passes[k]) continue;
        d->passes[k] = p.passes;
        snprintf(stage, sizeof stage, p.inner ? "%s_%ld" : "%s", p.name, p.passes);
        if (!p.inner || p.look) RP_TRY(write_state(d, stage));
    }
    return RP_OK;
}

static rp_status write_phases(run_driver *d)
{
    table t;
    RP_TRY(begin(d, "phases.tsv", &t));
    rp_table_header(t.out, units_of(d), "phase, passes, step, time [s]");
    for (size_t k = 0; k < exp_phase_count(d->plan); k++) {
        const exp_passed p = exp_phase_at(d->run, k);
        char time[32];
        if (p.passes > 0)
            fprintf(t.out, "%s\t%ld\t%ld\t%s\n", p.name, p.passes, p.step,
                    rp_number_text(p.time, 6, time, sizeof time));
    }
    return rp_file_close(t.path, t.out, RP_OK);
}

/* The text of this run, for `repose run`; not where its values are in other units. */
static rp_status write_text(run_driver *d)
{
    const dem_text *text = exp_text(d->plan);
    table t;
    if (text->lets.foreign) return RP_OK;
    RP_TRY(begin(d, "scene.cfg", &t));
    dem_text_write(text, d->seed, d->stream, t.out);
    return rp_file_close(t.path, t.out, RP_OK);
}

rp_status run_write_end(run_driver *d)
{
    const bool measures = d->to.folder && exp_has_phases(exp_text(d->plan));
    table t;
    if (!d->to.stages) RP_TRY(run_write_frames(d, false, true));
    for (size_t k = 0; measures && exp_series_name(d->plan, k); k++) {
        RP_TRY(begin(d, exp_series_name(d->plan, k), &t));
        exp_series_write(d->run, k, t.out);
        RP_TRY(rp_file_close(t.path, t.out, RP_OK));
    }
    if (measures && d->to.stages) {
        RP_TRY(write_phases(d));
        RP_TRY(write_state(d, "end"));
        RP_TRY(write_text(d));
    } else if (measures) {
        RP_TRY(begin(d, "measures.tsv", &t));
        run_write_measures(d, t.out);
        RP_TRY(rp_file_close(t.path, t.out, RP_OK));
    }
    return RP_OK;
}

static void note_let(const rp_let *let, FILE *out)
{
    char key[80];
    const rp_x_symbol *is = &let->is;
    snprintf(key, sizeof key, "let %.64s", let->name);
    if (is->type == RP_X_NUMBER)
        rp_table_note_number(out, key, is->value, "");
    else
        rp_table_note(out, key, "%s", is->type == RP_X_WORD ? is->word : is->value != 0.0 ? "true" : "false");
}

void run_write_measures(const run_driver *d, FILE *out)
{
    size_t n;
    uint64_t digest;
    const exp_output *o = exp_outputs(d->plan, &n);
    const exp_end *end = exp_ended(d->run);
    const rp_lets *lets = &exp_text(d->plan)->lets;
    rp_table_note(out, "status", "%s", end->status);
    if (*end->message) rp_table_note(out, "message", "%s", end->message);
    rp_table_note(out, "steps", "%ld", exp_steps(d->run));
    if (exp_sim(d->run) && !dem_digest(exp_sim(d->run), &digest))
        rp_table_note(out, "digest", "%016" PRIx64 " of the grains' places, velocities and forces", digest);
    for (size_t k = 0; k < lets->n; k++) note_let(&lets->lets[k], out);
    for (size_t k = 0; k < exp_phase_count(d->plan); k++) {
        const exp_passed p = exp_phase_at(d->run, k);
        char key[80];
        snprintf(key, sizeof key, "phase %.64s", p.name);
        if (p.passes > 0)
            rp_table_note(out, key, "%ld pass%s, to step %ld, t = %.15g", p.passes, p.passes > 1 ? "es" : "",
                          p.step, p.time);
    }
    rp_table_header(out, units_of(d), "measure, value, unit, meaning");
    for (size_t k = 0; k < n; k++) {
        const double value = exp_values(d->run)[k];
        fprintf(out, "%s\t", o[k].name);
        rp_table_numbers(out, 1, &value);
        fprintf(out, "\t%s\t%s%s%s\n", *o[k].unit ? o[k].unit : "-", o[k].meaning, isnan(value) ? "; " : "",
                isnan(value) ? exp_why_none(d->run, k) : "");
    }
}
