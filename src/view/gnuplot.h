/* A gnuplot that reads its commands from this process. */
#ifndef VIEW_GNUPLOT_H
#define VIEW_GNUPLOT_H

#include <stdbool.h>
#include <stdio.h>
#include <sys/types.h>

#include "core/status.h"

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
