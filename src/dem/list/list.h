/* The neighbour list; dem_neighbours_rebuild is in dem.h. */
#ifndef DEM_LIST_H
#define DEM_LIST_H

#include "dem/state/state.h"

/* Work space of a simulation at its start, and for more grains than its capacity. Errors: RP_NO_MEMORY. */
rp_status dem_neighbours_alloc(dem_sim *sim);
rp_status dem_neighbours_grow(dem_sim *sim, size_t capacity);
void dem_neighbours_free(dem_sim *sim);

/* Its part of a snapshot; a reading makes the work space. */
void dem_neighbours_keep(rp_snapshot *s, dem_sim *sim);

/* For hard collisions: let every grain's margin hold its displacement of the coming step. Few grains get
 * their part of the list anew, else all of it is rebuilt. The margin follows a grain's speed now. If that was
 * too small for a slow grain that a fast one has hit in a soft contact (accelerates), the speed that it is
 * about to have counts. Errors: RP_BROKEN, RP_NO_MEMORY. */
rp_status dem_neighbours_renew(dem_sim *sim, bool accelerates);

/* Take out the grains that left, with their pairs and wall slots, and keep the list as it is; removal.c. In a
 * large pile, they stay in the arrays of grains and pairs until the second function: of the rebuilding and of
 * the end of a run. */
void dem_neighbours_drop(dem_sim *sim);
void dem_neighbours_close_gaps(dem_sim *sim);

/* ---- Search for pairs; search.c ---- */

/* Square cells, row by row, which wrap around: the first grain of each. */
typedef struct {
    size_t columns, rows; /* powers of two */
    double size;
    size_t squares;  /* sum of the squared numbers of grains in a cell */
    uint32_t *start; /* [columns * rows + 1] */
} dem_cells;

/* Work space of a rebuilding, besides arrays of the grains; the lists grow. */
struct dem_list_work {
    dem_cells cells; /* of the last rebuilding */
    dem_grains spare;
    uint32_t *apart; /* pairs on their next to the end of the list */
    size_t apart_capacity;
    /* springs of touching pairs, a chain for the lower new index of the two grains: i is the next of the
     * chain, DEM_NOWHERE after the last, j the higher index */
    dem_pairs held;
    dem_wall_slot *wall_slot;
    size_t wall_capacity;
};

/* As many cells of this size as the extent of the grains needs, at most some four a grain. Are these numbers
 * of columns and rows possible with so many grains? */
void dem_cells_choose(const dem_sim *sim, double size, dem_cells *cells);
bool dem_cells_are_possible(const dem_cells *cells, size_t grains);

/* Find the places of the grains, moved_to, by cells of this size, in their old order within a cell. */
rp_status dem_cells_sort(dem_sim *sim, double size);

/* Find the pairs of a rebuilding once the grains are there: grains of the pairs alone. Errors: RP_NO_MEMORY.
 */
rp_status dem_cells_find_pairs(dem_sim *sim);

/* The same, in the same order, where grains of very different size, or margin, lie among one another;
 * sizes.c. Cells of the widest pair then hold so many small grains that the plain search tests hundreds for
 * each. Here every grain is in the cells of its own size. Reads cell, listed positions and cutoffs; uses
 * held_slot of the grains. */
rp_status dem_sizes_find_pairs(dem_sim *sim);
void dem_sizes_free(struct dem_sizes *sizes);

#endif
