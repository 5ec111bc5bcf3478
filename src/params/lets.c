/* Reading the names of a text; see lets.h. */
#include "params/lets.h"

#include <ctype.h>
#include <math.h>
#include <string.h>

#include "params/config.h"
#include "params/settings.h"

/* Is a text a name, which stands for itself unless it is an earlier one's? */
static bool is_word(const char *text)
{
    return isalpha((unsigned char)*text) && strspn(text, RP_NAME_LETTERS) == strlen(text);
}

static rp_status read_value(const config_setting_t *root, const rp_value *v, rp_x_symbol *is)
{
    rp_x_symbol earlier;
    bool known = false;
    *is = (rp_x_symbol){.type = v->kind == RP_V_BOOL ? RP_X_TRUTH : RP_X_NUMBER, .known = true};
    if (v->kind != RP_V_TEXT) return is->value = v->kind == RP_V_REAL ? v->r : (double)v->i, RP_OK;
    if (is_word(v->s)) RP_TRY(rp_lets_find(config_setting_get_hook(root), v->s, -1, &earlier, &known));
    if (known || !is_word(v->s) || strcmp(v->s, "inf") == 0) return rp_lets_value(root, v->s, is);
    is->type = RP_X_WORD, is->word = v->s;
    return RP_OK;
}

/* Of a group the further keys, and its value. */
static rp_status read_group(const config_setting_t *group, bool foreign, rp_let *let,
                            const config_setting_t **value)
{
    static const rp_param schema[] = {{"unit", "", RP_TEXT, offsetof(rp_let, unit), "", "", ""},
                                      {"range", "", RP_TEXT, offsetof(rp_let, range), "", "", ""},
                                      {"meaning", "", RP_TEXT, offsetof(rp_let, meaning), "", "", ""},
                                      {0}};
    RP_TRY(rp_config_group(group, schema, let, "value"));
    *value = member(group, "value");
    if (!*value) return rp_config_fail(group, "let.%s: value is missing", let->name);
    return foreign || !rp_unit_check(rp_config_units(group), let->unit)
               ? RP_OK
               : rp_config_fail(group, "let.%s: %s", let->name, rp_message());
}

/* Is it one of the words of a range of numbers, as in "[1, 10] | none"? */
static bool is_word_of(const rp_param *let, const rp_value *is, double *value)
{
    return is->kind == RP_V_TEXT && strcmp(is->s, "auto") != 0 && !rp_params_set(let, RP_CGS, value, is);
}

static rp_status read_let(const config_setting_t *root, const config_setting_t *value, rp_let let,
                          rp_lets *lets)
{
    if (rp_word_index("pi deg inf dt true false and or not", let.name) >= 0)
        return rp_fail(RP_BAD_INPUT, "the name is taken");
    if (!is_word(let.name)) return rp_fail(RP_BAD_INPUT, "a name of letters, digits and _ expected");
    const rp_param param = {let.name, let.unit, RP_REAL, 0, NULL, let.range, let.meaning};
    rp_value is;
    if (rp_config_scalar(value, &is))
        return rp_fail(RP_BAD_INPUT, "a number, true, false, a word or an expression expected");
    const bool brackets = *let.range == '[' || *let.range == '(', whole = rp_range_is_whole(let.range),
               word = whole && is_word_of(&param, &is, &let.is.value);
    if (word)
        let.is.type = RP_X_NUMBER, let.is.known = true, is.kind = RP_V_REAL;
    else
        RP_TRY(read_value(root, &is, &let.is));
    if (*let.range && !whole && (brackets || let.is.type == RP_X_NUMBER))
        return rp_fail(RP_BAD_INPUT,
                       "range = \"%s\": [a, b] from the lower end to the upper expected, or ( )", let.range);
    const bool infinite = isinf(let.is.value) && strchr(let.range, '|'); /* what such a word stands for */
    let.computed = is.kind == RP_V_TEXT && !(let.is.type == RP_X_WORD && strcmp(let.is.word, is.s) == 0);
    if (*let.range && let.is.type == RP_X_NUMBER && !word && !infinite) {
        double checked; /* units are the text's own */
        RP_TRY(rp_params_set(&param, RP_CGS, &checked, &(rp_value){.kind = RP_V_REAL, .r = let.is.value}));
    }
    lets->lets[lets->n++] = let;
    return RP_OK;
}

rp_status rp_lets_read(config_setting_t *root, rp_lets *lets)
{
    rp_arena_end(&lets->arena);
    lets->n = 0;
    lets->names = (rp_x_names){.host = lets, .find = rp_lets_find, .list = rp_lets_list, .call = lets->call};
    for (int k = 0; k < RP_LET_CONSTANTS; k++) lets->constants[k] = NAN;
    config_setting_set_hook(root, lets);
    const config_setting_t *group = member(root, "let");
    if (!group) return RP_OK;
    if (!config_setting_is_group(group))
        return rp_config_fail(group, "let: a group { NAME = value; ... } expected");
    RP_NEW(&lets->arena, lets->lets, (size_t)config_setting_length(group));
    for (size_t i = 0; i < length(group); i++) {
        const config_setting_t *setting = element(group, i), *value = setting;
        rp_let let = {.name = config_setting_name(setting), .unit = "", .range = "", .meaning = ""};
        if (config_setting_is_group(setting)) RP_TRY(read_group(setting, lets->foreign, &let, &value));
        if (read_let(root, value, let, lets))
            return rp_config_fail(setting, "let.%s: %s", config_setting_name(setting), rp_message());
    }
    return RP_OK;
}

void rp_lets_end(rp_lets *lets)
{
    rp_arena_end(&lets->arena);
    *lets = (rp_lets){0};
}
