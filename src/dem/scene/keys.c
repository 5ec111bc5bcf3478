/* The keys of a scene file: schemas of its groups, and of the parts that several read. */
#include <ctype.h>
#include <stddef.h>
#include <string.h>

#include "dem/scene/file.h"
#include "dem/scene/radii.h"
#include "params/units.h"

#define AT(type, field) offsetof(type, field)
#define OF_TOP(...)     DEM_KEY_ROW(dem_scene, laws.physics., __VA_ARGS__)
#define ROW(...)        DEM_KEY_ROW(dem_physics, , __VA_ARGS__)

static const rp_param top_schema[] = {
    DEM_GRAIN_PARAMS(OF_TOP){"steps", "", RP_INT, AT(dem_scene, steps), "20000", "[0, 2147483647]",
                             "how many steps to run"},
    {"units", "", RP_CHOICE, AT(dem_scene, def.units), "cgs", RP_UNITS_WORDS,
     "unit system of this file and of its tables; defaults are converted. sigma: the units are diameter "
     "sigma and mass m of the default grain, and g"},
    {"skin", "cm", RP_REAL, AT(dem_scene, def.skin), "auto", "(0, inf) | auto",
     "margin of the neighbour list beyond contact; auto: 0.4 mean radii for its cells, and a margin by its "
     "speed for each grain"},
    {"x_min", "cm", RP_REAL, AT(dem_scene, laws.x_min), "none", "(-inf, inf) | none",
     "grains whose centre is to the left of it, in the box frame, are removed"},
    {"x_max", "cm", RP_REAL, AT(dem_scene, laws.x_max), "none", "(-inf, inf) | none",
     "grains whose centre is to the right of it, in the box frame, are removed"},
    {"y_min", "cm", RP_REAL, AT(dem_scene, laws.y_min), "none", "(-inf, inf) | none",
     "grains whose centre is below it, in the box frame, are removed"},
    {"gravity_turn_deg_per_step", "degree", RP_REAL, AT(dem_scene, turn_deg), "0.0", "[-10, 10]",
     "rotation of gravity per step; positive lowers the side at +x"},
    {"box_turn_deg_per_step", "degree", RP_REAL, AT(dem_scene, box_turn_deg), "0.0", "[-10, 10]",
     "rotation of the walls about the origin per step; positive lowers the side at +x"},
    {"turn_from_step", "", RP_INT, AT(dem_scene, def.turn_from_step), "0", "[0, 2147483647]",
     "first step at which gravity or the box turns"},
    {"kernel", "", RP_CHOICE, AT(dem_scene, def.kernel), "fast", DEM_WORDS(DEM_KERNEL_LIST),
     "instance of the force loops; results are bitwise identical", .manual = DEM_MANUALS(DEM_KERNEL_LIST)},
    {"ledger", "", RP_BOOL, AT(dem_scene, def.ledger), "false", "",
     "whether to keep the energy ledger, which `repose run -o` writes with the energies; slower, with "
     "bitwise identical results"},
    {"particles_file", "", RP_TEXT, AT(dem_scene, particles_file), "", "",
     "table with columns x y r and, if wanted, m vx vy angle omega fixed, or a dump or data file of LAMMPS; "
     "instead of `particles`"},
    {"particles_step", "", RP_INT, AT(dem_scene, particles_step), "last", "[0, 2147483647] | last",
     "step of the table or dump, which may have several"},
    {"pairs_rule", "", RP_CHOICE, AT(dem_scene, laws.pairs_rule), "equal", DEM_WORDS(DEM_PAIR_RULES),
     "what two kinds, or a kind and a wall, have together where `pairs` does not say it",
     .manual = DEM_MANUALS(DEM_PAIR_RULES)},
    {"compressed", "", RP_BOOL, AT(dem_scene, compressed), "false", "",
     "whether listed grains may overlap by more than a tenth of the radius, as in a packing under pressure"},
    {"contacts_file", "", RP_TEXT, AT(dem_scene, contacts_file), "", "",
     "table contacts.tsv that belongs to the states.tsv of `particles_file`, from which the contacts' "
     "springs are taken; without it springs start at 0, and a bed at rest moves"},
    {0}};

static const rp_param normal_schema[] = {DEM_NORMAL_PARAMS(ROW){0}};
static const rp_param tangential_schema[] = {DEM_TANGENTIAL_PARAMS(ROW){0}};
static const rp_param rolling_schema[] = {DEM_ROLLING_PARAMS(ROW){0}};

static const rp_param material_schema[] = {
    {"E", "dyn/cm^2", RP_REAL, AT(dem_scene, E), NULL, "(0, inf)", "Young's modulus"},
    {"nu", "", RP_REAL, AT(dem_scene, nu), NULL, "[0, 0.5]", "Poisson's ratio"},
    {"restitution", "", RP_REAL, AT(dem_scene, laws.physics.restitution), NULL, "(0, 1]",
     "coefficient of restitution at all impact speeds"},
    {"mu", "", RP_REAL, AT(dem_scene, laws.physics.mu), NULL, "[0, inf) | infinite",
     "coefficient of friction"},
    {0}};

static const rp_param ground_schema[] = {
    {"wall", "", RP_INT, AT(dem_ground, wall), "1", "[1, 8]", "number of the wall, from 1; an infinite line"},
    {"mu_static", "", RP_REAL, AT(dem_ground, mu_static), NULL, "[0, inf)",
     "static friction: largest force of a well over the normal force"},
    {"a", "cm", RP_REAL, AT(dem_ground, a), NULL, "(0, inf)", "half-width of a well, beyond which it breaks"},
    {"set", "", RP_CHOICE, AT(dem_ground, set), "rest", DEM_WORDS(DEM_WELL_SETS),
     "when a grain gets its well", .manual = DEM_MANUALS(DEM_WELL_SETS)},
    {0}};

static const rp_param hard_schema[] = {
    {"restitution", "", RP_REAL, AT(dem_hard, restitution), NULL, "[0, 1]",
     "coefficient of restitution of the collisions of bodies that approach fast"},
    {"mu", "", RP_REAL, AT(dem_hard, mu), "0.0", "[0, inf) | infinite",
     "coefficient of friction of collisions"},
    {0}};

static const rp_param implicit_schema[] = {
    {"solver", "", RP_CHOICE, AT(dem_implicit_solver, solver), "direct", DEM_WORDS(DEM_SOLVERS),
     "how a step is solved", .manual = DEM_MANUALS(DEM_SOLVERS)},
    {"relaxation", "", RP_REAL, AT(dem_implicit_solver, relaxation), "0.7", "(0, 2)",
     "relaxation factor of sor"},
    {"tolerance", "", RP_REAL, AT(dem_implicit_solver, tolerance), "1e-15", "[1e-15, 1e-3]",
     "largest Newton correction of a grain over its radius at convergence"},
    {"max_iterations", "", RP_INT, AT(dem_implicit_solver, max_iterations), "1000", "[1, 1000000]",
     "largest number of factorisations or sweeps, after which a step counts as not solved"},
    {0}};

/* A coefficient of a wall, a kind or two kinds, which may be "auto", in member `at` of a structure T. */
#define MAY_BE_AUTO(...) MAY_BE_AUTO_OF(__VA_ARGS__)
#define MAY_BE_AUTO_OF(T, at, says, kind, type, name, key, unit, fallback, range, also, automatic, wall,     \
                       ...)                                                                                  \
    DEM_IF_MATERIAL(kind, {#name, unit, type, AT(T, at name), "auto", range " | auto", says(wall)}, )
#define WALL_SAYS(wall)                                                                                      \
    "for contacts with this wall; auto: " #wall                                                              \
    " times the grains' value, or where that is auto too, from the wall's other coefficients"
#define KIND_SAYS(wall)  "of grains of this kind; auto: the scene's"
#define PAIR_SAYS(wall)  "of contacts of the two; auto: by their own"
#define OF_MATERIAL(...) MAY_BE_AUTO(dem_material, , WALL_SAYS, __VA_ARGS__)
#define OF_ENTRY(...)    MAY_BE_AUTO(dem_wall_entry, line.material., WALL_SAYS, __VA_ARGS__)
#define OF_KIND(...)     MAY_BE_AUTO(dem_kind_said, material., KIND_SAYS, __VA_ARGS__)
#define OF_PAIR(...)     MAY_BE_AUTO(dem_pair_said, material., PAIR_SAYS, __VA_ARGS__)

const rp_param dem_coefficient_schema[] = {DEM_PHYSICS(OF_MATERIAL){0}};
static const rp_param wall_schema[] = {
    {"name", "", RP_TEXT, AT(dem_wall_entry, name), "", "",
     "name for phases and measures; entries with the same name open together"},
    {"sides", "", RP_INT, AT(dem_wall_entry, sides), "64", "[3, 4096]",
     "number of sides of a circle, which is a regular polygon"},
    {"closed", "", RP_BOOL, AT(dem_wall_entry, closed), "true", "",
     "whether a polygon is closed by a side from its last point to its first"},
    {"E", "dyn/cm^2", RP_REAL, AT(dem_wall_entry, E), "auto", "(0, inf) | auto",
     "Young's modulus; auto: that of the grain that touches it"},
    {"nu", "", RP_REAL, AT(dem_wall_entry, nu), "auto", "[0, 0.5] | auto",
     "Poisson's ratio; auto: that of the grain that touches it"},
    DEM_PHYSICS(OF_ENTRY){"open_at_step", "", RP_INT, AT(dem_wall_entry, line.open_at_step), "never",
                          "[0, 2147483647] | never", "step at which the wall opens"},
    {"open_speed", "cm/s", RP_REAL, AT(dem_wall_entry, line.open_speed), "instant", "[0, inf) | instant",
     "speed along the wall at which its lower end then moves (for a level wall, its first end); instant: the "
     "whole wall is removed at that step"},
    {"omega", "rad/s", RP_REAL, AT(dem_wall_entry, line.omega), "0.0", "(-inf, inf)",
     "angular velocity about `pivot`, counter-clockwise"},
    {0}};

static const rp_param kind_schema[] = {
    DEM_PHYSICS(OF_KIND){"density", "g/cm^3", RP_REAL, AT(dem_kind_said, density), "auto", "(0, inf) | auto",
                         "of grains of this kind; auto: the scene's"},
    {"E", "dyn/cm^2", RP_REAL, AT(dem_kind_said, E), "auto", "(0, inf) | auto",
     "Young's modulus; auto: the scene's in `material`"},
    {"nu", "", RP_REAL, AT(dem_kind_said, nu), "auto", "[0, 0.5] | auto",
     "Poisson's ratio; auto: the scene's"},
    {0}};
static const rp_param pair_schema[] = {DEM_PHYSICS(OF_PAIR){0}};

static const rp_param particle_schema[] = {
    {"x", "cm", RP_REAL, AT(dem_grain, x), NULL, "(-inf, inf)", "x of the centre"},
    {"y", "cm", RP_REAL, AT(dem_grain, y), NULL, "(-inf, inf)", "y of the centre"},
    {"r", "cm", RP_REAL, AT(dem_grain, r), NULL, "(0, inf)", "radius"},
    {"m", "g", RP_REAL, AT(dem_grain, m), "auto", "(0, inf) | auto", "mass; auto: from density and shape"},
    {"vx", "cm/s", RP_REAL, AT(dem_grain, vx), "0.0", "(-inf, inf)", "velocity along x"},
    {"vy", "cm/s", RP_REAL, AT(dem_grain, vy), "0.0", "(-inf, inf)", "velocity along y"},
    {"angle", "rad", RP_REAL, AT(dem_grain, angle), "0.0", "(-inf, inf)",
     "rotation angle, counter-clockwise; 0 without rotation"},
    {"omega", "rad/s", RP_REAL, AT(dem_grain, omega), "0.0", "(-inf, inf)",
     "angular velocity, counter-clockwise; 0 without rotation"},
    {"fixed", "", RP_BOOL, AT(dem_grain, fixed), "false", "", "whether the grain never moves"},
    {0}};

/* clang-format off */
#define INTERVAL(table, what) \
    {#table, "steps", RP_INT, AT(dem_intervals, table), "auto", "[0, 2147483647] | auto", \
     "interval between frames of the " what "; 0: none; auto: the last frame, and the ends of phases"},
#define OF_FILL(...) DEM_KEY_ROW(dem_fill, , __VA_ARGS__)
#define RADII_ROWS \
    DEM_RADIUS_PARAMS(OF_FILL) \
    {"radius_law", "", RP_CHOICE, AT(dem_fill, law), "gauss", DEM_WORDS(DEM_RADIUS_LAWS), "distribution of the radii", \
     .manual = DEM_MANUALS(DEM_RADIUS_LAWS)}, \
    {"by", "", RP_CHOICE, AT(dem_fill, by), "number", DEM_WORDS(DEM_SHARES), "what the fractions of the distribution refer to", \
     .manual = DEM_MANUALS(DEM_SHARES)},
/* clang-format on */

static const rp_param output_schema[] = {INTERVAL(states, "states") INTERVAL(energy, "energies")
                                             INTERVAL(contacts, "contacts") INTERVAL(walls, "walls"){0}};

const rp_param dem_radii_schema[] = {RADII_ROWS{0}};
static const rp_param fill_schema[] = {
    {"N", "", RP_INT, AT(dem_fill, N), "auto", "[1, 100000000] | auto",
     "number of grains; auto: as many as fit, for a row or a lattice"},
    {"W", "cm", RP_REAL, AT(dem_fill, W), NULL, "(0, inf)", "width of the region, from x = x0"},
    {"H", "cm", RP_REAL, AT(dem_fill, H), "auto", "(0, inf) | auto",
     "height of the region, from y = y0; auto: none, for a row"},
    {"x0", "cm", RP_REAL, AT(dem_fill, x0), "0.0", "(-inf, inf)", "left end of the region"},
    {"y0", "cm", RP_REAL, AT(dem_fill, y0), "0.0", "(-inf, inf)", "lower end of the region"},
    {"seed", "", RP_INT, AT(dem_fill, seed), "1993", "[0, 2147483647]",
     "seed of the random streams; a `seed` at the top of the file replaces it, also for grains that phases "
     "insert"},
    {"run", "", RP_INT, AT(dem_fill, run), "0", "[0, 2147483647]",
     "number of the streams within the seed; a `run` at the top of the file replaces it"},
    RADII_ROWS{"pattern", "", RP_CHOICE, AT(dem_fill, pattern), "random", DEM_WORDS(DEM_PATTERNS),
               "arrangement of the grains", .manual = DEM_MANUALS(DEM_PATTERNS)},
    {"density", "g/cm^3", RP_REAL, AT(dem_fill, density), "auto", "(0, inf) | auto",
     "density of these grains; auto: that of the scene"},
    {"fixed", "", RP_BOOL, AT(dem_fill, fixed), "false", "", "whether these grains never move"},
    {"kind", "", RP_TEXT, AT(dem_fill, kind), "", "",
     "name of their kind, for measures and for the coefficients of `kinds`"},
    {"spacing", "cm", RP_REAL, AT(dem_fill, spacing), "auto", "(0, inf) | auto",
     "distance between centres in a row or lattice; auto: grains touch"},
    {0}};

const char dem_scene_others[] = "let material gravity normal tangential rolling walls kinds pairs particles "
                                "fill ground hard implicit phases "
                                "measure regions rest result seed run output require";

/* corner_lower and corner_upper joined walls before all walls that meet were joined */
const char dem_wall_others[] =
    "point direction extent polygon circle velocity pivot corner_lower corner_upper";

const dem_scene_group dem_scene_schemas[] = {
    {"scene", top_schema, "what all grains share, and the run; gravity = [gx, gy] (cm/s^2)"},
    {"normal", normal_schema,
     "contact force along the line of centres; x is the overlap, v_n the speed of separation"},
    {"tangential", tangential_schema, "contact force perpendicular to the line of centres"},
    {"rolling", rolling_schema,
     "resistance to rolling: a spring and a dashpot of the rolling displacement, under the limit mu F_n (Ai, "
     "Chen, Rotter & Ooi 2011, model C)"},
    {"material", material_schema,
     "elastic spheres by the constants of their material; stands for normal = { law = \"elastic\"; tension = "
     "false; } with k_n = 4/3 E*, tangential = { law = \"mindlin\"; } with k_s = 8 G*, and these "
     "coefficients; walls can have their own E and nu"},
    {"walls", wall_schema,
     "infinite lines, segments, polygons and circles, which may move and open. A line or segment: point = "
     "[x, y]; direction = [nx, ny] (into the grains, any length); for a segment also extent = [s0, s1] (its "
     "ends, measured from the point along the direction turned 90 degrees clockwise). A polygon: polygon = "
     "([x, y], ...) (the inside is on the left when going from each point to the next). A circle: circle = "
     "[x, y, radius]. A motion: velocity = [vx, vy] (cm/s) of pivot = [x, y] (default: the origin; for a "
     "circle its centre). Of coincident segments "
     "only the more deeply overlapped one acts, on a tie, the later"},
    {"ground", ground_schema,
     "static friction of a wall: a force of -mu_static F_n/a times its displacement holds each grain on it "
     "within a well of half-width a (Liffman, Chan & Hughes 1992, eqs (30) and (33))"},
    {"hard", hard_schema,
     "rigid-body impulses: bodies that approach fast collide instantaneously, with restitution and friction "
     "(Liffman, Chan & Hughes 1992, eqs (1) to (22)); slow contacts have the soft forces"},
    {"implicit", implicit_schema, "solver of the integrator implicit"},
    {"output", output_schema,
     "intervals between frames in the tables of `repose run -o`; its --every sets all four"},
    {"particles", particle_schema, "list of grains with their positions; kind = \"NAME\", as of a fill"},
    {"kinds", kind_schema,
     "coefficients of grains by their kind, kinds = { NAME = { ... }; }; also material = { E; nu; "
     "restitution; mu; }, as the scene's"},
    {"pairs", pair_schema,
     "coefficients of contacts of two kinds, or of a kind and a wall, pairs = ( { of = (\"NAME\", \"NAME\"); "
     "... } )"},
    {"fill", fill_schema,
     "grains of random radius, at random positions without overlap, or in rows; a group, or a list ( { ... } "
     ") of groups, each of which is used only if its key if = \"CONDITION\" holds; radii = ( [r, fraction], "
     "... ) for radius_law = \"table\"; polygon = ( [x, y], ... ): the part of the region that holds the "
     "centres"},
    {0}};

rp_status dem_is_wanted(const config_setting_t *group, bool *wanted)
{
    static const rp_param condition[] = {{"if", "", RP_BOOL, 0, NULL, "", "whether the group is there"}, {0}};
    *wanted = true;
    return config_setting_is_group(group) ? rp_config_peek(group, condition, "if", wanted) : RP_OK;
}

rp_status dem_read_group(const config_setting_t *root, int number, void *values, bool *there)
{
    const config_setting_t *group = member(root, dem_scene_schemas[number].name);
    *there = false;
    if (group) RP_TRY(dem_is_wanted(group, there));
    if (!*there) return RP_OK;
    rp_params_defaults(SCHEMA(number), rp_config_units(root), values);
    return rp_config_group(group, SCHEMA(number), values, "if");
}

bool dem_is_name(const char *text)
{
    return strlen(text) < DEM_NAME_BYTES && strspn(text, RP_NAME_LETTERS) == strlen(text) &&
           !isdigit((unsigned char)*text);
}

rp_status dem_read_name(rp_arena *arena, const config_setting_t *setting, const char *key, const char **name)
{
    if (!dem_is_name(*name))
        return rp_config_fail(setting, "%s = \"%s\": up to %d letters, digits and _ expected", key, *name,
                              DEM_NAME_BYTES - 1);
    *name = rp_text(arena, "%s", *name);
    return *name ? RP_OK : RP_NO_MEMORY;
}

rp_status dem_read_points(rp_arena *arena, const config_setting_t *list, size_t least, size_t *n,
                          double **points)
{
    if (!config_setting_is_list(list) || length(list) < least)
        return rp_config_fail(list, "polygon: a list ( [x, y], ... ) of at least %zu points expected", least);
    *n = length(list);
    RP_NEW(arena, *points, 2 * *n);
    for (size_t i = 0; i < *n; i++) RP_TRY(rp_config_pair(element(list, i), *points + 2 * i));
    return RP_OK;
}
