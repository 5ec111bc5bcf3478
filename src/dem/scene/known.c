/* What d, m, g, dt and dt_limit are in a scene file's expressions: keys that tell them are read before their
 * groups, which may be written with them. */
#include <ctype.h>
#include <math.h>
#include <string.h>

#include "core/elementary.h"
#include "dem/scene/file.h"
#include "dem/scene/radii.h"

static void end_scene(dem_scene *scene)
{
    rp_arena_end(&scene->arena);
}

/* A scene at its defaults, of which parts are read; it ends with the block. */
#define PART_OF_SCENE(name)                                                                                  \
    RP_ENDS(end_scene) dem_scene name = {.def = dem_definition_default()};                                   \
    rp_params_defaults(SCHEMA(TOP), rp_config_units(root), &name);                                           \
    name.def.units = rp_config_units(root)

/* Radius of the mean grain: of the first fill, of the particles, or of what a phase adds first, 0: unknown;
 * shape and density of all are put into the scene. */
static rp_status mean_grain(const dem_text *text, const char *keys, dem_scene *scene, double *r)
{
    const config_setting_t *root = config_root_setting(&text->config);
    const config_setting_t *list = member(root, "particles"), *add = dem_first_add(member(root, "phases")),
                           *fill;
    dem_grain grain = {0};
    dem_fill radii = {0};
    *r = 0.0;
    RP_TRY(rp_config_peek(root, SCHEMA(TOP), keys, scene));
    RP_TRY(rp_config_peek(root, SCHEMA(TOP), "particles_file particles_step", scene));
    RP_TRY(dem_next_fill(root, &(size_t){0}, &fill));
    if (!fill && *scene->particles_file) {
        const double density = scene->laws.physics.density;
        scene->laws.physics.density = 0.0; /* the mass of those that the table gives none */
        RP_TRY(dem_read_table(text->path, scene));
        scene->laws.physics.density = density;
        for (size_t i = 0; i < scene->def.n_grains; i++)
            *r += scene->grains[i].r / (double)scene->def.n_grains;
    } else if (!fill && !list && add && member(add, "r")) {
        RP_TRY(rp_config_peek(add, SCHEMA(PARTICLES), "r", &grain));
        RP_TRY(dem_peek_density(add, &radii.density));
        if (rp_config_peek(add, SCHEMA(FILL), "density", &radii)) radii.density = 0.0; /* the run's */
        *r = grain.r;
    } else if (fill || (!list && add)) {
        RP_TRY(dem_peek_radii(&scene->arena, fill ? fill : add, &radii));
        *r = dem_radius_mean(&radii);
    }
    if (radii.density > 0.0) scene->laws.physics.density = radii.density;
    for (size_t i = 0; !fill && i < length(list); i++, grain.r = 0.0) {
        RP_TRY(rp_config_peek(element(list, i), SCHEMA(PARTICLES), "r", &grain));
        *r += grain.r / (double)length(list);
    }
    return RP_OK;
}

/* Of grains of which some give their mass, the mean of all, of the others by density; `m` stays if none does.
 */
static rp_status mean_mass(const config_setting_t *list, const dem_scene *scene, double *m)
{
    const dem_physics *all = &scene->laws.physics;
    const size_t n = list ? length(list) : scene->def.n_grains;
    double sum = 0.0;
    bool given = false;
    for (size_t i = 0; i < n; i++) {
        dem_grain grain = list ? (dem_grain){0} : scene->grains[i];
        if (list) RP_TRY(rp_config_peek(element(list, i), SCHEMA(PARTICLES), "r m", &grain));
        double density = all->density;
        if (list) RP_TRY(dem_peek_density(element(list, i), &density));
        given |= grain.m > 0.0 || density != all->density;
        sum += grain.m > 0.0 ? grain.m : dem_mass(all->shape, density, grain.r);
    }
    if (given) *m = sum / (double)n;
    return RP_OK;
}

rp_status dem_know(void *host, rp_let_constant which, double *value)
{
    const config_setting_t *root = config_root_setting(&((dem_text *)host)->config), *fill,
                           *gravity = member(root, "gravity");
    PART_OF_SCENE(scene);
    double r, g[2] = {0.0, rp_units_value(scene.def.units, "cm/s^2", scene.def.gravity[1])};
    if (which == RP_LET_DT) {
        RP_TRY(rp_config_peek(root, SCHEMA(TOP), "dt", &scene));
        return *value = scene.laws.physics.dt, RP_OK;
    }
    if (which == RP_LET_G) {
        if (gravity) RP_TRY(rp_config_pair(gravity, g));
        return *value = rp_hypot(g[0], g[1]), RP_OK;
    }
    RP_TRY(mean_grain(host, which == RP_LET_M ? "shape density" : "shape", &scene, &r));
    if (!(r > 0.0)) return RP_OK;
    *value = which == RP_LET_D ? 2.0 * r : dem_mass(scene.laws.physics.shape, scene.laws.physics.density, r);
    RP_TRY(dem_next_fill(root, &(size_t){0}, &fill));
    return which == RP_LET_M && !fill ? mean_mass(member(root, "particles"), &scene, value) : RP_OK;
}

/* The largest step for impacts at v of two such grains, and of one at the walls, by density if without a
 * mass, where it is below *least. `r`: the radius of the mean grain, 0: the same. */
static void limit_of(dem_scene *scene, double v, dem_grain grain, double density, double r_mean,
                     double *least)
{
    dem_definition *def = &scene->def;
    const double r = grain.r, m = grain.m > 0.0 ? grain.m : dem_mass(scene->laws.physics.shape, density, r);
    const dem_grain two[2] = {{.r = r, .m = m, .vx = 0.5 * v, .kind = grain.kind},
                              {.x = 3.0 * r, .r = r, .m = m, .kind = grain.kind}};
    def->grains = two, def->n_grains = 2;
    def->mass_to_come = r_mean > 0.0 ? dem_mass(scene->laws.physics.shape, density, r_mean) : m;
    def->gravity[0] = def->gravity[1] = 0.0;
    *least = fmin(*least, dem_time_step_limit(def, NULL));
}

/* Kinds that the text names, and the walls. */
static rp_status read_kinds(const config_setting_t *root, dem_scene *scene)
{
    const config_setting_t *list = member(root, "particles"), *fill = root;
    uint32_t kind;
    RP_TRY(dem_read_kinds(root, false, scene, &scene->laws));
    RP_TRY(dem_read_walls(root, scene));
    for (size_t next = 0; fill;) {
        RP_TRY(dem_next_fill(root, &next, &fill));
        if (fill) RP_TRY(dem_read_kind(fill, scene, &kind));
    }
    for (size_t i = 0; i < length(list); i++) RP_TRY(dem_read_kind(element(list, i), scene, &kind));
    return dem_number_added(member(root, "phases"), scene);
}

/* The same of all fills and particles, the smallest of each. */
static rp_status limit_of_all(const dem_text *text, dem_scene *scene, double v, double density, double *least)
{
    const config_setting_t *root = config_root_setting(&text->config), *list = member(root, "particles"),
                           *fill;
    const size_t n_read = list ? 0 : scene->def.n_grains;
    size_t next = 0;
    for (;;) {
        dem_fill radii;
        dem_grain grain = {0};
        RP_TRY(dem_next_fill(root, &next, &fill));
        if (!fill) break;
        RP_TRY(dem_peek_radii(&scene->arena, fill, &radii));
        RP_TRY(dem_read_kind(fill, scene, &grain.kind));
        grain.r = dem_radius_least(&radii);
        limit_of(scene, v, grain, radii.density > 0.0 ? radii.density : density, dem_radius_mean(&radii),
                 least);
    }
    for (size_t i = 0; i < length(list); i++) {
        dem_grain grain = {0};
        double own = density;
        RP_TRY(rp_config_peek(element(list, i), SCHEMA(PARTICLES), "r m", &grain));
        RP_TRY(dem_read_kind(element(list, i), scene, &grain.kind));
        RP_TRY(dem_peek_density(element(list, i), &own));
        limit_of(scene, v, grain, own, 0.0, least);
    }
    for (size_t i = 0; i < n_read; i++) limit_of(scene, v, scene->grains[i], density, 0.0, least);
    return RP_OK;
}

/* dt_limit(v, r): the largest time step of this file for impacts at v, with each other and with any wall, of
 * grains of radius r, by default of all that are there at the start, or of the first that a phase adds; the
 * fall from any height and the motion of walls aside. */
rp_status dem_call(void *host, const char *name, int n, const double args[], double *value, bool *known)
{
    const dem_text *text = ((rp_lets *)host)->host;
    const config_setting_t *root = config_root_setting(&text->config);
    PART_OF_SCENE(scene);
    double r, density;
    bool there;
    if (strcmp(name, "dt_limit") != 0) return RP_OK;
    if (n < 1 || n > 2 || !(args[0] >= 0.0) || isinf(args[0]) || (n == 2 && !(args[1] > 0.0)))
        return rp_fail(RP_BAD_INPUT, "dt_limit: a speed and, if wanted, a radius expected");
    RP_TRY(rp_config_peek(root, SCHEMA(TOP), "rotation integrator shape density", &scene));
    for (int k = NORMAL; k <= ROLLING; k++)
        rp_params_defaults(SCHEMA(k), scene.def.units, &scene.laws.physics);
    RP_TRY(dem_read_physics(root, &scene));
    RP_TRY(read_kinds(root, &scene));
    RP_TRY(dem_read_group(root, GROUND, &scene.def.ground, &there));
    RP_TRY(dem_read_group(root, HARD, &scene.def.hard, &scene.def.hard.on));
    for (size_t w = 0; w < scene.def.n_walls; w++) {
        dem_wall *wall = (dem_wall *)&dem_walls_of(&scene.def)[w];
        wall->velocity[0] = wall->velocity[1] = wall->omega = 0.0; /* v says how fast */
    }
    density = scene.laws.physics.density;
    RP_TRY(mean_grain(text, "", &scene, &r));
    RP_TRY(dem_mix_kinds(&scene, &scene.laws, scene.given, &scene.def));
    if (n == 2) r = args[1];
    if (!(r > 0.0)) return rp_fail(RP_BAD_INPUT, "dt_limit: no grains are known here");
    *known = true;
    *value = INFINITY;
    if (n == 1) RP_TRY(limit_of_all(text, &scene, args[0], density, value));
    if (isinf(*value)) limit_of(&scene, args[0], (dem_grain){.r = r}, scene.laws.physics.density, 0.0, value);
    return RP_OK;
}

/* The numbers that a condition names. Returns `text`. */
static const char *values_in(const dem_text *of, const char *condition, char text[256])
{
    const rp_lets *lets = &of->lets;
    char number[32];
    size_t used = 0;
    *text = '\0';
    for (const char *c = condition; *c; c += isalpha((unsigned char)*c) ? strspn(c, RP_NAME_LETTERS) : 1)
        for (size_t k = 0; k < lets->n && isalpha((unsigned char)*c) && used < 200; k++)
            if (lets->lets[k].is.type == RP_X_NUMBER &&
                strlen(lets->lets[k].name) == strspn(c, RP_NAME_LETTERS) &&
                strncmp(c, lets->lets[k].name, strlen(lets->lets[k].name)) == 0)
                used += (size_t)snprintf(text + used, 256 - used, "; %s = %s", lets->lets[k].name,
                                         rp_number_text(lets->lets[k].is.value, 6, number, sizeof number));
    return text;
}

/* require = ( ("condition", "message"), ... ): of the lets, before anything runs. */
rp_status dem_check_required(const dem_text *text)
{
    const config_setting_t *list = config_lookup(&text->config, "require");
    if (list && !config_setting_is_list(list))
        return rp_config_fail(list, "require: a list ( (\"condition\", \"message\"), ... ) expected");
    for (size_t k = 0; k < length(list); k++) {
        const config_setting_t *pair = element(list, k);
        const char *condition = config_setting_get_string_elem(pair, 0),
                   *message = config_setting_get_string_elem(pair, 1);
        rp_x_symbol is = {0};
        char values[256];
        if (!condition || !message || length(pair) != 2 || config_setting_is_group(pair))
            return rp_config_fail(pair, "require: (\"condition\", \"message\") expected");
        if (rp_lets_value(pair, condition, &is))
            return rp_config_fail(pair, "require \"%s\": %s", condition, rp_message());
        if (is.type != RP_X_TRUTH)
            return rp_config_fail(pair, "require \"%s\": a condition expected", condition);
        if (is.value == 0.0)
            return rp_config_fail(pair, "%s (%s%s)", message, condition, values_in(text, condition, values));
    }
    return RP_OK;
}
