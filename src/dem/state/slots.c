/* The arrays of the walls and of their slots; see slots.h. */
#include "dem/state/slots.h"

#include <stdlib.h>
#include <string.h>

rp_status dem_walls_alloc(dem_walls *w, size_t n)
{
    w->capacity = w->n_slots + 1;
    w->slot = malloc(w->capacity * sizeof *w->slot);
    bool good = w->slot != NULL;
#define X(type, name) good &= (w->name = calloc(n + 1, sizeof(type))) != NULL;
    DEM_WALL_ARRAYS(X)
#undef X
    return good ? RP_OK : rp_fail(RP_NO_MEMORY, "%zu walls: out of memory", n);
}

void dem_walls_free(dem_walls *walls)
{
    free(walls->slot);
#define X(type, name) free(walls->name);
    DEM_WALL_ARRAYS(X)
#undef X
}

void dem_walls_link(dem_walls *walls, size_t n, size_t n_grains, uint32_t *last)
{
    for (size_t w = 0, k = 0; w <= n; w++) {
        while (k < walls->n_slots && walls->slot[k].wall < w) k++;
        walls->start[w] = k;
    }
    memset(last, 0xff, n_grains * sizeof *last);
    for (uint32_t k = 0; k < walls->n_slots; k++) {
        dem_wall_slot *slot = &walls->slot[k];
        uint32_t *before = &last[slot->grain];
        slot->next = k & INT32_MAX;
        if (*before != UINT32_MAX) {
            slot->next = walls->slot[*before].next;
            walls->slot[*before].next = k & INT32_MAX;
        }
        *before = k;
        slot->leads = !dem_wall_is_line(&walls->wall[slot->wall]);
        for (size_t o = slot->next; o != k; o = walls->slot[o].next)
            slot->leads &= dem_wall_is_line(&walls->wall[walls->slot[o].wall]);
    }
}
