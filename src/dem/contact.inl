/* The one pair loop. kernels.c instantiates it for each law and feature, given as constant arguments, so
 * that a scene pays only for what it uses; the same loop with arguments known at run time is the reference
 * that every instance must match bit for bit. Forces on grain i by grain j: Lee & Herrmann 1993, eq (1). */
static inline __attribute__((always_inline)) void pair_loop(dem_sim *sim, double h, int normal,
                                                            int tangential, int slip, bool tension,
                                                            bool gear)
{
    const dem_record *restrict grain = sim->grain;
    dem_vec *restrict force = sim->force;
    const uint32_t *restrict pair_i = sim->pair_i, *restrict pair_j = sim->pair_j;
    const double *restrict radii = sim->pair_radii, *restrict mass = sim->pair_mass;
    double *restrict spring = sim->spring;
    uint32_t *restrict touching = sim->touching;
    const dem_material c = sim->def.material;
    const double mu = sim->mu, limit = sim->r_min;

    /* which pairs touch; a spring ends with its contact */
    size_t n = 0;
    for (size_t k = 0; k < sim->n_pairs; k++) {
        dem_vec d = grain[pair_i[k]].x - grain[pair_j[k]].x;
        bool touch = dem_dot(d, d) < radii[k] * radii[k];
        touching[n] = (uint32_t)k;
        n += touch;
        if (tangential == DEM_SPRING) spring[k] = touch ? spring[k] : 0.0;
    }
    sim->n_touching = n;

    bool alarm = false;
    for (size_t t = 0; t < n; t++) {
        const size_t k = touching[t], i = pair_i[k], j = pair_j[k];
        dem_vec d = grain[i].x - grain[j].x, v = grain[i].v - grain[j].v;
        double r = sqrt(dem_dot(d, d)), overlap = radii[k] - r;
        dem_vec direction = d * (1.0 / r);
        alarm |= !(overlap <= limit);
        double f_n =
            dem_law_normal(normal, tension, c.k_n, c.gamma_n, mass[k], overlap, dem_dot(v, direction));
        dem_vec f = f_n * direction;
        if (tangential == DEM_SPRING) {
            dem_vec s = dem_clockwise(direction);
            if (gear) spring[k] += dem_dot(sim->gear[i].slide - sim->gear[j].slide, s);
            double f_s =
                dem_law_shear(slip, c.k_s, c.gamma_s, mu, mass[k], dem_dot(v, s), f_n, h, &spring[k]);
            f += f_s * s;
        }
        force[i] += f;
        force[j] -= f;
    }
    sim->alarm |= alarm;
}
