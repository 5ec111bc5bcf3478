/* Forces of single contacts, and of walls. Contacts are numbered: the pairs of the neighbour list, then the
 * wall slots. */
#ifndef DEM_FORCES_H
#define DEM_FORCES_H

#include "dem/state/state.h"

/* ---- Contacts; contact.c ---- */

/* A contact of grain a with grain b or a wall, as the laws take it: their indices; coefficients; frame, n
 * from b to a; overlap and relative velocities, that of rolling at the arm r_eff; arms of the contact point;
 * springs; centre of b or nearest point of the wall, and the wall's velocity there. Without rotation, arms
 * and v_roll are 0. */
typedef struct {
    size_t a, b;               /* b is DEM_NOBODY at a wall */
    const dem_wall_slot *slot; /* NULL of a pair */
    const dem_material *c;
    double m_eff, overlap, v_n, v_s, v_roll, arm_a, arm_b, r_eff, spring, roll;
    dem_vec n, s, point, wall_velocity;
} dem_relative;

/* Of contact number k, false where it does not touch. The grain of the smaller id is grain a with `by_id`,
 * else the first of the pair. */
bool dem_contact_relative(const dem_sim *sim, size_t k, bool by_id, dem_relative *r);

/* The same of a wall slot, whose side is brought up to date. */
bool dem_slot_relative(const dem_sim *sim, dem_wall_slot *slot, dem_relative *r);

/* k_n of a contact, by its radii. */
static inline double dem_k_n_of(const dem_sim *sim, const dem_relative *r)
{
    return dem_normal_descriptors[sim->def.normal].scale(r->c->k_n, r->r_eff);
}

/* Forces by the laws, without a well, after the springs have advanced by h; c.shear_spring and
 * c.rolling_spring are then theirs. The other members are 0. */
dem_contact dem_law_forces(const dem_sim *sim, const dem_relative *r, double h);

/* ---- Walls; touch.c, ground.c, walls.c ---- */

/* Put the walls where the definition has them, which then borrows them from here; move them on for a step if
 * they move now. Errors: RP_NO_MEMORY. */
rp_status dem_walls_place(dem_sim *sim, const dem_definition *def);
void dem_walls_move(dem_sim *sim);

/* Distance of a wall's farther end from its pivot, INFINITY of a line. */
double dem_wall_reach(const dem_wall *wall);

/* Let wall w go on as `next`, whose fastest point goes `way` in a step. */
void dem_wall_go_on(dem_sim *sim, size_t w, const dem_wall *next, double way);

/* After a rebuilding for grains within `far` of the origin: how far walls may move until the next. */
void dem_walls_limit(dem_sim *sim, double far);

/* Is the wall a whole line at rest: nothing of it is open, and it does not move in this step? */
bool dem_wall_rests(const dem_sim *sim, size_t k);

/* The ends of a wall as it is now, along its tangent; false of one that is gone. */
bool dem_wall_ends(const dem_sim *sim, size_t wall, double ends[2]);

/* Geometry of a wall contact at the present step: unit vector from the wall's nearest point to the grain,
 * velocity of the wall there, overlap, and whether that point is an end. Brings slot->side up to date. False
 * where the wall is open. */
typedef struct {
    dem_vec normal, velocity;
    double overlap;
    bool at_end;
} dem_touch;
bool dem_wall_touch(const dem_sim *sim, dem_wall_slot *slot, dem_touch *touch);

/* Does another wall near the grain of the slot, a listed one of a segment, have this contact instead? Then
 * the two are one surface there. */
bool dem_wall_yields(const dem_sim *sim, const dem_wall_slot *slot, const dem_touch *touch);

/* Before the forces of a grain at several segments, whose first slot this is: springs of contacts that have
 * ended go to the contacts that have taken them over. */
void dem_wall_hand_over(dem_sim *sim, dem_wall_slot *first);

/* The ground, see dem_ground; ground.c. Displacement of a grain in its well, and the force along the ground's
 * tangent that this gives. */
bool dem_is_ground(const dem_sim *sim, const dem_wall_slot *slot);
double dem_ground_displacement(const dem_sim *sim, const dem_wall_slot *slot);
double dem_ground_force(const dem_sim *sim, const dem_wall_slot *slot, double normal_force);

/* Set or break the well of a contact under forces of the contact `f` and of the pairs, and give the well's
 * force. */
dem_vec dem_ground_hold(const dem_sim *sim, dem_wall_slot *slot, double normal_force, dem_vec f,
                        dem_vec ground_velocity);

/* Add the forces of the slots k..end of any walls. */
void dem_slots_apply(dem_sim *sim, size_t k, size_t end, double h);

/* Add the forces of the walls on the grains from..to: on all, in turn, from 0 on. */
void dem_walls_apply(dem_sim *sim, size_t from, size_t to, double h);

#endif
