/* Protocol `flux`: grains are put in at the upper left corner of a pile, one after the other and each once
 * the pile is quiet, and leave over the edge on the right (Lee & Herrmann 1993, section 5). The angle by
 * method 3 just before each insertion is a series that rises, then fluctuates; what is reported is of the
 * latter part.
 *
 * The floor ends at W: where it extends, nothing leaves and no steady state exists. "Quiet": the largest
 * speed over the grains with 0 < x < W has been below v_cut for 200 steps in a row, and the last grain has
 * had a contact, for a new one in the air is slow too. */
#include <gsl/gsl_statistics_double.h>
#include <math.h>
#include <stdlib.h>

#include "params/units.h"
#include "core/random.h"
#include "table/table.h"
#include "sweeps/protocols/box.h"
#include "sweeps/engine/physics.h"
#include "stats/stats.h"

static const long QUIET_STEPS = 200;

typedef struct {
    sweep_box box;
    double v_cut, drop_height, entry_width;
    long insertions, steps_max, avalanche;
} flux_params;

#define AT(field) offsetof(flux_params, field)

/* clang-format off */
static const rp_param schema[] = {
    SWEEP_BOX_PHYSICS
    SWEEP_BOX_WIDTH_ROW
    SWEEP_BOX_WALL_ROWS
    {"v_cut", "cm/s", RP_REAL, AT(v_cut), "0.1", "(0, inf)", "the pile is quiet below this speed"},
    {"drop_height", "d", RP_REAL, AT(drop_height), "0", "[0, 100]", "of a new grain, above where it would touch"},
    {"entry_width", "d", RP_REAL, AT(entry_width), "0", "[0, 100]",
     "a new grain touches the left wall, or with a width is up to that away from it, at random"},
    {"insertions", "", RP_INT, AT(insertions), "1000", "[4, 10000000]", "length of the series"},
    {"steps_max", "", RP_INT, AT(steps_max), "20000000", "[1, 2000000000]",
     "most steps; the series ends there if it is shorter"},
    {"avalanche", "", RP_INT, AT(avalanche), "5", "[1, 1000000]",
     "least outflow between two insertions that counts as an avalanche"},
    SWEEP_BOX_REST_ROWS
    SWEEP_BOX_SURFACE_ROWS
    {0}};

#define OUTPUTS(X) \
    X(level_step, "", "step at which the angle levels off (MSER)") \
    X(level_insertion, "", "insertions before that") \
    X(theta_deg, "degree", "mean angle from there on, method 3") \
    X(theta_sd_deg, "degree", "its standard deviation, the fluctuation") \
    X(theta_se_deg, "degree", "standard error of the mean, by blocking") \
    X(tau_insertions, "", "integrated correlation time, in insertions") \
    X(decorrelated, "", "number of decorrelated angles, n/(2 tau)") \
    X(theta_max_deg, "degree", "largest angle") \
    X(theta_ms_flux_deg, "degree", "mean angle just before avalanches") \
    X(theta_ms_less_r_deg, "degree", "that less the mean angle just after avalanches") \
    X(avalanches, "", "number of avalanches") \
    X(grains, "", "mean number of grains with 0 < x < W") \
    X(tower, "d", "mean height by which the first cell overtops the rest of the pile") \
    X(insertions_made, "", "length of the series, from the first") \
    X(steps, "", "steps in all")
/* clang-format on */
typedef struct {
    OUTPUTS(SWEEP_OUTPUT_MEMBER)
} flux_values;
static const sweep_output outputs[] = {OUTPUTS(SWEEP_OUTPUT_ROW){0}};

/* One run in the making; a row of the series is the quiet state before an insertion. */
typedef struct {
    flux_params p; /* with the floor and opening of this protocol */
    sweep_box_run box;
    gsl_rng *radii, *positions;
    size_t n;              /* rows */
    double *theta, *tower; /* degrees, d */
    double *step, *grains;
    double *work; /* room for a series */
} flux;

static void fix_box(flux_params *p)
{
    p->box.floor = SWEEP_FLOOR_ENDS;
    p->box.open = INFINITY;
}

static rp_status check(const void *params)
{
    flux_params p = *(const flux_params *)params;
    fix_box(&p);
    /* a pile may grow higher, but then the run says so */
    RP_TRY(sweep_box_check(&p.box, 2.0 * (p.box.W + p.drop_height * p.box.radius_mean)));
    dem_scene scene;
    sweep_box_scene(&p.box, &scene);
    if (scene.def.walls[DEM_BOX_FLOOR].material.mu == 0.0)
        return rp_fail(RP_BAD_INPUT, "no friction at the floor: nothing holds the first layer");
    return RP_OK;
}

static double draw_radius(flux *f)
{
    const sweep_box *b = &f->p.box;
    return rp_random_cut_normal(f->radii, b->radius_mean, b->radius_width, b->radius_min, b->radius_max);
}

static dem_grain grain_at(const flux *f, double x, double y, double r)
{
    return (dem_grain){
        .x = x, .y = y, .r = r, .m = dem_mass(f->p.box.physics.shape, f->p.box.physics.density, r)};
}

/* Grains from left to right, each on the floor and touching the last, while they end before W. */
static rp_status make_layer(flux *f)
{
    dem_definition *def = &f->box.scene.def;
    dem_grain *layer = f->box.scene.grains;
    double r = draw_radius(f), x = r;
    for (def->n_grains = 0; x + r <= f->p.box.W; def->n_grains++) {
        layer[def->n_grains] = grain_at(f, x, r, r);
        const double next = draw_radius(f);
        x += 2.0 * sqrt(r * next); /* (r + r')^2 = dx^2 + (r - r')^2 */
        r = next;
    }
    def->grains = layer;
    def->walls[DEM_BOX_RIGHT].open_at_step = 0;
    return dem_create(def, &f->box.sim);
}

static rp_status insert(flux *f, uint32_t *id)
{
    const double r = draw_radius(f), d = f->box.d,
                 x = r + f->p.entry_width * d * gsl_rng_uniform(f->positions);
    RP_TRY(dem_states(f->box.sim, f->box.states));
    double y = sweep_touch_height(dem_count(f->box.sim), f->box.states, x, r, 1e-6 * d);
    const dem_grain grain = grain_at(f, x, y + f->p.drop_height * d, r);
    rp_status status = dem_add(f->box.sim, &grain, id);
    /* a fall from there is too fast for dt */
    return status == RP_BAD_INPUT ? sweep_conclude(f->box.result, "too_high", "%s", rp_message()) : status;
}

/* Advance until the pile is quiet, or the steps are used up. */
static rp_status wait_until_quiet(flux *f, uint32_t id, bool *quiet)
{
    struct {
        bool touched;
        long below;
    } now = {false, 0};
    rp_status status = RP_OK;
    SWEEP_ENTER(f->box.keep, now);
    *quiet = false;
    while (!(*quiet = now.below >= QUIET_STEPS && now.touched) && dem_step(f->box.sim) < f->p.steps_max) {
        status = sweep_box_advance(&f->box, 1);
        if (status) break;
        now.touched = now.touched || dem_contact_count(f->box.sim, id) > 0;
        now.below = dem_largest_speed(f->box.sim, 0.0, f->p.box.W) < f->p.v_cut ? now.below + 1 : 0;
    }
    sweep_keep_leave(f->box.keep, 1);
    return status;
}

static rp_status note_row(flux *f)
{
    ang_slope slopes[ANG_N_METHODS];
    RP_TRY(sweep_box_slopes(&f->box, slopes));
    const double cell = f->p.box.W / round(f->p.box.W / f->box.d);
    double first = 0.0, others = 0.0;
    double inside = 0.0;
    for (size_t i = 0; i < dem_count(f->box.sim); i++) {
        const dem_state *s = &f->box.states[i];
        if (!(s->x > 0.0 && s->x < f->p.box.W)) continue;
        inside++;
        *(s->x < cell ? &first : &others) = fmax(s->x < cell ? first : others, s->y);
    }
    f->tower[f->n] = fmax(first - others, 0.0) / f->box.d;
    f->theta[f->n] = sweep_degrees(slopes[2].theta);
    f->step[f->n] = (double)dem_step(f->box.sim);
    f->grains[f->n++] = inside;
    return RP_OK;
}

static rp_status first_layer(flux *f)
{
    rp_status status = f->box.sim ? RP_OK : make_layer(f);
    if (!status) status = sweep_box_settle(&f->box, "first layer", false);
    return status ? status : note_row(f);
}

static rp_status run_series(flux *f)
{
    struct {
        uint32_t id; /* of the grain that was put in last */
        bool waits;  /* for the pile to be quiet */
    } now = {0, false};
    bool quiet = true;
    rp_status status = RP_OK;
    SWEEP_ENTER(f->box.keep, now);
    if (f->n == 0) status = first_layer(f);
    while (!status && f->n < (size_t)f->p.insertions) {
        if (!now.waits) status = insert(f, &now.id);
        now.waits = true;
        if (!status) status = wait_until_quiet(f, now.id, &quiet);
        if (status || !quiet) break;
        status = note_row(f);
        now.waits = false;
    }
    sweep_keep_leave(f->box.keep, 1);
    return status;
}

/* Grains that left between the insertion before row k and the row. */
static double outflow(const flux *f, size_t k)
{
    return k > 0 ? f->grains[k - 1] + 1.0 - f->grains[k] : 0.0;
}

static void avalanches(const flux *f, size_t from, flux_values *v)
{
    double before = 0.0, after = 0.0, count = 0.0;
    for (size_t k = from + 1; k < f->n; k++) {
        if (outflow(f, k) < (double)f->p.avalanche) continue;
        before += f->theta[k - 1];
        after += f->theta[k];
        count++;
    }
    v->avalanches = count;
    v->theta_ms_flux_deg = before / count; /* NaN without any */
    v->theta_ms_less_r_deg = (before - after) / count;
}

static rp_status analyse(flux *f)
{
    flux_values *const v = (void *)f->box.result->values;
    double grains = 0.0, tower = 0.0;
    size_t from;
    stats_series series;
    rp_status status = stats_level_off(f->n, f->theta, &from);
    if (status == RP_NO_RESULT) return sweep_conclude(f->box.result, "not_level", "%s", rp_message());
    if (status) return status;
    sweep_conclude(f->box.result, "ok", NULL);
    status = stats_blocking(f->n - from, f->theta + from, f->work, &series);
    if (status == RP_NO_RESULT) /* no errors, but a mean */
        sweep_conclude(f->box.result, "ok", "%s", rp_message());
    if (status && status != RP_NO_RESULT) return status;
    for (size_t k = from; k < f->n; k++) {
        grains += f->grains[k];
        tower += f->tower[k];
    }
    v->theta_max_deg = gsl_stats_max(f->theta + from, 1, f->n - from);
    v->level_step = f->step[from];
    v->level_insertion = (double)from;
    v->theta_deg = series.mean;
    v->theta_sd_deg = series.sd;
    v->theta_se_deg = series.se;
    v->tau_insertions = series.tau;
    v->decorrelated = (double)series.n / (2.0 * series.tau);
    v->grains = grains / (double)series.n;
    v->tower = tower / (double)series.n;
    avalanches(f, from, v);
    return RP_OK;
}

static rp_status write_series(const flux *f)
{
    sweep_file series;
    if (!f->box.tables) return RP_OK;
    RP_TRY(sweep_table_open(f->box.tables, "series.tsv", &series));
    rp_table_note(series.out, "v_cut", "%g %s", f->p.v_cut, rp_unit("cm/s"));
    rp_table_header(series.out, "step, insertion, grains, theta_r3_deg [degree], outflow, tower [d]");
    for (size_t k = 0; k < f->n; k++)
        rp_table_row(
            series.out, 6,
            (double[]){f->step[k], (double)k + 1.0, f->grains[k], f->theta[k], outflow(f, k), f->tower[k]});
    return sweep_table_close(&series, RP_OK);
}

/* The series, with its simulation still there to look at; afterwards `finish`. */
static rp_status make(flux *f, const flux_params *p, unsigned long seed, unsigned long run,
                      const sweep_tables *tables, sweep_result *result)
{
    *f = (flux){.p = *p};
    fix_box(&f->p);
    const size_t rows = (size_t)p->insertions,
                 most_layer = (size_t)(p->box.W / (2.0 * p->box.radius_min)) + 1;
    rp_status status = sweep_box_begin(&f->box, &f->p.box, rows + most_layer, tables, result);
    f->box.max_steps = p->steps_max;
    f->radii = rp_random_alloc(seed, run, RP_PURPOSE_RADII);
    f->positions = rp_random_alloc(seed, run, RP_PURPOSE_PLACES);
    f->theta = calloc(5 * rows, sizeof *f->theta);
    dem_grain *layer = f->box.scene.grains = malloc(most_layer * sizeof *layer);
    if (!f->radii || !f->positions || !f->theta || !layer)
        status = status ? status : rp_fail(RP_NO_MEMORY, "flux: out of memory");
    f->tower = f->theta + rows;
    f->step = f->tower + rows;
    f->grains = f->step + rows;
    f->work = f->grains + rows;
    if (status) return status;
    sweep_keep_enter(f->box.keep, gsl_rng_state(f->radii), gsl_rng_size(f->radii));
    sweep_keep_enter(f->box.keep, gsl_rng_state(f->positions), gsl_rng_size(f->positions));
    SWEEP_ENTER(f->box.keep, f->n);
    sweep_keep_enter(f->box.keep, f->theta, 4 * rows * sizeof *f->theta); /* to the last of the series */
    status = run_series(f);
    sweep_keep_leave(f->box.keep, 4);
    return status;
}

static rp_status finish(flux *f, rp_status status)
{
    if (f->radii) gsl_rng_free(f->radii);
    if (f->positions) gsl_rng_free(f->positions);
    free(f->theta);
    return sweep_box_end(&f->box, status);
}

static rp_status run_one(const void *params, unsigned long seed, unsigned long run,
                         const sweep_tables *tables, sweep_result *result)
{
    flux f;
    rp_status status = make(&f, params, seed, run, tables, result);
    if (!status) status = analyse(&f);
    flux_values *const v = (void *)result->values;
    v->insertions_made = (double)f.n;
    if (f.box.sim) v->steps = (double)dem_step(f.box.sim);
    if ((status == RP_OK || status == RP_NO_RESULT) && f.box.sim) {
        rp_status left = write_series(&f);
        if (!left) left = sweep_state_write(f.box.tables, f.box.sim, "pile");
        if (left) status = left;
    }
    return finish(&f, status);
}

/* Bits of the grains after a short run. */
static rp_status fingerprint(char digits[33])
{
    flux_params p = {0}; /* the schema has not every field of the box */
    flux f;
    sweep_result result;
    rp_params_defaults(schema, &p);
    p.box.W = 1.4;
    p.insertions = 12;
    rp_status status = make(&f, &p, 1, 0, NULL, &result);
    if (status == RP_NO_RESULT) /* which would pass for a run without angle, and leave no digits */
        status = rp_prefix(RP_BROKEN, "fingerprint of flux: ");
    if (!status) status = dem_states(f.box.sim, f.box.states);
    if (!status) sweep_states_digits(dem_count(f.box.sim), f.box.states, digits);
    if (!status) status = sweep_physics_add(digits);
    return finish(&f, status);
}

SWEEP_PROTOCOL(flux, schema, flux_params, flux_values, check,
               "grains put in at the left, one by one, leave over the right edge (Lee & Herrmann 1993)");
