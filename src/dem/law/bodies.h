/* Bodies: mass, moment of inertia, and the hard collision of two; of any mass, radius and spin, and of walls.
 *
 * Collisions: Liffman, Chan & Hughes 1992, eqs (1)-(21), instantaneous, with a coefficient of restitution and
 * Coulomb friction. With n from body 1 to body 2 an approaching pair has P_n < 0 by (12), so (7) and (19) as
 * they are printed give friction the wrong sign for one sense of sliding, and let it grow without limit. Here
 * magnitudes are compared: P_t is the impulse that ends slip (16), cut to |P_t| <= mu |P_n|. The second form
 * of (14) takes a plus. */
#ifndef DEM_BODIES_H
#define DEM_BODIES_H

#include <stdbool.h>

#include "core/status.h"
#include "dem/law/choices.h"

RP_C_BEGIN

/* Mass and moment of inertia. */
#define DEM_SHAPES(X)                                                                                        \
    X(DEM_SPHERE, sphere, "mass (4/3) pi rho r^3, moment of inertia (2/5) m r^2")                            \
    X(DEM_DISK, disk, "mass pi rho r^2, rho being a mass per area; moment of inertia (1/2) m r^2")
typedef enum { DEM_SHAPES(DEM_ID) } dem_shape;
double dem_mass(dem_shape shape, double density, double r);
double dem_inertia(dem_shape shape, double m, double r);

/* A body at the moment of contact. A wall, or what is held, has inverse mass and inertia 0. */
typedef struct {
    double v[2], omega; /* of the centre; spin counter-clockwise */
    double arm;         /* from the centre to the contact: the radius */
    double inverse_mass, inverse_inertia;
} dem_body;

/* Impulse on body 1, along n and along t = (-n_y, n_x). */
typedef struct {
    double normal, tangential;
    bool slips; /* the surfaces still slide on one another afterwards */
} dem_impulse;

/* Collide two bodies, one of which can move; n is the unit vector from 1 to 2. False, and nothing is changed,
 * where they do not approach. With arms that add up to the distance of the centres, angular momentum about
 * any point is conserved. The energy lost is
 *
 *   (1 - restitution^2) M_n v_n^2/2 + |P_t v_t| - P_t^2/(2 M_t),
 *
 * 1/M_n = 1/m_1 + 1/m_2, 1/M_t = 1/M_n + arm_1^2/I_1 + arm_2^2/I_2, v the relative velocity of the surfaces
 * before; without slip its second part is M_t v_t^2/2. 0 <= restitution <= 1, mu >= 0. */
bool dem_impact(dem_body *one, dem_body *two, const double n[2], double restitution, double mu,
                dem_impulse *impulse);

RP_C_END

#endif
