/* Sweeps run from the command line, with their progress on a terminal. */
#ifndef CLI_PROGRESS_H
#define CLI_PROGRESS_H

#include "sweeps/driver/sweep.h"

/* sweep_run with the given number of workers, below 1: one per processor; its errors. */
rp_status cli_sweep_run(const char *dir, long workers, sweep_counts *counts);

#endif
