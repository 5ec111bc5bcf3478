/* The pair loop. Its instances know their normal law and features, so that a scene pays only for what it
 * uses; the loop with all of them known at run time is the reference that every instance must match bit for
 * bit. Forces on grain i by grain j: Lee & Herrmann 1993, eq (1).
 *
 * With rotation the surfaces' spin counts in the shear velocity. The contact lies in the middle of the
 * overlap, at arms from the centres that add up to their distance, so that angular momentum is conserved. A
 * spin counter-clockwise moves the surface of i, at -arm n from its centre, along +s; that of j, at +arm n,
 * along -s; so both add to v_s, and F_s turns both the same way. */
LAW void pair_loop(dem_sim *sim, size_t from, size_t to, double h, dem_laws law, bool rotation, bool rolling)
{
    const dem_motion *restrict grain = sim->grains.motion;
    dem_vec *restrict force = sim->grains.force;
    const uint32_t *restrict pair_i = sim->pairs.i, *restrict pair_j = sim->pairs.j;
    const double *restrict radii = sim->pairs.radii, *restrict mass = sim->pairs.m_eff;
    double *restrict spring = sim->pairs.spring, *restrict roll = sim->pairs.roll;
    const double *restrict radius = sim->grains.radius;
    const double *restrict omega = sim->grains.omega;
    dem_force_torque *restrict force_torque = sim->grains.force_torque;
    uint64_t *restrict touching = sim->pairs.touching;
    const bool has_spring = dem_has_spring(law.tangential);
    const dem_vec *restrict excess = has_spring ? sim->grains.excess : NULL;
    const double limit = sim->r_min;

    bool too_deep = false;
    uint64_t word = 0;
    while (from < to) {
        /* which pairs touch, listed without a branch; a spring ends with its contact */
        enum { BLOCK = 256 };
        uint32_t held[BLOCK + 1];
        size_t n = 0;
        for (const size_t end = from + BLOCK; from < to && from < end; from += 8) {
            unsigned bits = 0;
            for (size_t k = from; k < from + 8; k++) {
                dem_vec d = grain[pair_i[k]].x - grain[pair_j[k]].x;
                const bool touch = dem_dot(d, d) < radii[k] * radii[k];
                bits |= (unsigned)touch << (k - from);
                held[n] = (uint32_t)k;
                n += touch;
                if (has_spring) spring[k] = touch ? spring[k] : 0.0;
                if (rolling) roll[k] = touch ? roll[k] : 0.0;
            }
            dem_note(touching, from, bits, &word);
        }
        for (size_t t = 0; t < n; t++) {
            const size_t k = held[t], i = pair_i[k], j = pair_j[k];
            dem_vec d = grain[i].x - grain[j].x, v = grain[i].v - grain[j].v;
            double r = sqrt(dem_dot(d, d)), overlap = radii[k] - r;
            dem_vec direction = d * (1.0 / r);
            too_deep |= !(overlap <= limit);
            double f_n = dem_law_normal(law.normal, law.tension, law.k_n, law.gamma_n, mass[k], overlap,
                                        dem_dot(v, direction));
            dem_vec f = f_n * direction;
            if (dem_has_friction(law.tangential)) {
                dem_vec s = dem_clockwise(direction);
                double v_s = dem_dot(v, s), arm_i = 0.0, arm_j = 0.0;
                if (rotation) {
                    arm_i = radius[i] - 0.5 * overlap, arm_j = radius[j] - 0.5 * overlap;
                    v_s += arm_i * omega[i] + arm_j * omega[j];
                }
                if (excess) spring[k] += dem_dot(excess[i] - excess[j], s);
                double f_s = dem_law_tangential(law.tangential, law.shear, mass[k], v_s, f_n, h, &spring[k]);
                f += f_s * s;
                if (rotation) {
                    double couple = 0.0;
                    if (rolling) {
                        const double r_eff = radius[i] * radius[j] / radii[k];
                        couple =
                            dem_law_rolling(law.rolls, r_eff, mass[k], omega[i] - omega[j], f_n, h, &roll[k]);
                    }
                    force_torque[i].torque += arm_i * f_s + couple;
                    force_torque[j].torque += arm_j * f_s - couple;
                }
            }
            *(rotation ? &force_torque[i].force : &force[i]) += f;
            *(rotation ? &force_torque[j].force : &force[j]) -= f;
        }
    }
    sim->too_deep |= too_deep;
}
