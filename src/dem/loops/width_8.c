/* Eight pairs or grains at a time, for processors with AVX-512. */
#include "dem/state/state.h"

#ifdef __x86_64__
#ifdef __clang__
#pragma clang attribute push(__attribute__((target("avx512f,avx512dq,avx512vl"))), apply_to = function)
#else
#pragma GCC target("avx512f,avx512dq,avx512vl")
#endif
#define WIDTH 8
#include "dem/loops/loops.inl"
const dem_loops dem_loops_8 =
    LOOPS("avx512", false, pairs, line, mixed_pairs, mixed_line, next_approaching, next_collided);
#ifdef __clang__
#pragma clang attribute pop
#endif
#endif
