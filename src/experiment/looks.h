/* Looks at a run: readings of its state, expressions, regions and measures. */
#ifndef EXP_LOOKS_H
#define EXP_LOOKS_H

#include "experiment/run.h"

/* What expressions are now. */
double exp_value(exp_run *run, const exp_expression *e);
bool exp_true(exp_run *run, const exp_expression *e); /* of a NAN false: a sample that is none */
/* Of a key of the present phase; a truth is 0 or 1. NAN ends the run. */
double exp_number(exp_run *run, const char *key, const exp_expression *e);
char *exp_operands(rp_arena *arena, const exp_run *run, const exp_expression *e); /* for messages */

/* The states of the grains as they are now; NULL after a failure. */
const dem_state *exp_states(exp_run *run);
const dem_contact *exp_contacts(exp_run *run, size_t *n); /* the same of the contacts, none after a failure */
void exp_mark(exp_run *run);

/* The grains of a scope at this look: of a region, of a kind, or of both. */
typedef struct {
    bool all, circle;
    size_t n_points;       /* of a polygon */
    const double *points;  /* the run's own, of this region */
    double at[4];          /* x, y from and to; or centre, radius */
    const uint32_t *kinds; /* by ids from 1 on; NULL: of any kind */
    uint32_t kind;
} exp_within;
const char *exp_region_fault(const exp_within *region);          /* NULL: none */
exp_within exp_within_now(exp_run *run, const exp_scope *scope); /* a faulty region ends the run */
bool exp_is_within(const void *within, uint32_t id, double x, double y);
double exp_share_within(const exp_within *region, const dem_state *grain); /* of its area, from 0 to 1 */

double exp_observe(void *run, int id, const double args[]);

/* The numbers of a module. Errors: RP_NO_RESULT; others. */
rp_status exp_module_values(exp_run *run, const exp_measure *m, double out[EXP_MODULE_OUTPUTS]);

/* Take the samples of a look; the values of the measures of a phase that has ended. */
void exp_sample(exp_run *run);
void exp_measure_phase(exp_run *run, size_t phase);
void exp_measures_in(const exp_run *run, long *next); /* lowered to the steps to the next sample */

#endif
