/* Four pairs at a time, for processors with AVX2. */
#include "dem/sim.h"

#ifdef __x86_64__
#pragma GCC target("avx2")
#define WIDE_KERNEL    dem_kernel_avx2
#define WIDE_LINE      dem_line_avx2
#define WIDE_ADVANCE   dem_advance_avx2
#define WIDE_STRAY     dem_stray_avx2
#define WIDE_NEAR      dem_near_avx2
#define WIDE_FORESEE   dem_foresee_avx2
#define WIDE_CLOSING   dem_closing_avx2
#define WIDE_DEFLECTED dem_deflected_avx2
#include "dem/kernels_wide.inl"
#endif
