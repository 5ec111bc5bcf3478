/* The state of a simulation. */
#ifndef DEM_SIM_H
#define DEM_SIM_H

#include "dem/grains.h"
#include "dem/kernels.h"
#include "dem/pairs.h"
#include "dem/walls.h"

enum { DEM_HITS = 8 };

struct dem_sim {
    dem_grains grains;
    dem_pairs pairs;
    dem_walls walls;
    dem_kernels kernels;
    long step;
    double mu;           /* of grains: finite stand-in for an infinite one */
    double r_min, r_max; /* of all grains so far */
    bool too_deep;       /* an overlap beyond the smallest radius was seen */
    dem_vec gravity;
    double gravity_norm, turn_cos, turn_sin;

    dem_definition def; /* its `grains` is NULL */

    const struct dem_scheme *scheme; /* the integrator */
    void *work;                      /* its own; NULL where it has none */
    bool ahead;                      /* Verlet: grains are already where the step to come takes them */
    unsigned ahead_left;             /* as of dem_step_lists */

    /* neighbour list */
    struct {
        double skin;       /* twice the largest margin */
        bool even_margins; /* half the skin for all */
        double round_off;  /* of a position, at most */
        struct dem_list_work *work;
    } list;

    /* grains that have collided in the coming step; beyond DEM_HITS it may be any grain */
    struct {
        uint32_t grain[DEM_HITS];
        size_t n;
    } hits;

    struct dem_ledger_state *ledger; /* NULL without */

    /* since the start; see dem_counts */
    struct {
        long rebuilds, collisions;
        double grain_steps, iterations;
    } count;

    /* of the start, for the header's notes */
    struct {
        double radius_mean, mass_mean, speed, dt_limit;
        const char *dt_limit_of;
    } start;

    dem_fault fault;
    dem_phases *times; /* of dem_run_timed, and the clock of its last reading; NULL without */
    double clock;
};

/* Force on a grain, in either of its arrays. */
static inline dem_vec *dem_force(const dem_sim *sim, size_t i)
{
    return sim->grains.force_torque ? &sim->grains.force_torque[i].force : &sim->grains.force[i];
}

static inline dem_vec dem_acceleration(const dem_sim *sim, size_t i)
{
    return *dem_force(sim, i) * sim->grains.inverse_mass[i] + sim->gravity;
}

static inline bool dem_is_fixed(const dem_sim *sim, size_t i)
{
    return sim->grains.inverse_mass[i] == 0.0;
}

/* A grain at x has left; false for NaN. */
static inline bool dem_beyond(const dem_sim *sim, dem_vec x)
{
    x = dem_to_box(&sim->walls, x);
    return (x[0] > sim->def.x_max) | (x[1] < sim->def.y_min);
}

/* Contacts by number: the pairs of the list, then the wall slots. Which grains: the second is DEM_NOBODY at a
 * wall, whose slot is NULL of a pair. */
#define DEM_NOBODY SIZE_MAX
typedef struct {
    size_t i, j;
    dem_wall_slot *slot;
} dem_ends;

static inline size_t dem_contact_numbers(const dem_sim *sim)
{
    return sim->pairs.n + sim->walls.n_slots;
}

static inline dem_ends dem_contact_ends(const dem_sim *sim, size_t k)
{
    if (k < sim->pairs.n) return (dem_ends){sim->pairs.i[k], sim->pairs.j[k], NULL};
    dem_wall_slot *slot = &sim->walls.slot[k - sim->pairs.n];
    return (dem_ends){slot->grain, DEM_NOBODY, slot};
}

/* Put fixed grains back to where they were at the last rebuilding, at rest. */
static inline void dem_hold_fixed(dem_sim *sim)
{
    dem_grains *const g = &sim->grains;
    for (size_t k = 0; k < g->n_fixed; k++)
        g->motion[g->fixed[k]] = (dem_motion){g->listed_x[g->fixed[k]], {0.0, 0.0}};
}

#endif
