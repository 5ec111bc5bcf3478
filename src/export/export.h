/* `repose export`: what is read, and the writers, one file for each family of formats. */
#ifndef CLI_EXPORT_H
#define CLI_EXPORT_H

#include <stdio.h>

#include "cli/cli.h"

/* The shortest text of a number that reads back to the same bits; it lives as long as the block. */
#define CLI_SHORT(number) rp_number_text(number, 15, (char[32]){0}, 32)

/* A file in the making ("-": standard output), compressed by zlib if its name ends in .gz. */
typedef struct {
    const char *path;
    FILE *out, *plain;
} cli_export;
rp_status cli_export_open(const char *path, cli_export *e);             /* as rp_file_open */
rp_status cli_export_close(const cli_export *e, rp_status keep);        /* as rp_file_close */
const char *cli_export_cell(const rp_table *t, size_t row, int column); /* a number: "inf" for infinite */

/* "out/pile", without the ending (and .gz before it), of "out/pile.pvd". */
const char *cli_export_stem(const char *path, char stem[4096]);

/* A table in frames, the rows of equal `step`: frame k is rows first[k] to first[k + 1] - 1. */
typedef struct {
    rp_table *table; /* NULL: there is no such table, and no frame */
    size_t n, *first;
    double *steps; /* of each frame */
    int step, t;   /* columns; -1 for none */
} cli_frames;

/* A quantity: one column, or the two components of a vector, by name in each format. */
typedef struct {
    int column[2]; /* the second -1: a number */
    const char *dump, *xyz, *vtk;
} cli_field;

/* What a run is made of. Contacts and walls belong to the frame of grains with their step. */
enum { CLI_MOST_FIELDS = 64 };
typedef struct {
    cli_frames grains, contacts, walls;
    int id, x, y, r; /* of the grains; id -1: their number in the frame */
    size_t n_fields;
    cli_field fields[CLI_MOST_FIELDS]; /* of the grains, `r` first, without step, t, id, x, y */
    double box[2][2];                  /* least and largest x, y of all grains with their radii */
    double largest;                    /* radius */
} cli_run_frames;

/* Sets n, first and steps from the steps of n rows, or from NaN: one frame. The frame with this
 * step, where the table has a column of steps; none: n. */
void cli_frames_split(rp_arena *arena, size_t n, const double step[], cli_frames *frames);
size_t cli_frame_at(const cli_frames *frames, double step);

/* Step and time of a frame of grains; without a column of times the step, without one of steps its number. */
double cli_frame_step(const cli_run_frames *run, size_t frame);
double cli_frame_time(const cli_run_frames *run, size_t frame);
void cli_frame_id(const cli_run_frames *run, size_t frame, size_t row, FILE *out);

/* Writers. Errors: RP_IO, RP_BAD_INPUT, RP_NO_MEMORY. */
rp_status cli_export_csv(const rp_table *t, size_t n, const int columns[], FILE *out);
rp_status cli_export_json(const rp_table *t, size_t n, const int columns[], FILE *out);
rp_status cli_export_dump(const cli_run_frames *run, const char *path);
rp_status cli_export_xyz(const cli_run_frames *run, const char *path);
rp_status cli_export_vtk(const cli_run_frames *run, const char *path);

/* The frames of the run in `folder`, as `repose run --dump` writes them there: run.lammpstrj, run.xyz or
 * run.pvd. Errors: those of the writers and of the tables. */
typedef enum { CLI_NO_DUMP, CLI_DUMP_LAMMPS, CLI_DUMP_XYZ, CLI_DUMP_VTK } cli_dump;
rp_status cli_export_run(const cli_call *call, const char *folder, cli_dump format);

/* The scene in file `scene` as the LAMMPS input `path` and its data file. Errors: RP_BAD_INPUT naming the key
 * for which LAMMPS has no equal. */
rp_status cli_export_lammps_input(rp_arena *arena, const char *scene, const rp_texts *changes,
                                  const char *path);

#endif
