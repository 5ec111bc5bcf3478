/* Stress in a pile from its contacts; see stress.h.
 *
 * Cells. Force f on grain a along the branch l from b to a: s_ab = (1/area) sum f_a l_b w, w the part of the
 * branch in the cell. A contact then carries its force along its branch, so that the force through a line is
 * the sum over the branches that cross it, and in each cell, summed over branches,
 *     area s_ab = sum over crossings with the border, of force times position,
 *               - sum over ends inside, of force times position,
 * where the ends are the grains, on which the contacts put the reversed weight, and the points of walls: the
 * moment of div s = rho g + forces of walls. Nothing is smoothed away, and no derivative is taken.
 *
 * Mohr. On a plane with normal n and tangent n' the pressure is n s n and the shear n' s n. With p the mean
 * pressure, R the radius and c = (xy - yx)/2 the point (pressure, shear) runs on the circle of radius R about
 * (p, +-c), so that the steepest line from the origin to it has the angle
 *     asin(R/sqrt(p^2 + c^2)) + atan(|c|/p);
 * without couple asin(R/p), the angle of friction mobilised. */
#include <gsl/gsl_math.h>
#include <math.h>

#include "core/elementary.h"
#include "stress/stress.h"

/* Cut [*lo, *hi] down to where from + s step lies in [a, b]. */
static void clip(double from, double step, double a, double b, double *lo, double *hi)
{
    if (step == 0.0) {
        if (from < a || from >= b) *hi = *lo;
        return;
    }
    double s = (a - from) / step, e = (b - from) / step;
    *lo = fmax(*lo, fmin(s, e));
    *hi = fmin(*hi, fmax(s, e));
}

/* First and last cell that the span from u to v may touch. */
static void cells_of(double u, double v, double start, double size, size_t n, size_t *first, size_t *last)
{
    const double most = (double)n - 1.0;
    *first = (size_t)fmin(fmax(floor((fmin(u, v) - start) / size), 0.0), most);
    *last = (size_t)fmin(fmax(floor((fmax(u, v) - start) / size), 0.0), most);
}

static void add_contact(const stress_contact *c, const stress_grid *g, stress_tensor stress[])
{
    const double lx = c->x - c->x_b, ly = c->y - c->y_b, area = g->dx * g->dy;
    size_t i0, i1, j0, j1;
    cells_of(c->x, c->x_b, g->x0, g->dx, g->nx, &i0, &i1);
    cells_of(c->y, c->y_b, g->y0, g->dy, g->ny, &j0, &j1);
    for (size_t j = j0; j <= j1; j++)
        for (size_t i = i0; i <= i1; i++) {
            double lo = 0.0, hi = 1.0, x = g->x0 + (double)i * g->dx, y = g->y0 + (double)j * g->dy;
            clip(c->x_b, lx, x, x + g->dx, &lo, &hi);
            clip(c->y_b, ly, y, y + g->dy, &lo, &hi);
            if (hi <= lo) continue;
            stress_tensor *s = &stress[j * g->nx + i];
            const double w = (hi - lo) / area;
            s->xx += w * c->fx * lx;
            s->xy += w * c->fx * ly;
            s->yx += w * c->fy * lx;
            s->yy += w * c->fy * ly;
        }
}

rp_status stress_cells(size_t n, const stress_contact contacts[], const stress_grid *grid,
                       stress_tensor stress[])
{
    const stress_grid *g = grid;
    if (!(g->dx > 0.0 && g->dy > 0.0 && isfinite(g->x0 + g->y0 + g->dx + g->dy) && g->nx > 0 && g->ny > 0))
        return rp_fail(RP_BAD_INPUT,
                       "grid: %zu x %zu cells of %g x %g from (%g, %g): at least one, allowed: (0, inf)",
                       g->nx, g->ny, g->dx, g->dy, g->x0, g->y0);
    for (size_t k = 0; k < g->nx * g->ny; k++) stress[k] = (stress_tensor){0};
    for (size_t k = 0; k < n; k++) {
        const stress_contact *c = &contacts[k];
        if (!isfinite(c->x + c->y + c->x_b + c->y_b + c->fx + c->fy))
            return rp_fail(RP_BAD_INPUT, "contact %zu: finite numbers expected", k + 1);
        add_contact(c, g, stress);
    }
    return RP_OK;
}

void stress_tensor_add(stress_tensor *sum, const stress_tensor *s, double factor)
{
    sum->xx += factor * s->xx;
    sum->xy += factor * s->xy;
    sum->yx += factor * s->yx;
    sum->yy += factor * s->yy;
}

stress_circle stress_mohr(const stress_tensor *s)
{
    stress_circle m;
    const double deviator = 0.5 * (s->xx - s->yy), shear = 0.5 * (s->xy + s->yx);
    m.pressure = 0.5 * (s->xx + s->yy);
    m.shear = rp_hypot(deviator, shear);
    m.couple = 0.5 * (s->xy - s->yx);
    m.direction = m.shear > 0.0 ? 0.5 * rp_atan2(shear, deviator) : NAN;
    const double reach = rp_hypot(m.pressure, m.couple);
    m.mobilised = m.pressure > 0.0 && m.shear < reach
                      ? fmin(rp_asin(m.shear / reach) + rp_atan(fabs(m.couple) / m.pressure), M_PI_2)
                      : (reach > 0.0 || m.shear > 0.0 ? M_PI_2 : NAN);
    return m;
}
