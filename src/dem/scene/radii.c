/* Laws of radii; see radii.h. */
#include "dem/scene/radii.h"

#include <math.h>

#include "core/elementary.h"
#include "core/random.h"

/* Mean and standard deviation of the logarithm, of a law of these. */
static void logarithmic(const dem_fill *f, double *mean, double *width)
{
    const double part = f->radius_width / f->radius_mean, variance = rp_log(1.0 + part * part);
    *mean = rp_log(f->radius_mean) - 0.5 * variance;
    *width = sqrt(variance);
}

/* The ends of the law, cut. */
static void ends(const dem_fill *f, double *lo, double *hi)
{
    *lo = f->radius_min, *hi = f->radius_max;
    if (f->law == DEM_RADII_TABLE) {
        *lo = INFINITY, *hi = 0.0;
        for (size_t k = 0; k < f->n_radii; k++)
            *lo = fmin(*lo, f->radii[2 * k]), *hi = fmax(*hi, f->radii[2 * k]);
    } else if (f->radius_width == 0.0) {
        *lo = *hi = f->radius_mean;
    } else if (f->law == DEM_RADII_UNIFORM) {
        *lo = fmax(*lo, f->radius_mean - sqrt(3.0) * f->radius_width);
        *hi = fmin(*hi, f->radius_mean + sqrt(3.0) * f->radius_width);
    }
}

double dem_radius_least(const dem_fill *f)
{
    double lo, hi;
    ends(f, &lo, &hi);
    return lo;
}

double dem_radius_most(const dem_fill *f)
{
    double lo, hi;
    ends(f, &lo, &hi);
    return hi;
}

double dem_radius_mean(const dem_fill *f)
{
    double sum = 0.0, shares = 0.0;
    if (f->law != DEM_RADII_TABLE) return f->radius_mean;
    for (size_t k = 0; k < f->n_radii; k++)
        sum += f->radii[2 * k] * f->radii[2 * k + 1], shares += f->radii[2 * k + 1];
    return sum / shares;
}

/* A radius by the law's shares as they are. */
static double draw_share(const dem_fill *f, rp_random *r, double lo, double hi)
{
    double mean, width, shares = 0.0;
    switch (f->law) {
    case DEM_RADII_GAUSS: break;
    case DEM_RADII_UNIFORM: return lo + (hi - lo) * rp_random_uniform(r);
    case DEM_RADII_LOGNORMAL:
        logarithmic(f, &mean, &width);
        return fmin(fmax(rp_exp(rp_random_cut_normal(r, mean, width, rp_log(lo), rp_log(hi))), lo), hi);
    case DEM_RADII_TABLE:
        for (size_t k = 0; k < f->n_radii; k++) shares += f->radii[2 * k + 1];
        shares *= rp_random_uniform(r);
        for (size_t k = 0; k + 1 < f->n_radii; k++)
            if ((shares -= f->radii[2 * k + 1]) < 0.0) return f->radii[2 * k];
        return f->radii[2 * f->n_radii - 2];
    }
    return rp_random_cut_normal(r, f->radius_mean, f->radius_width, lo, hi);
}

double dem_radius_draw(const dem_fill *f, rp_random *r)
{
    double lo, hi;
    ends(f, &lo, &hi);
    if (lo == hi) return lo;
    for (;;) {
        const double radius = draw_share(f, r, lo, hi);
        if (f->by == DEM_BY_NUMBER) return radius;
        /* of a share of the area, one of grains is less by r^2 */
        const double part = lo / radius;
        if (rp_random_uniform(r) <
            part * part * (f->by == DEM_BY_MASS && f->shape == DEM_SPHERE ? part : 1.0))
            return radius;
    }
}

rp_status dem_radii_check(const dem_fill *f)
{
    double shares = 0.0;
    if (f->law != DEM_RADII_TABLE)
        return f->radius_width > 0.0 ? dem_radius_check(f->radius_mean, f->radius_min, f->radius_max) : RP_OK;
    for (size_t k = 0; k < f->n_radii; k++) {
        const double r = f->radii[2 * k], share = f->radii[2 * k + 1];
        if (!(r > 0.0 && isfinite(r) && share >= 0.0 && isfinite(share)))
            return rp_fail(RP_BAD_INPUT, "radii: [%g, %g]: a radius above 0 and a share expected", r, share);
        shares += share;
    }
    return shares > 0.0 ? RP_OK : rp_fail(RP_BAD_INPUT, "radii: a list ( [r, share], ... ) is needed");
}
