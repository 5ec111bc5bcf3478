/* The arrays of the pairs; see pairs.h. */
#include "dem/state/pairs.h"

#include <stdlib.h>
#include <string.h>

#include "dem/state/grains.h"

rp_status dem_pairs_reserve(dem_pairs *pairs, size_t more)
{
    if (pairs->n + more + 8 <= pairs->capacity) return RP_OK;
    const bool rotation = pairs->rotation, rolling = pairs->rolling, kinds = pairs->kinds,
               springs_only = pairs->springs_only;
    const size_t n = pairs->n, capacity = pairs->capacity = 9 * (pairs->n + more) / 512 * 64 + 128;
#define X(type, name, need, share, role)                                                                     \
    if ((need) && !dem_array_grow(&pairs->name, sizeof(type), (n + share - 1) / share, capacity / share))    \
        return rp_fail(RP_NO_MEMORY, "neighbour list: out of memory");
    DEM_PAIR_ARRAYS(X)
#undef X
    return RP_OK;
}

void dem_pairs_free(dem_pairs *pairs)
{
    free(pairs->done);
#define X(type, name, need, share, role) free(pairs->name);
    DEM_PAIR_ARRAYS(X)
#undef X
}

void dem_pairs_pad(dem_pairs *pairs)
{
    const uint32_t last = pairs->n > 0 ? pairs->i[pairs->n - 1] : 0;
    for (size_t k = pairs->n; k < (pairs->n + 7) / 8 * 8; k++) {
#define X(type, name, need, share, role)                                                                     \
    if (share == 1 && pairs->name) pairs->name[k] = 0;
        DEM_PAIR_ARRAYS(X)
#undef X
        pairs->i[k] = pairs->j[k] = last;
    }
}

void dem_pairs_remove(dem_pairs *pairs, size_t k)
{
    const size_t last = --pairs->n;
#define X(type, name, need, share, role)                                                                     \
    if (share == 1 && pairs->name) pairs->name[k] = pairs->name[last];
    DEM_PAIR_ARRAYS(X)
#undef X
}

void dem_pairs_take_springs(dem_pairs *pairs, size_t k, const dem_pairs *others, size_t l, bool turned)
{
#define X(type, name, need, share, role)                                                                     \
    if (role != DEM_MADE && pairs->name)                                                                     \
        pairs->name[k] = role == DEM_SPRING_TURN && turned ? -others->name[l] : others->name[l];
    DEM_PAIR_ARRAYS(X)
#undef X
}

rp_status dem_pairs_append(dem_pairs *pairs, const dem_pairs *others, size_t k)
{
    RP_TRY(dem_pairs_reserve(pairs, 1));
#define X(type, name, need, share, role)                                                                     \
    if (share == 1 && pairs->name) pairs->name[pairs->n] = others->name[k];
    DEM_PAIR_ARRAYS(X)
#undef X
    pairs->n++;
    return RP_OK;
}

/* A grain is done where no pair of a later chunk has it. After cells wrapped around, or as pairs have been
 * renamed, that may be so of few before the end. */
void dem_pairs_find_done(const dem_pairs *pairs, dem_stretch of, dem_stretch grains, uint32_t *done)
{
    const size_t first = grains.from;
    uint32_t least = (uint32_t)grains.to;
    for (size_t c = (of.to - of.from + pairs->chunk - 1) / pairs->chunk, end = of.to; c-- > 0;) {
        const size_t start = of.from + c * pairs->chunk;
        done[c] = end == of.to ? least : least / DEM_GROUP * DEM_GROUP;
        for (size_t k = start; k < end; k++) {
            const uint32_t i = pairs->i[k], j = pairs->j[k];
            least = i >= first && i < least ? i : least;
            least = j >= first && j < least ? j : least;
        }
        end = start;
    }
}

rp_status dem_pairs_plan_chunks(dem_pairs *pairs, size_t n)
{
    const size_t chunks = (pairs->n + pairs->chunk - 1) / pairs->chunk;
    pairs->n_chunks = 0;
    if (!dem_pairs_are_many(pairs)) return RP_OK;
    RP_TRY(dem_room("neighbour list", &pairs->done, sizeof *pairs->done, chunks, &pairs->chunk_capacity));
    dem_pairs_find_done(pairs, (dem_stretch){0, pairs->n}, (dem_stretch){0, n}, pairs->done);
    pairs->n_chunks = chunks;
    return RP_OK;
}
