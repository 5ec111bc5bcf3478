/* Subcommands of `repose angle` that have files of their own. */
#ifndef CLI_CMD_ANGLE_H
#define CLI_CMD_ANGLE_H

#include "core/status.h"

rp_status cmd_angle_stress(int argc, char **argv);
rp_status cmd_angle_critical(int argc, char **argv);

#endif
