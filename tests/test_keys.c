/* Every key of a scene file, of a phase and of a protocol matters: changing it changes the result of some run
 * below. So does every word of a key that takes words. A key that is read and then ignored fails here, and a
 * new key without a run that it changes as well. Keys that change no result by design are listed, with the
 * reason. */
#include "tests/grains.h"
#include "tests/protocol.h"
#include "tests/trial.h"

enum { MOST_CANDIDATES = 24 };

static const struct {
    const char *group, *key, *reason;
} exceptions[] = {{"scene", "kernel", "every pair loop gives the same bits: suite laws"},
                  {"scene", "particles_file", "stands instead of the particles: suite scene"},
                  {"scene", "compressed", "lets start what is refused without it: suite wrong"},
                  {"scene", "particles_step", "of a table: suite scene"},
                  {"scene", "contacts_file", "of a table: suite scene"},
                  {"walls", "name", "says which walls act together: suite experiment"},
                  {"fill", "kind", "says whose grains they are: suite experiment"},
                  {"fill", "radius_law", "a table needs its radii: suite scene"},
                  {"output", "states", "frames, as the next three: suite command line"},
                  {"output", "energy", "frames"},
                  {"output", "contacts", "frames"},
                  {"output", "walls", "frames"}};

static bool is_exception(const char *group, const char *key)
{
    bool is = false;
    for (size_t i = 0; i < sizeof exceptions / sizeof *exceptions; i++)
        is |= strcmp(exceptions[i].group, group) == 0 && strcmp(exceptions[i].key, key) == 0;
    return is;
}

/* Values to try instead of `now`: words of the range, or numbers near `now` and of several magnitudes. */
typedef struct {
    size_t n;
    char text[MOST_CANDIDATES][128];
} candidates;

static void add(candidates *c, const char *text)
{
    if (c->n < MOST_CANDIDATES) snprintf(c->text[c->n++], sizeof c->text[0], "%s", text);
}

static candidates find_candidates(const rp_param *p, const char *now)
{
    static const char *const reals[] = {"0.3", "0.05", "0.2",  "7",   "0.9",  "1.5", "0.02",
                                        "40",  "-2",   "0.09", "3e3", "1e-3", "1e5"},
                             *const whole[] = {"2", "1", "3", "7", "40", "300", "5000"};
    candidates c = {0};
    char *end, text[64];
    const double value = strtod(now, &end);
    if (p->type == RP_BOOL) {
        add(&c, "true");
        add(&c, "false");
    } else if (p->type == RP_CHOICE) {
        const char *words = p->range;
        for (char word[128]; check_word(&words, "| ", word);) add(&c, word);
    } else {
        const bool real = p->type == RP_REAL;
        for (int k = 0; k < 3 && *now && !*end; k++) {
            const double near = value * (k == 0 ? 1.25 : k == 1 ? 0.5 : 2.0);
            snprintf(text, sizeof text, real ? "%.10g" : "%.0f", near);
            if (near != value && strcmp(text, now) != 0) add(&c, text);
        }
        for (size_t k = 0; k < (real ? sizeof reals : sizeof whole) / sizeof *reals; k++)
            add(&c, real ? reals[k] : whole[k]);
    }
    return c;
}

/* ---- scenes ---- */

#define WALLS                                                                                                \
    "walls = ( { point = [0.0, 0.0]; direction = [0.0, 1.0]; },\n"                                           \
    "          { point = [1.0, 0.0]; direction = [-1.0, 0.0]; },\n"                                          \
    "          { point = [0.0, 0.0]; direction = [1.0, 0.0]; } );\n"
/* The first slides along the floor against the second, and may roll; the third falls on both. */
#define GRAINS(spin)                                                                                         \
    "particles = ( { x = 0.3; y = 0.0998; r = 0.1; vx = 30.0;" spin " },\n"                                  \
    "              { x = 0.51; y = 0.1; r = 0.11; }, { x = 0.37; y = 0.29; r = 0.09; vy = -5.0; } );\n"
#define MIXED                                                                                                \
    "particles = ( { kind = \"a\"; x = 0.3; y = 0.0998; r = 0.1; vx = 30.0; omega = 90.0; },\n"              \
    "  { kind = \"b\"; x = 0.51; y = 0.1; r = 0.11; }, { kind = \"a\"; x = 0.37; y = 0.29; r = 0.09; } );\n"
#define SPIN     " omega = 90.0;"
#define FRICTION "tangential = { law = \"spring\"; mu = 0.3; };\n"

#define FLOOR "walls = ( { point = [0.0, 0.0]; direction = [0.0, 1.0]; } );\n"
#define SOFT  "normal = { law = \"linear\"; k_n = 1.0e5; "

static const char *const scenes[] = {
    "rotation = true; steps = 300; normal = { k_n = 1.0e5; }; rolling = { mu = 0.05; };\n" FRICTION WALLS
        GRAINS(SPIN),
    "rotation = true; steps = 300; ledger = true; normal = { restitution = 0.4; restitution_speed = 60.0; }; "
    "rolling = { };\n"
    "gravity_turn_deg_per_step = 0.01;\n"
    "tangential = { law = \"spring\"; mu = 0.1; damping = \"inside\"; gamma_s = 300.0; };\n" WALLS GRAINS(
        SPIN),
    "rotation = true; steps = 300; box_turn_deg_per_step = 0.01;\n" FRICTION SOFT
    "gamma_n = 300.0; };\n" WALLS GRAINS(SPIN),
    "steps = 400; normal = { law = \"tsuji\"; gamma_n = 0.3; };\n"
    "walls = ( { point = [0.0, 0.0]; direction = [0.0, 1.0]; extent = [-9.0, 9.0]; open_at_step = 100;\n"
    "            open_speed = 20.0; } );\n" GRAINS(""),
    "rotation = true; steps = 400; tangential = { law = \"slip_roll\"; gamma_s = 31.0; mu = 0.07; };\n" SOFT
    "tension = false; };\n" WALLS GRAINS(
        SPIN) "ground = { mu_static = 0.4; a = 0.013; set = \"touch\"; }; hard = { restitution = 0.3; };\n",
    "integrator = \"implicit\"; dt = 2e-4; steps = 200; implicit = { solver = \"sor\"; };\n" SOFT
    "};\n" WALLS GRAINS(""),
    "steps = 300; normal = { }; tangential = { }; fill = { N = 12; W = 1.0; H = 1.2; };\n" WALLS,
    "steps = 300; fill = { N = 3; W = 1.0; H = 1.2; };\n" WALLS,
    "rotation = true; steps = 300; normal = { k_n = 1.0e5; }; rolling = { mu = 0.001; };\n" FRICTION WALLS
        GRAINS(SPIN),
    /* E as of the candidates up to 1e5; the first lies on the floor */
    "steps = 300; gravity = [0.0, -20.0]; rotation = true; dt = 1.0e-4; material = { E = 1.0e5; nu = 0.3; "
    "restitution = 0.6; mu = 0.3; };\n" WALLS GRAINS(SPIN),
    "steps = 300; fill = { pattern = \"lattice\"; W = 1.0; H = 1.2; radius_width = 0.0; };\n" WALLS,
    /* where the segment ends, the grain is carried by its corner or, with a turn, not yet */
    "steps = 300; walls = ( { point = [0.0, 0.0]; direction = [0.0, 1.0]; extent = [-1.0, 0.3]; } );\n"
    "particles = ( { x = 0.31; y = 0.09; r = 0.1; }, { x = -1.01; y = 0.09; r = 0.1; } );\n",
    "steps = 300; walls = ( { circle = [0.0, 0.0, 1.0]; sides = 12; omega = 3.0; } );\n" FRICTION
    "particles = ( { x = 0.0; y = -0.87; r = 0.1; }, { x = 0.2; y = -0.84; r = 0.1; } );\n",
    "steps = 300; walls = ( { polygon = ( [0.0, 1.0], [0.0, 0.0], [1.0, 1.0] ); closed = false; } "
    ");\n" FRICTION "particles = ( { x = 0.3; y = 0.9; r = 0.1; vy = 40.0; } );\n",
    "steps = 9000; gravity_turn_deg_per_step = 0.01; turn_from_step = 5000;\n"
    "tangential = { law = \"slip_roll\"; gamma_s = 31.0; mu = 0.07; };\n" SOFT
    "gamma_n = 400.0; }; ground = { mu_static = 0.4; a = 1e-4; };\n" FLOOR
    "particles = ( { x = 0.3; y = 0.1; r = 0.1; } );\n",
    /* kinds: what two of them have is said, or by a rule */
    "rotation = true; steps = 300; kinds = { a = { }; b = { }; }; rolling = { mu = 0.05; };\n"
    "pairs = ( { of = (\"a\", \"b\"); gamma_s = 5.0; gamma_roll = 5.0; mu = 0.2; mu_roll = 0.03; } "
    ");\n" FRICTION SOFT "gamma_n = 300.0; };\n" WALLS MIXED,
    "rotation = true; steps = 300; kinds = { a = { mu = 0.1; }; b = { }; }; rolling = { mu = 0.05; };\n"
    "pairs_rule = \"smaller\"; pairs = ( { of = (\"a\", \"b\"); gamma_n = 200.0; } );\n" FRICTION SOFT
    "gamma_n = 300.0; };\n" WALLS MIXED,
    "steps = 300; gravity = [0.0, -20.0]; rotation = true; dt = 1.0e-4; material = { E = 1.0e5; nu = 0.3; "
    "restitution = 0.6; mu = 0.3; };\npairs_rule = \"geometric\"; kinds = { a = { mu = 0.1; }; b = { }; "
    "};\n" WALLS MIXED};
enum { N_SCENES = sizeof scenes / sizeof *scenes };

/* All tables of the scene's end; NULL if the scene is refused. A run that fails has a result: its end. */
static char *outcome(const char *text, const char *change)
{
    const rp_texts changes = {1, {change}};
    scoped_scene scene = {0};
    scoped_sim *sim = NULL;
    rp_status status = grains_read(text, change ? &changes : NULL, &scene);
    if (!status) status = dem_scene_start(&scene, &sim);
    char *tables = NULL;
    size_t size;
    if (!status) {
        FILE *to = open_memstream(&tables, &size);
        fprintf(to, "%d\n", (int)dem_run(sim, scene.steps));
        dem_write_rows(DEM_TABLE_STATES, sim, dem_step(sim), to);
        dem_write_rows(DEM_TABLE_CONTACTS, sim, dem_step(sim), to);
        CHECK_OK(dem_write_rows(DEM_TABLE_ENERGY, sim, dem_step(sim), to));
        scoped double *forces = calloc(2 * scene.def.n_walls + 1, sizeof *forces);
        CU_ASSERT_PTR_NOT_NULL_FATAL(forces);
        grains_wall_forces(sim, forces);
        for (size_t w = 0; w < 2 * scene.def.n_walls; w++) fprintf(to, "%.17g\t", forces[w]);
        fclose(to);
    }
    return tables;
}

/* Whether the scene's result changes with the key. */
static bool scene_changes(size_t scene, const char *base, const char *path, const char *value)
{
    scoped char *now = outcome(scenes[scene], check_text("%s=%s", path, value));
    return now && strcmp(now, base) != 0;
}

static void check_scene_key(char *const bases[], const char *group, const rp_param *p)
{
    const bool list = strstr("walls particles pairs", group) != NULL;
    const char *form = strcmp(group, "scene") == 0   ? "%.0s%s"
                       : strcmp(group, "kinds") == 0 ? "%s.a.%s"
                       : list                        ? "%s.[0].%s"
                                                     : "%s.%s";
    scoped char *path = strdup(check_text(form, group, p->name));
    const candidates c = find_candidates(p, p->fallback ? p->fallback : "");
    const bool words = p->type == RP_CHOICE;
    size_t matter = 0;
    bool good = true;
    for (size_t k = 0; k < c.n && (words || matter == 0); k++) {
        bool differs = false;
        for (size_t s = 0; s < N_SCENES && !differs; s++)
            differs = scene_changes(s, bases[s], path, c.text[k]);
        matter += differs;
        /* one word may be that of every scene, from which the others then differ: the default, or one that
         * stands there */
        bool stands = words && p->fallback && strcmp(c.text[k], p->fallback) == 0;
        for (size_t s = 0; s < N_SCENES && words; s++)
            stands |= strstr(scenes[s], check_text("%s = \"%s\"", p->name, c.text[k])) != NULL;
        good &= !words || differs || stands;
    }
    good &= words ? matter + 1 >= c.n : matter > 0;
    CHECK_OR_SAY(good, "%s.%s: %zu of %zu values change a scene", group, p->name, matter, c.n);
}

static void test_scene_keys(void)
{
    char *bases[N_SCENES];
    for (size_t s = 0; s < N_SCENES; s++) {
        bases[s] = outcome(scenes[s], NULL);
        if (!bases[s]) fprintf(stderr, "scene %zu: %s\n", s, rp_message());
        CU_ASSERT_PTR_NOT_NULL_FATAL(bases[s]);
    }
    for (const dem_scene_group *g = dem_scene_schemas; g->name; g++)
        for (const rp_param *p = g->schema; p->name; p++)
            if (!is_exception(g->name, p->name)) check_scene_key(bases, g->name, p);
    for (size_t s = 0; s < N_SCENES; s++) free(bases[s]);
}

/* ---- phases ---- */

/* A grain falls onto the floor, another lies on the gate. */
static const char phases[] =
    "dt = 1.0e-4; gravity = (0.0, -1000.0); regions = { right = { x = (4.0, 6.0); }; };\n"
    "walls = ( { point = (0.0, 0.0); direction = (0.0, 1.0); },\n"
    "  { name = `gate`; point = (5.0, 1.0); direction = (0.0, 1.0); extent = (-0.5, 0.5); } );\n"
    "particles = ( { x = 0.0; y = 0.4; r = 0.1; m = 0.01; }, { x = 5.0; y = 1.1; r = 0.1; m = 0.01; } );\n"
    "phases = ( { name = `fall`; steps = 200; },\n"
    "  { name = `land`; every = 20; until = `step > 310`; },\n"
    "  { name = `twice`; repeat = 2; phases = ( { name = `pass`; steps = 30; } ); },\n"
    "  { name = `ending`; until = `step > 9000`; most = 200; } );\n"
    "measure = ( { name = `far`; of = `moved(0.15)`; at = `land`; }, { name = `y`; of = `y`; at = `twice`; } "
    ");\n";

/* Each key of a phase, and what in the text becomes another run. */
static const struct {
    const char *key, *from, *to;
} of_phases[] = {{"name", "name = `ending`", "name = `late`"},
                 {"least", "every = 20", "every = 20; least = 7"},
                 {"every", "every = 20", "every = 35"},
                 {"most", "most = 200", "most = 300"},
                 {"go_on", "most = 200", "most = 200; go_on = true"},
                 {"status", "most = 200", "most = 200; status = `late`"},
                 {"open", "every = 20", "every = 20; open = `gate`"},
                 {"mark", "every = 20", "every = 20; mark = false"},
                 {"damp", "every = 20", "every = 20; damp = true"},
                 {"from", "steps = 30", "steps = 30; from = `fall`"},
                 {"remove", "every = 20", "every = 20; remove = `right`"},
                 {"repeat", "repeat = 2", "repeat = 3"}};
enum { PHASE_KEYS = sizeof of_phases / sizeof *of_phases };

static bool same_ends(const trial *a, const trial *b)
{
    return strcmp(exp_ended(a->run)->status, exp_ended(b->run)->status) == 0 &&
           exp_steps(a->run) == exp_steps(b->run) &&
           memcmp(exp_values(a->run), exp_values(b->run), 2 * sizeof(double)) == 0;
}

static void phase_keys(void)
{
    RUN_TRIAL(base, phases, 1000, "most_ending");
    for (size_t k = 0; k < PHASE_KEYS; k++) {
        scoped_trial now;
        const rp_status status = read_text(&now, check_changed(phases, of_phases[k].from, of_phases[k].to));
        if (!status) CHECK_OK(exp_start(now.plan, 7, 3, &now.run));
        if (!status) finish(&now, 1000);
        CHECK_OR_SAY(!status && !same_ends(&now, &base), "phases: %s: %s", of_phases[k].to,
                     status ? rp_message() : "the same run");
    }
    for (const rp_param *p = exp_groups->schema; p->name; p++) {
        size_t k = 0;
        while (k < PHASE_KEYS && strcmp(of_phases[k].key, p->name) != 0) k++;
        CHECK_OR_SAY(k < PHASE_KEYS, "phases.%s: no row of tests/test_keys.c", p->name);
    }
    check_refused(1, &(trial_change){phases, "repeat = 2", "repeat = 2; damp = true",
                                     "damp: of a block's phases, not of the block"});
}

/* ---- protocols ---- */

/* Quick runs: settings instead of the defaults, and values that only differ with further settings. */
static const struct {
    const sweep_protocol *protocol;
    const char *settings;
    const char *key, *value; /* NULL: for all keys */
} runs[] = {{&sweep_protocol_pile, "base=7"},
            {&sweep_protocol_pile, "base=7 eps=1e-3 branch=minimum load_steps=4"},
            {&sweep_protocol_pile, "base=9 alpha_deg=30 inner_deg=45 x_1=0.3 disorder=0.01"},
            {&sweep_protocol_pile, "base=9 alpha_deg=30 well=0.3 mu=0.2 load_steps=4 eps=1e-3"},
            {&sweep_protocol_pile, "base=9 alpha_deg=30 well=0.05 mu=0.05 load_steps=4 eps=1e-3", "set_again",
             "true"},
            {&sweep_protocol_pile, "base=9 threshold=true eps=1e-6"}};
enum { N_RUNS = sizeof runs / sizeof *runs };

/* The parameters of a run with one more setting "key=value"; NULL if a value is refused. */
static void *settings_of(const sweep_protocol *p, const char *settings, const char *key, const char *value)
{
    void *params = protocol_params(p, (const char *const[]){settings, NULL});
    rp_status status =
        key ? rp_params_set_text(rp_params_find(p->schema, key), RP_CGS, params, value) : RP_OK;
    if (!status && p->check) status = p->check(params);
    if (status) free(params);
    return status ? NULL : params;
}

static bool result_of(const sweep_protocol *p, void *params, sweep_result *result)
{
    memset(result, 0, sizeof *result);
    sweep_result_clear(result);
    const rp_status status = p->run(params, 7, 3, NULL, result);
    free(params);
    return status == RP_OK;
}

static bool same_results(const sweep_result *a, const sweep_result *b)
{
    return strcmp(a->status, b->status) == 0 && memcmp(a->values, b->values, sizeof a->values) == 0;
}

enum { SAME, CHANGED, REFUSED };

static int run_changes(size_t run, const sweep_result *base, const char *key, const char *value)
{
    sweep_result now;
    void *params = settings_of(runs[run].protocol, runs[run].settings, key, value);
    if (!params) return REFUSED;
    return !result_of(runs[run].protocol, params, &now) || same_results(base, &now) ? SAME : CHANGED;
}

/* Values to try in run number r, from its own. */
static candidates run_candidates(size_t r, const rp_param *p)
{
    candidates c = {0};
    char now[128];
    if (runs[r].key) {
        if (strcmp(runs[r].key, p->name) == 0) add(&c, runs[r].value);
        return c;
    }
    scoped void *params = settings_of(runs[r].protocol, runs[r].settings, NULL, NULL);
    c = find_candidates(p, rp_params_text(p, params, now, sizeof now));
    return c;
}

/* Of a key that takes words each word but the runs' own must change a run, or be refused by all; of a key
 * that takes numbers some number. */
static void check_protocol_key(const sweep_result bases[], const sweep_protocol *protocol, const rp_param *p)
{
    const bool words = p->type == RP_CHOICE;
    candidates c[N_RUNS] = {0}, matter = {0};
    const size_t expected = words ? find_candidates(p, "").n - 1 : 1;
    for (size_t r = 0; r < N_RUNS; r++)
        if (runs[r].protocol == protocol) c[r] = run_candidates(r, p);
    for (size_t k = 0; k < MOST_CANDIDATES && matter.n < expected; k++) {
        size_t refused = 0, tried = 0;
        const char *word = "";
        for (size_t r = 0; r < N_RUNS && matter.n < expected; r++) {
            bool known = k >= c[r].n;
            for (size_t i = 0; i < matter.n && !known; i++) known = strcmp(matter.text[i], c[r].text[k]) == 0;
            if (known) continue;
            const int change = run_changes(r, &bases[r], p->name, word = c[r].text[k]);
            if (change == CHANGED) add(&matter, word);
            refused += change == REFUSED;
            tried++;
        }
        if (words && tried && refused == tried) add(&matter, word);
    }
    if (matter.n < expected)
        fprintf(stderr, "%s %s: %zu of %zu values change a run\n", protocol->name, p->name, matter.n,
                expected);
    CU_ASSERT(matter.n >= expected);
}

static void check_protocol(const sweep_protocol *protocol)
{
    sweep_result bases[N_RUNS];
    for (size_t r = 0; r < N_RUNS; r++) {
        if (runs[r].protocol != protocol) continue;
        void *params = settings_of(protocol, runs[r].settings, NULL, NULL);
        if (!params && runs[r].key) continue; /* it has no such word */
        if (!params) fprintf(stderr, "%s: %s\n", runs[r].settings, rp_message());
        CU_ASSERT_PTR_NOT_NULL_FATAL(params);
        CU_ASSERT(result_of(protocol, params, &bases[r]));
        CHECK_OR_SAY(strncmp(bases[r].status, "ok", 2) == 0 || runs[r].key, "%s: %s", runs[r].settings,
                     bases[r].status);
    }
    /* under the sanitizers every eighth key */
    for (const rp_param *p = protocol->schema; p->name; p++)
        if ((p - protocol->schema) % (check_fast() ? 24 : 1) == 0) check_protocol_key(bases, protocol, p);
}

#define X(name)                                                                                              \
    static void test_##name##_keys(void)                                                                     \
    {                                                                                                        \
        check_protocol(&sweep_protocol_##name);                                                              \
    }
SWEEP_PROTOCOLS(X)
#undef X

CHECK_SUITE_WITHIN(keys, "keys", enter, leave, test_scene_keys, phase_keys, test_pile_keys)
