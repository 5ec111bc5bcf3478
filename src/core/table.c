/* Tables with provenance; see table.h. */
#include "core/table.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <math.h>
#include <stdbool.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/version.h"

void rp_table_provenance(FILE *out, const char *command)
{
    rp_table_note(out, "program", "repose %s, commit %s, model %d", RP_VERSION, rp_build_commit,
                  RP_MODEL_VERSION);
    rp_table_note(out, "compiler", "%s", rp_build_compiler);
    rp_table_note(out, "libraries", "%s", rp_build_libraries);
    if (command) rp_table_note(out, "command", "%s", command);
}

void rp_table_note(FILE *out, const char *key, const char *format, ...)
{
    char text[8192];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    for (char *c = text; (c = strpbrk(c, "\n\r"));) *c = ' '; /* as in a file's name: a note is one line */
    fprintf(out, "# %s: %s\n", key, text);
}

void rp_table_columns(FILE *out, size_t n, const char *const columns[][2])
{
    fputs("# units: ", out);
    for (size_t i = 0; i < n; i++) fprintf(out, "%s%s", i ? "\t" : "", *columns[i][1] ? columns[i][1] : "1");
    fputs("\n# ", out);
    for (size_t i = 0; i < n; i++) fprintf(out, "%s%s", i ? "\t" : "", columns[i][0]);
    fputc('\n', out);
}

void rp_table_header(FILE *out, const char *columns)
{
    for (int names = 0; names < 2; names++) {
        fputs(names ? "# " : "# units: ", out);
        for (const char *c = columns, *end; *c; c = end + (*end ? 2 : 0)) {
            end = strstr(c, ", ") ? strstr(c, ", ") : c + strlen(c);
            const char *unit = memchr(c, '[', (size_t)(end - c));
            if (c != columns) fputc('\t', out);
            if (names)
                fprintf(out, "%.*s", (int)((unit ? unit - 1 : end) - c), c);
            else
                fprintf(out, "%.*s", unit ? (int)(end - unit) - 2 : 1, unit ? unit + 1 : "1");
        }
        fputc('\n', out);
    }
}

static void write_cells(FILE *out, size_t n, const double values[])
{
    for (size_t i = 0; i < n; i++)
        if (isnan(values[i])) /* printf writes "-nan" for some */
            fprintf(out, "%snan", i ? "\t" : "");
        else
            fprintf(out, "%s%.17g", i ? "\t" : "", values[i]);
}

void rp_table_row(FILE *out, size_t n, const double values[])
{
    write_cells(out, n, values);
    fputc('\n', out);
}

void rp_table_row_word(FILE *out, size_t n, const double values[], const char *word)
{
    write_cells(out, n, values);
    fprintf(out, "%s%s\n", n ? "\t" : "", word);
}

rp_status rp_table_finish(FILE *out, const char *name)
{
    errno = 0;
    if (fflush(out) != 0 || ferror(out))
        return rp_fail(RP_IO, "%s: cannot write: %s", name, strerror(errno ? errno : EIO));
    return RP_OK;
}

/* For a link, the target of the link is replaced. */
static const char *find_target(const char *path, char target[PATH_MAX])
{
    if (!realpath(path, target)) snprintf(target, PATH_MAX, "%s", path);
    return target;
}

/* A new file beside the target, under a name that no one can foresee; devices and pipes are written directly.
 */
rp_status rp_file_open(const char *path, FILE **out)
{
    char target[PATH_MAX], temporary[PATH_MAX + 16];
    struct stat info;
    unsigned number;
    if (strcmp(path, "-") == 0) {
        *out = stdout;
        return RP_OK;
    }
    *out = NULL;
    if (stat(path, &info) == 0 && !S_ISREG(info.st_mode)) {
        *out = fopen(path, "w");
    } else if (getrandom(&number, sizeof number, 0) == sizeof number) {
        snprintf(temporary, sizeof temporary, "%s.tmp%08x", find_target(path, target), number);
        const int file = open(temporary, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        if (file >= 0) *out = fdopen(file, "w");
    }
    return *out ? RP_OK : rp_fail(RP_IO, "%s: cannot write: %s", path, strerror(errno));
}

rp_status rp_file_close(const char *path, FILE *out, rp_status keep)
{
    char target[PATH_MAX], temporary[PATH_MAX] = "", link[64];
    struct stat info;
    if (out == stdout) return keep ? keep : rp_table_finish(out, "standard output");
    snprintf(link, sizeof link, "/proc/self/fd/%d", fileno(out));
    const bool renamed = fstat(fileno(out), &info) == 0 && S_ISREG(info.st_mode);
    const bool named = renamed && readlink(link, temporary, sizeof temporary - 1) > 0;
    rp_status status = keep ? keep : rp_table_finish(out, path);
    /* the bytes reach the disk before the name does */
    bool failed = renamed && !status && (fsync(fileno(out)) != 0 || !named);
    failed |= fclose(out) != 0;
    if (!status && !failed && renamed) failed = rename(temporary, find_target(path, target)) != 0;
    if (!status && failed) status = rp_fail(RP_IO, "%s: cannot write: %s", path, strerror(errno));
    if (status && named) unlink(temporary);
    return status;
}

rp_status rp_make_directory(const char *path)
{
    char part[4096];
    if (strlen(path) >= sizeof part) return rp_fail(RP_BAD_INPUT, "%.60s...: path too long", path);
    for (size_t i = 1; i <= strlen(path); i++) {
        if (path[i] != '/' && path[i] != '\0') continue;
        snprintf(part, sizeof part, "%.*s", (int)i, path);
        if (mkdir(part, 0777) != 0 && errno != EEXIST)
            return rp_fail(RP_IO, "%s: cannot make the directory: %s", part, strerror(errno));
    }
    struct stat info;
    if (stat(path, &info) != 0 || !S_ISDIR(info.st_mode)) return rp_fail(RP_IO, "%s: not a directory", path);
    return RP_OK;
}

enum { MOST_BYTES = 1 << 30 };

rp_status rp_file_read(const char *path, char **text)
{
    FILE *in = strcmp(path, "-") == 0 ? stdin : fopen(path, "r");
    *text = NULL;
    if (!in) return rp_fail(RP_BAD_INPUT, "%s: cannot read: %s", path, strerror(errno));
    rp_status status = RP_OK;
    size_t size = 0, room = 0, n = 0;
    do {
        room = 2 * room + 65536;
        char *more = realloc(*text, room);
        if (!more) status = rp_fail(RP_NO_MEMORY, "%s: out of memory", path);
        if (!more) break;
        *text = more;
        n = fread(more + size, 1, room - 1 - size, in);
        if (memchr(more + size, '\0', n)) status = rp_fail(RP_BAD_INPUT, "%s: no text: holds a 0 byte", path);
        more[size += n] = '\0';
        if (!status && size > MOST_BYTES) status = rp_fail(RP_BAD_INPUT, "%s: more than 1 GB", path);
    } while (!status && size == room - 1);
    if (!status && ferror(in)) status = rp_fail(RP_BAD_INPUT, "%s: cannot read: %s", path, strerror(errno));
    if (in != stdin) fclose(in);
    return status;
}

static size_t count_cells(const char *line, const char *blanks)
{
    size_t n = 0;
    for (; *line; n++) {
        line += strspn(line, blanks);
        if (!*line) break;
        line += strcspn(line, blanks);
    }
    return n;
}

static void split_cells(char *line, const char *blanks, char **cells)
{
    for (char *save, *cell = strtok_r(line, blanks, &save); cell; cell = strtok_r(NULL, blanks, &save))
        *cells++ = cell;
}

static rp_status read_table(const char *path, const char *blanks, rp_table *table)
{
    *table = (rp_table){.path = path};
    rp_status status = rp_file_read(path, &table->text);
    if (status) return status;
    size_t n_lines = 1;
    for (const char *p = table->text; *p; p++) n_lines += *p == '\n';
    const size_t most_cells = strlen(table->text) / 2 + 1;
    char *header = NULL;
    size_t line_number = 0;
    table->lines = calloc(n_lines, sizeof *table->lines);
    if (!table->lines) return rp_fail(RP_NO_MEMORY, "%s: out of memory", path);
    for (char *next = table->text, *line; (line = next);) {
        next = strchr(line, '\n');
        if (next) *next++ = '\0';
        line_number++;
        if (*line == '#') {
            if (!table->cells) header = line + 1 + strspn(line + 1, " ");
            continue;
        }
        size_t n = count_cells(line, blanks);
        if (n == 0) continue;
        if (!table->cells) {
            table->n_columns = n;
            table->cells = calloc(n_lines < most_cells / n ? n_lines * n : most_cells, sizeof *table->cells);
            if (!table->cells) return rp_fail(RP_NO_MEMORY, "%s: out of memory", path);
        }
        if (n != table->n_columns)
            return rp_fail(RP_BAD_INPUT, "%s:%zu: %zu cells where %zu are expected", path, line_number, n,
                           table->n_columns);
        split_cells(line, blanks, table->cells + table->n_rows * n);
        table->lines[table->n_rows++] = line_number;
    }
    if (header && table->n_columns == 0) table->n_columns = count_cells(header, blanks);
    table->names = calloc(table->n_columns + 1, sizeof *table->names);
    if (!table->names) return rp_fail(RP_NO_MEMORY, "%s: out of memory", path);
    if (header && count_cells(header, blanks) == table->n_columns) split_cells(header, blanks, table->names);
    return RP_OK;
}

rp_status rp_table_read(const char *path, rp_table *table)
{
    return read_table(path, " \t\r", table);
}

rp_status rp_table_read_texts(const char *path, rp_table *table)
{
    return read_table(path, "\t\r", table);
}

void rp_table_free(rp_table *table)
{
    free(table->names);
    free(table->cells);
    free(table->lines);
    free(table->text);
    *table = (rp_table){0};
}

int rp_table_column(const rp_table *table, const char *name)
{
    for (size_t i = 0; table->names && i < table->n_columns; i++) /* none after an error of reading */
        if (table->names[i] ? strcmp(table->names[i], name) == 0 : (size_t)atol(name) == i + 1) return (int)i;
    return -1;
}

/* rp_table_read has ended every line with NUL; the first row stops the search. */
const char *rp_table_find_note(const rp_table *table, const char *key)
{
    const size_t n = strlen(key);
    if (!table->cells) return NULL;
    for (const char *line = table->text; *line == '#'; line += strlen(line) + 1)
        if (strncmp(line, "# ", 2) == 0 && strncmp(line + 2, key, n) == 0 &&
            strncmp(line + 2 + n, ": ", 2) == 0)
            return line + n + 4;
    return NULL;
}

static bool as_number(const char *text, double *value)
{
    char *end;
    *value = strtod(text, &end);
    return end != text && !*end;
}

/* Does `cell` meet the comparison with `value`? */
static bool meets(const char *cell, const char *op, const char *value)
{
    double a, b;
    const bool first = as_number(cell, &a), numbers = as_number(value, &b) && first;
    const bool equal = numbers ? a == b || (isnan(a) && isnan(b)) : strcmp(cell, value) == 0;
    if (*op == '=') return equal;
    if (*op == '!') return !equal;
    if (!numbers) return false;
    return (op[1] == '=' && equal) || (*op == '<' ? a < b : a > b);
}

rp_status rp_table_where(rp_table *table, const char *condition)
{
    static const char *const operators[] = {"<=", ">=", "!=", "<", ">", "="};
    char name[64];
    double number;
    const size_t length = strcspn(condition, "<>=!"), columns = table->n_columns;
    const char *op = NULL;
    for (size_t i = 0; i < sizeof operators / sizeof *operators && !op; i++)
        if (strncmp(condition + length, operators[i], strlen(operators[i])) == 0) op = operators[i];
    if (!op || length == 0 || length >= sizeof name)
        return rp_fail(RP_BAD_INPUT, "condition \"%s\": NAME=VALUE expected, or != < <= > >=", condition);
    snprintf(name, sizeof name, "%.*s", (int)length, condition);
    const char *value = condition + length + strlen(op);
    const int column = rp_table_column(table, name);
    if (column < 0) return rp_fail(RP_BAD_INPUT, "%s: no column \"%s\"", table->path, name);
    if (strchr("<>", *op) && !as_number(value, &number))
        return rp_fail(RP_BAD_INPUT, "condition \"%s\": \"%s\" is not a number", condition, value);
    size_t kept = 0;
    for (size_t i = 0; i < table->n_rows; i++) {
        if (!meets(table->cells[i * columns + (size_t)column], op, value)) continue;
        memmove(table->cells + kept * columns, table->cells + i * columns, columns * sizeof *table->cells);
        table->lines[kept++] = table->lines[i];
    }
    table->n_rows = kept;
    return RP_OK;
}

rp_status rp_table_number(const rp_table *table, size_t row, int column, int missing_ok, double *value)
{
    const char *cell = table->cells[row * table->n_columns + (size_t)column];
    char *end;
    if (missing_ok && strcmp(cell, "infinite") == 0) {
        *value = INFINITY;
        return RP_OK;
    }
    *value = strtod(cell, &end);
    if (*end || (!isfinite(*value) && !missing_ok))
        return rp_fail(RP_BAD_INPUT, "%s:%zu: column %d%s%s: \"%.40s\" is not a finite number", table->path,
                       table->lines[row], column + 1, table->names[column] ? " " : "",
                       table->names[column] ? table->names[column] : "", cell);
    return RP_OK;
}
