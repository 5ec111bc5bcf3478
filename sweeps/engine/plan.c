/* From a sweep file to its grid points, runs and tables; see sweep.h for the file and the order. */
#include "sweeps/engine/private.h"

#include <stdlib.h>
#include <string.h>

#include "params/config.h"
#include "core/file.h"
#include "params/units.h"
#include "core/version.h"
#include "table/columns.h"

enum { MAX_RUNS = 10000000 };
enum { PILES_OWN, PILES_SHARED };

typedef struct {
    int protocol;
    long replicas, study, seed;
    bool zip;
    int piles, units;
    const char *experiment;
    rp_texts set;
} head;

/* Of what a sweep's file has runs: a protocol, or an experiment. */
static bool sweep_names_runs(const config_setting_t *root)
{
    return config_setting_get_member(root, "protocol") || config_setting_get_member(root, "experiment");
}

static rp_status refuse_scene(const char *file, const config_setting_t *root)
{
    static const char *const keys[] = {"particles", "particles_file", "fill", "walls"};
    for (size_t i = 0; i < sizeof keys / sizeof *keys && !sweep_names_runs(root); i++)
        if (config_setting_get_member(root, keys[i]))
            return rp_fail(RP_BAD_INPUT, "%s: a scene (it has %s), no sweep; repose run %s simulates it",
                           file, keys[i], file);
    return RP_OK;
}

/* The file's settings apart from `fixed` and `grid`. */
static rp_status read_head(const char *file, const config_setting_t *root,
                           const sweep_protocol *const *protocols, head *h)
{
    char names[256] = "";
    size_t used = 0;
    for (const sweep_protocol *const *p = protocols; *p && used < sizeof names; p++)
        used += (size_t)snprintf(names + used, sizeof names - used, "%s%s", used ? " | " : "", (*p)->name);
    const rp_param schema[] = {
        {"protocol", "", RP_CHOICE, offsetof(head, protocol), protocols[0]->name, names,
         "kind of experiment"},
        {"experiment", "", RP_TEXT, offsetof(head, experiment), "", "",
         "file of a scene with phases and measures, instead of a protocol; beside this file"},
        {"replicas", "", RP_INT, offsetof(head, replicas), "20", "[1, 1000000]", "runs of each grid point"},
        {"study", "", RP_INT, offsetof(head, study), "auto", "[1, 1000000] | auto",
         "runs of each grid point for `repose sweep make --study`; auto: replicas"},
        {"seed", "", RP_INT, offsetof(head, seed), "1993", "[0, 2147483647]", "seed of the random streams"},
        {"zip", "", RP_BOOL, offsetof(head, zip), "false", "", "take the lists of the grid together"},
        {"piles", "", RP_CHOICE, offsetof(head, piles), "own", "own | shared",
         "random streams: every run its own, or replica k of every grid point the same"},
        {"units", "", RP_CHOICE, offsetof(head, units), "cgs", RP_UNITS_WORDS,
         "of the numbers here and of the tables; without it those of the protocol's text"},
        {"set", "", RP_TEXTS, offsetof(head, set), "", "", "KEY=VALUE: changes of the experiment"},
        {0}};
    RP_TRY(refuse_scene(file, root));
    if (!sweep_names_runs(root)) /* the root has no line to point at */
        return rp_fail(RP_BAD_INPUT, "%s: protocol or experiment: missing (kind of experiment), allowed: %s",
                       file, names);
    *h = (head){0};
    rp_params_defaults(schema, RP_CGS, h);
    RP_TRY(rp_config_group(root, schema, h, "fixed grid derive trace model"));
    const bool text = *h->experiment || protocols[h->protocol]->text;
    const config_setting_t *set = config_setting_get_member(root, "set"),
                           *units = config_setting_get_member(root, "units"),
                           *protocol = config_setting_get_member(root, "protocol");
    if (set && !text) return rp_config_fail(set, "set: changes an experiment");
    for (size_t i = 0; i < h->set.n; i++)
        if (strncmp(h->set.items[i], "seed=", 5) == 0 || strncmp(h->set.items[i], "run=", 4) == 0)
            return rp_config_fail(set, "set: %s: random numbers follow from the sweep's seed",
                                  h->set.items[i]);
    if (protocol && *h->experiment) return rp_config_fail(protocol, "protocol: the experiment's text has it");
    return units && *h->experiment ? rp_config_fail(units, "units: the experiment's text has it") : RP_OK;
}

static int length(const config_setting_t *group)
{
    return group ? config_setting_length(group) : 0;
}

/* Where the line of a setting begins among the bytes of its file. */
static const char *line_of(const config_setting_t *setting, const char *text)
{
    for (unsigned line = 1; line < config_setting_source_line(setting) && text; line++)
        text = strchr(text, '\n') ? strchr(text, '\n') + 1 : NULL;
    return text;
}

static const config_setting_t *element(const config_setting_t *group, size_t i)
{
    return config_setting_get_elem(group, (unsigned)i);
}

/* Open the experiment's file, beside the sweep's or as rp_data finds it, or the protocol's text. A sweep's
 * folder has a copy. */
static rp_status open_experiment(const char *file, const head *h, sweep_plan *plan)
{
    RP_SCOPE(arena);
    const char *name = h->experiment, *path, *slash = strrchr(file, '/');
    const int folder = slash ? (int)(slash - file) + 1 : 0;
    const config_setting_t *units = config_lookup(&plan->config, "units");
    if (*name) {
        RP_TRY(rp_path(&arena, &path, "%.*sstore.sqlite", folder, file));
        if (rp_is_there(path)) name = "experiment.cfg";
        RP_TRY(rp_path(&arena, &path, "%.*s%s", *name == '/' ? 0 : folder, file, name));
        if (!rp_is_there(path) && rp_is_there(rp_data(&arena, name))) path = rp_data(&arena, name);
        return rp_prefix(sweep_protocol_open(plan->protocol, path, &h->set, &plan->protocol),
                         "%s: experiment: ", file);
    }
    RP_TRY(rp_prefix(sweep_protocol_open(plan->protocol, NULL, &h->set, &plan->protocol), "%s: ", file));
    if (units && plan->protocol->units == RP_SIGMA && h->units != RP_SIGMA)
        return rp_config_fail(units, "units: protocol %s is in sigma, without a unit of length",
                              plan->protocol->name);
    if (units) sweep_protocol_in(plan->protocol, (rp_units)h->units);
    return RP_OK;
}

const rp_param *sweep_plan_param(const sweep_plan *plan, const char *name)
{
    sweep_protocol_also(plan->protocol, name);
    return rp_params_find(plan->protocol->schema, name);
}

static rp_status find_param(const sweep_plan *plan, const config_setting_t *setting, const rp_param **param)
{
    const sweep_protocol *protocol = plan->protocol;
    *param = sweep_plan_param(plan, config_setting_name(setting));
    if (*param) return RP_OK;
    char more[64];
    snprintf(more, sizeof more, "; see repose params %s",
             strcmp(protocol->name, "experiment") ? protocol->name : "scene");
    return rp_config_unknown(setting, protocol->schema, NULL, more);
}

static rp_status read_fixed(const sweep_plan *plan, const config_setting_t *fixed, void *values)
{
    rp_params_defaults(plan->protocol->schema, plan->protocol->units, values);
    if (fixed && !config_setting_is_group(fixed))
        return rp_config_fail(fixed, "fixed: a group { key = ...; } expected");
    for (int i = 0; i < length(fixed); i++) {
        const rp_param *param;
        const config_setting_t *setting = element(fixed, (size_t)i);
        RP_TRY(find_param(plan, setting, &param));
        RP_TRY(rp_config_value(setting, param, values));
    }
    return RP_OK;
}

enum { MAX_AXES = 64 };

/* The lists of the grid: a group of lists, each its own bundle or with zip = true one for all, or a list of
 * groups, a bundle each. */
static rp_status find_lists(const head *h, const config_setting_t *grid, sweep_axis axes[], size_t *n)
{
    const bool bundles = grid && config_setting_is_list(grid);
    *n = 0;
    if (bundles && h->zip)
        return rp_config_fail(grid, "grid: zip = true is for one group of lists, not for a list of groups");
    for (int g = 0; g < (bundles ? length(grid) : 1); g++) {
        const config_setting_t *group = bundles ? element(grid, (size_t)g) : grid;
        if (group && !config_setting_is_group(group))
            return rp_config_fail(group, "grid: %s { key = [ ... ]; } expected",
                                  bundles ? "groups" : "a group");
        for (int i = 0; i < length(group); i++) {
            if (*n == MAX_AXES) return rp_config_fail(group, "grid: more than %d lists", MAX_AXES);
            size_t bundle = bundles ? (size_t)g : h->zip ? 0 : *n;
            axes[(*n)++] = (sweep_axis){.list = element(group, (size_t)i), .bundle = bundle};
        }
    }
    return RP_OK;
}

/* The values of axis a, checked. It may not repeat another's parameter nor one under fixed. */
static rp_status read_axis(sweep_plan *plan, size_t a, const config_setting_t *fixed)
{
    sweep_axis *axis = &plan->axes[a];
    const char *name = config_setting_name(axis->list);
    RP_TRY(find_param(plan, axis->list, &axis->param));
    for (size_t other = 0; other < a; other++)
        if (plan->axes[other].param == axis->param)
            return rp_config_fail(axis->list, "%s: appears twice in the grid; keep one", name);
    if (plan->protocol->context && rp_word_index(RP_SWEEP_COLUMNS, name) >= 0)
        return rp_config_fail(axis->list, "%s: is a column that every sweep has; give the let another name",
                              name);
    const rp_type type = axis->param->type;
    if (type == RP_TEXT || type == RP_TEXTS)
        return rp_config_fail(axis->list, "%s: cannot vary over a grid; set it under fixed", name);
    if (fixed && config_setting_get_member(fixed, name))
        return rp_config_fail(axis->list, "%s: appears under fixed and under grid; keep one", name);
    if ((!config_setting_is_array(axis->list) && !config_setting_is_list(axis->list)) ||
        length(axis->list) == 0)
        return rp_config_fail(axis->list, "%s: a list [ ... ] of one value or more expected", name);
    axis->n = (size_t)length(axis->list);
    axis->first = a == 0 || axis[-1].bundle != axis->bundle;
    if (!axis->first && axis->n != axis[-1].n)
        return rp_config_fail(axis->list,
                              "%s: %zu values; lists that go together have the same number, %zu as in %s",
                              name, axis->n, axis[-1].n, axis[-1].param->name);
    for (size_t i = 0; i < axis->n; i++)
        RP_TRY(rp_config_value(element(axis->list, i), axis->param, plan->at->values));
    return RP_OK;
}

/* Find the axes of the grid and how many points they span. */
static rp_status read_axes(sweep_plan *plan, const config_setting_t *fixed)
{
    plan->n_points = 1;
    for (size_t a = 0; a < plan->n_axes; a++) {
        RP_TRY(read_axis(plan, a, fixed));
        if (plan->axes[a].first) plan->n_points *= plan->axes[a].n;
        if (plan->n_points > MAX_RUNS / plan->replicas)
            return rp_config_fail(plan->axes[a].list, "%s: the grid has too many runs, allowed: %d",
                                  plan->axes[a].param->name, MAX_RUNS);
    }
    return RP_OK;
}

/* Set the values of point i in the plan's one structure, and the sum of their hashes. */
static void move_to(const sweep_plan *plan, size_t i)
{
    sweep_position *at = plan->at;
    if (at->point == i) return;
    at->point = i;
    at->settings = plan->fixed_hash;
    for (size_t a = plan->n_axes, rest = i; a-- > 0;) {
        const sweep_axis *axis = &plan->axes[a];
        rp_config_value(element(axis->list, rest % axis->n), axis->param, at->values); /* checked before */
        at->settings = rp_hash_add(at->settings, rp_params_hash_one(axis->param, at->values));
        if (axis->first) rest /= axis->n;
    }
}

/* What stands for a grid point's parameters in keys: the sum of their hashes, of a text all that its numbers
 * depend on. */
static const XXH128_hash_t *hash_of(const sweep_plan *plan, size_t point)
{
    XXH128_hash_t *hash = &plan->hashes[point];
    if (hash->low64 || hash->high64) return hash;
    move_to(plan, point);
    if (!plan->protocol->hash || !plan->protocol->hash(plan->at->values, hash)) *hash = plan->at->settings;
    return hash;
}

bool sweep_plan_is_axis(const sweep_plan *plan, const rp_param *param)
{
    for (size_t a = 0; a < plan->n_axes; a++)
        if (plan->axes[a].param == param) return true;
    return false;
}

rp_status sweep_plan_check_point(const sweep_plan *plan, const char *file, size_t point)
{
    char where[256];
    const void *values = sweep_plan_point(plan, point);
    rp_status status = plan->protocol->check(values);
    if (!status) return RP_OK; /* the only answer for millions of points */
    return rp_prefix(status, "%s: %s%s: ", file, plan->n_axes ? "grid point " : "parameters",
                     sweep_plan_describe(plan, point, where, sizeof where));
}

typedef struct {
    XXH128_hash_t hash;
    size_t i;
} entry;

/* Two grid points of the same parameters would be the same runs: no bundle of lists repeats its values. */
static rp_status refuse_twins(const sweep_plan *plan, size_t first)
{
    const sweep_axis *axis = &plan->axes[first];
    entry *entries = calloc(axis->n, sizeof *entries);
    if (!entries) return rp_fail(RP_NO_MEMORY, "grid: out of memory");
    size_t stride = 1; /* from one value of the bundle to the next, in points */
    for (size_t a = first; a < plan->n_axes; a++)
        if (plan->axes[a].first && a > first) stride *= plan->axes[a].n;
    for (size_t i = 0; i < axis->n; i++) entries[i] = (entry){*hash_of(plan, i * stride), i};
    qsort(entries, axis->n, sizeof *entries, XXH128_cmp); /* the hash comes first */
    rp_status status = RP_OK;
    char where[256];
    for (size_t i = 1; !status && i < axis->n; i++)
        if (XXH128_isEqual(entries[i - 1].hash, entries[i].hash))
            status = rp_config_fail(axis->list, "grid point %s: appears twice in the grid",
                                    sweep_plan_describe(plan, entries[i].i * stride, where, sizeof where));
    free(entries);
    return status;
}

/* Append "name":value to a JSON text. */
static void append_json(const rp_param *param, const void *values, char *buffer, size_t size)
{
    char text[256];
    const size_t used = strlen(buffer);
    rp_params_text(param, values, text, sizeof text);
    const bool number =
        (param->type == RP_REAL || param->type == RP_INT) && strspn(text, "+-.0123456789e") == strlen(text);
    for (char *c = text; *c; c++)
        if (*c == '"' || *c == '\\' || *c < ' ') *c = '_'; /* in file names only */
    snprintf(buffer + used, size - used, number ? "%s\"%s\":%s" : "%s\"%s\":\"%s\"", used > 1 ? "," : "",
             param->name, text);
}

static void sum_fixed(sweep_plan *plan, const rp_texts *set, const config_setting_t *fixed)
{
    strcpy(plan->fixed_json, "{");
    for (size_t i = 0; i < set->n; i++)
        plan->fixed_hash = rp_hash_add(plan->fixed_hash, XXH3_128bits(set->items[i], strlen(set->items[i])));
    for (const rp_param *p = plan->protocol->schema; p->name; p++) {
        if (sweep_plan_is_axis(plan, p)) continue;
        plan->fixed_hash = rp_hash_add(plan->fixed_hash, rp_params_hash_one(p, plan->at->values));
        if (fixed && config_setting_get_member(fixed, p->name))
            append_json(p, plan->at->values, plan->fixed_json, sizeof plan->fixed_json);
    }
}

rp_status sweep_plan_read(const char *file, const sweep_protocol *const *protocols, sweep_plan *plan)
{
    *plan = (sweep_plan){0};
    head h;
    RP_TRY(rp_config_read(file, &plan->config));
    RP_TRY(rp_file_read(file, &plan->text));
    const config_setting_t *root = config_root_setting(&plan->config),
                           *fixed = config_setting_get_member(root, "fixed"),
                           *grid = config_setting_get_member(root, "grid");
    RP_TRY(read_head(file, root, protocols, &h));
    plan->protocol = protocols[h.protocol];
    if (*h.experiment || plan->protocol->text) RP_TRY(open_experiment(file, &h, plan));
    plan->replicas = (size_t)h.replicas;
    plan->seed = (unsigned long)h.seed;
    plan->shared_piles = h.piles == PILES_SHARED;
    plan->axes = calloc(MAX_AXES, sizeof *plan->axes);
    plan->at = calloc(1, sizeof *plan->at + plan->protocol->params_size);
    if (!plan->axes || !plan->at) return rp_fail(RP_NO_MEMORY, "%s: out of memory", file);
    plan->at->point = SIZE_MAX;
    if (plan->protocol->context) memcpy(plan->at->values, &plan->protocol->context, sizeof(void *));
    RP_TRY(find_lists(&h, grid, plan->axes, &plan->n_axes));
    RP_TRY(read_axes(plan, fixed));
    RP_TRY(read_fixed(plan, fixed, plan->at->values));
    char model[32];
    snprintf(plan->model, sizeof plan->model, "%s %s", plan->protocol->name, rp_model(model));
    sum_fixed(plan, &h.set, fixed);
    plan->hashes = calloc(plan->n_points, sizeof *plan->hashes);
    if (!plan->hashes) return rp_fail(RP_NO_MEMORY, "%s: out of memory", file);
    for (size_t a = 0; a < plan->n_axes; a++)
        if (plan->axes[a].first) RP_TRY(refuse_twins(plan, a));
    plan->n_runs = plan->n_points * plan->replicas;
    return RP_OK;
}

rp_status sweep_plan_replicate(sweep_plan *plan, size_t replicas)
{
    if (replicas < 1 || replicas > MAX_RUNS / plan->n_points)
        return rp_fail(RP_BAD_INPUT, "replicas = %zu: out of range for %zu grid points, allowed: [1, %zu]",
                       replicas, plan->n_points, MAX_RUNS / plan->n_points);
    const config_setting_t *setting = config_lookup(&plan->config, "replicas");
    const char *at = setting ? line_of(setting, plan->text) : plan->text;
    char *made = NULL;
    at = at && setting ? strstr(at, "replicas") : at;
    if (!at) return rp_config_fail(setting, "replicas: a name and its number on one line expected");
    if (setting) at += strcspn(at, "=:") + 1, at += strspn(at, " \t");
    const size_t n = setting ? strcspn(at, " \t\r\n;,#/") : 0;
    if (asprintf(&made, "%.*s%s%zu%s%s", (int)(at - plan->text), plan->text,
                 setting ? "" : "replicas = ", replicas, setting ? "" : ";\n", at + n) < 0)
        return rp_fail(RP_NO_MEMORY, "replicas: out of memory");
    free(plan->text);
    plan->text = made;
    plan->replicas = replicas;
    plan->n_runs = plan->n_points * replicas;
    return RP_OK;
}

void sweep_plan_free(sweep_plan *plan)
{
    free(plan->axes);
    free(plan->at);
    free(plan->hashes);
    free(plan->text);
    sweep_protocol_close(plan->protocol);
    config_destroy(&plan->config);
}

const void *sweep_plan_point(const sweep_plan *plan, size_t point)
{
    move_to(plan, point);
    return plan->at->values;
}

/* Hash of one of a point's hashes with `text`. */
static XXH128_hash_t hash_point(const XXH128_hash_t *of, const char *text)
{
    char bytes[sizeof(XXH128_canonical_t) + 256];
    XXH128_canonicalFromHash((XXH128_canonical_t *)bytes, *of);
    const int n = snprintf(bytes + sizeof(XXH128_canonical_t), 256, "%s", text);
    return XXH3_128bits(bytes, sizeof(XXH128_canonical_t) + (size_t)n);
}

sweep_stream sweep_plan_stream(const sweep_plan *plan, size_t run)
{
    const size_t replica = run % plan->replicas;
    if (plan->shared_piles) return (sweep_stream){plan->seed, replica, replica};
    char text[128];
    const char *name = plan->protocol->context ? plan->protocol->name : ""; /* of a text */
    snprintf(text, sizeof text, *name ? "streams %lu %s" : "streams %lu", plan->seed, name);
    /* numbers of 31 bits, as scene files have them */
    move_to(plan, run / plan->replicas);
    const unsigned long most = 0x7fffffff, hash = hash_point(&plan->at->settings, text).low64;
    return (sweep_stream){hash & most, ((hash >> 33) + replica) & most, (hash >> 12) + replica};
}

rp_status sweep_plan_run(const sweep_plan *plan, size_t run, const sweep_tables *tables, sweep_result *result)
{
    const sweep_stream stream = sweep_plan_stream(plan, run);
    return plan->protocol->run(sweep_plan_point(plan, run / plan->replicas), stream.seed, stream.run, tables,
                               result);
}

/* Hash of the parameters and streams of a run, and of the text before them. */
static void hash_run(const sweep_plan *plan, size_t run, const char *before, char digits[33])
{
    const sweep_stream stream = sweep_plan_stream(plan, run);
    char text[256];
    snprintf(text, sizeof text, "%s seed=%lu run=%lu", before, stream.seed, stream.run);
    rp_hash_digits(hash_point(hash_of(plan, run / plan->replicas), text), digits);
}

void sweep_plan_key(const sweep_plan *plan, size_t run, char key[33])
{
    hash_run(plan, run, plan->model, key);
}

void sweep_plan_setting(const sweep_plan *plan, size_t run, char digits[33])
{
    hash_run(plan, run, plan->protocol->name, digits);
}

const char *sweep_plan_parameters(const sweep_plan *plan, size_t point, char *buffer, size_t size)
{
    const void *values = sweep_plan_point(plan, point);
    snprintf(buffer, size, "%s", plan->fixed_json);
    for (size_t a = 0; a < plan->n_axes; a++) append_json(plan->axes[a].param, values, buffer, size - 1);
    return strcat(buffer, "}");
}

const char *sweep_plan_describe(const sweep_plan *plan, size_t point, char *buffer, size_t size)
{
    char text[64];
    size_t used = 0;
    const void *values = sweep_plan_point(plan, point);
    buffer[0] = '\0';
    for (size_t a = 0; a < plan->n_axes && used < size; a++)
        used += (size_t)snprintf(buffer + used, size - used, "%s%s = %s", a ? ", " : "",
                                 plan->axes[a].param->name,
                                 rp_params_text(plan->axes[a].param, values, text, sizeof text));
    return buffer;
}

/* ---- tables of the file ---- */

rp_status sweep_recipe_read(const char *file, sweep_recipe *recipe)
{
    static const rp_param none[] = {{0}};
    *recipe = (sweep_recipe){0};
    const char *base = basename(file); /* "lh3" of sweeps/lh/lh3.cfg */
    snprintf(recipe->name, sizeof recipe->name, "%.*s", (int)strcspn(base, "."), base);
    RP_TRY(rp_config_read(file, &recipe->config));
    const config_setting_t *root = config_root_setting(&recipe->config);
    int replicas = 0;
    recipe->has_runs = sweep_names_runs(root);
    if (config_setting_lookup_int(root, "study", &replicas) && replicas > 0) recipe->study = (size_t)replicas;
    RP_TRY(refuse_scene(file, root));
    if (recipe->has_runs) return RP_OK;
    if (!config_setting_get_member(root, "model"))
        return rp_fail(RP_BAD_INPUT, "%s: neither a protocol nor an experiment nor a model", file);
    return rp_config_group(root, none, NULL, "model units");
}

void sweep_recipe_free(sweep_recipe *recipe)
{
    config_destroy(&recipe->config);
}
