/* Integrators: each is a file with a descriptor, and a line of DEM_INTEGRATOR_LIST. The rest of the simulator
 * asks the descriptor. */
#ifndef DEM_INTEGRATOR_H
#define DEM_INTEGRATOR_H

#include <math.h>

#include "dem/dem.h"
#include "dem/state/vec.h"

/* Rates of the fastest mode of a packing whose contacts are all alike: damping, and the square of the
 * frequency, over a third of a pair's. */
typedef struct {
    double gamma, omega2;
} dem_rates;

/* Contacts of which a time step limit is asked: an impact to come, a contact at rest under a column of
 * grains, of the lightest or of the many, a contact that the start has. */
typedef enum { DEM_AT_IMPACT, DEM_AT_REST, DEM_OF_MANY, DEM_AT_START } dem_load;

/* Parts of a contact's force on its first grain, which add up to it: along n, which is shorter than 1 where a
 * pair turns in the step; along s; of rolling at its arm. */
typedef struct {
    dem_vec n, s;
    double elastic, damping, spring, dashpot, slip, well, roll_spring, roll_dashpot;
} dem_parts;

typedef struct dem_scheme {
    const char *name;
    int order[2];      /* of the error where forces are smooth: without damping, with it */
    bool rotation;     /* can rotate grains */
    bool hard;         /* has hard collisions */
    bool excess;       /* keeps excess displacements, which shear springs but mindlin take; see grains.h */
    bool solves;       /* solves each step for its displacements, as `implicit` of the definition says */
    bool runs_ahead;   /* grains may go on before the forces on all the others are there: parts for threads */
    bool even_margins; /* a step may move a grain by more than v dt: half the skin is every grain's margin */

    /* Bytes that it keeps of a grain from step to step, at most a dem_own: a structure of its file. They
     * follow the grain, and are in snapshots and clones; what else it needs of a step it makes anew. */
    size_t own;

    /* Limits of its own; NULL for none. Errors: RP_BAD_INPUT. */
    rp_status (*check)(const dem_definition *def);
    /* Largest stable time step; NULL: none is too large. */
    double (*step_limit)(const dem_definition *def, dem_rates rates, dem_load load);
    /* Largest omega dt at which impacts of a bed gain less than 1 % of what they lose, by their error: gamma
     * and the shear stiffness of a contact over omega and the normal stiffness. */
    double (*impact_limit)(const dem_definition *def, double damping, double shear);

    /* Frees the work space of its own, sim->work, where it has one. */
    void (*free)(dem_sim *sim);

    /* After the start's forces, for the grains from `from` on. */
    void (*start)(dem_sim *sim, size_t from);
    /* Gravity changes between steps; velocities of the full step stay as they are. NULL: nothing to do. */
    void (*gravity)(dem_sim *sim, dem_vec change);
    /* One step, by dem_step_lists and dem_step_forces; `last`: the caller reads the state after it.
     * Errors: as dem_run. */
    rp_status (*step)(dem_sim *sim, bool last);

    /* Velocity and spin of a grain at the time of its position; NULL: as they are kept. */
    dem_vec (*velocity)(const dem_sim *sim, size_t i);
    double (*spin)(const dem_sim *sim, size_t i);

    /* For the energy ledger, where the force of a contact is one all through a step: its parts, 0 without
     * touch, once the step is solved and before the grains move. NULL: the ledger takes the mean of the
     * forces of the step's ends. */
    dem_parts (*parts)(const dem_sim *sim, size_t contact);
} dem_scheme;

#define X(id, word, manual, scheme) extern const dem_scheme scheme;
DEM_INTEGRATOR_LIST(X)
#undef X

/* Hard collisions of bodies.h. Bodies that would touch in the coming step collide at the moment of touch if
 * they close fast; otherwise a soft contact forms. */
typedef struct {
    /* Collisions of the coming step, before it; then that step. *left as of dem_step_lists. Errors:
     * RP_BROKEN, RP_NO_MEMORY. */
    rp_status (*collide)(dem_sim *sim);
    void (*move)(dem_sim *sim, unsigned *left);
} dem_collisions;
extern const dem_collisions dem_collisions_hard;

/* What the program has of both; NULL for what it is built without: papers/methods.c, alone/methods.c. */
extern const dem_scheme *const dem_schemes[DEM_INTEGRATORS];
extern const dem_collisions *const dem_hard_collisions;

/* Limit of schemes that damp by velocities of the half step, which need 4 - 6 gamma dt - 3 omega^2 dt^2 > 0:
 * a part of that root. */
static inline double dem_half_step_limit(dem_rates rates, double part)
{
    const double rate = 3.0 * rates.gamma + sqrt(9.0 * rates.gamma * rates.gamma + 12.0 * rates.omega2);
    return rate > 0.0 ? part * 4.0 / rate : INFINITY;
}

#endif
