/* `repose export`: what it writes, read back. The comparisons are in tests/readers.py: in every check by the
 * standard library of Debian's Python; by LAMMPS, VTK and pandas where these are installed (`make
 * setup-peers` installs them). */
#include <limits.h>

#include "dem/law/laws.h"
#include "tests/numbers.h"
#include "tests/program.h"

/* Debian's Python before any other on the PATH. */
#define PYTHON "PATH=/usr/bin:/bin:$PATH python3 "

/* Run a case of readers.py in the folder. */
static bool readers(const char *words)
{
    static char script[PATH_MAX];
    if (!*script) CU_ASSERT_PTR_NOT_NULL_FATAL(realpath("tests/readers.py", script));
    const bool right = shell_line("export REPOSE; " PYTHON "%s %s >out 2>err", script, words) == 0;
    if (!right) fprintf(stderr, "readers.py %s: %s%s\n", words, out, err);
    return right;
}

/* Is the program, or the module of Python, installed? Without it a test, or a part of one, is skipped. */
static bool has(const char *command, const char *what, void skip(const char *reason))
{
    const bool there = shell_line("{ %s; } >out 2>err", command) == 0;
    if (!there) skip(check_text("needs %s, which `make setup-peers` installs", what));
    return there;
}

static bool has_lammps(void)
{
    return has("command -v lmp", "LAMMPS", check_skip_test);
}

/* Grains that fall into a corner with a wall that opens; one leaves. */
static void write_scene(void)
{
    write_text("scene.cfg",
               "dt = 2.0e-5; steps = 1000; x_max = 1.2; rotation = true;\n"
               "normal = { k_n = 1.0e5; gamma_n = 300.0; };\ntangential = { law = \"spring\"; mu = 0.3; };\n"
               "walls = ( { point = [0.0, 0.0]; direction = [0.0, 1.0]; },\n"
               "  { point = [0.1, 0.0]; direction = [0.8, 0.6]; extent = [-2.0, 0.0]; },\n"
               "  { point = [1.0, 0.0]; direction = [-1.0, 0.0]; extent = [0.05, 9.0]; open_at_step = 375; "
               "open_speed = 10.0; } );\n"
               "particles = ( { x = 1.17; y = 0.6; r = 0.03; vx = 6.0; }, { x = 0.4; y = 0.09; r = 0.1; "
               "omega = 3.0; },\n"
               "  { x = 0.58; y = 0.12; r = 0.09; vx = 20.0; },\n"
               "  { x = 0.2; y = 0.17; r = 0.1; vy = 10.0; } );\n");
}

static void write_run(void)
{
    write_scene();
    GOOD("run scene.cfg --every 250 -o pile");
}

static void export_formats(void)
{
    write_run();
    GOOD("export pile --to lammps -o pile.lammpstrj");
    GOOD("export pile --to lammps --columns contacts --where 'step>=500' -o few.lammpstrj");
    GOOD("export pile --to vtk -o pile.pvd");
    GOOD("export pile --to csv -o pile.csv");
    GOOD("export pile --to json -o pile.json");
    write_text("words.tsv", "# a: note\na\tb\tc\n1.5\tnan\tinfinite\n-2e-300\t.5\tx\"y,z\n");
    GOOD("export words.tsv --to csv -o words.csv");
    GOOD("export words.tsv --to json -o words.json");
}

static void test_formats(void)
{
    export_formats();
    CU_ASSERT(readers("light"));
}

/* A row of a sweep, a table of grains alone, and standard output. */
static void test_sources(void)
{
    write_run();
    GOOD("export pile --to csv --columns y,id --where step=1000");
    CU_ASSERT(strncmp(out, "y,id\n0.", 7) == 0 && strstr(out, ",4\n") && !strstr(out, ",1\n"));
    SHELL("cp pile/states.tsv one_grains.tsv; cp pile/contacts.tsv one_contacts.tsv");
    GOOD("export pile --to lammps -o a.lammpstrj");
    GOOD("export one_grains.tsv --to lammps -o b.lammpstrj");
    SHELL("cmp a.lammpstrj b.lammpstrj >out && cmp a.contacts.lammpstrj b.contacts.lammpstrj");
    GOOD("export pile --to lammps");
    SHELL("cp out said; cmp said a.lammpstrj >out");
    write_text("xyr.tsv", "x y r\n0.25 0.5 0.125\n1 2 0.5\n");
    GOOD("export xyr.tsv --to lammps");
    CU_ASSERT(strncmp(out, "ITEM: TIME\n0\nITEM: TIMESTEP\n0\n", 30) == 0);
    CU_ASSERT_PTR_NOT_NULL(
        strstr(out, "\nITEM: ATOMS id type x y z radius\n1 1 0.25 0.5 0 0.125\n2 1 1 2 0 0.5\n"));
}

#define SWEEP                                                                                                \
    "protocol = \"repose\"; replicas = 2; seed = 3;\nfixed = { W = 1.0; H = 1.25; };\n"                      \
    "grid = { mu = [0.1, 0.3]; };\n"

static void test_sweep(void)
{
    write_text("sweep.cfg", SWEEP);
    GOOD("sweep plan sweep.cfg -o s");
    CU_ASSERT(run("sweep run s -j 1") == 0);
    GOOD("sweep export s -o runs.tsv");
    GOOD("export s --to csv -o runs.csv");
    GOOD("export s --to json --reduce -o points.json");
    CU_ASSERT(readers("sweep"));
    GOOD("stats select runs.csv --columns W,mu --bare"); /* read again, by the name of a fixed parameter */
    CU_ASSERT_STRING_EQUAL(out, "1\t0.1\n1\t0.1\n1\t0.3\n1\t0.3\n");
    FAILS(65, "s/store.sqlite: is there; give another name", "export s --to csv -o s/store.sqlite");
    FAILS(64, "has no grains", "export s --to vtk -o s.pvd");
}

/* An experiment that goes back: steps rise, of its tables as of its phases. */
static void test_back(void)
{
    write_text("back.cfg",
               "y_min = -9.0; dt = 2e-5; particles = ( { x = 0.0; y = 9.0; r = 0.1; }, { x = 1.0; y = 9.0; r "
               "= 0.1; } );\n"
               "output = { states = 20; energy = 20; };\n"
               "phases = ( { name = \"a\"; steps = 40; }, { name = \"b\"; steps = 45; },\n"
               "  { name = \"c\"; from = \"a\"; steps = 30; }, { name = \"d\"; steps = 0; } );\nmeasure = ( "
               "{ name = \"at\"; of = \"step\"; } );\n");
    GOOD("run back.cfg -o back");
    SHELL("ln -s back back.2.cfg"); /* a folder, no scene */
    GOOD("export back.2.cfg --to lammps");
    SHELL("grep -A1 'ITEM: TIMESTEP' out | grep '^[0-9]' | tr '\\n' ' ' >steps; cat steps >out");
    CU_ASSERT_STRING_EQUAL(out, "0 20 40 60 80 85 100 115 ");
    SHELL("grep -c '^115' back/states.tsv >out"); /* one frame, though a phase without steps follows */
    CU_ASSERT_STRING_EQUAL(out, "2\n");
    GOOD("view back --frame b -o a.svg --force");
    SHELL("grep -q 'step 85, t = 0.0017 s' a.svg");
    GOOD("view back --frame c -o a.svg --force");
    SHELL("grep -q 'step 115, t = 0.0014 s' a.svg");
    write_text("back_sweep.cfg", "experiment = \"back.cfg\"; replicas = 1;\n");
    GOOD("run back_sweep.cfg --row 0 -o row");
    GOOD("view row --frame c -o a.svg --force");
    SHELL("grep -q 'step 115, t = 0.0014 s' a.svg");
}

/* A name of 4000 characters is the longest from which those of other files are made: here ./././... */
static void test_long_names(void)
{
    static const char *const cases[][2] = {{"export g.tsv --to vtk", ".pvd"},
                                           {"export g.cfg --to lammps-input", ".in"}};
    write_text("g.tsv", "x\ty\tr\n0.25\t0.5\t0.125\n");
    write_text("g.cfg", "particles_file = \"g.tsv\"; dt = 1e-5; steps = 10;\n"
                        "normal = { law = \"linear\"; tension = false; };\n");
    for (int k = 0; k < 2; k++)
        for (size_t n = 4000; n < 4300; n += 200) { /* of the system's 4096 */
            char name[4300];
            const size_t stem = n - strlen(cases[k][1]);
            size_t i = 0;
            for (; i + 3 < stem; i += 2) memcpy(name + i, "./", 2);
            memset(name + i, 'a', stem - i);
            strcpy(name + stem, cases[k][1]);
            const int status = shell_line("\"$REPOSE\" %s -o %s >out 2>err", cases[k][0], name);
            CU_ASSERT(n > 4096 ? (status == RP_BAD_INPUT || status == RP_IO) && *err : status == 0);
        }
}

static void test_errors(void)
{
    write_run();
    write_text("backwards.tsv", "step\tx\ty\tr\n2\t0\t0\t1\n1\t0\t0\t1\n");
    write_text("word.tsv", "x\ty\tr\tstatus\n0\t0\t1\tok\n");
    write_text("old.tsv", "id_a\tid_b\n1\t2\n");
    FAILS(65, "backwards.tsv:3: step 1 after step 2", "export backwards.tsv --to lammps");
    FAILS(65, "word.tsv:2: column 4 status: \"ok\" is not a finite number",
          "export word.tsv --to vtk -o a.pvd");
    write_text("word.tsv", "status\tx\ty\tr\nok\t0\t0\t1\n1\t3\t0\t1\n");
    FAILS(65, "word.tsv:2: column 1 status: \"ok\"", "export word.tsv --to lammps");
    FAILS(65, "old.tsv: no column \"x\"", "export old.tsv --to lammps");
    FAILS(65, "no column \"no\"", "export pile --to csv --columns x,no");
    FAILS(65, "no grains", "export pile --to lammps --where 'step>9999'");
    FAILS(65, "neither a run (states.tsv) nor a sweep (sweep.cfg)", "export . --to csv");
    FAILS(65, "nowhere: cannot read", "export nowhere --to csv");
    FAILS(64, "scene.cfg: a scene is exported with --to lammps-input", "export scene.cfg --to vtk");
    FAILS(64, "--reduce needs a sweep", "export pile --to csv --reduce");
    FAILS(64, "--set needs --to lammps-input", "export pile --to csv --set mu=1");
    FAILS(64, "vtk needs a name that ends in .pvd", "export pile --to vtk -o a.vtk");
    FAILS(64, "lammps-input needs a name that ends in .in", "export scene.cfg --to lammps-input");
    static const char *const untaken[] = {"--columns x", "--where x=1", "--reduce"};
    for (size_t k = 0; k < 3; k++)
        FAILS(64, "takes no --columns, --where or --reduce", "export scene.cfg --to lammps-input %s -o a.in",
              untaken[k]);
    FAILS(74, "/dev/full: cannot write", "export pile --to json -o /dev/full");
    SHELL("cp old.tsv pile/contacts.tsv");
    FAILS(65, "pile/contacts.tsv: no column \"step\"", "export pile --to lammps");
}

/* ---- whole files, by hand ---- */

/* Two frames, of which the second has lost a grain; contacts in the second alone, and walls that lean, with
 * and without ends, and in the second two that are gone. All numbers are exact in binary. */
static void write_small(void)
{
    SHELL("mkdir d >out 2>err");
    write_text("d/states.tsv",
               "step\tt\tid\tx\ty\tr\tm\tvx\tvy\tfx\tfy\tomega\tcontacts\n"
               "0\t0\t7\t0.5\t1\t0.5\t2\t1\t-1\t3\t-4\t0.25\t1\n0\t0\t3\t2\t1.5\t0.25\t4\t5\t6\t7\t8\t-9\t2\n"
               "10\t0.25\t3\t2.5\t0.5\t0.25\t4\t-5\t-6\t-7\t-8\t9\t0\n");
    write_text("d/contacts.tsv", "step\tt\tid_a\tid_b\tx\ty\tx_b\ty_b\tnormal_force\tlimit\n"
                                 "10\t0.25\t3\t7\t2.5\t0.5\t1.5\t0.75\t12\tinfinite\n"
                                 "10\t0.25\t3\t0\t2.5\t0.5\t2.25\t-0.5\t11\t4\n");
    write_text("d/walls.tsv", "step\tt\twall\tx\ty\tdirection_x\tdirection_y\tfrom\tto\n"
                              "0\t0\t1\t1\t2\t0.5\t1\t-inf\tinf\n0\t0\t2\t1\t2\t-0.5\t1\t-inf\tinf\n"
                              "10\t0.25\t1\t1\t2\t0.5\t1\t-0.5\t2\n10\t0.25\t2\t1\t2\t-0.5\t1\t-inf\t0\n"
                              "10\t0.25\t3\t1\t2\t0\t1\tinf\tinf\n10\t0.25\t4\t1\t2\t0\t1\t3\t3\n");
}

static void file_is(const char *name, const char *expected)
{
    static char text[1 << 14];
    slurp(name, text, sizeof text);
    CHECK_OR_SAY(strcmp(text, expected) == 0, "%s is:\n%sexpected:\n%s", name, text, expected);
}

/* x from 0.5 - 0.5 to 2.5 + 0.25, y from 0.5 - 0.25 to 1.5 + 0.25. */
#define DUMP(time, step, of, n)                                                                              \
    "ITEM: TIME\n" time "\nITEM: TIMESTEP\n" step "\nITEM: NUMBER OF " of "\n" n                             \
    "\nITEM: BOX BOUNDS ff ff pp\n0 2.75\n0.25 1.75\n-0.5 0.5\nITEM: " of " "

static void test_dump_files(void)
{
    write_small();
    GOOD("export d --to lammps -o a.dump");
    file_is("a.dump",
            DUMP("0", "0", "ATOMS",
                 "2") "id type x y z radius mass vx vy vz fx fy fz omegaz contacts\n"
                      "7 1 0.5 1 0 0.5 2 1 -1 0 3 -4 0 0.25 1\n3 1 2 1.5 0 0.25 4 5 6 0 7 8 0 -9 2\n" DUMP(
                          "0.25", "10", "ATOMS",
                          "1") "id type x y z radius mass vx vy vz fx fy fz omegaz contacts\n"
                               "3 1 2.5 0.5 0 0.25 4 -5 -6 0 -7 -8 0 9 0\n");
    file_is("a.contacts.dump",
            DUMP("0", "0", "ENTRIES", "0") "id_a id_b x y x_b y_b normal_force limit\n" DUMP(
                "0.25", "10", "ENTRIES", "2") "id_a id_b x y x_b y_b normal_force limit\n3 7 2.5 0.5 1.5 "
                                              "0.75 12 inf\n3 0 2.5 0.5 2.25 -0.5 11 4\n");
    /* contacts go to a file beside a file alone */
    GOOD("export d --to lammps");
    CU_ASSERT(shell("ls | grep contacts >out") == 0 && strcmp(out, "a.contacts.dump\n") == 0);
    GOOD("export d/states.tsv --to lammps -o b.dump");
    SHELL("cmp a.dump b.dump >out && ! test -e b.contacts.dump");
    /* the radius first, a vector once and whole, and no place or number twice */
    static const char *const chosen[][3] = {
        {"omega,vy,vx,r,m", "radius omegaz vx vy vz mass", "0.5 0.25 1 -1 0 2\n"},
        {"vx", "radius vx vy vz", "0.5 1 -1 0\n"},
        {"fy", "radius fx fy fz", "0.5 3 -4 0\n"},
        {"contacts,fy,m,fx", "radius contacts fx fy fz mass", "0.5 1 3 -4 0 2\n"},
        {"x,id,step,y,t", "radius", "0.5\n"}};
    for (size_t k = 0; k < sizeof chosen / sizeof *chosen; k++) {
        const char *expected =
            check_text("ITEM: ATOMS id type x y z %s\n7 1 0.5 1 0 %s", chosen[k][1], chosen[k][2]);
        GOOD("export d --to lammps --columns %s --where id=7", chosen[k][0]);
        CHECK_OR_SAY(strstr(out, expected) && strstr(out, "NUMBER OF ATOMS\n1\n"), "%s:\n%s", expected, out);
    }
    /* a box on either side of the origin */
    write_text("right.tsv", "x\ty\tr\n3\t4\t1\n");
    write_text("left.tsv", "x\ty\tr\n-3\t-4\t1\n");
    PRINTS("\nITEM: BOX BOUNDS ff ff pp\n2 4\n3 5\n-1 1\nITEM: ATOMS ", "export right.tsv --to lammps");
    PRINTS("\nITEM: BOX BOUNDS ff ff pp\n-4 -2\n-5 -3\n-1 1\nITEM: ATOMS ", "export left.tsv --to lammps");
    /* lone components are columns; without numbers grains count in each frame, the time is the step */
    write_text("half.tsv", "step\tx\ty\tr\tvx\tfy\n3\t0\t0\t1\t2\t4\n3\t2\t0\t1\t5\t6\n4\t0\t0\t1\t7\t8\n");
    GOOD("export half.tsv --to lammps");
#define HALF(step, n)                                                                                        \
    "ITEM: TIME\n" step "\nITEM: TIMESTEP\n" step "\nITEM: NUMBER OF ATOMS\n" n                              \
    "\nITEM: BOX BOUNDS ff ff pp\n-1 3\n-1 1\n-1 1\nITEM: ATOMS id type x y z radius vx fy\n"
    file_is("out", HALF("3", "2") "1 1 0 0 0 1 2 4\n2 1 2 0 0 1 5 6\n" HALF("4", "1") "1 1 0 0 0 1 7 8\n");
}

#define VTP(points, verts, lines, at)                                                                        \
    "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\">\n"     \
    "<PolyData>\n<Piece NumberOfPoints=\"" points "\" NumberOfVerts=\"" verts "\" NumberOfLines=\"" lines    \
    "\" NumberOfStrips=\"0\" NumberOfPolys=\"0\">\n<Points>\n" ARRAY("Points", "3", at) "</Points>\n"
#define ARRAY(name, width, values)                                                                           \
    "<DataArray type=\"Float64\" Name=\"" name "\" NumberOfComponents=\"" width                              \
    "\" format=\"ascii\">\n" values "</DataArray>\n"
#define CELLS(kind, ids, ends)                                                                               \
    "<" kind ">\n<DataArray type=\"Int64\" Name=\"connectivity\" format=\"ascii\">\n" ids                    \
    "</DataArray>\n<DataArray type=\"Int64\" Name=\"offsets\" format=\"ascii\">\n" ends                      \
    "</DataArray>\n</" kind ">\n"
#define LAST "</Piece>\n</PolyData>\n</VTKFile>\n"
#define PART(time, part, name, file)                                                                         \
    "<DataSet timestep=\"" time "\" part=\"" part "\" name=\"" name "\" file=\"a_frames/" file ".vtp\"/>\n"

/* The corners of the grains' box, from (1, 2) along (1, -1/2) and (1, 1/2): -7/8 to 21/8, -15/8 to 13/8. */
static void test_vtk_files(void)
{
    write_small();
    GOOD("export d --to vtk -o a.pvd");
    file_is("a.pvd",
            "<?xml version=\"1.0\"?>\n<VTKFile "
            "type=\"Collection\" version=\"1.0\">\n<Collection>\n" PART("0", "0", "grains", "grains_000000")
                PART("0", "1", "contacts", "contacts_000000") PART("0", "2", "walls", "walls_000000")
                    PART("0.25", "0", "grains", "grains_000001")
                        PART("0.25", "1", "contacts", "contacts_000001")
                            PART("0.25", "2", "walls", "walls_000001") "</Collection>\n</VTKFile>\n");
    file_is("a_frames/grains_000000.vtp",
            VTP("2", "2", "0", "0.5 1 0\n2 1.5 0\n") CELLS(
                "Verts", "0\n1\n", "1\n2\n") "<PointData Scalars=\"radius\">\n" ARRAY("id", "1", "7\n3\n")
                ARRAY("radius", "1", "0.5\n0.25\n") ARRAY("mass", "1", "2\n4\n")
                    ARRAY("velocity", "3", "1 -1 0\n5 6 0\n") ARRAY("force", "3", "3 -4 0\n7 8 0\n")
                        ARRAY("omega", "1", "0.25\n-9\n")
                            ARRAY("contacts", "1", "1\n2\n") "</PointData>\n" LAST);
    file_is("a_frames/contacts_000000.vtp",
            VTP("0", "0", "0", "") CELLS("Lines", "", "") "<CellData>\n" ARRAY("id_a", "1", "")
                ARRAY("id_b", "1", "") ARRAY("normal_force", "1", "")
                    ARRAY("limit", "1", "") "</CellData>\n" LAST);
    file_is("a_frames/contacts_000001.vtp",
            VTP("4", "0", "2", "2.5 0.5 0\n1.5 0.75 0\n2.5 0.5 0\n2.25 -0.5 0\n")
                CELLS("Lines", "0 1\n2 3\n", "2\n4\n") "<CellData>\n" ARRAY("id_a", "1", "3\n3\n")
                    ARRAY("id_b", "1", "7\n0\n") ARRAY("normal_force", "1", "12\n11\n")
                        ARRAY("limit", "1", "inf\n4\n") "</CellData>\n" LAST);
    file_is("a_frames/walls_000000.vtp",
            VTP("4", "0", "2", "0.125 2.4375 0\n3.625 0.6875 0\n-0.875 1.0625 0\n2.625 2.8125 0\n")
                CELLS("Lines", "0 1\n2 3\n", "2\n4\n") "<CellData>\n" ARRAY("wall", "1",
                                                                            "1\n2\n") "</CellData>\n" LAST);
    file_is("a_frames/walls_000001.vtp", VTP("4", "0", "2", "0.5 2.25 0\n3 1 0\n-0.875 1.0625 0\n1 2 0\n")
                                             CELLS("Lines", "0 1\n2 3\n", "2\n4\n") "<CellData>\n" ARRAY(
                                                 "wall", "1", "1\n2\n") "</CellData>\n" LAST);
    GOOD("export d --to vtk -o b.pvd --columns r --where step=10"); /* a name of one letter */
    file_is("b_frames/grains_000000.vtp",
            VTP("1", "1", "0", "2.5 0.5 0\n")
                CELLS("Verts", "0\n", "1\n") "<PointData Scalars=\"radius\">\n" ARRAY("id", "1", "3\n")
                    ARRAY("radius", "1", "0.25\n") "</PointData>\n" LAST);
    FAILS(64, "vtk needs a name that ends in .pvd", "export d --to vtk -o .pvd");
}

/* Header lines that stand again are a list; what is no header line, or has no name, is left out. */
#define CHECK_REFUSED_JSON(text)                                                                             \
    do {                                                                                                     \
        FAILS(65, text, "export t.tsv --to json");                                                           \
        CU_ASSERT(*out == '\0');                                                                             \
    } while (0)

static void test_text_files(void)
{
    write_text("t.tsv",
               "# a: one \"two\"\n# b: 1\n# a: three\n#c: no\n# d none\n# a: four\n# units: m\t1\n# last: 2\n"
               "x\ty\tz\n1\t.5\t1e5\n-0\tnan\tx,y\n+3\tinf\t-\n");
    PRINTS_ALL(
        "{\"notes\": {\n \"a\": [\n  \"one \\\"two\\\"\",\n  \"three\",\n  \"four\"\n ],\n \"b\": \"1\",\n"
        " \"last\": \"2\"\n},\n\"units\": {\n \"x\": \"m\",\n \"y\": \"1\",\n \"z\": \"1\"\n},\n\"rows\": [\n"
        "{\"x\": 1, \"y\": 0.5, \"z\": 1e5},\n{\"x\": -0, \"y\": null, \"z\": \"x,y\"},\n"
        "{\"x\": 3.0, \"y\": \"inf\", \"z\": \"-\"}\n]}\n",
        "export t.tsv --to json");
    GOOD("export t.tsv --to json --columns z,x --where y=inf");
    CU_ASSERT_PTR_NOT_NULL(strstr(out, "\"units\": {\n \"z\": \"1\",\n \"x\": \"m\"\n},\n\"rows\": [\n"
                                       "{\"z\": \"-\", \"x\": 3.0}\n]}\n"));
    PRINTS_ALL("x,y,z\n1,.5,1e5\n-0,nan,\"x,y\"\n+3,inf,-\n", "export t.tsv --to csv");
    PRINTS_ALL("y\n.5\nnan\ninf\n", "export t.tsv --to csv --columns y");
    GOOD("export t.tsv --to csv --columns z,z,x,x,y,z");
    file_is("out", "z,z,x,x,y,z\n1e5,1e5,1,1,.5,1e5\n\"x,y\",\"x,y\",-0,-0,nan,\"x,y\"\n-,-,+3,+3,inf,-\n");
    FAILS(65, "two columns have one name", "export t.tsv --to json --columns x,y,x");
    write_text("t.tsv", "a\tb\ntrue\tfalse\n");
    PRINTS("{\"a\": true, \"b\": false}\n]}\n", "export t.tsv --to json");
    /* bytes that JSON or a terminal cannot have; none is written before */
    write_text("t.tsv", "# by: Andr\xe9\na\tb\n1\t2\n");
    CHECK_REFUSED_JSON("t.tsv: the header is no UTF-8");
    write_text("t.tsv", "a\tb\xb5\n1\t2\n");
    CHECK_REFUSED_JSON("t.tsv: the header is no UTF-8");
    PRINTS_ALL("a\n1\n", "export t.tsv --to csv --columns a");
    PRINTS("{\"a\": 1}", "export t.tsv --to json --columns a");
    write_text("t.tsv", "a\tb\n1\t2\n3\tm\xfc\n");
    CHECK_REFUSED_JSON("t.tsv:3: b = \"m?\": no UTF-8");
    PRINTS_ALL("a,b\n1,2\n3,m\xfc\n", "export t.tsv --to csv");
    static const char *const controls[] = {"\x1b[2J", "\x07", "\x7f",
                                           "\x9b"
                                           "2J",
                                           "\xc2\x9b"
                                           "2J"};
    for (size_t k = 0; k < sizeof controls / sizeof *controls; k++)
        for (int place = 0; place < 3; place++) {
            write_text("t.tsv", "# by: me%s\na\tb%s\n1\t2%s\n", place == 0 ? controls[k] : "",
                       place == 1 ? controls[k] : "", place == 2 ? controls[k] : "");
            FAILS(65, check_text("t.tsv:%d: no text: a control character (byte ", place + 1),
                  "stats select t.tsv");
        }
    /* columns without names have numbers */
    write_text("bare.txt", "1 2\n3 4\n");
    PRINTS_ALL("1,2\n1,2\n3,4\n", "export bare.txt --to csv");
    GOOD("export bare.txt --to json");
    file_is("out", "{\"notes\": {},\n\"units\": {\n \"1\": \"1\",\n \"2\": \"1\"\n},\n\"rows\": [\n"
                   "{\"1\": 1, \"2\": 2},\n{\"1\": 3, \"2\": 4}\n]}\n");
    write_text("bare.txt", "# a: b\nx\n7\n");
    PRINTS("{\"notes\": {\n \"a\": \"b\"\n},", "export bare.txt --to json");
    write_text("bare.txt", "# a: b\n7\n");
    PRINTS("{\"notes\": {\n \"a\": \"b\"\n},", "export bare.txt --to json");
}

/* ---- LAMMPS input */

#define WALLS                                                                                                \
    "walls = ( { point = [0.0, 0.0]; direction = [0.0, 1.0]; mu = 0.4; },\n"                                 \
    "  { point = [0.15, 0.0]; direction = [0.96, 0.28]; gamma_n = 300.0; },\n"                               \
    "  { point = [1.6, 0.0]; direction = [-1.0, 0.0]; } );\n"
#define SMOOTH_WALLS                                                                                         \
    "walls = ( { point = [0.0, 0.0]; direction = [0.0, 1.0]; k_n = 3.0e6; },\n"                              \
    "  { point = [1.6, 0.0]; direction = [-1.0, 0.0]; },\n"                                                  \
    "  { point = [0.15, 0.0]; direction = [0.96, 0.28]; gamma_n = 300.0; } );\n"

/* The laws that coincide. After 1000 steps of grains that collide, the programs differ by round-off that
 * every impact multiplies: by RO radii at most. A coefficient off by 1e-6 moves a grain by that and more.
 * Where the shear dashpot alone exceeds the limit, LAMMPS draws the spring the other way: it does not in the
 * first, and the others have none. */
static const struct {
    const char *name, *laws;
} same[] = {
    {"spring",
     "normal = { law = \"linear\"; k_n = 2.0e5; gamma_n = 400.0; tension = false; };\n" WALLS
     "tangential = { law = \"spring\"; k_s = 2.0e4; gamma_s = 30.0; mu = 0.2; damping = \"inside\"; };\n"},
    {"hertz",
     "normal = { law = \"hertz\"; k_n = 1.0e6; gamma_n = 400.0; tension = false; };\n" WALLS
     "tangential = { law = \"spring\"; k_s = 2.0e4; gamma_s = 0.0; mu = 0.2; damping = \"inside\"; };\n"},
    {"slip", "normal = { law = \"hertz\"; k_n = 1.0e6; restitution = 0.8; restitution_speed = 50.0; tension "
             "= false; };\n"
             "walls = ( { point = [0.0, 0.0]; direction = [0.0, 1.0]; mu = 0.4; },\n"
             "  { point = [0.15, 0.0]; direction = [0.96, 0.28]; }, { point = [1.6, 0.0]; direction = [-1.0, "
             "0.0]; } );\n"
             "tangential = { law = \"slip_roll\"; gamma_s = 200.0; mu = 0.2; };\n"},
    {"mindlin",
     "normal = { law = \"elastic\"; k_n = 2.2e7; restitution = 0.7; tension = false; };\n"
     "walls = ( { point = [0.0, 0.0]; direction = [0.0, 1.0]; mu = 0.5; k_n = 3.5e7; k_s = 2.4e7; },\n"
     "  { point = [0.15, 0.0]; direction = [0.96, 0.28]; k_s = 3.0e7; }, { point = [1.6, 0.0]; "
     "direction = [-1.0, 0.0]; } );\n"
     "tangential = { law = \"mindlin\"; k_s = 1.8e7; gamma_s = 0.0; mu = 0.3; damping = \"inside\"; };\n"},
    {"pulls", "normal = { law = \"hertz\"; k_n = 1.0e6; gamma_n = 900.0; };\n" SMOOTH_WALLS}};

/* Rows of grains of three radii that touch nothing yet; two at the bottom are fixed. No number
 * is round: where a grain touches exactly at a step, round-off decides on its damping. */
static void write_grains(const char *file)
{
    FILE *f = file_of(file);
    fputs("x\ty\tr\tvx\tvy\tfixed\n", f);
    for (int i = 0; i < 30; i++) {
        const double moves = i < 2 ? 0.0 : 1.0;
        fprintf(f, "%g\t%g\t%g\t%g\t%g\t%d\n", 0.3 + 0.23 * (i % 5) + 0.01 * (i / 5), 0.12 + 0.21 * (i / 5),
                0.08 + 0.01 * (i * 7 % 3), -9.7313 * (i % 4) * moves, -(41.237 + 0.3173 * i) * moves, i < 2);
    }
    fclose(f);
}

static void write_same(size_t i)
{
    write_text(check_text("%s.cfg", same[i].name),
               "gravity = [-100.0, -981.0]; dt = 2.0e-5; particles_file = \"grains.tsv\";\n%s", same[i].laws);
}

enum { N_SAME = sizeof same / sizeof *same };

static void test_lammps_input(void)
{
    char names[128] = "lammps_input";
    if (has_lammps()) {
        write_grains("grains.tsv");
        for (size_t i = 0; i < N_SAME; i++) {
            const char *name = same[i].name;
            write_same(i);
            GOOD("export %s.cfg --set steps=1000 --to lammps-input -o %s.in", name, name);
            GOOD("run %s.cfg --set steps=1000 -o %s", name, name);
            strcat(strcat(names, " "), name);
        }
        write_text(
            "flat.cfg",
            "gravity = [0.0, 0.0]; dt = 1e-6; normal = { law = \"linear\"; k_n = 1e5; };\n"
            "particles = ( { x = 0.0; y = 0.0; r = 0.1; vx = 100.0; }, { x = 0.25; y = 0.0; r = 0.1; } );\n");
        GOOD("export flat.cfg --set steps=1000 --to lammps-input -o flat.in");
        GOOD("run flat.cfg --set steps=1000 -o flat");
        CU_ASSERT(readers(strcat(names, " flat"))); /* flat: in a region without a height */
    }
}

/* A grain that hits a wall, and two that hit each other, with spin: LAMMPS takes the slip at the radii, and
 * the spins differ by a share of the overlap, which falls as E^-0.4. */
static void spin_apart(const char *shape, double E, double apart[3])
{
    write_text("spin.cfg",
               "gravity = [0.0, 0.0]; dt = 2.0e-7; steps = 15000; rotation = true; shape = \"%s\";\n"
               "material = { E = %g; nu = 0.3; restitution = 0.7; mu = 0.3; };\n"
               "walls = ( { point = [0.0, 0.0]; direction = [0.0, 1.0]; } );\n"
               "particles = ( { x = 0.0; y = 0.12; r = 0.1; vx = 9.0; vy = -40.0; omega = 100.0; },\n"
               "  { x = 1.0; y = 0.5; r = 0.1; vx = 30.0; vy = 3.0; omega = 20.0; },\n"
               "  { x = 1.211; y = 0.53; r = 0.11; vx = -10.0; omega = 70.0; } );\n",
               shape, E);
    GOOD("export spin.cfg --to lammps-input -o spin.in --force");
    GOOD("run spin.cfg -o spin --force");
    SHELL("lmp -in spin.in >said && tail -n 3 spin.lammpstrj | awk '{ print $NF }' >out");
    double theirs[3];
    CU_ASSERT(sscanf(out, "%lf %lf %lf", &theirs[0], &theirs[1], &theirs[2]) == 3);
    scoped_table ours = read_table("spin/states.tsv");
    for (int i = 0; i < 3; i++) apart[i] = fabs(cell(&ours, (size_t)i, "omega") - theirs[i]);
}

static void test_spins(void)
{
    if (!has_lammps()) return;
    for (int disk = 0; disk < 2; disk++) {
        double soft[3], stiff[3];
        spin_apart(disk ? "disk" : "sphere", 3e8, soft);
        spin_apart(disk ? "disk" : "sphere", 3e9, stiff);
        for (int i = 0; i < 3; i++) /* 2.5 */
            CU_ASSERT(soft[i] < 4.0 && soft[i] > 2.0 * stiff[i] && soft[i] < 3.2 * stiff[i]);
    }
}

/* Rolling resistance by itself is that of LAMMPS: spins differ by round-off. With friction the arms of the
 * slip differ, and so does the way of a grain that slides, rolls and slows, as the overlap: 9e-4 of it. */
static void test_rolls(void)
{
    static const char *const laws[] = {"gamma = 30.0;", "gamma = 0.0; arm = \"radius\";"};
    double theirs[3], apart[2];
    if (!has_lammps()) return;
    for (int k = 0; k < 2; k++) {
        write_text("rolls.cfg",
                   "gravity = [-100.0, -981.0]; dt = 1e-6; steps = 40000; rotation = true;\n"
                   "normal = { law = \"hertz\"; k_n = 2.0e7; gamma_n = 400.0; tension = false; };\n"
                   "tangential = { law = \"spring\"; k_s = 2.0e6; gamma_s = 0.0; mu = 0.0; damping = "
                   "\"inside\"; };\n"
                   "rolling = { mu = 0.1; k = 1e6; %s };\n"
                   "walls = ( { point = [0.0, 0.0]; direction = [0.0, 1.0]; },\n"
                   "  { point = [-0.4, 0.0]; direction = [1.0, 0.0]; } );\n"
                   "particles = ( { x = 0.0; y = 0.1; r = 0.1; vx = 9.0; vy = -4.0; omega = -20.0; },\n"
                   "  { x = 0.25; y = 0.13; r = 0.11; vx = -10.0; omega = 70.0; },\n"
                   "  { x = 0.1; y = 0.32; r = 0.1; vx = 1.0; omega = -40.0; } );\n",
                   laws[k]);
        GOOD("export rolls.cfg --to lammps-input -o rolls.in --force");
        GOOD("run rolls.cfg -o rolls --force");
        SHELL("lmp -in rolls.in >said && tail -n 3 rolls.lammpstrj | awk '{ print $NF }' >out");
        CU_ASSERT(sscanf(out, "%lf %lf %lf", &theirs[0], &theirs[1], &theirs[2]) == 3);
        scoped_table ours = read_table("rolls/states.tsv");
        for (int i = 0; i < 3; i++) CU_ASSERT(fabs(cell(&ours, (size_t)i, "omega") - theirs[i]) < 1e-6);
    }
    for (int k = 0; k < 2; k++) {
        const char *stiff =
            k ? "4.1e5" : "4.1e4"; /* overlaps of a thousandth of the radius, and a tenth of it */
        write_text(
            "slows.cfg",
            "dt = 5e-6; steps = 20000; rotation = true;\n"
            "normal = { law = \"linear\"; k_n = %s; gamma_n = 400.0; tension = false; };\n"
            "tangential = { law = \"spring\"; k_s = %s; gamma_s = 0.0; mu = 0.4; damping = \"inside\"; };\n"
            "rolling = { mu = 0.05; gamma = 100.0; };\n"
            "walls = ( { point = [0.0, 0.0]; direction = [0.0, 1.0]; k_n = %s; } );\n"
            "particles = ( { x = 0.0; y = 0.1; r = 0.1; vx = 9.0; } );\n",
            stiff, stiff, stiff);
        GOOD("export slows.cfg --to lammps-input -o slows.in --force");
        GOOD("run slows.cfg -o slows --force");
        SHELL("lmp -in slows.in >said && tail -n 1 slows.lammpstrj | awk '{ print $3 }' >out");
        scoped_table ours = read_table("slows/states.tsv");
        CU_ASSERT(sscanf(out, "%lf", theirs) == 1 && *theirs > 0.4);
        apart[k] = fabs(cell(&ours, 0, "x") - *theirs) / *theirs;
    }
    CU_ASSERT(apart[0] < 1.2e-3 && apart[0] > 8.0 * apart[1] && apart[0] < 12.0 * apart[1]);
}

#define KINDS                                                                                                \
    "kinds = { hard = { density = 2.0; }; soft = { material = { E = 1.0e7; restitution = 0.5; mu = 0.5; }; " \
    "}; };\n"                                                                                                \
    "pairs = ( { of = (\"hard\", \"soft\"); restitution = 0.6; mu = 0.1; },\n"                               \
    "  { of = (\"hard\", \"box\"); restitution = 0.8; mu = 0.4; },\n"                                        \
    "  { of = (\"soft\", \"box\"); restitution = 0.4; mu = 0.2; } );\n"

/* Two kinds in a box, with coefficients for each two and for each with the walls. */
static void test_kinds(void)
{
    if (!has_lammps()) return;
    FILE *f = file_of("two.tsv");
    fputs("x\ty\tr\tvx\tvy\tkind\n", f);
    for (int i = 0; i < 30; i++)
        fprintf(f, "%g\t%g\t%g\t%g\t%g\t%s\n", 0.3 + 0.23 * (i % 5) + 0.01 * (i / 5), 0.12 + 0.21 * (i / 5),
                0.08 + 0.01 * (i * 7 % 3), -9.7313 * (i % 4), -(41.237 + 0.3173 * i),
                i % 3 ? "soft" : "hard");
    fclose(f);
    write_text("two.cfg",
               "gravity = [-100.0, -981.0]; dt = 2.0e-5; particles_file = \"two.tsv\";\n" KINDS
               "normal = { tension = false; }; tangential = { gamma_s = 0.0; damping = \"inside\"; };\n"
               "material = { E = 3.0e7; nu = 0.3; restitution = 0.7; mu = 0.3; };\n"
               "walls = ( { name = \"box\"; point = [0.0, 0.0]; direction = [0.0, 1.0]; },\n"
               "  { name = \"box\"; point = [0.15, 0.0]; direction = [0.96, 0.28]; E = 9.0e7; },\n"
               "  { name = \"box\"; point = [1.6, 0.0]; direction = [-1.0, 0.0]; } );\n");
    GOOD("export two.cfg --set steps=1000 --to lammps-input -o two.in");
    GOOD("run two.cfg --set steps=1000 -o two");
    CU_ASSERT(readers("lammps_input two"));
}

/* The coefficients by hand: k_n in series, with the walls' twice the grains'; and types read back as kinds,
 * of which the scene's order decides. */
static void test_kinds_written(void)
{
    char text[1 << 13];
    write_text("k.cfg", "dt = 1.0e-5; steps = 5; normal = { law = \"linear\"; k_n = 1.0e5; gamma_n = 4.0; "
                        "tension = false; };\n"
                        "kinds = { a = { }; b = { k_n = 3.0e5; }; };\n"
                        "walls = ( { point = [0.0, -8.0]; direction = [0.0, 1.0]; } );\n"
                        "particles = ( { x = 0.0; y = 0.0; r = 0.25; kind = \"b\"; }, { x = 1.0; y = 0.0; r "
                        "= 0.125; kind = \"a\"; },\n"
                        "  { x = 2.0; y = 0.0; r = 0.125; kind = \"b\"; } );\n");
    GOOD("export k.cfg --to lammps-input -o k.in");
    slurp("k.in", text, sizeof text);
    CHECK_PARTS(text, "\n# type 1: kind a\n# type 2: kind b\n", "\npair_coeff 1 1 hooke 100000 4 ",
                "\npair_coeff 1 2 hooke 150000 4 ", "\npair_coeff 2 2 hooke 300000 4 ",
                "\nfix wall1_1 type1 wall/gran/region granular hooke 200000 4 ",
                "\nfix wall1_2 type2 wall/gran/region granular hooke 600000 4 ");
    slurp("k.data", text, sizeof text);
    CHECK_PARTS(text, "\n2 atom types\n", "\n1 2 0.5 ", "\n2 1 0.25 ", "\n3 2 0.25 ");
    write_text("back.cfg",
               "dt = 1e-5; steps = 0; particles_file = \"k.data\"; kinds = { p = { }; q = { }; };\n");
    GOOD("run back.cfg -o back --force");
    scoped_table t = read_table("back/states.tsv");
    for (int i = 0; i < 3; i++) CU_ASSERT_EQUAL(cell(&t, (size_t)i, "kind"), i == 1 ? 1.0 : 2.0);
    write_text("back.cfg", "dt = 1e-5; steps = 0; particles_file = \"k.data\"; kinds = { p = { }; };\n");
    FAILS(65, "k.data:11: type = 2: a number from 1 to 1 expected", "run back.cfg");
    /* kinds keep their numbers, with grains or without */
    SHELL("sed -i 's/kinds = {/kinds = { unused = { };/' k.cfg");
    GOOD("export k.cfg --to lammps-input -o u.in");
    slurp("u.data", text, sizeof text);
    CHECK_PARTS(text, "\n3 atom types\n", "\n1 3 0.5 ", "\n2 2 0.25 ", "\n3 3 0.25 ");
    SHELL("sed -i 's/kind = \"a\"; //' k.cfg");
    GOOD("export k.cfg --to lammps-input -o u.in --force");
    slurp("u.data", text, sizeof text);
    CHECK_PARTS(text, "\n4 atom types\n", "\n1 3 0.5 ", "\n2 4 0.25 ", "\n3 3 0.25 ");
}

/* Fixed grains, the first and the last among them, are held by their numbers. */
static void test_held(void)
{
    write_text("g.tsv", "x\ty\tr\tfixed\n0\t0\t0.1\t1\n1\t0\t0.1\t0\n2\t0\t0.1\t1\n");
    write_text("held.cfg", "particles_file = \"g.tsv\"; dt = 1e-5; steps = 10;\n"
                           "normal = { law = \"linear\"; tension = false; };\n");
    GOOD("export held.cfg --to lammps-input -o held.in");
    SHELL("grep '^group fixed' held.in >out");
    CU_ASSERT_STRING_EQUAL(out, "group fixed id 1\ngroup fixed id 3\n");
}

/* Columns of the grains that a file gives, without a step. */
#define PLACES "4-5,7-9,12" /* x y vx vy omega r */
static void grains_of(const char *file, const char *columns, char grains[4096])
{
    write_text("given.cfg", "rotation = true; dt = 1e-5; steps = 0; particles_file = \"%s\";", file);
    GOOD("run given.cfg");
    SHELL(check_text("grep -v '^#' out | cut -f %s >grains", columns));
    slurp("grains", grains, 4096);
}

/* A run, as its table has it and as LAMMPS would, is the same grains; so is a scene that LAMMPS has read and
 * written again, but for angles and, by way of a density, the last bit of a mass. */
static void test_given(void)
{
    char first[4096], again[4096];
    write_run();
    GOOD("export pile --to lammps -o pile.lammpstrj");
    grains_of("pile/states.tsv", "3-15", first);
    grains_of("pile.lammpstrj", "3-15", again);
    CU_ASSERT_STRING_EQUAL(first, again);
    CU_ASSERT(strstr(first, "\t0.09\t") && strchr(first, '\n') != strrchr(first, '\n'));
    write_text("in.cfg", "dt = 1e-5; rotation = true; normal = { tension = false; };\n"
                         "particles_file = \"pile.lammpstrj\"; particles_step = 250;\n");
    GOOD("run in.cfg --set steps=0 -o in");
    grains_of("in/states.tsv", PLACES, first);
    GOOD("export in.cfg --to lammps-input -o in.in");
    grains_of("in.data", PLACES, again);
    CU_ASSERT_STRING_EQUAL(first, again);
    if (!has("command -v lmp", "LAMMPS", check_skip)) return;
    SHELL("echo 'write_data again.data' >>in.in && lmp -in in.in -var steps 0 >said");
    grains_of("again.data", PLACES, again);
    CU_ASSERT_STRING_EQUAL(first, again);
    grains_of("in.lammpstrj", PLACES, again);
    CU_ASSERT_STRING_EQUAL(first, again);
}

/* The input by hand: Hertz' k is 1e5/sqrt(R_eff), with R_eff = 1/32, 1/20 and 1/8 of pairs, and the radius at
 * walls, which are twice as stiff as grains. gamma_s over gamma_n is 100/400, or 0. */
static const char input[] =
    "variable steps index 250\n"
    "variable every index 2\n"
    "variable data index h.data\n"
    "variable dump index h.lammpstrj\n"
    "\n"
    "units lj\n"
    "dimension 2\n"
    "boundary m m p\n"
    "atom_style sphere\n"
    "atom_modify map array\n"
    "newton off\n"
    "comm_modify vel yes\n"
    "read_data ${data}\n"
    "\n"
    "pair_style granular\n"
    "pair_coeff 1 1 hertz 565685.424949238 400 tangential linear_history 20000 0.25 0.25 damping "
    "mass_velocity limit_damping\n"
    "pair_coeff 1 2 hertz 447213.59549995797 400 tangential linear_history 20000 0.25 0.25 damping "
    "mass_velocity limit_damping\n"
    "pair_coeff 2 2 hertz 282842.712474619 400 tangential linear_history 20000 0.25 0.25 damping "
    "mass_velocity limit_damping\n"
    "neighbor 0.125 bin\n"
    "neigh_modify every 1 delay 0 check yes\n"
    "timestep 2e-05\n"
    "\n"
    "group fixed id 2\n"
    "fix hold fixed freeze\n"
    "group mobile subtract all fixed\n"
    "fix gravity mobile gravity 5 vector -3 -4 0\n"
    "fix move mobile nve\n"
    "fix flat all enforce2d\n"
    "group type1 type 1\n"
    "group type2 type 2\n"
    "region wall1 plane 0.5 0.25 0 0.6 0.8 0\n"
    "fix wall1_1 type1 wall/gran/region granular hertz 800000 400 tangential linear_history 20000 0.25 0.75 "
    "damping mass_velocity limit_damping region wall1\n"
    "fix wall1_2 type2 wall/gran/region granular hertz 400000 400 tangential linear_history 20000 0.25 0.75 "
    "damping mass_velocity limit_damping region wall1\n"
    "region wall2 plane 4 0 0 -1 0 0\n"
    "fix wall2_1 type1 wall/gran/region granular hertz 1200000 400 tangential linear_history 20000 0 0.25 "
    "damping mass_velocity limit_damping region wall2\n"
    "fix wall2_2 type2 wall/gran/region granular hertz 600000 400 tangential linear_history 20000 0 0.25 "
    "damping mass_velocity limit_damping region wall2\n"
    "\n"
    "dump frames all custom ${every} ${dump} id type x y z radius mass vx vy vz\n"
    "dump_modify frames sort id format float %.17g\n"
    "thermo ${every}\n"
    "run ${steps}\n";

static void test_input_files(void)
{
    char text[1 << 13];
    write_text(
        "h.cfg",
        "gravity = [-3.0, -4.0]; dt = 2.0e-5; steps = 250; density = 2.5;\n"
        "normal = { law = \"hertz\"; k_n = 1.0e5; gamma_n = 400.0; tension = false; };\n"
        "tangential = { law = \"spring\"; k_s = 2.0e4; gamma_s = 100.0; mu = 0.25; damping = \"inside\"; };\n"
        "walls = ( { point = [0.5, 0.25]; direction = [0.6, 0.8]; mu = 0.75; },\n"
        "  { point = [4.0, 0.0]; direction = [-1.0, 0.0]; k_n = 3.0e5; gamma_s = 0.0; } );\n"
        "particles = ( { x = 1.0; y = 2.0; r = 0.25; vx = 3.0; vy = -1.0; },\n"
        "  { x = 3.0; y = 1.0; r = 0.0625; fixed = true; }, { x = 2.0; y = 1.5; r = 0.25; vy = 2.5; } );\n");
    GOOD("export h.cfg --to lammps-input -o h.in");
    file_is("h.data", "# h.cfg, written by repose export; columns: id type diameter density x y z\n\n"
                      "3 atoms\n2 atom types\n"
                      "0.75 3.0625 xlo xhi\n0.9375 2.25 ylo yhi\n-0.25 0.25 zlo zhi\n\nAtoms # sphere\n\n"
                      "1 2 0.5 2.5 1 2 0\n2 1 0.125 2.5 3 1 0\n3 2 0.5 2.5 2 1.5 0\n\nVelocities\n\n"
                      "1 3 -1 0 0 0 0\n2 0 0 0 0 0 0\n3 0 2.5 0 0 0 0\n");
    slurp("h.in", text, sizeof text);
    const char *after = strstr(text, "\nvariable ");
    CU_ASSERT_PTR_NOT_NULL_FATAL(after);
    CU_ASSERT_STRING_EQUAL(after + 1, input);
    CHECK_PARTS(text, "\n# normal force: hertz; LAMMPS' own stiffness is k sqrt(R_eff)",
                ", together not below 0\n# shear force: spring k_s and dashpot gamma_s m_eff, ",
                "\n# start: of contacts whose dashpot", "\n# dashpot alone above mu F_n");
}

/* Of one type, whose radii do not count; without gravity, shear and springs; a name of one letter. */
static void test_plain_input(void)
{
    char text[1 << 13];
    write_text("l.cfg",
               "dt = 2.0e-5; steps = 199; gravity = [0.0, 0.0];\n"
               "normal = { law = \"linear\"; k_n = 1.0e5; gamma_n = 0.5; };\n"
               "walls = ( { point = [0.0, -8.0]; direction = [0.0, 1.0]; } );\n"
               "particles = ( { x = -1.0; y = -2.0; r = 0.25; }, { x = -3.0; y = -1.0; r = 0.0625; } );\n");
    GOOD("export l.cfg --to lammps-input -o l.in");
    slurp("l.data", text, sizeof text);
    CU_ASSERT(strstr(text, "\n-3.0625 -0.75 xlo xhi\n-2.25 -0.9375 ylo yhi\n-0.25 0.25 zlo zhi\n") != NULL);
    slurp("l.in", text, sizeof text);
    CU_ASSERT(strstr(text, "\nvariable every index 1\n") && !strstr(text, "\ngroup type") &&
              !strstr(text, "fix gravity"));
#define HOOKE "000 0.5 tangential linear_nohistory 0 0 damping mass_velocity"
    CHECK_PARTS(text, "\npair_coeff * * hooke 100" HOOKE "\nneighbor ",
                "\ngroup mobile union all\nfix move mobile nve\nfix flat all enforce2d\nregion wall1 "
                "plane 0 -8 0 0 1 0\nfix wall1_1 all wall/gran/region granular hooke 200" HOOKE
                " region wall1\n\ndump ");
    CU_ASSERT(strstr(text, "# normal force: linear, dashpot gamma_n m_eff, which may pull\n# "
                           "shear force: none\n") &&
              !strstr(text, "# start"));
    GOOD("export l.cfg --to lammps-input -o a.in --set steps=200 --set 'gravity=[0.0,-0.5]' --set dt=1e-5");
    slurp("a.in", text, sizeof text);
    CHECK_PARTS(text, "\nvariable every index 2\n", "\nfix gravity mobile gravity 0.5 vector 0 -0.5 0\n");
    FAILS(64, "lammps-input needs a name that ends in .in", "export l.cfg --to lammps-input -o .in");
}

/* Of Hertz' law, 24 radii are as many as LAMMPS has types for; a radius that comes again is none. */
static void test_types(void)
{
    char grains[2048] = "x\ty\tr\n";
    for (int i = 0; i < 25; i++)
        sprintf(grains + strlen(grains), "%d\t0\t%g\n", i, 0.25 - 0.0078125 * (i % 24));
    write_text("g.tsv", "%s", grains);
    write_text("s.cfg", "particles_file = \"g.tsv\"; dt = 1e-6; steps = 10; normal = { law = \"hertz\"; "
                        "tension = false; };\n");
    GOOD("export s.cfg --to lammps-input -o s.in");
    CU_ASSERT(shell("grep -c pair_coeff s.in >out") == 0 && strcmp(out, "300\n") == 0);
    write_text("g.tsv", "%s25\t0\t0.5\n", grains);
    FAILS(65, "each radius is a type of LAMMPS, at most 24;", "export s.cfg --to lammps-input -o t.in");
#define ROLLS "--set normal.law=linear --set rotation=true --set tangential.law=spring --set rolling.mu=0.1 "
    FAILS(65, "normal.law = \"linear\", rolling.gamma: each radius and mass is a type of LAMMPS, at most 24;",
          "export s.cfg " ROLLS
          "--set rolling.gamma=1 --set tangential.damping=inside --to lammps-input -o t.in");
    GOOD("export s.cfg " ROLLS
         "--set rolling.gamma=0 --set tangential.damping=inside --to lammps-input -o t.in");
}

static void export_law(const char *laws, const char *name, const char *lammps, const char *before)
{
    char text[4096];
    write_text("law.cfg", "dt = 1e-6; particles = ( { x = 0.0; y = 0.0; r = 0.1; } ); %s\n", laws);
    if (lammps) {
        GOOD("export law.cfg --to lammps-input -o law.in --force");
        slurp("law.in", text, sizeof text);
        CU_ASSERT_PTR_NOT_NULL(strstr(text, check_text("%s%s ", before, lammps)));
    } else {
        FAILS(65, check_text("law = \"%s\": LAMMPS has no such law", name),
              "export law.cfg --to lammps-input -o law.in --force");
    }
}

/* Each law has its own name in LAMMPS, or is refused by its name here. */
static void test_laws(void)
{
    for (int i = 0; i < DEM_NORMAL_N; i++) {
        const dem_normal_descriptor *law = &dem_normal_descriptors[i];
        export_law(check_text("normal = { law = \"%s\"; tension = false; gamma_n = 0.1; };", law->name),
                   law->name, law->lammps, "pair_coeff * * ");
        for (int k = 0; k < i && law->lammps; k++)
            CU_ASSERT(!dem_normal_descriptors[k].lammps ||
                      strcmp(law->lammps, dem_normal_descriptors[k].lammps) != 0 ||
                      law->lammps_damping != dem_normal_descriptors[k].lammps_damping);
    }
    for (int i = 0; i < DEM_TANGENTIAL_N; i++) {
        const dem_tangential_descriptor *law = &dem_tangential_descriptors[i];
        const char *laws =
            check_text("normal = { tension = false; gamma_n = 0.1; }; tangential = { law = \"%s\"; %s %s };",
                       law->name, dem_has_spring(i) || dem_has_friction(i) ? "mu = 0.2;" : "",
                       dem_has_spring(i) ? "damping = \"inside\";" : "");
        export_law(laws, law->name, law->lammps, " tangential ");
    }
    CU_ASSERT(!dem_normal_descriptors[DEM_TSUJI].lammps);
}

/* Every setting without an equal is refused by its key. */
static void test_refused(void)
{
    static const char *const refused[][2] = {
        {"integrator=gear5", "integrator: LAMMPS steps as"},
        {"rotation=true --set rolling.mu=infinite", "rolling.mu = infinite"},
        {"rotation=true --set rolling.mu=0.1 --set rolling.model=constant", "rolling.model: LAMMPS has"},
        {"rotation=true --set rolling.mu=0.1 --set tangential.law=mindlin --set tangential.gamma_s=0",
         "rolling: of this tangential.law"},
        {"normal.tension=true", "normal.tension = true"},
        {"tangential.slip=total", "tangential.slip = \"total\""},
        {"tangential.damping=outside", "tangential.damping = \"outside\""},
        {"tangential.mu=infinite", "tangential.mu = infinite"},
        {"normal.gamma_n=0 --set dt=1e-6", "tangential.gamma_s = 30"},
        {"tangential.law=mindlin", "tangential.gamma_s = 30: LAMMPS damps shear"},
        {"particles_file=bed.tsv --set contacts_file=contacts.tsv", "contacts_file: springs"},
        {"x_max=5", "x_max: "},
        {"y_min=-5", "y_min: "},
        {"gravity_turn_deg_per_step=0.1", "gravity_turn_deg_per_step"},
        {"box_turn_deg_per_step=0.1", "box_turn_deg_per_step"}};
    write_grains("grains.tsv");
    write_same(0);
    write_text("bed.tsv", "# id\tx\ty\tr\n1\t0\t0.5\t0.1\n2\t0.2\t0.5\t0.1\n");
    write_text(
        "contacts.tsv",
        "# "
        "id_a\tid_b\twall\tx_b\ty_b\toverlap\tshear_spring\trolling_spring\n1\t2\t0\t0.1\t0.5\t0\t0.01\t0\n");
    for (size_t i = 0; i < sizeof refused / sizeof *refused; i++)
        FAILS(65, refused[i][1], "export spring.cfg --to lammps-input -o a.in --set %s", refused[i][0]);
    static const char *const walls[][2] = {
        {"extent = [0.0, 1.0];", "wall 1: extent"},
        {"extent = (\"-inf\", 1.0);", "wall 1: extent"},
        {"open_at_step = 5;", "wall 1: open_at_step = 5"},
        {"velocity = [0.0, 0.5];", "wall 1: velocity"},
        {"velocity = [0.5, 0.0];", "wall 1: velocity"},
        {"velocity = [0.0, 1.0];", "wall 1: velocity"},
        {"gamma_n = 0.0; gamma_s = 0.5;", "wall 1: tangential.gamma_s = 0.5"},
        {"omega = 1.0;", "wall 1: omega"},
        {"mu = \"infinite\";", "wall 1: tangential.mu = infinite"}};
    for (size_t i = 0; i < sizeof walls / sizeof *walls; i++) {
        write_text("w.cfg",
                   "dt = 1e-6; particles_file = \"grains.tsv\"; normal = { tension = false; };\n"
                   "tangential = { law = \"spring\"; mu = 0.1; damping = \"inside\"; };\n"
                   "walls = ( { point = [0.0, 0.0]; direction = [0.0, 1.0]; %s } );\n",
                   walls[i][0]);
        FAILS(65, walls[i][1], "export w.cfg --to lammps-input -o a.in");
    }
#define WITH_GRAINS "particles_file = \"grains.tsv\"; "
    static const char *const scenes[][2] = {
        {WITH_GRAINS "normal = { law = \"tsuji\"; gamma_n = 0.1; };", "normal.law = \"tsuji\""},
        {WITH_GRAINS "normal = { tension = false; }; hard = { restitution = 0.5; };", "hard: "},
        {WITH_GRAINS "normal = { tension = false; }; phases = ( { name = \"a\"; steps = 1; } );", "phases: "},
        {WITH_GRAINS "walls = ( { point = [0.0, 0.0]; direction = [0.0, 1.0]; } ); ground = { mu_static = "
                     "0.5; a = 0.01; };",
         "ground: "},
        {WITH_GRAINS "integrator = \"implicit\";", "integrator: "},
        {WITH_GRAINS "dt = 1e-6; normal = { law = \"elastic\"; k_n = 0.0; gamma_n = 0.3; tension = false; }; "
                     "tangential = { law = \"mindlin\"; mu = 0.1; damping = \"inside\"; };",
         "tangential.gamma_s = 0.24"},
        {WITH_GRAINS "dt = 1e-6; material = { E = 1e7; nu = 0.3; restitution = 0.1; mu = 0.5; };",
         "normal.gamma_n = 2.77"},
        {"fill = { N = 30; W = 2.0; H = 8.0; };", "normal.law = \"hertz\": each radius is a type of LAMMPS"}};
    CHECK_REFUSED(scenes, "w.cfg", "export w.cfg --to lammps-input -o a.in");
    CU_ASSERT(shell("ls a.in a.data >out 2>err") != 0);
}

/* ---- other programs, where installed; Python */

static void test_readers(void)
{
    static const char *const cases[][3] = {{"command -v lmp", "LAMMPS", "lammps"},
                                           {PYTHON "-c 'import vtkmodules'", "VTK", "vtk"},
                                           {PYTHON "-c 'import pandas'", "pandas", "pandas"}};
    export_formats();
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++)
        if (has(cases[k][0], cases[k][1], check_skip)) CU_ASSERT(readers(cases[k][2]));
}

/* Random texts as names of columns and units, and as names of files: CSV and JSON have them as they are, the
 * formats of grains as one word; in the input of LAMMPS a name is refused, or is one word. */
static void test_random_texts(void)
{
    enum { TEXTS = 1000, A_TABLE = 50 };
    if (CHECK_SKIPS("Python's part has no sanitizers")) return;
    scoped_rng *rng = numbers_of(2385, 9);
    char text[NUMBERS_TEXT], file[NUMBERS_TEXT + 8];
    const char *const ends[] = {"lammpstrj", "pvd", "in"}, *const formats[] = {"lammps", "vtk",
                                                                               "lammps-input"};
    write_text("l.cfg", "dt = 2.0e-5; steps = 199; gravity = [0.0, 0.0];\n"
                        "normal = { law = \"linear\"; k_n = 1.0e5; gamma_n = 0.5; };\n"
                        "particles = ( { x = -1.0; y = -2.0; r = 0.25; } );\n");
    size_t taken = 0;
    for (int t = 0; t < TEXTS / A_TABLE; t++) {
        FILE *table = file_of("random.tsv"), *names = file_of("names");
        fputs("# units: 1\tcm\tcm\tcm", table);
        for (int c = 0; c < A_TABLE; c++) {
            numbers_text(rng, "\n\t\r\x01", text);
            fprintf(table, "\t%s", text);
            fprintf(names, "%s\n", text);
        }
        fputs("\nid\tx\ty\tr", table);
        for (int c = 0; c < A_TABLE; c++) {
            numbers_text(rng, "\n\t\r\x01 ,'\"", text);
            fprintf(table, "\tc%d%s", c, text);
            fprintf(names, "c%d%s\n", c, text);
        }
        for (int i = 0; i < 2; i++) {
            fprintf(table, "\n%d\t%d\t0\t0.5", i, 2 * i);
            for (int c = 0; c < A_TABLE; c++) fprintf(table, "\t%d", c + i);
        }
        fputs("\n", table);
        fclose(table);
        fclose(names);
        SHELL("mkdir made >out 2>err && rm -f random.csv random.json");
        GOOD("export random.tsv --to csv -o random.csv");
        GOOD("export random.tsv --to json -o random.json");
        for (int k = 0; k < 3; k++) {
            numbers_text(rng, t % 2 ? "/" : "/ \n\t\r\x01'\"\\`$;|&<>#%{}*?~!^@=,:", text);
            snprintf(file, sizeof file, "r%s.%s", text, ends[k]);
            write_text("file", "%s", file);
            write_text("format", "%s", formats[k]);
            const char *line =
                k == 2
                    ? "cp l.cfg \"made/$(cat file).cfg\"; \"$REPOSE\" export \"made/$(cat file).cfg\" --to "
                      "lammps-input -o \"made/$(cat file)\" >out 2>err"
                    : "\"$REPOSE\" export random.tsv --to $(cat format) -o \"made/$(cat file)\" >out 2>err";
            const int status = shell(line);
            taken += k == 2 && status == 0;
            CU_ASSERT(status == 0 || (k == 2 && status == 64 && strstr(err, "letters, digits and ._+-")));
        }
        CU_ASSERT(readers("random"));
        SHELL("! ls hit made/hit >out 2>err && rm -r made");
    }
    CU_ASSERT(taken > 0);
}

/* python/repose.py, and its example. */
static void test_package(void)
{
    if (CHECK_SKIPS("Python's part has no sanitizers")) return;
    char script[PATH_MAX];
    write_run();
    write_text(
        "e.cfg",
        "let = { n = 40; }; particles = ( { x = 0.0; y = 0.0; r = 0.1; } );\n"
        "phases = ( { name = \"fall\"; steps = \"n\"; every = 10; fail = { late = \"step > 45\"; }; } );\n"
        "measure = ( { name = \"n_steps\"; of = \"step\"; unit = \"steps\"; } );\n");
    write_text("sweep.cfg", SWEEP);
    GOOD("sweep plan sweep.cfg -o first");
    CU_ASSERT(run("sweep run first -j 1") == 0);
    GOOD("sweep export first -o runs.tsv");
    GOOD("sweep plan sweep.cfg -o part");
    CU_ASSERT(run("sweep run part -j 1 --shard 2/2") == 0);
    CU_ASSERT(readers("package"));
    CU_ASSERT_PTR_NOT_NULL_FATAL(realpath("python/pile.py", script));
    CU_ASSERT(shell_line("export REPOSE; " PYTHON "%s example >out 2>err", script) == 0);
    CU_ASSERT(strstr(out, "theta_R by method 3: ") && *err == '\0');
}

CHECK_SUITE_WITHIN(export, "export", enter, leave, test_formats, test_sources, test_sweep, test_back,
                   test_long_names, test_errors, test_dump_files, test_vtk_files, test_text_files,
                   test_lammps_input, test_spins, test_rolls, test_given, test_kinds, test_kinds_written,
                   test_held, test_input_files, test_plain_input, test_types, test_laws, test_refused,
                   test_readers, test_random_texts, test_package)
