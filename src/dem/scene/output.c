/* Tables of a simulation's state, and notes on a scene's numbers in their headers; see scene.h. A column is a
 * row X(name, value) of a list, of which the header and the rows are made. */
#include <stdlib.h>
#include <string.h>

#include "table/table.h"
#include "dem/scene/scene.h"
#include "dem/state/state.h"

#define NAME(name, value)  ", " name
#define VALUE(name, value) (double)(value),
#define HEADER(COLUMNS)    rp_table_header(out, sim->def.units, &(COLUMNS(NAME))[2])
#define ROW(out, COLUMNS)  put_row(out, sizeof(double[]){COLUMNS(VALUE)}, (double[]){COLUMNS(VALUE)})

/* clang-format off */
#define NOW(X) X("step", step) X("t [s]", dem_time(sim))

#define STATES(X) NOW(X) \
    X("id", p->id) X("x [cm]", p->x) X("y [cm]", p->y) X("angle [rad]", p->angle) \
    X("vx [cm/s]", p->vx) X("vy [cm/s]", p->vy) X("omega [rad/s]", p->omega) \
    X("fx [dyn]", p->fx) X("fy [dyn]", p->fy) X("r [cm]", p->r) X("m [g]", p->m) \
    X("contacts", p->contacts) X("fixed", p->fixed)

#define CONTACTS(X) NOW(X) \
    X("id_a", c->id_a) X("id_b", c->id_b) X("wall", c->wall + 1) \
    X("x [cm]", c->x) X("y [cm]", c->y) X("x_b [cm]", c->x_b) X("y_b [cm]", c->y_b) X("overlap [cm]", c->overlap) \
    X("normal_force [dyn]", c->normal_force) X("shear_force [dyn]", c->shear_force) \
    X("shear_spring [cm]", c->shear_spring) X("rolling_torque [dyn cm]", c->rolling_torque) \
    X("rolling_spring [cm]", c->rolling_spring)

#define WALLS(X) NOW(X) \
    X("wall", k + 1) X("x [cm]", w.point[0]) X("y [cm]", w.point[1]) \
    X("direction_x", w.direction[0]) X("direction_y", w.direction[1]) \
    X("from [cm]", w.ends[0]) X("to [cm]", w.ends[1]) X("fx [dyn]", w.force[0]) X("fy [dyn]", w.force[1])

#define ENERGIES(X) NOW(X) \
    X("grains", n) X("kinetic [erg]", e.kinetic) X("elastic [erg]", e.elastic) X("gravity [erg]", e.gravity) \
    X("kinetic_per_grain [erg]", n > 0.0 ? (e.kinetic + e.rotational) / n : 0.0) \
    X("rotational [erg]", e.rotational)

#define WITH_KIND(X) STATES(X) X("kind", p->kind)

#define NAME_OF(channel, sign)  NAME(#channel " [erg]", 0)
#define VALUE_OF(channel, sign) VALUE(0, l.channel)
#define WITH_LEDGER(X) ENERGIES(X) \
    X("start [erg]", l.start) DEM_LEDGER_LIST(X##_OF) X("at_walls [erg]", l.at_walls) \
    X("turnover [erg]", l.turnover) X("residual [erg]", l.residual)
/* clang-format on */

const char dem_state_columns[] = WITH_KIND(NAME) ", index"; /* the last as pandas writes it */

static void put_row(FILE *out, size_t size, const double *values)
{
    rp_table_row(out, size / sizeof *values, values);
}

/* The names of the kinds from number 1 on, in a line of the header; false: there are none. */
static bool put_kinds(const dem_sim *sim, FILE *out)
{
    if (sim->def.n_kinds < 2) return false;
    fputs("# kinds:", out);
    for (size_t k = 1; k < sim->def.n_kinds; k++) fprintf(out, " %s", sim->def.kinds[k].name);
    return fputc('\n', out), true;
}

void dem_write_columns(dem_table table, const dem_sim *sim, FILE *out)
{
    switch (table) {
    case DEM_TABLE_STATES: put_kinds(sim, out) ? HEADER(WITH_KIND) : HEADER(STATES); break;
    case DEM_TABLE_ENERGY: sim->def.ledger ? HEADER(WITH_LEDGER) : HEADER(ENERGIES); break;
    case DEM_TABLE_CONTACTS: HEADER(CONTACTS); break;
    case DEM_TABLE_WALLS: HEADER(WALLS); break;
    }
}

static rp_status write_states(const dem_sim *sim, long step, FILE *out)
{
    dem_state *states = malloc((dem_count(sim) + 1) * sizeof *states);
    if (!states) return rp_fail(RP_NO_MEMORY, "states: out of memory");
    rp_status status = dem_states(sim, states);
    for (const dem_state *p = states; !status && p < states + dem_count(sim); p++)
        if (sim->def.n_kinds > 1)
            ROW(out, WITH_KIND);
        else
            ROW(out, STATES);
    free(states);
    return status;
}

static rp_status write_contacts(const dem_sim *sim, long step, FILE *out)
{
    dem_contact *contacts;
    size_t n;
    rp_status status = dem_contacts(sim, &contacts, &n);
    for (const dem_contact *c = contacts; !status && c < contacts + n; c++) ROW(out, CONTACTS);
    free(contacts);
    return status;
}

static void write_energy(const dem_sim *sim, long step, FILE *out)
{
    const double n = (double)dem_count(sim);
    dem_energy e;
    dem_ledger l = {0};
    dem_energies(sim, &e);
    if (dem_ledger_read(sim, &l))
        ROW(out, WITH_LEDGER);
    else
        ROW(out, ENERGIES);
}

rp_status dem_write_rows(dem_table table, const dem_sim *sim, long step, FILE *out)
{
    if (table == DEM_TABLE_STATES) return write_states(sim, step, out);
    if (table == DEM_TABLE_CONTACTS) return write_contacts(sim, step, out);
    if (table == DEM_TABLE_ENERGY) return write_energy(sim, step, out), RP_OK;
    for (size_t k = 0; k < sim->def.n_walls; k++) {
        const dem_wall_state w = dem_wall_now(sim, k);
        ROW(out, WALLS);
    }
    return RP_OK;
}

/* ---- notes ---- */

/* The coefficients of kinds, in pairs and at walls; walls that are alike in a row, as sides of a polygon,
 * once.
 */
static void write_pairs(const dem_sim *sim, FILE *out)
{
    const dem_definition *def = &sim->def;
    const size_t n = def->n_kinds;
    for (size_t k = 0; k < n * (n + def->n_walls); k++) {
        const size_t a = k % n, b = k / n;
        const dem_material *m = &def->pairs[k];
        char text[256] = "";
        if (b < n ? b > a : b > n && memcmp(m - a, m - a - n, n * sizeof *m) == 0) continue;
#define COEFFICIENT(kind, type, name, ...)                                                                   \
    DEM_IF_MATERIAL(kind, if (m->name >= 0.0) snprintf(text + strlen(text), sizeof text - strlen(text),      \
                                                       ", " #name " = %.6g", m->name);)
        DEM_PHYSICS(COEFFICIENT)
        if (b < n)
            rp_table_note(out, "contacts", "kinds \"%s\" and \"%s\"%s", def->kinds[b].name,
                          def->kinds[a].name, text);
        else
            rp_table_note(out, "contacts", "kind \"%s\" at wall %zu%s", def->kinds[a].name, b - n + 1, text);
    }
}

void dem_write_notes(const dem_sim *sim, FILE *out)
{
    const rp_units units = sim->def.units;
    const dem_material *c = &sim->def.material;
    const dem_normal_descriptor *law = &dem_normal_descriptors[sim->def.normal];
    const double r = sim->start.radius_mean, k_n = law->scale(c->k_n, 0.5 * r),
                 m_eff = 0.5 * sim->start.mass_mean, v = sim->start.speed;
    rp_table_note(out, "kernel", "%s", sim->loops.name);
    rp_table_note(out, "integrator", "%s", sim->scheme->name);
    rp_table_note(out, "time step", "dt = %.4g %s; limit %s %s, set by %s", sim->def.dt, rp_unit(units, "s"),
                  rp_text_below(sim->start.dt_limit, (char[32]){0}), rp_unit(units, "s"),
                  sim->start.dt_limit_of);
    if (sim->def.pairs) write_pairs(sim, out);
    if (sim->def.pairs || !(c->k_n > 0.0)) return;
    if (law->sticking_speed && sim->def.tension)
        rp_table_note(out, "sticking speed", "%.3g %s: slower impacts of two mean grains do not part",
                      law->sticking_speed(k_n, c->gamma_n, m_eff), rp_unit(units, "cm/s"));
    if (law->modulus)
        rp_table_note(out, "modulus", "E* = %.3g %s at the mean radius; k_n is the same for all radii",
                      law->modulus(c->k_n, r), rp_unit(units, "dyn/cm^2"));
    rp_table_note(out, "normal damping", "gamma_n = %.6g %s", c->gamma_n, rp_unit(units, law->gamma_n_unit));
    if (law->damping_ratio)
        rp_table_note(out, "restitution", "%.4f of two mean grains, at any speed",
                      dem_restitution(sim->def.tension, law->damping_ratio(k_n, c->gamma_n, m_eff)));
    dem_collision_result impact;
    dem_head_on mean = {sim->def.normal, sim->def.tension,          k_n, c->gamma_n,
                        m_eff,           sim->def.restitution_speed};
    if (!law->damping_ratio && isfinite(mean.v) && dem_collision(&mean, &impact) == RP_OK)
        rp_table_note(out, "restitution", "%.4f of two mean grains at %.4g %s; slower impacts lose more",
                      impact.restitution, mean.v, rp_unit(units, "cm/s"));
    mean.v = v;
    if (!(v > 0.0) || dem_collision(&mean, &impact) != RP_OK) return;
    rp_table_note(
        out, "impact",
        "two mean grains at %.4g %s: restitution %.3f, overlap %.3g d, dt/contact time %.3g, error of the "
        "energy about %.2g %%",
        v, rp_unit(units, "cm/s"), impact.restitution, impact.overlap / (2.0 * r), sim->def.dt / impact.time,
        100.0 * dem_impact_error(&mean, impact.restitution, sim->def.dt));
}
