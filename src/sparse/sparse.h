/* Stiffness matrix of disks on a network of possible contacts: symmetric, a 2x2 block for each disk and each
 * bond. Factorised as L D L' without pivoting, so that an indefinite matrix is allowed and the signs of D
 * count its negative eigenvalues (Sylvester). CHOLMOD analyses the pattern once, and updates factors. Large
 * positive matrices, of 20000 disks, are factorised with BLAS and OpenMP. Bits then depend on the BLAS, and a
 * process with OpenMP threads can't be forked to factorise again. */
#ifndef RP_STIFFNESS_H
#define RP_STIFFNESS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "core/status.h"

typedef struct rp_stiffness rp_stiffness;

/* The two disks of a bond, a < b. */
typedef struct {
    uint32_t a, b;
} rp_pair;

/* For n disks and bonds sorted by (a, b). `often`: nested dissection at any size, which takes longer than
 * minimum degree once, and less for each of some ten factorisations and updates. Free with rp_stiffness_free.
 * Errors: RP_NO_MEMORY. */
rp_status rp_stiffness_create(size_t n, size_t n_bonds, const rp_pair *bonds, bool often,
                              rp_stiffness **matrix);
void rp_stiffness_free(rp_stiffness *m);

/* Set to shift times the identity, then add springs that hold disk a to the ground, or join the ends of bond
 * number k, with stiffness [xx xy; xy yy]. */
void rp_stiffness_clear(rp_stiffness *m, double shift);
void rp_stiffness_add_site(rp_stiffness *m, size_t a, double xx, double xy, double yy);
void rp_stiffness_add_bond(rp_stiffness *m, size_t k, rp_pair ends, double xx, double xy, double yy);

/* Pivots D of the last factorisation. */
typedef struct {
    size_t negative;
    double smallest; /* in magnitude; 0: singular, the factorisation stopped there */
    size_t disk;     /* disk of the smallest pivot */
} rp_pivots;

/* Errors: RP_NO_MEMORY. A zero pivot is no error. */
rp_status rp_stiffness_factorise(rp_stiffness *m, rp_pivots *pivots);

/* Update the factor for bonds of stiffness 1 along the given directions, not all zero, added to the matrix or
 * removed from it; a bond with a = b is a spring to the ground. Far cheaper than a new factorisation for a
 * few bonds. Errors: RP_NO_MEMORY. */
rp_status rp_stiffness_update(rp_stiffness *m, bool add, size_t n_bonds, const rp_pair *bonds,
                              const double (*direction)[2], rp_pivots *pivots);

/* Solve for 2n unknowns x0 y0 x1 y1 ... with the last factorisation; `b` may be `x`. Errors: none. */
rp_status rp_stiffness_solve(rp_stiffness *m, const double *b, double *x);

/* Solve for the matrix assembled since, close to the factorised one, which must be positive: conjugate
 * gradients preconditioned by that factor, to a residual of a tenth of b. *found: false if the iterations do
 * not converge, or if they show that the matrix is not positive. Errors: RP_NO_MEMORY. */
rp_status rp_stiffness_solve_near(rp_stiffness *m, const double *b, double *x, bool *found);

#endif
