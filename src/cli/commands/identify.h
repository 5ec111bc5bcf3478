/* Calibration by a text: names of experiments from several measured numbers. */
#ifndef CLI_IDENTIFY_H
#define CLI_IDENTIFY_H

#include "cli/cli.h"

typedef struct {
    const char *o;
    long budget, j; /* below 1: the file's, one worker a processor */
    bool quiet, force, dry_run;
} calibrate_text_options;

/* Errors: RP_BAD_INPUT (the file), RP_NO_RESULT (an answer whose status is not ok, which is printed), those
 * of sweeps. */
rp_status cli_identify(const cli_call *call, const char *path, const calibrate_text_options *o);

#endif
