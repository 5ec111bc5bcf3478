/* Eight pairs at a time, for processors with AVX-512. */
#include "dem/sim.h"

#ifdef __x86_64__
#pragma GCC target("avx512f,avx512dq,avx512vl")
#define WIDE_PAIRS            dem_pairs_avx512
#define WIDE_LINE             dem_line_avx512
#define WIDE_ADVANCE          dem_advance_avx512
#define WIDE_BEYOND_MARGIN    dem_beyond_margin_avx512
#define WIDE_APPEND_PAIRS     dem_append_pairs_avx512
#define WIDE_PREDICT          dem_predict_avx512
#define WIDE_NEXT_APPROACHING dem_next_approaching_avx512
#define WIDE_NEXT_COLLIDED    dem_next_collided_avx512
#include "dem/kernels_wide.inl"
#endif
