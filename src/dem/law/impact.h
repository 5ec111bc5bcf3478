/* A single impact, solved apart from the simulator. */
#ifndef DEM_IMPACT_H
#define DEM_IMPACT_H

#include "dem/law/laws.h"

RP_C_BEGIN

/* Two bodies that meet head-on at the speed v > 0. */
typedef struct {
    dem_normal_law normal;
    bool tension;
    double k_n, gamma_n, m_eff, v;
} dem_head_on;

/* Their impact, from first touch until the overlap is 0 again, by an adaptive Runge-Kutta method, without the
 * simulator. Damping beyond 1e4 of the spring's rate: the limit of no spring, to 1e-6. A pair that never
 * parts has restitution 0 and time INFINITY. Errors: RP_BAD_INPUT, RP_NO_MEMORY. */
typedef struct {
    double restitution, overlap, time;
} dem_collision_result;
rp_status dem_collision(const dem_head_on *bodies, dem_collision_result *result);

/* Largest error of the part of their energy that is left after the impact, by leapfrog steps dt that begin
 * anywhere before touch; the exact impact has this restitution. */
double dem_impact_error(const dem_head_on *bodies, double restitution, double dt);

/* gamma_n with which their impact has this restitution, in (0, 1], whatever gamma_n they have: in closed
 * form, at any speed, where the law has a damping ratio; else from dem_collision, to 1e-12 of it. Errors:
 * RP_BAD_INPUT, RP_NO_MEMORY. */
rp_status dem_damping_of(const dem_head_on *bodies, double restitution, double *gamma_n);

RP_C_END

#endif
