/* Scene files: contents, and refused input. */
#include "dem/state/state.h"
#include "tests/folder.h"
#include "tests/grains.h"

static const char *const EXAMPLE =
    "gravity = [0.0, -981.0];  rotation = false;  shape = \"sphere\";\n"
    "integrator = \"verlet\";    dt = 5.0e-5;  steps = 400;\n"
    "normal = { law = \"hertz\"; k_n = 1.0e6; gamma_n = 500.0; tension = true; };\n"
    "tangential = { law = \"spring\"; k_s = 1.0e4; gamma_s = 5.0; mu = 0.2; slip = \"truncated\"; };\n"
    "walls = ( { point = [0.0, 0.0]; direction = [0.0, 1.0]; k_n = 2.0e6; mu = 0.2; } );\n"
    "particles = ( { x = 0.0; y = 0.2385; r = 0.1; m = 1.0; vx = 0.0; vy = -1.0; omega = 0.0; },\n"
    "              { x = 0.05; y = 0.5; r = 0.12; } );\n";

static void example(void)
{
    scoped_scene s = {0}, t = {0};
    CHECK_OK(grains_read(EXAMPLE, NULL, &s));
    CU_ASSERT(s.def.gravity[1] == -981.0 && s.def.dt == 5e-5 && s.steps == 400);
    CU_ASSERT(s.def.normal == DEM_HERTZ && s.def.tangential == DEM_SPRING && s.def.slip == DEM_TRUNCATED &&
              s.def.tension);
    CU_ASSERT(s.def.material.k_n == 1e6 && s.def.material.gamma_s == 5.0 && s.def.material.mu == 0.2);
    CU_ASSERT(s.def.n_walls == 1 && s.def.walls[0].direction[1] == 1.0 && isinf(s.def.walls[0].extent[1]));
    /* defaults of the wall */
    CU_ASSERT(s.def.walls[0].material.gamma_n == 500.0 && s.def.walls[0].material.k_s == 1e4);
    CU_ASSERT(s.def.walls[0].open_at_step == -1);
    /* no rotation; rolling resistance would use stiffness and damping of the shear spring */
    CU_ASSERT(!s.def.rotation && s.def.damping == DEM_DAMPING_INSIDE && s.def.material.mu_roll == 0.0);
    CU_ASSERT(s.def.material.k_roll == 1e4 && s.def.walls[0].material.gamma_roll == 5.0);
    CU_ASSERT(s.def.n_grains == 2 && s.grains[0].m == 1.0 && s.grains[0].vy == -1.0);
    CHECK_NEAR(s.grains[1].m, 4.0 / 3.0 * M_PI * 0.12 * 0.12 * 0.12, 1e-16);
    rp_texts changes = {3, {"tangential.mu=infinite", "steps=7", "shape=disk"}};
    CHECK_OK(grains_read(EXAMPLE, &changes, &t));
    CU_ASSERT(isinf(t.def.material.mu) && t.steps == 7 && t.def.shape == DEM_DISK);
    CHECK_NEAR(t.grains[1].m, M_PI * 0.12 * 0.12, 1e-16);
}

static void refused(void)
{
    static const struct {
        const char *change; /* appended to a file with one grain */
        const char *message;
    } cases[] = {
        {"particles_step = 3;", "particles_step: needs particles_file"},
        {"require = ( (\"1 > 2\", \"never\") );", ":2: never (1 > 2)"},
        {"measure = ( );", ":2: measure: needs phases"},
        {"material = { E = 1e9; nu = 0.3; restitution = 0.5; mu = 0.3; }; normal = { law = \"linear\"; };",
         ":2: normal: law and k_n follow from material"},
        {"material = { E = 1e9; nu = 0.3; restitution = 0.5; mu = 0.3; };\n"
         "walls = ( { point = [0.0, 0.0]; direction = [0.0, 1.0]; E = 1e8; k_n = 1e5; } );",
         ":3: E and k_n or k_s of a wall; keep one"},
        {"contacts_file = \"c.tsv\";", "contacts_file: needs particles_file"},
        {"fill = ( { N = 3; W = 3.0; H = 3.0; seed = 2; }, { N = 3; W = 3.0; H = 3.0; run = 2; } ); phases = "
         "( { name = \"a\"; steps = 1; } );",
         ":2: run: of the first fill"},
        {"colour = 1;", ":2: colour: unknown key"},
        {"partcles = 1;", ":2: partcles: unknown key (did you mean \"particles\"?)"},
        {"tangential = { la = \"spring\"; };",
         ":2: tangential.la: unknown key (did you mean \"law\"?); allowed: law"},
        {"tangential = { law = \"sprnig\"; };", "(did you mean \"spring\"?)"},
        {"walls = ( { pint = 1; } );", ":2: walls.[0].pint: unknown key (did you mean \"point\"?)"},
        {"dt = \"fast\";", ":2: dt = \"fast\": character 1: unknown name fast"},
        {"tangential = { law = \"spring\"; }; rolling = { mu = 0.1; };",
         ":2: mu_roll = 0.1: needs rotation = true"},
        {"rolling = { mu = 0.1; };", ":2: mu_roll = 0.1: needs a tangential law"},
        {"ground = { mu_static = 0.5; };", ":2: ground.a: missing"},
        {"gravity = [0.0, 0.0, 1.0];", ":2: gravity: two numbers"},
        {"gravity = 981.0;", ":2: gravity: two numbers"},
        {"implicit = { relaxation = 0.9; };", ":2: implicit: needs integrator = \"implicit\""},
        {"normal = 3;", ":2: normal: a group { ... } expected"},
        {"tangential = { mu = 0.3; };", ":2: mu = 0.3: needs a tangential law"},
        {"walls = ( { point = [0.0, 0.0]; } );", "direction: missing"},
        {"walls = ( { point = [0.0, 0.0]; direction = [0.0, 0.0]; } );",
         ":2: direction = [0, 0]: must not be 0"},
        {"walls = ( { point = [0.0, 0.0]; direction = [0.0, 1.0]; mu = 0.1; } );",
         ":2: mu = 0.1: needs a tangential law"},
        {"walls = ( { point = [0.0, 0.0]; direction = [0.0, 1.0]; extent = [1.0, 0.0]; } );",
         "extent = [1, 0]"},
        {"walls = { point = 1; };", "walls: a list"},
        {"particles_file = \"t.tsv\";", "particles and particles_file; keep one"},
        {"fill = ( );", ":2: fill: a group { ... }, or a list of one or more, expected"},
        {"fill = 3;", ":2: fill: a group { ... } expected"},
        {"fill = { N = 3; W = 1.0; };", ":2: H: missing (height of the region of a random fill)"},
        {"fill = { N = 3; W = 1.0; H = 1.0; kind = \"a b\"; };", ":2: kind = \"a b\": up to 31 letters"},
        {"fill = { N = 3; W = 1.0; H = 1.0; radius_law = \"table\"; };", ":2: radii: missing, of"},
        {"fill = { N = 3; W = 1.0; H = 1.0; radii = ( ); };", ":2: radii: needs radius_law"},
        {"fill = { N = 3; W = 1.0; H = 1.0; radius_law = \"table\"; radii = ( (0.1, 0.0) ); };",
         ":2: radii: a list ( [r, share], ... ) is needed"},
        {"fill = { N = 3; W = 1.0; H = 1.0; radius_law = \"table\"; radii = ( (-0.1, 1.0) ); };",
         ":2: radii: [-0.1, 1]: a radius above 0 and a share expected"}};
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        const char *text =
            check_text("particles = ( { x = 0.0; y = 0.5; r = 0.1; } );\n%s\n", cases[k].change);
        grains_refused(text, NULL, cases[k].message);
    }
    static const char *const whole[][2] = {
        {"steps = 3;", "no grains: particles, particles_file or fill is needed"},
        {"particles = ( );", ":1: particles: no particles"},
        {"particles = ( { x = 0.0; y = 0.5; r = -0.1; } );",
         ":1: particles.[0].r = -0.1: out of range, allowed: (0, inf) cm"},
        {"particles = ( { x = 0.0; y = 0.5; } );", "r: missing"},
        {"particles_file = \"/no/such/table.tsv\";", "/no/such/table.tsv: cannot read"},
        {"fill = { N = 4; W = 1.0; H = 1.0; radius_mean = 0.2; };", "radius_mean = 0.2: must lie between"},
        {"fill = { W = 1.0; H = 1.0; };", "N: missing (number of grains)"}};
    for (size_t k = 0; k < sizeof whole / sizeof *whole; k++) grains_refused(whole[k][0], NULL, whole[k][1]);
    static const char *const sets[][2] = {{"steps", "key=value expected"},
                                          {"nothing.mu=0.1", "no such group"},
                                          {"particle.mu=0.1", "no such group (did you mean \"particles\"?)"},
                                          {"mu=0.1", "--set mu=0.1: of a scene the key is tangential.mu"},
                                          {"dt=[1.0,2.0]", "dt: one value expected, not a list"},
                                          {"=3", "--set =3: key=value expected"},
                                          {"walls[9].mu=0.1", "walls[0] to walls["},
                                          {"walls[-1].mu=0.1", "walls"},
                                          {"walls.mu=0.1", "is a list of"},
                                          {"normal[0].k_n=1", "normal is no list with entries"},
                                          {"walls[0]=3", "give a key of the entry, or the whole list"}};
    for (size_t k = 0; k < sizeof sets / sizeof *sets; k++)
        grains_refused(EXAMPLE, &(rp_texts){1, {sets[k][0]}}, sets[k][1]);
    dem_scene s;
    CHECK_FAILS(dem_scene_read("/no/such/scene.cfg", NULL, &s), RP_BAD_INPUT, "cannot read");
}

static bool same_grain(const dem_grain *p, const dem_grain *q)
{
    return p->x == q->x && p->y == q->y && p->r == q->r && p->m == q->m && p->vx == q->vx && p->vy == q->vy &&
           p->angle == q->angle && p->omega == q->omega && p->fixed == q->fixed;
}

static bool same_wall(const dem_wall *w, const dem_wall *v)
{
    bool same = w->open_at_step == v->open_at_step && w->open_speed == v->open_speed &&
                w->omega == v->omega && memcmp(&w->material, &v->material, sizeof w->material) == 0;
    for (int c = 0; c < 2; c++)
        same &= w->point[c] == v->point[c] && w->direction[c] == v->direction[c] &&
                w->extent[c] == v->extent[c] && w->velocity[c] == v->velocity[c] &&
                w->pivot[c] == v->pivot[c];
    return same;
}

/* particles_file: named columns in any order; masses from the density where
 * there is no column m; of several steps the last. */
static void particles_from_table(void)
{
    static const char *const texts[] = {
        "# omega fixed r vy m y vx angle x\n3 1 0.1 -2 0.005 0.7 4 0.3 0.5\n-1 0 1.5 6 0.2 8 -7 9 2\n5 1 3 4 "
        "5 6 7 8 9\n",
        "x y r m vx vy angle omega fixed\n0.5 0.7 0.1 0.005 4 -2 0.3 3 1\n2 8 1.5 0.2 -7 6 9 -1 0\n9 6 3 5 7 "
        "4 8 5 1\n",
        "# r omega x y vy fixed\n0.1 3.0 0.5 0.7 -2.0 0\n0.08 0.0 0.1 0.9 0.0 1\n",
        "# step r omega x y vy fixed\n0 0.1 3 9 9 -2 0\n0 0.1 0 9 8 0 1\n0 0.2 0 9 7 0 0\n"
        "40 0.1 3 0.5 0.7 -2 0\n40 0.08 0 0.1 0.9 0 1\n",
        "\"\",\"x\",\"y\",\"r\",\"omega\",\"vy\",\"fixed\",mass\n"
        "\"0\",0.5,0.7,0.1,3,-2,False,5\n\"1\",0.1,0.9,0.08,0,0,true,6\n"};
    static const dem_grain typed[3] = {{0.5, 0.7, 0.1, 0.005, 4.0, -2.0, 0.3, 3.0, true},
                                       {2.0, 8.0, 1.5, 0.2, -7.0, 6.0, 9.0, -1.0, false},
                                       {9.0, 6.0, 3.0, 5.0, 7.0, 4.0, 8.0, 5.0, true}};
    char folder[FOLDER_PATH], text[128];
    folder_make("grains", folder);
    const char *table = folder_path(folder, "table");
    snprintf(text, sizeof text, "density = 2.0; particles_file = \"%s\";", table);
    for (int k = 0; k < 5; k++) {
        scoped_scene s = {0};
        file_print(table, "%s", texts[k]);
        CHECK_OK(grains_read(text, NULL, &s));
        CU_ASSERT_STRING_EQUAL(s.unused, k == 4 ? " mass" : "");
        CU_ASSERT_EQUAL_FATAL(s.def.n_grains, k < 2 ? 3 : 2);
        for (int i = 0; i < 3 && k < 2; i++) CU_ASSERT(same_grain(&s.grains[i], &typed[i]));
        const double volume = 4.0 / 3.0 * M_PI * 0.1 * 0.1 * 0.1;
        if (k >= 2) {
            CU_ASSERT(same_grain(&s.grains[0],
                                 &(dem_grain){0.5, 0.7, 0.1, s.grains[0].m, 0.0, -2.0, 0.0, 3.0, false}));
            CU_ASSERT(s.grains[1].x == 0.1 && s.grains[1].r == 0.08 && s.grains[1].fixed);
            CHECK_PAIRS(1e-16, {s.grains[0].m, 2.0 * volume}, {s.grains[1].m, 2.0 * 0.512 * volume});
        }
    }
    scoped_scene first = {0};
    file_print(table, "%s", texts[3]);
    CHECK_OK(grains_read(text, &(rp_texts){2, {"particles_step=0", "gravity=[0.0,-981]"}}, &first));
    CU_ASSERT(first.def.n_grains == 3 && first.grains[0].x == 9.0 && first.grains[2].r == 0.2);
    grains_refused(text, &(rp_texts){1, {"particles_step=7"}}, ": no rows with step=7");
    /* states say which grains are fixed */
    scoped_scene again = {0};
    scoped_sim *sim = NULL;
    first.def.rotation = true;
    CHECK_OK(dem_scene_start(&first, &sim));
    FILE *out = fopen(table, "w");
    dem_write_columns(DEM_TABLE_STATES, sim, out);
    CHECK_OK(dem_write_rows(DEM_TABLE_STATES, sim, dem_step(sim), out));
    fclose(out);
    CHECK_OK(grains_read(text, NULL, &again));
    CU_ASSERT(again.def.n_grains == 3 && again.grains[1].fixed && !again.grains[0].fixed && !*again.unused);
    file_print(table, "# units: m\tm\tm\nx\ty\tr\n1\t2\t0.1\n");
    grains_refused(text, NULL, "column 1: unit = m: the file's units are cgs; cm");
    file_print(table, "x\ty\tr\tstep\n1\t2\t0.1\tnan\n1\t3\t0.1\t0\n");
    grains_refused(text, NULL, ":2: column 4 step: \"nan\" is not a finite number");
    file_print(table, "x\ty\tr\tfixed\n1\t2\t0.1\t2\n");
    grains_refused(text, NULL, ":2: fixed = 2: 0, 1, true or false expected");
    static const char *const bad[] = {"-0.1", "0"};
    for (int k = 0; k < 2; k++) {
        file_print(table, "# x y r\n0.5 0.7 %s\n", bad[k]);
        grains_refused(text, NULL, check_text(":2: r = %s: out of range", bad[k]));
    }
    folder_remove(folder);
}

/* ---- particles_file of LAMMPS ---- */

#define DUMP(STEP, N, COLUMNS)                                                                               \
    "ITEM: TIMESTEP\n" STEP "\nITEM: NUMBER OF ATOMS\n" N "\nITEM: BOX BOUNDS pp ff pp\n-1 3\n0.5 "          \
    "2.5\n-0.5 0.5\nITEM: ATOMS " COLUMNS "\n"
#define DATA(STYLE, ROWS)                                                                                    \
    "made by hand\n\n 3 atoms\n2 atom types\n-1 3 xlo xhi\n\nMasses\n\n1 1\n2 1\n\nAtoms" STYLE "\n\n" ROWS

/* The same three grains: rows in any order, ids with gaps, boxes, diameters, densities, several frames. */
static void particles_from_lammps(void)
{
    static const char *const texts[] = {
        "x\ty\tr\tvx\tvy\tomega\n0.5\t0.75\t0.125\t4\t-2\t3\n2\t1.5\t0.25\t0\t0\t0\n1\t1\t0.0625\t1\t7\t-1\n",
        DUMP("0", "3",
             "id type x y z radius vx vy vz omegax omegay omegaz") "8 2 2 1.5 0 0.25 0 0 0 0 0 0 \n40 1 1 1 "
                                                                   "0 0.0625 1 7 9 9 9 -1 \n3 1 0.5 0.75 0 "
                                                                   "0.125 4 -2 0 9 9 3 \n",
        DUMP("0", "1", "id x y radius") "1 9 9 0.1\nITEM: UNITS\nlj\nITEM: TIME\n0.25\n" DUMP(
            "20", "3",
            "diameter ysu radius xs density omegaz vx vy zs id") "9 0.125 0.125 0.375 2 3 4 -2 0.5 3\n9 0.25 "
                                                                 "0.0625 0.5 2 -1 1 7 0.5 40\n9 0.5 0.25 "
                                                                 "0.75 2 0 0 0 0.5 8\n",
        DUMP("20", "3", "id xu xs yu ys diameter vx vy omegaz z") /* a plane anywhere */
        "3 0.5 9 0.75 9 0.25 4 -2 3 7\r\n8 2 9 1.5 9 0.5 0 0 0 7.0001\r\n40 1 9 1 9 0.125 1 7 -1 7\r\n",
        DATA(" # sphere",
             "40 1 0.125 2 1 1 0 0 0 1\n8 1 0.5 2 2 1.5 0 -1 0 0\n3 2 0.25 2 0.5 0.75 0 0 0 0\n\n"
             "Velocities\n\n3 4 -2 0 0 0 3\n40 1 7 9 9 9 -1\n"),
        DATA("", "8 1 0.5 2 2 1.5 0\n3 2 0.25 2 0.5 0.75 0\n40 1 0.125 2 1 1 0\n\nVelocities # sphere\n\n"
                 "8 0 0 0 0 0 0\n40 1 7 0 0 0 -1\n3 4 -2 0 0 0 3\n\nBonds\n\n1 1 3 8\n")};
    static const char *const bad[][2] = {
        {"ITEM: TIMESTEP\n0\n", ": no line ITEM: ATOMS"},
        {"ITEM: TIMESTEP\nnone\n", ":2: a number expected"},
        {"ITEM: TIMESTEP\n", ":2: a number expected"},
        {"ITEM: BOX BOUNDS ff ff pp\n0 1\n0 \n0 1\n", ":3: two ends of the box expected"},
        {DUMP("0", "2", "id x y radius") "1 0 0 0.1\n", ":9: 1 rows below, for 2 atoms"},
        {DUMP("0", "2", "id x y radius") "1 0 0 0.1\n2 0 ", ":11: 2 cells where 4 are expected"},
        {DUMP("0", "2", "id x y radius"), ":9: no rows below"},
        {DUMP("0", "2", "id x y radius") "1 0 0 0.1\n1 1 1 0.1\n", ":11: a second row has the id 1"},
        {DUMP("0", "1", "id x y radius") "1 0 0 -0.1\n", ":10: r = -0.1: out of range"},
        {DUMP("0", "1", "id x y radius") "1 0 inf 0.1\n", ":10: column 3 y: \"inf\" is not a finite number"},
        {DUMP("0", "1", "id x y") "1 0 0\n", ": no column \"radius\"; expected header: id type x y z radius"},
        {DUMP("0", "1", "id x xs radius") "1 0 0 0.1\n", ": no column \"y\""},
        {DUMP("0", "1", "x y radius") "0 0 0.1\n", ": no column \"id\""},
        {DUMP("0", "2", "id x y z radius") "2 1 0 1 0.1\n1 0 0 0 0.1\n",
         ":10: z = 1, of the first grain 0: grains in one plane expected"},
        {"ITEM: NUMBER OF ATOMS\n1\nITEM: BOX BOUNDS xy xz yz pp pp pp\n0 1 0\n0 1 0\n0 1 0\nITEM: ATOMS id "
         "xs y "
         "radius\n1 0 0 0.1\n",
         ":7: xs of a tilted box"},
        {DATA(" # atomic", "1 1 0 0 0\n"), ":12: \"Atoms # sphere\" expected"},
        {DATA(" # sphere", "1 1 0.1 1 0 0 0 0\n"), ":14: 8 cells where 10 are expected"},
        {DATA(" # sphere", "1 1 0.1 1 0 0 0\n2 1 0.1 1 0 1 0\n"), ":12: 2 rows below, for 3 atoms"},
        {DATA(" # sphere", "1 1 0.1 1 0 0 0\n2 1 0.1 1 0 1 0\n3 1 0.0 1 1 1 0\n"),
         ":16: r = 0: out of range"},
        {DATA(" # sphere", "1 1 1 1 0 0 0\n2 1 1 1 0 2 0\n4 1 1 1 2 2 0\n\nVelocities\n\n3 0 0 0 0 0 0\n"),
         ":20: no atom has the id 3"}};
    char folder[FOLDER_PATH], text[128];
    folder_make("lammps", folder);
    const char *file = folder_path(folder, "file");
    snprintf(text, sizeof text, "density = 2.0; particles_file = \"%s\";", file);
    scoped_scene table = {0};
    for (size_t k = 0; k < sizeof texts / sizeof *texts; k++) {
        scoped_scene s = {0};
        file_print(file, "%s", texts[k]);
        CHECK_OK(grains_read(text, NULL, k == 0 ? &table : &s));
        if (k == 0) continue;
        CU_ASSERT_EQUAL_FATAL(s.def.n_grains, 3);
        for (int i = 0; i < 3; i++) CU_ASSERT(same_grain(&s.grains[i], &table.grains[i]));
        CU_ASSERT(!*s.unused);
    }
    CU_ASSERT_EQUAL(table.def.n_grains, 3);
    grains_refused(text, &(rp_texts){1, {"particles_step=5"}}, ": particles_step: a data file has no steps");
    grains_refused(text, &(rp_texts){1, {"contacts_file=c.tsv"}}, ": contacts_file: needs a table");
    scoped_scene first = {0};
    file_print(file, "%s", texts[2]);
    CHECK_OK(grains_read(text, &(rp_texts){1, {"particles_step=0"}}, &first));
    CU_ASSERT(first.def.n_grains == 1 && first.grains[0].x == 9.0);
    grains_refused(text, &(rp_texts){1, {"particles_step=5"}}, ": no frame of step 5");
    for (size_t k = 0; k < sizeof bad / sizeof *bad; k++) {
        file_print(file, "%s", bad[k][0]);
        grains_refused(text, NULL, bad[k][1]);
    }
    folder_remove(folder);
}

/* Rolling resistance without a limit is that of a limit which no torque reaches. */
static void infinite_rolling(void)
{
    static const char *const limits[] = {"rolling.mu=infinite", "rolling.mu=1e5", "rolling.mu=0.01"};
    double spin[3];
    for (int k = 0; k < 3; k++) {
        scoped_scene s = {0};
        scoped_sim *sim = NULL;
        dem_state p[2];
        CHECK_OK(grains_read("rotation = true; tangential = { law = \"spring\"; mu = 0.5; }; rolling = { };\n"
                             "walls = ( { point = [0.0, 0.0]; direction = [0.1, 1.0]; } );\n"
                             "particles = ( { x = 0.0; y = 0.1; r = 0.1; vx = 5.0; },\n"
                             "              { x = 0.15; y = 0.25; r = 0.1; } );\n",
                             &(rp_texts){1, {limits[k]}}, &s));
        CHECK_OK(dem_scene_start(&s, &sim));
        grains_run(sim, 500, p);
        spin[k] = p[0].omega;
    }
    CU_ASSERT(spin[0] == spin[1] && fabs(spin[0] - spin[2]) > 1e-3 && isfinite(spin[2]));
}

/* A filling beside, across, around and within walls: no grain touches one, none lies behind a line, and all
 * lie in the part of the region that is larger. */
static void fill_among_walls(void)
{
    static const struct {
        const char *walls, *fill;
        double from_x, to_x, from_y, to_y; /* where all grains are */
        bool cut;
    } cases[] = {{"{ circle = [0.0, 0.0, 1.0]; }", "N = 40; W = 2.0; H = 2.0; x0 = -1.0; y0 = -1.0", -1, 1,
                  -1, 1, true},
                 {"{ circle = [0.0, 0.0, 0.5]; }", "N = 25; W = 2.0; H = 2.0; x0 = -1.0; y0 = -1.0", -1, 1,
                  -1, 1, true},
                 {"{ polygon = ( [0.5, 0.5], [0.5, 1.5], [1.5, 1.5], [1.5, 0.5] ); }",
                  "N = 90; W = 4.0; H = 2.0", 0, 4, 0, 2, true},
                 {"{ polygon = ( [0.5, 0.5], [1.5, 0.5], [1.5, 1.5], [0.5, 1.5] ); }",
                  "N = 90; W = 4.0; H = 2.0", 0, 4, 0, 2, true},
                 {"{ polygon = ( [-3.0, 6.0], [-0.6, 0.0] ); closed = false; }, { polygon = ( [0.6, 0.0], "
                  "[3.0, 6.0] ); closed = false; }",
                  "N = 200; W = 6.0; H = 8.0; x0 = -3.0; y0 = 0.5", -3, 3, 0.5, 8.5, true},
                 {"{ polygon = ( [0.0, 9.0], [0.0, 0.0], [2.0, 0.0], [2.0, 9.0] ); closed = false; }",
                  "N = 80; W = 3.0; H = 3.0", 0, 2, 0, 3, true},
                 {"{ point = [0.0, 0.0]; direction = [0.0, 1.0]; }", "N = 20; W = 2.0; H = 2.0; y0 = -1.0", 0,
                  2, 0, 1, false},
                 {"{ point = [0.0, 0.0]; direction = [0.0, 1.0]; extent = [-1.0, 1.0]; open_at_step = 0; }",
                  "N = 20; W = 2.0; H = 2.0; y0 = -1.0", 0, 2, -1, 1, false},
                 {"{ point = [1.0, 1.0]; direction = [0.6, 0.8]; extent = [-0.3, 0.3]; }",
                  "N = 30; W = 2.0; H = 2.0", 0, 2, 0, 2, false}};
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        scoped_scene s = {0};
        scoped_sim *sim = NULL;
        dem_state p[200];
        dem_energy e;
        bool cut = false;
        CHECK_OK(
            grains_read_as(&s, "dt = 2e-5; walls = ( %s ); fill = { %s; };", cases[k].walls, cases[k].fill));
        s.cut = &cut;
        CHECK_OK(dem_scene_start(&s, &sim));
        CU_ASSERT_PTR_NOT_NULL_FATAL(sim);
        CHECK_OK(dem_states(sim, p));
        dem_energies(sim, &e);
        CU_ASSERT(e.elastic == 0.0 && cut == cases[k].cut);
        for (size_t i = 0; i < dem_count(sim); i++) {
            const double x = p[i].x, y = p[i].y, r = p[i].r;
            CU_ASSERT(x - r > cases[k].from_x && x + r < cases[k].to_x && y - r > cases[k].from_y &&
                      y + r < cases[k].to_y && p[i].contacts == 0);
            if (k == 0) CU_ASSERT(hypot(x, y) + r < 1.0);
            if (k == 1) CU_ASSERT(hypot(x, y) > 0.5);
            if (k == 2 || k == 3) CU_ASSERT(fmax(fabs(x - 1.0), fabs(y - 1.0)) > 0.5);
            if (k == 4) CU_ASSERT(y > (fabs(x) - 0.6) * 2.5);
        }
    }
    scoped_scene s = {0};
    scoped_sim *sim = NULL;
    CHECK_OK(grains_read("walls = ( { circle = [0.0, 0.0, 0.3]; } ); fill = { N = 90; W = 0.6; H = 0.6; x0 = "
                         "-0.3; y0 = -0.3; };",
                         NULL, &s));
    CHECK_FAILS(dem_scene_start(&s, &sim), RP_NO_RESULT, "H = 0.6 on the inner side of the walls: ");
}

/* Listed grains overlap by a tenth of the smaller radius at most, or as far as they may be loaded. */
static void listed_overlaps(void)
{
    static const char *const text = "dt = 2e-5; steps = 3; walls = ( { point = [0.0, 0.0]; direction = [0.0, "
                                    "1.0]; }, { polygon = ( [5.0, 0.0], [6.0, 0.0] ); closed = false; } );\n"
                                    "particles = ( { x = 0.0; y = 0.1; r = 0.1; },\n{ x = 1.0; y = 0.2; r = "
                                    "0.2; },\n{ x = 1.0; y = 0.491; r = 0.1; } );\n";
    static const struct {
        rp_texts changes;
        const char *message;
    } cases[] = {
        {{0, {NULL}}, NULL},
        {{1, {"particles[2].y=0.489"}}, "particle 2, of line 3, overlaps particle 3, of line 4, by 0.011"},
        {{1, {"particles[2].y=0.25"}}, "particle 2, of line 3, overlaps particle 3, of line 4, by 0.25"},
        {{2, {"particles[2].y=0.489", "normal.k_n=100"}}, NULL},
        {{2, {"particles[2].y=0.489", "normal.k_n=1.0e5"}},
         NULL}, /* the weight of all three, to a hundredth */
        {{2, {"particles[2].y=0.489", "normal.k_n=1.015e5"}}, "by 0.011"},
        {{3, {"particles[2].y=0.489", "normal.k_n=100", "gravity=[0.0, -0.5]"}}, "by 0.011"},
        {{3, {"particles[2].y=0.489", "normal.k_n=100", "gravity=[981.0, 0.0]"}}, NULL},
        {{3, {"particles[2].y=0.25", "particles[1].fixed=true", "particles[2].fixed=true"}}, NULL},
        {{1, {"particles[0].y=0.091"}}, NULL},
        {{1, {"particles[0].y=0.089"}}, "particle 1, of line 2, overlaps wall 1 by 0.011"},
        {{1, {"particles[0].y=-0.5"}}, "grain 1: behind wall 1"},
        {{2, {"particles[0].x=5.5", "walls[0].point=[0.0, -9.0]"}}, NULL},
        {{3, {"particles[0].x=5.5", "particles[0].y=-0.08", "walls[0].point=[0.0, -9.0]"}},
         "overlaps wall 2 by 0.02"}};
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        scoped_scene s = {0};
        scoped_sim *sim = NULL;
        CHECK_OK(grains_read(text, &cases[k].changes, &s));
        CHECK_FAILS_IF(cases[k].message, dem_scene_start(&s, &sim), RP_BAD_INPUT, cases[k].message);
    }
}

/* A bed at rest that is taken back with its contacts goes on as if nothing had happened, although grains have
 * left and a wall is no more; without them it moves. */
static void bed_taken_back(void)
{
    static const char stage[] = "dt = 5e-5; rotation = true; tangential = { law = \"spring\"; mu = 0.4; "
                                "}; rolling = { mu = 0.05; }; x_max = 3.0;\n"
                                "walls = ( { point = [0.0, %s]; direction = [0.0, 1.0]; }, { point = "
                                "[0.0, 0.0]; direction = [1.0, 0.0]; }%s );\n%s";
    char folder[FOLDER_PATH], text[1024], table[256];
    folder_make("bed", folder);
    const char *states = folder_path(folder, "states"), *contacts = folder_path(folder, "contacts");
    scoped_sim *sim = grains_after_text(
        0, stage, "0.0", ", { point = [2.0, 0.0]; direction = [-1.0, 0.0]; open_at_step = 5000; }",
        "fill = { N = 80; W = 2.0; H = 3.0; };");
    FILE *out[2] = {fopen(states, "w"), fopen(contacts, "w")};
    dem_write_columns(DEM_TABLE_STATES, sim, out[0]);
    dem_write_columns(DEM_TABLE_CONTACTS, sim, out[1]);
    for (int part = 0; part < 2; part++) {
        CHECK_OK(dem_run(sim, part ? 10 : 60000));
        CHECK_OK(dem_write_rows(DEM_TABLE_STATES, sim, dem_step(sim), out[0]));
        CHECK_OK(dem_write_rows(DEM_TABLE_CONTACTS, sim, dem_step(sim), out[1]));
    }
    fclose(out[0]), fclose(out[1]);
    const size_t n = dem_count(sim);
    dem_state on[80], back[80];
    CU_ASSERT_FATAL(n > 20 && n < 80);
    grains_run(sim, 5000, on);
    for (int with = 0; with < 2; with++) {
        double most = 0.0;
        snprintf(table, sizeof table, "particles_file = \"%s\"; contacts_file = \"%s\";", states,
                 with ? contacts : "");
        snprintf(text, sizeof text, stage, "0.0", "", table);
        scoped_sim *taken = grains_after_text(5000, "%s", text);
        CHECK_OK(dem_states(taken, back));
        for (size_t i = 0; i < n; i++)
            most = fmax(most, fmax(hypot(on[i].x - back[i].x, on[i].y - back[i].y) / on[i].r,
                                   fabs(on[i].angle - back[i].angle)));
        CU_ASSERT(with ? most < 1e-8 : most > 1e-4); /* of a radius; rounding grows in 5000 steps */
    }
    scoped_scene bad = {0}, other = {0}, well = {0};
    CHECK_FAILS(
        grains_read(text,
                    &(rp_texts){3, {"tangential.law=slip_roll", "ground.mu_static=0.3", "ground.a=0.01"}},
                    &well),
        RP_BAD_INPUT, "contacts_file: its table does not have the wells");
    CHECK_FAILS(grains_read(text, &(rp_texts){1, {"particles_step=1"}}, &bad), RP_BAD_INPUT,
                "no rows with step=1");
    CHECK_FAILS(grains_read_as(&other, stage, "-0.001", "", table), RP_BAD_INPUT,
                ": no contact of these grains and walls");
    file_print(contacts, "step\tid_a\tid_b\twall\tx_b\ty_b\toverlap\tshear_spring\trolling_spring\n"
                         "60010\t1\t999\t0\t0\t0\t0\t0\t0\n");
    grains_refused(text, NULL, ":2: id_a = 1, id_b = 999, wall = 0: no such grain or wall");
    folder_remove(folder);
}

/* Values of a file, typed again. */
static void values_of_a_file(void)
{
    static const char *const text =
        "gravity = [3.0, -5.0]; skin = 0.25; x_min = -9.5; x_max = 7.0; y_min = -2.5; "
        "gravity_turn_deg_per_step = 0.5;\n"
        "walls = ( { point = [-4.0, 1.0]; direction = [0.3, 0.4]; extent = [-2.0, 3.0]; corner_lower = 0.2;\n"
        "            corner_upper = -0.3; velocity = [1.5, -2.5]; omega = 0.75; pivot = [4.0, 6.0]; },\n"
        "          { point = [-8.0, 9.0]; direction = [-0.6, 0.8000000005]; extent = [-0.5, 0.75];\n"
        "            open_at_step = 17; open_speed = 6.0; } );\n"
        "particles = ( { x = 0.25; y = 0.5; r = 1.5; m = 0.5; vx = 2.0; vy = -3.0; },\n"
        "              { x = 4.0; y = 5.5; r = 0.125; fixed = true; },\n"
        "              { x = 1.0; y = 9.0; r = 0.25; m = 3.0; } );\n";
    static const dem_grain typed[3] = {{0.25, 0.5, 1.5, 0.5, 2.0, -3.0},
                                       {4.0, 5.5, 0.125, 0.0, .fixed = true},
                                       {1.0, 9.0, 0.25, 3.0, 0.0, 0.0}};
    scoped_scene s = {0};
    CHECK_OK(grains_read(text, NULL, &s));
    const dem_definition *def = &s.def;
    CU_ASSERT(def->gravity[0] == 3.0 && def->gravity[1] == -5.0 && def->skin == 0.25 && def->x_min == -9.5 &&
              def->x_max == 7.0);
    CHECK_NEAR(def->turn_per_step, M_PI / 360.0, 1e-17);
    CU_ASSERT(def->y_min == -2.5 && def->n_walls == 2 && def->n_grains == 3 && def->wall_list == NULL);
    dem_wall a = def->walls[0], b = def->walls[1];
    CHECK_NEAR(a.direction[0], 0.6, 1e-16);
    CHECK_NEAR(a.direction[1], 0.8, 2e-16);
    a.direction[0] = 0.6, a.direction[1] = 0.8;
    dem_wall first = {{-4.0, 1.0}, {0.6, 0.8}, a.material, {-2.0, 3.0}, -1, INFINITY, {1.5, -2.5}, 0.75},
             second = {{-8.0, 9.0}, {-0.6, 0.8000000005}, b.material, {-0.5, 0.75}, 17, 6.0};
    first.pivot[0] = 4.0, first.pivot[1] = 6.0;
    CU_ASSERT(same_wall(&a, &first) && same_wall(&b, &second));
    for (int i = 0; i < 3; i++) {
        dem_grain p = typed[i];
        if (i == 1) p.m = s.grains[1].m;
        CU_ASSERT(same_grain(&s.grains[i], &p));
    }
}

/* A row of energies with two grains, one and none: the mean is over those that are there. */
static void energy_of_few(void)
{
    const dem_grain grains[2] = {{.x = 0.5, .r = 0.1, .m = 3.0, .vx = 100.0},
                                 {.x = 0.0, .r = 0.1, .m = 5.0, .vx = 100.0}};
    dem_definition def = grains_afloat(2, grains);
    def.x_max = 1.0;
    scoped_sim *sim = grains_start(&def);
    for (int left = 0; left < 3; left++) {
        double v[8] = {0.0};
        CHECK_WRITTEN(text, out, CHECK_OK(dem_write_rows(DEM_TABLE_ENERGY, sim, dem_step(sim), out)));
        char *at = text;
        for (int c = 0; c < 8; c++) v[c] = strtod(at, &at);
        const double kinetic[] = {4e4, 2.5e4, 0.0};
        CU_ASSERT(v[0] == 110.0 * left && v[2] == 2.0 - left && v[4] == 0.0 && v[5] == 0.0 && v[7] == 0.0);
        CHECK_PAIRS(1e-8, {v[3], kinetic[left]}, {v[6], left < 2 ? kinetic[left] / (2.0 - left) : 0.0});
        CHECK_OK(dem_run(sim, 110));
    }
}

CHECK_SUITE(scene, "scene", example, particles_from_table, particles_from_lammps, infinite_rolling,
            bed_taken_back, fill_among_walls, listed_overlaps, values_of_a_file, energy_of_few, refused)
