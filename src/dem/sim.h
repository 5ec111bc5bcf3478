/* Inside of the simulator: the state, and what its files do for one another. */
#ifndef DEM_SIM_H
#define DEM_SIM_H

#include <math.h>
#include <stdlib.h>

#include "dem/dem.h"
#include "dem/impact.h"

/* Two doubles as one value: + - * act on both. */
typedef double dem_vec __attribute__((vector_size(16)));

typedef struct dem_scheme dem_scheme; /* descriptor of an integrator; integrator.h */

/* What the pair loop reads of a grain, in one 32-byte piece. Verlet's velocity is that of half a step before
 * the positions: v(n - 1/2); observers add half a step's acceleration. Others' is that of the positions. */
typedef struct {
    dem_vec x, v;
} dem_record;

/* Force and torque on a grain that rotates, in one 32-byte piece. */
typedef struct {
    dem_vec force;
    double torque, spare;
} dem_push;

/* Grains near a wall: one slot each, from one rebuilding of the list to the next. `side` is +1 where the
 * grain is on the side of the wall's direction; -1 only behind a wall that it came round the end of. */
typedef struct {
    uint32_t wall, grain;
    double spring, roll, side;
    double rest; /* on the ground: the middle of the well, along the ground, from the wall's point */
    dem_well well;
} dem_wall_slot;

/* What the Gear scheme keeps of a grain besides: its derivatives 2 to 5, x^(k) dt^k/k!, and by how much the
 * way from one force evaluation to the next differs from v dt, which is what the shear springs lack. Between
 * steps `slide` is x less the place of the last force evaluation. */
typedef struct {
    dem_vec q[4], slide;
} dem_gear;

/* What the springs of a contact hold. */
typedef struct {
    double normal, well, shear, rolling;
} dem_elastic;

/* Add the forces of the pairs from..to: the first a multiple of 64, the second too or n_pairs. All, in turn.
 */
typedef void dem_kernel(struct dem_sim *sim, size_t from, size_t to, double h);
/* Add the forces of slots k..end of one wall, a whole line at rest, not the ground. */
typedef void dem_line(struct dem_sim *sim, size_t k, size_t end, double h);
/* What a step leaves to do: rebuild the neighbour list, since a grain has gone farther than its margin or a
 * number is not finite; take out grains that left. */
enum { DEM_LIST_OUT = 1, DEM_GRAIN_OUT = 2 };
enum { DEM_GROUP = 64, DEM_HITS = 8 };
/* Advance as many as it can of the grains from..to by Verlet's step, returns up to where; *left as there.
 * With speed2 not NULL, margins are not looked at, and *speed2, 0 before, becomes the square of the largest
 * speed, INFINITY for NaN. */
typedef size_t dem_advance(struct dem_sim *sim, size_t from, size_t to, unsigned *left, double *speed2);
/* Have as many as it can of the grains from..to left their margins? Returns up to where; raises *margin2 to
 * the largest square of a margin, *beyond to the largest of that of the way less that of the margin. */
typedef size_t dem_stray(const struct dem_sim *sim, size_t from, size_t to, unsigned *left, double *margin2,
                         double *beyond);
/* Append the pairs of grain i with those of grains from..to that are near; reads and writes up to 7 more. */
typedef void dem_near(struct dem_sim *sim, size_t i, size_t from, size_t to);

/* Hard collisions: like foresee_all in impact.c, for as many grains from the first on as it can, returns how
 * many; like next_closing and next_deflected there. */
typedef size_t dem_foresee(struct dem_sim *sim, size_t *beyond);
typedef size_t dem_closing(const struct dem_sim *sim, size_t k, size_t end, bool apart);
typedef size_t dem_deflected(const struct dem_sim *sim, size_t k, size_t end);

/* Where processors have the instructions; the pair loop without Gear's springs; kernels_wide.inl. */
dem_kernel dem_kernel_avx512, dem_kernel_avx2;
dem_line dem_line_avx512, dem_line_avx2;
dem_advance dem_advance_avx512, dem_advance_avx2;
dem_stray dem_stray_avx512, dem_stray_avx2;
dem_near dem_near_avx512, dem_near_avx2;
dem_foresee dem_foresee_avx512, dem_foresee_avx2;
dem_closing dem_closing_avx512, dem_closing_avx2;
dem_deflected dem_deflected_avx512, dem_deflected_avx2;

struct dem_sim {
    dem_definition def;       /* its `grains` is NULL */
    const dem_scheme *scheme; /* the integrator */
    void *work;               /* its own; NULL where it has none */
    bool ahead;               /* grains are already where the step to come takes them */
    unsigned ahead_left;      /* as of dem_step_lists */
    dem_phases *times;        /* of dem_run_timed, and the clock of its last reading; NULL without */
    double clock;
    long step;
    dem_fault fault;
    char kernel_name[40];
    dem_kernel *kernel;
    dem_line *line;           /* NULL for none */
    dem_advance *advance;     /* the same */
    dem_stray *stray;         /* the same */
    dem_near *near;           /* NULL for that of neighbours.c */
    dem_foresee *foresee;     /* NULL for none */
    dem_closing *closing;     /* NULL for that of impact.c */
    dem_deflected *deflected; /* NULL for that of impact.c */
    dem_vec gravity;
    double gravity_norm, turn_cos, turn_sin;
    /* walls that turn: the turn of a step and in all (cosine, sine); what a point of theirs moved in the last
     * step, over dt, along and across its place; angles turned in all, since the last rebuilding, and until
     * the next; the walls' places */
    dem_vec box_step, box, box_swing;
    double box_angle, box_swept, box_room;
    long box_from_step;
    struct {
        dem_vec point, direction;
    } wall[DEM_MAX_WALLS];
    double mu; /* finite stand-in for an infinite one */
    double wall_mu[DEM_MAX_WALLS];
    double r_min, r_max, skin;
    double radius_mean, mass_mean, start_speed, dt_limit; /* for the header's notes */
    const char *dt_limit_of;
    bool rolling; /* some contact resists rolling */
    bool alarm;   /* an overlap beyond the smallest radius was seen */

    /* grains, in the order of their cells; `ref` holds the positions at the last rebuilding or renewal */
    size_t n, room;   /* present; that the arrays hold */
    uint32_t last_id; /* of the grain that came last */
    dem_record *grain;
    dem_vec *force; /* contact forces, without gravity; NULL with rotation */
    dem_vec *ref;
    dem_gear *gear;                       /* NULL for other integrators */
    double *radius, *mass, *inverse_mass; /* 1/mass is 0 where a grain is fixed */
    double *margin2, *reach;              /* of the neighbour list: the margin's square; radius and margin */
    bool even_margins;                    /* half the skin for all */
    double *slack; /* of each DEM_GROUP grains: while they go less than this, all are within their margins */
    double round_off; /* of a place, at most */
    uint32_t *id;
    /* what rotates, NULL where nothing does; spins are of half a step before, as velocities are */
    double *angle, *omega, *inverse_inertia;
    dem_push *push; /* in place of `force`, with torques; NULL without rotation */
    size_t n_fixed;
    uint32_t *fixed; /* their places */

    /* pairs closer than touching and margins; `touching` has a bit for each, lowest of a word first;
     * `spring` and `roll` are 0 while they do not touch. Up to the next multiple of 8 follow pairs of grain 0
     * with itself that never touch. */
    size_t n_pairs, pair_room;
    uint32_t *pair_i, *pair_j;
    uint64_t *touching;
    double *pair_radii, *pair_mass, *spring;
    double *radius_i, *radius_j, *roll_radius; /* r_i, r_j, r_i r_j/(r_i + r_j); NULL without rotation */
    double *roll;                              /* rolling displacements; NULL without rolling resistance */

    /* where there are more pairs than a chunk, a multiple of 64, chunks of them: after chunk c, no pair is of
     * a grain below done[c]; n_chunks 0 where that is not known */
    size_t chunk, n_chunks, chunk_room;
    uint32_t *done;

    /* hard collisions: what the coming step makes of the grains; NULL without. `hit` are those that have
     * collided in it, up to DEM_HITS, beyond which it may have been any */
    dem_record *next;
    double *next_angle, *next_omega;
    uint32_t hit[DEM_HITS];
    size_t n_hit;

    /* slots in the order of walls: the first of each, and the first that a step has still to do */
    size_t n_wall_slots, wall_room, wall_start[DEM_MAX_WALLS + 1], wall_next[DEM_MAX_WALLS];
    dem_wall_slot *wall_slot;
    dem_vec wall_force[DEM_MAX_WALLS];

    struct dem_scratch *scratch; /* of the neighbour list */
    struct dem_book *book;       /* of the energy ledger; NULL without */
    long rebuilds;
    long collisions;
    double grain_steps, iterations;
};

/* Put the bits of pairs k.. into an array that is filled from a multiple of 64 on; `word` is what its word
 * has so far. */
static inline void dem_note(uint64_t *array, size_t k, unsigned bits, uint64_t *word)
{
    *word = (k % 64 ? *word : 0) | (uint64_t)bits << k % 64;
    array[k / 64] = *word;
}

static inline bool dem_touches(const dem_sim *sim, size_t k)
{
    return sim->touching[k / 64] >> k % 64 & 1;
}

static inline size_t dem_count_touching(const dem_sim *sim)
{
    size_t n = 0;
    for (size_t w = 0; 64 * w < sim->n_pairs; w++) n += (size_t)__builtin_popcountll(sim->touching[w]);
    return n;
}

/* For each pair k that touches. `break` does not end it. */
#define DEM_EACH_TOUCHING(sim, k)                                                                            \
    for (size_t word_ = 0, k; 64 * word_ < (sim)->n_pairs; word_++)                                          \
        for (uint64_t bits_ = (sim)->touching[word_];                                                        \
             bits_ && (k = 64 * word_ + (size_t)__builtin_ctzll(bits_), true); bits_ &= bits_ - 1)

/* Where the force on the grain at a place is. */
static inline dem_vec *dem_force(const dem_sim *sim, size_t i)
{
    return sim->push ? &sim->push[i].force : &sim->force[i];
}

static inline double dem_dot(dem_vec a, dem_vec b)
{
    dem_vec p = a * b;
    return p[0] + p[1];
}

/* The normal turned clockwise by 90 degrees: the paper's s. */
static inline dem_vec dem_clockwise(dem_vec n)
{
    return (dem_vec){n[1], -n[0]};
}

/* A new array of n items of this size, all bytes 0; NULL without memory. It begins with a line of the cache,
 * and lies on huge pages if it is large enough: gathers from small ones wait for the page table. */
void *dem_array(size_t n, size_t size);

/* Let the array that `array` points to hold `room` items; false, and as it was, if memory is short. */
static inline bool dem_grow(void *array, size_t size, size_t room)
{
    void *more = realloc(*(void **)array, size * room);
    if (more) *(void **)array = more;
    return more != NULL;
}

/* Choose the kernel of the definition; kernels.c. */
void dem_kernel_choose(dem_sim *sim);

/* A point in the box's frame. */
static inline dem_vec dem_to_box(const dem_sim *sim, dem_vec x)
{
    return sim->box[0] * x - sim->box[1] * dem_clockwise(x);
}

/* Velocity of a point at x that turns with the walls. */
static inline dem_vec dem_box_velocity(const dem_sim *sim, dem_vec x)
{
    return sim->box_swing[0] * x + sim->box_swing[1] * dem_clockwise(x);
}

/* A grain at x has left; false for NaN. */
static inline bool dem_beyond(const dem_sim *sim, dem_vec x)
{
    x = dem_to_box(sim, x);
    return (x[0] > sim->def.x_max) | (x[1] < sim->def.y_min);
}

/* Neighbour list: allocate (with `like`, as a copy of its pairs and slots), free; neighbours.c. */
rp_status dem_neighbours_alloc(dem_sim *sim, const dem_sim *like);
void dem_neighbours_free(dem_sim *sim);

/* Let every grain have room for its way to sim->next: where few may not, their part of the list anew, else
 * all of it. Errors: RP_BROKEN, RP_NO_MEMORY. */
rp_status dem_neighbours_renew(dem_sim *sim);

/* Take out the grains that left, with their pairs and wall slots, and keep the list as it is. */
void dem_neighbours_drop(dem_sim *sim);

/* Turn the walls on for a step if they turn now; walls.c. */
void dem_walls_turn(dem_sim *sim);

/* Add the forces of the walls on the grains from..to: on all, in turn, from 0 on; walls.c. */
void dem_walls_apply(dem_sim *sim, size_t from, size_t to, double h);

static inline bool dem_is_ground(const dem_sim *sim, const dem_wall_slot *slot)
{
    return (int)slot->wall + 1 == sim->def.ground.wall;
}

/* Displacement of a grain in its well, and the force along the ground's tangent that this gives; ground.c. */
double dem_ground_displacement(const dem_sim *sim, const dem_wall_slot *slot);
double dem_ground_force(const dem_sim *sim, const dem_wall_slot *slot, double normal_force);

/* Set or break the well of a contact under forces of the contact `f` and of the pairs, and give the well's
 * force. */
dem_vec dem_ground_hold(const dem_sim *sim, dem_wall_slot *slot, double normal_force, dem_vec f,
                        dem_vec ground_velocity);

/* Hard collisions of the coming step of Verlet, before it; then that step; impact.c.
 * Errors: RP_BROKEN, RP_NO_MEMORY. */
rp_status dem_impacts_apply(dem_sim *sim);
unsigned dem_impacts_integrate(dem_sim *sim);

/* Energies of the grain at a place, as an observer sees them; of its rotation in a frame that spins itself.
 * Of a pair, and of a wall slot, all 0 where it does not touch; observe.c. */
double dem_kinetic_energy(const dem_sim *sim, size_t i);
double dem_rotational_energy(const dem_sim *sim, size_t i, double frame);
dem_elastic dem_pair_elastic(const dem_sim *sim, size_t k);
dem_elastic dem_slot_elastic(const dem_sim *sim, size_t k);

/* The energy ledger, where a simulation has its book; ledger.c. Note the contacts' forces once they have
 * moved all springs by h; of the implicit integrator, before the grains go, those of the step, and their sum
 * on each grain; then, as they are at the start, or close the books of a step once all is in its place. */
rp_status dem_ledger_alloc(dem_sim *sim);
rp_status dem_ledger_clone(dem_sim *copy, const dem_sim *sim);
void dem_ledger_free(dem_sim *sim);
rp_status dem_ledger_forces(dem_sim *sim, double h);
rp_status dem_ledger_between(dem_sim *sim, const dem_vec *force);
void dem_ledger_start(dem_sim *sim);
void dem_ledger_step(dem_sim *sim);

/* Gravity has changed; a hard collision of two grains, or of one with what cannot move, whose place is then
 * not looked at; a grain is about to be put in. */
void dem_ledger_gravity(dem_sim *sim);
void dem_ledger_collision(dem_sim *sim, const size_t grain[2], const dem_body before[2],
                          const dem_body after[2]);
rp_status dem_ledger_add(dem_sim *sim, const dem_grain *grain);

/* A wall is a whole line at rest: nothing of it is open, and it does not turn in this step. */
static inline bool dem_wall_rests(const dem_sim *sim, size_t k)
{
    const dem_wall *w = &sim->def.walls[k];
    return isinf(w->extent[0]) && isinf(w->extent[1]) && sim->box_swing[1] == 0.0 &&
           !(w->open_at_step >= 0 && sim->step >= w->open_at_step);
}

/* Geometry of a wall contact at the present step: unit vector from the wall's nearest point to the grain,
 * overlap; brings slot->side up to date. False where the wall is open. */
bool dem_wall_touch(const dem_sim *sim, dem_wall_slot *slot, dem_vec *normal, double *overlap,
                    dem_vec *velocity);

/* Record a fault with step and grain; returns RP_BROKEN. */
rp_status dem_stop(dem_sim *sim, dem_fault fault, size_t grain, const char *format, ...)
    __attribute__((format(printf, 4, 5)));

#endif
