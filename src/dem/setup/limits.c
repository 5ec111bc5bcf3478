/* The speeds that a definition's walls have, and its impacts will have; its largest stable time step, from
 * the rates of its quickest contacts. */

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "core/elementary.h"
#include "params/units.h"
#include "dem/setup/definition.h"
#include "dem/forces/forces.h"
#include "dem/law/law.h"

/* ---- Speeds ---- */

static dem_vec end_of(const dem_wall *wall, int end)
{
    const dem_vec direction = dem_vec_of(wall->direction);
    return dem_vec_of(wall->point) + wall->extent[end] * dem_clockwise(direction);
}

double dem_wall_speed(const dem_definition *def, const dem_wall *wall)
{
    dem_wall w = *wall;
    if (def->box_turn_per_step != 0.0) /* about the origin */
        w.omega = def->box_turn_per_step / def->dt, w.pivot[0] = w.pivot[1] = 0.0;
    if (!dem_wall_moves(&w)) return 0.0;
    double reach = dem_wall_reach(&w);
    const bool line = isinf(reach);
    if (line) reach = 0.0;
    for (size_t i = 0; i < def->n_grains && line; i++)
        reach = fmax(reach, rp_hypot(def->grains[i].x - w.pivot[0], def->grains[i].y - w.pivot[1]));
    return rp_hypot(w.velocity[0], w.velocity[1]) + fabs(w.omega) * reach;
}

double dem_impact_speed(const dem_definition *def)
{
    double speed = 0.0, low = INFINITY, high = -INFINITY;
    const double *g = def->gravity;
    for (size_t i = 0; i < def->n_grains; i++) {
        const dem_grain *p = &def->grains[i];
        double height = -(g[0] * p->x + g[1] * p->y); /* times g */
        speed = fmax(speed, rp_hypot(p->vx, p->vy));
        low = fmin(low, height);
        high = fmax(high, height);
    }
    for (size_t w = 0; w < def->n_walls; w++) {
        const dem_wall *wall = &dem_walls_of(def)[w];
        const double *n = wall->direction, *q = wall->point;
        speed = fmax(speed, dem_wall_speed(def, wall));
        for (int end = 0; end < 2 && dem_wall_moves(wall); end++) {
            const dem_vec p = end_of(wall, end);
            if (isfinite(p[0] + p[1])) high = fmax(high, -(g[0] * p[0] + g[1] * p[1]));
        }
        /* a wall along gravity has no height of its own */
        if (fabs(n[0] * g[0] + n[1] * g[1]) > 1e-6 * rp_hypot(g[0], g[1]))
            low = fmin(low, -(g[0] * q[0] + g[1] * q[1]));
    }
    return 2.0 * speed + (high > low ? sqrt(2.0 * (high - low)) : 0.0);
}

/* ---- Steps ---- */

/* The stiffest and the most damped motion of a packing in which every contact is as this one, over a third of
 * what a pair's are. Of normal forces alone a triangular packing's modes have 3 k_n/m_eff at most; with shear
 * springs 3 k_n + k_s, or the other way round, at the edges of its cell of wave numbers, and
 * 9/4 (k_n + k_s) in the corners. Where grains rotate, J = m r^2/I, they do so the fastest when all turn
 * alike, 6 J k_s; rolling resistance then rests, but 3 J k_roll at R_eff <= r/2 bound what it adds. */
static double packing_sum(double normal, double shear, double roll, double turns)
{
    const double edge = fmax(normal, shear) + fmin(normal, shear) / 3.0, corner = 0.75 * (normal + shear);
    return fmax(fmax(edge, corner), turns * (2.0 * shear + roll));
}

/* Effective mass, coordination number over six, and effective radius of two grains or of a grain and a fixed
 * body. */
typedef struct {
    double m_eff, coordination, r_eff;
} contact_pair;

/* Largest coordination number of a grain, over six: a large grain among small ones has more neighbours. */
static double coordination_of(double r, double r_min)
{
    return fmax(1.0, M_PI / 6.0 / rp_asin(r_min / (r + r_min)));
}

/* Each of the two has as many contacts as it can; m_b may be INFINITY. */
static contact_pair pair_of(double m_a, double coordination_a, double m_b, double coordination_b,
                            double r_eff)
{
    const double inverse = 1.0 / m_a + 1.0 / m_b;
    return (contact_pair){1.0 / inverse, (coordination_a / m_a + coordination_b / m_b) / inverse, r_eff};
}

/* Stiffness and damping of a contact at this overlap: normal, of shear, of rolling. */
typedef struct {
    double k[3], gamma[3];
} contact_laws;

static contact_laws laws_at(const dem_definition *def, const dem_material *c, contact_pair of, double overlap)
{
    const dem_normal_descriptor *law = &dem_normal_descriptors[def->normal];
    const double scaled = law->scale(c->k_n, of.r_eff);
    double unused = 0.0;
    dem_slider slider = dem_slider_of(def->slip, def->damping, c->k_s, c->gamma_s, 0.0),
               roll = dem_rolls_of(def->rolling, def->tangential, dem_arm_of(def, c), c->k_roll,
                                   c->gamma_roll, c->mu_roll);
    if (dem_is_of_radius(def->tangential)) {
        slider = dem_law_at_overlap(slider, of.r_eff, of.m_eff, overlap, overlap, &unused);
        roll = dem_law_at_overlap(roll, of.r_eff, of.m_eff, overlap, overlap, &unused);
    }
    if (!dem_rolls_by_spring(def->rolling)) roll.k = 0.0;
    if (!dem_rolls_by_dashpot(def->rolling)) roll.gamma = 0.0;
    if (dem_rolls_by_speed(def->rolling)) /* of the spring's force at this overlap */
        roll.gamma = roll.mu * dem_law_elastic(def->normal, scaled, overlap) / of.m_eff;
    const bool shear = dem_has_friction(def->tangential), spring = dem_has_spring(def->tangential),
               rolls = shear && c->mu_roll > 0.0;
    return (contact_laws){{law->stiffness(scaled, overlap), spring ? slider.k : 0.0, rolls ? roll.k : 0.0},
                          {law->damping_rate(scaled, c->gamma_n, of.m_eff, overlap),
                           shear ? slider.gamma : 0.0, rolls ? roll.gamma : 0.0}};
}

/* A limit, and what sets it. */
typedef struct {
    double dt;
    const char *of;
} step_bound;

static double stable_step(const dem_definition *def, const contact_laws *laws, contact_pair of, dem_load load)
{
    const double turns = def->rotation ? 1.0 / dem_inertia(def->shape, 1.0, 1.0) : 0.0, *k = laws->k,
                 *gamma = laws->gamma;
    const dem_rates rates = {.gamma = of.coordination * packing_sum(gamma[0], gamma[1], gamma[2], turns),
                             .omega2 = of.coordination / of.m_eff * packing_sum(k[0], k[1], k[2], turns)};
    const dem_scheme *scheme = dem_schemes[def->integrator];
    return scheme->step_limit ? scheme->step_limit(def, rates, load) : INFINITY;
}

/* Largest time step of a contact at this overlap. What sets it is what, left out, raises it the most. */
static step_bound contact_step_limit(const dem_definition *def, const dem_material *c, contact_pair of,
                                     double overlap, dem_load load)
{
    static const char *const names[] = {"impacts", "k_s", "rolling", "gamma_n", "gamma_s", "rolling"};
    const contact_laws laws = laws_at(def, c, of, overlap);
    step_bound limit = {stable_step(def, &laws, of, load), names[0]};
    double most = limit.dt;
    for (int i = 0; i < 6; i++) {
        contact_laws without = laws;
        (i < 3 ? without.k : without.gamma)[i % 3] = 0.0;
        const double dt = stable_step(def, &without, of, load);
        if (dt > most) most = dt, limit.of = names[i];
    }
    return limit;
}

static void lower(step_bound t, step_bound *limit)
{
    if (t.dt < limit->dt) *limit = t;
}

/* Largest time step for impacts at speed v, and for a contact at rest under a column as high as v is fallen
 * from, of grains of radius r. Energy is that of the many, whose m_eff is m_mean, or of 2.5 times the
 * lightest. */
static step_bound speed_step_limit(const dem_definition *def, const dem_material *c, contact_pair of,
                                   double m_mean, double r, double v)
{
    const dem_normal_descriptor *law = &dem_normal_descriptors[def->normal];
    if (!(c->k_n > 0.0)) return contact_step_limit(def, c, of, 0.0, DEM_AT_IMPACT);
    const double k_n = law->scale(c->k_n, of.r_eff), impact = law->impact_overlap(k_n, of.m_eff, v),
                 weight = of.m_eff * v * v / (4.0 * r), rest = law->rest_overlap(k_n, weight);
    step_bound limit = contact_step_limit(def, c, of, impact, DEM_AT_IMPACT);
    lower(contact_step_limit(def, c, of, rest, DEM_AT_REST), &limit);
    const dem_scheme *scheme = dem_schemes[def->integrator];
    if (!(v > 0.0) || def->hard.on || !scheme->impact_limit) return limit;
    const double grown = fmin(fmax(m_mean / of.m_eff, 1.0), 2.5);
    of.m_eff *= grown, of.r_eff *= rp_pow(grown, 1.0 / 3.0);
    const double deepest = law->impact_overlap(law->scale(c->k_n, of.r_eff), of.m_eff, v);
    const contact_laws laws = laws_at(def, c, of, deepest);
    lower(contact_step_limit(def, c, of, law->rest_overlap(law->scale(c->k_n, of.r_eff), grown * weight),
                             DEM_OF_MANY),
          &limit);
    const double omega = sqrt(laws.k[0] / of.m_eff);
    /* Without damping, the error of an impact's energy stays below 1 % if the way to the deepest point would
     * take five steps at the first speed. */
    lower((step_bound){fmax(impact / (5.0 * v),
                            scheme->impact_limit(def, laws.gamma[0] / omega, laws.k[1] / laws.k[0]) / omega),
                       "little damped impacts"},
          &limit);
    return limit;
}

/* The same for a well of the ground under a column as high as v is fallen from. An impact's larger force
 * makes it stiffer, but breaks it or is over before that can grow. */
static double well_step_limit(const dem_definition *def, double m, double r, double v)
{
    const double stiffness = def->ground.mu_static *
                             fmax(m * v * v / (4.0 * r), m * rp_hypot(def->gravity[0], def->gravity[1])) /
                             def->ground.a;
    return stiffness > 0.0 ? 0.85 * 4.0 / sqrt(12.0 * stiffness / m) : INFINITY;
}

/* Mass for each place of a neighbour. */
static double lightness(const dem_grain *p, double r_min)
{
    return p->m / coordination_of(p->r, r_min);
}

static bool is_of(const dem_definition *def, const dem_grain *p, size_t kind)
{
    return !def->pairs || p->kind == kind;
}

/* The grain of a kind that is quickest in a coordination, of those that move, but one; NULL: there is none.
 */
static const dem_grain *lightest_of(const dem_definition *def, double r_min, size_t kind,
                                    const dem_grain *but)
{
    const dem_grain *lightest = NULL;
    double least = INFINITY;
    for (const dem_grain *p = def->grains; p < def->grains + def->n_grains; p++) {
        if (!is_of(def, p, kind) || p->fixed || p == but) continue;
        const double m = lightness(p, r_min);
        if (m < least) least = m, lightest = p;
    }
    return lightest;
}

/* Mean mass of the grains that move, or of those to come. */
static double mean_mass(const dem_definition *def)
{
    double sum = 0.0, n = 0.0;
    for (size_t i = 0; i < def->n_grains; i++)
        if (!def->grains[i].fixed) sum += def->grains[i].m, n += 1.0;
    return def->mass_to_come > 0.0 ? def->mass_to_come : sum / n;
}

/* Lower the limit to t, of this contact; at a wall, from 1. */
static void lower_to(step_bound t, const char *contact, size_t wall, double *limit, dem_limit_name what)
{
    if (t.dt >= *limit) return;
    *limit = t.dt;
    snprintf(what, sizeof(dem_limit_name), "%s%s%s", t.of, *t.of ? " of " : "", contact);
    if (wall) snprintf(what + strlen(what), sizeof(dem_limit_name) - strlen(what), " at wall %zu", wall);
}

/* All grains: radii, of those that move too; mean mass; speed of impacts. */
typedef struct {
    double r_min, r_max, r_moves, m_mean, v;
} bed;

/* The first, where the other can't move. */
static contact_pair one_of(const dem_grain *p, const bed *all)
{
    return pair_of(p->m, coordination_of(p->r, all->r_min), INFINITY, 0.0, p->r);
}

/* Lower the limit to that of the lightest grains of two kinds, or of one and a fixed grain. */
static void lower_to_kinds(const dem_definition *def, const bed *all, size_t a, size_t b, double *limit,
                           dem_limit_name what)
{
    const dem_grain *p = lightest_of(def, all->r_min, a, NULL), *q = lightest_of(def, all->r_min, b, p);
    dem_limit_name of = "two of the lightest grains";
    size_t others = 0;
    for (size_t i = 0; i < def->n_grains && !(p && q); i++) others += is_of(def, &def->grains[i], p ? b : a);
    if ((!p && !q) || (!(p && q) && others <= (a == b))) return;
    if (!p || (q && lightness(q, all->r_min) < lightness(p, all->r_min))) {
        const dem_grain *const heavier = p;
        p = q, q = heavier;
    }
    const contact_pair two =
        q ? pair_of(p->m, coordination_of(p->r, all->r_min), q->m, coordination_of(q->r, all->r_min),
                    p->r * all->r_max / (p->r + all->r_max))
          : one_of(p, all);
    if (def->pairs)
        snprintf(of, sizeof of, "kinds \"%.20s\" and \"%.20s\"", def->kinds[a].name, def->kinds[b].name);
    lower_to(speed_step_limit(def, dem_pair_material(def, a, b), two, q ? 0.5 * all->m_mean : all->m_mean,
                              all->r_moves, all->v),
             of, 0, limit, what);
}

/* The same at the walls. */
static void lower_to_walls(const dem_definition *def, const bed *all, size_t a, double *limit,
                           dem_limit_name what)
{
    const dem_grain *p = lightest_of(def, all->r_min, a, NULL);
    dem_limit_name of = "the lightest grain";
    if (def->pairs) snprintf(of, sizeof of, "kind \"%s\"", def->kinds[a].name);
    for (size_t w = 0; w < def->n_walls && p; w++) {
        if (dem_wall_moves(&dem_walls_of(def)[w]))
            lower_to((step_bound){all->r_min / dem_wall_speed(def, &dem_walls_of(def)[w]), ""},
                     "a way below the smallest radius", w + 1, limit, what);
        lower_to(speed_step_limit(def, dem_material_at(def, w, a), one_of(p, all), all->m_mean, all->r_moves,
                                  all->v),
                 of, w + 1, limit, what);
        if ((int)w + 1 == def->ground.wall)
            lower_to((step_bound){well_step_limit(def, p->m, all->r_moves, all->v), ""},
                     "the lightest grain in a well of the ground", 0, limit, what);
    }
}

static double step_limit(const dem_definition *def, dem_limit_name what)
{
    snprintf(what, sizeof(dem_limit_name), "nothing: the integrator is implicit");
    if (!dem_schemes[def->integrator]->step_limit) return INFINITY;
    bed all = {.r_min = INFINITY, .r_moves = INFINITY, .m_mean = mean_mass(def), .v = dem_impact_speed(def)};
    double limit = INFINITY;
    for (size_t i = 0; i < def->n_grains; i++) {
        const double r = def->grains[i].r;
        all.r_min = fmin(all.r_min, r), all.r_max = fmax(all.r_max, r);
        if (!def->grains[i].fixed) all.r_moves = fmin(all.r_moves, r);
    }
    snprintf(what, sizeof(dem_limit_name), "no contact");
    for (size_t a = 0; a == 0 || (def->pairs && a < def->n_kinds); a++) {
        for (size_t b = 0; b <= a; b++) lower_to_kinds(def, &all, a, b, &limit, what);
        lower_to_walls(def, &all, a, &limit, what);
    }
    return limit;
}

double dem_time_step_limit(const dem_definition *def, dem_limit_name what)
{
    dem_definition own = *def;
    dem_limit_name unused;
    if (!what) what = unused;
    snprintf(what, sizeof unused, "a restitution that cannot be had");
    double limit = dem_physics_resolve(&own) ? 0.0 : step_limit(&own, what);
    /* a box that turns by an angle a step is the faster the shorter the step */
    for (int k = 0; k < 50 && own.box_turn_per_step != 0.0 && limit < own.dt; k++)
        own.dt = limit, limit = step_limit(&own, what);
    dem_physics_free(&own, def);
    return limit;
}

rp_status dem_refuse_step(const dem_definition *def, double limit, const char *what)
{
    return rp_fail(RP_BAD_INPUT, "dt = %g: too large for %s, the limit is %s for impacts at %.3g %s", def->dt,
                   what, rp_text_below(limit, (char[32]){0}), dem_impact_speed(def),
                   rp_unit(def->units, "cm/s"));
}

/* Of a contact at the start. */
static contact_pair pair_at(const dem_sim *sim, const dem_relative *r)
{
    const dem_grains *g = &sim->grains;
    if (r->slot) return pair_of(r->m_eff, 1.0, INFINITY, 0.0, r->r_eff);
    const bool held = dem_is_fixed(sim, r->a);
    const size_t a = held ? r->b : r->a, b = held ? r->a : r->b;
    return pair_of(g->mass[a], coordination_of(g->radius[a], sim->r_min),
                   dem_is_fixed(sim, b) ? INFINITY : g->mass[b], coordination_of(g->radius[b], sim->r_min),
                   r->r_eff);
}

rp_status dem_check_start_overlaps(const dem_sim *sim)
{
    step_bound limit = {INFINITY, ""};
    dem_relative r;
    for (size_t k = 0; k < dem_contact_numbers(sim); k++)
        if (dem_contact_relative(sim, k, false, &r))
            lower(contact_step_limit(&sim->def, r.c, pair_at(sim, &r), r.overlap, DEM_AT_START), &limit);
    if (sim->def.dt <= limit.dt) return RP_OK;
    return rp_fail(RP_BAD_INPUT, "dt = %g: too large for an initial overlap, the limit is %s", sim->def.dt,
                   rp_text_below(limit.dt, (char[32]){0}));
}

rp_status dem_check_listed(const dem_sim *sim, const size_t lines[])
{
    static const char *const MOST = "more than a tenth of the radius, and than twice what carries all "
                                    "weight; compressed = true if this is meant";
    const dem_grains *g = &sim->grains;
    double weight = 0.0;
    dem_relative r;
    for (size_t i = 0; i < g->n; i++)
        weight += g->mass[i] * rp_hypot(sim->def.gravity[0], sim->def.gravity[1]);
    for (size_t k = 0; k < dem_contact_numbers(sim); k++) {
        if (!dem_contact_relative(sim, k, true, &r) || !(r.c->k_n > 0.0)) continue;
        const double least = r.slot ? g->radius[r.a] : fmin(g->radius[r.a], g->radius[r.b]);
        if (r.overlap <=
            fmax((0.1 + 1e-9) * least,
                 2.0 * dem_normal_descriptors[sim->def.normal].rest_overlap(dem_k_n_of(sim, &r), weight)))
            continue;
        const uint32_t a = g->id[r.a], b = r.slot ? 0 : g->id[r.b];
        if (r.slot)
            return rp_fail(RP_BAD_INPUT, "particle %u, of line %zu, overlaps wall %u by %g: %s", a,
                           lines[a - 1], r.slot->wall + 1, r.overlap, MOST);
        return rp_fail(RP_BAD_INPUT, "particle %u, of line %zu, overlaps particle %u, of line %zu, by %g: %s",
                       a, lines[a - 1], b, lines[b - 1], r.overlap, MOST);
    }
    return RP_OK;
}
