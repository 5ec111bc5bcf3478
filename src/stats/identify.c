/* Designs, fits and their inverse; see identify.h. */
#include "stats/identify.h"

#include <gsl/gsl_cdf.h>
#include <gsl/gsl_eigen.h>
#include <gsl/gsl_linalg.h>
#include <gsl/gsl_qrng.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "core/arena.h"
#include "stats/stats.h"

const char *const stats_identified_words[] = {
#define X(name, word, meaning) word,
    STATS_IDENTIFIED_LIST(X)};
#undef X
const char *const stats_identified_meanings[] = {
#define X(name, word, meaning) meaning,
    STATS_IDENTIFIED_LIST(X)
#undef X
};

/* One number in the box: coefficients and their covariance; variance of a point's mean about the form. */
typedef struct {
    double c[STATS_TERMS], covariance[STATS_TERMS * STATS_TERMS], tau2, p_value;
} form;

typedef struct {
    const stats_quest *q;
    double lo[STATS_NAMES], hi[STATS_NAMES]; /* the box */
    size_t n, room, n_terms;
    double *x;        /* of all points so far */
    stats_runs *runs; /* of number k at point i: [k + n_numbers i] */
    form form[STATS_NUMBERS];
    double value[STATS_NUMBERS], error[STATS_NUMBERS]; /* what is looked for */
    size_t skipped;                                    /* point that is left out, or SIZE_MAX */
    rp_arena arena;
} search;

static size_t terms_of(size_t n_names)
{
    return n_names == 1 ? 4 : (n_names + 1) * (n_names + 2) / 2;
}

static void terms_at(const search *s, const double x[], double t[STATS_TERMS])
{
    const size_t p = s->q->n_names;
    double u[STATS_NAMES];
    size_t n = 0;
    for (size_t i = 0; i < p; i++)
        u[i] = s->hi[i] > s->lo[i] ? (2.0 * x[i] - s->lo[i] - s->hi[i]) / (s->hi[i] - s->lo[i]) : 0.0;
    t[n++] = 1.0;
    for (size_t i = 0; i < p; i++) t[n++] = u[i];
    for (size_t i = 0; i < p; i++)
        for (size_t k = i; k < p; k++) t[n++] = u[i] * u[k];
    if (p == 1) t[n++] = u[0] * u[0] * u[0];
}

static bool in_box(const search *s, size_t i)
{
    const double *x = &s->x[i * s->q->n_names];
    bool in = i != s->skipped;
    for (size_t p = 0; p < s->q->n_names; p++) {
        const double slack = 1e-9 * (s->hi[p] - s->lo[p]);
        in = in && x[p] >= s->lo[p] - slack && x[p] <= s->hi[p] + slack;
    }
    return in;
}

/* Least squares over the points of the box that have the number. The variance of one run is that of runs at
 * equal points, pooled. */
static rp_status fit_number(search *s, size_t k)
{
    RP_SCOPE(arena);
    const size_t K = s->q->n_numbers, m = s->n_terms;
    double *X, *y, *w, squares = 0.0, dof = 0.0, weights = 0.0;
    size_t n = 0;
    form *f = &s->form[k];
    RP_NEW(&arena, X, s->n * m + 1);
    RP_NEW(&arena, y, s->n + 1);
    RP_NEW(&arena, w, s->n + 1);
    for (size_t i = 0; i < s->n; i++) {
        const stats_runs *r = &s->runs[k + K * i];
        if (!in_box(s, i) || !(r->n > 0.0)) continue;
        terms_at(s, &s->x[i * s->q->n_names], &X[n * m]);
        y[n] = r->mean, w[n] = r->n, n++;
        squares += r->squares, dof += r->n - 1.0;
    }
    if (n < m + 1)
        return rp_fail(RP_NO_RESULT, "number %zu: %zu points have it, at least %zu needed", k + 1, n, m + 1);
    const double one = dof > 0.0 ? squares / dof : 0.0;
    for (size_t i = 0; i < n && one > 0.0; i++) w[i] /= one;
    for (size_t i = 0; i < n; i++) weights += w[i];
    stats_linear fit = {
        .n = n, .p = m, .X = X, .y = y, .w = w, .tolerance = 1e-12, .c = f->c, .covariance = f->covariance};
    RP_TRY(stats_linear_fit(&fit));
    const double left = (double)(n - m), excess = fit.chi2 / left;
    f->p_value = one > 0.0 ? gsl_cdf_chisq_Q(fit.chi2, left) : 0.0;
    /* without scatter, or with a form that does not fit, the residuals tell the error */
    const bool grows = one == 0.0 || excess > 1.0;
    if (grows)
        for (size_t i = 0; i < m * m; i++) f->covariance[i] *= excess;
    f->tau2 = one == 0.0 ? excess * (double)n / weights : fmax(excess - 1.0, 0.0) * (double)n / weights;
    return RP_OK;
}

static double value_at(const search *s, size_t k, const double x[], double *variance)
{
    double t[STATS_TERMS], sum = 0.0, v = 0.0;
    const form *f = &s->form[k];
    terms_at(s, x, t);
    for (size_t i = 0; i < s->n_terms; i++) {
        sum += f->c[i] * t[i];
        for (size_t j = 0; j < s->n_terms && variance; j++)
            v += t[i] * f->covariance[i * s->n_terms + j] * t[j];
    }
    if (variance) *variance = fmax(v, 0.0) + f->tau2;
    return sum;
}

static double chi2_at(const double x[], void *data)
{
    const search *s = data;
    double sum = 0.0;
    if (s->q->allowed && !s->q->allowed(s->q->host, x)) return 1e6;
    for (size_t k = 0; k < s->q->n_numbers; k++) {
        double v;
        const double d = s->value[k] - value_at(s, k, x, &v), all = v + s->error[k] * s->error[k];
        if (all > 0.0) sum += d * d / all;
    }
    return sum;
}

/* Least chi2 in the box, or with one name held, from the best of a grid. */
static rp_status least(search *s, size_t held, double at, double x[], double *chi2)
{
    static const int cells[] = {1, 60, 16, 8}; /* by free names */
    const size_t p = s->q->n_names, n_free = p - (held < p);
    double lo[STATS_NAMES], hi[STATS_NAMES];
    memcpy(lo, s->lo, sizeof lo), memcpy(hi, s->hi, sizeof hi);
    if (held < p) lo[held] = hi[held] = at;
    return stats_least(chi2_at, s, p, lo, hi, cells[n_free], x, chi2);
}

/* Where the profile of a name passes the limit on one side of the best; the box's end where it does not. */
static rp_status pass(search *s, size_t p, const double best[], double se, int side, double limit, double *at)
{
    double y[STATS_NAMES], inside = best[p], chi2,
                           step = isfinite(se) && se > 0.0 ? se : 0.1 * (s->hi[p] - s->lo[p]);
    const double end = side < 0 ? s->lo[p] : s->hi[p];
    for (;; step *= 1.6) {
        double outside = side < 0 ? fmax(inside - step, end) : fmin(inside + step, end);
        RP_TRY(least(s, p, outside, y, &chi2));
        if (chi2 > limit) {
            while (fabs(outside - inside) > 1e-4 * (s->hi[p] - s->lo[p])) {
                const double middle = 0.5 * (inside + outside);
                RP_TRY(least(s, p, middle, y, &chi2));
                *(chi2 > limit ? &outside : &inside) = middle;
            }
            return *at = 0.5 * (inside + outside), RP_OK;
        }
        inside = outside;
        if (outside == end) return *at = end, RP_OK;
    }
}

/* Information on the names at x: sum of slopes times slopes over variances. */
static void information(const search *s, const double x[], double I[STATS_NAMES * STATS_NAMES])
{
    const size_t p = s->q->n_names;
    memset(I, 0, p * p * sizeof *I);
    for (size_t k = 0; k < s->q->n_numbers; k++) {
        double g[STATS_NAMES], v;
        value_at(s, k, x, &v);
        v += s->error[k] * s->error[k];
        for (size_t i = 0; i < p; i++) {
            double up[STATS_NAMES], down[STATS_NAMES];
            const double h = 1e-4 * (s->hi[i] - s->lo[i]);
            memcpy(up, x, sizeof up), memcpy(down, x, sizeof down);
            up[i] = fmin(x[i] + h, s->hi[i]), down[i] = fmax(x[i] - h, s->lo[i]);
            g[i] = (value_at(s, k, up, NULL) - value_at(s, k, down, NULL)) / (up[i] - down[i]);
        }
        for (size_t i = 0; i < p; i++)
            for (size_t j = 0; j < p && v > 0.0; j++) I[i * p + j] += g[i] * g[j] / v;
    }
}

/* Standard errors and correlations of the names, and the combination that is determined best: names in units
 * of their ranges along the axis of most information. */
static void take_errors(const search *s, stats_answer *a)
{
    const size_t p = s->q->n_names;
    double I[STATS_NAMES * STATS_NAMES], scaled[STATS_NAMES * STATS_NAMES],
        inverse[STATS_NAMES][STATS_NAMES] = {{0}}, axis[STATS_NAMES * STATS_NAMES], power[STATS_NAMES] = {0},
        range[STATS_NAMES] = {1.0, 1.0, 1.0};
    information(s, a->x, I);
    for (size_t i = 0; i < p; i++) range[i] = s->q->hi[i] - s->q->lo[i];
    for (size_t i = 0; i < p; i++)
        for (size_t j = 0; j < p; j++) scaled[i * p + j] = I[i * p + j] * range[i] * range[j];
    gsl_matrix_view m = gsl_matrix_view_array(scaled, p, p), v = gsl_matrix_view_array(axis, p, p);
    gsl_vector_view e = gsl_vector_view_array(power, p);
    gsl_eigen_symmv_workspace *w = gsl_eigen_symmv_alloc(p);
    if (!w) return;
    gsl_eigen_symmv(&m.matrix, &e.vector, &v.matrix, w);
    gsl_eigen_symmv_free(w);
    size_t most = 0;
    for (size_t k = 0; k < p; k++) {
        most = power[k] > power[most] ? k : most;
        for (size_t i = 0; i < p; i++)
            for (size_t j = 0; j < p; j++)
                inverse[i][j] +=
                    axis[i * p + k] * axis[j * p + k] * range[i] * range[j] / fmax(power[k], 1e-12);
    }
    for (size_t i = 0; i < p; i++) {
        a->se[i] = sqrt(inverse[i][i]);
        for (size_t j = 0; j < p; j++)
            a->correlation[i][j] = inverse[i][j] / sqrt(inverse[i][i] * inverse[j][j]);
    }
    double largest = 0.0;
    for (size_t i = 0; i < p; i++)
        if (fabs(axis[i * p + most]) > fabs(largest)) largest = axis[i * p + most];
    size_t first = 0;
    while (first + 1 < p && fabs(axis[first * p + most]) < 0.05 * fabs(largest)) first++;
    const double unit = axis[first * p + most] / range[first];
    a->sum = 0.0;
    for (size_t i = 0; i < p; i++) {
        a->weight[i] = axis[i * p + most] / range[i] / unit;
        if (fabs(axis[i * p + most]) < 0.05 * fabs(largest)) a->weight[i] = 0.0;
        a->sum += a->weight[i] * a->x[i];
    }
    a->sum_error = 1.0 / sqrt(fmax(power[most], 1e-300)) / fabs(unit);
}

static rp_status fit_all(search *s)
{
    for (size_t k = 0; k < s->q->n_numbers; k++) RP_TRY(fit_number(s, k));
    return RP_OK;
}

/* The best parameters, and their intervals in the box. */
static rp_status invert(search *s, bool intervals, stats_answer *a)
{
    const double limit = gsl_cdf_chisq_Pinv(0.95, 1.0);
    RP_TRY(least(s, SIZE_MAX, 0.0, a->x, &a->chi2));
    take_errors(s, a);
    for (size_t p = 0; p < s->q->n_names && intervals; p++) {
        RP_TRY(pass(s, p, a->x, a->se[p], -1, a->chi2 + limit, &a->lower[p]));
        RP_TRY(pass(s, p, a->x, a->se[p], 1, a->chi2 + limit, &a->upper[p]));
    }
    return RP_OK;
}

/* ---- stages ---- */

static rp_status add_points(search *s, size_t n, const double x[], const stats_runs runs[])
{
    const size_t p = s->q->n_names, K = s->q->n_numbers;
    if (s->n + n > s->room) {
        double *old_x = s->x;
        stats_runs *old = s->runs;
        s->room = 2 * (s->n + n);
        RP_NEW(&s->arena, s->x, s->room * p);
        RP_NEW(&s->arena, s->runs, s->room * K);
        if (s->n)
            memcpy(s->x, old_x, s->n * p * sizeof *s->x), memcpy(s->runs, old, s->n * K * sizeof *s->runs);
    }
    memcpy(&s->x[s->n * p], x, n * p * sizeof *x);
    for (size_t i = 0; i < n; i++)
        for (size_t k = 0; k < K; k++) s->runs[k + K * (s->n + i)] = runs[k * n + i];
    s->n += n;
    return RP_OK;
}

/* The next points of the sequence in the box. */
static rp_status draw(const search *s, gsl_qrng *sobol, size_t n, double x[])
{
    const size_t p = s->q->n_names;
    for (size_t i = 0, tries = 0; i < n; tries++) {
        double u[STATS_NAMES], *at = &x[i * p];
        if (tries > 10000 + 100 * n)
            return rp_fail(RP_BAD_INPUT, "where: hardly a point of the ranges is allowed");
        gsl_qrng_get(sobol, u);
        for (size_t k = 0; k < p; k++) at[k] = s->lo[k] + (s->hi[k] - s->lo[k]) * u[k];
        i += !s->q->allowed || s->q->allowed(s->q->host, at);
    }
    return RP_OK;
}

/* The box that holds what agrees: chi2 within its 99.9 % quantile of the least, widened by a fifth. True: it
 * is smaller by more than a fifth. */
static rp_status shrink(search *s, const stats_answer *a, bool *smaller)
{
    const size_t p = s->q->n_names;
    const double limit = a->chi2 + gsl_cdf_chisq_Pinv(0.999, (double)p);
    double lo[STATS_NAMES], hi[STATS_NAMES], ratio = 1.0;
    for (size_t i = 0; i < p; i++) {
        RP_TRY(pass(s, i, a->x, 2.0 * a->se[i], -1, limit, &lo[i]));
        RP_TRY(pass(s, i, a->x, 2.0 * a->se[i], 1, limit, &hi[i]));
        /* not below what a form can be fitted over */
        const double wide = fmax(1.2 * (hi[i] - lo[i]), 0.02 * (s->q->hi[i] - s->q->lo[i])),
                     middle = 0.5 * (lo[i] + hi[i]);
        lo[i] = fmax(middle - 0.5 * wide, s->q->lo[i]), hi[i] = fmin(middle + 0.5 * wide, s->q->hi[i]);
        ratio *= (hi[i] - lo[i]) / (s->hi[i] - s->lo[i]);
    }
    *smaller = ratio < 0.8;
    if (*smaller) memcpy(s->lo, lo, sizeof lo), memcpy(s->hi, hi, sizeof hi);
    return RP_OK;
}

/* Do the forms fit, and are their errors below half the measured ones? Groups whose are not get twice the
 * replicas. */
static bool settled(const search *s, const stats_answer *a, size_t replicas[])
{
    bool good = true, doubled[STATS_NUMBERS] = {false};
    for (size_t k = 0; k < s->q->n_numbers; k++) {
        const bool small = a->fit_error[k] <= 0.5 * s->error[k];
        good = good && small && a->p_value[k] > 0.05;
        if (!small && !doubled[s->q->group[k]] && replicas[s->q->group[k]] < 64)
            replicas[s->q->group[k]] *= 2, doubled[s->q->group[k]] = true;
    }
    return good;
}

static void note_fits(const search *s, stats_answer *a)
{
    for (size_t k = 0; k < s->q->n_numbers; k++) {
        double v;
        a->fitted[k] = value_at(s, k, a->x, &v);
        a->fit_error[k] = sqrt(v);
        a->p_value[k] = s->form[k].p_value;
    }
}

static size_t count_failed(const search *s)
{
    size_t n = 0;
    for (size_t i = 0; i < s->n; i++) {
        bool whole = true;
        for (size_t k = 0; k < s->q->n_numbers; k++)
            whole = whole && s->runs[k + s->q->n_numbers * i].n > 0.0;
        n += !whole;
    }
    return n;
}

/* Leave each point of the box out once, and look for it by its own numbers. */
static rp_status recover(search *s, stats_answer *a)
{
    const size_t K = s->q->n_numbers, p = s->q->n_names;
    for (size_t i = 0; i < s->n; i++) {
        stats_answer one = {0};
        bool whole = in_box(s, i), found = true;
        for (size_t k = 0; k < K; k++) {
            const stats_runs *r = &s->runs[k + K * i];
            whole = whole && r->n > 1.0;
            s->value[k] = r->mean;
            s->error[k] = whole ? sqrt(r->squares / (r->n - 1.0) / r->n) : 0.0;
        }
        if (!whole) continue;
        s->skipped = i;
        if (fit_all(s)) continue; /* too few are left */
        RP_TRY(invert(s, true, &one));
        for (size_t k = 0; k < p; k++)
            found = found && s->x[i * p + k] >= one.lower[k] && s->x[i * p + k] <= one.upper[k];
        a->tried++, a->recovered += found;
    }
    s->skipped = SIZE_MAX;
    memcpy(s->value, s->q->value, sizeof s->value), memcpy(s->error, s->q->error, sizeof s->error);
    return fit_all(s);
}

static void judge(const search *s, bool converged, stats_answer *a)
{
    const stats_quest *q = s->q;
    a->dof = q->n_numbers > q->n_names ? q->n_numbers - q->n_names : 0;
    const bool match = a->chi2 <= gsl_cdf_chisq_Pinv(0.99, a->dof ? (double)a->dof : 1.0);
    for (size_t p = 0; p < q->n_names; p++) {
        const double range = q->hi[p] - q->lo[p], slack = 1e-3 * range;
        const bool low = a->lower[p] <= q->lo[p] + slack, high = a->upper[p] >= q->hi[p] - slack;
        a->status[p] = !match                                     ? STATS_IDENTIFIED_NO_MATCH
                       : a->upper[p] - a->lower[p] >= 0.9 * range ? STATS_IDENTIFIED_NOT_IDENTIFIED
                       : low                                      ? STATS_IDENTIFIED_AT_MOST
                       : high                                     ? STATS_IDENTIFIED_AT_LEAST
                       : converged                                ? STATS_IDENTIFIED_OK
                                                                  : STATS_IDENTIFIED_BUDGET;
        if (a->se[p] > 10.0 * range) a->se[p] = NAN; /* no number tells */
        if (!match) a->x[p] = a->se[p] = a->lower[p] = a->upper[p] = NAN;
        if (low && match) a->lower[p] = q->lo[p];
        if (high && match) a->upper[p] = q->hi[p];
    }
    memcpy(a->box_lo, s->lo, sizeof s->lo), memcpy(a->box_hi, s->hi, sizeof s->hi);
}

static rp_status go(search *s, gsl_qrng *sobol, stats_answer *a)
{
    const stats_quest *q = s->q;
    size_t replicas[STATS_NUMBERS], n = 8 * q->n_names + 4;
    bool smaller = true, good = false, paid = true;
    double *x, last_lo[STATS_NAMES], last_hi[STATS_NAMES];
    for (size_t g = 0; g < STATS_NUMBERS; g++) replicas[g] = 2;
    for (;;) {
        size_t cost = 0;
        const double *points;
        stats_runs *runs = NULL;
        for (size_t g = 0; g < q->n_groups; g++) cost += n * replicas[g];
        paid = q->fixed_runs || a->n_runs + cost <= q->budget;
        if (!paid && a->stages == 0)
            return rp_fail(RP_BAD_INPUT, "budget = %zu: the first stage needs %zu runs", q->budget, cost);
        if (!paid) break;
        if (!q->fixed_runs) {
            RP_NEW(&s->arena, x, n * q->n_names);
            RP_TRY(draw(s, sobol, n, x));
            points = x;
        }
        RP_TRY(q->run(q->host, a->stages, &n, &points, replicas, &runs));
        RP_TRY(add_points(s, n, points, runs));
        a->stages++, a->n_runs += cost;
        RP_TRY(fit_all(s));
        RP_TRY(invert(s, false, a));
        note_fits(s, a);
        good = settled(s, a, replicas);
        if (q->fixed_runs) break;
        memcpy(last_lo, s->lo, sizeof last_lo), memcpy(last_hi, s->hi, sizeof last_hi);
        RP_TRY(shrink(s, a, &smaller));
        if (!smaller && good) break;
    }
    if (!paid) memcpy(s->lo, last_lo, sizeof last_lo), memcpy(s->hi, last_hi, sizeof last_hi);
    RP_TRY(fit_all(s));
    RP_TRY(invert(s, true, a));
    note_fits(s, a);
    a->n_points = s->n, a->n_failed = count_failed(s);
    judge(s, q->fixed_runs || (!smaller && good), a);
    return q->leave_out ? recover(s, a) : RP_OK;
}

rp_status stats_identify(const stats_quest *q, stats_answer *a)
{
    *a = (stats_answer){0};
    search s = {.q = q, .skipped = SIZE_MAX, .n_terms = terms_of(q->n_names)};
    for (size_t p = 0; p < q->n_names; p++)
        if (!(q->hi[p] > q->lo[p]) || !isfinite(q->lo[p]) || !isfinite(q->hi[p]))
            return rp_fail(RP_BAD_INPUT, "range of name %zu: [%g, %g]", p + 1, q->lo[p], q->hi[p]);
    memcpy(s.lo, q->lo, sizeof s.lo), memcpy(s.hi, q->hi, sizeof s.hi);
    memcpy(s.value, q->value, sizeof s.value), memcpy(s.error, q->error, sizeof s.error);
    gsl_qrng *sobol = gsl_qrng_alloc(gsl_qrng_sobol, (unsigned)q->n_names);
    rp_status status = sobol ? go(&s, sobol, a) : rp_fail(RP_NO_MEMORY, "calibrate: out of memory");
    if (sobol) gsl_qrng_free(sobol);
    rp_arena_end(&s.arena);
    return status;
}
