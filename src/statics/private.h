/* What the files of a pile share.
 *
 * With displacements w in eps sigma and forces in m g, every spring K_s has stiffness 1. A bond of length L,
 * stretched by the displacement e of its ends, has the length L + eps s, s = q/(r + L), with q = 2 d.e +
 * eps e.e and r = sqrt(L^2 + eps q). A difference of positions would lose the overlap's digits. The contact
 * force is f = max(rest - s, 0), rest the overlap at the start, and the stiffness n n' - eps (f/r) t t'. The
 * second term, from the turning of compressed contacts, makes soft piles buckle. */
#ifndef STATICS_PRIVATE_H
#define STATICS_PRIVATE_H

#include <math.h>

#include "sparse/sparse.h"
#include "statics/bonds.h"

/* The search: along the branch of a rising load, stable or not; downhill with a check of the slope, in the
 * linearised problem and from a saddle; downhill by long strides at first. */
enum { FOLLOW, DESCEND, STRIDE };

enum { NAMED = 8 };   /* most disks that a message names */
enum { MANY = 5000 }; /* disks: larger piles take less time, smaller ones keep their last digits */
static const double REACH = 1.25;    /* of touching: largest distance of neighbours */
static const double TOUCHING = 1e-9; /* sigma: smaller gaps and overlaps are rounding of the input */

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

static inline rp_status no_memory(size_t n)
{
    return rp_fail(RP_NO_MEMORY, "pile of %zu disks: out of memory", n);
}

static inline statics_network network_of(const statics_pile *pile)
{
    return (statics_network){pile->n, pile->disks, REACH, pile->n_bonds, pile->pairs};
}

/* Overlap in eps sigma; 0 within rounding of touching. */
static inline double rest_overlap(double overlap, double eps)
{
    return fabs(overlap) <= TOUCHING ? 0 : overlap / eps;
}

/* Force of bond k under displacements w, negative where it is open; its direction from a to b, its length. */
static inline double bond_force(const statics_pile *pile, size_t k, const double *w, double n[2],
                                double *length)
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

static inline double force_of(const statics_pile *pile, size_t k)
{
    double n[2], length;
    return bond_force(pile, k, pile->w, n, &length);
}

static inline double ground_force(const statics_pile *pile, size_t i, const double *w)
{
    return rest_overlap(pile->disks[i].r - pile->disks[i].y, pile->def.eps) - w[2 * i + 1];
}

static inline double largest(const double *v, size_t n)
{
    double most = 0;
    for (size_t i = 0; i < n; i++) most = fmax(most, fabs(v[i]));
    return most;
}

/* ---- newton.c ---- */

/* A solve without a result; `why` is known where Newton's method converged. */
rp_status statics_no_result(statics_pile *pile, statics_fault fault, const char *why);

/* Gradient of the energy in g: minus the net force on each disk. Returns its
 * largest component. */
double statics_gradient(statics_pile *pile, const double *w, double *g);

/* Stiffness at w. At the start no contact carries a force: the expected contacts count, and the wells as
 * under an even load. The change of wells with N, which is not symmetric, is left out. `soften` in [0, 1]
 * adds this part of their stiffness to open bonds and takes it from the turning term: a pile that would fall
 * apart or buckle gets a positive stiffness, and equilibrium stays the same. `factor`: for factorisation. */
void statics_assemble(statics_pile *pile, bool start, double soften, double shift, bool factor);

/* Energy of contacts, wells and weight, in m g eps sigma. */
double statics_energy(const statics_pile *pile);

double statics_largest_force(const statics_pile *pile);

/* Largest relative displacement of neighbours; *where, if not NULL, is their bond. */
double statics_largest_stretch(const statics_pile *pile, const double *w, size_t *where);

/* Rounding of displacements w changes six contact forces by up to DBL_EPSILON |w| each; with a margin. */
double statics_tolerance(const statics_pile *pile);

/* Whether neighbours are apart by more than `linear`, or where sigma has a meaning by 0.5 sigma. */
bool statics_spread(const statics_pile *pile, double linear);

rp_status statics_newton(statics_pile *pile, bool start, int mode);

/* Pivots of the stiffness at the state found. The last factorisation serves if its signs cannot differ. For
 * eps = 0 no pivot is negative, and the stiffness left to open contacts may at most hide a free disk. */
rp_status statics_count_modes(statics_pile *pile);

/* ---- pile.c ---- */

/* The end of a solve: overlaps that are new, what is known of the state, and the message where it has no
 * result. Errors: as statics_solve. */
rp_status statics_finish(statics_pile *pile, rp_status status);

#endif
