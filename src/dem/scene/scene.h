/* Scenes: a definition as a file, read and written; tables of a simulation's state. */
#ifndef DEM_SCENE_H
#define DEM_SCENE_H

#include <stdio.h>

#include "core/arena.h"
#include "params/params.h"
#include "dem/scene/fill.h"

RP_C_BEGIN

/* Steps from frame to frame of each table; 0: none, -1: the last frame alone. */
typedef struct {
    long states, energy, contacts, walls;
} dem_intervals;

/* Coefficients of a kind, and of two kinds or of a kind and a wall, as given; negative: not. */
typedef struct {
    dem_material material;
    double density, E, nu;
} dem_kind_said;
typedef struct {
    const char *of[2];
    dem_material material;
} dem_pair_said;

/* Of two values that differ. */
#define DEM_PAIR_RULES(X)                                                                                    \
    X(DEM_PAIRS_EQUAL, equal, "equal values hold, others are refused until `pairs` says them")               \
    X(DEM_PAIRS_SMALLER, smaller, "the smaller value, as in PFC")                                            \
    X(DEM_PAIRS_GEOMETRIC, geometric, "the root of their product, as in LAMMPS")
typedef enum { DEM_PAIR_RULES(DEM_ID) } dem_pair_rule;

/* What may change while a scene runs, as a file gives it: "auto" is not resolved, an end that is none is
 * above all numbers. */
typedef struct {
    dem_physics physics;
    double x_min, x_max, y_min;
    size_t n_kinds, n_pairs; /* kinds by their numbers; 0: none has coefficients of its own */
    const dem_kind_said *kinds;
    const dem_pair_said *pairs;
    int pairs_rule;
} dem_scene_laws;

typedef struct {
    dem_definition def; /* its grains are the scene's, or NULL with a fill */
    double E, nu;       /* of the grains, from `material`; 0: not given */
    bool phases;        /* its text has some, which are the experiment's */
    size_t n_fills;
    dem_fill *fills;  /* NULL: none */
    long seed, run;   /* of the fills' random streams, instead of their own */
    void *streams[2]; /* of the first fill, and whether walls cut one, as of a dem_fill */
    bool *cut;
    long steps;
    dem_intervals output;
    dem_grain *grains;
    size_t *lines;   /* of the grains in their list */
    bool compressed; /* they may overlap at the start */
    dem_scene_laws laws;
    dem_material *given;                        /* of the walls, as given */
    double (*bodies)[2];                        /* E and nu of each; negative: not given */
    const char **names;                         /* of the walls, "" of one without; NULL: none has one */
    bool has[DEM_MOST_MIXED];                   /* grains of these kinds, at the start or later */
    bool kinds_listed;                          /* in `kinds`: there are no others */
    double turn_deg, box_turn_deg;              /* a step, of gravity and of the box */
    bool has_density;                           /* given, no default */
    const char *particles_file, *contacts_file; /* "": none; the text's own */
    long particles_step;                        /* -1: the last */
    char unused[256];                           /* columns of particles_file, if there are any */
    rp_arena arena;                             /* of all arrays and texts of the scene and its definition */
} dem_scene;

/* Read a scene file; `changes` are further "key=value" or "group.key=value" settings, numbers, words or
 * booleans, that replace the file's. Free with dem_scene_free, also after an error.
 * Errors: RP_BAD_INPUT with file, line, key, value and allowed range; RP_NO_MEMORY. */
rp_status dem_scene_read(const char *path, const rp_texts *changes, dem_scene *scene);
void dem_scene_free(dem_scene *scene);

/* Does a point lie in a polygon? x and y of each of its n points. */
bool dem_in_polygon(size_t n, const double points[], double x, double y);

/* The grains of the start, a new array: those of the scene's list, then those of its fills one after the
 * other. Errors: as dem_fill_grains. */
rp_status dem_scene_grains(const dem_scene *scene, dem_grain **grains, size_t *n);

/* Id of the first grain at the start with nothing below it along gravity, neither a wall nor a fixed grain,
 * so that it falls farther than the scene is large in its steps (of phases: in any time), and nothing takes
 * it out; 0: none. Errors: RP_NO_MEMORY. */
rp_status dem_first_falling(const dem_scene *scene, const dem_sim *sim, dem_state *grain);

/* Fill if there is something to fill, and make the simulation. Errors: as dem_fill_grains, dem_create. */
rp_status dem_scene_start(const dem_scene *scene, dem_sim **sim);

/* The schemas of a scene file: top level, then groups; ended by a NULL name. The manual says what a group
 * describes, and its source. */
typedef struct {
    const char *name;
    const rp_param *schema;
    const char *manual;
} dem_scene_group;
extern const dem_scene_group dem_scene_schemas[];

/* Tables of a simulation's state, each row of a step, which the caller counts: an experiment's steps rise
 * where its simulation goes back; and at a time t. Of all grains: id x y angle vx vy omega fx fy r m contacts
 * fixed. Energies: grains kinetic elastic gravity kinetic_per_grain rotational (erg; gravity from the origin;
 * kinetic of translation alone, per grain of both); with a ledger all of dem_ledger. Of all contacts: id_a
 * id_b wall x y x_b y_b overlap normal_force shear_force shear_spring rolling_torque rolling_spring. Of all
 * walls, as dem_wall_now has them: wall x y direction_x direction_y from to fx fy. */
typedef enum { DEM_TABLE_STATES, DEM_TABLE_ENERGY, DEM_TABLE_CONTACTS, DEM_TABLE_WALLS } dem_table;
extern const char dem_state_columns[]; /* of the first, ", step, t [s], ..." */
void dem_write_columns(dem_table table, const dem_sim *sim, FILE *out);
rp_status dem_write_rows(dem_table table, const dem_sim *sim, long step, FILE *out); /* RP_NO_MEMORY */

/* Header lines on what the scene's numbers mean: dt against its limit and the contact time, restitution and
 * largest overlap of an impact at the start's fall height, the elastic modulus that k_n stands for. */
void dem_write_notes(const dem_sim *sim, FILE *out);

RP_C_END

#endif
