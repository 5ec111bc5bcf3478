/* Least value of a function of up to three variables, by + - * / alone; see stats.h. */
#include <math.h>
#include <string.h>

#include "stats/stats.h"

enum { MOST = 3 };

/* The best of a grid, the last side fastest. */
static void best_of_grid(const stats_minimum *m, const double cell[], double x[], double *value)
{
    int at[MOST] = {0};
    double y[MOST];
    for (size_t p = 1; p > 0;) {
        /* round-off must not leave the box */
        for (size_t k = 0; k < m->n; k++) y[k] = fmin(m->lo[k] + at[k] * cell[k], m->hi[k]);
        const double here = m->f(y, m->data);
        if (here < *value) *value = here, memcpy(x, y, m->n * sizeof *x);
        for (p = m->n; p > 0 && (!(m->hi[p - 1] > m->lo[p - 1]) || at[p - 1] == m->cells); p--) at[p - 1] = 0;
        if (p > 0) at[p - 1]++;
    }
}

typedef struct {
    double x[MOST], f;
} vertex;

/* `part` of the way from one to another, within the box. */
static vertex between(const stats_minimum *m, const vertex *from, const vertex *to, double part)
{
    vertex v;
    for (size_t p = 0; p < m->n; p++)
        v.x[p] = fmin(fmax(from->x[p] + part * (to->x[p] - from->x[p]), m->lo[p]), m->hi[p]);
    v.f = m->f(v.x, m->data);
    return v;
}

/* Downhill from y by a simplex (Nelder & Mead 1965); x and *value if that ends lower. */
static void descend(const stats_minimum *m, const double cell[], const double y[], double x[], double *value)
{
    vertex v[MOST + 1];
    size_t n = 0;
    memcpy(v[0].x, y, m->n * sizeof *y);
    v[0].f = m->f(y, m->data);
    for (size_t p = 0; p < m->n; p++) {
        if (!(m->hi[p] > m->lo[p])) continue;
        vertex to = v[0];
        to.x[p] += to.x[p] + cell[p] > m->hi[p] ? -cell[p] : cell[p];
        v[++n] = between(m, &v[0], &to, 1.0);
    }
    for (int k = 0; k < 2000; k++) {
        vertex middle = {{0.0}}, *w = &v[n]; /* the worst, and the middle of the others */
        double size = 0.0;
        for (size_t i = 1; i <= n; i++) /* the best first */
            for (size_t j = i; j > 0 && v[j].f < v[j - 1].f; j--) {
                const vertex higher = v[j - 1];
                v[j - 1] = v[j], v[j] = higher;
            }
        for (size_t p = 0; p < m->n; p++)
            for (size_t i = 0; i < n; i++) {
                size = fmax(size, fabs(v[i + 1].x[p] - v[0].x[p]) / cell[p]);
                middle.x[p] += v[i].x[p] / (double)n;
            }
        if (size < 1e-9) break;
        const vertex mirrored = between(m, &middle, w, -1.0);
        const double part = mirrored.f < v[0].f       ? -2.0
                            : mirrored.f < v[n - 1].f ? -1.0
                            : mirrored.f < w->f       ? -0.5
                                                      : 0.5;
        const vertex other = between(m, &middle, w, part);
        const vertex *lower = other.f < mirrored.f ? &other : &mirrored;
        if (lower->f < w->f) {
            *w = *lower;
            continue;
        }
        for (size_t i = 1; i <= n; i++) v[i] = between(m, &v[0], &v[i], 0.5);
    }
    if (v[0].f < *value) *value = v[0].f, memcpy(x, v[0].x, m->n * sizeof *x);
}

rp_status stats_least(const stats_minimum *m, double x[], double *value)
{
    double cell[MOST], y[MOST];
    size_t n_free = 0;
    if (m->n < 1 || m->n > MOST || m->cells < 1)
        return rp_fail(RP_BAD_INPUT, "minimum: %zu dimensions, %d cells: 1 to %d, and 1 or more expected",
                       m->n, m->cells, MOST);
    for (size_t p = 0; p < m->n; p++) {
        if (!isfinite(m->lo[p]) || !isfinite(m->hi[p]))
            return rp_fail(RP_BAD_INPUT, "minimum: side %zu: [%g, %g]: finite ends expected", p + 1, m->lo[p],
                           m->hi[p]);
        const bool held = !(m->hi[p] > m->lo[p]);
        n_free += !held;
        cell[p] = held ? 1.0 : (m->hi[p] - m->lo[p]) / m->cells;
    }
    *value = HUGE_VAL;
    best_of_grid(m, cell, x, value);
    if (n_free == 0) return RP_OK;
    descend(m, cell, x, x, value);
    /* the grid may miss a narrow valley: from the guess too, or from the middles of the halves of all sides
     */
    for (size_t k = 0; n_free > 1 && k < (m->guess ? 1 : 1u << m->n); k++) {
        for (size_t p = 0; p < m->n; p++)
            y[p] = m->guess ? fmin(fmax(m->guess[p], m->lo[p]), m->hi[p])
                            : m->lo[p] + (k >> p & 1 ? 0.75 : 0.25) * (m->hi[p] - m->lo[p]);
        descend(m, cell, y, x, value);
    }
    /* a simplex may have become flat before the end */
    double before = INFINITY;
    for (int k = 0; k < 8 && *value < before - 1e-9 * fabs(before); k++) {
        before = *value;
        descend(m, cell, x, x, value);
    }
    return RP_OK;
}
