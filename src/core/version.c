/* Provenance of this build. RP_COMMIT and RP_FLAGS come from the Makefile. */
#include "core/version.h"

/* gcc 12 fuses some products and sums even with -ffp-contract=off. Then results have other bits, and the keys
 * of stored runs do not say so; the kernels use wide instructions without these flags. */
#if defined __FMA__ || defined __FMA4__ || defined __FAST_MATH__ || __FLT_EVAL_METHOD__ != 0
#error                                                                                                       \
    "fused or inexact arithmetic changes the bits of results: build without -march=native, -mfma, -ffast-math, -m32"
#endif

#ifndef RP_COMMIT
#define RP_COMMIT "unknown"
#endif
#ifndef RP_FLAGS
#define RP_FLAGS ""
#endif
#ifdef __clang__ /* its __VERSION__ has its name */
#define COMPILER ""
#else
#define COMPILER "gcc "
#endif

const char rp_build_commit[] = RP_COMMIT;
const char rp_build_compiler[] = COMPILER __VERSION__ " " RP_FLAGS;

/* Arm has fused instructions always, and no macro tells whether the compiler takes them. */
rp_status rp_build_check(void)
{
    static const volatile double known =
        0x1.0000002p+0; /* 1 + 2^-27, its square 2^-54 above the other term */
    const double a = known;
    if (a * a - 0x1.0000004p+0 == 0.0) return RP_OK;
    return rp_fail(RP_BROKEN, "this build fuses products and sums, which changes the bits of results: build "
                              "with -ffp-contract=off");
}
