/* Surface h(x) of a pile and its slope: Lee & Herrmann 1993, section 3; see angle.h.
 *
 * Every slope is a linear combination of the heights, sum c_j h_j, so with independent scatter of variance
 * s^2 about the straight line its standard error is s sqrt(sum c_j^2). */
#include <float.h>
#include <gsl/gsl_sort.h>
#include <gsl/gsl_statistics_double.h>
#include <math.h>
#include <stdlib.h>

#include "angle/angle.h"
#include "core/arena.h"
#include "core/elementary.h"

static const double most_cells = 1e8;

static rp_status check_grains(size_t n, const double x[], const double y[], const double r[])
{
    for (size_t i = 0; i < n; i++) {
        if (!isfinite(x[i]) || !isfinite(y[i]))
            return rp_fail(RP_BAD_INPUT, "grain %zu: position (%g, %g): finite numbers expected", i + 1, x[i],
                           y[i]);
        if (r && !(r[i] > 0.0 && isfinite(r[i])))
            return rp_fail(RP_BAD_INPUT, "grain %zu: radius = %g: out of range, allowed: (0, inf)", i + 1,
                           r[i]);
    }
    return RP_OK;
}

static rp_status count_cells(double width, double diameter, size_t *n_cells)
{
    RP_TRY(rp_check_range("cell (nominal diameter)", diameter, DBL_MIN, DBL_MAX, "(0, inf)"));
    RP_TRY(rp_check_range("width", width, DBL_MIN, DBL_MAX, "(0, inf)"));
    double n = round(width / diameter);
    if (n < 1.0 || n > most_cells)
        return rp_fail(RP_BAD_INPUT, "width = %g: %g cells of %g, allowed: 1 to %g", width, n, diameter,
                       most_cells);
    *n_cells = (size_t)n;
    return RP_OK;
}

/* Highest value in each cell, -inf in an empty one. */
static void raise_surface(ang_surface *s, size_t n, const double x[], const double y[], const double r[],
                          double width)
{
    for (size_t j = 0; j < s->n_cells; j++) s->h[j] = -INFINITY;
    for (size_t i = 0; i < n; i++) {
        if (!(x[i] >= 0.0 && x[i] < width)) continue;
        size_t j = (size_t)(x[i] / s->cell);
        if (j >= s->n_cells) j = s->n_cells - 1; /* round-off next to the right edge */
        s->h[j] = fmax(s->h[j], r ? y[i] + r[i] : y[i]);
    }
}

/* Pack the cells in use to the front. */
static void finish_surface(ang_surface *s, const ang_options *options)
{
    for (size_t j = 0; j < s->n_cells; j++) {
        bool occupied = s->h[j] > -INFINITY;
        double h = occupied ? s->h[j] : 0.0;
        if (occupied && options->height == ANG_CENTRE) h = fmax(h - 0.5 * options->diameter, 0.0);
        s->n_occupied += occupied;
        if (!occupied && options->empty == ANG_EMPTY_SKIP) continue;
        s->column[s->n] = j;
        s->h[s->n++] = h;
    }
}

rp_status ang_surface_make(size_t n, const double x[], const double y[], const double r[], double width,
                           const ang_options *options, ang_surface *surface)
{
    *surface = (ang_surface){0};
    rp_status status = count_cells(width, options->diameter, &surface->n_cells);
    if (!status && options->height == ANG_TOP && !r)
        status = rp_fail(RP_BAD_INPUT, "height = top: the radii r are missing");
    if (!status) status = check_grains(n, x, y, options->height == ANG_TOP ? r : NULL);
    if (status) return status;
    surface->cell = width / (double)surface->n_cells;
    surface->column = malloc(surface->n_cells * sizeof *surface->column);
    surface->h = malloc(surface->n_cells * sizeof *surface->h);
    if (!surface->column || !surface->h)
        return rp_fail(RP_NO_MEMORY, "surface of %zu cells: out of memory", surface->n_cells);
    raise_surface(surface, n, x, y, options->height == ANG_TOP ? r : NULL, width);
    finish_surface(surface, options);
    if (surface->n_occupied < ANG_MIN_OCCUPIED)
        return rp_fail(RP_NO_RESULT, "no pile: %zu of %zu cells occupied, at least %d needed",
                       surface->n_occupied, surface->n_cells, ANG_MIN_OCCUPIED);
    return RP_OK;
}

void ang_surface_free(ang_surface *surface)
{
    free(surface->column);
    free(surface->h);
    *surface = (ang_surface){0};
}

/* The heights as the methods see them: x counts cells from the first. Lengths in cells until the end. */
typedef struct {
    size_t n;
    const double *x, *h;
    double width; /* of a cell; 0: of a line through points at any x */
} heights;

/* A slope downwards per cell, and the sum of its squared coefficients. */
typedef struct {
    double slope, gain;
} combination;

static combination end_to_end(const heights *s)
{
    double run = s->x[s->n - 1] - s->x[0];
    return (combination){(s->h[0] - s->h[s->n - 1]) / run, 2.0 / (run * run)};
}

/* Also the residual variance of h about the line, on n - 2 degrees of freedom. */
static combination straight_line(const heights *s, double *variance)
{
    double x = 0.0, h = 0.0, xx = 0.0, xh = 0.0, n = 0.0, first = 0.0, second = 0.0, squares = 0.0;
    for (size_t i = 0; i < s->n; i++) {
        n += 1.0;
        x += (s->x[i] - x) / n;
        h += (s->h[i] - h) / n;
    }
    n = 0.0;
    for (size_t i = 0; i < s->n; i++) {
        const double dx = s->x[i] - x, dh = s->h[i] - h, from_first = s->x[i] - s->x[0];
        n += 1.0;
        xx += (dx * dx - xx) / n;
        xh += (dx * dh - xh) / n;
        first += from_first;
        second += from_first * from_first;
    }
    const double slope = xh / xx;
    for (size_t i = 0; i < s->n; i++) {
        const double left = s->h[i] - h - slope * (s->x[i] - x);
        squares += left * left;
    }
    *variance = squares / (n - 2.0);
    return (combination){-slope, n / (n * second - first * first)};
}

/* Method 3. The parabola's second coefficient is sum e_k S_k / sum e_k^2, with e the part of z^2 that the
 * lower powers of z leave over; the slope is -2 times that. z counts cells: from the middle for the free
 * parabola (its origin does not matter, round-off does), from the left edge of the first cell for the
 * other, so that a straight h gives an exact parabola at the cells' right edges. S_k = sum of h up to k
 * turns this into a sum over h_j with the e_k from j onwards. Where g cells are left out before j, their
 * heights are taken midway between their neighbours', so that a straight h keeps its slope. Below a line, S_k
 * less half of h_k is the area from the first point on, whose mirror image has the mirrored slope. */
static combination running_sum(const heights *s, ang_parabola parabola)
{
    bool is_free = parabola == ANG_PARABOLA_FREE;
    double n = (double)s->n, start = is_free ? 0.0 : -1.0, m2 = 0.0, m3 = 0.0, norm = 0.0;
    for (size_t k = 0; is_free && k < s->n; k++) start += s->x[k] / n;
    for (size_t k = 0; k < s->n; k++) {
        double z = s->x[k] - start;
        m2 += z * z;
        m3 += z * z * z;
    }
    combination c = {0.0, 0.0};
    double tail = 0.0, shared = 0.0; /* sum of e from k on; what the gap after k adds to h_k */
    for (size_t k = s->n; k-- > 0;) {
        double z = s->x[k] - start;
        double e = z * z - m3 / m2 * z - (is_free ? m2 / n : 0.0);
        double gap = k > 0 ? s->x[k] - s->x[k - 1] - s->width : 0.0;
        norm += e * e;
        tail += e;
        double weight = s->width * tail + 0.5 * gap * tail + shared;
        shared = 0.5 * gap * tail;
        c.slope -= 2.0 * weight * s->h[k];
        c.gain += 4.0 * weight * weight;
    }
    return (combination){c.slope / norm, c.gain / (norm * norm)};
}

static rp_status find_slopes(const heights *s, double cell, ang_parabola parabola,
                             ang_slope slopes[ANG_N_METHODS])
{
    double variance;
    combination line = straight_line(s, &variance);
    combination all[ANG_N_METHODS] = {end_to_end(s), line, running_sum(s, parabola)};
    for (int i = 0; i < ANG_N_METHODS; i++) {
        double slope = all[i].slope / cell, se = sqrt(variance * all[i].gain) / cell;
        slopes[i] = (ang_slope){slope, se, rp_atan(slope), se / (1.0 + slope * slope)};
        if (!isfinite(slope + se))
            return rp_fail(RP_NO_RESULT, "no pile: numbers so large or small that their powers overflow");
    }
    return RP_OK;
}

rp_status ang_slopes(size_t n, const size_t column[], const double h[], double cell, ang_parabola parabola,
                     ang_slope slopes[ANG_N_METHODS])
{
    if (n < 3) return rp_fail(RP_BAD_INPUT, "slopes: %zu cells, at least 3 needed", n);
    RP_TRY(rp_check_range("cell", cell, DBL_MIN, DBL_MAX, "(0, inf)"));
    for (size_t k = 0; k < n; k++) {
        if (!isfinite(h[k])) return rp_fail(RP_BAD_INPUT, "height %zu = %g: not finite", k + 1, h[k]);
        if (column && k > 0 && column[k] <= column[k - 1])
            return rp_fail(RP_BAD_INPUT, "column %zu: numbers must ascend", k + 1);
    }
    double *x = malloc(n * sizeof *x);
    if (!x) return rp_fail(RP_NO_MEMORY, "slopes: out of memory");
    for (size_t k = 0; k < n; k++) x[k] = column ? (double)(column[k] - column[0]) : (double)k;
    const rp_status status = find_slopes(&(heights){n, x, h, 1.0}, cell, parabola, slopes);
    free(x);
    return status;
}

/* Of n points, leave the surface, from *first on in the order of x; returns its number of points. */
static size_t find_top(size_t n, double x[], double h[], size_t *first)
{
    static const double STEEPEST = 1.54; /* tan 57 degrees: pixels have no ties */
    double falling = -INFINITY, rising = -INFINITY;
    size_t m = 0;
    gsl_sort2(x, 1, h, 1, n);
    for (size_t k = 0; k < n; k++) {
        if (h[k] + STEEPEST * x[k] < falling) continue;
        falling = h[k] + STEEPEST * x[k];
        x[m] = x[k];
        h[m++] = h[k];
    }
    *first = m;
    for (size_t k = m; k-- > 0;) {
        if (h[k] - STEEPEST * x[k] < rising) continue;
        rising = h[k] - STEEPEST * x[k];
        x[--*first] = x[k];
        h[*first] = h[k];
    }
    return m - *first;
}

/* The points between two that are in the lowest and the highest tenth are a flank. */
static rp_status find_flanks(size_t n, const double x[], const double h[], ang_pile *pile)
{
    static const double TENTH = 0.1 + 1e-9, CLEAR = 3.0; /* standard errors */
    enum { LEAST = 4 };
    const double lo = gsl_stats_min(h, 1, n), height = gsl_stats_max(h, 1, n) - lo;
    size_t first = 0;
    int before = 0;
    size_t unclear = SIZE_MAX; /* points of a flank without a clear slope */
    for (size_t k = 0; k < n; k++) {
        const double part = (h[k] - lo) / height;
        const int now = part >= 1.0 - TENTH ? 1 : part <= TENTH ? -1 : 0;
        if (!now) continue;
        if (before == -now && pile->n_flanks++ < 2) {
            const size_t i = pile->n_flanks - 1, m = pile->n_flank[i] = k - first;
            ang_slope *s = pile->flank[i];
            if (m >= LEAST)
                RP_TRY(find_slopes(&(heights){m, x + first, h + first, 0.0}, 1.0, ANG_PARABOLA_FREE, s));
            if (!(fabs(s[1].slope) > CLEAR * s[1].slope_se)) unclear = m; /* 0 with fewer points */
        }
        before = now;
        first = k + 1;
    }
    /* a lone flank has a crown, a wall or the end of the grains on its other side, not half a slope */
    const double *end = pile->flank[0][1].slope > 0.0 ? h : h + n - 1;
    if (pile->n_flanks == 0)
        return rp_fail(RP_NO_RESULT, "no pile: no flank in a surface of %zu points, which is level or empty",
                       n);
    if (pile->n_flanks > 2)
        return rp_fail(RP_NO_RESULT, "no pile: %zu flanks, where a pile has 1 or 2", pile->n_flanks);
    if (unclear < SIZE_MAX)
        return rp_fail(
            RP_NO_RESULT,
            "no pile: a flank of %zu points without a clear slope: between the lowest and the highest "
            "tenth of the height it needs %d points or more, and a slope above %g of its errors",
            unclear, LEAST, CLEAR);
    if (pile->n_flanks == 1 && *end - lo < 0.5 * height)
        return rp_fail(RP_NO_RESULT,
                       "no pile: a flank of %zu points, and a second one that ends at %.2g of the height",
                       pile->n_flank[0], (*end - lo) / height);
    return RP_OK;
}

static rp_status find_within(size_t n, const double px[], const double py[], const double range[2],
                             ang_pile *pile)
{
    size_t m = 0, first;
    double *x = calloc(2 * n + 2, sizeof *x), *h = x + n + 1;
    *pile = (ang_pile){0};
    if (!x) return rp_fail(RP_NO_MEMORY, "surface of %zu points: out of memory", n);
    for (size_t i = 0; i < n; i++) {
        if (px[i] < range[0] || px[i] > range[1]) continue;
        x[m] = px[i] - px[0];
        h[m++] = py[i] - py[0];
    }
    pile->n = find_top(m, x, h, &first);
    const rp_status status = find_flanks(pile->n, x + first, h + first, pile);
    for (int k = 0; k < ANG_N_METHODS; k++) {
        const ang_slope *a = &pile->flank[0][k], *b = &pile->flank[pile->n_flanks == 2][k];
        const double theta = 0.5 * (fabs(a->theta) + fabs(b->theta)), t = rp_tan(theta);
        const double se = 0.5 * rp_hypot(a->theta_se, b->theta_se);
        pile->mean[k] = (ang_slope){t, se * (1.0 + t * t), theta, se};
    }
    free(x);
    return status;
}

/* Of the points with x in a range those between wide gaps, beyond which there are few; returns the number of
 * others, SIZE_MAX without memory. */
static size_t leave_strays(size_t n, const double px[], const double range[2], double within[2])
{
    double *x = calloc(n + 1, sizeof *x);
    size_t m = 0;
    if (!x) return SIZE_MAX;
    for (size_t i = 0; i < n; i++)
        if (px[i] >= range[0] && px[i] <= range[1]) x[m++] = px[i];
    gsl_sort(x, 1, m);
    const size_t few = m / 100 + 1;
    size_t first = 0, last = m - 1;
    if (m > 2 * few + 1) {
        const double wide = fmax(0.05, 3.0 / (double)m) * (x[m - 1 - few] - x[few]);
        for (size_t k = 0; k < few; k++) {
            if (x[k + 1] - x[k] > wide) first = k + 1;
            if (x[m - 1 - k] - x[m - 2 - k] > wide) last = m - 2 - k;
        }
    }
    if (m > 0) within[0] = x[first], within[1] = x[last];
    free(x);
    return m > 0 ? m - 1 - last + first : 0;
}

rp_status ang_pile_find(size_t n, const double px[], const double py[], const double range[2], ang_pile *pile)
{
    double within[2];
    ang_pile rest;
    const rp_status status = find_within(n, px, py, range, pile);
    const size_t strays = status == RP_NO_RESULT ? leave_strays(n, px, range, within) : 0;
    if (strays == SIZE_MAX) return rp_fail(RP_NO_MEMORY, "surface of %zu points: out of memory", n);
    if (strays == 0 || find_within(n, px, py, within, &rest)) return status;
    *pile = rest, pile->n_stray = strays;
    return RP_OK;
}

rp_status ang_one_sided(size_t n, const double x[], const double y[], const double ends[2], double diameter,
                        ang_slope *slope)
{
    static const double CLEAR = 3.0; /* standard errors */
    ang_options options = ANG_OPTIONS_DEFAULT;
    RP_SCOPE(memory);
    double *seen;
    RP_NEW(&memory, seen, n);
    *slope = (ang_slope){NAN, NAN, NAN, NAN};
    options.diameter = diameter;
    for (int mirrored = 0; mirrored < 2 && ends[0] < ends[1]; mirrored++) {
        RP_ENDS(ang_surface_free) ang_surface s;
        ang_slope slopes[ANG_N_METHODS];
        for (size_t i = 0; i < n; i++) seen[i] = mirrored ? ends[1] - x[i] : x[i] - ends[0];
        rp_status status = ang_surface_make(n, seen, y, NULL, ends[1] - ends[0], &options, &s);
        if (!status) status = ang_slopes(s.n, s.column, s.h, s.cell, options.parabola, slopes);
        if (status) return status == RP_NO_MEMORY ? status : RP_OK; /* too few cells: no slope */
        bool clear = 2 * s.n_occupied >= s.n_cells;
        for (int k = 0; k < ANG_N_METHODS && clear; k++) clear = slopes[k].slope > CLEAR * slopes[k].slope_se;
        if (clear) *slope = slopes[ANG_N_METHODS - 1];
    }
    return RP_OK;
}
