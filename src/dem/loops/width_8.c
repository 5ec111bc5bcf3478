/* Eight pairs at a time, for processors with AVX-512. */
#include "dem/state/state.h"

#ifdef __x86_64__
#define WIDE_BITS 512
#ifdef __clang__
#pragma clang attribute push(__attribute__((target("avx512f,avx512dq,avx512vl"))), apply_to = function)
#else
#pragma GCC target("avx512f,avx512dq,avx512vl")
#endif
#define WIDE(name) dem_##name##_avx512
#include "dem/loops/loops.inl"
#ifdef __clang__
#pragma clang attribute pop
#endif
#endif
