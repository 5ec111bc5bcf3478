/* Simulations: definition, checks, life, stepping. */
#include <float.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#ifdef __SSE2__
#include <xmmintrin.h>
#endif

#include "core/clock.h"
#include "dem/integrator.h"

/* Pairs of a chunk: some 3000 grains. What a step reads and writes of them fits into the second cache. */
enum { CHUNK = 8192 };

dem_definition dem_definition_default(void)
{
    dem_definition def = {
        .gravity = {0.0, -981.0},
        .implicit = {.relaxation = 0.7, .tolerance = 1e-15, .max_iterations = 1000},
        .x_max = INFINITY,
        .y_min = -INFINITY,
    };
    dem_physics physics = dem_physics_default();
    physics.tangential = DEM_SPRING;
    physics.mu = 0.2;
    dem_physics_apply(&physics, &def);
    return def;
}

void dem_box_walls(dem_definition *def, double W, const dem_material *wall)
{
    def->n_walls = DEM_BOX_N;
    for (int w = 0; w < DEM_BOX_N; w++)
        def->walls[w] = (dem_wall){
            .material = *wall, .extent = {-INFINITY, INFINITY}, .open_at_step = -1, .open_speed = INFINITY};
    def->walls[DEM_BOX_FLOOR].direction[1] = 1.0;
    def->walls[DEM_BOX_LEFT].direction[0] = 1.0;
    def->walls[DEM_BOX_RIGHT].direction[0] = -1.0;
    def->walls[DEM_BOX_RIGHT].point[0] = W;
}

double dem_mass(dem_shape shape, double density, double r)
{
    switch (shape) {
    case DEM_SPHERE: return density * M_PI * r * r * (4.0 / 3.0 * r);
    case DEM_DISK: return density * M_PI * r * r;
    }
    __builtin_unreachable();
}

double dem_inertia(dem_shape shape, double m, double r)
{
    switch (shape) {
    case DEM_SPHERE: return 0.4 * m * r * r;
    case DEM_DISK: return 0.5 * m * r * r;
    }
    __builtin_unreachable();
}

const dem_scheme *const dem_schemes[DEM_INTEGRATORS] = {
#define X(name, word) [name] = &dem_scheme_##word,
    DEM_INTEGRATOR_LIST(X)
#undef X
};

const char *dem_fault_text(dem_fault fault)
{
    switch (fault) {
#define X(name, text)                                                                                        \
    case name: return text;
        DEM_FAULT_LIST(X)
#undef X
    }
    return "unknown";
}

/* Overlap that an impact at speed v reaches without damping. */
static double impact_overlap(const dem_definition *def, const dem_material *c, double m_eff, double v)
{
    return c->k_n > 0.0 ? dem_normal_descriptors[def->normal].impact_overlap(c->k_n, m_eff, v) : 0.0;
}

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

/* Of two grains, or of a grain and what does not move. */
typedef struct {
    double m_eff, crowd;
} meeting;

/* Neighbours that a grain has room for, over six: a large one among small ones has more. */
static double crowd_of(double r, double r_min)
{
    return fmax(1.0, M_PI / 6.0 / asin(r_min / (r + r_min)));
}

/* Each of the two takes part in as many contacts as it has room for; m_b may be INFINITY. */
static meeting meet(double m_a, double crowd_a, double m_b, double crowd_b)
{
    const double inverse = 1.0 / m_a + 1.0 / m_b;
    return (meeting){1.0 / inverse, (crowd_a / m_a + crowd_b / m_b) / inverse};
}

static void contact_rates(const dem_definition *def, const dem_material *c, meeting of, double overlap,
                          double *gamma, double *omega_squared)
{
    const dem_normal_descriptor *law = &dem_normal_descriptors[def->normal];
    const double k_n = law->stiffness(c->k_n, overlap),
                 gamma_n = law->damping_rate(c->k_n, c->gamma_n, of.m_eff, overlap);
    const double turns = def->rotation ? 1.0 / dem_inertia(def->shape, 1.0, 1.0) : 0.0;
    const bool shear = dem_has_friction(def->tangential), spring = dem_has_spring(def->tangential),
               rolls = shear && c->mu_roll > 0.0;
    *gamma = of.crowd * packing_sum(gamma_n, shear ? c->gamma_s : 0.0, rolls ? c->gamma_roll : 0.0, turns);
    *omega_squared =
        of.crowd / of.m_eff * packing_sum(k_n, spring ? c->k_s : 0.0, rolls ? c->k_roll : 0.0, turns);
}

/* Largest time step of a contact at this overlap. */
static double contact_step_limit(const dem_definition *def, const dem_material *c, meeting of, double overlap,
                                 dem_load load)
{
    const dem_scheme *scheme = dem_schemes[def->integrator];
    dem_rates rates;
    contact_rates(def, c, of, overlap, &rates.gamma, &rates.omega2);
    return scheme->step_limit ? scheme->step_limit(def, rates, load) : INFINITY;
}

/* Largest time step for impacts at speed v, and for a contact at rest under a column as high as v is fallen
 * from, of grains of radius r. */
static double speed_step_limit(const dem_definition *def, const dem_material *c, meeting of, double r,
                               double v)
{
    double limit = contact_step_limit(def, c, of, impact_overlap(def, c, of.m_eff, v), DEM_AT_IMPACT);
    if (!(c->k_n > 0.0)) return limit;
    double weight = of.m_eff * v * v / (4.0 * r);
    double overlap = dem_normal_descriptors[def->normal].rest_overlap(c->k_n, weight);
    return fmin(limit, contact_step_limit(def, c, of, overlap, DEM_AT_REST));
}

/* The same for a well of the ground under a column as high as v is fallen from. An impact's larger force
 * makes it stiffer, but breaks it or is over before that can grow. */
static double well_step_limit(const dem_definition *def, double m, double r, double v)
{
    const double stiffness = def->ground.mu_static *
                             fmax(m * v * v / (4.0 * r), m * hypot(def->gravity[0], def->gravity[1])) /
                             def->ground.a;
    return stiffness > 0.0 ? 0.85 * 4.0 / sqrt(12.0 * stiffness / m) : INFINITY;
}

/* Speed of an impact to come: the largest closing speed at the start and a fall from the highest grain to
 * the lowest grain or wall. */
static double impact_speed(const dem_definition *def)
{
    double speed = 0.0, low = INFINITY, high = -INFINITY;
    const double *g = def->gravity;
    for (size_t i = 0; i < def->n_grains; i++) {
        const dem_grain *p = &def->grains[i];
        double height = -(g[0] * p->x + g[1] * p->y); /* times g */
        speed = fmax(speed, hypot(p->vx, p->vy));
        low = fmin(low, height);
        high = fmax(high, height);
    }
    for (size_t w = 0; w < def->n_walls; w++) {
        const double *n = def->walls[w].direction, *q = def->walls[w].point;
        /* a wall along gravity has no height of its own */
        if (fabs(n[0] * g[0] + n[1] * g[1]) > 1e-6 * hypot(g[0], g[1]))
            low = fmin(low, -(g[0] * q[0] + g[1] * q[1]));
    }
    return 2.0 * speed + (high > low ? sqrt(2.0 * (high - low)) : 0.0);
}

/* The two grains of all that move that are quickest in a crowd; `second` is NULL where only one moves. */
static void lightest_two(const dem_definition *def, double r_min, const dem_grain **first,
                         const dem_grain **second)
{
    double least = INFINITY, next = INFINITY;
    *first = *second = NULL;
    for (size_t i = 0; i < def->n_grains; i++) {
        const dem_grain *p = &def->grains[i];
        const double m = p->m / crowd_of(p->r, r_min);
        if (p->fixed || m >= next) continue;
        const bool lightest = m < least;
        next = lightest ? least : m;
        *second = lightest ? *first : p;
        if (lightest) least = m, *first = p;
    }
}

double dem_time_step_limit(const dem_definition *def, const char **what)
{
    double r_moves = INFINITY, r_min = INFINITY, limit = INFINITY;
    const dem_grain *first, *second;
    if (!dem_schemes[def->integrator]->step_limit) {
        if (what) *what = "nothing: the integrator is implicit";
        return INFINITY;
    }
    for (size_t i = 0; i < def->n_grains; i++) {
        r_min = fmin(r_min, def->grains[i].r);
        if (!def->grains[i].fixed) r_moves = fmin(r_moves, def->grains[i].r);
    }
    lightest_two(def, r_min, &first, &second);
    const double v = impact_speed(def), crowd = first ? crowd_of(first->r, r_min) : 0.0;
    const char *which = "no contact";
    if (def->n_grains > 1 && first) {
        /* one that can move: the others are fixed */
        const meeting two = second ? meet(first->m, crowd, second->m, crowd_of(second->r, r_min))
                                   : meet(first->m, crowd, INFINITY, 0.0);
        limit = speed_step_limit(def, &def->material, two, r_moves, v);
        which = "two of the lightest grains";
    }
    for (size_t w = 0; w < def->n_walls && first; w++) {
        const dem_material *c = &def->walls[w].material;
        double t = speed_step_limit(def, c, meet(first->m, crowd, INFINITY, 0.0), r_moves, v);
        if (t < limit) {
            limit = t;
            which = "the lightest grain at a wall";
        }
        t = (int)w + 1 == def->ground.wall ? well_step_limit(def, first->m, r_moves, v) : INFINITY;
        if (t < limit) {
            limit = t;
            which = "the lightest grain in a well of the ground";
        }
    }
    if (what) *what = which;
    return limit;
}

static rp_status check_number(const char *name, double value, double lo, const char *allowed)
{
    return value >= lo && isfinite(value)
               ? RP_OK
               : rp_fail(RP_BAD_INPUT, "%s = %g: out of range, allowed: %s", name, value, allowed);
}

static bool has_rolling(const dem_definition *def)
{
    bool rolling = def->material.mu_roll > 0.0;
    for (size_t w = 0; w < def->n_walls; w++) rolling |= def->walls[w].material.mu_roll > 0.0;
    return rolling;
}

static rp_status check_material(const dem_definition *def, const dem_material *c, const char *of)
{
    rp_status status = check_number("k_n", c->k_n, 0.0, "[0, inf)");
    if (!status) status = check_number("gamma_n", c->gamma_n, 0.0, "[0, inf)");
    if (!status && dem_has_spring(def->tangential)) status = check_number("k_s", c->k_s, DBL_MIN, "(0, inf)");
    if (!status && dem_has_friction(def->tangential))
        status = check_number("gamma_s", c->gamma_s, 0.0, "[0, inf)");
    if (!status && !(c->mu >= 0.0))
        status = rp_fail(RP_BAD_INPUT, "mu = %g: out of range, allowed: [0, inf) | infinite", c->mu);
    if (!status && !(c->mu_roll >= 0.0 && isfinite(c->mu_roll)))
        status = rp_fail(RP_BAD_INPUT, "mu_roll = %g: out of range, allowed: [0, inf)", c->mu_roll);
    if (!status) status = dem_material_check(def, c);
    if (!status && has_rolling(def)) status = check_number("k_roll", c->k_roll, DBL_MIN, "(0, inf)");
    if (!status && has_rolling(def)) status = check_number("gamma_roll", c->gamma_roll, 0.0, "[0, inf)");
    return status ? rp_prefix(status, "%s: ", of) : RP_OK;
}

static rp_status check_walls(const dem_definition *def)
{
    for (size_t k = 0; k < def->n_walls; k++) {
        const dem_wall *w = &def->walls[k];
        char of[32];
        snprintf(of, sizeof of, "wall %zu", k + 1);
        rp_status status = check_material(def, &w->material, of);
        if (status) return status;
        if (!(fabs(hypot(w->direction[0], w->direction[1]) - 1.0) < 1e-9) ||
            !isfinite(w->point[0] + w->point[1]))
            return rp_fail(RP_BAD_INPUT, "%s: direction = [%g, %g]: a unit vector expected", of,
                           w->direction[0], w->direction[1]);
        if (!(w->extent[0] < w->extent[1]))
            return rp_fail(RP_BAD_INPUT, "%s: extent = [%g, %g]: the first must be the smaller", of,
                           w->extent[0], w->extent[1]);
        if (!(w->open_speed >= 0.0) ||
            (isfinite(w->open_speed) && w->open_at_step >= 0 && isinf(w->extent[0])))
            return rp_fail(
                RP_BAD_INPUT,
                "%s: open_speed = %g: must be at least 0, and a wall that opens slowly needs a lower end", of,
                w->open_speed);
    }
    return RP_OK;
}

static rp_status check_ground(const dem_definition *def)
{
    const dem_ground *g = &def->ground;
    if (g->wall == 0) return RP_OK;
    if (g->wall < 0 || (size_t)g->wall > def->n_walls)
        return rp_fail(RP_BAD_INPUT, "ground: wall = %d: there are %zu walls", g->wall, def->n_walls);
    const dem_wall *w = &def->walls[g->wall - 1];
    if (w->open_at_step >= 0 || isfinite(w->extent[0]) || isfinite(w->extent[1]))
        return rp_fail(RP_BAD_INPUT, "ground: wall = %d: must be a whole line that never opens", g->wall);
    if (dem_has_spring(def->tangential))
        return rp_fail(RP_BAD_INPUT, "ground: the tangential law spring has static friction of its own");
    rp_status status = check_number("mu_static", g->mu_static, 0.0, "[0, inf)");
    if (!status) status = check_number("a", g->a, DBL_MIN, "(0, inf)");
    return status ? rp_prefix(status, "ground: ") : RP_OK;
}

static rp_status check_hard(const dem_definition *def)
{
    const dem_hard *hard = &def->hard;
    if (!hard->on) return RP_OK;
    if (!(hard->restitution >= 0.0 && hard->restitution <= 1.0))
        return rp_fail(RP_BAD_INPUT, "hard: restitution = %g: out of range, allowed: [0, 1]",
                       hard->restitution);
    if (!(hard->mu >= 0.0))
        return rp_fail(RP_BAD_INPUT, "hard: mu = %g: out of range, allowed: [0, inf) | infinite", hard->mu);
    /* a pair that has just collided must not be held back */
    if (def->tension)
        return rp_fail(RP_BAD_INPUT, "hard: collisions need normal forces that do not pull, tension = false");
    return RP_OK;
}

static rp_status refuse_turn(void)
{
    return rp_fail(RP_BAD_INPUT, "the box turns, but some grains are fixed: they would not turn with it");
}

static rp_status check_grain(const dem_definition *def, const dem_grain *p)
{
    if (!(p->r > 0.0) || !isfinite(p->r))
        return rp_fail(RP_BAD_INPUT, "r = %g: out of range, allowed: (0, inf)", p->r);
    if (!(p->m > 0.0) || !isfinite(p->m))
        return rp_fail(RP_BAD_INPUT, "m = %g: out of range, allowed: (0, inf)", p->m);
    if (p->fixed && (p->vx != 0.0 || p->vy != 0.0 || p->omega != 0.0))
        return rp_fail(RP_BAD_INPUT, "vx = %g, vy = %g, omega = %g: must be 0, it is fixed", p->vx, p->vy,
                       p->omega);
    if (p->fixed && def->box_turn_per_step != 0.0) return refuse_turn();
    if (!isfinite(p->x + p->y + p->vx + p->vy))
        return rp_fail(RP_BAD_INPUT, "position and velocity must be finite");
    if (!isfinite(p->angle + p->omega) || (!def->rotation && (p->angle != 0.0 || p->omega != 0.0)))
        return rp_fail(RP_BAD_INPUT, "angle = %g, omega = %g: %s", p->angle, p->omega,
                       def->rotation ? "must be finite" : "needs rotation");
    if (p->x > def->x_max || p->y < def->y_min)
        return rp_fail(RP_BAD_INPUT, "x = %g, y = %g: starts beyond x_max = %g or y_min = %g", p->x, p->y,
                       def->x_max, def->y_min);
    return RP_OK;
}

static rp_status check_grain_values(const dem_definition *def)
{
    if (def->n_grains == 0) return rp_fail(RP_BAD_INPUT, "no particles");
    if (def->n_grains > 100000000)
        return rp_fail(RP_BAD_INPUT, "%zu particles: at most 100000000", def->n_grains);
    for (size_t i = 0; i < def->n_grains; i++) {
        rp_status status = check_grain(def, &def->grains[i]);
        if (status) return rp_prefix(status, "particle %zu: ", i + 1);
    }
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

static rp_status check_definition(const dem_definition *def)
{
    if (def->n_walls > DEM_MAX_WALLS)
        return rp_fail(RP_BAD_INPUT, "%zu walls: at most %d", def->n_walls, DEM_MAX_WALLS);
    rp_status status = check_grain_values(def);
    if (!status) status = check_material(def, &def->material, "particles");
    if (!status) status = check_walls(def);
    if (!status) status = check_ground(def);
    if (!status) status = check_hard(def);
    if (!status) status = dem_scheme_check(def);
    if (status) return status;
    if (!dem_kernel_runs(def->kernel))
        return rp_fail(RP_BAD_INPUT, "kernel: this processor has no %s instructions",
                       def->kernel == DEM_AVX512 ? "AVX-512" : "AVX2");
    if (!(def->dt > 0.0) || !isfinite(def->dt))
        return rp_fail(RP_BAD_INPUT, "dt = %g: out of range, allowed: (0, inf)", def->dt);
    if (!isfinite(def->gravity[0] + def->gravity[1] + def->turn_per_step) ||
        !(fabs(def->turn_per_step) < 1.0))
        return rp_fail(RP_BAD_INPUT, "gravity and its turn must be finite, the turn below one radian a step");
    if (!(fabs(def->box_turn_per_step) < 1.0))
        return rp_fail(RP_BAD_INPUT, "box_turn_per_step = %g: out of range, allowed: below one radian a step",
                       def->box_turn_per_step);
    if (!(def->skin >= 0.0) || !isfinite(def->skin))
        return rp_fail(RP_BAD_INPUT, "skin = %g: out of range, allowed: [0, inf)", def->skin);
    const char *what;
    double limit = dem_time_step_limit(def, &what);
    if (def->dt > limit)
        return rp_fail(RP_BAD_INPUT, "dt = %g: too large for %s, the limit is %.3g", def->dt, what, limit);
    return RP_OK;
}

static void set_gravity(dem_sim *sim, const double g[2])
{
    sim->gravity = (dem_vec){g[0], g[1]};
    sim->gravity_norm = sqrt(dem_dot(sim->gravity, sim->gravity));
}

/* sin and cos by + - * / alone, |angle| < 1: the same bits on every processor. */
static void sine_cosine(double angle, double *sine, double *cosine)
{
    double term = 1.0, sums[2] = {0.0, 0.0};
    for (int k = 0; k < 24; k++) {
        sums[k % 2] += k % 4 < 2 ? term : -term;
        term *= angle / (k + 1);
    }
    *cosine = sums[0];
    *sine = sums[1];
}

void dem_gravity_turn(dem_sim *sim, double radians_per_step)
{
    sim->def.turn_per_step = radians_per_step;
    sim->def.turn_from_step = sim->step;
    sine_cosine(radians_per_step, &sim->turn_sin, &sim->turn_cos);
}

void dem_box_turn(dem_sim *sim, double radians_per_step)
{
    double sine, cosine;
    sine_cosine(radians_per_step, &sine, &cosine);
    sim->def.box_turn_per_step = radians_per_step;
    sim->box_from_step = sim->step;
    sim->box_step = (dem_vec){cosine, sine};
}

void dem_gravity_set(dem_sim *sim, const double g[2])
{
    dem_vec before = sim->gravity;
    set_gravity(sim, g);
    if (sim->scheme->gravity) sim->scheme->gravity(sim, sim->gravity - before);
    if (sim->book) dem_ledger_gravity(sim);
}

static void turn_gravity(dem_sim *sim)
{
    dem_vec g = sim->gravity;
    g = sim->turn_cos * g + sim->turn_sin * (dem_vec){-g[1], g[0]};
    double norm = sqrt(dem_dot(g, g));
    sim->gravity = norm > 0.0 ? g * (sim->gravity_norm / norm) : g;
    if (sim->book) dem_ledger_gravity(sim);
}

rp_status dem_stop(dem_sim *sim, dem_fault fault, size_t grain, const char *format, ...)
{
    char text[256];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    sim->fault = fault;
    return rp_fail(RP_BROKEN, "%s at step %ld: grain %u: %s", dem_fault_text(fault), sim->step,
                   sim->id[grain], text);
}

rp_status dem_check_overlaps(dem_sim *sim, size_t k, size_t to, size_t grain)
{
    sim->alarm = false;
    for (; k < to; k++) {
        if (!dem_touches(sim, k)) continue;
        const size_t i = sim->pair_i[k], j = sim->pair_j[k];
        dem_vec d = sim->grain[i].x - sim->grain[j].x;
        double overlap = sim->pair_radii[k] - sqrt(dem_dot(d, d)),
               smaller = fmin(sim->radius[i], sim->radius[j]);
        if (!(overlap <= smaller))
            return dem_stop(sim, isfinite(overlap) ? DEM_FAULT_OVERLAP : DEM_FAULT_NON_FINITE, i,
                            "overlap %g with grain %u, beyond the smaller radius %g", overlap, sim->id[j],
                            smaller);
    }
    for (size_t s = 0; s < sim->n_wall_slots; s++) {
        dem_vec normal, velocity;
        double overlap;
        dem_wall_slot slot = sim->wall_slot[s];
        if (slot.grain >= grain && dem_wall_touch(sim, &slot, &normal, &overlap, &velocity) &&
            !(overlap <= sim->radius[slot.grain]))
            return dem_stop(sim, isfinite(overlap) ? DEM_FAULT_LEAKED : DEM_FAULT_NON_FINITE, slot.grain,
                            "its centre passed wall %u (overlap %g)", slot.wall + 1, overlap);
    }
    return RP_OK;
}

void *dem_array(size_t n, size_t size)
{
    enum { LINE = 64, PAGE = 1 << 21 };
    const size_t bytes = (n * size + LINE - 1) / LINE * LINE;
    char *array = aligned_alloc(LINE, bytes);
    if (!array) return NULL;
    const size_t skip = (PAGE - (uintptr_t)array % PAGE) % PAGE;
    if (bytes >= skip + PAGE) madvise(array + skip, (bytes - skip) / PAGE * PAGE, MADV_HUGEPAGE);
    return memset(array, 0, bytes);
}

static rp_status alloc_arrays(dem_sim *sim, size_t n)
{
    const size_t room = n + 8; /* some pass the last grain by up to 7 */
    sim->grain = dem_array(room, sizeof *sim->grain);
    sim->ref = dem_array(room, sizeof *sim->ref);
    sim->radius = dem_array(room, sizeof *sim->radius);
    sim->mass = dem_array(room, sizeof *sim->mass);
    sim->margin2 = dem_array(room, sizeof *sim->margin2);
    sim->reach = dem_array(room, sizeof *sim->reach);
    sim->slack = dem_array(room / DEM_GROUP + 1, sizeof *sim->slack);
    sim->inverse_mass = dem_array(room, sizeof *sim->inverse_mass);
    sim->id = dem_array(room, sizeof *sim->id);
    sim->fixed = dem_array(room, sizeof *sim->fixed);
    const bool gear = sim->scheme->excess;
    if (gear) sim->gear = dem_array(room, sizeof *sim->gear);
    if (sim->def.rotation) {
        sim->angle = dem_array(room, sizeof *sim->angle);
        sim->omega = dem_array(room, sizeof *sim->omega);
        sim->inverse_inertia = dem_array(room, sizeof *sim->inverse_inertia);
        sim->push = dem_array(room, sizeof *sim->push);
    } else {
        sim->force = dem_array(room, sizeof *sim->force);
    }
    if (sim->def.hard.on) sim->next = dem_array(room, sizeof *sim->next);
    const bool turns = sim->next && sim->def.rotation;
    if (turns) {
        sim->next_angle = dem_array(room, sizeof *sim->next_angle);
        sim->next_omega = dem_array(room, sizeof *sim->next_omega);
    }
    if ((gear && !sim->gear) || (sim->def.hard.on && !sim->next) ||
        (turns && (!sim->next_angle || !sim->next_omega)) ||
        (sim->def.rotation ? !sim->angle || !sim->omega || !sim->inverse_inertia || !sim->push
                           : !sim->force) ||
        !sim->grain || !sim->ref || !sim->radius || !sim->mass || !sim->inverse_mass || !sim->margin2 ||
        !sim->reach || !sim->slack || !sim->id || !sim->fixed)
        return rp_fail(RP_NO_MEMORY, "%zu particles: out of memory", n);
    return sim->scheme->alloc ? sim->scheme->alloc(sim) : RP_OK;
}

static meeting meeting_of(const dem_sim *sim, size_t i, size_t j)
{
    const bool held = sim->inverse_mass[i] == 0.0;
    const size_t a = held ? j : i, b = held ? i : j;
    return meet(sim->mass[a], crowd_of(sim->radius[a], sim->r_min),
                sim->inverse_mass[b] > 0.0 ? sim->mass[b] : INFINITY, crowd_of(sim->radius[b], sim->r_min));
}

/* Contacts that the start has already may be stiffer than any impact to come. */
static rp_status check_start_overlaps(const dem_sim *sim)
{
    double limit = INFINITY;
    DEM_EACH_TOUCHING (sim, k) {
        const size_t i = sim->pair_i[k], j = sim->pair_j[k];
        dem_vec d = sim->grain[i].x - sim->grain[j].x;
        limit = fmin(limit, contact_step_limit(&sim->def, &sim->def.material, meeting_of(sim, i, j),
                                               sim->pair_radii[k] - sqrt(dem_dot(d, d)), DEM_AT_START));
    }
    for (size_t k = 0; k < sim->n_wall_slots; k++) {
        dem_vec normal, velocity;
        double overlap;
        dem_wall_slot slot = sim->wall_slot[k];
        if (dem_wall_touch(sim, &slot, &normal, &overlap, &velocity) && overlap > 0.0)
            limit = fmin(limit, contact_step_limit(&sim->def, &sim->def.walls[slot.wall].material,
                                                   meet(sim->mass[slot.grain], 1.0, INFINITY, 0.0), overlap,
                                                   DEM_AT_START));
    }
    return sim->def.dt <= limit
               ? RP_OK
               : rp_fail(RP_BAD_INPUT, "dt = %g: too large for an overlap of the start, the limit is %.3g",
                         sim->def.dt, limit);
}

/* Springs of the contact between the grains at places i and j, if it is listed so; pairs, with hard
 * collisions those that touch, are in the order of i. */
static bool set_pair_springs(dem_sim *sim, size_t i, size_t j, double shear, double roll)
{
    size_t lo = 0, hi = sim->def.hard.on ? dem_count_touching(sim) : sim->n_pairs;
    while (lo < hi) {
        const size_t middle = (lo + hi) / 2;
        if (sim->pair_i[middle] < i)
            lo = middle + 1;
        else
            hi = middle;
    }
    for (; lo < sim->n_pairs && sim->pair_i[lo] == i; lo++) {
        if (sim->pair_j[lo] != j || !dem_touches(sim, lo)) continue;
        sim->spring[lo] = shear;
        if (sim->rolling) sim->roll[lo] = roll;
        return true;
    }
    return false;
}

static void set_wall_springs(dem_sim *sim, const dem_contact *contact)
{
    for (size_t k = 0; k < sim->n_wall_slots; k++) {
        dem_wall_slot *slot = &sim->wall_slot[k];
        if (sim->id[slot->grain] != contact->id_a || (int)slot->wall != contact->wall) continue;
        slot->roll = contact->rolling_spring;
        slot->well = contact->well;
        if (contact->well == DEM_WELL_NONE)
            slot->spring = contact->shear_spring;
        else
            slot->rest = dem_ground_displacement(sim, slot) - contact->shear_spring;
        return;
    }
}

static rp_status set_springs(dem_sim *sim, size_t n, const dem_contact *contacts)
{
    if (n == 0) return RP_OK;
    size_t *place = malloc((sim->n + 1) * sizeof *place); /* of each id */
    if (!place) return rp_fail(RP_NO_MEMORY, "springs of the start: out of memory");
    for (size_t i = 0; i < sim->n; i++) place[sim->id[i]] = i;
    for (size_t k = 0; k < n; k++) {
        const dem_contact *c = &contacts[k];
        const double shear = c->shear_spring, roll = c->rolling_spring;
        if (c->id_b == 0)
            set_wall_springs(sim, c);
        else if (!set_pair_springs(sim, place[c->id_a], place[c->id_b], shear, roll))
            set_pair_springs(sim, place[c->id_b], place[c->id_a], shear, -roll);
    }
    free(place);
    return RP_OK;
}

/* Forces of the start, with velocities and springs of the start; then what the integrator makes of them. */
static rp_status start_forces(dem_sim *sim, const dem_definition *def)
{
    rp_status status = dem_neighbours_rebuild(sim);
    if (!status) status = set_springs(sim, def->n_contacts, def->contacts);
    if (status) return status;
    sim->kernel(sim, 0, sim->n_pairs, 0.0);
    dem_walls_apply(sim, 0, sim->n, 0.0);
    if (sim->alarm) status = dem_check_overlaps(sim, 0, sim->n_pairs, 0);
    if (!status) status = check_start_overlaps(sim);
    if (!status && sim->book) status = dem_ledger_forces(sim, 0.0);
    if (status) return status;
    if (sim->scheme->start) sim->scheme->start(sim, 0);
    if (sim->book) dem_ledger_start(sim);
    return RP_OK;
}

static void place_walls(dem_sim *sim)
{
    const dem_definition *def = &sim->def;
    sim->box = (dem_vec){1.0, 0.0};
    dem_box_turn(sim, def->box_turn_per_step);
    sim->box_from_step = def->turn_from_step;
    for (size_t w = 0; w < def->n_walls; w++) {
        sim->wall[w].point = (dem_vec){def->walls[w].point[0], def->walls[w].point[1]};
        sim->wall[w].direction = (dem_vec){def->walls[w].direction[0], def->walls[w].direction[1]};
    }
}

/* What the definition of a grain says, all but its name. */
static void put_grain(dem_sim *sim, size_t i, const dem_grain *p)
{
    sim->grain[i] = (dem_record){{p->x, p->y}, {p->vx, p->vy}};
    if (sim->gear) sim->gear[i] = (dem_gear){0};
    sim->radius[i] = p->r;
    sim->mass[i] = p->m;
    sim->inverse_mass[i] = p->fixed ? 0.0 : 1.0 / p->m;
    *dem_force(sim, i) = (dem_vec){0.0, 0.0};
    if (!sim->omega) return;
    sim->push[i].torque = 0.0;
    sim->angle[i] = p->angle;
    sim->omega[i] = p->omega;
    sim->inverse_inertia[i] = p->fixed ? 0.0 : 1.0 / dem_inertia(sim->def.shape, p->m, p->r);
}

static void note_radius(dem_sim *sim, double r)
{
    sim->r_min = fmin(sim->r_min, r);
    sim->r_max = fmax(sim->r_max, r);
}

static rp_status fill_in(dem_sim *sim, const dem_definition *def)
{
    sim->def = *def;
    sim->scheme = dem_schemes[def->integrator];
    sim->def.grains = NULL;
    sim->def.contacts = NULL;
    sim->def.n_contacts = 0;
    sim->n = sim->room = def->n_grains;
    sim->last_id = (uint32_t)def->n_grains;
    set_gravity(sim, def->gravity);
    sine_cosine(def->turn_per_step, &sim->turn_sin, &sim->turn_cos);
    place_walls(sim);
    /* 1e300 times no force is none, where infinity would give NaN */
    sim->mu = fmin(def->material.mu, 1e300);
    for (size_t w = 0; w < def->n_walls; w++) sim->wall_mu[w] = fmin(def->walls[w].material.mu, 1e300);
    sim->rolling = has_rolling(def);
    sim->chunk = CHUNK;
    dem_kernel_choose(sim);
    rp_status status = alloc_arrays(sim, sim->n);
    if (status) return status;
    sim->r_min = INFINITY;
    for (size_t i = 0; i < sim->n; i++) {
        const dem_grain *p = &def->grains[i];
        put_grain(sim, i, p);
        note_radius(sim, p->r);
        sim->id[i] = (uint32_t)i + 1;
        sim->radius_mean += p->r / (double)sim->n;
        sim->mass_mean += p->m / (double)sim->n;
    }
    sim->skin = def->skin > 0.0 ? def->skin : 0.4 * sim->radius_mean;
    sim->even_margins = def->skin > 0.0 || sim->scheme->even_margins;
    sim->start_speed = impact_speed(def);
    sim->dt_limit = dem_time_step_limit(def, &sim->dt_limit_of);
    status = dem_neighbours_alloc(sim, NULL);
    if (!status && def->ledger) status = dem_ledger_alloc(sim);
    return status ? status : start_forces(sim, def);
}

rp_status dem_create(const dem_definition *def, dem_sim **sim)
{
    *sim = NULL;
    rp_status status = check_definition(def);
    if (status) return status;
    dem_sim *s = calloc(1, sizeof *s);
    if (!s) return rp_fail(RP_NO_MEMORY, "simulation: out of memory");
    status = fill_in(s, def);
    if (status) {
        dem_free(s);
        return status == RP_BROKEN ? RP_BAD_INPUT : status; /* a fault at the start is the definition's */
    }
    *sim = s;
    return RP_OK;
}

/* A copy whose arrays hold `room` grains. */
static rp_status copy_with_room(const dem_sim *sim, size_t room, dem_sim **copy)
{
    *copy = NULL;
    dem_sim *c = malloc(sizeof *c);
    if (!c) return rp_fail(RP_NO_MEMORY, "simulation: out of memory");
    *c = *sim;
    c->room = room;
    c->margin2 = c->reach = c->slack = NULL, c->grain = NULL, c->force = c->ref = NULL,
    c->radius = c->mass = c->inverse_mass = NULL, c->id = NULL;
    c->gear = NULL, c->work = NULL, c->fixed = NULL, c->push = NULL;
    c->angle = c->omega = c->inverse_inertia = NULL;
    c->next = NULL, c->next_angle = c->next_omega = NULL;
    c->pair_i = c->pair_j = NULL, c->touching = NULL,
    c->pair_radii = c->pair_mass = c->spring = c->roll = NULL;
    c->radius_i = c->radius_j = c->roll_radius = NULL, c->done = NULL, c->chunk_room = 0;
    c->wall_slot = NULL, c->scratch = NULL, c->book = NULL;
    rp_status status = alloc_arrays(c, room);
    if (!status) status = dem_neighbours_alloc(c, sim);
    if (!status && sim->book) status = dem_ledger_clone(c, sim);
    if (status) {
        dem_free(c);
        return status;
    }
    memcpy(c->grain, sim->grain, c->n * sizeof *c->grain);
    if (c->force) memcpy(c->force, sim->force, c->n * sizeof *c->force);
    memcpy(c->ref, sim->ref, c->n * sizeof *c->ref);
    memcpy(c->radius, sim->radius, c->n * sizeof *c->radius);
    memcpy(c->mass, sim->mass, c->n * sizeof *c->mass);
    memcpy(c->margin2, sim->margin2, c->n * sizeof *c->margin2);
    memcpy(c->reach, sim->reach, c->n * sizeof *c->reach);
    memcpy(c->inverse_mass, sim->inverse_mass, c->n * sizeof *c->inverse_mass);
    memcpy(c->id, sim->id, c->n * sizeof *c->id);
    if (c->omega) {
        memcpy(c->angle, sim->angle, c->n * sizeof *c->angle);
        memcpy(c->omega, sim->omega, c->n * sizeof *c->omega);
        memcpy(c->inverse_inertia, sim->inverse_inertia, c->n * sizeof *c->inverse_inertia);
    }
    if (c->push) memcpy(c->push, sim->push, c->n * sizeof *c->push);
    memcpy(c->fixed, sim->fixed, c->n_fixed * sizeof *c->fixed);
    if (c->gear) memcpy(c->gear, sim->gear, c->n * sizeof *c->gear);
    *copy = c;
    return RP_OK;
}

rp_status dem_clone(const dem_sim *sim, dem_sim **copy)
{
    return copy_with_room(sim, sim->room, copy);
}

static rp_status check_new_grain(const dem_sim *sim, const dem_grain *p)
{
    dem_grain boxed = *p;
    dem_box_frame(sim, &boxed.x, &boxed.y);
    rp_status status = check_grain(&sim->def, &boxed);
    if (status) return status;
    if (p->fixed) return rp_fail(RP_BAD_INPUT, "a fixed grain must be there from the start");
    dem_definition def = sim->def;
    def.grains = (dem_grain[]){*p, *p};
    def.n_grains = 2;
    const char *what;
    double limit = dem_time_step_limit(&def, &what);
    if (def.dt > limit)
        return rp_fail(RP_BAD_INPUT, "dt = %g: too large for %s, the limit is %.3g", def.dt, what, limit);
    for (size_t i = 0; i < sim->n; i++) {
        dem_vec d = sim->grain[i].x - (dem_vec){p->x, p->y};
        double radii = sim->radius[i] + p->r;
        if (dem_dot(d, d) < radii * radii)
            return rp_fail(RP_BAD_INPUT, "x = %g, y = %g: touches grain %u", p->x, p->y, sim->id[i]);
    }
    return RP_OK;
}

/* Does the grain at `place` touch a wall, or lie behind a whole line? */
static rp_status check_new_walls(const dem_sim *sim, size_t place)
{
    const dem_vec x = sim->grain[place].x;
    for (uint32_t k = 0; k < sim->def.n_walls; k++) {
        const double *extent = sim->def.walls[k].extent;
        const bool line = isinf(extent[0]) && isinf(extent[1]),
                   behind = dem_dot(x - sim->wall[k].point, sim->wall[k].direction) < 0.0;
        dem_wall_slot slot = {.wall = k, .grain = (uint32_t)place, .side = behind && !line ? -1.0 : 1.0};
        dem_vec normal, velocity;
        double overlap;
        if (dem_wall_touch(sim, &slot, &normal, &overlap, &velocity) && overlap > 0.0)
            return rp_fail(RP_BAD_INPUT, "x = %g, y = %g: touches wall %u", x[0], x[1], k + 1);
    }
    return RP_OK;
}

rp_status dem_add(dem_sim *sim, const dem_grain *grain, uint32_t *id)
{
    rp_status status = check_new_grain(sim, grain);
    if (status) return rp_prefix(status, "new particle: ");
    if (sim->n == sim->room) {
        dem_sim *larger, old = *sim;
        status = copy_with_room(sim, 2 * sim->room, &larger);
        if (status) return status;
        *sim = *larger;
        *larger = old;
        dem_free(larger);
    }
    put_grain(sim, sim->n, grain);
    status = check_new_walls(sim, sim->n);
    if (status) return rp_prefix(status, "new particle: ");
    if (sim->book && (status = dem_ledger_add(sim, grain)) != RP_OK) return status;
    note_radius(sim, grain->r);
    sim->id[sim->n++] = ++sim->last_id;
    if (sim->scheme->start) sim->scheme->start(sim, sim->n - 1);
    if (id) *id = sim->last_id;
    return dem_neighbours_rebuild(sim);
}

void dem_free(dem_sim *sim)
{
    if (!sim) return;
    dem_neighbours_free(sim);
    if (sim->work) sim->scheme->free(sim);
    dem_ledger_free(sim);
    free(sim->margin2), free(sim->reach), free(sim->slack), free(sim->gear), free(sim->fixed);
    free(sim->next), free(sim->next_angle), free(sim->next_omega);
    free(sim->grain), free(sim->force), free(sim->ref), free(sim->radius), free(sim->mass);
    free(sim->inverse_mass), free(sim->id), free(sim->pair_i), free(sim->pair_j), free(sim->touching);
    free(sim->pair_radii), free(sim->pair_mass), free(sim->spring), free(sim->wall_slot);
    free(sim->radius_i), free(sim->radius_j), free(sim->roll_radius), free(sim->done);
    free(sim->angle), free(sim->omega), free(sim->inverse_inertia), free(sim->push), free(sim->roll),
        free(sim);
}

/* Give the time since the last reading to a phase. */
static inline void lap(dem_sim *sim, double *phase)
{
    const double now = rp_clock();
    *phase += now - sim->clock;
    sim->clock = now;
}

rp_status dem_step_lists(dem_sim *sim, unsigned left)
{
    rp_status status = RP_OK;
    sim->step++;
    if (sim->times) lap(sim, &sim->times->integration);
    if (left & DEM_LIST_OUT || sim->box_swept > sim->box_room)
        status = dem_neighbours_rebuild(sim);
    else if (left)
        dem_neighbours_drop(sim);
    if (sim->times) lap(sim, &sim->times->lists);
    return status;
}

rp_status dem_step_forces(dem_sim *sim)
{
    const double h = sim->def.dt;
    rp_status status;
    sim->kernel(sim, 0, sim->n_pairs, h);
    if (sim->times) lap(sim, &sim->times->contacts);
    dem_walls_apply(sim, 0, sim->n, h);
    if (sim->alarm && (status = dem_check_overlaps(sim, 0, sim->n_pairs, 0)) != RP_OK) return status;
    if (sim->times) lap(sim, &sim->times->walls);
    return sim->book ? dem_ledger_forces(sim, h) : RP_OK;
}

static rp_status advance(dem_sim *sim, long steps)
{
    /* the box may turn since the start */
    if (sim->n_fixed > 0 && sim->def.box_turn_per_step != 0.0) return refuse_turn();
    rp_status status = dem_scheme_check(&sim->def);
    for (; steps > 0 && !status; steps--) {
        if (sim->def.turn_per_step != 0.0 && sim->step >= sim->def.turn_from_step) turn_gravity(sim);
        status = sim->scheme->step(sim, steps == 1);
        if (!status && sim->book) dem_ledger_step(sim);
    }
    return status;
}

/* From now on numbers below the smallest normal one, 2.2e-308, count as 0; gives the mode before. Speeds and
 * springs of a disk that lies alone shrink for ever, and each operation on such a number takes the processor
 * some 150 cycles. */
static unsigned count_as_zero(void)
{
#ifdef __SSE2__
    enum { RESULTS = 0x8000, OPERANDS = 0x40 };
    const unsigned mode = _mm_getcsr();
    _mm_setcsr(mode | RESULTS | OPERANDS);
    return mode;
#else
    return 0;
#endif
}

static void restore_mode(unsigned mode)
{
#ifdef __SSE2__
    _mm_setcsr(mode);
#else
    (void)mode;
#endif
}

rp_status dem_run(dem_sim *sim, long steps)
{
    const unsigned mode = count_as_zero();
    rp_status status = advance(sim, steps);
    restore_mode(mode);
    return status;
}

rp_status dem_run_timed(dem_sim *sim, long steps, dem_phases *times)
{
    sim->times = times;
    sim->clock = rp_clock();
    rp_status status = dem_run(sim, steps);
    sim->times = NULL;
    return status;
}

void dem_wall_open(dem_sim *sim, size_t wall, double speed)
{
    sim->def.walls[wall].open_at_step = sim->step + 1;
    sim->def.walls[wall].open_speed = speed;
}

dem_fault dem_sim_fault(const dem_sim *sim)
{
    return sim->fault;
}

long dem_step(const dem_sim *sim)
{
    return sim->step;
}

double dem_time(const dem_sim *sim)
{
    return (double)sim->step * sim->def.dt;
}

size_t dem_count(const dem_sim *sim)
{
    return sim->n;
}

double dem_box_angle(const dem_sim *sim)
{
    return sim->box_angle;
}

void dem_box_frame(const dem_sim *sim, double *x, double *y)
{
    dem_vec place = dem_to_box(sim, (dem_vec){*x, *y});
    *x = place[0];
    *y = place[1];
}

void dem_gravity(const dem_sim *sim, double gravity[2])
{
    gravity[0] = sim->gravity[0];
    gravity[1] = sim->gravity[1];
}

const char *dem_kernel_name(const dem_sim *sim)
{
    return sim->kernel_name;
}
