/* Provenance of this build. RP_COMMIT, RP_SOURCES and RP_FLAGS come from the Makefile. */
#include "core/version.h"

#include <stdbool.h>
#include <stdio.h>
#include <string.h>

/* gcc 12 fuses some products and sums even with -ffp-contract=off. Then results have other bits, and the keys
 * of stored runs do not say so; the kernels use wide instructions without these flags. */
#if defined __FMA__ || defined __FMA4__ || defined __FAST_MATH__ || __FLT_EVAL_METHOD__ != 0
#error                                                                                                       \
    "fused or inexact arithmetic changes the bits of results: build without -march=native, -mfma, -ffast-math, -m32"
#endif

#ifndef RP_COMMIT
#define RP_COMMIT "unknown"
#endif
#ifndef RP_SOURCES
#define RP_SOURCES "unknown"
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
const char rp_build_sources[] = RP_SOURCES;
const char rp_build_compiler[] = COMPILER __VERSION__ " " RP_FLAGS;

const char *rp_model(char text[32])
{
    const bool known = strcmp(rp_build_sources, RP_MODEL_SOURCES) == 0;
    snprintf(text, 32, "%d%s%s", RP_MODEL_VERSION, known ? "" : " ", known ? "" : rp_build_sources);
    return text;
}

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
