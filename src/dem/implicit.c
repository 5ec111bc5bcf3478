/* The energy-conserving implicit integrator of Liffman, Chan & Hughes 1992, eq (24), for grains that do not
 * rotate. A step takes the positions x and velocities v of all grains from k to k + 1 by
 *
 *   x(k+1) - x(k) = dt (v(k) + v(k+1))/2,   m (v(k+1) - v(k)) = dt F,
 *
 * where the force of a contact is the quotient of potentials, -(V(r(k+1)) - V(r(k)))/(r(k+1) - r(k)), along
 * (R(k) + R(k+1))/(r(k) + r(k+1)). Its work is the change of V at any dt. The closed form in (24) holds for a
 * contact that lasts throughout the step; here the potential ends with the contact. Everything else acts at
 * the middle of the step: gravity; the dashpot, on the change of the overlap, so that its loss is never
 * negative; viscous slip, limited by the step's normal force; wells of the ground, (30), by the quotient of
 * their potential. A well's depth follows the normal force of the same step: one that follows the velocity at
 * the step's start keeps a pile rattling for ever.
 *
 * The unknowns are the displacements u = x(k+1) - x(k), the roots of m (u - dt v) - dt^2/2 (F(u) + m g).
 * Newton's method takes the symmetric part of F's derivative, without the dependence of slip and wells on the
 * normal force.
 *
 * A step that takes a grain beyond the neighbour list is repeated with a new list. It is refused if a grain
 * moves by more than half the skin. */
#include <float.h>
#include <math.h>
#include <stdlib.h>

#include "dem/ground.h"
#include "dem/integrator.h"
#include "dem/law.h"
#include "dem/ledger.h"
#include "dem/neighbours.h"
#include "dem/sim.h"
#include "dem/step.h"
#include "core/stiffness.h"

/* Force on a grain, of a pair on its first, and minus its derivative by the grain's displacement. */
typedef struct {
    dem_vec force;
    double xx, xy, yy;
} contact;

typedef struct {
    rp_pair ends; /* a < b */
    uint32_t pair;
} bond;

typedef struct {
    dem_vec *u, *force, *residual;
    double *stiffness;   /* of the contacts of each grain: trace */
    double *step, *next; /* Newton's, 2 n */
    size_t n_contacts;   /* pairs of the neighbour list, then its wall slots */
    contact *contact;
    long list; /* number of the neighbour list that all below is of; -1: none */
    bond *bond;
    rp_stiffness *matrix;
    size_t *first, *of; /* contacts of each grain: of[first[i]] to of[first[i + 1] - 1] */
} workspace;

static inline workspace *work(const dem_sim *sim)
{
    return sim->work;
}

static const size_t NOBODY = SIZE_MAX;

static rp_status check(const dem_definition *def)
{
    const dem_implicit_solver *s = &def->implicit;
    if (dem_has_spring(def->tangential))
        return rp_fail(RP_BAD_INPUT, "the integrator implicit has no tangential law spring");
    if (def->box_turn_per_step != 0.0)
        return rp_fail(RP_BAD_INPUT, "the box turns, but the integrator implicit needs walls that stand");
    for (size_t w = 0; w < def->n_walls; w++)
        if (isfinite(def->walls[w].extent[0]) || isfinite(def->walls[w].extent[1]))
            return rp_fail(RP_BAD_INPUT,
                           "wall %zu: extent = [%g, %g]: the integrator implicit needs whole lines", w + 1,
                           def->walls[w].extent[0], def->walls[w].extent[1]);
    rp_status status = RP_OK;
    if (s->solver == DEM_SOLVER_SOR)
        status =
            rp_check_range("implicit: relaxation", s->relaxation, DBL_MIN, nextafter(2.0, 0.0), "(0, 2)");
    if (!status) status = rp_check_range("implicit: tolerance", s->tolerance, 1e-15, 1e-3, "[1e-15, 1e-3]");
    return status ? status
                  : rp_check_range("implicit: max_iterations", (double)s->max_iterations, 1.0, INFINITY,
                                   "[1, inf)");
}

static rp_status no_memory(const dem_sim *sim)
{
    return rp_fail(RP_NO_MEMORY, "implicit integrator for %zu particles: out of memory", sim->grains.n);
}

static rp_status alloc_work(dem_sim *sim)
{
    workspace *m = sim->work = calloc(1, sizeof *m);
    if (!m) return no_memory(sim);
    m->list = -1;
    m->u = malloc(sim->grains.capacity * sizeof *m->u);
    m->force = malloc(sim->grains.capacity * sizeof *m->force);
    m->residual = malloc(sim->grains.capacity * sizeof *m->residual);
    m->stiffness = malloc(sim->grains.capacity * sizeof *m->stiffness);
    m->step = malloc(2 * sim->grains.capacity * sizeof *m->step);
    m->next = malloc(2 * sim->grains.capacity * sizeof *m->next);
    m->first = malloc((sim->grains.capacity + 1) * sizeof *m->first);
    return m->u && m->force && m->residual && m->stiffness && m->step && m->next && m->first ? RP_OK
                                                                                             : no_memory(sim);
}

static void free_work(dem_sim *sim)
{
    workspace *m = work(sim);
    rp_stiffness_free(m->matrix);
    free(m->u), free(m->force), free(m->residual), free(m->stiffness), free(m->step), free(m->next),
        free(m->first);
    free(m->contact), free(m->bond), free(m->of), free(m);
    sim->work = NULL;
}

/* ---- Forces of a step ---------------------------------------------------------------------------------- */

/* dem_law_quotient from or to a gap, where the potential is 0. */
static double end_quotient(dem_normal_law law, double k_n, double before, double after, double *slope)
{
    const double in = fmax(before, after), change = fabs(after - before),
                 force = dem_normal_descriptors[law].potential(k_n, in) / change;
    *slope = (after > 0.0 ? dem_law_elastic(law, k_n, in) - force : force) / change;
    return force;
}

/* Coefficients of a contact. */
typedef struct {
    const dem_material *c;
    double mu, m_eff;
} coefficients;

/* Normal force of the step, and its derivative by the overlap at the end; here and below, its parts too where
 * `p` is not NULL. */
static inline double normal_force(const dem_sim *sim, const coefficients *l, double before, double after,
                                  double *slope, dem_parts *p)
{
    const dem_normal_law law = sim->def.normal;
    const double k_n = l->c->k_n, from = fmax(before, 0.0), to = fmax(after, 0.0), gamma_n = l->c->gamma_n,
                 dt = sim->def.dt;
    double force = before > 0.0 && after > 0.0 ? dem_law_quotient(law, k_n, before, after, slope)
                                               : end_quotient(law, k_n, before, after, slope);
    if (p) p->elastic = force;
    force += dem_law_mean_rate(law, k_n, gamma_n, l->m_eff, from, to) * l->m_eff / dt * (to - from);
    if (after > 0.0) *slope += dem_law_damping_rate(law, k_n, gamma_n, l->m_eff, after) * l->m_eff / dt;
    if (!sim->def.tension && !(force > 0.0)) force = *slope = 0.0;
    if (p) p->damping = force - p->elastic;
    return force;
}

/* Add a force f along the unit vector s, with minus its derivative, `slope`. */
static void add_along(contact *to, dem_vec s, double f, double slope)
{
    to->force += f * s;
    to->xx += slope * s[0] * s[0];
    to->xy += slope * s[0] * s[1];
    to->yy += slope * s[1] * s[1];
}

/* Viscous slip along s, over the part of the step in which they touch; `slip` is its displacement. */
static inline void add_slip(const dem_sim *sim, const coefficients *l, dem_vec s, double slip, double before,
                            double after, double f_n, contact *to, dem_parts *p)
{
    if (!dem_has_friction(sim->def.tangential)) return;
    const double part = before > 0.0 && after > 0.0 ? 1.0 : fmax(before, after) / fabs(after - before);
    const double viscous = part * l->c->gamma_s * l->m_eff / sim->def.dt, cap = l->mu * fmax(f_n, 0.0);
    const bool slides = fabs(viscous * slip) > cap;
    const double force = slides ? -copysign(cap, slip) : -viscous * slip;
    add_along(to, s, force, slides ? 0.0 : viscous);
    if (p) *(slides ? &p->slip : &p->dashpot) = force;
}

static inline contact pair_contact(const dem_sim *sim, size_t k, dem_parts *p)
{
    const size_t i = sim->pairs.i[k], j = sim->pairs.j[k];
    const dem_vec from = sim->grains.motion[i].x - sim->grains.motion[j].x,
                  u = work(sim)->u[i] - work(sim)->u[j];
    const dem_vec to = from + u, sum = from + to;
    const double r = sqrt(dem_dot(from, from)), before = sim->pairs.radii[k] - r;
    contact f = {0};
    /* the change of the distance keeps the overlap's last digits */
    const double r_to = sqrt(dem_dot(to, to)), both = r + r_to, after = before - dem_dot(u, sum) / both;
    if (before <= 0.0 && after <= 0.0) return f;
    const coefficients l = {&sim->def.material, sim->mu, sim->pairs.m_eff[k]};
    double slope;
    const double f_n = normal_force(sim, &l, before, after, &slope, p), turn = f_n / both;
    const dem_vec s = sum / both;
    add_along(&f, s, f_n, slope + turn);
    f.xx -= turn, f.yy -= turn;
    const dem_vec t = dem_clockwise(sum) / sqrt(dem_dot(sum, sum));
    add_slip(sim, &l, t, dem_dot(u, t), before, after, f_n, &f, p);
    if (p) p->n = s, p->s = t;
    return f;
}

/* The well's force, by the quotient of the potential k min(d^2, a^2)/2 between displacements. */
static inline void add_well(const dem_sim *sim, const dem_wall_slot *slot, dem_vec t, double normal,
                            contact *to, dem_parts *p)
{
    const dem_ground *g = &sim->def.ground;
    const double before = dem_ground_displacement(sim, slot), moved = dem_dot(work(sim)->u[slot->grain], t);
    const double k = g->mu_static * fmax(normal, 0.0) / g->a, a = g->a;
    const bool holds = fabs(before + moved) <= a;
    const double pull = holds ? k * (before + 0.5 * moved) : 0.5 * k * (a - before) * (a + before) / moved;
    add_along(to, t, -pull, holds ? 0.5 * k : -pull / moved);
    if (p) p->well = -pull;
}

static inline contact slot_contact(const dem_sim *sim, const dem_wall_slot *at, dem_parts *p)
{
    contact f = {0};
    dem_wall_slot slot = *at;
    dem_vec n, still;
    double before, slope;
    if (!dem_wall_touch(sim, &slot, &n, &before, &still)) return f;
    const size_t i = slot.grain;
    const dem_vec u = work(sim)->u[i], t = dem_clockwise(n);
    const double after = before - dem_dot(u, n);
    if (before <= 0.0 && after <= 0.0) return f;
    const coefficients l = {&sim->def.walls[slot.wall].material, sim->walls.mu[slot.wall],
                            sim->grains.mass[i]};
    const double f_n = normal_force(sim, &l, before, after, &slope, p);
    add_along(&f, n, f_n, slope);
    add_slip(sim, &l, t, dem_dot(u, t), before, after, f_n, &f, p);
    if (slot.well == DEM_WELL_HOLDS && dem_is_ground(sim, &slot)) add_well(sim, &slot, t, f_n, &f, p);
    if (p) p->n = n, p->s = t;
    return f;
}

static contact any_contact(const dem_sim *sim, size_t c)
{
    return c < sim->pairs.n ? pair_contact(sim, c, NULL)
                            : slot_contact(sim, &sim->walls.slot[c - sim->pairs.n], NULL);
}

static dem_parts pair_parts(const dem_sim *sim, size_t k)
{
    dem_parts p = {0};
    pair_contact(sim, k, &p);
    return p;
}

static dem_parts slot_parts(const dem_sim *sim, size_t k)
{
    dem_parts p = {0};
    slot_contact(sim, &sim->walls.slot[k], &p);
    return p;
}

/* ---- Residuals of a step ------------------------------------------------------------------------------- */

/* Residual of grain i under the contacts' force. */
static dem_vec residual_of(const dem_sim *sim, size_t i, dem_vec force)
{
    const double dt = sim->def.dt, m = sim->grains.mass[i];
    if (dem_is_fixed(sim, i)) return (dem_vec){0.0, 0.0};
    return m * (work(sim)->u[i] - dt * sim->grains.motion[i].v - 0.5 * dt * dt * sim->gravity) -
           0.5 * dt * dt * force;
}

/* That as a step of the grain's own, over its radius; `stiffness` is the trace. */
static double own_step(const dem_sim *sim, size_t i, dem_vec residual, double stiffness)
{
    const double dt = sim->def.dt;
    return sqrt(dem_dot(residual, residual)) /
           (sim->grains.radius[i] * (sim->grains.mass[i] + 0.5 * dt * dt * fmax(stiffness, 0.0)));
}

typedef struct {
    double largest; /* step of a grain's own */
    size_t grain;   /* with that */
} lack;

/* A step that is not a number counts as the largest. */
static void note_own_step(lack *l, size_t i, double step)
{
    if (step <= l->largest || isnan(l->largest)) return;
    l->largest = step;
    l->grain = i;
}

/* All contacts, forces and residuals for the displacements u. */
static lack evaluate(dem_sim *sim)
{
    workspace *m = work(sim);
    for (size_t i = 0; i < sim->grains.n; i++) {
        m->force[i] = (dem_vec){0.0, 0.0};
        m->stiffness[i] = 0.0;
    }
    for (size_t c = 0; c < m->n_contacts; c++) {
        const contact f = m->contact[c] = any_contact(sim, c);
        const bool pair = c < sim->pairs.n;
        const size_t i = pair ? sim->pairs.i[c] : sim->walls.slot[c - sim->pairs.n].grain;
        m->force[i] += f.force;
        m->stiffness[i] += f.xx + f.yy;
        if (!pair) continue;
        const size_t j = sim->pairs.j[c];
        m->force[j] -= f.force;
        m->stiffness[j] += f.xx + f.yy;
    }
    lack l = {0};
    for (size_t i = 0; i < sim->grains.n; i++) {
        const dem_vec h = m->residual[i] = residual_of(sim, i, m->force[i]);
        note_own_step(&l, i, own_step(sim, i, h, m->stiffness[i]));
    }
    return l;
}

static rp_status not_solved(dem_sim *sim, const lack *l, long iterations)
{
    return dem_stop(sim, DEM_FAULT_NOT_SOLVED, l->grain,
                    "after %ld %s its own equation still asks for %g of its radius, allowed: %g", iterations,
                    sim->def.implicit.solver == DEM_SOLVER_SOR ? "sweeps" : "factorisations", l->largest,
                    sim->def.implicit.tolerance);
}

/* ---- Direct -------------------------------------------------------------------------------------------- */

static int by_ends(const void *a, const void *b)
{
    const bond *p = a, *q = b;
    if (p->ends.a != q->ends.a) return p->ends.a < q->ends.a ? -1 : 1;
    return (p->ends.b > q->ends.b) - (p->ends.b < q->ends.b);
}

static rp_status make_matrix(dem_sim *sim)
{
    workspace *m = work(sim);
    const size_t n = sim->pairs.n;
    rp_stiffness_free(m->matrix);
    m->matrix = NULL;
    rp_pair *ends = malloc((n + 1) * sizeof *ends);
    free(m->bond);
    m->bond = malloc((n + 1) * sizeof *m->bond);
    if (!ends || !m->bond) {
        free(ends);
        return no_memory(sim);
    }
    for (uint32_t k = 0; k < n; k++) {
        const uint32_t i = sim->pairs.i[k], j = sim->pairs.j[k];
        m->bond[k] = (bond){{i < j ? i : j, i < j ? j : i}, k};
    }
    qsort(m->bond, n, sizeof *m->bond, by_ends);
    for (size_t k = 0; k < n; k++) ends[k] = m->bond[k].ends;
    rp_status status = rp_stiffness_create(sim->grains.n, n, ends, &m->matrix);
    free(ends);
    return status;
}

static void assemble(dem_sim *sim)
{
    workspace *m = work(sim);
    const double c = 0.5 * sim->def.dt * sim->def.dt;
    rp_stiffness_clear(m->matrix, 0.0);
    for (size_t i = 0; i < sim->grains.n; i++) {
        const double mass =
            dem_is_fixed(sim, i) ? 1e30 * sim->grains.mass[i] : sim->grains.mass[i]; /* as good as infinite */
        rp_stiffness_add_site(m->matrix, i, mass, 0.0, mass);
    }
    for (size_t k = 0; k < sim->pairs.n; k++) {
        const contact *f = &m->contact[m->bond[k].pair];
        rp_stiffness_add_bond(m->matrix, k, m->bond[k].ends, c * f->xx, c * f->xy, c * f->yy);
    }
    for (size_t s = 0; s < sim->walls.n_slots; s++) {
        const contact *f = &m->contact[sim->pairs.n + s];
        rp_stiffness_add_site(m->matrix, sim->walls.slot[s].grain, c * f->xx, c * f->xy, c * f->yy);
    }
}

/* The step that the last factorisation makes of the residuals: 2 n; *size is the sum of its squares, *far the
 * largest of a grain. */
static rp_status newton_step(dem_sim *sim, double *step, double *size, double *far)
{
    workspace *m = work(sim);
    for (size_t i = 0; i < sim->grains.n; i++)
        for (size_t a = 0; a < 2; a++) step[2 * i + a] = m->residual[i][a];
    rp_status status = rp_stiffness_solve(m->matrix, step, step);
    *size = *far = 0.0;
    for (size_t i = 0; i < sim->grains.n && !status; i++) {
        const double square = step[2 * i] * step[2 * i] + step[2 * i + 1] * step[2 * i + 1];
        *size += square;
        *far = fmax(*far, sqrt(square));
    }
    return status;
}

/* Take a part of m->step. */
static lack go(dem_sim *sim, double part)
{
    workspace *m = work(sim);
    for (size_t i = 0; i < sim->grains.n; i++)
        if (!dem_is_fixed(sim, i)) m->u[i] -= part * (dem_vec){m->step[2 * i], m->step[2 * i + 1]};
    return evaluate(sim);
}

/* Take Newton's step, or half of it, a quarter, ..., until the next step by the same matrix is shorter.
 * Residuals cannot decide this: the stiffest contacts dominate them. No grain moves by more than half the
 * skin, beyond which the step is refused. A last step by the same matrix removes the remainder below the
 * tolerance, which has the same sign in every impact and would add up. */
static rp_status improve(dem_sim *sim, lack *l)
{
    double before, after, far, unused, gone = 0.0;
    rp_status status = newton_step(sim, work(sim)->step, &before, &far);
    const double most = fmin(1.0, 0.5 * sim->list.skin / far);
    for (double part = most; part > 0.05 * most && !status; part *= 0.5) {
        *l = go(sim, part - gone);
        gone = part;
        if (l->largest <= sim->def.implicit.tolerance) {
            status = newton_step(sim, work(sim)->step, &after, &unused);
            go(sim, 1.0);
            break;
        }
        status = newton_step(sim, work(sim)->next, &after, &unused);
        if (after < before) break;
    }
    return status;
}

static rp_status solve_direct(dem_sim *sim)
{
    const dem_implicit_solver *how = &sim->def.implicit;
    lack l = evaluate(sim);
    for (long k = 0; !(l.largest <= how->tolerance); k++) {
        rp_pivots pivots;
        if (k == how->max_iterations || !isfinite(l.largest)) return not_solved(sim, &l, k);
        assemble(sim);
        rp_status status = rp_stiffness_factorise(work(sim)->matrix, &pivots);
        if (!status && pivots.smallest == 0.0) return not_solved(sim, &l, k);
        if (!status) status = improve(sim, &l);
        if (status) return status;
        sim->count.iterations++;
    }
    return RP_OK;
}

/* ---- Sweeps -------------------------------------------------------------------------------------------- */

static rp_status make_contacts_of(dem_sim *sim)
{
    workspace *m = work(sim);
    free(m->of);
    m->of = malloc((2 * m->n_contacts + 1) * sizeof *m->of);
    if (!m->of) return no_memory(sim);
    for (size_t i = 0; i <= sim->grains.n; i++) m->first[i] = 0;
    for (int pass = 0; pass < 2; pass++) {
        for (size_t c = 0; c < m->n_contacts; c++) {
            const bool pair = c < sim->pairs.n;
            const size_t i = pair ? sim->pairs.i[c] : sim->walls.slot[c - sim->pairs.n].grain;
            const size_t ends[2] = {i, pair ? sim->pairs.j[c] : NOBODY};
            for (int e = 0; e < 2 && ends[e] != NOBODY; e++)
                if (pass == 0)
                    m->first[ends[e] + 1]++;
                else
                    m->of[m->first[ends[e]]++] = c;
        }
        for (size_t i = 0; i < sim->grains.n && pass == 0; i++) m->first[i + 1] += m->first[i];
    }
    for (size_t i = sim->grains.n; i > 0; i--) m->first[i] = m->first[i - 1];
    m->first[0] = 0;
    return RP_OK;
}

/* Newton's step of grain i while all others stay, or the part of it that is taken. */
static void relax(dem_sim *sim, size_t i, lack *l)
{
    workspace *m = work(sim);
    const double c = 0.5 * sim->def.dt * sim->def.dt;
    contact sum = {0};
    for (size_t k = m->first[i]; k < m->first[i + 1]; k++) {
        const size_t at = m->of[k];
        const contact f = any_contact(sim, at);
        const bool second = at < sim->pairs.n && sim->pairs.j[at] == i;
        sum.force += second ? -f.force : f.force;
        sum.xx += f.xx, sum.xy += f.xy, sum.yy += f.yy;
    }
    const dem_vec h = residual_of(sim, i, sum.force);
    note_own_step(l, i, own_step(sim, i, h, sum.xx + sum.yy));
    const double xx = sim->grains.mass[i] + c * sum.xx, xy = c * sum.xy,
                 yy = sim->grains.mass[i] + c * sum.yy;
    const dem_vec step = (dem_vec){yy * h[0] - xy * h[1], xx * h[1] - xy * h[0]} / (xx * yy - xy * xy);
    m->u[i] -= sim->def.implicit.relaxation * step;
}

static rp_status solve_sor(dem_sim *sim)
{
    const dem_implicit_solver *how = &sim->def.implicit;
    lack l = evaluate(sim);
    for (long k = 0; !(l.largest <= how->tolerance); k++) {
        if (k == how->max_iterations || !isfinite(l.largest)) return not_solved(sim, &l, k);
        l = (lack){0};
        for (size_t i = 0; i < sim->grains.n; i++)
            if (!dem_is_fixed(sim, i)) relax(sim, i, &l);
        sim->count.iterations++;
        if (l.largest <= how->tolerance) l = evaluate(sim);
    }
    return RP_OK;
}

/* ---- A step -------------------------------------------------------------------------------------------- */

/* Bring what depends on the neighbour list up to date. */
static rp_status prepare(dem_sim *sim)
{
    workspace *m = work(sim);
    if (m->list == sim->count.rebuilds) return RP_OK;
    m->n_contacts = sim->pairs.n + sim->walls.n_slots;
    free(m->contact);
    m->contact = malloc((m->n_contacts + 1) * sizeof *m->contact);
    if (!m->contact) return no_memory(sim);
    rp_status status = sim->def.implicit.solver == DEM_SOLVER_SOR ? make_contacts_of(sim) : make_matrix(sim);
    if (!status) m->list = sim->count.rebuilds;
    return status;
}

static rp_status solve(dem_sim *sim)
{
    workspace *m = work(sim);
    const double dt = sim->def.dt;
    rp_status status = prepare(sim);
    if (status) return status;
    for (size_t i = 0; i < sim->grains.n; i++)
        m->u[i] = dem_is_fixed(sim, i) ? (dem_vec){0.0, 0.0}
                                       : dt * sim->grains.motion[i].v + 0.5 * dt * dt * sim->gravity;
    return sim->def.implicit.solver == DEM_SOLVER_SOR ? solve_sor(sim) : solve_direct(sim);
}

/* A grain that the step takes farther than half the skin from its listed position, or NOBODY. */
static size_t beyond_list(const dem_sim *sim)
{
    for (size_t i = 0; i < sim->grains.n; i++) {
        const dem_vec moved = sim->grains.motion[i].x + work(sim)->u[i] - sim->grains.listed_x[i];
        if (!(dem_dot(moved, moved) <= 0.25 * sim->list.skin * sim->list.skin)) return i;
    }
    return NOBODY;
}

/* A grain that left makes the list be rebuilt: the solver's contacts are in its order. */
static rp_status move_grains(dem_sim *sim, unsigned *left)
{
    const workspace *m = work(sim);
    const double dt = sim->def.dt;
    rp_status status = sim->ledger ? dem_ledger_between(sim, m->force) : RP_OK;
    if (status) return status;
    for (size_t i = 0; i < sim->grains.n; i++) {
        *dem_force(sim, i) = (dem_vec){0.0, 0.0};
        if (dem_is_fixed(sim, i)) continue;
        /* from the forces, which cancel in sum: momentum is kept whatever the solver left */
        sim->grains.motion[i].v += dt * (sim->grains.inverse_mass[i] * m->force[i] + sim->gravity);
        sim->grains.motion[i].x += m->u[i];
        if (dem_beyond(sim, sim->grains.motion[i].x)) *left = DEM_LIST_OUT;
    }
    sim->count.grain_steps += (double)sim->grains.n;
    return RP_OK;
}

static rp_status step(dem_sim *sim, bool last)
{
    (void)last;
    unsigned left = 0;
    rp_status status = solve(sim);
    if (!status && beyond_list(sim) != NOBODY) {
        status = dem_neighbours_rebuild(sim);
        if (!status) status = solve(sim);
        const size_t i = status ? NOBODY : beyond_list(sim);
        if (i != NOBODY)
            return dem_stop(sim, DEM_FAULT_TOO_FAST, i, "moves %g in one step, half the skin is %g",
                            sqrt(dem_dot(work(sim)->u[i], work(sim)->u[i])), 0.5 * sim->list.skin);
    }
    if (!status) status = move_grains(sim, &left);
    if (!status) status = dem_step_lists(sim, left);
    return status ? status : dem_step_forces(sim);
}

const dem_scheme dem_scheme_implicit = {
    .name = "implicit",
    .order = {2, 2},
    .even_margins = true,
    .check = check,
    .alloc = alloc_work,
    .free = free_work,
    .step = step,
    .pair_parts = pair_parts,
    .slot_parts = slot_parts,
};
