/* Protocol `drop`: a pile of disks that are dropped one at a time, from two diameters above its highest point
 * (Liffman, Chan & Hughes 1992, fig 20), each once the pile is quiet.
 *
 * Lengths in d, the mean diameter; masses in m, a disk's of that diameter; g = 1. What the paper leaves open:
 * resistance to rolling, without which disks roll away; the positions, uniform over the source's width; when
 * a disk is at rest; K_slip. With the paper's viscous slip alone between disks at rest, law = slip_roll, a
 * pile creeps for as long as one waits, so that K_slip and the waiting time decide how steep it is. With
 * shear springs, the default, neither matters. k_s = K_s/4 and k_roll = K_s/20 shorten the time step by no
 * more than 3 %; eps = 2e-3 is for steps as long as can be.
 *
 * The fall itself is not simulated: a disk starts just above what it will hit, with the speed of its fall.
 * The next falls when no disk is fast or far from balance, though the pile may still sway. After the last the
 * pile comes to rest entirely, by kinetic damping: all velocities are set to 0 where the kinetic energy has a
 * maximum. All disks move at all times: with those farther than 4 to 9 d from the falling one held, whole
 * flanks slip under it, and piles are 2 or 3 degrees steeper.
 *
 * The base may have a friction of its own, which hard collisions with it ignore, or be rough: disks of
 * diameter 1 are glued to it, their lower halves below the ground. They never move, and what they carry is
 * load of the base, where the disk above has its centre.
 *
 * A pile may start from a lattice of disks, the same as protocol `pile` with disorder = radius_width has, at
 * rest and without load. It comes to rest by the relaxation, as a dropped pile does. This tells the disorder
 * of a lattice from that of drops.
 *
 * A layer is no result (no_pile), nor is a pile with a drop that was cut short, so that the next fell onto
 * disks that still moved (drops_not_quiet), nor one that does not relax at the end (not_at_rest). Their
 * outputs are kept. */
#include <gsl/gsl_fit.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <xxhash.h>

#include "experiment/modules/base.h"
#include "experiment/modules/module.h"
#include "stress/stress.h"
#include "core/random.h"
#include "core/file.h"
#include "table/table.h"
#include "dem/scene/scene.h"
#include "sweeps/engine/keep.h"
#include "sweeps/protocols/pile.h"

typedef struct {
    double source_width, drop_height, radius_width, restitution, mu, mu_roll, eps, damping, mu_static, a;
    double damping_shear, rest_speed, rest_force, x_limit, mu_base, glued, lattice_deg;
    long N, max_steps, lattice;
    int law, collisions;
} drop_params;

#define AT(field) offsetof(drop_params, field)

enum { LAW_SLIP_ROLL, LAW_SPRING };
enum { COLLISIONS_HARD, COLLISIONS_SOFT };

/* clang-format off */
#define ROW(...)            DEM_NAME_ROW(drop_params, , __VA_ARGS__)
static const rp_param schema[] = {
    DEM_MU_PARAM(ROW, "0.5") /* of hard collisions too; the paper's */
    DEM_MU_ROLL_PARAM(ROW, "0.1") /* without it disks roll away */
    {"N", "", RP_INT, AT(N), "968", "[0, 100000]", "disks that are dropped; at least 2 without a lattice"},
    {"source_width", "d", RP_REAL, AT(source_width), "1", "[0, 1000]", "disks fall uniformly over this width; of a point source 1"},
    {"drop_height", "d", RP_REAL, AT(drop_height), "2", "(0, 1000]", "from the highest point of the pile to a disk's lowest"},
    {"radius_width", "d/2", RP_REAL, AT(radius_width), "0", "[0, 0.2]", "standard deviation of the radii, cut at three of it"},
    {"law", "", RP_CHOICE, AT(law), "spring", "slip_roll | spring", "tangential law: viscous slip under mu N, and wells of the ground; or shear springs, at the ground too"},
    {"collisions", "", RP_CHOICE, AT(collisions), "hard", "hard | soft", "of fast disks: instantaneous ones, or soft contacts alone", true},
    {"restitution", "", RP_REAL, AT(restitution), "0.5", "[0, 1]", "of hard collisions"},
    {"eps", "", RP_REAL, AT(eps), "2e-3", "[1e-6, 1e-2]", "m g/(K_s d)"},
    {"damping", "", RP_REAL, AT(damping), "0.15", "(0, 2]", "normal, of contacts, over critical of a pair"},
    {"damping_shear", "", RP_REAL, AT(damping_shear), "0.03", "(0, 2]", "damping of shear and rolling, over critical of a pair"},
    {"mu_static", "", RP_REAL, AT(mu_static), "0.5", "(0, inf)", "static friction of the ground's wells"},
    {"a", "d", RP_REAL, AT(a), "0.05", "(0, 1]", "half-width of the ground's wells"},
    {"rest_speed", "sqrt(g d)", RP_REAL, AT(rest_speed), "0.1", "(0, 1]", "the next disk falls once all are slower than this, also at their rims,"},
    {"rest_force", "m g", RP_REAL, AT(rest_force), "0.2", "(0, 10]", "and nearer to balance than this, for a time 0.5"},
    {"x_limit", "d", RP_REAL, AT(x_limit), "100", "[10, 10000]", "a disk that goes farther from the middle has rolled away"},
    {"max_steps", "", RP_INT, AT(max_steps), "20000", "[100, 1000000000]", "most steps a drop"},
    {"mu_base", "", RP_REAL, AT(mu_base), "auto", "[0, inf) | auto", "friction of the ground; auto: mu", true},
    {"glued", "d", RP_REAL, AT(glued), "none", "[1, 10] | none", "from one disk that is glued to the ground to the next", true},
    {"lattice", "", RP_INT, AT(lattice), "0", "[0, 1000]", "disks in the base of a lattice that the drops fall on; 0: none", true},
    {"lattice_deg", "degree", RP_REAL, AT(lattice_deg), "30", "(0, 60]", "slope of the lattice", true},
    {0}};

#define OUTPUTS(X) \
    X(disks, "", "disks there at the end") \
    X(base_disks, "", "contacts with the base within B") \
    X(height, "d", "highest point") \
    X(width, "d", "base that holds 98 % of the load, B") \
    X(centroid, "d", "centroid of the load on the ground") \
    X(left_deg, "degree", "slope of the left side between 0.1 and 0.9 of the height, straight line") \
    X(right_deg, "degree", "slope of the right side, by the same fit") \
    X(dip, "", "D: mean N within 0.1 B of the centroid, less that from there to 0.3 B, over the mean") \
    X(balance, "", "1 - load of the ground over weight") \
    X(capped, "", "drops after which the pile was not quiet within max_steps; a pile with one is no result") \
    X(away, "", "disks that rolled away") \
    X(excess, "", "N less that of 60-degree rays under the pile's outline, mean within 0.1 B of the centroid, over the mean N") \
    X(middle, "", "mean N within 0.1 B of the centroid, less that from 0.1 B to 0.2 B, over the mean N") \
    X(psi6, "", "mean |psi_6| of the disks with two or more neighbours") \
    X(strongest_60, "", "share of the strongest contacts of the disks that run within 10 degrees of 60 or 120") \
    X(packed, "", "share of the disks that are close-packed: six neighbours, |psi_6| at least 0.9") \
    X(packed_60, "", "strongest_60 of the contacts between close-packed disks") \
    X(contacts, "", "mean contacts a disk") \
    X(moved_max, "", "largest number of disks that a drop moved by more than 0.1 d, itself left out") \
    X(moved_share, "", "share of drops that moved more than 10") \
    X(settled, "", "disks that the relaxation at the end moved by more than 0.1 d") \
    X(steps, "", "steps of the drops") \
    X(relax_steps, "", "steps of the relaxation at the end") \
    X(base_shear, "", "outward force on the base, both flanks, over the load") \
    X(fabric, "", "anisotropy of the contacts' directions farther than 0.1 B from the centroid, |mean exp(2 i direction)|") \
    X(fabric_deg, "degree", "their principal direction: from the vertical, positive if its upper end leans to the middle") \
    X(force_fabric, "", "fabric, each contact with the weight of its normal force") \
    X(force_deg, "degree", "fabric_deg with these weights")
/* clang-format on */
typedef struct {
    OUTPUTS(SWEEP_OUTPUT_MEMBER)
    SWEEP_BIN_FAMILIES
} drop_values;
static const sweep_output outputs[] = {OUTPUTS(SWEEP_OUTPUT_ROW) SWEEP_BIN_ROWS{0}};

typedef struct {
    const drop_params *p;
    sweep_result *result;
    drop_values *v; /* the result's */
    dem_definition scene;
    dem_sim *sim;
    size_t n_glued;             /* disks of the base; they come first */
    size_t n;                   /* disks in it, those of the base too */
    dem_state *states, *before; /* before: a drop, or the relaxation */
    gsl_rng *radii, *positions;
    long *moved; /* by each drop */
    bool relaxed;
    sweep_keep *keep; /* NULL: none */
} drop;

/* Between two looks at the pile, in steps; time for which it must be quiet. */
enum { EVERY = 20 };
static const double QUIET_TIME = 0.5;

static bool is_away(const drop *d, size_t i)
{
    return fabs(d->states[i].x) > d->p->x_limit;
}

static double degrees(double radians)
{
    return radians * (180.0 / M_PI);
}

/* ---- The scene ---- */

static const double density = 4.0 / M_PI; /* mass 1 at diameter 1 */

static dem_definition make_scene(const drop_params *p)
{
    const double k = 1.0 / p->eps, critical = 2.0 * sqrt(2.0 * k), /* m_eff = 1/2 */
        gamma_s = p->damping_shear * critical;
    dem_definition def = dem_definition_default();
    def.gravity[1] = -1.0;
    def.normal = DEM_LINEAR;
    def.tension = false;
    def.rotation = true;
    def.shape = DEM_DISK;
    def.damping = DEM_DAMPING_INSIDE;
    def.tangential = p->law == LAW_SPRING ? DEM_SPRING : DEM_SLIP_ROLL;
    def.material = (dem_material){.k_n = k,
                                  .gamma_n = p->damping * critical,
                                  .k_s = 0.25 * k,
                                  .gamma_s = gamma_s,
                                  .mu = p->mu,
                                  .mu_roll = p->mu_roll,
                                  .k_roll = 0.05 * k,
                                  .gamma_roll = gamma_s};
    def.hard = (dem_hard){p->collisions == COLLISIONS_HARD, p->restitution, p->mu};
    dem_material base = def.material;
    if (p->mu_base >= 0.0) base.mu = p->mu_base;
    dem_box_walls(&def, 1.0, &base);
    def.n_walls = 1; /* the floor of that box */
    if (p->law == LAW_SLIP_ROLL) def.ground = (dem_ground){1, p->mu_static, p->a, DEM_WELL_AGAIN};
    /* of the lightest disk, when it falls from a pile as steep as can be */
    const double r = 0.5 * (1.0 - 3.0 * p->radius_width), m = dem_mass(DEM_DISK, density, r),
                 top =
                     1.25 * sqrt((double)p->N) + 0.5 * sqrt(3.0) * (double)p->lattice + p->drop_height + 1.0;
    const double speed = sqrt(2.0 * top);
    const dem_grain two[2] = {{.y = r, .r = r, .m = m}, {.y = top, .r = r, .m = m, .vy = speed}};
    def.grains = two;
    def.n_grains = 2;
    def.dt =
        fmin(0.98 * dem_time_step_limit(&def, NULL), r / speed); /* a step moves no disk by more than r */
    def.grains = NULL;
    def.n_grains = 0;
    return def;
}

/* Number of the disks that are glued to the base, and, unless NULL, where they are: as far as disks of the
 * pile can be. */
static size_t glue(const drop_params *p, dem_state *states)
{
    if (!isfinite(p->glued)) return 0;
    const size_t half = (size_t)(p->x_limit / p->glued) + 2, n = 2 * half;
    for (size_t i = 0; i < n && states; i++)
        states[i] = (dem_state){.x = p->glued * ((double)i - (double)half + 0.5),
                                .r = 0.5,
                                .m = dem_mass(DEM_DISK, density, 0.5),
                                .fixed = true};
    return n;
}

/* The disks of the base and, from `glued` on, of the lattice, whose lowest row is the glued one if there is.
 */
static rp_status stack(const drop_params *p, unsigned long seed, unsigned long run, size_t glued, drop *d)
{
    sweep_outline h = {0};
    const sweep_pile pile = {
        .base = p->lattice, .alpha_deg = p->lattice_deg, .inner_deg = -1.0, .disorder = p->radius_width};
    rp_status status = p->lattice ? sweep_pile_outline(&pile, seed, run, &h) : RP_OK;
    d->states = status ? NULL : calloc(glued + h.n + (size_t)p->N, sizeof *d->states);
    if (!status && !d->states) status = rp_fail(RP_NO_MEMORY, "drop: out of memory");
    const double left = (double)((p->lattice - 1) / 2) + (glued ? 0.5 : 0.0), lift = glued ? -0.5 : 0.0;
    if (!status) glue(p, d->states);
    d->n = glued;
    for (size_t i = 0; i < h.n && !status; i++) {
        const statics_disk *disk = &h.disks[i];
        if (glued && disk->y <= 0.5) continue;
        d->states[d->n++] = (dem_state){.x = disk->x - left,
                                        .y = disk->y + lift,
                                        .r = disk->r,
                                        .m = dem_mass(DEM_DISK, density, disk->r)};
    }
    sweep_outline_free(&h);
    return status;
}

static dem_grain grain_of(const dem_state *s)
{
    return (dem_grain){.x = s->x, .y = s->y, .r = s->r, .m = s->m, .angle = s->angle, .fixed = s->fixed};
}

/* ---- Drops ---- */

/* The highest point. */
static an_point highest(const drop *d)
{
    an_point top = {0.0, 0.0};
    for (size_t i = 0; i < d->n; i++)
        if (d->states[i].y + d->states[i].r > top.y)
            top = (an_point){d->states[i].x, d->states[i].y + d->states[i].r};
    return top;
}

/* How many of the first n disks have moved by more than 0.1 d since they were marked. */
static size_t count_moved(const drop *d, size_t n)
{
    size_t moved = 0;
    for (size_t i = 0; i < n; i++) {
        const double dx = d->states[i].x - d->before[i].x, dy = d->states[i].y - d->before[i].y;
        moved += dx * dx + dy * dy > 0.01 && !is_away(d, i);
    }
    return moved;
}

static void mark_positions(drop *d)
{
    memcpy(d->before, d->states, d->n * sizeof *d->states);
}

static bool is_quiet(const drop *d)
{
    const double v2 = d->p->rest_speed * d->p->rest_speed, f = d->p->rest_force;
    for (size_t i = 0; i < d->n; i++) {
        const dem_state *s = &d->states[i];
        const double spin = s->omega * s->r;
        if ((s->vx * s->vx + s->vy * s->vy > v2 || spin * spin > v2 ||
             s->fx * s->fx + s->fy * s->fy > f * f * s->m * s->m || fabs(s->torque) > f * s->m * s->r) &&
            !s->fixed && !is_away(d, i))
            return false;
    }
    return true;
}

/* Until all are slow and nearly in balance for a while, or the drop has had its steps. */
static rp_status settle(drop *d, bool *quiet)
{
    struct {
        long start, quiet;
    } now = {dem_step(d->sim), 0};
    rp_status status = RP_OK;
    SWEEP_ENTER(d->keep, now);
    *quiet = false;
    while (!status && !*quiet && dem_step(d->sim) - now.start < d->p->max_steps) {
        status = dem_run(d->sim, EVERY);
        /* most often one is fast, and the others need not be looked at */
        const bool slow = dem_largest_speed(d->sim, -d->p->x_limit, d->p->x_limit) <= d->p->rest_speed;
        if (!status && slow) status = dem_states(d->sim, d->states);
        now.quiet = !status && slow && is_quiet(d) ? now.quiet + EVERY : 0;
        *quiet = (double)now.quiet * d->scene.dt >= QUIET_TIME;
        if (!status && !*quiet) status = sweep_keep_look(d->keep);
    }
    sweep_keep_leave(d->keep, 1);
    return status || *quiet ? status : dem_states(d->sim, d->states);
}

/* The disks that are there before the drops, and one more unless NULL. */
static rp_status begin(drop *d, const dem_grain *dropped)
{
    dem_definition def = d->scene;
    dem_grain *grains = malloc((d->n + 1) * sizeof *grains);
    if (!grains) return rp_fail(RP_NO_MEMORY, "drop: out of memory");
    for (size_t i = 0; i < d->n; i++) grains[i] = grain_of(&d->states[i]);
    if (dropped) grains[d->n] = *dropped;
    def.grains = grains;
    def.n_grains = d->n + (dropped ? 1 : 0);
    rp_status status = dem_create(&def, &d->sim);
    free(grains);
    return status;
}

static rp_status draw_and_put_in(drop *d)
{
    const drop_params *p = d->p;
    const double r = 0.5 * rp_random_cut_normal(d->radii, 1.0, p->radius_width, 1.0 - 3.0 * p->radius_width,
                                                1.0 + 3.0 * p->radius_width);
    const double x = p->source_width * (gsl_rng_uniform(d->positions) - 0.5),
                 y = exp_touch_height(d->n, d->states, x, r, 0.05, r + 0.05),
                 from = highest(d).y + p->drop_height + r;
    const dem_grain grain = {
        .x = x, .y = y, .r = r, .m = dem_mass(DEM_DISK, density, r), .vy = -sqrt(2.0 * (from - y))};
    mark_positions(d);
    rp_status status = d->sim ? dem_add(d->sim, &grain, NULL) : begin(d, &grain);
    d->n++;
    return status;
}

static rp_status drop_all(drop *d)
{
    struct {
        long k;
        double capped, most, large;
        bool falls; /* disk k has been put in */
    } now = {0};
    drop_values *const v = d->v;
    rp_status status = RP_OK;
    SWEEP_ENTER(d->keep, now);
    if (!d->sim && d->p->N == 0) status = begin(d, NULL);
    for (; now.k < d->p->N && !status; now.k++) {
        bool quiet = false;
        if (!now.falls) status = draw_and_put_in(d);
        now.falls = true;
        if (!status) status = settle(d, &quiet);
        if (status) break;
        const long moved = d->moved[now.k] = (long)count_moved(d, d->n - 1);
        now.capped += !quiet;
        now.most = fmax(now.most, (double)moved);
        now.large += moved > 10;
        now.falls = false;
    }
    sweep_keep_leave(d->keep, 1);
    if (status) return status;
    v->capped = now.capped;
    v->steps = (double)dem_step(d->sim);
    v->moved_max = now.most;
    v->moved_share = now.large / (double)d->p->N;
    return RP_OK;
}

/* ---- Relaxation of the whole pile ---- */

/* The same pile with all velocities 0. */
static rp_status stop_all(drop *d)
{
    dem_definition def = d->scene;
    dem_contact *contacts;
    rp_status status = dem_contacts(d->sim, &contacts, &def.n_contacts);
    dem_grain *grains = malloc(d->n * sizeof *grains);
    if (!status && !grains) status = rp_fail(RP_NO_MEMORY, "drop: out of memory");
    for (size_t i = 0; i < d->n && !status; i++) grains[i] = grain_of(&d->states[i]);
    def.grains = grains;
    def.n_grains = d->n;
    def.contacts = contacts;
    dem_sim *next;
    if (!status) status = dem_create(&def, &next);
    if (!status) {
        dem_free(d->sim);
        d->sim = next;
    }
    free(grains);
    free(contacts);
    return status;
}

static rp_status relax(drop *d)
{
    enum { MOST = 100000, ENOUGH = 10 };
    struct {
        double before;
        long steps, quiet;
    } now = {0.0, 0, 0};
    rp_status status = RP_OK;
    if (SWEEP_ENTER(d->keep, now)) {
        mark_positions(d);
        d->scene.dt *=
            0.9; /* near its limit a pile hums, and that energy hides where the other has its maxima */
    }
    for (; now.steps < MOST && now.quiet < ENOUGH && !status; status = sweep_keep_look(d->keep)) {
        dem_rest rest;
        status = dem_run(d->sim, EVERY);
        if (!status) status = dem_states(d->sim, d->states);
        if (!status) status = dem_rest_state(d->sim, -d->p->x_limit, d->p->x_limit, &rest);
        if (status) break;
        now.quiet = dem_at_rest(&rest, 1e-12, 1e-4, false) ? now.quiet + 1 : 0;
        const bool falls = rest.kinetic_energy < now.before;
        if (falls) status = stop_all(d);
        if (status) break;
        now.before = falls ? 0.0 : rest.kinetic_energy;
        now.steps += EVERY;
    }
    sweep_keep_leave(d->keep, 1);
    if (status) return status;
    d->v->relax_steps = (double)now.steps;
    d->v->settled = (double)count_moved(d, d->n);
    d->relaxed = now.quiet >= ENOUGH;
    return RP_OK;
}

/* ---- What is measured ---- */

/* Slope by a straight line through the highest points of columns one diameter wide, from the column of the
 * top to the side, between 0.1 and 0.9 of the height. */
static double side_slope(const drop *d, double sign, an_point highest)
{
    enum { COLUMNS = 400 };
    double top[COLUMNS] = {0.0}, x[COLUMNS], intercept, slope, unused;
    size_t n = 0;
    for (size_t i = 0; i < d->n; i++) {
        const double along = sign * (d->states[i].x - highest.x);
        if (along < 0.0 || along >= COLUMNS) continue;
        double *t = &top[(size_t)along];
        *t = fmax(*t, d->states[i].y + d->states[i].r);
    }
    for (int k = 0; k < COLUMNS; k++) {
        if (top[k] <= 0.1 * highest.y) break; /* also where there is no disk at all */
        if (top[k] > 0.9 * highest.y) continue;
        x[n] = k + 0.5;
        top[n++] = top[k]; /* n <= k */
    }
    gsl_fit_linear(x, 1, top, 1, n, &intercept, &slope, &unused, &unused, &unused, &unused);
    return -degrees(atan(slope));
}

static void measure_shape(const drop *d)
{
    const an_point top = highest(d);
    drop_values *const v = d->v;
    v->disks = (double)d->n;
    v->away = (double)d->p->N - (double)d->n;
    v->height = top.y;
    v->left_deg = side_slope(d, -1.0, top);
    v->right_deg = side_slope(d, 1.0, top);
}

static int by_id(const void *a, const void *b)
{
    const dem_state *s = a, *t = b;
    return (s->id > t->id) - (s->id < t->id);
}

/* Index of the disk with that id among those that are left, n if it is not. Both orders ascend. */
static size_t find(const drop *d, uint32_t id)
{
    const dem_state *s = bsearch(&(dem_state){.id = id}, d->states, d->n, sizeof *s, by_id);
    return s ? (size_t)(s - d->states) : d->n;
}

/* Within 10 degrees of 60 or 120 degrees to the horizontal. */
static bool is_at_60(const dem_contact *c)
{
    const double turn = degrees(atan2(fabs(c->y_b - c->y), fabs(c->x_b - c->x)));
    return fabs(turn - 60.0) <= 10.0;
}

/* Of contacts between disks that no other contact of one of their disks is stronger than; most[i]: the
 * strongest force of disk i. */
static void measure_strongest(const drop *d, size_t n, const dem_contact contacts[], const bool packed[],
                              double most[])
{
    double all[2] = {0.0}, at_60[2] = {0.0};
    for (int pass = 0; pass < 2; pass++)
        for (const dem_contact *c = contacts; c < contacts + n; c++) {
            const size_t a = find(d, c->id_a), b = c->id_b ? find(d, c->id_b) : d->n;
            if (a == d->n || b == d->n) continue;
            if (pass == 0) {
                most[a] = fmax(most[a], c->normal_force);
                most[b] = fmax(most[b], c->normal_force);
            } else if (c->normal_force >= fmin(most[a], most[b])) {
                const bool both = packed[a] && packed[b];
                all[0] += 1.0, all[1] += both;
                at_60[0] += is_at_60(c), at_60[1] += both && is_at_60(c);
            }
        }
    d->v->strongest_60 = at_60[0] / all[0];
    d->v->packed_60 = at_60[1] / all[1];
}

/* Bond order, close-packed disks, and directions of the strongest contacts. */
static rp_status measure_order(const drop *d, size_t n_contacts, const dem_contact contacts[])
{
    RP_SCOPE(memory);
    drop_values *const v = d->v;
    double touching = 0.0, n_packed = 0.0, *order, *most;
    int *neighbours;
    bool *packed;
    RP_NEW(&memory, order, d->n);
    RP_NEW(&memory, most, d->n);
    RP_NEW(&memory, neighbours, d->n);
    RP_NEW(&memory, packed, d->n);
    v->psi6 = exp_bond_order(d->n, d->states, order, neighbours);
    for (size_t i = 0; i < d->n; i++) {
        touching += d->states[i].contacts;
        packed[i] = neighbours[i] == 6 && order[i] >= 0.9;
        n_packed += packed[i];
    }
    v->contacts = touching / (double)d->n;
    v->packed = n_packed / (double)d->n;
    measure_strongest(d, n_contacts, contacts, packed, most);
    return RP_OK;
}

/* Pressure of rays under the outline, beside that of the base. */
static rp_status measure_rays(const drop *d, const stress_base *base)
{
    RP_SCOPE(memory);
    double *x, *top;
    RP_NEW(&memory, x, d->n);
    RP_NEW(&memory, top, d->n);
    for (size_t i = 0; i < d->n; i++) {
        x[i] = d->states[i].x;
        top[i] = d->states[i].y + d->states[i].r;
    }
    RP_TRY(exp_outline_rays(d->n, x, top, base, d->v->rays));
    d->v->excess = stress_excess(base->N, d->v->rays);
    return RP_OK;
}

/* Anisotropy and principal direction of the contacts between disks of the flanks, the left flank mirrored. */
static void measure_fabric(const drop *d, size_t n, const dem_contact contacts[], const stress_base *base)
{
    double cos2[2] = {0.0}, sin2[2] = {0.0}, weights[2] = {0.0};
    for (const dem_contact *c = contacts; c < contacts + n; c++) {
        const double out = 0.5 * (c->x + c->x_b) - base->centroid;
        if (fabs(out) <= 0.1 * base->width || find(d, c->id_a) == d->n || !c->id_b ||
            find(d, c->id_b) == d->n)
            continue;
        const double lx = copysign(1.0, out) * (c->x - c->x_b), ly = c->y - c->y_b, l2 = lx * lx + ly * ly,
                     weight[2] = {1.0, c->normal_force};
        for (int k = 0; k < 2; k++) {
            cos2[k] += weight[k] * (lx * lx - ly * ly) / l2;
            sin2[k] += weight[k] * 2.0 * lx * ly / l2;
            weights[k] += weight[k];
        }
    }
    drop_values *const v = d->v;
    v->fabric = hypot(cos2[0], sin2[0]) / weights[0];
    v->force_fabric = hypot(cos2[1], sin2[1]) / weights[1];
    /* turned by 90 degrees: from the vertical */
    v->fabric_deg = degrees(0.5 * atan2(-sin2[0], -cos2[0]));
    v->force_deg = degrees(0.5 * atan2(-sin2[1], -cos2[1]));
}

/* What a contact puts on the base: position and radius of the disk, load, force to the right. */
typedef struct {
    double x, r, N, H;
} base_load;

static bool load_of(const drop *d, const dem_contact *c, base_load *load)
{
    if (!c->id_b) {
        *load = (base_load){c->x, c->y - c->y_b + c->overlap, c->normal_force, -c->shear_force};
    } else {
        const bool on_b = c->id_b <= d->n_glued;
        if (!on_b && c->id_a > d->n_glued) return false;
        const double lx = c->x - c->x_b, ly = c->y - c->y_b, l = hypot(lx, ly), sign = on_b ? 1.0 : -1.0;
        load->x = on_b ? c->x : c->x_b;
        load->r = l + c->overlap - 0.5;
        load->N = sign * (c->normal_force * ly - c->shear_force * lx) / l;
        load->H = -sign * (c->normal_force * lx + c->shear_force * ly) / l;
    }
    return fabs(load->x) <= d->p->x_limit;
}

static rp_status measure_base(const drop *d, size_t n_contacts, const dem_contact contacts[])
{
    RP_SCOPE(memory);
    drop_values *const v = d->v;
    double weight = 0.0, load = 0.0, disks = 0.0, outward = 0.0, *x;
    size_t n = 0;
    RP_NEW(&memory, x, 4 * n_contacts);
    double *r = x + n_contacts, *N = r + n_contacts, *H = N + n_contacts;
    for (size_t k = 0; k < n_contacts; k++) {
        base_load on;
        if (!load_of(d, &contacts[k], &on)) continue;
        x[n] = on.x, r[n] = on.r, N[n] = on.N, H[n] = on.H;
        load += N[n++];
    }
    stress_base base;
    RP_TRY(stress_base_profile(n, x, r, N, &base));
    for (size_t i = 0; i < d->n; i++) weight += d->states[i].m;
    for (size_t i = 0; i < n; i++) {
        disks += fabs(x[i] - base.centroid) <= 0.5 * base.width;
        outward += x[i] > base.centroid ? H[i] : -H[i];
    }
    v->base_shear = outward / load;
    measure_fabric(d, n_contacts, contacts, &base);
    v->balance = 1.0 - load / weight;
    v->base_disks = disks;
    v->width = base.width;
    v->centroid = base.centroid;
    v->dip = stress_dip(base.N);
    v->middle = stress_middle(base.N);
    memcpy(v->n, base.N, sizeof base.N);
    return measure_rays(d, &base);
}

static rp_status measure_contacts(const drop *d)
{
    dem_contact *contacts;
    size_t n;
    RP_TRY(dem_contacts(d->sim, &contacts, &n));
    rp_status status = measure_order(d, n, contacts);
    if (!status) status = measure_base(d, n, contacts);
    free(contacts);
    return status;
}

/* From the states, those that rolled away, and the base. */
static void leave_out_away(drop *d)
{
    size_t n = 0;
    for (size_t i = d->n_glued; i < d->n; i++)
        if (!is_away(d, i)) d->states[n++] = d->states[i];
    d->n = n;
}

/* ---- A run ---- */

/* Its status word, of what is measured, and why it is no result. A layer comes first: its disks may roll
 * without end. */
static void conclude(const drop *d)
{
    enum { LEAST_HEIGHT = 2 }; /* d: two rows of disks, the upper ones in gaps, are 1.87 high */
    const drop_values *const v = d->v;
    char drops[110] = "", layer[110] = "";
    const bool pile = v->height >= LEAST_HEIGHT && isfinite(v->left_deg) && isfinite(v->right_deg);
    if (v->capped > 0.0)
        snprintf(drops, sizeof drops,
                 "%.0f of %ld drops left a pile that was not quiet after max_steps = %ld", v->capped, d->p->N,
                 d->p->max_steps);
    if (!pile)
        snprintf(layer, sizeof layer, "%.3g d high, slopes %.3g and %.3g degrees%s", v->height, v->left_deg,
                 v->right_deg, *drops ? "; " : "");
    const char *word = !pile ? "no_pile" : *drops ? "drops_not_quiet" : !d->relaxed ? "not_at_rest" : "ok";
    sweep_conclude(d->result, word, "%s%s", layer, drops);
}

static rp_status make(drop *d, const drop_params *p, unsigned long seed, unsigned long run, sweep_keep *keep,
                      sweep_result *result)
{
    const size_t glued = glue(p, NULL);
    sweep_result_clear(result);
    *d = (drop){.p = p,
                .result = result,
                .v = (void *)result->values,
                .scene = make_scene(p),
                .n_glued = glued,
                .keep = keep};
    RP_TRY(stack(p, seed, run, glued, d));
    const size_t n = d->n + (size_t)p->N;
    d->radii = rp_random_alloc(seed, run, RP_PURPOSE_RADII);
    d->positions = rp_random_alloc(seed, run, RP_PURPOSE_PLACES);
    d->before = calloc(n, sizeof *d->before);
    d->moved = calloc(n, sizeof *d->moved);
    if (!d->radii || !d->positions || !d->before || !d->moved)
        return rp_fail(RP_NO_MEMORY, "drop: out of memory");
    bool all = false; /* the drops are done */
    SWEEP_ENTER(keep, *result);
    sweep_keep_enter_sim(keep, &d->sim);
    SWEEP_ENTER(keep, d->scene.dt);
    SWEEP_ENTER(keep, d->n);
    sweep_keep_enter(keep, d->states, n * sizeof *d->states);
    sweep_keep_enter(keep, d->before, n * sizeof *d->before);
    sweep_keep_enter(keep, d->moved, n * sizeof *d->moved);
    sweep_keep_enter(keep, gsl_rng_state(d->radii), gsl_rng_size(d->radii));
    sweep_keep_enter(keep, gsl_rng_state(d->positions), gsl_rng_size(d->positions));
    SWEEP_ENTER(keep, all);
    rp_status status = keep ? keep->source.status : RP_OK;
    if (!status && !all) status = drop_all(d);
    all = true;
    if (!status) status = relax(d);
    if (!status) leave_out_away(d);
    sweep_keep_leave(keep, 10);
    return status;
}

static rp_status finish(drop *d, rp_status status)
{
    if (status == RP_BROKEN || status == RP_NO_RESULT) {
        sweep_conclude(d->result, status == RP_BROKEN ? "broken" : "no_pile", "%s", rp_message());
        status = RP_OK;
    }
    if (d->radii) gsl_rng_free(d->radii);
    if (d->positions) gsl_rng_free(d->positions);
    dem_free(d->sim);
    free(d->states), free(d->before), free(d->moved);
    return status;
}

static rp_status write_drops(const drop *d, const sweep_tables *tables)
{
    sweep_file f;
    RP_TRY(sweep_table_open(tables, "drops.tsv", &f));
    rp_table_header(f.out, "drop, moved");
    for (long k = 0; k < d->p->N; k++)
        rp_table_row(f.out, 2, (double[]){(double)k + 1.0, (double)d->moved[k]});
    return sweep_table_close(&f, RP_OK);
}

static rp_status run_one(const void *params, unsigned long seed, unsigned long run,
                         const sweep_tables *tables, sweep_result *result)
{
    drop d;
    rp_status status = make(&d, params, seed, run, tables ? tables->keep : NULL, result);
    if (!status) measure_shape(&d);
    if (!status && tables && tables->directory) {
        status = rp_make_directory(tables->directory);
        if (!status) status = sweep_state_write(tables, d.sim, "pile");
        if (!status) status = write_drops(&d, tables);
    }
    if (!status) status = measure_contacts(&d);
    if (!status) conclude(&d);
    return finish(&d, status);
}

/* The time step follows from the rest. */
static rp_status check(const void *params)
{
    const drop_params *p = params;
    if (!p->lattice && p->N < 2)
        return rp_fail(RP_BAD_INPUT, "N = %ld: without a lattice, allowed: at least 2", p->N);
    if (!p->lattice) return RP_OK;
    if (p->radius_width > 0.1)
        return rp_fail(RP_BAD_INPUT, "radius_width = %.17g: of a lattice, allowed: up to 0.1",
                       p->radius_width);
    if (isfinite(p->glued) && p->glued != 1.0)
        return rp_fail(RP_BAD_INPUT, "glued = %.17g: a lattice lies on glued disks 1 d apart", p->glued);
    if (0.5 * (double)p->lattice >= p->x_limit)
        return rp_fail(RP_BAD_INPUT, "lattice = %ld: reaches to x_limit = %.17g", p->lattice, p->x_limit);
    return RP_OK;
}

typedef struct {
    drop_params p;
    XXH3_state_t *hash;
} series;

/* Of all positions and velocities. */
static void hash_states(size_t n, const dem_state states[], char digits[33])
{
    XXH3_state_t *hash = XXH3_createState();
    XXH3_128bits_reset(hash);
    for (const dem_state *s = states; s < states + n; s++)
        XXH3_128bits_update(hash, (double[]){s->x, s->y, s->vx, s->vy}, 4 * sizeof(double));
    rp_hash_digits(XXH3_128bits_digest(hash), digits);
    XXH3_freeState(hash);
}

static rp_status hash_pile(const rp_param *changed, const char *word, void *context)
{
    (void)changed, (void)word;
    const series *all = context;
    drop d;
    sweep_result result;
    char digits[33];
    rp_status status = make(&d, &all->p, 1, 0, NULL, &result);
    if (!status) {
        hash_states(d.n, d.states, digits);
        XXH3_128bits_update(all->hash, digits, sizeof digits);
    }
    rp_status freed = finish(&d, status);
    return status ? status : freed;
}

/* Bits of the disks of small piles of unequal ones, with each law and kind of collision. */
static rp_status fingerprint(char digits[33])
{
    series all = {.hash = XXH3_createState()};
    if (!all.hash) return rp_fail(RP_NO_MEMORY, "fingerprint: out of memory");
    XXH3_128bits_reset(all.hash);
    rp_params_defaults(schema, &all.p);
    all.p.N = 12;
    all.p.radius_width = 0.05;
    rp_status status = hash_pile(NULL, NULL, &all);
    if (!status) status = sweep_each_word(schema, &all.p, hash_pile, &all);
    rp_hash_digits(XXH3_128bits_digest(all.hash), digits);
    XXH3_freeState(all.hash);
    return status;
}

SWEEP_PROTOCOL(drop, schema, drop_params, drop_values, check,
               "a pile of disks dropped one at a time (Liffman, Chan & Hughes 1992, fig 20)");
