/* `repose view`: what is drawn, and the text for gnuplot. */
#ifndef CLI_VIEW_H
#define CLI_VIEW_H

#include <stdbool.h>
#include <stdio.h>
#include <sys/types.h>

#include "core/arena.h"
#include "stress/stress.h"

/* A contact between two grains, or of a grain with a wall: the branch, the normal force (tension negative),
 * and the force on the first grain. */
typedef struct {
    double normal;
    bool wall;
    stress_contact c;
} view_contact;

/* Both ends; infinite ones beyond the picture are found when it is drawn. */
typedef struct {
    double x, y, direction[2], ends[2];
} view_wall;

/* One moment. Arrays belong to the command's memory. */
typedef struct {
    double step, t; /* NaN: unknown */
    size_t n, n_contacts, n_walls, n_base;
    const double *x, *y, *r, *value; /* of the grains; `value` is what colours them, or NULL */
    const double *fixed;             /* above 0: one that never moves; NaN, or NULL: unknown */
    const view_contact *contacts;    /* the weakest first */
    const view_wall *walls;
    const double *base_x, *base_force; /* forces on the base that the contacts do not show */
} view_frame;

typedef struct {
    size_t n;
    view_frame *frames;                                 /* by rising step */
    char length[32], force[32], time[32], quantity[32]; /* units; "1": none */
    const char *kinds; /* names of the values from 1 on; NULL: these are no kinds */
} view_scene;

/* All frames of a folder or table; `color`: column of the values, "" for none. Errors: RP_BAD_INPUT. */
rp_status view_read(rp_arena *arena, const char *path, const char *color, view_scene *scene);

/* Height of letters in an svg picture, pixels. */
#define VIEW_LETTERS 11

typedef struct {
    double width;     /* of the picture, cm */
    double window[4]; /* least and largest x, y; NaN: whatever there is */
    double cell;      /* width of cells of stress and of bins of the base */
    const char *color;
    bool stress, base;
    bool points; /* circles as gnuplot's svg terminal has them for points: a tenth of the bytes */
} view_style;

/* What all frames of a picture have in common. */
typedef struct {
    double window[4];
    double force, stress, pressure, value[2]; /* largest; least and largest */
    double width, height, panel, right;       /* cm: the picture; its lower panel; right of the plot */
    double radius;                            /* mean */
    double per_length;                        /* cm on the picture a unit of length */
    double cell, start[2];                    /* cells of stress and bins of the base: size, least x and y */
} view_scale;

/* Scale for the frames first to last. */
rp_status view_scale_of(rp_arena *arena, const view_scene *scene, size_t first, size_t last,
                        const view_style *style, view_scale *scale);

/* Settings that all frames share, after the terminal; one frame. */
void view_draw_start(const view_scene *scene, const view_style *style, const view_scale *scale, FILE *out);
rp_status view_draw(rp_arena *arena, const view_scene *scene, const view_frame *frame,
                    const view_style *style, const view_scale *scale, FILE *out);

/* A gnuplot that reads its commands from this process. */
typedef struct {
    FILE *in; /* its commands */
    const char *name;
    FILE *errors; /* its messages, shown if it fails */
    pid_t pid;
} view_gnuplot;

/* Start gnuplot, or another program that `arguments` (ended by NULL) name; its standard output goes to `out`
 * (NULL: to that of this process). A process that ends early is no signal here. Errors: RP_NO_RESULT (not
 * installed; the message names the Debian `package`), RP_IO. */
rp_status view_gnuplot_open(view_gnuplot *g, char *const arguments[], const char *package, FILE *out);

/* End the commands and wait. Errors: RP_NO_RESULT (no window can be opened), RP_IO. */
rp_status view_gnuplot_close(view_gnuplot *g);

/* Is there a screen for a window? */
bool view_has_screen(void);

/* The first commands for a window. gnuplot ends, for view_gnuplot_close to report, if it has none to open. */
extern const char view_gnuplot_window[];

#endif
