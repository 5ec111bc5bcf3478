/* The commands of the program `repose`. */
#include "cli/cli.h"

static const cli_command *const commands[] = {
    &cmd_lattice, &cmd_continuum, &cmd_tent,   &cmd_pile,      &cmd_angle,  &cmd_stress, &cmd_stats, &cmd_run,
    &cmd_view,    &cmd_sweep,     &cmd_export, &cmd_calibrate, &cmd_params, &cmd_bench,  &cmd_help,  NULL};

const cli_program cli_repose = {
    "repose", "Repose",
    "forces in and under piles of grains, and the angles at which piles are stable and fail", commands};
