/* Every contact law of the lists in laws.h, with every feature and kernel: what is listed is tested. */
#include <gsl/gsl_integration.h>

#include "dem/setup/definition.h"
#include "dem/law/law.h"
#include "dem/state/state.h"
#include "tests/grains.h"

/* ---- Kernels ---- */

enum { GRAINS = 60 };

/* The scene ran with the instructions and the law it asked for. */
static void check_name(const dem_definition *def, const char *name)
{
    const char *law = dem_normal_descriptors[def->normal].name;
    CU_ASSERT(strncmp(name, law, strlen(law)) == 0 && name[strlen(law)] == '_');
    CU_ASSERT((strstr(name, "_avx2") != NULL) == (def->kernel == DEM_AVX2));
    CU_ASSERT((strstr(name, "_avx512") != NULL) == (def->kernel == DEM_AVX512));
}

/* An avalanche in a box, whose walls open or turn, and which grains leave. */
static void each_kernel(dem_definition *def, long steps)
{
    def->kernel = DEM_REFERENCE;
    scoped_sim *reference = grains_after(def, steps);
    CU_ASSERT_STRING_EQUAL(dem_kernel_name(reference), "reference");
    CU_ASSERT(dem_count(reference) > 0 && dem_count(reference) < GRAINS); /* some were taken out */
    GRAINS_EACH_KERNEL (kernel, DEM_BASELINE) {
        def->kernel = kernel;
        scoped_sim *sim = grains_after(def, steps);
        CHECK_OR_SAY(grains_same_bits(sim, reference), "other bits than the reference: %s",
                     dem_kernel_name(sim));
        check_name(def, dem_kernel_name(sim));
    }
}

typedef struct {
    dem_normal_law normal;
    dem_tangential_law tangential;
    dem_slip slip;
    dem_damping damping;
    bool tension, rotation, rolling;
    dem_rolling model;
} features;

static void kernels_of(const features *f, long number)
{
    const long steps = check_fast() ? 1200 : 4000;
    dem_grain *grains;
    dem_definition def = grains_box(GRAINS, 2.0, number, &grains);
    grains_law(&def, f->normal, 1.5e5, 500.0);
    def.tangential = f->tangential, def.slip = f->slip, def.damping = f->damping;
    def.tension = f->tension, def.rotation = f->rotation;
    if (f->rolling) def.rolling = f->model;
    if (f->rolling) def.material.mu_roll = dem_rolls_by_speed(def.rolling) ? 1e-3 : 0.1;
    if (!dem_has_friction(f->tangential)) def.material.mu = 0.0;
    if (dem_is_of_radius(f->tangential)) {
        def.material.k_s = def.material.k_roll = 0.4 * def.material.k_n;
        def.material.gamma_s = def.material.gamma_roll = 0.2;
    }
    for (int i = 0; def.rotation && i < GRAINS; i++) grains[i].omega = i % 7 - 3.0;
    for (int w = 0; w < DEM_BOX_N; w++) {
        def.walls[w].material = def.material;
        def.walls[w].material.k_n *= 2.0;
    }
    def.walls[DEM_BOX_RIGHT].open_at_step = steps / 2;
    def.walls[DEM_BOX_FLOOR].open_at_step = steps - 900;
    def.box_turn_per_step = number % 3 == 1 ? 1e-4 : 0.0;
    def.x_max = 2.5, def.y_min = -0.5;
    each_kernel(&def, steps);
}

/* Bits of the features, in the order of their changes. */
static void kernels_match_reference(void)
{
    enum { TENSION = 1, ROTATION = 2, ROLLING = 4, TOTAL = 8, INSIDE = 16, ALL = 32 };
    long number = 0;
    for (int normal = 0; normal < DEM_NORMAL_N; normal++)
        for (int tangential = 0; tangential < DEM_TANGENTIAL_N; tangential++)
            for (int bits = 0; bits < ALL; bits++) {
                features f = {.normal = normal, .tangential = tangential, .tension = bits & TENSION};
                f.rotation = bits & ROTATION, f.rolling = bits & ROLLING;
                f.slip = bits & TOTAL ? DEM_TOTAL : DEM_TRUNCATED;
                f.damping = bits & INSIDE ? DEM_DAMPING_INSIDE : DEM_DAMPING_OUTSIDE;
                if (!dem_has_spring(tangential) && bits & (TOTAL | INSIDE)) continue;
                if (dem_is_of_radius(tangential) && normal != DEM_ELASTIC) continue; /* they go together */
                if (f.rolling && !(f.rotation && dem_has_friction(tangential))) continue;
                for (int model = 0; model < (f.rolling ? DEM_ROLLING_N : 1); model++) {
                    f.model = (dem_rolling)model;
                    kernels_of(&f, number++);
                }
            }
}

/* ---- Descriptors ---- */

typedef struct {
    dem_normal_law law;
    double k_n, gamma_n, m_eff;
    bool damping;
} integrand;

static double value(double x, void *of)
{
    const integrand *p = of;
    return p->damping ? dem_law_damping_rate(p->law, p->k_n, p->gamma_n, p->m_eff, x)
                      : dem_law_elastic(p->law, p->k_n, x);
}

/* Of a smooth function, by Gauss and Legendre's rule. */
static double integral(integrand *p, double from, double to)
{
    gsl_integration_glfixed_table *rule = gsl_integration_glfixed_table_alloc(64);
    const double sum = gsl_integration_glfixed(&(gsl_function){value, p}, from, to, rule);
    gsl_integration_glfixed_table_free(rule);
    return sum;
}

/* The spring of a law: energy, derivative and inverses belong to its force. */
static void springs_agree(void)
{
    for (int law = 0; law < DEM_NORMAL_N; law++) {
        const dem_normal_descriptor *d = &dem_normal_descriptors[law];
        const double k = 2.385e5, m = 0.00317, a = 3.1e-4, b = 2.17e-3, step = 1e-4;
        integrand p = {law, k, 0.0, m, false};
        const double energy = d->potential(k, b), force = dem_law_elastic(law, k, b);
        CU_ASSERT(dem_law_elastic(law, k, 0.0) == 0.0 && d->potential(k, 0.0) == 0.0);
        CHECK_NEAR((d->potential(k, b) - d->potential(k, a)) / integral(&p, a, b), 1.0, 1e-13);
        const double slope =
            (dem_law_elastic(law, k, b * (1.0 + step)) - dem_law_elastic(law, k, b * (1.0 - step))) /
            (2.0 * step * b);
        CHECK_NEAR(slope / d->stiffness(k, b), 1.0, step * step);
        CHECK_NEAR(d->impact_overlap(k, m, sqrt(2.0 * energy / m)) / b, 1.0, 1e-14);
        CHECK_NEAR(d->rest_overlap(k, force) / b, 1.0, 1e-14);
        CU_ASSERT(!d->constant_stiffness || d->stiffness(k, a) == d->stiffness(k, b));
        double derivative;
        const double mean = dem_normal_descriptors[law].quotient(k, a, b, &derivative);
        CHECK_NEAR(mean * (b - a) / integral(&p, a, b), 1.0, 1e-13);
        /* of (V(b) - V(a))/(b - a) by b */
        CHECK_NEAR(derivative / ((force - mean) / (b - a)), 1.0, 1e-12);
    }
}

static void dashpots_agree(void)
{
    for (int law = 0; law < DEM_NORMAL_N; law++) {
        const dem_normal_descriptor *d = &dem_normal_descriptors[law];
        const double k = 2.385e5, gamma = 1.7, m = 0.00317, a = 3.1e-4, b = 2.17e-3, v = -13.0;
        integrand p = {law, k, gamma, m, true};
        CHECK_NEAR(dem_normal_descriptors[law].mean_rate(k, gamma, m, a, b) * (b - a) / integral(&p, a, b),
                   1.0, 1e-13);
        CHECK_NEAR(d->damping_rate(k, gamma, m, b) / value(b, &p), 1.0, 0.0);
        CHECK_NEAR(d->damping_rate(k, 3.0 * gamma, m, b) / value(b, &p), 3.0, 1e-15); /* linear in gamma_n */
        CHECK_NEAR(dem_law_normal(law, true, k, gamma, m, b, v),
                   dem_law_elastic(law, k, b) - value(b, &p) * m * v, 0.0);
        /* what pulls is cut */
        const double parting = 2.0 * dem_law_elastic(law, k, b) / (value(b, &p) * m);
        CU_ASSERT(dem_law_normal(law, true, k, gamma, m, b, parting) < 0.0);
        CU_ASSERT(dem_law_normal(law, false, k, gamma, m, b, parting) == 0.0);
    }
}

/* The force that an observer reads is the law's, and that which moves the grains. */
static void observed_force(void)
{
    for (int law = 0; law < DEM_NORMAL_N; law++) {
        const dem_grain grains[2] = {{.x = 0.0, .r = 0.1, .m = 0.004, .vx = 3.0},
                                     {.x = 0.199, .r = 0.1, .m = 0.004, .vx = -2.0}};
        dem_definition def = grains_afloat(2, grains);
        grains_law(&def, law, 1.5e5, 500.0);
        scoped_sim *sim = grains_after(&def, 1);
        const dem_contact c = grains_only_contact(sim);
        scoped dem_state *s = grains_states(sim);
        /* Verlet damps by the velocity of half a step before */
        const double m_eff = 0.002, v_n = s[1].vx - s[0].vx - 0.5 * def.dt * s[1].fx / m_eff,
                     law_force =
                         dem_law_normal(law, true, dem_normal_descriptors[law].scale(def.material.k_n, 0.05),
                                        def.material.gamma_n, m_eff, c.overlap, v_n);
        CU_ASSERT(c.normal_force > 0.0 && c.overlap > 0.0);
        CHECK_PAIRS(1e-12 * law_force, {c.normal_force, law_force}, {s[1].fx, c.normal_force},
                    {s[0].fx, -c.normal_force});
    }
}

/* ---- Restitution ---- */

static const double ratios[] = {0.003, 0.04, 0.215, 0.5, 0.7, 0.73, 0.93, 0.999, 1.0, 1.02, 1.7, 4.1};
enum { RATIOS = sizeof ratios / sizeof *ratios };

/* Closed forms against the solution of the equation of motion, at speeds that differ by far. */
static void restitution_has_closed_form(void)
{
    const double k = 2.385e5, m = 0.00317;
    for (int law = 0; law < DEM_NORMAL_N; law++) {
        const dem_normal_descriptor *d = &dem_normal_descriptors[law];
        for (int i = 0; i < RATIOS * 2 * (d->damping_ratio != NULL); i++) {
            const double ratio = ratios[i / 2], gamma = ratio / d->damping_ratio(k, 1.0, m);
            CHECK_NEAR(d->damping_ratio(k, gamma, m), ratio, 1e-14 * ratio);
            const bool tension = i % 2;
            for (double v = 0.13; v < 1e3; v *= 37.0) {
                dem_collision_result c;
                CHECK_OK(dem_collision(&(dem_head_on){law, tension, k, gamma, m, v}, &c));
                CHECK_NEAR(c.restitution, dem_restitution(tension, ratio), 1e-12);
            }
        }
    }
}

static void restitution_is_inverted(void)
{
    for (int tension = 0; tension < 2; tension++) {
        CU_ASSERT(dem_restitution(tension, 0.0) == 1.0 && dem_damping_ratio_of(tension, 1.0) == 0.0);
        for (double e = 1e-3; e < 1.0; e *= 1.31)
            CHECK_NEAR(dem_restitution(tension, dem_damping_ratio_of(tension, e)), e, 1e-12);
        for (int i = 1; i < RATIOS; i++)
            CU_ASSERT(dem_restitution(tension, ratios[i]) < dem_restitution(tension, ratios[i - 1]) ||
                      (tension && ratios[i] > 1.0));
    }
    /* critical damping: exp(-2); the series about it from both sides */
    CHECK_NEAR(dem_restitution(false, 1.0), exp(-2.0), 1e-15);
    CHECK_NEAR(dem_restitution(false, 1.0 - 1e-9), exp(-2.0), 1e-8);
    CHECK_NEAR(dem_restitution(false, 1.0 + 1e-9), exp(-2.0), 1e-8);
    CU_ASSERT(dem_restitution(true, 1.0) == 0.0 && dem_restitution(true, 3.0) == 0.0);
}

/* Two equal grains and a wall: what a restitution gives is what the simulator does. */
static double simulated_restitution(dem_definition *def, double v)
{
    dem_grain grains[2] = {{.x = 0.0, .r = 0.1, .m = 0.004, .vx = v}, {.x = 0.2, .r = 0.1, .m = 0.004}};
    def->gravity[1] = def->material.mu = 0.0, def->tangential = DEM_NONE;
    def->grains = grains, def->n_grains = 2;
    def->dt = 2e-3 * dem_time_step_limit(def, NULL);
    scoped_sim *sim = grains_start(def);
    dem_state s[2];
    grains_run(sim, 8000, s);
    return (s[1].vx - s[0].vx) / v;
}

static void restitution_in_place_of_damping(void)
{
    for (int normal = 0; normal < DEM_NORMAL_N; normal++)
        for (int i = 0; i < 6; i++) {
            const double e = 0.3 + 0.15 * (i / 2), v = 37.0, first_order = 2e-2;
            dem_definition def = dem_definition_default();
            def.normal = normal, def.tension = i % 2;
            def.material.k_n = 1.5e5 / dem_normal_descriptors[normal].stiffness(1.0, 0.01);
            def.material.restitution = e, def.material.gamma_n = -1.0;
            def.restitution_speed = v;
            const bool any_speed = dem_normal_descriptors[normal].damping_ratio != NULL;
            CHECK_NEAR(simulated_restitution(&def, any_speed ? 2.0 * v : v), e, first_order * e);
        }
}

/* Damping that pulls has a limit, beyond which grains of Hertz' law stick: just above the sticking speed they
 * part, just below they do not. Restitution falls to 0 at that limit in a straight line.
 */
static void little_restitution(void)
{
    const double k_n = 1e6, m_eff = 0.002, v = 50.0, e = 1e-6;
    const dem_normal_descriptor *law = &dem_normal_descriptors[DEM_HERTZ];
    double gamma_n[3];
    dem_collision_result c;
    for (int k = 0; k < 3; k++)
        CHECK_OK(dem_damping_of(&(dem_head_on){DEM_HERTZ, true, .k_n = k_n, .m_eff = m_eff, .v = v},
                                (k + 1.0) * e, &gamma_n[k]));
    /* the slope changes as the root of the overlap at which the spring no longer counts, of order e */
    CHECK_NEAR((gamma_n[0] - gamma_n[1]) / (gamma_n[1] - gamma_n[2]), 1.0, 10.0 * sqrt(e));
    const double limit = 2.0 * gamma_n[0] - gamma_n[1];
    CHECK_NEAR(law->sticking_speed(k_n, limit, m_eff) / v, 1.0, e);
    for (int k = -1; k < 2; k += 2) {
        CHECK_OK(dem_collision(&(dem_head_on){DEM_HERTZ, true, k_n, limit * (1.0 + e * k), m_eff, v}, &c));
        CU_ASSERT((law->sticking_speed(k_n, limit * (1.0 + e * k), m_eff) > v) == (k > 0));
        CU_ASSERT((c.restitution == 0.0) == (k > 0) && c.restitution < e);
    }
    CHECK_OK(dem_collision(&(dem_head_on){DEM_HERTZ, true, k_n, gamma_n[0], m_eff, v}, &c));
    CHECK_NEAR(c.restitution, e, 1e-5 * e);
}

/* The damping of a restitution at a speed, of + - * / and roots, has the same bits everywhere, and is the
 * law's: of impacts that scale, gamma_n (m_eff/k_n)^(2/5) v^(-1/5) is the same. */
static void damping_has_same_bits(void)
{
    static const struct {
        bool tension;
        double restitution, gamma_n;
    } cases[] = {{false, 0.9, 0x1.22d9efc89f8b8p+7},    {false, 0.5, 0x1.0acc4c9208b2cp+10},
                 {false, 0.01, 0x1.bde887d75fe94p+13},  {false, 1e-6, 0x1.21c0126f850f5p+19},
                 {false, 1e-20, 0x1.b809cbcd5a669p+37}, {true, 0.9, 0x1.136985b88c846p+7},
                 {true, 0.5, 0x1.a39b330d30ddfp+9},     {true, 0.01, 0x1.41e00766c2dbcp+11},
                 {true, 1e-6, 0x1.4d1947ed0b68dp+11}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        dem_head_on impact = {DEM_HERTZ, cases[i].tension, .k_n = 2.385e5, .m_eff = 0.00317, .v = 13.0};
        double gamma_n, scaled;
        CHECK_OK(dem_damping_of(&impact, cases[i].restitution, &gamma_n));
        CHECK_OR_SAY(gamma_n == cases[i].gamma_n, "gamma_n = %a, expected %a", gamma_n, cases[i].gamma_n);
        impact.k_n *= 7.0, impact.v *= 3.0, impact.m_eff *= 1.1;
        CHECK_OK(dem_damping_of(&impact, cases[i].restitution, &scaled));
        CHECK_NEAR(scaled / gamma_n / (pow(7.0 / 1.1, 0.4) * pow(3.0, 0.2)), 1.0, 1e-12);
    }
}

static void bad_restitution(void)
{
    dem_grain grains[2] = {{.x = 0.0, .r = 0.1, .m = 0.004}, {.x = 0.3, .r = 0.1, .m = 0.004}};
    dem_definition def = grains_afloat(2, grains);
    scoped_sim *sim = NULL;
    double gamma_n;
    def.material.restitution = 0.5;
    CHECK_FAILS(dem_create(&def, &sim), RP_BAD_INPUT, "restitution = 0.5, gamma_n = 500: give one");
    def.material.gamma_n = -1.0;
    grains[0].vx = 50.0; /* of a start that is to be no choice of a speed */
    CHECK_FAILS(dem_create(&def, &sim), RP_BAD_INPUT, "give restitution_speed, in (0, inf)");
    def.restitution_speed = 0.01;
    CHECK_OK(dem_create(&def, &sim));
    dem_free(sim);
    /* nearer to 1 than an impact is computed: no damping, as 1 has */
    const dem_head_on near = {.normal = DEM_HERTZ, .k_n = 1e6, .m_eff = 0.002, .v = 50.0, .tension = true};
    CHECK_OK(dem_damping_of(&near, 1.0 - 1e-15, &gamma_n));
    CU_ASSERT(gamma_n >= 0.0 && gamma_n < 1e-6);
    def.material.restitution = 1.1;
    CHECK_FAILS(dem_create(&def, &sim), RP_BAD_INPUT, "restitution = 1.1");
    def.material.restitution = 0.5, def.material.k_n = 0.0;
    CHECK_FAILS(dem_create(&def, &sim), RP_BAD_INPUT, "needs k_n > 0");
    dem_head_on impact = {DEM_LINEAR, true, .k_n = 1e6, .m_eff = 1.0, .v = 1.0};
    CHECK_FAILS(dem_damping_of(&impact, 0.0, &gamma_n), RP_BAD_INPUT, "(0, 1]");
    CHECK_FAILS(dem_damping_of(&impact, NAN, &gamma_n), RP_BAD_INPUT, "(0, 1]");
    impact.normal = DEM_HERTZ;
    CHECK_OK(dem_damping_of(&impact, 1.0, &gamma_n));
    CU_ASSERT(gamma_n == 0.0);
}

/* No coefficient in 1/s follows from a gamma_n without a unit. */
static void defaults_need_a_rate(void)
{
    for (int normal = 0; normal < DEM_NORMAL_N; normal++) {
        const bool rate = strcmp(dem_normal_descriptors[normal].gamma_n_unit, "1/s") == 0;
        dem_definition def = dem_definition_default();
        dem_physics p = dem_physics_default(RP_CGS);
        p.normal = normal;
        dem_physics_apply(&p, &def);
        if (!rate) CHECK_FAILS(dem_physics_check(&def), RP_BAD_INPUT, "gamma_n: has no default");
        p.gamma_n = 0.3;
        dem_physics_apply(&p, &def);
        CHECK_OK(dem_physics_check(&def)); /* without friction */
        p.tangential = DEM_SPRING;
        dem_physics_apply(&p, &def);
        if (rate) CHECK_NEAR(def.material.gamma_s, 0.003, 1e-17);
        const char *expected = check_text(
            "gamma_s: has no default for the law %s, whose gamma_n is a number; give a rate, in 1/s",
            dem_normal_descriptors[normal].name);
        if (!rate) CHECK_FAILS(dem_physics_check(&def), RP_BAD_INPUT, expected);
        p.gamma_s = 5.0;
        dem_physics_apply(&p, &def);
        CHECK_OK(dem_physics_check(&def));
        CU_ASSERT(def.material.gamma_s == 5.0 && def.material.gamma_roll == 5.0);
    }
}

/* A wall has the grains' restitution, for its own stiffness and mass; or its own; or its own gamma_n. What
 * "auto" takes from gamma_n follows. */
static void restitution_of_walls(void)
{
    dem_grain grain = {.x = 0.0, .y = 1.0, .r = 0.1, .m = 0.004};
    dem_definition def = dem_definition_default();
    dem_physics p = dem_physics_default(RP_CGS);
    p.normal = DEM_LINEAR;
    p.dt = 1e-5;
    p.tangential = DEM_SPRING;
    p.restitution = 0.4;
    dem_physics_apply(&p, &def);
    const dem_normal_descriptor *law = &dem_normal_descriptors[DEM_LINEAR];
    dem_material stiff = dem_material_auto;
    stiff.k_s = 7.0, stiff.gamma_s = 8.0, stiff = dem_wall_material(RP_CGS, &stiff, &p);
    CHECK_PAIRS(0.0, {stiff.k_roll, 7.0}, {stiff.gamma_roll, 8.0}, {stiff.k_n, 2.0 * p.k_n});
    for (int choice = 0; choice < 3; choice++) {
        dem_material given = dem_material_auto;
        if (choice == 1) given.restitution = 0.7;
        if (choice == 2) given.gamma_n = 123.0;
        grains_on_floor(&def, 1, &grain);
        def.walls[0].material = dem_wall_material(RP_CGS, &given, &p);
        scoped_sim *sim = grains_start(&def);
        const dem_material *floor = &sim->def.walls[0].material, *grains = &sim->def.material;
        CHECK_NEAR(dem_restitution(true, law->damping_ratio(grains->k_n, grains->gamma_n, 0.002)), 0.4,
                   1e-12);
        CHECK_PAIRS(0.0, {grains->gamma_s, grains->gamma_n / 100.0},
                    {floor->gamma_s, floor->gamma_n / 100.0});
        if (choice == 2) CU_ASSERT(floor->gamma_n == 123.0);
        if (choice < 2)
            CHECK_NEAR(dem_restitution(true, law->damping_ratio(floor->k_n, floor->gamma_n, 0.004)),
                       choice ? 0.7 : 0.4, 1e-12);
    }
}

/* gamma_n by the restitution of one material alone, particles or any wall, for the grains' mean mass; walls
 * alike and unlike; a list of walls that is lent stays as it is. */
static void restitution_of_any_wall(void)
{
    enum { MANY = DEM_FEW_WALLS + 1 };
    const dem_grain grains[3] = {
        {.x = 0.0, .r = 0.1, .m = 0.003}, {.x = 1.0, .r = 0.1, .m = 0.004}, {.x = 2.0, .r = 0.1, .m = 0.008}};
    dem_definition def = grains_of(3, grains);
    dem_wall walls[MANY];
    def.normal = DEM_LINEAR, def.n_walls = 3;
    for (int asks = -1; asks < MANY; asks++) {
        dem_definition own = def;
        double gamma_n, alike;
        for (int w = 0; w < MANY; w++) {
            walls[w] = grains_line(0.0, -1.0, 0.0, 1.0, &def.material);
            walls[w].material.k_n = w < 2 ? 1e5 : 3e5;
            if (asks >= 3 && w >= asks - 1)
                walls[w].material.restitution = 0.4, walls[w].material.gamma_n = -1.0;
            if (w < 3) own.walls[w] = walls[w];
        }
        if (asks >= 3) own.n_walls = MANY, own.wall_list = walls;
        dem_material *m = asks < 0 ? &own.material : &own.walls[asks < 3 ? asks : 0].material;
        if (asks < 3) m->restitution = 0.4, m->gamma_n = -1.0;
        CHECK_OK(dem_damping_of(&(dem_head_on){DEM_LINEAR, def.tension, .k_n = 3e5, .m_eff = 0.005, .v = 1.0},
                                0.4, &alike));
        CHECK_OK(dem_damping_of(&(dem_head_on){DEM_LINEAR, def.tension, .k_n = m->k_n,
                                               .m_eff = asks < 0 ? 0.0025 : 0.005, .v = 1.0},
                                0.4, &gamma_n));
        CHECK_OK(dem_physics_resolve(&own));
        if (asks < 3) CHECK_NEAR(m->gamma_n, gamma_n, 1e-12 * gamma_n);
        CU_ASSERT(own.material.gamma_n == 500.0 || asks < 0);
        for (int w = 0; w < (int)own.n_walls; w++) {
            const dem_material *is = &dem_walls_of(&own)[w].material;
            if (asks < 3 && w != asks) CU_ASSERT(is->gamma_n == 500.0);
            if (asks >= 3) CHECK_NEAR(is->gamma_n, w >= asks - 1 ? alike : 500.0, 1e-12 * alike);
            CU_ASSERT(!(is->restitution > 0.0));
            if (asks >= 3) CU_ASSERT((walls[w].material.gamma_n == -1.0) == (w >= asks - 1));
        }
        dem_physics_free(&own, &def);
        own.material.restitution = -1.0, own.material.gamma_n = 500.0;
        own.wall_list = NULL, own.n_walls = 3;
        for (int w = 0; w < 3; w++) own.walls[w] = walls[0];
        own.walls[2].material.restitution = 0.4, own.walls[2].material.gamma_n = 0.0;
        CHECK_FAILS(dem_physics_resolve(&own), RP_BAD_INPUT,
                    "wall 3: restitution = 0.4, gamma_n = 0: give one");
        own.n_walls = MANY;
        CHECK_FAILS(dem_physics_resolve(&own), RP_BAD_INPUT, "9 walls: more than 8 need a list");
    }
}

CHECK_SUITE(laws, "laws", kernels_match_reference, springs_agree, dashpots_agree, observed_force,
            restitution_has_closed_form, restitution_is_inverted, little_restitution,
            restitution_in_place_of_damping, damping_has_same_bits, bad_restitution, defaults_need_a_rate,
            restitution_of_walls, restitution_of_any_wall)
