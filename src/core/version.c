/* Provenance of this build. RP_COMMIT and RP_FLAGS come from the Makefile. */
#include "core/version.h"

#include <gsl/gsl_version.h>
#include <libconfig.h>
#include <sqlite3.h>
#include <suitesparse/cholmod.h>
#include <xxhash.h>

#ifndef RP_COMMIT
#define RP_COMMIT "unknown"
#endif
#ifndef RP_FLAGS
#define RP_FLAGS ""
#endif
#define TEXT_(x) #x
#define TEXT(x)  TEXT_(x)

const char *rp_build_commit(void)
{
    return RP_COMMIT;
}

const char *rp_build_compiler(void)
{
#ifdef __clang__ /* its __VERSION__ has its name */
    return __VERSION__ " " RP_FLAGS;
#else
    return "gcc " __VERSION__ " " RP_FLAGS;
#endif
}

const char *rp_build_libraries(void)
{
    return "GSL " GSL_VERSION ", libconfig " TEXT(LIBCONFIG_VER_MAJOR) "." TEXT(
        LIBCONFIG_VER_MINOR) ", SQLite " SQLITE_VERSION
                             ", CHOLMOD " TEXT(CHOLMOD_MAIN_VERSION) "." TEXT(CHOLMOD_SUB_VERSION) "." TEXT(CHOLMOD_SUBSUB_VERSION) ", xxHash " TEXT(
                                 XXH_VERSION_MAJOR) "." TEXT(XXH_VERSION_MINOR) "." TEXT(XXH_VERSION_RELEASE) ", Random123 philox4x32-10";
}
