/* Frames as VTK PolyData (.vtp), with a ParaView collection (.pvd) of their times. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "core/file.h"
#include "core/folder.h"
#include "export/export.h"

/* One piece of PolyData in the making: points, then cells of `size` points each. */
typedef struct {
    const export_frames *frames;
    size_t first, end;
    int size; /* 1: vertices; 2: lines */
} piece;

#define END "</Piece>\n</PolyData>\n</VTKFile>\n"

static void start_array(FILE *out, const char *name, int components)
{
    fprintf(out, "<DataArray type=\"Float64\" Name=\"%s\" NumberOfComponents=\"%d\" format=\"ascii\">\n",
            name, components);
}

static void write_column(FILE *out, const piece *p, const char *name, int first, int second)
{
    start_array(out, name, second < 0 ? 1 : 3);
    for (size_t i = p->first; i < p->end; i++) {
        fputs(export_cell(p->frames->table, i, first), out);
        if (second >= 0) fprintf(out, " %s 0", export_cell(p->frames->table, i, second));
        fputc('\n', out);
    }
    fputs("</DataArray>\n", out);
}

static void start(FILE *out, const piece *p)
{
    const size_t n = p->end - p->first;
    fprintf(
        out,
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\">\n"
        "<PolyData>\n<Piece NumberOfPoints=\"%zu\" NumberOfVerts=\"%zu\" NumberOfLines=\"%zu\" "
        "NumberOfStrips=\"0\" NumberOfPolys=\"0\">\n<Points>\n",
        n * (size_t)p->size, p->size == 1 ? n : 0, p->size == 2 ? n : 0);
    start_array(out, "Points", 3);
}

/* After the points: the cells. */
static void write_cells(FILE *out, const piece *p)
{
    const size_t n = p->end - p->first, size = (size_t)p->size;
    const char *cells = size == 1 ? "Verts" : "Lines";
    fprintf(
        out,
        "</DataArray>\n</Points>\n<%s>\n<DataArray type=\"Int64\" Name=\"connectivity\" format=\"ascii\">\n",
        cells);
    for (size_t i = 0; i < n * size; i++) fprintf(out, "%zu%c", i, (i + 1) % size ? ' ' : '\n');
    fputs("</DataArray>\n<DataArray type=\"Int64\" Name=\"offsets\" format=\"ascii\">\n", out);
    for (size_t i = 1; i <= n; i++) fprintf(out, "%zu\n", i * size);
    fprintf(out, "</DataArray>\n</%s>\n", cells);
}

static rp_status write_grains(const export_run *run, const piece *p, FILE *out)
{
    const rp_table *t = run->grains.table;
    start(out, p);
    for (size_t i = p->first; i < p->end; i++)
        fprintf(out, "%s %s 0\n", export_cell(t, i, run->x), export_cell(t, i, run->y));
    write_cells(out, p);
    fputs("<PointData Scalars=\"radius\">\n", out);
    if (run->id >= 0) write_column(out, p, "id", run->id, -1);
    for (size_t f = 0; f < run->n_fields; f++)
        write_column(out, p, run->fields[f].vtk, run->fields[f].column[0], run->fields[f].column[1]);
    fputs("</PointData>\n" END, out);
    return RP_OK;
}

/* Columns of lines that are not among the n that give their ends. */
static void write_line_data(const piece *p, size_t n, const int ends[], FILE *out)
{
    const rp_table *t = p->frames->table;
    write_cells(out, p);
    fputs("<CellData>\n", out);
    for (int c = 0; c < (int)t->n_columns; c++) {
        bool data = c != p->frames->step && c != p->frames->t;
        for (size_t k = 0; k < n; k++) data &= c != ends[k];
        if (data) write_column(out, p, t->names[c], c, -1);
    }
    fputs("</CellData>\n" END, out);
}

static rp_status find_columns(const rp_table *t, size_t n, const char *const names[], int columns[])
{
    for (size_t k = 0; k < n; k++) RP_TRY(rp_table_find(t, names[k], names[k], &columns[k]));
    return RP_OK;
}

static rp_status write_contacts(const export_run *run, const piece *p, FILE *out)
{
    (void)run;
    const rp_table *t = p->frames->table;
    int ends[4];
    RP_TRY(find_columns(t, 4, (const char *const[]){"x", "y", "x_b", "y_b"}, ends));
    start(out, p);
    for (size_t i = p->first; i < p->end; i++)
        fprintf(out, "%s %s 0\n%s %s 0\n", rp_cell(t, i, ends[0]), rp_cell(t, i, ends[1]),
                rp_cell(t, i, ends[2]), rp_cell(t, i, ends[3]));
    write_line_data(p, 4, ends, out);
    return RP_OK;
}

/* From end to end along the direction turned clockwise; an open end reaches as far as the grains of all
 * frames do. */
static rp_status write_walls(const export_run *run, const piece *p, FILE *out)
{
    const rp_table *t = p->frames->table;
    int columns[6];
    double v[6];
    RP_TRY(find_columns(t, 6, (const char *const[]){"x", "y", "direction_x", "direction_y", "from", "to"},
                        columns));
    start(out, p);
    for (size_t i = p->first; i < p->end; i++) {
        for (int k = 0; k < 6; k++) v[k] = strtod(export_cell(t, i, columns[k]), NULL);
        const double tangent[2] = {v[3], -v[2]};
        double reach[2] = {INFINITY, -INFINITY};
        for (int corner = 0; corner < 4; corner++) {
            const double along =
                (run->box[0][corner % 2] - v[0]) * tangent[0] + (run->box[1][corner / 2] - v[1]) * tangent[1];
            reach[0] = fmin(reach[0], along), reach[1] = fmax(reach[1], along);
        }
        for (int end = 0; end < 2; end++) {
            const double s = isinf(v[4 + end]) ? reach[end] : v[4 + end];
            fprintf(out, "%s %s 0\n", EXPORT_SHORT(v[0] + s * tangent[0]),
                    EXPORT_SHORT(v[1] + s * tangent[1]));
        }
    }
    write_line_data(p, 6, columns, out);
    return RP_OK;
}

/* Write the parts of one frame, and name them in the collection. */
static rp_status write_frame(const export_run *run, size_t k, const char *folder, FILE *collection)
{
    const struct {
        const char *name;
        const export_frames *frames;
        rp_status (*write)(const export_run *, const piece *, FILE *);
        int size;
    } parts[] = {{"grains", &run->grains, write_grains, 1},
                 {"contacts", &run->contacts, write_contacts, 2},
                 {"walls", &run->walls, write_walls, 2}};
    for (size_t i = 0; i < sizeof parts / sizeof *parts; i++) {
        const export_frames *f = parts[i].frames;
        const size_t at = i == 0 ? k : f->table ? export_frame_at(f, export_frame_step(run, k)) : 0;
        const piece p = {f, at < f->n ? f->first[at] : 0, at < f->n ? f->first[at + 1] : 0, parts[i].size};
        if (!f->table) continue;
        const char *path = rp_text(run->arena, "%s/%s_%06zu.vtp", folder, parts[i].name, k);
        export_file e;
        RP_TRY(export_open(path, &e));
        RP_TRY(export_close(&e, parts[i].write(run, &p, e.out)));
        fprintf(collection, "<DataSet timestep=\"%s\" part=\"%zu\" name=\"%s\" file=\"%s/%s_%06zu.vtp\"/>\n",
                EXPORT_SHORT(export_frame_time(run, k)), i, parts[i].name, basename(folder), parts[i].name,
                k);
    }
    return RP_OK;
}

rp_status export_vtk(const export_run *run, const char *path)
{
    export_file e;
    if (strlen(path) < 5 || !rp_ends_in(path, ".pvd"))
        return rp_fail(RP_USAGE, "-o %s: vtk needs a name that ends in .pvd", path);
    char *folder = rp_text(run->arena, "%s_frames", export_stem(run->arena, path));
    export_word(basename(folder)); /* of an attribute in XML */
    RP_TRY(export_open(path, &e));
    rp_status status = rp_folder_make(folder);
    fputs("<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\">\n<Collection>\n", e.out);
    for (size_t k = 0; k < run->grains.n && !status; k++) status = write_frame(run, k, folder, e.out);
    fputs("</Collection>\n</VTKFile>\n", e.out);
    return export_close(&e, status);
}
