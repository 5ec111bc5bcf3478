/* What phases do: loads on walls, laws that change, grains that come and go, going back, tables. */
#include "grains.h"
#include "trial.h"

/* ---- loads ---- */

/* A lid of mass M = 10 m that a load has made fast meets a free grain: an elastic collision of two bodies. */
static const char lid[] =
    "dt = 1.0e-5; gravity = (0.0, 0.0);\n"
    "normal = { law = `linear`; k_n = 1.0e4; gamma_n = 0.0; };\n"
    "walls = ( { name = `lid`; point = (0.0, 0.21); direction = (0.0, -1.0); k_n = 1.0e4; } );\n"
    "particles = ( { x = 0.0; y = 0.1; r = 0.1; m = 0.01; }, { x = 9.0; y = -7.0; r = 0.1; m = 0.01; } );\n"
    "phases = ( { name = `near`; walls = { lid = { load_y = -10.0; speed = 100.0; }; }; every = 1; until = "
    "`lid.fy > 0`; },\n"
    "  { name = `touch`; walls = { lid = { load_y = 0.0; speed = 100.0; }; }; every = 1; until = `lid.fy == "
    "0`; } );\n"
    "regions = { left = { x = (-1.0, 1.0); }; };\n"
    "measure = ( { name = `v0`; of = `lid.vy`; at = `near`; }, { name = `last`; of = `t`; at = `touch`; },\n"
    "  { name = `deep`; of = `lid.fy`; during = `touch`; take = `max`; }, { name = `v1`; of = `lid.vy`; },\n"
    "  { name = `u1`; of = `left.vy`; } );\n";

static void test_oscillator(void)
{
    RUN_TRIAL(t, lid, 1000, "ok");
    const double m = 0.01, M = 0.1, w = sqrt(1e4 * (m + M) / (m * M)), v0 = measured(&t, "v0"), dt = 1e-5;
    CHECK_NEAR(v0, -sqrt(2.0 * 10.0 / M * 0.01), 3e-3); /* over the way to it */
    CHECK_NEAR(measured(&t, "last"), M_PI / w, 2.0 * dt);
    CHECK_NEAR(measured(&t, "deep"), 1e4 * -v0 / w, 2e-3 * 1e4 * -v0 / w);
    CHECK_EACH(measured(&t, NAME), 2e-3 * -v0, {"v1", (M - m) / (M + m) * v0},
               {"u1", 2.0 * M / (M + m) * v0});
    CHECK_NEAR(M * measured(&t, "v1") + m * measured(&t, "u1"), M * v0, 1e-3 * M * -v0);
}

/* A lid of a load on grains in a box: the floor carries their weight and the load, at rest. */
static void test_column(void)
{
    static const char text[] =
        "dt = 2.0e-5; let = { W = 2.0; load = 3.0e3; };\n"
        "walls = ( { name = `box`; polygon = ((0.0, 9.0), (0.0, 0.0), (`W`, 0.0), (`W`, 9.0)); closed = "
        "false; },\n"
        "  { name = `lid`; point = (0.0, 6.0); direction = (0.0, -1.0); } );\n"
        "fill = { N = 60; W = `W`; H = 4.0; };\n"
        "regions = { all = { polygon = ( (0.0, 0.0), (`W`, 0.0), (`W`, `lid.y`), (0.0, `lid.y`) ); }; };\n"
        "phases = ( { name = `fill`; least = 5000; until = `rest`; },\n"
        "  { name = `press`; walls = { lid = { load_y = `-load`; speed = 30.0; }; }; least = 5000; until = "
        "`rest`; },\n"
        "  { name = `free`; walls = { lid = { load_y = `none`; }; }; steps = 100; } );\n"
        "measure = ( { name = `top`; of = `lid.fy/load`; at = `press`; },\n"
        "  { name = `floor`; of = `-box.fy/(load + mass*g)`; at = `press`; },\n"
        "  { name = `sides`; of = `box.fx/load`; at = `press`; },\n"
        "  { name = `mean`; of = `all.syy*W/load`; at = `press`; },\n"
        "  { name = `area`; of = `all.fraction*W*lid.y`; at = `press`; },\n"
        "  { name = `symmetric`; of = `all.sxy/all.syy`; at = `press`; },\n"
        "  { name = `still`; of = `lid.vy`; at = `free`; } );\n";
    RUN_TRIAL(t, text, 1000, "ok");
    CHECK_EACH(measured(&t, NAME), 2e-3, {"top", 1.0}, {"floor", 1.0}, {"sides", 0.0});
    /* between the load at the top and with the weight at the floor */
    CU_ASSERT(measured(&t, "mean") > 0.9 && measured(&t, "mean") < 1.15);
    CU_ASSERT(fabs(measured(&t, "symmetric")) < 0.3 && measured(&t, "still") == 0.0);
    const dem_sim *sim = exp_sim(t.run);
    scoped dem_state *states = malloc(dem_count(sim) * sizeof *states);
    double area = 0.0;
    CHECK_OK(dem_states(sim, states));
    for (size_t i = 0; i < dem_count(sim); i++) area += M_PI * states[i].r * states[i].r;
    const double beyond =
        area - measured(&t, "area"); /* what walls and lid overlap, 0.1 radii deep at most */
    CU_ASSERT(beyond > 0.0 && beyond < 0.01 * area);
}

/* Where none is, a grain has the restitution of the text, by its own mass. */
static void test_first(void)
{
    RUN_TRIAL(t,
              "dt = 5e-6; gravity = (0.0, 0.0); normal = { law = `linear`; k_n = 1e5; restitution = 0.5; };\n"
              "walls = ( { point = (0.0, 0.0); direction = (0.0, 1.0); } ); phases = ( { name = `a`;\n"
              "steps = 3000; add = { r = 0.1; density = 2.5; x = 0.0; y = 0.2; vy = -20.0; }; } );\n"
              "measure = ( { name = `v`; of = `vy`; } );\n",
              1000, "ok");
    CHECK_NEAR(measured(&t, "v"), 10.0, 0.1); /* gamma_n dt/2 is 0.01 */
}

/* ---- laws ---- */

static bool is_left(const void *none, uint32_t id, double x, double y)
{
    (void)none, (void)id, (void)y;
    return x < 0.5;
}

/* A pile at rest goes on by other laws: what is the same changes nothing but round-off, springs and ids stay;
 * energy and ledger agree. */
static void test_laws_change(void)
{
    static const char scene[] =
        "dt = 5e-5; rotation = true; ledger = true; tangential = { law = \"spring\"; mu = 0.4; };\n"
        "walls = ( { point = (0.0, 0.0); direction = (0.0, 1.0); }, { point = (0.0, 0.0); direction = (1.0, "
        "0.0); }, { point = (2.0, 0.0); direction = (-1.0, 0.0); open_at_step = 12000; } );\n"
        "y_min = -1.0; x_max = 3.0; fill = { N = 60; W = 2.0; H = 4.0; };\n";
    scoped_scene s;
    scoped_sim *a = grains_scene_after(scene, 14000, &s), *b = NULL; /* the wall is gone, grains run out */
    CHECK_OK(dem_clone(a, &b));
    CHECK_OK(dem_change(&b, &s.def));
    CU_ASSERT(dem_step(a) == dem_step(b) && dem_count(a) == dem_count(b));
    CHECK_NEAR(dem_time(b), dem_time(a), 1e-12);
    size_t n[2];
    dem_contact *c[2] = {grains_contacts(a, &n[0]), grains_contacts(b, &n[1])};
    CU_ASSERT(n[0] == n[1] && n[0] > 40);
    for (size_t k = 0, i; k < n[0]; k++) {
        for (i = 0; i < n[1]; i++)
            if (c[0][k].wall == c[1][i].wall && c[0][k].id_a + c[0][k].id_b == c[1][i].id_a + c[1][i].id_b &&
                (c[0][k].id_a == c[1][i].id_a || c[0][k].id_a == c[1][i].id_b))
                break;
        CU_ASSERT_FATAL(i < n[1]);
        /* one that slides is cut to Coulomb's limit again, now by the velocities of the full step */
        CU_ASSERT(fabs(c[0][k].shear_spring - c[1][i].shear_spring) <= 0.05 * fabs(c[0][k].shear_spring));
    }
    free(c[0]), free(c[1]);
    dem_state x[60], y[60];
    grains_run(a, 200, x);
    grains_run(b, 200, y);
    const size_t left = dem_count(a);
    CU_ASSERT_FATAL(dem_count(b) == left && left < 60);
    for (size_t i = 0; i < left; i++)
        CU_ASSERT(x[i].id == y[i].id && fabs(x[i].x - y[i].x) < 1e-4 && fabs(x[i].y - y[i].y) < 1e-4);
    /* stiffer, and a smaller step */
    dem_definition stiff = s.def;
    dem_wall walls[3];
    memcpy(walls, dem_walls_of(&s.def), sizeof walls);
    stiff.material.k_n *= 4.0, stiff.dt *= 0.5, stiff.wall_list = walls;
    for (int w = 0; w < 3; w++) walls[w].material.k_n *= 4.0;
    const double time = dem_time(b);
    CHECK_OK(dem_change(&b, &stiff));
    CHECK_OK(dem_run(b, 4000));
    CHECK_NEAR(dem_time(b), time + 4000 * 2.5e-5, 1e-9);
    const dem_ledger l = grains_ledger(b);
    CU_ASSERT(fabs(l.residual) < 1e-12 * l.turnover && l.sliding > 0.0);
    CHECK_OK(dem_remove(&b, is_left, NULL));
    const dem_ledger less = grains_ledger(b);
    CU_ASSERT(fabs(less.residual) < 1e-12 * less.turnover);
    CU_ASSERT(less.put_in == l.put_in && less.taken_out > l.taken_out);
    stiff.dt = 1.0;
    CHECK_FAILS(dem_change(&b, &stiff), RP_BAD_INPUT, "too large");
    dem_box_turn(b, 1e-5);
    CHECK_FAILS(dem_change(&b, &s.def), RP_BAD_INPUT, "a box that turns");
}

/* All stand still, and then fall as from rest. */
static void test_halt(void)
{
    static const char *const scenes[] = {"", "integrator = \"gear5\";", "rotation = true;"};
    for (size_t k = 0; k < 3; k++) {
        scoped_scene s;
        dem_state at[2], now[2];
        scoped_sim *sim = grains_scene_after(
            check_text(
                "dt = 1e-5; ledger = true; %s particles = ( { x = 0.0; y = 5.0; r = 0.1; vx = 30.0; vy = "
                "9.0; %s }, { x = 1.0; y = 5.0; r = 0.1; } );",
                scenes[k], k == 2 ? "omega = 8.0;" : ""),
            1000, &s);
        CHECK_OK(dem_halt(sim));
        CHECK_OK(dem_states(sim, at));
        CU_ASSERT(fabs(at[0].vx) < 1e-12 && fabs(at[0].vy) < 1e-12 && at[0].omega == 0.0);
        CHECK_NEAR(at[0].fy, -981.0 * at[0].m, 1e-9);
        grains_run(sim, 1000, now);
        CHECK_NEAR(now[0].x, at[0].x, 1e-12);
        CHECK_NEAR(now[0].y, at[0].y - 0.5 * 981.0 * 1e-4, 1e-10);
        const dem_ledger l = grains_ledger(sim);
        CU_ASSERT(fabs(l.residual) < 1e-12 * l.turnover && l.put_in < -100.0 * at[0].m);
    }
}

/* One in a contact stands still there: what is left is its weight and the spring. */
static void test_halt_in_contact(void)
{
    static const char text[] =
        "dt = 1e-6; normal = { law = \"linear\"; k_n = 1.0e6; gamma_n = 50.0; }; tangential = { law = "
        "\"spring\"; mu = 0.5; }; rotation = true; walls = ( { point = (0.0, 0.0); direction = (0.0, 1.0); "
        "k_n = 1.0e6; } );\n"
        "particles = ( { x = 0.0; y = 0.1; r = 0.1; m = 0.01; vx = 5.0; vy = -20.0; omega = 3.0; } );\n";
    scoped_scene s;
    scoped_sim *sim = grains_scene_after(text, 100, &s);
    CHECK_OK(dem_halt(sim));
    const dem_state now = grains_state_of_one(sim);
    const dem_contact c = grains_only_contact(sim);
    CU_ASSERT(c.overlap > 1e-3 && fabs(c.shear_force) > 1.0);
    CHECK_NEAR(now.fy, 1e6 * c.overlap - 981.0 * 0.01, 1e-6);
    CHECK_NEAR(fabs(now.fx), fabs(c.shear_force), 1e-5);
}

/* mu that changes in a phase: a grain on an incline stays, then slides with g (sin - mu cos). */
static const char incline[] =
    "dt = 1e-5; let = { a = `30*deg`; mu = 0.7; later = 0.2; };\n"
    "tangential = { law = `spring`; mu = `mu`; k_s = 1e6; gamma_s = 0.0; };\n"
    "gravity = (`1000*sin(a)`, `-1000*cos(a)`);\n"
    "walls = ( { point = (-9.0, 0.0); direction = (1.0, 0.0); }, { name = `floor`; point = (0.0, 0.0); "
    "direction = (0.0, 1.0); } );\n"
    "particles = ( { x = 0.0; y = 0.1; r = 0.1; m = 0.01; } );\n"
    "phases = ( { name = `stay`; steps = 20000; }, { name = `slide`; tangential = { mu = `later`; }; steps = "
    "10000; },\n"
    "  { name = `again`; dt = 5e-6; walls = { floor = { mu = 0.0; }; }; time = 0.1; } );\n"
    "measure = ( { name = `v0`; of = `vx`; at = `stay`; }, { name = `no`; of = `sliding`; at = `stay`; },\n"
    "  { name = `v1`; of = `vx`; at = `slide`; }, { name = `yes`; of = `sliding`; at = `slide`; },\n"
    "  { name = `v2`; of = `vx`; at = `again`; }, { name = `T`; of = `time`; },\n"
    "  { name = `smooth`; of = `sliding`; at = `again`; } );\n";

static void test_friction_changes(void)
{
    RUN_TRIAL(t, incline, 777, "ok");
    CU_ASSERT(fabs(measured(&t, "v0")) < 0.1 && measured(&t, "no") == 0.0 && measured(&t, "yes") == 1.0);
    CHECK_NEAR(measured(&t, "smooth"), 0.0, 0.0);
    CHECK_NEAR(measured(&t, "v1"), 0.1 * (500.0 - 200.0 * sqrt(3.0) / 2.0), 0.2);
    CHECK_NEAR(measured(&t, "v2") - measured(&t, "v1"), 50.0, 0.01);
    CHECK_NEAR(measured(&t, "T"), 0.4, 1e-9);
}

/* ---- grains that come and go ---- */

static const char rain[] =
    "dt = 5e-5; seed = 11; tangential = { law = `spring`; mu = 0.5; }; let = { n = 6; };\n"
    "walls = ( { name = `floor`; point = (0.0, 0.0); direction = (0.0, 1.0); } );\n"
    "regions = { right = { polygon = ( (0.0, -1.0), (9.0, -1.0), (9.0, 9.0), (0.0, 9.0) ); }; };\n"
    "phases = (\n"
    "  { name = `first`; add = { kind = `stone`; r = 0.3; density = 2.0; x = 0.5; y = `touch`; gap = 0.0; }; "
    "steps = 1; },\n"
    "  { name = `rain`; repeat = `n`; phases = ( { name = `drop`; mark = true; every = 10;\n"
    "      add = { N = 2; kind = `drop`; x = (-1.0, 1.0); y = `touch + 0.2`; vy = `-sqrt(2*g*0.1)`; };\n"
    "      until = `touched and held(speed < 1, 5)`; } ); },\n"
    "  { name = `cloud`; add = { N = 20; kind = `drop`; x = (-1.5, 1.5); y = (-1.0, 4.0); }; steps = 1; },\n"
    "  { name = `b`; repeat = 2; phases = ( { name = `p`; steps = 1; } ); }, { name = `q`; mark = true; "
    "steps = 1; },\n"
    "  { name = `clear`; remove = `right`; steps = 1; } );\n"
    "measure = ( { name = `y1`; of = `stone.y`; at = `first`; },\n"
    "  { name = `m1`; of = `stone.mass`; at = `first`; },\n"
    "  { name = `n1`; of = `drop.grains`; at = `rain`; },\n"
    "  { name = `moved`; of = `moved(0.1)`; at = `drop`; take = `max`; },\n"
    "  { name = `added1`; of = `added`; at = `rain`; }, { name = `x`; of = `drop.x`; at = `rain`; },\n"
    "  { name = `n2`; of = `grains`; at = `cloud`; },\n"
    "  { name = `lost`; of = `right.grains`; at = `cloud`; },\n"
    "  { name = `n3`; of = `grains`; at = `clear`; }, { name = `gone`; of = `out`; at = `clear`; },\n"
    "  { name = `lost_mass`; of = `right.whole_mass`; at = `cloud`; }, { name = `weighed`; of = "
    "`out_mass/lost_mass`; at = `clear`; },\n"
    "  { name = `own`; of = `stone.energy/(0.5*stone.mass*(stone.vx^2 + stone.vy^2))`; at = `rain`; },\n"
    "  { name = `stones`; of = `stone.grains`; } );\n";

static void test_added(void)
{
    scoped_trial t;
    start(&t, rain);
    CU_ASSERT(exp_sim(t.run) && dem_count(exp_sim(t.run)) == 0);
    finish(&t, 1000);
    CU_ASSERT_STRING_EQUAL(exp_ended(t.run)->status, "ok");
    CU_ASSERT(exp_phase_at(t.run, 2).inner && !exp_phase_at(t.run, 2).look); /* it takes steps */
    CHECK_NEAR(measured(&t, "y1"), 0.3, 1e-5);
    CHECK_NEAR(measured(&t, "m1"), 2.0 * 4.0 / 3.0 * M_PI * 0.027, 1e-12);
    const double lost = measured(&t, "lost");
    CHECK_EACH(measured(&t, NAME), 0.0, {"n1", 12.0}, {"added1", 13.0}, {"n2", 33.0}, {"n3", 33.0 - lost},
               {"gone", lost}, {"stones", 0.0});
    CHECK_NEAR(measured(&t, "own"), 1.0, 1e-12);
    CHECK_NEAR(measured(&t, "weighed"), 1.0, 1e-12);
    CU_ASSERT(lost > 1.0 && fabs(measured(&t, "x")) < 1.0 && measured(&t, "moved") >= 0.0);
}

/* Where a body from above is stopped: by a floor, a ledge's end, a slope, a grain, a wall beside it. */
static void test_touch(void)
{
    static const struct {
        const char *walls, *x, *status;
        double y;
    } cases[] = {
        {"{ point = (0.0, 1.0); direction = (0.0, 1.0); }", "7.0", "ok", 1.1},
        {"{ point = (0.0, 0.0); direction = (0.6, 0.8); extent = (-1.0, 1.0); }", "0.87", "ok",
         -0.5285857157145715},
        {"{ point = (0.0, 1.0); direction = (0.0, 1.0); extent = (-1.0, 1.0); }", "1.5", "no_room", 0.0},
        {"{ point = (0.0, 1.0); direction = (0.0, -1.0); extent = (-1.0, 1.0); }", "0.3", "ok", 1.1},
        {"{ point = (0.0, 0.0); direction = (0.6, 0.8); }", "1.0", "ok", (0.1 - 0.6) / 0.8},
        {"{ point = (0.0, 0.0); direction = (0.0, 1.0); }, { point = (2.0, 0.0); direction = (-1.0, 0.0); }",
         "1.95", "no_room", 0.0},
        {"{ point = (0.0, 0.0); direction = (0.0, 1.0); }, { point = (2.0, 0.0); direction = (-1.0, 0.0); }",
         "1.9", "ok", 0.1},
        {"{ point = (0.0, 0.0); direction = (0.0, 1.0); }, { point = (0.0, 0.5); direction = (1.0, 0.0); "
         "extent = (-0.5, 0.5); }",
         "0.08", "ok", 1.06}};
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        const char *text = check_text(
            "dt = 1e-6; walls = ( %s ); particles = ( { x = -3.0; y = 3.0; r = 0.1; } );\n"
            "phases = ( { name = `a`; add = { kind = `new`; r = 0.1; x = %s; y = `touch`; gap = 1e-9; "
            "}; steps = 0; } );\n"
            "measure = ( { name = `y`; of = `new.y`; } );\n",
            cases[k].walls, cases[k].x);
        RUN_TRIAL(t, text, 10, cases[k].status);
        if (strcmp(cases[k].status, "ok") == 0) CHECK_NEAR(measured(&t, "y"), cases[k].y, 1e-8);
    }
}

/* Radii of a phase: those of the fill if it names none, else its own and the defaults of a fill. */
static void test_added_radii(void)
{
    static const char *const cases[][2] = {{"", "0.2"}, {"radius_mean = 0.1; radius_width = 0.0;", "0.1"}};
    for (size_t k = 0; k < 2; k++) {
        const char *text = check_text(
            "dt = 1e-5; walls = ( { point = (0.0, 0.0); direction = (0.0, 1.0); } );\n"
            "fill = { N = 2; W = 2.0; H = 2.0; radius_law = `table`; radii = ( (0.2, 1.0) ); };\n"
            "phases = ( { name = `add`; add = { kind = `new`; x = 5.0; y = `r`; %s }; steps = 0; } );\n"
            "measure = ( { name = `at`; of = `new.y`; } );\n",
            cases[k][0]);
        RUN_TRIAL(t, text, 10, "ok");
        CHECK_NEAR(measured(&t, "at"), atof(cases[k][1]), 1e-15);
    }
}

/* ---- measures of what was put there ---- */

/* A row of touching grains on a wall, and a hexagon of lattice places that stand still above it. */
static void test_base_order(void)
{
    static const char text[] =
        "dt = 1e-5;\n"
        "walls = ( { name = `base`; point = (0.0, -3.0); direction = (0.0, 1.0); } );\n"
        "fill = ( { pattern = `row`; W = 8.0; x0 = 1.0; y0 = -3.0; radius_width = 0.0; },\n"
        "  { pattern = `lattice`; W = 0.81; H = 0.56; x0 = 20.0; y0 = 30.0; radius_width = 0.0; } );\n"
        "regions = { up = { y = (20.0, 40.0); }; low = { y = (-4.0, -2.0); };\n"
        "  one = { circle = (20.4, `30.1 + 0.1*sqrt(3)`, 0.15); }; };\n"
        "phases = ( { name = `start`; steps = 0; },\n"
        "  { name = `sink`; remove = `up`; damp = true; every = 10; until = `held(force < 1e-6*m*g, 2)`; } "
        ");\n"
        "measure = ( { name = `o`; of = `order`; in = `up`; at = `start`; },\n"
        "  { name = `i`; of = `order`; in = `one`; at = `start`; optional = true; },\n"
        "  { name = `b`; of = `base`; wall = `base`; }, { name = `weight`; of = `low.mass*g`; } );\n";
    RUN_TRIAL(t, text, 1000, "ok");
    /* the middle one of rows of 4, 3 and 4 */
    CHECK_EACH(measured(&t, NAME), 1e-12, {"o_psi6", 1.0}, {"o_packed", 1.0 / 11.0});
    /* it alone, with neighbours beside the region */
    CHECK_EACH(measured(&t, NAME), 1e-12, {"i_psi6", 1.0}, {"i_packed", 1.0});
    CHECK_NEAR(measured(&t, "b_centroid"), 5.0, 1e-6);
    CHECK_NEAR(measured(&t, "b_load"), measured(&t, "weight"), 1e-5 * measured(&t, "weight"));
    CHECK_NEAR(measured(&t, "b_width"), 39.0 * 0.2, 0.05); /* 40 grains, less 1 % at both ends */
    CHECK_NEAR(measured(&t, "b_shear"), 0.0, 1e-9);
    CHECK_EACH(measured(&t, NAME), 0.02, {"b_n_10", 1.0}, {"b_rays_10", 1.0}, {"b_dip", 0.0},
               {"b_excess", 0.0});
}

/* Contacts at 0 and 30 degrees from the vertical, the second on the left: its mirror image leans back; a
 * wall's does not count. */
static void test_fabric(void)
{
    static const char text[] =
        "dt = 1e-6; gravity = (0.0, 0.0); walls = ( { point = (0.0, 0.0); direction = (0.0, 1.0); } );\n"
        "particles = ( { x = 1.0; y = 0.099; r = 0.1; }, { x = 1.0; y = 0.298; r = 0.1; },\n"
        "  { x = -1.0; y = 0.5; r = 0.1; }, { x = `-1 + 0.198*sin(30*deg)`; y = `0.5 + 0.198*cos(30*deg)`; r "
        "= 0.1; } );\n"
        "regions = { left = { x = (-2.0, 0.0); }; none = { y = (7.0, 8.0); }; };\n"
        "phases = ( { name = `p`; steps = 0; } );\n"
        "measure = ( { name = `all`; of = `fabric`; },\n"
        "  { name = `lean`; of = `fabric.fabric_deg`; in = `left`; },\n"
        "  { name = `mirror`; of = `fabric`; about = 0.0; },\n"
        "  { name = `empty`; of = `fabric`; in = `none`; optional = true; } );\n";
    RUN_TRIAL(t, text, 10, "ok");
    /* |1 + exp(i 60 degrees)|/2 = cos 30 degrees; forces are Hertzian, of overlaps 0.001 and 0.002 */
    const double w = pow(2.0, 1.5), fx = -1.0 - w * 0.5, fy = w * sqrt(0.75);
    CHECK_EACH(measured(&t, NAME), 1e-12, {"all_contacts", 2.0}, {"all_fabric", sqrt(0.75)});
    CHECK_NEAR(measured(&t, "all_force"), hypot(fx, fy) / (1.0 + w), 1e-4); /* damped by half a step */
    CHECK_NEAR(measured(&t, "all_force_deg"), 0.5 * atan2(fy, -fx) * 180.0 / M_PI, 0.01);
    CHECK_EACH(measured(&t, NAME), 1e-10, {"all_fabric_deg", 15.0}, {"lean", 30.0},
               {"mirror_fabric_deg", -15.0});
    CU_ASSERT(isnan(measured(&t, "empty_fabric")));
}

/* ---- going back ---- */

static const char back[] =
    "dt = 5e-5; tangential = { law = `spring`; mu = 0.3; };\n"
    "walls = ( { name = `base`; point = (0.0, 0.0); direction = (0.0, 1.0); }, { point = (0.0, 0.0); "
    "direction = (1.0, 0.0); }, { name = `gate`; point = (2.0, 0.0); direction = (-1.0, 0.0); } );\n"
    "x_max = 4.0; fill = { N = 50; W = 2.0; H = 4.0; };\n"
    "phases = ( { name = `fill`; least = 3000; every = 100; until = `held(energy < 1e-2, 3)`; },\n"
    "  { name = `one`; gravity_turn_deg_per_step = 0.01; walls = { base = { mu = 0.0; }; }; open = `gate`; "
    "steps = 1500; add = { r = 0.1; x = 1.0; y = `touch + 1`; }; },\n"
    "  { name = `two`; from = `fill`; gravity_turn_deg_per_step = 0.01; walls = { base = { mu = 0.0; }; }; "
    "open = `gate`; steps = 1500; },\n"
    "  { name = `three`; from = `fill`; steps = 0; } );\n"
    "measure = ( { name = `y0`; of = `y`; at = `fill`; }, { name = `y1`; of = `y`; at = `one`; },\n"
    "  { name = `y2`; of = `y`; at = `two`; }, { name = `tilt`; of = `tilt_deg`; at = `two`; },\n"
    "  { name = `out1`; of = `out`; at = `one`; }, { name = `n1`; of = `added`; at = `one`; },\n"
    "  { name = `y3`; of = `y`; at = `three`; }, { name = `n3`; of = `added`; },\n"
    "  { name = `tilt3`; of = `tilt_deg`; }, { name = `steps`; of = `step`; },\n"
    "  { name = `grains3`; of = `grains`; } );\n";

static void test_back(void)
{
    RUN_TRIAL(t, back, 1000, "ok");
    CHECK_EACH(measured(&t, NAME), 0.0, {"y3", measured(&t, "y0")}, {"tilt3", 0.0}, {"n1", 1.0}, {"n3", 0.0},
               {"grains3", 50.0});
    CHECK_NEAR(measured(&t, "tilt"), 15.0, 1e-9);
    CU_ASSERT(measured(&t, "y2") != measured(&t, "y1") && measured(&t, "y2") != measured(&t, "y0"));
    CU_ASSERT(measured(&t, "steps") > 3000.0 + measured(&t, "y0"));
}

/* Going back takes the walls' loads back too: where a load was given or ended, and the velocity it had. */
static void test_back_to_loads(void)
{
    static const char text[] =
        "dt = 1.0e-4; gravity = (0.0, 0.0);\n"
        "walls = ( { name = `lid`; point = (0.0, 5.0); direction = (0.0, -1.0); }, { name = `side`; point = "
        "(-5.0, 0.0); direction = (1.0, 0.0); } );\n"
        "particles = ( { x = 0.0; y = 1.0; r = 0.1; m = 0.01; } );\n"
        "phases = ( { name = `free`; steps = 10; },\n"
        "  { name = `press`; walls = { lid = { load_y = -1.0; speed = 30.0; }; }; steps = 40; },\n"
        "  { name = `pull`; walls = { lid = { load_y = 3.0; speed = 30.0; }; side = { load_x = 1.0; speed = "
        "30.0; }; }; steps = 40; },\n"
        "  { name = `ended`; walls = { lid = { load_y = `none`; }; side = { load_x = `none`; }; }; steps = "
        "40; },\n"
        "  { name = `again`; from = `press`; steps = 40; },\n"
        "  { name = `whole`; from = `pull`; steps = 40; },\n"
        "  { name = `off`; from = `ended`; steps = 40; },\n"
        "  { name = `none`; from = `free`; steps = 40; } );\n"
        "measure = ( %s );\n";
    static const char *const phases[] = {"free", "press", "pull", "ended", "again", "whole", "off", "none"};
    scoped char *measures = strdup("");
    for (size_t k = 0; k < sizeof phases / sizeof *phases; k++) {
        scoped char *before = measures;
        measures =
            strdup(check_text("%s%s{ name = `y_%s`; of = `lid.vy`; at = `%s`; }, { name = `x_%s`; of = "
                              "`side.vx`; at = `%s`; }",
                              before, k ? ", " : "", phases[k], phases[k], phases[k], phases[k]));
    }
    RUN_TRIAL(t, check_text(text, measures), 1000, "ok");
    /* a load accelerates a wall by itself over ten masses: a lid that is pressed over 80 steps has twice what
     * it has after 40 */
    const double press = measured(&t, "y_press"), pull = measured(&t, "y_pull"),
                 side = measured(&t, "x_pull");
    CU_ASSERT(press < 0.0 && pull > press && side > 0.0);
    CHECK_EACH(measured(&t, NAME), 1e-9, {"y_free", 0.0}, {"y_again", 2.0 * press}, {"x_again", 0.0},
               {"y_whole", 2.0 * pull - press}, {"x_whole", 2.0 * side}, {"y_off", measured(&t, "y_ended")},
               {"x_off", measured(&t, "x_ended")}, {"y_none", 0.0}, {"x_none", 0.0});
}

/* ---- cuts, snapshots, keys ---- */

static const char *const texts[] = {lid, incline, rain, back};

static void test_cuts(void)
{
    static const long parts[] = {1, 7, 130};
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        RUN_TRIAL(whole, texts[i], 1000000, "ok");
        for (long k = 0; k < 9; k++)
            check_cut(texts[i], &whole, parts[k % 3], exp_steps(whole.run) * (k + 1) / 10, 50);
    }
}

/* What changes a run changes its key; what does not, doesn't. Suite schemas has the keys. */
static void test_keys(void)
{
    static const trial_change cases[] = {{lid, "load_y = -10.0", "load_y = -1.00e1", "same"},
                                         {rain, "name = `floor`", "name = `ground`", "another"},
                                         {rain, "} ); }, { name = `q`; mark = true; steps = 1; }",
                                          "}, { name = `q`; mark = true; steps = 1; } ); }", "another"},
                                         {back, "from = `fill`; steps", "from = `one`; steps", "another"}};
    check_keys(sizeof cases / sizeof *cases, cases);
}

static void test_refused(void)
{
    static const trial_change cases[] = {
        {lid, "speed = 100.0; ", "", "lid: load_y needs speed"},
        {lid, "speed = 100.0", "speed = 0.0", "speed = 0: out of range, allowed: (0, inf)"},
        {lid, "load_y = -10.0", "load_z = -10.0", "load_z: unknown key"},
        {lid, "load_y = -10.0", "load_y = `fast`", "unknown name fast"},
        {lid, "speed = 100.0", "speed = 9.0e4",
         "phase near: wall lid needs dt <= 1.11e-06, by a way below the smallest radius at wall"},
        {incline, "tangential = { mu = `later`; }", "tangential = { muu = 1.0; }", "muu: unknown key"},
        {incline, "tangential = { mu = `later`; }", "tangential = { law = `none`; }",
         "needs a tangential law"},
        {incline, "tangential = { mu = `later`; }", "rolling = { mu = 0.1; }", "needs rotation = true"},
        {incline, "dt = 1e-5", "dt = `dt_limit(1/0)`", "a speed and, if wanted, a radius expected"},
        {incline, "dt = 5e-6", "dt = 5e-3", "phase again: dt = 0.005: too large"},
        {incline, "floor = { mu = 0.0; }", "floor = { mu = -1.0; }", "mu = -1: out of range"},
        {incline, "floor = { mu = 0.0; }", "floor = { mu_roll = 0.1; }", "wall 2: mu_roll = 0.1"},
        {incline, "floor = { mu = 0.0; }", "flor = { mu = 0.0; }",
         "flor: no wall has this name (did you mean"},
        {rain, "r = 0.3; density = 2.0", "r = 0.01; density = 0.2", "dt = 5e-05: too large for"},
        {rain, "r = 0.3", "r = -0.3", "add.r = -0.3: out of range, allowed: (0, inf)"},
        {rain, "density = 2.0", "density = 0.0", "add.density = 0: out of range"},
        {rain, "gap = 0.0", "gap = -1.0", "add.gap = -1: out of range"},
        {rain, "N = 20", "N = -20", "add.N = -20: out of range"},
        {rain, "x = 0.5; ", "", "add: x: missing"},
        {rain, "r = 0.3", "s = 0.3", "s: unknown key"},
        {rain, "y = `touch`", "y = `tuch`", "unknown name tuch (did you mean \"touch\"?)"},
        {rain, "kind = `stone`", "kind = `floor`", "floor names a wall and a kind"},
        {rain, "kind = `stone`", "kind = 3", "kind: a name expected"},
        {rain, "remove = `right`", "remove = `rigt`", "remove = \"rigt\": no such region (did you mean"},
        {rain, "phases = (",
         "ground = { wall = 1; mu_static = 0.5; a = 0.001; }; phases = ( { name = `lift`; open = `floor`; "
         "steps = 1; },",
         "open = \"floor\": the ground can't open"},
        {rain, "(9.0, 9.0), ", "", NULL},
        {rain, "( (0.0, -1.0), (9.0, -1.0), (9.0, 9.0), (0.0, 9.0) )", "( (0.0, -1.0), (9.0, -1.0) )",
         "polygon: a list ( (x, y), ... ) of at least 3"},
        {rain, "of = `stone.y`", "of = `stone.fy`", "unknown name stone.fy"},
        {back, "from = `fill`; g", "from = `two`; g", "from = \"two\": an earlier phase"},
        {back, "from = `fill`; g", "from = `fil`; g", "from = \"fil\": no such phase (did you mean"},
        {back, "of = `y`; at = `fill`", "of = `base`; at = `fill`", "wall: missing, whose load"},
        {back, "of = `y`; at = `fill`", "of = `base`; wall = `bas`; at = `fill`",
         "wall = \"bas\": no wall has this name"},
        {back, "of = `y`; at = `fill`", "of = `y`; wall = `base`; at = `fill`", "wall: of the module base"}};
    check_refused(sizeof cases / sizeof *cases, cases);
}

/* What only the run can know. */
static void test_ends(void)
{
    static const trial_change cases[] = {
        {rain, "N = 20", "N = 2000", "no_room"},
        {rain, "N = 2; kind", "N = 2; r = `0/grains`; kind", "no_number"},
        {rain, "density = 2.0", "density = `0*grains`", "no_number"},
        {lid, "load_y = -10.0", "load_y = `-1/(grains - 2)`", "no_number"},
        {rain, "y = `touch + 0.2`", "y = `touch + 4000`", "too_fast"},
        {rain, "y = `touch + 0.2`", "y = `touch - 0.05`", "no_room"},
        {rain, "repeat = `n`", "until = `added > 4`", "ok"},
        {rain, "repeat = `n`", "repeat = 2; until = `added > 40`", "ok"},
        {rain, "repeat = `n`", "repeat = 2; status = `dry`; until = `added > 40`", "dry"},
        {incline, "later = 0.2", "later = 0.2; z = 0.0", "ok"}};
    check_ends(sizeof cases / sizeof *cases, cases);
}

/* Bins of a box, by what is put there; over samples their mean; the stress is that of the region. */
static void test_profile(void)
{
    static const char text[] =
        "dt = 1e-6; gravity = (0.0, 0.0);\n"
        "particles = ( { x = 0.5; y = 0.5; r = 0.1; vx = 1.0; }, { x = 1.5; y = 0.5; r = 0.1; vx = 3.0; },\n"
        "  { x = 0.5; y = 1.5; r = 0.1; vx = 2.0; vy = 1.0; }, { x = 1.2; y = 1.5; r = 0.1; }, { x = 1.39; y "
        "= 1.5; r = 0.1; }, { x = 7.0; y = 1.0; r = 0.1; }, { x = 7.19; y = 1.0; r = 0.1; } );\n"
        "regions = { box = { x = (0.0, 2.0); y = (0.0, 2.0); }; half = { x = (0.0, 2.0); }; };\n"
        "phases = ( { name = `p`; steps = 0; }, { name = `q`; steps = 30; } );\n"
        "measure = ( { name = `rows`; of = `profile`; bins = 2; in = `box`; at = `p`; },\n"
        "  { name = `sxx`; of = `box.sxx`; at = `p`; },\n"
        "  { name = `mean`; of = `profile`; along = `x`; bins = 4; in = `box`; during = `q`; every = 10; } "
        ");\n";
    write_trial("p.cfg", text);
    GOOD("run p.cfg -o p");
    scoped_table rows = read_table("p/profile_rows.tsv");
    scoped_table measures = read_table("p/measures.tsv");
    CU_ASSERT_FATAL(rows.n_rows == 2 && measures.n_rows == 1);
    static const double expected[2][4] = {{0.5, 2.0, 2.0, 0.0}, {1.5, 3.0, 2.0 / 3.0, 1.0 / 3.0}};
    for (size_t k = 0; k < 2; k++) {
        CHECK_NEAR(cell(&rows, k, "y"), expected[k][0], 1e-14);
        CHECK_NEAR(cell(&rows, k, "grains"), expected[k][1], 0.0);
        CHECK_EACH(cell(&rows, k, NAME), 1e-12, {"vx", expected[k][2]}, {"vy", expected[k][3]},
                   {"fraction", expected[k][1] * M_PI * 0.01 / 2.0});
    }
    CU_ASSERT(cell(&rows, 0, "sxx") == 0.0 && cell(&rows, 1, "sxx") > 10.0);
    CHECK_NEAR(0.5 * cell(&rows, 1, "sxx"), cell(&measures, 0, "value"), 1e-10);
    CHECK_NEAR(cell(&rows, 1, "syy"), 0.0, 1e-12);
    scoped_table mean = read_table("p/profile_mean.tsv");
    CU_ASSERT_FATAL(mean.n_rows == 4);
    CHECK_NEAR(cell(&mean, 1, "grains"), 2.0, 0.0); /* of both ways, x from 0.5 to 1 */
    CHECK_NEAR(cell(&mean, 2, "grains"), 2.0, 0.0);
    SHELL("grep -qx '# samples: 3' p/profile_mean.tsv");
    /* in other parts: the same bytes */
    SHELL("mkdir r && cd r && cp ../p.cfg . && cp -r ../p/. whole && $REPOSE run p.cfg -o p "
          "--every 3 >/dev/null 2>&1 && grep -v '^#' p/profile_mean.tsv >x && grep -v '^#' "
          "whole/profile_mean.tsv | cmp - x");
    SHELL("sed 's/in = \"box\"; at/in = \"half\"; at/' p.cfg >h.cfg");
    FAILS(65, "in = \"half\": of profile, a region with two ends in x and y expected", "run h.cfg");
    SHELL("sed 's/bins = 4;/bins = 4; take = \"max\";/' p.cfg >h.cfg");
    FAILS(65, "measure mean: profile has a table of means, and no series", "run h.cfg");
}

/* ---- intervals of tables, by the command ---- */

static void test_frames(void)
{
    static const char text[] =
        "dt = 5e-5; let = { v = 20.0; late = 1; };\n"
        "walls = ( { point = (0.0, 0.0); direction = (0.0, 1.0); }, { point = (0.0, 0.0); direction = (1.0, "
        "0.0); }, { point = (2.0, 0.0); direction = (-1.0, 0.0); } );\n"
        "output = { states = 700; contacts = 0; energy = 100; };\n"
        "fill = { N = 30; W = 2.0; H = 3.0; };\n"
        "phases = ( { name = `bed`; steps = 4000; },\n"
        "  { name = `hit`; add = { r = 0.1; x = 1.0; y = `touch`; vy = `-v`; }; steps = 500; } );\n"
        "measure = ( { name = `before`; of = `y`; at = `bed`; }, { name = `after`; of = `y`; } );\n";
    write_trial("k.cfg", text);
    GOOD("run k.cfg -o whole");
    SHELL("cut -f1 whole/states.tsv | grep -v '^#' | sort -nu | tr '\\n' ' ' >out");
    CU_ASSERT_STRING_EQUAL(out, "step 700 1400 2100 2800 3500 4000 4200 4500 ");
    SHELL("(grep -vc '^#' whole/energy.tsv; grep -vc '^#' whole/contacts.tsv; grep -vc '^#' "
          "whole/walls.tsv) >out");
    CU_ASSERT_STRING_EQUAL(out, "47\n1\n7\n"); /* walls at both ends */
    /* without intervals, frames at the ends of phases, also where a text goes back */
    SHELL("sed '/output =/d' k.cfg >f.cfg && $REPOSE run f.cfg -o f >notes 2>err && cut -f1 "
          "f/contacts.tsv | grep -v '^#' | sort -nu | tr '\\n' ' ' >out");
    CU_ASSERT_STRING_EQUAL(out, "step 4000 4500 ");
    SHELL("grep -qx '# phase bed: 1 pass, to step 4000, t = 0.2' notes && grep -q '^# phase hit: 1 pass, to "
          "step 4500' f/measures.tsv");
    GOOD("view f --frame bed -o bed.svg");
    FAILS(64, "--frame bet: last, all, a number or step=N expected, or a phase that has ended",
          "view f --frame bet -o b.svg");
    SHELL("sed '/name = .hit/s/add/from = \"bed\"; add/' f.cfg >g.cfg && $REPOSE run g.cfg -o g >out 2>err "
          "&& cut -f1 g/states.tsv | grep -v '^#' | sort -nu | tr '\\n' ' ' >out");
    CU_ASSERT_STRING_EQUAL(out, "step 4000 4500 ");
    GOOD("run k.cfg -o all --every 1500");
    SHELL("cut -f1 all/contacts.tsv | grep -v '^#' | sort -nu | tr '\\n' ' ' >out");
    CU_ASSERT(strstr(out, "3000 4000 4500 ") != NULL);
}

CHECK_SUITE_WITHIN(actions, "actions", enter, leave, test_oscillator, test_column, test_first,
                   test_laws_change, test_halt, test_halt_in_contact, test_friction_changes, test_added,
                   test_touch, test_added_radii, test_base_order, test_fabric, test_back, test_back_to_loads,
                   test_cuts, test_keys, test_refused, test_ends, test_frames, test_profile)
