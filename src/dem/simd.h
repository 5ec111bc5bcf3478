/* Eight or four doubles as one value, as many as the instructions hold that the including file asks for with
 * `#pragma GCC target`. The operators act on each by itself and round as they do for one number, so that
 * every width gives the same bits. Below is what operators cannot say. */
#ifndef DEM_SIMD_H
#define DEM_SIMD_H

#include <immintrin.h>

#include "dem/sim.h"

#ifdef __AVX512F__
enum { WIDTH = 8 };
typedef __m512d wide;
typedef __mmask8 lanes; /* a yes or no for each number */

static inline wide wide_load(const double *from)
{
    return _mm512_loadu_pd(from);
}

static inline void wide_store(double *to, wide a)
{
    _mm512_storeu_pd(to, a);
}

static inline wide num_of(double a)
{
    return _mm512_set1_pd(a);
}

static inline wide num_sqrt(wide a)
{
    return _mm512_sqrt_pd(a);
}

/* a where a > b, else b */
static inline wide num_max(wide a, wide b)
{
    return _mm512_max_pd(a, b);
}

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

/* Which of WIDTH numbers are this one? */
static inline unsigned wide_is(const uint32_t *list, uint32_t number)
{
    return _mm256_cmpeq_epi32_mask(_mm256_loadu_si256((const __m256i *)list), _mm256_set1_epi32((int)number));
}

/* from[stride index[]] */
static inline wide wide_gather(const double *from, const uint32_t *index, int stride)
{
    __m256i at = _mm256_mullo_epi32(_mm256_loadu_si256((const __m256i *)index), _mm256_set1_epi32(stride));
    return _mm512_i32gather_pd(at, from, 8);
}

/* Positions and velocities of grains i[] relative to grains j[]. */
static inline void wide_difference(const dem_motion *grain, const uint32_t *i, const uint32_t *j, wide *x,
                                   wide *y, wide *vx, wide *vy)
{
    wide d[4];
    for (int a = 0; a < 4; a++) {
        const int p = a % 2 + a / 2 * 4, q = p + 2;
        wide first = _mm512_insertf64x4(_mm512_castpd256_pd512(_mm256_load_pd(&grain[i[p]].x[0])),
                                        _mm256_load_pd(&grain[i[q]].x[0]), 1);
        wide second = _mm512_insertf64x4(_mm512_castpd256_pd512(_mm256_load_pd(&grain[j[p]].x[0])),
                                         _mm256_load_pd(&grain[j[q]].x[0]), 1);
        d[a] = first - second;
    }
    wide lo[2] = {_mm512_unpacklo_pd(d[0], d[1]), _mm512_unpacklo_pd(d[2], d[3])};
    wide hi[2] = {_mm512_unpackhi_pd(d[0], d[1]), _mm512_unpackhi_pd(d[2], d[3])};
    *x = _mm512_shuffle_f64x2(lo[0], lo[1], 0x88);
    *y = _mm512_shuffle_f64x2(hi[0], hi[1], 0x88);
    *vx = _mm512_shuffle_f64x2(lo[0], lo[1], 0xdd);
    *vy = _mm512_shuffle_f64x2(hi[0], hi[1], 0xdd);
}

/* The vectors (x, y). */
static inline void wide_store_vectors(dem_vec to[WIDTH], wide x, wide y)
{
    const __m512i low = _mm512_setr_epi64(0, 8, 1, 9, 2, 10, 3, 11),
                  high = _mm512_setr_epi64(4, 12, 5, 13, 6, 14, 7, 15);
    wide_store((double *)to, _mm512_permutex2var_pd(x, low, y));
    wide_store((double *)(to + 4), _mm512_permutex2var_pd(x, high, y));
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

/* From here on a wide holds WIDTH/2 vectors. */
static inline wide wide_repeat(dem_vec a)
{
    return _mm512_broadcast_f64x2(a);
}

static inline wide wide_load_twice(const double *from)
{
    const __m512i index = _mm512_setr_epi64(0, 0, 1, 1, 2, 2, 3, 3);
    return _mm512_permutexvar_pd(index, _mm512_castpd256_pd512(_mm256_loadu_pd(from)));
}

static inline void wide_load_records(const dem_motion *from, wide *x, wide *v)
{
    wide a = wide_load((const double *)from), b = wide_load((const double *)(from + 2));
    *x = _mm512_shuffle_f64x2(a, b, 0x88);
    *v = _mm512_shuffle_f64x2(a, b, 0xdd);
}

static inline void wide_store_records(dem_motion *to, wide x, wide v)
{
    const __m512i low = _mm512_setr_epi64(0, 1, 8, 9, 2, 3, 10, 11),
                  high = _mm512_setr_epi64(4, 5, 12, 13, 6, 7, 14, 15);
    wide_store((double *)to, _mm512_permutex2var_pd(x, low, v));
    wide_store((double *)(to + 2), _mm512_permutex2var_pd(x, high, v));
}

/* (y, x) of each. */
static inline wide wide_swap(wide a)
{
    return _mm512_permute_pd(a, 0x55);
}

/* The first number of each vector of a, then of b. */
static inline wide wide_firsts(wide a, wide b)
{
    return _mm512_permutex2var_pd(a, _mm512_setr_epi64(0, 2, 4, 6, 8, 10, 12, 14), b);
}

#else /* AVX2 */
enum { WIDTH = 4 };
typedef __m256d wide;
typedef __m256d lanes;

static inline wide wide_load(const double *from)
{
    return _mm256_loadu_pd(from);
}

static inline void wide_store(double *to, wide a)
{
    _mm256_storeu_pd(to, a);
}

static inline wide num_of(double a)
{
    return _mm256_set1_pd(a);
}

static inline wide num_sqrt(wide a)
{
    return _mm256_sqrt_pd(a);
}

static inline wide num_max(wide a, wide b)
{
    return _mm256_max_pd(a, b);
}

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

static inline unsigned wide_is(const uint32_t *list, uint32_t number)
{
    __m128i same = _mm_cmpeq_epi32(_mm_loadu_si128((const __m128i *)list), _mm_set1_epi32((int)number));
    return (unsigned)_mm_movemask_ps(_mm_castsi128_ps(same));
}

static inline wide wide_gather(const double *from, const uint32_t *index, int stride)
{
    __m128i at = _mm_mullo_epi32(_mm_loadu_si128((const __m128i *)index), _mm_set1_epi32(stride));
    return _mm256_i32gather_pd(from, at, 8);
}

static inline void wide_difference(const dem_motion *grain, const uint32_t *i, const uint32_t *j, wide *x,
                                   wide *y, wide *vx, wide *vy)
{
    wide d[4];
    for (int p = 0; p < 4; p++) d[p] = _mm256_load_pd(&grain[i[p]].x[0]) - _mm256_load_pd(&grain[j[p]].x[0]);
    wide lo[2] = {_mm256_unpacklo_pd(d[0], d[1]), _mm256_unpacklo_pd(d[2], d[3])};
    wide hi[2] = {_mm256_unpackhi_pd(d[0], d[1]), _mm256_unpackhi_pd(d[2], d[3])};
    *x = _mm256_permute2f128_pd(lo[0], lo[1], 0x20);
    *y = _mm256_permute2f128_pd(hi[0], hi[1], 0x20);
    *vx = _mm256_permute2f128_pd(lo[0], lo[1], 0x31);
    *vy = _mm256_permute2f128_pd(hi[0], hi[1], 0x31);
}

static inline void wide_store_vectors(dem_vec to[WIDTH], wide x, wide y)
{
    wide even = _mm256_unpacklo_pd(x, y), odd = _mm256_unpackhi_pd(x, y);
    wide_store((double *)to, _mm256_permute2f128_pd(even, odd, 0x20));
    wide_store((double *)(to + 2), _mm256_permute2f128_pd(even, odd, 0x31));
}

static inline void wide_store_force_torques(dem_force_torque to[WIDTH], wide x, wide y, wide torque)
{
    wide even = _mm256_unpacklo_pd(x, y), odd = _mm256_unpackhi_pd(x, y),
         t_even = _mm256_unpacklo_pd(torque, torque), t_odd = _mm256_unpackhi_pd(torque, torque);
    wide_store((double *)to, _mm256_permute2f128_pd(even, t_even, 0x20));
    wide_store((double *)(to + 1), _mm256_permute2f128_pd(odd, t_odd, 0x20));
    wide_store((double *)(to + 2), _mm256_permute2f128_pd(even, t_even, 0x31));
    wide_store((double *)(to + 3), _mm256_permute2f128_pd(odd, t_odd, 0x31));
}

static inline wide wide_repeat(dem_vec a)
{
    return _mm256_set_m128d(a, a);
}

static inline wide wide_load_twice(const double *from)
{
    return _mm256_permute4x64_pd(_mm256_castpd128_pd256(_mm_loadu_pd(from)), 0x50);
}

static inline void wide_load_records(const dem_motion *from, wide *x, wide *v)
{
    wide a = wide_load((const double *)from), b = wide_load((const double *)(from + 1));
    *x = _mm256_permute2f128_pd(a, b, 0x20);
    *v = _mm256_permute2f128_pd(a, b, 0x31);
}

static inline void wide_store_records(dem_motion *to, wide x, wide v)
{
    wide_store((double *)to, _mm256_permute2f128_pd(x, v, 0x20));
    wide_store((double *)(to + 1), _mm256_permute2f128_pd(x, v, 0x31));
}

static inline wide wide_swap(wide a)
{
    return _mm256_permute_pd(a, 0x5);
}

static inline wide wide_firsts(wide a, wide b)
{
    return _mm256_permute4x64_pd(_mm256_unpacklo_pd(a, b), 0xd8);
}
#endif

typedef wide num;
#include "dem/law.inl"

#endif
