/* The pair loop of contact.inl and the integration of verlet.c for several pairs or grains at once, with
 * the same operations in the same order for each of them, and the same order of the sums of each grain. A
 * file that includes this one asks for instructions first, and defines the functions' names. */
#include <float.h>
#include <math.h>

#include "dem/loops/lanes.h"

INLINE wide normal_force(const dem_laws *law, wide m_eff, wide overlap, wide v_n)
{
    return dem_law_normal(law->normal, law->tension, law->k_n, law->gamma_n, m_eff, overlap, v_n);
}

/* Where the pairs of a block touch: normal from j to i, overlap, relative velocity. */
typedef struct {
    wide nx, ny, overlap, vx, vy;
    lanes touch;
} geometry;

INLINE geometry geometry_of(const dem_sim *sim, size_t k)
{
    geometry m;
    wide x, y;
    wide_difference(sim->grains.motion, sim->pairs.i + k, sim->pairs.j + k, &x, &y, &m.vx, &m.vy);
    const wide radii = wide_load(sim->pairs.radii + k), r2 = x * x + y * y;
    m.touch = wide_less(r2, radii * radii);
    m.nx = m.ny = m.overlap = (wide){0};
    if (!wide_bits(m.touch)) return m;
    const wide r = num_sqrt(r2), inverse = 1.0 / r;
    m.overlap = radii - r, m.nx = x * inverse, m.ny = y * inverse;
    return m;
}

/* *to += *b and *to -= *b, all 32 bytes at once */
INLINE void force_torque_add(dem_force_torque *to, const dem_force_torque *b)
{
    _mm256_store_pd((double *)to, _mm256_load_pd((const double *)to) + _mm256_loadu_pd((const double *)b));
}

INLINE void force_torque_subtract(dem_force_torque *to, const dem_force_torque *b)
{
    _mm256_store_pd((double *)to, _mm256_load_pd((const double *)to) - _mm256_loadu_pd((const double *)b));
}

/* A block without touch is left at once. In any other all is computed for all pairs; pairs that do not touch
 * then get a spring and a force of 0. Adding 0 to a force changes no bit: no force is ever -0, since it
 * starts from +0. The list ends in pairs that never touch. */
INLINE void pair_loop(dem_sim *sim, size_t from, size_t to, double h, dem_laws law, bool rotation,
                      bool rolling)
{
    const bool friction = dem_has_friction(law.tangential), has_spring = dem_has_spring(law.tangential);
    dem_vec *restrict force = sim->grains.force;
    const double *restrict omega = sim->grains.omega;
    dem_force_torque *restrict force_torque = sim->grains.force_torque;
    double *restrict spring = sim->pairs.spring, *restrict roll = sim->pairs.roll;
    uint64_t *restrict touching = sim->pairs.touching;
    const wide zero = {0}, limit = zero + sim->r_min;
    unsigned too_deep = 0;
    uint64_t word = 0;
    geometry next = {0};
    if (from < to) next = geometry_of(sim, from);
    for (size_t k = from; k < to; k += WIDTH) {
        const uint32_t *i = sim->pairs.i + k, *j = sim->pairs.j + k;
        const wide nx = next.nx, ny = next.ny, overlap = next.overlap, vx = next.vx, vy = next.vy;
        const lanes touch = next.touch;
        if (k + WIDTH < to) next = geometry_of(sim, k + WIDTH); /* while the divider works */
        dem_note(touching, k, wide_bits(touch), &word);
        if (!wide_bits(touch)) {
            if (has_spring) wide_store(spring + k, zero);
            if (rolling) wide_store(roll + k, zero);
            continue;
        }
        const wide m_eff = wide_load(sim->pairs.m_eff + k);
        too_deep |= wide_bits(touch) & ~wide_bits(wide_at_most(overlap, limit));
        wide f_n = normal_force(&law, m_eff, overlap, vx * nx + vy * ny);
        wide fx = f_n * nx, fy = f_n * ny;
        if (friction) {
            /* along s = (ny, -nx), the normal turned clockwise */
            wide v_s = vx * ny - vy * nx, r_i, r_j, omega_i, omega_j, ds = zero;
            if (rotation) {
                r_i = wide_load(sim->pairs.radius_i + k), r_j = wide_load(sim->pairs.radius_j + k);
                omega_i = wide_gather(omega, i, 1);
                omega_j = wide_gather(omega, j, 1);
                v_s += (r_i - 0.5 * overlap) * omega_i + (r_j - 0.5 * overlap) * omega_j;
            }
            if (has_spring) ds = wide_load(spring + k);
            const wide f_s = dem_law_tangential(law.tangential, law.shear, m_eff, v_s, f_n, h, &ds);
            if (has_spring) wide_store(spring + k, num_choose(touch, ds, zero));
            fx = fx + f_s * ny;
            fy = fy - f_s * nx;
            if (rotation) {
                wide couple = zero;
                if (rolling) {
                    wide xi = wide_load(roll + k);
                    couple = dem_law_rolling(law.rolls, wide_load(sim->pairs.r_eff + k), m_eff,
                                             omega_i - omega_j, f_n, h, &xi);
                    wide_store(roll + k, num_choose(touch, xi, zero));
                }
                dem_force_torque on_i[WIDTH], on_j[WIDTH];
                const wide x = num_choose(touch, fx, zero), y = num_choose(touch, fy, zero);
                wide_store_force_torques(on_i, x, y,
                                         num_choose(touch, (r_i - 0.5 * overlap) * f_s + couple, zero));
                wide_store_force_torques(on_j, x, y,
                                         num_choose(touch, couple - (r_j - 0.5 * overlap) * f_s, zero));
                for (int p = 0; p < WIDTH; p++) {
                    force_torque_add(force_torque + i[p], on_i + p);
                    force_torque_subtract(force_torque + j[p], on_j + p);
                }
                continue;
            }
        }
        dem_vec f[WIDTH];
        wide_store_vectors(f, num_choose(touch, fx, zero), num_choose(touch, fy, zero));
        for (int p = 0; p < WIDTH; p++) {
            *(rotation ? &force_torque[i[p]].force : &force[i[p]]) += f[p];
            *(rotation ? &force_torque[j[p]].force : &force[j[p]]) -= f[p];
        }
    }
    sim->too_deep |= too_deep != 0;
}

#include "dem/loops/instances.inl"

void WIDE(pairs)(dem_sim *sim, size_t from, size_t to, double h)
{
    run_instance(sim, from, to, h);
}

/* Of WIDTH contacts with a wall: force, torques of slip and rolling, springs; bits of the contacts that
 * touch, and of overlaps that are too deep. */
typedef struct {
    wide fx, fy, slip, couple, spring, roll;
    unsigned touch, deep;
} slot_forces;

/* As apply_slot in walls.c, for grains i[] in slots of wall w, the at[]-th ones of these. */
INLINE slot_forces slot_forces_of(const dem_sim *sim, const dem_laws *law, const dem_wall_slot *slot,
                                  const uint32_t *at, const uint32_t *i, double h)
{
    const uint32_t w = slot->wall;
    const double *grain = (const double *)sim->grains.motion;
    const int of_slot = sizeof *slot / sizeof *grain, of_grain = sizeof *sim->grains.motion / sizeof *grain;
    const dem_vec point = sim->walls.line[w].point, n = sim->walls.line[w].direction;
    const unsigned all = (1u << WIDTH) - 1;
    const wide zero = {0}, radius = wide_gather(sim->grains.radius, i, 1),
               mass = wide_gather(sim->grains.mass, i, 1), side = wide_gather(&slot->side, at, of_slot);
    const wide x = wide_gather(grain, i, of_grain), y = wide_gather(grain + 1, i, of_grain),
               vx = wide_gather(grain + 2, i, of_grain), vy = wide_gather(grain + 3, i, of_grain);
    const wide distance = (x - point[0]) * n[0] + (y - point[1]) * n[1], overlap = radius - side * distance,
               nx = side * n[0], ny = side * n[1];
    const wide f_n = normal_force(law, mass, overlap, vx * nx + vy * ny);
    slot_forces b = {.fx = f_n * nx,
                     .fy = f_n * ny,
                     .spring = wide_gather(&slot->spring, at, of_slot),
                     .roll = wide_gather(&slot->roll, at, of_slot),
                     .touch = ~wide_bits(wide_at_most(overlap, zero)) & all,
                     .deep = ~wide_bits(wide_at_most(overlap, radius)) & all};
    if (!dem_has_friction(law->tangential)) return b;
    const wide arm = radius - overlap,
               omega = sim->grains.omega ? wide_gather(sim->grains.omega, i, 1) : zero;
    wide v_s = vx * ny - vy * nx;
    if (sim->grains.omega) v_s += arm * omega;
    const wide f_s = dem_law_tangential(law->tangential, law->shear, mass, v_s, f_n, h, &b.spring);
    b.fx += ny * f_s;
    b.fy -= nx * f_s;
    b.slip = arm * f_s;
    if (sim->pairs.rolling) b.couple = dem_law_rolling(law->rolls, radius, mass, omega, f_n, h, &b.roll);
    return b;
}

/* Give slots k..k + n, of grains i[], their springs and the grains their forces; the wall's share is
 * subtracted from *wall. */
INLINE void take_slot_forces(dem_sim *sim, size_t k, size_t n, const uint32_t *i, const slot_forces *b,
                             dem_vec *wall)
{
    dem_vec f[WIDTH];
    double spring[WIDTH], roll[WIDTH], slip[WIDTH], couple[WIDTH];
    wide_store_vectors(f, b->fx, b->fy);
    wide_store(spring, b->spring);
    wide_store(roll, b->roll);
    wide_store(slip, b->slip);
    wide_store(couple, b->couple);
    for (size_t p = 0; p < n; p++) {
        dem_wall_slot *slot = &sim->walls.slot[k + p];
        if (!(b->touch >> p & 1)) {
            slot->spring = slot->roll = 0.0;
            slot->well = DEM_WELL_NONE;
            continue;
        }
        slot->spring = spring[p];
        slot->roll = roll[p];
        if (sim->grains.omega) sim->grains.force_torque[i[p]].torque += slip[p];
        if (sim->pairs.rolling) sim->grains.force_torque[i[p]].torque += couple[p];
        *dem_force(sim, i[p]) += f[p];
        *wall -= f[p];
    }
}

/* As apply_slot for slots k..end of one wall, a whole line at rest and not the ground. The last block is
 * filled up with its last slot. */
void WIDE(line)(dem_sim *sim, size_t k, size_t end, double h)
{
    const dem_wall_slot *slot = sim->walls.slot;
    const uint32_t w = slot[k].wall;
    const dem_laws law = dem_laws_of(&sim->def, &sim->walls.wall[w].material, sim->walls.mu[w]);
    dem_vec wall = sim->walls.force[w];
    for (; k < end; k += WIDTH) {
        static const uint32_t all[8] = {0, 1, 2, 3, 4, 5, 6, 7};
        const size_t n = end - k < WIDTH ? end - k : WIDTH;
        uint32_t some[WIDTH], i[WIDTH];
        const uint32_t *at = all;
        if (n < WIDTH) {
            for (size_t p = 0; p < WIDTH; p++) some[p] = (uint32_t)(p < n ? p : n - 1);
            at = some;
        }
        for (size_t p = 0; p < WIDTH; p++) i[p] = slot[k + at[p]].grain;
        const slot_forces b = slot_forces_of(sim, &law, slot + k, at, i, h);
        take_slot_forces(sim, k, n, i, &b, &wall);
        sim->too_deep |= b.deep != 0;
    }
    sim->walls.force[w] = wall;
}

/* As integrate_spins in verlet.c, for WIDTH grains; `rest` are their (torque, spare). */
INLINE void advance_spins(const dem_sim *sim, const dem_equation *e, size_t i, const wide rest[2],
                          double *next_angle, double *next_omega)
{
    wide angle = wide_load(sim->grains.angle + i), omega = wide_load(sim->grains.omega + i);
    dem_leap_spin(e, wide_firsts(rest[0], rest[1]), wide_load(sim->grains.inverse_inertia + i), &angle,
                  &omega);
    wide_store(next_omega + i, omega);
    wide_store(next_angle + i, angle);
}

/* Take the forces on WIDTH/2 grains, and their torques into *rest: they are 0 then. */
INLINE wide take_forces(dem_sim *sim, size_t i, wide *rest)
{
    const wide zero = {0};
    double *from = sim->grains.force_torque ? (double *)(sim->grains.force_torque + i)
                                            : (double *)(sim->grains.force + i);
    wide force = wide_load(from);
    if (sim->grains.force_torque) {
        wide_load_records((const dem_motion *)from, &force, rest);
        wide_store(from + WIDTH, zero);
    }
    wide_store(from, zero);
    return force;
}

INLINE double largest(wide a)
{
    double all[WIDTH];
    wide_store(all, a);
    double most = all[0];
    for (int p = 1; p < WIDTH; p++) most = all[p] > most ? all[p] : most;
    return most;
}

/* With `look`, margins are checked, else the largest speed is found. */
INLINE size_t advance_grains(dem_sim *sim, size_t from, size_t to, unsigned *left, double *speed2, bool look)
{
    enum { GRAINS = WIDTH / 2, ALL = (1 << WIDTH) - 1 };
    const bool turned = sim->walls.angle != 0.0; /* then the caller finds grains that left */
    const dem_equation e = dem_equation_of(sim);
    const double x_max = turned ? INFINITY : sim->def.x_max, y_min = turned ? -INFINITY : sim->def.y_min;
    const wide zero = {0}, most = wide_repeat((dem_vec){x_max, INFINITY}),
               least = wide_repeat((dem_vec){-INFINITY, y_min}), finite = zero + DBL_MAX;
    wide fast = zero;
    unsigned far = 0, out = 0;
    size_t i = from;
    for (; i + WIDTH <= to; i += WIDTH) {
        wide rest[2] = {zero, zero};
        for (size_t h = 0, at = i; h < 2; h++, at += GRAINS) {
            wide x, v;
            const wide force = take_forces(sim, at, &rest[h]);
            wide_load_records(sim->grains.motion + at, &x, &v);
            dem_leap(&e, force, wide_load_twice(sim->grains.inverse_mass + at), &x, &v);
            wide_store_records(sim->grains.motion + at, x, v);
            wide moved = v, most_moved = finite;
            if (look) {
                moved = x - wide_load((const double *)(sim->grains.listed_x + at));
                most_moved = wide_load_twice(sim->grains.margin2 + at);
            }
            moved *= moved;
            moved += wide_swap(moved);
            if (!look) fast = num_max(moved, fast);
            /* written so that NaN counts as moved */
            far |= wide_bits(wide_at_most(moved, most_moved)) ^ ALL;
            out |= wide_bits(wide_less(most, x)) | wide_bits(wide_less(x, least));
        }
        if (sim->grains.omega) advance_spins(sim, &e, i, rest, sim->grains.angle, sim->grains.omega);
    }
    if (!look) *speed2 = far ? INFINITY : largest(fast);
    *left |= (out != 0) * DEM_GRAIN_OUT | (look && far) * DEM_LIST_OUT;
    return i;
}

/* As advance in verlet.c, spins included. */
size_t WIDE(advance)(dem_sim *sim, size_t from, size_t to, unsigned *left, double *speed2)
{
    return speed2 ? advance_grains(sim, from, to, left, speed2, false)
                  : advance_grains(sim, from, to, left, NULL, true);
}

/* As measure_slack in verlet.c. */
size_t WIDE(beyond_margin)(const dem_sim *sim, size_t from, size_t to, unsigned *left, double *margin2,
                           double *beyond)
{
    enum { GRAINS = WIDTH / 2, ALL = (1 << WIDTH) - 1 };
    wide widest = (wide){0} + *margin2, most = (wide){0} + *beyond;
    unsigned far = 0;
    size_t i = from;
    for (; i + GRAINS <= to; i += GRAINS) {
        wide x, v;
        wide_load_records(sim->grains.motion + i, &x, &v);
        wide moved = x - wide_load((const double *)(sim->grains.listed_x + i));
        moved *= moved;
        moved += wide_swap(moved);
        const wide margin = wide_load_twice(sim->grains.margin2 + i);
        /* written so that NaN counts as moved */
        far |= wide_bits(wide_at_most(moved, margin)) ^ ALL;
        widest = num_max(margin, widest);
        most = num_max(moved - margin, most);
    }
    *left |= (far != 0) * DEM_LIST_OUT;
    *margin2 = largest(widest);
    *beyond = largest(most);
    return i;
}

/* As dem_append_pairs in neighbours.c. */
void WIDE(append_pairs)(dem_sim *sim, size_t i, size_t from, size_t to)
{
    const bool some_fixed = sim->grains.n_fixed > 0;
    const wide zero = {0}, x = wide_repeat(sim->grains.listed_x[i]), own = zero + sim->grains.cutoff[i],
               inverse_mass = zero + sim->grains.inverse_mass[i];
    size_t k = sim->pairs.n;
    for (size_t j = from; j < to; j += WIDTH) {
        const wide a = x - wide_load((const double *)(sim->grains.listed_x + j)),
                   b = x - wide_load((const double *)(sim->grains.listed_x + j + WIDTH / 2));
        const wide dx = wide_firsts(a, b), dy = wide_seconds(a, b),
                   cutoff = own + wide_load(sim->grains.cutoff + j);
        unsigned near = wide_bits(wide_less(dx * dx + dy * dy, cutoff * cutoff));
        if (some_fixed)
            near &= wide_bits(wide_less(zero, inverse_mass + wide_load(sim->grains.inverse_mass + j)));
        if (to - j < WIDTH) near &= (1u << (to - j)) - 1;
        for (size_t p = 0; p < WIDTH; p++) sim->pairs.i[k + p] = (uint32_t)i;
        k = wide_append(sim->pairs.j, k, near, j);
    }
    sim->pairs.n = k;
}

/* As predict_all in hard.c. */
size_t WIDE(predict)(dem_sim *sim, size_t *beyond)
{
    enum { GRAINS = WIDTH / 2, ALL = (1 << WIDTH) - 1 };
    const dem_equation e = dem_equation_of(sim);
    const bool some_fixed = sim->grains.n_fixed > 0;
    const wide zero = {0};
    size_t i = 0;
    for (; i + WIDTH <= sim->grains.n; i += WIDTH) {
        wide rest[2] = {zero, zero};
        for (size_t h = 0, at = i; h < 2; h++, at += GRAINS) {
            const wide inverse_mass = wide_load_twice(sim->grains.inverse_mass + at);
            wide x, v, force;
            if (sim->grains.force_torque)
                wide_load_records((const dem_motion *)(sim->grains.force_torque + at), &force, &rest[h]);
            else
                force = wide_load((const double *)(sim->grains.force + at));
            wide_load_records(sim->grains.motion + at, &x, &v);
            wide x_next = x, v_next = v;
            dem_leap(&e, force, inverse_mass, &x_next, &v_next);
            const lanes moves = wide_less(zero, inverse_mass);
            v = some_fixed ? num_choose(moves, v_next, v) : v_next;
            x = some_fixed ? num_choose(moves, x_next, x) : x_next;
            wide_store_records(sim->grains.next_motion + at, x, v);
            wide moved = x - wide_load((const double *)(sim->grains.listed_x + at));
            moved *= moved;
            /* written so that NaN counts as moved */
            const unsigned far =
                wide_bits(wide_at_most(moved + wide_swap(moved), wide_load_twice(sim->grains.margin2 + at))) ^
                ALL;
            if (far) *beyond = at + (31 - (size_t)__builtin_clz(far)) / 2;
        }
        if (sim->grains.omega)
            advance_spins(sim, &e, i, rest, sim->grains.next_angle, sim->grains.next_omega);
    }
    return i;
}

/* Which of WIDTH pairs may touch; as in hard.c. */
INLINE unsigned may_touch(const dem_sim *sim, const uint32_t *i, const uint32_t *j, wide radii)
{
    wide x, y, vx, vy;
    wide_difference(sim->grains.next_motion, i, j, &x, &y, &vx, &vy);
    const double dt = sim->def.dt;
    const wide moved_x = dt * vx, moved_y = dt * vy, start_x = x - moved_x, start_y = y - moved_y;
    const wide radii2 = radii * radii, slop = 1e-9 * radii2 + 4.0 * radii * sim->list.round_off,
               gap = start_x * start_x + start_y * start_y - radii2,
               along = start_x * moved_x + start_y * moved_y, moved2 = moved_x * moved_x + moved_y * moved_y;
    const unsigned apart = wide_bits(wide_at_most(-slop, gap)) & wide_bits(wide_at_most(along, slop)),
                   ends = wide_bits(wide_at_most(x * x + y * y, radii2 + slop)),
                   turns = wide_bits(wide_at_most((wide){0}, x * moved_x + y * moved_y)),
                   meets = wide_bits(wide_at_most((gap - slop) * moved2, along * along));
    return apart & (ends | (turns & meets));
}

size_t WIDE(next_approaching)(const dem_sim *sim, size_t k, size_t end)
{
    const uint64_t all = (1u << WIDTH) - 1;
    uint64_t left = ~0ull << k % 64;
    for (k -= k % 64; k < end; k += 64, left = ~0ull) {
        left &= ~sim->pairs.touching[k / 64];
        if (end - k < 64) left &= ~(~0ull << (end - k));
        while (left) {
            const size_t shift = (size_t)__builtin_ctzll(left) / WIDTH * WIDTH, at = k + shift;
            const uint64_t near =
                may_touch(sim, sim->pairs.i + at, sim->pairs.j + at, wide_load(sim->pairs.radii + at)) &
                left >> shift & all;
            if (near) return at + (size_t)__builtin_ctzll(near);
            left &= ~(all << shift);
        }
    }
    return end;
}

/* The first pair from k on of one of n grains that may touch. */
INLINE size_t next_of(const dem_sim *sim, const uint32_t *of, size_t n, size_t k, size_t end)
{
    const uint32_t *i = sim->pairs.i, *j = sim->pairs.j;
    for (size_t at = k - k % WIDTH; at < end; at += WIDTH) {
        unsigned found = 0;
        for (size_t c = 0; c < n; c++) found |= index_equals(i + at, of[c]) | index_equals(j + at, of[c]);
        if (at < k) found &= ~0u << (k - at);
        if (found) found &= may_touch(sim, i + at, j + at, wide_load(sim->pairs.radii + at));
        if (!found) continue;
        at += (size_t)__builtin_ctz(found);
        return at < end ? at : end;
    }
    return end;
}

/* As next_collided in hard.c. */
size_t WIDE(next_collided)(const dem_sim *sim, size_t k, size_t end)
{
    return sim->collided.n <= 2 ? next_of(sim, sim->collided.few, 2, k, end)
                                : next_of(sim, sim->collided.few, DEM_FEW, k, end);
}
