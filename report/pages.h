/* The command `report page`: a text whose numbers and verdicts come from tables and from the claims. */
#ifndef REPORT_PAGES_H
#define REPORT_PAGES_H

#include "cli/cli.h"
#include "report/claims.h"

/* Options of the commands. */
#define REPORT_OPTIONS(X)                                                                                    \
    X(TEXT, tables, "", "results,build/tables,results/kept", "",                                             \
      "folders of tables, joined by commas; a table is read from the first folder that holds it")            \
    X(TEXT, claims, "", "report/claims.tsv", "", "file of the claims")

extern const cli_command report_page, report_joint_command;

/* The commands of the program, ended by NULL. */
extern const cli_command *const report_commands[];

#endif
