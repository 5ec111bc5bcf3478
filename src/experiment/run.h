/* A run: what there is of it at any time, and what its phases do to it. */
#ifndef EXP_RUN_H
#define EXP_RUN_H

#include "core/random.h"

#include "experiment/plan.h"

/* Samples of a measure; beside: what it is against, or whether there was an event; pass: of those at the
 * looks of a phase, else 0. And sums over so many, of a module that has a table. */
typedef struct {
    double time, value, beside, step, pass;
} exp_sampled;
typedef struct {
    size_t n, room;
    exp_sampled *at;
    double taken, *sums; /* NULL: none */
} exp_samples;

/* What belongs to the simulation, beside itself: a phase that goes back gets it back. */
typedef struct {
    double tilt, turn[2]; /* so far, degrees; a step, of gravity and of the box */
    double tilt_before;   /* at the last look or the phase's start, that phase step: sums from there on do not
                             depend on where the run is cut */
    long tilted_at;
    size_t laws;  /* of this phase, or SIZE_MAX: the scene's */
    size_t added; /* grains */
    double added_mass;
    uint32_t last; /* id of the last that was added, 0 before */
    bool touched;  /* it has had a contact */
} exp_world;

/* The end of a phase, to go back to. */
typedef struct {
    dem_sim *sim;
    exp_world now;
    long *loads;
} exp_saved;

struct exp_run {
    const exp_plan *plan;
    rp_arena arena; /* of what has the same size all along */
    dem_sim *sim;
    rp_status failed; /* of a look */
    bool measuring;   /* what has no value ends no run, and leaves other measures alone */
    bool cut;         /* walls did so with the region of a fill */
    bool no_region;   /* the region that was asked for last is faulty */
    bool ahead;       /* t and phase_step are those of the step to come, at its middle */
    struct {
        size_t phase;          /* that it is in; n_phases: it has ended */
        long pass;             /* of its block, from 1 */
        long phase_step, most; /* steps in the phase, of which there are so many, or LONG_MAX */
        long steps;            /* in all */
        double begun;          /* time at the phase's start */
        double mass0;          /* of all grains at the start */
        size_t grains0;        /* grains at the start */
        double damped;         /* kinetic energy at the last look of a phase that damps */
        double most_seen[2];   /* speed of a wall, and gravity, that the time step was asked about */
        exp_world now;
        bool started, done, missed; /* the last: a measure that is not optional has no value */
        exp_end end;
    } at;
    double *counters, *values; /* of expressions; of outputs */
    exp_samples *samples;      /* of measures */
    double *marks;             /* x, y of ids from 1 on, in the box's frame; NAN: none */
    uint32_t *kinds;           /* of ids from 1 on; 0: none */
    long *loads;               /* of walls, along x and y: number of the load, or -1 */
    rp_random *random[2];      /* radii and places of the first fill, then of grains that are added */
    exp_saved *saved;          /* of phases */
    exp_passed *passed;        /* of phases; their names aside */
    double **points;           /* of regions: the corners of a polygon, as they were last asked for */
    struct {
        double r, y, touch;
    } grain; /* that is being added */
    /* readings of the present state, made when they are asked for */
    bool fresh;
    size_t n_states, n_contacts;
    dem_state *states;
    dem_contact *contacts; /* NULL: not asked for */
    size_t n_ids;
};

/* End a run with this word and message; while measuring, say so at its end. The first cause stays. */
void exp_conclude(exp_run *run, const char *status, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
/* With the text's word for a good run, or that of a phase that was gone on from. */
void exp_end_run(exp_run *run);

const dem_physics *exp_laws(const exp_run *run); /* that hold */

/* Room for the marks and kinds of ids up to this one. Errors: RP_NO_MEMORY, in run->failed. */
bool exp_make_ids(exp_run *run, size_t id);

/* What a phase does at its start besides forces: laws, grains out of a region, grains put in; going back.
 * What can't be ends the run. */
void exp_go_back(exp_run *run, const exp_phase *p);
void exp_save(exp_run *run, size_t phase);
void exp_change_laws(exp_run *run, const exp_phase *p);
void exp_remove(exp_run *run, const exp_phase *p);
void exp_add_grains(exp_run *run, const exp_phase *p);

/* Loads of walls: begin or end with a phase; then give their walls their speed for a step. */
void exp_load_walls(exp_run *run, const exp_phase *p);
bool exp_is_loaded(const exp_run *run);
/* May a wall move so fast, or gravity be so strong, with this time step; where it is not the run ends. A
 * value not half larger than all before is not asked about. */
void exp_check_speed(exp_run *run, const char *whose, const double v[2], bool gravity);
void exp_push_walls(exp_run *run);
/* Along a direction in which one is free, its load sees to its motion. velocity may be NULL, omega NAN: as
 * before. */
void exp_move_wall(exp_run *run, const exp_wall *wall, const double velocity[2], double omega);

#endif
