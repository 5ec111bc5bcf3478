/* Tables of a simulation's state; see scene.h. */
#include <stdlib.h>

#include "core/table.h"
#include "dem/scene.h"

void dem_write_state_columns(FILE *out)
{
    static const char *const columns[][2] = {
        {"step", ""},     {"t", "s"},     {"id", ""},     {"x", "cm"},        {"y", "cm"},
        {"angle", "rad"}, {"vx", "cm/s"}, {"vy", "cm/s"}, {"omega", "rad/s"}, {"fx", "dyn"},
        {"fy", "dyn"},    {"r", "cm"},    {"m", "g"},     {"contacts", ""}};
    rp_table_columns(out, sizeof columns / sizeof *columns, columns);
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

rp_status dem_write_contacts(const dem_sim *sim, FILE *out)
{
    static const char *const columns[][2] = {{"id_a", ""},
                                             {"id_b", ""},
                                             {"wall", ""},
                                             {"x", "cm"},
                                             {"y", "cm"},
                                             {"x_b", "cm"},
                                             {"y_b", "cm"},
                                             {"overlap", "cm"},
                                             {"normal_force", "dyn"},
                                             {"shear_force", "dyn"},
                                             {"shear_spring", "cm"},
                                             {"rolling_torque", "dyn cm"},
                                             {"rolling_spring", "cm"}};
    dem_contact *contacts;
    size_t n;
    rp_status status = dem_contacts(sim, &contacts, &n);
    rp_table_columns(out, sizeof columns / sizeof *columns, columns);
    for (size_t k = 0; !status && k < n; k++) {
        const dem_contact *c = &contacts[k];
        rp_table_row(out, 13,
                     (double[]){c->id_a, c->id_b, c->wall + 1, c->x, c->y, c->x_b, c->y_b, c->overlap,
                                c->normal_force, c->shear_force, c->shear_spring, c->rolling_torque,
                                c->rolling_spring});
    }
    free(contacts);
    return status;
}

/* Without a ledger the columns end before its own. */
enum { ENERGY_COLUMNS = 8 };

void dem_write_energy_columns(bool ledger, FILE *out)
{
    static const char *const columns[][2] = {{"step", ""},
                                             {"t", "s"},
                                             {"grains", ""},
                                             {"kinetic", "erg"},
                                             {"elastic", "erg"},
                                             {"gravity", "erg"},
                                             {"kinetic_per_grain", "erg"},
                                             {"rotational", "erg"},
                                             {"start", "erg"},
#define X(channel, sign) {#channel, "erg"},
                                             DEM_LEDGER_LIST(X)
#undef X
                                                 {"at_walls", "erg"},
                                             {"turnover", "erg"},
                                             {"residual", "erg"}};
    rp_table_columns(out, ledger ? sizeof columns / sizeof *columns : ENERGY_COLUMNS, columns);
}

void dem_write_energy(const dem_sim *sim, FILE *out)
{
    const double n = (double)dem_count(sim);
    dem_energy e;
    dem_ledger l = {0};
    const bool ledger = dem_ledger_read(sim, &l);
    dem_energies(sim, &e);
    const double row[] = {(double)dem_step(sim),
                          dem_time(sim),
                          n,
                          e.kinetic,
                          e.elastic,
                          e.gravity,
                          n > 0.0 ? (e.kinetic + e.rotational) / n : 0.0,
                          e.rotational,
                          l.start,
#define X(channel, sign) l.channel,
                          DEM_LEDGER_LIST(X)
#undef X
                              l.at_walls,
                          l.turnover,
                          l.residual};
    rp_table_row(out, ledger ? sizeof row / sizeof *row : ENERGY_COLUMNS, row);
}
