/* Energy ledger: the channels into which a run's energy goes. The simulation does not depend on it.
 *
 * In a step with displacement D, the forces F of the step's two ends do the work (F_0 + F_1) . D/2. The work
 * is split over the contacts, and at each contact over the parts of its law. Damping, sliding and moving
 * walls are channels. The work of a spring is compared with the change of its potential, and the work on a
 * grain with the change of its kinetic energy; both differences are the channel `integration`. Energy and
 * ledger then agree to round-off if the parts of all contacts add up to the forces that moved the grains.
 *
 * An integrator with one force throughout a step gives the parts of that force itself.
 *
 * A truncated spring slides by the law's increment of displacement less the change of the spring. */
#include "dem/ledger.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dem/energy.h"
#include "dem/ground.h"
#include "dem/integrator.h"
#include "dem/law.h"
#include "dem/sim.h"

/* A grain, by id, at the end of the last step, with its displacement and turn in the step. `hard` is the
 * energy gained in the step's hard collisions; mass 0 means fixed. */
typedef struct {
    bool present, seen;
    dem_vec x, force, displacement;
    double angle, torque, turn, mass, kinetic, hard;
} ledger_grain;

/* A contact of grain a with grain b, or with a wall (b = 0): frame, parts of the force on a, increments of
 * the shear and rolling displacements, energies. */
typedef struct {
    uint64_t key;
    uint32_t a, b, index; /* index of the pair or wall slot */
    dem_vec n, s, point, own_velocity;
    double arm_a, arm_b, r_eff;
    double elastic, damping, spring, dashpot, slip, well, roll_spring, roll_dashpot;
    double sheared, rolled;
    dem_elastic energy;
} ledger_contact;

struct dem_ledger_state {
    dem_ledger sum;
    dem_vec gravity;
    size_t capacity; /* ids, with the 0 that is nobody's */
    ledger_grain *grain;
    size_t n_old, n_new, contact_capacity;
    ledger_contact *old_contact, *new_contact;
    size_t n_between, between_capacity; /* forces that are one through the step */
    ledger_contact *between;
};

static bool one_force(const dem_sim *sim)
{
    return sim->scheme->pair_parts != NULL;
}

static rp_status no_memory(void)
{
    return rp_fail(RP_NO_MEMORY, "energy ledger: out of memory");
}

static rp_status reserve_grains(dem_sim *sim, size_t last_id)
{
    struct dem_ledger_state *b = sim->ledger;
    if (last_id < b->capacity) return RP_OK;
    const size_t capacity = 2 * last_id + 2;
    if (!dem_grow(&b->grain, sizeof *b->grain, capacity)) return no_memory();
    memset(b->grain + b->capacity, 0, (capacity - b->capacity) * sizeof *b->grain);
    b->capacity = capacity;
    return RP_OK;
}

static rp_status reserve_contacts(struct dem_ledger_state *b, size_t need)
{
    if (need < b->contact_capacity) return RP_OK;
    const size_t capacity = 2 * need + 16;
    if (!dem_grow(&b->old_contact, sizeof *b->old_contact, capacity) ||
        !dem_grow(&b->new_contact, sizeof *b->new_contact, capacity))
        return no_memory();
    b->contact_capacity = capacity;
    return RP_OK;
}

/* The parts of the normal, tangential and rolling force; gives the normal force. */
static double split_forces(const dem_sim *sim, const dem_relative *r, double h, ledger_contact *e)
{
    const dem_definition *def = &sim->def;
    const dem_material *c = r->c;
    e->n = r->n, e->s = r->s, e->point = r->point;
    e->arm_a = r->arm_a, e->arm_b = r->arm_b, e->r_eff = r->r_eff;
    e->sheared = r->v_s * h, e->rolled = r->v_roll * h;
    const double f_n =
        dem_law_normal(def->normal, def->tension, c->k_n, c->gamma_n, r->m_eff, r->overlap, r->v_n);
    e->elastic = dem_law_elastic(def->normal, c->k_n, r->overlap);
    e->damping = f_n - e->elastic;
    const dem_slider shear = dem_shear_of(def, c, r->mu);
    double ds = r->spring, pull = c->k_s * ds;
    const double f_s = dem_law_tangential(def->tangential, shear, r->m_eff, r->v_s, f_n, 0.0, &ds),
                 cap = r->mu * fmax(f_n, 0.0);
    switch (def->tangential) {
    case DEM_NONE: break;
    case DEM_SPRING:
        if (def->slip == DEM_TOTAL && fabs(pull) > cap) pull = copysign(cap, pull);
        e->spring = -pull;
        e->dashpot = pull + f_s;
        break;
    case DEM_SLIP_ROLL: *(f_s == -(c->gamma_s * r->m_eff * r->v_s) ? &e->dashpot : &e->slip) = f_s; break;
    }
    if (sim->pairs.rolling) {
        double xi = r->roll;
        e->roll_spring = -c->k_roll * xi;
        e->roll_dashpot = dem_law_shear(dem_rolls_of(c), r->m_eff, r->v_roll, f_n, 0.0, &xi) - e->roll_spring;
    }
    return f_n;
}

/* Grain a is that of the smaller id, so that a contact keeps its sense as grains are sorted. */
static void pair_forces(const dem_sim *sim, uint32_t k, double h, ledger_contact *e)
{
    const bool swap = sim->grains.id[sim->pairs.i[k]] > sim->grains.id[sim->pairs.j[k]];
    const size_t i = swap ? sim->pairs.j[k] : sim->pairs.i[k], j = swap ? sim->pairs.i[k] : sim->pairs.j[k];
    *e = (ledger_contact){.a = sim->grains.id[i], .b = sim->grains.id[j], .index = k};
    e->key = (uint64_t)e->a << 32 | e->b;
    if (one_force(sim)) return;
    const dem_relative r = dem_pair_relative(sim, k, swap);
    split_forces(sim, &r, h, e);
    if (sim->grains.excess) e->sheared += dem_dot(sim->grains.excess[i] - sim->grains.excess[j], e->s);
}

static uint64_t slot_key(const dem_sim *sim, const dem_wall_slot *slot)
{
    return (uint64_t)sim->grains.id[slot->grain] << 32 | (UINT32_MAX - slot->wall);
}

static void slot_forces(const dem_sim *sim, uint32_t k, double h, ledger_contact *e)
{
    const dem_wall_slot *slot = &sim->walls.slot[k];
    dem_relative r;
    *e = (ledger_contact){.a = sim->grains.id[slot->grain], .index = k, .key = slot_key(sim, slot)};
    if (one_force(sim) || !dem_slot_relative(sim, k, &r)) return;
    const double f_n = split_forces(sim, &r, h, e);
    e->own_velocity = r.wall_velocity - dem_box_velocity(&sim->walls, e->point);
    if (sim->grains.excess) e->sheared += dem_dot(sim->grains.excess[slot->grain], e->s);
    if (dem_is_ground(sim, slot)) e->well = dem_ground_force(sim, slot, f_n);
}

static int by_key(const void *a, const void *b)
{
    const uint64_t x = ((const ledger_contact *)a)->key, y = ((const ledger_contact *)b)->key;
    return (x > y) - (x < y);
}

rp_status dem_ledger_forces(dem_sim *sim, double h)
{
    struct dem_ledger_state *b = sim->ledger;
    rp_status status = reserve_contacts(b, dem_count_touching(&sim->pairs) + sim->walls.n_slots);
    if (status) return status;
    b->n_new = 0;
    DEM_EACH_TOUCHING (&sim->pairs, k) pair_forces(sim, (uint32_t)k, h, &b->new_contact[b->n_new++]);
    for (uint32_t k = 0; k < sim->walls.n_slots; k++) slot_forces(sim, k, h, &b->new_contact[b->n_new++]);
    qsort(b->new_contact, b->n_new, sizeof *b->new_contact, by_key);
    return RP_OK;
}

static void note_between(struct dem_ledger_state *b, ledger_contact c, dem_parts p)
{
    c.n = p.n, c.s = p.s;
    c.elastic = p.elastic, c.damping = p.damping, c.dashpot = p.dashpot, c.slip = p.slip, c.well = p.well;
    b->between[b->n_between++] = c;
}

rp_status dem_ledger_between(dem_sim *sim, const dem_vec *force)
{
    struct dem_ledger_state *b = sim->ledger;
    const size_t need = sim->pairs.n + sim->walls.n_slots;
    if (need > b->between_capacity) {
        if (!dem_grow(&b->between, sizeof *b->between, need)) return no_memory();
        b->between_capacity = need;
    }
    b->n_between = 0;
    for (size_t i = 0; i < sim->grains.n; i++) b->grain[sim->grains.id[i]].force = force[i];
    for (size_t k = 0; k < sim->pairs.n; k++)
        note_between(
            b, (ledger_contact){.a = sim->grains.id[sim->pairs.i[k]], .b = sim->grains.id[sim->pairs.j[k]]},
            sim->scheme->pair_parts(sim, k));
    for (size_t k = 0; k < sim->walls.n_slots; k++) {
        const dem_wall_slot *slot = &sim->walls.slot[k];
        note_between(b, (ledger_contact){.a = sim->grains.id[slot->grain], .key = slot_key(sim, slot)},
                     sim->scheme->slot_parts(sim, k));
    }
    return RP_OK;
}

static ledger_grain read_grain(const dem_sim *sim, size_t i)
{
    ledger_grain g = {.present = true, .x = sim->grains.motion[i].x, .force = *dem_force(sim, i)};
    if (sim->grains.omega) {
        g.angle = sim->grains.angle[i];
        g.torque = sim->grains.force_torque[i].torque;
    }
    if (sim->grains.inverse_mass[i] == 0.0) return g;
    g.mass = sim->grains.mass[i];
    g.kinetic = dem_kinetic_energy(sim, i) + dem_rotational_energy(sim, i, 0.0);
    return g;
}

static double weight_energy(const struct dem_ledger_state *b, const ledger_grain *g)
{
    return -g->mass * dem_dot(b->gravity, g->x);
}

/* Sum of the channels of a step, with their signs. */
static double net(const dem_ledger *l)
{
#define X(channel, sign) sign l->channel
    return DEM_LEDGER_LIST(X);
#undef X
}

static void add(dem_ledger *sum, const dem_ledger *l)
{
#define X(channel, sign) sum->channel += l->channel;
    DEM_LEDGER_LIST(X)
#undef X
    sum->at_walls += l->at_walls;
    sum->turnover += fabs(l->wall_work);
}

/* Displacements in the step, and the gain of kinetic energy beyond the work of the forces. A grain that left
 * takes its energy of the step's start with it. */
static void move_grains(dem_sim *sim)
{
    struct dem_ledger_state *b = sim->ledger;
    for (size_t i = 0; i < sim->grains.n; i++) {
        ledger_grain *g = &b->grain[sim->grains.id[i]], now = read_grain(sim, i);
        now.seen = true;
        now.displacement = now.x - g->x;
        now.turn = now.angle - g->angle;
        if (now.mass > 0.0) {
            const dem_vec force = one_force(sim) ? g->force : 0.5 * (g->force + now.force);
            const double work = dem_dot(force, now.displacement) + 0.5 * (g->torque + now.torque) * now.turn;
            const double fall = now.mass * dem_dot(b->gravity, now.displacement),
                         change = now.kinetic - g->kinetic;
            b->sum.integration += change - work - fall - g->hard;
            b->sum.turnover += fabs(change) + fabs(fall);
        }
        *g = now;
    }
    for (size_t id = 1; id <= sim->grains.last_id; id++) {
        ledger_grain *g = &b->grain[id];
        if (g->present && !g->seen) {
            b->sum.taken_out += g->kinetic + g->hard + weight_energy(b, g);
            *g = (ledger_grain){0};
        }
        g->seen = false;
    }
}

/* Half of the work that the forces of one end of the step do over it. */
static void half_works(const dem_sim *sim, const ledger_contact *c, bool first, dem_ledger *step)
{
    const double dt = sim->def.dt;
    const ledger_grain *a = &sim->ledger->grain[c->a], *b = &sim->ledger->grain[c->b];
    dem_vec other = b->displacement;
    double turn = b->turn;
    if (c->b == 0) { /* where the wall's point goes from the step's start, or came from at its end */
        other = dt * (c->own_velocity + (first ? -sim->walls.swing[0] : sim->walls.swing[0]) * c->point +
                      sim->walls.swing[1] * dem_clockwise(c->point));
        turn = -dt * sim->walls.swing[1];
    }
    const double along_n = dem_dot(a->displacement - other, c->n), turned = a->turn - turn;
    const double centres = dem_dot(a->displacement - other, c->s); /* a well holds the centre */
    const double along_s = centres + c->arm_a * a->turn + c->arm_b * b->turn;
    const double rolled = c->r_eff * turned, shear = c->spring + c->dashpot + c->slip + c->well;
    step->normal_damping -= 0.5 * c->damping * along_n;
    step->shear_damping -= 0.5 * c->dashpot * along_s;
    step->sliding -= 0.5 * c->slip * along_s;
    step->wells -= 0.5 * c->well * centres;
    step->rolling -= 0.5 * c->roll_dashpot * rolled;
    step->integration += 0.5 * (c->elastic * along_n + c->spring * along_s + c->roll_spring * rolled);
    if (c->b == 0)
        step->wall_work += 0.5 * (dem_dot((c->elastic + c->damping) * c->n + shear * c->s, other) +
                                  c->r_eff * (c->roll_spring + c->roll_dashpot) * turn);
}

static bool wall_gone(const dem_sim *sim, const ledger_contact *c)
{
    const dem_wall *w = &sim->def.walls[UINT32_MAX - (uint32_t)c->key];
    return w->open_at_step >= 0 && sim->step >= w->open_at_step && isinf(w->open_speed);
}

/* Add the energies of a contact in the step to the sums. */
static void add_step(dem_sim *sim, const ledger_contact *c, dem_ledger step)
{
    struct dem_ledger_state *b = sim->ledger;
    if (!b->grain[c->a].present || (c->b && !b->grain[c->b].present))
        step = (dem_ledger){.taken_out = -net(&step)};
    else if (c->b == 0 && wall_gone(sim, c))
        step = (dem_ledger){.wall_work = net(&step)};
    else if (c->b == 0)
        step.at_walls = step.normal_damping + step.shear_damping + step.sliding + step.rolling + step.wells;
    add(&b->sum, &step);
}

/* Energies of a contact over the step. `was` is empty for a new contact, `is` for an ended one. */
static void settle_contact(dem_sim *sim, const ledger_contact *was, const ledger_contact *is)
{
    dem_ledger step = {0};
    half_works(sim, was, true, &step);
    half_works(sim, is, false, &step);
    const double pull = -0.5 * (was->spring + is->spring) * is->sheared;
    const double roll_pull = -0.5 * (was->roll_spring + is->roll_spring) * is->rolled;
    step.sliding += pull - (is->energy.shear - was->energy.shear);
    step.rolling += roll_pull - (is->energy.rolling - was->energy.rolling);
    step.wells -= is->energy.well - was->energy.well;
    step.integration += pull + roll_pull + is->energy.normal - was->energy.normal;
    add_step(sim, was->a ? was : is, step);
}

/* Energies of a contact with one force throughout the step. */
static void settle_between(dem_sim *sim, const ledger_contact *c)
{
    dem_ledger step = {0};
    half_works(sim, c, true, &step);
    half_works(sim, c, false, &step);
    add_step(sim, c, step);
}

static void read_elastic(dem_sim *sim)
{
    struct dem_ledger_state *b = sim->ledger;
    for (size_t k = 0; k < b->n_new; k++) {
        ledger_contact *c = &b->new_contact[k];
        c->energy = c->b ? dem_pair_elastic(sim, c->index) : dem_slot_elastic(sim, c->index);
    }
}

static void swap_contacts(struct dem_ledger_state *b)
{
    ledger_contact *swap = b->old_contact;
    b->old_contact = b->new_contact;
    b->new_contact = swap;
    b->n_old = b->n_new;
}

void dem_ledger_step(dem_sim *sim)
{
    static const ledger_contact none;
    struct dem_ledger_state *b = sim->ledger;
    move_grains(sim);
    read_elastic(sim);
    for (size_t i = 0, j = 0; i < b->n_old || j < b->n_new;) {
        const ledger_contact *was = &b->old_contact[i], *is = &b->new_contact[j];
        const bool ended = i < b->n_old && (j == b->n_new || was->key < is->key);
        const bool begun = j < b->n_new && (i == b->n_old || is->key < was->key);
        settle_contact(sim, begun ? &none : was, ended ? &none : is);
        i += !begun;
        j += !ended;
    }
    for (size_t k = 0; k < b->n_between; k++) settle_between(sim, &b->between[k]);
    swap_contacts(b);
}

void dem_ledger_gravity(dem_sim *sim)
{
    struct dem_ledger_state *b = sim->ledger;
    const dem_vec change = sim->gravity - b->gravity;
    double gain = 0.0;
    for (size_t i = 0; i < sim->grains.n; i++)
        if (sim->grains.inverse_mass[i] > 0.0)
            gain -= sim->grains.mass[i] * dem_dot(change, sim->grains.motion[i].x);
    b->sum.gravity_turn += gain;
    b->sum.turnover += fabs(gain);
    b->gravity = sim->gravity;
}

static double energy_of_body(const dem_body *body)
{
    return body->inverse_mass == 0.0
               ? 0.0
               : 0.5 * (body->v[0] * body->v[0] + body->v[1] * body->v[1]) / body->inverse_mass +
                     (body->inverse_inertia > 0.0 ? 0.5 * body->omega * body->omega / body->inverse_inertia
                                                  : 0.0);
}

void dem_ledger_collision(dem_sim *sim, const size_t grain[2], const dem_body before[2],
                          const dem_body after[2])
{
    struct dem_ledger_state *b = sim->ledger;
    double gain = 0.0, wall = 0.0;
    for (int k = 0; k < 2; k++) {
        if (before[k].inverse_mass == 0.0) continue;
        const double gained = energy_of_body(&after[k]) - energy_of_body(&before[k]);
        b->grain[sim->grains.id[grain[k]]].hard += gained;
        gain += gained;
        /* where the other cannot be moved, the work of the impulse as it moves */
        if (before[1 - k].inverse_mass == 0.0)
            wall = ((after[k].v[0] - before[k].v[0]) * before[1 - k].v[0] +
                    (after[k].v[1] - before[k].v[1]) * before[1 - k].v[1]) /
                   before[k].inverse_mass;
    }
    add(&b->sum, &(dem_ledger){.hard = wall - gain, .wall_work = wall});
}

rp_status dem_ledger_add(dem_sim *sim, const dem_grain *p)
{
    struct dem_ledger_state *b = sim->ledger;
    rp_status status = reserve_grains(sim, sim->grains.last_id + 1);
    if (status) return status;
    ledger_grain *g = &b->grain[sim->grains.last_id + 1];
    *g = (ledger_grain){.present = true, .x = {p->x, p->y}, .angle = p->angle, .mass = p->m};
    g->kinetic = 0.5 * p->m * (p->vx * p->vx + p->vy * p->vy) +
                 0.5 * dem_inertia(sim->def.shape, p->m, p->r) * p->omega * p->omega;
    b->sum.put_in += g->kinetic + weight_energy(b, g);
    return RP_OK;
}

static double energy_now(const dem_sim *sim)
{
    dem_energy e;
    dem_energies(sim, &e);
    return e.kinetic + e.rotational + e.elastic + e.gravity;
}

rp_status dem_ledger_alloc(dem_sim *sim)
{
    if (!(sim->ledger = calloc(1, sizeof *sim->ledger))) return no_memory();
    return reserve_grains(sim, sim->grains.last_id);
}

void dem_ledger_start(dem_sim *sim)
{
    struct dem_ledger_state *b = sim->ledger;
    b->gravity = sim->gravity;
    for (size_t i = 0; i < sim->grains.n; i++) b->grain[sim->grains.id[i]] = read_grain(sim, i);
    read_elastic(sim);
    swap_contacts(b);
    b->sum.start = energy_now(sim);
}

rp_status dem_ledger_clone(dem_sim *copy, const dem_sim *sim)
{
    const struct dem_ledger_state *from = sim->ledger;
    struct dem_ledger_state *b = copy->ledger = malloc(sizeof *b);
    if (!b) return no_memory();
    *b = *from;
    b->between = NULL; /* of a step */
    b->between_capacity = 0;
    b->grain = malloc(b->capacity * sizeof *b->grain);
    b->old_contact = malloc(b->contact_capacity * sizeof *b->old_contact);
    b->new_contact = malloc(b->contact_capacity * sizeof *b->new_contact);
    if (!b->grain || !b->old_contact || !b->new_contact) return no_memory();
    memcpy(b->grain, from->grain, b->capacity * sizeof *b->grain);
    memcpy(b->old_contact, from->old_contact, b->n_old * sizeof *b->old_contact);
    return RP_OK;
}

/* Every contact is one of grains and walls that there are. */
static bool contacts_exist(const dem_sim *sim)
{
    const struct dem_ledger_state *b = sim->ledger;
    bool exist = true;
    for (size_t k = 0; k < b->n_old; k++) {
        const ledger_contact *c = &b->old_contact[k];
        exist &= c->a <= sim->grains.last_id && c->b <= sim->grains.last_id;
        exist &= c->b > 0 || UINT32_MAX - (uint32_t)c->key < sim->def.n_walls;
    }
    return exist;
}

void dem_ledger_keep(rp_snapshot *s, dem_sim *sim)
{
    if (s->status || !sim->def.ledger) return;
    if (s->reading && (s->status = dem_ledger_alloc(sim)) != RP_OK) return;
    struct dem_ledger_state *b = sim->ledger;
    RP_KEEP(s, b->sum);
    RP_KEEP(s, b->gravity);
    RP_KEEP(s, b->n_old);
    rp_keep_check(s, b->n_old <= s->n / sizeof *b->old_contact, "impossible contacts of the ledger");
    if (!s->status && s->reading) s->status = reserve_contacts(b, b->n_old);
    rp_keep(s, b->grain, (sim->grains.last_id + 1) * sizeof *b->grain);
    rp_keep(s, b->old_contact, b->n_old * sizeof *b->old_contact);
    rp_keep_check(s, s->status || contacts_exist(sim), "impossible contacts of the ledger");
}

void dem_ledger_free(dem_sim *sim)
{
    if (!sim->ledger) return;
    free(sim->ledger->grain), free(sim->ledger->old_contact), free(sim->ledger->new_contact);
    free(sim->ledger->between), free(sim->ledger);
}

bool dem_ledger_read(const dem_sim *sim, dem_ledger *ledger)
{
    if (!sim->ledger) return false;
    *ledger = sim->ledger->sum;
    ledger->residual = energy_now(sim) - (ledger->start + net(ledger));
    return true;
}
