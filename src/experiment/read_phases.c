/* Phases of a text: their names, then what they do and how they end. */
#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "dem/setup/definition.h"
#include "experiment/reading.h"
#include "params/config.h"
#include "table/columns.h"

#define IN(field) offsetof(exp_phase, field)
const rp_param exp_phase_schema[] = {
    {"name", "", RP_TEXT, IN(name), NULL, "", "of the phase"},
    {"least", "steps", RP_INT, IN(least), "0", "[0, 2147483647]",
     "before looks begin, and with them samples"},
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
    {"repeat", "", RP_INT, IN(repeat), "auto", "[1, 1000000000] | auto", "passes of a block"},
    {0}};

/* Is it a word that a sweep gives to runs that it makes again? */
static rp_status check_status(const config_setting_t *setting, const char *word)
{
    char quoted[32];
    snprintf(quoted, sizeof quoted, "'%s'", word);
    return strstr(RP_MACHINE_STATUS, quoted)
               ? rp_config_fail(setting, "%s: a word of the sweeps' own, %s; give another", word,
                                RP_MACHINE_STATUS)
               : RP_OK;
}

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
        RP_TRY(check_status(element(group, i), f->word));
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
    const exp_key_of keys[] = {{ends[p->ending].key, &p->end, .type = ends[p->ending].type,
                                .range = p->ending == EXP_UNTIL ? NULL : "[0, 1e15)",
                                .whole = p->ending == EXP_STEPS},
                               {0}};
    RP_TRY(exp_read_keys(setting, "", keys, place));
    if (end && p->ending == EXP_UNTIL && p->end.x.known)
        return rp_config_fail(end, "until \"%s\" never changes", p->end.x.text);
    return RP_OK;
}

/* A load along one direction, or "none". */
static exp_loading loading_of(const config_setting_t *wall, const char *key)
{
    const config_setting_t *value = member(wall, key);
    const char *word = value ? config_setting_get_string(value) : NULL;
    return !value ? EXP_SAME : word && strcmp(word, "none") == 0 ? EXP_FREED : EXP_LOADED;
}

static rp_status read_move(const config_setting_t *setting, exp_place *place, exp_phase *p, exp_move *m)
{
    exp_plan *plan = place->plan;
    const char *name = config_setting_name(setting);
    bool coefficients = false;
    m->setting = setting;
    RP_TRY(exp_find(plan, EXP_WALL, setting, NULL, name, &m->wall));
    if (!config_setting_is_group(setting))
        return rp_config_fail(setting, "%s: a group { ... } expected", name);
    for (size_t k = 0; k < plan->walls[m->wall].n; k++)
        RP_TRY(dem_text_coefficients(setting, "velocity omega load_x load_y speed", &coefficients,
                                     &p->given[plan->walls[m->wall].walls[k]]));
    p->has_laws |= coefficients;
    if (length(setting) == 0)
        return rp_config_fail(setting, "%s: velocity, omega, load_x, load_y or coefficients expected", name);
    m->loading[0] = loading_of(setting, "load_x"), m->loading[1] = loading_of(setting, "load_y");
    const exp_key_of keys[] = {{"velocity", m->velocity, .n = 2},
                               {"omega", &m->omega},
                               {"load_x", m->loading[0] == EXP_LOADED ? &m->load[0] : NULL},
                               {"load_y", m->loading[1] == EXP_LOADED ? &m->load[1] : NULL},
                               {"speed", &m->speed, .range = "(0, inf)"},
                               {0}};
    RP_TRY(exp_read_keys(setting, "", keys, place));
    const bool loaded = m->loading[0] == EXP_LOADED || m->loading[1] == EXP_LOADED;
    if (loaded && !exp_given(&m->speed))
        return rp_config_fail(setting, "%s: load_%c needs speed", name,
                              m->loading[0] == EXP_LOADED ? 'x' : 'y');
    if (!loaded && exp_given(&m->speed))
        return rp_config_fail(member(setting, "speed"), "speed: needs load_x or load_y");
    if (loaded && plan->scene.def.hard.on)
        return rp_config_fail(setting, "%s: a load: hard collisions do not push walls", name);
    m->each_step = exp_asks(plan, &m->velocity[0], NULL) || exp_asks(plan, &m->velocity[1], NULL) ||
                   exp_asks(plan, &m->omega, NULL);
    p->each_step |= m->each_step;
    if (loaded) m->number = plan->n_loads, plan->loads[plan->n_loads++] = m;
    return RP_OK;
}

/* add = { N; kind; r, or radii as of a fill; density; x; y; vx; vy; omega; gap; }. */
static rp_status read_add(const config_setting_t *group, exp_place *place, exp_add *a)
{
    static const char others[] = "N kind r density x y vx vy omega gap radii";
    exp_plan *plan = place->plan;
    const config_setting_t *x = member(group, "x"), *y = member(group, "y");
    const double fallbacks[] = {1.0, NAN, NAN, 0.0, 0.0, 0.0, 1e-6 * plan->d};
    if (!config_setting_is_group(group)) return rp_config_fail(group, "add: a group { ... } expected");
    if (!x || !y) return rp_config_fail(group, "add: %s: missing", x ? "y" : "x");
    const bool x_range = !config_setting_is_scalar(x), y_range = !config_setting_is_scalar(y);
    const exp_key_of keys[] = {{"N", &a->n, .range = "[0, inf)", .whole = true},
                               {"r", &a->r, .range = "(0, inf)"},
                               {"density", &a->density, .range = "(0, inf)"},
                               {"vx", &a->vx, .range = "(-inf, inf)"},
                               {"vy", &a->vy, .range = "(-inf, inf)"},
                               {"omega", &a->omega, .range = "(-inf, inf)"},
                               {"gap", &a->gap, .range = "[0, inf)"},
                               {"x", a->x, .n = x_range ? 2 : 0},
                               {"y", a->y, .n = y_range ? 2 : 0},
                               {0}};
    a->on = plan->adds = true, a->in_range = y_range;
    RP_TRY(dem_read_kind(group, &plan->scene, &a->kind));
    place->of_grain = true;
    RP_TRY(exp_read_keys(group, "add.", keys, place));
    place->of_grain = false;
    for (size_t k = 0; k < sizeof fallbacks / sizeof *fallbacks; k++)
        if (!exp_given(keys[k].e)) keys[k].e->x = (rp_expression){.known = true, .value = fallbacks[k]};
    if (!x_range) a->x[1] = a->x[0];
    RP_TRY(dem_text_radii(&plan->arena, group, others, plan->scene.fills, &a->radii));
    return exp_given(&a->r) && member(group, "radius_mean")
               ? rp_config_fail(group, "add: r and radius_mean; keep one")
               : RP_OK;
}

/* Keys of a phase that are read by hand, laws first. */
#define LAW_KEYS "dt x_min x_max y_min normal tangential rolling kinds pairs"
const char exp_phase_keys[] = LAW_KEYS " if steps time until fail walls gravity add "
                                       "gravity_turn_deg_per_step box_turn_deg_per_step";

/* The laws of a phase follow from those of the one before it in the text, or that it goes back to. */
static rp_status read_laws(exp_plan *plan, exp_phase *p)
{
    dem_wall *walls;
    p->has_laws |= exp_has_key(p->setting, LAW_KEYS) != NULL;
    if (!p->has_laws) return RP_OK;
    RP_NEW(&plan->arena, walls, plan->scene.def.n_walls);
    RP_TRY(dem_text_laws(p->setting, &plan->scene, &p->laws));
    rp_status status = dem_laws_apply(&p->laws, p->given, &plan->scene, &p->def, walls);
    if (!status) status = dem_physics_check(&p->def);
    return status ? rp_config_fail(p->setting, "phase %s: %s", p->name, rp_message()) : RP_OK;
}

static rp_status begin_laws(exp_plan *plan, size_t k, exp_phase *p)
{
    const size_t n = plan->scene.def.n_walls;
    const exp_phase *before = p->source != SIZE_MAX ? &plan->phases[p->source] : k ? p - 1 : NULL;
    RP_NEW(&plan->arena, p->given, n);
    p->laws = before ? before->laws : plan->scene.laws;
    if (n) memcpy(p->given, before ? before->given : plan->scene.given, n * sizeof *p->given);
    return RP_OK;
}

static rp_status read_from(exp_plan *plan, size_t k, exp_phase *p)
{
    const config_setting_t *from = member(p->setting, "from");
    p->source = SIZE_MAX;
    if (*p->from) {
        RP_TRY(exp_find(plan, EXP_PHASE, p->setting, "from", p->from, &p->source));
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
    if (*p->remove) p->removes.sort = EXP_REGION;
    return exp_find(plan, EXP_REGION, p->setting, "remove", p->remove, &p->removes.index);
}

/* What a block may say; all else is of its phases. */
static const char of_block[] = "name if until phases repeat from go_on status";

static rp_status check_block(const config_setting_t *block)
{
    for (size_t i = 0; i < length(block); i++) {
        const char *key = config_setting_name(element(block, i));
        if (rp_word_index(of_block, key) < 0)
            return rp_config_fail(element(block, i), "%s: of a block's phases, not of the block", key);
    }
    return RP_OK;
}

/* The head of a phase: its own keys, and whether it is left out. */
static rp_status name_phase(exp_plan *plan, const config_setting_t *setting, size_t block, bool has_inner)
{
    exp_phase *p = &plan->phases[plan->n_phases];
    *p = (exp_phase){.setting = setting, .block = block, .ending = EXP_UNTIL};
    rp_params_defaults(exp_phase_schema, plan->scene.def.units, p);
    RP_TRY(rp_config_group(setting, exp_phase_schema, p, has_inner ? "if until phases" : exp_phase_keys));
    if (block != SIZE_MAX && !member(setting, "mark")) p->mark = false;
    if (!exp_is_word(p->name))
        return rp_config_fail(setting, "name = \"%s\": up to 23 letters, digits and _ expected", p->name);
    if (rp_word_index("last all auto", p->name) >= 0)
        return rp_config_fail(setting, "name = \"%s\": `repose view --frame %s` means other frames", p->name,
                              p->name);
    if (exp_scope_named(plan, EXP_PHASE, p->name, strlen(p->name), NULL))
        return rp_config_fail(setting, "name = \"%s\": names two phases", p->name);
    if (has_inner) RP_TRY(check_block(setting));
    if (!has_inner && p->repeat >= 0)
        return rp_config_fail(member(setting, "repeat"), "repeat: needs phases = ( ... ), a block");
    if (*p->status && !exp_is_word(p->status))
        return rp_config_fail(member(setting, "status"),
                              "status = \"%s\": up to 23 letters, digits and _ expected", p->status);
    if (*p->status) RP_TRY(check_status(member(setting, "status"), p->status));
    RP_TRY(exp_read_if(plan, setting, &p->left_out));
    plan->n_loads += length(member(setting, "walls"));
    return exp_add_scope(plan, EXP_PHASE, plan->n_phases++, p->name), RP_OK;
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

static bool is_zero(const exp_expression *e)
{
    return !exp_given(e) || (e->x.known && e->x.value == 0.0);
}

enum { SHIFTS = 1, SWINGS = 2, LOADED = 4 }; /* the last of x, and twice that of y */

/* In a box that turns, or has turned, walls stand, and laws and grains stay. Phases are taken in the order of
 * the text; what a run alone knows ends it. */
static rp_status check_turned(exp_plan *plan, size_t k)
{
    exp_phase *p = &plan->phases[k];
    const exp_phase *before = p->source != SIZE_MAX ? &plan->phases[p->source] : k ? p - 1 : NULL;
    const bool turned = before ? before->turned : plan->scene.def.box_turn_per_step != 0.0;
    RP_NEW(&plan->arena, p->moving, plan->n_walls);
    for (size_t w = 0; w < plan->n_walls; w++) {
        const dem_wall *wall = &dem_walls_of(&plan->scene.def)[*plan->walls[w].walls];
        p->moving[w] = before ? before->moving[w] : dem_wall_moves(wall) ? SHIFTS : 0;
    }
    p->turned = turned || (!p->left_out && !is_zero(&p->turn[1]));
    for (size_t i = 0; i < p->n_moves && !p->left_out; i++) {
        const exp_move *m = &p->moves[i];
        unsigned *moving = &p->moving[m->wall];
        const bool shifts = !is_zero(&m->velocity[0]) || !is_zero(&m->velocity[1]);
        if (exp_given(&m->velocity[0])) *moving = (*moving & ~SHIFTS) | (shifts ? SHIFTS : 0);
        if (exp_given(&m->omega)) *moving = (*moving & ~SWINGS) | (is_zero(&m->omega) ? 0 : SWINGS);
        for (unsigned c = 0; c < 2; c++) {
            if (m->loading[c] != EXP_SAME)
                *moving = (*moving & ~(LOADED << c)) | (m->loading[c] == EXP_LOADED ? LOADED << c : 0);
            if ((*moving & LOADED << c) && !is_zero(&m->velocity[c]))
                return rp_config_fail(
                    m->setting, "%s: velocity along %c, where a load moves it; load_%c = \"none\" ends that",
                    plan->walls[m->wall].name, "xy"[c], "xy"[c]);
        }
    }
    for (size_t w = 0; w < plan->n_walls; w++)
        if (p->turned && p->moving[w])
            return rp_config_fail(p->setting, "phase %s: wall %s moves, not in a box that turns", p->name,
                                  plan->walls[w].name);
    return turned && !p->left_out && (p->has_laws || *p->remove)
               ? rp_config_fail(p->setting, "phase %s: laws, dt and grains stay in a box that turns", p->name)
               : RP_OK;
}

rp_status exp_read_phase(exp_plan *plan, size_t k)
{
    exp_phase *p = &plan->phases[k];
    const config_setting_t *fail = member(p->setting, "fail"), *walls = member(p->setting, "walls");
    const exp_key_of keys[] = {{"gravity", p->gravity, .n = 2},
                               {"gravity_turn_deg_per_step", &p->turn[0], .range = "[-10, 10]"},
                               {"box_turn_deg_per_step", &p->turn[1], .range = "[-10, 10]"},
                               {0}};
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
    /* walls = { NAME = { velocity = (vx, vy); omega = ...; load_y = ...; mu = ...; }; } */
    if (walls && !config_setting_is_group(walls))
        return rp_config_fail(walls, "walls: a group { NAME = { ... }; } expected");
    RP_NEW(&plan->arena, p->moves, length(walls));
    for (; p->n_moves < length(walls); p->n_moves++)
        RP_TRY(read_move(element(walls, p->n_moves), &place, p, &p->moves[p->n_moves]));
    if (member(p->setting, "add")) RP_TRY(read_add(member(p->setting, "add"), &place, &p->add));
    RP_TRY(read_laws(plan, p));
    RP_TRY(exp_read_keys(p->setting, "", keys, &place));
    p->gravity_each_step = exp_asks(plan, &p->gravity[0], NULL) || exp_asks(plan, &p->gravity[1], NULL);
    p->each_step |= p->gravity_each_step;
    p->states[1] = plan->n_states;
    if (!*p->status && !p->go_on && p->ending == EXP_UNTIL) {
        p->status =
            exp_asks(plan, &p->end, "rest") ? "not_at_rest" : rp_text(&plan->arena, "most_%.17s", p->name);
        if (!p->status) return RP_NO_MEMORY;
    }
    size_t wall = 0;
    RP_TRY(exp_find(plan, EXP_WALL, p->setting, "open", p->open, &wall));
    p->opens = *p->open ? (long)wall : -1;
    for (size_t i = 0; *p->open && i < plan->walls[wall].n; i++) {
        const size_t number = plan->walls[wall].walls[i];
        dem_wall opens = dem_walls_of(&plan->scene.def)[number];
        opens.open_at_step = 0;
        if (plan->scene.def.ground.wall == (long)number + 1)
            return rp_config_fail(member(p->setting, "open"), "open = \"%s\": the ground can't open",
                                  p->open);
        if (dem_wall_check(&opens))
            return rp_config_fail(member(p->setting, "open"), "open = \"%s\": %s", p->open, rp_message());
    }
    return check_turned(plan, k);
}

size_t exp_count_phases(const config_setting_t *list)
{
    size_t n = 0;
    for (size_t i = 0; i < length(list); i++) n += 1 + length(member(element(list, i), "phases"));
    return n;
}

rp_status exp_name_phases(exp_plan *plan)
{
    const config_setting_t *list = config_lookup(&plan->text->config, "phases");
    const dem_kind *kinds = plan->scene.def.kinds;
    for (size_t k = 1; k < plan->scene.def.n_kinds; k++) {
        RP_TRY(exp_check_name(plan, list, "a kind", kinds[k].name));
        exp_add_scope(plan, EXP_KIND, k, kinds[k].name);
    }
    RP_TRY(exp_check_count(list, exp_count_phases(list)));
    RP_NEW(&plan->arena, plan->phases, exp_count_phases(list));
    RP_TRY(name_phases(plan, list, SIZE_MAX));
    RP_NEW(&plan->arena, plan->loads, plan->n_loads);
    plan->n_loads = 0; /* known so far */
    return RP_OK;
}
