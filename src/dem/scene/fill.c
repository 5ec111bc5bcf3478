/* Random filling without overlap (random sequential addition), found through square cells. */
#include <math.h>
#include <stdlib.h>

#include "core/random.h"
#include "dem/dem.h"

static const long MAX_TRIES = 1000000;

typedef struct {
    long nx, ny;
    double size;
    long *head; /* last grain of each cell, -1 for none */
    long *next; /* the one before it in the same cell */
} cells;

/* A place for a grain, from the region's corner (x0, y0). */
typedef struct {
    double x, y, r;
} place;

static bool is_free(const cells *c, const dem_grain *grains, const dem_fill *f, place p)
{
    long cx = (long)(p.x / c->size), cy = (long)(p.y / c->size);
    for (long a = cx > 0 ? cx - 1 : 0; a <= cx + 1 && a < c->nx; a++)
        for (long b = cy > 0 ? cy - 1 : 0; b <= cy + 1 && b < c->ny; b++)
            for (long k = c->head[b * c->nx + a]; k >= 0; k = c->next[k]) {
                double dx = grains[k].x - (f->x0 + p.x), dy = grains[k].y - (f->y0 + p.y),
                       radii = grains[k].r + p.r;
                if (dx * dx + dy * dy < radii * radii) return false;
            }
    return true;
}

static rp_status place_all(const dem_fill *f, cells *c, gsl_rng *places, dem_grain *grains)
{
    for (long i = 0; i < f->N; i++) {
        const double r = grains[i].r;
        double x, y;
        long tries = 0;
        do {
            if (tries++ == MAX_TRIES || 2.0 * r > f->W || 2.0 * r > f->H)
                return rp_fail(
                    RP_NO_RESULT,
                    "no room for grain %ld of N = %ld, of radius %g, in W = %g, H = %g: fewer or smaller "
                    "grains, or a larger box",
                    i + 1, f->N, r, f->W, f->H);
            x = r + (f->W - 2.0 * r) * gsl_rng_uniform(places);
            y = r + (f->H - 2.0 * r) * gsl_rng_uniform(places);
        } while (!is_free(c, grains, f, (place){x, y, r}));
        grains[i] = (dem_grain){f->x0 + x, f->y0 + y, r, dem_mass(f->shape, f->density, r), 0.0, 0.0};
        long cell = (long)(y / c->size) * c->nx + (long)(x / c->size);
        c->next[i] = c->head[cell];
        c->head[cell] = i;
    }
    return RP_OK;
}

rp_status dem_fill_place(const dem_fill *fill, dem_grain *grains)
{
    double r_max = 0.0;
    for (long i = 0; i < fill->N; i++) r_max = fmax(r_max, grains[i].r);
    /* no more than some four cells a grain, however large the region */
    const double most = 2.0 * sqrt((double)fill->N) + 8.0;
    cells c = {.size = fmax(2.0 * r_max, fmax(fill->W, fill->H) / most)};
    c.nx = (long)(fill->W / c.size) + 1;
    c.ny = (long)(fill->H / c.size) + 1;
    c.head = malloc((size_t)(c.nx * c.ny) * sizeof *c.head);
    c.next = malloc((size_t)fill->N * sizeof *c.next);
    gsl_rng *places = rp_random_alloc((unsigned long)fill->seed, (unsigned long)fill->run, RP_PURPOSE_PLACES);
    rp_status status = RP_NO_MEMORY;
    if (c.head && c.next && places) {
        for (long k = 0; k < c.nx * c.ny; k++) c.head[k] = -1;
        status = place_all(fill, &c, places, grains);
    } else {
        rp_fail(status, "filling: out of memory");
    }
    free(c.head);
    free(c.next);
    if (places) gsl_rng_free(places);
    return status;
}

rp_status dem_fill_random(const dem_fill *f, dem_grain *grains)
{
    gsl_rng *radii = rp_random_alloc((unsigned long)f->seed, (unsigned long)f->run, RP_PURPOSE_RADII);
    if (!radii) return rp_fail(RP_NO_MEMORY, "filling: out of memory");
    for (long i = 0; i < f->N; i++)
        grains[i].r =
            rp_random_cut_normal(radii, f->radius_mean, f->radius_width, f->radius_min, f->radius_max);
    gsl_rng_free(radii);
    return dem_fill_place(f, grains);
}
