/* Tests of the tests: each helper by which a test fails must fail where it should, NaN included. */
#include <limits.h>
#include <sys/wait.h>
#include <unistd.h>

#include "core/version.h"
#include "dem/state/state.h"
#include "tests/grains.h"
#include "tests/program.h"
#include "validation/cases.h"
#include "validation/oblique.h"
#include "validation/solved_pile.h"

/* How many assertions of a function fail, counted in a process of its own, which keeps its messages. */
static unsigned failures_of(void (*function)(void))
{
    int status = 0;
    fflush(NULL);
    const pid_t child = fork();
    if (child == 0) {
        const unsigned before = CU_get_number_of_failures();
        if (!freopen("/dev/null", "w", stderr)) _exit(255);
        function();
        _exit((int)(CU_get_number_of_failures() - before));
    }
    CU_ASSERT_FATAL(child > 0 && waitpid(child, &status, 0) == child && WIFEXITED(status));
    return (unsigned)WEXITSTATUS(status);
}

/* ---- check.h ---- */

static rp_status fails(void)
{
    return rp_fail(RP_BAD_INPUT, "mu = -1: out of range");
}

static rp_status passes(void)
{
    return RP_OK;
}

static void bad_numbers(void)
{
    CHECK_NEAR(1.0 + 0x1p-40, 1.0, 0x1p-41);
    CHECK_NEAR(1.0 - 0x1p-40, 1.0, 0x1p-41);
    CHECK_NEAR(NAN, 1.0, INFINITY);
    CHECK_NEAR(1.0, NAN, INFINITY);
    CHECK_NEAR(1.0, 1.0, NAN);
    CHECK_NEAR(INFINITY, 1.0, 1e300);
    CHECK_NEAR(INFINITY, INFINITY, 1.0); /* their difference is NaN */
    CHECK_NEAR(1.0, 1.0, -0x1p-60);
}

/* The same of pairs, and parts of a text. */
static void bad_pairs(void)
{
    CHECK_PAIRS(0x1p-41, {1.0 + 0x1p-40, 1.0}, {1.0, 1.0}, {1.0 - 0x1p-40, 1.0}, {NAN, 1.0}, {1.0, NAN});
    CHECK_PAIRS(NAN, {1.0, 1.0});
    CHECK_PARTS("one two", "one", "three", "two", "twos");
}

static void good_numbers(void)
{
    CHECK_PAIRS(0x1p-40, {1.0 + 0x1p-40, 1.0}, {1.0 - 0x1p-40, 1.0}, {2.385, 2.385});
    CHECK_PARTS("one two", "one", "e t", "two");
    CHECK_NEAR(1.0 + 0x1p-40, 1.0, 0x1p-40);
    CHECK_NEAR(1.0 - 0x1p-40, 1.0, 0x1p-40);
    CHECK_NEAR(2.385, 2.385, 0.0);
}

static void bad_statuses(void)
{
    CHECK_OK(fails());
    CHECK_FAILS(passes(), RP_BAD_INPUT, "");
    CHECK_FAILS(fails(), RP_IO, "out of range");
    CHECK_FAILS(fails(), RP_BAD_INPUT, "within range");
}

static void good_statuses(void)
{
    CHECK_OK(passes());
    CHECK_FAILS(fails(), RP_BAD_INPUT, "mu = -1: out of range");
}

static void test_check(void)
{
    CU_ASSERT(failures_of(bad_numbers) == 8 && failures_of(bad_pairs) == 7);
    CU_ASSERT(failures_of(good_numbers) == 0 && failures_of(bad_statuses) == 4);
    CU_ASSERT_EQUAL(failures_of(good_statuses), 0);
}

/* ---- cases of validation ---- */

static case_problem problem;

static void bad_cases(void)
{
    case_near(&problem, "v", 2.0, 2.0 + 0x1p-30, 0x1p-31, "e = %g", 0.5);
    case_near(&problem, "v", 2.0, 2.0 - 0x1p-30, 0x1p-31, "e = %g", 0.5);
    case_near(&problem, "v", 2.0, NAN, INFINITY, "e = %g", 0.5);
    case_near(&problem, "v", NAN, 2.0, INFINITY, "e = %g", 0.5);
    case_near(&problem, "v", 2.0, 2.0, NAN, "e = %g", 0.5);
}

/* Every case counts at full size. The tests run a second time with --full, this one alone. */
static void test_stride(void)
{
    char program[256] = "";
    if (check_full()) {
        CU_ASSERT_EQUAL(case_stride(7), 1);
        return;
    }
    CU_ASSERT_EQUAL(case_stride(7), check_fast() ? 35 : 7);
    CU_ASSERT_FATAL(readlink("/proc/self/exe", program, sizeof program - 1) > 0);
    SHELL(check_text("\"%s\" --full --test stride helpers >/dev/null 2>&1", program));
}

/* What is left out is counted: a part of a test, which passes, and a test, which does not. */
static void test_left_out(void)
{
    char program[256] = "";
    if (check_full()) {
        check_skip("a part");
        return;
    }
    CU_ASSERT_FATAL(readlink("/proc/self/exe", program, sizeof program - 1) > 0);
    CU_ASSERT(shell_line("\"%s\" --full --test 'left out' helpers >out 2>err", program) == 0);
    CHECK_PARTS(out, "  skipped left out: a part\n", "  skipped left out too: no need, for a test\n",
                "passed  helpers: left out, ", " skipped      3 tests or parts of them\n",
                "tests      2      1      1      0        1\n");
    CU_ASSERT_PTR_NULL(strstr(out, "passed  helpers: left out too"));
}

static void test_left_out_too(void)
{
    if (!check_full()) return;
    check_skip_test("no need, for a test");
    check_skip_test("and not twice");
}

static void no_case(void)
{
    case_problem empty = {.problem = "none"};
    case_write("nothing", (case_problem *[]){&empty}, 1);
}

/* The row of a case, and the largest error over its bound, NaN counted as the largest of all. */
static void test_cases(void)
{
    problem = (case_problem){.problem = "impact"};
    CU_ASSERT(failures_of(bad_cases) == 5 && failures_of(no_case) == 1);
    case_near(&problem, "exit speed", 2.0, 2.25, 0.5, "e = %g, law = %s", 0.5, "hertz");
    CHECK_NEAR(problem.worst, 0.5, 0.0);
    case_near(&problem, "time", 3.0, 2.875, 0.5, "e = %g", 0.25);
    CHECK_NEAR(problem.worst, 0.5, 0.0);
    case_near(&problem, "time", 3.0, 3.0, 0.0, "e = 1"); /* exact, and meant so */
    CHECK_NEAR(problem.worst, 0.5, 0.0);
    CU_ASSERT_EQUAL(problem.n, 3);
    CU_ASSERT_PTR_NOT_NULL_FATAL(problem.text);
    fflush(problem.text);
    CU_ASSERT_STRING_EQUAL(problem.rows, "impact\te,=,0.5,law,=,hertz\texit,speed\t2\t2.25\t0.25\t0.5\n"
                                         "impact\te,=,0.25\ttime\t3\t2.875\t0.125\t0.5\n"
                                         "impact\te,=,1\ttime\t3\t3\t0\t0\n");
    case_write("nothing", (case_problem *[]){&problem}, 1);
    CU_ASSERT(!problem.text && !problem.rows);
    CU_ASSERT_EQUAL(case_stride(3), check_full() ? 1 : check_fast() ? 15 : 3);
}

/* A run with --full -o writes both tables: a row a problem with its source and bound, and a row a case. */
static void test_case_tables(void)
{
    char program[256] = "";
    if (check_full()) {
        case_problem two[] = {{.problem = "impact", .source = "equation (1)", .bound = "order 2"},
                              {.problem = "roll", .source = "equation (7)", .bound = "order 4"}};
        case_near(&two[0], "speed", 2.0, 2.25, 0.5, "e = 1");
        case_near(&two[1], "time", 3.0, 3.25, 1.0, "e = 2");
        case_near(&two[1], "spin", 4.0, 4.75, 1.0, "e = 3");
        case_write("made", (case_problem *[]){&two[0], &two[1]}, 2);
        return;
    }
    CU_ASSERT_FATAL(readlink("/proc/self/exe", program, sizeof program - 1) > 0);
    CU_ASSERT(shell_line("\"%s\" --full -o . --test 'case tables' helpers >out 2>err", program) == 0);
    scoped_table t = read_table("made/made.tsv"), cases = read_table("made/cases.tsv");
    CU_ASSERT_STRING_EQUAL(rp_table_find_note(&t, "source_impact"), "equation (1)");
    CU_ASSERT_STRING_EQUAL(rp_table_find_note(&t, "bound_impact"), "order 2");
    CU_ASSERT_STRING_EQUAL(rp_table_find_note(&t, "source_roll"), "equation (7)");
    CU_ASSERT_STRING_EQUAL(rp_table_find_note(&t, "bound_roll"), "order 4");
    CU_ASSERT(t.n_rows == 2 && cases.n_rows == 3);
    static const struct {
        const char *problem, *parameters, *quantity;
        double expected, observed, error, bound;
    } rows[] = {{"impact", "e,=,1", "speed", 2.0, 2.25, 0.25, 0.5},
                {"roll", "e,=,2", "time", 3.0, 3.25, 0.25, 1.0},
                {"roll", "e,=,3", "spin", 4.0, 4.75, 0.75, 1.0}};
    for (size_t i = 0; i < 3; i++) {
        CU_ASSERT_STRING_EQUAL(word(&cases, i, "problem"), rows[i].problem);
        CU_ASSERT_STRING_EQUAL(word(&cases, i, "parameters"), rows[i].parameters);
        CU_ASSERT_STRING_EQUAL(word(&cases, i, "quantity"), rows[i].quantity);
        CHECK_EACH(cell(&cases, i, NAME), 0.0, {"expected", rows[i].expected}, {"observed", rows[i].observed},
                   {"error", rows[i].error}, {"bound", rows[i].bound});
    }
    for (size_t i = 0; i < 2; i++) {
        CU_ASSERT_STRING_EQUAL(word(&t, i, "problem"), rows[i].problem);
        CHECK_EACH(cell(&t, i, NAME), 0.0, {"cases", 1.0 + (double)i}, {"worst_over_bound", i ? 0.75 : 0.5});
    }
}

/* ---- oblique impact ---- */

/* kappa = 1/a: with W = 1 the shear spring swings as the normal one, and a grain that sticks leaves with its
 * slip reversed. Slow friction slides throughout: the slip falls by 2 a mu v_n. */
static void test_oblique(void)
{
    const double a = 3.5;
    for (int sign = -1; sign < 2; sign += 2) {
        CHECK_NEAR(oblique_left(a, 1.0 / a, 50.0, 1.0, sign * 0.3), sign * -0.3, 1e-9);
        CHECK_NEAR(oblique_left(a, 1.0 / a, 0.05, 1.0, sign * 2.0), sign * (2.0 - 2.0 * a * 0.05), 1e-9);
        CHECK_NEAR(oblique_left(a, 0.8, 0.05, 2.0, sign * 4.0), sign * (4.0 - 2.0 * a * 0.05 * 2.0), 1e-9);
        /* two swings of stick for W = 2 */
        CHECK_NEAR(oblique_left(a, 4.0 / a, 50.0, 1.0, sign * 0.3), sign * 0.3, 1e-9);
        /* three halves of a swing, but for the end, where the normal force no longer holds the spring */
        CHECK_NEAR(oblique_left(a, 2.25 / a, 50.0, 1.0, sign * 0.3), 0.0, 2e-3);
    }
}

/* With a mu v_n = 1 and kappa = W^2/a: sliding from v on, to the time t_1 at which v - 1 + cos t_1 = cos
 * t_1/W^2; sticking, where the spring swings at W, until it exceeds sin t/W^2 at t_2, between lo and hi; then
 * sliding, by the sign of the spring. */
static double slide_stick_slide(double W, double v, double lo, double hi)
{
    const double limit = 1.0 / (W * W), t_1 = acos((v - 1.0) / (limit - 1.0)), v_1 = limit * cos(t_1);
    const double spring = limit * sin(t_1);
    for (int k = 0; k < 100; k++) {
        const double t = 0.5 * (lo + hi), x = W * (t - t_1);
        *(fabs(spring * cos(x) + v_1 / W * sin(x)) > limit * sin(t) ? &hi : &lo) = t;
    }
    const double x = W * (hi - t_1), at = spring * cos(x) + v_1 / W * sin(x);
    return v_1 * cos(x) - spring * W * sin(x) - copysign(1.0, at) * (cos(hi) + 1.0);
}

static void test_oblique_changes(void)
{
    static const double cases[][4] = {{1.3, 0.7, 2.6, 2.9},  {1.5, 1.2, 2.8, 3.05}, {2.0, 0.5, 2.2, 2.5},
                                      {2.0, 1.5, 2.9, 3.05}, {2.5, 0.3, 2.7, 2.95}, {3.0, 1.2, 2.4, 2.65}};
    const double a = 3.5, v_n = 2.0;
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        const double *c = cases[k], expected = slide_stick_slide(c[0], c[1], c[2], c[3]);
        for (int sign = -1; sign < 2; sign += 2)
            CHECK_NEAR(oblique_left(a, c[0] * c[0] / a, 1.0 / (a * v_n), v_n, sign * c[1]), sign * expected,
                       1e-12);
    }
}

/* Sticking until the normal force no longer holds the spring, so shortly before the end that the spring
 * swings by three quarters: then the slip still changes by the impulse that is left. */
static void test_oblique_end(void)
{
    const double a = 3.5, W = 1.5, mu = 500.0, v = 0.3, limit = a * mu / (W * W);
    double lo = M_PI - 1e-3, hi = M_PI;
    for (int k = 0; k < 100; k++) {
        const double t = 0.5 * (lo + hi);
        *(fabs(v / W * sin(W * t)) > limit * sin(t) ? &hi : &lo) = t;
    }
    CU_ASSERT(hi > M_PI - 3e-4 && hi < M_PI - 2e-4);
    CHECK_NEAR(oblique_left(a, W * W / a, mu, 1.0, v), v * cos(W * hi) + a * mu * (cos(hi) + 1.0), 1e-10);
}

/* ---- scenes of the tests ---- */

/* Any difference in any bit of a state is one. */
static void test_same_bits(void)
{
    dem_grain one = {.x = 0.3, .y = 0.7, .r = 0.1, .m = 0.2, .vx = 1.5, .vy = -2.5};
    dem_definition def = grains_of(1, &one);
    scoped_sim *a = grains_start(&def), *same = grains_start(&def);
    CU_ASSERT(grains_same_bits(a, same));
    double *const members[] = {&one.x, &one.y, &one.r, &one.m, &one.vx, &one.vy};
    for (size_t k = 0; k < sizeof members / sizeof *members; k++) {
        const double old = *members[k];
        *members[k] = nextafter(old, 9.0);
        scoped_sim *other = grains_start(&def);
        CU_ASSERT(!grains_same_bits(a, other));
        *members[k] = old;
    }
    CHECK_OK(dem_run(same, 1));
    CU_ASSERT(!grains_same_bits(a, same));
    one.vx = one.vy = 0.0;
    one.fixed = true;
    scoped_sim *fixed = grains_start(&def);
    CU_ASSERT(grains_same_bits(fixed, fixed) && !grains_same_bits(a, fixed));
}

/* A pair that is missing or too far apart is a wrong one; one of two fixed grains belongs to no list. */
static void test_wrong_pairs(void)
{
    dem_grain three[] = {{.x = 0.0, .y = 1.0, .r = 0.1, .m = 1.0},
                         {.x = 0.2, .y = 1.0, .r = 0.1, .m = 1.0},
                         {.x = 9.0, .y = 1.0, .r = 0.1, .m = 1.0}};
    dem_definition def = grains_of(3, three);
    scoped_sim *sim = grains_start(&def);
    CU_ASSERT_FATAL(sim->pairs.n == 1);
    CU_ASSERT(grains_wrong_pairs(sim) == 0);
    sim->pairs.n = 0;
    CU_ASSERT(grains_wrong_pairs(sim) == 1);
    sim->pairs.n = 1;
    const double cutoff = sim->grains.cutoff[0];
    sim->grains.cutoff[0] = 0.0;
    sim->grains.listed_x[1][0] += 1.0;
    CU_ASSERT(grains_wrong_pairs(sim) == 1);
    sim->grains.cutoff[0] = cutoff;
    sim->grains.listed_x[1][0] -= 1.0;
    const uint32_t other = sim->pairs.j[0];
    sim->pairs.j[0] = sim->pairs.i[0]; /* of a removed grain, so that the pair is missing */
    CU_ASSERT(grains_wrong_pairs(sim) == 1);
    sim->pairs.j[0] = other;
    sim->grains.inverse_mass[0] = sim->grains.inverse_mass[1] = 0.0;
    CU_ASSERT(grains_wrong_pairs(sim) == 1);
}

/* So soft that neighbours slide apart, although every well holds: no result, and a state that is no pile. */
static void collapsing_pile(void)
{
    RP_ENDS(solved_pile_free) solved_pile pile = solved_pile_make(7, 60.0, 0.1, 1);
}

/* Close-packed disks of unit diameter on the ground, a part of 1e-13 lower, each on two of the row below. */
static void check_lattice(const solved_pile *pile)
{
    size_t ground = 0, pairs = 0;
    for (size_t i = 0; i < pile->n; i++) {
        const dem_grain *a = &pile->grains[i];
        CU_ASSERT(a->r == 0.5 && a->m == 1.0);
        ground += a->y < 0.5 && a->y > 0.5 - 2e-13;
        for (size_t j = 0; j < pile->n; j++) {
            const dem_grain *b = &pile->grains[j];
            const double apart = hypot(a->x - b->x, a->y - b->y);
            CU_ASSERT(i == j || apart > 1.0 - 1e-12);
            pairs += b->y > a->y + 0.1 && fabs(apart - 1.0) < 1e-12;
        }
    }
    CU_ASSERT_EQUAL(ground, pile->k);
    CU_ASSERT_EQUAL(pairs, 2 * (pile->n - ground));
}

/* The lattice pile in equilibrium: its scene holds the disks without weight, loading raises gravity to 1. */
static void test_solved_pile(void)
{
    const double eps = 1e-4;
    CU_ASSERT_EQUAL(failures_of(collapsing_pile), 2);
    RP_ENDS(solved_pile_free)
    solved_pile triangle = solved_pile_make(7, 60.0, eps, 1), pile = solved_pile_make(7, 30.0, eps, 1);
    CU_ASSERT_EQUAL(triangle.n, 28); /* the whole triangle */
    CU_ASSERT_EQUAL(pile.n,
                    12); /* 7 + 4 + 1: row j has the middles with j <= 2/3 of the way to the nearer end */
    double N = 0.0, H = 0.0;
    for (size_t i = 0; i < pile.k; i++) N += pile.N[i], H += pile.H[i];
    CHECK_PAIRS(1e-9, {N, (double)pile.n}, {H, 0.0});
    check_lattice(&pile);
    const dem_definition def = solved_pile_scene(&pile, DEM_VERLET, 0.3, 0.02);
    const double omega = 1.0 / sqrt(eps);
    CHECK_PAIRS(1e-15, {def.dt * omega, 0.02}, {def.material.gamma_n / omega, 0.3});
    CHECK_NEAR(def.material.k_n, 1.0 / eps, 1e-8);
    CHECK_NEAR(def.ground.a, eps, 1e-18);
    CU_ASSERT(def.gravity[0] == 0.0 && def.gravity[1] == 0.0 && def.n_grains == pile.n);
    scoped_sim *sim = grains_start(&def);
    solved_pile_load(sim, 40);
    CU_ASSERT_EQUAL(dem_step(sim), 40);
    scoped dem_state *states = grains_states(sim);
    double fy = 0.0, floor = 0.0;
    for (size_t i = 0; i < pile.n; i++) fy += states[i].fy;
    double forces[2 * DEM_FEW_WALLS] = {0};
    grains_wall_forces(sim, forces);
    floor = forces[1];
    CHECK_NEAR(fy, -(double)pile.n - floor,
               1e-9 * (double)pile.n); /* weight and ground are all that acts from outside */
}

/* ---- provenance ---- */

/* The program names the commit that it was built from, as the build noted it beside the program. */
static void test_commit(void)
{
    SHELL("cat \"$(dirname \"$REPOSE\")/commit\" >out 2>err");
    const char *commit = check_text("%.*s", (int)strcspn(out, "\n"), out);
    CU_ASSERT(*commit != 0);
    CU_ASSERT_STRING_EQUAL(rp_build_commit, commit);
    PRINTS(check_text("commit %s", commit), "lattice --layers 2");
}

/* A commit is named as such only where the files are its own; what a study has written is none of them. */
static void test_dirty_commit(void)
{
    static const char script[] =
        "exec >out 2>err; here=$PWD; tar -C \"$REPOSE_SOURCE\" --exclude=./build* --exclude=./.git "
        "--exclude=./results -c . | tar x && git init -q . && mkdir results && echo 1 >results/t && echo 1 "
        ">code && git add . ':!out' ':!err' && git -c user.name=a -c user.email=a@b commit -q -m a || exit "
        "8; say() { env -u MAKEFLAGS -u MFLAGS make -s build/commit >&2 && cat build/commit; }; a=$(say); "
        "case $a in ''|unknown|*-dirty) exit 1;; esac; echo 2 >results/t; [ \"$(say)\" = $a ] || exit 2; "
        "echo 2 >code; [ \"$(say)\" = $a-dirty ] || exit 3; git add code; [ \"$(say)\" = $a-dirty ] || exit "
        "4; git checkout -q HEAD code; [ \"$(say)\" = $a ] || exit 5";
    char source[PATH_MAX];
    CU_ASSERT_PTR_NOT_NULL_FATAL(getcwd(source, sizeof source));
    setenv("REPOSE_SOURCE", source, 1);
    SHELL(script);
}

CHECK_SUITE_WITHIN(helpers, "helpers", enter, leave, test_check, test_cases, test_stride, test_left_out,
                   test_left_out_too, test_case_tables, test_oblique, test_oblique_changes, test_oblique_end,
                   test_same_bits, test_wrong_pairs, test_solved_pile, test_commit, test_dirty_commit)
