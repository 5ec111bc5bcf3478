/* Validation of the normal laws and the integrator: head-on impacts, elastic and damped, of grains and on
 * walls, with and without attractive damped forces. */
#include <float.h>
#include <gsl/gsl_sf_gamma.h>

#include "table/table.h"
#include "tests/grains.h"
#include "validation/cases.h"

/* Head-on impact of two grains at relative speed v, or of a grain on a wall (m_b infinite). `clipped`: the
 * damped force may not be attractive. `phase`: fraction of a step from the start to first contact. */
typedef struct {
    int law;
    double k_n, gamma_n, v;
    bool clipped;
    double m_a, m_b, phase;
} impact;

typedef struct {
    double restitution, overlap, time, force;
} outcome;

static const double R_A = 0.1385, R_B = 0.0871, M_A = 0.01313, M_B = 0.00297;
static const double M_EFF = 0.01313 * 0.00297 / (0.01313 + 0.00297);

static double effective_mass(const impact *p)
{
    return p->m_a / (1.0 + p->m_a / p->m_b);
}

static dem_definition scene(const impact *p, double dt, dem_grain grains[2])
{
    const bool wall = isinf(p->m_b);
    const double gap = p->phase * p->v * dt, distance = R_A + (wall ? 0.0 : R_B) + gap;
    const double ux = 0.6, uy = 0.8; /* off the axes */
    const double share_a = wall ? 1.0 : p->m_b / (p->m_a + p->m_b), share_b = 1.0 - share_a;
    grains[0] = (dem_grain){0.0, 0.0, R_A, p->m_a, ux * p->v * share_a, uy * p->v * share_a};
    grains[1] =
        (dem_grain){ux * distance, uy * distance, R_B, p->m_b, -ux * p->v * share_b, -uy * p->v * share_b};
    dem_definition def =
        grains_bare(2 - wall, grains, p->law, (dem_material){.k_n = p->k_n, .gamma_n = p->gamma_n});
    def.tension = !p->clipped, def.dt = dt, def.n_walls = wall;
    def.walls[0] = grains_line(ux * distance, uy * distance, -ux, -uy, &def.material);
    return def;
}

/* The simulated impact; times of contact and separation are resolved within a step. Pairs still in contact
 * after `longest` have restitution 0. */
static outcome simulate(const impact *p, double dt, double longest)
{
    dem_grain grains[2];
    dem_definition def = scene(p, dt, grains);
    scoped_sim *sim = grains_start(&def);
    outcome o = {0.0, 0.0, INFINITY, 0.0};
    const bool wall = isinf(p->m_b);
    dem_state s[2];
    while (dem_time(sim) < longest) {
        CU_ASSERT_EQUAL_FATAL(dem_run(sim, 1), RP_OK);
        dem_states(sim, s);
        if (wall) s[1] = (dem_state){.x = def.walls[0].point[0], .y = def.walls[0].point[1]};
        const double x = s[1].x - s[0].x, y = s[1].y - s[0].y, r = hypot(x, y);
        const double closing = -((s[1].vx - s[0].vx) * x + (s[1].vy - s[0].vy) * y) / r;
        const double depth = R_A + (wall ? 0.0 : R_B) - r;
        o.overlap = fmax(o.overlap, depth);
        o.force = fmax(o.force, -(s[0].fx * x + s[0].fy * y) / r);
        if (depth <= 0.0 && closing < 0.0) {
            o.restitution = -closing / p->v;
            o.time = dem_time(sim) - p->phase * dt + depth / -closing; /* back to the moment of separation */
            break;
        }
    }
    return o;
}

/* Elastic: Hertz overlap (5 m v^2/(4 k))^(2/5), time 2.9432 overlap/v (the constant is
 * 4/5 sqrt(pi) Gamma(2/5)/Gamma(9/10)); linear overlap v/w, time pi/w, w^2 = k/m. */
static outcome elastic_exact(const impact *p)
{
    const double m = effective_mass(p);
    if (p->law == DEM_LINEAR) {
        const double w = sqrt(p->k_n / m), deepest = p->v / w;
        return (outcome){1.0, deepest, M_PI / w, p->k_n * deepest};
    }
    const double deepest = pow(1.25 * m * p->v * p->v / p->k_n, 0.4);
    return (outcome){1.0, deepest, 0.8 * sqrt(M_PI) * gsl_sf_gamma(0.4) / gsl_sf_gamma(0.9) * deepest / p->v,
                     p->k_n * pow(deepest, 1.5)};
}

/* Largest rate of the elastic contact, sqrt(k_eff/m). */
static double stiffest(const impact *p)
{
    const double k = p->law == DEM_LINEAR ? p->k_n : 1.5 * p->k_n * sqrt(elastic_exact(p).overlap);
    return sqrt(k / effective_mass(p));
}

/* The linear law's overlap is v exp(-b t) sin(w t)/w, b = gamma/2, w^2 = k/m - b^2. The pair separates where
 * the overlap is 0. A force that may not attract ends earlier, where tan(w t) = -2 b w/(w0^2 - 2 b^2), and
 * the pair moves freely. Over-damped: hyperbolic functions; with attraction it never separates. */
static outcome linear_exact(const impact *p)
{
    const double m = effective_mass(p), b = 0.5 * p->gamma_n, w02 = p->k_n / m, w2 = w02 - b * b;
    const double w = sqrt(fabs(w2)), v = p->v;
    const double top = w2 > 0.0 ? atan2(w, b) / w : atanh(w / b) / w;
    double end = w2 > 0.0 ? M_PI / w : INFINITY;
    if (p->clipped)
        end = w2 > 0.0 ? atan2(2.0 * b * w, 2.0 * b * b - w02) / w
                       : atanh(2.0 * b * w / (2.0 * b * b - w02)) / w;
    const double s_top = w2 > 0.0 ? sin(w * top) : sinh(w * top);
    outcome o = {0.0, v * exp(-b * top) * s_top / w, INFINITY, NAN};
    if (isinf(end)) return o;
    const double s = w2 > 0.0 ? sin(w * end) : sinh(w * end), c = w2 > 0.0 ? cos(w * end) : cosh(w * end);
    const double speed = v * exp(-b * end) * (b / w * s - c),
                 left = p->clipped ? v * exp(-b * end) * s / w : 0.0;
    o.restitution = speed / v;
    o.time = end + left / speed;
    return o;
}

/* The expected outcome of a damped impact: closed form or, for Hertz, the solver of single impacts. */
static outcome damped_exact(const impact *p)
{
    if (p->law == DEM_LINEAR) return linear_exact(p);
    dem_collision_result c;
    CHECK_OK(
        dem_collision(&(dem_head_on){p->law, !p->clipped, p->k_n, p->gamma_n, effective_mass(p), p->v}, &c));
    return (outcome){c.restitution, c.overlap, c.time, NAN};
}

/* The dashpot of the scheme uses the velocity half a step earlier. To first order in h = gamma dt/2 the
 * scheme therefore solves the law with k and gamma larger by 1 + h. The dashpot force starts and ends up to
 * half a step early or late, which changes the speed by h. Second order: the kink of the spring at contact
 * and separation, and the curvature in h, which matters near the sticking threshold. A slowly separating pair
 * accumulates rounding of one sign in every step. */
static outcome damped_bound(const impact *p, const outcome *exact, double dt)
{
    const double h = 0.5 * p->gamma_n * dt, rate = fmax(stiffest(p), p->gamma_n) * dt, second = rate * rate;
    impact lag = *p, lag2 = *p, fast = *p;
    lag.k_n *= 1.0 + h, lag.gamma_n *= 1.0 + h;
    lag2.k_n *= 1.0 + 2.0 * h, lag2.gamma_n *= 1.0 + 2.0 * h;
    fast.v *= 1.0 + h;
    const double rounding = DBL_EPSILON * (R_A + R_B) / (exact->restitution * p->v * dt);
    const outcome l = damped_exact(&lag), l2 = damped_exact(&lag2), f = damped_exact(&fast);
#define FIRST_AND_SECOND(q)                                                                                  \
    (fabs(l.q - exact->q) + 0.5 * fabs(l2.q - 2.0 * l.q + exact->q) + second * exact->q)
    return (outcome){FIRST_AND_SECOND(restitution) + fabs((1.0 + h) * f.restitution - exact->restitution) +
                         (p->clipped ? 0.0 : h * exact->restitution) + second,
                     FIRST_AND_SECOND(overlap) + fabs(f.overlap - exact->overlap),
                     FIRST_AND_SECOND(time) + fabs(f.time - exact->time) + rounding * exact->time, NAN};
#undef FIRST_AND_SECOND
}

/* gamma_n (m_eff/k_n)^(2/5) v^(-1/5), beyond which grains of Hertz' law stick. */
static const double hertz_threshold = 1.12798813552017;

static case_problem
    elastic_problem = {"elastic", "closed forms", "w^2 dt^2: contact and separation within a step"},
    damped_problem = {"damped", "closed forms (linear); Runge-Kutta to 1e-13 (Hertz)",
                      "gamma dt/2 from the lag of the dashpot, from contact and from separation"},
    sticking_problem = {"sticking", "threshold 1.12799 (Hertz), critical damping (linear)",
                        "never separates"},
    solver_problem = {"single_impacts", "closed forms", "tolerance of the Runge-Kutta method"};

/* Calls `check` for every law, stiffness, mass, speed and partner, or for every `stride`th, with phases
 * uniform over the step. */
static void for_grid(int stride, void (*check)(impact *p))
{
    static const double stiffness[] = {1e4, 1.7e6, 3.1e8}, scale[] = {1.0, 0.0123},
                        speed[] = {0.53, 4.7, 47.0};
    for (int i = 0; i < 2 * 3 * 2 * 3 * 3; i += stride) {
        const int partner = i / 36 % 3;
        impact p = {.law = i % 2, .k_n = stiffness[i / 2 % 3], .v = speed[i / 12 % 3]};
        p.m_a = M_A * scale[i / 6 % 2];
        p.m_b = partner == 0 ? INFINITY : partner == 1 ? p.m_a : M_B * scale[i / 6 % 2];
        p.phase = fmod(0.381 + 0.6180339887 * i, 1.0);
        check(&p);
    }
}

static void check_elastic(impact *p)
{
    const outcome exact = elastic_exact(p);
    const double dt = exact.time / (check_full() ? 2000.0 : 500.0), bound = pow(stiffest(p) * dt, 2.0);
    const outcome o = simulate(p, dt, 2.0 * exact.time);
    case_near(&elastic_problem, "restitution", exact.restitution, o.restitution, bound,
              "%s k_n=%g m_eff=%g v=%g dt=%g phase=%.3f", dem_normal_descriptors[p->law].name, p->k_n,
              effective_mass(p), p->v, dt, p->phase);
    case_also(&elastic_problem, "overlap", exact.overlap, o.overlap, bound * exact.overlap);
    case_also(&elastic_problem, "time", exact.time, o.time, bound * exact.time);
    case_also(&elastic_problem, "force", exact.force, o.force, bound * exact.force);
}

static void elastic(void)
{
    for_grid(case_stride(7), check_elastic);
}

/* Damping in units of the contact's rate: Hertz gamma (m/k)^(2/5) v^(-1/5), linear gamma/(2 sqrt(k/m)). */
static double damping_of(const impact *p, double number)
{
    const double m = effective_mass(p);
    return p->law == DEM_HERTZ ? number / (pow(m / p->k_n, 0.4) * pow(p->v, -0.2))
                               : number * 2.0 * sqrt(p->k_n / m);
}

static void check_damped(impact *p)
{
    static const double numbers[] = {0.01, 0.1, 0.4, 0.8, 0.97, 1.6, 5.0};
    for (int i = 0; i < 2 * 7; i++) {
        const double number = numbers[i / 2];
        p->clipped = i % 2;
        p->gamma_n = damping_of(p, number);
        if (!p->clipped && number > 1.0) continue; /* sticks */
        const outcome exact = damped_exact(p);
        const double dt = elastic_exact(p).time / (check_full() ? 2000.0 : 500.0) / fmax(1.0, 2.0 * number);
        const outcome o = simulate(p, dt, 4.0 * exact.time), bound = damped_bound(p, &exact, dt);
        case_near(&damped_problem, "restitution", exact.restitution, o.restitution, bound.restitution,
                  "%s %s damping=%g k_n=%g m_eff=%g v=%g dt=%g phase=%.3f",
                  dem_normal_descriptors[p->law].name, p->clipped ? "pushes" : "pulls", number, p->k_n,
                  effective_mass(p), p->v, dt, p->phase);
        case_also(&damped_problem, "overlap", exact.overlap, o.overlap, bound.overlap);
        case_also(&damped_problem, "time", exact.time, o.time, bound.time);
    }
}

static void damped(void)
{
    for_grid(case_stride(17), check_damped);
}

/* Beyond the threshold a pair with attractive forces stays in contact; a pair with repulsive forces only
 * always separates. Bisection with the solver of single impacts gives the threshold. */
static void check_sticking(impact *p)
{
    const double limit = p->law == DEM_HERTZ ? hertz_threshold : 1.0;
    for (int side = -1; side <= 1; side += 2) {
        p->gamma_n = damping_of(p, (1.0 + 0.01 * side) * limit);
        const double t = elastic_exact(p).time, dt = t / 1000.0;
        const outcome o = simulate(p, dt, side < 0 ? 40.0 * t : 5.0 * t);
        const outcome exact = side < 0 ? damped_exact(p) : (outcome){0.0, NAN, INFINITY, NAN};
        case_near(&sticking_problem, "restitution", exact.restitution, o.restitution,
                  side < 0 ? damped_bound(p, &exact, dt).restitution : 0.0,
                  "%s damping=%g of the threshold k_n=%g m_eff=%g v=%g dt=%g",
                  dem_normal_descriptors[p->law].name, 1.0 + 0.01 * side, p->k_n, effective_mass(p), p->v,
                  dt);
    }
}

static void sticking(void)
{
    for_grid(case_stride(5), check_sticking);
    double parts = 1.1, sticks = 1.2;
    for (int i = 0; i < (check_fast() ? 8 : 16); i++) {
        const double s = 0.5 * (parts + sticks);
        dem_collision_result c;
        CHECK_OK(dem_collision(&(dem_head_on){DEM_HERTZ, true, 1.0, s, 1.0, 1.0}, &c));
        *(c.restitution > 0.0 ? &parts : &sticks) = s;
    }
    /* half a unit of the last printed digit, and the bisection */
    case_near(&sticking_problem, "threshold", hertz_threshold, 0.5 * (parts + sticks),
              0.5e-5 + sticks - parts, "hertz, bisection with single impacts");
    const double stick = dem_normal_descriptors[DEM_HERTZ].sticking_speed(1e6, 500.0, M_EFF);
    case_near(&sticking_problem, "sticking speed", hertz_threshold,
              500.0 * pow(M_EFF / 1e6, 0.4) * pow(stick, -0.2), 1e-13, "hertz, dem_sticking_speed");
}

/* The solver with dominant damping: linear impacts in closed form, and continuity at a damping of 1e4, above
 * which the solver uses the limit. */
static void strong_damping(void)
{
    for (int clipped = 0; clipped < 2; clipped++) {
        for (double damping = 9.0; damping < 1e9; damping *= damping < 2e4 ? 1.9 : 1e3) {
            const impact p = {DEM_LINEAR, 1.0, damping, 1.0, clipped == 1, 2.0, 2.0, 0.0};
            const outcome exact = linear_exact(&p);
            dem_collision_result c;
            CHECK_OK(dem_collision(&(dem_head_on){DEM_LINEAR, !clipped, 1.0, damping, 1.0, 1.0}, &c));
            CU_ASSERT(clipped ? isfinite(c.time) : c.restitution == 0.0 && isinf(c.time));
            if (damping > 1e4) { /* the closed form loses its digits; its limit */
                const double less = (2.0 * log(damping) - 1.0) / (damping * damping);
                CHECK_NEAR(c.overlap * damping, 1.0 - less, 5e-7);
                CHECK_NEAR(c.restitution * damping * damping, clipped * (1.0 - 2.0 * less), 5e-7);
                continue;
            }
            CHECK_NEAR(c.overlap / exact.overlap, 1.0, 1e-6); /* a parabola's top */
            /* the closed form is a difference of numbers of about 1 */
            CHECK_NEAR(c.restitution, exact.restitution, 1e-6 * exact.restitution + 1e-13);
        }
        for (int law = DEM_HERTZ; law <= DEM_LINEAR; law++) {
            dem_collision_result below, above;
            CHECK_OK(dem_collision(&(dem_head_on){law, !clipped, 1.0, 1e4 * (1.0 - 1e-9), 1.0, 1.0}, &below));
            CHECK_OK(dem_collision(&(dem_head_on){law, !clipped, 1.0, 1e4 * (1.0 + 1e-9), 1.0, 1.0}, &above));
            CHECK_NEAR(above.overlap / below.overlap, 1.0, 1e-6);
            CHECK_NEAR(above.restitution, below.restitution, 1e-6 * below.restitution);
            if (clipped) CHECK_NEAR(above.time / below.time, 1.0, 1e-6);
        }
    }
    /* slightly over-damped: the overlap decays through subnormal numbers, and ends */
    dem_collision_result c;
    CHECK_OK(dem_collision(&(dem_head_on){DEM_LINEAR, true, 1.0, 2.2, 1.0, 1.0}, &c));
    CU_ASSERT(c.restitution == 0.0 && isinf(c.time));
}

/* The solver of single impacts against the closed forms. */
static void check_solver(impact *p)
{
    for (int i = 0; i < 4; i++) {
        static const double numbers[] = {0.0, 0.1, 0.7, 2.0};
        p->gamma_n = damping_of(p, numbers[i]);
        for (int clipped = 0; clipped < 2; clipped++) {
            p->clipped = clipped;
            if ((p->law == DEM_HERTZ && i > 0) || (i == 3 && !clipped)) continue;
            const outcome exact = p->law == DEM_HERTZ ? elastic_exact(p) : linear_exact(p);
            dem_collision_result c;
            CHECK_OK(dem_collision(
                &(dem_head_on){p->law, !clipped, p->k_n, p->gamma_n, effective_mass(p), p->v}, &c));
            /* some 1e2 to 1e3 adaptive steps of 1e-13; the largest overlap comes from a parabola through a
             * step of 0.01: some 1e-6 */
            case_near(&solver_problem, "restitution", exact.restitution, c.restitution, 1e-10,
                      "%s %s damping=%g k_n=%g m_eff=%g v=%g", dem_normal_descriptors[p->law].name,
                      clipped ? "pushes" : "pulls", numbers[i], p->k_n, effective_mass(p), p->v);
            case_also(&solver_problem, "time", exact.time, c.time, 1e-10 / exact.restitution * exact.time);
            case_also(&solver_problem, "overlap", exact.overlap, c.overlap, 2e-6 * exact.overlap);
        }
    }
}

static void single_impacts(void)
{
    for_grid(case_stride(11), check_solver);
    dem_collision_result c;
    CHECK_FAILS(dem_collision(&(dem_head_on){DEM_HERTZ, true, 1e6, 500.0, M_EFF, 0.0}, &c), RP_BAD_INPUT,
                "v = 0");
}

/* Damping from light to over-damped, with and without attractive forces, as a table for the figure. */
static void damping_range(void)
{
    for (int law = DEM_HERTZ; law <= DEM_LINEAR; law++) {
        CHECK_TABLE(out, law == DEM_HERTZ ? "impact_hertz" : "impact_linear", NULL);
        if (!out) return;
        rp_table_note(out, "steps", "1000 per elastic contact time, at least 1000/(2 damping) per 1/gamma");
        rp_table_header(out, RP_CGS,
                        "damping [1], pulls_exact [1], pulls [1], pulls_error [1], pulls_bound [1], "
                        "pushes_exact [1], pushes [1], pushes_error [1], pushes_bound [1]");
        for (int i = 0; i <= 48; i++) {
            impact p = {.law = law, .k_n = 1e6, .v = 12.3, .m_a = M_A, .m_b = M_B};
            p.phase = fmod(0.6180339887 * i, 1.0);
            const double number = 0.01 * pow(10.0, i / 16.0);
            double row[9] = {number};
            p.gamma_n = damping_of(&p, number);
            const double t = elastic_exact(&p).time, dt = t / 1000.0 / fmax(1.0, 2.0 * number);
            for (int clipped = 0; clipped < 2; clipped++) {
                p.clipped = clipped;
                const bool sticks = !clipped && number > (law == DEM_HERTZ ? hertz_threshold : 1.0 - 1e-12);
                const outcome exact = sticks ? (outcome){.time = INFINITY} : damped_exact(&p);
                double *r = row + 1 + 4 * clipped;
                r[0] = exact.restitution;
                r[1] = simulate(&p, dt, fmin(4.0 * exact.time, 5.0 * t * fmax(1.0, number * number)))
                           .restitution;
                r[2] = fabs(r[1] - r[0]);
                r[3] = sticks ? NAN : damped_bound(&p, &exact, dt).restitution;
                CU_ASSERT(r[2] <= (sticks ? 0.0 : r[3]));
            }
            rp_table_row(out, 9, row);
        }
    }
}

CASES(impact, &elastic_problem, &damped_problem, &sticking_problem, &solver_problem)

CHECK_SUITE_SUMMED(impact, "validation: impacts", elastic, damped, sticking, single_impacts, strong_damping,
                   damping_range, cases)
