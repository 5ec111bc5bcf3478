/* How well the grains of a kind are mixed with the others: Lacey's index of variances between cells (J. Appl.
 * Chem. 4, 257, 1954), unlike contacts, and centres of mass. */
#include <math.h>
#include <stdlib.h>

#include "core/elementary.h"
#include "experiment/modules/module.h"

typedef struct {
    double cell;
    int along;
} mixing_params;

enum { ALONG_X, ALONG_Y, ALONG_BOTH };
static const rp_param schema[] = {{"cell", "cm", RP_REAL, offsetof(mixing_params, cell), NULL, "(0, inf)",
                                   "width of a cell; the first begins at the region's lower ends, or at 0"},
                                  {"along", "", RP_CHOICE, offsetof(mixing_params, along), "both",
                                   "x | y | both", "direction of the cells: columns, layers or squares"},
                                  {0}};

enum { LACEY, UNLIKE, DISTANCE, SHARE, CELLS };
static const exp_output outputs[] = {
    {"_lacey", "", "Lacey's index: 0 where each cell has one sort alone, 1 the mean of shuffled grains"},
    {"_unlike", "",
     "share of the contacts that are between unlike grains, over its mean for shuffled grains; unequal sizes "
     "spoil it, since large grains have more neighbours"},
    {"_distance", "cm", "between the centre of mass of the kind and that of the others"},
    {"_share", "", "share of the kind in the number of grains"},
    {"_cells", "", "cells that hold a grain"},
    {0}};

/* A grain in its cell. */
typedef struct {
    double x, y;
    bool own;
} placed;

static int by_cell(const void *a, const void *b)
{
    const placed *p = a, *q = b;
    return p->y != q->y ? (p->y > q->y) - (p->y < q->y) : (p->x > q->x) - (p->x < q->x);
}

static double cell_at(double x, double lower, double width)
{
    return floor((x - (isfinite(lower) ? lower : 0.0)) / width);
}

/* Cells weigh as many grains as they hold, N in all. The mean variance between K cells over all ways to
 * shuffle the labels is p (1 - p) (K - 1)/(N - 1): of a cell with n grains, drawn from N without putting
 * back, it is p (1 - p)/n (N - n)/(N - 1). */
static rp_status lacey(const exp_view *s, const mixing_params *params, double p, double out[])
{
    RP_SCOPE(memory);
    placed *at;
    const double n = (double)s->n, apart = p * (1.0 - p);
    double between = 0.0, cells = 0.0;
    RP_NEW(&memory, at, s->n);
    for (size_t i = 0; i < s->n; i++) {
        const dem_state *g = &s->grains[i];
        at[i].own = g->kind == s->kind;
        if (params->along != ALONG_Y) at[i].x = cell_at(g->x, s->lo[0], params->cell);
        if (params->along != ALONG_X) at[i].y = cell_at(g->y, s->lo[1], params->cell);
    }
    qsort(at, s->n, sizeof *at, by_cell);
    for (size_t i = 0, end; i < s->n; i = end, cells++) {
        double own = 0.0;
        for (end = i; end < s->n && by_cell(&at[i], &at[end]) == 0; end++) own += at[end].own;
        const double held = (double)(end - i), off = own / held - p;
        between += held / n * off * off;
    }
    out[CELLS] = cells;
    if (cells > 1.0 && cells < n)
        out[LACEY] = (apart - between) / (apart * (1.0 - (cells - 1.0) / (n - 1.0)));
    return RP_OK;
}

static double unlike(const exp_view *s, double p)
{
    const double n = (double)s->n, shuffled = 2.0 * p * (1.0 - p) * n / (n - 1.0);
    double contacts = 0.0, differ = 0.0;
    for (const dem_contact *c = s->contacts; c < s->contacts + s->n_contacts; c++) {
        const dem_state *a = exp_grain_of(s->n, s->grains, c->id_a),
                        *b = exp_grain_of(s->n, s->grains, c->id_b);
        if (!a || !b) continue;
        contacts++, differ += (a->kind == s->kind) != (b->kind == s->kind);
    }
    return differ / contacts / shuffled;
}

static rp_status evaluate(const exp_view *s, const void *params, double out[])
{
    double n[2] = {0.0}, m[2] = {0.0}, x[2] = {0.0}, y[2] = {0.0};
    for (const dem_state *g = s->grains; g < s->grains + s->n; g++) {
        const bool own = g->kind == s->kind;
        n[own]++, m[own] += g->m, x[own] += g->m * g->x, y[own] += g->m * g->y;
    }
    if (!(n[0] > 0.0 && n[1] > 0.0))
        return rp_fail(RP_NO_RESULT, "%.0f grains of the kind, %.0f others", n[1], n[0]);
    out[SHARE] = n[1] / (double)s->n;
    out[DISTANCE] = rp_hypot(x[1] / m[1] - x[0] / m[0], y[1] / m[1] - y[0] / m[0]);
    out[UNLIKE] = unlike(s, out[SHARE]);
    return lacey(s, params, out[SHARE], out);
}

EXP_MODULE(mixing, "how the grains of a kind are mixed with all others of the region", "one_kind", schema,
           mixing_params, outputs, EXP_ON_CONTACTS | EXP_OF_KIND, .evaluate = evaluate);
