/* Calibration tested on piles whose parameters are known; see calibrate.h. */
#include <gsl/gsl_randist.h>
#include <math.h>
#include <stdlib.h>

#include "stats/calibrate_private.h"

static rp_status invert_case(const stats_calibration *c, stats_case *k)
{
    rp_status status = stats_calibration_invert(c, &k->measured, k->found);
    for (size_t p = 0; !status && p < c->n_params; p++) {
        const stats_calibrated *f = &k->found[p];
        k->covered[p] = false;
        for (size_t i = 0; i < f->n_solutions; i++)
            k->covered[p] |= !(k->truth[p] < f->solutions[i].lower || k->truth[p] > f->solutions[i].upper);
    }
    return status;
}

/* Point g of `points`, measured, with the pile-to-pile scatter of the response `c` as known error. */
static rp_status measure_case(const stats_calibration *c, const stats_calibration *points, size_t g,
                              stats_case *k)
{
    for (size_t p = 0; p < c->n_params; p++) {
        k->truth[p] = points->x[p][g];
        if (!(k->truth[p] >= c->lo[p] && k->truth[p] <= c->hi[p]))
            return rp_fail(RP_BAD_INPUT, "planted parameter = %g: out of the response's range, [%g, %g]",
                           k->truth[p], c->lo[p], c->hi[p]);
    }
    for (size_t a = 0; a < c->n_angles; a++) {
        k->measured.angle[a] = points->mean[a][g];
        k->measured.error[a] = stats_calibration_sd(c, a, k->truth) / sqrt(points->number[a][g]);
    }
    return invert_case(c, k);
}

/* Every angle has piles. */
static bool is_whole(const stats_calibration *points, size_t g)
{
    bool whole = true;
    for (size_t a = 0; a < points->n_angles; a++) whole = whole && points->number[a][g] > 0.0;
    return whole;
}

rp_status stats_calibration_planted(const stats_calibration *c, const stats_ensemble *planted, size_t room,
                                    stats_case cases[], size_t *n)
{
    stats_calibration points;
    *n = 0;
    rp_status status = stats_points_make(planted, NULL, &points);
    for (size_t g = 0; !status && g < points.n_points && *n < room; g++)
        if (is_whole(&points, g)) status = measure_case(c, &points, g, &cases[(*n)++]);
    stats_calibration_free(&points);
    return status;
}

/* Some of the piles: `piles` points into x and angle. */
typedef struct {
    stats_ensemble piles;
    double *x[STATS_MAX_PARAMS], *angle[STATS_MAX_ANGLES];
} part;

static void copy_pile(const stats_ensemble *all, size_t i, part *to)
{
    size_t k = to->piles.n++;
    for (size_t p = 0; p < all->n_params; p++) to->x[p][k] = all->x[p][i];
    for (size_t a = 0; a < all->n_angles; a++) to->angle[a][k] = all->angle[a][i];
}

/* Divide the piles of each point at random into halves, the first of which may have one more. order[n]: a
 * sequence of all piles, which is shuffled. */
static void divide(const stats_ensemble *all, const size_t point_of[], size_t order[], gsl_rng *rng,
                   part halves[2])
{
    halves[0].piles.n = halves[1].piles.n = 0;
    gsl_ran_shuffle(rng, order, all->n, sizeof *order);
    for (size_t k = 0; k < all->n; k++) {
        size_t before = 0;
        for (size_t l = 0; l < k; l++) before += point_of[order[l]] == point_of[order[k]];
        copy_pile(all, order[k], &halves[before % 2]);
    }
}

static rp_status holdout_case(const stats_ensemble *fit, const stats_ensemble *rest, gsl_rng *rng,
                              stats_case *k)
{
    stats_calibration c = {0}, points = {0};
    rp_status status = stats_calibration_fit(fit, &c);
    if (!status) status = stats_points_make(rest, NULL, &points);
    size_t g = 0, n = points.n_points;
    if (!status && n > 0) g = gsl_rng_uniform_int(rng, n);
    for (size_t tried = 0; !status && !is_whole(&points, g % n); g++)
        if (++tried >= n) status = rp_fail(RP_BAD_INPUT, "no piles with every angle to hold out");
    if (!status) status = measure_case(&c, &points, g % n, k);
    stats_calibration_free(&points);
    stats_calibration_free(&c);
    return status;
}

rp_status stats_calibration_holdout(const stats_ensemble *piles, size_t n_cases, gsl_rng *rng,
                                    stats_case cases[])
{
    enum { N_BLOCKS = 2 * (STATS_MAX_PARAMS + STATS_MAX_ANGLES) };
    const size_t n = piles->n;
    part halves[2] = {{.piles = *piles}, {.piles = *piles}};
    stats_calibration points = {0};
    size_t *point_of = malloc((2 * n + 1) * sizeof *point_of), *order = point_of + n;
    double *block = malloc((N_BLOCKS * n + 1) * sizeof *block), *next = block;
    rp_status status = point_of && block ? stats_points_make(piles, point_of, &points)
                                         : rp_fail(RP_NO_MEMORY, "calibrate: out of memory");
    stats_calibration_free(&points);
    for (int h = 0; !status && h < 2; h++) {
        for (size_t p = 0; p < piles->n_params; p++, next += n) halves[h].piles.x[p] = halves[h].x[p] = next;
        for (size_t a = 0; a < piles->n_angles; a++, next += n)
            halves[h].piles.angle[a] = halves[h].angle[a] = next;
    }
    for (size_t i = 0; !status && i < n; i++) order[i] = i;
    for (size_t k = 0; !status && k < n_cases; k++) {
        divide(piles, point_of, order, rng, halves);
        status = holdout_case(&halves[0].piles, &halves[1].piles, rng, &cases[k]);
    }
    free(point_of);
    free(block);
    return status;
}
