/* The laws of a scene file, and those that it changes to later. */
#include <string.h>

#include "dem/scene/file.h"
#include "dem/setup/definition.h"

static rp_status read_material(const config_setting_t *material, dem_scene *scene)
{
    dem_physics *p = &scene->laws.physics;
    RP_TRY(rp_config_group(material, SCHEMA(MATERIAL), scene, NULL));
    const double E[2] = {scene->E, scene->E}, nu[2] = {scene->nu, scene->nu};
    p->normal = DEM_BODIES_NORMAL, p->tangential = DEM_BODIES_TANGENTIAL, p->tension = false;
    dem_elastic_contact(E, nu, &p->k_n, &p->k_s);
    return RP_OK;
}

rp_status dem_read_physics(const config_setting_t *root, dem_scene *scene)
{
    const config_setting_t *material = member(root, "material"), *normal = member(root, "normal"),
                           *tangential = member(root, "tangential");
    dem_definition *def = &scene->def;
    dem_physics *p = &scene->laws.physics;
    if (material) RP_TRY(read_material(material, scene));
    if (normal && scene->E > 0.0 && (member(normal, "law") || member(normal, "k_n")))
        return rp_config_fail(normal, "normal: law and k_n follow from material; keep one of the two");
    if (tangential && material && (member(tangential, "law") || member(tangential, "k_s")))
        return rp_config_fail(
            tangential, "tangential: law \"mindlin\" and k_s follow from material; keep one of the two");
    dem_physics_apply(p, def);
    const config_setting_t *at = NULL; /* the first that needs what another has */
    for (int k = NORMAL; k <= ROLLING; k++) {
        const config_setting_t *group = member(root, dem_scene_schemas[k].name);
        if (!group) continue;
        RP_TRY(rp_config_group(group, SCHEMA(k), p, NULL));
        dem_physics_apply(p, def);
        if (!at && dem_material_check(def, &def->material)) at = group;
    }
    return at && dem_material_check(def, &def->material) ? rp_config_fail(at, "%s", rp_message()) : RP_OK;
}

void dem_ends_apply(const dem_scene_laws *laws, dem_definition *def)
{
    def->x_min = dem_lower_end(laws->x_min), def->x_max = laws->x_max,
    def->y_min = dem_lower_end(laws->y_min);
}

rp_status dem_laws_apply(const dem_scene_laws *laws, const dem_material *given, dem_scene *scene,
                         dem_definition *def, dem_wall *walls)
{
    *def = scene->def;
    dem_physics_apply(&laws->physics, def);
    dem_ends_apply(laws, def);
    memcpy(walls, dem_walls_of(&scene->def), scene->def.n_walls * sizeof *walls);
    for (size_t w = 0; w < scene->def.n_walls; w++) {
        walls[w].material = dem_material_of_wall(scene, laws, 0, w, &given[w]);
        RP_TRY(rp_prefix(dem_material_check(def, &walls[w].material), "wall %zu: ", w + 1));
    }
    def->wall_list = walls;
    return dem_mix_kinds(scene, laws, given, def);
}

rp_status dem_text_laws(const config_setting_t *group, dem_scene *scene, dem_scene_laws *laws)
{
    dem_scene changed = {.def = scene->def, .laws = *laws, .E = scene->E};
    RP_TRY(rp_config_peek(group, SCHEMA(TOP), "dt x_min x_max y_min", &changed));
    RP_TRY(dem_read_physics(group, &changed));
    *laws = changed.laws;
    return dem_read_kinds(group, true, scene, laws);
}

rp_status dem_text_coefficients(const config_setting_t *group, const char *others, bool *some,
                                dem_material *given)
{
    RP_TRY(rp_config_group(group, dem_coefficient_schema, given, others));
    for (const rp_param *row = dem_coefficient_schema; row->name; row++)
        *some |= member(group, row->name) != NULL;
    return RP_OK;
}
