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
#include "dem/observe/observe.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dem/forces/forces.h"
#include "dem/law/law.h"

/* A grain, by id, at the end of the last step, with its displacement and turn in the step. `hard` is the
 * energy gained in the step's hard collisions; mass 0 means fixed. `zero` stands where padding would
 * differ between snapshots of equal states. */
typedef struct {
    bool present, seen;
    char zero[14];
    dem_vec x, force, displacement;
    double angle, torque, turn, mass, kinetic, hard;
} ledger_grain;

/* A contact of grain a with grain b, or with a wall (b = 0), by ids: its number; parts of the force on a;
 * increments of the shear and rolling displacements; energies. */
typedef struct {
    uint64_t key;
    uint32_t a, b;
    size_t number;
    dem_parts part;
    dem_vec point, own_velocity; /* of a wall */
    double arm_a, arm_b, r_eff, sheared, rolled;
    dem_elastic energy;
} ledger_contact;

typedef struct {
    size_t n, capacity;
    ledger_contact *at;
} contact_list;

struct dem_ledger_state {
    dem_ledger sum;
    dem_vec gravity;
    size_t capacity; /* ids, with the 0 that is nobody's */
    ledger_grain *grain;
    contact_list old, now, between; /* between: forces that are one through the step */
};

static bool one_force(const dem_sim *sim)
{
    return sim->scheme->parts != NULL;
}

static rp_status reserve_grains(dem_sim *sim, size_t last_id)
{
    struct dem_ledger_state *b = sim->ledger;
    const size_t before = b->capacity;
    RP_TRY(dem_room("energy ledger", &b->grain, sizeof *b->grain, last_id + 1, &b->capacity));
    memset(b->grain + before, 0, (b->capacity - before) * sizeof *b->grain);
    return RP_OK;
}

static rp_status reserve(contact_list *list, size_t n)
{
    return dem_room("energy ledger", &list->at, sizeof *list->at, n, &list->capacity);
}

/* Contact number k without forces. With `by_id`, grain a of a pair has the smaller id: a contact keeps its
 * sense as grains are sorted. */
static ledger_contact new_contact(const dem_sim *sim, size_t k, bool by_id)
{
    const dem_ends ends = dem_contact_ends(sim, k);
    const uint32_t a = sim->grains.id[ends.i], b = ends.slot ? 0 : sim->grains.id[ends.j];
    const bool swap = by_id && b > 0 && a > b;
    ledger_contact c = {.a = swap ? b : a, .b = swap ? a : b, .number = k};
    c.key = (uint64_t)c.a << 32 | (ends.slot ? UINT32_MAX - ends.slot->wall : c.b);
    return c;
}

static dem_parts split_force(const dem_sim *sim, const dem_relative *r)
{
    const dem_definition *def = &sim->def;
    const dem_material *c = r->c;
    const dem_contact law = dem_law_forces(sim, r, 0.0);
    const double f_n = law.normal_force, f_s = law.shear_force, cap = c->mu * fmax(f_n, 0.0);
    dem_parts p = {
        .n = r->n, .s = r->s, .elastic = dem_law_elastic(def->normal, dem_k_n_of(sim, r), r->overlap)};
    p.damping = f_n - p.elastic;
    double pull = law.k_s * r->spring;
    if (dem_has_spring(def->tangential)) {
        if (def->slip == DEM_TOTAL && fabs(pull) > cap) pull = copysign(cap, pull);
        p.dashpot = pull + f_s;
        /* inside the limit it acts as far as the limit goes; a spring beyond it is the slider's affair */
        if (def->damping == DEM_DAMPING_INSIDE && fabs(p.dashpot) > cap)
            p.dashpot = copysign(cap, p.dashpot), pull = p.dashpot - f_s;
        p.spring = -pull;
    } else if (dem_has_friction(def->tangential)) {
        *(f_s == -(c->gamma_s * r->m_eff * r->v_s) ? &p.dashpot : &p.slip) = f_s;
    }
    if (sim->pairs.rolling) {
        p.roll_spring = -law.k_roll * r->roll;
        p.roll_dashpot = law.rolling_torque / r->r_eff - p.roll_spring;
    }
    if (r->slot && dem_is_ground(sim, r->slot)) p.well = dem_ground_force(sim, r->slot, f_n);
    return p;
}

/* Contact number k with its forces, after all springs have advanced by h. */
static ledger_contact contact_now(const dem_sim *sim, size_t k, double h)
{
    ledger_contact c = new_contact(sim, k, true);
    dem_relative r;
    if (one_force(sim) || !dem_contact_relative(sim, k, true, &r)) return c;
    c.part = split_force(sim, &r);
    c.point = r.point, c.arm_a = r.arm_a, c.arm_b = r.arm_b, c.r_eff = r.r_eff;
    if (r.slot) c.own_velocity = r.wall_velocity - dem_wall_velocity(&sim->walls, r.slot->wall, r.point);
    c.sheared = r.v_s * h, c.rolled = r.v_roll * h;
    if (sim->grains.excess) {
        const dem_vec *excess = sim->grains.excess;
        c.sheared += dem_dot(r.slot ? excess[r.a] : excess[r.a] - excess[r.b], r.s);
    }
    return c;
}

static int by_key(const void *a, const void *b)
{
    const uint64_t x = ((const ledger_contact *)a)->key, y = ((const ledger_contact *)b)->key;
    return (x > y) - (x < y);
}

rp_status dem_ledger_forces(dem_sim *sim, double h)
{
    contact_list *now = &sim->ledger->now;
    RP_TRY(reserve(now, dem_count_touching(&sim->pairs) + sim->walls.n_slots + 1));
    now->n = 0;
    for (size_t k = 0; k < dem_contact_numbers(sim); k++)
        if (k >= sim->pairs.n || dem_touches(&sim->pairs, k)) now->at[now->n++] = contact_now(sim, k, h);
    qsort(now->at, now->n, sizeof *now->at, by_key);
    return RP_OK;
}

rp_status dem_ledger_between(dem_sim *sim, const dem_vec *force)
{
    contact_list *between = &sim->ledger->between;
    RP_TRY(reserve(between, dem_contact_numbers(sim)));
    for (size_t i = 0; i < sim->grains.n; i++) sim->ledger->grain[sim->grains.id[i]].force = force[i];
    between->n = dem_contact_numbers(sim);
    for (size_t k = 0; k < between->n; k++) {
        between->at[k] = new_contact(sim, k, false);
        between->at[k].part = sim->scheme->parts(sim, k);
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

static size_t wall_of(const ledger_contact *c)
{
    return UINT32_MAX - (uint32_t)c->key;
}

/* Half of the work that the forces of one end of the step do over it. */
static void half_works(const dem_sim *sim, const ledger_contact *c, bool first, dem_ledger *step)
{
    if (c->a == 0) return; /* no contact */
    const double dt = sim->def.dt;
    const ledger_grain *a = &sim->ledger->grain[c->a], *b = &sim->ledger->grain[c->b];
    dem_vec other = b->displacement;
    double turn = b->turn;
    if (c->b == 0) { /* where the wall's point goes from the step's start, or came from at its end */
        const dem_wall_line *line = &sim->walls.line[wall_of(c)];
        const dem_vec swing = line->moves ? line->swing : sim->walls.swing,
                      pivot = first ? line->pivot - dt * line->drift : line->pivot, arm = c->point - pivot;
        other = dt * (c->own_velocity + line->drift + (first ? -swing[0] : swing[0]) * arm +
                      swing[1] * dem_clockwise(arm));
        turn = -dt * swing[1];
    }
    const dem_parts *p = &c->part;
    const double along_n = dem_dot(a->displacement - other, p->n), turned = a->turn - turn;
    const double centres = dem_dot(a->displacement - other, p->s); /* a well holds the centre */
    const double along_s = centres + c->arm_a * a->turn + c->arm_b * b->turn;
    const double rolled = c->r_eff * turned, shear = p->spring + p->dashpot + p->slip + p->well;
    step->normal_damping -= 0.5 * p->damping * along_n;
    step->shear_damping -= 0.5 * p->dashpot * along_s;
    step->sliding -= 0.5 * p->slip * along_s;
    step->wells -= 0.5 * p->well * centres;
    step->rolling -= 0.5 * p->roll_dashpot * rolled;
    step->integration += 0.5 * (p->elastic * along_n + p->spring * along_s + p->roll_spring * rolled);
    if (c->b == 0)
        step->wall_work += 0.5 * (dem_dot((p->elastic + p->damping) * p->n + shear * p->s, other) +
                                  c->r_eff * (p->roll_spring + p->roll_dashpot) * turn);
}

/* Add the energies of a contact in the step to the sums. */
static void add_step(dem_sim *sim, const ledger_contact *c, dem_ledger step)
{
    struct dem_ledger_state *b = sim->ledger;
    if (!b->grain[c->a].present || (c->b && !b->grain[c->b].present))
        step = (dem_ledger){.taken_out = -net(&step)};
    else if (c->b == 0 && dem_wall_is_gone(sim, wall_of(c)))
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
    const double pull = -0.5 * (was->part.spring + is->part.spring) * is->sheared;
    const double roll_pull = -0.5 * (was->part.roll_spring + is->part.roll_spring) * is->rolled;
    step.sliding += pull - (is->energy.shear - was->energy.shear);
    step.rolling += roll_pull - (is->energy.rolling - was->energy.rolling);
    step.wells -= is->energy.well - was->energy.well;
    step.integration += pull + roll_pull + is->energy.normal - was->energy.normal;
    add_step(sim, was->a ? was : is, step);
}

/* The contacts of now are those of the next step's start. */
static void turn_over(dem_sim *sim)
{
    const contact_list spare = sim->ledger->old;
    sim->ledger->old = sim->ledger->now;
    sim->ledger->now = spare;
}

static void read_elastic(dem_sim *sim)
{
    const contact_list *now = &sim->ledger->now;
    for (size_t k = 0; k < now->n; k++) now->at[k].energy = dem_contact_elastic(sim, now->at[k].number);
}

void dem_ledger_step(dem_sim *sim)
{
    static const ledger_contact none;
    const contact_list *old = &sim->ledger->old, *now = &sim->ledger->now, *between = &sim->ledger->between;
    move_grains(sim);
    read_elastic(sim);
    for (size_t i = 0, j = 0; i < old->n || j < now->n;) {
        const ledger_contact *was = &old->at[i], *is = &now->at[j];
        const bool ended = i < old->n && (j == now->n || was->key < is->key);
        const bool begun = j < now->n && (i == old->n || is->key < was->key);
        settle_contact(sim, begun ? &none : was, ended ? &none : is);
        i += !begun;
        j += !ended;
    }
    for (size_t k = 0; k < between->n; k++) { /* those with one force throughout the step */
        dem_ledger step = {0};
        half_works(sim, &between->at[k], true, &step);
        half_works(sim, &between->at[k], false, &step);
        add_step(sim, &between->at[k], step);
    }
    turn_over(sim);
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
    RP_TRY(reserve_grains(sim, sim->grains.last_id + 1));
    ledger_grain *g = &b->grain[sim->grains.last_id + 1];
    *g = (ledger_grain){.present = true, .x = {p->x, p->y}, .angle = p->angle, .mass = p->m};
    g->kinetic = 0.5 * p->m * (p->vx * p->vx + p->vy * p->vy) +
                 0.5 * dem_inertia(sim->def.shape, p->m, p->r) * p->omega * p->omega;
    b->sum.put_in += g->kinetic + weight_energy(b, g);
    return RP_OK;
}

rp_status dem_ledger_alloc(dem_sim *sim)
{
    if (!(sim->ledger = calloc(1, sizeof *sim->ledger)))
        return rp_fail(RP_NO_MEMORY, "energy ledger: out of memory");
    return reserve_grains(sim, sim->grains.last_id);
}

void dem_ledger_start(dem_sim *sim)
{
    struct dem_ledger_state *b = sim->ledger;
    b->gravity = sim->gravity;
    for (size_t i = 0; i < sim->grains.n; i++) b->grain[sim->grains.id[i]] = read_grain(sim, i);
    read_elastic(sim);
    turn_over(sim);
    b->sum.start = dem_energy_now(sim);
}

rp_status dem_ledger_go_on(dem_sim *sim, const dem_ledger *sum, double before, const uint32_t ids[],
                           bool removes)
{
    struct dem_ledger_state *b = sim->ledger;
    const double gained = b->sum.start - before;
    RP_TRY(reserve_grains(sim, sim->grains.last_id));
    memset(b->grain, 0, b->capacity * sizeof *b->grain);
    for (size_t i = 0; i < sim->grains.n; i++) b->grain[sim->grains.id[i]] = read_grain(sim, i);
    for (size_t k = 0; k < b->old.n; k++) { /* ids rise with the numbers, so that the order stays */
        ledger_contact *c = &b->old.at[k];
        const uint32_t last = (uint32_t)c->key;
        c->a = ids[c->a - 1], c->b = c->b ? ids[c->b - 1] : 0;
        c->key = (uint64_t)c->a << 32 | (c->b ? c->b : last);
    }
    b->sum = *sum;
    *(removes ? &b->sum.taken_out : &b->sum.put_in) += removes ? -gained : gained;
    b->sum.turnover += fabs(gained);
    return RP_OK;
}

void dem_ledger_halt(dem_sim *sim, double before)
{
    struct dem_ledger_state *b = sim->ledger;
    dem_ledger sum = b->sum;
    dem_ledger_start(sim);
    sum.put_in += b->sum.start - before;
    sum.turnover += fabs(b->sum.start - before);
    b->sum = sum;
}

/* Grains are there or not, and every contact is one of grains and walls that there are. */
static bool contacts_exist(const dem_sim *sim)
{
    const struct dem_ledger_state *b = sim->ledger;
    bool exist = true;
    for (size_t id = 0; id <= sim->grains.last_id; id++)
        exist &= rp_keep_bool(&b->grain[id].present) && rp_keep_bool(&b->grain[id].seen);
    for (size_t k = 0; k < b->old.n; k++) {
        const ledger_contact *c = &b->old.at[k];
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
    RP_KEEP(s, b->old.n);
    rp_keep_check(s, b->old.n <= s->n / sizeof *b->old.at, "impossible contacts of the ledger");
    if (!s->status && s->reading) s->status = reserve(&b->old, b->old.n + 1);
    rp_keep(s, b->grain, (sim->grains.last_id + 1) * sizeof *b->grain);
    rp_keep(s, b->old.at, b->old.n * sizeof *b->old.at);
    rp_keep_check(s, s->status || contacts_exist(sim), "impossible contacts of the ledger");
}

void dem_ledger_free(dem_sim *sim)
{
    if (!sim->ledger) return;
    free(sim->ledger->grain), free(sim->ledger->old.at), free(sim->ledger->now.at);
    free(sim->ledger->between.at), free(sim->ledger);
}

bool dem_ledger_read(const dem_sim *sim, dem_ledger *ledger)
{
    if (!sim->ledger) return false;
    *ledger = sim->ledger->sum;
    ledger->residual = dem_energy_now(sim) - (ledger->start + net(ledger));
    return true;
}
