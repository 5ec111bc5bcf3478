/* Conditions on the rows of a table; see where.h. */
#include "table/where.h"

#include "core/arena.h"
#include "params/expression.h"

#include <math.h>
#include <string.h>

enum { MOST_CELLS = 32 };

/* A table at one row: names are its columns, and beyond them the cells that a condition compares. */
typedef struct {
    const rp_table *table;
    rp_arena *arena;
    size_t row, n;
    struct {
        int column;
        const char *text;
        size_t row; /* of smallest and largest, without a text */
    } cells[MOST_CELLS];
} row_of;

static rp_status find_column(void *host, const char *name, int n_args, rp_x_symbol *symbol, bool *known)
{
    const rp_table *t = ((row_of *)host)->table;
    int column;
    if (n_args >= 0) return RP_OK;
    RP_TRY(rp_table_find(t, name, NULL, &column));
    *symbol = (rp_x_symbol){.type = RP_X_NUMBER, .id = column};
    return *known = true, RP_OK;
}

/* The row with the smallest or the largest number of a column, the first of equal ones; n_rows: none. */
static size_t extreme_row(const rp_table *t, int column, bool largest)
{
    size_t found = t->n_rows;
    double value = NAN, most = NAN;
    for (size_t row = 0; row < t->n_rows; row++)
        if (rp_text_number(rp_cell(t, row, column), &value) && isfinite(value) &&
            (found == t->n_rows || (largest ? value > most : value < most)))
            found = row, most = value;
    return found;
}

static int take_cell(void *host, int column, const char *text)
{
    row_of *of = host;
    const bool largest = strcmp(text, "largest") == 0, one = largest || strcmp(text, "smallest") == 0;
    if (of->n == MOST_CELLS) return -1;
    of->cells[of->n].column = column;
    of->cells[of->n].text = one ? NULL : rp_text(of->arena, "%s", text);
    if (one) of->cells[of->n].row = extreme_row(of->table, column, largest);
    return (int)(of->table->n_columns + of->n++);
}

static bool is_equal(const char *cell, const char *text)
{
    double a, b;
    if (strcmp(cell, text) == 0) return true;
    if (!rp_text_number(cell, &a) || !rp_text_number(text, &b)) return false;
    return a == b || (isnan(a) && isnan(b)) || (isfinite(b) && fabs(a - b) <= 1e-12 * fabs(b));
}

static double load(void *host, int id, const double args[])
{
    const row_of *of = host;
    const size_t n = of->table->n_columns, k = (size_t)id - n;
    double value;
    (void)args;
    if ((size_t)id >= n)
        return of->cells[k].text
                   ? is_equal(rp_cell(of->table, of->row, of->cells[k].column), of->cells[k].text)
                   : of->cells[k].row == of->row;
    return rp_text_number(rp_cell(of->table, of->row, id), &value) ? value : NAN;
}

rp_status rp_rows_mark(const rp_table *t, const char *condition, bool rows[])
{
    RP_SCOPE(arena);
    row_of of = {.table = t, .arena = &arena};
    const rp_x_names names = {.host = &of, .find = find_column, .cell = take_cell};
    const rp_x_values values = {&of, load};
    rp_expression e;
    RP_TRY(rp_prefix(rp_expression_read_as(&arena, condition, RP_X_TRUTH, &names, &e),
                     "condition \"%s\": ", condition));
    if (e.n_states > 0)
        return rp_fail(RP_BAD_INPUT, "condition \"%s\": held is not of a table's rows", condition);
    for (of.row = 0; of.row < t->n_rows; of.row++)
        rows[of.row] &= rp_expression_value(&e, &values, NULL) == 1.0;
    return RP_OK;
}

rp_status rp_table_where(rp_table *t, const char *condition)
{
    size_t kept = 0;
    const size_t columns = t->n_columns;
    RP_SCOPE(memory);
    bool *rows;
    RP_NEW(&memory, rows, t->n_rows);
    memset(rows, true, t->n_rows);
    RP_TRY(rp_rows_mark(t, condition, rows));
    for (size_t i = 0; i < t->n_rows; i++) {
        if (!rows[i]) continue;
        memmove(t->cells + kept * columns, t->cells + i * columns, columns * sizeof *t->cells);
        t->places[kept++] = t->places[i];
    }
    t->n_rows = kept;
    return RP_OK;
}
