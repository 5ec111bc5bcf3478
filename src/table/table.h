/* Tables: tab-separated text. Lines that start with '#' hold the provenance and, last, the units. The names
 * of the columns follow in a line of their own. Numbers have the shortest form that reads back to the same
 * bits; "nan" marks a missing result, and the status column gives the reason. */
#ifndef RP_TABLE_H
#define RP_TABLE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

#include "core/status.h"
#include "params/units.h"

RP_C_BEGIN

/* Header lines: program, version, commit, compiler, libraries, the command (may be NULL), and units other
 * than cgs. */
void rp_table_provenance(FILE *out, rp_units units, const char *command);

/* One more header line, "# key: text", of at most 8191 bytes, made plain by rp_plain. */
void rp_table_note(FILE *out, const char *key, const char *format, ...) __attribute__((format(printf, 3, 4)));

/* The header line "# key: value text", the number in its shortest form; `text` is its unit. */
void rp_table_note_number(FILE *out, const char *key, double value, const char *text);

/* The line of units and the names of the columns. `columns` holds n pairs name, unit in cgs: the table has
 * the label of its units. */
void rp_table_columns(FILE *out, rp_units units, size_t n, const char *const columns[][2]);

/* The same lines from a list "name, name [unit], ...". */
void rp_table_header(FILE *out, rp_units units, const char *columns);

/* The cells of n numbers, without the end of the line. */
void rp_table_numbers(FILE *out, size_t n, const double values[]);

/* One row of n numbers. */
void rp_table_row(FILE *out, size_t n, const double values[]);

/* One row of n numbers and a last column of one word, such as a status. */
void rp_table_row_word(FILE *out, size_t n, const double values[], const char *word);

/* Where a row stands: its file, a borrowed name, and line. */
typedef struct {
    const char *path;
    size_t line;
} rp_place;

/* A table read whole. cells[row * n_columns + column] are texts. */
typedef struct {
    size_t n_rows, n_columns;
    char **names, **cells;
    char *text;       /* the file's bytes, which names and cells point into */
    rp_place *places; /* of each row */
    const char *path; /* borrowed */
} rp_table;

/* Read `path` ("-": standard input). Tabs, blanks or commas separate the cells; tabs alone do in a row that
 * has one cell a column only so. Quotes around a cell are no part of it. The names stand in the first line,
 * or in the last line with '#' above a first row with numbers, as older tables have it; a table without names
 * has columns "1", "2", ... The first column of a table with an index, which has no name, is "index". A row
 * that repeats the names is left out. Free with rp_table_free, also after an error. Errors: RP_BAD_INPUT
 * (missing file, control characters, rows of unequal length), RP_IO, RP_NO_MEMORY. */
rp_status rp_table_read(const char *path, rp_table *table);

/* The rows of `more`, whose texts are borrowed, after those of `table`; messages on the whole name the path
 * of `table`. Of runs, whose first column is "run", those that `table` has under another number are left out.
 * Errors: RP_BAD_INPUT for other columns or units, RP_NO_MEMORY. */
rp_status rp_table_append(rp_table *table, const rp_table *more);

/* As rp_table_read, of a text from malloc, which the table takes; `name` is for messages, and borrowed. Its
 * cells may hold blanks: only tabs separate them, or commas in a table without tabs. */
rp_status rp_table_parse(const char *name, char *text, rp_table *table);
void rp_table_free(rp_table *table);

/* File and line of a row, for "%s:%zu" in a message; the text of a cell. */
#define RP_PLACE(table, row) (table)->places[row].path, (table)->places[row].line
const char *rp_cell(const rp_table *table, size_t row, int column);

/* Index of a column, or -1. */
int rp_table_column(const rp_table *table, const char *name);

/* The same; the message of the error shows the names that are `expected`, as "x y r", and those that the
 * table has. Errors: RP_BAD_INPUT. */
rp_status rp_table_find(const rp_table *table, const char *name, const char *expected, int *column);

/* Refuse a table of grains without names of columns: RP_BAD_INPUT, with its first row. */
rp_status rp_table_nameless(const rp_table *table);

/* The text of the header line "# key: text", or NULL, and that of the next such line. Only for tables with
 * rows. */
const char *rp_table_find_note(const rp_table *table, const char *key);
const char *rp_table_next_note(const rp_table *table, const char *key, const char *previous);

/* The units that its header names. */
rp_units rp_table_units(const rp_table *table);

/* Is a whole text a number? */
bool rp_text_number(const char *text, double *value);

/* A cell as a number; "nan", "infinite", "inf" and "-inf" are allowed only if `missing_ok`. Errors:
 * RP_BAD_INPUT with file, line, column. */
rp_status rp_table_number(const rp_table *table, size_t row, int column, int missing_ok, double *value);

RP_C_END

#endif
