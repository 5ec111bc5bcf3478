/* A run: from look to look, and from phase to phase. */
#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "experiment/private.h"

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
    run->counters = calloc(p->n_states + 1, sizeof *run->counters);
    run->values = calloc(p->n_outputs + 1, sizeof *run->values);
    run->samples = calloc(p->n_measures + 1, sizeof *run->samples);
    run->marks = calloc(2 * run->n_ids + 1, sizeof *run->marks);
    if (!run->counters || !run->values || !run->samples || !run->marks)
        return rp_fail(RP_NO_MEMORY, "run: out of memory");
    for (size_t k = 0; k < p->n_outputs; k++) run->values[k] = NAN;
    for (size_t k = 0; k < 2 * run->n_ids; k++) run->marks[k] = NAN;
    return RP_OK;
}

rp_status exp_start(const exp_plan *plan, unsigned long seed, unsigned long stream, exp_run **made)
{
    exp_run *run = *made = calloc(1, sizeof *run);
    if (!run) return rp_fail(RP_NO_MEMORY, "run: out of memory");
    dem_scene scene = plan->scene;
    scene.fill.seed = (long)seed, scene.fill.run = (long)stream;
    run->plan = plan;
    run->n_ids = scene.has_fill ? (size_t)scene.fill.N : scene.def.n_grains;
    RP_TRY(make_room(run));
    run->at.turn[0] = scene.def.turn_per_step * (180.0 / M_PI);
    run->at.turn[1] = scene.def.box_turn_per_step * (180.0 / M_PI);
    rp_status status = dem_scene_start(&scene, &run->sim);
    if (status == RP_NO_RESULT) return exp_conclude(run, "no_room", "%s", rp_message()), RP_OK;
    if (status) return rp_prefix(status, "%s: ", plan->text->path);
    run->at.grains0 = dem_count(run->sim);
    const dem_state *s = exp_states(run);
    for (size_t i = 0; s && i < run->n_states; i++) run->at.mass0 += s[i].m;
    run->at.phase = present(plan, 0, plan->n_phases);
    if (run->at.phase == plan->n_phases) exp_conclude(run, plan->result, "%s", "");
    return run->failed;
}

void exp_run_free(exp_run *run)
{
    if (!run) return;
    for (size_t k = 0; run->samples && k < run->plan->n_measures; k++) free(run->samples[k].at);
    free(run->counters), free(run->values), free(run->samples), free(run->marks), free(run->states);
    dem_free(run->sim);
    free(run);
}

/* ---- phases ---- */

static void clear(exp_run *run, const size_t states[2])
{
    for (size_t k = states[0]; k < states[1]; k++) run->counters[k] = 0.0;
}

/* All walls of a name move as one. */
static void move_walls(exp_run *run, const exp_phase *p, const exp_move *m)
{
    const exp_wall *wall = &run->plan->walls[m->wall];
    const double velocity[2] = {m->has_velocity ? exp_value(run, &m->velocity[0]) : 0.0,
                                m->has_velocity ? exp_value(run, &m->velocity[1]) : 0.0},
                 omega = m->has_omega ? exp_value(run, &m->omega) : NAN;
    for (size_t k = 0; k < wall->n && !run->at.done; k++)
        if (dem_wall_move(run->sim, wall->walls[k], m->has_velocity ? velocity : NULL, omega))
            exp_conclude(run, "too_fast", "phase %s: %s: %s", p->name, wall->name, rp_message());
}

/* Gravity and the motion of walls, at the phase's start; before each step those that change. */
static void set_forces(exp_run *run, const exp_phase *p, bool each_step)
{
    if (p->has_gravity && p->gravity_each_step == each_step)
        dem_gravity_set(run->sim, (double[]){exp_value(run, &p->gravity[0]), exp_value(run, &p->gravity[1])});
    for (size_t k = 0; k < p->n_moves; k++)
        if (p->moves[k].each_step == each_step) move_walls(run, p, &p->moves[k]);
}

/* Steps whose forces change from one to the next. */
static rp_status go_by_steps(exp_run *run, long steps)
{
    rp_status status = RP_OK;
    for (; steps > 0 && !status && !run->failed && !run->at.done; steps--) {
        run->fresh = false;
        run->ahead = true;
        set_forces(run, phase_of(run), true);
        run->ahead = false;
        if (run->at.done || run->failed) break;
        status = dem_run(run->sim, 1);
        if (!status) run->at.phase_step++, run->at.steps++;
        if (!status) run->at.tilt += run->at.turn[0] + run->at.turn[1];
    }
    return status;
}

static rp_status go(exp_run *run, long steps)
{
    rp_status status = dem_run(run->sim, steps);
    if (status) return status;
    run->at.phase_step += steps, run->at.steps += steps;
    run->at.tilt += (double)steps * (run->at.turn[0] + run->at.turn[1]);
    return RP_OK;
}

/* What a phase does at its start; a block begins with its first. */
static void begin_phase(exp_run *run)
{
    const exp_phase *p = phase_of(run);
    if (p->n_inner > 0) {
        clear(run, p->states);
        run->at.pass = 1;
        run->at.phase = present(run->plan, run->at.phase + 1, end_of_block(run->plan, run->at.phase));
        p = phase_of(run);
    }
    run->fresh = false;
    run->at.phase_step = 0;
    run->at.begun = dem_time(run->sim);
    run->at.started = true;
    clear(run, p->states);
    set_forces(run, p, false);
    for (int k = 0; k < 2; k++)
        if (p->turns[k]) {
            run->at.turn[k] = exp_value(run, &p->turn[k]);
            (k ? dem_box_turn : dem_gravity_turn)(run->sim, run->at.turn[k] * (M_PI / 180.0));
        }
    for (size_t k = 0; p->opens >= 0 && k < run->plan->walls[p->opens].n; k++) {
        const size_t w = run->plan->walls[p->opens].walls[k];
        dem_wall_open(run->sim, w, dem_walls_of(&run->plan->scene.def)[w].open_speed);
    }
    if (p->mark || p->block == SIZE_MAX) exp_mark(run);
    const double least = p->ending == EXP_STEPS  ? exp_value(run, &p->end)
                         : p->ending == EXP_TIME ? exp_value(run, &p->end) / run->plan->scene.def.dt
                                                 : (double)p->most;
    run->at.most = least >= 0.0 && least <= 9e15 ? lround(least) : -1;
    if (run->at.most < 0 && !run->failed)
        exp_conclude(run, "nan", "phase %s: %s \"%s\" is %g", p->name,
                     p->ending == EXP_STEPS ? "steps" : "time", p->end.x.text, least);
    for (size_t k = 0; k < run->plan->n_measures; k++)
        if (run->plan->measures[k].phase == run->at.phase && p->block == SIZE_MAX)
            clear(run, run->plan->measures[k].states);
}

/* The phase that follows, or the end of the run. */
static void end_phase(exp_run *run)
{
    const exp_plan *plan = run->plan;
    const exp_phase *p = phase_of(run);
    run->fresh = false;
    exp_measure_phase(run, run->at.phase);
    run->at.started = false;
    if (run->at.done || run->failed) return;
    const size_t end = p->block == SIZE_MAX ? plan->n_phases : end_of_block(plan, p->block);
    size_t next = present(plan, run->at.phase + 1, end);
    if (next == end && p->block != SIZE_MAX) { /* of a pass */
        const exp_phase *block = &plan->phases[p->block];
        const bool met = block->end.x.text && exp_true(run, &block->end);
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
        exp_measure_phase(run, p->block);
        if (run->at.done || run->failed) return;
    }
    run->at.phase = next = present(plan, next, plan->n_phases);
    if (next < plan->n_phases) return;
    if (*run->at.end.status) /* of a phase that was gone on from */
        run->at.done = true;
    else
        exp_conclude(run, plan->result, "%s", "");
}

/* One look: samples, what ends the run, what ends the phase. */
static void look(exp_run *run, bool is_end)
{
    const exp_phase *p = phase_of(run);
    const long since = run->at.phase_step - p->least;
    run->fresh = false;
    exp_sample(run);
    const bool looks = since > 0 && since % p->every == 0;
    for (size_t k = 0; k < p->n_fails && looks && !run->failed && !run->at.done; k++)
        if (exp_true(run, &p->fails[k].when))
            exp_conclude(run, p->fails[k].word, "phase %s, step %ld: %s", p->name, run->at.phase_step,
                         p->fails[k].when.x.text);
    if (run->failed || run->at.done) return;
    if (p->ending == EXP_UNTIL && looks && exp_true(run, &p->end)) {
        end_phase(run);
        return;
    }
    if (!is_end) return;
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

static long least_of(long a, long b)
{
    return a < b ? a : b;
}

rp_status exp_advance(exp_run *run, long most)
{
    if (!run->at.done && !run->at.started) begin_phase(run);
    if (run->at.done || run->failed) return run->failed;
    const exp_phase *p = phase_of(run);
    long next = LONG_MAX;
    if (p->ending == EXP_UNTIL || p->n_fails > 0) {
        const long since = run->at.phase_step - p->least;
        next = since < 0 ? p->every - since : p->every - since % p->every;
    }
    exp_measures_in(run, &next);
    const long left = run->at.most - run->at.phase_step, part = least_of(most, least_of(next, left));
    if (part > 0) {
        rp_status status = p->each_step ? go_by_steps(run, part) : go(run, part);
        run->fresh = false;
        if (status == RP_BROKEN) {
            exp_conclude(run, dem_fault_text(dem_sim_fault(run->sim)), "%s", rp_message());
            return RP_OK;
        }
        RP_TRY(status);
        if (run->at.done || run->failed) return run->failed;
    }
    if (part == next || part == left) look(run, part == left);
    return run->failed;
}

/* A condition that counts looks, without another one. */
static double show(void *host, int id, const double args[])
{
    const exp_run *run = host;
    const exp_use *use = id < EXP_ID_MEASURE ? &run->plan->uses[id] : NULL;
    return use && use->of->type == RP_X_TRUTH ? run->counters[use->state] : exp_observe(host, id, args);
}

const char *exp_where(const exp_run *run, char *text, size_t size)
{
    const exp_plan *plan = run->plan;
    if (run->at.done || run->at.phase >= plan->n_phases)
        return snprintf(text, size, "%s", run->at.end.status), text;
    const exp_phase *p = phase_of(run);
    RP_SCOPE(arena);
    const rp_x_values values = {(void *)run, show};
    if (p->ending == EXP_UNTIL && run->at.started) {
        const char *now = rp_expression_operands(&arena, &p->end.x, &values);
        snprintf(text, size, "%s: %s, until %s", p->name, now ? now : "", p->end.x.text);
    } else {
        snprintf(text, size, "%s", p->name);
    }
    return text;
}

/* ---- snapshots ---- */

static void keep_array(rp_snapshot *s, double *v, size_t n)
{
    size_t there = n;
    RP_KEEP(s, there);
    rp_keep_check(s, there == n, "a run of another file");
    if (!s->status && n > 0) rp_keep(s, v, n * sizeof *v);
}

static void keep_samples(rp_snapshot *s, exp_samples *samples)
{
    RP_KEEP(s, samples->n);
    if (s->reading) {
        rp_keep_check(s, samples->n <= (s->n - s->at) / sizeof(double) / EXP_SAMPLE, "samples without end");
        if (s->status) return;
        free(samples->at);
        samples->room = samples->n;
        samples->at = malloc((EXP_SAMPLE * samples->room + 1) * sizeof *samples->at);
        if (!samples->at) s->status = rp_fail(RP_NO_MEMORY, "samples: out of memory");
    }
    if (!s->status && samples->n > 0) rp_keep(s, samples->at, EXP_SAMPLE * samples->n * sizeof *samples->at);
}

void exp_keep(rp_snapshot *s, exp_run *run)
{
    const exp_plan *p = run->plan;
    RP_KEEP(s, run->at);
    rp_keep_check(s,
                  rp_keep_bool(&run->at.started) && rp_keep_bool(&run->at.done) &&
                      run->at.phase <= p->n_phases && (run->at.done || run->at.phase < p->n_phases) &&
                      run->at.phase_step >= 0 && memchr(run->at.end.status, 0, sizeof run->at.end.status) &&
                      memchr(run->at.end.message, 0, sizeof run->at.end.message),
                  "a place that no run is at");
    keep_array(s, run->counters, p->n_states);
    keep_array(s, run->values, p->n_outputs);
    keep_array(s, run->marks, 2 * run->n_ids);
    for (size_t k = 0; k < p->n_measures && !s->status; k++) keep_samples(s, &run->samples[k]);
    bool there = run->sim != NULL;
    RP_KEEP(s, there);
    if (s->reading) dem_free(run->sim), run->sim = NULL;
    if (there && !s->status) dem_keep(s, &run->sim);
    run->fresh = false;
}
