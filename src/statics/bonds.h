/* Which disks of a pile may touch. */
#ifndef STATICS_BONDS_H
#define STATICS_BONDS_H

#include "sparse/sparse.h"
#include "statics/equilibrium.h"

/* Disks, and all pairs of them whose distance is below reach (r_a + r_b), sorted by (a, b). */
typedef struct {
    size_t n;
    const statics_disk *disks;
    double reach;
    size_t n_pairs;
    rp_pair *pairs;
} statics_network;

/* Find the pairs, in a new array (free it), in about n log n steps for disks of similar size. Errors:
 * RP_NO_MEMORY. */
rp_status statics_bonds_find(statics_network *net);
bool statics_bonds_has(const statics_network *net, rp_pair pair);

/* How many disks the ground and their bonds, pushing, can't hold against their weight, one by one; `which`
 * gets the first, at most `room`. `lean` is room for 2 n numbers. */
size_t statics_bonds_unsupported(const statics_network *net, double *lean, size_t room, size_t *which);

/* The pile of half the size that has the same shape: of a pile on a triangular lattice, every second disk of
 * every second row, in a new array of *n_half. parents[i] are the two of them between which disk i lies, both
 * the same if it is one of them; n_half and above where one is missing. n_half = 0: the disks are on no such
 * lattice. Free *half also then. Errors: RP_NO_MEMORY. */
rp_status statics_bonds_halve(const statics_network *net, statics_disk **half, size_t *n_half,
                              rp_pair *parents);

#endif
