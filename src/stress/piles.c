/* Ensembles of piles: mean stress and forces on the floor; see stress.h. */
#include <math.h>

#include "core/arena.h"
#include "core/elementary.h"
#include "stress/stress.h"

stress_grid stress_grid_over(size_t n, const stress_pile piles[], double width, double cell)
{
    double top = -INFINITY, ground = INFINITY;
    for (size_t i = 0; i < n; i++) {
        ground = fmin(ground, piles[i].ground);
        for (size_t k = 0; k < piles[i].n_grains; k++) top = fmax(top, piles[i].y[k]);
    }
    stress_grid g = {.y0 = ground, .nx = (size_t)fmax(round(width / cell), 1.0)};
    g.dx = g.dy = width / (double)g.nx;
    g.ny = (size_t)ceil(fmax(top - ground, 0.0) / g.dy) + 1;
    return g;
}

rp_status stress_mean_cells(size_t n, const stress_pile piles[], const stress_grid *g, stress_tensor mean[])
{
    RP_SCOPE(memory);
    const size_t cells = g->nx * g->ny;
    stress_tensor *one;
    RP_NEW(&memory, one, cells);
    for (size_t k = 0; k < cells; k++) mean[k] = (stress_tensor){0};
    for (size_t i = 0; i < n; i++) {
        RP_TRY(stress_cells(piles[i].n, piles[i].contacts, g, one));
        for (size_t k = 0; k < cells; k++) stress_tensor_add(&mean[k], &one[k], 1.0 / (double)n);
    }
    return RP_OK;
}

/* Sums over a column of one pile. */
typedef struct {
    double n, h, weight, through;
} column;

static void add_columns(const stress_pile *p, double size, double g, size_t n, column columns[])
{
    for (size_t k = 0; k < p->n_grains; k++) {
        const double at = floor(p->x[k] / size);
        if (at >= 0.0 && at < (double)n) columns[(size_t)at].weight += p->m[k] * g;
    }
    for (size_t k = 0; k < p->n; k++) {
        const stress_contact *c = &p->contacts[k];
        const double a = floor(c->x / size), b = floor(c->x_b / size);
        const bool in_a = a >= 0.0 && a < (double)n, wall = p->wall[k] || c->x_b <= 0.0;
        if (p->floor[k] && in_a) {
            columns[(size_t)a].n += c->fy;
            columns[(size_t)a].h -= c->fx;
        } else if (a != b || wall) {
            if (in_a) columns[(size_t)a].through -= c->fy;
            if (!wall && b >= 0.0 && b < (double)n) columns[(size_t)b].through += c->fy;
        }
    }
}

size_t stress_floor_cells(size_t n, const stress_pile piles[], double width, double cell, double *size)
{
    double far = width;
    for (size_t i = 0; i < n; i++)
        for (size_t k = 0; k < piles[i].n_grains; k++) far = fmax(far, piles[i].x[k]);
    *size = width / fmax(round(width / cell), 1.0);
    return (size_t)ceil(far / *size) + 1;
}

rp_status stress_floor_forces(size_t n, const stress_pile piles[], double size, double g, size_t cells,
                              stress_floor forces[])
{
    RP_SCOPE(memory);
    column *all;
    double *work;
    RP_NEW(&memory, all, n * cells);
    RP_NEW(&memory, work, 2 * n);
    for (size_t i = 0; i < n; i++) add_columns(&piles[i], size, g, cells, all + i * cells);
    for (size_t j = 0; j < cells; j++) {
        stress_floor *f = &forces[j];
        f->weight = f->through = 0.0;
        for (size_t i = 0; i < n; i++) {
            const column *c = &all[i * cells + j];
            work[i] = c->n / size;
            work[n + i] = c->h / size;
            f->weight += c->weight / (size * (double)n);
            f->through += c->through / (size * (double)n);
        }
        RP_TRY(stats_mean(n, work, &f->n));
        RP_TRY(stats_mean(n, work + n, &f->h));
        f->imbalance = f->n.mean - f->weight - f->through;
    }
    return RP_OK;
}

void stress_wedge(double weight, double slope, double phi, double *n, double *h)
{
    const double t = rp_tan(slope), k = rp_tan(phi) * rp_tan(phi);
    *n = t * t < k ? weight / (1.0 - t * t / k) : NAN;
    *h = t / k * *n;
}
