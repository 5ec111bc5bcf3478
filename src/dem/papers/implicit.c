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
#include <string.h>

#include "sparse/sparse.h"
#include "dem/observe/observe.h"
#include "dem/forces/forces.h"
#include "dem/list/list.h"
#include "dem/methods/methods.h"
#include "dem/state/motion.h"

/* Force on a grain, of a pair on its first, and minus its derivative by the grain's displacement. */
typedef struct {
    dem_vec force;
    double xx, xy, yy;
} contact;

typedef struct {
    rp_pair ends; /* a < b */
    uint32_t pair;
} bond;

/* Follows the neighbour list. Of each grain: displacement u; contact_force; stiffness, the trace of its
 * contacts' sum; residual; newton_step and further_step, by one factorisation. */
typedef struct {
    long list; /* number of the neighbour list that all below is of; 0: none */
    contact *contact;
    bond *bond;
    rp_stiffness *matrix;
    size_t *first, *of; /* contacts of each grain: of[first[i]] to of[first[i + 1] - 1] */
} workspace;

static inline workspace *work(const dem_sim *sim)
{
    return sim->work;
}

static rp_status check(const dem_definition *def)
{
    const dem_implicit_solver *s = &def->implicit;
    if (dem_has_spring(def->tangential))
        return rp_fail(RP_BAD_INPUT, "the integrator implicit has no tangential law %s",
                       dem_tangential_descriptors[def->tangential].name);
    if (def->box_turn_per_step != 0.0)
        return rp_fail(RP_BAD_INPUT, "the box turns, but the integrator implicit needs walls that stand");
    for (size_t w = 0; w < def->n_walls; w++) {
        const dem_wall *wall = &dem_walls_of(def)[w];
        if (!dem_wall_is_line(wall))
            return rp_fail(RP_BAD_INPUT,
                           "wall %zu: extent = [%g, %g]: the integrator implicit needs whole lines", w + 1,
                           wall->extent[0], wall->extent[1]);
        if (dem_wall_moves(wall))
            return rp_fail(RP_BAD_INPUT, "wall %zu moves, but the integrator implicit needs walls that stand",
                           w + 1);
    }
    if (s->solver == DEM_SOLVER_SOR)
        RP_TRY(rp_check_range("implicit: relaxation", s->relaxation, DBL_MIN, nextafter(2.0, 0.0), "(0, 2)"));
    RP_TRY(rp_check_range("implicit: tolerance", s->tolerance, 1e-15, 1e-3, "[1e-15, 1e-3]"));
    return rp_check_range("implicit: max_iterations", (double)s->max_iterations, 1.0, INFINITY, "[1, inf)");
}

static rp_status no_memory(const dem_sim *sim)
{
    return rp_fail(RP_NO_MEMORY, "implicit integrator for %zu particles: out of memory", sim->grains.n);
}

static void free_work(dem_sim *sim)
{
    workspace *m = work(sim);
    rp_stiffness_free(m->matrix);
    free(m->contact), free(m->bond), free(m->first), free(m->of), free(m);
    sim->work = NULL;
}

/* ---- Forces of a step ---------------------------------------------------------------------------------- */

/* The quotient of a law from or to a gap, where the potential is 0. */
static double end_quotient(dem_normal_law normal, double k_n, double before, double after, double *slope)
{
    const double in = fmax(before, after), change = fabs(after - before),
                 force = dem_normal_descriptors[normal].potential(k_n, in) / change;
    *slope = (after > 0.0 ? dem_law_elastic(normal, k_n, in) - force : force) / change;
    return force;
}

/* A contact in the step: its coefficients, overlaps before and after, the normal force; where its parts go,
 * or NULL. */
typedef struct {
    const dem_material *c;
    double k_n, m_eff, before, after, normal;
    dem_parts *parts;
} touch;

/* Normal force of the step, and its derivative by the overlap at the end. */
static inline double normal_force(const dem_sim *sim, const touch *l, double *slope)
{
    const dem_normal_descriptor *law = &dem_normal_descriptors[sim->def.normal];
    const double k_n = l->k_n, gamma_n = l->c->gamma_n, dt = sim->def.dt, before = l->before,
                 after = l->after, from = fmax(before, 0.0), to = fmax(after, 0.0);
    double force = before > 0.0 && after > 0.0 ? law->quotient(k_n, before, after, slope)
                                               : end_quotient(sim->def.normal, k_n, before, after, slope);
    if (l->parts) l->parts->elastic = force;
    force += law->mean_rate(k_n, gamma_n, l->m_eff, from, to) * l->m_eff / dt * (to - from);
    if (after > 0.0) *slope += law->damping_rate(k_n, gamma_n, l->m_eff, after) * l->m_eff / dt;
    if (!sim->def.tension && !(force > 0.0)) force = *slope = 0.0;
    if (l->parts) l->parts->damping = force - l->parts->elastic;
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
static inline void add_slip(const dem_sim *sim, const touch *l, dem_vec s, double slip, contact *to)
{
    if (!dem_has_friction(sim->def.tangential)) return;
    const bool lasts = l->before > 0.0 && l->after > 0.0;
    const double part = lasts ? 1.0 : fmax(l->before, l->after) / fabs(l->after - l->before);
    const double viscous = part * l->c->gamma_s * l->m_eff / sim->def.dt,
                 cap = l->c->mu * fmax(l->normal, 0.0);
    const bool slides = fabs(viscous * slip) > cap;
    const double force = slides ? -copysign(cap, slip) : -viscous * slip;
    add_along(to, s, force, slides ? 0.0 : viscous);
    if (l->parts) *(slides ? &l->parts->slip : &l->parts->dashpot) = force;
}

/* The well's force, by the quotient of the potential k min(d^2, a^2)/2 between displacements. */
static inline void add_well(const dem_sim *sim, const touch *l, const dem_wall_slot *slot, dem_vec t,
                            contact *to)
{
    const dem_ground *g = &sim->def.ground;
    const double before = dem_ground_displacement(sim, slot),
                 moved = dem_dot(sim->grains.displacement[slot->grain], t);
    const double k = g->mu_static * fmax(l->normal, 0.0) / g->a, a = g->a;
    const bool holds = fabs(before + moved) <= a;
    const double pull = holds ? k * (before + 0.5 * moved) : 0.5 * k * (a - before) * (a + before) / moved;
    add_along(to, t, -pull, holds ? 0.5 * k : -pull / moved);
    if (l->parts) l->parts->well = -pull;
}

/* Contact number k. */
static inline contact contact_of(const dem_sim *sim, size_t k, dem_parts *p)
{
    const dem_ends ends = dem_contact_ends(sim, k);
    double r_eff;
    touch l = {.parts = p};
    dem_vec u = sim->grains.displacement[ends.i], along;
    double both = 1.0, length = 1.0; /* of a pair: sum of its distances, |along| */
    contact f = {0};
    if (ends.slot) {
        dem_wall_slot slot = *ends.slot;
        dem_touch at_wall;
        if (!dem_wall_touch(sim, &slot, &at_wall)) return f;
        along = at_wall.normal;
        l.before = at_wall.overlap;
        l.after = l.before - dem_dot(u, along);
        l.c = dem_material_at(&sim->def, slot.wall, dem_kind_of(sim, ends.i));
        l.m_eff = sim->grains.mass[ends.i], r_eff = sim->grains.radius[ends.i];
    } else {
        const dem_vec from = sim->grains.motion[ends.i].x - sim->grains.motion[ends.j].x;
        u -= sim->grains.displacement[ends.j];
        const dem_vec to = from + u;
        const double r = sqrt(dem_dot(from, from));
        along = from + to;
        both = r + sqrt(dem_dot(to, to));
        l.before = sim->pairs.radii[k] - r;
        /* the change of the distance keeps the overlap's last digits */
        l.after = l.before - dem_dot(u, along) / both;
        l.c = dem_pair_material(&sim->def, dem_kind_of(sim, ends.i), dem_kind_of(sim, ends.j));
        l.m_eff = sim->pairs.m_eff[k], r_eff = sim->pairs.r_eff[k];
    }
    if (l.before <= 0.0 && l.after <= 0.0) return f;
    if (!ends.slot) length = sqrt(dem_dot(along, along));
    double slope;
    l.k_n = dem_normal_descriptors[sim->def.normal].scale(l.c->k_n, r_eff);
    l.normal = normal_force(sim, &l, &slope);
    const double turn = ends.slot ? 0.0 : l.normal / both;
    const dem_vec s = along / both, t = dem_clockwise(along) / length;
    add_along(&f, s, l.normal, slope + turn);
    f.xx -= turn, f.yy -= turn;
    add_slip(sim, &l, t, dem_dot(u, t), &f);
    if (ends.slot && ends.slot->well == DEM_WELL_HOLDS && dem_is_ground(sim, ends.slot))
        add_well(sim, &l, ends.slot, t, &f);
    if (p) p->n = s, p->s = t;
    return f;
}

static dem_parts parts(const dem_sim *sim, size_t k)
{
    dem_parts p = {0};
    contact_of(sim, k, &p);
    return p;
}

/* ---- Residuals of a step ------------------------------------------------------------------------------- */

/* Residual of grain i under the contacts' force. */
static dem_vec residual_of(const dem_sim *sim, size_t i, dem_vec force)
{
    const dem_equation e = dem_equation_of(sim);
    const double dt = sim->def.dt, m = sim->grains.mass[i];
    const dem_vec u = sim->grains.displacement[i];
    if (dem_is_fixed(sim, i)) return (dem_vec){0.0, 0.0};
    return m * (u - dt * sim->grains.motion[i].v - 0.5 * dt * dt * dem_free_acceleration(&e, u / dt)) -
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
    dem_grains *const g = &sim->grains;
    memset(g->contact_force, 0, g->n * sizeof *g->contact_force);
    memset(g->stiffness, 0, g->n * sizeof *g->stiffness);
    for (size_t k = 0; k < dem_contact_numbers(sim); k++) {
        const dem_ends ends = dem_contact_ends(sim, k);
        const contact f = work(sim)->contact[k] = contact_of(sim, k, NULL);
        g->contact_force[ends.i] += f.force;
        g->stiffness[ends.i] += f.xx + f.yy;
        if (ends.slot) continue;
        g->contact_force[ends.j] -= f.force;
        g->stiffness[ends.j] += f.xx + f.yy;
    }
    lack l = {0};
    for (size_t i = 0; i < g->n; i++) {
        g->residual[i] = residual_of(sim, i, g->contact_force[i]);
        note_own_step(&l, i, own_step(sim, i, g->residual[i], g->stiffness[i]));
    }
    return l;
}

static rp_status not_solved(dem_sim *sim, const lack *l, long iterations)
{
    return dem_stop(sim, DEM_FAULT_NOT_SOLVED, l->grain,
                    "after %ld %s its own Newton step is %g of its radius, allowed: %g", iterations,
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
    rp_status status = rp_stiffness_create(sim->grains.n, n, ends, false, &m->matrix);
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
    for (size_t k = sim->pairs.n; k < dem_contact_numbers(sim); k++) {
        const contact *f = &m->contact[k];
        rp_stiffness_add_site(m->matrix, dem_contact_ends(sim, k).i, c * f->xx, c * f->xy, c * f->yy);
    }
}

/* The step that the last factorisation makes of the residuals; *size is the sum of its squares, *far the
 * largest of a grain. */
static rp_status newton_step(dem_sim *sim, dem_vec *step, double *size, double *far)
{
    memcpy(step, sim->grains.residual, sim->grains.n * sizeof *step);
    RP_TRY(rp_stiffness_solve(work(sim)->matrix, (double *)step, (double *)step));
    *size = *far = 0.0;
    for (size_t i = 0; i < sim->grains.n; i++) {
        const double square = dem_dot(step[i], step[i]);
        *size += square;
        *far = fmax(*far, sqrt(square));
    }
    return RP_OK;
}

/* Take a part of the step. */
static lack go(dem_sim *sim, double part)
{
    for (size_t i = 0; i < sim->grains.n; i++)
        if (!dem_is_fixed(sim, i)) sim->grains.displacement[i] -= part * sim->grains.newton_step[i];
    return evaluate(sim);
}

/* Take Newton's step, or half of it, a quarter, ..., until the next step by the same matrix is shorter.
 * Residuals cannot decide this: the stiffest contacts dominate them. No grain moves by more than half the
 * skin, beyond which the step is refused. A last step by the same matrix removes the remainder below the
 * tolerance, which has the same sign in every impact and would add up. */
static rp_status improve(dem_sim *sim, lack *l)
{
    double before, after, far, unused, gone = 0.0;
    RP_TRY(newton_step(sim, sim->grains.newton_step, &before, &far));
    const double most = fmin(1.0, 0.5 * sim->list.skin / far);
    for (double part = most; part > 0.05 * most; part *= 0.5) {
        *l = go(sim, part - gone);
        gone = part;
        if (l->largest <= sim->def.implicit.tolerance) {
            RP_TRY(newton_step(sim, sim->grains.newton_step, &after, &unused));
            go(sim, 1.0);
            break;
        }
        RP_TRY(newton_step(sim, sim->grains.further_step, &after, &unused));
        if (after < before) break;
    }
    return RP_OK;
}

/* A round of Newton's method, the number k. */
static rp_status newton_round(dem_sim *sim, lack *l, long k)
{
    rp_pivots pivots;
    assemble(sim);
    RP_TRY(rp_stiffness_factorise(work(sim)->matrix, &pivots));
    return pivots.smallest == 0.0 ? not_solved(sim, l, k) : improve(sim, l);
}

/* ---- Sweeps -------------------------------------------------------------------------------------------- */

static rp_status make_contacts_of(dem_sim *sim)
{
    workspace *m = work(sim);
    const size_t n = sim->grains.n, n_contacts = dem_contact_numbers(sim);
    free(m->of), free(m->first);
    m->of = malloc((2 * n_contacts + 1) * sizeof *m->of);
    m->first = calloc(n + 2, sizeof *m->first);
    if (!m->of || !m->first) return no_memory(sim);
    size_t *const end = m->first + 1; /* of the grain's contacts so far: the next grain's first at last */
    for (size_t k = 0; k < n_contacts; k++) {
        const dem_ends ends = dem_contact_ends(sim, k);
        end[ends.i + 1]++;
        if (!ends.slot) end[ends.j + 1]++;
    }
    for (size_t i = 1; i < n; i++) end[i] += end[i - 1];
    for (size_t k = 0; k < n_contacts; k++) {
        const dem_ends ends = dem_contact_ends(sim, k);
        m->of[end[ends.i]++] = k;
        if (!ends.slot) m->of[end[ends.j]++] = k;
    }
    return RP_OK;
}

/* Newton's step of grain i while all others stay, or the part of it that is taken. */
static void relax(dem_sim *sim, size_t i, lack *l)
{
    const workspace *m = work(sim);
    const double c = 0.5 * sim->def.dt * sim->def.dt;
    contact sum = {0};
    for (size_t k = m->first[i]; k < m->first[i + 1]; k++) {
        const contact f = contact_of(sim, m->of[k], NULL);
        sum.force += dem_contact_ends(sim, m->of[k]).j == i ? -f.force : f.force;
        sum.xx += f.xx, sum.xy += f.xy, sum.yy += f.yy;
    }
    const dem_vec h = residual_of(sim, i, sum.force);
    note_own_step(l, i, own_step(sim, i, h, sum.xx + sum.yy));
    const double xx = sim->grains.mass[i] + c * sum.xx, xy = c * sum.xy,
                 yy = sim->grains.mass[i] + c * sum.yy;
    const dem_vec step = (dem_vec){yy * h[0] - xy * h[1], xx * h[1] - xy * h[0]} / (xx * yy - xy * xy);
    sim->grains.displacement[i] -= sim->def.implicit.relaxation * step;
}

static lack sweep(dem_sim *sim)
{
    lack l = {0};
    for (size_t i = 0; i < sim->grains.n; i++)
        if (!dem_is_fixed(sim, i)) relax(sim, i, &l);
    return l.largest <= sim->def.implicit.tolerance ? evaluate(sim) : l;
}

/* ---- A step -------------------------------------------------------------------------------------------- */

/* Bring what depends on the neighbour list up to date. */
static rp_status prepare(dem_sim *sim)
{
    if (!sim->work && !(sim->work = calloc(1, sizeof(workspace)))) return no_memory(sim);
    workspace *m = work(sim);
    if (m->list == sim->count.rebuilds) return RP_OK;
    free(m->contact);
    m->contact = malloc((dem_contact_numbers(sim) + 1) * sizeof *m->contact);
    if (!m->contact) return no_memory(sim);
    RP_TRY(sim->def.implicit.solver == DEM_SOLVER_SOR ? make_contacts_of(sim) : make_matrix(sim));
    m->list = sim->count.rebuilds;
    return RP_OK;
}

static rp_status solve(dem_sim *sim)
{
    const dem_implicit_solver *how = &sim->def.implicit;
    const dem_equation e = dem_equation_of(sim);
    const double dt = sim->def.dt;
    RP_TRY(prepare(sim));
    for (size_t i = 0; i < sim->grains.n; i++) {
        const dem_vec v = sim->grains.motion[i].v;
        sim->grains.displacement[i] = dem_is_fixed(sim, i)
                                          ? (dem_vec){0.0, 0.0}
                                          : dt * v + 0.5 * dt * dt * dem_free_acceleration(&e, v);
    }
    lack l = evaluate(sim);
    for (long k = 0; !(l.largest <= how->tolerance); k++) {
        if (k == how->max_iterations || !isfinite(l.largest)) return not_solved(sim, &l, k);
        switch (how->solver) {
        case DEM_SOLVER_DIRECT: RP_TRY(newton_round(sim, &l, k)); break;
        case DEM_SOLVER_SOR: l = sweep(sim); break;
        }
        sim->count.iterations++;
    }
    return RP_OK;
}

/* A grain that the step takes farther than half the skin from its listed position, or DEM_NOBODY. */
static size_t beyond_list(const dem_sim *sim)
{
    for (size_t i = 0; i < sim->grains.n; i++) {
        const dem_vec moved = sim->grains.motion[i].x + sim->grains.displacement[i] - sim->grains.listed_x[i];
        if (!(dem_dot(moved, moved) <= 0.25 * sim->list.skin * sim->list.skin)) return i;
    }
    return DEM_NOBODY;
}

/* A grain that left makes the list be rebuilt: the solver's contacts are in its order. */
static rp_status move_grains(dem_sim *sim, unsigned *left)
{
    const dem_equation e = dem_equation_of(sim);
    if (sim->ledger) RP_TRY(dem_ledger_between(sim, sim->grains.contact_force));
    for (size_t i = 0; i < sim->grains.n; i++) {
        *dem_force(sim, i) = (dem_vec){0.0, 0.0};
        if (dem_is_fixed(sim, i)) continue;
        /* from the forces, which cancel in sum: momentum is kept whatever the solver left */
        const dem_vec u = sim->grains.displacement[i];
        sim->grains.motion[i].v +=
            e.dt * dem_acceleration(&e, sim->grains.contact_force[i], sim->grains.inverse_mass[i], u / e.dt);
        sim->grains.motion[i].x += u;
        if (dem_beyond(sim, sim->grains.motion[i].x)) *left = DEM_LIST_OUT;
    }
    sim->count.grain_steps += (double)sim->grains.n;
    return RP_OK;
}

static rp_status step(dem_sim *sim, bool last)
{
    (void)last;
    unsigned left = 0;
    RP_TRY(solve(sim));
    if (beyond_list(sim) != DEM_NOBODY) {
        RP_TRY(dem_neighbours_rebuild(sim));
        RP_TRY(solve(sim));
        const size_t i = beyond_list(sim);
        if (i != DEM_NOBODY)
            return dem_stop(sim, DEM_FAULT_TOO_FAST, i, "moves %g in one step, half the skin is %g",
                            sqrt(dem_dot(sim->grains.displacement[i], sim->grains.displacement[i])),
                            0.5 * sim->list.skin);
    }
    RP_TRY(move_grains(sim, &left));
    RP_TRY(dem_step_lists(sim, left));
    return dem_step_forces(sim);
}

const dem_scheme dem_scheme_implicit = {
    .name = "implicit",
    .order = {2, 2},
    .even_margins = true,
    .solves = true,
    .check = check,
    .free = free_work,
    .step = step,
    .parts = parts,
};
