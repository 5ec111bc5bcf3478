/* Observed order of every integrator on every law. A grain hits a wall, with a tangential velocity where the
 * law has a tangential part, and the rebound is compared with an independent solution. For each step size the
 * first contact falls into many phases of a step: a single phase may hide errors, as do steps that divide the
 * contact time exactly. Errors are root mean squares over the phases; the order is the slope of their
 * logarithm by least squares.
 *
 * Theory for a force that is not smooth at a contact within a step: a jump (damped law) gives an error of
 * first order, a kink (linear law, shear spring) of second, the exponent 3/2 of Hertz of order 5/2. Each
 * factor depends on the phase. */
#include <gsl/gsl_fit.h>

#include "dem/state/method.h"
#include "tests/grains.h"

/* Fitted errors: velocity and position after the rebound, and `integration` of the ledger. */
enum { VELOCITY, PLACE, INTEGRATION, N_ERRORS };

/* A law and its expected orders: with Verlet's scheme and, where different, with Gear's scheme and with the
 * contact located within the step. */
typedef struct {
    const char *name;
    int normal;
    double gamma_n;
    bool tension;
    double k_s, gamma_s, mu;
    double verlet[N_ERRORS];
} law;

static const double R = 0.1, M = 0.00419, V_N = 30.0, V_S = 20.0;

/* First order also without damping: a shear spring still loaded at the end of contact is a jump, and so is a
 * spring that grows by whole steps from the first one, unless slip resets it. The energy error of the scheme
 * does not contain either error of the dissipative forces: it has the order of a kink. */
static const law laws[] = {{"hertz_elastic", DEM_HERTZ, 0.0, true, 0.0, 0.0, 0.0, {2.5, 2.0, 2.5}},
                           {"hertz_pulls", DEM_HERTZ, 1500.0, true, 0.0, 0.0, 0.0, {1.0, 1.0, 2.0}},
                           {"hertz_clipped", DEM_HERTZ, 1500.0, false, 0.0, 0.0, 0.0, {1.0, 1.0, 2.0}},
                           {"hertz_sticks", DEM_HERTZ, 0.0, true, 1e4, 0.0, INFINITY, {1.0, 1.0, 1.0}},
                           {"hertz_slips", DEM_HERTZ, 0.0, true, 1e4, 0.0, 0.2, {2.0, 2.0, 2.5}},
                           {"linear_elastic", DEM_LINEAR, 0.0, true, 0.0, 0.0, 0.0, {2.0, 2.0, 2.0}},
                           {"linear_pulls", DEM_LINEAR, 1500.0, true, 0.0, 0.0, 0.0, {1.0, 1.0, 2.0}},
                           {"linear_clipped", DEM_LINEAR, 1500.0, false, 0.0, 0.0, 0.0, {1.0, 1.0, 2.0}},
                           {"linear_sticks", DEM_LINEAR, 0.0, true, 1e4, 0.0, INFINITY, {1.0, 1.0, 1.0}},
                           {"linear_slips", DEM_LINEAR, 0.0, true, 1e4, 0.0, 0.2, {1.0, 1.0, 2.0}},
                           {"paper", DEM_HERTZ, 500.0, true, 1e4, 5.0, 0.2, {1.0, 1.0, 2.0}}};
enum { N_LAWS = sizeof laws / sizeof *laws };

static double stiffness(const law *p)
{
    return p->normal == DEM_HERTZ ? 1e6 : 8e4;
}

static double v_along(const law *p)
{
    return p->k_s > 0.0 ? V_S : 0.0;
}

/* ---- reference: classical Runge-Kutta, from the moment of contact ---- */

/* Overlap and its rate, position and speed along the wall, length of the spring. */
enum { OVERLAP, CLOSING, ALONG, SPEED, SPRING, N_STATE };

static double normal_force(const law *p, const double y[])
{
    const double depth = fmax(y[OVERLAP], 0.0);
    const double f =
        stiffness(p) * (p->normal == DEM_HERTZ ? pow(depth, 1.5) : depth) + p->gamma_n * M * y[CLOSING];
    return p->tension ? f : fmax(f, 0.0);
}

static double limit(const law *p, const double y[])
{
    return p->mu > 0.0 ? p->mu * fmax(normal_force(p, y), 0.0) : 0.0;
}

static void rates(const law *p, const double y[], double dydt[])
{
    const double cap = limit(p, y), pull = p->k_s * y[SPRING];
    dydt[OVERLAP] = y[CLOSING];
    dydt[CLOSING] = -normal_force(p, y) / M;
    dydt[ALONG] = dydt[SPRING] = y[SPEED];
    dydt[SPEED] = -fmax(-cap, fmin(pull, cap)) / M - p->gamma_s * y[SPEED];
}

/* A step, and the slider: the Coulomb limit truncates the spring. */
static void rk4(const law *p, double h, double y[])
{
    double k[4][N_STATE], z[N_STATE];
    for (int stage = 0; stage < 4; stage++) {
        const double part = stage == 0 ? 0.0 : stage == 3 ? h : 0.5 * h;
        for (int a = 0; a < N_STATE; a++) z[a] = y[a] + (stage ? part * k[stage - 1][a] : 0.0);
        rates(p, z, k[stage]);
    }
    for (int a = 0; a < N_STATE; a++) y[a] += h / 6.0 * (k[0][a] + 2.0 * k[1][a] + 2.0 * k[2][a] + k[3][a]);
    if (p->k_s > 0.0) {
        const double most = limit(p, y) / p->k_s;
        y[SPRING] = fmax(-most, fmin(y[SPRING], most));
    }
}

/* State at the end of contact, located within its step, and its time. */
typedef struct {
    double time, v_n, v_s, along;
} rebound;

static rebound solve(const law *p, double h)
{
    double y[N_STATE] = {0.0, V_N, 0.0, v_along(p), 0.0}, last[N_STATE], t = 0.0;
    do {
        memcpy(last, y, sizeof y);
        rk4(p, h, y);
        t += h;
    } while (y[OVERLAP] > 0.0);
    double part = h;
    for (int k = 0; k < 6; k++) { /* Newton's method for the time of separation, from the step before it */
        part -= y[OVERLAP] / y[CLOSING];
        memcpy(y, last, sizeof y);
        rk4(p, part, y);
    }
    return (rebound){t - h + part, -y[CLOSING], y[SPEED], y[ALONG]};
}

/* Steps of 1e-8 s, once per law. */
static rebound exact_rebound(const law *p)
{
    static rebound known[N_LAWS];
    rebound *r = &known[p - laws];
    if (r->time == 0.0) *r = solve(p, 1e-8);
    return *r;
}

/* ---- the simulator ---- */

static dem_definition flight(const law *p, int integrator, double dt, double phase, dem_grain *grain)
{
    *grain = (dem_grain){0.0, R + (3.0 + phase) * V_N * dt, R, M, v_along(p), -V_N};
    dem_definition def = dem_definition_default();
    def.gravity[1] = 0.0, def.dt = dt, def.integrator = integrator;
    def.implicit.tolerance = 1e-15, def.normal = p->normal, def.tension = p->tension;
    def.tangential = p->k_s > 0.0 ? DEM_SPRING : DEM_NONE, def.damping = DEM_DAMPING_OUTSIDE;
    def.material = (dem_material){
        .k_n = stiffness(p), .gamma_n = p->gamma_n, .k_s = p->k_s, .gamma_s = p->gamma_s, .mu = p->mu};
    grains_on_floor(&def, 1, grain);
    return def;
}

/* Error of velocity over V_N, of position over V_N times the contact time, of energy over the initial one. */
typedef struct {
    double of[N_ERRORS];
} errors;

/* Errors of a state at the time `after` separation: in free motion, positions are compared at equal times. */
static errors compare(const law *p, const rebound *exact, double x, double y, double v_x, double v_y,
                      double after, double integration)
{
    const double then = 0.2 * exact->time, back = after - then;
    return (errors){
        {hypot(v_y - exact->v_n, v_x - exact->v_s) / V_N,
         hypot(y - back * v_y - then * exact->v_n, x - back * v_x - exact->along - then * exact->v_s) /
             (V_N * exact->time),
         integration / (0.5 * M * (V_N * V_N + v_along(p) * v_along(p)))}};
}

static errors simulate(const law *p, int integrator, const rebound *exact, double n, double phase)
{
    dem_grain grain;
    const double dt = exact->time / n;
    dem_definition def = flight(p, integrator, dt, phase, &grain);
    def.ledger = !dem_schemes[integrator]->parts; /* else its energy error has no order */
    scoped_sim *sim = grains_start(&def);
    /* Gear's higher derivatives decay over some steps after the contact */
    CHECK_OK(dem_run(sim, lround(1.2 * n) + 40));
    const dem_state s = grains_state_of_one(sim);
    dem_ledger l = {0};
    dem_ledger_read(sim, &l);
    const double after = dem_time(sim) - (3.0 + phase) * dt - exact->time;
    return compare(p, exact, s.x - v_along(p) * (3.0 + phase) * dt, s.y - R, s.vx, s.vy, after,
                   l.integration);
}

/* Root mean squares over phases of the first contact; slightly different step sizes make the phases of
 * separation independent. */
typedef errors method(const law *p, int variant, const rebound *exact, double n, double phase);

static errors rms(method *run, const law *p, int variant, const rebound *exact, double n, int phases)
{
    const double golden = 0.6180339887498949;
    errors sum = {0};
    for (int k = 0; k < phases; k++) {
        const errors e = run(p, variant, exact, n + fmod(golden * k, 1.0) - 0.5, (k + 0.381) / phases);
        for (int q = 0; q < N_ERRORS; q++) sum.of[q] += e.of[q] * e.of[q] / phases;
    }
    for (int q = 0; q < N_ERRORS; q++) sum.of[q] = sqrt(sum.of[q]);
    return sum;
}

/* ---- a contact located within its step ---- */

/* The simulator's leapfrog for this problem, with two remedies for first order. In the first and last step,
 * dissipative forces act only during contact, and the spring grows from the moment of contact. The damping
 * uses the velocity at the full step. */
enum { AS_IS, LOCATED, LOCATED_FULL_STEP };

static errors leapfrog(const law *p, int variant, const rebound *exact, double n, double phase)
{
    const double dt = exact->time / n, start = (3.0 + phase) * dt;
    double x = -v_along(p) * start, y = V_N * start, v_x = v_along(p), v_y = -V_N, spring = 0.0, f_s = 0.0;
    const long steps = lround(1.2 * n) + 40;
    bool touching = false;
    for (long step = 0; step < steps; step++) {
        double f_n = 0.0;
        if (y < 0.0) {
            const bool first = variant != AS_IS && !touching;
            const double part = first ? fmin(y / (v_y * dt), 1.0) : 1.0; /* of the last step */
            const double weight = first ? 0.5 + part : 1.0;
            const double elastic = stiffness(p) * (p->normal == DEM_HERTZ ? pow(-y, 1.5) : -y);
            double total = elastic - p->gamma_n * M * v_y;
            if (variant == LOCATED_FULL_STEP) total /= 1.0 + 0.5 * p->gamma_n * dt;
            if (!p->tension) total = fmax(total, 0.0);
            const double most = p->k_s > 0.0 ? p->mu * fmax(total, 0.0) / p->k_s : 0.0;
            f_n = elastic + weight * (total - elastic);
            spring = fmax(-most, fmin(spring + v_x * dt * part, most));
            double sum = -p->k_s * spring - p->gamma_s * M * v_x;
            if (variant == LOCATED_FULL_STEP) sum /= 1.0 + 0.5 * p->gamma_s * dt;
            f_s = -p->k_s * spring + weight * (sum + p->k_s * spring);
            touching = true;
        } else if (touching) { /* correction of the last kick */
            const double lacks = variant == AS_IS ? 0.0 : 0.5 - fmin(y / (v_y * dt), 1.0);
            f_n = p->tension ? -lacks * p->gamma_n * M * v_y : 0.0;
            f_s *= lacks;
            touching = false;
        } else {
            f_s = spring = 0.0;
        }
        v_y += dt * f_n / M;
        v_x += dt * f_s / M;
        y += dt * v_y;
        x += dt * v_x;
    }
    return compare(p, exact, x, y, v_x, v_y, (double)steps * dt - start - exact->time, 0.0);
}

/* ---- the fits ---- */

enum { MAX_SIZES = 16 };

typedef struct {
    double slope, se;
} fit;

/* Round-off of positions over the shortest step, relative to the velocity. */
static const double EXACT = 1e-9;

/* Least squares of log error against log(1/n); NaN where all errors are round-off. */
static fit fit_order(int sizes, const double n[], const double error[])
{
    bool exact = true;
    for (int k = 0; k < sizes; k++) exact = exact && error[k] < EXACT;
    if (exact) return (fit){NAN, NAN};
    double x[MAX_SIZES], y[MAX_SIZES], start, slope, cov[3], rest;
    for (int k = 0; k < sizes; k++) x[k] = -log(n[k]), y[k] = log(error[k]);
    gsl_fit_linear(x, 1, y, 1, (size_t)sizes, &start, &slope, cov, cov + 1, cov + 2, &rest);
    return (fit){slope, sqrt(cov[2])};
}

/* ---- the suite ---- */

/* Scheme of a rebound. */
typedef struct {
    const char *name;
    method *run;
    int variant;
} scheme;

static const scheme located = {"located", leapfrog, LOCATED},
                    located_full_step = {"located_full_step", leapfrog, LOCATED_FULL_STEP};

/* Does the simulator accept this time step? */
static bool allowed(const law *p, const scheme *s, double dt)
{
    dem_grain grain;
    const dem_definition def = flight(p, s->run == simulate ? s->variant : DEM_VERLET, dt, 1.0, &grain);
    return dt <= dem_time_step_limit(&def, NULL);
}

/* Errors over the step sizes as rows of `table`; a row of `summary` with the fits from 40 steps per contact
 * on and the error at the paper's time step. */
static void study(const law *p, const scheme *s, FILE *table, FILE *summary, fit fits[N_ERRORS])
{
    const rebound exact = exact_rebound(p);
    const int phases = check_full() ? 64 : 24;
    const double most = check_full() ? 2500.0 : 700.0, default_dt = 5e-5;
    double n[MAX_SIZES], error[N_ERRORS][MAX_SIZES];
    int sizes = 0;
    char name[64];
    snprintf(name, sizeof name, "%s/%s", p->name, s->name);
    for (double steps = 40.0 / pow(1.5, 3.0); steps < most; steps *= 1.5) {
        /* slightly fewer steps than this occur */
        if (!allowed(p, s, exact.time / (steps - 0.5))) continue;
        const errors e = rms(s->run, p, s->variant, &exact, steps, phases);
        CHECK_ROW(table, name, steps, exact.time / steps, e.of[VELOCITY], e.of[PLACE], e.of[INTEGRATION]);
        if (steps < 39.0) continue; /* steps too large for the fit */
        n[sizes] = steps;
        for (int q = 0; q < N_ERRORS; q++) error[q][sizes] = e.of[q];
        sizes++;
    }
    for (int q = 0; q < N_ERRORS; q++) fits[q] = fit_order(sizes, n, error[q]);
    if (!summary) return;
    errors e = {{NAN, NAN, NAN}};
    if (allowed(p, s, 1.05 * default_dt))
        e = rms(s->run, p, s->variant, &exact, exact.time / default_dt, phases);
    CHECK_ROW(summary, name, fits[VELOCITY].slope, fits[VELOCITY].se, fits[PLACE].slope, fits[PLACE].se,
              fits[INTEGRATION].slope, fits[INTEGRATION].se, exact.time / default_dt, e.of[VELOCITY],
              e.of[PLACE], e.of[INTEGRATION]);
}

/* Half the difference between orders. */
static const double SAME_ORDER = 0.25;

static void check_orders(const law *p, const char *name, const fit fits[], const double expected[], int n)
{
    for (int q = 0; q < n; q++) {
        if (!(fabs(fits[q].slope - expected[q]) <= SAME_ORDER)) fprintf(stderr, "%s, %s:\n", p->name, name);
        CHECK_NEAR(fits[q].slope, expected[q], SAME_ORDER);
    }
}

/* The implicit scheme has no shear springs. Conservative laws rebound at the impact speed for any step.
 * Damping acts only over the fraction of a step in contact, so that a jump gives an error of second order. */
static void check_implicit(const law *p, const scheme *s, FILE *table, FILE *summary)
{
    fit fits[N_ERRORS];
    if (p->k_s > 0.0) return;
    study(p, s, table, summary, fits);
    if (p->gamma_n > 0.0)
        check_orders(p, s->name, fits, (double[]){2.0, 2.0}, INTEGRATION);
    else
        CU_ASSERT(isnan(fits[VELOCITY].slope));
    CHECK_NEAR(fits[PLACE].slope, 2.0, SAME_ORDER);
}

static void orders(void)
{
    if (CHECK_SKIPS("numbers of code that other tests run under sanitizers")) return;
    CHECK_TABLE(table, "order", "steps, dt [s], velocity_error, position_error, integration, case");
    CHECK_TABLE(summary, "order_fits",
                "velocity_order, velocity_order_se, position_order, position_order_se, integration_order, "
                "integration_order_se, steps, velocity_error, position_error, integration, case");
    for (const law *p = laws; p < laws + N_LAWS; p++) {
        fit fits[N_ERRORS];
        for (int i = 0; i < DEM_INTEGRATORS; i++) {
            const scheme s = {dem_schemes[i]->name, simulate, i};
            double expected[N_ERRORS];
            if (dem_schemes[i]->parts) {
                check_implicit(p, &s, table, summary);
                continue;
            }
            memcpy(expected, p->verlet, sizeof expected);
            /* higher order for smooth forces, so that the error of the contact remains */
            if (s.variant == DEM_GEAR5) expected[PLACE] = p->verlet[VELOCITY];
            study(p, &s, table, summary, fits);
            check_orders(p, s.name, fits, expected, N_ERRORS);
        }
        study(p, &located, table, summary, fits);
        study(p, &located_full_step, table, summary, fits);
        check_orders(p, located_full_step.name, fits, (double[]){fmax(p->verlet[VELOCITY], 2.0), 2.0},
                     INTEGRATION);
    }
}

/* A grain that oscillates in permanent contact with a linear floor shows the order of the scheme itself. It
 * starts at a turning point, since Gear's third derivative starts at 0. Root mean square over the third
 * period, of position and velocity together, relative to the initial amplitude. */
static double sway(double gamma_n, int integrator, double n)
{
    const double k = 8e4, g = 1e5, half = 0.5 * gamma_n, w = sqrt(k / M - half * half), deep = M * g / k;
    const double reach = 0.5 * deep;
    dem_grain grain = {0.0, R - deep + reach, R, M, 0.0, 0.0};
    dem_definition def = grains_bare(1, &grain, DEM_LINEAR, (dem_material){.k_n = k, .gamma_n = gamma_n});
    def.gravity[1] = -g, def.dt = 2.0 * M_PI / w / n, def.integrator = integrator;
    grains_on_floor(&def, 1, &grain);
    scoped_sim *sim = grains_after(&def, lround(2.0 * n));
    const long steps = lround(n);
    double sum = 0.0;
    for (long step = 0; step < steps; step++) {
        CHECK_OK(dem_run(sim, 1));
        const dem_state s = grains_state_of_one(sim);
        const double t = dem_time(sim), fall = reach * exp(-half * t);
        const double y = fall * (cos(w * t) + half / w * sin(w * t));
        const double v = -fall * (w + half * half / w) * sin(w * t);
        sum += pow(s.y - R + deep - y, 2.0) + pow((s.vy - v) / w, 2.0);
    }
    return sqrt(sum / (double)steps) / reach;
}

/* Each integrator has the order of its descriptor. */
static void smooth(void)
{
    CHECK_TABLE(table, "order_smooth", "order, order_se, case");
    for (int damped = 0; damped < 2; damped++)
        for (int i = 0; i < DEM_INTEGRATORS; i++) {
            double n[MAX_SIZES], error[MAX_SIZES];
            int sizes = 0;
            for (double steps = 100.0; steps < 900.0; steps *= 1.5, sizes++) {
                n[sizes] = steps;
                error[sizes] = sway(damped ? 500.0 : 0.0, i, steps);
            }
            const fit f = fit_order(sizes, n, error);
            const int order = dem_schemes[i]->order[damped];
            if (order > 2) CU_ASSERT(f.slope > order - SAME_ORDER); /* or better */
            if (order <= 2) CHECK_NEAR(f.slope, order, SAME_ORDER);
            const char *name = check_text("%s/%s", damped ? "damped" : "undamped", dem_schemes[i]->name);
            CHECK_ROW(table, name, f.slope, f.se);
        }
}

/* The references: halving the step changes nothing; an adaptive method and closed forms agree. */
static void answers(void)
{
    for (const law *p = laws; p < laws + N_LAWS; p++) {
        const rebound a = exact_rebound(p), b = solve(p, 2e-8);
        dem_collision_result c;
        CHECK_NEAR(a.v_n / b.v_n, 1.0, 1e-9);
        CHECK_NEAR(a.v_s, b.v_s, 1e-9 * V_N);
        CHECK_NEAR(a.along, b.along, 1e-9 * V_N * a.time);
        CHECK_OK(dem_collision(&(dem_head_on){p->normal, p->tension, stiffness(p), p->gamma_n, M, V_N}, &c));
        CHECK_NEAR(a.v_n / V_N, c.restitution, 1e-9);
        if (p->tension) CHECK_NEAR(a.time / c.time, 1.0, 1e-9);
        if (isinf(p->mu)) { /* a spring that is never truncated */
            const double w = sqrt(p->k_s / M);
            CHECK_NEAR(a.v_s / V_S, cos(w * a.time), 1e-9);
            CHECK_NEAR(a.along / V_S, sin(w * a.time) / w, 1e-9 * a.time);
        }
    }
}

/* The leapfrog of the trials with located contact equals the simulator's. */
static void same_leapfrog(void)
{
    for (const law *p = laws; p < laws + N_LAWS; p++) {
        const rebound exact = exact_rebound(p);
        const errors a = simulate(p, DEM_VERLET, &exact, 41.3, 0.3),
                     b = leapfrog(p, AS_IS, &exact, 41.3, 0.3);
        CHECK_PAIRS(1e-12, {a.of[VELOCITY], b.of[VELOCITY]}, {a.of[PLACE], b.of[PLACE]});
    }
}

/* Energy budget of avalanches, and decrease of the integration error with the time step: piles of 40 grains,
 * filled and opened. Its error is the standard error over piles. */
static void avalanches(void)
{
    const int piles = check_full() ? 16 : check_fast() ? 1 : 2, sizes = check_full() ? 3 : 2;
    double integration[3];
    CHECK_TABLE(table, "order_ledger",
                "dt [s], normal_damping, shear_damping, sliding, at_walls, "
                "integration, integration_se, residual");
    for (int k = 0; k < sizes; k++) {
        double row[8] = {5e-5 / (1 << k)}, square = 0.0;
        for (int pile = 0; pile < piles; pile++) {
            dem_definition def = grains_box(40, 1.2, pile, NULL);
            def.dt = row[0], def.ledger = true;
            def.walls[DEM_BOX_RIGHT].open_at_step = 6000L << k;
            scoped_sim *sim = grains_after(&def, 12000L << k);
            const dem_ledger l = grains_ledger(sim);
            const double lost = l.normal_damping + l.shear_damping + l.sliding;
            const double share[] = {l.normal_damping, l.shear_damping, l.sliding, l.at_walls, l.integration};
            for (int c = 0; c < 5; c++) row[c + 1] += share[c] / lost / piles;
            square += l.integration / lost * l.integration / lost / piles;
            row[7] = fmax(row[7], fabs(l.residual) / l.turnover);
            CHECK_NEAR(l.residual, 0.0, 1e-10 * l.turnover);
        }
        integration[k] = row[5];
        row[6] = sqrt((square - row[5] * row[5]) / (piles - 1.0));
        check_row(table, 8, row, NULL);
    }
    for (int k = 1; k < sizes; k++) CHECK_NEAR(log2(integration[k - 1] / integration[k]), 2.0, SAME_ORDER);
}

CHECK_SUITE(order, "validation: order", answers, same_leapfrog, orders, smooth, avalanches)
