/* Protocol `stress`: the box of protocol `repose` to its pile at rest; then gravity is tilted by small
 * angles, each to rest, and the forces of all contacts are read. Yields the response of floor forces and mean
 * stress to tilt, and from it the tilt at which Coulomb's law is reached (src/stress/stress.c), beside the
 * tilt at which a copy of the same pile moves. Traced, the run leaves the coarse-grained stress at each tilt.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "sweeps/protocols/tilted.h"
#include "stats/stats.h"
#include "stress/stress.h"

/* Tilts at which the forces are read, degrees; the response is that of the first N_FITTED, or as many as
 * there are, and the last shows how far it holds. */
static const double tilts_deg[] = {0.0, 0.5, 1.0, 2.0, 4.0};
enum { N_TILTS = sizeof tilts_deg / sizeof *tilts_deg, N_FITTED = 4, LEAST_TILTS = 3 };

/* clang-format off */
#define OUTPUTS(X) \
    X(theta_r3_deg, "degree", "slope by method 3") \
    X(theta_t_displacement_deg, "degree", "tilt at which 5 % of the grains have moved 0.1 d") \
    X(n_0, "weight", "normal force on the floor, 0 < x < W, over all grains' weight normal to it; at tilt 0") \
    X(n_1, "weight", "rise of n with the tangent of the tilt") \
    X(h_0, "weight", "force of the pile along the floor, away from the wall; at tilt 0") \
    X(h_1, "weight", "rise of h with the tangent of the tilt") \
    X(sxx_0, "weight d", "sum over the contacts in 0 < x < W of force along x times branch along x; at tilt 0") \
    X(sxy_0, "weight d", "sum of force along x times branch along y; at tilt 0") \
    X(syx_0, "weight d", "sum of force along y times branch along x; at tilt 0") \
    X(syy_0, "weight d", "sum of force along y times branch along y; at tilt 0") \
    X(sxx_1, "weight d", "rise of sxx with the tangent of the tilt") \
    X(sxy_1, "weight d", "rise of sxy with the tangent of the tilt") \
    X(syx_1, "weight d", "rise of syx with the tangent of the tilt") \
    X(syy_1, "weight d", "rise of syy with the tangent of the tilt") \
    X(floor_friction_0, "", "h/n at tilt 0") \
    X(bulk_friction_0, "", "tangent of the angle that the pile's mean stress mobilises, at tilt 0") \
    X(floor_tilt_deg, "degree", "tilt at which h/n reaches the floor's mu") \
    X(floor_friction_beyond, "", "h/n at 4 degrees less what the response of up to 2 degrees gives") \
    X(couple_0, "", "half of xy - yx, over the mean pressure, at tilt 0") \
    X(tilts, "", "tilts at which forces were read, before 5 % of the grains had moved 0.1 d") \
    X(weight_error, "weight", "floor, wall and shear through x = W less the weight of 0 < x < W, at tilt 0") \
    X(balance_error, "m g", "largest net force on a grain of the pile, of its contacts and weight, at any tilt") \
    X(grains, "", "grains with 0 < x < W in the pile") \
    X(steps, "", "steps in all")
/* clang-format on */
typedef struct {
    OUTPUTS(SWEEP_OUTPUT_MEMBER)
} stress_values;
static const sweep_output outputs[] = {OUTPUTS(SWEEP_OUTPUT_ROW){0}};

/* What is read of one state: tan of the tilt; over the weight normal to the floor, the forces on the floor
 * and the stress times d. The response of each part is two outputs. */
enum { N, H, SXX, SXY, SYX, SYY, N_PARTS };
typedef struct {
    double t, part[N_PARTS], weight_error, balance_error;
} reading;

typedef struct {
    const sweep_tilted *p;
    sweep_box_run box;
    stress_values *v; /* of the result */
    double weight;    /* of all grains at rest */
    reading readings[N_TILTS];
    size_t n_readings;
} experiment;

/* ---- Phases, each from where the last one ends, or from where a snapshot was written ---- */

static rp_status note_pile(void *data)
{
    experiment *e = data;
    ang_slope slopes[ANG_N_METHODS];
    RP_TRY(sweep_box_pile_slopes(&e->box, slopes));
    e->v->theta_r3_deg = sweep_degrees(slopes[2].theta);
    RP_TRY(sweep_state_write(e->box.tables, e->box.sim, "pile"));
    RP_TRY(sweep_box_note(&e->box));
    for (size_t i = 0; i < dem_count(e->box.sim); i++) e->weight += e->box.states[i].m * e->p->box.g;
    e->v->grains = (double)e->box.n_noted;
    return dem_clone(e->box.sim, &e->box.rested);
}

static void contact_force(const dem_contact *c, stress_contact *force)
{
    const double lx = c->x - c->x_b, ly = c->y - c->y_b, l = sqrt(lx * lx + ly * ly), nx = lx / l,
                 ny = ly / l;
    *force = (stress_contact){c->x,
                              c->y,
                              c->x_b,
                              c->y_b,
                              c->normal_force * nx + c->shear_force * ny,
                              c->normal_force * ny - c->shear_force * nx};
}

/* Net force on each grain, from contacts and weight: the largest on a grain of the pile; and what is missing
 * in the vertical balance of the column 0 < x < W, between floor, left wall, the shear through the line x =
 * W, and the weight. The contacts within the column cancel. */
static void check_balance(experiment *e, size_t n, const dem_contact contacts[],
                          const stress_contact forces[], const double g[2], reading *r)
{
    double *fx = e->box.work, *fy = fx + e->box.scene.fill.N;
    memset(fx, 0, 2 * (size_t)e->box.scene.fill.N * sizeof *fx);
    for (size_t k = 0; k < n; k++) {
        const stress_contact *f = &forces[k];
        fx[contacts[k].id_a - 1] += f->fx;
        fy[contacts[k].id_a - 1] += f->fy;
        if (contacts[k].id_b == 0) continue;
        fx[contacts[k].id_b - 1] -= f->fx;
        fy[contacts[k].id_b - 1] -= f->fy;
    }
    for (size_t i = 0; i < dem_count(e->box.sim); i++) {
        const dem_state *s = &e->box.states[i];
        if (!(s->x > 0.0 && s->x < e->p->box.W)) continue;
        double x = fx[s->id - 1] + s->m * g[0], y = fy[s->id - 1] + s->m * g[1];
        r->weight_error += y / e->weight;
        if (s->contacts > 0) r->balance_error = fmax(r->balance_error, sqrt(x * x + y * y) / e->box.mg);
    }
}

/* `forces` is room for those of the n contacts. */
static rp_status sum_forces(experiment *e, size_t n, const dem_contact contacts[], stress_contact forces[],
                            reading *r)
{
    const sweep_box *b = &e->p->box;
    double g[2];
    dem_gravity(e->box.sim, g);
    const double normal = e->weight * -g[1] / b->g; /* the weight's part normal to the floor */
    *r = (reading){.t = -g[0] / g[1]};
    for (size_t k = 0; k < n; k++) {
        const dem_contact *c = &contacts[k];
        contact_force(c, &forces[k]);
        if (c->id_b || c->wall != DEM_BOX_FLOOR || !(c->x > 0.0 && c->x < b->W)) continue;
        r->part[N] += forces[k].fy / normal;
        r->part[H] -= forces[k].fx / normal;
    }
    /* one cell of unit area times weight times d */
    const stress_grid grid = {0.0, 0.0, b->W, 4.0 * e->p->box.H, 1, 1};
    const double scale = grid.dx * grid.dy / (normal * e->box.d);
    stress_tensor s;
    rp_status status = stress_cells(n, forces, &grid, &s);
    r->part[SXX] = scale * s.xx, r->part[SXY] = scale * s.xy;
    r->part[SYX] = scale * s.yx, r->part[SYY] = scale * s.yy;
    check_balance(e, n, contacts, forces, g, r);
    return status;
}

static rp_status read_forces(experiment *e, double tilt_deg)
{
    dem_contact *contacts = NULL;
    size_t n = 0;
    char stage[64];
    rp_status status = dem_contacts(e->box.sim, &contacts, &n);
    stress_contact *forces = malloc((n + 1) * sizeof *forces);
    if (!status && !forces) status = rp_fail(RP_NO_MEMORY, "stress: out of memory");
    if (!status) status = dem_states(e->box.sim, e->box.states);
    if (!status) status = sum_forces(e, n, contacts, forces, &e->readings[e->n_readings++]);
    free(contacts);
    free(forces);
    snprintf(stage, sizeof stage, "tilt_%g", tilt_deg);
    return status ? status : sweep_state_write(e->box.tables, e->box.sim, stage);
}

/* Tilt by tilt, until the pile moves. */
static rp_status tilt_to_rest(void *data)
{
    experiment *e = data;
    struct {
        int k;
        bool waits;
    } now = {1, false};
    rp_status status = SWEEP_ENTER(e->box.keep, now) ? read_forces(e, 0.0) : RP_OK;
    for (; now.k < N_TILTS && !status; now.k++) {
        const double step_deg = tilts_deg[now.k] - tilts_deg[now.k - 1];
        const long steps = lround(step_deg / e->p->tilt_rate_deg);
        bool moved = false;
        if (!now.waits) {
            dem_gravity_turn(e->box.sim, step_deg / (double)steps * (M_PI / 180.0));
            status = sweep_box_advance(&e->box, steps);
            dem_gravity_turn(e->box.sim, 0.0);
        }
        now.waits = true;
        if (!status) status = sweep_box_settle(&e->box, "tilt", false);
        if (!status) status = sweep_box_onset(&e->box, &moved);
        if (moved) break;
        if (!status) status = read_forces(e, tilts_deg[now.k]);
        now.waits = false;
    }
    sweep_keep_leave(e->box.keep, 1);
    return status;
}

static rp_status tilt_at_rate(void *data)
{
    experiment *e = data;
    sweep_box_go_back(&e->box);
    return sweep_box_tilt(&e->box, false, e->p->tilt_rate_deg, &e->v->theta_t_displacement_deg, NULL);
}

/* Value at t = 0 and rise of a part of the readings, by least squares. */
static rp_status respond(const experiment *e, int part, stress_linear *response)
{
    double t[N_TILTS], v[N_TILTS];
    stats_line line;
    const size_t n = e->n_readings < N_FITTED ? e->n_readings : N_FITTED;
    for (size_t k = 0; k < n; k++) {
        t[k] = e->readings[k].t;
        v[k] = e->readings[k].part[part];
    }
    rp_status status = stats_line_fit(&(stats_xy){n, t, v, NULL}, false, &line);
    *response = (stress_linear){line.intercept, line.slope};
    return status;
}

static rp_status conclude(void *data)
{
    experiment *e = data;
    stress_values *const v = e->v;
    stress_linear r[N_PARTS];
    const double mu_floor = e->box.scene.def.walls[DEM_BOX_FLOOR].material.mu;
    const reading *first = &e->readings[0], *last = &e->readings[e->n_readings - 1];
    const stress_circle circle =
        stress_mohr(&(stress_tensor){first->part[SXX], first->part[SXY], first->part[SYX], first->part[SYY]});
    v->couple_0 = circle.couple / circle.pressure;
    v->tilts = (double)e->n_readings;
    v->weight_error = first->weight_error;
    v->balance_error = 0.0;
    v->floor_friction_0 = first->part[H] / first->part[N];
    v->bulk_friction_0 = tan(circle.mobilised);
    for (size_t k = 0; k < e->n_readings; k++)
        v->balance_error = fmax(v->balance_error, e->readings[k].balance_error);
    if (e->n_readings < LEAST_TILTS)
        return sweep_conclude(e->box.result, "no_response", "the pile moves at the first tilts");
    double *const at_0[] = {&v->n_0, &v->h_0, &v->sxx_0, &v->sxy_0, &v->syx_0, &v->syy_0},
                  *const rises[] = {&v->n_1, &v->h_1, &v->sxx_1, &v->sxy_1, &v->syx_1, &v->syy_1};
    for (int part = 0; part < N_PARTS; part++) RP_TRY(respond(e, part, &r[part]));
    for (int part = 0; part < N_PARTS; part++) {
        *at_0[part] = r[part].at_0;
        *rises[part] = r[part].rise;
    }
    v->floor_tilt_deg = sweep_degrees(stress_floor_tilt(&r[N], &r[H], mu_floor));
    if (e->n_readings == N_TILTS)
        v->floor_friction_beyond = last->part[H] / last->part[N] -
                                   (r[H].at_0 + r[H].rise * last->t) / (r[N].at_0 + r[N].rise * last->t);
    return sweep_conclude(e->box.result, "ok", NULL);
}

static rp_status run_one(const void *params, unsigned long seed, unsigned long run,
                         const sweep_tables *tables, sweep_result *result)
{
    static rp_status (*const phases[])(void *) = {note_pile, tilt_to_rest, tilt_at_rate, conclude};
    const sweep_tilted *p = params;
    experiment e = {.p = p, .v = (void *)result->values};
    rp_status status = sweep_box_begin_filled(&e.box, &p->box, seed, run, tables, result);
    if (status) return sweep_box_end(&e.box, status);
    SWEEP_ENTER(e.box.keep, e.weight);
    SWEEP_ENTER(e.box.keep, e.readings);
    SWEEP_ENTER(e.box.keep, e.n_readings);
    status = sweep_tilted_phases(&e.box, sizeof phases / sizeof *phases, phases, &e);
    e.v->steps = sweep_box_steps(&e.box);
    return sweep_box_end(&e.box, status);
}

static rp_status fingerprint(char digits[33])
{
    return sweep_tilted_fingerprint(
        run_one, outputs,
        "theta_r3_deg theta_t_displacement_deg n_0 n_1 h_0 h_1 sxx_0 syx_1 floor_tilt_deg "
        "weight_error balance_error grains steps",
        digits);
}

SWEEP_PROTOCOL(
    stress, sweep_tilted_schema, sweep_tilted, stress_values, sweep_tilted_check,
    "the pile of `repose`, tilted by small angles: forces on the floor, stress, Coulomb-critical tilt");
