/* Published verification cases of other codes, as far as they are two-dimensional, in SI units:
 *
 * DEM01 to DEM05 of MFiX-DEM: Garg, Galvin, Li & Pannala 2012, Powder Technology 220, 122, and the MFiX
 *   verification manual, chapter 4, with the results of its DEM05 for linear springs.
 * Tests 1 to 8 of Chung & Ooi 2011, Granular Matter 13, 643: sliding regime only, since their law in stick
 *   differs. Their curves as digitised in Kratos Multiphysics (DEMApplication, basic_benchmarks).
 * The rebound of aluminium oxide spheres from glass measured by Kharaz, Gorham & Salman 2001, Powder
 * Technology 120, 281, as digitised in the MFiX manual. */
#include <gsl/gsl_errno.h>
#include <gsl/gsl_odeiv2.h>
#include <gsl/gsl_sf_gamma.h>
#include <string.h>

#include "dem/dem.h"
#include "tests/check.h"
#include "dem/law/laws.h"
#include "dem/scene/scene.h"
#include "params/units.h"
#include "tests/grains.h"
#include "validation/cases.h"
#include "validation/oblique.h"

static const double G = 9.81;

static const char MFIX[] = "MFiX verification manual 4.1-4.4: equations of motion",
                  CHUNG[] = "Chung & Ooi 2011: rigid-body sliding; Hertz",
                  DIGITS[] = "Chung & Ooi 2011, digitised";

static case_problem dem01 = {"DEM01", MFIX, "gamma dt from contact, lag and separation; w^2 dt^2"},
                    dem02 = {"DEM02", MFIX,
                             "gamma dt from contact, lag and separation; w^2 dt^2; hard: g dt"},
                    dem03 = {"DEM03", MFIX,
                             "lag of the dashpots, gamma dt/2, times the oscillations; w^2 dt^2"},
                    dem04 = {"DEM04", MFIX, "loading time of the spring and a step; overlap/r"},
                    dem05 = {"DEM05", "MFiX's results, linear springs",
                             "W dt of its steps, 1/50 of a contact time; overlap/r"},
                    kharaz = {"Kharaz", "experiment", "10 % on average, as in Kratos' benchmarks"},
                    kharaz_material = {"Kharaz-material", "experiment",
                                       "10 % on average, by E and nu of both bodies"},
                    chung_material = {"Chung-Ooi-material", CHUNG, "w^2 dt^2; overlap/r, by E and nu"},
                    chung1 = {"Chung-Ooi-1", CHUNG, "w^2 dt^2"}, chung2 = {"Chung-Ooi-2", CHUNG, "w^2 dt^2"},
                    chung3 = {"Chung-Ooi-3", "prescribed restitution",
                              "gamma dt from contact, lag and separation"},
                    chung4 = {"Chung-Ooi-4", CHUNG, "gamma dt of the normal impulse; overlap/r"},
                    chung5 = {"Chung-Ooi-5", CHUNG, "gamma dt of the normal impulse; overlap/r"},
                    chung6 = {"Chung-Ooi-6", CHUNG, "gamma dt of the normal impulse; overlap/r"},
                    chung7 = {"Chung-Ooi-7", "symmetry: no slip", "gamma dt; round-off"},
                    chung8 = {"Chung-Ooi-8", CHUNG, "gamma dt of the normal impulse; overlap/r"},
                    chung_digits = {"Chung-Ooi-curves", DIGITS, "1 % of the axis for digitisation"};

static double sphere_mass(double density, double r)
{
    return dem_mass(DEM_SPHERE, density, r);
}

/* gamma/sqrt(k/m) for a restitution: with attractive forces in closed form, without by bisection. */
static double damping_for(double restitution, bool pulls)
{
    const double l = -log(restitution), pi2 = M_PI * M_PI;
    if (pulls) return 2.0 * l / sqrt(pi2 + l * l);
    double lo = 0.0, hi = 4.0;
    for (int i = 0; i < 50 && restitution < 1.0; i++) {
        const double middle = 0.5 * (lo + hi);
        dem_collision_result c;
        CHECK_OK(dem_collision(&(dem_head_on){DEM_LINEAR, false, 1.0, middle, 1.0, 1.0}, &c));
        *(c.restitution > restitution ? &lo : &hi) = middle;
    }
    return lo;
}

/* One or two vertically aligned spheres between walls at 0 and `lid`, linear springs, each contact with its
 * own damping force eta. */
typedef struct {
    int n;
    double k, lid, r, m[2], eta[3]; /* of floor, pair, lid; a single sphere has no lid */
} vertical;

static double contact(const vertical *p, int i, double overlap, double rate)
{
    return overlap > 0.0 ? p->k * overlap + p->eta[i] * rate : 0.0;
}

static int vertical_rates(double t, const double y[], double rate[], void *data)
{
    (void)t;
    const vertical *p = data;
    const double floor = contact(p, 0, p->r - y[0], -y[2]);
    const double pair = p->n == 2 ? contact(p, 1, 2.0 * p->r - (y[1] - y[0]), y[2] - y[3]) : 0.0;
    rate[0] = y[2], rate[1] = y[3];
    rate[2] = -G + (floor - pair) / p->m[0];
    rate[3] = p->n == 2 ? -G + (pair - contact(p, 2, y[1] + p->r - p->lid, y[3])) / p->m[1] : 0.0;
    return GSL_SUCCESS;
}

static dem_sim *vertical_start(const vertical *p, const double y[2], double dt, const dem_hard *hard)
{
    dem_grain grains[2] = {{0.0, y[0], p->r, p->m[0], 0.0, 0.0}, {0.0, y[1], p->r, p->m[1], 0.0, 0.0}};
    dem_definition def = grains_bare((size_t)p->n, grains, DEM_LINEAR, (dem_material){.k_n = p->k});
    def.gravity[1] = -G, def.dt = dt, def.n_walls = (size_t)p->n;
    def.walls[0] = grains_line(0.0, 0.0, 0.0, 1.0, &def.material);
    def.walls[1] = grains_line(0.0, p->lid, 0.0, -1.0, &def.material);
    def.walls[0].material.gamma_n = p->eta[0] / p->m[0];
    def.walls[1].material.gamma_n = p->eta[2] / p->m[1];
    if (p->n == 2) def.material.gamma_n = p->eta[1] * (1.0 / p->m[0] + 1.0 / p->m[1]);
    if (hard) def.hard = *hard, def.tension = false;
    return grains_start(&def);
}

static gsl_odeiv2_driver *reference(const gsl_odeiv2_system *system, double length)
{
    gsl_odeiv2_driver *driver =
        gsl_odeiv2_driver_alloc_y_new(system, gsl_odeiv2_step_rk8pd, 1e-6, 1e-13 * length, 1e-13);
    CU_ASSERT_PTR_NOT_NULL_FATAL(driver);
    return driver;
}

/* A sphere dropped from a height of 0.5 m: position and velocity every 5 ms, and (DEM02) heights of its
 * bounces. */
static vertical dropped(double k, double e)
{
    vertical p = {.n = 1, .k = k, .r = 0.1, .m = {sphere_mass(2600.0, 0.1)}};
    p.eta[0] = damping_for(e, true) * sqrt(k * p.m[0]);
    return p;
}

static void check_dem01(double k, double e)
{
    vertical p = dropped(k, e);
    const double w = sqrt(k / p.m[0]), dt = 1e-3 / w, gamma = p.eta[0] / p.m[0], v = sqrt(2.0 * G * 0.4);
    const double touch = v / G, error = 1.5 * gamma * dt + w * w * dt * dt;
    double y[4] = {0.5}, t = 0.0;
    gsl_odeiv2_system system = {vertical_rates, NULL, 4, &p};
    gsl_odeiv2_driver *driver = reference(&system, p.r);
    scoped_sim *sim = vertical_start(&p, y, dt, NULL);
    for (int i = 1; i <= 20; i++) {
        CHECK_OK(dem_run(sim, lround(0.025 * i / dt) - dem_step(sim)));
        CU_ASSERT_EQUAL(gsl_odeiv2_driver_apply(driver, &t, dem_time(sim), y), GSL_SUCCESS);
        const dem_state s = grains_state_of_one(sim);
        const double since = fmax(0.0, t - touch + dt); /* free fall is exact to round-off */
        case_near(&dem01, "y", y[0], s.y, error * v * since + 1e-11, "k=%g e=%g t=%.4f dt=%g", k, e, t, dt);
        case_also(&dem01, "v", y[2], s.vy, (since > 0.0) * error * v + 1e-11);
    }
    gsl_odeiv2_driver_free(driver);
}

static void dem01_freely_falling(void)
{
    static const double k[] = {1e4, 2.5e4, 5e4, 1e5}, e[] = {0.6, 0.7, 0.8, 0.9, 1.0};
    for (int i = 0; i < 4 * 5; i += case_stride(3))
        if (i != 16) check_dem01(k[i % 4], e[i / 4]); /* elastic on the softest spring it falls through */
}

/* Run to the top of the next bounce; height of the centre there. */
static double next_top(dem_sim *sim)
{
    dem_state s = grains_state_of_one(sim), last;
    do {
        last = s;
        CU_ASSERT_EQUAL_FATAL(dem_run(sim, 1), RP_OK);
        s = grains_state_of_one(sim);
    } while (dem_time(sim) < 10.0 && !(last.vy > 0.0 && s.vy <= 0.0));
    return s.y + 0.5 * s.vy * s.vy / G;
}

static void check_dem02(double k, double e)
{
    enum { BOUNCES = 3 };
    const vertical p = dropped(k, e);
    const double w = sqrt(k / p.m[0]), dt = 2e-3 / w, gamma = p.eta[0] / p.m[0];
    const double error = 1.5 * gamma * dt + w * w * dt * dt;
    vertical reference_of = p;
    gsl_odeiv2_system system = {vertical_rates, NULL, 4, &reference_of};
    gsl_odeiv2_driver *driver = reference(&system, p.r);
    double y[4] = {0.5}, t = 0.0, height = 0.4;
    scoped_sim *soft = vertical_start(&p, y, dt, NULL);
    const dem_hard hard_law = {true, e, 0.0};
    scoped_sim *hard = vertical_start(&p, y, dt, &hard_law);
    for (int bounce = 1; bounce <= BOUNCES; bounce++) {
        const double top = next_top(soft);
        /* the reference at the same time is near its own top: the difference is a parabola */
        CU_ASSERT_EQUAL(gsl_odeiv2_driver_apply(driver, &t, dem_time(soft), y), GSL_SUCCESS);
        const double exact = y[0] + 0.5 * y[2] * y[2] / G;
        case_near(&dem02, "height", exact, top, 2.0 * bounce * error * height / e + 1e-11,
                  "k=%g e=%g bounce=%d dt=%g", k, e, bounce, dt);
        height *= e * e;
        /* a hard collision at its exact time, with speeds of the half step: g dt relative to sqrt(2 g h) */
        case_near(&dem02, "height", height + p.r, next_top(hard), 2.0 * bounce * sqrt(2.0 * G * 0.4) * dt,
                  "hard e=%g bounce=%d dt=%g", e, bounce, dt);
    }
    gsl_odeiv2_driver_free(driver);
}

static void dem02_bouncing(void)
{
    static const double k[] = {5e4, 5e5, 5e6}, e[] = {0.5, 0.6, 0.7, 0.8, 0.9, 1.0};
    for (int i = 0; i < 3 * 6; i += case_stride(7)) check_dem02(k[i % 3], e[i / 3]);
}

/* Two spheres compressed by walls 3.6 r apart, from positions without force balance. */
static void dem03_stacked(void)
{
    for (int i = 0; i < 6; i += case_stride(2)) {
        const double e = 1.0 - 0.1 * i, r = 0.5e-3, lid = 3.6 * r, damping = damping_for(e, true);
        vertical p = {2, 1e3, lid, r, {sphere_mass(2e4, r), sphere_mass(1e4, r)}, {0.0}};
        const double m_eff = p.m[0] * p.m[1] / (p.m[0] + p.m[1]);
        p.eta[0] = damping * sqrt(p.k * p.m[0]), p.eta[1] = damping * sqrt(p.k * m_eff);
        p.eta[2] = damping * sqrt(p.k * p.m[1]);
        /* the fastest mode: the upper sphere on two springs, at most */
        const double w = sqrt(3.0 * p.k / p.m[1]), dt = 1e-3 / w, h = 0.5 * damping * sqrt(p.k / m_eff) * dt;
        double y[4] = {0.25 * lid, 0.75 * lid}, t = 0.0;
        gsl_odeiv2_system system = {vertical_rates, NULL, 4, &p};
        gsl_odeiv2_driver *driver = reference(&system, r);
        scoped_sim *sim = vertical_start(&p, y, dt, NULL);
        dem_state s[2];
        for (int k = 1; k <= 10; k++) {
            CHECK_OK(dem_run(sim, lround(1e-4 * k / dt) - dem_step(sim)));
            CU_ASSERT_EQUAL(gsl_odeiv2_driver_apply(driver, &t, dem_time(sim), y), GSL_SUCCESS);
            CHECK_OK(dem_states(sim, s));
            /* they oscillate by a fifteenth of r; the phase error is (h + (w dt)^2/24) w t */
            const double bound = (h + pow(w * dt, 2.0)) * (1.0 + w * t) * r / 15.0;
            for (int j = 0; j < 2; j++)
                case_near(&dem03, j ? "y2" : "y1", y[j], s[j].y, bound, "e=%g t=%.6f dt=%g", e, t, dt);
        }
        gsl_odeiv2_driver_free(driver);
    }
}

/* A sphere placed on a rough floor with speed u: slips until 2 u/(7 mu g), then rolls at 5/7 u. */
static void dem04_slipping(void)
{
    for (int i = 0; i < 9; i += case_stride(2)) {
        const double mu = 0.2 + 0.1 * i, u = 0.05, r = 0.5e-3, m = sphere_mass(1e4, r), k = 1e4,
                     sinks = m * G / k;
        dem_grain grain = {0.0, r - sinks, r, m, u, 0.0};
        dem_definition def = dem_definition_default();
        def.gravity[1] = -G, def.normal = DEM_LINEAR, def.rotation = true;
        def.material = (dem_material){.k_n = k, .k_s = k, .mu = mu};
        def.dt = 1e-6;
        grains_on_floor(&def, 1, &grain);
        scoped_sim *sim = grains_start(&def);
        dem_state s = {.vx = u};
        double slip = u, last = u;
        while (dem_time(sim) < u / (mu * G) && slip > 0.0) {
            last = slip;
            CU_ASSERT_EQUAL_FATAL(dem_run(sim, 1), RP_OK);
            s = grains_state_of_one(sim);
            slip = s.vx + r * s.omega;
        }
        const double late = mu * m * G / (k * u) + def.dt, exact = 2.0 * u / (7.0 * mu * G);
        case_near(&dem04, "time", exact, dem_time(sim) - def.dt * slip / (slip - last),
                  late + 2.0 * sinks / r * exact, "mu=%g u=%g dt=%g", mu, u, def.dt);
        case_also(&dem04, "u", 5.0 / 7.0 * u, s.vx, mu * G * late + 2.0 * sinks / r * u);
        case_also(&dem04, "omega r", 5.0 / 7.0 * u, -s.omega * r, 2.5 * mu * G * late + 2.0 * sinks / r * u);
    }
}

/* A sphere hits a wall, or another sphere head on: approach speed v_n, tangential speed u of the centre, and
 * spins; the same quantities after impact. */
typedef struct {
    double r, m, r_other, m_other; /* m_other = INFINITY: a wall */
    double k, k_s, mu, gamma;
    bool hertz, pulls;
    int tangential; /* slip_roll slides from the first step, since it has no spring */
    double v_n, u, omega, omega_other;
    double out_n, out_u, out_omega, depth, force, time;
} strike;

static double strike_mass(const strike *p)
{
    return p->m / (1.0 + p->m / p->m_other);
}

static double strike_rate(const strike *p)
{
    const double m = strike_mass(p), deepest = pow(1.25 * m * p->v_n * p->v_n / p->k, 0.4);
    return sqrt((p->hertz ? 1.5 * p->k * sqrt(deepest) : p->k) / m);
}

/* Step by step until they part. */
static void follow(strike *p, dem_sim *sim, double dt)
{
    const bool wall = isinf(p->m_other);
    dem_state s[2] = {0};
    double overlap;
    p->depth = p->force = 0.0;
    do {
        CU_ASSERT_FATAL(dem_run(sim, 1) == RP_OK && dem_time(sim) * strike_rate(p) < 100.0);
        dem_states(sim, s);
        overlap = wall ? p->r - s[0].y : p->r + p->r_other - hypot(s[0].x - s[1].x, s[0].y - s[1].y);
        p->depth = fmax(p->depth, overlap), p->force = fmax(p->force, s[0].fy);
    } while (s[0].contacts > 0 || dem_time(sim) < 2.0 * dt);
    p->out_n = s[0].vy - s[1].vy, p->out_u = s[0].vx, p->out_omega = s[0].omega;
    p->time = dem_time(sim) + overlap / p->out_n - 0.381 * dt;
}

static void run_strike(strike *p, double dt)
{
    const bool wall = isinf(p->m_other);
    const double gap = 0.381 * p->v_n * dt;
    dem_grain grains[2] = {{0.0, p->r + gap, p->r, p->m, p->u, -p->v_n, 0.0, p->omega},
                           {0.0, -p->r_other, p->r_other, p->m_other, 0.0, 0.0, 0.0, p->omega_other}};
    dem_definition def =
        grains_bare(2 - wall, grains, p->hertz ? DEM_HERTZ : DEM_LINEAR,
                    (dem_material){.k_n = p->k, .gamma_n = p->gamma, .k_s = p->k_s, .mu = p->mu});
    def.tension = p->pulls, def.rotation = true, def.tangential = p->tangential;
    if (p->tangential == DEM_SLIP_ROLL) def.material.gamma_s = 100.0 * strike_rate(p);
    def.dt = dt, def.n_walls = wall;
    def.walls[0] = grains_line(0.0, 0.0, 0.0, 1.0, &def.material);
    scoped_sim *sim = grains_start(&def);
    follow(p, sim, dt);
}

/* DEM05: aluminium oxide on glass at 3.9 m/s, linear springs. */
static const double SPEED = 3.9, OXIDE_R = 2.5e-3, MU = 0.092;

static strike oxide(double degrees)
{
    const double angle = degrees * M_PI / 180.0;
    return (strike){.r = OXIDE_R,
                    .m = sphere_mass(4000.0, OXIDE_R),
                    .m_other = INFINITY,
                    .k = 1.72e7,
                    .k_s = 1.48e7,
                    .mu = MU,
                    .pulls = true,
                    .tangential = DEM_SPRING,
                    .v_n = SPEED * cos(angle),
                    .u = SPEED * sin(angle)};
}

/* Incident angle; after impact, angle of the centre's path, tan = u/v_n (degrees), and spin: MFiX manual,
 * DEM05, sphere on wall. */
static const double MFIX_DEM05[][3] = {
    {2.5, 2.1141, 26.0646},    {5.0, 3.9890, 68.5245},    {7.5, 5.4655, 138.2890},
    {10.0, 6.5953, 231.9435},  {12.5, 7.7794, 322.1778},  {15.0, 9.0906, 404.5505},
    {17.5, 10.5615, 476.8114}, {20.0, 12.2112, 538.0793}, {22.5, 14.0679, 586.8645},
    {25.0, 16.1724, 620.3752}, {27.5, 18.6236, 632.2736}, {30.0, 21.4755, 618.8437},
    {35.0, 27.3031, 585.5217}, {40.0, 33.2292, 547.6964}, {45.0, 39.2091, 505.7470},
    {50.0, 45.2158, 459.8864}, {55.0, 51.2073, 410.4812}, {60.0, 57.1372, 357.9511},
    {65.0, 62.9718, 302.6790}};

static void dem05_oblique_collision(void)
{
    for (size_t i = 0; i < sizeof MFIX_DEM05 / sizeof *MFIX_DEM05; i++) {
        const double *row = MFIX_DEM05[i];
        strike p = oxide(row[0]);
        const double w = strike_rate(&p), a = 3.5, kappa = p.k_s / p.k, places = 1.0 / w * p.v_n / p.r;
        run_strike(&p, 1e-3 / w);
        /* both codes count the first step of the spring in full; their step is 1/50 of a contact time */
        const double their_dt = M_PI / w / 50.0, first = sqrt(a * kappa) * w * their_dt;
        const bool slides =
            row[0] >= 30.0; /* sliding throughout: no spring, the normal impulse is of second order */
        const double bound = (slides ? pow(w * their_dt, 2.0) : first) + 3.0 * places;
        const double slip = bound * (p.u + p.v_n * MU) / a; /* of the centre's speed */
        case_near(&dem05, "rebound angle", row[1], atan2(p.out_u, p.out_n) * 180.0 / M_PI,
                  slip / p.out_n * 180.0 / M_PI + 5e-5, "angle=%g", row[0]);
        case_also(&dem05, "spin", row[2], -p.out_omega, 2.5 * slip / p.r + 5e-5);
        /* and the simulator against the exact impact of a rigid body */
        const double exact = oblique_left(a, kappa, MU, p.v_n, p.u);
        case_also(&dem05, "slip, exact", exact, p.out_u + p.r * p.out_omega,
                  sqrt(a * kappa) * 1e-3 * p.u + 3.0 * places * (p.u + p.v_n));
    }
}

/* Kharaz, Gorham & Salman: angle and value. */
static const double KHARAZ_ANGLE[][2] = {{2.2945, 1.7630},   {4.2922, 2.9577},   {9.9429, 6.6917},
                                         {20.5594, 12.3645}, {30.3767, 21.7809}, {39.6233, 32.5455},
                                         {49.7831, 45.1051}, {60.0571, 57.3652}},
                    KHARAZ_SPIN[][2] = {{6.0025, 135.5703},  {10.9840, 264.5493}, {21.1931, 577.0096},
                                        {31.0947, 612.6481}, {39.0283, 595.4843}, {50.2214, 452.9444},
                                        {60.2460, 381.3185}},
                    KHARAZ_E_T[][2] = {{2.0275, 0.7938},  {3.9282, 0.7450},  {9.6304, 0.6728},
                                       {20.0845, 0.5964}, {30.2218, 0.6883}, {39.3031, 0.7719},
                                       {49.5459, 0.8469}, {59.8416, 0.9019}};

static const struct {
    const char *quantity;
    const double (*data)[2];
    size_t n;
} KHARAZ[] = {{"rebound angle", KHARAZ_ANGLE, sizeof KHARAZ_ANGLE / sizeof *KHARAZ_ANGLE},
              {"spin", KHARAZ_SPIN, sizeof KHARAZ_SPIN / sizeof *KHARAZ_SPIN},
              {"tangential restitution", KHARAZ_E_T, sizeof KHARAZ_E_T / sizeof *KHARAZ_E_T}};

/* A sphere on a wall by a scene's `material`, in SI: E, nu, those of the wall (E = INFINITY: rigid),
 * restitution. */
static void run_material(strike *p, double density, double E, double nu, double wall_E, double wall_nu,
                         double e)
{
    char text[1024], wall[64] = "";
    scoped_scene scene;
    scoped_sim *sim = NULL;
    if (isfinite(wall_E))
        snprintf(wall, sizeof wall, " E = %.17e; nu = %.17g;", wall_E, wall_nu);
    else
        snprintf(wall, sizeof wall, " E = 1.0e300; nu = 0.0;");
    double k_n, k_s;
    dem_elastic_contact((double[]){E, fmin(wall_E, 1e300)}, (double[]){nu, wall_nu}, &k_n, &k_s);
    p->m_other = INFINITY, p->m = sphere_mass(density, p->r), p->hertz = true, p->k = k_n * sqrt(p->r);
    const double dt = 1e-3 / strike_rate(p);
    snprintf(text, sizeof text,
             "units = \"si\"; gravity = [0.0, 0.0]; rotation = true; density = %.17g; dt = %.17g;\n"
             "material = { E = %.17e; nu = %.17g; restitution = %g; mu = %.17g; };\n"
             "walls = ( { point = [0.0, 0.0]; direction = [0.0, 1.0];%s } );\n"
             "particles = ( { x = 0.0; y = %.17g; r = %.17g; vx = %.17g; vy = %.17g; omega = %.17g; } );\n",
             density, dt, E, nu, e, p->mu, wall, p->r + 0.381 * p->v_n * dt, p->r, p->u, -p->v_n, p->omega);
    CHECK_OK(grains_read(text, NULL, &scene));
    CHECK_OK(dem_scene_start(&scene, &sim));
    follow(p, sim, dt);
    rp_units_set(RP_CGS);
}

/* The experiment's restitution is 0.98. Linear springs, and aluminium oxide on glass by E and nu. */
static void by_springs(strike *p)
{
    p->gamma = damping_for(0.98, true) * strike_rate(p);
    run_strike(p, 1e-3 / strike_rate(p));
}

static void on_glass(strike *p)
{
    run_material(p, 4000.0, 3.8e11, 0.23, 7.0e10, 0.25, 0.98);
}

/* Mean of |simulated - measured| over the mean of |measured|. */
static void check_rebounds(case_problem *problem, void (*run)(strike *p))
{
    for (int q = 0; q < 3; q++) {
        double error = 0.0, size = 0.0;
        for (size_t i = 0; i < KHARAZ[q].n; i++) {
            strike p = oxide(KHARAZ[q].data[i][0]);
            run(&p);
            const double observed[] = {atan2(p.out_u, p.out_n) * 180.0 / M_PI, -p.out_omega, p.out_u / p.u};
            error += fabs(observed[q] - KHARAZ[q].data[i][1]);
            size += fabs(KHARAZ[q].data[i][1]);
        }
        case_near(problem, KHARAZ[q].quantity, 0.0, error / size, 0.1, "mean error over %zu angles, relative",
                  KHARAZ[q].n);
    }
}

static void kharaz_rebounds(void)
{
    check_rebounds(&kharaz, by_springs);
}

/* An impact that has been run is Hertz' by its stiffness k. */
static void hertz_is(case_problem *problem, const char *material, const strike *p)
{
    const double m = strike_mass(p), deepest = pow(1.25 * m * p->v_n * p->v_n / p->k, 0.4), bound = 1e-6;
    const double time = 0.8 * sqrt(M_PI) * gsl_sf_gamma(0.4) / gsl_sf_gamma(0.9) * deepest / p->v_n;
    const double expected[] = {deepest, p->k * pow(deepest, 1.5), time, p->v_n},
                 observed[] = {p->depth, p->force, p->time, p->out_n};
    static const char *const names[] = {"overlap", "force", "time", "speed"};
    for (int q = 0; q < 4; q++)
        case_near(problem, names[q], expected[q], observed[q], bound * expected[q], "%s v=%g", material,
                  p->v_n);
}

/* Tests 1 and 2: elastic, Hertz; k = 4/3 E* sqrt(R). */
static void check_hertz(case_problem *problem, const char *material, strike p, double young, double poisson)
{
    const bool wall = isinf(p.m_other);
    const double modulus = young / (1.0 - poisson * poisson) / (wall ? 1.0 : 2.0);
    p.hertz = p.pulls = true;
    p.k = 4.0 / 3.0 * modulus * sqrt(wall ? p.r : 0.5 * p.r);
    run_strike(&p, 1e-3 / strike_rate(&p));
    hertz_is(problem, material, &p);
}

static void chung_ooi_1_and_2_elastic(void)
{
    const double r = 0.01, plane = 0.1;
    strike glass = {.r = r, .m = sphere_mass(2800.0, r), .r_other = r, .v_n = 20.0}, limestone = glass;
    glass.m_other = glass.m;
    limestone.m = limestone.m_other = sphere_mass(2500.0, r);
    check_hertz(&chung1, "glass", glass, 4.8e10, 0.20);
    check_hertz(&chung1, "limestone", limestone, 2.0e10, 0.25);
    strike alloy = {.r = plane, .m = sphere_mass(2699.0, plane), .m_other = INFINITY, .v_n = 0.2},
           magnesium = alloy;
    magnesium.m = sphere_mass(1800.0, plane);
    check_hertz(&chung2, "aluminium alloy", alloy, 7.0e10, 0.30);
    check_hertz(&chung2, "magnesium alloy", magnesium, 4.0e10, 0.35);
}

/* Test 3: the prescribed restitution, with and without attractive damped forces. */
static void chung_ooi_3_restitution(void)
{
    for (int i = 0; i < 2 * 2 * 5; i++) {
        const double e = 0.2 * (1 + i / 4);
        strike p = oxide(0.0);
        p.pulls = i % 2, p.tangential = DEM_NONE, p.mu = 0.0;
        if (i / 2 % 2) p.m = sphere_mass(7000.0, OXIDE_R); /* cast iron */
        p.gamma = damping_for(e, p.pulls) * strike_rate(&p);
        const double dt = 1e-3 / strike_rate(&p);
        run_strike(&p, dt);
        case_near(&chung3, "restitution", e, p.out_n / p.v_n, 1.5 * p.gamma * dt + 1e-6, "density=%s, %s",
                  i / 2 % 2 ? "7000" : "4000", p.pulls ? "pulls" : "pushes");
    }
}

/* An impact that slides throughout: the tangential impulse is mu (1 + e) of the normal one. Slip afterwards,
 * and change of the spin, with their bound relative to mu (1 + e) v_n. */
static double slide(strike *p, double e)
{
    const double w = strike_rate(p), dt = 1e-3 / w;
    p->pulls = false; /* friction counts repulsive normal forces only */
    p->gamma = damping_for(e, false) * w;
    run_strike(p, dt);
    return 1.5 * p->gamma * dt + 1e-6 + 3.0 * p->v_n / w / p->r;
}

/* Test 4: one speed, sliding angles (tan > 7/2 mu (1 + e), plus the contribution of the spring); curves of
 * tangential restitution and spin for aluminium oxide, as digitised. */
static void chung_ooi_4_oblique(void)
{
    static const double curves[][4] = {
        /* angle and value of each curve */
        {35.0297, 0.7372323, 34.9310, -582.2630}, {40.0198, 0.7808896, 39.9803, -544.8012},
        {50.0000, 0.8451400, 50.0000, -457.0336}, {59.9802, 0.8929160, 60.0197, -357.4924},
        {69.9604, 0.9316310, 69.9606, -246.1774}, {80.0198, 0.9662273, 80.0592, -126.2997},
        {85.0099, 0.9827018, 85.0296, -63.1498}};
    const double e = 0.98;
    for (size_t i = 0; i < sizeof curves / sizeof *curves; i++) {
        strike p = oxide(curves[i][0]), q = oxide(curves[i][2]);
        const double bound = slide(&p, e), impulse = MU * (1.0 + e) * p.v_n;
        case_near(&chung4, "e_t", 1.0 - impulse / p.u, p.out_u / p.u, bound * impulse / p.u, "angle=%g",
                  curves[i][0]);
        case_also(&chung4, "spin", -2.5 * impulse / p.r, p.out_omega, bound * 2.5 * impulse / p.r);
        case_near(&chung_digits, "e_t", curves[i][1], p.out_u / p.u, 0.006, "test 4, angle=%g", curves[i][0]);
        slide(&q, e);
        case_near(&chung_digits, "spin", curves[i][3], q.out_omega, 7.5, "test 4, angle=%g", curves[i][2]);
    }
}

/* Test 5: a small sphere of steel, elastic; (u + r omega)/(mu v_n) after against before, with finite elements
 * from the literature. */
static void chung_ooi_5_small_sphere(void)
{
    static const double elements[][2] = {{9.117824773413897, 2.1466666666666665},
                                         {12.356495468277945, 5.426666666666667}};
    const double r = 1e-5, mu = 0.3, v = 5.0;
    for (int i = 0; i < 8; i++) {
        const double ratio = i < 2 ? elements[i][0] : 9.0 + i;
        strike p = {.r = r,
                    .m = sphere_mass(7850.0, r),
                    .m_other = INFINITY,
                    .k = 1e9 * r,
                    .k_s = 8e8 * r,
                    .tangential = DEM_SPRING,
                    .mu = mu,
                    .v_n = v,
                    .u = ratio * mu * v};
        /* stiff enough for small overlaps */
        p.k *= 1e4, p.k_s *= 1e4;
        const double bound = slide(&p, 1.0), slip = (p.out_u + r * p.out_omega) / (mu * v);
        case_near(&chung5, "slip", ratio - 7.0, slip, bound * 7.0, "slip/(mu v_n)=%g", ratio);
        case_also(&chung5, "spin", -5.0, r * p.out_omega / (mu * v), bound * 5.0);
        if (i < 2)
            case_near(&chung_digits, "slip", elements[i][1], slip, 0.1,
                      "test 5, finite elements, slip/(mu v_n)=%g", ratio);
    }
}

/* Tests 6 and 8: a spinning sphere on a plane, on one of five times its radius, and that a thousand times as
 * dense: ratio of slip after to slip before impact, -1 + 7/2 mu (1 + e) v_n/slip. Test 7: two equal spheres
 * whose spins give no slip. */
static void chung_ooi_6_to_8_spinning(void)
{
    static const double curve[][2] = {{0.17621145374449387, -0.8200274348422496},
                                      {0.35242290748898686, -0.6334705075445815},
                                      {0.5506607929515415, -0.4447187928669407},
                                      {0.7709251101321586, -0.24279835390946491}};
    const double r = 0.1, mu = 0.4, e = 0.5, v = 0.2;
    for (int i = 0; i < 3 * 4; i++) {
        const double number = curve[i % 4][0]; /* 7/2 mu (1 + e) v_n over the slip */
        const double slip = 3.5 * mu * (1.0 + e) * v / number;
        strike p = {.r = r,
                    .m = sphere_mass(2700.0, r),
                    .m_other = INFINITY,
                    .k = 1e9,
                    .tangential = DEM_SLIP_ROLL,
                    .mu = mu,
                    .v_n = v,
                    .omega = slip / r};
        if (i >= 4) p.r_other = 5.0 * r, p.m_other = sphere_mass(i >= 8 ? 2.7e6 : 2700.0, p.r_other);
        case_problem *problem = i < 4 ? &chung6 : &chung8;
        const char *const on = i < 4 ? "plane" : i < 8 ? "sphere 5 r" : "sphere 5 r, dense";
        const double bound = slide(&p, e), m = strike_mass(&p);
        case_near(problem, "speed along", -mu * (1.0 + e) * v * m / p.m, p.out_u, bound * mu * (1.0 + e) * v,
                  "%s, number=%g", on, number);
        case_also(problem, "spin", p.omega - 2.5 * mu * (1.0 + e) * v * m / p.m / r, p.out_omega,
                  bound * 2.5 * mu * (1.0 + e) * v / r);
        if (i < 4)
            case_near(&chung_digits, "e_t", curve[i][1], -(p.out_u + r * p.out_omega) / slip, 0.016,
                      "test 6, number=%g", number);
    }
    for (int i = 0; i < 5; i++) {
        const double omega = 0.2 * pow(3.0, i);
        strike p = {.r = r,
                    .m = sphere_mass(2700.0, r),
                    .r_other = r,
                    .m_other = sphere_mass(2700.0, r),
                    .k = 1e9,
                    .tangential = DEM_SLIP_ROLL,
                    .mu = mu,
                    .v_n = 2.0 * v,
                    .omega = omega,
                    .omega_other = -omega};
        const double bound = slide(&p, e);
        case_near(&chung7, "spin", omega, p.out_omega, 1e-12 * omega, "omega=%g", omega);
        case_also(&chung7, "speed along", 0.0, p.out_u, 1e-12 * v);
        case_also(&chung7, "restitution", e, p.out_n / p.v_n, bound);
    }
}

/* Tests 2 and 4 by E and nu of both bodies: Hertz' impact; sliding impacts; and at all angles the measured
 * rebounds of aluminium oxide on glass. */
static void by_material(void)
{
    static const struct {
        double density, E, nu;
    } alloys[] = {{2699.0, 7.0e10, 0.30}, {1800.0, 4.0e10, 0.35}};
    for (int i = 0; i < 2; i++) {
        strike p = {.r = 0.1, .v_n = 0.2, .mu = 0.4};
        run_material(&p, alloys[i].density, alloys[i].E, alloys[i].nu, INFINITY, 0.0, 1.0);
        hertz_is(&chung_material, i ? "magnesium alloy" : "aluminium alloy", &p);
    }
    for (int degrees = 40; degrees <= 80; degrees += 10) {
        strike p = oxide(degrees);
        run_material(&p, 4000.0, 3.8e11, 0.23, INFINITY, 0.0, 0.98);
        const double impulse = MU * (p.v_n + p.out_n);
        case_near(&chung_material, "e_t", 1.0 - impulse / p.u, p.out_u / p.u, 0.01 * impulse / p.u,
                  "angle=%d", degrees);
        case_also(&chung_material, "spin", -2.5 * impulse / p.r, p.out_omega, 0.025 * impulse / p.r);
    }
    check_rebounds(&kharaz_material, on_glass);
}

static void cases(void)
{
    case_problem *const problems[] = {
        &dem01,  &dem02,  &dem03,  &dem04,  &dem05,  &kharaz,       &chung1,         &chung2,         &chung3,
        &chung4, &chung5, &chung6, &chung7, &chung8, &chung_digits, &chung_material, &kharaz_material};
    case_write("published", problems, sizeof problems / sizeof *problems);
}

CHECK_SUITE_SUMMED(published, "validation: published cases", dem01_freely_falling, dem02_bouncing,
                   dem03_stacked, dem04_slipping, dem05_oblique_collision, kharaz_rebounds,
                   chung_ooi_1_and_2_elastic, chung_ooi_3_restitution, chung_ooi_4_oblique,
                   chung_ooi_5_small_sphere, chung_ooi_6_to_8_spinning, by_material, cases)
