/* The dimensionless groups on which a pile of the protocol `repose` depends, and its parameters from them.
 *
 * With d the nominal diameter, m the mass of a grain of the mean radius and t = sqrt(d/g), equal groups give
 * the same motion in units of d, m and t. A publication that prints k_n without the mass leaves the first one
 * open. */
#ifndef SWEEP_GROUPS_H
#define SWEEP_GROUPS_H

#include <stdbool.h>

#include "sweeps/engine/protocol.h"

RP_C_BEGIN

/* X(name, formula, logarithmic, lowest, highest, meaning). Groups with a range are open choices, whose prior
 * is uniform over it, in the logarithm where that is so; those with 0, 0 follow from the point of a grid. */
#define SWEEP_GROUPS(X)                                                                                      \
    X(stiffness, "k_n d^1.5/(m g)", true, 2e3, 4e5, "normal stiffness over weight: the mass")                \
    X(damping_rate, "gamma_n t", true, 3.0, 50.0, "normal damping: the gravity")                             \
    X(wall_friction, "mu_wall/mu", false, 0.0, 2.0, "friction of the side walls over that of the grains")    \
    X(floor_friction, "mu_floor/mu", false, 0.5, 3.0, "friction of the floor over that of the grains")       \
    X(pause, "relax_steps dt/t", true, 40.0, 400.0, "time from the opening to the measurement")              \
    X(opening, "open t/d", true, 1.0, 100.0, "speed at which the wall is lifted")                            \
    X(shear_stiffness, "k_s d/(m g)", true, 0.0, 0.0, "shear stiffness over weight")                         \
    X(friction, "mu", false, 0.0, 0.0, "friction of the grains")                                             \
    X(width, "W/d", true, 0.0, 0.0, "width of the box")                                                      \
    X(height, "H/d", true, 0.0, 0.0, "height of the box")
enum {
#define X(name, ...) SWEEP_GROUP_##name,
    SWEEP_GROUPS(X) SWEEP_N_GROUPS
#undef X
};

typedef struct {
    const char *name, *formula;
    bool logarithmic;
    double lo, hi;
    const char *meaning;
} sweep_group;
extern const sweep_group sweep_groups[SWEEP_N_GROUPS];

/* The parameters of `repose` that follow from the open groups, joined by commas. */
#define SWEEP_GROUP_KEYS "density,g,mu_wall,mu_floor,dt,fill_steps,relax_steps,open"

/* The groups of the parameters of `repose`: infinite for a wall that opens at once, and for piles that wait
 * for rest. */
void sweep_groups_of(const void *params, double value[SWEEP_N_GROUPS]);

/* Set the parameters of SWEEP_GROUP_KEYS but the time step from the open groups that are finite; the steps
 * follow from dt. */
void sweep_groups_apply(const double value[SWEEP_N_GROUPS], void *params);

/* Mass of a grain of the mean radius, g, and gravity, cm/s^2. */
void sweep_groups_weight(const void *params, double *mass, double *gravity);

/* Largest time step of the parameters of `repose`. */
double sweep_repose_step_limit(const void *params);

RP_C_END

#endif
