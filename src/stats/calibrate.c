/* From measured angles to parameters: the inverse of the response; see calibrate.h. */
#include <gsl/gsl_cdf.h>
#include <gsl/gsl_math.h>
#include <gsl/gsl_randist.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "stats/calibrate.h"
#include "stats/stats.h"

/* Values of a parameter that are scanned, alone or for each value of the other one. */
enum { SCAN_ONE = 400, SCAN_TWO = 80, SCAN_OTHER = 40 };
static const double confidence = 0.95, match_level = 0.01;

typedef struct {
    const stats_calibration *c;
    const stats_measured *m;
} problem;

const char *const stats_calibrated_words[] = {
#define X(name, word, meaning) word,
    STATS_CALIBRATED_LIST(X)};
#undef X
const char *const stats_calibrated_meanings[] = {
#define X(name, word, meaning) meaning,
    STATS_CALIBRATED_LIST(X)
#undef X
};

/* Covariance of measured less response at x: of the first angle, of both, of the second. Measured or
 * simulated, the two angles are of the same piles. A second angle that there is not has the variance 1. */
static void covariance(const problem *s, const double x[], double v[3])
{
    double fitted[STATS_MAX_ANGLES] = {0.0, 1.0};
    const double *error = s->m->error;
    for (size_t a = 0; a < s->c->n_angles; a++) stats_response_value(&s->c->response[a], x, &fitted[a]);
    v[0] = fitted[0] + error[0] * error[0];
    v[1] = 0.0;
    v[2] = fitted[1];
    if (s->c->n_angles == 1) return;
    v[1] = s->c->correlation * (sqrt(fitted[0] * fitted[1]) + error[0] * error[1]);
    v[2] += error[1] * error[1];
}

/* Two numbers of this covariance as independent ones of variance 1. */
static void whiten(const double v[3], double d[2])
{
    d[0] /= sqrt(v[0]);
    d[1] = (d[1] - v[1] / sqrt(v[0]) * d[0]) / sqrt(v[2] - v[1] * v[1] / v[0]);
}

static double chi2_at(const double x[], void *data)
{
    const problem *s = data;
    double d[STATS_MAX_ANGLES] = {0.0}, v[3];
    for (size_t a = 0; a < s->c->n_angles; a++)
        d[a] = s->m->angle[a] - stats_response_value(&s->c->response[a], x, NULL);
    covariance(s, x, v);
    whiten(v, d);
    return d[0] * d[0] + d[1] * d[1];
}

static double scanned(const problem *s, size_t p, int i, int n)
{
    return s->c->lo[p] + (s->c->hi[p] - s->c->lo[p]) * i / n;
}

/* Least chi2 with parameter p in [from, to], at x. */
static rp_status least(problem *s, size_t p, double from, double to, double x[], double *chi2)
{
    double lo[STATS_MAX_PARAMS], hi[STATS_MAX_PARAMS];
    memcpy(lo, s->c->lo, sizeof lo);
    memcpy(hi, s->c->hi, sizeof hi);
    lo[p] = from;
    hi[p] = to;
    return stats_least(chi2_at, s, 2, lo, hi, s->c->n_params == 1 ? SCAN_ONE : SCAN_OTHER, x, chi2);
}

static rp_status search(problem *s, double x[], double *chi2)
{
    return least(s, 0, s->c->lo[0], s->c->hi[0], x, chi2);
}

static rp_status profile(problem *s, size_t p, double value, double *chi2)
{
    double x[STATS_MAX_PARAMS];
    return least(s, p, value, value, x, chi2);
}

/* Where the profile passes `limit`, between a value inside and one outside; NaN if that is NaN. */
static rp_status crossing(problem *s, size_t p, double inside, double outside, double limit, double *at)
{
    const double tolerance = 1e-9 * (s->c->hi[p] - s->c->lo[p]);
    while (fabs(outside - inside) > tolerance) {
        double middle = 0.5 * (inside + outside), chi2;
        RP_TRY(profile(s, p, middle, &chi2));
        if (chi2 <= limit)
            inside = middle;
        else
            outside = middle;
    }
    *at = 0.5 * (inside + outside);
    return RP_OK;
}

/* The profile, its minima instead of the scanned values next to them. Beyond its ends there is no value,
 * and chi2 is infinite. */
typedef struct {
    int n; /* intervals; scanned values 1 to n + 1 */
    double value[SCAN_ONE + 3], chi2[SCAN_ONE + 3], least;
} scan;

static rp_status scan_profile(problem *s, size_t p, scan *q)
{
    double x[STATS_MAX_PARAMS];
    const int n = q->n = s->c->n_params == 1 ? SCAN_ONE : SCAN_TWO;
    q->value[0] = q->value[n + 2] = NAN;
    q->least = q->chi2[0] = q->chi2[n + 2] = INFINITY;
    for (int i = 1; i <= n + 1; i++) {
        q->value[i] = scanned(s, p, i - 1, n);
        RP_TRY(profile(s, p, q->value[i], &q->chi2[i]));
    }
    for (int i = 1; i <= n + 1; i++) {
        if (q->chi2[i] <= q->chi2[i - 1] && q->chi2[i] <= q->chi2[i + 1]) {
            RP_TRY(least(s, p, scanned(s, p, i > 1 ? i - 2 : 0, n), scanned(s, p, i <= n ? i : n, n), x,
                         &q->chi2[i]));
            q->value[i] = x[p];
        }
        q->least = fmin(q->least, q->chi2[i]);
    }
    return RP_OK;
}

/* Each run of values within the limit is an interval, and its best value the solution. */
static rp_status find_intervals(problem *s, size_t p, stats_calibrated *r)
{
    scan q;
    RP_TRY(scan_profile(s, p, &q));
    const double limit = q.least + gsl_cdf_chisq_Pinv(confidence, 1.0);
    for (int i = 1, best = 0; i <= q.n + 1; i++) {
        if (q.chi2[i] > limit) continue;
        if (q.chi2[i - 1] > limit) {
            if (r->n_solutions == STATS_MAX_SOLUTIONS) break;
            best = i;
            RP_TRY(crossing(s, p, q.value[i], q.value[i - 1], limit, &r->solutions[r->n_solutions++].lower));
        }
        if (q.chi2[i] < q.chi2[best]) best = i;
        r->solutions[r->n_solutions - 1].value = q.value[best];
        if (q.chi2[i + 1] > limit)
            RP_TRY(
                crossing(s, p, q.value[i], q.value[i + 1], limit, &r->solutions[r->n_solutions - 1].upper));
    }
    return RP_OK;
}

/* Delta method: the inverse of J' S^-1 J, with J the slopes of the responses at x. */
static void standard_errors(const problem *s, const double x[], stats_calibrated result[])
{
    double slope[STATS_MAX_PARAMS][STATS_MAX_ANGLES] = {{0.0}}, v[3];
    covariance(s, x, v);
    for (size_t p = 0; p < s->c->n_params; p++) {
        double up[2] = {x[0], x[1]}, down[2] = {x[0], x[1]}, h = 1e-5 * (s->c->hi[p] - s->c->lo[p]);
        up[p] = fmin(x[p] + h, s->c->hi[p]);
        down[p] = fmax(x[p] - h, s->c->lo[p]);
        for (size_t a = 0; a < s->c->n_angles; a++)
            slope[p][a] = (stats_response_value(&s->c->response[a], up, NULL) -
                           stats_response_value(&s->c->response[a], down, NULL)) /
                          (up[p] - down[p]);
        whiten(v, slope[p]);
    }
    for (size_t p = 0; p < s->c->n_params; p++) {
        const double *own = slope[p], *other = slope[1 - p];
        const double shared = own[0] * other[0] + own[1] * other[1],
                     most = gsl_pow_2(gsl_hypot(other[0], other[1]));
        result[p].se =
            1.0 / sqrt(own[0] * own[0] + own[1] * own[1] - (most > 0.0 ? shared * shared / most : 0.0));
    }
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

/* Nothing in the range agrees. One angle then lies on one side of the whole response, the same for every x.
 * A response of one parameter that rises or falls throughout is taken to go on so, beyond the end x[0]. */
static void no_match(const problem *s, const double x[], stats_calibrated result[])
{
    const stats_calibration *c = s->c;
    stats_calibrated_status status = STATS_CALIBRATED_NO_MATCH;
    if (c->n_angles == 1)
        status = s->m->angle[0] > stats_response_value(&c->response[0], x, NULL)
                     ? STATS_CALIBRATED_ABOVE_RANGE
                     : STATS_CALIBRATED_BELOW_RANGE;
    for (size_t p = 0; p < c->n_params; p++) result[p].status = status;
    const bool at_end = x[0] == c->lo[0] || x[0] == c->hi[0];
    if (c->n_params == 2 || c->n_angles == 2 || !at_end || !c->response[0].monotone) return;
    result[0].n_solutions = 1;
    if (x[0] == c->hi[0])
        result[0].solutions[0].lower = x[0];
    else
        result[0].solutions[0].upper = x[0];
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
    double x[STATS_MAX_PARAMS], chi2;
    for (size_t p = 0; p < c->n_params; p++)
        result[p] = (stats_calibrated){.value = NAN,
                                       .se = NAN,
                                       .solutions = {{NAN, NAN, NAN}},
                                       .boot_se = NAN,
                                       .boot_lower = NAN,
                                       .boot_upper = NAN};
    RP_TRY(check_measured(c, measured));
    RP_TRY(search(&s, x, &chi2));
    double dof = (double)(c->n_angles > c->n_params ? c->n_angles - c->n_params : c->n_angles);
    if (!(gsl_cdf_chisq_Q(chi2, dof) >= match_level)) {
        no_match(&s, x, result);
        return RP_OK;
    }
    standard_errors(&s, x, result);
    for (size_t p = 0; p < c->n_params; p++) {
        RP_TRY(find_intervals(&s, p, &result[p]));
        judge(&s, p, &result[p]);
    }
    return RP_OK;
}

/* ---- bootstrap ---- */

/* Means of piles drawn again within each point, the same for both angles. Their spread is that of n piles
 * with n, not n - 1, below the root: made up for. */
static void resample(const stats_ensemble *piles, const stats_calibration *c, gsl_rng *rng, double y[])
{
    for (size_t g = 0; g < c->n_points; g++) {
        const stats_point *point = &c->point[g];
        const size_t n = point[1].first - point->first;
        double sum[STATS_MAX_ANGLES] = {0.0, 0.0}, number[STATS_MAX_ANGLES] = {0.0, 0.0};
        for (size_t k = 0; k < n; k++) {
            size_t i = c->pile[point->first + gsl_rng_uniform_int(rng, n)];
            for (size_t a = 0; a < c->n_angles; a++)
                if (!isnan(piles->angle[a][i])) {
                    sum[a] += piles->angle[a][i];
                    number[a] += 1.0;
                }
        }
        for (size_t a = 0; a < c->n_angles; a++) {
            double mean = point->mean[a], m = point->number[a];
            double drawn = number[a] > 0.0 ? sum[a] / number[a] : mean;
            y[a * c->n_points + g] = mean + sqrt(m / (m - 1.0)) * (drawn - mean);
        }
    }
}

/* The parameters of one resample. */
static rp_status search_again(const stats_ensemble *piles, const stats_calibration *c, stats_measured m,
                              gsl_rng *rng, double y[], double x[])
{
    stats_calibration again = *c; /* shares the points */
    double draw[2], chi2;
    resample(piles, c, rng, y);
    gsl_ran_bivariate_gaussian(rng, 1.0, 1.0, c->correlation, &draw[0], &draw[1]);
    for (size_t a = 0; a < c->n_angles; a++) {
        m.angle[a] += draw[a] * m.error[a];
        RP_TRY(stats_response_solve(&again.response[a], c, a, y + a * c->n_points));
    }
    return search(&(problem){&again, &m}, x, &chi2);
}

rp_status stats_calibration_bootstrap(const stats_ensemble *piles, const stats_calibration *c,
                                      const stats_measured *measured, size_t n_resamples, gsl_rng *rng,
                                      stats_calibrated result[])
{
    rp_status status = RP_OK;
    RP_TRY(stats_check_resamples(n_resamples));
    double *y = malloc(STATS_MAX_ANGLES * c->n_points * sizeof *y);
    double *values = malloc(STATS_MAX_PARAMS * n_resamples * sizeof *values);
    if (!y || !values) status = rp_fail(RP_NO_MEMORY, "calibrate: out of memory");
    for (size_t k = 0; !status && k < n_resamples; k++) {
        double x[STATS_MAX_PARAMS] = {NAN, NAN};
        status = search_again(piles, c, *measured, rng, y, x);
        for (size_t p = 0; p < STATS_MAX_PARAMS; p++) values[p * n_resamples + k] = x[p];
        if (status == RP_NO_RESULT) status = RP_OK; /* no scale: the resample says nothing */
    }
    for (size_t p = 0; !status && p < c->n_params; p++) {
        const stats_spread spread = stats_resampled(n_resamples, values + p * n_resamples);
        if (!isfinite(result[p].value)) continue;
        result[p].boot_se = spread.sd;
        result[p].boot_lower = spread.lo;
        result[p].boot_upper = spread.hi;
    }
    free(y);
    free(values);
    return status;
}
