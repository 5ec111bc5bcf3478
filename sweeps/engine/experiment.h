/* An experiment's text as a protocol of sweeps: its lets are the parameters, its measures the outputs; and
 * its runs as those of src/run. */
#ifndef SWEEP_EXPERIMENT_H
#define SWEEP_EXPERIMENT_H

#include "params/units.h"
#include "run/run.h"
#include "sweeps/engine/protocol.h"

/* Read the text of a protocol of the program, or of the file `path` unless NULL, with changes as of --set. A
 * protocol that is no text is itself, open: nothing below changes it. Afterwards
 * sweep_protocol_close(*opened), also after an error. Errors: RP_BAD_INPUT (also: it has no phases, or names
 * other files), RP_NO_MEMORY. */
rp_status sweep_protocol_open(const sweep_protocol *protocol, const char *path, const rp_texts *changes,
                              const sweep_protocol **opened);
void sweep_protocol_close(const sweep_protocol *p);

/* The units of the parameters, where they are not those of the text. */
void sweep_protocol_in(const sweep_protocol *p, rp_units units);

/* Make a physical parameter of scenes (dem/scene/text.h) one of these runs too, if no let has its name. */
void sweep_protocol_also(const sweep_protocol *p, const char *name);

/* The plan of a run with these parameters, for exp_free; NULL of a protocol that is no text. Errors: those of
 * exp_read. And what such a run gives. */
rp_status sweep_protocol_plan(const sweep_protocol *p, const void *params, exp_plan **plan);
void sweep_result_of(const run_driver *driver, sweep_result *result);

/* The bytes of the file that it was opened from; NULL: from none. */
const char *sweep_protocol_bytes(const sweep_protocol *p);

#endif
