/* Short runs of the contact physics; see physics.h. Three grains slide, roll, collide and part between a
 * floor and two walls. From each tangential law one thing at a time is changed: each choice to each of its
 * words, and each coefficient that is 0 or "auto" to a number. */
#include "sweeps/engine/physics.h"

#include <math.h>
#include <string.h>
#include <xxhash.h>

#include "dem/scene/scene.h"
#include "dem/state/method.h"

enum { N_GRAINS = 3, STEPS = 300 };

typedef struct {
    dem_physics physics;
    dem_ground ground;
    dem_hard hard;
    dem_implicit_solver implicit;
} setting;

typedef struct {
    setting now;
    const char *law;
    rp_status (*visit)(const sweep_physics_run *run, void *context);
    void *context;
} series;

#define ROW(...) DEM_NAME_ROW(setting, physics., __VA_ARGS__)
static const rp_param schema[] = {
    DEM_PHYSICS(ROW){"hard", "", RP_BOOL, offsetof(setting, hard.on), "false", "", "hard collisions"}, {0}};

/* The schema of a group of scene files. */
static const rp_param *schema_of(const char *group)
{
    const dem_scene_group *g = dem_scene_schemas;
    while (strcmp(g->name, group) != 0) g++;
    return g->schema;
}

static setting start_from(dem_tangential_law law)
{
    setting s = {.ground = {.mu_static = 0.4, .a = 0.004, .set = DEM_WELL_REST},
                 .implicit = dem_definition_default().implicit};
    rp_params_defaults(schema, RP_CGS, &s);
    s.hard.restitution = 0.3;
    s.hard.mu = 0.2;
    s.physics.tangential = law;
    s.physics.rotation = true;
    s.physics.k_n = 1e5;
    if (!dem_has_friction(law)) return s;
    s.physics.mu = 0.3;
    s.physics.mu_roll = 0.05;
    s.ground.wall = dem_has_spring(law) ? 0 : 1;
    return s;
}

/* What a word excludes gives way to it; what it needs is given. */
static void make_room(setting *s)
{
    s->physics.rotation = s->physics.rotation && dem_schemes[s->physics.integrator]->rotation;
    if (dem_rolls_by_speed(s->physics.rolling)) s->physics.mu_roll = 1e-3; /* over a speed */
    if (!s->physics.rotation) s->physics.mu_roll = 0.0;
    if (s->hard.on) s->physics.tension = false;
    /* of other laws the search for gamma_n would take longer than all runs */
    while (s->physics.restitution > 0.0 && !dem_normal_descriptors[s->physics.normal].damping_ratio)
        s->physics.normal++;
    if (strcmp(dem_normal_descriptors[s->physics.normal].gamma_n_unit, "1/s") == 0) return;
    s->physics.gamma_n = 0.3;
    s->physics.gamma_s = 5.0;
}

static rp_status simulate(const setting *s, dem_state states[N_GRAINS])
{
    dem_grain grains[N_GRAINS] = {
        {.x = 0.3, .y = 0.0998, .r = 0.1, .vx = 5.0},
        {.x = 0.51, .y = 0.1, .r = 0.11},
        {.x = 0.37, .y = 0.29, .r = 0.09, .vy = -5.0, .omega = s->physics.rotation ? 90.0 : 0.0}};
    dem_definition def = dem_definition_default();
    dem_sim *sim = NULL;
    dem_physics_apply(&s->physics, &def);
    dem_box_walls(&def, 1.0, &def.material);
    for (size_t i = 0; i < N_GRAINS; i++) grains[i].m = dem_mass(def.shape, s->physics.density, grains[i].r);
    def.ground = s->ground;
    def.hard = s->hard;
    def.implicit = s->implicit;
    def.grains = grains;
    def.n_grains = N_GRAINS;
    rp_status status = dem_create(&def, &sim);
    if (!status) status = dem_run(sim, STEPS);
    if (!status) status = dem_states(sim, states);
    dem_free(sim);
    return status;
}

/* Last digits are the C library's, of a coefficient from a restitution, or a solver's. */
static void hash_grains(const dem_state states[N_GRAINS], bool exact, char digits[33])
{
    double v[N_GRAINS][6];
    for (size_t i = 0; i < N_GRAINS; i++) {
        const dem_state *s = &states[i];
        memcpy(v[i], (double[]){s->x, s->y, s->vx, s->vy, s->angle, s->omega}, sizeof v[i]);
        for (int k = 0; k < 6 && !exact; k++) v[i][k] = round(v[i][k] * 1e9);
    }
    rp_hash_digits(XXH3_128bits(v, sizeof v), digits);
}

static rp_status run_word(const rp_param *changed, const char *word, void *context)
{
    const series *all = context;
    setting s = all->now;
    dem_state states[N_GRAINS];
    sweep_physics_run run = {.law = all->law, .key = changed ? changed->name : NULL, .word = word};
    make_room(&s);
    rp_status status = simulate(&s, states);
    if (status == RP_BAD_INPUT && changed) return RP_OK; /* not with this law */
    if (status) return rp_prefix(status, "short run of the physics, %s %s: ", all->law, word ? word : "");
    hash_grains(states,
                !(changed && changed->type == RP_REAL) && dem_schemes[s.physics.integrator]->step_limit,
                run.digits);
    return all->visit(&run, all->context);
}

static rp_status run_numbers(series *all)
{
    for (const rp_param *p = schema; p->name; p++) {
        double *value = (double *)((char *)&all->now + p->offset);
        if (p->type != RP_REAL || *value > 0.0) continue;
        const double before = *value;
        *value = 0.25;
        RP_TRY(run_word(p, "0.25", all));
        *value = before;
    }
    return RP_OK;
}

rp_status sweep_physics_runs(rp_status (*visit)(const sweep_physics_run *run, void *context), void *context)
{
    const rp_param *laws = rp_params_find(schema, "tangential");
    char law[64];
    for (int k = 0; *rp_word_at(laws->range, k, law, sizeof law); k++) {
        series all = {start_from((dem_tangential_law)k), law, visit, context};
        setting *now = &all.now;
        RP_TRY(run_word(NULL, NULL, &all));
        RP_TRY(sweep_each_word(schema, now, run_word, &all));
        if (dem_has_spring(now->physics.tangential)) RP_TRY(run_numbers(&all));
        if (now->ground.wall) RP_TRY(sweep_each_word(schema_of("ground"), &now->ground, run_word, &all));
        now->physics.integrator = DEM_IMPLICIT;
        if (now->ground.wall) RP_TRY(sweep_each_word(schema_of("implicit"), &now->implicit, run_word, &all));
    }
    return RP_OK;
}

static rp_status add_run(const sweep_physics_run *run, void *context)
{
    XXH3_128bits_update(context, run->digits, sizeof run->digits);
    return RP_OK;
}

rp_status sweep_physics_add(char digits[33])
{
    XXH3_state_t *hash = XXH3_createState();
    if (!hash) return rp_fail(RP_NO_MEMORY, "fingerprint: out of memory");
    XXH3_128bits_reset(hash);
    XXH3_128bits_update(hash, digits, 32);
    rp_status status = sweep_physics_runs(add_run, hash);
    rp_hash_digits(XXH3_128bits_digest(hash), digits);
    XXH3_freeState(hash);
    return status;
}
