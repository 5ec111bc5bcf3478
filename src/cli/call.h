/* What a command was called with: the values of its options, its arguments, its memory. It is handed on. */
#ifndef CLI_CALL_H
#define CLI_CALL_H

#include <gsl/gsl_rng.h>
#include <stdbool.h>
#include <stdio.h>

#include "core/arena.h"
#include "params/params.h"
#include "table/table.h"

struct cli_command;

/* A program of commands. */
typedef struct {
    const char *name, *title;                  /* as it is typed, as it is written */
    const char *about;                         /* in one line */
    const struct cli_command *const *commands; /* in the order of the overview, to NULL */
    const struct cli_removed *removed;         /* to a NULL name; NULL: none */
} cli_program;

typedef struct {
    rp_arena *arena; /* of the whole command */
    const cli_program *program;
    const char *line;    /* the command line, for provenance */
    const char *lineage; /* further header lines of its table; may be NULL */
    const struct cli_command *command;
    rp_param *options; /* of the command, with names as they are typed */
    bool *given;       /* each option: on the command line? */
    void *values;
    size_t n_own; /* options of the command itself; those after them are of every command */
    int n_arguments;
    char *const *arguments;
} cli_call;

/* Argument number i, NULL beyond their end. */
const char *cli_argument(const cli_call *call, int i);

/* Index of an option, and whether it was given. The command must have it. */
size_t cli_option(const cli_call *call, const char *name);
bool cli_given(const cli_call *call, const char *name);

/* Generator of resamples: stream `run` of the option --seed, which the command must have. */
gsl_rng *cli_random(const cli_call *call, unsigned long run);

/* The defaults of options that are not given again, once a table has told its system of units. */
void cli_defaults_in_units(const cli_call *call);

/* A file that the program brings along, as "sweeps/lh/lh3.cfg", by this name in the current folder; else in
 * the data folder. That is the one REPOSE_DATA names; where it is not set, ../share/repose next to the
 * program, or the source that the program was built in. The name itself where there is no such file. */
const char *cli_data(rp_arena *arena, const char *name);

/* The tables of all arguments as one; *n_first (may be NULL): rows of the first. Errors: those of
 * rp_table_read and rp_table_append. */
rp_status cli_tables_read(const cli_call *call, rp_table **table, size_t *n_first);

/* Start a table with provenance; cli_table notes the numbers and words among the options' values too. */
void cli_provenance(const cli_call *call, FILE *out);
void cli_table(const cli_call *call, FILE *out);

/* Values of CLI_POSITIONS as a new array of fractions of the base; points -1, at "auto": not given.
 * Errors: RP_USAGE (both given), RP_BAD_INPUT (not numbers in [0, 1]). */
rp_status cli_positions(rp_arena *arena, long points, const char *at, double **x, size_t *n);

#endif
