/* The slope of a surface that falls to one side, by the three methods of Lee & Herrmann 1993. */
#include <math.h>

#include "angle/angle.h"
#include "core/arena.h"
#include "experiment/modules/module.h"
#include "stats/stats.h"

typedef struct {
    int falls, height, empty, parabola;
    double from, to;
} slope_params;

#define AT(field) offsetof(slope_params, field)
static const rp_param schema[] = {
    {"falls", "", RP_CHOICE, AT(falls), "right", "right | left", "side to which the surface falls"},
    {"height", "", RP_CHOICE, AT(height), "centre", ANG_HEIGHT_WORDS,
     "height of a surface bin, about d wide: highest centre - d/2 (at least 0), highest centre, or highest "
     "point"},
    {"empty", "", RP_CHOICE, AT(empty), "zero", ANG_EMPTY_WORDS, "empty bins have height 0, or are left out"},
    {"parabola", "", RP_CHOICE, AT(parabola), "free", ANG_PARABOLA_WORDS,
     "parabola of method 3: three coefficients, or through the origin"},
    {"from", "", RP_REAL, AT(from), "0", "[0, 1)",
     "fraction of the width that is left out, on the side that the surface falls from"},
    {"to", "", RP_REAL, AT(to), "1", "(0, 1]",
     "fraction of the width, from the same side, up to which bins are used"},
    {0}};

static const exp_output outputs[] = {
    {"_r1_deg", "degree", "slope from the first to the last surface bin"},
    {"_r2_deg", "degree", "slope of the straight line through the heights"},
    {"_r3_deg", "degree", "slope by the parabola through the running sum of heights"},
    {"_r3_error_deg", "degree", "standard error of method 3, from the scatter of the heights"},
    {"_r12_deg", "degree", "slope by method 1 minus slope by method 2"},
    {"_r23_deg", "degree", "slope by method 2 minus slope by method 3"},
    {"_cells", "", "number of surface bins that hold a grain, including those left out"},
    {0}};

/* The columns of a surface that count, [first, first + n). Afterwards ang_surface_free, also after an error.
 */
static rp_status find_columns(const exp_view *s, const slope_params *p, ang_surface *surface, size_t *first,
                              size_t *n)
{
    const ang_options options = {s->d, (ang_height)p->height, (ang_empty)p->empty, (ang_parabola)p->parabola};
    const double ground = isfinite(s->lo[1]) ? s->lo[1] : 0.0;
    RP_SCOPE(memory);
    double *x;
    *first = *n = 0;
    if (!(s->hi[0] - s->lo[0] >= 0.5 * s->d))
        return rp_fail(RP_NO_RESULT, "the region goes from x = %g to %g, less than a surface bin", s->lo[0],
                       s->hi[0]);
    RP_NEW(&memory, x, 3 * s->n);
    double *y = x + s->n, *r = y + s->n;
    for (size_t i = 0; i < s->n; i++) {
        x[i] = p->falls ? s->hi[0] - s->grains[i].x : s->grains[i].x - s->lo[0];
        y[i] = s->grains[i].y - ground, r[i] = s->grains[i].r;
    }
    RP_TRY(ang_surface_make(s->n, x, y, r, s->hi[0] - s->lo[0], &options, surface));
    const double lo = ceil(p->from * (double)surface->n_cells - 1e-9),
                 hi = floor(p->to * (double)surface->n_cells + 1e-9);
    for (size_t k = 0; k < surface->n; k++) {
        *first += (double)surface->column[k] < lo;
        *n += (double)surface->column[k] >= lo && (double)surface->column[k] < hi;
    }
    return *n >= 3 ? RP_OK : rp_fail(RP_NO_RESULT, "%zu surface bins, at least 3 needed", *n);
}

static rp_status slopes_of(const ang_surface *s, size_t first, size_t n, int parabola,
                           ang_slope slopes[ANG_N_METHODS])
{
    return ang_slopes(n, s->column + first, s->h + first, s->cell, (ang_parabola)parabola, slopes);
}

static const double degree = 180.0 / M_PI;

static rp_status evaluate(const exp_view *s, const void *params, double out[])
{
    const slope_params *p = params;
    RP_ENDS(ang_surface_free) ang_surface surface = {0};
    ang_slope slopes[ANG_N_METHODS];
    size_t first, n;
    RP_TRY(find_columns(s, p, &surface, &first, &n));
    RP_TRY(slopes_of(&surface, first, n, p->parabola, slopes));
    for (int k = 0; k < ANG_N_METHODS; k++) out[k] = slopes[k].theta * degree;
    out[3] = slopes[2].theta_se * degree;
    out[4] = out[0] - out[1], out[5] = out[1] - out[2];
    out[6] = (double)surface.n_occupied;
    return RP_OK;
}

EXP_MODULE(slope,
           "slope of a surface that falls to one side, with heights above y = 0 or the region's lower end",
           "no_pile", schema, slope_params, outputs, EXP_BOUNDED, .evaluate = evaluate);

/* ---- what else the surface says ---- */

typedef struct {
    slope_params slope;
    double mu;
} surface_params;

#define OF_SURFACE(field) offsetof(surface_params, field)
static const rp_param surface_schema[] = {{"falls", "", RP_CHOICE, OF_SURFACE(slope.falls), "right",
                                           "right | left", "side to which the surface falls"},
                                          {"mu", "", RP_REAL, OF_SURFACE(mu), "none", "[0, inf) | none",
                                           "coefficient of friction of the floor, for theta_t"},
                                          {0}};

static const exp_output surface_outputs[] = {
    {"_scatter", "d", "root mean square deviation of the heights from their straight line"},
    {"_steepest_deg", "degree",
     "slope of the steepest straight line through two fifths of the bins in a row"},
    {"_theta_t_deg", "degree",
     "tilt at which a pile of this slope (method 3) slides, by (4) of Lee & Herrmann 1993, balanced"},
    {0}};

static rp_status evaluate_surface(const exp_view *s, const void *params, double out[])
{
    const surface_params *p = params;
    slope_params whole = p->slope;
    RP_ENDS(ang_surface_free) ang_surface surface = {0};
    RP_SCOPE(memory);
    double *x;
    size_t first, n;
    ang_slope slopes[ANG_N_METHODS];
    ang_tilt_result theory;
    stats_line line;
    whole.from = 0.0, whole.to = 1.0;
    RP_TRY(find_columns(s, &whole, &surface, &first, &n));
    RP_NEW(&memory, x, n);
    for (size_t k = 0; k < n; k++) x[k] = (double)surface.column[first + k];
    RP_TRY(stats_line_fit(&(stats_xy){n, x, surface.h + first, NULL}, false, &line));
    out[0] = sqrt(line.chi2 / (double)n) / s->d;
    const size_t part = (2 * n + 4) / 5;
    for (size_t k = 0; k + part <= n && part >= 3; k++) {
        RP_TRY(slopes_of(&surface, first + k, part, ANG_PARABOLA_FREE, slopes));
        out[1] = fmax(out[1], slopes[1].theta * degree);
    }
    RP_TRY(slopes_of(&surface, first, n, ANG_PARABOLA_FREE, slopes));
    if (isinf(p->mu) || slopes[2].theta < 0.0) return RP_OK;
    RP_TRY(ang_tilt(ANG_BALANCED, p->mu, slopes[2].theta, M_PI / 3.0, &theory));
    out[2] = theory.theta_t * degree;
    return RP_OK;
}

EXP_MODULE(surface,
           "scatter and steepest part of a surface that falls to one side, and the tilt at which it slides "
           "by (4) of Lee & Herrmann 1993",
           "no_pile", surface_schema, surface_params, surface_outputs, EXP_BOUNDED,
           .evaluate = evaluate_surface);
