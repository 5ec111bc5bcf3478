/* A plan: what a text becomes before anything runs, and what names stand for in it. */
#ifndef EXP_PLAN_H
#define EXP_PLAN_H

#include "experiment/experiment.h"

/* Symbols: uses of observables below this, then outputs. */
enum { EXP_ID_MEASURE = 1 << 20 };

/* An expression of the text, with its place in a run's counters. */
typedef struct {
    rp_expression x;
    size_t state;
} exp_expression;

static inline bool exp_given(const exp_expression *e)
{
    return e->x.text != NULL;
}

/* What a name of the text stands for, by its number among those of its sort; so what an observable is of.
 * Sorts are bits: of a kind in a region both are set, and index is the region's. */
typedef struct {
    enum { EXP_ALL = 0, EXP_REGION = 1, EXP_WALL = 2, EXP_KIND = 4, EXP_PHASE = 8, EXP_MEASURE = 16 } sort;
    size_t index, kind;
    const char *name;
} exp_scope;
enum { EXP_SCOPES = EXP_REGION | EXP_WALL | EXP_KIND }; /* their names differ from each other's */

typedef struct exp_use exp_use;
typedef struct {
    const char *name;
    enum {
        OF_RUN = 1,
        OF_GRAINS = 2,
        OF_REGION = 4,
        OF_PART = OF_GRAINS | OF_REGION,
        OF_WALL = 8,
        OF_NEW = 16,
        OF_KIND_IN = 32, /* of a kind in a region, as all of OF_GRAINS */
        OF_FILLED = OF_REGION | OF_KIND_IN
    } of;
    int least, most; /* numbers in brackets */
    rp_x_type type;
    const char *unit, *meaning;
    double (*value)(exp_run *run, const exp_use *use, const double args[]);
} exp_observable;
extern const exp_observable exp_observables[];                             /* ended by a NULL name */
const exp_observable *exp_observable_named(const char *name, unsigned of); /* NULL: none */

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
    exp_expression at[4]; /* x from and to, y from and to; or centre and radius */
    size_t n_points;      /* of a polygon, x and y of each */
    exp_expression *points;
} exp_region;

typedef struct {
    const char *name;
    size_t n, *walls; /* numbers */
} exp_wall;

typedef struct {
    const char *word;
    exp_expression when;
} exp_fail;

/* What a wall does from here on: a motion, a load along x or y in which it is free, or the end of that. */
typedef enum { EXP_SAME, EXP_LOADED, EXP_FREED } exp_loading;
typedef struct {
    size_t wall; /* number among the plan's */
    const config_setting_t *setting;
    bool each_step; /* it asks for what changes from step to step */
    exp_expression velocity[2], omega;
    exp_loading loading[2];
    exp_expression load[2], speed;
    size_t number; /* among the plan's loads */
} exp_move;

/* Grains that a phase puts in. */
typedef struct {
    bool on, in_range; /* the latter: anywhere between y[0] and y[1] */
    uint32_t kind;     /* number; 0: none */
    exp_expression n, r, density, x[2], y[2], vx, vy, omega, gap;
    dem_fill radii;
} exp_add;

typedef enum { EXP_STEPS, EXP_TIME, EXP_UNTIL } exp_ending;

typedef struct {
    /* by schema */
    const char *name, *open, *status;
    long least, every, most, repeat;
    bool mark, go_on, damp;
    const char *from, *remove;
    /* by hand */
    const config_setting_t *setting;
    bool left_out, is_sampled; /* the last: some measure takes samples at its looks */
    bool turned;               /* the box, in it or before */
    unsigned *moving;          /* of walls: whether and how they do in it */
    exp_ending ending;
    exp_expression end;     /* steps, time or until; of a block, its until */
    exp_expression turn[2]; /* degrees a step: gravity, box */
    exp_expression gravity[2];
    bool gravity_each_step, each_step; /* the last: this or a move */
    long opens;                        /* number of the wall, or -1 */
    size_t n_moves;
    exp_move *moves;
    exp_add add;
    bool has_laws, is_source; /* is_source: a later phase goes back to its end */
    dem_scene_laws laws;      /* that hold in it */
    dem_material *given;      /* and the coefficients of the walls, as given */
    dem_definition def;       /* that follows from both; zero without laws of its own */
    size_t source;            /* phase of `from`, or SIZE_MAX */
    exp_scope removes;
    size_t n_fails;
    exp_fail *fails;
    size_t n_inner;   /* phases of a block, which follow it */
    size_t block;     /* of an inner phase; else SIZE_MAX */
    size_t states[2]; /* counters of its expressions */
} exp_phase;

enum { TAKE_VALUE, TAKE_MEAN, TAKE_MAX, TAKE_MIN, TAKE_FIRST, TAKE_RATE, TAKE_AVALANCHES, TAKE_LINE };
#define EXP_TAKES "value | mean | max | min | first | rate | avalanches | line"

typedef struct {
    const char *name, *at, *during, *unit, *meaning, *prefix, *in, *kind, *wall, *level_of;
    size_t levels_with;             /* number of that measure, or its own */
    const char *file, *series_unit; /* of its table */
    int take;
    long every;
    double skip, drop; /* share, INFINITY: where it levels off; least fall of an avalanche, or INFINITY */
    bool series, optional;
    const config_setting_t *setting;
    bool left_out;
    size_t phase, output; /* its phase; the first of its outputs */
    exp_expression of, when, event, against;
    const exp_module *module; /* instead of `of`; NULL: none */
    void *params;             /* of the module */
    long pick;                /* the module's output that is sampled; -1: all are outputs */
    exp_scope scope;          /* of the module */
    size_t on;                /* its wall */
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
    size_t n_scopes, n_regions, n_walls, n_phases, n_measures, n_outputs, n_uses, n_states, n_loads, n_series;
    size_t *series;    /* measures with a table */
    exp_scope *scopes; /* in the order of the text */
    exp_move **loads;
    bool adds, asks_measures; /* some phase does */
    exp_region *regions;
    exp_wall *walls;
    exp_phase *phases;
    exp_measure *measures;
    exp_output *outputs;
    exp_use *uses;
};

/* The first of these sorts, added together, whose name are so many letters; NULL: there is none. `guess` (may
 * be NULL) tries all names. */
const exp_scope *exp_scope_named(const exp_plan *plan, unsigned sorts, const char *name, size_t length,
                                 rp_guess *guess);

/* Where an expression stands: what it may name. */
typedef struct {
    exp_plan *plan;
    rp_x_names names;
    size_t phase;    /* of a phase; SIZE_MAX: of measures, or of the whole text */
    size_t measure;  /* outputs of measures before this one are known; SIZE_MAX: by phase */
    bool lets_alone; /* before the run */
    bool of_grain;   /* names of a new grain are known */
} exp_place;
void exp_place_in(exp_place *place, exp_plan *plan);

/* Read an expression of this type from a setting, a number, truth or text. Errors: RP_BAD_INPUT. */
rp_status exp_expression_read(const config_setting_t *setting, const char *key, rp_x_type type,
                              exp_place *place, exp_expression *e);

/* Does an expression ask for this observable; NULL: for any, and not for measures alone? */
bool exp_asks(const exp_plan *plan, const exp_expression *e, const char *observable);
bool exp_names(const exp_plan *plan, const char *observable); /* does any expression of the text? */

/* From this phase on, the next that is not left out: of a block, or of the text. */
size_t exp_present(const exp_plan *plan, size_t phase, size_t end);

/* The density of new grains; given: if the text says one. */
double exp_density(const exp_plan *plan, const exp_add *a, double given);

long exp_known_steps(const exp_phase *p);   /* -1: it ends by a condition, or by what the run alone knows */
long exp_next_look(long since, long every); /* steps to it, so many after looks have begun */

#endif
