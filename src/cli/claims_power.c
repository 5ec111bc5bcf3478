/* The power of the claims' tests; see claims.h. */
#include "report/claims.h"

#include <gsl/gsl_cdf.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "stats/samplesize.h"

/* Two standard errors decide where the error is known, as in stats/verdict.h. */
static const double two_errors = 2.0, two_sided = 0.025, one_sided = 0.05;

/* The quantile of a chance divided among the tests of a family. */
static double quantile(double level, size_t tests)
{
    return gsl_cdf_ugaussian_Qinv(level / (double)tests);
}

/* An interval within +-margin, for no change. */
static stats_rule find_equivalence(double margin, size_t tests)
{
    return (stats_rule){-margin, margin, one_sided / (double)tests, quantile(one_sided, tests)};
}

/* The rule of a test and the truth for which it is to decide. A difference: two standard errors on the side
 * of the effect. No change, and an order of magnitude: the interval within the margins if there is no effect.
 */
static bool find_rule(const cli_claim *c, size_t tests, stats_rule *rule, double *truth)
{
    const double margin = c->margin;
    *truth = margin;
    *rule = (stats_rule){0.0, INFINITY, two_sided / (double)tests, two_errors};
    if (tests > 1) rule->known = quantile(gsl_cdf_ugaussian_Q(two_errors), tests);
    switch (c->test) {
    case CLAIM_AGREES:
    case CLAIM_SAME:
    case CLAIM_RATIO:
    case CLAIM_ABOVE:
    case CLAIM_BELOW: break;
    case CLAIM_RISES:
    case CLAIM_FALLS: rule->known = quantile(two_sided, tests); break;
    case CLAIM_INDEPENDENT:
        *rule = find_equivalence(margin, tests);
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

/* Inequalities and changes, which a difference decides, or its absence where a margin excludes it. */
static bool tests_difference(const cli_claim *c)
{
    return c->test == CLAIM_ABOVE || c->test == CLAIM_BELOW || c->test == CLAIM_RISES ||
           c->test == CLAIM_FALLS || c->test == CLAIM_INDEPENDENT;
}

/* The runs that decide, one way or the other, if the truth is the present number. */
static double find_needed_own(const cli_claim *c, const cli_judged *j, const stats_pilot *pilot, size_t tests)
{
    char *end;
    stats_rule difference, none = find_equivalence(c->margin, tests);
    double truth;
    if (!tests_difference(c)) return NAN;
    cli_claim trend = *c;
    if (c->test == CLAIM_INDEPENDENT) trend.test = CLAIM_RISES;
    find_rule(&trend, tests, &difference, &truth);
    const double ours = fabs(j->ours.value - (*c->against ? j->against.value : 0.0));
    const double limit = strtod(c->against, &end);
    const bool is_limit = *c->against && !*end && limit != 0.0; /* a limit is the margin itself */
    const double by_difference = stats_sample_size(&difference, pilot, ours, CLI_POWER);
    return is_limit ? by_difference : fmin(by_difference, stats_sample_size(&none, pilot, ours, CLI_POWER));
}

/* Processor time of so many times the present runs of all sweeps behind a claim. */
static double find_seconds(const cli_claim *c, const char *folders)
{
    cli_sweep sweeps[CLI_MAX_SWEEPS];
    size_t n;
    double seconds = 0.0;
    if (cli_claim_sweeps(c, folders, sweeps, &n)) return NAN;
    for (size_t k = 0; k < n; k++) seconds += sweeps[k].seconds;
    return seconds;
}

bool cli_claim_power(const cli_claim *c, const char *folders, const cli_judged *j, cli_power *p)
{
    stats_rule rule;
    double truth;
    const size_t tests = j->tests > 1 ? j->tests : 1;
    if (j->verdict == STATS_NO_DATA || !find_rule(c, tests, &rule, &truth)) return false;
    const bool published = c->test == CLAIM_AGREES || c->test == CLAIM_RATIO;
    stats_pilot pilot = {.se = own_error(c, j), .dof = j->dof, .fixed = published ? c->published.se : 0.0};
    if (!(pilot.se > 0.0) || !cli_find_sweep(folders, c->answer, &p->sweep)) return false;
    const bool pooled = strstr(c->answer, " + ") != NULL;
    pilot.n = p->runs = pooled ? j->n : p->sweep.replicas;
    p->effect = c->margin;
    p->se = pilot.se;
    p->power = stats_power(&rule, &pilot, truth, pilot.n);
    p->needed = p->needed_sd = stats_sample_size(&rule, &pilot, truth, CLI_POWER);
    p->needed_own = find_needed_own(c, j, &pilot, tests);
    if (published && c->samples > 0.0) {
        pilot.fixed /= sqrt(c->samples);
        p->needed_sd = stats_sample_size(&rule, &pilot, truth, CLI_POWER);
    }
    p->seconds = pooled ? p->needed_sd * p->sweep.seconds / p->sweep.replicas / p->sweep.points
                        : p->needed_sd / p->runs * find_seconds(c, folders);
    return true;
}

/* "1785 runs a point (2.5 h)"; of several sweeps, whose numbers differ, a multiple of what there is. */
static void print_runs(FILE *out, const cli_claim *c, const char *folders, const cli_power *p, double runs)
{
    cli_sweep sweeps[CLI_MAX_SWEEPS];
    size_t n = 0;
    const double hours = p->seconds / p->needed_sd * runs / 3600.0;
    if (isinf(runs))
        fputs("no number of runs", out);
    else if (!cli_claim_sweeps(c, folders, sweeps, &n) && n > 1)
        fprintf(out, "%.2g times the present runs", runs / p->runs);
    else
        fprintf(out, "%.0f runs a point", runs);
    if (isfinite(hours)) fprintf(out, " (%.*f h)", hours < 10.0, hours);
}

/* The truth for which a test is planned, and the present number. */
static void print_needed(FILE *out, const cli_claim *c, const char *folders, const cli_power *p)
{
    const char *truth = c->test == CLAIM_INDEPENDENT ? "no change"
                        : c->test == CLAIM_ORDER     ? "an equal number"
                                                     : "a difference";
    fputs(truth, out);
    if (c->test != CLAIM_INDEPENDENT && c->test != CLAIM_ORDER) fprintf(out, " of %g", p->effect);
    fputs(" takes ", out);
    print_runs(out, c, folders, p, p->needed);
    if (isnan(p->needed_own)) return;
    fputs(isinf(p->needed_own) ? ", our present one " : ", our present one at most ", out);
    print_runs(out, c, folders, p, p->needed_own);
}

void cli_claim_remedy(const cli_claim *c, const char *folders, const cli_judged *j, char text[256])
{
    cli_power p;
    *text = '\0';
    if (j->verdict != STATS_UNDECIDED) return;
    FILE *out = fmemopen(text, 256, "w");
    if (stats_fit_rejected(j->p_fit))
        fputs("no number of runs decides: the means need another form of fit", out);
    else if (c->test == CLAIM_CONSTANT || strncmp(c->answer, "published ", strlen("published ")) == 0)
        fputs("no number of runs decides: the paper's numbers alone are tested", out);
    else if (!cli_claim_power(c, folders, j, &p) || isnan(p.needed))
        fputs("no number of runs can be given: the error of the present number is not known", out);
    else if (isinf(p.needed) && j->two_readings && j->match.error != STATS_UNDECIDED)
        fputs("no number of runs decides: the verdict depends on the reading of the paper's ±", out);
    else if (isinf(p.needed))
        fputs("no number of runs decides: the paper's own error is too large", out);
    else
        print_needed(out, c, folders, &p);
    fclose(out);
}
