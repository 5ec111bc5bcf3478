/* What the names of a text stand for; see lets.h. */
#include <math.h>
#include <string.h>

#include "params/lets.h"

static const char *const constants[RP_LET_CONSTANTS] = {"d", "m", "g", "dt"};

const char *rp_name_meaning(const char *name)
{
    static const char *const meanings[][2] = {{"d", "the diameter of the mean grain"},
                                              {"m", "the mass of the mean grain"},
                                              {"g", "the size of gravity"},
                                              {"dt", "the time step"},
                                              {"pi", "the number pi"},
                                              {"deg", "a degree in radians"},
                                              {"inf", "infinity"},
                                              {"true", "a truth"},
                                              {"false", "a truth"},
                                              {"and", "an operator"},
                                              {"or", "an operator"},
                                              {"not", "an operator"}};
    for (size_t k = 0; k < sizeof meanings / sizeof *meanings; k++)
        if (strcmp(meanings[k][0], name) == 0) return meanings[k][1];
    return NULL;
}

rp_status rp_lets_constant(rp_lets *lets, rp_let_constant k, double *value)
{
    double *const constant = &lets->constants[k];
    if (isnan(*constant) && lets->know && !lets->asked[k]) {
        lets->asked[k] = true;
        const rp_status status = lets->know(lets->host, k, constant);
        lets->asked[k] = false;
        RP_TRY(status);
    }
    *value = *constant;
    return isnan(*value) ? rp_fail(RP_BAD_INPUT, "%s is not known here", constants[k]) : RP_OK;
}

rp_status rp_lets_find(void *host, const char *name, int n_args, rp_x_symbol *symbol, bool *known)
{
    rp_lets *lets = host;
    if (n_args >= 0) return RP_OK;
    for (size_t i = 0; i < lets->n; i++) {
        rp_let *let = &lets->lets[i];
        if (strcmp(let->name, name) != 0) continue;
        RP_TRY(rp_prefix(lets->read(let, lets), "let.%s: ", name));
        return *symbol = let->is, *known = true, RP_OK;
    }
    for (rp_let_constant k = 0; k < RP_LET_CONSTANTS; k++) {
        if (strcmp(constants[k], name) != 0) continue;
        *symbol = (rp_x_symbol){.type = RP_X_NUMBER, .known = true};
        RP_TRY(rp_lets_constant(lets, k, &symbol->value));
        *known = true;
    }
    return RP_OK;
}

void rp_lets_list(void *host, rp_guess *guess)
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
    *value = (rp_x_symbol){.type = e.type, .known = true, .value = e.value + 0.0}; /* -0 is 0 */
    if (e.type == RP_X_WORD) value->word = rp_text(&((rp_lets *)lets)->arena, "%s", e.word);
    if (e.type == RP_X_WORD && !value->word) return RP_NO_MEMORY;
    if (isnan(e.value)) return rp_fail(RP_BAD_INPUT, "is nan");
    return RP_OK;
}

rp_value rp_x_value(rp_x_type type, double value, const char *word)
{
    if (type == RP_X_WORD) return (rp_value){.kind = RP_V_TEXT, .s = word};
    if (type == RP_X_TRUTH) return (rp_value){.kind = RP_V_BOOL, .i = value != 0.0};
    return fabs(value) <= 9007199254740992.0 && value == floor(value)
               ? (rp_value){.kind = RP_V_INT, .i = (long)value}
               : (rp_value){.kind = RP_V_REAL, .r = value};
}

void rp_put_place(char text[RP_PLACE_BYTES], size_t *used, const char *name, const char *key,
                  const char *brackets)
{
    const bool list = *brackets == '(';
    if (*used < RP_PLACE_BYTES)
        *used += (size_t)snprintf(text + *used, RP_PLACE_BYTES - *used,
                                  *used        ? ", or %s"
                                  : !*brackets ? "%s"
                                  : list       ? "%s = ( { %s = ...; } )"
                                               : "%s = { %s = ...; }",
                                  name, key);
}

bool rp_lets_place(const config_setting_t *setting, const char *key, char text[RP_PLACE_BYTES])
{
    const rp_lets *lets = lets_of(setting);
    return lets && lets->place && lets->place(key, text);
}

bool rp_lets_has(const config_setting_t *setting, const char *name)
{
    const rp_lets *lets = lets_of(setting);
    bool has = false;
    for (size_t k = 0; lets && k < lets->n; k++) has |= strcmp(lets->lets[k].name, name) == 0;
    return has;
}
