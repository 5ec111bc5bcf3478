/* Published verification cases of other codes, as far as they are two-dimensional, in SI units:
 *
 * DEM01 to DEM05 of MFiX-DEM: Garg, Galvin, Li & Pannala 2012, Powder Technology 220, 122, and the MFiX
 *   verification manual, chapter 4, with the results of its DEM05 for linear springs.
 * Tests 1 to 8 of Chung & Ooi 2011, Granular Matter 13, 643, by E and nu of scenes: sliding regime only,
 * since their law in stick differs. Their curves as digitised in Kratos Multiphysics (DEMApplication,
 *   basic_benchmarks).
 * The rebound of aluminium oxide spheres from glass measured by Kharaz, Gorham & Salman 2001, Powder
 * Technology 120, 281, as digitised in the MFiX manual. */
#include <gsl/gsl_errno.h>
#include <gsl/gsl_odeiv2.h>
#include <gsl/gsl_sf_gamma.h>

#include "params/units.h"
#include "tests/grains.h"
#include "validation/cases.h"
#include "validation/oblique.h"

static const double G = 9.81;

static const char MFIX[] = "MFiX verification manual 4.1-4.4: equations of motion",
                  CHUNG[] = "Chung & Ooi 2011: Hertz; rigid-body sliding",
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
                    chung = {"Chung-Ooi", CHUNG, "w^2 dt^2 and gamma dt; lever of friction: overlap/r"},
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
    dem_definition def = dem_definition_default();
    def.gravity[1] = -G, def.normal = DEM_LINEAR, def.tangential = DEM_NONE;
    def.material = (dem_material){.k_n = p->k};
    def.dt = dt, def.grains = grains, def.n_grains = (size_t)p->n;
    def.n_walls = (size_t)p->n;
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

/* A sphere dropped from a height of 0.5 m: position and velocity every 5 ms, (DEM02) heights of bounces. */
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
            grains_run(sim, lround(1e-4 * k / dt) - dem_step(sim), s);
            CU_ASSERT_EQUAL(gsl_odeiv2_driver_apply(driver, &t, dem_time(sim), y), GSL_SUCCESS);
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
 * spins; what it is made of; the same quantities after impact, the deepest overlap and the largest force. */
typedef struct {
    double density, r, r_other, m_other; /* m_other = 0: a wall */
    double E, nu, wall_E, wall_nu, e;    /* wall_E = 0: rigid */
    double k, mu;                        /* stiffness; of Hertz' force by E and nu, once it has been run */
    double v_n, u, omega, omega_other;
    double out_n, out_u, out_omega, depth, force, time;
} strike;

static double strike_mass(const strike *p)
{
    const double m = sphere_mass(p->density, p->r);
    return p->m_other > 0.0 ? m * p->m_other / (m + p->m_other) : m;
}

/* Largest overlap of a Hertzian impact. */
static double hertz_depth(const strike *p)
{
    return pow(1.25 * strike_mass(p) * p->v_n * p->v_n / p->k, 0.4);
}

/* Until the spheres have parted. */
static void run_impact(dem_sim *sim, strike *p, double rate, double gap_time)
{
    dem_state s[2] = {0};
    double overlap;
    p->depth = p->force = 0.0;
    do {
        CU_ASSERT_FATAL(dem_run(sim, 1) == RP_OK && dem_time(sim) * rate < 100.0);
        dem_states(sim, s);
        overlap =
            p->m_other > 0.0 ? p->r + p->r_other - hypot(s[0].x - s[1].x, s[0].y - s[1].y) : p->r - s[0].y;
        p->depth = fmax(p->depth, overlap), p->force = fmax(p->force, s[0].fy);
    } while (s[0].contacts > 0 || dem_time(sim) < 2.0 * gap_time);
    p->out_n = s[0].vy - s[1].vy, p->out_u = s[0].vx, p->out_omega = s[0].omega;
    p->time = dem_time(sim) + overlap / p->out_n - gap_time;
}

/* Linear springs against a wall: k_s and restitution; steps of 1e-3 over the rate. */
static double run_springs(strike *p, double k_s, double e)
{
    const double m = strike_mass(p), rate = sqrt(p->k / m), dt = 1e-3 / rate, gap = 0.381 * p->v_n * dt;
    const dem_grain grain = {0.0, p->r + gap, p->r, m, p->u, -p->v_n, 0.0, p->omega};
    dem_definition def = dem_definition_default();
    def.gravity[1] = 0.0, def.normal = DEM_LINEAR, def.tangential = DEM_SPRING, def.rotation = true;
    def.material =
        (dem_material){.k_n = p->k, .gamma_n = damping_for(e, true) * rate, .k_s = k_s, .mu = p->mu};
    def.dt = dt;
    grains_on_floor(&def, 1, &grain);
    scoped_sim *sim = grains_start(&def);
    run_impact(sim, p, rate, 0.381 * dt);
    return rate;
}

/* By a scene's `material`, in SI: of both spheres, or of the sphere and the wall. */
static void run_material(strike *p)
{
    char other[256];
    double k_n, k_s;
    const double E[2] = {p->E, p->m_other > 0.0 ? p->E : p->wall_E > 0.0 ? p->wall_E : 1e300};
    const double nu[2] = {p->nu, p->m_other > 0.0 ? p->nu : p->wall_nu};
    dem_elastic_contact(E, nu, &k_n, &k_s);
    p->k = k_n * sqrt(p->m_other > 0.0 ? p->r * p->r_other / (p->r + p->r_other) : p->r);
    /* the contact's frequency at its largest overlap */
    const double rate = sqrt(1.5 * p->k * sqrt(hertz_depth(p)) / strike_mass(p)), dt = 1e-3 / rate;
    if (p->m_other > 0.0)
        snprintf(other, sizeof other, "{ x = 0.0; y = %.17g; r = %.17g; m = %.17g; omega = %.17g; } );",
                 -p->r_other, p->r_other, p->m_other, p->omega_other);
    else
        snprintf(other, sizeof other,
                 ");\nwalls = ( { point = [0.0, 0.0]; direction = [0.0, 1.0]; E = %.17e; nu = %.17g; } );",
                 E[1], nu[1]);
    scoped_sim *sim = grains_after_text(
        0,
        "units = \"si\"; gravity = [0.0, 0.0]; rotation = true; density = %.17g; dt = %.17g;\n"
        "material = { E = %.17e; nu = %.17g; restitution = %.17g; mu = %.17g; };\n"
        "particles = ( { x = 0.0; y = %.17g; r = %.17g; vx = %.17g; vy = %.17g; omega = %.17g; }%s %s\n",
        p->density, dt, p->E, p->nu, p->e, p->mu, p->r + 0.381 * p->v_n * dt, p->r, p->u, -p->v_n, p->omega,
        p->m_other > 0.0 ? "," : "", other);
    run_impact(sim, p, rate, 0.381 * dt);
}

/* DEM05: aluminium oxide on glass at 3.9 m/s, linear springs. Chung & Ooi's oxide is the same by E and nu. */
static const double SPEED = 3.9, OXIDE_R = 2.5e-3, MU = 0.092, OXIDE_K = 1.72e7, OXIDE_K_S = 1.48e7;

static strike oxide(double degrees)
{
    const double angle = degrees * M_PI / 180.0;
    strike p = {.density = 4000.0, .r = OXIDE_R, .E = 3.8e11, .nu = 0.23, .e = 0.98, .k = OXIDE_K, .mu = MU};
    p.v_n = SPEED * cos(angle), p.u = SPEED * sin(angle);
    return p;
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
        const double w = run_springs(&p, OXIDE_K_S, 1.0), a = 3.5, kappa = OXIDE_K_S / OXIDE_K,
                     places = 1.0 / w * p.v_n / p.r;
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

static double rebound_angle(const strike *p)
{
    return atan2(p->out_u, p->out_n) * 180.0 / M_PI;
}

static double rebound_spin(const strike *p)
{
    return -p->out_omega;
}

static double rebound_e_t(const strike *p)
{
    return p->out_u / p->u;
}

/* The experiment's restitution is 0.98. Linear springs, and aluminium oxide on glass by E and nu. */
static void by_springs(strike *p)
{
    run_springs(p, OXIDE_K_S, p->e);
}

static void on_glass(strike *p)
{
    p->wall_E = 7.0e10, p->wall_nu = 0.25;
    run_material(p);
}

/* Mean of |simulated - measured| over the mean of |measured|, of each quantity. */
static void check_rebounds(case_problem *problem, void (*run)(strike *p))
{
#define MEASURED(data) data, sizeof data / sizeof *data
    static const struct {
        const char *quantity;
        const double (*data)[2];
        size_t n;
        double (*observe)(const strike *p);
    } list[] = {{"rebound angle", MEASURED(KHARAZ_ANGLE), rebound_angle},
                {"spin", MEASURED(KHARAZ_SPIN), rebound_spin},
                {"tangential restitution", MEASURED(KHARAZ_E_T), rebound_e_t}};
    for (size_t k = 0; k < sizeof list / sizeof *list; k++) {
        double error = 0.0, size = 0.0;
        for (size_t i = 0; i < list[k].n; i++) {
            strike p = oxide(list[k].data[i][0]);
            run(&p);
            error += fabs(list[k].observe(&p) - list[k].data[i][1]);
            size += fabs(list[k].data[i][1]);
        }
        case_near(problem, list[k].quantity, 0.0, error / size, 0.1, "mean error over %zu angles, relative",
                  list[k].n);
    }
}

static void kharaz_rebounds(void)
{
    check_rebounds(&kharaz, by_springs);
    check_rebounds(&kharaz_material, on_glass);
}

/* Tests 1 and 2: elastic, Hertz; on a sphere alike, on a rigid plane. */
static void chung_ooi_1_and_2_elastic(void)
{
    static const struct {
        const char *name;
        strike of;
        bool pair;
    } list[] = {
        {"1, glass", {.density = 2800.0, .r = 0.01, .E = 4.8e10, .nu = 0.20, .v_n = 20.0}, true},
        {"1, limestone", {.density = 2500.0, .r = 0.01, .E = 2.0e10, .nu = 0.25, .v_n = 20.0}, true},
        {"2, aluminium alloy", {.density = 2699.0, .r = 0.1, .E = 7.0e10, .nu = 0.30, .v_n = 0.2}, false},
        {"2, magnesium alloy", {.density = 1800.0, .r = 0.1, .E = 4.0e10, .nu = 0.35, .v_n = 0.2}, false}};
    for (size_t i = 0; i < sizeof list / sizeof *list; i++) {
        strike p = list[i].of;
        p.e = 1.0, p.mu = 0.35;
        if (list[i].pair) p.r_other = p.r, p.m_other = sphere_mass(p.density, p.r);
        run_material(&p);
        const double depth = hertz_depth(&p), bound = 1e-6,
                     time = 0.8 * sqrt(M_PI) * gsl_sf_gamma(0.4) / gsl_sf_gamma(0.9) * depth / p.v_n;
        case_near(&chung, "overlap", depth, p.depth, bound * depth, "test %s", list[i].name);
        case_also(&chung, "force", p.k * pow(depth, 1.5), p.force, bound * (p.k * pow(depth, 1.5)));
        case_also(&chung, "time", time, p.time, bound * time);
        case_also(&chung, "speed", p.v_n, p.out_n, bound * p.v_n);
    }
}

/* Test 3: the prescribed restitution, of aluminium oxide and of cast iron. */
static void chung_ooi_3_restitution(void)
{
    for (int i = 0; i < 2 * 5; i++) {
        strike p = oxide(0.0);
        p.e = 0.2 * (1 + i / 2);
        if (i % 2) p.density = 7000.0, p.E = 1.0e11, p.nu = 0.25;
        run_material(&p);
        case_near(&chung, "restitution", p.e, p.out_n / p.v_n, 1e-3, "test 3, %s, e=%g",
                  i % 2 ? "cast iron" : "aluminium oxide", p.e);
    }
}

static const double ROUND = 1e-9; /* of sums over the steps of an impact */

/* An impact that slides throughout: the tangential impulse is mu (1 + e) m_eff v_n, over its mass. */
static double slide(strike *p)
{
    run_material(p);
    return p->mu * (p->v_n + p->out_n) * strike_mass(p) / sphere_mass(p->density, p->r);
}

/* The part of the spin's change, 5/2 of the impulse over m r, that is missing at most because friction acts
 * at r less the overlap. */
static double lever(const strike *p)
{
    return 2.5 * p->depth / p->r + ROUND;
}

/* Test 4: one speed, sliding angles (tan > 7/2 mu (1 + e), plus the contribution of the spring); curves of
 * tangential restitution and spin for aluminium oxide, as digitised; aluminium alloy besides. */
static void chung_ooi_4_oblique(void)
{
    static const double curves[][4] = {
        /* angle and value of each curve */
        {35.0297, 0.7372323, 34.9310, -582.2630}, {40.0198, 0.7808896, 39.9803, -544.8012},
        {50.0000, 0.8451400, 50.0000, -457.0336}, {59.9802, 0.8929160, 60.0197, -357.4924},
        {69.9604, 0.9316310, 69.9606, -246.1774}, {80.0198, 0.9662273, 80.0592, -126.2997},
        {85.0099, 0.9827018, 85.0296, -63.1498}};
    for (size_t i = 0; i < sizeof curves / sizeof *curves; i++) {
        strike p = oxide(curves[i][0]), q = oxide(curves[i][2]), alloy = p;
        alloy.density = 2700.0, alloy.E = 7.0e10, alloy.nu = 0.33;
        strike *const both[] = {&p, &alloy};
        for (int k = 0; k < 2; k++) {
            const double impulse = slide(both[k]), r = both[k]->r;
            case_near(&chung, "e_t", 1.0 - impulse / p.u, both[k]->out_u / p.u, ROUND * impulse / p.u,
                      "test 4, %s, angle=%g", k ? "alloy" : "oxide", curves[i][0]);
            case_also(&chung, "spin", -2.5 * impulse / r, both[k]->out_omega, lever(both[k]) * impulse / r);
        }
        case_near(&chung_digits, "e_t", curves[i][1], p.out_u / p.u, 0.006, "test 4, angle=%g", curves[i][0]);
        slide(&q);
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
        strike p = {.density = 7850.0, .r = r, .E = 2.08e11, .nu = 0.3, .e = 1.0, .mu = mu, .v_n = v};
        p.u = ratio * mu * v;
        slide(&p);
        const double slip = (p.out_u + r * p.out_omega) / (mu * v);
        case_near(&chung, "slip", ratio - 7.0, slip, lever(&p) * 2.0, "test 5, slip/(mu v_n)=%g", ratio);
        case_also(&chung, "spin", -5.0, r * p.out_omega / (mu * v), lever(&p) * 2.0);
        if (i < 2)
            case_near(&chung_digits, "slip", elements[i][1], slip, 0.1,
                      "test 5, finite elements, slip/(mu v_n)=%g", ratio);
    }
}

/* Tests 6 and 8: a spinning sphere of aluminium alloy or nylon on a plane, on one of five times its radius,
 * and that a thousand times as dense: ratio of slip after to slip before impact, -1 + 7/2 mu (1 + e)
 * v_n/slip. Test 7: two equal spheres whose spins give no slip. Spheres that slide past
 * each other turn their normal by some overlap/r. */
static void chung_ooi_6_to_8_spinning(void)
{
    static const double curve[][2] = {{0.17621145374449387, -0.8200274348422496},
                                      {0.35242290748898686, -0.6334705075445815},
                                      {0.5506607929515415, -0.4447187928669407},
                                      {0.7709251101321586, -0.24279835390946491}};
    static const char *const on[] = {"alloy on plane", "nylon on plane", "on 5 r", "on 5 r, dense"};
    const double r = 0.1;
    const strike alloy = {
        .density = 2700.0, .r = r, .E = 7.0e10, .nu = 0.33, .e = 0.5, .mu = 0.4, .v_n = 0.2};
    for (int i = 0; i < 4 * 4; i++) {
        const double number = curve[i % 4][0]; /* 7/2 mu (1 + e) v_n over the slip */
        strike p = alloy;
        const double slip = 3.5 * p.mu * (1.0 + p.e) * p.v_n / number;
        p.omega = slip / r;
        if (i / 4 == 1) p.density = 1000.0, p.E = 2.5e9, p.nu = 0.4;
        if (i / 4 > 1) p.r_other = 5.0 * r, p.m_other = sphere_mass(i / 4 > 2 ? 2.7e6 : 2700.0, p.r_other);
        const double impulse = slide(&p);
        case_near(&chung, "speed along", -impulse, p.out_u, (ROUND + (i / 4 > 1) * p.depth / r) * impulse,
                  "test %d, %s, number=%g", i / 4 > 1 ? 8 : 6, on[i / 4], number);
        case_also(&chung, "spin", p.omega - 2.5 * impulse / r, p.out_omega, lever(&p) * impulse / r);
        if (i / 4 < 2)
            case_near(&chung_digits, "e_t", curve[i % 4][1], -(p.out_u + r * p.out_omega) / slip, 0.016,
                      "test 6, %s, number=%g", on[i / 4], number);
    }
    for (int i = 0; i < 5; i++) {
        const double omega = 0.2 * pow(3.0, i);
        strike p = alloy;
        p.r_other = r, p.m_other = sphere_mass(p.density, r), p.v_n = 0.4;
        p.omega = omega, p.omega_other = -omega;
        run_material(&p);
        case_near(&chung, "spin", omega, p.out_omega, 1e-12 * omega, "test 7, omega=%g", omega);
        case_also(&chung, "speed along", 0.0, p.out_u, 1e-12 * p.v_n);
        case_also(&chung, "restitution", p.e, p.out_n / p.v_n, 1e-3);
    }
}

CASES(published, &dem01, &dem02, &dem03, &dem04, &dem05, &kharaz, &kharaz_material, &chung, &chung_digits)

CHECK_SUITE_SUMMED(published, "validation: published cases", dem01_freely_falling, dem02_bouncing,
                   dem03_stacked, dem04_slipping, dem05_oblique_collision, kharaz_rebounds,
                   chung_ooi_1_and_2_elastic, chung_ooi_3_restitution, chung_ooi_4_oblique,
                   chung_ooi_5_small_sphere, chung_ooi_6_to_8_spinning, cases)
