/* What a person sees of a run: its progress, its end in one line, and plots while it goes on. */
#ifndef CLI_WATCH_H
#define CLI_WATCH_H

#include "core/arena.h"
#include "view/gnuplot.h"
#include "dem/scene/scene.h"

/* Energies and the surface, drawn by gnuplot in a window, or as text on standard error without a screen. */
typedef struct {
    cli_gnuplot gnuplot;
    bool open, text;
    double next;            /* time of the next picture */
    size_t n, taken, every; /* samples kept, taken: one of `every` is kept */
    double (*sample)[3];    /* t, kinetic with rotational, elastic */
} cli_plot;

/* Errors: those of cli_gnuplot_open. A plot that fails later is no error of the run. */
rp_status cli_plot_open(rp_arena *arena, cli_plot *plot);
void cli_plot_show(rp_arena *arena, cli_plot *plot, const dem_sim *sim, const char *title, bool last);
void cli_plot_close(cli_plot *plot);

/* Are the grains at rest by dem_at_rest, to 1e-7 m g d and 1e-2 m g, by one look? Without gravity only
 * without any energy and force. Errors: RP_NO_MEMORY. */
rp_status cli_at_rest(rp_arena *arena, const dem_sim *sim, bool *rest);

/* theta_R by method 3 and its standard error, in degrees, over a range of x. */
typedef struct {
    double theta, se, x[2];
} cli_slope;

/* That of a pile at rest whose surface falls to one side: the slopes by all three methods have one sign and
 * exceed three times their errors; else NaN. Gravity points down. The pile ends at an upright wall that has
 * opened, and else where the grains end. Errors: RP_NO_MEMORY. */
rp_status cli_slope_of(rp_arena *arena, const dem_sim *sim, cli_slope *slope);

#endif
