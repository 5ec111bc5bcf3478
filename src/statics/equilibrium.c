/* Static equilibrium by a semi-smooth Newton method on displacements; see equilibrium.h.
 *
 * With displacements w in eps sigma and forces in m g, every spring K_s has stiffness 1. A bond of length L,
 * stretched by the displacement e of its ends, has the length L + eps s, s = q/(r + L), with q = 2 d.e +
 * eps e.e and r = sqrt(L^2 + eps q). A difference of positions would lose the overlap's digits. The contact
 * force is f = max(rest - s, 0), rest the overlap at the start, and the stiffness n n' - eps (f/r) t t'. The
 * second term, from the turning of compressed contacts, makes soft piles buckle. */
#include "statics/equilibrium.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/random.h"
#include "statics/bonds.h"
#include "core/sparse.h"

static const double REACH = 1.25;         /* of touching: largest distance of neighbours */
static const double TOUCHING = 1e-9;      /* sigma: smaller gaps and overlaps are rounding of the input */
static const double LEVEL = 0.2588;       /* sin(15 degrees): largest of horizontal bonds */
static const double STEP_MAX = 0.2;       /* sigma: largest relative displacement of a Newton step */
static const double SPREAD = 0.5;         /* sigma: relative displacement that ends a solve */
static const double SPREAD_LINEAR = 1e12; /* eps sigma: the same for eps = 0 */
static const double SLID_LINEAR =
    1e3; /* the same after wells broke, over the whole weight on one K_s, or a */
static const double KEEP_FACTOR = 0.02; /* fall of the residual a step that keeps the old factorisation */
static const double ALMOST = 1e-6;      /* m g: residual at which a new factorisation may serve to the end */
static const double CURVED = 0.5;   /* slope after a step over the slope before it: largest, of either sign */
static const double LONGER = 8;     /* the next trial of a step that was too short */
static const double APART = 3;      /* largest residual over the residual at the load step's start */
static const double UPDATE_MAX = 8; /* of sqrt(n): most contacts that change without a new factorisation */
static const double SINGULAR = 1e-11;    /* K_s: smaller pivots are rounding */
static const double HOLD = 1e-9;         /* K_s: stiffness that holds free disks during the search */
static const double SAME_PIVOTS = 1e-6;  /* of the smallest pivot: a change that keeps all signs */
static const double SOFTEN_MIN = 1e-6;   /* least softening of a singular stiffness, or of open contacts */
static const double SOFTEN_FIRST = 1e-4; /* first softening of a negative or singular stiffness */
static const double SOFTEN_TURN = 0.3;   /* the same in strides, of the largest turning term */
static const double HELD =
    1e-3; /* of the smallest pivot: stiffness of open contacts that hides no free disk */
static const double FOLLOWED = 0.01; /* of a well's stiffness: change that hides no free disk */
static const double KICK = 0.1;      /* of the largest force: displacement from a saddle towards a minimum */
/* The search: along the branch of a rising load, stable or not; downhill with a check of the slope, in the
 * linearised problem and from a saddle; downhill by long strides at first. */
enum { FOLLOW, DESCEND, STRIDE };
enum {
    STEPS_FOLLOW = 15,
    STEPS_STRIDE = 40,
    TRIALS = 40,
    STEPS_DESCEND = 2000,
    WELL_ROUNDS = 100,
    SMALLEST_STEP = 10,
    KICKS = 20,
    HALVED = 1000, /* disks from which on a pile of half the size is solved first */
    MANY =
        5000,  /* disks: smaller piles, as the papers', keep their last digits; larger ones take less time */
    NAMED = 8, /* most disks that a message names */
    INVERSE_STEPS = 30,
    MIXING_STEPS = 1 /* leaves many modes in */
};

typedef struct {
    double d[2], length, rest;
    double hard,
        along[2];    /* stiffness in the factorised matrix, but for the turning term; its direction then */
    bool horizontal, /* within 15 degrees */
        expected;    /* to carry a force, at the first factorisation */
} bond;

typedef struct {
    uint32_t disk;
    bool broken, lost;   /* now; at least once */
    double x_0, k, N, H; /* k: stiffness, which follows N from one round to the next */
    double held;         /* stiffness in the factorised matrix */
} well;

struct statics_pile {
    statics_definition def;
    size_t n, n_bonds, n_wells;
    statics_disk *disks; /* owned */
    rp_pair *pairs;
    bond *bonds;
    well *wells;
    rp_stiffness *matrix;
    size_t n_changes; /* room for bonds changed at once */
    rp_pair *changed;
    double (*direction)[2];
    double *block;                    /* of the next five, 2 n each */
    double *w, *g, *p, *trial, *kept; /* displacements, gradient, step, place tried, last load's place */
    double eps, a; /* of the forces now: from 0, the linearised problem, to def.eps; of the wells now */
    bool factored;
    double soften, moved; /* of the factorised stiffness; neighbours' relative displacement since then */
    double buckles; /* first eps tried at the last load's place, if its stiffness is negative there; else 0 */
    rp_pivots pivots;
    const char *why; /* there is no result though Newton's method converged; "" */
    size_t n_met;    /* pairs that overlap and were no neighbours; the first of them */
    rp_pair met[NAMED];
    statics_result result;
};

statics_definition statics_definition_default(void)
{
    return (statics_definition){.eps = 1e-4, .k_x = 1, .mu = 1, .a = 1, .load_steps = 1};
}

const char *const statics_fault_texts[] = {
#define X(name, text) text,
    STATICS_LIST(X)
#undef X
};

/* "disks 1, 2, 3 and 5 more"; `disks` holds the first NAMED of n. */
static void name_disks(FILE *text, size_t n, const size_t disks[])
{
    fputs(n == 1 ? "disk" : "disks", text);
    for (size_t i = 0; i < n && i < NAMED; i++) fprintf(text, "%s %zu", i ? "," : "", disks[i] + 1);
    if (n > NAMED) fprintf(text, " and %zu more", n - NAMED);
}

static rp_status no_memory(size_t n)
{
    return rp_fail(RP_NO_MEMORY, "pile of %zu disks: out of memory", n);
}

/* A solve without a result; `why` is known where Newton's method converged. */
static rp_status no_result(statics_pile *pile, statics_fault fault, const char *why)
{
    pile->why = why;
    pile->result.fault = fault;
    return RP_NO_RESULT;
}

/* ---- Making a pile ---- */

static rp_status check_disks(const statics_definition *def)
{
    if (def->n < 1 || def->n > STATICS_MAX)
        return rp_fail(RP_BAD_INPUT, "%zu disks: out of range, allowed: [1, %d]", def->n, STATICS_MAX);
    for (size_t i = 0; i < def->n; i++) {
        const statics_disk *p = &def->disks[i];
        const double overlap = p->r - p->y;
        if (!(isfinite(p->x) && isfinite(p->y) && isfinite(p->r) && p->r > 0 && p->weight > 0 &&
              isfinite(p->weight)))
            return rp_fail(RP_BAD_INPUT, "disk %zu at (%g, %g) with r = %g, weight %g: not allowed", i + 1,
                           p->x, p->y, p->r, p->weight);
        if (overlap > (def->eps > 0 ? p->r / 2 : TOUCHING))
            return rp_fail(RP_BAD_INPUT, "disk %zu at (%g, %g): below the ground", i + 1, p->x, p->y);
    }
    return RP_OK;
}

static rp_status check_definition(const statics_definition *def)
{
    RP_TRY(rp_check_range("eps", def->eps, 0, 0.1, "[0, 0.1]"));
    if (def->well == STATICS_WELL_SPRING) RP_TRY(rp_check_range("k_x", def->k_x, DBL_MIN, 1e9, "(0, 1e9]"));
    if (def->well == STATICS_WELL_FRICTION) {
        RP_TRY(rp_check_range("mu", def->mu, DBL_MIN, 1e9, "(0, 1e9]"));
        RP_TRY(rp_check_range("a", def->a, DBL_MIN, 1e9, "(0, 1e9]"));
    }
    RP_TRY(rp_check_range("set_load", def->set_load, 0, 1, "[0, 1]"));
    RP_TRY(rp_check_range("load_steps", (double)def->load_steps, 1, 1e6, "[1, 1000000]"));
    return check_disks(def);
}

/* Overlap in eps sigma; 0 within rounding of touching. */
static double rest_overlap(double overlap, double eps)
{
    return fabs(overlap) <= TOUCHING ? 0 : overlap / eps;
}

static rp_status make_bonds(statics_pile *pile)
{
    const statics_definition *def = &pile->def;
    for (size_t k = 0; k < pile->n_bonds; k++) {
        const statics_disk *p = &pile->disks[pile->pairs[k].a], *q = &pile->disks[pile->pairs[k].b];
        bond *b = &pile->bonds[k];
        b->d[0] = q->x - p->x;
        b->d[1] = q->y - p->y;
        b->length = sqrt(b->d[0] * b->d[0] + b->d[1] * b->d[1]);
        b->horizontal = fabs(b->d[1]) < LEVEL * b->length;
        const double overlap = p->r + q->r - b->length;
        if (overlap > (def->eps > 0 ? (p->r + q->r) / 2 : TOUCHING))
            return rp_fail(RP_BAD_INPUT, "disks %u and %u overlap by %g sigma, allowed: up to %s",
                           pile->pairs[k].a + 1, pile->pairs[k].b + 1, overlap,
                           def->eps > 0 ? "half of touching" : "rounding, as eps = 0");
        b->rest = rest_overlap(overlap, def->eps);
    }
    return RP_OK;
}

static int by_x(const void *left, const void *right)
{
    const well *p = left, *q = right;
    return (p->x_0 > q->x_0) - (p->x_0 < q->x_0);
}

static void make_wells(statics_pile *pile)
{
    for (size_t i = 0; i < pile->n; i++)
        if (pile->disks[i].y - pile->disks[i].r <= TOUCHING)
            pile->wells[pile->n_wells++] = (well){.disk = (uint32_t)i, .x_0 = pile->disks[i].x};
    qsort(pile->wells, pile->n_wells, sizeof *pile->wells, by_x);
    for (size_t i = 0; i < pile->n_wells; i++) pile->wells[i].x_0 = 0; /* from here on a displacement */
}

static rp_status refuse_hanging(const statics_pile *pile, size_t n, const size_t hang[])
{
    char more[240] = "";
    FILE *text = n > 1 ? fmemopen(more, sizeof more, "w") : NULL;
    if (text) {
        fputs("; nor ", text);
        name_disks(text, n - 1, hang + 1);
        fclose(text);
    }
    return rp_fail(RP_BAD_INPUT,
                   "disk %zu at (%g, %g) has no support: its neighbours and the ground can't carry it%s",
                   hang[0] + 1, pile->disks[hang[0]].x, pile->disks[hang[0]].y, more);
}

static rp_status find_network(statics_pile *pile)
{
    RP_TRY(statics_bonds_find(pile->n, pile->disks, REACH, &pile->pairs, &pile->n_bonds));
    size_t hang[NAMED + 1];
    const size_t hanging = statics_bonds_unsupported(pile->n, pile->disks, pile->pairs, pile->n_bonds, REACH,
                                                     pile->trial, NAMED + 1, hang);
    if (hanging) return refuse_hanging(pile, hanging, hang);
    pile->bonds = calloc(pile->n_bonds + 1, sizeof *pile->bonds);
    pile->n_changes = (size_t)(UPDATE_MAX * sqrt((double)pile->n));
    pile->changed = malloc(pile->n_changes * sizeof *pile->changed);
    pile->direction = malloc(pile->n_changes * sizeof *pile->direction);
    if (!pile->bonds || !pile->changed || !pile->direction) return no_memory(pile->n);
    RP_TRY(make_bonds(pile));
    make_wells(pile);
    const bool often = pile->n >= MANY && pile->def.eps > 0;
    return rp_stiffness_create(pile->n, pile->n_bonds, pile->pairs, often, &pile->matrix);
}

rp_status statics_create(const statics_definition *def, statics_pile **made)
{
    rp_status status = check_definition(def);
    if (status) return status;
    const size_t n = def->n;
    statics_pile *pile = calloc(1, sizeof *pile);
    if (!pile) return no_memory(n);
    pile->def = *def;
    pile->n = n;
    pile->disks = malloc(n * sizeof *pile->disks);
    pile->wells = malloc(n * sizeof *pile->wells);
    pile->block = calloc(10 * n, sizeof *pile->block);
    if (!pile->disks || !pile->wells || !pile->block)
        status = no_memory(n);
    else {
        memcpy(pile->disks, def->disks, n * sizeof *pile->disks);
        pile->def.disks = pile->disks;
        pile->w = pile->block;
        pile->g = pile->w + 2 * n;
        pile->p = pile->g + 2 * n;
        pile->trial = pile->p + 2 * n;
        pile->kept = pile->trial + 2 * n;
        status = find_network(pile);
    }
    if (status)
        statics_free(pile);
    else
        *made = pile;
    return status;
}

void statics_free(statics_pile *pile)
{
    if (!pile) return;
    rp_stiffness_free(pile->matrix);
    free(pile->disks);
    free(pile->pairs);
    free(pile->bonds);
    free(pile->changed);
    free(pile->direction);
    free(pile->wells);
    free(pile->block);
    free(pile);
}

/* ---- Forces and stiffness ---- */

/* Force of bond k under displacements w, negative where it is open; its direction from a to b, its length. */
static double bond_force(const statics_pile *pile, size_t k, const double *w, double n[2], double *length)
{
    const bond *b = &pile->bonds[k];
    const double *wa = &w[2 * pile->pairs[k].a], *wb = &w[2 * pile->pairs[k].b], eps = pile->eps;
    const double ex = wb[0] - wa[0], ey = wb[1] - wa[1];
    const double q = 2 * (b->d[0] * ex + b->d[1] * ey) + eps * (ex * ex + ey * ey);
    const double r = sqrt(b->length * b->length + eps * q);
    n[0] = (b->d[0] + eps * ex) / r;
    n[1] = (b->d[1] + eps * ey) / r;
    *length = r;
    return b->rest - q / (r + b->length);
}

static double force_of(const statics_pile *pile, size_t k)
{
    double n[2], length;
    return bond_force(pile, k, pile->w, n, &length);
}

static double ground_force(const statics_pile *pile, size_t i, const double *w)
{
    return rest_overlap(pile->disks[i].r - pile->disks[i].y, pile->def.eps) - w[2 * i + 1];
}

/* Gradient of the energy in g: minus the net force on each disk. Returns its
 * largest component. */
static double gradient(statics_pile *pile, const double *w, double *g)
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

/* Stiffness at w. At the start no contact carries a force: the expected contacts count, and the wells as
 * under an even load. The change of wells with N, which is not symmetric, is left out. `soften` in [0, 1]
 * adds this part of their stiffness to open bonds and takes it from the turning term: a pile that would fall
 * apart or buckle gets a positive stiffness, and equilibrium stays the same. `factor`: for factorisation. */
static void assemble(statics_pile *pile, bool start, double soften, double shift, bool factor)
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

/* Energy of contacts, wells and weight, in m g eps sigma. */
static double energy(const statics_pile *pile)
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

static bool same_contacts(const statics_pile *pile)
{
    for (size_t k = 0; k < pile->n_bonds; k++) {
        if (force_of(pile, k) > 0 ? pile->bonds[k].hard < 1 : pile->bonds[k].hard > SOFTEN_MIN) return false;
    }
    return true;
}

static double largest_force(const statics_pile *pile)
{
    double most = 0;
    for (size_t k = 0; k < pile->n_bonds; k++) most = fmax(most, force_of(pile, k));
    return most;
}

/* Factorise at w, softened until the matrix is not singular, and for a minimum not negative; disks that are
 * still free get a weak hold. The softening is kept for the next time, and lowered while the residual falls.
 */
static rp_status factorise(statics_pile *pile, bool start, int mode, bool falling)
{
    const bool positive = mode != FOLLOW;
    double soften = falling ? pile->soften / 10 : pile->soften, hold = 0;
    if (soften < SOFTEN_MIN) soften = 0;
    const bool first = !pile->factored && !(soften > 0); /* at the last load's place */
    bool known = first && positive && pile->buckles > 0 && pile->eps == pile->buckles;
    for (;;) {
        if (!known) {
            assemble(pile, start, soften, hold, true);
            rp_status status = rp_stiffness_factorise(pile->matrix, &pile->pivots);
            pile->result.factored++;
            if (status) return status;
            if (pile->pivots.smallest > SINGULAR && !(positive && pile->pivots.negative)) break;
            if (hold > 0) return no_result(pile, STATICS_SINGULAR, "");
        }
        known = false;
        if (soften == 1) hold = HOLD;
        soften = soften > 0       ? fmin(10 * soften, 1)
                 : mode == STRIDE ? fmin(fmax(SOFTEN_TURN * pile->eps * largest_force(pile), SOFTEN_MIN), 1)
                                  : SOFTEN_FIRST;
    }
    if (first && !(soften > 0) && pile->pivots.negative && !(pile->buckles > 0)) pile->buckles = pile->eps;
    pile->soften = soften;
    pile->moved = 0;
    pile->factored = true;
    return RP_OK;
}

/* Stiffness of a closed or open bond after an update. An opening bond keeps the softening, at least
 * SOFTEN_MIN, until the contacts have settled: a disk between two contacts must not come free. */
static double next_stiffness(const bond *b, bool pushes, bool settled, double soften)
{
    return pushes ? 1 : b->hard == 1 ? fmax(soften, SOFTEN_MIN) : settled ? 0 : b->hard;
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

/* Note a spring whose stiffness increases, or decreases, from *now to `next`, for an update. False if there
 * is no room. */
static bool note_change(statics_pile *pile, bool add, rp_pair ends, const double along[2], double next,
                        double *now, size_t *n)
{
    if (add ? !(next > *now) : !(next < *now)) return true;
    if (*n == pile->n_changes) return false;
    const double part = sqrt(fabs(next - *now));
    pile->changed[*n] = ends;
    pile->direction[*n][0] = part * along[0];
    pile->direction[(*n)++][1] = part * along[1];
    *now = next;
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
            if (!note_change(pile, add, pile->pairs[k], b->along, next, &b->hard, &n)) return false;
        }
        for (size_t i = 0; wells > 0 && i < pile->n_wells; i++) {
            well *h = &pile->wells[i];
            if (!note_change(pile, add, (rp_pair){h->disk, h->disk}, (double[]){1, 0}, h->k, &h->held, &n))
                return false;
        }
        all += n;
        *status = rp_stiffness_update(pile->matrix, add, n, pile->changed,
                                      (const double(*)[2])pile->direction, &pile->pivots);
        if (*status || pile->pivots.negative || !(pile->pivots.smallest > SINGULAR)) return false;
    }
    return all > 0; /* else it was something else that changed */
}

/* ---- Newton's method ---- */

static double largest(const double *v, size_t n)
{
    double most = 0;
    for (size_t i = 0; i < n; i++) most = fmax(most, fabs(v[i]));
    return most;
}

/* Largest relative displacement of neighbours; *where, if not NULL, is their bond. */
static double largest_stretch(const statics_pile *pile, const double *w, size_t *where)
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

/* Rounding of displacements w changes six contact forces by up to DBL_EPSILON |w| each; with a margin. */
static double tolerance(const statics_pile *pile)
{
    return 32 * DBL_EPSILON * fmax(largest(pile->w, 2 * pile->n), 1);
}

/* Whether neighbours are apart by more than `linear`, or where sigma has a meaning by SPREAD. */
static bool spread(const statics_pile *pile, double linear)
{
    const double limit = pile->eps > 0 ? SPREAD / pile->eps : linear;
    return !(largest_stretch(pile, pile->w, NULL) < limit);
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
    const double slope = slope_along(pile), stretch = largest_stretch(pile, pile->p, NULL),
                 reach = stretch * pile->eps;
    double t = reach > STEP_MAX ? STEP_MAX / reach : 1, residual = INFINITY;
    double below = 0, s_below = 1, above = INFINITY,
           s_above = 0; /* bracket: places, and slopes over the first */
    for (int i = 0; i < TRIALS; i++) {
        for (size_t c = 0; c < 2 * pile->n; c++) pile->trial[c] = pile->w[c] + t * pile->p[c];
        residual = gradient(pile, pile->trial, pile->g);
        const double s = slope_along(pile) / slope;
        const bool bracketed = isfinite(above), lengthen = pile->soften > 0 && LONGER * t * reach < STEP_MAX;
        if (whole || !(s < -CURVED || (s > CURVED && (bracketed || lengthen)))) break;
        if (s < 0) {
            above = t;
            s_above = s;
        } else {
            below = t;
            s_below = s;
        }
        const double part = s_below / (s_below - s_above);
        t = isfinite(above) ? below + (above - below) * fmin(fmax(part, 0.1), 0.9) : LONGER * t;
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
    static const int most[] = {[FOLLOW] = STEPS_FOLLOW, [DESCEND] = STEPS_DESCEND, [STRIDE] = STEPS_DESCEND};
    if (spread(pile, SPREAD_LINEAR)) return pile->result.broken ? STATICS_SPREADS : STATICS_COLLAPSES;
    if (step == most[mode] || !(pile->result.residual < INFINITY)) return STATICS_NOT_CONVERGED;
    return mode == FOLLOW && pile->pivots.negative && pile->result.residual > APART * first
               ? STATICS_NOT_CONVERGED
               : STATICS_OK;
}

/* The step of a soft pile while few contacts change: by the updated factorisation and conjugate gradients,
 * with less softening while the residual falls. False if this fails. */
static bool step_by_old_factor(statics_pile *pile, bool falling, rp_status *status)
{
    const size_t changed = changed_contacts(pile) + changed_wells(pile);
    const bool waits = pile->n >= MANY && pile->result.residual > ALMOST;
    if (changed > 0 ? changed > pile->n_changes / 2 || !update(pile, status) : !waits) return false;
    const double less = falling && pile->soften / 10 >= SOFTEN_MIN ? pile->soften / 10 : pile->soften;
    bool found = false;
    for (int again = 0; !found && !*status && again <= (less < pile->soften); again++) {
        const double soften = again ? pile->soften : less;
        assemble(pile, false, soften, 0, false);
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

static rp_status newton(statics_pile *pile, bool start, int mode)
{
    statics_result *r = &pile->result;
    pile->why = "";
    double last = INFINITY, first = r->residual = gradient(pile, pile->w, pile->g);
    for (int step = 0; !(r->residual <= tolerance(pile)); step++, start = false) {
        r->fault = fault_of_step(pile, mode, step, first);
        if (r->fault) return RP_NO_RESULT;
        if (pile->def.watch) pile->def.watch(pile->n, r, pile->def.context);
        const bool serves = pile->factored && r->residual <= KEEP_FACTOR * last && same_contacts(pile);
        RP_TRY(serves ? rp_stiffness_solve(pile->matrix, pile->g, pile->p)
                      : find_step(pile, start, mode, r->residual < last));
        last = r->residual;
        for (size_t i = 0; i < 2 * pile->n; i++) pile->p[i] = -pile->p[i];
        r->residual = advance(pile, mode == FOLLOW || (mode == STRIDE && step < STEPS_STRIDE));
        r->steps++;
    }
    r->fault = STATICS_OK;
    return RP_OK;
}

/* ---- Wells, load, branches ---- */

/* Let the wells' stiffness follow N; true if that changed a force. */
static bool follow_wells(statics_pile *pile)
{
    double change = 0;
    for (size_t i = 0; pile->def.well == STATICS_WELL_FRICTION && i < pile->n_wells; i++) {
        well *h = &pile->wells[i];
        const double k = h->broken ? 0 : pile->def.mu * h->N / pile->a;
        change = fmax(change, fabs((k - h->k) * (pile->w[2 * h->disk] - h->x_0)));
        if (k != h->k) pile->buckles = 0;
        h->k = k;
    }
    return change > tolerance(pile);
}

/* Break, or set anew, the wells that their disks have left; true if there are any. */
static bool break_wells(statics_pile *pile)
{
    bool any = false;
    for (size_t i = 0; pile->def.well == STATICS_WELL_FRICTION && i < pile->n_wells; i++) {
        well *h = &pile->wells[i];
        const double x = pile->w[2 * h->disk];
        if (h->broken || fabs(x - h->x_0) <= pile->a) continue;
        if (!pile->result.broken) pile->result.first_broken = h->disk;
        pile->result.broken += !h->lost;
        h->lost = true;
        h->x_0 = x;
        h->broken = !pile->def.set_again;
        any = true;
    }
    return any;
}

/* Equilibrium, no well breaking. */
static rp_status converge(statics_pile *pile, bool start, int mode)
{
    for (int round = 0; round < WELL_ROUNDS; round++, start = false) {
        rp_status status = newton(pile, start, mode);
        if (status || !follow_wells(pile)) return status;
    }
    return no_result(pile, STATICS_NOT_CONVERGED, "the wells' stiffness does not settle; ");
}

/* Equilibrium, with the wells that hold. */
static rp_status settle(statics_pile *pile, int mode)
{
    for (int round = 0; round < WELL_ROUNDS; round++) {
        rp_status status = converge(pile, false, mode);
        if (status || !break_wells(pile)) return status;
        follow_wells(pile);
    }
    return no_result(pile, STATICS_CREEPS, "wells are left as often as they are set anew; ");
}

/* A branch that is lost as wells break: the descent from the last equilibrium, under the whole load, tells
 * whether the pile comes apart or comes to rest on another branch. */
static rp_status descend_from_kept(statics_pile *pile, double to)
{
    memcpy(pile->w, pile->kept, 2 * pile->n * sizeof *pile->w);
    pile->eps = to;
    pile->factored = false;
    rp_status status = settle(pile, STRIDE);
    return status ? status
                  : no_result(pile, STATICS_NOT_CONVERGED,
                              "the branch was lost as wells broke, but downhill there is rest; ");
}

/* Raise eps from 0, where w is the linearised solution, to `to`. A step that fails is halved, one that
 * succeeds doubled. Where the smallest fails the branch has ended: the pile jumps downhill, and stays at
 * minima from there on. */
static rp_status raise_eps(statics_pile *pile, double to)
{
    double *load = &pile->result.load;
    const double most = 1 / (double)pile->def.load_steps;
    int mode = pile->def.branch == STATICS_BRANCH_MINIMUM && !pile->def.leave ? STRIDE : FOLLOW;
    for (double step = most; *load < 1;) {
        step = fmin(step, 1 - *load);
        memcpy(pile->kept, pile->w, 2 * pile->n * sizeof *pile->w);
        pile->eps = (*load + step) * to;
        pile->factored = false;
        rp_status status = settle(pile, mode);
        if (!status) {
            pile->buckles = 0;
            *load = 1 - *load > step ? *load + step : 1;
            step = fmin(2 * step, most);
            continue;
        }
        step /= 2;
        const bool ended = step < most / SMALLEST_STEP;
        if (status != RP_NO_RESULT || (mode == STRIDE && ended)) return status;
        if (pile->result.broken)
            return mode == FOLLOW && pile->result.fault == STATICS_NOT_CONVERGED ? descend_from_kept(pile, to)
                                                                                 : status;
        memcpy(pile->w, pile->kept, 2 * pile->n * sizeof *pile->w);
        if (ended) {
            mode = STRIDE;
            pile->result.jumps = 1;
            step = most;
        }
    }
    return RP_OK;
}

static rp_status solve_linear(statics_pile *pile, double a);

/* The pile of half the size, made and solved; NULL where there is none or it has no solution. */
static rp_status solve_half(const statics_pile *pile, double a, rp_pair *parents, statics_pile **solved)
{
    statics_definition def = pile->def;
    statics_disk *disks = NULL;
    statics_pile *half = NULL;
    rp_status status =
        statics_bonds_halve(pile->n, pile->disks, pile->pairs, pile->n_bonds, &disks, &def.n, parents);
    def.disks = disks;
    def.k_x *= 2; /* half the force, a quarter of the displacement */
    if (!status && def.n > 0) status = statics_create(&def, &half);
    if (half) status = solve_linear(half, a / 4);
    free(disks);
    if (status) {
        statics_free(half);
        half = NULL;
    }
    *solved = half;
    return status == RP_NO_MEMORY ? status : RP_OK;
}

/* Friction wells as under the N of the half-size pile, which is half of N here. */
static void expect_wells(statics_pile *pile, const statics_pile *half, const rp_pair parents[])
{
    for (size_t i = 0; i < pile->n_wells; i++) {
        const rp_pair from = parents[pile->wells[i].disk];
        if (from.a >= half->n || from.b >= half->n) continue;
        const double N = ground_force(half, from.a, half->w) + ground_force(half, from.b, half->w);
        if (N > 0) pile->wells[i].k = pile->def.mu * N / pile->a;
    }
}

/* Contacts that are expected to carry a force: all but the horizontal ones; if all neighbours touch, those
 * that do at the same position in the linearised pile of half the size. The solution does not depend on it.
 */
static rp_status expect_contacts(statics_pile *pile, double a)
{
    bool touching = pile->n >= HALVED;
    for (size_t k = 0; k < pile->n_bonds; k++) {
        pile->bonds[k].expected = !pile->bonds[k].horizontal;
        touching &= !(fabs(pile->bonds[k].rest) > 0);
    }
    if (!touching) return RP_OK;
    statics_pile *half = NULL;
    rp_pair *parents = malloc(pile->n * sizeof *parents);
    if (!parents) return no_memory(pile->n);
    rp_status status = solve_half(pile, a, parents, &half);
    for (size_t i = 0; half && i < 2 * pile->n; i++) {
        const size_t p = parents[i / 2].a, q = parents[i / 2].b;
        pile->w[i] = p < half->n && q < half->n ? half->w[2 * p + i % 2] + half->w[2 * q + i % 2] : NAN;
    }
    for (size_t k = 0; half && k < pile->n_bonds; k++) {
        const double f = force_of(pile, k);
        if (!isnan(f)) pile->bonds[k].expected = f > 0;
    }
    if (half && pile->def.well == STATICS_WELL_FRICTION && pile->n >= MANY) expect_wells(pile, half, parents);
    statics_free(half);
    free(parents);
    return status;
}

/* The linearised state, its wells at their x_0 with the half-width a. */
static rp_status solve_linear(statics_pile *pile, double a)
{
    const statics_definition *def = &pile->def;
    const double even = def->mu / a * (double)pile->n / (double)pile->n_wells; /* until N is known */
    for (size_t i = 0; i < pile->n_wells; i++) {
        pile->wells[i].broken = pile->wells[i].lost = false;
        pile->wells[i].k = def->well == STATICS_WELL_SPRING ? def->k_x : even;
    }
    pile->factored = false;
    pile->soften = pile->eps = pile->buckles = 0;
    pile->a = a;
    pile->result = (statics_result){.wells = pile->n_wells, .first_broken = pile->n, .released = NAN};
    rp_status status = expect_contacts(pile, a);
    memset(pile->w, 0, 2 * pile->n * sizeof *pile->w);
    return status ? status : converge(pile, true, DESCEND);
}

/* The state at `eps`. */
static rp_status find_state(statics_pile *pile, double eps, double a)
{
    rp_status status = solve_linear(pile, a);
    if (status || eps > 0) return status ? status : raise_eps(pile, eps);
    status = settle(pile, DESCEND);
    pile->result.load = !status;
    return status;
}

/* x_0 where the disks stand under a part of the load: eps is in proportion to the weight, and with it the
 * unit of displacements. */
static rp_status set_wells(statics_pile *pile, double part)
{
    rp_status status = find_state(pile, part * pile->def.eps, pile->def.a / part);
    if (status) pile->result.load *= part;
    for (size_t i = 0; !status && i < pile->n_wells; i++)
        pile->wells[i].x_0 = part * pile->w[2 * pile->wells[i].disk];
    return status;
}

/* Most stiffness that an open contact has in the factorised matrix. */
static double kept_open(const statics_pile *pile)
{
    double most = 0;
    for (size_t k = 0; k < pile->n_bonds; k++)
        if (pile->bonds[k].hard < 1) most = fmax(most, pile->bonds[k].hard);
    return most;
}

/* Whether all wells have kept nearly the stiffness that they have in the factorised matrix. Without eps all
 * springs pull back, so that the pivots change by no larger part than the wells. Piles of the papers' sizes
 * keep the pivots of a new factorisation. */
static bool wells_kept(const statics_pile *pile)
{
    bool kept = pile->n >= MANY && !(pile->eps > 0);
    for (size_t i = 0; kept && i < pile->n_wells; i++) {
        const well *h = &pile->wells[i];
        kept = fabs(h->k - h->held) <= FOLLOWED * h->held;
    }
    return kept || pile->def.well == STATICS_WELL_SPRING;
}

/* Pivots of the stiffness at the state found. The last factorisation serves if its signs cannot differ. For
 * eps = 0 no pivot is negative, and the stiffness left to open contacts may at most hide a free disk. */
static rp_status count_modes(statics_pile *pile)
{
    const bool exact = pile->factored && !(pile->soften > 0) && wells_kept(pile) &&
                       pile->eps * pile->moved < SAME_PIVOTS * pile->pivots.smallest && same_contacts(pile) &&
                       kept_open(pile) <= (pile->eps > 0 ? 0 : HELD * pile->pivots.smallest);
    rp_status status = RP_OK;
    if (!exact) {
        assemble(pile, false, 0, 0, true);
        pile->factored = false;
        pile->result.factored++;
        status = rp_stiffness_factorise(pile->matrix, &pile->pivots);
    }
    pile->result.negative_modes = pile->pivots.negative;
    pile->result.smallest_pivot = pile->pivots.smallest;
    pile->result.pivot_disk = pile->pivots.disk;
    if (status || pile->pivots.smallest > SINGULAR) return status;
    return no_result(pile, STATICS_SINGULAR, ""); /* an indifferent equilibrium: its modes are not counted */
}

/* Leave a saddle close to its least stable mode, by inverse iteration with the stiffness shifted until it is
 * positive. After few iterations the direction is a mixture of unstable modes. */
static rp_status kick(statics_pile *pile)
{
    const int steps = pile->def.leave ? MIXING_STEPS : INVERSE_STEPS;
    gsl_rng *rng = rp_random_alloc(pile->def.leave, 0, RP_PURPOSE_DIRECTION);
    rp_status status = rng ? RP_OK : rp_fail(RP_NO_MEMORY, "random stream: out of memory");
    if (status) return status;
    double shift = 1e-6;
    do {
        assemble(pile, false, 0, shift, true);
        status = rp_stiffness_factorise(pile->matrix, &pile->pivots);
        pile->result.factored++;
        shift *= 2;
    } while (!status && (pile->pivots.negative || !(pile->pivots.smallest > 0)));
    for (size_t i = 0; i < 2 * pile->n; i++) pile->p[i] = gsl_rng_uniform(rng) - 0.5;
    gsl_rng_free(rng);
    for (int step = 0; !status && step < steps; step++) {
        const double scale = 1 / largest(pile->p, 2 * pile->n);
        for (size_t i = 0; i < 2 * pile->n; i++) pile->p[i] *= scale;
        status = rp_stiffness_solve(pile->matrix, pile->p, pile->p);
    }
    if (status) return status;
    const double scale = KICK * largest_force(pile) / largest_stretch(pile, pile->p, NULL);
    for (size_t i = 0; i < 2 * pile->n; i++) pile->w[i] += scale * pile->p[i];
    pile->factored = false;
    return RP_OK;
}

static rp_status go_to_minimum(statics_pile *pile)
{
    const double primary = energy(pile);
    for (int i = 0; pile->result.negative_modes && i < KICKS; i++) {
        RP_TRY(kick(pile));
        RP_TRY(settle(pile, DESCEND));
        RP_TRY(count_modes(pile));
    }
    if (pile->def.leave && !pile->result.jumps) pile->result.released = primary - energy(pile);
    return pile->result.negative_modes ? no_result(pile, STATICS_NOT_CONVERGED, "no stable state downhill; ")
                                       : RP_OK;
}

/* Pairs that overlap now and were no neighbours. */
static rp_status check_new_overlaps(statics_pile *pile)
{
    const double eps = pile->def.eps;
    size_t n_met = 0;
    statics_disk *moved = malloc(pile->n * sizeof *moved);
    rp_pair *met = NULL;
    if (!moved) return no_memory(pile->n);
    for (size_t i = 0; i < pile->n; i++) {
        moved[i] = pile->disks[i];
        moved[i].x += eps * pile->w[2 * i];
        moved[i].y += eps * pile->w[2 * i + 1];
    }
    rp_status status = statics_bonds_find(pile->n, moved, 1 - TOUCHING, &met, &n_met);
    for (size_t k = 0, j = 0; k < n_met; k++) {
        while (j < pile->n_bonds &&
               (pile->pairs[j].a < met[k].a || (pile->pairs[j].a == met[k].a && pile->pairs[j].b < met[k].b)))
            j++;
        if (j < pile->n_bonds && pile->pairs[j].a == met[k].a && pile->pairs[j].b == met[k].b) continue;
        if (pile->n_met < NAMED) pile->met[pile->n_met] = met[k];
        pile->n_met++;
    }
    free(met);
    free(moved);
    return status || !pile->n_met ? status : no_result(pile, STATICS_MEETS, "");
}

static void count_contacts(statics_pile *pile)
{
    pile->result.contacts = pile->result.horizontal = 0;
    for (size_t k = 0; k < pile->n_bonds; k++) {
        const bool closed = force_of(pile, k) > 0;
        pile->result.contacts += closed;
        pile->result.horizontal += closed && pile->bonds[k].horizontal;
    }
}

/* The disk with the largest net force. */
static size_t worst_disk(const statics_pile *pile)
{
    size_t worst = 0;
    for (size_t i = 0; i < 2 * pile->n; i++)
        if (fabs(pile->g[i]) > fabs(pile->g[worst])) worst = i;
    return worst / 2;
}

static void name_wells(const statics_pile *pile, FILE *text)
{
    const statics_result *r = &pile->result;
    size_t lost[NAMED], n = 0;
    if (!r->broken) return;
    for (size_t i = 0; i < pile->n_wells && n < NAMED; i++)
        if (pile->wells[i].lost) lost[n++] = pile->wells[i].disk;
    fprintf(text, "%zu of %zu wells %s, first that of disk %zu: ", r->broken, r->wells,
            pile->def.set_again ? "set anew" : "broken", r->first_broken + 1);
    name_disks(text, r->broken, lost);
    fputs("; ", text);
}

/* Which disks moved apart, met, or are free. */
static void name_cause(const statics_pile *pile, FILE *text)
{
    const statics_fault fault = pile->result.fault;
    if (fault == STATICS_SPREADS || fault == STATICS_COLLAPSES) {
        size_t widest = 0;
        const double moved = largest_stretch(pile, pile->w, &widest);
        const rp_pair apart = pile->pairs[widest];
        fprintf(text, "neighbours %u and %u moved by %.3g %s against one another; ", apart.a + 1, apart.b + 1,
                pile->eps > 0 ? pile->eps * moved : moved, pile->eps > 0 ? "sigma" : "eps sigma");
    }
    if (fault == STATICS_NOT_CONVERGED || fault == STATICS_CREEPS) fputs(pile->why, text);
    if (fault == STATICS_SINGULAR) fprintf(text, "no pivot for disk %zu; ", pile->pivots.disk + 1);
    for (size_t i = 0; i < pile->n_met && i < NAMED; i++)
        fprintf(text, "%s%u on %u", i ? ", " : "no neighbours, but disk ", pile->met[i].a + 1,
                pile->met[i].b + 1);
    if (pile->n_met > NAMED) fprintf(text, " and %zu more pairs", pile->n_met - NAMED);
    if (pile->n_met) fputs("; ", text);
}

/* The message of a solve without a result: what is known. */
static rp_status explain(const statics_pile *pile)
{
    const statics_result *r = &pile->result;
    char known[900] = "";
    FILE *text = fmemopen(known, sizeof known, "w");
    if (!text) return no_memory(pile->n);
    name_wells(pile, text);
    name_cause(pile, text);
    fprintf(text, "followed up to %g of the load", r->load);
    if (!(r->residual <= tolerance(pile)))
        fprintf(text, ", then a residual of %.3g m g, on disk %zu", r->residual, worst_disk(pile) + 1);
    fclose(text);
    return rp_fail(RP_NO_RESULT, "%s: %s, after %zu steps", statics_fault_texts[r->fault], known, r->steps);
}

/* The state in which a solve ended without a result. */
static void record_state(statics_pile *pile)
{
    statics_result *r = &pile->result;
    r->residual = gradient(pile, pile->w, pile->g);
    r->eps = pile->eps;
    if (r->broken && spread(pile, SLID_LINEAR * ((double)pile->n + pile->a))) r->fault = STATICS_SPREADS;
    const bool free_disk = r->fault == STATICS_SINGULAR;
    r->negative_modes = STATICS_UNCOUNTED;
    r->smallest_pivot = free_disk ? pile->pivots.smallest : NAN;
    r->pivot_disk = free_disk ? pile->pivots.disk : pile->n;
}

rp_status statics_solve(statics_pile *pile, statics_result *result)
{
    const statics_definition *def = &pile->def;
    for (size_t i = 0; i < pile->n_wells; i++) pile->wells[i].x_0 = 0;
    pile->n_met = 0;
    rp_status status = def->set_load > 0 ? set_wells(pile, def->set_load) : RP_OK;
    if (!status) status = find_state(pile, def->eps, def->a);
    if (!status) status = count_modes(pile);
    if (!status && (def->branch == STATICS_BRANCH_MINIMUM || pile->result.jumps))
        status = go_to_minimum(pile);
    /* new overlaps count also where another disk is free */
    const bool free_disk = status == RP_NO_RESULT && pile->result.fault == STATICS_SINGULAR &&
                           pile->result.residual <= tolerance(pile);
    if (def->eps > 0 && (!status || free_disk)) {
        rp_status met = check_new_overlaps(pile);
        if (met) status = met;
    }
    pile->result.eps = def->eps;
    if (status == RP_NO_RESULT) record_state(pile);
    count_contacts(pile);
    pile->result.energy = energy(pile);
    *result = pile->result;
    return status == RP_NO_RESULT ? explain(pile) : status;
}

/* ---- Reading ---- */

void statics_displacements(const statics_pile *pile, double *u)
{
    memcpy(u, pile->w, 2 * pile->n * sizeof *u);
}

void statics_base(const statics_pile *pile, size_t *disk, double *N, double *H)
{
    for (size_t i = 0; i < pile->n_wells; i++) {
        if (disk) disk[i] = pile->wells[i].disk;
        N[i] = pile->wells[i].N;
        H[i] = pile->wells[i].H;
    }
}

void statics_wells(const statics_pile *pile, statics_well *wells)
{
    for (size_t i = 0; i < pile->n_wells; i++) {
        const well *h = &pile->wells[i];
        wells[i] = (statics_well){.disk = h->disk,
                                  .x = pile->w[2 * h->disk],
                                  .x_0 = h->x_0,
                                  .N = h->N,
                                  .H = h->broken ? 0 : h->H,
                                  .state = h->broken ? STATICS_WELL_BROKEN
                                           : h->lost ? STATICS_WELL_ANEW
                                                     : STATICS_WELL_HOLDS};
    }
}

/* Uses two of the pile's vectors as work space. */
static void mark_extremes(const statics_pile *pile, statics_contact *contacts, size_t n)
{
    const double TIE = 1e-9;
    double *most = pile->p, *least = pile->trial;
    for (size_t i = 0; i < pile->n; i++) {
        most[i] = 0;
        least[i] = INFINITY;
    }
    for (size_t e = 0; e < 2 * n; e++) {
        const size_t i = e % 2 ? contacts[e / 2].b : contacts[e / 2].a;
        most[i] = fmax(most[i], contacts[e / 2].force);
        least[i] = fmin(least[i], contacts[e / 2].force);
    }
    for (size_t e = 0; e < 2 * n; e++) {
        statics_contact *c = &contacts[e / 2];
        const size_t i = e % 2 ? c->b : c->a;
        c->strongest |= c->force >= most[i] * (1 - TIE);
        c->weakest |= c->force <= least[i] * (1 + TIE);
    }
}

rp_status statics_contacts(const statics_pile *pile, statics_contact **contacts, size_t *n)
{
    const double eps = pile->result.eps, *w = pile->w;
    statics_contact *list = malloc((pile->n_bonds + 1) * sizeof *list);
    if (!list) return rp_fail(RP_NO_MEMORY, "contacts of %zu disks: out of memory", pile->n);
    *n = 0;
    for (size_t k = 0; k < pile->n_bonds; k++) {
        double dir[2], r;
        const double f = bond_force(pile, k, w, dir, &r);
        if (!(f > 0)) continue;
        const size_t a = pile->pairs[k].a, b = pile->pairs[k].b;
        list[(*n)++] = (statics_contact){.a = a,
                                         .b = b,
                                         .x = pile->disks[a].x + eps * w[2 * a],
                                         .y = pile->disks[a].y + eps * w[2 * a + 1],
                                         .x_b = pile->disks[b].x + eps * w[2 * b],
                                         .y_b = pile->disks[b].y + eps * w[2 * b + 1],
                                         .force = f,
                                         .horizontal = pile->bonds[k].horizontal};
    }
    mark_extremes(pile, list, *n);
    *contacts = list;
    return RP_OK;
}
