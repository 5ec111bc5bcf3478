/* Normal force of a contact: Lee & Herrmann 1993, eq (2a). Pure functions of a few numbers. */
#ifndef DEM_LAW_NORMAL_H
#define DEM_LAW_NORMAL_H

#include <math.h>
#include <stdbool.h>

#include "dem/dem.h"

/* Elastic part for overlap > 0: k_n overlap^(3/2), or k_n overlap for the linear law. */
static inline double dem_law_elastic(int law, double k_n, double overlap)
{
    return law == DEM_HERTZ ? k_n * overlap * sqrt(overlap) : k_n * overlap;
}

/* (2a): v_n is the normal relative velocity, positive when the grains part. Where they part fast the damping
 * outweighs the spring and the force pulls; `tension` false cuts it at 0. */
static inline double dem_law_normal(int law, bool tension, double k_n, double gamma_n, double m_eff,
                                    double overlap, double v_n)
{
    double f = dem_law_elastic(law, k_n, overlap) - gamma_n * m_eff * v_n;
    return tension || f > 0.0 ? f : 0.0;
}

#endif
