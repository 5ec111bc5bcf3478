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
#ifndef DEM_EQUILIBRIUM_H
#define DEM_EQUILIBRIUM_H

#include <stdbool.h>
#include <stddef.h>

#include "core/status.h"

typedef struct {
    double x, y, r; /* sigma; on the ground where y = r */
    double weight;  /* m g */
} dem_pile_disk;

/* The well under a disk that stands on the ground at the start: a spring of constant stiffness that holds for
 * ever; or (30), of stiffness mu N/a, that breaks where |x - x_0| > a and so carries up to mu N. */
enum { DEM_WELL_SPRING, DEM_WELL_FRICTION };

/* Which equilibrium, where there are several: the one that grows from no load, stable or not; or a minimum of
 * the energy near it, found by going downhill: from the linearised state; or, where def.leave is not 0, from
 * the primary state along a mixture, drawn with that number, of the directions in which it is not stable. The
 * primary branch is followed from the linearised problem by raising eps, which is in proportion to the
 * weight; where it ends, as contacts close or open, the pile jumps: it goes downhill from there on, to a
 * minimum, and result.jumps is 1. A step of the load may also come to a state of another branch unnoticed: of
 * 12 000 random piles of up to 55 disks, eps from 1e-7 to 3e-2, 6 in 1000 did so in one step that did not in
 * 32, of equal disks 1 in 1000. */
enum { DEM_BRANCH_PRIMARY, DEM_BRANCH_MINIMUM };

enum { DEM_PILE_MAX = 20000000 }; /* disks */

struct dem_pile_result;
typedef struct {
    size_t n;
    const dem_pile_disk *disks; /* borrowed until dem_pile_create returns */
    double eps;                 /* 0: linearised */
    int well;
    double k_x;      /* DEM_WELL_SPRING: stiffness, K_s */
    double mu, a;    /* DEM_WELL_FRICTION: coefficient; half-width, eps sigma */
    bool set_again;  /* a broken well is set anew where its disk then is; else it stays broken */
    double set_load; /* x_0 is the disk's place under this part of the load; 0: its place at the start */
    int branch;
    unsigned long leave; /* below 2^32 */
    long load_steps;     /* in which the load is raised; halved where a step fails */
    /* Called before each step with what is known then, also of smaller piles that are solved on the way. */
    void (*watch)(size_t n, const struct dem_pile_result *so_far, void *context);
    void *context;
} dem_pile_definition;

/* eps = 1e-4, spring wells of k_x = 1 set at the start, primary branch in one step; no disks. (mu = 1,
 * a = 1 should the wells be of friction.) */
dem_pile_definition dem_pile_definition_default(void);

/* Why there is no equilibrium: wells broke and neighbours slid apart; so they did with no well broken, for
 * the pile toppled, or the disks or springs are too soft; wells are set anew without end; disks overlap that
 * were no neighbours; Newton's method gave up; a disk can move freely. */
#define DEM_PILE_LIST(X)                                                                                     \
    X(DEM_PILE_OK, "ok")                                                                                     \
    X(DEM_PILE_SPREADS, "spreads")                                                                           \
    X(DEM_PILE_COLLAPSES, "collapses")                                                                       \
    X(DEM_PILE_CREEPS, "creeps")                                                                             \
    X(DEM_PILE_MEETS, "meets")                                                                               \
    X(DEM_PILE_NOT_CONVERGED, "not_converged")                                                               \
    X(DEM_PILE_SINGULAR, "singular")
typedef enum {
#define X(name, text) name,
    DEM_PILE_LIST(X)
#undef X
} dem_pile_fault;
const char *dem_pile_fault_text(dem_pile_fault fault);

/* Negative modes where there is no equilibrium. */
#define DEM_PILE_UNCOUNTED ((size_t)-1)

/* What is known of a pile, solved or not: of the state where a solve was given up. Horizontal contacts are
 * those between disks less than 15 degrees from level at the start. */
typedef struct dem_pile_result {
    dem_pile_fault fault;
    double load;             /* part of eps, and so of the weight, up to which it was followed */
    size_t jumps;            /* 1: the primary branch ended before all of eps */
    double eps;              /* of the state: all of it, or the part at which the solve was given up */
    double residual;         /* largest net force on a disk, m g */
    double energy, released; /* m g eps sigma, 0 before any load; that of the primary state less it, or NAN */
    size_t negative_modes;   /* of the stiffness: 0 is a stable state; DEM_PILE_UNCOUNTED with a fault */
    double smallest_pivot;  /* of its factorisation, K_s: near 0, the pile can move freely; NAN: none known */
    size_t pivot_disk;      /* disk of that pivot, n without */
    size_t contacts;        /* between disks */
    size_t horizontal;      /* of those */
    size_t wells, broken;   /* wells at the start; now broken, or set anew at least once */
    size_t first_broken;    /* disk whose well broke first; n if none */
    size_t steps, factored; /* Newton steps; factorisations */
} dem_pile_result;

typedef struct dem_pile dem_pile;

/* Check the definition, find who may touch whom, and analyse the stiffness; free with dem_pile_free. Disks
 * may touch within 1e-9 sigma, have gaps or overlap; those nearer than 1.25 times touching count as
 * neighbours. Errors: RP_BAD_INPUT (a value; disks below the ground or on one another; a disk that its
 * neighbours and the ground can't carry; with eps = 0 disks that overlap), RP_NO_MEMORY. */
rp_status dem_pile_create(const dem_pile_definition *def, dem_pile **pile);
void dem_pile_free(dem_pile *pile);

/* Find the equilibrium. Errors: RP_NO_RESULT with result->fault and what is known, in the message too, which
 * names the disks and wells; RP_NO_MEMORY. */
rp_status dem_pile_solve(dem_pile *pile, dem_pile_result *result);

/* Displacements in eps sigma: u[2 i], u[2 i + 1] of disk i. */
void dem_pile_displacements(const dem_pile *pile, double *u);

/* The disks with a well, by x: disk[], N of the ground on each, H of each on the ground, positive to the
 * right, in m g. Arrays of result.wells; `disk` may be NULL. */
void dem_pile_base(const dem_pile *pile, size_t *disk, double *N, double *H);

/* `state`: never broken; broken for good; broken and set anew. */
enum { DEM_PILE_WELL_HOLDS, DEM_PILE_WELL_BROKEN, DEM_PILE_WELL_ANEW };
typedef struct {
    size_t disk;
    double x, x_0; /* displacements of the disk and of where the well rests or, broken, gave way; eps sigma */
    double N, H;   /* as of dem_pile_base */
    int state;
} dem_pile_well;

/* The same disks' wells: result.wells of them, also where there is no equilibrium. */
void dem_pile_wells(const dem_pile *pile, dem_pile_well *wells);

/* Contacts between disks. Strongest and weakest: of those of at least one of its two disks; equal ones all.
 */
typedef struct {
    size_t a, b;
    double x, y, x_b, y_b; /* displaced centres, sigma */
    double force;          /* m g */
    bool horizontal, strongest, weakest;
} dem_pile_contact;

/* *contacts is a new array of result.contacts (free it). Errors: RP_NO_MEMORY. */
rp_status dem_pile_contacts(const dem_pile *pile, dem_pile_contact **contacts, size_t *n);

#endif
