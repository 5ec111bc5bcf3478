/* Names and lists of a text; see reading.h. */
#include "experiment/reading.h"

#include <ctype.h>
#include <string.h>

#include "params/config.h"
#include "params/lets.h"

static bool is_name(const char *word, size_t bytes)
{
    const size_t n = strlen(word);
    return n < bytes && isalpha((unsigned char)*word) && strspn(word, RP_NAME_LETTERS) == n;
}

bool exp_is_word(const char *word)
{
    return is_name(word, sizeof((exp_end *)NULL)->status);
}

rp_status exp_check_word(const config_setting_t *setting, const char *what, const char *name)
{
    if (is_name(name, DEM_NAME_BYTES)) return RP_OK;
    return rp_config_fail(setting, "\"%s\": the name of %s has up to %d letters, digits and _", name, what,
                          DEM_NAME_BYTES - 1);
}

rp_status exp_check_name(const exp_plan *plan, const config_setting_t *setting, const char *what,
                         const char *name)
{
    static const char *const sorts[] = {
        [EXP_REGION] = "a region", [EXP_WALL] = "a wall", [EXP_KIND] = "a kind"};
    const exp_scope *scope = exp_scope_named(plan, EXP_SCOPES, name, strlen(name), NULL);
    RP_TRY(exp_check_word(setting, what, name));
    if (!scope && !rp_lets_has(setting, name)) return RP_OK;
    return rp_config_fail(setting, "%s names %s and %s", name, scope ? sorts[scope->sort] : "a let", what);
}

rp_status exp_find(const exp_plan *plan, int sort, const config_setting_t *setting, const char *key,
                   const char *name, size_t *index)
{
    static const char *const none[] = {[EXP_REGION] = "no such region",
                                       [EXP_WALL] = "no wall has this name",
                                       [EXP_PHASE] = "no such phase",
                                       [EXP_MEASURE] = "no earlier measure has this name"};
    rp_guess guess = rp_guess_of(name);
    const exp_scope *scope = exp_scope_named(plan, (unsigned)sort, name, strlen(name), &guess);
    if (scope) return *index = scope->index, RP_OK;
    if (!key) return rp_config_fail(setting, "%s: %s%s", name, none[sort], rp_guess_text(&guess));
    return rp_config_fail(setting, "%s = \"%s\": %s%s", key, name, none[sort], rp_guess_text(&guess));
}

void exp_add_scope(exp_plan *plan, int sort, size_t index, const char *name)
{
    plan->scopes[plan->n_scopes++] = (exp_scope){.sort = sort, .index = index, .name = name};
}

/* Numbers or expressions, (a, b) or (a, b, c). */
rp_status exp_read_list(const config_setting_t *list, const char *key, size_t n, exp_place *place,
                        exp_expression *e)
{
    if ((!config_setting_is_list(list) && !config_setting_is_array(list)) || length(list) != n)
        return rp_config_fail(list, "%s: %s expected", key, n == 2 ? "(a, b)" : "(a, b, c)");
    for (size_t i = 0; i < n; i++)
        RP_TRY(exp_expression_read(element(list, i), key, RP_X_NUMBER, place, &e[i]));
    return RP_OK;
}

rp_status exp_read_keys(const config_setting_t *group, const char *within, const exp_key_of *keys,
                        exp_place *place)
{
    for (; keys->key; keys++) {
        const config_setting_t *setting = member(group, keys->key);
        exp_expression *e = keys->e;
        char name[64];
        double number;
        if (!setting || !e) continue;
        if (keys->n > 0)
            RP_TRY(exp_read_list(setting, keys->key, keys->n, place, e));
        else
            RP_TRY(exp_expression_read(setting, keys->key, keys->type, place, e));
        if (!keys->range || !e->x.known) continue;
        snprintf(name, sizeof name, "%s%s", within, keys->key);
        const rp_param param = {.name = name, .unit = "", .type = RP_REAL, .range = keys->range};
        if (rp_params_set(&param, &number, &(rp_value){.kind = RP_V_REAL, .r = e->x.value}))
            return rp_config_fail(setting, "%s", rp_message());
    }
    return RP_OK;
}

rp_status exp_read_if(exp_plan *plan, const config_setting_t *group, bool *left_out)
{
    exp_expression e = {0};
    exp_place place;
    exp_place_in(&place, plan);
    place.lets_alone = true;
    RP_TRY(exp_read_keys(group, "", (const exp_key_of[]){{"if", &e, .type = RP_X_TRUTH}, {0}}, &place));
    *left_out = exp_given(&e) && e.x.value == 0.0;
    return RP_OK;
}
