/* Elastic spheres by their material: Hertz, Mindlin. */
#include "dem/law/law.h"
#include "dem/state/state.h"
#include "tests/grains.h"
#include "tests/numbers.h"

/* E* and G* of steel on glass by hand, of two alike, and of a sphere on what does not yield. */
static void moduli(void)
{
    double k_n, k_s;
    dem_elastic_contact((double[]){210e9, 70e9}, (double[]){0.3, 0.2}, &k_n, &k_s);
    const double modulus = 1.0 / ((1.0 - 0.09) / 210e9 + (1.0 - 0.04) / 70e9), g1 = 210e9 / 2.6,
                 g2 = 70e9 / 2.4;
    CHECK_NEAR(k_n, 4.0 / 3.0 * modulus, 1e-14 * k_n);
    CHECK_NEAR(k_s, 8.0 / (1.7 / g1 + 1.8 / g2), 1e-14 * k_s);
    dem_elastic_contact((double[]){70e9, 70e9}, (double[]){0.2, 0.2}, &k_n, &k_s);
    CHECK_NEAR(k_n, 4.0 / 3.0 * 70e9 / (2.0 * 0.96), 1e-14 * k_n);
    CHECK_NEAR(k_s / k_n, 3.0 * (1.0 - 0.2) / (2.0 - 0.2), 1e-13);
    double rigid_n, rigid_s;
    dem_elastic_contact((double[]){70e9, 1e300}, (double[]){0.2, 0.0}, &rigid_n, &rigid_s);
    CHECK_NEAR(rigid_n, 2.0 * k_n, 1e-14 * k_n);
    CHECK_NEAR(rigid_s, 2.0 * k_s, 1e-14 * k_s);
}

/* Mindlin's force along a path of overlaps and shear displacements. */
typedef struct {
    double k, r, x, spring, force;
} path;

static void go(path *p, double x, double shear)
{
    dem_slider c = dem_slider_of(DEM_TRUNCATED, DEM_DAMPING_INSIDE, p->k, 0.0, 1e300);
    c = dem_law_at_overlap(c, p->r, 1.0, x, p->x, &p->spring);
    p->force = dem_law_shear(c, 1.0, shear, 1.0, 1.0, &p->spring), p->x = x;
}

/* F = k sqrt(R x) s at one overlap; it stays while the contact grows, and falls as its radius shrinks. */
static void mindlin_path(void)
{
    path p = {.k = 3e7, .r = 0.04, .x = 1e-3};
    go(&p, 1e-3, 2e-5);
    const double held = p.force;
    CHECK_NEAR(held, -3e7 * sqrt(0.04 * 1e-3) * 2e-5, 1e-12 * fabs(held));
    for (int k = 1; k <= 10; k++) go(&p, 1e-3 * (1.0 + 0.3 * k), 0.0);
    CHECK_NEAR(p.force, held, 1e-12 * fabs(held));
    for (int k = 1; k <= 10; k++) go(&p, 4e-3 - 3e-4 * k, 0.0);
    CHECK_NEAR(p.force, 0.5 * held, 1e-12 * fabs(held));
    go(&p, 1e-3, -1e-5);
    CHECK_NEAR(p.force, 0.5 * held + 3e7 * sqrt(0.04 * 1e-3) * 1e-5, 1e-12 * fabs(held));
}

/* Thornton's test: round any path of overlap and shear to its start the contact has taken energy, or none. */
static void no_energy_gained(void)
{
    scoped_rng *rng = numbers_of(5, 0);
    double most = 0.0;
    for (int loop = 0; loop < 400; loop++) {
        enum { CORNERS = 5, STEPS = 200 };
        double x[CORNERS + 1], s[CORNERS + 1], work = 0.0;
        for (int k = 0; k < CORNERS; k++)
            x[k] = 1e-3 * (0.05 + gsl_rng_uniform(rng)), s[k] = k ? 1e-4 * (gsl_rng_uniform(rng) - 0.5) : 0.0;
        x[CORNERS] = x[0], s[CORNERS] = s[0];
        path p = {.k = 3e7, .r = 0.04, .x = x[0]};
        for (int round = 0; round < 2; round++) /* the second begins with a spring */
            for (int k = 0; k < CORNERS; k++)
                for (int i = 1; i <= STEPS; i++) {
                    const double ds = (s[k + 1] - s[k]) / STEPS, before = p.spring;
                    const double radius = sqrt(p.r * p.x);
                    go(&p, x[k] + (x[k + 1] - x[k]) * i / STEPS, ds);
                    const double now = sqrt(p.r * p.x), start = before * fmin(1.0, radius / now);
                    work += 0.5 * (p.k * now * start - p.force) * ds; /* what moves the grains does on it */
                }
        const double left = 0.5 * p.force * p.force / (p.k * sqrt(p.r * p.x));
        CU_ASSERT(work - left >= -1e-12 * fabs(work));
        most = fmax(most, work - left);
    }
    CU_ASSERT(most > 0.0);
}

/* Two unequal spheres, or a sphere and a wall, meet undamped: deepest overlap and time of Hertz' theory. */
static void hertz_impact(void)
{
    for (int wall = 0; wall < 2; wall++)
        for (double v = 1.0; v < 200.0; v *= 10.0) {
            const double r[2] = {0.1, 0.15}, m[2] = {0.01, 0.03}, E = 1e9, nu = 0.25;
            dem_grain grains[2] = {{.y = 0.11, .r = r[0], .m = m[0], .vy = -v},
                                   {.y = -0.15, .r = r[1], .m = m[1]}};
            dem_definition def = grains_afloat(2 - (size_t)wall, grains);
            double k_n, k_s, deepest = 0.0, begins = 0.0, ends = 0.0;
            dem_elastic_contact((double[]){E, E}, (double[]){nu, nu}, &k_n, &k_s);
            def.normal = DEM_ELASTIC, def.tangential = DEM_NONE, def.material = (dem_material){.k_n = k_n};
            def.walls[0] = grains_line(0.0, 0.0, 0.0, 1.0, &def.material), def.n_walls = (size_t)wall;
            const double R = wall ? r[0] : r[0] * r[1] / (r[0] + r[1]),
                         mass = wall ? m[0] : m[0] * m[1] / (m[0] + m[1]),
                         modulus = E / (2.0 * (1.0 - nu * nu)),
                         depth = pow(15.0 * mass * v * v / (16.0 * modulus * sqrt(R)), 0.4),
                         time = 2.943275 * depth / v;
            def.dt = 1e-4 * time;
            scoped_sim *sim = grains_start(&def);
            for (long step = 1; ends == 0.0 && step < 4000000; step++) {
                CHECK_OK(dem_run(sim, 1));
                if (dem_contact_count(sim, 1) == 0) {
                    if (begins > 0.0) ends = dem_time(sim);
                    continue;
                }
                if (begins == 0.0) begins = dem_time(sim);
                deepest = fmax(deepest, grains_only_contact(sim).overlap);
            }
            CHECK_NEAR(deepest / depth, 1.0, 1e-4);
            CHECK_NEAR((ends - begins) / time, 1.0, 3e-4);
        }
}

static const char
    material[] = "material = { E = 1.0e8; nu = 0.3; restitution = 0.6; mu = 0.4; };\n",
    groups[] =
        "normal = { law = \"elastic\"; k_n = 73260073.26007326; restitution = 0.6; tension = false; };\n"
        "tangential = { law = \"mindlin\"; k_s = 90497737.55656108; mu = 0.4; damping = \"inside\"; };\n";

/* The group stands for two others; walls have its moduli, or their own. */
static void group_of_a_scene(void)
{
#define REST                                                                                                 \
    "%swalls = ( { point = [0.0, 0.0]; direction = [0.0, 1.0]; %s } );\nparticles = ( { x = 0.0; y = "       \
    "0.0999; r = 0.1; vx = 5.0; }, { x = 0.15; y = 0.37; r = 0.2; } );\ndt = 1e-6; steps = 2000;\n"
    scoped_sim *one = grains_after_text(2000, REST, material, ""),
               *two =
                   grains_after_text(2000, REST, groups, "k_n = 73260073.26007326; k_s = 90497737.55656108;");
    CU_ASSERT(grains_same_bits(one, two));
    /* the same part of critical: c over 2 sqrt(k/m), of the stiffnesses 3/2 K sqrt(x) and K_s */
    CHECK_NEAR(one->def.material.gamma_s / 2.0, one->def.material.gamma_n / (2.0 * sqrt(1.5)), 1e-14);
    scoped_scene c;
    CHECK_OK(grains_read_as(&c, REST, material, "E = 3.0e7; nu = 0.1; mu = 0.9; restitution = 0.3;"));
    double k_n, k_s;
    dem_elastic_contact((double[]){1e8, 3e7}, (double[]){0.3, 0.1}, &k_n, &k_s);
    const dem_material *wall = &c.def.walls[0].material;
    CU_ASSERT(wall->k_n == k_n && wall->k_s == k_s && wall->mu == 0.9 && wall->restitution == 0.3);
    static const char *const refused[][2] = {
        {"material = { E = 1.0e8; nu = 0.3; mu = 0.4; };\n", "restitution: missing"},
        {"material = { E = 1.0e8; nu = 0.6; restitution = 0.6; mu = 0.4; };\n", "nu = 0.6: out of range"},
        {"material = { E = 1.0e8; nu = 0.3; restitution = 0.6; mu = 0.4; k_n = 3.0; };\n",
         "material.k_n: does not belong here, but in normal"},
        {"integrator = \"gear5\";\nmaterial = { E = 1.0e8; nu = 0.3; restitution = 0.6; mu = 0.4; };\n",
         "mindlin needs the integrator verlet"},
        {"walls = ( { point = [0.0, 0.0]; direction = [0.0, 1.0]; E = 1.0e7; } );\n",
         "of a wall need the grains' in material"}};
    for (size_t k = 0; k < sizeof refused / sizeof *refused; k++) {
        scoped_scene s;
        scoped_sim *sim = NULL;
        rp_status status =
            grains_read_as(&s, "%sparticles = ( { x = 0.0; y = 0.2; r = 0.1; } );\n", refused[k][0]);
        if (!status) status = dem_scene_start(&s, &sim);
        CHECK_FAILS(status, RP_BAD_INPUT, refused[k][1]);
    }
}

/* Undamped grains that roll and slide in a closed box: the ledger closes, friction alone takes energy, and
 * takes it at all times. */
static void close_ledger(dem_rolling model)
{
    dem_grain *grains;
    dem_definition def = grains_box(60, 2.0, 4, &grains);
    double k_n, k_s, lost = 0.0, rolled = 0.0;
    dem_elastic_contact((double[]){3e7, 3e7}, (double[]){0.3, 0.3}, &k_n, &k_s);
    def.normal = DEM_ELASTIC, def.tangential = DEM_MINDLIN, def.tension = false, def.rotation = true,
    def.ledger = true;
    def.damping = DEM_DAMPING_INSIDE;
    def.material = (dem_material){
        .k_n = k_n, .k_s = k_s, .mu = 0.4, .mu_roll = dem_rolls_by_speed(model) ? 1e-3 : 0.1, .k_roll = k_s};
    for (int w = 0; w < DEM_BOX_N; w++) def.walls[w].material = def.material;
    for (int i = 0; i < 60; i++) grains[i].omega = 20.0 * (i % 7 - 3.0);
    def.dt = 1e-6;
    def.rolling = model;
    scoped_sim *sim = grains_start(&def);
    for (int k = 0; k < 40; k++) {
        CHECK_OK(dem_run(sim, 2500));
        const dem_ledger l = grains_ledger(sim);
        CHECK_NEAR(l.residual, 0.0, 1e-10 * l.turnover);
        CU_ASSERT(l.sliding >= lost && l.rolling >= rolled && l.normal_damping == 0.0 &&
                  fabs(l.integration) < 1e-3 * l.turnover);
        lost = l.sliding, rolled = l.rolling;
    }
    CU_ASSERT(lost > 0.0 && rolled > 0.0);
}

static void ledger_closes(void)
{
    for (int model = 0; model < DEM_ROLLING_N; model++) close_ledger((dem_rolling)model);
}

/* A sphere rolls on a floor: the constant model takes mu g/(1 + I/(m r^2)) of its speed a second, then holds
 * it, the viscous one a part mu g/(1 + I/(m r^2)) of it; so does the spring, but for its stretch. */
static void rolling_models(void)
{
    static const char *const models[] = {"spring", "constant", "viscous"};
    for (int k = 0; k < 3; k++)
        for (int kernel = 0; kernel < 2; kernel++) {
            const double mu = k == 2 ? 2e-3 : 0.02, v = 10.0, decay = mu * 981.0 / 1.4;
            dem_state now;
            scoped_sim *sim =
                grains_after_text(/* 0.3 s */
                                  60000,
                                  "%srotation = true; dt = 5e-6; kernel = \"%s\"; rolling = { model = "
                                  "\"%s\"; mu = %g; };\n"
                                  "walls = ( { point = [0.0, 0.0]; direction = [0.0, 1.0]; mu = 5.0; } );\n"
                                  "particles = ( { x = 0.0; y = 0.09995; r = 0.1; vx = %g; omega = %g; } "
                                  ");\n",
                                  material, kernel ? "reference" : "fast", models[k], mu, v, -v / 0.1);
            CHECK_OK(dem_states(sim, &now));
            CHECK_NEAR(now.vx, k == 2 ? v * exp(-decay * 0.3) : v - decay * 0.3, 0.02 * v);
            CHECK_NEAR(now.omega, -now.vx / 0.1, 0.02 * v / 0.1);
            grains_run(sim, 120000, &now);
            if (k < 2) CHECK_NEAR(now.vx, 0.0, 0.02);
            if (k == 2) CHECK_NEAR(now.vx, v * exp(-decay * 0.9), 0.03 * v * exp(-decay * 0.9));
        }
}

/* Of a pair of radii 0.1 and 0.05 that rolls fast, and of a grain that rolls on a wall: the torque is the arm
 * times mu F_n, and of the viscous model times the speed at that arm too. */
static void rolling_arms(void)
{
    static const char *const models[] = {"constant", "spring", "viscous"}, *const arms[] = {"reduced",
                                                                                            "radius"};
    for (int k = 0; k < 12; k++) {
        const int model = k % 3, wall = k / 6;
        const double r = 0.1, omega = 300.0, mu = model == 2 ? 1e-4 : 0.01,
                     arm = wall ? r : (k / 3 % 2 ? 2.0 : 1.0) * 0.1 * 0.05 / 0.15;
        scoped_sim *sim = grains_after_text(/* the spring comes to its limit */
                                            60,
                                            "%srotation = true; gravity = [0.0, 0.0]; dt = 2e-7; rolling = { "
                                            "model = \"%s\"; arm = \"%s\"; mu = %g; };\n"
                                            "walls = ( { point = [0.0, 0.0]; direction = [0.0, 1.0]; } );\n"
                                            "particles = ( { x = 0.0; y = %g; r = %g; omega = %g; }, { x = "
                                            "0.1499; y = %g; r = 0.05; } );\n",
                                            material, models[model], arms[k / 3 % 2], mu, wall ? 0.0999 : 5.0,
                                            r, omega, wall ? 9.0 : 5.0);
        const dem_contact c = grains_only_contact(sim);
        const double speed = model == 2 ? arm * omega : 1.0;
        CHECK_NEAR(fabs(c.rolling_torque), arm * mu * c.normal_force * speed,
                   0.02 * arm * mu * c.normal_force * speed);
    }
}

/* Below its limit the spring's torque on a pair, of k or of gamma, is four times as large at twice the arm;
 * the viscous model bounds the time step by a quarter. */
static double below_limit(const char *arm, const char *law, double *limit)
{
    static const char scene[] =
        "%srotation = true; dt = %s; rolling = { arm = \"%s\"; %s };\n"
        "particles = ( { x = 0.0; y = 0.0; r = 0.1; omega = 1.0; }, { x = 0.1499; y = 0.0; r = 0.05; } );\n";
    scoped_sim *sim = grains_after_text(4, scene, material, "1e-9", arm, law);
    scoped_scene bound;
    CHECK_OK(grains_read_as(&bound, scene, material, "\"dt_limit(9)\"", arm, law));
    *limit = bound.def.dt;
    return grains_only_contact(sim).rolling_torque;
}

static void arms_below_the_limit(void)
{
    static const char *const laws[] = {"mu = 1.0e6; k = 1.0e6; gamma = 0.0;",
                                       "mu = 1.0e6; k = 1.0e-9; gamma = 0.5;",
                                       "mu = 1.0; model = \"viscous\";"};
    for (int k = 0; k < 3; k++) {
        double limits[2];
        const double half = below_limit("reduced", laws[k], &limits[0]),
                     whole = below_limit("radius", laws[k], &limits[1]);
        CU_ASSERT(half != 0.0);
        CHECK_NEAR(whole / half, 4.0, 0.01);
        if (k == 2) CHECK_NEAR(limits[0] / limits[1], 4.0, 0.5);
    }
}

/* A surface acts the same as a whole line and as a segment, at rest, and moving in a frame along with it. */
static void walls_alike(void)
{
    static const char *const walls[] = {"", " extent = [-9.0, 9.0];", " velocity = [0.0, 7.0];"};
    double speed[3][3];
    for (int k = 0; k < 3; k++) {
        scoped_sim *sim = grains_after_text(
            3000,
            "%sgravity = [0.0, 0.0]; rotation = true; dt = 1e-6; walls = ( { point = [0.0, 0.0]; "
            "direction = [0.0, 1.0];%s } "
            ");\nparticles = ( { x = 0.0; y = 0.100133; r = 0.1; vx = 20.0; vy = %g; omega = 30.0; } );\n",
            material, walls[k], k == 2 ? -43.0 : -50.0);
        const dem_state state = grains_state_of_one(sim);
        CU_ASSERT(state.contacts == 0);
        speed[k][0] = state.vx, speed[k][1] = state.vy - (k == 2 ? 7.0 : 0.0), speed[k][2] = state.omega;
    }
    CHECK_NEAR(speed[0][1], 0.6 * 50.0, 0.05);
    CU_ASSERT(speed[0][0] < 19.0 && speed[0][2] < 30.0);
    for (int k = 1; k < 3; k++)
        for (int c = 0; c < 3; c++) CHECK_NEAR(speed[k][c], speed[0][c], 1e-9 * fabs(speed[0][c]));
}

CHECK_SUITE(material, "material", moduli, mindlin_path, no_energy_gained, hertz_impact, group_of_a_scene,
            walls_alike, rolling_models, rolling_arms, arms_below_the_limit, ledger_closes)
