/* Search for pairs by square cells, which wrap around, so that no scene is too large. */
#include <math.h>
#include <string.h>

#include "dem/list/list.h"
#include "dem/threads/threads.h"

enum { MOST_CELLS = 1 << 14 }; /* in a row at the start */

static size_t power_of_two(double at_least, size_t most)
{
    size_t p = 4; /* three neighbouring columns must differ */
    while ((double)p < at_least && p < most) p *= 2;
    return p;
}

void dem_cells_choose(const dem_sim *sim, double size, dem_cells *cells)
{
    double lo[2] = {INFINITY, INFINITY}, hi[2] = {-INFINITY, -INFINITY};
    for (size_t i = 0; i < sim->grains.n; i++)
        for (int a = 0; a < 2; a++) {
            lo[a] = fmin(lo[a], sim->grains.motion[i].x[a]);
            hi[a] = fmax(hi[a], sim->grains.motion[i].x[a]);
        }
    cells->columns = power_of_two((hi[0] - lo[0]) / size + 2.0, MOST_CELLS);
    cells->rows = power_of_two((hi[1] - lo[1]) / size + 2.0, MOST_CELLS);
    while (cells->columns * cells->rows > 4 * sim->grains.n + 64 && (cells->columns > 4 || cells->rows > 4))
        if (cells->columns > cells->rows)
            cells->columns /= 2;
        else
            cells->rows /= 2;
}

bool dem_cells_are_possible(const dem_cells *cells, size_t grains)
{
    return power_of_two((double)cells->columns, MOST_CELLS) == cells->columns &&
           power_of_two((double)cells->rows, MOST_CELLS) == cells->rows &&
           cells->columns * cells->rows <= 4 * grains + 64;
}

static rp_status find_cells(dem_sim *sim, dem_part *part)
{
    const dem_cells *cells = &sim->list.work->cells;
    const double inverse_size = 1.0 / cells->size;
    for (size_t i = part->from; i < part->to; i++) {
        dem_vec x = sim->grains.motion[i].x;
        if (dem_beyond(sim, x)) {
            sim->grains.cell[i] = DEM_NOWHERE;
            continue;
        }
        size_t cx = (size_t)(long)floor(x[0] * inverse_size) & (cells->columns - 1);
        size_t cy = (size_t)(long)floor(x[1] * inverse_size) & (cells->rows - 1);
        sim->grains.cell[i] = (uint32_t)(cy * cells->columns + cx);
    }
    return RP_OK;
}

rp_status dem_cells_sort(dem_sim *sim, double size)
{
    dem_cells *const cells = &sim->list.work->cells;
    const size_t n_cells = cells->columns * cells->rows;
    cells->size = size;
    RP_TRY(dem_threads_do(sim, find_cells, sim->grains.n, 1));
    memset(cells->start, 0, (n_cells + 1) * sizeof *cells->start);
    for (size_t i = 0; i < sim->grains.n; i++)
        if (sim->grains.cell[i] != DEM_NOWHERE) cells->start[sim->grains.cell[i] + 1]++;
    cells->squares = 0;
    for (size_t c = 0; c < n_cells; c++) {
        const size_t n = cells->start[c + 1];
        cells->squares += n * n;
        cells->start[c + 1] += cells->start[c];
    }
    for (size_t i = 0; i < sim->grains.n; i++) {
        if (sim->grains.cell[i] == DEM_NOWHERE) {
            sim->grains.moved_to[i] = DEM_NOWHERE;
            continue;
        }
        /* start moves up as its cell fills, and is moved back below */
        sim->grains.moved_to[i] = cells->start[sim->grains.cell[i]]++;
    }
    for (size_t c = n_cells; c > 0; c--) cells->start[c] = cells->start[c - 1];
    cells->start[0] = 0;
    return RP_OK;
}

/* The first cell whose grains begin at `grain` or behind. */
static size_t first_cell(const dem_cells *cells, size_t grain)
{
    size_t low = 0;
    for (size_t high = cells->columns * cells->rows; low < high;) {
        const size_t middle = (low + high) / 2;
        if (cells->start[middle] < grain)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

/* Pairs of the grains of each cell with those after them, and with those of the next cell and of the three
 * above; cells that follow one another are taken as one. */
static rp_status append_cells(dem_sim *sim, dem_part *part)
{
    const dem_cells *cells = &sim->list.work->cells;
    const size_t mask_x = cells->columns - 1, n_cells = cells->columns * cells->rows,
                 last = first_cell(cells, part->to);
    dem_threads_collect(sim, part);
    for (size_t c = first_cell(cells, part->from); c < last; c++) {
        const size_t cx = c & mask_x, row = c - cx, up = (row + cells->columns) & (n_cells - 1);
        const size_t half[4] = {row + ((cx + 1) & mask_x), up + ((cx - 1) & mask_x), up + cx,
                                up + ((cx + 1) & mask_x)};
        size_t from[5] = {0}, to[5] = {cells->start[c + 1]}, n = 1, most = to[0] - cells->start[c];
        for (int a = 0; a < 4; a++) {
            const size_t first = cells->start[half[a]], end = cells->start[half[a] + 1];
            most += end - first;
            if (first != to[n - 1]) from[n++] = first;
            to[n - 1] = end;
        }
        for (size_t i = cells->start[c]; i < cells->start[c + 1]; i++) {
            RP_TRY(dem_pairs_reserve(&sim->pairs, most));
            sim->loops.append(sim, i, i + 1, to[0]);
            for (size_t a = 1; a < n; a++) sim->loops.append(sim, i, from[a], to[a]);
        }
    }
    return RP_OK;
}

rp_status dem_cells_find_pairs(dem_sim *sim)
{
    const dem_cells *cells = &sim->list.work->cells;
    const double tests = 4.5 * (double)cells->squares; /* of half of the grains in nine cells */
    if (tests <= sim->list.most_tests * (double)sim->grains.n) {
        RP_TRY(dem_threads_do(sim, append_cells, sim->grains.n, 1));
        return dem_threads_gather(sim);
    }
    /* cells that hold many grains are searched by cells of the grains' own sizes */
    for (uint32_t c = 0; c < cells->columns * cells->rows; c++)
        for (size_t i = cells->start[c]; i < cells->start[c + 1]; i++) sim->grains.cell[i] = c;
    return dem_sizes_find_pairs(sim);
}
