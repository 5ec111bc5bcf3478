/* Readings of a simulation. Nothing here changes the state: the integrator brings velocities to the
 * time of the positions on the way out. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <xxhash.h>

#include "dem/forces/forces.h"
#include "dem/observe/observe.h"
#include "dem/state/motion.h"

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

/* Contacts of each grain, by index. */
static int *count_contacts(const dem_sim *sim)
{
    int *count = calloc(sim->grains.n + 1, sizeof *count);
    if (!count) return NULL;
    DEM_EACH_TOUCHING (&sim->pairs, k) count[sim->pairs.i[k]]++, count[sim->pairs.j[k]]++;
    for (size_t s = 0; s < sim->walls.n_slots; s++) {
        dem_relative r;
        dem_wall_slot slot = sim->walls.slot[s];
        count[slot.grain] += dem_slot_relative(sim, &slot, &r);
    }
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
            dem_is_fixed(sim, i) ? *dem_force(sim, i) : sim->grains.mass[i] * dem_acceleration_of(sim, i);
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
                                .fixed = dem_is_fixed(sim, i),
                                .kind = dem_kind_of(sim, i)};
    }
    free(contacts);
    free(index);
    return RP_OK;
}

static dem_contact contact_of(const dem_sim *sim, const dem_relative *r)
{
    dem_contact c = dem_law_forces(sim, r, 0.0);
    const dem_vec x = sim->grains.motion[r->a].x;
    c.id_a = sim->grains.id[r->a], c.id_b = r->slot ? 0 : sim->grains.id[r->b];
    c.wall = r->slot ? (int)r->slot->wall : -1;
    c.x = x[0], c.y = x[1], c.x_b = r->point[0], c.y_b = r->point[1];
    if (!r->slot || r->slot->well == DEM_WELL_NONE) return c;
    c.well = r->slot->well;
    c.shear_force += dem_ground_force(sim, r->slot, c.normal_force);
    c.shear_spring = c.well == DEM_WELL_HOLDS ? dem_ground_displacement(sim, r->slot) : 0.0;
    return c;
}

rp_status dem_contacts(const dem_sim *sim, dem_contact **contacts, size_t *n)
{
    dem_relative r;
    *n = 0;
    *contacts = malloc((dem_count_touching(&sim->pairs) + sim->walls.n_slots + 1) * sizeof **contacts);
    if (!*contacts) return rp_fail(RP_NO_MEMORY, "contacts: out of memory");
    for (size_t k = 0; k < dem_contact_numbers(sim); k++)
        if (dem_contact_relative(sim, k, false, &r)) (*contacts)[(*n)++] = contact_of(sim, &r);
    return RP_OK;
}

size_t dem_over_friction(const dem_sim *sim, size_t *over)
{
    static const double ROUND_OFF = 1e-9;
    const dem_definition *def = &sim->def;
    dem_relative r;
    size_t n = 0;
    *over = 0;
    if (!dem_has_spring(def->tangential) || def->damping == DEM_DAMPING_INSIDE) return 0;
    for (size_t k = 0; k < dem_contact_numbers(sim); k++) {
        if (!dem_contact_relative(sim, k, false, &r)) continue;
        const dem_contact c = dem_law_forces(sim, &r, 0.0);
        *over += fabs(c.shear_force) > (1.0 + ROUND_OFF) * r.c->mu * fmax(c.normal_force, 0.0);
        n++;
    }
    return n;
}

/* A shear spring of the untruncated law pulls with the constant cap beyond its Coulomb limit. */
dem_elastic dem_contact_elastic(const dem_sim *sim, size_t k)
{
    dem_relative r;
    if (!dem_contact_relative(sim, k, false, &r)) return (dem_elastic){0};
    const dem_contact contact = contact_of(sim, &r);
    const double ds = fabs(contact.shear_spring), roll = contact.rolling_spring,
                 normal = fmax(contact.normal_force, 0.0);
    dem_elastic energy = {
        .normal = dem_normal_descriptors[sim->def.normal].potential(dem_k_n_of(sim, &r), r.overlap),
        .rolling = 0.5 * contact.k_roll * roll * roll};
    if (contact.well == DEM_WELL_HOLDS)
        energy.well = 0.5 * sim->def.ground.mu_static * normal / sim->def.ground.a * ds * ds;
    if (dem_has_spring(sim->def.tangential)) {
        double pull = contact.k_s * ds;
        if (sim->def.slip == DEM_TOTAL) pull = fmin(pull, r.c->mu * normal);
        if (pull > 0.0) energy.shear = pull * ds - 0.5 * pull * pull / contact.k_s; /* k_s may be 0 */
    }
    return energy;
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
    for (size_t k = 0; k < dem_contact_numbers(sim); k++) {
        const dem_elastic e = dem_contact_elastic(sim, k);
        energy->elastic += e.normal + e.well + e.shear + e.rolling;
    }
}

double dem_energy_now(const dem_sim *sim)
{
    dem_energy e;
    dem_energies(sim, &e);
    return e.kinetic + e.rotational + e.elastic + e.gravity;
}

rp_status dem_rest_in(const dem_sim *sim, dem_in_region *in, const void *region, dem_rest *rest)
{
    *rest = (dem_rest){0};
    int *contacts = count_contacts(sim);
    if (!contacts) return rp_fail(RP_NO_MEMORY, "rest test: out of memory");
    double force2[2] = {0.0, 0.0}; /* without, with a contact */
    for (size_t i = 0; i < sim->grains.n; i++) {
        const dem_vec at = dem_to_box(&sim->walls, sim->grains.motion[i].x);
        if (dem_is_fixed(sim, i) || !in(region, sim->grains.id[i], at[0], at[1])) continue;
        dem_vec v = velocity(sim, i) - dem_box_velocity(&sim->walls, sim->grains.motion[i].x);
        dem_vec f = sim->grains.mass[i] * dem_acceleration_of(sim, i);
        rest->n++;
        rest->kinetic_energy +=
            0.5 * sim->grains.mass[i] * dem_dot(v, v) + dem_rotational_energy(sim, i, -sim->walls.swing[1]);
        rest->contact_number += contacts[i];
        double *largest = &force2[contacts[i] > 0];
        *largest = fmax(*largest, dem_dot(f, f));
    }
    free(contacts);
    rest->free_force = sqrt(force2[0]);
    rest->net_force = sqrt(force2[1]);
    if (rest->n > 0) {
        rest->kinetic_energy /= (double)rest->n;
        rest->contact_number /= (double)rest->n;
    }
    return RP_OK;
}

static bool lies_between(const void *ends, uint32_t id, double x, double y)
{
    (void)id, (void)y;
    return x > ((const double *)ends)[0] && x < ((const double *)ends)[1];
}

rp_status dem_rest_state(const dem_sim *sim, double lo, double hi, dem_rest *rest)
{
    return dem_rest_in(sim, lies_between, (double[]){lo, hi}, rest);
}

bool dem_at_rest(const dem_rest *rest, double energy, double force, bool brief)
{
    return rest->kinetic_energy <= energy && rest->net_force <= force && !(brief && rest->free_force > force);
}

int dem_contact_count(const dem_sim *sim, uint32_t id)
{
    int count = 0;
    dem_relative r;
    for (size_t k = 0; k < dem_contact_numbers(sim); k++) {
        const dem_ends ends = dem_contact_ends(sim, k);
        const bool has = sim->grains.id[ends.i] == id || (!ends.slot && sim->grains.id[ends.j] == id);
        count += has && dem_contact_relative(sim, k, false, &r);
    }
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

rp_status dem_digest(const dem_sim *sim, uint64_t *digest)
{
    const size_t n = sim->grains.n;
    dem_state *states = malloc((n + 1) * sizeof *states);
    double(*v)[6] = malloc((n + 1) * sizeof *v);
    rp_status status = states && v ? dem_states(sim, states) : rp_fail(RP_NO_MEMORY, "digest: out of memory");
    for (size_t i = 0; i < n && !status; i++) {
        const dem_state *s = &states[i];
        memcpy(v[i], (double[]){s->x, s->y, s->vx, s->vy, s->fx, s->fy}, sizeof v[i]);
    }
    if (!status) *digest = XXH3_64bits(v, n * sizeof *v);
    free(states), free(v);
    return status;
}
