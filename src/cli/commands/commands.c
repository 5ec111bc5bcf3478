/* The commands of the program `repose`. */
#include "cli/cli.h"

static const cli_command *const commands[] = {
    &cmd_lattice, &cmd_continuum, &cmd_tent,   &cmd_pile,      &cmd_angle,  &cmd_stress, &cmd_stats, &cmd_run,
    &cmd_view,    &cmd_sweep,     &cmd_export, &cmd_calibrate, &cmd_params, &cmd_bench,  &cmd_help,  NULL};

/* CHANGELOG.md has the same. */
static const cli_removed removed[] = {
    {"claims", "build/report claims, in the source tree"},
    {"report", "build/report page, in the source tree"},
    {"forensics", "nothing; 0.1.0 has it"},
    {"stats predict", "repose stats correlation"},
    {"stats threshold", "nothing; 0.1.0 has it"},
    {"stats cost", "nothing; 0.1.0 has it"},
    {"stats oscillation", "nothing; 0.1.0 has it"},
    {"stress critical", "columns floor_tilt_deg and bulk_friction_0 of protocol stress"},
    {"run --plot", "repose view of the run's folder"},
    {"calibrate --sweep", "a file: repose calibrate FILE.cfg"},
    {"calibrate --runs", "a file: repose calibrate FILE.cfg, with `runs`"},
    {"calibrate --fit", "a file: repose calibrate FILE.cfg, with `fit`"},
    {"calibrate --bootstrap", "nothing; tests of the program do this"},
    {"calibrate --seed", "a file: repose calibrate FILE.cfg, with `seed`"},
    {"calibrate --planted", "nothing; tests of the program do this"},
    {"calibrate --verify", "nothing; tests of the program do this"},
    {"calibrate --response", "nothing; tests of the program do this"},
    {"stress dip --power", "nothing; tests of the program do this"},
    {"stress dip --ensembles", "nothing; tests of the program do this"},
    {"stress dip --resamples", "nothing; p_value is by Student's t"},
    {"stress dip --seed", "nothing; p_value is by Student's t"},
    {"angle phi", "nothing; 0.1.0 has it"},
    {"stats maximum", "nothing; 0.1.0 has it"},
    {"stats fit --successive", "nothing; 0.1.0 has it"},
    {"stats size --exponent", "nothing; 0.1.0 has it"},
    {"tent --map", "repose tent for each pair of angles"},
    {"help --man", "repose help --markdown; packages hold the manual page"},
    {NULL, NULL}};

const cli_program cli_repose = {
    "repose", "Repose",
    "forces in and under piles of grains, and the angles at which piles are stable and fail", commands,
    removed};
