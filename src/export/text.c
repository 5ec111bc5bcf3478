/* Tables as CSV (RFC 4180) and JSON. */
#include <jansson.h>
#include <math.h>
#include <string.h>

#include "core/plain.h"
#include "export/export.h"

static void write_quoted(const char *text, FILE *out)
{
    if (!strpbrk(text, ",\"\r\n")) {
        fputs(text, out);
        return;
    }
    fputc('"', out);
    for (; *text; text++) fputs(*text == '"' ? "\"\"" : (char[]){*text, '\0'}, out);
    fputc('"', out);
}

rp_status export_csv(const rp_table *t, size_t n, const int columns[], FILE *out)
{
    char number[12];
    for (size_t c = 0; c < n; c++) {
        write_quoted(rp_column_name(t, columns[c], number), out);
        fputc(c + 1 < n ? ',' : '\n', out);
    }
    for (size_t i = 0; i < t->n_rows; i++)
        for (size_t c = 0; c < n; c++) {
            write_quoted(rp_cell(t, i, columns[c]), out);
            fputc(c + 1 < n ? ',' : '\n', out);
        }
    return RP_OK;
}

/* ---- JSON ---- */

/* A file that cannot be written is reported when it is closed. */
static rp_status write_json(const rp_table *t, json_t *value, size_t flags, FILE *out)
{
    const size_t as = flags | JSON_ENCODE_ANY | JSON_REAL_PRECISION(17);
    const bool written = value && json_dumpf(value, out, as) == 0;
    json_decref(value);
    if (written || ferror(out)) return RP_OK;
    return rp_fail(RP_NO_MEMORY, "%s: out of memory", t->path);
}

/* A cell as it stands, if JSON has such a number or truth value; nan is null, any other word a string. */
static rp_status write_value(const rp_table *t, const char *text, FILE *out)
{
    double number;
    const bool is_number = rp_text_number(text, &number);
    json_t *value = json_loads(text, JSON_DECODE_ANY, NULL);
    const bool as_is = is_number && json_is_number(value);
    json_decref(value);
    if (as_is || strcmp(text, "true") == 0 || strcmp(text, "false") == 0) return fputs(text, out), RP_OK;
    return write_json(t,
                      !is_number || isinf(number) ? json_string(text)
                      : isnan(number)             ? json_null()
                                                  : json_real(number),
                      0, out);
}

/* A key that stands again has a list of its texts. */
static void add_note(json_t *notes, const char *key, const char *text)
{
    json_t *known = json_object_get(notes, key);
    if (known && !json_is_array(known)) {
        json_t *list = json_array();
        json_array_append(list, known);
        json_object_set_new(notes, key, list);
        known = list;
    }
    if (known)
        json_array_append_new(known, json_string(text));
    else
        json_object_set_new(notes, key, json_string(text));
}

/* The header ends at the names, which are never missing. */
static const char *header_end(const rp_table *t)
{
    return t->names[0] ? t->names[0] : t->cells ? t->cells[0] : t->text;
}

/* Control characters a table has only between its cells. */
static bool is_utf8(const char *text)
{
    for (size_t n; *text; text += n ? n : 1)
        if ((n = rp_character(text)) == 0 && !strchr("\t\r", *text)) return false;
    return true;
}

/* Before the first byte is written. */
static rp_status check_utf8(const rp_table *t, size_t n, const int columns[])
{
    char number[12];
    bool whole = true;
    for (const char *line = t->text; line < header_end(t) && *line == '#'; line += strlen(line) + 1)
        whole &= is_utf8(line);
    for (size_t c = 0; c < n; c++) whole &= is_utf8(rp_column_name(t, columns[c], number));
    if (!whole) return rp_fail(RP_BAD_INPUT, "%s: the header is no UTF-8, which JSON needs", t->path);
    for (size_t i = 0; i < t->n_rows; i++)
        for (size_t c = 0; c < n; c++)
            if (!is_utf8(rp_cell(t, i, columns[c])))
                return rp_fail(RP_BAD_INPUT, "%s:%zu: %s = \"%.40s\": no UTF-8, which JSON needs",
                               RP_PLACE(t, i), rp_column_name(t, columns[c], number),
                               rp_cell(t, i, columns[c]));
    return RP_OK;
}

/* The header lines "# key: text", but the units. */
static json_t *notes_of(const rp_table *t)
{
    json_t *notes = json_object();
    for (const char *line = t->text; line < header_end(t) && *line == '#'; line += strlen(line) + 1) {
        char key[128];
        const char *colon = strstr(line, ": ");
        if (strncmp(line, "# ", 2) != 0 || !colon || colon - line >= (long)sizeof key) continue;
        snprintf(key, sizeof key, "%.*s", (int)(colon - line - 2), line + 2);
        if (strcmp(key, "units") != 0) add_note(notes, key, colon + 2);
    }
    return notes;
}

static json_t *units_of(const rp_table *t, size_t n, const int columns[])
{
    json_t *units = json_object();
    for (size_t c = 0; c < n; c++) {
        char number[12], unit[32];
        rp_column_unit(t, columns[c], unit);
        json_object_set_new(units, rp_column_name(t, columns[c], number), json_string(unit));
    }
    return units;
}

rp_status export_json(const rp_table *t, size_t n, const int columns[], FILE *out)
{
    RP_TRY(check_utf8(t, n, columns));
    json_t *units = units_of(t, n, columns);
    const bool apart = json_object_size(units) == n;
    json_decref(units);
    if (!apart)
        return rp_fail(RP_BAD_INPUT, "%s: two columns have one name, which JSON cannot tell apart", t->path);
    fputs("{\"notes\": ", out);
    RP_TRY(write_json(t, notes_of(t), JSON_INDENT(1), out));
    fputs(",\n\"units\": ", out);
    RP_TRY(write_json(t, units_of(t, n, columns), JSON_INDENT(1), out));
    fputs(",\n\"rows\": [", out);
    for (size_t i = 0; i < t->n_rows; i++)
        for (size_t c = 0; c < n; c++) {
            char number[12];
            fputs(c > 0 ? ", " : i > 0 ? ",\n{" : "\n{", out);
            RP_TRY(write_json(t, json_string(rp_column_name(t, columns[c], number)), 0, out));
            fputs(": ", out);
            RP_TRY(write_value(t, rp_cell(t, i, columns[c]), out));
            if (c + 1 == n) fputs("}", out);
        }
    fputs("\n]}\n", out);
    return RP_OK;
}
