/* Protocol `repose`: its scene, and its outputs by a second method from the tables of a run. */
#include "experiment/modules/module.h"
#include "angle/angle.h"
#include "dem/scene/text.h"
#include "sweeps/engine/experiment.h"
#include "tests/grains.h"
#include "tests/program.h"
#include "tests/protocol.h"

/* Angles from the same numbers in another order of summation: some ulp of 30 degrees. */
static const double ANGLE_TOLERANCE_DEG = 1e-10;

static const double RADIAN_DEG = 180.0 / 3.14159265358979323846;

static const sweep_protocol *protocol; /* open */

static double output(const sweep_result *result, const char *name)
{
    return protocol_output(protocol, result, name);
}

/* A run with its tables in the folder `t` of the test. */
#define TRACED(result, ...) traced_run(result, (const char *const[]){__VA_ARGS__, NULL})
static void traced_run(sweep_result *result, const char *const changes[])
{
    protocol = protocol_of(&sweep_protocol_repose);
    scoped void *params = protocol_params(protocol, changes);
    protocol_trace(protocol, params, 1000, result);
}

typedef struct {
    size_t n;
    double x[256], y[256], r[256];
} grains;

static void read_grains(const char *name, grains *g)
{
    scoped_table t = read_table(name);
    CU_ASSERT_FATAL(t.n_rows > 0 && t.n_rows <= 256);
    g->n = t.n_rows;
    for (size_t i = 0; i < g->n; i++)
        g->x[i] = cell(&t, i, "x"), g->y[i] = cell(&t, i, "y"), g->r[i] = cell(&t, i, "r");
}

/* Slope of the least-squares line through (j, h_j), by the normal equations. */
static double line_deg(int n, const double h[], double cell)
{
    double sj = 0.0, sh = 0.0, sjj = 0.0, sjh = 0.0;
    for (int j = 0; j < n; j++) sj += j, sh += h[j], sjj += (double)j * j, sjh += j * h[j];
    return -atan((n * sjh - sj * sh) / (n * sjj - sj * sj) / cell) * RADIAN_DEG;
}

/* Highest centres minus d/2 in an odd number of cells of 0.2; lines through those beside the middle one. */
static void check_halves(const grains *g, int cells, const sweep_result *result)
{
    double h[11] = {0.0};
    for (size_t i = 0; i < g->n; i++) {
        const int k = (int)floor(g->x[i] / 0.2);
        if (k >= 0 && k < cells) h[k] = fmax(h[k], g->y[i] - 0.1);
    }
    const int half = cells / 2;
    double upper = line_deg(half, h, 0.2), lower = line_deg(half, h + half + 1, 0.2);
    CHECK_EACH(output(result, NAME), ANGLE_TOLERANCE_DEG, {"theta_lower_less_upper_deg", lower - upper},
               {"theta_upper_deg", upper});
}

/* In a triangular lattice every grain has order 1; a line of three has it in the middle, and ends with one
 * neighbour do not count. At 1.24 diameters a grain is a neighbour, at 1.26 or fixed it is none. */
static void test_bond_order(void)
{
    dem_state g[7] = {{.r = 1.0}};
    for (int k = 0; k < 6; k++)
        g[k + 1] = (dem_state){.x = 2.0 * cos(k * M_PI / 3.0), .y = 2.0 * sin(k * M_PI / 3.0), .r = 1.0};
    CHECK_NEAR(exp_bond_order(7, g, NULL, NULL), 1.0, 1e-14);
    CU_ASSERT(isnan(exp_bond_order(2, g, NULL, NULL)));
    /* bonds at 0 and 45 degrees: half of |1 + exp(i 270)|; the others are too far away */
    g[1] = (dem_state){.x = 2.48, .r = 1.0};
    g[2] = (dem_state){.x = sqrt(2.0), .y = sqrt(2.0), .r = 1.0};
    g[3] = (dem_state){.x = -2.52, .r = 1.0};
    g[4] = (dem_state){.y = -2.0, .r = 1.0, .fixed = true};
    CU_ASSERT(hypot(2.48 - sqrt(2.0), sqrt(2.0)) < 2.5); /* so they touch one another as well */
    const double angle = atan2(sqrt(2.0), 2.48 - sqrt(2.0));
    CHECK_NEAR(exp_bond_order(5, g, NULL, NULL),
               (sqrt(0.5) + fabs(cos(3.0 * angle)) + fabs(cos(3.0 * (M_PI - angle - 0.25 * M_PI)))) / 3.0,
               1e-14);
}

/* Order of the filled box, by angles of the bonds. */
static void check_order(const sweep_result *result)
{
    grains g;
    double sum = 0.0, n = 0.0;
    read_grains("t/filled_grains.tsv", &g);
    for (size_t i = 0; i < g.n; i++) {
        double re = 0.0, im = 0.0, near = 0.0;
        for (size_t j = 0; j < g.n; j++) {
            const double dx = g.x[j] - g.x[i], dy = g.y[j] - g.y[i];
            if (i == j || hypot(dx, dy) > 1.25 * (g.r[i] + g.r[j])) continue;
            re += cos(6.0 * atan2(dy, dx));
            im += sin(6.0 * atan2(dy, dx));
            near++;
        }
        if (near >= 2.0) sum += hypot(re, im) / near, n++;
    }
    CU_ASSERT(n > 0.0);
    CHECK_NEAR(output(result, "psi6"), sum / n, 1e-12);
}

/* Few grains leave empty cells. */
static void test_surfaces(void)
{
    sweep_result result;
    grains g;
    TRACED(&result, "W=2.2 N=16 floor=absorbs mu=0.1 stop=steps fill_steps=4000 relax_steps=4000");
    CU_ASSERT_STRING_EQUAL(result.status, "ok_fixed_time");
    CU_ASSERT(output(&result, "fill_steps_used") == 4000.0 && output(&result, "relax_steps_used") == 4000.0);
    CU_ASSERT(output(&result, "steps") == 8000.0);
    read_grains("t/pile_grains.tsv", &g);
    CU_ASSERT(output(&result, "cells") < 11.0);
    check_halves(&g, 11, &result);
    check_order(&result);
}

/* Three cells make a half, two do not; a step of relaxation is one. */
static void test_small_halves(void)
{
    sweep_result result;
    for (int cells = 5; cells < 8; cells += 2) {
        TRACED(&result, "H=1 stop=steps fill_steps=1500 relax_steps=1", cells == 5 ? "W=1" : "W=1.4");
        CU_ASSERT(output(&result, "steps") == 1501.0 && output(&result, "relax_steps_used") == 1.0);
        CU_ASSERT(output(&result, "cells") == cells);
        grains g;
        read_grains("t/pile_grains.tsv", &g);
        if (cells == 5) CU_ASSERT(isnan(output(&result, "theta_upper_deg")));
        if (cells == 7) check_halves(&g, cells, &result);
    }
}

/* The scene of the text with such values. */
static void scene_with(const char *const changes[], dem_text *text, dem_scene *scene)
{
    rp_texts list = {0};
    for (; *changes; changes++) list.items[list.n++] = *changes;
    CHECK_OK(dem_text_open("repose", sweep_protocol_repose.text, &list, text));
    CHECK_OK(dem_text_scene(text, scene));
}

/* Friction of the floor when some of the three coefficients are given. */
static void test_frictions(void)
{
    static const struct {
        const char *changes[3];
        double wall, floor;
    } cases[] = {{{NULL}, 0.2, 0.2},
                 {{"mu_wall=0.3"}, 0.3, 0.2},
                 {{"mu_floor=1.0"}, 0.2, 1.0},
                 {{"mu_wall=0.3", "mu_floor=0.0"}, 0.3, 0.0}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        dem_text text;
        scoped_scene scene = {0};
        scene_with(cases[i].changes, &text, &scene);
        CU_ASSERT(scene.def.material.mu == 0.2);
        CU_ASSERT(scene.def.walls[DEM_BOX_FLOOR].material.mu == cases[i].floor);
        CU_ASSERT(scene.def.walls[DEM_BOX_LEFT].material.mu == cases[i].wall);
        CU_ASSERT(scene.def.walls[DEM_BOX_RIGHT].material.mu == cases[i].wall);
        dem_text_close(&text);
    }
    sweep_result result;
    TRACED(&result, "W=1 H=1 mu_floor=0 stop=steps fill_steps=10 relax_steps=10");
    CU_ASSERT_STRING_EQUAL(result.status, "no_pile");
    CU_ASSERT(strstr(result.message, "mu_floor == 0") != NULL);
}

/* The box by a second way, to the steps at which the run has its pile, equal in every bit. */
static void box_again(const sweep_result *result, double W, dem_sim **sim)
{
    const double steps[] = {output(result, "fill_steps_used"), output(result, "relax_steps_used")};
    protocol_box(W, W, 0, steps, sim);
    scoped_table t = read_table("t/pile_grains.tsv");
    CU_ASSERT_FATAL(dem_count(*sim) <= 256 && dem_count(*sim) == t.n_rows);
    scoped dem_state *states = grains_states(*sim);
    for (size_t i = 0; i < t.n_rows; i++)
        CU_ASSERT(cell(&t, i, "x") == states[i].x && cell(&t, i, "y") == states[i].y);
}

/* Whatever of the physics the text has no name for is a parameter by its own name, and a part of the key. */
static void test_keys_of_the_scene(void)
{
    static const struct {
        const char *name, *value;
    } others[] = {
        {"rotation", "true"}, {"shape", "disk"},       {"density", "2"},         {"integrator", "gear5"},
        {"dt", "2e-5"},       {"normal", "linear"},    {"tension", "false"},     {"tangential", "slip_roll"},
        {"k_s", "9000"},      {"gamma_s", "7"},        {"damping", "inside"},    {"k_roll", "5"},
        {"gamma_roll", "6"},  {"rolling", "constant"}, {"rolling_arm", "radius"}};
    const sweep_protocol *open;
    size_t n = 0, left = 0;
    for (; n < sizeof others / sizeof *others; n++) {
        XXH128_hash_t hash[2];
        CHECK_OK(sweep_protocol_open(&sweep_protocol_repose, NULL, NULL, &open));
        CU_ASSERT_PTR_NULL(rp_params_find(open->schema, others[n].name));
        sweep_protocol_also(open, others[n].name);
        const rp_param *p = rp_params_find(open->schema, others[n].name);
        CU_ASSERT_PTR_NOT_NULL_FATAL(p);
        scoped void *params = protocol_params(open, (const char *const[]){NULL});
        const char *as_in_text = strcmp(others[n].name, "tangential") == 0 ? "spring"
                                 : strcmp(others[n].name, "damping") == 0  ? "outside"
                                                                           : NULL;
        if (as_in_text) CHECK_OK(rp_params_set_text(p, RP_CGS, params, as_in_text));
        CU_ASSERT_FATAL(open->hash(params, &hash[0]));
        CHECK_OK(rp_params_set_text(p, RP_CGS, params, others[n].value));
        const bool works = open->hash(params, &hash[1]);
        if (!works) fprintf(stderr, "%s = %s: %s\n", others[n].name, others[n].value, rp_message());
        CU_ASSERT_FATAL(works);
        CU_ASSERT(!XXH128_isEqual(hash[0], hash[1]));
        sweep_protocol_close(open);
    }
    CHECK_OK(sweep_protocol_open(&sweep_protocol_repose, NULL, NULL, &open));
    for (const dem_named_key *k = dem_named_keys; k->key; k++)
        left += !rp_params_find(open->schema, k->param.name);
    sweep_protocol_close(open);
    CU_ASSERT_EQUAL(left,
                    n + 3); /* restitution excludes gamma_n, its speed needs it, mu_roll needs rotation */
}

/* Another value of each name of the text is another run, or is refused. */
static void test_names(void)
{
    static const char *const bases[] = {"theta_t=true theta_t_static=true", "stop=steps theta_t=true"};
    protocol = protocol_of(&sweep_protocol_repose);
    for (const rp_param *p = protocol->schema; p->name; p++) {
        size_t matters = 0;
        for (size_t b = 0; b < 2; b++) {
            scoped void *params = PROTOCOL_PARAMS(protocol, bases[b]);
            XXH128_hash_t hash[2];
            char now[64], word[64];
            CU_ASSERT_FATAL(protocol->hash(params, &hash[0]));
            rp_params_text(p, params, now, sizeof now);
            snprintf(word, sizeof word, "%.17g",
                     strcmp(now, "computed") == 0 ? 7.0 : 1.001 * atof(now) + (strcmp(now, "0") == 0));
            if (p->type == RP_BOOL) strcpy(word, strcmp(now, "true") ? "true" : "false");
            if (p->type == RP_CHOICE)
                for (int k = 1; k >= 0 && (k == 1 || strcmp(word, now) == 0); k--)
                    rp_word_at(p->range, k, word, sizeof word);
            const rp_status status = rp_params_set_text(p, RP_CGS, params, word);
            matters += status || !protocol->hash(params, &hash[1]) || !XXH128_isEqual(hash[0], hash[1]);
        }
        CHECK_OR_SAY(matters > 0, "repose: %s changes nothing", p->name);
    }
}

/* Gravity grows as t/T until t = T, and is constant until 2 T: a grain falls by (1/6 + 1/2 + 1/2) g T^2.
 * Steps of T/400 take gravity at their end. */
static void test_ramp(void)
{
    sweep_result result;
    double y[2];
    for (int k = 0; k < 2; k++) {
        TRACED(&result, "W=1 H=4 N=1 fill=ramp stop=steps relax_steps=1",
               k == 0 ? "fill_steps=2" : "fill_steps=800");
        scoped_table t = read_table("t/filled_grains.tsv");
        y[k] = cell(&t, 0, "y");
    }
    const double T = 400 * 5e-5, fall = 7.0 / 6.0 * 981.0 * T * T;
    CHECK_NEAR(y[0] - y[1], fall, fall * 2.0 / 400.0);
}

/* A drop from 2 H = 8: two grains of 0.0042 g overlap by 0.034 at k_n = 2e5, by 0.037 at 1.6e5, where
 * half of radius_min is 0.035. */
static void test_ramp_where_soft(void)
{
    static const struct {
        const char *k_n;
        bool ramp;
    } cases[] = {{"k_n=1e6", false}, {"k_n=2e5", false}, {"k_n=1.6e5", true}, {"k_n=1e4", true}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        sweep_result result;
        TRACED(&result, "W=1 H=4 fill=auto stop=steps fill_steps=400 relax_steps=10", cases[i].k_n);
        CU_ASSERT_STRING_EQUAL(result.status, "ok_fixed_time");
        scoped_table phases = read_table("t/phases.tsv");
        CU_ASSERT(phases.n_rows == (cases[i].ramp ? 5 : 4));
    }
}

/* Contacts per grain with 0 < x < W, from the tables of a stage; number of these grains. */
static double contact_number(const char *stage, double W, size_t *n_pile)
{
    double count = 0.0;
    scoped_table all = read_table(check_text("t/%s_grains.tsv", stage)),
                 contacts = read_table(check_text("t/%s_contacts.tsv", stage));
    *n_pile = 0;
    for (size_t i = 0; i < all.n_rows; i++) {
        const double x = cell(&all, i, "x"), id = cell(&all, i, "id");
        if (!(x > 0.0 && x < W)) continue;
        ++*n_pile;
        for (size_t k = 0; k < contacts.n_rows; k++)
            count += cell(&contacts, k, "id_a") == id || cell(&contacts, k, "id_b") == id;
    }
    return count / (double)*n_pile;
}

/* Outputs of the pile, computed from its tables. */
static void check_pile(const sweep_result *result, double W)
{
    double x[256], y[256], energy = 0.0, force = 0.0;
    const double mg = dem_mass(DEM_SPHERE, 1.0, 0.1) * 981.0, round_off = 1e-13; /* of sums of 50 */
    scoped_table t = read_table("t/pile_grains.tsv"), filled = read_table("t/filled_grains.tsv");
    const size_t n = t.n_rows;
    size_t n_pile, n_full;
    CU_ASSERT_FATAL(n > 0 && n <= 256);
    for (size_t i = 0; i < n; i++) {
        x[i] = cell(&t, i, "x"), y[i] = cell(&t, i, "y");
        if (!(x[i] > 0.0 && x[i] < W)) continue;
        const double vx = cell(&t, i, "vx"), vy = cell(&t, i, "vy");
        energy += 0.5 * cell(&t, i, "m") * (vx * vx + vy * vy);
        if (cell(&t, i, "contacts") > 0.0) force = fmax(force, hypot(cell(&t, i, "fx"), cell(&t, i, "fy")));
    }
    CHECK_NEAR(output(result, "contact_number"), contact_number("pile", W, &n_pile), round_off);
    contact_number("filled", W, &n_full);
    CU_ASSERT(output(result, "grains") == (double)n_pile && n_pile < n_full);
    CHECK_NEAR(output(result, "residual_energy") / (energy / (double)n_pile / (mg * 0.2)), 1.0, round_off);
    CHECK_NEAR(output(result, "residual_force") / (force / mg), 1.0, round_off);
    CU_ASSERT(output(result, "fill_steps_used") == cell(&filled, 0, "step"));
    CU_ASSERT(output(result, "relax_steps_used") == cell(&t, 0, "step") - cell(&filled, 0, "step"));
    const ang_options options = ANG_OPTIONS_DEFAULT;
    RP_ENDS(ang_surface_free) ang_surface s;
    ang_slope slopes[ANG_N_METHODS];
    CHECK_OK(ang_surface_make(n, x, y, NULL, W, &options, &s));
    CHECK_OK(ang_slopes(s.n, s.column, s.h, s.cell, options.parabola, slopes));
    double theta[3];
    for (int k = 0; k < 3; k++) theta[k] = slopes[k].theta * RADIAN_DEG;
    CHECK_EACH(output(result, NAME), ANGLE_TOLERANCE_DEG, {"theta_r1_deg", theta[0]},
               {"theta_r2_deg", theta[1]}, {"theta_r3_deg", theta[2]},
               {"theta_r3_error_deg", slopes[2].theta_se * RADIAN_DEG},
               {"theta_r12_deg", theta[0] - theta[1]}, {"theta_r23_deg", theta[1] - theta[2]});
    CU_ASSERT(output(result, "cells") == (double)s.n_occupied);
}

/* Number of grains of the pile, at[], that are farther than `reach` from their positions in the box, rotated
 * by `angle`, with the given number of contacts; or that are gone. */
static size_t moved(const dem_sim *sim, size_t n, const dem_state at[], double W, double angle, double reach,
                    int contacts, size_t *n_pile)
{
    size_t count = 0, j = 0;
    scoped dem_state *now = grains_states(sim);
    *n_pile = 0;
    for (size_t i = 0; i < n; i++) {
        if (!(at[i].x > 0.0 && at[i].x < W)) continue;
        ++*n_pile;
        while (j < dem_count(sim) && now[j].id < at[i].id) j++; /* both are in the order of id */
        if (j == dem_count(sim) || now[j].id != at[i].id) {
            count++;
            continue;
        }
        const double dx = now[j].x * cos(angle) - now[j].y * sin(angle) - at[i].x;
        const double dy = now[j].x * sin(angle) + now[j].y * cos(angle) - at[i].y;
        count += dx * dx + dy * dy > reach * reach && now[j].contacts >= contacts;
    }
    return count;
}

typedef struct {
    double W, deg_per_step;
    bool box;
} tilting;

static void turn(dem_sim *sim, const tilting *t, double deg_per_step)
{
    (t->box ? dem_box_turn : dem_gravity_turn)(sim, deg_per_step / RADIAN_DEG);
}

/* The tilts at which 5 % of the grains have moved by 0.1 d, and at which the energy exceeds that of the first
 * half degree tenfold and 1e-5 m g d. */
static void onset(dem_sim *sim, const tilting *t, double *displacement, double *energy)
{
    const size_t n = dem_count(sim);
    const long from = dem_step(sim), every = lround(fmin(10.0, 0.01 / t->deg_per_step));
    double sway = 0.0;
    scoped dem_state *at = grains_states(sim);
    turn(sim, t, t->deg_per_step);
    *displacement = *energy = NAN;
    while (isnan(*displacement) || isnan(*energy)) {
        CHECK_OK(dem_run(sim, every));
        const double deg = (double)(dem_step(sim) - from) * t->deg_per_step;
        size_t n_pile;
        dem_rest rest;
        const size_t gone = moved(sim, n, at, t->W, t->box ? deg / RADIAN_DEG : 0.0, 0.02, 0, &n_pile);
        CHECK_OK(dem_rest_state(sim, 0.0, t->W, &rest));
        if (isnan(*displacement) && 20 * gone >= n_pile) *displacement = deg;
        if (deg < 0.5 + 1e-9)
            sway = fmax(sway, rest.kinetic_energy);
        else if (isnan(*energy) &&
                 rest.kinetic_energy > fmax(10.0 * sway, 1e-5 * dem_mass(DEM_SPHERE, 1.0, 0.1) * 981.0 * 0.2))
            *energy = deg;
        if (deg > 60.0) break;
    }
}

/* The last tenth of a degree before a grain with two contacts or more moves by 0.5 d, at rest after each. */
static double static_onset(dem_sim *sim, const tilting *t)
{
    const size_t n = dem_count(sim);
    const double mg = dem_mass(DEM_SPHERE, 1.0, 0.1) * 981.0;
    scoped dem_state *at = grains_states(sim);
    for (int tenths = 1; tenths <= 600; tenths++) {
        turn(sim, t, t->deg_per_step);
        CHECK_OK(dem_run(sim, lround(0.1 / t->deg_per_step)));
        turn(sim, t, 0.0);
        for (int quiet = 0; quiet < 10;) {
            dem_rest rest;
            CHECK_OK(dem_run(sim, 500));
            CHECK_OK(dem_rest_state(sim, 0.0, t->W, &rest));
            quiet = rest.kinetic_energy < 1e-7 * mg * 0.2 && rest.net_force < 1e-2 * mg ? quiet + 1 : 0;
        }
        size_t n_pile;
        const double angle = t->box ? 0.1 * tenths / RADIAN_DEG : 0.0;
        if (moved(sim, n, at, t->W, angle, 0.1, 2, &n_pile) > 0) return 0.1 * (tenths - 1);
    }
    return NAN;
}

/* All outputs by a second method: of the pile from its tables, of the tilts from its scene. */
static void test_outputs(void)
{
    static const tilting cases[] = {{1.4, 1e-2, true}, {1.0, 5e-4, false}};
    for (int k = 0; k < (check_fast() ? 1 : 2); k++) {
        const tilting *t = &cases[k];
        sweep_result result;
        TRACED(&result, "theta_t=true theta_t_static=true",
               k == 0 ? "W=1.4 H=1.4 tilt=box tilt_rate_deg=0.01"
                      : "W=1 H=1 tilt=gravity tilt_rate_deg=0.0005");
        CU_ASSERT_STRING_EQUAL(result.status, "ok");
        CU_ASSERT_STRING_EQUAL(result.message, "");
        check_pile(&result, t->W);
        scoped_sim *sim = NULL, *again = NULL;
        double displacement, energy;
        box_again(&result, t->W, &sim);
        const long steps = dem_step(sim);
        CHECK_OK(dem_clone(sim, &again));
        onset(sim, t, &displacement, &energy);
        CHECK_EACH(output(&result, NAME), ANGLE_TOLERANCE_DEG, {"theta_t_displacement_deg", displacement},
                   {"theta_t_energy_deg", energy});
        CHECK_NEAR(output(&result, "theta_rt_deg"), output(&result, "theta_r3_deg") + displacement,
                   ANGLE_TOLERANCE_DEG);
        CHECK_NEAR(output(&result, "theta_t_static_deg"), static_onset(again, t), ANGLE_TOLERANCE_DEG);
        CU_ASSERT(output(&result, "steps") == (double)(dem_step(sim) - steps + dem_step(again)));
    }
}

/* Grains so rough that they only oscillate: tilted by 60 degrees in steps of 0.01, or
 * by tenths with rest of at least 5000 steps after each. */
static void test_stands(void)
{
    if (CHECK_SKIPS("a long run of code that others run")) return;
    static const char *const measures[] = {"theta_t=true", "theta_t_static=true"};
    for (int quasi_static = 0; quasi_static < 2; quasi_static++) {
        sweep_result result;
        TRACED(&result, "W=2 N=8 mu=10 floor=ends tilt_rate_deg=0.01", measures[quasi_static]);
        CU_ASSERT_STRING_EQUAL(result.status, "ok");
        CU_ASSERT(isnan(output(&result, "theta_t_displacement_deg")) &&
                  isnan(output(&result, "theta_t_static_deg")) && isnan(output(&result, "theta_rt_deg")));
        const double tilt = output(&result, "steps") - output(&result, "fill_steps_used") -
                            output(&result, "relax_steps_used");
        if (quasi_static) CU_ASSERT(tilt >= 600.0 * 5010.0 && tilt < 605.0 * 5010.0); /* some wait longer */
        if (!quasi_static) CHECK_NEAR(tilt, 6000.0, 1.0); /* sums of 0.01 end just below 60, or above */
    }
}

/* A slide longer than max_steps ends a quasi-static tilt; the angle is kept. */
static void test_restless(void)
{
    double theta[2];
    for (int bounded = 0; bounded < 2; bounded++) {
        sweep_result result;
        TRACED(&result, "W=1 H=1 theta_t_static=true tilt_rate_deg=0.01",
               bounded ? "max_steps=12500" : "max_steps=400000");
        CU_ASSERT_STRING_EQUAL(result.status, "ok");
        CU_ASSERT((output(&result, "restless") == 12500.0) == bounded);
        theta[bounded] = output(&result, "theta_t_static_deg");
    }
    CU_ASSERT(theta[0] > 1.0 && theta[1] == theta[0]);
}

static void test_refusals(void)
{
    static const struct {
        const char *settings;
        const char *message;
    } cases[] = {{"mu_roll=0.1", "mu_roll = 0.1: needs rotation = true"},
                 {"rotation=true integrator=gear5", "grains that rotate need the integrator verlet"},
                 {"slip=total", "needs stop = \"steps\""},
                 {"stop=steps theta_t_static=true", "needs stop = \"rest\""},
                 {"dt=2e-4", "dt = 0.0002: too large"},
                 {"integrator=gear5 dt=1e-4", "dt = 0.0001: too large"},
                 {"radius_min=0.11", "radius_mean = 0.1: must lie between"},
                 {"W=0.9", "at least five grain diameters expected (W >= 5*d; W = 0.9)"}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        protocol = protocol_of(&sweep_protocol_repose);
        scoped void *params = PROTOCOL_PARAMS(protocol, cases[i].settings);
        CHECK_FAILS(protocol->check(params), RP_BAD_INPUT, cases[i].message);
    }
}

/* Most steps of a phase, a whole number: 4e5, times 500/gamma_n and (H/4)^2 where these exceed 1; at most
 * 2e9. */
static void test_patience(void)
{
    static const struct {
        const char *changes[3];
        double steps;
    } cases[] = {{{"H=4"}, 400000},
                 {{"gamma_n=5000"}, 400000},
                 {{"gamma_n=125", "H=2"}, 1600000},
                 {{"gamma_n=0.5"}, 200000000},
                 {{"H=6"}, 900000},
                 {{"gamma_n=300"}, 666667},
                 {{"gamma_n=0"}, 200000000},
                 {{"gamma_n=50", "H=400"}, 2000000000},
                 {{"gamma_n=50", "max_steps=7000"}, 7000}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        dem_text text;
        scoped_scene scene = {0};
        double steps = 0.0;
        scene_with(cases[i].changes, &text, &scene);
        for (size_t k = 0; k < text.lets.n; k++)
            if (strcmp(text.lets.lets[k].name, "max_steps") == 0) steps = text.lets.lets[k].is.value;
        CHECK_NEAR(steps, cases[i].steps, 0.0);
        dem_text_close(&text);
    }
}

/* Grains fill a box from twice its height: the time step allows for such a fall of two smallest ones. */
static void test_limit_of_step(void)
{
    static const sweep_protocol *const filled[] = {&sweep_protocol_repose, &sweep_protocol_stress,
                                                   &sweep_protocol_onset};
    const double m = 4.0 / 3.0 * M_PI * 0.343e-3;
    const dem_grain two[] = {{.y = 0.0, .r = 0.07, .m = m}, {.y = 180.0, .r = 0.07, .m = m}};
    for (size_t k = 0; k < sizeof filled / sizeof *filled; k++) {
        dem_text text;
        scoped_scene scene = {0};
        CHECK_OK(dem_text_open("box", filled[k]->text, NULL, &text));
        CHECK_OK(dem_text_scene(&text, &scene));
        scene.def.grains = two, scene.def.n_grains = 2;
        const double limit = dem_time_step_limit(&scene.def, NULL);
        scene.def.grains = NULL, scene.def.n_grains = 0;
        dem_text_close(&text);
        protocol = protocol_of(filled[k]);
        CU_ASSERT(strtod(rp_params_find(protocol->schema, "rest_energy")->fallback, NULL) == DEM_REST_ENERGY);
        CU_ASSERT(strtod(rp_params_find(protocol->schema, "rest_force")->fallback, NULL) == DEM_REST_FORCE);
        for (int above = 0; above < 2; above++) {
            const char *dt = check_text("dt=%.17g", limit * (1.0 + (above ? 1e-9 : -1e-9)));
            scoped void *params = PROTOCOL_PARAMS(protocol, "H=90", dt);
            CHECK_FAILS_IF(above, protocol->check(params), RP_BAD_INPUT, "too large for");
        }
    }
}

CHECK_SUITE_WITHIN(repose, "protocol repose", enter, leave, test_surfaces, test_limit_of_step,
                   test_small_halves, test_bond_order, test_frictions, test_keys_of_the_scene, test_names,
                   test_ramp, test_ramp_where_soft, test_outputs, test_stands, test_restless, test_patience,
                   test_refusals)
