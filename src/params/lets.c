/* Names of a text; see lets.h. */
#include "params/lets.h"

#include <ctype.h>
#include <math.h>
#include <string.h>

#include "params/config.h"
#include "params/units.h"

static const char *const constants[RP_LET_CONSTANTS] = {"d", "m", "g", "dt"};

/* A constant, where a text first asks for it. */
static rp_status know(rp_lets *lets, rp_let_constant k)
{
    if (!isnan(lets->constants[k])) return RP_OK;
    if (!lets->know || lets->asked[k]) return rp_fail(RP_BAD_INPUT, "%s is not known here", constants[k]);
    lets->asked[k] = true;
    rp_status status = lets->know(lets->host, k, &lets->constants[k]);
    lets->asked[k] = false;
    if (!status && isnan(lets->constants[k]))
        status = rp_fail(RP_BAD_INPUT, "%s is not known here", constants[k]);
    return status;
}

rp_status rp_lets_find(rp_lets *lets, const char *name, rp_x_symbol *symbol, bool *known)
{
    for (size_t k = 0; k < lets->n; k++)
        if (strcmp(lets->lets[k].name, name) == 0) return *symbol = lets->lets[k].is, *known = true, RP_OK;
    for (rp_let_constant k = 0; k < RP_LET_CONSTANTS; k++) {
        if (strcmp(constants[k], name) != 0) continue;
        RP_TRY(know(lets, k));
        *symbol = (rp_x_symbol){.type = RP_X_NUMBER, .known = true, .value = lets->constants[k]};
        *known = true;
    }
    return RP_OK;
}

static rp_status find(void *host, const char *name, int n_args, rp_x_symbol *symbol, bool *known)
{
    return n_args < 0 ? rp_lets_find(host, name, symbol, known) : RP_OK;
}

void rp_lets_list(const rp_lets *lets, rp_guess *guess)
{
    for (size_t k = 0; k < lets->n; k++) rp_guess_try(guess, lets->lets[k].name);
    for (int k = 0; k < RP_LET_CONSTANTS; k++) rp_guess_try(guess, constants[k]);
}

static void list(void *host, rp_guess *guess)
{
    rp_lets_list(host, guess);
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

static rp_status read_value(const config_setting_t *root, const rp_value *v, rp_x_symbol *is)
{
    rp_x_symbol earlier;
    bool known = false;
    *is = (rp_x_symbol){.type = v->kind == RP_V_BOOL ? RP_X_TRUTH : RP_X_NUMBER, .known = true};
    if (v->kind != RP_V_TEXT) return is->value = v->kind == RP_V_REAL ? v->r : (double)v->i, RP_OK;
    if (is_word(v->s)) RP_TRY(rp_lets_find(config_setting_get_hook(root), v->s, &earlier, &known));
    if (known || !is_word(v->s)) return rp_lets_value(root, v->s, is);
    is->type = RP_X_WORD, is->word = v->s;
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
    if (strcmp(rp_unit(let->unit), let->unit) != 0)
        return rp_fail(RP_BAD_INPUT, "unit = %s: the text's units are %s; %s", let->unit, rp_units_word(),
                       rp_unit(let->unit));
    return RP_OK;
}

static rp_status read_let(const config_setting_t *root, const config_setting_t *setting, rp_lets *lets)
{
    rp_let let = {.name = config_setting_name(setting), .unit = "", .range = "", .meaning = ""};
    const config_setting_t *value = setting;
    static const char *const taken[] = {"pi", "deg", "inf", "dt", "true", "false", "and", "or", "not"};
    for (size_t k = 0; k < sizeof taken / sizeof *taken; k++)
        if (strcmp(let.name, taken[k]) == 0) return rp_fail(RP_BAD_INPUT, "the name is taken");
    if (!is_word(let.name)) return rp_fail(RP_BAD_INPUT, "a name of letters, digits and _ expected");
    if (config_setting_is_group(setting)) RP_TRY(read_group(setting, &let, &value));
    rp_value is;
    if (rp_config_scalar(value, &is))
        return rp_fail(RP_BAD_INPUT, "a number, true, false, a word or an expression expected");
    for (size_t k = 0; k < lets->n_given; k++)
        if (strcmp(lets->given[k].name, let.name) == 0) is = lets->given[k].value;
    RP_TRY(read_value(root, &is, &let.is));
    let.computed = is.kind == RP_V_TEXT && !(let.is.type == RP_X_WORD && strcmp(let.is.word, is.s) == 0);
    if (*let.range && let.is.type == RP_X_NUMBER) {
        const rp_param param = {let.name, let.unit, RP_REAL, 0, NULL, let.range, let.meaning};
        double checked; /* units are the text's own */
        RP_TRY(rp_params_set(&param, &checked, &(rp_value){.kind = RP_V_REAL, .r = let.is.value}));
    }
    lets->lets[lets->n++] = let;
    return RP_OK;
}

rp_status rp_lets_read(config_setting_t *root, rp_lets *lets)
{
    rp_arena_end(&lets->arena);
    lets->n = 0;
    lets->names = (rp_x_names){.host = lets, .find = find, .list = list};
    for (int k = 0; k < RP_LET_CONSTANTS; k++) lets->constants[k] = NAN;
    config_setting_set_hook(root, lets);
    const config_setting_t *group = config_setting_get_member(root, "let");
    if (!group) return RP_OK;
    if (!config_setting_is_group(group))
        return rp_config_fail(group, "let: a group { NAME = value; ... } expected");
    RP_NEW(&lets->arena, lets->lets, (size_t)config_setting_length(group));
    for (int i = 0; i < config_setting_length(group); i++) {
        const config_setting_t *setting = config_setting_get_elem(group, (unsigned)i);
        if (read_let(root, setting, lets))
            return rp_config_fail(setting, "let.%s: %s", config_setting_name(setting), rp_message());
    }
    return RP_OK;
}

void rp_lets_end(rp_lets *lets)
{
    rp_arena_end(&lets->arena);
    *lets = (rp_lets){0};
}
