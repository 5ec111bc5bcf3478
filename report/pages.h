/* A text whose numbers and verdicts come from tables and from the claims: `report page`. */
#ifndef REPORT_PAGES_H
#define REPORT_PAGES_H

#include "cli/cli.h"

extern const cli_command report_page;

/* The commands of the program, ended by NULL. */
extern const cli_command *const report_commands[];

#endif
