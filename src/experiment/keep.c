/* Snapshots of a run. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/random.h"
#include "experiment/run.h"

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
    for (size_t k = 0; k < n; k++) known &= run->kinds[k] <= run->plan->scene.def.n_kinds;
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

/* All but measures, counters and ends to go back to. */
static void keep_place(rp_snapshot *s, exp_run *run)
{
    const exp_plan *p = run->plan;
    RP_KEEP(s, run->at);
    rp_keep_check(s,
                  rp_keep_bool(&run->at.started) && rp_keep_bool(&run->at.done) &&
                      rp_keep_bool(&run->at.missed) && rp_keep_bool(&run->at.end.of_measure) &&
                      rp_keep_bool(&run->at.now.touched) && run->at.phase <= p->n_phases &&
                      (run->at.done || run->at.phase < p->n_phases) && run->at.phase_step >= 0 &&
                      has_laws(p, &run->at.now) && memchr(run->at.end.status, 0, sizeof run->at.end.status) &&
                      memchr(run->at.end.message, 0, sizeof run->at.end.message),
                  "a place that no run is at");
    for (size_t k = 0; k < p->n_phases; k++) {
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

void exp_keep(rp_snapshot *s, exp_run *run)
{
    const exp_plan *p = run->plan;
    keep_place(s, run);
    keep_array(s, run->counters, p->n_states);
    for (size_t k = 0; k < p->n_measures && !s->status; k++) keep_measure(s, run, k);
    for (size_t k = 0; k < p->n_phases && !s->status; k++)
        if (p->phases[k].is_source) keep_saved(s, p, &run->saved[k]);
}
