/* Experiments: observables and measures against closed forms, what is refused, and that cuts, snapshots and
 * sweeps change no bit. */
#include <inttypes.h>
#include <signal.h>

#include "tests/grains.h"
#include "trial.h"

/* Two grains fall from rest beside each other, then lie on a floor that is a wall with a name. */
static const char fall[] =
    "dt = 1.0e-4; gravity = (0.0, -1000.0); let = { h = 5.0; };\n"
    "walls = ( { name = `floor`; point = (0.0, 0.0); direction = (0.0, 1.0); } );\n"
    "particles = ( { x = 1.0; y = `h`; r = 0.1; m = 0.01; }, { x = 3.0; y = `h`; r = 0.2; m = 0.03; } );\n"
    "regions = { left_half = { x = (0.0, 2.0); }; disk = { circle = (3.0, `h`, 1.5); };\n"
    "  high = { y = (8.0, `inf`); }; };\n"
    "phases = ( { name = `fall`; steps = 500; every = 50; },\n"
    "           { name = `land`; least = 1000; every = 100; until = `rest`; } );\n"
    "measure = ( { name = `y1`; of = `left_half.y`; at = `fall`; },\n"
    "  { name = `v`; of = `vy`; at = `fall`; }, { name = `all`; of = `y`; at = `fall`; },\n"
    "  { name = `fastest`; of = `speed`; at = `fall`; }, { name = `e`; of = `kinetic`; at = `fall`; },\n"
    "  { name = `mean_e`; of = `energy`; at = `fall`; },\n"
    "  { name = `fell`; of = `moved(1.2)`; at = `fall`; },\n"
    "  { name = `stay`; of = `moved(1.3)`; at = `fall`; },\n"
    "  { name = `in`; of = `disk.grains`; at = `fall`; },\n"
    "  { name = `in_m`; of = `disk.mass`; at = `fall`; }, { name = `t1`; of = `t`; at = `fall`; },\n"
    "  { name = `T`; of = `time`; }, { name = `s`; of = `step`; },\n"
    "  { name = `rate_y`; of = `vy`; during = `fall`; take = `rate`; },\n"
    "  { name = `faster`; of = `y`; during = `fall`; every = 10; take = `rate`; },\n"
    "  { name = `mean_t`; of = `t`; during = `fall`; },\n"
    "  { name = `late`; of = `t`; during = `fall`; when = `vy < -26`; take = `first`; },\n"
    "  { name = `most`; of = `-vy`; during = `fall`; take = `max`; skip = 0.5; },\n"
    "  { name = `least`; of = `-vy`; during = `fall`; take = `min`; skip = 0.5; },\n"
    "  { name = `step_y`; of = `change(t)`; during = `fall`; take = `max`; every = 25; },\n"
    "  { name = `steps_y`; of = `change(t)`; during = `fall`; },\n"
    "  { name = `first`; of = `t`; during = `land`; take = `first`; every = 70; },\n"
    "  { name = `weight`; of = `floor.fy`; }, { name = `side`; of = `floor.fx`; },\n"
    "  { name = `top`; of = `height`; }, { name = `l`; of = `left`; }, { name = `right_end`; of = `right`; "
    "},\n"
    "  { name = `touching`; of = `contacts`; }, { name = `columns`; of = `cells`; },\n"
    "  { name = `above`; of = `high.speed`; at = `fall`; },\n"
    "  { name = `by_most`; of = `t`; during = `fall`; level_of = `most`; },\n"
    "  { name = `by_that`; of = `t`; during = `fall`; level_of = `by_most`; },\n"
    "  { name = `some`; of = `phase_step`; during = `fall`; every = 5; take = `first`; skip = 0.07; },\n"
    "  { name = `root`; of = `held(y > 9, 2) ? 1 : sqrt(t - 0.03)`; during = `fall`; optional = true; },\n"
    "  { name = `sum`; of = `v + exp(log(2))`; } );\n";

static void test_closed_forms(void)
{
    RUN_TRIAL(t, fall, 1000, "ok");
    const double T = 0.05, fell = 0.5 * 1000.0 * T * T;
    /* Verlet has the fall exact; half of ten samples is left out of the least */
    CHECK_EACH(measured(&t, NAME), 1e-9, {"y1", 5.0 - fell}, {"v", -50.0}, {"all", 5.0 - fell},
               {"fastest", 50.0}, {"e", 0.5 * 0.04 * 2500.0}, {"mean_e", 0.25 * 0.04 * 2500.0},
               {"most", 50.0}, {"least", 30.0}, {"l", 0.9}, {"right_end", 3.2}, {"sum", -48.0});
    CHECK_EACH(measured(&t, NAME), 0.0, {"fell", 2.0}, {"stay", 0.0}, {"in", 1.0}, {"in_m", 0.03},
               {"side", 0.0}, {"touching", 1.0}, {"columns", 2.0}, {"above", 0.0}, {"some", 40.0});
    /* a let named d leaves the mean grain's diameter as it is: columns; samples each 0.005 s; the first
     * beyond 25 cm/s is late */
    CHECK_EACH(measured(&t, NAME), 1e-12, {"t1", T}, {"T", 1e-4 * measured(&t, "s")}, {"mean_t", 0.0275},
               {"late", 0.03}, {"by_most", 0.04}, {"by_that", 0.04}, {"first", 0.107}, {"step_y", 0.0025},
               {"steps_y", 0.005});
    CHECK_NEAR(measured(&t, "rate_y"), -1000.0, 1e-6);
    CHECK_NEAR(measured(&t, "weight"), -0.04 * 1000.0, 0.4);
    CHECK_NEAR(measured(&t, "top"), 0.4, 1e-3);
    CU_ASSERT(isnan(measured(&t, "root")));      /* a root of a number below 0 is a sample too */
    CU_ASSERT(isnan(measured(&t, "rate_y_se"))); /* ten samples are too few for an error */
    CU_ASSERT(isnan(measured(&t, "faster_se"))); /* and fifty whose steps correlate, too short a series */
}

/* Windows at equality: what lies exactly on an end, and shares that are no whole number of samples. */
static void test_windows(void)
{
    static const char text[] =
        "dt = 1.0e-4; gravity = (0.0, 0.0); particles = ( { x = 1.0; y = 1.0; r = 0.1; vx = 50.0; } );\n"
        "phases = ( { name = `once`; least = 1000; every = 100; steps = 1100; },\n"
        "  { name = `none`; least = 1000; every = 100; steps = 1000; fail = { no = `false`; }; },\n"
        "  { name = `until`; least = 200; every = 50; most = 300; until = `phase_step >= 300`; },\n"
        "  { name = `beyond`; every = 50; most = 300; until = `phase_step > 300`; go_on = true; },\n"
        "  { name = `edge`; least = 100; every = 50; most = 100; until = `phase_step >= 100`; go_on = true; "
        "status "
        "= `ok_edge`; },\n"
        "  { name = `hold`; every = 50; until = `held(phase_step >= 100, 3)`; },\n"
        "  { name = `passes`; repeat = 3; phases = ( { name = `pass`; every = 10; steps = 70; } ); },\n"
        "  { name = `many`; every = 5; steps = 500; } );\n"
        "measure = ( { name = `first`; of = `phase_step`; during = `once`; take = `first`; },\n"
        "  { name = `last`; of = `phase_step`; during = `once`; take = `max`; },\n"
        "  { name = `no`; of = `phase_step`; during = `none`; take = `first`; optional = true; },\n"
        "  { name = `met`; of = `phase_step`; at = `until`; },\n"
        "  { name = `all`; of = `phase_step`; at = `beyond`; },\n"
        "  { name = `looks`; of = `phase_step`; at = `hold`; },\n"
        "  { name = `whole`; of = `phase_step`; during = `many`; take = `first`; skip = 0.07; },\n"
        "  { name = `part`; of = `phase_step`; during = `many`; take = `first`; skip = 0.071; },\n"
        "  { name = `one`; of = `phase_step`; during = `many`; take = `first`; skip = 1e-3; },\n"
        "  { name = `end`; of = `phase_step`; during = `many`; take = `first`; skip = 0.99; },\n"
        "  { name = `mean`; of = `phase_step`; during = `many`; skip = 0.071; },\n"
        "  { name = `same`; of = `phase_step`; during = `many`; take = `first`; level_of = `mean`; },\n"
        "  { name = `each`; of = `phase_step`; during = `pass`; skip = 0.5; },\n"
        "  { name = `falls`; of = `phase_step - 20*floor(phase_step/20) < 10 ? 2 : 1`; during = `many`; take "
        "= `avalanches`; drop "
        "= 1.0; },\n"
        "  { name = `less`; of = `phase_step - 20*floor(phase_step/20) < 10 ? 2 : 1`; during = `many`; take "
        "= `avalanches`; drop "
        "= 1.0000001; optional = true; } );\n";
    for (long part = 1; part <= 1000; part *= 10) {
        RUN_TRIAL(t, text, part, "ok_edge"); /* a phase does not look at its `least` */
        CHECK_EACH(measured(&t, NAME), 0.0, {"first", 1100.0}, {"last", 1100.0}, {"met", 300.0},
                   {"all", 300.0}, {"looks", 200.0}, {"whole", 40.0}, {"part", 45.0}, {"one", 10.0},
                   {"end", 500.0}, {"mean", 272.5}, {"same", 45.0}, {"each", 60.0}, {"falls_n", 25.0},
                   {"less_n", 0.0});
        CU_ASSERT(isnan(measured(&t, "no")));
    }
}

/* Times 64 longer, accelerations 4096 smaller: the same bits but for the exponents. What lies at rest under a
 * strong gravity lies so under a weak one, after as many steps, and what a lid presses without any. */
static void test_rest_by_gravity(void)
{
    static const char column[] =
        "walls = ( { point = (0.0, 0.0); direction = (0.0, 1.0); }, { point = (0.0, 0.799); direction = "
        "(0.0, -1.0); } );\n"
        "particles = ( { x = 1.0; y = 0.1; r = 0.1; m = 0.01; }, { x = 1.0; y = 0.3; r = 0.1; m = 0.01; },\n"
        "  { x = 1.0; y = 0.5; r = 0.1; m = 0.01; }, { x = 1.0; y = 0.7; r = 0.1; m = 0.01; } );\n"
        "phases = ( { name = `lie`; until = `rest`; most = 200000; } );\n";
    static const struct {
        double gravity, dt, k_n, gamma_n;
    } scales[] = {{1024.0, 1e-4, 1e5, 100.0},
                  {0.25, 64.0 * 1e-4, 1e5 / 4096.0, 100.0 / 64.0},
                  {0.0, 1e-4, 1e5, 100.0},
                  {0.0, 64.0 * 1e-4, 1e5 / 4096.0, 100.0 / 64.0}};
    long steps[4];
    for (int k = 0; k < 4; k++) {
        const char *text = check_text(
            "gravity = (0.0, -%.17g); dt = %.17g; normal = { law = `linear`; k_n = %.17g; gamma_n = "
            "%.17g; };\n%s",
            scales[k].gravity, scales[k].dt, scales[k].k_n, scales[k].gamma_n, column);
        RUN_TRIAL(t, text, 1000, "ok");
        steps[k] = exp_steps(t.run);
    }
    CU_ASSERT(steps[0] > 5000 && steps[0] == steps[1]);
    CU_ASSERT(steps[2] > 5000 && steps[2] == steps[3]);
}

/* What lies at rest is looked at each `every` steps of rest, however often the phase looks. */
static void test_looks_at_rest(void)
{
    static const char text[] =
        "dt = 1.0e-4; rest = { energy = 1e9; force = 1e9; looks = 3; every = 500; };\n"
        "particles = ( { x = 1.0; y = 1.0; r = 0.1; } );\n"
        "phases = ( { name = `before`; steps = 70; }, { name = `wait`; every = 100; until = `rest`; } );\n";
    RUN_TRIAL(t, text, 1000, "ok");
    CU_ASSERT(exp_steps(t.run) == 70 + 100 + 2 * 500);
}

/* Blocks, gravity that turns, phases that are left out, ends by time, and words. */
static void test_phases(void)
{
    static const char text[] =
        "dt = 1.0e-4; let = { turns = true; rate = 0.01; };\n"
        "walls = ( { name = `floor`; point = (0.0, 0.0); direction = (0.0, 1.0); } );\n"
        "tangential = { law = `spring`; mu = 1.0; }; particles = ( { x = 1.0; y = 0.1; r = 0.1; m = 0.01; }, "
        "{ x = 9.0; y = 5.2; r = 0.1; m = 0.01; } );\n"
        "result = `ok_turned`;\n"
        "phases = ( { name = `never`; if = `not turns`; steps = 100; },\n"
        "  { name = `steps`; repeat = 6; until = `tilt_deg > 4.5`; phases = (\n"
        "    { name = `turn`; gravity_turn_deg_per_step = `rate`; steps = `round(1/rate)`; },\n"
        "    { name = `no`; if = `rate > 1`; steps = 1; },\n"
        "    { name = `wait`; gravity_turn_deg_per_step = 0.0; time = 0.01; } ); },\n"
        "  { name = `back`; gravity = (0.0, -500.0); steps = 3; } );\n"
        "measure = ( { name = `tilt`; of = `tilt_deg`; at = `wait`; take = `max`; },\n"
        "  { name = `passes`; of = `pass`; at = `wait`; take = `max`; series = true; },\n"
        "  { name = `turning`; of = `tilt_deg`; during = `turn`; every = 10; take = `rate`; skip = 0.5; },\n"
        "  { name = `later`; of = `phase_step`; during = `turn`; every = 10; take = `first`; skip = 0.5; },\n"
        "  { name = `none`; of = `t`; during = `turn`; take = `avalanches`; every = 10; drop = 0.005; "
        "optional = true; },\n"
        "  { name = `nothing`; of = `tilt_deg`; at = `never`; }, { name = `steps`; of = `step`; },\n"
        "  { name = `falls`; of = `imbalance`; } );\n";
    RUN_TRIAL(t, text, 37, "ok_turned");
    CHECK_EACH(measured(&t, NAME), 1e-9, {"tilt", 5.0}, {"passes", 5.0}, {"steps", 5.0 * 200.0 + 3.0},
               {"turning", 100.0}, {"later", 60.0}, {"none_n", 0.0}, /* of each pass */
               {"falls", 1.0});
    CU_ASSERT(isnan(measured(&t, "nothing")) && exp_steps(t.run) == 1003);
    CU_ASSERT(!exp_series_name(t.plan, 1) && strcmp(exp_series_name(t.plan, 0), "series_passes.tsv") == 0);
}

/* A grain rises and falls: the largest height so far is known while the phase lasts. A block marks positions
 * at its start alone, its phases where they say so. A measure without a phase is of the last one. */
static void test_known_so_far(void)
{
    static const char text[] =
        "dt = 1.0e-4; gravity = [0.0, -1000.0]; particles = ( { x = 1.0; y = 5.0; r = 0.1; vy = 50.0; } );\n"
        "phases = ( { name = `flight`; every = 10; until = `y < most - 0.2`; most = 5000; },\n"
        "  { name = `twice`; repeat = 2; phases = ( { name = `on`; steps = 100; } ); },\n"
        "  { name = `marked`; repeat = 2; phases = ( { name = `again`; mark = true; steps = 100; } ); },\n"
        "  { name = `never`; if = `1 > 2`; steps = 3; } );\n"
        "measure = ( { name = `most`; of = `y`; during = `flight`; take = `max`; },\n"
        "  { name = `fell`; of = `y`; at = `flight`; },\n"
        "  { name = `by_block`; of = `moved(0.5)`; at = `on`; take = `max`; },\n"
        "  { name = `before`; of = `moved(0.7)`; at = `on`; take = `max`; },\n"
        "  { name = `by_phase`; of = `moved(0.6)`; at = `again`; take = `max`; },\n"
        "  { name = `last`; of = `step`; },\n"
        "  { name = `fall`; of = `vy`; during = `flight`; take = `line`; against = `t`; },\n"
        "  { name = `sink`; of = `0+vy`; unit = `cm/s`; during = `flight`; take = `line`; against = `t`; },\n"
        "  { name = `rate`; of = `2*vy`; during = `flight`; take = `rate`; } );\n";
    RUN_TRIAL(t, text, 7, "ok");
    CHECK_NEAR(measured(&t, "most"), 5.0 + 50.0 * 50.0 / 2000.0, 1e-3);
    CU_ASSERT(measured(&t, "fell") < measured(&t, "most") - 0.2 &&
              measured(&t, "fell") > measured(&t, "most") - 0.25);
    /* from 20 cm/s down 0.25 and 0.35 cm in a pass of a block, then 0.45 and 0.55; the block begins 1.05 cm
     * higher than the flight */
    CU_ASSERT(measured(&t, "by_block") == 1.0 && measured(&t, "before") == 0.0);
    CHECK_NEAR(measured(&t, "fall_0"), 50.0, 1e-9); /* vy = 50 - 1000 t */
    CHECK_NEAR(measured(&t, "fall_1"), -1000.0, 1e-7);
    size_t n;
    const exp_output *o = exp_outputs(t.plan, &n);
    for (size_t k = 0; k < n; k++)
        if (strncmp(o[k].name, "fall_", 5) == 0 || strncmp(o[k].name, "sink_", 5) == 0)
            CU_ASSERT_STRING_EQUAL(o[k].unit, o[k].name[5] == '1' ? "cm/s/s" : "cm/s");
    CU_ASSERT_STRING_EQUAL(o[n - 1].unit, ""); /* of another expression it is not known */
    CU_ASSERT(measured(&t, "by_phase") == 0.0 && measured(&t, "last") == (double)exp_steps(t.run));
}

/* 400 levels at random, each for ten samples: a line through these has the error of 400 values. */
static void test_line_of_correlated(void)
{
    static const char text[] =
        "dt = 1.0e-4; gravity = [0.0, 0.0]; particles = ( { x = 1.0; y = 5.0; r = 0.1; } );\n"
        "phases = ( { name = `wait`; every = 10; steps = 40000; } );\n"
        "measure = ( { name = `l`; of = `sin(7*(floor(100*t) + 0.5)^2)`; during = `wait`; take = `line`; "
        "against = `t`; } );\n";
    RUN_TRIAL(t, text, 1, "ok");
    const double sd_of_t = 4.0 / sqrt(12.0), expected = sqrt(0.5 / 400.0) / sd_of_t;
    CU_ASSERT(fabs(measured(&t, "l_1_se") / expected - 1.0) < 0.35);
    CU_ASSERT(fabs(measured(&t, "l_1")) < 3.0 * expected);
}

/* A line of samples that are too few, or whose distances from it do not settle, has no errors, as a mean. */
static void test_line_without_error(void)
{
    static const char text[] =
        "dt = 1.0e-4; gravity = [0.0, 0.0]; particles = ( { x = 1.0; y = 5.0; r = 0.1; } );\n"
        "phases = ( { name = `wait`; every = 10; steps = %s; } );\n"
        "measure = ( { name = `l`; of = `%s`; during = `wait`; take = `line`; against = `t`; },\n"
        "  { name = `mid`; of = `%s`; during = `wait`; } );\n";
    static const char *const cases[][2] = {{"100", "sin(3000*t)"}, {"2000", "sin(12*t)"}};
    for (size_t k = 0; k < 2; k++) {
        RUN_TRIAL(t, check_text(text, cases[k][0], cases[k][1], cases[k][1]), 100, "ok");
        CU_ASSERT(isfinite(measured(&t, "l_0")) && isfinite(measured(&t, "l_1")) &&
                  isfinite(measured(&t, "mid")));
        CU_ASSERT(isnan(measured(&t, "l_0_se")) && isnan(measured(&t, "l_1_se")) &&
                  isnan(measured(&t, "mid_se")));
    }
}

/* Of a disk that the boundary of a region cuts, the share of its area within counts in mass and fraction:
 * closed forms. Its centre decides whether it counts as a grain. */
static void test_shares(void)
{
    static const char text[] =
        "dt = 1.0e-6; gravity = [0.0, 0.0]; shape = `disk`; particles = ( { x = 1.0; y = 1.0; r = 0.5; m = "
        "1.0; }, { x = 5.0; y = 5.0; r = 0.1; m = 7.0; fixed = true; } );\n"
        "regions = { half = { x = (1.0, `inf`); }; quarter = { x = (1.0, 9.0); y = (0.0, 1.0); };\n"
        "  strip = { y = (0.75, 1.25); }; cap = { y = (1.25, `y + 8`); }; small = { x = (0.9, 1.1); y = "
        "(0.9, "
        "1.2); };\n"
        "  corner = { x = (1.4, 2.0); y = (1.4, 2.0); }; all_ = { x = (0.5, 1.5); y = (0.5, 1.5); };\n"
        "  wedge = { polygon = ( (1.0, 1.0), (3.0, 1.0), (3.0, 3.0) ); };\n"
        "  arrow = { polygon = ( (0.0, 0.0), (0.0, 2.0), (2.0, 2.0), (1.0, 1.0), (2.0, 0.0) ); };\n"
        "  dot = { circle = (1.1, 1.0, 0.2); }; same = { circle = (1.5, 1.0, 0.5); }; big = { circle = (1.0, "
        "1.0, 3.0); }; };\n"
        "phases = ( { name = `look`; steps = 1; } );\n"
        "measure = ( %s { name = `n_half`; of = `half.grains`; }, { name = `n_strip`; of = `strip.grains`; "
        "},\n"
        "  { name = `whole`; of = `dot.whole_mass`; }, { name = `fraction`; of = `quarter.fraction`; } );\n";
    const double cap = (M_PI / 3.0 - sqrt(3.0) / 4.0) / M_PI; /* cut at half of the radius */
    const struct {
        const char *region;
        double share;
    } cases[] = {{"half", 0.5},
                 {"quarter", 0.25},
                 {"strip", 1.0 - 2.0 * cap},
                 {"cap", cap},
                 {"small", 0.2 * 0.3 / (M_PI * 0.25)},
                 {"corner", 0.0},
                 {"all_", 1.0},
                 {"wedge", 0.125},
                 {"arrow", 0.75},
                 {"dot", 0.16},
                 {"same", 2.0 / 3.0 - sqrt(0.75) / M_PI},
                 {"big", 1.0}};
    char list[2048] = "";
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++)
        snprintf(list + strlen(list), sizeof list - strlen(list), "{ name = `m_%s`; of = `%s.mass`; },\n",
                 cases[k].region, cases[k].region);
    RUN_TRIAL(t, check_text(text, list), 10, "ok");
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++)
        CHECK_NEAR(measured(&t, check_text("m_%s", cases[k].region)), cases[k].share, 1e-14);
    CU_ASSERT(measured(&t, "m_corner") == 0.0 && measured(&t, "m_all_") == 1.0);
    CHECK_EACH(measured(&t, NAME), 1e-14, {"n_half", 0.0}, {"n_strip", 1.0}, {"whole", 1.0},
               {"fraction", 0.25 * M_PI * 0.25 / 8.0});
}

/* One measure without a value leaves the others alone, before and after it, in its phase and in later ones;
 * the run ends with the word of the first. What it is of is without a value too. */
static void test_one_without_value(void)
{
    static const char text[] =
        "dt = 1.0e-4; gravity = [0.0, -1000.0]; particles = ( { x = 1.0; y = 5.0; r = 0.1; } );\n"
        "regions = { gone = { x = (0.0, `sqrt(-y)`); }; none = { x = (7.0, 8.0); }; high = { y = (4.7, 9.0); "
        "}; };\n"
        "phases = ( { name = `fall`; every = 10; steps = 200; }, { name = `on`; steps = 100; "
        "},\n"
        "  { name = `twice`; repeat = 2; phases = ( { name = `in`; steps = 10; } ); } );\n"
        "measure = ( { name = `first`; of = `step`; at = `fall`; },\n"
        "  { name = `slope`; of = `slope`; in = `none`; at = `fall`; optional = true; },\n"
        "  { name = `bad`; of = `sqrt(-y)`; at = `fall`; }, { name = `faulty`; of = `gone.grains`; at = "
        "`on`; },\n"
        "  { name = `order`; of = `order.packed`; in = `high`; during = `on`; take = `max`; every = 10; },\n"
        "  { name = `passes`; of = `order.psi6`; in = `none`; at = `in`; take = `mean`; },\n"
        "  { name = `y_rate`; of = `y`; during = `fall`; take = `rate`; }, { name = `after`; of = `bad + 1`; "
        "},\n"
        "  { name = `last`; of = `step`; } );\n";
    RUN_TRIAL(t, text, 7, "no_number");
    CHECK_PARTS(exp_ended(t.run)->message, "bad = \"sqrt(-y)\" is nan; y = ");
    CHECK_EACH(measured(&t, NAME), 0.0, {"first", 200.0}, {"last", 320.0});
    CU_ASSERT(isfinite(measured(&t, "y_rate")) && exp_steps(t.run) == 320);
    static const char *const without[] = {"bad", "faulty", "order", "passes", "after"};
    for (size_t k = 0; k < sizeof without / sizeof *without; k++) CU_ASSERT(isnan(measured(&t, without[k])));
    check_cut(text, &t, 7, 250, 13);
    /* the first in time is a sample */
    RUN_TRIAL(samples, check_changed(text, "`sqrt(-y)`; at", "`y`; at"), 7, "no_pile");
    CU_ASSERT(isfinite(measured(&samples, "bad")) && isnan(measured(&samples, "faulty")) &&
              isnan(measured(&samples, "order")));
    RUN_TRIAL(looks, check_changed(text, "`gone.grains`", "`none.grains`"), 7, "no_number");
    CU_ASSERT(measured(&looks, "faulty") == 0.0 && isnan(measured(&looks, "order")));
    RUN_TRIAL(stops, check_changed(text, "steps = 100;", "every = 10; until = `y > bad`;"), 7, "no_number");
    CU_ASSERT(exp_steps(stops.run) == 210 && strstr(exp_ended(stops.run)->message, "sqrt(-y)"));
}

/* A grain on a level floor presses with its weight, wherever the floor lies and which region it is in; beside
 * the region it counts only in the weight. Of a floor that is not level there is no number. */
static void test_forces(void)
{
    static const char text[] =
        "dt = 4.0e-5; gravity = (%s, -981.0); normal = { gamma_n = 2000.0; };\n"
        "tangential = { law = `spring`; mu = 0.3; gamma_s = 2000.0; };\n"
        "rest = { energy = 1e-20; force = 1e-9; };\n"
        "walls = ( { name = `side`; point = (-9.0, 0.0); direction = (1.0, 0.0); },\n"
        "  { name = `base`; point = (0.0, %s); direction = (%s, 1.0); } );\n"
        "particles = ( { x = 1.0; y = %s; r = 0.1; }, { x = 3.0; y = %s; r = 0.1; } );\n"
        "regions = { here = { x = (0.5, 1.5); y = (%s, 9.0); }; };\n"
        "phases = ( { name = `lie`; until = `rest`; most = 200000; go_on = true; } );\n"
        "measure = ( { name = `f`; of = `forces`; in = `here`; wall = `base`; } );\n";
    static const char *const places[][6] = {{"0.0", "0.0", "0.0", "0.099", "0.099", "0.0"},
                                            {"98.1", "-7.0", "0.0", "-6.901", "-6.901", "-7.0"},
                                            {"0.0", "0.0", "0.2", "-0.09", "-0.49", "-1.0"}};
    for (size_t k = 0; k < 3; k++) {
        const char *const *at = places[k];
        RUN_TRIAL(t, check_text(text, at[0], at[1], at[2], at[3], at[4], at[5]), 1000,
                  k < 2 ? "ok" : "no_pile");
        if (k == 2) CU_ASSERT(strstr(exp_ended(t.run)->message, "the floor is not level") != NULL);
        if (k == 2) continue;
        size_t n;
        CU_ASSERT_STRING_EQUAL(exp_outputs(t.plan, &n)->unit, "weight");
        /* of two such grains; half of the weight at an arm of half of d, less the overlap */
        CHECK_EACH(measured(&t, NAME), 1e-6, {"f_n", 0.5}, {"f_weight_error", 0.0}, {"f_balance_error", 0.0});
        CHECK_NEAR(measured(&t, "f_syy"), 0.5 * 0.5, 1e-3);
        const double tangent = k == 1 ? 0.1 : 0.0; /* of gravity, which the floor holds */
        CHECK_EACH(measured(&t, NAME), 1e-6, {"f_h", 0.5 * tangent}, {"f_friction", tangent}, {"f_sxx", 0.0},
                   {"f_sxy", -tangent * measured(&t, "f_syy")}, {"f_syx", 0.0}, {"f_couple", -tangent});
        CU_ASSERT(isnan(measured(&t, "f_bulk"))); /* nothing presses from the sides */
    }
}

/* Grains apart from one another, over a region's lower end at -3 d: a straight surface; then a shift of 0.3 d
 * and a strain of 0.2 along x, less than which only the xy pattern of 0.1 is left. */
static void test_surface_and_motion(void)
{
    static const char text[] =
        "dt = 1.0e-4; gravity = [0.0, 0.0];\n"
        "particles = ( { x = -4.0; y = -2.0; vx = 10.0; vy = 10.0; r = 0.5; },\n"
        "  { x = -2.0; y = -2.0; vx = 50.0; vy = -10.0; r = 0.5; },\n"
        "  { x = -4.0; y = 0.0; vx = 10.0; vy = -10.0; r = 0.5; },\n"
        "  { x = -2.0; y = 0.0; vx = 50.0; vy = 10.0; r = 0.5; },\n"
        "  { x = 10.5; y = -0.5; r = 0.5; }, { x = 11.5; y = -1.0; r = 0.5; },\n"
        "  { x = 12.5; y = -1.5; r = 0.5; }, { x = 13.5; y = -2.0; r = 0.5; },\n"
        "  { x = 14.5; y = -2.5; r = 0.5; } );\n"
        "regions = { four = { x = (-5.0, -1.0); y = (-3.0, 9.0); }; stairs = { x = (10.0, 15.0); y = (-3.0, "
        "9.0); }; thin = { x = (10.0, 10.4); }; };\n"
        "phases = ( { name = `move`; steps = 100; } );\n"
        "measure = ( { name = `u`; of = `motion`; in = `four`; },\n"
        "  { name = `s`; of = `slope`; in = `stairs`; },\n"
        "  { name = `n`; of = `slope`; in = `thin`; optional = true; } );\n";
    RUN_TRIAL(t, text, 1000, "ok");
    CU_ASSERT(isnan(measured(&t, "n_cells"))); /* of less than a column */
    CHECK_EACH(measured(&t, NAME), 1e-9, {"u_nonaffine", 0.1}, {"u_share", 0.01 / (0.01 + 0.04)},
               {"u_x", 0.5}, {"u_y", 2.0}, {"u_depth", 1.0}, {"u_all_y", 2.0}, {"u_reach", hypot(0.5, 0.1)},
               {"s_r1_deg", atan(0.5) * 180.0 / M_PI}, {"s_r2_deg", atan(0.5) * 180.0 / M_PI},
               {"s_r3_deg", atan(0.5) * 180.0 / M_PI}, {"s_cells", 5.0});
}

static const char hopper[] =
    "let = { D = { value = 1.6; unit = `cm`; range = `(0, 6)`; meaning = `outlet`; }; mu = 0.2; N = 60; stop "
    "= 20; };\n"
    "dt = 5.0e-5; y_min = -1.0;\n"
    "tangential = { law = `spring`; mu = `mu`; };\n"
    "walls = ( { name = `bin`; polygon = ((0.0, 40.0), (0.0, 0.0), (`1 - D/4`, 0.0)); closed = false; },\n"
    "  { name = `bin`; polygon = ( ( `1 + D/4`, 0.0 ), ( 2.0, 0.0 ), ( 2.0, 40.0 ) ); closed = false; },\n"
    "          { name = `gate`; polygon = ( ( `1 - D/4`, 0.0 ), ( `1 + D/4`, 0.0 ) ); closed = false; } );\n"
    "fill = { N = `N`; W = 2.0; H = 4.0; };\n"
    "regions = { bulk = { x = [0.5, 1.5]; y = [0.0, 1.0]; }; };\n"
    "phases = ( { name = `fill`; least = 2000; every = 100; until = `held(energy < 1e-3, 3)`; },\n"
    "           { name = `flow`; open = `gate`; every = 50; until = `grains < stop`; most = 40000;\n"
    "             fail = { clogged = `rest`; }; } );\n"
    "measure = ( { name = `depth`; of = `height`; at = `fill`; },\n"
    "  { name = `rate`; of = `out`; during = `flow`; take = `rate`; unit = `1/s`; },\n"
    "  { name = `packed`; of = `bulk.fraction`; at = `fill`; },\n"
    "  { name = `mean_y`; of = `y`; during = `flow`; series = true; } );\n";

static const char shaken[] = "dt = 5.0e-5; let = { f = 20.0; A = 0.05; w = `2*pi*f`; };\n"
                             "walls = ( { name = `box`; polygon = ((0.0, 9.0), (0.0, 0.0), (2.0, 0.0), (2.0, "
                             "9.0)); closed = false; } );\n"
                             "fill = { N = 40; W = 2.0; H = 3.0; };\n"
                             "phases = ( { name = `fall`; steps = 2000; },\n"
                             "  { name = `shake`; walls = { box = { velocity = (0.0, `A*w*sin(w*t)`); }; }; "
                             "time = `2/f`; every = 50; },\n"
                             "  { name = `sway`; gravity = (`300*sin(w*t)`, -981.0); time = `1/f`; } );\n"
                             "measure = ( { name = `rises`; of = `y`; during = `shake`; take = `max`; }, { "
                             "name = `xs`; of = `x`; } );\n";

static void test_cuts(void)
{
    static const long parts[] = {1, 7, 333};
    static const char turned[] =
        "dt = 1.0e-4; gravity = (0.0, -981.0); particles = ( { x = 0.0; y = 0.0; r = 0.1; fixed = true; } "
        ");\n"
        "phases = ( { name = `turn`; steps = 1997; gravity_turn_deg_per_step = 0.0123; },\n"
        "  { name = `more`; every = 13; until = `tilt_deg > 40`; most = 9000; } );\n"
        "measure = ( { name = `a`; of = `tilt_deg`; at = `turn`; }, { name = `b`; of = `tilt_deg`; } );\n";
    RUN_TRIAL(slowly, turned, 1000000, "ok");
    CHECK_NEAR(measured(&slowly, "a"), 1997 * 0.0123, 1e-12);
    for (size_t k = 0; k < 3; k++) check_cut(turned, &slowly, parts[k], 1000 + parts[k], parts[k]);
    for (int text = 0; text < 2; text++) {
        RUN_TRIAL(whole, text ? shaken : hopper, 1000000, "ok");
        size_t n;
        exp_outputs(whole.plan, &n);
        CU_ASSERT(text ? measured(&whole, "xs") != 1.0 : n == 8 && measured(&whole, "rate") > 100.0);
        for (size_t k = 0; k < 3; k++)
            check_cut(text ? shaken : hopper, &whole, parts[k], 2000 + 20 * parts[k], parts[k]);
    }
}

/* Where a run is: its phase, and what an `until` waits for once that has begun. */
static void test_where(void)
{
    scoped_trial one, two;
    char text[256];
    start(&one, hopper), start(&two, shaken);
    CU_ASSERT(strcmp(exp_where(one.run, text, sizeof text), "fill") == 0);
    CHECK_OK(exp_advance(one.run, 500));
    CHECK_OK(exp_advance(two.run, 500));
    CHECK_PARTS(exp_where(one.run, text, sizeof text),
                "fill: step 500, t = 0.025: energy = ", ", until held(energy < 1e-3, 3)");
    CHECK_PARTS(exp_where(two.run, text, sizeof text), "fall: step 500 of 2000, t = 0.0");
    scoped_trial three;
    start(&three, check_changed(hopper, "held(energy < 1e-3, 3)", "energy < 1e-3 and rest"));
    CHECK_OK(exp_advance(three.run, 500));
    CHECK_PARTS(exp_where(three.run, text, sizeof text), ", rest = 0, until energy");
    CU_ASSERT(strstr(text, "energy = 0,") == NULL);
}

static void test_words(void)
{
    static const trial_change cases[] = {
        {hopper, "most = 40000;", "most = 100;", "most_flow"},
        {hopper, "most = 40000;", "most = 100; status = `slow`;", "slow"},
        {hopper, "most = 40000;", "most = 100; status = `slow`; go_on = true;", "slow"},
        {hopper, "most = 40000;", "most = 100; go_on = true;", "ok"},
        {hopper, "clogged = `rest`", "deep = `grains < 50`", "deep"},
        {hopper, "N = 60", "N = 6000", "no_room"},
        {hopper, "`height`", "`sqrt(-height)`", "no_number"},
        {hopper, "`height`", "`sqrt(-height) > 1 ? 1 : 2`", "no_number"},
        {hopper, "clogged = `rest`", "low = `sqrt(-height) < 5`", "no_number"},
        {hopper, "clogged = `rest`", "low = `height < 0 and sqrt(-height) < 5`", "ok"},
        {hopper, "grains < stop", "not (sqrt(-height) < 5)", "no_number"},
        {hopper, "held(energy < 1e-3, 3)`", "rest`; most = 4000", "not_at_rest"},
        {hopper, "take = `rate`", "when = `grains < 0`; take = `rate`", "no_samples"},
        {hopper, "`out`; during = `flow`; take = `rate`", "`sqrt(8 - out)`; during = `flow`; take = `max`",
         "no_samples"},
        {hopper, "`out`; during = `flow`; take = `rate`",
         "`sqrt(8 - out)`; during = `flow`; take = `max`; series = true", "no_samples"},
        {hopper, "clogged = `rest`", "narrow = `D < 2`", "narrow"},
        {hopper, "clogged = `rest`", "narrow = `D > 2`", "ok"},
        {hopper, "phases = (",
         "phases = ( { name = `none`; steps = 0; fail = { at_end = `grains > 0`; }; }, ", "at_end"},
        {hopper, "phases = (", "result = `D > 2 ? 'ok' : 'ok_narrow'`; phases = (", "ok_narrow"},
        {hopper, "take = `rate`", "when = `grains < 0`; optional = true; take = `rate`", "ok"}};
    check_ends(sizeof cases / sizeof *cases, cases);
    RUN_TRIAL(t, check_changed(hopper, "clogged = `rest`", "low = `sqrt(-height) < 5`"), 1000, "no_number");
    CHECK_PARTS(exp_ended(t.run)->message, ": low \"sqrt(-height) < 5\" is nan; height = ");
    RUN_TRIAL(early,
              check_changed(hopper, "phases = (",
                            "phases = ( { name = `none`; steps = 0; fail = { no = `true`; }; }, "),
              1000, "no");
    size_t n;
    exp_outputs(early.plan, &n);
    CU_ASSERT(n > 0);
    for (size_t k = 0; k < n; k++) CU_ASSERT(isnan(exp_values(early.run)[k]));
}

static void test_refused(void)
{
    static const trial_change cases[] = {
        {hopper, "grains < stop", "grians < stop",
         "e.cfg:10: until \"grians < stop\", character 1: unknown name grians (did you mean \"grains\"?)"},
        {hopper, "grains < stop", "bulk.grain < 3",
         "unknown name bulk.grain (did you mean \"bulk.grains\"?)"},
        {hopper, "grains < stop", "D > 3", "until \"D > 3\" never changes"},
        {hopper, "take = `rate`", "take = `line`", "take = \"line\" goes with against"},
        {hopper, "y = [0.0, 1.0]", "y = (0.0, `rest ? 1 : 2`)",
         "bulk: held and rest count looks; not in a region"},
        {hopper, "y = [0.0, 1.0]", "y = (0.0, `held(height < 1, 3) ? 1 : 2`)", "not in a region"},
        {hopper, "take = `rate`", "take = `rate`; against = `t`", "take = \"line\" goes with against"},
        {hopper, "clogged = `rest`", "clogged = true", "clogged = 1 never changes"},
        {hopper, "phases = (", "result = `D > 2 ? 'ok' : 'narrow'`; phases = (",
         "result = \"narrow\": ok or ok_... expected"},
        {hopper, "phases = (", "require = ( (`D > 2 or mu == 0`, `too narrow`) ); phases = (",
         "too narrow (D > 2 or mu == 0; D = 1.6; mu = 0.2)"},
        {hopper, "phases = (", "require = ( (`not (sqrt(0-D) < 1)`, `x`) ); phases = (",
         "require \"not (sqrt(0-D) < 1)\": is nan"},
        {hopper, "phases = (", "require = ( (`D`, `x`) ); phases = (", "require \"D\": a condition expected"},
        {hopper, "phases = (", "require = ( (`grains > 2`, `x`) ); phases = (", "unknown name grains"},
        {hopper, "phases = (", "require = ( `D > 2` ); phases = (",
         "require: (\"condition\", \"message\") expected"},
        {hopper, "grains < stop", "D", "until \"D\", a number stands where a condition is expected"},
        {hopper, "grains < stop", "rate > 3", "rate is measured at flow, after this phase"},
        {hopper, "grains < stop", "atan(y) > 1", "atan: only in measure"},
        {hopper, "grains < stop", "moved() > 1", "moved: 1 to 2 numbers in brackets expected"},
        {hopper, "grains < stop", "grains(3) > 1", "grains: takes nothing in brackets"},
        {hopper, "until = `grains < stop`; ", "", "phase flow: steps, time or until is missing"},
        {hopper, "until = `grains < stop`; ", "until = `grains < stop`; steps = 3; ",
         "phase flow: steps and until; keep one"},
        {hopper, "until = `grains < stop`; ", "time = -3.0; ", "time = -3: out of range"},
        {hopper, "open = `gate`", "open = `gat`",
         "open = \"gat\": no wall has this name (did you mean \"gate\"?)"},
        {hopper, "open = `gate`", "opens = `gate`", "opens: unknown key (did you mean \"open\"?)"},
        {hopper, "clogged =", "ok_clogged =", "fail: ok_clogged: a word"},
        {hopper, "clogged =", "crashed =", "crashed: a word of the sweeps' own"},
        {hopper, "unit = `1/s`", "unit = `1/\\ts`", "unit: a text on one line, without tabs, in UTF-8"},
        {hopper, "unit = `1/s`", "meaning = `caf\xe9`", "meaning: a text on one line"},
        {hopper, "name = `flow`", "name = `fill`", "name = \"fill\": names two phases"},
        {hopper, "bulk = {", "gate = {", "gate names a wall and a region"},
        {hopper, "bulk = {",
         "r234567890123456789012345678901 = { y = [0.0, 1.0]; }; r2345678901234567890123456789012 = {",
         "\"r2345678901234567890123456789012\": the name of a region has up to 31 letters"},
        {hopper, "bulk = {", "D = {", "D names a let and a region"},
        {hopper, "mu = 0.2;", "mu = 0.2; height = 3.0;",
         "let height: height already stands for something in every expression"},
        {hopper, "x = [0.5, 1.5]; y = [0.0, 1.0];", "z = 3;", "regions.bulk.z: unknown key"},
        {hopper, "x = [0.5, 1.5]; y = [0.0, 1.0];", "", "bulk: x, y or both, or circle, or polygon expected"},
        {hopper, "name = `depth`", "name = `D`", "D names a let and a measure"},
        {hopper, "name = `depth`", "name = `rate`", "rate: two measures have this column"},
        {hopper, "at = `fill`", "at = `fil`", "at = \"fil\": no such phase (did you mean \"fill\"?)"},
        {hopper, "at = `fill`", "at = `fill`; take = `mean`", "measure depth: take = \"mean\": needs during"},
        {hopper, "at = `fill`", "at = `fill`; series = true", "series: needs samples, during"},
        {hopper, "unit = `1/s`", "drop = 1.0", "drop: needs take = \"avalanches\""},
        {hopper, "at = `fill`", "at = `fill`; prefix = `a-b`", "\"a-b\": the name of a column has up to"},
        {hopper, "of = `height`; ", "", "measure depth: of: missing"},
        {hopper, "of = `height`", "of = `height > 1`",
         "of \"height > 1\", a condition stands where a number is expected"},
        {hopper, "of = `height`", "of = `mean_y`", "mean_y is measured after this"},
        {hopper, "unit = `1/s`", "unit = 3", "unit"},
        {hopper, "unit = `1/s`", "level_of = `dept`",
         "level_of = \"dept\": no earlier measure has this name (did you"},
        {hopper, "unit = `1/s`", "level_of = `depth`",
         "level_of = \"depth\": samples of the same looks expected"},
        {hopper, "unit = `1/s`", "level_of = `depth`; skip = 0.1", "level_of and skip; keep one"},
        {hopper, "unit = `1/s`", "columns = 3", "columns: names, [\"NAME\", ...], expected"},
        {hopper, "unit = `1/s`", "columns = [`mu`]", "mu names a let and a column"},
        {hopper, "unit = `1/s`", "columns = [`depth`]", "depth: two measures have this column"},
        {hopper, "regions =", "result = `fine`; regions =", "result = \"fine\": ok or ok_... expected"},
        {hopper, "dt = 5.0e-5", "dt = `D > 1`", "dt = \"D > 1\": "},
        {hopper, "dt = 5.0e-5", "dt = 5.0e-3", "dt = 0.005: too large for"}};
    check_refused(sizeof cases / sizeof *cases, cases);
}

static void test_keys(void)
{
    /* what is replaced by what, and whether that may change the numbers; suite schemas has the keys */
    static const trial_change cases[] = {{hopper, "D = {", "/* outlet */ D = {", "same"},
                                         {hopper, "meaning = `outlet`", "meaning = `gap`", "same"},
                                         {hopper, "stop = 20", "stop = 2.00e1", "same"},
                                         {hopper, "grains < stop", "grains < 4*5", "another"},
                                         {hopper, "  { name = `packed`", "\n { name = `packed`", "same"},
                                         {hopper, "clogged = `rest`", "jammed = `rest`", "another"}};
    check_keys(sizeof cases / sizeof *cases, cases);
}

/* A text, and its later phases alone with the simulation of those before. */
static const char three_phases[] =
    "dt = 5.0e-5; tangential = { law = `spring`; mu = 0.3; };\n"
    "walls = ( { name = `floor`; point = (0.0, 0.0); direction = (0.0, 1.0); },\n"
    "          { name = `left`; point = (0.0, 0.0); direction = (1.0, 0.0); },\n"
    "          { name = `right`; point = (2.0, 0.0); direction = (-1.0, 0.0); } );\n"
    "fill = { N = 60; W = 2.0; H = 4.0; };\n"
    "phases = ( { name = `a`; steps = 6000; }, { name = `b`; tangential = { mu = 0.6; }; dt = 4.0e-5; steps "
    "= 3000; },\n"
    "  { name = `c`; open = `right`; add = { r = 0.1; x = 1.0; y = `touch + d`; }; time = 0.2; } );\n"
    "measure = ( { name = `left_over`; of = `grains`; } );\n";

static uint64_t digest_of(const trial *t)
{
    uint64_t digest = 0;
    CHECK_OK(dem_digest(exp_sim(t->run), &digest));
    return digest;
}

static void test_started_at(void)
{
    RUN_TRIAL(whole, three_phases, 1000000, "ok");
    CU_ASSERT(measured(&whole, "left_over") == 61.0);
    for (size_t phase = 1; phase < 3; phase++) {
        scoped_trial first, rest;
        start(&first, three_phases);
        while (exp_stages(first.run) < phase) CHECK_OK(exp_advance(first.run, 1000000));
        const uint64_t before = digest_of(&first);
        CHECK_OK(read_text(&rest, three_phases));
        CHECK_OK(exp_start_at(rest.plan, phase, exp_sim(first.run), &rest.run));
        CU_ASSERT(digest_of(&rest) == before);
        finish(&rest, 77);
        CU_ASSERT(digest_of(&first) == before && digest_of(&rest) == digest_of(&whole));
        CU_ASSERT(exp_steps(rest.run) == exp_steps(whole.run) && measured(&rest, "left_over") == 61.0);
        CHECK_OK(exp_advance(first.run, 1));
        CU_ASSERT(digest_of(&first) != before);
    }
}

/* ---- the program ---- */

static void test_run(void)
{
    write_trial("h.cfg", hopper);
    SHELL("$REPOSE run h.cfg 2>err | $REPOSE export - --to json >out && grep -q '\"status\": \"ok\"' out");
    CU_ASSERT(strstr(out, "{\"measure\": \"rate\", \"value\": ") != NULL);
    scoped_trial t; /* run 0 of the seed 1993, as a text has it */
    CHECK_OK(read_text(&t, hopper));
    CHECK_OK(exp_start(t.plan, 1993, 0, &t.run));
    finish(&t, 1000000);
    PRINTS(check_text("\n# digest: %016" PRIx64 " of ", digest_of(&t)), "run h.cfg");
    GOOD("run h.cfg -o whole --every 700");
    CU_ASSERT(strstr(err, "repose run: ok, ") && strstr(err, "; tables in whole"));
    scoped_table m = read_table("whole/measures.tsv");
    CU_ASSERT(m.n_rows == 8 && cell(&m, 0, "value") > 0.5);
    scoped_table series = read_table("whole/series_mean_y.tsv");
    CU_ASSERT(series.n_rows > 10);
    PRINTS("\nD\tlet\t1.6\tcm\t(0, 6)\toutlet\n", "params h.cfg");
    CHECK_PARTS(out, "\nN\tlet\t60\t-\t-\t-\nstop\tlet\t20\t-\t-\t-\n", "\nrate\tmeasure\t-\t1/s\t-\t");
    FAILS(64, "--every needs -o DIR", "run h.cfg --every 3");
    FAILS(65, "--set Q=1: no such key or let; lets: D mu", "run h.cfg --set Q=1");
    FAILS(65, "--set Mu=0.3: no such key or let (did you mean \"mu\"?)", "run h.cfg --set Mu=0.3");
    FAILS(65, "let.D: D = 7: out of range, allowed: (0, 6) cm", "run h.cfg --set D=7");
    SHELL("{ echo 'gravity = [0.0, -900.0]; seed = 7; rest = { force = 0.02; };'; cat h.cfg; } >g.cfg; "
          "$REPOSE run g.cfg 2>/dev/null | grep '^# digest' >given && $REPOSE run h.cfg --set seed=7 --set "
          "'gravity=[0.0, -900.0]' --set rest.force=0.02 2>/dev/null | grep '^# digest' | cmp - given");
    FAILS(1, "clogged: phase flow, step ",
          "run h.cfg --set 'phases[1].fail.clogged=rest or grains < 50' -o o");
    CU_ASSERT(strstr(out, "# status: clogged") != NULL);
    SHELL("grep -qx '# status: clogged' o/measures.tsv && ! test -e o.part");
}

static void test_swept(void)
{
    write_trial("h.cfg", hopper);
    write_text("s.cfg", "experiment = \"h.cfg\"; replicas = 3; seed = 6; set = [ \"rest.looks=9\" ];\n"
                        "fixed = { mu = 0.25; }; grid = { D = [1.4, 1.6]; };\n");
    SHELL("sed -i 's/^regions/rest = { looks = 10; }; regions/' h.cfg");
    GOOD("sweep make s.cfg -o s --tables t -j 2 --quiet");
    scoped_table t = read_table("t/runs.tsv");
    CU_ASSERT(t.n_rows == 6 && cell(&t, 0, "D") == 1.4 && cell(&t, 5, "D") == 1.6);
    CU_ASSERT(cell(&t, 5, "rate") > 100.0 && cell(&t, 5, "rate") != cell(&t, 4, "rate"));
    /* a row again, alone; the folder has all that it needs */
    SHELL("mv h.cfg gone.cfg && $REPOSE run s/sweep.cfg --row 5 -o row >row.out 2>/dev/null");
    scoped_table row = read_table("row.out");
    CU_ASSERT(cell(&row, 0, "rate") == cell(&t, 5, "rate"));
    scoped_table series = read_table("row/series_mean_y.tsv");
    CU_ASSERT(series.n_rows > 10);
    SHELL("sed 's/\"rate\"; unit/\"rate\"; series = true; unit/' gone.cfg >r.cfg && $REPOSE run r.cfg -o r "
          ">out 2>&1 && grep -q '^# units: 1.s.1$' r/series_rate.tsv"); /* that of a sample */
    GOOD("view row --frame flow -o row.svg");
    FAILS(64, "or a phase that has ended", "view row --frame flows -o row.svg");
    GOOD("sweep status s");
    /* in shards, with the same digest */
    SHELL("mv gone.cfg h.cfg && $REPOSE sweep plan s.cfg -o p >/dev/null");
    for (int k = 1; k < 4; k++) GOOD("sweep run p --shard %d/3 -j 1 --quiet", k);
    SHELL("$REPOSE sweep merge p >/dev/null && [ \"$($REPOSE sweep digest s)\" = \"$($REPOSE sweep digest "
          "p)\" ]");
    /* with other measures the runs are made again; those of before come back with their measures */
    SHELL("cp h.cfg kept.cfg && sed -i 's/name = \"rate\"/name = \"flux\"/' h.cfg && $REPOSE sweep plan "
          "s.cfg -o s | grep -q ' 0 already stored' && $REPOSE sweep make s.cfg -o s --tables flux --quiet "
          "&& cp kept.cfg h.cfg && $REPOSE sweep plan s.cfg -o s | grep -q ' 6 already stored' && $REPOSE "
          "sweep make s.cfg -o s --quiet");
    scoped_table flux = read_table("flux/runs.tsv"), again = read_table("s/tables/runs.tsv");
    CU_ASSERT(cell(&flux, 5, "flux") == cell(&t, 5, "rate") &&
              cell(&again, 5, "rate") == cell(&t, 5, "rate"));
    /* with another default of what is fixed the streams are others: no row is stored, and none is damaged */
    SHELL("sed -i 's/mu = 0.2;/mu = 0.25;/' h.cfg && $REPOSE sweep make s.cfg -o s --quiet && cp kept.cfg "
          "h.cfg && sed -i 's/looks=9/looks=9.0/' s.cfg && $REPOSE sweep make s.cfg -o s --quiet");
    /* another phase is another plan; its rows are made again */
    SHELL("sed -i 's/least = 2000/least = 2100/' h.cfg && $REPOSE sweep plan s.cfg -o s | grep -q "
          "' 0 already stored'");
}

static const char beds[] =
    "let = { v = 5.0; top = 0.5; };\ndt = 5e-5; tangential = { law = `spring`; mu = 0.4; };\n"
    "walls = ( { polygon = ( (0.0, 9.0), (0.0, 0.0), (2.0, 0.0), (2.0, 9.0) ); closed = false; } );\n"
    "fill = { N = 20; W = 2.0; H = 2.0; };\nregions = { low = { x = (0.0, 2.0); y = (0.0, `top`); }; };\n"
    "phases = ( { name = `pour`; steps = 2000; }, { name = `bed`; steps = 2000; },\n"
    "  { name = `hit`; add = { r = 0.1; x = 1.0; y = `touch`; vy = `-v`; }; steps = 200; } );\n"
    "measure = ( { name = `poured`; of = `contacts`; at = `pour`; }, { name = `bed_height`; of = `height`; "
    "at = `bed`; },\n  { name = `after`; of = `energy`; at = `hit`; }, { name = `low_mass`; of = "
    "`low.mass`; at = `hit`; } );\n";

/* A measure that goes or moves leaves rows as they are. With one that comes they are run again, and keep what
 * they have of the others: back with the first text all are there. */
static void test_other_measures(void)
{
#define POURED "{ name = `poured`; of = `contacts`; at = `pour`; }"
#define BED    "{ name = `bed_height`; of = `height`; at = `bed`; }"
#define LOW    "{ name = `low_mass`; of = `low.mass`; at = `hit`; }"
    static const struct {
        const char *from, *to;
        int stored, back; /* of 4 rows */
    } cases[] = {{", " LOW, "", 4, 4},
                 {POURED ", ", "", 4, 4},
                 {POURED ", " BED, BED ", " POURED, 4, 4},
                 {"at = `hit`; }, " LOW, "at = `hit`; meaning = `later`; unit = ``; }, " LOW, 4, 4},
                 {LOW, LOW ", { name = `left_at`; of = `left`; }", 0, 4},
                 {LOW, LOW ", { name = `spin_at`; of = `spin + bed_height`; at = `bed`; }", 0, 4},
                 {"`low.mass`", "`sqrt(-low.mass)`", 0, 0},
                 {"`contacts`", "`contacts + 1`", 0, 4},
                 {"top = 0.5", "top = 0.6", 0, 4},
                 {"steps = 2000; }, {", "steps = 2001; }, {", 0, 4}};
    write_text("s.cfg", "experiment = \"e.cfg\"; replicas = 2; seed = 5; grid = { v = [5.0, 9.0]; };\n");
    write_trial("e.cfg", beds);
    GOOD("sweep make s.cfg -o first --quiet");
    GOOD("sweep digest first");
    SHELL("cp out digest && cp e.cfg first.cfg");
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        write_trial("e.cfg", check_changed(beds, cases[k].from, cases[k].to));
        CU_ASSERT(
            shell_line("rm -rf again new && cp -r first again && $REPOSE sweep plan s.cfg -o again "
                       "| grep -q ' %d already stored' && $REPOSE sweep run again -j 1 --quiet && "
                       "$REPOSE sweep plan s.cfg -o new && $REPOSE sweep run new -j 1 --quiet && [ "
                       "\"$($REPOSE sweep digest again)\" = \"$($REPOSE sweep digest new)\" ] && cp "
                       "first.cfg e.cfg && $REPOSE sweep plan s.cfg -o again | grep -q ' %d already "
                       "stored' && $REPOSE sweep run again -j 1 --quiet && $REPOSE sweep digest again | "
                       "cmp - digest",
                       cases[k].stored, cases[k].back) == 0);
    }
    /* of two stores, of which one has more measures of the same runs */
    write_trial("e.cfg", check_changed(beds, ", " LOW, ""));
    SHELL("rm -rf again && $REPOSE sweep make s.cfg -o again --quiet && cp first.cfg e.cfg && $REPOSE sweep "
          "plan s.cfg -o again | grep -q ' 0 already stored' && $REPOSE sweep merge again first >out && "
          "$REPOSE sweep digest again | cmp - digest");
}

static void test_sweeps_refused(void)
{
    static const char *const cases[][2] = {
        {"experiment = \"no.cfg\";", "s.cfg: experiment: "},
        {"experiment = \"plain.cfg\";", "plain.cfg: has no phases; a sweep needs an experiment"},
        {"experiment = \"h.cfg\"; protocol = \"repose\";", "s.cfg:1: protocol: the experiment's text has it"},
        {"experiment = \"h.cfg\"; units = \"si\";", "s.cfg:1: units: the experiment's text has it"},
        {"protocol = \"pile\"; set = [ \"mu=1\" ];", "s.cfg:1: set: changes an experiment"},
        {"experiment = \"h.cfg\"; set = [ \"moo=1\" ];", "moo"},
        {"experiment = \"h.cfg\"; set = [ \"seed=1\" ];",
         "set: seed=1: random numbers follow from the sweep's"},
        {"experiment = \"h.cfg\"; fixed = { moo = 0.1; };",
         "fixed.moo: unknown key; allowed: D mu unused N stop"},
        {"experiment = \"h.cfg\"; grid = { D = [1.0, 7.0]; };",
         "s.cfg:1: grid.D = 7: out of range, allowed: (0, 6) cm"},
        {"experiment = \"h.cfg\"; grid = { N = [60.0, 60.5]; };", "grid point N = 60.5: "},
        {"experiment = \"h.cfg\"; grid = { unused = [1.0, 1.0]; };", "appears twice in the grid"},
        {"experiment = \"files.cfg\";", "particles_file: a text that is swept must be whole in itself"},
        {"experiment = \"included.cfg\";", "included.cfg:1: @include: a file must be whole in itself"},
        {"experiment = \"taken.cfg\";", ": replica is a column that every sweep has"},
        {"experiment = \"mean.cfg\";", "mean.cfg: rate_mean is a let, and what a sweep's points call a"},
        {"experiment = \"pile.cfg\"; grid = { pile = [1.0, 2.0]; };",
         "pile: is a column that every sweep has"},
        {"replicas = 3;", "protocol or experiment: missing"}};
    write_trial("h.cfg", check_changed(hopper, "mu = 0.2", "mu = 0.2; unused = 1.0"));
    write_text("plain.cfg", "steps = 3; particles = ( { x = 0.0; y = 0.0; r = 0.1; } );\n");
    write_text("files.cfg", "particles_file = \"p.tsv\"; phases = ( { name = \"a\"; steps = 3; } );\n");
    write_text("p.tsv", "x\ty\tr\n0\t0\t0.1\n");
    SHELL("sed 's/packed/replica/' h.cfg >taken.cfg; sed 's/unused/rate_mean/' h.cfg >mean.cfg; sed "
          "'s/unused/pile/' h.cfg >pile.cfg");
    write_text("included.cfg", "@include \"h.cfg\"\n");
    CHECK_REFUSED(cases, "s.cfg", "sweep plan s.cfg -o s");
    SHELL("[ ! -e s ]");
    SHELL("mkdir d && for c in run merge; do $REPOSE sweep $c d 2>out; grep -q 'd/sweep.cfg: cannot "
          "read' out || exit 9; done; rmdir d"); /* a folder of no sweep stays as it is */
}

/* 60 degrees are a whole number of steps at each rate, though 60/1e-5 is not one. */
static void test_slow_turns(void)
{
    static const char *const protocols[] = {"onset", "repose", "stress"};
    for (size_t k = 0; k < 3; k++) {
        write_text("s.cfg", "protocol = \"%s\"; replicas = 1; fixed = { tilt_rate_deg = 1.0e-5; };\n",
                   protocols[k]);
        GOOD("sweep plan s.cfg -o slow_%s", protocols[k]);
    }
}

/* A let that is computed again, after a grid point that gave it a number. */
static void test_computed_again(void)
{
    write_text("c.cfg", "let = { a = 0.5; b = { value = \"a\"; range = \"[0, inf) | endless\"; }; c = "
                        "\"2*b\"; }; particles = ( { x = 0.0; y = 0.0; r = 0.1; } ); phases = ( { name = "
                        "\"fall\"; steps = 3; } ); measure = ( { name = \"is\"; of = \"c\"; } );\n");
    write_text("s.cfg", "experiment = \"c.cfg\"; replicas = 1; grid = { b = (\"computed\", 0.25); };\n");
    GOOD("sweep make s.cfg -o again -j 1 --quiet");
    PRINTS("\n0\tok\tcomputed\t0\t", "sweep export again");
    SHELL("$REPOSE stats select --columns b,is --bare out | tr '\\t\\n' '  ' | grep -q '^computed 1 0.25 0.5 "
          "$'");
    write_text("s.cfg", "experiment = \"c.cfg\"; replicas = 1; fixed = { b = \"endless\"; };\n");
    FAILS(65, "fixed.b = \"endless\": a number expected, allowed: [0, inf) | computed",
          "sweep plan s.cfg -o e");
}

/* ---- walls, modules and avalanches ---- */

static const char lift[] =
    "dt = 1.0e-4; gravity = (0.0, -1000.0); let = { v = 2.0; };\n"
    "walls = ( { name = `plate`; polygon = ((-1.0, 0.0), (1.0, 0.0)); closed = false; } );\n"
    "particles = ( { x = 0.5; y = 0.1; r = 0.1; m = 0.01; } ); tangential = { law = `spring`; mu = 0.5; };\n"
    "phases = ( { name = `lie`; steps = 3000; },\n"
    "  { name = `up`; walls = { plate = { velocity = (0.0, `v`); }; }; every = 10; until = `plate.y >= 0.5`; "
    "},\n"
    "  { name = `wait`; walls = { plate = { velocity = (0.0, 0.0); }; }; steps = 3000; },\n"
    "  { name = `tilt`; walls = { plate = { omega = 0.1; }; }; time = 2.0; },\n"
    "  { name = `stop`; walls = { plate = { omega = 0.0; }; }; steps = 3000; } );\n"
    "measure = ( { name = `y0`; of = `y`; at = `lie`; },\n"
    "  { name = `torque`; of = `plate.torque`; at = `lie`; }, { name = `vy_`; of = `vy`; at = `up`; },\n"
    "  { name = `wall_vy`; of = `plate.vy`; at = `up`; }, { name = `y1`; of = `y`; at = `wait`; },\n"
    "  { name = `p1`; of = `plate.y`; at = `wait`; }, { name = `turned`; of = `plate.angle`; },\n"
    "  { name = `x2`; of = `x`; }, { name = `y2`; of = `y`; }, { name = `px`; of = `plate.x`; },\n"
    "  { name = `py`; of = `plate.y`; }, { name = `f`; of = `plate.fy`; } );\n";

/* In a box that has turned by 20 degrees, places are those of the box, and a torque is about the pivot as it
 * lies now: between two pivots it differs by the moment of the force. */
static void test_turned_walls(void)
{
    static const char turned[] =
        "dt = 1.0e-4; gravity = (0.0, -1000.0); particles = ( { x = 0.5; y = 0.1; r = 0.1; m = 0.01; } );\n"
        "walls = ( { name = `plate`; polygon = ((-1.0, 0.0), (1.0, 0.0)); closed = false; pivot = (0.7, "
        "0.4); },\n  { name = `line`; point = (1.0, 0.0); direction = (-1.0, 0.0); } );\n"
        "tangential = { law = `spring`; mu = 0.9; };\n"
        "phases = ( { name = `lie`; box_turn_deg_per_step = 0.02; steps = 1000; } );\n"
        "measure = ( { name = `px`; of = `plate.x`; }, { name = `py`; of = `plate.y`; },\n"
        "  { name = `lx`; of = `line.x`; }, { name = `ly`; of = `line.y`; },\n"
        "  { name = `about`; of = `plate.torque`; }, { name = `fx`; of = `plate.fx`; }, { name = `fy`; of = "
        "`plate.fy`; } );\n";
    RUN_TRIAL(about, turned, 1000, "ok");
    RUN_TRIAL(other, check_changed(turned, "(0.7, 0.4)", "(0.0, 0.0)"), 1000, "ok");
    const double c = cos(20.0 * M_PI / 180.0), s = sin(20.0 * M_PI / 180.0), fx = measured(&about, "fx"),
                 fy = measured(&about, "fy"), x = 0.7 * c + 0.4 * s, y = 0.4 * c - 0.7 * s;
    CHECK_PAIRS(1e-12, {measured(&about, "px"), 0.0}, {measured(&about, "py"), 0.0},
                {measured(&about, "lx"), 1.0}, {measured(&about, "ly"), 0.0});
    CU_ASSERT(fy < -1.0);
    CHECK_NEAR(measured(&other, "about") - measured(&about, "about"), x * fy - y * fx, 1e-9);
}

/* vx, vy and spin of a grain after its oblique impact on a wall. */
static void hit(const char *laws, const char *grains, const char *wall, const char *later, double v[3])
{
    RUN_TRIAL(
        t,
        check_text("gravity = (0.0, 0.0); rotation = true; %s\n"
                   "walls = ( { name = `w`; point = (0.0, 0.0); direction = (0.0, 1.0); %s } );\n"
                   "phases = ( { name = `near`; steps = 1; }, { name = `hit`; %s steps = 6000; } );\n"
                   "measure = ( { name = `a`; of = `vx`; }, { name = `b`; of = `vy`; }, { name = `c`; of "
                   "= `spin`; } );\n",
                   check_changed(laws, "X", grains), wall, later),
        9999, "ok");
    memcpy(v, exp_values(t.run), 3 * sizeof *v);
}

/* A wall's own restitution, or own gamma_n, acts in all that follows from it as where the grains have the
 * same, given at the start or in a phase. What the grains are given in numbers the wall takes. */
static void test_own_damping(void)
{
#define IN_CGS "dt = 2e-7; particles = ( { x = 0.0; y = 0.1003; r = 0.1; vx = 3.42; vy = -9.4; } );\n"
    static const struct {
        const char *laws, *key, *grains, *wall;
    } list[] = {
        {IN_CGS "material = { E = 1e8; nu = 0.3; mu = 0.5; X };", "restitution", "0.7", "0.5"},
        {"units = `si`; dt = 1e-6; particles = ( { x = 0.0; y = 1.003e-3; r = 1e-3; vx = 0.34; vy = -0.94; } "
         ");\n"
         "material = { E = 1e7; nu = 0.3; mu = 0.5; X }; rolling = { mu = 0.1; };",
         "restitution", "0.8", "0.4"},
        {IN_CGS "normal = { law = `linear`; k_n = 1e6; X }; tangential = { law = `spring`; mu = 0.5; };",
         "restitution", "0.9", "0.2"},
        {IN_CGS "normal = { law = `linear`; k_n = 1e6; X }; tangential = { law = `slip_roll`; mu = 0.5; }; "
                "rolling = { mu = 0.1; };",
         "restitution", "0.9", "0.2"},
        {IN_CGS
         "normal = { X restitution_speed = 9.0; }; tangential = { law = `spring`; mu = 0.5; }; rolling = "
         "{ mu = 0.1; };",
         "restitution", "0.8", "0.3"},
        {IN_CGS "normal = { X }; tangential = { law = `spring`; mu = 0.5; }; rolling = { mu = 0.1; };",
         "gamma_n", "500.0", "9000.0"},
        {IN_CGS "normal = { law = `tsuji`; X }; tangential = { law = `mindlin`; k_s = 1e6; mu = 0.5; };",
         "gamma_n", "0.1", "0.9"},
        {IN_CGS "normal = { law = `tsuji`; X }; tangential = { law = `mindlin`; k_s = 1e6; mu = 0.5; };",
         "restitution", "0.9", "0.4"}};
    for (size_t k = 0; k < sizeof list / sizeof *list; k++) {
        double v[3], as[3];
        scoped char *grains = strdup(check_text("%s = %s;", list[k].key, list[k].grains)),
                    *wall = strdup(check_text("%s = %s;", list[k].key, list[k].wall)),
                    *phase = strdup(check_text("walls = { w = { %s }; };", wall)),
                    *given = strdup(check_changed(list[k].laws, "mu = 0.5;", "mu = 0.5; gamma_s = 3.0;"));
        hit(list[k].laws, wall, "", "", as);
        hit(list[k].laws, wall, wall, "", v);
        CU_ASSERT(memcmp(v, as, sizeof v) == 0);
        hit(list[k].laws, grains, wall, "", v);
        CHECK_PAIRS(0.0, {v[0], as[0]}, {v[1], as[1]}, {v[2], as[2]});
        hit(list[k].laws, grains, "", phase, v);
        CHECK_PAIRS(0.0, {v[0], as[0]}, {v[1], as[1]}, {v[2], as[2]});
        hit(list[k].laws, grains, "", "", v);
        CU_ASSERT(v[0] != as[0] && v[1] != as[1] && v[2] != as[2]);
        if (strstr(given, "material")) continue;
        hit(given, grains, wall, "", v);
        hit(given, grains, check_text("%s gamma_s = 3.0;", wall), "", as);
        CU_ASSERT(memcmp(v, as, sizeof v) == 0);
        hit(list[k].laws, grains, wall, "", as);
        CU_ASSERT(memcmp(v, as, sizeof v) != 0);
    }
}

/* A wall is at its middle wherever its pivot is and however it is cut; one without an end at its point. Its
 * pivot (1, 1) moves to (2, 3), and it makes a quarter turn. One that is lifted is shorter, one that is gone
 * nowhere. */
static void test_places_of_walls(void)
{
    static const struct {
        const char *sides;
        double x, y; /* at the start */
    } walls[] = {{"point = (3.0, 5.0); direction = (0.0, -1.0); extent = (-1.0, 2.0);", 2.5, 5.0},
                 {"polygon = ((2.0, 5.0), (2.0, 9.0)); closed = false;", 2.0, 7.0},
                 {"polygon = ((0.0, 0.0), (1.0, 0.0), (4.0, 0.0), (4.0, 4.0)); closed = false;", 3.0, 1.0},
                 {"polygon = ((0.0, 0.0), (4.0, 0.0)); closed = false; }, { name = `w`; pivot = (1.0, 1.0);\n"
                  "polygon = ((4.0, 0.0), (4.0, 4.0)); closed = false;",
                  3.0, 1.0},
                 {"polygon = ((4.0, 0.0), (4.0, 3.0), (0.0, 0.0));", 2.5, 1.0},
                 {"circle = (7.0, 8.0, 1.5); sides = 5;", 7.0, 8.0},
                 {"point = (3.0, 5.0); direction = (0.6, -0.8);", 3.0, 5.0},
                 {"point = (3.0, 5.0); direction = (0.0, -1.0); extent = (`-inf`, 2.0);", 3.0, 5.0}};
    static const char text[] =
        "dt = 1.0e-3; gravity = (0.0, 0.0); normal = { k_n = 1.0; };\n"
        "particles = ( { x = -50.0; y = -40.0; r = 0.1; fixed = true; } );\n"
        "walls = ( { name = `w`; pivot = (1.0, 1.0); %s } );\n"
        "phases = ( { name = `see`; steps = 1; }, { name = `go`; %s time = 1.0; }, { name = `end`; open = "
        "`w`; steps = 1; } );\n"
        "measure = ( { name = `x0`; of = `w.x`; at = `see`; }, { name = `y0`; of = `w.y`; at = `see`; },\n"
        "  { name = `x1`; of = `w.x`; at = `go`; }, { name = `y1`; of = `w.y`; at = `go`; },\n"
        "  { name = `x2`; of = `w.x`; }, { name = `y2`; of = `w.y`; } );\n";
    for (size_t k = 0; k < sizeof walls / sizeof *walls; k++) {
        const double x = walls[k].x, y = walls[k].y;
        RUN_TRIAL(
            t,
            check_text(text, walls[k].sides, "walls = { w = { velocity = (1.0, 2.0); omega = `pi/2`; }; };"),
            999, "no_number");
        CHECK_EACH(measured(&t, NAME), 1e-9, {"x0", x}, {"y0", y}, {"x1", 3.0 - y}, {"y1", 2.0 + x});
    }
    RUN_TRIAL(lifted, check_text(text, check_text("%s open_speed = 1.0;", walls[1].sides), "open = `w`;"),
              999, "ok");
    CHECK_EACH(measured(&lifted, NAME), 1.1e-3, {"y0", 7.0}, {"x1", 2.0}, {"y1", 7.5}); /* of a step */
}

/* Gravity is at t that of t, for each integrator; a step has it at its middle, so that the way errs by the
 * second order. One that turns has after n steps turned n times, the first before the first step. */
static void test_gravity_of_time(void)
{
    static const char *const integrators[] = {"verlet", "gear5", "implicit"};
    const double w = 30.0, G = 100.0, T = 0.1;
    for (int k = 0; k < 3; k++) {
        double error[2];
        for (int fine = 0; fine < 2; fine++) {
            scoped_trial t;
            double g[2], at = 0.0;
            start(&t,
                  check_text("dt = %g; gravity = (1.0, 1.0); integrator = `%s`; normal = { law = `linear`; "
                             "k_n = 1e3; };\n"
                             "particles = ( { x = 0.0; y = 0.0; r = 0.1; m = 1.0; } );\n"
                             "phases = ( { name = `sway`; gravity = (`100*sin(30*t)`, `-100*cos(30*t)`); "
                             "time = 0.1; } );\n"
                             "measure = ( { name = `xs`; of = `x`; }, { name = `vs`; of = `vx`; } );\n",
                             fine ? 5e-4 : 1e-3, integrators[k]));
            while (!exp_done(t.run)) {
                CHECK_OK(exp_advance(t.run, 1));
                dem_gravity(exp_sim(t.run), g);
                at = dem_time(exp_sim(t.run));
                const dem_state s = grains_state_of_one(exp_sim(t.run));
                CHECK_PAIRS(1e-9, {g[0], G * sin(w * at)}, {g[1], -G * cos(w * at)}, {s.fx, g[0]},
                            {s.fy, g[1]});
            }
            CHECK_NEAR(at, T, 1e-12);
            error[fine] = measured(&t, "xs") - (G / w * T - G / (w * w) * sin(w * T));
            CHECK_NEAR(measured(&t, "vs"), G / w * (1.0 - cos(w * T)), 1e-3 * G / w); /* (w dt)^2/24 */
        }
        CHECK_NEAR(error[0] / error[1], 4.0, 0.1);
    }
    dem_grain grain = {.r = 0.1, .m = 1.0};
    dem_definition def = grains_of(1, &grain);
    const double turn = 0.01, dt = def.dt;
    def.turn_per_step = turn;
    scoped_sim *sim = grains_after(&def, 1);
    double g[2];
    dem_gravity(sim, g);
    CHECK_PAIRS(1e-9, {g[0], 981.0 * sin(turn)}, {g[1], -981.0 * cos(turn)});
    CHECK_NEAR(grains_state_of_one(sim).x, dt * dt * g[0], 1e-9 * dt * dt * g[0]);
}

/* A grain on a plate that rises, stands, turns about its middle and stands again. */
static void test_walls(void)
{
    RUN_TRIAL(t, lift, 321, "ok");
    CHECK_NEAR(measured(&t, "torque"), -0.01 * 1000.0 * 0.5, 1e-3); /* the weight at its arm */
    CHECK_NEAR(measured(&t, "vy_"), 2.0, 0.2);
    CHECK_EACH(measured(&t, NAME), 0.0, {"wall_vy", 2.0}, {"px", 0.0});
    CHECK_EACH(measured(&t, NAME), 1e-12, {"p1", 0.5}, {"turned", 0.2}, {"py", 0.5}); /* 2500 steps */
    CHECK_NEAR(measured(&t, "y1") - measured(&t, "y0"), 0.5, 1e-5);
    /* the grain lies on the plate, which is inclined by 0.2 now, and friction holds it */
    const double x = measured(&t, "x2"), y = measured(&t, "y2") - 0.5;
    CHECK_NEAR(y * cos(0.2) - x * sin(0.2), 0.1, 1e-3);
    CHECK_NEAR(x * cos(0.2) + y * sin(0.2), 0.5, 2e-2);
    CHECK_NEAR(measured(&t, "f"), -0.01 * 1000.0, 0.05);
    /* a grain that rolls hands the floor its resistance, mu r F_n, which turns against its push */
    static const char rolls[] =
        "dt = 1.0e-5; gravity = (0.0, 0.0); rotation = true; rolling = { model = `constant`; mu = 0.2; };\n"
        "tangential = { law = `spring`; mu = 0.5; gamma_s = 0.0; };\n"
        "walls = ( { name = `floor`; point = (0.0, 0.0); direction = (0.0, 1.0); } );\n"
        "particles = ( { x = 1.0; y = 0.09; r = 0.1; m = 0.01; omega = 10.0; } );\n"
        "phases = ( { name = `look`; steps = 1; } );\n"
        "measure = ( { name = `arm`; of = `floor.torque/floor.fy`; } );\n";
    RUN_TRIAL(rolling, rolls, 1, "ok");
    CHECK_NEAR(measured(&rolling, "arm"), 1.0 - 0.2 * 0.1, 1e-9);
}

/* On a plate that moves as A sin(w t) a grain lifts off where A w^2 > g, at sin(w t) = g/(A w^2). */
static void test_vibrated(void)
{
    for (int strong = 0; strong < 2; strong++) {
        scoped_trial t;
        start(&t,
              check_text(
                  "dt = 1.0e-5; gravity = (0.0, -981.0); let = { f = 10.0; gamma = %s; w = `2*pi*f`; A = "
                  "`gamma*g/w^2`; };\n"
                  "walls = ( { name = `plate`; polygon = ((-1.0, 0.0), (1.0, 0.0)); closed = false; } );\n"
                  "particles = ( { x = 0.0; y = 0.0999; r = 0.1; m = 0.004; } );\n"
                  "phases = ( { name = `lie`; steps = 5000; },\n"
                  "  { name = `shake`; walls = { plate = { velocity = (0.0, `A*w*sin(w*t)`); }; }; time = "
                  "`0.5/f`; every = 5; } );\n"
                  "measure = ( { name = `flies`; of = `t`; during = `shake`; take = `first`; when = "
                  "`contacts == 0`; optional = true; },\n"
                  "  { name = `top`; of = `plate.y`; during = `shake`; take = `max`; },\n"
                  "  { name = `end`; of = `plate.y`; },\n"
                  "  { name = `fastest`; of = `plate.vy`; during = `shake`; take = `max`; } );\n",
                  strong ? "2.0" : "0.8"));
        CHECK_OK(exp_check(t.plan));
        finish(&t, 777);
        const double w = 2.0 * M_PI * 10.0, A = (strong ? 2.0 : 0.8) * 981.0 / (w * w);
        CHECK_EACH(measured(&t, NAME), 1e-5, {"top", 2.0 * A}, {"end", 2.0 * A});
        CHECK_NEAR(measured(&t, "fastest"), A * w, 1e-4 * A * w);
        CU_ASSERT(strong || isnan(measured(&t, "flies")));
        if (strong)
            CHECK_NEAR(measured(&t, "flies"), acos(-0.5) / w, 1e-3); /* contacts open in their own time */
    }
}

/* A heap of columns: two slopes, one apex, a grain that flies above `to` over the left flank, one run out. */
static void test_modules(void)
{
    char text[16384];
    size_t n = 0;
    n += (size_t)snprintf(text, sizeof text,
                          "dt = 1.0e-5; gravity = (0.0, 0.0); regions = { all = { x = (-2.0, 4.2); y = (0.0, "
                          "9.0); }; right_side = { x = (0.0, 4.0); }; wide = { x = (-2.0, 6.0); }; };\n"
                          "particles = (");
    /* columns of width 0.2: heights 2 - 0.4 |x| to the right, 2 - 0.8 |x| to the left */
    for (int k = -9; k <= 19; k++) {
        const double x = 0.2 * k, top = k < 0 ? 2.0 + 0.8 * x : 2.0 - 0.4 * x;
        n += (size_t)snprintf(text + n, sizeof text - n, "%s { x = %.6f; y = %.6f; r = 0.1; }",
                              k > -9 ? "," : "", x + 0.1, top - 0.1);
    }
    snprintf(text + n, sizeof text - n,
             ", { x = -0.5; y = 1.8; r = 0.1; }, { x = 4.7; y = 0.9; r = 0.1; }, { x = 9.0; y = 0.1; r = "
             "0.1; }, { x = 9.19; y = 0.1; r = 0.1; } );\n"
             "phases = ( { name = `look`; steps = 0; } );\n"
             "measure = ( { name = `heap`; of = `flanks`; in = `all`; touching = false; },\n"
             "  { name = `gap`; of = `flanks`; in = `wide`; touching = false; }, { name = `d_`; of = "
             "`deposit`; },\n"
             "  { name = `s`; of = `slope`; in = `right_side`; height = `top`; },\n"
             "  { name = `two`; of = `slope.r2_deg`; in = `right_side`; height = `top`; },\n"
             "  { name = `mirrored`; of = `slope.r1_deg`; in = `right_side`; falls = `left`; } );\n");
    RUN_TRIAL(t, text, 100, "ok");
    const double right = atan(0.4) * 180.0 / M_PI, left = atan(0.8) * 180.0 / M_PI;
    CHECK_EACH(measured(&t, NAME), 1e-6, {"heap_right_deg", right}, {"heap_left_deg", left},
               {"heap_mean_deg", 0.5 * (right + left)}, {"heap_height", 2.0}, {"heap_width", 29 * 0.2},
               {"heap_right_error_deg", 0.0}, {"s_r2_deg", right}, {"s_r1_deg", right}, {"mirrored", -right});
    CHECK_NEAR(measured(&t, "gap_right_deg"), measured(&t, "heap_right_deg"),
               1e-9); /* beyond an empty column */
    CHECK_NEAR(measured(&t, "heap_apex"), 0.1, 0.02);
    /* the two that overlap by a hundredth are the only ones that touch */
    CHECK_EACH(measured(&t, NAME), 0.0, {"two", measured(&t, "s_r2_deg")}, {"s_cells", 20.0},
               {"d__grains", 2.0});
    CHECK_EACH(measured(&t, NAME), 1e-9, {"d__left", 8.9}, {"d__right", 9.29}, {"d__height", 0.2});
    /* columns of 1.6, 1.5, 0.9 and 0.5 beside one of 2: a slope of 1.95, and squares of 0.047 beside it */
    n = (size_t)snprintf(text, sizeof text, "dt = 1.0e-5; gravity = (0.0, 0.0);\nparticles = (");
    for (int k = -4; k <= 4; k++) {
        static const double top[] = {2.0, 1.6, 1.5, 0.9, 0.5};
        n += (size_t)snprintf(text + n, sizeof text - n, "%s { x = %.6f; y = %.6f; r = 0.1; }",
                              k > -4 ? "," : "", 0.2 * k + 0.1, top[abs(k)] - 0.1);
    }
    snprintf(text + n, sizeof text - n,
             " );\nphases = ( { name = `look`; steps = 0; } );\n"
             "measure = ( { name = `f`; of = `flanks`; touching = false; } );\n");
    RUN_TRIAL(few, text, 100, "ok");
    const double error = sqrt(0.047 / 2.0 / 0.2) / (1.0 + 1.95 * 1.95) * 180.0 / M_PI;
    CHECK_EACH(measured(&few, NAME), 1e-6, {"f_right_deg", atan(1.95) * 180.0 / M_PI},
               {"f_right_error_deg", error}, {"f_left_error_deg", error});
}

/* Flanks of a lattice, 60 degrees, with a grain above and one that has run out; of all grains, others. */
static void test_flanks_of_touching(void)
{
    char text[8192];
    size_t n = (size_t)snprintf(text, sizeof text, "dt = 1.0e-5; gravity = (0.0, 0.0);\nparticles = (");
    for (int j = 0; j < 9; j++)
        for (int k = 0; k < 9 - j; k++)
            n += (size_t)snprintf(text + n, sizeof text - n, "%s { x = %.6f; y = %.6f; r = 0.1; }",
                                  j + k ? "," : "", 0.1999 * (k + 0.5 * j), 0.1 + 0.1999 * sqrt(0.75) * j);
    snprintf(text + n, sizeof text - n,
             ", { x = 0.5; y = 2.6; r = 0.1; }, { x = 3.0; y = 0.1; r = 0.1; } );\n"
             "phases = ( { name = `look`; steps = 0; } );\n"
             "measure = ( { name = `heap`; of = `flanks`; },\n"
             "  { name = `any`; of = `flanks`; touching = false; optional = true; } );\n");
    RUN_TRIAL(t, text, 100, "ok");
    CHECK_EACH(measured(&t, NAME), 1.0, {"heap_left_deg", 60.0}, {"heap_right_deg", 60.0});
    CHECK_NEAR(measured(&t, "heap_height"), 0.2 + 8.0 * 0.1999 * sqrt(0.75), 1e-6);
    CU_ASSERT(!(fabs(measured(&t, "any_left_deg") - 60.0) < 5.0));
}

/* A saw of known teeth, by a drop and by events; levelling off; a time step by its limit. */
static void test_avalanches(void)
{
    static const char text[] =
        "dt = `min(1e-4, 0.9*dt_limit(20))`; gravity = (0.0, 0.0); particles = ( { x = 0.0; y = 0.0; r = "
        "0.1; } );\n"
        "phases = ( { name = `saw`; steps = 10000; every = 10; } );\n"
        "measure = ( { name = `fall`; of = `3*(phase_step/995 - floor(phase_step/995))`; during = `saw`; "
        "take = `avalanches`; drop = 1.0; },\n"
        "  { name = `shock`; of = `floor(phase_step/995)`; during = `saw`; take = `avalanches`; event = "
        "`change(floor(phase_step/995)) > 0`; },\n"
        "  { name = `level`; of = `max(1, 5 - phase_step/500)`; during = `saw`; skip = `level`; series = "
        "true; },\n"
        "  { name = `none`; of = `1`; during = `saw`; take = `avalanches`; drop = 1.0; optional = true; } "
        ");\n";
    RUN_TRIAL(t, text, 1 << 20, "ok");
    CU_ASSERT(measured(&t, "fall_n") == 10.0 && measured(&t, "shock_n") == 10.0 &&
              measured(&t, "none_n") == 0.0);
    CHECK_EACH(measured(&t, NAME), 0.05, {"fall_before", 3.0}, {"fall_after", 0.0});
    CU_ASSERT(measured(&t, "fall_before_se") < 0.01);
    CHECK_EACH(measured(&t, NAME), 1e-12, {"shock_before", 4.5}, {"shock_after", 5.5},
               {"shock_after_se", sqrt(82.5 / 9.0 / 10.0)});
    CHECK_NEAR(measured(&t, "level"), 1.0, 0.01);
    /* the limit is that of a check with the same fall */
    static const char *const factors[] = {"0.999", "1.001"};
    for (int k = 0; k < 2; k++) {
        scoped_trial f;
        CHECK_OK(read_text(
            &f, check_text("dt = `%s*dt_limit(sqrt(2*g*(1 - 0)))`; fill = { N = 3; W = 2.0; H = 1.0; };\n"
                           "walls = ( { point = (0.0, 0.0); direction = (0.0, 1.0); } );\n"
                           "phases = ( { name = `a`; steps = 1; } );\n",
                           factors[k])));
        CU_ASSERT(exp_check(f.plan) == (k ? RP_BAD_INPUT : RP_OK));
    }
}

/* dt_limit of a radius is that of a text with grains of it, and without one that of the smallest grains. */
static void test_limits_of_radii(void)
{
#define GRAIN(r) "{ x = 0.0; y = 0.0; r = " r "; }"
#define FILL(r)                                                                                              \
    "{ N = 2; W = 9.0; H = 9.0; radius_mean = " r                                                            \
    "; radius_width = 0.0; radius_min = 0.01; radius_max = 0.2; }"
    static const char *const of[][2] = {{"", "particles = ( " GRAIN("0.04") " );"},
                                        {", 0.04", "particles = ( " GRAIN("0.1") " );"},
                                        {"", "particles = ( " GRAIN("0.1") ", " GRAIN("0.04") " );"},
                                        {"", "fill = ( " FILL("0.1") ", " FILL("0.04") " );"},
                                        {"", "fill = " FILL("0.1") "; particles = ( " GRAIN("0.04") " );"}};
    double dt[sizeof of / sizeof *of];
    for (size_t k = 0; k < sizeof of / sizeof *of; k++) {
        scoped_trial t;
        CHECK_OK(read_text(&t, check_text("dt = `0.5*dt_limit(20%s)`; gravity = (0.0, 0.0); %s\n"
                                          "phases = ( { name = `a`; steps = 1; } );\n",
                                          of[k][0], of[k][1])));
        dt[k] = exp_scene(t.plan)->def.dt;
        CHECK_NEAR(dt[k], dt[0], 0.0);
    }
}

/* Windows of modules at equality: a column that begins at `from`, or ends at `to`, counts; so does a height
 * that is just that share of the heap's. */
static void test_windows_of_modules(void)
{
    enum { COLUMNS = 100, BESIDE = 7 };
    static const double tops[BESIDE] = {1.0, 0.9375, 0.875, 0.75, 0.5, 0.375, 0.25};
    CHECK_WRITTEN(
        text, to,
        fputs("dt = 1e-9; gravity = (0.0, 0.0); regions = { bed = { x = (0.0, 20.0); }; heap = { x = (30.0, "
              "40.0); }; };\nparticles = ( ",
              to);
        for (int k = 0; k < COLUMNS; k++)
            fprintf(to, "{ x = %g; y = %.17g; r = 0.1; }, ", 0.2 * k + 0.1, 0.1 + 1e-3 * k * k);
        for (int k = 1 - BESIDE; k < BESIDE; k++)
            fprintf(to, "%s{ x = %g; y = %.17g; r = 0.1; }", k > 1 - BESIDE ? ", " : "", 35.0 + 0.2 * k,
                    tops[abs(k)] - 0.1);
        fputs(
            " );\nphases = ( { name = `look`; steps = 0; } );\nmeasure = ( { name = `s`; of = `slope`; in = "
            "`bed`; from = 0.07; to = 0.29; },\n  { name = `f`; of = `flanks`; in = `heap`; from = 0.5; "
            "to = 0.875; touching = false; } );\n",
            to));
    RUN_TRIAL(t, text, 100, "ok");
    CHECK_NEAR(measured(&t, "s_r1_deg"), atan(1e-3 * (7.0 * 7.0 - 28.0 * 28.0) / (21.0 * 0.2)) * 180.0 / M_PI,
               1e-9);
    /* heights 0.875, 0.75 and 0.5 in three columns */
    CHECK_EACH(measured(&t, NAME), 1e-9, {"f_left_deg", atan(0.375 / 0.4) * 180.0 / M_PI},
               {"f_right_deg", atan(0.375 / 0.4) * 180.0 / M_PI});
}

/* dt_limit means the same at walls, as stiff as they are and however they move, and in a well: the limit of
 * grains that come at this speed. */
static void test_limits_at_walls(void)
{
    static const char *const walls[] = {
        "walls = ( { point = (0.0, -1.0); direction = (0.0, 1.0); k_n = 1e8; } );",
        "walls = ( { point = (0.0, -1.0); direction = (0.0, 1.0); gamma_n = 1e5; } );",
        "walls = ( { name = `lid`; polygon = ( (-1.0, -1.0), (1.0, -1.0) ); closed = false; velocity = (0.0, "
        "%s); } );",
        "walls = ( { point = (0.0, -1.0); direction = (0.0, 1.0); } ); tangential = { law = `slip_roll`; };"
        "ground = { wall = 1; mu_static = 0.9; a = 1e-5; };"};
    for (size_t k = 0; k < sizeof walls / sizeof *walls; k++)
        for (int above = 0; above < 2; above++) {
            scoped_trial t;
            CHECK_OK(
                read_text(&t, check_text("dt = `%s*dt_limit(80)`; gravity = (0.0, 0.0); particles = ( { x "
                                         "= 0.0; y = 0.0; r = 0.1; vx = %s; } );\n%s\n"
                                         "phases = ( { name = `a`; steps = 1; } );\n",
                                         above ? "1.0001" : "0.9999", k == 2 ? "0.0" : "40.0",
                                         check_text(walls[k], "40.0"))));
            CU_ASSERT(exp_check(t.plan) == (above ? RP_BAD_INPUT : RP_OK));
        }
}

/* A refusal prints the least limit of all phases, rounded down: typed in, it is taken. */
static void test_printed_limits(void)
{
    static const double speeds[] = {3.0, 130.0, 777.0, 2345.0, 40000.0};
    for (size_t k = 0; k < sizeof speeds / sizeof *speeds; k++)
        for (int later = 0; later < 2; later++) {
            const char *dt = "1e-3";
            for (int typed = 0; typed < 2; typed++) {
                scoped_trial t;
                CHECK_OK(read_text(
                    &t,
                    check_text(
                        "dt = %s; gravity = (0.0, %s); particles = ( { x = 0.0; y = 0.0; r = 0.1; } "
                        ");\n walls = ( { name = `plate`; polygon = ( (-1.0, 2.0), (-1.0, -2.0) ); closed = "
                        "false; } );\n phases = ( { name = `a`; steps = 1; walls = { plate = { velocity = "
                        "(1.0, 0.0); }; }; }, { name = `b`; steps = 1; %s } );\n",
                        dt, later ? "-1.0" : "0.0",
                        check_text(later ? "gravity = (0.0, -%g);"
                                         : "walls = { plate = { velocity = (%g, 0.0); }; };",
                                   speeds[k] * (later ? speeds[k] : 1.0)))));
                if (typed) {
                    CHECK_OK(exp_check(t.plan));
                    break;
                }
                CHECK_FAILS(exp_check(t.plan), RP_BAD_INPUT, "phase b: ");
                const char *limit = strstr(rp_message(), later ? "limit is " : "dt <= ");
                CU_ASSERT_PTR_NOT_NULL_FATAL(limit);
                dt = check_text("%.*s", (int)strcspn(limit + (later ? 9 : 6), " ,"), limit + (later ? 9 : 6));
            }
        }
}

/* The base of a pile on grains that never move; names with an own beginning; a flank ends at a gap. */
static void test_more_modules(void)
{
    static const char text[] =
        "dt = 1.0e-5; normal = { gamma_n = 0.0; }; gravity = (0.0, 0.0); particles = ( { x = 0.0; y = 0.0; r "
        "= 0.1; fixed = true; }, { x = 0.3; y = 0.0; r = 0.1; fixed = true; },\n"
        "  { x = 0.0; y = 0.1999; r = 0.1; }, { x = 0.3; y = 0.1998; r = 0.1; }, { x = 0.6; y = 0.0999; r = "
        "0.1; } );\n"
        "walls = ( { name = `floor`; point = (0.0, 0.0); direction = (0.0, 1.0); } );\n"
        "phases = ( { name = `look`; steps = 0; } );\n"
        "measure = ( { name = `a`; of = `base`; wall = `floor`; prefix = ``; fixed = true; },\n"
        "  { name = `b`; of = `base`; wall = `floor`; prefix = `alone`; optional = true; } );\n";
    RUN_TRIAL(t, text, 100, "ok");
    const double k = 1e6, one = k * pow(1e-4, 1.5), two = k * pow(2e-4, 1.5), wall = 2.0 * k * pow(1e-4, 1.5);
    CHECK_NEAR(measured(&t, "load"), one + two + wall, 1e-6);
    CHECK_NEAR(measured(&t, "centroid"), (0.3 * two + 0.6 * wall) / (one + two + wall), 1e-9);
    CU_ASSERT(isnan(measured(&t, "alone_load"))); /* one grain is no base */
    static const char level[] = "{ name = `floor`; point = (0.0, 0.0); direction = (0.0, 1.0); }",
                      tilted[] = "{ point = (0.0, -9.0); direction = (0.0, 1.0); }, { name = `floor`; point "
                                 "= (0.0, 0.0); direction = (0.1, 1.0); }";
    RUN_TRIAL(leans, check_changed(text, level, tilted), 100, "no_pile");
    CU_ASSERT(strstr(exp_ended(leans.run)->message, "the wall is not level") != NULL);
    static const char pulls[] = /* two that part fast, two that press; places are those of a box that turns */
        "dt = 1e-8; gravity = (0.0, 0.0); tangential = { law = `spring`; mu = 0.5; };\n"
        "walls = ( { name = `floor`; point = (0.0, 0.0); direction = (0.0, 1.0); } );\n"
        "regions = { all = { x = (-9.0, 0.0); }; };\n"
        "particles = ( { x = 1.0; y = 1.0; r = 0.1; vx = -50.0; }, { x = 1.199; y = 1.0; r = 0.1; vx = 50.0; "
        "},\n"
        "  { x = 3.0; y = 1.0; r = 0.1; }, { x = 3.19; y = 1.0; r = 0.1; } );\n"
        "phases = ( { name = `turn`; box_turn_deg_per_step = 1.0; steps = 100; } );\n"
        "measure = ( { name = `l`; of = `limit`; in = `all`; wall = `floor`; },\n"
        "  { name = `f`; of = `fabric`; about = 1.0; apart = 1.0; } );\n";
    RUN_TRIAL(p, pulls, 100, "ok");
    CHECK_EACH(measured(&p, NAME), 0.0, {"l_all", 0.5}, {"l_force", 0.0}, {"f_contacts", 2.0});
}

/* The mean grain: of those that are listed some give their mass; a table says the same. */
static void test_mean_grain(void)
{
    static const char listed[] =
        "particles = ( { x = 0.0; y = 1.0; r = 0.1; m = 0.5; }, { x = 1.0; y = 1.0; r = 0.3; } );",
                      rest[] =
                          "let = { D = `d`; }; dt = 5e-5; phases = ( { name = `a`; steps = 1; } );\n"
                          "measure = ( { name = `M`; of = `m`; }, { name = `all`; of = `mass/grains`; } );\n";
    write_text("g.tsv", "x y r m\n0 1 0.1 0.5\n1 1 0.3 0.2\n");
    for (int table = 0; table < 2; table++) {
        RUN_TRIAL(t, check_text("%s %s", table ? "particles_file = `g.tsv`;" : listed, rest), 100, "ok");
        CHECK_NEAR(measured(&t, "M"), measured(&t, "all"), 1e-12);
    }
}

static void test_refused_more(void)
{
    static const trial_change cases[] = {
        {lift, "plate = { velocity = (0.0, `v`); };", "plat = { omega = 1.0; };",
         "plat: no wall has this name (did you mean \"plate\"?)"},
        {lift, "plate = { velocity = (0.0, `v`); };", "plate = { };",
         "plate: velocity, omega, load_x, load_y or coefficients expected"},
        {lift, "plate = { velocity = (0.0, `v`); };", "plate = { speed = 3.0; };",
         "speed: needs load_x or load_y"},
        {lift, "(0.0, `v`)", "(`v`)", "velocity: (a, b) expected"},
        {lift, "walls = { plate = { omega = 0.0; }; }; steps", "box_turn_deg_per_step = 0.001; steps",
         "phase stop: wall plate moves, not in a box that turns"},
        {lift, "walls = { plate = { velocity = (0.0, 0.0); }; }; steps",
         "box_turn_deg_per_step = 0.001; steps", "phase wait: wall plate moves, not in a box that turns"},
        {lift, "velocity = (0.0, `v`); }; };", "velocity = (0.0, `v`); load_y = 1.0; speed = 1.0; }; };",
         "plate: velocity along y, where a load moves it; load_y = \"none\" ends that"},
        {lift, "omega = 0.0; }; }; steps = 3000; }",
         "omega = 0.0; }; }; box_turn_deg_per_step = 0.001; steps = 9; }, { name = `soft`; dt = 1e-5; steps "
         "= 9; }",
         "phase soft: laws, dt and grains stay in a box that turns"},
        {lift, "tangential = { law = `spring`; mu = 0.5; };\nphases = ( { name = `lie`;",
         "normal = { tension = false; }; hard = { restitution = 0.5; }; phases = ( { name = `lie`; walls = { "
         "plate = { load_y = 1.0; speed = 1.0; }; };",
         "plate: a load: hard collisions do not push walls"},
        {hopper, "polygon = ( ( `1 - D/4`, 0.0 ), ( `1 + D/4`, 0.0 ) ); closed = false;",
         "point = (0.0, 0.0); direction = (0.0, 1.0); open_speed = 20.0;",
         "open = \"gate\": open_speed = 20: must be at least 0, and a wall that opens slowly needs a lower "
         "end"},
        {lift, "of = `y`; at = `lie`", "of = `slope`; at = `lie`", "measure y0: in: missing"},
        {lift, "of = `y`; at = `lie`", "of = `flanks.r3`; at = `lie`",
         "of = \"flanks.r3\": flanks has no such number"},
        {lift, "of = `y`; at = `lie`", "of = `flanks`; in = `here`", "in = \"here\": no such region"},
        {lift, "of = `y`; at = `lie`", "of = `flanks`; during = `lie`",
         "samples are of one number, as in of = \"flanks.left_deg\""},
        {lift, "of = `y`; at = `lie`", "of = `flanks`; from = 0.9; to = 0.2", "flanks: from is not below to"},
        {lift, "of = `y`; at = `lie`", "of = `flanks.left_degree`; at = `lie`",
         "flanks has no such number (did you mean \"left_deg\"?)"},
        {lift, "of = `y`; at = `lie`", "of = `y`; in = `here`", "in: of a module"},
        {lift, "of = `y`; at = `lie`", "of = `flank`; at = `lie`",
         "of \"flank\": unknown name (did you mean \"flanks\"?)"},
        {lift, "of = `y`; at = `lie`", "of = `y`; during = `wait`; every = 100000",
         "measure y0: no samples: phase wait has 3000 steps; one is"},
        {lift, "of = `y`; at = `lie`", "of = `y`; during = `tilt`; every = 20001",
         "measure y0: no samples: phase tilt has 20000 steps; one is"},
        {lift, "of = `y`; at = `lie`", "of = `y`; during = `up`; every = 1000000000",
         "measure y0: no samples: phase up has"},
        {lift, "name = `x2`; of = `x`", "name = `m`; of = `x`; }, { name = `top`; of = `2*m`",
         "measure m: m already stands for something in every expression (the mass of the mean grain)"},
        {lift, "of = `y`; at = `lie`", "of = `y`; unit = `m`", "unit = m: the file's units are cgs; cm"},
        {lift, "v = 2.0", "v = { value = 2.0; range = `[3, 1]`; }",
         "let.v: range = \"[3, 1]\": [a, b] from the lower"},
        {lift, "v = 2.0", "v = { value = 2.0; range = `1 to 3`; }",
         "let.v: range = \"1 to 3\": [a, b] from the lower"},
        {lift, "v = 2.0", "v = { value = 2.0; unit = `m/s`; }",
         "let.v: unit = m/s: the file's units are cgs; cm/s"},
        {lift, "v = 2.0", "v = { value = 2.0; unit = `mm/s`; }",
         "let.v: unit = mm/s: the file's units are cgs; cm, g, s, dyn, erg"},
        {lift, "v = 2.0", "v = { value = 2.0; unit = `J`; }",
         "let.v: unit = J: the file's units are cgs; erg"},
        {lift, "v = 2.0", "v = { value = 2.0; unit = `1/min`; }",
         "let.v: unit = 1/min: the file's units are cgs"},
        {lift, "name = `x2`; of = `x`", "name = `x`; of = `x`; }, { name = `top`; of = `x`",
         "x is an observable and an earlier measure; give the measure another name"},
        {lift, "name = `x2`; of = `x`; }, { name = `y2`; of = `y`",
         "name = `x2`; of = `x`; }, { name = `y2`; of = `2*x2`; at = `wait`", "x2 is measured after this"},
        {lift, "of = `y`; at = `lie`", "of = `change(y)`", "change and held need samples"},
        {lift, "of = `y`; at = `lie`", "of = `moved(-1, 0)`", "moved(-1): a distance of 0 or more expected"},
        {lift, "phases =", "steps = 7; phases =", "steps: an experiment ends with its last phase"},
        {lift, "phases =", "regions = { up = { y = (5.0, 0.0); }; }; phases =",
         "up: y = (5, 0): from the lower end to the upper"},
        {lift, "phases =", "regions = { up = { circle = (0.0, 5.0, 0.0); }; }; phases =",
         "up: the radius is not positive"},
        {lift, "phases =",
         "regions = { up = { polygon = ( (0.0, 0.0), (1.0, 1.0), (1.0, 0.0), (0.0, 1.0) ); }; }; phases =",
         "up: two sides of the polygon cross"},
        {lift, "measure = ( {",
         "regions = { up = { y = (0.0, 5.0); }; }; measure = ( { name = `s`; of = `up.sxx`; }, {",
         "up.sxx: over the area of a region, whose x and y have two ends"},
        {lift, "measure = ( {",
         "regions = { up = { x = (0.0, `inf`); y = (`t`, 5.0); }; }; measure = ( { name = `s`; of = "
         "`up.sxx`; }, {",
         "up.sxx: over the area of a region, whose x and y have two ends"},
        {lift, "measure = ( {",
         "regions = { up = { circle = (0.0, 5.0, 1.0); }; }; measure = ( { name = `s`; of = `profile`; in = "
         "`up`; }, {",
         "in = \"up\": of profile, a region of x and y expected"},
        {lift, "measure = ( {",
         "regions = { up = { polygon = ( (0.0, 0.0), (1.0, 0.0), (0.0, 1.0) ); }; }; measure = ( { name = "
         "`s`; of = `motion`; in = `up`; }, {",
         "in = \"up\": of motion, a region of x and y expected"},
        {lift, "measure = ( {",
         "regions = { up = { y = (0.0, 5.0); }; }; measure = ( { name = `s`; of = `slope`; in = `up`; }, {",
         "in = \"up\": of slope, a region with two ends in x expected"},
        {hopper, "name = `packed`; of = `bulk.fraction`; at = `fill`",
         "name = `above`; of = `y/rate`; during = `flow`",
         "rate is known at the end of flow, after these samples"},
        {hopper, "of = `y`; during = `flow`", "of = `y - depth`; during = `fill`",
         "depth is known at the end of fill, after these samples"},
        {lift, "of = `y`; at = `lie`", "of = `y`; during = `lie`; take = `avalanches`",
         "avalanches are found by drop, or by event"},
        {"dt = 6.2e-5; particles = ( { x = 0.0; y = 0.0; r = 0.1; } ); walls = ( { circle = (0.0, 0.0, 4.0); "
         "sides = 9; } );\n"
         "phases = ( { name = `turn`; box_turn_deg_per_step = 0.01; steps = 1; } );\n",
         "0.01", "0.8", "phase turn: dt = 6.2e-05: too large"},
        {lift, "v = 2.0", "v = 900.0", "phase up: wall plate needs dt <= "},
        {lift, "every = 10;", "gravity = (0.0, `-1e9*t`); every = 10;",
         "phase up: wall plate needs dt <= 3.21e-05"},
        {lift, "`v`", "`2000*cos(t)`", "phase up: wall plate needs dt <= "}};
    check_refused(sizeof cases / sizeof *cases, cases);
    static const trial_change ends[] = {
        /* known to the run alone */
        {lift, "`v`", "`v*(1e5 + y)`", "too_fast"},
        {"walls = ( { point = (0.0, 0.0); direction = (0.0, 1.0); }, { name = `belt`; polygon = ((-1.0, "
         "0.0), (1.0, "
         "0.0)); closed = false; } ); particles = ( { x = 0.5; y = 0.1; r = 0.1; } );\n"
         "phases = ( { name = `a`; steps = 9; walls = { belt = { velocity = (1.0, 1.0); }; }; } );\n",
         "(1.0, 1.0)", "(1.0, 0.0)", "too_fast"},
        {"dt = 6e-5; walls = ( { point = (0.0, 0.0); direction = (0.0, 1.0); }, { name = `lid`; polygon = "
         "((-1.0, 0.5), (-2.0, 0.5)); closed = false; } );\n"
         "particles = ( { x = 0.0; y = 0.1; r = 0.1; } ); phases = ( { name = `come`; add = { r = 0.1; x = "
         "3.0; y = 900.0; }; steps = 1; },\n"
         "  { name = `move`; steps = 9; walls = { lid = { velocity = (`-400 - 0*y`, 0.0); }; }; } );\n",
         "0.5)", "0.5)", "ok"},
        {lift, "`v`", "`sqrt(-y) > 1 ? 1 : v`", "no_number"},
        {lift, "every = 10;", "x_max = -9.0; every = 10;", "outside"},
        {lift, "measure = ( {",
         "regions = { up = { x = (0.0, `1 - step`); }; }; measure = ( { name = `s`; of = `up.x`; }, {",
         "no_region"}};
    check_ends(sizeof ends / sizeof *ends, ends);
}

/* Much of what phases can do, for a while. */
static const char acting[] =
    "dt = 5e-5; seed = 2; let = { n = 3; }; tangential = { law = `spring`; mu = 0.4; };\n"
    "walls = ( { name = `base`; point = (0.0, 0.0); direction = (0.0, 1.0); },\n"
    "  { name = `lid`; point = (0.0, 5.0); direction = (0.0, -1.0); } );\n"
    "fill = ( { kind = `a`; N = 20; W = 2.0; H = 3.0; radius_law = `lognormal`; by = `mass`; },\n"
    "  { kind = `b`; pattern = `row`; W = 2.0; x0 = 3.0; } );\n"
    "regions = { part = { polygon = ( (0.0, 0.0), (2.0, 0.0), (1.0, `lid.y`) ); }; };\n"
    "output = { states = 100; contacts = 0; };\n"
    "phases = ( { name = `fall`; steps = 200; damp = true; every = 20; },\n"
    "  { name = `press`; walls = { lid = { load_y = `-10*lid.y`; speed = 50.0; mu = 0.1; }; }; steps = 100; "
    "},\n"
    "  { name = `feed`; repeat = `n`; phases = ( { name = `drop`; mark = true;\n"
    "      add = { N = 1; kind = `c`; r = 0.1; x = (2.2, 2.8); y = `touch + r`; vy = `-y`; };\n"
    "      every = 10; most = 100; go_on = true; until = `touched`; } ); },\n"
    "  { name = `again`; from = `fall`; tangential = { mu = 0.2; }; dt = 2e-5; remove = `part`; steps = 50; "
    "} );\n"
    "measure = ( { name = `s`; of = `part.syy + c.y + sliding`; at = `feed`; optional = true; },\n"
    "  { name = `order`; of = `order`; at = `fall`; },\n"
    "  { name = `load`; of = `base`; wall = `base`; at = `press`; optional = true; } );\n";

/* A thousand texts with parts exchanged, doubled or left out: refused with a message, or run to a word. */
static void test_random_texts(void)
{
    static const char *const texts[] = {hopper, lift, fall, acting};
    static const char *const parts[] = {"0.0",  "-1",  "1e300", "`inf`",  "`0/0`",  "`grains`",
                                        "true", "( )", "{ }",   "`rest`", "1e-300", "`1/(grains - 60)`"};
    unsigned random = 1993;
    const int n = check_fast() ? 150 : 1000;
    for (int k = 0; k < n; k++) {
        char text[8192], mutated[8192];
        strcpy(text, texts[k % 4]);
        for (int change = 0; change < 1 + k % 3; change++) {
            /* from one sign to another */
            const size_t length = strlen(text);
            random = random * 1664525u + 1013904223u;
            size_t from = (random >> 8) % length;
            while (from < length && !strchr("=;,({ ", text[from])) from++;
            const size_t to =
                from + 1 + strcspn(text + from + 1 < text + length ? text + from + 1 : "", ";,)} ");
            random = random * 1664525u + 1013904223u;
            const char *part = parts[(random >> 8) % (sizeof parts / sizeof *parts)];
            snprintf(mutated, sizeof mutated, "%.*s %s %s", (int)(from < length ? from + 1 : length), text,
                     (random >> 20) % 4 ? part : "", to < length ? text + to : "");
            if (strlen(mutated) < 6000) strcpy(text, mutated);
        }
        scoped_trial t;
        rp_status status = read_text(&t, text);
        if (!status) status = exp_check(t.plan);
        if (!status && exp_scene(t.plan)->fills && exp_scene(t.plan)->fills->N > 100) continue;
        if (!status) status = exp_start(t.plan, 1, 2, &t.run);
        for (int part = 0; !status && part < 100 && !exp_done(t.run); part++) status = exp_advance(t.run, 50);
        CHECK_OR_SAY(status ? status == RP_BAD_INPUT && strstr(rp_message(), "e.cfg")
                            : !exp_done(t.run) || *exp_ended(t.run)->status,
                     "status %d, %s\n"
                     "%s",
                     status, rp_message(), text);
    }
}

CHECK_SUITE_WITHIN(experiment, "experiment", enter, leave, test_closed_forms, test_windows,
                   test_rest_by_gravity, test_looks_at_rest, test_phases, test_known_so_far,
                   test_line_of_correlated, test_line_without_error, test_shares, test_one_without_value,
                   test_forces, test_surface_and_motion, test_walls, test_turned_walls, test_own_damping,
                   test_places_of_walls, test_gravity_of_time, test_vibrated, test_modules,
                   test_flanks_of_touching, test_avalanches, test_limits_of_radii, test_limits_at_walls,
                   test_printed_limits, test_windows_of_modules, test_more_modules, test_mean_grain,
                   test_refused_more, test_cuts, test_where, test_started_at, test_words, test_refused,
                   test_keys, test_random_texts, test_run, test_swept, test_other_measures,
                   test_sweeps_refused, test_slow_turns, test_computed_again)
