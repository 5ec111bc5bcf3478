/* Shared functions of the command line. One file per subcommand; no physics here. */
#ifndef CLI_H
#define CLI_H

#include <stdbool.h>
#include <stdio.h>

#include "core/params.h"
#include "core/status.h"
#include "core/table.h"

/* One subcommand: text of --help, and options of the parser. Options of one letter take one dash. */
typedef struct {
    const char *name;     /* "angle tilt" */
    const char *synopsis; /* arguments on the usage line */
    const char *about;    /* one or more lines */
    const char *example;
    const rp_param *options;
    int min_arguments, max_arguments;
} cli_command;

/* Parse argv[1..] by the options' schema into `values` (defaults first). Boolean options take no value.
 * Arguments that are not options go to arguments[0..*n_arguments), NULL for a command without. After --help,
 * *done is true: the text has been printed. Errors: RP_USAGE (unknown option, missing value, required option
 * or argument), RP_BAD_INPUT (a value). */
rp_status cli_parse(const cli_command *command, int argc, char **argv, void *values, const char **arguments,
                    int *n_arguments, bool *done);

/* Whether option `name` was on the command line that was parsed last. */
bool cli_given(const cli_command *command, const char *name);

/* A command without arguments: parse, act with the options `values`. Errors: those of cli_parse, and the
 * action's own. */
rp_status cli_plain(const cli_command *command, int argc, char **argv, void *values,
                    rp_status (*act)(const void *values));

/* The option --where of commands on tables, in a field rp_texts `where` of the structure T. */
#define CLI_WHERE(T)                                                                                         \
    {                                                                                                        \
        "where", "", RP_TEXTS, offsetof(T, where), "", "",                                                   \
            "use only rows with NAME=VALUE, or != < <= > >=; several conditions must all hold"               \
    }

/* Read a table, and keep the rows that meet the option --where of the command's options `values`, if it has
 * one. Free with rp_table_free, also after an error. Errors: those of rp_table_read and rp_table_where. */
rp_status cli_table_read(const cli_command *command, const void *values, const char *path, rp_table *table);

/* A command on one table: parse, cli_table_read of the table that the argument names, act on it with the
 * options `values`, free it. Errors: those of cli_parse and cli_table_read, and the action's own. */
rp_status cli_with_table(const cli_command *command, int argc, char **argv, void *values,
                         rp_status (*act)(rp_table *table, const void *values));

/* The command line of this process, for provenance. */
const char *cli_command_line(void);

/* Start a table on standard output: provenance, `schema` with its values as notes (may be NULL). */
void cli_table(FILE *out, const rp_param *schema, const void *values);

/* Read "0.1,0.25,..." into a new array (free it). Errors: RP_BAD_INPUT, RP_NO_MEMORY. */
rp_status cli_numbers(const char *option, const char *text, double **numbers, size_t *n);

/* Numbers of the columns called names[n]. Errors: RP_BAD_INPUT. */
rp_status cli_find_columns(const rp_table *table, size_t n, const char *const names[], int columns[]);

/* The columns as new arrays of numbers, one after the other in one block (free it, also after an error). A
 * column of -1 is skipped and its part unset. Errors: RP_BAD_INPUT, RP_NO_MEMORY. */
rp_status cli_read_columns(const rp_table *table, size_t n, const int columns[], int missing_ok,
                           double **block);

/* Rows of a table grouped by their cells in the columns `by` ("a" or "a,b,..."; "none": one group). */
typedef struct {
    size_t n_groups;
    size_t *of_row;
    const char *
        *words; /* of the groups, in the order in which they appear: their cells, joined by the separator */
    char *labels;
} cli_groups;

/* Free with cli_groups_free, also after an error. Errors: RP_BAD_INPUT, RP_NO_MEMORY. */
rp_status cli_group_rows(const rp_table *table, const char *by, char separator, cli_groups *groups);
void cli_groups_free(cli_groups *groups);

/* The unit of a column as the table's header has it, "1" where it has none. */
void cli_column_unit(const rp_table *table, int column, char unit[32]);

/* The n columns of the list `names` ("a,b,..."), at most `most`. Errors: RP_BAD_INPUT. */
rp_status cli_column_list(const rp_table *table, const char *names, size_t most, size_t *n, int columns[]);

/* A group of commands such as `repose angle`. */
typedef struct {
    const char *name;
    rp_status (*function)(int, char **);
    const char *summary;
} cli_subcommand;

/* Run the command that argv[1] names out of a list that ends with {0}, or print the list. Errors: RP_USAGE.
 */
rp_status cli_dispatch(const char *group, const cli_subcommand list[], int argc, char **argv);

/* The subcommands: name, function, summary. The dispatcher and the overview read this list. */
#define CLI_COMMANDS(X)                                                                                      \
    X("lattice", cmd_lattice, "forces on the base of a close-packed pile, lattice model (37)-(44)")          \
    X("continuum", cmd_continuum, "forces on the base of a triangular pile, continuum model (49)-(59)")      \
    X("tent", cmd_tent, "forces on the base of a tent-shaped pile")                                          \
    X("pile", cmd_pile, "static equilibrium of a close-packed pile of soft disks")                           \
    X("angle", cmd_angle, "angles of repose, tilting and marginal stability from plain numbers")             \
    X("stress", cmd_stress, "stress in piles, forces and dip of pressure on their base")                     \
    X("stats", cmd_stats, "lines, trends, thresholds and costs from tables of runs")                         \
    X("run", cmd_run, "simulate any scene, described in a file")                                             \
    X("sweep", cmd_sweep, "plan, run and read parameter sweeps")                                             \
    X("calibrate", cmd_calibrate, "friction that gives a measured angle of repose, with its interval")       \
    X("claims", cmd_claims, "published claims and their verdicts")                                           \
    X("forensics", cmd_forensics, "unspecified choices of a paper against its published numbers")            \
    X("params", cmd_params, "every parameter of a protocol or scene file, with unit, default and range")     \
    X("bench", cmd_bench, "particle-steps per second on this machine")                                       \
    X("report", cmd_report, "fill a report's template from tables")

#define X(name, function, summary) rp_status function(int argc, char **argv);
CLI_COMMANDS(X)
#undef X

#endif
