/* `repose run`: any scene from a file, with snapshots from which it resumes; or one run of a sweep again with
 * its tables. */
#include <inttypes.h>
#include <limits.h>
#include <math.h>
#include <signal.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <xxhash.h>

#include "cli/cli.h"
#include "export/export.h"
#include "cli/unfinished.h"
#include "cli/progress.h"
#include "cli/closing.h"
#include "core/clock.h"
#include "params/config.h"
#include "params/units.h"
#include "dem/scene/text.h"
#include "experiment/experiment.h"
#include "sweeps/protocols/protocols.h"

#define RUN_OPTIONS(X)                                                                                       \
    X(TEXTS, set, "", "", "",                                                                                \
      "KEY=VALUE, GROUP.KEY=VALUE or walls[0].KEY=VALUE replaces a key; may be repeated")                    \
    X(INT, every, "steps", "auto", "[1, 2147483647] | auto",                                                 \
      "interval of the frames (of a sweep's run: energies) written; auto: the last, and the ends of phases " \
      "(energies: 100)")                                                                                     \
    X(TEXT, o, "", "", "", "folder for tables, instead of standard output")                                  \
    X(BOOL, ledger, "", "false", "",                                                                         \
      "add the terms of the energy ledger to the energies; as `ledger = true` in a scene")                   \
    X(INT, j, "", "1", "[1, 256]",                                                                           \
      "threads of one scene of some 16000 grains or more; the bits are the same for any number")             \
    X(INT, row, "", "0", "[0, 2147483647]", "number of the sweep's run, from 0")                             \
    X(INT, snapshot, "steps", "0", "[0, 2147483647]",                                                        \
      "interval of the snapshots in DIR/unfinished; 0: none; needs -o")                                      \
    X(CHOICE, dump, "", "none", "none | lammps | xyz | vtk",                                                 \
      "write the frames for another program too, as `repose export` does; needs -o")                         \
    X(TEXT, from, "", "", "",                                                                                \
      "begin where a run in this folder has kept the end of a phase, of a text that is the same up to "      \
      "there")                                                                                               \
    CLI_FORCE(X)                                                                                             \
    CLI_QUIET(X)                                                                                             \
    X(TEXT, resume, "", "", "", "resume from the snapshot in this folder, with the options of the start")

CLI_OPTIONS(run, RUN_OPTIONS)

/* What a run is to do. A snapshot keeps it. */
typedef struct {
    long steps, every[CLI_GROWING], snapshot, dump; /* every: as dem_intervals, of the tables below */
    bool ledger, phases, stages; /* the last: a frame at the end of each phase of the top level */
    XXH128_hash_t scene;
} run_plan;

/* Energy without source must not grow. Samples of the first and of the last quarter of a long run are
 * compared: a step near the limit of stability heats a scene with little damping, slowly, endlessly. */
enum { SAMPLES = 64, LEAST_STEPS = 100 * SAMPLES };
static const double MOST_GROWTH = 0.02; /* of the largest sum of kinetic and elastic energy */

typedef struct {
    long every; /* steps; 0: no such scene */
    size_t n, grains;
    double first, last, scale;
} growth;

/* A scene as its file has it, and what it says of phases; NULL without. */
typedef struct {
    dem_text text;
    dem_scene scene;
    exp_plan *phases;
} scene_text;

/* A scene run in the making. */
typedef struct {
    run_plan plan;
    growth energy;
    cli_rest rest;
    dem_sim *sim;               /* with phases theirs */
    exp_run *exp;               /* NULL: no phases */
    unsigned long streams[2];   /* seed and run, of phases */
    char line[4096], run[1024]; /* of its start, for tables that are written at the end */
    long threads;
} scene_run;

/* Of what a folder's tables are, in their header and in the folder's marker. */
typedef struct {
    const cli_call *call;
    char run[1024], holds[2048];
    const char *start;      /* what is to be known of it, or NULL */
    const exp_plan *phases; /* NULL: none */
} origin;

static void put_origin(const void *context, FILE *out)
{
    const origin *of = context;
    cli_provenance(of->call, out);
    rp_table_note(out, "run", "%s", of->run);
    if (of->start) rp_table_note(out, "start", "%s", of->start);
}

static void put_holds(origin *of)
{
    snprintf(of->holds, sizeof of->holds, "%s (%.900s)", of->run, of->call->line);
}

/* Where the tables of a run go. Standard output holds the states alone. */
typedef struct {
    const char *directory; /* "": standard output */
    bool resumable;        /* by the snapshots beside the tables */
    FILE *table[CLI_GROWING];
    cli_unfinished unfinished;
    bool quiet;
    cli_progress progress;
} outputs;

/* Every table gets rows of each frame. */
enum { STATES, ENERGY, CONTACTS, WALLS };
static const char *const growing[CLI_GROWING] = {"states.tsv", "energy.tsv", "contacts.tsv", "walls.tsv"};

static uint64_t layout(void)
{
    return dem_keep_layout() ^ sizeof(scene_run);
}

static outputs outputs_in(rp_arena *arena, const char *directory, bool resumable, bool quiet)
{
    return (outputs){
        .directory = directory,
        .resumable = resumable,
        .quiet = quiet,
        .unfinished = {.arena = arena, .directory = directory, .layout = layout(), .names = growing}};
}

static void keep_run(rp_snapshot *s, void *context)
{
    scene_run *r = context;
    RP_KEEP(s, r->plan);
    RP_KEEP(s, r->energy);
    RP_KEEP(s, r->rest);
    rp_keep_check(s,
                  rp_keep_bool(&r->plan.stages) && rp_keep_bool(&r->plan.phases) &&
                      r->plan.phases == (r->exp != NULL),
                  r->exp ? "no phases" : "phases: give the file too, repose run FILE --resume DIR");
    if (!r->plan.phases || s->status) {
        dem_keep(s, &r->sim);
        return;
    }
    RP_KEEP(s, r->line);
    RP_KEEP(s, r->run);
    rp_keep_check(s, memchr(r->line, 0, sizeof r->line) && memchr(r->run, 0, sizeof r->run), "no command");
    exp_keep(s, r->exp);
    r->sim = exp_sim(r->exp);
}

static void take_growing(outputs *o)
{
    for (int k = 0; k < CLI_GROWING; k++) o->table[k] = o->unfinished.table[k].file;
}

static rp_status outputs_open(outputs *o, const origin *of, const scene_run *r)
{
    if (r->exp && !*o->directory) return RP_OK; /* standard output holds the measures */
    o->table[STATES] = stdout;
    if (*o->directory) {
        RP_TRY(cli_unfinished_start(&o->unfinished));
        take_growing(o);
        for (int k = 0; k < CLI_GROWING; k++) put_origin(of, o->table[k]);
        dem_write_energy_columns(r->plan.ledger, o->table[ENERGY]);
        dem_write_contact_columns(o->table[CONTACTS]);
        dem_write_wall_columns(o->table[WALLS]);
    } else {
        cli_provenance(of->call, stdout);
    }
    dem_write_notes(r->sim, o->table[STATES]);
    dem_write_state_columns(o->table[STATES]);
    return RP_OK;
}

/* Steps so far; those of a simulation alone go back with it. */
static long steps_of(const scene_run *r)
{
    return r->exp ? exp_steps(r->exp) : dem_step(r->sim);
}

/* A frame of the tables whose turn it is at this step; of those without an interval at the end of a
 * stage; `last`: of all that have any. */
static rp_status outputs_write(const outputs *o, const scene_run *r, bool stage, bool last)
{
    const long *every = r->plan.every, step = steps_of(r);
    bool due[CLI_GROWING];
    for (int k = 0; k < CLI_GROWING; k++)
        due[k] = o->table[k] && (last           ? every[k] != 0
                                 : every[k] > 0 ? step % every[k] == 0
                                                : stage && every[k]);
    if (due[STATES]) RP_TRY(dem_write_states(r->sim, o->table[STATES]));
    if (due[ENERGY]) dem_write_energy(r->sim, o->table[ENERGY]);
    if (due[CONTACTS]) RP_TRY(dem_write_contacts(r->sim, o->table[CONTACTS]));
    return due[WALLS] ? dem_write_walls(r->sim, o->table[WALLS]) : RP_OK;
}

static growth growth_of(const dem_scene *scene, const dem_sim *sim)
{
    bool driven =
        scene->steps < LEAST_STEPS || scene->def.turn_per_step != 0.0 || scene->def.box_turn_per_step != 0.0;
    for (size_t w = 0; w < scene->def.n_walls; w++) {
        const dem_wall *wall = &dem_walls_of(&scene->def)[w];
        driven |= wall->open_at_step >= 0 || dem_wall_moves(wall);
    }
    return (growth){.every = driven ? 0 : scene->steps / SAMPLES, .grains = dem_count(sim)};
}

static void growth_sample(growth *g, const dem_sim *sim)
{
    dem_energy e;
    if (g->every == 0 || dem_step(sim) % g->every != 0) return;
    dem_energies(sim, &e);
    const double free = e.kinetic + e.elastic + e.rotational;
    g->scale = fmax(g->scale, free);
    if (g->n < SAMPLES / 4) g->first += free + e.gravity;
    if (g->n >= SAMPLES - SAMPLES / 4 && g->n < SAMPLES) g->last += free + e.gravity;
    g->n++;
}

/* No grain may have left with its energy. */
static void growth_report(const growth *g, const dem_sim *sim, FILE *states)
{
    const double grown = (g->last - g->first) / (SAMPLES / 4) / g->scale;
    char text[160];
    if (g->n < SAMPLES || dem_count(sim) != g->grains || !(grown > MOST_GROWTH)) return;
    snprintf(text, sizeof text,
             "energy grew by %.2g %% of its largest kinetic and elastic part; dt is too large for so little "
             "damping",
             100.0 * grown);
    rp_table_note(states, "warning", "%s", text);
    fprintf(stderr, "repose run: warning: %s\n", text);
}

static volatile sig_atomic_t stop_signal;

static void note_stop(int signal_number)
{
    stop_signal = signal_number;
}

/* Steps from `step` to the next multiple of `every`; `most` without. */
static long steps_to(long step, long every, long most)
{
    const long next = every > 0 ? every - step % every : most;
    return next < most ? next : most;
}

static bool is_done(const scene_run *r)
{
    return r->exp ? exp_done(r->exp) : dem_step(r->sim) >= r->plan.steps;
}

static rp_status go_on(scene_run *r, long part)
{
    if (r->exp) {
        const rp_status advanced = exp_advance(r->exp, part);
        r->sim = exp_sim(r->exp); /* laws that change make a new one */
        return advanced;
    }
    part = (long)fmin((double)part, (double)cli_rest_next(&r->rest, dem_step(r->sim)));
    rp_status status = dem_run(r->sim, part);
    /* too soft, too fast, too hard to solve: the scene has no result, and the program is not wrong */
    return status == RP_BROKEN && dem_sim_fault(r->sim) != DEM_FAULT_NON_FINITE ? RP_NO_RESULT : status;
}

static void show_progress(const scene_run *r, cli_progress *p)
{
    char text[256];
    const double now = rp_clock();
    if (!r->exp)
        cli_progress_show(p, now, dem_step(r->sim), stderr);
    else if (is_done(r) || cli_progress_due(p, now))
        cli_progress_tell(p, now, is_done(r) ? NULL : exp_where(r->exp, text, sizeof text), stderr);
}

static rp_status stop(const scene_run *r, const outputs *out, long step)
{
    char at[300], of[32], where[256];
    snprintf(of, sizeof of, "%ld", r->plan.steps);
    snprintf(at, sizeof at, "stopped at step %ld of %s", step,
             r->exp ? exp_where(r->exp, where, sizeof where) : of);
    return out->resumable ? rp_fail(RP_STOPPED, "%s; repose run %s--resume %s continues", at,
                                    r->exp ? "FILE " : "", out->directory)
                          : rp_fail(RP_STOPPED, "%s", at);
}

/* Advance to the end, or until a signal. */
static rp_status advance(scene_run *r, outputs *out)
{
    const run_plan *p = &r->plan;
    /* some tenths of a second: often enough to show progress and to notice a signal */
    const long most = 1 + r->threads * 10000000 / ((long)dem_count(r->sim) + 1);
    rp_status status = RP_OK;
    bool told = false;
    dem_threads(r->sim, (size_t)r->threads);
    while (!status && !is_done(r)) {
        const long before = steps_of(r), left = r->exp ? most : p->steps - before;
        long part = left < most ? left : most;
        for (int k = 0; k < CLI_GROWING; k++) part = steps_to(before, p->every[k], part);
        part = steps_to(before, p->snapshot, part);
        part = steps_to(before, r->energy.every, part);
        const size_t stages = r->exp ? exp_stages(r->exp) : 0;
        status = go_on(r, part);
        const long step = steps_of(r);
        const bool stage = r->exp && exp_stages(r->exp) > stages && r->plan.stages;
        show_progress(r, &out->progress);
        if (step == before) continue; /* a phase began or ended */
        if (!status) growth_sample(&r->energy, r->sim);
        if (!status && !r->exp) status = cli_rest_look(out->unfinished.arena, r->sim, &r->rest);
        if (!status && !told && !out->quiet) cli_tell_threads(r->sim, "run", r->threads);
        told = true;
        const bool stopped = stop_signal && !is_done(r);
        if (!status && !is_done(r)) status = outputs_write(out, r, stage, false);
        if (!status && out->resumable && !is_done(r) && (stopped || step % p->snapshot == 0))
            status = cli_unfinished_write(&out->unfinished, keep_run, r);
        if (!status && stopped) status = stop(r, out, step);
    }
    return status;
}

/* The frames for another program come from the tables, and are part of the result. */
static rp_status dump_frames(rp_arena *arena, const scene_run *r, const outputs *out)
{
    for (int k = 0; k < CLI_GROWING; k++) RP_TRY(rp_file_finish(out->table[k], growing[k]));
    return export_folder(arena, out->unfinished.stage.path, (export_format)r->plan.dump);
}

/* What the phases end with: a row a column of a sweep's table. */
static void write_measures(const cli_call *call, const scene_run *r, const exp_plan *plan, FILE *out)
{
    size_t n;
    const exp_output *o = exp_outputs(plan, &n);
    const exp_end *end = exp_ended(r->exp);
    cli_provenance(call, out);
    rp_table_note(out, "status", "%s", end->status);
    if (*end->message) rp_table_note(out, "message", "%s", end->message);
    rp_table_note(out, "steps", "%ld", exp_steps(r->exp));
    uint64_t digest;
    if (r->sim && !dem_digest(r->sim, &digest))
        rp_table_note(out, "digest", "%016" PRIx64 " of the grains' places, velocities and forces", digest);
    const rp_lets *lets = exp_lets(plan);
    for (size_t k = 0; k < lets->n; k++) {
        char key[80];
        const rp_x_symbol *is = &lets->lets[k].is;
        snprintf(key, sizeof key, "let %.64s", lets->lets[k].name);
        if (is->type == RP_X_NUMBER)
            rp_table_note_number(out, key, is->value, "");
        else
            rp_table_note(out, key, "%s",
                          is->type == RP_X_WORD ? is->word
                          : is->value != 0.0    ? "true"
                                                : "false");
    }
    for (size_t k = 0; k < exp_phase_count(plan); k++) {
        const exp_passed p = exp_phase_at(r->exp, k);
        char key[80];
        snprintf(key, sizeof key, "phase %.64s", p.name);
        if (p.passes > 0)
            rp_table_note(out, key, "%ld pass%s, to step %ld, t = %.15g", p.passes, p.passes > 1 ? "es" : "",
                          p.step, p.time);
    }
    rp_table_header(out, "measure, value, unit, meaning");
    for (size_t k = 0; k < n; k++) {
        fprintf(out, "%s\t", o[k].name);
        rp_table_numbers(out, 1, &exp_values(r->exp)[k]);
        fprintf(out, "\t%s\t%s\n", *o[k].unit ? o[k].unit : "-", o[k].meaning);
    }
}

/* A state at the end of a phase belongs to all texts that are the same up to there. */
#define KEPT "end_%s.state"
static rp_status write_results(const origin *of, const scene_run *r, const outputs *out)
{
    rp_arena *arena = of->call->arena;
    const char *path, *stage = out->unfinished.stage.path;
    FILE *table;
    write_measures(of->call, r, of->phases, stdout);
    if (!*out->directory) return RP_OK;
    RP_TRY(rp_path(arena, &path, "%s/measures.tsv", stage));
    RP_TRY(rp_file_open(path, &table));
    write_measures(of->call, r, of->phases, table);
    RP_TRY(rp_file_close(path, table, RP_OK));
    for (size_t k = 0; k < exp_kept_count(of->phases); k++) {
        const rp_snapshot *state = exp_kept(r->exp, k);
        char owner[33];
        if (state->n == 0) continue;
        RP_TRY(exp_kept_key(of->phases, k, r->streams[0], r->streams[1], owner));
        RP_TRY(rp_path(arena, &path, "%s/" KEPT, stage, exp_kept_name(of->phases, k)));
        RP_TRY(rp_file_open(path, &table));
        RP_TRY(rp_file_close(path, table, rp_snapshot_print(state, table, owner, layout())));
    }
    for (size_t k = 0; exp_series_name(of->phases, k); k++) {
        RP_TRY(rp_path(arena, &path, "%s/%s", stage, exp_series_name(of->phases, k)));
        RP_TRY(rp_file_open(path, &table));
        put_origin(of, table);
        exp_series_write(r->exp, k, table);
        RP_TRY(rp_file_close(path, table, RP_OK));
    }
    return RP_OK;
}

/* The closing line of a run with phases. A word other than ok is no result. */
static rp_status close_phases(const scene_run *r, const outputs *out)
{
    const exp_end *end = exp_ended(r->exp);
    const char *beside = *out->directory ? "; tables in " : "";
    if (!rp_is_result(end->status))
        return rp_fail(RP_NO_RESULT, "%s: %s%s%s", end->status, end->message, beside, out->directory);
    if (out->quiet) return RP_OK;
    fprintf(stderr, "repose run: %s, %ld steps, t = %.5g%s", end->status, exp_steps(r->exp), dem_time(r->sim),
            *out->directory ? "" : "; measures on standard output\n");
    if (*out->directory) cli_close_line(out->directory);
    return RP_OK;
}

/* From the start, or with `out` resumed from where the run is. */
static rp_status finish_scene(const origin *of, scene_run *r, outputs *out, rp_status status)
{
    rp_arena *arena = of->call->arena;
    out->progress =
        cli_progress_start(out->quiet, isatty(STDERR_FILENO), rp_clock(), dem_step(r->sim), r->plan.steps);
    if (!status) status = advance(r, out);
    if (!status) status = outputs_write(out, r, false, true);
    if (!status && !r->exp) growth_report(&r->energy, r->sim, out->table[STATES]);
    if (!status && r->exp) status = write_results(of, r, out);
    if (!status && *out->directory) status = dump_frames(arena, r, out);
    if (*out->directory)
        status = cli_unfinished_end(&out->unfinished, out->resumable, status);
    else if (status && out->table[STATES])
        rp_table_note(stdout, "unfinished", "%s", rp_message());
    else if (!status)
        status = rp_file_finish(stdout, "standard output");
    if (!status && r->exp) return close_phases(r, out);
    if (!status && !out->quiet) cli_close_run(arena, r->sim, &r->rest, out->directory);
    return status;
}

static rp_status run_scene(const origin *of, scene_run *r, const run_options *o)
{
    outputs out = outputs_in(of->call->arena, o->o, r->plan.snapshot > 0, o->quiet);
    out.unfinished.holds = of->holds;
    out.unfinished.force = o->force;
    cli_on_stop(note_stop);
    rp_status status = outputs_open(&out, of, r);
    if (!status && !is_done(r)) status = outputs_write(&out, r, false, false);
    if (!status && out.resumable) status = cli_unfinished_write(&out.unfinished, keep_run, r);
    return finish_scene(of, r, &out, status);
}

static void report_row(const sweep_output columns[], const sweep_result *result, const char *directory)
{
    fprintf(stderr, "repose run: %s", result->status);
    for (size_t k = 0; columns[k].name; k++)
        if (strcmp(columns[k].name, "theta_r3_deg") == 0 && !isnan(result->values[k]))
            fprintf(stderr, ", theta_R = %.1f degrees (method 3)", result->values[k]);
    cli_close_line(directory);
}

static rp_status run_row(const cli_call *call, const char *path, const run_options *o)
{
    if (!*o->o)
        return rp_fail(RP_USAGE,
                       "%s is a sweep file; repose run %s --row N -o DIR makes one of its runs, with tables; "
                       "repose sweep make %s -o DIR makes all",
                       path, path, path);
    if (o->set.n > 0) return rp_fail(RP_USAGE, "--set needs a scene; %s is a sweep file", path);
    if (cli_given(call, "j"))
        return rp_fail(RP_USAGE,
                       "-j needs a scene; %s is a sweep file, whose runs take one processor each; repose "
                       "sweep make -j works on several runs",
                       path);
    sweep_result result;
    const sweep_output *made;
    const double started = rp_clock();
    static volatile bool stopped;
    const char *stage, *snapshot;
    origin of = {.call = call};
    snprintf(of.run, sizeof of.run, "%s row %ld", path, o->row);
    put_holds(&of);
    cli_unfinished folder = {.arena = call->arena, .directory = o->o, .holds = of.holds, .force = o->force};
    RP_TRY(cli_unfinished_start(&folder));
    RP_TRY(rp_path(call->arena, &stage, "%s/unfinished", o->o));
    RP_TRY(rp_path(call->arena, &snapshot, "%s/snapshot", stage));
    cli_unfinished_stops(o->o, &stopped);
    const sweep_tables tables = {.directory = stage,
                                 .every = o->every > 0 ? o->every : 100,
                                 .header = put_origin,
                                 .context = &of,
                                 .ledger = o->ledger,
                                 .snapshot = snapshot,
                                 .interval = CLI_SNAPSHOT,
                                 .stop = &stopped};
    rp_status status =
        sweep_trace(path, sweep_protocols, (size_t)o->row, &tables, call->arena, &made, &result);
    RP_TRY(cli_unfinished_end(&folder, false, status));
    const char *columns[SWEEP_MAX_OUTPUTS + 1][2];
    size_t n = 0;
    for (const sweep_output *p = made; p->name; p++, n++) columns[n][0] = p->name, columns[n][1] = p->unit;
    columns[n][0] = "status", columns[n][1] = "";
    cli_provenance(call, stdout);
    rp_table_note(stdout, "run_time", "%.3g s", rp_clock() - started);
    rp_table_columns(stdout, n + 1, (const char *const(*)[2])columns);
    rp_table_row_word(stdout, n, result.values, result.status);
    if (!o->quiet && rp_is_result(result.status)) report_row(made, &result, o->o);
    if (rp_is_result(result.status)) return RP_OK;
    return rp_fail(RP_NO_RESULT, "%s%s%s", result.status, *result.message ? ": " : "", result.message);
}

/* A sweep has a protocol, or models alone. */
static rp_status is_sweep(const char *path, bool *sweep)
{
    config_t config;
    rp_status status = rp_config_read(path, &config);
    *sweep = !status && (config_lookup(&config, "protocol") || config_lookup(&config, "experiment"));
    if (!status && !*sweep && config_lookup(&config, "model"))
        status =
            rp_fail(RP_BAD_INPUT,
                    "%s is a sweep file of models alone; repose sweep make %s -o DIR writes their tables",
                    path, path);
    config_destroy(&config);
    return status;
}

/* Of all that makes a scene, whatever the kernel, the ledger and the number of steps. */
static rp_status hash_scene(const dem_scene *scene, const exp_plan *phases, XXH128_hash_t *hash)
{
    char *text = NULL;
    size_t size = 0;
    dem_scene any = *scene;
    any.def.kernel = DEM_FAST;
    any.def.n_grains = 0;
    any.def.ledger = false;
    any.steps = 0;
    FILE *out = open_memstream(&text, &size);
    if (!out) return rp_fail(RP_NO_MEMORY, "scene: out of memory");
    char *key = phases ? exp_key(phases) : NULL;
    if (key) fputs(key, out);
    free(key);
    dem_scene_write(&any, out);
    for (size_t i = 0; i < scene->def.n_grains && scene->grains; i++) {
        const dem_grain *p = &scene->grains[i];
        fwrite(p, offsetof(dem_grain, fixed), 1, out);
        fputc(p->fixed, out);
    }
    for (const dem_contact *c = any.contacts; c < any.contacts + any.def.n_contacts; c++)
        fprintf(out, "%u %u %d %a %a\n", c->id_a, c->id_b, c->wall, c->shear_spring, c->rolling_spring);
    fclose(out);
    *hash = XXH3_128bits(text, size);
    free(text);
    return RP_OK;
}

/* Afterwards free_text, also after an error. */
static rp_status read_text(const char *path, const run_options *o, scene_text *t)
{
    dem_scene *scene = &t->scene;
    *t = (scene_text){0};
    RP_TRY(dem_text_open(path, &o->set, &t->text));
    if (exp_has_phases(&t->text)) {
        RP_TRY(exp_read(&t->text, &t->phases));
        RP_TRY(exp_check(t->phases));
        *scene = *exp_scene(t->phases);
    } else {
        RP_TRY(dem_text_scene(&t->text, scene));
    }
    if (*scene->unused) fprintf(stderr, "repose run: particles_file: not used:%s\n", scene->unused);
    cli_warn_gravity(path, hypot(scene->def.gravity[0], scene->def.gravity[1]));
    if (o->ledger) scene->def.ledger = true;
    return RP_OK;
}

static void free_text(scene_text *t)
{
    if (!t->phases) dem_scene_free(&t->scene);
    exp_free(t->phases);
    dem_text_close(&t->text);
}

static void free_run(scene_run *r)
{
    if (r->exp)
        exp_run_free(r->exp);
    else
        dem_free(r->sim);
}

static bool has_new_springs(const dem_scene *scene, const dem_sim *sim)
{
    dem_counts now;
    dem_count_work(sim, &now);
    return scene->from_table && now.contacts > 0 && !scene->def.n_contacts &&
           dem_has_spring(scene->def.tangential);
}

static void name_run(origin *of, const char *path, const run_plan *plan)
{
    const long *every = plan->every;
    char key[33], frames[200] = "the last frame";
    bool equal = true;
    for (int k = 1; k < CLI_GROWING; k++) equal &= every[k] == every[0];
    rp_hash_digits(plan->scene, key);
    if (equal && *every > 0) snprintf(frames, sizeof frames, "a frame each %ld", *every);
    if (!equal)
        snprintf(frames, sizeof frames, "frames each %ld (states), %ld (energy), %ld (contacts), %ld (walls)",
                 every[STATES], every[ENERGY], every[CONTACTS], every[WALLS]);
    char length[32] = "phases";
    if (!plan->phases) snprintf(length, sizeof length, "%ld steps", plan->steps);
    snprintf(of->run, sizeof of->run, "%.400s, %s, %s, key %s", path, length, frames, key);
    put_holds(of);
}

/* Make the simulation, or the run of the phases. */
static rp_status start(scene_text *t, scene_run *r)
{
    if (!t->phases) return dem_scene_start(&t->scene, &r->sim);
    r->streams[0] = (unsigned long)t->scene.fill.seed, r->streams[1] = (unsigned long)t->scene.fill.run;
    RP_TRY(exp_start(t->phases, r->streams[0], r->streams[1], &r->exp));
    r->sim = exp_sim(r->exp);
    return r->sim ? RP_OK : rp_fail(RP_NO_RESULT, "%s", exp_ended(r->exp)->message);
}

/* Begin at the last phase whose end the folder has, of a text that is the same up to there. */
static rp_status begin_from(rp_arena *arena, const char *path, const char *directory, const exp_plan *plan,
                            scene_run *r, const char **note)
{
    char told[300] = "it has none";
    if (!plan || exp_kept_count(plan) == 0)
        return rp_fail(RP_USAGE, "--from %s: %s has no phase with keep = true", directory, path);
    for (size_t k = exp_kept_count(plan); k-- > 0;) {
        const char *state;
        char owner[33];
        rp_snapshot s = {0};
        RP_TRY(rp_path(arena, &state, "%s/" KEPT, directory, exp_kept_name(plan, k)));
        if (access(state, F_OK)) continue;
        RP_TRY(exp_kept_key(plan, k, r->streams[0], r->streams[1], owner));
        rp_status status = rp_snapshot_read(&s, state, owner, layout());
        if (!status) status = exp_begin(r->exp, k, &s);
        rp_snapshot_free(&s);
        r->sim = exp_sim(r->exp);
        if (!status)
            return rp_path(arena, note, "begins with the end of %s in %s", exp_kept_name(plan, k), directory);
        snprintf(told, sizeof told, "%s", rp_message());
    }
    return rp_fail(RP_BAD_INPUT, "--from %s: no end of a phase that %s begins with: %s", directory, path,
                   told);
}

static rp_status run_file(const cli_call *call, const char *path, const run_options *o)
{
    RP_ENDS(free_text) scene_text t;
    origin of = {.call = call};
    RP_ENDS(free_run) scene_run r = {.plan = {.snapshot = o->snapshot, .dump = o->dump}, .threads = o->j};
    if (cli_given(call, "row")) return rp_fail(RP_USAGE, "--row needs a sweep file; %s is a scene", path);
    if (o->snapshot > 0 && !*o->o) return rp_fail(RP_USAGE, "--snapshot needs -o DIR");
    if (o->dump && !*o->o) return rp_fail(RP_USAGE, "--dump needs -o DIR");
    RP_TRY(read_text(path, o, &t));
    if (t.phases && o->every > 0 && !*o->o)
        return rp_fail(RP_USAGE,
                       "--every needs -o DIR; %s has phases, and standard output holds what they measure",
                       path);
    const dem_intervals *own = &t.scene.output;
    const long every[] = {own->states, own->energy, own->contacts, own->walls};
    for (int k = 0; k < CLI_GROWING; k++) r.plan.every[k] = o->every > 0 ? o->every : every[k];
    if (*o->o) RP_TRY(hash_scene(&t.scene, t.phases, &r.plan.scene));
    r.plan.steps = r.rest.steps = t.phases ? 0 : t.scene.steps;
    r.plan.phases = t.phases != NULL;
    r.plan.stages = t.phases && !exp_goes_back(t.phases); /* there steps would not rise */
    of.phases = t.phases;
    name_run(&of, path, &r.plan);
    snprintf(r.line, sizeof r.line, "%s", call->line);
    memcpy(r.run, of.run, sizeof r.run);
    r.plan.ledger = t.scene.def.ledger;
    bool cut = false;
    t.scene.fill.cut = &cut;
    rp_status status = start(&t, &r);
    if (status == RP_BAD_INPUT && !t.phases) rp_prefix(status, "%s: ", path);
    of.start = cut ? "walls cut the region; grains lie in its largest part alone"
               : !status && has_new_springs(&t.scene, r.sim)
                   ? "grains touch, and their shear springs begin at 0; a bed at rest needs contacts_file"
                   : NULL;
    if (!status && *o->from) status = begin_from(call->arena, path, o->from, t.phases, &r, &of.start);
    if (of.start) fprintf(stderr, "repose run: %s: %s\n", path, of.start);
    if (!status && !t.phases) r.energy = growth_of(&t.scene, r.sim);
    return status ? status : run_scene(&of, &r, o);
}

/* A scene file that is given must be that of the snapshot, or without a plan that of the finished
 * tables, which the folder's marker names. */
static rp_status check_scene(const char *path, const run_options *o, const scene_text *t,
                             const run_plan *plan, const char *holds)
{
    XXH128_hash_t hash = {0};
    RP_TRY(hash_scene(&t->scene, t->phases, &hash));
    char steps[32], key[48] = ", key ";
    snprintf(steps, sizeof steps, t->phases ? ", phases, " : ", %ld steps, ", t->scene.steps);
    rp_hash_digits(hash, key + strlen(key));
    const bool same = !plan ? strstr(holds, steps) && strstr(holds, key)
                            : XXH128_isEqual(hash, plan->scene) &&
                                  (t->phases || t->scene.steps == plan->steps) &&
                                  t->scene.def.ledger == plan->ledger;
    if (same) return RP_OK;
    return rp_fail(RP_BAD_INPUT, "%s: not the scene that the %s in %s %s of", path,
                   plan ? "snapshot" : "tables", o->resume, plan ? "is" : "are");
}

static rp_status resume(const cli_call *call, const run_options *o)
{
    const char *scene = cli_argument(call, 0);
    RP_ENDS(free_text) scene_text t = {0};
    RP_ENDS(free_run) scene_run r = {.threads = o->j};
    origin of = {.call = call};
    outputs out = outputs_in(call->arena, o->resume, true, o->quiet);
    if (cli_given(call, "o") || cli_given(call, "every") || cli_given(call, "row") ||
        cli_given(call, "snapshot") || cli_given(call, "dump") || cli_given(call, "force") ||
        cli_given(call, "from"))
        return rp_fail(RP_USAGE, "--resume continues with the options of the start; it takes no -o, --every, "
                                 "--row, --snapshot, --dump, --from or --force");
    if (!scene && (o->set.n > 0 || o->ledger))
        return rp_fail(RP_USAGE, "--set and --ledger need a scene file");
    if (scene) RP_TRY(read_text(scene, o, &t));
    if (t.phases) RP_TRY(start(&t, &r));
    of.phases = t.phases;
    cli_on_stop(note_stop);
    bool done;
    rp_status status = cli_unfinished_resume(&out.unfinished, keep_run, &r, &done);
    if (!status && done) {
        if (scene) status = check_scene(scene, o, &t, NULL, out.unfinished.holds);
        if (!status) printf("%s: the run is done; its tables are in this folder\n", o->resume);
        return status;
    }
    if (!status && scene) status = check_scene(scene, o, &t, &r.plan, NULL);
    if (status) return cli_unfinished_end(&out.unfinished, true, status);
    cli_call first = *call;
    if (r.exp) first.line = r.line, of.call = &first, memcpy(of.run, r.run, sizeof of.run);
    if (r.exp)
        printf("%s: continues from step %ld\n", o->resume, steps_of(&r));
    else
        printf("%s: continues from step %ld to %ld\n", o->resume, dem_step(r.sim), r.plan.steps);
    take_growing(&out);
    return finish_scene(&of, &r, &out, RP_OK);
}

static rp_status run_any(cli_call *call, const void *values)
{
    const run_options *o = values;
    const char *path = cli_argument(call, 0);
    bool sweep;
    if (*o->resume) return resume(call, o);
    if (!path) return rp_fail(RP_USAGE, "give a file, or --resume DIR; see repose run --help");
    path = cli_data(call->arena, path);
    RP_TRY(is_sweep(path, &sweep));
    if (sweep && (o->snapshot > 0 || o->dump || *o->from))
        return rp_fail(RP_USAGE, "--%s needs a scene; %s is a sweep file",
                       o->dump    ? "dump"
                       : *o->from ? "from"
                                  : "snapshot",
                       path);
    return sweep ? run_row(call, path, values) : run_file(call, path, values);
}

const cli_command cmd_run = {
    "run",
    "simulate any scene, described in a file",
    "SCENE.cfg [--set KEY=VALUE]... [--every N] [--ledger] [-o DIR [--snapshot N] [--dump FORMAT] "
    "[--force]]\n"
    "[SCENE.cfg] --resume DIR\n"
    "SWEEP.cfg [--row N] -o DIR [--every N] [--ledger] [--force]",
    "A file that the current folder lacks, as examples/pile.cfg, is read from the program's own files:\n"
    "PREFIX/share/repose where it is installed.\n"
    "\n"
    "SCENE.cfg: simulate the scene and print the state of each grain: step, t (s), id, x, y (cm), angle\n"
    "(rad), vx, vy (cm/s), omega (rad/s), net force fx, fy (dyn), r (cm), m (g), contacts, fixed. With -o, "
    "the\n"
    "folder gets the tables states.tsv, contacts.tsv, walls.tsv and energy.tsv, with rows of every frame. A\n"
    "wall is a line through x, y with the unit normal direction_x, direction_y, between the ends `from` and\n"
    "`to` along the normal turned clockwise; an open wall has equal ends. `repose params scene` lists the\n"
    "keys of a scene file. Tables of a run that was stopped or failed go to DIR/unfinished:\n"
    "only a whole result takes its place in DIR. A finished result is replaced with --force alone; what the\n"
    "program did not write there is never touched (DIR/.repose lists what it did).\n"
    "--dump lammps, xyz or vtk adds DIR/run.lammpstrj, DIR/run.xyz or DIR/run.pvd, as `repose export` has\n"
    "them.\n"
    "The run ends with one line on standard error: grains, steps, at rest or not (a mean kinetic energy "
    "below\n"
    "1e-7 m g d, and forces that balance to 1e-2 m g, by ten looks in the last 5000 steps), and theta_R by\n"
    "method 3 where the surface at rest falls to one side by all three methods.\n"
    "The slope is measured from the standing wall to the opened one, or over the whole pile if no wall\n"
    "opens.\n"
    "\n"
    "--snapshot N: the tables grow in DIR/unfinished, where a snapshot is written every N steps and at\n"
    "SIGINT, SIGTERM or SIGHUP. `repose run --resume DIR` continues after a stop, a kill or a power cut, "
    "and\n"
    "ends with the files of an undisturbed run, byte by byte. A snapshot of another scene, program version\n"
    "or model, or a damaged one, is refused.\n"
    "\n"
    "SWEEP.cfg (a file with the key `protocol`): repeat one run of the sweep and print its results. The\n"
    "folder gets the tables of this run. A long run of any protocol but pile keeps a snapshot there: after\n"
    "a stop or a kill the same command continues. Of a text: grains, contacts and walls at the end of each\n"
    "phase, phases.tsv, energies, and a file scene.cfg that `repose run` repeats bit for bit. For a static "
    "pile: disks, contacts, wells and the\n"
    "forces on the base.",
    "repose run scene.cfg --set tangential.mu=0.3 --every 1000 -o out",
    run_params,
    .refuses =
        "A folder with a finished result: give another one, or --force. A sweep's folder, and files in the "
        "way.\n"
        "--snapshot and --dump without -o; --row with a scene; --set, -j, --snapshot, --dump and --from with "
        "a sweep.\n"
        "--from without a phase that keeps its end, or where the folder's text begins otherwise.\n"
        "--resume with -o, --every, --row, --snapshot, --dump, --from or --force: it continues with the "
        "options of the start.\n"
        "A snapshot of another scene, program version or model, or a damaged one.",
    .act = run_any};
