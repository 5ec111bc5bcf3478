/* Error against run time (work-precision): cost of accuracy with each integrator and solver, and the fastest
 * for each accuracy. References are at least ten times more accurate than any result in the tables, each by
 * two methods. Times are processor time, least of several; no test depends on them. */
#include <gsl/gsl_errno.h>
#include <gsl/gsl_odeiv2.h>

#include "core/clock.h"
#include "table/table.h"
#include "dem/state/method.h"
#include "tests/grains.h"
#include "validation/solved_pile.h"

static const double DECADES = 11.0 / 3.0; /* of time steps */

/* ---- Outcomes, and their Pareto front ---- */

typedef struct {
    double setting, error, seconds;
    char method[48]; /* PROBLEM/METHOD */
} outcome;

enum { MAX_OUTCOMES = 400 };
typedef struct {
    size_t n, front_from; /* first row of the current problem */
    outcome row[MAX_OUTCOMES];
    bool front[MAX_OUTCOMES];
} outcomes;

static void add(outcomes *o, const char *problem, const char *method, double setting, double error,
                double seconds)
{
    CU_ASSERT_FATAL(o->n < MAX_OUTCOMES);
    outcome *r = &o->row[o->n++];
    *r = (outcome){setting, error, seconds, ""};
    snprintf(r->method, sizeof r->method, "%s/%s", problem, method);
    CU_ASSERT(isfinite(error));
}

/* The Pareto front: outcomes that no other beats in error or time without being worse in the other. */
static void mark_front(outcomes *o)
{
    for (size_t i = o->front_from; i < o->n; i++) {
        const outcome *a = &o->row[i];
        o->front[i] = true;
        for (const outcome *b = o->row + o->front_from; b < o->row + o->n; b++)
            o->front[i] &= b->seconds > a->seconds || b->error > a->error ||
                           (b->seconds == a->seconds && b->error == a->error);
    }
    o->front_from = o->n;
}

/* The fastest of `n` outcomes with an error of at most `target`, excluding the method of `besides` (may be
 * NULL); NULL if none. */
static const outcome *quickest(const outcome row[], size_t n, double target, const outcome *besides)
{
    const outcome *best = NULL;
    for (const outcome *r = row; r < row + n; r++)
        if (r->error <= target && (!besides || strcmp(r->method, besides->method) != 0) &&
            (!best || r->seconds < best->seconds))
            best = r;
    return best;
}

/* Notes for each problem and target: the fastest method and its setting, and the second fastest. */
static void note_cheapest(FILE *out, const outcomes *o, const char *setting)
{
    static const double targets[] = {1e-2, 1e-3, 1e-6, 1e-9};
    for (size_t from = 0, to; from < o->n; from = to) {
        const size_t length = strcspn(o->row[from].method, "/") + 1;
        for (to = from; to < o->n && strncmp(o->row[to].method, o->row[from].method, length) == 0;) to++;
        for (int k = 0; k < 4; k++) {
            const outcome *best = NULL;
            for (int rank = 0; rank < 2; rank++) {
                const char *key = check_text("%s_%.*s_%.0e", rank ? "next" : "cheapest", (int)length - 1,
                                             o->row[from].method, targets[k]);
                best = quickest(o->row + from, to - from, targets[k], best);
                if (best)
                    rp_table_note(out, key, "%s %.2g s (%s = %.2g)", best->method + length, best->seconds,
                                  setting, best->setting);
                else
                    rp_table_note(out, key, "none");
            }
        }
    }
}

static void write_outcomes(const outcomes *o, const char *name, const char *setting, const char *unit,
                           const char *error_unit)
{
    CHECK_TABLE(out, name, NULL);
    if (!out) return;
    rp_table_note(out, "seconds",
                  "processor time, least of several (one run if 0.5 s or more); front: on the Pareto front");
    note_cheapest(out, o, setting);
    const char *columns =
        check_text("%s [%s], error [%s], seconds [s], front, method", setting, unit, error_unit);
    rp_table_header(out, RP_CGS, columns);
    for (const outcome *r = o->row; r < o->row + o->n; r++)
        CHECK_ROW(out, r->method, r->setting, r->error, r->seconds, (double)o->front[r - o->row]);
}

/* Over all settings, the error of a method decreases at least with its order. Phases of the first and last
 * points change the slope between them by up to 0.3. */
static void check_gain(const outcomes *o, const char *problem, const char *integrator, double order)
{
    const outcome *first = NULL, *last = NULL;
    const char *method = check_text("%s/%s", problem, integrator);
    for (const outcome *r = o->row; r < o->row + o->n; r++) {
        if (strcmp(r->method, method) != 0) continue;
        if (!first) first = r;
        last = r;
    }
    CU_ASSERT_FATAL(first && first != last);
    CU_ASSERT(log(first->error / last->error) / log(first->setting / last->setting) > order - 0.3);
}

static void check_gains(const outcomes *o, const char *problem, double verlet, double gear5, double implicit)
{
    check_gain(o, problem, "verlet", verlet);
    check_gain(o, problem, "gear5", gear5);
    check_gain(o, problem, "implicit", implicit);
}

/* ---- Motion without friction, by the simulator and by adaptive Runge-Kutta on all pairs ---- */

typedef struct {
    const char *name;
    dem_definition def;
    double time, length; /* of the run; unit of the errors */
    double *answer;      /* x, y, v_x, v_y of each grain */
} motion;

static double push(const motion *p, const dem_material *c, double m_eff, double overlap, double closing)
{
    const double elastic = p->def.normal == DEM_HERTZ ? overlap * sqrt(overlap) : overlap;
    return c->k_n * elastic + c->gamma_n * m_eff * closing;
}

static int rates(double t, const double y[], double dydt[], void *context)
{
    (void)t;
    const motion *p = context;
    const dem_grain *g = p->def.grains;
    for (size_t i = 0; i < p->def.n_grains; i++) {
        const double *a = y + 4 * i;
        double *d = dydt + 4 * i;
        d[0] = a[2], d[1] = a[3];
        d[2] = p->def.gravity[0], d[3] = p->def.gravity[1];
        for (size_t w = 0; w < p->def.n_walls; w++) {
            const double *point = p->def.walls[w].point, *n = p->def.walls[w].direction;
            const double overlap = g[i].r - (a[0] - point[0]) * n[0] - (a[1] - point[1]) * n[1];
            if (overlap <= 0.0) continue;
            const double f =
                push(p, &p->def.walls[w].material, g[i].m, overlap, -a[2] * n[0] - a[3] * n[1]) / g[i].m;
            d[2] += f * n[0], d[3] += f * n[1];
        }
        for (size_t j = 0; j < i; j++) {
            const double *b = y + 4 * j, dx = a[0] - b[0], dy = a[1] - b[1], reach = g[i].r + g[j].r;
            if (dx * dx + dy * dy >= reach * reach) continue;
            const double r = sqrt(dx * dx + dy * dy), nx = dx / r, ny = dy / r;
            const double f = push(p, &p->def.material, g[i].m * g[j].m / (g[i].m + g[j].m), reach - r,
                                  (b[2] - a[2]) * nx + (b[3] - a[3]) * ny);
            d[2] += f * nx / g[i].m, d[3] += f * ny / g[i].m;
            dydt[4 * j + 2] -= f * nx / g[j].m, dydt[4 * j + 3] -= f * ny / g[j].m;
        }
    }
    return GSL_SUCCESS;
}

static double *integrate(motion *p, const gsl_odeiv2_step_type *type, double tolerance)
{
    const size_t n = p->def.n_grains;
    double *y = malloc(4 * n * sizeof *y), t = 0.0;
    for (size_t i = 0; i < n; i++) {
        const dem_grain *g = &p->def.grains[i];
        memcpy(y + 4 * i, (double[]){g->x, g->y, g->vx, g->vy}, 4 * sizeof *y);
    }
    gsl_odeiv2_system system = {rates, NULL, 4 * n, p};
    gsl_odeiv2_driver *driver =
        gsl_odeiv2_driver_alloc_y_new(&system, type, 1e-3 * p->time, tolerance, tolerance);
    CU_ASSERT_EQUAL(gsl_odeiv2_driver_apply(driver, &t, p->time, y), GSL_SUCCESS);
    gsl_odeiv2_driver_free(driver);
    return y;
}

/* Root mean square distance of the grains' positions. */
static double distance(const motion *p, const double a[], const double b[])
{
    double sum = 0.0;
    for (size_t i = 0; i < p->def.n_grains; i++)
        sum += pow(a[4 * i] - b[4 * i], 2) + pow(a[4 * i + 1] - b[4 * i + 1], 2);
    return sqrt(sum / (double)p->def.n_grains) / p->length;
}

/* Error of the simulator after `steps` steps, and its processor time. */
static double simulate(const motion *p, int integrator, long steps, double *seconds)
{
    const size_t n = p->def.n_grains;
    dem_definition def = p->def;
    def.integrator = integrator, def.dt = p->time / (double)steps;
    const double start = rp_cpu_clock();
    scoped_sim *sim = grains_after(&def, steps);
    *seconds = rp_cpu_clock() - start;
    scoped double *y = calloc(4 * n, sizeof *y);
    scoped dem_state *s = grains_states(sim);
    for (size_t i = 0; i < n; i++) y[4 * i] = s[i].x, y[4 * i + 1] = s[i].y;
    return distance(p, y, p->answer);
}

/* Root mean square of the error over `phases` numbers of steps within a tenth of each other, so that contact
 * and separation fall into all phases of a step; least time of several. */
static double measure(const motion *p, int integrator, double steps, int phases, double *seconds)
{
    const int least = check_full() ? 2 : 1, most = check_full() ? 7 : 1;
    double spent = 0.0, square = 0.0;
    *seconds = INFINITY;
    for (int k = 0; k < most && (k < least ? spent < 0.5 : spent < 0.1); k++) {
        double total = 0.0, s;
        square = 0.0;
        for (int phase = 0; phase < phases; phase++) {
            const double part = phases > 1 ? 0.95 + 0.1 * phase / phases : 1.0,
                         e = simulate(p, integrator, lround(part * steps), &s);
            square += e * e / phases;
            total += s;
        }
        spent += total;
        *seconds = fmin(*seconds, total / phases);
    }
    return sqrt(square);
}

static bool allowed(const motion *p, int integrator, double dt)
{
    scoped_sim *sim = NULL;
    dem_definition def = p->def;
    def.integrator = integrator, def.dt = dt;
    return dem_create(&def, &sim) == RP_OK;
}

/* All integrators over `decades` of the time step, downwards from about the largest allowed; the implicit one
 * starts `head_start` times higher. Runge-Kutta for the whole motion, a second method, agrees with the
 * reference; errors below ten times the difference of the two are left out. */
static void sweep_steps(motion *p, const gsl_odeiv2_step_type *type, double tolerance, double agree,
                        int phases, double decades, double head_start, outcomes *o)
{
    scoped double *other = integrate(p, type, tolerance);
    const double doubt = distance(p, other, p->answer);
    CHECK_NEAR(doubt, 0.0, agree);
    const double limit = dem_time_step_limit(&p->def, NULL);
    for (int integrator = 0; integrator < DEM_INTEGRATORS; integrator++) {
        const double largest = limit * (integrator == DEM_IMPLICIT ? head_start : 0.75);
        for (int k = 0; k <= lround(3.0 * decades); k++) {
            const double steps = ceil(p->time / largest * pow(10.0, k / 3.0)), dt = p->time / steps;
            if (!allowed(p, integrator, dt / 0.94)) continue; /* Gear's steps are smaller */
            double seconds;
            const double error = measure(p, integrator, steps, phases, &seconds);
            if (!(error < 10.0 * doubt))
                add(o, p->name, dem_schemes[integrator]->name, dt / limit, error, seconds);
        }
    }
    mark_front(o);
}

/* ---- Impacts of two grains ---- */

static const struct {
    const char *name;
    int normal;
    double k_n, gamma_n;
} laws[] = {{"hertz_elastic", DEM_HERTZ, 1e6, 0.0},
            {"hertz_damped", DEM_HERTZ, 1e6, 1500.0},
            {"linear_elastic", DEM_LINEAR, 8e4, 0.0},
            {"linear_damped", DEM_LINEAR, 8e4, 1500.0}};
enum { LAWS = sizeof laws / sizeof *laws };

static const double R = 0.1, M = 0.00419, SPEED = 30.0;

/* Restitution and contact time: for Hertz' elastic impact 2.943 delta/v by the beta function, for the linear
 * law half a period, for Hertz' damped impact from dem_collision. */
static dem_collision_result impact_of(int law)
{
    dem_collision_result c = {1.0, NAN, NAN};
    const double m = 0.5 * M, k = laws[law].k_n, g = laws[law].gamma_n;
    if (laws[law].normal == DEM_LINEAR) {
        c.time = M_PI / sqrt(k / m - 0.25 * g * g);
        c.restitution = exp(-0.5 * g * c.time);
    } else if (g == 0.0) {
        const double deepest = pow(1.25 * m * SPEED * SPEED / k, 0.4);
        c.time = 0.8 * deepest / SPEED * tgamma(0.4) * tgamma(0.5) / tgamma(0.9);
    } else {
        CHECK_OK(dem_collision(&(dem_head_on){DEM_HERTZ, true, k, g, m, SPEED}, &c));
    }
    return c;
}

/* Contact starts after 0.37 contact times; the free motion after separation lasts 0.2 contact times. */
static motion impact(int law, dem_grain grains[2])
{
    const dem_collision_result c = impact_of(law);
    const double gap = 0.37 * c.time * SPEED, after = R + 0.1 * c.restitution * SPEED * c.time;
    motion p = {laws[law].name,
                grains_bare(2, grains, laws[law].normal,
                            (dem_material){.k_n = laws[law].k_n, .gamma_n = laws[law].gamma_n}),
                1.57 * c.time, SPEED * c.time, malloc(8 * sizeof(double))};
    for (int i = 0; i < 2; i++) {
        const double side = i ? 1.0 : -1.0;
        grains[i] =
            (dem_grain){.x = side * (R + 0.5 * gap), .y = 1.0, .r = R, .m = M, .vx = -side * 0.5 * SPEED};
        memcpy(p.answer + 4 * i, (double[]){side * after, 1.0, 0.5 * side * c.restitution * SPEED, 0.0},
               4 * sizeof(double));
    }
    return p;
}

static void impacts(void)
{
    const double decades = check_full() ? DECADES : 2.0;
    outcomes o = {0};
    for (int law = 0; law < LAWS; law++) {
        dem_grain grains[2];
        motion p = impact(law, grains);
        sweep_steps(&p, gsl_odeiv2_step_rk8pd, 1e-13, 1e-12, check_full() ? 16 : 4, decades, 1.0, &o);
        const double order = laws[law].gamma_n > 0.0 ? 1.0 : 2.0;
        check_gains(&o, p.name, order, order, 2.0);
        free(p.answer);
    }
    write_outcomes(&o, "precision_impact", "dt", "limit", "speed*contact");
}

/* ---- A column under doubled gravity ---- */

enum { COLUMN = 10 };

/* A column with the overlaps of half its weight oscillates about twice these overlaps and decays. With a
 * floor twice as stiff and damped, the modes are sines of a chain held half a grain below its lower end, and
 * damping is proportional to stiffness. */
static void column_answer(const motion *p, const double sink[])
{
    const double k = p->def.material.k_n, m = M;
    double u[COLUMN] = {0.0};
    for (int mode = 0; mode < COLUMN; mode++) {
        const double angle = (2 * mode + 1) * M_PI / (2 * COLUMN), w = 2.0 * sqrt(k / m) * sin(0.5 * angle);
        const double decay = p->def.material.gamma_n * m * w * w / (4.0 * k), t = p->time;
        const double rest = w * w - decay * decay, q = sqrt(fabs(rest));
        const double swing =
            rest > 0.0 ? cos(q * t) + decay / q * sin(q * t) : cosh(q * t) + decay / q * sinh(q * t);
        double a = 0.0;
        for (int i = 0; i < COLUMN; i++) a += 2.0 / COLUMN * 0.5 * sink[i] * sin(angle * (i + 0.5));
        for (int i = 0; i < COLUMN; i++) u[i] += a * sin(angle * (i + 0.5)) * exp(-decay * t) * swing;
    }
    for (int i = 0; i < COLUMN; i++)
        memcpy(p->answer + 4 * i, (double[]){0.0, (2 * i + 1) * R - sink[i] + u[i], NAN, NAN},
               4 * sizeof(double));
}

static motion column(dem_grain grains[COLUMN])
{
    motion p = {"column", dem_definition_default(), 0.02, NAN, malloc(4 * COLUMN * sizeof(double))};
    const double k = 8e4, g = -p.def.gravity[1];
    double sink[COLUMN];
    for (int i = 0; i < COLUMN; i++) {
        const double load = (COLUMN - i) * M * g;
        sink[i] = i ? sink[i - 1] + load / k : 0.5 * load / k;
        grains[i] = (dem_grain){.y = (2 * i + 1) * R - 0.5 * sink[i], .r = R, .m = M};
    }
    p.length = sink[COLUMN - 1], p.def.normal = DEM_LINEAR, p.def.tangential = DEM_NONE;
    p.def.material = (dem_material){.k_n = k, .gamma_n = 2000.0};
    grains_on_floor(&p.def, COLUMN, grains);
    p.def.walls[0].material.k_n = 2.0 * k;
    column_answer(&p, sink);
    return p;
}

static void damped_column(void)
{
    const double decades = check_full() ? DECADES : 2.0;
    outcomes o = {0};
    dem_grain grains[COLUMN];
    motion p = column(grains);
    sweep_steps(&p, gsl_odeiv2_step_rk8pd, 1e-13, 1e-11, 1, decades, 10.0, &o);
    check_gains(&o, p.name, 1.0, 1.0, 2.0);
    write_outcomes(&o, "precision_column", "dt", "limit", "sink");
    free(p.answer);
}

/* ---- Settling ---- */

/* A box of 100 falling grains without friction; the run ends before chaos sets in. */
static void settling(void)
{
    outcomes o = {0};
    motion p = {"settling", grains_box(check_fast() ? 30 : 100, 2.0, 1, NULL), 0.03, 2.0 * R, NULL};
    p.def.tangential = DEM_NONE;
    p.def.material = (dem_material){.k_n = 1e6, .gamma_n = 500.0};
    const dem_material wall = {.k_n = 2e6, .gamma_n = 500.0};
    dem_box_walls(&p.def, 2.0, &wall);
    p.answer = integrate(&p, gsl_odeiv2_step_rk8pd, 1e-12);
    sweep_steps(&p, gsl_odeiv2_step_rkf45, 1e-12, 1e-9, 1, check_full() ? DECADES : 1.0, 3.0, &o);
    for (int i = 0; i < DEM_INTEGRATORS; i++) check_gain(&o, p.name, dem_schemes[i]->name, 1.0);
    write_outcomes(&o, "precision_settling", "dt", "limit", "diameter");
    free(p.answer);
}

/* ---- Static piles ---- */

/* The larger of the two; NaN if either is NaN. */
static double worse(double a, double b)
{
    return b > a || isnan(b) ? b : a;
}

/* Largest difference of the forces on the base from the static solution, m g. */
static double base_error(const solved_pile *pile, const dem_sim *sim)
{
    size_t n, base = 0;
    double worst = 0.0;
    scoped dem_contact *list = grains_contacts(sim, &n);
    scoped const dem_contact **under = calloc(pile->n, sizeof *under); /* each disk that stands on the base */
    for (size_t c = 0; c < n; c++)
        if (list[c].id_b == 0) under[list[c].id_a - 1] = &list[c];
    for (size_t i = 0; i < pile->n; i++) {
        if (!under[i]) continue;
        CU_ASSERT_FATAL(base < pile->k);
        const double N = under[i]->normal_force, H = -under[i]->shear_force;
        worst = worse(worst, hypot(N - pile->N[base], H - pile->H[base]));
        base++;
    }
    CU_ASSERT_EQUAL(base, pile->k);
    return worst;
}

/* Damped motion to rest: gamma and 1/dt in units of sqrt(K_s/m), steps of rising weight, and steps after. */
typedef struct {
    const char *method;
    int integrator;
    double gamma, dt;
    long load, steps;
    double agrees; /* agreement with the static solution at the end, m g */
} relaxation;

/* The error after each doubling of the steps since loading, and the largest net force, the tolerance of a
 * test for rest that would stop there. Returns the last error. */
static double relax_to_rest(const char *problem, const solved_pile *pile, const relaxation *w, outcomes *o)
{
    const size_t from = o->n;
    double error = NAN, seconds = 0.0;
    for (int repeat = 0; repeat < (check_full() ? 3 : 1) && (repeat < 1 || seconds < 0.5); repeat++) {
        const dem_definition def = solved_pile_scene(pile, w->integrator, w->gamma, w->dt);
        size_t row = from;
        double start = rp_cpu_clock();
        scoped_sim *sim = grains_start(&def);
        solved_pile_load(sim, w->load);
        seconds = rp_cpu_clock() - start;
        for (long done = 0, more = w->steps / 256; done < w->steps; done += more, more = done) {
            start = rp_cpu_clock();
            CHECK_OK(dem_run(sim, more));
            seconds += rp_cpu_clock() - start;
            dem_rest rest;
            CHECK_OK(dem_rest_state(sim, -INFINITY, INFINITY, &rest));
            error = base_error(pile, sim);
            if (repeat == 0)
                add(o, problem, w->method, rest.net_force, error, seconds);
            else
                o->row[row].seconds = fmin(o->row[row].seconds, seconds);
            row++;
        }
    }
    return error;
}

/* Time to solve a pile, and the difference of its forces from those of `other`, loaded in different steps. */
static void solve_in_time(const char *problem, long base, double alpha_deg, const solved_pile *other,
                          outcomes *o)
{
    double error = 0.0, seconds = INFINITY, residual = NAN;
    for (int repeat = 0; repeat < (check_full() ? 5 : 1); repeat++) {
        const double start = rp_cpu_clock();
        RP_ENDS(solved_pile_free) solved_pile pile = solved_pile_make(base, alpha_deg, other->eps, 1);
        seconds = fmin(seconds, rp_cpu_clock() - start);
        for (size_t i = 0; i < pile.k; i++)
            error = worse(error, hypot(pile.N[i] - other->N[i], pile.H[i] - other->H[i]));
        residual = pile.result.residual;
    }
    add(o, problem, "newton", residual, error, seconds);
}

/* Both methods give the same forces: after motion to rest, only the round-off of positions of some 50
 * relative to overlaps of some 1e-5 remains. */
static void static_piles(void)
{
    static const struct {
        const char *name;
        long base;
        double alpha_deg;
    } piles[] = {{"10", 4, 60.0}, {"1035", 45, 60.0}, {"5490", 180, 30.0}};
    static const relaxation relaxations[3][2] = {{{"verlet", DEM_VERLET, 2.0, 0.1, 2000, 8192, 1e-8},
                                                  {"implicit", DEM_IMPLICIT, 4.0, 1.0, 400, 1024, 1e-8}},
                                                 {{"verlet", DEM_VERLET, 2.0, 0.2, 40000, 256000, 1e-6},
                                                  {"implicit", DEM_IMPLICIT, 4.0, 1.0, 500, 256, INFINITY}},
                                                 {{"verlet", DEM_VERLET, 2.0, 0.2, 40000, 128000, 1e-5}}};
    outcomes o = {0};
    const size_t first = check_full() ? 1 : 0, last = check_full() ? 3 : 1;
    for (size_t k = first; k < last; k++) {
        RP_ENDS(solved_pile_free)
        solved_pile pile = solved_pile_make(piles[k].base, piles[k].alpha_deg, 1e-6, 8);
        solve_in_time(piles[k].name, piles[k].base, piles[k].alpha_deg, &pile, &o);
        CU_ASSERT(o.row[o.n - 1].error < 1e-8);
        for (const relaxation *w = relaxations[k]; w < relaxations[k] + 2 && w->method; w++)
            CU_ASSERT(relax_to_rest(piles[k].name, &pile, w, &o) < w->agrees);
        mark_front(&o);
    }
    write_outcomes(&o, "precision_pile", "net_force", "m*g", "m*g");
}

/* No outcome that is both slower (or as fast) and less accurate is on the front of its problem. */
static void fronts(void)
{
    static const double error[] = {1.0, 0.1, 0.2, 0.2, 0.01, 5.0}, seconds[] = {1.0, 3.0, 4.0, 2.0, 3.0, 9.0};
    static const bool front[] = {true, false, false, true, true, true};
    outcomes o = {0};
    for (int i = 0; i < 5; i++) add(&o, "one", "method", 1.0, error[i], seconds[i]);
    mark_front(&o);
    add(&o, "other", "method", 1.0, error[5], seconds[5]);
    mark_front(&o);
    for (int i = 0; i < 6; i++) CU_ASSERT_EQUAL(o.front[i], front[i]);
}

CHECK_SUITE(precision, "validation: precision", fronts, impacts, damped_column, settling, static_piles)
