/* One, four or eight doubles as one value: WIDTH of them, which the including file sets after it asks for
 * instructions with `#pragma GCC target`. Operators act on each number by itself and round as they do for one
 * number, so that every width gives the same bits.
 *
 * A `num` is WIDTH numbers, `lanes` a truth value for each. A `plane` is GRAINS vectors of the plane, (a0,
 * a1), (a2, a3), ..., and PLANES of these are WIDTH vectors. Shuffles are written once, by the index of each
 * number; the rest depends on the instructions. */
#ifndef DEM_LANES_H
#define DEM_LANES_H

#include "dem/state/state.h"

enum { GRAINS = (WIDTH + 1) / 2, PLANES = WIDTH / GRAINS };

/* A dem_force_torque. */
typedef double force_torque __attribute__((vector_size(32), aligned(16), may_alias));

#if WIDTH == 1
#include "dem/state/motion.h"
typedef num num_unaligned;
typedef plane plane_unaligned;
#elif WIDTH == 4
#include <immintrin.h>
typedef __m256d num, plane, lanes;
typedef __m256d_u num_unaligned, plane_unaligned;
#define NUM_INDEX               ((__m256i){0, 1, 2, 3})
#define NUM_PD(operation)       _mm256_##operation##_pd
#define NUM_COMPARE(a, b, how)  _mm256_cmp_pd(a, b, how)
#define NUM_CHOOSE(l, yes, no)  _mm256_blendv_pd(no, yes, l)
#define NUM_GATHER(from, index) _mm256_i32gather_pd(from, (__m128i)(index), 8)
#define LANES_BITS(l)           (unsigned)_mm256_movemask_pd(l)
#else /* 8 */
#include <immintrin.h>
typedef __m512d num, plane;
typedef __m512d_u num_unaligned, plane_unaligned;
typedef __mmask8 lanes;
#define NUM_INDEX               ((__m512i){0, 1, 2, 3, 4, 5, 6, 7})
#define NUM_PD(operation)       _mm512_##operation##_pd
#define NUM_COMPARE(a, b, how)  _mm512_cmp_pd_mask(a, b, how)
#define NUM_CHOOSE(l, yes, no)  _mm512_mask_blend_pd(l, no, yes)
#define NUM_GATHER(from, index) _mm512_i32gather_pd((__m256i)(index), from, 8)
#define LANES_BITS(l)           l
#endif

INLINE num num_load(const double *from)
{
    return *(const num_unaligned *)from;
}

INLINE void num_store(double *to, num a)
{
    *(num_unaligned *)to = a;
}

INLINE plane plane_load(const dem_vec *from)
{
    return *(const plane_unaligned *)from;
}

INLINE void plane_store(dem_vec *to, plane a)
{
    *(plane_unaligned *)to = a;
}

#if WIDTH == 1
/* from[stride index[]] */
INLINE num num_gather(const double *from, const uint32_t *index, int stride)
{
    return from[(size_t)stride * *index];
}

INLINE lanes num_at_most(num a, num b)
{
    return a <= b;
}

INLINE unsigned lanes_bits(lanes l)
{
    return l;
}

/* Positions and velocities of grains i[] relative to grains j[]. */
INLINE void num_difference(const dem_motion *grain, const uint32_t *i, const uint32_t *j, num *x, num *y,
                           num *vx, num *vy)
{
    const dem_vec d = grain[*i].x - grain[*j].x, v = grain[*i].v - grain[*j].v;
    *x = d[0], *y = d[1], *vx = v[0], *vy = v[1];
}

/* The first numbers of WIDTH vectors; their second numbers. */
INLINE num num_firsts(const plane a[PLANES])
{
    return a[0][0];
}

INLINE num num_seconds(const plane a[PLANES])
{
    return a[0][1];
}

/* The vectors (x, y). */
INLINE void store_vectors(dem_vec to[WIDTH], num x, num y)
{
    to[0] = (dem_vec){x, y};
}

/* Forces and torques (x, y, torque). What becomes of `spare` does not matter. */
INLINE void store_force_torques(dem_force_torque to[WIDTH], num x, num y, num torque)
{
    dem_vec *half = (dem_vec *)to; /* in the pieces that are read again */
    half[0] = (dem_vec){x, y}, half[1] = (dem_vec){torque, 0.0};
}

/* A number of each of GRAINS grains, which acts on both numbers of its vector; reads WIDTH. */
INLINE num num_load_each(const double *from)
{
    return *from;
}

/* Such numbers: squares of lengths. */
INLINE num squares_of(plane a)
{
    return dem_dot(a, a);
}

/* GRAINS records of two vectors. */
INLINE void plane_load_records(const void *from, plane *x, plane *v)
{
    const dem_vec *record = from;
    *x = record[0], *v = record[1];
}

INLINE void plane_store_records(void *to, plane x, plane v)
{
    dem_vec *record = to;
    record[0] = x, record[1] = v;
}

/* Is any number of a less than its fellow in b? */
INLINE bool plane_any_less(plane a, plane b)
{
    return (a[0] < b[0]) | (a[1] < b[1]);
}

/* Which of WIDTH indices are this one. */
INLINE unsigned index_equals(const uint32_t *index, uint32_t one)
{
    return *index == one;
}

#else /* 4 or 8 */
#define NUM_ODD (NUM_INDEX & 1)

#ifdef __clang__ /* has no shuffle by a vector of indices; these loops become one */
INLINE num num_shuffle(num a, num b, __typeof__(NUM_INDEX) from)
{
    num result;
    for (int i = 0; i < WIDTH; i++) result[i] = from[i] < WIDTH ? a[from[i]] : b[from[i] - WIDTH];
    return result;
}
#else
#define num_shuffle __builtin_shuffle
#endif

INLINE num num_of(double a)
{
    return a - (num){0};
}

INLINE num num_sqrt(num a)
{
    return NUM_PD(sqrt)(a);
}

/* a where a > b, else b */
INLINE num num_max(num a, num b)
{
    return NUM_PD(max)(a, b);
}

/* The first numbers of the vectors of a, each followed by that of b; the second numbers; the even vectors of
 * a, then of b; the odd vectors. */
INLINE num num_zip_firsts(num a, num b)
{
    return num_shuffle(a, b, NUM_INDEX - NUM_ODD + NUM_ODD * WIDTH);
}

INLINE num num_zip_seconds(num a, num b)
{
    return num_shuffle(a, b, NUM_INDEX - NUM_ODD + NUM_ODD * WIDTH + 1);
}

INLINE num num_evens(num a, num b)
{
    return num_shuffle(a, b, 2 * NUM_INDEX - NUM_ODD);
}

INLINE num num_odds(num a, num b)
{
    return num_shuffle(a, b, 2 * NUM_INDEX - NUM_ODD + 2);
}

INLINE num num_firsts(const plane a[PLANES])
{
    return num_shuffle(a[0], a[1], 2 * NUM_INDEX);
}

INLINE num num_seconds(const plane a[PLANES])
{
    return num_shuffle(a[0], a[1], 2 * NUM_INDEX + 1);
}

INLINE num num_load_each(const double *from)
{
    const num a = num_load(from);
    return num_shuffle(a, a, NUM_INDEX / 2);
}

INLINE void plane_load_records(const void *from, plane *x, plane *v)
{
    const num a = num_load(from), b = num_load((const double *)from + WIDTH);
    *x = num_evens(a, b);
    *v = num_odds(a, b);
}

INLINE void plane_store_records(void *to, plane x, plane v)
{
    const __typeof__(NUM_INDEX) low = NUM_INDEX / 2 % 2 * WIDTH + NUM_INDEX / 4 * 2 + NUM_ODD;
    num_store(to, num_shuffle(x, v, low));
    num_store((double *)to + WIDTH, num_shuffle(x, v, low + WIDTH / 2));
}

INLINE void store_vectors(dem_vec to[WIDTH], num x, num y)
{
    const __typeof__(NUM_INDEX) low = NUM_INDEX / 2 + NUM_ODD * WIDTH;
    num_store((double *)to, num_shuffle(x, y, low));
    num_store((double *)(to + WIDTH / 2), num_shuffle(x, y, low + WIDTH / 2));
}

INLINE lanes num_less(num a, num b)
{
    return NUM_COMPARE(a, b, _CMP_LT_OQ);
}

INLINE lanes num_at_most(num a, num b)
{
    return NUM_COMPARE(a, b, _CMP_LE_OQ);
}

INLINE unsigned lanes_bits(lanes l)
{
    return LANES_BITS(l);
}

INLINE num num_choose(lanes l, num yes, num no)
{
    return NUM_CHOOSE(l, yes, no);
}

INLINE num num_gather(const double *from, const uint32_t *index, int stride)
{
    typedef int indices __attribute__((vector_size(4 * WIDTH), aligned(4), may_alias));
    return NUM_GATHER(from, *(const indices *)index * stride);
}

#if WIDTH == 8
/* a, or what has its sign and the magnitude `most` where that is less; which these are. Of NaN some become
 * `most`. */
INLINE num num_limit(num a, num most, lanes *less)
{
    const num limited = _mm512_range_pd(a, most, 2);
    *less = _mm512_cmp_pd_mask(limited, a, _CMP_NEQ_UQ);
    return limited;
}

INLINE unsigned index_equals(const uint32_t *index, uint32_t one)
{
    return _mm256_cmpeq_epi32_mask(_mm256_loadu_si256((const __m256i *)index), _mm256_set1_epi32((int)one));
}

INLINE plane plane_of(dem_vec a)
{
    return _mm512_broadcast_f64x2(a);
}

INLINE void store_force_torques(dem_force_torque to[WIDTH], num x, num y, num torque)
{
    for (int p = 0; p < 8; p += 2) {
        const __m512i xy = _mm512_setr_epi64(p, p + 8, p, p, p + 1, p + 9, p, p),
                      third = _mm512_setr_epi64(p, p, p, p, p, p, p + 1, p);
        num_store((double *)(to + p),
                  _mm512_mask_permutexvar_pd(_mm512_permutex2var_pd(x, xy, y), 0x44, third, torque));
    }
}

/* Record i[0], followed by record i[2]. */
INLINE num num_load_record(const dem_motion *grain, const uint32_t *i)
{
    return _mm512_insertf64x4(_mm512_castpd256_pd512(_mm256_load_pd((const double *)&grain[i[0]])),
                              _mm256_load_pd((const double *)&grain[i[2]]), 1);
}

#else
INLINE num num_limit(num a, num most, lanes *less)
{
    const num mask = _mm256_set1_pd(-0.0);
    *less = num_less(most, _mm256_andnot_pd(mask, a));
    return num_choose(*less, _mm256_or_pd(_mm256_and_pd(mask, a), most), a);
}

INLINE unsigned index_equals(const uint32_t *index, uint32_t one)
{
    const __m128i same = _mm_cmpeq_epi32(_mm_loadu_si128((const __m128i *)index), _mm_set1_epi32((int)one));
    return (unsigned)_mm_movemask_ps(_mm_castsi128_ps(same));
}

INLINE plane plane_of(dem_vec a)
{
    return _mm256_set_m128d(a, a);
}

INLINE void store_force_torques(dem_force_torque to[WIDTH], num x, num y, num torque)
{
    const num even = num_zip_firsts(x, y), odd = num_zip_seconds(x, y),
              t_even = num_zip_firsts(torque, torque), t_odd = num_zip_seconds(torque, torque);
    num_store((double *)to, num_evens(even, t_even));
    num_store((double *)(to + 1), num_evens(odd, t_odd));
    num_store((double *)(to + 2), num_odds(even, t_even));
    num_store((double *)(to + 3), num_odds(odd, t_odd));
}

INLINE num num_load_record(const dem_motion *grain, const uint32_t *i)
{
    return _mm256_load_pd((const double *)&grain[i[0]]);
}
#endif

INLINE void num_difference(const dem_motion *grain, const uint32_t *i, const uint32_t *j, num *x, num *y,
                           num *vx, num *vy)
{
    num d[4];
    for (int a = 0; a < 4; a++) {
        const int p = a % 2 + a / 2 * (WIDTH / 2);
        d[a] = num_load_record(grain, i + p) - num_load_record(grain, j + p);
    }
    const num lo[2] = {num_zip_firsts(d[0], d[1]), num_zip_firsts(d[2], d[3])},
              hi[2] = {num_zip_seconds(d[0], d[1]), num_zip_seconds(d[2], d[3])};
    *x = num_evens(lo[0], lo[1]);
    *y = num_evens(hi[0], hi[1]);
    *vx = num_odds(lo[0], lo[1]);
    *vy = num_odds(hi[0], hi[1]);
}

INLINE bool plane_any_less(plane a, plane b)
{
    return lanes_bits(num_less(a, b));
}

INLINE num squares_of(plane a)
{
    a *= a;
    return a + num_shuffle(a, a, NUM_INDEX ^ 1);
}

#include "dem/law/law.inl"
#include "dem/state/motion.inl"
#endif /* WIDTH == 1 */

/* Is any number of a above its fellow in `most`? NaN is. */
INLINE bool num_any_above(num a, num most)
{
    return lanes_bits(num_at_most(a, most)) != (1u << WIDTH) - 1;
}

INLINE double num_largest(num a)
{
    double all[WIDTH];
    num_store(all, a);
    double most = all[0];
    for (int p = 1; p < WIDTH; p++) most = all[p] > most ? all[p] : most;
    return most;
}

/* Append `first` + the index of each bit that is set; writes WIDTH numbers whatever their count. */
INLINE size_t append_bits(uint32_t *list, size_t n, unsigned bits, size_t first)
{
#if WIDTH == 8
    const __m256i index = _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7);
    __m256i k = _mm256_add_epi32(index, _mm256_set1_epi32((int)first));
    _mm256_storeu_si256((__m256i *)(list + n), _mm256_maskz_compress_epi32((__mmask8)bits, k));
    return n + (size_t)__builtin_popcount(bits);
#else
    for (size_t p = 0; p < WIDTH; p++) {
        list[n] = (uint32_t)(first + p);
        n += bits >> p & 1;
    }
    return n;
#endif
}

#endif
