/* Which disks of a pile may touch. */
#ifndef STATICS_BONDS_H
#define STATICS_BONDS_H

#include "statics/equilibrium.h"
#include "core/sparse.h"

/* All pairs of disks whose distance is below reach (r_a + r_b), sorted by (a, b) in a new array (free it).
 * About n log n steps for disks of similar size. Errors: RP_NO_MEMORY. */
rp_status statics_bonds_find(size_t n, const statics_disk *disks, double reach, rp_pair **bonds,
                             size_t *n_bonds);

/* How many disks the ground and their bonds, pushing, can't hold against their weight, one by one; `which`
 * gets the first, at most `room`. `lean` is room for 2 n numbers. */
size_t statics_bonds_unsupported(size_t n, const statics_disk *disks, const rp_pair *bonds, size_t n_bonds,
                                 double reach, double *lean, size_t room, size_t *which);

/* The pile of half the size that has the same shape: of a pile on a triangular lattice, every second disk of
 * every second row, in a new array of *n_half. parents[i] are the two of them between which disk i lies, both
 * the same if it is one of them; n_half and above where one is missing. n_half = 0: the disks are on no such
 * lattice. Errors: RP_NO_MEMORY. */
rp_status statics_bonds_halve(size_t n, const statics_disk *disks, const rp_pair *bonds, size_t n_bonds,
                              statics_disk **half, size_t *n_half, rp_pair *parents);

#endif
