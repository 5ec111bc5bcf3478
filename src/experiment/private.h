/* What the files of an experiment share: the plan, the run, and what names stand for. See experiment.h. */
#ifndef EXP_PRIVATE_H
#define EXP_PRIVATE_H

#include "experiment/experiment.h"

enum { EXP_ID_MEASURE = 1 << 20 }; /* symbols from here on are outputs, below uses of observables */

/* An expression of the text, with its place in a run's counters. */
typedef struct {
    rp_expression x;
    size_t state;
} exp_expression;

/* What an observable is of. */
typedef struct {
    enum { EXP_ALL, EXP_REGION, EXP_WALL } kind;
    size_t index;
} exp_scope;

typedef struct exp_use exp_use;
typedef struct {
    const char *name;
    enum { OF_RUN = 1, OF_GRAINS = 2, OF_REGION = 4, OF_WALL = 8 } of; /* sums */
    int least, most;                                                   /* numbers in brackets */
    rp_x_type type;
    const char *unit, *meaning;
    double (*value)(exp_run *run, const exp_use *use, const double args[]);
} exp_observable;
extern const exp_observable exp_observables[]; /* ended by a NULL name */

struct exp_use {
    const exp_observable *of;
    exp_scope scope;
    int n_args;
    size_t state; /* of `rest` */
    const char *key;
};

typedef struct {
    const char *name;
    bool circle;
    exp_expression x[2], y[2], circle_of[3];
} exp_region;

typedef struct {
    const char *name;
    size_t n, *walls; /* numbers */
} exp_wall;

typedef struct {
    const char *word;
    exp_expression when;
} exp_fail;

/* A wall's new motion. */
typedef struct {
    size_t wall;                             /* number among the plan's */
    bool has_velocity, has_omega, each_step; /* the latter: it asks for what changes from step to step */
    exp_expression velocity[2], omega;
} exp_move;

typedef enum { EXP_STEPS, EXP_TIME, EXP_UNTIL } exp_ending;

typedef struct {
    /* by schema */
    const char *name, *open, *status;
    long least, every, most, repeat;
    bool mark, go_on;
    /* by hand */
    const config_setting_t *setting;
    bool left_out;
    exp_ending ending;
    exp_expression end;     /* steps, time or until; of a block, its until */
    exp_expression turn[2]; /* degrees a step: gravity, box */
    exp_expression gravity[2];
    bool turns[2], has_gravity, gravity_each_step, each_step; /* the last: this or a move */
    long opens;                                               /* number of the wall, or -1 */
    size_t n_moves;
    exp_move *moves;
    size_t n_fails;
    exp_fail *fails;
    size_t n_inner,
        block;        /* phases of a block, which follow it; of an inner phase: its block; else SIZE_MAX */
    size_t states[2]; /* counters of its expressions */
} exp_phase;

typedef enum { TAKE_VALUE, TAKE_MEAN, TAKE_MAX, TAKE_MIN, TAKE_FIRST, TAKE_RATE, TAKE_AVALANCHES } exp_take;
#define EXP_TAKES "value | mean | max | min | first | rate | avalanches"

typedef struct {
    const char *name, *at, *during, *unit, *in;
    int take;
    long every;
    double skip, drop; /* share, INFINITY: where it levels off; least fall of an avalanche, or INFINITY */
    bool series, optional;
    const config_setting_t *setting;
    bool left_out;
    size_t phase, output; /* its phase; the first of its outputs */
    exp_expression of, when, event;
    const exp_module *module; /* instead of `of`; NULL: none */
    void *params;             /* of the module */
    long pick;                /* the module's output that is sampled; -1: all are outputs */
    exp_scope scope;          /* of the module */
    size_t n_outputs, states[2];
} exp_measure;

struct exp_plan {
    rp_arena arena;
    dem_text *text;
    dem_scene scene;
    double d, m, g;
    const char *result;
    struct {
        double energy, force;
        long looks, every;
    } rest;
    size_t n_regions, n_walls, n_phases, n_measures, n_outputs, n_uses, n_states;
    exp_region *regions;
    exp_wall *walls;
    exp_phase *phases;
    exp_measure *measures;
    exp_output *outputs;
    exp_use *uses;
};

/* Where an expression stands: what it may name. */
typedef struct {
    exp_plan *plan;
    rp_x_names names;
    size_t phase;    /* of a phase; SIZE_MAX: of measures, or of the whole text */
    size_t measure;  /* outputs of measures before this one are known; SIZE_MAX: by phase */
    bool lets_alone; /* before the run */
} exp_place;
void exp_place_in(exp_place *place, exp_plan *plan);

/* Read an expression of this type from a setting, a number, truth or text. Errors: RP_BAD_INPUT. */
rp_status exp_expression_read(const config_setting_t *setting, const char *key, rp_x_type type,
                              exp_place *place, exp_expression *e);

/* Samples of a measure: time, value, and whether there was an event. */
enum { EXP_SAMPLE = 3 };
typedef struct {
    size_t n, room;
    double *at;
} exp_samples;

struct exp_run {
    const exp_plan *plan;
    dem_sim *sim;
    rp_status failed; /* of a look */
    bool ahead;       /* t and phase_step are those of the step to come, at its middle */
    struct {
        size_t phase;           /* that it is in; n_phases: it has ended */
        long pass;              /* of its block, from 1 */
        long phase_step, most;  /* steps in the phase, of which there are so many, or LONG_MAX */
        long steps;             /* in all */
        double begun;           /* time at the phase's start */
        double tilt, turn[2];   /* so far, degrees; a step, of gravity and of the box */
        double mass0;           /* of all grains at the start */
        size_t grains0, marked; /* grains at the start; marked */
        bool started, done;
        exp_end end;
    } at;
    double *counters, *values; /* of expressions; of outputs */
    exp_samples *samples;      /* of measures */
    double *marks;             /* x, y of ids from 1 on, in the box's frame; NAN: none */
    /* readings of the present state, made when they are asked for */
    bool fresh;
    size_t n_states;
    dem_state *states;
    size_t n_ids;
};

/* End a run with this word and message. */
void exp_conclude(exp_run *run, const char *status, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

double exp_value(exp_run *run, const exp_expression *e);
bool exp_true(exp_run *run, const exp_expression *e);

/* Does an expression ask for anything but measures? */
bool exp_changes(const exp_expression *e);

/* The states of the grains as they are now; NULL after a failure. */
const dem_state *exp_states(exp_run *run);
void exp_mark(exp_run *run);
double exp_observe(void *run, int id, const double args[]);

/* The numbers of a module. Errors: RP_NO_RESULT; others. */
rp_status exp_module_values(exp_run *run, const exp_measure *m, double out[EXP_MODULE_OUTPUTS]);
const exp_module *exp_module_find(const char *name, size_t length); /* NULL: none */

/* Take the samples of a look; the values of the measures of a phase that has ended. */
void exp_sample(exp_run *run);
void exp_measure_phase(exp_run *run, size_t phase);
bool exp_measures_in(const exp_run *run, long *next); /* steps of the phase to the next sample */

#endif
