/* Eight pairs at a time, for processors with AVX-512. */
#include "dem/sim.h"

#ifdef __x86_64__
#pragma GCC target("avx512f,avx512dq,avx512vl")
#define WIDE(name) dem_##name##_avx512
#include "dem/kernels_wide.inl"
#endif
