/* repose stress: derivations of src/cli/derive. */
#include "cli/derive/derive.h"

#define X(name) &cmd_stress_##name,
static const cli_command *const commands[] = {CLI_STRESS(X) NULL};
#undef X
const cli_command cmd_stress = {"stress", "stress in piles, forces and dip of pressure on their base",
                                .group = commands};
