/* Newton's method at one load: forces, stiffness, its factorisation and updates, steps. */
#include "statics/private.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* The length of a step along p. */
static const struct {
    double step_max, curved, longer, trials;
} search = {.step_max = 0.2, /* sigma: largest relative displacement of neighbours */
            .curved = 0.5,   /* slope after a step over the slope before it: largest, of either sign */
            .longer = 8,     /* the next trial of a step that was too short */
            .trials = 40};

/* Where Newton's method gives up. */
static const struct {
    double spread, spread_linear, apart;
    int steps[3], whole_strides;
} limit = {.spread = 0.5,         /* sigma: relative displacement of neighbours */
           .spread_linear = 1e12, /* eps sigma: the same for eps = 0 */
           .apart = 3,            /* largest residual over the residual at the load step's start */
           .steps = {[FOLLOW] = 15, [DESCEND] = 2000, [STRIDE] = 2000},
           .whole_strides = 40}; /* later strides are steps of a descent */

/* Softening of a stiffness that is singular or negative. */
static const struct {
    double least, first, turn, hold;
} softening = {.least = 1e-6, /* also of open contacts */
               .first = 1e-4,
               .turn = 0.3,   /* the first in strides, of the largest turning term */
               .hold = 1e-9}; /* K_s: stiffness that holds free disks during the search */

/* What a factorisation tells, and how long it serves. */
static const struct {
    double singular, falls, almost, same, held, followed;
} factors = {.singular = 1e-11, /* K_s: smaller pivots are rounding */
             .falls = 0.02,     /* of the residual in the last step, which lets the next keep it */
             .almost = 1e-6,    /* m g: residual at which a new one may serve to the end */
             .same = 1e-6,      /* of the smallest pivot: a change that keeps all signs */
             .held = 1e-3, /* of the smallest pivot: stiffness of open contacts that hides no free disk */
             .followed = 0.01}; /* of a well's stiffness: change that hides no free disk */

rp_status statics_no_result(statics_pile *pile, statics_fault fault, const char *why)
{
    pile->why = why;
    pile->result.fault = fault;
    return RP_NO_RESULT;
}

/* ---- Forces and stiffness ---- */

double statics_gradient(statics_pile *pile, const double *w, double *g)
{
    for (size_t i = 0; i < pile->n; i++) {
        g[2 * i] = 0;
        g[2 * i + 1] = pile->disks[i].weight - fmax(ground_force(pile, i, w), 0);
    }
    for (size_t k = 0; k < pile->n_bonds; k++) {
        double n[2], r, f = bond_force(pile, k, w, n, &r);
        if (!(f > 0)) continue;
        double *ga = &g[2 * pile->pairs[k].a], *gb = &g[2 * pile->pairs[k].b];
        for (int c = 0; c < 2; c++) {
            ga[c] += f * n[c];
            gb[c] -= f * n[c];
        }
    }
    for (size_t i = 0; i < pile->n_wells; i++) {
        well *h = &pile->wells[i];
        h->N = fmax(ground_force(pile, h->disk, w), 0);
        h->H = h->k * (w[2 * h->disk] - h->x_0);
        g[2 * h->disk] += h->H;
    }
    double worst = 0;
    for (size_t i = 0; i < 2 * pile->n; i++)
        if (!(fabs(g[i]) <= worst)) worst = fabs(g[i]); /* a NaN stays */
    return worst;
}

void statics_assemble(statics_pile *pile, bool start, double soften, double shift, bool factor)
{
    const double *w = pile->w;
    rp_stiffness_clear(pile->matrix, shift);
    for (size_t k = 0; k < pile->n_bonds; k++) {
        double n[2], r, f = bond_force(pile, k, w, n, &r);
        bond *b = &pile->bonds[k];
        const double hard = f > 0 || (start && b->expected) ? 1 : soften;
        if (factor) {
            b->hard = hard;
            memcpy(b->along, n, sizeof n);
        }
        if (!(hard > 0)) continue;
        const double turn = (1 - soften) * pile->eps * fmax(f, 0) / r;
        rp_stiffness_add_bond(pile->matrix, k, pile->pairs[k], hard * n[0] * n[0] - turn * n[1] * n[1],
                              n[0] * n[1] * (hard + turn), hard * n[1] * n[1] - turn * n[0] * n[0]);
    }
    for (size_t i = 0; i < pile->n; i++)
        if (ground_force(pile, i, w) > 0) rp_stiffness_add_site(pile->matrix, i, 0, 0, 1);
    for (size_t i = 0; i < pile->n_wells; i++) {
        well *h = &pile->wells[i];
        if (factor) h->held = h->k;
        rp_stiffness_add_site(pile->matrix, h->disk, h->k, 0,
                              ground_force(pile, h->disk, w) > 0 ? 0
                              : start                            ? 1
                                                                 : soften);
    }
}

double statics_energy(const statics_pile *pile)
{
    double sum = 0;
    for (size_t i = 0; i < pile->n; i++) {
        const double f = fmax(ground_force(pile, i, pile->w), 0);
        sum += f * f / 2 + pile->disks[i].weight * pile->w[2 * i + 1];
    }
    for (size_t k = 0; k < pile->n_bonds; k++) {
        const double f = fmax(force_of(pile, k), 0);
        sum += f * f / 2;
    }
    for (size_t i = 0; i < pile->n_wells; i++) {
        const double x = pile->w[2 * pile->wells[i].disk] - pile->wells[i].x_0;
        sum += pile->wells[i].k * x * x / 2;
    }
    return sum;
}

/* Whether the factorised matrix has all closed contacts, and of open ones no more than `kept`. */
static bool same_contacts(const statics_pile *pile, double kept)
{
    for (size_t k = 0; k < pile->n_bonds; k++)
        if (force_of(pile, k) > 0 ? pile->bonds[k].hard < 1 : pile->bonds[k].hard > kept) return false;
    return true;
}

double statics_largest_force(const statics_pile *pile)
{
    double most = 0;
    for (size_t k = 0; k < pile->n_bonds; k++) most = fmax(most, force_of(pile, k));
    return most;
}

/* Factorise at w, softened until the matrix is not singular, and for a minimum not negative; disks that are
 * still free get a weak hold. The softening is kept for the next time, lowered while the residual falls. */
static rp_status factorise(statics_pile *pile, bool start, int mode, bool falling)
{
    const bool positive = mode != FOLLOW;
    double soften = falling ? pile->soften / 10 : pile->soften, hold = 0;
    if (soften < softening.least) soften = 0;
    const bool first = !pile->factored && !(soften > 0); /* at the last load's place */
    bool known = first && positive && pile->buckles > 0 && pile->eps == pile->buckles;
    for (;;) {
        if (!known) {
            statics_assemble(pile, start, soften, hold, true);
            rp_status status = rp_stiffness_factorise(pile->matrix, &pile->pivots);
            pile->result.factored++;
            if (status) return status;
            if (pile->pivots.smallest > factors.singular && !(positive && pile->pivots.negative)) break;
            if (hold > 0) return statics_no_result(pile, STATICS_SINGULAR, "");
        }
        known = false;
        if (soften == 1) hold = softening.hold;
        soften =
            soften > 0 ? fmin(10 * soften, 1)
            : mode == STRIDE
                ? fmin(fmax(softening.turn * pile->eps * statics_largest_force(pile), softening.least), 1)
                : softening.first;
    }
    if (first && !(soften > 0) && pile->pivots.negative && !(pile->buckles > 0)) pile->buckles = pile->eps;
    pile->soften = soften;
    pile->moved = 0;
    pile->factored = true;
    return RP_OK;
}

/* Stiffness of a closed or open bond after an update. An opening bond keeps the softening, at least
 * softening.least, until the contacts have settled: a disk between two contacts must not come free. */
static double next_stiffness(const bond *b, bool pushes, bool settled, double soften)
{
    return pushes ? 1 : b->hard == 1 ? fmax(soften, softening.least) : settled ? 0 : b->hard;
}

/* Contacts that have closed or opened since the stiffness was factorised or updated. */
static size_t changed_contacts(const statics_pile *pile)
{
    size_t changed = 0;
    for (size_t k = 0; k < pile->n_bonds; k++)
        changed += (force_of(pile, k) > 0) != (pile->bonds[k].hard == 1);
    return changed;
}

/* Wells of large piles whose stiffness has followed N since the stiffness was factorised or updated. */
static size_t changed_wells(const statics_pile *pile)
{
    size_t changed = 0;
    for (size_t i = 0; pile->n >= MANY && i < pile->n_wells; i++)
        changed += pile->wells[i].k != pile->wells[i].held;
    return changed;
}

/* A spring whose stiffness in the factorised matrix changes from *now to `next`. */
typedef struct {
    rp_pair ends;
    double along[2], next, *now;
} change;

/* Note the n-th change for an update, if it is an increase, or a decrease. False if there is no room. */
static bool note_change(statics_pile *pile, bool add, change c, size_t *n)
{
    if (add ? !(c.next > *c.now) : !(c.next < *c.now)) return true;
    if (*n == pile->n_changes) return false;
    const double part = sqrt(fabs(c.next - *c.now));
    pile->changed[*n] = c.ends;
    pile->direction[*n][0] = part * c.along[0];
    pile->direction[(*n)++][1] = part * c.along[1];
    *c.now = c.next;
    return true;
}

/* Update the factorised stiffness by the few bonds and wells that changed, without the turning term of soft
 * piles. False if too many changed, or the result is singular or negative. */
static bool update(statics_pile *pile, rp_status *status)
{
    const size_t wells = changed_wells(pile);
    const bool settled = !(pile->eps > 0) && changed_contacts(pile) == 0 && wells == 0;
    size_t all = 0;
    for (int add = 1; add >= 0; add--) { /* first the new ones, so that it does not get singular on the way */
        size_t n = 0;
        for (size_t k = 0; k < pile->n_bonds; k++) {
            bond *b = &pile->bonds[k];
            const double next = next_stiffness(b, force_of(pile, k) > 0, settled, pile->soften);
            if (!note_change(pile, add, (change){pile->pairs[k], {b->along[0], b->along[1]}, next, &b->hard},
                             &n))
                return false;
        }
        for (size_t i = 0; wells > 0 && i < pile->n_wells; i++) {
            well *h = &pile->wells[i];
            if (!note_change(pile, add, (change){{h->disk, h->disk}, {1, 0}, h->k, &h->held}, &n))
                return false;
        }
        all += n;
        *status = rp_stiffness_update(pile->matrix, add, n, pile->changed,
                                      (const double(*)[2])pile->direction, &pile->pivots);
        if (*status || pile->pivots.negative || !(pile->pivots.smallest > factors.singular)) return false;
    }
    return all > 0; /* else it was something else that changed */
}

/* ---- Steps ---- */

double statics_largest_stretch(const statics_pile *pile, const double *w, size_t *where)
{
    double most = 0;
    for (size_t k = 0; k < pile->n_bonds; k++) {
        const double *wa = &w[2 * pile->pairs[k].a], *wb = &w[2 * pile->pairs[k].b],
                     moved = fmax(fabs(wb[0] - wa[0]), fabs(wb[1] - wa[1]));
        if (where && moved > most) *where = k;
        most = fmax(most, moved);
    }
    return most;
}

double statics_tolerance(const statics_pile *pile)
{
    return 32 * DBL_EPSILON * fmax(largest(pile->w, 2 * pile->n), 1);
}

bool statics_spread(const statics_pile *pile, double linear)
{
    const double most = pile->eps > 0 ? limit.spread / pile->eps : linear;
    return !(statics_largest_stretch(pile, pile->w, NULL) < most);
}

static double slope_along(const statics_pile *pile)
{
    double sum = 0;
    for (size_t i = 0; i < 2 * pile->n; i++) sum += pile->g[i] * pile->p[i];
    return sum;
}

/* Move along p: by all of it, or where contacts on the way reverse the slope of the energy, to a slope below
 * half. A softened stiffness gives a short p, which is lengthened until the slope has fallen. The slope's
 * sign does not matter: it is positive at first where the energy curves downwards. Returns the residual. */
static double advance(statics_pile *pile, bool whole)
{
    const double slope = slope_along(pile), stretch = statics_largest_stretch(pile, pile->p, NULL),
                 reach = stretch * pile->eps;
    double t = reach > search.step_max ? search.step_max / reach : 1, residual = INFINITY;
    double below = 0, s_below = 1, above = INFINITY,
           s_above = 0; /* bracket: places, and slopes over the first */
    for (int i = 0; i < search.trials; i++) {
        for (size_t c = 0; c < 2 * pile->n; c++) pile->trial[c] = pile->w[c] + t * pile->p[c];
        residual = statics_gradient(pile, pile->trial, pile->g);
        const double s = slope_along(pile) / slope;
        const bool bracketed = isfinite(above),
                   lengthen = pile->soften > 0 && search.longer * t * reach < search.step_max;
        if (whole || !(s < -search.curved || (s > search.curved && (bracketed || lengthen)))) break;
        if (s < 0) {
            above = t;
            s_above = s;
        } else {
            below = t;
            s_below = s;
        }
        const double part = s_below / (s_below - s_above);
        t = isfinite(above) ? below + (above - below) * fmin(fmax(part, 0.1), 0.9) : search.longer * t;
    }
    pile->moved += t * stretch;
    double *reached = pile->trial;
    pile->trial = pile->w;
    pile->w = reached;
    return residual;
}

/* The fault that ends Newton's method here; STATICS_OK: none. A branch is followed by whole steps and left
 * when they do not converge at once: another step might find another branch. */
static statics_fault fault_of_step(const statics_pile *pile, int mode, int step, double first)
{
    if (statics_spread(pile, limit.spread_linear))
        return pile->result.broken ? STATICS_SPREADS : STATICS_COLLAPSES;
    if (step == limit.steps[mode] || !(pile->result.residual < INFINITY)) return STATICS_NOT_CONVERGED;
    return mode == FOLLOW && pile->pivots.negative && pile->result.residual > limit.apart * first
               ? STATICS_NOT_CONVERGED
               : STATICS_OK;
}

/* The step of a soft pile while few contacts change: by the updated factorisation and conjugate gradients,
 * with less softening while the residual falls. False if this fails. */
static bool step_by_old_factor(statics_pile *pile, bool falling, rp_status *status)
{
    const size_t changed = changed_contacts(pile) + changed_wells(pile);
    const bool waits = pile->n >= MANY && pile->result.residual > factors.almost;
    if (changed > 0 ? changed > pile->n_changes / 2 || !update(pile, status) : !waits) return false;
    const double less = falling && pile->soften / 10 >= softening.least ? pile->soften / 10 : pile->soften;
    bool found = false;
    for (int again = 0; !found && !*status && again <= (less < pile->soften); again++) {
        const double soften = again ? pile->soften : less;
        statics_assemble(pile, false, soften, 0, false);
        *status = rp_stiffness_solve_near(pile->matrix, pile->g, pile->p, &found);
        if (found) pile->soften = soften;
    }
    return found;
}

/* Solve the stiffness at w for p, with the right side g. */
static rp_status find_step(statics_pile *pile, bool start, int mode, bool falling)
{
    rp_status status = RP_OK;
    const bool linear = !(pile->eps > 0);
    if (pile->factored && !linear && mode != FOLLOW && step_by_old_factor(pile, falling, &status))
        return RP_OK;
    if (!status && !(pile->factored && linear && !(pile->soften > 0) && update(pile, &status)) && !status)
        status = factorise(pile, start, mode, falling);
    return status ? status : rp_stiffness_solve(pile->matrix, pile->g, pile->p);
}

rp_status statics_newton(statics_pile *pile, bool start, int mode)
{
    statics_result *r = &pile->result;
    pile->why = "";
    double last = INFINITY, first = r->residual = statics_gradient(pile, pile->w, pile->g);
    for (int step = 0; !(r->residual <= statics_tolerance(pile)); step++, start = false) {
        r->fault = fault_of_step(pile, mode, step, first);
        if (r->fault) return RP_NO_RESULT;
        if (pile->def.watch) pile->def.watch(pile->n, r, pile->def.context);
        const bool serves =
            pile->factored && r->residual <= factors.falls * last && same_contacts(pile, softening.least);
        RP_TRY(serves ? rp_stiffness_solve(pile->matrix, pile->g, pile->p)
                      : find_step(pile, start, mode, r->residual < last));
        last = r->residual;
        for (size_t i = 0; i < 2 * pile->n; i++) pile->p[i] = -pile->p[i];
        r->residual = advance(pile, mode == FOLLOW || (mode == STRIDE && step < limit.whole_strides));
        r->steps++;
    }
    r->fault = STATICS_OK;
    return RP_OK;
}

/* Whether all wells have kept nearly the stiffness that they have in the factorised matrix. Without eps all
 * springs pull back, so that the pivots change by no larger part than the wells. Piles of the papers' sizes
 * keep the pivots of a new factorisation. */
static bool wells_kept(const statics_pile *pile)
{
    bool kept = pile->n >= MANY && !(pile->eps > 0);
    for (size_t i = 0; kept && i < pile->n_wells; i++) {
        const well *h = &pile->wells[i];
        kept = fabs(h->k - h->held) <= factors.followed * h->held;
    }
    return kept || pile->def.well == STATICS_WELL_SPRING;
}

rp_status statics_count_modes(statics_pile *pile)
{
    const double kept = pile->eps > 0 ? 0 : fmin(softening.least, factors.held * pile->pivots.smallest);
    const bool exact = pile->factored && !(pile->soften > 0) && wells_kept(pile) &&
                       pile->eps * pile->moved < factors.same * pile->pivots.smallest &&
                       same_contacts(pile, kept);
    rp_status status = RP_OK;
    if (!exact) {
        statics_assemble(pile, false, 0, 0, true);
        pile->factored = false;
        pile->result.factored++;
        status = rp_stiffness_factorise(pile->matrix, &pile->pivots);
    }
    pile->result.negative_modes = pile->pivots.negative;
    pile->result.smallest_pivot = pile->pivots.smallest;
    pile->result.pivot_disk = pile->pivots.disk;
    if (status || pile->pivots.smallest > factors.singular) return status;
    /* an indifferent equilibrium: its modes are not counted */
    return statics_no_result(pile, STATICS_SINGULAR, "");
}
