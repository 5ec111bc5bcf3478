/* Power of a test and the number of values that it needs; see samplesize.h. */
#include "stats/samplesize.h"

#include <gsl/gsl_cdf.h>
#include <math.h>

/* Quantiles of the estimated error that the power is averaged over: its own error is then below 1e-3. */
enum { QUANTILES = 64 };

/* From so many degrees of freedom on the estimated error is the true one, to 1 %. */
static const double MANY = 5000.0;

/* The error at n values. */
typedef struct {
    double se, dof, fixed;
} errors;

static errors errors_at(const stats_pilot *p, double n)
{
    errors e = {p->se * sqrt(p->n / n), p->dof * (n - 1.0) / (p->n - 1.0), p->fixed};
    if (isinf(n)) e = (errors){0.0, INFINITY, p->fixed};
    if (e.dof < 1.0) e.dof = 1.0;
    return e;
}

/* Chance to decide if the estimated error is `estimated` times the true one. */
static double power_at(const stats_rule *rule, const errors *e, double effect, double estimated)
{
    const double t = isinf(e->dof) ? rule->known : gsl_cdf_tdist_Qinv(rule->level, e->dof);
    const double within = hypot(t * e->se * estimated, rule->known * e->fixed),
                 sigma = hypot(e->se, e->fixed);
    const double lo = rule->from + within - effect, hi = rule->to - within - effect;
    if (lo >= hi) return 0.0;
    if (sigma == 0.0) return lo < 0.0 && hi > 0.0 ? 1.0 : 0.0;
    return gsl_cdf_ugaussian_P(hi / sigma) - gsl_cdf_ugaussian_P(lo / sigma);
}

double stats_power(const stats_rule *rule, const stats_pilot *pilot, double effect, double n)
{
    const errors e = errors_at(pilot, n);
    if (e.dof > MANY) return power_at(rule, &e, effect, 1.0);
    double power = 0.0;
    for (int i = 0; i < QUANTILES; i++)
        power += power_at(rule, &e, effect, sqrt(gsl_cdf_chisq_Pinv((i + 0.5) / QUANTILES, e.dof) / e.dof));
    return power / QUANTILES;
}

double stats_sample_size(const stats_rule *rule, const stats_pilot *pilot, double effect, double power)
{
    const double most = 1e9;
    double hi = 2.0, lo = 1.0;
    if (isnan(stats_power(rule, pilot, effect, hi))) return NAN;
    while (hi < most && stats_power(rule, pilot, effect, hi) < power) {
        lo = hi;
        hi = fmin(2.0 * hi, most);
    }
    if (hi == most && stats_power(rule, pilot, effect, most) < power) return INFINITY;
    while (hi - lo > 1.0) {
        const double middle = floor(0.5 * (lo + hi));
        *(stats_power(rule, pilot, effect, middle) < power ? &lo : &hi) = middle;
    }
    return hi;
}
