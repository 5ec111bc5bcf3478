/* The state of a simulation. */
#ifndef DEM_STATE_H
#define DEM_STATE_H

#include "dem/state/grains.h"
#include "dem/state/method.h"
#include "dem/state/loops.h"
#include "dem/state/pairs.h"
#include "dem/state/slots.h"

/* Of what a loop calls for each pair or grain: a call that the compiler left would cost a tenth of the time.
 */
#define INLINE static inline __attribute__((always_inline))

struct dem_sim {
    dem_grains grains;
    dem_pairs pairs;
    dem_walls walls;
    dem_loops loops;
    long step, step0; /* step0, time0: where dt has last changed */
    double time0;
    double r_min, r_max; /* of all grains so far */
    bool too_deep;       /* an overlap beyond the smallest radius was seen */
    dem_vec gravity;
    double gravity_norm, turn_cos, turn_sin;

    dem_definition def; /* its `grains` is NULL */

    const dem_scheme *scheme;   /* the integrator */
    const dem_collisions *hard; /* NULL without */
    void *work;                 /* its own; NULL where it has none */
    bool ahead;                 /* Verlet: grains are already where the step to come takes them */
    unsigned ahead_left;        /* as of dem_step_lists */
    size_t threads;             /* to run with; 0: one */
    struct dem_team *team;      /* NULL without threads */

    /* neighbour list */
    struct {
        double skin;       /* of the scene, or 0.4 mean radii */
        bool even_margins; /* half the skin for all; else at most a mean radius, with hard collisions 1.5 */
        double round_off;  /* of a position, at most */
        double fastest;    /* speed, and square of a distance from the origin, that a rebuilding finds */
        double far2;
        double most_tests; /* a grain; where the plain search would need more, grains are searched by size */
        struct dem_list_work *work;
        struct dem_sizes *sizes; /* work space of that; NULL before */
    } list;

    /* in the coming step: how many grains have collided; the first ones, the last of them to the end */
    struct {
        size_t n;
        uint32_t few[DEM_FEW];
    } collided;

    struct dem_ledger_state *ledger; /* NULL without */

    /* since the start; see dem_counts */
    struct {
        long rebuilds, collisions;
        double grain_steps, iterations;
    } count;

    /* of the start, for the header's notes */
    struct {
        double radius_mean, mass_mean, speed, dt_limit;
        dem_limit_name dt_limit_of;
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

/* That array, and the size of an item. */
typedef struct {
    char *at;
    size_t size;
} dem_forces;
static inline dem_forces dem_forces_of(const dem_grains *g)
{
    return g->force_torque ? (dem_forces){(char *)g->force_torque, sizeof *g->force_torque}
                           : (dem_forces){(char *)g->force, sizeof *g->force};
}

static inline uint32_t dem_kind_of(const dem_sim *sim, size_t i)
{
    return sim->grains.kind ? sim->grains.kind[i] : 0;
}

static inline bool dem_is_fixed(const dem_sim *sim, size_t i)
{
    return sim->grains.inverse_mass[i] == 0.0;
}

/* A grain at x has left; false for NaN. */
static inline bool dem_beyond(const dem_sim *sim, dem_vec x)
{
    x = dem_to_box(&sim->walls, x);
    return (x[0] < sim->def.x_min) | (x[0] > sim->def.x_max) | (x[1] < sim->def.y_min);
}

/* Has grain i at x moved beyond its margin, so that the neighbour list may lack a pair of it? True for NaN.
 */
static inline bool dem_beyond_margin(const dem_sim *sim, size_t i, dem_vec x)
{
    const dem_vec moved = x - sim->grains.listed_x[i];
    return !(dem_dot(moved, moved) <= sim->grains.margin2[i]);
}

/* Has the wall begun to open? */
static inline bool dem_wall_opens(const dem_sim *sim, size_t w)
{
    const long from = sim->walls.wall[w].open_at_step;
    return from >= 0 && sim->step >= from;
}

/* Is nothing left of it, since it has opened at once? */
static inline bool dem_wall_is_gone(const dem_sim *sim, size_t w)
{
    return dem_wall_opens(sim, w) && isinf(sim->walls.wall[w].open_speed);
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

/* Put a fixed grain, or all, back to where they were at the last rebuilding, at rest. */
static inline void dem_hold_grain(dem_sim *sim, size_t i)
{
    sim->grains.motion[i] = (dem_motion){sim->grains.listed_x[i], {0.0, 0.0}};
}

static inline void dem_hold_fixed(dem_sim *sim)
{
    for (size_t k = 0; k < sim->grains.n_fixed; k++) dem_hold_grain(sim, sim->grains.fixed[k]);
}

/* Record a fault with step and grain; returns RP_BROKEN. */
rp_status dem_stop(dem_sim *sim, dem_fault fault, size_t grain, const char *format, ...)
    __attribute__((format(printf, 4, 5)));

/* Arm of the rolling resistance over R_eff, of coefficients c of a pair or of a wall. */
static inline double dem_arm_of(const dem_definition *def, const dem_material *c)
{
    const bool pair = def->pairs ? c < def->pairs + def->n_kinds * def->n_kinds : c == &def->material;
    return def->rolling_arm == DEM_ARM_RADIUS && pair ? 2.0 : 1.0;
}

#endif
