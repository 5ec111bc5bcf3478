/* Kinds of grains in a scene file: their numbers, their coefficients as given, and those of their contacts.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dem/scene/file.h"
#include "params/guess.h"

/* ---- Numbers ---- */

rp_status dem_number_kind(dem_scene *scene, const char *name, uint32_t *number)
{
    dem_definition *def = &scene->def;
    const size_t n = def->n_kinds > 0 ? def->n_kinds : 1;
    dem_kind *kinds;
    for (*number = 0; *number < n && strcmp(*number ? def->kinds[*number].name : "", name) != 0;) ++*number;
    if (*number < DEM_MOST_MIXED) scene->has[*number] = true;
    if (*number < n) return RP_OK;
    if (scene->kinds_listed) {
        rp_guess guess = rp_guess_of(name);
        for (size_t k = 1; k < n; k++) rp_guess_try(&guess, def->kinds[k].name);
        return rp_fail(RP_BAD_INPUT,
                       "kind = \"%s\": none of `kinds`%s; one with the scene's coefficients is %s = {};",
                       name, rp_guess_text(&guess), name);
    }
    if (n == DEM_MOST_KINDS) return rp_fail(RP_BAD_INPUT, "kind = \"%s\": one of more than %zu", name, n);
    if ((n & (n - 1)) == 0) { /* a power of two: the room is full */
        RP_NEW(&scene->arena, kinds, 2 * n);
        if (def->kinds) memcpy(kinds, def->kinds, n * sizeof *kinds);
        def->kinds = kinds;
    }
    strcpy(((dem_kind *)def->kinds)[n].name, name);
    def->n_kinds = n + 1;
    return RP_OK;
}

rp_status dem_read_kind(const config_setting_t *group, dem_scene *scene, uint32_t *number)
{
    const config_setting_t *kind = member(group, "kind");
    const char *name = kind ? config_setting_get_string(kind) : "", *key;
    for (size_t k = 0; name && *name && k < length(group); k++)
        if (rp_params_find(SCHEMA(KINDS), key = config_setting_name(element(group, k))) &&
            !rp_params_find(SCHEMA(FILL), key))
            return rp_config_fail(element(group, k),
                                  "%s: of all grains of a kind, kinds = { %s = { %s = ...; }; }", key, name,
                                  key);
    if (!name) return rp_config_fail(kind, "kind: a name expected");
    RP_TRY(dem_read_name(&scene->arena, group, "kind", &name));
    return dem_number_kind(scene, name, number) ? rp_config_fail(kind, "%s", rp_message()) : RP_OK;
}

rp_status dem_number_added(const config_setting_t *phases, dem_scene *scene)
{
    for (size_t i = 0; phases && config_setting_is_list(phases) && i < length(phases); i++) {
        const config_setting_t *phase = element(phases, i);
        if (!config_setting_is_group(phase)) continue;
        const config_setting_t *add = member(phase, "add");
        if (add && config_setting_is_group(add)) RP_TRY(dem_read_kind(add, scene, &(uint32_t){0}));
        RP_TRY(dem_number_added(member(phase, "phases"), scene));
    }
    return RP_OK;
}

/* ---- What the file says ---- */

/* NAME = { density; material = { ... }; mu; ... }, over what the kind has said. */
static rp_status read_said(const config_setting_t *group, const dem_scene *scene, bool masses,
                           dem_kind_said *said)
{
    const config_setting_t *material = config_setting_is_group(group) ? member(group, "material") : NULL;
    const bool was_solid = said->E > 0.0 || said->nu >= 0.0;
    for (size_t k = 0; material && k < length(material); k++)
        if (config_setting_is_group(material) &&
            !rp_params_find(SCHEMA(MATERIAL), config_setting_name(element(material, k))))
            return rp_config_unknown(element(material, k), SCHEMA(MATERIAL), NULL, "");
        else if (config_setting_is_group(material) &&
                 member(group, config_setting_name(element(material, k))))
            return rp_config_fail(element(material, k), "%s: given twice, in the kind and in its material",
                                  config_setting_name(element(material, k)));
    if (material) RP_TRY(rp_config_group(material, SCHEMA(KINDS), said, NULL));
    RP_TRY(rp_config_group(group, SCHEMA(KINDS), said, "material"));
    if (!(scene->E > 0.0) && (said->E > 0.0 || said->nu >= 0.0) && !was_solid)
        return rp_config_fail(group, "E, nu: of a kind need the scene's in material = { E; nu; ... }");
    if (scene->E > 0.0 && (said->material.k_n >= 0.0 || said->material.k_s >= 0.0))
        return rp_config_fail(group, "k_n and k_s of a kind follow from material; give its E and nu");
    return !masses && member(group, "density")
               ? rp_config_fail(member(group, "density"), "density: of a grain that is there, it stays")
               : RP_OK;
}

/* All kinds so far, with what those have said. */
static rp_status say_all(dem_scene *scene, dem_scene_laws *laws, dem_kind_said **kinds)
{
    const size_t n = scene->def.n_kinds;
    RP_NEW(&scene->arena, *kinds, n);
    for (size_t k = 0; k < n; k++) {
        rp_params_defaults(SCHEMA(KINDS), scene->def.units, *kinds + k);
        if (k < laws->n_kinds) (*kinds)[k] = laws->kinds[k];
    }
    laws->kinds = *kinds, laws->n_kinds = n;
    return RP_OK;
}

/* Does a pair of names stand for these? In either order. */
static bool is_of(const dem_pair_said *p, const char *const names[2])
{
    return (strcmp(p->of[0], names[0]) == 0 && strcmp(p->of[1], names[1]) == 0) ||
           (strcmp(p->of[0], names[1]) == 0 && strcmp(p->of[1], names[0]) == 0);
}

/* { of = ("NAME", "NAME"); mu; ... } */
static rp_status read_pair(const config_setting_t *group, dem_scene *scene, dem_pair_said *pair)
{
    const config_setting_t *of = config_setting_is_group(group) ? member(group, "of") : NULL;
    rp_params_defaults(SCHEMA(PAIRS), scene->def.units, pair);
    RP_TRY(rp_config_group(group, SCHEMA(PAIRS), pair, "of"));
    for (size_t k = 0; k < 2; k++) {
        pair->of[k] = of && length(of) == 2 ? config_setting_get_string_elem(of, (int)k) : NULL;
        if (!pair->of[k])
            return rp_config_fail(of ? of : group,
                                  "of = (\"NAME\", \"NAME\"): two kinds, or a kind and a wall, expected");
        RP_TRY(dem_read_name(&scene->arena, of, "of", &pair->of[k]));
    }
    return RP_OK;
}

static rp_status read_pairs(const config_setting_t *list, dem_scene *scene, dem_scene_laws *laws)
{
    dem_pair_said *pairs;
    if (!config_setting_is_list(list)) return rp_config_fail(list, "pairs: a list ( { ... } ) expected");
    RP_NEW(&scene->arena, pairs, laws->n_pairs + length(list));
    if (laws->n_pairs) memcpy(pairs, laws->pairs, laws->n_pairs * sizeof *pairs);
    for (size_t k = 0; k < length(list); k++) {
        dem_pair_said *pair = &pairs[laws->n_pairs + k];
        RP_TRY(read_pair(element(list, k), scene, pair));
        for (const dem_pair_said *p = pair - k; p < pair; p++)
            if (is_of(p, pair->of))
                return rp_config_fail(element(list, k), "pairs: of = (\"%s\", \"%s\") twice", pair->of[0],
                                      pair->of[1]);
    }
    laws->pairs = pairs, laws->n_pairs += length(list);
    return RP_OK;
}

rp_status dem_read_kinds(const config_setting_t *group, bool known, dem_scene *scene, dem_scene_laws *laws)
{
    const config_setting_t *list = member(group, "kinds"), *pairs = member(group, "pairs");
    dem_kind_said *kinds = NULL;
    uint32_t number;
    if (list && !config_setting_is_group(list))
        return rp_config_fail(list, "kinds: a group { NAME = { ... }; } expected");
    for (size_t k = 0; k < length(list) && !known; k++) {
        const char *name = config_setting_name(element(list, k));
        RP_TRY(dem_read_name(&scene->arena, element(list, k), "kinds", &name));
        RP_TRY(dem_number_kind(scene, name, &number));
    }
    if (!known) memset(scene->has, 0, sizeof scene->has), scene->kinds_listed = length(list) > 0;
    if (length(list) > 0) RP_TRY(say_all(scene, laws, &kinds));
    for (size_t k = 0; k < length(list); k++) {
        const config_setting_t *entry = element(list, k);
        rp_guess guess = rp_guess_of(config_setting_name(entry));
        for (number = 1; number < laws->n_kinds; number++) {
            if (strcmp(scene->def.kinds[number].name, config_setting_name(entry)) == 0) break;
            rp_guess_try(&guess, scene->def.kinds[number].name);
        }
        if (number == laws->n_kinds)
            return rp_config_fail(entry, "kinds: no grains are of the kind %s%s", config_setting_name(entry),
                                  rp_guess_text(&guess));
        RP_TRY(read_said(entry, scene, !known, &kinds[number]));
    }
    return pairs ? read_pairs(pairs, scene, laws) : RP_OK;
}

double dem_density_of(const dem_scene *scene, size_t kind)
{
    const double own = kind < scene->laws.n_kinds ? scene->laws.kinds[kind].density : -1.0;
    return own > 0.0 ? own : scene->laws.physics.density;
}

rp_status dem_peek_density(const config_setting_t *group, double *density)
{
    const config_setting_t *root = group, *kind = member(group, "kind"), *kinds;
    const char *name = kind ? config_setting_get_string(kind) : NULL;
    dem_kind_said said = {.density = *density};
    while (!config_setting_is_root(root)) root = config_setting_parent(root);
    kinds = member(root, "kinds");
    kind = kinds && name && config_setting_is_group(kinds) ? member(kinds, name) : NULL;
    if (kind && config_setting_is_group(kind)) RP_TRY(rp_config_peek(kind, SCHEMA(KINDS), "density", &said));
    *density = said.density;
    return RP_OK;
}

/* ---- Coefficients of contacts ---- */

/* What grains of a kind have: what it says, else the scene's; is its material its own? */
typedef struct {
    dem_physics physics;
    double E, nu;
    bool solid;
} body;

static dem_material coefficients_of(const dem_physics *p)
{
    dem_material m;
#define TAKE(kind, type, name, ...) DEM_IF_MATERIAL(kind, m.name = p->name;)
    DEM_PHYSICS(TAKE)
    return m;
}

static dem_kind_said said_by(const dem_scene_laws *laws, size_t kind)
{
    const dem_kind_said nothing = {.material = dem_material_auto, .density = -1.0, .E = -1.0, .nu = -1.0};
    return kind < laws->n_kinds ? laws->kinds[kind] : nothing;
}

static body body_of(const dem_scene *scene, const dem_scene_laws *laws, size_t kind)
{
    const dem_kind_said said = said_by(laws, kind);
    body b = {laws->physics, said.E > 0.0 ? said.E : scene->E, said.nu >= 0.0 ? said.nu : scene->nu,
              said.E > 0.0 || said.nu >= 0.0};
    dem_material m = coefficients_of(&laws->physics);
    dem_material_over(&said.material, &m);
    if (b.solid) dem_elastic_contact((double[]){b.E, b.E}, (double[]){b.nu, b.nu}, &m.k_n, &m.k_s);
#define PUT(kind, type, name, ...) DEM_IF_MATERIAL(kind, b.physics.name = m.name;)
    DEM_PHYSICS(PUT)
    return b;
}

/* With the wall's stiffness by E, where it is. */
static dem_material given_with(const dem_scene *scene, const body *b, size_t wall, const dem_material *given)
{
    const double *own = scene->bodies[wall], E[2] = {b->E, own[0] > 0.0 ? own[0] : b->E},
                 nu[2] = {b->nu, own[1] >= 0.0 ? own[1] : b->nu};
    dem_material m = *given;
    double k_n, k_s;
    if (!(scene->E > 0.0)) return m;
    dem_elastic_contact(E, nu, &k_n, &k_s);
    if (m.k_n < 0.0) m.k_n = k_n;
    if (m.k_s < 0.0) m.k_s = k_s;
    return m;
}

dem_material dem_material_of_wall(const dem_scene *scene, const dem_scene_laws *laws, size_t kind,
                                  size_t wall, const dem_material *given)
{
    const body b = body_of(scene, laws, kind);
    const dem_material with = given_with(scene, &b, wall, given);
    return dem_wall_material(scene->def.units, &with, &b.physics);
}

/* Two that touch: a kind, and a kind or a wall; what is said of them together. */
typedef struct {
    const char *names[2];
    bool wall;
    dem_pair_rule rule;
    dem_material said;
} couple;

static void write_value(double v, char text[32])
{
    v < 0.0 ? (void)strcpy(text, "auto") : (void)rp_number_text(v, 6, text, 32);
}

/* Of coefficients that differ, the one that the rule gives. */
static rp_status settle(const couple *c, const char *key, double a, double b, double *value)
{
    char texts[2][32];
    *value = c->rule == DEM_PAIRS_SMALLER ? fmin(a, b) : sqrt(a) * sqrt(b);
    if (c->rule != DEM_PAIRS_EQUAL && a >= 0.0 && b >= 0.0) return RP_OK;
    write_value(a, texts[0]), write_value(b, texts[1]);
    return rp_fail(
        RP_BAD_INPUT,
        "kind \"%s\" has %s = %s, and %s \"%s\" %s: say what their contacts have, pairs = ( { of = "
        "(\"%s\", \"%s\"); %s = ...; } ); %s",
        c->names[0], key, texts[0], c->wall ? "wall" : "kind", c->names[1], texts[1], c->names[0],
        c->names[1], key,
        c->rule == DEM_PAIRS_EQUAL ? "or pairs_rule = \"smaller\" or \"geometric\""
                                   : "pairs_rule needs both values");
}

/* 1/k = 1/(2 a) + 1/(2 b) */
static double in_series(double a, double b)
{
    return a == b ? a : 2.0 / (1.0 / a + 1.0 / b);
}

static bool is_damping(const char *key)
{
    return strcmp(key, "restitution") == 0 || strcmp(key, "gamma_n") == 0;
}

/* Is a coefficient given here, or one that it follows from? */
static bool is_given(const dem_material *m, const char *key, double value)
{
    return is_damping(key) ? m->restitution > 0.0 || m->gamma_n >= 0.0 : value >= 0.0;
}

/* Of two kinds. */
static rp_status mix(const dem_scene *scene, const dem_scene_laws *laws, const couple *c, size_t a, size_t b,
                     const dem_definition *def, dem_material *m)
{
    const body A = body_of(scene, laws, a), B = body_of(scene, laws, b);
    dem_material first = coefficients_of(&A.physics), second = coefficients_of(&B.physics);
    dem_material_complete(def, &first), dem_material_complete(def, &second);
    *m = coefficients_of(&A.physics);
#define MIX(kind, type, name, ...)                                                                           \
    DEM_IF_MATERIAL(                                                                                         \
        kind, if (A.physics.name != B.physics.name) {                                                        \
            if (dem_is_stiffness(#name))                                                                     \
                m->name = in_series(first.name, second.name);                                                \
            else if (!is_given(&c->said, #name, c->said.name))                                               \
                RP_TRY(settle(c, #name, A.physics.name, B.physics.name, &m->name));                          \
        })
    DEM_PHYSICS(MIX)
    if (A.solid || B.solid)
        dem_elastic_contact((double[]){A.E, B.E}, (double[]){A.nu, B.nu}, &m->k_n, &m->k_s);
    return RP_OK;
}

/* Of a kind and a wall: what both say must be the same. */
static rp_status mix_wall(const dem_scene *scene, const dem_scene_laws *laws, const couple *c, size_t a,
                          size_t wall, const dem_material *given, dem_material *m)
{
    const dem_material said = said_by(laws, a).material;
    const body b = body_of(scene, laws, a);
    const dem_material own = coefficients_of(&b.physics);
    dem_material both = own, with = *given;
    dem_material_over(given, &both);
#define MEET(kind, type, name, ...)                                                                          \
    DEM_IF_MATERIAL(kind, if (!dem_is_stiffness(#name) && own.name != both.name &&                           \
                              is_given(&said, #name, said.name) && !is_given(&c->said, #name, c->said.name)) \
                              RP_TRY(settle(c, #name, own.name, both.name, &with.name));)
    DEM_PHYSICS(MEET)
    dem_material_over(&c->said, &with); /* and what follows from them */
    *m = dem_material_of_wall(scene, laws, a, wall, &with);
    return RP_OK;
}

/* All names of pairs are those of kinds or walls. */
static rp_status check_names(const dem_scene *scene, const dem_scene_laws *laws)
{
    const dem_definition *def = &scene->def;
    for (size_t k = 0; k < 2 * laws->n_pairs; k++) {
        const char *name = laws->pairs[k / 2].of[k % 2];
        rp_guess guess = rp_guess_of(name);
        size_t kinds = 0, walls = 0;
        for (size_t i = 0; i < def->n_kinds; i++)
            kinds += strcmp(def->kinds[i].name, name) == 0, rp_guess_try(&guess, def->kinds[i].name);
        for (size_t w = 0; w < def->n_walls && *name; w++)
            walls += strcmp(scene->names[w], name) == 0, rp_guess_try(&guess, scene->names[w]);
        if (kinds && walls) return rp_fail(RP_BAD_INPUT, "%s names a wall and a kind", name);
        if (!kinds && !walls)
            return rp_fail(RP_BAD_INPUT, "pairs: no kind or wall is called \"%s\"%s", name,
                           rp_guess_text(&guess));
    }
    return RP_OK;
}

rp_status dem_mix_kinds(dem_scene *scene, const dem_scene_laws *laws, const dem_material *given,
                        dem_definition *def)
{
    const size_t n = def->n_kinds;
    dem_material *pairs;
    def->pairs = NULL;
    if (laws->n_kinds == 0 && laws->n_pairs == 0) return RP_OK;
    if (n < 2) return rp_fail(RP_BAD_INPUT, "pairs: no grains have a kind");
    if (n > DEM_MOST_MIXED) return rp_fail(RP_BAD_INPUT, "%zu kinds: at most %d", n, DEM_MOST_MIXED);
    RP_TRY(check_names(scene, laws));
    RP_NEW(&scene->arena, pairs, n * (n + def->n_walls));
    for (size_t k = 0; k < n * (n + def->n_walls); k++) {
        const size_t a = k % n, b = k / n;
        if (b > a && b < n) {
            pairs[k] = pairs[a * n + b];
            continue;
        }
        const bool wall = b >= n, meet = scene->has[a] && (wall || scene->has[b]);
        couple c = {{def->kinds[a].name, wall ? scene->names[b - n] : def->kinds[b].name},
                    wall,
                    meet ? (dem_pair_rule)laws->pairs_rule : DEM_PAIRS_SMALLER,
                    dem_material_auto};
        for (const dem_pair_said *p = laws->pairs; p < laws->pairs + laws->n_pairs; p++)
            if (is_of(p, c.names) && !(wall && !*c.names[1])) dem_material_over(&p->material, &c.said);
        const rp_status status = wall ? mix_wall(scene, laws, &c, a, b - n, &given[b - n], &pairs[k])
                                      : mix(scene, laws, &c, a, b, def, &pairs[k]);
        if (status && meet) return status;
        dem_material_over(&c.said, &pairs[k]);
        dem_material_complete(def, &pairs[k]);
        if (meet && dem_material_check(def, &pairs[k]))
            return rp_fail(RP_BAD_INPUT, "kind \"%s\" and %s \"%s\": %s", c.names[0], wall ? "wall" : "kind",
                           c.names[1], rp_message());
    }
    def->pairs = pairs;
    return RP_OK;
}
