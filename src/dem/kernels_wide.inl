/* The pair loop of contact.inl and the integration of integrators.c for several pairs or grains at once, with
 * the same operations in the same order for each of them, and the same order of the sums of each grain. A
 * file that includes this one asks for instructions first, and defines WIDE_CHOOSE, the function, and
 * WIDE_NAME. */
#include <math.h>

#include "dem/simd.h"

#define INLINE static inline __attribute__((always_inline))

/* law_normal.h */
INLINE wide law_normal(int law, bool tension, const dem_material *c, wide m_eff, wide overlap, wide v_n)
{
    const wide zero = {0};
    wide elastic = law == DEM_HERTZ ? c->k_n * overlap * wide_sqrt(overlap) : c->k_n * overlap;
    wide f = elastic - c->gamma_n * m_eff * v_n;
    return tension ? f : wide_max(f, zero);
}

/* law_shear.h; the division only where a contact slides. */
INLINE wide law_shear(int slip, const dem_material *c, double mu, wide m_eff, wide v_s, wide f_n, double h,
                      lanes touch, wide *spring)
{
    const wide zero = {0};
    wide ds = *spring + v_s * h;
    wide cap = mu * wide_max(f_n, zero);
    wide pull = c->k_s * ds;
    lanes slides = wide_less(cap, wide_abs(pull));
    wide held = wide_choose(slides, wide_copysign(cap, pull), pull);
    if (slip == DEM_TRUNCATED && wide_bits(slides) & wide_bits(touch))
        ds = wide_choose(slides, held / c->k_s, ds);
    *spring = ds;
    return -c->gamma_s * m_eff * v_s - held;
}

/* A block in which no pair touches is left at once. In any other all is computed for all pairs; those that do
 * not touch then get a spring and a force of 0, and 0 added to a force changes no bit: no force is ever -0,
 * since it starts from +0. The list ends in pairs that never touch. */
INLINE void pair_loop(dem_sim *sim, double h, int normal, int tangential, int slip, bool tension)
{
    const dem_record *restrict grain = sim->grain;
    dem_vec *restrict force = sim->force;
    double *restrict spring = sim->spring;
    uint32_t *restrict touching = sim->touching;
    const dem_material c = sim->def.material;
    const double mu = sim->mu;
    const wide zero = {0}, limit = zero + sim->r_min;
    size_t n = 0;
    unsigned alarm = 0;
    for (size_t k = 0; k < sim->n_pairs; k += WIDTH) {
        const uint32_t *i = sim->pair_i + k, *j = sim->pair_j + k;
        wide x, y, vx, vy;
        wide_difference(grain, i, j, &x, &y, &vx, &vy);
        const wide radii = wide_load(sim->pair_radii + k), r2 = x * x + y * y;
        const lanes touch = wide_less(r2, radii * radii);
        if (!wide_bits(touch)) {
            if (tangential == DEM_SPRING) wide_store(spring + k, zero);
            continue;
        }
        n = wide_append(touching, n, touch, k);
        const wide r = wide_sqrt(r2), inverse = 1.0 / r, overlap = radii - r, nx = x * inverse,
                   ny = y * inverse, m_eff = wide_load(sim->pair_mass + k);
        alarm |= wide_bits(touch) & ~wide_bits(wide_at_most(overlap, limit));
        wide f_n = law_normal(normal, tension, &c, m_eff, overlap, vx * nx + vy * ny);
        wide fx = f_n * nx, fy = f_n * ny;
        if (tangential == DEM_SPRING) {
            /* along s = (ny, -nx), the normal turned clockwise */
            wide ds = wide_load(spring + k);
            wide f_s = law_shear(slip, &c, mu, m_eff, vx * ny - vy * nx, f_n, h, touch, &ds);
            wide_store(spring + k, wide_choose(touch, ds, zero));
            fx = fx + f_s * ny;
            fy = fy - f_s * nx;
        }
        dem_vec f[WIDTH];
        wide_store_vectors(f, wide_choose(touch, fx, zero), wide_choose(touch, fy, zero));
        for (int p = 0; p < WIDTH; p++) {
            force[i[p]] += f[p];
            force[j[p]] -= f[p];
        }
    }
    sim->n_touching = n;
    sim->alarm |= alarm != 0;
}

/* As dem_integrate; returns for how many grains. */
static size_t advance(dem_sim *sim, bool *stale)
{
    enum { GRAINS = WIDTH / 2, ALL = (1 << WIDTH) - 1 };
    const double dt = sim->def.dt;
    const wide zero = {0}, gravity = wide_repeat(sim->gravity), reach = zero + 0.25 * sim->skin * sim->skin,
               most = wide_repeat((dem_vec){sim->def.x_max, INFINITY}),
               least = wide_repeat((dem_vec){-INFINITY, sim->def.y_min});
    unsigned out = 0;
    size_t i = 0;
    for (; i + GRAINS <= sim->n; i += GRAINS) {
        double *force = (double *)(sim->force + i);
        wide x, v;
        wide_load_records(sim->grain + i, &x, &v);
        v = v + dt * (wide_load(force) * wide_load_twice(sim->inverse_mass + i) + gravity);
        x = x + dt * v;
        wide moved = x - wide_load((const double *)(sim->ref + i));
        wide_store_records(sim->grain + i, x, v);
        wide_store(force, zero);
        /* written so that NaN counts as moved */
        out |= (wide_bits(wide_at_most(wide_sums(moved * moved), reach)) ^ ALL) |
               wide_bits(wide_less(most, x)) | wide_bits(wide_less(x, least));
    }
    *stale |= out != 0;
    return i;
}

/* name, normal law, tangential law, slip */
#define LAWS(X)                                                                                              \
    X(hertz_none, DEM_HERTZ, DEM_NONE, DEM_TRUNCATED)                                                        \
    X(hertz_truncated, DEM_HERTZ, DEM_SPRING, DEM_TRUNCATED)                                                 \
    X(hertz_total, DEM_HERTZ, DEM_SPRING, DEM_TOTAL)                                                         \
    X(linear_none, DEM_LINEAR, DEM_NONE, DEM_TRUNCATED)                                                      \
    X(linear_truncated, DEM_LINEAR, DEM_SPRING, DEM_TRUNCATED)                                               \
    X(linear_total, DEM_LINEAR, DEM_SPRING, DEM_TOTAL)

#define X(name, normal, tangential, slip)                                                                    \
    static void name##_pull(dem_sim *sim, double h)                                                          \
    {                                                                                                        \
        pair_loop(sim, h, normal, tangential, slip, true);                                                   \
    }                                                                                                        \
    static void name##_push(dem_sim *sim, double h)                                                          \
    {                                                                                                        \
        pair_loop(sim, h, normal, tangential, slip, false);                                                  \
    }
LAWS(X)
#undef X

void WIDE_CHOOSE(dem_sim *sim)
{
    static const struct {
        const char *name;
        dem_kernel *kernel;
        int normal, tangential, slip;
        bool tension;
    } list[] = {
#define X(name, normal, tangential, slip)                                                                    \
    {#name "_pull_" WIDE_NAME, name##_pull, normal, tangential, slip, true},                                 \
        {#name "_push_" WIDE_NAME, name##_push, normal, tangential, slip, false},
        LAWS(X)
#undef X
    };
    const dem_definition *def = &sim->def;
    for (size_t i = 0; i < sizeof list / sizeof *list; i++)
        if (list[i].normal == def->normal && list[i].tangential == def->tangential &&
            (def->tangential == DEM_NONE || list[i].slip == def->slip) && list[i].tension == def->tension) {
            sim->kernel = list[i].kernel;
            sim->kernel_name = list[i].name;
        }
    sim->advance = advance;
}
