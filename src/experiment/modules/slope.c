/* The slope of a surface that falls to one side, by the three methods of Lee & Herrmann 1993. */
#include <math.h>
#include <stdlib.h>

#include "angle/angle.h"
#include "experiment/modules/module.h"

typedef struct {
    int falls, height, empty, parabola;
    double from, to;
} slope_params;

#define AT(field) offsetof(slope_params, field)
static const rp_param schema[] = {
    {"falls", "", RP_CHOICE, AT(falls), "right", "right | left", "side to which the surface falls"},
    {"height", "", RP_CHOICE, AT(height), "centre", ANG_HEIGHT_WORDS, "of a column of width about d"},
    {"empty", "", RP_CHOICE, AT(empty), "zero", ANG_EMPTY_WORDS, "height of an empty column"},
    {"parabola", "", RP_CHOICE, AT(parabola), "free", ANG_PARABOLA_WORDS, "of method 3"},
    {"from", "", RP_REAL, AT(from), "0", "[0, 1)",
     "share of the width that is left out, on the side that the surface falls from"},
    {"to", "", RP_REAL, AT(to), "1", "(0, 1]",
     "share of the width, from there, where the columns that are used end"},
    {0}};

static const exp_output outputs[] = {
    {"_r1_deg", "degree", "slope from the first to the last column"},
    {"_r2_deg", "degree", "slope of the straight line"},
    {"_r3_deg", "degree", "slope by the parabola through the running sum of heights"},
    {"_r3_error_deg", "degree", "standard error of the last, from the scatter of the heights"},
    {"_r12_deg", "degree", "the first less the second"},
    {"_r23_deg", "degree", "the second less the third"},
    {"_cells", "", "columns that hold a grain"},
    {0}};

static rp_status evaluate(const exp_view *s, const void *params, double out[])
{
    static const double degree = 180.0 / M_PI;
    const slope_params *p = params;
    const ang_options options = {s->d, (ang_height)p->height, (ang_empty)p->empty, (ang_parabola)p->parabola};
    const double ground = isfinite(s->lo[1]) ? s->lo[1] : 0.0;
    ang_surface surface = {0};
    ang_slope slopes[ANG_N_METHODS];
    double *x = malloc((3 * s->n + 1) * sizeof *x), *y = x + s->n, *r = y + s->n;
    if (!x) return rp_fail(RP_NO_MEMORY, "slope: out of memory");
    for (size_t i = 0; i < s->n; i++) {
        x[i] = p->falls ? s->hi[0] - s->grains[i].x : s->grains[i].x - s->lo[0];
        y[i] = s->grains[i].y - ground, r[i] = s->grains[i].r;
    }
    rp_status status = ang_surface_make(s->n, x, y, r, s->hi[0] - s->lo[0], &options, &surface);
    size_t first = 0, n = 0;
    const double lo = ceil(p->from * (double)surface.n_cells - 1e-9),
                 hi = floor(p->to * (double)surface.n_cells + 1e-9);
    for (size_t k = 0; k < surface.n && !status; k++) {
        first += (double)surface.column[k] < lo;
        n += (double)surface.column[k] >= lo && (double)surface.column[k] < hi;
    }
    if (!status && n < 3) status = rp_fail(RP_NO_RESULT, "%zu columns, at least 3 needed", n);
    if (!status)
        status =
            ang_slopes(n, surface.column + first, surface.h + first, surface.cell, options.parabola, slopes);
    if (!status) {
        for (int k = 0; k < ANG_N_METHODS; k++) out[k] = slopes[k].theta * degree;
        out[3] = slopes[2].theta_se * degree;
        out[4] = out[0] - out[1], out[5] = out[1] - out[2];
        out[6] = (double)surface.n_occupied;
    }
    ang_surface_free(&surface);
    free(x);
    return status;
}

const exp_module exp_module_slope = {
    .name = "slope",
    .about = "slope of a surface that falls to one side, over y = 0 or the region's lower end",
    .word = "no_pile",
    .schema = schema,
    .size = sizeof(slope_params),
    .outputs = outputs,
    .bounded = true,
    .evaluate = evaluate};
