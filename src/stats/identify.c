/* Designs, fits and their inverse; see identify.h. */
#include "stats/identify.h"

#include <gsl/gsl_cdf.h>
#include <gsl/gsl_math.h>
#include <gsl/gsl_qrng.h>
#include <gsl/gsl_sort.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "core/arena.h"
#include "core/elementary.h"
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
    size_t n_terms;
    double c[STATS_TERMS], covariance[STATS_TERMS * STATS_TERMS], tau2, p_value, one; /* the last: of a run */
} form;

/* Values of a name at which its profile is looked at: over the box, and by its error about the best. */
enum { NODES = 64, NEAR = 3, ALL_NODES = NODES + 1 + 2 * NEAR + 1 };

typedef struct {
    stats_quest *q;                          /* a copy, whose range may lose its ends */
    double lo[STATS_NAMES], hi[STATS_NAMES]; /* the box */
    size_t n, room;
    double *x;        /* of all points so far */
    stats_runs *runs; /* of number k at point i: [k + n_numbers i] */
    form form[STATS_NUMBERS];
    double value[STATS_NUMBERS], error[STATS_NUMBERS]; /* what is looked for */
    double widest[STATS_NUMBERS];                      /* error of the form, where something agrees */
    size_t
        n_agreeing; /* places of the profiles that agree: the name that is held there, chi2 below the limit */
    struct {
        size_t held;
        double x[STATS_NAMES], below;
    } agreeing[STATS_NAMES * ALL_NODES];
    size_t skipped; /* point that is left out, or SIZE_MAX */
    rp_arena arena;
} search;

static const double FEW = 12.0;      /* degrees of freedom that a first stage has at least */
static const double BENT = 2.0;      /* most error of a combination, over that of straight lines */
static const double REJECTED = 0.01; /* chance of a misfit below which the runs reject a form */

/* Degrees of a form, by the number of names: the usual one, and the highest, which many points allow. */
static const size_t usual[] = {0, 3, 2, 2}, highest[] = {0, 7, 6, 4};

static size_t terms_of(size_t n_names, size_t degree)
{
    size_t n = 1;
    for (size_t i = 1; i <= n_names; i++) n = n * (degree + i) / i;
    return n;
}

/* The first n_terms products of the names, those of a lower degree first. */
static void terms_at(const search *s, const double x[], size_t n_terms, double t[STATS_TERMS])
{
    const size_t p = s->q->n_names;
    double u[STATS_NAMES];
    size_t last[STATS_TERMS] = {0},
           n = 1; /* names in order: a product goes on with its last, or a later one */
    for (size_t i = 0; i < p; i++)
        u[i] = s->hi[i] > s->lo[i] ? (2.0 * x[i] - s->lo[i] - s->hi[i]) / (s->hi[i] - s->lo[i]) : 0.0;
    t[0] = 1.0;
    for (size_t i = 0; n < n_terms; i++)
        for (size_t k = last[i]; k < p && n < n_terms; k++) t[n] = t[i] * u[k], last[n++] = k;
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

/* Do the runs ask for more terms, `less` with chi2 instead of f with `least`? Up to the usual degree if chi2
 * falls by 2 for each, beyond if that is not by chance. dof: of runs at equal points; 0: the residuals tell.
 */
static bool asks_for(const form *less, double chi2, const form *f, double least, bool is_usual, double dof,
                     double left)
{
    const double more = (double)(less->n_terms - f->n_terms);
    if (f->n_terms == 0 || is_usual) return f->n_terms == 0 || dof == 0.0 || chi2 + 2.0 * more < least;
    return gsl_cdf_fdist_Q((least - chi2) / more / (dof > 0.0 ? 1.0 : chi2 / left), more,
                           dof > 0.0 ? dof : left) < REJECTED;
}

/* Least squares over the points of the box that have the number. The variance of one run is that of runs at
 * equal points, pooled; a misfit of a tenth of the measured error does not count. */
static rp_status fit_number(search *s, size_t k)
{
    RP_SCOPE(arena);
    const size_t K = s->q->n_numbers, P = s->q->n_names, all = terms_of(P, highest[P]);
    const double slack = 0.1 * s->q->error[k];
    double *T, *X, *y, *w, squares = 0.0, dof = 0.0, weights = 0.0, chi2 = INFINITY;
    size_t n = 0;
    form *f = &s->form[k];
    RP_NEW(&arena, T, s->n * all + 1);
    RP_NEW(&arena, X, s->n * all + 1);
    RP_NEW(&arena, y, s->n + 1);
    RP_NEW(&arena, w, s->n + 1);
    for (size_t i = 0; i < s->n; i++) {
        const stats_runs *r = &s->runs[k + K * i];
        if (!in_box(s, i) || !(r->n > 0.0)) continue;
        terms_at(s, &s->x[i * P], all, &T[n * all]);
        y[n] = r->mean, w[n] = r->n, n++;
        squares += r->squares, dof += r->n - 1.0;
    }
    const double one = dof > 0.0 ? squares / dof : 0.0;
    for (size_t i = 0; i < n && dof > 0.0; i++) w[i] = 1.0 / (one / w[i] + slack * slack);
    for (size_t i = 0; i < n; i++) weights += w[i];
    stats_linear fit = {.n = n, .X = X, .y = y, .w = w, .tolerance = 1e-12};
    f->n_terms = 0;
    for (size_t degree = P == 1 ? 1 : 2; degree <= highest[P]; degree++) {
        const bool is_usual = degree <= usual[P];
        form less = {.n_terms = terms_of(P, degree)};
        if (n < less.n_terms + (is_usual ? 1 : 4)) break;
        for (size_t i = 0; i < n * less.n_terms; i++)
            X[i] = T[i / less.n_terms * all + i % less.n_terms]; /* the first of each row */
        fit.p = less.n_terms, fit.c = less.c, fit.covariance = less.covariance;
        RP_TRY(stats_linear_fit(&fit));
        if (asks_for(&less, fit.chi2, f, chi2, is_usual, dof, (double)(n - less.n_terms)))
            *f = less, chi2 = fit.chi2;
    }
    if (f->n_terms == 0)
        return rp_fail(RP_NO_RESULT, "number %zu: %zu points have it, at least %zu needed", k + 1, n,
                       terms_of(P, P == 1 ? 1 : 2) + 1);
    const double left = (double)(n - f->n_terms), excess = chi2 / left;
    f->one = one;
    f->p_value = dof > 0.0 ? gsl_cdf_fdist_Q(excess, left, dof) : NAN;
    /* without repeats, or with a form that does not fit, the residuals tell the error; what few degrees of
     * freedom tell is widened to Student's interval */
    const double known = dof > 0.0 ? dof : left,
                 student =
                     known < FEW ? gsl_cdf_tdist_Pinv(0.975, known) / gsl_cdf_ugaussian_Pinv(0.975) : 1.0,
                 few = rint(1e9 * student * student) / 1e9, /* of which every build of GSL has the same */
        grows = few * (dof > 0.0 ? fmax(excess, 1.0) : excess);
    for (size_t i = 0; i < f->n_terms * f->n_terms; i++) f->covariance[i] *= grows;
    f->tau2 = few * (dof > 0.0 ? fmax(excess - 1.0, 0.0) : excess) * (double)n / weights;
    if (f->p_value < REJECTED) f->tau2 *= 4.0; /* a misfit has a place, where it is larger than elsewhere */
    return RP_OK;
}

/* Do the runs reject a form? */
static bool is_bent(const search *s)
{
    bool bent = false;
    for (size_t k = 0; k < s->q->n_numbers; k++) bent = bent || s->form[k].p_value < REJECTED;
    return bent;
}

static double value_at(const search *s, size_t k, const double x[], double *variance)
{
    double t[STATS_TERMS], sum = 0.0, v = 0.0;
    const form *f = &s->form[k];
    terms_at(s, x, f->n_terms, t);
    for (size_t i = 0; i < f->n_terms; i++) {
        sum += f->c[i] * t[i];
        for (size_t j = 0; j < f->n_terms && variance; j++)
            v += t[i] * f->covariance[i * f->n_terms + j] * t[j];
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

/* Least chi2 in the box, or with one name held: then the best of all is a guess. */
static rp_status least(search *s, size_t held, double at, const double guess[], double x[], double *chi2)
{
    static const int cells[] = {1, 60, 16, 8}; /* by free names */
    const size_t p = s->q->n_names, n_free = p - (held < p);
    double lo[STATS_NAMES], hi[STATS_NAMES];
    memcpy(lo, s->lo, sizeof lo), memcpy(hi, s->hi, sizeof hi);
    if (held < p) lo[held] = hi[held] = at;
    return stats_least(&(stats_minimum){chi2_at, s, p, lo, hi, cells[n_free], guess}, x, chi2);
}

static size_t place_nodes(const search *s, size_t p, double best, double se, double at[ALL_NODES])
{
    static const double near[NEAR] = {1.0, 2.0, 4.0};
    const int cells = s->q->n_names == 1 ? NODES : 8;
    size_t n = 0;
    for (int k = 0; k <= cells; k++) at[n++] = s->lo[p] + (s->hi[p] - s->lo[p]) * k / cells;
    for (int k = 0; k < 2 * NEAR && isfinite(se); k++) {
        const double x = best + (k % 2 ? -1.0 : 1.0) * near[k / 2] * se;
        if (x > s->lo[p] && x < s->hi[p]) at[n++] = x;
    }
    at[n++] = best;
    gsl_sort(at, 1, n);
    return n;
}

/* Where the profile passes the limit between a value inside and one outside. */
static rp_status pass(search *s, size_t p, const double best[], double inside, double outside, double limit,
                      double *at)
{
    double y[STATS_NAMES], chi2;
    while (fabs(outside - inside) > 1e-4 * (s->hi[p] - s->lo[p])) {
        const double middle = 0.5 * (inside + outside);
        RP_TRY(least(s, p, middle, best, y, &chi2));
        *(chi2 > limit ? &outside : &inside) = middle;
    }
    return *at = 0.5 * (inside + outside), RP_OK;
}

/* The intervals of a name in which its profile does not exceed the limit. */
static rp_status intervals_of(search *s, size_t p, const stats_answer *a, double limit,
                              stats_interval out[STATS_INTERVALS], size_t *n)
{
    double at[ALL_NODES], chi2[ALL_NODES], lowest = INFINITY;
    const size_t nodes = place_nodes(s, p, a->x[p], a->se[p], at);
    *n = 0;
    for (size_t k = 0; k < nodes; k++) {
        double y[STATS_NAMES];
        memcpy(y, a->x, sizeof y), chi2[k] = a->chi2;
        if (at[k] != a->x[p]) RP_TRY(least(s, p, at[k], a->x, y, &chi2[k]));
        const bool in = chi2[k] <= limit, was = k > 0 && chi2[k - 1] <= limit;
        if (in && s->n_agreeing < STATS_NAMES * ALL_NODES) {
            s->agreeing[s->n_agreeing].held = p, s->agreeing[s->n_agreeing].below = limit - chi2[k];
            memcpy(s->agreeing[s->n_agreeing++].x, y, sizeof y);
        }
        if (in && !was) { /* the last takes what is beyond */
            if (*n < STATS_INTERVALS) out[(*n)++].lower = at[k], lowest = INFINITY;
            if (k > 0 && out[*n - 1].lower == at[k])
                RP_TRY(pass(s, p, a->x, at[k], at[k - 1], limit, &out[*n - 1].lower));
        }
        if (!in && was) RP_TRY(pass(s, p, a->x, at[k - 1], at[k], limit, &out[*n - 1].upper));
        if (in && k + 1 == nodes) out[*n - 1].upper = at[k];
        if (in && chi2[k] < lowest) lowest = chi2[k], out[*n - 1].value = at[k];
    }
    return RP_OK;
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

/* Rows and columns of the symmetric M[p p] turn until it is diagonal, by Jacobi's rotations; V: its axes, as
 * columns. */
static void diagonalize(size_t p, double M[], double V[])
{
    enum { SWEEPS = 30 };
    for (size_t i = 0; i < p * p; i++) V[i] = i % (p + 1) == 0;
    for (size_t n = 0; n < SWEEPS * p * p; n++) {
        const size_t i = n / p % p, j = n % p;
        if (i >= j || M[i * p + j] == 0.0) continue;
        const double half = (M[j * p + j] - M[i * p + i]) / (2.0 * M[i * p + j]),
                     t = copysign(1.0 / (fabs(half) + rp_hypot(1.0, half)), half), c = 1.0 / rp_hypot(1.0, t);
        for (size_t k = 0; k < 3 * p; k++) { /* columns of M, rows of M, columns of V */
            double *of = k < 2 * p ? M : V, *a = &of[k / p == 1 ? i * p + k % p : k % p * p + i],
                   *b = &of[k / p == 1 ? j * p + k % p : k % p * p + j];
            const double was = *a;
            *a = c * (was - t * *b), *b = c * (t * was + *b);
        }
        M[i * p + j] = M[j * p + i] = 0.0;
    }
}

/* Standard errors and correlations of the names. */
static void take_errors(const search *s, stats_answer *a)
{
    const size_t p = s->q->n_names;
    double scaled[STATS_NAMES * STATS_NAMES], inverse[STATS_NAMES][STATS_NAMES] = {{0}},
                                              axis[STATS_NAMES * STATS_NAMES], range[STATS_NAMES];
    information(s, a->x, scaled);
    for (size_t i = 0; i < p; i++) range[i] = s->q->hi[i] - s->q->lo[i];
    for (size_t i = 0; i < p; i++)
        for (size_t j = 0; j < p; j++) scaled[i * p + j] *= range[i] * range[j];
    diagonalize(p, scaled, axis);
    for (size_t k = 0; k < p; k++)
        for (size_t i = 0; i < p; i++)
            for (size_t j = 0; j < p; j++)
                inverse[i][j] +=
                    axis[i * p + k] * axis[j * p + k] * range[i] * range[j] / fmax(scaled[k * p + k], 1e-12);
    for (size_t i = 0; i < p; i++) {
        a->se[i] = sqrt(inverse[i][i]);
        for (size_t j = 0; j < p; j++)
            a->correlation[i][j] = inverse[i][j] / sqrt(inverse[i][i] * inverse[j][j]);
    }
}

/* Variance of the combination at x with one name held. */
static double variance_with(const search *s, const stats_answer *a, const double x[], size_t held)
{
    const size_t p = s->q->n_names, i = (held + 1) % p, j = (held + 2) % p;
    double I[STATS_NAMES * STATS_NAMES];
    information(s, x, I);
    const double *w = a->weight, ii = I[i * p + i], jj = I[j * p + j], ij = I[i * p + j];
    return p == 1   ? 0.0
           : p == 2 ? w[i] * w[i] / ii
                    : (w[i] * w[i] * jj - 2.0 * w[i] * w[j] * ij + w[j] * w[j] * ii) / (ii * jj - ij * ij);
}

/* Is a best value an end of its range? There no slope is 0: unless the combination is the same all along what
 * agrees, the range determines it, and not the numbers. */
static bool is_at_edge(const search *s, const stats_answer *a)
{
    bool edge = false;
    for (size_t p = 0; p < s->q->n_names; p++) {
        const double slack = 1e-3 * (s->q->hi[p] - s->q->lo[p]);
        edge = edge || a->x[p] <= s->q->lo[p] + slack || a->x[p] >= s->q->hi[p] - slack;
    }
    return edge;
}

/* The combination that is determined best: across the places that agree, the names in units of their ranges.
 * Its error reaches to the farthest of what agrees there, which slopes at the best place don't tell where
 * that bends. */
static void take_sum(const search *s, double limit, stats_answer *a)
{
    const size_t p = s->q->n_names;
    double scatter[STATS_NAMES * STATS_NAMES] = {0}, I[STATS_NAMES * STATS_NAMES],
                                 axis[STATS_NAMES * STATS_NAMES], range[STATS_NAMES], largest = 0.0,
                                 error = 0.0, farthest = 0.0, wIw = 0.0, ww = 0.0;
    size_t least = 0, first = 0;
    for (size_t i = 0; i < p; i++) range[i] = s->q->hi[i] - s->q->lo[i];
    for (size_t n = 0; n < s->n_agreeing; n++)
        for (size_t i = 0; i < p; i++)
            for (size_t j = 0; j < p; j++)
                scatter[i * p + j] +=
                    (s->agreeing[n].x[i] - a->x[i]) / range[i] * (s->agreeing[n].x[j] - a->x[j]) / range[j];
    diagonalize(p, scatter, axis);
    for (size_t k = 0; k < p; k++) least = scatter[k * p + k] < scatter[least * p + least] ? k : least;
    for (size_t i = 0; i < p; i++) largest = fmax(largest, fabs(axis[i * p + least]));
    while (first + 1 < p && fabs(axis[first * p + least]) < 0.05 * largest) first++;
    const double unit = axis[first * p + least] / range[first];
    a->sum = 0.0;
    for (size_t i = 0; i < p; i++) {
        const double exact = axis[i * p + least] / range[i] / unit,
                     digit = rp_pow(10.0, floor(rp_log(fabs(exact)) / M_LN10) - 3.0); /* as printed */
        a->weight[i] = fabs(axis[i * p + least]) < 0.05 * largest ? 0.0 : digit * round(exact / digit);
        a->sum += a->weight[i] * a->x[i];
    }
    for (size_t n = 0; n < s->n_agreeing; n++) {
        double far = -a->sum;
        for (size_t i = 0; i < p; i++) far += a->weight[i] * s->agreeing[n].x[i];
        farthest = fmax(farthest, fabs(far));
        error = fmax(error, fabs(far) + sqrt(s->agreeing[n].below *
                                             variance_with(s, a, s->agreeing[n].x, s->agreeing[n].held)));
    }
    information(s, a->x, I);
    for (size_t i = 0; i < p * p; i++)
        wIw += a->weight[i / p] * a->weight[i % p] * I[i] * gsl_pow_2(range[i / p] * range[i % p]);
    for (size_t i = 0; i < p; i++) ww += gsl_pow_2(a->weight[i] * range[i]);
    a->sum_error = error / sqrt(limit);
    a->determined = a->sum_error < BENT * ww / sqrt(wIw) && (farthest < 0.5 * error || !is_at_edge(s, a));
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
    RP_TRY(least(s, SIZE_MAX, 0.0, NULL, a->x, &a->chi2));
    take_errors(s, a);
    double widest = 0.0;
    for (size_t p = s->n_agreeing = 0; p < s->q->n_names && intervals; p++) {
        stats_interval *const of = a->interval[p];
        const size_t first = s->n_agreeing;
        RP_TRY(intervals_of(s, p, a, a->chi2 + limit, of, &a->n_intervals[p]));
        const double *from = s->agreeing[first].x, *to = s->agreeing[s->n_agreeing - 1].x,
                     wide = (to[p] - from[p]) / (s->q->hi[p] - s->q->lo[p]);
        if (wide >= widest) {
            memcpy(a->ends[0], from, sizeof a->ends[0]), memcpy(a->ends[1], to, sizeof a->ends[1]);
            widest = wide;
        }
        for (size_t k = 0; k < a->n_intervals[p]; k++)
            if (of[k].lower <= a->x[p] && of[k].upper >= a->x[p]) a->own[p] = of[k];
    }
    if (intervals) take_sum(s, limit, a);
    return RP_OK;
}

/* ---- stages ---- */

static rp_status add_points(search *s, size_t n, const double x[], const stats_runs runs[])
{
    const size_t p = s->q->n_names, K = s->q->n_numbers;
    if (n == 0) return RP_OK;
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

/* The range ends where runs do that have the numbers: a form says nothing of what is beyond. A design without
 * failed points beyond has none by chance. */
static void cut_range(search *s)
{
    const size_t P = s->q->n_names, K = s->q->n_numbers;
    for (size_t p = 0; p < P; p++)
        for (size_t k = 0; k < K; k++) {
            double lo = INFINITY, hi = -INFINITY, least = s->q->fixed_runs ? -INFINITY : INFINITY,
                   most = -least;
            for (size_t i = 0; i < s->n; i++) {
                const double x = s->x[i * P + p];
                if (s->runs[k + K * i].n > 0.0)
                    lo = fmin(lo, x), hi = fmax(hi, x);
                else
                    least = fmin(least, x), most = fmax(most, x);
            }
            if (!(hi > lo)) continue; /* too few points: fit_number says so */
            if (least < lo) s->q->lo[p] = fmax(s->q->lo[p], fmin(lo, s->q->hi[p]));
            if (most > hi) s->q->hi[p] = fmin(s->q->hi[p], fmax(hi, s->q->lo[p]));
        }
    for (size_t p = 0; p < P; p++)
        s->lo[p] = fmax(s->lo[p], s->q->lo[p]), s->hi[p] = fmin(s->hi[p], s->q->hi[p]);
}

/* The next points of the sequence in the box. */
static rp_status draw(const search *s, gsl_qrng *sobol, size_t n, double x[])
{
    const size_t p = s->q->n_names;
    for (size_t i = 0, tries = 0; i < n; tries++) {
        double u[STATS_NAMES], *at = &x[i * p];
        if (tries > 10000 + 100 * n)
            return rp_fail(RP_BAD_INPUT, "where: allows hardly any point of the ranges");
        gsl_qrng_get(sobol, u);
        for (size_t k = 0; k < p; k++) at[k] = s->lo[k] + (s->hi[k] - s->lo[k]) * u[k];
        i += !s->q->allowed || s->q->allowed(s->q->host, at);
    }
    return RP_OK;
}

/* The box that holds what agrees: chi2 within the quantile 0.999 of the least, widened by a fifth. True: it
 * is smaller by more than a fifth. */
static rp_status shrink(search *s, const stats_answer *a, bool *smaller)
{
    const size_t p = s->q->n_names;
    const double limit = a->chi2 + gsl_cdf_chisq_Pinv(0.999, (double)p);
    double lo[STATS_NAMES], hi[STATS_NAMES], ratio = 1.0;
    for (size_t i = 0; i < p; i++) {
        stats_interval of[STATS_INTERVALS];
        size_t n;
        RP_TRY(intervals_of(s, i, a, limit, of, &n));
        lo[i] = of[0].lower, hi[i] = of[n - 1].upper;
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

static size_t points_in_box(const search *s)
{
    size_t n = 0;
    for (size_t i = 0; i < s->n; i++) n += in_box(s, i);
    return n;
}

/* A smaller box of the points that are there, while the runs reject a form. */
static rp_status narrow(search *s, stats_answer *a)
{
    const size_t P = s->q->n_names, enough = terms_of(P, usual[P]) + 6;
    for (bool smaller = true; smaller && is_bent(s);) {
        double lo[STATS_NAMES], hi[STATS_NAMES];
        memcpy(lo, s->lo, sizeof lo), memcpy(hi, s->hi, sizeof hi);
        RP_TRY(invert(s, false, a));
        RP_TRY(shrink(s, a, &smaller));
        if (smaller && (points_in_box(s) < enough || fit_all(s))) {
            memcpy(s->lo, lo, sizeof lo), memcpy(s->hi, hi, sizeof hi);
            return fit_all(s);
        }
    }
    return RP_OK;
}

/* Nothing comes near what was measured, by a form that may err by as much as it does. */
static bool is_hopeless(const search *s, const stats_answer *a)
{
    const size_t K = s->q->n_numbers, p = s->q->n_names;
    return a->chi2 > gsl_cdf_chisq_Pinv(1.0 - 1e-4, K > p ? (double)(K - p) : 1.0);
}

/* Is the error of a form, its lack of fit too, below half the measured one? */
static bool is_settled(const search *s, size_t k)
{
    return s->widest[k] <= 0.5 * s->error[k];
}

static bool settled(const search *s)
{
    bool all = true;
    for (size_t k = 0; k < s->q->n_numbers; k++) all = all && is_settled(s, k);
    return all;
}

/* The errors of the forms at the best places of other intervals of a name, too. */
static rp_status look_elsewhere(search *s, stats_answer *a)
{
    RP_TRY(invert(s, true, a));
    for (size_t p = 0; p < s->q->n_names; p++)
        for (size_t i = 0; i < a->n_intervals[p]; i++) {
            const stats_interval *of = &a->interval[p][i];
            double y[STATS_NAMES], chi2, v;
            if (of->lower <= a->x[p] && of->upper >= a->x[p]) continue;
            RP_TRY(least(s, p, of->value, a->x, y, &chi2));
            for (size_t k = 0; k < s->q->n_numbers; k++) {
                value_at(s, k, y, &v);
                s->widest[k] = fmax(s->widest[k], sqrt(v));
            }
        }
    return RP_OK;
}

/* Twice the replicas of the groups whose numbers are not. */
static void double_replicas(const search *s, size_t replicas[])
{
    bool doubled[STATS_NUMBERS] = {false};
    for (size_t k = 0; k < s->q->n_numbers; k++) {
        const size_t g = s->q->group[k];
        if (is_settled(s, k) || s->form[k].p_value < REJECTED || doubled[g] || replicas[g] >= 64) continue;
        replicas[g] *= 2, doubled[g] = true;
    }
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

/* What the points reach, and how many of them lack a number. */
static void note_points(const search *s, stats_answer *a)
{
    const size_t K = s->q->n_numbers;
    for (size_t k = 0; k < K; k++) a->reach[k][0] = INFINITY, a->reach[k][1] = -INFINITY;
    for (size_t i = 0; i < s->n; i++) {
        bool whole = true;
        double most = 0.0;
        for (size_t k = 0; k < K; k++) {
            const stats_runs *r = &s->runs[k + K * i];
            whole = whole && r->n > 0.0;
            most = fmax(most, r->n);
            if (!(r->n > 0.0)) continue;
            a->reach[k][0] = fmin(a->reach[k][0], r->mean), a->reach[k][1] = fmax(a->reach[k][1], r->mean);
        }
        a->n_failed += !whole, a->n_repeated += most > 1.0;
        if (s->q->fixed_runs) a->n_runs += (size_t)most;
    }
    a->n_points = s->n;
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
            s->error[k] = whole ? sqrt(s->form[k].one / r->n) : 0.0;
        }
        if (!whole) continue;
        s->skipped = i;
        if (fit_all(s)) continue; /* too few are left */
        RP_TRY(invert(s, true, &one));
        for (size_t k = 0; k < p; k++)
            found = found && s->x[i * p + k] >= one.own[k].lower && s->x[i * p + k] <= one.own[k].upper;
        a->tried++, a->recovered += found;
    }
    s->skipped = SIZE_MAX;
    memcpy(s->value, s->q->value, sizeof s->value), memcpy(s->error, s->q->error, sizeof s->error);
    return fit_all(s);
}

static stats_identified status_of(const stats_quest *q, const stats_answer *a, size_t p, bool converged)
{
    const double range = q->hi[p] - q->lo[p], slack = 1e-3 * range;
    const size_t n = a->n_intervals[p];
    const stats_interval *first = &a->interval[p][0], *last = &a->interval[p][n - 1];
    double width = 0.0;
    for (size_t k = 0; k < n; k++) width += a->interval[p][k].upper - a->interval[p][k].lower;
    return width >= 0.9 * range               ? STATS_IDENTIFIED_NOT_IDENTIFIED
           : n > 1                            ? STATS_IDENTIFIED_SEVERAL
           : first->lower <= q->lo[p] + slack ? STATS_IDENTIFIED_AT_MOST
           : last->upper >= q->hi[p] - slack  ? STATS_IDENTIFIED_AT_LEAST
           : converged                        ? STATS_IDENTIFIED_OK
                                              : STATS_IDENTIFIED_BUDGET;
}

/* Does the point nearest to the best lack a number, or half of those in the intervals? */
static bool lacks_runs(const search *s, const stats_answer *a)
{
    const size_t P = s->q->n_names, K = s->q->n_numbers;
    double nearest = INFINITY;
    size_t inside = 0, lacking = 0;
    bool lacks = false;
    for (size_t i = 0; i < s->n; i++) {
        double d = 0.0;
        bool whole = true, in = true;
        for (size_t p = 0; p < P; p++) {
            const double x = s->x[i * P + p];
            d += gsl_pow_2((x - a->x[p]) / (s->q->hi[p] - s->q->lo[p]));
            in = in && x >= a->own[p].lower && x <= a->own[p].upper;
        }
        for (size_t k = 0; k < K; k++) whole = whole && s->runs[k + K * i].n > 0.0;
        if (d < nearest || (d == nearest && whole)) nearest = d, lacks = !whole;
        inside += in, lacking += in && !whole;
    }
    return lacks || 2 * lacking > inside;
}

/* The status of each name; nothing stays that a rejected form tells, or one that agrees nowhere. */
static void judge(const search *s, bool converged, bool failed, stats_answer *a)
{
    const stats_quest *q = s->q;
    const bool lacks = failed || lacks_runs(s, a);
    a->dof = q->n_numbers > q->n_names ? q->n_numbers - q->n_names : 0;
    const bool match = a->chi2 <= gsl_cdf_chisq_Pinv(0.99, a->dof ? (double)a->dof : 1.0), bent = is_bent(s),
               beyond = q->n_numbers == 1 && !match &&
                        (q->value[0] < a->reach[0][0] || q->value[0] > a->reach[0][1]);
    const stats_identified none = q->n_numbers > 1             ? STATS_IDENTIFIED_NO_MATCH
                                  : q->value[0] > a->fitted[0] ? STATS_IDENTIFIED_ABOVE_RANGE
                                                               : STATS_IDENTIFIED_BELOW_RANGE;
    a->determined = a->determined && match && !bent && !lacks;
    for (size_t p = 0; p < q->n_names; p++) {
        a->lo[p] = q->lo[p], a->hi[p] = q->hi[p];
        a->status[p] = bent && !beyond ? STATS_IDENTIFIED_BENT : match ? status_of(q, a, p, converged) : none;
        const bool at_end =
            a->status[p] == STATS_IDENTIFIED_AT_LEAST || a->status[p] == STATS_IDENTIFIED_AT_MOST;
        if ((lacks && (a->status[p] == STATS_IDENTIFIED_OK || a->status[p] == STATS_IDENTIFIED_BUDGET)) ||
            (failed && at_end))
            a->status[p] = STATS_IDENTIFIED_NO_RUNS;
        if (a->se[p] > 10.0 * (q->hi[p] - q->lo[p])) a->se[p] = NAN; /* no number tells */
        if (match && !bent) continue;
        a->x[p] = a->se[p] = NAN, a->n_intervals[p] = 0;
        a->own[p] = (stats_interval){NAN, NAN, NAN};
    }
}

enum { FIRST_REPLICAS = 2 };

rp_status stats_first_stage(const stats_quest *q, size_t *points, size_t *runs)
{
    *points = 8 * q->n_names + 4;
    *runs = *points * FIRST_REPLICAS * q->n_groups;
    return q->fixed_runs || *runs <= q->budget
               ? RP_OK
               : rp_fail(RP_BAD_INPUT, "budget = %zu: the first stage needs %zu runs", q->budget, *runs);
}

static rp_status go(search *s, gsl_qrng *sobol, stats_answer *a)
{
    const stats_quest *q = s->q;
    size_t replicas[STATS_NUMBERS], n, first;
    bool smaller = true, good = false, paid = true, lacks = false;
    double *x, last_lo[STATS_NAMES], last_hi[STATS_NAMES];
    RP_TRY(stats_first_stage(q, &n, &first));
    for (size_t g = 0; g < STATS_NUMBERS; g++) replicas[g] = FIRST_REPLICAS;
    for (;;) {
        size_t cost = 0;
        const double *points;
        stats_runs *runs = NULL;
        for (size_t g = 0; g < q->n_groups; g++) cost += n * replicas[g];
        paid = q->fixed_runs || a->n_runs + cost <= q->budget;
        if (!paid) a->n_next = cost;
        if (!paid) break;
        if (!q->fixed_runs) {
            RP_NEW(&s->arena, x, n * q->n_names);
            RP_TRY(draw(s, sobol, n, x));
            points = x;
        }
        RP_TRY(q->run(q->host, a->stages, &n, &points, replicas, &runs));
        RP_TRY(add_points(s, n, points, runs));
        a->stages++, a->n_runs += q->fixed_runs ? 0 : cost;
        cut_range(s);
        const rp_status fitted = fit_all(s);
        lacks = fitted == RP_NO_RESULT && a->stages > 1; /* the runs of a smaller box failed */
        if (lacks) break;
        RP_TRY(fitted);
        RP_TRY(invert(s, q->tell != NULL, a));
        note_fits(s, a);
        memcpy(s->widest, a->fit_error, sizeof s->widest);
        if (q->tell) {
            stats_answer so_far = *a;
            note_points(s, &so_far);
            judge(s, false, false, &so_far);
            q->tell(q->host, &so_far);
        }
        if (q->fixed_runs || is_hopeless(s, a)) break;
        memcpy(last_lo, s->lo, sizeof last_lo), memcpy(last_hi, s->hi, sizeof last_hi);
        RP_TRY(shrink(s, a, &smaller));
        if (!smaller && settled(s)) RP_TRY(look_elsewhere(s, a));
        good = settled(s) && !is_bent(s);
        if (!smaller && good) break;
        if (!smaller && is_bent(s) && points_in_box(s) >= 2 * terms_of(q->n_names, highest[q->n_names]))
            break;
        if (!smaller) double_replicas(s, replicas);
    }
    if (!paid || lacks) memcpy(s->lo, last_lo, sizeof last_lo), memcpy(s->hi, last_hi, sizeof last_hi);
    cut_range(s);
    RP_TRY(fit_all(s));
    RP_TRY(narrow(s, a));
    RP_TRY(invert(s, true, a));
    note_fits(s, a);
    note_points(s, a);
    judge(s, q->fixed_runs || (!smaller && good), lacks, a);
    return q->leave_out && !is_bent(s) ? recover(s, a) : RP_OK;
}

rp_status stats_identify(const stats_quest *q, stats_answer *a)
{
    *a = (stats_answer){0};
    stats_quest own = *q;
    search s = {.q = &own, .skipped = SIZE_MAX};
    if (q->n_names < 1 || q->n_names > STATS_NAMES || q->n_numbers < 1 || q->n_numbers > STATS_NUMBERS)
        return rp_fail(RP_BAD_INPUT, "%zu names, %zu numbers: 1 to %d, and 1 to %d expected", q->n_names,
                       q->n_numbers, STATS_NAMES, STATS_NUMBERS);
    for (size_t k = 0; k < q->n_numbers; k++)
        if (!isfinite(q->value[k]) || !(q->error[k] > 0.0 && isfinite(q->error[k])))
            return rp_fail(RP_BAD_INPUT,
                           "number %zu: %g with the standard error %g: finite, and above 0 expected", k + 1,
                           q->value[k], q->error[k]);
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
