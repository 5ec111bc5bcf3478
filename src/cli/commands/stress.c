/* repose stress: derivations of src/cli/derive. */
#include "cli/derive/derive.h"

static const cli_command *const commands[] = {CLI_STRESS(CLI_ENTRY) NULL};
const cli_command cmd_stress = {"stress", "stress in piles; forces and pressure dip on their base",
                                .group = commands};
