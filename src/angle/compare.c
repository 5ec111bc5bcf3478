/* Measured piles against theory: Lee & Herrmann 1993, Fig. 7; see angle.h.
 *
 * (4) is taken at the mean theta_r. Its error and those of the differences come from one bootstrap: each
 * resample of the piles gives a mean theta_r and a mean theta_t, and (4) at that theta_r, so that the
 * correlation of the two angles within a pile is kept. */
#include <float.h>
#include <math.h>
#include <string.h>

#include "angle/angle.h"
#include "core/arena.h"

enum { OF_FORM = 5, N_QUANTITIES = 1 + OF_FORM * ANG_N_FORMS };

/* Means of theta_r and theta_t over as many piles, drawn with replacement. */
static void resample(const ang_piles *piles, rp_random *rng, double *r, double *t)
{
    double r_sum = 0.0, t_sum = 0.0;
    for (size_t i = 0; i < piles->n; i++) {
        const size_t k = rp_random_below(rng, piles->n);
        r_sum += piles->theta_r[k];
        t_sum += piles->theta_t[k];
    }
    *r = r_sum / (double)piles->n;
    *t = t_sum / (double)piles->n;
}

/* diff_ms, then of each form theta_t, diff, theta_rt, gain and gain_relative, for mean angles r and t. (4)
 * has no angle where r is below 0, as it may come out for nearly flat piles. */
static rp_status quantities(double mu, double phi, double theta_ms, double r, double t,
                            double q[N_QUANTITIES], ang_tilt_status word[ANG_N_FORMS])
{
    const double miss_ms = fabs(r + t - theta_ms);
    q[0] = r + t - theta_ms;
    for (int f = 0; f < ANG_N_FORMS; f++) {
        ang_tilt_result tilt = {ANG_TILT_NO_PILE, NAN, NAN, NAN, NAN};
        if (r >= 0.0) RP_TRY(ang_tilt((ang_form)f, mu, r, phi, &tilt));
        const double miss = fabs(t - tilt.theta_t);
        memcpy(q + 1 + OF_FORM * f,
               (double[OF_FORM]){tilt.theta_t, t - tilt.theta_t, r + tilt.theta_t, miss - miss_ms,
                                 miss / fabs(t) - miss_ms / fabs(r + t)},
               OF_FORM * sizeof *q);
        word[f] = tilt.status;
    }
    return RP_OK;
}

/* The estimates of q and their errors over the resamples sample[N_QUANTITIES][n_resamples]. Means of n
 * resampled piles spread as the standard deviation with n below the root, not n - 1. */
static void take_estimates(size_t n, const double q[], size_t n_resamples, double sample[], ang_comparison *c)
{
    const double unbias = sqrt((double)n / (double)(n - 1));
    stats_number all[N_QUANTITIES];
    for (int k = 0; k < N_QUANTITIES; k++) {
        size_t used;
        const double sd = stats_resampled(n_resamples, sample + (size_t)k * n_resamples, &used);
        all[k] = (stats_number){q[k], n > 1 && !isnan(q[k]) ? unbias * sd : NAN};
        if (n > 1 && n_resamples - used > c->n_lost) c->n_lost = n_resamples - used;
    }
    c->diff_ms = all[0];
    for (int f = 0; f < ANG_N_FORMS; f++) {
        const stats_number *e = all + 1 + OF_FORM * f;
        c->form[f].theta_t = e[0];
        c->form[f].diff = e[1];
        c->form[f].theta_rt = e[2];
        c->form[f].gain = e[3];
        c->form[f].gain_relative = e[4];
    }
}

rp_status ang_compare(const ang_piles *piles, double phi, size_t n_resamples, rp_random *rng,
                      ang_comparison *c)
{
    const size_t n = piles->n;
    const double *theta_r = piles->theta_r, *theta_t = piles->theta_t, mu = piles->mu;
    ang_tilt_status word[ANG_N_FORMS];
    double q[N_QUANTITIES], one[N_QUANTITIES];
    *c = (ang_comparison){0};
    RP_TRY(ang_marginal(mu, phi, &c->theta_ms, NULL));
    RP_TRY(stats_mean(n, theta_r, &c->theta_r));
    RP_TRY(stats_mean(n, theta_t, &c->theta_t));
    RP_TRY(stats_paired(n, theta_r, 1.0, theta_t, &c->theta_rt));
    RP_TRY(quantities(mu, phi, c->theta_ms, c->theta_r.mean, c->theta_t.mean, q, word));
    RP_TRY(rp_check_range("resamples", (double)n_resamples, 2.0, DBL_MAX, "[2, inf)"));
    for (size_t i = 0; i < n; i++) c->n_unstable += theta_r[i] > c->theta_ms;
    for (int f = 0; f < ANG_N_FORMS; f++) c->form[f].status = word[f];
    RP_SCOPE(memory);
    double *sample;
    RP_NEW(&memory, sample, N_QUANTITIES * n_resamples);
    for (size_t i = 0; i < n_resamples; i++) {
        double r, t;
        resample(piles, rng, &r, &t);
        RP_TRY(quantities(mu, phi, c->theta_ms, r, t, one, word));
        for (size_t k = 0; k < N_QUANTITIES; k++) sample[k * n_resamples + i] = one[k];
    }
    take_estimates(n, q, n_resamples, sample, c);
    return RP_OK;
}
