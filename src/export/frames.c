/* Frames of an export; see export.h. */
#include "export/export.h"

#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/file.h"

const char *export_stem(rp_arena *arena, const char *path)
{
    char *stem = rp_text(arena, "%s", path);
    char *name = strrchr(stem, '/'), *dot = strrchr(name ? name : stem, '.');
    if (dot) *dot = '\0';
    return stem;
}

char *export_word(char *text)
{
    for (char *c = text; *c; c++)
        if (!isalnum((unsigned char)*c) && !(*c & 0x80) && !strchr("._+-/()[]", *c)) *c = '_';
    return text;
}

const char *export_cell(const rp_table *t, size_t row, int column)
{
    const char *text = rp_cell(t, row, column);
    return strcmp(text, "infinite") == 0 ? "inf" : text;
}

/* ---- frames of a run ---- */

void export_split(rp_arena *arena, size_t n, const double step[], const double t[], export_frames *f)
{
    f->first = rp_arena_memory(arena, n + 1, sizeof *f->first);
    f->steps = rp_arena_memory(arena, n, sizeof *f->steps);
    f->times = rp_arena_memory(arena, n, sizeof *f->times);
    for (size_t i = 0; i < n; i++) {
        if (i > 0 && (step[i] == step[i - 1] || isnan(step[i]))) continue;
        f->steps[f->n] = step[i], f->times[f->n] = t[i];
        f->first[f->n++] = i;
    }
    f->first[f->n] = n;
}

size_t export_rows_at(const export_frames *f, double step, size_t *first)
{
    size_t k = 0;
    while (k < f->n && f->step >= 0 && f->steps[k] != step) k++;
    *first = k < f->n ? f->first[k] : 0;
    return k < f->n ? f->first[k + 1] - *first : 0;
}

/* Every cell of a frame's table is a number, and steps rise. */
static rp_status find_frames(rp_arena *arena, rp_table *table, export_frames *f)
{
    double *step = rp_arena_memory(arena, 2 * table->n_rows, sizeof *step), *t = step + table->n_rows, unused;
    *f = (export_frames){
        .table = table, .step = rp_table_column(table, "step"), .t = rp_table_column(table, "t")};
    for (size_t i = 0; i < table->n_rows; i++) {
        for (size_t c = 0; c < table->n_columns; c++)
            if (!rp_text_number(export_cell(table, i, (int)c), &unused))
                RP_TRY(rp_table_number(table, i, (int)c, true, &unused));
        t[i] = f->t < 0 ? NAN : strtod(rp_cell(table, i, f->t), NULL);
        if (f->step >= 0) RP_TRY(rp_table_number(table, i, f->step, false, &step[i]));
    }
    export_split(arena, table->n_rows, step, t, f);
    for (size_t k = 1; k < f->n; k++)
        if (f->steps[k] < f->steps[k - 1])
            return rp_fail(RP_BAD_INPUT, "%s:%zu: step %.0f after step %.0f", RP_PLACE(table, f->first[k]),
                           f->steps[k], f->steps[k - 1]);
    return RP_OK;
}

double export_frame_step(const export_run *run, size_t frame)
{
    const export_frames *f = &run->grains;
    return f->step < 0 ? (double)frame : f->steps[frame];
}

double export_frame_time(const export_run *run, size_t frame)
{
    const export_frames *f = &run->grains;
    return f->t < 0 ? export_frame_step(run, frame) : f->times[frame];
}

void export_frame_id(const export_run *run, size_t frame, size_t row, FILE *out)
{
    const export_frames *f = &run->grains;
    if (run->id < 0)
        fprintf(out, "%zu", row - f->first[frame] + 1);
    else
        fprintf(out, "%.0f", strtod(rp_cell(f->table, row, run->id), NULL));
}

/* Names in other programs; any other column keeps its own. */
static const struct {
    const char *columns[2], *dump, *vtk;
} known[] = {{{"r"}, "radius", "radius"},
             {{"m"}, "mass", "mass"},
             {{"vx", "vy"}, "vx vy vz", "velocity"},
             {{"fx", "fy"}, "fx fy fz", "force"},
             {{"omega"}, "omegaz", "omega"}};

/* Add column c, unless it has a place of its own, or the vector that it belongs to is there already. */
static rp_status add_field(export_run *run, int c)
{
    static const char *const placed[] = {"step", "t", "id", "x", "y"};
    const rp_table *t = run->grains.table;
    const char *name = t->names[c];
    export_field field = {{c, -1}, name, name};
    for (size_t i = 0; i < sizeof placed / sizeof *placed; i++)
        if (strcmp(name, placed[i]) == 0) return RP_OK;
    for (size_t i = 0; i < sizeof known / sizeof *known; i++) {
        const bool vector = known[i].columns[1];
        const int first = rp_table_column(t, known[i].columns[0]),
                  second = vector ? rp_table_column(t, known[i].columns[1]) : -1;
        if ((first != c && second != c) || (vector && (first < 0 || second < 0))) continue;
        for (size_t f = 0; f < run->n_fields; f++)
            if (run->fields[f].column[0] == first) return RP_OK;
        field = (export_field){{first, second}, known[i].dump, known[i].vtk};
    }
    if (run->n_fields == EXPORT_MOST_FIELDS)
        return rp_fail(RP_BAD_INPUT, "%s: more than %d columns", t->path, EXPORT_MOST_FIELDS);
    run->fields[run->n_fields++] = field;
    return RP_OK;
}

static rp_status find_grains(rp_arena *arena, export_run *run, const char *names)
{
    const rp_table *t = run->grains.table;
    int *columns;
    size_t n;
    RP_TRY(rp_table_find(t, "x", "x", &run->x));
    RP_TRY(rp_table_find(t, "y", "y", &run->y));
    RP_TRY(rp_table_find(t, "r", "r", &run->r));
    run->id = rp_table_column(t, "id");
    run->kind = rp_table_column(t, "kind");
    RP_TRY(rp_columns(arena, t, names, &n, &columns));
    RP_TRY(add_field(run, run->r));
    for (size_t c = 0; c < n; c++)
        if (columns[c] != run->r) RP_TRY(add_field(run, columns[c]));
    run->box[0][0] = run->box[1][0] = INFINITY, run->box[0][1] = run->box[1][1] = -INFINITY;
    for (size_t i = 0; i < t->n_rows; i++) {
        double v[3];
        const int own[3] = {run->x, run->y, run->r};
        for (int k = 0; k < 3; k++) RP_TRY(rp_table_number(t, i, own[k], false, &v[k]));
        for (int k = 0; k < 2; k++) {
            run->box[k][0] = fmin(run->box[k][0], v[k] - v[2]);
            run->box[k][1] = fmax(run->box[k][1], v[k] + v[2]);
        }
        run->largest = fmax(run->largest, v[2]);
        if (run->kind >= 0) run->first_type |= atol(rp_cell(t, i, run->kind)) == 0;
    }
    return RP_OK;
}

const char *export_beside(rp_arena *arena, const char *grains, const char *name)
{
    static const char *const ends[] = {"states.tsv", "grains.tsv", "disks.tsv"};
    const char *path = NULL;
    for (size_t k = 0; k < sizeof ends / sizeof *ends && !path; k++)
        if (rp_ends_in(grains, ends[k]))
            path = rp_text(arena, "%.*s%s", (int)(strlen(grains) - strlen(ends[k])), grains, name);
    return path && rp_is_there(path) ? path : NULL;
}

/* The table beside that of the grains in the folder of a run, or of a stage. */
static rp_status read_beside(rp_arena *arena, const char *source, const char *name, export_frames *frames)
{
    const bool run = rp_is_in(source, "states.tsv"), stage = rp_ends_in(source, "grains.tsv");
    const char *grains = run ? rp_text(arena, "%s/states.tsv", source) : source,
               *path = run || stage ? export_beside(arena, grains, name) : NULL;
    rp_table *table;
    if (!path) return RP_OK;
    RP_TRY(rp_table_load(arena, path, &table));
    RP_TRY(find_frames(arena, table, frames));
    if (frames->step < 0 && table->n_rows > 0)
        return rp_fail(RP_BAD_INPUT, "%s: no column \"step\": from an older version?", path);
    return RP_OK;
}

rp_status export_run_read(rp_arena *arena, const char *source, rp_table *table, const char *columns,
                          export_run *run)
{
    *run = (export_run){.arena = arena};
    RP_TRY(find_frames(arena, table, &run->grains));
    RP_TRY(find_grains(arena, run, columns));
    if (run->grains.n == 0) return rp_fail(RP_BAD_INPUT, "%s: no grains", source);
    RP_TRY(read_beside(arena, source, "contacts.tsv", &run->contacts));
    RP_TRY(read_beside(arena, source, "walls.tsv", &run->walls));
    const rp_table *tables[] = {run->grains.table, run->contacts.table, run->walls.table};
    for (size_t i = 0; i < sizeof tables / sizeof *tables; i++)
        for (size_t c = 0; tables[i] && c < tables[i]->n_columns; c++)
            if (tables[i]->names[c]) export_word(tables[i]->names[c]);
    return RP_OK;
}
