/* Energies of single grains and contacts, as an observer sees them; observe.c. */
#ifndef DEM_ENERGY_H
#define DEM_ENERGY_H

#include "dem/dem.h"

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

#endif
