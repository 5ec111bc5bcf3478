/* Writing scene files, and texts with the values that were given. */
#include <math.h>
#include <string.h>

#include "dem/scene/file.h"
#include "dem/state/method.h"

static void write_pair(FILE *out, const char *key, const double pair[2])
{
    fprintf(out, "%s = (", key);
    for (int k = 0; k < 2; k++) /* libconfig has no infinity, expressions have; its -0 is whole and 0 */
        fprintf(out,
                isinf(pair[k])                            ? "%s \"%g\""
                : pair[k] == 0.0 && signbit(pair[k]) != 0 ? "%s %.1f"
                                                          : "%s %.17g",
                k ? "," : "", pair[k]);
    fputs(" ); ", out);
}

static void write_group(FILE *out, int group, const void *values)
{
    fprintf(out, "%s = { ", dem_scene_schemas[group].name);
    rp_config_write(out, SCHEMA(group), values);
    fputs("};\n", out);
}

static void write_top(FILE *out, const dem_scene *scene)
{
    const dem_definition *def = &scene->def;
    const double density = scene->fills ? scene->fills->density : dem_physics_default(def->units).density;
    dem_scene file = {.def = *def,
                      .steps = scene->steps,
                      .laws = {dem_physics_of(def, density), dem_lower_end(def->x_min), def->x_max,
                               dem_lower_end(def->y_min)},
                      .turn_deg = def->turn_per_step * (180.0 / M_PI),
                      .box_turn_deg = def->box_turn_per_step * (180.0 / M_PI),
                      .particles_file = "",
                      .particles_step = -1,
                      .contacts_file = ""};
    if (def->skin == 0.0) file.def.skin = -1.0;
    if (scene->fills) file.laws.physics.shape = scene->fills->shape;
    write_pair(out, "gravity", def->gravity);
    rp_config_write(out, SCHEMA(TOP), &file);
    fputc('\n', out);
}

static void write_walls(FILE *out, const dem_scene *scene)
{
    const dem_definition *def = &scene->def;
    fputs("walls = (", out);
    for (size_t w = 0; w < def->n_walls; w++) {
        const dem_wall *wall = &dem_walls_of(def)[w];
        dem_wall_entry entry = {.line = *wall};
        fputs(w ? ",\n  { " : "\n  { ", out);
        if (scene->names && *scene->names[w]) fprintf(out, "name = \"%s\"; ", scene->names[w]);
        write_pair(out, "point", wall->point);
        write_pair(out, "direction", wall->direction);
        if (!dem_wall_is_line(wall)) write_pair(out, "extent", wall->extent);
        if (dem_wall_moves(wall)) write_pair(out, "velocity", wall->velocity);
        if (wall->pivot[0] != 0.0 || wall->pivot[1] != 0.0) write_pair(out, "pivot", wall->pivot);
        rp_config_write(out, SCHEMA(WALLS) + SHAPE_ROWS, &entry);
        fputs("}", out);
    }
    fputs(" );\n", out);
}

static void write_particles(FILE *out, const dem_scene *scene)
{
    fputs("particles = (", out);
    for (size_t i = 0; i < scene->def.n_grains; i++) {
        fputs(i ? ",\n  { " : "\n  { ", out);
        rp_config_write(out, SCHEMA(PARTICLES), &scene->grains[i]);
        fputs("}", out);
    }
    fputs(" );\n", out);
}

/* A fill: the rows that it always had, then those that are not at their defaults, so that a new one leaves
 * keys as they are. */
static void write_fill(FILE *out, rp_units units, const dem_fill *fill, double density)
{
    dem_fill plain;
    char is[512], was[512];
    rp_params_defaults(SCHEMA(FILL), units, &plain);
    plain.density = density;
    for (const rp_param *row = SCHEMA(FILL); row->name; row++) {
        rp_params_text(row, fill, is, sizeof is), rp_params_text(row, &plain, was, sizeof was);
        const bool always = row < rp_params_find(SCHEMA(FILL), "radius_law");
        if (always || strcmp(is, was) != 0) rp_config_write(out, (const rp_param[]){*row, {0}}, fill);
    }
}

static void write_points(FILE *out, const char *key, size_t n, const double points[])
{
    if (n > 0) fprintf(out, "%s = (", key);
    for (size_t i = 0; i < n; i++)
        fprintf(out, "%s( %.17g, %.17g )", i ? ", " : " ", points[2 * i], points[2 * i + 1]);
    if (n > 0) fputs(" ); ", out);
}

static void write_fills(FILE *out, const dem_scene *scene)
{
    const bool many = scene->n_fills > 1;
    fputs(many ? "fill = (\n" : "fill = ", out);
    for (size_t k = 0; k < scene->n_fills; k++) {
        dem_fill fill = scene->fills[k];
        if (k == 0) fill.seed = scene->seed, fill.run = scene->run;
        if (isinf(fill.H)) fill.H = -1.0;
        if (!(fill.spacing > 0.0)) fill.spacing = -1.0;
        fputs(k ? ",\n{ " : "{ ", out);
        write_fill(out, scene->def.units, &fill, scene->fills->density);
        write_points(out, "radii", fill.n_radii, fill.radii);
        write_points(out, "polygon", fill.n_corners, fill.corners);
        fputs("}", out);
    }
    fputs(many ? " );\n" : ";\n", out);
}

void dem_scene_write(const dem_scene *scene, FILE *out)
{
    const dem_definition *def = &scene->def;
    const dem_physics physics = dem_physics_of(def, 0.0);
    write_top(out, scene);
    for (int k = NORMAL; k <= ROLLING; k++) write_group(out, k, &physics);
    write_walls(out, scene);
    if (def->ground.wall) write_group(out, GROUND, &def->ground);
    if (def->hard.on) write_group(out, HARD, &def->hard);
    if (dem_schemes[def->integrator]->solves) write_group(out, IMPLICIT, &def->implicit);
    if (scene->fills) write_fills(out, scene);
    if (scene->grains) write_particles(out, scene);
}

void dem_text_write(const dem_text *text, unsigned long seed, unsigned long stream, FILE *out)
{
    const config_setting_t *root = config_root_setting(&text->config);
    fprintf(out, "seed = %lu;\nrun = %lu;\n", seed, stream);
    for (size_t i = 0; i < length(root); i++) {
        const config_setting_t *s = element(root, i);
        const char *name = config_setting_name(s);
        const bool let = strcmp(name, "let") == 0;
        if (strcmp(name, "seed") == 0 || strcmp(name, "run") == 0) continue;
        fprintf(out, let ? "%s = {\n" : "%s = ", name);
        for (size_t k = 0; k < length(s) && let; k++) {
            fprintf(out, "  %s = ", config_setting_name(element(s, k)));
            rp_config_write_value(out, element(s, k));
            fputs(";\n", out);
        }
        let ? (void)fputc('}', out) : rp_config_write_value(out, s);
        fputs(";\n", out);
    }
}
