/* Calibration tested on piles whose parameters are known; see calibrate.h. */
#include <gsl/gsl_randist.h>
#include <math.h>
#include <stdlib.h>

#include "stats/calibrate.h"

static rp_status invert_case(const stats_calibration *c, stats_case *k)
{
    RP_TRY(stats_calibration_invert(c, &k->measured, k->found));
    for (size_t p = 0; p < c->n_params; p++) {
        const stats_calibrated *f = &k->found[p];
        k->covered[p] = false;
        for (size_t i = 0; i < f->n_solutions; i++)
            k->covered[p] |= !(k->truth[p] < f->solutions[i].lower || k->truth[p] > f->solutions[i].upper);
    }
    return RP_OK;
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
    rp_status status = stats_points_make(planted, &points);
    for (size_t g = 0; !status && g < points.n_points && *n < room; g++)
        if (is_whole(&points, g)) status = measure_case(c, &points, g, &cases[(*n)++]);
    stats_calibration_free(&points);
    return status;
}

/* Divide the piles of each point at random into halves, the first of which may have one more: each half has
 * all piles, but NaN for the angles of the other one. */
static void divide(const stats_ensemble *all, stats_calibration *points, gsl_rng *rng,
                   double *angle[2][STATS_MAX_ANGLES])
{
    for (size_t g = 0; g < points->n_points; g++) {
        size_t *pile = points->pile + points->first[g], n = points->first[g + 1] - points->first[g];
        gsl_ran_shuffle(rng, pile, n, sizeof *pile);
        for (size_t k = 0; k < n; k++)
            for (size_t a = 0; a < all->n_angles; a++) {
                angle[k % 2][a][pile[k]] = all->angle[a][pile[k]];
                angle[1 - k % 2][a][pile[k]] = NAN;
            }
    }
}

static rp_status holdout_case(const stats_ensemble *fit, const stats_ensemble *rest, gsl_rng *rng,
                              stats_case *k)
{
    stats_calibration c = {0}, points = {0};
    rp_status status = stats_points_make(rest, &points);
    size_t g = 0, n = points.n_points;
    if (!status && n > 0) g = gsl_rng_uniform_int(rng, n);
    for (size_t tried = 0; !status && (n == 0 || !is_whole(&points, g % n)); g++)
        if (++tried >= n) status = rp_fail(RP_BAD_INPUT, "no piles with every angle to hold out");
    if (!status) status = stats_calibration_fit(fit, &c);
    if (!status) status = measure_case(&c, &points, g % n, k);
    stats_calibration_free(&points);
    stats_calibration_free(&c);
    return status;
}

rp_status stats_calibration_holdout(const stats_ensemble *piles, size_t n_cases, gsl_rng *rng,
                                    stats_case cases[])
{
    stats_ensemble halves[2] = {*piles, *piles};
    stats_calibration points;
    double *angle[2][STATS_MAX_ANGLES] = {{NULL}};
    double *block = malloc((2 * STATS_MAX_ANGLES * piles->n + 1) * sizeof *block), *next = block;
    rp_status status = stats_points_make(piles, &points);
    if (!status && !block) status = rp_fail(RP_NO_MEMORY, "calibrate: out of memory");
    for (int h = 0; !status && h < 2; h++)
        for (size_t a = 0; a < piles->n_angles; a++, next += piles->n)
            halves[h].angle[a] = angle[h][a] = next;
    for (size_t k = 0; !status && k < n_cases; k++) {
        divide(piles, &points, rng, angle);
        status = holdout_case(&halves[0], &halves[1], rng, &cases[k]);
    }
    stats_calibration_free(&points);
    free(block);
    return status;
}
