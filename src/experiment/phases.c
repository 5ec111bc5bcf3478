/* A run: from look to look, and from phase to phase. */
#include <gsl/gsl_minmax.h>
#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/random.h"
#include "experiment/private.h"
#include "table/columns.h"

static const exp_phase *phase_of(const exp_run *run)
{
    return &run->plan->phases[run->at.phase];
}

bool exp_done(const exp_run *run)
{
    return run->at.done;
}

dem_sim *exp_sim(const exp_run *run)
{
    return run->sim;
}

long exp_steps(const exp_run *run)
{
    return run->at.steps;
}

const exp_end *exp_ended(const exp_run *run)
{
    return &run->at.end;
}

const double *exp_values(const exp_run *run)
{
    return run->values;
}

/* ---- start and end ---- */

/* From this phase on, the next that is not left out: of a block, or of the text. */
static size_t present(const exp_plan *plan, size_t phase, size_t end)
{
    while (phase < end && plan->phases[phase].left_out) phase += 1 + plan->phases[phase].n_inner;
    return phase;
}

static size_t end_of_block(const exp_plan *plan, size_t block)
{
    return block + 1 + plan->phases[block].n_inner;
}

static rp_status make_room(exp_run *run)
{
    const exp_plan *p = run->plan;
    rp_arena *const arena = &run->arena;
    RP_NEW(arena, run->counters, p->n_states);
    RP_NEW(arena, run->values, p->n_outputs);
    RP_NEW(arena, run->samples, p->n_measures);
    RP_NEW(arena, run->loads, 2 * p->n_walls);
    RP_NEW(arena, run->points, p->n_regions);
    RP_NEW(arena, run->saved, p->n_phases);
    RP_NEW(arena, run->kept, p->n_phases);
    RP_NEW(arena, run->passed, p->n_phases);
    for (size_t k = 0; k < p->n_regions; k++) RP_NEW(arena, run->points[k], 2 * p->regions[k].n_points);
    for (size_t k = 0; k < p->n_phases; k++) RP_NEW(arena, run->saved[k].loads, 2 * p->n_walls);
    for (size_t k = 0; k < p->n_measures; k++) {
        const exp_measure *m = &p->measures[k];
        if (m->module && m->module->add) RP_NEW(arena, run->samples[k].sums, m->module->room(m->params));
    }
    for (size_t k = 0; k < p->n_outputs; k++) run->values[k] = NAN;
    for (size_t k = 0; k < 2 * p->n_walls; k++) run->loads[k] = -1;
    return RP_OK;
}

/* The simulation, and the kinds of its grains. */
static rp_status fill(exp_run *run, dem_scene *scene)
{
    const exp_plan *plan = run->plan;
    size_t i = scene->grains ? scene->def.n_grains : 0;
    RP_SCOPE(arena);
    RP_NEW(&arena, scene->ends, scene->n_fills);
    if (plan->adds) scene->def.radius_to_come = 0.5 * plan->d;
    RP_TRY(dem_scene_start(scene, &run->sim));
    if (!exp_make_ids(run, dem_count(run->sim) + 1)) return run->failed;
    for (size_t k = 0; k < scene->n_fills; k++) {
        const char *name = scene->fills[k].kind;
        const exp_scope *kind = exp_scope_named(plan, EXP_KIND, name, strlen(name), NULL);
        for (; i < scene->ends[k]; i++) run->kinds[i] = kind ? (int32_t)kind->index : -1;
    }
    return RP_OK;
}

/* A run without a simulation. */
static rp_status make_run(const exp_plan *plan, unsigned long seed, unsigned long stream, exp_run **made)
{
    exp_run *run = *made = calloc(1, sizeof *run);
    if (!run) return rp_fail(RP_NO_MEMORY, "run: out of memory");
    run->plan = plan;
    RP_TRY(make_room(run));
    for (int k = 0; k < 2 && plan->adds; k++) {
        run->random[k] = rp_random_in(&run->arena, seed, stream, k ? RP_PURPOSE_PLACES : RP_PURPOSE_RADII);
        if (!run->random[k]) return RP_NO_MEMORY;
    }
    run->at.now.turn[0] = plan->scene.def.turn_per_step * (180.0 / M_PI);
    run->at.now.turn[1] = plan->scene.def.box_turn_per_step * (180.0 / M_PI);
    run->at.now.laws = SIZE_MAX;
    return RP_OK;
}

/* What is there when the first phase begins. */
static void count_start(exp_run *run)
{
    run->at.grains0 = dem_count(run->sim);
    const dem_state *s = exp_states(run);
    for (size_t i = 0; s && i < run->n_states; i++) run->at.mass0 += s[i].m;
}

rp_status exp_start(const exp_plan *plan, unsigned long seed, unsigned long stream, exp_run **made)
{
    RP_TRY(make_run(plan, seed, stream, made));
    exp_run *run = *made;
    dem_scene scene = plan->scene;
    scene.seed = (long)seed, scene.run = (long)stream;
    for (int k = 0; k < 2; k++) scene.streams[k] = run->random[k];
    rp_status status = fill(run, &scene);
    if (status == RP_NO_RESULT) return exp_conclude(run, "no_room", "%s", rp_message()), RP_OK;
    if (status) return rp_prefix(status, "%s: ", plan->text->path);
    count_start(run);
    run->at.phase = present(plan, 0, plan->n_phases);
    if (run->at.phase == plan->n_phases) exp_conclude(run, plan->result, "%s", "");
    return run->failed;
}

rp_status exp_start_at(const exp_plan *plan, size_t phase, const dem_sim *sim, exp_run **made)
{
    RP_TRY(make_run(plan, (unsigned long)plan->scene.seed, (unsigned long)plan->scene.run, made));
    exp_run *run = *made;
    RP_TRY(dem_clone(sim, &run->sim));
    count_start(run);
    run->at.steps = dem_step(sim), run->at.phase = phase;
    for (size_t k = 0; k < phase; k++)
        if (plan->phases[k].has_laws) run->at.now.laws = k;
    const dem_state *s = exp_states(run);
    exp_make_ids(run, s && run->n_states ? s[run->n_states - 1].id + 1 : 1);
    return run->failed;
}

void exp_run_free(exp_run *run)
{
    if (!run) return;
    for (size_t k = 0; run->samples && k < run->plan->n_measures; k++) free(run->samples[k].at);
    for (size_t k = 0; run->saved && k < run->plan->n_phases; k++) dem_free(run->saved[k].sim);
    for (size_t k = 0; run->kept && k < run->plan->n_phases; k++) rp_snapshot_free(&run->kept[k]);
    free(run->marks), free(run->kinds), free(run->states), free(run->contacts);
    dem_free(run->sim);
    rp_arena_end(&run->arena);
    free(run);
}

/* ---- phases ---- */

static void clear(exp_run *run, const size_t states[2])
{
    for (size_t k = states[0]; k < states[1]; k++) run->counters[k] = 0.0;
}

/* Gravity and the motion of walls, at the phase's start; before each step those that change. */
static void set_forces(exp_run *run, const exp_phase *p, bool each_step)
{
    if (exp_given(&p->gravity[0]) && p->gravity_each_step == each_step) {
        const double gravity[2] = {exp_number(run, "gravity", &p->gravity[0]),
                                   exp_number(run, "gravity", &p->gravity[1])};
        if (run->ahead && !run->at.done) exp_check_speed(run, "gravity", gravity, true);
        if (run->at.done) return;
        dem_gravity_set(run->sim, gravity);
    }
    for (const exp_move *m = p->moves; m < p->moves + p->n_moves && !run->at.done; m++) {
        if (m->each_step != each_step) continue;
        const bool shifts = exp_given(&m->velocity[0]);
        const double velocity[2] = {shifts ? exp_number(run, "velocity", &m->velocity[0]) : 0.0,
                                    shifts ? exp_number(run, "velocity", &m->velocity[1]) : 0.0},
                     omega = exp_given(&m->omega) ? exp_number(run, "omega", &m->omega) : NAN;
        if (run->at.done) return;
        exp_move_wall(run, &run->plan->walls[m->wall], shifts ? velocity : NULL, omega);
    }
}

static void add_tilt(exp_run *run)
{
    run->at.now.tilt_before = run->at.now.tilt, run->at.now.tilted_at = run->at.phase_step;
}

/* Go on by some steps; one by one where forces change from step to step. */
static rp_status go(exp_run *run, long steps, bool one_by_one)
{
    for (const long part = one_by_one ? 1 : steps; steps > 0; steps -= part) {
        run->fresh = false;
        if (one_by_one) {
            run->ahead = true;
            set_forces(run, phase_of(run), true);
            if (!run->at.done) exp_push_walls(run);
            run->ahead = false;
            if (run->at.done || run->failed) break;
        }
        RP_TRY(dem_run(run->sim, part));
        run->at.phase_step += part, run->at.steps += part;
        run->at.now.tilt = run->at.now.tilt_before + (double)(run->at.phase_step - run->at.now.tilted_at) *
                                                         (run->at.now.turn[0] + run->at.now.turn[1]);
        if (one_by_one) add_tilt(run);
    }
    return RP_OK;
}

/* What a phase does at its start; a block begins with its first. */
static void begin_phase(exp_run *run)
{
    const exp_phase *p = phase_of(run);
    if (p->n_inner > 0) {
        clear(run, p->states);
        if (p->source != SIZE_MAX) exp_go_back(run, p);
        run->at.pass = 1;
        run->at.phase = present(run->plan, run->at.phase + 1, end_of_block(run->plan, run->at.phase));
        p = phase_of(run);
        run->fresh = false;
        exp_mark(run);
    }
    run->fresh = false;
    run->at.phase_step = 0;
    run->at.started = true;
    run->at.damped = 0.0;
    clear(run, p->states);
    if (p->source != SIZE_MAX) exp_go_back(run, p);
    add_tilt(run);
    run->at.begun = dem_time(run->sim);
    if (*p->remove) exp_remove(run, p);
    if (p->has_laws && !run->at.done && !run->failed) exp_change_laws(run, p);
    if (run->at.done || run->failed) return;
    exp_load_walls(run, p);
    set_forces(run, p, false);
    for (int k = 0; k < 2; k++)
        if (exp_given(&p->turn[k])) {
            run->at.now.turn[k] =
                exp_number(run, k ? "box_turn_deg_per_step" : "gravity_turn_deg_per_step", &p->turn[k]);
            if ((k ? dem_box_turn : dem_gravity_turn)(run->sim, run->at.now.turn[k] * (M_PI / 180.0)))
                exp_conclude(run, "no_turn", "phase %s: %s", p->name, rp_message());
        }
    for (size_t k = 0; p->opens >= 0 && k < run->plan->walls[p->opens].n; k++) {
        const size_t w = run->plan->walls[p->opens].walls[k];
        if (dem_wall_open(run->sim, w, dem_walls_of(&run->plan->scene.def)[w].open_speed))
            exp_conclude(run, "no_opening", "phase %s: %s", p->name, rp_message());
    }
    if (p->mark) exp_mark(run);
    if (p->add.on && !run->at.done) exp_add_grains(run, p);
    if (run->at.done || run->failed) return;
    const double least = p->ending == EXP_STEPS  ? exp_value(run, &p->end)
                         : p->ending == EXP_TIME ? exp_value(run, &p->end) / exp_laws(run)->dt
                                                 : (double)p->most;
    run->at.most = least >= 0.0 && least <= 9e15 ? lround(least) : -1;
    if (run->at.most < 0 && !run->failed)
        exp_conclude(run, "nan", "phase %s: %s \"%s\" is %g", p->name,
                     p->ending == EXP_STEPS ? "steps" : "time", p->end.x.text, least);
    for (size_t k = 0; k < run->plan->n_measures; k++)
        if (run->plan->measures[k].phase == run->at.phase && p->block == SIZE_MAX)
            clear(run, run->plan->measures[k].states);
}

static void keep_end(exp_run *run, size_t phase);

/* A phase has ended, or a block with so many passes. */
static void note_passed(exp_run *run, size_t phase, long passes)
{
    exp_passed *p = &run->passed[phase];
    p->passes = passes, p->step = run->at.steps, p->time = dem_time(run->sim);
}

static void end_run(exp_run *run)
{
    if (*run->at.end.status) /* of a phase that was gone on from */
        run->at.done = true;
    else
        exp_conclude(run, run->plan->result, "%s", "");
}

/* The phase that follows, or the end of the run. */
static void go_to_next(exp_run *run)
{
    const exp_plan *plan = run->plan;
    const exp_phase *p = phase_of(run);
    run->fresh = false;
    note_passed(run, run->at.phase, run->passed[run->at.phase].passes + 1);
    exp_measure_phase(run, run->at.phase);
    if (p->is_source && !run->failed) exp_save(run, run->at.phase);
    run->at.started = false;
    if (run->at.done || run->failed) return;
    const size_t end = p->block == SIZE_MAX ? plan->n_phases : end_of_block(plan, p->block);
    size_t next = present(plan, run->at.phase + 1, end);
    if (next == end && p->block != SIZE_MAX) { /* of a pass */
        const exp_phase *block = &plan->phases[p->block];
        const bool met = block->end.x.text && exp_number(run, "until", &block->end) == 1.0;
        if (run->at.done || run->failed) return;
        if (!met && run->at.pass < block->repeat) {
            run->at.pass++;
            run->at.phase = present(plan, p->block + 1, end);
            return;
        }
        if (!met && block->end.x.text && !block->go_on) {
            exp_conclude(run, block->status, "%s: %ld passes, and not %s", block->name, run->at.pass,
                         block->end.x.text);
            return;
        }
        note_passed(run, p->block, run->at.pass);
        exp_measure_phase(run, p->block);
        if (run->at.done || run->failed) return;
    }
    run->at.phase = next = present(plan, next, plan->n_phases);
    if (next == plan->n_phases) end_run(run);
}

static void end_phase(exp_run *run)
{
    const size_t phase = run->at.phase;
    go_to_next(run);
    if (run->plan->phases[phase].keep && !run->failed && (!run->at.done || rp_is_result(run->at.end.status)))
        keep_end(run, phase);
}

/* All velocities become 0 where the kinetic energy begins to fall: it has passed a maximum. */
static void damp(exp_run *run)
{
    dem_rest rest;
    if (!run->failed) run->failed = dem_rest_state(run->sim, -INFINITY, INFINITY, &rest);
    if (run->failed) return;
    const bool falls = rest.kinetic_energy < run->at.damped;
    if (falls) run->failed = dem_halt(run->sim);
    run->at.damped = falls ? 0.0 : rest.kinetic_energy;
    run->fresh = false;
}

/* One look: samples, what ends the run, what ends the phase. */
static void look(exp_run *run, bool is_end)
{
    const exp_phase *p = phase_of(run);
    const long since = run->at.phase_step - p->least;
    run->fresh = false;
    if (run->at.now.last && !run->at.now.touched)
        run->at.now.touched = dem_contact_count(run->sim, run->at.now.last) > 0;
    if (p->is_sampled) exp_sample(run);
    const bool looks = since > 0 && (p->every == 1 || since % p->every == 0); /* a division takes long */
    for (size_t k = 0; k < p->n_fails && (looks || is_end) && !run->failed && !run->at.done; k++)
        if (exp_number(run, p->fails[k].word, &p->fails[k].when) == 1.0)
            exp_conclude(run, p->fails[k].word, "phase %s, step %ld: %s", p->name, run->at.phase_step,
                         p->fails[k].when.x.text);
    if (run->failed || run->at.done) return;
    if (p->ending == EXP_UNTIL && looks && exp_number(run, "until", &p->end) == 1.0) {
        end_phase(run);
        return;
    }
    if (p->damp && looks) damp(run);
    if (!is_end || run->failed || run->at.done) return;
    if (p->ending == EXP_UNTIL && !p->go_on) {
        char now[160];
        exp_conclude(run, p->status, "phase %s, after %ld steps: %s", p->name, run->at.phase_step,
                     exp_where(run, now, sizeof now));
        return;
    }
    if (p->ending == EXP_UNTIL && *p->status && !*run->at.end.status) {
        snprintf(run->at.end.status, sizeof run->at.end.status, "%s", p->status);
        snprintf(run->at.end.message, sizeof run->at.end.message, "phase %s, after %ld steps", p->name,
                 run->at.phase_step);
    }
    end_phase(run);
}

rp_status exp_advance(exp_run *run, long most)
{
    if (!run->at.done && !run->at.started) begin_phase(run);
    if (run->at.done || run->failed) return run->failed;
    const exp_phase *p = phase_of(run);
    long next = LONG_MAX;
    if (p->ending == EXP_UNTIL || p->n_fails > 0 || p->damp)
        next = exp_next_look(run->at.phase_step - p->least, p->every);
    if (p->is_sampled) exp_measures_in(run, &next);
    const long left = run->at.most - run->at.phase_step, part = GSL_MIN(most, GSL_MIN(next, left));
    if (part > 0) {
        const rp_status status = go(run, part, p->each_step || exp_is_loaded(run));
        run->fresh = false;
        if (status == RP_BROKEN) {
            exp_conclude(run, dem_fault_text(dem_sim_fault(run->sim)), "%s", rp_message());
            return RP_OK;
        }
        RP_TRY(status);
        if (run->at.done || run->failed) return run->failed;
    }
    if (part == next || part == left) {
        add_tilt(run);
        look(run, part == left);
    }
    return run->failed;
}

size_t exp_phase_count(const exp_plan *plan)
{
    return plan->n_phases;
}

exp_passed exp_phase_at(const exp_run *run, size_t k)
{
    exp_passed passed = run->passed[k];
    passed.name = run->plan->phases[k].name;
    const exp_phase *p = &run->plan->phases[k];
    passed.inner = p->block != SIZE_MAX;
    passed.look = passed.inner && p->ending == EXP_STEPS && p->end.x.known && p->end.x.value == 0.0 &&
                  run->plan->phases[p->block].repeat <= 20;
    return passed;
}

size_t exp_stages(const exp_run *run)
{
    size_t n = 0;
    for (size_t k = 0; k < run->plan->n_phases; k++)
        n += run->plan->phases[k].block == SIZE_MAX && run->passed[k].passes > 0;
    return n;
}

bool exp_goes_back(const exp_plan *plan)
{
    for (size_t k = 0; k < plan->n_phases; k++)
        if (!plan->phases[k].left_out && plan->phases[k].source != SIZE_MAX) return true;
    return false;
}

const char *exp_where(const exp_run *run, char *text, size_t size)
{
    const exp_plan *plan = run->plan;
    if (run->at.done || run->at.phase >= plan->n_phases)
        return snprintf(text, size, "%s", run->at.end.status), text;
    const exp_phase *p = phase_of(run);
    RP_SCOPE(arena);
    if (p->ending == EXP_UNTIL && run->at.started) {
        const char *now = exp_operands(&arena, run, &p->end);
        snprintf(text, size, "%s: %s, until %s", p->name, now ? now : "", p->end.x.text);
    } else {
        snprintf(text, size, "%s", p->name);
    }
    return text;
}

/* ---- snapshots ---- */

#define ANOTHER "a run of another file"

static void keep_array(rp_snapshot *s, double *v, size_t n)
{
    size_t there = n;
    RP_KEEP(s, there);
    rp_keep_check(s, there == n, ANOTHER);
    rp_keep(s, v, n * sizeof *v);
}

static void keep_samples(rp_snapshot *s, exp_samples *samples)
{
    RP_KEEP(s, samples->n);
    if (s->reading) {
        rp_keep_check(s, samples->n <= (s->n - s->at) / sizeof *samples->at, "samples without end");
        if (s->status) return;
        free(samples->at);
        samples->room = samples->n;
        samples->at = malloc((samples->room + 1) * sizeof *samples->at);
        if (!samples->at) s->status = rp_fail(RP_NO_MEMORY, "samples: out of memory");
    }
    rp_keep(s, samples->at, samples->n * sizeof *samples->at);
}

static void keep_loads(rp_snapshot *s, const exp_plan *plan, long loads[])
{
    bool known = true;
    rp_keep(s, loads, 2 * plan->n_walls * sizeof *loads);
    for (size_t k = 0; k < 2 * plan->n_walls; k++) known &= loads[k] >= -1 && loads[k] < (long)plan->n_loads;
    rp_keep_check(s, known, ANOTHER);
}

static void keep_sim(rp_snapshot *s, dem_sim **sim)
{
    bool there = *sim != NULL;
    RP_KEEP(s, there);
    rp_keep_check(s, rp_keep_bool(&there), ANOTHER);
    if (s->reading) dem_free(*sim), *sim = NULL;
    if (there && !s->status) dem_keep(s, sim);
}

static bool has_laws(const exp_plan *plan, const exp_world *now)
{
    return now->laws == SIZE_MAX || now->laws < plan->n_phases;
}

static void keep_saved(rp_snapshot *s, const exp_plan *plan, exp_saved *saved)
{
    keep_sim(s, &saved->sim);
    if (!saved->sim) return;
    RP_KEEP(s, saved->now);
    keep_loads(s, plan, saved->loads);
    rp_keep_check(s, has_laws(plan, &saved->now), ANOTHER);
}

/* Marks and kinds, of as many ids as there have been. */
static void keep_ids(rp_snapshot *s, exp_run *run)
{
    size_t n = run->n_ids;
    bool known = true;
    RP_KEEP(s, n);
    rp_keep_check(s, n <= (s->n - s->at) / (2 * sizeof(double)), "grains without end");
    if (s->reading && !s->status && !exp_make_ids(run, n)) s->status = run->failed;
    if (s->status) return;
    run->n_ids = n;
    rp_keep(s, run->marks, 2 * n * sizeof *run->marks);
    rp_keep(s, run->kinds, n * sizeof *run->kinds);
    for (size_t k = 0; k < n; k++) known &= run->kinds[k] >= -1 && run->kinds[k] < (int)run->plan->n_kinds;
    rp_keep_check(s, known, ANOTHER);
}

uint64_t exp_keep_layout(void)
{
    return sizeof((exp_run *)NULL)->at << 10 ^ sizeof(exp_sampled) ^ 1;
}

static void keep_measure(rp_snapshot *s, exp_run *run, size_t k)
{
    const exp_measure *m = &run->plan->measures[k];
    keep_array(s, &run->values[m->output], m->n_outputs);
    keep_samples(s, &run->samples[k]);
    if (!run->samples[k].sums) return;
    RP_KEEP(s, run->samples[k].taken);
    keep_array(s, run->samples[k].sums, m->module->room(m->params));
}

/* All but measures, with the counters of their samples, and ends to go back to; the first n phases. */
static void keep_place(rp_snapshot *s, exp_run *run, size_t n)
{
    const exp_plan *p = run->plan;
    RP_KEEP(s, run->at);
    rp_keep_check(s,
                  rp_keep_bool(&run->at.started) && rp_keep_bool(&run->at.done) &&
                      rp_keep_bool(&run->at.now.touched) && run->at.phase <= p->n_phases &&
                      (run->at.done || run->at.phase < p->n_phases) && run->at.phase_step >= 0 &&
                      has_laws(p, &run->at.now) && memchr(run->at.end.status, 0, sizeof run->at.end.status) &&
                      memchr(run->at.end.message, 0, sizeof run->at.end.message),
                  "a place that no run is at");
    for (size_t k = 0; k < n; k++) {
        exp_passed *passed = &run->passed[k];
        RP_KEEP(s, passed->passes);
        RP_KEEP(s, passed->step);
        RP_KEEP(s, passed->time);
        rp_keep_check(s, passed->passes >= 0 && passed->step >= 0, "a phase that has not been");
    }
    keep_ids(s, run);
    keep_loads(s, p, run->loads);
    for (int k = 0; k < 2 && run->random[k] && !s->status; k++) {
        rp_keep(s, gsl_rng_state(run->random[k]), gsl_rng_size(run->random[k]));
        rp_keep_check(s, rp_random_is_whole(run->random[k]), "a random stream that is none");
    }
    if (!s->status) keep_sim(s, &run->sim);
    run->fresh = false;
}

/* ---- ends that are kept for other runs ---- */

static void keep_bytes(rp_snapshot *s, rp_snapshot *kept)
{
    size_t n = kept->n;
    RP_KEEP(s, n);
    if (s->reading) {
        rp_snapshot_free(kept);
        rp_keep_check(s, n <= s->n - s->at, "an end without end");
        if (!s->status && n > 0) rp_keep(kept, s->bytes + s->at, n), s->at += n;
        if (kept->status) s->status = kept->status;
    } else if (n > 0) {
        rp_keep(s, kept->bytes, n);
    }
}

void exp_keep(rp_snapshot *s, exp_run *run)
{
    const exp_plan *p = run->plan;
    keep_place(s, run, p->n_phases);
    keep_array(s, run->counters, p->n_states);
    for (size_t k = 0; k < p->n_measures && !s->status; k++) keep_measure(s, run, k);
    for (size_t k = 0; k < p->n_phases && !s->status; k++) {
        if (p->phases[k].is_source) keep_saved(s, p, &run->saved[k]);
        if (p->phases[k].keep) keep_bytes(s, &run->kept[k]);
    }
}

/* The measures up to a phase, and their hashes: another text may have others. */
typedef struct {
    size_t n, *which;
    XXH128_hash_t *of;
} measured;

static rp_status find_measured(const exp_plan *plan, size_t phase, rp_arena *arena, measured *m)
{
    RP_NEW(arena, m->which, plan->n_measures);
    RP_NEW(arena, m->of, plan->n_measures);
    for (size_t k = 0; k < plan->n_measures; k++) {
        if (plan->measures[k].left_out || plan->measures[k].phase > phase) continue;
        m->which[m->n] = k;
        if (!exp_measure_hash(plan, k, &m->of[m->n++])) return rp_fail(RP_NO_MEMORY, "state: out of memory");
    }
    return RP_OK;
}

/* What the expressions of a phase, or the samples of a measure, remember. */
static void keep_counters(rp_snapshot *s, const exp_run *run, const size_t states[2])
{
    keep_array(s, run->counters + states[0], states[1] - states[0]);
}

/* Hashes of the measures, steps of the phase, phases before that can be gone back to, the place; the bytes of
 * each measure. */
static rp_status write_end(exp_run *run, size_t phase)
{
    RP_SCOPE(arena);
    rp_snapshot *const s = &run->kept[phase];
    measured m = {0};
    RP_TRY(find_measured(run->plan, phase, &arena, &m));
    rp_snapshot_free(s);
    RP_KEEP(s, m.n);
    rp_keep(s, m.of, m.n * sizeof *m.of);
    RP_KEEP(s, run->at.phase_step);
    for (size_t k = 0; k < phase; k++) rp_keep(s, &(bool){run->saved[k].sim != NULL}, sizeof(bool));
    keep_place(s, run, phase + 1);
    keep_counters(s, run, run->plan->phases[phase].states);
    for (size_t k = 0; k < phase; k++)
        if (run->saved[k].sim) keep_saved(s, run->plan, &run->saved[k]);
    for (size_t i = 0; i < m.n; i++) {
        rp_snapshot one = {0};
        keep_measure(&one, run, m.which[i]);
        keep_counters(&one, run, run->plan->measures[m.which[i]].states);
        keep_bytes(s, &one);
        if (one.status) s->status = one.status;
        rp_snapshot_free(&one);
    }
    return s->status;
}

static void keep_end(exp_run *run, size_t phase)
{
    run->failed = write_end(run, phase);
}

/* Steps of a phase; -1: it ends by a condition, or by what the run alone knows. */
static long steps_of(const exp_phase *p)
{
    const double value = p->end.x.known ? p->end.x.value : NAN, n = p->ending == EXP_STEPS ? value
                                                                    : p->ending == EXP_TIME
                                                                        ? value / p->laws.physics.dt
                                                                        : NAN;
    return n >= 0.0 && n <= 9e15 ? lround(n) : -1;
}

/* Read the head of an end; does it have all that a run needs of before? *known: by number of the measure;
 * *left: steps that the last phase has more. */
static rp_status read_head(rp_snapshot *s, const exp_plan *plan, size_t phase, rp_arena *arena, measured *m,
                           bool **known, bool **back, long *left)
{
    const exp_phase *p = &plan->phases[phase];
    measured own = {0};
    long steps = 0;
    RP_TRY(find_measured(plan, phase, arena, &own));
    RP_KEEP(s, m->n);
    rp_keep_check(s, m->n <= (s->n - s->at) / sizeof *m->of, ANOTHER);
    RP_TRY(s->status);
    RP_NEW(arena, m->of, m->n);
    RP_NEW(arena, m->which, m->n);
    RP_NEW(arena, *known, plan->n_measures);
    RP_NEW(arena, *back, phase);
    rp_keep(s, m->of, m->n * sizeof *m->of);
    RP_KEEP(s, steps);
    *left = steps_of(p) < 0 ? 0 : steps_of(p) - steps;
    /* what fails counts its looks, and the end is one */
    const bool more = p->n_fails > 0 && (steps - p->least) % p->every != 0;
    if (*left < 0 || (*left > 0 && (more || present(plan, phase + 1, plan->n_phases) < plan->n_phases)))
        return rp_fail(RP_NO_RESULT, "%s: %s with %ld steps", s->path, p->name, steps);
    rp_keep(s, *back, phase * sizeof **back);
    for (size_t i = 0; i < m->n; i++) m->which[i] = SIZE_MAX;
    for (size_t j = 0; j < own.n; j++) {
        const exp_measure *of = &plan->measures[own.which[j]];
        size_t i = 0;
        while (i < m->n && !XXH128_isEqual(m->of[i], own.of[j])) i++;
        if (i < m->n)
            m->which[i] = own.which[j], (*known)[own.which[j]] = true;
        else if (of->phase < phase || of->take != TAKE_VALUE)
            return rp_fail(RP_NO_RESULT, "%s: %s is not in it", s->path, of->name);
    }
    for (size_t k = 0; k < phase; k++) {
        rp_keep_check(s, rp_keep_bool(&(*back)[k]), ANOTHER);
        if (plan->phases[k].is_source && !(*back)[k])
            return rp_fail(RP_NO_RESULT, "%s: the end of %s is not in it", s->path, plan->phases[k].name);
    }
    return s->status;
}

/* What follows the end of a phase: measures that other texts lack, and the end of the run. */
static void end_again(exp_run *run, size_t phase, const bool known[])
{
    const bool done = run->at.done;
    const size_t next = run->at.phase;
    if (run->plan->phases[phase].is_source) exp_save(run, phase);
    if (done && strcmp(run->at.end.status, run->plan->result) == 0) *run->at.end.status = '\0';
    run->at.phase = phase, run->at.done = false;
    exp_measure_again(run, phase, known);
    run->at.phase = next;
    if (done) end_run(run);
}

/* The last phase has more steps than where the state was left. */
static void go_on(exp_run *run, size_t phase, long left)
{
    if (strcmp(run->at.end.status, run->plan->result) == 0) *run->at.end.status = '\0';
    run->at.phase = phase, run->at.done = false, run->at.started = true;
    run->at.most = run->at.phase_step + left;
    run->passed[phase].passes = 0;
    for (size_t k = 0; k < run->plan->n_measures; k++) {
        const exp_measure *m = &run->plan->measures[k];
        for (size_t o = 0; m->phase == phase && m->take == TAKE_VALUE && o < m->n_outputs; o++)
            run->values[m->output + o] = NAN;
    }
}

rp_status exp_begin(exp_run *run, size_t k, rp_snapshot *s)
{
    RP_SCOPE(arena);
    const size_t phase = run->plan->kept[k];
    measured m = {0};
    bool *known, *back;
    long left;
    RP_TRY(read_head(s, run->plan, phase, &arena, &m, &known, &back, &left));
    keep_place(s, run, phase + 1);
    keep_counters(s, run, run->plan->phases[phase].states);
    for (size_t j = 0; j < phase && !s->status; j++)
        if (back[j]) keep_saved(s, run->plan, &run->saved[j]);
    for (size_t i = 0; i < m.n && !s->status; i++) {
        rp_snapshot one = {.path = s->path};
        keep_bytes(s, &one);
        one.reading = true;
        if (m.which[i] != SIZE_MAX) {
            keep_measure(&one, run, m.which[i]);
            keep_counters(&one, run, run->plan->measures[m.which[i]].states);
        }
        if (one.status) s->status = one.status;
        rp_snapshot_free(&one);
    }
    RP_TRY(rp_snapshot_end(s));
    if (run->at.phase <= phase && !run->at.done) return rp_fail(RP_BAD_INPUT, "%s: a state within", s->path);
    if (left > 0) return go_on(run, phase, left), RP_OK;
    end_again(run, phase, known);
    if (!run->failed) keep_end(run, phase);
    return run->failed;
}

size_t exp_kept_count(const exp_plan *plan)
{
    return plan->n_kept;
}

const char *exp_kept_name(const exp_plan *plan, size_t k)
{
    return plan->phases[plan->kept[k]].name;
}

const rp_snapshot *exp_kept(const exp_run *run, size_t k)
{
    return &run->kept[run->plan->kept[k]];
}

rp_status exp_kept_key(const exp_plan *plan, size_t k, unsigned long seed, unsigned long stream,
                       char digits[33])
{
    char text[128];
    XXH128_hash_t hash;
    if (!exp_hash(plan, NULL, 0, plan->kept[k] + 1, &hash))
        return rp_fail(RP_NO_MEMORY, "state: out of memory");
    rp_hash_digits(hash, digits);
    snprintf(text, sizeof text, "%s streams %lu %lu", digits, seed, stream);
    rp_hash_digits(XXH3_128bits(text, strlen(text)), digits);
    return RP_OK;
}
