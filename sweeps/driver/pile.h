/* Static piles as protocol `pile` and `repose pile` have them: parameters, solution, results, tables. */
#ifndef SWEEP_PILE_H
#define SWEEP_PILE_H

#include "sweeps/driver/outline.h"
#include "sweeps/driver/protocol.h"

/* The fields of protocol `pile`; lengths in sigma, angles in degrees. */
typedef struct {
    double eps, alpha_deg, inner_deg, x_1, gap, disorder, k_x, well, mu, set_load;
    long base, leave, load_steps;
    int branch;
    bool set_again, threshold;
} sweep_pile;

extern const rp_param sweep_pile_schema[];

/* The disks that the parameters describe, unequal ones from the stream (seed, run). Free the outline, which
 * is zero at first, also after an error. Errors: RP_BAD_INPUT, RP_NO_MEMORY. */
rp_status sweep_pile_outline(const sweep_pile *p, unsigned long seed, unsigned long run, sweep_outline *h);

/* One pile, solved. `h` may come from elsewhere; then alpha_deg < 0 says that the parameters do not describe
 * it. `watch` (may be NULL) and its context are those of statics_definition. Free with sweep_solved_free,
 * also after an error. Errors: RP_NO_RESULT (no equilibrium: `results` has its status and message), and those
 * of statics_create. */
typedef struct {
    const sweep_pile *p;
    const sweep_outline *h;
    statics_pile *pile;
    statics_result r;
    size_t *disk;              /* [r.wells] of the base, from left to right; */
    double *N, *H;             /* forces on them, m g */
    sweep_outline_error error; /* NAN where diagonals alone are not known */
} sweep_solved;
rp_status sweep_pile_solve(const sweep_pile *p, const sweep_outline *h,
                           void (*watch)(size_t n, const statics_result *so_far, void *context),
                           void *context, sweep_solved *s, sweep_result *results);
void sweep_solved_free(sweep_solved *s);

/* The eps, sought from p->eps on by bisection, up to which the primary branch is stable: results' eps_c.
 * Errors: as sweep_pile_solve. */
rp_status sweep_pile_threshold(const sweep_pile *p, const sweep_outline *h, sweep_result *results);

/* What the solver says, as header lines; the forces on the base, a row a disk; all tables of a pile in a
 * folder: base.tsv (of an equilibrium), wells.tsv, contacts.tsv, disks.tsv. Errors: RP_IO, RP_NO_MEMORY. */
void sweep_pile_notes(const sweep_solved *s, FILE *out);
rp_status sweep_pile_write_base(const sweep_solved *s, FILE *out);
rp_status sweep_pile_write(const sweep_solved *s, const sweep_tables *tables);

#endif
