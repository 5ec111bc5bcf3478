/* Forces of a pile on a level floor and inside it, over the weight; and which contacts are at the limit of
 * friction. */
#include <math.h>

#include "core/arena.h"
#include "core/elementary.h"
#include "experiment/modules/module.h"
#include "stress/stress.h"

static bool is_floor(const exp_view *s, const dem_contact *c)
{
    bool floor = false;
    for (size_t k = 0; k < s->n_walls && c->id_b == 0; k++) floor |= s->walls[k] == (size_t)c->wall;
    return floor;
}

static bool is_in(const exp_view *s, const dem_contact *c)
{
    double x = c->x, y = c->y;
    dem_box_frame(s->sim, &x, &y);
    return x > s->lo[0] && x < s->hi[0] && y > s->lo[1] && y < s->hi[1];
}

enum { N, H, SXX, SXY, SYX, SYY, FRICTION, BULK, COUPLE, WEIGHT_ERROR, BALANCE_ERROR };
static const exp_output outputs[] = {
    {"_n", "weight", "normal force on the floor, over the component of all grains' weight normal to it"},
    {"_h", "weight", "force of the grains along the floor, to the right"},
    {"_sxx", "weight d", "sum over the contacts of force along x times branch along x"},
    {"_sxy", "weight d", "sum of force along x times branch along y"},
    {"_syx", "weight d", "sum of force along y times branch along x"},
    {"_syy", "weight d", "sum of force along y times branch along y"},
    {"_friction", "", "h/n"},
    {"_bulk", "",
     "tangent of the friction angle that the mean stress mobilises; nan if a plane is in tension"},
    {"_couple", "", "half of xy - yx, over the mean pressure"},
    {"_weight_error", "weight",
     "forces of floor and walls and shear through the ends, minus the weight of the grains"},
    {"_balance_error", "m g", "largest net force of contacts and weight on a grain with a contact"},
    {0}};

/* Net force on each grain, by its id: what is missing in the vertical balance of the region, within which
 * contacts cancel; and the largest of a grain. */
static rp_status check_balance(const exp_view *s, size_t n, const dem_contact contacts[], const double g[2],
                               double weight, double out[])
{
    RP_SCOPE(arena);
    double *f, x, y;
    RP_NEW(&arena, f, s->n_all ? 2 * s->all[s->n_all - 1].id : 0);
    for (const dem_contact *c = contacts; c < contacts + n; c++) {
        double force[2];
        exp_contact_force(c, force);
        for (int k = 0; k < 2; k++) {
            f[2 * (c->id_a - 1) + (size_t)k] += force[k];
            if (c->id_b) f[2 * (c->id_b - 1) + (size_t)k] -= force[k];
        }
    }
    out[WEIGHT_ERROR] = out[BALANCE_ERROR] = 0.0;
    for (const dem_state *grain = s->grains; grain < s->grains + s->n; grain++) {
        x = f[2 * (grain->id - 1)] + grain->m * g[0], y = f[2 * (grain->id - 1) + 1] + grain->m * g[1];
        out[WEIGHT_ERROR] += y / weight;
        if (grain->contacts > 0)
            out[BALANCE_ERROR] =
                fmax(out[BALANCE_ERROR], sqrt(x * x + y * y) / (s->m * rp_hypot(g[0], g[1])));
    }
    return RP_OK;
}

static rp_status evaluate(const exp_view *s, const void *params, double out[])
{
    RP_SCOPE(arena);
    const size_t n = s->n_contacts;
    const dem_contact *const contacts = s->contacts;
    stress_contact *forces;
    stress_tensor stress;
    double g[2], y[2] = {s->lo[1], s->hi[1]}, top = -INFINITY, bottom = INFINITY;
    (void)params;
    RP_NEW(&arena, forces, n);
    dem_gravity(s->sim, g);
    const double weight = s->mass * rp_hypot(g[0], g[1]), normal = -s->mass * g[1];
    if (!(normal > 0.0)) return rp_fail(RP_NO_RESULT, "no weight on the floor");
    for (size_t k = 0; k < s->n_walls; k++)
        if (fabs(dem_wall_now(s->sim, s->walls[k]).direction[0]) > 1e-9)
            return rp_fail(RP_NO_RESULT, "the floor is not level");
    out[N] = out[H] = 0.0;
    for (size_t k = 0; k < n; k++) {
        const dem_contact *c = &contacts[k];
        double f[2];
        exp_contact_force(c, f);
        forces[k] = (stress_contact){c->x, c->y, c->x_b, c->y_b, f[0], f[1]};
        top = fmax(top, fmax(c->y, c->y_b)), bottom = fmin(bottom, fmin(c->y, c->y_b));
        if (!is_floor(s, c) || !is_in(s, c)) continue;
        out[N] += f[1] / normal, out[H] -= f[0] / normal;
    }
    /* one cell: the region, whose open ends are beyond all contacts */
    if (isinf(y[0])) y[0] = bottom - s->d;
    if (isinf(y[1])) y[1] = top + s->d;
    if (n == 0 || !(y[1] > y[0])) return rp_fail(RP_NO_RESULT, "no contacts in the region");
    const stress_grid grid = {s->lo[0], y[0], s->hi[0] - s->lo[0], y[1] - y[0], 1, 1};
    const double scale = grid.dx * grid.dy / (normal * s->d);
    RP_TRY(stress_cells(n, forces, &grid, &stress));
    const stress_circle circle = stress_mohr(&stress);
    out[SXX] = scale * stress.xx, out[SXY] = scale * stress.xy;
    out[SYX] = scale * stress.yx, out[SYY] = scale * stress.yy;
    out[FRICTION] = out[H] / out[N],
    out[BULK] = circle.mobilised < 0.5 * M_PI - 1e-9 ? rp_tan(circle.mobilised) : NAN;
    out[COUPLE] = circle.couple / circle.pressure;
    return check_balance(s, n, contacts, g, weight, out);
}

EXP_MODULE(forces, "forces on a level floor, mean stress and balance", "no_pile", exp_no_keys, char, outputs,
           EXP_BOUNDED | EXP_ON_WALL | EXP_ON_CONTACTS, .evaluate = evaluate);

/* ---- the limit of friction ---- */

enum { FLOOR, WALLS, INSIDE, ALL, FORCE };
static const exp_output limit_outputs[] = {
    {"_floor", "", "fraction of the contacts with the floor"},
    {"_walls", "", "fraction of the contacts with other walls"},
    {"_inside", "", "fraction of the contacts between grains"},
    {"_all", "", "fraction of all contacts"},
    {"_force", "", "fraction of the normal force that they carry, without attractive contacts"},
    {0}};

/* Has its spring come to the limit of Coulomb's law? It holds mu times the normal force of its last step, so
 * that a thousandth is left for the force's change. One that pulls is past it. */
static bool at_limit(const dem_contact *c)
{
    return c->mu > 0.0 && c->k_s * fabs(c->shear_spring) >= 0.999 * c->mu * c->normal_force;
}

static rp_status count(const exp_view *s, const void *params, double out[])
{
    double at[INSIDE + 1] = {0}, of[INSIDE + 1] = {0}, force_at = 0.0, force = 0.0;
    (void)params;
    for (const dem_contact *c = s->contacts; c < s->contacts + s->n_contacts; c++) {
        if (!is_in(s, c)) continue;
        const int where = c->id_b ? INSIDE : is_floor(s, c) ? FLOOR : WALLS;
        const bool slides = at_limit(c);
        at[where] += slides, of[where] += 1.0;
        const double pressed = fmax(c->normal_force, 0.0);
        force_at += slides ? pressed : 0.0, force += pressed;
    }
    for (int k = 0; k <= INSIDE; k++) out[k] = at[k] / of[k];
    out[ALL] = (at[FLOOR] + at[WALLS] + at[INSIDE]) / (of[FLOOR] + of[WALLS] + of[INSIDE]);
    out[FORCE] = force_at / force;
    return RP_OK;
}

EXP_MODULE(limit,
           "contacts whose spring is at the limit of friction, or that are attractive, by the place of their "
           "first grain",
           "no_contacts", exp_no_keys, char, limit_outputs, EXP_BOUNDED | EXP_ON_WALL | EXP_ON_CONTACTS,
           .evaluate = count);
