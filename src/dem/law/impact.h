/* A single impact, solved apart from the simulator. */
#ifndef DEM_IMPACT_H
#define DEM_IMPACT_H

#include "dem/law/laws.h"

RP_C_BEGIN

/* One head-on impact at speed v > 0, from first touch until the overlap is 0 again, by an adaptive
 * Runge-Kutta method, without the simulator. Damping beyond 1e4 of the spring's rate: the limit of no spring,
 * to 1e-6. A pair that never parts has restitution 0 and time INFINITY. Errors: RP_BAD_INPUT, RP_NO_MEMORY.
 */
typedef struct {
    double restitution, overlap, time;
} dem_collision_result;
rp_status dem_collision(dem_normal_law normal, bool tension, double k_n, double gamma_n, double m_eff,
                        double v, dem_collision_result *result);

/* gamma_n with which an impact at speed v has this restitution, in (0, 1]: in closed form, whatever v, where
 * the law has a damping ratio; else from dem_collision, to 1e-12 of it. Errors: RP_BAD_INPUT, RP_NO_MEMORY.
 */
rp_status dem_damping_of(dem_normal_law normal, bool tension, double k_n, double m_eff, double v,
                         double restitution, double *gamma_n);

RP_C_END

#endif
