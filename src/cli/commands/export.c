/* `repose export`: runs, tables and sweeps in the formats of other programs. */
#include <sys/stat.h>

#include "cli/cli.h"
#include "table/where.h"
#include "export/export.h"

#define EXPORT_OPTIONS(X)                                                                                    \
    X(CHOICE, to, "", NULL, "csv | json | lammps | vtk | lammps-input", "format")                            \
    X(TEXT, o, "", "-", "", "file to write; - is standard output")                                           \
    X(TEXT, columns, "", "all", "", "columns (a or a,b,...) of the table or of the grains")                  \
    X(BOOL, reduce, "", "false", "",                                                                         \
      "for a sweep: one row per grid point, as in `repose sweep export --reduce`")                           \
    X(TEXTS, set, "", "", "", "for a scene: KEY=VALUE replaces a key, as in `repose run`")                   \
    CLI_WHERE(X)                                                                                             \
    CLI_FORCE(X, "replace an existing file")

CLI_OPTIONS(export, EXPORT_OPTIONS)
enum { TO_CSV, TO_JSON, TO_LAMMPS, TO_VTK, TO_LAMMPS_INPUT };

/* ---- what there is to export ---- */

/* The table that a run, a sweep or a file stands for; of a sweep its counts, else nothing planned. */
static rp_status read_source(const cli_call *call, const char *source, const export_options *o,
                             rp_table **table, sweep_counts *counts)
{
    *counts = (sweep_counts){0};
    const bool sweep = rp_is_in(source, "sweep.cfg"), run = rp_is_in(source, "states.tsv");
    struct stat info;
    if (o->reduce && !sweep) return rp_fail(RP_USAGE, "--reduce needs a sweep; %s is none", source);
    if (stat(source, &info) == 0 && S_ISDIR(info.st_mode) && !sweep && !run)
        return rp_fail(RP_BAD_INPUT, "%s: neither a run (states.tsv) nor a sweep (sweep.cfg)", source);
    if (!sweep && !run && rp_ends_in(source, ".cfg"))
        return rp_fail(RP_USAGE,
                       "%s: a scene is exported with --to lammps-input; repose run makes its tables", source);
    const unsigned what = SWEEP_PARAMETERS | (o->reduce ? SWEEP_POINTS : SWEEP_RUNS);
    RP_TRY(sweep ? cli_sweep_table(call, source, what, table, counts)
                 : rp_table_load(call->arena, run ? rp_text(call->arena, "%s/states.tsv", source) : source,
                                 table));
    for (size_t i = 0; i < o->where.n; i++) RP_TRY(rp_table_where(*table, o->where.items[i]));
    return RP_OK;
}

static rp_status export_table(const cli_call *call, const char *source, const export_options *o)
{
    rp_table *t;
    FILE *out;
    sweep_counts counts;
    size_t n;
    int *columns;
    RP_TRY(read_source(call, source, o, &t, &counts));
    RP_TRY(rp_columns(call->arena, t, o->columns, &n, &columns));
    RP_TRY(rp_file_open(o->o, o->force, &out));
    rp_status status = (o->to == TO_CSV ? export_csv : export_json)(t, n, columns, out);
    RP_TRY(rp_file_close(o->o, out, status));
    return rp_prefix(sweep_check_whole(source, &counts), "the table is not whole: ");
}

static rp_status export_grains(const cli_call *call, const char *source, const export_options *o)
{
    rp_table *table;
    export_run run;
    sweep_counts none;
    if (rp_is_in(source, "sweep.cfg"))
        return rp_fail(RP_USAGE, "%s is a sweep, which has no grains; use --to csv or --to json", source);
    RP_TRY(read_source(call, source, o, &table, &none));
    RP_TRY(export_run_read(call->arena, source, table, o->columns, &run));
    run.replace = o->force;
    return (o->to == TO_LAMMPS ? export_dump : export_vtk)(&run, o->o);
}

static rp_status act_export(cli_call *call, const void *values)
{
    const export_options *o = values;
    const char *source = rp_data(call->arena, cli_argument(call, 0));
    if (o->set.n > 0 && o->to != TO_LAMMPS_INPUT) return rp_fail(RP_USAGE, "--set needs --to lammps-input");
    if (o->to <= TO_JSON) return export_table(call, source, o);
    if (o->to < TO_LAMMPS_INPUT) return export_grains(call, source, o);
    if (cli_given(call, "columns") || cli_given(call, "where") || o->reduce)
        return rp_fail(RP_USAGE, "--to lammps-input takes no --columns, --where or --reduce");
    return export_lammps_input(call->arena, source, &o->set, o->o, o->force);
}

const cli_command cmd_export = {
    "export",
    "convert runs, tables and sweeps for other programs",
    "SOURCE --to FORMAT [-o FILE] [options]",
    "SOURCE is the folder of a run (`repose run -o`), a table (- for standard input), the folder of a sweep, "
    "or a scene file.\n"
    "\n"
    "csv, json: a table, which for a run is its states.tsv, and for a sweep its runs with all parameters as "
    "columns. CSV starts with the names of the columns. JSON is { notes, units, rows: [{column: value}] }, "
    "with null for nan.\n"
    "\n"
    "lammps: a LAMMPS dump of the grains with a frame for each step, and a dump local of the contacts in "
    "FILE.contacts.lammpstrj. Columns have the names of LAMMPS: radius, mass, vx vy vz, omegaz. vtk: "
    "FILE.pvd for ParaView, with grains as points (radius, mass, velocity), contacts and walls as lines, in "
    "VTP files in FILE_frames. "
    "Both formats can also be made of a table of grains (x, y, r); if it is X_grains.tsv, the contacts and "
    "walls beside it are included. Lengths, times and masses keep the units of the source; z is 0.\n"
    "\n"
    "lammps-input: the scene as FILE.in and FILE.data for LAMMPS. The head of FILE.in says which laws "
    "coincide. LAMMPS supports these keys; any other setting is refused.\n"
    "  normal.law      linear, elastic; hertz with at most 24 different radii, as\n"
    "                  each radius is a type\n"
    "  normal.tension  false; true without friction\n"
    "  tangential.law  none, slip_roll; spring and mindlin with slip = \"truncated\"\n"
    "                  and damping = \"inside\"\n"
    "  rolling         model spring, not with mindlin; with gamma at most 24\n"
    "                  different radii and masses\n"
    "  walls           infinite lines at rest, at any angle\n"
    "  grains          fixed or not, with or without rotation\n"
    "  integrator      verlet\n"
    "  none of         ground, hard, x_min, x_max, y_min, phases, turning\n"
    "                  gravity, turning box",
    "repose export out --to lammps -o pile.lammpstrj",
    export_params,
    .refuses =
        "lammps and vtk of a sweep: its store has results, and no grains. Use csv or json, or export the "
        "folder of one run (repose run SWEEP.cfg --row N -o DIR). --reduce without a sweep.\n"
        "For lammps-input: a key that LAMMPS does not support; --columns, --where and --reduce.\n"
        "--set with any other format.",
    .act = act_export};
