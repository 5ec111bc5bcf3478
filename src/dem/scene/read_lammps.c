/* Grains of a LAMMPS dump (`dump custom`) or data file (`Atoms # sphere`), in the order of their ids: files
 * have them in any order, and with gaps. A centre that a periodic boundary has moved stays in the box. Grains
 * must lie in one plane across z: a cut through a packing of spheres has other radii and contacts. */
#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dem/scene/file.h"
#include "table/columns.h"

typedef struct {
    double id;
    size_t row;
} ranked;

/* Rows below a line of the file, and the names of their columns. */
typedef struct {
    const char *names, *rows; /* NULL: not there */
    size_t n_names, n_rows;   /* characters */
    size_t line;
    double atoms, step, box[3][2]; /* atoms: as the file announces */
    bool tilted;
    rp_table *table;
    ranked *order; /* of its rows by their ids */
} part;

typedef struct {
    const char *path;
    char *at;    /* the line that is read next */
    size_t line; /* number of the last one */
    part atoms, velocities;
} reader;

static bool begins(const char *line, const char *with)
{
    return strncmp(line, with, strlen(with)) == 0;
}

static char *next_line(reader *r)
{
    char *line = r->at, *end = strchr(line, '\n');
    r->at = end ? end + 1 : line + strlen(line);
    r->line++;
    return line;
}

static rp_status next_numbers(reader *r, int n, double numbers[])
{
    char *at = next_line(r), *end;
    for (int k = 0; k < n; k++, at = end) {
        numbers[k] = strtod(at, &end);
        if (end == at || end > r->at || !isfinite(numbers[k]))
            return rp_fail(RP_BAD_INPUT, "%s:%zu: %s expected", r->path, r->line,
                           n > 1 ? "two ends of the box" : "a number");
    }
    return RP_OK;
}

static part *end_part(part *p, const char *end)
{
    if (p) p->n_rows = (size_t)(end - p->rows);
    return NULL;
}

static part *begin_part(const reader *r, part *p, const char *names)
{
    p->names = names, p->n_names = strcspn(names, "\r\n");
    p->rows = r->at, p->line = r->line;
    return p;
}

/* The frame of a step; of -1 the last. */
static rp_status find_frame(reader *r, long wanted)
{
    part frame = {0}, *in = NULL;
    while (*r->at) {
        char *line = next_line(r);
        if (!begins(line, "ITEM:")) continue;
        in = end_part(in, line);
        if (begins(line, "ITEM: TIMESTEP")) RP_TRY(next_numbers(r, 1, &frame.step));
        if (begins(line, "ITEM: NUMBER OF ATOMS")) RP_TRY(next_numbers(r, 1, &frame.atoms));
        if (begins(line, "ITEM: BOX BOUNDS")) {
            frame.tilted = begins(line, "ITEM: BOX BOUNDS xy") || begins(line, "ITEM: BOX BOUNDS abc");
            for (int k = 0; k < 3; k++) RP_TRY(next_numbers(r, 2, frame.box[k]));
        }
        if (!begins(line, "ITEM: ATOMS ") || (wanted >= 0 && frame.step != (double)wanted)) continue;
        r->atoms = frame;
        in = begin_part(r, &r->atoms, line + strlen("ITEM: ATOMS "));
    }
    end_part(in, r->at);
    if (r->atoms.rows) return RP_OK;
    return rp_fail(RP_BAD_INPUT, wanted < 0 ? "%s: no line ITEM: ATOMS" : "%s: no frame of step %ld", r->path,
                   wanted);
}

/* The sections of a data file, whose first line is a comment. */
static rp_status find_sections(reader *r)
{
    static const char flags[] = " nx ny nz";
    part *in = NULL;
    char *end;
    for (next_line(r); *r->at;) {
        char *line = next_line(r), *style = strpbrk(line, "#\n");
        const double number = strtod(line, &end);
        if (end > line && begins(end + strspn(end, " \t"), "atoms")) r->atoms.atoms = number;
        if (!isalpha((unsigned char)*line)) continue;
        in = end_part(in, line);
        if (begins(line, "Velocities"))
            in = begin_part(r, &r->velocities, "id vx vy vz omegax omegay omegaz");
        if (!begins(line, "Atoms")) continue;
        if (style && *style == '#' && !begins(style, "# sphere"))
            return rp_fail(RP_BAD_INPUT, "%s:%zu: \"Atoms # sphere\" expected, which has diameters", r->path,
                           r->line);
        in = begin_part(r, &r->atoms, "id type diameter density x y z nx ny nz");
        size_t cells = 0; /* of the first row, which may end before nx */
        for (const char *c = r->at + strspn(r->at, " \t\r\n"); *c && !strchr("\r\n", *c);
             c += strspn(c, " \t"))
            c += strcspn(c, " \t\r\n"), cells++;
        if (cells == 7) in->n_names -= strlen(flags);
    }
    end_part(in, r->at);
    return RP_OK;
}

static int by_id(const void *a, const void *b)
{
    const double p = ((const ranked *)a)->id, q = ((const ranked *)b)->id;
    return (p > q) - (p < q);
}

/* The part as a table, whose rows have the numbers of the file's lines. */
static rp_status make_table(rp_arena *arena, const char *path, part *p)
{
    const size_t above = p->line - 1;
    char *text = malloc(above + p->n_names + p->n_rows + 2);
    int id;
    if (!text) return rp_fail(RP_NO_MEMORY, "%s: out of memory", path);
    memset(text, '\n', above);
    memcpy(text + above, p->names, p->n_names);
    text[above + p->n_names] = '\n';
    memcpy(text + above + p->n_names + 1, p->rows, p->n_rows);
    text[above + p->n_names + 1 + p->n_rows] = '\0';
    for (char *c = text; (c = strchr(c, ' '));) *c = '\t';
    RP_TRY(rp_table_keep(arena, path, text, &p->table));
    const rp_table *t = p->table;
    if (t->n_rows == 0) return rp_fail(RP_BAD_INPUT, "%s:%zu: no rows below", path, p->line);
    RP_TRY(rp_table_find(t, "id", NULL, &id));
    RP_NEW(arena, p->order, t->n_rows);
    for (size_t i = 0; i < t->n_rows; i++) {
        p->order[i].row = i;
        RP_TRY(rp_table_number(t, i, id, false, &p->order[i].id));
    }
    qsort(p->order, t->n_rows, sizeof *p->order, by_id);
    for (size_t i = 1; i < t->n_rows; i++)
        if (p->order[i].id == p->order[i - 1].id)
            return rp_fail(RP_BAD_INPUT, "%s:%zu: a second row has the id %.17g",
                           RP_PLACE(t, p->order[i].row), p->order[i].id);
    return RP_OK;
}

/* Keys of a grain, and the columns that give them, of which the first that is there counts. */
static const char *const columns[][2] = {
    {"x", "x xu xs xsu"}, {"y", "y yu ys ysu"},  {"r", "radius diameter"},
    {"z", "z zu zs zsu"}, {"m", "mass density"}, {"vx", "vx"},
    {"vy", "vy"},         {"omega", "omegaz"},   {"angle", "angle"},
    {"fixed", "fixed"},   {"kind", "type"}};
enum { REQUIRED = 3, N_COLUMNS = sizeof columns / sizeof *columns };

/* A coordinate from that in the box, a radius, a mass as LAMMPS makes it of a density, in a plane too. */
static double translated(const part *p, const char *name, double v, double r)
{
    if (strcmp(name, "diameter") == 0) return 0.5 * v;
    if (strcmp(name, "density") == 0) return dem_mass(DEM_SPHERE, v, r);
    if (name[1] != 's') return v;
    const double *box = p->box[*name - 'x'];
    return box[0] + v * (box[1] - box[0]);
}

/* A type, which is the number of a kind if the scene has some; or z. */
static rp_status take_other(const char *name, double v, double first, dem_grain *grain, dem_scene *scene)
{
    const size_t n = scene->def.n_kinds;
    if (*name == 'z' && !(fabs(v - first) <= 1e-3 * grain->r))
        return rp_fail(
            RP_BAD_INPUT,
            "%s = %g, of the first grain %g: grains in one plane expected; a cut through a packing has "
            "other radii and contacts",
            name, v, first);
    if (*name == 'z' || n < 2) return RP_OK;
    if (!(v >= 1.0 && v < (double)n && v == floor(v)))
        return rp_fail(RP_BAD_INPUT, "type = %g: a number from 1 to %zu expected, as of the scene's kinds", v,
                       n - 1);
    return dem_number_kind(scene, scene->def.kinds[(size_t)v].name, &grain->kind);
}

/* One column, for the grains in the order of `atoms`; key NULL: no key of a grain. */
static rp_status take_column(const part *p, int column, const rp_param *key, const part *atoms,
                             dem_scene *scene)
{
    const rp_table *t = p->table;
    const char *name = t->names[column];
    const size_t n = scene->def.n_grains;
    double first = NAN;
    if (name[1] == 's' && p->tilted)
        return rp_fail(RP_BAD_INPUT, "%s:%zu: %s of a tilted box; %c expected", t->path, p->line, name,
                       *name);
    for (size_t k = 0, i = 0; k < t->n_rows; k++) {
        const size_t row = p->order[k].row;
        rp_value v = {.kind = key && key->type == RP_BOOL ? RP_V_BOOL : RP_V_REAL};
        while (i < n && atoms->order[i].id < p->order[k].id) i++;
        if (i == n || atoms->order[i].id != p->order[k].id)
            return rp_fail(RP_BAD_INPUT, "%s:%zu: no atom has the id %.17g", RP_PLACE(t, row),
                           p->order[k].id);
        dem_grain *grain = &scene->grains[i];
        RP_TRY(rp_table_number(t, row, column, false, &v.r));
        v.r = translated(p, name, v.r, grain->r);
        v.i = v.r != 0.0;
        if (k == 0) first = v.r;
        RP_TRY(rp_prefix(key ? rp_params_set(key, scene->def.units, grain, &v)
                             : take_other(name, v.r, first, grain, scene),
                         "%s:%zu: ", RP_PLACE(t, row)));
    }
    return RP_OK;
}

static rp_status take_columns(const part *p, const part *atoms, dem_scene *scene)
{
    for (int c = 0; c < N_COLUMNS; c++) {
        int column = -1, best = -1;
        for (int i = 0; i < (int)p->table->n_columns; i++) {
            const int k = rp_word_index(columns[c][1], p->table->names[i]);
            if (k >= 0 && (column < 0 || k < best)) best = k, column = i;
        }
        if (column < 0 && c < REQUIRED && p == atoms)
            return rp_table_find(p->table, c == 2 ? "radius" : columns[c][0],
                                 "id type x y z radius mass vx vy omegaz", &column);
        if (column >= 0)
            RP_TRY(take_column(p, column, rp_params_find(SCHEMA(PARTICLES), columns[c][0]), atoms, scene));
    }
    return RP_OK;
}

bool dem_is_lammps(const char *text)
{
    const char *atoms = strstr(text, "\nAtoms");
    return begins(text, "ITEM:") || (atoms && strchr(" \t\r\n#", atoms[6]));
}

rp_status dem_read_lammps(rp_arena *arena, const char *path, char *text, dem_scene *scene)
{
    reader r = {.path = path, .at = text};
    part *atoms = &r.atoms;
    const bool dump = begins(text, "ITEM:");
    if (!dump && scene->particles_step >= 0)
        return rp_fail(RP_BAD_INPUT, "%s: particles_step: a data file has no steps", path);
    RP_TRY(dump ? find_frame(&r, scene->particles_step) : find_sections(&r));
    RP_TRY(make_table(arena, path, atoms));
    const size_t n = scene->def.n_grains = atoms->table->n_rows;
    if (atoms->atoms != (double)n)
        return rp_fail(RP_BAD_INPUT, "%s:%zu: %zu rows below, for %g atoms", path, atoms->line, n,
                       atoms->atoms);
    RP_NEW(&scene->arena, scene->grains, n);
    RP_NEW(&scene->arena, scene->lines, n);
    for (size_t i = 0; i < n; i++) {
        rp_params_defaults(SCHEMA(PARTICLES), scene->def.units, &scene->grains[i]);
        scene->lines[i] = atoms->table->places[atoms->order[i].row].line;
    }
    RP_TRY(take_columns(atoms, atoms, scene));
    if (!r.velocities.rows) return RP_OK;
    RP_TRY(make_table(arena, path, &r.velocities));
    return take_columns(&r.velocities, atoms, scene);
}
