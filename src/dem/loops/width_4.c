/* Four pairs or grains at a time, for processors with AVX2. */
#include "dem/state/state.h"

#ifdef __x86_64__
#ifdef __clang__
#pragma clang attribute push(__attribute__((target("avx2"))), apply_to = function)
#else
#pragma GCC target("avx2")
#endif
#define WIDTH 4
#include "dem/loops/loops.inl"
const dem_loops dem_loops_4 =
    LOOPS("avx2", false, pairs, line, mixed_pairs, mixed_line, next_approaching, next_collided);
#ifdef __clang__
#pragma clang attribute pop
#endif
#endif
