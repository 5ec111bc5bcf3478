/* Search for pairs by cells of each size; see list.h.
 *
 * Level 0 has the cells of the plain search, as wide as the widest pair; each further level has cells of half
 * the width. A grain is in the narrowest cells that are at least as wide as its pair with an equal. It looks
 * for others of its level in half of the neighbouring cells, and for smaller ones in all cells within reach.
 * Copies of what the search reads are sorted by level and cell, so that cells side by side are tested in one
 * go. The pairs found are then brought into the order of the plain search. */
#include "dem/list/list.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dem/threads/threads.h"

enum { LEVELS = 12 };

struct dem_sizes {
    size_t columns, rows; /* of the plain search */
    const uint32_t *cell; /* of each grain, there */
    size_t levels;
    double width[LEVELS], inverse_width[LEVELS]; /* of the cells of each level */
    size_t first_cell[LEVELS + 1];               /* of each level; the number of all cells */
    size_t first[LEVELS + 1];                    /* sorted grain of each level; the number of grains */
    uint32_t *start;                             /* sorted grain of each cell; the number of grains */
    size_t start_capacity;
    /* by sorted number; listed_x, cutoff and inverse_mass of the grains, padded as kernels need it */
    uint32_t *grain;
    dem_vec *x;
    double *cutoff, *inverse_mass;
    size_t capacity;
    uint64_t *key; /* of the pairs: order of the second grains of a first one, lower half: the second grain */
    size_t key_capacity;
};

static rp_status no_memory(void)
{
    return rp_fail(RP_NO_MEMORY, "neighbour list: out of memory");
}

void dem_sizes_free(struct dem_sizes *z)
{
    if (!z) return;
    free(z->start), free(z->grain), free(z->x), free(z->cutoff), free(z->inverse_mass), free(z->key);
    free(z);
}

static rp_status reserve_grains(struct dem_sizes *z, size_t n)
{
    if (n <= z->capacity) return RP_OK;
    free(z->grain), free(z->x), free(z->cutoff), free(z->inverse_mass);
    z->capacity = n;
    z->grain = dem_array(n + 8, sizeof *z->grain);
    z->x = dem_array(n + 8, sizeof *z->x);
    z->cutoff = dem_array(n + 8, sizeof *z->cutoff);
    z->inverse_mass = dem_array(n + 8, sizeof *z->inverse_mass);
    if (z->grain && z->x && z->cutoff && z->inverse_mass) return RP_OK;
    z->capacity = 0;
    return no_memory();
}

/* As many levels as the smallest grain needs, of no more than some two cells a grain. */
static rp_status choose_levels(struct dem_sizes *z, const dem_sim *sim)
{
    const dem_cells *cells = &sim->list.work->cells;
    size_t n = cells->columns * cells->rows, level = 0;
    z->columns = cells->columns, z->rows = cells->rows;
    z->cell = sim->grains.cell;
    z->first_cell[0] = 0;
    for (double width = cells->size;; width *= 0.5, n *= 4) {
        z->width[level] = width;
        z->inverse_width[level] = 1.0 / width;
        z->first_cell[level + 1] = z->first_cell[level] + n;
        level++;
        if (level == LEVELS || 4 * n > 2 * sim->grains.n || width < 4.0 * sim->r_min) break;
    }
    z->levels = level;
    return dem_room("neighbour list", &z->start, sizeof *z->start, z->first_cell[level] + 1,
                    &z->start_capacity);
}

/* The column or row of a level in which a coordinate is. */
static long cell_at(const struct dem_sizes *z, double x, size_t level)
{
    return (long)floor(x * z->inverse_width[level]);
}

/* The level of a grain: of cells a little wider than its pair with an equal, so that rounding of a cell does
 * not matter. */
static size_t level_of(const struct dem_sizes *z, double cutoff)
{
    const int level = ilogb(0.499 * z->width[0] / cutoff);
    return level < 0 ? 0 : (size_t)level < z->levels ? (size_t)level : z->levels - 1;
}

/* Columns and rows of a level, less one. */
static size_t mask_x(const struct dem_sizes *z, size_t level)
{
    return (z->columns << level) - 1;
}

static size_t mask_y(const struct dem_sizes *z, size_t level)
{
    return (z->rows << level) - 1;
}

/* Number of the first cell of a row. */
static size_t row_start(const struct dem_sizes *z, size_t level, long row)
{
    return z->first_cell[level] + ((size_t)row & mask_y(z, level)) * (mask_x(z, level) + 1);
}

/* Sort the grains by level and cell. */
static void sort_grains(struct dem_sizes *z, const dem_sim *sim)
{
    const dem_grains *g = &sim->grains;
    uint32_t *const cell = g->held_slot, *const start = z->start;
    const size_t cells = z->first_cell[z->levels];
    memset(start, 0, (cells + 1) * sizeof *start);
    for (size_t i = 0; i < g->n; i++) {
        const size_t level = level_of(z, g->cutoff[i]);
        const long column = cell_at(z, g->listed_x[i][0], level), row = cell_at(z, g->listed_x[i][1], level);
        cell[i] = (uint32_t)(row_start(z, level, row) + ((size_t)column & mask_x(z, level)));
        start[cell[i] + 1]++;
    }
    for (size_t c = 0; c < cells; c++) start[c + 1] += start[c];
    for (size_t level = 0; level <= z->levels; level++) z->first[level] = start[z->first_cell[level]];
    for (size_t i = 0; i < g->n; i++) {
        const uint32_t p = start[cell[i]]++; /* moved back below */
        z->grain[p] = (uint32_t)i;
        z->x[p] = g->listed_x[i];
        z->cutoff[p] = g->cutoff[i];
        z->inverse_mass[p] = g->inverse_mass[i];
    }
    memmove(start + 1, start, cells * sizeof *start);
    start[0] = 0;
}

/* Append the pairs of sorted grain p with those from..end. */
static rp_status append(dem_sim *sorted, size_t p, size_t from, size_t end)
{
    if (from >= end) return RP_OK;
    RP_TRY(dem_pairs_reserve(&sorted->pairs, end - from));
    sorted->loops.append(sorted, p, from, end);
    return RP_OK;
}

/* Cells of a row, from one column to another. */
typedef struct {
    size_t level;
    long row, from, to;
} cell_row;

/* With those of a row of cells; of the first cell, those from `least` on. */
static rp_status append_row(dem_sim *sorted, size_t p, cell_row r, size_t least)
{
    const struct dem_sizes *z = sorted->list.sizes;
    const size_t mask = mask_x(z, r.level), first = (size_t)r.from & mask, last = (size_t)r.to & mask;
    const uint32_t *start = z->start + row_start(z, r.level, r.row);
    const size_t begin = start[first] > least ? start[first] : least;
    if (first <= last) return append(sorted, p, begin, start[last + 1]);
    RP_TRY(append(sorted, p, begin, start[mask + 1]));
    return append(sorted, p, start[0], start[last + 1]);
}

/* Pairs of sorted grain p with those behind it of its level, and with smaller ones. */
static rp_status append_grain(dem_sim *sorted, size_t p, size_t level)
{
    const struct dem_sizes *z = sorted->list.sizes;
    const dem_vec x = z->x[p];
    const long column = cell_at(z, x[0], level), row = cell_at(z, x[1], level);
    RP_TRY(append_row(sorted, p, (cell_row){level, row, column, column + 1}, p + 1));
    RP_TRY(append_row(sorted, p, (cell_row){level, row + 1, column - 1, column + 1}, 0));
    for (size_t l = level + 1; l < z->levels; l++) {
        if (z->first[l] == z->first[l + 1]) continue;
        const double reach = z->cutoff[p] + 0.501 * z->width[l];
        const long left = cell_at(z, x[0] - reach, l), right = cell_at(z, x[0] + reach, l),
                   top = cell_at(z, x[1] + reach, l);
        for (long r = cell_at(z, x[1] - reach, l); r <= top; r++)
            RP_TRY(append_row(sorted, p, (cell_row){l, r, left, right}, 0));
    }
    return RP_OK;
}

/* The part's share of the sorted grains. */
static rp_status find_part(dem_sim *sim, dem_part *part)
{
    const struct dem_sizes *z = sim->list.sizes;
    rp_status status = RP_OK;
    dem_threads_collect(sim, part);
    dem_sim sorted = *sim;
    sorted.grains.listed_x = z->x;
    sorted.grains.cutoff = z->cutoff;
    sorted.grains.inverse_mass = z->inverse_mass;
    for (size_t p = part->from, level = 0; p < part->to && !status; p++) {
        while (p >= z->first[level + 1]) level++;
        status = append_grain(&sorted, p, level);
    }
    sim->pairs = sorted.pairs;
    return status;
}

/* Place of grain b's cell about grain a's in the order of the plain search: 1 the same, 2 the next, 3 to 5
 * above; 0 those that it searches from b. */
static unsigned place(const struct dem_sizes *z, uint32_t a, uint32_t b)
{
    const size_t m = mask_x(z, 0), shift = (size_t)__builtin_ctzl(z->columns), from = z->cell[a],
                 to = z->cell[b];
    const size_t dx = (to - from + 1) & m, dy = ((to >> shift) - (from >> shift)) & mask_y(z, 0);
    return (unsigned)((3 * dy + dx) * ((dy < 2) & (dx < 3)));
}

/* Name the grains of the pairs, in the order of each pair. */
static rp_status name_part(dem_sim *sim, dem_part *part)
{
    const struct dem_sizes *z = sim->list.sizes;
    for (size_t k = part->from; k < part->to; k++) {
        const uint32_t a = z->grain[sim->pairs.i[k]], b = z->grain[sim->pairs.j[k]];
        const unsigned at = place(z, a, b);
        const bool turned = (at == 0) | ((at == 1) & (b < a));
        sim->pairs.i[k] = turned ? b : a;
        sim->pairs.j[k] = turned ? a : b;
    }
    return RP_OK;
}

/* Sort the pairs of the part's share of the grains; their keys are together already, up to held_slot. */
static rp_status order_part(dem_sim *sim, dem_part *part)
{
    const size_t from = part->from, end = part->to;
    uint64_t *const key = sim->list.sizes->key;
    const uint32_t *until = sim->grains.held_slot;
    for (size_t i = from, k = i > 0 ? until[i - 1] : 0; i < end; i++)
        for (const size_t first = k; k < until[i]; k++) {
            const uint64_t one = key[k];
            size_t at = k;
            for (; at > first && key[at - 1] > one; at--) key[at] = key[at - 1];
            key[at] = one;
            sim->pairs.i[k] = (uint32_t)i;
        }
    for (size_t k = from > 0 ? until[from - 1] : 0; end > 0 && k < until[end - 1]; k++)
        sim->pairs.j[k] = (uint32_t)key[k];
    return RP_OK;
}

/* Order the pairs by their first grains. */
static rp_status order_pairs(dem_sim *sim)
{
    struct dem_sizes *z = sim->list.sizes;
    uint32_t *const start = sim->grains.held_slot, n = 0;
    RP_TRY(dem_threads_do(sim, name_part, sim->pairs.n, 1));
    RP_TRY(dem_room("neighbour list", &z->key, sizeof *z->key, sim->pairs.n, &z->key_capacity));
    memset(start, 0, sim->grains.n * sizeof *start);
    for (size_t k = 0; k < sim->pairs.n; k++) start[sim->pairs.i[k]]++;
    for (size_t i = 0; i < sim->grains.n; i++) {
        const uint32_t own = start[i];
        start[i] = n;
        n += own;
    }
    for (size_t k = 0; k < sim->pairs.n; k++) {
        const uint32_t i = sim->pairs.i[k], j = sim->pairs.j[k];
        z->key[start[i]++] = (uint64_t)place(z, i, j) << 32 | j;
    }
    return dem_threads_do(sim, order_part, sim->grains.n, 1);
}

rp_status dem_sizes_find_pairs(dem_sim *sim)
{
    if (!sim->list.sizes && !(sim->list.sizes = calloc(1, sizeof *sim->list.sizes))) return no_memory();
    struct dem_sizes *z = sim->list.sizes;
    RP_TRY(reserve_grains(z, sim->grains.capacity));
    RP_TRY(choose_levels(z, sim));
    sort_grains(z, sim);
    RP_TRY(dem_threads_do(sim, find_part, sim->grains.n, 1));
    RP_TRY(dem_threads_gather(sim));
    return order_pairs(sim);
}
