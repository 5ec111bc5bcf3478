/* Measures: samples of a phase, and what is made of them. */
#include <gsl/gsl_cdf.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/arena.h"
#include "experiment/looks.h"
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

long exp_known_steps(const exp_phase *p)
{
    double n = p->ending != EXP_UNTIL && p->end.x.known ? p->end.x.value : NAN;
    if (p->ending == EXP_TIME) n /= p->laws.physics.dt;
    return n >= 0.0 && n <= 9e15 ? lround(n) : -1;
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

/* A value; *begins: it is none yet, since change(e) has its first. */
static double sampled(exp_run *run, const exp_expression *e, bool *begins)
{
    const double value = exp_value(run, e);
    for (size_t k = 0; k < e->x.n_states; k++)
        *begins |= isnan(value) && run->counters[e->state + k] == -INFINITY;
    return value;
}

static void add_sample(exp_run *run, size_t k)
{
    const exp_measure *m = &run->plan->measures[k];
    exp_samples *s = &run->samples[k];
    double out[EXP_MODULE_OUTPUTS];
    if (m->when.x.text && !exp_true(run, &m->when)) return;
    rp_status status = m->module && !run->failed ? exp_module_values(run, m, out) : RP_OK;
    no_numbers(run, m, status, m->module ? m->module->word : "");
    if ((status && m->optional) || (m->module && m->module->add)) return;
    bool begins = false;
    const double value = status ? NAN : m->module ? out[m->pick] : sampled(run, &m->of, &begins);
    const double beside = m->take == TAKE_LINE ? sampled(run, &m->against, &begins)
                          : m->event.x.text    ? exp_true(run, &m->event)
                                               : 0.0;
    const exp_sampled *last = s->n > 0 ? &s->at[s->n - 1] : NULL;
    if (run->failed || begins) return;
    const bool extreme = m->take == TAKE_MAX || m->take == TAKE_MIN; /* of all samples so far */
    const bool some = m->skip != 0.0 || *m->level_of;
    double *const known = &run->values[m->output]; /* while the phase lasts */
    if (!some && extreme && isfinite(value) && !(m->take == TAKE_MAX ? value <= *known : value >= *known))
        *known = value;
    if (!some &&
        (m->take == TAKE_FIRST || (extreme && !m->series))) { /* one is enough, or the first of nan */
        const bool worse = last && !(m->take == TAKE_MAX ? value > last->value : value < last->value);
        if (last && (m->take == TAKE_FIRST || !isfinite(last->value) || (worse && isfinite(value)))) return;
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
    s->at[s->n++] = (exp_sampled){dem_time(run->sim), value, beside, (double)run->at.steps,
                                  *m->during ? (double)run->at.pass : 0.0};
    if (!some && m->take == TAKE_FIRST) *known = value;
}

void exp_sample(exp_run *run)
{
    const exp_phase *phase = &run->plan->phases[run->at.phase];
    const long since = run->at.phase_step - phase->least;
    run->measuring = true;
    for (size_t k = 0; k < run->plan->n_measures && !run->failed; k++) {
        const exp_measure *m = &run->plan->measures[k];
        if (samples_at_looks(m, run->at.phase) && since > 0 && since % m->every == 0) add_sample(run, k);
    }
    run->measuring = false;
}

/* ---- what is made of samples ---- */

static size_t end_of_pass(const exp_samples *s, size_t begin)
{
    size_t end = begin;
    while (end < s->n && s->at[end].pass == s->at[begin].pass) end++;
    return end;
}

/* The samples that count: without the first ones, of each pass of a phase that is repeated. */
static rp_status take_counting(const exp_run *run, const exp_measure *m, rp_arena *arena,
                               exp_samples *counting)
{
    const exp_measure *level = &run->plan->measures[m->levels_with];
    const exp_samples *s = &run->samples[m - run->plan->measures], *by = &run->samples[m->levels_with];
    double *v;
    size_t from = 0;
    if (by->n != s->n) return rp_fail(RP_NO_RESULT, "%s has other samples", level->name);
    RP_NEW(arena, v, s->n);
    RP_NEW(arena, counting->at, s->n);
    for (size_t i = 0; i < s->n; i++) v[i] = by->at[i].value;
    if (isinf(level->skip)) RP_TRY(stats_level_off(s->n, v, &from));
    for (size_t end; from < s->n; from = end) {
        end = isinf(level->skip) ? s->n : end_of_pass(s, from);
        if (isfinite(level->skip)) from += (size_t)ceil(level->skip * (double)(end - from) - 1e-9);
        for (size_t i = from; i < end; i++) counting->at[counting->n++] = s->at[i];
    }
    return RP_OK;
}

enum { BLOCKS = 10, FEW = 20 };

static double rate_between(const exp_sampled *lo, const exp_sampled *hi)
{
    return (hi->value - lo->value) / (hi->time - lo->time);
}

/* Change over time, the mean of those of the passes, and its standard error from ten blocks: those of one
 * pass, unless it is too short for the correlation of its steps, or ten passes or more. */
static rp_status rate(const exp_samples *s, rp_arena *arena, double out[])
{
    double *rates, *work;
    size_t n = 0;
    stats_summary all;
    stats_series series;
    RP_NEW(arena, rates, s->n + BLOCKS);
    RP_NEW(arena, work, s->n);
    for (size_t i = 0, end; i < s->n; i = end)
        if ((end = end_of_pass(s, i)) - i > 1) rates[n++] = rate_between(&s->at[i], &s->at[end - 1]);
    if (n == 0) return rp_fail(RP_NO_RESULT, "fewer than two samples");
    if (stats_mean(n, rates, &all)) return rp_fail(RP_NO_RESULT, "two samples at one time");
    out[0] = all.mean;
    const size_t last = s->n - 1;
    if (n == 1 && end_of_pass(s, 0) == s->n && last >= 2 * BLOCKS) {
        for (size_t i = 0; i < last; i++) rates[i] = rate_between(&s->at[i], &s->at[i + 1]);
        if (!stats_blocking(last, rates, work, &series))
            for (n = 0; n < BLOCKS; n++)
                rates[n] = rate_between(&s->at[last * n / BLOCKS], &s->at[last * (n + 1) / BLOCKS]);
    }
    /* why there is no error, which the rate does not need */
    if (n == 1 && last < 2 * BLOCKS)
        rp_fail(RP_NO_RESULT, "%zu samples: more than %d needed, or %d passes", s->n, 2 * BLOCKS, BLOCKS);
    if (n > 1 && n < BLOCKS) rp_fail(RP_NO_RESULT, "%zu passes: at least %d needed", n, BLOCKS);
    if (n < BLOCKS) return RP_OK;
    if (!stats_mean(n, rates, &all)) out[1] = all.se;
    return RP_OK;
}

/* Sums over the falls of the samples from `begin` to `end`: number; values before and after, and squares. */
typedef struct {
    double n, sums[2], squares[2];
} falls_found;

static void add_falls(const exp_measure *m, const exp_sampled *s, const exp_sampled *end, falls_found *f)
{
    double most = s->value, least = s->value;
    bool falls = false;
    for (s++; s <= end; s++) {
        const bool ends = s == end;
        const double value = ends ? NAN : s->value;
        double pair[2] = {s[-1].value, value};
        bool found = !ends && s->beside != 0.0;
        if (isfinite(m->drop)) {
            found = falls && (ends || value >= least + m->drop);
            pair[0] = most, pair[1] = least;
            if (found)
                falls = false, most = ends ? most : value;
            else if (!ends && !falls && value <= most - m->drop)
                falls = true, least = value;
            else if (!ends && falls)
                least = fmin(least, value);
            else if (!ends)
                most = fmax(most, value);
        }
        if (!found) continue;
        f->n++;
        for (int k = 0; k < 2; k++) f->sums[k] += pair[k], f->squares[k] += pair[k] * pair[k];
    }
}

/* Falls of the series of each pass: samples with an event, from the one before; or falls by `drop` from a
 * maximum, to the minimum before it has risen as much again. Number; values before and after, each with its
 * error. */
static rp_status avalanches(const exp_measure *m, const exp_samples *s, double out[])
{
    falls_found f = {0};
    for (size_t i = 0, end; i < s->n; i = end)
        end = end_of_pass(s, i), add_falls(m, &s->at[i], &s->at[end], &f);
    out[0] = f.n;
    if (f.n == 0.0) return rp_fail(RP_NO_RESULT, "no avalanche in %zu samples", s->n);
    if (f.n == 1.0) rp_fail(RP_NO_RESULT, "one avalanche: at least 2 needed for an error");
    for (int k = 0; k < 2; k++) { /* mean and its standard error */
        const double about_mean = fmax(f.squares[k] - f.sums[k] * f.sums[k] / f.n, 0.0);
        out[1 + 2 * k] = f.sums[k] / f.n;
        out[2 + 2 * k] = f.n > 1.0 ? sqrt(about_mean / (f.n - 1.0) / f.n) : NAN;
    }
    return RP_OK;
}

/* The straight line through the samples. Errors are of independent passes, or of a series whose distances
 * from the line are correlated; one that is too short for that has none. */
static rp_status straight(const exp_samples *s, bool is_series, double v[], double x[], double out[])
{
    stats_line line;
    stats_series series = {.tau = 0.5};
    for (size_t i = 0; i < s->n; i++)
        if (!isfinite(x[i] = s->at[i].beside)) return rp_fail(RP_NO_RESULT, "against is %g", x[i]);
    RP_TRY(stats_line_fit(&(stats_xy){s->n, x, v, NULL}, false, &line));
    out[0] = line.intercept, out[1] = line.slope;
    for (size_t i = 0; i < s->n; i++) v[i] -= line.intercept + line.slope * x[i];
    if (is_series && stats_blocking(s->n, v, x, &series)) return RP_OK;
    const double factor = sqrt(fmax(2.0 * series.tau, 1.0));
    if (line.dof == 0) rp_fail(RP_NO_RESULT, "%zu samples: at least 3 needed for an error", s->n);
    if (line.dof > 0) out[2] = factor * line.intercept_se, out[3] = factor * line.slope_se;
    return RP_OK;
}

/* The outputs of a measure, in the order of its columns. */
static rp_status reduce(const exp_run *run, const exp_measure *m, double out[])
{
    RP_SCOPE(arena);
    const exp_samples *all = &run->samples[m - run->plan->measures];
    exp_samples s = {0};
    double *v, *work;
    stats_series series = {0};
    if (all->n == 0)
        return rp_fail(RP_NO_RESULT, "no samples of phase %s: one is taken every %ld steps%s",
                       run->plan->phases[m->phase].name, m->every, m->when.x.text ? " if `when` holds" : "");
    for (size_t i = 0; i < all->n; i++)
        if (!isfinite(all->at[i].value))
            return rp_fail(RP_NO_RESULT, "a sample is %g; `when` leaves samples out", all->at[i].value);
    RP_TRY(take_counting(run, m, &arena, &s));
    if (s.n == 0) return rp_fail(RP_NO_RESULT, "%zu samples, and skip = %g", all->n, m->skip);
    RP_NEW(&arena, v, s.n);
    RP_NEW(&arena, work, s.n);
    for (size_t i = 0; i < s.n; i++) v[i] = s.at[i].value;
    if (m->take == TAKE_LINE) return straight(&s, *m->during != '\0', v, work, out);
    if (m->take == TAKE_AVALANCHES) return avalanches(m, &s, out);
    if (m->take == TAKE_RATE) return rate(&s, &arena, out);
    out[0] = v[0];
    for (size_t i = 0; i < s.n; i++)
        if (m->take == TAKE_MAX ? v[i] > out[0] : m->take == TAKE_MIN && v[i] < out[0]) out[0] = v[i];
    if (m->take != TAKE_MEAN) return RP_OK;
    const rp_status blocked = stats_blocking(s.n, v, work, &series);
    if (isnan(series.mean)) return blocked; /* one without an error is one */
    out[0] = series.mean, out[1] = series.sd, out[2] = series.se;
    /* of few blocks widened, so that 2 se hold 95 % */
    const size_t blocks = series.block ? series.n / series.block : 0;
    if (blocks > 0 && blocks < FEW)
        out[2] *= gsl_cdf_tdist_Pinv(0.975, (double)blocks - 1.0) / gsl_cdf_ugaussian_Pinv(0.975);
    out[3] = isfinite(series.tau) ? (double)series.n / fmax(2.0 * series.tau, 1.0) : NAN;
    return RP_OK;
}

const char *exp_why_none(const exp_run *run, size_t output)
{
    const exp_plan *plan = run->plan;
    double out[EXP_MODULE_OUTPUTS];
    size_t k = plan->n_measures;
    rp_fail(RP_NO_RESULT, "it has no value");
    while (k-- > 0 && output < plan->measures[k].output) continue;
    const exp_measure *m = &plan->measures[k];
    if (!m->module && m->take != TAKE_VALUE) (void)reduce(run, m, out); /* which says why again */
    return rp_message();
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
        const rp_status status = reduce(run, m, all);
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
        exp_conclude(run, "no_number", "%s = \"%s\" is %g; %s", m->name, m->of.x.text, out[0],
                     names ? names : "");
    }
    out[0] = NAN;
}

void exp_measure_phase(exp_run *run, size_t phase)
{
    const exp_plan *plan = run->plan;
    const exp_phase *p = &plan->phases[phase];
    const bool passes = p->block != SIZE_MAX;
    run->measuring = true;
    /* a block has ended: first of its phases' samples, which its own measures may use */
    for (size_t i = phase + 1; i <= phase + p->n_inner; i++)
        for (size_t k = 0; k < plan->n_measures && !run->failed; k++)
            if (samples_in(&plan->measures[k], i)) measure(run, k);
    for (size_t k = 0; k < plan->n_measures && !run->failed; k++) {
        const exp_measure *m = &plan->measures[k];
        if (m->left_out || m->phase != phase) continue;
        if (m->take == TAKE_VALUE || !passes)
            measure(run, k);
        else if (!*m->during)
            add_sample(run, k);
    }
    run->measuring = false;
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
        m->module->write(m->params, run->plan->scene.def.units, s->taken, s->sums, out);
        return;
    }
    const char *const columns[][2] = {{"step", ""}, {"time", "s"}, {m->name, m->series_unit}};
    rp_table_columns(out, run->plan->scene.def.units, 3, columns);
    for (const exp_sampled *at = s->at; s->n && at < s->at + s->n; at++)
        rp_table_row(out, 3, (double[]){at->step, at->time, at->value});
}
