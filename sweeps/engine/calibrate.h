/* Calibration by runs: a file asks for names of experiments from numbers that were measured, and each stage
 * of the search (stats/identify.h) is a sweep. */
#ifndef SWEEP_CALIBRATE_H
#define SWEEP_CALIBRATE_H

#include "params/expression.h"
#include "stats/identify.h"
#include "sweeps/engine/sweep.h"

/* A number that was measured, a column `of` runs. */
typedef struct {
    const char *of, *experiment, *protocol, *runs;
    double value, error, model_error;
} sweep_measured;

/* Runs that give some of the numbers: of an experiment or protocol with values of its own, or of a table. */
typedef struct {
    const char *kind, *source; /* "experiment", "protocol" or "runs", and its name */
    const char *fixed;         /* values, as a sweep's file has them; "": none */
    bool has[STATS_NAMES];     /* it has this name */
    rp_table *table;           /* of the last stage */
} sweep_group;

typedef struct sweep_problem {
    /* of the caller, before the problem is read */
    rp_arena *arena;
    const char *path; /* of the file */
    const sweep_protocol *const *protocols;
    const char *command; /* for the headers of tables */
    /* and before it is solved: sweep_run of a folder, for runs of this source */
    rp_status (*run)(const struct sweep_problem *problem, size_t stage, const char *source, const char *dir,
                     sweep_counts *counts);
    void *context;

    stats_quest quest; /* its host is this problem; `tell` and `budget` may be set before it is solved */
    char key[33];      /* of the file's text */
    config_t config;
    const char *name[STATS_NAMES];
    sweep_measured number[STATS_NUMBERS];
    sweep_group group[STATS_NUMBERS];
    long seed, budget;
    rp_expression where;
    rp_x_names names;
    const char *folder, *store; /* of the tables, and of the sweeps */
    rp_tally words;             /* how the runs of all stages ended */
    size_t n_table_points;
    double *points; /* of tables */
    stats_runs *runs;
} sweep_problem;

/* Read a file, or for its path this text, and check it: tables are read, and each name and column is one of
 * the runs. Afterwards sweep_problem_free, also after an error. Errors: RP_BAD_INPUT, RP_IO, RP_NO_MEMORY. */
rp_status sweep_problem_read(sweep_problem *problem, const char *text);
void sweep_problem_free(sweep_problem *problem);

/* The answer. Files of the sweeps, stage_1_1.cfg of the first stage and group, and tables of their runs go
 * into the folder, which is there, and the rows of each group into a sweep's folder within `store`, which is
 * made: with it another process goes on. Errors: those of stats_identify, sweep_prepare, sweep_run and
 * sweep_export.
 */
rp_status sweep_problem_solve(sweep_problem *problem, const char *folder, const char *store,
                              stats_answer *answer);

/* The combination of the names that is determined best, as "mu + 1.9 mu_roll". And of the numbers that the
 * runs give besides, the one that differs most along what agrees, beside its scatter, in the last stage;
 * NULL: none stands out. Texts of the problem's arena. */
const char *sweep_problem_combination(const sweep_problem *problem, const stats_answer *answer);
const char *sweep_problem_separator(const sweep_problem *problem, const stats_answer *answer);

#endif
