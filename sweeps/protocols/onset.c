/* Protocol `onset`: the box of protocol `repose` to its pile at rest, on which whatever might predict its
 * tilting angle is measured; then gravity is turned at a rate until the pile moves. The same tilt is made a
 * second time, with the same bits, and read at quarters of the tilting angle: which contacts slide, and which
 * grains move otherwise than the pile as a whole.
 */
#include <gsl/gsl_math.h>
#include <gsl/gsl_sort.h>
#include <math.h>
#include <stdlib.h>

#include "experiment/modules/module.h"
#include "stats/stats.h"
#include "sweeps/protocols/tilted.h"
#include "stress/stress.h"

/* Readings at these tilts: PROBE_DEG, and quarters of the tilting angle, from none to all of it. */
enum { N_QUARTERS = 5, HALF = 2, ONSET = 4 };
static const double PROBE_DEG = 1.0;

/* clang-format off */
/* Where contacts are, with the words of their outputs. */
#define CLASSES(X) X(floor, "with the floor") X(wall, "with the wall") X(inside, "between grains")
/* Zones of the grains: quarters of the width from the wall on, and of each the surface, the inside, the floor. */
#define COLUMNS(X) X(1) X(2) X(3) X(4)

#define OUTPUTS(X) \
    X(theta_r3_deg, "degree", "slope by method 3") \
    X(theta_t_displacement_deg, "degree", "tilt at which 5 % of the grains have moved 0.1 d") \
    X(theta_t_theory_deg, "degree", "the same by (4), balanced, from this pile's theta_r3") \
    X(theta_upper_deg, "degree", "straight line through the cells left of W/2") \
    X(theta_lower_deg, "degree", "straight line through the cells right of W/2") \
    X(theta_steepest_deg, "degree", "steepest straight line through two fifths of the cells, neighbours") \
    X(scatter, "d", "root mean square of the surface's height about its straight line") \
    X(floor_friction_0, "", "force of the pile along the floor, away from the wall, over the normal force") \
    X(bulk_friction_0, "", "tangent of the angle that the pile's mean stress mobilises") \
    X(limit_force_0, "", "share of the normal force that contacts at the limit of friction carry") \
    X(contact_number, "", "contacts a grain") \
    X(rattlers, "", "share of the grains with fewer than two contacts") \
    X(fabric, "", "anisotropy of the contacts' directions, |mean exp(2 i direction)|") \
    X(fabric_shear, "", "mean sin(2 direction): positive if contacts point up the slope, as /") \
    X(psi6, "", "mean |psi_6| of the grains") \
    X(grains, "", "grains with 0 < x < W") \
    X(limit_probe, "", "share of all contacts at the limit of friction, at a tilt of 1 degree") \
    X(reach_probe, "d", "displacement that 5 % of the grains exceed at a tilt of 1 degree")
#define LIMIT(X, where, words) \
    X(limit_##where##_0, "", "share of the contacts " words " at the limit of friction, without tilt") \
    X(limit_##where##_1, "", "the same at a quarter of the tilting angle") \
    X(limit_##where##_2, "", "at half of it") \
    X(limit_##where##_3, "", "at three quarters of it") \
    X(limit_##where##_4, "", "at the tilting angle")
#define MOTION(X, when, words) \
    X(nonaffine_##when, "d", "root mean square displacement less the best affine one, " words) \
    X(nonaffine_share_##when, "", "share of these squares in those of the displacement about its mean, " words) \
    X(moves_x_##when, "W", "distance from the wall, mean over the grains with the squares as weights, " words) \
    X(moves_y_##when, "d", "the same of the height above the floor, " words) \
    X(moves_depth_##when, "d", "the same of the depth below the surface, " words)
#define PLACES(X) \
    X(all_x, "W", "distance from the wall, mean over the grains") \
    X(all_y, "d", "height above the floor, mean over the grains") \
    X(all_depth, "d", "depth below the surface, mean over the grains")
#define ZONE(X, k) \
    X(moved_surface_##k, "", "share of the grains that have moved 0.1 d: surface, 1.5 d, quarter " #k " from the wall") \
    X(moved_inside_##k, "", "the same of the inside, quarter " #k) \
    X(moved_floor_##k, "", "the same of the floor, grains below y = d, quarter " #k)
#define LIMIT_MEMBERS(where, words) LIMIT(SWEEP_OUTPUT_MEMBER, where, words)
#define LIMIT_ROWS(where, words)    LIMIT(SWEEP_OUTPUT_ROW, where, words)
#define ZONE_MEMBERS(k)             ZONE(SWEEP_OUTPUT_MEMBER, k)
#define ZONE_ROWS(k)                ZONE(SWEEP_OUTPUT_ROW, k)
#define STEPS(X) X(steps, "", "steps in all")
enum { FLOOR, WALL, INSIDE, N_CLASSES };
enum { N_COLUMNS = 4, SURFACE = 0, BULK = 1, BASE = 2, N_LAYERS = 3 };
enum { NONAFFINE, NONAFFINE_SHARE, MOVES_X, MOVES_Y, MOVES_DEPTH, N_MOTIONS };
typedef struct {
    OUTPUTS(SWEEP_OUTPUT_MEMBER)
    SWEEP_FAMILY(limit[N_CLASSES][N_QUARTERS], CLASSES(LIMIT_MEMBERS))
    SWEEP_FAMILY(at_half[N_MOTIONS], MOTION(SWEEP_OUTPUT_MEMBER, half, ""))
    SWEEP_FAMILY(at_onset[N_MOTIONS], MOTION(SWEEP_OUTPUT_MEMBER, onset, ""))
    PLACES(SWEEP_OUTPUT_MEMBER)
    SWEEP_FAMILY(moved[N_COLUMNS][N_LAYERS], COLUMNS(ZONE_MEMBERS))
    STEPS(SWEEP_OUTPUT_MEMBER)
} onset_values;
static const sweep_output outputs[] = {
    OUTPUTS(SWEEP_OUTPUT_ROW) CLASSES(LIMIT_ROWS) MOTION(SWEEP_OUTPUT_ROW, half, "at half the tilting angle")
    MOTION(SWEEP_OUTPUT_ROW, onset, "at the tilting angle") PLACES(SWEEP_OUTPUT_ROW) COLUMNS(ZONE_ROWS)
    STEPS(SWEEP_OUTPUT_ROW) {0}};
/* clang-format on */
typedef struct {
    const sweep_tilted *p;
    sweep_box_run box;
    onset_values *v; /* of the result */
    double *depth;   /* [1 + most] by id, of the grains of the pile at rest, in d */
} experiment;

/* ---- the pile at rest ---- */

static rp_status measure_scatter(const ang_surface *s, double d, double *scatter)
{
    double *x = malloc(s->n * sizeof *x);
    stats_line line;
    if (!x) return rp_fail(RP_NO_MEMORY, "onset: out of memory");
    for (size_t k = 0; k < s->n; k++) x[k] = (double)s->column[k];
    rp_status status = stats_line_fit(&(stats_xy){s->n, x, s->h, NULL}, false, &line);
    *scatter = sqrt(line.chi2 / (double)s->n) / d;
    free(x);
    return status;
}

/* Slopes of parts of the surface, its scatter, and the depth of each grain below it. */
static rp_status measure_surface(experiment *e)
{
    onset_values *const v = e->v;
    const ang_options options = sweep_box_options(&e->p->box);
    ang_surface s;
    rp_status status = sweep_box_surface(&e->box, &options, &s);
    const size_t half = s.n / 2, part = (2 * s.n + 4) / 5;
    if (!status) status = sweep_box_line(&s, 0, half, &v->theta_upper_deg);
    if (!status) status = sweep_box_line(&s, s.n - half, half, &v->theta_lower_deg);
    for (size_t k = 0; !status && k + part <= s.n; k++) {
        double theta_deg = NAN;
        status = sweep_box_line(&s, k, part, &theta_deg);
        v->theta_steepest_deg = fmax(v->theta_steepest_deg, theta_deg);
    }
    if (!status) status = measure_scatter(&s, e->box.d, &v->scatter);
    /* the highest centre of each column */
    double *top = e->box.work;
    for (size_t c = 0; !status && c < s.n_cells; c++) top[c] = 0.0;
    for (size_t i = 0; !status && i < dem_count(e->box.sim); i++) {
        const dem_state *g = &e->box.states[i];
        if (!(g->x > 0.0 && g->x < e->p->box.W)) continue;
        double *t = &top[(size_t)fmin(g->x / s.cell, (double)s.n_cells - 1.0)];
        *t = fmax(*t, g->y);
    }
    for (size_t i = 0; !status && i < dem_count(e->box.sim); i++) {
        const dem_state *g = &e->box.states[i];
        if (!(g->x > 0.0 && g->x < e->p->box.W)) continue;
        e->depth[g->id] = (top[(size_t)fmin(g->x / s.cell, (double)s.n_cells - 1.0)] - g->y) / e->box.d;
    }
    ang_surface_free(&s);
    return status;
}

/* Is the contact in the pile, and where? */
static bool classify(const experiment *e, const dem_contact *c, int *where)
{
    if (!(c->x > 0.0 && c->x < e->p->box.W)) return false;
    *where = c->id_b ? INSIDE : c->wall == DEM_BOX_FLOOR ? FLOOR : WALL;
    return true;
}

/* Has its spring come to the limit of Coulomb's law? It holds mu times the normal force of its last step, so
 * that a thousandth is left for the force's change. */
static bool at_limit(const experiment *e, const dem_contact *c)
{
    const dem_definition *def = &e->box.scene.def;
    const dem_material *m = c->id_b ? &def->material : &def->walls[c->wall].material;
    return m->mu > 0.0 && m->k_s * fabs(c->shear_spring) >= 0.999 * m->mu * c->normal_force;
}

/* Shares of the contacts at the limit: of each class, of all, and of the normal force; NaN without any. */
typedef struct {
    double where[N_CLASSES], all, force;
} limits;

static limits count_limits(const experiment *e, size_t n, const dem_contact contacts[])
{
    double at[N_CLASSES] = {0}, of[N_CLASSES] = {0}, force_at = 0.0, force = 0.0;
    limits l;
    int where;
    for (const dem_contact *c = contacts; c < contacts + n; c++) {
        if (!classify(e, c, &where)) continue;
        const bool slides = at_limit(e, c);
        at[where] += slides;
        of[where] += 1.0;
        force_at += slides ? c->normal_force : 0.0;
        force += c->normal_force;
    }
    for (int k = 0; k < N_CLASSES; k++) l.where[k] = at[k] / of[k];
    l.all = (at[FLOOR] + at[WALL] + at[INSIDE]) / (of[FLOOR] + of[WALL] + of[INSIDE]);
    l.force = force_at / force;
    return l;
}

/* Floor force, mean stress and fabric of the contacts. */
static void measure_forces(experiment *e, size_t n, const dem_contact contacts[])
{
    onset_values *const v = e->v;
    double normal = 0.0, along = 0.0, cos2 = 0.0, sin2 = 0.0, inside = 0.0;
    stress_tensor s = {0};
    int where;
    for (const dem_contact *c = contacts; c < contacts + n; c++) {
        if (!classify(e, c, &where)) continue;
        const double lx = c->x - c->x_b, ly = c->y - c->y_b, l = hypot(lx, ly),
                     fx = (c->normal_force * lx + c->shear_force * ly) / l,
                     fy = (c->normal_force * ly - c->shear_force * lx) / l;
        stress_tensor_add(&s, &(stress_tensor){fx * lx, fx * ly, fy * lx, fy * ly}, 1.0);
        normal += where == FLOOR ? fy : 0.0;
        along -= where == FLOOR ? fx : 0.0;
        if (where != INSIDE) continue;
        cos2 += (lx * lx - ly * ly) / (l * l);
        sin2 += 2.0 * lx * ly / (l * l);
        inside += 1.0;
    }
    v->floor_friction_0 = along / normal;
    v->bulk_friction_0 = tan(stress_mohr(&s).mobilised);
    v->fabric = hypot(cos2, sin2) / inside;
    v->fabric_shear = sin2 / inside;
    v->limit_force_0 = count_limits(e, n, contacts).force;
}

/* Numbers of the grains of the pile. */
static void measure_grains(experiment *e)
{
    onset_values *const v = e->v;
    double n = 0.0, contacts = 0.0, rattlers = 0.0, x = 0.0, y = 0.0, depth = 0.0;
    for (size_t i = 0; i < dem_count(e->box.sim); i++) {
        const dem_state *s = &e->box.states[i];
        if (isnan(e->box.x[s->id])) continue;
        n += 1.0;
        contacts += s->contacts;
        rattlers += s->contacts < 2;
        x += s->x / e->p->box.W;
        y += s->y / e->box.d;
        depth += e->depth[s->id];
    }
    v->grains = n;
    v->contact_number = contacts / n;
    v->rattlers = rattlers / n;
    v->all_x = x / n;
    v->all_y = y / n;
    v->all_depth = depth / n;
    v->psi6 = exp_bond_order(dem_count(e->box.sim), e->box.states, NULL, NULL);
}

/* ---- Phases, each from where the last one ends, or from where a snapshot was written ---- */

static rp_status note_pile(void *data)
{
    experiment *e = data;
    onset_values *const v = e->v;
    ang_slope slopes[ANG_N_METHODS];
    ang_tilt_result theory;
    dem_contact *contacts = NULL;
    size_t n = 0;
    RP_TRY(sweep_box_pile_slopes(&e->box, slopes));
    RP_TRY(sweep_state_write(e->box.tables, e->box.sim, "pile"));
    RP_TRY(sweep_box_note(&e->box));
    RP_TRY(measure_surface(e));
    RP_TRY(dem_contacts(e->box.sim, &contacts, &n));
    measure_forces(e, n, contacts);
    measure_grains(e);
    free(contacts);
    v->theta_r3_deg = sweep_degrees(slopes[2].theta);
    if (!(slopes[2].theta < 0.0)) {
        RP_TRY(ang_tilt(ANG_BALANCED, e->box.scene.def.walls[DEM_BOX_FLOOR].material.mu, slopes[2].theta,
                        M_PI / 3.0, &theory));
        v->theta_t_theory_deg = sweep_degrees(theory.theta_t);
    }
    return dem_clone(e->box.sim, &e->box.rested);
}

static rp_status find_onset(void *data)
{
    experiment *e = data;
    double *theta_t = &e->v->theta_t_displacement_deg;
    rp_status status = sweep_box_tilt(&e->box, false, e->p->tilt_rate_deg, theta_t, NULL);
    return !status && isnan(*theta_t) ? sweep_conclude(e->box.result, "stable", "stable at 60 degrees")
                                      : status;
}

/* ---- the second tilt ---- */

/* Displacement of the grains that are still there since they were noted, less the best affine one: squares
 * sum[i] by grain, in d^2; *about_mean gets the squares about the mean displacement. Rows of grains of the
 * pile are packed to the front of `state`. */
typedef struct {
    size_t n;
    dem_state *state;
    double *ux, *uy, *square;
    double about_mean;
} motion;

static rp_status measure_motion(experiment *e, motion *m)
{
    enum { TERMS = 3 };
    double cx[TERMS], cy[TERMS], covariance[TERMS * TERMS], mean_x = 0.0, mean_y = 0.0;
    RP_TRY(dem_states(e->box.sim, e->box.states));
    m->n = 0;
    m->state = e->box.states;
    m->ux = e->box.work;
    m->uy = m->ux + e->box.most;
    m->square = m->uy + e->box.most;
    double *X = malloc(TERMS * e->box.most * sizeof *X);
    if (!X) return rp_fail(RP_NO_MEMORY, "onset: out of memory");
    for (size_t i = 0; i < dem_count(e->box.sim); i++) {
        const dem_state s = e->box.states[i];
        if (isnan(e->box.x[s.id])) continue;
        const double x = e->box.x[s.id], y = e->box.y[s.id];
        X[TERMS * m->n] = 1.0;
        X[TERMS * m->n + 1] = x / e->box.d;
        X[TERMS * m->n + 2] = y / e->box.d;
        m->ux[m->n] = (s.x - x) / e->box.d;
        m->uy[m->n] = (s.y - y) / e->box.d;
        mean_x += m->ux[m->n];
        mean_y += m->uy[m->n];
        m->state[m->n++] = s;
    }
    stats_linear in_x = {m->n, TERMS, X, m->ux, NULL, GSL_DBL_EPSILON, cx, covariance},
                 in_y = {m->n, TERMS, X, m->uy, NULL, GSL_DBL_EPSILON, cy, covariance};
    rp_status status = m->n < TERMS ? RP_OK : stats_linear_fit(&in_x);
    if (!status && m->n >= TERMS) status = stats_linear_fit(&in_y);
    m->about_mean = 0.0;
    for (size_t i = 0; !status && i < m->n; i++) {
        const double *x = &X[TERMS * i];
        m->square[i] = gsl_pow_2(m->ux[i] - cx[0] - cx[1] * x[1] - cx[2] * x[2]) +
                       gsl_pow_2(m->uy[i] - cy[0] - cy[1] * x[1] - cy[2] * x[2]);
        m->about_mean +=
            gsl_pow_2(m->ux[i] - mean_x / (double)m->n) + gsl_pow_2(m->uy[i] - mean_y / (double)m->n);
    }
    free(X);
    return status;
}

/* Where grains move otherwise than the pile. */
static void note_motion(const experiment *e, const motion *m, double of[N_MOTIONS])
{
    double sum = 0.0, x = 0.0, y = 0.0, depth = 0.0;
    for (size_t i = 0; i < m->n; i++) {
        const uint32_t id = m->state[i].id;
        sum += m->square[i];
        x += m->square[i] * e->box.x[id] / e->p->box.W;
        y += m->square[i] * e->box.y[id] / e->box.d;
        depth += m->square[i] * e->depth[id];
    }
    of[NONAFFINE] = sqrt(sum / (double)m->n);
    of[NONAFFINE_SHARE] = sum / m->about_mean;
    of[MOVES_X] = x / sum;
    of[MOVES_Y] = y / sum;
    of[MOVES_DEPTH] = depth / sum;
}

/* Shares of the grains that have moved 0.1 d, zone by zone. */
static void note_zones(experiment *e, const motion *m)
{
    double moved[N_COLUMNS][N_LAYERS] = {{0}}, all[N_COLUMNS][N_LAYERS] = {{0}};
    for (size_t i = 0; i < m->n; i++) {
        const uint32_t id = m->state[i].id;
        const int column = (int)(N_COLUMNS * e->box.x[id] / e->p->box.W), layer = e->depth[id] < 1.5 ? SURFACE
                                                                                  : e->box.y[id] < e->box.d
                                                                                      ? BASE
                                                                                      : BULK;
        all[column][layer] += 1.0;
        moved[column][layer] += gsl_pow_2(m->ux[i]) + gsl_pow_2(m->uy[i]) > 0.01;
    }
    for (int k = 0; k < N_COLUMNS; k++)
        for (int j = 0; j < N_LAYERS; j++) e->v->moved[k][j] = moved[k][j] / all[k][j];
}

/* `quarter`: of the tilting angle; negative at PROBE_DEG. */
static rp_status read_pile(experiment *e, int quarter)
{
    onset_values *const v = e->v;
    dem_contact *contacts = NULL;
    size_t n = 0;
    motion m;
    RP_TRY(dem_contacts(e->box.sim, &contacts, &n));
    const limits l = count_limits(e, n, contacts);
    free(contacts);
    for (int k = 0; quarter >= 0 && k < N_CLASSES; k++) v->limit[k][quarter] = l.where[k];
    if (quarter >= 0 && quarter != HALF && quarter != ONSET) return RP_OK;
    RP_TRY(measure_motion(e, &m));
    if (quarter == HALF) note_motion(e, &m, v->at_half);
    if (quarter == ONSET) note_motion(e, &m, v->at_onset);
    if (quarter == ONSET) note_zones(e, &m);
    if (quarter >= 0) return RP_OK;
    v->limit_probe = l.all;
    for (size_t i = 0; i < m.n; i++) m.square[i] = hypot(m.ux[i], m.uy[i]);
    gsl_sort(m.square, 1, m.n);
    v->reach_probe = m.square[(size_t)(0.95 * ((double)m.n - 1.0))];
    return RP_OK;
}

/* The tilts at which the pile is read, in order. */
static rp_status tilt_again(void *data)
{
    experiment *e = data;
    const double rate = e->p->tilt_rate_deg, theta_t = e->v->theta_t_displacement_deg;
    struct {
        long turned; /* steps */
        int quarter;
        bool probed;
    } now = {0, 0, false};
    rp_status status = RP_OK;
    sweep_box_go_back(&e->box);
    if (SWEEP_ENTER(e->box.keep, now)) dem_gravity_turn(e->box.sim, rate * (M_PI / 180.0));
    while (now.quarter < N_QUARTERS && !status) {
        const long at = lround(now.quarter * theta_t / (4.0 * rate)), probe = lround(PROBE_DEG / rate);
        const bool probes = !now.probed && probe <= at;
        const long to = probes ? probe : at;
        status = sweep_box_advance(&e->box, to - now.turned);
        if (!status) status = read_pile(e, probes ? -1 : now.quarter);
        now.turned = to;
        now.probed = now.probed || probes;
        now.quarter += !probes;
    }
    sweep_keep_leave(e->box.keep, 1);
    return status ? status : sweep_conclude(e->box.result, "ok", NULL);
}

static rp_status run_one(const void *params, unsigned long seed, unsigned long run,
                         const sweep_tables *tables, sweep_result *result)
{
    static rp_status (*const phases[])(void *) = {note_pile, find_onset, tilt_again};
    const sweep_tilted *p = params;
    experiment e = {.p = p, .v = (void *)result->values};
    rp_status status = sweep_box_begin_filled(&e.box, &p->box, seed, run, tables, result);
    if (!status) e.depth = calloc(e.box.most + 1, sizeof *e.depth);
    if (!status && !e.depth) status = rp_fail(RP_NO_MEMORY, "onset: out of memory");
    if (!status) {
        sweep_keep_enter(e.box.keep, e.depth, (e.box.most + 1) * sizeof *e.depth);
        status = sweep_tilted_phases(&e.box, sizeof phases / sizeof *phases, phases, &e);
        e.v->steps = sweep_box_steps(&e.box);
    }
    free(e.depth);
    return sweep_box_end(&e.box, status);
}

static rp_status fingerprint(char digits[33])
{
    return sweep_tilted_fingerprint(
        run_one, outputs,
        "theta_r3_deg theta_t_displacement_deg theta_steepest_deg scatter floor_friction_0 bulk_friction_0 "
        "fabric reach_probe limit_inside_0 limit_inside_4 nonaffine_onset moves_depth_onset grains steps",
        digits);
}

SWEEP_PROTOCOL(
    onset, sweep_tilted_schema, sweep_tilted, onset_values, sweep_tilted_check,
    "the pile of `repose`, tilted until it moves: what predicts the angle, what slides and moves first");
