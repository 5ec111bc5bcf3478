/* What people type who know another program, or another unit: each ends in one line that names what they did
 * and what to type instead. Hints that are in messages work when they are typed. */
#include <ctype.h>

#include "cli/cli.h"
#include "tests/program.h"

#define FLOOR "walls = ( { point = [0.0, 0.0]; direction = [0.0, 1.0]; } );\n"
#define SOME  "dt = 2e-5; steps = 3; fill = { N = 3; W = 4.0; H = 4.0; };\n"
#define SCENE FLOOR SOME
#define PHASES                                                                                               \
    "dt = 2e-5;" FLOOR "fill = { N = 3; W = 4.0; H = 4.0; }; phases = ( { name = `a`; steps = 3; } );\n"
#define TABLE FLOOR "dt = 2e-5; steps = 3; particles_file = `t.tsv`;\n"
#define PRESSED                                                                                              \
    "gravity = [0.0, 0.0]; dt = 2e-6; steps = 3; normal = { law = `linear`; k_n = 1e5; };\n"                 \
    "walls = ( { point = [-0.8, 0.0]; direction = [1.0, 0.0]; }, { point = [2.4, 0.0]; "                     \
    "direction = [-1.0, 0.0]; } );\n"                                                                        \
    "particles = ( { x = 0.0; y = 0.0; r = 1.0; },\n { x = 1.6; y = 0.0; r = 1.0; } );\n"

static void put(const char *name, const char *text)
{
    scoped char *made = strdup(text);
    for (char *c = made; *c; c++) *c = *c == '`' ? '"' : *c;
    write_text(name, "%s", made);
}

/* The scene is refused with this message; what it tells to type is the second scene, or the words of --set,
 * and runs. NULL: nothing is tried. */
typedef struct {
    const char *scene, *message, *cure;
} wrong_scene;

static void check_scenes(size_t n, const wrong_scene cases[])
{
    for (const wrong_scene *c = cases; c < cases + n; c++) {
        put("s.cfg", c->scene);
        const int status = run("run s.cfg");
        CHECK_OR_SAY(status == RP_BAD_INPUT && strstr(err, c->message) &&
                         strchr(err, '\n') == strrchr(err, '\n') && !*out,
                     "%s\nexit status %d, %s\nexpected: %s", c->scene, status, err, c->message);
        if (!c->cure) continue;
        put("s.cfg", c->cure);
        const int cured = run("run s.cfg");
        CHECK_OR_SAY(cured == RP_OK, "%s\nexit status %d, %s", c->cure, cured, err);
    }
}
#define CHECK_SCENES(cases) check_scenes(sizeof(cases) / sizeof *(cases), cases)

static void misplaced(void)
{
    static const wrong_scene cases[] = {
        {"N = 10; W = 4.0; H = 4.0;" FLOOR, "N: does not belong here, but in fill = { N = ...; }", NULL},
        {"radius_mean = 0.1;" SCENE,
         "radius_mean: does not belong here, but in fill = { radius_mean = ...; }", NULL},
        {"mu = 0.3;" SCENE, "mu: does not belong here, but in tangential = { mu = ...; }",
         "tangential = { law = `spring`; mu = 0.3; };" SCENE},
        {"normal = { mu = 0.3; };" SCENE, "normal.mu: does not belong here, but in tangential = { mu", NULL},
        {"k_n = 1e6;" SCENE, "k_n: does not belong here, but in normal = { k_n = ...; }",
         "normal = { k_n = 1e6; };" SCENE},
        {"restitution = 0.5;" SCENE,
         "restitution: does not belong here, but in normal = { restitution = ...; }",
         "normal = { law = `linear`; k_n = 1e5; restitution = 0.5; };" SCENE},
        {"gamma_s = 0.1;" SCENE, "in tangential = { gamma_s = ...; }", NULL},
        {"point = [0.0, 0.0];" SCENE, "point: does not belong here, but in walls = ( { point = ...; } )",
         NULL},
        {"until = `rest`;" PHASES, "until: does not belong here, but in phases = ( { until = ...; } )", NULL},
        {"fill = { N = 3; W = 4.0; H = 4.0; mu = 0.3; };" FLOOR "dt = 2e-5;",
         "fill.mu: does not belong here, but in", NULL},
        {"fill = { N = 3; W = 4.0; H = 4.0; dt = 2e-5; };" FLOOR,
         "fill.dt: does not belong here, but in the file itself, outside all groups", SCENE},
        {"tangential = { mu_roll = 0.1; };" SCENE,
         "tangential.mu_roll: does not belong here, but in rolling = { mu = ...; }", NULL},
        {FLOOR SOME "phases = ( { name = `a`; steps = 3; } );",
         "steps: an experiment ends with its last phase", PHASES},
        {"material = { E = 1e9; nu = 0.3; restitution = 0.5; mu = 0.3; }; tangential = { law = `spring`; "
         "};" SCENE,
         "tangential: law \"mindlin\" and k_s follow from material; keep one",
         "steps = 3; dt = 5e-7; fill = { N = 3; W = 4.0; H = 4.0; };" FLOOR
         "material = { E = 1e9; nu = 0.3; restitution = 0.5; mu = 0.3; };"},
        {"measure = ( { name = `n2`; of = `grains`; } );" SCENE, "measure: needs phases, as in phases = (",
         "measure = ( { name = `n2`; of = `grains`; } );" PHASES}};
    CHECK_SCENES(cases);
}

static void names(void)
{
    static const wrong_scene cases[] = {
        {"let = { r = 0.1; };" SCENE, "let r: r already stands for something in `add` of a phase (radius of",
         "let = { R = 0.1; };" SCENE},
        {"let = { touch = 0.1; };" SCENE, "`add` of a phase (height of first contact", NULL},
        {"let = { t = 0.1; };" SCENE, "in every expression (time since the phase began)", NULL},
        {"let = { d = 0.1; };" SCENE, "in every expression (the diameter of the mean grain)", NULL},
        {"let = { pi = 3.0; };" SCENE, "in every expression (the number pi)", NULL},
        {"let = { height = 3.0; };" SCENE, "in every expression (highest point", NULL},
        {"dt = 2e-5;" FLOOR
         "fill = { N = 3; W = 4.0; H = 4.0; }; phases = ( { name = `last`; steps = 3; } );",
         "`repose view --frame last` means other frames", NULL},
        {"let = { slope = 3.0; };" SCENE, "in `of` of a measure (a module)", NULL},
        {"let = { density = 3.0; };" SCENE,
         "density is a key of the scene too; give the let another name, or the key its value: density = "
         "\"density\"",
         "let = { density = 3.0; }; density = `density`;" SCENE},
        {"measure = ( { name = `grains`; of = `height`; } );" PHASES,
         "measure grains: grains already stands for",
         "measure = ( { name = `grains`; of = `grains`; } );" PHASES},
        {"measure = ( { name = `status`; of = `height`; } );" PHASES,
         "status is a column that every sweep has", NULL},
        {"let = { H = 2.0; }; measure = ( { name = `H`; of = `height`; } );" PHASES, "H names a let and",
         NULL},
        {"let = { a = `b + 1`; b = `a`; };" SCENE, "let.b: let.a: follows from itself",
         "let = { a = `b + 1`; b = 2; };" SCENE}};
    CHECK_SCENES(cases);
    /* in any order, and by their group */
    put("s.cfg", "let = { E = `2*D`; D = 1.0; }; dt = 2e-5;" FLOOR
                 "fill = { N = 3; W = `E`; H = 4.0; }; phases = ( { name = `a`; steps = 3; } );\n"
                 "measure = ( { name = `e`; of = `E`; } );\n");
    PRINTS("e\t2\t", "run s.cfg");
    PRINTS("e\t6\t", "run s.cfg --set D=3");
    PRINTS("e\t6\t", "run s.cfg --set let.D=3");
    FAILS(65, "--set let.DD=3: no such let (did you mean \"D\"?)", "run s.cfg --set let.DD=3");
    put("s.cfg", "let = { D = { value = 1.0; range = `[0, 2]`; }; };" SCENE);
    FAILS(65, "D = 3: out of range, allowed: [0, 2]", "run s.cfg --set let.D=3");
}

static void numbers(void)
{
    static const wrong_scene cases[] = {
        {"dt = 2,5e-5;" FLOOR, "decimal numbers with a point", NULL},
        {"steps = 2.5; dt = 2e-5;" FLOOR "fill = { N = 3; W = 4.0; H = 4.0; };",
         "steps = 2.5: a whole number expected",
         "steps = 3e0; dt = 2e-5;" FLOOR "fill = { N = 3.0; W = 4; H = 4; };"},
        {"steps = `2.5`; dt = 2e-5;" FLOOR "fill = { N = 3; W = 4.0; H = 4.0; };",
         "steps = 2.5: a whole number expected", NULL},
        {"dt = 2e-5; fill = { N = 3; W = 4.0; H = 4.0; }; phases = ( { name = `a`; steps = `2.5`; } );",
         "steps = 2.5: a whole number expected",
         "dt = 2e-5;" FLOOR
         "fill = { N = 3; W = 4.0; H = 4.0; }; phases = ( { name = `a`; steps = `6e-5/dt`; } );"},
        {"gravity = -981.0;" SCENE, "gravity: two numbers [a, b] expected", "gravity = [0.0, -981.0];" SCENE},
        {"gravity = [0, -981.0];" SCENE, "[ ] holds one type only; write 0.0 for 0, or use ( )",
         "gravity = (0, -981.0);" SCENE},
        {"gravity_turn_deg_per_step = 45;" SCENE, "out of range, allowed: [-10, 10] degree", NULL},
        {"normal = { restitution = 50; };" SCENE, "restitution = 50: out of range, allowed: ", NULL},
        {"normal = { law = hertz; };" SCENE, "words in quotes", "normal = { law = `hertz`; };" SCENE},
        {"normal = { law = `hertzian`; };" SCENE, "(did you mean \"hertz\"?)", NULL},
        {"rotation = yes;" SCENE, "syntax error", "rotation = true;" SCENE},
        {"rotation = `yes`;" SCENE, "rotation = \"yes\"", NULL},
        {"units = `mks`;" SCENE, "units = \"mks\": unknown word, allowed: cgs | si | sigma", NULL},
        {"let = { v = { value = 1.0; unit = `m/s`; }; };" SCENE, "unit = m/s: the file's units are cgs; cm/s",
         NULL},
        {"dt = 1;" FLOOR "fill = { N = 3; W = 4.0; H = 4.0; };", "dt = 1: too large for", NULL},
        {PRESSED, "compressed = true if this is meant", "compressed = true;" PRESSED},
        {"walls = { point = [0.0, 0.0]; direction = [0.0, 1.0]; };" SOME,
         "walls: a list ( { ... } ) expected", SCENE},
        {"let = { a = `2^70`; };" SCENE, "an exponent goes from -64 to 64", "let = { a = `2^0.2`; };" SCENE}};
    CHECK_SCENES(cases);
    /* one zero: the same bits, and the same key */
    char first[4096];
    put("s.cfg", "gravity = (0.0, -981.0);" PHASES);
    GOOD("run s.cfg");
    snprintf(first, sizeof first, "%s", strstr(out, "# digest"));
    put("s.cfg", "gravity = (-0.0, -981.0);" PHASES);
    GOOD("run s.cfg");
    CU_ASSERT_STRING_EQUAL(first, strstr(out, "# digest"));
    put("s.cfg", "let = { a = `32^0.2`; b = `2^2.5`; };" PHASES
                 "measure = ( { name = `A`; of = `a`; }, { name = `B`; of = `b`; } );");
    PRINTS("A\t2\t", "run s.cfg");
    PRINTS("B\t5.656854249492", "run s.cfg");
}

static void tables(void)
{
    static const char *const cases[][2] = {
        {"0 0.5 0.1\n1 0.5 0.1\n", "no names of columns above the first row \"0 0.5 0.1\"; what are they? "
                                   "Write a line as \"x y r\" above it"},
        {"1 0 0.5 0.1\n2 1 0.5 0.1\n",
         "Write a line as \"index x y r\" above it (the first column counts the rows)"},
        {"# vtk DataFile Version 3.0\n", "is a VTK file"},
        {"<?xml version=\"1.0\"?>\n", "is an XML file"},
        {"{\"x\": [1, 2]}\n", "is a JSON file"},
        {"2\nLattice=\"4 0 0\"\nC 0 0.5 0\nC 1 0.5 0\n", "t.tsv: is an XYZ file; a table expected"},
        {"2\r\n\r\n1\t0\t0.5\t0\r\n1\t1\t0.5\t0\r\n", "t.tsv: is an XYZ file"},
        {"\x89PNG\r\n", "t.tsv: is a picture; a table expected"},
        {"x\ty\tr\n0,0\t0,5\t0,1\n",
         "\"0,0\" is not a finite number; decimal commas? write points, as in 0.5"},
        {"x y r\n0,0 0,5 0,1\n", "decimal commas? write points"},
        {"x,y,r\n0,0,0,5,0,1\n", "6 cells where 3 are expected; decimal commas?"},
        {"x;y;r\n0.0;0.5;0.1\n", "cells are separated by ;, tabs or commas expected"},
        {"x;y;r\n0,0;0,5;0,1\n", "tr ';,' '\\t.' <FILE >TABLE writes them so"},
        {"X Y R\n0 0.5 0.1\n", "no column \"x\" (did you mean \"X\"?); expected header: x y r"},
        {"id type x y radius\n1 1 0 0.5 0.1\n", "no column \"r\"; expected header: x y r, and m vx vy angle "
                                                "omega fixed as needed; found: id type x y radius"},
        {"x y r\n0 0.5 -0.1\n", "t.tsv:2: r = -0.1: out of range, allowed: (0, inf) cm"},
        {"# units: m\tm\tm\nx\ty\tr\n0\t0.5\t0.1\n", "column 1: unit = m: the file's units are cgs; cm"},
        {"x y r\n", "t.tsv: no particles"}};
    put("s.cfg", TABLE);
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        write_text("t.tsv", "%s", cases[k][0]);
        FAILS(65, cases[k][1], "run s.cfg");
    }
    /* bytes that no text has, and wherever a table is read */
    SHELL("printf '\\377\\330\\377\\340\\0\\20JFIF' >t.tsv; printf 'PK\\3\\4\\0' >t.ods; printf '2\\n\\nC 0 "
          "0.5 0\\nC 1 "
          "0.5 0\\n' >t.xyz");
    FAILS(65, "t.tsv: is a picture; a table expected", "run s.cfg");
    FAILS(65, "t.ods: is an archive or spreadsheet", "stats select t.ods");
    FAILS(65, "t.xyz: is an XYZ file", "view t.xyz -o p.svg");
    FAILS(65, "t.xyz: is an XYZ file", "angle slope t.xyz");
    FAILS(65, "t.xyz: is an XYZ file", "export t.xyz --to lammps -o t.dump");
    write_text("t.txt", "5\n3\n4\n"); /* one column of numbers is a table */
    GOOD("stats select t.txt --columns 1");
    write_text("t.tsv", "ITEM: TIMESTEP\n0\n");
    FAILS(65, "t.tsv: is a dump of LAMMPS; a table expected: a line of names, as x y r", "angle slope t.tsv");
    /* a table where a scene is expected; numbers in a list are none */
    static const char *const given[] = {"0.1\t0.2\t0.3\n",
                                        "0.1 0.2 0.3\n",
                                        "# x y r\n\n-.1,0.2,0.3\n",
                                        "x,y,r\n1,2,3\n",
                                        "5\n6\n",
                                        "\"a\",\"b\"\n\"1\",\"2\"\n",
                                        "\xef\xbb\xbfx;y\n1,0;2,0\n",
                                        "7 ok\n",
                                        "# 3\n30000000000 1 2\n"};
    for (size_t k = 0; k < sizeof given / sizeof *given; k++) {
        write_text("given.tsv", "%s", given[k]);
        FAILS(65,
              "given.tsv: is a table of numbers; a scene, experiment or sweep is a text of parameters, key =",
              "run given.tsv");
    }
    FAILS(65, "particles_file = \"given.tsv\";", "sweep plan given.tsv -o planned");
    write_text("s.cfg", "walls = ( { point = [\n0.0,\n0.0\n]; direction = [0.0, 1.0]; } );\n/*\n5\n*/" SOME);
    GOOD("run s.cfg");
    write_text("s.cfg", "/*\n5\n*/ %s", SCENE);
    GOOD("run s.cfg");
    write_text("s.cfg", "steps\n= 3; 5\n");
    FAILS(65, "s.cfg:2: syntax error in", "run s.cfg");
    put("s.cfg", TABLE);
    /* what the messages tell to do */
    write_text("t.csv", "x;y;r\n0,0;0,5;0,1\n");
    SHELL("tr ';,' '\\t.' <t.csv >t.tsv");
    GOOD("run s.cfg");
    write_text("t.tsv", "index x y r\n1 0 0.5 0.1\n2 1 0.5 0.1\n");
    CU_ASSERT(run("run s.cfg") == RP_OK);
    write_text("t.tsv", ",x,y,r\n0,0,0.5,0.1\n1,1,0.5,0.1\n"); /* of pandas */
    CU_ASSERT(run("run s.cfg") == RP_OK);
}

/* Told before the run, with the first grain. */
static void falls(void)
{
    static const char *const cases[][2] = {
        {"dt = 2e-5; steps = 20000; fill = { N = 3; W = 1.0; H = 1.0; };", "grain 1 at x = "},
        {"dt = 2e-5; steps = 20000; particles = ( { x = 0.5; y = 0.2; r = 0.1; }, { x = 3.0; y = 0.2; r = "
         "0.1; } );\n"
         "walls = ( { polygon = ( [0.0, 5.0], [0.0, 0.0], [2.0, 0.0], [2.0, 5.0] ); closed = false; } );",
         "grain 2 at x = 3, y = 0.2 falls for ever: no wall or fixed grain is below it"},
        {"y_min = -1.0; dt = 2e-5; steps = 20000; particles = ( { x = 0.5; y = 0.2; r = 0.1; } );", NULL},
        {"gravity = [0.0, 0.0]; dt = 2e-5; steps = 20000; particles = ( { x = 0.5; y = 0.2; r = 0.1; } );",
         NULL},
        {"dt = 2e-5; steps = 20000; particles = ( { x = 0.5; y = 2.0; r = 0.1; }, { x = 0.6; y = 0.2; r = "
         "0.1; fixed = true; } );",
         NULL},
        {FLOOR "dt = 2e-5; steps = 20000; fill = { N = 3; W = 1.0; H = 1.0; };", NULL}};
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        put("s.cfg", cases[k][0]);
        CU_ASSERT(run("run s.cfg") == RP_OK);
        CHECK_OR_SAY(cases[k][1] ? strstr(err, cases[k][1]) != NULL : !strstr(err, "for ever"), "%s: %s",
                     cases[k][0], err);
    }
}

static void pictures(void)
{
    FILE *f = file_of("p.tsv");
    fputs("x y\n", f);
    for (int i = 0; i <= 100; i++) fprintf(f, "%d %g\n", i, 0.5 * (i < 50 ? i : 100 - i));
    fputs("150 40\n", f); /* a stray pixel */
    fclose(f);
    CU_ASSERT(run("angle slope p.tsv") == RP_OK &&
              strstr(err, "1 stray points beside the pile are left out"));
    CU_ASSERT(strstr(out, "ok_mean") != NULL);
    f = file_of("p.tsv");
    fputs("x y\n", f);
    for (int i = 0; i <= 100; i++) fprintf(f, "%d %g\n", i, 100.0 - 0.5 * (i < 50 ? i : 100 - i));
    fclose(f);
    CU_ASSERT(run("angle slope p.tsv") == RP_NO_RESULT && strstr(err, "--y-axis down"));
    CU_ASSERT(run("angle slope p.tsv --y-axis down") == RP_OK && strstr(out, "ok_mean"));
    write_text("p.tsv", "1 0 0.5 0.1\n2 1 0.5 0.1\n");
    FAILS(65, "no names of columns above the first row \"1 0 0.5 0.1\"; what are they?", "angle slope p.tsv");
}

/* A series that is too short for its error says how long it must be. */
static void errors(void)
{
    put("s.cfg", "dt = 2e-5;" FLOOR "fill = { N = 3; W = 4.0; H = 4.0; };\n"
                 "phases = ( { name = `a`; steps = 100; every = 10; } );\n"
                 "measure = ( { name = `e`; of = `kinetic`; during = `a`; }, { name = `v`; of = `y`; during "
                 "= `a`; take = `rate`; } );\n");
    PRINTS("10 values: at least 16 needed", "run s.cfg");
    PRINTS("10 samples: more than 20 needed, or 10 passes", "run s.cfg");
    put("s.cfg",
        "let = { v = 1.0; }; dt = 1e-4; gravity = [0.0, 0.0]; particles = ( { x = 1.0; y = 1.0; r = "
        "0.1; } );\n"
        "phases = ( { name = `b`; repeat = 2; phases = ( { name = `a`; steps = 100; every = 10; } ); } "
        ");\n"
        "measure = ( { name = `rise`; of = `v*time`; during = `a`; take = `rate`; },\n"
        "  { name = `fall`; of = `-floor(time/0.015)`; during = `a`; take = `avalanches`; drop = 0.5; "
        "},\n"
        "  { name = `line`; of = `v*time`; at = `a`; take = `line`; against = `time`; } );\n");
    PRINTS("\nrise_se\tnan\t-\tstandard error of the rate, from ten blocks of v*time, during a; 2 passes: at "
           "least 10 needed\n",
           "run s.cfg");
    PRINTS("; one avalanche: at least 2 needed for an error\n", "run s.cfg");
    PRINTS("; 2 samples: at least 3 needed for an error\n", "run s.cfg");
    const char *const note = "# errors: nan where a mean is of one result; at least 2 needed\n";
    put("w.cfg", "experiment = `s.cfg`; replicas = 1; seed = 1; grid = { v = [1.6, 2.0]; };\n");
    GOOD("sweep make w.cfg -o w --quiet");
    PRINTS(note, "sweep export w --reduce");
    PRINTS("# short series: 2 runs have nan as an _se; after repose run FILE --row N -o DIR, repose run "
           "DIR/scene.cfg says why\n",
           "sweep export w");
    GOOD("run w.cfg --row 1 -o wr"); /* as the line says */
    PRINTS("; 2 passes: at least 10 needed\n", "run wr/scene.cfg");
    GOOD("sweep export w");
    CU_ASSERT(!strstr(out, "# errors"));
    GOOD("sweep make w.cfg -o w --quiet --replicas 2");
    GOOD("sweep export w --reduce");
    CU_ASSERT(!strstr(out, "# errors"));
    write_text("two.tsv", "# x\ty\ts\n1\t2\t1\n2\t3\t1\n");
    PRINTS("# errors: nan; at least 3 rows needed\n", "stats fit two.tsv -x x -y y");
    PRINTS("# errors: p_value is nan; at least 3 rows needed\n", "stats fit two.tsv -x x -y y --se s");
    write_text("g.tsv",
               "# x\ty\tg\tstatus\n1\t2\ta\tok\n2\t3\ta\tok\n3\t3.5\ta\tok\n1\t2\tb\tok\n2\t3\tb\tok\n");
    const char *const group =
        "# no_result: b: no trend: 2 values at 2 different x; at least 3 values at 2 x needed\n";
    PRINTS(group, "stats trend g.tsv -x x -y y --by g");
    PRINTS(group, "stats size g.tsv -x x -y y --by g");
    write_text("one.tsv", "# mu\ttheta_r3_deg\ttheta_t_displacement_deg\tstatus\n0.2\t18\t5\tok\n");
    PRINTS("# errors: mu = 0.2 has one pile; at least 2 needed\n", "angle compare one.tsv");
}

static void sweeps(void)
{
    SHELL("mkdir -p sub examples");
    put("examples/h.cfg", "let = { v = 1.0; };" PHASES "measure = ( { name = `w`; of = `v`; } );\n");
    put("sub/s.cfg", "experiment = `examples/h.cfg`; replicas = 2; seed = 1; grid = { v = [1.6]; };\n");
    GOOD("sweep plan sub/s.cfg -o d"); /* as `run` finds it */
    write_text("points.tsv", "mu\tC_mean\tC_se\tn\n0.1\t2\t0.5\t3\n0.2\t4\t0.25\t3\n");
    SHELL("mkdir -p e/tables && cp points.tsv e/tables/");
    GOOD("view e -x mu -y C_mean -o p.svg");
    SHELL("grep -q '>C_mean<' p.svg && grep -q '>mu<' p.svg");
    FAILS(64, "-x and -y go together", "view e -x mu -o p.svg --force");
    FAILS(65, "no column \"C_men\" (did you mean \"C_mean\"?)", "view e -x mu -y C_men -o p.svg --force");
    FAILS(65, "no points.tsv; repose sweep export d --reduce -o d/points.tsv writes it",
          "view d -x v -y w_mean -o q.svg");
}

/* ---- hints ---- */

static bool is_option(const rp_param *options, const char *name, size_t n)
{
    bool is = false;
    for (const rp_param *p = options; p && p->name && !is; p++) {
        is = strlen(p->name) == n;
        for (size_t k = 0; k < n && is; k++) is = p->name[k] == (name[k] == '-' ? '_' : name[k]);
    }
    return is;
}

static bool has_option(const cli_command *const *c, const char *name, size_t n)
{
    bool has = false;
    for (; *c && !has; c++)
        has = is_option((*c)->options ? (*c)->options() : NULL, name, n) ||
              is_option((*c)->protocol, name, n) || ((*c)->group && has_option((*c)->group, name, n));
    return has;
}

static size_t n_hints;

/* In the literals of a line: `repose COMMAND` is one, and each --option is an option of some command. */
static void check_hints(const char *path, int number, char *line)
{
    static const char *const others[] = {"help", "version", "leak-check", "no", "unshare"};
    if (!strchr(line, '"') || strstr(line, "include")) return;
    for (char *c = strchr(line, '"'); (c = strstr(c, "--")); c += 2) {
        const size_t n = strspn(c + 2, "abcdefghijklmnopqrstuvwxyz0123456789-_");
        bool known = n < 2 || c[2] == '-' || c[-1] == '-' || (c > line && isalnum((unsigned char)c[-1]));
        for (size_t k = 0; k < sizeof others / sizeof *others; k++)
            known |= strlen(others[k]) == n && strncmp(c + 2, others[k], n) == 0;
        CHECK_OR_SAY(known || has_option(cli_repose.commands, c + 2, n), "%s:%d: no option %.*s", path,
                     number, (int)n + 2, c);
        n_hints++;
    }
    for (char *c = strchr(line, '"'); (c = strstr(c, "repose ")); c += 7) {
        char word[2][32] = {"", ""};
        if (c > line && (isalnum((unsigned char)c[-1]) || strchr("#*/_", c[-1]))) continue;
        sscanf(c + 7, "%31[a-z] %31[a-z]", word[0], word[1]);
        const cli_command *found = *word[0] ? cli_find(cli_repose.commands, word[0]) : NULL;
        if (!found || c[7 + strlen(word[0])] == ':') continue; /* of a sentence, or before a message */
        if (found->group && *word[1]) found = cli_find(found->group, word[1]);
        CHECK_OR_SAY(found, "%s:%d: no command repose %s %s", path, number, word[0], word[1]);
        n_hints++;
    }
}

static void hints(void)
{
    static const char *const sources[] = {"src/*/*.c", "src/*/*/*.c", "sweeps/engine/*.c"};
    for (size_t k = 0; k < sizeof sources / sizeof *sources; k++) file_lines(sources[k], check_hints);
    CU_ASSERT(n_hints > 150);
    PRINTS("% REPOSE(1)", "help manual");
    PRINTS("complete -o", "help completion");
    for (const cli_command *const *c = cli_repose.commands; *c; c++) GOOD("help %s", (*c)->name);
}

/* Kinds whose contacts nobody has given, by whatever way their grains come; walls without a name are in no
 * pair. */
static void kinds(void)
{
#define STEEL "dt = 2e-5; gravity = [0.0, 0.0]; tangential = { law = `spring`; mu = 0.3; };\n"
    put("s.cfg", STEEL
        "steps = 3; kinds = { steel = { mu = 0.1; }; sand = { mu = 0.6; }; }; particles_file = `t.tsv`;\n");
    static const char *const given[] = {"1\n1\t0\t0.1\t2", "steel\n1\t0\t0.1\tsand", "0\n1\t0\t0.1\t1"};
    for (size_t k = 0; k < 3; k++) {
        write_text("t.tsv", "x\ty\tr\tkind\n0\t0\t0.1\t%s\n", given[k]);
        FAILS(65, ": say what their contacts have, pairs = ", "run s.cfg");
    }
    write_text("t.tsv", "x\ty\tr\n0\t0\t0.1\n");
    put("s.cfg", STEEL
        "kinds = { steel = { mu = 0.1; }; }; particles_file = `t.tsv`;\n"
        "phases = ( { name = `a`; steps = 3; add = { kind = `steel`; r = 0.1; x = 1.0; y = 1.0; }; } );\n");
    FAILS(65, ": say what their contacts have, pairs = ", "run s.cfg");
    put("s.cfg",
        "dt = 2e-5; normal = { law = `linear`; restitution = 0.6; }; kinds = { steel = { }; gold = { density "
        "= 19.0; }; };\n"
        "particles = ( { kind = `steel`; x = 0.5; y = 1.0; r = 0.1; } );" FLOOR
        "phases = ( { name = `a`; steps = 3; add = { kind = `gold`; r = 0.3; x = 1.5; y = 0.5; }; } );\n");
    FAILS(65, "no grain of kind \"gold\" is there at the start, so that its restitution has no mean mass",
          "run s.cfg");
    GOOD("run s.cfg --set normal.law=tsuji -o tsuji");
    put("s.cfg",
        STEEL "steps = 3; kinds = { steel = { }; }; pairs = ( { of = (`steel`, ``); mu = 0.9; } );\n" FLOOR
              "particles = ( { kind = `steel`; x = 0.5; y = 1.0; r = 0.1; } );\n");
    SHELL("\"$REPOSE\" run s.cfg | grep 'kind \"steel\" at wall 1' | grep -q 'mu = 0.3,'");
}

CHECK_SUITE_WITHIN(wrong, "wrong input of people", enter, leave, misplaced, names, numbers, tables, falls,
                   kinds, pictures, errors, sweeps, hints)
