/* Columns of a table as arrays of numbers, groups of rows. */
#ifndef RP_COLUMNS_H
#define RP_COLUMNS_H

#include <stdbool.h>

#include "core/arena.h"
#include "table/table.h"

RP_C_BEGIN

/* As rp_table_parse, or for a text NULL as rp_table_read; the table is freed with the arena. */
rp_status rp_table_keep(rp_arena *arena, const char *path, char *text, rp_table **table);
rp_status rp_table_load(rp_arena *arena, const char *path, rp_table **table);

/* Errors: RP_USAGE for a list of columns, such as an option that names one column can't have. */
rp_status rp_one_column(const char *option, const char *name);

/* The columns of the list `names`, or all of them for "all", as a new array. Errors: RP_BAD_INPUT. */
rp_status rp_columns(rp_arena *arena, const rp_table *table, const char *names, size_t *n, int **columns);

/* Names of the columns that are none of `names`, ", a, b [unit]", each after a blank. */
void rp_columns_beside(const rp_table *table, const char *names, char text[256]);

/* Refuse rows of several steps: a table of states may hold a pile at several times. Errors: RP_BAD_INPUT. */
rp_status rp_table_one_step(const rp_table *table);

/* The columns of the list `names` as new arrays of finite numbers, one after the other in one block; of a
 * table, and of one in a file. Errors: RP_BAD_INPUT; those of rp_table_read. */
enum { RP_MOST_COLUMNS = 32 };
rp_status rp_columns_read(rp_arena *arena, const rp_table *table, const char *names, double **block);
rp_status rp_columns_read_file(rp_arena *arena, const char *path, const char *names, double **block,
                               size_t *n_rows);

/* Is this status that of a full result, ok or ok_...? */
bool rp_is_result(const char *status);

/* Status words, in SQL, that the machine decides and not the physics: a sweep makes such a run again. */
#define RP_MACHINE_STATUS "('crashed', 'no_memory', 'time_limit')"

/* Columns of a sweep's tables of runs and points, beside parameters and outputs. */
#define RP_SWEEP_COLUMNS "run status seconds pile replica n n_failed failed_for"

/* How often words occur, such as statuses; as a text "no_pile:2,overlap:1", "-" for none. A text is added
 * with a weight, and may also be "no_pile 2, overlap 1" before a parenthesis; a word alone has NaN. */
typedef struct {
    size_t n;
    struct {
        char word[24];
        double times;
    } of[32];
} rp_tally;
void rp_tally_add(rp_tally *tally, const char *word, size_t length, double times);
void rp_tally_add_text(rp_tally *tally, const char *text, double weight);
void rp_tally_text(const rp_tally *tally, char text[1024]);

/* Rows of a table grouped by their cells in the columns `by` ("a" or "a,b,..."; "none": one group). */
typedef struct {
    size_t n_groups;
    size_t *of_row;
    const char *
        *words; /* in the order in which they appear: the cells of each group, joined by the separator */
} rp_groups;

/* Errors: RP_BAD_INPUT. */
rp_status rp_group_rows(rp_arena *arena, const rp_table *table, const char *by, char separator,
                        rp_groups *groups);

/* The cells n_failed and failed_for: rows without a result among those that a row of a derived table reads,
 * of this group (groups NULL: of all), with a number from range[0] to range[1] in column x (range NULL: any),
 * and their causes, as in "no_pile:2,overlap:1", "-" for none. A table of grid points has both in columns. */
#define RP_FAILED_COLUMNS "n_failed, failed_for"
const char *rp_failed_text(rp_arena *arena, const rp_table *table, const rp_groups *groups, size_t group,
                           const char *x, const double range[2]);

/* Which rows count. Zero: those whose status, if there is such a column, starts with ok, and without nan. */
typedef struct {
    bool any_status;
    const double *range;     /* least and largest number in the first column; NULL: any */
    const rp_groups *groups; /* ordered by these, */
    bool grouped;            /* or by the numbers of the first column, each a group; else as in the table */
} rp_choice;

/* Rows as columns of numbers. */
typedef struct {
    size_t n, n_failed, n_nan, n_outside; /* rows that count; left out for status, nan, range */
    double *column[RP_MOST_COLUMNS];      /* of the list of names */
    size_t *row;                          /* each row's index in the table */
    size_t n_groups, *first;              /* first[g] <= i < first[g + 1] in group g */
} rp_rows;

/* Errors: RP_BAD_INPUT; RP_NO_RESULT without a row that counts. */
rp_status rp_rows_read(rp_arena *arena, const rp_table *table, const char *names, const rp_choice *choice,
                       rp_rows *rows);

/* The name of a column, or its number where it has none, by way of `text`. */
const char *rp_column_name(const rp_table *table, int column, char text[12]);

/* The unit of a column as the table's header has it, "1" where it has none. */
void rp_column_unit(const rp_table *table, int column, char unit[32]);

/* The header of a table whose first columns are those of the list `by` ("none": none), with their units,
 * before its own. Errors: RP_BAD_INPUT. */
rp_status rp_header_by(const rp_table *table, const char *by, const char *own, FILE *out);

RP_C_END

#endif
