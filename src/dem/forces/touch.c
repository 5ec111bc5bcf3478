/* Where a grain touches a wall. The nearest point of the wall acts along the line to the centre, so that the
 * end of a segment is a corner, and the shear spring lives on as a grain rolls over it.
 *
 * A surface acts the same however it is cut into walls: a contact whose point lies on another wall, which the
 * grain touches more deeply, is not a second one, and what its springs hold goes from wall to wall. */
#include <math.h>

#include "core/elementary.h"
#include "dem/forces/forces.h"

bool dem_wall_rests(const dem_sim *sim, size_t k)
{
    const dem_wall *w = &sim->walls.wall[k];
    if (sim->walls.line[k].plain) return sim->walls.swing[1] == 0.0;
    return dem_wall_is_line(w) && sim->walls.swing[1] == 0.0 && !sim->walls.line[k].moves &&
           !dem_wall_opens(sim, k);
}

bool dem_wall_ends(const dem_sim *sim, size_t wall, double ends[2])
{
    const dem_wall *w = &sim->walls.wall[wall];
    ends[0] = w->extent[0], ends[1] = w->extent[1];
    if (!dem_wall_opens(sim, wall)) return true;
    if (isinf(w->open_speed)) return false;
    ends[0] += w->open_speed * sim->def.dt * (double)(sim->step - w->open_at_step);
    return ends[0] < ends[1]; /* else lifted past its upper end */
}

/* Where a wall has ends, or opens. */
static bool touch_segment(const dem_sim *sim, dem_wall_slot *slot, dem_vec d, dem_touch *touch)
{
    const double radius = sim->grains.radius[slot->grain];
    const dem_vec direction = sim->walls.line[slot->wall].direction, tangent = dem_clockwise(direction);
    const double along = dem_dot(d, tangent), distance = dem_dot(d, direction);
    double ends[2];
    if (!dem_wall_ends(sim, slot->wall, ends)) return false;
    if (dem_wall_opens(sim, slot->wall)) touch->velocity = sim->walls.wall[slot->wall].open_speed * tangent;
    touch->at_end = along < ends[0] || along > ends[1];
    if (touch->at_end) {
        dem_vec corner = d - ends[along > ends[1]] * tangent;
        double distance_to_end = sqrt(dem_dot(corner, corner));
        slot->side = distance < 0.0 ? -1.0 : 1.0;
        touch->overlap = radius - distance_to_end;
        touch->normal = corner * (1.0 / distance_to_end);
    } else {
        touch->overlap = radius - slot->side * distance;
        touch->normal = slot->side * direction;
    }
    return true;
}

bool dem_wall_touch(const dem_sim *sim, dem_wall_slot *slot, dem_touch *touch)
{
    const dem_wall_line *line = &sim->walls.line[slot->wall];
    const dem_vec x = sim->grains.motion[slot->grain].x, d = x - line->point;
    const double radius = sim->grains.radius[slot->grain];
    touch->velocity = (dem_vec){0.0, 0.0};
    touch->at_end = false;
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

/* Of two contacts of a grain, does that with wall `one` come before the other? Whole lines come first, then
 * the deeper contact. Where overlaps agree to 1e-9 of the radius, as at a point that two walls share,
 * round-off is not to decide: a side comes before an end, and of two ends that of the later wall. */
static bool precedes(const dem_sim *sim, size_t one, const dem_touch *a, const dem_wall_slot *slot,
                     const dem_touch *b)
{
    if (dem_wall_is_line(&sim->walls.wall[one])) return true;
    /* an odd unit: round numbers lie inside its intervals */
    const double unit = 1.2345e-9 * sim->grains.radius[slot->grain], x = floor(a->overlap / unit),
                 y = floor(b->overlap / unit);
    if (x != y) return x > y;
    return a->at_end != b->at_end ? b->at_end : one > slot->wall;
}

/* Is the contact at point p with this direction one with the surface of a second wall too? Its point lies on
 * that wall, to a thousandth of the radius, or, beside a segment, its direction agrees with that segment's
 * and with that of its contact: at more than 0.05 rad two sides that meet begin to touch below 0.1 % of
 * overlap. */
static bool is_on(const dem_sim *sim, size_t wall, const dem_touch *at_wall, dem_vec p, dem_vec normal,
                  double radius)
{
    static const double SLIGHT = 0.99875; /* cos(0.05) */
    const dem_vec d = p - sim->walls.line[wall].point, direction = sim->walls.line[wall].direction;
    const double along = dem_dot(d, dem_clockwise(direction)), above = dem_dot(d, direction);
    double ends[2];
    if (!dem_wall_ends(sim, wall, ends)) return false;
    if (rp_hypot(along - fmin(fmax(along, ends[0]), ends[1]), above) <= 1e-3 * radius) return true;
    return !dem_wall_is_line(&sim->walls.wall[wall]) && dem_dot(normal, at_wall->normal) > SLIGHT &&
           fabs(dem_dot(normal, direction)) > SLIGHT;
}

static dem_vec nearest_point(const dem_sim *sim, const dem_wall_slot *slot, const dem_touch *touch)
{
    return sim->grains.motion[slot->grain].x -
           (sim->grains.radius[slot->grain] - touch->overlap) * touch->normal;
}

bool dem_wall_yields(const dem_sim *sim, const dem_wall_slot *slot, const dem_touch *touch)
{
    const dem_vec p = nearest_point(sim, slot, touch);
    for (dem_wall_slot other = *slot; (other = sim->walls.slot[other.next]).wall != slot->wall;) {
        dem_touch at_other;
        if (dem_wall_touch(sim, &other, &at_other) && precedes(sim, other.wall, &at_other, slot, touch) &&
            is_on(sim, other.wall, &at_other, p, touch->normal, sim->grains.radius[slot->grain]))
            return true;
    }
    return false;
}

static bool acts(const dem_sim *sim, dem_wall_slot slot, dem_touch *touch)
{
    return dem_wall_touch(sim, &slot, touch) && touch->overlap > 0.0 && !dem_wall_yields(sim, &slot, touch);
}

void dem_wall_hand_over(dem_sim *sim, dem_wall_slot *first)
{
    dem_wall_slot *slot = first;
    do {
        dem_touch touch, at_other;
        const bool held = slot->spring != 0.0 || slot->roll != 0.0;
        dem_wall_slot *other = slot, now = *slot;
        if (held && !acts(sim, *slot, &touch) && dem_wall_touch(sim, &now, &touch))
            while ((other = &sim->walls.slot[other->next]) != slot)
                if (other->spring == 0.0 && other->roll == 0.0 && acts(sim, *other, &at_other) &&
                    is_on(sim, other->wall, &at_other, nearest_point(sim, slot, &touch), touch.normal,
                          sim->grains.radius[slot->grain])) {
                    other->spring = slot->spring, other->roll = slot->roll;
                    slot->spring = slot->roll = 0.0;
                    break;
                }
        slot = &sim->walls.slot[slot->next];
    } while (slot != first);
}
