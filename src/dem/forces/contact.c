/* Geometry of a contact, and its forces by the laws. */
#include <math.h>

#include "dem/forces/forces.h"
#include "dem/law/law.h"

static dem_relative pair_relative(const dem_sim *sim, size_t k, bool swap)
{
    const dem_grains *g = &sim->grains;
    const size_t i = swap ? sim->pairs.j[k] : sim->pairs.i[k], j = swap ? sim->pairs.i[k] : sim->pairs.j[k];
    const dem_vec d = g->motion[i].x - g->motion[j].x, v = g->motion[i].v - g->motion[j].v;
    const double distance = sqrt(dem_dot(d, d)), roll = sim->pairs.rolling ? sim->pairs.roll[k] : 0.0;
    dem_relative r = {.a = i,
                      .b = j,
                      .c = dem_pair_material(&sim->def, dem_kind_of(sim, i), dem_kind_of(sim, j)),
                      .m_eff = sim->pairs.m_eff[k],
                      /* Gear corrects positions after touch is found: slightly below 0 is possible */
                      .overlap = fmax(sim->pairs.radii[k] - distance, 0.0),
                      .n = d * (1.0 / distance),
                      .point = g->motion[j].x,
                      .spring = sim->pairs.spring[k],
                      .roll = swap ? -roll : roll};
    r.s = dem_clockwise(r.n);
    r.v_n = dem_dot(v, r.n);
    r.v_s = dem_dot(v, r.s);
    r.r_eff = g->radius[i] * g->radius[j] / sim->pairs.radii[k];
    if (!g->omega) return r;
    r.arm_a = g->radius[i] - 0.5 * r.overlap;
    r.arm_b = g->radius[j] - 0.5 * r.overlap;
    r.v_s += r.arm_a * g->omega[i] + r.arm_b * g->omega[j];
    r.v_roll = r.r_eff * (g->omega[i] - g->omega[j]);
    return r;
}

bool dem_slot_relative(const dem_sim *sim, dem_wall_slot *slot, dem_relative *r)
{
    const dem_grains *g = &sim->grains;
    const size_t i = slot->grain, w = slot->wall;
    *r = (dem_relative){.a = i,
                        .b = DEM_NOBODY,
                        .slot = slot,
                        .c = dem_material_at(&sim->def, w, dem_kind_of(sim, i)),
                        .m_eff = g->mass[i],
                        .spring = slot->spring,
                        .roll = slot->roll};
    dem_touch touch;
    if (!dem_wall_touch(sim, slot, &touch) || touch.overlap <= 0.0) return false;
    if (!dem_wall_is_line(&sim->walls.wall[w]) && dem_wall_yields(sim, slot, &touch)) return false;
    r->n = touch.normal, r->overlap = touch.overlap, r->wall_velocity = touch.velocity;
    const dem_vec v = g->motion[i].v - r->wall_velocity;
    r->s = dem_clockwise(r->n);
    r->v_n = dem_dot(v, r->n);
    r->v_s = dem_dot(v, r->s);
    r->point = g->motion[i].x - (g->radius[i] - r->overlap) * r->n;
    r->r_eff = g->radius[i];
    if (!g->omega) return true;
    r->arm_a = g->radius[i] - r->overlap;
    r->v_s += r->arm_a * g->omega[i];
    r->v_roll = r->r_eff * (g->omega[i] + dem_wall_spin(&sim->walls, w));
    return true;
}

bool dem_contact_relative(const dem_sim *sim, size_t k, bool by_id, dem_relative *r)
{
    const dem_ends ends = dem_contact_ends(sim, k);
    if (ends.slot) {
        dem_wall_slot slot = *ends.slot;
        const bool touches = dem_slot_relative(sim, &slot, r);
        r->slot = ends.slot;
        return touches;
    }
    if (!dem_touches(&sim->pairs, k)) return false;
    *r = pair_relative(sim, k, by_id && sim->grains.id[ends.i] > sim->grains.id[ends.j]);
    return true;
}

dem_contact dem_law_forces(const dem_sim *sim, const dem_relative *r, double h)
{
    const dem_definition *def = &sim->def;
    const double k_n = dem_law_k_n(def->normal, r->c->k_n, r->r_eff);
    dem_slider shear = dem_slider_of(def->slip, def->damping, r->c->k_s, r->c->gamma_s, r->c->mu),
               rolls = dem_rolls_of(def->rolling, def->tangential, dem_arm_of(def, r->c), r->c->k_roll,
                                    r->c->gamma_roll, r->c->mu_roll);
    dem_contact c = {.overlap = r->overlap, .shear_spring = r->spring, .rolling_spring = r->roll};
    c.normal_force =
        dem_law_normal(def->normal, def->tension, k_n, r->c->gamma_n, r->m_eff, r->overlap, r->v_n);
    if (dem_is_of_radius(def->tangential)) { /* a pair has h = 0 here */
        const double before = r->overlap + r->v_n * h;
        shear = dem_law_at_overlap(shear, r->r_eff, r->m_eff, r->overlap, before, &c.shear_spring);
        rolls = dem_law_at_overlap(rolls, r->r_eff, r->m_eff, r->overlap, before, &c.rolling_spring);
    }
    c.k_s = shear.k, c.k_roll = rolls.k;
    c.shear_force =
        dem_law_tangential(def->tangential, shear, r->m_eff, r->v_s, c.normal_force, h, &c.shear_spring);
    if (sim->pairs.rolling)
        c.rolling_torque = r->r_eff * dem_law_rolling(def->rolling, rolls, r->m_eff, r->v_roll,
                                                      c.normal_force, h, &c.rolling_spring);
    return c;
}
