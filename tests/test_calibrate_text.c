/* repose calibrate FILE: a planted friction is found by runs; tables of other programs; what is refused. */
#include <signal.h>

#include "numbers.h"
#include "program.h"

#include <gsl/gsl_randist.h>

/* A grain slides down an incline: x = g (sin - mu cos) t^2/2; the scatter is that of its radius. */
static const char slide[] =
    "let = { mu = { value = 0.2; range = \"[0.05, 0.5]\"; }; mu_roll = 0.1; T = 0.05; };\n"
    "dt = 1e-5; gravity = (\"1000*sin(30*deg)\", \"-1000*cos(30*deg)\"); seed = 4;\n"
    "tangential = { law = \"spring\"; mu = \"mu\"; k_s = 1e6; gamma_s = 0.0; };\n"
    "walls = ( { point = (0.0, 0.0); direction = (0.0, 1.0); } );\n"
    "fill = { N = 4; pattern = \"row\"; W = 0.9; x0 = 0.0; };\n"
    "phases = ( { name = \"go\"; time = \"T\"; } );\n"
    "measure = ( { name = \"way\"; of = \"x\"; }, { name = \"v\"; of = \"vx + 0.1*x\"; },\n"
    "            { name = \"both\"; of = \"vx + 20*mu_roll\"; }, { name = \"twice\"; of = \"2*vx + "
    "40*mu_roll\"; } );\n";

static void write_fit(const char *measured)
{
    write_text("fit.cfg", "fit = { mu = [0.05, 0.45]; };\nbudget = 400;\nmeasured = ( %s );\n", measured);
}

static double found(const char *name, const char *column)
{
    scoped_table t = read_table("out");
    for (size_t i = 0; i < t.n_rows; i++)
        if (strcmp(word(&t, i, "parameter"), name) == 0) return cell(&t, i, column);
    return NAN;
}

static void test_runs(void)
{
    write_text("slide.cfg", "%s", slide);
    /* v = 1000 (0.5 - mu cos 30) t, at mu = 0.3 */
    write_fit("{ experiment = \"slide.cfg\"; of = \"v\"; value = 12.05; error = 0.3; }");
    SHELL("$REPOSE calibrate fit.cfg -o c >out 2>err");
    CHECK_NEAR(found("mu", "value"), 0.3, 0.01);
    CU_ASSERT(found("mu", "lower") < 0.3 && found("mu", "upper") > 0.3);
    CHECK_NEAR(found("mu", "se"), 0.3 / (50.0 * 0.866), 0.003);
    CU_ASSERT(strstr(err, "stage 1, slide.cfg: 12 points, 2 runs each") != NULL);
    SHELL("cmp out c/answer.tsv && ! test -e c.part");
    GOOD("run c/stage_1_1.cfg --row 3 -o row");
    scoped_table runs = read_table("c/stage_1_1.tsv"), row = read_table("out");
    CHECK_NEAR(cell(&runs, 3, "v"), cell(&row, 0, "v"), 0.0);
    FAILS(65, "c: holds fit.cfg, key ", "calibrate fit.cfg -o c");
    /* an answer that the budget ends has no name; more goes on */
    FAILS(1, "; 24 of 30 runs are made, and the next stage needs 24 more: give a larger --budget",
          "calibrate fit.cfg -o b --budget 30 --quiet");
    SHELL("! test -e b && test -s b.part/stage_1_1.tsv");
    CU_ASSERT(run("calibrate fit.cfg -o b") == 0);
    CU_ASSERT(strstr(err, "stage 2, slide.cfg: 12 points") && !strstr(err, "stage 1, "));
    SHELL("for d in b c; do grep -v '^# command' $d/answer.tsv >$d.answer; done; cmp b.answer c.answer");
    write_fit("{ experiment = \"slide.cfg\"; of = \"v\"; value = 40.0; error = 0.3; }");
    FAILS(65, "c: holds fit.cfg, key ", "calibrate fit.cfg -o c");
    FAILS(1, "; the runs reach 6.66 to 20.8, for 0.05 <= mu <= 0.45",
          "calibrate fit.cfg -o c --force --quiet");
    SHELL("grep -q above_range c/answer.tsv");
    PRINTS("first stage: 12 points, 24 runs; at most 400", "calibrate fit.cfg --dry-run -o d");
    PRINTS("theta_r3_deg\t1\t30\t1", "calibrate --theta-r-deg 30 --error-deg 1 -o d --dry-run");
    SHELL("! test -e d && ! test -e d.part"); /* a dry run writes nothing */
    /* two numbers of two texts, a name that one of them lacks */
    SHELL("sed 's/mu_roll/push/g' slide.cfg >pushed.cfg");
    write_text("lacks.cfg",
               "fit = { mu = [0.05, 0.45]; push = [0.0, 0.5]; };\n"
               "measured = ( { experiment = \"pushed.cfg\"; of = \"both\"; value = 16.0; error = 0.5; },\n"
               " { experiment = \"slide.cfg\"; of = \"v\"; value = 12.05; error = 0.3; } );\n");
    GOOD("calibrate lacks.cfg -o h --quiet");
    CHECK_NEAR(found("mu", "value"), 0.3, 0.02);
    CHECK_NEAR(found("push", "value"), 0.2, 0.05);
    SHELL("grep -q push h/stage_1_1.cfg && ! grep -q push h/stage_1_2.cfg");
    /* of one text with values of its own, where not all is allowed */
    write_text(
        "two.cfg",
        "fit = { mu = [0.05, 0.45]; mu_roll = [0.0, 0.5]; }; where = \"mu_roll < 2*mu\"; budget = 900;\n"
        "measured = ( { experiment = \"slide.cfg\"; of = \"both\"; value = 16.0; error = 0.5; },\n"
        " { experiment = \"slide.cfg\"; of = \"v\"; value = 12.05; error = 0.3; fixed = { T = 0.05; }; } "
        ");\n");
    SHELL("$REPOSE calibrate two.cfg -o e >out 2>err");
    CHECK_NEAR(found("mu", "value"), 0.3, 0.02);
    CHECK_NEAR(found("mu_roll", "value"), 0.2, 0.05);
    CHECK_PARTS(out, "# runs: 160 at 40 points, 0 of them without some measure, in 2 stages\n",
                "# v: measured 12.05 +- 0.3, fitted 12.05 +- 0.014", "; runs reach 6.11459 to 20.2175\n",
                "# left out: 22 of 22 points", "# determined: mu - 0.1983 mu_roll = 0.26082 +- 0.0063\n",
                "# correlation: mu and mu_roll: 0.51\n"); /* 0.3 of v's error over hypot(0.3, 0.5) */
    SHELL("sed -i 's/.*of = .v.*/ );/; s/error = 0.5; },/error = 0.5; }/' two.cfg && ! $REPOSE "
          "calibrate two.cfg -o f >out 2>err");
    CHECK_PARTS(
        err, "not_identified: ", /* both = 25 - 43.3 mu + 20 mu_roll, of which twice tells no more */
        "determined is mu - 0.4662 mu_roll = 0.20647 +- 0.015; best measure to separate the variables: v of "
        "slide.cfg "
        "(differs",
        "\nrepose calibrate: after stage 1: mu 0.185 to 0.45, at_least, mu_roll 0 to 0.5, not_identified; "
        "determined is mu - 0.4654 mu_roll = 0.20618");
    /* best values at an end of their range */
    SHELL("sed -i 's/ where = .*2.mu.; / /; s/16.0; error = 0.5/34.0; error = 9.0/' two.cfg && ! $REPOSE "
          "calibrate two.cfg -o g >out 2>err");
    CU_ASSERT(strstr(err, "not_identified: ") && !strstr(err, "determined is") &&
              strstr(out, "# determined: unknown, because the best values lie at an end") != NULL);
    CHECK_PARTS(out, "# both: measured 34 +- 9, fitted 32.8349 +- ", ", residual 0.13; form p = ");
}

/* Numbers of another program: 0.4 + 2 a + a^2 at the points of a table. */
static void test_table(void)
{
    scoped_rng *noise = numbers_of(5, 5);
    FILE *table = file_of("t.tsv");
    fputs("a\ty\n", table);
    for (int i = 0; i < 10; i++)
        for (int k = 0; k < 4; k++)
            fprintf(table, "%g\t%.17g\n", 0.1 * i,
                    0.4 + 0.2 * i + 0.01 * i * i + gsl_ran_gaussian(noise, 0.02));
    fclose(table);
    write_text("fit.cfg", "fit = { a = [0.0, 0.9]; };\n"
                          "measured = ( { runs = \"t.tsv\"; of = \"y\"; value = 1.65; error = 0.02; "
                          "model_error = 0.01; } );\n");
    SHELL("sed -i '2s/^0/-0.0/' t.tsv"); /* the point 0 */
    GOOD("calibrate fit.cfg");
    CU_ASSERT(strstr(out, "# runs: 40 at 10 points, 0 of them without some measure, 10 repeated\n") != NULL);
    CHECK_NEAR(found("a", "value"), 0.5, 0.02);
    CHECK_NEAR(found("a", "se"), hypot(hypot(0.02, 0.01), 0.006) / 3.0, 0.001);
    CU_ASSERT(strstr(out, "; form p = 0.") != NULL);
    /* no point twice: that is said, and the form is not tested */
    SHELL("awk 'NR % 4 == 2 || NR == 1' t.tsv >once.tsv && sed 's/t[.]tsv/once.tsv/' fit.cfg >once.cfg");
    GOOD("calibrate once.cfg");
    CHECK_PARTS(out,
                "# runs: 10 at 10 points, 0 of them without some measure, none repeated, so that scatter",
                "; form p = not known; ");
    /* a step that no polynomial follows, many times measured: no value, no fit, no combination */
    SHELL("awk 'BEGIN { print \"a\\tb\\ty\"; for (i = 0; i < 400; i++) { a = i % 10; b = int(i / 10) % 10;"
          " printf \"%g\\t%g\\t%.9g\\n\", a, b, (a + b > 9) + (a > 4) + 0.001 * (i * 7 % 11) } }' "
          ">step.tsv");
    write_text("step.cfg",
               "fit = { a = [0.0, 9.0]; b = [0.0, 9.0]; };\nmeasured = ( { runs = \"step.tsv\"; of = "
               "\"y\"; value = 1.2; error = 0.02; } );\n");
    FAILS(1, "bent: the runs bend more than the polynomial can follow", "calibrate step.cfg");
    CU_ASSERT(!strstr(out, "fitted") && !strstr(out, "correlation") && isnan(found("a", "lower")));
    CHECK_PARTS(out, "# determined: unknown, because the runs bend too much\n", "; form p = ");
    /* of two names one that nothing asks, of a wide range */
    SHELL("awk 'NR == 1 { print \"a\\tb\\ty\" } NR > 1 { print $1 \"\\t\" 1000*((NR % 3) - 1) \"\\t\" $2 }' "
          "t.tsv >wide.tsv && sed 's/};/b = [-1000.0, 1000.0]; };/; s/t[.]tsv/wide.tsv/' fit.cfg >wide.cfg");
    FAILS(1, "determined is a", "calibrate wide.cfg");
    /* an angle beside the number is no setting; what takes two values at each point is */
    SHELL("awk -v OFS='\t' '{ print $0, NR == 1 ? \"z\" : $2 + 1, NR == 1 ? \"replica\" : NR % 2 }' t.tsv >u "
          "&& mv u t.tsv");
    GOOD("calibrate fit.cfg");
    SHELL("sed -i s/replica/gamma/ t.tsv");
    FAILS(65, "t.tsv: gamma is a setting: at every point it goes from 0 to 1", "calibrate fit.cfg");
}

/* A file in a folder of a name with a blank, which holds what is somebody's. */
static void test_folder(void)
{
    SHELL(": >out; : >err; mkdir -p 'a b' && echo mine >'a b/mine.txt'");
    write_text("a b/slide.cfg", "%s", slide);
    write_text("a b/fit.cfg", "fit = { mu = [0.05, 0.45]; };\nmeasured = ( { experiment = \"slide.cfg\"; of "
                              "= \"v\"; value = 12.05; error = 0.3; fixed = { T = 0.05; }; } );\n");
    FAILS(65, "a b/fit.cfg: not of a result", "calibrate 'a b/fit.cfg' -o 'a b' --quiet --force");
    GOOD("calibrate 'a b/fit.cfg' -o 'a b/c' --quiet");
    CHECK_NEAR(found("mu", "value"), 0.3, 0.01);
    CU_ASSERT(!strstr(out, " slow"));
    /* those of large mu end by a word, which is said */
    SHELL("sed 's/time = \"T\";/time = \"T\"; fail = { slow = \"t > 0.04 and vx < 7\"; };/' 'a b/slide.cfg' "
          ">slide.cfg && cp 'a b/fit.cfg' . && $REPOSE calibrate fit.cfg -o slow --quiet >out 2>err");
    CHECK_PARTS(out, "# failed: no_room 1, slow 4: the measures are from the other runs\n",
                "# runs: 48 at 24 points, 2 of them without",
                "# range: mu <= 0.35: only there do the runs have");
    CHECK_NEAR(found("mu", "value"), 0.3, 0.01);
    SHELL("test mine = \"$(cat 'a b/mine.txt')\"");
}

/* The stages' tables but for the seconds. */
static bool equal_runs(const char *name)
{
    scoped char *whole = strdup(check_text("whole/%s", name));
    scoped_table a = read_table(check_text("d/%s", name)), b = read_table(whole);
    bool equal = a.n_rows == b.n_rows && a.n_rows > 0;
    for (size_t i = 0; i < a.n_rows && equal; i++)
        equal = strcmp(word(&a, i, "mu"), word(&b, i, "mu")) == 0 &&
                strcmp(word(&a, i, "v"), word(&b, i, "v")) == 0;
    return equal;
}

/* Stopped or killed before ever later calls that change a file, in any of its processes. */
static void test_stopped(void)
{
    static const int signals[] = {SIGTERM, SIGKILL};
#define FOUND "calibrate fit.cfg -o d --quiet -j 1"
    write_text("slide.cfg", "%s", slide);
    write_fit("{ experiment = \"slide.cfg\"; of = \"v\"; value = 12.05; error = 0.3; }");
    GOOD(FOUND);
    SHELL("mv d whole");
    for (int s = 0; s < 2; s++) {
        int status = -1, stops = 0, stored = 0;
        SHELL("rm -rf d");
        for (long n = 1; status != 0 && n < 10000; n += 1 + n / 2) {
            status = run_by_minutes(signals[s], "", n, FOUND);
            if (status == 65 && shell("test -e d") == 0) status = 0; /* it was whole, and has its name */
            CHECK_OR_SAY(status == 0 || status == 75 || status == 128 + signals[s], "call %ld: status %d, %s",
                         n, status, err);
            stops += status != 0;
            stored += shell("test -s d.part/snapshot/1/store.sqlite") == 0;
            if (status != 0 && shell("test -e d") == 0) status = 0;
        }
        CHECK_OR_SAY(status == 0 && stops > 5 && stored > 3, "status %d, %d stops, %d stored", status, stops,
                     stored);
        SHELL("cmp d/answer.tsv whole/answer.tsv && cmp d/.repose whole/.repose && ! test -e d.part");
        CU_ASSERT(equal_runs("stage_1_1.tsv") && equal_runs("stage_2_1.tsv"));
    }
    /* another problem, or another command, in the folder of what was begun */
    SHELL("rm -rf d");
    CU_ASSERT(run_by_minutes(SIGKILL, "", 30, FOUND) == 128 + SIGKILL);
    FAILS(65, "d.part: holds fit.cfg, key ", "run slide.cfg -o d");
    write_fit("{ experiment = \"slide.cfg\"; of = \"v\"; value = 12.06; error = 0.3; }");
    FAILS(65, "d.part: holds fit.cfg, key ", FOUND);
    GOOD(FOUND " --force");
    SHELL("! test -e d.part");
}

static void test_refused(void)
{
#define MU "fit = { mu = [0.1, 0.8]; }; "
#define MEASURED(file, name, error)                                                                          \
    "measured = ( { experiment = \"" file "\"; of = \"" name "\"; value = 1.0; error = " error "; }"
    static const char *const cases[][2] = {
        {"measured = ( );", "fit: missing"},
        {MU, "measured: missing"},
        {"fit = { mu = [0.8, 0.1]; };", "fit.cfg:1: mu: [0.8, 0.1]: a range from a smaller"},
        {"fit = { };", "one to 3 names"},
        {MU "colour = 1;", "colour: unknown key"},
        {MU "value = 1;", "value: unknown key"},
        {MU "measured = ( { of = \"v\"; value = 1.0; error = 0.1; } );",
         "one of experiment, protocol and runs"},
        {MU MEASURED("slide.cfg", "v", "0.0") " );", "error = 0: out of range, allowed: (0, inf)"},
        {MU MEASURED("no.cfg", "v", "0.1") " );", "experiment = \"no.cfg\": no such file"},
        {MU MEASURED("slide.cfg", "vv", "0.1") " );",
         "of = \"vv\": the runs have no such column (did you mean \"v\"?)"},
        {"fit = { nu = [0.1, 0.8]; }; " MEASURED("slide.cfg", "v", "0.1") " );",
         "fit.nu: no experiment has this name"},
        {MU MEASURED("slide.cfg", "v", "0.1; fixed = { nu = 1.0; }") " );",
         "fixed.nu: unknown key (did you mean \"mu\"?)"},
        {MU "where = \"nu < 1\"; " MEASURED("slide.cfg", "v", "0.1") " );",
         "where nu < 1: character 1: unknown name nu (did you mean \"mu\"?)"},
        {MU "budget = 20; " MEASURED("slide.cfg", "v", "0.1") " );",
         "budget = 20: the first stage needs 24 runs"},
        {MU MEASURED("slide.cfg", "v",
                     "0.1") ", { runs = \"t.tsv\"; of = \"y\"; value = 1.0; error = 0.1; } );",
         "cannot be combined"}};
    write_text("slide.cfg", "%s", slide);
    CHECK_REFUSED(cases, "fit.cfg", "calibrate fit.cfg -o r --quiet");
    CHECK_REFUSED(cases, "fit.cfg", "calibrate fit.cfg --dry-run");
    SHELL("! test -e r && ! test -e r.part"); /* before any run */
    FAILS(64, "says what is measured", "calibrate fit.cfg --theta-r-deg 20 --error-deg 1");
}

CHECK_SUITE_WITHIN(calibrate_text, "calibrate by a text", enter, leave, test_runs, test_table, test_folder,
                   test_stopped, test_refused)
