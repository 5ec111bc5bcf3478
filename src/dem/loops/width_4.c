/* Four pairs at a time, for processors with AVX2. */
#include "dem/state/state.h"

#ifdef __x86_64__
#define WIDE_BITS 256
#ifdef __clang__
#pragma clang attribute push(__attribute__((target("avx2"))), apply_to = function)
#else
#pragma GCC target("avx2")
#endif
#define WIDE(name) dem_##name##_avx2
#include "dem/loops/loops.inl"
#ifdef __clang__
#pragma clang attribute pop
#endif
#endif
