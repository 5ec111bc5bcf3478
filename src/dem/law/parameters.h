/* The physical parameters of grains and contacts: each stands here once, with name, unit, default, range and
 * meaning. Scene files, protocols and commands take their keys from these lists, dem_material its members,
 * walls their keys. A new parameter is a row here and the code that uses it.
 *
 * A row is X(kind, type, name, KEY, UNIT, DEFAULT, RANGE, ALSO, AUTOMATIC, WALL, MEANING):
 *   kind       MATERIAL: a member of dem_material, and a key of every wall of a scene;
 *              SCENE: a member of dem_definition; GRAIN, FILL: of what makes grains
 *   name       of the member, and the key in protocols
 *   KEY        in its group of a scene file
 *   ALSO       spellings that the range allows too
 *   AUTOMATIC  of a MATERIAL: value of "auto", from the other coefficients `m` of the same contact, and
 *              `rate`: gamma_n is in 1/s; negative for none
 *   WALL       of a MATERIAL: "auto" of a wall is this times the grains' coefficient as given; where that is
 *              "auto" too, AUTOMATIC of the wall's own
 * and of a choice, which is a SCENE, further members of its rp_param. */
#ifndef DEM_PARAMETERS_H
#define DEM_PARAMETERS_H

#include <stdbool.h>

#include "params/params.h"

/* The columns' names, in the order of a row. */
#define DEM_KEY(key)         key
#define DEM_UNIT(unit)       unit
#define DEM_DEFAULT(text)    text
#define DEM_RANGE(range)     range
#define DEM_ALSO(words)      words
#define DEM_AUTOMATIC(value) value
#define DEM_WALL(factor)     factor
#define DEM_MEANING(text)    text
/* All but a key's own columns: of a parameter that no wall has. */
#define DEM_NO_WALL DEM_ALSO(), DEM_AUTOMATIC(0), DEM_WALL(0)
/* A choice of the words of a list, see choices.h. */
#define DEM_CHOICE(X, name, KEY, DEFAULT, LIST, MEANING)                                                     \
    X(SCENE, RP_CHOICE, name, KEY, DEM_UNIT(""), DEFAULT, DEM_RANGE(DEM_WORDS(LIST)), DEM_NO_WALL, MEANING,  \
      .manual = DEM_MANUALS(LIST))

/* clang-format off */
/* Top level of a scene file. */
#define DEM_GRAIN_PARAMS(X) \
    X(SCENE, RP_BOOL, rotation, DEM_KEY("rotation"), DEM_UNIT(""), DEM_DEFAULT("false"), DEM_RANGE(""), DEM_NO_WALL, \
      DEM_MEANING("whether grains rotate")) \
    DEM_CHOICE(X, shape, DEM_KEY("shape"), DEM_DEFAULT("sphere"), DEM_SHAPES, \
      DEM_MEANING("gives mass (from the density) and moment of inertia")) \
    X(GRAIN, RP_REAL, density, DEM_KEY("density"), DEM_UNIT("g/cm^3"), DEM_DEFAULT("1.0"), DEM_RANGE("(0, inf)"), DEM_NO_WALL, \
      DEM_MEANING("of the grains (disk: g/cm^2, without a default in other units)")) \
    DEM_CHOICE(X, integrator, DEM_KEY("integrator"), DEM_DEFAULT("verlet"), DEM_INTEGRATOR_LIST, \
      DEM_MEANING("method of time integration")) \
    X(SCENE, RP_REAL, dt, DEM_KEY("dt"), DEM_UNIT("s"), DEM_DEFAULT("5e-5"), DEM_RANGE("(0, inf)"), DEM_NO_WALL, \
      DEM_MEANING("time step"))

/* Group `normal`. */
#define DEM_NORMAL_PARAMS(X) \
    DEM_CHOICE(X, normal, DEM_KEY("law"), DEM_DEFAULT("hertz"), DEM_NORMAL_LAWS, DEM_MEANING("normal force")) \
    X(MATERIAL, RP_REAL, k_n, DEM_KEY("k_n"), DEM_UNIT("dyn/cm^1.5"), DEM_DEFAULT("1e6"), DEM_RANGE("[0, inf)"), DEM_ALSO(""), \
      DEM_AUTOMATIC(m->k_n), DEM_WALL(2.0), DEM_MEANING("normal stiffness" DEM_K_N_UNITS)) \
    X(MATERIAL, RP_REAL, restitution, DEM_KEY("restitution"), DEM_UNIT(""), DEM_DEFAULT("auto"), DEM_RANGE("(0, 1]"), \
      DEM_ALSO(" | auto"), DEM_AUTOMATIC(-1.0), DEM_WALL(1.0), \
      DEM_MEANING("of two mean grains (of one at a wall), gives gamma_n; hertz: at restitution_speed; auto: by gamma_n")) \
    X(SCENE, RP_REAL, restitution_speed, DEM_KEY("restitution_speed"), DEM_UNIT("cm/s"), DEM_DEFAULT("none"), \
      DEM_RANGE("(0, inf) | none"), DEM_NO_WALL, \
      DEM_MEANING("speed of impact at which the restitution of hertz holds; slower impacts lose more")) \
    X(MATERIAL, RP_REAL, gamma_n, DEM_KEY("gamma_n"), DEM_UNIT("1/s"), DEM_DEFAULT("auto"), DEM_RANGE("[0, inf)"), \
      DEM_ALSO(" | auto"), DEM_AUTOMATIC(m->restitution > 0.0 || !rate ? -1.0 : rp_units_value(def->units, "1/s", 500.0)), DEM_WALL(1.0), \
      DEM_MEANING("normal damping" DEM_GAMMA_N_UNITS "; auto: by restitution, else 500/s")) \
    X(SCENE, RP_BOOL, tension, DEM_KEY("tension"), DEM_UNIT(""), DEM_DEFAULT("true"), DEM_RANGE(""), DEM_NO_WALL, \
      DEM_MEANING("whether the damped normal force may pull, as printed"))

/* Group `tangential`. */
#define DEM_TANGENTIAL_PARAMS(X) \
    DEM_CHOICE(X, tangential, DEM_KEY("law"), DEM_DEFAULT("none"), DEM_TANGENTIAL_LAWS, \
      DEM_MEANING("force along the contact")) \
    X(MATERIAL, RP_REAL, k_s, DEM_KEY("k_s"), DEM_UNIT("dyn/cm"), DEM_DEFAULT("1e4"), DEM_RANGE("(0, inf)"), DEM_ALSO(""), \
      DEM_AUTOMATIC(m->k_s), DEM_WALL(1.0), DEM_MEANING("shear stiffness; mindlin: dyn/cm^2")) \
    X(MATERIAL, RP_REAL, gamma_s, DEM_KEY("gamma_s"), DEM_UNIT("1/s"), DEM_DEFAULT("auto"), DEM_RANGE("[0, inf)"), \
      DEM_ALSO(" | auto"), DEM_AUTOMATIC(dem_is_of_radius(def->tangential) ? (rate ? 0.0 : sqrt(2.0 / 3.0) * m->gamma_n) : rate ? m->gamma_n / 100.0 : -1.0), \
      DEM_WALL(1.0), DEM_MEANING("shear damping; mindlin: over sqrt(stiffness/m_eff); auto: gamma_n/100 where that is in 1/s; mindlin: " \
                                 "sqrt(2/3) gamma_n, the same part of critical, or 0 beside a gamma_n in 1/s")) \
    DEM_MU_PARAM(X, "0.0") \
    DEM_CHOICE(X, slip, DEM_KEY("slip"), DEM_DEFAULT("truncated"), DEM_SLIPS, \
      DEM_MEANING("shear spring of a sliding contact: cut at the Coulomb limit, or as (2b) is printed")) \
    DEM_CHOICE(X, damping, DEM_KEY("damping"), DEM_DEFAULT("inside"), DEM_DAMPINGS, \
      DEM_MEANING("whether the limit mu F_n holds the shear dashpot with the spring, or leaves it out, as printed"))

/* Group `rolling`. */
#define DEM_ROLLING_PARAMS(X) \
    DEM_MU_ROLL_PARAM(X, "0.0") \
    DEM_CHOICE(X, rolling, DEM_KEY("model"), DEM_DEFAULT("spring"), DEM_ROLLINGS, DEM_MEANING("resistance to rolling")) \
    DEM_CHOICE(X, rolling_arm, DEM_KEY("arm"), DEM_DEFAULT("reduced"), DEM_ARMS, \
      DEM_MEANING("arm of rolling resistance between grains")) \
    X(MATERIAL, RP_REAL, k_roll, DEM_KEY("k"), DEM_UNIT("dyn/cm"), DEM_DEFAULT("auto"), DEM_RANGE("[0, inf)"), \
      DEM_ALSO(" | auto"), DEM_AUTOMATIC(m->k_s), DEM_WALL(1.0), DEM_MEANING("stiffness of rolling; auto: k_s")) \
    X(MATERIAL, RP_REAL, gamma_roll, DEM_KEY("gamma"), DEM_UNIT("1/s"), DEM_DEFAULT("auto"), DEM_RANGE("[0, inf)"), \
      DEM_ALSO(" | auto"), DEM_AUTOMATIC(m->gamma_s), DEM_WALL(1.0), DEM_MEANING("damping of rolling; auto: gamma_s"))

/* Two that have no unit, which protocols in other units take by themselves, with defaults of their own. */
#define DEM_MU_PARAM(X, default_mu) \
    X(MATERIAL, RP_REAL, mu, DEM_KEY("mu"), DEM_UNIT(""), DEM_DEFAULT(default_mu), DEM_RANGE("[0, inf) | infinite"), DEM_ALSO(""), \
      DEM_AUTOMATIC(m->mu), DEM_WALL(1.0), DEM_MEANING("friction between grains, Coulomb's coefficient"))
#define DEM_MU_ROLL_PARAM(X, default_mu) \
    X(MATERIAL, RP_REAL, mu_roll, DEM_KEY("mu"), DEM_UNIT(""), DEM_DEFAULT(default_mu), DEM_RANGE("[0, inf) | infinite"), DEM_ALSO(""), \
      DEM_AUTOMATIC(m->mu_roll), DEM_WALL(1.0), \
      DEM_MEANING("rolling resistance: limit of its force over the normal force"))

/* Radii of grains that are drawn: group `fill`. */
#define DEM_RADIUS_PARAMS(X) \
    X(FILL, RP_REAL, radius_mean, DEM_KEY("radius_mean"), DEM_UNIT("cm"), DEM_DEFAULT("0.1"), DEM_RANGE("(0, inf)"), DEM_NO_WALL, \
      DEM_MEANING("of the Gaussian; d is twice this")) \
    X(FILL, RP_REAL, radius_width, DEM_KEY("radius_width"), DEM_UNIT("cm"), DEM_DEFAULT("0.02"), DEM_RANGE("[0, inf)"), DEM_NO_WALL, \
      DEM_MEANING("standard deviation before the cut")) \
    X(FILL, RP_REAL, radius_min, DEM_KEY("radius_min"), DEM_UNIT("cm"), DEM_DEFAULT("0.07"), DEM_RANGE("(0, inf)"), DEM_NO_WALL, \
      DEM_MEANING("drawn again below")) \
    X(FILL, RP_REAL, radius_max, DEM_KEY("radius_max"), DEM_UNIT("cm"), DEM_DEFAULT("0.13"), DEM_RANGE("(0, inf)"), DEM_NO_WALL, \
      DEM_MEANING("drawn again above"))
/* clang-format on */

#define DEM_CONTACT_PARAMS(X) DEM_NORMAL_PARAMS(X) DEM_TANGENTIAL_PARAMS(X) DEM_ROLLING_PARAMS(X)
#define DEM_PHYSICS(X)        DEM_CONTACT_PARAMS(X) DEM_GRAIN_PARAMS(X)

/* What follows `kind` where a row is of this kind, else nothing. */
#define DEM_IF_MATERIAL(kind, ...)    DEM_IF_MATERIAL_##kind(__VA_ARGS__)
#define DEM_IF_MATERIAL_MATERIAL(...) __VA_ARGS__
#define DEM_IF_MATERIAL_SCENE(...)
#define DEM_IF_MATERIAL_GRAIN(...)
#define DEM_IF_SCENE(kind, ...) DEM_IF_SCENE_##kind(__VA_ARGS__)
#define DEM_IF_SCENE_SCENE(...) __VA_ARGS__
#define DEM_IF_SCENE_MATERIAL(...)
#define DEM_IF_SCENE_GRAIN(...)

/* Stiffnesses are the coefficients k_..., which bodies in contact have in series. */
static inline bool dem_is_stiffness(const char *name)
{
    return name[0] == 'k' && name[1] == '_';
}

#define DEM_MATERIAL_MEMBER(kind, type, name, ...) DEM_IF_MATERIAL(kind, double name;)

/* Rows of a schema whose values are in member `at` of a structure T. In a scene file they have their keys,
 * elsewhere their names. */
#define DEM_KEY_ROW(...) DEM_KEY_ROW_OF(__VA_ARGS__)
#define DEM_KEY_ROW_OF(T, at, kind, type, name, key, unit, fallback, range, also, automatic, wall, ...)      \
    {key, unit, type, offsetof(T, at name), fallback, range also, __VA_ARGS__},
#define DEM_NAME_ROW(...) DEM_NAME_ROW_OF(__VA_ARGS__)
#define DEM_NAME_ROW_OF(T, at, kind, type, name, key, unit, fallback, range, also, automatic, wall, ...)     \
    {#name, unit, type, offsetof(T, at name), fallback, range also, __VA_ARGS__, .inherited = true},

/* Coefficients of one kind of contact, grain-grain or grain-wall. mu and mu_roll may be INFINITY.
 * Rolling resistance acts through the force of a spring and a dashpot against R_eff (omega_i - omega_j),
 * R_eff = r_i r_j/(r_i + r_j) (at a wall r_i), limited to mu_roll max(F_n, 0), at the arm of rolling_arm.
 * Damping coefficients are per effective mass. */
typedef struct {
    DEM_CONTACT_PARAMS(DEM_MATERIAL_MEMBER)
} dem_material;

/* The parameters as they are given; -1 stands for "auto". */
#define DEM_MEMBER_RP_REAL                double
#define DEM_MEMBER_RP_BOOL                bool
#define DEM_MEMBER_RP_CHOICE              int
#define DEM_MEMBER(kind, type, name, ...) DEM_MEMBER_##type name;
typedef struct {
    DEM_PHYSICS(DEM_MEMBER)
} dem_physics;

#endif
