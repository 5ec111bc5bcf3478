/* Validation of the energy-conserving implicit integrator, Liffman, Chan & Hughes 1992, eq (24): energy over
 * many steps, phase error, cost of its solvers, and piles at the end of damped motion against static
 * solutions. Lengths in diameters, masses in those of a disk, g = 1. */
#include "table/table.h"
#include "tests/grains.h"
#include "validation/solved_pile.h"

static const double R = 0.5, K = 1e5;

/* Contact time: half a period of two disks on their spring. */
static double contact_time(void)
{
    return M_PI * sqrt(0.5 / K);
}

/* Five unequal disks that bounce in a box without dissipation. */
enum { GAS = 5 };
static dem_sim *gas(int integrator, double dt, double tolerance)
{
    dem_grain grains[GAS];
    grains_gas(GAS, grains);
    dem_definition def = grains_disks(GAS, grains, K);
    def.integrator = integrator, def.implicit.tolerance = tolerance;
    def.dt = dt * contact_time(), def.skin = 0.8;
    def.material.gamma_n =
        1e-300; /* counts as damped: at 0.1 the step of Verlet is beyond the limit without */
    dem_box_walls(&def, 3.6, &def.material);
    return grains_start(&def);
}

typedef struct {
    const char *name;
    int integrator;
    double dt, tolerance; /* time step in contact times; tolerance over the radius */
    bool exact;           /* to round-off */
} energy_case;

static const energy_case energy_cases[] = {
    {"implicit_0.01", DEM_IMPLICIT, 0.01, 1e-15, true}, {"implicit_0.1", DEM_IMPLICIT, 0.1, 1e-15, true},
    {"implicit_1", DEM_IMPLICIT, 1.0, 1e-15, true},     {"implicit_10", DEM_IMPLICIT, 10.0, 1e-15, true},
    {"loose_1", DEM_IMPLICIT, 1.0, 1e-9, false},        {"verlet_0.01", DEM_VERLET, 0.01, 0.0, false},
    {"verlet_0.05", DEM_VERLET, 0.05, 0.0, false}};
enum { ENERGY_CASES = sizeof energy_cases / sizeof *energy_cases };

/* Largest error up to a step, relative to the initial energy; potential energy is zero at the floor. */
enum { MARKS = 200 };
static size_t run_energy(const energy_case *c, long steps, double error[MARKS], double at[MARKS],
                         double *most, double *iterations)
{
    scoped_sim *sim = gas(c->integrator, c->dt, c->tolerance);
    const double before = grains_energy(sim);
    size_t n = 0;
    double next = 10.0;
    *most = 0.0;
    for (long k = 1; k <= steps; k++) {
        const rp_status status = dem_run(sim, 1);
        CHECK_OK(status);
        if (status) break;
        *most = fmax(*most, fabs(grains_energy(sim) - before) / before);
        if ((double)k < next && k < steps) continue;
        at[n] = (double)k;
        error[n++] = *most;
        next *= 1.1547819846894583; /* 16 per decade */
    }
    *iterations = grains_counts(sim).iterations / (double)steps;
    return n;
}

/* The error of a step is the rounding of positions, some 5e-16, times a force of some 1000, over an energy of
 * some 10. The energy performs a random walk. */
static double walk(long steps)
{
    return 1e-13 * sqrt((double)steps);
}

static void energy_is_kept(void)
{
    const long steps = check_full() ? 1000000 : check_fast() ? 2000 : 20000;
    static double error[ENERGY_CASES][MARKS], at[MARKS];
    const char *names[ENERGY_CASES + 1][2] = {{"step", ""}};
    double most[ENERGY_CASES], iterations[ENERGY_CASES];
    size_t marks = 0;
    for (int k = 0; k < ENERGY_CASES; k++) {
        const energy_case *c = &energy_cases[k];
        marks = run_energy(c, steps, error[k], at, &most[k], &iterations[k]);
        names[k + 1][0] = c->name, names[k + 1][1] = "";
        if (c->exact) CHECK_NEAR(most[k], 0.0, walk(steps));
        if (c->integrator == DEM_VERLET && c->dt >= 0.05) CU_ASSERT(most[k] > 1e-5);
    }
    CHECK_TABLE(out, "implicit_energy", NULL);
    if (out) {
        rp_table_columns(out, RP_CGS, ENERGY_CASES + 1, (const char *const(*)[2])names);
        for (size_t m = 0; m < marks; m++) {
            double row[ENERGY_CASES + 1] = {at[m]};
            for (int k = 0; k < ENERGY_CASES; k++) row[k + 1] = error[k][m];
            rp_table_row(out, ENERGY_CASES + 1, row);
        }
    }
    CHECK_TABLE(drift, "implicit_drift",
                "dt [contact times], tolerance [radius], steps, largest_error [start], "
                "iterations [a step], case");
    for (int k = 0; k < ENERGY_CASES; k++)
        CHECK_ROW(drift, energy_cases[k].name, energy_cases[k].dt, energy_cases[k].tolerance, (double)steps,
                  most[k], iterations[k]);
}

/* A disk on the floor oscillates more slowly than the exact solution: omega_eff = (2/dt) atan(omega dt/2). */
static void phase(void)
{
    const double omega = sqrt(K), A = 0.6 / K;
    const long steps = check_full() ? 100000 : 5000;
    CHECK_TABLE(out, "implicit_phase", "omega_dt, omega_eff [omega], formula [omega], verlet [omega]");
    for (int k = -6; k <= 6; k++) {
        const double angle = pow(10.0, 0.25 * k), formula = 2.0 / angle * atan(0.5 * angle);
        const dem_grain grain = {.x = 0.3, .y = R - 1.0 / K + A, .r = R, .m = 1.0};
        dem_definition def = grains_disks(1, &grain, K);
        def.dt = angle / omega;
        grains_on_floor(&def, 1, &grain);
        scoped_sim *sim = grains_start(&def);
        double sum = 0.0, last = 0.0;
        for (long n = 0; n < steps; n++) {
            CHECK_OK(dem_run(sim, 1));
            const dem_state s = grains_state_of_one(sim);
            const double now = atan2(-s.vy / omega, s.y - (R - 1.0 / K));
            sum += now - last + (now < last ? 2.0 * M_PI : 0.0);
            last = now;
        }
        const double measured = sum / ((double)steps * angle);
        /* positions of 0.5 are rounded to 1e-16, of an amplitude of 6e-5: random errors of 2e-12 a step */
        CHECK_NEAR(measured, formula, 1e-10 * formula);
        CHECK_ROW(out, NULL, angle, measured, formula, angle < 2.0 ? 2.0 / angle * asin(0.5 * angle) : NAN);
    }
}

/* A full triangle of `base` disks on a fixed row, released without load. */
static double cost_of(long base, double dt, int solver)
{
    const size_t n = (size_t)(base * (base + 1) / 2);
    const long steps = 10;
    scoped dem_grain *grains = calloc(n, sizeof *grains);
    size_t at = 0;
    for (long j = 0; j < base; j++)
        for (long i = 0; i < base - j; i++)
            grains[at++] =
                (dem_grain){(double)i + 0.5 * (double)j, (double)j * sqrt(0.75), R, 1.0, .fixed = j == 0};
    dem_definition def = grains_disks(n, grains, K);
    def.dt = dt * contact_time();
    def.implicit = (dem_implicit_solver){solver, 0.7, 1e-12, 1000000};
    scoped_sim *sim = grains_after(&def, steps);
    return grains_counts(sim).iterations / (double)steps;
}

/* SOR sweeps per step grow with dt and size, factorisations hardly. */
static void cost(void)
{
    static const double steps[] = {0.1, 1.0, 10.0};
    const long largest = check_full() ? 40 : 10;
    double before[3] = {0.0};
    CHECK_TABLE(out, "implicit_sweeps",
                "base [disks], dt [contact times], sweeps [a step], factorisations [a step]");
    for (long base = 5; base <= largest; base *= 2)
        for (int k = 0; k < 3; k++) {
            const double sweeps = cost_of(base, steps[k], DEM_SOLVER_SOR),
                         factorisations = cost_of(base, steps[k], DEM_SOLVER_DIRECT);
            CHECK_ROW(out, NULL, (double)base, steps[k], sweeps, factorisations);
            CU_ASSERT(factorisations <= 20.0);
            if (k == 2) CU_ASSERT(sweeps > 1.5 * before[2]);
            before[k] = sweeps;
        }
}

enum { CHAIN = 32 };

/* SOR sweeps in one step of a row of n overlapping disks between two fixed ones. Initial velocities: the mode
 * that relaxes slowest. */
static double sweeps_of_row(long n, double dt, double relaxation, double tolerance)
{
    dem_grain grains[CHAIN + 2];
    const double pitch = 0.98, displacement = 1e-3;
    for (long i = 0; i < n + 2; i++) {
        grains[i] = (dem_grain){.x = (double)i * pitch, .r = R, .m = 1.0, .fixed = i == 0 || i == n + 1};
        if (!grains[i].fixed)
            grains[i].vx = displacement / (dt * contact_time()) * sin(M_PI * (double)i / (double)(n + 1));
    }
    dem_definition def = grains_disks((size_t)(n + 2), grains, K);
    def.gravity[1] = 0.0, def.dt = dt * contact_time();
    def.implicit = (dem_implicit_solver){DEM_SOLVER_SOR, relaxation, tolerance, 1000000};
    scoped_sim *sim = grains_after(&def, 1);
    return grains_counts(sim).iterations;
}

/* Reduction of the error per sweep in that row. Its matrix, with diagonal 1 + 2 kappa and off-diagonal
 * -kappa, kappa = dt^2 K_s/(4 m), is consistently ordered. The spectral radius q of SOR then follows from
 * that of Jacobi's method, rho = 2 kappa/(1 + 2 kappa) cos(pi/(n + 1)): (q + w - 1)^2 = q w^2 rho^2 up to the
 * optimal w, and q = w - 1 beyond it. D. M. Young, Iterative Solution of Large Linear Systems (1971),
 * chapters 5 and 6. */
static double left_by_sweep(long n, double dt, double w, bool *beyond)
{
    const double kappa = 0.25 * K * dt * dt * contact_time() * contact_time(),
                 rho = 2.0 * kappa / (1.0 + 2.0 * kappa) * cos(M_PI / (double)(n + 1)),
                 square = w * w * rho * rho - 4.0 * (w - 1.0);
    *beyond = square < 0.0;
    return *beyond ? w - 1.0 : 0.25 * pow(w * rho + sqrt(square), 2.0);
}

/* Sweeps between two tolerances; their number is an integer. Beyond the optimal w all n modes decay at the
 * same rate with different phases: their sum deviates from the rate by a factor of about n at most. */
static void contraction(void)
{
    static const double steps[] = {10.0, 100.0}, factors[] = {0.5, 0.7, 0.9, 1.0, 1.3, 1.9};
    const double loose = 1e-6, tight = 1e-12;
    CHECK_TABLE(out, "implicit_contraction",
                "disks, dt [contact times], relaxation, sweeps [a step], left [a sweep], theory [a sweep]");
    for (long n = 2; n <= CHAIN; n *= 4)
        for (int k = 0; k < (check_fast() ? 1 : 2); k++)
            for (int f = 0; f < 6; f++) {
                bool beyond;
                const double w = factors[f], theory = left_by_sweep(n, steps[k], w, &beyond),
                             all = sweeps_of_row(n, steps[k], w, tight),
                             sweeps = all - sweeps_of_row(n, steps[k], w, loose);
                CHECK_NEAR(sweeps, log(tight / loose) / log(theory),
                           beyond ? -log((double)n + 2.0) / log(theory) : 1.0);
                CHECK_ROW(out, NULL, (double)n, steps[k], w, all, pow(tight / loose, 1.0 / sweeps), theory);
            }
}

/* ---- Damped motion to rest, and the static solution ---- */

typedef struct {
    double N, H, contact, position; /* largest differences, in m g, m g, m g, eps sigma */
    size_t missing;                 /* contacts above 1e-3 m g that only one of the two piles has */
} pile_difference;

static int by_id(const void *a, const void *b)
{
    const dem_contact *p = a, *q = b;
    return (p->id_a > q->id_a) - (p->id_a < q->id_a);
}

static pile_difference compare(const solved_pile *pile, const dem_sim *sim)
{
    pile_difference d = {0};
    scoped statics_contact *solved = NULL;
    size_t n, m, base = 0;
    scoped dem_contact *list = grains_contacts(sim, &n);
    CHECK_OK(statics_contacts(pile->equilibrium, &solved, &m));
    qsort(list, n, sizeof *list, by_id);
    scoped double *force = calloc(pile->n * pile->n, sizeof *force);
    for (size_t k = 0; k < m; k++) force[solved[k].a * pile->n + solved[k].b] = solved[k].force;
    for (size_t k = 0; k < n; k++) {
        if (list[k].id_b == 0) {
            d.N = fmax(d.N, fabs(list[k].normal_force - pile->N[base]));
            d.H = fmax(d.H, fabs(-list[k].shear_force - pile->H[base]));
            base++;
            continue;
        }
        const size_t a = (list[k].id_a < list[k].id_b ? list[k].id_a : list[k].id_b) - 1,
                     b = (list[k].id_a < list[k].id_b ? list[k].id_b : list[k].id_a) - 1;
        d.contact = fmax(d.contact, fabs(list[k].normal_force - force[a * pile->n + b]));
        force[a * pile->n + b] = 0.0;
    }
    CU_ASSERT_EQUAL(base, pile->k);
    for (size_t k = 0; k < pile->n * pile->n; k++) d.missing += force[k] > 1e-3;
    scoped dem_state *states = grains_states(sim);
    for (size_t i = 0; i < pile->n; i++)
        d.position =
            fmax(d.position, hypot((states[i].x - pile->grains[i].x) / pile->eps - pile->u[2 * i],
                                   (states[i].y - pile->grains[i].y) / pile->eps - pile->u[2 * i + 1]));
    return d;
}

/* Released under a slowly rising weight; gamma and 1/dt in units of sqrt(K_s/m). */
static pile_difference relaxed(const solved_pile *pile, int integrator, double gamma, double dt, long steps)
{
    const dem_definition def = solved_pile_scene(pile, integrator, gamma, dt);
    scoped_sim *sim = grains_start(&def);
    solved_pile_load(sim, steps / 2);
    CHECK_OK(dem_run(sim, steps / 2));
    return compare(pile, sim);
}

/* Strong dashpots reverse velocities at each long step; a well whose depth included the dashpot force would
 * amplify this oscillation. Piles of 60 degrees, slopes that the wells sustain. */
static void strong_dashpots(void)
{
    static const struct {
        long base;
        double gamma, dt;
    } cases[] = {{2, 11.0, 1.0}, {8, 11.0, 1.0}, {8, 50.0, 1.0}, {8, 11.0, 5.0}};
    for (int i = 0; i < 4; i++) {
        RP_ENDS(solved_pile_free) solved_pile pile = solved_pile_make(cases[i].base, 60.0, 1e-4, 1);
        const pile_difference d = relaxed(&pile, DEM_IMPLICIT, cases[i].gamma, cases[i].dt, 2000);
        /* a disk that leaves the ground and returns gets a new well */
        CHECK_PAIRS(1e-5, {d.N, 0.0}, {d.H, 0.0}, {d.contact, 0.0});
    }
}

static void pile_at_rest(void)
{
    const long bases[] = {8, 45};
    const double eps[] = {1e-3, 1e-5};
    CHECK_TABLE(out, "implicit_pile",
                "base [disks], disks, eps, N_error [m*g], H_error [m*g], contact_error [m*g], "
                "position_error [eps*sigma], integrator");
    for (int k = 0; k < (check_full() ? 2 : 1); k++) {
        RP_ENDS(solved_pile_free) solved_pile pile = solved_pile_make(bases[k], 30.0, eps[k], 1);
        const double b = (double)bases[k];
        for (int verlet = 0; verlet < 2; verlet++) {
            /* at this gamma the slowest mode, with a wavelength of some four heights, decays fastest */
            const pile_difference d = verlet ? relaxed(&pile, DEM_VERLET, 2.0, 0.1, lround(300.0 * b * b))
                                             : relaxed(&pile, DEM_IMPLICIT, 0.25 * b, 1.0, 4000);
            CHECK_PAIRS(1e-7, {d.N, 0.0}, {d.H, 0.0}, {d.contact, 0.0});
            CU_ASSERT_EQUAL(d.missing, 0);
            CHECK_ROW(out, verlet ? "verlet" : "implicit", b, (double)pile.n, pile.eps, d.N, d.H, d.contact,
                      d.position);
        }
    }
}

CHECK_SUITE(implicit, "validation: the implicit integrator", energy_is_kept, phase, cost, contraction,
            pile_at_rest, strong_dashpots)
