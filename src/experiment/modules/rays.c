/* What rays at 60 degrees would put on the base under a pile's outline (Liffman, Chan & Hughes 1992, section
 * 3), to compare its own load with. */
#include <math.h>

#include "analytic/analytic.h"
#include "core/arena.h"
#include "experiment/modules/base.h"

/* Columns one diameter wide, from *left on, that hold all points and the base, and on both sides as many
 * empty ones as a slope of STEEP takes down from the highest point. */
static const double STEEP = 1.7; /* below tan 60 degrees, which rays need */

static size_t count_columns(size_t n, const double x[], const double top[], const stress_base *base,
                            double *left)
{
    double lo = base->centroid - base->width / 2, hi = base->centroid + base->width / 2, highest = 0;
    for (size_t i = 0; i < n; i++) {
        lo = fmin(lo, x[i]);
        hi = fmax(hi, x[i]);
        highest = fmax(highest, top[i]);
    }
    const double beside = ceil(highest / STEEP) + 2;
    *left = floor(lo) - beside;
    return (size_t)(floor(hi) - *left + 1 + beside);
}

/* Polygon over the middles of the columns: their highest points, raised where the slope exceeded STEEP. */
static void set_columns(size_t n, const double x[], const double top[], double left, size_t columns,
                        an_point v[])
{
    for (size_t k = 0; k < columns; k++) v[k] = (an_point){left + (double)k + 0.5, 0};
    for (size_t i = 0; i < n; i++) {
        an_point *p = &v[(size_t)(x[i] - left)];
        p->y = fmax(p->y, top[i]);
    }
    for (size_t k = 1; k < columns; k++) v[k].y = fmax(v[k].y, v[k - 1].y - STEEP);
    for (size_t k = columns - 1; k-- > 0;) v[k].y = fmax(v[k].y, v[k + 1].y - STEEP);
}

/* Pressure of the rays of a profile at points of the base, in its bins. */
static rp_status bin_rays(const an_profile *profile, const stress_base *base, double N[STRESS_DIP_BINS])
{
    enum { POINTS = 20 * STRESS_DIP_BINS };
    double x[POINTS], r[POINTS], pressure[POINTS];
    for (int i = 0; i < POINTS; i++) {
        an_force force;
        x[i] = base->centroid + base->width * ((i + 0.5) / POINTS - 0.5);
        r[i] = 0.5 * base->width / POINTS;
        RP_TRY(an_profile_force(profile, x[i], &force));
        pressure[i] = force.N;
    }
    stress_base_bins(base, POINTS, x, r, pressure, N);
    return RP_OK;
}

rp_status exp_outline_rays(size_t n, const double x[], const double top[], const stress_base *base,
                           double N[STRESS_DIP_BINS])
{
    RP_SCOPE(memory);
    double left;
    const size_t columns = count_columns(n, x, top, base, &left);
    an_profile profile;
    an_point *v;
    RP_NEW(&memory, v, columns);
    set_columns(n, x, top, left, columns, v);
    RP_TRY(an_profile_set(&profile, v, columns));
    return bin_rays(&profile, base, N);
}
