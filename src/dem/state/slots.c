/* The arrays of the walls and of their slots; see slots.h. */
#include "dem/state/slots.h"

#include <stdlib.h>
#include <string.h>

rp_status dem_walls_alloc(dem_walls *w, size_t n)
{
    w->capacity = w->n_slots + 1;
    w->slot = malloc(w->capacity * sizeof *w->slot);
    w->start = calloc(n + 1, sizeof *w->start);
    w->next = calloc(n + 1, sizeof *w->next);
    w->wall = calloc(n + 1, sizeof *w->wall);
    w->force = calloc(n + 1, sizeof *w->force);
    w->mu = calloc(n + 1, sizeof *w->mu);
    w->line = calloc(n + 1, sizeof *w->line);
    if (!w->slot || !w->start || !w->next || !w->wall || !w->force || !w->mu || !w->line)
        return rp_fail(RP_NO_MEMORY, "%zu walls: out of memory", n);
    return RP_OK;
}

rp_status dem_walls_copy(const dem_walls *walls, size_t n, dem_walls *copy)
{
    *copy = *walls;
    dem_walls_forget(copy);
    RP_TRY(dem_walls_alloc(copy, n));
    if (walls->n_slots) memcpy(copy->slot, walls->slot, walls->n_slots * sizeof *copy->slot);
    memcpy(copy->start, walls->start, (n + 1) * sizeof *copy->start);
    memcpy(copy->next, walls->next, n * sizeof *copy->next);
    memcpy(copy->wall, walls->wall, n * sizeof *copy->wall);
    memcpy(copy->force, walls->force, n * sizeof *copy->force);
    memcpy(copy->mu, walls->mu, n * sizeof *copy->mu);
    memcpy(copy->line, walls->line, n * sizeof *copy->line);
    return RP_OK;
}

void dem_walls_forget(dem_walls *walls)
{
    walls->slot = NULL, walls->start = walls->next = NULL, walls->wall = NULL;
    walls->force = NULL, walls->mu = NULL, walls->line = NULL;
}

void dem_walls_free(dem_walls *walls)
{
    free(walls->slot), free(walls->start), free(walls->next), free(walls->wall);
    free(walls->force), free(walls->mu), free(walls->line);
}

void dem_walls_find_starts(dem_walls *walls, size_t n)
{
    for (size_t w = 0, k = 0; w <= n; w++) {
        while (k < walls->n_slots && walls->slot[k].wall < w) k++;
        walls->start[w] = k;
    }
}
