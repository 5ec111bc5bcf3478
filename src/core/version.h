/* Version of the program, and provenance of the build. */
#ifndef RP_VERSION_H
#define RP_VERSION_H

#include "core/status.h"

RP_C_BEGIN

#define RP_VERSION "0.3.0"

/* Version of the physics: a result stored under another number is never reused. Raise it whenever the
 * bits of a run change; the golden digests in tests/test_golden.c fail otherwise. */
#define RP_MODEL_VERSION 4

/* Hash of the sources (Makefile) whose bits are those golden digests. After any change of these sources
 * `build/check golden model` says whether the bits are the same, and prints this line anew. */
#define RP_MODEL_SOURCES "1a60850b60ccfbd5"

extern const char rp_build_commit[], rp_build_compiler[], rp_build_sources[];

/* What stored results share beside their settings: "4", the version of the physics; of sources that no one
 * has compared with the golden digests also their hash, so that they share nothing. Returns `text`. */
const char *rp_model(char text[32]);

/* RP_BROKEN: this build has fused arithmetic, where the preprocessor could not see that. */
rp_status rp_build_check(void);

RP_C_END

#endif
