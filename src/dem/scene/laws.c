/* The laws of a scene file, and those that it changes to later. */
#include <string.h>

#include "dem/scene/file.h"
#include "dem/setup/definition.h"

static rp_status read_material(const config_setting_t *material, dem_scene_file *file)
{
    dem_physics *p = &file->physics;
    RP_TRY(rp_config_group(material, SCHEMA(MATERIAL), file, NULL));
    const double E[2] = {file->scene.E, file->scene.E}, nu[2] = {file->scene.nu, file->scene.nu};
    p->normal = DEM_ELASTIC, p->tension = false;
    p->tangential = DEM_MINDLIN, p->damping = DEM_DAMPING_INSIDE;
    dem_elastic_contact(E, nu, &p->k_n, &p->k_s);
    return RP_OK;
}

rp_status dem_read_physics(const config_setting_t *root, dem_scene_file *file, dem_definition *def)
{
    const config_setting_t *material = member(root, "material");
    if (material) RP_TRY(read_material(material, file));
    dem_physics_apply(&file->physics, def);
    for (int k = NORMAL; k <= ROLLING; k++) {
        const config_setting_t *group = member(root, dem_scene_schemas[k].name);
        if (!group) continue;
        RP_TRY(rp_config_group(group, SCHEMA(k), &file->physics, NULL));
        dem_physics_apply(&file->physics, def);
        if (dem_material_check(def, &def->material)) return rp_config_fail(group, "%s", rp_message());
    }
    return RP_OK;
}

rp_status dem_laws_apply(const dem_scene_laws *laws, const dem_material *given, const dem_scene *scene,
                         dem_definition *def, dem_wall *walls)
{
    *def = scene->def;
    dem_physics_apply(&laws->physics, def);
    def->x_min = laws->ends[0], def->x_max = laws->ends[1], def->y_min = laws->ends[2];
    memcpy(walls, dem_walls_of(&scene->def), scene->def.n_walls * sizeof *walls);
    for (size_t w = 0; w < scene->def.n_walls; w++) {
        walls[w].material = dem_wall_material(&given[w], &def->material);
        RP_TRY(rp_prefix(dem_material_check(def, &walls[w].material), "wall %zu: ", w + 1));
    }
    def->wall_list = walls;
    return RP_OK;
}

rp_status dem_text_laws(const config_setting_t *group, const dem_scene *scene, dem_scene_laws *laws)
{
    dem_definition def = scene->def;
    dem_scene_file file = {.physics = laws->physics,
                           .x_min = dem_lower_end(laws->ends[0]),
                           .scene.def.x_max = laws->ends[1],
                           .y_min = dem_lower_end(laws->ends[2])};
    RP_TRY(rp_config_peek(group, SCHEMA(TOP), "dt x_min x_max y_min", &file));
    RP_TRY(dem_read_physics(group, &file, &def));
    *laws = (dem_scene_laws){file.physics,
                             {dem_lower_end(file.x_min), file.scene.def.x_max, dem_lower_end(file.y_min)}};
    return RP_OK;
}

rp_status dem_text_coefficients(const config_setting_t *group, const char *others, bool *some,
                                dem_material *given)
{
    RP_TRY(rp_config_group(group, dem_coefficient_schema, given, others));
    for (const rp_param *row = dem_coefficient_schema; row->name; row++)
        *some |= member(group, row->name) != NULL;
    return RP_OK;
}
