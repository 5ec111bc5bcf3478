/* Neighbours by bands as high as the longest bond: within a band, and from each band to the one above, disks
 * are met in the order of x. See bonds.h. */
#include "dem/bonds.h"

#include <math.h>
#include <stdlib.h>

typedef struct {
    double band, x;
    uint32_t disk;
} place;

static int by_band(const void *left, const void *right)
{
    const place *p = left, *q = right;
    if (p->band != q->band) return p->band < q->band ? -1 : 1;
    if (p->x != q->x) return p->x < q->x ? -1 : 1;
    return (p->disk > q->disk) - (p->disk < q->disk);
}

static int by_ends(const void *left, const void *right)
{
    const dem_pair *p = left, *q = right;
    if (p->a != q->a) return p->a < q->a ? -1 : 1;
    return (p->b > q->b) - (p->b < q->b);
}

typedef struct {
    dem_pair *pairs;
    size_t n, room;
} pair_list;

static bool add_if_near(pair_list *list, const dem_pile_disk *disks, double reach, uint32_t a, uint32_t b)
{
    const dem_pile_disk *p = &disks[a], *q = &disks[b];
    const double dx = p->x - q->x, dy = p->y - q->y, limit = reach * (p->r + q->r);
    if (!(dx * dx + dy * dy < limit * limit)) return true;
    if (list->n == list->room) {
        size_t room = 2 * list->room + 64;
        dem_pair *more = realloc(list->pairs, room * sizeof *more);
        if (!more) return false;
        list->pairs = more;
        list->room = room;
    }
    list->pairs[list->n++] = a < b ? (dem_pair){a, b} : (dem_pair){b, a};
    return true;
}

static bool search(size_t n, const place *places, const dem_pile_disk *disks, double reach, double height,
                   pair_list *list)
{
    size_t above = 0; /* first disk of the band above that is not too far to the left */
    for (size_t i = 0; i < n; i++) {
        const place *p = &places[i];
        for (size_t j = i + 1; j < n && places[j].band == p->band && places[j].x - p->x < height; j++)
            if (!add_if_near(list, disks, reach, p->disk, places[j].disk)) return false;
        while (above < n && (places[above].band <= p->band ||
                             (places[above].band == p->band + 1 && places[above].x <= p->x - height)))
            above++;
        for (size_t j = above; j < n && places[j].band == p->band + 1 && places[j].x - p->x < height; j++)
            if (!add_if_near(list, disks, reach, p->disk, places[j].disk)) return false;
    }
    return true;
}

rp_status dem_bonds_find(size_t n, const dem_pile_disk *disks, double reach, dem_pair **bonds,
                         size_t *n_bonds)
{
    double r_max = 0;
    for (size_t i = 0; i < n; i++) r_max = fmax(r_max, disks[i].r);
    const double height = 2 * reach * r_max;
    place *places = malloc((n + 1) * sizeof *places);
    pair_list list = {0};
    bool good = places != NULL;
    if (good) {
        for (size_t i = 0; i < n; i++)
            places[i] = (place){floor(disks[i].y / height), disks[i].x, (uint32_t)i};
        qsort(places, n, sizeof *places, by_band);
        good = search(n, places, disks, reach, height, &list);
    }
    free(places);
    if (!good) {
        free(list.pairs);
        return rp_fail(RP_NO_MEMORY, "neighbours of %zu disks: out of memory", n);
    }
    if (list.n) qsort(list.pairs, list.n, sizeof *list.pairs, by_ends);
    *bonds = list.pairs;
    *n_bonds = list.n;
    return RP_OK;
}

/* Steepest push to the right and to the left on each disk, as slopes n_y/|n_x|: two pushes can add up to one
 * upwards if their slopes have a positive sum. */
static void push(double lean[2], double nx, double ny)
{
    const double slope = fabs(nx) > 0 ? ny / fabs(nx) : copysign(INFINITY, ny);
    if (nx >= 0) lean[0] = fmax(lean[0], slope);
    if (nx <= 0) lean[1] = fmax(lean[1], slope);
}

size_t dem_bonds_unsupported(size_t n, const dem_pile_disk *disks, const dem_pair *bonds, size_t n_bonds,
                             double reach, double *lean)
{
    for (size_t i = 0; i < n; i++) {
        const double hold = disks[i].y < reach * disks[i].r ? INFINITY : -INFINITY;
        lean[2 * i] = lean[2 * i + 1] = hold;
    }
    for (size_t k = 0; k < n_bonds; k++) {
        const dem_pile_disk *p = &disks[bonds[k].a], *q = &disks[bonds[k].b];
        push(&lean[2 * bonds[k].a], p->x - q->x, p->y - q->y);
        push(&lean[2 * bonds[k].b], q->x - p->x, q->y - p->y);
    }
    for (size_t i = 0; i < n; i++)
        if (!(lean[2 * i] + lean[2 * i + 1] > 1e-9)) return i;
    return n;
}
