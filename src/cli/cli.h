/* The command line: commands, their options, and what several of them share. One file per command; no physics
 * here. */
#ifndef CLI_H
#define CLI_H

#include <math.h>

#include "core/file.h"
#include "core/folder.h"
#include "sweeps/protocols/protocols.h"
#include "table/columns.h"

/* ---- what a command was called with: its options' values, its arguments, its memory ---- */

struct cli_command;

/* A program of commands. */
typedef struct {
    const char *name, *title;                  /* as it is typed, as it is written */
    const char *about;                         /* in one line */
    const struct cli_command *const *commands; /* in the order of the overview, to NULL */
} cli_program;

typedef struct {
    rp_arena *arena; /* of the whole command */
    const cli_program *program;
    const char *line;    /* the command line, for provenance */
    FILE *out;           /* what it prints goes there */
    rp_units units;      /* of what it reads, and of its table */
    const char *lineage; /* further header lines of its table; may be NULL */
    const struct cli_command *command;
    rp_param *options; /* of the command, with names as they are typed */
    bool *given;       /* each option: on the command line? */
    void *values;
    int n_arguments;
    char *const *arguments;
} cli_call;

/* Argument number i, NULL beyond their end. */
const char *cli_argument(const cli_call *call, int i);

/* The value of an option, NULL where the command has none; whether one of its own was given. */
void *cli_value(const cli_call *call, const char *name);
bool cli_given(const cli_call *call, const char *name);

/* Start a table with provenance; cli_table notes the numbers and words among the options' values too. */
void cli_provenance(const cli_call *call, FILE *out);
void cli_table(const cli_call *call, FILE *out);

/* A line on standard error, whatever texts of strangers it has. */
void cli_say(const char *format, ...) __attribute__((format(printf, 1, 2)));

/* ---- commands and their options ---- */

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
      "use only rows that meet a condition, such as floor=ends, W != 4 or x > 1 and y <= 2*x; may be "       \
      "repeated")
#define CLI_BY(X, fallback, what)                                                                            \
    X(TEXT, by, "", fallback, "",                                                                            \
      "columns (a or a,b,...): rows with equal values in them form one of the " what)
#define CLI_RANGE(X, what)                                                                                   \
    X(REAL, from, "", "none", "(-inf, inf) | none", "smallest " what " that is used")                        \
    X(REAL, to, "", "none", "(-inf, inf) | none", "largest " what " that is used")
#define CLI_RANGE_OF(o) ((double[]){isinf((o)->from) ? -INFINITY : (o)->from, (o)->to})
#define CLI_PHI(X)                                                                                           \
    X(REAL, phi_deg, "deg", "60", "(0, 90)", "inclination of the rays of force to the horizontal")
#define CLI_WORKERS(X) X(INT, j, "", "auto", "[1, 4096] | auto", "worker processes; auto: one per processor")
#define CLI_LIMITS(X)                                                                                        \
    X(REAL, mem, "MB", "infinite", "(0, inf) | infinite", "memory limit of one run")                         \
    X(REAL, time, "s", "infinite", "(0, inf) | infinite", "time limit of one run")
#define CLI_QUIET(X) X(BOOL, quiet, "", "false", "", "no progress and no closing line on standard error")
#define CLI_POSITIONS(X)                                                                                     \
    X(INT, points, "", "auto", "[2, 10000000] | auto",                                                       \
      "number of equidistant positions from 0 to B; auto: 201 unless --at is given")                         \
    X(TEXT, at, "", "auto", "", "positions as fractions of B, such as 0.1,0.25")

/* One command: text of --help, options of the parser, and the function that acts on their values. Options of
 * one letter take one dash. Each line of the synopsis is a way to call the command; its first word in
 * capitals is an argument, with three dots after it one or more, in brackets an optional one. */
typedef struct cli_command {
    const char *name;     /* "angle tilt" */
    const char *summary;  /* in the overview of its group */
    const char *synopsis; /* arguments and options on the usage line */
    const char *about;    /* one or more lines */
    const char *example;
    const rp_param *(*options)(void); /* schema; NULL: none */
    const char *refuses;              /* lines: what is refused, and what to do instead */
    rp_status (*act)(cli_call *call, const void *values);
    rp_status (*on_table)(cli_call *call, rp_table *table, const void *values); /* of the arguments, with the
                                                                                   rows that --where leaves */
    const struct cli_command *const *group; /* subcommands, to NULL; no `act` */
    const rp_param *protocol;               /* schema whose options come first, and the size of its values */
    size_t protocol_size;
    bool derives; /* a table from a table of runs, or from piles: for settings `derive` */
} cli_command;

/* The options of a command as they are typed, with their defaults, in call->options and call->values. */
void cli_options_of(cli_call *call, const cli_command *command);

/* Parse argv[1..] into the call's options and arguments. Boolean options take no value. *helped: --help
 * was asked for and printed. Errors: RP_USAGE (unknown option, missing value, required option or
 * argument), RP_BAD_INPUT (a value). */
rp_status cli_parse(cli_call *call, const cli_command *command, int argc, char **argv, bool *helped);

/* Parse argv[1..] and act. --help prints its text. Errors: those of cli_parse, RP_USAGE for an unknown
 * subcommand, and the action's own. */
rp_status cli_run(cli_call *call, const cli_command *command, int argc, char **argv);

/* Act, what the command prints going to `out`; `table` in place of the arguments' tables, NULL: these.
 */
rp_status cli_act_into(cli_call *call, rp_table *table, FILE *out);

/* The header of a call's table has the lines `source` of the table that it is made of. */
void cli_sources(cli_call *call, const rp_table *table);

/* The one of these commands whose own name is `word`; NULL: none. */
const cli_command *cli_find(const cli_command *const *among, const char *word);

/* The error of a word that is no command of the group, or for NULL of the program, with the nearest
 * one. */
rp_status cli_unknown_command(const cli_program *program, const char *word, const cli_command *group);

/* What --help of a group prints, or for NULL that of the program. */
void cli_overview(const cli_program *program, const cli_command *group, FILE *out);

/* The main function of a program. */
int cli_main(const cli_program *program, int argc, char **argv);

/* The program `repose`. */
extern const cli_program cli_repose;

/* The text of an option in help, meaning, unit, range and default. What stands before its name: one
 * dash before a letter, else two. The last word of a command's name, the one to type. */
const char *cli_option_text(rp_arena *arena, const rp_param *option);
const char *cli_dashes(const rp_param *option);
const char *cli_own_name(const cli_command *command);

/* sweep_run with these options, workers below 1: one per processor; its progress unless `quiet`, and
 * a line for each run that fails. */
rp_status cli_sweep_run(const char *dir, sweep_options options, bool quiet, sweep_counts *counts);

/* sweep_export of a folder into a table, and into a file, "-": standard output. */
rp_status cli_sweep_table(const cli_call *call, const char *path, unsigned what, rp_table **table,
                          sweep_counts *counts);
rp_status cli_sweep_export(const cli_call *call, const char *dir, unsigned what, const char *path,
                           bool replace, sweep_counts *counts);

/* The row of one run, and before it the columns: those of parameters (NULL: without), of
 * results, and its status. */
void cli_result_row(const cli_call *call, const rp_param *schema, const void *parameters,
                    const sweep_output *outputs, const sweep_result *result);

/* How many runs are planned, stored and missing, and how many have which status. */
void cli_print_counts(const cli_call *call, const sweep_counts *counts);

/* May this sweep's file be planned in the folder? Not over another sweep, unless by `force`. Errors:
 * RP_BAD_INPUT; RP_IO. */
rp_status cli_claim_sweep(const char *directory, const char *file, bool force);

/* Plan it there, with progress. Errors: those of sweep_prepare. */
rp_status cli_sweep_plan(const char *file, const char *directory, size_t replicas, bool quiet,
                         sweep_counts *counts);
#define CLI_FORCE(X, what) X(BOOL, force, "", "false", "", what)

/* One degree in radians, and the number of an array's elements. */
static const double deg = M_PI / 180.0;
#define N_OF(array) (sizeof(array) / sizeof *(array))

/* The text of a cell, which is never empty: "-" for none. */
static inline const char *cli_cell(const char *text)
{
    return text && *text ? text : "-";
}

/* One row of numbers that `call` prints, and one with a word in the last column. */
#define CLI_NUMBERS(...)                                                                                     \
    sizeof((double[]){__VA_ARGS__}) / sizeof(double), (double[])                                             \
    {                                                                                                        \
        __VA_ARGS__                                                                                          \
    }
#define CLI_ROW(...)            rp_table_row(call->out, CLI_NUMBERS(__VA_ARGS__))
#define CLI_ROW_WORD(word, ...) rp_table_row_word(call->out, CLI_NUMBERS(__VA_ARGS__), word)

/* The commands, and subcommands with a file of their own. */
extern const cli_command cmd_lattice, cmd_continuum, cmd_tent, cmd_pile, cmd_angle, cmd_stress, cmd_stats,
    cmd_run, cmd_view, cmd_sweep, cmd_export, cmd_calibrate, cmd_params, cmd_bench, cmd_help;
extern const cli_command cmd_sweep_make, cmd_angle_slope;

#endif
