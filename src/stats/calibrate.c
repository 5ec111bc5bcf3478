/* From measured angles to parameters: the inverse of the response; see calibrate.h. */
#include <gsl/gsl_cdf.h>
#include <gsl/gsl_randist.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "stats/calibrate_private.h"
#include "stats/stats.h"

/* Values of a parameter that are scanned, alone or for each value of the other one. */
enum { SCAN_ONE = 400, SCAN_TWO = 80, SCAN_OTHER = 40 };
static const double confidence = 0.95, match_level = 0.01;

typedef struct {
    const stats_calibration *c;
    const stats_measured *m;
} problem;

static const char *const texts[][2] = {
#define X(name, word, meaning) {word, meaning},
    STATS_CALIBRATED_LIST(X)
#undef X
};

const char *stats_calibrated_word(stats_calibrated_status status)
{
    return texts[status][0];
}

const char *stats_calibrated_meaning(stats_calibrated_status status)
{
    return texts[status][1];
}

/* Measured less response, and the covariance of that: measured or simulated, the two angles are of the same
 * piles. */
static void difference(const problem *s, const double x[], double d[2], double covariance[3])
{
    double v[STATS_MAX_ANGLES] = {0.0, 0.0};
    covariance[1] = 0.0;
    for (size_t a = 0; a < s->c->n_angles; a++) {
        d[a] = s->m->angle[a] - stats_response_value(&s->c->response[a], x, &v[a]);
        covariance[2 * a] = v[a] + s->m->error[a] * s->m->error[a];
    }
    if (s->c->n_angles == 2)
        covariance[1] = s->c->correlation * (sqrt(v[0] * v[1]) + s->m->error[0] * s->m->error[1]);
}

static double chi2_at(const problem *s, const double x[])
{
    double d[2], v[3];
    difference(s, x, d, v);
    if (s->c->n_angles == 1) return d[0] * d[0] / v[0];
    return (v[2] * d[0] * d[0] - 2.0 * v[1] * d[0] * d[1] + v[0] * d[1] * d[1]) / (v[0] * v[2] - v[1] * v[1]);
}

static double objective(unsigned n, const double *x, double *gradient, void *data)
{
    (void)n, (void)gradient;
    return chi2_at(data, x);
}

static double scanned(const problem *s, size_t p, int i, int n)
{
    return s->c->lo[p] + (s->c->hi[p] - s->c->lo[p]) * i / n;
}

/* Least chi2 with parameter p in [from, to], from the best scanned value of the other one; x is left there.
 */
static rp_status descend(problem *s, size_t p, double from, double to, double x[], double *chi2)
{
    double lo[2] = {from, from}, hi[2] = {to, to};
    const size_t other = 1 - p;
    x[p] = 0.5 * (from + to);
    *chi2 = HUGE_VAL;
    for (int i = 0; s->c->n_params == 2 && i <= SCAN_OTHER; i++) {
        double y[2];
        y[p] = x[p];
        y[other] = scanned(s, other, i, SCAN_OTHER);
        double value = chi2_at(s, y);
        if (value < *chi2) *chi2 = value, x[other] = y[other];
    }
    if (s->c->n_params == 2) {
        double part = (s->c->hi[other] - s->c->lo[other]) / SCAN_OTHER;
        lo[other] = fmax(s->c->lo[other], x[other] - part);
        hi[other] = fmin(s->c->hi[other], x[other] + part);
    } else if (to == from) {
        *chi2 = chi2_at(s, x);
        return RP_OK;
    }
    return stats_descend(objective, s, (unsigned)s->c->n_params, lo, hi, x, chi2);
}

static rp_status profile(problem *s, size_t p, double value, double *chi2)
{
    double x[2];
    return descend(s, p, value, value, x, chi2);
}

/* The parameters with the least chi2, searched over the whole range. */
static rp_status search(const stats_calibration *c, const stats_measured *m, double x[], double *chi2)
{
    problem s = {c, m};
    const int n = c->n_params == 1 ? SCAN_ONE : SCAN_OTHER;
    double best[2] = {NAN, NAN};
    *chi2 = HUGE_VAL;
    for (int i = 0; i <= n; i++)
        for (int j = 0; j <= (c->n_params == 2 ? n : 0); j++) {
            double y[2] = {scanned(&s, 0, i, n), c->n_params == 2 ? scanned(&s, 1, j, n) : 0.0};
            double value = chi2_at(&s, y);
            if (value < *chi2) *chi2 = value, memcpy(best, y, sizeof best);
        }
    double lo[2], hi[2];
    for (size_t p = 0; p < c->n_params; p++) {
        double part = (s.c->hi[p] - s.c->lo[p]) / n;
        lo[p] = fmax(s.c->lo[p], best[p] - part);
        hi[p] = fmin(s.c->hi[p], best[p] + part);
        x[p] = best[p];
    }
    return stats_descend(objective, &s, (unsigned)c->n_params, lo, hi, x, chi2);
}

/* Where the profile passes `limit`, between a value inside and one outside. */
static rp_status crossing(problem *s, size_t p, double inside, double outside, double limit, double *at)
{
    const double tolerance = 1e-9 * (s->c->hi[p] - s->c->lo[p]);
    while (fabs(outside - inside) > tolerance) {
        double middle = 0.5 * (inside + outside), chi2;
        rp_status status = profile(s, p, middle, &chi2);
        if (status) return status;
        if (chi2 <= limit)
            inside = middle;
        else
            outside = middle;
    }
    *at = 0.5 * (inside + outside);
    return RP_OK;
}

/* The end of the interval around `inside`, in the direction `step` along the scan; NaN if the range cuts it.
 */
static rp_status find_end(problem *s, size_t p, const double scan[], int n, int from, int step, double inside,
                          double limit, double *end)
{
    *end = NAN;
    for (int i = from; i >= 0 && i <= n; i += step)
        if (scan[i] > limit)
            return crossing(s, p, inside, scanned(s, p, i, n), limit, end);
        else
            inside = scanned(s, p, i, n);
    return RP_OK;
}

/* A minimum of the profile near scanned value number i: a new solution, or a better value of the last one. */
static rp_status add_solution(problem *s, size_t p, const double scan[], int n, int i, double limit,
                              stats_calibrated *r, double *best)
{
    double x[2], chi2, value = scanned(s, p, i, n);
    rp_status status =
        descend(s, p, scanned(s, p, i > 0 ? i - 1 : i, n), scanned(s, p, i < n ? i + 1 : i, n), x, &chi2);
    if (status) return status;
    if (chi2 <= scan[i])
        value = x[p];
    else
        chi2 = scan[i];
    if (chi2 > limit) return RP_OK;
    if (r->n_solutions > 0) {
        double upper = r->solutions[r->n_solutions - 1].upper;
        if (isnan(upper) || value <= upper) {
            if (chi2 < *best) *best = chi2, r->solutions[r->n_solutions - 1].value = value;
            return RP_OK;
        }
    }
    if (r->n_solutions == STATS_MAX_SOLUTIONS) return RP_OK;
    size_t k = r->n_solutions++;
    *best = chi2;
    r->solutions[k].value = value;
    int below = scanned(s, p, i, n) < value ? i : i - 1;
    status = find_end(s, p, scan, n, below, -1, value, limit, &r->solutions[k].lower);
    return status ? status : find_end(s, p, scan, n, below + 1, 1, value, limit, &r->solutions[k].upper);
}

static rp_status find_intervals(problem *s, size_t p, double limit, stats_calibrated *r)
{
    double scan[SCAN_ONE + 1], best = HUGE_VAL;
    const int n = s->c->n_params == 1 ? SCAN_ONE : SCAN_TWO;
    rp_status status = RP_OK;
    for (int i = 0; !status && i <= n; i++) status = profile(s, p, scanned(s, p, i, n), &scan[i]);
    for (int i = 0; !status && i <= n; i++)
        if ((i == 0 || scan[i] <= scan[i - 1]) && (i == n || scan[i] <= scan[i + 1]))
            status = add_solution(s, p, scan, n, i, limit, r, &best);
    return status;
}

/* Delta method: the inverse of J' S^-1 J, with J the slopes of the responses at x. */
static void standard_errors(const problem *s, const double x[], stats_calibrated result[])
{
    double jacobian[2][2] = {{0.0}}, d[2], v[3] = {0.0, 0.0, 0.0}, unused;
    const size_t n_params = s->c->n_params, n_angles = s->c->n_angles;
    for (size_t p = 0; p < n_params; p++) {
        double up[2] = {x[0], x[1]}, down[2] = {x[0], x[1]}, h = 1e-5 * (s->c->hi[p] - s->c->lo[p]);
        up[p] = fmin(x[p] + h, s->c->hi[p]);
        down[p] = fmax(x[p] - h, s->c->lo[p]);
        for (size_t a = 0; a < n_angles; a++)
            jacobian[a][p] = (stats_response_value(&s->c->response[a], up, &unused) -
                              stats_response_value(&s->c->response[a], down, &unused)) /
                             (up[p] - down[p]);
    }
    difference(s, x, d, v);
    double inverse[2][2] = {{1.0 / v[0], 0.0}, {0.0, 0.0}};
    if (n_angles == 2) {
        double det = v[0] * v[2] - v[1] * v[1];
        memcpy(inverse, (double[2][2]){{v[2] / det, -v[1] / det}, {-v[1] / det, v[0] / det}}, sizeof inverse);
    }
    double f[2][2] = {{0.0}};
    for (size_t p = 0; p < n_params; p++)
        for (size_t q = 0; q < n_params; q++)
            for (size_t a = 0; a < n_angles; a++)
                for (size_t b = 0; b < n_angles; b++)
                    f[p][q] += jacobian[a][p] * inverse[a][b] * jacobian[b][q];
    if (n_params == 1) {
        result[0].se = sqrt(1.0 / f[0][0]);
        return;
    }
    double det = f[0][0] * f[1][1] - f[0][1] * f[1][0];
    for (size_t p = 0; p < 2; p++) result[p].se = sqrt(f[1 - p][1 - p] / det);
}

static rp_status check_measured(const stats_calibration *c, const stats_measured *m)
{
    for (size_t a = 0; a < c->n_angles; a++) {
        if (!isfinite(m->angle[a]))
            return rp_fail(RP_BAD_INPUT, "angle %zu = %g: not finite", a + 1, m->angle[a]);
        if (!(m->error[a] >= 0.0 && isfinite(m->error[a])))
            return rp_fail(RP_BAD_INPUT, "error of angle %zu = %g: out of range, allowed: [0, inf)", a + 1,
                           m->error[a]);
    }
    return RP_OK;
}

/* Nothing in the range agrees. One parameter and one angle: beyond which end, if the response goes on as it
 * does. */
static void no_match(const problem *s, const double x[], stats_calibrated result[])
{
    bool at_end = x[0] == s->c->lo[0] || x[0] == s->c->hi[0];
    for (size_t p = 0; p < s->c->n_params; p++) result[p].status = STATS_CALIBRATED_NO_MATCH;
    if (s->c->n_params == 2 || s->c->n_angles == 2 || !at_end || !s->c->response[0].monotone) return;
    bool above = x[0] == s->c->hi[0];
    result[0].status = above ? STATS_CALIBRATED_ABOVE_RANGE : STATS_CALIBRATED_BELOW_RANGE;
    result[0].n_solutions = 1;
    result[0].solutions[0].value = NAN;
    result[0].solutions[0].lower = above ? x[0] : NAN;
    result[0].solutions[0].upper = above ? NAN : x[0];
}

static void judge(const problem *s, size_t p, stats_calibrated *r)
{
    bool no_lower = isnan(r->solutions[0].lower), no_upper = isnan(r->solutions[r->n_solutions - 1].upper);
    r->value = r->solutions[0].value;
    if (!(r->se < s->c->hi[p] - s->c->lo[p])) r->se = NAN; /* flat there: no straight line */
    if (s->c->n_params > s->c->n_angles)
        r->status = STATS_CALIBRATED_UNDERDETERMINED;
    else if (r->n_solutions > 1)
        r->status = STATS_CALIBRATED_SEVERAL;
    else if (no_lower && no_upper)
        r->status = STATS_CALIBRATED_NOT_IDENTIFIED;
    else
        r->status = no_upper   ? STATS_CALIBRATED_AT_LEAST
                    : no_lower ? STATS_CALIBRATED_AT_MOST
                               : STATS_CALIBRATED_OK;
    if (r->status == STATS_CALIBRATED_OK || r->status == STATS_CALIBRATED_AT_LEAST ||
        r->status == STATS_CALIBRATED_AT_MOST)
        return;
    r->value = r->se = NAN;
    if (r->status != STATS_CALIBRATED_SEVERAL) r->solutions[0].value = NAN;
}

rp_status stats_calibration_invert(const stats_calibration *c, const stats_measured *measured,
                                   stats_calibrated result[])
{
    problem s = {c, measured};
    double x[2] = {NAN, NAN}, chi2;
    for (size_t p = 0; p < c->n_params; p++)
        result[p] =
            (stats_calibrated){.value = NAN, .se = NAN, .boot_se = NAN, .boot_lower = NAN, .boot_upper = NAN};
    rp_status status = check_measured(c, measured);
    if (!status) status = search(c, measured, x, &chi2);
    if (status) return status;
    double dof = (double)(c->n_angles > c->n_params ? c->n_angles - c->n_params : c->n_angles);
    if (gsl_cdf_chisq_Q(chi2, dof) < match_level) {
        no_match(&s, x, result);
        return RP_OK;
    }
    standard_errors(&s, x, result);
    for (size_t p = 0; !status && p < c->n_params; p++) {
        status = find_intervals(&s, p, chi2 + gsl_cdf_chisq_Pinv(confidence, 1.0), &result[p]);
        if (!status) judge(&s, p, &result[p]);
    }
    return status;
}

/* ---- bootstrap ---- */

/* Piles sorted by point: those of point g are pile[first[g]] to pile[first[g + 1] - 1]. */
typedef struct {
    const stats_ensemble *piles;
    size_t *point_of, *pile, *first;
    double *y; /* of the points, for each angle */
} resampler;

static rp_status resampler_make(resampler *s, const stats_ensemble *piles, size_t n_points)
{
    stats_calibration points;
    *s = (resampler){.piles = piles};
    s->point_of = calloc(2 * piles->n + n_points + 2, sizeof *s->point_of);
    s->y = calloc(n_points * STATS_MAX_ANGLES, sizeof *s->y);
    if (!s->point_of || !s->y) return rp_fail(RP_NO_MEMORY, "calibrate: out of memory");
    s->pile = s->point_of + piles->n;
    s->first = s->pile + piles->n;
    rp_status status = stats_points_make(piles, s->point_of, &points);
    stats_calibration_free(&points);
    if (status) return status;
    for (size_t i = 0; i < piles->n; i++) s->first[s->point_of[i] + 2]++;
    for (size_t g = 2; g < n_points + 2; g++) s->first[g] += s->first[g - 1];
    for (size_t i = 0; i < piles->n; i++) s->pile[s->first[s->point_of[i] + 1]++] = i;
    return RP_OK;
}

/* Means of piles drawn again within each point, the same for both angles. Their spread is that of n piles
 * with n, not n - 1, below the root: made up for. */
static void resample(resampler *s, const stats_calibration *c, gsl_rng *rng)
{
    for (size_t g = 0; g < c->n_points; g++) {
        size_t first = s->first[g], n = s->first[g + 1] - first;
        double sum[STATS_MAX_ANGLES] = {0.0, 0.0}, number[STATS_MAX_ANGLES] = {0.0, 0.0};
        for (size_t k = 0; k < n; k++) {
            size_t i = s->pile[first + gsl_rng_uniform_int(rng, n)];
            for (size_t a = 0; a < c->n_angles; a++)
                if (!isnan(s->piles->angle[a][i])) {
                    sum[a] += s->piles->angle[a][i];
                    number[a] += 1.0;
                }
        }
        for (size_t a = 0; a < c->n_angles; a++) {
            double mean = c->mean[a][g], m = c->number[a][g];
            double drawn = number[a] > 0.0 ? sum[a] / number[a] : mean;
            s->y[a * c->n_points + g] = mean + sqrt(m / (m - 1.0)) * (drawn - mean);
        }
    }
}

rp_status stats_calibration_bootstrap(const stats_ensemble *piles, const stats_calibration *c,
                                      const stats_measured *measured, size_t n_resamples, gsl_rng *rng,
                                      stats_calibrated result[])
{
    resampler s = {0};
    size_t n = 0;
    rp_status status = stats_check_resamples(n_resamples);
    if (status) return status;
    double *values = malloc(n_resamples * STATS_MAX_PARAMS * sizeof *values);
    status = resampler_make(&s, piles, c->n_points);
    if (!status && !values) status = rp_fail(RP_NO_MEMORY, "calibrate: out of memory");
    for (size_t k = 0; !status && k < n_resamples; k++) {
        stats_calibration again = *c; /* shares the points */
        stats_measured m = *measured;
        double x[2], chi2;
        resample(&s, c, rng);
        double draw[2];
        gsl_ran_bivariate_gaussian(rng, 1.0, 1.0, c->correlation, &draw[0], &draw[1]);
        for (size_t a = 0; a < c->n_angles; a++) m.angle[a] += draw[a] * m.error[a];
        for (size_t a = 0; !status && a < c->n_angles; a++)
            status = stats_response_solve(&again.response[a], c, a, s.y + a * c->n_points);
        if (!status) status = search(&again, &m, x, &chi2);
        if (status == RP_NO_RESULT) { /* no scale: the resample says nothing */
            status = RP_OK;
            continue;
        }
        for (size_t p = 0; !status && p < c->n_params; p++) values[p * n_resamples + n] = x[p];
        n++;
    }
    for (size_t p = 0; !status && n > 1 && p < c->n_params; p++) {
        const stats_spread spread = stats_resampled(n, values + p * n_resamples);
        if (!isfinite(result[p].value)) continue;
        result[p].boot_se = spread.sd;
        result[p].boot_lower = spread.lo;
        result[p].boot_upper = spread.hi;
    }
    free(s.point_of);
    free(s.y);
    free(values);
    return status;
}
