/* An experiment's text as a protocol of sweeps: its lets are the parameters, its measures the outputs. */
#ifndef SWEEP_EXPERIMENT_H
#define SWEEP_EXPERIMENT_H

#include "params/units.h"
#include "sweeps/engine/protocol.h"

typedef struct sweep_experiment sweep_experiment;

/* Read a text, with changes as of --set. Afterwards sweep_experiment_close, also after an error.
 * Errors: RP_BAD_INPUT (also: it has no phases, or names other files), RP_NO_MEMORY. */
rp_status sweep_experiment_open(const char *path, const rp_texts *changes, sweep_experiment **made,
                                const sweep_protocol **opened);

/* The same of a protocol that is a text of the program; one that is not is itself, and *made NULL. */
rp_status sweep_protocol_open(const sweep_protocol *protocol, const rp_texts *changes,
                              sweep_experiment **made, const sweep_protocol **opened);

/* The units of the parameters of an open protocol, where they are not those of its text. */
void sweep_experiment_in(sweep_experiment *e, rp_units units);

/* Make a physical parameter of scenes (dem/scene/text.h) one of these runs too, if no let has its name. */
void sweep_experiment_also(sweep_experiment *e, const char *name);
void sweep_experiment_close(sweep_experiment *e);

/* The bytes of the file that it was opened from; NULL: from none, also without an experiment. */
const char *sweep_experiment_text(const sweep_experiment *e);

#endif
