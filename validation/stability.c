/* The largest stable time step: measured, and compared with the linear theory of the schemes and with the
 * limit above which a scene is refused.
 *
 * Theory. The leapfrog evaluates damping half a step late: x(n+1) - 2 x(n) + x(n-1) + dt C (x(n) - x(n-1)) +
 * dt^2 K x(n) = 0 in coordinates weighted by the masses. As M (second difference) + dt C (central
 * difference) + dt^2 K (average of three) it is Newmark's scheme, with M = 1 - dt C/2 - dt^2 K/4, so it is
 * stable where 4 - 2 dt C - dt^2 K is positive definite, also where C and K do not commute. K and C are sums
 * over the contacts. Contacts on equal grains add up to at most 3 in any direction, which gives the limit:
 * 4 - 6 gamma dt - 3 omega^2 dt^2. Gear's scheme: each mode of K separately, with its damping by C, in the
 * matrix of predictor and corrector.
 *
 * Measured. Compressed grains at rest are slightly displaced; the largest time step, set without the check of
 * the limit, for which the displacement does not grow. */
#include <gsl/gsl_eigen.h>

#include "core/clock.h"
#include "table/table.h"
#include "dem/law/law.h"
#include "dem/state/state.h"
#include "tests/grains.h"
#include "tests/numbers.h"

enum { PAIR, WALL, LOADED, PACKING, FLOWER, SYSTEMS };
static const char *const system_names[SYSTEMS] = {"pair", "wall", "loaded", "packing", "flower"};
enum { MOST = 256 };

/* Masses and stiffnesses in cgs; damping and shear in units of the normal contact's omega = sqrt(k/m_eff) of
 * the light grains, k the slope of the force at the initial overlap. */
typedef struct {
    int system, law, integrator;
    double k_n, damping, mass_ratio, radius_ratio, shear;
    bool rotation;
} stability_case;

static const double R = 0.1, M = 0.004, DEPTH = 0.02; /* overlap over radius */

typedef struct {
    dem_definition def;
    dem_grain grains[MOST];
    double omega; /* of a contact of two light grains, or of a light grain with a fixed one */
} scene;

static double slope_of(const stability_case *c, double overlap)
{
    return c->law == DEM_HERTZ ? 1.5 * c->k_n * sqrt(overlap) : c->k_n;
}

static void put(scene *s, double x, double y, double r, double m, bool fixed)
{
    CU_ASSERT_FATAL(s->def.n_grains < MOST);
    s->grains[s->def.n_grains++] = (dem_grain){.x = x, .y = y, .r = r, .m = m, .fixed = fixed};
}

/* A row of two grains between two fixed ones. */
static void make_pair(scene *s, const stability_case *c)
{
    const double pitch = (2.0 - DEPTH) * R;
    put(s, 0.0, 0.0, R, M, true);
    put(s, pitch, 0.0, R, M, false);
    put(s, 2.0 * pitch, 0.0, R, M * c->mass_ratio, false);
    put(s, 3.0 * pitch, 0.0, R, M, true);
}

/* Rings of a triangular lattice around the origin, the outermost of them fixed; every third grain is lighter
 * than its six neighbours. */
static void make_packing(scene *s, const stability_case *c, int rings)
{
    const double pitch = (2.0 - DEPTH) * R;
    for (int b = -rings; b <= rings; b++)
        for (int a = -rings; a <= rings; a++) {
            if (abs(a + b) > rings) continue;
            const bool outer = abs(a) == rings || abs(b) == rings || abs(a + b) == rings;
            put(s, pitch * (a + 0.5 * b), pitch * sqrt(0.75) * b, R,
                M * ((a - b) % 3 == 0 ? 1.0 : c->mass_ratio), outer);
        }
}

/* One large grain, surrounded by as many fixed small ones as fit. */
static void make_flower(scene *s, const stability_case *c)
{
    const double large = R * c->radius_ratio, reach = large + R - DEPTH * R;
    const int n = (int)floor(M_PI / asin(R / reach) + 1e-9);
    put(s, 0.0, 0.0, large, M * c->mass_ratio, false);
    for (int i = 0; i < n; i++)
        put(s, reach * cos(2.0 * M_PI * i / n), reach * sin(2.0 * M_PI * i / n), R, M, true);
}

static void make_scene(scene *s, const stability_case *c, int rings)
{
    *s = (scene){.def = dem_definition_default()};
    dem_definition *def = &s->def;
    const double k = slope_of(c, DEPTH * R);
    const bool alone = c->system == WALL || c->system == LOADED || c->system == FLOWER;
    s->omega = sqrt(k / (alone ? M * (c->system == FLOWER ? c->mass_ratio : 1.0) : 0.5 * M));
    def->normal = c->law, def->integrator = c->integrator, def->rotation = c->rotation;
    def->tangential = c->shear > 0.0 ? DEM_SPRING : DEM_NONE;
    def->material = (dem_material){.k_n = c->k_n, .gamma_n = c->damping * s->omega, .k_s = c->shear * k};
    def->material.mu = c->shear > 0.0 ? INFINITY : 0.0;
    def->gravity[1] = 0.0, def->grains = s->grains, def->skin = 0.5 * R;
    if (c->system == PAIR) make_pair(s, c);
    if (c->system == PACKING) make_packing(s, c, rings);
    if (c->system == FLOWER) make_flower(s, c);
    if (c->system == WALL || c->system == LOADED) {
        put(s, (1.0 - DEPTH) * R, 0.0, R, M, false);
        def->n_walls = c->system == WALL ? 2 : 1;
        def->walls[0] = grains_line(0.0, 0.0, 1.0, 0.0, &def->material);
        def->walls[1] = grains_line(2.0 * (1.0 - DEPTH) * R, 0.0, -1.0, 0.0, &def->material);
        if (c->system == LOADED)
            def->gravity[0] = -c->k_n * DEPTH * R * (c->law == DEM_HERTZ ? sqrt(DEPTH * R) : 1.0) / M;
    }
}

/* The largest accepted time step. */
static double refused_above(scene *s)
{
    double lo = 1e-9 / s->omega, hi = 1e3 / s->omega;
    for (int i = 0; i < 50; i++) {
        scoped_sim *sim = NULL;
        s->def.dt = sqrt(lo * hi);
        *(dem_create(&s->def, &sim) == RP_OK ? &lo : &hi) = s->def.dt;
    }
    return lo;
}

/* ---- Theory */

typedef struct {
    size_t n; /* degrees of freedom */
    gsl_matrix *K, *C;
} modes;

/* Add w b b^T. */
static void add_element(gsl_matrix *A, double w, const size_t at[6], const double b[6])
{
    for (int i = 0; i < 6; i++)
        for (int j = 0; j < 6; j++)
            if (b[i] != 0.0 && b[j] != 0.0)
                gsl_matrix_set(A, at[i], at[j], gsl_matrix_get(A, at[i], at[j]) + w * b[i] * b[j]);
}

/* K and C of all contacts, weighted by the masses; a row of grains moves along the row alone: no buckling. */
static modes linearise(const scene *s, const stability_case *c, const dem_sim *sim)
{
    const bool line = c->system == PAIR || c->system == WALL || c->system == LOADED;
    modes A = {.n = 3 * s->def.n_grains};
    A.K = gsl_matrix_calloc(A.n, A.n);
    A.C = gsl_matrix_calloc(A.n, A.n);
    size_t n;
    scoped dem_contact *contacts = grains_contacts(sim, &n);
    for (size_t k = 0; k < n; k++) {
        const dem_contact *t = &contacts[k];
        const size_t i = t->id_a - 1, j = t->id_b ? t->id_b - 1 : i;
        const dem_grain *a = &s->grains[i], *b = t->id_b ? &s->grains[j] : NULL;
        const double r = hypot(t->x - t->x_b, t->y - t->y_b), nx = (t->x - t->x_b) / r,
                     ny = (t->y - t->y_b) / r;
        const double m_eff = !b || b->fixed ? a->m : a->fixed ? b->m : a->m * b->m / (a->m + b->m);
        const size_t at[6] = {3 * i, 3 * i + 1, 3 * i + 2, 3 * j, 3 * j + 1, 3 * j + 2};
        const double wa = a->fixed ? 0.0 : 1.0 / sqrt(a->m), wb = b && !b->fixed ? 1.0 / sqrt(b->m) : 0.0;
        const double turns = c->rotation ? sqrt(1.0 / dem_inertia(s->def.shape, 1.0, 1.0)) : 0.0;
        const double arm_a = turns * wa * (a->r - 0.5 * t->overlap) / a->r,
                     arm_b = b ? turns * wb * (b->r - 0.5 * t->overlap) / b->r : 0.0;
        const double flat = line ? 0.0 : 1.0;
        const double along[6] = {wa * nx, wa * ny, 0.0, -wb * nx, -wb * ny, 0.0};
        const double across[6] = {flat * wa * ny,  -flat * wa * nx, arm_a,
                                  -flat * wb * ny, flat * wb * nx,  arm_b};
        const double turned[6] = {across[0], across[1], 0.0, across[3], across[4], 0.0};
        add_element(A.K, slope_of(c, t->overlap), at, along);
        add_element(A.C, s->def.material.gamma_n * m_eff, at, along);
        if (c->shear > 0.0) add_element(A.K, s->def.material.k_s, at, across);
        if (b) add_element(A.K, -t->normal_force / r, at, turned);
    }
    return A;
}

/* Smallest eigenvalue of 4 - 2 dt C - dt^2 K. */
static double leapfrog_margin(const modes *A, double dt)
{
    gsl_matrix *S = gsl_matrix_alloc(A->n, A->n);
    gsl_vector *values = gsl_vector_alloc(A->n);
    gsl_eigen_symm_workspace *w = gsl_eigen_symm_alloc(A->n);
    for (size_t i = 0; i < A->n; i++)
        for (size_t j = 0; j < A->n; j++)
            gsl_matrix_set(S, i, j,
                           4.0 * (i == j) - 2.0 * dt * gsl_matrix_get(A->C, i, j) -
                               dt * dt * gsl_matrix_get(A->K, i, j));
    gsl_eigen_symm(S, values, w);
    const double least = gsl_vector_min(values);
    gsl_eigen_symm_free(w), gsl_vector_free(values), gsl_matrix_free(S);
    return least;
}

/* Spectral radius of a step of Gear's scheme of x'' = -k x - c x', times in units of the step: the state
 * (x, x', x''/2, ...) is predicted by Pascal's triangle and corrected by the error of x''/2. */
static double gear_radius(double k, double c)
{
    static const double correct[6] = {3.0 / 16.0, 251.0 / 360.0, 1.0, 11.0 / 18.0, 1.0 / 6.0, 1.0 / 60.0};
    gsl_matrix *S = gsl_matrix_calloc(6, 6);
    double P[6][6] = {{0.0}}, radius = 0.0;
    for (int i = 0; i < 6; i++)
        for (int j = i; j < 6; j++) P[i][j] = i == 0 || i == j ? 1.0 : P[i - 1][j - 1] + P[i][j - 1];
    for (int i = 0; i < 6; i++)
        for (int j = 0; j < 6; j++) {
            const double error = -0.5 * (k * P[0][j] + c * P[1][j]) - P[2][j];
            gsl_matrix_set(S, i, j, P[i][j] + correct[i] * error);
        }
    gsl_vector_complex *values = gsl_vector_complex_alloc(6);
    gsl_eigen_nonsymm_workspace *w = gsl_eigen_nonsymm_alloc(6);
    gsl_eigen_nonsymm(S, values, w);
    for (size_t i = 0; i < 6; i++) {
        const gsl_complex z = gsl_vector_complex_get(values, i);
        radius = fmax(radius, hypot(GSL_REAL(z), GSL_IMAG(z)));
    }
    gsl_eigen_nonsymm_free(w), gsl_vector_complex_free(values), gsl_matrix_free(S);
    return radius;
}

/* Threshold of growth per step: the growth that a run of STEPS reveals. */
enum { STEPS = 8000 };
static const double GROWTH = 5.0; /* log of the growth over a run */

/* u A u for vector m. */
static double share(const gsl_matrix *A, const gsl_matrix *vectors, size_t m)
{
    double sum = 0.0;
    for (size_t i = 0; i < A->size1; i++)
        for (size_t j = 0; j < A->size1; j++)
            sum += gsl_matrix_get(vectors, i, m) * gsl_matrix_get(A, i, j) * gsl_matrix_get(vectors, j, m);
    return sum;
}

/* Largest step of Gear's scheme without growth in a mode. The modes are those of K + omega C, since K and C
 * have nearly the same modes. */
static double gear_theory(const modes *A, double omega)
{
    gsl_matrix *S = gsl_matrix_alloc(A->n, A->n), *vectors = gsl_matrix_alloc(A->n, A->n);
    gsl_vector *values = gsl_vector_alloc(A->n);
    gsl_eigen_symmv_workspace *w = gsl_eigen_symmv_alloc(A->n);
    for (size_t i = 0; i < A->n; i++)
        for (size_t j = 0; j < A->n; j++)
            gsl_matrix_set(S, i, j, gsl_matrix_get(A->K, i, j) + omega * gsl_matrix_get(A->C, i, j));
    gsl_eigen_symmv(S, values, vectors, w);
    double least = INFINITY;
    for (size_t m = 0; m < A->n; m++) {
        const double k = share(A->K, vectors, m), c = share(A->C, vectors, m);
        double lo = 1e-6 / omega, hi = fmin(least, 1e2 / omega);
        if (k < 1e-9 * omega * omega || gear_radius(k * hi * hi, c * hi) < 1.0 + GROWTH / STEPS) continue;
        for (int i = 0; i < 40; i++) {
            const double dt = sqrt(lo * hi);
            *(gear_radius(k * dt * dt, c * dt) < 1.0 + GROWTH / STEPS ? &lo : &hi) = dt;
        }
        least = lo;
    }
    gsl_eigen_symmv_free(w), gsl_vector_free(values), gsl_matrix_free(vectors), gsl_matrix_free(S);
    return least;
}

static double theory(const scene *s, const stability_case *c, const dem_sim *sim)
{
    modes A = linearise(s, c, sim);
    double lo = 1e-6 / s->omega, hi = 1e2 / s->omega;
    for (int i = 0; i < 40 && c->integrator == DEM_VERLET; i++) {
        const double dt = sqrt(lo * hi);
        *(leapfrog_margin(&A, dt) > 0.0 ? &lo : &hi) = dt;
    }
    if (c->integrator == DEM_GEAR5) lo = gear_theory(&A, s->omega);
    gsl_matrix_free(A.K), gsl_matrix_free(A.C);
    return lo;
}

/* ---- Measured */

/* Largest displacement from the start, in radii. */
static double displaced(const scene *s, const dem_sim *sim)
{
    static dem_state states[MOST];
    double most = 0.0;
    if (dem_states(sim, states) != RP_OK) return NAN;
    for (size_t i = 0; i < dem_count(sim); i++) {
        const dem_grain *p = &s->grains[states[i].id - 1];
        const double d = hypot(states[i].x - p->x, states[i].y - p->y) + p->r * fabs(states[i].angle);
        if (!(d <= most)) most = d;
    }
    return most / R;
}

/* True if a displacement of 1e-7 of the overlap does not grow. */
static bool holds(const scene *rest, const stability_case *c, double dt, int steps)
{
    const bool line = c->system == PAIR || c->system == WALL || c->system == LOADED;
    const double kick = 1e-7 * DEPTH;
    static scene s;
    s = *rest;
    s.def.grains = s.grains;
    scoped_rng *random = numbers_of(11, 0);
    for (size_t i = 0; i < s.def.n_grains; i++) {
        if (s.grains[i].fixed) continue;
        s.grains[i].x += kick * R * (gsl_rng_uniform(random) - 0.5);
        if (!line) s.grains[i].y += kick * R * (gsl_rng_uniform(random) - 0.5);
        if (c->rotation) s.grains[i].omega = kick * s.omega * (gsl_rng_uniform(random) - 0.5);
    }
    s.def.dt = 1e-6 / s.omega;
    scoped_sim *sim = grains_start(&s.def);
    sim->def.dt = dt;
    bool bounded = true;
    for (int part = 0; part < 16 && bounded; part++)
        bounded = dem_run(sim, steps / 16) == RP_OK && displaced(rest, sim) < kick * exp(GROWTH);
    return bounded;
}

typedef struct {
    double measured, theory, limit, omega;
} stability;

static stability examine(const stability_case *c, int rings)
{
    static scene s;
    make_scene(&s, c, rings);
    stability out = {.limit = refused_above(&s), .omega = s.omega};
    s.def.dt = 1e-6 / s.omega;
    scoped_sim *sim = grains_start(&s.def);
    out.theory = theory(&s, c, sim);
    double lo = 0.02 * out.limit, hi = 50.0 * out.limit;
    for (int i = 0; i < 13; i++) {
        const double dt = sqrt(lo * hi);
        *(holds(&s, c, dt, STEPS) ? &lo : &hi) = dt;
    }
    out.measured = sqrt(lo * hi);
    return out;
}

/* ---- The map */

static FILE *table;

/* For one scheme: ratio of measured to limit, largest deviation from the theory. */
static struct {
    int cases;
    double least, most, deviation;
} summary;

static void check_one(const stability_case *c)
{
    const stability s = examine(c, check_full() ? 4 : 3);
    /* the last step of the bisection is 1.001; growth that is late or slow accounts for the rest: Gear's
     * scheme without damping gains 0.1 % per step at its threshold */
    CHECK_NEAR(s.measured / s.theory, 1.0,
               c->integrator == DEM_VERLET ? 0.005
               : c->damping > 0.0          ? 0.02
                                           : 0.08);
    /* the limit takes 0.85 of a packing's root, 1/1.176, with Verlet and the linear law 0.95, 1/1.053 */
    CU_ASSERT(s.measured > (c->integrator == DEM_VERLET && c->law == DEM_LINEAR ? 1.04 : 1.15) * s.limit);
    summary.cases++;
    summary.least = fmin(summary.least, s.measured / s.limit);
    summary.most = fmax(summary.most, s.measured / s.limit);
    summary.deviation = fmax(summary.deviation, fabs(s.measured / s.theory - 1.0));
    if (!table) return;
    const double w = s.omega;
    fprintf(table, "%s\t%s\t%s\t", system_names[c->system], dem_normal_descriptors[c->law].name,
            dem_schemes[c->integrator]->name);
    CHECK_ROW(table, NULL, c->k_n, c->damping * w, c->mass_ratio, c->radius_ratio, c->shear, c->rotation,
              s.limit, s.measured, s.theory, c->damping, w * s.limit, w * s.measured, w * s.theory,
              s.measured / s.limit);
}

static const stability_case plain = {PACKING, DEM_HERTZ, DEM_VERLET, 1e6, 0.0, 1.0, 1.0, 0.0, false};

/* Systems, laws, dampings, and mass ratios where the system has two masses. */
static void map_damping(int scheme)
{
    const double dampings[] = {0.1, 1.0, 0.0, 10.0, 0.03, 0.3, 3.0}, masses[] = {1.0, 1e3, 1e6};
    stability_case c = plain;
    c.integrator = scheme;
    for (c.system = 0; c.system < SYSTEMS; c.system++)
        for (c.law = check_fast() ? c.system % 2 : DEM_HERTZ; c.law <= DEM_LINEAR; c.law += 1 + check_fast())
            for (int d = 0; d < (check_full() ? 7 : check_fast() || c.law == DEM_LINEAR ? 1 : 2); d++)
                for (int m = 0; m < (check_full() && (c.system == PAIR || c.system == PACKING) ? 3 : 1);
                     m++) {
                    c.damping = dampings[d], c.mass_ratio = masses[m];
                    check_one(&c);
                }
}

static void map_stiffness(int scheme)
{
    stability_case c = plain;
    c.integrator = scheme;
    for (c.k_n = 1e2; c.k_n < 1e13; c.k_n *= check_full() ? 100.0 : 1e10)
        for (c.damping = 0.1; c.damping < 2.0; c.damping *= 10.0) check_one(&c);
}

/* Sticking shear springs, from soft to stiff, with and without rotation; with Gear's scheme only without. */
static void map_shear(int scheme)
{
    const double shears[] = {1.0, 0.2, 10.0, 0.02, 0.1, 0.3, 0.5, 2.0, 5.0};
    stability_case c = plain;
    c.law = DEM_LINEAR, c.integrator = scheme, c.damping = 0.1;
    for (int rotation = 0; rotation <= (scheme == DEM_VERLET); rotation++)
        for (int q = 0; q < (check_full() ? 9 : check_fast() ? 1 : 3); q++) {
            c.shear = shears[q], c.rotation = rotation == 1;
            check_one(&c);
        }
}

/* One light large grain among small ones: more than six neighbours. */
static void map_radii(int scheme)
{
    stability_case c = plain;
    c.system = FLOWER, c.integrator = scheme, c.damping = 0.1;
    for (c.radius_ratio = check_full() ? 1.0 : 10.0; c.radius_ratio < 40.0; c.radius_ratio *= 1.7)
        check_one(&c);
}

static void largest_time_step(void)
{
    if (CHECK_SKIPS("numbers of code that other tests run under sanitizers")) return;
    table = check_table("stability",
                        "system [word], law [word], integrator [word], k_n [dyn/cm^1.5 or dyn/cm], "
                        "gamma_n [1/s], mass_ratio, radius_ratio, k_s [slope of the normal force], rotation, "
                        "dt_limit [s], dt_measured [s], dt_theory [s], gamma_over_omega, omega_dt_limit, "
                        "omega_dt_measured, omega_dt_theory, margin [measured/limit]");
    CHECK_TABLE(sums, "stability_sums",
                "integrator [word], cases, margin_least [measured/limit], margin_most [measured/limit], "
                "deviation [largest deviation of measured/theory from 1], run_time [s]");
    for (int scheme = DEM_VERLET; scheme <= DEM_GEAR5; scheme++) {
        const double start = rp_clock();
        summary.cases = 0, summary.least = INFINITY, summary.most = summary.deviation = 0.0;
        map_damping(scheme);
        map_stiffness(scheme);
        map_shear(scheme);
        map_radii(scheme);
        if (sums) fprintf(sums, "%s\t", dem_schemes[scheme]->name);
        CHECK_ROW(sums, NULL, summary.cases, summary.least, summary.most, summary.deviation,
                  rp_clock() - start);
    }
    check_table_close(&table);
}

/* ---- The implicit scheme: no stability limit, but each step must be solvable, and no grain may move by more
 * than half the skin */

typedef struct {
    int solver;
    double tolerance;
} equation_solver;
static const equation_solver solvers[] = {
    {DEM_SOLVER_DIRECT, 1e-15}, {DEM_SOLVER_SOR, 1e-15}, {DEM_SOLVER_SOR, 1e-12}};
enum { SOLVERS = 3 };
static const char *const solver_names[] = {"direct", "sor"};

/* Compressed grains at rest, slightly displaced, at a step of a thousand contact times. */
static bool rests_implicitly(int system, const equation_solver *with, double damping, double times)
{
    static scene s;
    stability_case c = plain;
    c.system = system, c.integrator = DEM_IMPLICIT, c.damping = damping;
    make_scene(&s, &c, check_full() ? 4 : 2);
    s.def.implicit.solver = with->solver;
    s.def.implicit.tolerance = with->tolerance;
    return holds(&s, &c, times * M_PI / s.omega, check_full() ? 1000 : 100);
}

enum { GAS = 36 };

typedef struct {
    double contact_time, dt, sweeps;
    const char *ends;
} gas_run;

/* Elastic grains of this speed in a closed box. */
static dem_definition gas(dem_grain grains[GAS], int law, double speed, unsigned long run)
{
    dem_definition def = grains_bare(GAS, grains, law, (dem_material){.k_n = 1e6});
    scoped_rng *random = numbers_of(13, run);
    for (int i = 0; i < GAS; i++) {
        const double angle = 2.0 * M_PI * gsl_rng_uniform(random), r = R * (1.0 - 0.1 * (i % 3));
        grains[i] = (dem_grain){.x = 0.13 + 0.25 * (i % 6), .y = 0.13 + 0.25 * (i / 6), .r = r, .m = M};
        grains[i].vx = speed * cos(angle), grains[i].vy = speed * sin(angle);
    }
    dem_box_walls(&def, 1.51, &def.material);
    def.walls[def.n_walls++] = grains_line(0.0, 1.51, 0.0, -1.0, &def.material);
    return def;
}

/* A gas with speeds v/2, where a head-on impact at v has an overlap of `depth` radii; a step of `times` of
 * its contact time. */
static gas_run run_gas(const equation_solver *with, double depth, double times)
{
    const double overlap = depth * R, v = sqrt(1e6 * pow(overlap, 2.5) / (1.25 * 0.5 * M));
    gas_run out = {.contact_time = 2.9433 * overlap / v, .ends = dem_fault_text(DEM_FAULT_NONE)};
    dem_grain grains[GAS];
    dem_definition def = gas(grains, DEM_HERTZ, 0.5 * v, 0);
    def.integrator = DEM_IMPLICIT, def.implicit.solver = with->solver;
    def.implicit.tolerance = with->tolerance;
    def.skin = 0.4 * R, def.dt = out.dt = times * out.contact_time;
    scoped_sim *sim = grains_start(&def);
    const dem_energy before = grains_energies(sim);
    if (dem_run(sim, check_full() ? 300 : 40) == RP_OK) {
        const dem_energy after = grains_energies(sim);
        /* residual of the tolerance over 300 steps, of speeds that are small against a radius per step */
        CHECK_NEAR((after.kinetic + after.elastic) / before.kinetic, 1.0, 1e-6);
    } else {
        out.ends = dem_fault_text(dem_sim_fault(sim));
    }
    out.sweeps = grains_counts(sim).iterations / (double)(dem_step(sim) + 1);
    return out;
}

/* The largest of a series of steps, in contact times, at which grains at rest stay at rest. At larger steps
 * free fall leads beyond the convergence of Newton's method; the residual of the SOR sweeps grows by (omega
 * dt)^2 in the velocity of the next step. */
static void implicit_rest(void)
{
    CHECK_TABLE(out, "stability_implicit_rest", NULL);
    const char *const columns[][2] = {{"system", "word"},
                                      {"solver", "word"},
                                      {"tolerance", "radius"},
                                      {"gamma_over_omega", ""},
                                      {"dt_over_contact_time", "largest of 1, 3.2, 10, ... 1000"}};
    if (out) rp_table_columns(out, RP_CGS, sizeof columns / sizeof *columns, columns);
    for (int k = 0; k < (check_full() ? SOLVERS : 2); k++)
        for (int system = PAIR; system <= PACKING; system++)
            for (double damping = 0.0; damping < 2.0; damping += 1.0) {
                const equation_solver *with = &solvers[k];
                double times = 1000.0;
                while (times > 0.9 && !rests_implicitly(system, with, damping, times)) times /= sqrt(10.0);
                CU_ASSERT(times > (system == LOADED || with->tolerance > 1e-14 ? 3.0 : 999.0));
                if (out) fprintf(out, "%s\t%s\t", system_names[system], solver_names[with->solver]);
                CHECK_ROW(out, NULL, with->tolerance, damping, times);
            }
}

static void implicit_limits(void)
{
    CHECK_TABLE(out, "stability_implicit", NULL);
    const char *const columns[][2] = {{"solver", "word"},
                                      {"tolerance", "radius"},
                                      {"depth", "overlap of an impact over radius"},
                                      {"contact_time", "s"},
                                      {"dt", "s"},
                                      {"dt_over_contact_time", "largest successful step"},
                                      {"iterations", "a step, there"},
                                      {"half_skin", "contact times for a displacement of half the skin at v"},
                                      {"ends", "word"}};
    if (out) rp_table_columns(out, RP_CGS, sizeof columns / sizeof *columns, columns);
    for (int k = 0; k < (check_full() ? SOLVERS : 2); k++) {
        const equation_solver *with = &solvers[k];
        for (int d = 0; d < (check_full() ? 5 : 1); d++) {
            const double depth = (double[]){1e-3, 1e-4, 3e-4, 3e-3, 1e-2}[d];
            gas_run largest = {0}, next = {.ends = "none"};
            for (double times = 1.0; times < 2000.0; times *= 1.25) {
                next = run_gas(with, depth, times);
                if (strcmp(next.ends, dem_fault_text(DEM_FAULT_NONE)) != 0) break;
                largest = next;
            }
            CU_ASSERT(largest.dt >= 2.0 * largest.contact_time);
            const double v = 2.9433 * depth * R / next.contact_time;
            if (out) fprintf(out, "%s\t", solver_names[with->solver]);
            CHECK_ROW(out, next.ends, with->tolerance, depth, next.contact_time, largest.dt,
                      largest.dt / next.contact_time, largest.sweeps, 0.2 * R / v / next.contact_time);
        }
    }
}

/* ---- Boxes: fall, settle, rest */

/* True if a box with a step of `times` the limit rests in 2 s, 4 s if damped weakly, and gains no energy. */
static bool box_rests(int law, int scheme, double gamma, long stream, double times, double *limit)
{
    enum { N = 60 };
    dem_definition def = grains_box(N, 2.0, stream, NULL);
    def.normal = law, def.integrator = scheme;
    def.material.k_n = law == DEM_HERTZ ? 1e6 : 1e5;
    def.material.gamma_n = gamma;
    for (size_t w = 0; w < def.n_walls; w++) def.walls[w].material = def.material;
    *limit = dem_time_step_limit(&def, NULL);
    def.dt = *limit;
    scoped_sim *sim = grains_start(&def);
    dem_rest rest;
    const double most = grains_energies(sim).gravity;
    sim->def.dt *= times;
    bool good = true;
    for (int part = 0; part < 40 && good; part++) {
        good = dem_run(sim, lround((gamma < 100.0 ? 0.1 : 0.05) / sim->def.dt)) == RP_OK;
        const dem_energy e = grains_energies(sim);
        good = good && e.kinetic + e.elastic + e.gravity <= most;
    }
    good = good && dem_rest_state(sim, 0.0, 2.0, &rest) == RP_OK && rest.n == N &&
           rest.kinetic_energy < 1e-5 * 4e-3 * 981.0 * 0.2;
    return good;
}

/* ---- Energy that little damped beds gain */

/* What a step of 0.99 of the limit brings in over what is dissipated, until a bed or a lattice of equal
 * grains that falls by three radii has come down; no bed is shaken. */
static double brought_in(int law, int scheme, double damping, double shear, double inside, bool lattice,
                         long run)
{
    enum { N = 48 };
    dem_grain *grains;
    dem_definition def = grains_box(N, 2.0, run, &grains);
    const double k_n = law == DEM_LINEAR ? 1e5 : 1e6,
                 k = slope_of(&(stability_case){.law = law, .k_n = k_n}, 0.01);
    for (int i = 0; i < N && lattice; i++) { /* rows of ten and nine */
        const int odd = i % 19 > 9, row = 2 * (i / 19) + odd, of = i % 19 - 10 * odd;
        grains[i] = (dem_grain){
            .x = R * (1 + 2 * of + odd), .y = R * (4.0 + sqrt(3.0) * row), .r = 0.999 * R, .m = M};
    }
    def.normal = law, def.integrator = scheme, def.ledger = true, def.tension = false;
    def.damping = inside ? DEM_DAMPING_INSIDE : DEM_DAMPING_OUTSIDE;
    def.tangential = shear > 0.0 ? DEM_SPRING : DEM_NONE;
    def.material = (dem_material){.k_n = k_n,
                                  .gamma_n = damping * sqrt(k / (0.5 * M)),
                                  .k_s = shear * k,
                                  .mu = shear > 0.0 ? 0.5 : 0.0};
    for (size_t w = 0; w < def.n_walls; w++) def.walls[w].material = def.material;
    def.dt = 0.99 * dem_time_step_limit(&def, NULL);
    scoped_sim *sim = grains_start(&def);
    CHECK_OK(dem_run(sim, lround(0.3 / def.dt)));
    const dem_ledger l = grains_ledger(sim);
    return l.integration / (l.normal_damping + l.shear_damping + l.sliding);
}

static void little_damped(void)
{
    const double dampings[] = {0.01, 0.1, 0.003, 0.03, 0.3}, shears[] = {1.0, 0.0, 0.7, 0.3, 0.07};
    CHECK_TABLE(out, "stability_little_damped",
                "law [word], integrator [word], gamma_over_omega, k_s [slope of the normal force], lattice, "
                "brought_in [of what is dissipated]");
    const int n = check_full() ? 5 : check_fast() ? 1 : 2;
    for (int scheme = DEM_VERLET; scheme <= DEM_GEAR5; scheme++)
        for (int law = DEM_HERTZ; law <= DEM_LINEAR; law++)
            for (int d = 0; d < n; d++)
                for (int q = 0; q < n; q++)
                    for (int lattice = 0; lattice < 2; lattice++) {
                        const double part =
                            brought_in(law, scheme, dampings[d], shears[q], (d + q) % 2, lattice, 3 + d);
                        CHECK_OR_SAY(part < 0.01, "%s, %s, gamma %g, k_s %g, lattice %d: %g",
                                     dem_normal_descriptors[law].name, dem_schemes[scheme]->name, dampings[d],
                                     shears[q], lattice, part);
                        if (out)
                            fprintf(out, "%s\t%s\t", dem_normal_descriptors[law].name,
                                    dem_schemes[scheme]->name);
                        CHECK_ROW(out, NULL, dampings[d], shears[q], (double)lattice, part);
                    }
}

/* An undamped gas gains less than 1 % of its energy in 20 impacts a grain, at 0.99 of its limit. */
static void undamped_gas(void)
{
    for (int k = 0; k < 2 * DEM_NORMAL_N; k++) {
        dem_grain grains[GAS];
        const double v = 60.0;
        dem_definition def = gas(grains, k / 2, v, (unsigned long)k);
        def.integrator = k % 2 ? DEM_GEAR5 : DEM_VERLET;
        def.dt = 0.99 * dem_time_step_limit(&def, NULL);
        scoped_sim *sim = grains_start(&def);
        const double before = grains_energy(sim),
                     free_path = 0.1; /* of 36 grains in 1.5 x 1.5, at walls too: some 0.1 */
        CHECK_OK(dem_run(sim, lround(20.0 * free_path / v / def.dt)));
        CHECK_OR_SAY(grains_energy(sim) / before - 1.0 < 0.01, "law %d: %g", k,
                     grains_energy(sim) / before - 1.0);
    }
}

/* Boxes of falling grains rest at the limit; the table has its largest multiple at which all three do. */
static void boxes(void)
{
    CHECK_TABLE(out, "stability_boxes",
                "law [word], integrator [word], gamma_n [1/s], dt_limit [s], "
                "dt_rests [s], margin [rests/limit]");
    for (int scheme = DEM_VERLET; scheme <= DEM_GEAR5; scheme++)
        for (int law = DEM_HERTZ; law <= (check_fast() ? DEM_HERTZ : DEM_LINEAR); law++)
            for (int g = 0; g < (check_full() ? 5 : 1); g++) {
                const double gamma = (double[]){500.0, 1500.0, 4500.0, 200.0, 50.0}[g];
                double times = 1.0, limit;
                bool rests = true;
                for (long stream = 0; stream < (check_full() ? 3 : 1); stream++)
                    rests = box_rests(law, scheme, gamma, stream, 1.0, &limit) && rests;
                CU_ASSERT(rests);
                while (check_full() && rests && times < 16.0) {
                    for (long stream = 0; stream < 3 && rests; stream++)
                        rests = box_rests(law, scheme, gamma, stream, 1.1 * times, &limit);
                    if (rests) times *= 1.1;
                }
                if (out)
                    fprintf(out, "%s\t%s\t", dem_normal_descriptors[law].name, dem_schemes[scheme]->name);
                CHECK_ROW(out, NULL, gamma, limit, times * limit, times);
            }
}

CHECK_SUITE(stability, "validation: stability", largest_time_step, implicit_rest, implicit_limits, boxes,
            little_damped, undamped_gas)
