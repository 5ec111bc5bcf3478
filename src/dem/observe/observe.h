/* Single grains and contacts, as an observer sees them. Contacts are numbered: the pairs of the neighbour
 * list, then the wall slots. */
#ifndef DEM_OBSERVE_H
#define DEM_OBSERVE_H

#include "dem/state/state.h"

/* Of grain i; of its rotation in a frame that spins itself. */
double dem_kinetic_energy(const dem_sim *sim, size_t i);
double dem_rotational_energy(const dem_sim *sim, size_t i, double frame);

/* A contact of grain a with grain b or a wall, as the laws take it: their indices; coefficients; frame, n
 * from b to a; overlap and relative velocities, that of rolling at the arm r_eff; arms of the contact point;
 * springs; centre of b or nearest point of the wall, and the wall's velocity there. Without rotation, arms
 * and v_roll are 0. */
typedef struct {
    size_t a, b;               /* b is DEM_NOBODY at a wall */
    const dem_wall_slot *slot; /* NULL of a pair */
    const dem_material *c;
    double mu, m_eff, overlap, v_n, v_s, v_roll, arm_a, arm_b, r_eff, spring, roll;
    dem_vec n, s, point, wall_velocity;
} dem_relative;

/* Of contact number k, false where it does not touch. The grain of the smaller id is grain a with `by_id`,
 * else the first of the pair. */
bool dem_contact_relative(const dem_sim *sim, size_t k, bool by_id, dem_relative *r);

/* The same of a wall slot, whose side is brought up to date. */
bool dem_slot_relative(const dem_sim *sim, dem_wall_slot *slot, dem_relative *r);

/* Forces by the laws, without a well, after the springs have advanced by h; c.shear_spring and
 * c.rolling_spring are then theirs. The other members are 0. */
dem_contact dem_law_forces(const dem_sim *sim, const dem_relative *r, double h);

/* Elastic energies of a contact's springs, all 0 where it does not touch. */
typedef struct {
    double normal, well, shear, rolling;
} dem_elastic;
dem_elastic dem_contact_elastic(const dem_sim *sim, size_t k);

#endif
