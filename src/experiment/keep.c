/* Snapshots of a run, and the ends of phases that are kept for other runs and other measures. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/random.h"
#include "experiment/private.h"
#include "table/columns.h"

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
    return sizeof((exp_run *)NULL)->at << 10 ^ sizeof(exp_sampled) ^ 3;
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
                      rp_keep_bool(&run->at.missed) && rp_keep_bool(&run->at.now.touched) &&
                      run->at.phase <= p->n_phases && (run->at.done || run->at.phase < p->n_phases) &&
                      run->at.phase_step >= 0 && has_laws(p, &run->at.now) &&
                      memchr(run->at.end.status, 0, sizeof run->at.end.status) &&
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
        rp_keep(s, run->random[k], sizeof *run->random[k]);
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

/* The place at the end of a phase, whatever this text has after it. */
static void keep_end(rp_snapshot *s, exp_run *run, size_t phase)
{
    const size_t next = run->at.phase;
    const bool done = run->at.done;
    const char word = *run->at.end.status;
    if (done && !*run->at.end.message) *run->at.end.status = '\0'; /* of no phase that was gone on from */
    run->at.phase = phase, run->at.done = false;
    keep_place(s, run, phase + 1);
    run->at.phase = next, run->at.done = done, *run->at.end.status = word;
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
    keep_end(s, run, phase);
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

void exp_keep_end(exp_run *run, size_t phase)
{
    if (!run->at.missed && (!run->at.done || rp_is_result(run->at.end.status)))
        run->failed = write_end(run, phase);
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
    *left = exp_known_steps(p) < 0 ? 0 : exp_known_steps(p) - steps;
    /* what fails counts its looks, and the end is one, at which a grain may touch */
    const bool more = exp_names(plan, "touched") || (p->n_fails > 0 && (steps - p->least) % p->every != 0);
    if (*left < 0 || (*left > 0 && (more || exp_present(plan, phase + 1, plan->n_phases) < plan->n_phases)))
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

/* What follows the end of a phase: measures that other texts lack, the next phase or the end of the run. */
static void end_again(exp_run *run, size_t phase, const bool known[])
{
    const exp_plan *plan = run->plan;
    if (plan->phases[phase].is_source) exp_save(run, phase);
    exp_measure_again(run, phase, known);
    if (run->at.done || run->failed) return;
    run->at.phase = exp_present(plan, phase + 1, plan->n_phases);
    if (run->at.phase == plan->n_phases) exp_end_run(run);
}

/* The last phase has more steps than where the state was left. */
static void go_on(exp_run *run, size_t phase, long left)
{
    run->at.started = true;
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
    if (run->at.phase != phase || run->at.done) return rp_fail(RP_BAD_INPUT, "%s: a state within", s->path);
    if (left > 0) return go_on(run, phase, left), RP_OK;
    end_again(run, phase, known);
    if (!run->failed) exp_keep_end(run, phase);
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
