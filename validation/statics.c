/* Validation of contacts that last or act on one another: a bounce whose contact gravity acts through, grains
 * compressed between walls, columns at rest, Newton's cradles. */
#include <float.h>
#include <gsl/gsl_errno.h>
#include <gsl/gsl_odeiv2.h>
#include <stdlib.h>
#include <string.h>

#include "dem/dem.h"
#include "tests/check.h"
#include "tests/grains.h"
#include "validation/cases.h"

enum { MOST = 10 };

static const char *const LAW[] = {"hertz", "linear"};

static case_problem bounce_problem = {"bounce", "closed form (linear), energy (Hertz)",
                                      "w^2 dt^2; damped also gamma dt from touch, lag and parting"},
                    stack_problem = {"stack", "balance of forces", "net force left on the grains"},
                    column_problem = {"column", "weight above", "net force left on the grains"},
                    cradle_problem = {"cradle", "Runge-Kutta to 1e-13; linear three: also closed form",
                                      "w^2 dt^2 for each touch and parting"},
                    gap_problem = {"cradle_gaps", "exchange of velocities", "w^2 dt^2 for each touch and parting"};

static double elastic_force(int law, double k, double overlap)
{
    return overlap <= 0.0 ? 0.0 : law == DEM_HERTZ ? k * pow(overlap, 1.5) : k * overlap;
}

static double overlap_of(int law, double k, double force)
{
    return law == DEM_HERTZ ? pow(force / k, 2.0 / 3.0) : force / k;
}

/* The root of f between lo and hi, where it has opposite signs. */
static double root(double (*f)(double, const void *), const void *data, double lo, double hi)
{
    const bool rises = f(hi, data) > 0.0;
    for (int i = 0; i < 200; i++) {
        const double middle = 0.5 * (lo + hi);
        *((f(middle, data) > 0.0) == rises ? &hi : &lo) = middle;
    }
    return 0.5 * (lo + hi);
}

/* Overlap of a grain that touches a floor with speed v, linear law: x'' = g - w0^2 x - 2 b x'. */
typedef struct {
    double g, w02, b, v;
} bouncing;

static double bounce_overlap(double t, const void *data)
{
    const bouncing *p = data;
    const double w = sqrt(p->w02 - p->b * p->b), rest = p->g / p->w02;
    return rest + exp(-p->b * t) * ((p->v - p->b * rest) / w * sin(w * t) - rest * cos(w * t));
}

static double bounce_speed(double t, const void *data)
{
    const bouncing *p = data;
    const double w = sqrt(p->w02 - p->b * p->b), rest = p->g / p->w02;
    const double c = (p->v - p->b * rest) / w;
    return exp(-p->b * t) * ((c * w + p->b * rest) * cos(w * t) + (rest * w - p->b * c) * sin(w * t));
}

/* Dropped from a height at which it comes to speed v = g/(w0 heavy): `heavy` says how much gravity does while
 * they touch. */
static void check_bounce(double heavy, double damping, double k, double m, double phase)
{
    const double r = 0.1193, g = 981.0, w0 = sqrt(k / m), v = g / (w0 * heavy);
    const bouncing p = {g, w0 * w0, damping * w0, v};
    const double w = w0 * sqrt(1.0 - damping * damping), dt = M_PI / w0 / 2000.0;
    /* the overlap returns to 0 after it has come to its largest */
    const double top = root(bounce_speed, &p, 0.0, M_PI / w * (1.0 + heavy / (1.0 + heavy)));
    const double end = root(bounce_overlap, &p, top, 2.0 * M_PI / w - top * 1e-9);
    const double deepest = bounce_overlap(top, &p), out = -bounce_speed(end, &p);
    /* it starts in flight, a few steps above */
    const double before = (3.0 + phase) * dt;
    dem_grain grain = {0.0, r + (v - 0.5 * g * before) * before, r, m, 0.0, -(v - g * before)};
    dem_definition def = dem_definition_default();
    def.normal = DEM_LINEAR;
    def.tangential = DEM_NONE;
    def.material = (dem_material){.k_n = k, .gamma_n = 2.0 * damping * w0};
    def.dt = dt;
    def.grains = &grain;
    def.n_grains = 1;
    def.n_walls = 1;
    def.walls[0] = grains_line(0.0, 0.0, 0.0, 1.0, &def.material);
    dem_sim *sim = grains_start(&def);
    double largest = 0.0, t = NAN, speed = NAN;
    while (dem_time(sim) < before + 2.0 * end) {
        CU_ASSERT_EQUAL_FATAL(dem_run(sim, 1), RP_OK);
        const dem_state s = grains_state_of_one(sim);
        largest = fmax(largest, r - s.y);
        if (s.y >= r && s.vy > 0.0) {
            const double since = (s.y - r) / s.vy; /* of second order in g dt/v */
            t = dem_time(sim) - since - before;
            speed = s.vy + g * since;
            break;
        }
    }
    dem_free(sim);
    const double first = def.material.gamma_n * dt, second = pow(w0 * dt, 2.0) * (1.0 + heavy);
    case_near(&bounce_problem, "speed", out, speed, (1.5 * first + second) * v,
              "linear gravity=%g damping=%g k_n=%g m=%g dt=%g", heavy, damping, k, m, dt);
    case_near(&bounce_problem, "overlap", deepest, largest, (1.5 * first + second) * deepest,
              "linear gravity=%g damping=%g k_n=%g m=%g dt=%g", heavy, damping, k, m, dt);
    case_near(&bounce_problem, "time", end, t, (1.5 * first * v / out + second) * end,
              "linear gravity=%g damping=%g k_n=%g m=%g dt=%g", heavy, damping, k, m, dt);
}

static void bounce(void)
{
    static const double heavies[] = {0.001, 0.03, 0.3, 1.0}, dampings[] = {0.0, 0.05, 0.2},
                        stiffness[] = {1e4, 3.1e6}, masses[] = {0.0042, 0.31};
    const int stride = check_full() ? 1 : 5;
    for (int i = 0; i < 4 * 3 * 2 * 2; i += stride)
        check_bounce(heavies[i % 4], dampings[i / 4 % 3], stiffness[i / 12 % 2], masses[i / 24],
                     fmod(0.381 + 0.6180339887 * i, 1.0));
}
