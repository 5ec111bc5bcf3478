/* Outlines of close-packed piles; see pile.h. */
#include "sweeps/protocols/pile.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/random.h"

/* Rows of the lattice that stay below an outline over its base, from the centre of the first base disk to
 * that of the last: the rule of an_lattice_cut for any polygon. */
static rp_status cut_profile(const an_profile *profile, long k, double theta, long up[])
{
    const double TIE = 1e-9, left = profile->v[0].x, width = profile->v[profile->n - 1].x - left;
    const double unit = k > 1 ? width / (double)(k - 1) : width, height = unit / (2 * tan(theta));
    for (long s = 0; s < k; s++)
        for (up[s] = 1; s + up[s] < k; up[s]++) {
            double top, x = left + fmin(((double)s + 0.5 * (double)up[s]) * unit, width);
            RP_TRY(an_profile_height(profile, x, &top));
            if (!((double)up[s] * height <= top + TIE * unit)) break;
        }
    return RP_OK;
}

/* Over the square of the base. */
static double area(const an_profile *p)
{
    double sum = 0;
    for (size_t i = 1; i < p->n; i++) sum += (p->v[i].x - p->v[i - 1].x) * (p->v[i].y + p->v[i - 1].y) / 2;
    const double width = p->v[p->n - 1].x - p->v[0].x;
    return sum / (width * width);
}

/* Disks of a stepped outline, and their exact forces. */
static rp_status fill_outline(sweep_outline *h, double theta)
{
    h->disks = malloc(h->n * sizeof *h->disks);
    h->exact = malloc(h->k * sizeof *h->exact);
    if (!h->disks || !h->exact) return rp_fail(RP_NO_MEMORY, "pile: out of memory");
    size_t n = 0;
    for (size_t s = 0; s < h->k; s++)
        for (long j = 0; j < h->up[s]; j++)
            h->disks[n++] = (statics_disk){((double)s + 0.5 * (double)j) * 2 * sin(theta),
                                           0.5 + (double)j * cos(theta), 0.5, 1};
    return an_lattice_counts((long)h->k, h->up, theta, h->exact);
}

/* Disks in each row of an outline, and B. */
static rp_status cut_outline(sweep_outline *h, double theta, double alpha, size_t n, const an_point v[],
                             long up[])
{
    an_profile profile;
    RP_TRY(n > 0 ? an_profile_set(&profile, v, n) : an_lattice_cut((long)h->k, theta, alpha, up));
    if (n > 0) RP_TRY(cut_profile(&profile, (long)h->k, theta, up));
    for (size_t s = 0; s < h->k; s++) h->n += (size_t)up[s];
    if (h->n > STATICS_MAX) /* before there is memory for them */
        return rp_fail(RP_BAD_INPUT, "base of %zu disks: a pile of %zu, allowed: up to %d", h->k, h->n,
                       STATICS_MAX);
    h->B = n > 0 ? sqrt((double)h->n * sin(2 * theta) / area(&profile))
                 : an_lattice_base((double)h->n, theta, alpha);
    return RP_OK;
}

rp_status sweep_outline_count(sweep_outline *h, long k, double gap, double alpha, size_t n,
                              const an_point v[])
{
    const double theta = asin((1 + gap) / 2); /* of the diagonals to the vertical */
    long *up = malloc((size_t)k * sizeof *up);
    if (!up) return rp_fail(RP_NO_MEMORY, "pile: out of memory");
    *h = (sweep_outline){.k = (size_t)k};
    rp_status status = cut_outline(h, theta, alpha > 0 ? alpha : M_PI / 2 - theta, n, v, up);
    h->up = up;
    return status;
}

rp_status sweep_outline_make(sweep_outline *h, long k, double gap, double alpha, size_t n, const an_point v[])
{
    rp_status status = sweep_outline_count(h, k, gap, alpha, n, v);
    return status ? status : fill_outline(h, asin((1 + gap) / 2));
}

void sweep_outline_free(sweep_outline *h)
{
    free(h->up);
    free(h->disks);
    free(h->exact);
}

rp_status sweep_outline_disorder(sweep_outline *h, double S, unsigned long seed, unsigned long run)
{
    const double CUT = 3;
    gsl_rng *radii = rp_random_alloc(seed, run, RP_PURPOSE_RADII);
    if (!radii) return rp_fail(RP_NO_MEMORY, "pile: out of memory");
    for (size_t i = 0; i < h->n; i++) {
        statics_disk *p = &h->disks[i];
        if (p->y <= p->r) continue; /* on the ground */
        const double size = 1 + S * rp_random_cut_normal(radii, 0, 1, -CUT, CUT);
        p->r = size / 2;
        p->weight = size * size;
    }
    gsl_rng_free(radii);
    return RP_OK;
}

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

rp_status sweep_outline_rays(size_t n, const double x[], const double top[], const stress_base *base,
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

double sweep_outline_friction(size_t k, const double N[], const double H[])
{
    double most = 0;
    for (size_t i = 0; i < k; i++) most = fmax(most, fabs(H[i]) / N[i]); /* 0/0 needs none */
    return most;
}
