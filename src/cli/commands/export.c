/* `repose export`: runs, tables and sweeps in the formats of other programs. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include "export/export.h"

#define EXPORT_OPTIONS(X)                                                                                    \
    X(CHOICE, to, "", NULL, "csv | json | lammps | xyz | vtk | lammps-input", "format")                      \
    X(TEXT, o, "", "-", "", "file to write; - is standard output; a name that ends in .gz is compressed")    \
    X(TEXT, columns, "", "all", "", "columns (a or a,b,...) of the table, or of the grains")                 \
    X(BOOL, reduce, "", "false", "", "of a sweep: one row per grid point, as `repose sweep export` has it")  \
    X(TEXTS, set, "", "", "", "of a scene: KEY=VALUE replaces a key, as in `repose run`")                    \
    CLI_WHERE(X)

CLI_OPTIONS(export, EXPORT_OPTIONS)
typedef enum { TO_CSV, TO_JSON, TO_LAMMPS, TO_XYZ, TO_VTK, TO_LAMMPS_INPUT } target;

/* ---- files ---- */

static ssize_t gz_write(void *file, const char *bytes, size_t n)
{
    return n == 0 ? 0 : gzwrite(file, bytes, (unsigned)n);
}

static int gz_close(void *file)
{
    return gzclose(file) == Z_OK ? 0 : EOF;
}

rp_status cli_export_open(const char *path, cli_export *e)
{
    *e = (cli_export){.path = path};
    rp_status status = rp_file_open(path, &e->plain);
    e->out = e->plain;
    if (status || !rp_ends_in(path, ".gz")) return status;
    gzFile file = gzdopen(dup(fileno(e->plain)), "wb");
    e->out =
        file ? fopencookie(file, "w", (cookie_io_functions_t){.write = gz_write, .close = gz_close}) : NULL;
    if (e->out) return RP_OK;
    return rp_file_close(path, e->plain, rp_fail(RP_NO_MEMORY, "%s: out of memory", path));
}

rp_status cli_export_close(const cli_export *e, rp_status keep)
{
    if (e->out != e->plain) {
        const bool failed = ferror(e->out), unclosed = fclose(e->out) != 0;
        if (!keep && (failed || unclosed)) keep = rp_fail(RP_IO, "%s: cannot write", e->path);
    }
    return rp_file_close(e->path, e->plain, keep);
}

const char *cli_export_stem(const char *path, char stem[4096])
{
    snprintf(stem, 4096, "%s", path);
    if (rp_ends_in(stem, ".gz")) stem[strlen(stem) - 3] = '\0';
    char *name = strrchr(stem, '/'), *dot = strrchr(name ? name : stem, '.');
    if (dot) *dot = '\0';
    return stem;
}

const char *cli_export_cell(const rp_table *t, size_t row, int column)
{
    const char *text = cli_text(t, row, column);
    return strcmp(text, "infinite") == 0 ? "inf" : text;
}

/* ---- what there is to export ---- */

static bool is_there(const char *folder, const char *name)
{
    char path[4096];
    return snprintf(path, sizeof path, "%s/%s", folder, name) < (int)sizeof path && access(path, F_OK) == 0;
}

/* A sweep's runs or points, with all parameters. */
static rp_status read_sweep(const cli_call *call, const char *dir, bool reduce, rp_table **table,
                            sweep_counts *counts)
{
    char *text;
    size_t size;
    FILE *out = open_memstream(&text, &size);
    if (!out) return rp_fail(RP_NO_MEMORY, "%s: out of memory", dir);
    rp_status status =
        sweep_export(dir, sweep_protocols, SWEEP_PARAMETERS | (reduce ? SWEEP_POINTS : SWEEP_RUNS),
                     call->line, counts, out);
    fclose(out);
    if (!status) return cli_table_parse(call->arena, dir, text, table);
    free(text);
    return status;
}

/* The table that a run, a sweep or a file stands for; of a sweep its counts, else nothing planned. */
static rp_status read_source(const cli_call *call, const char *source, const export_options *o,
                             rp_table **table, sweep_counts *counts)
{
    char *path = rp_arena_memory(call->arena, strlen(source) + 16, 1);
    strcpy(path, source);
    *counts = (sweep_counts){0};
    const bool sweep = is_there(source, "sweep.cfg"), run = is_there(source, "states.tsv");
    struct stat info;
    if (o->reduce && !sweep) return rp_fail(RP_USAGE, "--reduce goes with a sweep; %s is none", source);
    if (stat(source, &info) == 0 && S_ISDIR(info.st_mode) && !sweep && !run)
        return rp_fail(RP_BAD_INPUT, "%s: neither a run (states.tsv) nor a sweep (sweep.cfg)", source);
    if (run) strcat(path, "/states.tsv");
    RP_TRY(sweep ? read_sweep(call, source, o->reduce, table, counts)
                 : cli_table_read(call->arena, path, table));
    for (size_t i = 0; i < o->where.n; i++) RP_TRY(rp_table_where(*table, o->where.items[i]));
    return RP_OK;
}

static rp_status export_table(const cli_call *call, const char *source, const export_options *o)
{
    rp_table *t;
    cli_export e;
    sweep_counts counts;
    size_t n;
    int *columns;
    RP_TRY(read_source(call, source, o, &t, &counts));
    RP_TRY(cli_columns(call->arena, t, o->columns, &n, &columns));
    if (is_there(source, "sweep.cfg")) RP_TRY(sweep_check_output(source, o->o));
    RP_TRY(cli_export_open(o->o, &e));
    rp_status status = (o->to == TO_CSV ? cli_export_csv : cli_export_json)(t, n, columns, e.out);
    RP_TRY(cli_export_close(&e, status));
    return cli_check_whole(source, &counts);
}

/* ---- frames of a run ---- */

void cli_frames_split(rp_arena *arena, size_t n, const double step[], cli_frames *f)
{
    f->first = rp_arena_memory(arena, n + 1, sizeof *f->first);
    f->steps = rp_arena_memory(arena, n, sizeof *f->steps);
    f->n = 0;
    for (size_t i = 0; i < n; i++) {
        if (i > 0 && (step[i] == step[i - 1] || isnan(step[i]))) continue;
        f->steps[f->n] = step[i];
        f->first[f->n++] = i;
    }
    f->first[f->n] = n;
}

size_t cli_frame_at(const cli_frames *f, double step)
{
    size_t k = 0;
    while (k < f->n && f->step >= 0 && f->steps[k] != step) k++;
    return k;
}

static bool is_number(const char *text)
{
    char *end;
    strtod(text, &end);
    return *text && !*end;
}

/* Every cell of a frame's table is a number, and steps rise. */
static rp_status find_frames(rp_arena *arena, rp_table *table, cli_frames *f)
{
    double *step = rp_arena_memory(arena, table->n_rows, sizeof *step), unused;
    *f = (cli_frames){
        .table = table, .step = rp_table_column(table, "step"), .t = rp_table_column(table, "t")};
    for (size_t i = 0; i < table->n_rows; i++) {
        for (size_t c = 0; c < table->n_columns; c++)
            if (!is_number(cli_export_cell(table, i, (int)c)))
                RP_TRY(rp_table_number(table, i, (int)c, true, &unused));
        if (f->step >= 0) RP_TRY(rp_table_number(table, i, f->step, false, &step[i]));
    }
    cli_frames_split(arena, table->n_rows, step, f);
    for (size_t k = 1; k < f->n; k++)
        if (f->steps[k] < f->steps[k - 1])
            return rp_fail(RP_BAD_INPUT, "%s:%zu: step %.0f after step %.0f", table->places[f->first[k]].path,
                           table->places[f->first[k]].line, f->steps[k], f->steps[k - 1]);
    return RP_OK;
}

double cli_frame_step(const cli_run_frames *run, size_t frame)
{
    const cli_frames *f = &run->grains;
    return f->step < 0 ? (double)frame : f->steps[frame];
}

double cli_frame_time(const cli_run_frames *run, size_t frame)
{
    const cli_frames *f = &run->grains;
    return f->t < 0 ? cli_frame_step(run, frame) : strtod(cli_text(f->table, f->first[frame], f->t), NULL);
}

void cli_frame_id(const cli_run_frames *run, size_t frame, size_t row, FILE *out)
{
    const cli_frames *f = &run->grains;
    if (run->id < 0)
        fprintf(out, "%zu", row - f->first[frame] + 1);
    else
        fprintf(out, "%.0f", strtod(cli_text(f->table, row, run->id), NULL));
}

/* Names in other programs; any other column keeps its own. */
static const struct {
    const char *columns[2], *dump, *xyz, *vtk;
} known[] = {{{"r"}, "radius", "radius", "radius"},
             {{"m"}, "mass", "mass", "mass"},
             {{"vx", "vy"}, "vx vy vz", "velo", "velocity"},
             {{"fx", "fy"}, "fx fy fz", "force", "force"},
             {{"omega"}, "omegaz", "omega", "omega"}};

/* Add column c, unless it has a place of its own or is the second component of a vector. */
static rp_status add_field(cli_run_frames *run, int c)
{
    static const char *const placed[] = {"step", "t", "id", "x", "y"};
    const rp_table *t = run->grains.table;
    const char *name = t->names[c];
    cli_field field = {{c, -1}, name, name, name};
    for (size_t i = 0; i < N_OF(placed); i++)
        if (strcmp(name, placed[i]) == 0) return RP_OK;
    for (size_t i = 0; i < N_OF(known); i++) {
        const bool vector = known[i].columns[1];
        const int first = rp_table_column(t, known[i].columns[0]),
                  second = vector ? rp_table_column(t, known[i].columns[1]) : -1;
        if (vector && second == c && first >= 0) return RP_OK;
        if (first != c || (vector && second < 0)) continue;
        field = (cli_field){{c, second}, known[i].dump, known[i].xyz, known[i].vtk};
    }
    if (run->n_fields == CLI_MOST_FIELDS)
        return rp_fail(RP_BAD_INPUT, "%s: more than %d columns", t->path, CLI_MOST_FIELDS);
    run->fields[run->n_fields++] = field;
    return RP_OK;
}

static rp_status find_grains(rp_arena *arena, cli_run_frames *run, const char *names)
{
    const rp_table *t = run->grains.table;
    int *columns;
    size_t n;
    RP_TRY(cli_find_column(t, "x", &run->x));
    RP_TRY(cli_find_column(t, "y", &run->y));
    RP_TRY(cli_find_column(t, "r", &run->r));
    run->id = rp_table_column(t, "id");
    RP_TRY(cli_columns(arena, t, names, &n, &columns));
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
    }
    return RP_OK;
}

/* The table beside that of the grains: DIR/contacts.tsv, or X_contacts.tsv of X_grains.tsv. */
static rp_status read_beside(rp_arena *arena, const char *source, const char *name, cli_frames *frames)
{
    static const char grains[] = "grains.tsv";
    const bool run = is_there(source, "states.tsv"), stage = rp_ends_in(source, grains);
    const int stem = (int)(strlen(source) - (stage ? strlen(grains) : 0));
    char *path = rp_arena_memory(arena, strlen(source) + 64, 1);
    rp_table *table;
    sprintf(path, "%.*s%s%s.tsv", stem, source, run ? "/" : "", name);
    if (!(run || stage) || access(path, F_OK) != 0) return RP_OK;
    RP_TRY(cli_table_read(arena, path, &table));
    RP_TRY(find_frames(arena, table, frames));
    if (frames->step < 0 && table->n_rows > 0)
        return rp_fail(RP_BAD_INPUT, "%s: no column \"step\": from an older version?", path);
    return RP_OK;
}

static rp_status export_frames(const cli_call *call, const char *source, const export_options *o)
{
    cli_run_frames run = {0};
    rp_table *table;
    sweep_counts none;
    if (is_there(source, "sweep.cfg"))
        return rp_fail(RP_USAGE, "%s is a sweep, which has no grains: csv and json go with it", source);
    RP_TRY(read_source(call, source, o, &table, &none));
    RP_TRY(find_frames(call->arena, table, &run.grains));
    RP_TRY(find_grains(call->arena, &run, o->columns));
    if (run.grains.n == 0) return rp_fail(RP_BAD_INPUT, "%s: no grains", source);
    RP_TRY(read_beside(call->arena, source, "contacts", &run.contacts));
    RP_TRY(read_beside(call->arena, source, "walls", &run.walls));
    switch (o->to) {
    case TO_LAMMPS: return cli_export_dump(&run, o->o);
    case TO_XYZ: return cli_export_xyz(&run, o->o);
    default: return cli_export_vtk(&run, o->o);
    }
}

rp_status cli_export_run(const cli_call *call, const char *folder, cli_dump format)
{
    static const struct {
        target to;
        const char *name;
    } files[] = {[CLI_DUMP_LAMMPS] = {TO_LAMMPS, "run.lammpstrj"},
                 [CLI_DUMP_XYZ] = {TO_XYZ, "run.xyz"},
                 [CLI_DUMP_VTK] = {TO_VTK, "run.pvd"}};
    if (format == CLI_NO_DUMP) return RP_OK;
    char *path = rp_arena_memory(call->arena, strlen(folder) + 16, 1);
    sprintf(path, "%s/%s", folder, files[format].name);
    return export_frames(call, folder,
                         &(export_options){.to = files[format].to, .o = path, .columns = "all"});
}

static rp_status act_export(cli_call *call, const void *values)
{
    const export_options *o = values;
    const char *source = cli_data(call->arena, cli_argument(call, 0));
    if (o->set.n > 0 && o->to != TO_LAMMPS_INPUT)
        return rp_fail(RP_USAGE, "--set goes with --to lammps-input");
    switch ((target)o->to) {
    case TO_CSV:
    case TO_JSON: return export_table(call, source, o);
    case TO_LAMMPS:
    case TO_XYZ:
    case TO_VTK: return export_frames(call, source, o);
    case TO_LAMMPS_INPUT: break;
    }
    if (cli_given(call, "columns") || cli_given(call, "where") || o->reduce)
        return rp_fail(RP_USAGE, "--columns, --where and --reduce do not go with --to lammps-input");
    return cli_export_lammps_input(call->arena, source, &o->set, o->o);
}

const cli_command cmd_export = {
    "export",
    "runs, tables and sweeps for other programs",
    "SOURCE --to FORMAT [-o FILE] [options]",
    "SOURCE is the folder of a run (`repose run -o`), a table, the folder of a sweep, or a scene.\n"
    "\n"
    "csv, json: a table; of a run its states.tsv; of a sweep its runs, with all parameters as columns. CSV\n"
    "starts with the names of the columns. JSON is { notes, units, rows: [{column: value}] }; nan is null.\n"
    "lammps: LAMMPS dump of the grains, a frame for each step, and beside FILE.lammpstrj the contacts as\n"
    "FILE.contacts.lammpstrj, a dump local. Names are those of LAMMPS: radius, mass, vx vy vz, omegaz.\n"
    "xyz: extended XYZ of the grains, for OVITO and ASE.\n"
    "vtk: FILE.pvd for ParaView: grains as points, contacts and walls as lines, VTP files in FILE_frames.\n"
    "These three take a table of grains (x, y, r) too, with the contacts and walls beside X_grains.tsv.\n"
    "Lengths, times and masses keep the units of the source; z is 0.\n"
    "\n"
    "lammps-input: FILE.in and FILE.data, the same scene for LAMMPS. A key whose law LAMMPS does not have\n"
    "is refused; the head of FILE.in says which laws coincide.",
    "repose export out --to lammps -o pile.lammpstrj.gz",
    export_params,
    .refuses =
        "Grains of a sweep, which has none: csv and json take it. --reduce without a sweep.\n"
        "For lammps-input: a scene with a law or key that LAMMPS lacks; --columns, --where and --reduce.\n"
        "--set with any other format.",
    .prints_text = true,
    .act = act_export};
