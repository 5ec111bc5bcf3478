/* Tables of a simulation's state; see scene.h. */
#include <stdlib.h>

#include "table/table.h"
#include "dem/scene/scene.h"
#include "dem/state/state.h"

void dem_write_state_columns(FILE *out)
{
    rp_table_header(out, "step, t [s], id, x [cm], y [cm], angle [rad], vx [cm/s], vy [cm/s], omega [rad/s], "
                         "fx [dyn], fy [dyn], r [cm], m [g], contacts");
}

rp_status dem_write_states(const dem_sim *sim, FILE *out)
{
    dem_state *states = malloc((dem_count(sim) + 1) * sizeof *states);
    if (!states) return rp_fail(RP_NO_MEMORY, "states: out of memory");
    rp_status status = dem_states(sim, states);
    for (size_t i = 0; !status && i < dem_count(sim); i++) {
        const dem_state *p = &states[i];
        rp_table_row(out, 14,
                     (double[]){(double)dem_step(sim), dem_time(sim), p->id, p->x, p->y, p->angle, p->vx,
                                p->vy, p->omega, p->fx, p->fy, p->r, p->m, p->contacts});
    }
    free(states);
    return status;
}

void dem_write_contact_columns(FILE *out)
{
    rp_table_header(out, "step, t [s], id_a, id_b, wall, x [cm], y [cm], x_b [cm], y_b [cm], overlap [cm], "
                         "normal_force [dyn], shear_force [dyn], shear_spring [cm], rolling_torque [dyn cm], "
                         "rolling_spring [cm]");
}

rp_status dem_write_contacts(const dem_sim *sim, FILE *out)
{
    dem_contact *contacts;
    size_t n;
    rp_status status = dem_contacts(sim, &contacts, &n);
    for (size_t k = 0; !status && k < n; k++) {
        const dem_contact *c = &contacts[k];
        rp_table_row(out, 15,
                     (double[]){(double)dem_step(sim), dem_time(sim), c->id_a, c->id_b, c->wall + 1, c->x,
                                c->y, c->x_b, c->y_b, c->overlap, c->normal_force, c->shear_force,
                                c->shear_spring, c->rolling_torque, c->rolling_spring});
    }
    free(contacts);
    return status;
}

void dem_write_wall_columns(FILE *out)
{
    rp_table_header(out, "step, t [s], wall, x [cm], y [cm], direction_x, direction_y, from [cm], to [cm], "
                         "fx [dyn], fy [dyn]");
}

rp_status dem_write_walls(const dem_sim *sim, FILE *out)
{
    for (size_t k = 0; k < sim->def.n_walls; k++) {
        const dem_wall_state w = dem_wall_now(sim, k);
        rp_table_row(out, 11,
                     (double[]){(double)dem_step(sim), dem_time(sim), (double)k + 1.0, w.point[0], w.point[1],
                                w.direction[0], w.direction[1], w.ends[0], w.ends[1], w.force[0],
                                w.force[1]});
    }
    return RP_OK;
}

/* Columns without a ledger, and its own. */
#define ENERGIES                                                                                             \
    "step, t [s], grains, kinetic [erg], elastic [erg], gravity [erg], kinetic_per_grain [erg], "            \
    "rotational [erg]"
#define CHANNEL(channel, sign) ", " #channel " [erg]"
#define LEDGER                 ", start [erg]" DEM_LEDGER_LIST(CHANNEL) ", at_walls [erg], turnover [erg], residual [erg]"

void dem_write_energy_columns(bool ledger, FILE *out)
{
    rp_table_header(out, ledger ? ENERGIES LEDGER : ENERGIES);
}

void dem_write_energy(const dem_sim *sim, FILE *out)
{
    enum { WITHOUT_LEDGER = 8 };
    const double n = (double)dem_count(sim);
    dem_energy e;
    dem_ledger l = {0};
    const bool ledger = dem_ledger_read(sim, &l);
    dem_energies(sim, &e);
    const double per_grain = n > 0.0 ? (e.kinetic + e.rotational) / n : 0.0;
#define VALUE(channel, sign) l.channel,
    const double row[] = {(double)dem_step(sim),
                          dem_time(sim),
                          n,
                          e.kinetic,
                          e.elastic,
                          e.gravity,
                          per_grain,
                          e.rotational,
                          l.start,
                          DEM_LEDGER_LIST(VALUE) l.at_walls,
                          l.turnover,
                          l.residual};
    rp_table_row(out, ledger ? sizeof row / sizeof *row : WITHOUT_LEDGER, row);
}
