/* Phases of a text: their names, then what they do and how they end. */
#include <ctype.h>
#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "experiment/reading.h"
#include "params/config.h"

#define IN(field) offsetof(exp_phase, field)
const rp_param exp_phase_schema[] = {
    {"name", "", RP_TEXT, IN(name), NULL, "", "of the phase"},
    {"least", "steps", RP_INT, IN(least), "0", "[0, 2147483647]", "before looks begin"},
    {"every", "steps", RP_INT, IN(every), "500", "[1, 1000000000]", "from look to look"},
    {"most", "steps", RP_INT, IN(most), "2000000", "[1, 2147483647]", "of a phase that ends by until"},
    {"go_on", "", RP_BOOL, IN(go_on), "false", "", "whether the run goes on when these are used up"},
    {"status", "", RP_TEXT, IN(status), "", "", "word of a run that ends so"},
    {"open", "", RP_TEXT, IN(open), "", "", "wall that opens at the start, at its open_speed"},
    {"mark", "", RP_BOOL, IN(mark), "true", "",
     "whether positions are marked for `moved` at the start; of a block's phases false, unless given"},
    {"damp", "", RP_BOOL, IN(damp), "false", "",
     "whether all grains stop at each look at which the kinetic energy has fallen since the last"},
    {"from", "", RP_TEXT, IN(from), "", "", "earlier phase to whose end the run first goes back"},
    {"remove", "", RP_TEXT, IN(remove), "", "", "region whose grains are taken out at the start"},
    {"keep", "", RP_BOOL, IN(keep), "false", "",
     "whether the state at the end is kept: by `repose run -o` for `--from`, for rows of a sweep of shared "
     "piles"},
    {"repeat", "", RP_INT, IN(repeat), "auto", "[1, 1000000000] | auto", "passes of a block"},
    {0}};

static rp_status read_fails(const config_setting_t *group, exp_place *place, exp_phase *p)
{
    if (!config_setting_is_group(group))
        return rp_config_fail(group, "fail: a group { word = \"condition\"; } expected");
    RP_NEW(&place->plan->arena, p->fails, length(group));
    for (size_t i = 0; i < length(group); i++) {
        exp_fail *f = &p->fails[i];
        f->word = config_setting_name(element(group, i));
        if (!exp_is_word(f->word) || strncmp(f->word, "ok", 2) == 0)
            return rp_config_fail(element(group, i),
                                  "fail: %s: a word of up to 23 letters expected, not one of a good run",
                                  f->word);
        RP_TRY(exp_expression_read(element(group, i), f->word, RP_X_TRUTH, place, &f->when));
        if (config_setting_type(element(group, i)) == CONFIG_TYPE_BOOL)
            return rp_config_fail(element(group, i), "%s = %s never changes", f->word, f->when.x.text);
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
    size_t wall = 0;
    p->opens = -1;
    if (!*p->open) return RP_OK;
    RP_TRY(exp_find_wall(plan, member(setting, "open"), "open", p->open, &wall));
    p->opens = (long)wall;
    return RP_OK;
}

/* A load along one direction, or "none". */
static rp_status read_load(const config_setting_t *setting, const char *key, exp_place *place,
                           exp_loading *is, exp_expression *load)
{
    const config_setting_t *value = member(setting, key);
    const char *word = value ? config_setting_get_string(value) : NULL;
    if (!value) return RP_OK;
    *is = word && strcmp(word, "none") == 0 ? EXP_FREED : EXP_LOADED;
    return *is == EXP_FREED ? RP_OK : exp_expression_read(value, key, RP_X_NUMBER, place, load);
}

static const char *const move_keys[] = {"velocity", "omega", "load_x", "load_y", "speed", NULL};

static rp_status read_move(const config_setting_t *setting, exp_place *place, exp_phase *p, exp_move *m)
{
    exp_plan *plan = place->plan;
    const char *name = config_setting_name(setting);
    bool coefficients = false;
    RP_TRY(exp_find_wall(plan, setting, NULL, name, &m->wall));
    if (!config_setting_is_group(setting))
        return rp_config_fail(setting, "%s: a group { ... } expected", name);
    for (size_t k = 0; k < plan->walls[m->wall].n; k++)
        RP_TRY(dem_text_coefficients(setting, move_keys, &coefficients,
                                     &p->given[plan->walls[m->wall].walls[k]]));
    p->has_laws |= coefficients;
    m->has_velocity = member(setting, "velocity") != NULL;
    m->has_omega = member(setting, "omega") != NULL;
    if (length(setting) == 0)
        return rp_config_fail(setting, "%s: velocity, omega, load_x, load_y or coefficients expected", name);
    if (m->has_velocity)
        RP_TRY(exp_read_list(member(setting, "velocity"), "velocity", 2, place, m->velocity));
    if (m->has_omega)
        RP_TRY(exp_expression_read(member(setting, "omega"), "omega", RP_X_NUMBER, place, &m->omega));
    RP_TRY(read_load(setting, "load_x", place, &m->loading[0], &m->load[0]));
    RP_TRY(read_load(setting, "load_y", place, &m->loading[1], &m->load[1]));
    const bool loaded = m->loading[0] == EXP_LOADED || m->loading[1] == EXP_LOADED;
    const config_setting_t *speed = member(setting, "speed");
    if (loaded && !speed)
        return rp_config_fail(setting, "%s: load_%c needs speed", name,
                              m->loading[0] == EXP_LOADED ? 'x' : 'y');
    if (speed && !loaded) return rp_config_fail(speed, "speed: needs load_x or load_y");
    if (speed) RP_TRY(exp_expression_read(speed, "speed", RP_X_NUMBER, place, &m->speed));
    if (m->speed.x.known && !(m->speed.x.value > 0.0 && isfinite(m->speed.x.value)))
        return rp_config_fail(speed, "speed = %g: out of range, allowed: (0, inf)", m->speed.x.value);
    m->each_step = exp_changes(&m->velocity[0]) || exp_changes(&m->velocity[1]) || exp_changes(&m->omega);
    p->each_step |= m->each_step;
    if (loaded) m->number = plan->n_loads, plan->loads[plan->n_loads++] = m;
    return RP_OK;
}

/* walls = { NAME = { velocity = (vx, vy); omega = ...; load_y = ...; mu = ...; }; }. */
static rp_status read_moves(const config_setting_t *group, exp_place *place, exp_phase *p)
{
    if (!config_setting_is_group(group))
        return rp_config_fail(group, "walls: a group { NAME = { ... }; } expected");
    RP_NEW(&place->plan->arena, p->moves, length(group));
    for (size_t i = 0; i < length(group); i++, p->n_moves++)
        RP_TRY(read_move(element(group, i), place, p, &p->moves[i]));
    return RP_OK;
}

/* add = { N; kind; r, or radii as of a fill; density; x; y; vx; vy; omega; gap; }. */
static rp_status read_add(const config_setting_t *group, exp_place *place, exp_add *a)
{
    static const char *const keys[] = {"N",  "kind", "r",     "density", "x",     "y",
                                       "vx", "vy",   "omega", "gap",     "radii", NULL};
    exp_plan *plan = place->plan;
    const config_setting_t *x = member(group, "x"), *y = member(group, "y");
    const struct {
        const char *key;
        exp_expression *e;
        double fallback, least, above;
        const char *range;
    } numbers[] = {{"N", &a->n, 1.0, 0.0, INFINITY, "[0, inf)"},
                   {"r", &a->r, NAN, 0.0, 0.0, "(0, inf)"},
                   {"density", &a->density, NAN, 0.0, 0.0, "(0, inf)"},
                   {"vx", &a->vx, 0.0, -INFINITY, INFINITY, "(-inf, inf)"},
                   {"vy", &a->vy, 0.0, -INFINITY, INFINITY, "(-inf, inf)"},
                   {"omega", &a->omega, 0.0, -INFINITY, INFINITY, "(-inf, inf)"},
                   {"gap", &a->gap, 1e-6 * plan->d, 0.0, INFINITY, "[0, inf)"}};
    if (!config_setting_is_group(group)) return rp_config_fail(group, "add: a group { ... } expected");
    if (!x || !y) return rp_config_fail(group, "add: %s: missing", x ? "y" : "x");
    a->on = plan->adds = true, a->kind = -1;
    a->has_r = member(group, "r"), a->has_density = member(group, "density");
    const char *kind = NULL;
    if (member(group, "kind") && !(kind = config_setting_get_string(member(group, "kind"))))
        return rp_config_fail(member(group, "kind"), "kind: a name expected");
    for (size_t k = 0; kind && k < plan->n_kinds; k++)
        if (strcmp(plan->kinds[k], kind) == 0) a->kind = (long)k;
    place->of_grain = true;
    for (size_t k = 0; k < sizeof numbers / sizeof *numbers; k++) {
        const config_setting_t *value = member(group, numbers[k].key);
        if (value)
            RP_TRY(exp_expression_read(value, numbers[k].key, RP_X_NUMBER, place, numbers[k].e));
        else
            numbers[k].e->x = (rp_expression){.known = true, .value = numbers[k].fallback};
        const double v = numbers[k].e->x.known ? numbers[k].e->x.value : NAN;
        if (value && (v < numbers[k].least || v == numbers[k].above || isinf(v)))
            return rp_config_fail(value, "add.%s = %g: out of range, allowed: %s", numbers[k].key, v,
                                  numbers[k].range);
    }
    const bool x_range = !config_setting_is_scalar(x);
    a->in_range = !config_setting_is_scalar(y);
    RP_TRY(x_range ? exp_read_list(x, "x", 2, place, a->x)
                   : exp_expression_read(x, "x", RP_X_NUMBER, place, &a->x[0]));
    if (!x_range) a->x[1] = a->x[0];
    RP_TRY(a->in_range ? exp_read_list(y, "y", 2, place, a->y)
                       : exp_expression_read(y, "y", RP_X_NUMBER, place, &a->y[0]));
    place->of_grain = false;
    RP_TRY(dem_text_radii(&plan->arena, group, keys, dem_scene_fill_at(&plan->scene, 0), &a->radii));
    return a->has_r && member(group, "radius_mean")
               ? rp_config_fail(group, "add: r and radius_mean; keep one")
               : RP_OK;
}

static bool changes_laws(const config_setting_t *setting)
{
    static const char *const keys[] = {"dt", "x_min", "x_max", "y_min", "normal", "tangential", "rolling"};
    bool some = false;
    for (size_t k = 0; k < sizeof keys / sizeof *keys; k++) some |= member(setting, keys[k]) != NULL;
    return some;
}

/* The laws of a phase follow from those of the one before it in the text, or that it goes back to. */
static rp_status read_laws(exp_plan *plan, exp_phase *p)
{
    dem_definition def;
    dem_wall *walls;
    if (!(p->has_laws |= changes_laws(p->setting))) return RP_OK;
    RP_NEW(&plan->arena, walls, plan->scene.def.n_walls);
    RP_TRY(dem_text_laws(p->setting, &plan->scene, &p->laws));
    rp_status status = dem_laws_apply(&p->laws, p->given, &plan->scene, &def, walls);
    if (!status) status = dem_physics_check(&def);
    return status ? rp_config_fail(p->setting, "phase %s: %s", p->name, rp_message()) : RP_OK;
}

static rp_status begin_laws(exp_plan *plan, size_t k, exp_phase *p)
{
    const size_t n = plan->scene.def.n_walls, before = p->source != SIZE_MAX ? p->source : k - 1;
    RP_NEW(&plan->arena, p->given, n);
    if (p->source == SIZE_MAX && k == 0) {
        p->laws = plan->scene.laws;
        if (n) memcpy(p->given, plan->scene.given, n * sizeof *p->given);
    } else {
        p->laws = plan->phases[before].laws;
        if (n) memcpy(p->given, plan->phases[before].given, n * sizeof *p->given);
    }
    return RP_OK;
}

static rp_status read_from(exp_plan *plan, size_t k, exp_phase *p)
{
    const config_setting_t *from = member(p->setting, "from"), *remove = member(p->setting, "remove");
    p->source = SIZE_MAX;
    if (*p->from) {
        RP_TRY(exp_find_phase(plan, from, "from", p->from, &p->source));
        exp_phase *source = &plan->phases[p->source];
        if (p->source >= k || source->left_out || (p->block != SIZE_MAX && p->source == p->block))
            return rp_config_fail(from, "from = \"%s\": an earlier phase that is not left out expected",
                                  p->from);
        if (source->n_inner) { /* the end of a block is that of its last phase */
            size_t last = p->source + source->n_inner;
            while (plan->phases[last].left_out) last--;
            p->source = last, source = &plan->phases[last];
        }
        source->is_source = true;
    }
    rp_guess guess = rp_guess_of(p->remove);
    for (size_t r = 0; r < plan->n_regions && *p->remove; r++) {
        rp_guess_try(&guess, plan->regions[r].name);
        if (strcmp(plan->regions[r].name, p->remove) == 0) p->removes = (exp_scope){EXP_REGION, r};
    }
    return !*p->remove || p->removes.kind == EXP_REGION
               ? RP_OK
               : rp_config_fail(remove, "remove = \"%s\": no such region%s", p->remove,
                                rp_guess_text(&guess));
}

/* The head of a phase: its own keys, and whether it is left out. */
static rp_status name_phase(exp_plan *plan, const config_setting_t *setting, size_t block, bool has_inner)
{
    /* clang-format off */
    static const char *const others[] = {"if", "steps", "time", "until", "fail", "walls", "gravity",
                                         "gravity_turn_deg_per_step", "box_turn_deg_per_step", "add",
                                         "dt", "x_min", "x_max", "y_min", "normal", "tangential", "rolling", NULL};
    /* clang-format on */
    static const char *const of_block[] = {"if", "until", "phases", NULL};
    exp_phase *p = &plan->phases[plan->n_phases];
    const config_setting_t *when = member(setting, "if");
    exp_place place;
    exp_place_in(&place, plan);
    place.lets_alone = true;
    *p = (exp_phase){.setting = setting, .block = block, .ending = EXP_UNTIL};
    rp_params_defaults(exp_phase_schema, p);
    RP_TRY(rp_config_group(setting, exp_phase_schema, p, has_inner ? of_block : others));
    if (block != SIZE_MAX && !member(setting, "mark")) p->mark = false;
    if (!exp_is_word(p->name))
        return rp_config_fail(setting, "name = \"%s\": up to 23 letters, digits and _ expected", p->name);
    for (size_t k = 0; k < plan->n_phases; k++)
        if (strcmp(plan->phases[k].name, p->name) == 0)
            return rp_config_fail(setting, "name = \"%s\": names two phases", p->name);
    for (const char *const *key =
             (const char *const[]){"least", "every", "most", "open", "mark", "damp", "remove", "keep", NULL};
         has_inner && *key; key++)
        if (member(setting, *key))
            return rp_config_fail(member(setting, *key), "%s: of a block's phases, not of the block", *key);
    if (!has_inner && p->repeat >= 0)
        return rp_config_fail(member(setting, "repeat"), "repeat: needs phases = ( ... ), a block");
    if (*p->status && !exp_is_word(p->status))
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

rp_status exp_read_phase(exp_plan *plan, size_t k)
{
    static const char *const turns[] = {"gravity_turn_deg_per_step", "box_turn_deg_per_step"};
    exp_phase *p = &plan->phases[k];
    const config_setting_t *fail = member(p->setting, "fail"), *gravity = member(p->setting, "gravity");
    exp_place place;
    exp_place_in(&place, plan);
    place.phase = p->n_inner ? k + p->n_inner + 1 : k; /* a block's until knows what its phases measure */
    p->states[0] = plan->n_states;
    RP_TRY(read_from(plan, k, p));
    RP_TRY(begin_laws(plan, k, p));
    RP_TRY(read_end(p->setting, &place, p));
    /* a number of passes that is given is a good end */
    if (p->n_inner && p->repeat >= 0 && !*p->status) p->go_on = true;
    if (p->repeat < 0) p->repeat = p->n_inner ? 1000000 : 1;
    if (fail) RP_TRY(read_fails(fail, &place, p));
    if (member(p->setting, "walls")) RP_TRY(read_moves(member(p->setting, "walls"), &place, p));
    if (member(p->setting, "add")) RP_TRY(read_add(member(p->setting, "add"), &place, &p->add));
    RP_TRY(read_laws(plan, p));
    if (gravity) {
        p->has_gravity = true;
        RP_TRY(exp_read_list(gravity, "gravity", 2, &place, p->gravity));
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

/* Of phases, or with a key of what they have under it. */
static size_t count(const config_setting_t *list, const char *key)
{
    size_t n = key ? 0 : length(list);
    for (size_t i = 0; i < length(list); i++) {
        const config_setting_t *phase = element(list, i);
        if (!config_setting_is_group(phase)) continue;
        n += key ? length(member(phase, key)) : 0;
        if (member(phase, "phases")) n += count(member(phase, "phases"), key);
    }
    return n;
}

/* Kinds of the fills, then of what phases add. */
static rp_status name_kind(exp_plan *plan, const config_setting_t *setting, const char *kind)
{
    for (size_t k = 0; k < plan->n_kinds; k++)
        if (strcmp(plan->kinds[k], kind) == 0) return RP_OK;
    RP_TRY(exp_check_name(plan, setting, "a kind", kind));
    plan->kinds[plan->n_kinds++] = kind;
    return RP_OK;
}

static rp_status name_added(exp_plan *plan, const config_setting_t *list)
{
    for (size_t i = 0; i < length(list); i++) {
        const config_setting_t *phase = element(list, i);
        if (!config_setting_is_group(phase)) continue;
        const config_setting_t *add = member(phase, "add"),
                               *kind = add && config_setting_is_group(add) ? member(add, "kind") : NULL;
        if (kind && config_setting_get_string(kind))
            RP_TRY(name_kind(plan, kind, config_setting_get_string(kind)));
        if (member(phase, "phases")) RP_TRY(name_added(plan, member(phase, "phases")));
    }
    return RP_OK;
}

rp_status exp_name_kinds(exp_plan *plan)
{
    const config_setting_t *list = config_lookup(&plan->text->config, "phases"),
                           *fill = config_lookup(&plan->text->config, "fill");
    RP_NEW(&plan->arena, plan->kinds, count(list, NULL) + plan->scene.n_more + 1);
    for (size_t k = 0; dem_scene_fill_at(&plan->scene, k); k++)
        if (*dem_scene_fill_at(&plan->scene, k)->kind)
            RP_TRY(name_kind(plan, fill, dem_scene_fill_at(&plan->scene, k)->kind));
    return name_added(plan, list);
}

rp_status exp_name_phases(exp_plan *plan)
{
    const config_setting_t *list = config_lookup(&plan->text->config, "phases");
    RP_NEW(&plan->arena, plan->phases, count(list, NULL));
    RP_NEW(&plan->arena, plan->loads, count(list, "walls"));
    return name_phases(plan, list, SIZE_MAX);
}
