/* What names stand for: lets and constants, observables of the run, of regions and of walls, measures. */
#include <math.h>
#include <string.h>

#include "experiment/private.h"
#include "params/config.h"

const exp_scope *exp_scope_named(const exp_plan *plan, unsigned sorts, const char *name, size_t length,
                                 rp_guess *guess)
{
    for (const exp_scope *s = plan->scopes; s < plan->scopes + plan->n_scopes; s++) {
        if (!(s->sort & sorts)) continue;
        if (strlen(s->name) == length && strncmp(s->name, name, length) == 0) return s;
        if (guess) rp_guess_try(guess, s->name);
    }
    return NULL;
}

/* Of what an observable may be asked after a name of this sort; EXP_ALL: without one. */
static unsigned asked_of(int sort)
{
    static const unsigned of[] = {[EXP_ALL] = OF_RUN | OF_GRAINS,
                                  [EXP_REGION] = OF_REGION,
                                  [EXP_WALL] = OF_WALL,
                                  [EXP_KIND] = OF_GRAINS};
    return sort < (int)(sizeof of / sizeof *of) ? of[sort] : 0;
}

const exp_observable *exp_observable_named(const char *name, unsigned of)
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

static rp_status find(void *host, const char *name, int n_args, rp_x_symbol *symbol, bool *known)
{
    exp_place *place = host;
    exp_plan *plan = place->plan;
    const char *dot = strchr(name, '.');
    const exp_scope all = {.sort = EXP_ALL},
                    *scope = dot ? exp_scope_named(plan, EXP_SCOPES, name, (size_t)(dot - name), NULL) : &all;
    const exp_observable *o =
        place->of_grain && n_args < 0 && !dot ? exp_observable_named(name, OF_NEW) : NULL;
    if (!o && !dot && n_args < 0) RP_TRY(rp_lets_find(&plan->text->lets, name, symbol, known));
    if (*known) return RP_OK;
    if (!o && scope) o = exp_observable_named(dot ? dot + 1 : name, asked_of(scope->sort));
    if (o && place->lets_alone) return rp_fail(RP_BAD_INPUT, "%s is not known before the run", name);
    if (o) return *known = true, use(plan, o, *scope, name, n_args, symbol);
    return n_args < 0 && !place->lets_alone ? find_measure(place, name, symbol, known) : RP_OK;
}

static void list(void *host, rp_guess *guess)
{
    const exp_place *place = host;
    const exp_plan *plan = place->plan;
    char name[128];
    rp_lets_list(&plan->text->lets, guess);
    for (const exp_observable *o = exp_observables; o->name; o++) {
        if (o->of & (asked_of(EXP_ALL) | (place->of_grain ? OF_NEW : 0))) rp_guess_try(guess, o->name);
        for (const exp_scope *s = plan->scopes; s < plan->scopes + plan->n_scopes; s++)
            if (o->of & asked_of(s->sort))
                snprintf(name, sizeof name, "%s.%s", s->name, o->name), rp_guess_try(guess, name);
    }
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
