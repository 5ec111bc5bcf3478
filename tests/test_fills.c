/* Fills: laws of radii, patterns, several fills in one scene. */
#include <gsl/gsl_sort.h>
#include <stddef.h>

#include "grains.h"

/* ---- laws of radii ---- */

static double density_of(const dem_fill *f, double r)
{
    const double z = (r - f->radius_mean) / f->radius_width, part = f->radius_width / f->radius_mean,
                 s2 = log(1.0 + part * part), l = log(r / f->radius_mean) + 0.5 * s2;
    return f->law == DEM_RADII_GAUSS     ? exp(-0.5 * z * z)
           : f->law == DEM_RADII_UNIFORM ? (fabs(z) <= sqrt(3.0))
                                         : exp(-0.5 * l * l / s2) / r;
}

/* Largest distance between the radii's distribution and the law's, times the root of their number; the law's
 * shares are divided by the power of r that a grain has of them. */
static double kolmogorov(const dem_fill *f, size_t n, const dem_grain *grains, double power)
{
    enum { POINTS = 20000 };
    double *r = malloc(n * sizeof *r), *sum = malloc((POINTS + 1) * sizeof *sum), most = 0.0;
    for (size_t i = 0; i < n; i++) r[i] = grains[i].r;
    gsl_sort(r, 1, n);
    sum[0] = 0.0;
    const double h = (f->radius_max - f->radius_min) / POINTS;
    for (int k = 0; k < POINTS; k++) {
        const double at = f->radius_min + (k + 0.5) * h;
        sum[k + 1] = sum[k] + density_of(f, at) / pow(at, power);
    }
    for (size_t i = 0; i < n; i++) {
        const double at = sum[(int)fmin((r[i] - f->radius_min) / h + 0.5, POINTS)] / sum[POINTS];
        most = fmax(most, fmax(fabs(at - (double)i / (double)n), fabs(at - (double)(i + 1) / (double)n)));
    }
    free(r), free(sum);
    return most * sqrt((double)n);
}

static const dem_fill wide = {3000, 60.0, 60.0, 0.1, 0.02, 0.05, 0.17, 1.0, DEM_SPHERE, 3, 0};

static void test_laws(void)
{
    scoped dem_grain *grains = malloc((size_t)wide.N * sizeof *grains);
    const struct {
        dem_share by;
        dem_shape shape;
        double power;
    } shares[] = {{DEM_BY_NUMBER, DEM_SPHERE, 0.0},
                  {DEM_BY_AREA, DEM_SPHERE, 2.0},
                  {DEM_BY_MASS, DEM_SPHERE, 3.0},
                  {DEM_BY_MASS, DEM_DISK, 2.0}};
    for (int law = DEM_RADII_GAUSS; law < DEM_RADII_TABLE; law++)
        for (size_t k = 0; k < sizeof shares / sizeof *shares; k++) {
            dem_fill f = wide;
            size_t n;
            f.law = (dem_radius_law)law, f.by = shares[k].by, f.shape = shares[k].shape;
            CHECK_OK(dem_fill_grains(&f, grains, &n));
            const double right = kolmogorov(&f, n, grains, shares[k].power),
                         wrong = kolmogorov(&f, n, grains, shares[k].power + 2.0);
            CU_ASSERT(n == (size_t)wide.N && right < 1.95); /* p > 0.001 */
            CU_ASSERT(wrong > 3.0);                         /* it would be seen */
        }
}

/* Of each radius as many as its share of number, area or mass says. */
static void test_table(void)
{
    static const double radii[] = {0.1, 2.0, 0.2, 1.0, 0.15, 0.0, 0.3, 1.0};
    scoped dem_grain *grains = malloc((size_t)wide.N * sizeof *grains);
    for (int by = DEM_BY_NUMBER; by <= DEM_BY_MASS; by++) {
        dem_fill f = wide;
        size_t n, count[4] = {0};
        double sum = 0.0, chi2 = 0.0;
        f.law = DEM_RADII_TABLE, f.radii = radii, f.n_radii = 4, f.by = (dem_share)by, f.W = f.H = 80.0;
        CHECK_OK(dem_fill_grains(&f, grains, &n));
        for (size_t i = 0; i < n; i++)
            for (int k = 0; k < 4; k++) count[k] += grains[i].r == radii[2 * k];
        CU_ASSERT(count[0] + count[1] + count[3] == n && count[2] == 0);
        const double power = by == DEM_BY_NUMBER ? 0.0 : by == DEM_BY_AREA ? 2.0 : 3.0;
        for (int k = 0; k < 4; k++) sum += radii[2 * k + 1] / pow(radii[2 * k], power);
        for (int k = 0; k < 4; k++) {
            const double expected = (double)n * radii[2 * k + 1] / pow(radii[2 * k], power) / sum;
            if (expected > 0.0)
                chi2 += ((double)count[k] - expected) * ((double)count[k] - expected) / expected;
        }
        CU_ASSERT(chi2 < 13.8); /* two degrees of freedom, p > 0.001 */
    }
}

/* ---- patterns ---- */

static void test_patterns(void)
{
    dem_fill f = wide;
    size_t n;
    f.N = -1, f.W = 3.0, f.H = 2.0, f.x0 = 1.0, f.y0 = -0.5;
    f.pattern = DEM_PATTERN_ROW;
    scoped dem_grain *row = malloc(dem_fill_most(&f) * sizeof *row);
    CHECK_OK(dem_fill_grains(&f, row, &n));
    CU_ASSERT(n >= 10 && n <= 25);
    for (size_t i = 0; i < n; i++) {
        const dem_grain *g = &row[i];
        CHECK_NEAR(g->y - g->r, -0.5, 1e-15);
        if (i > 0) CHECK_NEAR(hypot(g->x - g[-1].x, g->y - g[-1].y), g->r + g[-1].r, 1e-14);
        CU_ASSERT(g->x - g->r >= 1.0 - 1e-15 && g->x + g->r <= 4.0 + 1e-9);
    }
    f.pattern = DEM_PATTERN_LATTICE, f.radius_width = 0.0;
    scoped dem_grain *grains = malloc(dem_fill_most(&f) * sizeof *grains);
    CHECK_OK(dem_fill_grains(&f, grains, &n));
    CU_ASSERT(n == 15 * 6 + 14 * 5); /* rows of 15 and 14 at 0.173 from one another */
    for (size_t i = 1; i < n; i++) CU_ASSERT(grains[i].y + 0.1 <= 1.5 && grains[i].x + 0.1 <= 4.0 + 1e-9);
    f.N = 200;
    CHECK_FAILS(dem_fill_grains(&f, grains, &n), RP_NO_RESULT, "have room");
    double *const numbers[] = {&f.W, &f.H, &f.x0, &f.spacing, &f.density, &f.radius_mean, &f.radius_width};
    for (size_t k = 0; k < sizeof numbers / sizeof *numbers; k++) {
        const double before = *numbers[k];
        *numbers[k] = k < 2 ? -1.0 : NAN;
        CHECK_FAILS(dem_fill_grains(&f, grains, &n), RP_BAD_INPUT, "must be finite");
        *numbers[k] = before;
    }
    f.pattern = DEM_PATTERN_RANDOM, f.N = -1;
    CHECK_FAILS(dem_fill_grains(&f, grains, &n), RP_BAD_INPUT, "N = -1");
}

/* Rows and lattices of a given spacing; regions that a polygon cuts. */
static void test_cut(void)
{
    static const char *const fills[] = {
        "{ pattern = \"row\"; W = 3.0; spacing = 0.5; radius_width = 0.0; }",
        ("{ pattern = \"lattice\"; W = 2.2; H = 9.0; spacing = 0.2; radius_width = 0.0; polygon = ( (0.07, "
         "0.05), (2.13, 0.05), (1.1, 1.84) ); }"),
        "{ N = 300; W = 8.0; H = 8.0; polygon = ( (0.0, 0.0), (8.0, 0.0), (0.0, 8.0) ); }",
        "{ pattern = \"row\"; W = 20.0; spacing = 0.19; radius_width = 0.0; }"};
    static const size_t counts[] = {6, 66, 300, 105}; /* of the second 11 rows of 11 to 1 */
    for (int k = 0; k < 4; k++) {
        scoped_scene s;
        scoped dem_grain *grains = NULL;
        size_t n, low = 0;
        CHECK_OK(grains_read_as(&s, "fill = %s;\n", fills[k]));
        CHECK_OK(dem_scene_grains(&s, &grains, &n));
        CU_ASSERT_FATAL(n == counts[k]);
        for (size_t i = 0; i < n; i++) {
            const dem_grain *g = &grains[i];
            if (k == 0) CHECK_NEAR(g->x, 0.1 + 0.5 * (double)i, 1e-14);
            if (k == 1) CU_ASSERT(fabs(g->x - 1.1) <= 1.0 - (g->y - 0.1) / sqrt(3.0) + 1e-9);
            if (k == 2) CU_ASSERT(g->x + g->y < 8.0);
            low += g->x < 4.0 && g->y < 4.0; /* of the triangle a half */
        }
        if (k == 2) CU_ASSERT(fabs((double)low - 150.0) < 3.3 * sqrt(75.0));
    }
    static const char *const refused[][2] = {
        {"N = 3; W = 1.0; H = 1.0; spacing = 0.3;", "spacing: of a row or a lattice"},
        {"pattern = \"row\"; W = 3.0; spacing = 0.17; radius_width = 0.0;", "overlap by more than a tenth"},
        {"N = 3; W = 1.0; H = 1.0; polygon = ( (0.0, 0.0), (1.0, 1.0) );", "at least 3 points"}};
    scoped_scene far;
    scoped dem_grain *none = NULL;
    size_t n;
    CHECK_OK(grains_read("fill = { pattern = \"lattice\"; W = 1.0; H = 1.0; polygon = ( (5.0, 5.0), (6.0, "
                         "5.0), (5.0, 6.0) ); };\n",
                         NULL, &far));
    CHECK_FAILS(dem_scene_grains(&far, &none, &n), RP_NO_RESULT, "no place for a grain");
    for (int k = 0; k < 3; k++) {
        scoped_scene s;
        CHECK_FAILS(grains_read_as(&s, "fill = { %s };\n", refused[k][0]), RP_BAD_INPUT, refused[k][1]);
    }
}

/* Groups that a condition leaves out. */
static void test_if(void)
{
    for (int k = 0; k < 2; k++) {
        scoped_scene s;
        CHECK_OK(grains_read_as(
            &s,
            "let = { is = %s; }; normal = { law = \"linear\"; tension = false; }; tangential = { law = "
            "\"slip_roll\"; };\nwalls = ( { point = [0.0, 0.0]; direction = [0.0, 1.0]; } );\n"
            "hard = { if = \"is\"; restitution = 0.5; }; ground = { if = \"not is\"; mu_static = 0.3; a = "
            "0.01; };\nfill = { N = 3; W = 1.0; H = 1.0; };\n",
            k ? "false" : "true"));
        CU_ASSERT(s.def.hard.on == (k == 0) && s.def.ground.wall == k);
    }
}

/* ---- several fills ---- */

static const char several[] =
    "dt = 1e-5; steps = 10;\n"
    "walls = ( { name = \"bin\"; polygon = ( (0.0, 30.0), (0.0, 0.0), (4.0, 0.0), (4.0, 30.0) ); closed = "
    "false; } );\n"
    "particles = ( { x = 0.4; y = 6.05; r = 0.3; }, { x = 1.2; y = 6.05; r = 0.3; },\n"
    "  { x = 2.0; y = 6.05; r = 0.3; }, { x = 2.8; y = 6.05; r = 0.3; } ); # reach into the fills\n"
    "fill = ( { kind = \"bed\"; pattern = \"row\"; W = 4.0; fixed = true; radius_law = \"table\";\n"
    "    radii = ( (0.1, 1.0), (0.01, 1.0) ); },\n"
    "  { kind = \"small\"; N = 150; W = 4.0; H = 5.9; }, { if = false; N = 7; W = 1.0; H = 1.0; },\n"
    "  { kind = \"large\"; N = 12; W = 4.0; H = 5.9; density = 2.5; radius_mean = 0.2; radius_width = 0.0; } "
    ");\n";

static void test_several(void)
{
    scoped_scene s;
    scoped dem_grain *grains = NULL;
    size_t n, ends[3] = {4, 0, 0}; /* of the kinds, which follow the list */
    CHECK_OK(grains_read(several, NULL, &s));
    CU_ASSERT(s.n_fills == 3 && strcmp(s.fills[2].kind, "large") == 0);
    CHECK_OK(dem_scene_grains(&s, &grains, &n));
    for (size_t k = 0, i = 4; k < 3; ends[k++] = i)
        while (i < n && grains[i].kind == k + 1) i++;
    CU_ASSERT(n == ends[2] && ends[2] - ends[1] == 12 && ends[1] - ends[0] == 150 && ends[0] > 15);
    double nearest = INFINITY;
    for (size_t i = 0; i < n; i++) {
        const dem_grain *g = &grains[i];
        CU_ASSERT(g->fixed == (i >= 4 && i < ends[0]));
        CU_ASSERT(g->x >= g->r * (1.0 - 1e-9) && g->x <= 4.0 - g->r * (1.0 - 1e-9) &&
                  g->y >= g->r * (1.0 - 1e-9)); /* none touches a wall */
        if (i >= ends[1]) CHECK_NEAR(g->m, dem_mass(DEM_SPHERE, 2.5, 0.2), 1e-15);
        for (size_t k = 0; k < i; k++)
            nearest = fmin(nearest, hypot(g->x - grains[k].x, g->y - grains[k].y) - g->r - grains[k].r);
    }
    CU_ASSERT(nearest >= -1e-12);                /* small ones of the bed lie between two large ones */
    CU_ASSERT(grains[ends[0]].r != grains[4].r); /* streams of its own */
}

/* d is that of the mean grain of what is there first. */
static void test_constants(void)
{
    static const struct {
        const char *text;
        double d;
    } cases[] = {
        {"fill = ( { if = \"not all\"; N = 3; W = 1.0; H = 1.0; radius_mean = 0.12; }, { N = 3; W = 5.0; H = "
         "5.0; radius_mean = 0.2; radius_width = 0.0; } );",
         0.4},
        {"fill = { N = 3; W = 5.0; H = 5.0; radius_law = \"table\"; radii = ( (0.1, 3.0), (0.2, 1.0) ); };",
         0.25},
        {"fill = { if = \"not all\"; N = 3; W = 5.0; H = 5.0; }; particles = ( { x = 0.0; y = 0.0; r = 0.3; "
         "} );",
         0.6},
        {"particles = ( { x = 0.0; y = 0.0; r = 0.1; }, { x = 2.0; y = 0.0; r = 0.3; } );", 0.4}};
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        scoped_scene s;
        CHECK_OK(grains_read_as(&s, "let = { all = true; }; x_max = \"d\"; %s", cases[k].text));
        CHECK_NEAR(s.def.x_max, cases[k].d, 1e-15);
    }
}

/* Few grains of a lattice in much room, and rows that have places by turns. */
static void test_sparse(void)
{
    static const struct {
        const char *text;
        size_t n;
        double y; /* of the last */
    } cases[] = {{"N = 3; W = 0.5; H = 1e9;", 3, 0.1 * (1.0 + 1.7320508075688772)},
                 {"W = 0.25; H = 1.0;", 3, 0.1 * (1.0 + 4.0 * 1.7320508075688772)},
                 {"N = 3; W = 0.15; H = 1e9;", 0, 0.0}};
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        scoped_scene s;
        scoped dem_grain *grains = NULL;
        size_t n = 0;
        CHECK_OK(
            grains_read_as(&s, "fill = { pattern = \"lattice\"; radius_width = 0.0; %s };", cases[k].text));
        const rp_status status = dem_scene_grains(&s, &grains, &n);
        CU_ASSERT(status == (cases[k].n ? RP_OK : RP_NO_RESULT) && n == cases[k].n);
        if (n == cases[k].n && n > 0) CHECK_NEAR(grains[n - 1].y, cases[k].y, 1e-12);
    }
    scoped_scene large; /* what walls cut off is not looked for, in so many nodes */
    scoped dem_grain *grains = NULL;
    size_t n = 0;
    CHECK_OK(grains_read(
        "walls = ( { point = [0.0, 0.0]; direction = [0.0, 1.0]; } ); fill = { N = 3; W = 1e6; H = 1e6; };",
        NULL, &large));
    CHECK_OK(dem_scene_grains(&large, &grains, &n));
    CU_ASSERT(n == 3);
}

/* What leaves no grain, or more than there may be. */
static void test_extremes(void)
{
    static const char *const cases[][2] = {
        {"fill = { if = false; N = 3; W = 1.0; H = 1.0; };", "no particles"},
        {"fill = { pattern = \"row\"; W = 0.05; };", "no place for a grain"},
        {"fill = { pattern = \"lattice\"; W = 1e9; H = 1e9; };", "particles: at most 100000000"}};
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        scoped_scene s;
        dem_sim *sim;
        CHECK_OK(grains_read(cases[k][0], NULL, &s));
        const rp_status status = dem_scene_start(&s, &sim);
        CU_ASSERT(status == (k == 1 ? RP_NO_RESULT : RP_BAD_INPUT));
        CHECK_FAILS(status, status, cases[k][1]);
    }
}

CHECK_SUITE(fills, "fills", test_cut, test_if, test_laws, test_table, test_patterns, test_several,
            test_constants, test_sparse, test_extremes)
