/* Kinds of grains with coefficients of their own, in pairs and at walls. */
#include "dem/state/state.h"
#include "tests/grains.h"
#include "tests/numbers.h"
#include "tests/trial.h"
#include "tests/twin.h"

enum { KINDS = 3 };
static const dem_kind names[KINDS] = {{""}, {"steel"}, {"sand"}};

/* A box of grains of three kinds, whose coefficients differ by up to a factor of two; the table lasts until
 * the next call. */
static dem_definition mixed(long N, double W, long run, dem_grain **grains)
{
    static dem_material pairs[KINDS * (KINDS + DEM_FEW_WALLS)];
    dem_definition def = grains_box(N, W, run, grains);
    for (long i = 0; i < N; i++) (*grains)[i].kind = (uint32_t)(i % KINDS);
    def.n_kinds = KINDS, def.kinds = names, def.pairs = pairs;
    return def;
}

/* Fill the table from the coefficients that hold by now. */
static void mix(dem_definition *def)
{
    for (size_t k = 0; k < KINDS * (KINDS + def->n_walls); k++) {
        dem_material *m = (dem_material *)&def->pairs[k];
        const size_t a = k % KINDS, b = k / KINDS;
        const double part = b < KINDS ? 1.0 - 0.1 * (double)(a + b) : 1.0 - 0.15 * (double)a;
        *m = b < KINDS ? def->material : def->walls[b - KINDS].material;
        m->k_n *= part, m->k_s *= 1.5 - part, m->gamma_n *= part, m->gamma_s *= part;
        m->mu *= 1.5 - part, m->mu_roll *= part, m->k_roll *= part;
    }
}

/* ---- the same bits ---- */

static const char bed[] =
    "dt = 5e-6; rotation = true; %s\nrolling = { mu = 0.05; arm = \"radius\"; };\n"
    "material = { E = %s; nu = 0.3; restitution = 0.6; mu = 0.4; };\n"
    "walls = ( { point = [0.0, 0.0]; direction = [0.0, 1.0]; }, { name = \"side\"; E = 3e7;\n"
    "  polygon = ( [0.0, 9.0], [0.0, 1.0], [1.5, 0.1], [1.5, 9.0] ); closed = false; } );\n"
    "fill = ( { kind = \"steel\"; N = 25; W = 1.5; H = 2.5; %s }, { kind = \"sand\"; N = 25; W = 1.5; H = "
    "4.0; } );\n";

/* Kinds that say what the scene says, or nothing. */
static void alike(void)
{
    static const char kinds[] =
        "kinds = { sand = { mu = 0.4; density = 2.0; material = { E = 2e7; }; mu_roll = 0.05; },\n"
        "  steel = { material = { E = 2e7; nu = 0.3; restitution = 0.6; mu = 0.4; }; density = 2; }; };";
    GRAINS_EACH_KERNEL (kernel, DEM_REFERENCE) {
        char word[32], *text;
        rp_word_at(DEM_WORDS(DEM_KERNEL_LIST), kernel, word, sizeof word);
        text = strdup(check_text("kernel = \"%s\"; ", word));
        scoped_sim *one = grains_after_text(4000, bed, check_text("%sdensity = 2.0;", text), "2e7", ""),
                   *two = grains_after_text(4000, bed, check_text("%s%s", text, kinds), "1e7", "");
        CU_ASSERT(grains_same_bits(one, two) && one->def.pairs == NULL && two->def.pairs != NULL);
        CU_ASSERT(grains_energies(one).elastic > 0.0);
        CHECK_NEAR(one->start.dt_limit, two->start.dt_limit, 0.0);
        free(text);
    }
}

/* A label is no kind of its own: nothing depends on it. */
static void labels(void)
{
    scoped_sim *one = grains_after_text(3000, bed, "", "2e7", ""), *two = NULL;
    two = grains_of_text(3000, check_changed(check_text(bed, "", "2e7", ""), "kind = \"steel\";", ""));
    CU_ASSERT(grains_same_bits(one, two) && one->def.pairs == NULL && dem_kind_count(two) == 2);
}

/* All laws, by every kernel and by threads. */
static void kernels(void)
{
    enum { STEPS = 1500 };
    for (int normal = 0; normal < DEM_NORMAL_N; normal++)
        for (int tangential = 0; tangential < DEM_TANGENTIAL_N; tangential++)
            for (int model = 0; model < DEM_ROLLING_N; model++) {
                dem_grain *grains;
                dem_definition def = mixed(90, 1.5, 5, &grains);
                if (dem_is_of_radius(tangential) && normal != DEM_ELASTIC) continue;
                if (model > 0 && !dem_has_friction(tangential)) continue;
                grains_law(&def, normal, 1e5, 500.0);
                def.tangential = tangential, def.tension = false, def.damping = DEM_DAMPING_INSIDE;
                def.rotation = true, def.rolling = (dem_rolling)model, def.rolling_arm = DEM_ARM_RADIUS;
                if (!dem_has_friction(tangential)) def.material.mu = 0.0;
                if (dem_has_friction(tangential))
                    def.material.mu_roll = dem_rolls_by_speed(def.rolling) ? 1e-3 : 0.1;
                if (dem_is_of_radius(tangential)) {
                    def.material.k_s = def.material.k_roll = 0.4 * def.material.k_n;
                    def.material.gamma_s = def.material.gamma_roll = 0.2;
                }
                for (int w = 0; w < DEM_BOX_N; w++) def.walls[w].material = def.material;
                def.dt = 1e-5, mix(&def);
                def.kernel = DEM_REFERENCE;
                scoped_sim *reference = grains_after(&def, STEPS);
                GRAINS_EACH_KERNEL (kernel, DEM_BASELINE) {
                    def.kernel = kernel;
                    scoped_sim *sim = grains_after(&def, STEPS);
                    CHECK_OR_SAY(grains_same_bits(sim, reference), "%s, %s, model %d: other bits by %s",
                                 dem_normal_descriptors[normal].name,
                                 dem_tangential_descriptors[tangential].name, model, dem_kernel_name(sim));
                }
            }
}

static void by_threads(void)
{
    enum { STEPS = 1000 };
    dem_grain *grains;
    dem_definition def = mixed(900, 5.0, 8, &grains);
    def.rotation = true, def.material.mu_roll = 0.1, mix(&def);
    scoped_sim *one = grains_start_in_chunks(&def, 64), *two = grains_start_in_chunks(&def, 64);
    dem_threads(two, 2);
    CHECK_OK(dem_run(one, STEPS));
    CHECK_OK(dem_run(two, STEPS));
    CU_ASSERT(dem_threads_serve(two) && grains_same_bits(one, two));
}

static bool is_left(const void *region, uint32_t id, double x, double y)
{
    return (void)region, (void)id, (void)y, x < 0.7;
}

/* A snapshot and a copy have the kinds, and go on with them; so do the grains that others leave. */
static void kept(void)
{
    dem_grain *grains;
    dem_definition def = mixed(90, 1.5, 5, &grains);
    def.ledger = true, mix(&def);
    scoped_sim *sim = grains_after(&def, 1500), *read = grains_kept(sim), *copy = NULL;
    CHECK_OK(dem_clone(sim, &copy));
    for (int k = 0; k < 3; k++) CHECK_OK(dem_run(k == 0 ? sim : k == 1 ? read : copy, 1500));
    CU_ASSERT(grains_same_bits(sim, read) && grains_same_bits(sim, copy));
    scoped dem_state *states = grains_states(read);
    for (size_t i = 0; i < dem_count(read); i++) CU_ASSERT(states[i].kind == (states[i].id - 1) % KINDS);
    CU_ASSERT(dem_kind_count(read) == KINDS && strcmp(dem_kind_name(copy, 2), "sand") == 0);
    CHECK_NEAR(grains_ledger(read).residual, 0.0, 1e-10 * grains_ledger(read).turnover);
    CU_ASSERT(fabs(grains_ledger(read).sliding) > 1e-6 * grains_ledger(read).turnover);
    CHECK_OK(dem_remove(&read, is_left, NULL));
    const size_t n = dem_count(read);
    scoped dem_state *rest = grains_states(read);
    for (size_t i = 0; i < n; i++) CU_ASSERT(rest[i].kind == (rest[i].id - 1) % KINDS);
    CU_ASSERT(n > 0 && n < dem_count(sim));
}

/* ---- two bodies ---- */

/* The rebound of a grain of one kind from one of the other has the pair's restitution, at the pair's
 * stiffness and their own masses: a half oscillation of k = 2/(1/k_a + 1/k_b). */
static void rebound(void)
{
    static const char text[] =
        "dt = 1e-7; gravity = [0.0, 0.0]; normal = { law = \"linear\"; k_n = 1e5; restitution = 0.8; };\n"
        "kinds = { a = { k_n = 4e5; density = 3.0; }; b = { k_n = 1.5e5; }; };\n"
        "pairs = ( { of = (\"b\", \"a\"); restitution = 0.45; } );\n"
        "particles = ( { kind = \"a\"; x = 0.0; y = 0.0; r = 0.1; vx = 20.0; },\n"
        "  { kind = \"%s\"; x = 0.301; y = 0.0; r = 0.2; } );\n";
    for (int other = 0; other < 2; other++) {
        const double k = other ? 4e5 : 2.0 / (1.0 / 4e5 + 1.0 / 1.5e5), e = other ? 0.8 : 0.45,
                     m[2] = {4.0 * M_PI * 1e-3, 4.0 / 3.0 * M_PI * 8e-3 * (other ? 3.0 : 1.0)};
        scoped_sim *sim = grains_after_text(0, text, other ? "a" : "b");
        const double m_eff = other ? 0.5 * 0.5 * (m[0] + m[1]) : m[0] * m[1] / (m[0] + m[1]),
                     ratio = dem_damping_ratio_of(true, e);
        const dem_material *c = dem_pair_material(&sim->def, 1, other ? 1 : 2);
        CHECK_NEAR(c->k_n, k, 1e-15 * k);
        CHECK_NEAR(c->gamma_n, 2.0 * ratio * sqrt(k / m_eff), 1e-12 * c->gamma_n);
        while (dem_contact_count(sim, 1) == 0) CHECK_OK(dem_run(sim, 1));
        const double begins = dem_time(sim), omega = sqrt(k * (1.0 / m[0] + 1.0 / m[1]));
        while (dem_contact_count(sim, 1) > 0) CHECK_OK(dem_run(sim, 1));
        scoped dem_state *s = grains_states(sim);
        const double own = 0.5 * c->gamma_n / omega, root = sqrt(1.0 - own * own); /* of these two */
        CHECK_NEAR(dem_time(sim) - begins, M_PI / omega / root, 3e-7);
        CHECK_NEAR((s[1].vx - s[0].vx) / 20.0, exp(-M_PI * own / root), 1e-4);
        if (!other) CHECK_NEAR((s[1].vx - s[0].vx) / 20.0, 0.45, 1e-4);
    }
}

/* Moduli are summed as in dem_elastic_contact, of two kinds and of a kind at a wall. */
static void moduli(void)
{
    static const char kinds[] =
        "kinds = { steel = { material = { E = 2e9; nu = 0.2; }; }; sand = { nu = 0.1; }; };";
    static const double E[] = {2e8, 2e9, 2e8}, nu[] = {0.3, 0.2, 0.1};
    scoped_scene s = {0};
    CHECK_OK(grains_read_as(&s, bed, kinds, "2e8", ""));
    for (size_t a = 1; a < KINDS; a++)
        for (size_t b = 1; b < KINDS + 2; b++) {
            const bool wall = b >= KINDS; /* the first has the modulus of the kind */
            const double own[2] = {wall ? b == KINDS ? E[a] : 3e7 : E[b], wall ? nu[a] : nu[b]};
            const dem_material *c =
                wall ? dem_material_at(&s.def, b - KINDS, a) : dem_pair_material(&s.def, a, b);
            double k_n, k_s;
            dem_elastic_contact((double[]){E[a], own[0]}, (double[]){nu[a], own[1]}, &k_n, &k_s);
            CHECK_NEAR(c->k_n, k_n, 1e-15 * k_n);
            CHECK_NEAR(c->k_s, k_s, 1e-15 * k_s);
        }
}

/* A grain that slides on a wall feels the friction that the kind and this wall have together. */
static void at_walls(void)
{
    static const struct {
        const char *kinds, *walls, *pairs;
        double mu[2];
    } cases[] = {
        {"a = { mu = 0.5; }; b = { };", "", "", {0.5, 0.3}},
        {"a = { }; b = { };", "mu = 0.2;", "", {0.2, 0.2}},
        {"a = { mu = 0.2; }; b = { };", "mu = 0.2;", "", {0.2, 0.2}},
        {"a = { mu = 0.5; }; b = { };", "mu = 0.2;", "{ of = (\"lid\", \"a\"); mu = 0.1; }", {0.1, 0.2}},
        {"a = { mu = 0.5; }; b = { };", "", "{ of = (\"b\", \"lid\"); mu = 0.15; }", {0.5, 0.15}}};
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        scoped_sim *sim =
            grains_after_text(400,
                              "dt = 1e-5; tangential = { law = \"spring\"; mu = 0.3; }; pairs_rule = "
                              "\"smaller\"; kinds = { %s };\n"
                              "normal = { tension = false; }; walls = ( { name = \"lid\"; point = [0.0, "
                              "0.0]; direction = [0.0, 1.0]; %s } );\npairs = ( %s );\n"
                              "particles = ( { kind = \"a\"; x = 0.0; y = 0.0999; r = 0.1; vx = 40.0; },\n"
                              "  { kind = \"b\"; x = 3.0; y = 0.0999; r = 0.1; vx = 40.0; } );\n",
                              cases[k].kinds, cases[k].walls, cases[k].pairs);
        size_t n;
        scoped dem_contact *c = grains_contacts(sim, &n);
        CU_ASSERT_FATAL(n == 2);
        for (size_t i = 0; i < 2; i++)
            CHECK_NEAR(fabs(c[i].shear_force) / c[i].normal_force, cases[k].mu[c[i].id_a - 1], 1e-12);
    }
}

/* ---- the order of what is listed ---- */

static const char ordered[] =
    "dt = 5e-6; rotation = true; tangential = { law = \"spring\"; gamma_s = 40.0; mu = 0.3; };\n"
    "normal = { law = \"tsuji\"; restitution = 0.7; tension = false; };\n"
    "kinds = { %s };\npairs = ( %s );\n"
    "walls = ( { name = \"lid\"; mu = 0.25; point = [0.0, 0.0]; direction = [0.0, 1.0]; } );\n"
    "fill = ( { kind = \"%s\"; N = 30; W = 1.0; H = 3.0; }, { kind = \"%s\"; N = 30; W = 1.0; x0 = 1.0; H = "
    "3.0; } );\n";

static void order(void)
{
    scoped_sim *
        one = grains_after_text(
           4000, ordered, "a = { mu = 0.1; k_n = 2e6; }; b = { restitution = 0.5; };",
           "{ of = (\"a\", \"b\"); mu = 0.2; restitution = 0.6; }, { of = (\"lid\", \"a\"); mu = 0.15; }",
           "a", "b"),
       *two = grains_after_text(
           4000, ordered, "first = { restitution = 0.5; }; z = { k_n = 2e6; mu = 0.1; };",
           "{ of = (\"z\", \"lid\"); mu = 0.15; }, { of = (\"first\", \"z\"); restitution = 0.6; mu = 0.2; }",
           "z", "first");
    CU_ASSERT(grains_same_bits(one, two) && grains_energies(one).elastic > 0.0);
}

/* Grains in another order are the same, each with its kind, up to the order of sums. */
static void permuted(void)
{
    enum { N = 60, STEPS = 4000 };
    dem_grain *grains;
    dem_definition def = mixed(N, 1.0, 3, &grains);
    def.rotation = true, def.dt = 2e-5, mix(&def);
    scoped_sim *one = grains_after(&def, STEPS);
    scoped dem_state *s = grains_states(one);
    dem_grain turned[N];
    for (int i = 0; i < N; i++) turned[(7 * i + 3) % N] = grains[i];
    def.grains = turned;
    scoped_sim *two = grains_after(&def, STEPS);
    scoped dem_state *t = grains_states(two);
    for (int i = 0; i < N; i++) {
        const dem_state *a = &s[i], *b = &t[(7 * i + 3) % N];
        CU_ASSERT(a->kind == b->kind);
        CHECK_NEAR(hypot(a->x - b->x, a->y - b->y), 0.0, 1e-9); /* rounding, not yet chaos */
    }
}

/* ---- what is said ---- */

static void refused(void)
{
    static const struct {
        const char *kinds, *pairs, *message;
    } cases[] = {
        {"a = { mu = 0.1; }; b = { mu = 0.6; };", "",
         "kind \"b\" has mu = 0.6, and kind \"a\" 0.1: say what their contacts have, pairs = ( { of = "
         "(\"b\", "
         "\"a\"); mu = ...; } ); or pairs_rule"},
        {"a = { mu = 0.1; }; b = { };", "", "kind \"b\" has mu = 0.3, and kind \"a\" 0.1"},
        {"a = { restitution = 0.5; }; b = { };", "", "restitution"},
        {"a = { gamma_n = 3; }; b = { };", "", "restitution = 0.7, and kind \"a\" auto"},
        {"a = { mu_roll = 0.1; }; b = { };", "", "mu_roll"},
        {"a = { mu = 0.3; }; b = { };", "{ of = (\"a\", \"c\"); mu = 0.1; }",
         "no kind or wall is called \"c\""},
        {"a = { mu = 0.3; }; b = { };", "{ of = (\"a\", \"lif\"); mu = 0.1; }", "did you mean \"lid\""},
        {"a = { mu = 0.3; }; b = { };", "{ of = (\"a\", 3); mu = 0.1; }",
         "two kinds, or a kind and a wall, expected"},
        {"a = { mu = 0.3; }; b = { };", "{ of = (\"a\"); mu = 0.1; }",
         "two kinds, or a kind and a wall, expected"},
        {"a = { mu = 0.3; }; b = { };", "{ of = (\"a\", \"b\"); nu = 0.1; }", "nu: does not belong here"},
        {"a = { mu = 0.3; }; b = { };", "{ of = (\"a\", \"b\"); restitution = 0.5; gamma_n = 1.0; }",
         "give one, the other"},
        {"a = { mu = 0.3; }; lid = { }; b = { };", "{ of = (\"a\", \"lid\"); mu = 0.1; }",
         "lid names a wall and a kind"},
        {"a = { E = 1e9; }; b = { };", "", "E, nu: of a kind need the scene's"},
        {"a = { law = \"linear\"; }; b = { };", "", "law: does not belong here"},
        {"a = { material = { k_n = 1.0; }; }; b = { };", "", "k_n: "},
        {"a = 3;", "", "a group"},
        {"a = { mu = 0.3; };", "", "kind = \"b\": none of `kinds`; one with"},
        {"a = { mu = 0.3; material = { mu = 0.2; }; }; b = { };", "", "mu: given twice"},
        {"a = { mu = 0.3; }; b = { };",
         "{ of = (\"a\", \"b\"); mu = 0.1; }, { of = (\"b\", \"a\"); mu = 0.2; }", "twice"},
        {"a = { mu = 0.3; };", "{ of = (\"a\", \"b\"); mu = -1.0; }", "mu"}};
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++)
        grains_refused(check_text(ordered, cases[k].kinds, cases[k].pairs, "a", "b"), NULL, cases[k].message);
    grains_refused(
        check_text(ordered, "a = { mu = 0.1; }; b = { };", "{ of = (\"a\", \"b\"); mu = 0.2; }", "a", "b"),
        NULL, "kind \"a\" has mu = 0.1, and wall \"lid\" 0.25");
    grains_refused(
        check_text("pairs = ( { of = (\"a\", \"b\"); mu = 0.2; } ); fill = { N = 1; W = 1.0; H = 1.0; };"),
        NULL, "no grains have a kind");
    dem_grain *grains;
    dem_sim *sim;
    dem_definition def = mixed(9, 1.0, 1, &grains);
    mix(&def), def.hard = (dem_hard){true, 0.5, 0.3}, def.tension = false;
    CHECK_FAILS(dem_create(&def, &sim), RP_BAD_INPUT, "hard: its collisions are alike");
    def.hard.on = false, ((dem_material *)def.pairs)[KINDS + 2].mu = 0.9;
    CHECK_FAILS(dem_create(&def, &sim), RP_BAD_INPUT, "differ by their order");
    mix(&def), grains[4].kind = KINDS;
    CHECK_FAILS(dem_create(&def, &sim), RP_BAD_INPUT, "particle 5: kind = 3: there are 3");
}

/* A friction in a fill names where it belongs; kinds that meet differ in friction until pairs or a rule say
 * it. */
static void friction_of_a_fill(void)
{
    static const char field[] =
        "dt = 5.0e-5; steps = 10; tangential = { law = \"spring\"; mu = 0.3; }; %s\n"
        "walls = ( { polygon = ( [0.0, 20.0], [0.0, 0.0], [4.0, 0.0], [4.0, 20.0] ); closed = false; } );\n"
        "fill = ( { kind = \"steel\"; %s N = 50; W = 2.0; H = 6.0; }, { kind = \"sand\"; N = 50; W = 2.0; x0 "
        "= 2.0; H = 6.0; } );\n";
    static const char kinds[] = "kinds = { steel = { mu = 0.1; }; sand = { mu = 0.6; }; };";
    scoped_scene scene = {0}, ruled = {0};
    grains_refused(check_text(field, "", "mu = 0.1;"), NULL, "kinds = { steel = { mu = ...; }; }");
    grains_refused(check_text(field, kinds, ""), NULL, "mu = 0.6, and kind \"steel\" 0.1");
    grains_refused(
        check_text(field, "pairs_rule = \"smaller\"; kinds = { steel = { gamma_s = 3.0; }; sand = { }; };",
                   ""),
        NULL, "; } ); pairs_rule needs both values");
    scoped_sim *sim = grains_scene_after(
                   check_text(field,
                              check_text("%spairs = ( { of = (\"steel\", \"sand\"); mu = 0.2; } );", kinds),
                              ""),
                   10, &scene),
               *by_rule = grains_scene_after(
                   check_text(field, check_text("%spairs_rule = \"geometric\";", kinds), ""), 10, &ruled);
    CHECK_PAIRS(1e-15, {dem_pair_material(&sim->def, 1, 2)->mu, 0.2},
                {dem_pair_material(&sim->def, 1, 1)->mu, 0.1}, {dem_pair_material(&sim->def, 2, 2)->mu, 0.6},
                {dem_material_at(&sim->def, 1, 2)->mu, 0.6},
                {dem_pair_material(&by_rule->def, 2, 1)->mu, sqrt(0.06)});
}

/* Grains of particles, of a table by name or number, and their masses. */
static void listed(void)
{
    static const char text[] = "dt = 1e-5; kinds = { a = { density = 3.0; k_n = 2e6; }; b = { }; }; %s";
    static const double parts[] = {3.0, 1.0, 1.0};
    for (int table = 0; table < 2; table++) {
        scoped_scene s = {0};
        char folder[FOLDER_PATH];
        folder_make("kinds", folder);
        file_text(folder_path(folder, "p.tsv"), "x\ty\tr\tkind\n0\t0\t0.1\ta\n1\t0\t0.1\t2\n2\t0\t0.1\t0\n");
        CHECK_OK(grains_read_as(
            &s, text,
            table ? check_text("particles_file = \"%s/p.tsv\";", folder)
                  : "particles = ( { kind = \"a\"; x = 0.0; y = 0.0; r = 0.1; }, { kind = \"b\"; x = 1.0; "
                    "y = 0.0; r = 0.1; }, { x = 2.0; y = 0.0; r = 0.1; } );"));
        CU_ASSERT(s.def.n_kinds == 3 && s.grains[0].kind == 1 && s.grains[1].kind == 2 &&
                  s.grains[2].kind == 0);
        for (int i = 0; i < 3; i++) CHECK_NEAR(s.grains[i].m, dem_mass(DEM_SPHERE, parts[i], 0.1), 1e-15);
        folder_remove(folder);
    }
}

/* ---- time step, phases ---- */

/* The limit is that of the stiffest contact that there is, pairs and walls among them. */
static void limits(void)
{
    dem_grain two[2] = {{.r = 0.1, .m = 0.004, .kind = 1}, {.x = 1.0, .r = 0.1, .m = 0.006, .kind = 2}};
    dem_material pairs[KINDS * (KINDS + 1)];
    dem_limit_name what;
    dem_definition def = grains_bare(2, two, DEM_LINEAR, (dem_material){.k_n = 1e6, .gamma_n = 500.0}),
                   stiff = def;
    def.walls[0] = stiff.walls[0] = grains_line(0.0, -5.0, 0.0, 1.0, &def.material);
    def.n_walls = stiff.n_walls = 1, def.n_kinds = stiff.n_kinds = KINDS, def.kinds = stiff.kinds = names,
    def.pairs = pairs;
    for (size_t k = 0; k < KINDS * (KINDS + 1); k++) pairs[k] = def.material;
    CHECK_NEAR(dem_time_step_limit(&def, NULL), dem_time_step_limit(&stiff, NULL), 0.0);
    pairs[0].k_n = pairs[KINDS * KINDS].k_n = 1e9; /* of a kind without grains */
    CHECK_NEAR(dem_time_step_limit(&def, NULL), dem_time_step_limit(&stiff, NULL), 0.0);
    pairs[2 * KINDS + 1].k_n = pairs[KINDS + 2].k_n = stiff.material.k_n = 4e6;
    CHECK_NEAR(dem_time_step_limit(&def, what), dem_time_step_limit(&stiff, NULL), 0.0);
    CU_ASSERT(strstr(what, "kinds \"sand\" and \"steel\"") != NULL);
    pairs[KINDS * KINDS + 2].k_n = 9e7, stiff.walls[0].material.k_n = 9e7, two[0].m = 0.006;
    CHECK_NEAR(dem_time_step_limit(&def, what), dem_time_step_limit(&stiff, NULL), 0.0);
    CU_ASSERT(strstr(what, "kind \"sand\" at wall 1") != NULL);
}

static const char changing[] =
    "dt = 1e-5; tangential = { law = `spring`; mu = 0.3; };\n"
    "kinds = { a = { mu = 0.1; }; b = { }; c = { }; }; pairs = ( { of = (`a`, `b`); mu = 0.2; } );\n"
    "walls = ( { name = `lid`; point = (0.0, 0.0); direction = (0.0, 1.0); } );\n"
    "fill = ( { kind = `a`; N = 5; W = 2.0; H = 2.0; }, { kind = `b`; N = 5; W = 2.0; H = 2.0; } );\n"
    "phases = ( { name = `one`; steps = 10; },\n"
    "  { name = `two`; kinds = { a = { k_n = 3e6; }; b = { mu = 0.4; }; }; steps = 10; },\n"
    "  { name = `three`; add = { kind = `c`; r = 0.1; x = 1.0; y = `touch + 1`; }; steps = 10; },\n"
    "  { name = `four`; kinds = { c = { mu = 0.3; }; }; pairs = ( { of = (`b`, `lid`); mu = 0.7; } ); steps "
    "= 10; } );\n"
    "pairs_rule = `smaller`;\n";

/* A phase changes what kinds and pairs say, from there on. */
static void phases(void)
{
    RUN_TRIAL(t, changing, 7, "ok");
    const dem_definition *def = &exp_sim(t.run)->def;
    CU_ASSERT(def->n_kinds == 4 && dem_count(exp_sim(t.run)) == 11);
    CHECK_PAIRS(1e-14, {dem_pair_material(def, 1, 1)->k_n, 3e6}, {dem_pair_material(def, 1, 2)->k_n, 1.5e6},
                {dem_pair_material(def, 1, 2)->mu, 0.2}, {dem_pair_material(def, 2, 2)->mu, 0.4},
                {dem_pair_material(def, 2, 3)->mu, 0.3}, {dem_material_at(def, 0, 1)->k_n, 6e6},
                {dem_material_at(def, 0, 2)->mu, 0.7}, {dem_material_at(def, 0, 1)->mu, 0.1});
    static const trial_change changes[] = {
        {changing, "b = { mu = 0.4; }", "d = { mu = 0.4; }", "no grains are of the kind d"},
        {changing, "k_n = 3e6", "density = 3.0", "density: of a grain that is there"},
        {changing, "pairs_rule = `smaller`;", "", "kind \"c\" has mu = 0.3, and kind \"a\" 0.1"}};
    check_refused(sizeof changes / sizeof *changes, changes);
}

/* ---- another program ---- */

/* One of three values, or none. */
static double one_of(gsl_rng *rng, double share, double a, double b, double c)
{
    const double values[] = {a, b, c}, value = values[gsl_rng_uniform_int(rng, 3)];
    return gsl_rng_uniform(rng) < share ? value : NAN;
}

static twin_values draw(gsl_rng *rng, bool bodies, double share)
{
    return (twin_values){.density = one_of(rng, share, 0.8, 1.3, 2.7),
                         .E = bodies ? one_of(rng, share, 1.3e7, 4.1e7, 9.7e7) : NAN,
                         .nu = bodies ? one_of(rng, share, 0.11, 0.23, 0.37) : NAN,
                         .k_n = bodies ? NAN : one_of(rng, share, 3.1e5, 8.7e5, 1.9e6),
                         .k_s = bodies ? NAN : one_of(rng, share, 1.3e5, 2.9e5, 6.1e5),
                         .restitution = one_of(rng, share, 0.31, 0.55, 0.83),
                         .mu = one_of(rng, share, 0.0, 0.25, 0.7),
                         .mu_roll = one_of(rng, share, 0.0, 0.04, 0.15)};
}

/* Two values that differ need one for both, unless a rule gives it. */
static void settle(gsl_rng *rng, const twin_scene *t, double a, double b, double *of_two, double value)
{
    const bool differ = !isnan(a) && !isnan(b) && a != b;
    if ((differ && t->rule == 0) || gsl_rng_uniform(rng) < 0.2) *of_two = value;
}

static void draw_pair(gsl_rng *rng, twin_scene *t, int a, int b)
{
    const twin_values none = draw(rng, false, 0.0), *scene = t->kind;
    twin_values first = t->kind[a], other = b < TWIN_KINDS ? t->kind[b] : t->wall[b - TWIN_KINDS], two = none;
    double *const x = (double *)&first, *const y = (double *)&other;
    if (b >= TWIN_KINDS && a == 0) first = none; /* what the scene says, a wall may say otherwise */
    for (size_t k = 0; b < TWIN_KINDS && k < sizeof none / sizeof *x; k++) {
        if (isnan(x[k])) x[k] = ((const double *)scene)[k];
        if (isnan(y[k])) y[k] = ((const double *)scene)[k];
    }
    settle(rng, t, first.restitution, other.restitution, &two.restitution, 0.47);
    settle(rng, t, first.mu, other.mu, &two.mu, 0.33);
    settle(rng, t, first.mu_roll, other.mu_roll, &two.mu_roll, 0.09);
    if (gsl_rng_uniform(rng) < 0.1) two.k_n = t->bodies ? 2.3e7 : 6.1e5;
    t->pair[a][b] = two;
    if (b < TWIN_KINDS) t->pair[b][a] = two;
}

static void draw_scene(gsl_rng *rng, twin_scene *t)
{
    const double lines[TWIN_WALLS][4] = {{0, 0, 0, 1}, {0, 0, 1, 0}, {1, 0, -1, 0}};
    *t = (twin_scene){
        .rule = (int)gsl_rng_uniform_int(rng, 3), .dt = 4e-7, .g = 981.0, .gamma_s = 40.0, .n = 9};
    t->bodies = gsl_rng_uniform(rng) < 0.5, t->wide = gsl_rng_uniform(rng) < 0.5;
    t->n_kinds = 2 + (int)gsl_rng_uniform_int(rng, 4);
    memcpy(t->line, lines, sizeof lines);
    for (int k = 0; k < t->n_kinds; k++) t->kind[k] = draw(rng, t->bodies, k ? 0.5 : 1.0);
    for (int w = 0; w < TWIN_WALLS; w++) t->wall[w] = draw(rng, t->bodies, 0.3), t->wall[w].density = NAN;
    for (int a = 0; a < t->n_kinds; a++) {
        for (int b = a; b < t->n_kinds; b++) draw_pair(rng, t, a, b);
        for (int w = 0; w < TWIN_WALLS; w++) draw_pair(rng, t, a, TWIN_KINDS + w);
    }
    for (int i = 0; i < t->n; i++)
        t->grain[i] = (twin_grain){.x = 0.17 + 0.33 * (i % 3) + 0.02 * gsl_rng_uniform(rng),
                                   .y = 0.16 + 0.31 * (i / 3) + 0.02 * gsl_rng_uniform(rng),
                                   .r = 0.08 + 0.06 * gsl_rng_uniform(rng),
                                   .vx = 300.0 * (gsl_rng_uniform(rng) - 0.5),
                                   .vy = 300.0 * (gsl_rng_uniform(rng) - 0.5),
                                   .omega = 400.0 * (gsl_rng_uniform(rng) - 0.5),
                                   .kind = i % t->n_kinds};
}

static void put(FILE *to, const twin_values *v)
{
    static const char *const keys[] = {"density", "E", "nu", "k_n", "k_s", "restitution", "mu", "mu_roll"};
    for (size_t k = 0; k < sizeof keys / sizeof *keys; k++)
        if (!isnan(((const double *)v)[k])) fprintf(to, "%s = %.17g; ", keys[k], ((const double *)v)[k]);
}

static void put_of(FILE *to, const twin_values *v, const char *a, const char *b)
{
    fprintf(to, "%s{ of = (\"%s\", \"%s\"); ", *a || *b ? "," : "", a, b), put(to, v), fputs("}\n", to);
}

static void write_scene(const twin_scene *t, FILE *to)
{
    static const char *const kind[TWIN_KINDS] = {"", "a", "b", "c", "d"},
                             *const wall[TWIN_WALLS] = {"low", "left", "right"},
                             *const rules[] = {"equal", "smaller", "geometric"};
    const twin_values *s = t->kind;
    fprintf(to, "dt = %.17g; rotation = true; density = %.17g; pairs_rule = \"%s\";\n", t->dt, s->density,
            rules[t->rule]);
    fprintf(to, "rolling = { mu = %.17g; arm = \"%s\"; };\n", s->mu_roll, t->wide ? "radius" : "reduced");
    if (t->bodies)
        fprintf(to, "material = { E = %.17g; nu = %.17g; restitution = %.17g; mu = %.17g; };\n", s->E, s->nu,
                s->restitution, s->mu);
    else
        fprintf(to,
                "normal = { law = \"linear\"; k_n = %.17g; restitution = %.17g; tension = false; };\n"
                "tangential = { law = \"spring\"; k_s = %.17g; gamma_s = %.17g; mu = %.17g; };\n",
                s->k_n, s->restitution, s->k_s, t->gamma_s, s->mu);
    fputs("kinds = { ", to);
    for (int k = t->n_kinds - 1; k > 0; k--)
        fprintf(to, "%s = { ", kind[k]), put(to, &t->kind[k]), fputs("};\n", to);
    fputs("};\nwalls = ( ", to);
    for (int w = 0; w < TWIN_WALLS; w++) {
        const double *l = t->line[w];
        fprintf(to, "%s{ name = \"%s\"; point = [%.1f, %.1f]; direction = [%.1f, %.1f]; ", w ? "," : "",
                wall[w], l[0], l[1], l[2], l[3]);
        put(to, &t->wall[w]), fputs("}\n", to);
    }
    fputs(");\npairs = ( ", to);
    for (int a = 0; a < t->n_kinds; a++) {
        for (int b = a; b < t->n_kinds; b++) put_of(to, &t->pair[a][b], kind[a], kind[b]);
        for (int w = 0; w < TWIN_WALLS; w++) put_of(to, &t->pair[a][TWIN_KINDS + w], wall[w], kind[a]);
    }
    fputs(" );\nparticles = ( ", to);
    for (int i = 0; i < t->n; i++) {
        const twin_grain *g = &t->grain[i];
        fprintf(
            to,
            "%s{ x = %.17g; y = %.17g; r = %.17g; vx = %.17g; vy = %.17g; omega = %.17g; kind = \"%s\"; }\n",
            i ? "," : "", g->x, g->y, g->r, g->vx, g->vy, g->omega, kind[g->kind]);
    }
    fputs(");\n", to);
}

/* Largest difference of places, and of angles times radii, from another of them or from states. */
static double apart(const twin_scene *t, const twin_scene *other, const dem_state *s)
{
    double most = 0.0;
    for (int i = 0; i < t->n; i++) {
        const twin_grain *g = &t->grain[i];
        const double x = s ? s[i].x : other->grain[i].x, y = s ? s[i].y : other->grain[i].y,
                     angle = s ? s[i].angle : other->grain[i].angle;
        most = fmax(most, fmax(hypot(g->x - x, g->y - y), g->r * fabs(g->angle - angle)));
        if (isnan(g->x + g->y + g->angle + x + y + angle)) return INFINITY;
    }
    return most;
}

/* Random scenes of up to four kinds agree with the second program to 1e-12, until a change of 1e-13 has
 * become ten times as large there: collisions then amplify rounding too. */
static void second_program(void)
{
    const int scenes = check_fast() ? 30 : 300;
    scoped_rng *rng = numbers_of(64, 0);
    int compared = 0, whole = 0;
    for (int k = 0; k < scenes; k++) {
        twin_scene start;
        scoped char *text = NULL;
        size_t size;
        draw_scene(rng, &start);
        FILE *to = open_memstream(&text, &size);
        write_scene(&start, to);
        fclose(to);
        scoped_sim *sim = grains_of_text(0, text);
        for (long steps = 250; steps <= 4000; steps *= 2) {
            twin_scene one = start, two = start;
            two.grain[0].x += 1e-13;
            twin_run(&one, steps), twin_run(&two, steps);
            CHECK_OK(dem_run(sim, steps - dem_step(sim)));
            scoped dem_state *s = grains_states(sim);
            if (!(apart(&one, &two, NULL) <= 1e-12)) break;
            CHECK_OR_SAY(apart(&one, NULL, s) <= 1e-12, "scene %d, step %ld: %g apart\n%s", k, steps,
                         apart(&one, NULL, s), text);
            compared++, whole += steps == 4000;
        }
    }
    CU_ASSERT(compared > 3 * scenes && whole > scenes / 4);
}

CHECK_SUITE(kinds, "kinds", alike, labels, kernels, by_threads, kept, rebound, moduli, at_walls, order,
            permuted, refused, friction_of_a_fill, listed, limits, phases, second_program)
