/* The model of stored results: RP_MODEL_SOURCES names the sources that have the golden digests. */
#include <string.h>

#include "core/version.h"
#include "tests/check.h"

/* Fails after each change of these sources, until somebody says that the bits are the same, or others. */
static void test_sources(void)
{
    char model[32];
    CHECK_OR_SAY(
        strcmp(rp_build_sources, RP_MODEL_SOURCES) == 0,
        "The sources of the physics have changed: without an entry a sweep makes all its runs anew.\n"
        "If build/check golden passes, the entry of src/core/version.h is\n"
        "#define RP_MODEL_SOURCES \"%s\"",
        rp_build_sources);
    CU_ASSERT_STRING_EQUAL(rp_model(model), check_text("%d", RP_MODEL_VERSION));
}

CHECK_SUITE(model, "model", test_sources)
