/* Eight pairs at a time, for processors with AVX-512. */
#include "dem/sim.h"

#ifdef __x86_64__
#pragma GCC target("avx512f,avx512dq,avx512vl")
#define WIDE_KERNEL    dem_kernel_avx512
#define WIDE_LINE      dem_line_avx512
#define WIDE_ADVANCE   dem_advance_avx512
#define WIDE_STRAY     dem_stray_avx512
#define WIDE_NEAR      dem_near_avx512
#define WIDE_FORESEE   dem_foresee_avx512
#define WIDE_CLOSING   dem_closing_avx512
#define WIDE_DEFLECTED dem_deflected_avx512
#include "dem/kernels_wide.inl"
#endif
