/* Measured piles against theory: Lee & Herrmann 1993, Fig. 7; see angle.h.
 *
 * (4) is taken at the mean theta_r. Its error and those of the differences come from one bootstrap: each
 * resample of the piles gives a mean theta_r and a mean theta_t, and (4) at that theta_r, so that the
 * correlation of the two angles within a pile is kept. */
#include <math.h>

#include "angle/angle.h"
#include "stats/stats.h"

/* Running variance (Welford). */
typedef struct {
    size_t n;
    double mean, squares;
} spread;

static void add(spread *s, double v)
{
    double d = v - s->mean;
    s->n++;
    s->mean += d / (double)s->n;
    s->squares += d * (v - s->mean);
}

static double deviation(const spread *s)
{
    return s->n > 1 ? sqrt(s->squares / (double)(s->n - 1)) : NAN;
}

static void resample(size_t n, const double a[], const double b[], gsl_rng *rng, double *a_mean,
                     double *b_mean)
{
    double a_sum = 0.0, b_sum = 0.0;
    for (size_t i = 0; i < n; i++) {
        size_t k = gsl_rng_uniform_int(rng, n);
        a_sum += a[k];
        b_sum += b[k];
    }
    *a_mean = a_sum / (double)n;
    *b_mean = b_sum / (double)n;
}

/* (4) at a mean theta_r, which may come out below 0 for piles that are nearly flat: then there is none. */
static rp_status tilt_at(ang_form form, double mu, double theta_r, double phi, ang_tilt_result *tilt)
{
    if (theta_r >= 0.0) return ang_tilt(form, mu, theta_r, phi, tilt);
    *tilt = (ang_tilt_result){ANG_TILT_NO_PILE, NAN, NAN, NAN, NAN};
    return RP_OK;
}

/* How much nearer (4) comes to the measured theta_t than (3) to the measured sum: negative is nearer. */
static double gain(double theta_t, double form, double theta_rt, double theta_ms)
{
    return fabs(theta_t - form) - fabs(theta_rt - theta_ms);
}

static double gain_relative(double theta_t, double form, double theta_rt, double theta_ms)
{
    return fabs(theta_t - form) / fabs(theta_t) - fabs(theta_rt - theta_ms) / fabs(theta_rt);
}

static rp_status central_values(double mu, double phi, ang_comparison *c)
{
    c->diff_ms = (ang_estimate){c->theta_rt.mean - c->theta_ms, NAN};
    for (int f = 0; f < ANG_N_FORMS; f++) {
        ang_tilt_result tilt;
        rp_status status = tilt_at((ang_form)f, mu, c->theta_r.mean, phi, &tilt);
        if (status) return status;
        c->form[f].status = tilt.status;
        c->form[f].theta_t = (ang_estimate){tilt.theta_t, NAN};
        c->form[f].diff = (ang_estimate){c->theta_t.mean - tilt.theta_t, NAN};
        c->form[f].theta_rt = (ang_estimate){c->theta_r.mean + tilt.theta_t, NAN};
        c->form[f].gain =
            (ang_estimate){gain(c->theta_t.mean, tilt.theta_t, c->theta_rt.mean, c->theta_ms), NAN};
        c->form[f].gain_relative =
            (ang_estimate){gain_relative(c->theta_t.mean, tilt.theta_t, c->theta_rt.mean, c->theta_ms), NAN};
    }
    return RP_OK;
}

rp_status ang_compare(size_t n, const double theta_r[], const double theta_t[], double mu, double phi,
                      size_t n_resamples, gsl_rng *rng, ang_comparison *comparison)
{
    ang_comparison *c = comparison;
    *c = (ang_comparison){0};
    rp_status status = ang_marginal(mu, phi, &c->theta_ms, NULL);
    if (!status) status = stats_mean(n, theta_r, &c->theta_r);
    if (!status) status = stats_mean(n, theta_t, &c->theta_t);
    if (!status) status = stats_paired(n, theta_r, 1.0, theta_t, &c->theta_rt);
    if (!status) status = central_values(mu, phi, c);
    if (!status && n_resamples < 2)
        status = rp_fail(RP_BAD_INPUT, "resamples = %zu: out of range, allowed: [2, inf)", n_resamples);
    if (status) return status;
    for (size_t i = 0; i < n; i++) c->n_unstable += theta_r[i] > c->theta_ms;
    if (n == 1) return RP_OK;

    spread sum = {0}, tilts[ANG_N_FORMS] = {{0}}, diffs[ANG_N_FORMS] = {{0}}, sums[ANG_N_FORMS] = {{0}},
           gains[ANG_N_FORMS] = {{0}}, relative[ANG_N_FORMS] = {{0}};
    for (size_t i = 0; i < n_resamples; i++) {
        double r, t;
        resample(n, theta_r, theta_t, rng, &r, &t);
        add(&sum, r + t);
        for (int f = 0; f < ANG_N_FORMS; f++) {
            ang_tilt_result tilt;
            status = tilt_at((ang_form)f, mu, r, phi, &tilt);
            if (status) return status;
            if (isnan(tilt.theta_t)) continue;
            add(&tilts[f], tilt.theta_t);
            add(&diffs[f], t - tilt.theta_t);
            add(&sums[f], r + tilt.theta_t);
            add(&gains[f], gain(t, tilt.theta_t, r + t, c->theta_ms));
            add(&relative[f], gain_relative(t, tilt.theta_t, r + t, c->theta_ms));
        }
    }
    /* resampling n piles spreads as the standard deviation with n below the root, not n - 1 */
    const double unbias = sqrt((double)n / (double)(n - 1));
    c->diff_ms.se = unbias * deviation(&sum);
    for (int f = 0; f < ANG_N_FORMS; f++) {
        size_t lost = n_resamples - tilts[f].n;
        if (lost > c->n_lost) c->n_lost = lost;
        if (isnan(c->form[f].theta_t.value)) continue;
        c->form[f].theta_t.se = unbias * deviation(&tilts[f]);
        c->form[f].diff.se = unbias * deviation(&diffs[f]);
        c->form[f].theta_rt.se = unbias * deviation(&sums[f]);
        c->form[f].gain.se = unbias * deviation(&gains[f]);
        c->form[f].gain_relative.se = unbias * deviation(&relative[f]);
    }
    return RP_OK;
}
