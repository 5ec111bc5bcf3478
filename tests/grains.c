/* Small scenes shared by several test files; see grains.h. */
#include "tests/grains.h"

#include <stddef.h>

#include "dem/state/state.h"
#include "tests/folder.h"

dem_wall grains_line(double x, double y, double nx, double ny, const dem_material *c)
{
    return (dem_wall){.point = {x, y},
                      .direction = {nx, ny},
                      .material = *c,
                      .extent = {-INFINITY, INFINITY},
                      .open_at_step = -1,
                      .open_speed = INFINITY};
}

dem_definition grains_of(size_t n, const dem_grain *grains)
{
    dem_definition def = dem_definition_default();
    def.grains = grains, def.n_grains = n;
    return def;
}

dem_definition grains_afloat(size_t n, const dem_grain *grains)
{
    dem_definition def = grains_of(n, grains);
    def.gravity[1] = 0.0;
    return def;
}

dem_definition grains_bare(size_t n, const dem_grain *grains, dem_normal_law law, dem_material material)
{
    dem_definition def = grains_afloat(n, grains);
    def.normal = law, def.tangential = DEM_NONE, def.material = material;
    return def;
}

void grains_run(dem_sim *sim, long steps, dem_state *states)
{
    CHECK_OK(dem_run(sim, steps));
    CHECK_OK(dem_states(sim, states));
}

dem_state *grains_states(const dem_sim *sim)
{
    dem_state *states = calloc(dem_count(sim), sizeof *states);
    CHECK_OK(dem_states(sim, states));
    return states;
}

void grains_on_floor(dem_definition *def, size_t n, const dem_grain *grains)
{
    def->grains = grains;
    def->n_grains = n;
    def->n_walls = 1;
    def->walls[0] = grains_line(0.0, 0.0, 0.0, 1.0, &def->material);
}

dem_definition grains_floored(size_t n, const dem_grain *grains)
{
    dem_definition def = dem_definition_default();
    grains_on_floor(&def, n, grains);
    return def;
}

dem_definition grains_disks(size_t n, const dem_grain *grains, double k)
{
    dem_definition def = grains_bare(n, grains, DEM_LINEAR, (dem_material){.k_n = k});
    def.integrator = DEM_IMPLICIT, def.gravity[1] = -1.0, def.shape = DEM_DISK;
    return def;
}

void grains_law(dem_definition *def, dem_normal_law law, double stiffness, double rate)
{
    const dem_normal_descriptor *d = &dem_normal_descriptors[law];
    const double overlap = 0.01, m_eff = 0.002;
    def->normal = law;
    def->material.k_n = stiffness / d->stiffness(1.0, overlap);
    def->material.gamma_n = rate / d->damping_rate(def->material.k_n, 1.0, m_eff, overlap);
}

void grains_gas(size_t n, dem_grain *grains)
{
    for (int i = 0; i < (int)n; i++)
        grains[i] = (dem_grain){.x = 0.62 + 1.17 * (i % 3) + 0.05 * (i / 3),
                                .y = 0.56 + 1.11 * (i / 3),
                                .r = 0.5 - 0.013 * i,
                                .m = 1.0 - 0.07 * i,
                                .vx = 0.385 * (i % 2 ? 1.0 : -0.7),
                                .vy = 0.21 * (i - 2)};
}

dem_definition grains_box(long N, double W, long run, dem_grain **grains)
{
    dem_fill fill = {N, W, 2.5 * (double)N * 0.04 / W, 0.1, 0.02, 0.07, 0.13, 1.0, DEM_SPHERE, 7, run};
    dem_definition def = dem_definition_default();
    static rp_arena kept;
    dem_grain *made = rp_arena_memory(&kept, (size_t)N, sizeof *made);
    CHECK_OK(dem_fill_grains(&fill, made, &(size_t){0}));
    def.grains = made, def.n_grains = (size_t)N;
    if (grains) *grains = made;
    dem_material wall = def.material;
    wall.k_n *= 2.0;
    dem_box_walls(&def, W, &wall);
    return def;
}

dem_definition grains_outflow(long N, long part, bool rotation)
{
    dem_grain *made;
    dem_definition def = grains_box(N, 4.0, 9, &made);
    for (long i = 0; i < N; i += 50) made[i].fixed = true;
    def.walls[DEM_BOX_RIGHT].open_at_step = 2 * part;
    def.walls[DEM_BOX_FLOOR].open_at_step = 3 * part, def.x_max = 8.0, def.y_min = -0.5;
    def.rotation = rotation;
    def.material.mu_roll = rotation ? 0.1 : 0.0;
    return def;
}

dem_definition grains_too_soft(bool floor)
{
    dem_definition def = grains_box(1200, 6.0, 9, NULL);
    *(floor ? &def.walls[DEM_BOX_FLOOR].material.k_n : &def.material.k_n) = 1e3;
    def.material.gamma_n = def.walls[DEM_BOX_FLOOR].material.gamma_n = 100.0;
    return def;
}

void grains_break_alike(dem_sim *a, dem_sim *b)
{
    CU_ASSERT(dem_run(a, 100000) == RP_BROKEN);
    const char *text = check_text("%s", rp_message());
    CHECK_FAILS(dem_run(b, 100000), RP_BROKEN, text);
    CU_ASSERT(dem_step(a) == dem_step(b) && dem_sim_fault(a) == dem_sim_fault(b));
}

dem_sim *grains_start(const dem_definition *def)
{
    dem_sim *sim = NULL;
    CHECK_OK(dem_create(def, &sim));
    CU_ASSERT_PTR_NOT_NULL_FATAL(sim);
    return sim;
}

void grains_end(dem_sim **sim)
{
    dem_free(*sim);
}

dem_sim *grains_after(const dem_definition *def, long steps)
{
    dem_sim *sim = grains_start(def);
    CHECK_OK(dem_run(sim, steps));
    return sim;
}

dem_sim *grains_of_text(long steps, const char *text)
{
    scoped_scene scene = {0};
    return grains_scene_after(text, steps, &scene);
}

dem_sim *grains_kept(dem_sim *sim)
{
    RP_ENDS(rp_snapshot_free) rp_snapshot s = {0};
    dem_sim *copy = sim;
    dem_keep(&s, &copy);
    CHECK_OK(s.status);
    s.reading = true, s.path = "memory";
    dem_keep(&s, &copy);
    CHECK_OK(rp_snapshot_end(&s));
    CU_ASSERT_PTR_NOT_NULL_FATAL(copy);
    return copy;
}

dem_counts grains_counts(const dem_sim *sim)
{
    dem_counts counts;
    dem_count_work(sim, &counts);
    return counts;
}

dem_ledger grains_ledger(const dem_sim *sim)
{
    dem_ledger ledger = {0};
    CU_ASSERT_FATAL(dem_ledger_read(sim, &ledger));
    return ledger;
}

dem_contact *grains_contacts(const dem_sim *sim, size_t *n)
{
    dem_contact *list = NULL;
    CHECK_OK(dem_contacts(sim, &list, n));
    return list;
}

void grains_again(dem_sim **sim, const dem_definition *def, long steps)
{
    dem_free(*sim);
    *sim = grains_after(def, steps);
}

dem_sim *grains_start_in_chunks(const dem_definition *def, size_t chunk)
{
    dem_sim *sim = grains_start(def);
    if (chunk > 0) sim->pairs.chunk = chunk;
    CHECK_OK(dem_neighbours_rebuild(sim));
    return sim;
}

dem_state grains_state_of_one(const dem_sim *sim)
{
    dem_state s;
    CU_ASSERT_FATAL(dem_count(sim) == 1);
    CHECK_OK(dem_states(sim, &s));
    return s;
}

dem_contact grains_only_contact(const dem_sim *sim)
{
    size_t n;
    scoped dem_contact *list = grains_contacts(sim, &n);
    CU_ASSERT_FATAL(n == 1);
    return *list;
}

void grains_wall_forces(const dem_sim *sim, double *forces)
{
    for (size_t w = 0; w < dem_wall_count(sim); w++)
        memcpy(&forces[2 * w], dem_wall_now(sim, w).force, 2 * sizeof *forces);
}

dem_energy grains_energies(const dem_sim *sim)
{
    dem_energy energy;
    dem_energies(sim, &energy);
    return energy;
}

double grains_energy(const dem_sim *sim)
{
    const dem_energy e = grains_energies(sim);
    return e.kinetic + e.rotational + e.elastic + e.gravity;
}

size_t grains_wrong_pairs(const dem_sim *sim)
{
    const dem_grains *g = &sim->grains;
    scoped unsigned char *listed = calloc(g->n, g->n);
    size_t wrong = 0;
    CU_ASSERT_PTR_NOT_NULL_FATAL(listed);
    for (size_t k = 0; k < sim->pairs.n; k++) {
        const size_t i = sim->pairs.i[k], j = sim->pairs.j[k];
        if (i != j) listed[(i < j ? i : j) * g->n + (i < j ? j : i)]++; /* else of a removed grain */
    }
    for (size_t i = 0; i < g->n; i++)
        for (size_t j = i + 1; j < g->n; j++) {
            const dem_vec d = g->listed_x[i] - g->listed_x[j];
            const double reach = g->cutoff[i] + g->cutoff[j];
            const bool near = dem_dot(d, d) < reach * reach && g->inverse_mass[i] + g->inverse_mass[j] > 0.0;
            wrong += listed[i * g->n + j] != near;
        }
    return wrong;
}

bool grains_same_bits(const dem_sim *a, const dem_sim *b)
{
    const size_t n = dem_count(a), from = offsetof(dem_state, x), to = offsetof(dem_state, contacts);
    if (n != dem_count(b)) return false;
    scoped dem_state *s = calloc(2 * n + 1, sizeof *s);
    dem_state *t = s + n;
    dem_states(a, s);
    dem_states(b, t);
    bool same = true;
    for (size_t i = 0; i < n; i++) /* all but the padding */
        same &= s[i].id == t[i].id && s[i].contacts == t[i].contacts && s[i].fixed == t[i].fixed &&
                memcmp((const char *)&s[i] + from, (const char *)&t[i] + from, to - from) == 0;
    return same;
}

rp_status grains_read(const char *text, const rp_texts *changes, dem_scene *scene)
{
    char folder[FOLDER_PATH];
    folder_make("scene", folder);
    const char *path = folder_path(folder, "s.cfg");
    file_text(path, text);
    const rp_status status = dem_scene_read(path, changes, scene);
    folder_remove(folder);
    return status;
}

dem_sim *grains_scene_after(const char *text, long steps, dem_scene *scene)
{
    dem_sim *sim = NULL;
    CHECK_OK(grains_read(text, NULL, scene));
    CHECK_OK(dem_scene_start(scene, &sim));
    CU_ASSERT_PTR_NOT_NULL_FATAL(sim);
    if (steps > 0) CHECK_OK(dem_run(sim, steps));
    return sim;
}

void grains_refused(const char *text, const rp_texts *changes, const char *message)
{
    scoped_scene scene = {0};
    CHECK_FAILS(grains_read(text, changes, &scene), RP_BAD_INPUT, message);
}
