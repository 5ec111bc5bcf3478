/* Columns of a table as arrays of numbers; see cli.h. */
#include <stdlib.h>

#include "cli/cli.h"

rp_status cli_find_columns(const rp_table *table, size_t n, const char *const names[], int columns[])
{
    for (size_t c = 0; c < n; c++)
        if ((columns[c] = rp_table_column(table, names[c])) < 0)
            return rp_fail(RP_BAD_INPUT, "%s: no column \"%s\"", table->path, names[c]);
    return RP_OK;
}

rp_status cli_read_columns(const rp_table *table, size_t n, const int columns[], int missing_ok,
                           double **block)
{
    *block = malloc((n * table->n_rows + 1) * sizeof **block);
    if (!*block) return rp_fail(RP_NO_MEMORY, "%s: out of memory", table->path);
    for (size_t c = 0; c < n; c++)
        for (size_t i = 0; columns[c] >= 0 && i < table->n_rows; i++) {
            rp_status status =
                rp_table_number(table, i, columns[c], missing_ok, *block + c * table->n_rows + i);
            if (status) return status;
        }
    return RP_OK;
}
