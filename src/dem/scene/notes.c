/* Notes on a scene's numbers in headers of tables. */
#include "params/units.h"
#include "table/table.h"
#include "dem/scene/scene.h"
#include "dem/state/state.h"

void dem_write_notes(const dem_sim *sim, FILE *out)
{
    const dem_material *c = &sim->def.material;
    const dem_normal_descriptor *law = &dem_normal_descriptors[sim->def.normal];
    const double r = sim->start.radius_mean, k_n = law->scale(c->k_n, 0.5 * r),
                 m_eff = 0.5 * sim->start.mass_mean, v = sim->start.speed;
    rp_table_note(out, "kernel", "%s", sim->loops.name);
    rp_table_note(out, "integrator", "%s", sim->scheme->name);
    rp_table_note(out, "time step", "dt = %.4g %s; limit %.3g %s, set by %s", sim->def.dt, rp_unit("s"),
                  sim->start.dt_limit, rp_unit("s"), sim->start.dt_limit_of);
    if (!(c->k_n > 0.0)) return;
    if (law->sticking_speed && sim->def.tension)
        rp_table_note(out, "sticking speed", "%.3g %s: slower impacts of two mean grains do not part",
                      law->sticking_speed(k_n, c->gamma_n, m_eff), rp_unit("cm/s"));
    if (law->modulus)
        rp_table_note(out, "modulus", "E* = %.3g %s at the mean radius; k_n is the same for all radii",
                      law->modulus(c->k_n, r), rp_unit("dyn/cm^2"));
    rp_table_note(out, "normal damping", "gamma_n = %.6g %s", c->gamma_n, rp_unit(law->gamma_n_unit));
    if (law->damping_ratio)
        rp_table_note(out, "restitution", "%.4f of two mean grains, at any speed",
                      dem_restitution(sim->def.tension, law->damping_ratio(k_n, c->gamma_n, m_eff)));
    dem_collision_result impact;
    dem_head_on mean = {sim->def.normal, sim->def.tension,          k_n, c->gamma_n,
                        m_eff,           sim->def.restitution_speed};
    if (!law->damping_ratio && isfinite(mean.v) && dem_collision(&mean, &impact) == RP_OK)
        rp_table_note(out, "restitution", "%.4f of two mean grains at %.4g %s; slower impacts lose more",
                      impact.restitution, mean.v, rp_unit("cm/s"));
    mean.v = v;
    if (!(v > 0.0) || dem_collision(&mean, &impact) != RP_OK) return;
    rp_table_note(
        out, "impact",
        "two mean grains at %.4g %s: restitution %.3f, overlap %.3g d, dt/contact time %.3g, error of the "
        "energy about %.2g %%",
        v, rp_unit("cm/s"), impact.restitution, impact.overlap / (2.0 * r), sim->def.dt / impact.time,
        100.0 * dem_impact_error(&mean, impact.restitution, sim->def.dt));
}
