/* Changes of a scene file's text: --set, and values of its lets. */
#include <ctype.h>
#include <stdlib.h>
#include <string.h>

#include "dem/scene/file.h"
#include "params/guess.h"
#include "params/units.h"

/* Read "v = VALUE;"; a bare word is a string. */
static rp_status read_value(const char *value, config_t *one)
{
    char line[512];
    for (int quoted = 0; quoted < 3; quoted++) {
        const int last = (int)strlen(value) - 1;
        const bool list = *value == '[' && value[last] == ']'; /* of one type in libconfig, as ( ) is not */
        if (quoted == 1 && !list) continue;
        const int n = quoted == 1 ? snprintf(line, sizeof line, "v = (%.*s);", last - 1, value + 1)
                                  : snprintf(line, sizeof line, quoted ? "v = \"%s\";" : "v = %s;", value);
        if (n >= (int)sizeof line) return rp_fail(RP_BAD_INPUT, "--set: a value of more than 500 bytes");
        RP_TRY(rp_config_scan_text("--set", line));
        if (config_read_string(one, line) && length(config_root_setting(one)) == 1) return RP_OK;
    }
    return rp_fail(RP_BAD_INPUT, "--set: cannot read the value");
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
        rp_word_index("normal tangential rolling rest output", name) >= 0) /* all their keys have defaults */
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
static void put(config_setting_t *setting, const rp_value *value)
{
    if (config_setting_type(setting) == CONFIG_TYPE_STRING) config_setting_set_string(setting, NULL);
    setting->type = CONFIG_TYPE_NONE, setting->value.sval = NULL;
    switch (value->kind) {
    case RP_V_INT: config_setting_set_int64(setting, value->i); break;
    case RP_V_REAL: config_setting_set_float(setting, value->r); break;
    case RP_V_BOOL: config_setting_set_bool(setting, (int)value->i); break;
    case RP_V_TEXT: config_setting_set_string(setting, value->s); break;
    }
}

/* Add a copy of the value to a group under this name; to a list or an array without a name. */
static bool add_copy(config_setting_t *parent, const char *name, const config_setting_t *value)
{
    config_setting_t *copy = config_setting_add(parent, name, config_setting_type(value));
    rp_value scalar;
    bool whole = copy != NULL;
    if (copy && !rp_config_scalar(value, &scalar)) put(copy, &scalar);
    for (size_t i = 0; i < length(value) && whole; i++)
        whole = add_copy(copy, config_setting_name(element(value, i)), element(value, i));
    return whole;
}

static config_setting_t *let_of(const dem_text *text, const char *name)
{
    const config_setting_t *let = config_lookup(&text->config, "let");
    return let ? member(let, name) : NULL;
}

/* A key that is none of a scene is meant as a let, if there are any. */
static rp_status check_let(const dem_text *scene, const char *key, const char *text)
{
    const config_setting_t *lets = config_lookup(&scene->config, "let");
    rp_guess guess = rp_guess_of(key);
    char names[512] = "; lets:";
    size_t used = strlen(names);
    if (rp_word_index(dem_scene_others, key) >= 0 || rp_params_find(dem_scene_schemas->schema, key))
        return RP_OK;
    for (size_t k = 0; lets && k < length(lets); k++) {
        const char *name = config_setting_name(element(lets, k));
        rp_guess_try(&guess, name);
        if (used < sizeof names)
            used += (size_t)snprintf(names + used, sizeof names - used, " %s", name ? name : "");
    }
    const char *near = rp_guess_text(&guess);
    return lets && length(lets) > 0
               ? rp_fail(RP_BAD_INPUT, "--set %s: no such key or let%s", text, *near ? near : names)
               : RP_OK;
}

rp_status dem_text_give(dem_text *text, const char *name, const rp_value *value)
{
    config_setting_t *let = let_of(text, name);
    if (!let) return rp_fail(RP_BAD_INPUT, "let: the text has no %s", name);
    if (config_setting_is_group(let)) let = member(let, "value");
    if (!let || config_setting_is_aggregate(let)) return RP_OK; /* which its reading refuses */
    put(let, value);
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

/* Put "group.key=value" or "list[0].key=value" into the tree that was read, instead of what stands there. */
rp_status dem_text_change(dem_text *scene, const char *text)
{
    RP_ENDS(config_destroy) config_t one;
    char path[128], *key = path;
    const char *equals = strchr(text, '=');
    config_setting_t *group = config_root_setting(&scene->config);
    rp_value value;
    config_init(&one);
    if (!equals || equals == text || equals - text >= (long)sizeof path)
        return rp_fail(RP_BAD_INPUT, "--set %s: key=value expected", text);
    snprintf(path, sizeof path, "%.*s", (int)(equals - text), text);
    for (char *dot; (dot = strstr(path, ".["));)
        memmove(dot, dot + 1, strlen(dot)); /* libconfig's spelling */
    RP_TRY(read_value(equals + 1, &one));
    for (char *dot; (dot = strchr(key, '.')); key = dot + 1) {
        *dot = '\0';
        RP_TRY(step_into(key, text, &group));
    }
    if (key == path && let_of(scene, key) && !rp_config_scalar(config_lookup(&one, "v"), &value))
        return dem_text_give(scene, key, &value);
    for (const dem_named_key *k = dem_named_keys; k->key && key == path; k++)
        if (strcmp(k->param.name, key) == 0 && strchr(k->key, '.') && strncmp(k->key, key, strlen(key)) != 0)
            return rp_fail(RP_BAD_INPUT, "--set %s: of a scene the key is %s", text, k->key);
    if (key == path && !member(group, key)) RP_TRY(check_let(scene, key, text));
    if (strchr(key, '['))
        return rp_fail(RP_BAD_INPUT, "--set %s: give a key of the entry, or the whole list", text);
    if (member(group, key)) config_setting_remove(group, key);
    return add_copy(group, key, config_lookup(&one, "v"))
               ? RP_OK
               : rp_fail(RP_BAD_INPUT, "--set %s: not a key", text);
}
