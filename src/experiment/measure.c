/* Measures: samples of a phase, and what is made of them. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/arena.h"
#include "experiment/private.h"
#include "params/units.h"
#include "stats/stats.h"
#include "table/table.h"

static bool samples_in(const exp_measure *m, size_t phase)
{
    return !m->left_out && m->phase == phase && m->take != TAKE_VALUE;
}

/* A measure `at` an inner phase has a sample a pass, one `during` a phase at looks. */
static bool samples_at_looks(const exp_measure *m, size_t phase)
{
    return samples_in(m, phase) && *m->during;
}

long exp_next_look(long since, long every)
{
    return since < 0 ? every - since : every == 1 ? 1 : every - since % every; /* a division takes long */
}

void exp_measures_in(const exp_run *run, long *next)
{
    const long since = run->at.phase_step - run->plan->phases[run->at.phase].least;
    for (size_t k = 0; k < run->plan->n_measures; k++) {
        const exp_measure *m = &run->plan->measures[k];
        if (!samples_at_looks(m, run->at.phase)) continue;
        const long left = exp_next_look(since, m->every);
        *next = left < *next ? left : *next;
    }
}

/* What comes of a measure without numbers; RP_OK: nothing. */
static void no_numbers(exp_run *run, const exp_measure *m, rp_status status, const char *word)
{
    if (status && status != RP_NO_RESULT)
        run->failed = status;
    else if (status && !m->optional)
        exp_conclude(run, word, "%s: %s", m->name, rp_message());
}

static void add_sample(exp_run *run, size_t k)
{
    const exp_measure *m = &run->plan->measures[k];
    exp_samples *s = &run->samples[k];
    double out[EXP_MODULE_OUTPUTS];
    if (m->when.x.text && !exp_true(run, &m->when)) return;
    rp_status status = m->module && !run->failed ? exp_module_values(run, m, out) : RP_OK;
    no_numbers(run, m, status, m->module ? m->module->word : "");
    if (status || (m->module && m->module->add)) return;
    const double value = m->module ? out[m->pick] : exp_value(run, &m->of);
    const double beside = m->take == TAKE_LINE ? exp_value(run, &m->against)
                          : m->event.x.text    ? exp_number(run, "event", &m->event)
                                               : 0.0;
    const exp_sampled *last = s->n > 0 ? &s->at[s->n - 1] : NULL;
    if (run->failed) return;
    const bool extreme = m->take == TAKE_MAX || m->take == TAKE_MIN; /* of all samples so far */
    const bool some = m->skip != 0.0 || *m->level_of;
    if (!some && (m->take == TAKE_FIRST || (extreme && !m->series))) { /* one sample is enough */
        if (last &&
            (m->take == TAKE_FIRST || !(m->take == TAKE_MAX ? value > last->value : value < last->value)))
            return;
        s->n = 0;
    }
    if (s->n == s->room) {
        const size_t room = s->room ? 2 * s->room : 64;
        exp_sampled *more = realloc(s->at, room * sizeof *more);
        if (!more) {
            run->failed = rp_fail(RP_NO_MEMORY, "%s: out of memory", m->name);
            return;
        }
        s->at = more, s->room = room;
    }
    s->at[s->n++] = (exp_sampled){dem_time(run->sim), value, beside, (double)run->at.steps};
    /* what is known while the phase lasts */
    double *const known = &run->values[m->output];
    if (some) return;
    if (m->take == TAKE_FIRST || (extreme && !(m->take == TAKE_MAX ? value <= *known : value >= *known)))
        *known = value;
}

void exp_sample(exp_run *run)
{
    const exp_phase *phase = &run->plan->phases[run->at.phase];
    const long since = run->at.phase_step - phase->least;
    for (size_t k = 0; k < run->plan->n_measures && !run->failed; k++) {
        const exp_measure *m = &run->plan->measures[k];
        if (samples_at_looks(m, run->at.phase) && since > 0 && since % m->every == 0) add_sample(run, k);
    }
}

/* ---- what is made of samples ---- */

/* The first sample that counts. */
static rp_status first_of(const exp_run *run, const exp_measure *m, double work[], size_t *from)
{
    const exp_measure *level = &run->plan->measures[m->levels_with];
    const exp_samples *s = &run->samples[m->levels_with];
    if (s->n != run->samples[m - run->plan->measures].n)
        return rp_fail(RP_NO_RESULT, "%s has other samples", level->name);
    for (size_t i = 0; i < s->n; i++) work[i] = s->at[i].value;
    if (isinf(level->skip)) return stats_level_off(s->n, work, from);
    *from = (size_t)ceil(level->skip * (double)s->n);
    return RP_OK;
}

enum { BLOCKS = 10 };

/* Change over time, and its standard error from ten blocks. */
static void rate(const exp_samples *s, size_t from, double out[])
{
    const exp_sampled *at = &s->at[from];
    const size_t last = s->n - 1 - from;
    double rates[BLOCKS], mean = 0.0, sum = 0.0;
    out[0] = (at[last].value - at[0].value) / (at[last].time - at[0].time);
    if (last < 2 * BLOCKS) return;
    for (size_t b = 0; b < BLOCKS; b++) {
        const exp_sampled *lo = &at[last * b / BLOCKS], *hi = &at[last * (b + 1) / BLOCKS];
        mean += rates[b] = (hi->value - lo->value) / (hi->time - lo->time);
    }
    mean /= BLOCKS;
    for (size_t b = 0; b < BLOCKS; b++) sum += (rates[b] - mean) * (rates[b] - mean);
    out[1] = sqrt(sum / (BLOCKS - 1) / BLOCKS);
}

/* Falls of a series: samples with an event, from the one before; or falls by `drop` from a maximum, to the
 * minimum before it has risen as much again. Number; values before and after, each with its error. */
static rp_status avalanches(const exp_measure *m, const exp_samples *s, const double v[], size_t from,
                            double out[])
{
    double n = 0.0, sums[2] = {0.0, 0.0}, squares[2] = {0.0, 0.0}, most = v[from], least = v[from];
    bool falls = false;
    for (size_t i = from + 1; i <= s->n; i++) {
        const bool end = i == s->n;
        double pair[2] = {v[i - 1], end ? NAN : v[i]};
        bool found = !end && s->at[i].beside != 0.0;
        if (isfinite(m->drop)) {
            found = falls && (end || v[i] >= least + m->drop);
            pair[0] = most, pair[1] = least;
            if (found)
                falls = false, most = end ? most : v[i];
            else if (!end && !falls && v[i] <= most - m->drop)
                falls = true, least = v[i];
            else if (!end && falls)
                least = fmin(least, v[i]);
            else if (!end)
                most = fmax(most, v[i]);
        }
        if (!found) continue;
        n++;
        for (int k = 0; k < 2; k++) sums[k] += pair[k], squares[k] += pair[k] * pair[k];
    }
    out[0] = n;
    if (n == 0.0) return rp_fail(RP_NO_RESULT, "no avalanche in %zu samples", s->n - from);
    for (int k = 0; k < 2; k++) { /* mean and its standard error */
        const double about_mean = fmax(squares[k] - sums[k] * sums[k] / n, 0.0);
        out[1 + 2 * k] = sums[k] / n;
        out[2 + 2 * k] = n > 1.0 ? sqrt(about_mean / (n - 1.0) / n) : NAN;
    }
    return RP_OK;
}

/* The straight line through the samples. */
static rp_status straight(const exp_samples *s, const double v[], size_t from, double x[], double out[])
{
    stats_line line;
    for (size_t i = from; i < s->n; i++)
        if (!isfinite(x[i] = s->at[i].beside)) return rp_fail(RP_NO_RESULT, "against is %g", x[i]);
    RP_TRY(stats_line_fit(&(stats_xy){s->n - from, x + from, v + from, NULL}, false, &line));
    out[0] = line.intercept, out[1] = line.slope;
    if (line.dof > 0) out[2] = line.intercept_se, out[3] = line.slope_se;
    return RP_OK;
}

/* The outputs of a measure, in the order of its columns. */
static rp_status reduce(const exp_run *run, const exp_measure *m, const exp_samples *s, double out[])
{
    RP_SCOPE(arena);
    double *v, *work;
    size_t from;
    stats_series series = {0};
    if (s->n == 0) return rp_fail(RP_NO_RESULT, "no samples");
    RP_NEW(&arena, v, s->n);
    RP_NEW(&arena, work, s->n);
    for (size_t i = 0; i < s->n; i++)
        if (!isfinite(v[i] = s->at[i].value)) return rp_fail(RP_NO_RESULT, "a sample is %g", v[i]);
    RP_TRY(first_of(run, m, work, &from));
    if (from >= s->n) return rp_fail(RP_NO_RESULT, "one sample, and skip = %g", m->skip);
    if (m->take == TAKE_LINE) return straight(s, v, from, work, out);
    if (m->take == TAKE_AVALANCHES) return avalanches(m, s, v, from, out);
    if (m->take == TAKE_RATE && s->n - from < 2) return rp_fail(RP_NO_RESULT, "fewer than two samples");
    out[0] = v[from];
    for (size_t i = from; i < s->n; i++)
        if (m->take == TAKE_MAX ? v[i] > out[0] : m->take == TAKE_MIN && v[i] < out[0]) out[0] = v[i];
    if (m->take == TAKE_RATE) rate(s, from, out);
    if (m->take != TAKE_MEAN) return RP_OK;
    out[0] = 0.0;
    for (size_t i = from; i < s->n; i++) out[0] += v[i] / (double)(s->n - from);
    (void)stats_blocking(s->n - from, v + from, work, &series); /* a mean without an error is one */
    if (isfinite(series.mean)) out[0] = series.mean;
    out[1] = series.sd, out[2] = series.se;
    out[3] = isfinite(series.tau) ? (double)series.n / fmax(2.0 * series.tau, 1.0) : NAN;
    return RP_OK;
}

static void measure(exp_run *run, size_t k)
{
    const exp_measure *m = &run->plan->measures[k];
    double *out = &run->values[m->output], all[EXP_MODULE_OUTPUTS];
    for (int o = 0; o < EXP_MODULE_OUTPUTS; o++) all[o] = NAN;
    if (m->module && m->module->add && m->take != TAKE_VALUE) {
        if (run->samples[k].taken == 0.0 && !m->optional) exp_conclude(run, "no_samples", "%s", m->name);
        return;
    }
    if (m->take != TAKE_VALUE) {
        const rp_status status = reduce(run, m, &run->samples[k], all);
        memcpy(out, all, m->n_outputs * sizeof *out);
        no_numbers(run, m, status, "no_samples");
        return;
    }
    if (m->module) {
        const rp_status status = exp_module_values(run, m, all);
        no_numbers(run, m, status, m->module->word);
        for (size_t o = 0; !status && o < m->n_outputs; o++) out[o] = all[m->pick < 0 ? (long)o : m->pick];
        return;
    }
    out[0] = exp_value(run, &m->of);
    if (isfinite(out[0])) return;
    if (!m->optional && !run->failed) {
        RP_SCOPE(arena);
        const rp_x_values values = {run, exp_observe};
        const char *names = rp_expression_operands(&arena, &m->of.x, &values);
        exp_conclude(run, "nan", "%s = \"%s\" is %g; %s", m->name, m->of.x.text, out[0], names ? names : "");
    }
    out[0] = NAN;
}

void exp_measure_phase(exp_run *run, size_t phase)
{
    const exp_plan *plan = run->plan;
    const exp_phase *p = &plan->phases[phase];
    const bool passes = p->block != SIZE_MAX;
    /* a block has ended: first of its phases' samples, which its own measures may use */
    for (size_t i = phase + 1; i <= phase + p->n_inner; i++)
        for (size_t k = 0; k < plan->n_measures && !run->failed && !run->at.done; k++)
            if (samples_in(&plan->measures[k], i)) measure(run, k);
    for (size_t k = 0; k < plan->n_measures && !run->failed && !run->at.done; k++) {
        const exp_measure *m = &plan->measures[k];
        if (m->left_out || m->phase != phase) continue;
        if (m->take == TAKE_VALUE || !passes)
            measure(run, k);
        else if (!*m->during)
            add_sample(run, k);
    }
}

/* ---- series ---- */

const char *exp_series_name(const exp_plan *plan, size_t k)
{
    return k < plan->n_series ? plan->measures[plan->series[k]].file : NULL;
}

void exp_series_write(const exp_run *run, size_t k, FILE *out)
{
    const size_t number = run->plan->series[k];
    const exp_samples *s = &run->samples[number];
    const exp_measure *m = &run->plan->measures[number];
    if (s->sums) {
        m->module->write(m->params, s->taken, s->sums, out);
        return;
    }
    const char *const columns[][2] = {
        {"step", ""}, {"time", rp_unit("s")}, {m->name, run->plan->outputs[m->output].unit}};
    rp_table_columns(out, 3, columns);
    for (const exp_sampled *at = s->at; at < s->at + s->n; at++)
        rp_table_row(out, 3, (double[]){at->step, at->time, at->value});
}
