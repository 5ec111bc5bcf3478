/* Conditions on the rows of a table, as --where and the report's references have them. */
#ifndef RP_WHERE_H
#define RP_WHERE_H

#include "table/table.h"

RP_C_BEGIN

/* An expression of columns (params/expression.h), as "x > 2*r and floor=ends". In it NAME=VALUE and
 * NAME!=VALUE compare a cell as it stands: numbers are equal to 12 digits, words letter by letter;
 * NAME=smallest and NAME=largest are one row of the whole table, the first of equal ones. Elsewhere a row
 * with nan or a word in a column that decides does not meet the condition. */

/* Leave those of the n_rows marked rows that meet a condition. Errors: RP_BAD_INPUT (no such column, no
 * expression), RP_NO_MEMORY. */
rp_status rp_rows_mark(const rp_table *table, const char *condition, bool rows[]);

/* Keep the rows of a table that meet a condition. Errors: as above. */
rp_status rp_table_where(rp_table *table, const char *condition);

RP_C_END

#endif
