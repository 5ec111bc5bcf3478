/* Validation of the contact laws and the integrator against closed forms: head-on impacts of the Hertz and
 * the linear law, with the observed order; static overlaps; a block on an incline. */
#include <gsl/gsl_sf_gamma.h>
#include <stdlib.h>
#include <string.h>

#include "dem/dem.h"
#include "tests/check.h"
#include "tests/grains.h"

/* Two unequal grains that meet head on at relative speed v; `clipped`: the damped force may not pull. */
typedef struct {
    int law;
    double k_n, gamma_n, v;
    bool clipped;
} impact;

static const double R_A = 0.1385, R_B = 0.0871, M_A = 0.01313, M_B = 0.00297;
static const double M_EFF = 0.01313 * 0.00297 / (0.01313 + 0.00297);

static dem_definition two_grains(const impact *p, double dt, dem_grain grains[2])
{
    dem_definition def = dem_definition_default();
    /* the first touch lies a fraction of a step after the start, so that no step meets it exactly */
    const double gap = 0.381 * p->v * dt, distance = R_A + R_B + gap;
    const double ux = 0.6, uy = 0.8; /* off the axes */
    grains[0] = (dem_grain){0.0, 0.0, R_A, M_A, ux * p->v * M_B / (M_A + M_B), uy * p->v * M_B / (M_A + M_B)};
    grains[1] = (dem_grain){ux * distance,
                            uy * distance,
                            R_B,
                            M_B,
                            -ux * p->v * M_A / (M_A + M_B),
                            -uy * p->v * M_A / (M_A + M_B)};
    def.gravity[1] = 0.0;
    def.normal = p->law;
    def.tension = !p->clipped;
    def.tangential = DEM_NONE;
    def.material = (dem_material){.k_n = p->k_n, .gamma_n = p->gamma_n};
    def.dt = dt;
    def.grains = grains;
    def.n_grains = 2;
    return def;
}

/* Restitution and largest overlap of the simulated impact; time of contact to a step's fraction. */
static void simulate(const impact *p, double dt, double *restitution, double *overlap, double *time)
{
    dem_grain grains[2];
    dem_definition def = two_grains(p, dt, grains);
    dem_sim *sim;
    CHECK_OK(dem_create(&def, &sim));
    *overlap = *time = 0.0;
    *restitution = NAN;
    for (long step = 0; step < 10000000; step++) {
        dem_state s[2];
        CU_ASSERT_EQUAL_FATAL(dem_run(sim, 1), RP_OK);
        dem_states(sim, s);
        double x = s[1].x - s[0].x, y = s[1].y - s[0].y, r = hypot(x, y);
        double closing = -((s[1].vx - s[0].vx) * x + (s[1].vy - s[0].vy) * y) / r;
        double depth = R_A + R_B - r;
        if (depth > *overlap) *overlap = depth;
        if (depth <= 0.0 && closing < 0.0) {
            *restitution = -closing / p->v;
            *time = dem_time(sim) - 0.381 * dt + depth / -closing; /* back to the moment of parting */
            break;
        }
    }
    dem_free(sim);
}

/* Elastic Hertz impact: overlap (5 m v^2 / 4 k)^(2/5), time 2.9432 overlap/v (the constant is
 * 4/5 sqrt(pi) Gamma(2/5)/Gamma(9/10)). */
static void hertz_elastic(void)
{
    const impact p = {DEM_HERTZ, 2.385e6, 0.0, 31.7, false};
    double e, overlap, time, deepest = pow(1.25 * M_EFF * p.v * p.v / p.k_n, 0.4);
    double exact_time = 0.8 * sqrt(M_PI) * gsl_sf_gamma(0.4) / gsl_sf_gamma(0.9) * deepest / p.v;
    const double n =
        2000.0; /* steps a contact: errors of second order are some 1/n^2, times a constant below 10 */
    simulate(&p, exact_time / n, &e, &overlap, &time);
    CHECK_NEAR(e, 1.0, 10.0 / (n * n));
    CHECK_NEAR(overlap / deepest, 1.0, 10.0 / (n * n));
    CHECK_NEAR(time / exact_time, 1.0, 10.0 / (n * n));
}

/* Linear impact: v exp(-gamma t) sin(w t) / w for the overlap; restitution exp(-gamma pi / (2 w0 ...)). */
static void linear_closed_form(void)
{
    const double n = 2000.0;
    for (int damped = 0; damped < 2; damped++) {
        const impact p = {DEM_LINEAR, 3.19e4, damped ? 417.0 : 0.0, 23.85, false};
        const double half = 0.5 * p.gamma_n, w = sqrt(p.k_n / M_EFF - half * half);
        /* the pair parts where overlap is 0 again, at t = pi/w */
        const double exact_time = M_PI / w, exact_e = exp(-half * exact_time);
        const double t_top = atan2(w, half) / w, deepest = p.v * exp(-half * t_top) * sin(w * t_top) / w;
        double e, overlap, time;
        simulate(&p, exact_time / n, &e, &overlap, &time);
        /* damping sets in with a jump: first order, with gamma dt = 417 pi/(w n) as its measure */
        const double tolerance = damped ? p.gamma_n * exact_time / n : 10.0 / (n * n);
        CHECK_NEAR(e, exact_e, tolerance);
        CHECK_NEAR(overlap / deepest, 1.0, tolerance);
        CHECK_NEAR(time / exact_time, 1.0, tolerance);
    }
}

/* Least-squares slope of log error against log n. */
static double observed_order(const impact *p, double exact_time, double exact_overlap)
{
    double sx = 0.0, sy = 0.0, sxx = 0.0, sxy = 0.0;
    const int sizes = 8;
    for (int k = 0; k < sizes; k++) {
        const double n = 40.37 * pow(1.7, k); /* no whole number of steps a contact */
        double e, overlap, time;
        simulate(p, exact_time / n, &e, &overlap, &time);
        double error = fabs(time / exact_time - 1.0) + fabs(overlap / exact_overlap - 1.0);
        double x = log(n), y = log(error);
        sx += x, sy += y, sxx += x * x, sxy += x * y;
    }
    return -(sizes * sxy - sx * sy) / (sizes * sxx - sx * sx);
}

static void order_elastic(void)
{
    const impact hertz = {DEM_HERTZ, 2.385e6, 0.0, 31.7, false},
                 linear = {DEM_LINEAR, 3.19e4, 0.0, 23.85, false};
    dem_collision_result exact;
    CHECK_OK(dem_collision(DEM_HERTZ, true, hertz.k_n, 0.0, M_EFF, hertz.v, &exact));
    CHECK_NEAR(observed_order(&hertz, exact.time, exact.overlap), 2.0, 0.25);
    const double w = sqrt(linear.k_n / M_EFF);
    /* a force with a kink at touch: between first and second order from phase to phase, second on average */
    CHECK_NEAR(observed_order(&linear, M_PI / w, linear.v / w), 2.0, 0.4);
}

/* The damped force jumps at touch: first order (the rebound depends on where in a step the touch falls). */
static void order_damped(void)
{
    const impact p = {DEM_HERTZ, 1e6, 500.0, 12.3, false};
    dem_collision_result exact;
    CHECK_OK(dem_collision(DEM_HERTZ, true, p.k_n, p.gamma_n, M_EFF, p.v, &exact));
    CHECK_NEAR(observed_order(&p, exact.time, exact.overlap), 1.0, 0.35);
    double e, overlap, time;
    simulate(&p, exact.time / 4000.0, &e, &overlap, &time);
    CHECK_NEAR(e, exact.restitution, p.gamma_n * exact.time / 4000.0);
}

/* A force that may not pull returns more speed, by what the solver of single impacts says. */
static void clipped_force(void)
{
    const impact pulls = {DEM_HERTZ, 1e6, 2000.0, 12.3, false}, pushes = {DEM_HERTZ, 1e6, 2000.0, 12.3, true};
    dem_collision_result a, b;
    double e_a, e_b, overlap, time;
    CHECK_OK(dem_collision(DEM_HERTZ, true, 1e6, 2000.0, M_EFF, 12.3, &a));
    CHECK_OK(dem_collision(DEM_HERTZ, false, 1e6, 2000.0, M_EFF, 12.3, &b));
    const double dt = a.time / 4000.0;
    simulate(&pulls, dt, &e_a, &overlap, &time);
    simulate(&pushes, dt, &e_b, &overlap, &time);
    CHECK_NEAR(e_a, a.restitution, 2000.0 * dt); /* first order, as below */
    CHECK_NEAR(e_b, b.restitution, 2000.0 * dt);
    CU_ASSERT(b.restitution > a.restitution + 10.0 * 2000.0 * dt);
}

/* The solver of single impacts itself: closed forms of the linear law and of elastic Hertz, the sticking
 * threshold from both sides. */
static void collision_closed_forms(void)
{
    const double k = 3.19e4, gamma = 417.0, v = 23.85, half = 0.5 * gamma, w = sqrt(k / M_EFF - half * half);
    dem_collision_result c;
    CHECK_OK(dem_collision(DEM_LINEAR, true, k, gamma, M_EFF, v, &c));
    CHECK_NEAR(c.restitution, exp(-half * M_PI / w),
               1e-10); /* adaptive steps of tolerance 1e-13, some 1e2 of them */
    CHECK_NEAR(c.time * w / M_PI, 1.0, 1e-10);
    CHECK_OK(dem_collision(DEM_HERTZ, true, 1e6, 0.0, M_EFF, v, &c));
    CHECK_NEAR(c.restitution, 1.0, 1e-10);
    /* the deepest point comes from the end of a step of 0.01: some 1e-6 */
    CHECK_NEAR(c.overlap / pow(1.25 * M_EFF * v * v / 1e6, 0.4), 1.0, 2e-6);
    const double stick = dem_sticking_speed(1e6, 500.0, M_EFF);
    CHECK_OK(dem_collision(DEM_HERTZ, true, 1e6, 500.0, M_EFF, 1.02 * stick, &c));
    CU_ASSERT(c.restitution > 0.0);
    CHECK_OK(dem_collision(DEM_HERTZ, true, 1e6, 500.0, M_EFF, 0.98 * stick, &c));
    CU_ASSERT(c.restitution == 0.0);
    CHECK_FAILS(dem_collision(DEM_HERTZ, true, 1e6, 500.0, M_EFF, 0.0, &c), RP_BAD_INPUT, "v = 0");
}

/* A grain on the floor, and a column of five: overlaps from the weight above, (m g n / k)^(2/3). */
static void static_overlap(void)
{
    enum { N = 5 };
    const double r = 0.1193, m = 0.00471, g = 981.0;
    dem_grain grains[N];
    for (int i = 0; i < N; i++) grains[i] = (dem_grain){0.5, r * (2 * i + 1), r, m, 0.0, 0.0};
    dem_definition def = dem_definition_default();
    def.material.gamma_n = 2000.0;
    def.grains = grains;
    def.n_grains = N;
    def.n_walls = 1;
    def.walls[0] = grains_line(0.0, 0.0, 0.0, 1.0, &def.material);
    def.walls[0].material.k_n = 2.3e6;
    for (int n = 1; n <= N; n += N - 1) {
        def.n_grains = (size_t)n;
        dem_sim *sim;
        dem_contact *contacts;
        size_t n_contacts;
        CHECK_OK(dem_create(&def, &sim));
        CHECK_OK(dem_run(sim, check_fast() ? 40000 : 100000));
        CHECK_OK(dem_contacts(sim, &contacts, &n_contacts));
        CU_ASSERT_EQUAL((int)n_contacts, n);
        for (size_t k = 0; k < n_contacts; k++) {
            bool floor = contacts[k].wall >= 0;
            uint32_t lower = contacts[k].id_a < contacts[k].id_b ? contacts[k].id_a : contacts[k].id_b;
            double load = floor ? n * m * g : (n - (double)lower) * m * g;
            /* the slowest mode of the column decays as exp(-20 t): to round-off after 2 s */
            CHECK_NEAR(contacts[k].overlap, pow(load / (floor ? 2.3e6 : 1e6), 2.0 / 3.0), 1e-9);
            CHECK_NEAR(contacts[k].normal_force, load, 1e-6 * load);
        }
        double forces[2];
        dem_wall_forces(sim, forces);
        CHECK_NEAR(forces[1], -n * m * g, 1e-6 * n * m * g);
        free(contacts);
        dem_free(sim);
    }
}

/* A grain on a floor, gravity inclined by `angle`; it starts where the floor carries it. */
static dem_sim *incline(double angle, double mu, int slip, double gamma_s, double k_s)
{
    const double r = 0.1, m = 0.0042, g = 981.0, k = 2e6;
    dem_grain grain = {0.0, r - pow(m * g * cos(angle) / k, 2.0 / 3.0), r, m, 0.0, 0.0};
    dem_definition def = dem_definition_default();
    def.gravity[0] = g * sin(angle);
    def.gravity[1] = -g * cos(angle);
    def.slip = slip;
    def.material = (dem_material){1e6, 500.0, k_s, gamma_s, mu};
    def.grains = &grain;
    def.n_grains = 1;
    def.n_walls = 1;
    def.walls[0] = grains_line(0.0, 0.0, 0.0, 1.0, &def.material);
    def.walls[0].material.k_n = k;
    dem_sim *sim = NULL;
    CHECK_OK(dem_create(&def, &sim));
    return sim;
}

/* Below atan(mu/2) a suddenly loaded grain sticks, displaced by m g sin/k_s; above atan(mu) it slides and
 * comes to the speed g (sin - mu cos)/gamma_s of the viscous term outside the cap. */
static void incline_sticks_and_slides(void)
{
    const double mu = 0.2385, gamma_s = 40.0, g = 981.0;
    double angle = 0.9 * atan(0.5 * mu);
    dem_state s;
    dem_sim *sim = incline(angle, mu, DEM_TRUNCATED, gamma_s, 1e4);
    CHECK_OK(dem_run(sim, 40000));
    dem_states(sim, &s);
    CHECK_NEAR(s.x, 0.0042 * g * sin(angle) / 1e4,
               1e-9); /* the sway has died out: exp(-gamma_s t / 2), t = 2 s */
    dem_free(sim);
    angle = 1.3 * atan(mu);
    sim = incline(angle, mu, DEM_TRUNCATED, gamma_s, 1e4);
    CHECK_OK(dem_run(sim, 20000));
    dem_states(sim, &s);
    double speed = g * (sin(angle) - mu * cos(angle)) / gamma_s;
    CHECK_NEAR(s.vx / speed, 1.0, 1e-9); /* exp(-gamma_s t), t = 1 s, is 4e-18; the rest is round-off */
    dem_free(sim);
}

/* As (2b) is printed, without damping, friction is a conservative spring: a grain kicked along the floor
 * comes back to its start at full speed, though it slid; the truncated spring leaves it slower. */
static void total_spring_comes_back(void)
{
    for (int slip = DEM_TRUNCATED; slip <= DEM_TOTAL; slip++) {
        const double r = 0.1, m = 0.0042, g = 981.0, k = 2e6, kick = 15.0;
        dem_grain grain = {0.0, r - pow(m * g / k, 2.0 / 3.0), r, m, kick, 0.0};
        dem_definition def = dem_definition_default();
        def.slip = slip;
        def.dt = 1e-5;
        def.material =
            (dem_material){1e6, 500.0, 200.0, 0.0, 0.2}; /* soft in shear, so that its energy counts */
        def.grains = &grain;
        def.n_grains = 1;
        def.n_walls = 1;
        def.walls[0] = grains_line(0.0, 0.0, 0.0, 1.0, &def.material);
        def.walls[0].material.k_n = k;
        dem_sim *sim;
        dem_state s = {0};
        CHECK_OK(dem_create(&def, &sim));
        double back = 0.0, most = 0.0;
        for (long step = 0; step < 60000; step++) {
            dem_energy e;
            CHECK_OK(dem_run(sim, 1));
            dem_states(sim, &s);
            dem_energies(sim, &e);
            most =
                fmax(most, fabs(e.kinetic + e.elastic + e.gravity - m * g * grain.y - 0.5 * m * kick * kick));
            if (s.vx < back) back = s.vx;
            if (s.vx < 0.0 && s.x < 0.0) break;
        }
        if (slip == DEM_TOTAL) {
            CHECK_NEAR(back, -kick, 1e-3 * kick); /* second order in dt, of a kink at slip */
            /* its energy is all there, in a spring that pulls with a constant force; the normal spring of the
             * floor holds some (2/5) m g overlap */
            CHECK_NEAR(most, 0.0, 1e-3 * 0.5 * m * kick * kick + m * g * (r - grain.y));
        } else
            CU_ASSERT(back > -0.1 * kick);
        dem_free(sim);
    }
}

void suite_impact(void)
{
    static const check_case cases[] = {{"elastic Hertz impact", hertz_elastic},
                                       {"linear impact, closed form", linear_closed_form},
                                       {"observed order, elastic", order_elastic},
                                       {"observed order, damped", order_damped},
                                       {"force that may not pull", clipped_force},
                                       {"solver of single impacts", collision_closed_forms},
                                       {"static overlap of a grain and a column", static_overlap},
                                       {"incline: sticks, slides", incline_sticks_and_slides},
                                       {"the untruncated spring comes back", total_spring_comes_back},
                                       {NULL, NULL}};
    check_register("validation: impacts and friction", cases);
}
