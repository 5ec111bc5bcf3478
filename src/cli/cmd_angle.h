/* The parts of `repose angle` that have files of their own. */
#ifndef CMD_ANGLE_H
#define CMD_ANGLE_H

#include "core/status.h"

/* cmd_angle_trend.c */
rp_status cmd_angle_trend(int argc, char **argv);
rp_status cmd_angle_size(int argc, char **argv);

/* cmd_angle_stress.c */
rp_status cmd_angle_stress(int argc, char **argv);
rp_status cmd_angle_critical(int argc, char **argv);

/* cmd_angle_dip.c */
rp_status cmd_angle_dip(int argc, char **argv);

#endif
