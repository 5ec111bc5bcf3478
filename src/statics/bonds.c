/* Neighbours by bands as high as the longest bond: disks of a band, and of the band above, in the order of x.
 * See bonds.h. */
#include "statics/bonds.h"

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
    const rp_pair *p = left, *q = right;
    if (p->a != q->a) return p->a < q->a ? -1 : 1;
    return (p->b > q->b) - (p->b < q->b);
}

static bool add_if_near(statics_network *net, size_t *room, uint32_t a, uint32_t b)
{
    const statics_disk *p = &net->disks[a], *q = &net->disks[b];
    const double dx = p->x - q->x, dy = p->y - q->y, limit = net->reach * (p->r + q->r);
    if (!(dx * dx + dy * dy < limit * limit)) return true;
    if (net->n_pairs == *room) {
        *room = 2 * *room + 64;
        rp_pair *more = realloc(net->pairs, *room * sizeof *more);
        if (!more) return false;
        net->pairs = more;
    }
    net->pairs[net->n_pairs++] = a < b ? (rp_pair){a, b} : (rp_pair){b, a};
    return true;
}

static bool search(statics_network *net, const place *places, double height)
{
    const size_t n = net->n;
    size_t room = 0, above = 0; /* first disk of the band above that is not too far to the left */
    for (size_t i = 0; i < n; i++) {
        const place *p = &places[i];
        for (size_t j = i + 1; j < n && places[j].band == p->band && places[j].x - p->x < height; j++)
            if (!add_if_near(net, &room, p->disk, places[j].disk)) return false;
        while (above < n && (places[above].band <= p->band ||
                             (places[above].band == p->band + 1 && places[above].x <= p->x - height)))
            above++;
        for (size_t j = above; j < n && places[j].band == p->band + 1 && places[j].x - p->x < height; j++)
            if (!add_if_near(net, &room, p->disk, places[j].disk)) return false;
    }
    return true;
}

rp_status statics_bonds_find(statics_network *net)
{
    double r_max = 0;
    for (size_t i = 0; i < net->n; i++) r_max = fmax(r_max, net->disks[i].r);
    const double height = 2 * net->reach * r_max;
    place *places = malloc((net->n + 1) * sizeof *places);
    for (size_t i = 0; places && i < net->n; i++)
        places[i] = (place){floor(net->disks[i].y / height), net->disks[i].x, (uint32_t)i};
    net->pairs = NULL;
    net->n_pairs = 0;
    if (places) qsort(places, net->n, sizeof *places, by_band);
    const bool found = places && search(net, places, height);
    free(places);
    if (!found) {
        free(net->pairs);
        *net = (statics_network){net->n, net->disks, net->reach, 0, NULL};
        return rp_fail(RP_NO_MEMORY, "neighbours of %zu disks: out of memory", net->n);
    }
    if (net->n_pairs) qsort(net->pairs, net->n_pairs, sizeof *net->pairs, by_ends);
    return RP_OK;
}

bool statics_bonds_has(const statics_network *net, rp_pair pair)
{
    return net->n_pairs && bsearch(&pair, net->pairs, net->n_pairs, sizeof pair, by_ends);
}

/* Steepest contact forces on a disk to the right and to the left, as slopes n_y/|n_x|. Two forces can hold a
 * weight if the sum of their slopes is positive. */
static void push(double lean[2], double nx, double ny)
{
    const double slope = fabs(nx) > 0 ? ny / fabs(nx) : copysign(INFINITY, ny);
    if (nx >= 0) lean[0] = fmax(lean[0], slope);
    if (nx <= 0) lean[1] = fmax(lean[1], slope);
}

size_t statics_bonds_unsupported(const statics_network *net, double *lean, size_t room, size_t *which)
{
    size_t found = 0;
    for (size_t i = 0; i < net->n; i++)
        lean[2 * i] = lean[2 * i + 1] = net->disks[i].y < net->reach * net->disks[i].r ? INFINITY : -INFINITY;
    for (size_t k = 0; k < net->n_pairs; k++) {
        const rp_pair ends = net->pairs[k];
        const statics_disk *p = &net->disks[ends.a], *q = &net->disks[ends.b];
        push(&lean[2 * ends.a], p->x - q->x, p->y - q->y);
        push(&lean[2 * ends.b], q->x - p->x, q->y - p->y);
    }
    for (size_t i = 0; i < net->n; i++)
        if (!(lean[2 * i] + lean[2 * i + 1] > 1e-9) && ++found <= room) which[found - 1] = i;
    return found;
}

/* ---- The pile of half the size ---- */

/* A disk's position on a lattice: number `along` of row `row`, in columns that lean to the right. */
typedef struct {
    long row, along;
    uint32_t disk, half; /* its number, and that in the pile of half the size, UINT32_MAX without */
} lattice_site;

static int by_site(const void *left, const void *right)
{
    const lattice_site *p = left, *q = right;
    if (p->row != q->row) return p->row < q->row ? -1 : 1;
    return (p->along > q->along) - (p->along < q->along);
}

/* Steps to the next site of a row and of a column, from a bond that leans to the right and one that leans to
 * the left; false if there is none. */
static bool lattice_steps(const statics_network *net, double along[2], double up[2])
{
    const double LEANS = 0.25; /* of a bond's length: less is level, or upright */
    double left[2] = {0, 0};
    up[0] = up[1] = 0;
    for (size_t k = 0; k < net->n_pairs && !(up[0] > 0 && left[0] < 0); k++) {
        const statics_disk *p = &net->disks[net->pairs[k].a], *q = &net->disks[net->pairs[k].b];
        const double sign = q->y > p->y ? 1 : -1, dx = sign * (q->x - p->x), dy = sign * (q->y - p->y);
        if (!(dy > LEANS * fabs(dx) && fabs(dx) > LEANS * dy)) continue;
        double *side = dx > 0 ? up : left;
        side[0] = dx;
        side[1] = dy;
    }
    for (int c = 0; c < 2; c++) along[c] = up[c] - left[c];
    return up[0] > 0 && left[0] < 0;
}

/* The disks' sites in order, counted from a lowest disk, and the pile of half the size; 0 if a disk is off
 * the lattice. */
static size_t take_half(const statics_network *net, const double along[2], const double up[2],
                        lattice_site *sites, statics_disk *half)
{
    const statics_disk *disks = net->disks;
    const double OFF = 0.1; /* of a step */
    const double det = along[0] * up[1] - along[1] * up[0];
    const statics_disk *origin = disks;
    size_t n_half = 0;
    for (size_t i = 0; i < net->n; i++)
        if (disks[i].y < origin->y) origin = &disks[i];
    for (size_t i = 0; i < net->n; i++) {
        const double dx = disks[i].x - origin->x, dy = disks[i].y - origin->y;
        const double x = (dx * up[1] - dy * up[0]) / det, y = (dy * along[0] - dx * along[1]) / det;
        if (!(fabs(x - rint(x)) < OFF && fabs(y - rint(y)) < OFF)) return 0;
        sites[i] = (lattice_site){lrint(y), lrint(x), (uint32_t)i, UINT32_MAX};
        if (sites[i].along % 2 || sites[i].row % 2) continue;
        sites[i].half = (uint32_t)n_half;
        half[n_half] = disks[i];
        half[n_half].x = disks[i].x / 2;
        half[n_half++].y = disks[i].r + (disks[i].y - disks[i].r) / 2;
    }
    qsort(sites, net->n, sizeof *sites, by_site);
    return n_half;
}

static uint32_t half_at(size_t n, const lattice_site *sites, long row, long along)
{
    const lattice_site *found =
        bsearch(&(lattice_site){.row = row, .along = along}, sites, n, sizeof *sites, by_site);
    return found ? found->half : UINT32_MAX;
}

rp_status statics_bonds_halve(const statics_network *net, statics_disk **half, size_t *n_half,
                              rp_pair *parents)
{
    const size_t n = net->n;
    double along[2], up[2];
    *n_half = 0;
    *half = NULL;
    if (!lattice_steps(net, along, up)) return RP_OK;
    lattice_site *sites = malloc(n * sizeof *sites);
    *half = malloc(n * sizeof **half);
    const bool good = sites && *half;
    if (good) *n_half = take_half(net, along, up, sites, *half);
    for (size_t i = 0; *n_half > 0 && i < n; i++) {
        const lattice_site at = sites[i];
        const long x = at.along % 2 != 0, y = at.row % 2 == 0 ? 0 : x ? -1 : 1;
        parents[at.disk] = (rp_pair){half_at(n, sites, at.row - y, at.along - x),
                                     half_at(n, sites, at.row + y, at.along + x)};
    }
    free(sites);
    return good ? RP_OK : rp_fail(RP_NO_MEMORY, "pile of %zu disks: out of memory", n);
}
