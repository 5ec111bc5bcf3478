/* What names stand for: lets and constants, observables of the run, of regions and of walls, measures. Then
 * what the readers of a text's parts share; see reading.h. */
#include <ctype.h>
#include <math.h>
#include <string.h>

#include "experiment/reading.h"
#include "params/config.h"
#include "table/table.h"

const exp_scope *exp_scope_named(const exp_plan *plan, unsigned sorts, const char *name, size_t length,
                                 rp_guess *guess)
{
    for (const exp_scope *s = plan->scopes; plan->n_scopes && s < plan->scopes + plan->n_scopes; s++) {
        if (!(s->sort & sorts)) continue;
        if (strlen(s->name) == length && strncmp(s->name, name, length) == 0) return s;
        if (guess) rp_guess_try(guess, s->name);
    }
    return NULL;
}

enum { BOTH = EXP_REGION | EXP_KIND };

/* Of what an observable may be asked after a name of this sort; EXP_ALL: without one. */
static unsigned asked_of(int sort)
{
    return sort == EXP_ALL      ? OF_RUN | OF_GRAINS
           : sort == EXP_REGION ? OF_REGION
           : sort == EXP_WALL   ? OF_WALL
           : sort == EXP_KIND   ? OF_GRAINS
           : sort == BOTH       ? OF_GRAINS | OF_KIND_IN
                                : 0;
}

/* What a name is of, and the observable's name in it: NAME, REGION.NAME, KIND.NAME, WALL.NAME, or of a kind
 * in a region REGION.KIND.NAME or KIND.REGION.NAME. False: it begins with another name. */
static bool split(const exp_plan *plan, const char *name, exp_scope *scope, const char **observable)
{
    *scope = (exp_scope){.sort = EXP_ALL}, *observable = name;
    for (const char *dot; (dot = strchr(*observable, '.')); *observable = dot + 1) {
        const exp_scope *s =
            exp_scope_named(plan, EXP_SCOPES, *observable, (size_t)(dot - *observable), NULL);
        if (!s || (scope->sort && (scope->sort ^ s->sort) != BOTH)) return false;
        scope->sort |= s->sort;
        *(s->sort == EXP_KIND ? &scope->kind : &scope->index) = s->index;
    }
    return true;
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
    const exp_region *r = (o->of & OF_PART) == OF_REGION ? &plan->regions[scope.index] : NULL;
    for (int k = 0; r && k < 4 && !r->circle && !r->n_points; k++)
        if (r->at[k].x.known && isinf(r->at[k].x.value))
            return rp_fail(RP_BAD_INPUT, "%s: over the area of a region, whose x and y have two ends", name);
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

/* Is a measure of samples known while they are taken? */
static bool is_known_during(const exp_measure *m)
{
    return (m->take == TAKE_FIRST || m->take == TAKE_MAX || m->take == TAKE_MIN) && m->skip == 0.0 &&
           !*m->level_of;
}

/* Is a measure known only after all samples of measure k: at the end of the same phase or block? */
static bool is_after_samples(const exp_plan *plan, const exp_measure *m, size_t k)
{
    const exp_measure *by = &plan->measures[k];
    const size_t block = plan->phases[m->phase].block;
    return by->take != TAKE_VALUE && !m->left_out && !is_known_during(m) &&
           (m->phase == by->phase || (block != SIZE_MAX && block == plan->phases[by->phase].block));
}

/* Is a measure taken after measure k? Phases of one block take turns, and a block ends after its phases. */
static bool is_later(const exp_plan *plan, const exp_measure *m, size_t k)
{
    const size_t here = plan->measures[k].phase, block = plan->phases[m->phase].block;
    const bool within = block != SIZE_MAX && (block == here || block == plan->phases[here].block);
    return !m->left_out && m->phase > here && !within;
}

/* The measure with an output of this name; NULL: there is none. */
static const exp_measure *measure_of(const exp_plan *plan, const char *name, size_t *output)
{
    for (const exp_measure *m = plan->measures; plan->n_measures && m < plan->measures + plan->n_measures;
         m++)
        for (*output = m->output; *output < m->output + m->n_outputs; ++*output)
            if (strcmp(plan->outputs[*output].name, name) == 0) return m;
    return NULL;
}

static rp_status find_measure(const exp_place *place, const char *name, rp_x_symbol *symbol, bool *known)
{
    exp_plan *plan = place->plan;
    size_t output;
    const exp_measure *m = measure_of(plan, name, &output);
    if (!m) return RP_OK;
    const bool during = is_known_during(m) && m->phase == place->phase;
    if (place->phase != SIZE_MAX && m->phase >= place->phase && !during)
        return rp_fail(RP_BAD_INPUT, "%s is measured at %s, after this phase", name,
                       plan->phases[m->phase].name);
    if (place->phase == SIZE_MAX &&
        ((size_t)(m - plan->measures) >= place->measure || is_later(plan, m, place->measure)))
        return rp_fail(RP_BAD_INPUT, "%s is measured after this", name);
    if (place->phase == SIZE_MAX && is_after_samples(plan, m, place->measure)) {
        const size_t block = plan->phases[m->phase].block;
        return rp_fail(RP_BAD_INPUT, "%s is known at the end of %s, after these samples", name,
                       plan->phases[block == SIZE_MAX ? m->phase : block].name);
    }
    plan->asks_measures |= place->phase != SIZE_MAX;
    *symbol = (rp_x_symbol){
        .type = RP_X_NUMBER, .key = plan->outputs[output].name, .id = EXP_ID_MEASURE + (int)output};
    *known = true;
    return RP_OK;
}

/* The observable or module alone, in a region or of a kind: a measure may have its name. */
static bool is_same(const char *of, const char *name)
{
    const char *dot = of ? strrchr(of, '.') : NULL;
    const size_t n = strlen(name);
    return of &&
           (strcmp(dot ? dot + 1 : of, name) == 0 || (strncmp(of, name, n) == 0 && strchr(".(", of[n])));
}

rp_status exp_check_meaning(const config_setting_t *setting, const char *what, const char *name,
                            const char *of)
{
    const exp_observable *o = exp_observable_named(name, OF_RUN | OF_GRAINS),
                         *new = exp_observable_named(name, OF_NEW);
    const char *meaning = rp_name_meaning(name), *where = "every expression";
    for (const exp_module *const *m = exp_modules; *m; m++)
        if (strcmp((*m)->name, name) == 0) meaning = "a module", where = "`of` of a measure";
    if (o) meaning = o->meaning;
    if (new && !o) meaning = new->meaning, where = "`add` of a phase";
    if (!meaning || is_same(of, name)) return RP_OK;
    return rp_config_fail(setting,
                          "%s %s: %s already stands for something in %s (%s); give the %s another name", what,
                          name, name, where, meaning, what);
}

/* An observable or a constant is not meant where an earlier measure bears its name. */
static rp_status check_alone(const exp_place *place, const char *what, const char *name)
{
    const exp_plan *plan = place->plan;
    size_t output;
    const exp_measure *m = measure_of(plan, name, &output);
    const size_t k = m ? (size_t)(m - plan->measures) : SIZE_MAX;
    const bool earlier = m && (place->phase == SIZE_MAX ? k < place->measure : m->phase < place->phase);
    return earlier ? rp_fail(RP_BAD_INPUT, "%s is %s and an earlier measure; give the measure another name",
                             name, what)
                   : RP_OK;
}

static rp_status find(void *host, const char *name, int n_args, rp_x_symbol *symbol, bool *known)
{
    exp_place *place = host;
    exp_plan *plan = place->plan;
    const bool dot = strchr(name, '.');
    const char *alone;
    exp_scope scope;
    const bool of_scope = split(plan, name, &scope, &alone);
    const exp_observable *o =
        place->of_grain && n_args < 0 && !dot ? exp_observable_named(name, OF_NEW) : NULL;
    if (!o && !dot) RP_TRY(rp_lets_find(&plan->text->lets, name, n_args, symbol, known));
    if (*known) return check_alone(place, "a constant", name);
    if (!o && of_scope) o = exp_observable_named(alone, asked_of(scope.sort));
    if (o && place->lets_alone) return rp_fail(RP_BAD_INPUT, "%s is not known before the run", name);
    if (o && !dot) RP_TRY(check_alone(place, "an observable", name));
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
        if (o->of & (asked_of(EXP_ALL) | (place->of_grain ? OF_NEW : 0))) rp_guess_try(guess, o->name);
        for (const exp_scope *s = plan->scopes; plan->n_scopes && s < plan->scopes + plan->n_scopes; s++) {
            if (o->of & asked_of(s->sort))
                snprintf(name, sizeof name, "%s.%s", s->name, o->name), rp_guess_try(guess, name);
            for (const exp_scope *in = plan->scopes; in < plan->scopes + plan->n_scopes; in++)
                if ((s->sort ^ in->sort) == BOTH && (o->of & asked_of(BOTH)))
                    snprintf(name, sizeof name, "%s.%s.%s", in->name, s->name, o->name),
                        rp_guess_try(guess, name);
        }
    }
    for (size_t k = 0; k < plan->n_outputs; k++) rp_guess_try(guess, plan->outputs[k].name);
}

/* Known numbers of observables: of `moved` alone. */
static rp_status call(void *host, const char *name, int n, const double args[], double *value, bool *known)
{
    const char *dot = strrchr(name, '.');
    (void)host, (void)n, (void)value, (void)known;
    return strcmp(dot ? dot + 1 : name, "moved") == 0 && args[0] < 0.0
               ? rp_fail(RP_BAD_INPUT, "moved(%g): a distance of 0 or more expected", args[0])
               : RP_OK;
}

void exp_place_in(exp_place *place, exp_plan *plan)
{
    *place = (exp_place){.plan = plan, .phase = SIZE_MAX, .measure = SIZE_MAX};
    place->names = (rp_x_names){.host = place, .find = find, .list = list, .call = call};
}

rp_status exp_expression_read(const config_setting_t *setting, const char *key, rp_x_type type,
                              exp_place *place, exp_expression *e)
{
    exp_plan *plan = place->plan;
    rp_value v;
    if (rp_config_scalar(setting, &v))
        return rp_config_fail(setting, "%s: %s expected, or an expression of it", key, rp_x_types[type]);
    if (v.kind != RP_V_TEXT) {
        const rp_x_type is = v.kind == RP_V_BOOL ? RP_X_TRUTH : RP_X_NUMBER;
        if (is != type) return rp_config_fail(setting, "%s: %s expected", key, rp_x_types[type]);
        e->x = (rp_expression){.type = type, .known = true, .value = v.kind == RP_V_REAL ? v.r : (double)v.i};
        e->x.text = rp_text(&plan->arena, "%g", e->x.value);
        return e->x.text ? RP_OK : RP_NO_MEMORY;
    }
    if (rp_expression_read_as(&plan->arena, v.s, type, &place->names, &e->x))
        return rp_config_fail(setting, "%s \"%s\", %s", key, v.s, rp_message());
    if (e->x.known && isnan(e->x.value)) return rp_config_fail(setting, "%s \"%s\" is nan", key, v.s);
    e->state = plan->n_states;
    plan->n_states += e->x.n_states;
    return RP_OK;
}

/* ---- readers ---- */

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

rp_status exp_check_count(const config_setting_t *list, size_t n)
{
    enum { MOST = 10000 };
    return n <= MOST
               ? RP_OK
               : rp_config_fail(list, "%s: %zu in one list; at most %d", config_setting_name(list), n, MOST);
}

rp_status exp_find(const exp_plan *plan, int sort, const config_setting_t *group, const char *key,
                   const char *name, size_t *index)
{
    static const char *const none[] = {[EXP_REGION] = "no such region",
                                       [EXP_WALL] = "no wall has this name",
                                       [EXP_KIND] = "no grains of this kind",
                                       [EXP_PHASE] = "no such phase",
                                       [EXP_MEASURE] = "no earlier measure has this name"};
    rp_guess guess = rp_guess_of(name);
    const exp_scope *scope = exp_scope_named(plan, (unsigned)sort, name, strlen(name), &guess);
    if (scope) *index = scope->index;
    if (scope || !*name) return RP_OK;
    if (!key) return rp_config_fail(group, "%s: %s%s", name, none[sort], rp_guess_text(&guess));
    return rp_config_fail(member(group, key), "%s = \"%s\": %s%s", key, name, none[sort],
                          rp_guess_text(&guess));
}

void exp_add_scope(exp_plan *plan, int sort, size_t index, const char *name)
{
    plan->scopes[plan->n_scopes++] = (exp_scope){.sort = sort, .index = index, .name = name};
}

const config_setting_t *exp_has_key(const config_setting_t *group, const char *words)
{
    for (size_t i = 0; i < length(group); i++)
        if (rp_word_index(words, config_setting_name(element(group, i))) >= 0) return element(group, i);
    return NULL;
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
        if (keys->whole && rp_text_number(e->x.text, &number) && number != floor(number))
            return rp_config_fail(setting, "%s = %s: a whole number expected", name, e->x.text);
        const rp_param param = {.name = name, .unit = "", .type = RP_REAL, .range = keys->range};
        if (rp_params_set(&param, RP_CGS, &number, &(rp_value){.kind = RP_V_REAL, .r = e->x.value}))
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
