/* Where a grain touches a wall. The nearest point of the wall acts along the line to the centre, so that the
 * end of a segment is a corner, and the shear spring lives on as a grain rolls over it. */
#include <math.h>

#include "dem/forces/forces.h"

bool dem_wall_rests(const dem_sim *sim, size_t k)
{
    const dem_wall *w = &sim->walls.wall[k];
    if (sim->walls.line[k].plain) return sim->walls.swing[1] == 0.0;
    return dem_wall_is_line(w) && sim->walls.swing[1] == 0.0 && !sim->walls.line[k].moves &&
           !dem_wall_opens(sim, k);
}

/* Does a segment that is joined at this end (0: lower) have the contact of a grain there instead? The grain
 * is at (along, above) from the end, along the tangent and the direction.
 *
 * Beyond this end, the contact is the neighbour's unless the grain is beyond its end too, at a corner; that
 * belongs to the later of the two. Where the tangent turns towards the grain, it may touch both. At a slight
 * turn both would carry it in turn all its way along, and so the nearer has the contact. */
static bool is_neighbours(const dem_sim *sim, size_t wall, int end, double along, double above)
{
    enum { LOWER, UPPER };
    static const double SLIGHT = 0.05; /* rad; at more, both begin to touch below 0.1 % of overlap */
    const dem_vec half = sim->walls.line[wall].half_corner[end];
    const double c = half[0], s = half[1], turn = sim->walls.wall[wall].corner[end];
    /* along the bisector of the tangents, and along the neighbour's */
    const double middle = c * along + s * above, other = (c * c - s * s) * along + 2.0 * s * c * above;
    if (end == UPPER ? along > 0.0 : along < 0.0) return end == UPPER || other <= 0.0;
    return fabs(turn) < SLIGHT && turn * above > 0.0 && (end == UPPER ? middle > 0.0 : middle <= 0.0);
}

/* Where a wall has ends, or opens. */
static bool touch_segment(const dem_sim *sim, dem_wall_slot *slot, dem_vec d, dem_touch *touch)
{
    const dem_wall *w = &sim->walls.wall[slot->wall];
    const double radius = sim->grains.radius[slot->grain];
    const dem_vec direction = sim->walls.line[slot->wall].direction, tangent = dem_clockwise(direction);
    const double along = dem_dot(d, tangent), distance = dem_dot(d, direction), hi = w->extent[1];
    double lo = w->extent[0];
    if (dem_wall_opens(sim, slot->wall)) {
        if (isinf(w->open_speed)) return false;
        lo += w->open_speed * sim->def.dt * (double)(sim->step - w->open_at_step);
        touch->velocity = w->open_speed * tangent;
        if (lo >= hi) return false; /* lifted past its upper end */
    }
    if (along < lo || along > hi) {
        dem_vec corner = d - (along < lo ? lo : hi) * tangent;
        double distance_to_end = sqrt(dem_dot(corner, corner));
        slot->side = distance < 0.0 ? -1.0 : 1.0;
        touch->overlap = radius - distance_to_end;
        touch->normal = corner * (1.0 / distance_to_end);
    } else {
        touch->overlap = radius - slot->side * distance;
        touch->normal = slot->side * direction;
    }
    return !(w->joined[0] && is_neighbours(sim, slot->wall, 0, along - lo, distance)) &&
           !(w->joined[1] && is_neighbours(sim, slot->wall, 1, along - hi, distance));
}

bool dem_wall_touch(const dem_sim *sim, dem_wall_slot *slot, dem_touch *touch)
{
    const dem_wall_line *line = &sim->walls.line[slot->wall];
    const dem_vec x = sim->grains.motion[slot->grain].x, d = x - line->point;
    const double radius = sim->grains.radius[slot->grain];
    touch->velocity = (dem_vec){0.0, 0.0};
    if (line->plain) {
        touch->overlap = radius - slot->side * dem_dot(d, line->direction);
        touch->normal = slot->side * line->direction;
    } else if (!touch_segment(sim, slot, d, touch)) {
        return false;
    }
    if (line->moves || sim->walls.swing[1] != 0.0)
        touch->velocity +=
            dem_wall_velocity(&sim->walls, slot->wall, x - (radius - touch->overlap) * touch->normal);
    return true;
}
