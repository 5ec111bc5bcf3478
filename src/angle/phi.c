/* Inclination phi of the rays that carry the weight, fitted to piles: Lee & Herrmann 1993, (3) and (4) with
 * phi instead of pi/3; see angle.h.
 *
 * A group of n piles of one mu is compared at its mean angles: the residual e is theta_r + theta_t less (3),
 * or theta_t less (4) at theta_r, whose slope carries the scatter of theta_r into the variance of e. A pile
 * that would slide without tilt is one of theta_t = 0.
 *
 * With t^2 = n e^2/variance, and the variance not known beforehand,
 *     minus twice the log likelihood ratio = n log(1 + t^2/(n - 1)),
 * whose mean is n (psi(n/2) - psi((n - 1)/2)) and not 1. The sum over groups, each scaled to the mean 1
 * (Bartlett), is chi2, on n_groups - 1 degrees of freedom. */
#include <gsl/gsl_cdf.h>
#include <gsl/gsl_sf_psi.h>
#include <math.h>
#include <stdlib.h>

#include "angle/angle.h"

static const double difference = 1e-4;        /* of the slope of (4), rad: error 1e-8 */
static const double margin = 2e-4;            /* rad, between phi and where it ends */
static const double rise = 3.841458820694124; /* 95 % of chi2 with one degree of freedom */
static const double root_tolerance = 1e-12;   /* of the interval's ends, rad */
enum { SCAN = 48 };

/* A group as the fit sees it; var and cov of one pile. */
typedef struct {
    double mu, n, r, t, var_r, var_t, cov;
    double scale; /* Bartlett */
} moments;

typedef struct {
    size_t n_groups;
    ang_against against;
    moments *group;
    double lo, hi; /* where phi may lie for these means */
    double most;   /* chi2 where the interval of phi ends */
} problem;

const char *const ang_against_words[] = {"marginal", "balanced"};

/* What the equation gives at theta_r = r: theta_r + theta_t of (3), theta_t of (4). */
static double predicted(ang_against against, double mu, double r, double phi)
{
    double theta_ms;
    ang_tilt_result tilt;
    if (against == ANG_AGAINST_MARGINAL) return ang_marginal(mu, phi, &theta_ms, NULL) ? NAN : theta_ms;
    if (ang_tilt(ANG_BALANCED, mu, r, phi, &tilt)) return NAN;
    if (tilt.status == ANG_TILT_ALREADY_UNSTABLE) return 0.0;
    return tilt.status == ANG_TILT_NO_SLIDE ? tilt.limit : tilt.theta_t;
}

/* Square of Student's t of the residual. */
static double t_squared(const moments *g, ang_against against, double phi)
{
    const bool marginal = against == ANG_AGAINST_MARGINAL;
    double e = g->t + (marginal ? g->r : 0.0) - predicted(against, g->mu, g->r, phi);
    double slope = marginal ? -1.0
                            : (predicted(against, g->mu, g->r + difference, phi) -
                               predicted(against, g->mu, g->r - difference, phi)) /
                                  (2.0 * difference);
    return g->n * e * e / (g->var_t - 2.0 * slope * g->cov + slope * slope * g->var_r);
}

static double misfit(const double phi[], void *data)
{
    const problem *q = data;
    double sum = 0.0;
    for (size_t i = 0; i < q->n_groups; i++) {
        const moments *g = &q->group[i];
        sum += g->scale * g->n * log1p(t_squared(g, q->against, *phi) / (g->n - 1.0));
    }
    return sum;
}

/* Moments of the piles. False if they have no spread, or a mean angle too close to 0. */
static bool take_moments(const ang_piles *piles, moments *g)
{
    const double n = (double)piles->n;
    *g = (moments){.mu = piles->mu, .n = n};
    for (size_t i = 0; i < piles->n; i++) {
        g->r += piles->theta_r[i] / n;
        g->t += piles->theta_t[i] / n;
    }
    for (size_t i = 0; i < piles->n; i++) {
        double dr = piles->theta_r[i] - g->r, dt = piles->theta_t[i] - g->t;
        g->var_r += dr * dr / (n - 1.0);
        g->var_t += dt * dt / (n - 1.0);
        g->cov += dr * dt / (n - 1.0);
    }
    g->scale = 1.0 / (n * (gsl_sf_psi(0.5 * n) - gsl_sf_psi(0.5 * (n - 1.0))));
    if (g->r < 2.0 * difference || g->t < 2.0 * difference) return false;
    /* equal angles leave round-off */
    return g->var_r * g->var_t - g->cov * g->cov > 1e-12 * g->var_r * g->var_t && g->var_t > 1e-20;
}

static rp_status check_piles(const ang_piles *piles)
{
    if (!(piles->mu > 0.0 && isfinite(piles->mu)))
        return rp_fail(RP_BAD_INPUT, "mu = %g: out of range, allowed: (0, inf)", piles->mu);
    if (piles->n < ANG_PHI_PILES)
        return rp_fail(RP_BAD_INPUT, "mu = %g: %zu piles, at least %d needed", piles->mu, piles->n,
                       ANG_PHI_PILES);
    for (size_t i = 0; i < piles->n; i++) {
        double r = piles->theta_r[i], t = piles->theta_t[i];
        if (!(r > -M_PI_2 && r < M_PI_2 && t >= 0.0 && t < M_PI_2))
            return rp_fail(RP_BAD_INPUT,
                           "mu = %g, pile %zu: theta_r = %g, theta_t = %g rad: out of range, allowed: "
                           "(-pi/2, pi/2), [0, pi/2)",
                           piles->mu, i + 1, r, t);
    }
    return RP_OK;
}

static rp_status set_problem(size_t n_groups, const ang_piles groups[], problem *q)
{
    *q = (problem){.n_groups = n_groups, .hi = M_PI_2 - margin};
    if (n_groups == 0) return rp_fail(RP_NO_RESULT, "no piles");
    q->group = calloc(n_groups, sizeof *q->group);
    if (!q->group) return rp_fail(RP_NO_MEMORY, "phi: out of memory");
    for (size_t i = 0; i < n_groups; i++) {
        RP_TRY(check_piles(&groups[i]));
        if (!take_moments(&groups[i], &q->group[i]))
            return rp_fail(RP_NO_RESULT,
                           "mu = %g: mean angles %g, %g rad: flat, or all piles the same: nothing to fit",
                           groups[i].mu, q->group[i].r, q->group[i].t);
        q->lo = fmax(q->lo, q->group[i].r + q->group[i].t);
    }
    q->lo += margin + 2.0 * difference;
    if (q->lo < q->hi) return RP_OK;
    return rp_fail(RP_NO_RESULT, "theta_r + theta_t = %g rad: steeper than any ray", q->lo);
}

static double above_level(double phi, void *data)
{
    const problem *q = data;
    return misfit(&phi, data) - q->most;
}

/* Where chi2 has risen to q->most between the best phi and `end`; *open if it has not, and then `end`. */
static rp_status profile_end(problem *q, double phi, double end, bool *open, double *at)
{
    *at = end;
    *open = above_level(end, q) < 0.0;
    if (*open) return RP_OK;
    return ang_root(above_level, q, fmin(phi, end), fmax(phi, end), root_tolerance, 0.0, at);
}

static rp_status fit_equation(problem *q, ang_against against, ang_phi *fit)
{
    const double lo[2] = {q->lo, 0.0}, hi[2] = {q->hi, 0.0};
    double phi[2];
    q->against = against;
    /* of several minima, as a sum of terms that saturate may have, the least */
    RP_TRY(stats_least(misfit, q, lo, hi, SCAN, phi, &fit->chi2));
    fit->phi = *phi;
    q->most = fit->chi2 + rise;
    fit->dof = q->n_groups - 1;
    fit->p_value = fit->dof > 0 ? gsl_cdf_chisq_Q(fit->chi2, (double)fit->dof) : NAN;
    RP_TRY(profile_end(q, fit->phi, q->lo, &fit->lo_open, &fit->lo));
    return profile_end(q, fit->phi, q->hi, &fit->hi_open, &fit->hi);
}

rp_status ang_phi_fit(size_t n_groups, const ang_piles groups[], ang_phi fit[ANG_N_AGAINST])
{
    problem q;
    for (int a = 0; a < ANG_N_AGAINST; a++) fit[a] = (ang_phi){NAN, NAN, NAN, NAN, NAN, 0, false, false};
    rp_status status = set_problem(n_groups, groups, &q);
    for (int a = 0; a < ANG_N_AGAINST && !status; a++) status = fit_equation(&q, (ang_against)a, &fit[a]);
    free(q.group);
    return status;
}
