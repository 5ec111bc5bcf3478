/* The parts of `repose forensics`: published numbers, runs of a design, their emulation. */
#ifndef CLI_FORENSICS_H
#define CLI_FORENSICS_H

#include "report/cells.h"
#include "stats/emulator.h"
#include "stats/forensics.h"
#include "sweeps/engine/groups.h"

/* A published number: claim, what it measures, at which point, and whether it is held out. */
typedef struct {
    char name[40];
    stats_published published; /* radians */
    size_t stem, point;
    bool held;
} forensics_claim;

enum { FORENSICS_CLAIMS = 24, FORENSICS_STEMS = 4 };

typedef struct {
    size_t n, n_points, n_stems;
    forensics_claim claims[FORENSICS_CLAIMS];
    cli_words usual, points[FORENSICS_CLAIMS]; /* header line `at`; its keys at each point */
    char stems[FORENSICS_STEMS][32]; /* columns without _deg; the first is that of all numbers not held out */
} forensics_claims;

/* Read the rows of claims with a cell `forensics`. Errors: RP_BAD_INPUT; RP_NO_RESULT without any. */
rp_status forensics_claims_read(const char *path, forensics_claims *claims);

/* Parameters of `repose`, and these at a point. Errors: RP_BAD_INPUT. */
void *repose_params_new(void);
void repose_params_copy(void *to, const void *from);
rp_status repose_params_set(void *params, const char *name, const char *value);
rp_status repose_params_at(void *params, const cli_words *point);

struct forensics_study;

/* Settings of a design: the groups of its open choices, and parameters that have its factors. */
typedef struct {
    size_t n;
    double *group; /* [setting][SWEEP_N_GROUPS], infinite where they follow from the point */
    void **params;
    const struct forensics_study *study; /* whose factors these are; NULL: all */
} forensics_settings;

/* n settings that fill the prior. Errors: RP_BAD_INPUT. */
rp_status forensics_design(const forensics_claims *claims, size_t n, gsl_rng *rng, forensics_settings *d);

/* Print the grid of these settings, each with the time step that all points allow. Errors: RP_BAD_INPUT, for
 * a level that no design has too. */
rp_status forensics_design_print(const forensics_claims *claims, const forensics_settings *d);

/* How the surface of a pile is read; a column of the first has its stem alone. */
enum { FORENSICS_SURFACES = 12 };
extern const char *const forensics_surfaces[FORENSICS_SURFACES];

/* A factor: a column of the runs with its levels. */
typedef struct {
    const char *name;
    cli_groups levels;
} forensics_factor;

enum { FORENSICS_FACTORS = 24 };

/* Runs, by cells: a setting of the choices at a point. */
typedef struct forensics_study {
    const forensics_claims *claims;
    rp_table *runs;
    size_t n_first;  /* rows of the first sweep; the settings of the others come later */
    bool is_reduced; /* rows are means over runs, as `sweep export --reduce` writes them */
    cli_groups settings;
    size_t *first; /* first run of each setting */
    size_t n_factors, n_cells;
    forensics_factor factors[FORENSICS_FACTORS];
    size_t *setting, *point; /* of each cell that has runs */
    double *runs_of, *ok;    /* number of runs of each, and of those with a result */
    double *mean;            /* [stem][surface][cell], radians; NaN with fewer than two results */
    double *variance; /* [cell] of the mean by the first stem and surface, pooled over a point's cells */
    double *group;    /* [cell][SWEEP_N_GROUPS] */
    double *base;     /* [setting][SWEEP_N_GROUPS], where a claim names no point */
    bool varies[SWEEP_N_GROUPS];                   /* over the cells: inputs of the emulator */
    bool is_choice[SWEEP_N_GROUPS];                /* open, and varies over the settings */
    double lo[SWEEP_N_GROUPS], hi[SWEEP_N_GROUPS]; /* over the cells, on the scale of the group */
} forensics_study;

/* Errors: RP_BAD_INPUT (a column or parameter missing, a group that is infinite in some settings only, a
 * factor of too many levels); RP_NO_RESULT for too few cells with a result. */
rp_status forensics_study_read(rp_table *runs, size_t n_first, const forensics_claims *claims,
                               forensics_study *study);

/* Parameters of a setting's first run, where a claim names no point. Errors: RP_BAD_INPUT. */
rp_status forensics_study_params(const forensics_study *study, size_t setting, void *params);

/* A group on its scale, the logarithm or itself, and back. */
double forensics_scaled(size_t group, double value);
double forensics_unscaled(size_t group, double scaled);

/* Predictions of cells that had no part in them: number of cells, standard deviations of their values and of
 * these values' noise, root mean square error and the one that the predictions state, share within 95 %. */
typedef struct {
    size_t n;
    double spread, noise, rms, stated, covered;
} forensics_left_out;

/* An emulator of the runs, with what every kernel predicts of each setting of the first sweep from all
 * others, and of all settings of later sweeps, together, from the first. */
typedef struct {
    stats_kernel kernel; /* the better one */
    struct {
        forensics_left_out setting, sweep;
        double score;
    } of[STATS_KERNELS];
    stats_emulator e;
    size_t n;                       /* cells with a result */
    double *x, *variance, *weights; /* weights: [stem][surface][n] */
    int *level;
    size_t *group;
    double *centre, *scale; /* [stem][surface] mean of the values; variance in units of the first */
    double spread, noise;   /* standard deviations of the values, and of their noise */
} forensics_emulator;

/* Of the angles; of whether runs have a result (its values are normal deviates, and only the first weights
 * and centre are set). Free the emulator with stats_emulator_free. Errors: those of emulator.h. */
rp_status forensics_emulate(const forensics_study *study, forensics_emulator *m);
rp_status forensics_emulate_completion(const forensics_study *study, forensics_emulator *m);

/* Draws of the choices from their prior, and what the emulators predict of them. */
typedef struct {
    size_t n, n_sets;          /* draws; stems times surfaces */
    void *base;                /* parameters that no choice changes */
    double *value;             /* [draw][SWEEP_N_GROUPS] at the base, as in the study */
    double *mass, *gravity;    /* [draw] g, cm/s^2 */
    size_t *level;             /* [factor][draw] */
    double *mean, *covariance; /* [draw][set][point], [draw][point][point] */
    double *log_complete;      /* [draw] of the points of numbers not held out */
} forensics_draws;
rp_status forensics_draw(const forensics_study *study, const forensics_emulator *angles,
                         const forensics_emulator *completion, size_t n, gsl_rng *rng,
                         forensics_draws *draws);

/* Parameters of a draw, where a claim names no point. Errors: RP_BAD_INPUT. */
rp_status forensics_draw_params(const forensics_study *study, const forensics_draws *draws, size_t draw,
                                void *params);

#endif
