/* Outlines of close-packed piles; see pile.h. */
#include "core/elementary.h"
#include "sweeps/protocols/pile.h"

#include <math.h>

#include "core/random.h"

/* Rows of the lattice that stay below an outline over its base, from the centre of the first base disk to
 * that of the last: the rule of an_lattice_cut for any polygon. */
static rp_status cut_profile(const an_profile *profile, long k, double theta, long up[])
{
    const double TIE = 1e-9, left = profile->v[0].x, width = profile->v[profile->n - 1].x - left;
    const double unit = k > 1 ? width / (double)(k - 1) : width, height = unit / (2 * rp_tan(theta));
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

/* Disks in each row of an outline, and B. */
static rp_status cut_outline(sweep_outline *h, double theta, double alpha, size_t n, const an_point v[])
{
    an_profile profile;
    RP_TRY(n > 0 ? an_profile_set(&profile, v, n) : an_lattice_cut((long)h->k, theta, alpha, h->up));
    if (n > 0) RP_TRY(cut_profile(&profile, (long)h->k, theta, h->up));
    for (size_t s = 0; s < h->k; s++) h->n += (size_t)h->up[s];
    if (h->n > STATICS_MAX) /* before there is memory for them */
        return rp_fail(RP_BAD_INPUT, "base of %zu disks: a pile of %zu, allowed: up to %d", h->k, h->n,
                       STATICS_MAX);
    h->B = n > 0 ? sqrt((double)h->n * rp_sin(2 * theta) / area(&profile))
                 : an_lattice_base((double)h->n, theta, alpha);
    return RP_OK;
}

rp_status sweep_outline_count(sweep_outline *h, long k, double gap, double alpha, size_t n,
                              const an_point v[])
{
    const double theta = rp_asin((1 + gap) / 2); /* of the diagonals to the vertical */
    *h = (sweep_outline){.k = (size_t)k};
    RP_NEW(&h->memory, h->up, h->k);
    return cut_outline(h, theta, alpha > 0 ? alpha : M_PI / 2 - theta, n, v);
}

rp_status sweep_outline_make(sweep_outline *h, long k, double gap, double alpha, size_t n, const an_point v[])
{
    const double theta = rp_asin((1 + gap) / 2);
    size_t made = 0;
    RP_TRY(sweep_outline_count(h, k, gap, alpha, n, v));
    RP_NEW(&h->memory, h->disks, h->n);
    RP_NEW(&h->memory, h->exact, h->k);
    for (size_t s = 0; s < h->k; s++)
        for (long j = 0; j < h->up[s]; j++)
            h->disks[made++] = (statics_disk){((double)s + 0.5 * (double)j) * 2 * rp_sin(theta),
                                              0.5 + (double)j * rp_cos(theta), 0.5, 1};
    return an_lattice_counts(k, h->up, theta, h->exact);
}

void sweep_outline_free(sweep_outline *h)
{
    rp_arena_end(&h->memory);
}

rp_status sweep_outline_disorder(sweep_outline *h, double S, unsigned long seed, unsigned long run)
{
    const double CUT = 3;
    rp_random radii = rp_random_of(seed, run, RP_PURPOSE_RADII);
    for (size_t i = 0; i < h->n; i++) {
        statics_disk *p = &h->disks[i];
        if (p->y <= p->r) continue; /* on the ground */
        const double size = 1 + S * rp_random_cut_normal(&radii, 0, 1, -CUT, CUT);
        p->r = size / 2;
        p->weight = size * size;
    }
    return RP_OK;
}

double sweep_outline_friction(size_t k, const double N[], const double H[])
{
    double most = 0;
    for (size_t i = 0; i < k; i++) most = fmax(most, fabs(H[i]) / N[i]); /* 0/0 needs none */
    return most;
}
