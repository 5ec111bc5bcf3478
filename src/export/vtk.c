/* Frames as VTK PolyData (.vtp), with a ParaView collection (.pvd) of their times. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/file.h"
#include "core/folder.h"
#include "export/export.h"

/* One piece of PolyData in the making: points, then cells of `size` points each, one of each row that is
 * drawn. */
typedef struct {
    const export_frames *frames;
    size_t first, end;
    int size;        /* 1: vertices; 2: lines */
    const int *ends; /* columns of a wall's ends: nothing is left of one without a length; NULL: no walls */
} piece;

static bool is_drawn(const piece *p, size_t row)
{
    const rp_table *t = p->frames->table;
    return !p->ends ||
           strtod(export_cell(t, row, p->ends[0]), NULL) < strtod(export_cell(t, row, p->ends[1]), NULL);
}

static size_t count_drawn(const piece *p)
{
    size_t n = 0;
    for (size_t i = p->first; i < p->end; i++) n += is_drawn(p, i);
    return n;
}

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
        if (!is_drawn(p, i)) continue;
        fputs(export_cell(p->frames->table, i, first), out);
        if (second >= 0) fprintf(out, " %s 0", export_cell(p->frames->table, i, second));
        fputc('\n', out);
    }
    fputs("</DataArray>\n", out);
}

static void start(FILE *out, const piece *p)
{
    const size_t n = count_drawn(p);
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
    const size_t n = count_drawn(p), size = (size_t)p->size;
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

/* Lines: n columns that give their ends, and what prints these. */
typedef struct {
    size_t n;
    const char *columns[6];
    void (*put)(const export_run *run, const rp_table *t, size_t row, const int columns[], FILE *out);
} lines;

static void put_contact(const export_run *run, const rp_table *t, size_t row, const int c[], FILE *out)
{
    (void)run;
    fprintf(out, "%s %s 0\n%s %s 0\n", rp_cell(t, row, c[0]), rp_cell(t, row, c[1]), rp_cell(t, row, c[2]),
            rp_cell(t, row, c[3]));
}

/* From end to end along the direction turned clockwise; an open end reaches as far as the grains of all
 * frames do. */
static void put_wall(const export_run *run, const rp_table *t, size_t row, const int c[], FILE *out)
{
    double v[6], reach[2] = {INFINITY, -INFINITY};
    for (int k = 0; k < 6; k++) v[k] = strtod(export_cell(t, row, c[k]), NULL);
    const double tangent[2] = {v[3], -v[2]};
    for (int corner = 0; corner < 4; corner++) {
        const double along =
            (run->box[0][corner % 2] - v[0]) * tangent[0] + (run->box[1][corner / 2] - v[1]) * tangent[1];
        reach[0] = fmin(reach[0], along), reach[1] = fmax(reach[1], along);
    }
    for (int end = 0; end < 2; end++) {
        const double s = isinf(v[4 + end]) ? reach[end] : v[4 + end];
        fprintf(out, "%s %s 0\n", RP_SHORT(v[0] + s * tangent[0]), RP_SHORT(v[1] + s * tangent[1]));
    }
}

static const lines contacts = {4, {"x", "y", "x_b", "y_b"}, put_contact},
                   walls = {6, {"x", "y", "direction_x", "direction_y", "from", "to"}, put_wall};

/* With all other columns as their data. */
static rp_status write_lines(const export_run *run, piece *p, const lines *l, FILE *out)
{
    const rp_table *t = p->frames->table;
    int ends[6];
    for (size_t k = 0; k < l->n; k++) RP_TRY(rp_table_find(t, l->columns[k], l->columns[k], &ends[k]));
    if (l == &walls) p->ends = ends + 4;
    start(out, p);
    for (size_t i = p->first; i < p->end; i++)
        if (is_drawn(p, i)) l->put(run, t, i, ends, out);
    write_cells(out, p);
    fputs("<CellData>\n", out);
    for (int c = 0; c < (int)t->n_columns; c++) {
        bool data = c != p->frames->step && c != p->frames->t;
        for (size_t k = 0; k < l->n; k++) data &= c != ends[k];
        if (data) write_column(out, p, t->names[c], c, -1);
    }
    fputs("</CellData>\n" END, out);
    return RP_OK;
}

/* Write the parts of one frame, and name them in the collection. */
static rp_status write_frame(const export_run *run, size_t k, const rp_folder *folder, FILE *collection)
{
    const struct {
        const char *name;
        const export_frames *frames;
        const lines *lines;
    } parts[] = {{"grains", &run->grains, NULL},
                 {"contacts", &run->contacts, &contacts},
                 {"walls", &run->walls, &walls}};
    for (size_t i = 0; i < sizeof parts / sizeof *parts; i++) {
        const export_frames *f = parts[i].frames;
        size_t first = run->grains.first[k], n = run->grains.first[k + 1] - first;
        if (!f->table) continue;
        if (parts[i].lines) n = export_rows_at(f, export_frame_step(run, k), &first);
        piece p = {f, first, first + n, parts[i].lines ? 2 : 1, NULL};
        const char *path = rp_text(run->arena, "%s/%s_%06zu.vtp", folder->part, parts[i].name, k);
        FILE *out;
        RP_TRY(rp_file_open(path, true, &out));
        RP_TRY(rp_file_close(path, out,
                             parts[i].lines ? write_lines(run, &p, parts[i].lines, out)
                                            : write_grains(run, &p, out)));
        fprintf(collection, "<DataSet timestep=\"%s\" part=\"%zu\" name=\"%s\" file=\"%s/%s_%06zu.vtp\"/>\n",
                RP_SHORT(export_frame_time(run, k)), i, parts[i].name, basename(folder->path), parts[i].name,
                k);
    }
    return RP_OK;
}

/* The folder, by a name that its collection may have, once the collection is whole. */
static rp_status write_frames(const export_run *run, const char *path, bool replace, FILE *collection)
{
    RP_ENDS(rp_folder_end) rp_folder folder = {0};
    char *name = rp_text(run->arena, "%s_frames", export_stem(run->arena, path));
    export_word(basename(name)); /* of an attribute in XML */
    RP_TRY(rp_folder_begin(run->arena, name, rp_text(run->arena, "frames of %s", path), replace, &folder));
    for (size_t k = 0; k < run->grains.n; k++) RP_TRY(write_frame(run, k, &folder, collection));
    fputs("</Collection>\n</VTKFile>\n", collection);
    RP_TRY(rp_file_sync(collection, path));
    return rp_folder_publish(&folder);
}

rp_status export_vtk(const export_run *run, const char *path)
{
    FILE *out;
    if (strlen(path) < 5 || !rp_ends_in(path, ".pvd"))
        return rp_fail(RP_USAGE, "-o %s: vtk needs a name that ends in .pvd", path);
    const bool replace = run->replace || rp_file_was_begun(path);
    RP_TRY(rp_file_open(path, run->replace, &out));
    fputs("<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\">\n<Collection>\n", out);
    return rp_file_close(path, out, write_frames(run, path, replace, out));
}
