/* Instances of the file's pair_loop: the compiler knows the normal law of each, and all choices of the laws
 * of a box and of dropped piles. */

LAW dem_laws dem_laws_of(const dem_definition *def, const dem_material *c, double mu)
{
    return (dem_laws){def->normal,    def->tangential,
                      def->tension,   c->k_n,
                      c->gamma_n,     dem_slider_of(def->slip, def->damping, c->k_s, c->gamma_s, mu),
                      dem_rolls_of(c)};
}

/* The laws with these choices. */
LAW dem_laws spring_laws(dem_laws law, bool tension, dem_damping damping)
{
    law.tangential = DEM_SPRING, law.tension = tension;
    law.shear.slip = DEM_TRUNCATED, law.shear.damping = damping;
    return law;
}

LAW void run_of_motion(dem_sim *sim, size_t from, size_t to, double h, dem_laws law)
{
    if (!sim->def.rotation)
        pair_loop(sim, from, to, h, law, false, false);
    else if (!sim->pairs.rolling)
        pair_loop(sim, from, to, h, law, true, false);
    else
        pair_loop(sim, from, to, h, law, true, true);
}

LAW void run_of_law(dem_sim *sim, size_t from, size_t to, double h, dem_laws law)
{
    const bool spring = law.tangential == DEM_SPRING && law.shear.slip == DEM_TRUNCATED,
               inside = law.shear.damping == DEM_DAMPING_INSIDE;
    if (spring && law.tension && !inside)
        run_of_motion(sim, from, to, h, spring_laws(law, true, DEM_DAMPING_OUTSIDE));
    else if (spring && !law.tension && inside)
        run_of_motion(sim, from, to, h, spring_laws(law, false, DEM_DAMPING_INSIDE));
    else
        run_of_motion(sim, from, to, h, law);
}

LAW void run_instance(dem_sim *sim, size_t from, size_t to, double h)
{
    dem_laws law = dem_laws_of(&sim->def, &sim->def.material, sim->mu);
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
