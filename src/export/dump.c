/* Frames as LAMMPS dumps and as extended XYZ, and the choice among all formats of grains; see export.h. */
#include <string.h>

#include "export/export.h"

/* The values of a grain: the first column of the format, x y z, then the fields. */
static void write_values(const export_run *run, size_t row, FILE *out)
{
    const rp_table *t = run->grains.table;
    fprintf(out, " %s %s 0", export_cell(t, row, run->x), export_cell(t, row, run->y));
    for (size_t f = 0; f < run->n_fields; f++) {
        const int *c = run->fields[f].column;
        fprintf(out, " %s", export_cell(t, row, c[0]));
        if (c[1] >= 0) fprintf(out, " %s 0", export_cell(t, row, c[1]));
    }
    fputc('\n', out);
}

/* Head of a frame of `n` atoms or entries: box of all frames, open in x and y. */
static void write_head(const export_run *run, size_t frame, const char *of, size_t n, FILE *out)
{
    fprintf(out, "ITEM: TIME\n%s\nITEM: TIMESTEP\n%.0f\nITEM: NUMBER OF %s\n%zu\n",
            RP_SHORT(export_frame_time(run, frame)), export_frame_step(run, frame), of, n);
    fprintf(out, "ITEM: BOX BOUNDS ff ff pp\n%s %s\n%s %s\n%s %s\n", RP_SHORT(run->box[0][0]),
            RP_SHORT(run->box[0][1]), RP_SHORT(run->box[1][0]), RP_SHORT(run->box[1][1]),
            RP_SHORT(-run->largest), RP_SHORT(run->largest));
}

static rp_status write_grains(const export_run *run, const char *path)
{
    export_file e;
    RP_TRY(export_open(path, run->replace, &e));
    for (size_t k = 0; k < run->grains.n; k++) {
        const size_t first = run->grains.first[k], end = run->grains.first[k + 1];
        write_head(run, k, "ATOMS", end - first, e.out);
        fputs("ITEM: ATOMS id type x y z", e.out);
        for (size_t f = 0; f < run->n_fields; f++) fprintf(e.out, " %s", run->fields[f].dump);
        fputc('\n', e.out);
        for (size_t i = first; i < end; i++) {
            export_frame_id(run, k, i, e.out);
            fputs(" 1", e.out);
            write_values(run, i, e.out);
        }
    }
    return export_close(&e, RP_OK);
}

static rp_status write_contacts(const export_run *run, const char *path)
{
    const export_frames *f = &run->contacts;
    const rp_table *t = f->table;
    export_file e;
    RP_TRY(export_open(path, run->replace, &e));
    for (size_t k = 0; k < run->grains.n; k++) {
        size_t first;
        const size_t n = export_rows_at(f, export_frame_step(run, k), &first);
        write_head(run, k, "ENTRIES", n, e.out);
        fputs("ITEM: ENTRIES", e.out);
        for (size_t c = 0; c < t->n_columns; c++)
            if ((int)c != f->step && (int)c != f->t) fprintf(e.out, " %s", t->names[c]);
        fputc('\n', e.out);
        for (size_t i = first; i < first + n; i++, fputc('\n', e.out))
            for (size_t c = 0, written = 0; c < t->n_columns; c++)
                if ((int)c != f->step && (int)c != f->t)
                    fprintf(e.out, "%s%s", written++ ? " " : "", export_cell(t, i, (int)c));
    }
    return export_close(&e, RP_OK);
}

static rp_status write_dump(const export_run *run, const char *path)
{
    rp_status status = write_grains(run, path);
    if (status || strcmp(path, "-") == 0 || !run->contacts.table) return status;
    const char *stem = export_stem(run->arena, path);
    return write_contacts(run, rp_text(run->arena, "%s.contacts%s", stem, path + strlen(stem)));
}

static rp_status write_xyz(const export_run *run, const char *path)
{
    export_file e;
    RP_TRY(export_open(path, run->replace, &e));
    for (size_t k = 0; k < run->grains.n; k++) {
        const size_t first = run->grains.first[k], end = run->grains.first[k + 1];
        fprintf(e.out, "%zu\nProperties=id:I:1:pos:R:3", end - first);
        for (size_t f = 0; f < run->n_fields; f++)
            fprintf(e.out, ":%s:R:%d", run->fields[f].xyz, run->fields[f].column[1] < 0 ? 1 : 3);
        fprintf(e.out, " Time=%s step=%.0f pbc=\"F F F\"\n", RP_SHORT(export_frame_time(run, k)),
                export_frame_step(run, k));
        for (size_t i = first; i < end; i++) {
            export_frame_id(run, k, i, e.out);
            write_values(run, i, e.out);
        }
    }
    return export_close(&e, RP_OK);
}

rp_status export_write(const export_run *run, export_format format, const char *path)
{
    static rp_status (*const formats[])(const export_run *run, const char *path) = {
        [EXPORT_LAMMPS] = write_dump, [EXPORT_XYZ] = write_xyz, [EXPORT_VTK] = export_vtk};
    return formats[format](run, path);
}
