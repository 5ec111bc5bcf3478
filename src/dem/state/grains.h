/* Grains: one list of all arrays that have an entry for each. A new array is a line of it. */
#ifndef DEM_GRAINS_H
#define DEM_GRAINS_H

#include "dem/dem.h"
#include "dem/state/vec.h"

/* Position and velocity of a grain, which the pair loop reads as one 32-byte piece. Verlet's velocity is
 * half a step behind, v(n - 1/2). */
typedef struct {
    dem_vec x, v;
} dem_motion;

/* Contact force, without gravity, and torque on a grain that rotates, in one 32-byte piece. */
typedef struct {
    dem_vec force;
    double torque, spare;
} dem_force_torque;

/* Room for what an integrator keeps of a grain from step to step: a structure of its own file. */
typedef struct {
    dem_vec room[4];
} dem_own;

/* How an array follows its grains. */
typedef enum {
    DEM_STATE,  /* sorted with the grains; copied by a clone */
    DEM_LISTED, /* set anew by each rebuilding of the neighbour list; copied by a clone */
    DEM_INDEX,  /* the same, but entry i does not belong to grain i */
    DEM_OF_STEP /* of one step alone */
} dem_grain_role;

/* Type, name, the definitions and integrators that need it (NULL for others), role.
 *
 * motion, force or force_torque: see above; force is without rotation. inverse_mass: 0 where a grain is
 * fixed. angle, omega: omega is of half a step before, as velocities are. own: of the integrator. excess:
 * displacement since the last force evaluation beyond v dt, that shear springs lack; between steps, position
 * less that of the last force evaluation. listed_x: position as the neighbour list was built; margin2: square
 * of the distance that a grain may go from there; cutoff: radius and margin. fixed: indices of the n_fixed
 * fixed grains. Of hard collisions: next_*, after the coming
 * step; collided, in that step. displacement
 * to further_step: of the implicit step, implicit.c. Of a rebuilding of the list: cell;
 * moved_to: new index, DEM_NOWHERE where the grain is gone; held: by new index, the first pair that keeps
 * springs; held_slot: the old wall slot. */
#define DEM_GRAIN_ARRAYS(X)                                                                                  \
    X(dem_motion, motion, true, DEM_STATE)                                                                   \
    X(dem_vec, force, !def->rotation, DEM_STATE)                                                             \
    X(dem_force_torque, force_torque, def->rotation, DEM_STATE)                                              \
    X(double, radius, true, DEM_STATE)                                                                       \
    X(double, mass, true, DEM_STATE)                                                                         \
    X(double, inverse_mass, true, DEM_STATE)                                                                 \
    X(uint32_t, id, true, DEM_STATE)                                                                         \
    X(uint32_t, kind, def->n_kinds > 1, DEM_STATE)                                                           \
    X(double, angle, def->rotation, DEM_STATE)                                                               \
    X(double, omega, def->rotation, DEM_STATE)                                                               \
    X(double, inverse_inertia, def->rotation, DEM_STATE)                                                     \
    X(dem_own, own, scheme->own > 0, DEM_STATE)                                                              \
    X(dem_vec, excess, scheme->excess, DEM_STATE)                                                            \
    X(dem_vec, listed_x, true, DEM_LISTED)                                                                   \
    X(double, margin2, true, DEM_LISTED)                                                                     \
    X(double, cutoff, true, DEM_LISTED)                                                                      \
    X(uint32_t, fixed, true, DEM_INDEX)                                                                      \
    X(dem_motion, next_motion, def->hard.on, DEM_OF_STEP)                                                    \
    X(double, next_angle, def->hard.on && def->rotation, DEM_OF_STEP)                                        \
    X(double, next_omega, def->hard.on && def->rotation, DEM_OF_STEP)                                        \
    X(bool, collided, def->hard.on, DEM_OF_STEP)                                                             \
    X(dem_vec, displacement, scheme->solves, DEM_OF_STEP)                                                    \
    X(dem_vec, contact_force, scheme->solves, DEM_OF_STEP)                                                   \
    X(double, stiffness, scheme->solves, DEM_OF_STEP)                                                        \
    X(dem_vec, residual, scheme->solves, DEM_OF_STEP)                                                        \
    X(dem_vec, newton_step, scheme->solves, DEM_OF_STEP)                                                     \
    X(dem_vec, further_step, scheme->solves, DEM_OF_STEP)                                                    \
    X(uint32_t, cell, true, DEM_OF_STEP)                                                                     \
    X(uint32_t, moved_to, true, DEM_OF_STEP)                                                                 \
    X(uint32_t, held, true, DEM_OF_STEP)                                                                     \
    X(uint32_t, held_slot, true, DEM_OF_STEP)

enum { DEM_GROUP = 64 };
#define DEM_NOWHERE   UINT32_MAX /* no place: of a grain that left, behind the last of a chain */
#define DEM_SLACK_OUT (-INFINITY)

typedef struct {
    size_t n, capacity; /* present; that the arrays hold */
    size_t n_gone;      /* of the n: grains that left; 0 outside of a run */
    size_t n_fixed;
    uint32_t last_id; /* of the grain that came last */
    double *slack;    /* of each DEM_GROUP grains: while they go less than this, all are within their margins;
                       * DEM_SLACK_OUT: one of them has just left */
#define X(type, name, need, role) type *name;
    DEM_GRAIN_ARRAYS(X)
#undef X
} dem_grains;

/* Arrays that the definition and the integrator of `sim` need for `capacity` grains, `states` alone, or all:
 * 0, but for the n entries that old ones have. Free with dem_grains_free, also after an error, which leaves
 * the capacity as it was. Errors: RP_NO_MEMORY. */
rp_status dem_grains_reserve(const dem_sim *sim, size_t capacity, bool states, dem_grains *grains);
void dem_grains_free(dem_grains *grains);

/* Sort the states: put each grain i of from..end to place to[i] of `sorted`, or nowhere where that is
 * DEM_NOWHERE; then let the n states in `sorted` be those of the grains. */
void dem_grains_put(const dem_grains *grains, const uint32_t *to, dem_grains *sorted, size_t from,
                    size_t end);
void dem_grains_take(dem_grains *grains, dem_grains *sorted, size_t n);

/* Let all entries of grain i be 0. */
void dem_grains_clear(dem_grains *grains, size_t i);

/* Grain `to` becomes grain i. */
void dem_grains_move(dem_grains *grains, size_t i, size_t to);

#endif
