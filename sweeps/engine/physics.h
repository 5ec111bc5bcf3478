/* What the contact physics computes, as part of a fingerprint: the bits of short runs with every law,
 * damping, method and well, from the lists that make the keys of scenes. */
#ifndef SWEEP_PHYSICS_H
#define SWEEP_PHYSICS_H

#include "sweeps/engine/protocol.h"

/* One run: the tangential law that it starts from, what is changed there (NULL, NULL: nothing), and a hash of
 * the grains at its end. */
typedef struct {
    const char *law, *key, *word;
    char digits[33];
} sweep_physics_run;

/* Show all runs, until `visit` fails. A word that the simulator refuses in one run is in another. */
rp_status sweep_physics_runs(rp_status (*visit)(const sweep_physics_run *run, void *context), void *context);

/* Add them all to the digits of other runs. */
rp_status sweep_physics_add(char digits[33]);

#endif
