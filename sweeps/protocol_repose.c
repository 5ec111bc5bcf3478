/* Protocol `repose`: fill a box, open its right wall, wait for rest, measure the slope; then, if asked,
 * tilt until the pile moves (Lee & Herrmann 1993, sections 3 and 4). What the paper leaves unsaid is a
 * parameter here, with its meaning in the schema. */
#include "sweeps/protocol_repose.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <xxhash.h>

#include "angle/angle.h"
#include "core/table.h"
#include "dem/scene.h"

enum { FLOOR_EXTENDS, FLOOR_ENDS, FLOOR_ABSORBS };
enum { STOP_REST, STOP_STEPS };
enum { MEASURE_THETA_R = 1, MEASURE_THETA_T = 2, MEASURE_THETA_T_STATIC = 4 };

typedef struct {
    double W, H, mu, mu_wall, k_n, k_n_wall, k_s, gamma_n, gamma_s, density;
    double radius_mean, radius_width, radius_min, radius_max, g, dt, open;
    double rest_energy, rest_force, tilt_rate_deg;
    long N, fill_steps, relax_steps, max_steps;
    int shape, integrator, slip, floor, stop, tilt, height, empty, parabola;
    bool tension;
    unsigned measure;
} repose_params;

#define AT(field) offsetof(repose_params, field)

static const rp_param schema[] = {
    {"W", "cm", RP_REAL, AT(W), "4.0", "(0, 1000]", "width of the box"},
    {"H", "cm", RP_REAL, AT(H), "4.0", "(0, 1000]", "height that the grains are counted for"},
    {"N", "", RP_INT, AT(N), "auto", "[1, 10000000] | auto", "number of grains; auto: W H / d^2"},
    {"mu", "", RP_REAL, AT(mu), "0.2", "[0, inf) | infinite", "friction between grains"},
    {"mu_wall", "", RP_REAL, AT(mu_wall), "auto", "[0, inf) | infinite | auto",
     "of floor and walls; auto: mu"},
    {"k_n", "dyn/cm^1.5", RP_REAL, AT(k_n), "1e6", "(0, inf)", "normal stiffness"},
    {"k_n_wall", "dyn/cm^1.5", RP_REAL, AT(k_n_wall), "auto", "(0, inf) | auto",
     "of floor and walls; auto: 2 k_n"},
    {"k_s", "dyn/cm", RP_REAL, AT(k_s), "1e4", "(0, inf)", "shear stiffness"},
    {"gamma_n", "1/s", RP_REAL, AT(gamma_n), "500.0", "[0, inf)", "normal damping"},
    {"gamma_s", "1/s", RP_REAL, AT(gamma_s), "auto", "[0, inf) | auto", "shear damping; auto: gamma_n/100"},
    {"density", "g/cm^3", RP_REAL, AT(density), "1.0", "(0, inf)", "of the grains (disk: g/cm^2)"},
    {"shape", "", RP_CHOICE, AT(shape), "sphere", "sphere | disk", "gives the mass from the density"},
    {"radius_mean", "cm", RP_REAL, AT(radius_mean), "0.1", "(0, inf)", "of the Gaussian; d is twice this"},
    {"radius_width", "cm", RP_REAL, AT(radius_width), "0.02", "[0, inf)",
     "standard deviation before the cut"},
    {"radius_min", "cm", RP_REAL, AT(radius_min), "0.07", "(0, inf)", "drawn again below"},
    {"radius_max", "cm", RP_REAL, AT(radius_max), "0.13", "(0, inf)", "drawn again above"},
    {"g", "cm/s^2", RP_REAL, AT(g), "981.0", "(0, inf)", "gravity"},
    {"dt", "s", RP_REAL, AT(dt), "5e-5", "(0, inf)", "time step"},
    {"integrator", "", RP_CHOICE, AT(integrator), "verlet", "verlet", "time integration"},
    {"slip", "", RP_CHOICE, AT(slip), "truncated", "truncated | total",
     "shear spring of a sliding contact: cut at the Coulomb limit, or as (2b) is printed"},
    {"tension", "", RP_BOOL, AT(tension), "true", "", "whether the damped normal force may pull, as printed"},
    {"floor", "", RP_CHOICE, AT(floor), "extends", "extends | ends | absorbs",
     "beyond the opening: goes on (out at 3 W), ends in a corner at W, or takes grains out at W"},
    {"open", "cm/s", RP_REAL, AT(open), "instant", "(0, inf) | instant",
     "speed at which the right wall is lifted"},
    {"fill_steps", "", RP_INT, AT(fill_steps), "30000", "[1, 1000000000]", "least steps of filling"},
    {"stop", "", RP_CHOICE, AT(stop), "rest", "rest | steps",
     "measure at rest, or relax_steps after an opening at fill_steps, at rest or not"},
    {"relax_steps", "", RP_INT, AT(relax_steps), "50000", "[1, 1000000000]",
     "steps after the opening for stop = steps"},
    {"rest_energy", "m g d", RP_REAL, AT(rest_energy), "1e-7", "(0, inf)",
     "at rest: mean kinetic energy below"},
    {"rest_force", "m g", RP_REAL, AT(rest_force), "1e-2", "(0, inf)", "at rest: largest net force below"},
    {"max_steps", "", RP_INT, AT(max_steps), "auto", "[5000, 2000000000] | auto",
     "most steps a phase; auto: 4e5, times 500/gamma_n and (H/4)^2 where these exceed 1"},
    {"measure", "", RP_FLAGS, AT(measure), "theta_r", "theta_r | theta_t | theta_t_static",
     "slopes (always); tilt at a rate; tilt by 0.1 degree from rest to rest"},
    {"tilt", "", RP_CHOICE, AT(tilt), "gravity", "gravity", "what turns"},
    {"tilt_rate_deg", "degree", RP_REAL, AT(tilt_rate_deg), "1e-3", "[1e-6, 0.01]", "turn of gravity a step"},
    {"height", "", RP_CHOICE, AT(height), "centre", ANG_HEIGHT_WORDS,
     "h of a cell: highest centre less d/2, highest centre, highest point"},
    {"empty", "", RP_CHOICE, AT(empty), "zero", ANG_EMPTY_WORDS, "empty cells: height 0, or left out"},
    {"parabola", "", RP_CHOICE, AT(parabola), "free", ANG_PARABOLA_WORDS, "of method 3"},
    {0}};

/* Places of the outputs in sweep_result.values; the list below has the same order. */
enum {
    OUT_THETA_R1,
    OUT_THETA_R2,
    OUT_THETA_R3,
    OUT_THETA_R3_SE,
    OUT_THETA_R12,
    OUT_THETA_R23,
    OUT_THETA_T_DISPLACEMENT,
    OUT_THETA_T_ENERGY,
    OUT_THETA_T_STATIC,
    OUT_THETA_RT,
    OUT_GRAINS,
    OUT_CELLS,
    OUT_FILL_STEPS,
    OUT_RELAX_STEPS,
    OUT_STEPS,
    OUT_CONTACT_NUMBER,
    OUT_ENERGY,
    OUT_FORCE,
    N_OUTPUTS
};
static const sweep_output outputs[] = {
    {"theta_r1_deg", "degree", "slope by method 1, first to last cell"},
    {"theta_r2_deg", "degree", "slope by method 2, straight line"},
    {"theta_r3_deg", "degree", "slope by method 3, parabola through the running sum"},
    {"theta_r3_error_deg", "degree", "standard error of method 3 within the pile"},
    {"theta_r12_deg", "degree", "method 1 less method 2, of the same pile"},
    {"theta_r23_deg", "degree", "method 2 less method 3, of the same pile"},
    {"theta_t_displacement_deg", "degree", "tilt at which 5 % of the grains have moved 0.1 d"},
    {"theta_t_energy_deg", "degree", "tilt at which the kinetic energy exceeds 1e-5 m g d and the sway"},
    {"theta_t_static_deg", "degree", "last quasi-static tilt before a grain moves 0.5 d"},
    {"theta_rt_deg", "degree", "theta_r3 + theta_t by displacement"},
    {"grains", "", "grains with 0 < x < W in the pile"},
    {"cells", "", "occupied cells of the surface"},
    {"fill_steps_used", "", "steps until the filled box was at rest"},
    {"relax_steps_used", "", "steps from the opening to rest"},
    {"steps", "", "steps in all"},
    {"contact_number", "", "contacts a grain in the pile"},
    {"residual_energy", "m g d", "mean kinetic energy of the pile"},
    {"residual_force", "m g", "largest net force on a grain with a contact"},
    {NULL, NULL, NULL}};

/* One run in the making. */
typedef struct {
    const repose_params *p;
    sweep_result *result;
    dem_scene scene;
    dem_sim *sim;
    dem_state *states; /* room for N */
    double *work;      /* room for 3 N */
    double d, mg;      /* nominal diameter; weight of a grain of the mean radius */
    long max_steps;
    long steps_before; /* of a simulation that was tilted before this one */
    long every;        /* of the energy trace; 0 for none */
    FILE *energy;
} experiment;

static double degrees(double radians)
{
    return radians * (180.0 / M_PI);
}

static long grain_number(const repose_params *p)
{
    return p->N > 0 ? p->N : lround(p->W * p->H / (4.0 * p->radius_mean * p->radius_mean));
}

static void make_scene(const repose_params *p, unsigned long seed, unsigned long run, dem_scene *scene)
{
    const double d = 2.0 * p->radius_mean;
    dem_definition def = dem_definition_default();
    def.gravity[1] = -p->g;
    def.dt = p->dt;
    def.slip = p->slip;
    def.tension = p->tension;
    def.material =
        (dem_material){p->k_n, p->gamma_n, p->k_s, p->gamma_s < 0.0 ? p->gamma_n / 100.0 : p->gamma_s, p->mu};
    dem_material wall = def.material;
    wall.k_n = p->k_n_wall < 0.0 ? 2.0 * p->k_n : p->k_n_wall;
    wall.mu = p->mu_wall < 0.0 ? p->mu : p->mu_wall;
    dem_box_walls(&def, p->W, &wall);
    def.walls[DEM_BOX_RIGHT].open_speed = p->open;
    if (isfinite(p->open)) def.walls[DEM_BOX_RIGHT].extent[0] = 0.0;
    def.x_max = p->floor == FLOOR_ABSORBS ? p->W : 3.0 * p->W;
    if (p->floor == FLOOR_ENDS) {
        def.walls[DEM_BOX_FLOOR].extent[1] = p->W;
        def.y_min = -2.0 * d;
    }
    *scene = (dem_scene){.def = def, .has_fill = true};
    scene->fill =
        (dem_fill){grain_number(p), p->W,       2.0 * p->H, p->radius_mean, p->radius_width, p->radius_min,
                   p->radius_max,   p->density, p->shape,   (long)seed,     (long)run};
}

static rp_status check(const void *params)
{
    const repose_params *p = params;
    if (!(p->radius_min <= p->radius_mean && p->radius_mean <= p->radius_max))
        return rp_fail(RP_BAD_INPUT, "radius_mean = %g: must lie between radius_min = %g and radius_max = %g",
                       p->radius_mean, p->radius_min, p->radius_max);
    if (p->W < 10.0 * p->radius_mean)
        return rp_fail(RP_BAD_INPUT, "W = %g: at least five grain diameters (%g) expected", p->W,
                       10.0 * p->radius_mean);
    if (grain_number(p) < 1)
        return rp_fail(RP_BAD_INPUT, "W = %g, H = %g: no room for one grain", p->W, p->H);
    if (p->stop == STOP_REST && p->slip == DEM_TOTAL)
        return rp_fail(
            RP_BAD_INPUT,
            "slip = \"total\": the untruncated spring never comes to rest; needs stop = \"steps\"");
    if (p->stop == STOP_STEPS && p->measure & MEASURE_THETA_T_STATIC)
        return rp_fail(RP_BAD_INPUT,
                       "measure = theta_t_static: goes from rest to rest; needs stop = \"rest\"");
    /* the lightest grain that can be drawn, falling from the top of the filling region */
    dem_scene scene;
    make_scene(p, 0, 0, &scene);
    double m = dem_mass(p->shape, p->density, p->radius_width > 0.0 ? p->radius_min : p->radius_mean);
    dem_grain two[2] = {{0.0, 0.0, p->radius_min, m, 0.0, 0.0},
                        {0.0, 2.0 * p->H, p->radius_min, m, 0.0, 0.0}};
    scene.def.grains = two;
    scene.def.n_grains = 2;
    const char *what;
    double limit = dem_time_step_limit(&scene.def, &what);
    if (p->dt > limit)
        return rp_fail(RP_BAD_INPUT, "dt = %g: too large for %s, the limit is %.3g", p->dt, what, limit);
    return RP_OK;
}

static void conclude(experiment *e, const char *status, const char *message)
{
    snprintf(e->result->status, sizeof e->result->status, "%s", status);
    if (message != e->result->message) snprintf(e->result->message, sizeof e->result->message, "%s", message);
}

/* Advance; a fault of the simulation ends the run with its word and RP_NO_RESULT. */
static rp_status advance(experiment *e, long steps)
{
    while (steps > 0) {
        long part = steps;
        long to_next = e->every > 0 ? e->every - dem_step(e->sim) % e->every : steps;
        if (to_next < part) part = to_next;
        rp_status status = dem_run(e->sim, part);
        if (status == RP_BROKEN) {
            conclude(e, dem_fault_text(dem_sim_fault(e->sim)), rp_message());
            return RP_NO_RESULT;
        }
        if (status) return status;
        steps -= part;
        if (e->every > 0 && dem_step(e->sim) % e->every == 0) dem_write_energy(e->sim, e->energy);
    }
    return RP_OK;
}

/* The surface's heights and slopes of the present state. RP_NO_RESULT: too few cells are occupied. */
static rp_status measure_slopes(experiment *e, ang_slope slopes[ANG_N_METHODS])
{
    const size_t n = dem_count(e->sim);
    double *x = e->work, *y = x + n, *r = y + n;
    rp_status status = dem_states(e->sim, e->states);
    if (status) return status;
    for (size_t i = 0; i < n; i++) {
        x[i] = e->states[i].x;
        y[i] = e->states[i].y;
        r[i] = e->states[i].r;
    }
    const ang_options options = {e->d, (ang_height)e->p->height, (ang_empty)e->p->empty,
                                 (ang_parabola)e->p->parabola};
    ang_surface surface = {0};
    status = ang_surface_make(n, x, y, r, e->p->W, &options, &surface);
    e->result->values[OUT_CELLS] = (double)surface.n_occupied;
    if (!status && slopes)
        status = ang_slopes(surface.n, surface.column, surface.h, surface.cell, options.parabola, slopes);
    ang_surface_free(&surface);
    return status;
}

/* Test for rest every 500 steps until 10 tests in a row pass (protocol "Rest"). `opened`: the wall is gone,
 * and the run ends as soon as too few cells are left for a slope. */
static rp_status settle(experiment *e, bool opened, const char *phase)
{
    const long every = 500;
    const int in_a_row = 10;
    for (long steps = 0, passed = 0; passed < in_a_row; steps += every) {
        if (steps >= e->max_steps) {
            char text[96];
            snprintf(text, sizeof text, "%s: not at rest after %ld further steps", phase, steps);
            conclude(e, "not_at_rest", text);
            return RP_NO_RESULT;
        }
        rp_status status = advance(e, every);
        dem_rest rest;
        if (!status) status = dem_rest_state(e->sim, 0.0, e->p->W, &rest);
        if (status) return status;
        bool quiet = rest.kinetic_energy < e->p->rest_energy * e->mg * e->d &&
                     rest.net_force < e->p->rest_force * e->mg;
        passed = quiet ? passed + 1 : 0;
        if (!opened) continue;
        status = measure_slopes(e, NULL);
        if (status == RP_NO_RESULT) conclude(e, "no_pile", rp_message());
        if (status) return status;
    }
    return RP_OK;
}

static rp_status fill_box(experiment *e)
{
    rp_status status = dem_scene_start(&e->scene, &e->sim);
    if (status == RP_NO_RESULT) conclude(e, "no_room", rp_message());
    if (status) return status;
    status = advance(e, e->p->fill_steps);
    if (!status && e->p->stop == STOP_REST) status = settle(e, false, "filling");
    e->result->values[OUT_FILL_STEPS] = e->sim ? (double)dem_step(e->sim) : NAN;
    return status;
}

static rp_status open_box(experiment *e)
{
    const long opened_at = dem_step(e->sim), least = 5000;
    dem_wall_open(e->sim, DEM_BOX_RIGHT, e->p->open);
    e->scene.def.walls[DEM_BOX_RIGHT].open_at_step = opened_at + 1;
    rp_status status = advance(e, e->p->stop == STOP_REST ? least : e->p->relax_steps);
    if (!status && e->p->stop == STOP_REST) status = settle(e, true, "after the opening");
    e->result->values[OUT_RELAX_STEPS] = (double)(dem_step(e->sim) - opened_at);
    return status;
}

/* How far from rest the grains over the box's floor are, for better or worse. */
static rp_status note_state(experiment *e)
{
    double *v = e->result->values;
    dem_rest rest;
    rp_status status = dem_rest_state(e->sim, 0.0, e->p->W, &rest);
    if (status) return status;
    v[OUT_GRAINS] = (double)rest.n;
    v[OUT_CONTACT_NUMBER] = rest.contact_number;
    v[OUT_ENERGY] = rest.kinetic_energy / (e->mg * e->d);
    v[OUT_FORCE] = rest.net_force / e->mg;
    return RP_OK;
}

static rp_status measure_pile(experiment *e)
{
    double *v = e->result->values;
    ang_slope slopes[ANG_N_METHODS];
    rp_status status = note_state(e);
    if (status) return status;
    /* what lies flat on a smooth floor is no pile of angle 0: any slope would have flowed out */
    if (e->scene.def.walls[DEM_BOX_FLOOR].material.mu == 0.0) {
        conclude(e, "no_pile", "a floor without friction, and no wall on the right");
        return RP_NO_RESULT;
    }
    status = measure_slopes(e, slopes);
    if (status == RP_NO_RESULT) conclude(e, "no_pile", rp_message());
    if (status) return status;
    for (int m = 0; m < ANG_N_METHODS; m++) v[OUT_THETA_R1 + m] = degrees(slopes[m].theta);
    v[OUT_THETA_R3_SE] = degrees(slopes[2].theta_se);
    v[OUT_THETA_R12] = v[OUT_THETA_R1] - v[OUT_THETA_R2];
    v[OUT_THETA_R23] = v[OUT_THETA_R2] - v[OUT_THETA_R3];
    return RP_OK;
}

/* Where the grains of the pile were, by id; and how far from there they are. */
typedef struct {
    size_t n, n_all; /* in the pile; of all grains */
    double *x, *y;   /* by id, from 1; NaN for grains outside the pile */
} places;

static rp_status places_note(experiment *e, places *at)
{
    at->n = 0;
    at->n_all = (size_t)e->scene.fill.N;
    at->x = malloc((at->n_all + 1) * sizeof *at->x);
    at->y = malloc((at->n_all + 1) * sizeof *at->y);
    if (!at->x || !at->y) return rp_fail(RP_NO_MEMORY, "tilt: out of memory");
    for (size_t id = 0; id <= at->n_all; id++) at->x[id] = NAN;
    rp_status status = dem_states(e->sim, e->states);
    for (size_t i = 0; !status && i < dem_count(e->sim); i++) {
        const dem_state *s = &e->states[i];
        if (!(s->x > 0.0 && s->x < e->p->W)) continue;
        at->x[s->id] = s->x;
        at->y[s->id] = s->y;
        at->n++;
    }
    return status;
}

static void places_free(places *at)
{
    free(at->x);
    free(at->y);
}

/* Number of the pile's grains, with at least `contacts` contacts, that are further than `reach` from their
 * places; grains that have left the scene count. */
static rp_status places_moved(experiment *e, const places *at, double reach, int contacts, size_t *moved)
{
    rp_status status = dem_states(e->sim, e->states);
    size_t seen = 0;
    *moved = 0;
    for (size_t i = 0; !status && i < dem_count(e->sim); i++) {
        const dem_state *s = &e->states[i];
        if (isnan(at->x[s->id])) continue;
        seen++;
        double dx = s->x - at->x[s->id], dy = s->y - at->y[s->id];
        *moved += dx * dx + dy * dy > reach * reach && s->contacts >= contacts;
    }
    *moved += at->n - seen;
    return status;
}

/* Gravity turns at a constant rate; onset by displacement and by energy (protocol "Tilt"). The elastic sway
 * that the start of the turn excites is the largest mean energy within the first half degree. */
static rp_status tilt_at_rate(experiment *e)
{
    const long every = (long)fmin(10.0, fmax(1.0, 0.01 / e->p->tilt_rate_deg));
    const double sway_deg = 0.5, most_deg = 60.0;
    double *v = e->result->values, sway = 0.0;
    places at = {0};
    rp_status status = places_note(e, &at);
    dem_gravity_turn(e->sim, e->p->tilt_rate_deg * (M_PI / 180.0));
    for (double turned = 0.0; !status && turned < most_deg;) {
        status = advance(e, every);
        if (status) break;
        turned += (double)every * e->p->tilt_rate_deg;
        size_t moved;
        dem_rest rest;
        status = places_moved(e, &at, 0.1 * e->d, 0, &moved);
        if (!status) status = dem_rest_state(e->sim, 0.0, e->p->W, &rest);
        if (status) break;
        if (turned <= sway_deg) sway = fmax(sway, rest.kinetic_energy);
        if (isnan(v[OUT_THETA_T_DISPLACEMENT]) && (double)moved >= 0.05 * (double)at.n)
            v[OUT_THETA_T_DISPLACEMENT] = turned;
        if (isnan(v[OUT_THETA_T_ENERGY]) && turned > sway_deg && rest.kinetic_energy > 10.0 * sway &&
            rest.kinetic_energy > 1e-5 * e->mg * e->d)
            v[OUT_THETA_T_ENERGY] = turned;
        if (isfinite(v[OUT_THETA_T_DISPLACEMENT]) && isfinite(v[OUT_THETA_T_ENERGY])) break;
    }
    places_free(&at);
    v[OUT_THETA_RT] = v[OUT_THETA_R3] + v[OUT_THETA_T_DISPLACEMENT];
    if (!status && (isnan(v[OUT_THETA_T_DISPLACEMENT]) || isnan(v[OUT_THETA_T_ENERGY])))
        snprintf(e->result->message, sizeof e->result->message, "tilt: stands, by a criterion, at %g degrees",
                 most_deg);
    return status;
}

/* Gravity turns by 0.1 degree at the same rate, then waits for rest; the last angle at which no grain with
 * two contacts had moved half a diameter. */
static rp_status tilt_quasi_static(experiment *e)
{
    const double step_deg = 0.1, most_deg = 60.0;
    const long steps =
        lround(step_deg / e->p->tilt_rate_deg) > 0 ? lround(step_deg / e->p->tilt_rate_deg) : 1;
    places at = {0};
    rp_status status = places_note(e, &at);
    for (double turned = 0.0; !status && turned < most_deg; turned += step_deg) {
        dem_gravity_turn(e->sim, step_deg / (double)steps * (M_PI / 180.0));
        status = advance(e, steps);
        dem_gravity_turn(e->sim, 0.0);
        if (!status) status = settle(e, false, "quasi-static tilt");
        bool restless = status == RP_NO_RESULT && strcmp(e->result->status, "not_at_rest") == 0;
        if (restless) status = RP_OK;
        size_t moved = 0;
        if (!status) status = places_moved(e, &at, 0.5 * e->d, 2, &moved);
        if (!status && moved > 0) e->result->values[OUT_THETA_T_STATIC] = turned;
        if (moved > 0 || restless) break; /* restless in its place: no angle, the message says why */
    }
    places_free(&at);
    return status;
}

static rp_status tilt_pile(experiment *e)
{
    dem_sim *rested = NULL;
    rp_status status = RP_OK;
    if (e->p->measure & MEASURE_THETA_T_STATIC) status = dem_clone(e->sim, &rested);
    if (!status && e->p->measure & MEASURE_THETA_T) status = tilt_at_rate(e);
    if (rested && !status) {
        e->steps_before += dem_step(e->sim) - dem_step(rested);
        dem_sim *tilted = e->sim;
        e->sim = rested;
        rested = tilted;
        status = tilt_quasi_static(e);
    }
    dem_free(rested);
    return status;
}

/* What a trace adds: tables of a state. */
typedef struct {
    const char *directory;
    void (*header)(FILE *);
} trace;

static rp_status open_table(const trace *t, const char *name, char *path, size_t size, FILE **out)
{
    snprintf(path, size, "%s/%s", t->directory, name);
    rp_status status = rp_file_open(path, out);
    if (!status) t->header(*out);
    return status;
}

static rp_status write_tables(experiment *e, const trace *t, const char *stage)
{
    char name[64], path[4096];
    FILE *out;
    snprintf(name, sizeof name, "%s_grains.tsv", stage);
    rp_status status = open_table(t, name, path, sizeof path, &out);
    if (status) return status;
    dem_write_state_columns(out);
    status = rp_file_close(path, out, dem_write_states(e->sim, out));
    snprintf(name, sizeof name, "%s_contacts.tsv", stage);
    if (!status) status = open_table(t, name, path, sizeof path, &out);
    if (status) return status;
    return rp_file_close(path, out, dem_write_contacts(e->sim, out));
}

static rp_status write_scene(experiment *e, const trace *t)
{
    char path[4096];
    FILE *out;
    rp_status status = open_table(t, "scene.cfg", path, sizeof path, &out);
    if (status) return status;
    e->scene.steps = dem_step(e->sim);
    dem_scene_write(&e->scene, out);
    return rp_file_close(path, out, RP_OK);
}

/* The experiment from an empty box to its last measurement. */
static rp_status run_phases(experiment *e, const trace *t)
{
    rp_status status = fill_box(e);
    if (!status && t) status = write_tables(e, t, "filled");
    if (!status) status = open_box(e);
    if (!status) status = measure_pile(e);
    if (!status && t) status = write_tables(e, t, "pile");
    if (!status && t) status = write_scene(e, t);
    if (!status && e->p->measure & (MEASURE_THETA_T | MEASURE_THETA_T_STATIC)) status = tilt_pile(e);
    if (!status) conclude(e, e->p->stop == STOP_REST ? "ok" : "ok_fixed_time", e->result->message);
    if (e->sim) e->result->values[OUT_STEPS] = (double)(dem_step(e->sim) + e->steps_before);
    if (status != RP_NO_RESULT || !e->sim) return status;
    /* a run without a result leaves what there is to look at */
    rp_status left = note_state(e);
    if (!left && t) left = write_tables(e, t, "pile");
    if (!left && t) left = write_scene(e, t);
    return left ? left : status;
}

static rp_status run_experiment(const repose_params *p, unsigned long seed, unsigned long run, const trace *t,
                                long every, FILE *energy, sweep_result *result)
{
    *result = (sweep_result){.status = ""};
    for (int i = 0; i < N_OUTPUTS; i++) result->values[i] = NAN;
    experiment e = {.p = p, .result = result, .d = 2.0 * p->radius_mean, .every = every, .energy = energy};
    make_scene(p, seed, run, &e.scene);
    e.mg = dem_mass(p->shape, p->density, p->radius_mean) * p->g;
    const double rows = p->H / (20.0 * e.d);
    double most = 4e5 * fmax(1.0, 500.0 / fmax(p->gamma_n, 1.0)) * fmax(1.0, rows * rows);
    e.max_steps = p->max_steps > 0 ? p->max_steps : lround(fmin(most, 2e9));
    e.states = malloc((size_t)e.scene.fill.N * sizeof *e.states);
    e.work = malloc(3 * (size_t)e.scene.fill.N * sizeof *e.work);
    rp_status status = e.states && e.work ? run_phases(&e, t) : rp_fail(RP_NO_MEMORY, "run: out of memory");
    dem_free(e.sim);
    free(e.states);
    free(e.work);
    /* a status word was given: physics without a result, which is an answer */
    return status == RP_NO_RESULT ? RP_OK : status;
}

static rp_status run_one(const void *params, unsigned long seed, unsigned long run, sweep_result *result)
{
    return run_experiment(params, seed, run, NULL, 0, NULL, result);
}

rp_status sweep_repose_trace(const void *params, unsigned long seed, unsigned long run, const char *directory,
                             long every, void (*header)(FILE *), sweep_result *result)
{
    const trace t = {directory, header};
    char path[4096];
    FILE *energy;
    rp_status status = rp_make_directory(directory);
    if (!status) status = open_table(&t, "energy.tsv", path, sizeof path, &energy);
    if (status) return status;
    dem_write_energy_columns(energy);
    status = run_experiment(params, seed, run, &t, every, energy, result);
    return rp_file_close(path, energy, status);
}

/* Two short runs that between them use both springs, two floors, both masses and all phases but the tilt. */
static rp_status fingerprint(char digits[33])
{
    repose_params p[2];
    sweep_result results[2];
    double bits[2][N_OUTPUTS];
    for (int k = 0; k < 2; k++) {
        rp_params_defaults(schema, &p[k]);
        p[k].W = p[k].H = 1.0;
        p[k].stop = STOP_STEPS;
        p[k].fill_steps = p[k].relax_steps = 1500;
    }
    p[1].slip = DEM_TOTAL;
    p[1].floor = FLOOR_ENDS;
    p[1].shape = DEM_DISK;
    p[1].tension = false;
    for (int k = 0; k < 2; k++) {
        rp_status status = run_one(&p[k], 1, (unsigned long)k, &results[k]);
        if (status) return status;
        /* angles to a millionth of a degree: the C library's atan may differ in its last digits */
        for (int i = 0; i < N_OUTPUTS; i++)
            bits[k][i] = i <= OUT_THETA_RT ? round(results[k].values[i] * 1e6) : results[k].values[i];
        for (int i = 0; i < N_OUTPUTS; i++)
            if (isnan(bits[k][i])) bits[k][i] = -1e300; /* one NaN for all */
    }
    XXH128_hash_t h = XXH3_128bits(bits, sizeof bits);
    snprintf(digits, 33, "%016llx%016llx", (unsigned long long)h.high64, (unsigned long long)h.low64);
    return RP_OK;
}

const sweep_protocol sweep_protocol_repose = {
    .name = "repose",
    .about = "fill a box, open its right wall, measure the slope at rest, tilt (Lee & Herrmann 1993)",
    .schema = schema,
    .params_size = sizeof(repose_params),
    .outputs = outputs,
    .check = check,
    .fingerprint = fingerprint,
    .run = run_one};
