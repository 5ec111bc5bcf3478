/* Trends over a parameter, and tests that there is none; see stats.h. Every quantity is a contrast: a linear
 * combination of the means at the different x, with Student's t. */
#include <float.h>
#include <gsl/gsl_cdf.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/arena.h"
#include "core/elementary.h"
#include "stats/stats.h"

typedef struct {
    double x, y, pile;
} point;

/* The values at one x. */
typedef struct {
    double x, n, w, mean, variance; /* w: weight, variance: of the mean */
} cell;

typedef struct {
    const stats_sample *of;
    double x_unit, y_unit;  /* powers of two, of all that follows */
    size_t n, n_x, n_piles; /* n: values in use */
    point *points;          /* by x; paired: pile after pile, each by x */
    cell *cells;
    double *c, *work; /* coefficients of a contrast; [n] work space */
    double residual;  /* variance about the straight line, where an x has a single value; else NaN */
    double sw, x_mean, sxx, s3; /* sum of the weights, moments of x about its mean */
} sample;

static int by_x(const void *a, const void *b)
{
    const point *p = a, *q = b;
    return p->x != q->x ? (p->x > q->x) - (p->x < q->x) : (p->y > q->y) - (p->y < q->y);
}

static int by_pile(const void *a, const void *b)
{
    const point *p = a, *q = b;
    return p->pile != q->pile ? (p->pile > q->pile) - (p->pile < q->pile) : by_x(a, b);
}

static rp_status load_points(sample *s)
{
    const double *x = s->of->x, *y = s->of->y, *pile = s->of->pile;
    double most_x = 0.0, most_y = 0.0;
    for (size_t i = 0; i < s->n; i++) {
        const double number = pile ? pile[i] : 0.0;
        if (!isfinite(x[i]) || !isfinite(y[i]) || !isfinite(number))
            return rp_fail(RP_BAD_INPUT, "value %zu: (%g, %g) of pile %g: finite numbers expected", i + 1,
                           x[i], y[i], number);
        most_x = fmax(most_x, fabs(x[i])), most_y = fmax(most_y, fabs(y[i]));
    }
    s->x_unit = stats_unit(most_x), s->y_unit = stats_unit(most_y);
    for (size_t i = 0; i < s->n; i++)
        s->points[i] = (point){x[i] / s->x_unit, y[i] / s->y_unit, pile ? pile[i] : 0.0};
    qsort(s->points, s->n, sizeof *s->points, by_x);
    for (size_t i = 0; i < s->n; i++)
        if (i == 0 || s->points[i].x != s->points[i - 1].x) s->cells[s->n_x++].x = s->points[i].x;
    return RP_OK;
}

/* Keep the piles that have a value at every x. */
static rp_status keep_whole_piles(sample *s)
{
    size_t kept = 0;
    qsort(s->points, s->n, sizeof *s->points, by_pile);
    for (size_t first = 0, end; first < s->n; first = end) {
        for (end = first + 1; end < s->n && s->points[end].pile == s->points[first].pile; end++)
            if (s->points[end].x == s->points[end - 1].x)
                return rp_fail(RP_BAD_INPUT, "pile %g: two values at x = %g", s->points[end].pile,
                               s->points[end].x * s->x_unit);
        if (end - first != s->n_x) continue;
        memmove(s->points + kept, s->points + first, s->n_x * sizeof *s->points);
        kept += s->n_x;
    }
    s->n = kept;
    s->n_piles = kept / s->n_x;
    return RP_OK;
}

/* Means and their variances; unpaired points are in order of x. Of paired ones it has its weight alone. */
static rp_status fill_cells(sample *s)
{
    bool single = false;
    for (size_t j = 0; j < s->n_x && s->of->pile; j++) s->cells[j].n = (double)s->n_piles;
    for (size_t j = 0, first = 0; j < s->n_x && !s->of->pile; j++) {
        stats_summary stats;
        size_t n = 0;
        for (; first + n < s->n && s->points[first + n].x == s->cells[j].x; n++)
            s->work[n] = s->points[first + n].y;
        RP_TRY(stats_mean(n, s->work, &stats));
        s->cells[j] = (cell){s->cells[j].x, (double)n, NAN, stats.mean, stats.se * stats.se};
        single = single || n < 2;
        first += n;
    }
    s->residual = single ? INFINITY : NAN; /* its value needs the line */
    return RP_OK;
}

/* The contrast of the coefficients s->c of x number first to last, each `step` of them. Paired: mean over
 * piles. Otherwise the variances of the means add up, with the degrees of freedom of Welch and Satterthwaite.
 */
static stats_contrast contrast_of(const sample *s, size_t first, size_t last, size_t step)
{
    stats_contrast r = {0};
    if (s->of->pile) {
        stats_summary stats;
        for (size_t k = 0; k < s->n_piles; k++) {
            s->work[k] = 0.0;
            for (size_t j = first; j <= last; j += step) s->work[k] += s->c[j] * s->points[k * s->n_x + j].y;
        }
        if (stats_mean(s->n_piles, s->work, &stats)) stats.mean = stats.se = NAN; /* overflow */
        return (stats_contrast){stats.mean, stats.se, (double)s->n_piles - 1.0};
    }
    double variance = 0.0, squares = 0.0;
    for (size_t j = first; j <= last; j += step) {
        const cell *q = &s->cells[j];
        const double part = s->c[j] * s->c[j] * (isnan(s->residual) ? q->variance : s->residual / q->n);
        r.value += s->c[j] * q->mean;
        variance += part;
        squares += part * part / (q->n - 1.0);
    }
    r.se = sqrt(variance);
    r.dof = isnan(s->residual) ? variance * variance / squares : (double)s->n - 2.0;
    return r;
}

/* Of values without any scatter, what is round-off alone (|x| and |y| are below 2 in their units) is 0. */
static stats_contrast contrast(const sample *s)
{
    stats_contrast r = contrast_of(s, 0, s->n_x - 1, 1);
    double most = 0.0;
    for (size_t j = 0; j < s->n_x; j++) most += fabs(s->c[j]);
    most *= 1e-11 / (s->cells[s->n_x - 1].x - s->cells[0].x);
    if (r.se == 0.0 && fabs(r.value) <= most) r.value = 0.0;
    return r;
}

static void set_moments(sample *s)
{
    const double power = s->of->power;
    s->sw = s->x_mean = s->sxx = s->s3 = 0.0;
    for (size_t j = 0; j < s->n_x; j++) {
        cell *q = &s->cells[j];
        const double w = power == 0.0     ? 1.0
                         : s->of->log10_x ? rp_pow(10.0, power * (q->x * s->x_unit))
                                          : rp_pow(q->x * s->x_unit, power);
        s->sw += q->w = q->n * w;
    }
    for (size_t j = 0; j < s->n_x; j++) s->x_mean += s->cells[j].w * s->cells[j].x / s->sw;
    for (size_t j = 0; j < s->n_x; j++) {
        const double dx = s->cells[j].x - s->x_mean;
        s->sxx += s->cells[j].w * dx * dx;
        s->s3 += s->cells[j].w * dx * dx * dx;
    }
}

/* The coefficients of least squares: of a constant and of polynomials that are orthogonal to it. */
static stats_contrast coefficient(sample *s, int degree)
{
    double norm = 0.0;
    for (size_t j = 0; j < s->n_x; j++) {
        const double dx = s->cells[j].x - s->x_mean;
        const double p[] = {1.0, dx, dx * dx - s->s3 / s->sxx * dx - s->sxx / s->sw};
        s->c[j] = s->cells[j].w * p[degree];
        norm += s->cells[j].w * p[degree] * p[degree];
    }
    for (size_t j = 0; j < s->n_x; j++) s->c[j] /= norm;
    return contrast(s);
}

static stats_contrast intercept(sample *s)
{
    for (size_t j = 0; j < s->n_x; j++)
        s->c[j] = s->cells[j].w * (1.0 / s->sw - s->x_mean * (s->cells[j].x - s->x_mean) / s->sxx);
    return contrast(s);
}

/* Variance of all points about the straight line. */
static void set_residual(sample *s)
{
    const double slope = coefficient(s, 1).value, mean = coefficient(s, 0).value;
    double squares = 0.0;
    for (size_t i = 0; i < s->n; i++) {
        const double rest = s->points[i].y - mean - slope * (s->points[i].x - s->x_mean);
        squares += rest * rest;
    }
    s->residual = squares / ((double)s->n - 2.0);
}

/* Chance of Student's t above value/se. Values without any spread are certain. */
static double tail(double value, const stats_contrast *of)
{
    if (of->se == 0.0) return value > 0.0 ? 0.0 : value < 0.0 ? 1.0 : 0.5;
    if (isinf(of->dof)) return gsl_cdf_ugaussian_Q(value / of->se);
    return gsl_cdf_tdist_Q(value / of->se, of->dof);
}

double stats_contrast_p(const stats_contrast *c)
{
    return 2.0 * tail(fabs(c->value), c);
}

double stats_contrast_p_margin(const stats_contrast *c, double margin)
{
    return tail(margin - fabs(c->value), c);
}

void stats_contrast_interval(const stats_contrast *c, double level, double *lo, double *hi)
{
    const double outside = 0.5 * (1.0 - level);
    const double t = isinf(c->dof) ? gsl_cdf_ugaussian_Qinv(outside) : gsl_cdf_tdist_Qinv(outside, c->dof);
    const double half = c->se == 0.0 ? 0.0 : t * c->se;
    *lo = c->value - half;
    *hi = c->value + half;
}

static void compare_pairs(sample *s, stats_trend *trend)
{
    trend->pair = (stats_contrast){0.0, 0.0, NAN};
    trend->p_pairs = 0.0;
    for (size_t i = 0; i < s->n_x; i++)
        for (size_t j = i + 1; j < s->n_x; j++) {
            s->c[i] = -1.0;
            s->c[j] = 1.0;
            const stats_contrast pair = contrast_of(s, i, j, j - i);
            if (fabs(pair.value) >= fabs(trend->pair.value)) trend->pair = pair;
            trend->p_pairs = fmax(trend->p_pairs, stats_contrast_p_margin(&pair, s->of->margin / s->y_unit));
        }
}

/* Of what its unit makes too large or too small nothing is known. */
static void scale(stats_contrast *c, double unit)
{
    const double value = c->value * unit, se = c->se * unit;
    const bool fits = isfinite(value) && isfinite(se) && (se > 0.0) == (c->se > 0.0);
    c->value = fits ? value : NAN, c->se = fits ? se : NAN;
}

static rp_status analyse(sample *s, stats_trend *trend)
{
    rp_status status = s->of->pile && s->n > 0 ? keep_whole_piles(s) : RP_OK;
    trend->n = s->n;
    trend->n_x = s->n_x;
    if (status) return status;
    if (s->n < 3 || s->n_x < 2 || (s->of->pile && s->n_piles < 2))
        return rp_fail(RP_NO_RESULT,
                       "no trend: %zu values%s at %zu different x; at least 3 values at 2 x%s needed", s->n,
                       s->of->pile ? " of whole piles" : "", s->n_x, s->of->pile ? " of 2 piles" : "");
    RP_TRY(fill_cells(s));
    set_moments(s);
    if (!isfinite(s->sw) || !(s->sxx > 0.0))
        return rp_fail(RP_NO_RESULT, "no trend: weights x^%g overflow", s->of->power);
    if (!isnan(s->residual)) set_residual(s);
    trend->from = s->cells[0].x;
    trend->to = s->cells[s->n_x - 1].x;
    trend->slope = coefficient(s, 1);
    trend->intercept = intercept(s);
    if (s->n_x > 2) trend->bend = coefficient(s, 2);
    const double range = trend->to - trend->from;
    trend->change = (stats_contrast){trend->slope.value * range, trend->slope.se * range, trend->slope.dof};
    trend->p_margin = stats_contrast_p_margin(&trend->change, s->of->margin / s->y_unit);
    compare_pairs(s, trend);
    trend->from *= s->x_unit, trend->to *= s->x_unit;
    scale(&trend->slope, s->y_unit / s->x_unit);
    scale(&trend->intercept, s->y_unit);
    scale(&trend->bend, s->y_unit / s->x_unit / s->x_unit);
    scale(&trend->change, s->y_unit);
    scale(&trend->pair, s->y_unit);
    return RP_OK;
}

rp_status stats_trend_fit(const stats_sample *of, stats_trend *trend)
{
    const stats_contrast none = {NAN, NAN, NAN};
    *trend = (stats_trend){0, 0, NAN, NAN, none, none, none, none, none, NAN, NAN};
    RP_TRY(rp_check_range("margin", of->margin, DBL_MIN, DBL_MAX, "(0, inf)"));
    for (size_t i = 0; i < of->n && of->power != 0.0 && !of->log10_x; i++)
        if (!(of->x[i] > 0.0))
            return rp_fail(RP_BAD_INPUT,
                           "value %zu: x = %g: out of range for weights x^%g, allowed: (0, inf)", i + 1,
                           of->x[i], of->power);
    RP_SCOPE(memory);
    sample s = {.of = of, .n = of->n};
    RP_NEW(&memory, s.points, of->n);
    RP_NEW(&memory, s.cells, of->n);
    RP_NEW(&memory, s.c, 2 * of->n);
    s.work = s.c + of->n;
    RP_TRY(load_points(&s));
    return analyse(&s, trend);
}

void stats_holm(size_t n, const double p[], double corrected[])
{
    size_t tests = 0;
    for (size_t i = 0; i < n; i++) tests += !isnan(p[i]);
    for (size_t i = 0; i < n; i++) {
        size_t below = 0;
        for (size_t k = 0; k < n; k++) below += p[k] < p[i];
        corrected[i] = isnan(p[i]) ? NAN : fmin(1.0, p[i] * (double)(tests - below));
    }
    for (size_t i = 0; i < n; i++) /* the largest of what p[j] <= p[i] are raised to */
        for (size_t j = 0; j < n; j++)
            if (p[j] <= p[i]) corrected[i] = fmax(corrected[i], corrected[j]);
}

const char *stats_trend_word(const stats_trend *trend, double p_value, double level)
{
    const bool moves = p_value < level, falls = trend->change.value < 0.0;
    const bool small = trend->p_margin < level;
    if (moves && small) return falls ? "falls_within_margin" : "rises_within_margin";
    if (moves) return falls ? "falls" : "rises";
    return small ? "no_dependence_within_margin" : "undecided";
}
