/* Shared functions of the command line. One file per subcommand; no physics here. */
#ifndef CLI_H
#define CLI_H

#include <gsl/gsl_rng.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>

#include "params/params.h"
#include "core/file.h"
#include "core/status.h"
#include "table/table.h"
#include "sweeps/protocols/protocols.h"

/* One option of a command is X(type, name, unit, default, range, meaning), as in rp_param: type REAL, INT,
 * BOOL, ..., name with underlines for dashes, default NULL for a required one. CLI_OPTIONS(name, LIST) makes
 * of a list of options the structure name_options of their values and their schema name_params. */
#define CLI_OPTIONS(name, LIST)                                                                              \
    typedef struct {                                                                                         \
        LIST(CLI_FIELD)                                                                                      \
    } name##_options;                                                                                        \
    static const rp_param *name##_params(void)                                                               \
    {                                                                                                        \
        typedef name##_options T;                                                                            \
        static const rp_param rows[] = {LIST(CLI_PARAM){0}};                                                 \
        return rows;                                                                                         \
    }
#define CLI_FIELD(type, name, ...) CLI_FIELD_##type name;
#define CLI_FIELD_REAL             double
#define CLI_FIELD_INT              long
#define CLI_FIELD_BOOL             bool
#define CLI_FIELD_CHOICE           int
#define CLI_FIELD_TEXT             const char *
#define CLI_FIELD_TEXTS            rp_texts
#define CLI_PARAM(type, name, unit, fallback, range, meaning)                                                \
    {#name, unit, RP_##type, offsetof(T, name), fallback, range, meaning},

/* Options that several commands have. */
#define CLI_WHERE(X)                                                                                         \
    X(TEXTS, where, "", "", "",                                                                              \
      "use only rows with NAME=VALUE, or != < <= > >=; several conditions must all hold")
#define CLI_SEED(X, fallback, meaning) X(INT, seed, "", fallback, "[0, 2147483647]", meaning)
#define CLI_BOOTSTRAP(X, fallback)                                                                           \
    X(INT, bootstrap, "", fallback, "[2, 10000000]", "resamples of the piles")                               \
    CLI_SEED(X, "1993", "seed of the resamples")
#define CLI_BY(X, fallback, what)                                                                            \
    X(TEXT, by, "", fallback, "", "columns (a or a,b,...) whose different cells make the " what)
#define CLI_RANGE(X, what)                                                                                   \
    X(REAL, from, "", "-1e308", "(-inf, inf)", "smallest " what " that is used")                             \
    X(REAL, to, "", "1e308", "(-inf, inf)", "largest " what " that is used")
#define CLI_PHI(X)     X(REAL, phi_deg, "deg", "60", "(0, 90)", "inclination of the rays of force")
#define CLI_WORKERS(X) X(INT, j, "", "auto", "[1, 4096] | auto", "worker processes; auto: one per processor")
#define CLI_QUIET(X)   X(BOOL, quiet, "", "false", "", "no progress and no closing line on standard error")
#define CLI_POSITIONS(X)                                                                                     \
    X(INT, points, "", "auto", "[2, 10000000] | auto",                                                       \
      "number of equidistant positions from 0 to B; auto: 201 unless --at is given")                         \
    X(TEXT, at, "", "auto", "", "positions as fractions of B, as in 0.1,0.25")

/* One command: text of --help, options of the parser, and the function that acts on their values. Options of
 * one letter take one dash. A first word of the synopsis in capitals is an argument, with three dots after it
 * one or more, in brackets an optional one. */
typedef struct cli_command {
    const char *name;     /* "angle tilt" */
    const char *summary;  /* in the overview of its group */
    const char *synopsis; /* arguments and options on the usage line */
    const char *about;    /* one or more lines */
    const char *example;
    const rp_param *(*options)(void); /* schema; NULL: none */
    rp_status (*act)(void *values);
    rp_status (*on_table)(rp_table *table, void *values); /* the argument, rows as --where has it */
    const struct cli_command *const *group;               /* subcommands, to NULL; no `act` */
    const rp_param *protocol; /* schema whose options come first, and the size of its values */
    size_t protocol_size;
    bool prints_text; /* or nothing: the others print a table, which has --json */
} cli_command;

/* A program of commands. */
typedef struct {
    const char *name; /* as it is typed */
    const cli_command *const *commands;
    void (*overview)(FILE *out); /* what --help prints */
} cli_program;

/* The main function of a program, and the program that it began with. */
int cli_main(const cli_program *program, int argc, char **argv);
const cli_program *cli_this_program(void);

/* Parse argv[1..] by the options' schema into `values` (defaults first; the rest is 0), and act. Boolean
 * options take no value. --help prints its text. Errors: RP_USAGE (unknown option or subcommand, missing
 * value, required option or argument), RP_BAD_INPUT (a value), and the action's own. */
rp_status cli_run(const cli_command *command, int argc, char **argv);

/* The options of a command as they are typed, until the next call or parse. Errors: RP_BROKEN. The text of
 * one in help, meaning, unit, range and default; returns `text`. */
rp_status cli_options_of(const cli_command *command, const rp_param **options);
const char *cli_option_text(const rp_param *option, char *text, size_t size);

/* What stands before its name: one dash before a letter, else two. */
const char *cli_dashes(const rp_param *option);

/* The last word of a command's name, the one to type. */
const char *cli_own_name(const cli_command *command);

/* The error of a word that is none of these commands, with the nearest one; `group`: "" or their group's
 * name.
 */
rp_status cli_unknown_command(const char *word, const cli_command *const *among, const char *group);

/* Of the command line that was parsed last: argument number i, NULL beyond their end; all of them; whether
 * option `name` was given. */
const char *cli_argument(int i);
char *const *cli_arguments(void);
bool cli_given(const char *name);

/* The value of --seed, an option that the command must have. */
long cli_seed(void);

/* Warn of the g of SI among values in cgs, of a file whose units have been read. */
void cli_warn_gravity(const char *path, double g);

/* The defaults again, once a table has told its system of units. */
void cli_defaults_in_units(void);

/* sweep_run with these options, workers below 1: one per processor; its progress unless `quiet`, and
 * a line for each run that fails. */
rp_status cli_sweep_run(const char *dir, sweep_options options, bool quiet, sweep_counts *counts);
enum { CLI_SNAPSHOT = 60 }; /* seconds of processor time between the snapshots of a run */

/* sweep_export into a file, "-": standard output. */
rp_status cli_sweep_export(const char *dir, unsigned what, const char *path, sweep_counts *counts);

/* How many runs are planned, stored and missing, and how many have which status. */
void cli_print_counts(const sweep_counts *counts);

/* May this run, or this sweep's file, write into the folder? Not over results of something else, unless by
 * `force`. `run` is the header line `run` of its tables, "FILE, N steps, FRAMES, key DIGITS" or "FILE row N".
 * Where a scene replaces its own results, `replaces` says which by which, else it is "". Errors:
 * RP_BAD_INPUT; RP_IO. */
enum { CLI_RUN_NOTE = 1024, CLI_REPLACES = 2 * CLI_RUN_NOTE };
rp_status cli_claim_run(const char *directory, const char *run, bool force, char replaces[CLI_REPLACES]);
rp_status cli_claim_sweep(const char *directory, const char *file, bool force);
#define CLI_FORCE(X)                                                                                         \
    X(BOOL, force, "", "false", "", "write into the folder though it holds results of something else")

/* As sweep_check_whole, of a table that was written without the runs that lack. */
rp_status cli_check_whole(const char *dir, const sweep_counts *counts);

/* For long preparations: progress on a terminal, unless `quiet`. */
const sweep_watch *cli_watch(bool quiet);

/* The command line of this process, for provenance. */
const char *cli_command_line(void);

/* Another one, that started what this process continues. */
void cli_command_line_set(const char *text);

/* Zeroed memory for n objects, a generator of resamples (stream `run` of the option --seed), a table: all
 * freed after the command, and those since a mark by cli_release. Without memory the program ends. */
void *cli_memory(size_t n, size_t size);
gsl_rng *cli_random(unsigned long run);

/* A file that the program brings along, as "sweeps/lh/lh3.cfg", by this name in the current folder; else in
 * the data folder. That is the one REPOSE_DATA names; where it is not set, ../share/repose beside the
 * program, or the source that the program was built in. The name itself where there is no such file. */
const char *cli_data(const char *name);

/* Does a text, as a file's name, end in these letters? */
bool cli_ends_in(const char *text, const char *end);

rp_status cli_table_read(const char *path, rp_table **table);              /* as rp_table_read */
rp_status cli_texts_read(const char *path, rp_table **table);              /* as rp_table_read_texts */
rp_status cli_table_parse(const char *name, char *text, rp_table **table); /* as rp_table_parse */
size_t cli_mark(void);
void cli_release(size_t mark);

/* Start a table with provenance; cli_table notes the numbers and words among the values of the options too.
 */
void cli_provenance(FILE *out);
void cli_table(FILE *out);

/* One degree in radians, and the number of an array's elements. */
static const double deg = M_PI / 180.0;
#define N_OF(array) (sizeof(array) / sizeof *(array))

/* One row of numbers, and one with a word in the last column. */
#define CLI_NUMBERS(...)                                                                                     \
    sizeof((double[]){__VA_ARGS__}) / sizeof(double), (double[])                                             \
    {                                                                                                        \
        __VA_ARGS__                                                                                          \
    }
#define CLI_ROW(...)            rp_table_row(stdout, CLI_NUMBERS(__VA_ARGS__))
#define CLI_ROW_WORD(word, ...) rp_table_row_word(stdout, CLI_NUMBERS(__VA_ARGS__), word)

/* Index of a column. Errors: RP_BAD_INPUT. */
rp_status cli_find_column(const rp_table *table, const char *name, int *column);

/* Text of a cell. */
const char *cli_text(const rp_table *table, size_t row, int column);

/* The n columns of the list `names` ("a,b,..."), at most `most`. Errors: RP_BAD_INPUT. */
rp_status cli_column_list(const rp_table *table, const char *names, size_t most, size_t *n, int columns[]);

/* The columns of the list `names`, or all of them for "all", as a new array. Errors: RP_BAD_INPUT. */
rp_status cli_columns(const rp_table *table, const char *names, size_t *n, int **columns);

/* The columns of the list `names` as new arrays of finite numbers, one after the other in one block; of a
 * table, and of one in a file. Errors: RP_BAD_INPUT; those of rp_table_read. */
enum { CLI_MOST_COLUMNS = 32 };
rp_status cli_read_columns(const rp_table *table, const char *names, double **block);
rp_status cli_read_file(const char *path, const char *names, double **block, size_t *n_rows);

/* Rows of a table grouped by their cells in the columns `by` ("a" or "a,b,..."; "none": one group). */
typedef struct {
    size_t n_groups;
    size_t *of_row;
    const char *
        *words; /* in the order in which they appear: the cells of each group, joined by the separator */
} cli_groups;

/* Errors: RP_BAD_INPUT. */
rp_status cli_group_rows(const rp_table *table, const char *by, char separator, cli_groups *groups);

/* Which rows count. Zero: those whose status, if there is such a column, starts with ok, and without nan. */
typedef struct {
    bool any_status, any_number;
    const bool *among;        /* rows of the table; NULL: all */
    const double *range;      /* least and largest number in the first column; NULL: any */
    const cli_groups *groups; /* ordered by these, */
    bool grouped;             /* or by the numbers of the first column, each a group; else as in the table */
} cli_choice;

/* Rows as columns of numbers. */
typedef struct {
    size_t n, n_failed, n_nan, n_outside; /* rows that count; left out for status, nan, range */
    double *column[CLI_MOST_COLUMNS];     /* of the list of names */
    size_t *row;                          /* each row's index in the table */
    size_t n_groups, *first;              /* first[g] <= i < first[g + 1] in group g */
} cli_rows;

/* Errors: RP_BAD_INPUT; RP_NO_RESULT without a row that counts. */
rp_status cli_rows_read(const rp_table *table, const char *names, const cli_choice *choice, cli_rows *rows);

/* The header line that says how many rows count. */
void cli_rows_note(const rp_table *table, const cli_rows *rows);

/* Values of CLI_POSITIONS as a new array of fractions of the base; points -1, at "auto": not given.
 * Errors: RP_USAGE (both given), RP_BAD_INPUT (not numbers in [0, 1]). */
rp_status cli_positions(long points, const char *at, double **x, size_t *n);

/* The unit of a column as the table's header has it, "1" where it has none. */
void cli_column_unit(const rp_table *table, int column, char unit[32]);

/* The header of a table whose first columns are those of the list `by` ("none": none), with their units,
 * before its own. Errors: RP_BAD_INPUT. */
rp_status cli_header_by(const rp_table *table, const char *by, const char *own);

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
    X(view)                                                                                                  \
    X(sweep)                                                                                                 \
    X(export)                                                                                                \
    X(calibrate)                                                                                             \
    X(params)                                                                                                \
    X(bench)                                                                                                 \
    X(help)

#define X(name) extern const cli_command cmd_##name;
CLI_COMMANDS(X)
#undef X

/* The same as an array, ended by NULL, and what `repose --help` prints. */
extern const cli_command *const cli_commands[];
void cli_overview(FILE *out);

/* Subcommands with a file of their own. */
extern const cli_command cmd_sweep_merge, cmd_sweep_slurm, cmd_sweep_salvage, cmd_angle_slope,
    cmd_angle_compare, cmd_angle_phi, cmd_stress_dip, cmd_stats_fit, cmd_stats_trend, cmd_stats_size;

#endif
