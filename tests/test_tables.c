/* Tables that a run leaves: every column of every table against a second computation from other columns. A
 * column that no test reads fails, so that a new one needs its own check. */

#include "analytic/analytic.h"
#include "core/random.h"
#include "sweeps/protocols/protocols.h"
#include "tests/grains.h"
#include "tests/numbers.h"
#include "tests/program.h"

/* Positions up to 1 and lengths of 1e-3 have relative errors of 1e-13, forces some more. */
#define RELATIVE 1e-11

#define NEAR_RELATIVE(a, b, relative) CHECK_NEAR(a, b, (relative)*fabs(b))

/* ---- a scene of the simulator ---- */

static const struct {
    double nx, ny, k_n, k_s, k_roll, mu, mu_roll;
} coefficients[] = {{0.0, 0.0, 1.1e5, 1.3e4, 1.7e4, 5.0, 3.0}, /* between grains */
                    {0.0, 1.0, 1.6e5, 1.9e4, 2.3e4, 0.05, 3.0},
                    {0.8, 0.6, 2.1e5, 1.1e4, 2.1e4, 5.0, 0.07}};

enum { GRAINS = 5, STEPS = 80 };

static void write_scene(void)
{
    const char *walls = "";
    for (int w = 1; w < 3; w++)
        walls = check_text(
            "%s%s{ point = [0.0, 0.0]; direction = [%g, %g]; k_n = %g; k_s = %g; k_roll = %g; mu = %g;\n"
            "  mu_roll = %g; }",
            walls, w > 1 ? ", " : "", coefficients[w].nx, coefficients[w].ny, coefficients[w].k_n,
            coefficients[w].k_s, coefficients[w].k_roll, coefficients[w].mu, coefficients[w].mu_roll);
    write_text("scene.cfg",
               "dt = 1.0e-5; steps = %d; rotation = true; gravity = [40.0, -900.0];\n"
               "normal = { k_n = %g; gamma_n = 0.0; };\n"
               "tangential = { law = \"spring\"; k_s = %g; gamma_s = 0.0; mu = %g; };\n"
               "rolling = { mu = %g; k = %g; gamma = 0.0; };\nwalls = ( %s );\n"
               "particles = ( { x = 0.31; y = 0.1; r = 0.1; vx = 3.0; vy = -9.0; omega = 20.0; },\n"
               "  { x = 0.5205; y = 0.1101; r = 0.11; vx = -4.0; vy = -2.0; omega = -31.0; angle = 0.3; },\n"
               "  { x = 0.38; y = 0.2771; r = 0.09; vx = 1.0; vy = -25.0; },\n"
               "  { x = 0.01; y = 0.1201; r = 0.08; m = 0.005; vx = -11.0; vy = -7.0; omega = 12.0; },\n"
               "  { x = 0.9; y = 0.6; r = 0.07; vx = 2.0; } );\n",
               STEPS, coefficients[0].k_n, coefficients[0].k_s, coefficients[0].mu, coefficients[0].mu_roll,
               coefficients[0].k_roll, walls);
}

/* Row of a grain's state. */
static size_t row_of(long step, double id)
{
    return (size_t)step * GRAINS + (size_t)id - 1;
}

/* A contact from the states of a step: overlap, arms, direction from the second body to the first, and the
 * speeds that stretch its springs. */
typedef struct {
    double n[2], foot[2], overlap, arm[2], r_eff, v_s, v_roll;
} geometry;

static geometry contact_of(checked *s, long step, double id_a, double id_b, int wall)
{
    const size_t a = row_of(step, id_a), b = id_b > 0.0 ? row_of(step, id_b) : a;
    const double r_a = at(s, a, "r"), r_b = at(s, b, "r"), x = at(s, a, "x"), y = at(s, a, "y");
    const double spin_a = at(s, a, "omega"), spin_b = id_b > 0.0 ? at(s, b, "omega") : 0.0;
    geometry g = {.n = {coefficients[wall].nx, coefficients[wall].ny}};
    double vx = at(s, a, "vx"), vy = at(s, a, "vy");
    if (id_b > 0.0) {
        const double dx = x - at(s, b, "x"), dy = y - at(s, b, "y"), distance = hypot(dx, dy);
        g.n[0] = dx / distance, g.n[1] = dy / distance;
        g.overlap = r_a + r_b - distance;
        g.foot[0] = at(s, b, "x"), g.foot[1] = at(s, b, "y");
        g.arm[0] = r_a - 0.5 * g.overlap, g.arm[1] = r_b - 0.5 * g.overlap;
        g.r_eff = r_a * r_b / (r_a + r_b);
        vx -= at(s, b, "vx"), vy -= at(s, b, "vy");
    } else {
        const double height = x * g.n[0] + y * g.n[1];
        g.overlap = r_a - height;
        g.foot[0] = x - height * g.n[0], g.foot[1] = y - height * g.n[1];
        g.arm[0] = height;
        g.r_eff = r_a;
    }
    g.v_s = vx * g.n[1] - vy * g.n[0] + g.arm[0] * spin_a + g.arm[1] * spin_b;
    g.v_roll = g.r_eff * (spin_a - spin_b);
    return g;
}

/* Elongations of the springs by the trapezoidal rule since the contact began, cut at the limits. */
static void stretch(checked *s, double id_a, double id_b, int wall, double dt, double *shear, double *roll)
{
    *shear = *roll = 0.0;
    for (long step = 1; step <= STEPS; step++) {
        const geometry before = contact_of(s, step - 1, id_a, id_b, wall),
                       g = contact_of(s, step, id_a, id_b, wall);
        const double limit = coefficients[wall].k_n * pow(fmax(g.overlap, 0.0), 1.5);
        const double most = coefficients[wall].mu * limit / coefficients[wall].k_s,
                     most_roll = coefficients[wall].mu_roll * limit / coefficients[wall].k_roll;
        *shear = fmin(fmax(*shear + 0.5 * dt * (before.v_s + g.v_s), -most), most);
        *roll = fmin(fmax(*roll + 0.5 * dt * (before.v_roll + g.v_roll), -most_roll), most_roll);
    }
}

/* Sums over the contacts. */
typedef struct {
    double fx[GRAINS + 1], fy[GRAINS + 1], torque[GRAINS + 1], wall[3][2], elastic;
    int contacts[GRAINS + 1];
} sums;

static void check_contact(checked *c, size_t row, checked *s, double dt, sums *sum)
{
    const double id_a = at(c, row, "id_a"), id_b = at(c, row, "id_b");
    const int wall = (int)at(c, row, "wall");
    CU_ASSERT_FATAL(id_a >= 1.0 && (id_b > 0.0 ? wall == 0 && id_b <= GRAINS : wall == 1 || wall == 2));
    const geometry g = contact_of(s, STEPS, id_a, id_b, wall);
    const double normal = at(c, row, "normal_force"), shear = at(c, row, "shear_force"),
                 spring = at(c, row, "shear_spring"), torque = at(c, row, "rolling_torque"),
                 roll = at(c, row, "rolling_spring"), overlap = at(c, row, "overlap");
    const double k_n = coefficients[wall].k_n, k_s = coefficients[wall].k_s,
                 k_roll = coefficients[wall].k_roll;
    double by_steps, roll_by_steps;
    CHECK_EACH(at(c, row, NAME), 0.0, {"x", at(s, row_of(STEPS, id_a), "x")},
               {"y", at(s, row_of(STEPS, id_a), "y")});
    CHECK_EACH(at(c, row, NAME), 1e-15, {"x_b", g.foot[0]}, {"y_b", g.foot[1]});
    NEAR_RELATIVE(overlap, g.overlap, RELATIVE);
    NEAR_RELATIVE(normal, k_n * pow(g.overlap, 1.5), RELATIVE);
    CU_ASSERT(overlap > 0.0 && fabs(spring) > 0.0 && fabs(roll) > 0.0);
    NEAR_RELATIVE(shear, -k_s * spring, RELATIVE);
    NEAR_RELATIVE(torque, -k_roll * roll * g.r_eff, RELATIVE);
    stretch(s, id_a, id_b, wall, dt, &by_steps, &roll_by_steps);
    NEAR_RELATIVE(spring, by_steps, 0.02); /* first touch lies within one of some fifty steps */
    NEAR_RELATIVE(roll, roll_by_steps, 0.02);
    const double fx = normal * g.n[0] + shear * g.n[1], fy = normal * g.n[1] - shear * g.n[0];
    const int a = (int)id_a, b = (int)id_b;
    sum->fx[a] += fx, sum->fy[a] += fy, sum->torque[a] += shear * g.arm[0] + torque, sum->contacts[a]++;
    sum->fx[b] -= fx, sum->fy[b] -= fy, sum->torque[b] += shear * g.arm[1] - torque, sum->contacts[b]++;
    sum->wall[wall][0] -= fx, sum->wall[wall][1] -= fy;
    sum->elastic += 0.4 * normal * g.overlap + 0.5 * k_s * spring * spring + 0.5 * k_roll * roll * roll;
}

/* Newton's equations: forces at the end, and what the torques of the last step but one did to the spin. */
static void check_states(checked *s, const sums *sum, double dt)
{
    for (int id = 1; id <= GRAINS; id++) {
        const size_t row = row_of(STEPS, id), before = row_of(STEPS - 1, id);
        const double m = at(s, row, "m"), r = at(s, row, "r"), inertia = 0.4 * m * r * r;
        const double size = fabs(sum->fx[id]) + fabs(sum->fy[id]) + 900.0 * m;
        CHECK_EACH(at(s, row, NAME), 0.0, {"id", id}, {"step", STEPS});
        CHECK_NEAR(at(s, row, "t"), STEPS * dt, 1e-15);
        if (id != 4) NEAR_RELATIVE(m, 4.0 / 3.0 * M_PI * r * r * r, 1e-14);
        CHECK_EACH(at(s, row, NAME), RELATIVE * size, {"fx", sum->fx[id] + 40.0 * m},
                   {"fy", sum->fy[id] - 900.0 * m});
        CHECK_EACH(at(s, row, NAME), 0.0, {"contacts", sum->contacts[id]}, {"fixed", 0.0});
        /* forces change by a few percent a step */
#define RATE(name) ((at(s, row, name) - at(s, before, name)) / dt)
#define MEAN(name) (0.5 * (at(s, row, name) + at(s, before, name)))
        CHECK_PAIRS(1e-9 * size / m, {RATE("vx"), MEAN("fx") / m}, {RATE("vy"), MEAN("fy") / m});
        CHECK_NEAR(RATE("omega"), sum->torque[id] / inertia, 0.15 * fabs(sum->torque[id]) / inertia);
        CHECK_NEAR(RATE("angle"), MEAN("omega"), 0.01 * fabs(at(s, row, "omega")));
        CHECK_PAIRS(0.01 * hypot(at(s, row, "vx"), at(s, row, "vy")), {RATE("x"), MEAN("vx")},
                    {RATE("y"), MEAN("vy")});
#undef RATE
#undef MEAN
    }
}

static void check_energy(checked *e, checked *s, const sums *sum)
{
    const size_t last = e->t.n_rows - 1;
    double kinetic = 0.0, rotational = 0.0, gravity = 0.0;
    for (size_t row = row_of(STEPS, 1); row < row_of(STEPS, 1) + GRAINS; row++) {
        const double m = at(s, row, "m"), r = at(s, row, "r");
        kinetic += 0.5 * m * (pow(at(s, row, "vx"), 2.0) + pow(at(s, row, "vy"), 2.0));
        rotational += 0.5 * 0.4 * m * r * r * pow(at(s, row, "omega"), 2.0);
        gravity += m * (900.0 * at(s, row, "y") - 40.0 * at(s, row, "x"));
    }
    CHECK_EACH(at(e, last, NAME), 0.0, {"step", STEPS}, {"t", at(s, row_of(STEPS, 1), "t")},
               {"grains", GRAINS});
    NEAR_RELATIVE(at(e, last, "kinetic"), kinetic, RELATIVE);
    NEAR_RELATIVE(at(e, last, "rotational"), rotational, RELATIVE);
    NEAR_RELATIVE(at(e, last, "kinetic_per_grain"), (kinetic + rotational) / GRAINS, RELATIVE);
    NEAR_RELATIVE(at(e, last, "gravity"), gravity, RELATIVE);
    NEAR_RELATIVE(at(e, last, "elastic"), sum->elastic, RELATIVE);
}

/* Each frame has the contacts that its states count, at the centres that they have. */
static void check_frames(checked *c, checked *s)
{
    int count[(STEPS + 1) * GRAINS] = {0};
    for (size_t row = 0; row < c->t.n_rows; row++) {
        const long step = lround(at(c, row, "step"));
        CU_ASSERT_FATAL(step >= 0 && step <= STEPS);
        const size_t a = row_of(step, at(c, row, "id_a"));
        CHECK_EACH(at(c, row, NAME), 0.0, {"t", at(s, a, "t")}, {"x", at(s, a, "x")}, {"y", at(s, a, "y")});
        count[a]++;
        if (at(c, row, "id_b") > 0.0) count[row_of(step, at(c, row, "id_b"))]++;
    }
    for (size_t row = 0; row < s->t.n_rows; row++) CHECK_NEAR(at(s, row, "contacts"), count[row], 0.0);
}

static void test_scene(void)
{
    const double dt = 1e-5;
    sums sum = {0};
    write_scene();
    GOOD("run scene.cfg --every 1 -o d");
    scoped_checked s = checked_read("d/states.tsv"), c = checked_read("d/contacts.tsv"),
                   w = checked_read("d/walls.tsv"), e = checked_read("d/energy.tsv");
    CU_ASSERT_FATAL(s.t.n_rows == (STEPS + 1) * GRAINS);
    check_frames(&c, &s);
    const size_t end = c.t.n_rows - 5; /* 1-2, 1-3, and three with walls */
    CU_ASSERT(at(&c, end, "step") == STEPS && at(&c, end - 1, "step") == STEPS - 1);
    for (size_t row = end; row < c.t.n_rows; row++) check_contact(&c, row, &s, dt, &sum);
    check_states(&s, &sum, dt);
    check_energy(&e, &s, &sum);
    CU_ASSERT(w.t.n_rows == 2 * (STEPS + 1));
    for (size_t row = 0; row < w.t.n_rows; row++) {
        const int wall = 1 + (int)(row % 2);
        CHECK_NEAR(at(&w, row, "step"), (double)(row / 2), 0.0);
        CHECK_NEAR(at(&w, row, "t"), (double)(row / 2) * dt, 1e-15);
        CHECK_EACH(at(&w, row, NAME), 0.0, {"wall", wall}, {"x", 0.0}, {"y", 0.0},
                   {"direction_x", coefficients[wall].nx}, {"direction_y", coefficients[wall].ny});
        CU_ASSERT(at(&w, row, "from") == -INFINITY && at(&w, row, "to") == INFINITY);
        if (row / 2 < STEPS) continue;
        NEAR_RELATIVE(at(&w, row, "fx"), sum.wall[wall][0], RELATIVE);
        NEAR_RELATIVE(at(&w, row, "fy"), sum.wall[wall][1], RELATIVE);
    }
}

/* Walls where they are in each frame: one rises at 20 cm/s from step 40, one vanishes at step 60, and all
 * turn with the box. An open wall ends where it begins. */
static void test_walls(void)
{
    const double dt = 5e-5, turn = 0.01 * M_PI / 180.0;
    write_text(
        "scene.cfg",
        "dt = 5.0e-5; steps = 100; box_turn_deg_per_step = 0.01;\n"
        "walls = ( { point = [3.0, 0.5]; direction = [-1.0, 0.0]; extent = [-0.5, 9.0]; open_at_step = 40; "
        "open_speed = 20.0; },\n"
        "  { point = [0.0, 0.0]; direction = [0.6, 0.8]; extent = [-2.0, 2.5]; open_at_step = 60; } );\n"
        "particles = ( { x = 0.0; y = 5.0; r = 0.1; } );\n");
    GOOD("run scene.cfg --every 20 -o d");
    scoped_table w = read_table("d/walls.tsv");
    CU_ASSERT_FATAL(w.n_rows == 12);
    for (size_t row = 0; row < w.n_rows; row++) {
        const double step = 20.0 * (double)(row / 2), c = cos(turn * step), s = sin(turn * step);
        const bool first = row % 2 == 0, vanished = !first && step >= 60.0;
        const double px = first ? 3.0 : 0.0, py = first ? 0.5 : 0.0, nx = first ? -1.0 : 0.6,
                     ny = first ? 0.0 : 0.8;
        CHECK_NEAR(cell(&w, row, "step"), step, 0.0);
        CHECK_EACH(cell(&w, row, NAME), 1e-13, {"x", c * px + s * py}, {"y", c * py - s * px},
                   {"direction_x", c * nx + s * ny}, {"direction_y", c * ny - s * nx});
        CHECK_NEAR(cell(&w, row, "from"),
                   first ? -0.5 + 20.0 * dt * fmax(step - 40.0, 0.0) : (vanished ? 2.5 : -2.0), 1e-13);
        CHECK_NEAR(cell(&w, row, "to"), first ? 9.0 : 2.5, 0.0);
    }
}

/* Units stand above the names, 1 where there is none. */
static void test_units(void)
{
    static const struct {
        const char *table, *units;
    } lists[] = {{"d/states.tsv", "1\ts\t1\tcm\tcm\trad\tcm/s\tcm/s\trad/s\tdyn\tdyn\tcm\tg\t1\t1"},
                 {"d/contacts.tsv", "1\ts\t1\t1\t1\tcm\tcm\tcm\tcm\tcm\tdyn\tdyn\tcm\tdyn cm\tcm"},
                 {"d/walls.tsv", "1\ts\t1\tcm\tcm\t1\t1\tcm\tcm\tdyn\tdyn"},
                 {"d/energy.tsv", "1\ts\t1\terg\terg\terg\terg\terg"}};
    write_scene();
    GOOD("run scene.cfg -o d");
    for (size_t i = 0; i < sizeof lists / sizeof *lists; i++) {
        scoped_table t = read_table(lists[i].table);
        const char *units = rp_table_find_note(&t, "units");
        CU_ASSERT(units && strcmp(units, lists[i].units) == 0);
    }
}

/* ---- the ledger ---- */

/* The columns of the first row; a wrong one would have a wrong value. */
static void check_distinct(checked *e, size_t n, const check_value columns[])
{
    for (size_t k = 0; k < n; k++) {
        NEAR_RELATIVE(at(e, 0, columns[k].name), columns[k].value, 1e-14);
        for (size_t j = 0; j < k; j++)
            CU_ASSERT(fabs(columns[k].value) > 1e-9 && columns[k].value != columns[j].value);
        if (fabs(columns[k].value) < 1e-9) fprintf(stderr, "%s is 0\n", columns[k].name);
    }
}
#define CHECK_DISTINCT(e, ...)                                                                               \
    check_distinct(e, sizeof((check_value[]){__VA_ARGS__}) / sizeof(check_value),                            \
                   (check_value[]){__VA_ARGS__})

/* Gravity turns, a wall rises, a grain leaves, wells break, collisions are hard, and every contact damps: no
 * column of the ledger is 0. Each against the member of that name. */
static void test_ledger(void)
{
    write_text(
        "scene.cfg",
        "dt = 2.0e-5; steps = 2500; rotation = true; ledger = true; x_max = 1.4; y_min = -9.0;\n"
        "gravity_turn_deg_per_step = 0.01; integrator = \"verlet\";\n"
        "normal = { law = \"linear\"; k_n = 1.0e5; gamma_n = 90.0; tension = false; };\n"
        "tangential = { law = \"slip_roll\"; gamma_s = 70.0; mu = 0.3; };\n"
        "rolling = { mu = 0.1; k = 2.0e4; gamma = 50.0; };\n"
        "ground = { mu_static = 0.2; a = 0.0005; set = \"touch\"; }; hard = { restitution = 0.3; mu = 0.2; "
        "};\n"
        "walls = ( { point = [0.0, 0.0]; direction = [0.0, 1.0]; },\n"
        "  { point = [0.0, 0.0]; direction = [1.0, 0.0]; extent = [-0.5, 9.0]; open_at_step = 1; open_speed "
        "= 20.0; } );\n"
        "particles = ( { x = 0.09; y = 0.13; r = 0.1; vx = -9.0; }, { x = 0.32; y = 0.1; r = 0.1; omega = "
        "50.0; },\n"
        "  { x = 0.2; y = 0.31; r = 0.09; vy = -30.0; }, { x = 1.3; y = 0.4; r = 0.08; vx = 40.0; } );\n");
    GOOD("run scene.cfg -o d");
    scoped_checked e = checked_read("d/energy.tsv");
    scoped_scene scene = {0};
    scoped_sim *sim = NULL;
    CHECK_OK(dem_scene_read(path_of("scene.cfg"), NULL, &scene));
    CHECK_OK(dem_scene_start(&scene, &sim));
    CHECK_OK(dem_run(sim, scene.steps));
    const dem_energy now = grains_energies(sim);
    const dem_ledger l = grains_ledger(sim);
    CU_ASSERT_FATAL(e.t.n_rows == 1);
    CHECK_DISTINCT(&e, CHECKED_FIELD(l, start), CHECKED_FIELD(l, taken_out), CHECKED_FIELD(l, gravity_turn),
                   CHECKED_FIELD(l, wall_work), CHECKED_FIELD(l, normal_damping),
                   CHECKED_FIELD(l, shear_damping), CHECKED_FIELD(l, sliding), CHECKED_FIELD(l, rolling),
                   CHECKED_FIELD(l, wells), CHECKED_FIELD(l, hard), CHECKED_FIELD(l, integration),
                   CHECKED_FIELD(l, at_walls), CHECKED_FIELD(l, turnover), CHECKED_FIELD(now, kinetic),
                   CHECKED_FIELD(now, elastic), CHECKED_FIELD(now, gravity), CHECKED_FIELD(now, rotational),
                   {"kinetic_per_grain", (now.kinetic + now.rotational) / (double)dem_count(sim)},
                   {"grains", (double)dem_count(sim)}, {"step", 2500.0}, {"t", 0.05});
    CHECK_NEAR(at(&e, 0, "put_in"), 0.0, 0.0);
    CHECK_NEAR(at(&e, 0, "residual"), 0.0, 1e-12 * l.turnover);
}

/* ---- a static pile ---- */

enum { BASE = 4, DISKS = 10 };

/* Bonds of stiffness 1/eps at distances below 1, wells of k_x below each base disk. */
static void check_disks(checked *d, checked *c, checked *w, double eps)
{
    double fx[DISKS + 1] = {0}, fy[DISKS + 1] = {0}, most[DISKS + 1] = {0}, least[DISKS + 1];
    for (int id = 1; id <= DISKS; id++) least[id] = INFINITY;
    for (size_t k = 0; k < c->t.n_rows; k++) {
        const int a = (int)at(c, k, "a"), b = (int)at(c, k, "b");
        CU_ASSERT_FATAL(a >= 1 && a <= DISKS && b >= 1 && b <= DISKS);
        const size_t i = (size_t)a - 1, j = (size_t)b - 1;
        const double dx = at(d, i, "x") - at(d, j, "x"), dy = at(d, i, "y") - at(d, j, "y"),
                     force = at(c, k, "force"), distance = hypot(dx, dy);
        CHECK_EACH(at(c, k, NAME), 0.0, {"x", at(d, i, "x")}, {"y", at(d, i, "y")}, {"x_b", at(d, j, "x")},
                   {"y_b", at(d, j, "y")});
        NEAR_RELATIVE(force, (1.0 - distance) / eps, RELATIVE);
        CHECK_NEAR(at(c, k, "horizontal"), fabs(dy) < 0.1, 0.0);
        fx[a] += force * dx / distance, fy[a] += force * dy / distance;
        fx[b] -= force * dx / distance, fy[b] -= force * dy / distance;
        most[a] = fmax(most[a], force), most[b] = fmax(most[b], force);
        least[a] = fmin(least[a], force), least[b] = fmin(least[b], force);
    }
    for (size_t k = 0; k < c->t.n_rows; k++) {
        const int a = (int)at(c, k, "a"), b = (int)at(c, k, "b");
        const double force = at(c, k, "force"), slack = 1e-9 * force;
        CHECK_EACH(at(c, k, NAME), 0.0, {"strongest", force >= most[a] - slack || force >= most[b] - slack},
                   {"weakest", force <= least[a] + slack || force <= least[b] + slack});
    }
    for (size_t k = 0; k < w->t.n_rows; k++) {
        const int id = (int)at(w, k, "disk");
        const size_t i = (size_t)id - 1;
        CHECK_NEAR(at(w, k, "x_0"), (double)k, 0.0); /* the lattice's */
        CHECK_NEAR(at(w, k, "x"), at(d, i, "x"), 0.0);
        NEAR_RELATIVE(at(w, k, "x-x_0"), (at(w, k, "x") - at(w, k, "x_0")) / eps, RELATIVE);
        NEAR_RELATIVE(at(w, k, "N"), (0.5 - at(d, i, "y")) / eps, RELATIVE);
        NEAR_RELATIVE(at(w, k, "H"), 0.7 * at(w, k, "x-x_0"), RELATIVE);
        CHECKED_WORD(w, k, "state", "holds");
        fx[id] -= at(w, k, "H"), fy[id] += at(w, k, "N");
    }
    for (int id = 1; id <= DISKS; id++) {
        const size_t i = (size_t)id - 1;
        CHECK_PAIRS(1e-9, {fx[id], 0.0}, {fy[id], 1.0});
        CHECK_EACH(at(d, i, NAME), 0.0, {"id", id}, {"r", 0.5});
        /* in units of half a diameter and of a row's height the lattice has whole numbers */
        const double x_0 = 2.0 * (at(d, i, "x") - eps * at(d, i, "u_x")),
                     row = (at(d, i, "y") - eps * at(d, i, "u_y") - 0.5) / sqrt(0.75);
        CHECK_PAIRS(1e-12, {x_0, round(x_0)}, {row, round(row)});
    }
}

/* The triangle by (42) and (44): N = (k + 1)/2, H grows by equal parts from toe to toe. */
static void check_base(checked *b, checked *w)
{
    const double width = at(b, 1, "N/mg") / at(b, 1, "N/(chi*g*B)");
    CU_ASSERT(width > BASE - 1.0 && width < BASE + 1.0);
    for (size_t k = 0; k < BASE; k++) {
        CHECK_NEAR(at(b, k, "i"), (double)k + 1.0, 0.0);
        CHECK_NEAR(at(b, k, "x"), (double)k, 1e-12);
        CHECK_EACH(at(b, k, NAME), 0.0, {"N/mg", at(w, k, "N")}, {"H/mg", at(w, k, "H")});
        CHECK_EACH(at(b, k, NAME), 1e-13, {"N_diagonals/mg", 0.5 * (BASE + 1.0)},
                   {"H_diagonals/mg", ((double)k - 0.5 * (BASE - 1.0)) / sqrt(3.0)},
                   {"x/B", 0.5 + ((double)k - 0.5 * (BASE - 1.0)) / width});
        NEAR_RELATIVE(at(b, k, "N/(chi*g*B)"), at(w, k, "N") / width, 1e-13);
        NEAR_RELATIVE(at(b, k, "H/(chi*g*B)"), at(w, k, "H") / width, 1e-13);
    }
}

static void test_pile(void)
{
    write_text("s.cfg", "protocol = \"pile\"; replicas = 1; fixed = { base = 4; eps = 1e-3; k_x = 0.7; };\n");
    GOOD("run s.cfg -o d");
    scoped_checked d = checked_read("d/disks.tsv"), c = checked_read("d/contacts.tsv"),
                   w = checked_read("d/wells.tsv"), b = checked_read("d/base.tsv");
    CU_ASSERT_FATAL(d.t.n_rows == DISKS && w.t.n_rows == BASE && b.t.n_rows == BASE);
    check_disks(&d, &c, &w, 1e-3);
    check_base(&b, &w);
}

/* ---- runs of a sweep ---- */

/* Every row of the exported runs is the run made again; every column of the reduced table comes from them. */
static void test_sweep(void)
{
    write_text(
        "s.cfg",
        "protocol = \"pile\"; replicas = 3; seed = 7;\n"
        "fixed = { alpha_deg = 30.0; disorder = 2e-3; }; grid = { base = [9, 12]; eps = [1e-4, 2e-4]; };\n");
    GOOD("sweep plan s.cfg -o d");
    GOOD("sweep run d -j 2");
    GOOD("sweep export d -o runs.tsv");
    GOOD("sweep export d --reduce -o points.tsv");
    scoped_checked runs = checked_read("runs.tsv");
    char units[1024] = "1\t1\t1\t1\t1\t1"; /* run, status, base, eps, replica, pile */
    for (const sweep_output *o = sweep_protocol_pile.outputs; o->name; o++)
        snprintf(units + strlen(units), sizeof units - strlen(units), "\t%s", *o->unit ? o->unit : "1");
    strcat(units, "\ts");
    const char *const found = rp_table_find_note(&runs.t, "units");
    CU_ASSERT(found && strcmp(found, units) == 0);
    scoped_table points = read_table("points.tsv");
    CU_ASSERT_FATAL(runs.t.n_rows == 12 && points.n_rows == 4);
    for (size_t row = 0; row < 12; row++) {
        CHECK_EACH(at(&runs, row, NAME), 0.0, {"run", (double)row}, {"replica", (double)(row % 3)});
        const double pile = at(&runs, row, "pile");
        CHECK_NEAR(pile, cell(&runs.t, row - row % 3, "pile") + (double)(row % 3),
                   0.0); /* of its own, in a row */
        CU_ASSERT(row < 3 || pile != cell(&runs.t, row - 3, "pile"));
        CHECK_EACH(at(&runs, row, NAME), 0.0, {"base", row < 6 ? 9.0 : 12.0},
                   {"eps", row % 6 < 3 ? 1e-4 : 2e-4});
        CU_ASSERT(at(&runs, row, "seconds") > 0.0);
        CHECKED_WORD(&runs, row, "status", "ok");
        if (row % 5) continue; /* three of them */
        scoped_table again = TABLE_OF("run s.cfg --row %zu -o again --force", row);
        const char *const own = rp_table_find_note(&again, "units");
        const size_t length = strlen(units) - strlen("1\t1\t1\t1\t1\t1\t") - strlen("\ts");
        CU_ASSERT(own && strlen(own) == length + 2 &&
                  strncmp(own, units + 12, length) == 0); /* and the status */
        for (const sweep_output *o = sweep_protocol_pile.outputs; o->name; o++) {
            at(&runs, row, o->name);
            CU_ASSERT_STRING_EQUAL(word(&again, 0, o->name), word(&runs.t, row, o->name));
        }
    }
    for (size_t row = 0; row < 4; row++)
        for (const sweep_output *o = sweep_protocol_pile.outputs; o->name; o++) {
            double v[3], mean = 0.0, square = 0.0, n = 0.0;
            for (size_t k = 0; k < 3; k++) v[k] = at(&runs, 3 * row + k, o->name), n += isfinite(v[k]);
            CHECK_NEAR(cell(&points, row, check_text("%s_n", o->name)), n, 0.0);
            if (n < 3.0) continue;
            mean = (v[0] + v[1] + v[2]) / 3.0;
            for (size_t k = 0; k < 3; k++) square += (v[k] - mean) * (v[k] - mean);
            CHECK_NEAR(cell(&points, row, check_text("%s_mean", o->name)), mean, 1e-14 * (fabs(mean) + 1.0));
            CHECK_NEAR(cell(&points, row, check_text("%s_se", o->name)), sqrt(square / 6.0),
                       1e-7 * sqrt(square) + 1e-14);
        }
}

/* ---- commands ---- */

/* Standard error of the sum of two mean angles over resamples of their piles, from the stream of the seed;
 * resampled means of n piles spread with n, not n - 1, below the root. */
static double resampled_error(size_t n, const double a[], const double b[], int resamples, unsigned long seed)
{
    double sum = 0.0, squares = 0.0;
    rp_random rng = rp_random_of(seed, 0, RP_PURPOSE_BOOTSTRAP);
    for (int k = 0; k < resamples; k++) {
        double mean = 0.0;
        for (size_t i = 0; i < n; i++) {
            const size_t pick = rp_random_below(&rng, n);
            mean += (a[pick] + b[pick]) / (double)n;
        }
        sum += mean, squares += mean * mean;
    }
    const double variance = (squares - sum * sum / resamples) / (resamples - 1.0);
    return sqrt(variance * (double)n / ((double)n - 1.0));
}

/* A table that is derived from runs with a result alone. */
static void none_failed(checked *c)
{
    for (size_t row = 0; row < c->t.n_rows; row++) {
        CHECK_NEAR(at(c, row, "n_failed"), 0.0, 0.0);
        CHECKED_WORD(c, row, "failed_for", "-");
    }
}

/* Runs without a result, behind each row of a derived table: of its group and range, by runs, by points. */
static void test_failed(void)
{
    static const struct {
        const char *command, *table, *failed[3];
    } cases[] = {
        {"stats trend -x x -y y --by g", "f.tsv", {"1\tno_pile:1", "3\tno_pile:2,overlap:1"}},
        {"stats trend -x x -y y --by g --to 3", "f.tsv", {"1\tno_pile:1", "2\tno_pile:2"}},
        {"stats size -x x -y y --by g", "f.tsv", {"1\tno_pile:1", "3\tno_pile:2,overlap:1"}},
        {"stats correlation -x x -y y --by g", "f.tsv", {"1\tno_pile:1", "3\tno_pile:2,overlap:1"}},
        {"stats fit -x x -y y --from 2", "f.tsv", {"3\tno_pile:2,overlap:1", "3\tno_pile:2,overlap:1"}},
        {"stats fit -x x -y y --to 3", "p.tsv", {"4\toverlap:3,a:1", "4\toverlap:3,a:1"}}};
    FILE *file = file_of("f.tsv");
    fputs("# units: 1\t1\t1\t1\ng\tx\ty\tstatus\n", file);
    for (int i = 0; i < 24; i++) fprintf(file, "%c\t%d\t%d\tok\n", "ab"[i % 2], 1 + i / 2 % 4, 5 + i * i % 7);
    fputs("a\t1\tnan\tno_pile\nb\t2\tnan\tno_pile\nb\t3\t1\tno_pile\nb\t4\tnan\toverlap\n", file);
    fclose(file);
    write_text("p.tsv",
               "# units: 1\t1\t1\t1\t1\nx\ty\tn\tn_failed\tfailed_for\n"
               "1\t2\t5\t2\toverlap:1,a:1\n2\t3\t5\t2\toverlap:2\n2.5\tnan\t0\t7\ta:7\n3\t4\t5\t0\t-\n"
               "4\t5\t5\t1\ta:1\n");
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        scoped_table c = TABLE_OF("%s %s", cases[k].command, cases[k].table);
        for (size_t row = 0; row < 3 && cases[k].failed[row]; row++) {
            CU_ASSERT_FATAL(row < c.n_rows);
            const char *text = check_text("%s\t%s", word(&c, row, "n_failed"), word(&c, row, "failed_for"));
            if (strcmp(text, cases[k].failed[row])) fprintf(stderr, "%s: %s\n", cases[k].command, text);
            CU_ASSERT_STRING_EQUAL(text, cases[k].failed[row]);
        }
    }
}

/* angle compare: each form of (4) by angle tilt, at the mean slope. */
static void test_compare(void)
{
    static const char *const forms[] = {"balanced", "lattice", "sine", "printed"};
    static const double r[] = {9.0, 11.0, 10.5, 9.5}, t[] = {3.0, 3.5, 2.5, 4.0};
    const double mean_r = 10.0, mean_t = 3.25;
    write_text("runs.tsv",
               "# mu\ttheta_r3_deg\ttheta_t_displacement_deg\tstatus\n0.2\t%g\t%g\tok\n0.2\t%g\t%g\tok\n"
               "0.2\t%g\t%g\tok\n0.2\t%g\t%g\tok\n",
               r[0], t[0], r[1], t[1], r[2], t[2], r[3], t[3]);
    scoped_checked c = CHECKED_RUN(1, "angle compare runs.tsv --bootstrap 400 --phi-deg 55 --seed 31");
    none_failed(&c);
    const double ms = atan(0.2 * pow(tan(55.0 * M_PI / 180.0), 2.0)) * 180.0 / M_PI;
    const double miss_ms = fabs(mean_r + mean_t - ms);
    CHECK_EACH(at(&c, 0, NAME), 0.0, {"mu", 0.2}, {"n", 4.0});
    CHECK_EACH(at(&c, 0, NAME), 1e-12, {"theta_r_deg", mean_r}, {"theta_t_deg", mean_t},
               {"theta_rt_deg", mean_r + mean_t}, {"theta_r_se_deg", sqrt(2.5 / 3.0 / 4.0)},
               {"theta_t_se_deg", sqrt(1.25 / 3.0 / 4.0)});
    CHECK_NEAR(at(&c, 0, "theta_rt_se_deg"), sqrt(3.25 / 3.0 / 4.0), 1e-12); /* 12, 14.5, 13, 13.5 */
    CHECK_EACH(at(&c, 0, NAME), 1e-12, {"theta_ms_deg", ms}, {"diff_ms_deg", mean_r + mean_t - ms});
    CHECK_NEAR(at(&c, 0, "diff_ms_se_deg"), resampled_error(4, r, t, 400, 31), 1e-11);
    CHECK_EACH(at(&c, 0, NAME), 0.0, {"n_unstable", 0.0}, {"n_lost", 0.0});
    CHECKED_WORD(&c, 0, "status", "ok");
    for (size_t f = 0; f < 4; f++) {
        static const char *const parts[] = {"theta_t", "diff", "theta_rt", "gain"};
        scoped_table tilt = TABLE_OF("angle tilt --mu 0.2 --theta-r-deg 10 --phi-deg 55 --form %s", forms[f]);
        const double theory = cell(&tilt, 0, "theta_t_deg"), miss = fabs(mean_t - theory);
        const double expected[] = {theory, mean_t - theory, mean_r + theory, miss - miss_ms};
        for (size_t k = 0; k < 4; k++) {
            CHECK_NEAR(at(&c, 0, check_text("%s_%s_deg", parts[k], forms[f])), expected[k], 1e-11);
            const double error = at(&c, 0, check_text("%s_%s_se_deg", parts[k], forms[f]));
            CU_ASSERT(error > 0.0 && error < 2.0);
        }
        CHECK_NEAR(at(&c, 0, check_text("gain_relative_%s", forms[f])),
                   miss / mean_t - miss_ms / (mean_r + mean_t), 1e-12);
        const double error = at(&c, 0, check_text("gain_relative_%s_se", forms[f]));
        CU_ASSERT(error > 0.0 && error < 1.0);
    }
    /* groups of one pile beside it, each with its own friction */
    write_text(
        "more.tsv",
        "# mu\ttheta_r3_deg\ttheta_t_displacement_deg\tstatus\n0.3\t12\t5\tok\n0.1\t5\t2\tok\n0.2\t9\t3\tok\n"
        "0.2\t11\t3.5\tok\n");
    scoped_table t_more = TABLE_OF("angle compare more.tsv --bootstrap 10");
    CU_ASSERT_FATAL(t_more.n_rows == 3);
    for (size_t g = 0; g < 3; g++) {
        const double mu = 0.1 * ((double)g + 1.0);
        CHECK_NEAR(cell(&t_more, g, "mu"), mu, 1e-15);
        CHECK_NEAR(cell(&t_more, g, "n"), g == 1 ? 2.0 : 1.0, 0.0);
        CHECK_EACH(cell(&t_more, g, NAME), 1e-12, {"theta_ms_deg", atan(3.0 * mu) * 180.0 / M_PI},
                   {"theta_rt_deg", (double[]){7.0, 13.25, 17.0}[g]});
    }
    /* the word is that of the first form that is not ok */
    const char *first_word = "ok";
    char found[4][32];
    write_text("more.tsv",
               "# mu\ttheta_r3_deg\ttheta_t_displacement_deg\tstatus\n0.4\t4\t5\tok\n0.4\t6\t7\tok\n");
    for (size_t f = 0; f < 4; f++) {
        scoped_table tilt = TABLE_OF("angle tilt --mu 0.4 --theta-r-deg 5 --phi-deg 74 --form %s", forms[f]);
        snprintf(found[f], sizeof found[f], "%s", word(&tilt, 0, "status"));
    }
    for (size_t f = 4; f-- > 0;)
        if (strcmp(found[f], "ok") != 0) first_word = found[f];
    CU_ASSERT(strcmp(found[0], "ok") == 0 && strcmp(first_word, "ok") != 0);
    AGAIN_OF(t_more, "angle compare more.tsv --bootstrap 10 --phi-deg 74");
    CU_ASSERT_STRING_EQUAL(word(&t_more, 0, "status"), first_word);
}

/* Closed-form models: the outline of a tent of 30 and 45 degrees, the triangle by (42) and (44). */
static void test_models(void)
{
    static const double x[] = {0.1, 0.4, 0.8};
    const double steep = tan(M_PI / 4.0), flat = tan(M_PI / 6.0);
    const double height[] = {0.1 * flat, 0.3 * flat + 0.1 * steep, 0.2 * flat};
    scoped_checked tent = CHECKED_RUN(3, "tent --outer-deg 30 --inner-deg 45 --x1 0.3 --at 0.1,0.4,0.8");
    for (size_t i = 0; i < 3; i++) {
        CHECK_NEAR(at(&tent, i, "x/B"), x[i], 0.0);
        CHECK_NEAR(at(&tent, i, "y/B"), height[i], 1e-14);
        CU_ASSERT(at(&tent, i, "N/(chi*g*B)") > 0.0 && at(&tent, i, "N/(chi*g*B)") < height[1]);
        CU_ASSERT((at(&tent, i, "H/(chi*g*B)") > 0.0) == (x[i] > 0.5));
    }
    scoped_checked lattice = CHECKED_RUN(5, "lattice --layers 5");
    const double width = at(&lattice, 0, "N/mg") / at(&lattice, 0, "N/(chi*g*B)");
    for (size_t i = 0; i < 5; i++) {
        const double N = 3.0, H = ((double)i - 2.0) / sqrt(3.0);
        CHECK_NEAR(at(&lattice, i, "i"), (double)i + 1.0, 0.0);
        CHECK_EACH(at(&lattice, i, NAME), 1e-13, {"N/mg", N}, {"H/mg", H}, {"N/(chi*g*B)", N / width},
                   {"H/(chi*g*B)", H / width}, {"x/B", 0.5 + ((double)i - 2.0) / width});
    }
}

/* The continuum at points that are not even: forces of the model at each, mirrored at the middle. */
static void test_continuum(void)
{
    static const double x[] = {0.05, 0.2, 0.41, 0.59, 0.8, 0.95};
    scoped_checked c = CHECKED_RUN(6, "continuum --alpha-deg 40 --at 0.05,0.2,0.41,0.59,0.8,0.95");
    for (size_t i = 0; i < 6; i++) {
        an_force f;
        CHECK_OK(an_continuum(40.0 * M_PI / 180.0, x[i], &f));
        CHECK_NEAR(at(&c, i, "x/B"), x[i], 1e-15);
        CHECK_EACH(at(&c, i, NAME), 1e-14, {"N/(chi*g*B)", f.N}, {"H/(chi*g*B)", f.H});
        CHECK_EACH(at(&c, 5 - i, NAME), 1e-14, {"N/(chi*g*B)", f.N}, {"H/(chi*g*B)", -f.H});
        CU_ASSERT(i == 0 || i > 2 || f.N > at(&c, i - 1, "N/(chi*g*B)"));
    }
}

/* Columns by their names, against the members of the same name. */
static void check_named(checked *c, size_t row, size_t n, const check_value list[])
{
    for (size_t k = 0; k < n; k++) {
        CHECK_NEAR(at(c, row, list[k].name), list[k].value, 1e-12 * fabs(list[k].value) + 1e-15);
        for (size_t j = 0; j < k; j++) /* a wrong column has a wrong value */
            CU_ASSERT(list[k].value != list[j].value || strchr("nx", *list[k].name));
    }
}
#define CHECK_NAMED(c, row, ...)                                                                             \
    check_named(c, row, sizeof((check_value[]){__VA_ARGS__}) / sizeof(check_value),                          \
                (check_value[]){__VA_ARGS__})

enum { POINTS = 14 };

static void write_points(double x[POINTS], double y[POINTS], double se[POINTS])
{
    FILE *file = file_of("points.tsv");
    fputs("# x\ty\tse\n", file);
    for (int i = 0; i < POINTS; i++) {
        x[i] = 1.0 + i % 4 + (i % 4 == 3);
        y[i] = 2.0 + 0.13 * x[i] + 0.04 * x[i] * x[i] + 0.01 * ((i * 7) % 11);
        se[i] = 0.05 + 0.01 * (i % 3);
        fprintf(file, "%.17g\t%.17g\t%.17g\n", x[i], y[i], se[i]);
    }
    fclose(file);
}

static void test_fits(void)
{
    double x[POINTS], y[POINTS], se[POINTS], inverse[POINTS], lo[4], hi[4];
    stats_trend t;
    stats_line free_line, origin;
    write_points(x, y, se);
    CHECK_OK(stats_trend_fit(&(stats_sample){POINTS, x, y, NULL, 0.0, false, 0.7}, &t));
    checked c = CHECKED_RUN(1, "stats trend points.tsv -x x -y y --margin 0.7");
    none_failed(&c);
    stats_contrast_interval(&t.change, 0.95, &lo[0], &hi[0]);
    stats_contrast_interval(&t.change, 0.90, &lo[1], &hi[1]);
    CHECK_NAMED(&c, 0, {"n", POINTS}, {"n_left", 0.0}, {"n_x", 4.0}, {"x_from", 1.0}, {"x_to", 5.0},
                {"slope", t.slope.value}, {"slope_se", t.slope.se}, {"dof", t.slope.dof},
                {"change", 4.0 * t.slope.value}, {"change_se", 4.0 * t.slope.se}, {"change_lo", lo[0]},
                {"change_hi", hi[0]}, {"p_value", stats_contrast_p(&t.change)}, {"bend", t.bend.value},
                {"bend_se", t.bend.se}, {"p_bend", stats_contrast_p(&t.bend)}, {"change_lo90", lo[1]},
                {"change_hi90", hi[1]}, CHECKED_FIELD(t, p_margin), {"pair", t.pair.value},
                {"pair_se", t.pair.se}, CHECKED_FIELD(t, p_pairs));
    CHECK_NEAR(at(&c, 0, "p_holm"), stats_contrast_p(&t.change), 1e-15); /* one test alone */
    CHECKED_WORD(&c, 0, "verdict", "rises");
    checked_end(&c);

    for (int i = 0; i < POINTS; i++) inverse[i] = 1.0 / x[i];
    CHECK_OK(stats_trend_fit(&(stats_sample){POINTS, inverse, y, NULL, -2.0, false, 1.0}, &t));
    c = CHECKED_RUN(1, "stats size points.tsv -x x -y y");
    none_failed(&c);
    stats_contrast_interval(&t.intercept, 0.95, &lo[2], &hi[2]);
    stats_contrast_interval(&t.slope, 0.95, &lo[3], &hi[3]);
    CHECK_NAMED(&c, 0, {"n", POINTS}, {"n_x", 4.0}, {"x_from", 1.0}, {"x_to", 5.0},
                {"limit", t.intercept.value}, {"limit_se", t.intercept.se}, {"limit_lo", lo[2]},
                {"limit_hi", hi[2]}, {"c", t.slope.value}, {"c_se", t.slope.se}, {"c_lo", lo[3]},
                {"c_hi", hi[3]}, {"p_value", stats_contrast_p(&t.slope)},
                {"p_bend", stats_contrast_p(&t.bend)});
    CHECK_NEAR(at(&c, 0, "p_holm"), stats_contrast_p(&t.slope), 1e-15);
    at(&c, 0, "status");
    checked_end(&c);

    CHECK_OK(stats_line_fit(&(stats_xy){POINTS, x, y, se}, false, &free_line));
    CHECK_OK(stats_line_fit(&(stats_xy){POINTS, x, y, se}, true, &origin));
    c = CHECKED_RUN(2, "stats fit points.tsv -x x -y y --se se");
    none_failed(&c);
    for (size_t row = 0; row < 2; row++) {
        const stats_line *l = row ? &origin : &free_line;
        CHECK_EACH(at(&c, row, NAME), 1e-12 * fabs(NAMED_VALUE) + 1e-15, {"slope", l->slope},
                   {"slope_se", l->slope_se}, {"intercept", l->intercept}, {"intercept_se", l->intercept_se},
                   {"covariance", l->covariance}, {"chi2", l->chi2}, {"p_value", l->p_value});
        CHECK_EACH(at(&c, row, NAME), 0.0, {"dof", POINTS - 2.0 + (double)row}, {"n", POINTS},
                   {"x_from", 1.0}, {"x_to", 5.0});
        double residual = 0.0;
        for (int i = 0; i < POINTS; i++)
            residual = fmax(residual, fabs(y[i] - l->intercept - l->slope * x[i]));
        CHECK_NEAR(at(&c, row, "residual"), residual, 1e-13);
        CHECKED_WORD(&c, row, "line", row ? "origin" : "free");
    }
    checked_end(&c);
}

/* Groups of different sizes, in turns: each row is the library's fit to the rows of its own group. */
enum { GROUPS = 3, MOST_OF_GROUP = 20 };
static struct {
    double x[GROUPS][MOST_OF_GROUP], y[GROUPS][MOST_OF_GROUP], pile[GROUPS][MOST_OF_GROUP],
        v[GROUPS][MOST_OF_GROUP];
    size_t n[GROUPS];
} grouped;

static void write_groups(void)
{
    static const size_t piles[GROUPS] = {4, 5, 3};
    FILE *file = file_of("groups.tsv");
    fputs("# y\tg\tx\tstatus\tpile\tv\n", file);
    memset(&grouped, 0, sizeof grouped);
    for (size_t i = 0; i < 4 * 5; i++)
        for (size_t g = 0; g < GROUPS; g++) {
            const size_t pile = i % 5, k = grouped.n[g];
            const double x = 2.0 + 1.5 * (double)(i / 5) * (1.0 + 0.5 * (double)g),
                         y = 20.0 - (double)g + (3.0 + (double)g) / x + 0.2 * (double)((i * 7 + g * 3) % 11),
                         v = y + 0.3 * (double)((i * 5 + g) % 7) - 1.0;
            const bool left = i == 6 + g; /* a failed run, whose pile is not whole */
            if (pile >= piles[g]) continue;
            fprintf(file, "%.17g\t%c\t%.17g\t%s\t%zu\t%.17g\n", y, "abc"[g], x, left ? "no_pile" : "ok", pile,
                    v);
            if (left) continue;
            grouped.x[g][k] = x, grouped.y[g][k] = y, grouped.pile[g][k] = (double)pile, grouped.v[g][k] = v;
            grouped.n[g]++;
        }
    fclose(file);
}

static void check_trends(const char *options, bool paired, bool logarithm, double power)
{
    stats_trend t[GROUPS];
    double p[GROUPS], p_holm[GROUPS];
    for (size_t g = 0; g < GROUPS; g++) {
        double x[MOST_OF_GROUP];
        for (size_t i = 0; i < grouped.n[g]; i++) x[i] = logarithm ? log10(grouped.x[g][i]) : grouped.x[g][i];
        const stats_sample sample = {grouped.n[g], x,         grouped.y[g], paired ? grouped.pile[g] : NULL,
                                     power,        logarithm, 0.4};
        CHECK_OK(stats_trend_fit(&sample, &t[g]));
        p[g] = stats_contrast_p(&t[g].change);
    }
    stats_holm(GROUPS, p, p_holm);
    scoped_table c = TABLE_OF("stats trend groups.tsv -x x -y y --by g --margin 0.4 --level 0.1 %s", options);
    CU_ASSERT_FATAL(c.n_rows == GROUPS);
    for (size_t g = 0; g < GROUPS; g++) {
        CU_ASSERT(*word(&c, g, "g") == "abc"[g]);
        CHECK_EACH(cell(&c, g, NAME), 0.0, {"n", (double)t[g].n},
                   {"n_left", (double)(grouped.n[g] - t[g].n)});
        CHECK_EACH(cell(&c, g, NAME), 1e-12, {"x_from", grouped.x[g][0]},
                   {"x_to", grouped.x[g][grouped.n[g] - 1]}, {"slope", t[g].slope.value},
                   {"slope_se", t[g].slope.se});
        CHECK_NEAR(cell(&c, g, "dof"), t[g].slope.dof, 1e-10);
        CHECK_NEAR(cell(&c, g, "change"), t[g].change.value, 1e-12);
        CHECK_EACH(cell(&c, g, NAME), 1e-13, {"p_value", p[g]}, {"p_holm", p_holm[g]},
                   {"p_margin", t[g].p_margin});
        CU_ASSERT_STRING_EQUAL(word(&c, g, "verdict"), stats_trend_word(&t[g], p_holm[g], 0.1));
    }
}

static void check_sizes(void)
{
    double p[GROUPS], p_holm[GROUPS];
    stats_trend t[GROUPS];
    for (size_t g = 0; g < GROUPS; g++) {
        double inverse[MOST_OF_GROUP];
        for (size_t i = 0; i < grouped.n[g]; i++) inverse[i] = 1.0 / grouped.x[g][i];
        CHECK_OK(stats_trend_fit(&(stats_sample){grouped.n[g], inverse, grouped.y[g], NULL, -1.5, false, 1.0},
                                 &t[g]));
        p[g] = stats_contrast_p(&t[g].change);
    }
    stats_holm(GROUPS, p, p_holm);
    scoped_table c = TABLE_OF("stats size groups.tsv -x x -y y --by g --power 1.5");
    CU_ASSERT_FATAL(c.n_rows == GROUPS);
    for (size_t g = 0; g < GROUPS; g++) {
        CU_ASSERT(*word(&c, g, "g") == "abc"[g]);
        CHECK_NEAR(cell(&c, g, "n"), (double)grouped.n[g], 0.0);
        CHECK_NEAR(cell(&c, g, "limit"), t[g].intercept.value, 1e-12);
        CHECK_NEAR(cell(&c, g, "c"), t[g].slope.value, 1e-11);
        CHECK_NEAR(cell(&c, g, "p_holm"), p_holm[g], 1e-13);
        CU_ASSERT_STRING_EQUAL(word(&c, g, "status"), "ok");
    }
}

static void test_groups(void)
{
    write_groups();
    check_trends("", false, false, 0.0);
    check_trends("--pair", true, false, 0.0);
    check_trends("--scale log", false, true, 0.0);
    check_trends("--scale log --power 2", false, true, 2.0);
    check_sizes();
}

/* stats correlation: a row for each column and group, by the library, and one for all rows without groups. */
static void test_correlations(void)
{
    static const char *const names[] = {"x", "v"};
    write_groups();
    scoped_checked c = CHECKED_RUN(2 * GROUPS, "stats correlation groups.tsv -y y -x x,v --by g");
    for (size_t row = 0; row < 2 * GROUPS; row++) {
        CHECK_NEAR(at(&c, row, "n_failed"), row % GROUPS < 2, 0.0);
        CHECKED_WORD(&c, row, "failed_for", row % GROUPS < 2 ? "no_pile:1" : "-");
    }
    for (size_t k = 0; k < 2; k++)
        for (size_t g = 0; g < GROUPS; g++) {
            const size_t row = k * GROUPS + g;
            stats_correlation r;
            CHECK_OK(stats_correlate(grouped.n[g], k ? grouped.v[g] : grouped.x[g], grouped.y[g], &r));
            CHECK_EACH(at(&c, row, NAME), 1e-14, {"n", (double)r.n}, {"correlation", r.value},
                       {"correlation_se", r.se}, {"correlation_lo", r.lo}, {"correlation_hi", r.hi});
            CU_ASSERT(*checked_word(&c, row, "g") == "abc"[g]);
            CHECKED_WORD(&c, row, "quantity", names[k]);
        }
    scoped_table t = TABLE_OF("stats correlation groups.tsv -y y -x x");
    CU_ASSERT(t.n_rows == 1 && cell(&t, 0, "n") == (double)(grouped.n[0] + grouped.n[1] + grouped.n[2]));
}

/* The same box in three systems of units: labels follow, defaults are converted, numbers agree. */
static void test_systems(void)
{
    /* J per erg, and erg per m g sigma of the default grain: 981 * pi/6 * 0.2^4 */
    static const struct {
        const char *word, *note, *unit, *energies, *force;
        double W, erg;
    } systems[] = {
        {"cgs", "", "cm", "erg", "dyn", 1.0, 1.0},
        {"si", "# system: si\n", "m", "J", "N", 0.01, 1e7},
        {"sigma", "# system: sigma\n", "sigma", "m g sigma", "m g", 5.0, M_PI / 6.0 * 0.008 * 981.0 * 0.2}};
    double kinetic[3] = {0}, elastic[3] = {0};
    for (int k = 0; k < 3; k++) {
        const double W = systems[k].W;
        write_text("s.cfg",
                   "units = \"%s\"; steps = 1200; tangential = { law = \"spring\"; };\n"
                   "fill = { N = 8; W = %g; H = %g; };\n"
                   "walls = ( { point = [0.0, 0.0]; direction = [0.0, 1.0]; } );\n",
                   systems[k].word, W, W);
        GOOD("run s.cfg --every 5 --force -o d");
        scoped_table t = read_table("d/energy.tsv");
        for (size_t i = 0; i < t.n_rows; i++) {
            kinetic[k] += cell(&t, i, "kinetic") * systems[k].erg;
            elastic[k] += cell(&t, i, "elastic") * systems[k].erg;
        }
        const char *units = rp_table_find_note(&t, "units");
        CU_ASSERT(units && strstr(units, systems[k].energies) != NULL);
        read_again(&t, "d/contacts.tsv");
        units = rp_table_find_note(&t, "units");
        const char *text = check_text("\t%s\t%s\t%s\t", systems[k].unit, systems[k].force, systems[k].force);
        CU_ASSERT(units && strstr(units, text) != NULL);
        SHELL("cat d/states.tsv >out 2>err");
        GOOD("stats select d/states.tsv");
        CU_ASSERT((strstr(out, "# system: ") != NULL) == (k > 0) && strstr(out, systems[k].note) != NULL);
    }
    CU_ASSERT(elastic[0] > 1e-6 && kinetic[0] > 1.0);
    for (int k = 1; k < 3; k++) { /* 12 digits of the converted values, over a fall and a few collisions */
        CHECK_NEAR(kinetic[k], kinetic[0], 1e-6 * kinetic[0]);
        CHECK_NEAR(elastic[k], elastic[0], 1e-5 * elastic[0]);
    }
}

static void test_systems_of_sweeps(void)
{
#define SWEEP  "protocol = \"repose\"; replicas = 1; fixed = { W = %s; H = %s; stop = \"steps\"; %s};\n"
#define SHAPES "units = \"si\"; " SWEEP "grid = { shape = [\"sphere\", \"disk\"]; };\n"
    static const char short_run[] = "fill_steps = 200; relax_steps = 200; ";
    write_text("a.cfg", SWEEP, "2.0", "2.0", short_run);
    GOOD("sweep make a.cfg -o a --tables at");
    write_text("a.cfg", "units = \"cgs\"; " SWEEP, "2.0", "2.0", short_run);
    PRINTS("1 already stored", "sweep plan a.cfg -o a"); /* keys know numbers alone */
    write_text("b.cfg", "units = \"si\"; " SWEEP, "0.02", "0.02", short_run);
    GOOD("sweep make b.cfg -o b --tables bt");
    SHELL("cat at/points.tsv bt/points.tsv >out 2>err");
    SHELL("grep -q '^# k_n: 1e+06 dyn' at/points.tsv && ! grep -q '^# system' at/points.tsv && grep -q '^# "
          "k_n: 10000 N/m^1.5$' bt/points.tsv && grep -q '^# system: si$' bt/points.tsv");
    write_text("b.cfg", "units = \"si\"; " SWEEP, "0.02", "0.02", "fill_steps = 5000; relax_steps = 200; ");
    GOOD("run b.cfg -o r");
    SHELL("[ -e r/phases.tsv ] && [ ! -e r/scene.cfg ]"); /* the text is in other units */
    GOOD("stress base r/pile --width 0.02");
    CHECK_PARTS(out, "\n# g: 9.81 m/s^2\n", "\n# diameter: 0.002 m\n", "\n# units: 1\tN/m\tN/m\t");
    PRINTS("N/m^1.5    real   10000 ", "params repose --units si");
    write_text("b.cfg", "units = \"si\"; protocol = \"repose\"; fixed = { k_n = 0.0; };\n");
    FAILS(65, "fixed.k_n = 0: out of range, allowed: (0, inf) N/m^1.5\n", "sweep plan b.cfg -o v");
    /* the g of SI among values in cgs */
    static const char warning[] = "g = 9.81 among values in cm, g and s; give units = \"si\", or g = 981";
    write_text("s.cfg",
               "gravity = [0.0, -9.81]; steps = 2; particles = ( { x = 0.0; y = 0.0; r = 0.1; } );\n");
    CU_ASSERT(run("run s.cfg") == 0 && strstr(err, warning));
    GOOD("run s.cfg --set units=si");
    FAILS(65, "units = \"metric\": unknown word, allowed: cgs | si | sigma", "run s.cfg --set units=metric");
    /* disks: the default density is that of spheres, but in cgs */
    CU_ASSERT(run("run s.cfg --set shape=disk") == 0);
    FAILS(65, "density: the default is that of spheres", "run s.cfg --set shape=disk --set units=si");
    CU_ASSERT(strstr(err, "a mass per area in kg/m^2 (1 g/cm^2 is 10)") != NULL);
    FAILS(65, "give that of the disks, a mass per area\n", "run s.cfg --set shape=disk --set units=sigma");
    GOOD("run s.cfg --set shape=disk --set units=si --set density=1000");
    write_text("s.cfg", "steps = 2; particles = ( { x = 0.0; y = 0.0; r = 0.1; m = 1.0; } );\n");
    GOOD("run s.cfg --set shape=disk --set units=si"); /* not asked for */
    write_text("s.cfg", "units = \"si\"; shape = \"disk\"; particles_file = \"p.tsv\";\n");
    write_text("p.tsv", "x y r\n0 0 0.1\n");
    FAILS(65, "density: the default is that of spheres", "run s.cfg");
    write_text("s.cfg",
               "units = \"si\"; shape = \"disk\"; steps = 2; fill = { N = 3; W = 0.02; H = 0.02; };\n");
    FAILS(65, "s.cfg:1: density: the default is that of spheres", "run s.cfg");
    GOOD("run s.cfg --set density=10");
    write_text("w.cfg", SHAPES, "0.02", "0.02", short_run);
    FAILS(65, "density: the default is that of spheres", "sweep plan w.cfg -o v");
    write_text("w.cfg", SHAPES, "0.02", "0.02", "fill_steps = 200; density = 1000.0; ");
    GOOD("sweep plan w.cfg -o v");
    write_text("w.cfg", "units = \"metric\"; protocol = \"repose\";\n");
    FAILS(65, "units = \"metric\": unknown word, allowed: cgs | si | sigma", "sweep plan w.cfg -o v");
}

CHECK_SUITE_WITHIN(tables, "tables", enter, leave, test_scene, test_walls, test_units, test_systems,
                   test_systems_of_sweeps, test_ledger, test_pile, test_sweep, test_compare, test_failed,
                   test_fits, test_groups, test_correlations, test_models, test_continuum)
