/* The energy ledger of a simulation that has one; ledger.c. */
#ifndef DEM_LEDGER_H
#define DEM_LEDGER_H

#include "dem/hard.h"
#include "dem/vec.h"

rp_status dem_ledger_alloc(dem_sim *sim);
rp_status dem_ledger_clone(dem_sim *copy, const dem_sim *sim);
void dem_ledger_free(dem_sim *sim);

/* Note the contacts' forces once they have moved all springs by h; of an integrator whose force is one all
 * through a step, before the grains move, its parts, and their sum on each grain; then, as they are at the
 * start, or settle a step once everything has moved. */
rp_status dem_ledger_forces(dem_sim *sim, double h);
rp_status dem_ledger_between(dem_sim *sim, const dem_vec *force);
void dem_ledger_start(dem_sim *sim);
void dem_ledger_step(dem_sim *sim);

/* Gravity has changed; a hard collision of two grains, or of one with a wall, whose index is then not looked
 * at; a grain is about to be put in. */
void dem_ledger_gravity(dem_sim *sim);
void dem_ledger_collision(dem_sim *sim, const size_t grain[2], const dem_body before[2],
                          const dem_body after[2]);
rp_status dem_ledger_add(dem_sim *sim, const dem_grain *grain);

#endif
