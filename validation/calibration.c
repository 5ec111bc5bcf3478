/* Calibration of truths that are known. By real runs: friction, damping and stiffness are found again from
 * impacts of single grains on a floor, one to three names, ten cases each in the full run, which writes a
 * table. By functions that bend: two names from products, quotients and plateaus with noise. */
#include <gsl/gsl_randist.h>
#include <gsl/gsl_sort.h>

#include "core/random.h"
#include "stats/identify.h"
#include "tests/numbers.h"
#include "tests/program.h"

/* An oblique impact; the scatter is that of the grains' radii. */
static const char impact[] =
    "let = { mu = 0.2; gamma = 2000.0; k = 1.0e6; };\n"
    "dt = 2e-6; gravity = (0.0, 0.0); rotation = true;\n"
    "normal = { law = \"linear\"; k_n = \"k\"; gamma_n = \"gamma\"; };\n"
    "tangential = { law = \"spring\"; mu = \"mu\"; k_s = 1e6; gamma_s = 0.0; };\n"
    "walls = ( { name = \"floor\"; point = (0.0, 0.0); direction = (0.0, 1.0); } );\n"
    "phases = (\n"
    "  { name = \"fall\"; every = 1; until = \"floor.fy < 0\"; most = 10000;\n"
    "    add = { x = 0.0; y = \"1.01*r\"; vx = 60.0; vy = -40.0; radius_mean = 0.1; radius_width = 0.004; }; "
    "},\n"
    "  { name = \"impact\"; every = 1; until = \"floor.fy >= 0\"; most = 10000; } );\n"
    "measure = ( { name = \"u\"; of = \"vx\"; }, { name = \"v\"; of = \"vy\"; },\n"
    "            { name = \"ms\"; of = \"1000*t\"; at = \"impact\"; } );\n";

enum { NAMES = 3, RUNS = 16 };
static const struct {
    const char *name, *number;
    double lo, hi;
} of[NAMES] = {{"mu", "u", 0.05, 0.45}, {"gamma", "v", 500.0, 4000.0}, {"k", "ms", 5e5, 2e6}};

/* Runs at the truth, which a measurement would be. */
static void measure(size_t names, const double truth[], int seed, double value[], double error[])
{
    FILE *file = file_of("truth.cfg");
    fprintf(file, "experiment = \"impact.cfg\"; replicas = %d; seed = %d;\nfixed = { ", RUNS, seed);
    for (size_t p = 0; p < names; p++) fprintf(file, "%s = %.17e; ", of[p].name, truth[p]);
    fputs("};\n", file);
    fclose(file);
    SHELL("rm -rf truth && $REPOSE sweep make truth.cfg -o truth --quiet >out 2>err && $REPOSE "
          "sweep export truth --reduce >out 2>err");
    scoped_table t = read_table("out");
    for (size_t p = 0; p < names; p++) {
        value[p] = cell(&t, 0, check_text("%s_mean", of[p].number));
        error[p] = cell(&t, 0, check_text("%s_se", of[p].number));
    }
}

static void write_fit(size_t names, int seed, const double value[], const double error[])
{
    FILE *file = file_of("fit.cfg");
    fprintf(file, "seed = %d; budget = 20000; fit = { ", seed);
    for (size_t p = 0; p < names; p++) fprintf(file, "%s = [%.2f, %.2f]; ", of[p].name, of[p].lo, of[p].hi);
    fputs("};\nmeasured = ( ", file);
    for (size_t p = 0; p < names; p++)
        fprintf(file, "%s{ experiment = \"impact.cfg\"; of = \"%s\"; value = %.17e; error = %.17e; }",
                p ? ",\n  " : "", of[p].number, value[p], error[p]);
    fputs(" );\n", file);
    fclose(file);
}

static void test_found_again(void)
{
    const int cases = check_full() ? 10 : 3;
    scoped_rng *rng = numbers_of(39, 3);
    CHECK_TABLE(table, "calibration", "names, case, parameter, truth, value, lower, upper, status");
    int inside = 0, near = 0, n = 0;
    write_text("impact.cfg", "%s", impact);
    for (size_t names = 1; names <= (check_full() ? NAMES : 1); names++)
        for (int k = 0; k < cases; k++) {
            double truth[NAMES], value[NAMES], error[NAMES];
            for (size_t p = 0; p < names; p++)
                truth[p] = of[p].lo + (of[p].hi - of[p].lo) * (0.2 + 0.6 * gsl_rng_uniform(rng));
            measure(names, truth, 100 * (int)names + k, value, error);
            write_fit(names, 7 + k, value, error);
            const int status =
                shell("rm -rf found found.part && $REPOSE calibrate fit.cfg -o found --quiet >out 2>err");
            if (status > 1) fprintf(stderr, "%s", err);
            CU_ASSERT(status == RP_OK || status == RP_NO_RESULT);
            scoped_table t = read_table("out");
            CU_ASSERT_FATAL(t.n_rows >= names);
            for (size_t row = 0; row < names; row++) {
                const double lower = cell(&t, row, "lower"), upper = cell(&t, row, "upper");
                inside += truth[row] >= lower && truth[row] <= upper;
                near += truth[row] >= 2.0 * lower - upper && truth[row] <= 2.0 * upper - lower;
                n++;
                if (!table) continue;
                fprintf(table, "%zu\t%d\t%s\t%.6g\t%.6g\t%.6g\t%.6g\t%s\n", names, k, of[row].name,
                        truth[row], cell(&t, row, "value"), lower, upper, word(&t, row, "status"));
            }
        }
    /* 95 % of 60, less four standard errors; of three all but one, by at most the width of its interval */
    CU_ASSERT(near >= n - n / 30 && (n < 50 ? inside >= n - 1 : inside >= 50));
    fprintf(stderr, "calibration: %d of %d intervals hold the truth\n", inside, n);
}

/* ---- numbers that bend ---- */

enum { NUMBERS = 3, KINDS = 6 };

/* A number of two names from 0.05 to 1, with the scatter of its runs. */
typedef struct {
    size_t kind, first; /* which name comes first */
    double c, m, error, scatter;
} bent_number;

typedef struct {
    bent_number of[NUMBERS];
    size_t n;
    gsl_rng *noise;
    rp_arena arena;
} bent_model;

static double bent_value(const bent_number *one, const double x[])
{
    const double a = x[one->first], b = x[1 - one->first], c = one->c, m = one->m;
    switch (one->kind) {
    case 0: return 20.0 * a * b;
    case 1: return 12.0 * a / (b + c);
    case 2: return 20.0 * (1.0 - exp(-a / c) + m * b);
    case 3: return 20.0 * tanh(a / c) * (0.3 + b / (b + c));
    case 4: return 20.0 * fmin(a, m + c * b); /* with a kink */
    default: return 20.0 * pow(a, 5.0 * c - 0.5) * pow(b, 3.0 * m);
    }
}

static rp_status bent_run(void *host, size_t stage, size_t *n, const double **x, const size_t replicas[],
                          stats_runs **runs)
{
    bent_model *s = host;
    (void)stage;
    RP_NEW(&s->arena, *runs, *n * s->n);
    for (size_t i = 0; i < *n * s->n; i++) {
        const bent_number *one = &s->of[i / *n];
        stats_runs *r = &(*runs)[i];
        for (size_t j = 0; j < replicas[0]; j++) {
            const double y = bent_value(one, &(*x)[i % *n * 2]) + gsl_ran_gaussian(s->noise, one->scatter),
                         d = y - r->mean;
            r->n++, r->mean += d / r->n, r->squares += d * (y - r->mean);
        }
    }
    return RP_OK;
}

/* Covariance of the names for one who knows the functions: only the measured errors are left, and the slopes
 * at the truth tell what they do. */
static void needed(const bent_model *s, const double truth[2], double covariance[2][2])
{
    double I[2][2] = {{0}};
    for (size_t k = 0; k < s->n; k++) {
        double slope[2];
        for (size_t p = 0; p < 2; p++) {
            double up[2] = {truth[0], truth[1]}, down[2] = {truth[0], truth[1]};
            up[p] += 1e-5, down[p] -= 1e-5;
            slope[p] = (bent_value(&s->of[k], up) - bent_value(&s->of[k], down)) / 2e-5 / s->of[k].error;
        }
        for (size_t p = 0; p < 4; p++) I[p / 2][p % 2] += slope[p / 2] * slope[p % 2];
    }
    const double det = fmax(I[0][0] * I[1][1] - I[0][1] * I[1][0], 1e-9);
    covariance[0][0] = I[1][1] / det, covariance[1][1] = I[0][0] / det;
    covariance[0][1] = covariance[1][0] = -I[0][1] / det;
}

typedef struct {
    size_t cases, answered, told, hold, n_sums, sums_hold;
    double *width; /* of those that are told, over what is needed */
} bent_tally;

static void tell_case(const bent_model *s, const double truth[2], const stats_answer *a, bent_tally *t)
{
    const size_t before = t->told;
    double V[2][2], at = 0.0, variance = 0.0;
    needed(s, truth, V);
    for (size_t p = 0; p < 2; p++) {
        double width = 0.0;
        bool in = false;
        /* nothing, or nine tenths of the range, is no answer */
        if (a->n_intervals[p] == 0 || a->status[p] == STATS_IDENTIFIED_NOT_IDENTIFIED) continue;
        for (size_t k = 0; k < a->n_intervals[p]; k++) {
            const stats_interval *i = &a->interval[p][k];
            in |= truth[p] >= i->lower && truth[p] <= i->upper, width += i->upper - i->lower;
        }
        const double half = 1.96 * sqrt(V[p][p]);
        t->width[t->told++] = width / (fmin(truth[p] + half, 1.0) - fmax(truth[p] - half, 0.05));
        t->hold += in;
    }
    for (size_t p = 0; p < 4; p++) variance += a->weight[p / 2] * a->weight[p % 2] * V[p / 2][p % 2];
    for (size_t p = 0; p < 2; p++) at += a->weight[p] * truth[p];
    if (a->determined) {
        const bool in = fabs(at - a->sum) <= 1.96 * a->sum_error;
        t->width[t->told++] = a->sum_error / sqrt(variance);
        t->hold += in, t->n_sums++, t->sums_hold += in;
    }
    t->cases++, t->answered += t->told > before;
}

/* What is told of names and of combinations holds the truth in 93 % of the cases at least, is in the median
 * at most 1.3 times as wide as needed, and three cases of five tell something. */
static void test_bent(void)
{
    const size_t cases = check_full() ? 1000 : 150;
    scoped double *width = malloc(3 * cases * sizeof *width);
    bent_tally t = {.width = width};
    for (size_t i = 0; i < cases; i++) {
        scoped_rng *rng = numbers_of(37, i);
        const double pick = gsl_rng_uniform(rng),
                     truth[] = {gsl_ran_flat(rng, 0.2, 0.85), gsl_ran_flat(rng, 0.2, 0.85)};
        bent_model s = {.noise = rng, .n = pick < 0.1 ? 1 : pick < 0.8 ? 2 : 3};
        stats_answer a;
        stats_quest q = {.n_names = 2, .n_numbers = s.n, .n_groups = 1, .budget = 1000};
        q.host = &s, q.run = bent_run;
        for (size_t p = 0; p < 2; p++) q.lo[p] = 0.05, q.hi[p] = 1.0;
        for (size_t k = 0; k < s.n; k++) {
            bent_number *one = &s.of[k];
            one->kind = gsl_rng_uniform_int(rng, KINDS), one->first = gsl_rng_uniform_int(rng, 2);
            one->c = gsl_ran_flat(rng, 0.1, 0.6), one->m = gsl_ran_flat(rng, 0.0, 0.4);
            one->error = gsl_ran_flat(rng, 0.05, 0.6);
            one->scatter = one->error * exp(gsl_ran_flat(rng, log(0.02), log(2.0)));
            q.error[k] = one->error;
            q.value[k] = bent_value(one, truth) + gsl_ran_gaussian(rng, one->error);
        }
        CHECK_OK(stats_identify(&q, &a));
        tell_case(&s, truth, &a, &t);
        rp_arena_end(&s.arena);
    }
    gsl_sort(t.width, 1, t.told);
    const double told = (double)t.told, share = (double)t.hold / told,
                 wide = t.told ? t.width[t.told / 2] : INFINITY,
                 answered = (double)t.answered / (double)t.cases;
    fprintf(stderr,
            "calibration: %.1f %% of %zu hold the truth (%zu of %zu combinations), %.2f times as wide as "
            "needed, %.0f %% of the cases tell\n",
            100.0 * share, t.told, t.sums_hold, t.n_sums, wide, 100.0 * answered);
    CU_ASSERT(share >= 0.93 && wide <= 1.3 && answered >= 0.6);
    CU_ASSERT((double)t.sums_hold >= 0.9 * (double)t.n_sums && 5 * t.n_sums > t.cases);
}

CHECK_SUITE_WITHIN(calibration, "calibration", enter, leave, test_found_again, test_bent)
