/* What is read of a simulation: grains, contacts, walls, energies, rest. In the frame of the laboratory. */
#ifndef DEM_READ_H
#define DEM_READ_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "core/status.h"

RP_C_BEGIN

typedef struct dem_sim dem_sim;

/* Turn a point of the laboratory, the frame of all that is read of a simulation, into the box's frame, in
 * which the walls are where the definition has them. */
void dem_box_frame(const dem_sim *sim, double *x, double *y);

void dem_gravity(const dem_sim *sim, double gravity[2]);

typedef struct {
    uint32_t id;
    double x, y, r, m, vx, vy;
    double fx,
        fy; /* net force, gravity included; on a fixed grain the contacts' force, that its hold carries */
    double angle, omega, torque;
    int contacts;
    bool fixed;
    uint32_t kind; /* number; 0: none */
} dem_state;

/* States of the grains in the order of their ids; `states` holds dem_count() entries.
 * Errors: RP_NO_MEMORY. */
rp_status dem_states(const dem_sim *sim, dem_state *states);

/* XXH3 of x, y, vx, vy, fx, fy of all grains, in the order of their ids: equal for runs with the same bits.
 * Errors: RP_NO_MEMORY. */
rp_status dem_digest(const dem_sim *sim, uint64_t *digest);

typedef enum { DEM_WELL_NONE, DEM_WELL_HOLDS, DEM_WELL_BROKEN } dem_well;
typedef struct dem_contact {
    uint32_t id_a, id_b; /* id_b = 0: a wall, then `wall` is its number */
    int wall;
    double x, y, x_b, y_b; /* centres; for a wall its nearest point */
    /* shear: force on b along the way from a to b turned clockwise; displacement, of the other sign */
    double overlap, normal_force, shear_force, shear_spring;
    double k_s, k_roll;                    /* stiffness of the shear spring, of the rolling one */
    double rolling_torque, rolling_spring; /* torque on grain a, and displacement at the shorter arm */
    dem_well well; /* on the ground: of which shear_force holds the pull, shear_spring the displacement */
} dem_contact;

/* All contacts, walls included; *contacts is a new array (free it). Errors: RP_NO_MEMORY. */
rp_status dem_contacts(const dem_sim *sim, dem_contact **contacts, size_t *n);

/* Number of contacts; *over is how many have a shear force above Coulomb's limit mu max(F_n, 0), as only a
 * dashpot outside the limit makes it. Without such a dashpot both are 0. */
size_t dem_over_friction(const dem_sim *sim, size_t *over);

/* Energies: kinetic of the translation, elastic (normal, shear and rolling springs, wells of the ground),
 * gravity (from the origin; of what can move), kinetic of the rotation. */
typedef struct {
    double kinetic, elastic, gravity, rotational;
} dem_energy;
void dem_energies(const dem_sim *sim, dem_energy *energy);

/* Energy since the start by channels, each with its sign in
 *
 *   energy now = start + (put_in - taken_out + ... + integration) + residual:
 *
 * energy of the grains put in and taken out, with their contacts; work of gravity's change, and of walls that
 * move or vanish; losses to damping, sliding, rolling resistance (dashpot and slider), wells, whose depth
 * follows N, and hard collisions; error of the integrator. Energy that a well or an untruncated spring gives
 * back counts as a negative loss. */
#define DEM_LEDGER_LIST(X)                                                                                   \
    X(put_in, +)                                                                                             \
    X(taken_out, -)                                                                                          \
    X(gravity_turn, +)                                                                                       \
    X(wall_work, +)                                                                                          \
    X(normal_damping, -)                                                                                     \
    X(shear_damping, -) X(sliding, -) X(rolling, -) X(wells, -) X(hard, -) X(integration, +)
typedef struct {
    double start;
#define X(channel, sign) double channel;
    DEM_LEDGER_LIST(X)
#undef X
    double at_walls; /* of normal_damping to wells: at walls */
    double turnover; /* sum of the magnitudes of all changes of kinetic energy and height, and of such work */
    double residual; /* round-off of turnover, if the ledger is right */
} dem_ledger;

/* False without a ledger. */
bool dem_ledger_read(const dem_sim *sim, dem_ledger *ledger);

/* A wall as it is now, in the laboratory frame: the line through `point` with the unit normal `direction`,
 * between two ends along the direction turned clockwise, from the point; an infinite end has none. Nothing of
 * an open wall is left where both ends are equal. All is 0 of a wall that there is not. */
typedef struct {
    double point[2], direction[2], ends[2], force[2];
    double mu;
    double pivot[2], velocity[2], angle; /* the latter: turned by itself since the start, radians */
    bool open;                           /* it has begun to open */
} dem_wall_state;
size_t dem_wall_count(const dem_sim *sim);
dem_wall_state dem_wall_now(const dem_sim *sim, size_t wall);

/* Is a grain, whose centre is at (x, y), in a region? */
typedef bool dem_in_region(const void *region, uint32_t id, double x, double y);

/* How far from rest the grains of a region are, fixed ones left out; in the frame of the box, if that turns.
 * The region is lo < x < hi, or where `in` is true. */
typedef struct {
    size_t n;              /* grains in the region */
    double kinetic_energy; /* mean over them, of translation and rotation */
    double net_force;      /* largest on a grain with a contact, anywhere in the region */
    double free_force;     /* largest on one without: its weight while it flies */
    double contact_number; /* mean contacts a grain, walls counted once */
} dem_rest;
rp_status dem_rest_state(const dem_sim *sim, double lo, double hi, dem_rest *rest); /* RP_NO_MEMORY */
rp_status dem_rest_in(const dem_sim *sim, dem_in_region *in, const void *region,
                      dem_rest *rest); /* RP_NO_MEMORY */

/* At rest: the mean kinetic energy is at most `energy`, and the largest net force on a grain with a contact
 * at most `force`; in a box these are the constants, m g d and m g. Forces count because energies are small
 * at turning points too. Grains are at rest once ten looks in a row say so, 500 steps apart: so a grain that
 * flies is seen to fall. Where that may take longer, `brief`, forces on grains without a contact count as
 * well. */
#define DEM_REST_LOOKS  10
#define DEM_REST_STEPS  500
#define DEM_REST_ENERGY 1e-7
#define DEM_REST_FORCE  1e-2
bool dem_at_rest(const dem_rest *rest, double energy, double force, bool brief);

/* Contacts of a grain now, walls included (0 if it has left); the largest speed of a grain with lo < x < hi.
 * Neither allocates. */
int dem_contact_count(const dem_sim *sim, uint32_t id);
double dem_largest_speed(const dem_sim *sim, double lo, double hi);

RP_C_END

#endif
