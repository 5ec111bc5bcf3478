/* The parts of `repose angle` that have files of their own. */
#ifndef CMD_ANGLE_H
#define CMD_ANGLE_H

#include "core/params.h"
#include "core/status.h"

#define PHI_PARAM(T)                                                                                         \
    {                                                                                                        \
        "phi-deg", "deg", RP_REAL, offsetof(T, phi_deg), "60", "(0, 90)", "inclination of the rays of force" \
    }

/* cmd_angle_slope.c */
rp_status cmd_angle_slope(int argc, char **argv);

/* cmd_angle_compare.c */
rp_status cmd_angle_compare(int argc, char **argv);
rp_status cmd_angle_phi(int argc, char **argv);

#endif
