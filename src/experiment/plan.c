/* A text becomes a plan: names first, then phases, then measures; everything is checked here. */
#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "experiment/looks.h"
#include "experiment/reading.h"
#include "params/config.h"

bool exp_has_phases(const dem_text *text)
{
    return config_lookup(&text->config, "phases") != NULL;
}

static rp_status read_walls(exp_plan *plan)
{
    const dem_scene *s = &plan->scene;
    const config_setting_t *list = config_lookup(&plan->text->config, "walls");
    RP_NEW(&plan->arena, plan->walls, s->def.n_walls);
    for (size_t w = 0; w < s->def.n_walls; w++) {
        size_t k = 0;
        if (!*s->names[w]) continue;
        while (k < plan->n_walls && strcmp(plan->walls[k].name, s->names[w]) != 0) k++;
        exp_wall *wall = &plan->walls[k];
        if (k == plan->n_walls) {
            RP_TRY(exp_check_name(plan, list, "a wall", s->names[w]));
            exp_add_scope(plan, EXP_WALL, k, s->names[w]);
            wall->name = s->names[w];
            RP_NEW(&plan->arena, wall->walls, s->def.n_walls);
            plan->n_walls++;
        }
        wall->walls[wall->n++] = w;
    }
    return RP_OK;
}

/* A region whose numbers are all known. */
static rp_status check_known(const config_setting_t *setting, rp_arena *arena, const exp_region *r)
{
    exp_within in = {.circle = r->circle, .n_points = r->n_points};
    double *points;
    bool known = true;
    RP_NEW(arena, points, 2 * r->n_points);
    in.points = points;
    for (int k = 0; k < 4; k++) known &= r->at[k].x.known, in.at[k] = r->at[k].x.value;
    for (size_t k = 0; k < 2 * r->n_points; k++)
        known &= r->points[k].x.known, points[k] = r->points[k].x.value;
    const char *fault = known ? exp_region_fault(&in) : NULL;
    return fault ? rp_config_fail(setting, "%s: %s", r->name, fault) : RP_OK;
}

static rp_status read_region(const config_setting_t *setting, exp_place *place, exp_region *r)
{
    const config_setting_t *x = member(setting, "x"), *y = member(setting, "y"),
                           *circle = member(setting, "circle"), *polygon = member(setting, "polygon");
    *r = (exp_region){.name = config_setting_name(setting), .circle = circle != NULL};
    RP_TRY(rp_config_group(setting, exp_no_keys, NULL, "x y circle polygon"));
    if ((x || y) + (circle != NULL) + (polygon != NULL) != 1)
        return rp_config_fail(setting, "%s: x, y or both, or circle, or polygon expected", r->name);
    for (int k = 0; k < 4; k++)
        r->at[k].x = (rp_expression){.known = true, .value = k % 2 ? INFINITY : -INFINITY};
    if (circle) RP_TRY(exp_read_list(circle, "circle", 3, place, r->at));
    if (polygon && (!config_setting_is_list(polygon) || length(polygon) < 3))
        return rp_config_fail(polygon, "polygon: a list ( (x, y), ... ) of at least 3 points expected");
    r->n_points = length(polygon);
    RP_NEW(&place->plan->arena, r->points, 2 * r->n_points);
    for (size_t k = 0; k < r->n_points; k++)
        RP_TRY(exp_read_list(element(polygon, k), "polygon", 2, place, &r->points[2 * k]));
    if (x) RP_TRY(exp_read_list(x, "x", 2, place, r->at));
    if (y) RP_TRY(exp_read_list(y, "y", 2, place, r->at + 2));
    for (size_t k = 0; k < 4 + 2 * r->n_points; k++) { /* each measure of the region would count as a look */
        const exp_expression *e = k < 4 ? &r->at[k] : &r->points[k - 4];
        if (e->x.n_states > 0 || exp_asks(place->plan, e, "rest"))
            return rp_config_fail(setting, "%s: held and rest count looks; not in a region", r->name);
    }
    for (int k = 0; k < 2 && !circle; k++) {
        const rp_expression *from = &r->at[2 * k].x, *to = &r->at[2 * k + 1].x;
        if (from->known && to->known && !(from->value < to->value))
            return rp_config_fail(setting, "%s: %s = (%g, %g): from the lower end to the upper", r->name,
                                  k ? "y" : "x", from->value, to->value);
    }
    return check_known(setting, &place->plan->arena, r);
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
        RP_TRY(exp_check_name(plan, element(group, i), "a region", config_setting_name(element(group, i))));
        RP_TRY(read_region(element(group, i), &place, &plan->regions[i]));
        exp_add_scope(plan, EXP_REGION, plan->n_regions++, plan->regions[i].name);
    }
    return RP_OK;
}

#define REST(field)   offsetof(exp_plan, rest.field)
#define TEXT(number)  TEXT_(number)
#define TEXT_(number) #number
static const rp_param rest_schema[] = {
    {"energy", "m g d", RP_REAL, REST(energy), TEXT(DEM_REST_ENERGY), "(0, inf)",
     "largest mean kinetic energy of a grain"},
    {"force", "m g", RP_REAL, REST(force), TEXT(DEM_REST_FORCE), "(0, inf)",
     "largest net force on a grain with a contact"},
    {"looks", "", RP_INT, REST(looks), TEXT(DEM_REST_LOOKS), "[1, 1000000]", "in a row that find both"},
    {"every", "steps", RP_INT, REST(every), TEXT(DEM_REST_STEPS), "[1, 1000000000]",
     "least distance of two looks"},
    {0}};

/* A word, or an expression of one. */
static rp_status read_result(exp_plan *plan)
{
    const config_setting_t *setting = config_lookup(&plan->text->config, "result");
    const char *text = setting ? config_setting_get_string(setting) : "ok";
    rp_x_symbol is = {0};
    if (text && !exp_is_word(text)) {
        if (rp_lets_value(setting, text, &is))
            return rp_config_fail(setting, "result \"%s\": %s", text, rp_message());
        text = is.type == RP_X_WORD ? is.word : NULL;
    }
    if (!text || !exp_is_word(text) || (strcmp(text, "ok") != 0 && strncmp(text, "ok_", 3) != 0))
        return rp_config_fail(setting, "result = \"%s\": ok or ok_... expected", text ? text : "");
    plan->result = rp_text(&plan->arena, "%s", text);
    return plan->result ? RP_OK : RP_NO_MEMORY;
}

/* A scene without phases is one of so many steps, of which nothing is measured. */
static rp_status read_plain(exp_plan *plan)
{
    RP_NEW(&plan->arena, plan->phases, 1);
    *plan->phases = (exp_phase){.setting = config_root_setting(&plan->text->config),
                                .name = "scene",
                                .status = "",
                                .remove = "",
                                .ending = EXP_STEPS,
                                .end.x = {.known = true, .value = (double)plan->scene.steps},
                                .every = 1,
                                .opens = -1,
                                .source = SIZE_MAX,
                                .block = SIZE_MAX};
    plan->n_phases = 1, plan->result = "ok";
    return RP_OK;
}

/* As of rp_lets. */
static bool place(const char *key, char text[RP_PLACE_BYTES])
{
    size_t used = dem_place(key, text) ? strlen(text) : 0;
    if (rp_params_find(exp_phase_schema, key) || rp_word_index(exp_phase_keys, key) >= 0)
        rp_put_place(text, &used, "phases", key, "( )");
    if (rp_params_find(exp_measure_schema, key) || rp_word_index(exp_measure_keys, key) >= 0)
        rp_put_place(text, &used, "measure", key, "( )");
    return used > 0;
}

static rp_status read(exp_plan *plan)
{
    dem_text *text = plan->text;
    const config_setting_t *rest = config_lookup(&text->config, "rest"),
                           *lets = config_lookup(&text->config, "let");
    for (size_t k = 0; k < length(lets); k++)
        RP_TRY(exp_check_meaning(element(lets, k), "let", config_setting_name(element(lets, k)), NULL));
    text->lets.place = place;
    RP_TRY(dem_text_scene(text, &plan->scene));
    if (!exp_has_phases(text)) return read_plain(plan);
    rp_status status = rp_lets_constant(&text->lets, RP_LET_G, &plan->g);
    if (!status) status = rp_lets_constant(&text->lets, RP_LET_D, &plan->d);
    if (!status) status = rp_lets_constant(&text->lets, RP_LET_M, &plan->m);
    RP_TRY(rp_prefix(status, "%s: ", text->path));
    if (config_lookup(&text->config, "steps"))
        return rp_config_fail(config_lookup(&text->config, "steps"),
                              "steps: a text with phases ends with their last");
    RP_TRY(read_result(plan));
    RP_NEW(&plan->arena, plan->scopes,
           plan->scene.def.n_walls + plan->scene.def.n_kinds +
               exp_count_phases(config_lookup(&text->config, "phases")) +
               length(config_lookup(&text->config, "regions")) +
               length(config_lookup(&text->config, "measure")));
    RP_TRY(read_walls(plan));
    RP_TRY(exp_name_phases(plan));
    RP_TRY(read_regions(plan));
    rp_params_defaults(rest_schema, plan->scene.def.units, plan);
    if (rest) RP_TRY(rp_config_group(rest, rest_schema, plan, NULL));
    RP_TRY(exp_name_measures(plan));
    for (size_t k = 0; k < plan->n_phases; k++) RP_TRY(exp_read_phase(plan, k));
    for (size_t k = 0; k < plan->n_measures; k++) RP_TRY(exp_read_measure(plan, k));
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

void exp_with_ledger(exp_plan *plan)
{
    plan->scene.def.ledger = true;
}

const dem_text *exp_text(const exp_plan *plan)
{
    return plan->text;
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

const dem_scene_group exp_groups[] = {
    {"phases", exp_phase_schema,
     "a list, in its order: name; one of steps (a number), time (s), until (a condition, looked at every "
     "`every` steps); if (a condition of lets); fail = { word = \"condition\"; }. From here on: gravity = "
     "(gx, gy); gravity_turn_deg_per_step; box_turn_deg_per_step; dt; x_min; x_max; y_min; normal; "
     "tangential; "
     "rolling; walls = { NAME = { velocity = (vx, vy); omega; load_x; load_y; speed; coefficients }; }. A "
     "wall under a load moves by M dv/dt = load + force of the grains, |v| <= speed, M being a tenth of the "
     "total grain mass, at least that of ten grains. New grains: add = { N; kind; r, or radii as of a fill; "
     "density; x; y; vx; vy; omega; gap; }. A block has phases of its own, and repeat or until"},
    {"measure", exp_measure_schema,
     "a list of columns: name; of (an expression, a module or MODULE.OUTPUT); at or during a phase; when (a "
     "condition, of samples); event (a condition, of avalanches); against (an expression, of a line); if (a "
     "condition of lets); columns = [\"NAME\", ...] (the first of its columns, "
     "by these names)"},
    {"regions", exp_no_keys,
     "NAME = { x = (from, to); y = (from, to); }, { circle = (x, y, radius); } or { polygon = ( (x, y), ... "
     "); "
     "}, in the box's frame, by expressions"},
    {"require", exp_no_keys,
     "( (\"condition\", \"message\"), ... ): what must hold of the lets; asked before anything runs"},
    {"rest", rest_schema, "what the condition `rest` asks, in m, |g| and d of the mean grain"},
    {0}};
