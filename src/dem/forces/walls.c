/* Walls: their motion, and their forces by the pair's law with an infinite mass and no radius on the other
 * side (Lee & Herrmann 1993, after eq (2)). */
#include <math.h>
#include <string.h>

#include "core/elementary.h"
#include "dem/forces/forces.h"

static dem_vec turned(const dem_sim *sim, const double x[2])
{
    return sim->walls.turn[0] * dem_vec_of(x) + sim->walls.turn[1] * dem_clockwise(dem_vec_of(x));
}

double dem_wall_reach(const dem_wall *wall)
{
    double reach = 0.0;
    for (int end = 0; end < 2; end++)
        reach =
            fmax(reach, rp_hypot(wall->point[0] + wall->extent[end] * wall->direction[1] - wall->pivot[0],
                                 wall->point[1] - wall->extent[end] * wall->direction[0] - wall->pivot[1]));
    return isnan(reach) ? INFINITY : reach;
}

/* Put a wall that moves by itself where it is at this step. */
static void carry(dem_wall_line *line, const dem_wall *wall, double t)
{
    const dem_vec pivot = dem_vec_of(wall->pivot), arm = dem_vec_of(wall->point) - pivot,
                  direction = dem_vec_of(wall->direction);
    line->pivot = pivot + t * line->drift;
    line->point = line->pivot + line->turn[0] * arm + line->turn[1] * dem_clockwise(arm);
    line->direction = line->turn[0] * direction + line->turn[1] * dem_clockwise(direction);
}

/* (cosine, sine) of an angle and of a second one that follows; normalised. */
static dem_vec turned_on(dem_vec turn, dem_vec by)
{
    const dem_vec sum = {by[0] * turn[0] - by[1] * turn[1], by[0] * turn[1] + by[1] * turn[0]};
    return sum * (1.0 / sqrt(dem_dot(sum, sum)));
}

/* Displacement of p, where a step that turns by (cosine, sine) has brought it: (1 - cos) p + sin (p turned
 * clockwise), over dt. */
static dem_vec swing_of(dem_vec turn, double dt)
{
    return (dem_vec){turn[1] * turn[1] / (1.0 + turn[0]), turn[1]} / dt;
}

/* A wall begins the motion of its definition, from where that has it. */
static void set_off(dem_wall_line *line, const dem_wall *wall, double dt)
{
    double sine, cosine;
    dem_sine_cosine(-wall->omega * dt, &sine, &cosine);
    line->drift = dem_vec_of(wall->velocity);
    line->turn = (dem_vec){1.0, 0.0};
    line->turn_of_step = (dem_vec){cosine, sine};
    line->swing = swing_of(line->turn_of_step, dt);
    line->reach = dem_wall_reach(wall);
    carry(line, wall, 0.0);
}

rp_status dem_walls_place(dem_sim *sim, const dem_definition *def)
{
    dem_walls *const walls = &sim->walls;
    RP_TRY(dem_walls_alloc(walls, def->n_walls));
    memcpy(walls->wall, dem_walls_of(def), def->n_walls * sizeof *walls->wall);
    sim->def.wall_list = walls->wall;
    walls->turn = (dem_vec){1.0, 0.0};
    RP_TRY(dem_box_turn(sim, def->box_turn_per_step));
    walls->turn_from_step = def->turn_from_step;
    for (size_t w = 0; w < def->n_walls; w++) {
        dem_wall *wall = &walls->wall[w];
        dem_wall_line *line = &walls->line[w];
        dem_finite_limits(&wall->material);
        *line = (dem_wall_line){.point = dem_vec_of(wall->point),
                                .direction = dem_vec_of(wall->direction),
                                .moves = dem_wall_moves(wall),
                                .plain = dem_wall_is_line(wall) && wall->open_at_step < 0 &&
                                         !dem_wall_moves(wall)};
        if (line->moves) set_off(line, wall, def->dt), walls->n_moving++;
    }
    return RP_OK;
}

void dem_wall_go_on(dem_sim *sim, size_t w, const dem_wall *next, double way)
{
    dem_walls *const walls = &sim->walls;
    dem_wall *wall = &walls->wall[w];
    dem_wall_line *line = &walls->line[w];
    const bool reckoned = line->moves && way <= walls->stride && isfinite(line->reach);
    line->angle += wall->omega * sim->def.dt * (double)(sim->step - line->since);
    line->since = sim->step;
    *wall = *next;
    line->moves =
        dem_wall_moves(wall) || reckoned; /* one that stands for a moment stays in the list as it is */
    line->plain = dem_wall_is_line(wall) && wall->open_at_step < 0 && !line->moves;
    line->drift = line->pivot = line->swing = (dem_vec){0.0, 0.0};
    if (line->moves) set_off(line, wall, sim->def.dt);
    walls->n_moving = 0;
    for (size_t k = 0; k < sim->def.n_walls; k++) walls->n_moving += walls->line[k].moves;
    if (reckoned) return;
    walls->swept = INFINITY; /* the list has not reckoned with it, and will with more */
    walls->least_stride = fmax(walls->least_stride, 1.5 * way);
}

rp_status dem_box_turn(dem_sim *sim, double radians_per_step)
{
    double sine, cosine, far = 0.0;
    RP_TRY(rp_check_range("turn of the box", radians_per_step, -1.0, 1.0, "[-1, 1]"));
    for (size_t i = 0; i < sim->grains.n; i++)
        far = fmax(far, sqrt(dem_dot(sim->grains.motion[i].x, sim->grains.motion[i].x)));
    if (fabs(radians_per_step) * far > sim->r_min)
        return rp_fail(
            RP_BAD_INPUT,
            "box_turn_deg_per_step = %g: moves a wall at the farthest grain by %g in one step, the "
            "smallest radius is %g",
            radians_per_step * (180.0 / M_PI), fabs(radians_per_step) * far, sim->r_min);
    dem_sine_cosine(radians_per_step, &sine, &cosine);
    for (size_t w = 0; w < sim->def.n_walls && radians_per_step != 0.0; w++)
        if (dem_wall_moves(&sim->walls.wall[w]))
            return rp_fail(RP_BAD_INPUT, "wall %zu moves: the box can't turn", w + 1);
    sim->def.box_turn_per_step = radians_per_step;
    sim->walls.turn_from_step = sim->step;
    sim->walls.turn_of_step = (dem_vec){cosine, sine};
    return RP_OK;
}

void dem_box_frame(const dem_sim *sim, double *x, double *y)
{
    const dem_vec in_box = dem_to_box(&sim->walls, (dem_vec){*x, *y});
    *x = in_box[0];
    *y = in_box[1];
}

/* Of walls that move by themselves. */
static void move_on(dem_sim *sim)
{
    for (size_t w = 0; w < sim->def.n_walls; w++) {
        dem_wall_line *line = &sim->walls.line[w];
        if (!line->moves) continue;
        const double t = (double)(sim->step - line->since + 1) * sim->def.dt;
        line->turn = turned_on(line->turn, line->turn_of_step);
        carry(line, &sim->walls.wall[w], t);
    }
    sim->walls.swept += sim->walls.stride;
}

void dem_walls_limit(dem_sim *sim, double far)
{
    dem_walls *const walls = &sim->walls;
    const double half = 0.5 * sim->list.skin;
    walls->swept = 0.0;
    /* A turning wall may approach the farthest grain by half the skin, beside the grain's own margin. (A
     * grain that moves along the wall to where it turns faster moves less towards it.) */
    walls->sweep_limit = half / (far + sim->list.skin);
    if (walls->n_moving == 0) return;
    walls->stride = walls->least_stride;
    for (size_t w = 0; w < sim->def.n_walls; w++) {
        const dem_wall_line *l = &walls->line[w];
        if (!l->moves) continue;
        const double reach =
            isinf(l->reach) ? far + sqrt(dem_dot(l->pivot, l->pivot)) + sim->list.skin : l->reach;
        walls->stride = fmax(walls->stride, sim->def.dt * (sqrt(dem_dot(l->drift, l->drift)) +
                                                           fabs(walls->wall[w].omega) * reach));
    }
    /* hard collisions look a step ahead */
    walls->margin = half + walls->stride;
    walls->sweep_limit = half;
}

/* The walls' positions follow from the definition's and the angle, so that they keep their shape. */
void dem_walls_move(dem_sim *sim)
{
    sim->walls.swing = (dem_vec){0.0, 0.0};
    if (sim->walls.n_moving > 0) move_on(sim);
    if (sim->def.box_turn_per_step == 0.0 || sim->step < sim->walls.turn_from_step) return;
    sim->walls.turn = turned_on(sim->walls.turn, sim->walls.turn_of_step);
    sim->walls.angle += sim->def.box_turn_per_step;
    if (sim->step == sim->walls.turn_from_step)
        sim->walls.swept = INFINITY; /* the list has not reckoned with it */
    sim->walls.swept += fabs(sim->def.box_turn_per_step);
    sim->walls.swing = swing_of(sim->walls.turn_of_step, sim->def.dt);
    for (size_t w = 0; w < sim->def.n_walls; w++) {
        sim->walls.line[w].point = turned(sim, sim->walls.wall[w].point);
        sim->walls.line[w].direction = turned(sim, sim->walls.wall[w].direction);
    }
}

size_t dem_wall_count(const dem_sim *sim)
{
    return sim->def.n_walls;
}

dem_wall_state dem_wall_now(const dem_sim *sim, size_t wall)
{
    if (wall >= sim->def.n_walls) return (dem_wall_state){0};
    const dem_wall *w = &sim->walls.wall[wall];
    const dem_wall_line *line = &sim->walls.line[wall];
    const dem_vec point = line->point, direction = line->direction, force = sim->walls.force[wall],
                  pivot = line->moves ? line->pivot : turned(sim, w->pivot);
    double ends[2];
    if (!dem_wall_ends(sim, wall, ends)) ends[0] = ends[1];
    return (dem_wall_state){.point = {point[0], point[1]},
                            .direction = {direction[0], direction[1]},
                            .ends = {ends[0], ends[1]},
                            .force = {force[0], force[1]},
                            .pivot = {pivot[0], pivot[1]},
                            .velocity = {w->velocity[0], w->velocity[1]},
                            .angle = line->angle + w->omega * sim->def.dt * (double)(sim->step - line->since),
                            .mu = w->material.mu < 1e300 ? w->material.mu : INFINITY,
                            .open = dem_wall_opens(sim, wall)};
}

static void apply_slot(dem_sim *sim, dem_wall_slot *slot, double h)
{
    const size_t i = slot->grain;
    dem_relative r;
    if (slot->leads) dem_wall_hand_over(sim, slot);
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

void dem_slots_apply(dem_sim *sim, size_t k, size_t end, double h)
{
    for (; k < end; k++) apply_slot(sim, &sim->walls.slot[k], h);
}

void dem_walls_apply(dem_sim *sim, size_t from, size_t to, double h)
{
    dem_wall_slot *const slot = sim->walls.slot;
    const size_t *const start = sim->walls.start;
    for (size_t w = 0; w < sim->def.n_walls; w++) {
        size_t k = from == 0 ? start[w] : sim->walls.next[w], end = start[w + 1];
        if (from == 0) sim->walls.force[w] = (dem_vec){0.0, 0.0};
        if (to < sim->grains.n)
            for (end = k; end < start[w + 1] && slot[end].grain < to;) end++;
        sim->walls.next[w] = end;
        if (k == end) continue;
        const bool is_line = dem_wall_rests(sim, w) && !dem_is_ground(sim, &slot[k]);
        (is_line ? sim->loops.line : dem_slots_apply)(sim, k, end, h);
    }
}
