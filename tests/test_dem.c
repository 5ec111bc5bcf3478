/* The simulator: symmetries, conservation, the neighbour list, kernels, faults, bad input. */
#include <float.h>

#include "dem/setup/definition.h"
#include "dem/methods/methods.h"
#include "tests/grains.h"

static const double INF = INFINITY;

static dem_wall line(double x, double y, double nx, double ny, const dem_material *c)
{
    dem_wall w = grains_line(x, y, nx, ny, c);
    w.material.k_n *= 2.0;
    return w;
}

/* The only wall. */
static void put_wall(dem_definition *def, double x, double y, double nx, double ny)
{
    def->n_walls = 1;
    def->walls[0] = line(x, y, nx, ny, &def->material);
}

/* A test without and with rotation. */
#define EITHER(test)                                                                                         \
    static void test(void)                                                                                   \
    {                                                                                                        \
        test##_of(false);                                                                                    \
        test##_of(true);                                                                                     \
    }

/* Largest difference of position or velocity between two simulations of the same grains. */
static double distance(const dem_sim *a, const dem_sim *b)
{
    const size_t n = dem_count(a);
    if (n != dem_count(b)) return INF;
    scoped dem_state *s = grains_states(a), *t = grains_states(b);
    double most = 0.0;
    for (size_t i = 0; i < n; i++) {
        double d =
            fabs(s[i].x - t[i].x) + fabs(s[i].y - t[i].y) + fabs(s[i].vx - t[i].vx) + fabs(s[i].vy - t[i].vy);
        if (!(d <= most)) most = d; /* NaN if either is NaN */
    }
    return most;
}

static double angular_momentum(const dem_definition *def, const dem_state *s)
{
    return s->m * (s->x * s->vy - s->y * s->vx) + dem_inertia(def->shape, s->m, s->r) * s->omega;
}

/* A box as of grains_box, whose grains resist rolling if they rotate. */
static dem_definition box_of(long N, double W, long run, bool rotation, dem_grain **grains)
{
    dem_definition def = grains_box(N, W, run, grains);
    def.rotation = rotation, def.material.mu_roll = rotation ? 0.1 : 0.0;
    return def;
}

/* Momentum, and with rotation angular momentum, of a collapsing cloud. */
static void momentum_of(bool rotation)
{
    dem_grain *grains;
    dem_definition def = box_of(60, 2.0, 3, rotation, &grains);
    double p0[2] = {0.0, 0.0}, p1[2] = {0.0, 0.0}, l0 = 0.0, l1 = 0.0, scale = 0.0;
    def.n_walls = 0, def.gravity[1] = 0.0;
    for (size_t i = 0; i < 60; i++) { /* towards the middle */
        grains[i].vx = 20.0 * (1.0 - grains[i].x);
        grains[i].vy = 20.0 * (1.5 - grains[i].y);
        p0[0] += grains[i].m * grains[i].vx;
        p0[1] += grains[i].m * grains[i].vy;
        scale += grains[i].m * 40.0;
        if (rotation) grains[i].omega = 50.0 * ((double)(i % 5) - 1.0);
    }
    scoped_sim *sim = grains_start(&def);
    dem_state s[60];
    dem_states(sim, s);
    for (int i = 0; i < 60; i++) l0 += angular_momentum(&def, &s[i]);
    grains_run(sim, 4000, s);
    int touched = 0;
    for (int i = 0; i < 60; i++) {
        p1[0] += s[i].m * s[i].vx;
        p1[1] += s[i].m * s[i].vy;
        l1 += angular_momentum(&def, &s[i]);
        touched += s[i].contacts > 0 || fabs(s[i].vx - grains[i].vx) > 1e-9;
    }
    CU_ASSERT(touched > 30); /* otherwise no contact was tested */
    /* round-off of 4000 additions a grain, random signs: sqrt(4000 * 60) eps */
    CHECK_PAIRS(1e-13 * scale, {p1[0], p0[0]}, {p1[1], p0[1]});
    if (rotation) CHECK_NEAR(l1, l0, 1e-13 * scale * 2.0); /* at some 2 cm from the origin */
}

EITHER(momentum)

/* A mirrored box, and one with reversed grain numbers, have the same trajectories. Round-off grows in
 * an avalanche, so the comparison ends while the grains settle. */
static void mirror_and_relabel_of(bool rotation)
{
    dem_grain *grains, other[80];
    dem_definition def = box_of(80, 2.4, 5, rotation, &grains);
    def.damping = DEM_DAMPING_OUTSIDE; /* inside, round-off decides which contacts slip */
    for (int i = 0; rotation && i < 80; i++) grains[i].omega = 0.5 * i;
    scoped_sim *sim = grains_start(&def), *mirrored = NULL, *renumbered = NULL;
    for (int i = 0; i < 80; i++) {
        other[i] = grains[i];
        other[i].x = 2.4 - grains[i].x;
        other[i].omega = -grains[i].omega;
    }
    dem_definition changed = def;
    changed.grains = other;
    mirrored = grains_start(&changed);
    for (int i = 0; i < 80; i++) other[i] = grains[79 - i];
    renumbered = grains_start(&changed);
    dem_state s[80], m[80], r[80];
    grains_run(sim, 1000, s);
    grains_run(mirrored, 1000, m);
    grains_run(renumbered, 1000, r);
    int contacts = 0;
    for (int i = 0; i < 80; i++) {
        contacts += s[i].contacts;
        CHECK_PAIRS(1e-9, {m[i].x, 2.4 - s[i].x}, {m[i].y, s[i].y}, {r[79 - i].x, s[i].x});
        CHECK_PAIRS(1e-6, {m[i].vx, -s[i].vx}, {r[79 - i].vy, s[i].vy});
        CHECK_PAIRS(1e-5, {m[i].omega, -s[i].omega}, {r[79 - i].omega, s[i].omega});
        CHECK_NEAR(m[i].angle, -s[i].angle, 1e-8);
    }
    CU_ASSERT(contacts > 40);
}

EITHER(mirror_and_relabel)

/* Removal of grains from a continued list equals a rebuild, except for the order of sums. */
static void leave_of(bool rotation)
{
    dem_definition def = box_of(100, 2.2, 3, rotation, NULL);
    def.x_max = 2.3;
    scoped_sim *sim = grains_after(&def, 8000), *rebuilt = NULL;
    dem_wall_open(sim, DEM_BOX_RIGHT, INF);
    CHECK_OK(dem_run(sim, 1000));
    CHECK_OK(dem_clone(sim, &rebuilt));
    const size_t before = dem_count(sim);
    const long start = grains_counts(sim).rebuilds;
    for (int k = 0; k < 400; k++) {
        CHECK_OK(dem_run(sim, 1));
        CHECK_OK(dem_run(rebuilt, 1));
        CHECK_OK(dem_neighbours_rebuild(rebuilt));
        if (k % 100 == 99) CU_ASSERT(distance(sim, rebuilt) < 1e-9);
        CU_ASSERT_EQUAL(dem_count(sim), dem_count(rebuilt));
        CU_ASSERT(grains_counts(sim).contacts == grains_counts(rebuilt).contacts);
    }
    CU_ASSERT(dem_count(sim) + 5 <= before && dem_count(sim) > 50);
    CU_ASSERT(grains_counts(sim).rebuilds - start < 40);
}

EITHER(leave)

/* Grains moved to the indices of removed ones keep their wall contacts and margins. */
static void leave_below_others(void)
{
    const double r = 0.1, m = 0.0042, sinks = 1e-4;
    dem_grain grains[5] = {{0.9, 0.6, r, m, 0.0, -300.0},
                           {1.2, 0.65, r, m, 0.0, -300.0},
                           {0.2, 1.0 + r - sinks, r, m, 0.0, 0.0},
                           {0.2, 1.0 + 3.4 * r, r, m, 0.0, 0.0}, /* falls on the one before */
                           {1.2, 1.6 + r - sinks, r, m, 0.0, 0.0}};
    dem_definition def = grains_of(5, grains);
    def.dt = 1e-5, def.y_min = 0.5, def.n_walls = 2;
    for (int w = 0; w < 2; w++) {
        def.walls[w] = line(w ? 1.2 : 0.2, w ? 1.6 : 1.0, 0.0, 1.0, &def.material);
        def.walls[w].extent[0] = -0.2, def.walls[w].extent[1] = 0.2;
    }
    scoped_sim *sim = grains_after(&def, 3000); /* the fall uses 0.9 of them */
    CU_ASSERT_EQUAL_FATAL(dem_count(sim), 3);
    scoped dem_state *s = grains_states(sim);
    CU_ASSERT(s[0].contacts > 0 && s[0].y < 1.0 + r && s[0].y > 1.0);
    CU_ASSERT(s[1].y - s[0].y > 1.9 * r && s[1].y < 1.0 + 3.3 * r && fabs(s[2].y - grains[4].y) < 1e-3);
}

/* Work is counted in grains present at each step, by every integrator; one of three leaves on the way. */
static void work_is_counted(void)
{
    for (int way = 0; way < 4; way++) {
        dem_grain grains[] = {{0.2, 0.5, 0.1, 0.0042, 0.0, 0.0},
                              {0.5, 0.5, 0.1, 0.0042, 0.0, 0.0},
                              {0.93, 0.5, 0.1, 0.0042, 300.0, 0.0}};
        dem_definition def = grains_of(3, grains);
        def.dt = 1e-5, def.x_max = 1.0;
        def.integrator = way < 3 ? (dem_integrator[]){DEM_VERLET, DEM_GEAR5, DEM_IMPLICIT}[way] : DEM_VERLET;
        if (def.integrator == DEM_IMPLICIT)
            def.tension = false, def.tangential = DEM_NONE, def.material.mu = 0.0;
        if (way == 3) def.hard = (dem_hard){.on = true, .restitution = 0.5}, def.tension = false;
        scoped_sim *sim = grains_start(&def);
        size_t steps = 0;
        for (int k = 0; k < 50; k++) {
            steps += dem_count(sim);
            CHECK_OK(dem_run(sim, 1));
        }
        const dem_counts counts = grains_counts(sim);
        CU_ASSERT(dem_count(sim) == 2 && counts.grain_steps == (double)steps);
        CU_ASSERT(counts.collisions == 0 && counts.contacts == 0);
    }
}

/* Rebuilding the list more often than needed carries the springs over and changes the order of sums only. */
static void extra_rebuilds_of(bool rotation)
{
    dem_grain *grains;
    dem_definition def = box_of(100, 2.2, 3, rotation, &grains);
    /* 16 columns of some 0.3 cm wrap around inside the box, so that either grain of a pair may come first */
    for (int i = 0; i < 100; i++) grains[i].x += 3.8;
    for (int w = 0; w < 3; w++) {
        def.walls[w].material.mu_roll = def.material.mu_roll;
        def.walls[w].point[0] += 3.8;
    }
    scoped_sim *sim = grains_after(&def, 8000), *rebuilt = NULL;
    CHECK_OK(dem_clone(sim, &rebuilt));
    for (int k = 0; k < 40; k++) {
        CHECK_OK(dem_run(sim, 50));
        CHECK_OK(dem_neighbours_rebuild(rebuilt));
        if (k % 2) CHECK_OK(dem_neighbours_rebuild(rebuilt)); /* also twice in a row */
        CHECK_OK(dem_run(rebuilt, 50));
    }
    /* a lost spring would shift a grain by mu m g / k_s = 1e-4 */
    CU_ASSERT(distance(sim, rebuilt) < 1e-9);
    size_t n, m;
    double spring_a = 0.0, spring_b = 0.0, roll_a = 0.0, roll_b = 0.0;
    scoped dem_contact *a = grains_contacts(sim, &n), *b = grains_contacts(rebuilt, &m);
    CU_ASSERT_EQUAL(n, m);
    for (size_t k = 0; k < n; k++) spring_a += fabs(a[k].shear_spring), roll_a += fabs(a[k].rolling_spring);
    for (size_t k = 0; k < m; k++) spring_b += fabs(b[k].shear_spring), roll_b += fabs(b[k].rolling_spring);
    CU_ASSERT(spring_a > 1e-4);
    CHECK_NEAR(spring_a, spring_b, 1e-9);
    CU_ASSERT((roll_a > 1e-4) == rotation);
    CHECK_NEAR(roll_a, roll_b, 1e-9);
}

EITHER(extra_rebuilds)

static bool same_wall_forces(const dem_sim *a, const dem_sim *b)
{
    double f[2 * DEM_FEW_WALLS] = {0}, g[2 * DEM_FEW_WALLS] = {0};
    grains_wall_forces(a, f);
    grains_wall_forces(b, g);
    return memcmp(f, g, sizeof f) == 0;
}

/* Integration right behind the pair loop against integration after all forces. */
static void integration_behind_the_pair_loop_of(bool rotation)
{
    enum { N = 400, PARTS = 4 };
    const long part = check_fast() ? 700 : 2500;
    dem_definition def = grains_outflow(N, part, rotation);
    def.kernel = DEM_REFERENCE;
    dem_sim *reference[PARTS + 1] = {grains_start_in_chunks(&def, 0)};
    for (int k = 0; k < PARTS; k++) {
        CHECK_OK(dem_clone(reference[k], &reference[k + 1]));
        CHECK_OK(dem_run(reference[k + 1], part));
    }
    CU_ASSERT(dem_count(reference[PARTS]) < N - 20);
    for (def.kernel = DEM_BASELINE; def.kernel < DEM_KERNELS; def.kernel++) {
        if (!dem_kernel_runs(def.kernel)) continue;
        dem_sim *sim = grains_start_in_chunks(&def, 64), *copy;
        for (int k = 1; k <= PARTS; k++) {
            CHECK_OK(dem_clone(sim, &copy));
            CU_ASSERT(copy->pairs.n_chunks == sim->pairs.n_chunks);
            dem_free(sim);
            sim = copy;
            CHECK_OK(dem_run(sim, part));
            CU_ASSERT(grains_same_bits(sim, reference[k]) && same_wall_forces(sim, reference[k]));
            CU_ASSERT(grains_energy(sim) == grains_energy(reference[k])); /* springs too */
            if (k == 2)
                CU_ASSERT(sim->pairs.n_chunks > 6 && sim->pairs.done[sim->pairs.n_chunks / 2] > N / 4);
        }
        dem_free(sim);
    }
    for (int k = 0; k <= PARTS; k++) dem_free(reference[k]);
}

EITHER(integration_behind_the_pair_loop)

/* Number of steps with a grain beyond its Verlet margin, or with a bound of its group above what remains. */
static long beyond_margins(dem_sim *sim, int steps)
{
    long beyond = 0;
    for (int k = 0; k < steps; k++) {
        sim->pairs.n_chunks = 1; /* as in a large pile */
        CHECK_OK(dem_run(sim, 1));
        for (size_t i = 0; i < sim->grains.n; i++) {
            const dem_vec way = sim->grains.motion[i].x - sim->grains.listed_x[i];
            const double rest = sqrt(sim->grains.margin2[i]) - sqrt(dem_dot(way, way));
            beyond += !(rest >= 0.0 && sim->grains.slack[i / DEM_GROUP] <= rest);
        }
    }
    return beyond;
}

static void margins_of(bool hard, int kernel)
{
    enum { N = 150 };
    dem_grain *grains;
    dem_definition def = grains_box(N, 3.0, 4, &grains);
    for (int i = 0; i < N; i++) grains[i].vx = 100.0 * (i % 5 - 2), grains[i].vy = i % 3 ? -200.0 : 0.0;
    def.dt = 2e-5, def.kernel = kernel, def.x_max = 3.1;
    def.walls[DEM_BOX_RIGHT].open_at_step = 500;
    if (hard) def.hard = (dem_hard){.on = true, .restitution = 0.1, .mu = 0.2}, def.tension = false;
    scoped_sim *sim = grains_start(&def);
    CU_ASSERT(beyond_margins(sim, 3000) == 0 && sim->grains.n < N && sim->count.rebuilds < 500);
    CHECK_OK(dem_neighbours_rebuild(sim));
    CU_ASSERT(sim->grains.slack[0] == 0.0 &&
              sim->grains.slack[1] == 0.0); /* it would be that of other grains */
    CU_ASSERT(beyond_margins(sim, 1) == 0);
    sim->pairs.n_chunks = 1;
    sim->grains.motion[sim->grains.n / 2].v[0] = NAN;
    CHECK_FAILS(dem_run(sim, 1), RP_BROKEN, "non_finite");
}

/* Two grains that stop one another at different times between two rebuilds. */
static void margins_of_two(void)
{
    for (int k = 0; k < 60; k++) {
        dem_grain two[2] = {{-0.5 - 0.002 * k, 0.0, 0.1, 0.004, 300.0, 0.0},
                            {0.5 + 0.002 * k, 0.0, 0.1, 0.004, -300.0, 0.0}};
        dem_definition def = grains_afloat(2, two);
        def.dt = 1e-5, def.tension = false, def.hard.on = true;
        scoped_sim *sim = grains_start(&def);
        CU_ASSERT(beyond_margins(sim, 200) == 0 && sim->count.collisions == 1);
    }
}

/* Disks at rest, each hit by a hard collision in the same step: disks beyond their margins get new ones. */
static void margins_of_many_hit(size_t pairs)
{
    enum { MOST = 20 };
    long rebuilds = 0;
    for (int k = 0; k < 30; k++) {
        dem_grain grains[2 * MOST];
        for (size_t p = 0; p < pairs; p++) {
            grains[2 * p] = (dem_grain){0.0, 2.0 * (double)p, 0.1, 0.004, 0.0, 0.0};
            grains[2 * p + 1] = (dem_grain){0.4 + 0.001 * k, 2.0 * (double)p, 0.1, 0.004, -300.0, 0.0};
        }
        dem_definition def = grains_afloat(2 * pairs, grains);
        def.dt = 1e-4, def.normal = DEM_LINEAR, def.material.k_n = 1e3;
        def.tension = false;
        def.hard = (dem_hard){.on = true, .restitution = 1.0};
        scoped_sim *sim = grains_start(&def);
        const long before = sim->count.rebuilds;
        for (int step = 0; sim->count.collisions == 0 && step < 20; step++) {
            CHECK_OK(dem_run(sim, 1));
            for (size_t i = 0; i < sim->grains.n; i++) {
                const dem_vec way = sim->grains.motion[i].x - sim->grains.listed_x[i];
                CU_ASSERT(dem_dot(way, way) <= sim->grains.margin2[i]);
            }
        }
        CU_ASSERT(sim->count.collisions == (long)pairs);
        rebuilds += sim->count.rebuilds - before;
    }
    CU_ASSERT(rebuilds > 0);
}

static void margins(void)
{
    margins_of_two();
    margins_of_many_hit(2);
    margins_of_many_hit(20);
    for (int kernel = DEM_REFERENCE; kernel < DEM_KERNELS; kernel++)
        for (int hard = 0; hard < 2 && dem_kernel_runs(kernel); hard++) margins_of(hard, kernel);
}

/* The rotation of gravity keeps its length and accumulates to the angle. */
static void gravity_turns(void)
{
    dem_grain grain = {0.0, 0.0, 0.1, 0.004, 0.0, 0.0};
    dem_definition def = grains_of(1, &grain);
    scoped_sim *sim = grains_start(&def);
    double g[2], rate = 1e-3 * M_PI / 180.0;
    dem_gravity_turn(sim, rate);
    CHECK_OK(dem_run(sim, 30000));
    dem_gravity(sim, g);
    /* 30000 products of rounding errors of some eps each */
    CHECK_PAIRS(1e-9, {g[0], 981.0 * sin(30000 * rate)}, {g[1], -981.0 * cos(30000 * rate)});
    CHECK_NEAR(hypot(g[0], g[1]), 981.0, 1e-12 * 981.0);
    dem_gravity_turn(sim, 0.0);
    CHECK_OK(dem_run(sim, 10));
    dem_gravity(sim, g);
    CHECK_NEAR(g[0], 981.0 * sin(30000 * rate), 1e-9);
    /* any angle a step, any unit of length; the norm is that of the start */
    def.gravity[1] = -0.3;
    grains_again(&sim, &def, 0);
    dem_gravity_turn(sim, 1.0);
    CHECK_OK(dem_run(sim, 2000));
    dem_gravity(sim, g);
    CHECK_PAIRS(1e-12, {g[0], 0.3 * sin(2000.0)}, {g[1], -0.3 * cos(2000.0)});
    CHECK_NEAR(hypot(g[0], g[1]), 0.3, 1e-16);
}

/* Their series has 24 terms: at pi the first one left out is pi^24/24! = 1.4e-12 of the cosine. */
static void sine_and_cosine(void)
{
    for (int k = -8; k <= 8; k++) {
        double s = NAN, c = NAN;
        const double angle = 0.125 * k * M_PI;
        dem_sine_cosine(angle, &s, &c);
        CHECK_NEAR(s, sin(angle), abs(k) == 8 ? 2e-13 : 1e-13);
        CHECK_NEAR(c, cos(angle), abs(k) == 8 ? 1.5e-12 : 1e-13);
    }
}

/* A frictionless undamped grain slides off a finite floor, around the corner and below: energy is conserved,
 * the direction of the force is continuous, and no leak is reported. */
static void floor_that_ends(void)
{
    const double r = 0.1, m = 0.0042, g = 981.0, k = 2e6;
    dem_grain grain = {0.8, r - pow(m * g / k, 2.0 / 3.0), r, m, 3.0, 0.0};
    dem_definition def = grains_bare(1, &grain, DEM_HERTZ, (dem_material){.k_n = 1e6});
    def.gravity[1] = -g, def.dt = 1e-5;
    put_wall(&def, 0.0, 0.0, 0.0, 1.0);
    def.walls[0].extent[1] = 1.0, def.y_min = -0.4;
    scoped_sim *sim = grains_start(&def);
    dem_state s;
    const double start = grains_energy(sim);
    double lowest = 1.0, most = 0.0;
    for (long step = 0; step < 40000 && dem_count(sim) == 1; step++) {
        CHECK_OK(dem_run(sim, 1));
        if (dem_count(sim) == 0) break;
        lowest = fmin(lowest, grains_state_of_one(sim).y);
        most = fmax(most, fabs(grains_energy(sim) - start));
    }
    CU_ASSERT(dem_count(sim) == 0); /* dropped below y_min */
    CU_ASSERT(lowest < -0.3);
    CHECK_NEAR(most, 0.0, 1e-4 * m * g * 0.4); /* second order in dt at the soft corner */
    /* thrown back under the floor, it bounces off the underside without a reported leak */
    grain = (dem_grain){1.09, -0.15, r, m, -30.0, 20.0};
    grains_again(&sim, &def, 0);
    grains_run(sim, 300, &s);
    CU_ASSERT(s.vy < 0.0 && s.y < 0.0);
}

/* The same without a rebuild of the neighbour list: past the corner the grain is below the floor. */
static void corner_without_rebuild(void)
{
    dem_grain grain = {1.15, 0.12, 0.1, 0.0042, 0.0, -150.0};
    dem_definition def = grains_of(1, &grain);
    def.material.mu = 0.0, def.skin = 3.0;
    def.gravity[0] = -40000.0; /* round the corner and back under the floor */
    put_wall(&def, 0.0, 0.0, 0.0, 1.0);
    def.walls[0].extent[1] = 1.0;
    scoped_sim *sim = grains_start(&def);
    dem_state s;
    grains_run(sim, 90, &s);
    CU_ASSERT(grains_counts(sim).rebuilds == 1 && s.x < 1.0 && s.y < -0.1);
}

/* A shear spring ends with its contact: a grain that bounces between a heavy grain and a ceiling, sliding
 * slowly, starts each contact with the displacement of one step, not with the former spring. */
static void springs_end_of(bool rolling)
{
    dem_grain grains[2] = {{0.0, 0.25, 0.1, 0.0042, 0.1, -20.0}, {0.0, -9.0, 9.0, 1e12, 0.0, 0.0}};
    dem_definition def = grains_afloat(2, grains);
    def.material.gamma_n = 1e-9, def.material.gamma_s = 0.0, def.dt = 2.5e-5;
    def.material.mu = 10.0; /* it never slips */
    if (rolling) {          /* rotation without translation; too soft to reverse it */
        def.rotation = true, def.material.mu = def.material.gamma_roll = 0.0;
        def.material.mu_roll = 10.0, def.material.k_roll = 1e-3;
        grains[0].omega = 1.0;
    }
    put_wall(&def, 0.0, 0.5, 0.0, -1.0);
    scoped_sim *sim = grains_start(&def);
    int touches = 0;
    size_t before = 0;
    double longest = 0.0;
    for (int step = 0; step < 10000; step++) {
        size_t n;
        CHECK_OK(dem_run(sim, 1));
        scoped dem_contact *c = grains_contacts(sim, &n);
        /* 0.1 cm/s along x, and as much again from the slope of the heavy grain where it has drifted to */
        const double spring = n == 0 ? 0.0 : fabs(rolling ? c[0].rolling_spring : c[0].shear_spring);
        if (n == 1 && before == 0) {
            touches++;
            CU_ASSERT(spring <= 3.0 * 0.1 * def.dt);
        }
        longest = fmax(longest, spring);
        before = n;
    }
    CU_ASSERT(touches >= 10);
    CU_ASSERT(longest > 10.0 * 0.1 * def.dt); /* detects a spring that did not end */
}

EITHER(springs_end)

/* The couple of two unequal counter-rotating grains without friction: displacement R_eff (omega_a
 * - omega_b) dt after a step, R_eff = r_a r_b/(r_a + r_b). */
static void rolling_couple(void)
{
    dem_grain grains[2] = {{0.0, 0.0, 0.1, 0.0042, 0.0, 0.0, 0.0, 3.0},
                           {0.27, 0.0, 0.1739, 0.0222, 0.0, 0.0, 0.0, -11.0}};
    dem_definition def = grains_afloat(2, grains);
    def.rotation = true, def.material.mu = def.material.gamma_s = def.material.gamma_roll = 0.0;
    def.material.mu_roll = 0.3;
    scoped_sim *sim = grains_start(&def);
    dem_state s[2];
    const double r_eff = 0.1 * 0.1739 / 0.2739, xi = r_eff * (3.0 + 11.0) * def.dt;
    grains_run(sim, 1, s);
    const dem_contact c = grains_only_contact(sim);
    const double sign = c.id_a == 1 ? 1.0 : -1.0;
    CHECK_NEAR(c.rolling_spring, sign * xi, 1e-12 * xi);
    CHECK_NEAR(s[0].torque, -r_eff * def.material.k_roll * xi, 1e-12);
    CHECK_NEAR(s[1].torque, r_eff * def.material.k_roll * xi, 1e-12);
    CHECK_NEAR(c.rolling_torque, sign * s[0].torque, 1e-15);
}

enum { SPINNING = 80 };

/* Reported contacts against net forces and torques; number of sliding contacts. */
static size_t sliding_of_sums(const dem_sim *sim)
{
    enum { N = SPINNING };
    double sums[N + 1][3] = {{0.0}}; /* per id: force, torque; id 0 for the walls */
    size_t n, sliding = 0;
    scoped dem_contact *c = grains_contacts(sim, &n);
    CU_ASSERT_EQUAL_FATAL(dem_count(sim), N);
    scoped dem_state *s = grains_states(sim);
    for (size_t k = 0; k < n; k++) {
        const double dx = c[k].x - c[k].x_b, dy = c[k].y - c[k].y_b, d = hypot(dx, dy);
        const double fx = (c[k].normal_force * dx + c[k].shear_force * dy) / d,
                     fy = (c[k].normal_force * dy - c[k].shear_force * dx) / d;
        const double arm_a = c[k].id_b == 0 ? d : s[c[k].id_a - 1].r - 0.5 * c[k].overlap;
        double *a = sums[c[k].id_a], *b = sums[c[k].id_b];
        a[0] += fx, a[1] += fy, a[2] += arm_a * c[k].shear_force + c[k].rolling_torque;
        b[0] -= fx, b[1] -= fy, b[2] += (d - arm_a) * c[k].shear_force - c[k].rolling_torque;
        const double cap = 0.2 * fmax(c[k].normal_force, 0.0);
        CU_ASSERT(fabs(c[k].shear_force) <= cap * (1.0 + 1e-12));
        sliding += fabs(c[k].shear_force) > cap * (1.0 - 1e-9);
    }
    CU_ASSERT(n > N && sliding < n);
    for (int i = 0; i < N; i++) {
        CHECK_NEAR(sums[i + 1][0], s[i].fx, 1e-9); /* dyn; a grain weighs some 4 */
        CHECK_NEAR(sums[i + 1][1] - 981.0 * s[i].m, s[i].fy, 1e-9);
        CHECK_NEAR(sums[i + 1][2], s[i].torque, 1e-10);
    }
    return sliding;
}

/* In an avalanche of spinning grains, and also in a rotating box. */
static void contacts_add_up(void)
{
    enum { N = SPINNING };
    dem_definition def = grains_box(N, 2.0, 25, NULL);
    def.rotation = true, def.damping = DEM_DAMPING_INSIDE, def.material.gamma_s = 200.0;
    def.material.mu_roll = 0.1;
    for (int w = 0; w < 3; w++) def.walls[w].material.mu_roll = 0.07;
    def.walls[2].open_at_step = 4000;
    scoped_sim *sim = grains_after(&def, 5000);
    CU_ASSERT(sliding_of_sums(sim) > 0);
    dem_box_turn(sim, 1e-4);
    CHECK_OK(dem_run(sim, 3));
    sliding_of_sums(sim);
}

/* A lifted wall drags a touching grain upwards. */
static void lifted_wall_drags(void)
{
    dem_grain grain = {0.9003, 0.5, 0.1, 0.0042, 0.0, 0.0};
    dem_definition def = grains_afloat(1, &grain);
    def.gravity[0] = 981.0;
    put_wall(&def, 1.0, 0.0, -1.0, 0.0);
    def.walls[0].extent[0] = 0.0, def.walls[0].open_at_step = 0, def.walls[0].open_speed = 2.0;
    scoped_sim *sim = grains_after(&def, 2000);
    const dem_state s = grains_state_of_one(sim);
    CU_ASSERT(s.vy > 0.5 && s.y > 0.51);
    /* opened again it goes on from where it is, and what is gone stays gone */
    const double end = dem_wall_now(sim, 0).ends[0];
    CHECK_OK(dem_wall_open(sim, 0, 2.0));
    CHECK_OK(dem_run(sim, 1));
    CHECK_NEAR(dem_wall_now(sim, 0).ends[0], end + 2.0 * def.dt, 1e-12);
    CHECK_OK(dem_wall_open(sim, 0, 20.0));
    CHECK_OK(dem_run(sim, 2));
    CHECK_NEAR(dem_wall_now(sim, 0).ends[0], end + 22.0 * def.dt, 1e-12);
    CHECK_OK(dem_wall_open(sim, 0, INF));
    CHECK_OK(dem_run(sim, 2));
    CHECK_OK(dem_wall_open(sim, 0, 2.0));
    CHECK_OK(dem_run(sim, 1));
    CU_ASSERT(dem_wall_now(sim, 0).ends[0] == dem_wall_now(sim, 0).ends[1]);
}

/* A grain is removed at the step at which its centre passes x_max or y_min; the others continue. */
static void outlet(void)
{
    dem_grain grains[3] = {{0.0, 3.0, 0.1, 0.0042, 10.0, 0.0},
                           {0.0, 1.0, 0.1, 0.0042, 0.0, -10.0},
                           {-0.5, 2.0, 0.1, 0.0042, 0.0, 0.0}};
    dem_definition def = grains_afloat(3, grains);
    def.x_max = 0.30125; /* passed in step 603 of 5e-4 each */
    def.y_min = 0.49975; /* passed in step 1001 */
    scoped_sim *sim = grains_after(&def, 602);
    CU_ASSERT_EQUAL(dem_count(sim), 3);
    CHECK_OK(dem_run(sim, 1));
    CU_ASSERT_EQUAL(dem_count(sim), 2);
    CHECK_OK(dem_run(sim, 397));
    CU_ASSERT_EQUAL(dem_count(sim), 2);
    CHECK_OK(dem_run(sim, 1));
    CU_ASSERT_EQUAL(dem_count(sim), 1);
    dem_state s;
    grains_run(sim, 100, &s);
    CU_ASSERT(s.id == 3 && s.x == -0.5 && s.y == 2.0);
    def.n_grains = 1; /* the last to go */
    grains_again(&sim, &def, 602);
    CU_ASSERT_EQUAL(dem_count(sim), 1);
    CHECK_OK(dem_run(sim, 1));
    CU_ASSERT_EQUAL(dem_count(sim), 0);
}

/* A lifted wall releases grains below, and holds those above. */
static void lifted_wall(void)
{
    dem_grain grains[2] = {{0.9, 0.1, 0.1, 0.0042, 0.0, 0.0}, {0.9, 0.8, 0.1, 0.0042, 50.0, 0.0}};
    dem_definition def = grains_afloat(2, grains);
    def.material.mu = 0.0;
    put_wall(&def, 1.0, 0.0, -1.0, 0.0);
    def.walls[0].extent[0] = -0.2, def.walls[0].open_at_step = 100;
    def.walls[0].open_speed = 100.0;
    grains[0].vx = 30.0;
    scoped_sim *sim = grains_after(&def, 99);
    dem_state s[2];
    dem_states(sim, s);
    CU_ASSERT(s[0].vx < 0.0 && s[1].vx < 0.0); /* both came back from the closed wall */
    def.walls[0].open_at_step = 1; /* 0.1 s for the lower end to pass y = 0.8: too late for the upper grain */
    grains[0].x = 0.6;
    grains_again(&sim, &def, 0);
    grains_run(sim, 700, s);
    CU_ASSERT(s[0].x > 1.2 && s[1].x < 1.0 && s[1].vx < 0.0);
    def.walls[0].extent[1] = -0.1; /* lifted past its upper end: no corner remains for a grain above */
    grains[0] = (dem_grain){1.0, 0.5, 0.1, 0.0042, 0.0, 0.0};
    grains_again(&sim, &def, 0);
    grains_run(sim, 700, s);
    CU_ASSERT(s[0].x == 1.0 && s[0].y == 0.5);
}

static void filling(void)
{
    const dem_fill fill = {500, 4.0, 9.0, 0.1, 0.02, 0.07, 0.13, 1.3, DEM_DISK, 1993, 4};
    dem_grain a[500], b[500];
    CHECK_OK(dem_fill_grains(&fill, a, &(size_t){0}));
    CHECK_OK(dem_fill_grains(&fill, b, &(size_t){0}));
    CU_ASSERT(memcmp(a, b, sizeof a) == 0);
    for (int i = 0; i < 500; i++) {
        CU_ASSERT(a[i].r >= 0.07 && a[i].r <= 0.13);
        CU_ASSERT(a[i].x >= a[i].r && a[i].x <= 4.0 - a[i].r && a[i].y >= a[i].r && a[i].y <= 9.0 - a[i].r);
        CHECK_NEAR(a[i].m, 1.3 * M_PI * a[i].r * a[i].r, 1e-15);
        for (int j = 0; j < i; j++) CU_ASSERT(hypot(a[i].x - a[j].x, a[i].y - a[j].y) >= a[i].r + a[j].r);
    }
    /* radii that are given already: the same places */
    memset(b, 0, sizeof b);
    for (int i = 0; i < 500; i++) b[i].r = a[i].r;
    CHECK_OK(dem_fill_place(&fill, b));
    CU_ASSERT(memcmp(a, b, sizeof a) == 0);
    dem_fill other = fill;
    other.run = 5;
    CHECK_OK(dem_fill_grains(&other, b, &(size_t){0}));
    CU_ASSERT(a[0].x != b[0].x && a[0].r != b[0].r);
    other.W = 0.9, other.H = 1.0;
    CHECK_FAILS(dem_fill_grains(&other, b, &(size_t){0}), RP_NO_RESULT, "of N = ");
    long first, have;
    CU_ASSERT(sscanf(rp_message(),
                     "no room for grain %ld of N = 500, of radius 0.%*d, in W = 0.9, H = 1: %ld have room;",
                     &first, &have) == 2 &&
              have == first - 1);
}

/* A distant added grain changes no bit of the others, except through the rebuild of the list. A refused large
 * grain does not change the cells, nor the order of sums. */
static void added_far_away_of(bool rotation)
{
    dem_definition def = grains_box(80, 2.2, 6, NULL);
    def.rotation = rotation;
    def.n_walls = 1; /* the pile spreads over the floor */
    scoped_sim *sim = grains_after(&def, 6000), *more = NULL;
    CHECK_OK(dem_clone(sim, &more));
    uint32_t id = 0;
    CHECK_OK(dem_add(more, &(dem_grain){-60.0, 0.08, 0.08, 0.002, 0.0, 0.0}, &id));
    CU_ASSERT(id == 81 && dem_count(more) == 81);
    CHECK_FAILS(dem_add(sim, &(dem_grain){-50.0, 0.9, 1.0, 4.2, 0.0, 0.0}, &id), RP_NO_ROOM,
                "touches wall 1");
    CHECK_OK(dem_neighbours_rebuild(sim));
    dem_state a[80], b[81];
    memset(a, 0, sizeof a), memset(b, 0, sizeof b);
    grains_run(sim, 6000, a);
    grains_run(more, 6000, b);
    CU_ASSERT(memcmp(a, b, sizeof a) == 0 && b[80].id == 81 && b[80].x == -60.0 && b[80].contacts == 1);
}

EITHER(added_far_away)

/* Grains added one by one at the start equal those of the definition, for any capacity and cells; a grain
 * added later falls on a parabola, exact in leapfrog. */
static void added_one_by_one(void)
{
    enum { N = 300, FALL = 400 };
    dem_grain *grains;
    dem_definition def = grains_box(N, 3.0, 8, &grains), first = def;
    first.n_grains = 1;
    scoped_sim *all = grains_start(&def), *sim = grains_start(&first);
    uint32_t id = 0;
    for (uint32_t i = 1; i < N; i++) {
        CHECK_OK(dem_add(sim, &grains[i], &id));
        CU_ASSERT(id == i + 1);
    }
    CHECK_OK(dem_run(all, 1000));
    CHECK_OK(dem_run(sim, 1000));
    CU_ASSERT(distance(all, sim) < 1e-9); /* different order of the cells: round-off */
    CHECK_OK(dem_run(sim, 5000));         /* settled */
    const double y = 6.0, r = 0.5, vx = 0.3, g = 981.0, t = FALL * def.dt;
    CHECK_OK(dem_add(sim, &(dem_grain){1.5, y, r, 0.1, vx, -1.0}, NULL));
    dem_state s[N + 1];
    grains_run(sim, FALL, s);
    CHECK_NEAR(s[N].y, y - t - 0.5 * g * t * t, 1e-12); /* round-off of 400 steps */
    CHECK_NEAR(s[N].x, 1.5 + vx * t, 1e-12);
    CHECK_NEAR(s[N].vy, -1.0 - g * t, 1e-10);
    int touching = 0;
    double fastest = 0.0;
    for (int i = 0; i <= N; i++) {
        CU_ASSERT(dem_contact_count(sim, s[i].id) == s[i].contacts);
        touching += s[i].contacts > 0;
        if (s[i].x > 0.8 && s[i].x < 1.4) fastest = fmax(fastest, hypot(s[i].vx, s[i].vy));
    }
    CU_ASSERT(touching > N / 2 && fastest > 0.0 && dem_contact_count(sim, N + 2) == 0);
    CHECK_NEAR(dem_largest_speed(sim, 0.8, 1.4), fastest, 1e-15 * fastest);
    CHECK_NEAR(dem_largest_speed(sim, 0.0, 3.0), hypot(s[N].vx, s[N].vy), 1e-9);
    /* the new grain is the largest, so that the cells grow: no contact is missed */
    grains_run(sim, 5000, s);
    int near = 0;
    for (int i = 0; i < N; i++) near += hypot(s[i].x - s[N].x, s[i].y - s[N].y) < s[i].r + r;
    CU_ASSERT(near > 2 && near == s[N].contacts);
}

/* Gear's scheme gives the exact parabola too; with rotation the new grain keeps its spin. */
static void added_by_either_scheme(void)
{
    const double g = 981.0;
    dem_grain one = {.y = 1.0, .r = 0.1, .m = 0.004};
    dem_state s[2];
    for (int gear = 0; gear < 2; gear++) {
        dem_definition def = grains_of(1, &one);
        def.integrator = gear ? DEM_GEAR5 : DEM_VERLET;
        def.rotation = !gear;
        def.dt = 2e-5; /* Gear's limit is the lower */
        const double omega = gear ? 0.0 : 2.385, t = 300 * def.dt;
        scoped_sim *sim = grains_after(&def, 100);
        CHECK_OK(dem_add(
            sim, &(dem_grain){.x = 3.0, .y = 2.0, .r = 0.1, .m = 0.004, .vy = -7.0, .omega = omega}, NULL));
        grains_run(sim, 300, s);
        CHECK_NEAR(s[1].y, 2.0 - 7.0 * t - 0.5 * g * t * t, 1e-12); /* round-off of 300 steps */
        CHECK_NEAR(s[1].vy, -7.0 - g * t, 1e-11);
        CHECK_NEAR(s[1].angle, omega * t, 1e-13);
        CU_ASSERT(s[1].omega == omega);
        CHECK_FAILS(dem_add(sim, &(dem_grain){.x = 9.0, .r = 0.1, .m = 0.004, .fixed = true}, NULL),
                    RP_BAD_INPUT, "must be there from the start");
    }
}

/* Ids are unique, and a refused grain leaves the simulation unchanged. */
static void added_names_and_errors(void)
{
    dem_grain one = {0.0, 1.0, 0.1, 0.004, 0.0, 0.0};
    dem_definition def = grains_of(1, &one);
    def.y_min = -0.5, def.n_walls = 2;
    def.walls[0] = line(0.0, 0.0, 0.0, 1.0, &def.material);
    def.walls[0].extent[1] = 1.0; /* ends at x = 1 */
    def.walls[1] = line(-3.0, 0.0, 1.0, 0.0, &def.material);
    scoped_sim *sim = grains_start(&def), *same = NULL;
    uint32_t id;
    CHECK_OK(dem_add(sim, &(dem_grain){2.0, -0.4, 0.1, 0.004, 0.0, 0.0}, &id));
    CHECK_OK(dem_run(sim, 40000)); /* the last grain falls out, the first comes to rest */
    CU_ASSERT(dem_count(sim) == 1);
    CHECK_OK(dem_clone(sim, &same));
#define REFUSES(status, text, ...) CHECK_FAILS(dem_add(sim, &(dem_grain){__VA_ARGS__}, &id), status, text)
    REFUSES(RP_BAD_INPUT, "new particle: r = 0", 2.0, 2.0, 0.0, 0.004, 0.0, 0.0);
    REFUSES(RP_BAD_INPUT, "m = -1", 2.0, 2.0, 0.1, -1.0, 0.0, 0.0);
    REFUSES(RP_BAD_INPUT, "must be finite", 2.0, NAN, 0.1, 0.004, 0.0, 0.0);
    REFUSES(RP_BAD_INPUT, "beyond y_min", 2.0, -0.6, 0.1, 0.004, 0.0, 0.0);
    REFUSES(RP_NO_ROOM, "touches grain 1", 0.05, 0.1, 0.1, 0.004, 0.0, 0.0);
    REFUSES(RP_NO_ROOM, "touches wall 1", 0.5, 0.09, 0.1, 0.004, 0.0, 0.0);
    REFUSES(RP_NO_ROOM, "touches wall 1", 1.05, 0.08, 0.1, 0.004, 0.0, 0.0); /* at the corner */
    REFUSES(RP_NO_ROOM, "touches wall 2", -5.0, 2.0, 0.1, 0.004, 0.0, 0.0);  /* behind the line */
    REFUSES(RP_TOO_FAST, "dt = 5e-05: too large", 0.5, 0.5, 0.1, 1e-7, 0.0, 0.0);
#undef REFUSES
    CHECK_OK(dem_run(sim, 500));
    CHECK_OK(dem_run(same, 500));
    CU_ASSERT(grains_same_bits(sim, same));
    CHECK_OK(dem_add(sim, &(dem_grain){1.1, 0.1, 0.1, 0.004, 0.0, 0.0}, &id));
    CU_ASSERT(id == 3);
    CHECK_OK(dem_add(sim, &(dem_grain){0.5, -0.3, 0.1, 0.004, 0.0, 0.0}, &id)); /* below a wall that ends */
}

/* Faults of grains stop the run with a message that has step and grain. */
static void faults(void)
{
    dem_grain grains[2] = {{0.0, 0.5, 0.1, 0.004, 0.0, 0.0}, {0.0, 0.9, 0.1, 0.004, 0.0, 0.0}};
    dem_definition def = grains_of(2, grains);
    put_wall(&def, 0.0, 0.0, 0.0, 1.0);
    def.walls[0].material.k_n = 10.0; /* too soft to carry the fall */
    scoped_sim *sim = grains_start(&def);
    CHECK_FAILS(dem_run(sim, 100000), RP_BROKEN, "grain 1: its centre passed wall 1");
    CU_ASSERT_EQUAL(dem_sim_fault(sim), DEM_FAULT_LEAKED);

    def.n_walls = 0, def.gravity[1] = 0.0, def.material.k_n = 1.0;
    def.material.gamma_n = 0.0;
    grains[1].vy = -200.0;
    for (def.kernel = DEM_FAST; def.kernel < DEM_KERNELS; def.kernel++) {
        if (!dem_kernel_runs(def.kernel)) continue;
        grains_again(&sim, &def, 0);
        CHECK_FAILS(dem_run(sim, 100000), RP_BROKEN, "overlap at step 31:");
        CU_ASSERT_EQUAL(dem_sim_fault(sim), DEM_FAULT_OVERLAP);
    }

    def = grains_of(1, grains);
    def.gravity[1] = -1e9;
    grains_again(&sim, &def, 0);
    CHECK_FAILS(dem_run(sim, 100000), RP_BROKEN, "too_fast at step");
    def.gravity[1] = -1e308, def.dt = 1e100, def.material.k_n = def.material.k_s = 1e-300;
    def.material.gamma_n = def.material.gamma_s = 0.0;
    grains_again(&sim, &def, 0);
    CHECK_FAILS(dem_run(sim, 100000), RP_BROKEN, "non_finite at step");
}

/* Which of some pairs and grains at walls are looked at, and what is said: an overlap may be as large as the
 * smaller radius, at a wall as the radius. */
static void overlaps_too_deep(void)
{
    dem_grain grains[4];
    for (int i = 0; i < 4; i++)
        grains[i] = (dem_grain){.x = 0.3125 * i, .y = 0.1875, .r = 0.125 - 0.0625 * (i == 2), .m = 0.004};
    dem_definition def = grains_afloat(4, grains);
    def.skin = 0.3, def.n_walls = 2;
    for (int w = 0; w < 2; w++) def.walls[w] = grains_line(0.0, -0.5 + 0.5 * w, 0.0, 1.0, &def.material);
    scoped_sim *sim = grains_start(&def);
    dem_motion *at = sim->grains.motion;
    CU_ASSERT_EQUAL_FATAL(sim->pairs.n, 3);
    for (size_t k = 0; k < 3; k++) {
        const size_t i = sim->pairs.i[k], j = sim->pairs.j[k], low = i < j ? i : j;
        const double radii = grains[i].r + grains[j].r, smaller = fmin(grains[i].r, grains[j].r);
        for (size_t m = 0; m < 4; m++)
            at[m].x[0] = 0.3125 * (double)m - (m <= low ? 0.0 : 0.3125 - radii + smaller);
        for (size_t c = 0; c < 3; c++) sim->pairs.touching[0] |= 1ull << c;
        CHECK_OK(dem_check_overlaps(sim, (dem_stretch){0, 3},
                                    (dem_stretch){0, 4})); /* no more than the smaller radius */
        for (size_t m = low + 1; m < 4; m++) at[m].x[0] -= 0.015625;
        const char *text = check_text(
            "overlap at step 0: grain %zu: overlap %g with grain %zu, beyond the smaller radius %g", i + 1,
            smaller + 0.015625, j + 1, smaller);
        CHECK_FAILS(dem_check_overlaps(sim, (dem_stretch){0, 3}, (dem_stretch){0, 4}), RP_BROKEN, text);
        CU_ASSERT_EQUAL(dem_sim_fault(sim), DEM_FAULT_OVERLAP);
        CHECK_FAILS(dem_check_overlaps(sim, (dem_stretch){k, k + 1}, (dem_stretch){0, 0}), RP_BROKEN, text);
        CHECK_OK(dem_check_overlaps(sim, (dem_stretch){0, k}, (dem_stretch){0, 4}));
        CHECK_OK(dem_check_overlaps(sim, (dem_stretch){k + 1, 3}, (dem_stretch){0, 4}));
        at[i].x[0] = NAN;
        CHECK_FAILS(dem_check_overlaps(sim, (dem_stretch){k, k + 1}, (dem_stretch){0, 4}), RP_BROKEN,
                    "non_finite");
        CU_ASSERT_EQUAL(dem_sim_fault(sim), DEM_FAULT_NON_FINITE);
    }
    for (size_t i = 0; i < 4; i++) at[i].x = (dem_vec){0.3125 * (double)i, 0.1875};
    for (size_t i = 0; i < 4; i++) {
        at[i].x[1] = 0.0;
        CHECK_OK(dem_check_overlaps(sim, (dem_stretch){0, 0}, (dem_stretch){0, 4}));
        at[i].x[1] = -0.015625;
        const char *text =
            check_text("grain %zu: its centre passed wall 2 (overlap %g)", i + 1, grains[i].r + 0.015625);
        CHECK_FAILS(dem_check_overlaps(sim, (dem_stretch){0, 0}, (dem_stretch){0, 4}), RP_BROKEN, text);
        CU_ASSERT_EQUAL(dem_sim_fault(sim), DEM_FAULT_LEAKED);
        CHECK_FAILS(dem_check_overlaps(sim, (dem_stretch){0, 0}, (dem_stretch){i, i + 1}), RP_BROKEN, text);
        CHECK_OK(dem_check_overlaps(sim, (dem_stretch){0, 0}, (dem_stretch){0, i}));
        CHECK_OK(dem_check_overlaps(sim, (dem_stretch){0, 0}, (dem_stretch){i + 1, 4}));
        at[i].x[1] = NAN;
        CHECK_FAILS(dem_check_overlaps(sim, (dem_stretch){0, 0}, (dem_stretch){0, 4}), RP_BROKEN,
                    "non_finite");
        at[i].x[1] = 0.1875;
    }
}

/* What ranges_of_... below do not reach, and that all of them are asked. */
static void bad_definitions(void)
{
    dem_grain grains[2] = {{0.0, 0.5, 0.1, 0.004, 0.0, 0.0}, {0.0, 0.9, 0.1, 0.004, 0.0, 0.0}};
    const dem_grain good = grains[0];
    dem_definition def = grains_of(2, grains), bad;
    scoped_sim *sim = NULL;
    put_wall(&def, 0.0, 0.0, 0.0, 1.0);
#define REFUSES(change, text)                                                                                \
    do {                                                                                                     \
        bad = def;                                                                                           \
        change;                                                                                              \
        CHECK_FAILS(dem_create(&bad, &sim), RP_BAD_INPUT, text);                                             \
        CU_ASSERT_PTR_NULL(sim);                                                                             \
        grains[0] = good;                                                                                    \
    } while (0)
    REFUSES(bad.n_grains = 0, "no particles");
    REFUSES(grains[0].r = -0.1, "particle 1: r = -0.1");
    REFUSES(grains[0].y = 0.85, "overlap");
    REFUSES(grains[0].y = -0.05, "behind wall 1");
    REFUSES(bad.dt = 1e-3, "the limit is");
    REFUSES(bad.material.k_n = -1.0, "k_n = -1");
    REFUSES(bad.tangential = DEM_NONE, "needs a tangential law");
    REFUSES(bad.material.mu_roll = 0.1, "particles: mu_roll = 0.1: needs rotation");
    REFUSES(bad.walls[0].material.mu_roll = 0.1, "wall 1: mu_roll = 0.1: needs rotation");
    REFUSES((bad.rotation = true, bad.material.mu_roll = 0.1, bad.tangential = DEM_NONE,
             bad.material.mu = bad.walls[0].material.mu = 0.0),
            "mu_roll = 0.1: needs a tangential law");
    REFUSES(bad.n_walls = 9, "9 walls");
    REFUSES(bad.normal = (dem_normal_law)99, "normal = 99");
    REFUSES(bad.integrator = (dem_integrator)99, "integrator = 99");
    static const struct {
        dem_contact c;
        const char *text;
    } wrong[] = {
        {{.id_a = 0, .wall = -1}, "contact 1: of grain 0 with wall 0: there are 2 grains and 1 walls"},
        {{.id_a = 1, .wall = 1}, "of grain 1 with wall 2"},
        {{.id_a = 3, .id_b = 1}, "of grain 3 with grain 1"},
        {{.id_a = 1, .id_b = 3}, "of grain 1 with grain 3"},
        {{.id_a = 2, .id_b = 2}, "of grain 2 with grain 2"},
        {{.id_a = 1, .id_b = 2, .shear_spring = NAN}, "springs of nan and 0"}};
    for (size_t k = 0; k < sizeof wrong / sizeof *wrong; k++)
        REFUSES((bad.contacts = &wrong[k].c, bad.n_contacts = 1), wrong[k].text);
#undef REFUSES
    CHECK_OK(dem_create(&def, &sim));
    CHECK_FAILS(dem_wall_move(sim, 77, (double[]){1.0, 0.0}, 0.0), RP_BAD_INPUT, "wall 78: there are 1");
    CHECK_FAILS(dem_wall_open(sim, 77, INF), RP_BAD_INPUT, "wall 78: there are 1");
    CHECK_FAILS(dem_wall_open(sim, 0, NAN), RP_BAD_INPUT, "open_speed = nan");
    CHECK_FAILS(dem_gravity_set(sim, (double[]){NAN, 0.0}), RP_BAD_INPUT, "gravity = [nan, 0]");
    CHECK_FAILS(dem_gravity_turn(sim, INF), RP_BAD_INPUT, "turn of gravity = inf");
    CHECK_FAILS(dem_box_turn(sim, 3.0), RP_BAD_INPUT, "turn of the box = 3");
    CU_ASSERT(dem_wall_now(sim, 77).direction[1] == 0.0 && !dem_wall_now(sim, 0).open);
    bad = def, bad.n_walls = 0;
    CHECK_FAILS(dem_change(&sim, &bad), RP_BAD_INPUT, "0 walls: there are 1");
}

/* What a definition is before anything is given, and a box. */
static void defaults(void)
{
    const dem_definition def = dem_definition_default();
    CU_ASSERT(def.gravity[0] == 0.0 && def.gravity[1] == -981.0 && def.x_max == INF && def.y_min == -INF);
    CU_ASSERT(def.implicit.solver == DEM_SOLVER_DIRECT && def.implicit.relaxation == 0.7);
    CU_ASSERT(def.implicit.tolerance == 1e-15 && def.implicit.max_iterations == 1000);
    CU_ASSERT(def.tangential == DEM_SPRING && def.material.mu == 0.2 && def.n_walls == 0 && !def.hard.on);
    static const double at[3][4] = {{0.0, 0.0, 0.0, 1.0}, {0.0, 0.0, 1.0, 0.0}, {2.5, 0.0, -1.0, 0.0}};
    dem_definition box = def;
    dem_material wall = def.material;
    wall.mu = 0.7;
    dem_box_walls(&box, 2.5, &wall);
    CU_ASSERT_EQUAL(box.n_walls, 3);
    for (int w = 0; w < 3; w++) {
        const dem_wall *is = &box.walls[w];
        CU_ASSERT(is->point[0] == at[w][0] && is->point[1] == at[w][1]);
        CU_ASSERT(is->direction[0] == at[w][2] && is->direction[1] == at[w][3]);
        CU_ASSERT(is->extent[0] == -INF && is->extent[1] == INF && is->material.mu == 0.7);
        CU_ASSERT(is->open_at_step == -1 && is->open_speed == INF && !dem_wall_moves(is));
    }
}

/* A number of a definition, the last value that its range lets in, the first let out, what is said. */
typedef struct {
    double *at, in, out;
    const char *text;
} number_range;

static void check_ranges(const dem_definition *def, size_t n, const number_range *ranges)
{
    for (size_t k = 0; k < n; k++) {
        const number_range *r = &ranges[k];
        const double before = *r->at;
        *r->at = r->in;
        CHECK_OK(dem_laws_check(def));
        *r->at = r->out;
        CHECK_FAILS(dem_laws_check(def), RP_BAD_INPUT, r->text);
        *r->at = NAN;
        CHECK_FAILS(dem_laws_check(def), RP_BAD_INPUT, r->text);
        *r->at = before;
    }
}

/* Both sides of each limit, of the particles' material and of the last wall's. */
static void ranges_of_numbers(void)
{
    const double below = nextafter(1.0, 0.0), tiny = 1e-300, least = DBL_MIN;
    dem_definition def = dem_definition_default();
    def.rotation = true, def.material.mu_roll = 0.1, def.n_walls = 2;
    for (int w = 0; w < 2; w++) def.walls[w] = grains_line(0.0, 0.0, 1 - w, w, &def.material);
    dem_wall *w = &def.walls[1];
    for (int wall = 0; wall < 2; wall++) {
        dem_material *m = wall ? &w->material : &def.material;
        const char *whose = wall ? "wall 2: " : "particles: ";
        static const char *const names[] = {"k_n", "gamma_n", "k_s",    "gamma_s",
                                            "mu",  "mu_roll", "k_roll", "gamma_roll"};
        double *const at[] = {&m->k_n, &m->gamma_n, &m->k_s,    &m->gamma_s,
                              &m->mu,  &m->mu_roll, &m->k_roll, &m->gamma_roll};
        for (size_t k = 0; k < 8; k++) {
            const char *text = check_text("%s%s = ", whose, names[k]);
            const bool positive = k == 2 || k == 6, any = k == 4 || k == 5;
            const number_range both[] = {{at[k], positive ? least : 0.0, positive ? 0.0 : -tiny, text},
                                         {at[k], any ? INF : 1e308, any ? -INF : INF, text}};
            check_ranges(&def, 2, both);
        }
    }
    const number_range of_scene[] = {
        {&def.dt, least, 0.0, "dt = "},
        {&def.dt, 1e300, INF, "dt = "},
        {&def.skin, 0.0, -tiny, "skin = "},
        {&def.skin, 1e300, INF, "skin = "},
        {&def.gravity[0], 1e300, INF, "gravity and its turn"},
        {&def.gravity[1], 1e300, -INF, "gravity and its turn"},
        {&def.turn_per_step, below, 1.0, "the turn below one radian"},
        {&def.turn_per_step, -below, -1.0, "the turn below one radian"},
        {&def.box_turn_per_step, below, 1.0, "box_turn_per_step = "},
        {&def.box_turn_per_step, -below, -1.0, "box_turn_per_step = "},
        {&def.x_min, -INF, NAN, "x_min = nan"},
        {&def.x_max, INF, NAN, "x_max = nan"},
        {&def.y_min, -INF, NAN, "y_min = nan"},
        {&w->velocity[0], 1e300, INF, "wall 2: velocity, omega and pivot must be finite"},
        {&w->velocity[1], 1e300, INF, "velocity, omega and pivot must be finite"},
        {&w->omega, 1.0, INF, "velocity, omega and pivot must be finite"},
        {&w->pivot[0], 1e300, INF, "velocity, omega and pivot must be finite"},
        {&w->pivot[1], 1e300, INF, "velocity, omega and pivot must be finite"},
        {&w->point[0], 1e300, INF, "wall 2: point = ["},
        {&w->point[1], 1e300, INF, "wall 2: point = ["},
        {&w->open_speed, 0.0, -tiny, "wall 2: open_speed"},
        {&w->direction[0], 4e-5, 5e-5, "wall 2: direction"},
        {&w->direction[1], 1.0 + 9e-10, 1.0 + 1.1e-9, "wall 2: direction"},
        {&w->direction[1], -1.0 + 9e-10, 1.0 - 1.1e-9, "wall 2: direction"}};
    check_ranges(&def, sizeof of_scene / sizeof *of_scene, of_scene);
    def.dt = 0x1p-14;
    const number_range omega[] = {{&w->omega, 0x1.fffp13, 0x1p14, "omega"},
                                  {&w->omega, -0x1.fffp13, -0x1p14, "omega"}};
    check_ranges(&def, 2, omega);
    w->omega = 1.0;
    const number_range turn[] = {{&def.box_turn_per_step, 0.0, 1e-9, "not in a box that turns"},
                                 {&def.box_turn_per_step, -0.0, 0.999, "not in a box that turns"}};
    check_ranges(&def, 2, turn);
    def.hard.on = true, def.tension = false;
    const number_range hard[] = {{&def.hard.restitution, 0.0, -tiny, "hard: restitution"},
                                 {&def.hard.restitution, 1.0, 1.0 + 1e-15, "hard: restitution"},
                                 {&def.hard.mu, 0.0, -tiny, "hard: mu"},
                                 {&def.hard.mu, INF, -1.0, "hard: mu"}};
    check_ranges(&def, 4, hard);
}

/* Ends of a wall: in their order, and one below where it opens slowly. */
static void ranges_of_walls(void)
{
    dem_definition def = dem_definition_default();
    dem_wall good = grains_line(0.0, 0.0, 0.0, 1.0, &def.material), w = good;
    w.extent[0] = -1.0, w.extent[1] = -1.0;
    CHECK_FAILS(dem_wall_check(&w), RP_BAD_INPUT, "the first must be the smaller");
    w.extent[1] = nextafter(-1.0, 0.0);
    CHECK_OK(dem_wall_check(&w));
    for (int k = 0; k < 8; k++) { /* slowly, ever, without a lower end */
        w = good;
        if (k & 1) w.open_speed = 1.0;
        if (k & 2) w.open_at_step = 0;
        if (!(k & 4)) w.extent[0] = -1.0;
        CHECK_FAILS_IF(k == 7, dem_wall_check(&w), RP_BAD_INPUT, "needs a lower end");
        w.extent[0] = -1.0, w.omega = 1.0;
        CHECK_FAILS_IF(k % 4 == 3, dem_wall_check(&w), RP_BAD_INPUT, "can only open at once");
    }
}

/* Which walls may be the ground. */
static void ranges_of_ground(void)
{
    dem_definition def = dem_definition_default();
    def.tangential = DEM_SLIP_ROLL, def.n_walls = 2;
    for (int w = 0; w < 2; w++) def.walls[w] = grains_line(0.0, 0.0, 1 - w, w, &def.material);
    def.ground = (dem_ground){.wall = 2, .mu_static = 0.5, .a = 0.01};
    const number_range numbers[] = {{&def.ground.mu_static, 0.0, -1e-300, "ground: mu_static"},
                                    {&def.ground.a, DBL_MIN, 0.0, "ground: a"}};
    check_ranges(&def, 2, numbers);
    for (long wall = -1; wall <= 3; wall++) {
        def.ground.wall = wall;
        CHECK_FAILS_IF(wall < 0 || wall > 2, dem_laws_check(&def), RP_BAD_INPUT, "there are 2 walls");
    }
    def.ground.wall = 2;
    for (int k = 0; k < 4; k++)
        for (int w = 0; w < 2; w++) {
            dem_wall *wall = &def.walls[w];
            const dem_wall before = *wall;
            if (k < 2) wall->extent[k] = k ? 1.0 : -1.0;
            if (k == 2) wall->open_at_step = 0;
            if (k == 3) wall->velocity[0] = 1.0;
            CHECK_FAILS_IF(w, dem_laws_check(&def), RP_BAD_INPUT, "must be an infinite line");
            *wall = before;
        }
    def.ground.wall = 0, def.ground.a = -1.0; /* without ground, nothing of it counts */
    CHECK_OK(dem_laws_check(&def));
}

/* Numbers of a grain: sizes above 0, all finite; 0 what does not count; not beyond the scene's ends. */
static void ranges_of_grains(void)
{
    dem_definition def = dem_definition_default();
    def.x_max = 2.0, def.y_min = -3.0;
    dem_grain p = {.r = 0.1, .m = 0.004};
    double *const all[] = {&p.r, &p.m, &p.x, &p.y, &p.vx, &p.vy, &p.angle, &p.omega};
    for (int rotation = 0; rotation < 2; rotation++) {
        def.rotation = rotation;
        for (size_t k = 0; k < 8; k++) {
            const double before = *all[k], in = k < 2 ? DBL_MIN : k == 2 ? 2.0 : k == 3 ? -3.0 : 1.0;
            const double out[] = {INF, NAN, k < 2 ? 0.0 : -INF};
            *all[k] = in;
            CHECK_FAILS_IF(k > 5 && !rotation, dem_grain_check(&def, &p), RP_BAD_INPUT, "needs rotation");
            for (int o = 0; o < 3; o++) {
                *all[k] = out[o];
                CHECK_FAILS(dem_grain_check(&def, &p), RP_BAD_INPUT,
                            k > 5 && !rotation ? "needs rotation"
                            : k > 1            ? "must be finite"
                            : k                ? "m = "
                                               : "r = ");
            }
            *all[k] = nextafter(in, k == 2 ? INF : -INF);
            if (k == 2 || k == 3) CHECK_FAILS(dem_grain_check(&def, &p), RP_BAD_INPUT, "starts beyond");
            *all[k] = before;
        }
    }
    p.fixed = true;
    CHECK_OK(dem_grain_check(&def, &p));
    for (size_t k = 4; k < 8; k++) {
        *all[k] = 1.0;
        CHECK_FAILS_IF(k != 6, dem_grain_check(&def, &p), RP_BAD_INPUT, "must be 0, it is fixed");
        *all[k] = 0.0;
    }
    def.box_turn_per_step = 1e-9;
    CHECK_FAILS(dem_grain_check(&def, &p), RP_BAD_INPUT, "some grains are fixed");
    p.fixed = false;
    CHECK_OK(dem_grain_check(&def, &p));
}

/* Number of grains; the way of a wall in a step against the smallest of them; the largest time step. */
static void ranges_of_scenes(void)
{
    dem_grain grains[3];
    for (int i = 0; i < 3; i++) grains[i] = (dem_grain){.x = i, .y = 1.0, .r = 0.25, .m = 0.004};
    dem_definition def = grains_afloat(3, grains);
    def.material = (dem_material){.k_n = 1e-9, .k_s = 1e-9};
    def.n_walls = 3;
    for (int w = 0; w < 3; w++) def.walls[w] = grains_line(0.0, -w, 0.0, 1.0, &def.material);
    def.dt = 0x1p-10;
    for (int k = 0; k < 3; k++) {
        const dem_grain before = grains[k];
        grains[k].r = 0.125;
        def.walls[k].velocity[1] = -0x1p7;
        CHECK_OK(dem_definition_check(&def));
        def.walls[k].velocity[1] = -0x1.001p7;
        CHECK_FAILS(dem_definition_check(&def), RP_BAD_INPUT, check_text("wall %d: moves 0.12503", k + 1));
        def.walls[k].velocity[1] = 0.0;
        grains[k].r = -1.0;
        CHECK_FAILS(dem_definition_check(&def), RP_BAD_INPUT, check_text("particle %d: r = -1", k + 1));
        grains[k] = before;
    }
    def.dt = dem_time_step_limit(&def, NULL);
    CHECK_OK(dem_definition_check(&def));
    def.dt = nextafter(def.dt, INF);
    CHECK_FAILS(dem_definition_check(&def), RP_BAD_INPUT, "the limit is");
    grains[0].r = 0.0;
    def.n_grains = 100000000;
    CHECK_FAILS(dem_definition_check(&def), RP_BAD_INPUT, "particle 1: r = 0");
    def.n_grains++;
    CHECK_FAILS(dem_definition_check(&def), RP_BAD_INPUT, "100000001 particles: at most 100000000");
}

static const dem_contact *find_contact(const dem_contact *list, size_t n, const dem_contact *c)
{
    for (size_t k = 0; k < n; k++)
        if (list[k].id_a == c->id_a && list[k].id_b == c->id_b && list[k].wall == c->wall) return &list[k];
    return NULL;
}

/* A run that continues from its states and contacts has their springs: of pairs, more than a word of marks
 * holds, of any wall, and of a segment from either side. */
static void contacts_of_the_start(void)
{
    enum { ROW = 8, N = ROW * ROW + 4 };
    dem_grain grains[N] = {
        {.x = 0.5, .y = 0.095}, {.x = 0.75, .y = 0.095}, {.x = 3.0, .y = 1.095}, {.x = 3.5, .y = 0.905}};
    dem_definition def = grains_afloat(N, grains);
    for (int i = 0; i < N; i++) {
        if (i >= 4) grains[i].x = 5.0 + 0.195 * (i / ROW), grains[i].y = 5.0 + 0.195 * (i % ROW);
        grains[i].r = 0.1, grains[i].m = 0.004;
        grains[i].vx = 9.0 * sin(7.0 * i + 1.0), grains[i].omega = 80.0 * cos(5.0 * i);
    }
    def.rotation = true, def.dt = 1e-5, def.n_walls = 3;
    def.material.mu = def.material.mu_roll = 100.0; /* nothing slides */
    def.walls[0] = grains_line(-1.0, 0.0, 1.0, 0.0, &def.material);
    def.walls[1] = grains_line(0.3, 0.0, 0.0, 1.0, &def.material);
    def.walls[2] = grains_line(2.5, 1.0, 0.0, 1.0, &def.material);
    def.walls[2].extent[0] = -0.5, def.walls[2].extent[1] = 2.0;
    scoped_sim *sim = grains_after(&def, 20);
    size_t n, n_after;
    scoped dem_state *s = grains_states(sim);
    scoped dem_contact *before = grains_contacts(sim, &n);
    CU_ASSERT(n > 64 + 4);
    for (int i = 0; i < N; i++)
        grains[i].x = s[i].x, grains[i].y = s[i].y, grains[i].vx = s[i].vx, grains[i].vy = s[i].vy,
        grains[i].angle = s[i].angle, grains[i].omega = s[i].omega;
    def.contacts = before, def.n_contacts = n;
    grains_again(&sim, &def, 0);
    scoped dem_contact *after = grains_contacts(sim, &n_after);
    CU_ASSERT_EQUAL(n, n_after);
    size_t rolled = 0;
    for (size_t k = 0; k < n; k++) {
        const dem_contact *c = find_contact(after, n_after, &before[k]);
        CU_ASSERT_PTR_NOT_NULL_FATAL(c);
        CU_ASSERT(c->shear_spring == before[k].shear_spring && c->shear_spring != 0.0);
        CU_ASSERT(c->rolling_spring == before[k].rolling_spring);
        rolled += c->rolling_spring != 0.0;
        CHECK_NEAR(c->overlap, before[k].overlap, 1e-14);
    }
    CU_ASSERT(rolled > n - 4);
}

/* The limit of dt in a box. */
static void time_step_limit(void)
{
    dem_definition def = grains_box(60, 2.0, 1, NULL);
    const double limit = dem_time_step_limit(&def, NULL);
    /* the scale of a contact: dt falls as k_n^(-2/5) for Hertz */
    for (int w = 0; w < 3; w++)
        def.walls[w].material.k_n *= 32.0, def.walls[w].material.gamma_n *= 4.0,
            def.walls[w].material.k_s *= 16.0;
    def.material.k_n *= 32.0, def.material.gamma_n *= 4.0, def.material.k_s *= 16.0;
    CHECK_NEAR(dem_time_step_limit(&def, NULL) / limit, 0.25, 1e-2); /* gamma_s stays */
    /* with little damping, more than where nothing damps, and less than what is stable */
    double before = 0.0;
    for (double gamma = 0.0; gamma < 300.0; gamma = 4.0 * gamma + 1.0) {
        def.material.gamma_n = gamma;
        for (int w = 0; w < 3; w++) def.walls[w].material.gamma_n = gamma;
        const double now = dem_time_step_limit(&def, NULL);
        CU_ASSERT(now >= before);
        before = now;
    }
    /* damping alone limits gamma dt of a packing to 2/3, of which 0.85 is allowed; the second of the lightest
     * grains is slightly larger, with 1 % more neighbours */
    def.material = (dem_material){.k_n = 1e-9, .gamma_n = 3e5, .k_s = 1e-9};
    for (int w = 0; w < 3; w++) def.walls[w].material = def.material;
    CHECK_NEAR(dem_time_step_limit(&def, NULL), 0.85 * 2.0 / 3.0 / 3e5, 1e-2 * 0.85 * 2.0 / 3.0 / 3e5);
}

/* Energy of one grain after its impact over that before, by steps dt whose first touch comes anywhere in a
 * step; on a wall, or on another grain that is fixed. */
static double worst_impact(dem_definition def, double v, double dt, bool wall)
{
    double worst = 0.0;
    def.dt = dt;
    for (int phase = 0; phase < 20; phase++) {
        dem_grain grains[2] = {{.y = 0.1 + v * dt * (1.0 + phase / 20.0), .r = 0.1, .m = 0.004, .vy = -v},
                               {.y = -0.1, .r = 0.1, .m = 0.004, .fixed = true}};
        def.grains = grains, def.n_grains = wall ? 1 : 2;
        scoped_sim *sim = grains_after(&def, (long)ceil(0.02 / v / dt) + 60);
        scoped dem_state *s = grains_states(sim);
        CU_ASSERT(s[0].vy > 0.0);
        worst = fmax(worst, fabs(s[0].vy * s[0].vy / (v * v) - 1.0));
    }
    return worst;
}

/* Without damping, an impact changes the energy by at most 1 % at any step that is allowed, and a step just
 * above the limit is refused; with damping the header's estimate is that of the run. */
static void limit_without_damping(void)
{
    for (int k = 0; k < 4 * DEM_NORMAL_N; k++) {
        const double v = k % 3 ? 120.0 : 7.0;
        const bool wall = k & 1;
        dem_grain grains[2] = {{.y = 0.3, .r = 0.1, .m = 0.004, .vy = -v},
                               {.y = -0.1, .r = 0.1, .m = 0.004, .fixed = true}};
        dem_definition def = grains_afloat(2 - wall, grains);
        dem_sim *sim;
        def.normal = k / 4, def.integrator = k & 2 ? DEM_GEAR5 : DEM_VERLET;
        def.material.gamma_n = 0.0, def.material.gamma_s = 0.0;
        if (wall) put_wall(&def, 0.0, 0.0, 0.0, 1.0);
        const double limit = dem_time_step_limit(&def, NULL);
        for (double part = 1.0; part > 0.3; part *= 0.93) {
            const double error = worst_impact(def, v, part * limit, wall);
            CHECK_OR_SAY(error < 0.01, "law %d, %g of the limit: %g", k / 4, part, error);
        }
        def.dt = 1.001 * limit;
        CHECK_FAILS(dem_create(&def, &sim), RP_BAD_INPUT, "the limit is");
    }
    const dem_head_on mean = {DEM_LINEAR, true, 1e6, 300.0, 0.004, 50.0};
    dem_collision_result c;
    CHECK_OK(dem_collision(&mean, &c));
    CHECK_NEAR(dem_impact_error(&mean, c.restitution, 1e-3 * c.time), 0.0, 3e-3);
    CU_ASSERT(dem_impact_error(&mean, c.restitution, 0.2 * c.time) > 0.01);
}

/* The limit uses the speed of a fall at the floor, and twice the initial speed. */
static void limit_of_a_fall(void)
{
    for (int law = 0; law < DEM_NORMAL_N; law++)
        for (double speed = 0.0; speed < 100.0; speed += 40.0) {
            const double g = 981.0, height = 2.3, end = sqrt(2.0 * g * height);
            dem_grain grain = {.x = 0.3, .y = height, .r = 0.1, .m = 0.004, .vx = speed};
            dem_definition def = grains_of(1, &grain);
            def.normal = law, def.gravity[1] = -g, def.material.gamma_n = 0.0;
            put_wall(&def, 0.0, 0.0, 0.0, 1.0);
            for (int scheme = 0; scheme < DEM_INTEGRATORS; scheme++) {
                if (!dem_schemes[scheme]->step_limit) continue;
                def.integrator = scheme, def.gravity[1] = -g;
                grain.vx = speed;
                const double falls = dem_time_step_limit(&def, NULL);
                def.gravity[1] = 0.0;
                grain.vx = speed + 0.5 * end;
                CHECK_NEAR(falls / dem_time_step_limit(&def, NULL), 1.0, 1e-12);
            }
        }
}

/* The highest, the fastest and the lightest grain set the limit, at any index. */
static void limit_of_several(void)
{
    const dem_grain plain = {.x = 0.3, .y = 0.5, .r = 0.1, .m = 0.004};
    dem_grain grains[4] = {plain, plain, plain, plain};
    dem_definition def = grains_of(4, grains);
    dem_box_walls(&def, 2.0, &def.material);
    for (size_t i = 1; i < 4; i++) grains[i].x += 0.4 * (double)i;
    const double slow = dem_time_step_limit(&def, NULL);
    for (int what = 0; what < 3; what++) {
        double limit[4];
        for (size_t i = 0; i < 4; i++) {
            const dem_grain before = grains[i];
            if (what == 0) grains[i].y = 2.3;
            if (what == 1) grains[i].vx = -80.0;
            if (what == 2) grains[i].m = 0.002;
            limit[i] = dem_time_step_limit(&def, NULL);
            grains[i] = before;
        }
        CU_ASSERT(limit[0] < 0.95 * slow);
        CU_ASSERT(limit[1] == limit[0] && limit[2] == limit[0] && limit[3] == limit[0]);
    }
}

/* Disks of several sizes on undamped linear springs without friction: 0.95 of 4/sqrt(12 omega^2), omega^2 =
 * k_n (z_a/m_a + z_b/m_b) with z contacts on a grain over six, pi/asin(r_min/(r + r_min)) of them. The two
 * with the largest z/m count, in any order, fixed grains never, and at a wall the first of them alone. */
static void limit_of_unequal(void)
{
    static const double k_n = 1e4;
    const dem_grain grains[4] = {{.x = 1.0, .r = 0.3, .m = 0.002},
                                 {.x = 2.0, .r = 0.1, .m = 0.0012},
                                 {.x = 3.0, .r = 0.2, .m = 0.003},
                                 {.x = 4.0, .r = 0.1, .m = 1e-5, .fixed = true}};
    const double first = M_PI / 6.0 / asin(0.25) / 0.002, second = 1.0 / 0.0012;
    for (int k = 0; k < 24; k++) {
        dem_grain order[4];
        bool used[4] = {false};
        const int place[4] = {k / 6, k / 2 % 3, k % 2, 0}; /* among those left: all 24 permutations */
        for (int i = 0; i < 4; i++) {
            int at = 0;
            for (int left = place[i]; used[at] || left > 0; at++) left -= !used[at];
            used[at] = true;
            order[i] = grains[at];
        }
        dem_definition def = grains_bare(4, order, DEM_LINEAR, (dem_material){.k_n = k_n});
        dem_limit_name what;
        CHECK_NEAR(dem_time_step_limit(&def, what) / (3.8 / sqrt(12.0 * k_n * (first + second))), 1.0, 1e-14);
        CU_ASSERT_STRING_EQUAL(what, "impacts of two of the lightest grains");
        def.tangential =
            DEM_SPRING; /* shear at the edges of a packing's cell of wave numbers, and in its corners */
        for (int corner = 0; corner < 2; corner++) {
            def.material.k_s = (corner ? 0.9 : 0.3) * k_n;
            CHECK_NEAR(dem_time_step_limit(&def, what) /
                           (3.8 / sqrt(12.0 * (corner ? 0.75 * 1.9 : 1.1) * k_n * (first + second))),
                       1.0, 1e-14);
        }
        def.tangential = DEM_NONE;
        def.n_walls = 2;
        def.walls[k % 2] = grains_line(0.0, -1.0, 0.0, 1.0, &def.material);
        def.walls[!(k % 2)] = def.walls[k % 2];
        def.walls[k % 2].material.k_n = 3.0 * k_n;
        CHECK_NEAR(dem_time_step_limit(&def, what) / (3.8 / sqrt(36.0 * k_n * first)), 1.0, 1e-14);
        CU_ASSERT_STRING_EQUAL(what, check_text("impacts of the lightest grain at wall %d", k % 2 + 1));
        def.n_walls = 0;
        for (int i = 0; i < 4; i++) order[i].fixed = order[i].r != 0.2;
        CHECK_NEAR(dem_time_step_limit(&def, what) /
                       (3.8 / sqrt(12.0 * k_n * M_PI / 6.0 / asin(1.0 / 3.0) / 0.003)),
                   1.0, 1e-14);
        for (int i = 0; i < 4; i++) order[i].fixed = true;
        CU_ASSERT(isinf(dem_time_step_limit(&def, what)) && strcmp(what, "no contact") == 0);
        order[0].fixed = false, def.n_grains = 1; /* alone */
        CU_ASSERT(isinf(dem_time_step_limit(&def, what)) && strcmp(what, "no contact") == 0);
    }
}

/* Gear's limits of two disks on linear springs: 1/hypot(3 gamma 551/90, 2 omega) at rest, which is below that
 * of an impact; for an overlap of the start 0.85/hypot(3 gamma 551/90, 3 omega), but no more than 0.85 of
 * 4/(3 gamma + sqrt(9 gamma^2 + 12 omega^2)). */
static void limit_of_gear(void)
{
    static const double gammas[] = {0.0, 100.0, 1e4}, k_n = 1e4, m = 0.004;
    const double omega = sqrt(k_n / (0.5 * m));
    for (int k = 0; k < 3; k++) {
        dem_grain grains[2] = {{.x = 0.0, .r = 0.1, .m = m}, {.x = 0.3, .r = 0.1, .m = m}};
        dem_definition def =
            grains_bare(2, grains, DEM_LINEAR, (dem_material){.k_n = k_n, .gamma_n = gammas[k]});
        def.integrator = DEM_GEAR5;
        const double damped = 3.0 * gammas[k] * 551.0 / 90.0, rest = 1.0 / hypot(damped, 2.0 * omega);
        CHECK_NEAR(dem_time_step_limit(&def, NULL) / rest, 1.0, 1e-14);
        const double start =
            fmin(0.85 / hypot(damped, 3.0 * omega),
                 3.4 / (3.0 * gammas[k] + sqrt(9.0 * gammas[k] * gammas[k] + 12.0 * omega * omega)));
        scoped_sim *sim = NULL;
        grains[1].x = 0.199;
        def.dt = 1.0001 * start;
        CHECK_FAILS(dem_create(&def, &sim), RP_BAD_INPUT, "too large for an initial overlap");
        def.dt = 0.9999 * start;
        CHECK_OK(dem_create(&def, &sim));
    }
}

/* What sets the limit is named: what, left out, raises it the most; and at which wall. */
static void limit_is_named(void)
{
    const struct {
        dem_material c;
        const char *name;
    } cases[] = {
        {{.k_n = 1e6, .gamma_n = 3e3, .mu = 0.2}, "impacts of two"},
        {{.k_n = 1e6, .mu = 0.2}, "little damped impacts of two"},
        {{.k_n = 1e4, .k_s = 1e8, .gamma_n = 1e3, .mu = 0.2}, "k_s of two"},
        {{.k_n = 1e4, .gamma_n = 1e7, .mu = 0.2}, "gamma_n of two"},
        {{.k_n = 1e4, .gamma_n = 1e3, .gamma_s = 1e7, .mu = 0.2}, "gamma_s of two"},
        {{.k_n = 1e4, .gamma_n = 1e3, .k_roll = 1e9, .mu = 0.2, .mu_roll = 0.1}, "rolling of two"},
        {{.k_n = 1e4, .gamma_n = 1e3, .gamma_roll = 1e7, .mu = 0.2, .mu_roll = 0.1}, "rolling of two"}};
    const dem_grain grains[2] = {{.x = 0.5, .y = 0.5, .r = 0.1, .m = 0.004, .vx = 10.0},
                                 {.x = 1.5, .y = 0.5, .r = 0.1, .m = 0.004}};
    for (int k = 0; k < 14; k++) {
        dem_definition def = grains_afloat(2, grains);
        dem_limit_name what;
        scoped_sim *sim = NULL;
        dem_material c = cases[k / 2].c;
        c.k_s = fmax(c.k_s, 1.0), c.k_roll = fmax(c.k_roll, 1.0);
        def.normal = DEM_LINEAR, def.rotation = true, def.n_walls = 2 * (k % 2), def.material = c;
        def.walls[0] = def.walls[1] = grains_line(-1.0, 0.0, 1.0, 0.0, &def.material);
        def.walls[1].direction[0] = 0.0, def.walls[1].direction[1] = 1.0;
        if (k % 2)
            def.material = (dem_material){.k_n = 1.0, .gamma_n = 1.0, .k_s = 1.0, .k_roll = 1.0, .mu = 0.2};
        if (k % 2) def.walls[0].material = def.material;
        const double limit = dem_time_step_limit(&def, what);
        const char *name = check_text("%.*s", (int)(strlen(cases[k / 2].name) - 3), cases[k / 2].name);
        const char *of =
            check_text(k % 2 ? "%sthe lightest grain at wall 2" : "%stwo of the lightest grains", name);
        CHECK_OR_SAY(strcmp(what, of) == 0, "%s instead of %s", what, of);
        def.dt = 1.01 * limit;
        CHECK_FAILS(dem_create(&def, &sim), RP_BAD_INPUT, of);
    }
}

/* A bound as printed never exceeds itself, and is no farther below than its third digit. */
static void bounds_are_rounded_down(void)
{
    char text[32];
    for (double v = 1.0007e-9; v < 1e9; v *= 1.0371) {
        const double read = strtod(rp_text_below(v, text), NULL);
        CU_ASSERT(read <= v && read > 0.99 * v && strlen(text) <= 9);
    }
    CU_ASSERT_STRING_EQUAL(rp_text_below(9.996, text), "9.99");
    CU_ASSERT_STRING_EQUAL(rp_text_below(0.25, text), "0.25");
    CU_ASSERT_STRING_EQUAL(rp_text_below(INFINITY, text), "inf");
}

/* The faster a box turns, the shorter the step; the limit of one that turns by an angle a step is taken. */
static void limit_of_a_turning_box(void)
{
    dem_definition def = grains_box(60, 2.0, 1, NULL);
    dem_limit_name what;
    scoped_sim *sim = NULL;
    def.box_turn_per_step = 1e-2, def.dt = 1e-3;
    def.dt = strtod(rp_text_below(dem_time_step_limit(&def, what), (char[32]){0}), NULL);
    CU_ASSERT(def.dt > 0.0);
    CHECK_OK(dem_create(&def, &sim));
}

/* A wall along gravity has no height, wherever its point is; the same scene elsewhere and turned. */
static void limit_in_any_direction(void)
{
    const double round_off = 1e-13; /* of heights, ten times the position */
    double upright = NAN;
    for (int k = 0; k < 5; k++) {
        const double turn = 0.37 * k, c = cos(turn), s = sin(turn), left = 0.7 * k, down = -1.3 * k;
        dem_grain grains[2] = {{.x = 0.3, .y = 1.7, .r = 0.1, .m = 0.004},
                               {.x = 0.6, .y = 0.4, .r = 0.1, .m = 0.004}};
        dem_definition def = grains_of(2, grains);
        for (int i = 0; i < 2; i++) {
            const double x = grains[i].x, y = grains[i].y;
            grains[i].x = c * x - s * y + left;
            grains[i].y = s * x + c * y + down;
        }
        def.gravity[0] = 981.0 * s, def.gravity[1] = -981.0 * c, def.n_walls = 2;
        def.walls[0] = line(left, down, -s, c, &def.material);
        /* nearly along, through a point far below the floor */
        def.walls[1] = line(left + 9.0 * s, down - 9.0 * c, c - 1e-9 * s, s + 1e-9 * c, &def.material);
        const double limit = dem_time_step_limit(&def, NULL);
        if (k == 0) upright = limit;
        CHECK_NEAR(limit / upright, 1.0, round_off);
        def.n_walls = 1;
        CHECK_NEAR(dem_time_step_limit(&def, NULL) / upright, 1.0, round_off);
    }
}

/* The limit of dt for an initial overlap d is 0.85 of 4/sqrt(12 k/m_eff), k = 3/2 k_n sqrt(d), of the pair
 * itself, independent of other grains; a fixed grain and a wall are infinite masses. The energy is 2/5 k_n
 * d^(5/2), and k_n d^2/2 of the linear law. */
static void overlap_of_the_start(void)
{
    const double d = 0.01, m[3] = {0.004, 0.009, 0.03};
    for (int k = 0; k < 6; k++) {
        dem_grain grains[3] = {{.x = 0.5, .y = 0.5, .r = 0.1, .m = m[0]},
                               {.x = 0.7 - d, .y = 0.5, .r = 0.1, .m = m[1]},
                               {.x = 2.0, .y = 0.5, .r = 0.1, .m = m[2]}};
        dem_definition def = grains_afloat(3, grains);
        if (k == 1) grains[0].m = m[1], grains[1].m = m[0];
        if (k == 2 || k == 3) grains[k - 2].fixed = true;
        if (k == 4) grains[1].x = 1.2;
        if (k == 5) grains[1].r = 0.3, grains[1].x = 0.9 - d; /* has up to pi/asin(1/4) neighbours, not 6 */
        def.material.gamma_n = def.material.mu = 0.0;
        def.tangential = DEM_NONE;
        def.n_walls = k == 4;
        def.walls[0] = grains_line(0.4 + d, 0.0, 1.0, 0.0, &def.material);
        const double k_n = def.material.k_n,
                     m_eff = k == 2   ? m[1]
                             : k >= 3 ? m[0]
                                      : m[0] * m[1] / (m[0] + m[1]),
                     crowd = k == 5 ? (1.0 / m[0] + M_PI / 6.0 / asin(0.25) / m[1]) * m_eff : 1.0,
                     limit = 0.85 * 4.0 / sqrt(12.0 * 1.5 * k_n * sqrt(d) * crowd / m_eff);
        scoped_sim *sim = NULL;
        def.dt = 1.0001 * limit;
        CHECK_FAILS(dem_create(&def, &sim), RP_BAD_INPUT, "too large for an initial overlap");
        def.dt = 0.9999 * limit;
        grains_again(&sim, &def, 0);
        CHECK_NEAR(grains_energies(sim).elastic / (0.4 * k_n * pow(d, 2.5)), 1.0, 1e-12);
        const dem_contact c = grains_only_contact(sim);
        CU_ASSERT(c.shear_force == 0.0 && c.rolling_torque == 0.0);
        def.normal = DEM_LINEAR, def.dt = 1e-7;
        grains_again(&sim, &def, 0);
        CHECK_NEAR(grains_energies(sim).elastic / (0.5 * k_n * d * d), 1.0, 1e-12);
    }
}

/* A spring of the untruncated law, longer than Coulomb's limit: its force is p = mu N, N >= 0, beyond the
 * limit, and its energy p ds - p^2/(2 k_s). */
static void energy_of_a_long_spring(void)
{
    static const double speeds[] = {0.0, 400.0, -300.0}; /* together; apart: N would be below 0 */
    for (int k = 0; k < 3; k++) {
        const double d = 0.01, ds = 0.5;
        const dem_grain grains[2] = {{.x = 0.5, .y = 0.5, .r = 0.1, .m = 0.004, .vx = speeds[k]},
                                     {.x = 0.7 - d, .y = 0.5, .r = 0.1, .m = 0.004}};
        dem_definition def = grains_afloat(2, grains);
        def.dt = 1e-6, def.slip = DEM_TOTAL, def.material.gamma_n = 4000.0;
        const dem_contact start = {.id_a = 1, .id_b = 2, .wall = -1, .shear_spring = ds};
        def.contacts = &start, def.n_contacts = 1;
        scoped_sim *sim = grains_start(&def);
        const dem_energy energy = grains_energies(sim);
        const dem_contact now = grains_only_contact(sim);
        const double pull = def.material.mu * fmax(now.normal_force, 0.0), k_n = def.material.k_n;
        CU_ASSERT((now.normal_force < 0.0) == (k == 2) && pull < def.material.k_s * ds);
        CHECK_NEAR(fabs(now.shear_spring), ds, 1e-15);
        CHECK_NEAR(energy.elastic,
                   0.4 * k_n * pow(d, 2.5) + pull * ds - pull * pull / (2.0 * def.material.k_s),
                   1e-11); /* of 400 */
    }
}

/* Grains with equal rotation have the fastest mode for stiff shear springs: J (2 k_s + k_roll), J = 5/2 of
 * spheres, 2 of disks; k_roll enters with rolling resistance. */
static void limit_of_rotation(void)
{
    const dem_grain grains[2] = {{.x = 0.5, .y = 0.5, .r = 0.1, .m = 0.004},
                                 {.x = 1.5, .y = 0.5, .r = 0.1, .m = 0.004}};
    for (int k = 0; k < 4; k++) {
        const bool rolls = k & 1, disks = k & 2;
        dem_definition def = grains_afloat(2, grains);
        def.normal = DEM_LINEAR, def.rotation = true, def.shape = disks ? DEM_DISK : DEM_SPHERE;
        def.material =
            (dem_material){.k_n = 1.0, .k_s = 1e4, .mu = 0.2, .k_roll = 3e3, .mu_roll = rolls ? 0.1 : 0.0};
        const double square = (disks ? 2.0 : 2.5) * (2e4 + (rolls ? 3e3 : 0.0)) / 0.002;
        CHECK_NEAR(dem_time_step_limit(&def, NULL) / (3.8 / sqrt(12.0 * square)), 1.0, 1e-14);
    }
}

/* Header of a table for a scene of unequal free grains: values of the mean grain, at twice the top speed. */
static void header_notes(void)
{
    const dem_grain grains[3] = {{.x = 0.5, .y = 0.5, .r = 0.1, .m = 0.004, .vx = 30.0},
                                 {.x = 1.5, .y = 0.5, .r = 0.13, .m = 0.009, .vy = 13.0},
                                 {.x = 2.5, .y = 0.5, .r = 0.08, .m = 0.002}};
    dem_definition def = grains_afloat(3, grains);
    scoped_sim *sim = grains_start(&def);
    CHECK_WRITTEN(text, out, dem_write_notes(sim, out));
    const double m_eff = 0.5 * 0.015 / 3.0, r = 0.31 / 3.0;
    dem_collision_result c;
    CHECK_OK(dem_collision(
        &(dem_head_on){DEM_HERTZ, true, def.material.k_n, def.material.gamma_n, m_eff, 60.0}, &c));
    dem_limit_name what;
    const double limit = dem_time_step_limit(&def, what);
    const char *const expected[] = {
        check_text("dt = 5e-05 s; limit %s s, set by %s", rp_text_below(limit, (char[32]){0}), what),
        check_text("sticking speed: %.3g cm/s", dem_normal_descriptors[DEM_HERTZ].sticking_speed(
                                                    def.material.k_n, def.material.gamma_n, m_eff)),
        check_text("E* = %.3g dyn/cm^2", 0.75 * def.material.k_n / sqrt(0.5 * r)),
        check_text("at 60 cm/s: restitution %.3f, overlap %.3g d, dt/contact time %.3g", c.restitution,
                   c.overlap / (2.0 * r), def.dt / c.time)};
    for (size_t k = 0; k < 4; k++) CU_ASSERT_PTR_NOT_NULL(strstr(text, expected[k]));
}

/* State near rest against the given velocities: in the frame of a rotating box, for the grains inside,
 * without fixed ones; largest force of the grains in contact. */
static void state_near_rest(void)
{
    const double turn = 1e-3, dt = 5e-5;
    const dem_grain grains[4] = {{.x = 0.5, .y = 0.6, .r = 0.1, .m = 0.004, .omega = 3.0},
                                 {.x = 1.5, .y = 0.6, .r = 0.1, .m = 0.004, .vx = 50.0},
                                 {.x = 0.5, .y = 1.6, .r = 0.1, .m = 0.004, .fixed = true},
                                 {.x = -0.5, .y = 0.6, .r = 0.1, .m = 0.004, .vx = 50.0}};
    dem_definition def = grains_afloat(4, grains);
    def.rotation = true, def.dt = dt;
    scoped_sim *sim = grains_start(&def);
    dem_rest rest;
    CHECK_OK(dem_rest_state(sim, 0.0, 1.0, &rest));
    CU_ASSERT(rest.n == 1 && rest.contact_number == 0.0 && rest.net_force == 0.0);
    const double inertia = dem_inertia(def.shape, 0.004, 0.1);
    CHECK_NEAR(rest.kinetic_energy, 0.5 * inertia * 9.0, 1e-12);
    def.n_grains = 2, def.box_turn_per_step = turn;
    grains_again(&sim, &def, 1);
    CHECK_OK(dem_rest_state(sim, 0.0, 1.0, &rest));
    /* the point of the box reached the grain's position along a chord; its spin is clockwise */
    const double chord = hypot(0.5, 0.6) * 2.0 * sin(0.5 * turn) / dt, spin = 3.0 + sin(turn) / dt;
    CHECK_NEAR(rest.kinetic_energy, 0.5 * 0.004 * chord * chord + 0.5 * inertia * spin * spin, 1e-10);
    def.n_grains = 1, def.box_turn_per_step = M_PI / 4000.0; /* a quarter turn exchanges x and y */
    grains_again(&sim, &def, 2000);
    for (int turns = 1; turns >= 0; turns--) {
        CHECK_OK(dem_rest_state(sim, -0.61, -0.59, &rest));
        CU_ASSERT(rest.n == 1 && (rest.kinetic_energy > inertia * 9.0) == (turns == 1));
        dem_box_turn(sim, 0.0);
        CHECK_OK(dem_run(sim, 1));
    }
    /* one on a floor that carries half of its weight, and one in free fall */
    dem_grain two[2] = {{.x = 0.5, .r = 0.1, .m = 0.004}, {.x = 0.5, .y = 1.0, .r = 0.1, .m = 0.004}};
    def = grains_of(2, two);
    two[0].y = 0.1 - pow(0.5 * 0.004 * 981.0 / (2.0 * def.material.k_n), 2.0 / 3.0);
    put_wall(&def, 0.0, 0.0, 0.0, 1.0);
    grains_again(&sim, &def, 0);
    CHECK_OK(dem_rest_state(sim, 0.0, 1.0, &rest));
    CU_ASSERT(rest.n == 2 && rest.contact_number == 0.5);
    CHECK_PAIRS(1e-9, {rest.net_force, 0.5 * 0.004 * 981.0}, {rest.free_force, 0.004 * 981.0});
}

/* Both limits count; where looks follow soon, one in the air is at rest only if nothing accelerates it. */
static void at_rest(void)
{
    const double weight = 0.004 * 981.0, energy = 1e-7 * weight * 0.2, force = 1e-2 * weight;
    const dem_rest still = {.n = 1};
    CU_ASSERT(dem_at_rest(&still, energy, force, true) && dem_at_rest(&still, 0.0, 0.0, true));
    for (int look = 0; look < 2; look++) {
        CU_ASSERT(!dem_at_rest(&(dem_rest){.kinetic_energy = 1.01 * energy}, energy, force, look));
        CU_ASSERT(dem_at_rest(&(dem_rest){.kinetic_energy = energy}, energy, force, look));
        CU_ASSERT(!dem_at_rest(&(dem_rest){.net_force = 1.01 * force}, energy, force, look));
        CU_ASSERT(dem_at_rest(&(dem_rest){.net_force = force}, energy, force, look));
        CU_ASSERT(!dem_at_rest(&(dem_rest){.kinetic_energy = NAN}, energy, force, look));
    }
    /* at the top of its throw */
    dem_grain thrown = {.x = 0.5, .y = 1.0, .r = 0.1, .m = 0.004, .vy = 981.0 * 100 * 5e-5};
    dem_definition def = grains_of(1, &thrown);
    def.dt = 5e-5;
    scoped_sim *sim = grains_after(&def, 100);
    dem_rest rest;
    CHECK_OK(dem_rest_state(sim, 0.0, 1.0, &rest));
    CU_ASSERT(!dem_at_rest(&rest, energy, force, true) && dem_at_rest(&rest, energy, force, false));
}

/* Bytes of a grain in every array that goes with it. */
static void all_bytes(const dem_grains *grains, size_t i, unsigned char *to)
{
#define X(type, name, need, role)                                                                            \
    if (role == DEM_STATE && grains->name) {                                                                 \
        memcpy(to, &grains->name[i], sizeof(type));                                                          \
        to += sizeof(type);                                                                                  \
    }
    DEM_GRAIN_ARRAYS(X)
#undef X
}

/* Do the grains have the bytes that they had, by id? */
static bool same_bytes(const dem_grains *grains, unsigned char bytes[][1024])
{
    bool same = true;
    for (size_t i = 0; i < grains->n; i++) {
        unsigned char now[1024] = {0};
        all_bytes(grains, i, now);
        same &= memcmp(now, bytes[grains->id[i]], sizeof now) == 0;
    }
    return same;
}

/* Every array of the list follows its grain as the grains are sorted and copied, and as one leaves a gap. */
static void arrays_follow_grains(void)
{
    enum { N = 60 };
    for (int k = 0; k < 2 * DEM_INTEGRATORS; k++) {
        static unsigned char bytes[N + 1][1024];
        dem_definition def = grains_box(N, 2.0, 5, NULL);
        def.integrator = k / 2, def.rotation = k % 2, def.dt = 4e-5;
        if (!dem_scheme_check(&def)) {
            scoped_sim *sim = grains_after(&def, 2000), *copy = NULL;
            const uint32_t first = sim->grains.id[0];
            memset(bytes, 0, sizeof bytes);
            for (size_t i = 0; i < N; i++) {
                sim->grains.motion[i].x[0] = 2.0 - sim->grains.motion[i].x[0]; /* another order */
                all_bytes(&sim->grains, i, bytes[sim->grains.id[i]]);
            }
            CHECK_OK(dem_neighbours_rebuild(sim));
            CU_ASSERT(sim->grains.id[0] != first && same_bytes(&sim->grains, bytes));
            CHECK_OK(dem_clone(sim, &copy));
            const uint32_t gone = copy->grains.id[2];
            dem_grains_move(&copy->grains, --copy->grains.n, 2);
            CU_ASSERT(copy->grains.id[2] != gone && same_bytes(&copy->grains, bytes));
        }
    }
}

CHECK_SUITE(dem, "dem", momentum, mirror_and_relabel, leave, leave_below_others, work_is_counted,
            arrays_follow_grains, extra_rebuilds, integration_behind_the_pair_loop, margins, gravity_turns,
            floor_that_ends, corner_without_rebuild, springs_end, rolling_couple, contacts_add_up,
            lifted_wall, lifted_wall_drags, outlet, filling, added_far_away, added_one_by_one,
            added_by_either_scheme, added_names_and_errors, faults, bad_definitions, defaults,
            contacts_of_the_start, ranges_of_numbers, ranges_of_walls, ranges_of_ground, ranges_of_grains,
            ranges_of_scenes, time_step_limit, limit_of_unequal, limit_of_gear, limit_is_named,
            bounds_are_rounded_down, limit_of_a_turning_box, overlaps_too_deep, sine_and_cosine,
            limit_of_a_fall, limit_without_damping, limit_of_several, limit_in_any_direction,
            limit_of_rotation, overlap_of_the_start, energy_of_a_long_spring, header_notes, state_near_rest,
            at_rest)
