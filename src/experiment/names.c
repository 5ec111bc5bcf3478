/* What names stand for: lets and constants, observables of the run, of regions and of walls, measures. */
#include <math.h>
#include <string.h>

#include "experiment/private.h"
#include "params/config.h"

/* The region, wall or kind in "NAME.", of length n. */
static bool find_scope(const exp_plan *plan, const char *name, size_t n, exp_scope *scope)
{
    for (size_t k = 0; k < plan->n_regions; k++)
        if (strlen(plan->regions[k].name) == n && strncmp(plan->regions[k].name, name, n) == 0)
            return *scope = (exp_scope){EXP_REGION, k}, true;
    for (size_t k = 0; k < plan->n_walls; k++)
        if (strlen(plan->walls[k].name) == n && strncmp(plan->walls[k].name, name, n) == 0)
            return *scope = (exp_scope){EXP_WALL, k}, true;
    for (size_t k = 0; k < plan->n_kinds; k++)
        if (strlen(plan->kinds[k]) == n && strncmp(plan->kinds[k], name, n) == 0)
            return *scope = (exp_scope){EXP_KIND, k}, true;
    return false;
}

static const exp_observable *find_observable(const char *name, unsigned of)
{
    for (const exp_observable *o = exp_observables; o->name; o++)
        if ((o->of & of) && strcmp(o->name, name) == 0) return o;
    return NULL;
}

/* An observable as it is used here. */
static rp_status use(exp_plan *plan, const exp_observable *o, exp_scope scope, const char *name, int n_args,
                     rp_x_symbol *symbol)
{
    const int n = n_args < 0 ? 0 : n_args;
    if (n < o->least || n > o->most || (n_args == 0 && o->most == 0))
        return rp_fail(RP_BAD_INPUT,
                       o->most ? "%s: %d to %d numbers in brackets expected"
                               : "%s: takes nothing in brackets",
                       name, o->least, o->most);
    if ((plan->n_uses & (plan->n_uses + 1)) == 0) { /* a power of two less one: the room is full */
        exp_use *more = rp_arena_memory(&plan->arena, 2 * plan->n_uses + 2, sizeof *more);
        if (!more) return RP_NO_MEMORY;
        if (plan->n_uses) memcpy(more, plan->uses, plan->n_uses * sizeof *more);
        plan->uses = more;
    }
    exp_use *u = &plan->uses[plan->n_uses];
    *u = (exp_use){.of = o,
                   .scope = scope,
                   .n_args = n,
                   .state = plan->n_states,
                   .key = rp_text(&plan->arena, "%s", name)};
    if (!u->key) return RP_NO_MEMORY;
    if (o->type == RP_X_TRUTH) plan->n_states += 3; /* looks */
    *symbol = (rp_x_symbol){.type = o->type, .key = u->key, .id = (int)plan->n_uses++};
    return RP_OK;
}

static rp_status find_measure(const exp_place *place, const char *name, rp_x_symbol *symbol, bool *known)
{
    const exp_plan *plan = place->plan;
    for (size_t k = 0; k < plan->n_measures && !*known; k++) {
        const exp_measure *m = &plan->measures[k];
        for (size_t o = m->output; o < m->output + m->n_outputs; o++) {
            if (strcmp(plan->outputs[o].name, name) != 0) continue;
            const bool during = (m->take == TAKE_FIRST || m->take == TAKE_MAX || m->take == TAKE_MIN) &&
                                m->phase == place->phase && m->skip == 0.0 && !*m->level_of;
            if (place->phase != SIZE_MAX && m->phase >= place->phase && !during)
                return rp_fail(RP_BAD_INPUT, "%s is measured at %s, after this phase", name,
                               plan->phases[m->phase].name);
            if (place->phase == SIZE_MAX && k >= place->measure)
                return rp_fail(RP_BAD_INPUT, "%s is measured after this", name);
            *symbol = (rp_x_symbol){
                .type = RP_X_NUMBER, .key = plan->outputs[o].name, .id = EXP_ID_MEASURE + (int)o};
            *known = true;
        }
    }
    return RP_OK;
}

/* What a new grain knows of itself. */
static const char *const grain_names[EXP_GRAIN_N] = EXP_GRAIN_NAMES;

static bool find_of_grain(const char *name, rp_x_symbol *symbol)
{
    for (int k = 0; k < EXP_GRAIN_N; k++)
        if (strcmp(grain_names[k], name) == 0)
            return *symbol =
                       (rp_x_symbol){.type = RP_X_NUMBER, .key = grain_names[k], .id = EXP_ID_GRAIN + k},
                   true;
    return false;
}

static rp_status find(void *host, const char *name, int n_args, rp_x_symbol *symbol, bool *known)
{
    exp_place *place = host;
    exp_plan *plan = place->plan;
    const char *dot = strchr(name, '.');
    exp_scope scope = {EXP_ALL, 0};
    const exp_observable *o = NULL;
    if (place->of_grain && n_args < 0 && find_of_grain(name, symbol)) return *known = true, RP_OK;
    if (!dot) RP_TRY(rp_lets_find(&plan->text->lets, name, n_args, symbol, known));
    if (*known) return RP_OK;
    if (dot && find_scope(plan, name, (size_t)(dot - name), &scope))
        o = find_observable(dot + 1, scope.kind == EXP_WALL   ? OF_WALL
                                     : scope.kind == EXP_KIND ? OF_GRAINS
                                                              : OF_REGION);
    else if (!dot)
        o = find_observable(name, OF_RUN | OF_GRAINS);
    if (o && place->lets_alone) return rp_fail(RP_BAD_INPUT, "%s is not known before the run", name);
    if (o) return *known = true, use(plan, o, scope, name, n_args, symbol);
    return n_args < 0 && !place->lets_alone ? find_measure(place, name, symbol, known) : RP_OK;
}

static void list(void *host, rp_guess *guess)
{
    const exp_place *place = host;
    const exp_plan *plan = place->plan;
    char name[128];
    rp_lets_list(&plan->text->lets, guess);
    for (const exp_observable *o = exp_observables; o->name; o++) {
        if (o->of & (OF_RUN | OF_GRAINS)) rp_guess_try(guess, o->name);
        for (size_t k = 0; k < plan->n_regions && (o->of & OF_REGION); k++)
            snprintf(name, sizeof name, "%s.%s", plan->regions[k].name, o->name), rp_guess_try(guess, name);
        for (size_t k = 0; k < plan->n_kinds && (o->of & OF_GRAINS); k++)
            snprintf(name, sizeof name, "%s.%s", plan->kinds[k], o->name), rp_guess_try(guess, name);
        for (size_t k = 0; k < plan->n_walls && (o->of & OF_WALL); k++)
            snprintf(name, sizeof name, "%s.%s", plan->walls[k].name, o->name), rp_guess_try(guess, name);
    }
    for (int k = 0; k < EXP_GRAIN_N && place->of_grain; k++) rp_guess_try(guess, grain_names[k]);
    for (size_t k = 0; k < plan->n_outputs; k++) rp_guess_try(guess, plan->outputs[k].name);
}

void exp_place_in(exp_place *place, exp_plan *plan)
{
    *place = (exp_place){.plan = plan, .phase = SIZE_MAX, .measure = SIZE_MAX};
    place->names = (rp_x_names){.host = place, .find = find, .list = list};
}

rp_status exp_expression_read(const config_setting_t *setting, const char *key, rp_x_type type,
                              exp_place *place, exp_expression *e)
{
    static const char *const expected[] = {"a number", "a condition", "a word"};
    exp_plan *plan = place->plan;
    rp_value v;
    if (rp_config_scalar(setting, &v))
        return rp_config_fail(setting, "%s: %s expected, or an expression of it", key, expected[type]);
    if (v.kind != RP_V_TEXT) {
        const rp_x_type is = v.kind == RP_V_BOOL ? RP_X_TRUTH : RP_X_NUMBER;
        if (is != type) return rp_config_fail(setting, "%s: %s expected", key, expected[type]);
        e->x = (rp_expression){.type = type, .known = true, .value = v.kind == RP_V_REAL ? v.r : (double)v.i};
        e->x.text = rp_text(&plan->arena, "%g", e->x.value);
        return e->x.text ? RP_OK : RP_NO_MEMORY;
    }
    if (rp_expression_read_as(&plan->arena, v.s, type, &place->names, &e->x))
        return rp_config_fail(setting, "%s \"%s\"%s%s", key, v.s,
                              strncmp(rp_message(), "is ", 3) ? ", " : " ", rp_message());
    if (e->x.known && type == RP_X_NUMBER && isnan(e->x.value))
        return rp_config_fail(setting, "%s \"%s\" is nan", key, v.s);
    e->state = plan->n_states;
    plan->n_states += e->x.n_states;
    return RP_OK;
}
