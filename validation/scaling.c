/* Scaling of the static solver: processor time and memory of linearised piles of 30 and 60 degrees. Forces
 * are compared with known ones; the full run writes tables. */
#include <gsl/gsl_fit.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include "analytic/analytic.h"
#include "core/clock.h"
#include "table/table.h"
#include "statics/equilibrium.h"
#include "tests/check.h"

typedef struct {
    size_t n, k;
    an_force *exact; /* forces of diagonal contacts alone */
    double *N, *H;
    statics_well *wells;
    statics_result result;
    double seconds; /* processor time to assemble and solve the pile */
} solved;

static void free_solved(solved *s)
{
    free(s->exact), free(s->N), free(s->H), free(s->wells);
}

static solved solve(long k, double alpha_deg, double eps, double well)
{
    solved s = {.k = (size_t)k};
    long *up = malloc(s.k * sizeof *up);
    CHECK_OK(an_lattice_cut(k, M_PI / 6, alpha_deg * M_PI / 180, up));
    for (size_t i = 0; i < s.k; i++) s.n += (size_t)up[i];
    statics_disk *disks = malloc(s.n * sizeof *disks);
    for (size_t i = 0, n = 0; i < s.k; i++)
        for (long j = 0; j < up[i]; j++)
            disks[n++] = (statics_disk){(double)i + 0.5 * (double)j, 0.5 + (double)j * sqrt(0.75), 0.5, 1};
    s.exact = malloc(s.k * sizeof *s.exact);
    s.N = calloc(s.k, sizeof *s.N);
    s.H = calloc(s.k, sizeof *s.H);
    s.wells = calloc(s.k, sizeof *s.wells);
    CHECK_OK(an_lattice_counts(k, up, M_PI / 6, s.exact));
    statics_definition def = statics_definition_default();
    def.n = s.n, def.disks = disks, def.eps = eps;
    if (well > 0) def.well = STATICS_WELL_FRICTION, def.mu = 1, def.a = well;
    statics_pile *pile = NULL;
    const double start = rp_cpu_clock();
    CHECK_OK(statics_create(&def, &pile));
    if (pile) {
        CHECK_OK(statics_solve(pile, &s.result));
        s.seconds = rp_cpu_clock() - start;
        statics_base(pile, NULL, s.N, s.H);
        statics_wells(pile, s.wells);
    }
    statics_free(pile), free(disks), free(up);
    return s;
}

/* The base carries the weight, and the horizontal forces of the ground balance. In an equilateral pile each
 * force equals that of diagonal contacts alone. Displacements near n eps sigma are rounded by n DBL_EPSILON
 * each; with a margin for the sum over the base. */
static void check_forces(const solved *s, double alpha_deg)
{
    const double rounding = 1e-14 * (double)s->n;
    double N = 0, H = 0;
    for (size_t i = 0; i < s->k; i++) {
        N += s->N[i];
        H += s->H[i];
        if (alpha_deg < 60) continue;
        CHECK_PAIRS(rounding, {s->N[i], s->exact[i].N}, {s->H[i], s->exact[i].H});
    }
    CHECK_PAIRS((double)s->k * rounding, {N, (double)s->n}, {H, 0});
    CU_ASSERT(s->result.negative_modes == 0 && s->result.smallest_pivot > 1e-4);
}

/* The pile of half the size predicts nearly all contacts, and the stiffness of wells: one factorisation at
 * any size. The force of a well of friction is mu N (x - x_0)/a. */
static void one_factorisation(void)
{
    static const long bases[] = {180, 360};
    for (int i = 0; i < (check_fast() ? 1 : 2); i++)
        for (double well = 0; well <= 100; well += 100) {
            solved s = solve(bases[i], 30, 0, well);
            check_forces(&s, 30);
            CU_ASSERT(s.result.factored == 1 && s.result.steps < 40 && s.result.horizontal > s.n / 2);
            for (size_t j = 0; well > 0 && j < s.k; j++)
                CHECK_NEAR(s.H[j], s.N[j] * s.wells[j].x / well, 1e-14 * (double)s.n);
            free_solved(&s);
        }
}

/* BLAS factorises from 20 000 disks on: repeated solutions have the same bits, and forces are exact. */
static void large_pile(void)
{
    if (CHECK_SKIPS("a long run of code that others run")) return;
    solved s = solve(201, 60, 0, 0), again = solve(201, 60, 0, 0);
    CU_ASSERT(s.n == 20301);
    check_forces(&s, 60);
    CU_ASSERT(memcmp(s.N, again.N, s.k * sizeof *s.N) == 0 && memcmp(s.H, again.H, s.k * sizeof *s.H) == 0);
    free_solved(&s);
    free_solved(&again);
}

/* A large pile on an unstable branch, which BLAS can't factorise. Its number of negative modes continues that
 * of a pile two layers smaller, below the threshold for BLAS; the number grows no faster than the pile. */
static void large_unstable_pile(void)
{
    if (CHECK_SKIPS("a long run of code that others run")) return;
    solved small = solve(199, 60, 3e-6, 0), large = solve(201, 60, 3e-6, 0);
    const double modes = (double)small.result.negative_modes, more = (double)large.result.negative_modes;
    CU_ASSERT(small.n < 20000 && large.n > 20000);
    CU_ASSERT(modes > 100 && more >= modes && more <= modes * pow(201.0 / 199, 4));
    free_solved(&small);
    free_solved(&large);
}

enum { SHAPES = 2, SIZES = 6 };

/* Slope of log y against log n by least squares. */
static double exponent(size_t count, const double n[], const double y[])
{
    double lx[SIZES], ly[SIZES], start, slope, cov[3], rest;
    for (size_t i = 0; i < count; i++) lx[i] = log(n[i]), ly[i] = log(y[i]);
    gsl_fit_linear(lx, 1, ly, 1, count, &start, &slope, cov, cov + 1, cov + 2, &rest);
    return slope;
}

typedef struct {
    double alpha_deg;
    size_t n;
    double seconds, memory;
    statics_result result;
} row;

/* In a separate process, whose peak memory is that of this pile. */
static row measure(double alpha_deg, long k, double eps, double well)
{
    row *shared = mmap(NULL, sizeof *shared, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    CU_ASSERT_FATAL(shared != MAP_FAILED);
    int status = -1;
    const pid_t child = fork();
    if (child == 0) {
        const solved s = solve(k, alpha_deg, eps, well);
        *shared = (row){alpha_deg, s.n, s.seconds, rp_peak_memory(), s.result};
        _Exit(EXIT_SUCCESS);
    }
    CU_ASSERT(child > 0 && waitpid(child, &status, 0) == child && status == 0);
    const row made = *shared;
    munmap(shared, sizeof *shared);
    return made;
}

/* Alpha = 30 and 60 degrees, from 360 to 250 000 disks; exponents are fitted to the larger half of sizes. */
static void table_of_sizes(void)
{
    static const double alpha_deg[SHAPES] = {30, 60};
    static const long bases[SHAPES][SIZES] = {{45, 77, 180, 387, 774, 1224}, {26, 45, 104, 223, 447, 707}};
    CHECK_TABLE(out, "scaling", NULL);
    if (!out) return;
    row rows[SHAPES][SIZES];
    rp_table_note(out, "seconds", "processor time to assemble and solve a linearised pile; memory: peak");
    for (int i = 0; i < SHAPES; i++) {
        double n[SIZES], seconds[SIZES], memory[SIZES];
        for (int j = 0; j < SIZES; j++) {
            const row r = rows[i][j] = measure(alpha_deg[i], bases[i][j], 0, 0);
            n[j] = (double)r.n;
            seconds[j] = r.seconds;
            memory[j] = r.memory;
            CU_ASSERT(r.result.fault == STATICS_OK && r.result.load == 1 && r.result.negative_modes == 0);
        }
        rp_table_note(out, check_text("seconds_exponent_%g", alpha_deg[i]), "%.2f",
                      exponent(SIZES / 2, n + SIZES / 2, seconds + SIZES / 2));
        rp_table_note(out, check_text("memory_exponent_%g", alpha_deg[i]), "%.2f",
                      exponent(SIZES / 2, n + SIZES / 2, memory + SIZES / 2));
    }
    rp_table_header(out, RP_CGS,
                    "alpha_deg [degrees], n_disks, seconds [s], memory [MB], steps, factorisations, "
                    "negative_modes, residual [m g]");
    for (const row *r = rows[0]; r < rows[0] + SHAPES * SIZES; r++)
        CHECK_ROW(out, NULL, r->alpha_deg, (double)r->n, r->seconds, r->memory, (double)r->result.steps,
                  (double)r->result.factored, (double)r->result.negative_modes, r->result.residual);
}

static int by_seconds(const void *a, const void *b)
{
    const double x = ((const row *)a)->seconds, y = ((const row *)b)->seconds;
    return (x > y) - (x < y);
}

/* The measurement with the median time of several. */
static row measure_median(size_t times, double alpha_deg, long k, double eps, double well)
{
    row r[5];
    for (size_t i = 0; i < times; i++) r[i] = measure(alpha_deg, k, eps, well);
    qsort(r, times, sizeof *r, by_seconds);
    return r[times / 2];
}

/* Goals and measured processor times of a solution: linearised and soft piles, on springs and in friction
 * wells. Soft piles of 100 000 disks take minutes and are left out. */
static void table_of_goals(void)
{
    static const struct {
        double alpha_deg, goal;
        long base;
        size_t times;
        bool soft;
    } piles[] = {
        {30, 0.005, 45, 5, true}, {60, 0.02, 45, 5, true}, {30, 0.15, 180, 3, true}, {30, 10, 774, 1, false}};
    CHECK_TABLE(out, "scaling_goals", NULL);
    if (!out) return;
    rp_table_note(out, "seconds",
                  "processor time to assemble and solve a pile and to count its modes, median of up to 5");
    rp_table_note(out, "eps", "0: linearised");
    rp_table_note(out, "well", "half-width of friction wells, mu = 1; 0: springs of K_s");
    rp_table_header(out, RP_CGS,
                    "alpha_deg [degrees], n_disks, eps, well [eps sigma], goal [s], seconds [s], "
                    "memory [MB], factorisations, negative_modes, verdict");
    for (size_t i = 0; i < sizeof piles / sizeof *piles; i++)
        for (int kind = 0; kind < (piles[i].soft ? 4 : 2); kind++) {
            const double eps = kind < 2 ? 0 : 1e-4, well = kind % 2;
            const row r = measure_median(piles[i].times, piles[i].alpha_deg, piles[i].base, eps, well);
            CU_ASSERT(r.result.fault == STATICS_OK && r.result.load == 1);
            CHECK_ROW(out, r.seconds <= piles[i].goal ? "met" : "missed", r.alpha_deg, (double)r.n, eps, well,
                      piles[i].goal, r.seconds, r.memory, (double)r.result.factored,
                      (double)r.result.negative_modes);
        }
}

/* tables first: forked processes do not inherit the threads that CHOLMOD starts */
CHECK_SUITE(scaling, "validation: scaling of the static solver", table_of_sizes, table_of_goals,
            one_factorisation, large_pile, large_unstable_pile)
