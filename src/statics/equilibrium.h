/* Static equilibrium of a pile of soft frictionless disks on a flat base, solved rather than simulated.
 * K. Liffman, D. Y. C. Chan and B. D. Hughes, Powder Technology 72 (1992) 255.
 *
 * At rest the slip and rolling forces (27), (29) vanish with the velocities. What is left is the spring
 * K_s (sigma - r) between disks that overlap, (25); the same spring under each disk that presses on the
 * ground y = 0; and the well of static friction, (30), that holds a disk of the base near its place x_0.
 * Forces are those of the deformed pile: no small-angle approximation, but for eps = 0.
 *
 * Units: lengths in sigma, forces in m g. eps = m g/(K_s sigma) is the depth, in sigma, to which one disk
 * sinks into the ground, (45). Displacements are in eps sigma, so that hard and soft piles alike are of
 * order 1, and the limit eps -> 0 is the linearised problem, solved as eps = 0. */
#ifndef STATICS_EQUILIBRIUM_H
#define STATICS_EQUILIBRIUM_H

#include <stdbool.h>
#include <stddef.h>

#include "core/status.h"

RP_C_BEGIN

typedef struct {
    double x, y, r; /* sigma; on the ground where y = r */
    double weight;  /* m g */
} statics_disk;

/* The well under a disk that stands on the ground at the start: a spring of constant stiffness that holds for
 * ever; or (30), of stiffness mu N/a, that breaks where |x - x_0| > a and so carries up to mu N. */
enum { STATICS_WELL_SPRING, STATICS_WELL_FRICTION };

/* Of several equilibria: the primary one, which grows from no load, stable or not; or a minimum of the energy
 * near it. The minimum is reached downhill from the linearised state, or with def.leave > 0 from the primary
 * state along a mixture of its unstable directions, drawn with that number. The primary branch is followed by
 * raising eps, in proportion to the weight. Where it ends, as contacts close or open, the pile jumps downhill
 * to a minimum, and result.jumps is 1. One load step may also reach another branch unnoticed: 6 in 1000 of
 * random piles of up to 55 disks, 1 in 1000 with equal disks. */
enum { STATICS_BRANCH_PRIMARY, STATICS_BRANCH_MINIMUM };

enum { STATICS_MAX = 20000000 }; /* disks */

struct statics_result;
typedef struct {
    size_t n;
    const statics_disk *disks; /* borrowed until statics_create returns */
    double eps;                /* 0: linearised */
    int well;
    double k_x;      /* STATICS_WELL_SPRING: stiffness, K_s */
    double mu, a;    /* STATICS_WELL_FRICTION: coefficient; half-width, eps sigma */
    bool set_again;  /* a broken well is set anew where its disk then is; else it stays broken */
    double set_load; /* x_0 is the disk's place under this part of the load; 0: its place at the start */
    int branch;
    unsigned long leave; /* below 2^32 */
    long load_steps;     /* in which the load is raised; halved where a step fails */
    /* Called before each step with what is known then, also of smaller piles that are solved on the way. */
    void (*watch)(size_t n, const struct statics_result *so_far, void *context);
    void *context;
} statics_definition;

/* eps = 1e-4, spring wells of k_x = 1 set at the start, primary branch in one step; no disks. (mu = 1,
 * a = 1 should the wells be of friction.) */
statics_definition statics_definition_default(void);

/* Faults: neighbours slid apart after wells broke; neighbours slid apart although no well broke (a toppling
 * pile, too soft disks or springs); wells are set anew without end; disks overlap that were no neighbours;
 * Newton's method did not converge; a disk can move freely. */
#define STATICS_LIST(X)                                                                                      \
    X(STATICS_OK, "ok")                                                                                      \
    X(STATICS_SPREADS, "spreads")                                                                            \
    X(STATICS_COLLAPSES, "collapses")                                                                        \
    X(STATICS_CREEPS, "creeps")                                                                              \
    X(STATICS_MEETS, "meets")                                                                                \
    X(STATICS_NOT_CONVERGED, "not_converged")                                                                \
    X(STATICS_SINGULAR, "singular")
typedef enum {
#define X(name, text) name,
    STATICS_LIST(X)
#undef X
} statics_fault;
extern const char *const statics_fault_texts[];

/* Negative modes where there is no equilibrium. */
#define STATICS_UNCOUNTED ((size_t)-1)

/* What is known of a pile, solved or not: of the state where a solve was given up. Horizontal contacts are
 * those between disks less than 15 degrees from level at the start. */
typedef struct statics_result {
    statics_fault fault;
    double load;             /* part of eps, and so of the weight, up to which it was followed */
    size_t jumps;            /* 1: the primary branch ended before all of eps */
    double eps;              /* of the state: all of it, or the part at which the solve was given up */
    double residual;         /* largest net force on a disk, m g */
    double energy, released; /* m g eps sigma, 0 before any load; that of the primary state less it, or NAN */
    size_t negative_modes;   /* of the stiffness: 0 is a stable state; STATICS_UNCOUNTED with a fault */
    double smallest_pivot;  /* of its factorisation, K_s: near 0, the pile can move freely; NAN: none known */
    size_t pivot_disk;      /* disk of that pivot, n without */
    size_t contacts;        /* between disks */
    size_t horizontal;      /* of those */
    size_t wells, broken;   /* wells at the start; now broken, or set anew at least once */
    size_t first_broken;    /* disk whose well broke first; n if none */
    size_t steps, factored; /* Newton steps; factorisations */
} statics_result;

typedef struct statics_pile statics_pile;

/* Check the definition, find who may touch whom, and analyse the stiffness; free with statics_free. Disks
 * may touch within 1e-9 sigma, have gaps or overlap; those nearer than 1.25 times touching count as
 * neighbours. Errors: RP_BAD_INPUT (a value; disks below the ground or on one another; a disk that its
 * neighbours and the ground can't carry; with eps = 0 disks that overlap), RP_NO_MEMORY. */
rp_status statics_create(const statics_definition *def, statics_pile **pile);
void statics_free(statics_pile *pile);

/* Find the equilibrium. Errors: RP_NO_RESULT with result->fault and what is known, in the message too, which
 * names the disks and wells; RP_NO_MEMORY. */
rp_status statics_solve(statics_pile *pile, statics_result *result);

/* Displacements in eps sigma: u[2 i], u[2 i + 1] of disk i. */
void statics_displacements(const statics_pile *pile, double *u);

/* The disks with a well, by x: disk[], N of the ground on each, H of each on the ground, positive to the
 * right, in m g. Arrays of result.wells; `disk` may be NULL. */
void statics_base(const statics_pile *pile, size_t *disk, double *N, double *H);

/* `state`: never broken; broken for good; broken and set anew. */
enum { STATICS_WELL_HOLDS, STATICS_WELL_BROKEN, STATICS_WELL_ANEW };
typedef struct {
    size_t disk;
    double x, x_0; /* displacements of the disk and of where the well rests or, broken, gave way; eps sigma */
    double N, H;   /* as of statics_base */
    int state;
} statics_well;

/* The same disks' wells: result.wells of them, also where there is no equilibrium. */
void statics_wells(const statics_pile *pile, statics_well *wells);

/* Contacts between disks. Strongest and weakest: of those of at least one of its disks; equal ones all. */
typedef struct {
    size_t a, b;
    double x, y, x_b, y_b; /* displaced centres, sigma */
    double force;          /* m g */
    bool horizontal, strongest, weakest;
} statics_contact;

/* *contacts is a new array of result.contacts (free it). Errors: RP_NO_MEMORY. */
rp_status statics_contacts(const statics_pile *pile, statics_contact **contacts, size_t *n);

RP_C_END

#endif
