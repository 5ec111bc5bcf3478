/* The box experiment of Lee & Herrmann 1993, sections 3 and 4, beyond what every protocol offers. */
#ifndef SWEEP_PROTOCOL_REPOSE_H
#define SWEEP_PROTOCOL_REPOSE_H

#include <stdio.h>

#include "sweeps/protocol.h"

/* One run of protocol `repose` that leaves its tables in the folder `directory`: grains and contacts when
 * the box is full (filled_*.tsv) and of the final pile (pile_*.tsv), energies every `every` steps
 * (energy.tsv), and scene.cfg, which `repose run` takes to the same bits. `header` is called for each table
 * to write its first lines. Errors: as the protocol's run; RP_IO. */
rp_status sweep_repose_trace(const void *params, unsigned long seed, unsigned long run, const char *directory,
                             long every, void (*header)(FILE *), sweep_result *result);

#endif
