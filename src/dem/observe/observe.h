/* Energies of single grains and contacts, and the energy ledger of a simulation that has one; ledger.c. */
#ifndef DEM_OBSERVE_H
#define DEM_OBSERVE_H

#include "core/snapshot.h"
#include "dem/state/state.h"

/* Of grain i; of its rotation in a frame that spins itself. */
double dem_kinetic_energy(const dem_sim *sim, size_t i);
double dem_rotational_energy(const dem_sim *sim, size_t i, double frame);

/* The sum of dem_energies. */
double dem_energy_now(const dem_sim *sim);

/* Elastic energies of a contact's springs, all 0 where it does not touch. */
typedef struct {
    double normal, well, shear, rolling;
} dem_elastic;
dem_elastic dem_contact_elastic(const dem_sim *sim, size_t k);

rp_status dem_ledger_alloc(dem_sim *sim);
void dem_ledger_free(dem_sim *sim);

/* Go on with these sums, of a simulation whose energy was `before`; what there is now more, is put in. Grain
 * number k has the id ids[k]. dem_ledger_halt: the same where all stand still, whose forces are recorded. */
rp_status dem_ledger_go_on(dem_sim *sim, const dem_ledger *sum, double before, const uint32_t ids[],
                           bool removes);
void dem_ledger_halt(dem_sim *sim, double before);

/* Its part of a snapshot; a reading makes the ledger. */
void dem_ledger_keep(rp_snapshot *s, dem_sim *sim);

/* Record the contacts' forces after all springs have advanced by h. An integrator with one force throughout a
 * step passes it before the grains move. Then start, or balance the step once all grains have moved. */
rp_status dem_ledger_forces(dem_sim *sim, double h);
rp_status dem_ledger_between(dem_sim *sim, const dem_vec *force);
void dem_ledger_start(dem_sim *sim);
void dem_ledger_step(dem_sim *sim);

/* Events: gravity has changed; a hard collision of two grains, or of a grain (twice) with a wall; a grain is
 * about to be put in. */
void dem_ledger_gravity(dem_sim *sim);
void dem_ledger_collision(dem_sim *sim, const size_t grain[2], const dem_body before[2],
                          const dem_body after[2]);
rp_status dem_ledger_add(dem_sim *sim, const dem_grain *grain);

#endif
