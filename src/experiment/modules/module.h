/* Modules: measures of more than one number. A new one is a file here and a word in the list. */
#ifndef EXP_MODULE_H
#define EXP_MODULE_H

#include <stdio.h>

#include "core/arena.h"
#include "dem/read.h"
#include "params/params.h"
#include "stress/stress.h"

/* A number that a run yields. */
typedef struct {
    const char *name, *unit, *meaning;
} exp_output;

enum { EXP_MODULE_OUTPUTS = 64 }; /* most of a module */

/* The grains that a module is given: those that move, in its region, in the box's frame. */
typedef struct {
    size_t n;
    const dem_state *grains;
    double d, m;         /* diameter and mass of the mean grain */
    double lo[2], hi[2]; /* of the region, infinite without */
    uint32_t kind;       /* that its grains are of, or are told from; 0: any */
    const dem_sim *sim;
    double mass;         /* of all grains that move */
    double mu;           /* of contacts between grains */
    size_t n_marks;      /* ids from 1 on: */
    const double *marks; /* their marked x, y; NAN: none */
    size_t n_contacts;   /* of a module that asks for them: all of the run */
    const dem_contact *contacts;
    size_t n_all; /* all grains, those of the view and others, whose ids rise */
    const dem_state *all;
    size_t n_walls; /* numbers of those of its wall */
    const size_t *walls;
} exp_view;

/* What a module needs, added together: a region with two ends in x, a wall, the contacts, a kind, which it
 * tells from the other grains of its view. */
enum { EXP_BOUNDED = 1, EXP_ON_WALL = 2, EXP_ON_CONTACTS = 4, EXP_OF_KIND = 8 };
typedef struct {
    const char *name, *about, *word; /* the word: status of a run for which it has no numbers */
    const rp_param *schema;          /* of the structure below */
    size_t size;
    const exp_output *outputs; /* endings of names */
    unsigned needs;
    /* Errors: RP_NO_RESULT; others. */
    rp_status (*evaluate)(const exp_view *view, const void *params, double out[]);
    /* Of one that has a table instead of outputs: how many sums it needs; what a sample adds to them, 0 at
     * first; the table of so many samples. Errors: RP_NO_RESULT; others. */
    size_t (*room)(const void *params);
    rp_status (*add)(const exp_view *view, const void *params, double sums[]);
    void (*write)(const void *params, rp_units units, double samples, const double sums[], FILE *out);
} exp_module;
extern const rp_param exp_no_keys[]; /* the schema of one without parameters, a char */
#define EXP_MODULE(NAME, ABOUT, WORD, KEYS, TYPE, OUTPUTS, NEEDS, ...)                                       \
    const exp_module exp_module_##NAME = {.name = #NAME,                                                     \
                                          .about = ABOUT,                                                    \
                                          .word = WORD,                                                      \
                                          .schema = KEYS,                                                    \
                                          .size = sizeof(TYPE),                                              \
                                          .outputs = OUTPUTS,                                                \
                                          .needs = NEEDS,                                                    \
                                          __VA_ARGS__}

/* Is a grain of this id in a view, whose ids rise? */
bool exp_view_has(const exp_view *view, uint32_t id);

/* The grain of that id among n whose ids rise; NULL: there is none. */
const dem_state *exp_grain_of(size_t n, const dem_state grains[], uint32_t id);

/* The grains of the largest cluster of those that touch, *n of them, in that memory. Errors: RP_NO_RESULT,
 * RP_NO_MEMORY. */
rp_status exp_largest_cluster(const exp_view *view, rp_arena *memory, dem_state **grains, size_t *n);

/* Height of the centre at which a grain of radius r, lowered at x onto n grains, is `gap` away from the first
 * of them; at least y. */
double exp_touch_height(size_t n, const dem_state grains[], double x, double r, double gap, double y);

/* Of a contact on the grain that is named first. */
void exp_contact_force(const dem_contact *contact, double force[2]);

/* Bond order: mean over the grains of |psi_6|, the mean of exp(6 i theta) over the neighbours nearer
 * than 1.25 times touching; 1 in a triangular lattice. Fixed grains and those with fewer than two neighbours
 * are left out; NaN if all are. order[n], neighbours[n] (may be NULL): of each grain; NaN where left out. */
double exp_bond_order(size_t n, const dem_state grains[], double order[], int neighbours[]);

/* Profile that rays of 60 degrees put on this base under the outline of a pile of disks of mean diameter 1:
 * the highest points of columns of that width, where disks have their highest points (x, top), joined by
 * straight lines. Steps steeper than rays are filled. Errors: RP_NO_MEMORY, RP_BAD_INPUT (not finite). */
rp_status exp_outline_rays(size_t n, const double x[], const double top[], const stress_base *base,
                           double N[STRESS_DIP_BINS]);

#define EXP_MODULES(X)                                                                                       \
    X(slope)                                                                                                 \
    X(flanks)                                                                                                \
    X(deposit) X(base) X(order) X(fabric) X(profile) X(surface) X(forces) X(limit) X(motion) X(mixing)
#define X(name) extern const exp_module exp_module_##name;
EXP_MODULES(X)
#undef X
extern const exp_module *const exp_modules[]; /* ended by NULL */

#endif
