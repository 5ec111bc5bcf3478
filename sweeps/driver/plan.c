/* From a sweep file to its grid points and runs; see sweep.h for the file and the order. */
#include "sweeps/driver/private.h"

#include <stdlib.h>
#include <string.h>

#include "core/config.h"
#include "core/table.h"
#include "core/version.h"

enum { MAX_RUNS = 10000000 };
enum { PILES_OWN, PILES_SHARED };

typedef struct {
    int protocol;
    long replicas, study, seed;
    bool zip;
    int piles;
} head;

/* The file's settings apart from `fixed` and `grid`. */
static rp_status read_head(const char *file, const config_setting_t *root,
                           const sweep_protocol *const *protocols, head *h)
{
    char names[256] = "";
    size_t used = 0;
    for (const sweep_protocol *const *p = protocols; *p && used < sizeof names; p++)
        used += (size_t)snprintf(names + used, sizeof names - used, "%s%s", used ? " | " : "", (*p)->name);
    const rp_param schema[] = {
        {"protocol", "", RP_CHOICE, offsetof(head, protocol), NULL, names, "kind of experiment"},
        {"replicas", "", RP_INT, offsetof(head, replicas), "20", "[1, 1000000]", "runs of each grid point"},
        {"study", "", RP_INT, offsetof(head, study), "auto", "[1, 1000000] | auto",
         "runs of each grid point for `repose sweep make --study`; auto: replicas"},
        {"seed", "", RP_INT, offsetof(head, seed), "1993", "[0, 2147483647]", "seed of the random streams"},
        {"zip", "", RP_BOOL, offsetof(head, zip), "false", "", "take the lists of the grid together"},
        {"piles", "", RP_CHOICE, offsetof(head, piles), "own", "own | shared",
         "random streams: every run its own, or replica k of every grid point the same"},
        {0}};
    if (!config_setting_get_member(root, "protocol")) /* the root has no line to point at */
        return rp_fail(RP_BAD_INPUT, "%s: protocol: missing (kind of experiment), allowed: %s", file, names);
    rp_params_defaults(schema, h);
    return rp_config_group(root, schema, h, (const char *const[]){"fixed", "grid", "tables", NULL});
}

/* A sweep's folder keeps one file that says everything. */
static rp_status refuse_includes(const char *file, const char *text)
{
    int number = 1;
    for (const char *line = text; *line; number++) {
        if (strncmp(line + strspn(line, " \t"), "@include", 8) == 0)
            return rp_fail(RP_BAD_INPUT, "%s:%d: @include: a sweep file must be whole in itself", file,
                           number);
        line += strcspn(line, "\n");
        line += *line == '\n';
    }
    return RP_OK;
}

static rp_status find_param(const sweep_protocol *protocol, const config_setting_t *setting,
                            const rp_param **param)
{
    *param = rp_params_find(protocol->schema, config_setting_name(setting));
    return *param ? RP_OK
                  : rp_config_fail(setting, "%s: unknown key; see repose params %s",
                                   config_setting_name(setting), protocol->name);
}

static int length(const config_setting_t *group)
{
    return group ? config_setting_length(group) : 0;
}

static const config_setting_t *element(const config_setting_t *group, size_t i)
{
    return config_setting_get_elem(group, (unsigned)i);
}

static rp_status read_fixed(const sweep_plan *plan, const config_setting_t *fixed, void *values)
{
    rp_params_defaults(plan->protocol->schema, values);
    if (fixed && !config_setting_is_group(fixed))
        return rp_config_fail(fixed, "fixed: a group { key = ...; } expected");
    for (int i = 0; i < length(fixed); i++) {
        const rp_param *param;
        const config_setting_t *setting = element(fixed, (size_t)i);
        rp_status status = find_param(plan->protocol, setting, &param);
        if (!status) status = rp_config_value(setting, param, values);
        if (status) return status;
    }
    return RP_OK;
}

/* One list of the grid. Lists of one bundle go together; the bundles make the product. */
typedef struct {
    const config_setting_t *list;
    size_t bundle;
} axis_list;

enum { MAX_AXES = 64 };

/* The lists of the grid: a group of lists, each its own bundle or with zip = true one for all, or a list of
 * groups, a bundle each. */
static rp_status find_lists(const head *h, const config_setting_t *grid, axis_list lists[MAX_AXES], size_t *n)
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
            lists[(*n)++] = (axis_list){element(group, (size_t)i), bundle};
        }
    }
    return RP_OK;
}

/* Find the axes of the grid and how many points they span. */
static rp_status read_axes(sweep_plan *plan, const axis_list lists[], size_t n_lists,
                           const config_setting_t *fixed)
{
    plan->n_axes = n_lists;
    plan->n_points = 1;
    plan->axes = calloc(plan->n_axes + 1, sizeof *plan->axes);
    if (!plan->axes) return rp_fail(RP_NO_MEMORY, "grid: out of memory");
    for (size_t a = 0; a < plan->n_axes; a++) {
        const config_setting_t *list = lists[a].list;
        const char *name = config_setting_name(list);
        rp_status status = find_param(plan->protocol, list, &plan->axes[a]);
        if (status) return status;
        for (size_t other = 0; other < a; other++)
            if (plan->axes[other] == plan->axes[a])
                return rp_config_fail(list, "%s: appears twice in the grid; keep one", name);
        rp_type type = plan->axes[a]->type;
        if (type == RP_FLAGS || type == RP_TEXT || type == RP_TEXTS)
            return rp_config_fail(list, "%s: cannot vary over a grid; set it under fixed", name);
        if (fixed && config_setting_get_member(fixed, name))
            return rp_config_fail(list, "%s: appears under fixed and under grid; keep one", name);
        if ((!config_setting_is_array(list) && !config_setting_is_list(list)) || length(list) == 0)
            return rp_config_fail(list, "%s: a list [ ... ] of one value or more expected", name);
        size_t n = (size_t)length(list);
        bool first = a == 0 || lists[a - 1].bundle != lists[a].bundle;
        if (!first && n != (size_t)length(lists[a - 1].list))
            return rp_config_fail(list,
                                  "%s: %zu values; lists that go together have the same number, %d as in %s",
                                  name, n, length(lists[a - 1].list), plan->axes[a - 1]->name);
        if (first) plan->n_points *= n;
        if (plan->n_points > MAX_RUNS / plan->replicas)
            return rp_config_fail(list, "%s: the grid has too many runs, allowed: %d", name, MAX_RUNS);
    }
    return RP_OK;
}

/* Fill in the parameters of every point, the first one holding those that are fixed. */
static rp_status expand(const char *file, sweep_plan *plan, const axis_list lists[])
{
    size_t size = plan->protocol->params_size;
    for (size_t i = plan->n_points; i-- > 0;) {
        char *values = plan->points + i * size;
        if (i > 0) memcpy(values, plan->points, size);
        for (size_t a = plan->n_axes, rest = i; a-- > 0;) {
            size_t n = (size_t)length(lists[a].list);
            rp_status status = rp_config_value(element(lists[a].list, rest % n), plan->axes[a], values);
            if (status) return status;
            if (a == 0 || lists[a - 1].bundle != lists[a].bundle) rest /= n;
        }
    }
    for (size_t i = 0; i < plan->n_points; i++) {
        char where[256];
        rp_status status = plan->protocol->check(sweep_plan_point(plan, i));
        if (status)
            return rp_prefix(status, "%s: %s%s: ", file, plan->n_axes ? "grid point " : "parameters",
                             sweep_plan_describe(plan, i, where, sizeof where));
    }
    return RP_OK;
}

static int compare_keys(const void *a, const void *b)
{
    return strcmp(*(const char *const *)a, *(const char *const *)b);
}

/* On shared piles, two grid points of the same parameters would be the same runs. */
static rp_status refuse_twins(const char *file, const sweep_plan *plan)
{
    const char **first = malloc(plan->n_points * sizeof *first);
    if (!first) return rp_fail(RP_NO_MEMORY, "%s: out of memory", file);
    for (size_t i = 0; i < plan->n_points; i++) first[i] = plan->keys[i * plan->replicas];
    qsort(first, plan->n_points, sizeof *first, compare_keys);
    rp_status status = RP_OK;
    char where[256];
    for (size_t i = 1; !status && i < plan->n_points; i++)
        if (strcmp(first[i - 1], first[i]) == 0)
            status =
                rp_fail(RP_BAD_INPUT,
                        "%s: grid point %s: appears twice in the grid, which needs piles = \"own\"", file,
                        sweep_plan_describe(
                            plan, (size_t)(first[i] - plan->keys[0]) / (plan->replicas * sizeof *plan->keys),
                            where, sizeof where));
    free(first);
    return status;
}

/* Part of every key: a stored run without a value of a new output is not reused. */
static XXH64_hash_t hash_outputs(const sweep_protocol *protocol)
{
    XXH64_hash_t hash = 0;
    for (const sweep_output *o = protocol->outputs; o->name; o++)
        hash = XXH3_64bits_withSeed(o->name, strlen(o->name), hash);
    return hash;
}

static rp_status make_keys(sweep_plan *plan)
{
    char model[96], fingerprint[33] = "";
    plan->n_runs = plan->n_points * plan->replicas;
    free(plan->keys);
    plan->keys = calloc(plan->n_runs, sizeof *plan->keys);
    if (!plan->keys) return rp_fail(RP_NO_MEMORY, "%zu runs: out of memory", plan->n_runs);
    rp_status status = plan->protocol->fingerprint ? plan->protocol->fingerprint(fingerprint) : RP_OK;
    snprintf(model, sizeof model, "%d %s %016llx", RP_MODEL_VERSION, fingerprint,
             (unsigned long long)hash_outputs(plan->protocol));
    for (size_t r = 0; !status && r < plan->n_runs; r++)
        rp_params_hash(plan->protocol->schema, sweep_plan_point(plan, r / plan->replicas), plan->seed,
                       sweep_plan_pile(plan, r), model, plan->keys[r]);
    return status;
}

rp_status sweep_plan_read(const char *file, const sweep_protocol *const *protocols, sweep_plan *plan)
{
    *plan = (sweep_plan){0};
    head h;
    rp_status status = rp_config_read(file, &plan->config);
    if (!status) status = rp_file_read(file, &plan->text);
    if (!status) status = refuse_includes(file, plan->text);
    if (status) return status;
    const config_setting_t *root = config_root_setting(&plan->config),
                           *fixed = config_setting_get_member(root, "fixed"),
                           *grid = config_setting_get_member(root, "grid");
    status = read_head(file, root, protocols, &h);
    if (status) return status;
    plan->protocol = protocols[h.protocol];
    plan->replicas = plan->block = (size_t)h.replicas;
    plan->seed = (unsigned long)h.seed;
    plan->shared_piles = h.piles == PILES_SHARED;
    axis_list lists[MAX_AXES];
    size_t n_lists;
    status = find_lists(&h, grid, lists, &n_lists);
    if (!status) status = read_axes(plan, lists, n_lists, fixed);
    if (status) return status;
    plan->points = calloc(plan->n_points, plan->protocol->params_size);
    if (!plan->points) return rp_fail(RP_NO_MEMORY, "%s: out of memory", file);
    status = read_fixed(plan, fixed, plan->points);
    if (!status) status = expand(file, plan, lists);
    if (!status) status = make_keys(plan);
    return status || !plan->shared_piles ? status : refuse_twins(file, plan);
}

rp_status sweep_plan_replicate(sweep_plan *plan, size_t replicas)
{
    if (replicas < 1 || replicas > MAX_RUNS / plan->n_points)
        return rp_fail(RP_BAD_INPUT, "replicas = %zu: out of range for %zu grid points, allowed: [1, %zu]",
                       replicas, plan->n_points, MAX_RUNS / plan->n_points);
    plan->replicas = replicas;
    return make_keys(plan);
}

void sweep_plan_free(sweep_plan *plan)
{
    free(plan->axes);
    free(plan->points);
    free(plan->keys);
    free(plan->text);
    config_destroy(&plan->config);
}

const void *sweep_plan_point(const sweep_plan *plan, size_t point)
{
    return plan->points + point * plan->protocol->params_size;
}

unsigned long sweep_plan_pile(const sweep_plan *plan, size_t run)
{
    const size_t point = run / plan->replicas, replica = run % plan->replicas;
    if (plan->shared_piles) return replica;
    /* blocks of the file's number of replicas, so that asking for more keeps the piles that there are */
    return (replica / plan->block * plan->n_points + point) * plan->block + replica % plan->block;
}

const char *sweep_plan_describe(const sweep_plan *plan, size_t point, char *buffer, size_t size)
{
    char text[64];
    size_t used = 0;
    buffer[0] = '\0';
    for (size_t a = 0; a < plan->n_axes && used < size; a++)
        used +=
            (size_t)snprintf(buffer + used, size - used, "%s%s = %s", a ? ", " : "", plan->axes[a]->name,
                             rp_params_text(plan->axes[a], sweep_plan_point(plan, point), text, sizeof text));
    return buffer;
}
