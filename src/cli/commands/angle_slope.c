/* repose angle slope: the slope of a pile's surface. */
#include <gsl/gsl_statistics_double.h>
#include <string.h>

#include "angle/angle.h"
#include "cli/cli.h"

#define SLOPE_OPTIONS(X)                                                                                     \
    X(REAL, width, "", NULL, "(0, inf)", "width W of the box from x = 0, in the unit of FILE")               \
    X(REAL, cell, "", "auto", "(0, inf) | auto",                                                             \
      "nominal diameter d of a grain, in the unit of FILE; round(W/d) cells; auto: see above")               \
    X(CHOICE, height, "", "centre", ANG_HEIGHT_WORDS,                                                        \
      "height of a cell: highest centre - d/2 (at least 0), highest centre, or highest point")               \
    X(CHOICE, empty, "", "zero", ANG_EMPTY_WORDS, "empty cells have height 0, or are left out")              \
    X(CHOICE, parabola, "", "free", ANG_PARABOLA_WORDS,                                                      \
      "parabola of method 3: three coefficients, or through the origin")                                     \
    X(CHOICE, y_axis, "", "up", "up | down",                                                                 \
      "where y grows to: down in the rows of a picture; the lowest point then lies d/2 above the ground")    \
    CLI_WHERE(X)

CLI_OPTIONS(slope, SLOPE_OPTIONS)

/* Columns by name, if the table has one of the names, else the first ones. Radii are read where the table has
 * them, if they are `useful`. */
static rp_status read_grains(rp_arena *arena, rp_table *t, bool needs_r, bool useful, bool *with_r,
                             double **block)
{
    static char *first[] = {"x", "y", "r"};
    bool named = false;
    for (size_t c = 0; c < N_OF(first); c++) named |= rp_table_column(t, first[c]) >= 0;
    *with_r = needs_r || (useful && (named ? rp_table_column(t, "r") >= 0 : t->n_columns >= 3));
    const size_t n = *with_r ? 3 : 2;
    if (!named && t->n_columns < n)
        return rp_fail(RP_BAD_INPUT, "%s: %zu columns, at least %zu (%s) needed", t->path, t->n_columns, n,
                       *with_r ? "x y r" : "x y");
    for (size_t c = 0; !named && c < n; c++) t->names[c] = first[c];
    return rp_columns_read(arena, t, *with_r ? "x,y,r" : "x,y", block);
}

/* A table of states may hold a pile at several times. */
static rp_status refuse_several_steps(const rp_table *table)
{
    int column = rp_table_column(table, "step");
    for (size_t i = 1; column >= 0 && i < table->n_rows; i++)
        if (strcmp(rp_cell(table, i, column), rp_cell(table, 0, column)) != 0)
            return rp_fail(RP_BAD_INPUT, "%s:%zu: step = %s after %s: one step's grains expected",
                           table->places[i].path, table->places[i].line, rp_cell(table, i, column),
                           rp_cell(table, 0, column));
    return RP_OK;
}

/* A height above the ground instead of a row of a picture. */
static void turn_over(size_t n, double y[], double diameter)
{
    const double lowest = gsl_stats_max(y, 1, n);
    for (size_t i = 0; i < n; i++) y[i] = lowest - y[i] + 0.5 * diameter;
}

/* A table does not tell whether its surface falls to the left or its y points down. */
static void warn_negative(const cli_call *call, const ang_slope slopes[ANG_N_METHODS])
{
    bool negative = !cli_given(call, "y-axis");
    for (int i = 0; i < ANG_N_METHODS; i++) negative &= slopes[i].slope < 0.0;
    if (negative)
        fputs("repose angle slope: the angles are negative: the surface falls to the left (--y-axis up tells "
              "so), or y counts downward, as the rows of a picture do (--y-axis down)\n",
              stderr);
}

/* Without slopes: rows without result. */
static void print_slopes(const cli_call *call, const ang_surface *surface, const ang_slope *slopes,
                         const char *word, double cell, const char *origin)
{
    cli_table(call, stdout);
    rp_table_note_number(stdout, "cell", cell, origin);
    rp_table_header(stdout,
                    "method, slope, theta_deg [deg], theta_se_deg [deg], n_cells, n_occupied, status");
    for (int i = 0; i < ANG_N_METHODS; i++) {
        ang_slope s = slopes ? slopes[i] : (ang_slope){NAN, NAN, NAN, NAN};
        CLI_ROW_WORD(word, i + 1, s.slope, s.theta / deg, s.theta_se / deg, (double)surface->n_cells,
                     (double)surface->n_occupied);
    }
}

/* The nominal diameter of a grain, and where it is from. */
static rp_status choose_cell(const slope_options *o, const rp_table *t, const double *block, bool with_r,
                             double *cell, const char **origin)
{
    const size_t n = t->n_rows;
    const double *r = block + 2 * n;
    *cell = o->cell;
    *origin = "by --cell";
    if (o->cell > 0.0) return RP_OK;
    for (size_t i = 0; i < n && with_r; i++)
        if (!(r[i] > 0.0))
            return rp_fail(RP_BAD_INPUT, "%s:%zu: r = %g: out of range, allowed: (0, inf)", t->places[i].path,
                           t->places[i].line, r[i]);
    *origin = with_r ? "mean diameter of the grains" : "from the spacing of the points";
    *cell = with_r ? 2.0 * gsl_stats_mean(r, 1, n) : NAN;
    return with_r ? RP_OK : ang_cell_of_points(n, block, block + n, o->width, cell);
}

static rp_status slope_of_table(cli_call *call, rp_table *table, const void *values)
{
    const slope_options *o = values;
    double *block = NULL;
    size_t n = table->n_rows;
    ang_options options = {o->cell, (ang_height)o->height, (ang_empty)o->empty, (ang_parabola)o->parabola};
    ang_surface surface = {0};
    ang_slope slopes[ANG_N_METHODS];
    const char *origin = "", *word = "no_pile";
    bool with_r = false;
    if (n == 0) return rp_fail(RP_BAD_INPUT, "%s: no grains", table->path);
    rp_status status = refuse_several_steps(table);
    if (!status)
        status =
            read_grains(call->arena, table, options.height == ANG_TOP, !(o->cell > 0.0), &with_r, &block);
    if (!status) status = choose_cell(o, table, block, with_r, &options.diameter, &origin);
    if (!status && o->y_axis) turn_over(n, block + n, options.diameter);
    if (!status) {
        status = ang_surface_make(n, block, block + n, with_r ? block + 2 * n : NULL, o->width, &options,
                                  &surface);
        rp_prefix(status, "%s: ", table->path);
    }
    if (!status && 2 * surface.n_occupied < surface.n_cells) {
        word = "sparse";
        status = rp_fail(RP_NO_RESULT,
                         "%s: sparse: %zu of %zu cells hold a point; a larger --cell than %g is needed, or a "
                         "smaller --width",
                         table->path, surface.n_occupied, surface.n_cells, options.diameter);
    }
    if (!status)
        status = ang_slopes(surface.n, surface.column, surface.h, surface.cell, options.parabola, slopes);
    if (!status || status == RP_NO_RESULT)
        print_slopes(call, &surface, status ? NULL : slopes, status ? word : "ok", options.diameter, origin);
    if (!status) warn_negative(call, slopes);
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
    "is needed for --height top only. By default a cell is as wide as the mean diameter of the grains.\n"
    "Without r it is as wide as the widest gap along x between neighbouring points, so that no cell is\n"
    "empty, or as the median distance from a point to its nearest one, where that is larger.\n"
    "For points in pixels, whose y is the row of a picture, give --y-axis down.\n"
    "Fewer than 5 filled cells: no_pile; fewer than half of the cells: sparse; both have exit status 1.",
    "repose angle slope pile.tsv --width 4",
    slope_params,
    .refuses = "Grains of several steps: choose one by --where step=N.\n"
               "--height top without radii; a radius that is not positive.",
    .on_table = slope_of_table};
