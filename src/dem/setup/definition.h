/* A definition: its checks, and what follows from it. */
#ifndef DEM_DEFINITION_H
#define DEM_DEFINITION_H

#include "dem/dem.h"

/* All of it; all but the grains, and so without the largest time step; a wall by itself; its motion in this
 * scene; the way of its fastest point in a step: as far as a grain may go, see check_grain in list.c; one
 * grain; the integrator alone: can it do all that the definition asks for? Errors: RP_BAD_INPUT. */
rp_status dem_definition_check(const dem_definition *def);
rp_status dem_laws_check(const dem_definition *def);
rp_status dem_wall_check(const dem_wall *wall);
rp_status dem_motion_check(const dem_definition *def, const dem_wall *wall);
rp_status dem_hidden_check(const dem_definition *def, size_t k, const dem_wall *a, size_t j,
                           const dem_wall *b, double r);
rp_status dem_way_check(double way, double r_min);
rp_status dem_grain_check(const dem_definition *def, const dem_grain *grain);
rp_status dem_scheme_check(const dem_definition *def);

/* Put in the gamma_n that a restitution asks for, and what follows from it, in a copy of a definition; its
 * list of walls may then be one of its own, until dem_physics_free, also after an error. Errors:
 * RP_BAD_INPUT, RP_NO_MEMORY. */
rp_status dem_physics_resolve(dem_definition *copy);
void dem_physics_free(dem_definition *copy, const dem_definition *def);

/* Let a definition have kinds and pairs of its own, all 0; or those of another; free them. Errors:
 * RP_NO_MEMORY, after which it may be freed. */
rp_status dem_kinds_alloc(dem_definition *def, bool pairs);
rp_status dem_kinds_copy(const dem_definition *of, dem_definition *def);
void dem_kinds_free(dem_definition *def);

/* Kinds of the grains that there are, and coefficients that do not depend on the order of two. The kinds of
 * entry k of the pairs before an error's message. Errors: RP_BAD_INPUT. */
rp_status dem_kinds_check(const dem_definition *def);
rp_status dem_pair_prefix(const dem_definition *def, size_t k, rp_status status);

/* Entries of the pairs, walls included. */
static inline size_t dem_pair_count(const dem_definition *def)
{
    return def->n_kinds * (def->n_kinds + def->n_walls);
}

/* Largest speed of a wall's points, of a line of those beside the grains of the start; by its own motion, or
 * as the box turns. */
double dem_wall_speed(const dem_definition *def, const dem_wall *wall);

/* Speed of an impact to come: the largest closing speed at the start and a fall from the highest grain to
 * the lowest grain or wall. A grain may take the speed of a wall, and the height that a segment reaches. */
double dem_impact_speed(const dem_definition *def);

/* Contacts that the start has may be stiffer than any impact to come. Errors: RP_BAD_INPUT. */
rp_status dem_check_start_overlaps(const dem_sim *sim);

/* Listed grains that overlap too far, see dem_definition. Errors: RP_BAD_INPUT. */
rp_status dem_check_listed(const dem_sim *sim, const size_t lines[]);

/* The box turns, but some grains are fixed: RP_BAD_INPUT. */
rp_status dem_refuse_turn(void);

/* Does each physical parameter that is a word or a truth have one of its values? */
bool dem_words_known(const dem_definition *def);

/* Restitution and damping of a contact, of which one is given. Errors: RP_BAD_INPUT. */
rp_status dem_restitution_check(const dem_definition *def, const dem_material *m);

/* Is gamma_n a rate? Does any contact resist rolling? */
bool dem_damps_by_rate(const dem_definition *def);
bool dem_has_rolling(const dem_definition *def);

#endif
