/* Scene files: opened, read whole, and made a simulation; see scene.h and text.h. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/elementary.h"
#include "dem/scene/file.h"
#include "dem/scene/radii.h"
#include "dem/state/method.h"

rp_status dem_text_open(const char *name, const char *bytes, const rp_texts *changes, dem_text *text)
{
    *text = (dem_text){.path = name};
    RP_TRY(bytes ? rp_config_read_text(name, bytes, &text->config) : rp_config_read(name, &text->config));
    for (size_t i = 0; changes && i < changes->n; i++) RP_TRY(dem_text_change(text, changes->items[i]));
    return RP_OK;
}

void dem_text_close(dem_text *text)
{
    rp_lets_end(&text->lets);
    config_destroy(&text->config);
}

/* --set and sweeps take a name of a let for this: a key of the scene with its name has its value, or is
 * meant where the let is not. */
static rp_status check_lets(const config_setting_t *root)
{
    const config_setting_t *lets = member(root, "let");
    for (size_t k = 0; k < length(lets); k++) {
        const char *name = config_setting_name(element(lets, k));
        const config_setting_t *key = member(root, name);
        const char *text = key ? config_setting_get_string(key) : NULL;
        if ((rp_params_find(SCHEMA(TOP), name) || rp_word_index("seed run result", name) >= 0) &&
            (!text || strcmp(text, name) != 0))
            return rp_config_fail(element(lets, k),
                                  "let.%s: %s is a key of the scene too; give the let another name, or the "
                                  "key its value: %s = \"%s\"",
                                  name, name, name, name);
    }
    return RP_OK;
}

/* Phases have one stream, whose seed is that of the text or its first fill. */
static rp_status check_seeds(const config_setting_t *root)
{
    static const char *const keys[] = {"seed", "run"};
    const config_setting_t *fill = member(root, "fill");
    const int n =
        fill && config_setting_is_list(fill) && member(root, "phases") ? config_setting_length(fill) : 0;
    for (int k = 1; k < n; k++)
        for (int i = 0; i < 2; i++) {
            const config_setting_t *of = config_setting_get_elem(fill, (unsigned)k), *own;
            if (config_setting_is_group(of) && (own = member(of, keys[i])))
                return rp_config_fail(own, "%s: of the first fill, or at the top of the file, for all",
                                      keys[i]);
        }
    return RP_OK;
}

rp_status dem_text_scene(dem_text *text, dem_scene *scene)
{
    static const char *const of_phases[] = {"measure", "regions", "rest", "result", NULL};
    config_setting_t *root = config_root_setting(&text->config);
    const rp_units units = rp_config_units(root);
    dem_definition *def = &scene->def;
    dem_fill streams;
    bool there;
    *scene = (dem_scene){.def = dem_definition_default()};
    rp_params_defaults(SCHEMA(TOP), units, scene);
    def->gravity[1] = rp_units_value(units, "cm/s^2", def->gravity[1]);
    text->lets.know = dem_know, text->lets.call = dem_call, text->lets.host = text;
    if (!text->lets.place) text->lets.place = dem_place;
    RP_TRY(rp_lets_read(root, &text->lets));
    RP_TRY(check_lets(root));
    if (member(root, "gravity")) RP_TRY(rp_config_pair(member(root, "gravity"), def->gravity));
    RP_TRY(rp_config_group(root, SCHEMA(TOP), scene, dem_scene_others));
    scene->has_density = member(root, "density") != NULL;
    def->skin = fmax(def->skin, 0.0);
    dem_ends_apply(&scene->laws, def);
    def->turn_per_step = scene->turn_deg * (M_PI / 180.0);
    def->box_turn_per_step = scene->box_turn_deg * (M_PI / 180.0);
    for (int k = NORMAL; k <= ROLLING; k++) rp_params_defaults(SCHEMA(k), units, &scene->laws.physics);
    RP_TRY(dem_read_physics(root, scene));
    RP_TRY(dem_read_kinds(root, false, scene, &scene->laws));
    RP_TRY(dem_read_walls(root, scene));
    RP_TRY(dem_read_group(root, GROUND, &def->ground, &there));
    RP_TRY(dem_read_group(root, HARD, &def->hard, &def->hard.on));
    if (member(root, "implicit") && !dem_schemes[def->integrator]->solves)
        return rp_config_fail(member(root, "implicit"), "implicit: needs integrator = \"implicit\"");
    RP_TRY(dem_read_group(root, IMPLICIT, &def->implicit, &there));
    rp_params_defaults(SCHEMA(OUTPUT), units, &scene->output);
    RP_TRY(dem_read_group(root, OUTPUT, &scene->output, &there));
    scene->phases = member(root, "phases") != NULL;
    for (const char *const *key = of_phases; !scene->phases && *key; key++)
        if (member(root, *key))
            return rp_config_fail(member(root, *key),
                                  "%s: needs phases, as in phases = ( { name = \"run\"; steps = %ld; } );",
                                  *key, scene->steps);
    RP_TRY(dem_read_grains(text->path, root, scene));
    RP_TRY(dem_number_added(member(root, "phases"), scene));
    if (dem_mix_kinds(scene, &scene->laws, scene->given, def))
        return rp_config_fail(member(root, member(root, "kinds") ? "kinds" : "pairs"), "%s", rp_message());
    for (size_t k = 0; k < scene->n_fills; k++) {
        const dem_fill *f = &scene->fills[k];
        const double m = dem_mass(f->shape, f->density, dem_radius_mean(f)), least = def->mass_to_come;
        if (!f->fixed) def->mass_to_come = least > 0.0 ? fmin(m, least) : m;
    }
    RP_TRY(check_seeds(root));
    /* seed and run of the text go before those of its first fill, and are for what phases add too */
    rp_params_defaults(SCHEMA(FILL), units, &streams);
    if (scene->fills) streams = *scene->fills;
    RP_TRY(rp_config_peek(root, SCHEMA(FILL), "seed run", &streams));
    scene->seed = streams.seed, scene->run = streams.run;
    return dem_check_required(text);
}

rp_status dem_scene_read(const char *path, const rp_texts *changes, dem_scene *scene)
{
    RP_ENDS(dem_text_close) dem_text text;
    *scene = (dem_scene){0};
    RP_TRY(dem_text_open(path, NULL, changes, &text));
    return dem_text_scene(&text, scene);
}

void dem_scene_free(dem_scene *scene)
{
    rp_arena_end(&scene->arena);
    *scene = (dem_scene){0};
}

rp_status dem_scene_grains(const dem_scene *scene, dem_grain **grains, size_t *n)
{
    const size_t listed = scene->grains ? scene->def.n_grains : 0;
    size_t room = listed + 1;
    for (size_t k = 0; k < scene->n_fills; k++) room += dem_fill_most(&scene->fills[k]);
    if (room > DEM_MOST_GRAINS)
        return rp_fail(RP_BAD_INPUT, "fill: room for %zu particles: at most %d", room, DEM_MOST_GRAINS);
    *grains = malloc(room * sizeof **grains);
    if (!*grains) return rp_fail(RP_NO_MEMORY, "%zu particles: out of memory", room);
    if (listed) memcpy(*grains, scene->grains, listed * sizeof **grains);
    *n = listed;
    for (size_t k = 0; k < scene->n_fills; k++) {
        dem_fill one = scene->fills[k];
        const char *kind = one.kind ? one.kind : "";
        size_t placed = 0;
        one.seed = scene->seed, one.run = scene->run, one.cut = scene->cut;
        one.walls = dem_walls_of(&scene->def), one.n_walls = scene->def.n_walls;
        one.n_there = *n;
        if (k == 0) memcpy(one.streams, scene->streams, sizeof one.streams);
        RP_TRY(rp_prefix(dem_fill_grains(&one, *grains + *n, &placed), "%s%s", kind, *kind ? ": " : ""));
        *n += placed;
    }
    return RP_OK;
}

/* Is a segment from p along t, or a body there, below a grain, along the unit vector down? */
static bool is_below(const dem_state *s, const double down[2], const double p[2], const double t[2],
                     const double ends[2], double r)
{
    const double dx = p[0] - s->x, dy = p[1] - s->y, across = dx * down[1] - dy * down[0],
                 slope = t[0] * down[1] - t[1] * down[0];
    const double along = fabs(slope) > 1e-12 ? fmin(fmax(-across / slope, ends[0]), ends[1]) : 0.0;
    return fabs(across + along * slope) < r &&
           (dx + along * t[0]) * down[0] + (dy + along * t[1]) * down[1] > -r;
}

rp_status dem_first_falling(const dem_scene *scene, const dem_sim *sim, dem_state *grain)
{
    static const double point[2] = {0.0, 0.0};
    const dem_scene_laws *laws = &scene->laws;
    const size_t n = dem_count(sim), n_walls = dem_wall_count(sim);
    double g[2], size = 0.0;
    dem_state *all;
    RP_SCOPE(memory);
    dem_gravity(sim, g);
    *grain = (dem_state){0};
    const double g_size = rp_hypot(g[0], g[1]), down[2] = {g[0] / g_size, g[1] / g_size},
                 time = scene->phases ? INFINITY : laws->physics.dt * (double)scene->steps;
    if (!(g_size > 0.0) || isfinite(laws->x_min) || isfinite(laws->x_max) || isfinite(laws->y_min))
        return RP_OK;
    RP_NEW(&memory, all, n);
    RP_TRY(dem_states(sim, all));
    for (const dem_state *s = all; s < all + n; s++)
        size = fmax(size, rp_hypot(s->x - all->x, s->y - all->y) + 20.0 * s->r);
    if (!(0.5 * g_size * time * time > size)) return RP_OK;
    for (const dem_state *s = all; s < all + n; s++) {
        bool held = s->fixed;
        for (size_t w = 0; w < n_walls && !held; w++) {
            const dem_wall_state wall = dem_wall_now(sim, w);
            held = wall.ends[0] < wall.ends[1] &&
                   is_below(s, down, wall.point, (double[]){wall.direction[1], -wall.direction[0]}, wall.ends,
                            s->r);
        }
        for (const dem_state *b = all; b < all + n && !held; b++)
            held = b->fixed && is_below(s, down, (double[]){b->x, b->y}, point, point, s->r + b->r);
        if (!held) return *grain = *s, RP_OK;
    }
    return RP_OK;
}

rp_status dem_scene_start(const dem_scene *scene, dem_sim **sim)
{
    dem_definition def = scene->def;
    dem_grain *grains = NULL;
    *sim = NULL;
    rp_status status = dem_scene_grains(scene, &grains, &def.n_grains);
    def.grains = grains, def.lines = scene->n_fills || scene->compressed ? NULL : scene->lines;
    if (!status) status = dem_create(&def, sim);
    free(grains);
    return status;
}
