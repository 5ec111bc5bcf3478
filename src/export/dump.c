/* Frames as LAMMPS dumps; see export.h. */
#include <stdlib.h>
#include <string.h>

#include "export/export.h"

#include "core/file.h"

/* The values of a grain: x y z, then the fields. */
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

/* The kind; of grains some of which have none, one more. */
static long type_of(const export_run *run, size_t row)
{
    return run->kind < 0 ? 1 : run->first_type + atol(rp_cell(run->grains.table, row, run->kind));
}

static void write_grains(const export_run *run, FILE *out)
{
    for (size_t k = 0; k < run->grains.n; k++) {
        const size_t first = run->grains.first[k], end = run->grains.first[k + 1];
        write_head(run, k, "ATOMS", end - first, out);
        fputs("ITEM: ATOMS id type x y z", out);
        for (size_t f = 0; f < run->n_fields; f++) fprintf(out, " %s", run->fields[f].dump);
        fputc('\n', out);
        for (size_t i = first; i < end; i++) {
            export_frame_id(run, k, i, out);
            fprintf(out, " %ld", type_of(run, i));
            write_values(run, i, out);
        }
    }
}

static void write_contacts(const export_run *run, FILE *out)
{
    const export_frames *f = &run->contacts;
    const rp_table *t = f->table;
    for (size_t k = 0; k < run->grains.n; k++) {
        size_t first;
        const size_t n = export_rows_at(f, export_frame_step(run, k), &first);
        write_head(run, k, "ENTRIES", n, out);
        fputs("ITEM: ENTRIES", out);
        for (size_t c = 0; c < t->n_columns; c++)
            if ((int)c != f->step && (int)c != f->t) fprintf(out, " %s", t->names[c]);
        fputc('\n', out);
        for (size_t i = first; i < first + n; i++, fputc('\n', out))
            for (size_t c = 0, written = 0; c < t->n_columns; c++)
                if ((int)c != f->step && (int)c != f->t)
                    fprintf(out, "%s%s", written++ ? " " : "", export_cell(t, i, (int)c));
    }
}

rp_status export_dump(const export_run *run, const char *path)
{
    const char *stem = export_stem(run->arena, path),
               *beside = rp_text(run->arena, "%s.contacts%s", stem, path + strlen(stem));
    const bool both = run->contacts.table && strcmp(path, "-") != 0;
    const bool replace = run->replace || (both && rp_file_was_begun(path));
    FILE *out, *contacts;
    RP_TRY(rp_file_open(path, run->replace, &out));
    const rp_status status = both ? rp_file_open(beside, replace, &contacts) : RP_OK;
    if (!status) write_grains(run, out);
    if (status || !both) return rp_file_close(path, out, status);
    write_contacts(run, contacts);
    return rp_file_close_both(path, out, beside, contacts);
}
