/* Four pairs at a time, for processors with AVX2. */
#ifdef __x86_64__
#pragma GCC target("avx2")
#define WIDE_CHOOSE dem_kernel_choose_avx2
#define WIDE_NAME   "avx2"
#include "dem/kernels_wide.inl"
#endif
