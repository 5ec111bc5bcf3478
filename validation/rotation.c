/* Validation of tangential forces against closed forms: damping under the Coulomb limit, rotation, rolling
 * resistance. q = I/(m r^2) is 2/5 for a sphere and 1/2 for a disk; b is the lever arm of the force about the
 * centre, r minus the overlap with a wall. */
#include <float.h>

#include "dem/law/law.h"
#include "tests/grains.h"
#include "validation/cases.h"
#include "validation/oblique.h"

static case_problem rolls_problem = {"slides_then_rolls", "force mu m g; v - (q r^2/b) omega is constant",
                                     "loading time of the spring and a step; round-off"},
                    oblique_problem = {"oblique", "event by event, undamped linear law",
                                       "W dt of the spring's first step; overlap/r"};

static const double R = 0.1193, M = 0.00471, G = 981.0, FLOOR_K = 2e6;

/* The disk has the largest I/(m r^2). */
static double inertia_ratio(int shape)
{
    return dem_inertia(shape, 1.0, 1.0);
}

/* One rotating grain in equilibrium on a floor, gravity rotated by `angle` towards +x. */
static dem_definition on_floor(double angle, dem_grain *grain, const dem_material *material)
{
    dem_definition def = dem_definition_default();
    *grain = (dem_grain){0.0, R - pow(M * G * cos(angle) / FLOOR_K, 2.0 / 3.0), R, M};
    def.gravity[0] = G * sin(angle), def.gravity[1] = -G * cos(angle), def.rotation = true;
    def.material = *material, def.dt = 1e-5;
    grains_on_floor(&def, 1, grain);
    def.walls[0].material.k_n = FLOOR_K;
    return def;
}

static dem_state run(dem_sim *sim, double seconds, double dt)
{
    dem_state s[2];
    grains_run(sim, lround(seconds / dt), s);
    return s[0];
}

/* The law itself: under the limit both laws agree. Beyond it, the total force with the inner dashpot equals
 * the limit, and the spring carries the limit minus the dashpot force. */
static void inside_law(void)
{
    const double k = 1e4, gamma = 40.0, mu = 0.3, m = 0.004, f_n = 2.385, h = 1e-5, cap = mu * f_n;
    const dem_slider inside = dem_slider_of(DEM_TRUNCATED, DEM_DAMPING_INSIDE, k, gamma, mu),
                     outside = dem_slider_of(DEM_TRUNCATED, DEM_DAMPING_OUTSIDE, k, gamma, mu),
                     whole = dem_slider_of(DEM_TOTAL, DEM_DAMPING_INSIDE, k, gamma, mu);
    for (int sign = -1; sign <= 1; sign += 2) {
        double inner = sign * 1e-5, outer = inner;
        const double little = dem_law_shear(inside, m, sign * 0.5, f_n, h, &inner);
        CHECK_NEAR(little, dem_law_shear(outside, m, sign * 0.5, f_n, h, &outer), 1e-15);
        CHECK_NEAR(inner, outer, 0.0);
        /* sliding at 3 cm/s loads the spring to its limit; a dashpot of 0.48 carries most of it */
        for (int step = 0; step < 10; step++)
            CU_ASSERT(fabs(dem_law_shear(inside, m, sign * 3.0, f_n, h, &inner)) <= cap);
        CHECK_NEAR(k * inner, sign * (cap - gamma * m * 3.0), 1e-13);
        double total = sign * 1e-3;
        CHECK_NEAR(dem_law_shear(whole, m, sign * 3.0, f_n, h, &total), -sign * cap, 1e-15);
        CHECK_NEAR(total, sign * (1e-3 + 3.0 * h), 1e-16);
    }
}

/* Transition from sliding to rolling. The force f of the floor changes v_x by f/m and omega by b f/(q m r^2),
 * so that v_x - (q r^2/b) omega is constant for any force. Rolling, v_x = -b omega, then has v_x = v0/(1 + q
 * r^2/b^2): without overlap 5/7 of v0 for a sphere, 2/3 for a disk. With the force mu m g, rolling starts at
 * t = v0/(mu g (1 + b^2/(q r^2))). */
static void check_rolls(int shape, double mu, double v0)
{
    const double q = inertia_ratio(shape);
    dem_material c = {.k_n = 1e6, .gamma_n = 500.0, .k_s = 1e4, .gamma_s = 0.0, .mu = mu};
    dem_grain grain;
    dem_definition def = on_floor(0.0, &grain, &c);
    def.shape = shape;
    grain.vx = v0;
    const double b = grain.y, ratio = q * R * R / (b * b), exact = v0 / (mu * G * (1.0 + 1.0 / ratio));
    scoped_sim *sim = grains_start(&def);
    dem_state s = {0};
    double slip = v0, last = v0;
    while (dem_time(sim) < 2.0 * exact && slip > 0.0) {
        last = slip;
        s = run(sim, def.dt, def.dt);
        slip = s.vx + b * s.omega;
    }
    /* the spring is loaded after mu m g/(k_s v0), the force a step later */
    const double late = mu * M * G / (1e4 * v0) + def.dt;
    case_near(&rolls_problem, "time", exact, dem_time(sim) - def.dt * slip / (slip - last), late,
              "%s mu=%g v0=%g dt=%g", shape == DEM_SPHERE ? "sphere" : "disk", mu, v0, def.dt);
    case_also(&rolls_problem, "distance", v0 * exact - 0.5 * mu * G * exact * exact, s.x, v0 * late);
    case_also(&rolls_problem, "kept", v0, s.vx - q * R * R / b * s.omega,
              DBL_EPSILON * v0 * dem_time(sim) / def.dt);
    /* the remaining spring force oscillates and decays as exp(-gamma_s (1 + 1/q) t/2) */
    def.walls[0].material.gamma_s = 40.0;
    grains_again(&sim, &def, 0);
    s = run(sim, exact + 0.6, def.dt);
    case_also(&rolls_problem, "speed", v0 / (1.0 + ratio), s.vx, 1e-9 * v0);
    case_also(&rolls_problem, "spin", -s.vx / b, s.omega, 1e-9 * v0 / b);
    /* x + b angle is the slip distance; the conserved quantity gives the other relation */
    case_also(&rolls_problem, "angle", v0 * dem_time(sim), s.x - q * R * R / b * s.angle, 1e-9 * v0);
}

static void slides_then_rolls(void)
{
    static const double mus[] = {0.07, 0.2385, 0.8}, speeds[] = {3.0, 20.0, 70.0};
    for (int i = 0; i < 2 * 3 * 3; i += case_stride(5))
        check_rolls(i % 2 ? DEM_DISK : DEM_SPHERE, mus[i / 2 % 3], speeds[i / 6]);
}

/* Impacts on a wall or another grain, linear law: v_n and v_s at contact, and v_s after. */
typedef struct {
    bool pair;
    int shape;
    double k_s, mu, v_n, v_s;
    double out_s, turned; /* after; change of the first grain's spin */
} oblique;

static const double LINEAR_K = 1e5;

static void collide(oblique *p, double steps)
{
    const double r2 = 0.0871, m2 = 0.00297, m_eff = p->pair ? M * m2 / (M + m2) : M;
    const double dt = M_PI * sqrt(m_eff / LINEAR_K) / steps, gap = 0.381 * p->v_n * dt;
    /* the first grain falls on the other; s is +x. Half of the slip is backspin, the rest its speed */
    const double spin[2] = {-0.7 * p->v_s / R, p->pair ? 0.4 * p->v_s / r2 : 0.0};
    const double vx = p->v_s - R * spin[0] - r2 * spin[1];
    dem_grain grains[2] = {{0.0, R + gap, R, M, vx, -p->v_n, 0.0, spin[0]},
                           {0.0, -r2, r2, m2, 0.0, 0.0, 0.0, spin[1]}};
    dem_definition def = grains_bare(1 + p->pair, grains, DEM_LINEAR,
                                     (dem_material){.k_n = LINEAR_K, .k_s = p->k_s, .mu = p->mu});
    def.tangential = DEM_SPRING, def.rotation = true, def.shape = p->shape;
    def.dt = dt, def.n_walls = !p->pair;
    def.walls[0] = grains_line(0.0, 0.0, 0.0, 1.0, &def.material);
    scoped_sim *sim = grains_start(&def);
    dem_state s[2] = {0};
    do {
        CU_ASSERT_FATAL(dem_run(sim, 10) == RP_OK && dem_time(sim) < 3.0 * steps * dt);
        dem_states(sim, s);
    } while (s[0].contacts > 0 || dem_time(sim) < 2.0 * dt);
    p->out_s = s[0].vx - s[1].vx + R * s[0].omega + r2 * s[1].omega;
    p->turned = s[0].omega - spin[0];
}

static void oblique_any(void)
{
    static const double kappas[] = {0.05, 2.0 / 7.0, 0.86}, mus[] = {0.1, 0.4},
                        slopes[] = {0.02, 0.2, 0.6, 1.2, 2.5, 6.0};
    for (int i = 0; i < 2 * 2 * 3 * 2 * 6; i += case_stride(5)) {
        oblique p = {.pair = i % 2, .shape = i / 2 % 2 ? DEM_DISK : DEM_SPHERE, .v_n = 2e-4};
        p.k_s = LINEAR_K * kappas[i / 4 % 3], p.mu = mus[i / 12 % 2];
        p.v_s = p.v_n * slopes[i / 24];
        const double steps = 4000.0, q = inertia_ratio(p.shape), a = 1.0 + 1.0 / q;
        const double m_eff = p.pair ? M * 0.00297 / (M + 0.00297) : M, depth = p.v_n * sqrt(m_eff / LINEAR_K);
        const double out = oblique_left(a, p.k_s / LINEAR_K, p.mu, p.v_n, p.v_s);
        collide(&p, steps);
        /* the first step of the spring counts in full, although contact starts within it; lever arms change
         * with the overlap, and a pair rotates with its tangential displacement */
        const double first = sqrt(a * p.k_s / LINEAR_K) * M_PI / steps * p.v_s;
        const double places = depth / R + (p.pair ? 2.0 * p.v_s * M_PI * depth / p.v_n / (R + 0.0871) : 0.0);
        const double bound = first + 3.0 * places * (p.v_s + p.v_n);
        case_near(&oblique_problem, "slip", out, p.out_s, bound, "%s %s k_s/k_n=%g mu=%g v_s/v_n=%g",
                  p.shape == DEM_SPHERE ? "sphere" : "disk", p.pair ? "grain" : "wall", kappas[i / 4 % 3],
                  p.mu, slopes[i / 24]);
        case_also(&oblique_problem, "spin", m_eff * (out - p.v_s) / (a * q * M * R), p.turned,
                  m_eff * bound / (q * M * R));
    }
}

/* Event by event against the two ends of the range, sliding and sticking, in closed form. */
static void oblique_ends(void)
{
    for (int i = 0; i < 20; i++) {
        const double a = i % 2 ? 3.0 : 3.5, kappa = 0.05 + 0.04 * i, mu = 0.13, v_n = 1.7;
        const double fast = 1.1 * fmax(2.0 * a * mu * v_n + mu * v_n / kappa, mu * v_n / kappa);
        CHECK_NEAR(oblique_left(a, kappa, mu, v_n, fast), fast - 2.0 * a * mu * v_n, 1e-12);
        CHECK_NEAR(oblique_left(a, kappa, 1e9, v_n, 1.0), cos(M_PI * sqrt(a * kappa)), 1e-6);
    }
}

/* In stick, without damping, a grain with a speed oscillates on its shear and rolling springs. Its energy is
 * constant to the leapfrog's second order, (omega dt)^2 with omega^2 = (3.5 k_s + 2.5 k_roll)/m. */
static void energy_stays(void)
{
    dem_material c = {
        .k_n = 1e6, .gamma_n = 500.0, .k_s = 1e4, .mu = INFINITY, .mu_roll = 1e6, .k_roll = 2e3};
    dem_grain grain;
    dem_definition def = on_floor(0.0, &grain, &c);
    def.dt = 2e-6;
    grain.vx = 1.0;
    scoped_sim *sim = grains_start(&def);
    dem_rest rest;
    const double start_energy = grains_energy(sim), kick = 0.5 * M;
    double most = 0.0, rotational = 0.0, elastic = 0.0;
    for (int step = 0; step < 5000; step++) {
        CHECK_OK(dem_run(sim, 1));
        const dem_energy e = grains_energies(sim);
        dem_rest_state(sim, -1.0, 1.0, &rest);
        most = fmax(most, fabs(grains_energy(sim) - start_energy));
        rotational = fmax(rotational, e.rotational);
        elastic = fmax(elastic, e.elastic);
        CHECK_NEAR(rest.kinetic_energy, e.kinetic + e.rotational, 1e-15);
    }
    CHECK_NEAR(most / kick, 0.0, (3.5 * 1e4 + 2.5 * 2e3) / M * def.dt * def.dt);
    CU_ASSERT(rotational > 0.1 * kick && elastic > 0.3 * kick); /* each spring took part */
}

/* Rough contacts with damped shear and rolling springs, of this rolling resistance. */
static dem_material resisting(double mu_roll)
{
    dem_material c = {.k_n = 1e6, .gamma_n = 500.0, .k_s = 1e4, .gamma_s = 200.0, .mu = 5.0};
    c.mu_roll = mu_roll, c.k_roll = 1e4, c.gamma_roll = 200.0;
    return c;
}

/* The couple mu_roll m g r stops a rolling grain at the rate b mu_roll g r/(b^2 + q r^2), and it stays. */
static void rolling_stops(void)
{
    const double mu_roll = 0.05, v0 = 10.0;
    for (int shape = DEM_SPHERE; shape <= DEM_DISK; shape++) {
        const dem_material c = resisting(mu_roll);
        dem_grain grain;
        dem_definition def = on_floor(0.0, &grain, &c);
        def.shape = shape;
        grain.vx = v0, grain.omega = -v0 / grain.y;
        const double b = grain.y, slows = b * mu_roll * G * R / (b * b + inertia_ratio(shape) * R * R);
        /* springs load over these distances, and friction acts from the first step on */
        const double loading = mu_roll * M * G / 1e4 + M * slows / 1e4 + v0 * def.dt;
        scoped_sim *sim = grains_start(&def);
        dem_state s = run(sim, 0.1, def.dt);
        CHECK_NEAR(s.vx, v0 - slows * 0.1, slows * loading / v0);
        CHECK_NEAR(s.vx, -b * s.omega, 1e-3 * v0);
        s = run(sim, 0.9, def.dt);
        CHECK_PAIRS(loading, {s.x, 0.5 * v0 * v0 / slows}, {s.x, -b * s.angle});
        CHECK_NEAR(s.vx, 0.0, 1e-6 * v0);
        const double stopped = s.x;
        s = run(sim, 0.5, def.dt);
        CHECK_NEAR(s.x, stopped, 1e-6 * loading);
    }
}

/* On an incline it stays below tan(angle) = mu_roll r/b and rolls above, at
 * b (g sin b - mu_roll g cos r)/(b^2 + q r^2). Without resistance it rolls on any. */
static void rolling_incline(void)
{
    const double mu_roll = 0.2;
    for (int k = 0; k < 3; k++) {
        const double angle = atan((k == 0 ? 0.9 : k == 1 ? 1.1 : 0.05) * mu_roll);
        const double resists = k < 2 ? mu_roll : 0.0;
        const dem_material c = resisting(resists);
        dem_grain grain;
        dem_definition def = on_floor(angle, &grain, &c);
        scoped_sim *sim = grains_start(&def);
        dem_state s = run(sim, 0.8, def.dt);
        const double v = s.vx, b = grain.y;
        s = run(sim, 0.2, def.dt);
        if (k == 0) {
            CHECK_NEAR(s.vx, 0.0, 1e-6);
            /* suddenly loaded, it swings by the springs' extension, m g sin over stiffness, till it sticks */
            CU_ASSERT(s.x > 0.0 && s.x < 10.0 * 2.0 * M * G * sin(angle) / 1e4);
            CHECK_NEAR(grains_only_contact(sim).rolling_torque, M * G * sin(angle) * b, 1e-6 * M * G * R);
            CHECK_NEAR(s.torque, 0.0, 1e-6 * M * G * R);
        } else {
            const double rolls =
                b * (G * sin(angle) * b - resists * G * cos(angle) * R) / (b * b + 0.4 * R * R);
            CHECK_NEAR((s.vx - v) / 0.2, rolls, 1e-6 * G); /* the oscillation has decayed as exp(-gamma t) */
        }
    }
}

CASES(rotation, &rolls_problem, &oblique_problem)

CHECK_SUITE_SUMMED(rotation, "validation: rotation and rolling", inside_law, slides_then_rolls, oblique_ends,
                   oblique_any, energy_stays, rolling_stops, rolling_incline, cases)
