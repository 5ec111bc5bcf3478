/* Observables: what expressions may ask of a simulation. What a text does not name is not computed. */
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "experiment/looks.h"

/* ---- regions ---- */

/* On which side of the line through p and q, 1 to its left. */
static int side_of(const double p[2], const double q[2], const double r[2])
{
    const double turn = (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
    return (turn > 0.0) - (turn < 0.0);
}

const char *exp_region_fault(const exp_within *a)
{
    const size_t n = a->n_points;
    for (size_t k = 0; k < (n ? 2 * n : a->circle ? 3 : 4); k++)
        if (isnan(n ? a->points[k] : a->at[k])) return "a number is nan";
    if (a->circle) return a->at[2] > 0.0 ? NULL : "the radius is not positive";
    if (a->at[0] > a->at[1] || a->at[2] > a->at[3]) return "a lower end is above its upper one";
    for (size_t i = 0; i < n; i++)
        for (size_t k = i + 2; k < n - (i == 0); k++) { /* sides without a common corner */
            const double *p = &a->points[2 * i], *q = &a->points[2 * ((i + 1) % n)], *r = &a->points[2 * k],
                         *s = &a->points[2 * ((k + 1) % n)];
            if (side_of(p, q, r) * side_of(p, q, s) < 0 && side_of(r, s, p) * side_of(r, s, q) < 0)
                return "two sides of the polygon cross";
        }
    return NULL;
}

exp_within exp_within_now(exp_run *run, const exp_scope *scope)
{
    exp_within a = {.all = !(scope->sort & EXP_REGION)};
    if (scope->sort & EXP_KIND) a.kinds = run->kinds, a.kind = (uint32_t)scope->kind;
    if (a.all) return a;
    const exp_region *r = &run->plan->regions[scope->index];
    a.circle = r->circle;
    for (int k = 0; k < (r->circle ? 3 : 4); k++) a.at[k] = exp_value(run, &r->at[k]);
    double *points = run->points[scope->index];
    a.points = points, a.n_points = r->n_points;
    if (r->n_points) a.at[0] = a.at[2] = INFINITY, a.at[1] = a.at[3] = -INFINITY;
    for (size_t k = 0; k < 2 * r->n_points; k++) {
        points[k] = exp_value(run, &r->points[k]);
        a.at[2 * (k % 2)] = fmin(a.at[2 * (k % 2)], points[k]);
        a.at[2 * (k % 2) + 1] = fmax(a.at[2 * (k % 2) + 1], points[k]);
    }
    const char *fault = exp_region_fault(&a);
    run->no_region = fault != NULL;
    if (fault && !run->failed)
        exp_conclude(run, "no_region", "region %s, step %ld: %s", r->name, run->at.steps, fault);
    return a;
}

bool exp_is_within(const void *within, uint32_t id, double x, double y)
{
    const exp_within *a = within;
    if (a->kinds && a->kinds[id - 1] != a->kind) return false;
    if (a->all) return true;
    if (!a->circle)
        return x > a->at[0] && x < a->at[1] && y > a->at[2] && y < a->at[3] &&
               (!a->n_points || dem_in_polygon(a->n_points, a->points, x, y));
    const double dx = x - a->at[0], dy = y - a->at[1];
    return dx * dx + dy * dy < a->at[2] * a->at[2];
}

/* The grains that an observable is of, one after the other: those that move, in its region. */
typedef struct {
    exp_run *run;
    const dem_state *all;
    size_t n, i;
    exp_within in;
    dem_state s;  /* its centre in the box's frame */
    bool cut;     /* those that the boundary cuts too */
    double share; /* of its area that counts */
} walk;

static walk walk_over(exp_run *run, const exp_scope *scope)
{
    walk w = {.run = run, .in = exp_within_now(run, scope)};
    w.all = exp_states(run);
    w.n = w.all ? run->n_states : 0;
    return w;
}

static bool next(walk *w)
{
    while (w->i < w->n) {
        w->s = w->all[w->i++];
        dem_box_frame(w->run->sim, &w->s.x, &w->s.y);
        if (w->s.fixed) continue;
        w->share = w->cut ? exp_share_within(&w->in, &w->s) : exp_is_within(&w->in, w->s.id, w->s.x, w->s.y);
        if (w->share > 0.0) return true;
    }
    return false;
}

#define EACH(w) for (walk w = walk_over(run, &use->scope); next(&w);)

/* ---- of grains ---- */

/* Sums over the grains of an observable, and their outermost values. */
typedef struct {
    double n, mass, kinetic;
    double few, x, y, vx, vy; /* share with fewer than two contacts; means by mass */
    double speed2, spin, imbalance, left, right, top;
    double lo, hi; /* x of the outermost centres */
} totals;

/* Present |gravity|: the file's, with its bits, unless a phase has changed it. */
static double gravity_now(const exp_run *run)
{
    double g[2];
    dem_gravity(run->sim, g);
    const double now = sqrt(g[0] * g[0] + g[1] * g[1]);
    return fabs(now - run->plan->g) > 1e-9 * run->plan->g ? now : run->plan->g;
}

static totals totals_of(exp_run *run, const exp_use *use)
{
    totals t = {.left = INFINITY, .right = -INFINITY, .top = -INFINITY, .lo = INFINITY, .hi = -INFINITY};
    const exp_plan *plan = run->plan;
    const double g = gravity_now(run);
    EACH(w)
    {
        const dem_state *s = &w.s;
        const double v2 = s->vx * s->vx + s->vy * s->vy, weight = s->m * g,
                     f = sqrt(s->fx * s->fx + s->fy * s->fy);
        t.n++, t.few += s->contacts < 2, t.mass += s->m;
        t.x += s->m * s->x, t.y += s->m * s->y, t.vx += s->m * s->vx, t.vy += s->m * s->vy;
        t.kinetic +=
            0.5 * s->m * v2 + 0.5 * dem_inertia(plan->scene.def.shape, s->m, s->r) * s->omega * s->omega;
        t.speed2 = fmax(t.speed2, v2), t.spin = fmax(t.spin, fabs(s->omega) * s->r);
        t.imbalance = fmax(t.imbalance, fmax(f / weight, fabs(s->torque) / (weight * s->r)));
        t.left = fmin(t.left, s->x - s->r), t.right = fmax(t.right, s->x + s->r);
        t.top = fmax(t.top, s->y + s->r);
        t.lo = fmin(t.lo, s->x), t.hi = fmax(t.hi, s->x);
    }
    t.few /= t.n, t.x /= t.mass, t.y /= t.mass, t.vx /= t.mass, t.vy /= t.mass;
    if (t.n == 0.0) t.left = t.right = t.top = 0.0;
    return t;
}

/* Mass or area of the grains; of those that the boundary of a region cuts, the share within. */
static double content(exp_run *run, const exp_use *use, bool mass)
{
    double sum = 0.0;
    walk w = walk_over(run, &use->scope);
    for (w.cut = true; next(&w);) sum += w.share * (mass ? w.s.m : M_PI * w.s.r * w.s.r);
    return sum;
}

static dem_rest rest_of(exp_run *run, const exp_use *use)
{
    dem_rest rest = {0};
    const exp_within in = exp_within_now(run, &use->scope);
    if (!run->failed) run->failed = dem_rest_in(run->sim, exp_is_within, &in, &rest);
    if (rest.n == 0) rest.contact_number = NAN;
    return rest;
}

static double mass_taken_out(exp_run *run)
{
    double mass = 0.0;
    const dem_state *s = exp_states(run);
    for (size_t i = 0; s && i < run->n_states; i++) mass += s[i].m;
    return run->at.mass0 + run->at.now.added_mass - mass;
}

static double elastic_energy(const exp_run *run)
{
    dem_energy e;
    dem_energies(run->sim, &e);
    return e.elastic;
}

static double largest_speed(exp_run *run, const exp_use *use)
{
    const exp_within in = exp_within_now(run, &use->scope);
    double x = 1.0, y = 0.0;
    dem_box_frame(run->sim, &x, &y);
    /* without a copy of all grains, for conditions that are looked at in each step */
    if (!in.kinds && !in.circle && !in.n_points && x == 1.0 &&
        (in.all || (isinf(in.at[2]) && isinf(in.at[3]))))
        return dem_largest_speed(run->sim, in.all ? -INFINITY : in.at[0], in.all ? INFINITY : in.at[1]);
    return sqrt(totals_of(run, use).speed2);
}

static double marked(exp_run *run, const exp_use *use)
{
    const exp_within in = exp_within_now(run, &use->scope);
    double n = 0.0;
    for (size_t k = 0; k < run->n_ids; k++)
        n += !isnan(run->marks[2 * k]) &&
             exp_is_within(&in, (uint32_t)k + 1, run->marks[2 * k], run->marks[2 * k + 1]);
    return n;
}

/* How many of the marked of the region are farther than args[0] from their mark and have args[1] contacts or
 * more; those that are gone included. */
static double moved(exp_run *run, const exp_use *use, const double args[])
{
    const exp_within in = exp_within_now(run, &use->scope);
    const dem_state *s = exp_states(run);
    size_t n = 0, there = 0;
    for (size_t i = 0; s && i < run->n_states; i++) {
        const double *mark = &run->marks[2 * (s[i].id - 1)];
        double x = s[i].x, y = s[i].y;
        if (isnan(mark[0]) || !exp_is_within(&in, s[i].id, mark[0], mark[1])) continue;
        there++;
        dem_box_frame(run->sim, &x, &y);
        const double dx = x - mark[0], dy = y - mark[1];
        n += dx * dx + dy * dy > args[0] * args[0] && (use->n_args < 2 || s[i].contacts >= args[1]);
    }
    return (double)n + marked(run, use) - (double)there;
}

/* Columns of width about d, between the ends of a region or of the grains, that hold a centre. */
static double cells(exp_run *run, const exp_use *use)
{
    const exp_within in = exp_within_now(run, &use->scope);
    const totals t = totals_of(run, use);
    const bool ends = !in.all && !in.circle && isfinite(in.at[0]) && isfinite(in.at[1]);
    const double lo = ends ? in.at[0] : t.lo, hi = ends ? in.at[1] : t.hi, width = fmax(hi - lo, DBL_MIN),
                 columns = fmin(fmax(round(width / run->plan->d), 1.0), 1e7);
    double n = 0.0;
    if (t.n == 0.0) return 0.0;
    bool *held = calloc((size_t)columns + 1, sizeof *held);
    if (!held) run->failed = rp_fail(RP_NO_MEMORY, "cells: out of memory");
    EACH(w)
    {
        if (!held || w.s.x < lo || w.s.x > hi) continue;
        bool *cell = &held[(size_t)fmin((w.s.x - lo) / width * columns, columns - 1.0)];
        n += !*cell, *cell = true;
    }
    free(held);
    return n;
}

static double area_now(exp_run *run, const exp_use *use)
{
    const exp_within a = exp_within_now(run, &use->scope);
    double sum = 0.0;
    if (a.circle) return M_PI * a.at[2] * a.at[2];
    if (!a.n_points) return (a.at[1] - a.at[0]) * (a.at[3] - a.at[2]);
    for (size_t k = 0; k < a.n_points; k++) {
        const double *p = &a.points[2 * k], *q = &a.points[2 * ((k + 1) % a.n_points)];
        sum += 0.5 * (p[0] * q[1] - q[0] * p[1]);
    }
    return fabs(sum);
}

/* ---- of contacts ---- */

/* Sums over the contacts of a scope, those with their middle in a region, or with a grain of a kind: branch
 * vector times force, compression positive. */
typedef struct {
    double n, sliding, xx, xy, yy;
} contact_totals;

static contact_totals over_contacts(exp_run *run, const exp_use *use)
{
    contact_totals t = {0};
    size_t n;
    const exp_within in = exp_within_now(run, &use->scope);
    const dem_contact *const all = exp_contacts(run, &n);
    for (const dem_contact *c = all; n && c < all + n; c++) {
        double f[2], x = 0.5 * (c->x + c->x_b), y = 0.5 * (c->y + c->y_b);
        const double lx = c->x - c->x_b, ly = c->y - c->y_b;
        dem_box_frame(run->sim, &x, &y);
        if (!exp_is_within(&in, c->id_a, x, y) && !(in.kinds && c->id_b && exp_is_within(&in, c->id_b, x, y)))
            continue;
        exp_contact_force(c, f);
        const double mu = c->id_b ? exp_laws(run)->mu : dem_wall_now(run->sim, (size_t)c->wall).mu;
        t.n++, t.sliding +=
               mu > 0.0 && c->normal_force > 0.0 && fabs(c->shear_force) >= 0.999 * mu * c->normal_force;
        t.xx += lx * f[0], t.yy += ly * f[1], t.xy += 0.5 * (lx * f[1] + ly * f[0]);
    }
    return t;
}

static double sliding(exp_run *run, const exp_use *use)
{
    const contact_totals t = over_contacts(run, use);
    return t.n > 0.0 ? t.sliding / t.n : NAN;
}

/* Mean normal force of the contacts: what forces are compared with where nothing has a weight. */
static double mean_force(exp_run *run)
{
    size_t n;
    double sum = 0.0;
    const dem_contact *c = exp_contacts(run, &n);
    for (size_t i = 0; i < n; i++) sum += c[i].normal_force;
    return n > 0 ? sum / (double)n : 0.0;
}

/* Looks in a row that found the grains at rest, some steps apart whatever the phase's own looks. */
static bool is_at_rest(exp_run *run, const exp_use *use)
{
    enum { PASSED, LAST, LOOKED };
    const exp_plan *p = run->plan;
    double *c = &run->counters[use->state];
    if (c[LOOKED] == 0.0 || (double)run->at.phase_step - c[LAST] >= (double)p->rest.every) {
        const double f0 = p->g > 0.0 ? p->m * p->g : mean_force(run);
        const dem_rest now = rest_of(run, use);
        const bool quiet =
            f0 > 0.0 && dem_at_rest(&now, p->rest.energy * f0 * p->d, p->rest.force * f0, false);
        c[PASSED] = quiet ? c[PASSED] + 1.0 : 0.0;
        c[LAST] = (double)run->at.phase_step, c[LOOKED] = 1.0;
    }
    return c[PASSED] >= (double)p->rest.looks;
}

/* ---- of walls ---- */

static dem_wall_state wall_now(const exp_run *run, const exp_use *use, size_t k)
{
    return dem_wall_now(run->sim, run->plan->walls[use->scope.index].walls[k]);
}

/* The mean over its length, however it is cut into sides; where one has no end, the point of that. In the
 * box, as places of grains. */
static double wall_place(const exp_run *run, const exp_use *use, int component)
{
    double p[2] = {0.0, 0.0}, length = 0.0;
    for (size_t k = 0; k < run->plan->walls[use->scope.index].n; k++) {
        const dem_wall_state w = wall_now(run, use, k);
        double part = w.ends[1] - w.ends[0], middle = 0.5 * (w.ends[0] + w.ends[1]);
        const bool endless = isinf(part);
        if (endless) p[0] = p[1] = length = middle = 0.0, part = 1.0;
        p[0] += part * (w.point[0] + middle * w.direction[1]);
        p[1] += part * (w.point[1] - middle * w.direction[0]);
        length += part;
        if (endless) break;
    }
    p[0] /= length, p[1] /= length;
    dem_box_frame(run->sim, &p[0], &p[1]);
    return p[component];
}

/* Torque of the grains on it about its pivot. */
static double wall_torque(exp_run *run, const exp_use *use)
{
    const exp_wall *wall = &run->plan->walls[use->scope.index];
    size_t n;
    double sum = 0.0, f[2];
    const dem_contact *c = exp_contacts(run, &n);
    for (size_t i = 0; i < n; i++)
        for (size_t k = 0; k < wall->n && c[i].id_b == 0; k++) {
            if ((size_t)c[i].wall != wall->walls[k]) continue;
            const dem_wall_state w = wall_now(run, use, k);
            exp_contact_force(&c[i], f);
            sum -= (c[i].x_b - w.pivot[0]) * f[1] - (c[i].y_b - w.pivot[1]) * f[0] + c[i].rolling_torque;
        }
    return sum;
}

static double wall_force(exp_run *run, const exp_use *use, int component)
{
    double sum = 0.0;
    for (size_t k = 0; k < run->plan->walls[use->scope.index].n; k++)
        sum += wall_now(run, use, k).force[component];
    return sum;
}

/* What they are of, name, numbers in brackets, type, unit, meaning; value, of run, use and args. */
#define SUM(member) totals_of(run, use).member
/* clang-format off */
#define OBSERVABLES(X) \
    X(OF_RUN, time, 0, 0, RP_X_NUMBER, "s", "time since the start", dem_time(run->sim)) \
    X(OF_RUN, t, 0, 0, RP_X_NUMBER, "s", "time since the phase began", dem_time(run->sim) - run->at.begun + (run->ahead ? 0.5 * exp_laws(run)->dt : 0.0)) \
    X(OF_RUN, step, 0, 0, RP_X_NUMBER, "", "steps since the start", (double)run->at.steps) \
    X(OF_RUN, phase_step, 0, 0, RP_X_NUMBER, "", "steps since the phase began", (double)(run->at.phase_step + run->ahead)) \
    X(OF_RUN, pass, 0, 0, RP_X_NUMBER, "", "number of the block's pass, from 1", (double)run->at.pass) \
    X(OF_RUN, tilt_deg, 0, 0, RP_X_NUMBER, "degree", "turn of gravity against the box so far; positive lowers +x", run->at.now.tilt) \
    X(OF_RUN, out, 0, 0, RP_X_NUMBER, "", "grains taken out so far", (double)(run->at.grains0 + run->at.now.added) - (double)dem_count(run->sim)) \
    X(OF_RUN, out_mass, 0, 0, RP_X_NUMBER, "g", "their mass", mass_taken_out(run)) \
    X(OF_RUN, added, 0, 0, RP_X_NUMBER, "", "grains put in so far", (double)run->at.now.added) \
    X(OF_RUN, touched, 0, 0, RP_X_TRUTH, "", "whether the last that was put in has had a contact at a look", run->at.now.touched) \
    X(OF_RUN, elastic, 0, 0, RP_X_NUMBER, "erg", "elastic energy of all contacts", elastic_energy(run)) \
    X(OF_PART, grains, 0, 0, RP_X_NUMBER, "", "number of grains, those of a region by their centres", SUM(n)) \
    X(OF_PART, mass, 0, 0, RP_X_NUMBER, "g", "their mass; of those that the boundary of a region cuts, the share of their area within", content(run, use, true)) \
    X(OF_PART, whole_mass, 0, 0, RP_X_NUMBER, "g", "mass of the grains, those of a region by their centres", SUM(mass)) \
    X(OF_PART, energy, 0, 0, RP_X_NUMBER, "erg", "mean kinetic energy of a grain, of translation and spin, 0 without grains", rest_of(run, use).kinetic_energy) \
    X(OF_PART, kinetic, 0, 0, RP_X_NUMBER, "erg", "sum of the kinetic energies", SUM(kinetic)) \
    X(OF_PART, speed, 0, 0, RP_X_NUMBER, "cm/s", "largest speed of a centre", largest_speed(run, use)) \
    X(OF_PART, spin, 0, 0, RP_X_NUMBER, "cm/s", "largest speed at a rim by spin", SUM(spin)) \
    X(OF_PART, force, 0, 0, RP_X_NUMBER, "dyn", "largest net force on a grain with a contact", rest_of(run, use).net_force) \
    X(OF_PART, imbalance, 0, 0, RP_X_NUMBER, "", "largest net force on a grain over its weight, or torque over weight times radius; 1 of one that falls freely", SUM(imbalance)) \
    X(OF_PART, contacts, 0, 0, RP_X_NUMBER, "", "mean contacts of a grain", rest_of(run, use).contact_number) \
    X(OF_PART, rattlers, 0, 0, RP_X_NUMBER, "", "share of the grains with fewer than two contacts", SUM(few)) \
    X(OF_PART, x, 0, 0, RP_X_NUMBER, "cm", "centre of mass", SUM(x)) \
    X(OF_PART, y, 0, 0, RP_X_NUMBER, "cm", "centre of mass", SUM(y)) \
    X(OF_PART, vx, 0, 0, RP_X_NUMBER, "cm/s", "its velocity", SUM(vx)) \
    X(OF_PART, vy, 0, 0, RP_X_NUMBER, "cm/s", "its velocity", SUM(vy)) \
    X(OF_PART, height, 0, 0, RP_X_NUMBER, "cm", "highest point of a grain, 0 without grains", SUM(top)) \
    X(OF_PART, left, 0, 0, RP_X_NUMBER, "cm", "leftmost point, 0 without grains", SUM(left)) \
    X(OF_PART, right, 0, 0, RP_X_NUMBER, "cm", "rightmost point, 0 without grains", SUM(right)) \
    X(OF_PART, marked, 0, 0, RP_X_NUMBER, "", "grains whose position is marked, by where that is, taken out since or not", marked(run, use)) \
    X(OF_PART, moved, 1, 2, RP_X_NUMBER, "", "moved(s, k): marked grains farther than s from their mark, with k contacts or more, and those taken out", moved(run, use, args)) \
    X(OF_PART, cells, 0, 0, RP_X_NUMBER, "", "columns of about d that hold a grain", cells(run, use)) \
    X(OF_PART, rest, 0, 0, RP_X_TRUTH, "", "whether the grains are at rest, by several looks in a row", is_at_rest(run, use)) \
    X(OF_PART, sliding, 0, 0, RP_X_NUMBER, "", "share of the contacts that press, have friction, and whose shear force is within 1e-3 of Coulomb's limit; the module limit asks their springs", sliding(run, use)) \
    X(OF_REGION, sxx, 0, 0, RP_X_NUMBER, "dyn/cm", "stress: sum of branch vector times force over area, of contacts whose branch has its middle there; compression positive", over_contacts(run, use).xx / area_now(run, use)) \
    X(OF_REGION, sxy, 0, 0, RP_X_NUMBER, "dyn/cm", "its mixed component, the mean of the two", over_contacts(run, use).xy / area_now(run, use)) \
    X(OF_REGION, syy, 0, 0, RP_X_NUMBER, "dyn/cm", "its component along y", over_contacts(run, use).yy / area_now(run, use)) \
    X(OF_FILLED, fraction, 0, 0, RP_X_NUMBER, "", "area of the grains, also of a kind of them, over that of the region; of those that its boundary cuts, the part within", content(run, use, false) / area_now(run, use)) \
    X(OF_WALL, x, 0, 0, RP_X_NUMBER, "cm", "middle of the wall by its length, nan of one that is gone; of one without an end its point", wall_place(run, use, 0)) \
    X(OF_WALL, y, 0, 0, RP_X_NUMBER, "cm", "middle of the wall by its length, nan of one that is gone; of one without an end its point", wall_place(run, use, 1)) \
    X(OF_WALL, vx, 0, 0, RP_X_NUMBER, "cm/s", "its velocity, in a box that turns 0", wall_now(run, use, 0).velocity[0]) \
    X(OF_WALL, vy, 0, 0, RP_X_NUMBER, "cm/s", "its velocity, in a box that turns 0", wall_now(run, use, 0).velocity[1]) \
    X(OF_WALL, angle, 0, 0, RP_X_NUMBER, "rad", "turned in the box since the start, counter-clockwise", wall_now(run, use, 0).angle) \
    X(OF_WALL, torque, 0, 0, RP_X_NUMBER, "dyn cm", "torque of the grains on it about its pivot", wall_torque(run, use)) \
    X(OF_WALL, fx, 0, 0, RP_X_NUMBER, "dyn", "force of the grains on it, without impulses of hard collisions", wall_force(run, use, 0)) \
    X(OF_WALL, fy, 0, 0, RP_X_NUMBER, "dyn", "force of the grains on it, without impulses of hard collisions", wall_force(run, use, 1)) \
    X(OF_NEW, r, 0, 0, RP_X_NUMBER, "cm", "radius of the grain that is put in", run->grain.r) \
    X(OF_NEW, y, 0, 0, RP_X_NUMBER, "cm", "its centre", run->grain.y) \
    X(OF_NEW, touch, 0, 0, RP_X_NUMBER, "cm", "lowest place above which it meets nothing", run->grain.touch)
/* clang-format on */
#define FUNCTION(of, name, least, most, type, unit, meaning, value)                                          \
    static double of##_##name(exp_run *run, const exp_use *use, const double args[])                         \
    {                                                                                                        \
        return (void)run, (void)use, (void)args, (value);                                                    \
    }
OBSERVABLES(FUNCTION)
#define ROW(of, name, least, most, type, unit, meaning, value)                                               \
    {#name, of, least, most, type, unit, meaning, of##_##name},
const exp_observable exp_observables[] = {OBSERVABLES(ROW){0}};

/* ---- modules ---- */

#define X(name) &exp_module_##name,
const exp_module *const exp_modules[] = {EXP_MODULES(X) NULL};
#undef X

rp_status exp_module_values(exp_run *run, const exp_measure *m, double out[EXP_MODULE_OUTPUTS])
{
    const exp_plan *plan = run->plan;
    const exp_module *module = m->module;
    run->no_region = false;
    exp_scope scope = m->scope;
    if (module->needs & EXP_OF_KIND) scope.sort &= ~(unsigned)EXP_KIND;
    const exp_within in = exp_within_now(run, &scope);
    if (run->no_region) return rp_fail(RP_NO_RESULT, "the region is faulty");
    exp_samples *samples = &run->samples[m - plan->measures];
    exp_view view = {.d = plan->d,
                     .m = plan->m,
                     .kind = (uint32_t)m->scope.kind,
                     .sim = run->sim,
                     .mu = exp_laws(run)->mu,
                     .n_marks = run->marks ? run->n_ids : 0,
                     .marks = run->marks,
                     .lo = {-INFINITY, -INFINITY},
                     .hi = {INFINITY, INFINITY}};
    dem_state *grains;
    RP_SCOPE(memory);
    for (int c = 0; c < 2 && !in.all && !in.circle; c++)
        view.lo[c] = in.at[2 * c], view.hi[c] = in.at[2 * c + 1];
    if ((module->needs & EXP_BOUNDED) &&
        !(isfinite(view.lo[0]) && view.hi[0] > view.lo[0] && isfinite(view.hi[0])))
        return rp_fail(RP_NO_RESULT, "the region goes from x = %g to %g", view.lo[0], view.hi[0]);
    if (module->needs & EXP_ON_WALL)
        view.walls = plan->walls[m->on].walls, view.n_walls = plan->walls[m->on].n;
    if (module->needs & EXP_ON_CONTACTS) view.contacts = exp_contacts(run, &view.n_contacts);
    view.all = exp_states(run), view.n_all = run->n_states;
    if (run->failed) return run->failed;
    RP_NEW(&memory, grains, view.n_all);
    for (walk w = walk_over(run, &scope); next(&w);) grains[view.n++] = w.s;
    view.grains = grains;
    for (size_t i = 0; i < view.n_all; i++) view.mass += view.all[i].fixed ? 0.0 : view.all[i].m;
    for (int k = 0; k < EXP_MODULE_OUTPUTS; k++) out[k] = NAN;
    const rp_status status =
        module->add ? module->add(&view, m->params, samples->sums) : module->evaluate(&view, m->params, out);
    for (int k = 0; k < EXP_MODULE_OUTPUTS; k++) out[k] = isnan(out[k]) ? NAN : out[k];
    samples->taken += !status;
    return status;
}

exp_word exp_observable_at(size_t k)
{
    const exp_observable *o = &exp_observables[k];
    if (o->of == OF_NEW) return (exp_word){0}; /* the last, which `add` alone knows */
    return (exp_word){o->name,
                      o->of & OF_WALL                  ? "WALL."
                      : (o->of & OF_PART) == OF_REGION ? "REGION."
                      : o->of & OF_RUN                 ? "the run"
                                                       : "all, REGION., KIND.",
                      o->unit, o->meaning};
}

/* ---- expressions ---- */

double exp_observe(void *host, int id, const double args[])
{
    exp_run *run = host;
    if (id >= EXP_ID_MEASURE) return run->values[id - EXP_ID_MEASURE];
    const exp_use *use = &run->plan->uses[id];
    run->no_region = false;
    const double value = run->failed ? NAN : use->of->value(run, use, args);
    return run->no_region || isnan(value) ? NAN : value; /* one without a sign, which printf would write */
}

double exp_value(exp_run *run, const exp_expression *e)
{
    if (e->x.known) return e->x.value;
    const rp_x_values values = {run, exp_observe};
    const double value = rp_expression_value(&e->x, &values, &run->counters[e->state]);
    return isnan(value) ? NAN : value;
}

bool exp_true(exp_run *run, const exp_expression *e)
{
    return exp_value(run, e) == 1.0;
}

/* A condition that counts looks, without another one. */
static double show(void *host, int id, const double args[])
{
    const exp_run *run = host;
    const exp_use *use = id < EXP_ID_MEASURE ? &run->plan->uses[id] : NULL;
    return use && use->of->type == RP_X_TRUTH ? run->counters[use->state] : exp_observe(host, id, args);
}

char *exp_operands(rp_arena *arena, const exp_run *run, const exp_expression *e)
{
    return rp_expression_operands(arena, &e->x, &(rp_x_values){(void *)run, show});
}

double exp_number(exp_run *run, const char *key, const exp_expression *e)
{
    const double value = exp_value(run, e);
    if (!isnan(value) || run->failed || run->at.done) return value;
    RP_SCOPE(arena);
    const char *names = exp_operands(&arena, run, e);
    exp_conclude(run, "no_number", "phase %s, step %ld: %s \"%s\" is nan; %s",
                 run->plan->phases[run->at.phase].name, run->at.phase_step, key, e->x.text,
                 names ? names : "");
    return value;
}

bool exp_asks(const exp_plan *plan, const exp_expression *e, const char *observable)
{
    int id;
    for (size_t k = 0; (id = rp_expression_asks(&e->x, k)) >= 0; k++)
        if (id < EXP_ID_MEASURE && (!observable || strcmp(plan->uses[id].of->name, observable) == 0))
            return true;
    return false;
}

bool exp_names(const exp_plan *plan, const char *observable)
{
    for (const exp_use *u = plan->uses; plan->n_uses && u < plan->uses + plan->n_uses; u++)
        if (strcmp(u->of->name, observable) == 0) return true;
    return false;
}
