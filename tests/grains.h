/* Small scenes shared by several test files, and comparison of their simulations. */
#ifndef GRAINS_H
#define GRAINS_H

#include "dem/dem.h"
#include "dem/scene/scene.h"
#include "tests/check.h"

/* A whole line through (x, y), normal (nx, ny). */
dem_wall grains_line(double x, double y, double nx, double ny, const dem_material *c);

/* The grains without walls, by the defaults; the same without gravity. */
dem_definition grains_of(size_t n, const dem_grain *grains);
dem_definition grains_afloat(size_t n, const dem_grain *grains);

/* Without gravity and tangential forces, and of a material what is named. */
dem_definition grains_bare(size_t n, const dem_grain *grains, dem_normal_law law, dem_material material);

/* The grains, and as the only wall a floor of the definition's material through the origin. */
void grains_on_floor(dem_definition *def, size_t n, const dem_grain *grains);

/* The grains above a floor of the default material, by the defaults. */
dem_definition grains_floored(size_t n, const dem_grain *grains);

/* Disks on springs k without dissipation, for the implicit integrator; lengths in diameters, unit gravity. */
dem_definition grains_disks(size_t n, const dem_grain *grains, double k);

/* Unequal disks, three a row, that move in a box of width 3.6. */
void grains_gas(size_t n, dem_grain *grains);

/* N grains, of stream `run`, loosely filled into a box of width W with floor, left and right wall. They last
 * as long as the test; *grains (may be NULL) to change them. */
dem_definition grains_box(long N, double W, long run, dem_grain **grains);

/* Such a box of width 4 that is opened on the right after 2 `part` steps and below after 3: an avalanche,
 * fixed grains in between, cells that wrap around, grains that leave. */
dem_definition grains_outflow(long N, long part, bool rotation);

/* A box whose grains, or whose floor, are so soft that the overlap breaks the run. */
dem_definition grains_too_soft(bool floor);

/* Both runs end broken: at the same step, by the same fault, with the same message. */
void grains_break_alike(dem_sim *a, dem_sim *b);

/* Set the normal law, with the same stiffness (dyn/cm) and damping rate (1/s) for every law at an overlap of
 * 0.01 cm of two grains of 0.004 g. */
void grains_law(dem_definition *def, dem_normal_law law, double stiffness, double rate);

/* The simulation of a valid definition; that after some steps; one whose steps take chunks of so many pairs,
 * as those of a large pile do (0: as they are), with its list built anew; the state of the only grain. A
 * scoped_sim is freed at the end of its scope. */
#define scoped_sim __attribute__((cleanup(grains_end))) dem_sim
void grains_end(dem_sim **sim);
dem_sim *grains_start(const dem_definition *def);
dem_sim *grains_after(const dem_definition *def, long steps);
void grains_again(dem_sim **sim, const dem_definition *def, long steps); /* in place of another */
dem_sim *grains_start_in_chunks(const dem_definition *def, size_t chunk);
dem_state grains_state_of_one(const dem_sim *sim);

/* That of the scene of a text, as of printf, after some steps. */
#define grains_after_text(steps, ...) grains_of_text(steps, check_text(__VA_ARGS__))
dem_sim *grains_of_text(long steps, const char *text);

/* The simulation that the bytes of another's snapshot make. */
dem_sim *grains_kept(dem_sim *sim);

/* For each kernel of the machine from the first of these on. */
#define GRAINS_EACH_KERNEL(kernel, first)                                                                    \
    for (int kernel = first; kernel < DEM_KERNELS; kernel++)                                                 \
        if (dem_kernel_runs(kernel))

/* Run without an error, and give the states then; those now, to be freed. */
void grains_run(dem_sim *sim, long steps, dem_state *states);
dem_state *grains_states(const dem_sim *sim);

/* The work done; the ledger, which it has; the contacts, to be freed. */
dem_counts grains_counts(const dem_sim *sim);
dem_ledger grains_ledger(const dem_sim *sim);
dem_contact *grains_contacts(const dem_sim *sim, size_t *n);

/* The contact, if any; the force on each wall; the energies, and their sum. */
dem_contact grains_only_contact(const dem_sim *sim);
void grains_wall_forces(const dem_sim *sim, double *forces);
dem_energy grains_energies(const dem_sim *sim);
double grains_energy(const dem_sim *sim);

/* dem_scene_read of a text; a scoped_scene is freed at the end of its scope. */
#define scoped_scene __attribute__((cleanup(dem_scene_free))) dem_scene
rp_status grains_read(const char *text, const rp_texts *changes, dem_scene *scene);

/* The simulation of a text after some steps. */
dem_sim *grains_scene_after(const char *text, long steps, dem_scene *scene);
#define grains_read_as(scene, ...) grains_read(check_text(__VA_ARGS__), NULL, scene)

/* A text that is refused with this message. */
void grains_refused(const char *text, const rp_texts *changes, const char *message);

/* Pairs that are not listed once although they lie within their cutoffs where the list was made, or that are
 * listed and do not; found among all pairs. Pairs of two fixed grains belong to no list. */
size_t grains_wrong_pairs(const dem_sim *sim);

/* True if all states are equal to the bit. */
bool grains_same_bits(const dem_sim *a, const dem_sim *b);

#endif
