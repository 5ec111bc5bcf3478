/* The contact laws: one row each, of which their types, names, descriptors, kernels and tests are made. A new
 * normal law is a row here and its functions in law.inl. */
#ifndef DEM_LAWS_H
#define DEM_LAWS_H

#include <stdbool.h>

#include "core/status.h"
#include "dem/law/choices.h"

RP_C_BEGIN

/* Normal laws: a conservative spring and a dashpot. id; word; manual; the names in law.inl of the spring, of
 * the dashpot, and of how the stiffness depends on the radii; units of k_n and of gamma_n; members of
 * dem_normal_descriptor that not every law has. */
#define DEM_NORMAL_LAWS(X)                                                                                   \
    X(DEM_HERTZ, hertz,                                                                                      \
      "elastic spheres, F_n = k_n x^(3/2) - gamma_n m_eff v_n (Lee & Herrmann 1993, eq (2a)): slow impacts " \
      "lose more than fast ones",                                                                            \
      hertz, constant, of_all, "dyn/cm^1.5", "1/s", .sticking_speed = hertz_sticking_speed,                  \
      .modulus = hertz_modulus, .lammps = "hertz", .lammps_by_radius = true)                                 \
    X(DEM_LINEAR, linear,                                                                                    \
      "F_n = k_n x - gamma_n m_eff v_n (Liffman, Chan & Hughes 1992, eqs (23) and (25)): impacts of all "    \
      "speeds have the same restitution",                                                                    \
      linear, constant, of_all, "dyn/cm", "1/s", .constant_stiffness = true,                                 \
      .damping_ratio = linear_damping_ratio, .lammps = "hooke")                                              \
    X(DEM_TSUJI, tsuji,                                                                                      \
      "elastic spheres, F_n = k_n x^(3/2) - gamma_n sqrt(m_eff k_n) x^(1/4) v_n (Tsuji, Tanaka & Ishida "    \
      "1992): impacts of all speeds have the same restitution",                                              \
      hertz, tsuji, of_all, "dyn/cm^1.5", "1", .damping_ratio = tsuji_damping_ratio,                         \
      .modulus = hertz_modulus)                                                                              \
    X(DEM_ELASTIC, elastic,                                                                                  \
      "tsuji with the stiffness k_n sqrt(R) of each pair's own radii, R = r_i r_j/(r_i + r_j), at a wall R " \
      "= r: k_n = 4/3 E* of `material` (Hertz)",                                                             \
      hertz, tsuji, by_radius, "dyn/cm^2", "1", .damping_ratio = tsuji_damping_ratio, .lammps = "hertz",     \
      .lammps_damping = "tsuji")

/* Tangential laws. id; word; manual; has friction; has a spring; whether its coefficients, and those of
 * rolling, are of the contact's radius, see dem_law_at_overlap; the name of its force in law.inl; members of
 * dem_tangential_descriptor but the name, one at least. */
#define DEM_TANGENTIAL_LAWS(X)                                                                               \
    X(DEM_NONE, none, "no tangential force", false, false, false, no, .lammps = "linear_nohistory",          \
      .in_lammps = "none")                                                                                   \
    X(DEM_SPRING, spring,                                                                                    \
      "a spring k_s with the displacement s since first contact, and a dashpot: F_s = -gamma_s m_eff v_s - " \
      "sign(s) min(k_s |s|, mu max(F_n, 0)) (Lee & Herrmann 1993, eq (2b))",                                 \
      true, true, false, shear, .lammps = "linear_history",                                                  \
      .in_lammps = "spring k_s and dashpot gamma_s m_eff, together limited by mu F_n, the spring truncated") \
    X(DEM_MINDLIN, mindlin,                                                                                  \
      "spring, with the stiffness k_s sqrt(R x) of the contact's radius and the damping rate gamma_s "       \
      "sqrt(stiffness/m_eff); loading preserves the spring force, so that no energy is gained: k_s = "       \
      "8 G* "                                                                                                \
      "of `material` (Mindlin & Deresiewicz 1953; Thornton, Cummins & Cleary 2013)",                         \
      true, true, true, shear, .lammps = "mindlin_rescale/force",                                            \
      .in_lammps = "spring k_s sqrt(R_eff x) and dashpot, together limited by mu F_n; the force is "         \
                   "rescaled on unloading")                                                                  \
    X(DEM_SLIP_ROLL, slip_roll,                                                                              \
      "viscous slip, without a spring: F_s = -sign(v_s) min(gamma_s m_eff |v_s|, mu max(F_n, 0)) (Liffman, " \
      "Chan & Hughes 1992, eqs (27) to (32))",                                                               \
      true, false, false, slip, .lammps = "linear_nohistory",                                                \
      .in_lammps = "viscous slip gamma_s m_eff v_s limited by mu F_n, no spring")

/* What a shear spring remembers while it slides; whether the shear dashpot stands outside the limit mu F_n.
 */
#define DEM_SLIPS(X)                                                                                         \
    X(DEM_TRUNCATED, truncated, "a sliding spring is shortened to the limit mu F_n/k_s")                     \
    X(DEM_TOTAL, total,                                                                                      \
      "the spring is never shortened, as Lee & Herrmann's (2b) is printed: sliding stores energy")
#define DEM_DAMPINGS(X)                                                                                      \
    X(DEM_DAMPING_OUTSIDE, outside,                                                                          \
      "the dashpot adds to the limit mu F_n, as (2b) is printed: a viscous drag slows whatever slides")      \
    X(DEM_DAMPING_INSIDE, inside, "spring and dashpot together obey the limit mu F_n")

/* Models of rolling resistance, named as by Ai, Chen, Rotter & Ooi 2011. id; word, which is the name of its
 * force in law.inl; manual; has a spring; has a dashpot; whether its limit mu F_n is over a speed. */
#define DEM_ROLLINGS(X)                                                                                      \
    X(DEM_ROLL_SPRING, spring,                                                                               \
      "a spring and a dashpot with the rolling displacement, limited to mu F_n: model C", true, true, false) \
    X(DEM_ROLL_CONSTANT, constant,                                                                           \
      "the limit mu F_n against any rolling, however slow, so that resting grains tremble: model A", false,  \
      false, false)                                                                                          \
    X(DEM_ROLL_VISCOUS, viscous,                                                                             \
      "mu F_n v with the rolling speed v, mu in s/cm or s/m; no resistance at rest: model B", false, false,  \
      true)

/* Arm of the rolling resistance between grains; at a wall it is the grain's radius. */
#define DEM_ARMS(X)                                                                                          \
    X(DEM_ARM_REDUCED, reduced, "r_i r_j/(r_i + r_j): half the radius of equal grains")                      \
    X(DEM_ARM_RADIUS, radius, "2 r_i r_j/(r_i + r_j): the radius of equal grains, as at a wall")

typedef enum { DEM_NORMAL_LAWS(DEM_ID) } dem_normal_law;
typedef enum { DEM_TANGENTIAL_LAWS(DEM_ID) } dem_tangential_law;
typedef enum { DEM_ROLLINGS(DEM_ID) } dem_rolling;
typedef enum { DEM_ARMS(DEM_ID) } dem_arm;
typedef enum { DEM_SLIPS(DEM_ID) } dem_slip;
typedef enum { DEM_DAMPINGS(DEM_ID) } dem_damping;
enum { DEM_NORMAL_N = DEM_NORMAL_LAWS(DEM_ONE), DEM_TANGENTIAL_N = DEM_TANGENTIAL_LAWS(DEM_ONE) };
enum { DEM_ROLLING_N = DEM_ROLLINGS(DEM_ONE) };

/* A truth of each row, in a bit of its own: known to the compiler where the law is. */
#define DEM_FIRST_BIT(id, word, manual, first, ...)  | (unsigned)first << id
#define DEM_SECOND_BIT(id, word, manual, first, ...) | (unsigned)DEM_FIRST(__VA_ARGS__, ) << id
#define DEM_THIRD_BIT(id, word, manual, first, ...)  DEM_SECOND_BIT(id, word, manual, __VA_ARGS__)
#define DEM_ROW_IS(name, type, LIST, BIT)                                                                    \
    static inline bool name(type law)                                                                        \
    {                                                                                                        \
        return (0u LIST(BIT)) >> law & 1;                                                                    \
    }
DEM_ROW_IS(dem_has_friction, dem_tangential_law, DEM_TANGENTIAL_LAWS, DEM_FIRST_BIT)
DEM_ROW_IS(dem_has_spring, dem_tangential_law, DEM_TANGENTIAL_LAWS, DEM_SECOND_BIT)
DEM_ROW_IS(dem_is_of_radius, dem_tangential_law, DEM_TANGENTIAL_LAWS, DEM_THIRD_BIT)
DEM_ROW_IS(dem_rolls_by_spring, dem_rolling, DEM_ROLLINGS, DEM_FIRST_BIT)
DEM_ROW_IS(dem_rolls_by_dashpot, dem_rolling, DEM_ROLLINGS, DEM_SECOND_BIT)
DEM_ROW_IS(dem_rolls_by_speed, dem_rolling, DEM_ROLLINGS, DEM_THIRD_BIT)

/* Units of a coefficient, "; hertz: dyn/cm^1.5; linear: dyn/cm". */
#define DEM_LAW_K_N(id, word, manual, spring, dashpot, scale, k_n, ...) "; " #word ": " k_n
#define DEM_LAW_GAMMA_N(id, word, manual, spring, dashpot, scale, k_n, ...)                                  \
    "; " #word ": " DEM_FIRST(__VA_ARGS__, )
#define DEM_K_N_UNITS     "" DEM_NORMAL_LAWS(DEM_LAW_K_N)
#define DEM_GAMMA_N_UNITS "" DEM_NORMAL_LAWS(DEM_LAW_GAMMA_N)

/* A normal law, for all but its force. m_eff is the contact's effective mass, v an approach speed. */
typedef struct {
    const char *name, *k_n_unit, *gamma_n_unit;
    /* k_n of a contact of this effective radius, which the functions below take */
    double (*scale)(double k_n, double r_eff);
    double (*stiffness)(double k_n, double overlap);              /* dF/d(overlap) of the spring */
    double (*potential)(double k_n, double overlap);              /* energy of the spring */
    double (*impact_overlap)(double k_n, double m_eff, double v); /* at which the spring alone stops v */
    double (*rest_overlap)(double k_n, double force);             /* at which it carries the force */
    /* the force as the quotient of potentials between two overlaps above 0, and its derivative by the second
     */
    double (*quotient)(double k_n, double before, double after, double *slope);
    double (*damping_rate)(double k_n, double gamma_n, double m_eff, double overlap); /* 1/time */
    /* times the difference of the overlaps, the change of a function whose derivative is the rate */
    double (*mean_rate)(double k_n, double gamma_n, double m_eff, double before, double after);
    bool constant_stiffness; /* at all overlaps */
    /* NULL for a law that has none: damping over critical damping, where it is the same at all speeds; speed
     * below which two grains whose damping may pull never part; E* of spheres of radius r */
    double (*damping_ratio)(double k_n, double gamma_n, double m_eff);
    double (*sticking_speed)(double k_n, double gamma_n, double m_eff);
    double (*modulus)(double k_n, double r);
    const char *lammps;         /* name in LAMMPS' pair_style granular; NULL: none */
    const char *lammps_damping; /* there; NULL: mass_velocity */
    bool lammps_by_radius;      /* there, the stiffness is k_n sqrt(R_eff) */
} dem_normal_descriptor;
extern const dem_normal_descriptor dem_normal_descriptors[DEM_NORMAL_N];

typedef struct {
    const char *name;
    const char *lammps;    /* as of a normal law */
    const char *in_lammps; /* what it is there, for its inputs */
} dem_tangential_descriptor;
extern const dem_tangential_descriptor dem_tangential_descriptors[DEM_TANGENTIAL_N];

/* The laws of elastic bodies; their k_n, 4/3 E*, and k_s, 8 G*, where bodies of two materials touch: Young's
 * moduli E and Poisson's ratios nu; 1/E* is the sum of (1 - nu^2)/E, 1/G* of 2 (1 + nu) (2 - nu)/E (Johnson
 * 1985). */
enum { DEM_BODIES_NORMAL = DEM_ELASTIC, DEM_BODIES_TANGENTIAL = DEM_MINDLIN };
void dem_elastic_contact(const double E[2], const double nu[2], double *k_n, double *k_s);

/* Restitution of a law with a damping ratio, which may be above 1: of an impact from first touch to where the
 * overlap, or without tension the force, is 0 again. And the ratio of a restitution in (0, 1]; without
 * tension to 1e-15 or so of it. */
double dem_restitution(bool tension, double damping_ratio);
double dem_damping_ratio_of(bool tension, double restitution);

/* ---- A single impact, solved apart from the simulator; impact.c ---- */

/* Two bodies that meet head-on at the speed v > 0. */
typedef struct {
    dem_normal_law normal;
    bool tension;
    double k_n, gamma_n, m_eff, v;
} dem_head_on;

/* Their impact, from first touch until the overlap is 0 again, without the simulator: the same bits on every
 * processor, to 1e-12. A pair that never parts has restitution 0 and time INFINITY. Errors: RP_BAD_INPUT. */
typedef struct {
    double restitution, overlap, time;
} dem_collision_result;
rp_status dem_collision(const dem_head_on *bodies, dem_collision_result *result);

/* Largest error of the part of their energy that is left after the impact, by leapfrog steps dt that begin
 * anywhere before touch; the exact impact has this restitution. */
double dem_impact_error(const dem_head_on *bodies, double restitution, double dt);

/* gamma_n with which their impact has this restitution, in (0, 1], whatever gamma_n they have: in closed
 * form, at any speed, where the law has a damping ratio; else from dem_collision, to 1e-12 of it. Errors:
 * RP_BAD_INPUT, RP_BROKEN. */
rp_status dem_damping_of(const dem_head_on *bodies, double restitution, double *gamma_n);

RP_C_END

#endif
