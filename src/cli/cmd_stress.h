/* The parts of `repose stress` that have files of their own. */
#ifndef CMD_STRESS_H
#define CMD_STRESS_H

#include "core/status.h"

/* cmd_stress_critical.c */
rp_status cmd_stress_critical(int argc, char **argv);

/* cmd_stress_dip.c */
rp_status cmd_stress_dip(int argc, char **argv);

#endif
