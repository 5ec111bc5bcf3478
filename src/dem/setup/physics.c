/* The physical parameters, from what is given to a definition, see parameters.h; definitions that begin with
 * their defaults. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/arena.h"
#include "dem/setup/definition.h"
#include "dem/state/method.h"

static const rp_param schema[] = {
#define ROW(...) DEM_NAME_ROW(dem_physics, , __VA_ARGS__)
    DEM_PHYSICS(ROW){0}};

dem_physics dem_physics_default(rp_units units)
{
    dem_physics p;
    rp_params_defaults(schema, units, &p);
    return p;
}

bool dem_damps_by_rate(const dem_definition *def)
{
    return strcmp(dem_normal_descriptors[def->normal].gamma_n_unit, "1/s") == 0;
}

/* In the order of the list: a value may depend on those before it. What follows from a gamma_n that is not
 * known yet stays negative. */
void dem_material_complete(const dem_definition *def, dem_material *m)
{
    const bool rate = dem_damps_by_rate(def);
#define MATERIAL_VALUE(...) MATERIAL_VALUE_OF(__VA_ARGS__)
#define MATERIAL_VALUE_OF(kind, type, name, key, unit, fallback, range, also, automatic, ...)                \
    DEM_IF_MATERIAL(kind, if (m->name < 0.0) m->name = automatic; if (m->name < 0.0) m->name = -1.0;)
    DEM_PHYSICS(MATERIAL_VALUE)
}

void dem_physics_apply(const dem_physics *p, dem_definition *def)
{
    dem_material *m = &def->material;
#define GIVEN(kind, type, name, ...)                                                                         \
    DEM_IF_SCENE(kind, def->name = p->name;) DEM_IF_MATERIAL(kind, m->name = p->name;)
    DEM_PHYSICS(GIVEN)
    dem_material_complete(def, m);
}

static bool is_word(const char *words, int index)
{
    return *rp_word_at(words, index, (char[64]){0}, 64);
}

bool dem_words_known(const dem_definition *def)
{
    bool known = true;
#define KNOWN_RP_REAL(value, range)   true
#define KNOWN_RP_BOOL(value, range)   rp_keep_bool(&(value))
#define KNOWN_RP_CHOICE(value, range) is_word(range, (int)(value))
#define KNOWN(kind, type, name, key, unit, fallback, range, ...)                                             \
    DEM_IF_SCENE(kind, known &= KNOWN_##type(def->name, range);)
    DEM_PHYSICS(KNOWN)
    return known && dem_schemes[def->integrator] && rp_keep_bool(&def->hard.on) &&
           (!def->hard.on || dem_hard_collisions);
}

#define AUTO(kind, type, name, ...) DEM_IF_MATERIAL(kind, .name = -1.0, )
const dem_material dem_material_auto = {DEM_PHYSICS(AUTO)};

void dem_material_over(const dem_material *given, dem_material *m)
{
    if (given->gamma_n >= 0.0) m->restitution = -1.0;
    if (given->restitution > 0.0) m->gamma_n = -1.0;
#define OVER(kind, type, name, ...) DEM_IF_MATERIAL(kind, if (given->name >= 0.0) m->name = given->name;)
    DEM_PHYSICS(OVER)
}

dem_material dem_wall_material(rp_units units, const dem_material *given, const dem_physics *grains)
{
    const dem_definition laws = {.normal = grains->normal, .tangential = grains->tangential, .units = units};
    dem_material m;
#define WALL_VALUE(...) WALL_VALUE_OF(__VA_ARGS__)
#define WALL_VALUE_OF(kind, type, name, key, unit, fallback, range, also, automatic, wall, ...)              \
    DEM_IF_MATERIAL(kind, m.name = (wall)*grains->name;)
    DEM_PHYSICS(WALL_VALUE)
    dem_material_over(given, &m);
    dem_material_complete(&laws, &m);
    return m;
}

rp_status dem_restitution_check(const dem_definition *def, const dem_material *m)
{
    const dem_normal_descriptor *law = &dem_normal_descriptors[def->normal];
    if (m->restitution > 0.0 && m->gamma_n >= 0.0)
        return rp_fail(RP_BAD_INPUT, "restitution = %g, gamma_n = %g: give one, the other follows",
                       m->restitution, m->gamma_n);
    if (m->restitution > 0.0 && !law->damping_ratio && !isfinite(def->restitution_speed))
        return rp_fail(
            RP_BAD_INPUT,
            "restitution = %g: that of the law %s depends on speed; give restitution_speed, in (0, "
            "inf), the speed of the impacts that count, as sqrt(2 g h) of a fall, or gamma_n instead",
            m->restitution, law->name);
    return rp_check_range("restitution", m->restitution, -INFINITY, 1.0, "(0, 1]");
}

/* gamma_n of a contact of mass m_eff whose impacts have the restitution. */
static rp_status find_damping(const dem_definition *def, double m_eff, dem_material *m)
{
    RP_TRY(dem_restitution_check(def, m));
    if (!(m->restitution > 0.0)) return RP_OK;
    if (!(m->k_n > 0.0)) return rp_fail(RP_BAD_INPUT, "restitution = %g: needs k_n > 0", m->restitution);
    const rp_status status = dem_damping_of(
        &(dem_head_on){def->normal, def->tension, .k_n = m->k_n, .m_eff = m_eff, .v = def->restitution_speed},
        m->restitution, &m->gamma_n);
    m->restitution = -1.0;
    return status;
}

void dem_physics_free(dem_definition *copy, const dem_definition *def)
{
    if (copy->wall_list != def->wall_list) free((dem_wall *)copy->wall_list);
    copy->wall_list = def->wall_list;
    if (copy->pairs != def->pairs) free((dem_material *)copy->pairs);
    copy->pairs = def->pairs;
}

/* The walls of the copy, that may be changed; NULL without memory. */
static dem_wall *own_walls(dem_definition *copy)
{
    if (!copy->wall_list) return copy->walls;
    dem_wall *walls = malloc((copy->n_walls + 1) * sizeof *walls);
    if (walls) memcpy(walls, copy->wall_list, copy->n_walls * sizeof *walls);
    return walls;
}

/* Of two grains of these masses; a mean over equal ones is theirs. */
static double reduced(double a, double b)
{
    return a == b ? 0.5 * a : a * b / (a + b);
}

/* The same for each pair of kinds, of mean grains of both, or of all grains where a kind has none yet. */
static rp_status resolve_pairs(dem_definition *def, double mean)
{
    const size_t n = def->n_kinds, row = n * sizeof(dem_material);
    const dem_material *given = def->pairs;
    double *mass, *count;
    RP_SCOPE(arena);
    RP_NEW(&arena, mass, n);
    RP_NEW(&arena, count, n);
    for (size_t i = 0; i < def->n_grains; i++)
        mass[def->grains[i].kind] += def->grains[i].m, count[def->grains[i].kind] += 1.0;
    for (size_t a = 0; a < n; a++) mass[a] = count[a] > 0.0 ? mass[a] / count[a] : mean;
    dem_material *pairs = malloc(dem_pair_count(def) * sizeof *pairs);
    if (!pairs) return rp_fail(RP_NO_MEMORY, "kinds: out of memory");
    memcpy(pairs, given, dem_pair_count(def) * sizeof *pairs);
    def->pairs = pairs;
    for (size_t k = 0; k < dem_pair_count(def); k++) {
        const size_t a = k % n, b = k / n;
        if (b > n && memcmp(&given[b * n], &given[b * n - n], row) == 0) { /* as the sides of a polygon */
            pairs[k] = pairs[k - n];
            continue;
        }
        const double m_eff = b < n ? reduced(mass[a], mass[b]) : mass[a];
        RP_TRY(dem_pair_prefix(def, k, find_damping(def, m_eff, &pairs[k])));
        dem_material_complete(def, &pairs[k]);
    }
    return RP_OK;
}

rp_status dem_physics_resolve(dem_definition *def)
{
    if (def->n_walls > DEM_FEW_WALLS && !def->wall_list)
        return rp_fail(RP_BAD_INPUT, "%zu walls: more than %d need a list", def->n_walls, DEM_FEW_WALLS);
    RP_TRY(dem_kinds_check(def));
    bool asked = def->material.restitution > 0.0;
    for (size_t w = 0; w < def->n_walls; w++) asked |= dem_walls_of(def)[w].material.restitution > 0.0;
    for (size_t k = 0; def->pairs && k < dem_pair_count(def); k++) asked |= def->pairs[k].restitution > 0.0;
    if (!asked) return RP_OK;
    dem_wall *walls = own_walls(def);
    if (!walls) return rp_fail(RP_NO_MEMORY, "%zu walls: out of memory", def->n_walls);
    if (def->wall_list) def->wall_list = walls;
    double mass = def->n_grains > 0 ? 0.0 : def->mass_to_come;
    for (size_t i = 0; i < def->n_grains; i++) mass += def->grains[i].m / (double)def->n_grains;
    RP_TRY(find_damping(def, 0.5 * mass, &def->material));
    dem_material_complete(def, &def->material);
    dem_material given;
    for (size_t w = 0; w < def->n_walls; w++) {
        dem_material *m = &walls[w].material;
        if (w > 0 && memcmp(m, &given, sizeof given) == 0) { /* as the sides of a polygon */
            *m = walls[w - 1].material;
            continue;
        }
        given = *m;
        RP_TRY(rp_prefix(find_damping(def, mass, m), "wall %zu: ", w + 1));
        dem_material_complete(def, m);
    }
    return def->pairs ? resolve_pairs(def, mass) : RP_OK;
}

/* ---- Definitions ---- */

dem_definition dem_definition_default(void)
{
    dem_definition def = {
        .gravity = {0.0, -981.0},
        .implicit = {.relaxation = 0.7, .tolerance = 1e-15, .max_iterations = 1000},
        .restitution_speed = INFINITY,
        .x_min = -INFINITY,
        .x_max = INFINITY,
        .y_min = -INFINITY,
    };
    dem_physics physics = dem_physics_default(RP_CGS);
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

bool dem_has_rolling(const dem_definition *def)
{
    bool rolling = def->material.mu_roll > 0.0;
    for (size_t w = 0; w < def->n_walls; w++) rolling |= dem_walls_of(def)[w].material.mu_roll > 0.0;
    for (size_t k = 0; def->pairs && k < dem_pair_count(def); k++) rolling |= def->pairs[k].mu_roll > 0.0;
    return rolling;
}
