/* Conditions on the rows of a table, as --where and the report's references have them. */
#ifndef RP_WHERE_H
#define RP_WHERE_H

#include "table/table.h"

RP_C_BEGIN

/* "floor=ends", "eps<1e-5", "W=2:4", "W=largest": a column's name, one of = != < <= > >=, a value. Numbers
 * are equal to 12 digits, words letter by letter, and nan to nan; an order of words does not hold, and
 * neither does one with nan. FROM:TO is a range with its ends; smallest and largest are one row of the whole
 * table. */
typedef struct {
    char column[64], op[3];
    const char *value; /* borrowed */
} rp_condition;

/* Errors: RP_BAD_INPUT (no operator, an order of words). */
rp_status rp_condition_read(const char *text, rp_condition *condition);

/* Leave those of the n_rows marked rows that meet n conditions. Errors: RP_BAD_INPUT (no such column). */
rp_status rp_conditions_mark(const rp_table *table, size_t n, const rp_condition conditions[], bool rows[]);

/* Keep the rows of a table that meet a condition. Errors: as above; RP_NO_MEMORY. */
rp_status rp_table_where(rp_table *table, const char *condition);

RP_C_END

#endif
