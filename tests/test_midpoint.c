/* The energy-conserving implicit integrator: against closed forms of the mid-point rule, conservation laws,
 * and direct solver against SOR sweeps. Lengths in diameters, masses in those of a disk. */
#include "tests/grains.h"

static const double R = 0.5, K = 1e4;

/* dt in contact times of two disks. */
static dem_definition disks(const dem_grain *grains, size_t n, double dt)
{
    dem_definition def = grains_disks(n, grains, K);
    def.dt = dt * M_PI * sqrt(0.5 / K);
    return def;
}

static dem_definition on_floor(const dem_grain *grains, size_t n, double dt)
{
    dem_definition def = disks(grains, n, dt);
    grains_on_floor(&def, n, grains);
    return def;
}

/* Six disks of unequal size and mass in a box, moving. */
enum { GAS = 6 };
static dem_definition gas(dem_grain grains[GAS], double dt)
{
    grains_gas(GAS, grains);
    dem_definition def = disks(grains, GAS, dt);
    def.skin = 0.4;
    dem_box_walls(&def, 3.6, &def.material);
    return def;
}

/* A disk that slides on a floor, N = m g: decelerated by mu g, then creep by (1 - h)/(1 + h) per step, h =
 * gamma dt/2, once the viscous force is below the limit. */
static void slides_and_creeps(void)
{
    const double mu = 0.4, gamma = 20.0, m = 0.3;
    const dem_grain grain = {.x = 0.3, .y = R - m / K, .r = R, .m = m, .vx = 0.2};
    dem_definition def = on_floor(&grain, 1, 0.5);
    def.tangential = DEM_SLIP_ROLL;
    def.material.gamma_s = def.walls[0].material.gamma_s = gamma;
    def.material.mu = def.walls[0].material.mu = mu;
    scoped_sim *sim = grains_start(&def);
    const double h = 0.5 * gamma * def.dt;
    double v = 0.2;
    int slid = 0;
    for (int n = 0; n < 100; n++) {
        const double creeps = v * (1.0 - h) / (1.0 + h), slides = v - mu * def.dt;
        slid += slides > creeps;
        v = fmax(creeps, slides);
        CHECK_OK(dem_run(sim, 1));
        CHECK_NEAR(grains_state_of_one(sim).vx, v, 1e-12); /* N has a relative error of 1e-11 */
    }
    CU_ASSERT(slid > 30 && slid < 60);
}

/* A disk moves in its well: the depth belongs to N = m g throughout, as the disk is in vertical balance. */
static void well_conserves(void)
{
    const double mu = 0.3, a = 0.02, omega = sqrt(mu / a), escape = sqrt(mu * a);
    for (int leaves = 0; leaves < 2; leaves++)
        for (double angle = 0.05; angle < 10.0; angle *= 5.0) {
            dem_grain grain = {.x = 0.3, .y = R - 1.0 / K, .r = R, .m = 1.0};
            grain.vx = (leaves ? 1.3 : 0.8) * escape;
            dem_definition def = on_floor(&grain, 1, 1.0);
            def.dt = angle / omega, def.skin = 0.6;
            def.ground = (dem_ground){.wall = 1, .mu_static = mu, .a = a, .set = DEM_WELL_TOUCH};
            scoped_sim *sim = grains_start(&def);
            const double theta = 2.0 * atan(0.5 * angle), before = grains_energy(sim);
            for (int n = 1; n <= 100; n++) {
                CHECK_OK(dem_run(sim, 1));
                const dem_state s = grains_state_of_one(sim);
                if (leaves) continue;
                CHECK_NEAR(s.x - grain.x, 0.8 * a * sin(n * theta), 1e-13);
                /* the depth has the error of N: overlaps of 1e-4 to 1e-16, random errors */
                CHECK_NEAR(grains_energy(sim), before, 1e-11 * mu * a);
            }
            /* the loss is the depth of the well, mu N a/2, also if a step leads far beyond a */
            if (leaves) CHECK_NEAR(grains_state_of_one(sim).vx, sqrt(1.3 * 1.3 - 1.0) * escape, 1e-12);
        }
}

/* (30) with varying N: a disk oscillates vertically in its well, in permanent contact. The force then has no
 * potential: energy, with the depth at the present N, changes by the sum of mu u^2/(2 a) dN. A floor without
 * a well conserves energy. */
static void well_follows_load(void)
{
    const double mu = 0.3, a = 0.02, depth = 0.5 * mu * a;
    for (int well = 0; well < 2; well++) {
        dem_grain grain = {.x = 0.3, .y = R - 1.5 / K, .r = R, .m = 1.0};
        grain.vx = 0.8 * sqrt(mu * a);
        dem_definition def = on_floor(&grain, 1, 1.0);
        def.dt = 0.01 / sqrt(K);
        def.ground = (dem_ground){.wall = well, .mu_static = mu, .a = a, .set = DEM_WELL_TOUCH};
        scoped_sim *sim = grains_start(&def);
        const double before = grains_energy(sim);
        dem_contact c = grains_only_contact(sim);
        double work = 0.0, most = 0.0;
        for (int n = 0; n < 2000; n++) {
            const dem_contact last = c;
            CHECK_OK(dem_run(sim, 1));
            c = grains_only_contact(sim);
            const double u = 0.5 * (c.shear_spring + last.shear_spring);
            work += well ? 0.5 * mu * u * u / a * (c.normal_force - last.normal_force) : 0.0;
            most = fmax(most, fabs(work));
            /* (omega dt)^2 of the disk on its spring, 1e-4 of the depth, over some 3 periods */
            CHECK_NEAR(grains_energy(sim) - before, work, well ? 1e-3 * depth : 1e-11);
        }
        CU_ASSERT(!well || (c.well == DEM_WELL_HOLDS && most > 0.1 * depth));
    }
}

/* Linear and Hertz, direct solver and SOR, with steps short and long relative to a contact time: contacts
 * open and close within steps, and the neighbour list is rebuilt. */
static void energy_of_gas(void)
{
    static const double ratios[] = {0.01, 0.2, 1.0, 10.0};
    for (int k = 0; k < 16; k++) {
        dem_grain grains[GAS];
        dem_definition def = gas(grains, ratios[k % 4]);
        def.normal = k / 4 % 2 ? DEM_HERTZ : DEM_LINEAR;
        def.implicit.solver = k / 8, def.implicit.max_iterations = 10000, def.skin = 0.8;
        if (def.implicit.solver == DEM_SOLVER_SOR) def.skin = 0.4, def.dt *= k % 4 == 3 ? 0.3 : 1.0;
        scoped_sim *sim = grains_start(&def);
        const double before = grains_energy(sim);
        double most = 0.0;
        const long steps = k % 4 ? 2000 : 20000;
        for (long n = 0; n < steps && dem_sim_fault(sim) == DEM_FAULT_NONE; n++) {
            CHECK_OK(dem_run(sim, 1));
            most = fmax(most, fabs(grains_energy(sim) - before));
        }
        const dem_counts counts = grains_counts(sim);
        CU_ASSERT(counts.rebuilds > 2 && counts.iterations > 100.0);
        /* the error of a step is the rounding of positions, 5e-16, times a force of some 100, random over
         * 2000 steps; sweeps leave the tolerance, 1e-15, with one sign */
        CHECK_NEAR(most, 0.0, def.implicit.solver == DEM_SOLVER_SOR ? 2e-10 : 1e-11);
    }
}

/* Steps of ten contact times in a dense group, where a grain hits several others and Newton overshoots. */
static void long_steps(void)
{
    enum { N = 16 };
    dem_grain grains[N];
    for (int i = 0; i < N; i++)
        grains[i] = (dem_grain){1.2 * (i % 4) + 0.6 + 0.05 * (i / 4 % 2),
                                0.6 + 1.1 * (i / 4),
                                R,
                                1.0,
                                0.4 * (i % 2 ? 1.0 : -0.7),
                                0.2 * (i % 3 - 1)};
    dem_definition def = disks(grains, N, 10.0);
    def.gravity[1] = -0.2;
    for (int i = 0; i < N; i++) grains[i].vx *= sqrt(0.1), grains[i].vy *= sqrt(0.1);
    def.skin = 0.8;
    dem_box_walls(&def, 4.8, &def.material);
    scoped_sim *sim = grains_start(&def);
    const double before = grains_energy(sim);
    CHECK_OK(dem_run(sim, 300));
    CHECK_NEAR(grains_energy(sim), before, 1e-11);
}

/* Free disks conserve momentum at any tolerance, and angular momentum. */
static void momentum(void)
{
    for (int loose = 0; loose < 2; loose++) {
        dem_grain grains[3] = {
            {-0.7, 0.1, R, 1.0, 1.0, 0.0}, {0.7, -0.2, 0.6, 1.7, -1.0, 0.3}, {0.0, 1.2, 0.4, 0.6, 0.0, -1.0}};
        dem_definition def = disks(grains, 3, 0.7);
        def.gravity[1] = 0.0;
        def.implicit.tolerance = loose ? 1e-5 : 1e-15;
        scoped_sim *sim = grains_start(&def);
        dem_state s[3];
        double first[3] = {0.0};
        for (int n = 0; n <= 100; n++) {
            double p[3] = {0.0};
            dem_states(sim, s);
            for (const dem_state *i = s; i < s + 3; i++)
                p[0] += i->m * i->vx, p[1] += i->m * i->vy, p[2] += i->m * (i->x * i->vy - i->y * i->vx);
            if (n == 0) memcpy(first, p, sizeof p);
            for (int a = 0; a < (loose ? 2 : 3); a++) CHECK_NEAR(p[a], first[a], 1e-13);
            CHECK_OK(dem_run(sim, 1));
        }
        CU_ASSERT(fabs(s[0].vx - 1.0) > 0.1); /* they met */
    }
}

/* No step adds energy: dashpots with and without attractive forces, slip below and at its limit, wells. */
static void damping_takes_energy(void)
{
    static const double ratios[] = {0.05, 0.5, 3.0};
    for (int k = 0; k < 12; k++) {
        dem_grain grains[GAS];
        dem_definition def = gas(grains, ratios[k % 3]);
        def.tension = k / 3 % 2, def.material.gamma_n = 30.0;
        if (k / 6) def.tangential = DEM_SLIP_ROLL, def.material.gamma_s = 200.0, def.material.mu = 0.3;
        def.n_walls = 0;
        dem_box_walls(&def, 3.6, &def.material);
        scoped_sim *sim = grains_start(&def);
        double before = grains_energy(sim), fall = 0.0;
        const double start = before;
        for (long n = 0; n < 3000 && dem_sim_fault(sim) == DEM_FAULT_NONE; n++) {
            CHECK_OK(dem_run(sim, 1));
            const double now = grains_energy(sim);
            CU_ASSERT(now <= before + 1e-12);
            fall = start - now;
            before = now;
        }
        CU_ASSERT(fall > 1.0);
    }
}

/* Viscous slip without a friction limit acts during contact, half a period of an undamped linear spring: the
 * slip decays by exp(-gamma_s pi/omega), to second order, for any phase of contact within a step. */
static void slip_while_it_touches(void)
{
    const double gamma_s = 30.0, omega = sqrt(K), left = exp(-gamma_s * M_PI / omega);
    for (int k = 0; k < 8; k++) {
        dem_grain grain = {.x = 0.0, .y = R, .r = R, .m = 1.0, .vx = 1.0, .vy = -1.0};
        dem_definition def = on_floor(&grain, 1, 0.01);
        grain.y += (3.0 + k / 8.0) * def.dt;
        def.gravity[1] = 0.0, def.tangential = DEM_SLIP_ROLL;
        def.walls[0].material.gamma_s = gamma_s, def.walls[0].material.mu = INFINITY;
        scoped_sim *sim = grains_after(&def, lround(0.06 / def.dt));
        const dem_state s = grains_state_of_one(sim);
        CU_ASSERT(s.contacts == 0 && s.vy > 0.0);
        CHECK_NEAR(s.vx, left, omega * omega * def.dt * def.dt);
    }
}

/* The closed form printed in (24) assumes overlaps at both ends of a step. Written out for one bouncing disk:
 * with the printed form each opening changes the energy; the simulator conserves it. */
static void printed_form_loses_energy(void)
{
    const dem_grain grain = {.x = 0.0, .y = R + 0.01, .r = R, .m = 1.0, .vy = -0.5};
    dem_definition def = on_floor(&grain, 1, 0.2);
    def.gravity[1] = 0.0;
    scoped_sim *sim = grains_start(&def);
    double x = 0.01, v = -0.5; /* of its lowest point */
    const double dt = def.dt, c = 0.25 * dt * dt * K;
    for (int n = 0; n < 200; n++) {
        /* m (u - dt v) = dt^2/2 K (-x - u/2), if either end then is below the floor; or free */
        double u = dt * v;
        if (x < 0.0 || x + u < 0.0) u = (dt * v - 2.0 * c * x) / (1.0 + c);
        x += u;
        v = 2.0 * u / dt - v;
        CHECK_OK(dem_run(sim, 1));
    }
    CU_ASSERT(x > 0.0 && v > 0.0 && fabs(v / 0.5 - 1.0) > 1e-3);
    CHECK_NEAR(grains_state_of_one(sim).vy, 0.5, 1e-13);
}

/* A pile that settles on a sloping wall, a floor and a fixed grain. */
static dem_definition settling_pile(dem_grain *grains, size_t n)
{
    for (size_t i = 0; i < n; i++)
        grains[i] = (dem_grain){1.2 + 1.01 * (double)(i % 4) + 0.1 * (double)(i / 4 % 2),
                                R + 0.99 * (double)(i / 4), R, 1.0};
    grains[0].fixed = true;
    dem_definition def = on_floor(grains, n, 0.5);
    def.material.gamma_n = 20.0, def.n_walls = 2;
    for (size_t w = 0; w < 2; w++) def.walls[w] = grains_line(0.0, 0.0, 0.0, 1.0, &def.material);
    def.walls[1] = grains_line(4.9, 0.0, -0.6, 0.8, &def.material);
    return def;
}

static void sweeps_match_direct(void)
{
    enum { N = 12 };
    dem_grain grains[N];
    dem_definition def = settling_pile(grains, N);
    scoped_sim *direct = grains_start(&def);
    def.implicit.solver = DEM_SOLVER_SOR;
    static const double factors[] = {0.5, 0.9};
    for (int k = 0; k < 2; k++) {
        def.implicit.relaxation = factors[k];
        scoped_sim *sor = grains_start(&def);
        dem_state s[N], t[N];
        grains_run(direct, k == 0 ? 100 : 0, s);
        grains_run(sor, 100, t);
        for (int i = 0; i < N; i++) {
            CHECK_PAIRS(1e-12, {s[i].x, t[i].x}, {s[i].y, t[i].y});
            CHECK_NEAR(s[i].vx, t[i].vx, 1e-10);
        }
        CU_ASSERT(s[0].x == grains[0].x && s[0].vy == 0.0 && fabs(s[1].y - grains[1].y) > 1e-5);
    }
}

/* Factorisations and sweeps of the same settling pile and of a gas, counted once: a tolerance that asks for
 * more, or a step that goes astray, leads to the same state by more of them. */
static void work_of_both(void)
{
    static const struct {
        bool gas;
        double relaxation, tolerance; /* relaxation 0: direct */
        double iterations;
    } cases[] = {{false, 0.0, 1e-13, 474},  {false, 0.0, 1e-9, 350}, {false, 0.5, 1e-13, 6571},
                 {false, 0.9, 1e-12, 2140}, {false, 0.9, 1e-6, 828}, {true, 0.0, 1e-13, 830},
                 {true, 0.7, 1e-12, 9301},  {true, 0.7, 1e-6, 4019}};
    for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
        enum { N = 12 };
        dem_grain grains[N];
        dem_definition def = cases[c].gas ? gas(grains, 2.0) : settling_pile(grains, N);
        def.implicit.tolerance = cases[c].tolerance;
        if (cases[c].relaxation > 0.0)
            def.implicit.solver = DEM_SOLVER_SOR, def.implicit.relaxation = cases[c].relaxation;
        scoped_sim *sim = grains_after(&def, 200);
        CHECK_NEAR(grains_counts(sim).iterations, cases[c].iterations, 0.0);
    }
}

static void what_is_not_solved(void)
{
    enum { N = 12 };
    dem_grain grains[N];
    dem_definition def = settling_pile(grains, N);
    def.material.gamma_n = 0.0;
    def.dt *= 10.0;
    def.implicit = (dem_implicit_solver){DEM_SOLVER_SOR, 1.9, 1e-12, 300};
    scoped_sim *sim = grains_start(&def);
    CHECK_FAILS(dem_run(sim, 100), RP_BROKEN, "after 300 sweeps its own Newton step is");
    CU_ASSERT_EQUAL(dem_sim_fault(sim), DEM_FAULT_NOT_SOLVED);
    def.implicit = (dem_implicit_solver){DEM_SOLVER_DIRECT, 0.7, 1e-12, 1};
    grains_again(&sim, &def, 0);
    CHECK_FAILS(dem_run(sim, 100), RP_BROKEN, "after 1 factorisations");
    CU_ASSERT(grains_counts(sim).iterations == 1.0);
    grains[11].vx = 0.11 / def.dt; /* the skin is 0.2 */
    def.implicit.max_iterations = 100;
    grains_again(&sim, &def, 0);
    CHECK_FAILS(dem_run(sim, 100), RP_BROKEN, "in one step, half the skin is 0.1");
    CU_ASSERT_EQUAL(dem_sim_fault(sim), DEM_FAULT_TOO_FAST);
}

/* The tolerance limits the displacement that the residual of a grain implies for this grain alone, over its
 * radius. A contact at rest with overlap d begins with the residual c K d, c = dt^2/2, and has the stiffness
 * K/2 + gamma m_eff/dt; one of two grains at distance r has K d/(2 r) less, as it turns. */
static void what_the_tolerance_asks(void)
{
    const double d = 5e-4, soft = 1.0, gamma = 0.7, dt = 1.3, c = 0.5 * dt * dt;
    for (int k = 0; k < 8; k++) {
        const bool pair = k & 1, enough = k & 2;
        const dem_grain grains[2] = {{.x = 0.3, .y = R - d, .r = R, .m = 1.7},
                                     {.x = 0.3 + R + 0.4 - d, .y = R - d, .r = 0.4, .m = 0.6}};
        const dem_grain *worst = &grains[pair];
        dem_definition def = on_floor(grains, pair ? 2 : 1, 1.0);
        if (pair) def.n_walls = 0;
        def.gravity[1] = 0.0, def.dt = dt, def.material.k_n = def.walls[0].material.k_n = soft;
        def.material.gamma_n = def.walls[0].material.gamma_n = gamma;
        def.implicit.solver = k / 4;
        const double m_eff = pair ? 1.7 * 0.6 / 2.3 : worst->m,
                     turn = pair ? soft * d / (2.0 * (0.9 - d)) : 0.0;
        const double stiffness = 0.5 * soft + gamma * m_eff / dt - turn;
        const double asked = c * soft * d / (worst->r * (worst->m + c * stiffness));
        def.implicit.tolerance = asked * (enough ? 1.0 + 1e-9 : 1.0 - 1e-9);
        scoped_sim *sim = grains_after(&def, 1);
        CU_ASSERT(enough == (grains_counts(sim).iterations == 0.0));
    }
}

/* A clone, another kernel of the pair loop, a new list and an added grain. */
static void same_bits(void)
{
    for (int solver = 0; solver < 2; solver++) {
        dem_grain grains[GAS];
        dem_definition def = gas(grains, 0.5);
        def.implicit.solver = solver;
        scoped_sim *a = grains_start(&def), *b = NULL, *c = NULL;
        def.kernel = DEM_REFERENCE;
        c = grains_start(&def);
        CHECK_OK(dem_run(a, 500));
        CHECK_OK(dem_clone(a, &b));
        CHECK_OK(dem_run(a, 500));
        CHECK_OK(dem_run(b, 500));
        CHECK_OK(dem_run(c, 1000));
        CU_ASSERT(grains_same_bits(a, b) && grains_same_bits(a, c));
        const dem_grain late = {.x = 1.8, .y = 6.0, .r = 0.4, .m = 0.5};
        CHECK_OK(dem_add(a, &late, NULL));
        const double before = grains_energy(a);
        CHECK_OK(dem_run(a, 500));
        CHECK_NEAR(grains_energy(a), before, 1e-11);
    }
}

/* A disk goes in the step in which it leaves, whichever of the two it is. */
static void disks_leave(void)
{
    for (int first = 0; first < 2; first++) {
        const dem_grain two[] = {{.x = 1.0, .y = 1.0, .r = R, .m = 1.0, .vx = first ? 0.0 : 30.0},
                                 {.x = 1.0, .y = 4.0, .r = R, .m = 1.0, .vx = first ? 30.0 : 0.0}};
        dem_definition def = disks(two, 2, 0.5);
        def.x_max = 2.0, def.skin = 1.0;
        scoped_sim *sim = grains_start(&def);
        for (int k = 1; k < 20; k++) {
            CHECK_OK(dem_run(sim, 1));
            CU_ASSERT_EQUAL(dem_count(sim), 1.0 + 30.0 * def.dt * k < 2.0 ? 2 : 1);
        }
        CU_ASSERT_EQUAL(dem_count(sim), 1);
    }
}

static void refusals(void)
{
    const dem_grain grain = {.x = 0.0, .y = 2.0, .r = R, .m = 1.0};
    scoped_sim *sim = NULL;
#define REFUSES(change, text)                                                                                \
    do {                                                                                                     \
        dem_definition def = on_floor(&grain, 1, 1.0);                                                       \
        change;                                                                                              \
        CHECK_FAILS(dem_create(&def, &sim), RP_BAD_INPUT, text);                                             \
    } while (0)
    REFUSES(def.rotation = true, "rotation: grains that rotate need the integrator verlet");
    REFUSES((def.tangential = DEM_SPRING, def.material.k_s = def.walls[0].material.k_s = 1.0),
            "has no tangential law spring");
    REFUSES((def.tension = false, def.hard.on = true), "hard: collisions need the integrator verlet");
    REFUSES(def.walls[0].extent[1] = 5.0,
            "wall 1: extent = [-inf, 5]: the integrator implicit needs infinite lines");
    REFUSES(def.box_turn_per_step = 0.01, "the integrator implicit needs walls that stand");
    REFUSES((def.implicit.solver = DEM_SOLVER_SOR, def.implicit.relaxation = 2.0),
            "relaxation = 2: out of range");
    REFUSES(def.implicit.tolerance = 0.0, "tolerance = 0: out of range");
    REFUSES(def.implicit.tolerance = NAN, "tolerance = nan: out of range");
    REFUSES(def.implicit.max_iterations = 0, "max_iterations = 0: out of range");
#undef REFUSES
    dem_definition def = on_floor(&grain, 1, 1.0);
    sim = grains_start(&def);
    dem_box_turn(sim, 0.01);
    CHECK_FAILS(dem_run(sim, 1), RP_BAD_INPUT, "the integrator implicit needs walls that stand");
}

CHECK_SUITE(midpoint, "implicit integrator", slides_and_creeps, well_conserves, well_follows_load,
            energy_of_gas, long_steps, momentum, damping_takes_energy, slip_while_it_touches,
            printed_form_loses_energy, sweeps_match_direct, work_of_both, what_the_tolerance_asks,
            what_is_not_solved, same_bits, disks_leave, refusals)
