/* Checks of what a definition asks for. */
#include <float.h>
#include <math.h>
#include <string.h>

#include "core/elementary.h"
#include "params/units.h"
#include "dem/setup/definition.h"
#include "dem/state/loops.h"
#include "dem/state/method.h"

static bool are_finite(size_t n, const double *numbers)
{
    bool are = true;
    for (size_t i = 0; i < n; i++) are &= isfinite(numbers[i]);
    return are;
}

static rp_status check_number(const char *name, double value, double lo, const char *allowed)
{
    return rp_check_range(name, value, lo, DBL_MAX, allowed);
}

static rp_status check_material(const dem_definition *def, const dem_material *c)
{
    RP_TRY(check_number("k_n", c->k_n, 0.0, "[0, inf)"));
    RP_TRY(check_number("gamma_n", c->gamma_n, 0.0, "[0, inf)"));
    if (dem_has_spring(def->tangential)) RP_TRY(check_number("k_s", c->k_s, DBL_MIN, "(0, inf)"));
    if (dem_has_friction(def->tangential)) RP_TRY(check_number("gamma_s", c->gamma_s, 0.0, "[0, inf)"));
    RP_TRY(rp_check_range("mu", c->mu, 0.0, INFINITY, "[0, inf) | infinite"));
    RP_TRY(rp_check_range("mu_roll", c->mu_roll, 0.0, INFINITY, "[0, inf) | infinite"));
    RP_TRY(dem_material_check(def, c));
    if (dem_has_rolling(def)) RP_TRY(check_number("k_roll", c->k_roll, DBL_MIN, "(0, inf)"));
    if (dem_has_rolling(def)) RP_TRY(check_number("gamma_roll", c->gamma_roll, 0.0, "[0, inf)"));
    return RP_OK;
}

rp_status dem_wall_check(const dem_wall *w)
{
    if (!are_finite(2, w->point))
        return rp_fail(RP_BAD_INPUT, "point = [%g, %g]: finite numbers expected", w->point[0], w->point[1]);
    if (!(fabs(rp_hypot(w->direction[0], w->direction[1]) - 1.0) < 1e-9))
        return rp_fail(RP_BAD_INPUT, "direction = [%g, %g]: a unit vector expected", w->direction[0],
                       w->direction[1]);
    if (!(w->extent[0] < w->extent[1]))
        return rp_fail(RP_BAD_INPUT, "extent = [%g, %g]: the first must be the smaller", w->extent[0],
                       w->extent[1]);
    if (!(w->open_speed >= 0.0) || (isfinite(w->open_speed) && w->open_at_step >= 0 && isinf(w->extent[0])))
        return rp_fail(RP_BAD_INPUT,
                       "open_speed = %g: must be at least 0, and a wall that opens slowly needs a lower end",
                       w->open_speed);
    if (!are_finite(2, w->velocity) || !isfinite(w->omega) || !are_finite(2, w->pivot))
        return rp_fail(RP_BAD_INPUT, "velocity, omega and pivot must be finite");
    if (w->open_at_step >= 0 && isfinite(w->open_speed) && dem_wall_moves(w))
        return rp_fail(RP_BAD_INPUT, "open_speed = %g: a wall that moves can only open at once",
                       w->open_speed);
    return RP_OK;
}

rp_status dem_motion_check(const dem_definition *def, const dem_wall *wall)
{
    if (!dem_wall_moves(wall)) return RP_OK;
    if (def->box_turn_per_step != 0.0)
        return rp_fail(RP_BAD_INPUT, "velocity or omega: not in a box that turns");
    if (!(fabs(wall->omega) * def->dt < 1.0))
        return rp_fail(RP_BAD_INPUT, "omega = %g: must be below one radian a step", wall->omega);
    return RP_OK;
}

/* Would wall a never act, because it stays on the whole line b, to a thousandth of this radius, and has other
 * coefficients or another velocity, or is this line once more? */
static bool is_hidden(const dem_definition *def, size_t k, const dem_wall *a, size_t j, const dem_wall *b,
                      double r)
{
    bool alike = true;
    for (size_t kind = 0; kind == 0 || kind < def->n_kinds; kind++)
        alike &=
            memcmp(dem_material_at(def, k, kind), dem_material_at(def, j, kind), sizeof(dem_material)) == 0;
    const double d[] = {a->point[0] - b->point[0], a->point[1] - b->point[1]},
                 v[] = {a->velocity[0] - b->velocity[0], a->velocity[1] - b->velocity[1]}, *n = a->direction,
                 *m = b->direction;
    if (!dem_wall_is_line(b) || b->open_at_step >= 0 || a->omega != 0.0 || b->omega != 0.0) return false;
    if (fabs(n[0] * m[1] - n[1] * m[0]) > 1e-9 ||
        fabs(d[0] * m[0] + d[1] * m[1]) >
            fmax(1e-9 * rp_hypot(d[0], d[1]), dem_wall_is_line(a) ? 0.0 : 1e-3 * r) ||
        fabs(v[0] * m[0] + v[1] * m[1]) > 1e-9 * rp_hypot(v[0], v[1]))
        return false;
    return dem_wall_is_line(a) ? n[0] * m[0] + n[1] * m[1] > 0.0 : v[0] != 0.0 || v[1] != 0.0 || !alike;
}

rp_status dem_hidden_check(const dem_definition *def, size_t k, const dem_wall *a, size_t j,
                           const dem_wall *b, double r)
{
    if (k == j || !is_hidden(def, k, a, j, b, r)) return RP_OK;
    return rp_fail(
        RP_BAD_INPUT,
        "wall %zu: lies on wall %zu, an infinite line, and would never act: cut the line into segments, "
        "or leave one out",
        k + 1, j + 1);
}

static rp_status check_walls(const dem_definition *def)
{
    const dem_wall *walls = dem_walls_of(def);
    for (size_t k = 0; k < def->n_walls; k++) {
        rp_status status = check_material(def, &walls[k].material);
        if (!status) status = dem_wall_check(&walls[k]);
        if (!status) status = dem_motion_check(def, &walls[k]);
        RP_TRY(rp_prefix(status, "wall %zu: ", k + 1));
    }
    return RP_OK;
}

static rp_status check_ground(const dem_definition *def)
{
    const dem_ground *g = &def->ground;
    if (g->wall == 0) return RP_OK;
    if (g->wall < 0 || (size_t)g->wall > def->n_walls)
        return rp_fail(RP_BAD_INPUT, "ground: wall = %ld: there are %zu walls", g->wall, def->n_walls);
    const dem_wall *w = &dem_walls_of(def)[g->wall - 1];
    if (w->open_at_step >= 0 || !dem_wall_is_line(w) || dem_wall_moves(w))
        return rp_fail(RP_BAD_INPUT, "ground: wall = %ld: must be an infinite line that never opens or moves",
                       g->wall);
    if (dem_has_spring(def->tangential))
        return rp_fail(RP_BAD_INPUT, "ground: the tangential law %s has static friction of its own",
                       dem_tangential_descriptors[def->tangential].name);
    RP_TRY(rp_prefix(check_number("mu_static", g->mu_static, 0.0, "[0, inf)"), "ground: "));
    return rp_prefix(check_number("a", g->a, DBL_MIN, "(0, inf)"), "ground: ");
}

static rp_status check_hard(const dem_definition *def)
{
    const dem_hard *hard = &def->hard;
    if (!hard->on) return RP_OK;
    RP_TRY(rp_check_range("hard: restitution", hard->restitution, 0.0, 1.0, "[0, 1]"));
    RP_TRY(rp_check_range("hard: mu", hard->mu, 0.0, INFINITY, "[0, inf) | infinite"));
    if (def->pairs) return rp_fail(RP_BAD_INPUT, "hard: its collisions are alike for all kinds of grains");
    /* a pair that has just collided must not be held back */
    if (def->tension)
        return rp_fail(RP_BAD_INPUT,
                       "hard: collisions need normal forces that are never attractive, tension = false");
    return RP_OK;
}

rp_status dem_refuse_turn(void)
{
    return rp_fail(RP_BAD_INPUT, "the box turns, but some grains are fixed: they would not turn with it");
}

rp_status dem_grain_check(const dem_definition *def, const dem_grain *p)
{
    RP_TRY(check_number("r", p->r, DBL_MIN, "(0, inf)"));
    RP_TRY(check_number("m", p->m, DBL_MIN, "(0, inf)"));
    if (p->fixed && (p->vx != 0.0 || p->vy != 0.0 || p->omega != 0.0))
        return rp_fail(RP_BAD_INPUT, "vx = %g, vy = %g, omega = %g: must be 0, it is fixed", p->vx, p->vy,
                       p->omega);
    if (p->fixed && def->box_turn_per_step != 0.0) return dem_refuse_turn();
    if (!are_finite(4, (double[]){p->x, p->y, p->vx, p->vy}))
        return rp_fail(RP_BAD_INPUT, "position and velocity must be finite");
    if (!are_finite(2, (double[]){p->angle, p->omega}) ||
        (!def->rotation && (p->angle != 0.0 || p->omega != 0.0)))
        return rp_fail(RP_BAD_INPUT, "angle = %g, omega = %g: %s", p->angle, p->omega,
                       def->rotation ? "must be finite" : "needs rotation");
    const char *beyond = !(p->x >= def->x_min)   ? "x_min"
                         : !(p->x <= def->x_max) ? "x_max"
                         : !(p->y >= def->y_min) ? "y_min"
                                                 : NULL;
    if (beyond) return rp_fail(RP_BAD_INPUT, "x = %g, y = %g: starts beyond %s", p->x, p->y, beyond);
    return RP_OK;
}

static rp_status check_grain_values(const dem_definition *def)
{
    if (def->n_grains == 0 && !(def->radius_to_come > 0.0)) return rp_fail(RP_BAD_INPUT, "no particles");
    if (def->n_grains > DEM_MOST_GRAINS)
        return rp_fail(RP_BAD_INPUT, "%zu particles: at most %d", def->n_grains, DEM_MOST_GRAINS);
    for (size_t i = 0; i < def->n_grains; i++)
        RP_TRY(rp_prefix(dem_grain_check(def, &def->grains[i]), "particle %zu: ", i + 1));
    return RP_OK;
}

rp_status dem_scheme_check(const dem_definition *def)
{
    const dem_scheme *scheme = dem_schemes[def->integrator];
    if (def->rotation && !scheme->rotation)
        return rp_fail(RP_BAD_INPUT, "rotation: grains that rotate need the integrator verlet");
    if (def->hard.on && !scheme->hard)
        return rp_fail(RP_BAD_INPUT, "hard: collisions need the integrator verlet");
    return scheme->check ? scheme->check(def) : RP_OK;
}

rp_status dem_laws_check(const dem_definition *def)
{
    RP_TRY(rp_prefix(check_material(def, &def->material), "particles: "));
    RP_TRY(check_walls(def));
    for (size_t k = 0; def->pairs && k < dem_pair_count(def); k++)
        RP_TRY(dem_pair_prefix(def, k, check_material(def, &def->pairs[k])));
    RP_TRY(check_ground(def));
    RP_TRY(check_hard(def));
    RP_TRY(dem_scheme_check(def));
    if (!dem_kernel_runs(def->kernel))
        return rp_fail(RP_BAD_INPUT, "kernel: this processor has no %s instructions",
                       def->kernel == DEM_AVX512 ? "AVX-512" : "AVX2");
    RP_TRY(check_number("dt", def->dt, DBL_MIN, "(0, inf)"));
    RP_TRY(check_number("skin", def->skin, 0.0, "[0, inf)"));
    if (!are_finite(2, def->gravity) || !(fabs(def->turn_per_step) < 1.0))
        return rp_fail(RP_BAD_INPUT, "gravity and its turn must be finite, the turn below one radian a step");
    if (isnan(def->x_min) || isnan(def->x_max) || isnan(def->y_min))
        return rp_fail(RP_BAD_INPUT, "x_min = %g, x_max = %g, y_min = %g: numbers expected, or infinite",
                       def->x_min, def->x_max, def->y_min);
    if (!(fabs(def->box_turn_per_step) < 1.0))
        return rp_fail(RP_BAD_INPUT, "box_turn_per_step = %g: out of range, allowed: below one radian a step",
                       def->box_turn_per_step);
    return RP_OK;
}

rp_status dem_way_check(double way, double r_min)
{
    if (!(way > r_min)) return RP_OK;
    return rp_fail(RP_BAD_INPUT, "moves %g in one step, the smallest radius is %g", way, r_min);
}

/* Walls against grains, or those to come, and against walls. */
static rp_status check_walls_of_all(const dem_definition *def)
{
    double r_min = def->n_grains ? INFINITY : def->radius_to_come;
    for (size_t i = 0; i < def->n_grains; i++) r_min = fmin(r_min, def->grains[i].r);
    for (size_t k = 0; k < def->n_walls; k++) {
        const dem_wall *walls = dem_walls_of(def);
        const rp_status status = dem_way_check(dem_wall_speed(def, &walls[k]) * def->dt, r_min);
        const char *turns = def->box_turn_per_step != 0.0 ? "box_turn_deg_per_step: " : "";
        RP_TRY(rp_prefix(status, "%swall %zu: ", turns, k + 1));
        for (size_t j = 0; j < def->n_walls; j++)
            RP_TRY(dem_hidden_check(def, k, &walls[k], j, &walls[j], r_min));
    }
    return RP_OK;
}

/* Contacts of the start name grains and walls that there are. */
static rp_status check_contacts(const dem_definition *def)
{
    for (size_t k = 0; k < def->n_contacts; k++) {
        const dem_contact *c = &def->contacts[k];
        const bool with_wall = c->id_b == 0;
        if (c->id_a < 1 || c->id_a > def->n_grains || c->id_b > def->n_grains || c->id_a == c->id_b ||
            (with_wall && (c->wall < 0 || (size_t)c->wall >= def->n_walls)))
            return rp_fail(RP_BAD_INPUT,
                           "contact %zu: of grain %u with %s %d: there are %zu grains and %zu walls", k + 1,
                           c->id_a, with_wall ? "wall" : "grain", with_wall ? c->wall + 1 : (int)c->id_b,
                           def->n_grains, def->n_walls);
        if (!isfinite(c->shear_spring) || !isfinite(c->rolling_spring))
            return rp_fail(RP_BAD_INPUT, "contact %zu: springs of %g and %g: must be finite", k + 1,
                           c->shear_spring, c->rolling_spring);
    }
    return RP_OK;
}

rp_status dem_definition_check(const dem_definition *def)
{
    RP_TRY(check_grain_values(def));
    RP_TRY(check_contacts(def));
    RP_TRY(dem_laws_check(def));
    RP_TRY(check_walls_of_all(def));
    dem_limit_name what;
    double limit = dem_time_step_limit(def, what);
    if (def->dt > limit) return dem_refuse_step(def, limit, what);
    return RP_OK;
}

rp_status dem_material_check(const dem_definition *def, const dem_material *m)
{
    RP_TRY(dem_restitution_check(def, m));
    const char *law = dem_normal_descriptors[def->normal].name;
    if (m->gamma_n < 0.0 && !(m->restitution > 0.0))
        return rp_fail(RP_BAD_INPUT, "gamma_n: has no default for the law %s; give it or restitution", law);
    if (dem_is_of_radius(def->tangential) && dem_schemes[def->integrator]->excess)
        return rp_fail(RP_BAD_INPUT, "the tangential law %s needs the integrator verlet",
                       dem_tangential_descriptors[def->tangential].name);
    if (m->gamma_s < 0.0 && dem_has_friction(def->tangential) && !dem_damps_by_rate(def) &&
        !(dem_is_of_radius(def->tangential) && m->restitution > 0.0))
        return rp_fail(
            RP_BAD_INPUT,
            "gamma_s: has no default for the law %s, whose gamma_n is a number; give a rate, in %s", law,
            rp_unit(def->units, "1/s"));
    if (!dem_has_friction(def->tangential) && m->mu > 0.0)
        return rp_fail(RP_BAD_INPUT, "mu = %g: needs a tangential law, as tangential = { law = \"spring\"; }",
                       m->mu);
    if (!dem_has_friction(def->tangential) && m->mu_roll > 0.0)
        return rp_fail(RP_BAD_INPUT,
                       "mu_roll = %g: needs a tangential law, as tangential = { law = \"spring\"; }",
                       m->mu_roll);
    if (!def->rotation && m->mu_roll > 0.0)
        return rp_fail(RP_BAD_INPUT, "mu_roll = %g: needs rotation = true", m->mu_roll);
    return RP_OK;
}

rp_status dem_physics_check(const dem_definition *def)
{
    RP_TRY(dem_scheme_check(def));
    return dem_material_check(def, &def->material);
}

rp_status dem_density_check(dem_shape shape, rp_units units, bool given)
{
    return given || shape != DEM_DISK || units == RP_CGS
               ? RP_OK
               : rp_fail(RP_BAD_INPUT,
                         "density: the default is that of spheres; give that of the disks, a mass per area%s",
                         units == RP_SI ? " in kg/m^2 (1 g/cm^2 is 10)" : "");
}

rp_status dem_radius_check(double mean, double least, double most)
{
    if (least <= mean && mean <= most) return RP_OK;
    return rp_fail(RP_BAD_INPUT, "radius_mean = %g: must lie between radius_min = %g and radius_max = %g",
                   mean, least, most);
}
