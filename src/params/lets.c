/* Names of a text; see lets.h. */
#include "params/lets.h"

#include <ctype.h>
#include <math.h>
#include <string.h>

#include "params/config.h"

static const char *const constants[RP_LET_CONSTANTS] = {"d", "m", "g", "dt"};

static rp_status find(void *host, const char *name, int n_args, rp_x_symbol *symbol, bool *known)
{
    const rp_lets *lets = host;
    for (size_t k = 0; k < lets->n && n_args < 0 && !*known; k++)
        if (strcmp(lets->lets[k].name, name) == 0) *symbol = lets->lets[k].is, *known = true;
    for (int k = 0; k < RP_LET_CONSTANTS && n_args < 0 && !*known; k++) {
        if (strcmp(constants[k], name) != 0) continue;
        if (isnan(lets->constants[k])) return rp_fail(RP_BAD_INPUT, "%s is not known here", name);
        *symbol = (rp_x_symbol){.type = RP_X_NUMBER, .known = true, .value = lets->constants[k]},
        *known = true;
    }
    return RP_OK;
}

static void list(void *host, rp_guess *guess)
{
    const rp_lets *lets = host;
    for (size_t k = 0; k < lets->n; k++) rp_guess_try(guess, lets->lets[k].name);
    for (int k = 0; k < RP_LET_CONSTANTS; k++) rp_guess_try(guess, constants[k]);
}

static const rp_lets *lets_of(const config_setting_t *setting)
{
    while (config_setting_parent(setting)) setting = config_setting_parent(setting);
    return config_setting_get_hook(setting);
}

rp_status rp_lets_value(const config_setting_t *setting, const char *text, rp_x_symbol *value)
{
    const rp_lets *lets = lets_of(setting);
    rp_expression e = {0};
    RP_SCOPE(arena);
    if (!lets) return RP_NO_RESULT;
    RP_TRY(rp_expression_read(&arena, text, &lets->names, &e));
    if (!e.known) return rp_fail(RP_BAD_INPUT, "is not known before the run");
    *value = (rp_x_symbol){.type = e.type, .known = true, .value = e.value};
    if (e.type == RP_X_WORD) value->word = rp_text(&((rp_lets *)lets)->arena, "%s", e.word);
    if (e.type == RP_X_WORD && !value->word) return RP_NO_MEMORY;
    if (e.type == RP_X_NUMBER && isnan(e.value)) return rp_fail(RP_BAD_INPUT, "is nan");
    return RP_OK;
}

bool rp_lets_has(const config_setting_t *setting, const char *name)
{
    const rp_lets *lets = lets_of(setting);
    bool has = false;
    for (size_t k = 0; lets && k < lets->n; k++) has |= strcmp(lets->lets[k].name, name) == 0;
    return has;
}

/* Is a text a name, which stands for itself unless it is an earlier one's? */
static bool is_word(const char *text)
{
    if (!isalpha((unsigned char)*text)) return false;
    while (isalnum((unsigned char)*text) || *text == '_') text++;
    return !*text;
}

static rp_status read_value(const config_setting_t *setting, rp_x_symbol *is)
{
    const int type = config_setting_type(setting);
    is->known = true;
    if (config_setting_is_number(setting)) {
        is->value = type == CONFIG_TYPE_FLOAT ? config_setting_get_float(setting)
                                              : (double)config_setting_get_int64(setting);
    } else if (type == CONFIG_TYPE_BOOL) {
        is->type = RP_X_TRUTH, is->value = config_setting_get_bool(setting);
    } else if (type == CONFIG_TYPE_STRING) {
        const char *text = config_setting_get_string(setting);
        rp_x_symbol earlier;
        bool known = false;
        if (is_word(text)) RP_TRY(find((void *)lets_of(setting), text, -1, &earlier, &known));
        if (known || !is_word(text)) return rp_lets_value(setting, text, is);
        is->type = RP_X_WORD, is->word = text;
    } else {
        return rp_fail(RP_BAD_INPUT, "a number, true, false, a word or an expression expected");
    }
    return RP_OK;
}

/* The further keys of a group, and the range of a number. */
static rp_status read_group(const config_setting_t *setting, rp_let *let, const config_setting_t **value)
{
    const struct {
        const char *key, **at;
    } texts[] = {{"unit", &let->unit}, {"range", &let->range}, {"meaning", &let->meaning}};
    *value = config_setting_get_member(setting, "value");
    if (!*value) return rp_fail(RP_BAD_INPUT, "value is missing");
    for (int i = 0; i < config_setting_length(setting); i++) {
        const config_setting_t *member = config_setting_get_elem(setting, (unsigned)i);
        const char *name = config_setting_name(member);
        bool known = strcmp(name, "value") == 0;
        for (int k = 0; k < 3; k++)
            if (strcmp(name, texts[k].key) == 0) {
                known = true, *texts[k].at = config_setting_get_string(member);
                if (!*texts[k].at) return rp_fail(RP_BAD_INPUT, "%s: a text expected", name);
            }
        if (!known) return rp_fail(RP_BAD_INPUT, "unknown key %s; allowed: value unit range meaning", name);
    }
    return RP_OK;
}

static rp_status read_let(const config_setting_t *setting, rp_lets *lets)
{
    rp_let let = {.name = config_setting_name(setting), .unit = "", .range = "", .meaning = ""};
    const config_setting_t *value = setting;
    static const char *const taken[] = {"pi", "deg", "inf", "dt", "true", "false", "and", "or", "not"};
    for (size_t k = 0; k < sizeof taken / sizeof *taken; k++)
        if (strcmp(let.name, taken[k]) == 0) return rp_fail(RP_BAD_INPUT, "the name is taken");
    if (!is_word(let.name)) return rp_fail(RP_BAD_INPUT, "a name of letters, digits and _ expected");
    if (config_setting_is_group(setting)) RP_TRY(read_group(setting, &let, &value));
    RP_TRY(read_value(value, &let.is));
    if (*let.range && let.is.type == RP_X_NUMBER) {
        const rp_param param = {let.name, let.unit, RP_REAL, 0, NULL, let.range, let.meaning};
        double checked;
        RP_TRY(rp_params_set(&param, &checked, &(rp_value){.kind = RP_V_REAL, .r = let.is.value}));
    }
    lets->lets[lets->n++] = let;
    return RP_OK;
}

rp_status rp_lets_read(config_setting_t *root, rp_lets *lets)
{
    *lets = (rp_lets){.names = {.host = lets, .find = find, .list = list}};
    for (int k = 0; k < RP_LET_CONSTANTS; k++) lets->constants[k] = NAN;
    config_setting_set_hook(root, lets);
    const config_setting_t *group = config_setting_get_member(root, "let");
    if (!group) return RP_OK;
    if (!config_setting_is_group(group))
        return rp_config_fail(group, "let: a group { NAME = value; ... } expected");
    RP_NEW(&lets->arena, lets->lets, (size_t)config_setting_length(group));
    for (int i = 0; i < config_setting_length(group); i++) {
        const config_setting_t *setting = config_setting_get_elem(group, (unsigned)i);
        if (read_let(setting, lets))
            return rp_config_fail(setting, "let.%s: %s", config_setting_name(setting), rp_message());
    }
    return RP_OK;
}

void rp_lets_end(rp_lets *lets)
{
    rp_arena_end(&lets->arena);
    *lets = (rp_lets){0};
}
