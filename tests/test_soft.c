/* Soft particles on a ground, and how hard collisions become soft contacts: against closed forms. Lengths in
 * diameters, masses in those of a disk, g = 1. */
#include "dem/law/law.h"
#include "tests/grains.h"

static const double R = 0.5, K = 1e3, MU_STATIC = 0.3, A = 0.02;

/* Disks above a ground through the origin; the tangential law is slip_roll. */
static dem_definition on_ground(const dem_grain *grains, size_t n)
{
    dem_definition def = dem_definition_default();
    def.gravity[1] = -1.0, def.dt = 2e-3, def.normal = DEM_LINEAR;
    def.tension = false, def.shape = DEM_DISK, def.tangential = DEM_SLIP_ROLL;
    def.material = (dem_material){.k_n = K, .gamma_n = 20.0, .gamma_s = 5.0, .mu = 0.1};
    def.ground = (dem_ground){.wall = 1, .mu_static = MU_STATIC, .a = A, .set = DEM_WELL_REST};
    grains_on_floor(&def, n, grains);
    return def;
}

/* In vertical equilibrium. */
static dem_grain resting(void)
{
    return (dem_grain){.x = 0.3, .y = R - 1.0 / K, .r = R, .m = 1.0};
}

static long collisions(const dem_sim *sim)
{
    return grains_counts(sim).collisions;
}

/* (45): a disk sinks by m g/K; a column of four by the weight above. */
static void sinks_by_its_weight(void)
{
    dem_grain grains[4];
    for (int i = 0; i < 4; i++) grains[i] = (dem_grain){.x = 0.1, .y = R + i, .r = R, .m = 1.0};
    dem_definition def = on_ground(grains, 4);
    scoped_sim *sim = grains_after(&def, 40000);
    size_t n;
    scoped dem_contact *list = grains_contacts(sim, &n);
    CU_ASSERT_EQUAL(n, 4);
    for (size_t k = 0; k < n; k++) {
        const double load = list[k].wall == 0 ? 4.0 : 4.0 - fmin(list[k].id_a, list[k].id_b);
        /* round-off of positions, 1e-16, times K; the slowest oscillation has decayed */
        CHECK_NEAR(list[k].normal_force, load, 1e-10);
        CHECK_NEAR(list[k].overlap, load / K, 1e-13);
    }
}

/* Under slow loading the well holds the disk up to mu N, at the displacement m g_x a/(mu N). Beyond, the well
 * breaks, and the disk slips at g_x/gamma_s if the viscous force is below the limit. */
static void well_holds_and_breaks(void)
{
    const dem_grain grain = resting();
    dem_definition def = on_ground(&grain, 1);
    def.material.mu = def.walls[0].material.mu = 10.0, def.ground.set = DEM_WELL_AGAIN;
    scoped_sim *sim = grains_start(&def);
    for (int k = 1; k <= 99; k++) {
        dem_gravity_set(sim, (double[]){0.01 * k * MU_STATIC, -1.0});
        CHECK_OK(dem_run(sim, k % 33 == 0 ? 8000 : 2000));
        if (k % 33) continue;
        const dem_contact c = grains_only_contact(sim);
        CU_ASSERT_EQUAL(c.well, DEM_WELL_HOLDS);
        CHECK_NEAR(c.shear_spring, 0.01 * k * A,
                   1e-9); /* the last oscillation has decayed as exp(-gamma_s t/2) */
        CHECK_NEAR(c.shear_force, -0.01 * k * MU_STATIC, 1e-7);
        CHECK_NEAR(grains_state_of_one(sim).x, grain.x + 0.01 * k * A, 1e-9);
    }
    dem_gravity_set(sim, (double[]){1.01 * MU_STATIC, -1.0});
    for (int k = 0; k < 2000 && grains_only_contact(sim).well == DEM_WELL_HOLDS; k++)
        CHECK_OK(dem_run(sim, 1));
    CU_ASSERT(pow(grains_state_of_one(sim).vx, 2.0) <
              0.1 * MU_STATIC * A); /* slow, but still moving upwards */
    for (int k = 0; k < 100; k++) {
        CU_ASSERT_EQUAL(grains_only_contact(sim).well, DEM_WELL_BROKEN);
        CHECK_OK(dem_run(sim, 1));
    }
    dem_gravity_set(sim, (double[]){3.0 * MU_STATIC, -1.0});
    CHECK_OK(dem_run(sim, 20000));
    CU_ASSERT_EQUAL(grains_only_contact(sim).well, DEM_WELL_BROKEN);
    CHECK_NEAR(grains_state_of_one(sim).vx, 3.0 * MU_STATIC / 5.0, 1e-12);
}

/* A well's stiffness mu_static w/a, w the weight of the grain or of a column as high as it falls from, limits
 * the step to 0.85 of 4/sqrt(12 k/m), where it is the stiffest. */
static void limit_of_a_well(void)
{
    for (int high = 0; high < 2; high++) {
        const double m = 1.7, height = high ? 2.2 : R;
        const dem_grain grain = {.x = 0.3, .y = height, .r = R, .m = m};
        dem_definition def = on_ground(&grain, 1);
        def.ground.a = 1e-6;
        const double weight = m * (high ? 2.0 * height / (4.0 * R) : 1.0);
        dem_limit_name what;
        CHECK_NEAR(dem_time_step_limit(&def, what) / (3.4 / sqrt(12.0 * MU_STATIC * weight / (1e-6 * m))),
                   1.0, 1e-14);
        CU_ASSERT_STRING_EQUAL(what, "the lightest grain in a well of the ground");
    }
}

/* A new simulation from a saved state keeps the displacement in the well and the force. The energy of the
 * well is mu_static N x^2/(2 a), in addition to that of the overlap. */
static void well_of_the_start(void)
{
    dem_grain grain = resting();
    dem_definition def = on_ground(&grain, 1);
    def.gravity[0] = 0.2 * MU_STATIC, def.gravity[1] = -0.5;
    scoped_sim *sim = grains_after(&def, 8000);
    const dem_contact held = grains_only_contact(sim);
    const dem_state s = grains_state_of_one(sim);
    const dem_energy energy = grains_energies(sim);
    const double well = 0.5 * MU_STATIC * held.normal_force / A * held.shear_spring * held.shear_spring;
    CHECK_NEAR(energy.elastic, 0.5 * K * held.overlap * held.overlap + well, 1e-15);
    CU_ASSERT(held.well == DEM_WELL_HOLDS && held.shear_spring > 0.3 * A);
    grain = (dem_grain){.x = s.x, .y = s.y, .r = R, .m = 1.0, .vx = s.vx, .vy = s.vy};
    def.contacts = &held, def.n_contacts = 1;
    grains_again(&sim, &def, 0);
    const dem_contact again = grains_only_contact(sim);
    CU_ASSERT(again.well == DEM_WELL_HOLDS);
    CHECK_NEAR(again.shear_spring, held.shear_spring, 1e-15);
    CHECK_NEAR(again.shear_force, held.shear_force, 1e-15 * MU_STATIC / A);
}

/* Without other friction a disk in its well is a harmonic oscillator, omega^2 = mu_static g/a; it leaves the
 * well with the excess of its energy over the depth mu N a/2. */
static void energy_of_well(void)
{
    const double omega = sqrt(MU_STATIC / A), escape = sqrt(MU_STATIC * A);
    for (int leaves = 0; leaves < 2; leaves++) {
        dem_grain grain = resting();
        grain.vx = leaves ? 1.3 * escape : 0.8 * escape;
        dem_definition def = on_ground(&grain, 1);
        def.tangential = DEM_NONE, def.material.mu = def.walls[0].material.mu = 0.0;
        def.ground.set = DEM_WELL_TOUCH;
        scoped_sim *sim = grains_start(&def);
        const double before = grains_energy(sim), error = pow(omega * def.dt, 2.0);
        for (long step = 1; step <= lround(2.0 * M_PI / (omega * def.dt)); step++) {
            CHECK_OK(dem_run(sim, 1));
            if (leaves) continue;
            const double t = (double)step * def.dt;
            CHECK_NEAR(grains_state_of_one(sim).x - grain.x, 0.8 * A * sin(omega * t), error * A);
            CHECK_NEAR(grains_energy(sim) - before, 0.0, error * 0.5 * escape * escape);
        }
        CU_ASSERT_EQUAL(grains_only_contact(sim).well, leaves ? DEM_WELL_BROKEN : DEM_WELL_HOLDS);
        /* the force ends within a step of a: an error of first order, omega dt of the depth */
        if (leaves) CHECK_NEAR(grains_state_of_one(sim).vx / escape, sqrt(1.3 * 1.3 - 1.0), omega * def.dt);
    }
}

/* When a sliding disk gets its well, and whether it gets another. */
static void when_wells_are_set(void)
{
    for (int set = DEM_WELL_TOUCH; set <= DEM_WELL_AGAIN; set++) {
        dem_grain grain = resting();
        grain.vx = 2.0;
        dem_definition def = on_ground(&grain, 1);
        def.ground.set = set;
        scoped_sim *sim = grains_after(&def, 5);
        CU_ASSERT_EQUAL(grains_only_contact(sim).well,
                        set == DEM_WELL_TOUCH ? DEM_WELL_HOLDS : DEM_WELL_NONE);
        CHECK_OK(dem_run(sim, 40000));
        CU_ASSERT_EQUAL(grains_only_contact(sim).well,
                        set == DEM_WELL_TOUCH ? DEM_WELL_BROKEN : DEM_WELL_HOLDS);
        const double x = grains_state_of_one(sim).x;
        if (set != DEM_WELL_TOUCH) CHECK_NEAR(grains_only_contact(sim).shear_spring, 0.0, 1e-9);
        /* a force beyond the limit, then none: at rest again */
        dem_gravity_set(sim, (double[]){1.5 * MU_STATIC, -1.0});
        CHECK_OK(dem_run(sim, 1000));
        dem_gravity_set(sim, (double[]){0.0, -1.0});
        CHECK_OK(dem_run(sim, 20000));
        CU_ASSERT_EQUAL(grains_only_contact(sim).well,
                        set == DEM_WELL_AGAIN ? DEM_WELL_HOLDS : DEM_WELL_BROKEN);
        CU_ASSERT(grains_state_of_one(sim).x > x + A);
    }
}

/* Slip below its limit decays as exp(-gamma_s t); above it the deceleration is mu g. */
static void slip_is_viscous_then_capped(void)
{
    dem_grain grain = resting();
    grain.vx = 0.7;
    dem_definition def = on_ground(&grain, 1);
    def.ground.wall = 0, def.material.mu = def.walls[0].material.mu = 10.0;
    scoped_sim *sim = grains_after(&def, 500);
    CHECK_NEAR(grains_state_of_one(sim).vx / (0.7 * exp(-5.0)), 1.0,
               0.6 * 25.0 * def.dt); /* gamma^2 dt t/2, t = 1 */
    def.walls[0].material.mu = 0.1;
    grains_again(&sim, &def, 500);
    CHECK_NEAR(grains_state_of_one(sim).vx, 0.7 - 0.1, 1e-12);
}

/* A disk that slides, or spins without translation, ends up rolling: with arm b, q = I/(m b^2), a speed
 * v_0/(1 + q) or q b omega_0/(1 + q). A spin never grows beyond rolling, as it would with (36) as printed. */
static void slides_then_rolls(void)
{
    const double b = R - 1.0 / K, q = 0.5 * R * R / (b * b);
    for (int spins = 0; spins < 2; spins++) {
        dem_grain grain = resting();
        grain.vx = spins ? 0.0 : 2.0;
        grain.omega = spins ? -6.0 : 0.0;
        dem_definition def = on_ground(&grain, 1);
        def.rotation = true, def.ground.wall = 0;
        scoped_sim *sim = grains_start(&def);
        double last = grains_energy(sim), least = 0.0;
        for (int k = 0; k < 40; k++) {
            CHECK_OK(dem_run(sim, 500));
            CU_ASSERT(grains_energy(sim) <= last * (1.0 + 1e-12));
            last = grains_energy(sim);
            least = fmin(least, grains_state_of_one(sim).omega);
            if (k == 0) CHECK_NEAR(grains_state_of_one(sim).vx, spins ? 0.1 : 1.9, 1e-12);
        }
        const dem_state s = grains_state_of_one(sim);
        const double rolls = (spins ? q * b * 6.0 : 2.0) / (1.0 + q);
        CHECK_PAIRS(1e-9, {s.vx, rolls}, {s.omega, -rolls / b});
        CU_ASSERT(least >= (spins ? -6.0 : s.omega - 1e-9));
    }
}

/* A disk of radius and mass 1 under the slip force -(v + omega) alone, by Euler's method, its torque `sign`
 * times the force: its energy after, over that before. */
static double spun_by(double sign)
{
    double v = 0.3, omega = 2.0;
    for (int k = 0; k < 1000; k++) {
        const double f = -(v + omega);
        v += 1e-3 * f;
        omega += 1e-3 * sign * f / 0.5;
    }
    return (v * v + 0.5 * omega * omega) / (0.3 * 0.3 + 0.5 * 2.0 * 2.0);
}

/* Farthest that a disk gets from the middle of a well, in half-widths, which it starts at 0.1 of: force
 * `sign` (mu_static N/a) u. */
static double strays(double sign)
{
    double u = 0.1, v = 0.0, most = 0.0;
    for (int k = 0; k < 10000; k++) {
        v += 1e-3 * sign * (fabs(u) <= 1.0 ? u : 0.0);
        u += 1e-3 * v;
        most = fmax(most, fabs(u));
    }
    return most;
}

/* Consequences of the soft particles' equations as printed. */
static void misprints(void)
{
    /* (36): the torque has the sign that speeds a spinning disk up */
    CU_ASSERT(spun_by(1.0) < 1.0 && spun_by(-1.0) > 1.0);
    /* (33) with (34): n = (0, 1) on the ground, so F_x = -F_t, and the well of (30) pushes outwards */
    CU_ASSERT(strays(-1.0) < 0.101 && strays(1.0) > 1.0);
    /* (30): a disk at rest in the middle, x_k = x_(k+1) = x0, feels a force; with a plus sign none */
    const double x0 = 4.0;
    CU_ASSERT(-MU_STATIC / A * ((x0 - x0) / 2.0 - x0) > MU_STATIC);
    CU_ASSERT(-MU_STATIC / A * ((x0 + x0) / 2.0 - x0) == 0.0);
    /* (25): two disks that separate fast attract one another */
    const double k_s = 1e3, k_d = 10.0, overlap = 1e-3, parting = 0.5;
    CU_ASSERT(k_s * overlap - k_d * parting < 0.0);
    CU_ASSERT(dem_law_normal(DEM_LINEAR, false, k_s, k_d, 1.0, overlap, parting) == 0.0);
}

/* (29) and (32) as printed: friction of one sense only, whatever the slip, and the lesser of two numbers
 * rather than of two magnitudes. A disk at rest feels a force, and the limit does not hold. The simulator
 * uses (27), truncated at (29) and opposed to the slip. */
static void misprints_of_slip(void)
{
    const double m = 0.7, gamma = 5.0, k_slip = gamma * m, mu_roll = 0.2, F_n = 5.0, cap = mu_roll * F_n;
    const dem_slider c = dem_slider_of(DEM_TRUNCATED, DEM_DAMPING_OUTSIDE, 1.0, gamma, mu_roll);
    for (int k = -4; k <= 4; k++) {
        const double v = 0.26 * k, printed = fmin(-k_slip * v, -cap);
        CHECK_NEAR(dem_law_slip(c, m, v, F_n, 0.0, NULL), -fmax(fmin(k_slip * v, cap), -cap), 1e-15);
        CHECK_NEAR(dem_law_slip(c, m, v, -F_n, 0.0, NULL), 0.0, 0.0); /* no friction where it pulls */
        if (k <= 0) CU_ASSERT(printed * v >= 0.0 && printed < 0.0);   /* along the slip, or without any */
        if (k == 4) CU_ASSERT(fabs(printed) > 3.0 * cap);
    }
}

/* (22) as printed uses the speed that F gives in one step; but a disk that leaves the ground at v is back
 * on it after 2 v/g only, and not after v/g. */
static void misprint_of_flight(void)
{
    const double v = 0.7, g = 9.3, flight = 2.0 * v / g;
    for (int k = 1; k < 10; k++) {
        const double dt = 0.2 * k * v / g + 1e-9, height = v * dt - 0.5 * g * dt * dt;
        const bool printed = dt > v / g;
        CU_ASSERT((height < 0.0) == (dt > flight));
        if (printed && dt < flight) CU_ASSERT(height > 0.0); /* soft, and not in contact */
    }
}

/* Lee & Herrmann's (2b) with the numbers in its minimum rather than magnitudes, and without F_n >= 0: to the
 * left the spring is not limited, and with an attractive normal force it drives the slip. */
static void misprints_of_spring(void)
{
    const double k_s = 10.0, mu = 0.2;
    for (int side = -1; side <= 1; side += 2)
        for (int pulls = 0; pulls < 2; pulls++) {
            const double F_n = pulls ? -2.0 : 2.0, ds = 0.3 * side, cap = mu * fmax(F_n, 0.0);
            double spring = ds;
            const double printed = -side * fmin(k_s * ds, mu * F_n),
                         ours = dem_law_shear(dem_slider_of(DEM_TRUNCATED, DEM_DAMPING_OUTSIDE, k_s, 0.0, mu),
                                              1.0, 0.0, F_n, 0.0, &spring);
            CHECK_NEAR(ours, -side * cap, 1e-15);
            if (side > 0) CU_ASSERT(pulls ? printed > 0.0 : printed == ours); /* along ds: propulsive */
            if (side < 0) CHECK_NEAR(printed, k_s * ds, 1e-15); /* to the left too, without limit */
        }
}

/* A disk dropped onto the ground, or onto a fixed disk, bounces by hard collisions. Each bounce loses 1 - e^2
 * of its energy, to round-off, at the times v (1 + 2e + 2e^2 + ...)/g: leapfrog is exact in free flight, and
 * so are collision times. Below the speed (22) of a step of gravity it rests at the overlap m g/K. */
static void switches_to_soft(void)
{
    static const double restitution[] = {0.3, 0.6, 0.93};
    for (int k = 0; k < 6; k++) {
        const bool onto_disk = k >= 3;
        const double e = restitution[k % 3], h = 0.7, v = sqrt(2.0 * h), top = onto_disk ? 3.0 * R : R;
        const dem_grain grains[2] = {{.x = 0.3, .y = top + h, .r = R, .m = 1.0},
                                     {.x = onto_disk ? 0.3 : 9.0, .y = R, .r = R, .m = 1.0, .fixed = true}};
        dem_definition def = on_ground(grains, 2);
        def.hard = (dem_hard){true, e, 0.4};
        scoped_sim *sim = grains_start(&def);
        dem_state s[2];
        long seen = 0;
        double when = -v;
        for (long step = 0; step < 40000; step++) {
            CHECK_OK(dem_run(sim, 1));
            if (collisions(sim) == seen) continue;
            when += 2.0 * v * pow(e, (double)seen);
            seen = collisions(sim);
            CHECK_NEAR(dem_time(sim), when + 0.5 * def.dt, 0.5 * def.dt + 1e-9);
            CHECK_OK(dem_states(sim, s));
            const double w = v * pow(e, (double)seen);
            CU_ASSERT(w > e * def.dt);
            if (w > def.dt) /* otherwise the return may fall within the step and is soft */
                CHECK_NEAR(0.5 * s[0].vy * s[0].vy + s[0].y - top, 0.5 * w * w, 1e-12);
        }
        CU_ASSERT_EQUAL(seen, 1 + (long)floor(log(def.dt / v) / log(e)));
        CHECK_NEAR(grains_only_contact(sim).overlap, 1.0 / K, 1e-13);
    }
}

/* In a run two free disks, one of them fixed, or a disk and a wall collide at the moment of contact:
 * velocities there are those of dem_impact, and positions lie on straight lines through that moment. */
static void collide_in_flight(void)
{
    for (int fixed = 0; fixed < 2; fixed++) {
        dem_grain grains[2] = {{0.0, 2.0, 0.5, 1.0, 3.0, 0.7, 0.0, 2.0, false},
                               {1.3, 2.4, 0.4, 0.6, -1.0, 0.0, 0.0, -3.0, false}};
        if (fixed) grains[1] = (dem_grain){1.3, 2.4, 0.4, 0.6, .fixed = true};
        dem_definition def = on_ground(grains, 2);
        def.gravity[1] = 0.0, def.rotation = true;
        def.hard = (dem_hard){true, 0.8, 0.15};
        const double dx = -1.3, dy = -0.4, vx = 3.0 - grains[1].vx, vy = 0.7;
        const double bv = dx * vx + dy * vy, c = dx * dx + dy * dy - 0.81, v2 = vx * vx + vy * vy;
        const double t = (-bv - sqrt(bv * bv - v2 * c)) / v2;
        const double n[2] = {-(dx + vx * t) / 0.9, -(dy + vy * t) / 0.9};
        dem_body bodies[2];
        for (int i = 0; i < 2; i++) {
            const dem_grain *p = &grains[i];
            bodies[i] = (dem_body){
                {p->vx, p->vy}, p->omega, p->r, 1.0 / p->m, 1.0 / dem_inertia(DEM_DISK, p->m, p->r)};
            if (p->fixed) bodies[i].inverse_mass = bodies[i].inverse_inertia = 0.0;
        }
        dem_impulse impulse;
        CU_ASSERT(dem_impact(&bodies[0], &bodies[1], n, 0.8, 0.15, &impulse));
        scoped_sim *sim = grains_start(&def);
        const double end = 200 * def.dt;
        dem_state s[2];
        grains_run(sim, 200, s);
        CU_ASSERT(collisions(sim) == 1 && t < end);
        for (int i = 0; i < 2; i++) {
            const dem_body *b = &bodies[i];
            const double x = grains[i].x + grains[i].vx * t, y = grains[i].y + grains[i].vy * t;
            CHECK_PAIRS(1e-12, {s[i].vx, b->v[0]}, {s[i].vy, b->v[1]}, {s[i].x, x + b->v[0] * (end - t)},
                        {s[i].y, y + b->v[1] * (end - t)});
            CHECK_PAIRS(1e-11, {s[i].omega, b->omega},
                        {s[i].angle, grains[i].omega * t + b->omega * (end - t)});
        }
    }
    /* onto the ground: t = 0.5 / 2 */
    const dem_grain grain = {0.0, 1.0, 0.5, 1.0, 1.0, -2.0};
    dem_definition def = on_ground(&grain, 1);
    def.gravity[1] = 0.0;
    def.hard = (dem_hard){true, 0.5, 0.1};
    scoped_sim *sim = grains_after(&def, 300);
    const dem_state s = grains_state_of_one(sim);
    const double after = 300 * def.dt - 0.25;
    CHECK_PAIRS(1e-12, {s.vy, 1.0}, {s.vx, 1.0 - 0.1 * 3.0}, {s.y, 0.5 + after}, {s.x, 0.25 + 0.7 * after});
}

/* An impulse on the end of a row passes through it within a step, for any order of the pairs. */
static void passes_through_a_row(void)
{
    enum { N = 5 };
    for (int side = -1; side <= 1; side += 2) {
        dem_grain grains[N];
        for (int i = 0; i < N; i++)
            grains[i] = (dem_grain){.x = side * i * (1.0 + 1e-5), .y = 3.0, .r = R, .m = 1.0};
        grains[0].vx = 2.0 * side;
        dem_definition def = on_ground(grains, N);
        def.gravity[1] = 0.0;
        def.hard = (dem_hard){true, 1.0, 0.0};
        scoped_sim *sim = grains_start(&def);
        dem_state s[N];
        grains_run(sim, 1, s);
        CU_ASSERT_EQUAL(collisions(sim), N - 1);
        for (int i = 0; i < N; i++) CHECK_NEAR(s[i].vx, i == N - 1 ? 2.0 * side : 0.0, 1e-12);
        /* with contacts in between, the total displacement is 2 dt minus the gaps */
        CHECK_NEAR(side * s[N - 1].x, 4.0 * (1.0 + 1e-5) + 2.0 * def.dt - 4e-5, 1e-12);
    }
}

/* Impulses against the order of pairs need a round per pair, of at most eight; other pairs collide softly. */
static void rounds_end(void)
{
    enum { N = 12 };
    long found[2];
    for (int side = 0; side < 2; side++) {
        dem_grain grains[N];
        for (int i = 0; i < N; i++) grains[i] = (dem_grain){.y = 3.0 - i * (1.0 + 1e-5), .r = R, .m = 1.0};
        grains[side ? N - 1 : 0].vy = side ? 2.0 : -2.0;
        dem_definition def = on_ground(grains, N);
        def.gravity[1] = 0.0, def.n_walls = def.ground.wall = 0;
        def.hard = (dem_hard){true, 1.0, 0.0};
        scoped_sim *sim = grains_after(&def, 1);
        found[side] = collisions(sim);
    }
    /* all in one round upwards; downwards a few pairs of the list follow the ones before them */
    CU_ASSERT(found[1] == N - 1 && found[0] >= 8 && found[0] < N - 1);
}

/* A disk passes over a fixed one on a parabola of height g dt^2/8 within the step. The chord of the step
 * intersects the fixed disk, by up to that height; the parabola misses it. */
static void arc_over_a_disk(void)
{
    for (int k = 1; k < 60; k++) {
        dem_grain grains[2] = {{.y = 3.0, .r = R, .m = 1.0, .fixed = true}, {.r = R, .m = 1.0, .vx = 8.0}};
        dem_definition def = on_ground(grains, 2);
        grains[1].x = -0.5 * grains[1].vx * def.dt * (0.7 + 0.01 * k);
        grains[1].y = 4.0 - def.dt * def.dt / 8.0 * k / 30.0; /* its top is at 4 for k = 30 */
        grains[1].vy = 0.5 * def.dt;                          /* returns to its initial height */
        def.hard = (dem_hard){true, 1.0, 0.0};
        scoped_sim *sim = grains_after(&def, 1);
        /* a slight intersection has too small an approach speed for a hard collision, (22) */
        if (k < 30 || k > 32) CU_ASSERT((collisions(sim) > 0) == (k > 30));
    }
}

/* Far from the origin, where positions are rounded to 1e-8, a touching pair collides as at the origin. */
static void far_from_the_origin(void)
{
    GRAINS_EACH_KERNEL (kernel, DEM_REFERENCE) {
        for (int k = 0; k < 20; k++) {
            const double x = k * 5e6;
            dem_grain grains[2] = {{.x = x, .y = 3.0, .r = R, .m = 1.0, .vx = 20.0 + k},
                                   {.x = x + 0.75, .y = 3.0, .r = 0.25, .m = 0.25, .vx = -10.0}};
            dem_definition def = on_ground(grains, 2);
            def.gravity[1] = 0.0, def.n_walls = def.ground.wall = 0, def.kernel = kernel;
            def.hard = (dem_hard){true, 1.0, 0.0};
            scoped_sim *sim = grains_after(&def, 1);
            CU_ASSERT(collisions(sim) == 1);
        }
    }
}

/* The sign of a zero is unchanged too. */
static void fixed_stay_to_the_bit(void)
{
    enum { N = 12 };
    GRAINS_EACH_KERNEL (kernel, DEM_REFERENCE) {
        dem_grain grains[N];
        for (int i = 0; i < N; i++)
            grains[i] = (dem_grain){.x = -2.0 * i, .y = -0.0, .r = R, .m = 1.0, .fixed = i < N - 1};
        dem_definition def = on_ground(grains, N);
        def.n_walls = def.ground.wall = 0, def.kernel = kernel;
        def.hard = (dem_hard){true, 1.0, 0.0};
        scoped_sim *sim = grains_after(&def, 3);
        scoped dem_state *states = grains_states(sim);
        for (int i = 0; i < N - 1; i++) CU_ASSERT(states[i].y == 0.0 && signbit(states[i].y));
        CU_ASSERT(states[N - 1].y < 0.0);
    }
}

/* A rotating box: its ground, below the axis, moves to the left. A disk that moves with the ground is at
 * rest, a disk that moves against it is not. */
static void rests_on_a_ground_that_moves(void)
{
    const double speed = 0.1, below = 5.0;
    for (int against = 0; against < 2; against++) {
        dem_grain g = resting();
        g.y -= below;
        g.vx = against ? speed : -speed;
        dem_definition def = on_ground(&g, 1);
        def.walls[0].point[1] = -below, def.box_turn_per_step = speed / below * def.dt;
        scoped_sim *sim = grains_after(&def, 3);
        CU_ASSERT_EQUAL(grains_only_contact(sim).well, against ? DEM_WELL_NONE : DEM_WELL_HOLDS);
    }
}

/* A spinning disk is at rest if its rotational energy, twice omega^2/8, is below the depth of the well. */
static void rests_while_it_turns(void)
{
    const double most = sqrt(8.0 * MU_STATIC * A);
    for (int fast = 0; fast < 2; fast++) {
        dem_grain g = resting();
        g.omega = most * (fast ? 1.01 : 0.99);
        dem_definition def = on_ground(&g, 1);
        def.rotation = true;
        scoped_sim *sim = grains_start(&def);
        CU_ASSERT_EQUAL(grains_only_contact(sim).well, fast ? DEM_WELL_NONE : DEM_WELL_HOLDS);
    }
}

/* At zero overlap grains are not in contact: the dashpot does not act. */
static void touching_is_no_contact(void)
{
    GRAINS_EACH_KERNEL (kernel, DEM_FAST) {
        const dem_grain grains[2] = {{.y = 3.0, .r = R, .m = 1.0, .vy = -2.0}, {.y = 2.0, .r = R, .m = 1.0}};
        dem_definition def = on_ground(grains, 2);
        def.kernel = kernel, def.gravity[1] = 0.0;
        scoped_sim *sim = grains_start(&def);
        scoped dem_state *s = grains_states(sim);
        CU_ASSERT(s[0].contacts == 0 && s[0].fy == 0.0 && s[1].fy == 0.0);
    }
}

/* A contact at the very end of a step collides in that step; all numbers here are exact. */
static void touches_at_the_end(void)
{
    for (int pair = 0; pair < 2; pair++) {
        const double dt = 1.0 / 512.0;
        const dem_grain grains[2] = {{.y = 3.0 + 2.0 * dt, .r = R, .m = 1.0, .vy = -2.0},
                                     {.y = 2.0, .r = R, .m = 1.0, .fixed = true}};
        dem_definition def = on_ground(grains, 1 + (size_t)pair);
        if (!pair) def.walls[0].point[1] = 3.0 - R;
        def.gravity[1] = 0.0, def.dt = dt;
        def.hard = (dem_hard){true, 1.0, 0.0};
        scoped_sim *sim = grains_after(&def, 1);
        CU_ASSERT_EQUAL(collisions(sim), 1);
    }
}

/* A disk that falls onto the end of a wall comes within a radius of the wall's line before the corner. */
static void bounces_off_a_corner(void)
{
    GRAINS_EACH_KERNEL (kernel, DEM_FAST) {
        const double x = -0.6 * R, y = 0.8 * R, h = 0.7, v = sqrt(2.0 * h);
        const dem_grain grain = {.x = x, .y = y + h, .r = R, .m = 1.0};
        dem_definition def = on_ground(&grain, 1);
        def.kernel = kernel, def.ground.wall = 0, def.walls[0].extent[0] = 0.0;
        def.hard = (dem_hard){true, 1.0, 0.0};
        scoped_sim *sim = grains_after(&def, lround(v / def.dt) + 5);
        CU_ASSERT_EQUAL(collisions(sim), 1);
        /* the tangent at the start of the step replaces the corner */
        CHECK_NEAR(grains_state_of_one(sim).vx, -2.0 * 0.6 * 0.8 * v, 2.0 * v * def.dt / R);
    }
}

/* A disk that slides on the ground, with constant deceleration, hits a fixed one at its speed of that moment,
 * not at the speed in the middle of the step. */
static void hits_while_it_slides(void)
{
    const double a = -0.1, b = R - 1.0 / K, alpha = -0.1 * b / (0.5 * R * R), gap = 0.0037;
    dem_grain grains[2] = {resting(), {.r = R, .m = 1.0, .fixed = true}};
    grains[0].vx = 1.0;
    grains[1].x = grains[0].x + 1.0 + gap;
    grains[1].y = grains[0].y;
    dem_definition def = on_ground(grains, 2);
    def.rotation = true, def.gravity[1] = -1.0, def.ground.wall = 0;
    def.hard = (dem_hard){true, 0.6, INFINITY};
    const double t = (1.0 - sqrt(1.0 + 2.0 * a * gap)) / -a, dt = def.dt, n[2] = {1.0, 0.0};
    dem_body disk = {{1.0 + a * t, 0.0}, alpha * t, R, 1.0, 1.0 / (0.5 * R * R)}, held = {{0.0, 0.0}, 0.0, R};
    dem_impulse impulse;
    CU_ASSERT(t > dt && t < 2.0 * dt && dem_impact(&disk, &held, n, 0.6, INFINITY, &impulse));
    scoped_sim *sim = grains_start(&def);
    dem_state s[2];
    grains_run(sim, 2, s);
    CU_ASSERT_EQUAL(collisions(sim), 1);
    /* of the middle of the second step, at 1.5 dt */
    CHECK_PAIRS(1e-12, {s[0].vx - 0.5 * dt * s[0].fx, disk.v[0] + a * (1.5 * dt - t)},
                {s[0].vy - 0.5 * dt * s[0].fy, disk.v[1]},
                {s[0].omega - 0.5 * dt * s[0].torque / (0.5 * R * R), disk.omega + alpha * (1.5 * dt - t)});
}

/* No hard collision is missed when a pair exceeds the cutoff of the list within a step, alone or among many
 * disks at rest in full vector blocks. */
static void no_collision_is_missed(void)
{
    enum { ALL = 16 };
    for (int k = 0; k < 120; k++) {
        dem_grain grains[ALL] = {{0.0, 3.0, R, 1.0, 8.0, 0.0},
                                 {2.0 + 0.0173 * (k / 2), 3.1, R, 1.0, -9.0, 0.0}};
        for (int i = 2; i < ALL; i++) grains[i] = (dem_grain){.x = 3.0 * i, .y = 9.0, .r = R, .m = 1.0};
        dem_definition def = on_ground(grains, k % 2 ? ALL : 2);
        def.gravity[1] = 0.0;
        def.skin = 0.05; /* half of it is 1.4 steps of the faster */
        def.hard = (dem_hard){true, 1.0, 0.0};
        scoped_sim *sim = grains_start(&def);
        const double energy = grains_energy(sim);
        CHECK_OK(dem_run(sim, 120));
        CU_ASSERT_EQUAL(collisions(sim), 1);
        CHECK_NEAR(grains_energy(sim), energy, 1e-10);
    }
}

enum { HEAP = 30 };

static dem_sim *falling_disks(dem_definition *def)
{
    dem_fill fill = {HEAP, 6.0, 12.0, R, 0.05, 0.35, 0.65, 1.0, DEM_DISK, 1992, 1};
    static dem_grain grains[HEAP];
    CHECK_OK(dem_fill_grains(&fill, grains, &(size_t){0}));
    for (int i = 0; i < HEAP; i++) grains[i].vx = i % 5 - 2.0;
    *def = on_ground(grains, HEAP);
    def->rotation = true;
    def->material.mu_roll = 0.1;
    def->material.k_roll = 50.0;
    def->walls[0].material = def->material;
    def->ground.set = DEM_WELL_AGAIN;
    def->hard = (dem_hard){true, 0.5, 0.3};
    return grains_start(def);
}

/* Falling disks: energy never rises; clones and kernels give the same bits; some collide or rest in wells. */
static void pile_of_disks(void)
{
    dem_definition def;
    scoped_sim *sim = falling_disks(&def), *copy = NULL;
    double last = grains_energy(sim);
    const double first = last;
    for (int k = 0; k < 60; k++) {
        CHECK_OK(dem_run(sim, 100));
        if (k == 20) CHECK_OK(dem_clone(sim, &copy));
        CU_ASSERT(grains_energy(sim) < last + 1e-3 * first);
        last = grains_energy(sim);
    }
    CHECK_OK(dem_run(copy, 3900));
    CU_ASSERT(grains_same_bits(sim, copy) && collisions(sim) > HEAP && collisions(copy) == collisions(sim));
    size_t n, wells = 0;
    scoped dem_contact *list = grains_contacts(sim, &n);
    for (size_t k = 0; k < n; k++) wells += list[k].well == DEM_WELL_HOLDS;
    CU_ASSERT(wells > 3);
    GRAINS_EACH_KERNEL (kernel, DEM_REFERENCE) {
        def.kernel = kernel;
        scoped_sim *other = grains_after(&def, 6000);
        CU_ASSERT(grains_same_bits(sim, other));
    }
}

/* Ranges of numbers are in the suite `dem`. */
static void refused(void)
{
    const dem_grain grain = resting();
    dem_definition def = on_ground(&grain, 1), bad;
    scoped_sim *sim = NULL;
    def.hard = (dem_hard){true, 0.5, 0.3};
#define REFUSES(change, text)                                                                                \
    do {                                                                                                     \
        bad = def;                                                                                           \
        change;                                                                                              \
        CHECK_FAILS(dem_create(&bad, &sim), RP_BAD_INPUT, text);                                             \
    } while (0)
    REFUSES((bad.tangential = DEM_SPRING, bad.material.k_s = bad.walls[0].material.k_s = 1.0),
            "static friction of its own");
    REFUSES(bad.ground.a = 1e-9, "too large for the lightest grain in a well");
    REFUSES(bad.walls[0].material.gamma_s = 1e4, "the limit is");
    REFUSES((bad.rotation = true, bad.material.k_roll = bad.walls[0].material.k_roll = 1e7,
             bad.walls[0].material.mu_roll = 0.1),
            "the limit is");
    REFUSES(bad.tension = true, "tension = false");
    REFUSES(bad.integrator = DEM_GEAR5, "hard: collisions need the integrator verlet");
#undef REFUSES
    dem_grain fast = {.x = 0.0, .y = 9.0, .r = R, .m = 1.0, .vx = 49.0}; /* half the skin: 50 dt */
    def.skin = 0.2, def.grains = &fast;
    dem_free(grains_after(&def, 1));
    fast.vx = 51.0;
    sim = grains_start(&def);
    CHECK_FAILS(dem_run(sim, 1), RP_BROKEN,
                "too_fast at step 0: grain 1: moves beyond its margin of the neighbour list, 0.1, in");
    CU_ASSERT(dem_sim_fault(sim) == DEM_FAULT_TOO_FAST);
    /* all kernels report the same one of several */
    dem_grain all[21];
    for (int i = 0; i < 21; i++)
        all[i] = (dem_grain){.x = 1.5 * i, .y = 9.0, .r = R, .m = 1.0, .vx = i < 14 ? 51.0 : 49.0};
    def.grains = all, def.n_grains = 21;
    char first[256] = "";
    GRAINS_EACH_KERNEL (kernel, DEM_REFERENCE) {
        def.kernel = kernel;
        scoped_sim *several = grains_start(&def);
        CHECK_FAILS(dem_run(several, 1), RP_BROKEN, first);
        snprintf(first, sizeof first, "%s", rp_message());
    }
}

/* A disk at rest that a fast one presses on goes farther in one step than its margin, which its speed had
 * set: the list is made for the speed that it gets, and has all pairs. */
static void slow_disk_hit_by_a_fast_one(void)
{
    dem_grain grains[] = {{.x = 0.0, .y = 9.0, .r = R, .m = 1.0},
                          {.x = 0.0, .y = 10.0 - 1e-6, .r = R, .m = 1.0, .vy = -16.0},
                          {.x = 0.0, .y = 7.97, .r = R, .m = 1.0}};
    dem_definition def = on_ground(grains, 3);
    def.hard = (dem_hard){true, 0.5, 0.3};
    def.dt = 6.6e-3, def.material.k_n = def.walls[0].material.k_n = 1e4;
    def.material.gamma_n = def.walls[0].material.gamma_n = 0.0;
    dem_state s[3], wide[3];
    def.skin = 1.0; /* a list that holds them all */
    scoped_sim *one = grains_start(&def);
    grains_run(one, 40, wide);
    def.skin = 0.0;
    GRAINS_EACH_KERNEL (kernel, DEM_REFERENCE) {
        def.kernel = kernel;
        scoped_sim *sim = grains_start(&def);
        grains_run(sim, 40, s); /* in step 1 by 0.044, its margin was 0.041 */
        for (int i = 0; i < 3; i++) CHECK_PAIRS(1e-9, {s[i].y, wide[i].y}, {s[i].vy, wide[i].vy});
    }
}

CHECK_SUITE(soft, "soft particles", sinks_by_its_weight, well_holds_and_breaks, limit_of_a_well,
            well_of_the_start, energy_of_well, when_wells_are_set, slip_is_viscous_then_capped,
            slides_then_rolls, misprints, misprints_of_slip, misprint_of_flight, misprints_of_spring,
            switches_to_soft, collide_in_flight, passes_through_a_row, hits_while_it_slides, rounds_end,
            arc_over_a_disk, far_from_the_origin, fixed_stay_to_the_bit, touching_is_no_contact,
            rests_while_it_turns, rests_on_a_ground_that_moves, touches_at_the_end, bounces_off_a_corner,
            no_collision_is_missed, pile_of_disks, slow_disk_hit_by_a_fast_one, refused)
