/* `repose run`: any scene from a file, with snapshots from which it resumes; or one run of a sweep again with
 * its tables. */
#include <inttypes.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <xxhash.h>

#include "cli/cli.h"
#include "cli/result.h"
#include "cli/progress.h"
#include "cli/closing.h"
#include "core/elementary.h"
#include "core/clock.h"
#include "params/config.h"
#include "params/units.h"
#include "dem/scene/text.h"
#include "experiment/experiment.h"
#include "sweeps/engine/keep.h"

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
    CLI_FORCE(X)                                                                                             \
    CLI_QUIET(X)

CLI_OPTIONS(run, RUN_OPTIONS)

/* What a run is to do. */
typedef struct {
    long steps, every[CLI_GROWING]; /* every: as dem_intervals, of the tables below */
    bool ledger;
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

/* Of what a folder's tables are, in their header. */
typedef struct {
    cli_call call; /* with the command line of the start */
    char run[1024];
    const char *start; /* what is to be known of it, or NULL */
} origin;

/* A scene run in the making: what its file has, how far it is, and where its tables go. Standard output holds
 * the states alone, or the measures of phases. */
typedef struct {
    const run_options *o;
    dem_text text;
    dem_scene scene;
    exp_plan *phases;
    bool plain; /* no phases, and no measures */
    run_plan plan;
    growth energy;
    cli_rest rest;
    long written[CLI_GROWING]; /* steps of the last frames: a phase may have none */
    dem_sim *sim;              /* that of the run */
    exp_run *exp;
    bool over_friction; /* has been told */
    origin of;
    cli_result result;
    cli_progress progress;
} scene_run;

static void put_origin(const void *context, rp_units units, FILE *out)
{
    const origin *of = context;
    cli_call call = of->call;
    call.units = units;
    cli_provenance(&call, out);
    rp_table_note(out, "run", "%s", of->run);
    if (of->start) rp_table_note(out, "start", "%s", of->start);
}

/* Every table gets rows of each frame. */
enum { STATES, ENERGY, CONTACTS, WALLS };
static const char *const growing[CLI_GROWING] = {"states.tsv", "energy.tsv", "contacts.tsv", "walls.tsv"};

static uint64_t layout(void)
{
    return dem_keep_layout() ^ sizeof(scene_run) ^ exp_keep_layout() << 20;
}

static void free_run(scene_run *r)
{
    exp_run_free(r->exp);
    exp_free(r->phases);
    dem_text_close(&r->text);
    cli_result_free(&r->result);
}

static void keep_run(rp_snapshot *s, void *context)
{
    scene_run *r = context;
    RP_KEEP(s, r->energy);
    RP_KEEP(s, r->rest);
    RP_KEEP(s, r->written);
    exp_keep(s, r->exp);
    r->sim = exp_sim(r->exp);
}

/* NULL: no such table. */
static FILE *table_of(const scene_run *r, int k)
{
    return r->result.table[k];
}

static void begin_tables(scene_run *r)
{
    for (int k = 0; k < CLI_GROWING && *r->o->o; k++) put_origin(&r->of, r->of.call.units, table_of(r, k));
    for (int k = STATES + 1; k < CLI_GROWING && *r->o->o; k++)
        dem_write_columns((dem_table)k, r->sim, table_of(r, k));
    if (!*r->o->o && !r->plain) return; /* standard output holds the measures */
    if (!*r->o->o) r->result.table[STATES] = r->of.call.out, cli_provenance(&r->of.call, r->of.call.out);
    dem_write_notes(r->sim, table_of(r, STATES));
    dem_write_columns(DEM_TABLE_STATES, r->sim, table_of(r, STATES));
}

static long steps_of(const scene_run *r)
{
    return exp_steps(r->exp);
}

/* Once a run. */
static void tell_friction(scene_run *r)
{
    size_t over = 0;
    const size_t n = r->o->quiet || r->over_friction ? 0 : dem_over_friction(r->sim, &over);
    if (over == 0) return;
    r->over_friction = true;
    fprintf(
        stderr,
        "repose run: warning: t = %.5g: the shear force of %zu of %zu contacts exceeds mu times the normal "
        "force: damping = \"outside\" adds the dashpot to this limit, \"inside\" obeys it\n",
        dem_time(r->sim), over, n);
}

/* A frame of the tables whose turn it is at this step or at a stage's end; `last`: of all that have any. */
static rp_status write_frame(scene_run *r, bool stage, bool last)
{
    const long *every = r->plan.every, step = steps_of(r);
    if (stage || last) tell_friction(r);
    for (int k = 0; k < CLI_GROWING; k++) {
        const bool due = every[k] && (last || stage || (every[k] > 0 && step % every[k] == 0));
        if (due && k == CONTACTS) tell_friction(r);
        if (!due || !table_of(r, k) || r->written[k] == step) continue;
        RP_TRY(dem_write_rows((dem_table)k, r->sim, step, table_of(r, k)));
        r->written[k] = step;
    }
    return RP_OK;
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

static volatile bool stop_asked;

/* Steps from `step` to the next multiple of `every`; `most` without. */
static long steps_to(long step, long every, long most)
{
    const long next = every > 0 ? every - step % every : most;
    return next < most ? next : most;
}

static bool is_done(const scene_run *r)
{
    return exp_done(r->exp);
}

static rp_status go_on(scene_run *r, long part)
{
    if (r->plain) part = (long)fmin((double)part, (double)cli_rest_next(&r->rest, steps_of(r)));
    const rp_status advanced = exp_advance(r->exp, part);
    r->sim = exp_sim(r->exp); /* laws that change make a new one */
    return advanced;
}

static void show_progress(scene_run *r)
{
    char text[256];
    if (!r->plain)
        cli_progress_tell(&r->progress, rp_clock(), is_done(r) ? NULL : exp_where(r->exp, text, sizeof text),
                          stderr);
    else
        cli_progress_show(&r->progress, rp_clock(), dem_step(r->sim), stderr);
}

static rp_status stop(const scene_run *r)
{
    char text[256];
    const char *where =
        r->plain ? rp_text(r->of.call.arena, "%ld", r->plan.steps) : exp_where(r->exp, text, sizeof text);
    return rp_fail(RP_STOPPED, "stopped at step %ld of %s", steps_of(r), where);
}

/* Advance to the end, or until a signal. */
static rp_status advance(scene_run *r)
{
    const run_plan *p = &r->plan;
    /* some tenths of a second: often enough to show progress and to notice a signal */
    const long most = 1 + r->o->j * 10000000 / ((long)dem_count(r->sim) + 1);
    bool told = r->o->quiet;
    dem_threads(r->sim, (size_t)r->o->j);
    while (!is_done(r)) {
        const long before = steps_of(r);
        long part = most; /* go_on stops at the end */
        for (int k = 0; k < CLI_GROWING; k++) part = steps_to(before, p->every[k], part);
        part = steps_to(before, r->energy.every, part);
        const size_t stages = exp_stages(r->exp);
        const rp_status status = go_on(r, part);
        const long step = steps_of(r);
        const bool stage = exp_stages(r->exp) > stages;
        show_progress(r);
        RP_TRY(status);
        const bool stops = stop_asked; /* a later signal waits for the next snapshot */
        if (step == before && (!stops || is_done(r))) continue; /* a phase began or ended */
        growth_sample(&r->energy, r->sim);
        if (r->plain) RP_TRY(cli_rest_look(r->of.call.arena, r->sim, &r->rest));
        if (!told) cli_tell_threads(r->sim, "run", r->o->j);
        told = true;
        if (is_done(r)) continue;
        if (step != before) RP_TRY(write_frame(r, stage, false));
        RP_TRY(cli_result_keep(&r->result, stops));
        if (stops) return stop(r);
    }
    return RP_OK;
}

/* What the phases end with: a row a column of a sweep's table. */
static void write_measures(const scene_run *r, FILE *out)
{
    size_t n;
    const exp_output *o = exp_outputs(r->phases, &n);
    const exp_end *end = exp_ended(r->exp);
    cli_provenance(&r->of.call, out);
    rp_table_note(out, "status", "%s", end->status);
    if (*end->message) rp_table_note(out, "message", "%s", end->message);
    rp_table_note(out, "steps", "%ld", exp_steps(r->exp));
    uint64_t digest;
    if (r->sim && !dem_digest(r->sim, &digest))
        rp_table_note(out, "digest", "%016" PRIx64 " of the grains' places, velocities and forces", digest);
    const rp_lets *lets = &r->text.lets;
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
    for (size_t k = 0; k < exp_phase_count(r->phases); k++) {
        const exp_passed p = exp_phase_at(r->exp, k);
        char key[80];
        snprintf(key, sizeof key, "phase %.64s", p.name);
        if (p.passes > 0)
            rp_table_note(out, key, "%ld pass%s, to step %ld, t = %.15g", p.passes, p.passes > 1 ? "es" : "",
                          p.step, p.time);
    }
    rp_table_header(out, r->of.call.units, "measure, value, unit, meaning");
    for (size_t k = 0; k < n; k++) {
        fprintf(out, "%s\t", o[k].name);
        rp_table_numbers(out, 1, &exp_values(r->exp)[k]);
        fprintf(out, "\t%s\t%s%s\n", cli_cell(o[k].unit), o[k].meaning,
                isnan(exp_values(r->exp)[k]) ? "; it has no value" : "");
    }
}

/* The file `name` of the result. */
static rp_status open_result(const scene_run *r, const char *name, const char **path, FILE **file)
{
    RP_TRY(rp_path(r->of.call.arena, path, "%s/%s", r->result.folder.part, name));
    return rp_file_open(*path, true, file);
}

static rp_status write_results(const scene_run *r)
{
    const char *path;
    FILE *table;
    write_measures(r, r->of.call.out);
    if (!*r->o->o) return RP_OK;
    RP_TRY(open_result(r, "measures.tsv", &path, &table));
    write_measures(r, table);
    RP_TRY(rp_file_close(path, table, RP_OK));
    for (size_t k = 0; exp_series_name(r->phases, k); k++) {
        RP_TRY(open_result(r, exp_series_name(r->phases, k), &path, &table));
        put_origin(&r->of, r->of.call.units, table);
        exp_series_write(r->exp, k, table);
        RP_TRY(rp_file_close(path, table, RP_OK));
    }
    return RP_OK;
}

/* The closing line of a run with phases. A word other than ok is no result. */
static rp_status close_phases(const scene_run *r)
{
    const exp_end *end = exp_ended(r->exp);
    const char *directory = r->o->o;
    if (!rp_is_result(end->status))
        return rp_fail(RP_NO_RESULT, "%s: %s%s%s", end->status, end->message,
                       *directory ? "; tables in " : "", directory);
    if (r->o->quiet) return RP_OK;
    fprintf(stderr, "repose run: %s, %ld steps, t = %.5g%s", end->status, exp_steps(r->exp), dem_time(r->sim),
            *directory ? "" : "; measures on standard output\n");
    if (*directory) cli_close_line(directory);
    return RP_OK;
}

/* All that a result has besides the frames before its end. */
static rp_status write_end(scene_run *r)
{
    RP_TRY(write_frame(r, false, true));
    if (!r->plain)
        RP_TRY(write_results(r));
    else
        growth_report(&r->energy, r->sim, table_of(r, STATES));
    return RP_OK;
}

/* From the start, or resumed from where the run is. */
static rp_status finish_scene(scene_run *r, rp_status status)
{
    const char *directory = r->o->o;
    r->progress =
        cli_progress_start(r->o->quiet, isatty(STDERR_FILENO), rp_clock(), dem_step(r->sim), r->plan.steps);
    if (!status) status = advance(r);
    if (!status) status = write_end(r);
    if (*directory)
        status = cli_result_end(&r->result, status);
    else if (status && table_of(r, STATES))
        rp_table_note(r->of.call.out, "unfinished", "%s", rp_message());
    else if (!status)
        status = rp_file_finish(r->of.call.out, "standard output");
    if (!status && !r->plain) return close_phases(r);
    if (!status && !r->o->quiet) cli_close_run(r->of.call.arena, r->sim, &r->rest, directory);
    return status;
}

static rp_status run_row(const cli_call *call, const char *path, const run_options *o)
{
    if (!*o->o)
        return rp_fail(RP_USAGE,
                       "%s is a sweep file; repose run %s --row N -o DIR makes one of its runs, with tables; "
                       "repose sweep make %s -o DIR makes all",
                       path, path, path);
    sweep_result result;
    const sweep_protocol *made;
    const double started = rp_clock();
    const char *snapshot;
    bool resumed;
    origin of = {.call = *call};
    snprintf(of.run, sizeof of.run, "%s row %ld", path, o->row);
    const long every = o->every > 0 ? o->every : 100;
    const char *holds =
        rp_text(call->arena, "%s, energies each %ld%s", of.run, every, o->ledger ? ", ledger" : "");
    RP_ENDS(cli_result_free) cli_result folder = {0};
    RP_TRY(cli_result_begin(&folder, call->arena, o->o, holds, o->force, &resumed));
    RP_TRY(rp_path(call->arena, &snapshot, "%s/snapshot", folder.folder.part));
    cli_on_stop(&stop_asked);
    sweep_keep keep = {.path = snapshot, .interval = CLI_SNAPSHOT, .stop = &stop_asked};
    const sweep_tables tables = {.directory = folder.folder.part,
                                 .every = every,
                                 .header = put_origin,
                                 .context = &of,
                                 .ledger = o->ledger,
                                 .keep = &keep};
    rp_status status =
        sweep_trace(path, sweep_protocols, (size_t)o->row, &tables, call->arena, &made, &result);
    RP_TRY(cli_result_end(&folder, status));
    of.call.units = made->units;
    cli_provenance(&of.call, call->out);
    rp_table_note(call->out, "run_time", "%.3g s", rp_clock() - started);
    cli_result_row(&of.call, NULL, NULL, made->outputs, &result);
    if (!rp_is_result(result.status))
        return rp_fail(RP_NO_RESULT, "%s%s%s", result.status, *result.message ? ": " : "", result.message);
    if (o->quiet) return RP_OK;
    fprintf(stderr, "repose run: %s", result.status);
    for (size_t k = 0; made->outputs[k].name; k++)
        if (strcmp(made->outputs[k].name, "theta_r3_deg") == 0 && !isnan(result.values[k]))
            fprintf(stderr, ", theta_R = %.1f degrees (method 3)", result.values[k]);
    cli_close_line(o->o);
    return RP_OK;
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

/* Of the g of SI among values in cgs. */
static void warn_gravity(const char *path, rp_units units, double g)
{
    if (units == RP_CGS && g > 9.7 && g < 9.9)
        fprintf(stderr,
                "repose: warning: %s: g = %g among values in cm, g and s; give units = \"si\", or g = %g\n",
                path, g, 100.0 * g);
}

static rp_status read_text(const char *path, scene_run *r)
{
    dem_scene *scene = &r->scene;
    RP_TRY(dem_text_open(path, NULL, &r->o->set, &r->text));
    r->plain = !exp_has_phases(&r->text);
    RP_TRY(exp_read(&r->text, &r->phases));
    RP_TRY(exp_check(r->phases));
    *scene = *exp_scene(r->phases);
    if (*scene->unused) fprintf(stderr, "repose run: particles_file: not used:%s\n", scene->unused);
    warn_gravity(path, scene->def.units, rp_hypot(scene->def.gravity[0], scene->def.gravity[1]));
    r->of.call.units = scene->def.units;
    if (r->o->ledger) scene->def.ledger = true;
    if (r->o->ledger) exp_keep_ledger(r->phases);
    return RP_OK;
}

/* Of the run, its streams and its measures. */
static rp_status key_of(const scene_run *r, char digits[33])
{
    XXH128_hash_t sum;
    exp_measured m;
    RP_TRY(exp_key(r->phases, &sum));
    for (size_t k = 0; k < exp_measure_count(r->phases); k++) {
        RP_TRY(exp_measure_at(r->phases, k, &m));
        if (m.n_outputs > 0) sum = rp_hash_add(sum, m.key);
    }
    rp_hash_digits(rp_hash_add(sum, XXH3_128bits((long[]){r->scene.seed, r->scene.run}, 2 * sizeof(long))), digits);
    return RP_OK;
}

static rp_status name_run(const char *path, scene_run *r)
{
    const long *every = r->plan.every;
    rp_arena *arena = r->of.call.arena;
    const char *frames = *every > 0 ? rp_text(arena, "a frame each %ld", *every) : "the last frame",
               *length = !r->plain ? "phases" : rp_text(arena, "%ld steps", r->plan.steps);
    char key[33];
    RP_TRY(key_of(r, key));
    if (every[ENERGY] != *every || every[CONTACTS] != *every || every[WALLS] != *every)
        frames = rp_text(arena, "frames each %ld (states), %ld (energy), %ld (contacts), %ld (walls)",
                         every[STATES], every[ENERGY], every[CONTACTS], every[WALLS]);
    snprintf(r->of.run, sizeof r->of.run, "%.400s, %s, %s, key %s", path, length, frames, key);
    return RP_OK;
}

static rp_status start(scene_run *r)
{
    RP_TRY(exp_start(r->phases, (unsigned long)r->scene.seed, (unsigned long)r->scene.run, &r->exp));
    r->sim = exp_sim(r->exp);
    return r->sim ? RP_OK : rp_fail(RP_NO_RESULT, "%s", exp_ended(r->exp)->message);
}

static rp_status run_file(const cli_call *call, const char *path, const run_options *o)
{
    RP_ENDS(free_run)
    scene_run r = {.o = o,
                   .of = {.call = *call},
                   .written = {-1, -1, -1, -1},
                   .result = {.names = growing, .keep = keep_run, .context = &r, .layout = layout()}};
    if (cli_given(call, "row")) return rp_fail(RP_USAGE, "--row needs a sweep file; %s is a scene", path);
    RP_TRY(read_text(path, &r));
    if (!r.plain && o->every > 0 && !*o->o)
        return rp_fail(RP_USAGE,
                       "--every needs -o DIR; %s has phases, and standard output holds what they measure",
                       path);
    const dem_intervals *own = &r.scene.output;
    const long every[] = {own->states, own->energy, own->contacts, own->walls},
               steps = r.plain ? r.scene.steps : 0;
    r.plan = (run_plan){.steps = steps, .ledger = r.scene.def.ledger};
    for (int k = 0; k < CLI_GROWING; k++) r.plan.every[k] = o->every > 0 ? o->every : every[k];
    r.rest.steps = steps;
    RP_TRY(name_run(path, &r));
    const rp_status status = start(&r);
    dem_counts now = {0};
    if (!status) dem_count_work(r.sim, &now);
    if (!status && exp_is_cut(r.exp))
        r.of.start = "walls cut the region; grains lie in its largest part alone";
    else if (*r.scene.particles_file && now.contacts > 0 && !r.scene.def.n_contacts &&
             dem_has_spring(r.scene.def.tangential))
        r.of.start = "grains touch, and their shear springs begin at 0; a bed at rest needs contacts_file";
    if (r.of.start) fprintf(stderr, "repose run: %s: %s\n", path, r.of.start);
    RP_TRY(status);
    if (r.plain) r.energy = growth_of(&r.scene, r.sim);
    bool resumed = false;
    const char *holds = rp_text(call->arena, "%s%s", r.of.run, r.plan.ledger ? ", ledger" : "");
    cli_on_stop(&stop_asked);
    if (*o->o) RP_TRY(cli_result_begin(&r.result, call->arena, o->o, holds, o->force, &resumed));
    if (resumed) {
        if (!o->quiet) fprintf(stderr, "repose run: %s: continues from step %ld\n", o->o, steps_of(&r));
        return finish_scene(&r, RP_OK);
    }
    begin_tables(&r);
    return finish_scene(&r, is_done(&r) ? RP_OK : write_frame(&r, false, false));
}

static rp_status run_any(cli_call *call, const void *values)
{
    static const char *const of_scenes[] = {"j", "set"};
    const char *path = cli_data(call->arena, cli_argument(call, 0));
    bool sweep;
    RP_TRY(is_sweep(path, &sweep));
    for (size_t i = 0; sweep && i < N_OF(of_scenes); i++)
        if (cli_given(call, of_scenes[i]))
            return rp_fail(RP_USAGE, "%s%s needs a scene; %s is a sweep file%s", i == 0 ? "-" : "--",
                           of_scenes[i], path,
                           i > 0 ? ""
                                 : ", whose runs take one processor each; repose sweep make -j works on "
                                   "several runs");
    return sweep ? run_row(call, path, values) : run_file(call, path, values);
}

const cli_command cmd_run = {
    "run",
    "simulate any scene, described in a file",
    "SCENE.cfg [--set KEY=VALUE]... [--every N] [--ledger] [-o DIR [--force]]\n"
    "SWEEP.cfg [--row N] -o DIR [--every N] [--ledger] [--force]",
    "A file that the current folder lacks, as examples/pile.cfg, is read from the program's own files: "
    "PREFIX/share/repose where it is installed.\n"
    "\n"
    "SCENE.cfg: simulate the scene and print the state of each grain: step, t (s), id, x, y (cm), angle "
    "(rad), vx, vy (cm/s), omega (rad/s), net force fx, fy (dyn), r (cm), m (g), contacts, fixed. With -o, "
    "the folder gets the tables states.tsv, contacts.tsv, walls.tsv and energy.tsv, with rows of every "
    "frame. A wall is a line through x, y with the unit normal direction_x, direction_y, between the ends "
    "`from` and `to` along the normal turned clockwise; an open wall has equal ends. In contacts.tsv, "
    "shear_force acts on the second body, along the way from the first turned clockwise, shear_spring has "
    "the other sign; rolling_torque acts on the first, rolling_spring is at the arm r_i r_j/(r_i + r_j). "
    "`repose params scene` lists the keys of a scene file. The result grows in DIR.part and becomes DIR when "
    "it "
    "is whole; a finished one is replaced with --force alone. After a stop, a kill or a power cut the same "
    "command "
    "continues from the last snapshot, one a minute, and ends with the files of an undisturbed run. The "
    "run ends with one line on standard error: grains, steps, at rest or not (a mean kinetic energy below "
    "1e-7 m g d, and forces that balance to 1e-2 m g, by ten looks in the last 5000 steps), and theta_R by "
    "method 3 where the surface at rest falls to one side by all three methods. The slope is measured from "
    "the standing wall to the opened one, or over the whole pile if no wall opens.\n"
    "\n"
    "SWEEP.cfg (a file with the key `protocol`): repeat one run of the sweep and print its results. The "
    "folder gets the tables of this run. Of a text: grains, contacts and walls at the end of each "
    "phase, phases.tsv, energies, and a file scene.cfg that `repose run` repeats bit for bit. For a static "
    "pile: disks, contacts, wells and the forces on the base.",
    "repose run scene.cfg --set tangential.mu=0.3 --every 1000 -o out",
    run_params,
    .refuses = "A folder with a finished result, or with other files: give another one, or --force.\n"
               "--row with a scene; --set and -j with a sweep.",
    .act = run_any};
