/* Walls: the pair's law with an infinite mass and no radius on the other side (Lee & Herrmann 1993, after
 * eq (2)). The nearest point of the wall pushes along the line to the centre, so that the end of a segment
 * is a corner, and the shear spring lives on as a grain rolls over it. */
#include <math.h>

#include "dem/law_normal.h"
#include "dem/law_shear.h"
#include "dem/sim.h"

bool dem_wall_touch(const dem_sim *sim, dem_wall_slot *slot, dem_vec *normal, double *overlap,
                    dem_vec *velocity)
{
    const dem_wall *w = &sim->def.walls[slot->wall];
    dem_vec direction = {w->direction[0], w->direction[1]}, tangent = dem_clockwise(direction);
    dem_vec d = sim->grain[slot->grain].x - (dem_vec){w->point[0], w->point[1]};
    double distance = dem_dot(d, direction), along = dem_dot(d, tangent);
    double lo = w->extent[0], hi = w->extent[1];
    *velocity = (dem_vec){0.0, 0.0};
    if (w->open_at_step >= 0 && sim->step >= w->open_at_step) {
        if (isinf(w->open_speed)) return false;
        lo += w->open_speed * sim->def.dt * (double)(sim->step - w->open_at_step);
        *velocity = w->open_speed * tangent;
        if (lo >= hi) return false; /* lifted past its upper end */
    }
    if (along < lo || along > hi) {
        dem_vec corner = d - (along < lo ? lo : hi) * tangent;
        double reach = sqrt(dem_dot(corner, corner));
        slot->side = distance < 0.0 ? -1.0 : 1.0;
        *overlap = sim->radius[slot->grain] - reach;
        *normal = corner * (1.0 / reach);
    } else {
        *overlap = sim->radius[slot->grain] - slot->side * distance;
        *normal = slot->side * direction;
    }
    return true;
}

void dem_walls_apply(dem_sim *sim, double h)
{
    for (size_t w = 0; w < sim->def.n_walls; w++) sim->wall_force[w] = (dem_vec){0.0, 0.0};
    for (size_t k = 0; k < sim->n_wall_slots; k++) {
        dem_wall_slot *slot = &sim->wall_slot[k];
        dem_vec n, wall_velocity;
        double overlap;
        if (!dem_wall_touch(sim, slot, &n, &overlap, &wall_velocity) || overlap <= 0.0) {
            slot->spring = slot->roll = 0.0;
            continue;
        }
        const size_t i = slot->grain;
        const dem_material *c = &sim->def.walls[slot->wall].material;
        dem_vec v = sim->grain[i].v - wall_velocity;
        sim->alarm |= !(overlap <= sim->radius[i]);
        double f_n = dem_law_normal(sim->def.normal, sim->def.tension, c->k_n, c->gamma_n, sim->mass[i],
                                    overlap, dem_dot(v, n));
        dem_vec f = f_n * n;
        if (sim->def.tangential == DEM_SPRING) {
            dem_vec s = dem_clockwise(n);
            double v_s = dem_dot(v, s), arm = sim->radius[i] - overlap;
            if (sim->spin) v_s += arm * sim->spin[i].omega;
            double f_s = dem_law_shear(sim->def.slip, sim->def.damping, c->k_s, c->gamma_s,
                                       sim->wall_mu[slot->wall], sim->mass[i], v_s, f_n, h, &slot->spring);
            f += s * f_s;
            if (sim->spin) sim->spin[i].torque += arm * f_s;
            if (sim->rolling)
                sim->spin[i].torque +=
                    sim->radius[i] * dem_law_rolling(c, sim->mass[i], sim->radius[i] * sim->spin[i].omega,
                                                     f_n, h, &slot->roll);
        }
        sim->force[i] += f;
        sim->wall_force[slot->wall] -= f;
    }
}
