/* A text becomes a plan: names first, then phases, then measures; everything is checked here. */
#include <ctype.h>
#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "experiment/private.h"
#include "params/config.h"

#define member(group, name) config_setting_get_member(group, name)

static const config_setting_t *element(const config_setting_t *list, size_t i)
{
    return config_setting_get_elem(list, (unsigned)i);
}

static size_t length(const config_setting_t *list)
{
    return list ? (size_t)config_setting_length(list) : 0;
}

bool exp_has_phases(const dem_text *text)
{
    return config_lookup(&text->config, "phases") != NULL;
}

/* ---- names ---- */

static bool is_let(const exp_plan *plan, const char *name)
{
    for (size_t k = 0; k < plan->text->lets.n; k++)
        if (strcmp(plan->text->lets.lets[k].name, name) == 0) return true;
    return false;
}

static bool is_observable(const char *name)
{
    for (const exp_observable *o = exp_observables; o->name; o++)
        if (strcmp(o->name, name) == 0) return true;
    return false;
}

/* A name that nothing else has. */
static rp_status check_name(const exp_plan *plan, const config_setting_t *setting, const char *what,
                            const char *name)
{
    const char *other = is_let(plan, name) ? "a let" : NULL;
    for (size_t k = 0; k < plan->n_walls; k++)
        if (strcmp(plan->walls[k].name, name) == 0) other = "a wall";
    for (size_t k = 0; k < plan->n_regions; k++)
        if (strcmp(plan->regions[k].name, name) == 0) other = "a region";
    bool word = isalpha((unsigned char)*name) && strlen(name) < DEM_NAME_BYTES;
    for (const char *c = name; *c; c++) word = word && (isalnum((unsigned char)*c) || *c == '_');
    if (!word)
        return rp_config_fail(setting, "\"%s\": the name of %s has up to %d letters, digits and _", name,
                              what, DEM_NAME_BYTES - 1);
    if (other) return rp_config_fail(setting, "%s names %s and %s", name, other, what);
    return RP_OK;
}

/* A let's name stands alone, as an observable's does. */
static rp_status check_lets(const exp_plan *plan)
{
    const config_setting_t *let = config_lookup(&plan->text->config, "let");
    for (size_t k = 0; k < plan->text->lets.n; k++)
        if (is_observable(plan->text->lets.lets[k].name))
            return rp_config_fail(let, "let.%s: is an observable", plan->text->lets.lets[k].name);
    return RP_OK;
}

static rp_status read_walls(exp_plan *plan)
{
    const dem_scene *s = &plan->scene;
    const config_setting_t *list = config_lookup(&plan->text->config, "walls");
    RP_NEW(&plan->arena, plan->walls, s->n_names);
    for (size_t w = 0; w < s->n_names; w++) {
        size_t k = 0;
        if (!*s->names[w]) continue;
        while (k < plan->n_walls && strcmp(plan->walls[k].name, s->names[w]) != 0) k++;
        exp_wall *wall = &plan->walls[k];
        if (k == plan->n_walls) {
            RP_TRY(check_name(plan, list, "a wall", s->names[w]));
            wall->name = s->names[w];
            RP_NEW(&plan->arena, wall->walls, s->n_names);
            plan->n_walls++;
        }
        wall->walls[wall->n++] = w;
    }
    return RP_OK;
}

/* Numbers or expressions, (a, b) or (a, b, c). */
static rp_status read_list(const config_setting_t *list, const char *key, size_t n, exp_place *place,
                           exp_expression e[])
{
    if ((!config_setting_is_list(list) && !config_setting_is_array(list)) || length(list) != n)
        return rp_config_fail(list, "%s: %s expected", key, n == 2 ? "(a, b)" : "(a, b, c)");
    for (size_t i = 0; i < n; i++)
        RP_TRY(exp_expression_read(element(list, i), key, RP_X_NUMBER, place, &e[i]));
    return RP_OK;
}

static rp_status read_region(const config_setting_t *setting, exp_place *place, exp_region *r)
{
    static const rp_param none[] = {{0}};
    const config_setting_t *x = member(setting, "x"), *y = member(setting, "y"),
                           *circle = member(setting, "circle");
    *r = (exp_region){.name = config_setting_name(setting), .circle = circle != NULL};
    RP_TRY(rp_config_group(setting, none, NULL, (const char *const[]){"x", "y", "circle", NULL}));
    if (circle ? x || y : !x && !y)
        return rp_config_fail(setting, "%s: x, y or both, or circle expected", r->name);
    for (int k = 0; k < 2; k++)
        r->x[k].x = r->y[k].x = (rp_expression){.known = true, .value = k ? INFINITY : -INFINITY};
    if (circle) return read_list(circle, "circle", 3, place, r->circle_of);
    if (x) RP_TRY(read_list(x, "x", 2, place, r->x));
    return y ? read_list(y, "y", 2, place, r->y) : RP_OK;
}

static rp_status read_regions(exp_plan *plan)
{
    const config_setting_t *group = config_lookup(&plan->text->config, "regions");
    exp_place place;
    exp_place_in(&place, plan);
    place.measure = 0; /* no measure is known */
    if (group && !config_setting_is_group(group))
        return rp_config_fail(group, "regions: a group { NAME = { ... }; } expected");
    RP_NEW(&plan->arena, plan->regions, length(group));
    for (size_t i = 0; i < length(group); i++) {
        RP_TRY(check_name(plan, element(group, i), "a region", config_setting_name(element(group, i))));
        RP_TRY(read_region(element(group, i), &place, &plan->regions[i]));
        plan->n_regions++;
    }
    return RP_OK;
}

#define REST(field) offsetof(exp_plan, rest.field)
static const rp_param rest_schema[] = {
    {"energy", "m g d", RP_REAL, REST(energy), "1e-7", "(0, inf)", "largest mean kinetic energy of a grain"},
    {"force", "m g", RP_REAL, REST(force), "1e-2", "(0, inf)", "largest net force on a grain with a contact"},
    {"looks", "", RP_INT, REST(looks), "10", "[1, 1000000]", "in a row that find both"},
    {"every", "steps", RP_INT, REST(every), "500", "[1, 1000000000]", "least distance of two looks"},
    {0}};
static rp_status read_rest(exp_plan *plan)
{
    const config_setting_t *group = config_lookup(&plan->text->config, "rest");
    rp_params_defaults(rest_schema, plan);
    return group ? rp_config_group(group, rest_schema, plan, NULL) : RP_OK;
}

/* ---- measures: their names and outputs, before phases ask for them ---- */

#define IN(field) offsetof(exp_measure, field)
static const rp_param measure_schema[] = {
    {"name", "", RP_TEXT, IN(name), NULL, "", "of the column"},
    {"at", "", RP_TEXT, IN(at), "", "", "phase at whose end; default: the last"},
    {"during", "", RP_TEXT, IN(during), "", "", "phase that is sampled"},
    {"take", "", RP_CHOICE, IN(take), "value", EXP_TAKES,
     "what is made of samples; default: value, or the mean during a phase"},
    {"every", "steps", RP_INT, IN(every), "auto", "[1, 1000000000] | auto",
     "from sample to sample; auto: the phase's looks"},
    {"skip", "", RP_REAL, IN(skip), "0", "[0, 1) | level",
     "share of the samples that is left out; level: until they level off"},
    {"series", "", RP_BOOL, IN(series), "false", "", "whether to write a table of the samples too"},
    {"optional", "", RP_BOOL, IN(optional), "false", "", "whether a run is good without it"},
    {"drop", "", RP_REAL, IN(drop), "none", "(0, inf) | none",
     "least fall that is an avalanche; none: samples with `event`"},
    {"unit", "", RP_TEXT, IN(unit), "", "", "of the column"},
    {"in", "", RP_TEXT, IN(in), "", "", "region of a module's grains"},
    {0}};

static const char *const take_words[] = {"value", "mean", "max", "min", "first", "rate", "avalanches"};

static rp_status find_phase(const exp_plan *plan, const config_setting_t *setting, const char *key,
                            const char *name, size_t *phase)
{
    rp_guess guess = rp_guess_of(name);
    for (size_t k = 0; k < plan->n_phases; k++) {
        if (strcmp(plan->phases[k].name, name) == 0) return *phase = k, RP_OK;
        rp_guess_try(&guess, plan->phases[k].name);
    }
    return rp_config_fail(setting, "%s = \"%s\": no such phase%s", key, name, rp_guess_text(&guess));
}

static rp_status add_output(exp_plan *plan, const exp_measure *m, const char *ending, const char *unit,
                            const char *meaning)
{
    exp_output *o = &plan->outputs[plan->n_outputs];
    o->name = rp_text(&plan->arena, "%s%s", m->name, ending);
    o->unit = strcmp(ending, "_n") == 0 ? "" : unit;
    o->meaning = meaning;
    if (!o->name || !meaning) return RP_NO_MEMORY;
    for (size_t k = 0; k < plan->n_outputs; k++)
        if (strcmp(plan->outputs[k].name, o->name) == 0)
            return rp_config_fail(m->setting, "%s: two measures have this column", o->name);
    plan->n_outputs++;
    return RP_OK;
}

enum { MOST_OUTPUTS = 5 }; /* of samples */

/* Of a module: all its numbers, or with MODULE.OUTPUT one; its keys are the measure's too. */
static rp_status read_module(exp_plan *plan, const config_setting_t *setting, exp_measure *m,
                             const char *others[])
{
    const config_setting_t *what = member(setting, "of");
    const char *of = what ? config_setting_get_string(what) : NULL, *dot = of ? strchr(of, '.') : NULL;
    m->module = of ? exp_module_find(of, dot ? (size_t)(dot - of) : strlen(of)) : NULL;
    m->pick = -1;
    if (!m->module) return RP_OK;
    for (long k = 0; dot && m->module->outputs[k].name; k++)
        if (strcmp(m->module->outputs[k].name + 1, dot + 1) == 0) m->pick = k;
    if (dot && m->pick < 0)
        return rp_config_fail(member(setting, "of"), "of = \"%s\": %s has no such number", of,
                              m->module->name);
    m->params = rp_arena_memory(&plan->arena, 1, m->module->size);
    if (!m->params) return RP_NO_MEMORY;
    rp_params_defaults(m->module->schema, m->params);
    for (const rp_param *p = m->module->schema; p->name; p++) {
        const config_setting_t *key = member(setting, p->name);
        if (key) RP_TRY(rp_config_value(key, p, m->params));
        *others++ = p->name;
    }
    *others = NULL;
    return RP_OK;
}

/* The region of a module's grains. */
static rp_status read_scope(const exp_plan *plan, exp_measure *m)
{
    const config_setting_t *in = member(m->setting, "in");
    rp_guess guess = rp_guess_of(m->in);
    if (in && !m->module)
        return rp_config_fail(in, "in: of a module; an expression names its region, as in %s.grains", m->in);
    for (size_t k = 0; k < plan->n_regions && *m->in; k++) {
        rp_guess_try(&guess, plan->regions[k].name);
        if (strcmp(plan->regions[k].name, m->in) == 0) return m->scope = (exp_scope){EXP_REGION, k}, RP_OK;
    }
    if (*m->in) return rp_config_fail(in, "in = \"%s\": no such region%s", m->in, rp_guess_text(&guess));
    return m->module && m->module->bounded
               ? rp_config_fail(m->setting, "measure %s: in: missing (a region with two ends in x)", m->name)
               : RP_OK;
}

/* The phase of a measure, and what is made of samples there. */
static rp_status read_when(exp_plan *plan, exp_measure *m)
{
    const config_setting_t *setting = m->setting;
    if (*m->at && *m->during)
        return rp_config_fail(setting, "measure %s: has at and during; keep one", m->name);
    m->phase = plan->n_phases - 1;
    while (plan->phases[m->phase].block != SIZE_MAX) m->phase--;
    if (*m->at || *m->during)
        RP_TRY(find_phase(plan, setting, *m->at ? "at" : "during", *m->at ? m->at : m->during, &m->phase));
    const exp_phase *phase = &plan->phases[m->phase];
    const bool many = *m->during || phase->block != SIZE_MAX;
    if (*m->during && phase->n_inner > 0)
        return rp_config_fail(setting, "during = \"%s\": a block; name one of its phases", m->during);
    if (!member(setting, "take")) m->take = many ? TAKE_MEAN : TAKE_VALUE;
    if (many != (m->take != TAKE_VALUE))
        return rp_config_fail(
            setting,
            many ? "measure %s: take = \"%s\" of samples: one of mean, max, min, first, rate, avalanches"
                 : "measure %s: take = \"%s\": needs during = \"PHASE\"",
            m->name, take_words[m->take]);
    if (many && m->module && m->pick < 0)
        return rp_config_fail(setting, "measure %s: samples are of one number, as in of = \"%s.%s\"", m->name,
                              m->module->name, m->module->outputs[0].name + 1);
    if (m->take == TAKE_AVALANCHES && isfinite(m->drop) == (member(setting, "event") != NULL))
        return rp_config_fail(setting, "measure %s: avalanches are found by drop, or by event", m->name);
    if (m->every < 0) m->every = phase->every;
    m->left_out |= phase->left_out || (phase->block != SIZE_MAX && plan->phases[phase->block].left_out);
    return RP_OK;
}

/* The columns of a measure. */
static rp_status name_outputs(exp_plan *plan, exp_measure *m)
{
    static const char *const of_mean[][2] = {{"", "mean"},
                                             {"_sd", "standard deviation of the samples"},
                                             {"_se", "standard error of the mean, by blocking"},
                                             {"_n", "decorrelated samples"},
                                             {0}},
                             *const of_rate[][2] = {{"", "change over time"},
                                                    {"_se", "standard error of the rate, from ten blocks"},
                                                    {0}},
                             *const of_falls[][2] = {{"_n", "avalanches"},
                                                     {"_before", "mean before one"},
                                                     {"_before_se", "its standard error"},
                                                     {"_after", "mean after one"},
                                                     {"_after_se", "its standard error"},
                                                     {0}},
                             *const of_one[][2] = {{"", NULL}, {0}};
    const char *const(*list)[2] = m->take == TAKE_MEAN         ? of_mean
                                  : m->take == TAKE_RATE       ? of_rate
                                  : m->take == TAKE_AVALANCHES ? of_falls
                                                               : of_one;
    const exp_output *o = m->module && m->pick < 0 ? m->module->outputs : NULL;
    const char *of = config_setting_get_string(member(m->setting, "of")),
               *phase = plan->phases[m->phase].name,
               *unit = *m->unit || !m->module || m->pick < 0 ? m->unit : m->module->outputs[m->pick].unit;
    const char *words = m->take == TAKE_VALUE ? "" : take_words[m->take];
    m->output = plan->n_outputs;
    for (; o && o->name; o++) RP_TRY(add_output(plan, m, o->name, o->unit, o->meaning));
    for (size_t k = 0; !(m->module && m->pick < 0) && list[k][0]; k++)
        RP_TRY(add_output(plan, m, list[k][0], unit,
                          rp_text(&plan->arena, "%s%s%s, %s %s", list[k][1] ? list[k][1] : words,
                                  *words || list[k][1] ? " of " : "", of ? of : "a number",
                                  *m->during ? "during" : "at the end of", phase)));
    m->n_outputs = plan->n_outputs - m->output;
    return RP_OK;
}

static rp_status name_measure(exp_plan *plan, const config_setting_t *setting, exp_measure *m)
{
    const char *others[EXP_MODULE_OUTPUTS] = {"of", "when", "if", "event", NULL};
    exp_place place;
    *m = (exp_measure){.setting = setting};
    rp_params_defaults(measure_schema, m);
    if (!config_setting_is_group(setting))
        return rp_config_fail(setting, "measure: a list ( { ... } ) expected");
    RP_TRY(read_module(plan, setting, m, others + 4));
    RP_TRY(rp_config_group(setting, measure_schema, m, others));
    RP_TRY(check_name(plan, setting, "a measure", m->name));
    if (!member(setting, "of"))
        return rp_config_fail(setting, "measure %s: of: missing (what is measured)", m->name);
    exp_place_in(&place, plan);
    place.lets_alone = true;
    if (member(setting, "if")) {
        exp_expression e;
        RP_TRY(exp_expression_read(member(setting, "if"), "if", RP_X_TRUTH, &place, &e));
        m->left_out = e.x.value == 0.0;
    }
    RP_TRY(read_scope(plan, m));
    RP_TRY(read_when(plan, m));
    return name_outputs(plan, m);
}

static size_t count_outputs(const config_setting_t *list)
{
    size_t n = 0;
    for (size_t i = 0; i < length(list); i++) {
        const config_setting_t *of =
            config_setting_is_group(element(list, i)) ? member(element(list, i), "of") : NULL;
        const char *name = of ? config_setting_get_string(of) : NULL;
        n += name && exp_module_find(name, strlen(name)) ? EXP_MODULE_OUTPUTS : MOST_OUTPUTS;
    }
    return n;
}

static rp_status name_measures(exp_plan *plan)
{
    const config_setting_t *list = config_lookup(&plan->text->config, "measure");
    if (list && !config_setting_is_list(list))
        return rp_config_fail(list, "measure: a list ( { ... } ) expected");
    RP_NEW(&plan->arena, plan->measures, length(list));
    RP_NEW(&plan->arena, plan->outputs, count_outputs(list));
    for (size_t i = 0; i < length(list); i++) {
        RP_TRY(name_measure(plan, element(list, i), &plan->measures[i]));
        plan->n_measures++;
    }
    return RP_OK;
}

static rp_status read_measure(exp_plan *plan, size_t k)
{
    exp_measure *m = &plan->measures[k];
    const config_setting_t *when = member(m->setting, "when");
    exp_place place;
    exp_place_in(&place, plan);
    place.names.measure = true;
    place.measure = k;
    m->states[0] = plan->n_states;
    const config_setting_t *event = member(m->setting, "event");
    if (!m->module) RP_TRY(exp_expression_read(member(m->setting, "of"), "of", RP_X_NUMBER, &place, &m->of));
    if (event && m->take != TAKE_AVALANCHES)
        return rp_config_fail(event, "event: needs take = \"avalanches\"");
    if (event) RP_TRY(exp_expression_read(event, "event", RP_X_TRUTH, &place, &m->event));
    if (when && m->take == TAKE_VALUE) return rp_config_fail(when, "when: needs samples, during = \"PHASE\"");
    if (when) RP_TRY(exp_expression_read(when, "when", RP_X_TRUTH, &place, &m->when));
    m->states[1] = plan->n_states;
    return RP_OK;
}

/* ---- phases ---- */

#undef IN
#define IN(field) offsetof(exp_phase, field)
static const rp_param phase_schema[] = {
    {"name", "", RP_TEXT, IN(name), NULL, "", "of the phase"},
    {"least", "steps", RP_INT, IN(least), "0", "[0, 2147483647]", "before looks begin"},
    {"every", "steps", RP_INT, IN(every), "500", "[1, 1000000000]", "from look to look"},
    {"most", "steps", RP_INT, IN(most), "2000000", "[1, 2147483647]", "of a phase that ends by until"},
    {"go_on", "", RP_BOOL, IN(go_on), "false", "", "whether the run goes on when these are used up"},
    {"status", "", RP_TEXT, IN(status), "", "", "word of a run that ends so"},
    {"open", "", RP_TEXT, IN(open), "", "", "wall that opens at the start, at its open_speed"},
    {"mark", "", RP_BOOL, IN(mark), "false", "", "whether positions are marked for `moved` at the start"},
    {"repeat", "", RP_INT, IN(repeat), "auto", "[1, 1000000000] | auto", "passes of a block"},
    {0}};

static bool is_word(const char *word)
{
    const size_t n = strlen(word);
    return n > 0 && n < sizeof((exp_end *)NULL)->status && isalpha((unsigned char)*word) &&
           strspn(word, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_") == n;
}

static rp_status read_fails(const config_setting_t *group, exp_place *place, exp_phase *p)
{
    if (!config_setting_is_group(group))
        return rp_config_fail(group, "fail: a group { word = \"condition\"; } expected");
    RP_NEW(&place->plan->arena, p->fails, length(group));
    for (size_t i = 0; i < length(group); i++) {
        exp_fail *f = &p->fails[i];
        f->word = config_setting_name(element(group, i));
        if (!is_word(f->word) || strncmp(f->word, "ok", 2) == 0)
            return rp_config_fail(element(group, i),
                                  "fail: %s: a word of up to 23 letters expected, not one of a good run",
                                  f->word);
        RP_TRY(exp_expression_read(element(group, i), f->word, RP_X_TRUTH, place, &f->when));
        if (f->when.x.known)
            return rp_config_fail(element(group, i), "%s \"%s\" never changes", f->word, f->when.x.text);
        p->n_fails++;
    }
    return RP_OK;
}

static rp_status read_end(const config_setting_t *setting, exp_place *place, exp_phase *p)
{
    static const struct {
        const char *key;
        rp_x_type type;
    } ends[] = {[EXP_STEPS] = {"steps", RP_X_NUMBER},
                [EXP_TIME] = {"time", RP_X_NUMBER},
                [EXP_UNTIL] = {"until", RP_X_TRUTH}};
    const config_setting_t *end = NULL;
    const bool block = p->n_inner > 0;
    for (exp_ending k = block ? EXP_UNTIL : EXP_STEPS; k <= EXP_UNTIL; k++) {
        const config_setting_t *this = member(setting, ends[k].key);
        if (this && end)
            return rp_config_fail(this, "phase %s: %s and %s; keep one", p->name, ends[p->ending].key,
                                  ends[k].key);
        if (this) end = this, p->ending = k;
    }
    if (!end && !block) return rp_config_fail(setting, "phase %s: steps, time or until is missing", p->name);
    if (!end && p->repeat < 0)
        return rp_config_fail(setting, "phase %s: repeat or until is missing", p->name);
    if (!end) return RP_OK;
    RP_TRY(exp_expression_read(end, ends[p->ending].key, ends[p->ending].type, place, &p->end));
    if (p->ending == EXP_UNTIL && p->end.x.known)
        return rp_config_fail(end, "until \"%s\" never changes", p->end.x.text);
    if (p->ending != EXP_UNTIL && p->end.x.known && !(p->end.x.value >= 0.0 && p->end.x.value < 1e15))
        return rp_config_fail(end, "%s = %g: out of range, allowed: [0, 1e15)", ends[p->ending].key,
                              p->end.x.value);
    return RP_OK;
}

/* Does a condition ask whether grains are at rest? */
static bool asks_rest(const exp_plan *plan, const exp_expression *e)
{
    RP_SCOPE(arena);
    (void)plan;
    const char *key = rp_expression_key(&arena, &e->x);
    for (const char *at = key; at && (at = strstr(at, "rest")); at++)
        if ((at == key || at[-1] == ' ' || at[-1] == '.') && (!at[4] || at[4] == ' ')) return true;
    return false;
}

static rp_status open_wall(const exp_plan *plan, const config_setting_t *setting, exp_phase *p)
{
    rp_guess guess = rp_guess_of(p->open);
    p->opens = -1;
    for (size_t k = 0; k < plan->n_walls && *p->open; k++) {
        rp_guess_try(&guess, plan->walls[k].name);
        if (strcmp(plan->walls[k].name, p->open) == 0) p->opens = (long)k;
    }
    return p->opens >= 0 || !*p->open
               ? RP_OK
               : rp_config_fail(member(setting, "open"), "open = \"%s\": no wall has this name%s", p->open,
                                rp_guess_text(&guess));
}

/* walls = { NAME = { velocity = (vx, vy); omega = ...; }; }. */
static rp_status read_moves(const config_setting_t *group, exp_place *place, exp_phase *p)
{
    static const rp_param none[] = {{0}};
    const exp_plan *plan = place->plan;
    if (!config_setting_is_group(group))
        return rp_config_fail(group, "walls: a group { NAME = { ... }; } expected");
    RP_NEW(&place->plan->arena, p->moves, length(group));
    for (size_t i = 0; i < length(group); i++, p->n_moves++) {
        const config_setting_t *setting = element(group, i);
        const char *name = config_setting_name(setting);
        exp_move *m = &p->moves[i];
        rp_guess guess = rp_guess_of(name);
        while (m->wall < plan->n_walls && strcmp(plan->walls[m->wall].name, name) != 0)
            rp_guess_try(&guess, plan->walls[m->wall++].name);
        if (m->wall == plan->n_walls)
            return rp_config_fail(setting, "%s: no wall has this name%s", name, rp_guess_text(&guess));
        RP_TRY(rp_config_group(setting, none, NULL, (const char *const[]){"velocity", "omega", NULL}));
        m->has_velocity = member(setting, "velocity") != NULL,
        m->has_omega = member(setting, "omega") != NULL;
        if (!m->has_velocity && !m->has_omega)
            return rp_config_fail(setting, "%s: velocity or omega expected", name);
        if (m->has_velocity)
            RP_TRY(read_list(member(setting, "velocity"), "velocity", 2, place, m->velocity));
        if (m->has_omega)
            RP_TRY(exp_expression_read(member(setting, "omega"), "omega", RP_X_NUMBER, place, &m->omega));
        m->each_step = exp_changes(&m->velocity[0]) || exp_changes(&m->velocity[1]) || exp_changes(&m->omega);
        p->each_step |= m->each_step;
    }
    return RP_OK;
}

/* The head of a phase: its own keys, and whether it is left out. */
static rp_status name_phase(exp_plan *plan, const config_setting_t *setting, size_t block, bool has_inner)
{
    /* clang-format off */
    static const char *const others[] = {"if", "steps", "time", "until", "fail", "walls", "gravity",
                                         "gravity_turn_deg_per_step", "box_turn_deg_per_step", NULL};
    /* clang-format on */
    static const char *const of_block[] = {"if", "until", "phases", NULL};
    exp_phase *p = &plan->phases[plan->n_phases];
    const config_setting_t *when = member(setting, "if");
    exp_place place;
    exp_place_in(&place, plan);
    place.lets_alone = true;
    *p = (exp_phase){.setting = setting, .block = block, .ending = EXP_UNTIL};
    rp_params_defaults(phase_schema, p);
    RP_TRY(rp_config_group(setting, phase_schema, p, has_inner ? of_block : others));
    if (!is_word(p->name))
        return rp_config_fail(setting, "name = \"%s\": up to 23 letters, digits and _ expected", p->name);
    for (size_t k = 0; k < plan->n_phases; k++)
        if (strcmp(plan->phases[k].name, p->name) == 0)
            return rp_config_fail(setting, "name = \"%s\": names two phases", p->name);
    for (const char *const *key = (const char *const[]){"least", "every", "most", "open", "mark", NULL};
         has_inner && *key; key++)
        if (member(setting, *key))
            return rp_config_fail(member(setting, *key), "%s: of a block's phases, not of the block", *key);
    if (!has_inner && p->repeat >= 0)
        return rp_config_fail(member(setting, "repeat"), "repeat: needs phases = ( ... ), a block");
    if (*p->status && !is_word(p->status))
        return rp_config_fail(member(setting, "status"),
                              "status = \"%s\": up to 23 letters, digits and _ expected", p->status);
    if (when) {
        exp_expression e;
        RP_TRY(exp_expression_read(when, "if", RP_X_TRUTH, &place, &e));
        p->left_out = e.x.value == 0.0;
    }
    plan->n_phases++;
    return RP_OK;
}

static rp_status name_phases(exp_plan *plan, const config_setting_t *list, size_t block)
{
    if (!config_setting_is_list(list) || length(list) == 0)
        return rp_config_fail(list, "phases: a list ( { ... } ) of one or more expected");
    for (size_t i = 0; i < length(list); i++) {
        const config_setting_t *setting = element(list, i);
        if (!config_setting_is_group(setting))
            return rp_config_fail(setting, "phases: a list ( { ... } ) expected");
        const config_setting_t *inner = member(setting, "phases");
        const size_t phase = plan->n_phases;
        if (inner && block != SIZE_MAX) return rp_config_fail(inner, "phases: a block within a block");
        RP_TRY(name_phase(plan, setting, block, inner != NULL));
        if (!inner) continue;
        RP_TRY(name_phases(plan, inner, phase));
        exp_phase *p = &plan->phases[phase];
        p->n_inner = plan->n_phases - phase - 1;
        bool all_out = true;
        for (size_t k = phase + 1; k < plan->n_phases; k++) all_out &= plan->phases[k].left_out;
        p->left_out |= all_out;
    }
    return RP_OK;
}

static rp_status read_phase(exp_plan *plan, size_t k)
{
    static const char *const turns[] = {"gravity_turn_deg_per_step", "box_turn_deg_per_step"};
    exp_phase *p = &plan->phases[k];
    const config_setting_t *fail = member(p->setting, "fail"), *gravity = member(p->setting, "gravity");
    exp_place place;
    exp_place_in(&place, plan);
    place.phase = p->n_inner ? k + p->n_inner + 1 : k; /* a block's until knows what its phases measure */
    p->states[0] = plan->n_states;
    RP_TRY(read_end(p->setting, &place, p));
    if (p->repeat < 0) p->repeat = p->n_inner ? 1000000 : 1;
    if (fail) RP_TRY(read_fails(fail, &place, p));
    if (member(p->setting, "walls")) RP_TRY(read_moves(member(p->setting, "walls"), &place, p));
    if (gravity) {
        p->has_gravity = true;
        RP_TRY(read_list(gravity, "gravity", 2, &place, p->gravity));
        p->gravity_each_step = exp_changes(&p->gravity[0]) || exp_changes(&p->gravity[1]);
        p->each_step |= p->gravity_each_step;
    }
    for (int t = 0; t < 2; t++) {
        const config_setting_t *turn = member(p->setting, turns[t]);
        p->turns[t] = turn != NULL;
        if (turn) RP_TRY(exp_expression_read(turn, turns[t], RP_X_NUMBER, &place, &p->turn[t]));
        if (turn && p->turn[t].x.known && !(fabs(p->turn[t].x.value) <= 10.0))
            return rp_config_fail(turn, "%s = %g: out of range, allowed: [-10, 10]", turns[t],
                                  p->turn[t].x.value);
    }
    p->states[1] = plan->n_states;
    if (!*p->status && !p->go_on && p->ending == EXP_UNTIL) {
        const bool rest = p->end.x.text && asks_rest(plan, &p->end);
        p->status = rest ? "not_at_rest" : rp_text(&plan->arena, "most_%.17s", p->name);
        if (!p->status) return RP_NO_MEMORY;
    }
    return open_wall(plan, p->setting, p);
}

static size_t count_phases(const config_setting_t *list)
{
    size_t n = length(list);
    for (size_t i = 0; i < length(list); i++)
        if (config_setting_is_group(element(list, i))) n += length(member(element(list, i), "phases"));
    return n;
}

static rp_status read(exp_plan *plan)
{
    dem_text *text = plan->text;
    const config_setting_t *phases = config_lookup(&text->config, "phases");
    rp_x_symbol d = {0}, m = {0}, g = {0};
    bool known = false;
    RP_TRY(dem_text_scene(text, &plan->scene));
    RP_TRY(rp_lets_find(&text->lets, "g", &g, &known));
    known = false;
    RP_TRY(rp_prefix(rp_lets_find(&text->lets, "d", &d, &known), "%s: ", text->path));
    known = false;
    RP_TRY(rp_lets_find(&text->lets, "m", &m, &known));
    plan->d = text->lets.constants[RP_LET_D], plan->m = text->lets.constants[RP_LET_M],
    plan->g = text->lets.constants[RP_LET_G];
    plan->result = "ok";
    config_lookup_string(&text->config, "result", &plan->result);
    if (!is_word(plan->result) || (strcmp(plan->result, "ok") != 0 && strncmp(plan->result, "ok_", 3) != 0))
        return rp_config_fail(config_lookup(&text->config, "result"),
                              "result = \"%s\": ok or ok_... expected", plan->result);
    RP_NEW(&plan->arena, plan->phases, count_phases(phases));
    RP_TRY(check_lets(plan));
    RP_TRY(read_walls(plan));
    RP_TRY(read_regions(plan));
    RP_TRY(read_rest(plan));
    RP_TRY(name_phases(plan, phases, SIZE_MAX));
    RP_TRY(name_measures(plan));
    for (size_t k = 0; k < plan->n_phases; k++) RP_TRY(read_phase(plan, k));
    for (size_t k = 0; k < plan->n_measures; k++) RP_TRY(read_measure(plan, k));
    return RP_OK;
}

rp_status exp_read(dem_text *text, exp_plan **plan)
{
    *plan = calloc(1, sizeof **plan);
    if (!*plan) return rp_fail(RP_NO_MEMORY, "plan: out of memory");
    (*plan)->text = text;
    return read(*plan);
}

void exp_free(exp_plan *plan)
{
    if (!plan) return;
    dem_scene_free(&plan->scene);
    rp_arena_end(&plan->arena);
    free(plan);
}

const dem_scene *exp_scene(const exp_plan *plan)
{
    return &plan->scene;
}

const exp_output *exp_outputs(const exp_plan *plan, size_t *n)
{
    if (n) *n = plan->n_outputs;
    return plan->outputs;
}

const exp_group exp_groups[] = {
    {"phases", phase_schema,
     "a list, in its order: name; one of steps (a number), time (s), until (a condition, looked at every "
     "`every` steps); if "
     "(a "
     "condition of lets); fail = { word = \"condition\"; }; walls = { NAME = { velocity = (vx, vy); omega = "
     "...; }; }; gravity; gravity_turn_deg_per_step; "
     "box_turn_deg_per_step. A block has phases of its own, and repeat or until"},
    {"measure", measure_schema,
     "a list of columns: name; of (an expression); at or during a phase; when (a condition, of samples); if "
     "(a "
     "condition of lets)"},
    {"rest", rest_schema, "what the condition `rest` asks, in m, |g| and d of the mean grain"},
    {0}};
