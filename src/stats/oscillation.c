/* A series that decays and oscillates; see stats.h. */
#include <math.h>
#include <stdlib.h>

#include "stats/stats.h"

/* 1, t, cosine, sine, and the derivative by the frequency, which gives its error. */
enum { TERMS = 4, WITH_FREQUENCY = 5 };

typedef struct {
    size_t n;
    const double *t, *y;
    double from; /* first t */
    double *X;   /* [n WITH_FREQUENCY] */
    double c[WITH_FREQUENCY], covariance[WITH_FREQUENCY * WITH_FREQUENCY], squares;
    rp_status status;
} problem;

/* The terms at a frequency; the last needs the coefficients of the others. */
static void set_terms(problem *s, double frequency, size_t terms)
{
    for (size_t i = 0; i < s->n; i++) {
        const double t = s->t[i] - s->from, w = 2.0 * M_PI * t;
        double *x = s->X + terms * i;
        x[0] = 1.0;
        x[1] = t;
        x[2] = cos(w * frequency);
        x[3] = sin(w * frequency);
        if (terms == WITH_FREQUENCY) x[4] = w * (s->c[3] * x[2] - s->c[2] * x[3]);
    }
}

static void solve(problem *s, size_t terms)
{
    size_t rank;
    if (!s->status)
        s->status =
            stats_multifit(s->n, terms, s->X, NULL, s->y, 1e-12, s->c, s->covariance, &s->squares, &rank);
}

static double squares_at(const double x[], void *data)
{
    problem *s = data;
    set_terms(s, x[0], TERMS);
    solve(s, TERMS);
    return s->squares;
}

/* Variances of the slope and of the frequency, [0] and [1]. Residuals of a simulation are other modes, thus
 * correlated whatever the sampling: the scores x (y - fit) are summed over each period, and sums of different
 * periods taken as independent (Liang & Zeger 1986). */
static void period_variances(const problem *s, double frequency, double variances[2])
{
    const size_t terms = WITH_FREQUENCY, wanted[2] = {1, WITH_FREQUENCY - 1};
    const double scale = s->squares / (double)(s->n - terms);
    double sums[2] = {0.0}, squares[2] = {0.0};
    size_t periods = 0;
    for (size_t i = 0; i < s->n; i++) {
        const double *x = s->X + terms * i;
        double residual = s->y[i];
        for (size_t k = 0; k < terms; k++) residual -= s->c[k] * x[k];
        for (size_t v = 0; v < 2; v++)
            for (size_t k = 0; k < terms; k++)
                sums[v] += s->covariance[terms * wanted[v] + k] / scale * x[k] * residual;
        const double period = floor((s->t[i] - s->from) * frequency);
        if (i + 1 < s->n && floor((s->t[i + 1] - s->from) * frequency) == period) continue;
        periods++;
        for (size_t v = 0; v < 2; v++) {
            squares[v] += sums[v] * sums[v];
            sums[v] = 0.0;
        }
    }
    const double n = (double)s->n, groups = (double)periods;
    for (size_t v = 0; v < 2; v++)
        variances[v] = squares[v] * groups / (groups - 1.0) * (n - 1.0) / (n - (double)terms);
}

static rp_status fit(problem *s, double lo, double hi, stats_oscillation *fit)
{
    const double range = s->t[s->n - 1] - s->from;
    stats_line line;
    double at[2], least;
    RP_TRY(stats_line_fit(s->n, s->t, s->y, NULL, false, &line));
    /* four cells within the width of a peak, 1/range */
    RP_TRY(stats_least(squares_at, s, (double[]){lo, 0.0}, (double[]){hi, 0.0},
                       (int)ceil(4.0 * range * (hi - lo)), at, &least));
    squares_at(at, s);
    const double amplitude = hypot(s->c[2], s->c[3]), slope = s->c[1];
    set_terms(s, at[0], WITH_FREQUENCY);
    solve(s, WITH_FREQUENCY);
    if (s->status) return s->status;
    double variances[2];
    period_variances(s, at[0], variances);
    *fit = (stats_oscillation){.n = s->n,
                               .decay = -slope,
                               .decay_se = sqrt(variances[0]),
                               .frequency = at[0],
                               .frequency_se = sqrt(variances[1]),
                               .amplitude = amplitude,
                               .share = 1.0 - least / line.chi2};
    return RP_OK;
}

rp_status stats_oscillation_fit(size_t n, const double t[], const double y[], stats_oscillation *oscillation)
{
    *oscillation = (stats_oscillation){n, NAN, NAN, NAN, NAN, NAN, NAN};
    if (n < 16) return rp_fail(RP_NO_RESULT, "%zu values: at least 16 needed", n);
    for (size_t i = 1; i < n; i++)
        if (!(t[i] > t[i - 1]))
            return rp_fail(RP_BAD_INPUT, "value %zu at %g, after %g: increasing numbers expected", i + 1,
                           t[i], t[i - 1]);
    problem s = {.n = n, .t = t, .y = y, .from = t[0], .X = malloc(WITH_FREQUENCY * n * sizeof *s.X)};
    if (!s.X) return rp_fail(RP_NO_MEMORY, "oscillation: out of memory");
    const double range = t[n - 1] - t[0];
    rp_status status = fit(&s, 2.0 / range, 0.5 * ((double)n - 1.0) / range, oscillation);
    free(s.X);
    return status ? status : s.status;
}
