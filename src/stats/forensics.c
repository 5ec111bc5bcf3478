/* Published numbers against combinations of choices that the publication leaves open; see forensics.h.
 *
 * The published errors are known up to a common scale, over which the likelihood is averaged: what "+-"
 * means in Lee & Herrmann 1993 (standard error, deviation or mean square) is itself unsaid. */
#include <gsl/gsl_cdf.h>
#include <gsl/gsl_randist.h>
#include <gsl/gsl_sort.h>
#include <math.h>
#include <stdlib.h>

#include "stats/forensics.h"
#include "stats/stats.h"

enum { N_SCALES = 13 };
static const double scale_min = 0.2, scale_max = 2.0;

static double scale(double part)
{
    return scale_min * pow(scale_max / scale_min, part);
}

static double log_likelihood_at(double s, size_t n, const stats_claim claims[], const double y[],
                                const double se[])
{
    double sum = 0.0;
    for (size_t k = 0; k < n; k++) {
        double v = s * s * claims[k].error * claims[k].error + se[k] * se[k];
        double r = y[k] - claims[k].value;
        if (claims[k].kind == STATS_CLAIM_VALUE)
            sum -= 0.5 * (r * r / v + log(v));
        else
            sum += log(fmax(gsl_cdf_ugaussian_P(claims[k].value * y[k] / sqrt(v)), 1e-300));
    }
    return sum;
}

double stats_claims_log_likelihood(size_t n, const stats_claim claims[], const double y[], const double se[])
{
    double logs[N_SCALES], top = -INFINITY, sum = 0.0;
    for (int i = 0; i < N_SCALES; i++) {
        logs[i] = log_likelihood_at(scale((i + 0.5) / N_SCALES), n, claims, y, se);
        top = fmax(top, logs[i]);
    }
    for (int i = 0; i < N_SCALES; i++) sum += exp(logs[i] - top);
    return top + log(sum / N_SCALES);
}

/* What would have been published about a model value y +- se with the errors of `claim` at scale s. */
static double publish(const stats_claim *claim, double y, double se, double s, gsl_rng *rng)
{
    double seen = y + gsl_ran_gaussian(rng, hypot(s * claim->error, se));
    return claim->kind == STATS_CLAIM_VALUE ? seen : copysign(1.0, seen);
}

/* p-value of one combination among data that it would publish itself, and the limit of its likelihood. */
static void calibrate(size_t n, const stats_claim claims[], const double y[], const double se[], double level,
                      size_t n_draws, gsl_rng *rng, stats_claim *drawn, double *logs, stats_agreement *out)
{
    size_t below = 0;
    out->log_likelihood = stats_claims_log_likelihood(n, claims, y, se);
    for (size_t d = 0; d < n_draws; d++) {
        double s = scale(gsl_rng_uniform(rng));
        for (size_t k = 0; k < n; k++) drawn[k].value = publish(&claims[k], y[k], se[k], s, rng);
        logs[d] = stats_claims_log_likelihood(n, drawn, y, se);
        below += logs[d] <= out->log_likelihood;
    }
    gsl_sort(logs, 1, n_draws);
    out->limit = logs[(size_t)(level * (double)n_draws)];
    out->p_value = ((double)below + 1.0) / ((double)n_draws + 1.0);
    out->excluded = out->log_likelihood < out->limit;
}

/* How many combinations pass data of no combination: each claim's number is that of a combination drawn for
 * it alone. The mean over draws, and the share of draws that leave at least as many as the true data. */
static stats_chance pass_by_chance(size_t n_combinations, size_t n, const stats_claim claims[],
                                   const double y[], const double se[], const stats_agreement agreement[],
                                   size_t n_draws, gsl_rng *rng, stats_claim *drawn, size_t *complete)
{
    size_t m = 0, passed = 0, as_many = 0, observed = 0;
    for (size_t c = 0; c < n_combinations; c++) {
        if (agreement[c].complete) complete[m++] = c;
        observed += agreement[c].complete && !agreement[c].excluded;
    }
    for (size_t d = 0; d < n_draws && m > 0; d++) {
        double s = scale(gsl_rng_uniform(rng));
        for (size_t k = 0; k < n; k++) {
            size_t at = complete[gsl_rng_uniform_int(rng, m)] * n + k;
            drawn[k].value = publish(&claims[k], y[at], se[at], s, rng);
        }
        size_t here = 0;
        for (size_t i = 0; i < m; i++) {
            const size_t c = complete[i];
            here += stats_claims_log_likelihood(n, drawn, y + c * n, se + c * n) >= agreement[c].limit;
        }
        passed += here;
        as_many += here >= observed;
    }
    if (n_draws == 0) return (stats_chance){NAN, NAN};
    return (stats_chance){(double)passed / (double)n_draws, (double)as_many / (double)n_draws};
}

rp_status stats_claims_judge(size_t n_combinations, size_t n, const stats_claim claims[], const double y[],
                             const double se[], double level, size_t n_draws, size_t n_chance, gsl_rng *rng,
                             stats_agreement agreement[], stats_chance *chance)
{
    if (n == 0) return rp_fail(RP_NO_RESULT, "no claims");
    for (size_t k = 0; k < n; k++)
        if (!(claims[k].error > 0.0 || (claims[k].kind == STATS_CLAIM_SIGN && claims[k].error == 0.0)) ||
            !isfinite(claims[k].error + claims[k].value))
            return rp_fail(RP_BAD_INPUT, "claim %zu: %g +- %g: a finite value with a positive error expected",
                           k + 1, claims[k].value, claims[k].error);
    if (!(level > 0.0 && level < 1.0))
        return rp_fail(RP_BAD_INPUT, "level = %g: out of range, allowed: (0, 1)", level);
    if (n_draws < 20) return rp_fail(RP_BAD_INPUT, "draws = %zu: out of range, allowed: [20, inf)", n_draws);
    stats_claim *drawn = malloc(n * sizeof *drawn);
    double *logs = malloc(n_draws * sizeof *logs);
    size_t *complete = malloc((n_combinations + 1) * sizeof *complete);
    const bool room = drawn && logs && complete;
    for (size_t k = 0; k < n && room; k++) drawn[k] = claims[k];
    for (size_t c = 0; c < n_combinations && room; c++) {
        stats_agreement *a = &agreement[c];
        *a = (stats_agreement){true, true, NAN, NAN, NAN};
        for (size_t k = 0; k < n; k++) a->complete &= isfinite(y[c * n + k]) && isfinite(se[c * n + k]);
        if (a->complete) calibrate(n, claims, y + c * n, se + c * n, level, n_draws, rng, drawn, logs, a);
    }
    if (room)
        *chance = pass_by_chance(n_combinations, n, claims, y, se, agreement, n_chance, rng, drawn, complete);
    free(drawn);
    free(logs);
    free(complete);
    return room ? RP_OK : rp_fail(RP_NO_MEMORY, "claims: out of memory");
}

rp_status stats_effects(size_t n, size_t n_factors, const size_t level[], const size_t n_levels[],
                        const double y[], stats_effect effects[], double *residual_sd)
{
    size_t p = 1, rank = 0;
    for (size_t f = 0; f < n_factors; f++) p += n_levels[f] - 1;
    if (n <= p)
        return rp_fail(RP_NO_RESULT, "effects: %zu combinations for %zu coefficients, more expected", n, p);
    double *X = calloc(p * (n + p + 1), sizeof *X), *c = X + n * p, *covariance = c + p, chi2;
    if (!X) return rp_fail(RP_NO_MEMORY, "effects: out of memory");
    for (size_t i = 0; i < n; i++) {
        X[i * p] = 1.0;
        for (size_t f = 0, column = 0; f < n_factors; column += n_levels[f++] - 1) /* level 0: no column */
            if (level[i * n_factors + f] > 0) X[i * p + column + level[i * n_factors + f]] = 1.0;
    }
    rp_status status = stats_multifit(n, p, X, NULL, y, 1e-10, c, covariance, &chi2, &rank);
    if (!status && rank < p)
        status =
            rp_fail(RP_NO_RESULT,
                    "effects: the combinations do not distinguish the factors (rank %zu of %zu)", rank, p);
    const double dof = (double)(n - p), t = gsl_cdf_tdist_Qinv(0.025, dof);
    if (!status) *residual_sd = sqrt(chi2 / dof);
    for (size_t k = 1; !status && k < p; k++) {
        const double se = sqrt(covariance[k * p + k]);
        effects[k - 1] = (stats_effect){c[k], se, c[k] - t * se, c[k] + t * se,
                                        2.0 * gsl_cdf_tdist_Q(fabs(c[k]) / se, dof)};
    }
    free(X);
    return status;
}
