/* Changes of a scene file's text: --set, and values of its lets. */
#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dem/scene/file.h"
#include "params/guess.h"
#include "params/units.h"

/* A number or truth that is known by itself; else a text, with or without quotes, which the reader of its key
 * takes for a word or an expression. */
static rp_value value_of(char *text)
{
    static const rp_x_names none;
    const size_t n = strlen(text);
    rp_expression e;
    RP_SCOPE(arena);
    if (!rp_expression_read(&arena, text, &none, &e) && e.known && e.type != RP_X_WORD && isfinite(e.value))
        return rp_x_value(e.type, e.value, NULL);
    const bool quoted = n > 1 && *text == '"' && text[n - 1] == '"';
    if (quoted) text[n - 1] = '\0';
    return (rp_value){.kind = RP_V_TEXT, .s = text + quoted};
}

/* The index in "walls[2]", which ends the name there; -1 for a name alone, -2 for no index. */
static long take_index(char *name)
{
    char *open = strchr(name, '['), *end;
    if (!open) return -1;
    const long i = strtol(open + 1, &end, 10);
    const bool whole = isdigit((unsigned char)open[1]) && strcmp(end, "]") == 0;
    *open = '\0';
    return whole ? i : -2;
}

/* One step of a path: the member `name` of the group, or its entry where the name has an index. */
static rp_status step_into(char *name, const char *text, config_setting_t **group)
{
    const long i = take_index(name);
    config_setting_t *at = member(*group, name);
    if (!at && i == -1 && config_setting_is_root(*group) &&
        rp_word_index("normal tangential rolling rest output ground hard implicit", name) >= 0)
        at = config_setting_add(*group, name, CONFIG_TYPE_GROUP);
    rp_guess guess = rp_guess_of(name);
    for (size_t k = 0; k < length(*group); k++) rp_guess_try(&guess, config_setting_name(element(*group, k)));
    if (!at)
        return rp_fail(RP_BAD_INPUT, "--set %s: the file has no such group%s", text, rp_guess_text(&guess));
    const int n = config_setting_length(at);
    if (config_setting_is_list(at) && (i < 0 || i >= n))
        return rp_fail(RP_BAD_INPUT, "--set %s: %s is a list of %d entries: %s[0] to %s[%d]", text, name, n,
                       name, name, n - 1);
    if (!config_setting_is_list(at) && i != -1)
        return rp_fail(RP_BAD_INPUT, "--set %s: %s is no list with entries", text, name);
    *group = i < 0 ? at : config_setting_get_elem(at, (unsigned)i);
    if (config_setting_is_group(*group)) return RP_OK;
    return rp_fail(RP_BAD_INPUT, "--set %s: %s has no keys of its own", text, name);
}

/* Put a value of any type in the place of a setting's. */
static void put(config_setting_t *setting, rp_value value)
{
    if (config_setting_type(setting) == CONFIG_TYPE_STRING) config_setting_set_string(setting, NULL);
    setting->type = CONFIG_TYPE_NONE, setting->value.sval = NULL;
    switch (value.kind) {
    case RP_V_INT: config_setting_set_int64(setting, value.i); break;
    case RP_V_REAL: config_setting_set_float(setting, value.r); break;
    case RP_V_BOOL: config_setting_set_bool(setting, (int)value.i); break;
    case RP_V_TEXT: config_setting_set_string(setting, value.s); break;
    }
}

static bool is_list(const char *value)
{
    return *value == '[' && value[strlen(value) - 1] == ']';
}

/* Add a value, which is cut, to a group under this name, to a list without one; [a, b] is a list. */
static bool add_value(config_setting_t *parent, const char *name, char *value)
{
    const bool list = is_list(value);
    config_setting_t *added = config_setting_add(parent, name, list ? CONFIG_TYPE_LIST : CONFIG_TYPE_NONE);
    bool whole = added != NULL;
    if (list) value[strlen(value) - 1] = '\0';
    if (whole && !list) put(added, value_of(value));
    for (char *part = value + 1, *end; list && whole && *part; part = end) {
        int depth = 0;
        part += strspn(part, " ");
        for (end = part; *end && (depth > 0 || *end != ','); end++)
            depth += (*end == '[' || *end == '(') - (*end == ']' || *end == ')');
        if (*end) *end++ = '\0';
        whole = add_value(added, NULL, part);
    }
    return whole;
}

static config_setting_t *let_of(const dem_text *text, const char *name)
{
    const config_setting_t *let = config_lookup(&text->config, "let");
    return let ? member(let, name) : NULL;
}

/* A key that is none of a scene is meant as a let, if there are any; after `let.` it is one. */
static rp_status check_let(const dem_text *scene, const char *key, bool let, const char *text)
{
    const config_setting_t *lets = config_lookup(&scene->config, "let");
    rp_guess guess = rp_guess_of(key);
    char names[512] = "; lets:";
    size_t used = strlen(names);
    if (!let && (rp_word_index(dem_scene_others, key) >= 0 || rp_params_find(dem_scene_schemas->schema, key)))
        return RP_OK;
    for (size_t k = 0; lets && k < length(lets); k++) {
        const char *name = config_setting_name(element(lets, k));
        rp_guess_try(&guess, name);
        if (used < sizeof names)
            used += (size_t)snprintf(names + used, sizeof names - used, " %s", name ? name : "");
    }
    const char *near = rp_guess_text(&guess);
    if (let || length(lets) > 0)
        return rp_fail(RP_BAD_INPUT, "--set %s: no such %slet%s", text, let ? "" : "key or ",
                       *near ? near : names);
    return RP_OK;
}

rp_status dem_text_give(dem_text *text, const char *name, const rp_value *value)
{
    config_setting_t *let = let_of(text, name);
    if (!let) return rp_fail(RP_BAD_INPUT, "let: the text has no %s", name);
    if (config_setting_is_group(let)) let = member(let, "value");
    if (!let || config_setting_is_aggregate(let)) return RP_OK; /* which its reading refuses */
    put(let, *value);
    return RP_OK;
}

#define NAMED_KEY(...) NAMED_KEY_OF(__VA_ARGS__)
#define NAMED_KEY_OF(group, kind, type, name, key, unit, fallback, range, also, automatic, wall, ...)        \
    {{#name, unit, type, 0, fallback, range also, __VA_ARGS__}, group key},
#define OF_TOP(...)        NAMED_KEY("", __VA_ARGS__)
#define OF_NORMAL(...)     NAMED_KEY("normal.", __VA_ARGS__)
#define OF_TANGENTIAL(...) NAMED_KEY("tangential.", __VA_ARGS__)
#define OF_ROLLING(...)    NAMED_KEY("rolling.", __VA_ARGS__)
#define OF_FILL(...)       NAMED_KEY("fill.", __VA_ARGS__)
const dem_named_key dem_named_keys[] = {
    DEM_GRAIN_PARAMS(OF_TOP) DEM_NORMAL_PARAMS(OF_NORMAL) DEM_TANGENTIAL_PARAMS(OF_TANGENTIAL)
        DEM_ROLLING_PARAMS(OF_ROLLING) DEM_RADIUS_PARAMS(OF_FILL){{0}, NULL}};

/* The first is written as in a file. */
bool dem_place(const char *key, char text[RP_PLACE_BYTES])
{
    size_t used = 0;
    char group[16];
    for (const dem_named_key *k = dem_named_keys; k->key; k++) { /* by another name */
        const char *dot = strchr(k->key, '.');
        if (!dot || strcmp(k->param.name, key) != 0 || strcmp(dot + 1, key) == 0) continue;
        snprintf(group, sizeof group, "%.*s", (int)(dot - k->key), k->key);
        rp_put_place(text, &used, group, dot + 1, "{ }");
    }
    for (const dem_scene_group *g = dem_scene_schemas; g->name && used < RP_PLACE_BYTES; g++) {
        const bool top = g->schema == SCHEMA(TOP), list = g->schema == SCHEMA(WALLS) ||
                                                          g->schema == SCHEMA(PARTICLES) ||
                                                          g->schema == SCHEMA(PAIRS);
        const char *also = top                          ? dem_scene_others
                           : g->schema == SCHEMA(WALLS) ? dem_wall_others
                           : g->schema == SCHEMA(FILL)  ? "radii polygon"
                                                        : "";
        if (rp_params_find(g->schema, key) || rp_word_index(also, key) >= 0)
            rp_put_place(text, &used, top ? "the file itself, outside all groups" : g->name, key,
                         top    ? ""
                         : list ? "( )"
                                : "{ }");
    }
    return used > 0;
}

/* Put "group.key=value" or "list[0].key=value" into the tree that was read, instead of what stands there. */
rp_status dem_text_change(dem_text *scene, const char *text)
{
    RP_SCOPE(arena);
    char path[128], *key = path, *copy;
    const char *equals = strchr(text, '=');
    config_setting_t *group = config_root_setting(&scene->config);
    if (!equals || equals == text || equals - text >= (long)sizeof path)
        return rp_fail(RP_BAD_INPUT, "--set %s: key=value expected", text);
    snprintf(path, sizeof path, "%.*s", (int)(equals - text), text);
    for (char *dot; (dot = strstr(path, ".["));)
        memmove(dot, dot + 1, strlen(dot)); /* libconfig's spelling */
    if (!(copy = rp_text(&arena, "%s", equals + 1))) return RP_NO_MEMORY;
    const bool let = strncmp(path, "let.", 4) == 0 && !strchr(path + 4, '.');
    if (let) memmove(path, path + 4, strlen(path + 4) + 1);
    for (char *dot; (dot = strchr(key, '.')); key = dot + 1) {
        *dot = '\0';
        RP_TRY(step_into(key, text, &group));
    }
    if (key == path && let_of(scene, key) && !is_list(copy))
        return dem_text_give(scene, key, (rp_value[]){value_of(copy)});
    if (let) return check_let(scene, key, true, text);
    for (const dem_named_key *k = dem_named_keys; k->key && key == path; k++)
        if (strcmp(k->param.name, key) == 0 && strchr(k->key, '.') && strncmp(k->key, key, strlen(key)) != 0)
            return rp_fail(RP_BAD_INPUT, "--set %s: of a scene the key is %s", text, k->key);
    if (key == path && !member(group, key)) RP_TRY(check_let(scene, key, false, text));
    if (strchr(key, '['))
        return rp_fail(RP_BAD_INPUT, "--set %s: give a key of the entry, or the whole list", text);
    if (member(group, key)) config_setting_remove(group, key);
    return add_value(group, key, copy) ? RP_OK : rp_fail(RP_BAD_INPUT, "--set %s: not a key", text);
}
