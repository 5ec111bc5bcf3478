/* Reading the grains of a scene file: those that it lists, those of a table and their contacts, and what it
 * fills. */
#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "core/elementary.h"
#include "core/file.h"
#include "dem/scene/file.h"
#include "table/columns.h"
#include "table/where.h"

static rp_status alloc_grains(dem_scene *scene, size_t n)
{
    scene->def.n_grains = n;
    RP_NEW(&scene->arena, scene->grains, n);
    RP_NEW(&scene->arena, scene->lines, n);
    return RP_OK;
}

/* Grain i of the list is there, with or without a mass. */
static rp_status add_grain(dem_scene *scene, size_t i, size_t line)
{
    const dem_physics *all = &scene->laws.physics;
    dem_grain *p = &scene->grains[i];
    scene->lines[i] = line;
    if (p->kind < DEM_MOST_MIXED) scene->has[p->kind] = true;
    if (p->m >= 0.0) return RP_OK;
    const double density = dem_density_of(scene, p->kind);
    p->m = dem_mass(all->shape, density, p->r);
    return dem_density_check(all->shape, scene->def.units, scene->has_density || density != all->density);
}

static rp_status read_particles(const config_setting_t *list, dem_scene *scene)
{
    if (!config_setting_is_list(list)) return rp_config_fail(list, "particles: a list ( { ... } ) expected");
    if (length(list) == 0) return rp_config_fail(list, "particles: no particles");
    RP_TRY(alloc_grains(scene, length(list)));
    for (size_t i = 0; i < length(list); i++) {
        dem_grain *p = &scene->grains[i];
        rp_params_defaults(SCHEMA(PARTICLES), scene->def.units, p);
        RP_TRY(dem_read_kind(element(list, i), scene, &p->kind));
        RP_TRY(rp_config_group(element(list, i), SCHEMA(PARTICLES), p, "kind"));
        RP_TRY(add_grain(scene, i, config_setting_source_line(element(list, i))));
    }
    return RP_OK;
}

/* A number; of a boolean also its word, as pandas spells it too. */
static rp_status read_cell(const rp_table *table, size_t row, int column, const rp_param *key, rp_units units,
                           dem_grain *p)
{
    const char *cell = rp_cell(table, row, column);
    const bool word = strcasecmp(cell, "true") == 0 || strcasecmp(cell, "false") == 0;
    rp_value v = {.kind = key->type == RP_BOOL ? RP_V_BOOL : RP_V_REAL};
    if (key->type != RP_BOOL || !word) RP_TRY(rp_table_number(table, row, column, 0, &v.r));
    if (key->type == RP_BOOL && !word && v.r != 0.0 && v.r != 1.0)
        return rp_fail(RP_BAD_INPUT, "%s:%zu: %s = %s: 0, 1, true or false expected", table->places[row].path,
                       table->places[row].line, key->name, cell);
    v.i = word ? tolower((unsigned char)*cell) == 't' : v.r != 0.0;
    return rp_prefix(rp_params_set(key, units, p, &v), "%s:%zu: ", table->places[row].path,
                     table->places[row].line);
}

/* The name of a kind by its number in a table of states, whose header has the names of all. */
static bool kind_named(const rp_table *table, double number, char name[DEM_NAME_BYTES])
{
    const char *names = rp_table_find_note(table, "kinds");
    for (; names && number > 1.0; number--) names = strchr(names, ' ') ? strchr(names, ' ') + 1 : NULL;
    return names && number == 1.0 && sscanf(names, "%31s", name) == 1;
}

/* A kind by its name, or its number in the table's header or in the scene. */
static rp_status read_kind(const rp_table *table, size_t row, int column, dem_scene *scene, uint32_t *kind)
{
    const char *cell = rp_cell(table, row, column);
    char name[DEM_NAME_BYTES];
    double number = 0.0;
    if (dem_is_name(cell)) return dem_number_kind(scene, cell, kind);
    RP_TRY(rp_table_number(table, row, column, false, &number));
    if (kind_named(table, number, name) && dem_is_name(name)) return dem_number_kind(scene, name, kind);
    *kind = number >= 0.0 && number < fmax((double)scene->def.n_kinds, 1.0) ? (uint32_t)number : 0;
    if ((double)*kind == number) return RP_OK;
    return rp_fail(RP_BAD_INPUT, "%s:%zu: kind = %s: the name of a kind expected, or its number in the scene",
                   table->places[row].path, table->places[row].line, cell);
}

static rp_status read_particles_table(const rp_table *table, dem_scene *scene)
{
    enum { N = 9 }; /* keys of a grain */
    const rp_param *keys = SCHEMA(PARTICLES);
    int columns[N], kind = rp_table_column(table, "kind");
    if (table->n_rows == 0) return rp_fail(RP_BAD_INPUT, "%s: no particles", table->path);
    if (!table->names[0]) return rp_table_nameless(table);
    for (int c = 0; c < N; c++) {
        const rp_status found =
            rp_table_find(table, keys[c].name, "x y r, and m vx vy angle omega fixed as needed", &columns[c]);
        if (found && !keys[c].fallback) return found;
    }
    RP_TRY(alloc_grains(scene, table->n_rows));
    for (size_t i = 0; i < table->n_rows; i++) {
        dem_grain *p = &scene->grains[i];
        rp_params_defaults(keys, scene->def.units, p);
        for (int c = 0; c < N; c++)
            if (columns[c] >= 0) RP_TRY(read_cell(table, i, columns[c], &keys[c], scene->def.units, p));
        if (kind >= 0) RP_TRY(read_kind(table, i, kind, scene, &p->kind));
        RP_TRY(add_grain(scene, i, table->places[i].line));
    }
    return RP_OK;
}

/* Of a table of states that holds a pile at several steps, the one that is wanted; -1: the last. */
static rp_status take_step(rp_table *table, long wanted)
{
    char condition[64];
    const int step = rp_table_column(table, "step");
    double number;
    if (wanted < 0 && (step < 0 || table->n_rows == 0)) return RP_OK;
    for (size_t i = 0; step >= 0 && i < table->n_rows; i++)
        RP_TRY(rp_table_number(table, i, step, false, &number));
    if (wanted < 0)
        snprintf(condition, sizeof condition, "step=%s", rp_cell(table, table->n_rows - 1, step));
    else
        snprintf(condition, sizeof condition, "step=%ld", wanted);
    RP_TRY(rp_table_where(table, condition));
    return table->n_rows ? RP_OK : rp_fail(RP_BAD_INPUT, "%s: no rows with %s", table->path, condition);
}

/* A name of a scene file, whose relative names are meant from its folder. */
static rp_status find_file(rp_arena *arena, const char *path, const char **name)
{
    const char *slash = strrchr(path, '/');
    const int folder = slash && **name != '/' ? (int)(slash - path) + 1 : 0;
    return rp_path(arena, name, "%.*s%s", folder, path, *name);
}

/* A table at one step. */
static rp_status read_step(rp_arena *arena, const char *name, long step, rp_units units, rp_table **table)
{
    RP_TRY(rp_table_keep(arena, name, NULL, table));
    for (size_t c = 0; c < (*table)->n_columns; c++) {
        char unit[32];
        rp_column_unit(*table, (int)c, unit);
        RP_TRY(rp_prefix(rp_unit_check(units, unit), "%s: column %zu: ", name, c + 1));
    }
    return take_step(*table, step);
}

static int by_number(const void *a, const void *b)
{
    const double *p = a, *q = b;
    return (*p > *q) - (*p < *q);
}

/* The contacts, with their springs, of grains that were read from rows of states; ids rise there. */
static rp_status read_contacts(rp_arena *arena, const rp_table *states, const rp_table *table,
                               dem_scene *scene)
{
    dem_definition *def = &scene->def;
    const size_t m = table->n_rows, n = states->n_rows;
    double *id, *v;
    dem_contact *c;
    RP_TRY(rp_columns_read(arena, states, "id", &id));
    RP_TRY(rp_columns_read(arena, table, "id_a,id_b,wall,x_b,y_b,overlap,shear_spring,rolling_spring", &v));
    RP_NEW(&scene->arena, c, m);
    def->contacts = c;
    for (size_t k = 0; k < m; k++, v++) {
        const double *a = bsearch(v, id, n, sizeof *id, by_number),
                     *b = v[m] > 0.0 ? bsearch(v + m, id, n, sizeof *id, by_number) : NULL;
        const bool wall = v[2 * m] >= 1.0 && v[2 * m] <= (double)def->n_walls;
        if (!a || a == b || (!b && !wall))
            return rp_fail(RP_BAD_INPUT,
                           "%s:%zu: id_a = %g, id_b = %g, wall = %g: no such grain or wall; take out the "
                           "rows of what is gone",
                           table->path, table->places[k].line, v[0], v[m], v[2 * m]);
        const dem_grain *p = &scene->grains[a - id], *q = &scene->grains[b ? b - id : 0];
        const dem_wall *w = b ? NULL : &dem_walls_of(def)[(size_t)v[2 * m] - 1];
        const double overlap = b ? p->r + q->r - rp_hypot(p->x - q->x, p->y - q->y)
                                 : p->r - rp_hypot(p->x - v[3 * m], p->y - v[4 * m]),
                     off = b ? 0.0
                             : (v[3 * m] - w->point[0]) * w->direction[0] +
                                   (v[4 * m] - w->point[1]) * w->direction[1];
        if (!(fabs(overlap - v[5 * m]) + fabs(off) <= 1e-6 * p->r))
            return rp_fail(RP_BAD_INPUT,
                           "%s:%zu: no contact of these grains and walls, which keep their numbers",
                           table->path, table->places[k].line);
        if (!(fabs(v[6 * m]) <= p->r && fabs(v[7 * m]) <= p->r))
            return rp_fail(RP_BAD_INPUT,
                           "%s:%zu: shear_spring = %g, rolling_spring = %g: at most the radius %g",
                           table->path, table->places[k].line, v[6 * m], v[7 * m], p->r);
        c[def->n_contacts++] = (dem_contact){.id_a = (uint32_t)(a - id) + 1,
                                             .id_b = b ? (uint32_t)(b - id) + 1 : 0,
                                             .wall = b ? -1 : (int)v[2 * m] - 1,
                                             .shear_spring = v[6 * m],
                                             .rolling_spring = v[7 * m]};
    }
    return RP_OK;
}

rp_status dem_read_table(const char *path, dem_scene *scene)
{
    const char *name = scene->particles_file, *beside = scene->contacts_file;
    rp_table *table, *contacts;
    char *text;
    RP_SCOPE(arena);
    RP_TRY(find_file(&arena, path, &name));
    const bool read = !rp_file_read(name, &text); /* else the reader of tables says what it is */
    if (text) rp_arena_keep(&arena, text, free);
    if (read && dem_is_lammps(text)) {
        if (*beside)
            return rp_fail(RP_BAD_INPUT, "%s: contacts_file: needs a table, no file of LAMMPS", path);
        RP_TRY(dem_read_lammps(&arena, name, text, scene));
        for (size_t i = 0; i < scene->def.n_grains; i++) RP_TRY(add_grain(scene, i, scene->lines[i]));
        return RP_OK;
    }
    RP_TRY(read_step(&arena, name, scene->particles_step, scene->def.units, &table));
    RP_TRY(read_particles_table(table, scene));
    rp_columns_beside(table, dem_state_columns, scene->unused);
    if (!*scene->contacts_file) return RP_OK;
    const int step = rp_table_column(table, "step");
    RP_TRY(find_file(&arena, path, &beside));
    RP_TRY(read_step(&arena, beside, step < 0 ? -1 : atol(rp_cell(table, 0, step)), scene->def.units,
                     &contacts));
    return read_contacts(&arena, table, contacts, scene);
}

const config_setting_t *dem_first_add(const config_setting_t *phases)
{
    const config_setting_t *add = NULL;
    for (size_t i = 0; phases && config_setting_is_list(phases) && i < length(phases) && !add; i++) {
        if (!config_setting_is_group(element(phases, i))) continue;
        add = member(element(phases, i), "add");
        if (!add) add = dem_first_add(member(element(phases, i), "phases"));
    }
    return add && config_setting_is_group(add) ? add : NULL;
}

rp_status dem_read_grains(const char *path, const config_setting_t *root, dem_scene *scene)
{
    const config_setting_t *list = member(root, "particles"), *fill = member(root, "fill");
    const bool from_table = *scene->particles_file != '\0';
    if (list && from_table)
        return rp_config_fail(member(root, "particles_file"), "particles and particles_file; keep one");
    if (!(list || fill || from_table || dem_first_add(member(root, "phases"))))
        return rp_fail(RP_BAD_INPUT, "%s: no grains: particles, particles_file or fill is needed", path);
    if (!from_table && (scene->particles_step >= 0 || *scene->contacts_file))
        return rp_fail(RP_BAD_INPUT, "%s: %s: needs particles_file", path,
                       *scene->contacts_file ? "contacts_file" : "particles_step");
    if (*scene->contacts_file && scene->def.ground.wall)
        return rp_fail(RP_BAD_INPUT, "%s: contacts_file: its table does not have the wells of a ground",
                       path);
    if (fill) RP_TRY(dem_read_fills(fill, scene));
    return list ? read_particles(list, scene) : from_table ? dem_read_table(path, scene) : RP_OK;
}
