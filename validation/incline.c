/* Validation of the shear law on a floor: a grain that does not rotate, under inclined gravity. It starts in
 * equilibrium in the normal direction, so that the normal force is m g cos(angle) throughout. */
#include "tests/grains.h"
#include "validation/cases.h"

static const double R = 0.1, M = 0.0042, G = 981.0, FLOOR_K = 2e6;

static case_problem stick_problem = {"sticks", "m g sin/k_s",
                                     "exp(-gamma_s t/2) of the oscillation, round-off"},
                    slow_problem = {"slow_loading", "atan mu",
                                    "rate times the oscillation period and a step"},
                    sudden_problem = {"sudden_loading", "atan(mu/2)", "(w dt)^2, w^2 = k_s/m; bisection"},
                    terminal_problem = {"terminal_speed", "g (sin - mu cos)/gamma_s",
                                        "exp(-gamma_s t), round-off"},
                    speeding_problem = {"speeding_up", "g (sin - mu cos)", "round-off of the steps"},
                    stopping_problem = {"stopping", "x_1 + (v^2 - (mu g/w)^2)/(2 mu g)",
                                        "(w dt)^2 at slip, mu g dt^2 at rest"},
                    return_problem = {"comes_back", "conservative force", "(w dt)^2 at each kink"};

/* A grain with speed v along the floor. */
static dem_definition incline(double angle, const dem_material *c, double v, dem_grain *grain)
{
    dem_definition def = dem_definition_default();
    *grain = (dem_grain){0.0, R - pow(M * G * cos(angle) / FLOOR_K, 2.0 / 3.0), R, M, v, 0.0};
    def.gravity[0] = G * sin(angle), def.gravity[1] = -G * cos(angle), def.material = *c;
    grains_on_floor(&def, 1, grain);
    def.walls[0].material.k_n = FLOOR_K;
    return def;
}

static dem_state run(dem_sim *sim, double seconds, double dt)
{
    CHECK_OK(dem_run(sim, lround(seconds / dt)));
    return grains_state_of_one(sim);
}

static const double MU[] = {0.05, 0.2385, 0.7, 2.0}, K_S[] = {1e3, 1e4, 1e5};

/* Below atan(mu/2) a suddenly loaded grain sticks, and comes to rest at the displacement m g sin/k_s. */
static void sticks(void)
{
    static const double parts[] = {0.1, 0.5, 0.95};
    for (int i = 0; i < 4 * 3 * 3 * 2; i += case_stride(5)) {
        const double mu = MU[i % 4], k_s = K_S[i / 4 % 3], angle = parts[i / 12 % 3] * atan(0.5 * mu);
        const dem_material c = {.k_n = 1e6, .gamma_n = 500.0, .k_s = k_s, .gamma_s = 80.0, .mu = mu};
        dem_grain grain;
        dem_definition def = incline(angle, &c, 0.0, &grain);
        def.damping = i / 36;
        scoped_sim *sim = grains_start(&def);
        const dem_state s = run(sim, 0.8, def.dt);
        const double rest = M * G * sin(angle) / k_s;
        /* exp(-80 0.8/2) = 1e-14; x is of the order of 1e-5 and rounded to 1e-21 a step */
        case_near(&stick_problem, "displacement", rest, s.x, 1e-12 * rest + 16000 * 1e-21,
                  "mu=%g k_s=%g angle=%g damping=%s", mu, k_s, angle, def.damping ? "inside" : "outside");
    }
}

/* Under slowly rotating gravity the grain slips where friction reaches the Coulomb limit. */
static void slow_loading(void)
{
    for (int i = 0; i < 4 * 3 * 2; i += case_stride(3)) {
        const double mu = MU[i % 4], k_s = K_S[i / 4 % 3], rate = 1.0; /* rad/s */
        const dem_material c = {.k_n = 1e6, .gamma_n = 500.0, .k_s = k_s, .gamma_s = 80.0, .mu = mu};
        const int every = 4;
        dem_grain grain;
        dem_definition def = incline(0.0, &c, 0.0, &grain);
        def.damping = i / 12, def.turn_per_step = rate * def.dt;
        scoped_sim *sim = grains_start(&def);
        double slipped = NAN;
        for (long step = 0; step < lround(1.6 / def.turn_per_step) && isnan(slipped); step += every) {
            CHECK_OK(dem_run(sim, every));
            const dem_contact now = grains_only_contact(sim);
            const double held = def.damping ? now.shear_force : k_s * now.shear_spring;
            double g[2];
            dem_gravity(sim, g);
            if (fabs(held) >= mu * now.normal_force * (1.0 - 1e-12)) slipped = atan2(g[0], -g[1]);
        }
        /* the initial oscillation is rate/w; shear and normal springs follow within 1/w; a dashpot outside
         * the limit carries gamma_s/w^2 times the rate */
        const double w = sqrt(k_s / M);
        case_near(&slow_problem, "angle", atan(mu), slipped,
                  rate * (2.0 / w + 80.0 / (w * w) + every * def.dt), "mu=%g k_s=%g damping=%s", mu, k_s,
                  def.damping ? "inside" : "outside");
    }
}

/* Suddenly loaded and undamped, the spring force rises to twice the driving force, and the grain slips above
 * atan(mu/2). The spring is then shorter than the displacement. */
static bool slips_at_once(double angle, double mu, double k_s, double dt)
{
    const dem_material c = {.k_n = 1e6, .gamma_n = 0.0, .k_s = k_s, .gamma_s = 0.0, .mu = mu};
    dem_grain grain;
    dem_definition def = incline(angle, &c, 0.0, &grain);
    def.dt = dt;
    scoped_sim *sim = grains_start(&def);
    const dem_state s = run(sim, 1.2 * M_PI * sqrt(M / k_s), dt);
    return fabs(s.x - fabs(grains_only_contact(sim).shear_spring)) > 1e-12 * M * G / k_s;
}

static void sudden_loading(void)
{
    for (int i = 0; i < 4 * 3; i += case_stride(3)) {
        const double mu = MU[i % 4], k_s = K_S[i / 4], dt = 5e-3 * sqrt(M / k_s);
        double sticks_at = 0.8 * atan(0.5 * mu), slips_at = 1.2 * atan(0.5 * mu);
        for (int k = 0; k < 24; k++) {
            const double angle = 0.5 * (sticks_at + slips_at);
            *(slips_at_once(angle, mu, k_s, dt) ? &slips_at : &sticks_at) = angle;
        }
        case_near(&sudden_problem, "angle", atan(0.5 * mu), 0.5 * (sticks_at + slips_at),
                  pow(5e-3, 2.0) * 0.5 * mu + slips_at - sticks_at, "mu=%g k_s=%g dt=%g", mu, k_s, dt);
    }
}

/* Above atan(mu) it slides: with the dashpot outside the limit it reaches a terminal speed, with the dashpot
 * under the limit it accelerates uniformly. */
static void slides(void)
{
    static const double parts[] = {1.05, 1.3}, gammas[] = {20.0, 80.0, 400.0};
    for (int i = 0; i < 4 * 2 * 3; i += case_stride(5)) {
        const double mu = MU[i % 4], angle = parts[i / 4 % 2] * atan(mu), gamma_s = gammas[i / 8];
        const double pull = G * (sin(angle) - mu * cos(angle));
        const dem_material c = {.k_n = 1e6, .gamma_n = 500.0, .k_s = 1e4, .gamma_s = gamma_s, .mu = mu};
        dem_grain grain;
        dem_definition def = incline(angle, &c, 0.0, &grain);
        def.damping = DEM_DAMPING_OUTSIDE;
        scoped_sim *sim = grains_start(&def);
        case_near(&terminal_problem, "speed", pull / gamma_s, run(sim, 32.0 / gamma_s, def.dt).vx,
                  1e-12 * G / gamma_s, "mu=%g angle=%g gamma_s=%g", mu, angle, gamma_s);
        def.damping = DEM_DAMPING_INSIDE;
        grains_again(&sim, &def, 0);
        const double early = run(sim, 0.2, def.dt).vx, late = run(sim, 0.2, def.dt).vx;
        case_near(&speeding_problem, "acceleration", pull, (late - early) / 0.2, 4000 * 1e-16 * late / 0.2,
                  "mu=%g angle=%g gamma_s=%g", mu, angle, gamma_s);
    }
}

/* A grain kicked along the floor, undamped: its spring reaches the limit at x_1 = mu m g/k_s, then mu g
 * decelerates the grain. The truncated spring then returns it by its own length. The total spring, a
 * conservative force of position, returns it to the start at full speed. */
static void check_kick(int slip, double mu, double k_s, double v)
{
    const dem_material c = {.k_n = 1e6, .gamma_n = 500.0, .k_s = k_s, .gamma_s = 0.0, .mu = mu};
    const double w = sqrt(k_s / M), dt = 2e-3 / w, limit = mu * G / w; /* speed above which it slips */
    const double x1 = limit / w, v1 = sqrt(v * v - limit * limit), stopping = x1 + v1 * v1 / (2.0 * mu * G);
    dem_grain grain;
    dem_definition def = incline(0.0, &c, v, &grain);
    def.slip = slip, def.dt = dt;
    scoped_sim *sim = grains_start(&def);
    dem_state s = {.vx = v}, last = s;
    const double t1 = asin(limit / v) / w, turn = t1 + v1 / (mu * G);
    double furthest = 0.0;
    while (dem_time(sim) < 3.0 * turn && (slip == DEM_TOTAL ? s.vx >= 0.0 || s.x > 0.0 : s.vx > 0.0)) {
        last = s;
        s = run(sim, dt, dt);
        furthest = fmax(furthest, s.x);
    }
    /* the error of the force is at most k_s v dt in the step in which it slips; that of v is (w dt)^2 v/2 */
    const double kink = pow(w * dt, 2.0);
    const char *format = "%s mu=%g k_s=%g v=%g dt=%g";
    const char *reading = slip == DEM_TOTAL ? "total" : "truncated";
    case_near(&stopping_problem, "distance", stopping, furthest,
              kink * (v * v / (mu * G) + x1) + mu * G * dt * dt, format, reading, mu, k_s, v, dt);
    if (slip == DEM_TOTAL) {
        case_near(&return_problem, "speed", -v, s.vx, 2.0 * kink * v, format, reading, mu, k_s, v, dt);
        case_also(&return_problem, "time", 2.0 * turn, dem_time(sim) - dt * s.x / (s.x - last.x),
                  2.0 * kink * 2.0 * v / (mu * G) + kink / w);
    } else {
        /* stuck, it swings about the position x_1 before the turning point; observed half a period later */
        double nearest = furthest;
        for (double t = 0.0; t < 1.2 * M_PI / w; t += dt) nearest = fmin(nearest, run(sim, dt, dt).x);
        case_near(&return_problem, "swing", 2.0 * x1, furthest - nearest, 2.0 * kink * x1 + kink * x1, format,
                  reading, mu, k_s, v, dt);
    }
}

static void kicked(void)
{
    static const double speeds[] = {1.5, 4.0, 20.0}; /* in units of the slip threshold */
    for (int i = 0; i < 2 * 4 * 3 * 3; i += case_stride(5)) {
        const double mu = MU[i / 2 % 4], k_s = K_S[i / 8 % 3];
        check_kick(i % 2, mu, k_s, speeds[i / 24] * mu * G / sqrt(k_s / M));
    }
}

CASES(incline, &stick_problem, &slow_problem, &sudden_problem, &terminal_problem, &speeding_problem,
      &stopping_problem, &return_problem)

CHECK_SUITE_SUMMED(incline, "validation: friction on an incline", sticks, slow_loading, sudden_loading,
                   slides, kicked, cases)
