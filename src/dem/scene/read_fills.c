/* Reading the fills of a scene file, and radii alone. */
#include <math.h>

#include "dem/scene/file.h"
#include "dem/scene/radii.h"

/* radii = ( [r, share], ... ), of the law `table`. */
static rp_status read_radii(rp_arena *arena, const config_setting_t *group, dem_fill *f)
{
    const config_setting_t *list = member(group, "radii");
    double *radii;
    if ((list != NULL) != (f->law == DEM_RADII_TABLE))
        return rp_config_fail(list ? list : group, "radii: %s radius_law = \"table\"",
                              list ? "needs" : "missing, of");
    if (!list) return RP_OK;
    RP_NEW(arena, radii, 2 * length(list));
    for (size_t k = 0; k < length(list); k++) RP_TRY(rp_config_pair(element(list, k), &radii[2 * k]));
    f->radii = radii, f->n_radii = length(list);
    return RP_OK;
}

rp_status dem_text_radii(rp_arena *arena, const config_setting_t *group, const char *others,
                         const dem_fill *as, dem_fill *radii)
{
    bool given = member(group, "radii") != NULL;
    for (const rp_param *row = dem_radii_schema; row->name; row++) given |= member(group, row->name) != NULL;
    *radii = (dem_fill){0};
    rp_params_defaults(SCHEMA(FILL), rp_config_units(group), radii);
    if (as && !given) *radii = *as;
    RP_TRY(rp_config_group(group, dem_radii_schema, radii, others));
    if (given || !as) RP_TRY(read_radii(arena, group, radii));
    return dem_radii_check(radii) ? rp_config_fail(group, "%s", rp_message()) : RP_OK;
}

rp_status dem_peek_radii(rp_arena *arena, const config_setting_t *group, dem_fill *fill)
{
    *fill = (dem_fill){0};
    rp_params_defaults(SCHEMA(FILL), rp_config_units(group), fill);
    RP_TRY(rp_config_peek(group, SCHEMA(FILL),
                          "radius_mean radius_width radius_min radius_max radius_law by density", fill));
    if (fill->density < 0.0) RP_TRY(dem_peek_density(group, &fill->density));
    RP_TRY(read_radii(arena, group, fill));
    return fill->law == DEM_RADII_TABLE ? dem_radii_check(fill) : RP_OK;
}

static rp_status check_fill(const config_setting_t *group, const dem_scene *scene, const dem_fill *f)
{
    char pattern[16];
    rp_status status = dem_radii_check(f);
    if (!status && f->density < 0.0 && dem_density_of(scene, f->of_kind) == scene->laws.physics.density)
        status = dem_density_check(scene->laws.physics.shape, scene->def.units, scene->has_density);
    if (status) return rp_config_fail(group, "%s", rp_message());
    if (f->N < 0 && f->pattern == DEM_PATTERN_RANDOM)
        return rp_config_fail(group, "N: missing (number of grains)");
    if (f->spacing > 0.0 && f->pattern == DEM_PATTERN_RANDOM)
        return rp_config_fail(group, "spacing: of a row or a lattice");
    if (f->spacing > 0.0 && f->spacing < 2.0 * (1.0 - DEM_SPACING_OVERLAP) * dem_radius_most(f))
        return rp_config_fail(group, "spacing = %g: grains of radius %g overlap by more than a tenth",
                              f->spacing, dem_radius_most(f));
    if (f->H < 0.0 && f->pattern != DEM_PATTERN_ROW)
        return rp_config_fail(group, "H: missing (height of the region of a %s fill)",
                              rp_word_at(DEM_WORDS(DEM_PATTERNS), (int)f->pattern, pattern, sizeof pattern));
    return RP_OK;
}

static rp_status read_fill(const config_setting_t *group, dem_scene *scene, dem_fill *f)
{
    rp_arena *arena = &scene->arena;
    const config_setting_t *polygon = member(group, "polygon");
    double *corners = NULL;
    rp_params_defaults(SCHEMA(FILL), scene->def.units, f);
    RP_TRY(dem_read_kind(group, scene, &f->of_kind));
    RP_TRY(rp_config_group(group, SCHEMA(FILL), f, "radii polygon if"));
    RP_TRY(read_radii(arena, group, f));
    if (polygon) RP_TRY(dem_read_points(arena, polygon, 3, &f->n_corners, &corners));
    f->corners = corners;
    f->kind = f->of_kind > 0 ? scene->def.kinds[f->of_kind].name : "";
    RP_TRY(check_fill(group, scene, f));
    f->shape = scene->laws.physics.shape;
    if (f->density < 0.0) f->density = dem_density_of(scene, f->of_kind);
    if (f->H < 0.0) f->H = INFINITY;
    return RP_OK;
}

/* Number k of the fills that a text lists, whether they are there or not; NULL past the last. */
static const config_setting_t *fill_at(const config_setting_t *fill, size_t k)
{
    if (fill && config_setting_is_list(fill)) return element(fill, k);
    return k == 0 ? fill : NULL;
}

rp_status dem_next_fill(const config_setting_t *root, size_t *k, const config_setting_t **next)
{
    const config_setting_t *fill = member(root, "fill");
    bool wanted = false;
    while (!wanted && (*next = fill_at(fill, (*k)++))) {
        RP_TRY(dem_is_wanted(*next, &wanted));
        wanted &= config_setting_is_group(*next);
    }
    return RP_OK;
}

rp_status dem_read_fills(const config_setting_t *fill, dem_scene *scene)
{
    const config_setting_t *group;
    dem_fill *fills;
    bool wanted;
    if (!fill_at(fill, 0))
        return rp_config_fail(fill, "fill: a group { ... }, or a list of one or more, expected");
    RP_NEW(&scene->arena, fills, config_setting_is_list(fill) ? length(fill) : 1);
    for (size_t k = 0; (group = fill_at(fill, k)); k++) {
        if (!config_setting_is_group(group)) return rp_config_fail(group, "fill: a group { ... } expected");
        RP_TRY(dem_is_wanted(group, &wanted));
        if (!wanted) continue;
        scene->fills = fills;
        RP_TRY(read_fill(group, scene, &fills[scene->n_fills]));
        fills[scene->n_fills].number = (long)scene->n_fills;
        scene->n_fills++;
    }
    return RP_OK;
}
