/* Eight pairs at a time, for processors with AVX-512. */
#ifdef __x86_64__
#pragma GCC target("avx512f,avx512dq,avx512vl")
#define WIDE_CHOOSE dem_kernel_choose_avx512
#define WIDE_NAME   "avx512"
#include "dem/kernels_wide.inl"
#endif
