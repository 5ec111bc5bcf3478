/* From the words of a command line to the command, its group and its table as JSON. */
#ifndef CLI_COMMAND_H
#define CLI_COMMAND_H

#include "cli/cli.h"

/* Parse argv[1..] and act. --help prints its text. Errors: those of cli_parse, RP_USAGE for an unknown
 * subcommand, and the action's own. */
rp_status cli_run(cli_call *call, const cli_command *command, int argc, char **argv);

/* Act, what the command prints going to `out`; `table` in place of the arguments' tables, NULL: these. */
rp_status cli_act_into(cli_call *call, rp_table *table, FILE *out);

/* The header of a call's table has the lines `source` of the table that it is made of. */
void cli_sources(cli_call *call, const rp_table *table);

/* The one of these commands whose own name is `word`; NULL: none. */
const cli_command *cli_find(const cli_command *const *among, const char *word);

/* The error of a word that is no command of the group, or for NULL of the program, with the nearest one. */
rp_status cli_unknown_command(const cli_program *program, const char *word, const cli_command *group);

/* What a program's --help prints. */
void cli_overview(const cli_program *program, FILE *out);

/* The main function of a program. */
int cli_main(const cli_program *program, int argc, char **argv);

/* The program `repose`. */
extern const cli_program cli_repose;

#endif
