/* A scene file as a text: read once, and made a scene with one set of values of its names, or with another.
 */
#ifndef DEM_TEXT_H
#define DEM_TEXT_H

#include <libconfig.h>

#include "dem/scene/scene.h"
#include "params/lets.h"

typedef struct {
    const char *path; /* borrowed */
    config_t config;
    rp_lets lets;
} dem_text;

/* Read a file, or bytes that are there, and the changes of it, of which those of a let are given to the lets.
 * Afterwards dem_text_close, also after an error. Errors:
 * RP_BAD_INPUT. */
rp_status dem_text_open(const char *name, const char *bytes, const rp_texts *changes, dem_text *text);
void dem_text_close(dem_text *text);

/* Change a key, as --set does. Errors: RP_BAD_INPUT. */
rp_status dem_text_change(dem_text *text, const char *change);

/* Write the text with the values that its lets were given, and these streams; without comments. Nothing is
 * written where the values are in other units than the text. */
void dem_text_write(const dem_text *text, unsigned long seed, unsigned long stream, FILE *out);

/* Physical parameters by the names that sweeps have for them (dem/law/parameters.h), and the keys of a scene
 * file that they stand for; ended by a NULL name. Their offsets are in no structure. */
typedef struct {
    rp_param param;
    const char *key;
} dem_named_key;
extern const dem_named_key dem_named_keys[];

/* The groups of a scene that know a key, as of rp_lets. */
bool dem_place(const char *key, char text[RP_PLACE_BYTES]);

/* Give a let a value instead of its own; another reading takes it. Errors: RP_BAD_INPUT (no such let). */
rp_status dem_text_give(dem_text *text, const char *name, const rp_value *value);

/* Make the scene, with the lets as given; phases, measures and regions are left to the caller. Afterwards
 * dem_scene_free, also after an error. Errors: those of dem_scene_read. */
rp_status dem_text_scene(dem_text *text, dem_scene *scene);

/* The keys dt, x_min, x_max, y_min, normal, tangential, rolling, kinds and pairs of a group, over the laws
 * that hold so far. Errors: RP_BAD_INPUT. */
rp_status dem_text_laws(const config_setting_t *group, dem_scene *scene, dem_scene_laws *laws);

/* The definition and walls that follow from laws and the walls' coefficients as given; the definition borrows
 * the walls, of which there are as many as the scene's. Errors: RP_BAD_INPUT. */
rp_status dem_laws_apply(const dem_scene_laws *laws, const dem_material *given, dem_scene *scene,
                         dem_definition *def, dem_wall *walls);

/* The coefficients of a wall in a group, beside other keys; *some: there is one. Errors: RP_BAD_INPUT. */
rp_status dem_text_coefficients(const config_setting_t *group, const char *others, bool *some,
                                dem_material *given);

/* The number of the kind that the key `kind` of a group names, 0 without one; a new one comes to the scene's.
 * Errors: RP_BAD_INPUT. */
rp_status dem_read_kind(const config_setting_t *group, dem_scene *scene, uint32_t *number);

/* Keys of radii in a group, beside other keys, `radii` among them; without any the radii of `as`, or the
 * defaults of a fill. Errors: RP_BAD_INPUT. */
rp_status dem_text_radii(rp_arena *arena, const config_setting_t *group, const char *others,
                         const dem_fill *as, dem_fill *radii);

#endif
