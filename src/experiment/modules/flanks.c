/* The two flanks of a heap: straight lines from the highest point outwards. */
#include <math.h>

#include "angle/angle.h"
#include "core/arena.h"
#include "core/elementary.h"
#include "experiment/modules/module.h"

typedef struct {
    double from, to;
    bool touching;
} flanks_params;

#define AT(field) offsetof(flanks_params, field)
static const rp_param schema[] = {
    {"from", "", RP_REAL, AT(from), "0.1", "[0, 1)",
     "lowest height that counts, as a fraction of the height of the heap"},
    {"to", "", RP_REAL, AT(to), "0.9", "(0, 1]", "highest height that counts, likewise"},
    {"touching", "", RP_BOOL, AT(touching), "true", "",
     "whether only the largest cluster of touching grains counts, without grains that fly or have run out"},
    {0}};

enum { LEFT, RIGHT, MEAN, LEFT_ERROR, RIGHT_ERROR, MEAN_ERROR, HEIGHT, APEX, WIDTH };
static const exp_output outputs[] = {
    {"_left_deg", "degree", "slope of the left flank"},
    {"_right_deg", "degree", "slope of the right flank"},
    {"_mean_deg", "degree", "mean of the two slopes"},
    {"_left_error_deg", "degree", "standard error, from the scatter of the heights"},
    {"_right_error_deg", "degree", "standard error, from the scatter of the heights"},
    {"_mean_error_deg", "degree", "standard error, from the scatter of the heights"},
    {"_height", "cm", "highest point of the heap above y = 0 or the region's lower end"},
    {"_apex", "cm", "x of the highest point"},
    {"_width", "cm", "distance from the leftmost to the rightmost point"},
    {0}};

/* The flank on one side of the apex's column: the columns outwards until one is empty or below the lowest
 * height, those that are not above the highest; these move together. */
static rp_status flank(ang_surface *s, size_t apex, int side, const flanks_params *p, double out[])
{
    static const char *const names[] = {"left", "right"};
    enum { LEAST = 3 };
    const double top = s->h[apex];
    ang_slope slopes[ANG_N_METHODS];
    size_t lo = apex, hi = apex, n = 0;
    for (size_t k = apex; k < s->n; side ? k++ : k--) { /* below 0 it ends too */
        const size_t gone = side ? s->column[k] - s->column[apex] : s->column[apex] - s->column[k];
        if (s->h[k] < p->from * top || gone != (side ? k - apex : apex - k)) break;
        *(side ? &hi : &lo) = k;
    }
    for (size_t k = lo; k <= hi; k++)
        if (s->h[k] <= p->to * top) s->column[lo + n] = s->column[k], s->h[lo + n++] = s->h[k];
    if (n < LEAST)
        return rp_fail(RP_NO_RESULT, "%zu surface bins on the %s flank; %d or more expected", n, names[side],
                       LEAST);
    RP_TRY(ang_slopes(n, s->column + lo, s->h + lo, s->cell, ANG_PARABOLA_FREE, slopes));
    out[side] = (side ? 1.0 : -1.0) * slopes[1].theta * (180.0 / M_PI);
    out[LEFT_ERROR + side] = slopes[1].theta_se * (180.0 / M_PI);
    return RP_OK;
}

static rp_status evaluate(const exp_view *s, const void *params, double out[])
{
    const flanks_params *p = params;
    const double ground = isfinite(s->lo[1]) ? s->lo[1] : 0.0;
    const ang_options options = {s->d, ANG_TOP, ANG_EMPTY_SKIP, ANG_PARABOLA_FREE};
    double left = INFINITY, right = -INFINITY, top = -INFINITY, apex = NAN, *x;
    RP_ENDS(ang_surface_free) ang_surface surface = {0};
    RP_SCOPE(memory);
    size_t column = 0;
    dem_state *cluster;
    const dem_state *grains = s->grains;
    size_t n = s->n;
    if (p->touching) {
        RP_TRY(exp_largest_cluster(s, &memory, &cluster, &n));
        grains = cluster;
    }
    if (n == 0) return rp_fail(RP_NO_RESULT, "no grains that move");
    RP_NEW(&memory, x, 3 * n);
    double *y = x + n, *r = y + n;
    for (size_t i = 0; i < n; i++) {
        r[i] = grains[i].r, y[i] = grains[i].y - ground, x[i] = grains[i].x;
        left = fmin(left, x[i] - r[i]), right = fmax(right, x[i] + r[i]);
        if (y[i] + r[i] > top) top = y[i] + r[i], apex = x[i];
    }
    /* columns one diameter wide, the middle one about the apex */
    const double beside = ceil((apex - left) / s->d), columns = beside + 1.0 + ceil((right - apex) / s->d);
    for (size_t i = 0; i < n; i++) x[i] = x[i] - apex + (beside + 0.5) * s->d;
    RP_TRY(ang_surface_make(n, x, y, r, columns * s->d, &options, &surface));
    while (column + 1 < surface.n && (double)surface.column[column] < beside) column++;
    for (int side = 0; side < 2; side++) RP_TRY(flank(&surface, column, side, p, out));
    out[MEAN] = 0.5 * (out[LEFT] + out[RIGHT]);
    out[MEAN_ERROR] = 0.5 * rp_hypot(out[LEFT_ERROR], out[RIGHT_ERROR]);
    out[HEIGHT] = top, out[APEX] = apex, out[WIDTH] = right - left;
    return RP_OK;
}

EXP_MODULE(flanks, "both flanks of a heap, by straight lines from the highest point outwards", "no_pile",
           schema, flanks_params, outputs, EXP_ON_CONTACTS, .evaluate = evaluate);
