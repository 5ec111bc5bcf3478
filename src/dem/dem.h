/* The DEM simulator: grains in two dimensions with the contact forces of Lee & Herrmann 1993, eqs (1)-(2), or
 * the soft and hard ones of Liffman, Chan & Hughes 1992.
 *
 * Spheres or disks of any radius, that rotate or, as in the paper, do not; walls are lines or segments;
 * gravity or the box may turn. Angles and spins are counter-clockwise.
 * Any consistent units (the scenes of the paper use cgs). Grains have ids from 1 on, in the order of the
 * definition; walls are numbered from 0 on in calls and in a dem_contact, from 1 on in messages, tables and a
 * dem_ground. All functions are deterministic: the same definition gives the same bits. */
#ifndef DEM_H
#define DEM_H

#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "core/snapshot.h"
#include "core/status.h"
#include "dem/law/bodies.h"
#include "dem/law/choices.h"
#include "dem/law/laws.h"
#include "dem/law/parameters.h"
#include "dem/read.h"

RP_C_BEGIN

/* Time integration: id; word in files; manual; descriptor, which a file of its own defines (state/method.h).
 * All that lists integrators is made of this. */
#define DEM_INTEGRATOR_LIST(X)                                                                               \
    X(DEM_VERLET, verlet, "velocity Verlet in its leapfrog form (Swope, Andersen, Berens & Wilson 1982)",    \
      dem_scheme_verlet)                                                                                     \
    X(DEM_GEAR5, gear5,                                                                                      \
      "Gear's predictor-corrector of fifth order (Allen & Tildesley 1987, appendix E), without rotation",    \
      dem_scheme_gear5)                                                                                      \
    X(DEM_IMPLICIT, implicit,                                                                                \
      "implicit midpoint, which conserves energy at any dt (Liffman, Chan & Hughes 1992, eq (24)), "         \
      "without rotation and shear springs; walls are whole lines that stand",                                \
      dem_scheme_implicit)
typedef enum { DEM_INTEGRATOR_LIST(DEM_ID) } dem_integrator;
enum { DEM_INTEGRATORS = DEM_INTEGRATOR_LIST(DEM_ONE) };

/* Instances of the loops, all with the same bits. */
#define DEM_KERNEL_LIST(X)                                                                                   \
    X(DEM_FAST, fast, "the widest that this processor runs")                                                 \
    X(DEM_REFERENCE, reference,                                                                              \
      "by one, with laws known at run time alone: the others are compared with it")                          \
    X(DEM_BASELINE, baseline, "by one, for any processor")                                                   \
    X(DEM_AVX2, avx2, "by four, with AVX2")                                                                  \
    X(DEM_AVX512, avx512, "by eight, with AVX-512")
typedef enum { DEM_KERNEL_LIST(DEM_ID) DEM_KERNELS } dem_kernel_choice;

/* A wall through `point`; `direction` is its unit normal. `extent` holds the ends along the tangent (normal
 * turned clockwise), measured from `point`; -INFINITY, INFINITY for a whole line, whose normal points into
 * the grains. A segment has grains on both sides. From step `open_at_step` on (-1: never) the wall is gone,
 * or with a finite `open_speed` its lower end extent[0] moves along the tangent at that speed, as a wall that
 * is lifted.
 *
 * An end acts as a corner. A surface acts the same however it is cut into walls, with springs that go from
 * one to the next: of contacts whose points lie on each other's walls, to a thousandth of the radius, or
 * whose directions agree to 0.05 rad, the deepest acts, with the coefficients of its wall. A whole line acts
 * before a segment on it, which must have the same coefficients.
 *
 * The wall moves as a rigid body from the start on: it turns about `pivot` at the rate `omega`,
 * counter-clockwise, and the pivot moves at `velocity`. */
typedef struct {
    double point[2], direction[2];
    dem_material material;
    double extent[2];
    long open_at_step;
    double open_speed;
    double velocity[2], omega, pivot[2];
} dem_wall;
enum { DEM_FEW_WALLS = 8 };

/* A fixed grain never moves: to the others it is an infinite mass. Fixed grains and walls do not interact. */
typedef struct {
    double x, y, r, m, vx, vy;
    double angle, omega; /* 0 without rotation */
    bool fixed;
    uint32_t kind; /* its number in the definition; 0: none */
} dem_grain;

/* Kinds of grains, by name. Number 0 is that of the grains without a kind, "". */
enum { DEM_NAME_BYTES = 32, DEM_MOST_KINDS = 10000, DEM_MOST_MIXED = 64 }; /* mixed: with `pairs` */
typedef struct {
    char name[DEM_NAME_BYTES];
} dem_kind;

enum { DEM_MOST_GRAINS = 100000000 };

/* Static friction of a ground, a whole line that never opens: Liffman, Chan & Hughes 1992, eqs (30) and (33).
 * A grain that touches it is held in a well: along the ground, through the centre and without a torque, acts
 * -mu_static N (s - s0)/a, none beyond a half-width a: there the well is broken, until the contact ends.
 * `set` says when a grain gets its s0. */
#define DEM_WELL_SETS(X)                                                                                     \
    X(DEM_WELL_TOUCH, touch, "at first touch")                                                               \
    X(DEM_WELL_REST, rest,                                                                                   \
      "once the grain is at rest along the ground: it slows down, and the well is deep enough to hold it, "  \
      "m v_s^2 + I omega^2 <= mu_static F_n a")                                                              \
    X(DEM_WELL_AGAIN, again, "at rest, and again after each break")
typedef enum { DEM_WELL_SETS(DEM_ID) } dem_well_set;
typedef struct {
    long wall; /* its number, from 1; 0: no ground, and nothing else here counts */
    double mu_static, a;
    dem_well_set set;
} dem_ground;

/* Hard collisions of fast bodies; papers/hard.c, law/bodies.h. Grains, or a grain and a wall, that would
 * touch in the coming step collide at touch. If they close no faster than dt times the acceleration that
 * presses them together, eq (22), the step would undo a rebound: they form a soft contact, which lasts until
 * they part. */
typedef struct {
    bool on;
    double restitution, mu; /* of grains and walls alike; 0 <= restitution <= 1, mu may be INFINITY */
} dem_hard;

/* Solver of an implicit step. It ends when no grain's own Newton step exceeds `tolerance` of its radius. */
#define DEM_SOLVERS(X)                                                                                       \
    X(DEM_SOLVER_DIRECT, direct, "Newton's method by sparse factorisation")                                  \
    X(DEM_SOLVER_SOR, sor,                                                                                   \
      "sweeps grain by grain, each by the part `relaxation` of its own Newton step (Liffman, Chan & Hughes " \
      "1992, who take 0.5 to 0.9)")
typedef enum { DEM_SOLVERS(DEM_ID) } dem_solver;
typedef struct {
    dem_solver solver;
    double relaxation; /* (0, 2); of DEM_SOLVER_SOR */
    double tolerance;  /* [1e-15, 1e-3] */
    long max_iterations;
} dem_implicit_solver;

typedef struct {
    double gravity[2];
    double dt;
    double skin; /* of the neighbour list; 0: each grain has its own, by its speed; a start without grains, to
                    which some are added, must give it */
    dem_integrator integrator;
    dem_normal_law normal;
    dem_tangential_law tangential;
    dem_rolling rolling;
    dem_arm rolling_arm;
    dem_slip slip;
    dem_damping damping;
    double restitution_speed; /* at which the restitution of a law without a damping ratio holds; INFINITY:
                                 none */
    bool tension;             /* true: the damped normal force may pull, as (2a) is printed */
    bool rotation;   /* else the grains only translate, and no mu_roll may be above 0; of some methods */
    dem_shape shape; /* gives the moments of inertia */
    dem_material material;
    dem_ground ground;            /* not with a tangential law that has a spring */
    dem_hard hard;                /* of some methods; without tension */
    dem_implicit_solver implicit; /* DEM_IMPLICIT needs whole lines at rest as walls; no rotation;
                                     no tangential law that has a spring */
    double x_min, x_max, y_min;   /* in the box's frame: a grain beyond is taken out; infinite for none */
    double turn_per_step; /* gravity turns by this angle a step, radians; positive lowers the side at +x */
    double box_turn_per_step; /* the same for the walls, about the origin; gravity then keeps its direction */
    long turn_from_step;      /* of both */
    dem_kernel_choice kernel;
    rp_units units; /* of all numbers: for messages, tables and what follows from nothing given */
    bool ledger;    /* keep the energy ledger: some twenty times slower, the same bits */
    size_t n_walls;
    dem_wall walls[DEM_FEW_WALLS];
    const dem_wall *wall_list; /* if not NULL, the walls are these, of any number; borrowed as the grains */
    double radius_to_come;     /* mean radius of grains that are added to none; 0: there must be some */
    double mass_to_come; /* their mean mass, for a restitution; of all, if known, for the largest step */
    /* Kinds, with that of number 0, and the coefficients of their contacts: of kinds a and b at
     * [b * n_kinds + a], of kind a at wall w at [(n_kinds + w) * n_kinds + a]. NULL: `material` and the
     * walls' hold for all. Both are borrowed. */
    size_t n_kinds;
    const dem_kind *kinds;
    const dem_material *pairs;
    size_t n_grains;
    const dem_grain *grains; /* borrowed until dem_create returns */
    /* Contacts that the start already has, as dem_contacts gives them, ids by the order of the grains: their
     * springs, rolling springs and wells continue. Contacts that do not touch are ignored. Borrowed too. */
    size_t n_contacts;
    const struct dem_contact *contacts;
    /* Lines of the grains in a list of a user, borrowed, or NULL. With them, overlaps above a tenth of the
     * smaller radius and above twice that which carries the weight of all grains are refused. */
    const size_t *lines;
} dem_definition;

/* The walls of a definition. */
static inline const dem_wall *dem_walls_of(const dem_definition *def)
{
    return def->wall_list ? def->wall_list : def->walls;
}

/* Coefficients of the contacts of kinds a and b, or of kind a at wall w. */
static inline const dem_material *dem_pair_material(const dem_definition *def, size_t a, size_t b)
{
    return def->pairs ? &def->pairs[b * def->n_kinds + a] : &def->material;
}

static inline const dem_material *dem_material_at(const dem_definition *def, size_t w, size_t a)
{
    return def->pairs ? &def->pairs[(def->n_kinds + w) * def->n_kinds + a] : &dem_walls_of(def)[w].material;
}

/* Does the wall move by itself? */
static inline bool dem_wall_moves(const dem_wall *wall)
{
    return wall->velocity[0] != 0.0 || wall->velocity[1] != 0.0 || wall->omega != 0.0;
}

/* Is it a whole line? */
static inline bool dem_wall_is_line(const dem_wall *wall)
{
    return isinf(wall->extent[0]) && isinf(wall->extent[1]);
}

/* Units of the paper's box scene: g = 981, dt = 5e-5, its coefficients at mu = 0.2; no walls, no grains. */
dem_definition dem_definition_default(void);

/* The parameters of the list in parameters.h: at their defaults; put into a definition, "auto" resolved, all
 * but what a restitution leaves to dem_create. */
dem_physics dem_physics_default(rp_units units);
void dem_physics_apply(const dem_physics *p, dem_definition *def);

/* The coefficients of a wall: those given; for negative ones the grains' times the factor of the list, or
 * where these are "auto" too what follows from the wall's own. */
dem_material dem_wall_material(rp_units units, const dem_material *given, const dem_physics *grains);
extern const dem_material dem_material_auto; /* all negative */

/* Put the coefficients that are given over others, and for negative ones what follows from the others; one of
 * restitution and gamma_n that is given replaces the other. */
void dem_material_over(const dem_material *given, dem_material *m);
void dem_material_complete(const dem_definition *def, dem_material *m);

/* Refuse parameters that contradict one another: coefficients of the grains or a wall of a definition; those
 * and the integrator; radii to draw from. Errors: RP_BAD_INPUT. */
rp_status dem_material_check(const dem_definition *def, const dem_material *m);
rp_status dem_physics_check(const dem_definition *def);
rp_status dem_radius_check(double mean, double least, double most);

/* Is there a density: one that is given, or a default? That of disks is known in cgs alone, since defaults of
 * other units are converted for spheres. Errors: RP_BAD_INPUT. */
rp_status dem_density_check(dem_shape shape, rp_units units, bool given);

/* Floor, left and right wall of a box 0 < x < W, whole lines that never open: the definition's only walls. */
enum { DEM_BOX_FLOOR, DEM_BOX_LEFT, DEM_BOX_RIGHT, DEM_BOX_N };
void dem_box_walls(dem_definition *def, double W, const dem_material *wall);

/* Why a run stopped. */
#define DEM_FAULT_LIST(X)                                                                                    \
    X(DEM_FAULT_NONE, "ok")                                                                                  \
    X(DEM_FAULT_LEAKED, "leaked")                                                                            \
    X(DEM_FAULT_NON_FINITE, "non_finite")                                                                    \
    X(DEM_FAULT_OVERLAP, "overlap")                                                                          \
    X(DEM_FAULT_TOO_FAST, "too_fast")                                                                        \
    X(DEM_FAULT_NOT_SOLVED, "not_solved")
typedef enum { DEM_FAULT_LIST(DEM_ID) } dem_fault;
const char *dem_fault_text(dem_fault fault);

/* Largest time step that the definition allows, 3.4/(3 gamma + sqrt(9 gamma^2 + 12 omega^2)): 0.85 of the
 * stability limit of a packing's fastest mode; with Verlet and the linear law 0.95 of it. omega^2 and gamma
 * belong to the quickest contact in an impact from the start's height and speed; limits.c derives them. With
 * little normal damping, also that at which impacts of mean grains bring in less than 1 % of what is
 * dissipated, but no less than that at which an impact changes the energy by 1 % at most. A single pair
 * becomes unstable at about twice the limit. Gear has a further limit, see gear.c; the implicit integrator
 * has none, INFINITY. `what` (may be NULL) names what sets the limit, and the contact. dem_create also checks
 * the overlaps of the start. Measured in validation/stability.c. */
typedef char dem_limit_name[80];
double dem_time_step_limit(const dem_definition *def, dem_limit_name what);

/* The error of a time step above that limit, which it prints rounded down: RP_BAD_INPUT. */
rp_status dem_refuse_step(const dem_definition *def, double limit, const char *what);

/* Check the definition and make a simulation at step 0; free with dem_free.
 * Errors: RP_BAD_INPUT (a value, a time step above the limit, grains that overlap by more than the smaller
 * radius or lie behind a wall), RP_NO_MEMORY. */
rp_status dem_create(const dem_definition *def, dem_sim **sim);

/* A copy that continues exactly as the original would. Errors: RP_NO_MEMORY. */
rp_status dem_clone(const dem_sim *sim, dem_sim **copy);
void dem_free(dem_sim *sim);

/* Write the simulation into a snapshot, or make *sim from one: it continues exactly as the original would,
 * whatever its kernel. After a failure of a reading *sim is NULL. Errors, in the snapshot's status:
 * RP_BAD_INPUT (a state that no simulation can have), RP_NO_MEMORY. dem_keep_layout: for the file's head. */
void dem_keep(rp_snapshot *s, dem_sim **sim);
uint64_t dem_keep_layout(void);

/* Go on with the time step, laws, coefficients (also of the walls, by number) and limits x_min, x_max, y_min
 * of another definition: grains, contacts with their springs, walls, gravity, ids, steps and time stay. *sim
 * is a new simulation afterwards. A ledger counts the energy that a spring gains or loses as put in. Errors:
 * as dem_create, and a box that turns; then *sim is as before. */
rp_status dem_change(dem_sim **sim, const dem_definition *laws);

/* The same with fewer grains, and the laws that hold: those of a region are taken out. */
rp_status dem_remove(dem_sim **sim, dem_in_region *in, const void *region);

/* All velocities and spins become 0; springs stay. Errors: RP_NO_MEMORY. */
rp_status dem_halt(dem_sim *sim);

/* Put in one more grain, at rest or not, where it touches nothing; *id (may be NULL) is the next after the
 * last that was given. Forces and springs of the others stay as they are. The neighbour list is rebuilt;
 * capacity doubles when needed. Errors: RP_BAD_INPUT (a value; a fixed grain), RP_NO_ROOM (it touches a grain
 * or a wall), RP_TOO_FAST (a fall from its height onto a wall or on one like itself needs a smaller time
 * step), RP_NO_MEMORY; then nothing has changed. RP_BROKEN from the list. */
rp_status dem_add(dem_sim *sim, const dem_grain *grain, uint32_t *id);

/* Advance by `steps`, in which numbers below 2.2e-308, the smallest normal one, count as 0 on x86. Errors:
 * RP_BROKEN with step and grain in the message (dem_sim_fault says which kind; of the implicit integrator too
 * a step that is not solved, or in which a grain moves by more than skin/2), RP_NO_MEMORY, RP_BAD_INPUT (a
 * box that turns with fixed grains or the implicit integrator). After an error the simulation can only be
 * read and freed. */
rp_status dem_run(dem_sim *sim, long steps);

/* Let runs take so many threads, with the same bits. They serve the Verlet integrator without hard collisions
 * and ledger, from some 40 000 listed pairs on; any other run takes one. A copy has the number of its
 * original, a state from a snapshot has 1. */
void dem_threads(dem_sim *sim, size_t n);
bool dem_threads_serve(const dem_sim *sim); /* as the list is now */

dem_fault dem_sim_fault(const dem_sim *sim);

/* As dem_run, with the same bits; adds the seconds of the neighbour list, the pair loop, the walls' forces
 * and everything else (integration) to `times`. The clock is read four times a step, some 0.1 us. */
typedef struct {
    double integration, lists, contacts, walls;
} dem_phases;
rp_status dem_run_timed(dem_sim *sim, long steps, dem_phases *times);

/* From the next step on: open wall number `wall` at `speed` (INFINITY: at once), also one that has begun to
 * open, from where it is; turn gravity by this angle a step (0 stops it), |angle| <= 1; let gravity be g,
 * from which a turn then continues. Errors: RP_BAD_INPUT (no such wall, the ground, a speed that dem_create
 * would refuse, an angle, g); then nothing has changed. */
rp_status dem_wall_open(dem_sim *sim, size_t wall, double speed);

/* From the next step on, wall number `wall` moves so from where it is, about its pivot, which has moved
 * along; NULL and NAN: as before. Errors: RP_BAD_INPUT (no such wall, a motion that dem_create would refuse);
 * then nothing has changed. */
rp_status dem_wall_move(dem_sim *sim, size_t wall, const double velocity[2], double omega);
rp_status dem_gravity_turn(dem_sim *sim, double radians_per_step);
rp_status dem_gravity_set(dem_sim *sim, const double g[2]);

/* From the next step on, turn the walls rigidly about the origin by this angle a step, |angle| <= 1, else
 * RP_BAD_INPUT; positive lowers the side at +x, 0 stops them. A wall's velocity at a contact is the
 * displacement of its point in the step over dt. With fixed grains dem_run refuses. */
rp_status dem_box_turn(dem_sim *sim, double radians_per_step);

/* Rebuild the neighbour list now: changes the trajectory by round-off at most. */
rp_status dem_neighbours_rebuild(dem_sim *sim);

rp_units dem_units(const dem_sim *sim);
long dem_step(const dem_sim *sim);
double dem_time(const dem_sim *sim);
size_t dem_count(const dem_sim *sim); /* grains still there */
const char *dem_kernel_name(const dem_sim *sim);

/* How many kinds, with number 0; 0 or 1: the grains have none. The name of one that there is. */
size_t dem_kind_count(const dem_sim *sim);
const char *dem_kind_name(const dem_sim *sim, size_t kind);

/* Whether this processor can run it. */
bool dem_kernel_runs(dem_kernel_choice kernel);

/* How much work the run was. */
typedef struct {
    size_t pairs, contacts, wall_slots; /* now */
    long rebuilds, collisions;          /* since the start: of whole lists; hard ones */
    double grain_steps;                 /* sum over steps of the grains present */
    double iterations;                  /* of the implicit integrator: factorisations, or sweeps */
} dem_counts;
void dem_count_work(const dem_sim *sim, dem_counts *counts);

RP_C_END

#endif
