/* How the grains of a pile have moved from their marks, otherwise than the pile as a whole; and where. */
#include <gsl/gsl_math.h>
#include <gsl/gsl_sort.h>
#include <string.h>

#include "core/arena.h"
#include "core/elementary.h"
#include "experiment/modules/module.h"
#include "stats/stats.h"

/* Zones: quarters of the width, from the left; of each the surface, the inside and the floor. */
enum { QUARTERS = 4, SURFACE = 0, BULK = 1, BASE = 2, LAYERS = 3 };
enum { NONAFFINE, SHARE, MOVES_X, MOVES_Y, MOVES_DEPTH, REACH, ALL_X, ALL_Y, ALL_DEPTH, MOVED };
#define ZONE(k)                                                                                              \
    {"_surface_" #k, "", "share of the grains that have moved 0.1 d: surface, 1.5 d, quarter " #k},          \
        {"_inside_" #k, "", "the same of the inside, quarter " #k},                                          \
        {"_floor_" #k, "", "the same of the floor, grains lower than d, quarter " #k},
static const exp_output outputs[] = {
    {"_nonaffine", "d", "root mean square displacement less the best affine one"},
    {"_share", "", "share of these squares in those of the displacement about its mean"},
    {"_x", "", "distance from the left end over the width, mean over the grains with the squares as weights"},
    {"_y", "d", "the same of the height over y = 0, or over the region's lower end"},
    {"_depth", "d", "the same of the depth below the surface"},
    {"_reach", "d", "displacement that 5 % of the grains exceed"},
    {"_all_x", "", "distance from the left end over the width, mean over the grains"},
    {"_all_y", "d", "height over the same, mean over the grains"},
    {"_all_depth", "d", "depth below the surface, mean over the grains"},
    ZONE(1) ZONE(2) ZONE(3) ZONE(4){0}};

/* A grain that had a mark in the region: this place, its depth below the highest of its column, displacement;
 * lengths in d. */
typedef struct {
    double x, y, depth, ux, uy, square;
} place;

static bool mark_of(const exp_view *s, uint32_t id, double at[2])
{
    if (id > s->n_marks) return false;
    memcpy(at, &s->marks[2 * (id - 1)], 2 * sizeof *at);
    return at[0] > s->lo[0] && at[0] < s->hi[0] && at[1] > s->lo[1] && at[1] < s->hi[1];
}

static size_t column_of(double x, double width, size_t n)
{
    return (size_t)fmin(x / (width / (double)n), (double)n - 1.0);
}

/* Of the grains that are still there. Columns are those of the surface, about d wide. */
static rp_status find_places(const exp_view *s, rp_arena *arena, place *p, size_t *found)
{
    const double width = s->hi[0] - s->lo[0];
    const size_t columns = (size_t)fmax(round(width / s->d), 1.0);
    const double ground = isfinite(s->lo[1]) ? s->lo[1] : 0.0;
    double *top, at[2];
    RP_NEW(arena, top, columns);
    for (size_t k = 0; k < columns; k++) top[k] = -INFINITY;
    for (uint32_t id = 1; id <= s->n_marks; id++)
        if (mark_of(s, id, at)) {
            double *t = &top[column_of(at[0] - s->lo[0], width, columns)];
            *t = fmax(*t, at[1]);
        }
    *found = 0;
    for (const dem_state *g = s->all; g < s->all + s->n_all; g++) {
        double x = g->x, y = g->y;
        if (!mark_of(s, g->id, at) || (s->kind && g->kind != s->kind)) continue;
        dem_box_frame(s->sim, &x, &y);
        p[(*found)++] = (place){
            at[0] - s->lo[0],   at[1] - ground,     top[column_of(at[0] - s->lo[0], width, columns)] - at[1],
            (x - at[0]) / s->d, (y - at[1]) / s->d, 0.0};
    }
    return RP_OK;
}

/* Squares of the displacements less the best affine one; *about_mean: about the mean one. */
static rp_status take_affine(const exp_view *s, rp_arena *arena, size_t n, place p[], double *about_mean)
{
    enum { TERMS = 3 };
    double *X, *u[2], c[2][TERMS], covariance[TERMS * TERMS], mean[2] = {0.0};
    RP_NEW(arena, X, TERMS * n);
    RP_NEW(arena, u[0], n);
    RP_NEW(arena, u[1], n);
    for (size_t i = 0; i < n; i++) {
        X[TERMS * i] = 1.0, X[TERMS * i + 1] = p[i].x / s->d, X[TERMS * i + 2] = p[i].y / s->d;
        u[0][i] = p[i].ux, u[1][i] = p[i].uy;
        mean[0] += p[i].ux, mean[1] += p[i].uy;
    }
    for (int k = 0; k < 2; k++) {
        stats_linear fit = {n, TERMS, X, u[k], NULL, GSL_DBL_EPSILON, c[k], covariance};
        RP_TRY(stats_linear_fit(&fit));
    }
    *about_mean = 0.0;
    for (size_t i = 0; i < n; i++) {
        const double *x = &X[TERMS * i];
        p[i].square = gsl_pow_2(p[i].ux - c[0][0] - c[0][1] * x[1] - c[0][2] * x[2]) +
                      gsl_pow_2(p[i].uy - c[1][0] - c[1][1] * x[1] - c[1][2] * x[2]);
        *about_mean += gsl_pow_2(p[i].ux - mean[0] / (double)n) + gsl_pow_2(p[i].uy - mean[1] / (double)n);
    }
    return RP_OK;
}

static void note_zones(const exp_view *s, size_t n, const place p[], double out[])
{
    double moved[QUARTERS][LAYERS] = {{0}}, all[QUARTERS][LAYERS] = {{0}};
    for (size_t i = 0; i < n; i++) {
        const int quarter = (int)(QUARTERS * p[i].x / (s->hi[0] - s->lo[0]));
        const bool surface = p[i].depth / s->d < 1.5;
        const int layer = surface ? SURFACE : p[i].y < s->d ? BASE : BULK;
        all[quarter][layer] += 1.0;
        moved[quarter][layer] += gsl_pow_2(p[i].ux) + gsl_pow_2(p[i].uy) > 0.01;
    }
    for (int k = 0; k < QUARTERS; k++)
        for (int j = 0; j < LAYERS; j++) out[MOVED + LAYERS * k + j] = moved[k][j] / all[k][j];
}

static rp_status evaluate(const exp_view *s, const void *params, double out[])
{
    RP_SCOPE(arena);
    place *p;
    double *reach, about_mean, sum = 0.0, width = s->hi[0] - s->lo[0];
    size_t n;
    (void)params;
    RP_NEW(&arena, p, s->n_all);
    RP_NEW(&arena, reach, s->n_all);
    RP_TRY(find_places(s, &arena, p, &n));
    if (n < 4) return rp_fail(RP_NO_RESULT, "%zu grains with a mark in the region, at least 4 needed", n);
    RP_TRY(take_affine(s, &arena, n, p, &about_mean));
    for (int k = MOVES_X; k < MOVED; k++) out[k] = 0.0;
    for (size_t i = 0; i < n; i++) {
        const double at[3] = {p[i].x / width, p[i].y / s->d, p[i].depth / s->d};
        sum += p[i].square;
        for (int k = 0; k < 3; k++) out[MOVES_X + k] += p[i].square * at[k], out[ALL_X + k] += at[k];
        reach[i] = rp_hypot(p[i].ux, p[i].uy);
    }
    gsl_sort(reach, 1, n);
    for (int k = 0; k < 3; k++) out[MOVES_X + k] /= sum, out[ALL_X + k] /= (double)n;
    out[NONAFFINE] = sqrt(sum / (double)n), out[SHARE] = sum / about_mean;
    out[REACH] = reach[(size_t)(0.95 * ((double)n - 1.0))];
    note_zones(s, n, p, out);
    return RP_OK;
}

EXP_MODULE(motion, "displacements from the marks in a region, less the best affine one", "no_pile",
           exp_no_keys, char, outputs, EXP_BOUNDED, .evaluate = evaluate);
