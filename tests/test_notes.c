/* Numbers in the lines above a table, `# key: ...`: each is computed a second time, from the table's own
 * rows, from what was written into its input, or by the library. */

#include "sweeps/protocols/pile.h"
#include "tests/faults.h"
#include "tests/program.h"
#include "tests/protocol.h"

/* The text of a note; a failed assertion and "" without. */
static const char *note(const rp_table *t, const char *key)
{
    const char *found = rp_table_find_note(t, key);
    if (!found) fprintf(stderr, "no note \"%s\"\n", key);
    CU_ASSERT_PTR_NOT_NULL(found);
    return found ? found : "";
}

/* The note is this text. */
#define check_note(t, key, ...) note_is(t, key, check_text(__VA_ARGS__))
static void note_is(const rp_table *t, const char *key, const char *expected)
{
    const char *found = note(t, key);
    if (strcmp(found, expected) != 0) fprintf(stderr, "%s: %s\nexpected: %s\n", key, found, expected);
    CU_ASSERT_STRING_EQUAL(found, expected);
}

/* ---- rows used and left out ---- */

/* Of 14 rows five serve, one has no result, two have nan; three lie below x = 1, three above 5. */
static void test_rows(void)
{
    static const struct {
        const char *command, *rows;
    } cases[] = {
        {"stats fit t.tsv -x x -y y --from 1 --to 5", "6 used, 2 left out for nan, 6 outside the range of x"},
        {"stats fit t.tsv -x x -y y --from 1 --to 5 --scale log",
         "6 used, 2 left out for nan, 6 outside the range of x"},
        {"stats trend t.tsv -x x -y y --from 1 --to 5",
         "5 used, 1 without result, 2 with nan, 6 outside the range of x"},
        {"stats correlation t.tsv -x x -y y", "11 used, 1 without result, 2 with nan"}};
    write_text(
        "t.tsv",
        "x\ty\tpart\tstatus\n1\t2.1\t1\tok\n2\t3.9\t1\tok\n3\t6.2\t2\tok\n4\t7.9\t2\tok\n5\t10.3\t2\tok\n"
        "2\t7\t1\tno_pile\n3\tnan\t1\tok\n4\tnan\t2\tok\n"
        "0.1\t1\t1\tok\n0.2\t1\t1\tok\n0.3\t1\t2\tok\n6\t1\t1\tok\n7\t1\t1\tok\n8\t1\t2\tok\n");
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        run("%s", cases[k].command);
        scoped_table t = read_table("out");
        check_note(&t, "rows", "%s", cases[k].rows);
    }
}

/* ---- static piles ---- */

/* What the notes say is what the tables beside them hold, and what the library finds for the same pile. */
static void check_pile_notes(const char *file, const sweep_solved *s, const rp_table *contacts,
                             const rp_table *wells)
{
    scoped_table t = read_table(file);
    size_t level = 0, left = 0;
    for (size_t i = 0; i < contacts->n_rows; i++) level += cell(contacts, i, "horizontal") == 1.0;
    for (size_t i = 0; i < wells->n_rows; i++) {
        left += strcmp(word(wells, i, "state"), "holds") != 0;
        /* positions up to 45 are rounded to 1e-14 */
        CHECK_NEAR(cell(wells, i, "x-x_0"), (cell(wells, i, "x") - cell(wells, i, "x_0")) / s->p->eps,
                   4e-14 / s->p->eps);
    }
    check_note(&t, "n_disks", "%zu", s->h->n);
    CHECK_NEAR(strtod(note(&t, "B"), NULL), s->h->B, 1e-12);
    check_note(&t, "contacts", "%zu, %zu of them horizontal", contacts->n_rows, level);
    check_note(&t, "wells", "%zu, %zu of them %s", wells->n_rows, left,
               s->p->set_again ? "set anew" : "broken");
    check_note(&t, "load", "%g of the weight; %zu jumps to another branch before", s->r.load, s->r.jumps);
    CHECK_NEAR(strtod(note(&t, "energy"), NULL), s->r.energy, 1e-9 * fabs(s->r.energy));
    CHECK_NEAR(strtod(note(&t, "residual"), NULL), 0.0, 1e-11);
    check_note(&t, "negative_modes", "%zu", s->r.negative_modes);
    check_note(&t, "smallest_pivot", "%.3g K_s, disk %zu", s->r.smallest_pivot, s->r.pivot_disk + 1);
    check_note(&t, "solver", "%zu steps, %zu factorisations", s->r.steps, s->r.factored);
}

/* Errors of N and H against diagonals alone, and how deep the base sinks: from the rows. */
static void check_base_notes(double eps)
{
    scoped_table t = read_table("d/base.tsv");
    double squares = 0.0, worst = 0.0, H = 0.0, H_diagonals = 0.0, most = 0.0;
    for (size_t i = 0; i < t.n_rows; i++) {
        const double error = cell(&t, i, "N/mg") / cell(&t, i, "N_diagonals/mg") - 1.0;
        squares += error * error;
        worst = fmax(worst, fabs(error));
        most = fmax(most, cell(&t, i, "N/mg"));
        H = fmax(H, fabs(cell(&t, i, "H/mg")));
        H_diagonals = fmax(H_diagonals, fabs(cell(&t, i, "H_diagonals/mg")));
    }
    check_note(&t, "N_error", "%.3g rms, %.3g at most, relative to diagonals alone",
               sqrt(squares / (double)t.n_rows), worst);
    check_note(&t, "H_ratio", "%.6g, the largest H over that of diagonals alone", H / H_diagonals);
    check_note(&t, "sinks", "%.3g sigma at most", eps * most);
}

static void test_pile(void)
{
    static const char *const files[] = {"d/base.tsv", "d/wells.tsv", "d/contacts.tsv", "d/disks.tsv"};
    static const char *const cases[][2] = {
        {"--base 12 --alpha-deg 30 --eps 1e-3", "base=12 alpha_deg=30 eps=1e-3"},
        {"--base 9 --eps 0.008 --branch minimum --leave 1", "base=9 eps=0.008 branch=minimum leave=1"},
        {"--base 20 --alpha-deg 55 --eps 3e-3", "base=20 alpha_deg=55 eps=3e-3"},
        {"--base 45 --alpha-deg 30 --eps 1e-4 --well 1 --mu 0.2 --set-again",
         "base=45 alpha_deg=30 eps=1e-4 well=1 mu=0.2 set_again=true"}};
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        scoped sweep_pile *p = PROTOCOL_PARAMS(&sweep_protocol_pile, cases[k][1]);
        RP_ENDS(sweep_outline_free) sweep_outline h = {0};
        RP_ENDS(sweep_solved_free) sweep_solved s;
        sweep_result r;
        CHECK_OK(sweep_pile_outline(p, 1, 0, &h));
        CHECK_OK(sweep_pile_solve(p, &h, NULL, NULL, &s, &r));
        GOOD("pile %s -o d", cases[k][0]);
        scoped_table contacts = read_table("d/contacts.tsv"), wells = read_table("d/wells.tsv");
        for (size_t f = 0; f < 4; f++) check_pile_notes(files[f], &s, &contacts, &wells);
        check_base_notes(p->eps);
        scoped_table t = read_table("d/base.tsv");
        CU_ASSERT((rp_table_find_note(&t, "released") != NULL) == !isnan(s.r.released));
        if (!isnan(s.r.released))
            check_note(&t, "released", "%.6g m g eps sigma, from the primary state on", s.r.released);
        SHELL("rm -r d");
    }
}

/* An option that would do nothing is refused by its name, and goes where it does something. */
static void test_idle_options(void)
{
    static const struct {
        const char *option, *idle, *serves;
    } cases[] = {{"--x-1 0.3", "--base 9 --alpha-deg 30", "--base 9 --alpha-deg 30 --inner-deg 40"},
                 {"--load-steps 2", "--base 4 --eps 0", "--base 4 --eps 1e-3"},
                 {"--leave 1", "--base 12 --eps 5e-3", "--base 12 --eps 5e-3 --branch minimum"},
                 {"--leave 1", "--base 12 --eps 0 --branch minimum", "--base 12 --eps 5e-3 --branch minimum"},
                 {"--branch minimum", "--base 12 --eps 0", "--base 12 --eps 5e-3"},
                 {"--k-x 0.5", "--base 4 --well 1", "--base 4"},
                 {"--set-again", "--base 4", "--base 4 --well 1"},
                 {"--mu 0.3", "--base 4", "--base 4 --well 1"},
                 {"--seed 2", "--base 4", "--base 4 --disorder 0.01 --eps 1e-4"},
                 {"--threshold", "--base 4 --eps 0", "--base 4 --eps 1e-3"},
                 {"--threshold", "--base 4 --eps 1e-3 --branch minimum", "--base 4 --eps 1e-3"},
                 {"--threshold", "--base 4 --eps 1e-3 -o d", "--base 4 --eps 1e-3"}};
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        const char *named = check_text("%.*s ", (int)strcspn(cases[k].option, " "), cases[k].option);
        const char *others = check_text("%.*s", (int)strcspn(cases[k].option, " "), cases[k].option);
        const int status = run("pile %s %s", cases[k].idle, cases[k].option);
        const bool right = strncmp(err, "repose pile: ", 13) == 0 &&
                           (strstr(err, "has no effect") ? strncmp(err + 13, named, strlen(named)) == 0
                                                         : strstr(err, others) != NULL);
        if (status != 64 || !right)
            fprintf(stderr, "pile %s %s: %d, %s", cases[k].idle, cases[k].option, status, err);
        CU_ASSERT(status == 64 && right);
        const int served = run("pile %s %s", cases[k].serves, cases[k].option);
        if (served > 1) fprintf(stderr, "pile %s %s: %d, %s", cases[k].serves, cases[k].option, served, err);
        CU_ASSERT(served == 0 || served == 1);
    }
    PRINTS("\n# H_ratio: nan, the", "pile --base 1");
}

/* On a terminal a line says how far a pile is that takes long, and is taken away. */
static void test_terminal(void)
{
    if (shell("script -qec true typed </dev/null >out 2>err") != 0) {
        check_skip_test("no terminal of script(1): progress of a pile");
    } else {
        SHELL("export REPOSE; script -qec '$REPOSE pile --base 4 --eps 1e-3 >rows' typed </dev/null >out");
        CU_ASSERT_STRING_EQUAL(out, "\r\033[K");
        SHELL("$REPOSE pile --base 4 --eps 1e-3 >out 2>err && grep -v '^#' out >plain; grep -v '^#' rows | "
              "cmp - plain >out");
        CU_ASSERT_STRING_EQUAL(err, "");
    }
}

/* ---- models ---- */

/* A pile cut from a lattice: B is the base of the triangle of slope alpha with as many cells, of 2 sin theta
 * by cos theta, and base disks are 2 sin theta apart about its middle. */
static void check_lattice(int base, double alpha_deg, double theta_deg)
{
    const double alpha = alpha_deg * M_PI / 180.0, theta = theta_deg * M_PI / 180.0;
    scoped_table t = TABLE_OF("lattice --base %d --alpha-deg %g --theta-deg %g", base, alpha_deg, theta_deg);
    double weight = 0.0;
    CU_ASSERT_FATAL(t.n_rows == (size_t)base);
    for (size_t i = 0; i < t.n_rows; i++) weight += cell(&t, i, "N/mg");
    CHECK_NEAR(strtod(note(&t, "disks"), NULL), weight, 1e-9); /* the base carries all of them */
    const double B = sqrt(4.0 * weight * 2.0 * sin(theta) * cos(theta) / tan(alpha));
    CHECK_NEAR(strtod(note(&t, "B"), NULL), B, 1e-9);
    for (size_t i = 0; i < t.n_rows; i++) {
        CHECK_NEAR(cell(&t, i, "i"), (double)i + 1.0, 0.0);
        CHECK_EACH(cell(&t, i, NAME), 1e-12,
                   {"x/B", 0.5 + 2.0 * sin(theta) * ((double)i - 0.5 * (base - 1)) / B},
                   {"N/(chi*g*B)", cell(&t, i, "N/mg") / B}, {"H/(chi*g*B)", cell(&t, i, "H/mg") / B});
    }
    check_note(&t, "base", "%d", base);
    check_note(&t, "layers", "auto");
    check_note(&t, "alpha-deg", "%g degrees", alpha_deg);
    check_note(&t, "theta-deg", "%g degrees", theta_deg);
    check_note(&t, "method", "closed");
    CU_ASSERT_PTR_NULL(rp_table_find_note(&t, "json"));
}

static void test_models(void)
{
    check_lattice(12, 30.0, 30.0);
    check_lattice(9, 40.0, 35.0);
    /* the closed form goes beyond the recursion, which has the same forces */
    FAILS(65, "10001 disks in the base: out of range, allowed: [1, 10000]",
          "lattice --layers 10001 --method recursion");
    FAILS(65, "10001 disks in the base: out of range",
          "lattice --base 10001 --alpha-deg 30 --method recursion");
    GOOD("lattice --base 10001 --alpha-deg 30");
    scoped_table t = TABLE_OF("lattice --layers 10001");
    CU_ASSERT_FATAL(t.n_rows == 10001);
    for (size_t i = 0; i < t.n_rows; i += 1000) CHECK_NEAR(cell(&t, i, "N/mg"), 5001.0, 1e-9);
    AGAIN_OF(t, "lattice --layers 45 --method recursion");
    check_note(&t, "method", "recursion");
    for (size_t i = 0; i < t.n_rows; i++) CHECK_NEAR(cell(&t, i, "N/mg"), 23.0, 1e-10);
    AGAIN_OF(t, "tent --outer-deg 30 --inner-deg 45 --x1 0.3 --points 2001");
    size_t top = 0, middle = t.n_rows / 2;
    for (size_t i = 0; i <= middle; i++)
        if (cell(&t, i, "N/(chi*g*B)") > cell(&t, top, "N/(chi*g*B)")) top = i;
    double dip, N, x, low;
    CU_ASSERT(sscanf(note(&t, "dip"), "%lf: N = %lf at %lf B, %lf in the middle", &dip, &N, &x, &low) == 4);
    CHECK_NEAR(cell(&t, middle, "x/B"), 0.5, 1e-9);
    CHECK_NEAR(low, cell(&t, middle, "N/(chi*g*B)"), 5e-5); /* four digits are printed */
    CHECK_NEAR(N, cell(&t, top, "N/(chi*g*B)"), 5e-5);
    CHECK_NEAR(x, cell(&t, top, "x/B"), 1e-3);
    CHECK_NEAR(dip, 1.0 - low / N, 5e-4);
    PRINTS("# dip: 0: ", "tent --outer-deg 45 --inner-deg 30 --x1 0.38");
    check_note(&t, "outer-deg", "30 degrees");
    check_note(&t, "inner-deg", "45 degrees");
    check_note(&t, "x1", "0.3 B");
    check_note(&t, "points", "2001");
    CU_ASSERT(!rp_table_find_note(&t, "at") && !rp_table_find_note(&t, "json"));
    AGAIN_OF(t, "continuum --alpha-deg 30");
    CU_ASSERT_FATAL(t.n_rows == 201);
    for (size_t i = 0; i < t.n_rows; i++) CHECK_NEAR(cell(&t, i, "x/B"), 0.005 * (double)i, 1e-15);
    AGAIN_OF(t, "continuum --alpha-deg 30 --points 4001");
    top = 0;
    for (size_t i = 0; i < t.n_rows / 2; i++)
        if (fabs(cell(&t, i, "H/(chi*g*B)")) > fabs(cell(&t, top, "H/(chi*g*B)"))) top = i;
    CHECK_NEAR(strtod(note(&t, "x_c/B"), NULL), cell(&t, top, "x/B"), 3e-4); /* the kink has the largest H */
}

/* ---- sweeps ---- */

/* The header of an exported sweep against its rows. */
static void check_export(size_t stored)
{
    run("sweep export s");
    scoped_table t = read_table("out");
    double seconds = 0.0;
    size_t failed = 0;
    CU_ASSERT_FATAL(t.n_rows == stored);
    for (size_t i = 0; i < stored; i++) {
        seconds += cell(&t, i, "seconds");
        failed += strncmp(word(&t, i, "status"), "ok", 2) != 0;
    }
    check_note(&t, "sweep", "s.cfg, protocol pile, seed 5, 2 grid points x 3 replicas");
    check_note(&t, "missing", "%zu of 6", 6 - stored);
    check_note(&t, "failed", "%zu of %zu (collapses %zu)", failed, stored, failed);
    CU_ASSERT(failed > 0 && failed < stored);
    CHECK_NEAR(strtod(note(&t, "run_time"), NULL), seconds, 0.0501); /* one decimal is printed */
    CU_ASSERT(strcmp(note(&t, "base"), "10") == 0 && strcmp(note(&t, "disorder"), "0.02") == 0);
    CU_ASSERT(rp_table_find_note(&t, "eps") == NULL); /* it is a column */
    char digest[64] = "";
    CU_ASSERT(strstr(note(&t, "runs made by"), check_text(" (%zu)", stored)) != NULL);
    if (stored == 6) {
        GOOD("sweep digest s");
        CU_ASSERT_FATAL(sscanf(out, "%63s", digest) == 1);
        check_note(&t, "source", "s %s 6", digest);
    }
    run("sweep status s");
    read_again(&t, "out");
    check_note(&t, "planned", "6");
    check_note(&t, "stored", "%zu", stored);
    check_note(&t, "missing", "%zu", 6 - stored);
    const double left = seconds / (double)stored * (double)(6 - stored);
    CHECK_NEAR(strtod(note(&t, "left"), NULL), left, 0.006 * left); /* three digits */
}

/* A copy with one more shard of two runs is merged twice, then into a sweep that shares two of its runs. */
static void check_merge(void)
{
    write_text("f.cfg",
               "protocol = \"pile\"; replicas = 2; seed = 5; fixed = { base = 10; disorder = 0.02; };\n"
               "grid = { eps = [5e-3]; };\n");
    GOOD("sweep plan f.cfg -o f");
    SHELL("cp -r s a");
    run("sweep run a -j 1 --shard 3/3");
    for (int again = 0; again < 2; again++) {
        run("sweep merge s a"); /* the store of the copy and its two shards */
        scoped_table t = read_table("out");
        check_note(&t, "stored", "4");
    }
    run("sweep merge f s");
    scoped_table t = read_table("out");
    check_note(&t, "stored", "1");
}

/* A sweep of which a shard is there, and one of its runs has no result; then all of it. */
static void test_sweep(void)
{
    write_text("s.cfg",
               "protocol = \"pile\"; replicas = 3; seed = 5; fixed = { base = 10; disorder = 0.02; };\n"
               "grid = { eps = [1e-4, 5e-3]; };\n");
    GOOD("sweep plan s.cfg -o s");
    run("sweep run s -j 1 --shard 2/3");
    check_export(2);
    check_merge();
    run("sweep run s -j 1");
    check_export(6);
}

static void tick(void)
{
    fault_monotonic_tick = 1.0;
}

/* A run says how long it took, from one look at the clock to another. */
static void test_run(void)
{
    write_text("s.cfg", "protocol = \"pile\"; replicas = 1; fixed = { base = 4; };\n");
    CU_ASSERT(run_begun("run s.cfg --row 0 -o d", tick) == 0);
    scoped_table t = read_table("out");
    const double seconds = strtod(note(&t, "run_time"), NULL);
    CU_ASSERT(seconds >= 1.0 && seconds == floor(seconds));
}

CHECK_SUITE_WITHIN(notes, "notes", enter, leave, test_rows, test_pile, test_idle_options, test_terminal,
                   test_models, test_sweep, test_run)
