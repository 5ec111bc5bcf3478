/* The commands of the program `repose`. */
#include "cli/cli.h"

static const cli_command *const commands[] = {&cmd_run,    &cmd_view,    &cmd_sweep,     &cmd_calibrate,
                                              &cmd_angle,  &cmd_stats,   &cmd_stress,    &cmd_export,
                                              &cmd_params, &cmd_lattice, &cmd_continuum, &cmd_tent,
                                              &cmd_pile,   &cmd_bench,   &cmd_help,      NULL};

const cli_program cli_repose = {
    "repose", "Repose",
    "simulates two-dimensional piles of grains, and measures their slopes, stability and forces", commands};
