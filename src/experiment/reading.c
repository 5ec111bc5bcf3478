/* Names and lists of a text; see reading.h. */
#include "experiment/reading.h"

#include <ctype.h>
#include <string.h>

#include "params/config.h"

static bool is_let(const exp_plan *plan, const char *name)
{
    for (size_t k = 0; k < plan->text->lets.n; k++)
        if (strcmp(plan->text->lets.lets[k].name, name) == 0) return true;
    return false;
}

rp_status exp_check_word(const config_setting_t *setting, const char *what, const char *name)
{
    bool word = isalpha((unsigned char)*name) && strlen(name) < DEM_NAME_BYTES;
    for (const char *c = name; *c; c++) word = word && (isalnum((unsigned char)*c) || *c == '_');
    if (word) return RP_OK;
    return rp_config_fail(setting, "\"%s\": the name of %s has up to %d letters, digits and _", name, what,
                          DEM_NAME_BYTES - 1);
}

rp_status exp_check_name(const exp_plan *plan, const config_setting_t *setting, const char *what,
                         const char *name)
{
    const char *other = is_let(plan, name) ? "a let" : NULL;
    for (size_t k = 0; k < plan->n_walls; k++)
        if (strcmp(plan->walls[k].name, name) == 0) other = "a wall";
    for (size_t k = 0; k < plan->n_regions; k++)
        if (strcmp(plan->regions[k].name, name) == 0) other = "a region";
    for (size_t k = 0; k < plan->n_kinds; k++)
        if (strcmp(plan->kinds[k], name) == 0) other = "a kind";
    RP_TRY(exp_check_word(setting, what, name));
    return other ? rp_config_fail(setting, "%s names %s and %s", name, other, what) : RP_OK;
}

bool exp_is_word(const char *word)
{
    const size_t n = strlen(word);
    return n > 0 && n < sizeof((exp_end *)NULL)->status && isalpha((unsigned char)*word) &&
           strspn(word, RP_NAME_LETTERS) == n;
}

rp_status exp_find_wall(const exp_plan *plan, const config_setting_t *setting, const char *key,
                        const char *name, size_t *at)
{
    rp_guess guess = rp_guess_of(name);
    for (size_t k = 0; k < plan->n_walls; k++) {
        if (strcmp(plan->walls[k].name, name) == 0) return *at = k, RP_OK;
        rp_guess_try(&guess, plan->walls[k].name);
    }
    if (!key) return rp_config_fail(setting, "%s: no wall has this name%s", name, rp_guess_text(&guess));
    return rp_config_fail(setting, "%s = \"%s\": no wall has this name%s", key, name, rp_guess_text(&guess));
}

rp_status exp_find_phase(const exp_plan *plan, const config_setting_t *setting, const char *key,
                         const char *name, size_t *phase)
{
    rp_guess guess = rp_guess_of(name);
    for (size_t k = 0; k < plan->n_phases; k++) {
        if (strcmp(plan->phases[k].name, name) == 0) return *phase = k, RP_OK;
        rp_guess_try(&guess, plan->phases[k].name);
    }
    return rp_config_fail(setting, "%s = \"%s\": no such phase%s", key, name, rp_guess_text(&guess));
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
