/* Readings of a simulation. Nothing here changes the state: the integrator brings velocities to the
 * time of the positions on the way out. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dem/energy.h"
#include "dem/ground.h"
#include "dem/integrator.h"
#include "dem/law.h"
#include "dem/sim.h"

static dem_vec velocity(const dem_sim *sim, size_t i)
{
    return sim->scheme->velocity && !dem_is_fixed(sim, i) ? sim->scheme->velocity(sim, i)
                                                          : sim->grains.motion[i].v;
}

static double omega(const dem_sim *sim, size_t i)
{
    return sim->scheme->spin ? sim->scheme->spin(sim, i) : sim->grains.omega[i];
}

double dem_kinetic_energy(const dem_sim *sim, size_t i)
{
    dem_vec v = velocity(sim, i);
    return 0.5 * sim->grains.mass[i] * dem_dot(v, v);
}

double dem_rotational_energy(const dem_sim *sim, size_t i, double frame)
{
    if (!sim->grains.omega || dem_is_fixed(sim, i)) return 0.0;
    const double spin = omega(sim, i) - frame;
    return 0.5 * dem_inertia(sim->def.shape, sim->grains.mass[i], sim->grains.radius[i]) * spin * spin;
}

static bool wall_contact(const dem_sim *sim, size_t k, dem_vec *normal, double *overlap,
                         dem_vec *wall_velocity)
{
    dem_wall_slot slot = sim->walls.slot[k];
    return dem_wall_touch(sim, &slot, normal, overlap, wall_velocity) && *overlap > 0.0;
}

/* Contacts of each grain, by index. */
static int *count_contacts(const dem_sim *sim)
{
    int *count = calloc(sim->grains.n + 1, sizeof *count);
    if (!count) return NULL;
    DEM_EACH_TOUCHING (&sim->pairs, k) {
        count[sim->pairs.i[k]]++;
        count[sim->pairs.j[k]]++;
    }
    dem_vec n, v;
    double overlap;
    for (size_t k = 0; k < sim->walls.n_slots; k++)
        if (wall_contact(sim, k, &n, &overlap, &v)) count[sim->walls.slot[k].grain]++;
    return count;
}

rp_status dem_states(const dem_sim *sim, dem_state *states)
{
    int *contacts = count_contacts(sim);
    uint32_t *index = calloc((size_t)sim->grains.last_id + 1, sizeof *index); /* of each id, from 1 */
    if (!contacts || !index) {
        free(contacts);
        free(index);
        return rp_fail(RP_NO_MEMORY, "states: out of memory");
    }
    for (size_t i = 0; i < sim->grains.n; i++) index[sim->grains.id[i]] = (uint32_t)i + 1;
    for (size_t id = 1; id <= sim->grains.last_id; id++) {
        if (index[id] == 0) continue;
        const size_t i = index[id] - 1;
        dem_vec x = sim->grains.motion[i].x, v = velocity(sim, i);
        dem_vec f =
            dem_is_fixed(sim, i) ? *dem_force(sim, i) : sim->grains.mass[i] * dem_acceleration(sim, i);
        *states++ = (dem_state){.id = (uint32_t)id,
                                .x = x[0],
                                .y = x[1],
                                .r = sim->grains.radius[i],
                                .m = sim->grains.mass[i],
                                .vx = v[0],
                                .vy = v[1],
                                .fx = f[0],
                                .fy = f[1],
                                .angle = sim->grains.angle ? sim->grains.angle[i] : 0.0,
                                .omega = sim->grains.omega ? omega(sim, i) : 0.0,
                                .torque = sim->grains.force_torque ? sim->grains.force_torque[i].torque : 0.0,
                                .contacts = contacts[i],
                                .fixed = dem_is_fixed(sim, i)};
    }
    free(contacts);
    free(index);
    return RP_OK;
}

static dem_contact pair_contact(const dem_sim *sim, size_t k)
{
    const size_t i = sim->pairs.i[k], j = sim->pairs.j[k];
    const dem_material *c = &sim->def.material;
    dem_vec a = sim->grains.motion[i].x, b = sim->grains.motion[j].x, d = a - b,
            v = sim->grains.motion[i].v - sim->grains.motion[j].v;
    double r = sqrt(dem_dot(d, d)), f_s = 0.0, couple = 0.0;
    double spring = sim->pairs.spring[k], roll = sim->pairs.rolling ? sim->pairs.roll[k] : 0.0;
    /* Gear corrects positions after touch is found: slightly below 0 is possible */
    double overlap = fmax(sim->pairs.radii[k] - r, 0.0);
    dem_vec n = d * (1.0 / r);
    double v_s = dem_dot(v, dem_clockwise(n));
    if (sim->grains.omega)
        v_s += (sim->grains.radius[i] - 0.5 * overlap) * sim->grains.omega[i] +
               (sim->grains.radius[j] - 0.5 * overlap) * sim->grains.omega[j];
    double f_n = dem_law_normal(sim->def.normal, sim->def.tension, c->k_n, c->gamma_n, sim->pairs.m_eff[k],
                                overlap, dem_dot(v, n));
    f_s = dem_law_tangential(sim->def.tangential, dem_shear_of(&sim->def, c, sim->mu), sim->pairs.m_eff[k],
                             v_s, f_n, 0.0, &spring);
    if (sim->pairs.rolling) {
        const double r_eff = sim->grains.radius[i] * sim->grains.radius[j] / sim->pairs.radii[k];
        couple = dem_law_rolling(dem_rolls_of(c), r_eff, sim->pairs.m_eff[k],
                                 sim->grains.omega[i] - sim->grains.omega[j], f_n, 0.0, &roll);
    }
    return (dem_contact){sim->grains.id[i],
                         sim->grains.id[j],
                         -1,
                         a[0],
                         a[1],
                         b[0],
                         b[1],
                         overlap,
                         f_n,
                         f_s,
                         spring,
                         couple,
                         roll};
}

/* The contact of a wall slot; false if they do not touch. */
static bool slot_contact(const dem_sim *sim, size_t k, dem_contact *contact)
{
    dem_vec normal, wall_velocity;
    double overlap, f_s = 0.0, couple = 0.0;
    double spring = sim->walls.slot[k].spring, roll = sim->walls.slot[k].roll;
    if (!wall_contact(sim, k, &normal, &overlap, &wall_velocity)) return false;
    const dem_wall_slot *slot = &sim->walls.slot[k];
    const size_t i = slot->grain, w = slot->wall;
    const int well = slot->well;
    const dem_material *c = &sim->def.walls[w].material;
    dem_vec v = sim->grains.motion[i].v - wall_velocity, x = sim->grains.motion[i].x;
    dem_vec at = x - (sim->grains.radius[i] - overlap) * normal;
    double f_n = dem_law_normal(sim->def.normal, sim->def.tension, c->k_n, c->gamma_n, sim->grains.mass[i],
                                overlap, dem_dot(v, normal));
    double v_s = dem_dot(v, dem_clockwise(normal));
    if (sim->grains.omega) v_s += (sim->grains.radius[i] - overlap) * sim->grains.omega[i];
    f_s = dem_law_tangential(sim->def.tangential, dem_shear_of(&sim->def, c, sim->walls.mu[w]),
                             sim->grains.mass[i], v_s, f_n, 0.0, &spring);
    if (well != DEM_WELL_NONE) {
        f_s += dem_ground_force(sim, slot, f_n);
        spring = well == DEM_WELL_HOLDS ? dem_ground_displacement(sim, slot) : 0.0;
    }
    if (sim->pairs.rolling)
        couple = dem_law_rolling(dem_rolls_of(c), sim->grains.radius[i], sim->grains.mass[i],
                                 sim->grains.omega[i] + sim->walls.swing[1], f_n, 0.0, &roll);
    *contact = (dem_contact){sim->grains.id[i], 0,   (int)w, x[0],   x[1],   at[0], at[1],
                             overlap,           f_n, f_s,    spring, couple, roll,  well};
    return true;
}

rp_status dem_contacts(const dem_sim *sim, dem_contact **contacts, size_t *n)
{
    *n = 0;
    *contacts = malloc((dem_count_touching(&sim->pairs) + sim->walls.n_slots + 1) * sizeof **contacts);
    if (!*contacts) return rp_fail(RP_NO_MEMORY, "contacts: out of memory");
    DEM_EACH_TOUCHING (&sim->pairs, k) (*contacts)[(*n)++] = pair_contact(sim, k);
    for (size_t k = 0; k < sim->walls.n_slots; k++) *n += slot_contact(sim, k, *contacts + *n);
    return RP_OK;
}

/* A shear spring of the untruncated law pulls with the constant cap beyond its Coulomb limit. */
static dem_elastic elastic(const dem_sim *sim, const dem_material *c, double mu, const dem_contact *contact)
{
    const double overlap = contact->overlap, ds = fabs(contact->shear_spring);
    dem_elastic energy = {.normal = dem_normal_descriptors[sim->def.normal].potential(c->k_n, overlap),
                          .rolling = 0.5 * c->k_roll * contact->rolling_spring * contact->rolling_spring};
    if (contact->well == DEM_WELL_HOLDS)
        energy.well =
            0.5 * sim->def.ground.mu_static * fmax(contact->normal_force, 0.0) / sim->def.ground.a * ds * ds;
    if (dem_has_spring(sim->def.tangential)) {
        double pull = c->k_s * ds;
        if (sim->def.slip == DEM_TOTAL) pull = fmin(pull, mu * fmax(contact->normal_force, 0.0));
        energy.shear = pull * ds - 0.5 * pull * pull / c->k_s;
    }
    return energy;
}

dem_elastic dem_pair_elastic(const dem_sim *sim, size_t k)
{
    const dem_contact contact = pair_contact(sim, k);
    return elastic(sim, &sim->def.material, sim->mu, &contact);
}

dem_elastic dem_slot_elastic(const dem_sim *sim, size_t k)
{
    dem_contact contact;
    const uint32_t w = sim->walls.slot[k].wall;
    return slot_contact(sim, k, &contact)
               ? elastic(sim, &sim->def.walls[w].material, sim->walls.mu[w], &contact)
               : (dem_elastic){0};
}

static double all_elastic(dem_elastic e)
{
    return e.normal + e.well + e.shear + e.rolling;
}

void dem_energies(const dem_sim *sim, dem_energy *energy)
{
    *energy = (dem_energy){0};
    for (size_t i = 0; i < sim->grains.n; i++) {
        if (dem_is_fixed(sim, i)) continue;
        energy->kinetic += dem_kinetic_energy(sim, i);
        energy->gravity -= sim->grains.mass[i] * dem_dot(sim->gravity, sim->grains.motion[i].x);
        energy->rotational += dem_rotational_energy(sim, i, 0.0);
    }
    DEM_EACH_TOUCHING (&sim->pairs, k) energy->elastic += all_elastic(dem_pair_elastic(sim, k));
    for (size_t k = 0; k < sim->walls.n_slots; k++) energy->elastic += all_elastic(dem_slot_elastic(sim, k));
}

void dem_wall_forces(const dem_sim *sim, double *forces)
{
    for (size_t w = 0; w < sim->def.n_walls; w++) {
        forces[2 * w] = sim->walls.force[w][0];
        forces[2 * w + 1] = sim->walls.force[w][1];
    }
}

rp_status dem_rest_state(const dem_sim *sim, double lo, double hi, dem_rest *rest)
{
    *rest = (dem_rest){0};
    int *contacts = count_contacts(sim);
    if (!contacts) return rp_fail(RP_NO_MEMORY, "rest test: out of memory");
    double force2 = 0.0;
    for (size_t i = 0; i < sim->grains.n; i++) {
        double x = dem_to_box(&sim->walls, sim->grains.motion[i].x)[0];
        if (!(x > lo && x < hi) || dem_is_fixed(sim, i)) continue;
        dem_vec v = velocity(sim, i) - dem_box_velocity(&sim->walls, sim->grains.motion[i].x);
        dem_vec f = sim->grains.mass[i] * dem_acceleration(sim, i);
        rest->n++;
        rest->kinetic_energy +=
            0.5 * sim->grains.mass[i] * dem_dot(v, v) + dem_rotational_energy(sim, i, -sim->walls.swing[1]);
        rest->contact_number += contacts[i];
        if (contacts[i] > 0) force2 = fmax(force2, dem_dot(f, f));
    }
    free(contacts);
    rest->net_force = sqrt(force2);
    if (rest->n > 0) {
        rest->kinetic_energy /= (double)rest->n;
        rest->contact_number /= (double)rest->n;
    }
    return RP_OK;
}

int dem_contact_count(const dem_sim *sim, uint32_t id)
{
    int count = 0;
    dem_vec n, v;
    double overlap;
    DEM_EACH_TOUCHING (&sim->pairs, k)
        count += sim->grains.id[sim->pairs.i[k]] == id || sim->grains.id[sim->pairs.j[k]] == id;
    for (size_t k = 0; k < sim->walls.n_slots; k++)
        count += sim->grains.id[sim->walls.slot[k].grain] == id && wall_contact(sim, k, &n, &overlap, &v);
    return count;
}

double dem_largest_speed(const dem_sim *sim, double lo, double hi)
{
    double speed2 = 0.0;
    for (size_t i = 0; i < sim->grains.n; i++) {
        const double x = sim->grains.motion[i].x[0];
        dem_vec v = velocity(sim, i);
        if (x > lo && x < hi && dem_dot(v, v) > speed2) speed2 = dem_dot(v, v);
    }
    return sqrt(speed2);
}

void dem_count_work(const dem_sim *sim, dem_counts *counts)
{
    *counts = (dem_counts){sim->pairs.n,         dem_count_touching(&sim->pairs), sim->walls.n_slots,
                           sim->count.rebuilds,  sim->count.collisions,           sim->count.grain_steps,
                           sim->count.iterations};
}
