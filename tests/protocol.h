/* Protocols with parameters of a test, and what they give. */
#ifndef PROTOCOL_H
#define PROTOCOL_H

#include "sweeps/protocols/protocols.h"

/* A protocol of the program, open as long as the tests run. */
const sweep_protocol *protocol_of(const sweep_protocol *protocol);

/* The defaults with changes, ended by NULL, each "name=value" or several with blanks between; of a text also
 * those of a scene that it has no name for. Free them. */
void *protocol_params(const sweep_protocol *protocol, const char *const changes[]);
#define PROTOCOL_PARAMS(protocol, ...) protocol_params(protocol, (const char *const[]){__VA_ARGS__, NULL})

/* A checked run of stream (1993, 0) with its tables in the folder `t` of the test (program.h), and a row of
 * energies every so many steps. */
void protocol_trace(const sweep_protocol *protocol, const void *params, long every, sweep_result *result);

/* The box of protocol repose by hand, of stream (1993, run): filled for so many steps, then open. */
void protocol_box(double W, double H, long run, const double steps[2], dem_sim **sim);

/* An output by its name; a failed assertion and NaN if there is none. */
double protocol_output(const sweep_protocol *protocol, const sweep_result *result, const char *name);

/* The export of a sweep as it is printed; "" where it is refused. Free it. */
char *protocol_export(const char *folder, const sweep_protocol *const *protocols, unsigned what);

#endif
