/* A run: from look to look, and from phase to phase. */
#include <gsl/gsl_minmax.h>
#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/random.h"
#include "experiment/looks.h"

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

bool exp_is_cut(const exp_run *run)
{
    return run->cut;
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
    if (!exp_make_ids(run, s && run->n_states ? s[run->n_states - 1].id + 1 : 1)) return;
    for (size_t i = 0; s && i < run->n_states; i++)
        run->at.mass0 += s[i].m, run->kinds[s[i].id - 1] = s[i].kind;
}

rp_status exp_start(const exp_plan *plan, unsigned long seed, unsigned long stream, exp_run **made)
{
    RP_TRY(make_run(plan, seed, stream, made));
    exp_run *run = *made;
    dem_scene scene = plan->scene;
    scene.seed = (long)seed, scene.run = (long)stream;
    for (int k = 0; k < 2; k++) scene.streams[k] = run->random[k];
    scene.cut = &run->cut;
    if (plan->adds) scene.def.radius_to_come = 0.5 * plan->d, scene.def.mass_to_come = plan->m;
    rp_status status = dem_scene_start(&scene, &run->sim);
    if (status == RP_NO_RESULT) return exp_conclude(run, "no_room", "%s", rp_message()), RP_OK;
    if (status) return rp_prefix(status, "%s: ", plan->text->path);
    count_start(run);
    run->at.phase = exp_present(plan, 0, plan->n_phases);
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
    return run->failed;
}

void exp_run_free(exp_run *run)
{
    if (!run) return;
    for (size_t k = 0; run->samples && k < run->plan->n_measures; k++) free(run->samples[k].at);
    for (size_t k = 0; run->saved && k < run->plan->n_phases; k++) dem_free(run->saved[k].sim);
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

static void set_gravity(exp_run *run, const exp_phase *p)
{
    if (!exp_given(&p->gravity[0])) return;
    const double gravity[2] = {exp_number(run, "gravity", &p->gravity[0]),
                               exp_number(run, "gravity", &p->gravity[1])};
    if (run->ahead && !run->at.done) exp_check_speed(run, "gravity", gravity, true);
    if (!run->at.done) dem_gravity_set(run->sim, gravity);
}

/* The motion of walls, at the phase's start; before each step where it changes. */
static void set_motion(exp_run *run, const exp_phase *p, bool each_step)
{
    for (const exp_move *m = p->moves; p->n_moves && m < p->moves + p->n_moves && !run->at.done; m++) {
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

/* Go on by some steps; one by one where forces change from step to step. A step takes gravity's value at its
 * middle; what is read after it, that at its end. */
static rp_status go(exp_run *run, long steps, bool one_by_one)
{
    const exp_phase *p = phase_of(run);
    for (const long part = one_by_one ? 1 : steps; steps > 0; steps -= part) {
        run->fresh = false;
        if (one_by_one) {
            run->ahead = true;
            if (p->gravity_each_step) set_gravity(run, p);
            set_motion(run, p, true);
            if (!run->at.done) exp_push_walls(run);
            run->ahead = false;
            if (run->at.done || run->failed) break;
        }
        RP_TRY(dem_run(run->sim, part));
        run->at.phase_step += part, run->at.steps += part;
        run->at.now.tilt = run->at.now.tilt_before + (double)(run->at.phase_step - run->at.now.tilted_at) *
                                                         (run->at.now.turn[0] + run->at.now.turn[1]);
        if (one_by_one) add_tilt(run);
        run->fresh = false;
        if (p->gravity_each_step) set_gravity(run, p);
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
        run->at.phase = exp_present(run->plan, run->at.phase + 1, end_of_block(run->plan, run->at.phase));
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
    set_gravity(run, p);
    if (!run->at.done) set_motion(run, p, false);
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
        exp_conclude(run, "no_number", "phase %s: %s \"%s\" is %g", p->name,
                     p->ending == EXP_STEPS ? "steps" : "time", p->end.x.text, least);
    for (size_t k = 0; k < run->plan->n_measures; k++)
        if (run->plan->measures[k].phase == run->at.phase && p->block == SIZE_MAX)
            clear(run, run->plan->measures[k].states);
}

/* A phase has ended, or a block with so many passes. */
static void note_passed(exp_run *run, size_t phase, long passes)
{
    exp_passed *p = &run->passed[phase];
    p->passes = passes, p->step = run->at.steps, p->time = dem_time(run->sim);
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
    size_t next = exp_present(plan, run->at.phase + 1, end);
    if (next == end && p->block != SIZE_MAX) { /* of a pass */
        const exp_phase *block = &plan->phases[p->block];
        const bool met = block->end.x.text && exp_number(run, "until", &block->end) == 1.0;
        if (run->at.done || run->failed) return;
        if (!met && run->at.pass < block->repeat) {
            run->at.pass++;
            run->at.phase = exp_present(plan, p->block + 1, end);
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
    run->at.phase = next = exp_present(plan, next, plan->n_phases);
    if (next == plan->n_phases) exp_end_run(run);
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
        go_to_next(run);
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
    go_to_next(run);
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
        const bool wrong = dem_sim_fault(run->sim) == DEM_FAULT_NON_FINITE;
        if (status == RP_BROKEN && !exp_has_phases(run->plan->text)) return wrong ? status : RP_NO_RESULT;
        if (status == RP_BROKEN) {
            exp_conclude(run, dem_fault_text(dem_sim_fault(run->sim)), "%s", rp_message());
            return RP_OK;
        }
        RP_TRY(status);
        if (run->at.done || run->failed) return run->failed;
    }
    if (part == next || part == left) {
        if (part == next) add_tilt(run); /* a phase that follows adds it, a longer one does not look here */
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

const char *exp_where(const exp_run *run, char *text, size_t size)
{
    const exp_plan *plan = run->plan;
    if (!exp_has_phases(plan->text)) return snprintf(text, size, "%ld", plan->scene.steps), text;
    if (run->at.done || run->at.phase >= plan->n_phases)
        return snprintf(text, size, "%s", run->at.end.status), text;
    const exp_phase *p = phase_of(run);
    RP_SCOPE(arena);
    if (p->ending == EXP_UNTIL && run->at.started) {
        const char *now = exp_operands(&arena, run, &p->end);
        snprintf(text, size, "%s: step %ld, t = %.4g: %s, until %s", p->name, run->at.phase_step,
                 dem_time(run->sim) - run->at.begun, now ? now : "", p->end.x.text);
    } else if (run->at.started) {
        snprintf(text, size, "%s: step %ld of %ld, t = %.4g", p->name, run->at.phase_step, run->at.most,
                 dem_time(run->sim) - run->at.begun);
    } else {
        snprintf(text, size, "%s", p->name);
    }
    return text;
}
