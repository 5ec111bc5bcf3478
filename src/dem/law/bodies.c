/* Mass, moment of inertia and hard collisions of bodies. */
#include "dem/law/bodies.h"

#include <math.h>

double dem_mass(dem_shape shape, double density, double r)
{
    switch (shape) {
    case DEM_SPHERE: return density * M_PI * r * r * (4.0 / 3.0 * r);
    case DEM_DISK: return density * M_PI * r * r;
    }
    __builtin_unreachable();
}

double dem_inertia(dem_shape shape, double m, double r)
{
    switch (shape) {
    case DEM_SPHERE: return 0.4 * m * r * r;
    case DEM_DISK: return 0.5 * m * r * r;
    }
    __builtin_unreachable();
}

/* (6), (13), (14): the impulse (p_x, p_y); its tangential part turns both bodies alike. */
static void apply_impulse(dem_body *body, double p_x, double p_y, double p_t)
{
    body->v[0] += body->inverse_mass * p_x;
    body->v[1] += body->inverse_mass * p_y;
    body->omega += body->inverse_inertia * body->arm * p_t;
}

bool dem_impact(dem_body *one, dem_body *two, const double n[2], double restitution, double mu,
                dem_impulse *impulse)
{
    const double vx = one->v[0] - two->v[0], vy = one->v[1] - two->v[1];
    const double v_n = vx * n[0] + vy * n[1];
    if (!(v_n > 0.0)) return false;
    /* (9) with (17), (18) */
    const double v_t = vy * n[0] - vx * n[1] + one->arm * one->omega + two->arm * two->omega;
    const double inverse_n = one->inverse_mass + two->inverse_mass;
    const double inverse_t =
        inverse_n + one->arm * one->arm * one->inverse_inertia + two->arm * two->arm * two->inverse_inertia;
    const double p_n = -(1.0 + restitution) * v_n / inverse_n; /* (12) */
    const double no_slip = -v_t / inverse_t, most = -mu * p_n; /* (16); (7) as a magnitude */
    impulse->slips = fabs(no_slip) > most;                     /* (19) */
    const double p_t = impulse->slips ? copysign(most, no_slip) : no_slip;
    impulse->normal = p_n;
    impulse->tangential = p_t;
    const double p_x = p_n * n[0] - p_t * n[1], p_y = p_n * n[1] + p_t * n[0]; /* (20), (21) */
    apply_impulse(one, p_x, p_y, p_t);
    apply_impulse(two, -p_x, -p_y, p_t);
    return true;
}
