/* Stress in a pile from its contacts, and the tilt at which Coulomb's law is reached; see stress.h.
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
 * without couple asin(R/p), the angle of friction mobilised.
 *
 * Tilt. Of a pile that does not move and whose contacts neither slide nor part, forces are linear in the two
 * components of gravity. Divided by the component normal to the floor they are linear in t, the tangent of
 * the tilt; the two coefficients are measured at small tilts. Coulomb's law is then put to
 *   the floor: h/n = mu, as (3) and (4) do, but with the measured forces, summed over the base; and to
 *   the inside: the mobilised angle of the mean stress of the pile equals a friction angle.
 * Assumed: linearity up to failure (contacts that slide already, and those that start to, carry no more);
 * failure of the sum and not of its weakest part; and inside, that planes of grains have the friction of
 * their contacts, atan mu, though they interlock: along a plane under a long straight flank every stress in
 * balance with the weight mobilises the slope of the flank, tilt included, and that exceeds atan mu in stable
 * piles. The friction of the packing can be measured, but not inferred from mu. */
#include <gsl/gsl_math.h>
#include <gsl/gsl_statistics_double.h>
#include <math.h>
#include <stdlib.h>

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
                       "grid: %zu x %zu cells of %g x %g from (%g, %g): at least one, allowed: "
                       "(0, inf)",
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
    m.shear = hypot(deviator, shear);
    m.couple = 0.5 * (s->xy - s->yx);
    m.direction = m.shear > 0.0 ? 0.5 * atan2(shear, deviator) : NAN;
    const double reach = hypot(m.pressure, m.couple);
    m.mobilised = m.pressure > 0.0 && m.shear < reach
                      ? fmin(asin(m.shear / reach) + atan(fabs(m.couple) / m.pressure), M_PI_2)
                      : (reach > 0.0 || m.shear > 0.0 ? M_PI_2 : NAN);
    return m;
}

double stress_floor_tilt(const stress_response *r, double mu)
{
    /* h[0] + h[1] t = mu (n[0] + n[1] t) */
    const double rise = r->h[1] - mu * r->n[1];
    return rise > 0.0 ? atan((mu * r->n[0] - r->h[0]) / rise) : NAN;
}

double stress_bulk_mobilised(const stress_response *r, double tilt)
{
    stress_tensor s = r->s[0];
    stress_tensor_add(&s, &r->s[1], tan(tilt));
    return stress_mohr(&s).mobilised;
}

/* ---- ensemble ---- */

enum { N_QUANTITIES = sizeof(stress_critical) / sizeof(stress_interval) };

/* Spearman's correlation between the piles' own critical tilts and theta_t, over those that have one. */
static double rank_correlation(size_t n, const stress_response responses[], const double theta_t[],
                               const size_t *pick, double mu, double work[])
{
    double *tilt = work, *t = work + n;
    size_t found = 0;
    for (size_t i = 0; i < n; i++) {
        const size_t k = pick ? pick[i] : i;
        tilt[found] = stress_floor_tilt(&responses[k], mu);
        t[found] = theta_t[k];
        found += !isnan(tilt[found]);
    }
    return found > 2 ? gsl_stats_spearman(tilt, 1, t, 1, found, work + 2 * n) : NAN;
}

/* The quantities of stress_critical, in its order, of the piles pick[0..n), or of all. work[4 n]. */
static void quantities(size_t n, const stress_response responses[], const double theta_t[],
                       const size_t *pick, double mu, double work[], double q[N_QUANTITIES])
{
    stress_response mean = {0};
    double tilt = 0.0;
    const double part = 1.0 / (double)n;
    for (size_t i = 0; i < n; i++) {
        const stress_response *r = &responses[pick ? pick[i] : i];
        tilt += part * theta_t[pick ? pick[i] : i];
        for (int k = 0; k < 2; k++) {
            mean.n[k] += part * r->n[k];
            mean.h[k] += part * r->h[k];
            stress_tensor_add(&mean.s[k], &r->s[k], part);
        }
    }
    const double t = tan(tilt);
    q[0] = mean.h[0] / mean.n[0];
    q[1] = tan(stress_bulk_mobilised(&mean, 0.0));
    q[2] = stress_floor_tilt(&mean, mu);
    q[3] = tilt;
    q[4] = q[2] - tilt;
    q[5] = (mean.h[0] + mean.h[1] * t) / (mean.n[0] + mean.n[1] * t);
    q[6] = tan(stress_bulk_mobilised(&mean, tilt));
    q[7] = rank_correlation(n, responses, theta_t, pick, mu, work);
}

static stress_interval interval(double value, size_t n, double sample[])
{
    const stats_spread spread = stats_resampled(n, sample);
    if (isnan(value) || 10 * spread.n < 9 * n) return (stress_interval){value, NAN, NAN, NAN};
    return (stress_interval){value, spread.sd, spread.lo, spread.hi};
}

static rp_status check_responses(size_t n, const stress_response responses[], const double theta_t[],
                                 size_t n_resamples)
{
    if (n < 3) return rp_fail(RP_NO_RESULT, "%zu piles, at least 3 needed", n);
    for (size_t i = 0; i < n; i++) {
        const double *v = (const double *)&responses[i];
        bool good = isfinite(theta_t[i]);
        for (size_t k = 0; k < sizeof responses[i] / sizeof *v; k++) good = good && isfinite(v[k]);
        if (!good) return rp_fail(RP_BAD_INPUT, "pile %zu: finite numbers expected", i + 1);
    }
    return stats_check_resamples(n_resamples);
}

rp_status stress_critical_tilts(size_t n, const stress_response responses[], const double theta_t[],
                                double mu, size_t n_resamples, gsl_rng *rng, stress_critical *critical)
{
    stress_interval *all = (stress_interval *)critical;
    for (int i = 0; i < N_QUANTITIES; i++) all[i] = (stress_interval){NAN, NAN, NAN, NAN};
    rp_status status = check_responses(n, responses, theta_t, n_resamples);
    if (status) return status;
    double q[N_QUANTITIES], one[N_QUANTITIES];
    size_t *pick = malloc(n * sizeof *pick);
    double *work = malloc(4 * n * sizeof *work),
           *sample = malloc(N_QUANTITIES * n_resamples * sizeof *sample);
    if (!pick || !work || !sample) status = rp_fail(RP_NO_MEMORY, "critical tilts: out of memory");
    if (!status) {
        quantities(n, responses, theta_t, NULL, mu, work, q);
        for (size_t k = 0; k < n_resamples; k++) {
            for (size_t i = 0; i < n; i++) pick[i] = gsl_rng_uniform_int(rng, n);
            quantities(n, responses, theta_t, pick, mu, work, one);
            for (int i = 0; i < N_QUANTITIES; i++) sample[(size_t)i * n_resamples + k] = one[i];
        }
        for (int i = 0; i < N_QUANTITIES; i++)
            all[i] = interval(q[i], n_resamples, sample + (size_t)i * n_resamples);
    }
    free(sample);
    free(work);
    free(pick);
    return status;
}
