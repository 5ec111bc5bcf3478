/* Filling: at random without overlap (random sequential addition), found through square cells; in rows. */
#include <math.h>

#include "core/elementary.h"
#include "core/random.h"
#include "dem/scene/radii.h"
#include "dem/scene/scene.h"

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

/* `grains`: all, those that are there first. */
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

/* An odd number of sides to the right of the point. */
bool dem_in_polygon(size_t n, const double points[], double x, double y)
{
    bool in = false;
    for (size_t k = 0; k < n; k++) {
        const double *p = &points[2 * k], *q = &points[2 * ((k + 1) % n)];
        if ((p[1] > y) != (q[1] > y) && x < p[0] + (y - p[1]) / (q[1] - p[1]) * (q[0] - p[0])) in = !in;
    }
    return in;
}

static bool in_corners(const dem_fill *f, double x, double y)
{
    return f->n_corners == 0 || dem_in_polygon(f->n_corners, f->corners, x, y);
}

/* Distance of a point from a wall at the start, negative behind a whole line; INFINITY of one that is gone.
 */
static double distance_of(const dem_wall *w, double x, double y)
{
    const double dx = x - w->point[0], dy = y - w->point[1],
                 along = dx * w->direction[1] - dy * w->direction[0],
                 above = dx * w->direction[0] + dy * w->direction[1];
    if (w->open_at_step == 0 && isinf(w->open_speed)) return INFINITY;
    return dem_wall_is_line(w) ? above
                               : rp_hypot(along - fmin(fmax(along, w->extent[0]), w->extent[1]), above);
}

static bool is_clear(const dem_fill *f, double x, double y, double distance)
{
    for (size_t w = 0; w < f->n_walls; w++)
        if (distance_of(&f->walls[w], x, y) < distance) return false;
    return true;
}

/* The largest part of a region that walls cut: of nodes at which a body of 0.42 of the smallest radius
 * touches no wall, each with the next ones. At a distance of 0.8 no wall fits between two of them, and from a
 * place of a grain the way to the nearest node is free. */
typedef struct {
    long nx, *up; /* nodes of a row; another node of the same part, -1 at a wall; NULL: the region is one */
    double h;
    long largest; /* the node that the others of the part lead up to */
} space;
static const double MOST_NODES = 1e7;

static long top_of(long *up, long k)
{
    while (up[k] != k) k = up[k] = up[up[k]];
    return k;
}

static rp_status find_space(const dem_fill *f, double r_min, rp_arena *memory, space *s)
{
    long *up, *size;
    *s = (space){.h = 0.8 * r_min};
    if (f->n_walls == 0 || !((f->W / s->h + 1.0) * (f->H / s->h + 1.0) < MOST_NODES)) return RP_OK;
    s->nx = (long)(f->W / s->h) + 1;
    const long n = s->nx * ((long)(f->H / s->h) + 1);
    RP_NEW(memory, up, (size_t)n);
    RP_NEW(memory, size, (size_t)n);
    s->up = up;
    for (long k = 0; k < n; k++) {
        const double x = f->x0 + s->h * (double)(k % s->nx), y = f->y0 + s->h * (double)(k / s->nx);
        up[k] = is_clear(f, x, y, 0.42 * r_min) ? k : -1;
        if (up[k] >= 0 && k % s->nx && up[k - 1] >= 0) up[k] = top_of(up, k - 1);
        if (up[k] >= 0 && k >= s->nx && up[k - s->nx] >= 0) up[top_of(up, k)] = top_of(up, k - s->nx);
    }
    for (long k = 0; k < n; k++)
        if (up[k] >= 0 && ++size[top_of(up, k)] > size[s->largest]) s->largest = top_of(up, k);
    return RP_OK;
}

/* May a grain that touches no other be here? */
static bool is_inside(const dem_fill *f, const space *s, place p)
{
    if (!in_corners(f, f->x0 + p.x, f->y0 + p.y)) return false;
    if (!is_clear(f, f->x0 + p.x, f->y0 + p.y, (1.0 - 1e-9) * p.r)) return false;
    const bool inside =
        !s->up || top_of(s->up, lround(p.y / s->h) * s->nx + lround(p.x / s->h)) == s->largest;
    if (!inside && f->cut) *f->cut = true;
    return inside;
}

static void put_in_cell(cells *c, double x, double y, long i)
{
    const long cx = (long)fmin(fmax(x / c->size, 0.0), (double)(c->nx - 1)),
               cy = (long)fmin(fmax(y / c->size, 0.0), (double)(c->ny - 1));
    c->next[i] = c->head[cy * c->nx + cx];
    c->head[cy * c->nx + cx] = i;
}

/* Those that are there, and reach into the region. */
static void put_there(cells *c, const dem_fill *f, const dem_grain *all)
{
    for (size_t i = 0; i < f->n_there; i++) {
        const double x = all[i].x - f->x0, y = all[i].y - f->y0, r = all[i].r;
        if (x > -r && x < f->W + r && y > -r && y < f->H + r) put_in_cell(c, x, y, (long)i);
    }
}

static dem_grain grain_of(const dem_fill *f, double x, double y, double r)
{
    return (dem_grain){.x = x,
                       .y = y,
                       .r = r,
                       .m = dem_mass(f->shape, f->density, r),
                       .fixed = f->fixed,
                       .kind = f->of_kind};
}

static rp_status no_room(const dem_fill *f, long i, double r)
{
    return rp_fail(RP_NO_RESULT,
                   "no room for grain %ld of N = %ld, of radius %g, in W = %g, H = %g%s: %ld "
                   "have room; fewer or smaller grains, or a larger region",
                   i + 1, f->N, r, f->W, f->H, f->n_walls ? " on the inner side of the walls" : "", i);
}

static rp_status place_all(const dem_fill *f, const space *s, cells *c, rp_random *places, dem_grain *grains)
{
    dem_grain *const all = grains - f->n_there;
    put_there(c, f, all);
    for (long i = 0; i < f->N; i++) {
        const double r = grains[i].r;
        double x, y;
        long tries = 0;
        do {
            if (tries++ == MAX_TRIES || 2.0 * r > f->W || 2.0 * r > f->H) return no_room(f, i, r);
            x = r + (f->W - 2.0 * r) * rp_random_uniform(places);
            y = r + (f->H - 2.0 * r) * rp_random_uniform(places);
        } while (!is_free(c, all, f, (place){x, y, r}) || !is_inside(f, s, (place){x, y, r}));
        grains[i] = grain_of(f, f->x0 + x, f->y0 + y, r);
        put_in_cell(c, x, y, (long)f->n_there + i);
    }
    return RP_OK;
}

/* A stream of this fill: its own, which ends with the memory, or one that goes on when it is filled. */
static rp_random *stream_of(const dem_fill *f, rp_purpose purpose, rp_arena *memory)
{
    const bool places = purpose == RP_PURPOSE_PLACES;
    const long of = f->number == 0 ? purpose : RP_PURPOSE_FILLS + 2 * (f->number - 1) + places;
    return f->streams[places]
               ? f->streams[places]
               : rp_random_in(memory, (unsigned long)f->seed, (unsigned long)f->run, (rp_purpose)of);
}

rp_status dem_fill_place(const dem_fill *fill, dem_grain *grains)
{
    RP_SCOPE(memory);
    rp_random *const places = stream_of(fill, RP_PURPOSE_PLACES, &memory);
    space s;
    double r_max = 0.0, r_min = INFINITY;
    for (long i = 0; i < fill->N; i++) r_max = fmax(r_max, grains[i].r), r_min = fmin(r_min, grains[i].r);
    for (size_t i = 1; i <= fill->n_there; i++) r_max = fmax(r_max, grains[-(long)i].r);
    /* no more than some four cells a grain, however large the region */
    const double most = 2.0 * sqrt((double)fill->N) + 8.0;
    cells c = {.size = fmax(2.0 * r_max, fmax(fill->W, fill->H) / most)};
    c.nx = (long)(fill->W / c.size) + 1;
    c.ny = (long)(fill->H / c.size) + 1;
    RP_NEW(&memory, c.head, (size_t)(c.nx * c.ny));
    RP_NEW(&memory, c.next, (size_t)fill->N + fill->n_there);
    for (long k = 0; k < c.nx * c.ny; k++) c.head[k] = -1;
    if (!places) return RP_NO_MEMORY;
    RP_TRY(find_space(fill, r_min, &memory, &s));
    return place_all(fill, &s, &c, places, grains);
}

/* From left to right, each on y0 and touching the last, or a larger one before: (r + r')^2 = dx^2 +
 * (r - r')^2. */
static size_t place_row(const dem_fill *f, rp_random *radii, size_t most, dem_grain *grains)
{
    double r = dem_radius_draw(f, radii), x = r;
    size_t n = 0;
    while (n < most && x + r <= f->W * (1.0 + 1e-12)) {
        if (in_corners(f, f->x0 + x, f->y0 + r)) grains[n++] = grain_of(f, f->x0 + x, f->y0 + r, r);
        const double next = dem_radius_draw(f, radii);
        x = fmax(next, x + (f->spacing > 0.0 ? f->spacing : 2.0 * sqrt(r * next)));
        for (const dem_grain *g = grains + n; !(f->spacing > 0.0) && g-- > grains;) {
            if (g->x - f->x0 + 2.0 * sqrt(dem_radius_most(f) * next) <= x) break;
            x = fmax(x, g->x - f->x0 + 2.0 * (1.0 - 1e-12) * sqrt(g->r * next)); /* of the last to the bit */
        }
        r = next;
    }
    return n;
}

/* Rows of places that the largest grain has room in, each row moved by half a place against the last. */
static size_t place_lattice(const dem_fill *f, rp_random *radii, size_t most, dem_grain *grains)
{
    const double widest = f->spacing > 0.0 ? 0.5 * f->spacing : dem_radius_most(f);
    size_t n = 0;
    for (long row = 0; n < most; row++) {
        const double y = widest * (1.0 + sqrt(3.0) * (double)row);
        if (y + widest > f->H * (1.0 + 1e-12)) break;
        for (long k = 0; n < most; k++) {
            const double x = widest * (1.0 + 2.0 * (double)k + (double)(row % 2));
            if (x + widest > f->W * (1.0 + 1e-12)) break;
            if (in_corners(f, f->x0 + x, f->y0 + y))
                grains[n++] = grain_of(f, f->x0 + x, f->y0 + y, dem_radius_draw(f, radii));
        }
    }
    return n;
}

static double ratio_up(double length, double least)
{
    return fmin(length / (2.0 * least) + 2.0, 2.0 * DEM_MOST_GRAINS);
}

size_t dem_fill_most(const dem_fill *f)
{
    if (f->N >= 0) return (size_t)f->N;
    const double least = f->spacing > 0.0 ? 0.5 * f->spacing : dem_radius_least(f),
                 row = ratio_up(f->W, least);
    return (size_t)fmin(f->pattern == DEM_PATTERN_ROW ? row : row * ratio_up(f->H, 0.8 * least),
                        2.0 * DEM_MOST_GRAINS);
}

static rp_status place_rows(const dem_fill *f, rp_random *radii, dem_grain *grains, size_t *n)
{
    const size_t most = dem_fill_most(f);
    const double overlap = f->spacing > 0.0 ? DEM_SPACING_OVERLAP : 1e-9;
    const char *const pattern = f->pattern == DEM_PATTERN_ROW ? "row" : "lattice";
    *n = f->pattern == DEM_PATTERN_ROW ? place_row(f, radii, most, grains)
                                       : place_lattice(f, radii, most, grains);
    if (f->N >= 0 && *n < most) return no_room(f, (long)*n, dem_radius_mean(f));
    if (*n == 0)
        return rp_fail(RP_NO_RESULT, "no place for a grain of a row or lattice in W = %g, H = %g", f->W,
                       f->H);
    for (size_t i = 0; i < *n; i++) {
        const dem_grain *g = &grains[i];
        if (!f->fixed && !is_clear(f, g->x, g->y, (1.0 - overlap) * g->r))
            return rp_fail(RP_NO_RESULT, "grain %zu of a %s, at x = %g, y = %g, touches a wall", i + 1,
                           pattern, g->x, g->y);
        for (size_t k = 1; k <= f->n_there; k++) {
            const dem_grain *b = &grains[-(long)k];
            if (rp_hypot(b->x - g->x, b->y - g->y) < (b->r + g->r) * (1.0 - overlap))
                return rp_fail(RP_NO_RESULT,
                               "grain %zu of a %s, at x = %g, y = %g, touches one that is there", i + 1,
                               pattern, g->x, g->y);
        }
    }
    return RP_OK;
}

rp_status dem_fill_grains(const dem_fill *f, dem_grain *grains, size_t *n)
{
    RP_SCOPE(memory);
    const bool row = f->pattern == DEM_PATTERN_ROW;
    if ((unsigned)f->pattern >= DEM_PATTERNS(DEM_ONE) || (unsigned)f->law >= DEM_RADIUS_LAWS(DEM_ONE) ||
        (unsigned)f->by >= DEM_SHARES(DEM_ONE) || (unsigned)f->shape >= DEM_SHAPES(DEM_ONE))
        return rp_fail(RP_BAD_INPUT, "fill: pattern = %d, law = %d, by = %d, shape = %d: no such choice",
                       (int)f->pattern, (int)f->law, (int)f->by, (int)f->shape);
    if (!(f->W >= 0.0 && isfinite(f->W)) || !(f->H >= 0.0) || (isinf(f->H) && !row) ||
        !isfinite(f->x0 + f->y0 + f->spacing + f->density))
        return rp_fail(RP_BAD_INPUT,
                       "fill: W = %g, H = %g, x0 = %g, y0 = %g, spacing = %g, density = %g: must be finite, "
                       "W and H at least 0",
                       f->W, f->H, f->x0, f->y0, f->spacing, f->density);
    if (f->N < 0 && f->pattern == DEM_PATTERN_RANDOM)
        return rp_fail(RP_BAD_INPUT, "fill: N = %ld: must be at least 0", f->N);
    if (f->law != DEM_RADII_TABLE &&
        !(f->radius_mean > 0.0 && f->radius_width >= 0.0 && isfinite(f->radius_mean + f->radius_width)))
        return rp_fail(RP_BAD_INPUT,
                       "fill: radius_mean = %g, radius_width = %g: must be finite, above 0 and at least 0",
                       f->radius_mean, f->radius_width);
    RP_TRY(rp_prefix(dem_radii_check(f), "fill: "));
    rp_random *const radii = stream_of(f, RP_PURPOSE_RADII, &memory);
    if (!radii) return RP_NO_MEMORY;
    *n = (size_t)f->N;
    if (f->pattern != DEM_PATTERN_RANDOM) return place_rows(f, radii, grains, n);
    for (long i = 0; i < f->N; i++) grains[i].r = dem_radius_draw(f, radii);
    return dem_fill_place(f, grains);
}
