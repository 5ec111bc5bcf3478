/* Single grains and contacts, as an observer sees them; observe.c. */
#ifndef DEM_ENERGY_H
#define DEM_ENERGY_H

#include "dem/dem.h"
#include "dem/vec.h"

/* Elastic energies of a contact's springs. */
typedef struct {
    double normal, well, shear, rolling;
} dem_elastic;

/* Of grain i; of its rotation in a frame that spins itself. Of pair k, and of wall slot k, all 0 where it
 * does not touch. */
double dem_kinetic_energy(const dem_sim *sim, size_t i);
double dem_rotational_energy(const dem_sim *sim, size_t i, double frame);
dem_elastic dem_pair_elastic(const dem_sim *sim, size_t k);
dem_elastic dem_slot_elastic(const dem_sim *sim, size_t k);

/* A contact of grain a with grain b or a wall, as the laws take it: coefficients; frame, n from b to a;
 * overlap and relative velocities, that of rolling at the arm r_eff; arms of the contact point; springs; of a
 * wall its nearest point, and its velocity there. Without rotation, arms and v_roll are 0. */
typedef struct {
    const dem_material *c;
    double mu, m_eff, overlap, v_n, v_s, v_roll, arm_a, arm_b, r_eff, spring, roll;
    dem_vec n, s, point, wall_velocity;
} dem_relative;

/* Of pair k, whose second grain is grain a with `swap`; of wall slot k, false where it does not touch. */
dem_relative dem_pair_relative(const dem_sim *sim, size_t k, bool swap);
bool dem_slot_relative(const dem_sim *sim, size_t k, dem_relative *r);

#endif
