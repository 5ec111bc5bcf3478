/* The formats of grains; see export.h. */
#include "export/export.h"

static const struct {
    rp_status (*write)(const export_run *run, const char *path);
    const char *ending;
} formats[] = {[EXPORT_LAMMPS] = {export_dump, "lammpstrj"},
               [EXPORT_XYZ] = {export_xyz, "xyz"},
               [EXPORT_VTK] = {export_vtk, "pvd"}};

rp_status export_grains_of(rp_arena *arena, const char *source, rp_table *table, const char *columns,
                           export_format format, const char *path)
{
    export_run run;
    RP_TRY(export_run_read(arena, source, table, columns, &run));
    return formats[format].write(&run, path);
}

rp_status export_folder(rp_arena *arena, const char *folder, export_format format)
{
    rp_table *table;
    const char *states, *path;
    if (format == EXPORT_NONE) return RP_OK;
    RP_TRY(rp_path(arena, &states, "%s/states.tsv", folder));
    RP_TRY(rp_path(arena, &path, "%s/run.%s", folder, formats[format].ending));
    RP_TRY(rp_table_load(arena, states, &table));
    return export_grains_of(arena, folder, table, "all", format, path);
}
