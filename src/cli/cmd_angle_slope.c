/* repose angle slope: the slope of a pile's surface. */
#include <string.h>

#include "angle/angle.h"
#include "cli/cli.h"

#define SLOPE_OPTIONS(X)                                                                                     \
    X(REAL, width, "cm", NULL, "(0, inf)", "width W of the box, from x = 0")                                 \
    X(REAL, cell, "cm", "0.2", "(0, inf)", "nominal diameter d of a grain; round(W/d) cells")                \
    X(CHOICE, height, "", "centre", ANG_HEIGHT_WORDS,                                                        \
      "height of a cell: highest centre - d/2 (at least 0), highest centre, or highest point")               \
    X(CHOICE, empty, "", "zero", ANG_EMPTY_WORDS, "empty cells have height 0, or are left out")              \
    X(CHOICE, parabola, "", "free", ANG_PARABOLA_WORDS,                                                      \
      "parabola of method 3: three coefficients, or through the origin")                                     \
    CLI_WHERE(X)

CLI_OPTIONS(slope, SLOPE_OPTIONS)

/* Columns by name, if the table has one of the names, else the first ones. */
static rp_status read_grains(rp_table *t, bool with_r, double **block)
{
    static char *first[] = {"x", "y", "r"};
    const size_t n = with_r ? 3 : 2;
    bool named = false;
    for (size_t c = 0; c < N_OF(first); c++) named |= rp_table_column(t, first[c]) >= 0;
    if (!named && t->n_columns < n)
        return rp_fail(RP_BAD_INPUT, "%s: %zu columns, at least %zu (%s) needed", t->path, t->n_columns, n,
                       with_r ? "x y r" : "x y");
    for (size_t c = 0; !named && c < n; c++) t->names[c] = first[c];
    return cli_read_columns(t, with_r ? "x,y,r" : "x,y", block);
}

/* A table of states may hold a pile at several times. */
static rp_status refuse_several_steps(const rp_table *table)
{
    int column = rp_table_column(table, "step");
    for (size_t i = 1; column >= 0 && i < table->n_rows; i++)
        if (strcmp(cli_text(table, i, column), cli_text(table, 0, column)) != 0)
            return rp_fail(RP_BAD_INPUT, "%s:%zu: step = %s after %s: one step's grains expected",
                           table->path, table->lines[i], cli_text(table, i, column),
                           cli_text(table, 0, column));
    return RP_OK;
}

/* Without slopes: rows without result. */
static void print_slopes(const ang_surface *surface, const ang_slope *slopes)
{
    cli_table(stdout);
    rp_table_header(stdout,
                    "method, slope, theta_deg [deg], theta_se_deg [deg], n_cells, n_occupied, status");
    for (int i = 0; i < ANG_N_METHODS; i++) {
        ang_slope s = slopes ? slopes[i] : (ang_slope){NAN, NAN, NAN, NAN};
        CLI_ROW_WORD(slopes ? "ok" : "no_pile", i + 1, s.slope, s.theta / deg, s.theta_se / deg,
                     (double)surface->n_cells, (double)surface->n_occupied);
    }
}

static rp_status slope_of_table(rp_table *table, void *values)
{
    const slope_options *o = values;
    double *block = NULL;
    size_t n = table->n_rows;
    ang_options options = {o->cell, (ang_height)o->height, (ang_empty)o->empty, (ang_parabola)o->parabola};
    ang_surface surface = {0};
    ang_slope slopes[ANG_N_METHODS];
    if (n == 0) return rp_fail(RP_BAD_INPUT, "%s: no grains", table->path);
    rp_status status = refuse_several_steps(table);
    if (!status) status = read_grains(table, options.height == ANG_TOP, &block);
    if (!status) {
        status = ang_surface_make(n, block, block + n, options.height == ANG_TOP ? block + 2 * n : NULL,
                                  o->width, &options, &surface);
        if (status) rp_prefix(status, "%s: ", table->path);
    }
    if (!status)
        status = ang_slopes(surface.n, surface.column, surface.h, surface.cell, options.parabola, slopes);
    if (!status || status == RP_NO_RESULT) print_slopes(&surface, status ? NULL : slopes);
    ang_surface_free(&surface);
    return status;
}

const cli_command cmd_angle_slope = {
    "angle slope",
    "slope of a table of grains by three methods",
    "FILE --width W [options]",
    "Slope of a pile's surface h(x), positive where it falls to the right, by the methods of Lee &\n"
    "Herrmann 1993: 1 first to last cell, 2 straight line, 3 parabola through the running sum of h. The\n"
    "standard error is propagated from the scatter of h about its straight line.\n"
    "FILE (- for standard input): one row a grain, columns x y r by name, otherwise the first three; r\n"
    "is needed for --height top only. Fewer than 5 occupied cells: no_pile, exit status 1.",
    "repose angle slope pile.tsv --width 4",
    slope_params,
    .on_table = slope_of_table};
