/* Conditions on the rows of a table; see where.h. */
#include "table/where.h"

#include "core/arena.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

rp_status rp_condition_read(const char *text, rp_condition *c)
{
    double number;
    const size_t length = strcspn(text, "<>=!"), n = strspn(text + length, "<>=!");
    snprintf(c->column, sizeof c->column, "%.*s", (int)length, text);
    snprintf(c->op, sizeof c->op, "%.*s", (int)(n > 1 && text[length + 1] == '=' ? 2 : 1), text + length);
    c->value = text + length + strlen(c->op);
    if (length == 0 || length >= sizeof c->column || !*c->op || strcmp(c->op, "!") == 0 ||
        strcmp(c->op, "==") == 0)
        return rp_fail(RP_BAD_INPUT, "condition \"%s\": NAME=VALUE expected, or != < <= > >=", text);
    if (strchr("<>", *c->op) && !rp_text_number(c->value, &number))
        return rp_fail(RP_BAD_INPUT, "condition \"%s\": \"%s\" is not a number", text, c->value);
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

static bool meets(const char *cell, const rp_condition *c)
{
    double a, b;
    const bool equal = is_equal(cell, c->value);
    if (*c->op == '=') return equal;
    if (*c->op == '!') return !equal;
    if (!rp_text_number(cell, &a) || !rp_text_number(c->value, &b)) return false;
    return (c->op[1] && equal) || (*c->op == '<' ? a < b : a > b);
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

rp_status rp_conditions_mark(const rp_table *t, size_t n, const rp_condition conditions[], bool rows[])
{
    for (const rp_condition *c = conditions; c < conditions + n; c++) {
        int column;
        RP_TRY(rp_table_find(t, c->column, NULL, &column));
        const bool largest = strcmp(c->value, "largest") == 0,
                   one = largest || strcmp(c->value, "smallest") == 0;
        const size_t extreme = one && *c->op == '=' ? extreme_row(t, column, largest) : 0;
        for (size_t row = 0; row < t->n_rows; row++)
            rows[row] &= one && *c->op == '=' ? row == extreme : meets(rp_cell(t, row, column), c);
    }
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
