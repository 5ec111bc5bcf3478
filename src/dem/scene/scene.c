/* Scene files, through schemas; see scene.h. */
#include "core/elementary.h"
#include "dem/scene/text.h"

#include <ctype.h>
#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "core/arena.h"
#include "params/config.h"
#include "params/guess.h"
#include "table/where.h"
#include "table/columns.h"
#include "params/units.h"
#include "dem/scene/radii.h"
#include "dem/setup/definition.h"
#include "dem/state/method.h"
#include "dem/state/vec.h"

/* What a scene file says, before defaults that depend on one another are filled in. */
typedef struct {
    dem_scene scene;
    dem_physics physics;
    bool has_density; /* given, no default */
    double x_min, y_min, turn_deg, box_turn_deg;
    int units;
    const char *particles_file, *contacts_file;
    long particles_step; /* -1: the last */
} scene_file;

#define AT(type, field) offsetof(type, field)
#define TOP(...)        DEM_KEY_ROW(scene_file, physics., __VA_ARGS__)
#define ROW(...)        DEM_KEY_ROW(dem_physics, , __VA_ARGS__)

static const rp_param top_schema[] = {
    DEM_GRAIN_PARAMS(TOP){"steps", "", RP_INT, AT(scene_file, scene.steps), "20000", "[0, 2147483647]",
                          "how many steps to run"},
    {"units", "", RP_CHOICE, AT(scene_file, units), "cgs", RP_UNITS_WORDS,
     "of the numbers here and of the tables; defaults are converted. sigma: diameter sigma and mass m of "
     "the default grain, and g"},
    {"skin", "cm", RP_REAL, AT(scene_file, scene.def.skin), "auto", "(0, inf) | auto",
     "of the neighbour list"},
    {"x_min", "cm", RP_REAL, AT(scene_file, x_min), "none", "(-inf, inf) | none",
     "a grain whose centre passes it to the left, in the box's frame, is taken out"},
    {"x_max", "cm", RP_REAL, AT(scene_file, scene.def.x_max), "none", "(-inf, inf) | none",
     "a grain whose centre passes it to the right, in the box's frame, is taken out"},
    {"y_min", "cm", RP_REAL, AT(scene_file, y_min), "none", "(-inf, inf) | none",
     "a grain whose centre sinks below it, in the box's frame, is taken out"},
    {"gravity_turn_deg_per_step", "degree", RP_REAL, AT(scene_file, turn_deg), "0.0", "[-10, 10]",
     "gravity's turn a step; positive lowers the side at +x"},
    {"box_turn_deg_per_step", "degree", RP_REAL, AT(scene_file, box_turn_deg), "0.0", "[-10, 10]",
     "the walls' turn a step, about the origin; positive lowers the side at +x"},
    {"turn_from_step", "", RP_INT, AT(scene_file, scene.def.turn_from_step), "0", "[0, 2147483647]",
     "first step at which gravity or the box turns"},
    {"kernel", "", RP_CHOICE, AT(scene_file, scene.def.kernel), "fast", DEM_WORDS(DEM_KERNEL_LIST),
     "instances of the loops, with the same bits", .manual = dem_kernel_manual},
    {"ledger", "", RP_BOOL, AT(scene_file, scene.def.ledger), "false", "",
     "whether to keep the energy ledger, which `repose run -o` writes with the energies; slower, the same "
     "bits"},
    {"particles_file", "", RP_TEXT, AT(scene_file, particles_file), "", "",
     "table with columns x y r and, if wanted, m vx vy angle omega fixed; instead of `particles`"},
    {"particles_step", "", RP_INT, AT(scene_file, particles_step), "last", "[0, 2147483647] | last",
     "step of the table, which may have several"},
    {"contacts_file", "", RP_TEXT, AT(scene_file, contacts_file), "", "",
     "table contacts.tsv beside the states.tsv of `particles_file`, whose springs then go on; without it "
     "they begin "
     "at 0, and a bed at rest moves"},
    {0}};

static const rp_param normal_schema[] = {DEM_NORMAL_PARAMS(ROW){0}};
static const rp_param tangential_schema[] = {DEM_TANGENTIAL_PARAMS(ROW){0}};
static const rp_param rolling_schema[] = {DEM_ROLLING_PARAMS(ROW){0}};

static const rp_param material_schema[] = {
    {"E", "dyn/cm^2", RP_REAL, AT(scene_file, scene.E), NULL, "(0, inf)", "Young's modulus"},
    {"nu", "", RP_REAL, AT(scene_file, scene.nu), NULL, "[0, 0.5]", "Poisson's ratio"},
    {"restitution", "", RP_REAL, AT(scene_file, physics.restitution), NULL, "(0, 1]",
     "of impacts of all speeds"},
    {"mu", "", RP_REAL, AT(scene_file, physics.mu), NULL, "[0, inf) | infinite", "coefficient of friction"},
    {0}};

static const rp_param ground_schema[] = {
    {"wall", "", RP_INT, AT(dem_ground, wall), "1", "[1, 8]", "its number: a whole line"},
    {"mu_static", "", RP_REAL, AT(dem_ground, mu_static), NULL, "[0, inf)",
     "static friction: largest force of a well over the normal force"},
    {"a", "cm", RP_REAL, AT(dem_ground, a), NULL, "(0, inf)",
     "half-width of a well, beyond which it is broken"},
    {"set", "", RP_CHOICE, AT(dem_ground, set), "rest", DEM_WORDS(DEM_WELL_SETS),
     "when a grain gets its well", .manual = dem_well_manual},
    {0}};

static const rp_param hard_schema[] = {
    {"restitution", "", RP_REAL, AT(dem_hard, restitution), NULL, "[0, 1]",
     "of collisions of what approaches fast"},
    {"mu", "", RP_REAL, AT(dem_hard, mu), "0.0", "[0, inf) | infinite", "their coefficient of friction"},
    {0}};

static const rp_param implicit_schema[] = {
    {"solver", "", RP_CHOICE, AT(dem_implicit_solver, solver), "direct", DEM_WORDS(DEM_SOLVERS),
     "how a step is solved", .manual = dem_solver_manual},
    {"relaxation", "", RP_REAL, AT(dem_implicit_solver, relaxation), "0.7", "(0, 2)", "factor of the sweeps"},
    {"tolerance", "", RP_REAL, AT(dem_implicit_solver, tolerance), "1e-15", "[1e-15, 1e-3]",
     "convergence: largest Newton correction of a grain, over its radius"},
    {"max_iterations", "", RP_INT, AT(dem_implicit_solver, max_iterations), "1000", "[1, 1000000]",
     "factorisations or sweeps, after which a step counts as not solved"},
    {0}};

#define WALL_AUTO(...) WALL_AUTO_OF(__VA_ARGS__)
#define WALL_AUTO_OF(kind, type, name, key, unit, fallback, range, also, automatic, wall, ...)               \
    DEM_IF_MATERIAL(kind,                                                                                    \
                    {#name, unit, type, AT(wall_entry, line.material.name), "auto", range " | auto",         \
                     "of this wall; auto: the grains', times " #wall}, )

/* What a wall of a file says: one wall, or a polygon or circle of several. */
typedef struct {
    dem_wall line;
    long sides;
    bool closed;
    const char *name;
    double E, nu;
} wall_entry;

/* The first rows are of entries: their sides are written as segments, each with the name if there is one. */
enum { SHAPE_ROWS = 5 };
static const rp_param wall_schema[] = {
    {"name", "", RP_TEXT, AT(wall_entry, name), "", "",
     "for phases and measures; entries of one name open together"},
    {"sides", "", RP_INT, AT(wall_entry, sides), "64", "[3, 4096]",
     "of a circle, which is a regular polygon"},
    {"closed", "", RP_BOOL, AT(wall_entry, closed), "true", "",
     "whether a polygon is closed by a side from its last point to its first"},
    {"E", "dyn/cm^2", RP_REAL, AT(wall_entry, E), "auto", "(0, inf) | auto",
     "Young's modulus; auto: the grains' in `material`"},
    {"nu", "", RP_REAL, AT(wall_entry, nu), "auto", "[0, 0.5] | auto", "Poisson's ratio; auto: the grains'"},
    DEM_PHYSICS(WALL_AUTO){"open_at_step", "", RP_INT, AT(wall_entry, line.open_at_step), "never",
                           "[0, 2147483647] | never", "step from which the wall is gone"},
    {"open_speed", "cm/s", RP_REAL, AT(wall_entry, line.open_speed), "instant", "[0, inf) | instant",
     "speed at which its lower end moves then, along the wall; of a level one the first"},
    {"omega", "rad/s", RP_REAL, AT(wall_entry, line.omega), "0.0", "(-inf, inf)",
     "rate at which the wall turns about `pivot`, counter-clockwise"},
    {0}};

static const rp_param particle_schema[] = {
    {"x", "cm", RP_REAL, AT(dem_grain, x), NULL, "(-inf, inf)", "centre"},
    {"y", "cm", RP_REAL, AT(dem_grain, y), NULL, "(-inf, inf)", "centre"},
    {"r", "cm", RP_REAL, AT(dem_grain, r), NULL, "(0, inf)", "radius"},
    {"m", "g", RP_REAL, AT(dem_grain, m), "auto", "(0, inf) | auto", "mass; auto: from density and shape"},
    {"vx", "cm/s", RP_REAL, AT(dem_grain, vx), "0.0", "(-inf, inf)", "velocity"},
    {"vy", "cm/s", RP_REAL, AT(dem_grain, vy), "0.0", "(-inf, inf)", "velocity"},
    {"angle", "rad", RP_REAL, AT(dem_grain, angle), "0.0", "(-inf, inf)", "0 where nothing rotates"},
    {"omega", "rad/s", RP_REAL, AT(dem_grain, omega), "0.0", "(-inf, inf)",
     "spin, counter-clockwise; 0 where nothing rotates"},
    {"fixed", "", RP_BOOL, AT(dem_grain, fixed), "false", "", "whether it never moves"},
    {0}};

#define INTERVAL(table, what)                                                                                \
    {                                                                                                        \
#table, "steps", RP_INT, AT(dem_intervals, table), "auto", "[0, 2147483647] | auto",                 \
            "from frame to frame of the " what                                                               \
            "; 0: none; auto: the last frame, and those at the ends of phases"                               \
    }
static const rp_param output_schema[] = {INTERVAL(states, "states"),
                                         INTERVAL(energy, "energies"),
                                         INTERVAL(contacts, "contacts"),
                                         INTERVAL(walls, "walls"),
                                         {0}};

/* What a fill of a file says. */
typedef struct {
    dem_fill fill;
    const char *kind;
} fill_entry;

#define FILL(...) DEM_KEY_ROW(fill_entry, fill., __VA_ARGS__)

static const rp_param fill_schema[] = {
    {"N", "", RP_INT, AT(fill_entry, fill.N), "auto", "[1, 100000000] | auto",
     "number of grains; auto: of a row or a lattice, as many as there is room for"},
    {"W", "cm", RP_REAL, AT(fill_entry, fill.W), NULL, "(0, inf)", "width of the region, from x = x0"},
    {"H", "cm", RP_REAL, AT(fill_entry, fill.H), "auto", "(0, inf) | auto",
     "height of the region, from y = y0; auto: of a row, which needs none"},
    {"x0", "cm", RP_REAL, AT(fill_entry, fill.x0), "0.0", "(-inf, inf)", "left end of the region"},
    {"y0", "cm", RP_REAL, AT(fill_entry, fill.y0), "0.0", "(-inf, inf)", "lower end of the region"},
    {"seed", "", RP_INT, AT(fill_entry, fill.seed), "1993", "[0, 2147483647]", "of the random streams"},
    {"run", "", RP_INT, AT(fill_entry, fill.run), "0", "[0, 2147483647]",
     "number of the streams within the seed"},
    DEM_RADIUS_PARAMS(FILL){"radius_law", "", RP_CHOICE, AT(fill_entry, fill.law), "gauss",
                            DEM_WORDS(DEM_RADIUS_LAWS), "law of the radii", .manual = dem_radius_law_manual},
    {"by", "", RP_CHOICE, AT(fill_entry, fill.by), "number", DEM_WORDS(DEM_SHARES),
     "what the law's shares are of", .manual = dem_share_manual},
    {"pattern", "", RP_CHOICE, AT(fill_entry, fill.pattern), "random", DEM_WORDS(DEM_PATTERNS),
     "of the places", .manual = dem_pattern_manual},
    {"density", "g/cm^3", RP_REAL, AT(fill_entry, fill.density), "auto", "(0, inf) | auto",
     "of these grains; auto: the scene's"},
    {"fixed", "", RP_BOOL, AT(fill_entry, fill.fixed), "false", "", "whether they never move"},
    {"kind", "", RP_TEXT, AT(fill_entry, kind), "", "", "a name for them, for measures"},
    {"spacing", "cm", RP_REAL, AT(fill_entry, fill.spacing), "auto", "(0, inf) | auto",
     "of a row or lattice, from centre to centre; auto: so that grains touch"},
    {0}};

const dem_scene_group dem_scene_schemas[] = {
    {"scene", top_schema, "what all grains share, and the run; gravity = [gx, gy] (cm/s^2)"},
    {"normal", normal_schema, "force of a contact along the line of centres; overlap x, parting at v_n"},
    {"tangential", tangential_schema, "force of a contact across the line of centres"},
    {"rolling", rolling_schema,
     "resistance to rolling: a spring and a dashpot of the rolling displacement, under the limit mu F_n "
     "(Ai, Chen, Rotter & Ooi 2011, model C)"},
    {"material", material_schema,
     "elastic spheres by their material: stands for normal = { law = \"elastic\"; tension = false; } with "
     "k_n = 4/3 E*, "
     "tangential = { law = \"mindlin\"; damping = \"inside\"; } with k_s = 8 G*, and these coefficients; "
     "walls have E and "
     "nu of their own, else the grains'"},
    {"walls", wall_schema,
     "lines, segments, polygons and circles, which may move and open. A line or segment: point = [x, y]; "
     "direction = [nx, ny] (into the grains, any length); of a segment extent = [s0, s1] (from the point "
     "along "
     "the direction turned clockwise). A polygon: polygon = ([x, y], ...) (the inside is on the left of the "
     "way "
     "from each point to the next). A circle: circle = [x, y, radius]. A motion: velocity = [vx, vy] (cm/s) "
     "of "
     "pivot = [x, y] (the origin; of a circle its centre)"},
    {"ground", ground_schema,
     "static friction of a wall: each grain on it is held by -mu_static F_n/a times its displacement within "
     "a "
     "well of half-width a (Liffman, Chan & Hughes 1992, eqs (30) and (33))"},
    {"hard", hard_schema,
     "collisions of what approaches fast are instantaneous: an impulse of restitution and friction at the "
     "moment of touch (Liffman, Chan & Hughes 1992, eqs (1) to (22)); slow contacts are soft"},
    {"implicit", implicit_schema, "solver of the integrator implicit"},
    {"output", output_schema, "frames of the tables of `repose run -o`; its --every sets all"},
    {"particles", particle_schema, "grains, each with its place"},
    {"fill", fill_schema,
     "grains of random radius, at random places without overlap or in rows; a group, or a list ( { ... } ) "
     "of "
     "several, each of which if = \"CONDITION\" may leave out; radii = ( [r, share], ... ) of a table; "
     "polygon "
     "= ( [x, y], ... ) that the centres lie in, of the region"},
    {0}};

/* A value that others are written with, before they are read. */
static rp_status peek(const config_setting_t *group, const rp_param *schema, const char *name, void *values)
{
    const config_setting_t *setting = group ? config_setting_get_member(group, name) : NULL;
    return setting ? rp_config_value(setting, rp_params_find(schema, name), values) : RP_OK;
}

/* The groups of the contacts' parameters that stand in a text, over those that are there. */
static rp_status read_physics(const config_setting_t *root, scene_file *file, dem_definition *def)
{
    enum { N_GROUPS = 3 };
    const dem_scene_group *groups = &dem_scene_schemas[1];
    const config_setting_t *material = config_setting_get_member(root, "material");
    dem_physics *p = &file->physics;
    if (material) {
        RP_TRY(rp_config_group(material, material_schema, file, NULL));
        const double E[2] = {file->scene.E, file->scene.E}, nu[2] = {file->scene.nu, file->scene.nu};
        p->normal = DEM_ELASTIC, p->tension = false;
        p->tangential = DEM_MINDLIN, p->damping = DEM_DAMPING_INSIDE;
        dem_elastic_contact(E, nu, &p->k_n, &p->k_s);
    }
    dem_physics_apply(p, def);
    for (size_t k = 0; k < N_GROUPS; k++) {
        const config_setting_t *group = config_setting_get_member(root, groups[k].name);
        rp_status status = group ? rp_config_group(group, groups[k].schema, p, NULL) : RP_OK;
        if (status) return status;
        dem_physics_apply(p, def);
        status = group ? dem_material_check(def, &def->material) : RP_OK;
        if (status) return rp_config_fail(group, "%s", rp_message());
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
    static const char *const keys[] = {"dt", "x_min", "x_max", "y_min"};
    dem_definition def = scene->def;
    scene_file file = {.physics = laws->physics,
                       .x_min = -laws->ends[0],
                       .scene.def.x_max = laws->ends[1],
                       .y_min = -laws->ends[2]};
    if (!isinf(file.x_min)) file.x_min = laws->ends[0];
    if (!isinf(file.y_min)) file.y_min = laws->ends[2];
    for (size_t k = 0; k < sizeof keys / sizeof *keys; k++) RP_TRY(peek(group, top_schema, keys[k], &file));
    RP_TRY(read_physics(group, &file, &def));
    *laws = (dem_scene_laws){file.physics,
                             {isinf(file.x_min) ? -INFINITY : file.x_min, file.scene.def.x_max,
                              isinf(file.y_min) ? -INFINITY : file.y_min}};
    return RP_OK;
}

/* Is this a row of a coefficient? */
static bool is_coefficient(const rp_param *row)
{
    return row->offset >= AT(wall_entry, line.material) &&
           row->offset < AT(wall_entry, line.material) + sizeof(dem_material);
}

rp_status dem_text_coefficients(const config_setting_t *group, const char *const others[], bool *some,
                                dem_material *given)
{
    wall_entry entry = {.line.material = *given};
    rp_guess guess;
    for (int i = 0; i < config_setting_length(group); i++) {
        const config_setting_t *key = config_setting_get_elem(group, (unsigned)i);
        const rp_param *row = rp_params_find(wall_schema, config_setting_name(key));
        const char *const *other = others;
        while (*other && strcmp(*other, config_setting_name(key)) != 0) other++;
        if (*other) continue;
        guess = rp_guess_of(config_setting_name(key));
        for (other = others; *other; other++) rp_guess_try(&guess, *other);
        for (const rp_param *r = wall_schema; r->name; r++)
            if (is_coefficient(r)) rp_guess_try(&guess, r->name);
        if (!row || !is_coefficient(row))
            return rp_config_fail(key, "%s: unknown key%s", config_setting_name(key), rp_guess_text(&guess));
        RP_TRY(rp_config_value(key, row, &entry));
        *some = true;
    }
    *given = entry.line.material;
    return RP_OK;
}

void dem_laws_write(const dem_scene_laws *laws, FILE *out)
{
    fprintf(out, "dt = %.17g; ends = ( %.17g, %.17g, %.17g );\n", laws->physics.dt, laws->ends[0],
            laws->ends[1], laws->ends[2]);
    for (size_t k = 1; k <= 3; k++) {
        fprintf(out, "%s = { ", dem_scene_schemas[k].name);
        rp_config_write(out, dem_scene_schemas[k].schema, &laws->physics);
        fputs("};\n", out);
    }
}

/* Add a wall to those of the scene, once its place is known; its coefficients are those that are given. */
static rp_status add_wall(const config_setting_t *setting, const dem_wall *placed, dem_scene *scene)
{
    dem_wall own = *placed, *const wall = &own;
    wall->material = dem_wall_material(&placed->material, &scene->def.material);
    dem_definition *def = &scene->def;
    rp_status status = dem_wall_check(wall);
    if (!status) status = dem_material_check(def, &wall->material);
    if (status) return rp_config_fail(setting, "%s", rp_message());
    const size_t n = def->n_walls;
    if (n < DEM_FEW_WALLS) def->walls[n] = *wall;
    if ((n & (n - 1)) == 0 && (!dem_grow(&scene->walls, sizeof *wall, n ? 2 * n : 1) ||
                               !dem_grow(&scene->given, sizeof *scene->given, n ? 2 * n : 1)))
        return rp_fail(RP_NO_MEMORY, "%zu walls: out of memory", n);
    scene->walls[n] = *wall;
    scene->given[n] = placed->material;
    def->n_walls++;
    def->wall_list = def->n_walls > DEM_FEW_WALLS ? scene->walls : NULL;
    return RP_OK;
}

/* Turn a segment that opens round, where its lower end in space is the upper along its tangent; a level one
 * opens from its first end. */
static void put_lower_end_first(dem_wall *wall)
{
    const double rise = -wall->direction[0]; /* of the tangent */
    if (wall->open_at_step < 0 || isinf(wall->open_speed) || !(rise < 0.0)) return;
    const double ends[2] = {-wall->extent[1], -wall->extent[0]};
    memcpy(wall->extent, ends, sizeof ends);
    for (int c = 0; c < 2; c++) wall->direction[c] = -wall->direction[c];
}

/* A direction of any length; one of length 1 stays as it is to the bit. */
static rp_status normalise(const config_setting_t *setting, double v[2])
{
    const double length = rp_hypot(v[0], v[1]);
    if (!(length > 0.0)) return rp_config_fail(setting, "direction = [0, 0]: must not be 0");
    if (fabs(length - 1.0) < 1e-9) return RP_OK;
    v[0] /= length, v[1] /= length;
    return RP_OK;
}

static rp_status read_line(const config_setting_t *setting, const wall_entry *entry, dem_scene *scene)
{
    dem_wall wall = entry->line;
    const config_setting_t *point = config_setting_get_member(setting, "point");
    const config_setting_t *direction = config_setting_get_member(setting, "direction");
    const config_setting_t *extent = config_setting_get_member(setting, "extent");
    if (!point || !direction)
        return rp_config_fail(setting, "%s: missing (or polygon, or circle)", point ? "direction" : "point");
    RP_TRY(rp_config_pair(point, wall.point));
    RP_TRY(rp_config_pair(direction, wall.direction));
    RP_TRY(normalise(direction, wall.direction));
    if (extent) RP_TRY(rp_config_ends(extent, wall.extent));
    put_lower_end_first(&wall);
    return add_wall(setting, &wall, scene);
}

/* Points (x, y) of a polygon or circle. */
typedef struct {
    size_t n;
    double *at;
    bool closed;
} outline;

/* The sides through the points, with the direction on the left of the way along them. */
static rp_status add_sides(const config_setting_t *setting, const wall_entry *entry, const outline *through,
                           dem_scene *scene)
{
    const double *points = through->at;
    const size_t n = through->n;
    for (size_t i = 0; i < (through->closed ? n : n - 1); i++) {
        const double *p = &points[2 * i], *q = &points[2 * ((i + 1) % n)];
        const double dx = q[0] - p[0], dy = q[1] - p[1], length = rp_hypot(dx, dy);
        if (!(length > 0.0) || !isfinite(length))
            return rp_config_fail(setting, "polygon: points %zu and %zu are [%g, %g]: no side", i + 1,
                                  (i + 1) % n + 1, p[0], p[1]);
        dem_wall wall = entry->line;
        memcpy(wall.point, p, sizeof wall.point);
        wall.direction[0] = -dy / length, wall.direction[1] = dx / length;
        wall.extent[0] = 0.0, wall.extent[1] = length;
        put_lower_end_first(&wall);
        RP_TRY(add_wall(setting, &wall, scene));
    }
    return RP_OK;
}

/* `polygon = ( [x, y], ... )`; the caller frees the points, also after an error. */
static rp_status read_points(const config_setting_t *list, int least, size_t *n, double **points)
{
    if (!config_setting_is_list(list) || config_setting_length(list) < least)
        return rp_config_fail(list, "polygon: a list ( [x, y], ... ) of at least %d points expected", least);
    *n = (size_t)config_setting_length(list);
    if (!(*points = malloc(2 * *n * sizeof **points))) return rp_fail(RP_NO_MEMORY, "polygon: out of memory");
    for (size_t i = 0; i < *n; i++)
        RP_TRY(rp_config_pair(config_setting_get_elem(list, (unsigned)i), *points + 2 * i));
    return RP_OK;
}

static rp_status read_polygon(const config_setting_t *polygon, const wall_entry *entry, outline *o)
{
    *o = (outline){.closed = entry->closed};
    return read_points(polygon, entry->closed ? 3 : 2, &o->n, &o->at);
}

/* `circle = [x, y, radius]`: points on the circle, counter-clockwise; its pivot is its centre. */
static rp_status read_circle(const config_setting_t *circle, wall_entry *entry, outline *o)
{
    double c[3];
    RP_TRY(rp_config_numbers(circle, 3, c));
    if (!(c[2] > 0.0)) return rp_config_fail(circle, "circle: radius = %g: must be above 0", c[2]);
    memcpy(entry->line.pivot, c, sizeof entry->line.pivot);
    *o = (outline){.n = (size_t)entry->sides, .closed = true};
    if (!(o->at = malloc(2 * o->n * sizeof *o->at))) return rp_fail(RP_NO_MEMORY, "circle: out of memory");
    for (size_t i = 0; i < o->n; i++) {
        const double angle = 2.0 * M_PI * ((double)i + 0.5) / (double)o->n; /* a side at the bottom */
        o->at[2 * i] = c[0] + c[2] * rp_sin(angle);
        o->at[2 * i + 1] = c[1] - c[2] * rp_cos(angle);
    }
    return RP_OK;
}

/* Name the walls from number `first` on. */
static rp_status name_walls(const config_setting_t *setting, const char *name, size_t first, dem_scene *scene)
{
    const size_t n = scene->def.n_walls;
    if (strlen(name) >= DEM_NAME_BYTES || strspn(name, RP_NAME_LETTERS) != strlen(name) ||
        isdigit((unsigned char)*name))
        return rp_config_fail(setting, "name = \"%s\": up to %d letters, digits and _ expected", name,
                              DEM_NAME_BYTES - 1);
    if (!dem_grow(&scene->names, sizeof *scene->names, n))
        return rp_fail(RP_NO_MEMORY, "walls: out of memory");
    for (size_t w = scene->n_names; w < n; w++)
        snprintf(scene->names[w], sizeof *scene->names, "%s", w < first ? "" : name);
    scene->n_names = n;
    return RP_OK;
}

/* Of a wall's material against the grains'. */
static rp_status use_material(const config_setting_t *setting, const dem_scene *scene, wall_entry *wall)
{
    dem_material *m = &wall->line.material;
    double k_n, k_s;
    if (!(scene->E > 0.0))
        return wall->E > 0.0 || wall->nu >= 0.0
                   ? rp_config_fail(setting, "E, nu: of a wall need the grains' in material = { E; nu; ... }")
                   : RP_OK;
    const double E[2] = {scene->E, wall->E > 0.0 ? wall->E : scene->E},
                 nu[2] = {scene->nu, wall->nu >= 0.0 ? wall->nu : scene->nu};
    dem_elastic_contact(E, nu, &k_n, &k_s);
    if (m->k_n < 0.0) m->k_n = k_n;
    if (m->k_s < 0.0) m->k_s = k_s;
    return RP_OK;
}

static rp_status read_wall(const config_setting_t *setting, dem_scene *scene)
{
    const size_t first = scene->def.n_walls;
    /* corner_lower and corner_upper joined walls before all walls that meet were joined */
    static const char *const others[] = {"point",    "direction", "extent",       "polygon",      "circle",
                                         "velocity", "pivot",     "corner_lower", "corner_upper", NULL};
    wall_entry entry = {.line.extent = {-INFINITY, INFINITY}};
    rp_params_defaults(wall_schema, &entry);
    RP_TRY(rp_config_group(setting, wall_schema, &entry, others));
    RP_TRY(use_material(setting, scene, &entry));
    const config_setting_t *polygon = config_setting_get_member(setting, "polygon"),
                           *circle = config_setting_get_member(setting, "circle"),
                           *velocity = config_setting_get_member(setting, "velocity"),
                           *pivot = config_setting_get_member(setting, "pivot");
    const config_setting_t *shape = polygon ? polygon : circle;
    for (int k = 0; k < 3 && shape; k++)
        if (config_setting_get_member(setting, others[k]) || (polygon && circle))
            return rp_config_fail(setting, "a wall has one of point, polygon and circle");
    outline through = {0};
    rp_status status = polygon  ? read_polygon(polygon, &entry, &through)
                       : circle ? read_circle(circle, &entry, &through)
                                : RP_OK;
    if (!status && velocity) status = rp_config_pair(velocity, entry.line.velocity);
    if (!status && pivot) status = rp_config_pair(pivot, entry.line.pivot);
    if (!status)
        status = shape ? add_sides(shape, &entry, &through, scene) : read_line(setting, &entry, scene);
    free(through.at);
    if (!status && *entry.name) status = name_walls(setting, entry.name, first, scene);
    return status;
}

static rp_status read_walls(const config_setting_t *root, dem_scene *scene)
{
    const config_setting_t *list = config_setting_get_member(root, "walls");
    if (!list) return RP_OK;
    if (!config_setting_is_list(list)) return rp_config_fail(list, "walls: a list ( { ... } ) expected");
    const int n = config_setting_length(list);
    for (int i = 0; i < n; i++) RP_TRY(read_wall(config_setting_get_elem(list, (unsigned)i), scene));
    return RP_OK;
}

/* Is a group there, or left out by its condition? */
static rp_status is_wanted(const config_setting_t *group, bool *wanted)
{
    const config_setting_t *when =
        config_setting_is_group(group) ? config_setting_get_member(group, "if") : NULL;
    static const rp_param condition = {"if", "", RP_BOOL, 0, NULL, "", "whether the group is there"};
    *wanted = true;
    return when ? rp_config_value(when, &condition, wanted) : RP_OK;
}

/* A group that may be missing; its values then stay as they are. */
static rp_status read_group(const config_setting_t *root, const char *name, const rp_param *schema,
                            void *values, bool *there)
{
    static const char *const others[] = {"if", NULL};
    const config_setting_t *group = config_setting_get_member(root, name);
    bool wanted = false;
    if (group) RP_TRY(is_wanted(group, &wanted));
    if (there) *there = wanted;
    if (!wanted) return RP_OK;
    rp_params_defaults(schema, values);
    return rp_config_group(group, schema, values, others);
}

static rp_status alloc_grains(scene_file *file, size_t n)
{
    file->scene.def.n_grains = n;
    file->scene.grains = malloc((n + 1) * sizeof *file->scene.grains);
    file->scene.lines = malloc((n + 1) * sizeof *file->scene.lines);
    return file->scene.grains && file->scene.lines ? RP_OK
                                                   : rp_fail(RP_NO_MEMORY, "%zu particles: out of memory", n);
}

static rp_status mass_of(const scene_file *file, double r, double *m)
{
    *m = dem_mass(file->physics.shape, file->physics.density, r);
    return dem_density_check(file->physics.shape, file->has_density);
}

static rp_status read_particles(const config_setting_t *list, scene_file *file)
{
    if (!config_setting_is_list(list)) return rp_config_fail(list, "particles: a list ( { ... } ) expected");
    const size_t n = (size_t)config_setting_length(list);
    if (n == 0) return rp_config_fail(list, "particles: no particles");
    RP_TRY(alloc_grains(file, n));
    for (size_t i = 0; i < n; i++) {
        dem_grain *p = &file->scene.grains[i];
        const config_setting_t *entry = config_setting_get_elem(list, (unsigned)i);
        rp_params_defaults(particle_schema, p);
        RP_TRY(rp_config_group(entry, particle_schema, p, NULL));
        file->scene.lines[i] = config_setting_source_line(entry);
        if (p->m < 0.0) RP_TRY(mass_of(file, p->r, &p->m));
    }
    return RP_OK;
}

/* A number; of a boolean also its word, as pandas spells it too. */
static rp_status read_cell(const rp_table *table, size_t row, int column, const rp_param *key, double *v)
{
    const char *cell = rp_cell(table, row, column);
    if (key->type != RP_BOOL || (strcasecmp(cell, "true") != 0 && strcasecmp(cell, "false") != 0))
        return rp_table_number(table, row, column, 0, v);
    *v = tolower((unsigned char)*cell) == 't';
    return RP_OK;
}

static rp_status read_particles_table(const rp_table *table, scene_file *file)
{
    enum { N = sizeof particle_schema / sizeof *particle_schema - 1 };
    int columns[N];
    static const char *const numbers[N] = {"1", "2", "3", "4", "5", "6", "7", "8", "9"};
    const bool named = table->n_columns > 0 && table->names[0];
    for (int c = 0; c < N; c++) {
        const char *name = particle_schema[c].name;
        const rp_status found = rp_table_find(table, named ? name : numbers[c],
                                              "x y r, and m vx vy angle omega fixed as needed", &columns[c]);
        if (found && !particle_schema[c].fallback) return found;
    }
    RP_TRY(alloc_grains(file, table->n_rows));
    for (size_t i = 0; i < table->n_rows; i++) {
        double v[N] = {0.0};
        for (int c = 0; c < N; c++)
            if (columns[c] >= 0) RP_TRY(read_cell(table, i, columns[c], &particle_schema[c], &v[c]));
        if (!(v[2] > 0.0))
            return rp_fail(RP_BAD_INPUT, "%s:%zu: r = %g: out of range, allowed: (0, inf)",
                           table->places[i].path, table->places[i].line, v[2]);
        if (columns[3] < 0) RP_TRY(mass_of(file, v[2], &v[3]));
        file->scene.grains[i] = (dem_grain){v[0], v[1], v[2], v[3], v[4], v[5], v[6], v[7], v[8] != 0.0};
        file->scene.lines[i] = table->places[i].line;
    }
    return RP_OK;
}

/* Of a table of states that holds a pile at several steps, the one that is wanted; -1: the last. */
static rp_status take_step(rp_table *table, long wanted)
{
    char condition[64];
    const int step = rp_table_column(table, "step");
    if (wanted < 0 && (step < 0 || table->n_rows == 0)) return RP_OK;
    if (wanted < 0)
        snprintf(condition, sizeof condition, "step=%s", rp_cell(table, table->n_rows - 1, step));
    else
        snprintf(condition, sizeof condition, "step=%ld", wanted);
    RP_TRY(rp_table_where(table, condition));
    return table->n_rows ? RP_OK : rp_fail(RP_BAD_INPUT, "%s: no rows with %s", table->path, condition);
}

/* radii = ( [r, share], ... ), of the law `table`; the caller frees them. */
static rp_status read_radii(const config_setting_t *group, dem_fill *f)
{
    const config_setting_t *list = config_setting_get_member(group, "radii");
    const size_t n = list ? (size_t)config_setting_length(list) : 0;
    if ((list != NULL) != (f->law == DEM_RADII_TABLE))
        return rp_config_fail(list ? list : group, "radii: %s radius_law = \"table\"",
                              list ? "needs" : "missing, of");
    if (!list) return RP_OK;
    double *radii = malloc((2 * n + 1) * sizeof *radii);
    rp_status status = radii ? RP_OK : rp_fail(RP_NO_MEMORY, "radii: out of memory");
    for (size_t k = 0; k < n && !status; k++)
        status = rp_config_pair(config_setting_get_elem(list, (unsigned)k), &radii[2 * k]);
    if (status) return free(radii), status;
    f->radii = radii, f->n_radii = n;
    return RP_OK;
}

static bool is_of_radii(const char *name)
{
    return rp_params_find(fill_schema, name) && (strncmp(name, "radius_", 7) == 0 || strcmp(name, "by") == 0);
}

rp_status dem_text_radii(const config_setting_t *group, const char *const others[], const dem_fill *as,
                         dem_fill *radii)
{
    fill_entry entry = {.kind = ""};
    bool given = config_setting_get_member(group, "radii") != NULL;
    for (int i = 0; i < config_setting_length(group); i++)
        given |= is_of_radii(config_setting_name(config_setting_get_elem(group, (unsigned)i)));
    rp_params_defaults(fill_schema, &entry);
    if (as && !given) entry.fill = *as;
    for (int i = 0; i < config_setting_length(group); i++) {
        const config_setting_t *key = config_setting_get_elem(group, (unsigned)i);
        const char *name = config_setting_name(key), *const *other = others;
        while (*other && strcmp(*other, name) != 0) other++;
        if (*other || strcmp(name, "radii") == 0) continue;
        if (!is_of_radii(name)) {
            rp_guess guess = rp_guess_of(name);
            for (other = others; *other; other++) rp_guess_try(&guess, *other);
            return rp_config_fail(key, "%s: unknown key%s", name, rp_guess_text(&guess));
        }
        RP_TRY(rp_config_value(key, rp_params_find(fill_schema, name), &entry));
    }
    if (given || !as) RP_TRY(read_radii(group, &entry.fill));
    *radii = entry.fill;
    if (!dem_radii_check(radii)) return RP_OK;
    if (given) free((void *)radii->radii);
    return rp_config_fail(group, "%s", rp_message());
}

static rp_status check_fill(const config_setting_t *group, const scene_file *file, const dem_fill *f)
{
    static const char *const patterns[] = {"random", "row", "lattice"};
    rp_status status = dem_radii_check(f);
    if (!status && f->density < 0.0) status = dem_density_check(file->physics.shape, file->has_density);
    if (status) return rp_config_fail(group, "%s", rp_message());
    if (f->N < 0 && f->pattern == DEM_PATTERN_RANDOM)
        return rp_config_fail(group, "N: missing (number of grains)");
    if (f->spacing > 0.0 && f->pattern == DEM_PATTERN_RANDOM)
        return rp_config_fail(group, "spacing: of a row or a lattice");
    if (f->spacing > 0.0 && f->spacing < 2.0 * (1.0 - DEM_SPACING_OVERLAP) * dem_radius_most(f))
        return rp_config_fail(group, "spacing = %g: grains of radius %g overlap by more than a tenth",
                              f->spacing, dem_radius_most(f));
    if (f->H < 0.0 && f->pattern != DEM_PATTERN_ROW)
        return rp_config_fail(group, "H: missing (height of the region of a %s fill)", patterns[f->pattern]);
    return RP_OK;
}

/* Number k of the fills. */
static rp_status read_fill(const config_setting_t *group, scene_file *file, size_t k)
{
    static const char *const others[] = {"radii", "polygon", "if", NULL};
    dem_scene *scene = &file->scene;
    dem_fill *f = k == 0 ? &scene->fill : &scene->more[k - 1];
    fill_entry entry = {0};
    if (!config_setting_is_group(group)) return rp_config_fail(group, "fill: a group { ... } expected");
    rp_params_defaults(fill_schema, &entry);
    RP_TRY(rp_config_group(group, fill_schema, &entry, others));
    double *corners = NULL;
    rp_status status = read_radii(group, &entry.fill);
    const config_setting_t *polygon = config_setting_get_member(group, "polygon");
    if (!status && polygon) status = read_points(polygon, 3, &entry.fill.n_corners, &corners);
    entry.fill.corners = corners;
    *f = entry.fill; /* its radii and corners are the scene's, also after an error */
    if (!status) status = check_fill(group, file, f);
    if (status) return status;
    if (strlen(entry.kind) >= DEM_NAME_BYTES || strspn(entry.kind, RP_NAME_LETTERS) != strlen(entry.kind) ||
        isdigit((unsigned char)*entry.kind))
        return rp_config_fail(group, "kind = \"%s\": up to %d letters, digits and _ expected", entry.kind,
                              DEM_NAME_BYTES - 1);
    snprintf(scene->kinds[k], sizeof *scene->kinds, "%s", entry.kind);
    f->number = (long)k;
    f->shape = file->physics.shape;
    if (f->density < 0.0) f->density = file->physics.density;
    if (f->H < 0.0) f->H = INFINITY;
    return RP_OK;
}

static rp_status read_fills(const config_setting_t *fill, scene_file *file)
{
    dem_scene *scene = &file->scene;
    const bool list = config_setting_is_list(fill);
    const size_t n = list ? (size_t)config_setting_length(fill) : 1;
    if (n == 0) return rp_config_fail(fill, "fill: a group { ... }, or a list of one or more, expected");
    scene->more = calloc(n + 1, sizeof *scene->more);
    scene->kinds = calloc(n + 1, sizeof *scene->kinds);
    if (!scene->more || !scene->kinds) return rp_fail(RP_NO_MEMORY, "fills: out of memory");
    size_t there = 0;
    for (size_t k = 0; k < n; k++) {
        const config_setting_t *group = list ? config_setting_get_elem(fill, (unsigned)k) : fill;
        bool wanted;
        RP_TRY(is_wanted(group, &wanted));
        if (!wanted) continue;
        scene->has_fill = true;
        scene->n_more = there;
        RP_TRY(read_fill(group, file, there));
        there++;
    }
    return RP_OK;
}

/* A table, whose relative name is meant from the scene file's folder, at one step. */
static rp_status read_step(rp_arena *arena, const char *path, const char *name, long step, rp_table *table)
{
    const char *slash = strrchr(path, '/');
    const int folder = slash && *name != '/' ? (int)(slash - path) + 1 : 0;
    RP_TRY(rp_path(arena, &name, "%.*s%s", folder, path, name));
    RP_TRY(rp_table_read(name, table));
    return take_step(table, step);
}

static int by_number(const void *a, const void *b)
{
    const double *p = a, *q = b;
    return (*p > *q) - (*p < *q);
}

/* The contacts, with their springs, of grains that were read from rows of states; ids rise there. Those with
 * grains and walls that are gone are left out. */
static rp_status read_contacts(rp_arena *arena, const rp_table *states, const rp_table *table,
                               scene_file *file)
{
    dem_definition *def = &file->scene.def;
    const size_t m = table->n_rows, n = states->n_rows;
    double *id, *v;
    RP_TRY(rp_columns_read(arena, states, "id", &id));
    RP_TRY(rp_columns_read(arena, table, "id_a,id_b,wall,x_b,y_b,overlap,shear_spring,rolling_spring", &v));
    dem_contact *c = file->scene.contacts = calloc(m + 1, sizeof *c);
    if (!c) return rp_fail(RP_NO_MEMORY, "%s: out of memory", table->path);
    for (size_t k = 0; k < m; k++, v++) {
        const double *a = bsearch(v, id, n, sizeof *id, by_number),
                     *b = v[m] > 0.0 ? bsearch(v + m, id, n, sizeof *id, by_number) : NULL;
        const bool wall = v[2 * m] >= 1.0 && v[2 * m] <= (double)def->n_walls;
        if (!a || a == b || (!b && !wall)) continue;
        const dem_grain *p = &file->scene.grains[a - id], *q = &file->scene.grains[b ? b - id : 0];
        const dem_wall *w = b ? NULL : &dem_walls_of(def)[(size_t)v[2 * m] - 1];
        const double overlap = b ? p->r + q->r - rp_hypot(p->x - q->x, p->y - q->y)
                                 : p->r - rp_hypot(p->x - v[3 * m], p->y - v[4 * m]),
                     off = b ? 0.0
                             : (v[3 * m] - w->point[0]) * w->direction[0] +
                                   (v[4 * m] - w->point[1]) * w->direction[1];
        if (!(fabs(overlap - v[5 * m]) + fabs(off) <= 1e-6 * p->r))
            return rp_fail(RP_BAD_INPUT,
                           "%s:%zu: no contact of these grains and walls, which keep their numbers",
                           table->path, table->places[k].line);
        *c++ = (dem_contact){.id_a = (uint32_t)(a - id) + 1,
                             .id_b = b ? (uint32_t)(b - id) + 1 : 0,
                             .wall = b ? -1 : (int)v[2 * m] - 1,
                             .shear_spring = v[6 * m],
                             .rolling_spring = v[7 * m]};
    }
    def->contacts = file->scene.contacts;
    def->n_contacts = (size_t)(c - file->scene.contacts);
    return RP_OK;
}

/* Columns of grains, and those of states that follow from them. */
#define USED ",x,y,r,m,vx,vy,angle,omega,fixed,step,t,id,fx,fy,contacts,index,"

/* The first group `add` of phases; NULL: none. */
static const config_setting_t *first_add(const config_setting_t *phases)
{
    const config_setting_t *add = NULL;
    const int n = phases && config_setting_is_list(phases) ? config_setting_length(phases) : 0;
    for (int i = 0; i < n && !add; i++) {
        const config_setting_t *phase = config_setting_get_elem(phases, (unsigned)i);
        if (!config_setting_is_group(phase)) continue;
        add = config_setting_get_member(phase, "add");
        if (!add) add = first_add(config_setting_get_member(phase, "phases"));
    }
    return add && config_setting_is_group(add) ? add : NULL;
}

static rp_status read_grains(const char *path, const config_setting_t *root, scene_file *file)
{
    const config_setting_t *list = config_setting_get_member(root, "particles");
    const config_setting_t *fill = config_setting_get_member(root, "fill");
    const bool from_table = file->particles_file && *file->particles_file;
    const bool added = first_add(config_setting_get_member(root, "phases")) != NULL;
    if (list && from_table)
        return rp_config_fail(config_setting_get_member(root, "particles_file"),
                              "particles and particles_file; keep one");
    if (!(list || fill || from_table || added))
        return rp_fail(RP_BAD_INPUT, "%s: no grains: particles, particles_file or fill is needed", path);
    if (!from_table && (file->particles_step >= 0 || *file->contacts_file))
        return rp_fail(RP_BAD_INPUT, "%s: %s: needs particles_file", path,
                       *file->contacts_file ? "contacts_file" : "particles_step");
    if (*file->contacts_file && file->scene.def.ground.wall)
        return rp_fail(RP_BAD_INPUT, "%s: contacts_file: its table does not have the wells of a ground",
                       path);
    file->scene.from_table = from_table;
    if (fill) RP_TRY(read_fills(fill, file));
    if (!list && !from_table) return RP_OK;
    if (list) return read_particles(list, file);
    rp_arena arena = {0};
    rp_table table = {0}, contacts = {0};
    rp_status status = read_step(&arena, path, file->particles_file, file->particles_step, &table);
    if (!status && table.n_rows == 0) status = rp_fail(RP_BAD_INPUT, "%s: no particles", table.path);
    if (!status) status = read_particles_table(&table, file);
    if (!status) rp_columns_beside(&table, USED, file->scene.unused);
    if (!status && *file->contacts_file) {
        const int step = rp_table_column(&table, "step");
        status = read_step(&arena, path, file->contacts_file, step < 0 ? -1 : atol(rp_cell(&table, 0, step)),
                           &contacts);
        if (!status) status = read_contacts(&arena, &table, &contacts, file);
    }
    rp_table_free(&contacts);
    rp_table_free(&table);
    rp_arena_release(&arena, NULL);
    return status;
}

/* Read "v = VALUE;"; a bare word is a string. Afterwards config_destroy, also after an error. */
static rp_status read_value(const char *value, config_t *one)
{
    char line[512];
    rp_status status = RP_OK;
    config_init(one);
    for (int quoted = 0; quoted < 2 && !status; quoted++) {
        const int n = snprintf(line, sizeof line, quoted ? "v = \"%s\";" : "v = %s;", value);
        if (n >= (int)sizeof line) return rp_fail(RP_BAD_INPUT, "--set: a value of more than 500 bytes");
        status = rp_config_scan_text("--set", line);
        if (!status && config_read_string(one, line) && config_setting_length(config_root_setting(one)) == 1)
            return RP_OK;
    }
    return status ? status : rp_fail(RP_BAD_INPUT, "--set: cannot read the value");
}

static rp_status no_member(const config_setting_t *group, const char *name, const char *text)
{
    rp_guess guess = rp_guess_of(name);
    for (int i = 0; i < config_setting_length(group); i++)
        rp_guess_try(&guess, config_setting_name(config_setting_get_elem(group, (unsigned)i)));
    return rp_fail(RP_BAD_INPUT, "--set %s: the file has no such group%s", text, rp_guess_text(&guess));
}

/* The index in "walls[2]", which ends the name there; -1 for a name alone, -2 for no index. */
static long take_index(char *name)
{
    char *open = strchr(name, '['), *end;
    if (!open) return -1;
    const long i = strtol(open + 1, &end, 10);
    const bool whole = isdigit((unsigned char)open[1]) && strcmp(end, "]") == 0;
    *open = '\0';
    return whole ? i : -2;
}

/* One step of a path: the member `name` of the group, or its entry where the name has an index. */
static rp_status step_into(char *name, const char *text, config_setting_t **group)
{
    const long i = take_index(name);
    config_setting_t *member = config_setting_get_member(*group, name);
    for (int k = 1; k <= 3 && !member && i == -1 && config_setting_is_root(*group);
         k++) /* laws have defaults */
        if (strcmp(name, dem_scene_schemas[k].name) == 0)
            member = config_setting_add(*group, name, CONFIG_TYPE_GROUP);
    if (!member) return no_member(*group, name, text);
    const int n = config_setting_length(member);
    if (config_setting_is_list(member) && (i < 0 || i >= n))
        return rp_fail(RP_BAD_INPUT, "--set %s: %s is a list of %d entries: %s[0] to %s[%d]", text, name, n,
                       name, name, n - 1);
    if (!config_setting_is_list(member) && i != -1)
        return rp_fail(RP_BAD_INPUT, "--set %s: %s is no list with entries", text, name);
    *group = i < 0 ? member : config_setting_get_elem(member, (unsigned)i);
    if (config_setting_is_group(*group)) return RP_OK;
    return rp_fail(RP_BAD_INPUT, "--set %s: %s has no keys of its own", text, name);
}

/* Add a copy of the value to a group under this name; to a list or an array without a name. */
static bool add_copy(config_setting_t *parent, const char *name, const config_setting_t *value)
{
    const int type = config_setting_type(value);
    config_setting_t *copy = config_setting_add(parent, name, type);
    if (!copy) return false;
    switch (type) {
    case CONFIG_TYPE_INT: return config_setting_set_int(copy, config_setting_get_int(value));
    case CONFIG_TYPE_INT64: return config_setting_set_int64(copy, config_setting_get_int64(value));
    case CONFIG_TYPE_FLOAT: return config_setting_set_float(copy, config_setting_get_float(value));
    case CONFIG_TYPE_BOOL: return config_setting_set_bool(copy, config_setting_get_bool(value));
    case CONFIG_TYPE_STRING: return config_setting_set_string(copy, config_setting_get_string(value));
    default: break;
    }
    bool whole = true;
    for (int i = 0; i < config_setting_length(value) && whole; i++) {
        const config_setting_t *part = config_setting_get_elem(value, (unsigned)i);
        whole = add_copy(copy, config_setting_name(part), part);
    }
    return whole;
}

static bool has_let(const config_t *config, const char *name)
{
    const config_setting_t *let = config_lookup(config, "let");
    return let && config_setting_get_member(let, name);
}

rp_status dem_text_give(dem_text *text, const char *name, const rp_value *value)
{
    rp_lets *lets = &text->lets;
    size_t k = 0;
    while (k < lets->n_given && strcmp(lets->given[k].name, name) != 0) k++;
    if (!has_let(&text->config, name)) return rp_fail(RP_BAD_INPUT, "let: the text has no %s", name);
    if (k == RP_LETS_MOST) return rp_fail(RP_BAD_INPUT, "let: more than %d values are given", RP_LETS_MOST);
    lets->given[k] = (rp_let_given){
        config_setting_name(config_setting_get_member(config_lookup(&text->config, "let"), name)), *value};
    if (value->kind == RP_V_TEXT) {
        RP_NEW(&text->memory, lets->given[k].value.s, strlen(value->s));
        strcpy((char *)lets->given[k].value.s, value->s);
    }
    if (k == lets->n_given) lets->n_given++;
    return RP_OK;
}

#define NAMED_KEY(...) NAMED_KEY_OF(__VA_ARGS__)
#define NAMED_KEY_OF(group, kind, type, name, key, unit, fallback, range, also, automatic, wall, ...)        \
    {{#name, unit, type, 0, fallback, DEM_ALLOWED_##kind(range, also), __VA_ARGS__}, group key},
#define OF_TOP(...)        NAMED_KEY("", __VA_ARGS__)
#define OF_NORMAL(...)     NAMED_KEY("normal.", __VA_ARGS__)
#define OF_TANGENTIAL(...) NAMED_KEY("tangential.", __VA_ARGS__)
#define OF_ROLLING(...)    NAMED_KEY("rolling.", __VA_ARGS__)
#define OF_FILL(...)       NAMED_KEY("fill.", __VA_ARGS__)
const dem_named_key dem_named_keys[] = {
    DEM_GRAIN_PARAMS(OF_TOP) DEM_NORMAL_PARAMS(OF_NORMAL) DEM_TANGENTIAL_PARAMS(OF_TANGENTIAL)
        DEM_ROLLING_PARAMS(OF_ROLLING) DEM_RADIUS_PARAMS(OF_FILL){{0}, NULL}};

/* Put "group.key=value" or "list[0].key=value" into the tree that was read, instead of what stands there. */
rp_status dem_text_change(dem_text *scene, const char *text)
{
    config_t *config = &scene->config;
    char path[128];
    const char *equals = strchr(text, '=');
    if (!equals || equals == text || equals - text >= (long)sizeof path)
        return rp_fail(RP_BAD_INPUT, "--set %s: key=value expected", text);
    snprintf(path, sizeof path, "%.*s", (int)(equals - text), text);
    for (char *dot; (dot = strstr(path, ".["));)
        memmove(dot, dot + 1, strlen(dot)); /* libconfig's spelling */
    config_t one;
    rp_status status = read_value(equals + 1, &one);
    config_setting_t *group = config_root_setting(config);
    char *key = path;
    for (char *dot; !status && (dot = strchr(key, '.')); key = dot + 1) {
        *dot = '\0';
        status = step_into(key, text, &group);
    }
    rp_value value;
    if (!status && key == path && has_let(config, key) &&
        !rp_config_scalar(config_lookup(&one, "v"), &value)) {
        status = dem_text_give(scene, key, &value);
        config_destroy(&one);
        return status;
    }
    for (const dem_named_key *k = dem_named_keys; k->key && key == path && !status; k++)
        if (strcmp(k->param.name, key) == 0 && strchr(k->key, '.') && strncmp(k->key, key, strlen(key)) != 0)
            status = rp_fail(RP_BAD_INPUT, "--set %s: of a scene the key is %s", text, k->key);
    if (!status && strchr(key, '['))
        status = rp_fail(RP_BAD_INPUT, "--set %s: give a key of the entry, or the whole list", text);
    if (!status) {
        if (config_setting_get_member(group, key)) config_setting_remove(group, key);
        if (!add_copy(group, key, config_lookup(&one, "v")))
            status = rp_fail(RP_BAD_INPUT, "--set %s: not a key", text);
    }
    config_destroy(&one);
    return status;
}

/* A let, with the value that it was given. */
static void write_let(const rp_lets *lets, const config_setting_t *let, FILE *out)
{
    const rp_let_given *given = lets->given;
    while (given < lets->given + lets->n_given && strcmp(given->name, config_setting_name(let)) != 0) given++;
    fprintf(out, "  %s = ", config_setting_name(let));
    if (given == lets->given + lets->n_given) {
        rp_config_write_value(out, let);
    } else if (!config_setting_is_group(let)) {
        rp_config_write_scalar(out, &given->value);
    } else {
        fputs("{ ", out);
        for (int i = 0; i < config_setting_length(let); i++) {
            const config_setting_t *m = config_setting_get_elem(let, (unsigned)i);
            const bool value = strcmp(config_setting_name(m), "value") == 0;
            fprintf(out, "%s = ", config_setting_name(m));
            value ? rp_config_write_scalar(out, &given->value) : rp_config_write_value(out, m);
            fputs("; ", out);
        }
        fputc('}', out);
    }
    fputs(";\n", out);
}

void dem_text_write(const dem_text *text, unsigned long seed, unsigned long stream, FILE *out)
{
    const config_setting_t *root = config_root_setting(&text->config);
    fprintf(out, "seed = %lu;\nrun = %lu;\n", seed, stream);
    for (int i = 0; i < config_setting_length(root); i++) {
        const config_setting_t *s = config_setting_get_elem(root, (unsigned)i);
        const char *name = config_setting_name(s);
        const bool let = strcmp(name, "let") == 0;
        if (strcmp(name, "seed") == 0 || strcmp(name, "run") == 0) continue;
        fprintf(out, "%s = ", name);
        if (let) fputs("{\n", out);
        for (int k = 0; k < config_setting_length(s) && let; k++)
            write_let(&text->lets, config_setting_get_elem(s, (unsigned)k), out);
        let ? (void)fputc('}', out) : rp_config_write_value(out, s);
        fputs(";\n", out);
    }
}

/* The first fill that is there; NULL: none. */
static rp_status first_fill(const config_setting_t *root, const config_setting_t **first)
{
    const config_setting_t *fill = config_setting_get_member(root, "fill");
    const bool list = fill && config_setting_is_list(fill);
    const int n = list ? config_setting_length(fill) : fill != NULL;
    *first = NULL;
    for (int k = 0; k < n && !*first; k++) {
        const config_setting_t *group = list ? config_setting_get_elem(fill, (unsigned)k) : fill;
        bool wanted;
        RP_TRY(is_wanted(group, &wanted));
        if (wanted && config_setting_is_group(group)) *first = group;
    }
    return RP_OK;
}

/* What tells the radii of the first fill. Afterwards free its radii, also after an error. */
static rp_status peek_radii(const config_setting_t *fill, fill_entry *entry)
{
    static const char *const keys[] = {"radius_mean", "radius_width", "radius_min", "radius_max",
                                       "radius_law",  "by",           "density"};
    rp_params_defaults(fill_schema, entry);
    for (size_t k = 0; k < sizeof keys / sizeof *keys; k++) RP_TRY(peek(fill, fill_schema, keys[k], entry));
    RP_TRY(read_radii(fill, &entry->fill));
    return entry->fill.law == DEM_RADII_TABLE ? dem_radii_check(&entry->fill) : RP_OK;
}

/* Radius and density of the mean grain of the first fill, of the particles, or of what a phase adds first; 0:
 * unknown. */
static rp_status mean_grain(const config_setting_t *root, double *r, double *density)
{
    const config_setting_t *fill, *list = config_setting_get_member(root, "particles"),
                                  *add = first_add(config_setting_get_member(root, "phases"));
    *r = *density = 0.0;
    RP_TRY(first_fill(root, &fill));
    if (!fill && !list && add && config_setting_get_member(add, "r")) {
        dem_grain grain = {0};
        RP_TRY(peek(add, particle_schema, "r", &grain));
        return *r = grain.r, RP_OK;
    }
    if (!fill && !list) fill = add;
    if (fill) {
        fill_entry entry = {0};
        rp_status status = peek_radii(fill, &entry);
        if (!status) *r = dem_radius_mean(&entry.fill), *density = fmax(entry.fill.density, 0.0);
        free((void *)entry.fill.radii);
        return status;
    }
    const int n = list ? config_setting_length(list) : 0;
    for (int i = 0; i < n; i++) {
        dem_grain grain = {0};
        RP_TRY(peek(config_setting_get_elem(list, (unsigned)i), particle_schema, "r", &grain));
        *r += grain.r / n;
    }
    return RP_OK;
}

/* Of particles that are listed with their masses, the mean of these; else it stays. */
static rp_status mean_mass(const config_setting_t *root, double one, double *m)
{
    const config_setting_t *list = config_setting_get_member(root, "particles"), *fill;
    RP_TRY(first_fill(root, &fill));
    const int n = list && !fill && config_setting_is_list(list) ? config_setting_length(list) : 0;
    double sum = 0.0;
    for (int i = 0; i < n; i++) {
        dem_grain grain = {.m = one};
        RP_TRY(peek(config_setting_get_elem(list, (unsigned)i), particle_schema, "m", &grain));
        sum += grain.m > 0.0 ? grain.m : one;
    }
    if (n > 0) *m = sum / n;
    return RP_OK;
}

/* What d, m, g and dt are in this file's expressions. */
static rp_status know(void *host, rp_let_constant which, double *value)
{
    const config_setting_t *root = config_root_setting(&((dem_text *)host)->config),
                           *gravity = config_setting_get_member(root, "gravity");
    scene_file file = {.scene = {.def = dem_definition_default()}};
    double r = 0.0, density = 0.0, g[2] = {0.0, rp_units_value("cm/s^2", file.scene.def.gravity[1])};
    rp_params_defaults(top_schema, &file);
    if (which == RP_LET_DT) {
        RP_TRY(peek(root, top_schema, "dt", &file));
        return *value = file.physics.dt, RP_OK;
    }
    if (which == RP_LET_G) {
        if (gravity) RP_TRY(rp_config_pair(gravity, g));
        return *value = rp_hypot(g[0], g[1]), RP_OK;
    }
    RP_TRY(mean_grain(root, &r, &density));
    RP_TRY(peek(root, top_schema, "shape", &file));
    if (which == RP_LET_M) RP_TRY(peek(root, top_schema, "density", &file));
    if (density > 0.0) file.physics.density = density;
    if (!(r > 0.0)) return RP_OK;
    const double m = dem_mass(file.physics.shape, file.physics.density, r);
    *value = which == RP_LET_D ? 2.0 * r : m;
    return which == RP_LET_M ? mean_mass(root, m, value) : RP_OK;
}

/* dt_limit(v, r): the largest time step of this file for impacts at v of grains of radius r, by default the
 * smallest of its first fill; the fall from any height aside. */
static rp_status dt_limit(void *host, const char *name, int n, const double args[], double *value,
                          bool *known)
{
    dem_text *text = host;
    const config_setting_t *root = config_root_setting(&text->config), *fill;
    scene_file file = {.scene = {.def = dem_definition_default()}};
    dem_definition *def = &file.scene.def;
    fill_entry f = {0};
    double r = 0.0, density = 0.0;
    const char *what;
    if (strcmp(name, "dt_limit") != 0) return RP_OK;
    if (n < 1 || n > 2 || !(args[0] >= 0.0) || isinf(args[0]) || (n == 2 && !(args[1] > 0.0)))
        return rp_fail(RP_BAD_INPUT, "dt_limit: a speed and, if wanted, a radius expected");
    RP_TRY(first_fill(root, &fill));
    rp_params_defaults(top_schema, &file);
    RP_TRY(peek(root, top_schema, "rotation", &file));
    RP_TRY(peek(root, top_schema, "integrator", &file));
    RP_TRY(peek(root, top_schema, "shape", &file));
    RP_TRY(peek(root, top_schema, "density", &file));
    for (size_t k = 1; k <= 3; k++) rp_params_defaults(dem_scene_schemas[k].schema, &file.physics);
    RP_TRY(read_physics(root, &file, def));
    rp_status status = read_walls(root, &file.scene);
    if (!status) status = mean_grain(root, &r, &density);
    if (!status && fill) {
        status = peek_radii(fill, &f);
        if (!status) r = dem_radius_least(&f.fill);
        free((void *)f.fill.radii);
    }
    if (density > 0.0) file.physics.density = density;
    if (n == 2) r = args[1];
    if (!status && !(r > 0.0)) status = rp_fail(RP_BAD_INPUT, "dt_limit: no grains are known here");
    const double m = dem_mass(file.physics.shape, file.physics.density, r);
    const dem_grain two[2] = {{.r = r, .m = m, .vx = 0.5 * args[0]}, {.x = 3.0 * r, .r = r, .m = m}};
    def->grains = two, def->n_grains = 2;
    def->gravity[0] = def->gravity[1] = 0.0;
    *known = true;
    if (!status) *value = dem_time_step_limit(def, &what);
    def->grains = NULL;
    dem_scene_free(&file.scene);
    return status;
}

rp_status dem_text_open(const char *path, const rp_texts *changes, dem_text *text)
{
    return dem_text_open_bytes(path, NULL, changes, text);
}

rp_status dem_text_open_bytes(const char *name, const char *bytes, const rp_texts *changes, dem_text *text)
{
    const char *units = NULL;
    *text = (dem_text){.path = name};
    RP_TRY(bytes ? rp_config_read_text(name, bytes, &text->config) : rp_config_read(name, &text->config));
    for (size_t i = 0; changes && i < changes->n; i++) RP_TRY(dem_text_change(text, changes->items[i]));
    config_lookup_string(&text->config, "units", &units);
    rp_units_set(rp_units_find(units));
    return RP_OK;
}

void dem_text_close(dem_text *text)
{
    rp_lets_end(&text->lets);
    rp_arena_end(&text->memory);
    config_destroy(&text->config);
}

/* `seed` and `run` of the text go before those of its first fill, and are for what phases add too. */
static rp_status read_streams(const config_setting_t *root, dem_scene *scene)
{
    fill_entry entry = {.fill = scene->fill};
    if (!scene->has_fill) rp_params_defaults(fill_schema, &entry);
    RP_TRY(peek(root, fill_schema, "seed", &entry));
    RP_TRY(peek(root, fill_schema, "run", &entry));
    scene->fill.seed = entry.fill.seed, scene->fill.run = entry.fill.run;
    return RP_OK;
}

static rp_status read_scene(dem_text *text, scene_file *file)
{
    static const char *const others[] = {"let",    "material",  "gravity", "normal", "tangential", "rolling",
                                         "walls",  "particles", "fill",    "ground", "hard",       "implicit",
                                         "phases", "measure",   "regions", "rest",   "result",     "seed",
                                         "run",    "output",    "require", NULL};
    config_setting_t *root = config_root_setting(&text->config);
    rp_params_defaults(top_schema, file);
    dem_definition *def = &file->scene.def;
    def->gravity[1] = rp_units_value("cm/s^2", def->gravity[1]);
    for (int k = 0; k < RP_LET_CONSTANTS; k++) text->lets.constants[k] = NAN;
    text->lets.know = know, text->lets.call = dt_limit, text->lets.host = text;
    RP_TRY(rp_lets_read(root, &text->lets));
    const config_setting_t *gravity = config_setting_get_member(root, "gravity");
    if (gravity) RP_TRY(rp_config_pair(gravity, def->gravity));
    RP_TRY(rp_config_group(root, top_schema, file, others));
    file->has_density = config_setting_get_member(root, "density") != NULL;
    def->skin = fmax(def->skin, 0.0);
    def->x_min = isinf(file->x_min) ? -INFINITY : file->x_min;
    def->y_min = isinf(file->y_min) ? -INFINITY : file->y_min;
    def->turn_per_step = file->turn_deg * (M_PI / 180.0);
    def->box_turn_per_step = file->box_turn_deg * (M_PI / 180.0);
    for (size_t k = 1; k <= 3; k++) rp_params_defaults(dem_scene_schemas[k].schema, &file->physics);
    RP_TRY(read_physics(root, file, def));
    file->scene.laws = (dem_scene_laws){file->physics, {def->x_min, def->x_max, def->y_min}};
    RP_TRY(read_walls(root, &file->scene));
    const config_setting_t *implicit = config_setting_get_member(root, "implicit");
    RP_TRY(read_group(root, "ground", ground_schema, &def->ground, NULL));
    RP_TRY(read_group(root, "hard", hard_schema, &def->hard, &def->hard.on));
    if (implicit && !dem_schemes[def->integrator]->solves)
        return rp_config_fail(implicit, "implicit: needs integrator = \"implicit\"");
    RP_TRY(read_group(root, "implicit", implicit_schema, &def->implicit, NULL));
    rp_params_defaults(output_schema, &file->scene.output);
    RP_TRY(read_group(root, "output", output_schema, &file->scene.output, NULL));
    file->scene.phases = config_setting_get_member(root, "phases") != NULL;
    RP_TRY(read_grains(text->path, root, file));
    return read_streams(root, &file->scene);
}

rp_status dem_text_scene(dem_text *text, dem_scene *scene)
{
    scene_file file = {.scene = {.def = dem_definition_default()}};
    rp_status status = read_scene(text, &file);
    *scene = file.scene;
    return status;
}

rp_status dem_scene_read(const char *path, const rp_texts *changes, dem_scene *scene)
{
    dem_text text;
    *scene = (dem_scene){0};
    rp_status status = dem_text_open(path, changes, &text);
    if (!status) status = dem_text_scene(&text, scene);
    dem_text_close(&text);
    return status;
}

dem_fill *dem_scene_fill_at(dem_scene *scene, size_t k)
{
    if (!scene->has_fill || k > scene->n_more) return NULL;
    return k == 0 ? &scene->fill : &scene->more[k - 1];
}

void dem_scene_free(dem_scene *scene)
{
    dem_fill *fill;
    for (size_t k = 0; (fill = dem_scene_fill_at(scene, k)); k++)
        free((void *)fill->radii), free((void *)fill->corners), fill->radii = fill->corners = NULL;
    free(scene->grains), free(scene->walls), free(scene->names), free(scene->lines), free(scene->contacts);
    free(scene->more), free(scene->kinds), free(scene->given);
    scene->grains = NULL, scene->walls = NULL, scene->names = NULL, scene->lines = NULL;
    scene->contacts = NULL, scene->more = NULL, scene->kinds = NULL, scene->given = NULL;
    scene->n_names = scene->n_more = 0;
    scene->def.wall_list = NULL;
}

rp_status dem_scene_grains(const dem_scene *scene, dem_grain **grains, size_t *n, size_t ends[])
{
    const size_t listed = scene->grains ? scene->def.n_grains : 0;
    size_t room = listed + 1;
    const dem_fill *fill;
    for (size_t k = 0; (fill = dem_scene_fill_at((dem_scene *)scene, k)); k++) room += dem_fill_most(fill);
    if (room > DEM_MOST_GRAINS)
        return rp_fail(RP_BAD_INPUT, "fill: room for %zu particles: at most %d", room, DEM_MOST_GRAINS);
    *grains = malloc(room * sizeof **grains);
    if (!*grains) return rp_fail(RP_NO_MEMORY, "%zu particles: out of memory", room);
    if (listed) memcpy(*grains, scene->grains, listed * sizeof **grains);
    *n = listed;
    for (size_t k = 0; (fill = dem_scene_fill_at((dem_scene *)scene, k)); k++) {
        dem_fill one = *fill;
        const char *kind = scene->kinds ? scene->kinds[k] : "";
        size_t placed = 0;
        one.seed = scene->fill.seed, one.run = scene->fill.run, one.cut = scene->fill.cut;
        one.walls = dem_walls_of(&scene->def), one.n_walls = scene->def.n_walls;
        one.n_there = *n;
        if (k > 0) one.streams[0] = one.streams[1] = NULL;
        RP_TRY(rp_prefix(dem_fill_grains(&one, *grains + *n, &placed), "%s%s", kind, *kind ? ": " : ""));
        *n += placed;
        if (ends) ends[k] = *n;
    }
    return RP_OK;
}

rp_status dem_scene_start(const dem_scene *scene, dem_sim **sim)
{
    *sim = NULL;
    dem_definition def = scene->def;
    if (!scene->has_fill) {
        def.grains = scene->grains;
        def.lines = scene->lines;
        return dem_create(&def, sim);
    }
    dem_grain *grains = NULL;
    rp_status status = dem_scene_grains(scene, &grains, &def.n_grains, NULL);
    def.grains = grains;
    if (!status) status = dem_create(&def, sim);
    free(grains);
    return status;
}

static void write_pair(FILE *out, const char *key, const double pair[2])
{
    fprintf(out, "%s = ( %.17g, %.17g ); ", key, pair[0], pair[1]);
}

static void write_group(FILE *out, const char *key, const rp_param *schema, const void *values)
{
    fprintf(out, "%s = { ", key);
    rp_config_write(out, schema, values);
    fputs("};\n", out);
}

static void write_top(FILE *out, const dem_scene *scene)
{
    const dem_definition *def = &scene->def;
    const double density = scene->has_fill ? scene->fill.density : dem_physics_default().density;
    scene_file file = {.scene = *scene,
                       .physics = dem_physics_of(def, density),
                       .particles_file = "",
                       .particles_step = -1,
                       .contacts_file = ""};
    if (def->skin == 0.0) file.scene.def.skin = -1.0;
    file.x_min = isinf(def->x_min) ? INFINITY : def->x_min;
    file.y_min = isinf(def->y_min) ? INFINITY : def->y_min;
    file.turn_deg = def->turn_per_step * (180.0 / M_PI);
    file.box_turn_deg = def->box_turn_per_step * (180.0 / M_PI);
    if (scene->has_fill) file.physics.shape = scene->fill.shape;
    file.units = (int)rp_units_now();
    write_pair(out, "gravity", def->gravity);
    rp_config_write(out, top_schema, &file);
    fputc('\n', out);
}

static void write_walls(FILE *out, const dem_scene *scene)
{
    const dem_definition *def = &scene->def;
    fputs("walls = (", out);
    for (size_t w = 0; w < def->n_walls; w++) {
        const dem_wall *wall = &dem_walls_of(def)[w];
        wall_entry entry = {.line = *wall};
        fputs(w ? ",\n  { " : "\n  { ", out);
        if (w < scene->n_names && *scene->names[w]) fprintf(out, "name = \"%s\"; ", scene->names[w]);
        write_pair(out, "point", wall->point);
        write_pair(out, "direction", wall->direction);
        /* libconfig has no infinity: an open end is written as a number far away */
        double ends[2] = {fmax(wall->extent[0], -1e300), fmin(wall->extent[1], 1e300)};
        if (isfinite(wall->extent[0]) || isfinite(wall->extent[1])) write_pair(out, "extent", ends);
        if (dem_wall_moves(wall)) {
            write_pair(out, "velocity", wall->velocity);
            write_pair(out, "pivot", wall->pivot);
        }
        rp_config_write(out, wall_schema + SHAPE_ROWS, &entry);
        fputs("}", out);
    }
    fputs(" );\n", out);
}

static void write_particles(FILE *out, const dem_scene *scene)
{
    fputs("particles = (", out);
    for (size_t i = 0; i < scene->def.n_grains; i++) {
        fputs(i ? ",\n  { " : "\n  { ", out);
        rp_config_write(out, particle_schema, &scene->grains[i]);
        fputs("}", out);
    }
    fputs(" );\n", out);
}

/* A fill: the rows that it always had, then those that are not at their defaults, so that a new one leaves
 * keys as they are. */
static void write_fill(FILE *out, const fill_entry *entry, double density)
{
    fill_entry plain = {.kind = ""};
    char is[512], was[512];
    rp_params_defaults(fill_schema, &plain);
    plain.fill.density = density;
    for (const rp_param *row = fill_schema; row->name; row++) {
        rp_params_text(row, entry, is, sizeof is), rp_params_text(row, &plain, was, sizeof was);
        const bool always = row < rp_params_find(fill_schema, "radius_law");
        if (always || strcmp(is, was) != 0) rp_config_write(out, (const rp_param[]){*row, {0}}, entry);
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
    const dem_fill *f;
    fputs(scene->n_more ? "fill = (\n" : "fill = ", out);
    for (size_t k = 0; (f = dem_scene_fill_at((dem_scene *)scene, k)); k++) {
        fill_entry entry = {*f, scene->kinds ? scene->kinds[k] : ""};
        if (isinf(f->H)) entry.fill.H = -1.0;
        if (!(f->spacing > 0.0)) entry.fill.spacing = -1.0;
        fputs(k ? ",\n{ " : "{ ", out);
        write_fill(out, &entry, scene->fill.density);
        write_points(out, "radii", f->n_radii, f->radii);
        write_points(out, "polygon", f->n_corners, f->corners);
        fputs("}", out);
    }
    fputs(scene->n_more ? " );\n" : ";\n", out);
}

void dem_scene_write(const dem_scene *scene, FILE *out)
{
    const dem_definition *def = &scene->def;
    const dem_physics physics = dem_physics_of(def, 0.0);
    write_top(out, scene);
    write_group(out, "normal", normal_schema, &physics);
    write_group(out, "tangential", tangential_schema, &physics);
    write_group(out, "rolling", rolling_schema, &physics);
    write_walls(out, scene);
    if (def->ground.wall) write_group(out, "ground", ground_schema, &def->ground);
    if (def->hard.on) write_group(out, "hard", hard_schema, &def->hard);
    if (dem_schemes[def->integrator]->solves) write_group(out, "implicit", implicit_schema, &def->implicit);
    if (scene->has_fill) write_fills(out, scene);
    if (scene->grains) write_particles(out, scene);
}
