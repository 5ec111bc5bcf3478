/* Verdicts on published claims; see verdict.h. */
#include "report/verdict.h"

#include <gsl/gsl_cdf.h>
#include <math.h>

static const double errors_that_decide = 2.0, level = 0.05;

const char *report_verdict_text(report_verdict verdict, bool own)
{
    static const char *const texts[][REPORT_VERDICTS] = {{"reproduced", "not reproduced", "open", "no data"},
                                                         {"supported", "not supported", "open", "no data"}};
    return texts[own][verdict];
}

stats_number report_of_few(stats_number mean, double n)
{
    if (n >= 2.0) mean.se *= gsl_cdf_tdist_Qinv(0.025, n - 1.0) / errors_that_decide;
    return mean;
}

double report_deviation_error(double sd, double n)
{
    return n >= 2.0 ? sd / sqrt(2.0 * (n - 1.0)) : NAN;
}

report_verdict report_agree(stats_number ours, stats_number published, double margin,
                            const report_chances *raised, double *z)
{
    const double difference = ours.value - published.value, se = hypot(ours.se, published.se);
    *z = difference / se;
    if (!isfinite(difference) || isnan(se)) return REPORT_OPEN;
    if (fabs(difference) > errors_that_decide * se) /* one that is no more significant is no agreement */
        return !raised || raised->effect < report_agree_p(errors_that_decide) ? REPORT_NOT_REPRODUCED
                                                                              : REPORT_OPEN;
    return errors_that_decide * se <= margin ? REPORT_REPRODUCED : REPORT_OPEN;
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

double report_exceed_p_margin(stats_number a, stats_number b, int sign, double margin)
{
    const double difference = sign * (a.value - b.value), se = hypot(a.se, b.se);
    return se > 0.0 && isfinite(margin) ? gsl_cdf_ugaussian_Q((margin - difference) / se) : NAN;
}

report_verdict report_exceed(stats_number a, stats_number b, int sign, const report_chances *p)
{
    const double difference = sign * (a.value - b.value);
    const bool exact = hypot(a.se, b.se) == 0.0 && !isnan(difference);
    if (isinf(difference)) return REPORT_OPEN;
    const bool small = !exact && p->margin < level;
    if (exact || p->effect < report_agree_p(errors_that_decide))
        return difference <= 0.0 ? REPORT_NOT_REPRODUCED : small ? REPORT_OPEN : REPORT_REPRODUCED;
    return small ? REPORT_NOT_REPRODUCED : REPORT_OPEN;
}

report_verdict report_bound(double value, double limit, int sign)
{
    if (!isfinite(value) || !isfinite(limit)) return REPORT_OPEN;
    return sign * value >= sign * limit ? REPORT_REPRODUCED : REPORT_NOT_REPRODUCED;
}

static bool within(const report_change *change, double margin)
{
    return change->lo90 > -margin && change->hi90 < margin;
}

report_verdict report_equivalent(const report_change *change, double margin, const report_chances *raised)
{
    if (isinf(change->lo90) || isinf(change->hi90)) return REPORT_OPEN;
    if (raised ? raised->margin < level : within(change, margin)) return REPORT_REPRODUCED;
    const bool beyond = change->lo90 > margin || change->hi90 < -margin;
    return (raised ? raised->effect < level : beyond) ? REPORT_NOT_REPRODUCED : REPORT_OPEN;
}

report_verdict report_trends(const report_change *change, int sign, double margin,
                             const report_chances *raised)
{
    const double middle = 0.5 * (change->lo90 + change->hi90);
    const bool small = sign * (sign > 0 ? change->hi90 : change->lo90) < margin;
    if (!isfinite(middle)) return REPORT_OPEN;
    if ((raised ? raised->effect : change->p_value) < level)
        return sign * middle < 0.0 ? REPORT_NOT_REPRODUCED : small ? REPORT_OPEN : REPORT_REPRODUCED;
    return small ? REPORT_NOT_REPRODUCED : REPORT_OPEN;
}

report_together report_joint(size_t n, const stats_number differences[])
{
    report_together t = {0};
    double weights = 0.0, sum = 0.0;
    for (size_t i = 0; i < n; i++) {
        const stats_number d = differences[i];
        const double weight = 1.0 / (d.se * d.se);
        t.chi2 += weight * d.value * d.value, weights += weight, sum += weight * d.value;
    }
    t.shift = (stats_number){sum / weights, 1.0 / sqrt(weights)};
    t.left = t.chi2 - t.shift.value * sum;
    t.p = gsl_cdf_chisq_Q(t.chi2, (double)n);
    t.p_left = gsl_cdf_chisq_Q(t.left, (double)n - 1.0);
    t.verdict = report_bound(t.p, level, 1);
    return t;
}

report_verdict report_order(stats_number quotient, double factor)
{
    const double lo = quotient.value - errors_that_decide * quotient.se,
                 hi = quotient.value + errors_that_decide * quotient.se;
    if (!isfinite(lo)) return REPORT_OPEN;
    if (lo >= 1.0 / factor && hi <= factor) return REPORT_REPRODUCED;
    return lo > factor || hi < 1.0 / factor ? REPORT_NOT_REPRODUCED : REPORT_OPEN;
}

stats_number report_quotient(stats_number a, stats_number b)
{
    const double q = a.value / b.value;
    return (stats_number){q, hypot(a.se, q * b.se) / fabs(b.value)};
}
