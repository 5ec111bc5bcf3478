/* Every protocol of the program: the list that the functions of sweep.h are given. */
#ifndef SWEEP_PROTOCOLS_H
#define SWEEP_PROTOCOLS_H

#include "sweeps/engine/sweep.h"

RP_C_BEGIN

#define SWEEP_PROTOCOLS(X) X(pile)
#define SWEEP_TEXTS(X)     X(repose) X(flux) X(stress) X(onset) X(drop) /* repose.cfg, beside this file */

#define X(name) extern const sweep_protocol sweep_protocol_##name;
SWEEP_PROTOCOLS(X)
SWEEP_TEXTS(X)
#undef X

extern const sweep_protocol *const sweep_protocols[]; /* ended by NULL */

RP_C_END

#endif
