/* The list of protocols; see protocol.h. */
#include "sweeps/driver/sweep.h"

const sweep_protocol *const sweep_protocols[] = {
#define X(name) &sweep_protocol_##name,
    SWEEP_PROTOCOLS(X)
#undef X
        NULL};
