/* Golden digests: short runs whose bits may change only together with RP_MODEL_VERSION, because results of
 * one version are reused. Digests cover results of + - * / and sqrt only, so that they hold on any machine;
 * angles from atan are compared as numbers. All outputs stand in tests/golden.txt, with ten digits. */
#include <stdint.h>
#include <xxhash.h>

#include "core/version.h"
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
                 "RP_MODEL_VERSION (now %d) in src/core/version.h, unless the\nfingerprint of all protocols "
                 "concerned changes too, and put it (GOLDEN_VERSION) and the new digest into %s.",
                 what, (unsigned long long)digest, (unsigned long long)golden, GOLDEN_VERSION,
                 RP_MODEL_VERSION, __FILE__);
}

/* Of the key of stored runs of `pile`: an accidental change loses all stored runs. */
static const char FINGERPRINT[] = "c7a1768420111129d3b453153b2511ef";

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
    if (check_fast()) return; /* the fingerprints run each protocol too */
    for (size_t i = 0; i < N_RUNS; i++)
        for (unsigned long pile = 0; pile < (*runs[i].hashed ? 1 : 2); pile++) check_run(&runs[i], pile);
    for (const sweep_protocol *const *p = sweep_protocols; *p; p++) {
        bool has_run = false;
        for (size_t i = 0; i < N_RUNS; i++) has_run |= strcmp(runs[i].protocol, (*p)->name) == 0;
        CHECK_OR_SAY(has_run, "protocol %s has no golden run", (*p)->name);
    }
}

static void test_fingerprints(void)
{
    size_t n = 0;
    for (const sweep_protocol *const *p = sweep_protocols; *p; p++) {
        if ((*p)->text) continue;
        char digits[33];
        CU_ASSERT_STRING_EQUAL((*p)->name, "pile");
        CHECK_OK((*p)->fingerprint(digits));
        n++;
        if (strcmp(digits, FINGERPRINT) != 0)
            fprintf(stderr,
                    "protocol %s: fingerprint %s, expected %s.\nIts stored runs are lost: if that is meant, "
                    "put the new one into %s.\n",
                    (*p)->name, digits, FINGERPRINT, __FILE__);
        CU_ASSERT_STRING_EQUAL(digits, FINGERPRINT);
    }
    CU_ASSERT(n == 1);
}

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

CHECK_SUITE(golden, "golden digests", test_protocols, test_fingerprints, test_scene)
