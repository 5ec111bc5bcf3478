/* Tables with provenance; see table.h. */
#include "table/table.h"

#include <ctype.h>
#include <gsl/gsl_version.h>
#include <libconfig.h>
#include <math.h>
#include <sqlite3.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <suitesparse/cholmod.h>
#include <xxhash.h>

#include "core/file.h"
#include "core/plain.h"
#include "core/version.h"
#include "params/guess.h"
#include "params/params.h"

#define TEXT_(x)  #x
#define TEXT(x)   TEXT_(x)
#define LIBCONFIG TEXT(LIBCONFIG_VER_MAJOR) "." TEXT(LIBCONFIG_VER_MINOR)
#define CHOLMOD   TEXT(CHOLMOD_MAIN_VERSION) "." TEXT(CHOLMOD_SUB_VERSION) "." TEXT(CHOLMOD_SUBSUB_VERSION)
#define XXHASH    TEXT(XXH_VERSION_MAJOR) "." TEXT(XXH_VERSION_MINOR) "." TEXT(XXH_VERSION_RELEASE)

void rp_table_provenance(FILE *out, rp_units units, const char *command)
{
    rp_table_note(out, "program", "repose %s, commit %s, model %d", RP_VERSION, rp_build_commit,
                  RP_MODEL_VERSION);
    rp_table_note(out, "compiler", "%s", rp_build_compiler);
    rp_table_note(out, "libraries",
                  "GSL " GSL_VERSION ", libconfig " LIBCONFIG ", SQLite " SQLITE_VERSION ", CHOLMOD " CHOLMOD
                  ", xxHash " XXHASH ", Random123 philox4x32-10");
    if (command) rp_table_note(out, "command", "%s", command);
    if (units != RP_CGS) rp_table_note(out, "system", "%s", rp_units_word(units));
}

void rp_table_note(FILE *out, const char *key, const char *format, ...)
{
    char text[8192];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    fprintf(out, "# %s: %s\n", key, rp_plain(text)); /* a note is one line */
}

void rp_table_note_number(FILE *out, const char *key, double value, const char *text)
{
    rp_table_note(out, key, "%s%s%s", RP_SHORT(value), *text ? " " : "", text);
}

/* Time that a run took is in seconds in every system. */
static const char *unit_of(rp_units units, const char *column, const char *cgs)
{
    return *cgs ? strcmp(column, "seconds") ? rp_unit(units, cgs) : cgs : "1";
}

void rp_table_columns(FILE *out, rp_units units, size_t n, const char *const columns[][2])
{
    fputs("# units: ", out);
    for (size_t i = 0; i < n; i++)
        fprintf(out, "%s%s", i ? "\t" : "", unit_of(units, columns[i][0], columns[i][1]));
    fputc('\n', out);
    for (size_t i = 0; i < n; i++) fprintf(out, "%s%s", i ? "\t" : "", columns[i][0]);
    fputc('\n', out);
}

void rp_table_header(FILE *out, rp_units units, const char *columns)
{
    for (int names = 0; names < 2; names++) {
        if (!names) fputs("# units: ", out);
        for (const char *c = columns, *end; *c; c = end + (*end ? 2 : 0)) {
            char name[256], label[64];
            end = strstr(c, ", ") ? strstr(c, ", ") : c + strlen(c);
            const char *unit = memchr(c, '[', (size_t)(end - c));
            snprintf(name, sizeof name, "%.*s", (int)((unit ? unit - 1 : end) - c), c);
            snprintf(label, sizeof label, "%.*s", unit ? (int)(end - unit) - 2 : 0, unit ? unit + 1 : "");
            fprintf(out, "%s%s", c != columns ? "\t" : "", names ? name : unit_of(units, name, label));
        }
        fputc('\n', out);
    }
}

void rp_table_numbers(FILE *out, size_t n, const double values[])
{
    for (size_t i = 0; i < n; i++) fprintf(out, "%s%s", i ? "\t" : "", RP_SHORT(values[i]));
}

void rp_table_row(FILE *out, size_t n, const double values[])
{
    rp_table_numbers(out, n, values);
    fputc('\n', out);
}

void rp_table_row_word(FILE *out, size_t n, const double values[], const char *word)
{
    rp_table_numbers(out, n, values);
    fprintf(out, "%s%s\n", n ? "\t" : "", word);
}

/* What separates the cells of a line: tabs alone where cells hold blanks, commas, which may have blanks
 * beside them, where there is no tab. */
static const char *blanks_of(const char *line, bool texts)
{
    if (!strchr(line, '\t') && strchr(line, ',')) return ",\r";
    return texts ? "\t\r" : " \t\r";
}

/* The next cell of a line, without the quotes around it, and its length; NULL behind the last. */
static char *next_cell(char **line, const char *blanks, size_t *n)
{
    const char *skipped = *blanks == ',' ? ", \r" : blanks;
    char *cell = *line + strspn(*line, skipped), *quote = *cell == '"' ? strchr(cell + 1, '"') : NULL;
    const bool quoted = quote && strchr(skipped, quote[1]); /* also at the line's end */
    if (!*cell) return NULL;
    *n = quoted ? (size_t)(quote - cell) - 1 : strcspn(cell, blanks);
    *line = quoted ? quote + 1 : cell + *n;
    while (!quoted && cell[*n - 1] == ' ' && *blanks == ',') --*n;
    return cell + quoted;
}

static size_t count_cells(char *line, const char *blanks)
{
    size_t n = 0, length;
    while (next_cell(&line, blanks, &length)) n++;
    return n;
}

static void split_cells(char *line, const char *blanks, char **cells)
{
    size_t n;
    for (char *cell; (cell = next_cell(&line, blanks, &n)); cell[n] = '\0') {
        line += *line != '\0';
        *cells++ = cell;
    }
}

bool rp_text_number(const char *text, double *value)
{
    char *end;
    *value = strtod(text, &end);
    return end != text && !*end;
}

static bool holds_number(char *line, const char *blanks)
{
    char word[64], *cell;
    double value;
    for (size_t n; (cell = next_cell(&line, blanks, &n));) {
        snprintf(word, sizeof word, "%.*s", (int)n, cell);
        if (n < sizeof word && rp_text_number(word, &value)) return true;
    }
    return false;
}

/* A table while it is read. */
typedef struct {
    rp_table *table;
    bool texts;
    const char *blanks; /* between the cells of a row */
    char *above;        /* the last line with # before the first row */
    bool units_above;   /* the line before this one holds the units */
    char *header;       /* the line of names, split at the first row, which tells what separates them */
    char lead;          /* what it begins with */
    size_t most_rows, most_cells;
} reading;

/* The names of the columns, if the line has one for each of them. They hold blanks where only so there is one
 * for each cell of `row`; then tabs separate them. */
static rp_status take_names(reading *r, char *line, char *row)
{
    rp_table *t = r->table;
    const char *blanks = blanks_of(line, r->texts);
    const size_t n = row ? count_cells(row, r->blanks) : t->n_columns, strict = count_cells(line, "\t\r");
    r->lead = line[strspn(line, " ")];
    if (n && count_cells(line, blanks) != n && strict > 1 && *line != '\t' &&
        (strict == n || (row && strict == count_cells(row, "\t\r"))))
        blanks = "\t\r";
    if (t->n_columns == 0) t->n_columns = count_cells(line, blanks);
    free(t->names);
    t->names = calloc(t->n_columns + 2, sizeof *t->names);
    if (!t->names) return rp_fail(RP_NO_MEMORY, "%s: out of memory", t->path);
    if (count_cells(line, blanks) == t->n_columns) split_cells(line, blanks, t->names);
    return RP_OK;
}

/* Column names have a line of their own. In older tables they are the last line with #, below the units or
 * with tabs; and a first row with a number is no header. */
static bool is_header(const reading *r, char *line, size_t n)
{
    if (r->above && strncmp(r->above, "units: ", 7) == 0) return true;
    const bool older =
        r->above && (r->units_above || strchr(r->above, '\t')) &&
        (count_cells(r->above, blanks_of(r->above, r->texts)) == n || count_cells(r->above, "\t\r") == n);
    return !older && !holds_number(line, r->blanks);
}

/* Between commas; tabs and blanks may be several, but not tabs beside a cell that holds a blank. */
static bool has_empty_cell(char *line, const char *blanks, size_t n)
{
    size_t commas = 0;
    bool quoted = false;
    if (*blanks == ' ') return (*line == '\t' || strstr(line, "\t\t")) && count_cells(line, "\t\r") != n;
    for (; *line; line++) {
        quoted ^= *line == '"';
        commas += *line == ',' && !quoted;
    }
    return strchr(blanks, ',') && commas + 1 != n;
}

/* In tables that were joined, the names stand again. */
static bool is_names(const rp_table *t, char *const cells[])
{
    size_t i = 0;
    while (t->names && i < t->n_columns && strcmp(t->names[i], cells[i]) == 0) i++;
    return t->names && i == t->n_columns;
}

/* A table with an index has no name for its first column. */
static void take_index(reading *r, size_t n)
{
    static char name[] = "index";
    rp_table *t = r->table;
    if (!t->names || (r->lead != ',' && (r->lead != '\t' || n != t->n_columns + 1))) return;
    memmove(t->names + 1, t->names, t->n_columns++ * sizeof *t->names);
    t->names[0] = name;
}

/* Is there a comma between two digits? */
static const char *if_decimal_commas(const char *text)
{
    for (const char *c = text; (c = strchr(c, ',')); c++)
        if (c > text && isdigit((unsigned char)c[-1]) && isdigit((unsigned char)c[1]))
            return "; decimal commas? write points, as in 0.5";
    return "";
}

static rp_status take_row(reading *r, char *line, size_t n, size_t line_number)
{
    rp_table *t = r->table;
    const char *blanks = r->blanks;
    if (n != t->n_columns && t->names && count_cells(line, "\t\r") == t->n_columns) { /* texts with blanks */
        n = t->n_columns;
        blanks = "\t\r";
    }
    if (!t->cells) {
        take_index(r, n);
        t->n_columns = t->names ? t->n_columns : n;
        const size_t most =
            r->most_rows < r->most_cells / t->n_columns ? r->most_rows * t->n_columns : r->most_cells;
        t->cells = calloc(most, sizeof *t->cells);
        if (!t->cells) return rp_fail(RP_NO_MEMORY, "%s: out of memory", t->path);
    }
    if (n != t->n_columns)
        return rp_fail(RP_BAD_INPUT, "%s:%zu: %zu cells where %zu are expected%s", t->path, line_number, n,
                       t->n_columns, if_decimal_commas(line));
    if (has_empty_cell(line, blanks, n))
        return rp_fail(RP_BAD_INPUT, "%s:%zu: an empty cell", t->path, line_number);
    split_cells(line, blanks, t->cells + t->n_rows * n);
    if (is_names(t, t->cells + t->n_rows * n)) return RP_OK;
    t->places[t->n_rows++] = (rp_place){.path = t->path, .line = line_number};
    return RP_OK;
}

static rp_status take_line(reading *r, char *line, size_t line_number)
{
    rp_table *t = r->table;
    if (*line == '#') {
        if (t->cells || r->header) return RP_OK;
        r->units_above = r->above && strncmp(r->above, "units: ", 7) == 0;
        r->above = line + 1 + strspn(line + 1, " ");
        return RP_OK;
    }
    if (!r->blanks && !r->header && !strchr(line, '\t') && strchr(line, ';'))
        return rp_fail(RP_BAD_INPUT,
                       "%s:%zu: cells are separated by ;, tabs or commas expected, and decimal points: "
                       "tr ';,' '\\t.' <FILE >TABLE writes them so",
                       t->path, line_number);
    if (!r->blanks && strspn(line, " \t\r,") < strlen(line)) r->blanks = blanks_of(line, r->texts);
    const size_t n = r->blanks ? count_cells(line, r->blanks) : 0;
    if (n == 0) return RP_OK;
    if (!t->cells && !r->header && is_header(r, line, n)) return r->header = line, RP_OK;
    if (r->header && !t->names) RP_TRY(take_names(r, r->header, line));
    return take_row(r, line, n, line_number);
}

/* A number of atoms, a line of any text, and lines of an element and its coordinates. */
static bool is_xyz(const char *text)
{
    const size_t digits = strspn(text, "0123456789");
    const char *line = text + digits + strspn(text + digits, " \t\r");
    double x, y;
    if (digits == 0 || *line != '\n' || !(line = strchr(line + 1, '\n'))) return false;
    line += 1 + strspn(line + 1, " \t");
    return sscanf(line, "%*[^ \t\n]%*[ \t]%lf%*[ \t]%lf", &x, &y) == 2;
}

/* Files of other programs, by their first bytes. */
static rp_status check_kind(const rp_table *t)
{
    static const char *const kinds[][2] = {{"ITEM:", "a dump of LAMMPS"},
                                           {"LAMMPS", "a data or log file of LAMMPS"},
                                           {"# vtk", "a VTK file"},
                                           {"<", "an XML file"},
                                           {"{", "a JSON file"},
                                           {"%PDF", "a PDF file"},
                                           {"PK", "an archive or spreadsheet"},
                                           {"\x89PNG", "a picture"},
                                           {"\xff\xd8", "a picture"},
                                           {"GIF8", "a picture"},
                                           {"", "an XYZ file"}};
    for (size_t k = 0; k < sizeof kinds / sizeof *kinds; k++)
        if (*kinds[k][0] ? strncmp(t->text, kinds[k][0], strlen(kinds[k][0])) == 0 : is_xyz(t->text))
            return rp_fail(RP_BAD_INPUT,
                           "%s: is %s; a table expected: a line of names, as x y r, and a row of numbers for "
                           "each grain or run",
                           t->path, kinds[k][1]);
    return RP_OK;
}

/* Tables of any encoding are read, but no byte that a terminal takes for a control character. */
static rp_status check_bytes(const rp_table *t)
{
    size_t line = 1, n;
    for (const char *c = t->text; *c; c += n ? n : 1) {
        n = rp_character(c);
        line += *c == '\n';
        if (n == 0 && !strchr("\t\n\r", *c) && (unsigned char)*c < 0xa0)
            return rp_fail(RP_BAD_INPUT, "%s:%zu: no text: a control character (byte %d)", t->path, line,
                           (unsigned char)*c);
    }
    return RP_OK;
}

/* Split the text that the table has. */
static rp_status split_text(bool texts, rp_table *table)
{
    reading r = {.table = table, .texts = texts, .most_rows = 1};
    rp_status status = check_bytes(table);
    if (strncmp(table->text, "\xEF\xBB\xBF", 3) == 0) /* a byte order mark */
        memmove(table->text, table->text + 3, strlen(table->text + 3) + 1);
    RP_TRY(check_kind(table));
    for (const char *p = table->text; *p; p++) r.most_rows += *p == '\n';
    r.most_cells = strlen(table->text) / 2 + 1;
    table->places = calloc(r.most_rows, sizeof *table->places);
    if (!table->places) return rp_fail(RP_NO_MEMORY, "%s: out of memory", table->path);
    size_t line_number = 0;
    for (char *next = table->text, *line; (line = next) && !status;) {
        next = strchr(line, '\n');
        if (next) *next++ = '\0';
        status = take_line(&r, line, ++line_number);
    }
    static char none[] = "";
    if (!r.header) r.header = r.above ? r.above : none;
    return status || table->names ? status : take_names(&r, r.header, NULL);
}

rp_status rp_table_parse(const char *name, char *text, rp_table *table)
{
    *table = (rp_table){.path = name, .text = text};
    return split_text(true, table);
}

rp_status rp_table_read(const char *path, rp_table *table)
{
    *table = (rp_table){.path = path};
    rp_status status = rp_file_read(path, &table->text);
    if (status && table->text) RP_TRY(check_kind(table)); /* which says more than a 0 byte */
    return status ? status : split_text(false, table);
}

void rp_table_free(rp_table *table)
{
    free(table->names);
    free(table->cells);
    free(table->places);
    free(table->text);
    *table = (rp_table){0};
}

static bool same_note(const rp_table *a, const rp_table *b, const char *key)
{
    const char *of_a = rp_table_find_note(a, key), *of_b = rp_table_find_note(b, key);
    return of_a && of_b ? strcmp(of_a, of_b) == 0 : of_a == of_b;
}

/* A row without its first cell. */
typedef struct {
    char *const *cells;
    size_t n;
} row_cells;

static int by_cells(const void *a, const void *b)
{
    const row_cells *p = a, *q = b;
    int order = 0;
    for (size_t c = 1; c < p->n && !order; c++) order = strcmp(p->cells[c], q->cells[c]);
    return order;
}

rp_status rp_table_append(rp_table *table, const rp_table *more)
{
    const size_t columns = table->n_columns, n = table->n_rows, added = more->n_rows;
    bool same = columns == more->n_columns;
    for (size_t c = 0; c < columns && same; c++)
        same = strcmp(table->names[c] ? table->names[c] : "", more->names[c] ? more->names[c] : "") == 0;
    if (!same) return rp_fail(RP_BAD_INPUT, "%s and %s have different columns", table->path, more->path);
    if (!same_note(table, more, "units") || !same_note(table, more, "system"))
        return rp_fail(RP_BAD_INPUT, "%s and %s have different units", table->path, more->path);
    char **cells = realloc(table->cells, ((n + added) * columns + 1) * sizeof *cells);
    if (cells) table->cells = cells;
    rp_place *places = realloc(table->places, (n + added + 1) * sizeof *places);
    if (places) table->places = places;
    const bool runs = columns && table->names[0] && strcmp(table->names[0], "run") == 0;
    row_cells *there = malloc((n + 1) * sizeof *there);
    if (!cells || !places || !there) {
        free(there);
        return rp_fail(RP_NO_MEMORY, "%s: out of memory", more->path);
    }
    for (size_t i = 0; i < n; i++) there[i] = (row_cells){cells + i * columns, columns};
    if (runs) qsort(there, n, sizeof *there, by_cells);
    for (size_t i = 0; i < added; i++) {
        const row_cells row = {more->cells + i * columns, columns};
        if (runs && bsearch(&row, there, n, sizeof *there, by_cells)) continue;
        memcpy(cells + table->n_rows * columns, row.cells, columns * sizeof *cells);
        places[table->n_rows++] = more->places[i];
    }
    free(there);
    return RP_OK;
}

const char *rp_cell(const rp_table *table, size_t row, int column)
{
    return table->cells[row * table->n_columns + (size_t)column];
}

int rp_table_column(const rp_table *table, const char *name)
{
    char number[24];
    for (size_t i = 0; table->names && i < table->n_columns; i++) { /* none after an error of reading */
        snprintf(number, sizeof number, "%zu", i + 1);
        if (strcmp(table->names[i] ? table->names[i] : number, name) == 0) return (int)i;
    }
    return -1;
}

static rp_status no_column(const rp_table *table, const char *name, const char *expected)
{
    char found[512] = "";
    rp_guess guess = rp_guess_of(name);
    for (size_t i = 0, used = 0; table->names && table->names[0] && i < table->n_columns; i++) {
        rp_guess_try(&guess, table->names[i]);
        if (used < sizeof found)
            used += (size_t)snprintf(found + used, sizeof found - used, " %s", table->names[i]);
        if (used >= sizeof found) strcpy(found + sizeof found - 5, " ...");
    }
    return rp_fail(RP_BAD_INPUT, "%s: no column \"%s\"%s%s%s; found:%s", table->path, name,
                   rp_guess_text(&guess), expected ? "; expected header: " : "", expected ? expected : "",
                   *found ? found : " none");
}

rp_status rp_table_find(const rp_table *table, const char *name, const char *expected, int *column)
{
    *column = rp_table_column(table, name);
    if (*column < 0) return no_column(table, name, expected);
    for (size_t i = (size_t)*column + 1; table->names[*column] && i < table->n_columns; i++)
        if (table->names[i] && strcmp(table->names[i], name) == 0)
            return rp_fail(RP_BAD_INPUT, "%s: columns %d and %zu are both \"%s\"", table->path, *column + 1,
                           i + 1, name);
    return RP_OK;
}

/* Its first row is shown, since that is what one looks for in the file. */
rp_status rp_table_nameless(const rp_table *t)
{
    char row[128] = "";
    size_t used = 0;
    double first, next;
    for (size_t c = 0; c < t->n_columns && used < sizeof row; c++)
        used +=
            (size_t)snprintf(row + used, sizeof row - used, "%s%.20s", c ? " " : "", rp_cell(t, 0, (int)c));
    const bool counts = t->n_rows > 1 && t->n_columns > 3 && rp_text_number(rp_cell(t, 0, 0), &first) &&
                        rp_text_number(rp_cell(t, 1, 0), &next) && next == first + 1.0;
    return rp_fail(
        RP_BAD_INPUT,
        "%s:%zu: no names of columns above the first row \"%s\"; what are they? Write a line as \"%sx y r\" "
        "above it%s",
        RP_PLACE(t, 0), row, counts ? "index " : "", counts ? " (the first column counts the rows)" : "");
}

/* rp_table_read has ended every line with NUL; the first row stops the search. */
const char *rp_table_find_note(const rp_table *table, const char *key)
{
    return rp_table_next_note(table, key, NULL);
}

rp_units rp_table_units(const rp_table *table)
{
    return rp_units_find(rp_table_find_note(table, "system"));
}

const char *rp_table_next_note(const rp_table *table, const char *key, const char *previous)
{
    const size_t n = strlen(key);
    if (!table->text) return NULL;
    for (const char *line = previous ? previous + strlen(previous) + 1 : table->text; *line == '#';
         line += strlen(line) + 1)
        if (strncmp(line, "# ", 2) == 0 && strncmp(line + 2, key, n) == 0 &&
            strncmp(line + 2 + n, ": ", 2) == 0)
            return line + n + 4;
    return NULL;
}

rp_status rp_table_number(const rp_table *table, size_t row, int column, int missing_ok, double *value)
{
    const char *cell = rp_cell(table, row, column);
    if (missing_ok && strcmp(cell, "infinite") == 0) {
        *value = INFINITY;
        return RP_OK;
    }
    if (!rp_text_number(cell, value) || (!isfinite(*value) && !missing_ok)) /* "" is none */
        return rp_fail(RP_BAD_INPUT, "%s:%zu: column %d%s%s: \"%.40s\" is not a finite number%s",
                       RP_PLACE(table, row), column + 1, table->names[column] ? " " : "",
                       table->names[column] ? table->names[column] : "", cell, if_decimal_commas(cell));
    return RP_OK;
}
