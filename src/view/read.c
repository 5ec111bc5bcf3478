/* Frames of a run from its tables; see view.h. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "core/file.h"
#include "export/export.h"
#include "view/view.h"

/* Columns of a table. A name with a question mark may be missing; its values are then NaN. */
enum { MOST = 12 };
typedef struct {
    size_t n; /* rows */
    double *column[MOST];
    char unit[MOST][32];
    const char *kinds; /* names in its header */
} numbers;

/* A table without rows is empty, whatever its columns, and so is one that is not there, of path NULL. */
static rp_status read_numbers(rp_arena *arena, const char *path, const char *const names[],
                              const char *expected, numbers *out)
{
    RP_ENDS(rp_table_free) rp_table t = {0};
    *out = (numbers){0};
    if (path) RP_TRY(rp_table_read(path, &t));
    out->n = t.n_rows;
    const char *kinds = t.n_rows ? rp_table_find_note(&t, "kinds") : NULL;
    if (kinds) out->kinds = rp_text(arena, "%s", kinds);
    for (size_t k = 0; names[k] && t.n_rows > 0; k++) {
        const bool optional = *names[k] == '?';
        int column = rp_table_column(&t, names[k] + optional);
        double *values = out->column[k] = rp_arena_memory(arena, t.n_rows, sizeof *values);
        if (!optional) RP_TRY(rp_table_find(&t, names[k], expected, &column));
        strcpy(out->unit[k], "1");
        if (column >= 0) rp_column_unit(&t, column, out->unit[k]);
        for (size_t i = 0; i < t.n_rows; i++) {
            values[i] = NAN;
            if (column >= 0) RP_TRY(rp_table_number(&t, i, column, 1, &values[i]));
        }
    }
    return RP_OK;
}

/* Forces on the first grain: the normal one from b to a, the shear along the normal turned clockwise. */
static int by_force(const void *a, const void *b)
{
    const double f = fabs(((const view_contact *)a)->normal), g = fabs(((const view_contact *)b)->normal);
    return (f > g) - (f < g);
}

static rp_status read_contacts(rp_arena *arena, const char *grains, numbers *c, view_contact **contacts,
                               char unit[32])
{
    const char *path = export_beside(arena, grains, "contacts.tsv");
    static const char *const names[] = {"?step",        "x",     "y", "x_b", "y_b", "?normal_force", "?force",
                                        "?shear_force", "?wall", NULL};
    RP_TRY(read_numbers(arena, path, names, "x y x_b y_b, and normal_force or force", c));
    *contacts = rp_arena_memory(arena, c->n, sizeof **contacts);
    if (c->n == 0) return RP_OK;
    for (size_t k = 0; k < c->n; k++) {
        view_contact *v = &(*contacts)[k];
        const double normal = isnan(c->column[5][k]) ? c->column[6][k] : c->column[5][k],
                     shear = isnan(c->column[7][k]) ? 0.0 : c->column[7][k];
        *v = (view_contact){.normal = normal, .wall = c->column[8][k] > 0.0};
        v->c = (stress_contact){c->column[1][k], c->column[2][k], c->column[3][k], c->column[4][k]};
        const double lx = v->c.x - v->c.x_b, ly = v->c.y - v->c.y_b, l = hypot(lx, ly);
        if (!(l > 0.0) || !isfinite(normal + shear))
            return rp_fail(RP_BAD_INPUT, "%s: row %zu has no branch or no force", path, k + 1);
        v->c.fx = (normal * lx + shear * ly) / l;
        v->c.fy = (normal * ly - shear * lx) / l;
    }
    snprintf(unit, 32, "%s", strcmp(c->unit[5], "1") ? c->unit[5] : c->unit[6]);
    return RP_OK;
}

static rp_status read_walls(rp_arena *arena, const char *grains, numbers *w, view_wall **walls)
{
    const char *path = export_beside(arena, grains, "walls.tsv");
    static const char *const names[] = {"?step", "x", "y", "direction_x", "direction_y", "from", "to", NULL};
    RP_TRY(read_numbers(arena, path, names, "x y direction_x direction_y from to", w));
    *walls = rp_arena_memory(arena, w->n, sizeof **walls);
    for (size_t k = 0; k < w->n; k++)
        (*walls)[k] = (view_wall){w->column[1][k],
                                  w->column[2][k],
                                  {w->column[3][k], w->column[4][k]},
                                  {w->column[5][k], w->column[6][k]}};
    return RP_OK;
}

/* Times of grains alone: of the others this column is another, and is not read. */
static export_frames split(rp_arena *arena, const numbers *t)
{
    export_frames f = {.step = -1};
    export_split(arena, t->n, t->column[0], t->column[1], &f);
    if (t->n > 0 && !isnan(t->column[0][0])) f.step = 0;
    return f;
}

/* The rows of contacts or walls that belong to a frame of grains: those with its step, or all where the
 * grains have one frame only. Returns the number, and the first one. */
static size_t rows_of(const export_frames *f, double step, bool one, size_t *first)
{
    *first = 0;
    return one ? f->first[f->n] : f->step < 0 ? 0 : export_rows_at(f, step, first);
}

static rp_status add_source(rp_arena *arena, const char *path, const char *color, view_scene *scene)
{
    const char *names[] = {"?step", "?t", "x", "y", "r", "?fixed", *color ? color : NULL, NULL};
    const char *base = rp_ends_in(path, "disks.tsv") ? export_beside(arena, path, "base.tsv") : NULL;
    numbers g, c, w, b;
    view_contact *contacts;
    view_wall *walls;
    RP_TRY(read_numbers(arena, path, names, "x y r", &g));
    RP_TRY(read_contacts(arena, path, &c, &contacts, scene->force));
    RP_TRY(read_walls(arena, path, &w, &walls));
    RP_TRY(read_numbers(arena, base, (const char *const[]){"x", "N/mg", NULL}, "x N/mg", &b));
    if (g.n == 0) return RP_OK;
    const double *x = g.column[2], *y = g.column[3], *r = g.column[4], *value = g.column[6];
    for (size_t k = 0; k < g.n; k++)
        if (!(isfinite(x[k] + y[k]) && r[k] > 0.0 && isfinite(r[k])))
            return rp_fail(RP_BAD_INPUT, "%s: row %zu: x, y and a radius above 0 expected", path, k + 1);
    snprintf(scene->length, sizeof scene->length, "%s", g.unit[2]);
    snprintf(scene->time, sizeof scene->time, "%s", g.unit[1]);
    if (strcmp(color, "kind") == 0) scene->kinds = g.kinds;
    if (*color) snprintf(scene->quantity, sizeof scene->quantity, "%s", g.unit[6]);
    const export_frames grains = split(arena, &g), of_contacts = split(arena, &c),
                        of_walls = split(arena, &w);
    view_frame *frames = rp_arena_memory(arena, scene->n + grains.n, sizeof *frames);
    if (scene->n > 0) memcpy(frames, scene->frames, scene->n * sizeof *frames);
    for (size_t k = 0; k < grains.n; k++) {
        const size_t i = grains.first[k];
        size_t ci, wi;
        const size_t n_c = rows_of(&of_contacts, grains.steps[k], grains.n == 1, &ci),
                     n_w = rows_of(&of_walls, grains.steps[k], grains.n == 1, &wi);
        if (n_c > 0) qsort(contacts + ci, n_c, sizeof *contacts, by_force);
        frames[scene->n + k] = (view_frame){.step = grains.steps[k],
                                            .t = grains.times[k],
                                            .n = grains.first[k + 1] - i,
                                            .x = x + i,
                                            .y = y + i,
                                            .r = r + i,
                                            .fixed = g.column[5] + i,
                                            .value = value ? value + i : NULL,
                                            .n_contacts = n_c,
                                            .contacts = contacts + ci,
                                            .n_walls = n_w,
                                            .walls = walls + wi,
                                            .n_base = b.n,
                                            .base_x = b.column[0],
                                            .base_force = b.column[1]};
    }
    scene->frames = frames;
    scene->n += grains.n;
    return RP_OK;
}

static int by_step(const void *a, const void *b)
{
    const double f = ((const view_frame *)a)->step, g = ((const view_frame *)b)->step;
    return (f > g) - (f < g);
}

static bool is_stage(const char *name)
{
    return rp_ends_in(name, "_grains.tsv");
}

/* The tables of a folder: of a scene, of a static pile, or of each stage of a sweep's run. */
static rp_status read_folder(rp_arena *arena, const char *path, const char *color, view_scene *scene)
{
    static const char *const whole[] = {"states.tsv", "disks.tsv"};
    for (size_t k = 0; k < sizeof whole / sizeof *whole; k++)
        if (rp_is_in(path, whole[k]))
            return add_source(arena, rp_text(arena, "%s/%s", path, whole[k]), color, scene);
    rp_paths stages = {0};
    rp_status status = rp_paths_in(&stages, path, is_stage);
    for (size_t k = 0; k < stages.n && !status; k++) status = add_source(arena, stages.path[k], color, scene);
    rp_paths_free(&stages);
    if (scene->n > 0) qsort(scene->frames, scene->n, sizeof *scene->frames, by_step);
    return status;
}

rp_status view_read(rp_arena *arena, const char *path, const char *color, view_scene *scene)
{
    struct stat info;
    *scene = (view_scene){.length = "1", .force = "1", .time = "1", .quantity = "1"};
    const bool folder = stat(path, &info) == 0 && S_ISDIR(info.st_mode);
    RP_TRY((folder ? read_folder : add_source)(arena, path, color, scene));
    if (scene->n > 0) return RP_OK;
    return folder ? rp_fail(RP_BAD_INPUT,
                            "%s: no rows in a states.tsv, disks.tsv or ..._grains.tsv; of a sweep -x and -y "
                            "draw points",
                            path)
                  : rp_fail(RP_BAD_INPUT, "%s: no rows", path);
}
