/* Shear force of a contact: Lee & Herrmann 1993, eq (2b), with the magnitudes its "min" needs:
 *
 *   F_s = -gamma_s m_eff v_s - sign(ds) min(k_s |ds|, mu max(F_n, 0))
 *
 * ds is the shear displacement since first touch. As printed it is never shortened ("total"), so a sliding
 * contact is a conservative spring; today's practice shortens it to the Coulomb limit ("truncated").
 * As printed the dashpot stands outside the limit; "inside", spring and dashpot are limited together:
 *
 *   F_s = -sign(T) min(|T|, mu max(F_n, 0)),  T = k_s ds + gamma_s m_eff v_s,
 *
 * and a truncated spring is left what the dashpot does not take of the limit. */
#ifndef DEM_LAW_SHEAR_H
#define DEM_LAW_SHEAR_H

#include <math.h>
#include <stdbool.h>

#include "dem/dem.h"

/* v_s is the relative velocity along s, the normal turned clockwise; `h` the time since the last call;
 * *spring is ds and is brought up to date. An infinite mu is given as a large number. */
static inline double dem_law_shear(int slip, int damping, double k_s, double gamma_s, double mu, double m_eff,
                                   double v_s, double normal_force, double h, double *spring)
{
    const bool inside = damping == DEM_DAMPING_INSIDE;
    double ds = *spring + v_s * h, dashpot = gamma_s * m_eff * v_s;
    double cap = mu * (normal_force > 0.0 ? normal_force : 0.0);
    double pull = inside ? k_s * ds + dashpot : k_s * ds;
    double held = fabs(pull) > cap ? copysign(cap, pull) : pull;
    if (slip == DEM_TRUNCATED && fabs(pull) > cap) ds = (inside ? held - dashpot : held) * (1.0 / k_s);
    *spring = ds;
    return inside ? -held : -dashpot - held;
}

/* Viscous slip capped by friction: Liffman, Chan & Hughes 1992, eqs (27), (29), (32), with the sign of v_s
 * and the magnitude that their minimum needs, and k_slip = gamma_s m_eff. Their "rolling" friction is
 * Coulomb's limit of the slip, mu here: it does not resist rolling. */
static inline double dem_law_slip_roll(double gamma_s, double mu, double m_eff, double v_s,
                                       double normal_force)
{
    double slip = gamma_s * m_eff * v_s, cap = mu * (normal_force > 0.0 ? normal_force : 0.0);
    return fabs(slip) > cap ? -copysign(cap, v_s) : -slip;
}

/* The tangential law of the scene, which is not DEM_NONE. */
static inline double dem_law_tangential(int law, int slip, int damping, const dem_material *c, double mu,
                                        double m_eff, double v_s, double normal_force, double h,
                                        double *spring)
{
    return law == DEM_SPRING
               ? dem_law_shear(slip, damping, c->k_s, c->gamma_s, mu, m_eff, v_s, normal_force, h, spring)
               : dem_law_slip_roll(c->gamma_s, mu, m_eff, v_s, normal_force);
}

/* Rolling resistance as the same spring and slider (Ai, Chen, Rotter & Ooi 2011, model C): force at the
 * distance R_eff = r_i r_j/(r_i + r_j) (a wall: r_i) from both centres, against v_roll = R_eff (omega_i -
 * omega_j), at most mu_roll max(F_n, 0), dashpot included; *xi is the rolling displacement. The torques
 * R_eff times it on i, and its opposite on j, conserve angular momentum. */
static inline double dem_law_rolling(const dem_material *c, double m_eff, double v_roll, double normal_force,
                                     double h, double *xi)
{
    return dem_law_shear(DEM_TRUNCATED, DEM_DAMPING_INSIDE, c->k_roll, c->gamma_roll, c->mu_roll, m_eff,
                         v_roll, normal_force, h, xi);
}

#endif
