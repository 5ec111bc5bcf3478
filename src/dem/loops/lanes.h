/* Eight or four doubles as one value, as many as the instructions hold that the including file asks for with
 * `#pragma GCC target`. Operators act on each number by itself and round as they do for one number, so that
 * every width gives the same bits. Shuffles are written once, by the index of each number; the rest depends
 * on the instructions. */
#ifndef DEM_SIMD_H
#define DEM_SIMD_H

#include <immintrin.h>

#include "dem/state/state.h"

#if WIDE_BITS == 512
enum { WIDTH = 8 };
typedef __m512d wide;
typedef __m512d_u wide_unaligned;
typedef __mmask8 lanes; /* a truth value for each number */
#define WIDE_INDEX         ((__m512i){0, 1, 2, 3, 4, 5, 6, 7})
#define WIDE_PD(operation) _mm512_##operation##_pd
#else /* AVX2 */
enum { WIDTH = 4 };
typedef __m256d wide;
typedef __m256d_u wide_unaligned;
typedef __m256d lanes;
#define WIDE_INDEX         ((__m256i){0, 1, 2, 3})
#define WIDE_PD(operation) _mm256_##operation##_pd
#endif
#define WIDE_ODD (WIDE_INDEX & 1)

#ifdef __clang__ /* has no shuffle by a vector of indices; these loops become one */
static inline wide wide_shuffle(wide a, wide b, __typeof__(WIDE_INDEX) from)
{
    wide result;
    for (int i = 0; i < WIDTH; i++) result[i] = from[i] < WIDTH ? a[from[i]] : b[from[i] - WIDTH];
    return result;
}
#else
#define wide_shuffle __builtin_shuffle
#endif

static inline wide wide_load(const double *from)
{
    return *(const wide_unaligned *)from;
}

static inline void wide_store(double *to, wide a)
{
    *(wide_unaligned *)to = a;
}

static inline wide num_of(double a)
{
    return a - (wide){0};
}

/* A wide also holds WIDTH/2 vectors of the plane, (a0, a1), (a2, a3), ... The first numbers of the vectors of
 * a, each followed by that of b; the second numbers; the even vectors of a, then of b; the odd vectors. */
static inline wide wide_zip_firsts(wide a, wide b)
{
    return wide_shuffle(a, b, WIDE_INDEX - WIDE_ODD + WIDE_ODD * WIDTH);
}

static inline wide wide_zip_seconds(wide a, wide b)
{
    return wide_shuffle(a, b, WIDE_INDEX - WIDE_ODD + WIDE_ODD * WIDTH + 1);
}

static inline wide wide_evens(wide a, wide b)
{
    return wide_shuffle(a, b, 2 * WIDE_INDEX - WIDE_ODD);
}

static inline wide wide_odds(wide a, wide b)
{
    return wide_shuffle(a, b, 2 * WIDE_INDEX - WIDE_ODD + 2);
}

/* The first number of each vector of a, then of b; the second numbers. */
static inline wide wide_firsts(wide a, wide b)
{
    return wide_shuffle(a, b, 2 * WIDE_INDEX);
}

static inline wide wide_seconds(wide a, wide b)
{
    return wide_shuffle(a, b, 2 * WIDE_INDEX + 1);
}

/* (y, x) of each vector. */
static inline wide wide_swap(wide a)
{
    return wide_shuffle(a, a, WIDE_INDEX ^ 1);
}

/* WIDTH/2 records of two vectors. */
static inline void wide_load_records(const dem_motion *from, wide *x, wide *v)
{
    const wide a = wide_load((const double *)from), b = wide_load((const double *)from + WIDTH);
    *x = wide_evens(a, b);
    *v = wide_odds(a, b);
}

static inline void wide_store_records(void *to, wide x, wide v)
{
    const __typeof__(WIDE_INDEX) low = WIDE_INDEX / 2 % 2 * WIDTH + WIDE_INDEX / 4 * 2 + WIDE_ODD;
    wide_store(to, wide_shuffle(x, v, low));
    wide_store((double *)to + WIDTH, wide_shuffle(x, v, low + WIDTH / 2));
}

/* The vectors (x, y). */
static inline void wide_store_vectors(dem_vec to[WIDTH], wide x, wide y)
{
    const __typeof__(WIDE_INDEX) low = WIDE_INDEX / 2 + WIDE_ODD * WIDTH;
    wide_store((double *)to, wide_shuffle(x, y, low));
    wide_store((double *)(to + WIDTH / 2), wide_shuffle(x, y, low + WIDTH / 2));
}

/* WIDTH/2 numbers, each twice; reads WIDTH. */
static inline wide wide_load_twice(const double *from)
{
    const wide a = wide_load(from);
    return wide_shuffle(a, a, WIDE_INDEX / 2);
}

static inline wide num_sqrt(wide a)
{
    return WIDE_PD(sqrt)(a);
}

/* a where a > b, else b */
static inline wide num_max(wide a, wide b)
{
    return WIDE_PD(max)(a, b);
}

#if WIDE_BITS == 512
static inline lanes wide_less(wide a, wide b)
{
    return _mm512_cmp_pd_mask(a, b, _CMP_LT_OQ);
}

static inline lanes wide_at_most(wide a, wide b)
{
    return _mm512_cmp_pd_mask(a, b, _CMP_LE_OQ);
}

static inline unsigned wide_bits(lanes l)
{
    return l;
}

static inline wide num_choose(lanes l, wide yes, wide no)
{
    return _mm512_mask_blend_pd(l, no, yes);
}

/* a, or what has its sign and the magnitude `most` where that is less; which these are. Of NaN some become
 * `most`. */
static inline wide num_limit(wide a, wide most, lanes *less)
{
    const wide limited = _mm512_range_pd(a, most, 2);
    *less = _mm512_cmp_pd_mask(limited, a, _CMP_NEQ_UQ);
    return limited;
}

/* Append `first` + the index of each bit that is set; writes WIDTH numbers whatever their count. */
static inline size_t wide_append(uint32_t *list, size_t n, unsigned bits, size_t first)
{
    const __m256i index = _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7);
    __m256i k = _mm256_add_epi32(index, _mm256_set1_epi32((int)first));
    _mm256_storeu_si256((__m256i *)(list + n), _mm256_maskz_compress_epi32((__mmask8)bits, k));
    return n + (size_t)__builtin_popcount(bits);
}

/* Which of WIDTH indices are this one. */
static inline unsigned index_equals(const uint32_t *index, uint32_t one)
{
    return _mm256_cmpeq_epi32_mask(_mm256_loadu_si256((const __m256i *)index), _mm256_set1_epi32((int)one));
}

/* from[stride index[]] */
static inline wide wide_gather(const double *from, const uint32_t *index, int stride)
{
    __m256i at = _mm256_mullo_epi32(_mm256_loadu_si256((const __m256i *)index), _mm256_set1_epi32(stride));
    return _mm512_i32gather_pd(at, from, 8);
}

static inline wide wide_repeat(dem_vec a)
{
    return _mm512_broadcast_f64x2(a);
}

/* Forces and torques (x, y, torque); the fourth number is arbitrary. */
static inline void wide_store_force_torques(dem_force_torque to[WIDTH], wide x, wide y, wide torque)
{
    for (int p = 0; p < 8; p += 2) {
        const __m512i xy = _mm512_setr_epi64(p, p + 8, p, p, p + 1, p + 9, p, p),
                      third = _mm512_setr_epi64(p, p, p, p, p, p, p + 1, p);
        wide_store((double *)(to + p),
                   _mm512_mask_permutexvar_pd(_mm512_permutex2var_pd(x, xy, y), 0x44, third, torque));
    }
}

/* Record i[0], followed by record i[2]. */
static inline wide wide_load_record(const dem_motion *grain, const uint32_t *i)
{
    return _mm512_insertf64x4(_mm512_castpd256_pd512(_mm256_load_pd((const double *)&grain[i[0]])),
                              _mm256_load_pd((const double *)&grain[i[2]]), 1);
}

#else
static inline lanes wide_less(wide a, wide b)
{
    return _mm256_cmp_pd(a, b, _CMP_LT_OQ);
}

static inline lanes wide_at_most(wide a, wide b)
{
    return _mm256_cmp_pd(a, b, _CMP_LE_OQ);
}

static inline unsigned wide_bits(lanes l)
{
    return (unsigned)_mm256_movemask_pd(l);
}

static inline wide num_choose(lanes l, wide yes, wide no)
{
    return _mm256_blendv_pd(no, yes, l);
}

static inline wide num_limit(wide a, wide most, lanes *less)
{
    const wide mask = _mm256_set1_pd(-0.0);
    *less = wide_less(most, _mm256_andnot_pd(mask, a));
    return num_choose(*less, _mm256_or_pd(_mm256_and_pd(mask, a), most), a);
}

static inline size_t wide_append(uint32_t *list, size_t n, unsigned bits, size_t first)
{
    for (size_t p = 0; p < WIDTH; p++) {
        list[n] = (uint32_t)(first + p);
        n += bits >> p & 1;
    }
    return n;
}

static inline unsigned index_equals(const uint32_t *index, uint32_t one)
{
    const __m128i same = _mm_cmpeq_epi32(_mm_loadu_si128((const __m128i *)index), _mm_set1_epi32((int)one));
    return (unsigned)_mm_movemask_ps(_mm_castsi128_ps(same));
}

static inline wide wide_gather(const double *from, const uint32_t *index, int stride)
{
    __m128i at = _mm_mullo_epi32(_mm_loadu_si128((const __m128i *)index), _mm_set1_epi32(stride));
    return _mm256_i32gather_pd(from, at, 8);
}

static inline wide wide_repeat(dem_vec a)
{
    return _mm256_set_m128d(a, a);
}

static inline void wide_store_force_torques(dem_force_torque to[WIDTH], wide x, wide y, wide torque)
{
    const wide even = wide_zip_firsts(x, y), odd = wide_zip_seconds(x, y),
               t_even = wide_zip_firsts(torque, torque), t_odd = wide_zip_seconds(torque, torque);
    wide_store((double *)to, wide_evens(even, t_even));
    wide_store((double *)(to + 1), wide_evens(odd, t_odd));
    wide_store((double *)(to + 2), wide_odds(even, t_even));
    wide_store((double *)(to + 3), wide_odds(odd, t_odd));
}

static inline wide wide_load_record(const dem_motion *grain, const uint32_t *i)
{
    return _mm256_load_pd((const double *)&grain[i[0]]);
}
#endif

/* Positions and velocities of grains i[] relative to grains j[]. */
static inline void wide_difference(const dem_motion *grain, const uint32_t *i, const uint32_t *j, wide *x,
                                   wide *y, wide *vx, wide *vy)
{
    wide d[4];
    for (int a = 0; a < 4; a++) {
        const int p = a % 2 + a / 2 * (WIDTH / 2);
        d[a] = wide_load_record(grain, i + p) - wide_load_record(grain, j + p);
    }
    const wide lo[2] = {wide_zip_firsts(d[0], d[1]), wide_zip_firsts(d[2], d[3])},
               hi[2] = {wide_zip_seconds(d[0], d[1]), wide_zip_seconds(d[2], d[3])};
    *x = wide_evens(lo[0], lo[1]);
    *y = wide_evens(hi[0], hi[1]);
    *vx = wide_odds(lo[0], lo[1]);
    *vy = wide_odds(hi[0], hi[1]);
}

static inline wide plane_of(dem_vec a)
{
    return wide_repeat(a);
}

typedef wide num, plane;
#include "dem/law/law.inl"
#include "dem/state/motion.inl"

#endif
