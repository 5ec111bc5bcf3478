/* A protocol that costs nothing, for thousands of runs: y is its only parameter x plus noise, z the noise. */
#ifndef NOISE_H
#define NOISE_H

#include "sweeps/engine/sweep.h"

extern const rp_param noise_schema[];
extern const sweep_output noise_outputs[];

rp_status noise_check(const void *params);
rp_status noise_run(const void *params, unsigned long seed, unsigned long run, const sweep_tables *tables,
                    sweep_result *result);

/* The protocol called `word`, whose runs are made by `runs`. */
#define NOISE_PROTOCOL(word, runs)                                                                           \
    {                                                                                                        \
        .name = word, .about = word, .schema = noise_schema, .params_size = sizeof(double),                  \
        .outputs = noise_outputs, .check = noise_check, .run = runs                                          \
    }

#endif
