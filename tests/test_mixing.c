/* Grains of a kind: in a region, by observables and modules; how kinds are mixed, against all ways to shuffle
 * their labels; and that tables, exports and pictures name them. */
#include "experiment/modules/module.h"
#include "tests/grains.h"
#include "trial.h"

/* Three kinds in a box, one of them put in by a phase; `some` cuts all, `all` holds all. */
static const char box[] =
    "dt = 5e-5; tangential = { law = `spring`; mu = 0.3; };\n"
    "walls = ( { polygon = ( (0.0, 20.0), (0.0, 0.0), (4.0, 0.0), (4.0, 20.0) ); closed = false; } );\n"
    "fill = ( { kind = `red`; N = 30; W = 2.0; H = 4.0; },\n"
    "  { kind = `blue`; N = 20; W = 2.0; x0 = 2.0; H = 4.0; radius_mean = 0.15; radius_width = 0.0; } );\n"
    "regions = { some = { x = (0.5, 3.0); y = (0.2, 1.4); }; all = { x = (-1.0, 5.0); y = (-1.0, 9.0); };\n"
    "  disk = { circle = (2.0, 0.0, 1.5); }; corner = { polygon = ( (0.0, 0.0), (3.0, 0.0), (0.0, 3.0) ); }; "
    "};\n"
    "phases = ( { name = `fall`; steps = 4000; mark = true; },\n"
    "  { name = `more`; add = { kind = `green`; N = 3; x = (0.5, 3.5); y = `touch + r`; }; steps = 1000; } "
    ");\n";

static const char *const regions[] = {"some", "all", "disk", "corner"}, *const kinds[] = {"red", "blue",
                                                                                          "green"};

/* Each region with each of two kinds. */
enum { BOTH = 8 };
static const char *region_of(size_t i)
{
    return regions[i / 2];
}

static const char *kind_of(size_t i)
{
    return kinds[2 * (i % 2)];
}

static void put_orders(FILE *to)
{
    exp_word w;
    fprintf(to, "%smeasure = ( { name = `count`; of = `grains`; }", box);
    for (size_t k = 0; (w = exp_observable_at(k)).name; k++) {
        const char *args = strcmp(w.name, "moved") == 0 ? "(0.5, 1)" : "";
        if (!strstr(w.of, "KIND") || strcmp(w.name, "rest") == 0) continue;
        for (size_t i = 0; i < BOTH; i++) {
            const char *r = region_of(i), *c = kind_of(i);
            fprintf(to, ", { name = `%s_%s_%s`; of = `%s.%s.%s%s`; optional = true; }", r, c, w.name, r, c,
                    w.name, args);
            fprintf(to, ", { name = `%s_%s_%s`; of = `%s.%s.%s%s`; optional = true; }", c, r, w.name, c, r,
                    w.name, args);
        }
        for (size_t i = 0; i < 2; i++)
            fprintf(to, ", { name = `%s_%s`; of = `%s.%s%s`; optional = true; }", kind_of(i), w.name,
                    kind_of(i), w.name, args);
    }
    fputs(" );\n", to);
}

/* Both orders are one observable; in a region that holds all it is that of the kind. */
static void orders(void)
{
    exp_word w;
    scoped_trial t = {0};
    char name[3][64];
    size_t n = 0;
    CHECK_WRITTEN(text, to, put_orders(to));
    run_whole(&t, text, 100000, "ok");
    for (size_t k = 0; (w = exp_observable_at(k)).name; k++) {
        if (!strstr(w.of, "KIND") || strcmp(w.name, "rest") == 0) continue;
        for (size_t i = 0; i < BOTH; i++) {
            const char *r = region_of(i), *c = kind_of(i);
            snprintf(name[0], 64, "%s_%s_%s", r, c, w.name), snprintf(name[1], 64, "%s_%s_%s", c, r, w.name);
            snprintf(name[2], 64, "%s_%s", c, w.name);
            const double one = measured(&t, name[0]), other = measured(&t, name[1]),
                         all = measured(&t, name[2]);
            CHECK_OR_SAY(one == other || (isnan(one) && isnan(other)), "%s: %g, %g", name[0], one, other);
            if (i / 2 == 1 && strcmp(w.name, "cells") != 0) /* whose width is between the region's ends */
                CHECK_OR_SAY(one == all || (isnan(one) && isnan(all)), "%s: %g, all %g", name[0], one, all);
            n++;
        }
    }
    CU_ASSERT(n > BOTH * 15);
}

static void put_sums(FILE *to)
{
    fprintf(to, "%smeasure = ( { name = `filled`; of = `some.fraction`; }", box);
    for (int k = 0; k < 3; k++) {
        const char *c = kinds[k];
        fprintf(to,
                ", { name = `n%d`; of = `some.%s.grains`; }, { name = `m%d`; of = `%s.some.whole_mass`; },"
                " { name = `f%d`; of = `some.%s.fraction`; }, { name = `cut%d`; of = `%s.some.mass`; },"
                " { name = `y%d`; of = `some.%s.grains > 0 ? some.%s.y*some.%s.whole_mass : 0`; }",
                k, c, k, c, k, c, k, c, k, c, c, c);
    }
    fputs(" );\n", to);
}

/* Sums over the grains, whose ids rise from fill to fill. */
static void against_states(void)
{
    static const uint32_t ends[] = {30, 50, 53};
    CHECK_WRITTEN(text, to, put_sums(to));
    RUN_TRIAL(t, text, 100000, "ok");
    scoped dem_state *s = grains_states(exp_sim(t.run));
    double filled = 0.0;
    for (int k = 0; k < 3; k++) {
        double n = 0.0, m = 0.0, y = 0.0;
        for (size_t i = 0; i < dem_count(exp_sim(t.run)); i++) {
            const bool own = s[i].id <= ends[k] && (k == 0 || s[i].id > ends[k - 1]),
                       in = s[i].x > 0.5 && s[i].x < 3.0 && s[i].y > 0.2 && s[i].y < 1.4;
            if (own && in) n++, m += s[i].m, y += s[i].m * s[i].y;
        }
        CHECK_PAIRS(1e-12, {measured(&t, check_text("n%d", k)), n}, {measured(&t, check_text("m%d", k)), m},
                    {measured(&t, check_text("y%d", k)), y});
        filled += measured(&t, check_text("f%d", k));
        CU_ASSERT(k == 2 || (n > 3.0 && measured(&t, check_text("cut%d", k)) != m));
    }
    CHECK_NEAR(filled, measured(&t, "filled"), 1e-12);
}

static void put_modules(FILE *to)
{
    fprintf(to,
            "%smeasure = ( { name = `a`; of = `order`; in = `all`; }, { name = `f`; of = `fabric`; in = "
            "`some`; kind = `red`; },\n { name = `p`; of = `profile`; in = `all`; bins = 3; },\n"
            "  { name = `place`; of = `motion.all_x`; in = `all`; kind = `blue`; at = `fall`; },\n"
            "  { name = `places`; of = `motion.all_x`; in = `all`; at = `fall`; },\n"
            "  { name = `heap`; of = `deposit`; kind = `red`; }, { name = `top`; of = `red.height`; }",
            box);
    for (int k = 0; k < 3; k++) {
        fprintf(to,
                ", { name = `a%d`; of = `order`; kind = `%s`; }, { name = `n%d`; of = `%s.grains`; },\n"
                "  { name = `p%d`; of = `profile`; in = `all`; kind = `%s`; bins = 3; }",
                k, kinds[k], k, kinds[k], k, kinds[k]);
    }
    fputs(" );\n", to);
}

/* Modules of a kind: what is of single grains adds up to that of all, what is between grains is of pairs of
 * the kind. */
static void modules(void)
{
    CHECK_WRITTEN(text, to, put_modules(to));
    write_trial("m.cfg", text);
    GOOD("run m.cfg -o m");
    RUN_TRIAL(t, text, 100000, "ok");
    scoped_table all = read_table("m/profile_p.tsv");
    rp_table parts[3];
    double packed = 0.0, n = 0.0;
    for (int k = 0; k < 3; k++) {
        parts[k] = read_table(check_text("m/profile_p%d.tsv", k));
        const double own = measured(&t, check_text("n%d", k));
        n += own, packed += own * measured(&t, check_text("a%d_packed", k));
    }
    CHECK_NEAR(packed, n * measured(&t, "a_packed"), 1e-9);
    for (size_t i = 0; i < 3; i++) {
        double grains = 0.0, fraction = 0.0;
        for (int k = 0; k < 3; k++)
            grains += cell(&parts[k], i, "grains"), fraction += cell(&parts[k], i, "fraction");
        CHECK_PAIRS(1e-12, {grains, cell(&all, i, "grains")}, {fraction, cell(&all, i, "fraction")});
    }
    for (int k = 0; k < 3; k++) rp_table_free(&parts[k]);
    size_t n_contacts;
    double pairs = 0.0;
    scoped dem_contact *c = grains_contacts(exp_sim(t.run), &n_contacts);
    scoped dem_state *s = grains_states(exp_sim(t.run));
    for (size_t i = 0; i < n_contacts; i++) {
        bool in = c[i].id_a <= 30 && c[i].id_b > 0 && c[i].id_b <= 30;
        for (int end = 0; end < 2 && in; end++) {
            const dem_state *p = &s[(end ? c[i].id_b : c[i].id_a) - 1];
            in = p->x > 0.5 && p->x < 3.0 && p->y > 0.2 && p->y < 1.4;
        }
        pairs += in;
    }
    CU_ASSERT(pairs > 3.0 && measured(&t, "f_contacts") == pairs);
    CU_ASSERT(measured(&t, "place") > 0.55 &&
              measured(&t, "places") < 0.5); /* blue on the right, as filled */
    CU_ASSERT(measured(&t, "heap_height") <= measured(&t, "top"));
}

/* ---- mixing ---- */

enum { N = 12, OWN = 5 };

/* Twelve grains in cells of 5, 4, 2 and 1, some of which touch; the kinds are labels on them. */
typedef struct {
    dem_state grains[N];
    dem_contact contacts[9];
    exp_view view;
    void *params;
} labelled;

static void lay(labelled *l, const char *along)
{
    static const double places[N][2] = {{0.1, 0.1}, {0.3, 0.4}, {0.5, 0.2}, {0.7, 0.7},
                                        {0.9, 0.3}, {1.1, 0.5}, {1.3, 0.6}, {1.5, 0.1},
                                        {1.8, 0.9}, {2.2, 0.4}, {2.7, 0.2}, {3.5, 0.6}};
    static const int pairs[9][2] = {{0, 1}, {1, 2}, {2, 4}, {3, 4}, {4, 5}, {5, 6}, {6, 7}, {8, 9}, {10, 11}};
    *l = (labelled){.view = {.n = N, .n_all = N, .n_contacts = 9}};
    for (uint32_t i = 0; i < N; i++)
        l->grains[i] = (dem_state){.id = i + 1, .x = places[i][0], .y = places[i][1], .r = 0.1, .m = 1.0};
    for (size_t k = 0; k < 9; k++)
        l->contacts[k].id_a = (uint32_t)pairs[k][0] + 1, l->contacts[k].id_b = (uint32_t)pairs[k][1] + 1;
    l->contacts[8].id_b = 0; /* with a wall: between no grains */
    l->view.grains = l->view.all = l->grains, l->view.contacts = l->contacts;
    l->view.kind = 7;
    l->view.lo[0] = l->view.lo[1] = -INFINITY;
    l->params = calloc(1, exp_module_mixing.size);
    CU_ASSERT_PTR_NOT_NULL_FATAL(l->params);
    rp_params_defaults(exp_module_mixing.schema, RP_CGS, l->params);
    CHECK_OK(rp_params_set_text(rp_params_find(exp_module_mixing.schema, "cell"), RP_CGS, l->params, "1"));
    CHECK_OK(rp_params_set_text(rp_params_find(exp_module_mixing.schema, "along"), RP_CGS, l->params, along));
}

enum { LACEY, UNLIKE, DISTANCE, SHARE, CELLS };

static void mix(labelled *l, unsigned own, double got[])
{
    for (int i = 0; i < N; i++) l->grains[i].kind = own >> i & 1 ? 7 : i % 2U;
    for (int k = 0; k < 5; k++) got[k] = NAN;
    CHECK_OK(exp_module_mixing.evaluate(&l->view, l->params, got));
}

/* Over all ways to label five of twelve grains the means of both indices are 1. */
static void shuffled(void)
{
    labelled l;
    double got[5], sum[2] = {0.0}, ways = 0.0;
    lay(&l, "x");
    for (unsigned own = 0; own < 1U << N; own++) {
        if (__builtin_popcount(own) != OWN) continue;
        mix(&l, own, got);
        ways++, sum[0] += got[LACEY], sum[1] += got[UNLIKE];
    }
    CU_ASSERT(ways == 792.0 && got[CELLS] == 4.0);
    CHECK_PAIRS(1e-12, {sum[0] / ways, 1.0}, {sum[1] / ways, 1.0}, {got[SHARE], 5.0 / 12.0});
    free(l.params);
}

/* Separated in cells: 0; the kinds change places, and grains their numbers, without a change of the indices.
 */
static void separated(void)
{
    labelled l;
    double got[5], swapped[5], moved[5];
    lay(&l, "x");
    mix(&l, 0x01f, got); /* the first cell */
    CHECK_PAIRS(1e-15, {got[LACEY], 0.0}, {got[UNLIKE], (1.0 / 8.0) / (2.0 * 5.0 * 7.0 / (12.0 * 11.0))},
                {got[DISTANCE], hypot(0.5 - (1.1 + 1.3 + 1.5 + 1.8 + 2.2 + 2.7 + 3.5) / 7.0,
                                      0.34 - (0.5 + 0.6 + 0.1 + 0.9 + 0.4 + 0.2 + 0.6) / 7.0)});
    mix(&l, 0x5a5, got);
    mix(&l, ~0x5a5U & 0xfff, swapped);
    CHECK_PAIRS(1e-14, {swapped[LACEY], got[LACEY]}, {swapped[UNLIKE], got[UNLIKE]},
                {swapped[DISTANCE], got[DISTANCE]}, {swapped[SHARE], 1.0 - got[SHARE]});
    mix(&l, 0x5a5, got);
    unsigned own = 0;
    dem_state back[N];
    for (uint32_t i = 0; i < N; i++) { /* numbers from the other end */
        back[i] = l.grains[N - 1 - i], back[i].id = i + 1;
        own |= (0x5a5U >> (N - 1 - i) & 1) << i;
    }
    memcpy(l.grains, back, sizeof back);
    for (size_t k = 0; k < 8; k++)
        l.contacts[k].id_a = N + 1 - l.contacts[k].id_a, l.contacts[k].id_b = N + 1 - l.contacts[k].id_b;
    mix(&l, own, moved);
    CHECK_PAIRS(1e-14, {moved[LACEY], got[LACEY]}, {moved[UNLIKE], got[UNLIKE]},
                {moved[DISTANCE], got[DISTANCE]});
    free(l.params);
    lay(&l, "y"); /* one layer: no variance between cells, and no index */
    mix(&l, 0x01f, got);
    CU_ASSERT(isnan(got[LACEY]) && got[CELLS] == 1.0 && got[UNLIKE] > 0.0);
    for (uint32_t i = 0; i < N; i++) l.grains[i].kind = 7;
    CHECK_FAILS(exp_module_mixing.evaluate(&l.view, l.params, got), RP_NO_RESULT,
                "12 grains of the kind, 0 others");
    free(l.params);
}

/* In a run: squares of a region begin at its lower ends; others than the kind count together. */
static void in_a_run(void)
{
    const char *text = check_text(
        "%s measure = ( { name = `m`; of = `mixing`; kind = `red`; in = `some`; cell = 0.6; },\n"
        "  { name = `count`; of = `some.grains`; }, { name = `own`; of = `some.red.grains`; },\n"
        "  { name = `one`; of = `mixing.lacey`; kind = `green`; cell = 0.5; during = `fall`; optional = "
        "true; } );",
        box);
    RUN_TRIAL(t, text, 100000, "ok");
    scoped dem_state *s = grains_states(exp_sim(t.run));
    double held[5][2][2] = {{{0.0}}}, n = measured(&t, "count"), p = measured(&t, "own") / n, between = 0.0,
           K = 0.0;
    for (size_t i = 0; i < dem_count(exp_sim(t.run)); i++)
        if (s[i].x > 0.5 && s[i].x < 3.0 && s[i].y > 0.2 && s[i].y < 1.4)
            held[(int)((s[i].x - 0.5) / 0.6)][(int)((s[i].y - 0.2) / 0.6)][s[i].id <= 30]++;
    for (int i = 0; i < 10; i++) {
        const double *h = held[i / 2][i % 2], all = h[0] + h[1];
        if (all > 0.0) K++, between += all / n * pow(h[1] / all - p, 2.0);
    }
    CHECK_PAIRS(1e-12, {measured(&t, "m_cells"), K}, {measured(&t, "m_share"), p},
                {measured(&t, "m_lacey"),
                 (p * (1.0 - p) - between) / (p * (1.0 - p) - p * (1.0 - p) * (K - 1.0) / (n - 1.0))});
    CU_ASSERT(isnan(measured(&t, "one")));
}

static void refused(void)
{
    const char *text = check_text("%s measure = ( { name = `count`; of = `some.red.grains`; } );", box);
#define OF "{ name = `count`; of = `some.red.grains`; }"
    const trial_change list[] = {
        {text, "some.red.grains", "some.all.grains", "unknown name some.all.grains"},
        {text, "some.red.grains", "red.blue.grains", "unknown name red.blue.grains"},
        {text, "some.red.grains", "some.red.blue.grains", "unknown name some.red.blue.grains"},
        {text, "some.red.grains", "some.red.sxx", "unknown name some.red.sxx"},
        {text, "some.red.grains", "some.red.grain", "did you mean \"some.red.grains\"?"},
        {text, "some.red.grains", "some.red.moved(-1)", "moved(-1): a distance of 0 or more expected"},
        {text, OF, "{ name = `count`; of = `grains`; kind = `red`; }",
         "an expression names it, as in red.grains"},
        {text, OF, "{ name = `count`; of = `order`; kind = `rod`; }", "no grains of this kind (did you mean"},
        {text, OF, "{ name = `count`; of = `mixing`; kind = `red`; }", "cell: missing"},
        {text, OF, "{ name = `count`; of = `mixing`; cell = 1.0; }", "kind: missing"},
        {text, OF, "{ name = `count`; of = `mixing`; kind = `red`; cell = 0.0; }", "cell = 0: out of range"}};
    check_refused(sizeof list / sizeof *list, list);
    const trial_change ends[] = {
        {text, OF,
         "{ name = `count`; of = `mixing`; in = `corner`; kind = `green`; cell = 1.0; at = `fall`; }",
         "one_kind"}};
    check_ends(sizeof ends / sizeof *ends, ends);
}

/* Sweeps and calibrations read them as any other measure: a speed that is planted is found by the share of a
 * kind in a region. */
static void swept(void)
{
    write_trial("k.cfg",
                "let = { v = 10.0; }; dt = 1e-5; gravity = (0.0, 0.0);\n"
                "fill = ( { kind = `fast`; pattern = `row`; N = 20; W = 8.0; x0 = 0.0; y0 = 1.0; },\n"
                "  { kind = `slow`; pattern = `row`; N = 20; W = 8.0; y0 = 3.0; x0 = 0.0; } );\n"
                "regions = { right = { x = (2.0, 9.0); }; };\n"
                "phases = ( { name = `go`; steps = 10; } );\n"
                "measure = ( { name = `gap`; of = `v*(slow.y - right.fast.y)`; },\n"
                "  { name = `m`; of = `mixing`; kind = `fast`; cell = 1.0; along = `y`; prefix = ``; } );\n");
    write_text("s.cfg", "experiment = \"k.cfg\"; replicas = 2; seed = 6; grid = { v = [1.0, 2.0]; };\n");
    GOOD("sweep make s.cfg -o s --tables t --quiet");
    scoped_table t = read_table("t/points.tsv");
    CU_ASSERT(t.n_rows == 2 && cell(&t, 1, "lacey_mean") == 0.0);
    CHECK_NEAR(cell(&t, 1, "gap_mean"), 4.0, 0.2);
    write_text("fit.cfg",
               "fit = { v = [1.0, 9.0]; };\nmeasured = ( { experiment = \"k.cfg\"; of = \"gap\"; value = "
               "8.0; error = 0.2; } );\n");
    SHELL("$REPOSE calibrate fit.cfg -o c >out 2>err");
    scoped_table answer = read_table("out");
    CHECK_NEAR(cell(&answer, 0, "value"), 4.0, 0.3);
}

/* ---- tables, exports, pictures ---- */

static const char layers[] =
    "dt = 5e-5; steps = 10;\n%s"
    "walls = ( { polygon = ( (0.0, 20.0), (0.0, 0.0), (4.0, 0.0), (4.0, 20.0) ); closed = false; } );\n"
    "fill = ( { kind = `%s`; N = 20; W = 4.0; H = 1.5; }, { kind = `%s`; N = 10; W = 4.0; y0 = 1.5; H = 1.0; "
    "},\n"
    "  { %s N = 5; W = 4.0; y0 = 2.5; H = 1.0; } );\n";

static void write_layers(const char *name, const char *more, const char *low, const char *high,
                         const char *top)
{
    write_trial(name, check_text(layers, more, low, high, top));
}

/* Each frame's states by a command of the shell: column 1 counts, column 2 what is counted. */
static void counts(const char *command, const char *expected)
{
    CU_ASSERT(shell(check_text("{ %s; } | sort -n | uniq -c | awk '{ printf \"%%s %%s, \", $1, $2 }' >counts",
                               command)) == 0);
    char text[256];
    slurp("counts", text, sizeof text);
    CHECK_OR_SAY(strcmp(text, expected) == 0, "%s: %s", command, text);
}

#define STATES                                                                                               \
    "awk -F'\t' '/^step/ { for (i = 1; i <= NF; i++) if ($i == \"kind\") c = i } /^10\t/ { print $c }' "

static void exports(void)
{
    write_layers("a.cfg", "", "sand", "steel", "");
    write_layers("b.cfg", "", "sand", "steel", "kind = `sand`;");
    write_text("none.cfg", "dt = 5e-5; steps = 10; fill = { N = 3; W = 2.0; H = 2.0; };\n");
    GOOD("run a.cfg -o a");
    GOOD("run b.cfg -o b");
    GOOD("run none.cfg -o none");
    counts(STATES "a/states.tsv", "5 0, 20 1, 10 2, ");
    counts(STATES "b/states.tsv", "25 1, 10 2, ");
    SHELL("grep -qx '# kinds: sand steel' a/states.tsv && ! grep -q kind none/states.tsv");
    for (const char *name = "ab"; *name; name++) {
        GOOD("export %c --to lammps -o %c.dump", *name, *name);
        GOOD("export %c --to vtk -o %c.pvd", *name, *name);
        GOOD("export %c/states.tsv --to json --columns step,kind -o %c.json", *name, *name);
        GOOD("export %c/states.tsv --to csv --columns kind,step -o %c.csv", *name, *name);
    }
    /* types of LAMMPS begin at 1 */
    counts("tail -35 a.dump | cut -d' ' -f2", "5 1, 20 2, 10 3, ");
    counts("tail -35 b.dump | cut -d' ' -f2", "25 1, 10 2, ");
    counts("sed -n '/Name=\"kind\"/,/<.Data/p' a_frames/grains_000000.vtp | grep '^[0-9]'",
           "5 0, 20 1, 10 2, ");
    counts("grep '\"step\": 10,' a.json | grep -o '\"kind\": .'| cut -c9-", "5 0, 20 1, 10 2, ");
    counts("sed -n 's/,10$//p' b.csv", "25 1, 10 2, ");
    SHELL("grep -q '\"kinds\": \"sand steel\"' a.json");
    GOOD("export none --to lammps -o none.dump");
    counts("tail -3 none.dump | cut -d' ' -f2", "3 1, ");
}

/* A table tells its kinds by name: in a scene whose kinds have other numbers they are the same. */
static void read_back(void)
{
    write_layers("a.cfg", "", "sand", "steel", "");
    GOOD("run a.cfg -o a");
    write_trial(
        "again.cfg",
        "dt = 5e-5; particles_file = `a/states.tsv`; gravity = (0.0, 0.0);\n"
        "phases = ( { name = `go`; steps = 1; }, { name = `drop`; add = { kind = `steel`; r = 0.1; x = 2.0; "
        "y = 9.0; }; steps = 1; } );\n"
        "measure = ( { name = `hard`; of = `steel.grains`; }, { name = `soft`; of = `sand.grains`; } );\n");
    GOOD("run again.cfg -o again");
    SHELL("grep -q '^hard.11.' again/measures.tsv && grep -q '^soft.20.' again/measures.tsv");
    SHELL("sed 's/^# kinds: .*/# kinds: steel/' a/states.tsv >few.tsv && sed 's/a.states/few/' again.cfg "
          ">few.cfg");
    FAILS(65, "kind = 2: the name of a kind expected, or its number in the scene", "run few.cfg");
}

/* The names of a picture's key and the colours of its grains. */
static void pictures(void)
{
    write_layers("a.cfg", "", "fine_sand", "steel", "");
    write_layers("b.cfg", "", "sand", "steel", "kind = `sand`;");
    GOOD("run a.cfg -o a");
    GOOD("run b.cfg -o b");
    GOOD("view a --color kind -o a.svg");
    GOOD("view b --color kind -o b.svg");
    SHELL("grep -q '>fine_sand<' a.svg && grep -q '>steel<' a.svg && grep -q '>none<' a.svg && grep -q "
          "'>kind<' a.svg");
    SHELL("! grep -q '>none<' b.svg && grep -q '>sand<' b.svg");
    counts("grep '<use' b.svg | grep -o \"rgb([^)]*)\" | tr -d ' ' | grep -v 168",
           "10 rgb(230,159,0), 25 rgb(86,180,233), ");
    GOOD("view b --color r -o r.svg");
    SHELL("! grep -q '>sand<' r.svg && grep -q '>r (cm)<' r.svg");
}

CHECK_SUITE_WITHIN(mixing, "mixing", enter, leave, orders, against_states, modules, shuffled, separated,
                   in_a_run, refused, swept, exports, read_back, pictures)
