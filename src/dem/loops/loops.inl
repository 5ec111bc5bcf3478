/* The loops over pairs, wall slots and grains, for WIDTH of them at a time: with the same operations in the
 * same order for each, and the same order of the sums of each grain, so that every width gives the same bits.
 * What they do is in state/loops.h. A file that includes this one asks for instructions first, and sets
 * WIDTH. */
#include <float.h>
#include <math.h>

#include "dem/loops/lanes.h"

/* The rest of a loop whose width does not divide the number of its grains. */
#define REST(loop, i, to, ...)                                                                               \
    if (WIDTH > 1 && (i) < (to)) dem_loops_1.loop(sim, i, to, __VA_ARGS__)

/* ---- Pairs ---------------------------------------------------------------------------------------------
 *
 * Forces on grain i by grain j: Lee & Herrmann 1993, eq (1). Instances know their normal law and features, so
 * that a scene pays only for what it uses.
 *
 * With rotation the surfaces' spin counts in the shear velocity. The contact lies in the middle of the
 * overlap, at arms from the centres that add up to their distance, so that angular momentum is conserved. A
 * spin counter-clockwise moves the surface of i, at -arm n from its centre, along +s; that of j, at +arm n,
 * along -s; so both add to v_s, and F_s turns both the same way. */

/* What the loop knows beforehand. */
typedef struct {
    dem_laws law;
    bool rotation, rolling, excess;
    const dem_material *kinds; /* coefficients by the pairs' entries; NULL: all pairs have those of the law */
    double arm;
} features;

/* What it works on: copies, which no store into an array can change; the time since the last forces; the
 * smallest radius. */
typedef struct {
    dem_grains grains;
    dem_pairs pairs;
    double h;
    num r_min;
    features with;
} work;

/* Where pairs touch: normal from j to i, overlap, relative velocity. */
typedef struct {
    num nx, ny, overlap, vx, vy;
    lanes touch;
} geometry;

/* On i along x and y; torques on i and j. */
typedef struct {
    num fx, fy, on_i, on_j;
} forces;

/* A coefficient of one material for all, or of the material that each contact has. */
INLINE num coefficient(const double *of, const uint32_t *entry)
{
    return entry ? num_gather(of, entry, sizeof(dem_material) / sizeof *of) : num_of(*of);
}

INLINE dem_laws with_coefficients(dem_laws law, const dem_material *c, const uint32_t *entry, double arm)
{
    law.k_n = coefficient(&c->k_n, entry), law.gamma_n = coefficient(&c->gamma_n, entry);
    law.shear = dem_slider_of(law.shear.slip, law.shear.damping, coefficient(&c->k_s, entry),
                              coefficient(&c->gamma_s, entry), coefficient(&c->mu, entry));
    law.rolls = dem_rolls_of(law.rolling, law.tangential, arm, coefficient(&c->k_roll, entry),
                             coefficient(&c->gamma_roll, entry), coefficient(&c->mu_roll, entry));
    return law;
}

INLINE dem_laws laws_of(const dem_sim *sim, const dem_material *c)
{
    const dem_definition *def = &sim->def;
    const dem_laws law = {.normal = def->normal,
                          .tangential = def->tangential,
                          .rolling = def->rolling,
                          .tension = def->tension,
                          .shear = {.slip = def->slip, .damping = def->damping}};
    return with_coefficients(law, c, NULL, dem_arm_of(def, c));
}

INLINE num normal_force(const dem_laws *law, num r_eff, num m_eff, num overlap, num v_n)
{
    return dem_law_normal(law->normal, law->tension, dem_law_k_n(law->normal, law->k_n, r_eff), law->gamma_n,
                          m_eff, overlap, v_n);
}

INLINE geometry geometry_of(const work *w, size_t k)
{
    const dem_pairs *pairs = &w->pairs;
    geometry g;
    num x, y;
    num_difference(w->grains.motion, pairs->i + k, pairs->j + k, &x, &y, &g.vx, &g.vy);
    const num radii = num_load(pairs->radii + k), r2 = x * x + y * y;
    g.touch = num_less(r2, radii * radii);
    g.nx = g.ny = g.overlap = (num){0};
    if (!lanes_bits(g.touch)) return g;
    const num r = num_sqrt(r2), inverse = 1.0 / r;
    g.overlap = radii - r, g.nx = x * inverse, g.ny = y * inverse;
    return g;
}

/* Forces of the pairs from k on; brings their springs up to date. */
INLINE forces forces_of(const work *w, size_t k, const geometry *g)
{
    const dem_grains *grains = &w->grains;
    const dem_pairs *pairs = &w->pairs;
    dem_laws own;
    const dem_laws *law = &w->with.law;
    if (w->with.kinds) {
        own = with_coefficients(*law, w->with.kinds, pairs->entry + k, w->with.arm);
        law = &own;
    }
    const bool has_spring = dem_has_spring(law->tangential);
    const num zero = {0}, m_eff = num_load(pairs->m_eff + k), r_eff = num_load(pairs->r_eff + k),
              v_n = g->vx * g->nx + g->vy * g->ny, f_n = normal_force(law, r_eff, m_eff, g->overlap, v_n);
    forces f = {f_n * g->nx, f_n * g->ny, zero, zero};
    if (!dem_has_friction(law->tangential)) return f;
    /* along s = (ny, -nx), the normal turned clockwise */
    num v_s = g->vx * g->ny - g->vy * g->nx, arm_i = zero, arm_j = zero, omega_i = zero, omega_j = zero,
        ds = zero;
    if (w->with.rotation) {
        arm_i = num_load(pairs->radius_i + k) - 0.5 * g->overlap;
        arm_j = num_load(pairs->radius_j + k) - 0.5 * g->overlap;
        omega_i = num_gather(grains->omega, pairs->i + k, 1);
        omega_j = num_gather(grains->omega, pairs->j + k, 1);
        v_s += arm_i * omega_i + arm_j * omega_j;
    }
    if (has_spring) ds = num_load(pairs->spring + k);
#if WIDTH == 1
    if (w->with.excess) {
        const dem_vec more = grains->excess[pairs->i[k]] - grains->excess[pairs->j[k]];
        ds += more[0] * g->ny - more[1] * g->nx;
    }
#endif
    dem_slider shear = law->shear, rolls = law->rolls;
    num xi = w->with.rolling ? num_load(pairs->roll + k) : zero;
    if (dem_is_of_radius(law->tangential)) { /* a step back, along straight lines */
        const num radii = num_load(pairs->radii + k), r = radii - g->overlap, h = num_of(w->h),
                  back = r * r - 2.0 * h * r * v_n + h * h * (g->vx * g->vx + g->vy * g->vy),
                  before = radii - num_sqrt(back);
        shear = dem_law_at_overlap(shear, r_eff, m_eff, g->overlap, before, &ds);
        if (w->with.rolling) rolls = dem_law_at_overlap(rolls, r_eff, m_eff, g->overlap, before, &xi);
    }
    const num f_s = dem_law_tangential(law->tangential, shear, m_eff, v_s, f_n, w->h, &ds);
    if (has_spring) num_store(pairs->spring + k, num_choose(g->touch, ds, zero));
    f.fx = f.fx + f_s * g->ny;
    f.fy = f.fy - f_s * g->nx;
    if (!w->with.rotation) return f;
    num couple = zero;
    if (w->with.rolling) {
        couple =
            r_eff * dem_law_rolling(law->rolling, rolls, m_eff, r_eff * (omega_i - omega_j), f_n, w->h, &xi);
        num_store(pairs->roll + k, num_choose(g->touch, xi, zero));
    }
    f.on_i = arm_i * f_s + couple;
    f.on_j = couple - arm_j * f_s;
    return f;
}

/* Adding 0 to a force, of pairs that do not touch, changes no bit: no force is ever -0, since it starts from
 * +0. */
INLINE void add_forces(const work *w, size_t k, lanes touch, const forces *f)
{
    const dem_grains *grains = &w->grains;
    const uint32_t *i = w->pairs.i + k, *j = w->pairs.j + k;
    const num zero = {0}, fx = num_choose(touch, f->fx, zero), fy = num_choose(touch, f->fy, zero);
    if (w->with.rotation && dem_has_friction(w->with.law.tangential)) {
        dem_force_torque on_i[WIDTH], on_j[WIDTH];
        store_force_torques(on_i, fx, fy, num_choose(touch, f->on_i, zero));
        store_force_torques(on_j, fx, fy, num_choose(touch, f->on_j, zero));
        for (int p = 0; p < WIDTH; p++) {
            *(force_torque *)(grains->force_torque + i[p]) += *(force_torque *)(on_i + p);
            *(force_torque *)(grains->force_torque + j[p]) -= *(force_torque *)(on_j + p);
        }
        return;
    }
    dem_vec on_i[WIDTH];
    store_vectors(on_i, fx, fy);
    for (int p = 0; p < WIDTH; p++) {
        *(w->with.rotation ? &grains->force_torque[i[p]].force : &grains->force[i[p]]) += on_i[p];
        *(w->with.rotation ? &grains->force_torque[j[p]].force : &grains->force[j[p]]) -= on_i[p];
    }
}

/* Forces of the pairs from k on; which are too deep. */
INLINE unsigned do_pairs(const work *w, size_t k, const geometry *g)
{
    const forces f = forces_of(w, k, g);
    add_forces(w, k, g->touch, &f);
    return lanes_bits(g->touch) & ~lanes_bits(num_at_most(g->overlap, w->r_min));
}

/* A spring ends with its contact. One pair at a time: those that touch are listed first, without a branch.
 * Several: a block without touch is left at once. In any other all is computed for all pairs; pairs that do
 * not touch then get a spring and a force of 0. The list ends in pairs that never touch. */
#ifdef __SANITIZE_ADDRESS__ /* one for all features: instances with sanitizers take minutes to compile */
#define INSTANCE static __attribute__((noipa))
#else
#define INSTANCE INLINE
#endif
INSTANCE void pair_loop(dem_sim *sim, size_t from, size_t to, double h, features with)
{
    const num zero = {0};
    const work w = {sim->grains, sim->pairs, h, zero + sim->r_min, with};
    const dem_pairs pairs = w.pairs;
    const bool has_spring = dem_has_spring(with.law.tangential);
    unsigned too_deep = 0;
    uint64_t word = 0;
#if WIDTH == 1
    while (from < to) {
        enum { BLOCK = 256 };
        uint32_t held[BLOCK + 1];
        size_t n = 0;
        for (const size_t end = from + BLOCK; from < to && from < end; from += 8) {
            unsigned bits = 0;
            for (size_t k = from; k < from + 8; k++) {
                const dem_vec d = w.grains.motion[pairs.i[k]].x - w.grains.motion[pairs.j[k]].x;
                const bool touch = dem_dot(d, d) < pairs.radii[k] * pairs.radii[k];
                bits |= (unsigned)touch << (k - from);
                held[n] = (uint32_t)k;
                n += touch;
                if (has_spring) pairs.spring[k] = touch ? pairs.spring[k] : 0.0;
                if (with.rolling) pairs.roll[k] = touch ? pairs.roll[k] : 0.0;
            }
            dem_note(pairs.touching, from, bits, &word);
        }
        for (size_t t = 0; t < n; t++) {
            const geometry g = geometry_of(&w, held[t]);
            too_deep |= do_pairs(&w, held[t], &g);
        }
    }
#else
    geometry next = {0};
    if (from < to) next = geometry_of(&w, from);
    for (size_t k = from; k < to; k += WIDTH) {
        const geometry now = next;
        if (k + WIDTH < to) next = geometry_of(&w, k + WIDTH); /* while the divider works */
        dem_note(pairs.touching, k, lanes_bits(now.touch), &word);
        if (lanes_bits(now.touch)) {
            too_deep |= do_pairs(&w, k, &now);
        } else {
            if (has_spring) num_store(pairs.spring + k, zero);
            if (with.rolling) num_store(pairs.roll + k, zero);
        }
    }
#endif
    sim->too_deep |= too_deep != 0;
}

/* The laws with these choices. */
INLINE dem_laws spring_laws(dem_laws law, dem_tangential_law tangential, bool tension, dem_damping damping)
{
    law.tangential = tangential, law.tension = tension;
    law.shear.slip = DEM_TRUNCATED, law.shear.damping = damping;
    return law;
}

INLINE void run_of_motion(dem_sim *sim, size_t from, size_t to, double h, dem_laws law,
                          const dem_material *kinds)
{
    const double arm = dem_arm_of(&sim->def, kinds);
    if (!sim->def.rotation)
        pair_loop(sim, from, to, h, (features){law, false, false, false, kinds, arm});
    else if (!sim->pairs.rolling)
        pair_loop(sim, from, to, h, (features){law, true, false, false, kinds, arm});
    else if (law.rolling == DEM_COMMON_ROLLING) {
        law.rolling = DEM_COMMON_ROLLING; /* known to the compiler */
        pair_loop(sim, from, to, h, (features){law, true, true, false, kinds, arm});
    } else
        pair_loop(sim, from, to, h, (features){law, true, true, false, kinds, arm});
}

/* The compiler knows the choices of the laws that most scenes make. */
INLINE void run_of_law(dem_sim *sim, size_t from, size_t to, double h, dem_laws law)
{
#define X(along, pulls, normals, damps)                                                                      \
    if (law.tangential == along && law.shear.slip == DEM_TRUNCATED && law.tension == (pulls) && (normals) && \
        law.shear.damping == damps)                                                                          \
        run_of_motion(sim, from, to, h, spring_laws(law, along, pulls, damps), NULL);                        \
    else
    DEM_COMMON_LAWS(X)
#undef X
    run_of_motion(sim, from, to, h, law, NULL);
}

static void pairs(dem_sim *sim, size_t from, size_t to, double h)
{
    dem_laws law = laws_of(sim, dem_pair_material(&sim->def, 0, 0));
    switch (law.normal) {
#define X(id, ...)                                                                                           \
    case id:                                                                                                 \
        law.normal = id;                                                                                     \
        run_of_law(sim, from, to, h, law);                                                                   \
        break;
        DEM_NORMAL_LAWS(X)
#undef X
    }
}

/* The same with the coefficients of kinds, and laws that are known at run time alone. */
static void mixed_pairs(dem_sim *sim, size_t from, size_t to, double h)
{
    run_of_motion(sim, from, to, h, laws_of(sim, sim->def.pairs), sim->def.pairs);
}

/* ---- Wall slots ---------------------------------------------------------------------------------------- */

/* Of WIDTH contacts with a wall: force, torques of slip and rolling, springs; bits of the contacts that
 * touch, and of overlaps that are too deep. */
typedef struct {
    num fx, fy, slip, couple, spring, roll;
    unsigned touch, deep;
} slot_forces;

/* For grains i[] in slots of wall w, the at[]-th ones of these. */
INLINE slot_forces slot_forces_of(const dem_sim *sim, const dem_laws *law, const dem_wall_slot *slot,
                                  const uint32_t *at, const uint32_t *i, double h)
{
    const uint32_t w = slot->wall;
    const double *grain = (const double *)sim->grains.motion;
    const int of_slot = sizeof *slot / sizeof *grain, of_grain = sizeof *sim->grains.motion / sizeof *grain;
    const dem_vec point = sim->walls.line[w].point, n = sim->walls.line[w].direction;
    const unsigned all = (1u << WIDTH) - 1;
    const num zero = {0}, radius = num_gather(sim->grains.radius, i, 1),
              mass = num_gather(sim->grains.mass, i, 1), side = num_gather(&slot->side, at, of_slot);
    const num x = num_gather(grain, i, of_grain), y = num_gather(grain + 1, i, of_grain),
              vx = num_gather(grain + 2, i, of_grain), vy = num_gather(grain + 3, i, of_grain);
    const num distance = (x - point[0]) * n[0] + (y - point[1]) * n[1], overlap = radius - side * distance,
              nx = side * n[0], ny = side * n[1];
    const num v_n = vx * nx + vy * ny, f_n = normal_force(law, radius, mass, overlap, v_n);
    slot_forces b = {.fx = f_n * nx,
                     .fy = f_n * ny,
                     .spring = num_gather(&slot->spring, at, of_slot),
                     .roll = num_gather(&slot->roll, at, of_slot),
                     .touch = ~lanes_bits(num_at_most(overlap, zero)) & all,
                     .deep = ~lanes_bits(num_at_most(overlap, radius)) & all};
    if (!dem_has_friction(law->tangential)) return b;
    const num arm = radius - overlap, omega = sim->grains.omega ? num_gather(sim->grains.omega, i, 1) : zero;
    num v_s = vx * ny - vy * nx;
    if (sim->grains.omega) v_s += arm * omega;
    dem_slider shear = law->shear, rolls = law->rolls;
    if (dem_is_of_radius(law->tangential)) {
        const num before = overlap + v_n * h;
        shear = dem_law_at_overlap(shear, radius, mass, overlap, before, &b.spring);
        rolls = dem_law_at_overlap(rolls, radius, mass, overlap, before, &b.roll);
    }
    const num f_s = dem_law_tangential(law->tangential, shear, mass, v_s, f_n, h, &b.spring);
    b.fx += ny * f_s;
    b.fy -= nx * f_s;
    b.slip = arm * f_s;
    if (sim->pairs.rolling)
        b.couple = radius * dem_law_rolling(law->rolling, rolls, mass, radius * omega, f_n, h, &b.roll);
    return b;
}

/* Give slots k..k + n, of grains i[], their springs and the grains their forces; the wall's share is
 * subtracted from *wall. */
INLINE void take_slot_forces(dem_sim *sim, size_t k, size_t n, const uint32_t *i, const slot_forces *b,
                             dem_vec *wall)
{
    dem_vec f[WIDTH];
    double spring[WIDTH], roll[WIDTH], slip[WIDTH], couple[WIDTH];
    store_vectors(f, b->fx, b->fy);
    num_store(spring, b->spring);
    num_store(roll, b->roll);
    num_store(slip, b->slip);
    num_store(couple, b->couple);
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

/* The last block is filled up with its last slot. */
INLINE void line_loop(dem_sim *sim, size_t k, size_t end, double h, const dem_material *kinds)
{
    const dem_wall_slot *slot = sim->walls.slot;
    const uint32_t w = slot[k].wall, n_kinds = (uint32_t)sim->def.n_kinds;
    const dem_laws law = laws_of(sim, dem_material_at(&sim->def, w, 0));
    dem_vec wall = sim->walls.force[w];
    for (; k < end; k += WIDTH) {
        static const uint32_t all[8] = {0, 1, 2, 3, 4, 5, 6, 7};
        const size_t n = end - k < WIDTH ? end - k : WIDTH;
        uint32_t some[WIDTH], i[WIDTH], entry[WIDTH];
        const uint32_t *at = all;
        if (n < WIDTH) {
            for (size_t p = 0; p < WIDTH; p++) some[p] = (uint32_t)(p < n ? p : n - 1);
            at = some;
        }
        for (size_t p = 0; p < WIDTH; p++) i[p] = slot[k + at[p]].grain;
        for (size_t p = 0; p < WIDTH && kinds; p++)
            entry[p] = (n_kinds + w) * n_kinds + sim->grains.kind[i[p]];
        dem_laws own;
        if (kinds) own = with_coefficients(law, kinds, entry, 1.0);
        const slot_forces b = slot_forces_of(sim, kinds ? &own : &law, slot + k, at, i, h);
        take_slot_forces(sim, k, n, i, &b, &wall);
        sim->too_deep |= b.deep != 0;
    }
    sim->walls.force[w] = wall;
}

static void line(dem_sim *sim, size_t k, size_t end, double h)
{
    line_loop(sim, k, end, h, NULL);
}

static void mixed_line(dem_sim *sim, size_t k, size_t end, double h)
{
    line_loop(sim, k, end, h, sim->def.pairs);
}

/* ---- Motion -------------------------------------------------------------------------------------------- */

/* The forces on GRAINS grains, and their torques in *rest; they become 0 where the goal says so. */
INLINE plane take_force(const dem_sim *sim, size_t i, bool clears, plane *rest)
{
    const plane zero = {0};
    plane force;
    if (!sim->grains.force_torque) {
        force = plane_load(sim->grains.force + i);
        if (clears) plane_store(sim->grains.force + i, zero);
    } else {
        plane_load_records(sim->grains.force_torque + i, &force, rest);
        if (clears) plane_store_records(sim->grains.force_torque + i, zero, zero);
    }
    return force;
}

/* Where a step takes grains, and whether forces become 0 then; WIDTH of them. */
typedef struct {
    dem_motion *motion;
    double *angle, *omega;
    bool clears;
} goal;

typedef struct {
    plane x[PLANES], v[PLANES];
} block;

INLINE block leap(const dem_sim *sim, const dem_equation *e, size_t i, const goal *to)
{
    const dem_grains *g = &sim->grains;
    block b;
    plane rest[PLANES] = {{0}};
    for (size_t p = 0, at = i; p < PLANES; p++, at += GRAINS) {
        const plane force = take_force(sim, at, to->clears, &rest[p]);
        plane_load_records(g->motion + at, &b.x[p], &b.v[p]);
        dem_leap(e, force, num_load_each(g->inverse_mass + at), &b.x[p], &b.v[p]);
        plane_store_records(to->motion + at, b.x[p], b.v[p]);
    }
    if (!to->omega) return b;
    num angle = num_load(g->angle + i), omega = num_load(g->omega + i);
    dem_leap_spin(e, num_firsts(rest), num_load(g->inverse_inertia + i), &angle, &omega);
    num_store(to->angle + i, angle);
    num_store(to->omega + i, omega);
    return b;
}

/* Is any of GRAINS grains at x beyond its margin, or not a number? */
INLINE bool any_beyond(const dem_sim *sim, size_t i, plane x)
{
    return num_any_above(squares_of(x - plane_load(sim->grains.listed_x + i)),
                         num_load_each(sim->grains.margin2 + i));
}

/* With `look`, margins are looked at, else the largest speed is found. */
INLINE void advance_grains(dem_sim *sim, size_t from, size_t to, dem_moved *moved, bool look)
{
    const bool turned = sim->walls.angle != 0.0;
    const dem_equation e = dem_equation_of(sim);
    const goal now = {sim->grains.motion, sim->grains.angle, sim->grains.omega, true};
    const dem_definition *def = &sim->def;
    const plane most = plane_of((dem_vec){turned ? INFINITY : def->x_max, INFINITY}),
                least =
                    plane_of(turned ? (dem_vec){-INFINITY, -INFINITY} : (dem_vec){def->x_min, def->y_min});
    num fast = {0};
    bool far = false, out = false;
    size_t i = from;
    for (; i + WIDTH <= to; i += WIDTH) {
        const block b = leap(sim, &e, i, &now);
        for (size_t p = 0; p < PLANES; p++) {
            if (look) {
                far |= any_beyond(sim, i + p * GRAINS, b.x[p]);
            } else {
                const num square = squares_of(b.v[p]);
                far |= num_any_above(square, (num){0} + DBL_MAX);
                fast = num_max(square, fast);
            }
            out |= plane_any_less(most, b.x[p]);
            out |= plane_any_less(b.x[p], least);
        }
    }
    for (size_t k = from; k < i && turned; k++) out |= dem_beyond(sim, sim->grains.motion[k].x);
    if (!look) moved->speed2 = fmax(moved->speed2, far ? INFINITY : num_largest(fast));
    moved->left |= out * DEM_GRAIN_OUT | (look && far) * DEM_LIST_OUT;
    REST(advance, i, to, moved);
}

static void advance(dem_sim *sim, size_t from, size_t to, dem_moved *moved)
{
    if (sim->pairs.n_chunks > 0)
        advance_grains(sim, from, to, moved, false);
    else
        advance_grains(sim, from, to, moved, true);
}

static void margins(const dem_sim *sim, size_t from, size_t to, dem_moved *moved)
{
    num widest = (num){0} + moved->margin2, most = (num){0} + moved->beyond;
    bool far = false;
    size_t i = from;
    for (; i + GRAINS <= to; i += GRAINS) {
        plane x, v;
        plane_load_records(sim->grains.motion + i, &x, &v);
        const num square = squares_of(x - plane_load(sim->grains.listed_x + i)),
                  margin = num_load_each(sim->grains.margin2 + i);
        far |= num_any_above(square, margin);
        widest = num_max(margin, widest);
        most = num_max(square - margin, most);
    }
    moved->left |= far * DEM_LIST_OUT;
    moved->margin2 = num_largest(widest);
    moved->beyond = num_largest(most);
    REST(margins, i, to, moved);
}

static void predict(dem_sim *sim, size_t from, size_t to, dem_moved *moved)
{
    const dem_equation e = dem_equation_of(sim);
    const goal next = {sim->grains.next_motion, sim->grains.next_angle, sim->grains.next_omega, false};
    bool far = false;
    size_t i = from;
    for (; i + WIDTH <= to; i += WIDTH) {
        const block b = leap(sim, &e, i, &next);
        for (size_t p = 0; p < PLANES; p++) far |= any_beyond(sim, i + p * GRAINS, b.x[p]);
    }
    moved->left |= far * DEM_LIST_OUT;
    REST(predict, i, to, moved);
}

/* ---- Searches ------------------------------------------------------------------------------------------ */

/* Each pair is written; those within the cutoffs are kept, without a branch. */
static void append(dem_sim *sim, size_t i, size_t from, size_t to)
{
    const bool some_fixed = sim->grains.n_fixed > 0;
    const plane x = plane_of(sim->grains.listed_x[i]);
    const num zero = {0}, own = zero + sim->grains.cutoff[i],
              inverse_mass = zero + sim->grains.inverse_mass[i];
    size_t k = sim->pairs.n;
    for (size_t j = from; j < to; j += WIDTH) {
        plane d[PLANES];
        for (size_t p = 0; p < PLANES; p++) d[p] = x - plane_load(sim->grains.listed_x + j + p * GRAINS);
        const num dx = num_firsts(d), dy = num_seconds(d), cutoff = own + num_load(sim->grains.cutoff + j);
        unsigned near = lanes_bits(num_less(dx * dx + dy * dy, cutoff * cutoff));
        if (some_fixed) /* not where both are */
            near &= lanes_bits(num_less(zero, inverse_mass + num_load(sim->grains.inverse_mass + j)));
        if (to - j < WIDTH) near &= (1u << (to - j)) - 1;
        for (size_t p = 0; p < WIDTH; p++) sim->pairs.i[k + p] = (uint32_t)i;
        k = append_bits(sim->pairs.j, k, near, j);
    }
    sim->pairs.n = k;
}

/* Which of WIDTH pairs may touch on their straight lines over the step? All for which time_of_touch in hard.c
 * is finite, and a few more by round-off. Nearer is a soft contact. */
INLINE unsigned may_touch(const dem_sim *sim, const uint32_t *i, const uint32_t *j, num radii)
{
    num x, y, vx, vy;
    num_difference(sim->grains.next_motion, i, j, &x, &y, &vx, &vy);
    const double dt = sim->def.dt;
    const num moved_x = dt * vx, moved_y = dt * vy, start_x = x - moved_x, start_y = y - moved_y;
    const num radii2 = radii * radii, slop = 1e-9 * radii2 + 4.0 * radii * sim->list.round_off,
              gap = start_x * start_x + start_y * start_y - radii2,
              along = start_x * moved_x + start_y * moved_y;
    const unsigned apart = lanes_bits(num_at_most(-slop, gap)) & lanes_bits(num_at_most(along, slop));
    if (WIDTH == 1 && !apart) return 0;
    const num moved2 = moved_x * moved_x + moved_y * moved_y;
    const unsigned ends = lanes_bits(num_at_most(x * x + y * y, radii2 + slop)),
                   turns = lanes_bits(num_at_most((num){0}, x * moved_x + y * moved_y)),
                   meets = lanes_bits(num_at_most((gap - slop) * moved2, along * along));
    return apart & (ends | (turns & meets));
}

static size_t next_approaching(const dem_sim *sim, size_t k, size_t end)
{
    const uint64_t all = (1u << WIDTH) - 1;
    uint64_t left = ~0ull << k % 64;
    for (k -= k % 64; k < end; k += 64, left = ~0ull) {
        left &= ~sim->pairs.touching[k / 64];
        if (end - k < 64) left &= ~(~0ull << (end - k));
        while (left) {
            const size_t shift = (size_t)__builtin_ctzll(left) / WIDTH * WIDTH, at = k + shift;
            const uint64_t near =
                may_touch(sim, sim->pairs.i + at, sim->pairs.j + at, num_load(sim->pairs.radii + at)) &
                left >> shift & all;
            if (near) return at + (size_t)__builtin_ctzll(near);
            left &= ~(all << shift);
        }
    }
    return end;
}

/* Which of WIDTH pairs have one of the first n grains that have collided; n 0: of all that have. */
INLINE unsigned have_collided(const dem_sim *sim, const uint32_t *i, const uint32_t *j, size_t n)
{
    const bool *collided = sim->grains.collided;
    unsigned found = 0;
    for (size_t c = 0; c < n; c++)
        found |= index_equals(i, sim->collided.few[c]) | index_equals(j, sim->collided.few[c]);
    for (size_t p = 0; p < WIDTH && n == 0; p++) found |= (unsigned)(collided[i[p]] | collided[j[p]]) << p;
    return found;
}

INLINE size_t next_of(const dem_sim *sim, size_t n, size_t k, size_t end)
{
    const uint32_t *i = sim->pairs.i, *j = sim->pairs.j;
    for (size_t at = k - k % WIDTH; at < end; at += WIDTH) {
        unsigned found = have_collided(sim, i + at, j + at, n);
        if (at < k) found &= ~0u << (k - at);
        if (found) found &= may_touch(sim, i + at, j + at, num_load(sim->pairs.radii + at));
        if (!found) continue;
        at += (size_t)__builtin_ctz(found);
        return at < end ? at : end;
    }
    return end;
}

static size_t next_collided(const dem_sim *sim, size_t k, size_t end)
{
    return sim->collided.n > DEM_FEW ? next_of(sim, 0, k, end)
           : sim->collided.n > 2     ? next_of(sim, DEM_FEW, k, end)
                                     : next_of(sim, 2, k, end);
}

/* The table of a width, or of other loops over pairs and slots. */
#define LOOPS(word, general, pairs, line, mixed_pairs, mixed_line, next_approaching, next_collided)          \
    {                                                                                                        \
        word, general, "", pairs, line, mixed_pairs, mixed_line, advance, margins, predict, append,          \
            next_approaching, next_collided                                                                  \
    }
