/* Calibration by real runs: friction, damping and stiffness that are known, found again from impacts of
 * single grains on a floor. One to three names, ten cases each in the full run, which writes a table. */
#include "core/random.h"
#include "tests/numbers.h"
#include "tests/program.h"

/* An oblique impact; the scatter is that of the grains' radii. */
static const char impact[] =
    "let = { mu = 0.2; gamma = 2000.0; k = 1.0e6; };\n"
    "dt = 2e-6; gravity = (0.0, 0.0); rotation = true;\n"
    "normal = { law = \"linear\"; k_n = \"k\"; gamma_n = \"gamma\"; };\n"
    "tangential = { law = \"spring\"; mu = \"mu\"; k_s = 1e6; gamma_s = 0.0; };\n"
    "walls = ( { name = \"floor\"; point = (0.0, 0.0); direction = (0.0, 1.0); } );\n"
    "phases = (\n"
    "  { name = \"fall\"; every = 1; until = \"floor.fy < 0\"; most = 10000;\n"
    "    add = { x = 0.0; y = \"1.01*r\"; vx = 60.0; vy = -40.0; radius_mean = 0.1; radius_width = 0.004; }; "
    "},\n"
    "  { name = \"impact\"; every = 1; until = \"floor.fy >= 0\"; most = 10000; } );\n"
    "measure = ( { name = \"u\"; of = \"vx\"; }, { name = \"v\"; of = \"vy\"; },\n"
    "            { name = \"ms\"; of = \"1000*t\"; at = \"impact\"; } );\n";

enum { NAMES = 3, RUNS = 16 };
static const struct {
    const char *name, *number;
    double lo, hi;
} of[NAMES] = {{"mu", "u", 0.05, 0.45}, {"gamma", "v", 500.0, 4000.0}, {"k", "ms", 5e5, 2e6}};

/* Runs at the truth, which a measurement would be. */
static void measure(size_t names, const double truth[], int seed, double value[], double error[])
{
    FILE *file = file_of("truth.cfg");
    fprintf(file, "experiment = \"impact.cfg\"; replicas = %d; seed = %d;\nfixed = { ", RUNS, seed);
    for (size_t p = 0; p < names; p++) fprintf(file, "%s = %.17e; ", of[p].name, truth[p]);
    fputs("};\n", file);
    fclose(file);
    SHELL("rm -rf truth && $REPOSE sweep make truth.cfg -o truth --quiet >out 2>err && $REPOSE "
          "sweep export truth --reduce >out 2>err");
    scoped_table t = read_table("out");
    for (size_t p = 0; p < names; p++) {
        value[p] = cell(&t, 0, check_text("%s_mean", of[p].number));
        error[p] = cell(&t, 0, check_text("%s_se", of[p].number));
    }
}

static void write_fit(size_t names, int seed, const double value[], const double error[])
{
    FILE *file = file_of("fit.cfg");
    fprintf(file, "seed = %d; budget = 20000; fit = { ", seed);
    for (size_t p = 0; p < names; p++) fprintf(file, "%s = [%.2f, %.2f]; ", of[p].name, of[p].lo, of[p].hi);
    fputs("};\nmeasured = ( ", file);
    for (size_t p = 0; p < names; p++)
        fprintf(file, "%s{ experiment = \"impact.cfg\"; of = \"%s\"; value = %.17e; error = %.17e; }",
                p ? ",\n  " : "", of[p].number, value[p], error[p]);
    fputs(" );\n", file);
    fclose(file);
}

static void test_found_again(void)
{
    const int cases = check_full() ? 10 : 1;
    scoped_rng *rng = rp_random_alloc(39, 3, RP_PURPOSE_TEST);
    CHECK_TABLE(table, "calibration", "names, case, parameter, truth, value, lower, upper, status");
    int inside = 0, near = 0, n = 0;
    write_text("impact.cfg", "%s", impact);
    for (size_t names = 1; names <= (check_full() ? NAMES : 1); names++)
        for (int k = 0; k < cases; k++) {
            double truth[NAMES], value[NAMES], error[NAMES];
            for (size_t p = 0; p < names; p++)
                truth[p] = of[p].lo + (of[p].hi - of[p].lo) * (0.2 + 0.6 * gsl_rng_uniform(rng));
            measure(names, truth, 100 * (int)names + k, value, error);
            write_fit(names, 7 + k, value, error);
            const int status = shell("rm -rf found && $REPOSE calibrate fit.cfg -o found --quiet >out 2>err");
            if (status > 1) fprintf(stderr, "%s", err);
            CU_ASSERT(status == RP_OK || status == RP_NO_RESULT);
            scoped_table t = read_table("out");
            CU_ASSERT_FATAL(t.n_rows >= names);
            for (size_t row = 0; row < names; row++) {
                const double lower = cell(&t, row, "lower"), upper = cell(&t, row, "upper");
                inside += truth[row] >= lower && truth[row] <= upper;
                near += truth[row] >= 2.0 * lower - upper && truth[row] <= 2.0 * upper - lower;
                n++;
                if (!table) continue;
                fprintf(table, "%zu\t%d\t%s\t%.6g\t%.6g\t%.6g\t%.6g\t%s\n", names, k, of[row].name,
                        truth[row], cell(&t, row, "value"), lower, upper, word(&t, row, "status"));
            }
        }
    /* 95 % of 60, less four standard errors; of one, within three half-widths */
    CU_ASSERT(near >= n - n / 30 && (n < 50 || inside >= 50));
    fprintf(stderr, "calibration: %d of %d intervals hold the truth\n", inside, n);
}

CHECK_SUITE_WITHIN(calibration, "calibration", enter, leave, test_found_again)
