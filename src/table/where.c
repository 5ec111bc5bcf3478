/* Conditions on the rows of a table; see where.h. */
#include "table/where.h"

#include "core/arena.h"
#include "params/expression.h"

#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

rp_status rp_condition_read(const char *text, rp_condition *c)
{
    const size_t length = strcspn(text, "<>=!"), n = strspn(text + length, "<>=!");
    const bool cell =
        strncmp(text + length, "!=", 2) == 0 || (text[length] == '=' && text[length + 1] != '=');
    *c = (rp_condition){.differs = text[length] == '!', .text = text};
    snprintf(c->column, sizeof c->column, "%.*s", (int)length, text);
    if (length == 0 || length >= sizeof c->column || n == 0)
        return rp_fail(RP_BAD_INPUT, "condition \"%s\": NAME=VALUE expected, or != < <= > >=", text);
    if (cell) c->value = text + length + (c->differs ? 2 : 1);
    if (cell && strpbrk(c->value, "<>=!"))
        return rp_fail(RP_BAD_INPUT, "condition \"%s\": several comparisons: write == for = in all of them",
                       text);
    return RP_OK;
}

static bool is_equal(const char *cell, const char *value)
{
    double a, b;
    char *end;
    if (strcmp(cell, value) == 0) return true;
    if (!rp_text_number(cell, &a)) return false;
    b = strtod(value, &end);
    if (*end == ':' && end > value) return a >= b && a <= strtod(end + 1, &end) && !*end;
    const bool near = isfinite(b) && fabs(a - b) <= 1e-12 * fabs(b);
    return !*end && *value && (near || a == b || (isnan(a) && isnan(b)));
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

static rp_status mark_cells(const rp_table *t, const rp_condition *c, bool rows[])
{
    int column;
    RP_TRY(rp_table_find(t, c->column, NULL, &column));
    const bool largest = strcmp(c->value, "largest") == 0,
               one = !c->differs && (largest || strcmp(c->value, "smallest") == 0);
    const size_t extreme = one ? extreme_row(t, column, largest) : 0;
    for (size_t row = 0; row < t->n_rows; row++)
        rows[row] &= one ? row == extreme : is_equal(rp_cell(t, row, column), c->value) != c->differs;
    return RP_OK;
}

/* ---- expressions ---- */

/* Columns are names. One before the first sign that is no name, as x/W, is called "column". */
typedef struct {
    const rp_table *table;
    int first; /* -1: none is called so */
    size_t row;
} row_of;

static const char FIRST[] = "column";

static rp_status find_column(void *host, const char *name, int n_args, rp_x_symbol *symbol, bool *known)
{
    const row_of *c = host;
    const int column = c->first >= 0 && strcmp(name, FIRST) == 0 ? c->first : rp_table_column(c->table, name);
    *known = n_args < 0 && column >= 0;
    if (*known) *symbol = (rp_x_symbol){.type = RP_X_NUMBER, .key = c->table->names[column], .id = column};
    return RP_OK;
}

static void list_columns(void *host, rp_guess *guess)
{
    const rp_table *t = ((row_of *)host)->table;
    for (size_t k = 0; k < t->n_columns; k++)
        if (t->names[k]) rp_guess_try(guess, t->names[k]);
}

static double load_cell(void *host, int column, const double args[])
{
    const row_of *c = host;
    double value;
    (void)args;
    return rp_text_number(rp_cell(c->table, c->row, column), &value) ? value : NAN;
}

static bool is_name(const char *text)
{
    if (!isalpha((unsigned char)*text)) return false;
    while (isalnum((unsigned char)*text) || *text == '_' || *text == '.') text++;
    return !*text;
}

static rp_status mark_expression(const rp_table *t, const rp_condition *c, bool rows[])
{
    RP_SCOPE(arena);
    row_of of = {.table = t, .first = rp_table_column(t, c->column)};
    if (is_name(c->column)) of.first = -1;
    const rp_x_names names = {.host = &of, .find = find_column, .list = list_columns};
    const rp_x_values values = {&of, load_cell};
    rp_expression e;
    const char *text = of.first < 0 ? c->text : rp_text(&arena, "%s%s", FIRST, c->text + strlen(c->column));
    if (!text) return RP_NO_MEMORY;
    RP_TRY(rp_prefix(rp_expression_read_as(&arena, text, RP_X_TRUTH, &names, &e),
                     "condition \"%s\": ", c->text));
    double states[2] = {0.0};
    if (e.n_states > 0)
        return rp_fail(RP_BAD_INPUT, "condition \"%s\": held and change: not of a table's rows", c->text);
    for (of.row = 0; of.row < t->n_rows; of.row++)
        rows[of.row] &= rp_expression_value(&e, &values, states) == 1.0;
    return RP_OK;
}

rp_status rp_conditions_mark(const rp_table *t, size_t n, const rp_condition conditions[], bool rows[])
{
    for (const rp_condition *c = conditions; c < conditions + n; c++)
        RP_TRY(c->value ? mark_cells(t, c, rows) : mark_expression(t, c, rows));
    return RP_OK;
}

rp_status rp_table_where(rp_table *t, const char *condition)
{
    rp_condition c;
    size_t kept = 0;
    const size_t columns = t->n_columns;
    RP_TRY(rp_condition_read(condition, &c));
    RP_SCOPE(memory);
    bool *rows;
    RP_NEW(&memory, rows, t->n_rows);
    memset(rows, true, t->n_rows);
    RP_TRY(rp_conditions_mark(t, 1, &c, rows));
    for (size_t i = 0; i < t->n_rows; i++) {
        if (!rows[i]) continue;
        memmove(t->cells + kept * columns, t->cells + i * columns, columns * sizeof *t->cells);
        t->places[kept++] = t->places[i];
    }
    t->chosen |= kept < t->n_rows;
    t->n_rows = kept;
    return RP_OK;
}
