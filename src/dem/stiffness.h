/* Stiffness matrix of disks on a network of possible contacts: symmetric, a 2x2 block for each disk and each
 * bond. Factorised as L D L' by CHOLMOD without pivoting, so that an indefinite matrix is allowed and the
 * signs of D count its negative eigenvalues (Sylvester). The pattern is analysed once. Of large piles a
 * positive matrix is factorised with BLAS, whose bits differ from one BLAS to another, and with OpenMP, so
 * that a process that did so can't be forked to do it again. */
#ifndef DEM_STIFFNESS_H
#define DEM_STIFFNESS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "core/status.h"

typedef struct dem_stiffness dem_stiffness;

/* Disks that a bond joins, a < b. */
typedef struct {
    uint32_t a, b;
} dem_pair;

/* For n disks and bonds sorted by (a, b). Free with dem_stiffness_free. Errors: RP_NO_MEMORY. */
rp_status dem_stiffness_create(size_t n, size_t n_bonds, const dem_pair *bonds, dem_stiffness **matrix);
void dem_stiffness_free(dem_stiffness *m);

/* Set to shift times the identity, then add springs that hold disk a to the ground, or join the ends of bond
 * number k, with stiffness [xx xy; xy yy]. */
void dem_stiffness_clear(dem_stiffness *m, double shift);
void dem_stiffness_add_site(dem_stiffness *m, size_t a, double xx, double xy, double yy);
void dem_stiffness_add_bond(dem_stiffness *m, size_t k, dem_pair ends, double xx, double xy, double yy);

/* Pivots D of the last factorisation. */
typedef struct {
    size_t negative;
    double smallest; /* in magnitude; 0: singular, the factorisation stopped there */
    size_t disk;     /* that it belongs to */
} dem_pivots;

/* Errors: RP_NO_MEMORY. A zero pivot is no error. */
rp_status dem_stiffness_factorise(dem_stiffness *m, dem_pivots *pivots);

/* Add to (or take from) the factorised matrix bonds of stiffness 1 along directions that are not all zero,
 * without a new factorisation: for a few bonds far cheaper. Errors: RP_NO_MEMORY. */
rp_status dem_stiffness_update(dem_stiffness *m, bool add, size_t n_bonds, const dem_pair *bonds,
                               const double (*direction)[2], dem_pivots *pivots);

/* Solve for 2n unknowns x0 y0 x1 y1 ... with the last factorisation; `b` may be `x`. Errors: RP_NO_MEMORY. */
rp_status dem_stiffness_solve(dem_stiffness *m, const double *b, double *x);

/* The same for the matrix that was added up since, near the factorised one, which must be positive: to a tenth
 * of b, by conjugate gradients with that factorisation. *found: false if few iterations do not do, or if they
 * find that the matrix is not positive. Errors: RP_NO_MEMORY. */
rp_status dem_stiffness_solve_near(dem_stiffness *m, const double *b, double *x, bool *found);

#endif
