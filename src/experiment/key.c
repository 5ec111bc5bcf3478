/* What a plan's numbers depend on, and whether its time step can work. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/elementary.h"
#include "dem/scene/radii.h"
#include "experiment/private.h"
#include "params/config.h"

/* A text in the making, and the measures that it names so far. */
typedef struct {
    const exp_plan *plan;
    rp_arena *arena;
    FILE *out;
    bool *asked;
} writer;

static void put(const writer *w, const char *key, const exp_expression *e)
{
    const char *text = e->x.text || e->x.known ? rp_expression_key(w->arena, &e->x) : NULL;
    int id;
    if (text)
        fprintf(w->out, " %s=[%s]", key,
                e->x.known && e->x.n == 0 ? rp_number_text(e->x.value, 6, (char[32]){0}, 32) : text);
    for (size_t k = 0; (id = rp_expression_asks(&e->x, k)) >= 0; k++)
        for (size_t m = 0; id >= EXP_ID_MEASURE && m < w->plan->n_measures; m++)
            w->asked[m] |=
                (size_t)(id - EXP_ID_MEASURE) - w->plan->measures[m].output < w->plan->measures[m].n_outputs;
}

static void put_add(const writer *w, const exp_add *a)
{
    FILE *const out = w->out;
    const exp_expression *const e[] = {&a->n,    &a->r,  &a->density, &a->x[0],  &a->x[1], &a->y[0],
                                       &a->y[1], &a->vx, &a->vy,      &a->omega, &a->gap};
    const dem_fill *f = &a->radii;
    fprintf(out, " add kind=%s range=%d r=%d", a->kind < 0 ? "" : a->kind_name, a->in_range,
            exp_given(&a->r));
    for (size_t k = 0; k < sizeof e / sizeof *e; k++) put(w, "e", e[k]);
    fprintf(out, " radii %a %a %a %a %d %d", f->radius_mean, f->radius_width, f->radius_min, f->radius_max,
            f->law, f->by);
    for (size_t k = 0; k < 2 * f->n_radii; k++) fprintf(out, " %a", f->radii[k]);
}

static void put_phase(const writer *w, const exp_phase *p)
{
    const exp_plan *const plan = w->plan;
    FILE *const out = w->out;
    static const char *const ends[] = {"steps", "time", "until"};
    fprintf(out, "phase %s of %ld every=%ld least=%ld most=%ld on=%d mark=%d status=%s repeat=%ld", p->name,
            p->block == SIZE_MAX ? -1L : (long)p->block, p->every, p->least, p->most, p->go_on, p->mark,
            p->status, p->repeat);
    if (p->damp) fputs(" damp", out);
    if (p->source != SIZE_MAX) fprintf(out, " from=%s", plan->phases[p->source].name);
    if (*p->remove) fprintf(out, " remove=%s", p->remove);
    if (p->has_laws) {
        fputc(' ', out);
        dem_laws_write(&p->laws, out);
        for (size_t i = 0; i < plan->scene.def.n_walls; i++)
            for (size_t k = 0; k < sizeof *p->given / sizeof(double); k++)
                fprintf(out, " %a", ((const double *)&p->given[i])[k]);
    }
    if (p->add.on) put_add(w, &p->add);
    if (p->opens >= 0) fprintf(out, " open=%s", plan->walls[p->opens].name);
    put(w, ends[p->ending], &p->end);
    for (int k = 0; k < 2; k++) {
        put(w, "g", &p->gravity[k]);
        put(w, k ? "box" : "turn", &p->turn[k]);
    }
    for (size_t k = 0; k < p->n_moves; k++) {
        const exp_move *m = &p->moves[k];
        fprintf(out, " wall %s", plan->walls[m->wall].name);
        for (int c = 0; c < 2; c++) put(w, "v", &m->velocity[c]);
        put(w, "omega", &m->omega);
        for (int c = 0; c < 2; c++) {
            if (m->loading[c] != EXP_SAME) fprintf(out, " load %d %d", c, m->loading[c]);
            if (m->loading[c] == EXP_LOADED) put(w, "load", &m->load[c]);
        }
        put(w, "speed", &m->speed);
    }
    for (size_t k = 0; k < p->n_fails; k++) put(w, p->fails[k].word, &p->fails[k].when);
    fputc('\n', out);
}

static void put_measure(const writer *w, const exp_measure *m)
{
    const exp_plan *const plan = w->plan;
    FILE *const out = w->out;
    if (m->left_out) return;
    fprintf(out, "measure %s in %s take=%d during=%d every=%ld skip=%a optional=%d", m->name,
            plan->phases[m->phase].name, m->take, *m->during != '\0', m->every, m->skip, m->optional);
    put(w, "of", &m->of);
    put(w, "when", &m->when);
    put(w, "event", &m->event);
    put(w, "against", &m->against);
    if (m->take == TAKE_AVALANCHES) fprintf(out, " drop=%a", m->drop);
    if (*m->level_of) fprintf(out, " level_of=%s", m->level_of), w->asked[m->levels_with] = true;
    const bool named =
        config_setting_get_member(m->setting, "columns") || config_setting_get_member(m->setting, "prefix");
    for (size_t o = 0; named && o < m->n_outputs; o++)
        fprintf(out, " column=%s", plan->outputs[m->output + o].name);
    if (m->module) {
        fprintf(out, " module=%s %ld in=%s ", m->module->name, m->pick, m->in);
        if (m->module->needs & EXP_ON_WALL) fprintf(out, "wall=%s ", m->wall);
        rp_config_write(out, m->module->schema, m->params);
    }
    fputc('\n', out);
}

static void put_scene(const writer *w)
{
    const exp_plan *const plan = w->plan;
    FILE *const out = w->out;
    dem_scene scene = plan->scene;
    scene.def.kernel = DEM_FAST;
    scene.def.ledger = false;
    scene.steps = 0;
    scene.seed = scene.run = 0;
    for (size_t k = 0; k < scene.n_fills; k++) scene.fills[k].seed = scene.fills[k].run = 0;
    dem_scene_write(&scene, out);
    for (const dem_contact *c = scene.def.contacts; c < scene.def.contacts + scene.def.n_contacts; c++)
        fprintf(out, "spring %u %u %d %a %a\n", c->id_a, c->id_b, c->wall, c->shear_spring,
                c->rolling_spring);
    fprintf(out, "rest %a %a %ld %ld\n", plan->rest.energy, plan->rest.force, plan->rest.looks,
            plan->rest.every);
    for (size_t k = 0; k < plan->n_regions; k++) {
        const exp_region *r = &plan->regions[k];
        fprintf(out, "region %s", r->name);
        for (int c = 0; c < 3 && r->circle; c++) put(w, "circle", &r->at[c]);
        for (int c = 0; c < 2 && !r->circle && !r->n_points; c++)
            put(w, "x", &r->at[c]), put(w, "y", &r->at[2 + c]);
        for (size_t c = 0; c < 2 * r->n_points; c++) put(w, "p", &r->points[c]);
        fputc('\n', out);
    }
    for (size_t k = 0; k < plan->n_phases; k++)
        if (!plan->phases[k].left_out) put_phase(w, &plan->phases[k]);
}

char *exp_key(const exp_plan *plan)
{
    char *text = NULL;
    size_t size = 0;
    RP_SCOPE(arena);
    const writer w = {plan, &arena, open_memstream(&text, &size),
                      rp_arena_memory(&arena, plan->n_measures, sizeof *w.asked)};
    if (!w.out) return NULL;
    if (w.asked) {
        put_scene(&w);
        for (size_t k = 0; k < plan->n_measures; k++) put_measure(&w, &plan->measures[k]);
        fprintf(w.out, "result %s\n", plan->result);
    }
    fclose(w.out);
    if (!w.asked) free(text), text = NULL;
    return text;
}

/* Add what has been written since the last time. */
static void add_text(const writer *w, char *const *text, const size_t *size, size_t *from, XXH128_hash_t *sum)
{
    fflush(w->out);
    *sum = rp_hash_add(*sum, XXH3_128bits(*text + *from, *size - *from));
    *from = *size;
}

/* What has been at looks may differ with those of other measures. */
static void put_looks(const writer *w)
{
    const exp_plan *const plan = w->plan;
    if (!exp_names(plan, "touched") && !exp_names(plan, "tilt_deg")) return;
    for (const exp_measure *m = plan->measures; m < plan->measures + plan->n_measures; m++)
        if (!m->left_out && *m->during)
            fprintf(w->out, "looks %s %ld\n", plan->phases[m->phase].name, m->every);
}

/* Of the scene, and of the measures that are asked, or that one of these asks: they ask earlier ones alone.
 */
static bool hash(const exp_plan *plan, bool asked[], XXH128_hash_t *sum)
{
    char *text = NULL;
    size_t size = 0, from = 0;
    RP_SCOPE(arena);
    const writer w = {plan, &arena, open_memstream(&text, &size), asked};
    *sum = (XXH128_hash_t){0};
    if (!w.out) return false;
    put_scene(&w);
    put_looks(&w);
    fprintf(w.out, "result %s\n", plan->result);
    add_text(&w, &text, &size, &from, sum);
    for (size_t k = plan->n_measures; k-- > 0;) {
        if (!asked[k] || plan->measures[k].left_out) continue;
        put_measure(&w, &plan->measures[k]);
        add_text(&w, &text, &size, &from, sum);
    }
    fclose(w.out);
    free(text);
    return true;
}

bool exp_hash(const exp_plan *plan, const char *const outputs[], size_t n, XXH128_hash_t *sum)
{
    bool *asked = calloc(plan->n_measures + 1, sizeof *asked), known = asked != NULL;
    for (size_t k = 0; k < n && known; k++) {
        size_t output;
        const exp_measure *m = exp_measure_of(plan, outputs[k], &output);
        known = m != NULL;
        if (m) asked[m - plan->measures] = true;
    }
    known = known && hash(plan, asked, sum);
    free(asked);
    return known;
}

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
    for (const dem_fill *f = s->fills; f < s->fills + s->n_fills; f++) {
        const double r = dem_radius_least(f), m = dem_mass(f->shape, f->density, r);
        for (int end = 0; end < 2; end++)
            grains[def->n_grains++] = (dem_grain){.x = f->x0,
                                                  .y = f->y0 + (f->pattern != DEM_PATTERN_ROW ? end * f->H
                                                                : end ? dem_radius_most(f)
                                                                      : r),
                                                  .r = r,
                                                  .m = m,
                                                  .fixed = f->fixed};
    }
    const double y = def->n_grains ? grains[0].y : 0.0;
    for (const exp_phase *p = plan->phases; p < plan->phases + plan->n_phases; p++) {
        const exp_add *a = &p->add;
        const double density = exp_density(plan, a, a->density.x.known ? a->density.x.value : NAN),
                     r = !exp_given(&a->r) ? dem_radius_least(&a->radii)
                         : a->r.x.known    ? a->r.x.value
                                           : NAN,
                     m = dem_mass(s->def.shape, density, r);
        if (!p->left_out && a->on && m > 0.0) grains[def->n_grains++] = (dem_grain){.y = y, .r = r, .m = m};
    }
    return RP_OK;
}

rp_status exp_check(const exp_plan *plan)
{
    dem_definition def = plan->scene.def;
    refusal least = {.limit = INFINITY};
    RP_SCOPE(arena);
    RP_TRY(stand_ins(plan, &arena, &def));
    RP_TRY(rp_prefix(dem_physics_check(&def), "%s: ", plan->text->path));
    lower(&def, NULL, NULL, &least);
    RP_TRY(check_phases(plan, &def, &least));
    if (isinf(least.limit)) return RP_OK;
    if (!least.phase) return rp_fail(RP_BAD_INPUT, "%s: %s", plan->text->path, least.message);
    return rp_config_fail(least.phase->setting, "phase %s: %s", least.phase->name, least.message);
}
