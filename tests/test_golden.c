/* Golden digests: short runs whose bits may change only together with RP_MODEL_VERSION, because results of
 * one version are reused. Each law, model, method and function of the lists has one, and so has each
 * protocol. Digests cover results of + - * / and sqrt only, so that they hold on any machine; angles from
 * atan are compared as numbers. All outputs stand in tests/golden.txt, with ten digits. */
#include <stdint.h>
#include <xxhash.h>

#include "core/version.h"
#include "dem/law/laws.h"
#include "params/expression.h"
#include "sweeps/engine/experiment.h"
#include "tests/folder.h"
#include "tests/grains.h"
#include "tests/protocol.h"

/* The digests below belong to this RP_MODEL_VERSION: raising it without new digests fails too. */
enum { GOLDEN_VERSION = 4 };

/* C libraries may differ in the last digits of atan: 1e-9 degree is 1e5 of them. Solves stop near 1e-13. */
static const double ANGLE_TOLERANCE_DEG = 1e-9;

enum { MAX_HASHED = 32 };

/* Settings NAME=VALUE and names of outputs that are hashed, with blanks between them. A run without the
 * latter only tests/golden.txt holds. */
typedef struct {
    const char *protocol, *settings, *hashed, *status;
    uint64_t digest;
    const char *angles; /* NAME=VALUE */
} golden_run;

static const char repose_hashed[] =
    "grains cells fill_steps_used relax_steps_used steps contact_number residual_energy residual_force "
    "theta_t_displacement_deg theta_t_energy_deg";

static const char flux_hashed[] = "level_step level_insertion avalanches grains";

/* Without the coefficients of lines, whose last digits are GSL's. */
static const char stress_hashed[] = "tilts grains steps weight_error balance_error";

/* Without coefficients of lines, as above. */
static const char onset_hashed[] = "grains steps contact_number rattlers limit_floor_2 limit_inside_2 "
                                   "limit_inside_4 limit_probe floor_friction_0 all_x";

/* Counts: the forces of a static solve depend on the order of its operations in the last digits. */
static const char pile_hashed[] = "n_disks contacts horizontal negative_modes broken jumps load";
static const char drop_hashed[] =
    "disks height width centroid dip balance psi6 contacts steps settled relax_steps";

/* The second run of `repose`: other floor, spring and mass, a lifted wall, contacts without attraction. */
static const golden_run runs[] = {
    {"repose", "W=2 H=2 theta_t=true", repose_hashed, "ok", 0x69f885c6c90388ee,
     "theta_r1_deg=22.608706582791452 theta_r2_deg=18.815473553970179 theta_r3_deg=18.30022251707566"},
    {"repose",
     "W=2 H=2 floor=ends slip=total stop=steps fill_steps=6000 relax_steps=4000 shape=disk open=100 "
     "tension=false",
     repose_hashed, "ok_fixed_time", 0x1fa9841e0524b556,
     "theta_r1_deg=26.124650436934175 theta_r2_deg=18.224371711593523 theta_r3_deg=12.736310147046545"},
    {"flux", "W=1.4 insertions=120 avalanche=2 drop_height=1", flux_hashed, "ok", 0xeb77f06b1de2a1a7,
     "theta_deg=15.937506562799364 theta_sd_deg=6.1207856161898553 theta_max_deg=33.042196553399904"},
    {"pile", "base=20 alpha_deg=30 disorder=1e-4 well=10", pile_hashed, "ok", 0xccfb61335d8449d0,
     "D=0.22332242852920325 H_ratio=1.3531349113022209 N_error_rms=0.080162131496141514 "
     "N_continuum_rms=0.046214916864963797"},
    {"stress", "W=2 H=2", stress_hashed, "ok", 0xe0da2cde73d7c18a,
     "theta_r3_deg=18.30022251707566 floor_tilt_deg=12.129609284937734 n_0=0.57734545187972242 "
     "n_1=-0.027938305390767484 h_0=0.048157327989494722 h_1=0.30760390526714404 sxx_0=0.74586531836112901 "
     "sxy_0=-0.21902502432444304 syx_1=-0.12825093952911693 syy_1=-0.12225664625404206"},
    {"onset", "W=2 H=2", onset_hashed, "ok", 0xcd19fa6f329f6201,
     "theta_r3_deg=18.30022251707566 theta_t_displacement_deg=5.4399999999999284 "
     "theta_steepest_deg=31.027190318490319"},
    {"drop", "N=60 radius_width=0.03 source_width=5 rest_force=0.1", drop_hashed, "ok", 0x6e3191f33bd1d0b2,
     "left_deg=17.994080183199198 right_deg=30.504451040903025"},
    {"repose",
     "W=1.6 H=1.6 rotation=true mu_roll=0.1 fill=ramp gamma_n=2000 theta_t=true theta_t_static=true "
     "tilt_rate_deg=0.01",
     "", "ok"},
    {"repose",
     "W=1.6 N=35 mu_wall=0.3 mu_floor=0.4 k_n_wall=3e6 floor=absorbs open=50 theta_t=true tilt=box "
     "tilt_rate_deg=0.01",
     "", "ok"},
    {"stress", "W=1.6 H=1.6 mu_floor=0.4 mu_wall=0.1 tilt_rate_deg=0.01", "", "ok"},
    {"onset", "W=1.6 H=1.6 mu_floor=0.4 mu_wall=0.1 floor=ends tilt_rate_deg=0.01", "", "ok"},
    {"pile", "base=14 alpha_deg=30 inner_deg=45 x_1=0.3 eps=1e-3 gap=0.1 k_x=0.5 disorder=0.01", "", "ok"},
    {"pile", "base=12 alpha_deg=30 eps=1e-3 well=1 mu=0.2 set_again=true set_load=0.5 load_steps=3", "",
     "ok"},
    {"pile", "base=9 eps=0.008 branch=minimum leave=1", "", "ok"},
    {"pile", "base=9 threshold=true", "", "ok"},
    {"drop", "N=15 lattice=15 lattice_deg=40 glued=1 law=spring radius_width=0.03", "", "ok"},
    {"drop", "N=25 collisions=soft mu_base=0.8 source_width=4 drop_height=1 mu_roll=0.2", "", "ok"},
    {"drop", "N=60 x_limit=10 mu_roll=0.03 mu=0.3 law=spring restitution=0.7", "", "ok"},
    {"drop", "N=40 glued=1.6 radius_width=0.15 a=0.02 mu_static=0.3 eps=1e-3", "", "ok"},
    {"flux", "W=2 insertions=40 drop_height=0.3 entry_width=0.5", "", "ok"}};
enum { N_RUNS = sizeof runs / sizeof *runs };

/* Positions, velocities and forces of the scene below. */
static const uint64_t SCENE_DIGEST = 0x5b594a42a2cd5b47;

static void check_digest(const char *what, uint64_t digest, uint64_t golden)
{
    CHECK_OR_SAY(RP_MODEL_VERSION == GOLDEN_VERSION && digest == golden,
                 "%s: digest 0x%016llx, expected 0x%016llx of model version %d.\nBits changed: raise "
                 "RP_MODEL_VERSION (now %d) in src/core/version.h, and put it (GOLDEN_VERSION) and the\n"
                 "new digest into %s.",
                 what, (unsigned long long)digest, (unsigned long long)golden, GOLDEN_VERSION,
                 RP_MODEL_VERSION, __FILE__);
}

/* An output of number `run` of the list above, from 1 on, with the pile `pile`. False: the file lacks it.
 * Rows: run, pile, output, value. */
static bool known_output(size_t run, unsigned long pile, const char *name, double *value)
{
    static char *text;
    if (!text) text = file_read("tests/golden.txt", &(size_t){0});
    const char *key = check_text("\n%zu\t%lu\t%s\t", run, pile, name);
    const char *row = strstr(text, key);
    if (row) *value = strtod(row + strlen(key), NULL);
    return row != NULL;
}

static const sweep_protocol *find_protocol(const char *name)
{
    const sweep_protocol *const *p = sweep_protocols;
    while (*p && strcmp((*p)->name, name) != 0) p++;
    return *p;
}

/* Every output of a run, to the digits that libraries share: nothing of it changes unseen. */
static void check_outputs(size_t run, unsigned long pile, const sweep_protocol *p, const sweep_result *result)
{
    for (size_t n = 0; p->outputs[n].name; n++) {
        const double v = result->values[n];
        double known = NAN;
        const bool found = known_output(run, pile, p->outputs[n].name, &known),
                   same = isnan(v) ? isnan(known)
                                   : v == known || fabs(v - known) <= fmax(1e-7 * fabs(known), 1e-11);
        if (!found || !same)
            fprintf(stderr, "tests/golden.txt has another value: %zu\t%lu\t%s\t%.10g\n", run, pile,
                    p->outputs[n].name, v);
        CU_ASSERT(found && same);
    }
}

static void check_run(const golden_run *g, unsigned long pile)
{
    const sweep_protocol *p = find_protocol(g->protocol);
    CU_ASSERT_PTR_NOT_NULL_FATAL(p);
    CHECK_OK(sweep_protocol_open(p, NULL, NULL, &p));
    scoped void *params = PROTOCOL_PARAMS(p, g->settings);
    sweep_result result;
    CHECK_OK(p->check(params));
    CHECK_OK(p->run(params, 1993, pile, NULL, &result));
    CU_ASSERT_STRING_EQUAL(result.status, g->status);

    double values[MAX_HASHED];
    size_t n = 0;
    const char *names = g->hashed;
    for (char name[128]; check_word(&names, " ", name); n++) {
        CU_ASSERT_FATAL(n < MAX_HASHED);
        const double v = protocol_output(p, &result, name);
        values[n] = isnan(v) ? NAN : v; /* NaN has many bit patterns */
    }
    if (n > 0) check_digest(g->protocol, XXH3_64bits(values, n * sizeof *values), g->digest);
    const char *angles = g->angles;
    for (char angle[128]; angles && check_word(&angles, " ", angle);) {
        char *const value = strchr(angle, '=');
        *value = '\0';
        CHECK_NEAR(protocol_output(p, &result, angle), strtod(value + 1, NULL), ANGLE_TOLERANCE_DEG);
    }
    check_outputs((size_t)(g - runs) + 1, pile, p, &result);
    sweep_protocol_close(p);
}

static void test_protocols(void)
{
    for (size_t i = 0; i < N_RUNS; i++)
        for (unsigned long pile = 0; pile < (*runs[i].hashed ? 1 : 2); pile++) check_run(&runs[i], pile);
    for (const sweep_protocol *const *p = sweep_protocols; *p; p++) {
        bool has_run = false;
        for (size_t i = 0; i < N_RUNS; i++)
            has_run |= strcmp(runs[i].protocol, (*p)->name) == 0 && *runs[i].hashed;
        CHECK_OR_SAY(has_run, "protocol %s has no golden digest", (*p)->name);
    }
}

/* ---- Each of a list ---- */

static const char *golden_text(void)
{
    static char *text;
    if (!text) text = file_read("tests/golden.txt", &(size_t){0});
    return text;
}

/* The digest of this name stands in tests/golden.txt, as an output of run 0. */
static void check_named(const char *name, uint64_t digest)
{
    const char *key = check_text("\n0\t0\t%s\t", name), *row = strstr(golden_text(), key);
    if (RP_MODEL_VERSION == GOLDEN_VERSION && row && strtoull(row + strlen(key), NULL, 16) == digest) return;
    fprintf(stderr, "tests/golden.txt has another value: 0\t0\t%s\t0x%016llx\n", name,
            (unsigned long long)digest);
    CU_FAIL("bits changed, or a name without a digest");
}

enum { BOX_GRAINS = 30 };

/* Bits of all states, contacts and energies. */
static uint64_t digest_of(const dem_sim *sim)
{
    size_t n;
    scoped dem_state *s = grains_states(sim);
    scoped dem_contact *c = grains_contacts(sim, &n);
    const dem_energy e = grains_energies(sim);
    uint64_t digest = XXH3_64bits((double[]){e.kinetic, e.elastic, e.rotational}, 3 * sizeof(double));
    CU_ASSERT(dem_count(sim) > 0 && n > 0);
    for (size_t i = 0; i < dem_count(sim); i++) {
        const double v[] = {s[i].x,     s[i].y,  s[i].angle, s[i].vx,    s[i].vy,
                            s[i].omega, s[i].fx, s[i].fy,    s[i].torque};
        digest = XXH3_64bits_withSeed(v, sizeof v, digest);
    }
    for (size_t i = 0; i < n; i++) {
        const double v[] = {c[i].overlap,      c[i].normal_force,   c[i].shear_force,
                            c[i].shear_spring, c[i].rolling_torque, c[i].rolling_spring};
        digest = XXH3_64bits_withSeed(v, sizeof v, digest);
    }
    return digest;
}

/* Rolling grains pour out of a box; without rotation where a method has none. */
static dem_definition box_of(bool rotation)
{
    dem_grain *grains;
    dem_definition def = grains_box(BOX_GRAINS, 1.2, 11, &grains);
    grains_law(&def, DEM_HERTZ, 1.5e5, 500.0);
    def.rotation = rotation;
    for (int i = 0; rotation && i < BOX_GRAINS; i++) grains[i].omega = 3.0 * (i % 7) - 9.0;
    def.material.mu_roll = rotation ? 0.1 : 0.0;
    def.x_max = 2.0;
    return def;
}

static void mindlin(dem_definition *def)
{
    grains_law(def, DEM_ELASTIC, 1.5e5, 500.0);
    def->material.k_s = def->material.k_roll = 0.4 * def->material.k_n;
    def->material.gamma_s = def->material.gamma_roll = 0.2;
}

static void check_box(const char *name, dem_definition *def)
{
    for (int w = 0; w < DEM_BOX_N; w++) {
        def->walls[w].material = def->material;
        def->walls[w].material.k_n *= 2.0;
    }
    def->walls[DEM_BOX_RIGHT].open_at_step = 2500;
    scoped_sim *sim = grains_after(def, 4000);
    check_named(name, digest_of(sim));
}

static void check_normal(const char *name, int law)
{
    dem_definition def = box_of(true);
    grains_law(&def, (dem_normal_law)law, 1.5e5, 500.0);
    check_box(name, &def);
}

static void check_tangential(const char *name, int law)
{
    dem_definition def = box_of(dem_has_friction((dem_tangential_law)law));
    def.tangential = (dem_tangential_law)law;
    if (!dem_has_friction(def.tangential)) def.material.mu = 0.0;
    if (dem_is_of_radius(def.tangential)) mindlin(&def);
    check_box(name, &def);
}

static void check_slip(const char *name, int slip)
{
    dem_definition def = box_of(true);
    def.slip = (dem_slip)slip;
    check_box(name, &def);
}

static void check_damping(const char *name, int damping)
{
    dem_definition def = box_of(true);
    def.damping = (dem_damping)damping;
    check_box(name, &def);
}

static void check_rolling(const char *name, int model)
{
    dem_definition def = box_of(true);
    def.rolling = (dem_rolling)model;
    if (dem_rolls_by_speed(def.rolling)) def.material.mu_roll = 1e-3;
    check_box(name, &def);
}

static void check_arm(const char *name, int arm)
{
    dem_definition def = box_of(true);
    def.rolling_arm = (dem_arm)arm;
    check_box(name, &def);
}

static void check_integrator(const char *name, int integrator)
{
    dem_definition def = box_of(false);
    def.integrator = (dem_integrator)integrator;
    if (def.integrator == DEM_IMPLICIT) { /* the other solver's last digits are a library's */
        def.tangential = DEM_SLIP_ROLL, def.material.gamma_s = 40.0, def.dt = 2e-5;
        def.implicit = (dem_implicit_solver){DEM_SOLVER_SOR, 0.7, 1e-12, 3000};
    }
    check_box(name, &def);
}

static void check_wells(const char *name, int set)
{
    dem_definition def = box_of(true);
    def.tangential = DEM_SLIP_ROLL, def.material.gamma_s = 40.0;
    def.ground = (dem_ground){.wall = 1, .mu_static = 0.4, .a = 1e-3, .set = (dem_well_set)set};
    check_box(name, &def);
}

static const struct {
    const char *name;
    void (*check)(const char *name, int value);
    int value;
} listed[] = {
#define X(id, word, ...) {"normal." #word, check_normal, id},
    DEM_NORMAL_LAWS(X)
#undef X
#define X(id, word, ...) {"tangential." #word, check_tangential, id},
        DEM_TANGENTIAL_LAWS(X)
#undef X
#define X(id, word, ...) {"slip." #word, check_slip, id},
            DEM_SLIPS(X)
#undef X
#define X(id, word, ...) {"damping." #word, check_damping, id},
                DEM_DAMPINGS(X)
#undef X
#define X(id, word, ...) {"rolling." #word, check_rolling, id},
                    DEM_ROLLINGS(X)
#undef X
#define X(id, word, ...) {"arm." #word, check_arm, id},
                        DEM_ARMS(X)
#undef X
#define X(id, word, ...) {"integrator." #word, check_integrator, id},
                            DEM_INTEGRATOR_LIST(X)
#undef X
#define X(id, word, ...) {"wells." #word, check_wells, id},
                                DEM_WELL_SETS(X)
#undef X
};

static void test_laws(void)
{
    if (CHECK_SKIPS("the suite laws runs them")) return;
    for (size_t k = 0; k < sizeof listed / sizeof *listed; k++)
        listed[k].check(listed[k].name, listed[k].value);
}

static rp_status no_name(void *host, const char *name, int n_args, rp_x_symbol *symbol, bool *known)
{
    (void)host, (void)name, (void)n_args, (void)symbol, (void)known;
    return RP_OK;
}

/* Of a function of texts, at many places. */
static uint64_t digest_of_function(const char *format)
{
    static const rp_x_names names = {.find = no_name, .measure = true};
    uint64_t digest = 0;
    double states[4] = {0.0};
    for (double x = 0.0107; x < 700.0; x *= 1.37) {
        RP_SCOPE(arena);
        rp_expression e = {0};
        CHECK_OK(rp_expression_read(&arena, check_text(format, x, x), &names, &e));
        const double v = rp_expression_value(&e, &(rp_x_values){0}, states);
        digest = XXH3_64bits_withSeed(&v, sizeof v, digest);
    }
    return digest;
}

/* Each function has one here, or a reason. */
static const struct {
    const char *name, *format, *reason;
} functions[] = {{"min", "min(%.17g, 2)"},
                 {"max", "max(%.17g, 2)"},
                 {"abs", "abs(2 - %.17g)"},
                 {"sqrt", "sqrt(%.17g)"},
                 {"floor", "floor(2.5 - %.17g)"},
                 {"round", "round(2.5 - %.17g)"},
                 {"sin", "sin(%.17g) + sin(-%.17g/7)"},
                 {"cos", "cos(%.17g)"},
                 {"tan", "tan(%.17g)"},
                 {"atan", "atan(%.17g)"},
                 {"exp", "exp(%.17g) + exp(-%.17g)"},
                 {"log", "log(%.17g)"},
                 {"held", "held(%.17g > 2, 1) ? 1 : 0"},
                 {"power", "%.17g^1.5 + %.17g^-2"},
                 {"known", NULL, "of a measure"},
                 {"change", NULL, "of a sample and the one before"},
                 {"dt_limit", NULL, "of a scene, whose limit the suite experiment compares"}};
enum { FUNCTIONS = sizeof functions / sizeof *functions };

static void test_functions(void)
{
    const char *words = strchr(rp_expression_functions, ';') + 1;
    for (char word[128]; *words != ';' && check_word(&words, " ;", word);) {
        size_t k = 0;
        while (k < FUNCTIONS && strcmp(functions[k].name, word) != 0) k++;
        CHECK_OR_SAY(k < FUNCTIONS, "function %s has no golden digest", word);
    }
    for (size_t k = 0; k < FUNCTIONS; k++)
        if (functions[k].format)
            check_named(check_text("function.%s", functions[k].name),
                        digest_of_function(functions[k].format));
}

/* A digest of run 0 is of a name of the lists, or of a function. */
static void test_names(void)
{
    for (const char *row = golden_text(); (row = strstr(row, "\n0\t0\t")); row++) {
        char name[128];
        bool known = false;
        check_word(&(const char *){row + 5}, "\t", name);
        for (size_t k = 0; k < sizeof listed / sizeof *listed; k++) known |= !strcmp(listed[k].name, name);
        for (size_t k = 0; k < FUNCTIONS; k++)
            known |= functions[k].format && !strcmp(check_text("function.%s", functions[k].name), name);
        CHECK_OR_SAY(known, "tests/golden.txt: %s is in no list", name);
    }
}

/* ---- A scene ---- */

/* A box is filled, and opened while gravity rotates. */
static void test_scene(void)
{
    enum { N = 100 };
    dem_fill fill = {N, 2.0, 3.5, 0.1, 0.02, 0.07, 0.13, 1.0, DEM_SPHERE, 1993, 0};
    dem_grain grains[N];
    CHECK_OK(dem_fill_grains(&fill, grains, &(size_t){0}));
    dem_definition def = grains_of(N, grains);
    dem_material wall = def.material;
    wall.k_n *= 2.0;
    dem_box_walls(&def, 2.0, &wall);
    scoped_sim *sim = grains_after(&def, 1500);
    dem_wall_open(sim, 2, INFINITY);
    dem_gravity_turn(sim, 2.385e-5);
    CHECK_OK(dem_run(sim, 500));
    CU_ASSERT_FATAL(dem_count(sim) == N);
    CU_ASSERT(grains_counts(sim).contacts > N); /* not grains in free fall */
    double values[N][6];
    scoped dem_state *states = grains_states(sim);
    for (int i = 0; i < N; i++) {
        const dem_state *s = &states[i];
        memcpy(values[i], (double[]){s->x, s->y, s->vx, s->vy, s->fx, s->fy}, sizeof values[i]);
    }
    check_digest("scene", XXH3_64bits(values, sizeof values), SCENE_DIGEST);
}

CHECK_SUITE(golden, "golden digests", test_protocols, test_names, test_laws, test_functions, test_scene)
