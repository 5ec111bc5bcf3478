/* Pairs of the neighbour list where grains of very different size, or margin, lie among one another. Cells of
 * the widest pair then hold so many small grains that the plain search tests hundreds for each. Here every
 * grain is in the cells of its own size. The list is the same, in the same order. */
#ifndef DEM_SIZES_H
#define DEM_SIZES_H

#include "dem/dem.h"

struct dem_sim;
struct dem_sizes; /* work space */

/* Grain i is in cell cell[i] of `columns` * `rows`, row by row, powers of two, of this size; they wrap
 * around. */
typedef struct {
    size_t columns, rows;
    double size;
    const uint32_t *cell;
} dem_cells;

/* Find the pairs of a rebuilding, grains of the pairs alone: those of neighbours.c, in their order. Reads
 * listed positions and cutoffs; uses held_slot of the grains. Errors: RP_NO_MEMORY. */
rp_status dem_sizes_find_pairs(struct dem_sim *sim, const dem_cells *cells);
void dem_sizes_free(struct dem_sizes *sizes);

#endif
