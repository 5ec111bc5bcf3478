/* Conditions on the rows of a table, as --where and the report's references have them. */
#ifndef RP_WHERE_H
#define RP_WHERE_H

#include "table/table.h"

RP_C_BEGIN

/* A cell as it stands, "floor=ends", "W=2:4", "W=largest" or with !=: numbers are equal to 12 digits, words
 * letter by letter, and nan to nan; FROM:TO is a range with its ends; smallest and largest are one row of the
 * whole table. Or an expression of columns, "eps<1e-5", "x > 2*r and W == 4" (params/expression.h): it does
 * not hold for a row with nan or a word in one of them. */
typedef struct {
    char column[64]; /* the name before the first sign */
    bool differs;
    const char *value, *text; /* borrowed; value NULL: of an expression */
} rp_condition;

/* Errors: RP_BAD_INPUT (no comparison, or a cell's among others). */
rp_status rp_condition_read(const char *text, rp_condition *condition);

/* Leave those of the n_rows marked rows that meet n conditions. Errors: RP_BAD_INPUT (no such column, no
 * expression), RP_NO_MEMORY. */
rp_status rp_conditions_mark(const rp_table *table, size_t n, const rp_condition conditions[], bool rows[]);

/* Keep the rows of a table that meet a condition. Errors: as above; RP_NO_MEMORY. */
rp_status rp_table_where(rp_table *table, const char *condition);

RP_C_END

#endif
