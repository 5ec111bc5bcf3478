/* Neighbour list. Grains are kept in the order of square cells that wrap around (so that no scene is too
 * large for them). Each grain has a margin, how far it may go until the list is rebuilt; each pair closer
 * than touching and their margins has a slot, and each grain as near to a wall. A rebuilding carries the
 * springs of touching contacts over. It is a function of the state alone. Where few grains go far, only their
 * pairs are looked for anew, behind the others. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dem/sim.h"

/* Work space of a rebuilding, all allocated beforehand but for the lists that grow. */
struct dem_scratch {
    size_t cells_x, cells_y; /* powers of two */
    uint32_t *cell_start;    /* cells + 1 */
    uint32_t *cell;          /* of each grain */
    uint32_t *moved_to;      /* new place of each grain; UINT32_MAX where it is gone */
    dem_record *grain;
    dem_vec *force;
    dem_gear *gear;
    double *radius, *mass, *inverse_mass;
    uint32_t *id;
    double *angle, *omega, *inverse_inertia;
    uint32_t *apart; /* pairs on their way to the end of the list */
    size_t apart_room;
    dem_push *push;
    /* springs of touching pairs, a chain for the lower new index of the two grains */
    uint32_t *held_first, *held_next; /* UINT32_MAX after the last */
    uint32_t *held_partner;
    double *held_spring, *held_roll;
    size_t held_room;
    uint32_t *wall_held; /* old wall slot of each grain, UINT32_MAX for none */
    dem_wall_slot *wall_slot;
    size_t wall_room;
};

/* What a grain takes along to another place, in arrays of the simulation and of the work space alike, NULL
 * where a scene has none. */
#define CARRIED_LIST(X)                                                                                      \
    X(dem_record, grain)                                                                                     \
    X(dem_vec, force)                                                                                        \
    X(dem_gear, gear)                                                                                        \
    X(double, radius)                                                                                        \
    X(double, mass)                                                                                          \
    X(double, inverse_mass)                                                                                  \
    X(uint32_t, id)                                                                                          \
    X(double, angle)                                                                                         \
    X(double, omega)                                                                                         \
    X(double, inverse_inertia)                                                                               \
    X(dem_push, push)

static const uint32_t NOWHERE = UINT32_MAX;

/* How far a grain may go before the list is rebuilt: half the skin, or where the skin was left open, more
 * than it goes in so many steps at its speed, within bounds in mean radii. Few fast grains then neither ask
 * for frequent rebuildings nor bring all the others a list of pairs that are far from touching. */
static double margin(const dem_sim *sim, double speed)
{
    const bool hard = sim->def.hard.on; /* few disks fall onto many at rest */
    const double STEPS = hard ? 50.0 : 25.0, LEAST = 0.08, MOST = hard ? 1.5 : 1.0;
    return sim->even_margins
               ? 0.5 * sim->skin
               : fmin(LEAST * sim->radius_mean + STEPS * sim->def.dt * speed, MOST * sim->radius_mean);
}

static size_t power_of_two(double at_least, size_t most)
{
    size_t p = 4; /* three neighbouring columns must differ */
    while ((double)p < at_least && p < most) p *= 2;
    return p;
}

/* The cells' number follows the extent at the start, and stays below some four a grain. */
static void size_cells(dem_sim *sim, struct dem_scratch *w)
{
    double lo[2] = {INFINITY, INFINITY}, hi[2] = {-INFINITY, -INFINITY};
    for (size_t i = 0; i < sim->n; i++)
        for (int a = 0; a < 2; a++) {
            lo[a] = fmin(lo[a], sim->grain[i].x[a]);
            hi[a] = fmax(hi[a], sim->grain[i].x[a]);
        }
    const double size = 2.0 * (sim->r_max + margin(sim, 0.0));
    const size_t most = (size_t)1 << 14;
    w->cells_x = power_of_two((hi[0] - lo[0]) / size + 2.0, most);
    w->cells_y = power_of_two((hi[1] - lo[1]) / size + 2.0, most);
    while (w->cells_x * w->cells_y > 4 * sim->n + 64 && (w->cells_x > 4 || w->cells_y > 4))
        if (w->cells_x > w->cells_y)
            w->cells_x /= 2;
        else
            w->cells_y /= 2;
}

/* Like dem_grow, of an array of dem_array, and only the first `held` items stay. */
static bool lengthen(void *array, size_t size, size_t held, size_t room)
{
    void *old = *(void **)array, *more = dem_array(room, size);
    if (!more) return false;
    if (held > 0) memcpy(more, old, size * held);
    free(old);
    *(void **)array = more;
    return true;
}

static rp_status pair_room(dem_sim *sim, size_t more)
{
    if (sim->n_pairs + more + 8 <= sim->pair_room) return RP_OK;
    const size_t held = sim->n_pairs, room = sim->pair_room = 9 * (sim->n_pairs + more) / 512 * 64 + 128;
    if (lengthen(&sim->pair_i, sizeof *sim->pair_i, held, room) &&
        lengthen(&sim->pair_j, sizeof *sim->pair_j, held, room) &&
        lengthen(&sim->touching, sizeof *sim->touching, (held + 63) / 64, room / 64) &&
        lengthen(&sim->pair_radii, sizeof *sim->pair_radii, held, room) &&
        lengthen(&sim->pair_mass, sizeof *sim->pair_mass, held, room) &&
        lengthen(&sim->spring, sizeof *sim->spring, held, room) &&
        (!sim->omega || (lengthen(&sim->radius_i, sizeof *sim->radius_i, held, room) &&
                         lengthen(&sim->radius_j, sizeof *sim->radius_j, held, room) &&
                         lengthen(&sim->roll_radius, sizeof *sim->roll_radius, held, room))) &&
        (!sim->rolling || lengthen(&sim->roll, sizeof *sim->roll, held, room)))
        return RP_OK;
    return rp_fail(RP_NO_MEMORY, "neighbour list: out of memory");
}

/* Fill the last of the groups that kernels may take at once with pairs that never touch. */
static void pad_pairs(dem_sim *sim)
{
    for (size_t k = sim->n_pairs; k < (sim->n_pairs + 7) / 8 * 8; k++) {
        sim->pair_i[k] = sim->pair_j[k] = 0;
        sim->pair_radii[k] = sim->pair_mass[k] = sim->spring[k] = 0.0;
        if (sim->omega) sim->radius_i[k] = sim->radius_j[k] = sim->roll_radius[k] = 0.0;
    }
}

/* A grain is done where no pair of a later chunk has it. After cells wrapped around, or as pairs have been
 * renamed, that may be so of few before the end. */
static rp_status plan_chunks(dem_sim *sim)
{
    enum { LEAST = 6 }; /* fewer fit into the cache together */
    const size_t n = (sim->n_pairs + sim->chunk - 1) / sim->chunk;
    sim->n_chunks = 0;
    if (n < LEAST) return RP_OK;
    if (n > sim->chunk_room && !dem_grow(&sim->done, sizeof *sim->done, sim->chunk_room = 2 * n))
        return rp_fail(RP_NO_MEMORY, "neighbour list: out of memory");
    uint32_t done = (uint32_t)sim->n;
    for (size_t c = n, end = sim->n_pairs; c-- > 0; end = c * sim->chunk) {
        sim->done[c] = c + 1 == n ? done : done / DEM_GROUP * DEM_GROUP;
        for (size_t k = c * sim->chunk; k < end; k++) {
            const uint32_t i = sim->pair_i[k], j = sim->pair_j[k], first = i < j ? i : j;
            done = first < done ? first : done;
        }
    }
    sim->n_chunks = n;
    return RP_OK;
}

static rp_status copy_lists(dem_sim *sim, const dem_sim *like)
{
    sim->n_pairs = sim->pair_room = 0;
    rp_status status = pair_room(sim, like->n_pairs + 1); /* so that the arrays exist */
    sim->wall_room = like->n_wall_slots + 1;
    if (status || !dem_grow(&sim->wall_slot, sizeof *sim->wall_slot, sim->wall_room))
        return rp_fail(RP_NO_MEMORY, "neighbour list: out of memory");
    sim->n_pairs = like->n_pairs;
    memcpy(sim->pair_i, like->pair_i, sim->n_pairs * sizeof *sim->pair_i);
    memcpy(sim->pair_j, like->pair_j, sim->n_pairs * sizeof *sim->pair_j);
    memcpy(sim->touching, like->touching, (sim->n_pairs + 63) / 64 * sizeof *sim->touching);
    memcpy(sim->pair_radii, like->pair_radii, sim->n_pairs * sizeof *sim->pair_radii);
    memcpy(sim->pair_mass, like->pair_mass, sim->n_pairs * sizeof *sim->pair_mass);
    memcpy(sim->spring, like->spring, sim->n_pairs * sizeof *sim->spring);
    if (sim->omega) {
        memcpy(sim->radius_i, like->radius_i, sim->n_pairs * sizeof *sim->radius_i);
        memcpy(sim->radius_j, like->radius_j, sim->n_pairs * sizeof *sim->radius_j);
        memcpy(sim->roll_radius, like->roll_radius, sim->n_pairs * sizeof *sim->roll_radius);
    }
    if (sim->rolling) memcpy(sim->roll, like->roll, sim->n_pairs * sizeof *sim->roll);
    pad_pairs(sim);
    if (sim->n_wall_slots)
        memcpy(sim->wall_slot, like->wall_slot, sim->n_wall_slots * sizeof *sim->wall_slot);
    return like->n_chunks > 0 ? plan_chunks(sim) : RP_OK;
}

rp_status dem_neighbours_alloc(dem_sim *sim, const dem_sim *like)
{
    struct dem_scratch *w = sim->scratch = calloc(1, sizeof *w);
    if (!w) return rp_fail(RP_NO_MEMORY, "neighbour list: out of memory");
    const size_t n = sim->room + 8; /* as in sim.c */
    if (like) {
        w->cells_x = like->scratch->cells_x;
        w->cells_y = like->scratch->cells_y;
        while (sim->room > like->room && 4 * w->cells_x * w->cells_y < sim->n)
            *(w->cells_x < w->cells_y ? &w->cells_x : &w->cells_y) *= 2; /* grains were put in */
    } else {
        size_cells(sim, w);
    }
    w->cell_start = calloc(w->cells_x * w->cells_y + 1, sizeof *w->cell_start);
    w->cell = dem_array(n, sizeof *w->cell);
    w->moved_to = dem_array(n, sizeof *w->moved_to);
    w->grain = dem_array(n, sizeof *w->grain);
    if (!sim->def.rotation) w->force = dem_array(n, sizeof *w->force);
    if (sim->gear) w->gear = dem_array(n, sizeof *w->gear);
    w->radius = dem_array(n, sizeof *w->radius);
    w->mass = dem_array(n, sizeof *w->mass);
    w->inverse_mass = dem_array(n, sizeof *w->inverse_mass);
    w->id = dem_array(n, sizeof *w->id);
    if (sim->def.rotation) {
        w->angle = dem_array(n, sizeof *w->angle);
        w->omega = dem_array(n, sizeof *w->omega);
        w->inverse_inertia = dem_array(n, sizeof *w->inverse_inertia);
        w->push = dem_array(n, sizeof *w->push);
    }
    w->held_first = malloc(n * sizeof *w->held_first);
    w->wall_held = malloc(n * sizeof *w->wall_held);
    if (!w->cell_start || !w->cell || !w->moved_to || !w->grain || !w->radius || !w->mass ||
        !w->inverse_mass || !w->id || !w->held_first || !w->wall_held || (sim->gear && !w->gear) ||
        (sim->def.rotation ? !w->angle || !w->omega || !w->inverse_inertia || !w->push : !w->force))
        return rp_fail(RP_NO_MEMORY, "neighbour list: out of memory");
    memset(w->wall_held, 0xff, n * sizeof *w->wall_held);
    return like ? copy_lists(sim, like) : RP_OK;
}

void dem_neighbours_free(dem_sim *sim)
{
    struct dem_scratch *w = sim->scratch;
    if (!w) return;
    free(w->cell_start), free(w->cell), free(w->moved_to), free(w->grain), free(w->force), free(w->radius);
    free(w->mass), free(w->inverse_mass), free(w->id), free(w->held_first), free(w->held_next),
        free(w->held_partner);
    free(w->held_spring), free(w->held_roll), free(w->wall_held), free(w->wall_slot), free(w->angle),
        free(w->omega), free(w->inverse_inertia), free(w->apart), free(w->push);
    free(w->gear), free(w);
    sim->scratch = NULL;
}

/* What must hold of a grain when its part of the list is rebuilt; its speed into *fastest if that is larger.
 */
static rp_status check_grain(dem_sim *sim, size_t i, double *fastest)
{
    const double size = 2.0 * sim->r_max + sim->skin;
    dem_vec x = sim->grain[i].x, v = sim->grain[i].v;
    if (!isfinite(x[0] + x[1] + v[0] + v[1]))
        return dem_stop(sim, DEM_FAULT_NON_FINITE, i, "a number is not finite");
    const double speed = sqrt(dem_dot(v, v)), travel = speed * sim->def.dt;
    *fastest = fmax(*fastest, speed);
    if (travel > sim->radius[i])
        return dem_stop(sim, DEM_FAULT_TOO_FAST, i, "moves %g in one step, its radius is %g", travel,
                        sim->radius[i]);
    if (fabs(x[0]) > 1e9 * size || fabs(x[1]) > 1e9 * size)
        return dem_stop(sim, DEM_FAULT_LEAKED, i, "far away at x = %g, y = %g", x[0], x[1]);
    for (size_t k = 0; k < sim->def.n_walls && sim->inverse_mass[i] > 0.0; k++) {
        const dem_wall *wall = &sim->def.walls[k];
        bool line = isinf(wall->extent[0]) && isinf(wall->extent[1]);
        bool open = wall->open_at_step >= 0 && sim->step >= wall->open_at_step;
        if (line && !open && dem_dot(x - sim->wall[k].point, sim->wall[k].direction) < 0.0)
            return dem_stop(sim, DEM_FAULT_LEAKED, i, "behind wall %zu at x = %g, y = %g", k + 1, x[0], x[1]);
    }
    return RP_OK;
}

/* Its place and margin in the list are those of now. */
static void mark_grain(dem_sim *sim, size_t i)
{
    const dem_record *grain = &sim->grain[i];
    const double most = margin(sim, sqrt(dem_dot(grain->v, grain->v)));
    sim->ref[i] = grain->x;
    sim->margin2[i] = most * most;
    sim->reach[i] = sim->radius[i] + most;
    sim->slack[i / DEM_GROUP] = 0.0;
}

/* Drop the grains that left and sort the rest by square cells of that size, keeping their order within one.
 */
static void sort_grains(dem_sim *sim, double size)
{
    struct dem_scratch *w = sim->scratch;
    const double inverse_size = 1.0 / size;
    const size_t cells = w->cells_x * w->cells_y;
    memset(w->cell_start, 0, (cells + 1) * sizeof *w->cell_start);
    for (size_t i = 0; i < sim->n; i++) {
        dem_vec x = sim->grain[i].x;
        if (dem_beyond(sim, x)) {
            w->cell[i] = NOWHERE;
            continue;
        }
        size_t cx = (size_t)(long)floor(x[0] * inverse_size) & (w->cells_x - 1);
        size_t cy = (size_t)(long)floor(x[1] * inverse_size) & (w->cells_y - 1);
        w->cell[i] = (uint32_t)(cy * w->cells_x + cx);
        w->cell_start[w->cell[i] + 1]++;
    }
    for (size_t c = 0; c < cells; c++) w->cell_start[c + 1] += w->cell_start[c];
    for (size_t i = 0; i < sim->n; i++) {
        if (w->cell[i] == NOWHERE) {
            w->moved_to[i] = NOWHERE;
            continue;
        }
        /* cell_start moves up as its cell fills, and is moved back below */
        size_t to = w->moved_to[i] = w->cell_start[w->cell[i]]++;
#define X(type, field)                                                                                       \
    if (sim->field) w->field[to] = sim->field[i];
        CARRIED_LIST(X)
#undef X
    }
    for (size_t c = cells; c > 0; c--) w->cell_start[c] = w->cell_start[c - 1];
    w->cell_start[0] = 0;
    sim->n = w->cell_start[cells];
#define X(type, field)                                                                                       \
    do {                                                                                                     \
        type *swap_ = sim->field;                                                                            \
        sim->field = w->field;                                                                               \
        w->field = swap_;                                                                                    \
    } while (0);
    CARRIED_LIST(X)
#undef X
    sim->n_fixed = 0;
    for (size_t i = 0; i < sim->n; i++) {
        mark_grain(sim, i);
        if (sim->inverse_mass[i] == 0.0) sim->fixed[sim->n_fixed++] = (uint32_t)i;
    }
}

/* Of a place, its distance from the origin squared, at most. */
static double round_off(const dem_sim *sim, double far2)
{
    return 1e-15 * (sqrt(far2) + sim->skin);
}

/* A wall that turns may come nearer to the farthest grain by half the skin; the grain has its margin beside
 * that. (A margin can be above that half, and a grain go along the wall to where it turns faster, but then it
 * does not go towards the wall so far.) */
static void measure_room(dem_sim *sim)
{
    double far2 = 0.0;
    for (size_t i = 0; i < sim->n; i++) far2 = fmax(far2, dem_dot(sim->grain[i].x, sim->grain[i].x));
    sim->box_room = 0.5 * sim->skin / (sqrt(far2) + sim->skin);
    sim->box_swept = 0.0;
    sim->round_off = round_off(sim, far2);
}

/* Keep the springs of touching pairs. */
static rp_status hold_springs(dem_sim *sim)
{
    struct dem_scratch *w = sim->scratch;
    const size_t most = dem_count_touching(sim);
    if (most > w->held_room) {
        w->held_room = most + most / 2;
        if (!dem_grow(&w->held_next, sizeof *w->held_next, w->held_room) ||
            !dem_grow(&w->held_partner, sizeof *w->held_partner, w->held_room) ||
            !dem_grow(&w->held_spring, sizeof *w->held_spring, w->held_room) ||
            (sim->rolling && !dem_grow(&w->held_roll, sizeof *w->held_roll, w->held_room)))
            return rp_fail(RP_NO_MEMORY, "neighbour list: out of memory");
    }
    memset(w->held_first, 0xff, sim->n * sizeof *w->held_first);
    uint32_t n = 0;
    DEM_EACH_TOUCHING (sim, k) {
        const uint32_t a = w->moved_to[sim->pair_i[k]], b = w->moved_to[sim->pair_j[k]];
        if (a == NOWHERE || b == NOWHERE || (sim->spring[k] == 0.0 && !sim->rolling)) continue;
        const uint32_t low = a < b ? a : b;
        w->held_partner[n] = a < b ? b : a;
        w->held_spring[n] = sim->spring[k];
        if (sim->rolling) w->held_roll[n] = a < b ? sim->roll[k] : -sim->roll[k];
        w->held_next[n] = w->held_first[low];
        w->held_first[low] = n++;
    }
    return RP_OK;
}

/* Give pair k of grains a and b the springs it held before. */
static void restore_springs(dem_sim *sim, size_t k, uint32_t a, uint32_t b)
{
    const struct dem_scratch *w = sim->scratch;
    uint32_t low = a < b ? a : b, high = a < b ? b : a;
    for (uint32_t at = w->held_first[low]; at != NOWHERE; at = w->held_next[at])
        if (w->held_partner[at] == high) {
            sim->spring[k] = w->held_spring[at];
            /* it is i's turn against j, where the shear displacement does not ask who is i */
            if (sim->rolling) sim->roll[k] = a < b ? w->held_roll[at] : -w->held_roll[at];
            return;
        }
}

/* Pairs of grain i with grains from..to. Each is written, and kept where near, without a branch. */
static void add_near(dem_sim *sim, size_t i, size_t from, size_t to)
{
    const dem_vec x = sim->ref[i];
    const double own = sim->reach[i], inverse_mass = sim->inverse_mass[i];
    uint32_t *restrict pair_i = sim->pair_i, *restrict pair_j = sim->pair_j;
    size_t k = sim->n_pairs;
    for (size_t j = from; j < to; j++) {
        dem_vec d = x - sim->ref[j];
        const double reach = own + sim->reach[j];
        pair_i[k] = (uint32_t)i;
        pair_j[k] = (uint32_t)j;
        /* not where both are fixed */
        k += (dem_dot(d, d) < reach * reach) & (inverse_mass + sim->inverse_mass[j] > 0.0);
    }
    sim->n_pairs = k;
}

/* The rest of what the pairs from k on hold; springs are 0. */
static void complete_pairs(dem_sim *sim, size_t k)
{
    for (; k < sim->n_pairs; k++) {
        const size_t i = sim->pair_i[k], j = sim->pair_j[k];
        double radii = sim->radius[i] + sim->radius[j], m_i = sim->mass[i], m_j = sim->mass[j];
        sim->pair_radii[k] = radii;
        sim->pair_mass[k] = sim->inverse_mass[i] == 0.0   ? m_j
                            : sim->inverse_mass[j] == 0.0 ? m_i
                                                          : m_i * m_j / (m_i + m_j);
        sim->spring[k] = 0.0;
        if (sim->omega) {
            const double r_i = sim->radius[i], r_j = sim->radius[j];
            sim->radius_i[k] = r_i, sim->radius_j[k] = r_j, sim->roll_radius[k] = r_i * r_j / radii;
        }
        if (sim->rolling) sim->roll[k] = 0.0;
    }
}

static void find_touching(dem_sim *sim)
{
    uint64_t *restrict touching = sim->touching, word = 0;
    for (size_t k = 0; k < sim->n_pairs; k++) {
        dem_vec d = sim->grain[sim->pair_i[k]].x - sim->grain[sim->pair_j[k]].x;
        dem_note(touching, k, dem_dot(d, d) < sim->pair_radii[k] * sim->pair_radii[k], &word);
    }
}

/* Pairs of the grains of each cell with those after them, and with those of the next cell and of the three
 * above; cells that follow one another are taken as one. */
/* The pairs that touch first, both parts in their order: most stay so, and a block of the pair loop is then
 * full of them or left at once. */
static rp_status part_pairs(dem_sim *sim)
{
    struct dem_scratch *w = sim->scratch;
    if (sim->n_pairs > w->apart_room &&
        !dem_grow(&w->apart, 2 * sizeof *w->apart, w->apart_room = 2 * sim->n_pairs))
        return rp_fail(RP_NO_MEMORY, "neighbour list: out of memory");
    size_t touching = 0, apart = 0;
    for (size_t k = 0; k < sim->n_pairs; k++) {
        const uint32_t i = sim->pair_i[k], j = sim->pair_j[k];
        const dem_vec d = sim->grain[i].x - sim->grain[j].x;
        const double radii = sim->radius[i] + sim->radius[j];
        if (dem_dot(d, d) < radii * radii) {
            sim->pair_i[touching] = i;
            sim->pair_j[touching++] = j;
        } else {
            w->apart[2 * apart] = i;
            w->apart[2 * apart++ + 1] = j;
        }
    }
    for (size_t k = 0; k < apart; k++) {
        sim->pair_i[touching + k] = w->apart[2 * k];
        sim->pair_j[touching + k] = w->apart[2 * k + 1];
    }
    return RP_OK;
}

static rp_status find_pairs(dem_sim *sim)
{
    struct dem_scratch *w = sim->scratch;
    const size_t mask_x = w->cells_x - 1, mask_y = w->cells_y - 1;
    dem_near *const add = sim->near ? sim->near : add_near;
    sim->n_pairs = 0;
    for (size_t cy = 0, c = 0; cy < w->cells_y; cy++)
        for (size_t cx = 0; cx < w->cells_x; cx++, c++) {
            const size_t up = ((cy + 1) & mask_y) * w->cells_x;
            const size_t half[4] = {cy * w->cells_x + ((cx + 1) & mask_x), up + ((cx - 1) & mask_x), up + cx,
                                    up + ((cx + 1) & mask_x)};
            size_t from[5] = {0}, to[5] = {w->cell_start[c + 1]}, n = 1, most = to[0] - w->cell_start[c];
            for (int a = 0; a < 4; a++) {
                const size_t first = w->cell_start[half[a]], end = w->cell_start[half[a] + 1];
                most += end - first;
                if (first != to[n - 1]) from[n++] = first;
                to[n - 1] = end;
            }
            for (size_t i = w->cell_start[c]; i < w->cell_start[c + 1]; i++) {
                rp_status status = pair_room(sim, most);
                if (status) return status;
                add(sim, i, i + 1, to[0]);
                for (size_t a = 1; a < n; a++) add(sim, i, from[a], to[a]);
            }
        }
    rp_status status = sim->def.hard.on ? part_pairs(sim) : RP_OK;
    if (status) return status;
    complete_pairs(sim, 0);
    find_touching(sim);
    DEM_EACH_TOUCHING (sim, k) restore_springs(sim, k, sim->pair_i[k], sim->pair_j[k]);
    return RP_OK;
}

static void mark_walls(dem_sim *sim)
{
    for (size_t w = 0, k = 0; w <= sim->def.n_walls; w++) {
        while (k < sim->n_wall_slots && sim->wall_slot[k].wall < w) k++;
        sim->wall_start[w] = k;
    }
}

/* Slots of grains near a wall's line; a wall that is gone has none. */
static rp_status find_wall_slots(dem_sim *sim)
{
    struct dem_scratch *w = sim->scratch;
    const size_t n_old = sim->n_wall_slots;
    const bool turns = sim->def.box_turn_per_step != 0.0 && sim->step >= sim->box_from_step;
    const double turn = turns ? 0.5 * sim->skin : 0.0;
    if (n_old > w->wall_room && !dem_grow(&w->wall_slot, sizeof *w->wall_slot, w->wall_room = sim->wall_room))
        return rp_fail(RP_NO_MEMORY, "neighbour list: out of memory");
    if (n_old) memcpy(w->wall_slot, sim->wall_slot, n_old * sizeof *w->wall_slot);
    sim->n_wall_slots = 0;
    for (uint32_t k = 0; k < sim->def.n_walls; k++) {
        const dem_wall *wall = &sim->def.walls[k];
        if (wall->open_at_step >= 0 && sim->step >= wall->open_at_step && isinf(wall->open_speed)) continue;
        const dem_vec direction = sim->wall[k].direction, point = sim->wall[k].point;
        for (uint32_t s = 0; s < n_old; s++)
            if (w->wall_slot[s].wall == k && w->moved_to[w->wall_slot[s].grain] != NOWHERE)
                w->wall_held[w->moved_to[w->wall_slot[s].grain]] = s;
        for (uint32_t i = 0; i < sim->n; i++) {
            double distance = dem_dot(sim->ref[i] - point, direction);
            uint32_t held = w->wall_held[i];
            w->wall_held[i] = NOWHERE;
            if (!(fabs(distance) < sim->reach[i] + turn) || sim->inverse_mass[i] == 0.0) continue;
            if (sim->n_wall_slots == sim->wall_room &&
                !dem_grow(&sim->wall_slot, sizeof *sim->wall_slot, sim->wall_room = 2 * sim->wall_room + 64))
                return rp_fail(RP_NO_MEMORY, "neighbour list: out of memory");
            dem_wall_slot *slot = &sim->wall_slot[sim->n_wall_slots++];
            *slot = (dem_wall_slot){.wall = k, .grain = i, .side = distance < 0.0 ? -1.0 : 1.0};
            if (held != NOWHERE) {
                slot->spring = w->wall_slot[held].spring;
                slot->roll = w->wall_slot[held].roll;
                slot->side = w->wall_slot[held].side;
                slot->rest = w->wall_slot[held].rest;
                slot->well = w->wall_slot[held].well;
            }
        }
    }
    mark_walls(sim);
    return RP_OK;
}

/* Put the last grain in the place of one that left. */
static void move_last(dem_sim *sim, size_t to)
{
    const size_t last = --sim->n;
#define X(type, field)                                                                                       \
    if (sim->field) sim->field[to] = sim->field[last];
    CARRIED_LIST(X)
#undef X
    sim->ref[to] = sim->ref[last];
    sim->reach[to] = sim->reach[last];
    sim->margin2[to] = sim->margin2[last];
}

/* A pair of a grain that left becomes one of grain 0 with itself, that never touches. */
static void drop_pairs(dem_sim *sim, uint32_t gone, uint32_t last)
{
    for (size_t k = 0; k < sim->n_pairs; k++) {
        uint32_t *i = &sim->pair_i[k], *j = &sim->pair_j[k];
        if (*i == gone || *j == gone) {
            *i = *j = 0;
            sim->pair_radii[k] = 0.0;
        }
        if (*i == last) *i = gone;
        if (*j == last) *j = gone;
    }
}

void dem_neighbours_drop(dem_sim *sim)
{
    for (size_t i = sim->n; i-- > 0;) {
        if (!dem_beyond(sim, sim->grain[i].x)) continue;
        const uint32_t gone = (uint32_t)i, last = (uint32_t)sim->n - 1;
        drop_pairs(sim, gone, last);
        size_t n = 0;
        for (size_t k = 0; k < sim->n_wall_slots; k++) {
            if (sim->wall_slot[k].grain == gone) continue;
            sim->wall_slot[n] = sim->wall_slot[k];
            if (sim->wall_slot[n].grain == last) sim->wall_slot[n].grain = gone;
            n++;
        }
        sim->n_wall_slots = n;
        for (size_t k = 0; k < sim->n_fixed; k++)
            if (sim->fixed[k] == last) sim->fixed[k] = gone;
        move_last(sim, i);
    }
    mark_walls(sim);
    memset(sim->slack, 0, (sim->n / DEM_GROUP + 1) * sizeof *sim->slack);
    sim->n_chunks = 0; /* places are no longer in the order of the list */
}

rp_status dem_neighbours_rebuild(dem_sim *sim)
{
    double fastest = 0.0;
    rp_status status = RP_OK;
    for (size_t i = 0; i < sim->n && !status; i++) status = check_grain(sim, i, &fastest);
    if (status) return status;
    sim->rebuilds++;
    sort_grains(sim, 2.0 * (sim->r_max + margin(sim, fastest)));
    measure_room(sim);
    status = hold_springs(sim);
    if (!status) status = find_pairs(sim);
    pad_pairs(sim);
    if (!status) status = find_wall_slots(sim);
    return status ? status : plan_chunks(sim);
}

/* The last pair takes the place of this one. */
static void remove_pair(dem_sim *sim, size_t k)
{
    const size_t last = --sim->n_pairs;
    sim->pair_i[k] = sim->pair_i[last];
    sim->pair_j[k] = sim->pair_j[last];
    sim->pair_radii[k] = sim->pair_radii[last];
    sim->pair_mass[k] = sim->pair_mass[last];
    sim->spring[k] = sim->spring[last];
    if (sim->omega) {
        sim->radius_i[k] = sim->radius_i[last];
        sim->radius_j[k] = sim->radius_j[last];
        sim->roll_radius[k] = sim->roll_radius[last];
    }
    if (sim->rolling) sim->roll[k] = sim->roll[last];
}

/* Remove the pairs of grain i that are no longer near, and append those that are not listed; what touches is
 * near, and keeps its springs. `listed` holds numbers below `mark`. */
static rp_status renew_pairs(dem_sim *sim, uint32_t i, uint32_t *listed, uint32_t mark)
{
    listed[i] = mark;
    for (size_t k = 0; k < sim->n_pairs;) {
        const uint32_t a = sim->pair_i[k], b = sim->pair_j[k], j = a == i ? b : a;
        if (a != i && b != i) {
            k++;
            continue;
        }
        const dem_vec d = sim->ref[i] - sim->ref[j];
        const double reach = sim->reach[i] + sim->reach[j];
        if (dem_dot(d, d) < reach * reach)
            listed[j] = mark, k++;
        else
            remove_pair(sim, k);
    }
    rp_status status = pair_room(sim, sim->n);
    if (status) return status;
    const size_t from = sim->n_pairs;
    (sim->near ? sim->near : add_near)(sim, i, 0, sim->n);
    size_t n = from;
    for (size_t k = from; k < sim->n_pairs; k++) {
        sim->pair_j[n] = sim->pair_j[k];
        n += listed[sim->pair_j[k]] != mark;
    }
    sim->n_pairs = n;
    complete_pairs(sim, from);
    return RP_OK;
}

/* A grain that in the coming step may pass its margin has gone half of it or goes half of it in that step;
 * such grains get new places and margins in the list. Others keep theirs, within which they still are. A
 * whole rebuilding takes as long as some ten grains' parts, and rids the list of the wide margins of grains
 * that were fast. */
rp_status dem_neighbours_renew(dem_sim *sim)
{
    enum { FEW = 8 };
    struct dem_scratch *w = sim->scratch;
    uint32_t moved[FEW];
    size_t n = 0;
    for (size_t i = 0; i < sim->n; i++) {
        const dem_vec d = sim->grain[i].x - sim->ref[i];
        const dem_vec way = 1.01 * sim->def.dt * sim->next[i].v;
        const double d2 = dem_dot(d, d), way2 = dem_dot(way, way);
        /* so that NaN counts as moved */
        if ((4.0 * d2 <= sim->margin2[i]) & (4.0 * way2 <= sim->margin2[i])) continue;
        if (n == FEW) return dem_neighbours_rebuild(sim);
        moved[n++] = (uint32_t)i;
    }
    double fastest = 0.0;
    rp_status status = RP_OK;
    for (size_t m = 0; m < n && !status; m++) status = check_grain(sim, moved[m], &fastest);
    if (status) return status;
    for (size_t m = 0; m < n; m++) {
        const dem_vec x = sim->grain[moved[m]].x;
        mark_grain(sim, moved[m]);
        sim->round_off = fmax(sim->round_off, round_off(sim, dem_dot(x, x)));
    }
    memset(w->cell, 0, sim->n * sizeof *w->cell);
    for (size_t m = 0; m < n && !status; m++) status = renew_pairs(sim, moved[m], w->cell, (uint32_t)m + 1);
    pad_pairs(sim);
    find_touching(sim);
    for (uint32_t i = 0; i < sim->n; i++) w->moved_to[i] = i;
    if (!status) status = find_wall_slots(sim);
    return status;
}
