/* The equation of motion of one grain. */
#ifndef DEM_MOTION_H
#define DEM_MOTION_H

#include "dem/law/law.h"
#include "dem/state/state.h"

typedef dem_vec plane;

static inline plane plane_of(dem_vec a)
{
    return a;
}

#include "dem/state/motion.inl"

/* Acceleration of grain i under the force on it now and at the velocity that it has now. */
static inline dem_vec dem_acceleration_of(const dem_sim *sim, size_t i)
{
    const dem_equation e = dem_equation_of(sim);
    return dem_acceleration(&e, *dem_force(sim, i), sim->grains.inverse_mass[i], sim->grains.motion[i].v);
}

/* Change of the spin of grain i in time t under the torque on it now. */
static inline double dem_spin_gain_of(const dem_sim *sim, size_t i, double t)
{
    return dem_spin_gain(t, sim->grains.inverse_inertia[i], sim->grains.force_torque[i].torque);
}

#endif
