/* Version of the program, and provenance of the build. */
#ifndef RP_VERSION_H
#define RP_VERSION_H

#include "core/status.h"

RP_C_BEGIN

#define RP_VERSION "0.2.0"

/* Version of the physics: a result stored under another number is never reused. Raise it whenever the
 * bits of a run change; the golden digests in tests/test_golden.c fail otherwise. */
#define RP_MODEL_VERSION 4

extern const char rp_build_commit[], rp_build_compiler[];

/* RP_BROKEN: this build has fused arithmetic, where the preprocessor could not see that. */
rp_status rp_build_check(void);

RP_C_END

#endif
