/* Parameter files through a schema; see config.h. */
#include "params/config.h"

#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include "params/guess.h"
#include "params/lets.h"
#include "params/settings.h"
#include "core/file.h"
#include "core/plain.h"

/* libconfig says "syntax error" and the line, no more: this is the line, and what a parameter file is. */
static void explain(const char *path, const char *error, int line, char hint[256])
{
    char *text = NULL;
    *hint = '\0';
    if (strstr(error, "mismatched element type"))
        strcpy(hint, ": [ ] holds one type only; write 0.0 for 0, or use ( )");
    else if ((strstr(error, "syntax error") || strstr(error, "duplicate")) && !rp_file_read(path, &text)) {
        const char *at = text;
        while (line-- > 1 && strchr(at, '\n')) at = strchr(at, '\n') + 1;
        if (at[strspn(at, " \t\r\n")])
            snprintf(hint, 256, " in \"%.*s\" or before it%s",
                     (int)(strcspn(at, "\r\n") < 60 ? strcspn(at, "\r\n") : 60), at,
                     *error == 'd'
                         ? ""
                         : "; expected: key = value; words in quotes, decimal numbers with a point");
        else
            strcpy(hint, " at the end of the file: a value, or } ] ) expected");
    }
    free(text);
}

rp_status rp_config_read_text(const char *name, const char *text, config_t *config)
{
    config_init(config);
    RP_TRY(rp_config_scan_text(name, text));
    if (config_read_string(config, text) == CONFIG_TRUE) return RP_OK;
    return rp_fail(RP_BAD_INPUT, "%s:%d: %s", name, config_error_line(config), config_error_text(config));
}

rp_status rp_config_read(const char *path, config_t *config)
{
    config_init(config);
    RP_TRY(rp_config_scan_file(path));
    if (config_read_file(config, path) == CONFIG_TRUE) return RP_OK;
    const char *text = config_error_text(config) ? config_error_text(config) : "cannot read";
    char hint[256];
    explain(path, text, config_error_line(config), hint);
    return rp_fail(RP_BAD_INPUT, "%s:%d: %s%s", path, config_error_line(config), text, hint);
}

rp_status rp_config_fail(const config_setting_t *setting, const char *format, ...)
{
    char text[RP_MESSAGE];
    va_list args;
    va_start(args, format);
    rp_plain_print(text, format, args);
    va_end(args);
    const char *file = config_setting_source_file(setting);
    const unsigned line = config_setting_source_line(setting);
    /* a setting without a line was not read from a file */
    return line > 0 ? rp_fail(RP_BAD_INPUT, "%s:%u: %s", file ? file : "built-in text", line, text)
                    : rp_fail(RP_BAD_INPUT, "%s", text);
}

/* "walls.[2]", as --set takes it; "" for the top level. */
static void put_path(const config_setting_t *setting, char *text, size_t size)
{
    const config_setting_t *parent = config_setting_parent(setting);
    text[0] = '\0';
    if (!parent) return;
    put_path(parent, text, size);
    const size_t used = strlen(text);
    const char *name = config_setting_name(setting), *dot = used ? "." : "";
    if (name)
        snprintf(text + used, size - used, "%s%s", dot, name);
    else
        snprintf(text + used, size - used, "%s[%d]", dot, config_setting_index(setting));
}

/* "walls.[2]." of the group that holds the setting, or of the group itself. */
static const char *path_within(const config_setting_t *setting)
{
    static _Thread_local char text[256]; /* as of rp_message */
    while (setting && !config_setting_is_group(setting)) setting = config_setting_parent(setting);
    if (setting) put_path(setting, text, sizeof text - 1);
    return setting && *text ? strcat(text, ".") : "";
}

rp_units rp_config_units(const config_setting_t *setting)
{
    const char *word = NULL;
    while (config_setting_parent(setting)) setting = config_setting_parent(setting);
    config_setting_lookup_string(setting, "units", &word);
    return rp_units_find(word);
}

rp_status rp_config_unknown(const config_setting_t *setting, const rp_param *schema, const char *others,
                            const char *more)
{
    const char *name = config_setting_name(setting);
    char allowed[2048] = "", place[RP_PLACE_BYTES];
    size_t used = 0;
    rp_guess guess = rp_guess_of(name);
    rp_guess_schema(&guess, schema);
    rp_guess_words(&guess, others ? others : "");
    const bool misspelt = *guess.nearest && guess.cost <= 2 && strlen(name) > 3; /* one letter */
    if (!misspelt && rp_lets_place(setting, name, place))
        return rp_config_fail(setting, "%s%s: does not belong here, but in %s",
                              path_within(config_setting_parent(setting)), name, place);
    for (; schema->name && used < sizeof allowed; schema++)
        used += (size_t)snprintf(allowed + used, sizeof allowed - used, " %s", schema->name);
    return rp_config_fail(setting, "%s%s: unknown key%s; allowed:%s%s%s%s",
                          path_within(config_setting_parent(setting)), name, rp_guess_text(&guess), allowed,
                          others ? " " : "", others ? others : "", more);
}

rp_status rp_config_scalar(const config_setting_t *setting, rp_value *value)
{
    switch (config_setting_type(setting)) {
    case CONFIG_TYPE_INT:
    case CONFIG_TYPE_INT64:
        *value = (rp_value){.kind = RP_V_INT, .i = (long)config_setting_get_int64(setting)};
        break;
    case CONFIG_TYPE_FLOAT:
        *value = (rp_value){.kind = RP_V_REAL, .r = config_setting_get_float(setting) + 0.0}; /* -0 is 0 */
        break;
    case CONFIG_TYPE_BOOL:
        *value = (rp_value){.kind = RP_V_BOOL, .i = config_setting_get_bool(setting)};
        break;
    case CONFIG_TYPE_STRING:
        *value = (rp_value){.kind = RP_V_TEXT, .s = config_setting_get_string(setting)};
        break;
    default: return RP_BAD_INPUT;
    }
    return RP_OK;
}

/* A text that is no word of the parameter: an expression of the file's names. RP_NO_RESULT: nothing of the
 * kind. */
static rp_status set_computed(const config_setting_t *setting, const rp_param *param, void *values,
                              const char *text)
{
    rp_x_symbol is = {0};
    if (param->type == RP_TEXT || param->type == RP_TEXTS) return RP_NO_RESULT;
    const bool word = param->type == RP_CHOICE;
    RP_TRY(word && !rp_lets_has(setting, text) && !strpbrk(text, "?'(") ? RP_NO_RESULT
                                                                        : rp_lets_value(setting, text, &is));
    if (param->type == RP_INT && fabs(is.value - round(is.value)) <= 1e-9 * fabs(is.value))
        is.value = round(is.value); /* a quotient of times */
    const rp_value value = rp_x_value(is.type, is.value, is.word);
    if (!isfinite(is.value) && param->type == RP_REAL) { /* what is infinite has its word, if there is one */
        char spelt[64];
        rp_params_text(&(rp_param){.type = RP_REAL, .range = param->range}, &is.value, spelt, sizeof spelt);
        return rp_params_set_text(param, rp_config_units(setting), values,
                                  *spelt           ? spelt
                                  : is.value > 0.0 ? "inf"
                                                   : "-inf");
    }
    return rp_params_set(param, rp_config_units(setting), values, &value);
}

rp_status rp_config_value(const config_setting_t *setting, const rp_param *param, void *values)
{
    rp_value value;
    if (param->type == RP_TEXTS && (config_setting_is_list(setting) || config_setting_is_array(setting))) {
        for (size_t i = 0; i < length(setting); i++)
            RP_TRY(rp_config_value(element(setting, i), param, values));
        return RP_OK;
    }
    if (rp_config_scalar(setting, &value) != RP_OK)
        return rp_config_fail(setting, "%s%s: one value expected, not a %s",
                              path_within(config_setting_parent(setting)), param->name,
                              config_setting_is_group(setting) ? "group" : "list");
    if (param->type == RP_TEXT && value.kind == RP_V_TEXT && !rp_is_plain(value.s))
        return rp_config_fail(setting, "%s%s: a text on one line, without tabs, in UTF-8 expected",
                              path_within(setting), param->name);
    rp_status status = rp_params_set(param, rp_config_units(setting), values, &value);
    if (status && value.kind == RP_V_TEXT) {
        status = set_computed(setting, param, values, value.s);
        if (status && status != RP_NO_RESULT)
            return rp_config_fail(setting, "%s%s = \"%s\": %s", path_within(setting), param->name, value.s,
                                  rp_message());
    }
    return status ? rp_config_fail(setting, "%s%s", path_within(setting), rp_message()) : RP_OK;
}

rp_status rp_config_peek(const config_setting_t *group, const rp_param *schema, const char *keys,
                         void *values)
{
    for (; schema->name; schema++) {
        const config_setting_t *setting =
            keys && rp_word_index(keys, schema->name) < 0 ? NULL : member(group, schema->name);
        if (setting) RP_TRY(rp_config_value(setting, schema, values));
    }
    return RP_OK;
}

rp_status rp_config_group(const config_setting_t *group, const rp_param *schema, void *values,
                          const char *others)
{
    if (!config_setting_is_group(group))
        return rp_config_fail(group, "%s: a group { ... } expected",
                              config_setting_name(group) ? config_setting_name(group) : "entry");
    for (size_t i = 0; i < length(group); i++) {
        const config_setting_t *setting = element(group, i);
        const char *name = config_setting_name(setting);
        if (rp_word_index(others, name) >= 0) continue;
        const rp_param *param = rp_params_find(schema, name);
        if (!param) return rp_config_unknown(setting, schema, others, "");
        RP_TRY(rp_config_value(setting, param, values));
    }
    for (; schema->name; schema++)
        if (!schema->fallback && !member(group, schema->name))
            return rp_config_fail(group, "%s%s: missing (%s)", path_within(group), schema->name,
                                  schema->meaning);
    return RP_OK;
}

rp_status rp_config_numbers(const config_setting_t *setting, int n, bool finite, double *numbers)
{
    const char *name = config_setting_name(setting) ? config_setting_name(setting) : "value";
    const char *const expected = n == 2 ? "two numbers [a, b] expected" : "three numbers [a, b, c] expected";
    if ((!config_setting_is_array(setting) && !config_setting_is_list(setting)) ||
        config_setting_length(setting) != n)
        return rp_config_fail(setting, "%s%s: %s", path_within(setting), name, expected);
    for (int i = 0; i < n; i++) {
        rp_value value;
        const config_setting_t *part = element(setting, (size_t)i);
        rp_x_symbol is = {0};
        const bool read = rp_config_scalar(part, &value) == RP_OK;
        rp_status status = read && value.kind == RP_V_TEXT ? rp_lets_value(part, value.s, &is) : RP_NO_RESULT;
        if (status && status != RP_NO_RESULT)
            return rp_config_fail(part, "%s%s = \"%s\": %s", path_within(setting), name, value.s,
                                  rp_message());
        if (!read || value.kind == RP_V_BOOL ||
            (value.kind == RP_V_TEXT && (status || is.type != RP_X_NUMBER)))
            return rp_config_fail(part, "%s%s: %s", path_within(setting), name, expected);
        numbers[i] = !status ? is.value : value.kind == RP_V_INT ? (double)value.i : value.r;
        if (finite && !isfinite(numbers[i]))
            return rp_config_fail(part, "%s%s: finite numbers expected", path_within(setting), name);
    }
    return RP_OK;
}

rp_status rp_config_pair(const config_setting_t *setting, double pair[2])
{
    return rp_config_numbers(setting, 2, true, pair);
}

/* In quotes, as a parameter file has it. */
void rp_config_write_text(FILE *out, const char *text)
{
    fputc('"', out);
    for (const char *c = text; *c; c++)
        if ((unsigned char)*c < ' ')
            fprintf(out, "\\x%02x", (unsigned)*c);
        else
            fprintf(out, strchr("\"\\", *c) ? "\\%c" : "%c", *c);
    fputc('"', out);
}

/* As it is read back to the bit; or, `plain`, each number in one form, whole or not. */
static void write_value(FILE *out, const config_setting_t *setting, bool plain)
{
    rp_value v;
    if (!rp_config_scalar(setting, &v)) {
        if (v.kind == RP_V_INT && plain) v = (rp_value){.kind = RP_V_REAL, .r = (double)v.i};
        if (v.kind == RP_V_REAL) fprintf(out, isinf(v.r) ? "\"%g\"" : "%.17e", v.r);
        if (v.kind == RP_V_INT) fprintf(out, "%ld", v.i);
        if (v.kind == RP_V_BOOL) fputs(v.i ? "true" : "false", out);
        if (v.kind == RP_V_TEXT) rp_config_write_text(out, v.s);
        return;
    }
    const bool named = config_setting_is_group(setting);
    fputs(named ? "{ " : "( ", out);
    for (size_t i = 0; i < length(setting); i++) {
        const config_setting_t *part = element(setting, i);
        if (named) fprintf(out, "%s = ", config_setting_name(part));
        if (!named && i) fputs(", ", out);
        write_value(out, part, plain);
        if (named) fputs("; ", out);
    }
    fputs(named ? "}" : " )", out);
}

void rp_config_write_value(FILE *out, const config_setting_t *setting)
{
    write_value(out, setting, false);
}

void rp_config_write_key(FILE *out, const config_setting_t *setting)
{
    write_value(out, setting, true);
}
