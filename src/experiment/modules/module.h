/* Modules: measures of more than one number. A new one is a file here and a word in the list. */
#ifndef EXP_MODULE_H
#define EXP_MODULE_H

#include "dem/dem.h"
#include "params/params.h"

/* A number that a run yields. */
typedef struct {
    const char *name, *unit, *meaning;
} exp_output;

enum { EXP_MODULE_OUTPUTS = 64 }; /* most of a module */

/* The grains that a module is given: those that move, in its region, in the box's frame. */
typedef struct {
    size_t n;
    const dem_state *grains;
    double d;            /* diameter of the mean grain */
    double lo[2], hi[2]; /* of the region, infinite without */
    const dem_sim *sim;
} exp_view;

typedef struct {
    const char *name, *about, *word; /* the word: status of a run for which it has no numbers */
    const rp_param *schema;          /* of the structure below */
    size_t size;
    const exp_output *outputs; /* endings of names */
    bool bounded;              /* its region must have two ends in x */
    /* Errors: RP_NO_RESULT; others. */
    rp_status (*evaluate)(const exp_view *view, const void *params, double out[]);
} exp_module;

#define EXP_MODULES(X) X(slope) X(flanks) X(deposit)
#define X(name)        extern const exp_module exp_module_##name;
EXP_MODULES(X)
#undef X

#endif
