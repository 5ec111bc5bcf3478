/* What a phase does at its start: going back, other laws, grains taken out and put in, loads of walls. */
#include <math.h>
#include <string.h>

#include "core/elementary.h"
#include "dem/scene/radii.h"
#include "experiment/looks.h"

/* ---- going back ---- */

void exp_save(exp_run *run, size_t phase)
{
    exp_saved *saved = &run->saved[phase];
    const size_t n = 2 * run->plan->n_walls;
    dem_free(saved->sim);
    saved->sim = NULL;
    if ((run->failed = dem_clone(run->sim, &saved->sim))) return;
    saved->now = run->at.now;
    memcpy(saved->loads, run->loads, n * sizeof *saved->loads);
}

void exp_go_back(exp_run *run, const exp_phase *p)
{
    const exp_saved *saved = &run->saved[p->source];
    const size_t n = 2 * run->plan->n_walls;
    dem_sim *copy;
    if (!saved->sim) { /* its block was left before it */
        exp_conclude(run, "no_start", "phase %s: %s was not reached", p->name,
                     run->plan->phases[p->source].name);
        return;
    }
    run->failed = dem_clone(saved->sim, &copy);
    if (run->failed) return;
    dem_free(run->sim);
    run->sim = copy;
    run->at.now = saved->now;
    memcpy(run->loads, saved->loads, n * sizeof *saved->loads);
}

/* ---- laws, and grains that go ---- */

/* The simulation has changed; what can't be ends the run with this word. */
static void renew(exp_run *run, const exp_phase *p, rp_status status, const char *word)
{
    run->fresh = false;
    if (status && status != RP_NO_MEMORY)
        exp_conclude(run, word, "phase %s: %s", p->name, rp_message());
    else
        run->failed = status;
}

/* Is a grain beyond the x where this phase takes grains out? */
static bool has_outside(exp_run *run, const dem_definition *def)
{
    const dem_state *s = exp_states(run);
    bool outside = false;
    for (size_t i = 0; s && i < run->n_states; i++) outside |= s[i].x < def->x_min || s[i].x > def->x_max;
    return outside;
}

void exp_change_laws(exp_run *run, const exp_phase *p)
{
    dem_definition def = p->def;
    def.ledger = run->plan->scene.def.ledger;
    run->at.now.laws = (size_t)(p - run->plan->phases);
    run->at.most_seen[0] = run->at.most_seen[1] = 0.0;
    const char *const word = has_outside(run, &def) ? "outside" : "too_fast";
    renew(run, p, dem_change(&run->sim, &def), word);
}

void exp_remove(exp_run *run, const exp_phase *p)
{
    const exp_within in = exp_within_now(run, &p->removes);
    renew(run, p, dem_remove(&run->sim, exp_is_within, &in), "too_fast");
}

/* ---- grains that come ---- */

/* The lowest place of a centre above which a body of this radius, that comes from above at x, meets nothing:
 * -INFINITY where there is nothing, INFINITY where a wall is beside it all the way up. */
static double touch_of_wall(const dem_wall_state *w, double x, double r, double gap)
{
    const double reach = r + gap, nx = w->direction[0], ny = w->direction[1], tx = ny, ty = -nx;
    double y = -INFINITY;
    if (w->ends[0] >= w->ends[1]) return y;
    for (int side = -1; side <= 1; side += 2) { /* of both sides the one that looks up */
        const double up = side * ny;
        if (isinf(w->ends[0]) && isinf(w->ends[1]) && side < 0) continue;
        if (up <= 0.0 || fabs(ny) < 1e-12) continue;
        const double at = (reach - side * (x - w->point[0]) * nx) / up + w->point[1],
                     along = (x - w->point[0]) * tx + (at - w->point[1]) * ty;
        if (along >= w->ends[0] && along <= w->ends[1]) y = fmax(y, at);
    }
    for (int end = 0; end < 2; end++) {
        const double dx = w->point[0] + w->ends[end] * tx - x;
        if (isfinite(w->ends[end]) && fabs(dx) < reach)
            y = fmax(y, w->point[1] + w->ends[end] * ty + sqrt(reach * reach - dx * dx));
    }
    /* an upright one without an upper end */
    const bool up = fabs(ny) < 1e-12 && isinf(w->ends[ty > 0.0 ? 1 : 0]);
    return up && fabs(x - w->point[0]) < r * (1.0 - 1e-9) ? INFINITY : y;
}

double exp_touch_height(size_t n, const dem_state grains[], double x, double r, double gap, double y)
{
    for (size_t i = 0; i < n; i++) {
        const double dx = grains[i].x - x, reach = r + grains[i].r + gap;
        if (fabs(dx) < reach) y = fmax(y, grains[i].y + sqrt(reach * reach - dx * dx));
    }
    return y;
}

static double touch_height(exp_run *run, double x, double r, double gap)
{
    const dem_state *s = exp_states(run);
    double y = -INFINITY;
    for (size_t w = 0; w < dem_wall_count(run->sim); w++) {
        const dem_wall_state wall = dem_wall_now(run->sim, w);
        y = fmax(y, touch_of_wall(&wall, x, r, gap));
    }
    return s ? exp_touch_height(run->n_states, s, x, r, gap, y) : y;
}

static double between(exp_run *run, const double ends[2])
{
    return ends[0] == ends[1] ? ends[0] : ends[0] + (ends[1] - ends[0]) * rp_random_uniform(run->random[1]);
}

double exp_density(const exp_plan *plan, const exp_add *a, double given)
{
    const dem_fill *first = plan->scene.fills;
    const dem_scene_laws *laws = &plan->scene.laws;
    const double own = a->kind < laws->n_kinds ? laws->kinds[a->kind].density : -1.0;
    return exp_given(&a->density) ? given : own > 0.0 ? own : first ? first->density : laws->physics.density;
}

/* Draw a grain, and put it in; of a range at the first free place of many. RP_NO_RESULT: there is none. */
static rp_status put_grain(exp_run *run, const exp_phase *p, dem_grain *g, uint32_t *id)
{
    const exp_add *a = &p->add;
    enum { TRIES = 10000 };
    const exp_plan *plan = run->plan;
    *g = (dem_grain){.r = exp_given(&a->r) ? exp_value(run, &a->r)
                                           : dem_radius_draw(&a->radii, run->random[0]),
                     .kind = a->kind};
    run->grain.r = g->r, run->grain.y = run->grain.touch = NAN;
    const double density = exp_density(plan, a, exp_value(run, &a->density)), gap = exp_value(run, &a->gap);
    g->m = dem_mass(plan->scene.def.shape, density, g->r);
    const double x[2] = {exp_value(run, &a->x[0]), exp_value(run, &a->x[1])};
    if (!(g->r > 0.0) || !(g->m > 0.0) || !(gap >= 0.0) || !isfinite(x[0]) || !isfinite(x[1])) {
        exp_conclude(run, "no_number", "%s: r = %g, density = %g, gap = %g, x = %g to %g", p->name, g->r,
                     density, gap, x[0], x[1]);
        return RP_NO_RESULT;
    }
    for (int k = 0; k < TRIES; k++) {
        g->x = between(run, x);
        run->grain.touch = a->in_range ? NAN : touch_height(run, g->x, g->r, gap);
        const double y[2] = {exp_number(run, "add.y", &a->y[0]),
                             a->in_range ? exp_number(run, "add.y", &a->y[1]) : NAN};
        run->grain.y = g->y = a->in_range ? between(run, y) : y[0];
        g->vx = exp_number(run, "add.vx", &a->vx), g->vy = exp_number(run, "add.vy", &a->vy);
        g->omega = exp_number(run, "add.omega", &a->omega);
        if (run->at.done || !isfinite(g->x) || !isfinite(g->y)) return RP_NO_RESULT;
        const rp_status status = dem_add(run->sim, g, id);
        if (!a->in_range || status != RP_NO_ROOM) return status;
    }
    return RP_NO_RESULT;
}

static void add_grain(exp_run *run, const exp_phase *p)
{
    dem_grain g;
    uint32_t id;
    const rp_status status = put_grain(run, p, &g, &id);
    if (status == RP_NO_RESULT) {
        if (!run->failed && !run->at.done)
            exp_conclude(run, "no_room", "phase %s: no place for a grain of radius %g, at x = %g, y = %g",
                         p->name, g.r, g.x, g.y);
        return;
    }
    if (status == RP_BROKEN) run->failed = status;
    if (run->failed) return;
    renew(run, p, status, status == RP_TOO_FAST ? "too_fast" : "no_room");
    if (run->failed || run->at.done || !exp_make_ids(run, id)) return;
    run->kinds[id - 1] = p->add.kind;
    run->marks[2 * (id - 1)] = run->marks[2 * (id - 1) + 1] = NAN;
    run->at.now.added++, run->at.now.added_mass += g.m;
    run->at.now.last = id, run->at.now.touched = false;
}

void exp_add_grains(exp_run *run, const exp_phase *p)
{
    const double n = exp_value(run, &p->add.n);
    if (!(n >= 0.0 && n <= 1e8)) {
        exp_conclude(run, "no_number", "phase %s: add: N \"%s\" is %g", p->name, p->add.n.x.text, n);
        return;
    }
    for (long k = lround(n); k > 0 && !run->failed && !run->at.done; k--) add_grain(run, p);
}

/* ---- speeds ---- */

void exp_check_speed(exp_run *run, const char *whose, const double v[2], bool gravity)
{
    const exp_plan *plan = run->plan;
    const double size = rp_hypot(v[0], v[1]);
    double *const most = &run->at.most_seen[gravity];
    if (!(size > 1.5 * *most)) return;
    *most = size;
    const dem_state *s = exp_states(run);
    dem_definition def = run->at.now.laws == SIZE_MAX ? plan->scene.def : plan->phases[run->at.now.laws].def;
    dem_limit_name what;
    RP_SCOPE(arena);
    dem_grain *grains = rp_arena_memory(&arena, run->n_states + 1, sizeof *grains);
    if (!s || !grains || run->n_states == 0) return;
    for (size_t i = 0; i < run->n_states; i++)
        grains[i] = (dem_grain){
            .x = s[i].x, .y = s[i].y, .r = s[i].r, .m = s[i].m, .fixed = s[i].fixed, .kind = s[i].kind};
    if (!gravity) grains->vx = size;
    def.grains = grains, def.n_grains = run->n_states, def.gravity[0] = def.gravity[1] = 0.0;
    if (gravity) memcpy(def.gravity, v, sizeof def.gravity);
    const double limit = dem_time_step_limit(&def, what);
    if (def.dt <= limit) return;
    (void)dem_refuse_step(&def, limit, what);
    exp_conclude(run, "too_fast", "phase %s, step %ld: %s: %s", plan->phases[run->at.phase].name,
                 run->at.phase_step, whose, rp_message());
}

/* ---- walls ---- */

/* All walls of a name move as one. */
static void give_velocity(exp_run *run, const exp_wall *wall, const double velocity[2], double omega)
{
    if (run->ahead && velocity) exp_check_speed(run, wall->name, velocity, false);
    for (size_t k = 0; k < wall->n && !run->at.done; k++)
        if (dem_wall_move(run->sim, wall->walls[k], velocity, omega))
            exp_conclude(run, "too_fast", "phase %s: %s: %s", run->plan->phases[run->at.phase].name,
                         wall->name, rp_message());
}

void exp_move_wall(exp_run *run, const exp_wall *wall, const double velocity[2], double omega)
{
    const size_t w = (size_t)(wall - run->plan->walls);
    const dem_wall_state now = dem_wall_now(run->sim, wall->walls[0]);
    double v[2];
    for (int c = 0; c < 2 && velocity; c++) v[c] = run->loads[2 * w + c] >= 0 ? now.velocity[c] : velocity[c];
    give_velocity(run, wall, velocity ? v : NULL, omega);
}

void exp_load_walls(exp_run *run, const exp_phase *p)
{
    for (size_t k = 0; k < p->n_moves && !run->at.done; k++) {
        const exp_move *m = &p->moves[k];
        const exp_wall *wall = &run->plan->walls[m->wall];
        const dem_wall_state now = dem_wall_now(run->sim, wall->walls[0]);
        double v[2] = {now.velocity[0], now.velocity[1]};
        bool freed = false;
        for (int c = 0; c < 2; c++) {
            long *const load = &run->loads[2 * m->wall + (size_t)c];
            if (m->loading[c] == EXP_FREED && *load >= 0) *load = -1, v[c] = 0.0, freed = true;
            if (m->loading[c] == EXP_LOADED) *load = (long)m->number;
        }
        if (freed) exp_move_wall(run, wall, v, NAN);
    }
}

bool exp_is_loaded(const exp_run *run)
{
    for (size_t k = 0; k < 2 * run->plan->n_walls; k++)
        if (run->loads[k] >= 0) return true;
    return false;
}

/* M dv/dt = force of the grains + load, |v| <= speed; M is a tenth of the grains', at least 10 m. A step
 * takes the velocity of its middle, as that of a grain. */
void exp_push_walls(exp_run *run)
{
    const exp_plan *plan = run->plan;
    const double mass = fmax(0.1 * (run->at.mass0 + run->at.now.added_mass), 10.0 * plan->m),
                 dt = exp_laws(run)->dt;
    for (size_t w = 0; w < plan->n_walls && !run->at.done; w++) {
        const exp_wall *wall = &plan->walls[w];
        const dem_wall_state now = dem_wall_now(run->sim, wall->walls[0]);
        double v[2] = {now.velocity[0], now.velocity[1]};
        bool loaded = false;
        for (int c = 0; c < 2; c++) {
            const long load = run->loads[2 * w + (size_t)c];
            if (load < 0) continue;
            const exp_move *m = plan->loads[load];
            const double most = fabs(exp_value(run, &m->speed));
            double force = exp_value(run, &m->load[c]);
            loaded = true;
            if (!isfinite(force) || !isfinite(most))
                exp_conclude(run, "no_number", "%s: load \"%s\" is %g, speed %g", wall->name,
                             m->load[c].x.text, force, most);
            for (size_t k = 0; k < wall->n; k++) force += dem_wall_now(run->sim, wall->walls[k]).force[c];
            v[c] = fmin(fmax(v[c] + dt / mass * force, -most), most);
        }
        if (loaded) give_velocity(run, wall, v, NAN);
    }
}
