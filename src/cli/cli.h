/* Shared functions of the command line. One file per subcommand; no physics here. */
#ifndef CLI_H
#define CLI_H

#include <stdbool.h>
#include <stdio.h>

#include "core/params.h"
#include "core/status.h"
#include "core/table.h"
#include "sweeps/driver/sweep.h"

/* One command: text of --help, options of the parser, and the function that acts on their values. Options of
 * one letter take one dash. A first word of the synopsis in capitals is an argument, with three dots after it
 * one or more, in brackets an optional one. */
typedef struct cli_command {
    const char *name;     /* "angle tilt" */
    const char *summary;  /* in the overview of its group */
    const char *synopsis; /* arguments and options on the usage line */
    const char *about;    /* one or more lines */
    const char *example;
    const rp_param *options; /* NULL: none */
    rp_status (*act)(const void *values);
    rp_status (*on_table)(rp_table *table, const void *values); /* the argument, read by cli_table_read */
    const struct cli_command *const *group;                     /* subcommands, to NULL; no `act` */
    rp_status (*run)(int argc, char **argv);                    /* parses by itself, in place of all */
} cli_command;

/* Parse argv[1..] by the options' schema into `values` (defaults first; the rest is 0), and act. Boolean
 * options take no value. --help prints its text. Errors: RP_USAGE (unknown option or subcommand, missing
 * value, required option or argument), RP_BAD_INPUT (a value), and the action's own. */
rp_status cli_run(const cli_command *command, int argc, char **argv);

/* Argument number i of the command line that was parsed last, NULL beyond their end. */
const char *cli_argument(int i);

/* Whether option `name` was on the command line that was parsed last. */
bool cli_given(const char *name);

/* Read a table, and keep the rows that meet the option --where of the command's options `values`, if it has
 * one. Free with rp_table_free, also after an error. Errors: those of rp_table_read and rp_table_where. */
rp_status cli_table_read(const cli_command *command, const void *values, const char *path, rp_table *table);

/* sweep_run with the given number of workers, below 1: one per processor, and limits of a run (MB, s; 0:
 * none); its progress on a terminal. */
rp_status cli_sweep_run(const char *dir, long workers, double memory, double time, sweep_counts *counts);

/* Tables of a run are written in a folder `stage`, DIRECTORY/unfinished, which is emptied first. A whole
 * result moves into the directory, in place of what is there; any other one stays, and the message of `run`,
 * which is returned, names its folder. Errors: RP_IO, RP_BAD_INPUT. */
rp_status cli_stage_open(const char *directory, char stage[4096]);
rp_status cli_stage_close(const char *directory, const char *stage, rp_status run);

/* SIGINT, SIGTERM and SIGHUP call `handler`, or end this process with RP_STOPPED and a message that names the
 * stage. */
void cli_on_stop(void (*handler)(int));
void cli_stage_stops(const char *stage);

/* The command line of this process, for provenance. */
const char *cli_command_line(void);

/* clang-format off */
/* The option --where of commands on tables, in a field rp_texts `where` of the structure T. */
#define CLI_WHERE(T)                                                                                         \
    {"where", "", RP_TEXTS, offsetof(T, where), "", "",                                                      \
     "use only rows with NAME=VALUE, or != < <= > >=; several conditions must all hold"}

/* Options that several commands have, in fields of the structure T named like them. */
#define CLI_TEXT(T, field, fallback, meaning) {#field, "", RP_TEXT, offsetof(T, field), fallback, "", meaning}
#define CLI_BOOL(T, field, meaning) {#field, "", RP_BOOL, offsetof(T, field), "false", "", meaning}
#define CLI_SEED(T, fallback, meaning)                                                                       \
    {"seed", "", RP_INT, offsetof(T, seed), fallback, "[0, 2147483647]", meaning}
#define CLI_BOOTSTRAP(T, fallback)                                                                           \
    {"bootstrap", "", RP_INT, offsetof(T, bootstrap), fallback, "[2, 10000000]", "resamples of the piles"},  \
    CLI_SEED(T, "1993", "seed of the resamples")
#define CLI_BY(T, fallback, what)                                                                            \
    CLI_TEXT(T, by, fallback, "columns (a or a,b,...) whose different cells make the " what)
#define CLI_RANGE(T, what)                                                                                   \
    {"from", "", RP_REAL, offsetof(T, from), "-1e308", "(-inf, inf)", "smallest " what " that is used"},     \
    {"to", "", RP_REAL, offsetof(T, to), "1e308", "(-inf, inf)", "largest " what " that is used"}
#define CLI_PHI(T)                                                                                           \
    {"phi-deg", "deg", RP_REAL, offsetof(T, phi_deg), "60", "(0, 90)", "inclination of the rays of force"}
#define CLI_WORKERS(T)                                                                                       \
    {"j", "", RP_INT, offsetof(T, j), "auto", "[1, 4096] | auto", "worker processes; auto: one per processor"}
/* clang-format on */

/* Start a table on standard output: provenance, `schema` with its values as notes (may be NULL). */
void cli_table(FILE *out, const rp_param *schema, const void *values);

/* One row of numbers, and one with a word in the last column. */
#define CLI_NUMBERS(...)                                                                                     \
    sizeof((double[]){__VA_ARGS__}) / sizeof(double), (double[])                                             \
    {                                                                                                        \
        __VA_ARGS__                                                                                          \
    }
#define CLI_ROW(...)            rp_table_row(stdout, CLI_NUMBERS(__VA_ARGS__))
#define CLI_ROW_WORD(word, ...) rp_table_row_word(stdout, CLI_NUMBERS(__VA_ARGS__), word)

/* Read "0.1,0.25,..." into a new array (free it). Errors: RP_BAD_INPUT, RP_NO_MEMORY. */
rp_status cli_numbers(const char *option, const char *text, double **numbers, size_t *n);

/* Numbers of the columns called names[n]. Errors: RP_BAD_INPUT. */
rp_status cli_find_columns(const rp_table *table, size_t n, const char *const names[], int columns[]);

/* The columns as new arrays of numbers, one after the other in one block (free it, also after an error). A
 * column of -1 is skipped and its part unset. Errors: RP_BAD_INPUT, RP_NO_MEMORY. */
rp_status cli_read_columns(const rp_table *table, size_t n, const int columns[], int missing_ok,
                           double **block);

/* The columns of the list `names` ("a,b,...") in the same way, and of the table in a file.
 * Errors: RP_BAD_INPUT, RP_NO_MEMORY; those of rp_table_read. */
rp_status cli_read_named(const rp_table *table, const char *names, int missing_ok, double **block);
rp_status cli_read_file(const char *path, const char *names, double **block, size_t *n_rows);

/* Rows with a result as columns of numbers: status, if there is such a column, starts with ok. */
enum { CLI_MOST_COLUMNS = 32 };
typedef struct {
    size_t n;
    double *column[CLI_MOST_COLUMNS]; /* of the list of names; the first is all memory */
} cli_rows;

/* `grouped`: ordered by the first column, and without rows that have nan; else as in the table. Free with
 * cli_rows_free, also after an error. Errors: RP_BAD_INPUT, RP_NO_MEMORY; RP_NO_RESULT without such a row. */
rp_status cli_rows_read(const rp_table *table, const char *names, bool grouped, cli_rows *rows);
void cli_rows_free(cli_rows *rows);

/* End of the rows with the same number in the first column as row `first`. */
size_t cli_rows_end(const cli_rows *rows, size_t first);

/* The header line that says how many rows count. */
void cli_rows_note(const rp_table *table, const cli_rows *rows);

/* Values of the options --points and --at. */
typedef struct {
    long points;    /* -1: not given */
    const char *at; /* "auto": not given */
} cli_positions;

/* clang-format off */
#define CLI_POSITIONS(type, field)                                                                           \
    {"points", "", RP_INT, offsetof(type, field.points), "auto", "[2, 10000000] | auto",                     \
     "number of equidistant positions from 0 to B; auto: 201 unless --at is given"},                                      \
    {"at", "", RP_TEXT, offsetof(type, field.at), "auto", "", "positions as fractions of B, as in 0.1,0.25"}
/* clang-format on */

/* The positions as a new array (free it) of fractions of the base.
 * Errors: RP_USAGE (both given), RP_BAD_INPUT (not numbers in [0, 1]), RP_NO_MEMORY. */
rp_status cli_positions_read(const cli_positions *asked, double **x, size_t *n);

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

/* The header of a table whose first columns are those of the list `by` ("none": none), with their units,
 * before its own. Errors: RP_BAD_INPUT. */
rp_status cli_header_by(const rp_table *table, const char *by, const char *own);

/* The n columns of the list `names` ("a,b,..."), at most `most`. Errors: RP_BAD_INPUT. */
rp_status cli_column_list(const rp_table *table, const char *names, size_t most, size_t *n, int columns[]);

/* The commands, in the order of the overview. */
#define CLI_COMMANDS(X)                                                                                      \
    X(lattice)                                                                                               \
    X(continuum)                                                                                             \
    X(tent)                                                                                                  \
    X(pile)                                                                                                  \
    X(angle)                                                                                                 \
    X(stress)                                                                                                \
    X(stats)                                                                                                 \
    X(run)                                                                                                   \
    X(sweep)                                                                                                 \
    X(calibrate)                                                                                             \
    X(claims)                                                                                                \
    X(forensics)                                                                                             \
    X(params)                                                                                                \
    X(bench)                                                                                                 \
    X(report)

#define X(name) extern const cli_command cmd_##name;
CLI_COMMANDS(X)
#undef X

/* Subcommands with a file of their own. */
extern const cli_command cmd_angle_slope, cmd_angle_compare, cmd_angle_phi, cmd_stress_dip,
    cmd_stress_critical, cmd_stats_fit, cmd_stats_trend, cmd_stats_size, cmd_stats_threshold, cmd_stats_cost;

#endif
