/* The physical parameters of grains and contacts: each stands here once, with name, unit, default, range and
 * meaning. Scene files, protocols and commands take their keys from these lists, dem_material its members,
 * walls their keys. A new parameter is a row here and the code that uses it.
 *
 * A row is X(kind, name, key, unit, type, default, range, further, auto, wall, meaning):
 *   kind     MATERIAL: a member of dem_material, and a key of every wall of a scene;
 *            SCENE: a member of dem_definition; GRAIN: of what makes grains
 *   name     of the member, and the key in protocols
 *   key      in its group of a scene file
 *   further  spellings that the range allows too
 *   auto     of a MATERIAL: value of "auto", from the other coefficients `m` of the same contact, and `rate`:
 *            gamma_n is in 1/s; negative for none
 *   wall     of a MATERIAL: "auto" of a wall is this times the grains' coefficient */
#ifndef DEM_PHYSICS_H
#define DEM_PHYSICS_H

#include <stdbool.h>

#include "params/params.h"

/* clang-format off */
/* Top level of a scene file. */
#define DEM_GRAIN_PARAMS(X) \
    X(SCENE, rotation, "rotation", "", RP_BOOL, "false", "", "", 0, 0, "whether grains rotate") \
    X(SCENE, shape, "shape", "", RP_CHOICE, "sphere", "sphere | disk", "", 0, 0, \
      "gives mass (from the density) and moment of inertia") \
    X(GRAIN, density, "density", "g/cm^3", RP_REAL, "1.0", "(0, inf)", "", 0, 0, "of the grains (disk: g/cm^2, without a default in other units)") \
    X(SCENE, integrator, "integrator", "", RP_CHOICE, "verlet", DEM_INTEGRATOR_WORDS, "", 0, 0, \
      DEM_INTEGRATOR_TEXTS) \
    X(SCENE, dt, "dt", "s", RP_REAL, "5e-5", "(0, inf)", "", 0, 0, "time step")

/* Group `normal`. */
#define DEM_NORMAL_PARAMS(X) \
    X(SCENE, normal, "law", "", RP_CHOICE, "hertz", DEM_NORMAL_WORDS, "", 0, 0, "normal force, eq (2a)") \
    X(MATERIAL, k_n, "k_n", "dyn/cm^1.5", RP_REAL, "1e6", "[0, inf)", "", m->k_n, 2.0, \
      "normal stiffness" DEM_K_N_UNITS) \
    X(MATERIAL, restitution, "restitution", "", RP_REAL, "auto", "(0, 1]", " | auto", -1.0, 1.0, \
      "of two mean grains (of one at a wall), gives gamma_n; hertz: at the speed of the start's impact; auto: by gamma_n") \
    X(MATERIAL, gamma_n, "gamma_n", "1/s", RP_REAL, "auto", "[0, inf)", " | auto", m->restitution > 0.0 || !rate ? -1.0 : rp_units_value("1/s", 500.0), 1.0, \
      "normal damping" DEM_GAMMA_N_UNITS "; auto: by restitution, else 500/s") \
    X(SCENE, tension, "tension", "", RP_BOOL, "true", "", "", 0, 0, "whether the damped normal force may pull, as printed")

/* Group `tangential`. */
#define DEM_TANGENTIAL_PARAMS(X) \
    X(SCENE, tangential, "law", "", RP_CHOICE, "none", DEM_TANGENTIAL_WORDS, "", 0, 0, \
      "shear force: eq (2b), or viscous slip of gamma_s under the limit mu F_n") \
    X(MATERIAL, k_s, "k_s", "dyn/cm", RP_REAL, "1e4", "(0, inf)", "", m->k_s, 1.0, "shear stiffness") \
    X(MATERIAL, gamma_s, "gamma_s", "1/s", RP_REAL, "auto", "[0, inf)", " | auto", rate ? m->gamma_n / 100.0 : -1.0, 1.0, \
      "shear damping; auto: gamma_n/100 where that is in 1/s") \
    DEM_MU_PARAM(X) \
    X(SCENE, slip, "slip", "", RP_CHOICE, "truncated", "truncated | total", "", 0, 0, \
      "shear spring of a sliding contact: cut at the Coulomb limit, or as (2b) is printed") \
    X(SCENE, damping, "damping", "", RP_CHOICE, "outside", "outside | inside", "", 0, 0, \
      "whether the limit mu F_n leaves the shear dashpot out, as printed, or holds it with the spring")

/* Group `rolling`. */
#define DEM_ROLLING_PARAMS(X) \
    DEM_MU_ROLL_PARAM(X) \
    X(MATERIAL, k_roll, "k", "dyn/cm", RP_REAL, "auto", "[0, inf)", " | auto", m->k_s, 1.0, "stiffness of rolling; auto: k_s") \
    X(MATERIAL, gamma_roll, "gamma", "1/s", RP_REAL, "auto", "[0, inf)", " | auto", m->gamma_s, 1.0, \
      "damping of rolling; auto: gamma_s")

/* Two that have no unit, which protocols in other units take by themselves. */
#define DEM_MU_PARAM(X) \
    X(MATERIAL, mu, "mu", "", RP_REAL, "0.0", "[0, inf) | infinite", "", m->mu, 1.0, "friction between grains, Coulomb's coefficient")
#define DEM_MU_ROLL_PARAM(X) \
    X(MATERIAL, mu_roll, "mu", "", RP_REAL, "0.0", "[0, inf)", "", m->mu_roll, 1.0, \
      "rolling resistance: limit of its force, at an arm r_i r_j/(r_i + r_j), over the normal force")

/* Radii of grains that are drawn: group `fill`. */
#define DEM_RADIUS_PARAMS(X) \
    X(FILL, radius_mean, "radius_mean", "cm", RP_REAL, "0.1", "(0, inf)", "", 0, 0, "of the Gaussian; d is twice this") \
    X(FILL, radius_width, "radius_width", "cm", RP_REAL, "0.02", "[0, inf)", "", 0, 0, "standard deviation before the cut") \
    X(FILL, radius_min, "radius_min", "cm", RP_REAL, "0.07", "(0, inf)", "", 0, 0, "drawn again below") \
    X(FILL, radius_max, "radius_max", "cm", RP_REAL, "0.13", "(0, inf)", "", 0, 0, "drawn again above")
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

#define DEM_MATERIAL_MEMBER(kind, name, ...) DEM_IF_MATERIAL(kind, double name;)

/* Rows of a schema whose values are in member `at` of a structure T. In a scene file they have their keys,
 * elsewhere their names. */
#define DEM_RANGE_MATERIAL(range, further) range further
#define DEM_RANGE_SCENE(range, further)    range
#define DEM_RANGE_GRAIN(range, further)    range
#define DEM_RANGE_FILL(range, further)     range
#define DEM_KEY_ROW(T, at, kind, name, key, unit, type, fallback, range, further, value, wall, meaning)      \
    {key, unit, type, offsetof(T, at name), fallback, DEM_RANGE_##kind(range, further), meaning},
#define DEM_NAME_ROW(T, at, kind, name, key, unit, type, fallback, range, further, value, wall, meaning)     \
    {#name, unit, type, offsetof(T, at name), fallback, DEM_RANGE_##kind(range, further), meaning, true},

/* Coefficients of one kind of contact, grain-grain or grain-wall. mu may be INFINITY, mu_roll not.
 * Rolling resistance acts through the force of a spring and a dashpot against R_eff (omega_i - omega_j),
 * R_eff = r_i r_j/(r_i + r_j) (at a wall r_i), limited to mu_roll max(F_n, 0), at an arm of R_eff. Damping
 * coefficients are per effective mass. */
typedef struct {
    DEM_CONTACT_PARAMS(DEM_MATERIAL_MEMBER)
} dem_material;

/* The parameters as they are given; -1 stands for "auto". */
#define DEM_MEMBER_RP_REAL                           double
#define DEM_MEMBER_RP_BOOL                           bool
#define DEM_MEMBER_RP_CHOICE                         int
#define DEM_MEMBER(kind, name, key, unit, type, ...) DEM_MEMBER_##type name;
typedef struct {
    DEM_PHYSICS(DEM_MEMBER)
} dem_physics;

#endif
