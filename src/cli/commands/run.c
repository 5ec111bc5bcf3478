/* `repose run`: any scene from a file, or one run of a sweep again with its tables. */
#include <signal.h>
#include <string.h>

#include "cli/cli.h"
#include "cli/closing.h"
#include "core/clock.h"
#include "core/elementary.h"
#include "params/config.h"
#include "params/units.h"
#include "sweeps/engine/experiment.h"

#define RUN_OPTIONS(X)                                                                                       \
    X(TEXTS, set, "", "", "",                                                                                \
      "KEY=VALUE, GROUP.KEY=VALUE or walls[0].KEY=VALUE replaces a key; may be repeated")                    \
    X(INT, every, "steps", "auto", "[1, 2147483647] | auto",                                                 \
      "interval between frames of all tables (of a sweep's run: of the energies); auto: only the last "      \
      "frame and the ends of phases (of a sweep's run: energies every 100 steps)")                           \
    X(TEXT, o, "", "", "", "folder for tables, instead of standard output")                                  \
    X(BOOL, ledger, "", "false", "",                                                                         \
      "add the terms of the energy ledger to the energies, as `ledger = true` in a scene file does")         \
    X(INT, j, "", "1", "[1, 256]",                                                                           \
      "number of threads, useful from some 16000 grains on; results are bitwise identical for any number")   \
    X(INT, row, "", "0", "[0, 2147483647]",                                                                  \
      "number of the run in the sweep, from 0: column `run` of its tables")                                  \
    CLI_FORCE(X, "replace a finished result in the folder")                                                  \
    CLI_QUIET(X)

CLI_OPTIONS(run, RUN_OPTIONS)

/* What a folder's tables are of, in their first lines. */
typedef struct {
    cli_call call;           /* with the command line of the start */
    const char *run, *start; /* of a folder; what is to be known of the start; or NULL */
} origin;

/* A run in the making, which looks on. Standard output holds the states alone, or what has been measured. */
typedef struct {
    const run_options *o;
    const char *path;
    dem_text text;
    sweep_again row; /* of a sweep; without a protocol a scene */
    exp_plan *plan;  /* NULL: of a protocol that is no text */
    bool plain;      /* no phases, and nothing measured */
    unsigned long seed, stream;
    long every[RUN_TABLES];
    double started;
    cli_looks looks;
    origin of;
    rp_folder folder;
    run_driver driver;
    sweep_result result; /* of a row */
} a_run;

static volatile bool stop_asked;

static void stop(int signal_number)
{
    (void)signal_number;
    stop_asked = true;
}

/* A second signal ends the process. */
static void stop_on_signals(void)
{
    static const int signals[] = {SIGINT, SIGTERM, SIGHUP};
    struct sigaction now, act = {.sa_handler = stop, .sa_flags = (int)SA_RESETHAND};
    for (int k = 0; k < 3; k++) /* not of nohup */
        if (sigaction(signals[k], NULL, &now) == 0 && now.sa_handler != SIG_IGN)
            sigaction(signals[k], &act, NULL);
}

static void put_origin(const void *context, rp_units units, FILE *out)
{
    const origin *of = context;
    cli_call call = of->call;
    call.units = units;
    cli_provenance(&call, out);
    if (of->run) rp_table_note(out, "run", "%s", of->run);
    if (of->run && of->start) rp_table_note(out, "start", "%s", of->start);
}

static void free_run(a_run *r)
{
    run_free(&r->driver);
    exp_free(r->plan);
    dem_text_close(&r->text);
    rp_folder_end(&r->folder);
}

/* ---- its start ---- */

static rp_status read_scene(a_run *r)
{
    RP_TRY(dem_text_open(r->path, NULL, &r->o->set, &r->text));
    r->plain = !exp_has_phases(&r->text);
    RP_TRY(exp_read(&r->text, &r->plan));
    RP_TRY(exp_check(r->plan));
    const dem_scene *scene = exp_scene(r->plan);
    if (*scene->unused) cli_say("repose run: particles_file: columns that are not used:%s", scene->unused);
    const double g = rp_hypot(scene->def.gravity[0], scene->def.gravity[1]);
    if (scene->def.units == RP_CGS && g > 9.7 && g < 9.9) /* that of SI */
        cli_say("repose: warning: %s: g = %g among values in cm, g and s; give units = \"si\", or g = %g",
                r->path, g, 100.0 * g);
    const long own[] = {scene->output.states, scene->output.energy, scene->output.contacts,
                        scene->output.walls},
               every = r->o->every;
    for (int k = 0; k < RUN_TABLES; k++) r->every[k] = every > 0 ? every : own[k];
    r->of.call.units = scene->def.units;
    r->seed = (unsigned long)scene->seed, r->stream = (unsigned long)scene->run;
    if (r->plain || every <= 0 || *r->o->o) return RP_OK;
    return rp_fail(
        RP_USAGE, "--every needs -o DIR; %s has phases, and standard output gets only the measures", r->path);
}

static rp_status read_row(a_run *r)
{
    if (!*r->o->o)
        return rp_fail(
            RP_USAGE,
            "%s is a sweep file; repose run %s --row N -o DIR repeats one of its runs, with tables; "
            "repose sweep make %s -o DIR makes all",
            r->path, r->path, r->path);
    RP_TRY(sweep_read_again(r->path, sweep_protocols, (size_t)r->o->row, r->of.call.arena, &r->row));
    r->every[RUN_ENERGY] = r->o->every > 0 ? r->o->every : 100;
    r->of.call.units = r->row.protocol->units;
    r->seed = r->row.seed, r->stream = r->row.stream;
    return sweep_protocol_plan(r->row.protocol, r->row.params, &r->plan);
}

static rp_status name_run(a_run *r)
{
    rp_arena *arena = r->of.call.arena;
    const char *frames = "", *row = r->row.protocol ? rp_text(arena, " row %ld", r->o->row) : "";
    char key[33] = "of its protocol";
    if (!*r->o->o) return RP_OK;
    if (r->plan) RP_TRY(run_key(r->plan, r->seed, r->stream, key));
    for (int k = 0; k < RUN_TABLES; k++)
        frames = r->every[k] < 0 ? rp_text(arena, "%s last", frames)
                                 : rp_text(arena, "%s %ld", frames, r->every[k]);
    r->of.run = rp_text(arena, "%s%s, frames each%s, key %s", r->path, row, frames, key);
    return RP_OK;
}

static rp_status start(a_run *r)
{
    const dem_scene *scene = exp_scene(r->plan);
    dem_counts now;
    dem_state falling;
    if (r->o->ledger) exp_with_ledger(r->plan);
    RP_TRY(run_start(r->plan, r->seed, r->stream, &r->driver));
    const exp_run *run = r->driver.run;
    if (!exp_sim(run)) return r->row.protocol ? RP_OK : rp_fail(RP_NO_RESULT, "%s", exp_ended(run)->message);
    dem_count_work(exp_sim(run), &now);
    if (exp_is_cut(run))
        r->of.start = "walls divide the region; only its largest part has grains";
    else if (*scene->particles_file && now.contacts > 0 && !scene->def.n_contacts &&
             dem_has_spring(scene->def.tangential))
        r->of.start =
            "grains touch, and their tangential springs begin at 0; a bed at rest needs contacts_file";
    RP_TRY(dem_first_falling(scene, exp_sim(run), &falling));
    if (falling.id)
        r->of.start = rp_text(
            r->of.call.arena,
            "grain %u at x = %g, y = %g falls for ever: no wall or fixed grain is below it, and no "
            "x_min, x_max or y_min removes it%s%s",
            falling.id, falling.x, falling.y, r->of.start ? "; " : "", r->of.start ? r->of.start : "");
    if (r->of.start && !r->o->quiet) cli_say("repose run: %s: %s", r->path, r->of.start);
    r->driver.threads = (size_t)r->o->j;
    if (r->plain) cli_looks_scene(&r->looks, scene, exp_sim(run));
    return RP_OK;
}

static rp_status open_result(a_run *r)
{
    const bool is_row = r->row.protocol;
    const char *directory = r->o->o;
    bool resumed;
    run_sinks to = {.stages = is_row,
                    .header = put_origin,
                    .of = &r->of,
                    .stop = &stop_asked,
                    .host = &r->looks,
                    .next = cli_looks_next,
                    .look = cli_looks_at,
                    .frame = is_row ? NULL : cli_looks_at_frame,
                    .keep = cli_looks_keep};
    memcpy(to.every, r->every, sizeof to.every);
    if (*directory) {
        const char *holds = rp_text(r->of.call.arena, "%s%s", r->of.run, r->o->ledger ? ", ledger" : "");
        RP_TRY(rp_folder_begin(r->of.call.arena, directory, holds, r->o->force, &r->folder));
        to.folder = r->folder.part;
        to.snapshot = r->folder.snapshot, to.owner = "repose run", to.interval = RUN_SNAPSHOT;
    } else if (r->plain) {
        to.states = r->of.call.out;
    }
    if (!r->plan) return RP_OK;
    RP_TRY(run_open(&r->driver, &to, &resumed));
    if (resumed && !r->o->quiet)
        cli_say("repose run: %s: continues from step %ld", directory, exp_steps(r->driver.run));
    return RP_OK;
}

/* ---- its end ---- */

static rp_status make(a_run *r)
{
    if (!r->plan) {
        const sweep_tables tables = {.directory = r->folder.part, .header = put_origin, .context = &r->of};
        return r->row.protocol->run(r->row.params, r->seed, r->stream, &tables, &r->result);
    }
    RP_TRY(run_finish(&r->driver));
    if (r->plain) cli_close_energy(&r->looks, exp_sim(r->driver.run), r->driver.table[RUN_STATES]);
    if (r->row.protocol) sweep_result_of(&r->driver, &r->result);
    return run_sync(&r->driver);
}

static void print_measures(const a_run *r)
{
    const cli_call *call = &r->of.call;
    cli_provenance(call, call->out);
    if (r->row.protocol) {
        rp_table_note(call->out, "run_time", "%.3g s", rp_clock() - r->started);
        cli_result_row(call, NULL, NULL, r->row.protocol->outputs, &r->result);
    } else {
        run_write_measures(&r->driver, call->out);
    }
}

/* The closing line of a run that measures. A word other than ok is no result. */
static rp_status close_measures(const a_run *r)
{
    rp_arena *arena = r->of.call.arena;
    const char *directory = r->o->o, *word = r->result.status, *message = r->result.message;
    size_t n = 0;
    if (!r->row.protocol)
        word = exp_ended(r->driver.run)->status, message = exp_ended(r->driver.run)->message;
    if (!rp_is_result(word))
        return rp_fail(RP_NO_RESULT, "%s: %s%s%s", word, message, *directory ? "; tables in " : "",
                       directory);
    if (r->o->quiet) return RP_OK;
    if (r->plan)
        word = rp_text(arena, "%s, %ld steps, t = %.5g", word, exp_steps(r->driver.run),
                       dem_time(exp_sim(r->driver.run)));
    const exp_output *of = r->plan ? exp_outputs(r->plan, &n) : NULL;
    for (size_t k = 0; k < n; k++)
        if (strcmp(of[k].name, "theta_r3_deg") == 0 && !isnan(exp_values(r->driver.run)[k]))
            word =
                rp_text(arena, "%s, theta_R = %.1f degrees (method 3)", word, exp_values(r->driver.run)[k]);
    cli_close_line(word, directory, "measures");
    return RP_OK;
}

static rp_status end_result(rp_folder *folder, rp_status run)
{
    char why[1024];
    if (!run) return rp_folder_publish(folder);
    if (rp_folder_is_empty(folder)) return run;
    snprintf(why, sizeof why, "%s", rp_message());
    return run == RP_STOPPED ? rp_fail(run, "%s; the same command continues", why)
                             : rp_fail(run, "%s; the tables so far are in %s", why, folder->part);
}

static rp_status finish(a_run *r)
{
    const char *directory = r->o->o;
    FILE *const out = r->of.call.out;
    rp_status status = make(r);
    if (!status && !r->plain) print_measures(r);
    if (*directory)
        status = end_result(&r->folder, status);
    else if (status && r->driver.table[RUN_STATES])
        rp_table_note(out, "unfinished", "%s", rp_message());
    else if (!status)
        status = rp_file_finish(out, "standard output");
    if (!status && !r->plain) return close_measures(r);
    if (!status && !r->o->quiet) cli_close_run(&r->looks, exp_sim(r->driver.run), directory);
    return status;
}

/* A sweep has a protocol, or models alone. */
static rp_status is_sweep(const char *path, bool *sweep)
{
    config_t config;
    rp_status status = rp_config_read(path, &config);
    *sweep = !status && (config_lookup(&config, "experiment") || config_lookup(&config, "protocol"));
    if (!status && !*sweep && config_lookup(&config, "model"))
        status =
            rp_fail(RP_BAD_INPUT,
                    "%s is a sweep file with models only; repose sweep make %s -o DIR writes their tables",
                    path, path);
    config_destroy(&config);
    return status;
}

static rp_status run_any(cli_call *call, const void *values)
{
    const run_options *o = values;
    const char *path = rp_data(call->arena, cli_argument(call, 0));
    RP_ENDS(free_run)
    a_run r = {.o = o,
               .path = path,
               .looks = {.arena = call->arena, .quiet = o->quiet, .threads = o->j},
               .of = {.call = *call},
               .started = rp_clock()};
    bool sweep;
    RP_TRY(is_sweep(path, &sweep));
    if (sweep && (cli_given(call, "j") || cli_given(call, "set")))
        return rp_fail(RP_USAGE, "-j and --set need a scene; %s is a sweep file, see repose sweep make",
                       path);
    if (!sweep && cli_given(call, "row"))
        return rp_fail(RP_USAGE, "--row needs a sweep file; %s is a scene", path);
    RP_TRY(sweep ? read_row(&r) : read_scene(&r));
    RP_TRY(name_run(&r));
    if (r.plan) RP_TRY(start(&r));
    if (r.plan) stop_on_signals();
    RP_TRY(open_result(&r));
    return finish(&r);
}

const cli_command cmd_run = {
    "run",
    "simulate the scene in a file",
    "SCENE.cfg [--set KEY=VALUE]... [--every N] [--ledger] [-o DIR [--force]]\n"
    "SWEEP.cfg [--row N] -o DIR [--every N] [--ledger] [--force]",
    "SCENE.cfg: simulates the scene; `repose params scene` lists the keys of the file. Without -o the states "
    "of the grains are printed, or the measures of an experiment (a scene with phases). With -o, the folder "
    "DIR gets states.tsv, contacts.tsv, walls.tsv and energy.tsv, with rows for every frame, and for an "
    "experiment also phases.tsv and measures.tsv. Each table names the units of its columns; `repose params "
    "--help` explains the columns.\n"
    "\n"
    "The result grows in DIR.part, which is renamed to DIR when it is complete. After a stop, a kill or a "
    "power cut, the same command continues from the last snapshot (there is one a minute), and ends with the "
    "same files as an undisturbed run.\n"
    "\n"
    "The run ends with one line on standard error: the number of grains and steps, whether the grains are at "
    "rest, and theta_R by method 3 of `repose angle slope` if the surface at rest falls to one side by all "
    "three methods. The slope "
    "is measured from the standing wall to the opened one, or over the whole pile if no wall opens. Grains "
    "are at rest if their mean kinetic energy is below 1e-7 m g d (m and d are mass and diameter of the mean "
    "grain) and the net force on each is below 1e-2 m "
    "g, at ten checks in the last 5000 steps.\n"
    "\n"
    "SWEEP.cfg, a file with the key `protocol`: repeats one run of the sweep with its tables, and prints its "
    "results. For a protocol with phases, the folder gets the grains, contacts and walls at the end of each "
    "phase, phases.tsv, energies, and a file scene.cfg that gives bitwise identical results with `repose "
    "run`. For a static pile, it gets the disks, contacts, wells and the forces on the base.\n"
    "\n"
    "A file that is not in the current folder, such as examples/pile.cfg, is read from the program's own "
    "files (PREFIX/share/repose where it is installed).",
    "repose run scene.cfg --set tangential.mu=0.3 --every 1000 -o out",
    run_params,
    .refuses = "A folder with a finished result, without --force; a folder with other files.\n"
               "--row with a scene; --set and -j with a sweep.",
    .act = run_any};
