/* Motion of grains and walls: the Gear scheme, the rotating box, fixed grains, gravity set by a call. */
#include "core/clock.h"
#include "dem/setup/definition.h"
#include "dem/state/state.h"
#include "tests/faults.h"
#include "tests/grains.h"

static const double R = 0.1, M = 0.0042; /* of a single grain */
static const int integrators[2] = {DEM_VERLET, DEM_GEAR5};

/* Reference: one grain on a floor through the origin that rotates clockwise by `rate` per step, written out
 * with the functions of the C library. */
typedef struct {
    const dem_definition *def;
    double rate, spring, force[2];
} naive;

/* x, v: of the grain; way: what it moved since the last call; step: how far the floor has turned. */
static void naive_force(naive *p, const double x[2], const double v[2], const double way[2], long step)
{
    const dem_material *c = &p->def->walls[0].material;
    const double a = p->rate * (double)step, before = a - (step > 0 ? p->rate : 0.0);
    const double n[2] = {sin(a), cos(a)}, s[2] = {cos(a), -sin(a)};
    const double height = x[0] * n[0] + x[1] * n[1], along = x[0] * s[0] + x[1] * s[1];
    const double wall[2] = {along * (s[0] - cos(before)),
                            along * (s[1] + sin(before))}; /* its displacement */
    const double overlap = R - height, dt = p->def->dt;
    p->force[0] = p->force[1] = 0.0;
    if (overlap <= 0.0) {
        p->spring = 0.0;
        return;
    }
    const double u[2] = {v[0] - wall[0] / dt, v[1] - wall[1] / dt};
    const double f_n = c->k_n * pow(overlap, 1.5) - c->gamma_n * M * (u[0] * n[0] + u[1] * n[1]);
    const double cap = c->mu * fmax(f_n, 0.0);
    p->spring += (way[0] - wall[0]) * s[0] + (way[1] - wall[1]) * s[1];
    p->spring = fmax(-cap / c->k_s, fmin(cap / c->k_s, p->spring));
    const double f_s = -c->gamma_s * M * (u[0] * s[0] + u[1] * s[1]) - c->k_s * p->spring;
    for (int k = 0; k < 2; k++) p->force[k] = f_n * n[k] + f_s * s[k];
}

/* x and v are those of the start, then those of the end. */
static void naive_verlet(naive *p, double x[2], double v[2], long steps)
{
    const double dt = p->def->dt, *g = p->def->gravity, still[2] = {0.0, 0.0};
    naive_force(p, x, v, still, 0);
    for (int k = 0; k < 2; k++) v[k] -= 0.5 * dt * (p->force[k] / M + g[k]);
    for (long step = 1; step <= steps; step++) {
        double way[2];
        for (int k = 0; k < 2; k++) {
            v[k] += dt * (p->force[k] / M + g[k]);
            way[k] = dt * v[k];
            x[k] += way[k];
        }
        naive_force(p, x, v, way, step);
    }
    for (int k = 0; k < 2; k++) v[k] += 0.5 * dt * (p->force[k] / M + g[k]);
}

/* Six values x^(k) dt^k/k! of one coordinate. */
static void predict(double q[6])
{
    for (int rows = 5; rows > 0; rows--) /* Pascal's triangle */
        for (int i = rows - 1; i < 5; i++) q[i] += q[i + 1];
}

static void correct(double q[6], double second)
{
    static const double corrector[6] = {3.0 / 16.0, 251.0 / 360.0, 1.0, 11.0 / 18.0, 1.0 / 6.0, 1.0 / 60.0};
    const double error = second - q[2];
    for (int i = 0; i < 6; i++) q[i] += corrector[i] * error;
}

static void naive_gear(naive *p, double x[2], double v[2], long steps)
{
    const double dt = p->def->dt, *g = p->def->gravity, still[2] = {0.0, 0.0};
    double q[2][6] = {{0.0}}, last[2] = {x[0], x[1]};
    naive_force(p, x, v, still, 0);
    for (int k = 0; k < 2; k++) {
        q[k][0] = x[k];
        q[k][1] = dt * v[k];
        q[k][2] = 0.5 * dt * dt * (p->force[k] / M + g[k]);
    }
    for (long step = 1; step <= steps; step++) {
        double way[2];
        for (int k = 0; k < 2; k++) {
            predict(q[k]);
            x[k] = q[k][0];
            v[k] = q[k][1] / dt;
            way[k] = x[k] - last[k];
            last[k] = x[k];
        }
        naive_force(p, x, v, way, step);
        for (int k = 0; k < 2; k++) correct(q[k], 0.5 * dt * dt * (p->force[k] / M + g[k]));
    }
    for (int k = 0; k < 2; k++) {
        x[k] = q[k][0];
        v[k] = q[k][1] / dt;
    }
}

/* Bounces with friction and damping to rest, on a fixed or rotating floor. */
static void matches_naive_program(void)
{
    static const double rates[3] = {0.0, 2.385e-5, -2e-4};
    for (int k = 0; k < 6; k++) {
        const double rate = rates[k / 2];
        dem_grain grain = {0.385, 0.2, R, M, 7.0, -20.0};
        dem_definition def = grains_floored(1, &grain);
        def.integrator = integrators[k % 2], def.walls[0].material.gamma_n = 100.0;
        def.damping = DEM_DAMPING_OUTSIDE;
        scoped_sim *sim = grains_start(&def);
        dem_box_turn(sim, rate);
        for (long steps = 100; steps <= 1600; steps *= 2) {
            naive p = {.def = &def, .rate = rate};
            double x[2] = {grain.x, grain.y}, v[2] = {grain.vx, grain.vy};
            CHECK_OK(dem_run(sim, steps - dem_step(sim)));
            (def.integrator == DEM_GEAR5 ? naive_gear : naive_verlet)(&p, x, v, steps);
            dem_state s = grains_state_of_one(sim);
            /* round-off of sums of `steps` terms, some eps each; more in bounces where a floor turns */
            const double tolerance = rate == 0.0 ? 1e-12 : 1e-10;
            CHECK_PAIRS(tolerance, {s.x, x[0]}, {s.y, x[1]});
            CHECK_PAIRS(1e3 * tolerance, {s.vx, v[0]}, {s.vy, v[1]});
        }
    }
}

/* Without contacts every integrator is exact, also if gravity changes between steps. */
static void free_flight(void)
{
    const long steps = 1000;
    for (int k = 0; k < DEM_INTEGRATORS; k++) {
        if (dem_schemes[k]->order[0] < 2) continue;
        dem_grain grain = {0.3, 5.0, R, M, 12.0, 385.0};
        dem_definition def = grains_of(1, &grain);
        def.integrator = k, def.tangential = DEM_NONE, def.material.mu = 0.0;
        scoped_sim *sim = grains_start(&def);
        const double t = (double)steps * def.dt, g = 981.0;
        CHECK_OK(dem_run(sim, steps));
        dem_state s = grains_state_of_one(sim), after;
        /* 1000 sums of numbers below 20: 1000 half-ulps of 3.6e-15 */
        CHECK_PAIRS(2e-12, {s.x, 0.3 + 12.0 * t}, {s.y, 5.0 + 385.0 * t - 0.5 * g * t * t});
        CHECK_NEAR(s.vy, 385.0 - g * t, 1e-10);
        dem_gravity_set(sim, (double[]){300.0, 100.0});
        after = grains_state_of_one(sim);
        CHECK_PAIRS(1e-12, {after.vx, s.vx}, {after.vy, s.vy});
        CHECK_NEAR(after.fx, 300.0 * M, 1e-15);
        CHECK_OK(dem_run(sim, steps));
        after = grains_state_of_one(sim);
        CHECK_PAIRS(4e-12, {after.x, s.x + 12.0 * t + 150.0 * t * t},
                    {after.y, s.y + s.vy * t + 50.0 * t * t});
        CHECK_NEAR(after.vx, 12.0 + 300.0 * t, 1e-10);
        /* a rotation continues from it, and keeps its length */
        double now[2];
        dem_gravity_turn(sim, 1e-4);
        CHECK_OK(dem_run(sim, steps));
        dem_gravity(sim, now);
        CHECK_PAIRS(1e-9, {now[0], 300.0 * cos(0.1) - 100.0 * sin(0.1)},
                    {now[1], 100.0 * cos(0.1) + 300.0 * sin(0.1)});
    }
}

/* Grains in a lattice, whose pairs are listed but do not touch, and fixed ones beside it, which come first.
 * Their number is no multiple of that of any loop. */
enum { COLUMNS = 20, BESIDE = 3, IN_LATTICE = 200 + BESIDE };

static void make_lattice(double omega, dem_grain grains[IN_LATTICE])
{
    for (int i = 0; i < IN_LATTICE; i++) {
        grains[i] = (dem_grain){-1.0, 0.25 * i, R, M, .fixed = true};
        if (i < BESIDE) continue;
        grains[i] =
            (dem_grain){0.22 * (i % COLUMNS), 0.22 * (i / COLUMNS), R, M * (1.0 + 0.385 * i), 12.0, 185.0};
        grains[i].omega = omega;
    }
}

/* Each grain is where it is after free flight. */
static void check_flight(const dem_sim *sim, const dem_grain grains[IN_LATTICE], double t)
{
    const double g[2] = {-385.0, -981.0};
    scoped dem_state *s = grains_states(sim);
    for (int i = 0; i < IN_LATTICE; i++) {
        const dem_grain *from = &grains[i];
        const double moves = from->fixed ? 0.0 : t;
        /* some 300 sums of numbers below 20 */
        CHECK_PAIRS(4e-12, {s[i].x, from->x + from->vx * moves + 0.5 * g[0] * moves * moves},
                    {s[i].y, from->y + from->vy * moves + 0.5 * g[1] * moves * moves});
        CHECK_PAIRS(1e-10, {s[i].vx, from->vx + g[0] * moves}, {s[i].vy, from->vy + g[1] * moves});
        CHECK_NEAR(s[i].angle, from->omega * t, 1e-12);
        CU_ASSERT(s[i].contacts == 0);
    }
}

/* Each kernel and method takes all terms of the equation of motion, of soft and of hard grains, of those that
 * run ahead of a large pile's forces, in threads too, and of those whose number does not fill a vector. */
static void equation_of_motion(void)
{
    enum { ROTATION = 1, HARD = 2, LARGE = 4, THREADS = 8, ALL = 16 };
    const long steps = 300;
    dem_grain grains[IN_LATTICE];
    for (int way = 0; way < ALL * DEM_INTEGRATORS * DEM_KERNELS; way++) {
        dem_definition def = grains_of(IN_LATTICE, grains);
        def.kernel = way / ALL % DEM_KERNELS, def.integrator = way / ALL / DEM_KERNELS;
        def.rotation = way & ROTATION, def.hard.on = way & HARD;
        def.tension = !def.hard.on, def.gravity[0] = -385.0;
        def.material.mu = 0.0, def.tangential = DEM_NONE;
        if (!dem_kernel_runs(def.kernel) || dem_scheme_check(&def) || (way & THREADS && !(way & LARGE)))
            continue;
        make_lattice(def.rotation ? 3.0 : 0.0, grains);
        scoped_sim *sim = grains_start_in_chunks(&def, way & LARGE ? 64 : 0);
        CU_ASSERT((sim->pairs.n_chunks > 0) == ((way & LARGE) > 0));
        dem_threads(sim, way & THREADS ? 2 : 1);
        CHECK_OK(dem_run(sim, steps));
        check_flight(sim, grains, (double)steps * def.dt);
    }
}

/* A sticking contact without damping oscillates for ever, at a wall, and between two grains of which one is
 * fixed and nearly flat. At omega dt = 0.2 Verlet's energy oscillates by (omega dt)^2/4, and Gear's falls
 * by 2.2e-5 per period (numerical damping 0.1 (omega dt)^5). A spring that grows by predicted velocities
 * would damp the energy by exp(-k_s dt t/(2 m)): 1e-100 at the end. */
static void sticking_contact_rings(void)
{
    const double k_n = 1e6, g = 981.0, flat = 10.0, dt = 4e-5, omega = 0.2 / dt, v = 1e-5 * omega;
    for (int k = 0; k < 4; k++) {
        const double rest = R - pow(M * g / k_n, 2.0 / 3.0), k_s = M * omega * omega;
        dem_grain grains[2] = {{0.0, rest, R, M, v, 0.0}, {0.0, -flat, flat, M, 0.0, 0.0, .fixed = true}};
        dem_definition def = grains_floored(1, grains);
        def.integrator = integrators[k % 2];
        def.material = (dem_material){.k_n = k_n, .gamma_n = 500.0, .k_s = k_s, .mu = INFINITY};
        def.walls[0].material = def.material, def.skin = 0.04, def.dt = dt;
        if (k / 2) def.n_walls = 0, def.n_grains = 2;
        scoped_sim *sim = grains_start(&def);
        dem_state s[2];
        grains_run(sim, 10000, s); /* 318 periods */
        CHECK_NEAR((omega * omega * s[0].x * s[0].x + s[0].vx * s[0].vx) / (v * v), 1.0, 0.011);
    }
}

/* The same bits for any division of the steps, from a clone, with the wall opened by the definition or by a
 * call, with observation, after many rebuilds of the list, while the box or gravity rotates. */
static void determinism(void)
{
    for (int k = 0; k < 2 * DEM_INTEGRATORS; k++) {
        dem_definition def = grains_box(90, 2.2, 5, NULL);
        def.integrator = k / 2, def.dt = 4e-5, def.x_max = 3.5;
        def.rotation = k == 0, def.material.mu_roll = k == 0 ? 0.1 : 0.0;
        def.turn_from_step = 3000;
        *(k % 2 ? &def.box_turn_per_step : &def.turn_per_step) = 2e-5;
        def.walls[2].open_at_step = 4001;
        if (dem_scheme_check(&def)) continue;
        dem_sim *whole = grains_start(&def), *cut, *copy;
        def.walls[2].open_at_step = -1, def.box_turn_per_step = def.turn_per_step = 0.0;
        cut = grains_start(&def);
        CHECK_OK(dem_run(whole, 9000));
        for (int part = 0; part < 30; part++) {
            dem_energy e;
            dem_rest rest;
            dem_state s[90];
            grains_run(cut, 100, s);
            dem_energies(cut, &e);
            CHECK_OK(dem_rest_state(cut, 0.0, 2.2, &rest));
        }
        (k % 2 ? dem_box_turn : dem_gravity_turn)(cut, 2e-5);
        CHECK_OK(dem_run(cut, 1000));
        dem_wall_open(cut, 2, INFINITY);
        CHECK_OK(dem_run(cut, 2500));
        CHECK_OK(dem_clone(cut, &copy));
        dem_free(cut);
        dem_phases t = {0};
        fault_monotonic_tick = 1.0;
        const double started = rp_clock();
        CHECK_OK(dem_run_timed(copy, 2500, &t));
        const double elapsed = rp_clock() - started, all = t.integration + t.lists + t.contacts + t.walls;
        fault_monotonic_tick = 0.0;
        CU_ASSERT(t.integration > 0.0 && t.lists > 0.0 && t.contacts > 0.0 && t.walls > 0.0);
        /* the looks between the first, at the start, and the last, here */
        CU_ASSERT(all == elapsed - 2.0 && grains_same_bits(whole, copy));
        CU_ASSERT(grains_counts(copy).rebuilds > 20 && dem_count(copy) < 90 && dem_count(copy) > 30);
        CU_ASSERT(whole->walls.angle == copy->walls.angle);
        dem_free(whole), dem_free(copy);
    }
}

/* The angle accumulates, the frame rotates with the walls, and both stay when the box stops. */
static void box_angle(void)
{
    const double rate = -2.385e-4, a = 4000 * rate;
    dem_grain grain = {0.0, 9.0, R, M, 0.0, 0.0};
    dem_definition def = grains_floored(1, &grain);
    def.gravity[1] = 0.0;
    scoped_sim *sim = grains_start(&def);
    CU_ASSERT(sim->walls.angle == 0.0);
    dem_box_turn(sim, rate);
    CHECK_OK(dem_run(sim, 4000));
    dem_box_turn(sim, 0.0);
    CHECK_OK(dem_run(sim, 100));
    /* 4000 roundings */
    CHECK_NEAR(sim->walls.angle, a, 1e-12);
    double x = 2.0 * cos(a) + 0.7 * sin(a), y = -2.0 * sin(a) + 0.7 * cos(a);
    dem_box_frame(sim, &x, &y);
    CHECK_PAIRS(1e-11, {x, 2.0}, {y, 0.7});
}

/* The gain of momentum is the impulse of walls and gravity, while the box throws grains. */
static void wall_ledger(void)
{
    enum { N = 40, STEPS = 4000 };
    dem_definition def = grains_box(N, 1.5, 5, NULL);
    scoped_sim *sim = grains_start(&def);
    dem_state s[N];
    double p[2][2], impulse[2] = {0.0, 0.0}, mass = 0.0, forces[2 * DEM_FEW_WALLS];
    CHECK_OK(dem_run(sim, 3000));
    dem_box_turn(sim, 1e-4);
    for (int round = 0; round <= STEPS; round++) {
        if (round > 0) CHECK_OK(dem_run(sim, 1));
        const double half = round == 0 || round == STEPS ? 0.5 : 1.0;
        grains_wall_forces(sim, forces);
        for (int w = 0; w < 3; w++)
            for (int a = 0; a < 2; a++) impulse[a] -= half * def.dt * forces[2 * w + a];
        if (half == 1.0) continue;
        CHECK_OK(dem_states(sim, s));
        double *now = p[round > 0];
        now[0] = now[1] = mass = 0.0;
        for (int i = 0; i < N; i++) {
            now[0] += s[i].m * s[i].vx;
            now[1] += s[i].m * s[i].vy;
            mass += s[i].m;
        }
    }
    impulse[1] -= 981.0 * mass * STEPS * def.dt;
    /* round-off of 4000 * 40 terms of some dyn * dt: 400 * 1e-16 * 1e-2 and less */
    CHECK_PAIRS(1e-12, {p[1][0] - p[0][0], impulse[0]}, {p[1][1] - p[0][1], impulse[1]});
    CU_ASSERT(fabs(impulse[0]) > 1e-2);
}

/* Walls that sweep up distant grains at rest: the same as with a list rebuilt at every step. */
static void list_follows_turning_walls(void)
{
    for (int k = 0; k < DEM_INTEGRATORS; k++) {
        dem_grain grains[2] = {{-8.0, 1.0, R, M, 0.0, 0.0}, {-3.0, 0.5, R, M, 0.0, 0.0}};
        dem_definition def = grains_floored(1, grains);
        def.gravity[1] = 0.0, def.n_grains = 2, def.integrator = k;
        if (dem_scheme_check(&def)) continue;
        scoped_sim *sim = grains_start(&def), *renewed = grains_start(&def);
        dem_state s[2], t[2];
        dem_box_turn(sim, 1e-4);
        dem_box_turn(renewed, 1e-4);
        for (long step = 0; step < 3000; step++) {
            grains_run(sim, 1, s);
            CHECK_OK(dem_neighbours_rebuild(renewed));
            grains_run(renewed, 1, t);
            CU_ASSERT_FATAL(s[0].x == t[0].x && s[0].y == t[0].y && s[1].y == t[1].y);
        }
        CU_ASSERT(s[0].vy > 1.0 && s[1].vy > 1.0); /* both were hit */
        CU_ASSERT(grains_counts(sim).rebuilds < 500);
    }
}

/* x_max and y_min rotate with the box: a grain at rest in the laboratory is removed when they reach it. */
static void outlet_turns(void)
{
    dem_grain grains[2] = {{2.0, 5.0, R, M, 0.0, 0.0}, {-4.0, 0.5, R, M, 0.0, 0.0}};
    dem_definition def = grains_afloat(2, grains);
    const double rate = 1e-4;
    def.x_max = 2.5, def.y_min = -1.0;
    /* the first passes x_max where |x| cos(atan2(5, 2) - a) = 2.5, the second y_min */
    const double way[] = {atan2(5.0, 2.0) - acos(2.5 / hypot(5.0, 2.0)),
                          asin(1.0 / hypot(4.0, 0.5)) + atan2(0.5, 4.0)};
    for (int k = 0; k < 2; k++) {
        scoped_sim *sim = grains_start(&def);
        dem_box_turn(sim, k ? rate : -rate);
        CHECK_OK(dem_run(sim, (long)(way[k] / rate)));
        CU_ASSERT_EQUAL(dem_count(sim), 2);
        CHECK_OK(dem_run(sim, 1));
        CU_ASSERT_EQUAL(dem_count(sim), 1);
    }
}

/* A fixed grain is a round wall: the same head-on trajectory, and the same mass in the damping. With gravity
 * down and up, so that each of the two grains comes first in the list once. */
static void fixed_is_a_wall(void)
{
    for (int k = 0; k < 4; k++) {
        const double up = k / 2 ? -1.0 : 1.0;
        dem_grain grains[2] = {{0.0, up * 0.35, R, M, 0.0, up * -10.0},
                               {0.0, up * -0.385, 0.385, 3.0 * M, .fixed = true}};
        dem_definition def = grains_floored(1, grains);
        def.integrator = integrators[k % 2];
        def.gravity[1] *= up;
        def.walls[0].direction[1] = up;
        scoped_sim *on_wall = grains_start(&def), *on_grain = NULL;
        def.n_walls = 0, def.n_grains = 2;
        on_grain = grains_start(&def);
        dem_state s[2];
        for (int part = 0; part < 2; part++) { /* after a bounce, and at rest */
            CHECK_OK(dem_run(on_wall, part ? 11000 : 1000));
            grains_run(on_grain, part ? 11000 : 1000, s);
            /* rounding of centres at a distance, 1e-16 in the overlap, damped */
            CHECK_NEAR(s[0].y, grains_state_of_one(on_wall).y, 1e-12);
            CHECK_NEAR(s[0].vy, grains_state_of_one(on_wall).vy, 1e-9);
            CU_ASSERT(part == 1 || fabs(s[0].vy) > 0.1);
        }
        CU_ASSERT(s[1].fixed && !s[0].fixed && s[1].vy == 0.0 && s[1].y == up * -0.385);
        /* at rest, or nearly so */
        CHECK_NEAR(s[1].fy, -up * M * 981.0, 1e-3 * M * 981.0);
        dem_rest rest;
        CHECK_OK(dem_rest_state(on_grain, -1.0, 1.0, &rest));
        CU_ASSERT(rest.n == 1 && rest.net_force < 1e-3 * M * 981.0 && rest.contact_number == 1.0);
        const dem_energy energy = grains_energies(on_grain);
        CHECK_NEAR(energy.gravity, M * 981.0 * R, 1e-3 * M * 981.0);
    }
}

/* Rolling resistance acts relative to the box: without other friction a grain turns with the box. */
static void rolls_with_box(void)
{
    const double rate = 2e-5, depth = pow(M * 981.0 / 1e6, 2.0 / 3.0);
    dem_grain grain = {0.0, R - depth, R, M};
    dem_definition def = grains_floored(1, &grain);
    def.rotation = true, def.walls[0].material.mu = def.walls[0].material.gamma_s = 0.0;
    def.walls[0].material.mu_roll = 0.5, def.walls[0].material.k_roll = 1e4;
    def.walls[0].material.gamma_roll = 500.0;
    scoped_sim *sim = grains_start(&def);
    dem_box_turn(sim, rate);
    CHECK_OK(dem_run(sim, 3000));
    CHECK_NEAR(grains_state_of_one(sim).omega, -rate / def.dt, 1e-6 * rate / def.dt);
}

/* A rough floor of overlapping fixed grains below the floor's line. While a box empties over it, its grains
 * stay fixed, without contacts to one another or to walls, and others are removed and sorted. */
static void fixed_stay(void)
{
    enum { N = 60, FIXED = 18 };
    for (int k = 0; k < 2 * DEM_INTEGRATORS; k++) {
        const bool rotation = k % 2;
        dem_grain *fill, grains[N + FIXED];
        dem_definition def = grains_box(N, 2.0, 5, &fill);
        memcpy(grains + FIXED, fill, N * sizeof *fill);
        for (int i = 0; i < FIXED; i++)
            grains[i] = (dem_grain){0.19 * i, -0.06, R, M, 0.0, 0.0, .fixed = true};
        def.walls[DEM_BOX_RIGHT].open_at_step = 4000, def.integrator = k / 2;
        def.rotation = rotation, def.dt = 3.5e-5, def.grains = grains;
        def.n_grains = N + FIXED, def.x_max = 3.4;
        if (dem_scheme_check(&def)) continue;
        scoped_sim *sim = grains_start(&def), *copy = NULL;
        int carried = 0;
        CHECK_OK(dem_run(sim, 7000));
        CHECK_OK(dem_clone(sim, &copy));
        CHECK_OK(dem_run(sim, 4000));
        CHECK_OK(dem_run(copy, 4000));
        CU_ASSERT(grains_same_bits(sim, copy));
        scoped dem_state *s = grains_states(sim);
        for (int i = 0; i < FIXED; i++)
            CU_ASSERT(s[i].x == grains[i].x && s[i].y == -0.06 && s[i].vx == 0.0 && s[i].vy == 0.0 &&
                      s[i].fixed);
        for (size_t i = 0; i < dem_count(sim); i++) {
            CU_ASSERT(s[i].fixed == (i < FIXED));
            CU_ASSERT((s[i].omega != 0.0 || s[i].angle != 0.0) == (rotation && i >= FIXED));
        }
        const dem_energy energy = grains_energies(sim);
        CU_ASSERT(isfinite(energy.rotational) && (energy.rotational > 0.0) == rotation);
        CU_ASSERT(dem_count(sim) < N + FIXED);
        size_t n;
        scoped dem_contact *contacts = grains_contacts(sim, &n);
        for (size_t i = 0; i < n; i++) {
            const bool a = contacts[i].id_a <= FIXED, b = contacts[i].id_b >= 1 && contacts[i].id_b <= FIXED;
            carried += a != b;
            CU_ASSERT(!(a && b) && !(a && contacts[i].id_b == 0));
        }
        CU_ASSERT(carried > 5);
    }
}

static void refusals(void)
{
    dem_grain grain = {0.0, 0.5, R, M, 0.0, 0.0, .fixed = true};
    dem_definition def = grains_floored(1, &grain);
    dem_sim *sim = grains_start(&def); /* nothing moves */
    CHECK_OK(dem_run(sim, 10));
    CU_ASSERT(grains_state_of_one(sim).y == 0.5);
    dem_box_turn(sim, 1e-5);
    CHECK_FAILS(dem_run(sim, 1), RP_BAD_INPUT, "the box turns, but some grains are fixed");
    dem_free(sim);
    def.integrator = DEM_GEAR5, def.rotation = true;
    CHECK_FAILS(dem_create(&def, &sim), RP_BAD_INPUT, "grains that rotate need the integrator verlet");
}

CHECK_SUITE(motion, "motion", matches_naive_program, free_flight, equation_of_motion, sticking_contact_rings,
            determinism, box_angle, wall_ledger, list_follows_turning_walls, outlet_turns, rolls_with_box,
            fixed_is_a_wall, fixed_stay, refusals)
