/* Calibration by quadratics: planted truths on closed-form stand-ins with noise. Intervals hold the truth as
 * often as they say, the signed roots of chi2 are normal, and what can't be told is said. */
#include <gsl/gsl_cdf.h>
#include <gsl/gsl_randist.h>
#include <gsl/gsl_sort.h>

#include "check.h"
#include "core/random.h"
#include "stats/identify.h"
#include "stats/stats.h"
#include "tests/numbers.h"

/* A simulation that is known: numbers of the names, and the scatter of its runs. */
typedef struct {
    size_t n_names, n_numbers;
    bool degenerate, arch; /* every number is one of the same sum; rises and falls */
    bool plateau, kink;    /* the sum of degenerate ones levels off; a kink across both names */
    double fails;          /* the sum of the first two names above which runs have no number; 0: none; below
                              0: minus the last name alone */
    double scatter[STATS_NUMBERS];
    gsl_rng *noise;
    rp_arena arena;
    long runs;
    void *told;
} stand_in;

static double number_of(const stand_in *s, size_t k, const double x[])
{
    const double a = x[0], b = s->n_names > 1 ? x[1] : 0.5, c = s->n_names > 2 ? x[2] : 0.5;
    if (s->arch) return 30.0 - 100.0 * (a - 0.5) * (a - 0.5);
    if (s->degenerate && s->plateau) return 20.0 * tanh(a + 1.9 * b) + (double)k;
    if (s->degenerate) return 20.0 + 10.0 * (a + 1.9 * b) + (double)k;
    if (s->kink) return 20.0 * fmin(a, 0.2 + 0.5 * b);
    switch (k) {
    case 0: return 15.0 + 22.0 * (1.0 - exp(-2.0 * a)) + 4.0 * b;
    case 1: return 8.0 + 6.0 * b + 3.0 * a * b + 2.0 * c;
    case 2: return 30.0 - 9.0 * sqrt(0.3 + c) + 2.0 * a;
    default: return 5.0 + 3.0 * a - 2.0 * b + c * c;
    }
}

static rp_status run(void *host, size_t stage, size_t *n, const double **x, const size_t replicas[],
                     stats_runs **runs)
{
    stand_in *s = host;
    (void)stage;
    RP_NEW(&s->arena, *runs, *n * s->n_numbers);
    for (size_t i = 0; i < *n; i++)
        for (size_t k = 0; k < s->n_numbers; k++) {
            stats_runs *r = &(*runs)[k * *n + i];
            const double *at = &(*x)[i * s->n_names];
            if (s->fails > 0.0 && at[0] + (s->n_names > 1 ? at[1] : 0.0) > s->fails) continue;
            if (s->fails < 0.0 && at[s->n_names - 1] > -s->fails) continue;
            if (s->fails > 9.0 && fmod(s->fails * at[0], 1.0) < 0.6) continue; /* anywhere */
            for (size_t j = 0; j < replicas[0]; j++) {
                const double y = number_of(s, k, at) + gsl_ran_gaussian(s->noise, s->scatter[k]),
                             d = y - r->mean;
                r->n++, r->mean += d / r->n, r->squares += d * (y - r->mean);
                s->runs++;
            }
        }
    return RP_OK;
}

static void end_noise(stand_in *s)
{
    rp_arena_end(&s->arena);
    gsl_rng_free(s->noise);
}
#define scoped_stand_in __attribute__((cleanup(end_noise))) stand_in

static stats_quest quest_of(stand_in *s, const double truth[], double error)
{
    stats_quest q = {.n_names = s->n_names, .n_numbers = s->n_numbers, .n_groups = 1, .budget = 4000};
    q.host = s, q.run = run;
    for (size_t p = 0; p < q.n_names; p++) q.lo[p] = 0.0, q.hi[p] = 1.0;
    for (size_t k = 0; k < q.n_numbers; k++) {
        q.error[k] = error;
        q.value[k] = number_of(s, k, truth) + gsl_ran_gaussian(s->noise, error);
    }
    return q;
}

/* Kolmogorov's distance from the normal law, times the root of the number. */
static double distance_from_normal(size_t n, double z[])
{
    double most = 0.0;
    gsl_sort(z, 1, n);
    for (size_t i = 0; i < n; i++) {
        const double at = gsl_cdf_ugaussian_P(z[i]);
        most = fmax(most, fmax(fabs(at - (double)i / (double)n), fabs(at - (double)(i + 1) / (double)n)));
    }
    return most * sqrt((double)n);
}

static void planted(size_t n_names)
{
    const size_t n = check_fast() ? 12 : check_full() || n_names == 1 ? 1000 : n_names == 2 ? 500 : 40;
    scoped_stand_in s = {.n_names = n_names, .n_numbers = n_names + 1, .scatter = {1.0, 0.8, 0.6, 0.5}};
    scoped double *z = malloc(n * n_names * sizeof *z);
    size_t inside[STATS_NAMES] = {0}, used = 0, tried = 0, recovered = 0;
    s.noise = numbers_of(2026, n_names);
    for (size_t i = 0; i < n; i++) {
        double truth[STATS_NAMES];
        stats_answer a;
        for (size_t p = 0; p < n_names; p++) truth[p] = 0.3 + 0.4 * gsl_rng_uniform(s.noise);
        stats_quest q = quest_of(&s, truth, 0.4);
        q.leave_out = i < (check_full() ? 20 : check_fast() ? 2 : 9 - 2 * n_names);
        CHECK_OK(stats_identify(&q, &a));
        rp_arena_end(&s.arena);
        bool known = true;
        for (size_t p = 0; p < n_names; p++) known = known && isfinite(a.x[p]);
        if (!known) continue; /* no_match: one case in a hundred */
        tried += a.tried, recovered += a.recovered;
        for (size_t p = 0; p < n_names; p++) {
            inside[p] += truth[p] >= a.own[p].lower && truth[p] <= a.own[p].upper;
            const double side =
                truth[p] > a.x[p] ? (a.own[p].upper - a.x[p]) / 1.96 : (a.x[p] - a.own[p].lower) / 1.96;
            z[used * n_names + p] = (truth[p] - a.x[p]) / side;
        }
        used++;
    }
    CU_ASSERT((double)used >= 0.9 * (double)n);
    for (size_t p = 0; p < n_names; p++) {
        scoped double *own = malloc(used * sizeof *own);
        for (size_t i = 0; i < used; i++) own[i] = z[i * n_names + p];
        const double share = (double)inside[p] / (double)used, far = distance_from_normal(used, own);
        const bool good = check_fast() ? share > 0.7 : n < 500 ? share > 0.88 : share > 0.93 && share < 0.97;
        CU_ASSERT(good && far < 1.95);
    }
    CU_ASSERT((double)recovered > (check_full() ? 0.8 : 0.7) * (double)tried);
}

static void test_one(void)
{
    planted(1);
}
static void test_two(void)
{
    planted(2);
}
static void test_three(void)
{
    planted(3);
}

/* A number that rises and falls: two values give it, each with its interval; near the top one, above none. */
static void test_arch(void)
{
    scoped_stand_in s = {.n_names = 1, .n_numbers = 1, .arch = true, .scatter = {0.5}};
    stats_answer a;
    s.noise = numbers_of(11, 1);
    stats_quest q = quest_of(&s, (double[STATS_NAMES]){0.5}, 0.3);
    q.value[0] = 21.0;
    CHECK_OK(stats_identify(&q, &a));
    CU_ASSERT(a.status[0] == STATS_IDENTIFIED_SEVERAL && a.n_intervals[0] == 2);
    for (int k = 0; k < 2; k++) {
        const stats_interval *i = &a.interval[0][k];
        const double root = 0.5 + (k ? 0.3 : -0.3);
        CHECK_NEAR(i->value, root, 0.02);
        CU_ASSERT(i->lower < root && i->upper > root && i->upper - i->lower < 0.05);
    }
    q.error[0] = 0.2;
    for (int c = 0; c < 50; c++) { /* the form adds an eighth to the error, at the other value too */
        CHECK_OK(stats_identify(&q, &a));
        for (size_t k = 0; k < a.n_intervals[0]; k++) {
            const stats_interval *i = &a.interval[0][k];
            CU_ASSERT((i->upper - i->lower) * 100.0 * fabs(i->value - 0.5) < 1.15 * 1.96 * q.error[0]);
        }
    }
    q.value[0] = 29.9, q.error[0] = 0.3;
    CHECK_OK(stats_identify(&q, &a));
    CU_ASSERT(a.status[0] == STATS_IDENTIFIED_OK && a.own[0].lower < 0.5 && a.own[0].upper > 0.5);
    q.value[0] = 36.0;
    CHECK_OK(stats_identify(&q, &a));
    CU_ASSERT(a.status[0] == STATS_IDENTIFIED_ABOVE_RANGE);
}

/* Numbers that all tell the same sum: that one is found, its parts are not. */
static void test_degenerate(void)
{
    const size_t n = check_fast() ? 50 : 100;
    size_t said = 0, told = 0, inside = 0;
    scoped_stand_in s = {.n_names = 2, .n_numbers = 2, .degenerate = true, .scatter = {0.5, 0.5}};
    s.noise = numbers_of(7, 1);
    for (size_t i = 0; i < n; i++) {
        const double truth[] = {0.3 + 0.4 * gsl_rng_uniform(s.noise), 0.4 + 0.2 * gsl_rng_uniform(s.noise)};
        stats_answer a;
        const stats_quest q = quest_of(&s, truth, 0.3);
        CHECK_OK(stats_identify(&q, &a));
        rp_arena_end(&s.arena);
        said +=
            a.status[0] == STATS_IDENTIFIED_NOT_IDENTIFIED || a.status[1] == STATS_IDENTIFIED_NOT_IDENTIFIED;
        if (!a.determined) continue;
        told++;
        CHECK_NEAR(a.weight[1] / a.weight[0], 1.9, 0.3);
        inside += fabs(a.sum - (truth[0] + a.weight[1] * truth[1])) < 3.0 * a.sum_error;
        CU_ASSERT(a.sum_error < 0.1);
    }
    CU_ASSERT((double)said >= 0.95 * (double)n && (double)told > 0.8 * (double)n &&
              (double)inside > 0.98 * (double)told);
}

static bool below(void *host, const double x[])
{
    (void)host;
    return x[1] < x[0];
}

static void test_statuses(void)
{
    scoped_stand_in s = {.n_names = 1, .n_numbers = 1, .scatter = {1.0}};
    stats_answer a;
    s.noise = numbers_of(8, 1);
    stats_quest q = quest_of(&s, (double[STATS_NAMES]){0.5}, 0.4);
    q.value[0] = 70.0;
    CHECK_OK(stats_identify(&q, &a));
    CU_ASSERT(a.status[0] == STATS_IDENTIFIED_ABOVE_RANGE && isnan(a.x[0]) && a.n_intervals[0] == 0);
    CU_ASSERT(a.stages == 1 && a.n_runs == 24); /* no more runs for what is beyond reach */
    CU_ASSERT(a.reach[0][0] > 16.0 && a.reach[0][0] < 24.0 && a.reach[0][1] > 33.0 && a.reach[0][1] < 38.5);
    q.value[0] = -20.0;
    CHECK_OK(stats_identify(&q, &a));
    CU_ASSERT(a.status[0] == STATS_IDENTIFIED_BELOW_RANGE);
    q.value[0] = number_of(&s, 0, (double[STATS_NAMES]){1.0});
    CHECK_OK(stats_identify(&q, &a));
    CU_ASSERT(a.status[0] == STATS_IDENTIFIED_AT_LEAST && a.own[0].upper == 1.0 && a.own[0].lower > 0.5);
    q.value[0] = number_of(&s, 0, (double[STATS_NAMES]){0.0});
    CHECK_OK(stats_identify(&q, &a));
    CU_ASSERT(a.status[0] == STATS_IDENTIFIED_AT_MOST && a.own[0].lower == 0.0 && a.own[0].upper < 0.4);
    q.value[0] = number_of(&s, 0, (double[STATS_NAMES]){0.4}), q.budget = 30;
    CHECK_OK(stats_identify(&q, &a));
    CU_ASSERT(a.status[0] == STATS_IDENTIFIED_BUDGET && a.n_runs == 24 && a.own[0].lower < 0.4 &&
              a.own[0].upper > 0.4);
    q.budget = 20;
    CHECK_FAILS(stats_identify(&q, &a), RP_BAD_INPUT, "the first stage needs 24 runs");
    q.budget = 400, q.hi[0] = 0.0;
    CHECK_FAILS(stats_identify(&q, &a), RP_BAD_INPUT, "range of name 1");
    q.error[0] = 0.0;
    CHECK_FAILS(stats_identify(&q, &a), RP_BAD_INPUT, "standard error 0");
    q.value[0] = NAN;
    CHECK_FAILS(stats_identify(&q, &a), RP_BAD_INPUT, "number 1: nan");
    q.n_names = 0;
    CHECK_FAILS(stats_identify(&q, &a), RP_BAD_INPUT, "0 names, 1 numbers");
    /* only what is allowed */
    scoped_stand_in t = {.n_names = 2, .n_numbers = 2, .scatter = {0.5, 0.5}};
    t.noise = numbers_of(9, 1);
    stats_quest two = quest_of(&t, (double[STATS_NAMES]){0.6, 0.4}, 0.2);
    two.allowed = below, two.leave_out = true;
    CHECK_OK(stats_identify(&two, &a));
    CU_ASSERT(a.x[1] < a.x[0] && a.status[0] == STATS_IDENTIFIED_OK && a.tried > 10);
    CHECK_PAIRS(1e-12, {a.correlation[0][0], 1.0}, {a.correlation[0][1], a.correlation[1][0]});
}

static rp_status run_fixed(void *host, size_t stage, size_t *n, const double **x, const size_t replicas[],
                           stats_runs **runs)
{
    static const double at[] = {0.0, 0.25, 0.5, 0.75, 1.0};
    (void)replicas;
    *n = 5, *x = at;
    return run(host, stage, n, x, (size_t[]){1}, runs);
}

/* What each stage has told, of numbers whose names can't be separated. */
typedef struct {
    size_t stages;
    bool known;
} told;

static void note_told(void *host, const stats_answer *a)
{
    told *t = ((stand_in *)host)->told;
    CU_ASSERT(a->stages == ++t->stages && a->n_points > 0);
    t->known = t->known || a->determined || a->n_intervals[0] > 0 || isfinite(a->x[0]);
    for (size_t p = 0; p < 2; p++) CU_ASSERT((a->n_intervals[p] == 0) == isnan(a->x[p]));
}

/* A plateau gets more terms, and is found; of a kink that no polynomial follows nothing is told in any stage,
 * nor of runs that are given, until a smaller box has no kink. */
static void test_bent(void)
{
    told t = {0};
    stats_answer a;
    scoped_stand_in s = {
        .n_names = 2, .n_numbers = 2, .degenerate = true, .plateau = true, .scatter = {0.05, 0.05}};
    s.noise = numbers_of(16, 1), s.told = &t;
    stats_quest q = quest_of(&s, (double[STATS_NAMES]){0.3, 0.2}, 0.1);
    q.tell = note_told;
    CHECK_OK(stats_identify(&q, &a));
    CU_ASSERT(a.determined && a.p_value[0] > 0.01 && a.status[0] != STATS_IDENTIFIED_BENT);
    CU_ASSERT(t.stages == a.stages && t.known && a.stages < 7);
    CHECK_NEAR(a.weight[1], 1.9, 0.05);
    CU_ASSERT(fabs(a.sum - (0.3 + a.weight[1] * 0.2)) < 3.0 * a.sum_error && a.sum_error < 0.02);
    CU_ASSERT(fabs(a.ends[1][0] - a.ends[0][0]) > 0.5); /* along the sum */
    CHECK_NEAR(a.ends[1][0] + 1.9 * a.ends[1][1], a.ends[0][0] + 1.9 * a.ends[0][1], 0.05);

    scoped_stand_in kink = {.n_names = 2, .n_numbers = 1, .kink = true, .scatter = {0.02}};
    kink.noise = numbers_of(17, 1), t = (told){0}, kink.told = &t;
    q = quest_of(&kink, (double[STATS_NAMES]){0.45, 0.5}, 0.1), q.tell = note_told;
    CHECK_OK(stats_identify(&q, &a));
    CU_ASSERT(a.status[0] == STATS_IDENTIFIED_BENT && a.status[1] == STATS_IDENTIFIED_BENT && !a.determined);
    CU_ASSERT(a.p_value[0] < 0.01 && isnan(a.x[0]) && a.n_intervals[0] == 0 && isnan(a.own[1].lower));
    CU_ASSERT(!t.known && t.stages > 1 && a.n_runs < q.budget / 8); /* more runs would not tell */
    kink.n_numbers = 2;                                             /* the same twice */
    q = quest_of(&kink, (double[STATS_NAMES]){0.45, 0.5}, 0.1), q.budget = 40, q.tell = note_told,
    t.stages = 0;
    CHECK_OK(stats_identify(&q, &a));
    CU_ASSERT(a.status[0] == STATS_IDENTIFIED_BENT && a.stages == 1 && !t.known && a.n_next > 0);
}

/* Few runs at different points: their residuals are few, and the interval is widened. */
static void test_few_runs(void)
{
    enum { CASES = 300 };
    scoped_stand_in s = {.n_names = 1, .n_numbers = 1, .scatter = {1.0}};
    int inside = 0;
    s.noise = numbers_of(15, 1);
    for (int k = 0; k < CASES; k++) {
        const double truth = 0.3 + 0.4 * gsl_rng_uniform(s.noise);
        stats_answer a;
        stats_quest q = quest_of(&s, &truth, 0.1);
        q.fixed_runs = true, q.run = run_fixed;
        CHECK_OK(stats_identify(&q, &a));
        rp_arena_end(&s.arena);
        inside += isnan(a.x[0]) || (truth >= a.own[0].lower && truth <= a.own[0].upper);
        CU_ASSERT(isnan(a.p_value[0]) && a.n_runs == 5 && a.n_repeated == 0); /* nothing tests the form */
    }
    CU_ASSERT(inside > 0.93 * CASES);
}

/* Where runs fail, nothing is found; a range ends there. */
static void test_failing(void)
{
    static const struct {
        double at;
        stats_identified status;
    } cases[] = {
        {0.25, STATS_IDENTIFIED_OK}, {0.5, STATS_IDENTIFIED_AT_LEAST}, {0.8, STATS_IDENTIFIED_ABOVE_RANGE}};
    for (size_t k = 0; k < 3; k++) {
        scoped_stand_in s = {.n_names = 1, .n_numbers = 1, .scatter = {0.3}, .fails = 0.5};
        stats_answer a;
        s.noise = numbers_of(12, k);
        const stats_quest q = quest_of(&s, &cases[k].at, 0.3);
        CHECK_OK(stats_identify(&q, &a));
        CU_ASSERT(a.status[0] == cases[k].status && a.hi[0] <= 0.5 && a.hi[0] > 0.4 &&
                  !(a.own[0].upper > 0.5));
    }
    scoped_stand_in s = {.n_names = 2, .n_numbers = 2, .scatter = {0.3, 0.3}, .fails = 1.0};
    stats_answer a;
    s.noise = numbers_of(13, 1);
    for (int k = 0; k < 2; k++) {
        const stats_quest q = quest_of(&s, (double[]){0.3 + 0.3 * k, 0.3 + 0.3 * k}, 0.1);
        CHECK_OK(stats_identify(&q, &a));
        CU_ASSERT(a.status[0] == (k ? STATS_IDENTIFIED_NO_RUNS : STATS_IDENTIFIED_OK));
    }
    int lacking = 0, tried = 0;
    for (int k = 0; k < 40; k++) { /* most of those in the interval lack it, or the nearest does */
        scoped_stand_in one = {.n_names = 1, .n_numbers = 1, .scatter = {0.3}, .fails = 1e3 * M_PI + 7.7 * k};
        one.noise = numbers_of(14, (unsigned long)k);
        const stats_quest q = quest_of(&one, (double[]){0.4}, 0.3);
        if (stats_identify(&q, &a)) continue; /* too few points */
        tried++, lacking += a.status[0] == STATS_IDENTIFIED_NO_RUNS;
    }
    CU_ASSERT(tried > 30 && 10 * lacking > 7 * tried);
    s.fails = -0.6;
    const stats_quest q = quest_of(&s, (double[]){0.7, 0.3}, 0.1);
    CHECK_OK(stats_identify(&q, &a));
    CU_ASSERT(a.status[0] == STATS_IDENTIFIED_OK && a.hi[0] == 1.0 && a.hi[1] > 0.5 && a.hi[1] <= 0.6);
}

/* What was found at first, digit by digit: the tests above bound it as widely as it scatters. Of each name
 * status, value, error, interval, weight, upper end; of each number value, error, fit. */
static void test_answers(void)
{
    static const struct {
        stand_in s;
        double error;
        const char *answer;
    } cases[] = {
        {{.n_names = 1, .n_numbers = 2},
         0.4,
         "0 0.3653 0.0192 0.3274 0.4031 1 1; 28.36 0.0697 0.47; 12.56 0.179 0.2; 0.000303 1; "
         "0.3653 0.0186; 5 60 0 240 46 45"},
        {{.n_names = 2, .n_numbers = 3, .fails = 1.1},
         0.5,
         "5 0.4166 0.0322 0.3569 0.4828 1 0.938; 5 0.5035 0.0703 0.3666 0.6454 0.341 0.938; 29.35 0.193 "
         "0.13; 12.63 0.0702 0.65; 22.77 0.183 0.12; 5.42 -0.5; 0.5884 0.0283; 5 100 41 640 54 51"},
        {{.n_names = 2, .n_numbers = 3, .degenerate = true},
         0.3,
         "3 0.3204 0.917 0 1 1 1; 0 0.5841 0.487 0.2066 0.7764 1.9 1; 34.32 0.0844 0.86; 35.33 0.0822 0.88; "
         "36.39 0.0931 0.68; 0.0516 -1; 1.428 0.023; 4 80 0 320 75 74"}};
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        scoped_stand_in s = cases[k].s;
        char text[512] = "", *end = text;
        stats_answer a;
        s.noise = numbers_of(15, k);
        for (size_t i = 0; i < s.n_numbers; i++) s.scatter[i] = 0.8;
        stats_quest q = quest_of(&s, (double[]){0.37, 0.56, 0.45}, cases[k].error);
        q.budget = 900, q.leave_out = true;
        CHECK_OK(stats_identify(&q, &a));
        for (size_t p = 0; p < s.n_names; p++)
            end += sprintf(end, "%d %.4g %.3g %.4g %.4g %.3g %.3g; ", a.status[p], a.x[p], a.se[p],
                           a.own[p].lower, a.own[p].upper, a.weight[p], a.hi[p]);
        for (size_t i = 0; i < s.n_numbers; i++)
            end += sprintf(end, "%.4g %.3g %.2g; ", a.fitted[i], a.fit_error[i], a.p_value[i]);
        sprintf(end, "%.3g %.2g; %.4g %.3g; %zu %zu %zu %zu %zu %zu", a.chi2, a.correlation[0][s.n_names - 1],
                a.sum, a.sum_error, a.stages, a.n_points, a.n_failed, a.n_runs, a.tried, a.recovered);
        CHECK_OR_SAY(strcmp(text, cases[k].answer) == 0, "%zu: \"%s\"", k, text);
    }
}

/* A curved valley a thousandth as wide as the box, which a grid misses. */
typedef struct {
    double at[3], along[3][3];
} valley;

static double depth_in(const double x[], void *data)
{
    static const double width[] = {0.001, 0.01, 0.1};
    const valley *v = data;
    double sum = 0.0;
    for (int k = 0; k < 3; k++) {
        double d = 0.0;
        for (int i = 0; i < 3; i++) d += v->along[k][i] * (x[i] - v->at[i]) * (1.0 + 0.3 * (x[i] + v->at[i]));
        sum += d * d / (width[k] * width[k]);
    }
    return sum;
}

static void test_valleys(void)
{
    static const double lo[3] = {0.0}, hi[3] = {1.0, 1.0, 1.0};
    scoped_rng *rng = numbers_of(3, 11);
    for (int c = 0; c < 100; c++) {
        valley v;
        double x[3], value;
        for (int i = 0; i < 3; i++) v.at[i] = 0.1 + 0.8 * gsl_rng_uniform(rng);
        for (int i = 0; i < 9; i++) v.along[i / 3][i % 3] = gsl_ran_gaussian(rng, 1.0);
        for (int i = 0; i < 3; i++) v.along[1][i] = v.along[0][i] + 0.3 * v.along[1][i];
        CHECK_OK(stats_least(&(stats_minimum){depth_in, &v, 3, lo, hi, 8, NULL}, x, &value));
        CHECK_NEAR(value, 0.0, 1e-6);
    }
    double x[3], value;
    CHECK_FAILS(stats_least(&(stats_minimum){depth_in, NULL, 1, lo, hi, 0, NULL}, x, &value), RP_BAD_INPUT,
                "1 dimensions, 0 cells");
    CHECK_FAILS(stats_least(&(stats_minimum){depth_in, NULL, 4, lo, hi, 8, NULL}, x, &value), RP_BAD_INPUT,
                "4 dimensions");
    const double none[] = {-INFINITY};
    CHECK_FAILS(stats_least(&(stats_minimum){depth_in, NULL, 1, none, hi, 8, NULL}, x, &value), RP_BAD_INPUT,
                "side 1: [-inf, 1]");
}

CHECK_SUITE(identify, "identify", test_valleys, test_one, test_two, test_three, test_arch, test_degenerate,
            test_statuses, test_bent, test_few_runs, test_failing, test_answers)
