/* The parts of `repose stats` that have files of their own. */
#ifndef CMD_STATS_H
#define CMD_STATS_H

#include "core/status.h"

/* cmd_stats_fit.c */
rp_status cmd_stats_fit(int argc, char **argv);

/* cmd_stats_trend.c */
rp_status cmd_stats_trend(int argc, char **argv);
rp_status cmd_stats_size(int argc, char **argv);

/* cmd_stats_settings.c */
rp_status cmd_stats_threshold(int argc, char **argv);
rp_status cmd_stats_cost(int argc, char **argv);

#endif
