/* Published claims against combinations of choices: closed forms, planted truths, planted effects. */
#include <gsl/gsl_randist.h>
#include <math.h>
#include <stdlib.h>

#include "stats/stats.h"
#include "stats/forensics.h"
#include "core/random.h"
#include "tests/check.h"

/* A claim whose model error far exceeds the published error has the normal density, at any scale. */
static void test_likelihood(void)
{
    const stats_claim value = {STATS_CLAIM_VALUE, 2.385, 1e-9}, falls = {STATS_CLAIM_SIGN, -1.0, 1e-9};
    const double y = 3.1, se = 0.7, z = (y - value.value) / se;
    CHECK_NEAR(stats_claims_log_likelihood(1, &value, &y, &se), -0.5 * z * z - log(se), 1e-12);
    CHECK_NEAR(stats_claims_log_likelihood(1, &falls, &y, &se), log(0.5 * erfc(y / se / sqrt(2.0))), 1e-10);
    /* an exact model: the average over scales of the published error's own density, by a finer sum */
    const stats_claim loose = {STATS_CLAIM_VALUE, 1.0, 0.5};
    const double exact = 0.0, off = 2.0;
    double sum = 0.0;
    const int fine = 20000;
    for (int i = 0; i < fine; i++) {
        double s = 0.2 * pow(10.0, (i + 0.5) / fine), v = 0.25 * s * s;
        sum += exp(-0.5 * (off - 1.0) * (off - 1.0) / v) / sqrt(v);
    }
    /* the mid-point rule with 13 scales is accurate to one per cent */
    CHECK_NEAR(stats_claims_log_likelihood(1, &loose, &off, &exact), log(sum / fine), 0.01);
}

enum { N_CLAIMS = 4, N_COMBINATIONS = 5 };

/* Publications drawn from combination 0 exclude it with probability `level`, and the distant combination
 * nearly always; a combination without a number is not judged. */
static void test_judge(void)
{
    const double level = 0.1;
    const int trials = check_fast() ? 60 : 400;
    double y[N_COMBINATIONS * N_CLAIMS], se[N_COMBINATIONS * N_CLAIMS];
    stats_chance by_chance;
    stats_agreement a[N_COMBINATIONS];
    gsl_rng *rng = rp_random_alloc(11, 0, RP_PURPOSE_TEST);
    for (int c = 0; c < N_COMBINATIONS; c++)
        for (int k = 0; k < N_CLAIMS; k++) {
            y[c * N_CLAIMS + k] = k == 3 ? (c == 1 ? 4.0 : -4.0) : 18.0 + 0.3 * k + (c == 1 ? 6.0 : 0.2 * c);
            se[c * N_CLAIMS + k] = 0.3;
        }
    y[2 * N_CLAIMS + 1] = NAN;
    int excluded = 0, far = 0;
    for (int t = 0; t < trials; t++) {
        stats_claim claims[N_CLAIMS];
        double s = 0.2 * pow(10.0, gsl_rng_uniform(rng));
        for (int k = 0; k < N_CLAIMS; k++) {
            double seen = y[k] + gsl_ran_gaussian(rng, hypot(0.6 * s, 0.3));
            claims[k] = k == 3 ? (stats_claim){STATS_CLAIM_SIGN, copysign(1.0, seen), 0.6}
                               : (stats_claim){STATS_CLAIM_VALUE, seen, 0.6};
        }
        CHECK_OK(
            stats_claims_judge(N_COMBINATIONS, N_CLAIMS, claims, y, se, level, 200, 0, rng, a, &by_chance));
        excluded += a[0].excluded;
        far += a[1].excluded;
        CU_ASSERT(!a[2].complete && a[2].excluded && isnan(a[2].p_value));
        CU_ASSERT(a[0].excluded == (a[0].log_likelihood < a[0].limit));
        /* p-value and limit come from the same draws */
        CU_ASSERT(!a[0].excluded || a[0].p_value <= level + 0.01);
    }
    /* four standard errors of a binomial count, and the limit's own error from 200 draws */
    CHECK_NEAR((double)excluded / trials, level,
               4.0 * sqrt(level * (1.0 - level) * (1.0 / trials + 1.0 / 200.0)));
    CU_ASSERT(far > 0.95 * trials);
    gsl_rng_free(rng);
}

/* A sign needs no error, a number does. */
static void test_errors_of_claims(void)
{
    const stats_claim falls = {STATS_CLAIM_SIGN, -1.0, 0.0}, value = {STATS_CLAIM_VALUE, -1.0, 0.0};
    const double y[] = {-2.0, 2.0}, se[] = {1.0, 1.0};
    stats_agreement a[2];
    stats_chance by_chance;
    gsl_rng *rng = rp_random_alloc(12, 0, RP_PURPOSE_TEST);
    CHECK_OK(stats_claims_judge(2, 1, &falls, y, se, 0.05, 1000, 0, rng, a, &by_chance));
    /* a publication of the first has this sign in 97.7 % of all cases, of the second in 2.3 % */
    CHECK_NEAR(a[0].log_likelihood, log(0.5 * erfc(-2.0 / sqrt(2.0))), 1e-10);
    CU_ASSERT(!a[0].excluded && a[1].excluded);
    CHECK_FAILS(stats_claims_judge(2, 1, &value, y, se, 0.05, 1000, 0, rng, a, &by_chance), RP_BAD_INPUT,
                "a finite value with a positive error");
    gsl_rng_free(rng);
}

/* Equal combinations pass by chance as often as true ones; without draws there is no count.
 */
static void test_chance(void)
{
    const stats_claim claims[2] = {{STATS_CLAIM_VALUE, 1.0, 0.5}, {STATS_CLAIM_VALUE, 1.0, 0.5}};
    const double y[6] = {1.0, 1.0, 1.0, 1.0, 1.0, 1.0}, se[6] = {0.1, 0.1, 0.1, 0.1, 0.1, 0.1};
    stats_agreement a[3];
    stats_chance by_chance;
    gsl_rng *rng = rp_random_alloc(12, 0, RP_PURPOSE_TEST);
    CHECK_OK(stats_claims_judge(3, 2, claims, y, se, 0.2, 2000, 2000, rng, a, &by_chance));
    CHECK_NEAR(by_chance.mean, 3.0 * 0.8, 0.15); /* five errors of 2000 draws, the three in step */
    CHECK_NEAR(by_chance.as_many, 0.8, 0.06); /* all three pass the claims, and pass together or not at all */
    /* two of three have numbers, far apart, and the claims are of the first: in half of the draws both claims
     * are of one combination, which then passes with 0.8 */
    const double far[6] = {1.0, 1.0, NAN, 1.0, 90.0, 90.0};
    CHECK_OK(stats_claims_judge(3, 2, claims, far, se, 0.2, 2000, 2000, rng, a, &by_chance));
    CHECK_NEAR(by_chance.mean, 0.4, 0.06);
    CHECK_NEAR(by_chance.as_many, 0.4, 0.06);
    CHECK_OK(stats_claims_judge(3, 2, claims, y, se, 0.2, 20, 0, rng, a, &by_chance));
    CU_ASSERT(isnan(by_chance.mean) && isnan(by_chance.as_many));
    CU_ASSERT(stats_claims_judge(3, 0, claims, y, se, 0.2, 20, 0, rng, a, &by_chance) == RP_NO_RESULT);
    CU_ASSERT(stats_claims_judge(3, 2, claims, y, se, 1.0, 20, 0, rng, a, &by_chance) == RP_BAD_INPUT);
    CU_ASSERT(stats_claims_judge(3, 2, claims, y, se, 0.2, 19, 0, rng, a, &by_chance) == RP_BAD_INPUT);
    const stats_claim sure = {STATS_CLAIM_VALUE, 1.0, 0.0};
    CU_ASSERT(stats_claims_judge(1, 1, &sure, y, se, 0.2, 20, 0, rng, a, &by_chance) == RP_BAD_INPUT);
    gsl_rng_free(rng);
}

/* A design of three factors with 2, 3 and 2 levels, twice each. */
enum { N_DESIGN = 24 };
static const size_t n_levels[3] = {2, 3, 2};

static void make_design(size_t level[])
{
    for (size_t i = 0; i < N_DESIGN; i++) {
        level[3 * i] = i % 2;
        level[3 * i + 1] = i / 2 % 3;
        level[3 * i + 2] = i / 6 % 2;
    }
}

/* Without noise the effects are exact; with noise the intervals have their coverage. */
static void test_effects(void)
{
    const double planted[4] = {-1.7, 0.6, 2.2, 0.05};
    size_t level[3 * N_DESIGN];
    double y[N_DESIGN], residual;
    stats_effect e[4];
    make_design(level);
    gsl_rng *rng = rp_random_alloc(13, 0, RP_PURPOSE_TEST);
    const int trials = 400;
    int covered = 0;
    for (int t = 0; t <= trials; t++) {
        for (size_t i = 0; i < N_DESIGN; i++)
            y[i] = 18.0 + (double)level[3 * i] * planted[0] + (level[3 * i + 1] == 1) * planted[1] +
                   (level[3 * i + 1] == 2) * planted[2] + (double)level[3 * i + 2] * planted[3] +
                   (t > 0 ? gsl_ran_gaussian(rng, 0.8) : 0.0);
        CHECK_OK(stats_effects(N_DESIGN, 3, level, n_levels, y, e, &residual));
        for (int k = 0; k < 4; k++) {
            if (t == 0) CHECK_NEAR(e[k].effect, planted[k], 1e-12);
            covered += t > 0 && e[k].lo <= planted[k] && planted[k] <= e[k].hi;
            CU_ASSERT(t == 0 || (e[k].p_value < 0.05) == (e[k].lo > 0.0 || e[k].hi < 0.0));
        }
        if (t == 0) CHECK_NEAR(residual, 0.0, 1e-12);
    }
    CHECK_NEAR(covered / (4.0 * trials), 0.95, 4.0 * sqrt(0.95 * 0.05 / trials));
    gsl_rng_free(rng);
}

static void test_effects_errors(void)
{
    size_t level[3 * N_DESIGN];
    double y[N_DESIGN] = {0}, residual;
    stats_effect e[4];
    make_design(level);
    CU_ASSERT(stats_effects(5, 3, level, n_levels, y, e, &residual) == RP_NO_RESULT);
    for (size_t i = 0; i < N_DESIGN; i++) level[3 * i + 2] = level[3 * i]; /* two factors in step */
    CU_ASSERT(stats_effects(N_DESIGN, 3, level, n_levels, y, e, &residual) == RP_NO_RESULT);
}

void suite_forensics(void)
{
    static const check_case cases[] = {
        {"likelihood of claims", test_likelihood},
        {"planted combination", test_judge},
        {"errors of claims", test_errors_of_claims},
        {"passing by chance", test_chance},
        {"planted effects", test_effects},
        {"errors of effects", test_effects_errors},
        {NULL, NULL},
    };
    check_register("forensics", cases);
}
