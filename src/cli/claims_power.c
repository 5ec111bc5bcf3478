/* The power of the claims' tests; see claims.h. */
#include "cli/claims.h"

#include <gsl/gsl_cdf.h>
#include <math.h>
#include <string.h>

#include "stats/samplesize.h"

/* Two standard errors decide where the error is known, as in stats/claims.h. */
static const double two_errors = 2.0, two_sided = 0.025, one_sided = 0.05;

/* The rule of a test and the truth for which it is to decide. A difference: two standard errors on the side
 * of the effect. No change, and an order of magnitude: the interval within the margins if there is no effect.
 */
static bool find_rule(const cli_claim *c, stats_rule *rule, double *truth)
{
    const double margin = c->margin;
    *truth = margin;
    *rule = (stats_rule){0.0, INFINITY, two_sided, two_errors};
    switch (c->test) {
    case CLAIM_AGREES:
    case CLAIM_SAME:
    case CLAIM_RATIO:
    case CLAIM_ABOVE:
    case CLAIM_BELOW: break;
    case CLAIM_RISES:
    case CLAIM_FALLS: rule->known = gsl_cdf_ugaussian_Qinv(two_sided); break;
    case CLAIM_INDEPENDENT:
        *rule = (stats_rule){-margin, margin, one_sided, gsl_cdf_ugaussian_Qinv(one_sided)};
        *truth = 0.0;
        break;
    case CLAIM_ORDER:
        *rule = (stats_rule){1.0 / margin - 1.0, margin - 1.0, two_sided, two_errors};
        *truth = 0.0;
        break;
    case CLAIM_LEAST:
    case CLAIM_MOST:
    case CLAIM_EQUALS:
    case CLAIM_CONSTANT:
    case CLAIM_FORMULA:
    case CLAIM_PICTURE:
    case CLAIM_UNTESTABLE:
    case CLI_N_CLAIM_TESTS: return false;
    }
    return isfinite(margin);
}

/* The error that more runs reduce. An order of magnitude has a relative one. */
static double own_error(const cli_claim *c, const cli_judged *j)
{
    if (c->test == CLAIM_ORDER)
        return hypot(j->ours.se / j->ours.value, *c->against ? j->against.se / j->against.value : 0.0);
    return c->test == CLAIM_RATIO ? j->ours.se : hypot(j->ours.se, j->against.se);
}

bool cli_claim_power(const cli_claim *c, const char *folders, const cli_judged *j, cli_power *p)
{
    stats_rule rule;
    double truth;
    if (j->verdict == STATS_NO_DATA || !find_rule(c, &rule, &truth)) return false;
    const bool published = c->test == CLAIM_AGREES || c->test == CLAIM_RATIO;
    stats_pilot pilot = {.se = own_error(c, j), .dof = j->dof, .fixed = published ? c->published.se : 0.0};
    if (!(pilot.se > 0.0) || !cli_find_sweep(folders, c->answer, &p->sweep)) return false;
    const bool pooled = strstr(c->answer, " + ") != NULL;
    pilot.n = p->runs = pooled ? j->n : p->sweep.replicas;
    p->effect = c->margin;
    p->se = pilot.se;
    p->power = stats_power(&rule, &pilot, truth, pilot.n);
    p->needed = p->needed_sd = stats_sample_size(&rule, &pilot, truth, CLI_POWER);
    if (published && c->samples > 0.0) {
        pilot.fixed /= sqrt(c->samples);
        p->needed_sd = stats_sample_size(&rule, &pilot, truth, CLI_POWER);
    }
    p->seconds = p->needed_sd * p->sweep.seconds / p->sweep.replicas / (pooled ? p->sweep.points : 1.0);
    return true;
}
