/* What all files of a run read and change of it. */
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>

#include "experiment/looks.h"

void exp_conclude(exp_run *run, const char *status, const char *format, ...)
{
    va_list args;
    const bool first = !run->at.done && !run->at.missed;
    *(run->measuring ? &run->at.missed : &run->at.done) = true;
    if (!first) return;
    run->at.end.of_measure = run->measuring;
    va_start(args, format);
    snprintf(run->at.end.status, sizeof run->at.end.status, "%s", status);
    vsnprintf(run->at.end.message, sizeof run->at.end.message, format, args);
    va_end(args);
}

void exp_end_run(exp_run *run)
{
    if (*run->at.end.status) /* of a phase that was gone on from */
        run->at.done = true;
    else
        exp_conclude(run, run->plan->result, "%s", "");
}

const dem_state *exp_states(exp_run *run)
{
    if (run->fresh || run->failed) return run->failed ? NULL : run->states;
    const size_t n = dem_count(run->sim);
    void *more = realloc(run->states, (n + 1) * sizeof *run->states);
    if (!more) {
        run->failed = rp_fail(RP_NO_MEMORY, "grains: out of memory");
        return NULL;
    }
    run->states = more;
    run->failed = dem_states(run->sim, run->states);
    run->n_states = n;
    run->fresh = !run->failed;
    free(run->contacts), run->contacts = NULL;
    return run->failed ? NULL : run->states;
}

const dem_contact *exp_contacts(exp_run *run, size_t *n)
{
    if (exp_states(run) && !run->contacts)
        run->failed = dem_contacts(run->sim, &run->contacts, &run->n_contacts);
    *n = run->failed ? 0 : run->n_contacts;
    return run->contacts;
}

const dem_physics *exp_laws(const exp_run *run)
{
    const size_t laws = run->at.now.laws;
    return &(laws == SIZE_MAX ? &run->plan->scene.laws : &run->plan->phases[laws].laws)->physics;
}

bool exp_make_ids(exp_run *run, size_t id)
{
    const size_t n = id > 2 * run->n_ids ? id : 2 * run->n_ids;
    if (id <= run->n_ids) return true;
    double *marks = realloc(run->marks, 2 * n * sizeof *marks);
    if (marks) run->marks = marks;
    uint32_t *kinds = realloc(run->kinds, n * sizeof *kinds);
    if (kinds) run->kinds = kinds;
    if (!marks || !kinds) return run->failed = rp_fail(RP_NO_MEMORY, "grains: out of memory"), false;
    for (size_t k = run->n_ids; k < n; k++) marks[2 * k] = marks[2 * k + 1] = NAN, kinds[k] = 0;
    run->n_ids = n;
    return true;
}

void exp_mark(exp_run *run)
{
    const dem_state *s = exp_states(run);
    for (size_t k = 0; k < 2 * run->n_ids; k++) run->marks[k] = NAN;
    for (size_t i = 0; s && i < run->n_states; i++) {
        double x = s[i].x, y = s[i].y;
        if (s[i].fixed) continue;
        dem_box_frame(run->sim, &x, &y);
        run->marks[2 * (s[i].id - 1)] = x, run->marks[2 * (s[i].id - 1) + 1] = y;
    }
}

size_t exp_present(const exp_plan *plan, size_t phase, size_t end)
{
    while (phase < end && plan->phases[phase].left_out) phase += 1 + plan->phases[phase].n_inner;
    return phase;
}
