/* What the readers and the writer of a scene file share. */
#ifndef DEM_SCENE_FILE_H
#define DEM_SCENE_FILE_H

#include "dem/scene/text.h"
#include "params/config.h"
#include "params/settings.h"

/* What it says of a wall: one wall, or a polygon or circle of several. */
typedef struct {
    dem_wall line;
    long sides;
    bool closed;
    const char *name;
    double E, nu;
    const config_setting_t *setting; /* for messages on its place */
    size_t n_points;                 /* of a polygon or circle: x and y of each */
    double *points;
} dem_wall_entry;

/* The groups of dem_scene_schemas, and schemas of some keys of them: a wall's coefficients as given, in a
 * dem_material; what tells the radii of a dem_fill. */
enum {
    TOP,
    NORMAL,
    TANGENTIAL,
    ROLLING,
    MATERIAL,
    WALLS,
    GROUND,
    HARD,
    IMPLICIT,
    OUTPUT,
    PARTICLES,
    KINDS,
    PAIRS,
    FILL
};
extern const char dem_scene_others[],
    dem_wall_others[]; /* keys of the file, of a wall, beside the schema's */
#define SCHEMA(group) dem_scene_schemas[group].schema
extern const rp_param dem_coefficient_schema[], dem_radii_schema[];
/* The first rows of a wall are of entries: their sides are written as segments, each with the name. */
enum { SHAPE_ROWS = 5 };

/* An end that takes out grains below it: "none" is above all numbers in a file, below them in a definition;
 * either from the other. */
static inline double dem_lower_end(double end)
{
    return isinf(end) ? -end : end;
}

/* Put the ends of laws into a definition. */
void dem_ends_apply(const dem_scene_laws *laws, dem_definition *def);

/* A group that may be missing, or left out by its condition; its values then stay as they are. */
rp_status dem_read_group(const config_setting_t *root, int number, void *values, bool *there);

/* Is a group there, or left out by its condition? */
rp_status dem_is_wanted(const config_setting_t *group, bool *wanted);

/* A name of the file, "" for none, which is kept in the arena. */
bool dem_is_name(const char *text);
rp_status dem_read_name(rp_arena *arena, const config_setting_t *setting, const char *key, const char **name);

/* `polygon = ( [x, y], ... )`, as a new array. */
rp_status dem_read_points(rp_arena *arena, const config_setting_t *list, size_t least, size_t *n,
                          double **points);

/* The groups of the contacts' parameters that stand in a text, over those that are there. */
rp_status dem_read_physics(const config_setting_t *root, dem_scene *scene);

/* The number of a kind by its name, "" for none; a new one comes to the scene's. Those of the grains that
 * phases add. */
rp_status dem_number_kind(dem_scene *scene, const char *name, uint32_t *number);
rp_status dem_number_added(const config_setting_t *phases, dem_scene *scene);

/* What a group says of kinds and of pairs, over what holds; `known`: these kinds alone. */
rp_status dem_read_kinds(const config_setting_t *group, bool known, dem_scene *scene, dem_scene_laws *laws);

/* The coefficients of a wall for grains of a kind, 0 for the scene's, as it and the kind are given. */
dem_material dem_material_of_wall(const dem_scene *scene, const dem_scene_laws *laws, size_t kind,
                                  size_t wall, const dem_material *given);

/* The pairs of a definition, as kinds, pairs and the walls are given; NULL where no kind has coefficients of
 * its own. Errors: RP_BAD_INPUT. */
rp_status dem_mix_kinds(dem_scene *scene, const dem_scene_laws *laws, const dem_material *given,
                        dem_definition *def);

/* The density of grains of a kind; that which the kind in a group of the file says, else 0. */
double dem_density_of(const dem_scene *scene, size_t kind);
rp_status dem_peek_density(const config_setting_t *group, double *density);

rp_status dem_read_walls(const config_setting_t *root, dem_scene *scene);
rp_status dem_read_fills(const config_setting_t *fill, dem_scene *scene);
rp_status dem_read_grains(const char *path, const config_setting_t *root, dem_scene *scene);
rp_status dem_read_table(const char *path, dem_scene *scene); /* of particles_file */

/* Is a text a dump or data file of LAMMPS? Its grains, as scene->grains and their lines; a mass that it does
 * not give stays "auto". `path` is for messages. */
bool dem_is_lammps(const char *text);
rp_status dem_read_lammps(rp_arena *arena, const char *path, char *text, dem_scene *scene);

/* The next fill that is there, from *k on, and the first group `add` of phases; NULL: none. What tells the
 * radii and the density of a fill. */
rp_status dem_next_fill(const config_setting_t *root, size_t *k, const config_setting_t **next);
const config_setting_t *dem_first_add(const config_setting_t *phases);
rp_status dem_peek_radii(rp_arena *arena, const config_setting_t *group, dem_fill *fill);

/* What d, m, g and dt are in a file's expressions, and dt_limit; for lets whose host is the dem_text. */
rp_status dem_know(void *host, rp_let_constant which, double *value);
rp_status dem_call(void *host, const char *name, int n, const double args[], double *value, bool *known);

/* Does what the text requires of its lets hold? Errors: RP_BAD_INPUT. */
rp_status dem_check_required(const dem_text *text);

#endif
