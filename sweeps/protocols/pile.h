/* Close-packed piles of disks on a flat base, as the static solver takes them (statics/equilibrium.h): their
 * outlines, with what diagonal contacts alone would carry in them; parameters, solution, results and tables
 * of protocol `pile` and `repose pile`. Lengths in sigma, forces in m g, angles in radians. Liffman, Chan &
 * Hughes 1992. */
#ifndef SWEEP_PILE_H
#define SWEEP_PILE_H

#include "analytic/analytic.h"
#include "statics/equilibrium.h"
#include "sweeps/engine/protocol.h"

typedef struct {
    size_t n, k; /* disks; in the base */
    long *up;    /* [k] disks of the diagonal that rises to the right from a disk of the base */
    statics_disk *disks;
    an_force *exact; /* [k] by diagonals alone, of equal disks */
    double B;        /* base of the same outline and the same weight */
    rp_arena memory;
} sweep_outline;

/* k disks in the base and slopes alpha on both sides, by an_lattice_cut; alpha <= 0 is the full triangle. Or
 * by the same rule under a polygon of n > 0 vertices from left to right (an_profile_set), which the base is
 * scaled to. The disks of a row are `gap` apart, those of the diagonals touch. Errors: RP_BAD_INPUT,
 * RP_NO_MEMORY. Free the outline, which is zero at first, also after an error. */
rp_status sweep_outline_make(sweep_outline *outline, long k, double gap, double alpha, size_t n,
                             const an_point v[]);

/* The same without its disks: n, k and B. */
rp_status sweep_outline_count(sweep_outline *outline, long k, double gap, double alpha, size_t n,
                              const an_point v[]);
void sweep_outline_free(sweep_outline *outline);

/* Unequal disks at the same positions: radii (1 + S z)/2 with z normal, cut at +-3, from the stream (seed,
 * run, RP_PURPOSE_RADII); weights as r^2. Disks of the base stay as they are: wells would hold the squeeze
 * between unequal ones for ever. S in [0, 0.1]. Errors: RP_NO_MEMORY. */
rp_status sweep_outline_disorder(sweep_outline *outline, double S, unsigned long seed, unsigned long run);

/* Friction that the base must have at least: largest |H|/N of its disks. INFINITY for a disk that
 * carries H but no N. */
double sweep_outline_friction(size_t k, const double N[], const double H[]);

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

/* One pile, solved. `watch` (may be NULL) and its context are those of statics_definition. Free with
 * sweep_solved_free, also after an error. Errors: RP_NO_RESULT (no equilibrium: `results` has its status and
 * message), and those of statics_create. */
typedef struct {
    const sweep_pile *p;
    const sweep_outline *h;
    statics_pile *pile;
    statics_result r;
    size_t *disk;                             /* [r.wells] of the base, from left to right; */
    double *N, *H;                            /* forces on them, m g */
    double N_error_rms, N_error_max, H_ratio; /* outputs */
    rp_arena memory;
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
