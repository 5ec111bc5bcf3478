/* Simulations: definition, checks, life, stepping. */
#include <float.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dem/sim.h"

dem_definition dem_definition_default(void)
{
    return (dem_definition){
        .gravity = {0.0, -981.0},
        .dt = 5e-5,
        .normal = DEM_HERTZ,
        .tangential = DEM_SPRING,
        .slip = DEM_TRUNCATED,
        .tension = true,
        .material = {.k_n = 1e6, .gamma_n = 500.0, .k_s = 1e4, .gamma_s = 5.0, .mu = 0.2},
        .x_max = INFINITY,
        .y_min = -INFINITY,
    };
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

double dem_mass(int shape, double density, double r)
{
    return density * M_PI * r * r * (shape == DEM_SPHERE ? 4.0 / 3.0 * r : 1.0);
}

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
    if (!(c->k_n > 0.0)) return 0.0;
    return def->normal == DEM_HERTZ ? pow(5.0 * m_eff * v * v / (4.0 * c->k_n), 0.4)
                                    : v * sqrt(m_eff / c->k_n);
}

/* Largest time step of a contact of mass m_eff at this overlap. In a packing the stiffness and damping of a
 * grain's contacts add up to some three times a pair's, and Verlet with velocities of the half step needs
 * 4 - 6 gamma dt - 3 omega^2 dt^2 > 0. Of that root, 0.85 are allowed: without damping about 1/omega. */
static double contact_step_limit(const dem_definition *def, const dem_material *c, double m_eff,
                                 double overlap)
{
    double k_normal = def->normal == DEM_HERTZ ? 1.5 * c->k_n * sqrt(overlap) : c->k_n;
    double k = fmax(k_normal, def->tangential == DEM_SPRING ? c->k_s : 0.0);
    double gamma = fmax(c->gamma_n, def->tangential == DEM_SPRING ? c->gamma_s : 0.0);
    double rate = 3.0 * gamma + sqrt(9.0 * gamma * gamma + 12.0 * k / m_eff);
    return rate > 0.0 ? 0.85 * 4.0 / rate : INFINITY;
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

double dem_time_step_limit(const dem_definition *def, const char **what)
{
    double m_min = INFINITY, m_second = INFINITY, limit = INFINITY;
    for (size_t i = 0; i < def->n_grains; i++) {
        m_second = fmin(m_second, fmax(m_min, def->grains[i].m));
        m_min = fmin(m_min, def->grains[i].m);
    }
    const double v = impact_speed(def);
    const char *which = "no contact";
    if (def->n_grains > 1) {
        double m_eff = m_min * m_second / (m_min + m_second);
        limit = contact_step_limit(def, &def->material, m_eff, impact_overlap(def, &def->material, m_eff, v));
        which = "two of the lightest grains";
    }
    for (size_t w = 0; w < def->n_walls && def->n_grains > 0; w++) {
        const dem_material *c = &def->walls[w].material;
        double t = contact_step_limit(def, c, m_min, impact_overlap(def, c, m_min, v));
        if (t < limit) {
            limit = t;
            which = "the lightest grain at a wall";
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

static rp_status check_material(const dem_definition *def, const dem_material *c, const char *of)
{
    rp_status status = check_number("k_n", c->k_n, 0.0, "[0, inf)");
    if (!status) status = check_number("gamma_n", c->gamma_n, 0.0, "[0, inf)");
    if (!status && def->tangential == DEM_SPRING) status = check_number("k_s", c->k_s, DBL_MIN, "(0, inf)");
    if (!status && def->tangential == DEM_SPRING)
        status = check_number("gamma_s", c->gamma_s, 0.0, "[0, inf)");
    if (!status && !(c->mu >= 0.0))
        status = rp_fail(RP_BAD_INPUT, "mu = %g: out of range, allowed: [0, inf) | infinite", c->mu);
    if (!status && def->tangential == DEM_NONE && c->mu > 0.0)
        status = rp_fail(RP_BAD_INPUT, "mu = %g: needs a tangential law, but the scene declares none", c->mu);
    return status ? rp_prefix(status, "%s: ", of) : RP_OK;
}

static rp_status check_walls(const dem_definition *def)
{
    if (def->n_walls > DEM_MAX_WALLS)
        return rp_fail(RP_BAD_INPUT, "%zu walls: at most %d", def->n_walls, DEM_MAX_WALLS);
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

static rp_status check_grain(const dem_definition *def, const dem_grain *p)
{
    if (!(p->r > 0.0) || !isfinite(p->r))
        return rp_fail(RP_BAD_INPUT, "r = %g: out of range, allowed: (0, inf)", p->r);
    if (!(p->m > 0.0) || !isfinite(p->m))
        return rp_fail(RP_BAD_INPUT, "m = %g: out of range, allowed: (0, inf)", p->m);
    if (!isfinite(p->x + p->y + p->vx + p->vy))
        return rp_fail(RP_BAD_INPUT, "position and velocity must be finite");
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

static rp_status check_definition(const dem_definition *def)
{
    rp_status status = check_grain_values(def);
    if (!status) status = check_material(def, &def->material, "particles");
    if (!status) status = check_walls(def);
    if (status) return status;
    if (!(def->dt > 0.0) || !isfinite(def->dt))
        return rp_fail(RP_BAD_INPUT, "dt = %g: out of range, allowed: (0, inf)", def->dt);
    if (!isfinite(def->gravity[0] + def->gravity[1] + def->turn_per_step) ||
        !(fabs(def->turn_per_step) < 1.0))
        return rp_fail(RP_BAD_INPUT, "gravity and its turn must be finite, the turn below one radian a step");
    if (!(def->skin >= 0.0) || !isfinite(def->skin))
        return rp_fail(RP_BAD_INPUT, "skin = %g: out of range, allowed: [0, inf)", def->skin);
    const char *what;
    double limit = dem_time_step_limit(def, &what);
    if (def->dt > limit)
        return rp_fail(RP_BAD_INPUT, "dt = %g: too large for %s, the limit is %.3g", def->dt, what, limit);
    return RP_OK;
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

static void turn_gravity(dem_sim *sim)
{
    dem_vec g = sim->gravity;
    g = sim->turn_cos * g + sim->turn_sin * (dem_vec){-g[1], g[0]};
    double norm = sqrt(dem_dot(g, g));
    sim->gravity = norm > 0.0 ? g * (sim->gravity_norm / norm) : g;
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

/* An overlap beyond the smallest radius was seen: find one that is beyond the smaller of its own two. */
static rp_status check_overlaps(dem_sim *sim)
{
    sim->alarm = false;
    for (size_t t = 0; t < sim->n_touching; t++) {
        const size_t k = sim->touching[t], i = sim->pair_i[k], j = sim->pair_j[k];
        dem_vec d = sim->grain[i].x - sim->grain[j].x;
        double overlap = sim->pair_radii[k] - sqrt(dem_dot(d, d)),
               smaller = fmin(sim->radius[i], sim->radius[j]);
        if (!(overlap <= smaller))
            return dem_stop(sim, isfinite(overlap) ? DEM_FAULT_OVERLAP : DEM_FAULT_NON_FINITE, i,
                            "overlap %g with grain %u, beyond the smaller radius %g", overlap, sim->id[j],
                            smaller);
    }
    for (size_t k = 0; k < sim->n_wall_slots; k++) {
        dem_vec normal, velocity;
        double overlap;
        dem_wall_slot slot = sim->wall_slot[k];
        if (dem_wall_touch(sim, &slot, &normal, &overlap, &velocity) && !(overlap <= sim->radius[slot.grain]))
            return dem_stop(sim, isfinite(overlap) ? DEM_FAULT_LEAKED : DEM_FAULT_NON_FINITE, slot.grain,
                            "its centre passed wall %u (overlap %g)", slot.wall + 1, overlap);
    }
    return RP_OK;
}

static rp_status alloc_arrays(dem_sim *sim, size_t n)
{
    const size_t room = n + 1;
    sim->grain = aligned_alloc(64, (room * sizeof *sim->grain + 63) / 64 * 64);
    sim->force = aligned_alloc(64, (room * sizeof *sim->force + 63) / 64 * 64);
    sim->ref = aligned_alloc(64, (room * sizeof *sim->ref + 63) / 64 * 64);
    sim->radius = calloc(room, sizeof *sim->radius);
    sim->mass = calloc(room, sizeof *sim->mass);
    sim->inverse_mass = calloc(room, sizeof *sim->inverse_mass);
    sim->id = calloc(room, sizeof *sim->id);
    if (!sim->grain || !sim->force || !sim->ref || !sim->radius || !sim->mass || !sim->inverse_mass ||
        !sim->id)
        return rp_fail(RP_NO_MEMORY, "%zu particles: out of memory", n);
    return RP_OK;
}

/* Contacts that the start has already may be stiffer than any impact to come. */
static rp_status check_start_overlaps(const dem_sim *sim)
{
    double limit = INFINITY;
    for (size_t t = 0; t < sim->n_touching; t++) {
        const size_t k = sim->touching[t];
        dem_vec d = sim->grain[sim->pair_i[k]].x - sim->grain[sim->pair_j[k]].x;
        limit = fmin(limit, contact_step_limit(&sim->def, &sim->def.material, sim->pair_mass[k],
                                               sim->pair_radii[k] - sqrt(dem_dot(d, d))));
    }
    for (size_t k = 0; k < sim->n_wall_slots; k++) {
        dem_vec normal, velocity;
        double overlap;
        dem_wall_slot slot = sim->wall_slot[k];
        if (dem_wall_touch(sim, &slot, &normal, &overlap, &velocity) && overlap > 0.0)
            limit = fmin(limit, contact_step_limit(&sim->def, &sim->def.walls[slot.wall].material,
                                                   sim->mass[slot.grain], overlap));
    }
    return sim->def.dt <= limit
               ? RP_OK
               : rp_fail(RP_BAD_INPUT, "dt = %g: too large for an overlap of the start, the limit is %.3g",
                         sim->def.dt, limit);
}

/* Forces of the start, with velocities of the start and springs as they are; then velocities half a step
 * back, as the leapfrog keeps them. */
static rp_status start_forces(dem_sim *sim)
{
    rp_status status = dem_neighbours_rebuild(sim);
    if (status) return status;
    sim->kernel(sim, 0.0);
    dem_walls_apply(sim, 0.0);
    if (sim->alarm) status = check_overlaps(sim);
    if (!status) status = check_start_overlaps(sim);
    if (status) return status;
    for (size_t i = 0; i < sim->n; i++)
        sim->grain[i].v -= 0.5 * sim->def.dt * (sim->force[i] * sim->inverse_mass[i] + sim->gravity);
    return RP_OK;
}

static rp_status fill_in(dem_sim *sim, const dem_definition *def)
{
    sim->def = *def;
    sim->def.grains = NULL;
    sim->n = sim->room = def->n_grains;
    sim->last_id = (uint32_t)def->n_grains;
    sim->gravity = (dem_vec){def->gravity[0], def->gravity[1]};
    sim->gravity_norm = sqrt(dem_dot(sim->gravity, sim->gravity));
    sine_cosine(def->turn_per_step, &sim->turn_sin, &sim->turn_cos);
    /* 1e300 times no force is none, where infinity would give NaN */
    sim->mu = fmin(def->material.mu, 1e300);
    for (size_t w = 0; w < def->n_walls; w++) sim->wall_mu[w] = fmin(def->walls[w].material.mu, 1e300);
    dem_kernel_choose(sim);
    rp_status status = alloc_arrays(sim, sim->n);
    if (status) return status;
    sim->r_min = INFINITY;
    for (size_t i = 0; i < sim->n; i++) {
        const dem_grain *p = &def->grains[i];
        sim->grain[i] = (dem_record){{p->x, p->y}, {p->vx, p->vy}};
        sim->force[i] = (dem_vec){0.0, 0.0};
        sim->radius[i] = p->r;
        sim->mass[i] = p->m;
        sim->inverse_mass[i] = 1.0 / p->m;
        sim->id[i] = (uint32_t)i + 1;
        sim->r_min = fmin(sim->r_min, p->r);
        sim->r_max = fmax(sim->r_max, p->r);
        sim->radius_mean += p->r / (double)sim->n;
        sim->mass_mean += p->m / (double)sim->n;
    }
    sim->skin = def->skin > 0.0 ? def->skin : 0.4 * sim->radius_mean;
    sim->start_speed = impact_speed(def);
    sim->dt_limit = dem_time_step_limit(def, &sim->dt_limit_of);
    status = dem_neighbours_alloc(sim, NULL);
    return status ? status : start_forces(sim);
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
    c->grain = NULL, c->force = c->ref = NULL, c->radius = c->mass = c->inverse_mass = NULL, c->id = NULL;
    c->pair_i = c->pair_j = c->touching = NULL, c->pair_radii = c->pair_mass = c->spring = NULL;
    c->wall_slot = NULL, c->scratch = NULL;
    rp_status status = alloc_arrays(c, room);
    if (!status) status = dem_neighbours_alloc(c, sim);
    if (status) {
        dem_free(c);
        return status;
    }
    memcpy(c->grain, sim->grain, c->n * sizeof *c->grain);
    memcpy(c->force, sim->force, c->n * sizeof *c->force);
    memcpy(c->ref, sim->ref, c->n * sizeof *c->ref);
    memcpy(c->radius, sim->radius, c->n * sizeof *c->radius);
    memcpy(c->mass, sim->mass, c->n * sizeof *c->mass);
    memcpy(c->inverse_mass, sim->inverse_mass, c->n * sizeof *c->inverse_mass);
    memcpy(c->id, sim->id, c->n * sizeof *c->id);
    *copy = c;
    return RP_OK;
}

rp_status dem_clone(const dem_sim *sim, dem_sim **copy)
{
    return copy_with_room(sim, sim->room, copy);
}

static rp_status check_new_grain(const dem_sim *sim, const dem_grain *p)
{
    rp_status status = check_grain(&sim->def, p);
    if (status) return status;
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
        const dem_wall *w = &sim->def.walls[k];
        const bool line = isinf(w->extent[0]) && isinf(w->extent[1]);
        const double distance =
            (x[0] - w->point[0]) * w->direction[0] + (x[1] - w->point[1]) * w->direction[1];
        dem_wall_slot slot = {k, (uint32_t)place, 0.0, distance < 0.0 && !line ? -1.0 : 1.0};
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
    const size_t i = sim->n;
    sim->grain[i].x = (dem_vec){grain->x, grain->y};
    sim->grain[i].v = (dem_vec){grain->vx, grain->vy} - 0.5 * sim->def.dt * sim->gravity;
    sim->force[i] = (dem_vec){0.0, 0.0};
    sim->radius[i] = grain->r;
    sim->mass[i] = grain->m;
    sim->inverse_mass[i] = 1.0 / grain->m;
    status = check_new_walls(sim, i);
    if (status) return rp_prefix(status, "new particle: ");
    sim->id[i] = ++sim->last_id;
    sim->n++;
    sim->r_min = fmin(sim->r_min, grain->r);
    sim->r_max = fmax(sim->r_max, grain->r);
    if (id) *id = sim->last_id;
    return dem_neighbours_rebuild(sim);
}

void dem_free(dem_sim *sim)
{
    if (!sim) return;
    dem_neighbours_free(sim);
    free(sim->grain), free(sim->force), free(sim->ref), free(sim->radius), free(sim->mass);
    free(sim->inverse_mass), free(sim->id), free(sim->pair_i), free(sim->pair_j), free(sim->touching);
    free(sim->pair_radii), free(sim->pair_mass), free(sim->spring), free(sim->wall_slot), free(sim);
}

rp_status dem_run(dem_sim *sim, long steps)
{
    const double h = sim->def.dt;
    for (; steps > 0; steps--) {
        if (sim->def.turn_per_step != 0.0 && sim->step >= sim->def.turn_from_step) turn_gravity(sim);
        bool stale = dem_integrate(sim);
        sim->step++;
        rp_status status = stale ? dem_neighbours_rebuild(sim) : RP_OK;
        if (status) return status;
        sim->kernel(sim, h);
        dem_walls_apply(sim, h);
        if (sim->alarm && (status = check_overlaps(sim)) != RP_OK) return status;
    }
    return RP_OK;
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

void dem_gravity(const dem_sim *sim, double gravity[2])
{
    gravity[0] = sim->gravity[0];
    gravity[1] = sim->gravity[1];
}

const char *dem_kernel_name(const dem_sim *sim)
{
    return sim->kernel_name;
}
