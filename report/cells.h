/* Cells of the tables that claims and the report name by "TABLE key=value ... COLUMN". */
#ifndef REPORT_CELLS_H
#define REPORT_CELLS_H

#include <stdbool.h>
#include <stdio.h>

#include "core/status.h"
#include "table/table.h"
#include "stats/verdict.h"

enum { CLI_MAX_WORDS = 24, CLI_MAX_REFERENCE = 512 };

/* A text split at blanks, in place. */
typedef struct {
    char text[CLI_MAX_REFERENCE];
    char *words[CLI_MAX_WORDS];
    int n;
} cli_words;

/* Errors: RP_BAD_INPUT for a text that is too long or has too many words. */
rp_status cli_split(const char *text, cli_words *words);

/* Whether a row matches all of the words first <= w < last, each key=value, or for numbers key=FROM:TO,
 * key=smallest or key=largest, which is that of the whole table.
 * Errors: RP_BAD_INPUT for a column that the table does not have. */
rp_status cli_row_matches(const rp_table *table, size_t row, const cli_words *words, int first, int last,
                          bool *matches);

/* Path of NAME.tsv in the first of `folders`, joined by commas, that has it; false if none has. */
bool cli_find_table(const char *folders, const char *name, char path[4096]);

/* The sweep whose runs a table comes from: NAME of NAME.tsv or of NAME_*.tsv, the longest such name with a
 * header line `sweep`. False if there is none. */
typedef struct {
    char name[128];
    char failed[512]; /* runs without a result, "8 of 15 (no_pile 6, overlap 2)"; "" if there are none */
} cli_sweep;
bool cli_find_sweep(const char *folders, const char *table, cli_sweep *sweep);

/* One cell of a table. */
typedef struct {
    rp_table *table;
    char path[4096];
    size_t row;
    cli_words words;    /* of the reference */
    const char *column; /* its last word */
    bool missing;       /* no folder has the table: nothing else is set */
} cli_cell;

/* Errors: RP_BAD_INPUT (no such column, rows other than one), those of rp_table_read. */
rp_status cli_cell_find(const char *folders, const char *reference, cli_cell *cell);

/* The text in another column of the cell's row, or for #KEY in a header line; NULL if there is none. */
const char *cli_cell_text(const cli_cell *cell, const char *column);

/* Value and standard error: NAME_mean and NAME_se, or NAME_deg and NAME_se_deg, or NAME and NAME_se; a
 * quantity without a column for its error is exact, save a standard deviation NAME_sd: its error follows from
 * NAME_n, or n, values. Column #KEY is the number that a header line starts with.
 * Errors: RP_BAD_INPUT. */
rp_status cli_cell_number(const cli_cell *cell, stats_number *number);

/* Whether the cell's column is the standard deviation of a table's values, NAME_sd. */
bool cli_cell_is_deviation(const cli_cell *cell);

/* The number in another column, NaN if there is no such column. Errors: RP_BAD_INPUT. */
rp_status cli_cell_column(const cli_cell *cell, const char *column, double *value);

/* Decimals that show two significant digits of an error > 0. */
int cli_decimals(double se);

/* "18.04 ± 0.92", two significant digits of the error; "not known" for NaN, "inf" or "-inf". */
void cli_print_number(FILE *out, stats_number number);

/* A cell's text under a format such as %.3g or %.0f; without one a count stands as it is, other numbers take
 * %.3g. Errors: RP_BAD_INPUT for any other format. */
rp_status cli_print_text(FILE *out, const char *text, const char *format);

#endif
