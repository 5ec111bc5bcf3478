/* Power and number of values: closed forms, textbook's numbers, and piles that are drawn and judged. */
#include <gsl/gsl_cdf.h>
#include <gsl/gsl_randist.h>
#include <math.h>

#include "core/random.h"
#include "stats/verdict.h"
#include "stats/samplesize.h"
#include "stats/stats.h"
#include "tests/check.h"

/* A power is an average over 64 quantiles of the estimated error. */
static const double POWER_ERROR = 1e-3;

/* Above 0 by two standard errors; a change of at most 1 is none. */
static const stats_rule above = {0.0, INFINITY, 0.025, 2.0}, none = {-1.0, 1.0, 0.05, 1.6448536269514722};

/* Known errors: the normal distribution. The error falls as the root of the number of values. */
static void test_known_errors(void)
{
    const stats_pilot pilot = {.se = 0.75, .n = 16.0, .dof = INFINITY};
    CHECK_NEAR(stats_power(&above, &pilot, 1.2, 16.0), gsl_cdf_ugaussian_P(1.2 / 0.75 - 2.0), 1e-15);
    CHECK_NEAR(stats_power(&above, &pilot, 1.2, 64.0), gsl_cdf_ugaussian_P(1.2 / 0.375 - 2.0), 1e-15);
    CHECK_NEAR(stats_power(&none, &pilot, 0.0, 144.0), 2.0 * gsl_cdf_ugaussian_P(4.0 - none.known) - 1.0,
               1e-14);
    CHECK_NEAR(stats_power(&none, &pilot, 0.25, 144.0),
               gsl_cdf_ugaussian_P(3.0 - none.known) - gsl_cdf_ugaussian_P(none.known - 5.0), 1e-14);
    CHECK_NEAR(stats_power(&none, &pilot, 0.0, 16.0), 0.0, 0.0); /* the interval is wider than the margins */
    CHECK_NEAR(stats_sample_size(&above, &pilot, 1.2, 0.95),
               ceil(16.0 * pow((2.0 + none.known) * 0.75 / 1.2, 2.0)), 0.0);
    CHECK_NEAR(stats_sample_size(&none, &pilot, 0.0, 0.95),
               ceil(16.0 * pow((none.known + gsl_cdf_ugaussian_Pinv(0.975)) * 0.75, 2.0)), 0.0);
    /* up to a thousand million, and none beyond */
    for (double n = 9e8; n < 1.2e9; n += 2e8) {
        const double found = stats_sample_size(&above, &pilot, 3.0 * (2.0 + none.known) / sqrt(n), 0.95);
        CU_ASSERT(n > 1e9 ? isinf(found) : fabs(found - n) < 10.0);
    }
}

/* Power by its definition: the estimate is normal about the effect, and its estimated error a root of chi^2
 * over its degrees of freedom, at the middles of 64 equal parts of its chance, or the true one where they are
 * many. */
static double power_by_hand(const stats_rule *rule, const stats_pilot *p, double effect, double n)
{
    const double se = p->se * sqrt(p->n / n), dof = fmax(p->dof * (n - 1.0) / (p->n - 1.0), 1.0),
                 sigma = sqrt(se * se + p->fixed * p->fixed);
    const bool many = dof > 5000.0;
    const double t = isinf(dof) ? rule->known : gsl_cdf_tdist_Qinv(rule->level, dof);
    double sum = 0.0;
    for (int i = 0; i < 64; i++) {
        const double estimated = many ? 1.0 : sqrt(gsl_cdf_chisq_Pinv((2.0 * i + 1.0) / 128.0, dof) / dof),
                     within = sqrt(pow(t * se * estimated, 2.0) + pow(rule->known * p->fixed, 2.0)),
                     from = rule->from + within, to = rule->to - within;
        if (from < to)
            sum += gsl_cdf_ugaussian_P((to - effect) / sigma) - gsl_cdf_ugaussian_P((from - effect) / sigma);
    }
    return sum / 64.0;
}

static void test_by_hand(void)
{
    static const stats_pilot pilots[] = {{0.4, 7.0, 6.0, 0.0},      {0.4, 16.0, 3.0, 0.1},
                                         {0.9, 12.0, 30.0, 0.0},    {0.2, 9.0, 2e4, 0.05},
                                         {0.3, 5.0, INFINITY, 0.2}, {0.6, 9.0, 4.0, 0.8}};
    static const stats_rule *const rules[] = {&above, &none};
    for (size_t k = 0; k < sizeof pilots / sizeof *pilots; k++)
        for (int r = 0; r < 2; r++)
            for (double effect = 0.0; effect < 2.0; effect += 0.6) {
                const stats_pilot *p = &pilots[k];
                size_t least = 2;
                for (double n = 2.0; n < 100.0; n *= 2.1)
                    CHECK_NEAR(stats_power(rules[r], p, effect, n), power_by_hand(rules[r], p, effect, n),
                               1e-12);
                while (least < 40 && power_by_hand(rules[r], p, effect, (double)least) < 0.8) least++;
                if (least < 40) CHECK_NEAR(stats_sample_size(rules[r], p, effect, 0.8), (double)least, 0.0);
            }
    /* without any error the effect decides, at both ends */
    const stats_pilot exact = {.se = 0.0, .n = 2.0, .dof = INFINITY};
    static const double effects[] = {-1.5, -0.5, 0.5, 1.5};
    for (int k = 0; k < 4; k++)
        CHECK_NEAR(stats_power(&none, &exact, effects[k], 2.0), fabs(effects[k]) < 1.0, 0.0);
    CHECK_NEAR(stats_sample_size(&above, &exact, 0.1, 0.8), 2.0, 0.0);
}

/* The error of a published number stays: it bounds the power of any number of values. */
static void test_fixed_errors(void)
{
    const stats_pilot pilot = {.se = 0.6, .n = 9.0, .dof = INFINITY, .fixed = 0.8};
    CHECK_NEAR(stats_power(&above, &pilot, 3.0, 9.0), gsl_cdf_ugaussian_P(1.0), 1e-15);
    CHECK_NEAR(stats_power(&above, &pilot, 3.0, INFINITY), gsl_cdf_ugaussian_P(3.0 / 0.8 - 2.0), 1e-15);
    CU_ASSERT(isfinite(stats_sample_size(&above, &pilot, 3.0, 0.95)));
    CU_ASSERT(isinf(stats_sample_size(&above, &pilot, 2.9, 0.95))); /* 2.9/0.8 - 2 < 1.645 */
    const stats_pilot student = {.se = 0.6, .n = 9.0, .dof = 8.0, .fixed = 0.8};
    CU_ASSERT(isinf(stats_sample_size(&above, &student, 2.9, 0.95)));
    CHECK_NEAR(stats_power(&above, &student, 2.9, 1e7), gsl_cdf_ugaussian_P(2.9 / 0.8 - 2.0), 1e-3);
    CU_ASSERT(isnan(stats_power(&above, &(stats_pilot){.se = NAN, .n = 4.0, .dof = 3.0}, 1.0, 8.0)));
    for (int k = 0; k < 8;
         k++) { /* a pilot or an effect that is not known, with an error that is, or is estimated */
        const double dof = k / 4 ? INFINITY : 3.0;
        const stats_pilot p = {.se = k % 4 == 0 ? NAN : 1.0,
                               .n = 4.0,
                               .dof = k % 4 == 1 ? NAN : dof,
                               .fixed = k % 4 == 2 ? NAN : 0.5};
        const double effect = k % 4 == 3 ? NAN : 1.0;
        CU_ASSERT(isnan(stats_power(&above, &p, effect, 8.0)) && isnan(stats_power(&none, &p, effect, 8.0)));
        CU_ASSERT(isnan(stats_sample_size(&none, &p, effect, 0.95)));
    }
    CU_ASSERT(isnan(stats_sample_size(&above, &(stats_pilot){.se = 1.0, .n = NAN, .dof = 3.0}, 1.0, 0.95)));
    const stats_pilot exact = {.se = 0.0, .n = 2.0, .dof = INFINITY};
    CHECK_NEAR(stats_power(&above, &exact, 0.1, 2.0), 1.0, 0.0);
    CHECK_NEAR(stats_power(&above, &exact, -0.1, 2.0), 0.0, 0.0);
}

/* One-sample t tests, two-sided at 5 %, effect of half a standard deviation: 34, 44 and 54 values in tables
 * of the power of t tests (Cohen 1988). */
static void test_textbook(void)
{
    static const struct {
        double power, n;
    } rows[] = {{0.80, 34.0}, {0.90, 44.0}, {0.95, 54.0}};
    const stats_pilot pilot = {.se = 2.0 / sqrt(12.0), .n = 12.0, .dof = 11.0};
    for (size_t k = 0; k < sizeof rows / sizeof *rows; k++) {
        const double n = stats_sample_size(&above, &pilot, 1.0, rows[k].power);
        CHECK_NEAR(n, rows[k].n, 0.0);
        CU_ASSERT(stats_power(&above, &pilot, 1.0, n) >= rows[k].power);
        CU_ASSERT(stats_power(&above, &pilot, 1.0, n - 1.0) < rows[k].power);
    }
}

/* At another number of values the error falls as its root, and the degrees of freedom grow with it: two
 * pilots with five of them at 6 and at 9 values. They are 1 at least. */
static void test_degrees_of_freedom(void)
{
    const stats_pilot six = {.se = 0.5, .n = 6.0, .dof = 5.0},
                      three = {.se = 0.5 * sqrt(3.0), .n = 3.0, .dof = 1.25};
    CHECK_NEAR(stats_power(&above, &three, 1.1, 9.0), stats_power(&above, &six, 1.1, 6.0), 1e-14);
    double power[3];
    for (int k = 0; k < 3; k++)
        power[k] = stats_power(&above, &(stats_pilot){.se = 0.5, .n = 6.0, .dof = 0.5 * (k + 1)}, 1.1, 6.0);
    CHECK_NEAR(power[0], power[1], 0.0);
    CU_ASSERT(power[2] > power[1]);
}

enum { PILES = 6, CASES = 20000 };

/* Shares of drawn ensembles that the verdicts decide: a mean above 0, and a paired change that is none. */
static void draw_shares(double mean, double sd, double *share_above, double *share_none)
{
    gsl_rng *rng = rp_random_alloc(1993, 11, RP_PURPOSE_TEST);
    double x[2 * PILES], y[2 * PILES], pile[2 * PILES];
    *share_above = *share_none = 0.0;
    for (int k = 0; k < CASES; k++) {
        stats_summary s;
        stats_trend t;
        stats_change change = {.p_value = 1.0};
        for (int i = 0; i < PILES; i++) {
            const double common = gsl_ran_gaussian(rng, 5.0);
            for (int j = 0; j < 2; j++) {
                x[2 * i + j] = j;
                pile[2 * i + j] = i;
                y[2 * i + j] = common + (j ? gsl_ran_gaussian(rng, sd) : 0.0);
            }
        }
        CHECK_OK(stats_trend_fit(2 * PILES, x, y, pile, 0.0, 1.0, &t));
        stats_contrast_interval(&t.change, 0.9, &change.lo90, &change.hi90);
        *share_none += stats_equivalent(&change, 1.0) == STATS_REPRODUCED;
        for (int i = 0; i < PILES; i++) y[i] = mean + gsl_ran_gaussian(rng, sd);
        CHECK_OK(stats_mean(PILES, y, &s));
        const stats_number own = stats_of_few((stats_number){s.mean, s.se}, PILES);
        *share_above += stats_exceed(own, (stats_number){0.0, 0.0}, 1, INFINITY) == STATS_REPRODUCED;
    }
    gsl_rng_free(rng);
    *share_above /= CASES;
    *share_none /= CASES;
}

/* The power of a pilot with other numbers of piles is that of the verdicts on drawn ensembles. */
static void test_drawn_ensembles(void)
{
    static const double sds[] = {0.7, 1.0, 1.6};
    for (size_t k = 0; k < sizeof sds / sizeof *sds; k++) {
        double share_above, share_none;
        const stats_pilot pilot = {.se = sds[k] / sqrt(15.0), .n = 15.0, .dof = 14.0};
        const double p_above = stats_power(&above, &pilot, 1.1, PILES),
                     p_none = stats_power(&none, &pilot, 0.0, PILES);
        draw_shares(1.1, sds[k], &share_above, &share_none);
        CHECK_NEAR(share_above, p_above, POWER_ERROR + 4.0 * sqrt(p_above * (1.0 - p_above) / CASES));
        CHECK_NEAR(share_none, p_none, POWER_ERROR + 4.0 * sqrt(p_none * (1.0 - p_none) / CASES));
        CU_ASSERT(p_above > 0.2 && p_above < 0.95);
    }
}

void suite_samplesize(void)
{
    static const check_case cases[] = {{"by its definition", test_by_hand},
                                       {"known errors", test_known_errors},
                                       {"errors that stay", test_fixed_errors},
                                       {"t tests of the textbook", test_textbook},
                                       {"degrees of freedom", test_degrees_of_freedom},
                                       {"drawn ensembles", test_drawn_ensembles},
                                       {0}};
    check_register("samplesize", cases);
}
