/* The physical parameters, from what is given to a definition; see physics.h. */
#include "dem/definition.h"

static const rp_param schema[] = {
#define ROW(...) DEM_NAME_ROW(dem_physics, , __VA_ARGS__)
    DEM_PHYSICS(ROW){0}};

dem_physics dem_physics_default(void)
{
    dem_physics p;
    rp_params_defaults(schema, &p);
    return p;
}

void dem_physics_apply(const dem_physics *p, dem_definition *def)
{
    dem_material *m = &def->material;
#define SCENE_VALUE(kind, name, ...) DEM_IF_SCENE(kind, def->name = p->name;)
    DEM_PHYSICS(SCENE_VALUE)
    /* in the order of the list: a value may depend on those before it */
#define MATERIAL_VALUE(kind, name, key, unit, type, fallback, range, further, value, ...)                    \
    DEM_IF_MATERIAL(kind, m->name = p->name; if (m->name < 0.0) m->name = value;)
    DEM_PHYSICS(MATERIAL_VALUE)
}

dem_physics dem_physics_of(const dem_definition *def, double density)
{
    dem_physics p = {.density = density};
    const dem_material *m = &def->material;
#define SCENE_OF(kind, name, ...) DEM_IF_SCENE(kind, p.name = def->name;)
    DEM_PHYSICS(SCENE_OF)
#define MATERIAL_OF(kind, name, ...) DEM_IF_MATERIAL(kind, p.name = m->name;)
    DEM_PHYSICS(MATERIAL_OF)
    return p;
}

#define AUTO(kind, name, ...) DEM_IF_MATERIAL(kind, .name = -1.0, )
const dem_material dem_material_auto = {DEM_PHYSICS(AUTO)};

dem_material dem_wall_material(const dem_material *given, const dem_material *grains)
{
    dem_material m;
#define WALL_VALUE(kind, name, key, unit, type, fallback, range, further, value, wall, ...)                  \
    DEM_IF_MATERIAL(kind, m.name = given->name < 0.0 ? (wall)*grains->name : given->name;)
    DEM_PHYSICS(WALL_VALUE)
    return m;
}

rp_status dem_material_check(const dem_definition *def, const dem_material *m)
{
    if (!dem_has_friction(def->tangential) && m->mu > 0.0)
        return rp_fail(RP_BAD_INPUT, "mu = %g: needs a tangential law, as spring", m->mu);
    if (!dem_has_friction(def->tangential) && m->mu_roll > 0.0)
        return rp_fail(RP_BAD_INPUT, "mu_roll = %g: needs a tangential law, as spring", m->mu_roll);
    if (!def->rotation && m->mu_roll > 0.0)
        return rp_fail(RP_BAD_INPUT, "mu_roll = %g: needs rotation = true", m->mu_roll);
    return RP_OK;
}

rp_status dem_physics_check(const dem_definition *def)
{
    rp_status status = dem_scheme_check(def);
    return status ? status : dem_material_check(def, &def->material);
}

rp_status dem_radius_check(double mean, double least, double most)
{
    return least <= mean && mean <= most
               ? RP_OK
               : rp_fail(RP_BAD_INPUT,
                         "radius_mean = %g: must lie between radius_min = %g and radius_max = %g", mean,
                         least, most);
}
