/* Protocol `flux`, a text: position and time of each new grain, and outputs of the series. */
#include <gsl/gsl_cdf.h>

#include "experiment/modules/module.h"
#include "tests/numbers.h"
#include "tests/protocol.h"
#include "tests/program.h"

static void height_closed_forms(void)
{
    const double gap = 1e-3;
    dem_state s[3] = {{.x = 1.0, .y = 0.7, .r = 0.15}};
    CHECK_NEAR(exp_touch_height(0, s, 0.1, 0.1, gap, 0.1 + gap), 0.101, 1e-15);
    CHECK_NEAR(exp_touch_height(1, s, 0.1, 0.1, gap, 0.1 + gap), 0.101, 1e-15); /* beyond contact */
    CHECK_NEAR(exp_touch_height(1, s, 1.0, 0.1, gap, 0.1 + gap), 0.7 + 0.25 + gap, 1e-15);
    s[0] = (dem_state){.x = 0.4, .y = 0.7, .r = 0.399}; /* with 0.1 + gap a triangle of 3, 4, 5 tenths */
    CHECK_NEAR(exp_touch_height(1, s, 0.1, 0.1, gap, 0.1 + gap), 1.1, 1e-15);
    s[1] = (dem_state){.x = 0.1, .y = 0.9, .r = 0.1}; /* the higher of two, in either order */
    CHECK_NEAR(exp_touch_height(2, s, 0.1, 0.1, gap, 0.1 + gap), 0.9 + 0.2 + gap, 1e-15);
    s[2] = s[0];
    CHECK_NEAR(exp_touch_height(2, s + 1, 0.1, 0.1, gap, 0.1 + gap), 0.9 + 0.2 + gap, 1e-15);
    s[0].y = -0.4; /* at the height of the floor's contact, not above it */
    CHECK_NEAR(exp_touch_height(1, s, 0.1, 0.1, gap, 0.1 + gap), 0.101, 1e-15);
}

/* Free at that height and everywhere above, not free just below it. */
static void height_of_random_piles(void)
{
    enum { N = 12 };
    const double gap = 2e-7, below = 1e-9;
    scoped_rng *rng = numbers_of(21, 0);
    for (int pile = 0; pile < 500; pile++) {
        dem_state s[N];
        for (int i = 0; i < N; i++)
            s[i] = (dem_state){.x = gsl_rng_uniform(rng),
                               .y = 2.0 * gsl_rng_uniform(rng),
                               .r = 0.07 + 0.06 * gsl_rng_uniform(rng)};
        const double r = 0.07 + 0.06 * gsl_rng_uniform(rng), x = r + 0.5 * gsl_rng_uniform(rng);
        const double y = exp_touch_height(N, s, x, r, gap, r + gap);
        bool supported = y - below < r + gap;
        CU_ASSERT(y >= r + gap);
        for (int i = 0; i < N; i++) {
            CU_ASSERT(hypot(s[i].x - x, s[i].y - y) > s[i].r + r + 0.99 * gap);
            CU_ASSERT(s[i].y <= y || fabs(s[i].x - x) >= s[i].r + r);
            supported |= hypot(s[i].x - x, s[i].y - (y - below)) < s[i].r + r + gap;
        }
        CU_ASSERT(supported);
    }
}

/* A run with its tables in the folder `t` of the test. */
typedef struct {
    const sweep_protocol *protocol;
    sweep_result result;
    rp_table series, grains;
} traced;

static void trace_free(traced *t)
{
    rp_table_free(&t->series);
    rp_table_free(&t->grains);
}
#define scoped_trace __attribute__((cleanup(trace_free))) traced

static traced trace(const char *const changes[])
{
    traced t = {.protocol = protocol_of(&sweep_protocol_flux)};
    scoped void *p = protocol_params(t.protocol, changes);
    protocol_trace(t.protocol, p, 1000000, &t.result);
    t.series = read_table("t/series_theta.tsv"), t.grains = read_table("t/end_grains.tsv");
    return t;
}

static double output(const traced *t, const char *name)
{
    return protocol_output(t->protocol, &t->result, name);
}

/* A grain falls two diameters in sqrt(2 h/g)/dt steps; with so high a v_cut the pile counts as quiet
 * throughout. A grain placed at rest waits for the 200 steps only. */
static void waits_for_contact(void)
{
    static const char *const high[] = {"W=1", "insertions=4", "v_cut=1e6", "drop_height=2", NULL};
    static const char *const low[] = {"W=1", "insertions=4", "v_cut=1e6", NULL};
    const double steps = sqrt(2.0 * (2.0 * 0.2 + 0.2e-6) / 981.0) / 5e-5;
    scoped_trace t = trace(high), slow = trace(low);
    CU_ASSERT(cell(&t.series, 1, "step") - cell(&t.series, 0, "step") == ceil(steps));
    for (size_t k = 1; k < 4; k++)
        CU_ASSERT(cell(&slow.series, k, "step") - cell(&slow.series, k - 1, "step") == 200.0);
}

/* Every grain is in the box or fell over the edge; at the end the box is quiet. Outputs are of the series. */
static void outputs_from_series(void)
{
    static const char *const small[] = {"W=1.3", "insertions=148", "entry_width=1", "avalanche=2", NULL};
    scoped_trace t = trace(small);
    const size_t n = t.series.n_rows, from = (size_t)output(&t, "level_insertion");
    double inside = 0.0, last = 0.0, sum = 0.0, squares = 0.0, most = -INFINITY;
    CU_ASSERT_STRING_EQUAL(t.result.status, "ok");
    CU_ASSERT_FATAL(n == 148 && from > 0 && from < n / 2);
    for (size_t k = 1; k < n; k++)
        CU_ASSERT(cell(&t.series, k, "step") >= cell(&t.series, k - 1, "step") + 200.0);
    for (size_t i = 0; i < t.grains.n_rows; i++) {
        const double x = cell(&t.grains, i, "x");
        last = fmax(last, cell(&t.grains, i, "id"));
        if (!(x > 0.0 && x < 1.3)) continue;
        inside++;
        CU_ASSERT(hypot(cell(&t.grains, i, "vx"), cell(&t.grains, i, "vy")) < 0.1);
    }
    /* the first layer has 1.3 over mean diameters of 0.2, reduced by overlaps; ids are given in order */
    CU_ASSERT(output(&t, "insertions_made") == 148.0 && last >= 148.0 + 6.0 && last <= 148.0 + 9.0);
    CU_ASSERT(inside > 10.0 && inside < last - 10.0 && fabs(inside - output(&t, "grains")) < 10.0);
    CHECK_NEAR(cell(&t.series, 0, "theta"), 0.0, 3.0);
    CU_ASSERT(cell(&t.series, from, "step") == output(&t, "level_step"));
    for (size_t k = from; k < n; k++) {
        const double theta = cell(&t.series, k, "theta");
        sum += theta, squares += theta * theta, most = fmax(most, theta);
    }
    const double kept = (double)(n - from), mean = sum / kept, round_off = 1e-11;
    CHECK_NEAR(output(&t, "theta_deg"), mean, round_off);
    CHECK_NEAR(output(&t, "theta_sd_deg"), sqrt((squares - kept * mean * mean) / (kept - 1.0)),
               1e3 * round_off);
    stats_series b; /* of few blocks, widened by Student's t */
    double theta[148], work[148];
    for (size_t k = from; k < n; k++) theta[k - from] = cell(&t.series, k, "theta");
    CHECK_OK(stats_blocking(n - from, theta, work, &b));
    const double blocks = floor(kept / (double)b.block);
    CU_ASSERT(blocks < 20.0);
    CHECK_NEAR(output(&t, "theta_se_deg"), b.se * gsl_cdf_tdist_Pinv(0.975, blocks - 1.0) / 1.959963984540054,
               round_off);
    CU_ASSERT(output(&t, "theta_max_deg") == most && output(&t, "avalanches") > 2.0);
    CU_ASSERT(output(&t, "decorrelated") > 2.0 && output(&t, "decorrelated") < kept);
    CHECK_NEAR(output(&t, "theta_ms_less_r_deg"),
               output(&t, "theta_ms_flux_deg") - output(&t, "theta_r_flux_deg"), round_off);
    /* without tables the same bits; another stream, another pile */
    sweep_result again;
    scoped void *p = protocol_params(t.protocol, small);
    CHECK_OK(t.protocol->run(p, 1993, 0, NULL, &again));
    CU_ASSERT(memcmp(again.values, t.result.values, sizeof again.values) == 0);
    if (!check_fast()) {
        CHECK_OK(t.protocol->run(p, 1993, 1, NULL, &again));
        CU_ASSERT(protocol_output(t.protocol, &again, "theta_deg") != output(&t, "theta_deg"));
    }
}

static void ends_without_result(void)
{
    static const struct {
        const char *changes, *status;
        double steps;                                  /* 0: any */
    } cases[] = {{"insertions=26", "no_samples", 0.0}, /* has not levelled off */
                 {"W=1 steps_max=30000", "ok", 30000.0},
                 {"W=1 v_cut=1e-9 steps_max=8000", "no_samples", 8000.0}};
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        scoped_trace t = trace((const char *const[]){cases[k].changes, NULL});
        CU_ASSERT_STRING_EQUAL(t.result.status, cases[k].status);
        if (k == 1) CU_ASSERT(output(&t, "insertions_made") > 4.0 && output(&t, "insertions_made") < 100.0);
        if (k == 1)
            CU_ASSERT(output(&t, "steps") >= cases[k].steps && output(&t, "steps") < 1.5 * cases[k].steps);
        if (k != 1) CU_ASSERT(isnan(output(&t, "theta_deg")));
    }
}

/* The first layer falls as far as a grain of it is high: without damping that shortens the step. */
static void refuses_step_of_layer(void)
{
    const sweep_protocol *protocol = protocol_of(&sweep_protocol_flux);
    for (int damped = 0; damped < 2; damped++) {
        scoped void *params = PROTOCOL_PARAMS(protocol, damped ? "gamma_n=500" : "gamma_n=0");
        CHECK_FAILS_IF(!damped, protocol->check(params), RP_BAD_INPUT, "dt = 5e-05: too large for");
    }
    protocol = protocol_of(&sweep_protocol_drop); /* disks glued at y = 0 cannot fall */
    scoped void *params = PROTOCOL_PARAMS(
        protocol, "N=60 glued=1.5 law=slip_roll eps=0.001 damping=2 radius_width=0.2 mu_static=100 a=0.001");
    CHECK_OK(protocol->check(params));
}

CHECK_SUITE_WITHIN(flux, "constant flux", enter, leave, height_closed_forms, height_of_random_piles,
                   waits_for_contact, outputs_from_series, ends_without_result, refuses_step_of_layer)
