/* Protocol `repose`: fill a box, open its right wall, wait for rest, measure the slope; then, if asked,
 * tilt until the pile moves (Lee & Herrmann 1993, sections 3 and 4). What the paper leaves unsaid is a
 * parameter here, with its meaning in the schema. */
#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "experiment/modules/module.h"
#include "sweeps/protocols/box.h"
#include "sweeps/engine/physics.h"

enum { FILL_DROP, FILL_RAMP, FILL_AUTO };
enum { STOP_REST, STOP_STEPS };
enum { TILT_GRAVITY, TILT_BOX };
enum { MEASURE_THETA_R = 1, MEASURE_THETA_T = 2, MEASURE_THETA_T_STATIC = 4 };

typedef struct {
    sweep_box box;
    double tilt_rate_deg;
    long relax_steps;
    int fill, stop, tilt;
    unsigned measure;
} repose_params;

#define AT(field) offsetof(repose_params, field)

/* clang-format off */
static const rp_param schema[] = {
    SWEEP_BOX_PHYSICS
    SWEEP_BOX_WIDTH_ROW
    SWEEP_BOX_COUNT_ROWS
    SWEEP_BOX_WALL_ROWS
    SWEEP_BOX_OPENING_ROWS
    SWEEP_ROW(floor_grains, "", RP_BOOL, "false", "",
              "a row of fixed grains of the mean radius for a floor, tops at y = 0; touched as any other grain")
    {"fill", "", RP_CHOICE, AT(fill), "auto", "drop | ramp | auto",
     "gravity from the start, or growing from 0 in the first half of fill_steps; auto: growing where a fall "
     "would press grains in by half the smallest radius"},
    SWEEP_BOX_FILL_STEPS_ROW
    {"stop", "", RP_CHOICE, AT(stop), "rest", "rest | steps",
     "measure at rest, or relax_steps after an opening at fill_steps, at rest or not"},
    {"relax_steps", "", RP_INT, AT(relax_steps), "50000", "[1, 1000000000]",
     "steps after the opening for stop = steps"},
    SWEEP_BOX_REST_ROWS
    SWEEP_BOX_MAX_STEPS_ROW
    {"measure", "", RP_FLAGS, AT(measure), "theta_r", "theta_r | theta_t | theta_t_static",
     "slopes (always); tilt at a rate; tilt by 0.1 degree from rest to rest"},
    {"tilt", "", RP_CHOICE, AT(tilt), "gravity", "gravity | box",
     "what turns: gravity, or the walls about the origin, as in the paper"},
    {"tilt_rate_deg", "degree", RP_REAL, AT(tilt_rate_deg), "1e-3", "[1e-6, 0.01]", "turn a step"},
    SWEEP_BOX_SURFACE_ROWS
    {0}};
/* clang-format on */

/* The variants of the surface, four slopes each. */
#define ONE(height, empty) +1
enum { N_SURFACES = 0 ANG_SURFACES(ONE), N_SLOPES = ANG_N_METHODS + 1 };

/* clang-format off */
#define SLOPES(X) \
    X(theta_r1_deg, "degree", "slope by method 1, first to last cell") \
    X(theta_r2_deg, "degree", "slope by method 2, straight line") \
    X(theta_r3_deg, "degree", "slope by method 3, parabola through the running sum")
#define OUTPUTS(X) \
    X(theta_r3_error_deg, "degree", "standard error of method 3 within the pile") \
    X(theta_r12_deg, "degree", "method 1 less method 2, of the same pile") \
    X(theta_r23_deg, "degree", "method 2 less method 3, of the same pile") \
    X(theta_t_displacement_deg, "degree", "tilt at which 5 % of the grains have moved 0.1 d") \
    X(theta_t_energy_deg, "degree", "tilt at which the kinetic energy exceeds 1e-5 m g d and the sway") \
    X(theta_t_static_deg, "degree", "last quasi-static tilt before a grain moves 0.5 d") \
    X(theta_rt_deg, "degree", "theta_r3 + theta_t by displacement") \
    X(theta_lower_less_upper_deg, "degree", "straight line through the cells right of W/2, to the opening, less that through those left of W/2") \
    X(theta_upper_deg, "degree", "straight line through the cells left of W/2, the upper half") \
    X(psi6, "", "mean |psi_6| of the grains in the filled box with two or more neighbours") \
    X(grains, "", "grains with 0 < x < W in the pile") \
    X(cells, "", "occupied cells of the surface") \
    X(fill_steps_used, "", "steps until the filled box was at rest") \
    X(relax_steps_used, "", "steps from the opening to rest") \
    X(steps, "", "steps in all") \
    X(contact_number, "", "contacts a grain in the pile") \
    X(residual_energy, "m g d", "mean kinetic energy of the pile") \
    X(residual_force, "m g", "largest net force on a grain with a contact")
#define SURFACE(X, height, empty) \
    X(theta_r1_##height##_##empty##_deg, "degree", "method 1 for height = " #height ", empty = " #empty) \
    X(theta_r2_##height##_##empty##_deg, "degree", "method 2 for height = " #height ", empty = " #empty) \
    X(theta_r3_##height##_##empty##_deg, "degree", "method 3, parabola = free, for height = " #height ", empty = " #empty) \
    X(theta_r3_##height##_##empty##_origin_deg, "degree", "method 3, parabola = origin, for height = " #height ", empty = " #empty)
#define SURFACE_MEMBERS(height, empty) SURFACE(SWEEP_OUTPUT_MEMBER, height, empty)
#define SURFACE_ROWS(height, empty) SURFACE(SWEEP_OUTPUT_ROW, height, empty)
/* clang-format on */
typedef struct {
    SWEEP_FAMILY(theta_deg[ANG_N_METHODS], SLOPES(SWEEP_OUTPUT_MEMBER))
    OUTPUTS(SWEEP_OUTPUT_MEMBER)
    SWEEP_FAMILY(surface_deg[N_SURFACES][N_SLOPES], ANG_SURFACES(SURFACE_MEMBERS))
} repose_values;
static const sweep_output outputs[] = {SLOPES(SWEEP_OUTPUT_ROW) OUTPUTS(SWEEP_OUTPUT_ROW)
                                           ANG_SURFACES(SURFACE_ROWS){0}};

/* One run in the making. */
typedef struct {
    const repose_params *p;
    sweep_box_run box;
    repose_values *v; /* of the result */
} experiment;

static rp_status check(const void *params)
{
    const repose_params *p = params;
    RP_TRY(sweep_box_check_fill(&p->box));
    if (p->tilt == TILT_BOX && p->measure & (MEASURE_THETA_T | MEASURE_THETA_T_STATIC)) {
        dem_scene turned;
        sweep_box_scene(&p->box, &turned);
        turned.def.box_turn_per_step = p->tilt_rate_deg * (M_PI / 180.0);
        RP_TRY(dem_physics_check(&turned.def));
    }
    if (p->stop == STOP_REST && p->box.physics.slip == DEM_TOTAL)
        return rp_fail(
            RP_BAD_INPUT,
            "slip = \"total\": the untruncated spring never comes to rest; needs stop = \"steps\"");
    if (p->stop == STOP_STEPS && p->measure & MEASURE_THETA_T_STATIC)
        return rp_fail(RP_BAD_INPUT,
                       "measure = theta_t_static: goes from rest to rest; needs stop = \"rest\"");
    if (p->box.floor_grains && p->tilt == TILT_BOX && p->measure & (MEASURE_THETA_T | MEASURE_THETA_T_STATIC))
        return rp_fail(RP_BAD_INPUT,
                       "tilt = \"box\": a floor of fixed grains cannot turn; needs tilt = \"gravity\"");
    return RP_OK;
}

/* The grains that fall, then those of the floor. */
static rp_status place_grains(experiment *e)
{
    dem_scene *s = &e->box.scene;
    const size_t n = (size_t)s->fill.N, n_floor = sweep_box_floor(&e->p->box, NULL);
    if (n_floor == 0) return RP_OK; /* the scene's own fill */
    s->grains = malloc((n + n_floor) * sizeof *s->grains);
    if (!s->grains) return rp_fail(RP_NO_MEMORY, "fill: out of memory");
    s->has_fill = false;
    s->def.grains = s->grains;
    s->def.n_grains = n + sweep_box_floor(&e->p->box, s->grains + n);
    return dem_fill_random(&s->fill, s->grains);
}

/* With `auto` gravity grows where the fall from 2 H would press two grains of the mean radius into each other
 * by more than half of the smallest radius, without damping: where half m_eff v^2 exceeds the energy of the
 * spring there. */
static bool fills_by_ramp(const repose_params *p)
{
    const sweep_box *b = &p->box;
    const double m_eff = 0.5 * dem_mass(b->physics.shape, b->physics.density, b->radius_mean),
                 impact = m_eff * b->g * 2.0 * b->H,
                 spring =
                     dem_normal_descriptors[b->physics.normal].potential(b->physics.k_n, 0.5 * b->radius_min);
    return p->fill == FILL_RAMP || (p->fill == FILL_AUTO && impact > spring);
}

static long ramp_steps(const experiment *e)
{
    return fills_by_ramp(e->p) ? e->p->box.fill_steps / 2 : 0;
}

/* ---- Phases, each from where the last one ends, or from where a snapshot was written ---- */

static rp_status note_filling(experiment *e, rp_status status)
{
    e->v->fill_steps_used = (double)dem_step(e->box.sim);
    return status;
}

static rp_status ramp_gravity(experiment *e)
{
    const long steps = ramp_steps(e);
    long k = 1;
    rp_status status = RP_OK;
    SWEEP_ENTER(e->box.keep, k);
    for (; !status && k <= steps; k++) {
        dem_gravity_set(e->box.sim, (double[]){0.0, -e->p->box.g * (double)k / (double)steps});
        status = sweep_box_advance(&e->box, 1);
    }
    sweep_keep_leave(e->box.keep, 1);
    return note_filling(e, status);
}

static rp_status start_box(experiment *e)
{
    rp_status status = place_grains(e);
    return status ? status : sweep_box_start(&e->box);
}

static rp_status fall(experiment *e)
{
    return note_filling(e, sweep_box_advance(&e->box, e->p->box.fill_steps - ramp_steps(e)));
}

static rp_status fill_to_rest(experiment *e)
{
    rp_status status = e->p->stop == STOP_REST ? sweep_box_settle(&e->box, "filling", false) : RP_OK;
    note_filling(e, status);
    if (!status) status = dem_states(e->box.sim, e->box.states);
    if (status) return status;
    e->v->psi6 = exp_bond_order(dem_count(e->box.sim), e->box.states, NULL, NULL);
    return sweep_state_write(e->box.tables, e->box.sim, "filled");
}

static rp_status open_box(experiment *e)
{
    long opened_at = dem_step(e->box.sim);
    SWEEP_ENTER(e->box.keep, opened_at);
    rp_status status = sweep_box_open(&e->box, e->p->stop == STOP_REST ? 0 : e->p->relax_steps);
    e->v->relax_steps_used = (double)(dem_step(e->box.sim) - opened_at);
    sweep_keep_leave(e->box.keep, 1);
    return status;
}

/* Outputs of any state. */
static rp_status note_state(experiment *e)
{
    repose_values *const v = e->v;
    dem_rest rest;
    bool quiet;
    RP_TRY(sweep_box_rest(&e->box, &rest, &quiet));
    v->grains = (double)rest.n;
    v->contact_number = rest.contact_number;
    v->residual_energy = rest.kinetic_energy / (e->box.mg * e->box.d);
    v->residual_force = rest.net_force / e->box.mg;
    return RP_OK;
}

/* Straight line through the cells in use from column `from` to before `to`. */
static rp_status local_slope(const ang_surface *s, size_t from, size_t to, double *theta_deg)
{
    size_t first = 0, n = 0;
    for (size_t k = 0; k < s->n; k++) {
        first += s->column[k] < from;
        n += s->column[k] >= from && s->column[k] < to;
    }
    return sweep_box_line(s, first, n, theta_deg);
}

/* The middle cell of an odd number belongs to neither half. */
static rp_status measure_halves(experiment *e)
{
    double *const upper = &e->v->theta_upper_deg, lower = NAN;
    const ang_options options = sweep_box_options(&e->p->box);
    ang_surface s;
    rp_status status = sweep_box_surface(&e->box, &options, &s);
    if (!status) status = local_slope(&s, 0, s.n_cells / 2, upper);
    if (!status) status = local_slope(&s, s.n_cells - s.n_cells / 2, s.n_cells, &lower);
    e->v->theta_lower_less_upper_deg = lower - *upper;
    ang_surface_free(&s);
    return status;
}

/* All readings of the same surface. */
static rp_status measure_variants(experiment *e)
{
    rp_status status = RP_OK;
    for (int k = 0; !status && k < N_SURFACES; k++) {
        double *const theta_deg = e->v->surface_deg[k];
        const ang_options options = {e->box.d, (ang_height)(k / 2), (ang_empty)(k % 2), ANG_PARABOLA_FREE};
        ang_surface s;
        ang_slope free[ANG_N_METHODS], origin[ANG_N_METHODS];
        status = sweep_box_surface(&e->box, &options, &s);
        if (!status) status = ang_slopes(s.n, s.column, s.h, s.cell, ANG_PARABOLA_FREE, free);
        if (!status) status = ang_slopes(s.n, s.column, s.h, s.cell, ANG_PARABOLA_ORIGIN, origin);
        ang_surface_free(&s);
        if (status) break;
        for (int m = 0; m < ANG_N_METHODS; m++) theta_deg[m] = sweep_degrees(free[m].theta);
        theta_deg[ANG_N_METHODS] = sweep_degrees(origin[2].theta);
    }
    return status;
}

static rp_status measure_pile(experiment *e)
{
    repose_values *const v = e->v;
    ang_slope slopes[ANG_N_METHODS];
    RP_TRY(note_state(e));
    RP_TRY(sweep_box_pile_slopes(&e->box, slopes));
    for (int m = 0; m < ANG_N_METHODS; m++) v->theta_deg[m] = sweep_degrees(slopes[m].theta);
    v->theta_r3_error_deg = sweep_degrees(slopes[2].theta_se);
    v->theta_r12_deg = v->theta_r1_deg - v->theta_r2_deg;
    v->theta_r23_deg = v->theta_r2_deg - v->theta_r3_deg;
    RP_TRY(measure_halves(e));
    return measure_variants(e);
}

static void turn(experiment *e, double deg_per_step)
{
    (e->p->tilt == TILT_BOX ? dem_box_turn : dem_gravity_turn)(e->box.sim, deg_per_step * (M_PI / 180.0));
}

static rp_status tilt_at_rate(experiment *e)
{
    repose_values *const v = e->v;
    /* the tilt that resumes has its positions */
    rp_status status = sweep_keep_resumes(e->box.keep) ? RP_OK : sweep_box_note(&e->box);
    if (!status)
        status = sweep_box_tilt(&e->box, e->p->tilt == TILT_BOX, e->p->tilt_rate_deg,
                                &v->theta_t_displacement_deg, &v->theta_t_energy_deg);
    v->theta_rt_deg = v->theta_r3_deg + v->theta_t_displacement_deg;
    if (!status && (isnan(v->theta_t_displacement_deg) || isnan(v->theta_t_energy_deg)))
        snprintf(e->box.result->message, sizeof e->box.result->message,
                 "tilt: stable, by a criterion, at 60 degrees");
    return status;
}

/* It turns by 0.1 degree at the same rate, then waits for rest; the last angle at which no grain with
 * two contacts had moved half a diameter. */
static rp_status tilt_quasi_static(experiment *e)
{
    const double step_deg = 0.1, most_deg = 60.0;
    const long steps = lround(step_deg / e->p->tilt_rate_deg);
    enum { TO_TURN, TURNS, WAITS };
    struct {
        double turned;
        int part;
    } now = {0.0, TO_TURN};
    rp_status status = SWEEP_ENTER(e->box.keep, now) ? sweep_box_note(&e->box) : RP_OK;
    for (; !status && now.turned < most_deg; now.turned += step_deg) {
        if (now.part == TO_TURN) turn(e, step_deg / (double)steps);
        if (now.part != WAITS) {
            now.part = TURNS;
            status = sweep_box_advance(&e->box, steps);
            turn(e, 0.0);
        }
        now.part = WAITS;
        if (!status) status = sweep_box_settle(&e->box, "quasi-static tilt", false);
        const bool restless = strcmp(e->box.result->status, "not_at_rest") == 0;
        if (restless) status = RP_OK;
        size_t moved = 0;
        if (!status) status = sweep_box_moved(&e->box, 0.5 * e->box.d, 2, &moved);
        if (!status && moved > 0) e->v->theta_t_static_deg = now.turned;
        if (moved > 0 || restless) break; /* restless without moving: no angle, the message says why */
        now.part = TO_TURN;
    }
    sweep_keep_leave(e->box.keep, 1);
    return status;
}

/* Both tilts start from the pile at rest. */
static rp_status tilt_pile(experiment *e)
{
    const bool at_rate = e->p->measure & MEASURE_THETA_T, by_steps = e->p->measure & MEASURE_THETA_T_STATIC;
    bool second = !at_rate;
    rp_status status = RP_OK;
    if (SWEEP_ENTER(e->box.keep, second) && at_rate && by_steps)
        status = dem_clone(e->box.sim, &e->box.rested);
    if (!status && !second) status = tilt_at_rate(e);
    if (!status) sweep_box_go_back(&e->box);
    second = true;
    if (!status && by_steps) status = tilt_quasi_static(e);
    sweep_keep_leave(e->box.keep, 1);
    return status;
}

static rp_status write_scene(experiment *e)
{
    sweep_file f;
    if (!e->box.tables || fills_by_ramp(e->p)) return RP_OK; /* no scene has a ramp */
    RP_TRY(sweep_table_open(e->box.tables, "scene.cfg", &f));
    e->box.scene.steps = dem_step(e->box.sim);
    dem_scene_write(&e->box.scene, f.out);
    return sweep_table_close(&f, RP_OK);
}

static rp_status note_pile(experiment *e)
{
    RP_TRY(measure_pile(e));
    RP_TRY(sweep_state_write(e->box.tables, e->box.sim, "pile"));
    return write_scene(e);
}

/* The experiment from an empty box to its last measurement. */
static rp_status run_phases(experiment *e)
{
    static rp_status (*const phases[])(experiment *) = {start_box, ramp_gravity, fall,     fill_to_rest,
                                                        open_box,  note_pile,    tilt_pile};
    size_t phase = 0;
    rp_status status = RP_OK;
    SWEEP_ENTER(e->box.keep, phase);
    for (; phase < sizeof phases / sizeof *phases && !status; phase++) status = phases[phase](e);
    sweep_keep_leave(e->box.keep, 1);
    if (!status)
        status = sweep_conclude(e->box.result, e->p->stop == STOP_REST ? "ok" : "ok_fixed_time", NULL);
    e->v->steps = sweep_box_steps(&e->box);
    if (status != RP_NO_RESULT || !e->box.sim) return status;
    /* a run without a result leaves what there is to look at */
    rp_status left = note_state(e);
    if (!left) left = sweep_state_write(e->box.tables, e->box.sim, "pile");
    if (!left) left = write_scene(e);
    return left ? left : status;
}

static rp_status run_one(const void *params, unsigned long seed, unsigned long run,
                         const sweep_tables *tables, sweep_result *result)
{
    const repose_params *p = params;
    experiment e = {.p = p, .v = (void *)result->values};
    rp_status status = sweep_box_begin_filled(&e.box, &p->box, seed, run, tables, result);
    if (!status) status = run_phases(&e);
    e.v->cells = e.box.cells;
    return sweep_box_end(&e.box, status);
}

/* Short runs through all phases but the quasi-static tilt, with three floors. */
static rp_status fingerprint(char digits[33])
{
    enum { N_RUNS = 3 };
    static const char hashed[] =
        "theta_r1_deg theta_r2_deg theta_r3_deg theta_t_displacement_deg theta_t_energy_deg "
        "theta_lower_less_upper_deg theta_upper_deg psi6 grains cells contact_number residual_energy "
        "residual_force";
    repose_params p[N_RUNS];
    sweep_result results[N_RUNS];
    for (int k = 0; k < N_RUNS; k++) {
        rp_params_defaults(schema, &p[k]);
        p[k].box.W = p[k].box.H = 1.0;
        p[k].stop = STOP_STEPS;
        p[k].box.fill_steps = p[k].relax_steps = 800;
        p[k].measure = MEASURE_THETA_R | MEASURE_THETA_T;
        p[k].tilt_rate_deg = 0.01;
    }
    p[1].box.floor = SWEEP_FLOOR_ENDS;
    p[1].tilt = TILT_BOX;
    p[2].box.floor_grains = true;
    p[2].fill = FILL_RAMP;
    for (int k = 0; k < N_RUNS; k++) RP_TRY(run_one(&p[k], 1, (unsigned long)k, NULL, &results[k]));
    sweep_results_digits(N_RUNS, results, outputs, hashed, digits);
    return sweep_physics_add(digits);
}

SWEEP_PROTOCOL(repose, schema, repose_params, repose_values, check,
               "fill a box, open its right wall, measure the slope at rest, tilt (Lee & Herrmann 1993)");
