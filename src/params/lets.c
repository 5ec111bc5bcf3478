/* Reading the names of a text; see lets.h. */
#include "params/lets.h"

#include <ctype.h>
#include <math.h>
#include <string.h>

#include "params/config.h"
#include "params/settings.h"

/* Is a text a name, which stands for itself unless it is another let's? */
static bool is_word(const char *text)
{
    return isalpha((unsigned char)*text) && strspn(text, RP_NAME_LETTERS) == strlen(text);
}

static rp_status read_value(const rp_let *let, const rp_lets *lets, const rp_value *v, rp_x_symbol *is)
{
    rp_x_symbol other;
    bool known = false;
    *is = (rp_x_symbol){.type = v->kind == RP_V_BOOL ? RP_X_TRUTH : RP_X_NUMBER, .known = true};
    if (v->kind != RP_V_TEXT) return is->value = v->kind == RP_V_REAL ? v->r : (double)v->i, RP_OK;
    if (is_word(v->s) && strcmp(v->s, let->name) != 0)
        RP_TRY(rp_lets_find((rp_lets *)lets, v->s, -1, &other, &known));
    if (known || !is_word(v->s) || strcmp(v->s, "inf") == 0) return rp_lets_value(let->value, v->s, is);
    is->type = RP_X_WORD, is->word = v->s;
    return RP_OK;
}

/* Of a group the further keys, and its value. */
static rp_status read_group(const config_setting_t *group, bool foreign, rp_let *let)
{
    static const rp_param schema[] = {{"unit", "", RP_TEXT, offsetof(rp_let, unit), "", "", ""},
                                      {"range", "", RP_TEXT, offsetof(rp_let, range), "", "", ""},
                                      {"meaning", "", RP_TEXT, offsetof(rp_let, meaning), "", "", ""},
                                      {0}};
    RP_TRY(rp_config_group(group, schema, let, "value"));
    let->value = member(group, "value");
    if (!let->value) return rp_config_fail(group, "let.%s: value is missing", let->name);
    return foreign || !rp_unit_check(rp_config_units(group), let->unit)
               ? RP_OK
               : rp_config_fail(group, "let.%s: %s", let->name, rp_message());
}

/* Is it one of the words of a range of numbers, as in "[1, 10] | none"? */
static bool is_word_of(const rp_param *let, const rp_value *is, double *value)
{
    return is->kind == RP_V_TEXT && strcmp(is->s, "auto") != 0 && !rp_params_set(let, RP_CGS, value, is);
}

static rp_status read_let(const rp_lets *lets, rp_let *let)
{
    const rp_param param = {let->name, let->unit, RP_REAL, 0, NULL, let->range, let->meaning};
    rp_value is;
    if (rp_config_scalar(let->value, &is))
        return rp_fail(RP_BAD_INPUT, "a number, true, false, a word or an expression expected");
    const bool brackets = *let->range == '[' || *let->range == '(', whole = rp_range_is_whole(let->range),
               word = whole && is_word_of(&param, &is, &let->is.value);
    if (word)
        let->is.type = RP_X_NUMBER, let->is.known = true, is.kind = RP_V_REAL;
    else
        RP_TRY(read_value(let, lets, &is, &let->is));
    if (*let->range && !whole && (brackets || let->is.type == RP_X_NUMBER))
        return rp_fail(RP_BAD_INPUT,
                       "range = \"%s\": [a, b] from the lower end to the upper expected, or ( )", let->range);
    const bool infinite = isinf(let->is.value) && strchr(let->range, '|'); /* what such a word stands for */
    let->computed = is.kind == RP_V_TEXT && !(let->is.type == RP_X_WORD && strcmp(let->is.word, is.s) == 0);
    if (*let->range && let->is.type == RP_X_NUMBER && !word && !infinite) {
        double checked; /* units are the text's own */
        RP_TRY(rp_params_set(&param, RP_CGS, &checked, &(rp_value){.kind = RP_V_REAL, .r = let->is.value}));
    }
    return RP_OK;
}

static rp_status read_once(rp_let *let, const rp_lets *lets)
{
    const char *meaning = rp_name_meaning(let->name);
    if (let->state == RP_LET_READ) return RP_OK;
    if (let->state == RP_LET_READING) return rp_fail(RP_BAD_INPUT, "follows from itself");
    if (meaning)
        return rp_fail(RP_BAD_INPUT, "%s is %s in every expression; give the let another name", let->name,
                       meaning);
    if (!is_word(let->name)) return rp_fail(RP_BAD_INPUT, "a name of letters, digits and _ expected");
    let->state = RP_LET_READING;
    RP_TRY(read_let(lets, let));
    let->state = RP_LET_READ;
    return RP_OK;
}

rp_status rp_lets_read(config_setting_t *root, rp_lets *lets)
{
    rp_arena_end(&lets->arena);
    lets->n = 0, lets->read = read_once;
    lets->names = (rp_x_names){.host = lets, .find = rp_lets_find, .list = rp_lets_list, .call = lets->call};
    for (int k = 0; k < RP_LET_CONSTANTS; k++) lets->constants[k] = NAN;
    config_setting_set_hook(root, lets);
    const config_setting_t *group = member(root, "let");
    if (!group) return RP_OK;
    if (!config_setting_is_group(group))
        return rp_config_fail(group, "let: a group { NAME = value; ... } expected");
    RP_NEW(&lets->arena, lets->lets, (size_t)config_setting_length(group));
    for (; lets->n < length(group); lets->n++) {
        const config_setting_t *setting = element(group, lets->n);
        rp_let *let = &lets->lets[lets->n];
        *let = (rp_let){
            .name = config_setting_name(setting), .unit = "", .range = "", .meaning = "", .value = setting};
        if (config_setting_is_group(setting)) RP_TRY(read_group(setting, lets->foreign, let));
    }
    for (rp_let *let = lets->lets; let < lets->lets + lets->n; let++)
        if (read_once(let, lets)) return rp_config_fail(let->value, "let.%s: %s", let->name, rp_message());
    return RP_OK;
}

void rp_lets_end(rp_lets *lets)
{
    rp_arena_end(&lets->arena);
    *lets = (rp_lets){0};
}
