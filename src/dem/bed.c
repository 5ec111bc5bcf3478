/* Grains of which most are asleep; see bed.h. */
#include "dem/bed.h"

#include <math.h>
#include <stdlib.h>

enum { LINKS = 12, CHUNK = 20, RINGS = 3 };

/* A contact as one of its grains sees it: springs with the signs of that grain as `a`, force and torque on
 * it.
 */
typedef struct {
    uint32_t other; /* 0: a wall */
    int wall, well;
    double shear, roll, fx, fy, torque;
} link;

typedef struct {
    dem_grain grain;
    bool awake, gone;
    int to_wake; /* asleep: at the next change */
    long quiet;  /* steps in a row in which it could have slept */
    int n_links;
    link links[LINKS];
    uint32_t next;         /* in its cell, asleep; 0: the last */
    uint32_t local;        /* id in the part; 0: not in it */
    double from_x, from_y; /* where it was when the part was made */
    double fx, fy, torque; /* on one asleep, of what is asleep too, weight included */
} member;

struct dem_bed {
    dem_definition scene;
    dem_bed_options options;
    double margin, cell, r_max; /* way after which the part is made anew; of the grid; largest radius */
    size_t n;
    member *members; /* by id, from 1 */
    size_t columns, rows;
    uint32_t *first; /* of each cell, those asleep */
    size_t n_awake, n_part;
    uint32_t *awake, *part; /* ids awake; ids in the part, those awake first */
    dem_sim *sim;           /* of the part; NULL: to be made */
    dem_grain *grains;
    dem_contact *contacts;
    dem_state *states;
    double fastest; /* speed of those awake */
    long steps;
    double grain_steps;
};

/* ---- The grid of those asleep ---- */

static size_t clamp(double x, size_t n)
{
    return x < 0.0 ? 0 : x >= (double)n ? n - 1 : (size_t)x;
}

static size_t column_of(const dem_bed *bed, double x)
{
    return clamp((x + bed->options.x_limit) / bed->cell, bed->columns);
}

static size_t row_of(const dem_bed *bed, double y)
{
    return clamp(y / bed->cell, bed->rows);
}

static uint32_t *cell_of(const dem_bed *bed, const member *m)
{
    return &bed->first[row_of(bed, m->grain.y) * bed->columns + column_of(bed, m->grain.x)];
}

static void grid_insert(dem_bed *bed, uint32_t id)
{
    uint32_t *cell = cell_of(bed, &bed->members[id]);
    bed->members[id].next = *cell;
    *cell = id;
}

static void grid_remove(dem_bed *bed, uint32_t id)
{
    uint32_t *at = cell_of(bed, &bed->members[id]);
    while (*at != id) at = &bed->members[*at].next;
    *at = bed->members[id].next;
}

/* Call for each grain asleep in the cells around a place. */
typedef void visitor(dem_bed *bed, const member *m, uint32_t id);
static void visit_near(dem_bed *bed, const member *m, visitor *visit)
{
    const size_t c = column_of(bed, m->grain.x), r = row_of(bed, m->grain.y);
    for (size_t row = r > 0 ? r - 1 : 0; row <= r + 1 && row < bed->rows; row++)
        for (size_t column = c > 0 ? c - 1 : 0; column <= c + 1 && column < bed->columns; column++)
            for (uint32_t id = bed->first[row * bed->columns + column], next; id; id = next) {
                next = bed->members[id].next; /* it may wake */
                visit(bed, m, id);
            }
}

/* ---- Links ---- */

static void unlink_from(member *m, uint32_t other)
{
    for (int k = 0; k < m->n_links; k++)
        if (m->links[k].other == other) m->links[k--] = m->links[--m->n_links];
}

static rp_status add_link(dem_bed *bed, uint32_t id, const link *l)
{
    member *m = &bed->members[id];
    if (m->n_links == LINKS) return rp_fail(RP_BROKEN, "bed: grain %u has more than %d contacts", id, LINKS);
    m->links[m->n_links++] = *l;
    return RP_OK;
}

/* Both sides of a contact of the part. */
static rp_status note_contact(dem_bed *bed, const dem_contact *c)
{
    const uint32_t a = bed->part[c->id_a - 1], b = c->id_b ? bed->part[c->id_b - 1] : 0;
    const double dx = c->x - c->x_b, dy = c->y - c->y_b, d = sqrt(dx * dx + dy * dy);
    const double nx = dx / d, ny = dy / d, f_n = c->normal_force, f_s = c->shear_force;
    const member *m = &bed->members[a];
    const dem_ground *ground = &bed->scene.ground;
    double turn = c->shear_force; /* a well acts through the centre */
    if (c->well == DEM_WELL_HOLDS) turn += ground->mu_static * fmax(f_n, 0.0) / ground->a * c->shear_spring;
    link l = {b,
              c->wall,
              c->well,
              c->shear_spring,
              c->rolling_spring,
              f_n * nx + f_s * ny,
              f_n * ny - f_s * nx,
              (m->grain.r - (b ? 0.5 : 1.0) * c->overlap) * turn + c->rolling_torque};
    rp_status status = add_link(bed, a, &l);
    if (status || !b) return status;
    l = (link){a,
               c->wall,
               c->well,
               c->shear_spring,
               -c->rolling_spring,
               -l.fx,
               -l.fy,
               (bed->members[b].grain.r - 0.5 * c->overlap) * turn - c->rolling_torque};
    return add_link(bed, b, &l);
}

/* ---- The part that is simulated ---- */

static void take_in(dem_bed *bed, uint32_t id)
{
    member *m = &bed->members[id];
    bed->part[bed->n_part++] = id;
    m->local = (uint32_t)bed->n_part;
    m->from_x = m->grain.x;
    m->from_y = m->grain.y;
    bed->grains[m->local - 1] = m->grain;
    bed->grains[m->local - 1].fixed = !m->awake;
}

/* One asleep, which may come to touch `m`; and what holds it besides. */
static void take_in_asleep(dem_bed *bed, const member *m, uint32_t id)
{
    member *s = &bed->members[id];
    const double dx = s->grain.x - m->grain.x, dy = s->grain.y - m->grain.y,
                 reach = s->grain.r + m->grain.r + bed->margin;
    if (s->local || dx * dx + dy * dy > reach * reach) return;
    take_in(bed, id);
    s->fx = s->grain.m * bed->scene.gravity[0];
    s->fy = s->grain.m * bed->scene.gravity[1];
    s->torque = 0.0;
    for (int k = 0; k < s->n_links; k++) {
        const link *l = &s->links[k];
        if (l->other && bed->members[l->other].awake) continue;
        s->fx += l->fx;
        s->fy += l->fy;
        s->torque += l->torque;
    }
}

static dem_contact contact_of(const link *l, uint32_t a, uint32_t b)
{
    return (dem_contact){.id_a = a,
                         .id_b = b,
                         .wall = l->wall,
                         .well = l->well,
                         .shear_spring = l->shear,
                         .rolling_spring = l->roll};
}

/* Contacts of the grains awake, each once. */
static size_t gather_contacts(const dem_bed *bed)
{
    size_t n = 0;
    for (size_t k = 0; k < bed->n_awake; k++) {
        const uint32_t id = bed->awake[k];
        const member *m = &bed->members[id];
        for (int i = 0; i < m->n_links; i++) {
            const link *l = &m->links[i];
            const member *other = &bed->members[l->other];
            if (l->other && other->awake && l->other < id) continue;
            bed->contacts[n++] = contact_of(l, m->local, l->other ? other->local : 0);
        }
    }
    return n;
}

static rp_status make_part(dem_bed *bed)
{
    for (size_t k = 0; k < bed->n_part; k++) bed->members[bed->part[k]].local = 0;
    bed->n_part = 0;
    for (size_t k = 0; k < bed->n_awake; k++) take_in(bed, bed->awake[k]);
    for (size_t k = 0; k < bed->n_awake; k++) visit_near(bed, &bed->members[bed->awake[k]], take_in_asleep);
    dem_definition def = bed->scene;
    def.skin = 2.0 * bed->margin;
    def.grains = bed->grains;
    def.n_grains = bed->n_part;
    def.contacts = bed->contacts;
    def.n_contacts = gather_contacts(bed);
    rp_status status = dem_create(&def, &bed->sim);
    return status == RP_BAD_INPUT ? RP_BROKEN : status; /* the run made it so */
}

/* Bring the grains' contacts up to date with the part, and end it. */
static rp_status end_part(dem_bed *bed)
{
    dem_contact *contacts;
    size_t n;
    rp_status status = dem_contacts(bed->sim, &contacts, &n);
    for (size_t k = 0; k < bed->n_awake && !status; k++) {
        member *m = &bed->members[bed->awake[k]];
        for (int i = 0; i < m->n_links; i++)
            if (m->links[i].other) unlink_from(&bed->members[m->links[i].other], bed->awake[k]);
        m->n_links = 0;
    }
    for (size_t k = 0; k < n && !status; k++) status = note_contact(bed, &contacts[k]);
    free(contacts);
    dem_free(bed->sim);
    bed->sim = NULL;
    return status;
}

/* ---- Waking and falling asleep ---- */

static void wake(dem_bed *bed, uint32_t id)
{
    member *m = &bed->members[id];
    grid_remove(bed, id);
    m->awake = true;
    m->to_wake = 0;
    m->quiet = 0;
}

static void fall_asleep(dem_bed *bed, uint32_t id)
{
    member *m = &bed->members[id];
    m->grain.vx = m->grain.vy = m->grain.omega = 0.0;
    m->awake = false;
    grid_insert(bed, id);
}

/* About to be hit by `m` within a chunk and a half. */
static void note_hit(dem_bed *bed, const member *m, uint32_t id)
{
    member *s = &bed->members[id];
    const double dx = s->grain.x - m->grain.x, dy = s->grain.y - m->grain.y, d = sqrt(dx * dx + dy * dy);
    const double closing = (dx * m->grain.vx + dy * m->grain.vy) / d;
    if (closing > bed->options.wake_speed &&
        d - s->grain.r - m->grain.r < fmin(1.5 * CHUNK * bed->scene.dt * closing, bed->margin))
        s->to_wake = RINGS;
}

static void take_out(dem_bed *bed, uint32_t id)
{
    member *m = &bed->members[id];
    for (int k = 0; k < m->n_links; k++) {
        const uint32_t other = m->links[k].other;
        if (!other) continue;
        unlink_from(&bed->members[other], id);
        if (!bed->members[other].awake) bed->members[other].to_wake = 1;
    }
    m->n_links = 0;
    m->gone = true;
    m->awake = false;
}

static bool out_of_balance(double fx, double fy, double torque, double r, double most)
{
    return !(fx * fx + fy * fy <= most * most && fabs(torque) <= most * r);
}

static double weight_of(const dem_bed *bed, const member *m)
{
    const double *g = bed->scene.gravity;
    return m->grain.m * sqrt(g[0] * g[0] + g[1] * g[1]);
}

/* Take over the state of one awake, `steps` later; false where the part must be made anew. */
static bool follow(dem_bed *bed, member *m, const dem_state *s, long steps)
{
    const dem_bed_options *o = &bed->options;
    const double dx = s->x - m->from_x, dy = s->y - m->from_y, speed2 = s->vx * s->vx + s->vy * s->vy;
    const double way = sqrt(dx * dx + dy * dy) + 1.5 * CHUNK * bed->scene.dt * sqrt(speed2),
                 turn = s->omega * s->omega * s->r * s->r, slow2 = o->sleep_speed * o->sleep_speed;
    const bool quiet = speed2 < slow2 && turn < slow2 &&
                       !out_of_balance(s->fx, s->fy, s->torque, s->r, o->sleep_force * weight_of(bed, m));
    m->grain.x = s->x, m->grain.y = s->y, m->grain.vx = s->vx, m->grain.vy = s->vy;
    m->grain.angle = s->angle, m->grain.omega = s->omega;
    m->quiet = quiet ? m->quiet + steps : 0;
    bed->fastest = fmax(bed->fastest, sqrt(speed2));
    if (speed2 > o->wake_speed * o->wake_speed) visit_near(bed, m, note_hit);
    return way < bed->margin && fabs(s->x) <= o->x_limit;
}

/* Read the part's states; true where the part must be made anew, for one to wake or leave, or too far away.
 */
static bool look(dem_bed *bed, long steps)
{
    bool stale = false;
    bed->fastest = 0.0;
    for (size_t k = 0; k < bed->n_awake; k++)
        stale |= !follow(bed, &bed->members[bed->part[k]], &bed->states[k], steps);
    for (size_t k = bed->n_awake; k < bed->n_part; k++) {
        member *m = &bed->members[bed->part[k]];
        const dem_state *s = &bed->states[k];
        if (out_of_balance(m->fx + s->fx, m->fy + s->fy, m->torque + s->torque, m->grain.r,
                           bed->options.wake_force * weight_of(bed, m)) &&
            m->to_wake == 0)
            m->to_wake = 1;
        stale |= m->to_wake > 0;
    }
    return stale;
}

static bool could_sleep(const dem_bed *bed, const member *m)
{
    return (double)m->quiet * bed->scene.dt > bed->options.sleep_time;
}

static size_t count_quiet(const dem_bed *bed)
{
    size_t n = 0;
    for (size_t k = 0; k < bed->n_awake; k++) n += could_sleep(bed, &bed->members[bed->awake[k]]);
    return n;
}

/* What is hit takes along those around it, ring by ring: they would be an anvil to it otherwise. */
static void spread(dem_bed *bed)
{
    for (int ring = RINGS; ring > 1; ring--)
        for (uint32_t id = 1; id <= bed->n; id++) {
            const member *m = &bed->members[id];
            for (int k = 0; k < m->n_links && m->to_wake == ring; k++) {
                member *other = &bed->members[m->links[k].other];
                if (m->links[k].other && !other->awake && other->to_wake < ring) other->to_wake = ring - 1;
            }
        }
}

/* Who is awake from here on. */
static void choose(dem_bed *bed)
{
    for (size_t k = 0; k < bed->n_awake; k++) {
        const member *m = &bed->members[bed->awake[k]];
        if (fabs(m->grain.x) > bed->options.x_limit)
            take_out(bed, bed->awake[k]);
        else if (bed->options.sleep && could_sleep(bed, m))
            fall_asleep(bed, bed->awake[k]);
    }
    bed->n_awake = 0;
    spread(bed);
    for (uint32_t id = 1; id <= bed->n; id++) {
        if (bed->members[id].to_wake) wake(bed, id);
        if (bed->members[id].awake) bed->awake[bed->n_awake++] = id;
    }
}

/* Before the first part: who will be hit by those put in? */
static void foresee(dem_bed *bed)
{
    for (size_t k = 0; k < bed->n_awake; k++) {
        const member *m = &bed->members[bed->awake[k]];
        bed->fastest = fmax(bed->fastest, sqrt(m->grain.vx * m->grain.vx + m->grain.vy * m->grain.vy));
        visit_near(bed, m, note_hit);
    }
    choose(bed);
}

/* As many steps as none goes farther in than a part's margin. */
static long chunk_steps(const dem_bed *bed)
{
    const double most = bed->margin / (1.5 * bed->scene.dt * fmax(bed->fastest, 1e-300));
    return most > CHUNK ? CHUNK : most > 1.0 ? (long)most : 1;
}

rp_status dem_bed_run(dem_bed *bed, long most, bool *rest)
{
    const long end = bed->steps + most;
    rp_status status = RP_OK;
    foresee(bed);
    while (!status && bed->n_awake > 0 && bed->steps < end) {
        const long steps = chunk_steps(bed);
        if (!bed->sim) status = make_part(bed);
        if (!status) status = dem_run(bed->sim, steps);
        if (!status) status = dem_states(bed->sim, bed->states);
        if (status) break;
        bed->steps += steps;
        bed->grain_steps += (double)steps * (double)bed->n_awake;
        const bool stale = look(bed, steps);
        const size_t quiet = count_quiet(bed);
        if (!bed->options.sleep && quiet == bed->n_awake) break;
        if (!stale && (!bed->options.sleep || 4 * quiet < bed->n_awake)) continue;
        status = end_part(bed);
        if (!status) choose(bed);
    }
    if (!status && bed->sim) status = end_part(bed);
    *rest = count_quiet(bed) == bed->n_awake;
    if (status || !bed->options.sleep) return status;
    for (size_t k = 0; k < bed->n_awake; k++) fall_asleep(bed, bed->awake[k]);
    bed->n_awake = 0;
    return RP_OK;
}

/* ---- Life ---- */

rp_status dem_bed_create(const dem_definition *scene, const dem_bed_options *options, dem_bed **out)
{
    const size_t n = options->most + 1;
    dem_bed *bed = *out = calloc(1, sizeof *bed);
    if (!bed) return rp_fail(RP_NO_MEMORY, "bed: out of memory");
    bed->scene = *scene;
    bed->options = *options;
    bed->members = calloc(n, sizeof *bed->members);
    bed->awake = calloc(n, sizeof *bed->awake);
    bed->part = calloc(n, sizeof *bed->part);
    bed->grains = calloc(n, sizeof *bed->grains);
    bed->states = calloc(n, sizeof *bed->states);
    bed->contacts = calloc(n * LINKS, sizeof *bed->contacts);
    if (bed->members && bed->awake && bed->part && bed->grains && bed->states && bed->contacts) return RP_OK;
    dem_bed_free(bed);
    *out = NULL;
    return rp_fail(RP_NO_MEMORY, "bed: out of memory");
}

void dem_bed_free(dem_bed *bed)
{
    if (!bed) return;
    dem_free(bed->sim);
    free(bed->members), free(bed->awake), free(bed->part), free(bed->grains), free(bed->states);
    free(bed->contacts), free(bed->first), free(bed);
}

/* The grid, for the largest radius so far. */
static rp_status make_grid(dem_bed *bed, double r_max)
{
    bed->r_max = r_max;
    bed->margin = 0.6 * r_max;
    bed->cell = 2.0 * r_max + bed->margin;
    bed->columns = (size_t)(2.0 * bed->options.x_limit / bed->cell) + 1;
    bed->rows = 128;
    free(bed->first);
    bed->first = calloc(bed->columns * bed->rows, sizeof *bed->first);
    if (!bed->first) return rp_fail(RP_NO_MEMORY, "bed: out of memory");
    for (uint32_t id = 1; id <= bed->n; id++)
        if (!bed->members[id].awake && !bed->members[id].gone) grid_insert(bed, id);
    return RP_OK;
}

rp_status dem_bed_add(dem_bed *bed, const dem_grain *grain)
{
    if (bed->n == bed->options.most) return rp_fail(RP_BAD_INPUT, "bed: at most %zu grains", bed->n);
    rp_status status = grain->r > bed->r_max ? make_grid(bed, grain->r) : RP_OK;
    if (status) return status;
    bed->members[++bed->n] = (member){.grain = *grain, .awake = true};
    bed->awake[bed->n_awake++] = (uint32_t)bed->n;
    return RP_OK;
}

/* ---- Observers ---- */

long dem_bed_steps(const dem_bed *bed)
{
    return bed->steps;
}

double dem_bed_grain_steps(const dem_bed *bed)
{
    return bed->grain_steps;
}

size_t dem_bed_count(const dem_bed *bed)
{
    return bed->n;
}

const dem_grain *dem_bed_grain(const dem_bed *bed, uint32_t id)
{
    return bed->members[id].gone ? NULL : &bed->members[id].grain;
}

double dem_bed_height(const dem_bed *bed, double x, double r, double gap)
{
    double y = r + gap;
    for (uint32_t id = 1; id <= bed->n; id++) {
        const dem_grain *g = &bed->members[id].grain;
        const double dx = g->x - x, reach = r + g->r + gap;
        if (!bed->members[id].gone && fabs(dx) < reach) y = fmax(y, g->y + sqrt(reach * reach - dx * dx));
    }
    return y;
}

rp_status dem_bed_sim(const dem_bed *bed, dem_sim **sim)
{
    dem_definition def = bed->scene;
    uint32_t *local = calloc(bed->n + 1, sizeof *local);
    if (!local) return rp_fail(RP_NO_MEMORY, "bed: out of memory");
    for (uint32_t id = 1; id <= bed->n; id++) {
        if (bed->members[id].gone) continue;
        bed->grains[def.n_grains] = bed->members[id].grain;
        local[id] = (uint32_t)++def.n_grains;
    }
    for (uint32_t id = 1; id <= bed->n; id++)
        for (int k = 0; k < bed->members[id].n_links; k++) {
            const link *l = &bed->members[id].links[k];
            if (l->other < id && l->other) continue;
            bed->contacts[def.n_contacts++] = contact_of(l, local[id], local[l->other]);
        }
    def.grains = bed->grains;
    def.contacts = bed->contacts;
    rp_status status = dem_create(&def, sim);
    free(local);
    return status;
}
