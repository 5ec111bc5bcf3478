/* Pairs of grains nearer than touching and their margins: one list of all arrays that have an entry for each.
 * A new array is a line of it. */
#ifndef DEM_PAIRS_H
#define DEM_PAIRS_H

#include "dem/dem.h"
#include "dem/state/vec.h"

/* How an entry survives a rebuilding of the neighbour list. */
typedef enum {
    DEM_MADE,       /* it is made anew from the grains, by list.c */
    DEM_SPRING_OF,  /* it stays with a pair that touches, and is 0 for others */
    DEM_SPRING_TURN /* the same, and changes its sign where i and j are exchanged */
} dem_pair_role;

/* Type, name, where it is needed (NULL elsewhere), entries that share one item, role.
 *
 * touching: a bit for each pair, lowest of a word first. radii: r_i + r_j. r_eff: r_i r_j/(r_i + r_j).
 * entry: of the definition's pairs. spring, roll: displacements of the shear and the rolling spring, 0
 * without touch. */
#define DEM_PAIR_ARRAYS(X)                                                                                   \
    X(uint32_t, i, true, 1, DEM_MADE)                                                                        \
    X(uint32_t, j, true, 1, DEM_MADE)                                                                        \
    X(uint64_t, touching, true, 64, DEM_MADE)                                                                \
    X(double, radii, !springs_only, 1, DEM_MADE)                                                             \
    X(double, m_eff, !springs_only, 1, DEM_MADE)                                                             \
    X(double, radius_i, rotation, 1, DEM_MADE)                                                               \
    X(double, radius_j, rotation, 1, DEM_MADE)                                                               \
    X(double, r_eff, !springs_only, 1, DEM_MADE)                                                             \
    X(uint32_t, entry, kinds && !springs_only, 1, DEM_MADE)                                                  \
    X(double, spring, true, 1, DEM_SPRING_OF)                                                                \
    X(double, roll, rolling, 1, DEM_SPRING_TURN)

typedef struct {
    bool rotation, rolling; /* the grains rotate; some contact resists rolling */
    bool kinds;             /* have coefficients of their own */
    bool springs_only;      /* pairs whose springs a rebuilding keeps */
    size_t n,
        capacity; /* up to the next multiple of 8 follow pairs of the last i with itself, not touching */
#define X(type, name, need, share, role) type *name;
    DEM_PAIR_ARRAYS(X)
#undef X
    /* where there are more pairs than a chunk, a multiple of 64, chunks of them: after chunk c, no pair is of
     * a grain below done[c]; n_chunks 0 where that is not known */
    size_t chunk, n_chunks, chunk_capacity;
    uint32_t *done;
} dem_pairs;

/* Have capacity for `more` pairs, and 8. Errors: RP_NO_MEMORY. */
rp_status dem_pairs_reserve(dem_pairs *pairs, size_t more);
void dem_pairs_free(dem_pairs *pairs);

/* Fill the last of the groups that kernels may take at once with pairs that never touch. */
void dem_pairs_pad(dem_pairs *pairs);

/* The last pair replaces pair k; `touching` is not valid then. */
void dem_pairs_remove(dem_pairs *pairs, size_t k);

/* Let pair k have the springs of pair l of others, where i and j are exchanged with `turned`. */
void dem_pairs_take_springs(dem_pairs *pairs, size_t k, const dem_pairs *others, size_t l, bool turned);

/* Append a copy of pair k of others. Errors: RP_NO_MEMORY. */
rp_status dem_pairs_append(dem_pairs *pairs, const dem_pairs *others, size_t k);

/* Divide the pairs of n grains into chunks, if there are enough. Errors: RP_NO_MEMORY. */
enum { DEM_LEAST_CHUNKS = 6 }; /* fewer fit into the cache together */
rp_status dem_pairs_plan_chunks(dem_pairs *pairs, size_t n);

/* For each chunk of a stretch of the pairs: no later one has a pair of the grains below done[c]; those of
 * `grains` alone count. */
void dem_pairs_find_done(const dem_pairs *pairs, dem_stretch of, dem_stretch grains, uint32_t *done);

static inline bool dem_pairs_are_many(const dem_pairs *pairs)
{
    return pairs->n > (DEM_LEAST_CHUNKS - 1) * pairs->chunk;
}

/* Put the bits of pairs k.. into an array that is filled from a multiple of 64 on; `word` is what its word
 * has so far. */
static inline void dem_note(uint64_t *array, size_t k, unsigned bits, uint64_t *word)
{
    *word = (k % 64 ? *word : 0) | (uint64_t)bits << k % 64;
    array[k / 64] = *word;
}

static inline bool dem_touches(const dem_pairs *pairs, size_t k)
{
    return pairs->touching[k / 64] >> k % 64 & 1;
}

/* Of the pairs below k, a multiple of 64 or their number; of all. */
static inline size_t dem_count_touching_below(const dem_pairs *pairs, size_t k)
{
    size_t n = 0;
    for (size_t w = 0; 64 * w < k; w++) n += (size_t)__builtin_popcountll(pairs->touching[w]);
    return n;
}

static inline size_t dem_count_touching(const dem_pairs *pairs)
{
    return dem_count_touching_below(pairs, pairs->n);
}

/* For each pair k that touches, of all or of those from..to, `from` a multiple of 64. `break` does not end
 * it.
 */
#define DEM_EACH_TOUCHING(pairs, k) DEM_EACH_TOUCHING_OF(pairs, 0, (pairs)->n, k)
#define DEM_EACH_TOUCHING_OF(pairs, from, to, k)                                                             \
    for (size_t word_ = (from) / 64, k; 64 * word_ < (to); word_++)                                          \
        for (uint64_t bits_ = (pairs)->touching[word_];                                                      \
             bits_ && (k = 64 * word_ + (size_t)__builtin_ctzll(bits_), true); bits_ &= bits_ - 1)

#endif
