/* Cells of tables that claims and pages name by "TABLE key=value ... COLUMN". All stays in an arena. */
#ifndef REPORT_CELLS_H
#define REPORT_CELLS_H

#include <stdbool.h>

#include "core/arena.h"
#include "core/status.h"
#include "stats/stats.h"
#include "table/columns.h"
#include "table/where.h"

/* Where tables are looked for, and those that have been read, each once. */
typedef struct {
    rp_arena *arena;
    const char *folders; /* joined by commas: a table is that of the first folder that holds it */
    struct report_read *read;
} report_tables;

/* NAME.tsv; *table is NULL where no folder holds it. Errors: those of rp_table_read. */
rp_status report_table(report_tables *tables, const char *name, const rp_table **table);

/* The words of a text, which blanks separate. */
typedef struct {
    int n;
    char **word;
} report_words;
report_words report_split(rp_arena *arena, const char *text);

/* A cell by "TABLE key=value ... COLUMN", several that are pooled, "CELL + CELL ...", or the difference of
 * two such numbers, "CELL ... less CELL ...". */
typedef struct report_reference {
    const char *text, *table, *column;
    size_t n;
    const char **conditions;
    struct report_reference *next; /* pooled with this one; NULL: the last */
    struct report_reference *less; /* of the first: what is taken off; NULL: nothing */
} report_reference;

/* Errors: RP_BAD_INPUT (no column). */
rp_status report_reference_read(rp_arena *arena, const char *text, report_reference **reference);

/* Which rows a reference reads, *table NULL where no folder holds it. Errors: RP_BAD_INPUT (no such
 * column). */
rp_status report_rows(report_tables *tables, const report_reference *reference, const rp_table **table,
                      bool **rows);

/* One cell of a table. */
typedef struct {
    const rp_table *table; /* NULL where no folder holds it */
    size_t row;
    const char *column;
} report_cell;

/* Errors: RP_BAD_INPUT (no such column, rows other than one), those of rp_table_read. */
rp_status report_cell_find(report_tables *tables, const report_reference *reference, report_cell *cell);

/* The text in another column of the cell's row, or for #KEY in a header line; NULL if there is none. */
const char *report_cell_text(const report_cell *cell, const char *column);

/* The number in another column, NaN if there is no such column. Errors: RP_BAD_INPUT. */
rp_status report_cell_column(const report_cell *cell, const char *column, double *value);

/* A number as it is printed, and with the error that decides: that of a mean by Student's t, that of a fit or
 * a bootstrap as it stands. How many values are behind it, NaN where the table does not say. */
typedef struct {
    stats_number shown, tested;
    double n;
} report_number;

/* Value and standard error of a cell: NAME_mean and NAME_se, or NAME_deg and NAME_se_deg, or NAME and
 * NAME_se, of NAME_n or n values; the error of a line widened by sqrt(chi2/dof) > 1. A quantity without a
 * column for its error is exact, save a standard deviation NAME_sd. Column #KEY is the number that a header
 * line starts with. Errors: RP_BAD_INPUT. */
rp_status report_cell_number(const report_cell *cell, report_number *number);

/* The number of a cell, or of several: of all their values the mean, or of columns NAME_sd the standard
 * deviation. A table that is not there leaves *missing true. Errors: those of report_cell_find and
 * report_cell_number. */
rp_status report_number_find(report_tables *tables, const report_reference *reference, report_cell *cell,
                             report_number *number, bool *missing);

/* a - b with independent errors. */
stats_number report_difference(stats_number a, stats_number b);

/* Decimals that show two significant digits of an error > 0. */
int report_decimals(double se);

/* "18.04 ± 0.92", two significant digits of the error; "not known" for NaN, "inf" or "-inf". */
const char *report_number_text(rp_arena *arena, stats_number number);

/* ---- the sweeps whose runs answer a claim, and those of their runs that have no result ---- */

/* A sweep by the name in the header lines "# source: NAME DIGEST RUNS" of the tables made of its runs. */
typedef struct report_sweep {
    const char *name;
    const char
        *failed; /* of NAME/points: runs without a result, "8 of 15 (no_pile 6, overlap 2)"; "": none */
    struct report_sweep *next;
} report_sweep;

/* Add the sweeps behind both sides of a claim to a list, NULL at first. A side is a cell or several cells
 * that are pooled; NULL: a number, or none. Errors: those of rp_table_read, RP_BAD_INPUT. */
rp_status report_sweeps(report_tables *tables, const report_reference *answer,
                        const report_reference *against, report_sweep **sweeps);

/* Runs without a result behind the rows that both sides read, with their causes and how the mean changes
 * without them: "11 of 185 (no_response 11): the weakest piles are left out, theta_T is too large"; "" if
 * there are none. Errors: as above. */
rp_status report_failed(report_tables *tables, const report_reference *answer,
                        const report_reference *against, const char **text);

#endif
