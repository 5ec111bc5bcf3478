/* What protocols share that fill a box, open it and tilt the pile at rest by turning gravity: parameters and
 * fingerprint. */
#ifndef SWEEP_TILTED_H
#define SWEEP_TILTED_H

#include "sweeps/driver/box.h"

typedef struct {
    sweep_box box;
    double tilt_rate_deg; /* a step */
} sweep_tilted;

extern const rp_param sweep_tilted_schema[];

/* Digits of the outputs named in `hashed`, of a run of a small pile that is hardly at rest and so takes
 * milliseconds. Errors: those of run_one. */
rp_status sweep_tilted_fingerprint(rp_status (*run_one)(const void *params, unsigned long seed,
                                                        unsigned long run, const sweep_tables *tables,
                                                        sweep_result *result),
                                   const sweep_output outputs[], const char *hashed, char digits[33]);

#endif
