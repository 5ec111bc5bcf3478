#include "cli/cli.h"
rp_status cmd_report(int argc, char **argv)
{
    (void)argc, (void)argv;
    return rp_fail(RP_USAGE, "not built yet");
}
