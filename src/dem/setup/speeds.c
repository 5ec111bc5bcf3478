/* The speeds that a definition's walls have, and its impacts will have. */
#include <math.h>

#include "core/elementary.h"
#include "dem/forces/forces.h"
#include "dem/setup/definition.h"

static dem_vec end_of(const dem_wall *wall, int end)
{
    const dem_vec direction = dem_vec_of(wall->direction);
    return dem_vec_of(wall->point) + wall->extent[end] * dem_clockwise(direction);
}

double dem_wall_speed(const dem_definition *def, const dem_wall *wall)
{
    double reach = dem_wall_reach(wall);
    if (!dem_wall_moves(wall)) return 0.0;
    const bool line = isinf(reach);
    if (line) reach = 0.0;
    for (size_t i = 0; i < def->n_grains && line; i++)
        reach = fmax(reach, rp_hypot(def->grains[i].x - wall->pivot[0], def->grains[i].y - wall->pivot[1]));
    return rp_hypot(wall->velocity[0], wall->velocity[1]) + fabs(wall->omega) * reach;
}

double dem_impact_speed(const dem_definition *def)
{
    double speed = 0.0, low = INFINITY, high = -INFINITY;
    const double *g = def->gravity;
    for (size_t i = 0; i < def->n_grains; i++) {
        const dem_grain *p = &def->grains[i];
        double height = -(g[0] * p->x + g[1] * p->y); /* times g */
        speed = fmax(speed, rp_hypot(p->vx, p->vy));
        low = fmin(low, height);
        high = fmax(high, height);
    }
    for (size_t w = 0; w < def->n_walls; w++) {
        const dem_wall *wall = &dem_walls_of(def)[w];
        const double *n = wall->direction, *q = wall->point;
        speed = fmax(speed, dem_wall_speed(def, wall));
        for (int end = 0; end < 2 && dem_wall_moves(wall); end++) {
            const dem_vec p = end_of(wall, end);
            if (isfinite(p[0] + p[1])) high = fmax(high, -(g[0] * p[0] + g[1] * p[1]));
        }
        /* a wall along gravity has no height of its own */
        if (fabs(n[0] * g[0] + n[1] * g[1]) > 1e-6 * rp_hypot(g[0], g[1]))
            low = fmin(low, -(g[0] * q[0] + g[1] * q[1]));
    }
    return 2.0 * speed + (high > low ? sqrt(2.0 * (high - low)) : 0.0);
}
