/* Walls: the pair's law with an infinite mass and no radius on the other side (Lee & Herrmann 1993, after
 * eq (2)). The nearest point of the wall acts along the line to the centre, so that the end of a segment
 * is a corner, and the shear spring lives on as a grain rolls over it. */
#include "dem/walls.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dem/observe.h"

static dem_vec turned(const dem_sim *sim, const double x[2])
{
    return sim->walls.turn[0] * (dem_vec){x[0], x[1]} +
           sim->walls.turn[1] * dem_clockwise((dem_vec){x[0], x[1]});
}

rp_status dem_walls_alloc(dem_walls *walls)
{
    walls->capacity = walls->n_slots + 1;
    walls->slot = malloc(walls->capacity * sizeof *walls->slot);
    return walls->slot ? RP_OK : rp_fail(RP_NO_MEMORY, "wall slots: out of memory");
}

rp_status dem_walls_copy(const dem_walls *walls, dem_walls *copy)
{
    *copy = *walls;
    rp_status status = dem_walls_alloc(copy);
    if (!status && walls->n_slots) memcpy(copy->slot, walls->slot, walls->n_slots * sizeof *copy->slot);
    return status;
}

void dem_walls_free(dem_walls *walls)
{
    free(walls->slot);
}

void dem_walls_place(dem_sim *sim)
{
    const dem_definition *def = &sim->def;
    dem_walls *const walls = &sim->walls;
    walls->turn = (dem_vec){1.0, 0.0};
    dem_box_turn(sim, def->box_turn_per_step);
    walls->turn_from_step = def->turn_from_step;
    for (size_t w = 0; w < def->n_walls; w++) {
        const dem_wall *wall = &def->walls[w];
        walls->line[w].point = (dem_vec){wall->point[0], wall->point[1]};
        walls->line[w].direction = (dem_vec){wall->direction[0], wall->direction[1]};
        walls->mu[w] = dem_finite_mu(wall->material.mu);
    }
}

void dem_box_turn(dem_sim *sim, double radians_per_step)
{
    double sine, cosine;
    dem_sine_cosine(radians_per_step, &sine, &cosine);
    sim->def.box_turn_per_step = radians_per_step;
    sim->walls.turn_from_step = sim->step;
    sim->walls.turn_of_step = (dem_vec){cosine, sine};
}

void dem_box_frame(const dem_sim *sim, double *x, double *y)
{
    const dem_vec in_box = dem_to_box(&sim->walls, (dem_vec){*x, *y});
    *x = in_box[0];
    *y = in_box[1];
}

void dem_wall_open(dem_sim *sim, size_t wall, double speed)
{
    sim->def.walls[wall].open_at_step = sim->step + 1;
    sim->def.walls[wall].open_speed = speed;
}

bool dem_wall_rests(const dem_sim *sim, size_t k)
{
    const dem_wall *w = &sim->def.walls[k];
    return isinf(w->extent[0]) && isinf(w->extent[1]) && sim->walls.swing[1] == 0.0 &&
           !(w->open_at_step >= 0 && sim->step >= w->open_at_step);
}

/* The walls' positions follow from the definition's and the angle, so that they keep their shape. */
void dem_walls_turn(dem_sim *sim)
{
    sim->walls.swing = (dem_vec){0.0, 0.0};
    if (sim->def.box_turn_per_step == 0.0 || sim->step < sim->walls.turn_from_step) return;
    const double c = sim->walls.turn_of_step[0], s = sim->walls.turn_of_step[1];
    dem_vec box = {c * sim->walls.turn[0] - s * sim->walls.turn[1],
                   c * sim->walls.turn[1] + s * sim->walls.turn[0]};
    sim->walls.turn = box * (1.0 / sqrt(dem_dot(box, box)));
    sim->walls.angle += sim->def.box_turn_per_step;
    if (sim->step == sim->walls.turn_from_step)
        sim->walls.swept = INFINITY; /* the list has not reckoned with it */
    sim->walls.swept += fabs(sim->def.box_turn_per_step);
    /* of p, where the step has brought it: (1 - cos) p + sin (p turned clockwise) */
    sim->walls.swing = (dem_vec){s * s / (1.0 + c), s} / sim->def.dt;
    for (size_t w = 0; w < sim->def.n_walls; w++) {
        sim->walls.line[w].point = turned(sim, sim->def.walls[w].point);
        sim->walls.line[w].direction = turned(sim, sim->def.walls[w].direction);
    }
}

dem_wall_state dem_wall_now(const dem_sim *sim, size_t wall)
{
    const dem_wall *w = &sim->def.walls[wall];
    const dem_vec point = sim->walls.line[wall].point, direction = sim->walls.line[wall].direction,
                  force = sim->walls.force[wall];
    double lo = w->extent[0];
    const double hi = w->extent[1];
    if (w->open_at_step >= 0 && sim->step >= w->open_at_step)
        lo = isinf(w->open_speed)
                 ? hi
                 : fmin(lo + w->open_speed * sim->def.dt * (double)(sim->step - w->open_at_step), hi);
    return (dem_wall_state){.point = {point[0], point[1]},
                            .direction = {direction[0], direction[1]},
                            .ends = {lo, hi},
                            .force = {force[0], force[1]}};
}

bool dem_wall_touch(const dem_sim *sim, dem_wall_slot *slot, dem_vec *normal, double *overlap,
                    dem_vec *velocity)
{
    const dem_wall *w = &sim->def.walls[slot->wall];
    dem_vec direction = sim->walls.line[slot->wall].direction, tangent = dem_clockwise(direction);
    dem_vec d = sim->grains.motion[slot->grain].x - sim->walls.line[slot->wall].point;
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
        double distance_to_end = sqrt(dem_dot(corner, corner));
        slot->side = distance < 0.0 ? -1.0 : 1.0;
        *overlap = sim->grains.radius[slot->grain] - distance_to_end;
        *normal = corner * (1.0 / distance_to_end);
    } else {
        *overlap = sim->grains.radius[slot->grain] - slot->side * distance;
        *normal = slot->side * direction;
    }
    if (sim->walls.swing[1] != 0.0) {
        dem_vec p =
            sim->grains.motion[slot->grain].x - (sim->grains.radius[slot->grain] - *overlap) * *normal;
        *velocity += dem_box_velocity(&sim->walls, p);
    }
    return true;
}

static void apply_slot(dem_sim *sim, dem_wall_slot *slot, double h)
{
    const size_t i = slot->grain;
    dem_relative r;
    if (!dem_slot_relative(sim, slot, &r)) {
        slot->spring = slot->roll = 0.0;
        slot->well = DEM_WELL_NONE;
        return;
    }
    sim->too_deep |= !(r.overlap <= sim->grains.radius[i]);
    if (sim->grains.excess && dem_has_spring(sim->def.tangential))
        r.spring += dem_dot(sim->grains.excess[i], r.s);
    const dem_contact c = dem_law_forces(sim, &r, h);
    slot->spring = c.shear_spring;
    slot->roll = c.rolling_spring;
    dem_vec f = c.normal_force * r.n + c.shear_force * r.s;
    if (dem_is_ground(sim, slot)) f += dem_ground_hold(sim, slot, c.normal_force, f, r.wall_velocity);
    *dem_force(sim, i) += f;
    sim->walls.force[slot->wall] -= f;
    if (!sim->grains.omega) return;
    sim->grains.force_torque[i].torque += r.arm_a * c.shear_force;
    sim->grains.force_torque[i].torque += c.rolling_torque;
}

void dem_walls_apply(dem_sim *sim, size_t from, size_t to, double h)
{
    dem_wall_slot *const slot = sim->walls.slot;
    for (size_t w = 0; w < sim->def.n_walls; w++) {
        size_t k = from == 0 ? sim->walls.start[w] : sim->walls.next[w], end = sim->walls.start[w + 1];
        if (from == 0) sim->walls.force[w] = (dem_vec){0.0, 0.0};
        if (to < sim->grains.n)
            for (end = k; end < sim->walls.start[w + 1] && slot[end].grain < to;) end++;
        sim->walls.next[w] = end;
        if (k < end && sim->kernels.line && dem_wall_rests(sim, w) && !dem_is_ground(sim, &slot[k]))
            sim->kernels.line(sim, k, end, h);
        else
            for (; k < end; k++) apply_slot(sim, &slot[k], h);
    }
}
