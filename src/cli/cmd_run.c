/* `repose run`: any scene from a file, or one run of a sweep again with its tables. */
#include <math.h>
#include <signal.h>
#include <stddef.h>
#include <string.h>
#include <unistd.h>

#include "cli/cli.h"
#include "core/clock.h"
#include "core/config.h"
#include "dem/scene.h"
#include "sweeps/driver/sweep.h"

#define RUN_OPTIONS(X)                                                                                       \
    X(TEXTS, set, "", "", "", "KEY=VALUE or GROUP.KEY=VALUE replaces a key of the file; may be repeated")    \
    X(INT, every, "steps", "auto", "[1, 2147483647] | auto",                                                 \
      "interval of the states (of a sweep's run: energies) written; auto: the final state (energies: 100)")  \
    X(TEXT, o, "", "", "", "folder for tables, instead of standard output")                                  \
    X(BOOL, ledger, "", "false", "",                                                                         \
      "add the terms of the energy ledger to the energies; as `ledger = true` in a scene")                   \
    X(INT, row, "", "0", "[0, 2147483647]", "number of the sweep's run, from 0")

CLI_OPTIONS(run, RUN_OPTIONS)

/* Where the tables of a run go. Standard output holds the states alone. */
typedef struct {
    sweep_tables tables; /* no folder: standard output */
    sweep_file states, energy;
} outputs;

static rp_status outputs_open(outputs *o, const dem_scene *scene, const dem_sim *sim)
{
    rp_status status = RP_OK;
    if (*o->tables.directory) {
        status = rp_make_directory(o->tables.directory);
        if (!status) status = sweep_table_open(&o->tables, "states.tsv", &o->states);
        if (!status) status = sweep_table_open(&o->tables, "energy.tsv", &o->energy);
        if (status) return status;
        dem_write_energy_columns(scene->def.ledger, o->energy.out);
    } else {
        o->states = (sweep_file){"-", stdout};
        cli_provenance(stdout);
    }
    dem_write_notes(sim, o->states.out);
    dem_write_state_columns(o->states.out);
    return RP_OK;
}

static rp_status outputs_write(const outputs *o, const dem_sim *sim)
{
    if (o->energy.out) dem_write_energy(sim, o->energy.out);
    return dem_write_states(sim, o->states.out);
}

static rp_status write_contacts(const sweep_tables *tables, const dem_sim *sim)
{
    sweep_file file;
    rp_status status = sweep_table_open(tables, "contacts.tsv", &file);
    return status ? status : sweep_table_close(&file, dem_write_contacts(sim, file.out));
}

static rp_status write_walls(const sweep_tables *tables, const dem_scene *scene, const dem_sim *sim)
{
    double forces[2 * DEM_MAX_WALLS];
    sweep_file file;
    rp_status status = sweep_table_open(tables, "walls.tsv", &file);
    if (status) return status;
    dem_wall_forces(sim, forces);
    rp_table_header(file.out, "wall, fx [dyn], fy [dyn]");
    for (size_t w = 0; w < scene->def.n_walls; w++)
        rp_table_row(file.out, 3, (double[]){(double)w + 1.0, forces[2 * w], forces[2 * w + 1]});
    return sweep_table_close(&file, RP_OK);
}

/* Unless the run is whole, its tables say so in their last line. */
static rp_status close_table(const sweep_file *file, rp_status run)
{
    if (run) rp_table_note(file->out, "unfinished", "%s", rp_message());
    return sweep_table_close(file, RP_OK);
}

/* What was computed before a failure is kept. */
static rp_status outputs_close(const outputs *o, const dem_scene *scene, const dem_sim *sim, rp_status run)
{
    char why[1024];
    snprintf(why, sizeof why, "%s", rp_message());
    rp_status status = o->energy.out ? close_table(&o->energy, run) : RP_OK;
    if (*o->tables.directory && o->states.out) {
        rp_status closed = close_table(&o->states, run);
        if (!status) status = closed;
        if (!status) status = write_contacts(&o->tables, sim);
        if (!status) status = write_walls(&o->tables, scene, sim);
    }
    return run ? rp_fail(run, "%s", why) : status;
}

/* Energy without source must not grow. Samples of the first and of the last quarter of a long run are
 * compared: a step near the limit of stability heats a scene with little damping, slowly and without an end.
 */
enum { SAMPLES = 64, LEAST_STEPS = 100 * SAMPLES };
static const double MOST_GROWTH = 0.02; /* of the largest sum of kinetic and elastic energy */

typedef struct {
    long every; /* steps; 0: no such scene */
    size_t n, grains;
    double first, last, scale;
} growth;

static growth growth_of(const dem_scene *scene, const dem_sim *sim)
{
    bool driven =
        scene->steps < LEAST_STEPS || scene->def.turn_per_step != 0.0 || scene->def.box_turn_per_step != 0.0;
    for (size_t w = 0; w < scene->def.n_walls; w++) driven |= scene->def.walls[w].open_at_step >= 0;
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

static void show_progress(const dem_sim *sim, long steps)
{
    static int last = -1;
    int percent = steps > 0 ? (int)(100 * dem_step(sim) / steps) : 100;
    if (!isatty(STDERR_FILENO) || percent == last) return;
    last = percent;
    fprintf(stderr, "\rstep %ld of %ld, %d %%%s", dem_step(sim), steps, percent, percent == 100 ? "\n" : "");
}

static volatile sig_atomic_t stop_signal;

static void note_stop(int signal_number)
{
    stop_signal = signal_number;
}

/* Steps to the next multiple of `every`, at most `part`. */
static long to_next(long every, const dem_sim *sim, long part)
{
    const long steps = every - dem_step(sim) % every;
    return steps < part ? steps : part;
}

static rp_status run_scene(const dem_scene *scene, const run_options *o, dem_sim *sim)
{
    cli_on_stop(note_stop);
    /* some tenths of a second: often enough to show progress and to notice a signal */
    const long most = 1 + 10000000 / ((long)dem_count(sim) + 1);
    char stage[4096] = "";
    rp_status status = *o->o ? cli_stage_open(o->o, stage) : RP_OK;
    if (status) return status;
    outputs out = {.tables = {.directory = stage, .header = cli_provenance}};
    status = outputs_open(&out, scene, sim);
    if (!status && o->every > 0) status = outputs_write(&out, sim);
    growth energy = growth_of(scene, sim);
    while (!status && dem_step(sim) < scene->steps) {
        long part = scene->steps - dem_step(sim);
        if (o->every > 0) part = to_next(o->every, sim, part);
        if (energy.every > 0) part = to_next(energy.every, sim, part);
        if (part > most) part = most;
        status = dem_run(sim, part);
        /* too soft, too fast, too hard to solve: the scene has no result, and the program is not wrong */
        if (status == RP_BROKEN && dem_sim_fault(sim) != DEM_FAULT_NON_FINITE) status = RP_NO_RESULT;
        show_progress(sim, scene->steps);
        if (!status) growth_sample(&energy, sim);
        if (!status && stop_signal)
            status = rp_fail(RP_STOPPED, "stopped at step %ld of %ld", dem_step(sim), scene->steps);
        if (!status && o->every > 0 && dem_step(sim) % o->every == 0 && dem_step(sim) < scene->steps)
            status = outputs_write(&out, sim);
    }
    if (!status && (o->every <= 0 || scene->steps > 0)) status = outputs_write(&out, sim);
    if (!status) growth_report(&energy, sim, out.states.out);
    status = outputs_close(&out, scene, sim, status);
    return *stage ? cli_stage_close(o->o, stage, status) : status;
}

static rp_status run_row(const char *path, const run_options *o)
{
    if (!*o->o) return rp_fail(RP_USAGE, "%s is a sweep file: needs -o DIR, the folder for tables", path);
    if (o->set.n > 0) return rp_fail(RP_USAGE, "--set goes with a scene file; %s is a sweep file", path);
    sweep_result result;
    const sweep_protocol *protocol;
    const double started = rp_clock();
    char stage[4096];
    rp_status status = cli_stage_open(o->o, stage);
    if (status) return status;
    cli_stage_stops(stage);
    const sweep_tables tables = {stage, o->every > 0 ? o->every : 100, cli_provenance, o->ledger};
    status = sweep_trace(path, sweep_protocols, (size_t)o->row, &tables, &protocol, &result);
    status = cli_stage_close(o->o, stage, status);
    if (status) return status;
    const char *columns[SWEEP_MAX_OUTPUTS + 1][2];
    size_t n = 0;
    for (; protocol->outputs[n].name; n++) {
        columns[n][0] = protocol->outputs[n].name;
        columns[n][1] = protocol->outputs[n].unit;
    }
    columns[n][0] = "status";
    columns[n][1] = "";
    cli_provenance(stdout);
    rp_table_note(stdout, "run_time", "%.3g s", rp_clock() - started);
    rp_table_columns(stdout, n + 1, (const char *const(*)[2])columns);
    rp_table_row_word(stdout, n, result.values, result.status);
    return strncmp(result.status, "ok", 2) == 0
               ? RP_OK
               : rp_fail(RP_NO_RESULT, "%s%s%s", result.status, *result.message ? ": " : "", result.message);
}

static rp_status is_sweep(const char *path, bool *sweep)
{
    config_t config;
    rp_status status = rp_config_read(path, &config);
    *sweep = !status && config_lookup(&config, "protocol") != NULL;
    config_destroy(&config);
    return status;
}

static rp_status run_file(const char *path, const run_options *o)
{
    dem_scene scene;
    dem_sim *sim = NULL;
    if (cli_given("row")) return rp_fail(RP_USAGE, "--row goes with a sweep file; %s is a scene", path);
    rp_status status = dem_scene_read(path, &o->set, &scene);
    if (o->ledger) scene.def.ledger = true;
    if (!status && (status = dem_scene_start(&scene, &sim)) == RP_BAD_INPUT) rp_prefix(status, "%s: ", path);
    if (!status) status = run_scene(&scene, o, sim);
    dem_free(sim);
    dem_scene_free(&scene);
    return status;
}

static rp_status run_any(void *values)
{
    const char *path = cli_argument(0);
    bool sweep;
    rp_status status = is_sweep(path, &sweep);
    return status ? status : sweep ? run_row(path, values) : run_file(path, values);
}

const cli_command cmd_run = {
    "run",
    "simulate any scene, described in a file",
    "SCENE.cfg [--set KEY=VALUE]... [--every N] [--ledger] [-o DIR] | SWEEP.cfg [--row N] [--every N] "
    "[--ledger] -o DIR",
    "SCENE.cfg: simulate the scene and print the state of each grain: step, t (s), id, x, y (cm), angle\n"
    "(rad), vx, vy (cm/s), omega (rad/s), net force fx, fy (dyn), r (cm), m (g), contacts. With -o, the\n"
    "folder gets the tables states.tsv, contacts.tsv, walls.tsv and energy.tsv. `repose params scene`\n"
    "lists the keys of a scene file. Tables of a run that was stopped or failed go to DIR/unfinished:\n"
    "only a whole result replaces the one in DIR.\n"
    "\n"
    "SWEEP.cfg (a file with the key `protocol`): repeat one run of the sweep and print its results. The\n"
    "folder gets the tables of this run. For a box: grains, contacts, energies, and a file scene.cfg that\n"
    "`repose run` repeats bit for bit. For a static pile: disks, contacts, wells and the forces on the\n"
    "base.",
    "repose run scene.cfg --set tangential.mu=0.3 --every 1000 -o out",
    run_params,
    .act = run_any};
