/* Protocol `flux`: position and time of each new grain, and outputs of the series. */
#include <stdlib.h>
#include <string.h>

#include "stats/stats.h"
#include "table/table.h"
#include "sweeps/protocols/box.h"
#include "sweeps/protocols/protocols.h"
#include "tests/check.h"
#include "tests/numbers.h"
#include "tests/protocol.h"
#include "tests/folder.h"

static const sweep_protocol *const protocol = &sweep_protocol_flux;

static void height_closed_forms(void)
{
    const double gap = 1e-3;
    dem_state s[3] = {{.x = 1.0, .y = 0.7, .r = 0.15}};
    CHECK_NEAR(sweep_touch_height(0, s, 0.1, 0.1, gap), 0.101, 1e-15);
    CHECK_NEAR(sweep_touch_height(1, s, 0.1, 0.1, gap), 0.101, 1e-15); /* beyond contact */
    CHECK_NEAR(sweep_touch_height(1, s, 1.0, 0.1, gap), 0.7 + 0.25 + gap, 1e-15);
    s[0] = (dem_state){.x = 0.4, .y = 0.7, .r = 0.399}; /* with 0.1 + gap a triangle of 3, 4, 5 tenths */
    CHECK_NEAR(sweep_touch_height(1, s, 0.1, 0.1, gap), 1.1, 1e-15);
    s[1] = (dem_state){.x = 0.1, .y = 0.9, .r = 0.1}; /* the higher of two, in either order */
    CHECK_NEAR(sweep_touch_height(2, s, 0.1, 0.1, gap), 0.9 + 0.2 + gap, 1e-15);
    s[2] = s[0];
    CHECK_NEAR(sweep_touch_height(2, s + 1, 0.1, 0.1, gap), 0.9 + 0.2 + gap, 1e-15);
    s[0].y = -0.4; /* at the height of the floor's contact, not above it */
    CHECK_NEAR(sweep_touch_height(1, s, 0.1, 0.1, gap), 0.101, 1e-15);
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
        const double y = sweep_touch_height(N, s, x, r, gap);
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

static double output(const sweep_result *result, const char *name)
{
    return protocol_output(protocol, result, name);
}

/* A run with its tables in a folder of its own. */
typedef struct {
    sweep_result result;
    char folder[FOLDER_PATH];
    rp_table series, grains;
} traced;

static void trace(const char *const changes[], traced *t)
{
    char path[FOLDER_PATH + 16];
    scoped void *p = protocol_params(protocol, changes);
    folder_make("flux", t->folder);
    const sweep_tables tables = {t->folder, 1000000, protocol_no_header};
    CHECK_OK(protocol->check(p));
    CHECK_OK(protocol->run(p, 1993, 0, &tables, &t->result));
    snprintf(path, sizeof path, "%s/series.tsv", t->folder);
    CHECK_OK(rp_table_read(path, &t->series));
    snprintf(path, sizeof path, "%s/pile_grains.tsv", t->folder);
    CHECK_OK(rp_table_read(path, &t->grains));
}

static void trace_free(traced *t)
{
    folder_remove(t->folder);
    rp_table_free(&t->series);
    rp_table_free(&t->grains);
}

static double cell(const rp_table *table, size_t row, const char *name)
{
    double value = NAN;
    CHECK_OK(rp_table_number(table, row, rp_table_column(table, name), 0, &value));
    return value;
}

/* A grain falls two diameters in sqrt(2 h/g)/dt steps; with so high a v_cut the pile counts as quiet
 * throughout. A grain placed at rest waits for the 200 steps only. */
static void waits_for_contact(void)
{
    static const char *const high[] = {"W=1", "insertions=4", "v_cut=1e6", "drop_height=2", NULL};
    static const char *const low[] = {"W=1", "insertions=4", "v_cut=1e6", NULL};
    const double steps = sqrt(2.0 * (2.0 * 0.2 + 0.2e-6) / 981.0) / 5e-5;
    traced t;
    trace(high, &t);
    CU_ASSERT(cell(&t.series, 1, "step") - cell(&t.series, 0, "step") == ceil(steps));
    trace_free(&t);
    trace(low, &t);
    for (size_t k = 1; k < 4; k++)
        CU_ASSERT(cell(&t.series, k, "step") - cell(&t.series, k - 1, "step") == 200.0);
    trace_free(&t);
}

static const char *const small[] = {"W=1.3", "insertions=150", "entry_width=1", "avalanche=2", NULL};

/* Every grain is in the box or fell over the edge; at the end the box is quiet. */
static void grains_are_counted(void)
{
    traced t;
    trace(small, &t);
    const size_t n = t.series.n_rows;
    double left = 0.0, inside = 0.0, last = 0.0;
    CU_ASSERT(n == 150 && output(&t.result, "insertions_made") == 150.0);
    for (size_t k = 0; k < n; k++) {
        left += cell(&t.series, k, "outflow");
        CU_ASSERT(cell(&t.series, k, "insertion") == (double)k + 1.0);
        CU_ASSERT(k == 0 || cell(&t.series, k, "step") >= cell(&t.series, k - 1, "step") + 200.0);
    }
    for (size_t i = 0; i < t.grains.n_rows; i++) {
        const double x = cell(&t.grains, i, "x");
        last = fmax(last, cell(&t.grains, i, "id"));
        if (!(x > 0.0 && x < 1.3)) continue;
        inside++;
        CU_ASSERT(hypot(cell(&t.grains, i, "vx"), cell(&t.grains, i, "vy")) < 0.1);
    }
    const double layer = cell(&t.series, 0, "grains");
    CU_ASSERT(layer >= 6.0 && layer <= 9.0); /* 1.3 over mean diameters of 0.2, reduced by overlaps */
    CHECK_NEAR(cell(&t.series, 0, "theta_r3_deg"), 0.0, 3.0);
    CU_ASSERT(inside == cell(&t.series, n - 1, "grains"));
    /* ids are given in order, and the newest grain is still in the box: the series ends before the next */
    CU_ASSERT(last == layer + (double)n - 1.0 && inside == last - left);
    CU_ASSERT(left > 10.0 && output(&t.result, "steps") == cell(&t.series, n - 1, "step"));
    trace_free(&t);
}

/* The outputs again from the table of the series, one by one; and the run without tables has the same bits.
 */
static void outputs_from_series(void)
{
    /* the last insertion sets off an avalanche */
    static const char *const ending[] = {"W=1.3", "insertions=148", "entry_width=1", "avalanche=2", NULL};
    traced t;
    trace(ending, &t);
    const size_t n = t.series.n_rows, from = (size_t)output(&t.result, "level_insertion");
    double sum = 0.0, squares = 0.0, most = -INFINITY, count = 0.0, ms = 0.0, r = 0.0, grains = 0.0;
    CU_ASSERT_STRING_EQUAL(t.result.status, "ok");
    CU_ASSERT(from > 0 && from < n / 2);
    CU_ASSERT(cell(&t.series, from, "step") == output(&t.result, "level_step"));
    for (size_t k = from; k < n; k++) {
        const double theta = cell(&t.series, k, "theta_r3_deg");
        sum += theta;
        squares += theta * theta;
        most = fmax(most, theta);
        grains += cell(&t.series, k, "grains");
        if (k == from || cell(&t.series, k, "outflow") < 2.0) continue;
        count++;
        ms += cell(&t.series, k - 1, "theta_r3_deg");
        r += theta;
    }
    const double kept = (double)(n - from), mean = sum / kept;
    const double round_off = 1e-11; /* of sums of some hundred angles */
    CHECK_NEAR(output(&t.result, "theta_deg"), mean, round_off);
    CHECK_NEAR(output(&t.result, "theta_sd_deg"), sqrt((squares - kept * mean * mean) / (kept - 1.0)),
               1e3 * round_off);
    CU_ASSERT(output(&t.result, "theta_max_deg") == most);
    CU_ASSERT(cell(&t.series, n - 1, "outflow") >= 2.0);
    CU_ASSERT(count > 2.0 && output(&t.result, "avalanches") == count);
    CHECK_NEAR(output(&t.result, "theta_ms_flux_deg"), ms / count, round_off);
    CHECK_NEAR(output(&t.result, "theta_ms_less_r_deg"), (ms - r) / count, round_off);
    CHECK_NEAR(output(&t.result, "grains"), grains / kept, round_off);
    const double tau = output(&t.result, "tau_insertions");
    CHECK_NEAR(output(&t.result, "decorrelated"), kept / (2.0 * tau), round_off);
    CU_ASSERT(tau > 1.0);

    sweep_result again;
    scoped void *p = protocol_params(protocol, ending);
    CHECK_OK(protocol->run(p, 1993, 0, NULL, &again));
    CU_ASSERT(memcmp(again.values, t.result.values, sizeof again.values) == 0);
    if (!check_fast()) {
        CHECK_OK(protocol->run(p, 1993, 1, NULL, &again)); /* another stream, another pile */
        CU_ASSERT(output(&again, "theta_deg") != output(&t.result, "theta_deg"));
    }
    trace_free(&t);
}

static void ends_without_result(void)
{
    static const char *const rising[] = {"insertions=26", NULL};
    static const char *const short_of_steps[] = {"W=1", "steps_max=30000", NULL};
    sweep_result result;
    void *p = protocol_params(protocol, rising);
    CHECK_OK(protocol->run(p, 1993, 0, NULL, &result));
    CU_ASSERT_STRING_EQUAL(result.status, "not_level");
    CU_ASSERT(strstr(result.message, "has not levelled off") != NULL);
    CU_ASSERT(isnan(output(&result, "theta_deg")) && output(&result, "insertions_made") == 26.0);
    free(p);
    /* too short for a correlation time: mean and largest angle stay */
    static const char *const no_plateau[] = {"W=1.4", "insertions=44", NULL};
    p = protocol_params(protocol, no_plateau);
    CHECK_OK(protocol->run(p, 1993, 0, NULL, &result));
    CU_ASSERT_STRING_EQUAL(result.status, "ok");
    CU_ASSERT(isnan(output(&result, "tau_insertions")));
    CU_ASSERT(output(&result, "theta_max_deg") > output(&result, "theta_deg"));
    free(p);
    p = protocol_params(protocol, short_of_steps);
    CHECK_OK(protocol->run(p, 1993, 0, NULL, &result));
    CU_ASSERT(output(&result, "steps") == 30000.0);
    CU_ASSERT(output(&result, "insertions_made") > 4.0 && output(&result, "insertions_made") < 100.0);
    free(p);
    /* a tower above the height assumed for dt: grains fall too fast from there */
    static const char *const tower[] = {"W=1", "mu=1", "mu_wall=1", "insertions=60", NULL};
    p = protocol_params(protocol, tower);
    const rp_param *dt = rp_params_find(protocol->schema, "dt");
    CHECK_OK(rp_params_set_text(dt, p, "1e-3"));
    CHECK_FAILS(protocol->check(p), RP_BAD_INPUT, "the limit is ");
    double limit = atof(strstr(rp_message(), "the limit is ") + strlen("the limit is "));
    memcpy((char *)p + dt->offset, &(double){0.995 * limit}, sizeof limit); /* three digits are printed */
    CHECK_OK(protocol->check(p));
    CHECK_OK(protocol->run(p, 1993, 0, NULL, &result));
    CU_ASSERT_STRING_EQUAL(result.status, "too_high");
    CU_ASSERT(strstr(result.message, "new particle: dt = ") != NULL);
    free(p);
    static const char *const fast[] = {"dt=1e-3", NULL}, *const smooth[] = {"mu=0", NULL},
                             *const smooth_floor[] = {"mu_floor=0", NULL}, *const narrow[] = {"W=0.5", NULL};
    CHECK_FAILS(protocol->check(p = protocol_params(protocol, fast)), RP_BAD_INPUT, "dt = 0.001: too large");
    free(p);
    CHECK_FAILS(protocol->check(p = protocol_params(protocol, smooth)), RP_BAD_INPUT,
                "nothing holds the first layer");
    free(p);
    CHECK_FAILS(protocol->check(p = protocol_params(protocol, smooth_floor)), RP_BAD_INPUT,
                "nothing holds the first layer");
    free(p);
    CHECK_FAILS(protocol->check(p = protocol_params(protocol, narrow)), RP_BAD_INPUT, "five grain diameters");
    free(p);
}

/* Fill the stack of the next call with ones. */
static void __attribute__((noinline)) soil_stack(void)
{
    volatile unsigned char soil[1 << 16];
    for (size_t i = 0; i < sizeof soil; i++) soil[i] = 1;
}

/* The key of stored runs has all its digits, and is the same at every call. */
/* The time step allows for a fall from twice the base's width, and the drop onto the pile. */
static void limit_of_step(void)
{
    static const char *const high[] = {"W=40", "drop_height=30", NULL};
    scoped void *p = protocol_params(protocol, high);
    sweep_box *b = p;
    const double limit = sweep_box_step_limit(b, 2.0 * (40.0 + 30.0 * b->radius_mean), NULL);
    CU_ASSERT(limit < sweep_box_step_limit(b, 2.0 * 40.0, NULL));
    b->physics.dt = limit * (1.0 - 1e-9);
    CHECK_OK(protocol->check(p));
    b->physics.dt = limit * (1.0 + 1e-9);
    CHECK_FAILS(protocol->check(p), RP_BAD_INPUT, "too large for");
}

static void fingerprint_repeats(void)
{
    char first[33] = "", again[33] = "";
    CHECK_OK(protocol->fingerprint(first));
    CU_ASSERT(strlen(first) == 32);
    soil_stack();
    CHECK_OK(protocol->fingerprint(again));
    CU_ASSERT_STRING_EQUAL(first, again);
}

void suite_flux(void)
{
    static const check_case cases[] = {{"height of a new grain: closed forms", height_closed_forms},
                                       {"height of a new grain: random piles", height_of_random_piles},
                                       {"the next waits for contact", waits_for_contact},
                                       {"grains are counted", grains_are_counted},
                                       {"outputs from the series", outputs_from_series},
                                       {"runs without a result", ends_without_result},
                                       {"fingerprint", fingerprint_repeats},
                                       {"limit of the time step", limit_of_step},
                                       {NULL, NULL}};
    check_register("constant flux", cases);
}
