/* Shear force of a contact: Lee & Herrmann 1993, eq (2b), with the magnitudes its "min" needs:
 *
 *   F_s = -gamma_s m_eff v_s - sign(ds) min(k_s |ds|, mu max(F_n, 0))
 *
 * ds is the shear displacement since first touch. As printed it is never shortened ("total"), so a sliding
 * contact is a conservative spring; today's practice shortens it to the Coulomb limit ("truncated"). */
#ifndef DEM_LAW_SHEAR_H
#define DEM_LAW_SHEAR_H

#include <math.h>

#include "dem/dem.h"

/* v_s is the relative velocity along s, the normal turned clockwise; `h` the time since the last call;
 * *spring is ds and is brought up to date. An infinite mu is given as a large number. */
static inline double dem_law_shear(int slip, double k_s, double gamma_s, double mu, double m_eff, double v_s,
                                   double normal_force, double h, double *spring)
{
    double ds = *spring + v_s * h;
    double cap = mu * (normal_force > 0.0 ? normal_force : 0.0);
    double pull = k_s * ds;
    double held = fabs(pull) > cap ? copysign(cap, pull) : pull;
    if (slip == DEM_TRUNCATED && fabs(pull) > cap) ds = held / k_s;
    *spring = ds;
    return -gamma_s * m_eff * v_s - held;
}

#endif
