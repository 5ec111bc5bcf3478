/* Verdicts on published claims; see verdict.h. */
#include "report/verdict.h"

#include <gsl/gsl_cdf.h>
#include <math.h>
#include <string.h>

static const double errors_that_decide = 2.0, level = 0.05;

const char *const report_verdict_texts[REPORT_VERDICTS] = {"reproduced",      "not reproduced", "undecided",
                                                           "can't be tested", "by eye",         "no data"};

stats_number report_of_few(stats_number mean, double n)
{
    if (n >= 2.0) mean.se *= gsl_cdf_tdist_Qinv(0.025, n - 1.0) / errors_that_decide;
    return mean;
}

double report_deviation_error(double sd, double n)
{
    return n >= 2.0 ? sd / sqrt(2.0 * (n - 1.0)) : NAN;
}

/* p: chance of the difference, as it is or corrected. A difference that is no more significant then is no
 * agreement. */
static report_verdict agree_once(double difference, double se, double margin, double p)
{
    if (isnan(difference) || isnan(se)) return REPORT_UNDECIDED;
    if (fabs(difference) > errors_that_decide * se)
        return p < report_agree_p(errors_that_decide) ? REPORT_NOT_REPRODUCED : REPORT_UNDECIDED;
    return errors_that_decide * se <= margin ? REPORT_REPRODUCED : REPORT_UNDECIDED;
}

/* Both readings must say the same. */
static report_verdict both(report_verdict a, report_verdict b)
{
    return a == b ? a : REPORT_UNDECIDED;
}

report_match report_agree(stats_number ours, stats_number published, double samples, double margin,
                          const report_chances *raised)
{
    const double difference = ours.value - published.value;
    const double se = hypot(ours.se, published.se);
    const double sd = hypot(ours.se, samples > 0.0 ? published.se / sqrt(samples) : published.se);
    report_match m = {.z_error = difference / se, .z_deviation = difference / sd};
    const bool own = !raised;
    m.error = agree_once(difference, se, margin, own ? 0.0 : raised->effect);
    m.deviation = agree_once(difference, sd, margin, own ? 0.0 : raised->deviation);
    m.verdict = both(m.error, m.deviation);
    return m;
}

double report_agree_p(double z)
{
    return 2.0 * gsl_cdf_ugaussian_Q(fabs(z));
}

double report_exceed_p(stats_number a, stats_number b)
{
    const double difference = fabs(a.value - b.value), se = hypot(a.se, b.se);
    return se > 0.0 ? 2.0 * gsl_cdf_ugaussian_Q(difference / se) : NAN;
}

double report_exceed_p_margin(stats_number a, stats_number b, double margin)
{
    const double difference = fabs(a.value - b.value), se = hypot(a.se, b.se);
    return se > 0.0 && isfinite(margin) ? gsl_cdf_ugaussian_Q((margin - difference) / se) : NAN;
}

report_verdict report_exceed(stats_number a, stats_number b, int sign, const report_chances *p)
{
    const double difference = sign * (a.value - b.value);
    const bool exact = hypot(a.se, b.se) == 0.0 && !isnan(difference);
    if (exact || p->effect < report_agree_p(errors_that_decide))
        return difference > 0.0 ? REPORT_REPRODUCED : REPORT_NOT_REPRODUCED;
    return p->margin < level ? REPORT_NOT_REPRODUCED : REPORT_UNDECIDED;
}

report_verdict report_bound(double value, double limit, int sign)
{
    if (isnan(value) || isnan(limit)) return REPORT_UNDECIDED;
    return sign * value >= sign * limit ? REPORT_REPRODUCED : REPORT_NOT_REPRODUCED;
}

static bool within(const report_change *change, double margin)
{
    return change->lo90 > -margin && change->hi90 < margin;
}

report_verdict report_equivalent(const report_change *change, double margin, const report_chances *raised)
{
    if (raised ? raised->margin < level : within(change, margin)) return REPORT_REPRODUCED;
    return (raised ? raised->effect : change->p_value) < level ? REPORT_NOT_REPRODUCED : REPORT_UNDECIDED;
}

report_verdict report_trends(const report_change *change, int sign, double margin)
{
    const double middle = 0.5 * (change->lo90 + change->hi90);
    if (isnan(middle)) return REPORT_UNDECIDED;
    if (change->p_value < level) return sign * middle > 0.0 ? REPORT_REPRODUCED : REPORT_NOT_REPRODUCED;
    return within(change, margin) ? REPORT_NOT_REPRODUCED : REPORT_UNDECIDED;
}

/* Chance of so large a chi^2 about the weighted mean. */
static double constant_p(size_t n, const stats_number v[], double factor)
{
    double weights = 0.0, sum = 0.0, chi2 = 0.0;
    for (size_t i = 0; i < n; i++) {
        const double w = 1.0 / (factor * v[i].se * factor * v[i].se);
        weights += w;
        sum += w * v[i].value;
    }
    for (size_t i = 0; i < n; i++) {
        const double r = (v[i].value - sum / weights) / (factor * v[i].se);
        chi2 += r * r;
    }
    return n > 1 && isfinite(chi2) ? gsl_cdf_chisq_Q(chi2, (double)n - 1.0) : NAN;
}

report_match report_constant(size_t n, const stats_number published[], double samples)
{
    report_match m = {.z_error = constant_p(n, published, 1.0),
                      .z_deviation = constant_p(n, published, samples > 0.0 ? 1.0 / sqrt(samples) : 1.0)};
    m.error = report_bound(m.z_error, level, 1);
    m.deviation = report_bound(m.z_deviation, level, 1);
    m.verdict = both(m.error, m.deviation);
    return m;
}

report_verdict report_order(stats_number quotient, double factor)
{
    const double lo = quotient.value - errors_that_decide * quotient.se,
                 hi = quotient.value + errors_that_decide * quotient.se;
    if (isnan(lo)) return REPORT_UNDECIDED;
    if (lo >= 1.0 / factor && hi <= factor) return REPORT_REPRODUCED;
    return lo > factor || hi < 1.0 / factor ? REPORT_NOT_REPRODUCED : REPORT_UNDECIDED;
}

stats_number report_quotient(stats_number a, stats_number b)
{
    const double q = a.value / b.value;
    return (stats_number){q, hypot(a.se, q * b.se) / fabs(b.value)};
}

bool report_fit_rejected(double p_fit)
{
    return p_fit < level;
}

void report_count_verdicts(size_t n, const report_verdict verdicts[], size_t counts[REPORT_VERDICTS])
{
    memset(counts, 0, REPORT_VERDICTS * sizeof *counts);
    for (size_t i = 0; i < n; i++) counts[verdicts[i]]++;
}
