/* Four pairs at a time, for processors with AVX2. */
#include "dem/sim.h"

#ifdef __x86_64__
#pragma GCC target("avx2")
#define WIDE(name) dem_##name##_avx2
#include "dem/kernels_wide.inl"
#endif
