/* Reading the walls of a scene file. */
#include <math.h>
#include <string.h>

#include "core/elementary.h"
#include "dem/scene/file.h"
#include "dem/setup/definition.h"

/* Add a wall to those of the scene, which have room, once its place is known; its coefficients are those that
 * are given. */
static rp_status add_wall(const dem_wall_entry *entry, dem_wall wall, dem_scene *scene)
{
    dem_definition *def = &scene->def;
    const size_t n = def->n_walls++;
    /* of a segment that opens, here or in a phase, the lower end in space is the upper along its tangent:
     * turn it round; a level one opens from its first end */
    if (isfinite(wall.open_speed) && wall.direction[0] > 0.0 && !dem_wall_is_line(&wall)) {
        memcpy(wall.extent, (double[]){-wall.extent[1], -wall.extent[0]}, sizeof wall.extent);
        for (int c = 0; c < 2; c++) wall.direction[c] = -wall.direction[c];
    }
    scene->given[n] = wall.material;
    scene->names[n] = entry->name;
    memcpy(scene->bodies[n], (double[]){entry->E, entry->nu}, sizeof scene->bodies[n]);
    wall.material = dem_material_of_wall(scene, &scene->laws, 0, n, &wall.material);
    rp_status status = dem_wall_check(&wall);
    if (!status) status = dem_material_check(def, &wall.material);
    ((dem_wall *)def->wall_list)[n] = wall;
    return status ? rp_config_fail(entry->setting, "%s", rp_message()) : RP_OK;
}

static rp_status read_line(const config_setting_t *setting, dem_wall *wall)
{
    const config_setting_t *point = member(setting, "point"), *direction = member(setting, "direction"),
                           *extent = member(setting, "extent");
    if (!point || !direction)
        return rp_config_fail(setting, "%s: missing (or polygon, or circle)", point ? "direction" : "point");
    RP_TRY(rp_config_pair(point, wall->point));
    RP_TRY(rp_config_pair(direction, wall->direction));
    const double norm = rp_hypot(wall->direction[0], wall->direction[1]);
    if (!(norm > 0.0)) return rp_config_fail(direction, "direction = [0, 0]: must not be 0");
    if (fabs(norm - 1.0) >= 1e-9) /* one of length 1 stays as it is to the bit */
        wall->direction[0] /= norm, wall->direction[1] /= norm;
    return extent ? rp_config_numbers(extent, 2, false, wall->extent) : RP_OK;
}

/* The sides through the points, with the direction on the left of the way along them. */
static rp_status add_sides(const dem_wall_entry *entry, dem_scene *scene)
{
    const size_t n = entry->n_points;
    for (size_t i = 0; i < (entry->closed ? n : n - 1); i++) {
        const double *p = &entry->points[2 * i], *q = &entry->points[2 * ((i + 1) % n)];
        const double dx = q[0] - p[0], dy = q[1] - p[1], length = rp_hypot(dx, dy);
        if (!(length > 0.0) || !isfinite(length))
            return rp_config_fail(entry->setting, "polygon: points %zu and %zu are [%g, %g]: no side", i + 1,
                                  (i + 1) % n + 1, p[0], p[1]);
        dem_wall wall = entry->line;
        memcpy(wall.point, p, sizeof wall.point);
        wall.direction[0] = -dy / length, wall.direction[1] = dx / length;
        wall.extent[0] = 0.0, wall.extent[1] = length;
        RP_TRY(add_wall(entry, wall, scene));
    }
    return RP_OK;
}

/* `circle = [x, y, radius]`: points on the circle, counter-clockwise; its pivot is its centre. */
static rp_status read_circle(rp_arena *arena, const config_setting_t *circle, dem_wall_entry *entry)
{
    double c[3];
    RP_TRY(rp_config_numbers(circle, 3, true, c));
    if (!(c[2] > 0.0)) return rp_config_fail(circle, "circle: radius = %g: must be above 0", c[2]);
    memcpy(entry->line.pivot, c, sizeof entry->line.pivot);
    entry->n_points = (size_t)entry->sides, entry->closed = true;
    RP_NEW(arena, entry->points, 2 * entry->n_points);
    for (size_t i = 0; i < entry->n_points; i++) {
        const double angle = 2.0 * M_PI * ((double)i + 0.5) / (double)entry->n_points; /* a side below */
        entry->points[2 * i] = c[0] + c[2] * rp_sin(angle);
        entry->points[2 * i + 1] = c[1] - c[2] * rp_cos(angle);
    }
    return RP_OK;
}

/* Has a wall a material of its own, it is one of elastic bodies. */
static rp_status check_material(const config_setting_t *setting, const dem_scene *scene,
                                const dem_wall_entry *wall)
{
    const dem_material *m = &wall->line.material;
    if (!(scene->E > 0.0) && (wall->E > 0.0 || wall->nu >= 0.0))
        return rp_config_fail(setting, "E, nu: of a wall need the grains' in material = { E; nu; ... }");
    return wall->E > 0.0 && (m->k_n >= 0.0 || m->k_s >= 0.0)
               ? rp_config_fail(setting, "E and k_n or k_s of a wall; keep one")
               : RP_OK;
}

/* An entry, whose points stay in the arena. */
static rp_status read_entry(rp_arena *arena, const config_setting_t *setting, dem_scene *scene,
                            dem_wall_entry *entry)
{
    static const char *const of_line[] = {"point", "direction", "extent"};
    *entry = (dem_wall_entry){.line.extent = {-INFINITY, INFINITY}};
    rp_params_defaults(SCHEMA(WALLS), scene->def.units, entry);
    RP_TRY(rp_config_group(setting, SCHEMA(WALLS), entry, dem_wall_others));
    RP_TRY(dem_read_name(&scene->arena, setting, "name", &entry->name));
    RP_TRY(check_material(setting, scene, entry));
    const config_setting_t *polygon = member(setting, "polygon"), *circle = member(setting, "circle"),
                           *velocity = member(setting, "velocity"), *pivot = member(setting, "pivot");
    entry->setting = polygon ? polygon : circle ? circle : setting;
    for (int k = 0; k < 3 && (polygon || circle); k++)
        if (member(setting, of_line[k]) || (polygon && circle))
            return rp_config_fail(setting, "a wall has one of point, polygon and circle");
    RP_TRY(polygon  ? dem_read_points(arena, polygon, entry->closed ? 3 : 2, &entry->n_points, &entry->points)
           : circle ? read_circle(arena, circle, entry)
                    : read_line(setting, &entry->line));
    if (velocity) RP_TRY(rp_config_pair(velocity, entry->line.velocity));
    return pivot ? rp_config_pair(pivot, entry->line.pivot) : RP_OK;
}

rp_status dem_read_walls(const config_setting_t *root, dem_scene *scene)
{
    const config_setting_t *list = member(root, "walls");
    dem_definition *def = &scene->def;
    dem_wall_entry *entries;
    dem_wall *walls;
    enum { MOST_WALLS = 10000 }; /* their ends are compared with one another */
    size_t most = 0;
    RP_SCOPE(arena);
    if (!list) return RP_OK;
    if (!config_setting_is_list(list)) return rp_config_fail(list, "walls: a list ( { ... } ) expected");
    RP_NEW(&arena, entries, length(list));
    for (size_t i = 0; i < length(list); i++) {
        RP_TRY(read_entry(&arena, element(list, i), scene, &entries[i]));
        most += entries[i].points ? entries[i].n_points : 1;
    }
    if (most > MOST_WALLS)
        return rp_config_fail(list, "walls: %zu lines and sides; at most %d", most, MOST_WALLS);
    RP_NEW(&scene->arena, walls, most);
    RP_NEW(&scene->arena, scene->given, most);
    RP_NEW(&scene->arena, scene->names, most);
    RP_NEW(&scene->arena, scene->bodies, most);
    def->wall_list = walls;
    for (const dem_wall_entry *e = entries; e < entries + length(list); e++)
        RP_TRY(e->points ? add_sides(e, scene) : add_wall(e, e->line, scene));
    if (def->n_walls > DEM_FEW_WALLS) return RP_OK;
    memcpy(def->walls, walls, def->n_walls * sizeof *walls);
    def->wall_list = NULL;
    return RP_OK;
}
