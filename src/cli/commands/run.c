/* `repose run`: any scene from a file, or one run of a sweep again with its tables. */
#include <string.h>
#include <unistd.h>
#include <xxhash.h>

#include "cli/cli.h"
#include "cli/closing.h"
#include "cli/progress.h"
#include "cli/result.h"
#include "core/clock.h"
#include "core/elementary.h"
#include "params/config.h"
#include "params/units.h"
#include "run/run.h"

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

/* What a folder's tables are of, in their first lines. */
typedef struct {
    cli_call call; /* with the command line of the start */
    char run[1024];
    const char *start; /* what is to be known of it, or NULL */
} origin;

/* A run in the making, which looks on. Standard output holds the states alone, or the measures of phases. */
typedef struct {
    const run_options *o;
    dem_text text;
    exp_plan *plan;
    bool plain; /* no phases, and nothing measured */
    long every[RUN_TABLES];
    cli_growth energy;
    cli_rest rest;
    bool over_friction, told; /* of threads */
    origin of;
    rp_folder folder;
    run_driver driver;
    cli_progress progress;
} scene_run;

static volatile bool stop_asked;

static void put_origin(const void *context, rp_units units, FILE *out)
{
    const origin *of = context;
    cli_call call = of->call;
    call.units = units;
    cli_provenance(&call, out);
    rp_table_note(out, "run", "%s", of->run);
    if (of->start) rp_table_note(out, "start", "%s", of->start);
}

static void put_call(const void *context, rp_units units, FILE *out)
{
    (void)units;
    cli_provenance(&((const origin *)context)->call, out);
}

static void free_run(scene_run *r)
{
    run_free(&r->driver);
    exp_free(r->plan);
    dem_text_close(&r->text);
    rp_folder_end(&r->folder);
}

/* ---- looking on ---- */

static long next(const void *host, long step)
{
    const scene_run *r = host;
    const long looks = cli_rest_next(&r->rest, step), left = cli_growth_next(&r->energy, step);
    return looks < left ? looks : left;
}

static rp_status look(void *host, const exp_run *run)
{
    scene_run *r = host;
    const dem_sim *sim = exp_sim(run);
    char where[256];
    if (r->plain)
        cli_progress_show(&r->progress, rp_clock(), exp_steps(run), stderr);
    else
        cli_progress_tell(&r->progress, rp_clock(),
                          exp_done(run) ? NULL : exp_where(run, where, sizeof where), stderr);
    if (!r->told) cli_tell_threads(sim, "run", r->o->j);
    r->told = true;
    cli_growth_look(&r->energy, sim);
    return r->plain ? cli_rest_look(r->of.call.arena, sim, &r->rest) : RP_OK;
}

/* Once a run. */
static void tell_friction(void *host, const exp_run *run)
{
    scene_run *r = host;
    size_t over = 0;
    const size_t n = r->o->quiet || r->over_friction ? 0 : dem_over_friction(exp_sim(run), &over);
    if (over == 0) return;
    r->over_friction = true;
    fprintf(
        stderr,
        "repose run: warning: t = %.5g: the shear force of %zu of %zu contacts exceeds mu times the normal "
        "force: damping = \"outside\" adds the dashpot to this limit, \"inside\" obeys it\n",
        dem_time(exp_sim(run)), over, n);
}

static void keep(rp_snapshot *s, void *host)
{
    scene_run *r = host;
    RP_KEEP(s, r->energy);
    RP_KEEP(s, r->rest);
}

/* ---- its start ---- */

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
    RP_TRY(dem_text_open(path, NULL, &r->o->set, &r->text));
    r->plain = !exp_has_phases(&r->text);
    RP_TRY(exp_read(&r->text, &r->plan));
    RP_TRY(exp_check(r->plan));
    const dem_scene *scene = exp_scene(r->plan);
    if (*scene->unused) fprintf(stderr, "repose run: particles_file: not used:%s\n", scene->unused);
    r->of.call.units = scene->def.units;
    warn_gravity(path, scene->def.units, rp_hypot(scene->def.gravity[0], scene->def.gravity[1]));
    if (r->o->ledger) exp_with_ledger(r->plan);
    const long *own = (const long[]){scene->output.states, scene->output.energy, scene->output.contacts,
                                     scene->output.walls};
    for (int k = 0; k < RUN_TABLES; k++) r->every[k] = r->o->every > 0 ? r->o->every : own[k];
    return RP_OK;
}

/* Of the run, its streams and its measures. */
static rp_status key_of(const scene_run *r, char digits[33])
{
    XXH128_hash_t sum;
    exp_measured m;
    const dem_scene *scene = exp_scene(r->plan);
    RP_TRY(exp_key(r->plan, &sum));
    for (size_t k = 0; k < exp_measure_count(r->plan); k++) {
        RP_TRY(exp_measure_at(r->plan, k, &m));
        if (m.n_outputs > 0) sum = rp_hash_add(sum, m.key);
    }
    rp_hash_digits(rp_hash_add(sum, XXH3_128bits((long[]){scene->seed, scene->run}, 2 * sizeof(long))),
                   digits);
    return RP_OK;
}

static rp_status name_run(const char *path, scene_run *r)
{
    const long *every = r->every;
    rp_arena *arena = r->of.call.arena;
    const char *frames = *every > 0 ? rp_text(arena, "a frame each %ld", *every) : "the last frame",
               *length = r->plain ? rp_text(arena, "%ld steps", exp_scene(r->plan)->steps) : "phases";
    char key[33];
    RP_TRY(key_of(r, key));
    if (every[RUN_ENERGY] != *every || every[RUN_CONTACTS] != *every || every[RUN_WALLS] != *every)
        frames = rp_text(arena, "frames each %ld (states), %ld (energy), %ld (contacts), %ld (walls)",
                         every[RUN_STATES], every[RUN_ENERGY], every[RUN_CONTACTS], every[RUN_WALLS]);
    snprintf(r->of.run, sizeof r->of.run, "%.400s, %s, %s, key %s", path, length, frames, key);
    return RP_OK;
}

static rp_status start(const char *path, scene_run *r)
{
    const dem_scene *scene = exp_scene(r->plan);
    dem_counts now;
    RP_TRY(run_start(r->plan, (unsigned long)scene->seed, (unsigned long)scene->run, &r->driver));
    const exp_run *run = r->driver.run;
    if (!exp_sim(run)) return rp_fail(RP_NO_RESULT, "%s", exp_ended(run)->message);
    dem_count_work(exp_sim(run), &now);
    if (exp_is_cut(run))
        r->of.start = "walls cut the region; grains lie in its largest part alone";
    else if (*scene->particles_file && now.contacts > 0 && !scene->def.n_contacts &&
             dem_has_spring(scene->def.tangential))
        r->of.start = "grains touch, and their shear springs begin at 0; a bed at rest needs contacts_file";
    if (r->of.start && !r->o->quiet) fprintf(stderr, "repose run: %s: %s\n", path, r->of.start);
    r->driver.threads = (size_t)r->o->j;
    r->rest.steps = r->plain ? scene->steps : 0;
    if (r->plain) r->energy = cli_growth_of(scene, exp_sim(run));
    return RP_OK;
}

static rp_status open_result(scene_run *r, bool *resumed)
{
    const char *snapshot = NULL, *directory = r->o->o;
    run_sinks to = {.header = put_call,
                    .of = &r->of,
                    .stop = &stop_asked,
                    .host = r,
                    .next = r->plain ? next : NULL,
                    .look = look,
                    .frame = tell_friction,
                    .keep = keep};
    memcpy(to.every, r->every, sizeof to.every);
    if (*directory) {
        const char *holds =
            rp_text(r->of.call.arena, "%s%s", r->of.run, exp_scene(r->plan)->def.ledger ? ", ledger" : "");
        RP_TRY(cli_result_begin(r->of.call.arena, directory, holds, r->o->force, &r->folder, &snapshot));
        to.folder = r->folder.part, to.header = put_origin;
        to.snapshot = snapshot, to.owner = "repose run", to.interval = CLI_SNAPSHOT;
    } else if (r->plain) {
        to.states = r->of.call.out;
    }
    RP_TRY(run_open(&r->driver, &to, resumed));
    if (*resumed && !r->o->quiet)
        fprintf(stderr, "repose run: %s: continues from step %ld\n", directory, exp_steps(r->driver.run));
    return RP_OK;
}

/* ---- its end ---- */

/* The closing line of a run with phases. A word other than ok is no result. */
static rp_status close_phases(const scene_run *r)
{
    const exp_run *run = r->driver.run;
    const exp_end *end = exp_ended(run);
    const char *directory = r->o->o;
    if (!rp_is_result(end->status))
        return rp_fail(RP_NO_RESULT, "%s: %s%s%s", end->status, end->message,
                       *directory ? "; tables in " : "", directory);
    if (r->o->quiet) return RP_OK;
    fprintf(stderr, "repose run: %s, %ld steps, t = %.5g%s", end->status, exp_steps(run),
            dem_time(exp_sim(run)), *directory ? "" : "; measures on standard output\n");
    if (*directory) cli_close_line(directory);
    return RP_OK;
}

static rp_status finish(scene_run *r)
{
    const char *directory = r->o->o;
    FILE *const states = r->driver.table[RUN_STATES];
    const exp_run *run = r->driver.run;
    rp_status status = run_finish(&r->driver);
    if (!status && r->plain) cli_growth_report(&r->energy, exp_sim(run), states);
    if (!status) status = run_sync(&r->driver);
    if (!status && !r->plain) {
        put_call(&r->of, r->of.call.units, r->of.call.out);
        run_write_measures(&r->driver, r->of.call.out);
    }
    if (*directory)
        status = cli_result_end(&r->folder, status);
    else if (status && states)
        rp_table_note(r->of.call.out, "unfinished", "%s", rp_message());
    else if (!status)
        status = rp_file_finish(r->of.call.out, "standard output");
    if (!status && !r->plain) return close_phases(r);
    if (!status && !r->o->quiet) cli_close_run(r->of.call.arena, exp_sim(run), &r->rest, directory);
    return status;
}

static rp_status run_file(const cli_call *call, const char *path, const run_options *o)
{
    RP_ENDS(free_run) scene_run r = {.o = o, .of = {.call = *call}, .told = o->quiet};
    bool resumed = false;
    if (cli_given(call, "row")) return rp_fail(RP_USAGE, "--row needs a sweep file; %s is a scene", path);
    RP_TRY(read_text(path, &r));
    if (!r.plain && o->every > 0 && !*o->o)
        return rp_fail(RP_USAGE,
                       "--every needs -o DIR; %s has phases, and standard output holds what they measure",
                       path);
    RP_TRY(name_run(path, &r));
    RP_TRY(start(path, &r));
    cli_on_stop(&stop_asked);
    RP_TRY(open_result(&r, &resumed));
    r.progress = cli_progress_start(o->quiet, isatty(STDERR_FILENO), rp_clock(), exp_steps(r.driver.run),
                                    r.rest.steps);
    return finish(&r);
}

/* ---- a run of a sweep ---- */

/* stops: it looks whether it is asked to stop; else the first signal ends it. */
static rp_status run_row(const cli_call *call, const char *path, const run_options *o, bool stops)
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
    origin of = {.call = *call};
    snprintf(of.run, sizeof of.run, "%s row %ld", path, o->row);
    const long every = o->every > 0 ? o->every : 100;
    const char *holds =
        rp_text(call->arena, "%s, energies each %ld%s", of.run, every, o->ledger ? ", ledger" : "");
    RP_ENDS(rp_folder_end) rp_folder folder = {0};
    if (stops) cli_on_stop(&stop_asked);
    RP_TRY(cli_result_begin(call->arena, o->o, holds, o->force, &folder, &snapshot));
    const sweep_tables tables = {.directory = folder.part,
                                 .every = every,
                                 .header = put_origin,
                                 .context = &of,
                                 .ledger = o->ledger,
                                 .snapshot = snapshot,
                                 .interval = CLI_SNAPSHOT,
                                 .stop = &stop_asked};
    RP_TRY(cli_result_end(
        &folder, sweep_trace(path, sweep_protocols, (size_t)o->row, &tables, call->arena, &made, &result)));
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

/* A sweep has a protocol, or models alone. *text: what its runs do is a text. */
static rp_status is_sweep(const char *path, bool *sweep, bool *text)
{
    config_t config;
    const char *name = "";
    rp_status status = rp_config_read(path, &config);
    *text = !status && config_lookup(&config, "experiment");
    *sweep = !status && (*text || config_lookup(&config, "protocol"));
    if (*sweep) config_lookup_string(&config, "protocol", &name);
    for (const sweep_protocol *const *p = sweep_protocols; *p; p++)
        *text |= strcmp((*p)->name, name) == 0 && (*p)->text;
    if (!status && !*sweep && config_lookup(&config, "model"))
        status =
            rp_fail(RP_BAD_INPUT,
                    "%s is a sweep file of models alone; repose sweep make %s -o DIR writes their tables",
                    path, path);
    config_destroy(&config);
    return status;
}

static rp_status run_any(cli_call *call, const void *values)
{
    static const char *const of_scenes[] = {"j", "set"};
    const char *path = cli_data(call->arena, cli_argument(call, 0));
    bool sweep, text;
    RP_TRY(is_sweep(path, &sweep, &text));
    for (size_t i = 0; sweep && i < N_OF(of_scenes); i++)
        if (cli_given(call, of_scenes[i]))
            return rp_fail(RP_USAGE, "%s%s needs a scene; %s is a sweep file%s", i == 0 ? "-" : "--",
                           of_scenes[i], path,
                           i > 0 ? ""
                                 : ", whose runs take one processor each; repose sweep make -j works on "
                                   "several runs");
    return sweep ? run_row(call, path, values, text) : run_file(call, path, values);
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
