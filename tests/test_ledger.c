/* The energy ledger: it closes, agrees with closed forms, and changes no trajectory. */
#include "dem/setup/definition.h"
#include "dem/state/method.h"
#include "tests/grains.h"

/* Sums of some 1e6 numbers, each rounded to 1e-16 of its terms. */
static const double CLOSES = 1e-10;

static double losses(const dem_ledger *l)
{
    return l->normal_damping + l->shear_damping + l->sliding + l->rolling + l->wells + l->hard;
}

/* True if a channel of the wrong sign would go unnoticed. */
static bool seen(double channel, const dem_ledger *l)
{
    return fabs(2.0 * channel) > 100.0 * CLOSES * l->turnover;
}

/* The ledger closes at `looks` times over the run; a simulation without ledger has the same bits. */
static dem_ledger run_closed(const char *name, dem_definition *def, long steps, int looks)
{
    def->ledger = false;
    scoped_sim *plain = grains_start(def);
    def->ledger = true;
    scoped_sim *sim = grains_start(def);
    dem_ledger l = {0};
    CU_ASSERT_FALSE(dem_ledger_read(plain, &l));
    for (int k = 0; k < looks; k++) {
        CHECK_OK(dem_run(sim, steps / looks));
        CHECK_OK(dem_run(plain, steps / looks));
        l = grains_ledger(sim);
        if (!(fabs(l.residual) <= CLOSES * l.turnover)) fprintf(stderr, "%s: look %d\n", name, k);
        CHECK_NEAR(l.residual, 0.0, CLOSES * l.turnover);
    }
    CU_ASSERT(grains_same_bits(sim, plain));
    return l;
}

/* Two colliding grains, as in the validation of impacts. */
static dem_definition two_grains(dem_grain grains[2], dem_normal_law law, double rate, bool tension)
{
    grains[0] = (dem_grain){0.0, 0.0, 0.13, 0.011, 6.1, 5.2};
    grains[1] = (dem_grain){0.19, 0.17, 0.09, 0.0032, -9.3, -11.7};
    dem_definition def = grains_bare(2, grains, law, (dem_material){0});
    grains_law(&def, law, 2e4, rate);
    def.tension = tension, def.dt = 2e-6;
    return def;
}

/* Damping dissipates 1 - e^2 of the energy of normal motion. */
static void impacts(void)
{
    for (int law = 0; law < DEM_NORMAL_N; law++)
        for (int tension = 0; tension < 2; tension++)
            for (int integrator = 0; integrator < DEM_INTEGRATORS; integrator++) {
                const bool one_force = dem_schemes[integrator]->parts; /* adds hardly any energy */
                dem_grain grains[2];
                dem_definition def = two_grains(grains, law, 900.0, tension);
                def.integrator = integrator;
                const dem_ledger l = run_closed("impact", &def, 2000, 40);
                CU_ASSERT(seen(l.normal_damping, &l) && (one_force || l.integration != 0.0));
                CU_ASSERT(l.shear_damping == 0.0 && l.sliding == 0.0 && l.at_walls == 0.0);
                CU_ASSERT(l.normal_damping > 0.0 && fabs(l.integration) < 0.01 * l.normal_damping);
            }
}

/* A grain in equilibrium on a floor, with an initial tangential speed. */
static dem_definition kicked(dem_grain *grain, double kick, const dem_material *floor)
{
    const double r = 0.1, m = 0.0042;
    *grain = (dem_grain){0.0, r - pow(m * 981.0 / floor->k_n, 2.0 / 3.0), r, m, kick, 0.0};
    dem_definition def = dem_definition_default();
    def.material = *floor;
    grains_on_floor(&def, 1, grain);
    return def;
}

/* Friction dissipates mu m g times the sliding distance; all loss but the dashpot's is at the wall. */
static void sliding_block(void)
{
    for (int choice = 0; choice < 8; choice++) {
        dem_grain grain;
        const dem_material floor = {.k_n = 2e6,
                                    .gamma_n = 500.0,
                                    .k_s = 1e4,
                                    .gamma_s = choice == 6  ? 500.0
                                               : choice & 4 ? 5.0
                                                            : 0.0,
                                    .mu = 0.2};
        dem_definition def = kicked(&grain, 15.0, &floor);
        def.slip = choice & 1 ? DEM_TOTAL : DEM_TRUNCATED;
        def.damping = choice & 2 ? DEM_DAMPING_INSIDE : DEM_DAMPING_OUTSIDE;
        def.dt = 2e-5;
        const long steps = 3000; /* it has slid 0.55 cm */
        const dem_ledger l = run_closed("block", &def, steps, 30);
        CHECK_NEAR(losses(&l), l.at_walls, CLOSES * l.turnover);
        const double weight = grain.m * 981.0;
        /* slip begins within a step; the work of the force uses the middle of the step */
        const double one_step = 0.5 * floor.mu * weight * 15.0 * def.dt;
        scoped_sim *sim = grains_after(&def, steps);
        const dem_state s = grains_state_of_one(sim);
        if (def.slip == DEM_TRUNCATED && !(choice & 4)) {
            const double slid = s.x - floor.mu * weight / floor.k_s; /* the rest is in the spring */
            CHECK_NEAR(l.sliding, floor.mu * weight * slid, one_step);
        }
        if (def.slip == DEM_TOTAL) CHECK_NEAR(l.sliding, 0.0, one_step);
        if (choice & 4) CU_ASSERT(seen(l.shear_damping, &l));
        if (choice == 6)
            CHECK_NEAR(l.shear_damping, l.at_walls - l.normal_damping,
                       CLOSES * l.turnover); /* which takes all */
    }
}

/* A grain in equilibrium on a floor, pushed or, with `roll`, spun, with the dashpot inside the limit and at
 * `share` of critical. */
static dem_definition pushed(dem_grain *grain, dem_normal_law law, dem_tangential_law tangential,
                             double share, bool roll)
{
    const double r = 0.1, m = 0.0042, weight = m * 981.0, speed = 5.0;
    dem_definition def = grains_bare(1, grain, law, (dem_material){0});
    *grain = (dem_grain){0.0, r, r, m, roll ? 0.0 : speed, 0.0, .omega = roll ? -speed / r : 0.0};
    grains_law(&def, law, 2e6, 0.0);
    def.gravity[1] = -981.0, def.tangential = tangential, def.damping = DEM_DAMPING_INSIDE;
    def.tension = false, def.rotation = roll;
    dem_material *c = &def.material;
    const dem_normal_descriptor *spring = &dem_normal_descriptors[law];
    const double overlap = spring->rest_overlap(spring->scale(c->k_n, r), weight),
                 mindlin = tangential == DEM_MINDLIN ? sqrt(r * overlap) : 1.0;
    const double k = 1e4, inert = roll ? dem_inertia(def.shape, m, r) / (r * r) : m,
                 rate = share * 2.0 * sqrt(k * inert) / m;
    grain->y -= overlap;
    c->mu = roll ? 0.0 : 0.3, c->mu_roll = roll ? 0.3 : 0.0;
    c->k_s = c->k_roll = k / mindlin;
    c->gamma_s = c->gamma_roll = tangential == DEM_MINDLIN ? rate / sqrt(k / m) : rate;
    grains_on_floor(&def, 1, grain);
    def.dt = fmin(2e-6, 0.2 * dem_time_step_limit(&def, NULL)), def.ledger = true;
    return def;
}

/* Whatever the damping, the grain stops on the way of Coulomb's law; no energy arises, and the spring holds
 * at most that at the limit. */
static void stops_at_the_limit(void)
{
    static const double shares[] = {0.0, 0.01, 0.3, 1.0, 10.0, 100.0};
    static const dem_tangential_law springs[] = {DEM_SPRING, DEM_MINDLIN};
    for (int law = 0; law < DEM_NORMAL_N; law++)
        for (int n = 0; n < 24; n++) {
            const double share = shares[n % 6], most = 0.3 * 0.0042 * 981.0, speed = 5.0;
            const bool roll = n / 12;
            dem_grain grain;
            const dem_definition def = pushed(&grain, law, springs[n / 6 % 2], share, roll);
            scoped_sim *sim = grains_start(&def);
            const double inertia = dem_inertia(def.shape, grain.m, grain.r) / (grain.r * grain.r),
                         energy = 0.5 * (roll ? inertia : grain.m) * speed * speed;
            double before = grains_energy(sim), held = 0.0, risen = 0.0, stiffness = 0.0;
            const long steps = lround(1.2 * 2.0 * energy / (most * speed) / def.dt), looks = 400;
            for (long look = 0; look < looks; look++) {
                CHECK_OK(dem_run(sim, steps / looks + 1));
                const double now = grains_energy(sim);
                const dem_contact c = grains_only_contact(sim);
                held = fmax(held, roll ? 0.5 * c.k_roll * c.rolling_spring * c.rolling_spring
                                       : 0.5 * c.k_s * c.shear_spring * c.shear_spring);
                risen = fmax(risen, now - before), before = now;
                stiffness = roll ? c.k_roll : c.k_s;
            }
            const dem_state s = grains_state_of_one(sim);
            const dem_ledger l = grains_ledger(sim);
            CHECK_NEAR((roll ? -s.angle * grain.r : s.x) * most / energy, 1.0, 0.05);
            CU_ASSERT(held <= 0.5 * most * most / stiffness * (1.0 + 1e-9));
            CU_ASSERT(risen <= 1e-6 * energy);
            CU_ASSERT(fmin(fmin(l.sliding, l.shear_damping), l.rolling) >= -CLOSES * energy);
            CHECK_NEAR(losses(&l), energy, 0.05 * energy);
        }
}

/* Oblique impacts by Mindlin's law, whose stiffness begins at 0: no spring stores energy at first touch, and
 * sliding takes no energy that it gives back later. */
static void first_touch(void)
{
    for (int n = 0; n < 12; n++) {
        const double angle = 0.1 + 0.12 * n, speed = 23.85, r = 0.1;
        dem_grain grain = {0.0, 1.0001 * r, r, 0.0042, speed * sin(angle), -speed * cos(angle)};
        dem_definition def = grains_bare(1, &grain, DEM_ELASTIC, (dem_material){0});
        grains_law(&def, DEM_ELASTIC, 2e6, 900.0);
        def.tangential = DEM_MINDLIN, def.damping = DEM_DAMPING_INSIDE, def.tension = false;
        def.rotation = n % 2, def.dt = 2e-7, def.ledger = true;
        dem_material *c = &def.material;
        c->mu = 0.3, c->k_s = 0.8 * c->k_n, c->gamma_s = sqrt(2.0 / 3.0) * c->gamma_n;
        grains_on_floor(&def, 1, &grain);
        scoped_sim *sim = grains_start(&def);
        dem_ledger before = grains_ledger(sim), l;
        for (int look = 0; look < 2000; look++, before = l) {
            CHECK_OK(dem_run(sim, 2));
            l = grains_ledger(sim);
            CU_ASSERT(l.sliding - before.sliding > -1e-5 * l.start);
            CU_ASSERT(l.shear_damping - before.shear_damping > -1e-5 * l.start);
        }
        CU_ASSERT(l.sliding + l.shear_damping > 1e-3 * l.start && grains_energies(sim).elastic == 0.0);
    }
}

/* Viscous slip under Coulomb's limit: sliding, then creep. */
static void slip_roll(void)
{
    dem_grain grain;
    const dem_material floor = {.k_n = 2e6, .gamma_n = 500.0, .gamma_s = 40.0, .mu = 0.2};
    dem_definition def = kicked(&grain, 15.0, &floor);
    def.tangential = DEM_SLIP_ROLL;
    const dem_ledger l = run_closed("slip", &def, 4000, 20);
    CU_ASSERT(seen(l.sliding, &l) && seen(l.shear_damping, &l) && l.shear_damping > 0.0 && l.sliding > 0.0);
    CHECK_NEAR(l.shear_damping + l.sliding, 0.5 * grain.m * 15.0 * 15.0, 1e-3 * l.turnover);
}

/* A box is filled and opened; some grains leave. */
static void avalanche(void)
{
    const long steps = check_fast() ? 6000 : 12000;
    for (int choice = 0; choice < 9; choice++) {
        dem_definition def = grains_box(40, 1.2, choice, NULL);
        def.walls[DEM_BOX_RIGHT].open_at_step = steps / 2, def.x_max = 2.0;
        if (choice == 1) def.slip = DEM_TOTAL;
        if (choice == 2) def.damping = DEM_DAMPING_INSIDE, def.tension = false;
        if (choice == 3) def.integrator = DEM_GEAR5;
        if (choice == 4) def.integrator = DEM_GEAR5, def.slip = DEM_TOTAL, def.dt = 2.5e-5;
        if (choice >= 5) def.rotation = true;
        if (choice >= 6)
            for (int w = -1; w < DEM_BOX_N; w++) {
                dem_material *c = w < 0 ? &def.material : &def.walls[w].material;
                c->mu_roll = 0.1, c->k_roll = 1e4, c->gamma_roll = 5.0;
            }
        if (choice == 7) { /* a moving wall, and a floor that ends in a corner */
            def.walls[DEM_BOX_RIGHT].open_speed = 20.0;
            def.walls[DEM_BOX_RIGHT].extent[0] = 0.0, def.walls[DEM_BOX_FLOOR].extent[1] = 1.2;
            def.y_min = -0.4;
        }
        if (choice == 8) def.slip = DEM_TOTAL, def.damping = DEM_DAMPING_INSIDE, def.tension = false;
        const dem_ledger l = run_closed("avalanche", &def, steps, 200);
        CU_ASSERT(seen(l.normal_damping, &l) && seen(l.shear_damping, &l) && seen(l.sliding, &l));
        CU_ASSERT(seen(l.wall_work, &l) && seen(l.integration, &l));
        CU_ASSERT(l.normal_damping > 0.0 && losses(&l) > l.at_walls && l.at_walls > 0.0);
        if (def.slip == DEM_TRUNCATED) CU_ASSERT(l.sliding > 0.0 && l.shear_damping > 0.0);
        if (!check_fast()) CU_ASSERT(seen(l.taken_out, &l));
        if (choice >= 6) CU_ASSERT(l.rolling > 0.0 && seen(l.rolling, &l));
    }
}

/* Gravity rotates, and is set; then the box rotates about a point outside. */
static void turns(void)
{
    for (int choice = 0; choice < 4; choice++) {
        dem_definition def = grains_box(20, 0.8, 3 + choice, NULL);
        def.turn_from_step = 3000;
        if (choice & 2) def.rotation = true, def.material.mu_roll = 0.1;
        if (choice & 2)
            for (int w = 0; w < DEM_BOX_N; w++)
                def.walls[w].material.mu_roll = 0.1, def.walls[w].material.k_roll = 1e4;
        *(choice & 1 ? &def.box_turn_per_step : &def.turn_per_step) = 1e-4;
        const dem_ledger l = run_closed("turn", &def, 6000, 60);
        CU_ASSERT(seen(choice & 1 ? l.wall_work : l.gravity_turn, &l));
        CU_ASSERT((choice & 1 ? l.gravity_turn : l.wall_work) == 0.0);
    }
    dem_definition def = grains_box(20, 0.8, 3, NULL);
    def.ledger = true;
    scoped_sim *sim = grains_after(&def, 3000);
    const double before = grains_energies(sim).gravity;
    dem_gravity_set(sim, (double[]){100.0, -900.0});
    dem_ledger l = grains_ledger(sim);
    CHECK_PAIRS(CLOSES * l.turnover, {l.gravity_turn, grains_energies(sim).gravity - before},
                {l.residual, 0.0});
    CHECK_OK(dem_run(sim, 1000));
    l = grains_ledger(sim);
    CHECK_NEAR(l.residual, 0.0, CLOSES * l.turnover);
}

/* Grains are added one by one; a clone continues with its own ledger. */
static void grains_put_in(void)
{
    dem_grain grain;
    const dem_material floor = {.k_n = 2e6, .gamma_n = 500.0, .k_s = 1e4, .gamma_s = 5.0, .mu = 0.2};
    dem_definition def = kicked(&grain, 3.0, &floor);
    def.ledger = true, def.rotation = true;
    scoped_sim *sim = grains_start(&def), *copy = NULL;
    double put_in = 0.0;
    for (int k = 0; k < 20; k++) {
        const dem_grain more = {0.07 * k, 1.3, 0.08 + 0.002 * k, 0.003, 4.0, -7.0, 0.0, 11.0};
        CHECK_OK(dem_run(sim, 1500));
        CHECK_OK(dem_add(sim, &more, NULL));
        put_in += 0.5 * more.m * 65.0 + 0.5 * dem_inertia(DEM_SPHERE, more.m, more.r) * 121.0 +
                  more.m * 981.0 * more.y;
    }
    CHECK_OK(dem_clone(sim, &copy));
    CHECK_OK(dem_run(sim, 4000));
    CHECK_OK(dem_run(copy, 4000));
    const dem_ledger l = grains_ledger(sim), same = grains_ledger(copy);
    CHECK_NEAR(l.put_in, put_in, CLOSES * put_in);
    CHECK_NEAR(l.residual, 0.0, CLOSES * l.turnover);
    CU_ASSERT(memcmp(&l, &same, sizeof l) == 0);
    CHECK_FAILS(dem_add(sim, &(dem_grain){0.0, 0.05, 0.1, 0.003}, NULL), RP_NO_ROOM, "touches");
}

/* Hard collisions, some together with soft contacts, in a rotating box; wells on a ground. */
static void hard_and_wells(void)
{
    for (int choice = 0; choice < 6; choice++) {
        dem_grain *grains;
        dem_definition def = grains_box(30, 1.0, 11 + choice, &grains);
        def.tangential = DEM_SLIP_ROLL, def.tension = false, def.normal = DEM_LINEAR;
        def.material.k_n = 2e4, def.rotation = choice & 1;
        for (int w = 0; w < DEM_BOX_N; w++) def.walls[w].material = def.material;
        if (choice < 4) def.hard = (dem_hard){true, 0.5, 0.3};
        if (choice >= 2) def.ground = (dem_ground){1, 0.3, 1e-3, choice % 3};
        if (choice == 3) grains[7].fixed = true, grains[7].vx = grains[7].vy = 0.0;
        if (choice == 1) def.box_turn_per_step = 1e-4;
        if (choice == 2) def.walls[DEM_BOX_RIGHT].open_at_step = 4000;
        def.x_max = 1.5;
        const dem_ledger l = run_closed("hard", &def, 8000, 100);
        CU_ASSERT(seen(choice < 4 ? l.hard : l.wells, &l));
        CU_ASSERT(l.hard >= 0.0);
    }
}

/* The implicit integrator with both solvers in an opened box: damping, slip and wells; rotating gravity. */
static void implicit_box(void)
{
    const long steps = check_fast() ? 600 : 2400;
    for (int choice = 0; choice < 6; choice++) {
        dem_grain *grains;
        dem_definition def = grains_box(20, 1.0, 21 + choice, &grains);
        def.integrator = DEM_IMPLICIT;
        def.implicit.solver = choice & 1 ? DEM_SOLVER_SOR : DEM_SOLVER_DIRECT;
        def.tangential = choice == 0 ? DEM_NONE : DEM_SLIP_ROLL;
        def.normal = choice & 2 ? DEM_LINEAR : DEM_HERTZ;
        def.tension = choice < 3;
        def.material =
            (dem_material){.k_n = choice & 2 ? 2e5 : 1e6, .gamma_n = 500.0, .gamma_s = 40.0, .mu = 0.2};
        if (choice == 0) def.material.gamma_s = def.material.mu = 0.0;
        for (int w = 0; w < DEM_BOX_N; w++) def.walls[w].material = def.material;
        def.dt = 2e-4;
        if (choice >= 2) def.ground = (dem_ground){1, 0.3, 1e-3, choice % 3};
        if (choice == 1) grains[7].fixed = true, grains[7].vx = grains[7].vy = 0.0;
        if (choice == 4) def.turn_per_step = 2e-4;
        def.walls[DEM_BOX_RIGHT].open_at_step = steps / 2, def.x_max = 1.1;
        const dem_ledger l = run_closed("implicit box", &def, steps, 60);
        CU_ASSERT(l.normal_damping > 0.0 && seen(l.normal_damping, &l));
        CU_ASSERT(losses(&l) > l.at_walls && l.at_walls > 0.0);
        if (def.tangential != DEM_NONE) CU_ASSERT(seen(l.shear_damping, &l) && seen(l.sliding, &l));
        if (def.tangential != DEM_NONE) CU_ASSERT(l.shear_damping > 0.0 && l.sliding > 0.0);
        if (choice >= 2) CU_ASSERT(seen(l.wells, &l));
        if (choice == 4) CU_ASSERT(seen(l.gravity_turn, &l));
        if (!check_fast()) CU_ASSERT(seen(l.taken_out, &l));
        if (!check_fast() && choice != 2) CU_ASSERT(seen(l.wall_work, &l)); /* no grain touches it */
        /* residual of the solver in a grain's equation, times the force */
        CHECK_PAIRS(1e-12 * l.turnover, {l.integration, 0.0}, {l.residual, 0.0});
    }
}

/* Undamped impacts of the implicit scheme conserve energy to the solver's residual: two grains, and one on a
 * floor, with steps of any fraction of a contact time. The channel of damping has its whole loss. */
static void implicit_conserves(void)
{
    for (int law = 0; law < DEM_NORMAL_N; law++)
        for (int solver = DEM_SOLVER_DIRECT; solver <= DEM_SOLVER_SOR; solver++)
            for (double dt = 2e-6; dt < 1e-3; dt *= 7.0)
                for (int damped = 0; damped < 2; damped++) {
                    dem_grain grains[2];
                    dem_definition def = two_grains(grains, law, damped ? 900.0 : 0.0, true);
                    def.integrator = DEM_IMPLICIT, def.implicit.solver = solver, def.dt = dt;
                    def.skin = 0.2;
                    grains[1].vx *= 0.3, grains[1].vy *= 0.3;
                    const dem_ledger l =
                        run_closed("implicit impact", &def, lround(8e-3 / dt / 20.0) * 20, 20);
                    CHECK_NEAR(l.integration, 0.0, 1e-11 * l.turnover);
                    CU_ASSERT(l.turnover > 0.0);
                    CU_ASSERT(damped ? l.normal_damping > 0.0 && seen(l.normal_damping, &l)
                                     : losses(&l) == 0.0);
                }
    dem_grain grain;
    const dem_material floor = {.k_n = 1e5};
    dem_definition def = kicked(&grain, 15.0, &floor);
    grain.y = 0.3;
    def.integrator = DEM_IMPLICIT, def.tangential = DEM_NONE, def.dt = 1e-4;
    const dem_ledger l = run_closed("implicit bounce", &def, 4000, 40);
    CU_ASSERT(losses(&l) == 0.0 && l.wall_work == 0.0);
    CHECK_NEAR(l.integration, 0.0, 1e-12 * l.turnover);
}

/* Infinite friction has no slip loss, whatever the error of the oscillation: a grain on a floor, and two
 * grains during an impact. */
static void sticking(void)
{
    for (int integrator = 0; integrator < DEM_INTEGRATORS; integrator++) {
        dem_grain grain;
        const dem_material floor = {.k_n = 2e6, .gamma_n = 1e-12, .k_s = 1e4, .mu = INFINITY};
        dem_definition def = kicked(&grain, 3.0, &floor);
        def.integrator = integrator, def.dt = 4e-5;
        if (dem_scheme_check(&def)) continue;
        const dem_ledger l = run_closed("sticks", &def, 6750, 10);
        CHECK_NEAR(losses(&l), 0.0, CLOSES * l.turnover);
        CU_ASSERT(integrator == DEM_VERLET || seen(l.integration, &l));
        dem_grain grains[2];
        def = two_grains(grains, DEM_HERTZ, 0.0, true);
        def.integrator = integrator, def.tangential = DEM_SPRING, def.material.k_s = 1e4;
        def.material.mu = INFINITY;
        const dem_ledger pair = run_closed("sticks", &def, 950, 1);
        CHECK_NEAR(losses(&pair), 0.0, CLOSES * pair.turnover);
        CU_ASSERT(pair.integration != 0.0);
    }
}

/* The ledger identifies each lasting contact after a step, also while others begin or end: in a pile at rest
 * under slightly rotated gravity, no contact slides while two grains collide above. */
static void pile_sticks(void)
{
    dem_definition def = grains_box(20, 0.8, 5, NULL);
    def.ledger = true, def.material.mu = INFINITY;
    for (int w = 0; w < DEM_BOX_N; w++) def.walls[w].material.mu = INFINITY;
    scoped_sim *sim = grains_after(&def, 30000);
    const dem_ledger before = grains_ledger(sim);
    const dem_grain two[2] = {{0.4, 4.0, 0.1, 0.004, 0.0, 0.0}, {0.4, 4.25, 0.1, 0.004, 0.0, -40.0}};
    for (int i = 0; i < 2; i++) CHECK_OK(dem_add(sim, &two[i], NULL));
    dem_gravity_set(sim, (double[]){9.81, -981.0});
    CHECK_OK(dem_run(sim, 100));
    const dem_ledger after = grains_ledger(sim);
    CHECK_NEAR(after.sliding, before.sliding, CLOSES * after.turnover);
    CU_ASSERT(after.normal_damping > before.normal_damping + 1e-3);
}

/* Work of a floor that rotates under a grain: measured force times the displacement of the contact point, and
 * rolling torque times the angle. */
static void work_of_a_wall(void)
{
    const double turn = 0.01, dt = 1e-4;
    dem_grain grain;
    dem_material floor = {.k_n = 2e6, .gamma_n = 500.0, .k_s = 1e4, .gamma_s = 5.0, .mu = 0.5};
    floor.mu_roll = 0.3, floor.k_roll = 1e4, floor.gamma_roll = 5.0;
    dem_definition def = kicked(&grain, 0.0, &floor);
    def.rotation = true, def.dt = dt, def.box_turn_per_step = turn;
    def.ledger = true;
    scoped_sim *sim = grains_start(&def);
    double work = 0.0;
    for (int step = 0; step < 30; step++) {
        for (int end = 0; end < 2; end++) {
            double f[2];
            const dem_contact c = grains_only_contact(sim);
            grains_wall_forces(sim, f);
            /* clockwise, from the start of the step or back from its end */
            const double angle = end ? -turn : turn, x = c.x_b, y = c.y_b;
            const double dx = x * cos(angle) + y * sin(angle) - x, dy = y * cos(angle) - x * sin(angle) - y;
            work -= (end ? -0.5 : 0.5) * (f[0] * dx + f[1] * dy) + 0.5 * c.rolling_torque * sin(turn);
            if (!end) CHECK_OK(dem_run(sim, 1));
        }
    }
    const dem_ledger l = grains_ledger(sim);
    CHECK_NEAR(l.wall_work / work, 1.0, 1e-9);
    CHECK_NEAR(l.residual, 0.0, CLOSES * l.turnover);
}

/* A grain at rest that is hit and leaves within the same step carries the transferred energy away. */
static void hit_and_gone(void)
{
    dem_grain grains[2] = {{0.0, 0.0, 0.1, 0.004, 50.0, 0.0}, {0.2001, 0.0, 0.1, 0.004}};
    dem_definition def = grains_bare(2, grains, DEM_HERTZ, (dem_material){.k_n = 1e5});
    def.dt = 1e-4, def.tension = false, def.x_max = 0.2005;
    def.hard = (dem_hard){true, 0.5, 0.0};
    const dem_ledger l = run_closed("gone", &def, 1, 1);
    const double v = 50.0;
    CHECK_NEAR(l.taken_out, 0.5 * 0.004 * 0.75 * 0.75 * v * v, CLOSES * l.turnover);
    CHECK_NEAR(l.hard, 0.25 * 0.004 * 0.75 * v * v, CLOSES * l.turnover);
}

/* A hard collision with a sloping belt that moves along itself: its work is that of the sliding impulse mu
 * P_n, P_n = m (1 + e) v_n; the remaining energy change is loss. */
static void hit_by_a_belt(void)
{
    const double m = 0.004, r = 0.1, e = 0.5, mu = 0.3, belt = 70.0, v_n = 30.0, v_t = -11.0;
    const double n[2] = {-0.6, 0.8}, t[2] = {0.8, 0.6};
    dem_grain grain = {.x = 1.0 + 1.0001 * r * n[0], .y = 2.0 + 1.0001 * r * n[1], .r = r, .m = m};
    grain.vx = -v_n * n[0] + v_t * t[0], grain.vy = -v_n * n[1] + v_t * t[1];
    dem_definition def = grains_bare(1, &grain, DEM_HERTZ, (dem_material){.k_n = 1e5});
    def.dt = 1e-4, def.tension = false, def.rotation = true;
    def.hard = (dem_hard){true, e, mu}, def.n_walls = 1;
    def.walls[0] = grains_line(1.0, 2.0, n[0], n[1], &def.material);
    def.walls[0].extent[0] = -1.0, def.walls[0].open_at_step = 0;
    def.walls[0].open_speed = belt;
    const dem_ledger l = run_closed("belt", &def, 4, 4);
    const double impulse = m * (1.0 + e) * v_n, slid = mu * impulse, turned = slid * r;
    const double gain = 0.5 * m * (e * e - 1.0) * v_n * v_n + slid * v_t + 0.5 * slid * slid / m +
                        0.5 * turned * turned / dem_inertia(def.shape, m, r);
    CHECK_PAIRS(CLOSES * l.turnover, {l.wall_work, slid * belt}, {l.hard, slid * belt - gain});
}

/* Two grains whose distance is below the sum of their radii by its square alone: they touch with overlap 0,
 * where Mindlin's stiffness is 0. One that comes so slowly that a step does not move it has begun to touch.
 */
static void overlap_zero(void)
{
    const double r = 0.1, m = 0.0042, far = 1000.0, reach = r + r;
    double x = reach, y = 0.0;
    for (int k = 1000; k < 1999 && !(x * x + y * y < reach * reach && sqrt(x * x + y * y) == reach); k++)
        x = far + 1e-4 * k - far, y = sqrt(reach * reach - x * x);
    for (int choice = 0; choice < 8; choice++) {
        dem_grain grains[] = {{far, 0.0, r, m}, {far + x, y, r, m, choice & 1 ? -1e-9 : 0.0, 0.0}};
        dem_definition def = grains_bare(2, grains, choice & 4 ? DEM_LINEAR : DEM_HERTZ,
                                         (dem_material){.k_n = 1e5, .k_s = 1e5, .gamma_n = 9.0, .mu = 0.5});
        def.rotation = true, def.tangential = DEM_MINDLIN, def.dt = 1e-6;
        def.slip = choice & 2 ? DEM_TOTAL : DEM_TRUNCATED;
        const dem_ledger l = run_closed("overlap 0", &def, 20, 20);
        CU_ASSERT(l.start == 0.5 * m * (choice & 1 ? 1e-18 : 0.0) && isfinite(l.sliding));
        scoped_sim *sim = grains_after(&def, 2);
        const dem_contact c = grains_only_contact(sim);
        CU_ASSERT(c.overlap == 0.0 && isfinite(c.shear_spring) && isfinite(c.shear_force));
    }
}

CHECK_SUITE(ledger, "energy ledger", impacts, sliding_block, stops_at_the_limit, first_touch, sticking,
            slip_roll, pile_sticks, work_of_a_wall, hit_and_gone, hit_by_a_belt, avalanche, turns,
            grains_put_in, hard_and_wells, implicit_box, implicit_conserves, overlap_zero)
