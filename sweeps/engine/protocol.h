/* A protocol: one kind of numerical experiment that a sweep repeats over a grid of parameters.
 * A new protocol is a file of sweeps/protocols and a word in the list of protocols.h. */
#ifndef SWEEP_PROTOCOL_H
#define SWEEP_PROTOCOL_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

#include "core/arena.h"
#include "params/params.h"
#include "dem/dem.h"
#include "stress/stress.h"

RP_C_BEGIN

enum { SWEEP_MAX_OUTPUTS = 80 };

/* One number that a run yields, a column of the store. */
typedef struct {
    const char *name;
    const char *unit; /* "" where there is none */
    const char *meaning;
    const char *stored; /* its name in a store, which also tells how it is measured; NULL: `name` */
} sweep_output;

static inline const char *sweep_output_stored(const sweep_output *o)
{
    return o->stored ? o->stored : o->name;
}

/* What one run yields. `status` is one of the protocol's words, "ok" for a full result; values that the
 * run has no result for are NaN. Wall time is kept apart, by the caller. */
typedef struct {
    char status[24];
    char message[232]; /* empty, or why there is no result */
    bool of_measures;  /* the status is that of a measure without a value, not of the run itself */
    double values[SWEEP_MAX_OUTPUTS];
} sweep_result;

/* Where a run that is no text leaves tables; and of a text the snapshot from which another process resumes
 * it.
 */
typedef struct {
    const char *directory;                                          /* NULL: no tables */
    void (*header)(const void *context, rp_units units, FILE *out); /* writes the first lines of each */
    const void *context;
    const char *snapshot, *owner; /* as of run_sinks */
    double interval;
    const volatile bool *stop;
    char *why; /* gets why a snapshot was refused: the run then starts anew */
    size_t size;
} sweep_tables;

typedef struct {
    const char *name;
    const char *about;           /* one line */
    const rp_param *schema;      /* of the structure below; each parameter has a default */
    size_t params_size;          /* bytes of the structure that the schema fills */
    const sweep_output *outputs; /* ended by a NULL name; at most SWEEP_MAX_OUTPUTS */
    rp_units units;              /* of parameters and outputs */

    /* Refuse combinations of parameters that can't work, before anything runs: a time step too large, a
     * box without grains. Errors: RP_BAD_INPUT. */
    rp_status (*check)(const void *params);

    /* Of a protocol that a text describes: its first parameter, a pointer; and what stands for the parameters
     * in keys: false for values that can't be. NULL for those of the program. */
    const void *context;
    const char
        *text; /* of a protocol that is not open yet (sweep_protocol_open): all but its name and `about` */
    bool (*hash)(const void *params, XXH128_hash_t *digest);

    /* One run with the random streams (seed, run, purpose). With `tables` (else NULL) the run, the same to
     * the bit, leaves tables in a folder. Physics without a result (a leak, a pile that never rests) is RP_OK
     * with its status word; an error stops the whole sweep. */
    rp_status (*run)(const void *params, unsigned long seed, unsigned long run, const sweep_tables *tables,
                     sweep_result *result);
} sweep_protocol;

/* Number of a protocol's outputs. */
size_t sweep_count_outputs(const sweep_protocol *protocol);

/* No status word, no message, every value NaN. */
void sweep_result_clear(sweep_result *result);
bool sweep_is_aborted(const char *status); /* of a result: by the machine, or a limit */

/* Give a result its status word and, unless NULL, its message. RP_NO_RESULT if it is that of a failure. */
rp_status sweep_conclude(sweep_result *result, const char *status, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* A table of the run: open it, header written; close it, kept if `status` is RP_OK. Errors: RP_IO. */
typedef struct {
    rp_arena memory;
    const char *path;
    FILE *out;
} sweep_file;
rp_status sweep_table_open(const sweep_tables *tables, rp_units units, const char *name, sweep_file *file);
rp_status sweep_table_close(sweep_file *file, rp_status status);

/* Hash of what is measured, and in which order: of the names in a store. */
uint64_t sweep_outputs_hash(const sweep_output outputs[]);

/* What a grid point has of an output's values, as columns y_mean, y_sd, ... of y. Is this one of them? */
enum { SWEEP_STATISTICS = 6 };
extern const char *const sweep_statistics[SWEEP_STATISTICS];
bool sweep_column_is_statistic(const char *name, const char *output);

RP_C_END

#endif
