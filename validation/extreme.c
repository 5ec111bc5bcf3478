/* Stiff and extreme cases, generated: each gives the result of a closed form or a conservation law, or is
 * refused with a message that names the fault; none crashes, hangs or is wrong. A row a case. */
#include "analytic/analytic.h"
#include "core/clock.h"
#include "dem/law/law.h"
#include "dem/state/state.h"
#include "tests/grains.h"
#include "tests/program.h"

static const double R = 0.1, M = 0.004, G = 981.0;
static const double stiffnesses[] = {1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12};
#define COUNT(list) (sizeof(list) / sizeof *(list))

/* ---- The table */

static FILE *table;
static int n_cases, n_right, n_refused;

static struct {
    char parameters[200], expected[120], observed[320];
} text; /* of the present case */
#define SAY(to, ...)    (void)(snprintf(to, sizeof(to), __VA_ARGS__) < 0)
#define PARAMETERS(...) SAY(text.parameters, __VA_ARGS__)
#define EXPECTED(...)   SAY(text.expected, __VA_ARGS__)
#define OBSERVED(...)   SAY(text.observed, __VA_ARGS__)

static void verdict(const char *name, bool right)
{
    n_cases++;
    n_right += right;
    n_refused += strncmp(text.expected, "refused", 7) == 0;
    CU_ASSERT(right);
    if (!right)
        fprintf(stderr, "extreme: %s: %s: expected %s, observed %s\n", name, text.parameters, text.expected,
                text.observed);
    if (table)
        fprintf(table, "%s\t%s\t%s\t%s\t%s\n", name, text.parameters, text.expected, text.observed,
                right ? "right" : "WRONG");
}

/* A number that must equal its closed form within a tolerance relative to `scale`. */
static void number(const char *name, double observed, double expected, double scale, double tolerance)
{
    EXPECTED("%.9g within %.1g", expected, tolerance * fabs(scale));
    OBSERVED("%.9g", observed);
    verdict(name, fabs(observed - expected) <= tolerance * fabs(scale));
}

/* A call that must fail, with the name of the faulty input in its message. */
static void refusal(const char *name, rp_status status, rp_status expected, const char *word)
{
    EXPECTED("refused: %s", word);
    OBSERVED("%s%s", status ? "refused: " : "accepted", status ? rp_message() : "");
    verdict(name, status == expected && strstr(rp_message(), word) != NULL);
}

/* ---- Scenes */

static dem_definition bare(int law, int scheme)
{
    dem_definition def = grains_bare(0, NULL, law, (dem_material){.k_n = 1e6});
    def.integrator = scheme;
    return def;
}

/* The limit of the time step; Verlet's limit for integrators without one. */
static double step_limit(const dem_definition *def)
{
    dem_definition as = *def;
    if (!dem_schemes[as.integrator]->step_limit) as.integrator = DEM_VERLET;
    return dem_time_step_limit(&as, NULL);
}

/* A grain placed on a floor reaches the overlap whose force balances its weight. A grain too heavy for the
 * floor passes through it, and the run ends with that message. */
static void static_overlaps(void)
{
    for (int scheme = 0; scheme < DEM_INTEGRATORS; scheme++)
        for (int law = 0; law < 2; law++)
            for (size_t i = 0; i < COUNT(stiffnesses); i++) {
                dem_definition def = bare(law, scheme);
                const double k = stiffnesses[i], power = law == DEM_HERTZ ? 2.0 / 3.0 : 1.0;
                const double overlap = pow(M * G / k, power);
                const double omega = sqrt((law == DEM_HERTZ ? 1.5 : 1.0) * G / overlap);
                dem_grain grain = {0.0, R, R, M};
                def.gravity[1] = -G;
                def.material = (dem_material){.k_n = k, .gamma_n = 2.0 * omega};
                grains_on_floor(&def, 1, &grain);
                def.dt = 0.5 * fmin(step_limit(&def), 0.1 / omega);
                PARAMETERS("k_n = %g, %s, %s", k, dem_normal_descriptors[law].name,
                           dem_schemes[scheme]->name);
                scoped_sim *sim = grains_start(&def);
                rp_status status = dem_run(sim, lround(40.0 / (omega * def.dt)));
                if (overlap > R) {
                    refusal("static overlap", status, RP_BROKEN, "centre passed wall 1");
                    continue;
                }
                CHECK_OK(status);
                /* creep stops where v dt, with v = omega (y - y0)/2, is below the rounding of y */
                number("static overlap", grains_only_contact(sim).overlap, overlap, 1.0,
                       1e-6 * overlap + 4.0 * 0x1p-57 / (omega * def.dt));
            }
}

typedef struct {
    double v[2];
    rp_status status;
} outcome;

/* Two grains, the second approaching the first at speed v along x; until they separate, or `most` steps. */
static outcome collide(dem_definition *def, dem_grain grains[2], double v, double steps, long most)
{
    grains[1].x = grains[0].x + grains[0].r + grains[1].r;
    grains[1].vx = -v;
    def->grains = grains, def->n_grains = 2;
    def->dt = step_limit(def) / steps;
    grains[1].x += 0.381 * v * def->dt;
    outcome o = {.status = RP_OK};
    scoped_sim *sim = grains_start(def);
    dem_state s[2];
    for (long part = 0; part < most && !o.status; part++) {
        o.status = dem_run(sim, 1);
        dem_states(sim, s);
        if (s[1].x - s[0].x > s[0].r + s[1].r && s[1].vx > s[0].vx) break;
    }
    o.v[0] = s[0].vx, o.v[1] = s[1].vx;
    return o;
}

/* Head-on elastic impacts of any stiffness, radii and masses: both final speeds; or, if the overlap of the
 * closed form exceeds the smaller radius, a message that says so. */
static void elastic(const char *name, int law, int scheme, double k, dem_grain a, dem_grain b, double v)
{
    const double m_eff = a.m * b.m / (a.m + b.m);
    const double depth = law == DEM_HERTZ ? pow(1.25 * m_eff * v * v / k, 0.4) : v * sqrt(m_eff / k);
    dem_definition def = bare(law, scheme);
    def.material.k_n = k;
    PARAMETERS("k_n = %g, %s, %s, r = %g, %g, m = %g, %g", k, dem_normal_descriptors[law].name,
               dem_schemes[scheme]->name, a.r, b.r, a.m, b.m);
    outcome o = collide(&def, (dem_grain[]){a, b}, v, 40.0, 100000);
    if (depth > fmin(a.r, b.r)) {
        refusal(name, o.status, RP_BROKEN, "beyond the smaller radius");
        return;
    }
    /* steps of 1/40 of the limit, some 120 per impact: the kink of the force at contact causes errors of up
     * to 1/120^2 of the exchanged speed, and some ten times as much with Gear's scheme, of one evaluation */
    const double after[2] = {-2.0 * b.m / (a.m + b.m) * v, -(b.m - a.m) / (a.m + b.m) * v};
    const double error = fmax(fabs(o.v[0] - after[0]), fabs(o.v[1] - after[1])) / v;
    EXPECTED("speeds %.6g, %.6g", after[0], after[1]);
    OBSERVED("%.6g, %.6g%s%s", o.v[0], o.v[1], o.status ? "; " : "", o.status ? rp_message() : "");
    verdict(name, o.status == RP_OK && error < 1e-3);
}

static void elastic_impacts(void)
{
    const dem_grain one = {.r = R, .m = M};
    for (int scheme = 0; scheme < DEM_INTEGRATORS; scheme++)
        for (int law = 0; law < 2; law++) {
            for (size_t i = 0; i < COUNT(stiffnesses); i++)
                elastic("elastic impact", law, scheme, stiffnesses[i], one, one, 31.7);
            const double ratios[] = {3.0, 10.0, 100.0, 1e4}, masses[] = {1e3, 1e6, 1e9, 1e12};
            for (size_t i = 0; i < 2 * COUNT(ratios); i++) {
                const bool size = i < COUNT(ratios);
                const double q = size ? ratios[i] : 1.0, m = size ? q * q * q : masses[i - COUNT(ratios)];
                const dem_grain large = {.r = q * R, .m = m * M};
                const char *const name = size ? "radius ratio" : "mass ratio";
                elastic(name, law, scheme, 1e6, one, large, 31.7);
                elastic(name, law, scheme, 1e6, large, one, 31.7);
            }
        }
}

/* Damping from zero to far over-damped: restitution from the solver of single impacts. Where only damping
 * acts within the run: the stopping distance v/gamma, and the momentum. */
static void damped_impacts(void)
{
    const double gammas[] = {0.0, 1.0, 1e2, 1e3, 1e4}, slow[] = {1e6, 1e8, 1e10, 1e12}, v = 12.3;
    for (int law = 0; law < 2; law++) {
        for (size_t i = 0; i < COUNT(gammas); i++) {
            dem_definition def = bare(law, DEM_VERLET);
            def.material.gamma_n = gammas[i];
            dem_grain pair[2] = {{.r = R, .m = M}, {.r = R, .m = 2.0 * M}};
            dem_collision_result exact;
            CHECK_OK(dem_collision(&(dem_head_on){law, true, 1e6, gammas[i], M * 2.0 / 3.0, v}, &exact));
            PARAMETERS("gamma_n = %g, %s", gammas[i], dem_normal_descriptors[law].name);
            outcome o = collide(&def, pair, v, 400.0, 400000);
            const double e = isinf(exact.time) ? 0.0 : exact.restitution;
            /* first order: gamma dt, with a jump of the force at contact */
            number("damped impact", (o.v[1] - o.v[0]) / v, e, 1.0, 1e-4 + gammas[i] * def.dt);
        }
        for (size_t i = 0; i < COUNT(slow); i++)
            for (int tension = 0; tension < 2; tension++) {
                dem_definition def = bare(law, DEM_VERLET);
                def.tension = tension == 1, def.material.gamma_n = slow[i];
                dem_grain pair[2] = {{.r = R, .m = M}, {.x = 2.0 * R, .r = R, .m = 2.0 * M, .vx = -v}};
                def.grains = pair, def.n_grains = 2, def.dt = step_limit(&def);
                pair[1].x += 0.5 * v * def.dt;
                scoped_sim *sim = grains_start(&def);
                dem_state s[2];
                PARAMETERS("gamma_n = %g, %s, tension %d", slow[i], dem_normal_descriptors[law].name,
                           tension);
                rp_status status = dem_run(sim, 200);
                dem_states(sim, s);
                const double overlap = 2.0 * R - (s[1].x - s[0].x);
                EXPECTED("comes to rest at overlap %.6g", v / slow[i]);
                OBSERVED("overlap %.6g, momentum %.6g of %.6g%s", overlap, s[0].vx + 2.0 * s[1].vx, -2.0 * v,
                         status ? rp_message() : "");
                /* the first step of contact acts from its start: half of v dt, with dt = 0.57/gamma */
                verdict("overdamped impact", !status && fabs(overlap * slow[i] / v - 1.0) < 0.5 &&
                                                 fabs(s[1].vx - s[0].vx) < 1e-3 * v &&
                                                 fabs(s[0].vx + 2.0 * s[1].vx + 2.0 * v) < 1e-9 * v);
            }
    }
}

/* A sphere on an incline of 30 degrees, of any friction: it slides, sticks or rolls by closed forms. */
static void frictions(void)
{
    const double mus[] = {0.0, 1e-12, 0.1, 10.0, 1e300, INFINITY}, slope = M_PI / 6.0, k_s = 1e4, T = 0.5;
    for (size_t i = 0; i < COUNT(mus); i++)
        for (int rotation = 0; rotation < 2; rotation++)
            for (int slip = 0; slip < 2; slip++)
                for (int damping = 0; damping < 2; damping++) {
                    const double mu = mus[i], gx = G * sin(slope), gy = G * cos(slope);
                    dem_definition def = bare(DEM_HERTZ, DEM_VERLET);
                    dem_grain grain = {0.0, R - pow(M * gy / 1e6, 2.0 / 3.0), R, M};
                    def.gravity[0] = gx, def.gravity[1] = -gy, def.tangential = DEM_SPRING;
                    def.rotation = rotation == 1, def.slip = slip, def.damping = damping;
                    def.material = (dem_material){.k_n = 1e6, .gamma_n = 500.0, .k_s = k_s, .mu = mu};
                    def.dt = 2e-5;
                    grains_on_floor(&def, 1, &grain);
                    scoped_sim *sim = grains_after(&def, lround(T / def.dt));
                    const dem_state s = grains_state_of_one(sim);
                    PARAMETERS("mu = %g, rotation %d, %s, dashpot %s", mu, rotation,
                               slip ? "total" : "truncated", damping ? "inside" : "outside");
                    /* an undamped spring oscillates up to twice its static extension */
                    if (mu > 1.0 && !rotation)
                        number("friction, sticks", s.x, M * gx / k_s, M * gx / k_s, 1.001);
                    else if (mu > 1.0)
                        number("friction, rolls", s.vx, 5.0 / 7.0 * gx * T, gx * T, 2e-3);
                    else /* the default shear spring, below its limit, holds mu N */
                        number("friction, slides", s.vx, (gx - mu * gy) * T, gx * T, 2e-3);
                }
}

/* Undamped grains that overlap at the start: all elastic energy becomes kinetic. Overlaps beyond the smaller
 * radius, and coincident centres, are refused. */
static void start_overlaps(void)
{
    const double depths[] = {1e-9, 0.01, 0.3, 0.5, 0.6, 0.9, 0.999, 1.001, 1.5, 2.0};
    for (int law = 0; law < 2; law++)
        for (int wall = 0; wall < 2; wall++)
            for (size_t i = 0; i < COUNT(depths); i++) {
                const double overlap = depths[i] * R, energy = law == DEM_HERTZ
                                                                   ? 0.4 * 1e6 * pow(overlap, 2.5)
                                                                   : 0.5e6 * overlap * overlap;
                dem_definition def = bare(law, DEM_VERLET);
                dem_grain pair[2] = {{.x = 0.0, .y = R - overlap, .r = R, .m = M},
                                     {.x = 0.0, .y = 3.0 * R - 2.0 * overlap, .r = R, .m = M}};
                grains_on_floor(&def, wall ? 1 : 2, pair);
                def.n_walls = wall, def.dt = 1e-9;
                PARAMETERS("overlap %g of the radius, %s, %s", depths[i], dem_normal_descriptors[law].name,
                           wall ? "at a wall" : "two grains");
                scoped_sim *sim = NULL;
                const rp_status status = dem_create(&def, &sim);
                if (depths[i] > 1.0) {
                    refusal("initial overlap", status, RP_BAD_INPUT, wall ? "wall 1" : "overlap");
                    continue;
                }
                CHECK_OK(status);
                const double m_eff = wall ? M : 0.5 * M, k = law == DEM_HERTZ ? 1.5e6 * sqrt(overlap) : 1e6;
                def.dt = 0.01 / sqrt(k / m_eff);
                grains_again(&sim, &def, 1000);
                const dem_energy e = grains_energies(sim);
                number("initial overlap", e.kinetic, energy, energy, 1e-3);
            }
}

/* A single grain under any gravity: a parabola, which both schemes reproduce to round-off. */
static void single_grains(void)
{
    const double gravities[][2] = {{0.0, 0.0}, {0.0, -981.0}, {981.0, 0.0},  {-981.0, 981.0},
                                   {0.0, 1e9}, {0.0, -1e-12}, {1e-300, 0.0}, {-3.0, 4.0}};
    const double speeds[] = {0.0, 100.0};
    const long steps = 1000;
    for (int scheme = 0; scheme < DEM_INTEGRATORS; scheme++)
        for (size_t g = 0; g < COUNT(gravities); g++)
            for (size_t v = 0; v < COUNT(speeds); v++) {
                dem_definition def = bare(DEM_HERTZ, scheme);
                dem_grain grain = {1.0, 2.0, R, M, speeds[v], -speeds[v]};
                memcpy(def.gravity, gravities[g], sizeof def.gravity);
                def.grains = &grain, def.n_grains = 1;
                PARAMETERS("gravity = [%g, %g], v = %g, %s", gravities[g][0], gravities[g][1], speeds[v],
                           dem_schemes[scheme]->name);
                scoped_sim *sim = grains_start(&def);
                const rp_status status = dem_run(sim, steps);
                if (fabs(gravities[g][1]) * def.dt * def.dt > R) {
                    refusal("single grain", status, RP_BROKEN, "too_fast");
                    continue;
                }
                CHECK_OK(status);
                const dem_state s = grains_state_of_one(sim);
                const double t = (double)steps * def.dt;
                const double x = 1.0 + speeds[v] * t + 0.5 * gravities[g][0] * t * t,
                             y = 2.0 - speeds[v] * t + 0.5 * gravities[g][1] * t * t;
                /* a step rounds a position and a velocity times dt: a few times 2^-53 of the largest value */
                number("single grain", hypot(s.x - x, s.y - y), 0.0, 2.0 + fabs(x) + fabs(y),
                       4.0 * (double)steps * 0x1p-53);
            }
}

/* Two grains at any distance move freely, or are refused where cell indices overflow. */
static void far_apart(void)
{
    for (double distance = 10.0; distance < 1e308; distance *= distance < 1e15 ? 1e3 : 1e60)
        for (int scheme = 0; scheme < DEM_INTEGRATORS; scheme++)
            for (int walls = 0; walls < 2; walls++) {
                dem_definition def = bare(DEM_HERTZ, scheme);
                dem_grain pair[2] = {{0.0, R, R, M, 1.0, 0.0}, {distance, R, R, M, 1.0, 0.0}};
                grains_on_floor(&def, 2, pair);
                def.n_walls = walls;
                PARAMETERS("%g apart, %s%s", distance, dem_schemes[scheme]->name,
                           walls ? ", on a floor" : "");
                scoped_sim *sim = NULL;
                dem_state s[2];
                rp_status status = dem_create(&def, &sim);
                if (distance > 2e8) { /* cell indices end at 1e9 */
                    refusal("far apart", status, RP_BAD_INPUT, "far away");
                    continue;
                }
                CHECK_OK(status);
                grains_run(sim, 1000, s);
                const double displacement = 1000.0 * def.dt;
                number("far apart", fabs(s[0].x - displacement) + fabs(s[1].x - (distance + displacement)),
                       0.0, 1.0 + distance, 2000.0 * 0x1p-53);
            }
}

/* The same impact in other units of length, mass and time: restitution and overlap stay the same. */
static void scaled_units(void)
{
    const double gamma = 300.0, v = 12.3;
    dem_collision_result exact;
    CHECK_OK(dem_collision(&(dem_head_on){DEM_HERTZ, true, 1e6, gamma, 0.5 * M, v}, &exact));
    for (double length = 1e-30; length < 1e31; length *= 1e10)
        for (double mass = 1e-30; mass < 1e31; mass *= 1e20)
            for (double time = 1e-6; time < 1e7; time *= 1e6) {
                dem_definition def = bare(DEM_HERTZ, DEM_VERLET);
                def.material.k_n = 1e6 * mass / (sqrt(length) * time * time);
                def.material.gamma_n = gamma / time;
                dem_grain pair[2] = {{.r = R * length, .m = M * mass}, {.r = R * length, .m = M * mass}};
                const double speed = v * length / time;
                PARAMETERS("lengths times %g, masses times %g, times times %g", length, mass, time);
                outcome o = collide(&def, pair, speed, 400.0, 400000);
                /* first order, as the damped impacts */
                number("units", o.status ? NAN : (o.v[1] - o.v[0]) / speed, exact.restitution, 1.0,
                       gamma / time * def.dt);
            }
}

/* Grains at rest without contact, or with zero overlap, keep their positions to the bit. */
static void zero_velocities(void)
{
    for (int scheme = 0; scheme < DEM_INTEGRATORS; scheme++)
        for (int law = 0; law < 2; law++)
            for (int n = 1; n <= 100; n *= 10) {
                dem_grain grains[100];
                dem_definition def = bare(law, scheme);
                for (int i = 0; i < n; i++)
                    grains[i] = (dem_grain){.x = 0.25 * (i % 10), .y = 0.25 * (i / 10), .r = 0.125, .m = M};
                def.grains = grains, def.n_grains = (size_t)n;
                def.dt = step_limit(&def) < 1.0 ? step_limit(&def) : def.dt;
                PARAMETERS("%d grains with zero overlap, %s, %s", n, dem_normal_descriptors[law].name,
                           dem_schemes[scheme]->name);
                scoped_sim *sim = grains_start(&def);
                dem_state s[100];
                grains_run(sim, 1000, s);
                int moved = 0;
                for (int i = 0; i < n; i++)
                    moved +=
                        s[i].x != grains[i].x || s[i].y != grains[i].y || s[i].vx != 0.0 || s[i].vy != 0.0;
                EXPECTED("none moves");
                OBSERVED("%d move", moved);
                verdict("zero velocities", moved == 0);
            }
}

/* A frictionless grain in a closed box. Gravity has any direction from the start, or is rotated, or the box
 * is rotated; the walls carry the components of the weight. */
static void sideways(void)
{
    for (int how = 0; how < 3; how++)
        for (int degrees = 0; degrees <= 180; degrees += check_fast() ? 90 : 30) {
            const double angle = degrees * M_PI / 180.0;
            dem_definition def = bare(DEM_HERTZ, DEM_VERLET);
            dem_grain grain = {0.5, 0.5, R, M};
            def.gravity[1] = -G;
            if (how == 0) def.gravity[0] = G * sin(angle), def.gravity[1] = -G * cos(angle);
            def.material.gamma_n = 500.0, def.grains = &grain, def.n_grains = 1;
            def.n_walls = 4;
            for (int w = 0; w < 4; w++) {
                static const double n[4][2] = {{0.0, 1.0}, {-1.0, 0.0}, {0.0, -1.0}, {1.0, 0.0}};
                const double c = w == 1 || w == 2 ? 1.0 : 0.0;
                def.walls[w] = grains_line(c, c, n[w][0], n[w][1], &def.material);
            }
            scoped_sim *sim = grains_start(&def);
            const long turning = 20000;
            if (how == 1) dem_gravity_turn(sim, angle / (double)turning);
            if (how == 2) dem_box_turn(sim, angle / (double)turning);
            CHECK_OK(dem_run(sim, turning));
            if (how == 1) dem_gravity_turn(sim, 0.0);
            if (how == 2) dem_box_turn(sim, 0.0);
            CHECK_OK(dem_run(sim, 60000));
            double f[8], carried[2];
            grains_wall_forces(sim, f);
            /* in the frame of the box */
            const double turned = how == 2 ? angle : 0.0;
            double sum[2] = {0.0, 0.0};
            for (int w = 0; w < 4; w++) sum[0] += f[2 * w], sum[1] += f[2 * w + 1];
            carried[0] = cos(turned) * sum[0] - sin(turned) * sum[1];
            carried[1] = sin(turned) * sum[0] + cos(turned) * sum[1];
            PARAMETERS("%d degrees, %s", degrees,
                       how == 0   ? "from the start"
                       : how == 1 ? "gravity turned"
                                  : "box turned");
            EXPECTED("force on the walls %.6g, %.6g", M * G * sin(angle), -M * G * cos(angle));
            OBSERVED("%.6g, %.6g", carried[0], carried[1]);
            verdict("gravity sideways",
                    hypot(carried[0] - M * G * sin(angle), carried[1] + M * G * cos(angle)) < 1e-6 * M * G);
        }
}

/* A full box, with gravity or the box rotated to an angle, then held until the grains rest. */
enum { MANY = 40 };
static const double WIDTH = 2.0, HEIGHT = 2.2;

static dem_sim *start_full_box(int scheme, double mu, bool lid)
{
    dem_definition def = grains_box(MANY, WIDTH, 17, NULL);
    def.integrator = scheme, def.material.mu = mu;
    def.damping = DEM_DAMPING_OUTSIDE; /* a drag: grains without friction would sway on */
    for (size_t w = 0; w < def.n_walls; w++) def.walls[w].material.mu = mu;
    if (lid) def.walls[def.n_walls++] = grains_line(0.0, HEIGHT, 0.0, -1.0, &def.walls[0].material);
    def.x_max = lid ? INFINITY : 1.5 * WIDTH;
    dem_sim *sim = grains_start(&def);
    CHECK_OK(dem_run(sim, 10000));
    return sim;
}

/* Largest kinetic plus elastic energy over `steps`; NAN for a run that fails. */
static double most_energy(dem_sim *sim, long steps)
{
    double most = 0.0;
    for (long part = 0; part < 50; part++) {
        if (dem_run(sim, steps / 50) != RP_OK) return NAN;
        const dem_energy e = grains_energies(sim);
        most = fmax(most, e.kinetic + e.elastic);
    }
    return most;
}

static double turn_box(dem_sim *sim, bool box, double angle, long resting)
{
    const long turning = 16000;
    (box ? dem_box_turn : dem_gravity_turn)(sim, angle / (double)turning);
    const double most = most_energy(sim, turning);
    (box ? dem_box_turn : dem_gravity_turn)(sim, 0.0);
    const double rest = most_energy(sim, resting);
    return isnan(most) || isnan(rest) ? NAN : fmax(most, rest);
}

/* Mass of the grains, and their number inside the closed box. */
static double mass_within(const dem_sim *sim, size_t *within)
{
    double mass = 0.0;
    *within = 0;
    scoped dem_state *states = grains_states(sim);
    for (size_t i = 0; i < dem_count(sim); i++) {
        double x = states[i].x, y = states[i].y;
        dem_box_frame(sim, &x, &y);
        *within += x > 0.0 && x < WIDTH && y > 0.0 && y < HEIGHT;
        mass += states[i].m;
    }
    return mass;
}

/* No grain leaves a closed box; in the end the walls carry the weight; each frictionless wall carries the
 * component along its normal. The energy stays below the potential energy of the fall within the box. */
static void turned_boxes(void)
{
    for (int scheme = 0; scheme < (check_full() ? 2 : 1); scheme++)
        for (int box = 0; box < 2; box++)
            for (int rough = check_fast(); rough < 2; rough++)
                for (int degrees = check_full() ? 45 : 90; degrees <= (check_fast() ? 90 : 180);
                     degrees += check_full() ? 45 : 90) {
                    const double angle = degrees * M_PI / 180.0;
                    scoped_sim *sim = start_full_box(scheme, rough ? 0.2 : 0.0, true);
                    size_t within;
                    const double most = turn_box(sim, box == 1, angle, 30000),
                                 mass = mass_within(sim, &within);
                    const double weight = mass * G, turned = sim->walls.angle;
                    double f[8], along[4], sum[2] = {0.0, 0.0};
                    grains_wall_forces(sim, f);
                    static const double outwards[4][2] = {{0.0, -1.0}, {-1.0, 0.0}, {1.0, 0.0}, {0.0, 1.0}};
                    for (int w = 0; w < 4; w++) {
                        double x = f[2 * w], y = f[2 * w + 1];
                        dem_box_frame(sim, &x, &y);
                        along[w] = (x * outwards[w][0] + y * outwards[w][1]) / weight;
                        sum[0] += x / weight, sum[1] += y / weight;
                    }
                    PARAMETERS("%d grains, mu = %g, %d degrees, %s turned, %s", MANY, rough ? 0.2 : 0.0,
                               degrees, box ? "box" : "gravity", dem_schemes[scheme]->name);
                    EXPECTED("all inside; walls carry %.4g, %.4g of the weight; energy below weight times "
                             "width and height",
                             sin(angle), -cos(angle));
                    OBSERVED("%zu inside, rotated by %.4g; %.6g, %.6g; floor %.4g, left %.4g, right %.4g, "
                             "lid %.4g; energy %.3g",
                             within, turned, sum[0], sum[1], along[0], along[1], along[2], along[3],
                             most / (weight * (WIDTH + HEIGHT)));
                    double off = hypot(sum[0] - sin(angle), sum[1] + cos(angle));
                    if (!rough && fmod(degrees, 90.0) == 0.0) /* one wall carries the whole weight */
                        off = fmax(off, fabs(along[degrees == 90 ? 2 : 3] - 1.0));
                    /* grains still oscillate on their shear springs, which are weakly damped */
                    verdict("full box turned", within == MANY && off < (rough ? 5e-3 : 1e-3) &&
                                                   most < weight * (WIDTH + HEIGHT));
                }
}

/* Open at the top or at the side: grains outside are counted, and exert no force on the floor. */
static void emptied_boxes(void)
{
    for (int scheme = 0; scheme < (check_full() ? 2 : 1); scheme++)
        for (int box = 0; box < 2; box++)
            for (int side = 0; side < 2; side++) {
                scoped_sim *sim = start_full_box(scheme, 0.2, false);
                if (side) dem_wall_open(sim, DEM_BOX_RIGHT, INFINITY);
                const double most = turn_box(sim, box == 1, side ? M_PI_2 : M_PI, 10000);
                size_t within, left;
                mass_within(sim, &within);
                left = dem_count(sim);
                double f[8]; /* the sides are infinite lines, which still guide falling grains */
                grains_wall_forces(sim, f);
                const double force = hypot(f[2 * DEM_BOX_FLOOR], f[2 * DEM_BOX_FLOOR + 1]);
                PARAMETERS("%d grains, %s turned, open %s, %s", MANY, box ? "box" : "gravity",
                           side ? "at the side" : "on top", dem_schemes[scheme]->name);
                EXPECTED("0 within, %d there", side ? 0 : MANY);
                OBSERVED("%zu inside, %zu counted, force on the floor %.3g", within, left, force);
                verdict("full box emptied",
                        within == 0 && left == (size_t)(side ? 0 : MANY) && force == 0.0 && isfinite(most));
            }
}

/* Hard collisions of any masses. */
static void hard_collisions(void)
{
    const double restitutions[] = {0.0, 0.5, 1.0}, masses[] = {1.0, 1e6, 1e12}, v = 100.0;
    for (size_t i = 0; i < COUNT(restitutions); i++)
        for (size_t k = 0; k < COUNT(masses); k++) {
            const double e = restitutions[i], m = masses[k] * M;
            dem_definition def = bare(DEM_LINEAR, DEM_VERLET);
            dem_grain pair[2] = {{.r = R, .m = M}, {.x = 2.5 * R, .r = R, .m = m, .vx = -v}};
            def.tension = false;
            def.hard = (dem_hard){true, e, 0.0};
            def.grains = pair, def.n_grains = 2;
            def.dt = fmin(5e-5, 0.9 * step_limit(&def));
            scoped_sim *sim = grains_start(&def);
            dem_state s[2];
            grains_run(sim, lround(1e-3 / def.dt), s);
            const double mean = -v * m / (M + m);
            PARAMETERS("restitution %g, m = %g, %g", e, M, m);
            EXPECTED("speeds %.6g, %.6g", mean * (1.0 + e), mean + e * v * M / (M + m));
            OBSERVED("%.6g, %.6g", s[0].vx, s[1].vx);
            verdict("hard collision", fabs(s[0].vx - mean * (1.0 + e)) < 1e-9 * v &&
                                          fabs(s[1].vx - mean - e * v * M / (M + m)) < 1e-9 * v);
        }
}

/* ---- The program */

/* Exit status of `repose` with these arguments, killed after 60 s of processor time. */
#define PROGRAM(format, ...) shell_line("ulimit -t 60; \"$REPOSE\" " format " >out 2>err", __VA_ARGS__)

/* The answer is the message, or else the first cell of the table. */
static void program_refuses(const char *name, int status, int expected, const char *part)
{
    scoped_table t = {0};
    if (!*err) t = read_table("out");
    const char *answer = *err ? err : t.n_rows ? t.cells[0] : "";
    EXPECTED("%sexit status %d: %s", expected ? "refused, " : "", expected, part);
    OBSERVED("exit status %d: %.*s", status, (int)fmin(160.0, (double)strcspn(answer, "\n")), answer);
    verdict(name, status == expected && (strstr(out, part) || strstr(err, part)));
}

/* Soft piles of the flattest and the steepest slopes, one layer and one disk: the base carries the disks. */
static void soft_piles(void)
{
    const double alphas[] = {1e-6, 1.0, 30.0, 59.999, 60.0};
    const int bases[] = {1, 2, 20};
    for (size_t i = 0; i < COUNT(alphas); i++)
        for (size_t b = 0; b < COUNT(bases); b++)
            for (double eps = 1e-12; eps < 1e-3; eps *= 1e8) {
                long up[20], disks = 0;
                CHECK_OK(an_lattice_cut(bases[b], M_PI / 6.0, alphas[i] * M_PI / 180.0, up));
                for (int s = 0; s < bases[b]; s++) disks += up[s];
                PARAMETERS("alpha = %g degrees, base of %d, eps = %g", alphas[i], bases[b], eps);
                const int status =
                    PROGRAM("pile --base %d --alpha-deg %.17g --eps %g", bases[b], alphas[i], eps);
                scoped_table t = read_table("out");
                double N = 0.0, H = 0.0;
                for (size_t row = 0; row < t.n_rows; row++)
                    N += cell(&t, row, "N/mg"), H += cell(&t, row, "H/mg");
                EXPECTED("sum of N %ld, of H 0", disks);
                OBSERVED("exit status %d: %.9g, %.3g", status, N, H);
                verdict("soft pile", status == 0 && fabs(N - (double)disks) < 1e-6 * (double)disks &&
                                         fabs(H) < 1e-6 * (double)disks);
            }
}

/* Boxes from flat to tall, of one layer, column or grain: a result for all grains, or why there is none. */
static void box_shapes(void)
{
    const struct {
        double W, H, dt;
        long N;
        const char *more, *word; /* NULL: a result with all grains */
        int status;
        bool slow;
    } boxes[] = {
        {4.0, 4.0, 5e-5, 1, "", "no_pile", 1, false},
        {2.0, 0.2, 5e-5, 5, "radius_width = 0.0;", NULL, 0, false},
        {4.0, 0.4, 5e-5, 30, "", NULL, 0, false},
        {1.0, 4.0, 5e-5, 20, "", NULL, 0, false},
        {1.0, 2.0, 5e-5, -1, "radius_width = 0.0;", NULL, 0, false},
        {0.9, 2.0, 5e-5, -1, "", "at least five grain diameters expected (W >= 5*d; W = 0.9)", 65, false},
        {4.0, 0.2, 5e-5, -1, "", NULL, 0, false},
        {4.0, 0.05, 5e-5, -1, "", "no room for grain", 1, false},
        {4.0, 0.001, 5e-5, -1, "", "N = 0: out of range", 65, false},
        {1.0, 100.0, 5e-5, -1, "", "dt = 5e-05", 65, false},
        {1.0, 100.0, 4e-5, -1, "stop = \"steps\"; fill_steps = 3000; relax_steps = 3000;", NULL, 0, true},
        {40.0, 4.0, 5e-5, -1, "stop = \"steps\"; fill_steps = 3000; relax_steps = 3000;", NULL, 0, true}};
    for (size_t i = 0; i < COUNT(boxes); i++) {
        if ((boxes[i].slow && !check_full()) || (check_fast() && !boxes[i].word && i % 3)) continue;
        const char *count = boxes[i].N > 0 ? check_text("N = %ld;", boxes[i].N) : "";
        PARAMETERS("W = %g, H = %g, dt = %g %s %s", boxes[i].W, boxes[i].H, boxes[i].dt, count,
                   boxes[i].more);
        write_text("box.cfg",
                   "protocol = \"repose\"; replicas = 1; piles = \"shared\"; seed = 5; fixed = { W = %.6f; "
                   "H = %.6f; dt = %.9f; %s %s }; grid = { mu = [0.2]; };",
                   boxes[i].W, boxes[i].H, boxes[i].dt, count, boxes[i].more);
        const int status = PROGRAM("run box.cfg --row 0 -o box_%zu", i);
        if (boxes[i].word) {
            program_refuses("box", status, boxes[i].status, boxes[i].word);
            continue;
        }
        scoped_table t = read_table("out");
        const double grains = cell(&t, 0, "grains"), theta = cell(&t, 0, "theta_r3_deg"),
                     most = boxes[i].N > 0 ? (double)boxes[i].N : round(boxes[i].W * boxes[i].H / 0.04);
        EXPECTED("a slope of 1 to %g grains", most);
        OBSERVED("exit status %d: theta_R = %g, %g grains", status, theta, grains);
        verdict("box", status == 0 && theta > -45.0 && theta < 90.0 && grains >= 1.0 && grains <= most);
    }
}

/* Scenes of a grain that hits a wall, from undamped to far over-damped: the run ends, and reports the impact
 * where one is defined. */
static void run_scenes(void)
{
    static const char *const frictions[] = {"0.0", "1e-12", "10.0", "\"infinite\""};
    for (int law = 0; law < 2; law++)
        for (int scheme = 0; scheme < DEM_INTEGRATORS; scheme++)
            for (double gamma = 0.0; gamma<1e13; gamma = gamma> 0.0 ? 1e3 * gamma : 1e4)
                for (size_t f = 0; f < (scheme == DEM_IMPLICIT || !check_full() ? 1 : COUNT(frictions));
                     f++) {
                    PARAMETERS("%s, %s, gamma_n = %g, mu = %s", dem_normal_descriptors[law].name,
                               dem_schemes[scheme]->name, gamma, frictions[f]);
                    write_text("s.cfg",
                               "integrator = \"%s\"; dt = 1.0e-14; steps = 20; normal = { law = \"%s\"; k_n "
                               "= 100.0; gamma_n = %.17e; }; tangential = { law = \"%s\"; mu = %s; }; walls "
                               "= ( { point = [0.0, 0.0]; direction = [0.0, 1.0]; } ); particles = ( { x = "
                               "0.0; y = 0.25; r = 0.1; vy = -1.0; } );",
                               dem_schemes[scheme]->name, dem_normal_descriptors[law].name, gamma,
                               scheme == DEM_IMPLICIT ? "none" : "spring", frictions[f]);
                    const int status = PROGRAM("%s", "run s.cfg");
                    scoped_table t = read_table("out");
                    const double vy = cell(&t, t.n_rows - 1, "vy");
                    EXPECTED("flies on at -1");
                    OBSERVED("exit status %d: vy = %.9g", status, vy);
                    verdict("scene", status == 0 && fabs(vy + 1.0) < 1e-9 &&
                                         strstr(out, "# impact: two mean") != NULL);
                }
}

/* A million grains, each in contact with two others: they fall as one body. */
static void million(void)
{
    const size_t n = 1000000;
    scoped dem_grain *grains = malloc(n * sizeof *grains);
    CU_ASSERT_FATAL(grains != NULL);
    for (size_t i = 0; i < n; i++)
        grains[i] =
            (dem_grain){.x = 0.25 * (double)(i % 1000), .y = 0.25 * (double)(i / 1000), .r = 0.125, .m = M};
    dem_definition def = bare(DEM_HERTZ, DEM_VERLET);
    def.gravity[1] = -G, def.grains = grains, def.n_grains = n;
    def.dt = step_limit(&def);
    PARAMETERS("1000 x 1000 grains");
    scoped_sim *sim = grains_after(&def, 20);
    scoped dem_state *states = grains_states(sim);
    const double t = dem_time(sim);
    double most = 0.0;
    for (size_t i = 0; i < n; i++)
        most = fmax(most, hypot(states[i].x - grains[i].x, states[i].y - grains[i].y + 0.5 * G * t * t));
    /* positions up to 250, rounded 20 times, and contact forces of overlaps of 2^-45 */
    number("1e6 grains", most, 0.0, 250.0, 20.0 * 0x1p-51);
}

static void right_or_refused(void)
{
    table = check_table("extreme",
                        "case [word], parameters [text], expected [text], observed [text], verdict [word]");
    n_cases = n_right = n_refused = 0;
    const double start = rp_clock();
    static void (*const kinds[])(void) = {
        static_overlaps, elastic_impacts, damped_impacts,  frictions,  start_overlaps, single_grains,
        far_apart,       scaled_units,    zero_velocities, sideways,   turned_boxes,   emptied_boxes,
        hard_collisions, soft_piles,      box_shapes,      run_scenes, million};
    for (size_t k = 0; k < COUNT(kinds) - !check_full(); k++) kinds[k](); /* the last in full only */
    CU_ASSERT(n_cases >= 300);
    check_table_close(&table);
    table = check_table("extreme_sums", "cases, right, refused, run_time [s]");
    if (table) fprintf(table, "%d\t%d\t%d\t%.3g\n", n_cases, n_right, n_refused, rp_clock() - start);
    check_table_close(&table);
}

CHECK_SUITE_WITHIN(extreme, "validation: extreme cases", enter, leave, right_or_refused)
