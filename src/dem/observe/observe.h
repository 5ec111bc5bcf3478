/* Energies of single grains and contacts. */
#ifndef DEM_OBSERVE_H
#define DEM_OBSERVE_H

#include "dem/state/state.h"

/* Of grain i; of its rotation in a frame that spins itself. */
double dem_kinetic_energy(const dem_sim *sim, size_t i);
double dem_rotational_energy(const dem_sim *sim, size_t i, double frame);

/* Elastic energies of a contact's springs, all 0 where it does not touch. */
typedef struct {
    double normal, well, shear, rolling;
} dem_elastic;
dem_elastic dem_contact_elastic(const dem_sim *sim, size_t k);

#endif
