/* Observables: what expressions may ask of a simulation. What a text does not name is not computed. */
#include <float.h>
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include "experiment/private.h"

/* ---- regions ---- */

exp_within exp_within_now(exp_run *run, const exp_scope *scope)
{
    exp_within a = {.all = scope->kind != EXP_REGION};
    if (scope->kind == EXP_KIND) a.kinds = run->kinds, a.kind = (int32_t)scope->index;
    if (a.all) return a;
    const exp_region *r = &run->plan->regions[scope->index];
    a.circle = r->circle;
    const exp_expression *const box[4] = {&r->x[0], &r->x[1], &r->y[0], &r->y[1]};
    for (int k = 0; k < (r->circle ? 3 : 4); k++)
        a.at[k] = exp_value(run, r->circle ? &r->circle_of[k] : box[k]);
    if (r->n_points == 0) return a;
    double *points = run->points[scope->index];
    a.points = points, a.n_points = r->n_points;
    a.at[0] = a.at[2] = INFINITY, a.at[1] = a.at[3] = -INFINITY;
    for (size_t k = 0; k < 2 * r->n_points; k++) {
        points[k] = exp_value(run, &r->points[k]);
        a.at[2 * (k % 2)] = fmin(a.at[2 * (k % 2)], points[k]);
        a.at[2 * (k % 2) + 1] = fmax(a.at[2 * (k % 2) + 1], points[k]);
    }
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

static double area_of(const exp_within *a)
{
    double sum = 0.0;
    if (a->circle) return M_PI * a->at[2] * a->at[2];
    if (!a->n_points) return (a->at[1] - a->at[0]) * (a->at[3] - a->at[2]);
    for (size_t k = 0; k < a->n_points; k++) {
        const double *p = &a->points[2 * k], *q = &a->points[2 * ((k + 1) % a->n_points)];
        sum += 0.5 * (p[0] * q[1] - q[0] * p[1]);
    }
    return fabs(sum);
}

/* The grains that an observable is of, one after the other: those that move, in its region. */
typedef struct {
    exp_run *run;
    const dem_state *all;
    size_t n, i;
    exp_within in;
    dem_state s; /* its centre in the box's frame */
} walk;

static walk walk_over(exp_run *run, const exp_use *use)
{
    walk w = {.run = run, .in = exp_within_now(run, &use->scope)};
    w.all = exp_states(run);
    w.n = w.all ? run->n_states : 0;
    return w;
}

static bool next(walk *w)
{
    while (w->i < w->n) {
        w->s = w->all[w->i++];
        dem_box_frame(w->run->sim, &w->s.x, &w->s.y);
        if (!w->s.fixed && exp_is_within(&w->in, w->s.id, w->s.x, w->s.y)) return true;
    }
    return false;
}

#define EACH(w) for (walk w = walk_over(run, use); next(&w);)
#define OBSERVABLE(name)                                                                                     \
    static double name(exp_run *run, const exp_use *use, const double args[]) /* NOLINT */
#define NO_ARGS (void)use, (void)args

/* ---- of the run ---- */

OBSERVABLE(run_time)
{
    return NO_ARGS, dem_time(run->sim);
}
OBSERVABLE(run_t)
{
    return NO_ARGS, dem_time(run->sim) - run->at.begun + (run->ahead ? 0.5 * exp_dt(run) : 0.0);
}
OBSERVABLE(run_step)
{
    return NO_ARGS, (double)run->at.steps;
}
OBSERVABLE(run_phase_step)
{
    return NO_ARGS, (double)(run->at.phase_step + run->ahead);
}
OBSERVABLE(run_pass)
{
    return NO_ARGS, (double)run->at.pass;
}
OBSERVABLE(run_tilt)
{
    return NO_ARGS, run->at.now.tilt;
}
OBSERVABLE(run_out)
{
    return NO_ARGS, (double)(run->at.grains0 + run->at.now.added) - (double)dem_count(run->sim);
}

OBSERVABLE(run_out_mass)
{
    double mass = 0.0;
    NO_ARGS;
    const dem_state *s = exp_states(run);
    for (size_t i = 0; s && i < run->n_states; i++) mass += s[i].m;
    return run->at.mass0 + run->at.now.added_mass - mass;
}

OBSERVABLE(run_added)
{
    return NO_ARGS, (double)run->at.now.added;
}
OBSERVABLE(run_touched)
{
    return NO_ARGS, run->at.now.touched;
}

/* ---- of grains ---- */

OBSERVABLE(grains)
{
    double n = 0.0;
    (void)args;
    EACH(w) n++;
    return n;
}

OBSERVABLE(mass)
{
    double sum = 0.0;
    (void)args;
    EACH(w) sum += w.s.m;
    return sum;
}

static double kinetic_of(const exp_run *run, const dem_state *s)
{
    return 0.5 * s->m * (s->vx * s->vx + s->vy * s->vy) +
           0.5 * dem_inertia(run->plan->scene.def.shape, s->m, s->r) * s->omega * s->omega;
}

OBSERVABLE(kinetic)
{
    double sum = 0.0;
    (void)args;
    EACH(w) sum += kinetic_of(run, &w.s);
    return sum;
}

OBSERVABLE(energy)
{
    dem_rest rest = {0};
    const exp_within in = exp_within_now(run, &use->scope);
    (void)args;
    if (!run->failed) run->failed = dem_rest_in(run->sim, exp_is_within, &in, &rest);
    return rest.kinetic_energy;
}

OBSERVABLE(force)
{
    dem_rest rest = {0};
    const exp_within in = exp_within_now(run, &use->scope);
    (void)args;
    if (!run->failed) run->failed = dem_rest_in(run->sim, exp_is_within, &in, &rest);
    return rest.net_force;
}

OBSERVABLE(rattlers)
{
    double n = 0.0, all = 0.0;
    (void)args;
    EACH(w) all++, n += w.s.contacts < 2;
    return n / all;
}
OBSERVABLE(contacts)
{
    dem_rest rest = {0};
    const exp_within in = exp_within_now(run, &use->scope);
    (void)args;
    if (!run->failed) run->failed = dem_rest_in(run->sim, exp_is_within, &in, &rest);
    return rest.n ? rest.contact_number : NAN;
}

OBSERVABLE(elastic)
{
    dem_energy e;
    NO_ARGS;
    dem_energies(run->sim, &e);
    return e.elastic;
}

OBSERVABLE(speed)
{
    const exp_within in = exp_within_now(run, &use->scope);
    double most = 0.0, x = 1.0, y = 0.0;
    (void)args;
    dem_box_frame(run->sim, &x, &y);
    /* without a copy of all grains, for conditions that are looked at in each step */
    if (!in.kinds && !in.circle && !in.n_points && x == 1.0 && (in.all || isinf(in.at[3] - in.at[2])))
        return dem_largest_speed(run->sim, in.all ? -INFINITY : in.at[0], in.all ? INFINITY : in.at[1]);
    EACH(w) most = fmax(most, w.s.vx * w.s.vx + w.s.vy * w.s.vy);
    return sqrt(most);
}

OBSERVABLE(spin)
{
    double most = 0.0;
    (void)args;
    EACH(w) most = fmax(most, fabs(w.s.omega) * w.s.r);
    return most;
}

OBSERVABLE(imbalance)
{
    double most = 0.0;
    (void)args;
    EACH(w)
    {
        const double weight = w.s.m * run->plan->g, f = sqrt(w.s.fx * w.s.fx + w.s.fy * w.s.fy);
        most = fmax(most, fmax(f / weight, fabs(w.s.torque) / (weight * w.s.r)));
    }
    return most;
}

/* Means by mass of x, y, vx, vy. */
static double mean_of(exp_run *run, const exp_use *use, size_t offset)
{
    double sum = 0.0, weight = 0.0;
    EACH(w) sum += w.s.m * *(const double *)((const char *)&w.s + offset), weight += w.s.m;
    return sum / weight;
}
OBSERVABLE(mean_x)
{
    return (void)args, mean_of(run, use, offsetof(dem_state, x));
}
OBSERVABLE(mean_y)
{
    return (void)args, mean_of(run, use, offsetof(dem_state, y));
}
OBSERVABLE(mean_vx)
{
    return (void)args, mean_of(run, use, offsetof(dem_state, vx));
}
OBSERVABLE(mean_vy)
{
    return (void)args, mean_of(run, use, offsetof(dem_state, vy));
}

/* The outermost point to one side; without grains 0. */
static double outermost(exp_run *run, const exp_use *use, double x, double y)
{
    double most = -INFINITY;
    EACH(w) most = fmax(most, x * w.s.x + y * w.s.y + w.s.r);
    return isinf(most) ? 0.0 : most;
}
OBSERVABLE(height)
{
    return (void)args, outermost(run, use, 0.0, 1.0);
}
OBSERVABLE(left)
{
    return (void)args, -outermost(run, use, -1.0, 0.0);
}
OBSERVABLE(right)
{
    return (void)args, outermost(run, use, 1.0, 0.0);
}

OBSERVABLE(marked)
{
    const exp_within in = exp_within_now(run, &use->scope);
    double n = 0.0;
    (void)args;
    for (size_t k = 0; k < run->n_ids; k++)
        n += !isnan(run->marks[2 * k]) &&
             exp_is_within(&in, (uint32_t)k + 1, run->marks[2 * k], run->marks[2 * k + 1]);
    return n;
}

/* How many of the marked of the region are farther than args[0] from their mark and have args[1] contacts or
 * more; those that are gone included. */
OBSERVABLE(moved)
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
    return (double)n + marked(run, use, args) - (double)there;
}

/* Columns of width about d, between the ends of a region or of the grains, that hold a centre. */
OBSERVABLE(cells)
{
    (void)args;
    exp_within in = exp_within_now(run, &use->scope);
    double lo = INFINITY, hi = -INFINITY, n = 0.0;
    EACH(w) lo = fmin(lo, w.s.x), hi = fmax(hi, w.s.x);
    if (!(hi >= lo)) return 0.0;
    if (!in.all && !in.circle && isfinite(in.at[0]) && isfinite(in.at[1])) lo = in.at[0], hi = in.at[1];
    const double width = fmax(hi - lo, DBL_MIN), columns = fmin(fmax(round(width / run->plan->d), 1.0), 1e7);
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

/* Area of the grains by centre over the region's own. */
OBSERVABLE(fraction)
{
    const exp_within in = exp_within_now(run, &use->scope);
    double sum = 0.0;
    (void)args;
    EACH(w) sum += M_PI * w.s.r * w.s.r;
    return sum / area_of(&in);
}

/* Sum over the contacts of a scope of what each adds: those with their middle in a region, or with a grain of
 * a kind. */
static double over_contacts(exp_run *run, const exp_use *use,
                            double (*part)(const exp_run *run, const dem_contact *c, const double f[2]),
                            double *n)
{
    dem_contact *c = NULL;
    size_t n_contacts = 0;
    double sum = 0.0;
    const exp_within in = exp_within_now(run, &use->scope);
    if (!run->failed) run->failed = dem_contacts(run->sim, &c, &n_contacts);
    *n = 0.0;
    for (size_t k = 0; k < n_contacts; k++) {
        double f[2], x = 0.5 * (c[k].x + c[k].x_b), y = 0.5 * (c[k].y + c[k].y_b);
        dem_box_frame(run->sim, &x, &y);
        if (!exp_is_within(&in, c[k].id_a, x, y) &&
            !(in.kinds && c[k].id_b && exp_is_within(&in, c[k].id_b, x, y)))
            continue;
        (*n)++;
        exp_contact_force(&c[k], f);
        sum += part(run, &c[k], f);
    }
    free(c);
    return sum;
}

static const dem_physics *physics_now(const exp_run *run)
{
    const size_t laws = run->at.now.laws;
    return &(laws == SIZE_MAX ? &run->plan->scene.laws : &run->plan->phases[laws].laws)->physics;
}

static double slides(const exp_run *run, const dem_contact *c, const double f[2])
{
    const double mu = c->id_b ? physics_now(run)->mu : dem_wall_now(run->sim, (size_t)c->wall).mu;
    (void)f;
    return c->normal_force > 0.0 && fabs(c->shear_force) >= 0.999 * mu * c->normal_force;
}

OBSERVABLE(sliding)
{
    double n;
    (void)args;
    const double sum = over_contacts(run, use, slides, &n);
    return n > 0.0 ? sum / n : NAN;
}

/* Branch vector times force, compression positive. */
static double part_xx(const exp_run *run, const dem_contact *c, const double f[2])
{
    return (void)run, (c->x - c->x_b) * f[0];
}
static double part_yy(const exp_run *run, const dem_contact *c, const double f[2])
{
    return (void)run, (c->y - c->y_b) * f[1];
}
static double part_xy(const exp_run *run, const dem_contact *c, const double f[2])
{
    return (void)run, 0.5 * ((c->x - c->x_b) * f[1] + (c->y - c->y_b) * f[0]);
}
OBSERVABLE(stress_xx)
{
    double n;
    const exp_within in = exp_within_now(run, &use->scope);
    return (void)args, over_contacts(run, use, part_xx, &n) / area_of(&in);
}
OBSERVABLE(stress_yy)
{
    double n;
    const exp_within in = exp_within_now(run, &use->scope);
    return (void)args, over_contacts(run, use, part_yy, &n) / area_of(&in);
}
OBSERVABLE(stress_xy)
{
    double n;
    const exp_within in = exp_within_now(run, &use->scope);
    return (void)args, over_contacts(run, use, part_xy, &n) / area_of(&in);
}

/* Mean normal force of the contacts: what forces are compared with where nothing has a weight. */
static double mean_force(exp_run *run)
{
    dem_contact *c = NULL;
    size_t n = 0;
    double sum = 0.0;
    if (!run->failed) run->failed = dem_contacts(run->sim, &c, &n);
    for (size_t i = 0; i < n; i++) sum += c[i].normal_force;
    free(c);
    return n > 0 ? sum / (double)n : 0.0;
}

/* Looks in a row that found the grains at rest, some steps apart whatever the phase's own looks. */
OBSERVABLE(rest)
{
    enum { PASSED, LAST, LOOKED };
    const exp_plan *p = run->plan;
    double *c = &run->counters[use->state];
    (void)args;
    if (c[LOOKED] != 0.0 && (double)run->at.phase_step - c[LAST] < (double)p->rest.every)
        return c[PASSED] >= (double)p->rest.looks;
    const exp_within in = exp_within_now(run, &use->scope);
    const double f0 = p->g > 0.0 ? p->m * p->g : mean_force(run);
    dem_rest now = {0};
    if (!run->failed) run->failed = dem_rest_in(run->sim, exp_is_within, &in, &now);
    const bool quiet = f0 > 0.0 && dem_at_rest(&now, p->rest.energy * f0 * p->d, p->rest.force * f0, false);
    c[PASSED] = quiet ? c[PASSED] + 1.0 : 0.0;
    c[LAST] = (double)run->at.phase_step, c[LOOKED] = 1.0;
    return c[PASSED] >= (double)p->rest.looks;
}

/* ---- of walls ---- */

static dem_wall_state wall_now(const exp_run *run, const exp_use *use, size_t k)
{
    return dem_wall_now(run->sim, run->plan->walls[use->scope.index].walls[k]);
}

/* Its pivot, which moves along; of a whole line its point. */
static double wall_place(const exp_run *run, const exp_use *use, int component)
{
    const dem_wall_state w = wall_now(run, use, 0);
    return isinf(w.ends[0]) && isinf(w.ends[1]) ? w.point[component] : w.pivot[component];
}
OBSERVABLE(wall_x)
{
    return (void)args, wall_place(run, use, 0);
}
OBSERVABLE(wall_y)
{
    return (void)args, wall_place(run, use, 1);
}
OBSERVABLE(wall_vx)
{
    return (void)args, wall_now(run, use, 0).velocity[0];
}
OBSERVABLE(wall_vy)
{
    return (void)args, wall_now(run, use, 0).velocity[1];
}
OBSERVABLE(wall_angle)
{
    return (void)args, wall_now(run, use, 0).angle;
}

/* Torque of the grains on it about its pivot. */
OBSERVABLE(wall_torque)
{
    const exp_wall *wall = &run->plan->walls[use->scope.index];
    dem_contact *c = NULL;
    size_t n = 0;
    double sum = 0.0;
    (void)args;
    if (!run->failed) run->failed = dem_contacts(run->sim, &c, &n);
    for (size_t i = 0; i < n; i++)
        for (size_t k = 0; k < wall->n && c[i].id_b == 0; k++) {
            if ((size_t)c[i].wall != wall->walls[k]) continue;
            const dem_wall_state w = wall_now(run, use, k);
            const double dx = c[i].x - c[i].x_b, dy = c[i].y - c[i].y_b, l = sqrt(dx * dx + dy * dy),
                         nx = dx / l, ny = dy / l, fx = c[i].normal_force * nx + c[i].shear_force * ny,
                         fy = c[i].normal_force * ny - c[i].shear_force * nx;
            sum -= (c[i].x_b - w.pivot[0]) * fy - (c[i].y_b - w.pivot[1]) * fx + c[i].rolling_torque;
        }
    free(c);
    return sum;
}

static double wall_force(exp_run *run, const exp_use *use, int component)
{
    double sum = 0.0;
    for (size_t k = 0; k < run->plan->walls[use->scope.index].n; k++)
        sum += wall_now(run, use, k).force[component];
    return sum;
}
OBSERVABLE(wall_fx)
{
    return (void)args, wall_force(run, use, 0);
}
OBSERVABLE(wall_fy)
{
    return (void)args, wall_force(run, use, 1);
}

#define ALL_GRAINS (OF_GRAINS | OF_REGION)
/* clang-format off */
const exp_observable exp_observables[] = {
    {"time", OF_RUN, 0, 0, RP_X_NUMBER, "s", "time since the start", run_time},
    {"t", OF_RUN, 0, 0, RP_X_NUMBER, "s", "time since the phase began", run_t},
    {"step", OF_RUN, 0, 0, RP_X_NUMBER, "", "steps since the start", run_step},
    {"phase_step", OF_RUN, 0, 0, RP_X_NUMBER, "", "steps since the phase began", run_phase_step},
    {"pass", OF_RUN, 0, 0, RP_X_NUMBER, "", "number of the block's pass, from 1", run_pass},
    {"tilt_deg", OF_RUN, 0, 0, RP_X_NUMBER, "degree", "turn of gravity against the box so far; positive lowers +x", run_tilt},
    {"out", OF_RUN, 0, 0, RP_X_NUMBER, "", "grains taken out so far", run_out},
    {"out_mass", OF_RUN, 0, 0, RP_X_NUMBER, "g", "their mass", run_out_mass},
    {"added", OF_RUN, 0, 0, RP_X_NUMBER, "", "grains put in so far", run_added},
    {"touched", OF_RUN, 0, 0, RP_X_TRUTH, "", "whether the last that was put in has had a contact at a look", run_touched},
    {"elastic", OF_RUN, 0, 0, RP_X_NUMBER, "erg", "elastic energy of all contacts", elastic},
    {"grains", ALL_GRAINS, 0, 0, RP_X_NUMBER, "", "number of grains", grains},
    {"mass", ALL_GRAINS, 0, 0, RP_X_NUMBER, "g", "their mass", mass},
    {"energy", ALL_GRAINS, 0, 0, RP_X_NUMBER, "erg", "mean kinetic energy of a grain, of translation and spin", energy},
    {"kinetic", ALL_GRAINS, 0, 0, RP_X_NUMBER, "erg", "sum of the kinetic energies", kinetic},
    {"speed", ALL_GRAINS, 0, 0, RP_X_NUMBER, "cm/s", "largest speed of a centre", speed},
    {"spin", ALL_GRAINS, 0, 0, RP_X_NUMBER, "cm/s", "largest speed at a rim by spin", spin},
    {"force", ALL_GRAINS, 0, 0, RP_X_NUMBER, "dyn", "largest net force on a grain with a contact", force},
    {"imbalance", ALL_GRAINS, 0, 0, RP_X_NUMBER, "", "largest net force on a grain over its weight, or torque over weight times radius; 1 of one that falls freely", imbalance},
    {"contacts", ALL_GRAINS, 0, 0, RP_X_NUMBER, "", "mean contacts of a grain", contacts},
    {"rattlers", ALL_GRAINS, 0, 0, RP_X_NUMBER, "", "share of the grains with fewer than two contacts", rattlers},
    {"x", ALL_GRAINS, 0, 0, RP_X_NUMBER, "cm", "centre of mass", mean_x},
    {"y", ALL_GRAINS, 0, 0, RP_X_NUMBER, "cm", "centre of mass", mean_y},
    {"vx", ALL_GRAINS, 0, 0, RP_X_NUMBER, "cm/s", "its velocity", mean_vx},
    {"vy", ALL_GRAINS, 0, 0, RP_X_NUMBER, "cm/s", "its velocity", mean_vy},
    {"height", ALL_GRAINS, 0, 0, RP_X_NUMBER, "cm", "highest point of a grain, 0 without grains", height},
    {"left", ALL_GRAINS, 0, 0, RP_X_NUMBER, "cm", "leftmost point", left},
    {"right", ALL_GRAINS, 0, 0, RP_X_NUMBER, "cm", "rightmost point", right},
    {"marked", ALL_GRAINS, 0, 0, RP_X_NUMBER, "", "grains whose position is marked, by where that is", marked},
    {"moved", ALL_GRAINS, 1, 2, RP_X_NUMBER, "", "moved(s, k): marked grains farther than s from their mark, with k contacts or more", moved},
    {"cells", ALL_GRAINS, 0, 0, RP_X_NUMBER, "", "columns of about d that hold a grain", cells},
    {"rest", ALL_GRAINS, 0, 0, RP_X_TRUTH, "", "whether the grains are at rest, by several looks in a row", rest},
    {"sliding", ALL_GRAINS, 0, 0, RP_X_NUMBER, "", "share of the contacts whose shear force is at Coulomb's limit", sliding},
    {"sxx", OF_REGION, 0, 0, RP_X_NUMBER, "dyn/cm", "stress: sum of branch vector times force over area, compression positive", stress_xx},
    {"sxy", OF_REGION, 0, 0, RP_X_NUMBER, "dyn/cm", "its mixed component, the mean of the two", stress_xy},
    {"syy", OF_REGION, 0, 0, RP_X_NUMBER, "dyn/cm", "its component along y", stress_yy},
    {"fraction", OF_REGION, 0, 0, RP_X_NUMBER, "", "area of the grains over that of the region", fraction},
    {"x", OF_WALL, 0, 0, RP_X_NUMBER, "cm", "the wall's pivot, of a whole line its point", wall_x},
    {"y", OF_WALL, 0, 0, RP_X_NUMBER, "cm", "the wall's pivot, of a whole line its point", wall_y},
    {"vx", OF_WALL, 0, 0, RP_X_NUMBER, "cm/s", "its velocity", wall_vx},
    {"vy", OF_WALL, 0, 0, RP_X_NUMBER, "cm/s", "its velocity", wall_vy},
    {"angle", OF_WALL, 0, 0, RP_X_NUMBER, "rad", "turned since the start, counter-clockwise", wall_angle},
    {"torque", OF_WALL, 0, 0, RP_X_NUMBER, "dyn cm", "torque of the grains on it about its pivot", wall_torque},
    {"fx", OF_WALL, 0, 0, RP_X_NUMBER, "dyn", "force of the grains on it", wall_fx},
    {"fy", OF_WALL, 0, 0, RP_X_NUMBER, "dyn", "force of the grains on it", wall_fy},
    {0}};
/* clang-format on */

/* ---- modules ---- */

#define X(name) &exp_module_##name,
static const exp_module *const modules[] = {EXP_MODULES(X) NULL};
#undef X

const exp_module *exp_module_find(const char *name, size_t length)
{
    for (const exp_module *const *m = modules; *m; m++)
        if (strlen((*m)->name) == length && strncmp((*m)->name, name, length) == 0) return *m;
    return NULL;
}

exp_group exp_module_at(size_t k)
{
    if (k >= sizeof modules / sizeof *modules - 1) return (exp_group){0};
    return (exp_group){modules[k]->name, modules[k]->schema, modules[k]->about, modules[k]->outputs};
}

rp_status exp_module_values(exp_run *run, const exp_measure *m, double out[EXP_MODULE_OUTPUTS])
{
    const exp_use use = {.scope = m->scope};
    const exp_within in = exp_within_now(run, &m->scope);
    exp_view sample = {.d = run->plan->d,
                       .m = run->plan->m,
                       .sim = run->sim,
                       .mu = physics_now(run)->mu,
                       .n_marks = run->marks ? run->n_ids : 0,
                       .marks = run->marks,
                       .lo = {-INFINITY, -INFINITY},
                       .hi = {INFINITY, INFINITY}};
    for (int c = 0; c < 2 && !in.all && !in.circle; c++)
        sample.lo[c] = in.at[2 * c], sample.hi[c] = in.at[2 * c + 1];
    if (m->module->bounded &&
        !(isfinite(sample.lo[0]) && sample.hi[0] > sample.lo[0] && isfinite(sample.hi[0])))
        return rp_fail(RP_NO_RESULT, "the region goes from x = %g to %g", sample.lo[0], sample.hi[0]);
    if (!(sample.all = exp_states(run))) return run->failed;
    sample.n_all = run->n_states;
    dem_state *grains = malloc((run->n_states + 1) * sizeof *grains);
    if (!grains) return rp_fail(RP_NO_MEMORY, "%s: out of memory", m->name);
    for (walk w = walk_over(run, &use); next(&w);)
        if (exp_is_within(&in, w.s.id, w.s.x, w.s.y)) grains[sample.n++] = w.s;
    for (size_t i = 0; i < run->n_states; i++) sample.mass += run->states[i].fixed ? 0.0 : run->states[i].m;
    for (int k = 0; k < EXP_MODULE_OUTPUTS; k++) out[k] = NAN;
    sample.grains = grains;
    if (m->module->on_wall)
        sample.walls = run->plan->walls[m->on].walls, sample.n_walls = run->plan->walls[m->on].n;
    exp_table *table = &run->tables[m - run->plan->measures];
    dem_contact *contacts = NULL;
    rp_status status = m->module->on_contacts ? dem_contacts(run->sim, &contacts, &sample.n_contacts) : RP_OK;
    sample.contacts = contacts;
    if (!status)
        status = m->module->add ? m->module->add(&sample, m->params, table->sums)
                                : m->module->evaluate(&sample, m->params, out);
    table->samples += !status;
    free(contacts);
    free(grains);
    return status;
}

exp_word exp_observable_at(size_t k)
{
    const exp_observable *o = &exp_observables[k];
    return (exp_word){o->name,
                      o->of & OF_WALL      ? "WALL."
                      : o->of == OF_REGION ? "REGION."
                      : o->of & OF_RUN     ? "the run"
                                           : "all, REGION., KIND.",
                      o->unit, o->meaning};
}

/* ---- expressions ---- */

double exp_observe(void *host, int id, const double args[])
{
    exp_run *run = host;
    if (id >= EXP_ID_MEASURE) return run->values[id - EXP_ID_MEASURE];
    if (id >= EXP_ID_GRAIN) return run->grain[id - EXP_ID_GRAIN];
    const exp_use *use = &run->plan->uses[id];
    return run->failed ? NAN : use->of->value(run, use, args);
}

double exp_value(exp_run *run, const exp_expression *e)
{
    if (e->x.known) return e->x.value;
    const rp_x_values values = {run, exp_observe};
    return rp_expression_value(&e->x, &values, &run->counters[e->state]);
}

bool exp_true(exp_run *run, const exp_expression *e)
{
    return exp_value(run, e) == 1.0;
}

static void ask(void *host, int id)
{
    *(bool *)host |= id < EXP_ID_MEASURE;
}

bool exp_changes(const exp_expression *e)
{
    bool asks = false;
    rp_expression_each(&e->x, ask, &asks);
    return asks;
}
