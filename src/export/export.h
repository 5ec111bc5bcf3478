/* Runs and tables for other programs: what is read, and the writers, one file for each family of formats. */
#ifndef EXPORT_H
#define EXPORT_H

#include <stdio.h>

#include "params/params.h"
#include "table/columns.h"

const char *export_cell(const rp_table *t, size_t row, int column); /* a number: "inf" for infinite */

/* Make a text one word, in which no program finds a command or a mark: what is no letter, digit, UTF-8 or one
 * of ._+-/()[] becomes _. */
char *export_word(char *text);

/* "out/pile" of "out/pile.pvd". */
const char *export_stem(rp_arena *arena, const char *path);

/* A table in frames, the rows of equal `step`: frame k is rows first[k] to first[k + 1] - 1. */
typedef struct {
    rp_table *table; /* NULL: there is no such table, and no frame */
    size_t n, *first;
    double *steps, *times; /* of each frame; NaN: unknown */
    int step, t;           /* columns; -1 for none */
} export_frames;

/* A quantity: one column, or the two components of a vector, by name in each format. */
typedef struct {
    int column[2]; /* the second -1: a number */
    const char *dump, *vtk;
} export_field;

/* What a run is made of. Contacts and walls belong to the frame of grains with their step. */
enum { EXPORT_MOST_FIELDS = 64 };
typedef struct {
    rp_arena *arena;
    export_frames grains, contacts, walls;
    int id, x, y, r, kind; /* of the grains; id -1: their number in the frame; kind -1: none */
    int first_type;        /* LAMMPS' of kind 0: it counts from 1 */
    size_t n_fields;
    export_field fields[EXPORT_MOST_FIELDS]; /* of the grains, `r` first, without step, t, id, x, y */
    double box[2][2];                        /* least and largest x, y of all grains with their radii */
    double largest;                          /* radius */
    bool replace;                            /* files that are there */
} export_run;

/* Sets n, first, steps and times from the steps and times of n rows; steps of NaN: one frame. How many rows
 * the frame with this step has, from *first on; of a table without a column of steps the first frame. */
void export_split(rp_arena *arena, size_t n, const double step[], const double t[], export_frames *frames);
size_t export_rows_at(const export_frames *frames, double step, size_t *first);

/* Step and time of a frame of grains; without a column of times the step, without one of steps its number. */
double export_frame_step(const export_run *run, size_t frame);
double export_frame_time(const export_run *run, size_t frame);
void export_frame_id(const export_run *run, size_t frame, size_t row, FILE *out);

/* Writers. Errors: RP_IO, RP_BAD_INPUT, RP_NO_MEMORY. */
rp_status export_csv(const rp_table *t, size_t n, const int columns[], FILE *out);
rp_status export_json(const rp_table *t, size_t n, const int columns[], FILE *out);
rp_status export_dump(const export_run *run, const char *path);
rp_status export_vtk(const export_run *run, const char *path);

/* The table NAME beside one of grains, DIR/NAME of DIR/states.tsv or DIR/disks.tsv, X_NAME of X_grains.tsv;
 * NULL without. */
const char *export_beside(rp_arena *arena, const char *grains, const char *name);

/* The grains of a table, that of `source`, as a run with these columns ("a,b,..." or "all"); contacts and
 * walls come from the tables beside: contacts.tsv in the folder of a run, X_contacts.tsv of X_grains.tsv.
 * Errors: RP_BAD_INPUT; those of the tables. */
rp_status export_run_read(rp_arena *arena, const char *source, rp_table *table, const char *columns,
                          export_run *run);

/* The scene in file `scene` as the LAMMPS input `path` and its data file. Errors: RP_BAD_INPUT naming the key
 * for which LAMMPS has no equal. */
rp_status export_lammps_input(rp_arena *arena, const char *scene, const rp_texts *changes, const char *path,
                              bool replace);

#endif
