/* Walls: the pair's law with an infinite mass and no radius on the other side (Lee & Herrmann 1993, after
 * eq (2)). The nearest point of the wall pushes along the line to the centre, so that the end of a segment
 * is a corner, and the shear spring lives on as a grain rolls over it. */
#include <math.h>

#include "dem/law.h"
#include "dem/sim.h"

static dem_vec turned(const dem_sim *sim, const double x[2])
{
    return sim->box[0] * (dem_vec){x[0], x[1]} + sim->box[1] * dem_clockwise((dem_vec){x[0], x[1]});
}

/* The walls' places follow from the definition's and the angle, so that they keep their shape. */
void dem_walls_turn(dem_sim *sim)
{
    sim->box_swing = (dem_vec){0.0, 0.0};
    if (sim->def.box_turn_per_step == 0.0 || sim->step < sim->box_from_step) return;
    const double c = sim->box_step[0], s = sim->box_step[1];
    dem_vec box = {c * sim->box[0] - s * sim->box[1], c * sim->box[1] + s * sim->box[0]};
    sim->box = box * (1.0 / sqrt(dem_dot(box, box)));
    sim->box_angle += sim->def.box_turn_per_step;
    if (sim->step == sim->box_from_step) sim->box_swept = INFINITY; /* the list has not reckoned with it */
    sim->box_swept += fabs(sim->def.box_turn_per_step);
    /* of p, where the step has brought it: (1 - cos) p + sin (p turned clockwise) */
    sim->box_swing = (dem_vec){s * s / (1.0 + c), s} / sim->def.dt;
    for (size_t w = 0; w < sim->def.n_walls; w++) {
        sim->wall[w].point = turned(sim, sim->def.walls[w].point);
        sim->wall[w].direction = turned(sim, sim->def.walls[w].direction);
    }
}

bool dem_wall_touch(const dem_sim *sim, dem_wall_slot *slot, dem_vec *normal, double *overlap,
                    dem_vec *velocity)
{
    const dem_wall *w = &sim->def.walls[slot->wall];
    dem_vec direction = sim->wall[slot->wall].direction, tangent = dem_clockwise(direction);
    dem_vec d = sim->grain[slot->grain].x - sim->wall[slot->wall].point;
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
    if (sim->box_swing[1] != 0.0) {
        dem_vec p = sim->grain[slot->grain].x - (sim->radius[slot->grain] - *overlap) * *normal;
        *velocity += dem_box_velocity(sim, p);
    }
    return true;
}

static void apply_slot(dem_sim *sim, dem_wall_slot *slot, double h)
{
    dem_vec n, wall_velocity;
    double overlap;
    if (!dem_wall_touch(sim, slot, &n, &overlap, &wall_velocity) || overlap <= 0.0) {
        slot->spring = slot->roll = 0.0;
        slot->well = DEM_WELL_NONE;
        return;
    }
    const size_t i = slot->grain;
    const dem_material *c = &sim->def.walls[slot->wall].material;
    dem_vec v = sim->grain[i].v - wall_velocity;
    sim->alarm |= !(overlap <= sim->radius[i]);
    double f_n = dem_law_normal(sim->def.normal, sim->def.tension, c->k_n, c->gamma_n, sim->mass[i], overlap,
                                dem_dot(v, n));
    dem_vec f = f_n * n;
    if (dem_has_friction(sim->def.tangential)) {
        dem_vec s = dem_clockwise(n);
        if (sim->gear && dem_has_spring(sim->def.tangential)) slot->spring += dem_dot(sim->gear[i].slide, s);
        double v_s = dem_dot(v, s), arm = sim->radius[i] - overlap;
        if (sim->omega) v_s += arm * sim->omega[i];
        const dem_slider shear = dem_shear_of(&sim->def, c, sim->wall_mu[slot->wall]);
        double f_s = dem_law_tangential(sim->def.tangential, shear, sim->mass[i], v_s, f_n, h, &slot->spring);
        f += s * f_s;
        if (sim->omega) sim->push[i].torque += arm * f_s;
        if (sim->rolling)
            sim->push[i].torque += dem_law_rolling(dem_rolls_of(c), sim->radius[i], sim->mass[i],
                                                   sim->omega[i] + sim->box_swing[1], f_n, h, &slot->roll);
    }
    if (dem_is_ground(sim, slot)) f += dem_ground_hold(sim, slot, f_n, f, wall_velocity);
    *dem_force(sim, i) += f;
    sim->wall_force[slot->wall] -= f;
}

void dem_walls_apply(dem_sim *sim, size_t from, size_t to, double h)
{
    dem_wall_slot *const slot = sim->wall_slot;
    for (size_t w = 0; w < sim->def.n_walls; w++) {
        size_t k = from == 0 ? sim->wall_start[w] : sim->wall_next[w], end = sim->wall_start[w + 1];
        if (from == 0) sim->wall_force[w] = (dem_vec){0.0, 0.0};
        if (to < sim->n)
            for (end = k; end < sim->wall_start[w + 1] && slot[end].grain < to;) end++;
        sim->wall_next[w] = end;
        if (k < end && sim->line && dem_wall_rests(sim, w) && !dem_is_ground(sim, &slot[k]))
            sim->line(sim, k, end, h);
        else
            for (; k < end; k++) apply_slot(sim, &slot[k], h);
    }
}
