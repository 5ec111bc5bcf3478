/* Walls as they are now, and the slots of the grains near them. */
#ifndef DEM_SLOTS_H
#define DEM_SLOTS_H

#include <math.h>

#include "dem/dem.h"
#include "dem/state/vec.h"

/* A grain near a wall, from one rebuilding of the list to the next, which keeps all but the two indices.
 * `side` is +1 where the grain is on the side of the wall's direction; -1 only behind a wall whose end it has
 * passed. */
typedef struct {
    uint32_t wall, grain;
    double spring, roll, side;
    double rest; /* on the ground: the middle of the well, along the ground, from the wall's point */
    dem_well well;
    /* the next slot of this grain, after the last one the first; is it the first at a segment of several? */
    uint32_t next : 31, leads : 1;
} dem_wall_slot;

/* Where a wall is now. Its definition says where it was at the step `since`, turned by `angle` then; that is
 * the start, or when its motion last changed. Of one that moves by itself: the displacement of its point at p
 * in the last step over dt is drift + swing[0] (p - pivot) + swing[1] (p - pivot, turned clockwise); turn so
 * far and of a step (cosine, sine, clockwise); distance of its farther end from the pivot, INFINITY of a
 * line. */
typedef struct {
    dem_vec point, direction;
    bool moves, plain; /* plain: a whole line that never opens, nor moves by itself */
    dem_vec drift, pivot, swing, turn, turn_of_step;
    double reach, angle;
    long since;
} dem_wall_line;

/* Arrays with an entry for each wall, and one more: type, name. start, next: the first slot, and the first
 * that a step has still to do; wall: of the definition; force: on the wall; line: where the wall is now. */
#define DEM_WALL_ARRAYS(X)                                                                                   \
    X(dem_wall, wall) X(dem_wall_line, line) X(dem_vec, force) X(size_t, next) X(size_t, start)

typedef struct {
    size_t n_slots, capacity;
    dem_wall_slot *slot; /* in the order of walls */
#define X(type, name) type *name;
    DEM_WALL_ARRAYS(X)
#undef X

    /* walls that move by themselves: how many; the way of the fastest in a step, at most, and what the list
     * reckons with at least, where motions change; margin of the list for such walls */
    size_t n_moving;
    double stride, least_stride, margin;

    /* a box that turns: the turn of a step and in all (cosine, sine), that as an angle; displacement of a
     * point at x in the last step over dt, along x and along x turned clockwise; angles turned since the last
     * rebuilding, and until the next, or, of walls that move by themselves, ways */
    dem_vec turn_of_step, turn, swing;
    double angle, swept, sweep_limit;
    long turn_from_step;
} dem_walls;

/* A point in the frame of the walls. */
static inline dem_vec dem_to_box(const dem_walls *walls, dem_vec x)
{
    return walls->turn[0] * x - walls->turn[1] * dem_clockwise(x);
}

/* Velocity of a point at x that turns with the walls. */
static inline dem_vec dem_box_velocity(const dem_walls *walls, dem_vec x)
{
    return walls->swing[0] * x + walls->swing[1] * dem_clockwise(x);
}

/* Velocity of a wall at its point p, and the clockwise spin, both as displacements of a step over dt. */
static inline dem_vec dem_wall_velocity(const dem_walls *walls, size_t w, dem_vec p)
{
    const dem_wall_line *l = &walls->line[w];
    if (!l->moves) return dem_box_velocity(walls, p);
    return l->drift + l->swing[0] * (p - l->pivot) + l->swing[1] * dem_clockwise(p - l->pivot);
}

static inline double dem_wall_spin(const dem_walls *walls, size_t w)
{
    return walls->line[w].moves ? walls->line[w].swing[1] : walls->swing[1];
}

/* Room for n walls and the n_slots slots. Errors: RP_NO_MEMORY. */
rp_status dem_walls_alloc(dem_walls *walls, size_t n);
void dem_walls_free(dem_walls *walls);

/* Coulomb's coefficient without infinity: 1e300 times no force is none, where infinity would give NaN. */
static inline double dem_finite_mu(double mu)
{
    return fmin(mu, 1e300);
}

static inline void dem_finite_limits(dem_material *m)
{
    m->mu = dem_finite_mu(m->mu), m->mu_roll = dem_finite_mu(m->mu_roll);
}

/* Find the first slot of each of n walls, and chain the slots of each of n_grains, with as many numbers of
 * room. */
void dem_walls_link(dem_walls *walls, size_t n, size_t n_grains, uint32_t *last);

#endif
