/* Whether a plan's time step can work. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/elementary.h"
#include "dem/scene/radii.h"
#include "experiment/plan.h"
#include "params/config.h"

/* t and phase_step of a moment; NAN for all else, which only the run knows. */
typedef struct {
    const exp_plan *plan;
    double t, dt;
} moment;

static double at_moment(void *host, int id, const double args[])
{
    const moment *m = host;
    const exp_use *use = id < EXP_ID_MEASURE ? &m->plan->uses[id] : NULL;
    (void)args;
    if (use && strcmp(use->of->name, "t") == 0) return m->t;
    return use && strcmp(use->of->name, "phase_step") == 0 ? m->t / m->dt : NAN;
}

/* The value of an expression of t over a phase that is farthest from 0, at a thousand points; *v stays if it
 * has none. */
static void largest(const exp_plan *plan, const exp_phase *p, const exp_expression *e, rp_arena *arena,
                    double *v)
{
    enum { POINTS = 1000 };
    const double dt = p->laws.physics.dt, end = p->end.x.known ? p->end.x.value : NAN,
                 last = p->ending == EXP_TIME    ? end
                        : p->ending == EXP_STEPS ? end * dt
                                                 : (double)p->most * dt;
    double *states = rp_arena_memory(arena, e->x.n_states, sizeof *states), most = NAN;
    if (!exp_given(e)) return;
    if (e->x.known) {
        *v = e->x.value;
        return;
    }
    for (int k = 0; k < POINTS && states && isfinite(last); k++) {
        moment m = {plan, last * (k + 0.5) / POINTS, dt};
        const double value = rp_expression_value(&e->x, &(rp_x_values){&m, at_moment}, states);
        if (!(fabs(value) <= fabs(most))) most = value;
    }
    if (isfinite(most)) *v = most;
}

/* The speeds that a phase lets a wall have. */
static void let_move(const exp_plan *plan, const exp_phase *p, const exp_move *m, rp_arena *arena,
                     dem_wall *w)
{
    for (int c = 0; c < 2; c++) largest(plan, p, &m->velocity[c], arena, &w->velocity[c]);
    largest(plan, p, &m->omega, arena, &w->omega);
    for (int c = 0; c < 2; c++) {
        if (m->loading[c] == EXP_LOADED) largest(plan, p, &m->speed, arena, &w->velocity[c]);
        if (m->loading[c] == EXP_FREED && !exp_given(&m->velocity[0])) w->velocity[c] = 0.0;
    }
}

/* The lowest limit of dt that refuses a run: its phase, NULL of the start, and the message. */
typedef struct {
    double limit;
    const exp_phase *phase;
    char message[512];
} refusal;

/* Lower it to that of a definition, which a wall's motion sets, or NULL. */
static void lower(const dem_definition *def, const exp_phase *phase, const exp_wall *wall, refusal *least)
{
    dem_limit_name what;
    const double limit = dem_time_step_limit(def, what);
    if (def->dt <= limit || limit >= least->limit) return;
    least->limit = limit, least->phase = phase;
    (void)(wall ? rp_fail(RP_BAD_INPUT, "wall %s needs dt <= %s, by %s", wall->name,
                          rp_text_below(limit, (char[32]){0}), what)
                : dem_refuse_step(def, limit, what));
    snprintf(least->message, sizeof least->message, "%s", rp_message());
}

/* The time step of each phase, with its laws, its gravity and the walls' motions that are known, one after
 * the other. */
static rp_status check_phases(const exp_plan *plan, dem_definition *def, refusal *least)
{
    RP_SCOPE(arena);
    dem_wall *walls;
    double(*gravity)[2]; /* of each phase */
    RP_NEW(&arena, walls, def->n_walls);
    memcpy(walls, dem_walls_of(def), def->n_walls * sizeof *walls);
    def->wall_list = walls;
    RP_NEW(&arena, gravity, plan->n_phases);
    for (size_t p = 0; p < plan->n_phases; p++) {
        const exp_phase *phase = &plan->phases[p];
        if (phase->left_out || phase->n_inner) continue;
        if (phase->source != SIZE_MAX) memcpy(def->gravity, gravity[phase->source], sizeof def->gravity);
        for (int c = 0; c < 2; c++) largest(plan, phase, &phase->gravity[c], &arena, &def->gravity[c]);
        memcpy(gravity[p], def->gravity, sizeof def->gravity);
        if (phase->has_laws) dem_physics_apply(&phase->laws.physics, def);
        if (phase->has_laws) def->pairs = phase->def.pairs;
        for (size_t w = 0; w < def->n_walls && phase->has_laws; w++)
            walls[w].material = dem_walls_of(&phase->def)[w].material;
        double degrees = def->box_turn_per_step * (180.0 / M_PI);
        largest(plan, phase, &phase->turn[1], &arena, &degrees);
        def->box_turn_per_step = degrees * (M_PI / 180.0);
        if (phase->has_laws || exp_given(&phase->gravity[0]) || exp_given(&phase->turn[1]))
            lower(def, phase, NULL, least);
        for (size_t k = 0; k < phase->n_moves; k++) {
            const exp_move *m = &phase->moves[k];
            const exp_wall *wall = &plan->walls[m->wall];
            for (size_t i = 0; i < wall->n; i++) let_move(plan, phase, m, &arena, &walls[wall->walls[i]]);
            lower(def, phase, wall, least);
        }
    }
    return RP_OK;
}

/* Grains that stand for those of the start, the smallest of each fill at both ends of its height, and for
 * those that come, the lightest of each phase as far as that is known. */
static rp_status stand_ins(const exp_plan *plan, rp_arena *arena, dem_definition *def)
{
    const dem_scene *s = &plan->scene;
    const size_t listed = s->grains ? s->def.n_grains : 0;
    dem_grain *grains;
    RP_NEW(arena, grains, listed + 2 * s->n_fills + plan->n_phases);
    if (listed) memcpy(grains, s->grains, listed * sizeof *grains);
    def->grains = grains, def->n_grains = listed;
    for (const dem_fill *f = s->fills; s->n_fills && f < s->fills + s->n_fills; f++) {
        const double r = dem_radius_least(f), m = dem_mass(f->shape, f->density, r);
        for (int end = 0; end < 2; end++)
            grains[def->n_grains++] = (dem_grain){.x = f->x0,
                                                  .y = f->y0 + (f->pattern != DEM_PATTERN_ROW ? end * f->H
                                                                : end ? dem_radius_most(f)
                                                                      : r),
                                                  .r = r,
                                                  .m = m,
                                                  .fixed = f->fixed,
                                                  .kind = f->of_kind};
    }
    const double y = def->n_grains ? grains[0].y : 0.0;
    for (const exp_phase *p = plan->phases; plan->n_phases && p < plan->phases + plan->n_phases; p++) {
        const exp_add *a = &p->add;
        const double density = exp_density(plan, a, a->density.x.known ? a->density.x.value : NAN),
                     r = !exp_given(&a->r) ? dem_radius_least(&a->radii)
                         : a->r.x.known    ? a->r.x.value
                                           : NAN,
                     m = dem_mass(s->def.shape, density, r);
        if (!p->left_out && a->on && m > 0.0)
            grains[def->n_grains++] = (dem_grain){.y = y, .r = r, .m = m, .kind = a->kind};
    }
    return RP_OK;
}

/* A restitution over a mean mass needs grains of the kind at the start. */
static rp_status check_added(const exp_plan *plan, const dem_definition *def)
{
    const dem_scene *s = &plan->scene;
    const bool by_mass = strcmp(dem_normal_descriptors[def->normal].gamma_n_unit, "1") != 0;
    for (const exp_phase *p = plan->phases; plan->n_phases && p < plan->phases + plan->n_phases; p++) {
        const uint32_t kind = p->add.kind;
        bool there = p->left_out || !p->add.on || !def->pairs || !by_mass, asked = false;
        for (size_t k = 0; k < s->n_fills; k++) there |= s->fills[k].of_kind == kind;
        for (size_t i = 0; s->grains && i < s->def.n_grains; i++) there |= s->grains[i].kind == kind;
        for (size_t b = 0; !there && b < def->n_kinds + def->n_walls; b++)
            asked |= def->pairs[b * def->n_kinds + kind].restitution > 0.0;
        if (asked)
            return rp_config_fail(p->setting,
                                  "phase %s: add: no grain of kind \"%s\" is there at the start, so that its "
                                  "restitution has no mean mass; give its gamma_n, or normal.law = \"tsuji\"",
                                  p->name, def->kinds[kind].name);
    }
    return RP_OK;
}

rp_status exp_check(const exp_plan *plan)
{
    dem_definition def = plan->scene.def;
    refusal least = {.limit = INFINITY};
    if (!exp_has_phases(plan->text)) return RP_OK; /* as its grains are, when it starts */
    RP_SCOPE(arena);
    RP_TRY(stand_ins(plan, &arena, &def));
    RP_TRY(rp_prefix(dem_physics_check(&def), "%s: ", plan->text->path));
    RP_TRY(check_added(plan, &def));
    lower(&def, NULL, NULL, &least);
    RP_TRY(check_phases(plan, &def, &least));
    if (isinf(least.limit)) return RP_OK;
    if (!least.phase) return rp_fail(RP_BAD_INPUT, "%s: %s", plan->text->path, least.message);
    return rp_config_fail(least.phase->setting, "phase %s: %s", least.phase->name, least.message);
}
