/* What protocols share that fill a box, open it and tilt the pile at rest by turning gravity: parameters,
 * phases and fingerprint. */
#ifndef SWEEP_TILTED_H
#define SWEEP_TILTED_H

#include "sweeps/protocols/box.h"

typedef struct {
    sweep_box box;
    double tilt_rate_deg; /* a step */
} sweep_tilted;

extern const rp_param sweep_tilted_schema[];

/* Refuse what cannot be filled or come to rest. Errors: RP_BAD_INPUT. */
rp_status sweep_tilted_check(const void *params);

/* Fill the box, open it, and go through n further phases of an experiment; a resumed run continues in its
 * phase. Errors: those of sweep_box_phase and of the phases. */
rp_status sweep_tilted_phases(sweep_box_run *run, size_t n, rp_status (*const phases[])(void *experiment),
                              void *experiment);

/* Digits of the outputs named in `hashed`, of a run of a small pile that is hardly at rest and so takes
 * milliseconds. Errors: those of run_one. */
rp_status sweep_tilted_fingerprint(rp_status (*run_one)(const void *params, unsigned long seed,
                                                        unsigned long run, const sweep_tables *tables,
                                                        sweep_result *result),
                                   const sweep_output outputs[], const char *hashed, char digits[33]);

#endif
