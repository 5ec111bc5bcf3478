#include "tests/protocol.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tests/check.h"

void *protocol_params(const sweep_protocol *protocol, const char *const changes[])
{
    void *params = calloc(1, protocol->params_size);
    CU_ASSERT_PTR_NOT_NULL_FATAL(params);
    rp_params_defaults(protocol->schema, params);
    for (; *changes; changes++) {
        char name[32];
        const char *value = strchr(*changes, '=') + 1;
        snprintf(name, sizeof name, "%.*s", (int)(value - 1 - *changes), *changes);
        CHECK_OK(rp_params_set_text(rp_params_find(protocol->schema, name), params, value));
    }
    return params;
}

double protocol_output(const sweep_protocol *protocol, const sweep_result *result, const char *name)
{
    for (size_t i = 0; protocol->outputs[i].name; i++)
        if (strcmp(protocol->outputs[i].name, name) == 0) return result->values[i];
    fprintf(stderr, "protocol %s: no output %s\n", protocol->name, name);
    CU_FAIL("no such output");
    return NAN;
}

void protocol_no_header(const void *context, FILE *table)
{
    (void)context;
    (void)table;
}
