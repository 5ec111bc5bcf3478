/* Validation of lasting and interacting contacts: a bounce under gravity, grains compressed between walls,
 * columns at rest, Newton's cradles. */
#include <float.h>
#include <gsl/gsl_errno.h>
#include <gsl/gsl_odeiv2.h>

#include "dem/law/law.h"
#include "tests/grains.h"
#include "validation/cases.h"

enum { MOST = 10 };

static case_problem bounce_problem = {"bounce", "closed form (linear), energy (Hertz)",
                                      "w^2 dt^2; damped also gamma dt from contact, lag and separation"},
                    stack_problem = {"stack", "force balance",
                                     "remaining net force and damping on the grains"},
                    column_problem = {"column", "weight above",
                                      "remaining net force and damping on the grains"},
                    cradle_problem = {"cradle", "Runge-Kutta to 1e-13; linear three: also closed form",
                                      "w^2 dt^2 for each contact and separation"},
                    gap_problem = {"cradle_gaps", "exchange of velocities",
                                   "w^2 dt^2 for each contact and separation"};

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

/* v^2/2 after a Hertz spring of k/m and gravity have acted over an overlap. */
static double hertz_energy(double overlap, const void *data)
{
    const bouncing *p = data;
    return 0.5 * p->v * p->v + p->g * overlap - 0.4 * p->w02 * pow(overlap, 2.5);
}

/* A grain falls on a floor with speed v = g/(w0 heavy), where `heavy` measures the effect of gravity during
 * contact. Observed: speed at separation, largest overlap, contact time. */
static void drop(int law, const bouncing *p, double k, double m, double gamma, double dt, double phase,
                 double observed[3])
{
    const double r = 0.1193, before = (3.0 + phase) * dt; /* it starts a few steps before contact */
    dem_grain grain = {0.0, r + (p->v - 0.5 * p->g * before) * before, r, m, 0.0, -(p->v - p->g * before)};
    dem_definition def = grains_bare(1, &grain, law, (dem_material){.k_n = k, .gamma_n = gamma});
    def.gravity[1] = -p->g, def.dt = dt;
    grains_on_floor(&def, 1, &grain);
    scoped_sim *sim = grains_start(&def);
    dem_state s = {0};
    observed[0] = observed[2] = NAN;
    observed[1] = 0.0;
    for (long step = 0; step < 20000 && !(s.y >= r && s.vy > 0.0); step++) {
        CU_ASSERT_EQUAL_FATAL(dem_run(sim, 1), RP_OK);
        s = grains_state_of_one(sim);
        observed[1] = fmax(observed[1], r - s.y);
    }
    const double since = (s.y - r) / s.vy; /* to second order */
    observed[0] = s.vy + p->g * since;
    observed[2] = dem_time(sim) - since - before;
}

static void check_bounce(double heavy, double damping, double k, double m, double phase)
{
    static const char *const names[] = {"speed", "overlap", "time"};
    const double g = 981.0, w0 = sqrt(k / m), v = g / (w0 * heavy), dt = M_PI / w0 / 2000.0;
    const bouncing p = {g, w0 * w0, damping * w0, v};
    const double half = M_PI / (w0 * sqrt(1.0 - damping * damping));
    const double top = root(bounce_speed, &p, 0.0, half), end = root(bounce_overlap, &p, top, top + half);
    const double out = -bounce_speed(end, &p), expected[] = {out, bounce_overlap(top, &p), end};
    double observed[3];
    drop(DEM_LINEAR, &p, k, m, 2.0 * p.b, dt, phase, observed);
    /* it separates at speed `out`: a change v of speed changes the end by v/out */
    const double first = 2.0 * p.b * dt, second = pow(w0 * dt, 2.0) * (1.0 + heavy);
    const double scale[] = {v, expected[1], end * v / out};
    for (int q = 0; q < 3; q++)
        case_near(&bounce_problem, names[q], expected[q], observed[q], (1.5 * first + second) * scale[q],
                  "linear g/(w0 v)=%g damping=%g k_n=%g m=%g dt=%g", heavy, damping, k, m, dt);
    if (damping > 0.0) return;
    const double deepest = root(hertz_energy, &p, 0.0, 0.1), w2 = 1.5 * p.w02 * sqrt(deepest);
    const double hertz_dt = M_PI / sqrt(w2) / 2000.0, bound = w2 * hertz_dt * hertz_dt;
    drop(DEM_HERTZ, &p, k, m, 0.0, hertz_dt, phase, observed);
    case_near(&bounce_problem, "speed", v, observed[0], bound * v, "hertz v=%g k_n=%g m=%g dt=%g", v, k, m,
              hertz_dt);
    case_also(&bounce_problem, "overlap", deepest, observed[1], bound * deepest);
}

static void bounce(void)
{
    static const double heavies[] = {0.003, 0.03, 0.2, 0.5}, dampings[] = {0.0, 0.02, 0.1},
                        stiffness[] = {1e5, 3.1e6}, masses[] = {0.0042, 0.0131};
    const int stride = case_stride(5);
    for (int i = 0; i < 4 * 3 * 2 * 2; i += stride)
        check_bounce(heavies[i % 4], dampings[i / 4 % 3], stiffness[i / 12 % 2], masses[i / 24],
                     fmod(0.381 + 0.6180339887 * i, 1.0));
}

/* Run until net forces and dashpot forces, gamma m v each, are at most `most`; returns their largest sum. */
static double settle(dem_sim *sim, double gamma, double most)
{
    dem_state s[MOST];
    double left = INFINITY;
    for (int i = 0; i < 400 && !(left <= most); i++) {
        grains_run(sim, 2000, s);
        left = 0.0;
        for (size_t k = 0; k < dem_count(sim); k++)
            left = fmax(left, hypot(s[k].fx, s[k].fy) + 2.0 * gamma * s[k].m * hypot(s[k].vx, s[k].vy));
    }
    CU_ASSERT(left <= most);
    return left;
}

/* Grains in a column between a floor and, if `lid` is finite, a wall above, all damped; contact forces from
 * below upwards. The contact under grain i is that of the floor or of grains i - 1 and i. */
static double compress(int law, double k, double k_wall, size_t n, const dem_grain *grains, double lid,
                       double force[MOST + 1])
{
    dem_definition def = grains_bare(n, grains, law, (dem_material){.k_n = k});
    double heaviest = 0.0;
    for (size_t i = 0; i < n; i++) heaviest = fmax(heaviest, grains[i].m);
    def.gravity[1] = -981.0, def.n_walls = 1 + isfinite(lid);
    def.walls[0] = grains_line(0.0, 0.0, 0.0, 1.0, &def.material);
    def.walls[1] = grains_line(0.0, lid, 0.0, -1.0, &def.material);
    def.walls[0].material.k_n = def.walls[1].material.k_n = k_wall;
    /* damping that makes the slow modes of the column decay fast */
    def.dt = 0.2 * dem_time_step_limit(&def, NULL);
    def.material.gamma_n = def.walls[0].material.gamma_n = def.walls[1].material.gamma_n = 0.2 / def.dt;
    scoped_sim *sim = grains_start(&def);
    /* positions are rounded: the force is uncertain by the last digit times the stiffness, and motion below
     * that digit per step stops at any dashpot force */
    const double digit = 2.0 * DBL_EPSILON * grains[n - 1].y, stiff = 0.1 * heaviest / (def.dt * def.dt);
    const double left =
        settle(sim, def.material.gamma_n,
               1e-9 * heaviest * 981.0 + (stiff + def.material.gamma_n * heaviest / def.dt) * digit);
    size_t n_contacts;
    scoped dem_contact *contacts = grains_contacts(sim, &n_contacts);
    CU_ASSERT_EQUAL(n_contacts, n - 1 + def.n_walls);
    for (size_t c = 0; c < n_contacts; c++) {
        const size_t lower = contacts[c].wall == 0   ? 0
                             : contacts[c].wall == 1 ? n
                                                     : (size_t)fmin(contacts[c].id_a, contacts[c].id_b);
        force[lower] = contacts[c].normal_force;
    }
    return left + stiff * digit;
}

/* Two grains pressed together by floor and lid: overlaps at the forces F, F + m_2 g, F + (m_1 + m_2) g add up
 * to the sum of diameters minus the distance of the walls. */
typedef struct {
    int law;
    double k, k_wall, m1, m2, taken;
} stacked;

static double stack_overlap(double lid_force, const void *data)
{
    const stacked *s = data;
    return overlap_of(s->law, s->k_wall, lid_force) + overlap_of(s->law, s->k, lid_force + s->m2 * 981.0) +
           overlap_of(s->law, s->k_wall, lid_force + (s->m1 + s->m2) * 981.0) - s->taken;
}

static void stack(void)
{
    static const double stiffness[] = {1e5, 1e6, 2.3e7}, ratios[] = {0.1, 1.0, 10.0}, squeezes[] = {0.1, 0.3};
    const int stride = case_stride(3);
    for (int i = 0; i < 3 * 3 * 2 * 2; i += stride) {
        const double r = 0.1, m = 0.0042;
        stacked s = {i % 2, stiffness[i / 2 % 3],  2.0 * stiffness[i / 2 % 3],
                     m,     m * ratios[i / 6 % 3], r * squeezes[i / 18]};
        const double top = root(stack_overlap, &s, 0.0, s.k);
        const dem_grain grains[2] = {{0.0, r - 0.25 * s.taken, r, s.m1, 0.0, 0.0},
                                     {0.0, 3.0 * r - 0.75 * s.taken, r, s.m2, 0.0, 0.0}};
        double force[MOST + 1];
        const double net = compress(s.law, s.k, s.k_wall, 2, grains, 4.0 * r - s.taken, force);
        const double expected[] = {top + (s.m1 + s.m2) * 981.0, top + s.m2 * 981.0, top};
        static const char *const names[] = {"force below", "force between", "force above"};
        /* a force d on each grain changes the force of each of the three springs by at most d */
        for (int q = 0; q < 3; q++)
            case_near(&stack_problem, names[q], expected[q], force[q], 2.0 * net,
                      "%s k_n=%g m2/m1=%g squeeze=%g", dem_normal_descriptors[s.law].name, s.k, s.m2 / s.m1,
                      s.taken);
    }
}

/* Columns of 1 to 10 grains of unequal masses: each contact carries the weight above. */
static void column(void)
{
    static const double stiffness[] = {1e5, 1e6, 3.1e7};
    static const size_t counts[] = {1, 2, 3, 5, 10};
    const int stride = case_stride(3);
    for (int i = 0; i < 2 * 3 * 5; i += stride) {
        const double r = 0.1193, k = stiffness[i / 2 % 3];
        const size_t n = counts[i / 6];
        dem_grain grains[MOST];
        double force[MOST + 1], above = 0.0;
        for (size_t j = 0; j < n; j++)
            grains[j] =
                (dem_grain){0.5, r * (2.0 * (double)j + 1.0), r, 0.00471 * (1.0 + (double)(j % 3)), 0.0, 0.0};
        const double net = compress(i % 2, k, 2.0 * k, n, grains, INFINITY, force);
        for (size_t j = n; j-- > 0;) {
            above += grains[j].m * 981.0;
            case_near(&column_problem, "force", above, force[j], (double)n * net,
                      "%s k_n=%g grains=%zu contact=%zu", dem_normal_descriptors[i % 2].name, k, n, j);
        }
    }
}

/* A cradle of n equal grains in a row, hit by the first `launched` at speed v; initial values and spring
 * rates of the overlaps, for the reference. */
typedef struct {
    int law, n;
    double k, m;
} cradle;

static int cradle_rates(double t, const double y[], double rate[], void *data)
{
    (void)t;
    const cradle *c = data;
    for (int i = 0; i < c->n; i++) rate[i] = y[c->n + i], rate[c->n + i] = 0.0;
    for (int i = 0; i + 1 < c->n; i++) {
        const double f = elastic_force(c->law, c->k, y[i] - y[i + 1]) / c->m;
        rate[c->n + i] -= f;
        rate[c->n + i + 1] += f;
    }
    return GSL_SUCCESS;
}

/* Speeds after `time`, by a method independent of the simulator; displacements relative to zero overlap. */
static void cradle_reference(const cradle *c, int launched, double v, double time, double speeds[])
{
    double y[2 * MOST] = {0.0}, t = 0.0;
    for (int i = 0; i < launched; i++) y[c->n + i] = v;
    gsl_odeiv2_system system = {cradle_rates, NULL, (size_t)(2 * c->n), (void *)c};
    gsl_odeiv2_driver *driver =
        gsl_odeiv2_driver_alloc_y_new(&system, gsl_odeiv2_step_rk8pd, 1e-4 * time, 1e-13 * v * time, 1e-13);
    CU_ASSERT_PTR_NOT_NULL_FATAL(driver);
    CU_ASSERT_EQUAL(gsl_odeiv2_driver_apply(driver, &t, time, y), GSL_SUCCESS);
    gsl_odeiv2_driver_free(driver);
    for (int i = 0; i < c->n; i++) speeds[i] = y[c->n + i];
}

static void cradle_simulate(const cradle *c, int launched, double v, double gap, double dt, double time,
                            double speeds[])
{
    const double r = 0.1;
    dem_grain grains[MOST];
    for (int i = 0; i < c->n; i++)
        grains[i] = (dem_grain){i * (2.0 * r + gap), 0.0, r, c->m, i < launched ? v : 0.0, 0.0};
    dem_definition def = grains_bare((size_t)c->n, grains, c->law, (dem_material){.k_n = c->k});
    def.dt = dt;
    scoped_sim *sim = grains_start(&def);
    dem_state s[MOST];
    grains_run(sim, lround(time / dt), s);
    for (int i = 0; i < c->n; i++) speeds[i] = s[i].vx;
}

/* Linear springs, three grains, one launched: the overlaps are the half sum and difference of v sin(w t)/w
 * and v sin(sqrt 3 w t)/(sqrt 3 w) until the first contact opens; then two grains separate at sqrt 2 w. */
static double first_overlap(double wt, const void *data)
{
    (void)data;
    return sin(wt) + sin(sqrt(3.0) * wt) / sqrt(3.0);
}

static void three_linear(double v, double speeds[3])
{
    const double t = root(first_overlap, NULL, 1.0, 4.0), s = sqrt(3.0);
    const double rate_sum = cos(t), rate_difference = cos(s * t);
    const double x2 = 0.5 * (sin(t) - sin(s * t) / s), rate2 = 0.5 * (rate_sum - rate_difference);
    /* v_1 = v - integral of x1, and so on: from the momentum and the rates of the overlaps */
    const double rate1 = 0.5 * (rate_sum + rate_difference), v2 = (1.0 - rate1 + rate2) / 3.0;
    const double pair = 0.5 * (v2 + v2 - rate2), swing = sqrt(rate2 * rate2 + 2.0 * x2 * x2);
    speeds[0] = v * (v2 + rate1);
    speeds[1] = v * (pair - 0.5 * swing);
    speeds[2] = v * (pair + 0.5 * swing);
}

static void check_cradle(int i)
{
    static const int counts[] = {3, 5, 9};
    static const double speeds[] = {0.5, 20.0};
    const cradle c = {i % 2, counts[i / 2 % 3], i / 6 % 2 ? 3.1e7 : 1e6, 0.0042};
    const double v = speeds[i / 12 % 2];
    const int launched = 1 + i / 24;
    const double m_eff = 0.5 * c.m, deepest = pow(1.25 * m_eff * v * v / c.k, 0.4);
    const double w = c.law == DEM_HERTZ ? sqrt(1.5 * c.k * sqrt(deepest) / m_eff) : sqrt(c.k / m_eff);
    const double dt = 1e-3 / w, time = 10.0 * c.n / w, bound = 2.0 * (c.n - 1) * pow(w * dt, 2.0) * v;
    double expected[MOST], observed[MOST];
    cradle_reference(&c, launched, v, time, expected);
    cradle_simulate(&c, launched, v, 0.0, dt, time, observed);
    for (int j = 0; j < c.n; j++)
        case_near(&cradle_problem, "speed", expected[j], observed[j], bound,
                  "%s grains=%d launched=%d k_n=%g v=%g dt=%g grain=%d", dem_normal_descriptors[c.law].name,
                  c.n, launched, c.k, v, dt, j);
    if (c.law == DEM_LINEAR && c.n == 3 && launched == 1) {
        double exact[3];
        three_linear(v, exact);
        for (int j = 0; j < 3; j++)
            case_near(&cradle_problem, "speed", exact[j], observed[j], bound,
                      "linear, closed form, k_n=%g v=%g dt=%g grain=%d", c.k, v, dt, j);
    }
    /* a grain moves by less than 2 overlaps during a collision: with wider gaps each collision ends before
     * the next, and the momentum passes through the row */
    const double gap = 4.0 * (c.law == DEM_HERTZ ? deepest : v / w);
    cradle_simulate(&c, launched, v, gap, dt, time + (c.n + 1) * gap / v, observed);
    for (int j = 0; j < c.n && launched == 1; j++)
        case_near(&gap_problem, "speed", j == c.n - 1 ? v : 0.0, observed[j], bound,
                  "%s grains=%d k_n=%g v=%g gap=%g dt=%g grain=%d", dem_normal_descriptors[c.law].name, c.n,
                  c.k, v, gap, dt, j);
}

static void cradles(void)
{
    const int stride = case_stride(2);
    for (int i = 0; i < 48; i += stride) check_cradle(i);
}

CASES(contacts, &bounce_problem, &stack_problem, &column_problem, &cradle_problem, &gap_problem)

CHECK_SUITE_SUMMED(contacts, "validation: lasting contacts", bounce, stack, column, cradles, cases)
