/* Measures of a text: their names and outputs, before phases ask for them; then what they say. */
#include <math.h>
#include <stddef.h>
#include <string.h>

#include "experiment/reading.h"
#include "params/config.h"
#include "params/units.h"
#include "table/columns.h"

#define IN(field) offsetof(exp_measure, field)
const rp_param exp_measure_schema[] = {
    {"name", "", RP_TEXT, IN(name), NULL, "", "of the column"},
    {"at", "", RP_TEXT, IN(at), "", "",
     "phase at whose end, the mean over its passes if it is repeated; default: the last that is not left "
     "out"},
    {"during", "", RP_TEXT, IN(during), "", "", "phase that is sampled"},
    {"take", "", RP_CHOICE, IN(take), "value", EXP_TAKES,
     "what is made of samples; a rate is the mean of those of the passes; default: value, or the mean during "
     "a phase"},
    {"every", "steps", RP_INT, IN(every), "auto", "[1, 1000000000] | auto",
     "from sample to sample; auto: the phase's looks"},
    {"skip", "", RP_REAL, IN(skip), "0", "[0, 1) | level",
     "share of the samples that is left out, the first ones of each pass; level: until they level off"},
    {"level_of", "", RP_TEXT, IN(level_of), "", "",
     "earlier measure of the same phase: as many samples are left out as of that"},
    {"series", "", RP_BOOL, IN(series), "false", "", "whether to write a table of the samples too"},
    {"optional", "", RP_BOOL, IN(optional), "false", "",
     "whether a run is good without it; a module's sample without a value is then left out"},
    {"drop", "", RP_REAL, IN(drop), "none", "(0, inf) | none",
     "least fall that is an avalanche; none: samples with `event`"},
    {"unit", "", RP_TEXT, IN(unit), "", "", "of the column"},
    {"meaning", "", RP_TEXT, IN(meaning), "", "", "of the first column"},
    {"prefix", "", RP_TEXT, IN(prefix), "auto", "",
     "of a module: what its columns' names begin with, which may be nothing; auto: the measure's name"},
    {"in", "", RP_TEXT, IN(in), "", "", "region of a module's grains"},
    {"kind", "", RP_TEXT, IN(kind), "", "", "kind of a module's grains"},
    {"wall", "", RP_TEXT, IN(wall), "", "", "wall of the modules base and forces"},
    {0}};

const char exp_measure_keys[] = "of when if event columns against";

/* What is made of samples, or a value: endings of columns, with what their meaning begins with. */
enum { MOST_OUTPUTS = 5 };
static const exp_output takes[][MOST_OUTPUTS + 1] = {
    [TAKE_VALUE] = {{"", NULL, ""}},
    [TAKE_MEAN] = {{"", NULL, "mean"},
                   {"_sd", NULL, "standard deviation of the samples"},
                   {"_se", NULL, "standard error of the mean, by blocking (of few blocks by Student's t)"},
                   {"_n", NULL, "decorrelated samples"}},
    [TAKE_MAX] = {{"", NULL, "max"}},
    [TAKE_MIN] = {{"", NULL, "min"}},
    [TAKE_FIRST] = {{"", NULL, "first"}},
    [TAKE_RATE] = {{"", NULL, "change over time"},
                   {"_se", NULL, "standard error of the rate, from ten blocks"}},
    [TAKE_AVALANCHES] = {{"_n", NULL, "avalanches"},
                         {"_before", NULL, "mean before one"},
                         {"_before_se", NULL, "its standard error"},
                         {"_after", NULL, "mean after one"},
                         {"_after_se", NULL, "its standard error"}},
    [TAKE_LINE] = {{"_0", NULL, "value at against = 0 of the straight line"},
                   {"_1", NULL, "rise of the straight line"},
                   {"_0_se", NULL, "standard error of the value, from the scatter"},
                   {"_1_se", NULL, "standard error of the rise"}}};

/* The next column: by the measure's name and an ending, or by `columns`, beyond which there is none. */
static rp_status add_output(exp_plan *plan, const exp_measure *m, const char *ending, const char *unit,
                            const char *meaning)
{
    exp_output *o = &plan->outputs[plan->n_outputs];
    const config_setting_t *names = member(m->setting, "columns");
    const size_t number = plan->n_outputs - m->output;
    const char *begin = strcmp(m->prefix, "auto") == 0 ? m->name : m->prefix;
    if (names && number >= length(names)) return RP_OK;
    o->name = names ? config_setting_get_string_elem(names, (int)number)
                    : rp_text(&plan->arena, "%s%s", begin, ending + (!*begin && *ending));
    o->unit = unit;
    o->meaning = number == 0 && *m->meaning ? m->meaning : meaning;
    if (!o->name || !meaning) return RP_NO_MEMORY;
    for (size_t k = 0; k < plan->n_outputs; k++)
        if (strcmp(plan->outputs[k].name, o->name) == 0)
            return rp_config_fail(m->setting, "%s: two measures have this column", o->name);
    if (rp_word_index(RP_SWEEP_COLUMNS, o->name) >= 0)
        return rp_config_fail(m->setting,
                              "%s is a column that every sweep has; give the measure another name", o->name);
    if (rp_lets_has(m->setting, o->name))
        return rp_config_fail(m->setting, "%s names a let and a column of a measure", o->name);
    if (!*ending || strcmp(ending + 1, o->name) != 0) /* of a module, its own name for it */
        RP_TRY(exp_check_meaning(m->setting, "measure", o->name,
                                 config_setting_get_string(member(m->setting, "of"))));
    plan->n_outputs++;
    return RP_OK;
}

/* A word that nothing has as its name, but a module nearly. */
static rp_status check_module(const config_setting_t *setting, const char *of)
{
    if (!of || !exp_is_word(of) || exp_observable_named(of, ~(unsigned)OF_NEW) || rp_lets_has(setting, of))
        return RP_OK;
    rp_guess guess = rp_guess_of(of);
    for (const exp_module *const *m = exp_modules; *m; m++) rp_guess_try(&guess, (*m)->name);
    return *rp_guess_text(&guess)
               ? rp_config_fail(member(setting, "of"), "of \"%s\": unknown name%s", of, rp_guess_text(&guess))
               : RP_OK;
}

/* Of a module: all its numbers, or with MODULE.OUTPUT one; its keys are the measure's too. */
static rp_status read_module(exp_plan *plan, const config_setting_t *setting, exp_measure *m)
{
    const config_setting_t *what = member(setting, "of");
    const char *of = what ? config_setting_get_string(what) : NULL, *dot = of ? strchr(of, '.') : NULL;
    for (const exp_module *const *at = exp_modules; of && *at; at++)
        if (strlen((*at)->name) == strcspn(of, ".") && strncmp((*at)->name, of, strcspn(of, ".")) == 0)
            m->module = *at;
    m->pick = -1;
    if (!m->module) return check_module(setting, of);
    rp_guess guess = rp_guess_of(dot ? dot + 1 : "");
    for (long k = 0; dot && m->module->outputs[k].name; k++) {
        rp_guess_try(&guess, m->module->outputs[k].name + 1);
        if (strcmp(m->module->outputs[k].name + 1, dot + 1) == 0) m->pick = k;
    }
    if (dot && m->pick < 0)
        return rp_config_fail(member(setting, "of"), "of = \"%s\": %s has no such number%s", of,
                              m->module->name, rp_guess_text(&guess));
    m->params = rp_arena_memory(&plan->arena, 1, m->module->size);
    if (!m->params) return RP_NO_MEMORY;
    rp_params_defaults(m->module->schema, plan->scene.def.units, m->params);
    RP_TRY(rp_config_peek(setting, m->module->schema, NULL, m->params));
    for (const rp_param *p = m->module->schema; p->name; p++)
        if (!p->fallback && !member(setting, p->name))
            return rp_config_fail(setting, "%s: missing (%s)", p->name, p->meaning);
    const rp_param *from = rp_params_find(m->module->schema, "from"),
                   *to = rp_params_find(m->module->schema, "to");
    const char *params = m->params;
    if (from && to && !(*(const double *)(params + from->offset) < *(const double *)(params + to->offset)))
        return rp_config_fail(setting, "%s: from is not below to", m->module->name);
    return RP_OK;
}

/* The region of a module's grains. */
static rp_status read_scope(const exp_plan *plan, exp_measure *m)
{
    const config_setting_t *in = member(m->setting, "in");
    const bool on_wall = m->module && (m->module->needs & EXP_ON_WALL);
    if (on_wall != (*m->wall != '\0'))
        return rp_config_fail(m->setting, "measure %s: wall: %s", m->name,
                              on_wall ? "missing, whose load is measured" : "of the module base");
    RP_TRY(exp_find(plan, EXP_WALL, m->setting, "wall", m->wall, &m->on));
    if (in && !m->module)
        return rp_config_fail(in, "in: of a module; an expression names its region, as in %s.grains", m->in);
    if (!*m->in && m->module && (m->module->needs & EXP_BOUNDED))
        return rp_config_fail(m->setting, "measure %s: in: missing (a region with two ends in x)", m->name);
    if (*m->kind && !m->module)
        return rp_config_fail(member(m->setting, "kind"),
                              "kind: of a module; an expression names it, as in %s.grains", m->kind);
    m->scope.sort = (*m->in ? EXP_REGION : 0) | (*m->kind ? EXP_KIND : 0);
    RP_TRY(exp_find(plan, EXP_REGION, m->setting, "in", m->in, &m->scope.index));
    RP_TRY(exp_find(plan, EXP_KIND, m->setting, "kind", m->kind, &m->scope.kind));
    if (!*m->kind && m->module && (m->module->needs & EXP_OF_KIND))
        return rp_config_fail(m->setting, "measure %s: kind: missing (which grains are told from the others)",
                              m->name);
    const exp_region *r = *m->in ? &plan->regions[m->scope.index] : NULL;
    const bool by_ends = m->module && (m->module->add || m->module->needs & EXP_BOUNDED);
    const int ends = !by_ends || !r ? 0 : m->module->add ? 4 : 2;
    if (ends && (r->circle || r->n_points))
        return rp_config_fail(in, "in = \"%s\": of %s, a region of x and y expected", m->in, m->module->name);
    for (int k = 0; k < ends; k++)
        if (r->at[k].x.known && isinf(r->at[k].x.value))
            return rp_config_fail(in, "in = \"%s\": of %s, a region with two ends in %s expected", m->in,
                                  m->module->name, ends == 4 ? "x and y" : "x");
    return RP_OK;
}

/* The phase of a measure, and what is made of samples there. */
static rp_status read_when(exp_plan *plan, exp_measure *m)
{
    const config_setting_t *setting = m->setting;
    if (*m->at && *m->during)
        return rp_config_fail(setting, "measure %s: has at and during; keep one", m->name);
    m->phase = plan->n_phases - 1;
    while (m->phase > 0 && (plan->phases[m->phase].block != SIZE_MAX || plan->phases[m->phase].left_out))
        m->phase--;
    RP_TRY(exp_find(plan, EXP_PHASE, setting, "at", m->at, &m->phase));
    RP_TRY(exp_find(plan, EXP_PHASE, setting, "during", m->during, &m->phase));
    const exp_phase *phase = &plan->phases[m->phase];
    const bool many = *m->during || phase->block != SIZE_MAX;
    if (*m->during && phase->n_inner > 0)
        return rp_config_fail(setting, "during = \"%s\": a block; name one of its phases", m->during);
    if (!member(setting, "take")) m->take = many ? TAKE_MEAN : TAKE_VALUE;
    if (many != (m->take != TAKE_VALUE))
        return rp_config_fail(
            setting,
            many
                ? "measure %s: take = \"%s\" of samples: one of mean, max, min, first, rate, avalanches, line"
                : "measure %s: take = \"%s\": needs during = \"PHASE\"",
            m->name, rp_word_at(EXP_TAKES, m->take, (char[16]){0}, 16));
    if (m->module && m->module->add && (m->series || (many && m->take != TAKE_MEAN)))
        return rp_config_fail(setting, "measure %s: %s has a table of means, and no series", m->name,
                              m->module->name);
    if (many && m->module && m->pick < 0 && !m->module->add)
        return rp_config_fail(setting, "measure %s: samples are of one number, as in of = \"%s.%s\"", m->name,
                              m->module->name, m->module->outputs[0].name + 1);
    if (m->take == TAKE_AVALANCHES && isfinite(m->drop) == (member(setting, "event") != NULL))
        return rp_config_fail(setting, "measure %s: avalanches are found by drop, or by event", m->name);
    if ((m->take == TAKE_LINE) != (member(setting, "against") != NULL))
        return rp_config_fail(setting, "measure %s: take = \"line\" goes with against, an expression",
                              m->name);
    if (m->every < 0) m->every = phase->every;
    m->left_out |= phase->left_out || (phase->block != SIZE_MAX && plan->phases[phase->block].left_out);
    return RP_OK;
}

/* The unit of an observable that stands alone; NULL: it is another expression. */
static const char *unit_named(rp_units units, const char *of)
{
    const char *dot = of ? strrchr(of, '.') : NULL;
    const exp_observable *o = of ? exp_observable_named(dot ? dot + 1 : of, ~(unsigned)OF_NEW) : NULL;
    return o ? rp_unit(units, o->unit) : NULL;
}

/* That of a sample. */
static const char *sampled_unit(rp_units units, const exp_measure *m, const char *of)
{
    return !m->module     ? unit_named(units, of)
           : m->pick >= 0 ? rp_unit(units, m->module->outputs[m->pick].unit)
                          : "";
}

/* The unit of a column of what is made of samples: as given, or of `of`, over time where it is a rate; over
 * that of `against` where it is a rise. */
static const char *unit_of(exp_plan *plan, const exp_measure *m, const char *of, const char *ending)
{
    const rp_units units = plan->scene.def.units;
    const config_setting_t *line = member(m->setting, "against");
    const char *against = line ? config_setting_get_string(line) : NULL,
               *unit = *m->unit ? m->unit : sampled_unit(units, m, of), *over = "";
    if (m->take == TAKE_RATE && !*m->unit) over = rp_unit(units, "s");
    if (m->take == TAKE_LINE && strncmp(ending, "_1", 2) == 0) over = unit_named(units, against);
    if (!unit || !over || strcmp(ending, "_n") == 0) return "";
    return *over ? rp_text(&plan->arena, "%s/%s", *unit ? unit : "1", over) : unit;
}

/* The columns of a measure. */
static rp_status name_outputs(exp_plan *plan, exp_measure *m)
{
    const bool all = m->module && m->pick < 0; /* numbers of the module */
    const char *given = config_setting_get_string(member(m->setting, "of"));
    char *of = given ? rp_text(&plan->arena, "%s", given) : NULL;
    for (char *c = of; c && (c = strpbrk(c, "\n\r\t"));) *c = ' '; /* a meaning is one line */
    m->output = plan->n_outputs;
    for (const exp_output *o = all ? m->module->outputs : takes[m->take]; o->name; o++)
        RP_TRY(add_output(plan, m, o->name,
                          all ? rp_unit(plan->scene.def.units, o->unit) : unit_of(plan, m, given, o->name),
                          all ? o->meaning
                              : rp_text(&plan->arena, "%s%s%s, %s %s", o->meaning, *o->meaning ? " of " : "",
                                        of ? of : "a number", *m->during ? "during" : "at the end of",
                                        plan->phases[m->phase].name)));
    m->n_outputs = plan->n_outputs - m->output;
    m->series_unit =
        *m->unit && m->take != TAKE_RATE ? m->unit : sampled_unit(plan->scene.def.units, m, given);
    if (!m->series_unit) m->series_unit = "";
    return RP_OK;
}

/* columns = ["NAME", ...]: the first of the measure's, by these names. */
static rp_status check_columns(const exp_plan *plan, const exp_measure *m)
{
    const config_setting_t *names = member(m->setting, "columns");
    if (rp_unit_check(plan->scene.def.units, m->unit))
        return rp_config_fail(member(m->setting, "unit"), "%s", rp_message());
    if (!names) return RP_OK;
    bool good = !config_setting_is_group(names) && length(names) > 0 && length(names) <= EXP_MODULE_OUTPUTS;
    for (size_t k = 0; k < length(names); k++) good &= config_setting_get_string(element(names, k)) != NULL;
    if (!good) return rp_config_fail(names, "columns: names, [\"NAME\", ...], expected");
    for (size_t k = 0; k < length(names); k++)
        RP_TRY(exp_check_name(plan, names, "a column", config_setting_get_string(element(names, k))));
    return RP_OK;
}

static rp_status read_level(const exp_plan *plan, exp_measure *m)
{
    const config_setting_t *setting = member(m->setting, "level_of");
    m->levels_with = (size_t)(m - plan->measures);
    if (!*m->level_of) return RP_OK;
    if (member(m->setting, "skip")) return rp_config_fail(setting, "level_of and skip; keep one");
    RP_TRY(exp_find(plan, EXP_MEASURE, m->setting, "level_of", m->level_of, &m->levels_with));
    const exp_measure *other = &plan->measures[m->levels_with];
    if (other->phase != m->phase || other->every != m->every || other->take == TAKE_VALUE ||
        other->take == TAKE_FIRST || *other->during != *m->during || other->left_out)
        return rp_config_fail(setting, "level_of = \"%s\": samples of the same looks expected", m->level_of);
    m->levels_with = other->levels_with;
    return RP_OK;
}

static rp_status name_measure(exp_plan *plan, const config_setting_t *setting, exp_measure *m)
{
    const char *others = exp_measure_keys;
    *m = (exp_measure){.setting = setting};
    rp_params_defaults(exp_measure_schema, plan->scene.def.units, m);
    if (!config_setting_is_group(setting))
        return rp_config_fail(setting, "measure: a list ( { ... } ) expected");
    RP_TRY(read_module(plan, setting, m));
    for (const rp_param *p = m->module ? m->module->schema : exp_no_keys; p->name && others; p++)
        others = rp_text(&plan->arena, "%s %s", others, p->name);
    if (!others) return RP_NO_MEMORY;
    RP_TRY(rp_config_group(setting, exp_measure_schema, m, others));
    /* all numbers of a module have names of their own */
    RP_TRY(m->module && m->pick < 0 ? exp_check_word(setting, "a measure", m->name)
                                    : exp_check_name(plan, setting, "a measure", m->name));
    if (!member(setting, "of"))
        return rp_config_fail(setting, "measure %s: of: missing (what is measured)", m->name);
    if (*m->prefix) RP_TRY(exp_check_word(setting, "a column", m->prefix));
    RP_TRY(exp_read_if(plan, setting, &m->left_out));
    RP_TRY(check_columns(plan, m));
    m->file =
        rp_text(&plan->arena, "%s_%s.tsv", m->module && m->module->add ? m->module->name : "series", m->name);
    if (!m->file) return RP_NO_MEMORY;
    RP_TRY(read_scope(plan, m));
    RP_TRY(read_when(plan, m));
    RP_TRY(read_level(plan, m));
    plan->phases[m->phase].is_sampled |= !m->left_out && *m->during;
    return name_outputs(plan, m);
}

rp_status exp_name_measures(exp_plan *plan)
{
    const config_setting_t *list = config_lookup(&plan->text->config, "measure");
    if (list && !config_setting_is_list(list))
        return rp_config_fail(list, "measure: a list ( { ... } ) expected");
    RP_TRY(exp_check_count(list, length(list)));
    RP_NEW(&plan->arena, plan->measures, length(list));
    RP_NEW(&plan->arena, plan->outputs, length(list) * EXP_MODULE_OUTPUTS);
    RP_NEW(&plan->arena, plan->series, length(list));
    for (size_t i = 0; i < length(list); i++) {
        const exp_measure *m = &plan->measures[i];
        RP_TRY(name_measure(plan, element(list, i), &plan->measures[i]));
        if (m->series || (m->module && m->module->add)) plan->series[plan->n_series++] = i;
        exp_add_scope(plan, EXP_MEASURE, plan->n_measures++, m->name);
    }
    return RP_OK;
}

rp_status exp_read_measure(exp_plan *plan, size_t k)
{
    exp_measure *m = &plan->measures[k];
    const exp_phase *p = &plan->phases[m->phase];
    const config_setting_t *sampled = exp_has_key(m->setting, "when every skip series drop"),
                           *fall = exp_has_key(m->setting, "event drop");
    const exp_key_of keys[] = {{"of", m->module ? NULL : &m->of},
                               {"event", &m->event, .type = RP_X_TRUTH},
                               {"when", &m->when, .type = RP_X_TRUTH},
                               {"against", &m->against},
                               {0}};
    exp_place place;
    exp_place_in(&place, plan);
    place.names.measure = true;
    place.measure = k;
    if (sampled && m->take == TAKE_VALUE)
        return rp_config_fail(sampled, "%s: needs samples, during = \"PHASE\"", config_setting_name(sampled));
    if (fall && m->take != TAKE_AVALANCHES)
        return rp_config_fail(fall, "%s: needs take = \"avalanches\"", config_setting_name(fall));
    m->states[0] = plan->n_states;
    RP_TRY(exp_read_keys(m->setting, "", keys, &place));
    m->states[1] = plan->n_states;
    const long steps = p->ending == EXP_UNTIL ? p->most : exp_known_steps(p);
    if (*m->during && !m->optional && !m->left_out && steps >= 0 && steps < p->least + m->every)
        return rp_config_fail(m->setting,
                              "measure %s: no samples: phase %s has %ld steps; one is taken every %ld",
                              m->name, p->name, steps, m->every);
    if (m->take == TAKE_VALUE && m->of.x.n_states > 0)
        return rp_config_fail(member(m->setting, "of"), "change and held need samples, during = \"PHASE\"");
    return RP_OK;
}
