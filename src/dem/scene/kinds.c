/* Kinds of grains in a scene file: their numbers. */
#include <string.h>

#include "dem/scene/file.h"

rp_status dem_number_kind(dem_scene *scene, const char *name, uint32_t *number)
{
    dem_definition *def = &scene->def;
    const size_t n = def->n_kinds > 0 ? def->n_kinds : 1;
    dem_kind *kinds;
    for (*number = 0; *number < n; ++*number)
        if (strcmp(*number ? def->kinds[*number].name : "", name) == 0) return RP_OK;
    if (n == DEM_MOST_KINDS) return rp_fail(RP_BAD_INPUT, "kind = \"%s\": one of more than %zu", name, n);
    if ((n & (n - 1)) == 0) { /* a power of two: the room is full */
        RP_NEW(&scene->arena, kinds, 2 * n);
        if (def->kinds) memcpy(kinds, def->kinds, n * sizeof *kinds);
        def->kinds = kinds;
    }
    strcpy(((dem_kind *)def->kinds)[n].name, name);
    def->n_kinds = n + 1;
    return RP_OK;
}

rp_status dem_read_kind(const config_setting_t *group, dem_scene *scene, uint32_t *number)
{
    const config_setting_t *kind = member(group, "kind");
    const char *name = kind ? config_setting_get_string(kind) : "";
    if (!name) return rp_config_fail(kind, "kind: a name expected");
    RP_TRY(dem_read_name(&scene->arena, group, "kind", &name));
    return dem_number_kind(scene, name, number) ? rp_config_fail(kind, "%s", rp_message()) : RP_OK;
}

/* Of the grains that phases add. */
static rp_status number_added(const config_setting_t *phases, dem_scene *scene)
{
    for (size_t i = 0; phases && config_setting_is_list(phases) && i < length(phases); i++) {
        const config_setting_t *phase = element(phases, i);
        if (!config_setting_is_group(phase)) continue;
        const config_setting_t *add = member(phase, "add");
        if (add && config_setting_is_group(add)) RP_TRY(dem_read_kind(add, scene, &(uint32_t){0}));
        RP_TRY(number_added(member(phase, "phases"), scene));
    }
    return RP_OK;
}

rp_status dem_read_kinds(const config_setting_t *root, dem_scene *scene)
{
    return number_added(member(root, "phases"), scene);
}
