/* The list of protocols; see protocols.h. */
#include "sweeps/protocols/protocols.h"

const sweep_protocol *const sweep_protocols[] = {
#define X(name) &sweep_protocol_##name,
    SWEEP_PROTOCOLS(X)
#undef X
        NULL};
