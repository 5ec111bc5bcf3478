/* Columns of a table as arrays of numbers, groups of rows; see columns.h. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "table/columns.h"

static void free_table(void *table)
{
    rp_table_free(table);
}

rp_status rp_table_keep(rp_arena *arena, const char *path, char *text, rp_table **table)
{
    *table = rp_arena_keep(arena, rp_arena_memory(arena, 1, sizeof **table), free_table);
    if (!*table) return free(text), RP_NO_MEMORY;
    return text ? rp_table_parse(path, text, *table) : rp_table_read(path, *table);
}

rp_status rp_table_load(rp_arena *arena, const char *path, rp_table **table)
{
    return rp_table_keep(arena, path, NULL, table);
}

bool rp_is_result(const char *status)
{
    return strncmp(status, "ok", 2) == 0;
}

void rp_tally_add(rp_tally *t, const char *word, size_t length, double times)
{
    size_t i = 0;
    while (i < t->n && (strncmp(t->of[i].word, word, length) != 0 || t->of[i].word[length])) i++;
    if (length >= sizeof t->of[i].word || i == sizeof t->of / sizeof *t->of) return;
    if (i == t->n) snprintf(t->of[t->n++].word, sizeof t->of[i].word, "%.*s", (int)length, word);
    t->of[i].times += times;
}

void rp_tally_add_text(rp_tally *t, const char *text, double weight)
{
    for (const char *end = text + strcspn(text, ")"); text < end; text += strspn(text, ", ")) {
        const size_t n = strcspn(text, " :,)");
        const double number = text[n] == ' ' || text[n] == ':' ? strtod(text + n + 1, NULL) : NAN;
        if (*text != '-') rp_tally_add(t, text, n, weight * number);
        text += strcspn(text, ",)");
    }
}

void rp_tally_text(const rp_tally *t, char text[1024])
{
    strcpy(text, "-");
    for (size_t i = 0, used = 0; i < t->n; i++)
        used += (size_t)snprintf(text + used, 1024 - used, "%s%s:%g", i ? "," : "", t->of[i].word,
                                 t->of[i].times);
}

/* The n columns of the list `names` ("a,b,..."), at most `most`. Errors: RP_BAD_INPUT. */
static rp_status column_list(const rp_table *table, const char *names, size_t most, size_t *n, int columns[])
{
    char header[1024];
    *n = 0;
    snprintf(header, sizeof header, "%s", names);
    for (char *comma = header; (comma = strchr(comma, ','));) *comma = ' ';
    for (const char *name = names; *name; name += strcspn(name, ","), name += *name == ',') {
        char word[64];
        if (*n == most) return rp_fail(RP_BAD_INPUT, "\"%s\": at most %zu columns", names, most);
        snprintf(word, sizeof word, "%.*s", (int)strcspn(name, ","), name);
        RP_TRY(rp_table_find(table, word, header, &columns[(*n)++]));
    }
    return *n > 0 ? RP_OK : rp_fail(RP_BAD_INPUT, "\"%s\": a column expected", names);
}

rp_status rp_one_column(const char *option, const char *name)
{
    return strchr(name, ',') ? rp_fail(RP_USAGE, "%s = \"%s\": one column expected", option, name) : RP_OK;
}

rp_status rp_columns(rp_arena *arena, const rp_table *table, const char *names, size_t *n, int **columns)
{
    *n = table->n_columns;
    *columns = rp_arena_memory(arena, *n + strlen(names), sizeof **columns);
    for (size_t c = 0; c < *n; c++) (*columns)[c] = (int)c;
    return strcmp(names, "all") == 0 ? RP_OK : column_list(table, names, strlen(names), n, *columns);
}

static bool is_among(const char *names, const char *name)
{
    const size_t n = strlen(name);
    for (const char *at = names; (at = strstr(at, ", ")); at++)
        if (strncmp(at + 2, name, n) == 0 && strchr(", ", at[2 + n])) return true;
    return false;
}

void rp_columns_beside(const rp_table *table, const char *names, char text[256])
{
    *text = '\0';
    for (size_t c = 0, used = 0; c < table->n_columns && table->names[c] && used < 256; c++) {
        const char *name = table->names[c];
        if (*name && !is_among(names, name)) used += (size_t)snprintf(text + used, 256 - used, " %s", name);
    }
}

rp_status rp_columns_read(rp_arena *arena, const rp_table *table, const char *names, double **block)
{
    int columns[RP_MOST_COLUMNS];
    size_t n, used = 0;
    RP_TRY(column_list(table, names, RP_MOST_COLUMNS, &n, columns));
    RP_NEW(arena, *block, n * table->n_rows);
    for (size_t c = 0; c < n; c++)
        for (size_t i = 0; i < table->n_rows; i++)
            RP_TRY(rp_table_number(table, i, columns[c], false, *block + used++));
    return RP_OK;
}

rp_status rp_table_one_step(const rp_table *table)
{
    int column = rp_table_column(table, "step");
    for (size_t i = 1; column >= 0 && i < table->n_rows; i++)
        if (strcmp(rp_cell(table, i, column), rp_cell(table, 0, column)) != 0)
            return rp_fail(RP_BAD_INPUT,
                           "%s:%zu: step = %s after %s: one step expected; choose it by --where step=N",
                           RP_PLACE(table, i), rp_cell(table, i, column), rp_cell(table, 0, column));
    return RP_OK;
}

rp_status rp_columns_read_file(rp_arena *arena, const char *path, const char *names, double **block,
                               size_t *n_rows)
{
    rp_table *table;
    RP_TRY(rp_table_load(arena, path, &table));
    *n_rows = table->n_rows;
    return rp_columns_read(arena, table, names, block);
}

/* Is a row of these numbers left out? Count why. */
static bool is_left_out(const rp_choice *choice, bool failed, size_t n, const double numbers[], rp_rows *r)
{
    bool missing = false;
    for (size_t c = 0; c < n && !failed; c++) missing |= isnan(numbers[c]);
    const bool outside = choice->range && (numbers[0] < choice->range[0] || numbers[0] > choice->range[1]);
    r->n_failed += failed;
    r->n_nan += !failed && missing;
    r->n_outside += !failed && !missing && outside;
    return failed || missing || outside;
}

typedef struct {
    double key;
    size_t row;
} ranked;

static int by_key(const void *a, const void *b)
{
    const ranked *p = a, *q = b;
    return p->key != q->key ? (p->key > q->key) - (p->key < q->key) : (p->row > q->row) - (p->row < q->row);
}

/* Where the groups of the ordered rows begin. */
static void find_groups(rp_arena *arena, rp_rows *r, const ranked rank[], const rp_groups *groups)
{
    size_t g = 0;
    r->first = rp_arena_memory(arena, (groups ? groups->n_groups : r->n) + 1, sizeof *r->first);
    for (size_t i = 0; i < r->n; i++)
        while (groups ? (double)g < rank[i].key : i > r->first[g] && rank[i].key != rank[i - 1].key)
            r->first[++g] = i;
    r->n_groups = groups ? groups->n_groups : g + (r->n > 0);
    while (g < r->n_groups) r->first[++g] = r->n;
}

rp_status rp_rows_read(rp_arena *arena, const rp_table *t, const char *names, const rp_choice *choice,
                       rp_rows *r)
{
    int columns[RP_MOST_COLUMNS];
    size_t k;
    *r = (rp_rows){0};
    RP_TRY(column_list(t, names, RP_MOST_COLUMNS, &k, columns));
    const int word = choice->any_status ? -1 : rp_table_column(t, "status");
    double *numbers = rp_arena_memory(arena, t->n_rows * k, sizeof *numbers);
    ranked *rank = rp_arena_memory(arena, t->n_rows, sizeof *rank);
    for (size_t i = 0; i < t->n_rows; i++) {
        const bool failed = word >= 0 && !rp_is_result(rp_cell(t, i, word));
        for (size_t c = 0; c < k && !failed; c++)
            RP_TRY(rp_table_number(t, i, columns[c], true, &numbers[i * k + c]));
        if (is_left_out(choice, failed, k, numbers + i * k, r)) continue;
        for (size_t c = choice->grouped; c < k; c++) /* the first names the group */
            if (isinf(numbers[i * k + c]))
                RP_TRY(rp_table_number(t, i, columns[c], false, &numbers[i * k + c]));
        const double key = choice->groups ? (double)choice->groups->of_row[i] : numbers[i * k];
        rank[r->n++] = (ranked){choice->groups || choice->grouped ? key : 0.0, i};
    }
    if (r->n == 0)
        return rp_fail(RP_NO_RESULT, "%s: no row with status ok and numbers for %s", t->path, names);
    qsort(rank, r->n, sizeof *rank, by_key);
    find_groups(arena, r, rank, choice->groups);
    r->row = rp_arena_memory(arena, r->n, sizeof *r->row);
    for (size_t c = 0; c < k; c++) {
        r->column[c] = rp_arena_memory(arena, r->n, sizeof *r->column[c]);
        for (size_t i = 0; i < r->n; i++) r->column[c][i] = numbers[(r->row[i] = rank[i].row) * k + c];
    }
    return RP_OK;
}

enum { MOST_BY = 24 };

const char *rp_column_name(const rp_table *table, int column, char text[12])
{
    snprintf(text, 12, "%d", column + 1);
    return table->names[column] ? table->names[column] : text;
}

void rp_column_unit(const rp_table *table, int column, char unit[32])
{
    const char *units = rp_table_find_note(table, "units");
    for (int c = 0; units && c < column; c++) units = (units = strchr(units, '\t')) ? units + 1 : NULL;
    const int length = units ? (int)strcspn(units, "\t\r") : 0;
    snprintf(unit, 32, "%.*s", length ? length : 1, length ? units : "1");
}

rp_status rp_header_by(const rp_table *table, const char *by, const char *own, FILE *out)
{
    char text[4096], name[12], unit[32];
    int columns[MOST_BY];
    size_t n = 0, used = 0;
    if (strcmp(by, "none") != 0) RP_TRY(column_list(table, by, MOST_BY, &n, columns));
    for (size_t i = 0; i < n; i++) {
        rp_column_unit(table, columns[i], unit);
        used += (size_t)snprintf(text + used, sizeof text - used, "%.100s [%s], ",
                                 rp_column_name(table, columns[i], name), unit);
    }
    snprintf(text + used, sizeof text - used, "%s", own);
    rp_table_header(out, rp_table_units(table), text);
    return RP_OK;
}

rp_status rp_group_rows(rp_arena *arena, const rp_table *t, const char *by, char separator, rp_groups *g)
{
    size_t n_by = 0;
    int columns[MOST_BY];
    *g = (rp_groups){0};
    if (strcmp(by, "none") != 0) RP_TRY(column_list(t, by, MOST_BY, &n_by, columns));
    RP_NEW(arena, g->of_row, t->n_rows);
    RP_NEW(arena, g->words, t->n_rows);
    for (size_t i = 0; i < t->n_rows; i++) {
        RP_SCOPE(row);
        const char *label = "";
        size_t group = 0;
        for (size_t k = 0; k < n_by && label; k++)
            label = rp_text(&row, "%s%.*s%s", label, k > 0, &separator, rp_cell(t, i, columns[k]));
        if (!label) return RP_NO_MEMORY;
        while (group < g->n_groups && strcmp(g->words[group], label) != 0) group++;
        g->of_row[i] = group;
        if (group == g->n_groups) g->words[g->n_groups++] = rp_text(arena, "%s", label);
    }
    return RP_OK;
}

const char *rp_failed_text(rp_arena *arena, const rp_table *t, const rp_groups *groups, size_t group,
                           const char *x, const double range[2])
{
    const int status = rp_table_column(t, "status"), n = rp_table_column(t, "n"),
              failed = rp_table_column(t, "n_failed"), words = rp_table_column(t, "failed_for"),
              at = x && range ? rp_table_column(t, x) : -1;
    rp_tally causes = {0};
    char text[1024];
    double runs = 0.0;
    for (size_t i = 0; i < t->n_rows; i++) {
        const double value = at < 0 ? 0.0 : strtod(rp_cell(t, i, at), NULL);
        if ((groups && groups->of_row[i] != group) || (at >= 0 && !(value >= range[0] && value <= range[1])))
            continue;
        /* points without any result enter no mean */
        if (failed >= 0 && (n < 0 || strtod(rp_cell(t, i, n), NULL) > 0.0)) {
            runs += strtod(rp_cell(t, i, failed), NULL);
            if (words >= 0) rp_tally_add_text(&causes, rp_cell(t, i, words), 1.0);
        } else if (failed < 0 && status >= 0 && !rp_is_result(rp_cell(t, i, status))) {
            runs++;
            rp_tally_add(&causes, rp_cell(t, i, status), strlen(rp_cell(t, i, status)), 1.0);
        }
    }
    rp_tally_text(&causes, text);
    return rp_text(arena, "%.0f\t%s", runs, text);
}
