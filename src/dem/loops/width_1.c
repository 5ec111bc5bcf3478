/* One pair or grain at a time, for any processor. */
#include "dem/forces/forces.h"

#define WIDTH 1
#include "dem/loops/loops.inl"

const dem_loops dem_loops_1 =
    LOOPS("baseline", false, pairs, line, mixed_pairs, mixed_line, next_approaching, next_collided);

/* ---- The reference: all that is known at run time alone, without a short cut ---- */

/* Displacements in excess of v dt count. */
static void any_pairs(dem_sim *sim, size_t from, size_t to, double h)
{
    const dem_material *const kinds = sim->def.pairs;
    const dem_laws law = laws_of(sim, dem_pair_material(&sim->def, 0, 0));
    pair_loop(sim, from, to, h,
              (features){law, sim->def.rotation, sim->pairs.rolling,
                         sim->grains.excess && dem_has_spring(law.tangential), kinds,
                         dem_arm_of(&sim->def, kinds)});
}

/* Pairs that touch are looked at too. */
static size_t any_approaching(const dem_sim *sim, size_t k, size_t end)
{
    while (k < end && !may_touch(sim, sim->pairs.i + k, sim->pairs.j + k, sim->pairs.radii[k])) k++;
    return k;
}

static size_t any_collided(const dem_sim *sim, size_t k, size_t end)
{
    return next_of(sim, 0, k, end);
}

const dem_loops dem_loops_reference = LOOPS("reference", true, any_pairs, dem_slots_apply, any_pairs,
                                            dem_slots_apply, any_approaching, any_collided);
