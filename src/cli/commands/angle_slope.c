/* repose angle slope: the slope of a pile's surface. */
#include <gsl/gsl_statistics_double.h>
#include <strings.h>

#include "angle/angle.h"
#include "cli/cli.h"

#define SLOPE_OPTIONS(X)                                                                                     \
    X(REAL, width, "", "auto", "(0, inf) | auto",                                                            \
      "width W of a box from x = 0, in the unit of FILE; auto: the pile, wherever it is")                    \
    CLI_RANGE(X, "x")                                                                                        \
    X(REAL, cell, "", "auto", "(0, inf) | auto",                                                             \
      "nominal diameter d of a grain, in the unit of FILE; round(W/d) cells; auto: the mean of r")           \
    X(CHOICE, height, "", "centre", ANG_HEIGHT_WORDS,                                                        \
      "height of a cell: highest centre - d/2 (at least 0), highest centre, or highest point")               \
    X(CHOICE, empty, "", "zero", ANG_EMPTY_WORDS, "empty cells have height 0, or are left out")              \
    X(CHOICE, parabola, "", "free", ANG_PARABOLA_WORDS,                                                      \
      "parabola of method 3: three coefficients, or through the origin")                                     \
    X(CHOICE, y_axis, "", "up", "up | down",                                                                 \
      "where y grows to: down in the rows of a picture; in a box the lowest point is d/2 above the ground")  \
    CLI_WHERE(X)

CLI_OPTIONS(slope, SLOPE_OPTIONS)

/* Columns by name, if the table has one of the names, else the first ones. Radii are read where the table has
 * them, if they are useful. */
static rp_status read_grains(rp_arena *arena, rp_table *t, const slope_options *o, bool *with_r,
                             double **block)
{
    const bool needs_r = o->height == ANG_TOP, useful = o->width > 0.0 && !(o->cell > 0.0);
    static char *first[] = {"x", "y", "r"};
    bool named = false;
    for (size_t c = 0; c < N_OF(first); c++) {
        const bool exact = rp_table_column(t, first[c]) >= 0;
        for (size_t i = 0; i < t->n_columns && !exact; i++)
            if (t->names[i] && strcasecmp(t->names[i], first[c]) == 0) t->names[i] = first[c];
        named |= rp_table_column(t, first[c]) >= 0;
    }
    *with_r = needs_r || (useful && (named ? rp_table_column(t, "r") >= 0 : t->n_columns >= 3));
    const size_t n = *with_r ? 3 : 2;
    if (!named && t->n_columns < n)
        return rp_fail(RP_BAD_INPUT, "%s: %zu columns, at least %zu (%s) needed", t->path, t->n_columns, n,
                       *with_r ? "x y r" : "x y");
    if (!named && t->names[0] && t->n_columns > 2)
        cli_say("repose angle slope: %s: no columns x, y: taken instead: %s, %s", t->path, t->names[0],
                t->names[1]);
    for (size_t c = 0; !named && c < n; c++) t->names[c] = first[c];
    return rp_columns_read(arena, t, *with_r ? "x,y,r" : "x,y", block);
}

/* A table does not tell whether its surface falls to the left or its y points down. */
static void warn_negative(const cli_call *call, const ang_slope slopes[ANG_N_METHODS])
{
    bool negative = !cli_given(call, "y-axis");
    for (int i = 0; i < ANG_N_METHODS; i++) negative &= slopes[i].slope < 0.0;
    if (negative)
        cli_say(
            "repose angle slope: the angles are negative: the surface falls to the left (--y-axis up tells "
            "so), or y counts downward, as the rows of a picture do (--y-axis down)");
}

/* Without slopes: rows without result. */
static void print_slopes(const cli_call *call, size_t n_cells, size_t n_occupied, const ang_slope *slopes,
                         const char *word)
{
    for (int i = 0; i < ANG_N_METHODS; i++) {
        ang_slope s = slopes ? slopes[i] : (ang_slope){NAN, NAN, NAN, NAN};
        CLI_ROW_WORD(word, i + 1, s.slope, s.theta / deg, s.theta_se / deg, (double)n_cells,
                     (double)n_occupied);
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
    if (!with_r)
        return rp_fail(RP_USAGE,
                       "%s: no radii, from which --width has its cells; give --cell, or leave --width out",
                       t->path);
    for (size_t i = 0; i < n; i++)
        if (!(r[i] > 0.0))
            return rp_fail(RP_BAD_INPUT, "%s:%zu: r = %g: out of range, allowed: (0, inf)", RP_PLACE(t, i),
                           r[i]);
    *origin = "mean diameter of the grains";
    *cell = 2.0 * gsl_stats_mean(r, 1, n);
    return RP_OK;
}

/* As the slopes of one flank. A box has its ground at y = 0 and cells from x = 0 on. */
static rp_status slope_of_box(size_t n, const double *block, bool with_r, const slope_options *o, double cell,
                              ang_pile *pile)
{
    const ang_options options = {cell, (ang_height)o->height, (ang_empty)o->empty, (ang_parabola)o->parabola};
    const double *x = block, *y = block + n;
    double left = INFINITY, lowest = 0.0;
    RP_ENDS(ang_surface_free) ang_surface s;
    rp_status status = ang_surface_make(n, x, y, with_r ? y + n : NULL, o->width, &options, &s);
    for (size_t i = 0; i < n; i++) {
        if (!(x[i] >= 0.0 && x[i] < o->width)) continue;
        left = fmin(left, x[i]);
        if (o->height == ANG_CENTRE) lowest = fmin(lowest, y[i]);
    }
    if (!status && (2 * s.n_occupied <= s.n_cells || left >= s.cell || lowest < -0.5 * s.cell))
        status = rp_fail(
            RP_NO_RESULT,
            "sparse: %zu of %zu cells hold a point, the first x is %g and the lowest y %g, where a box "
            "begins at 0, 0; give a larger --cell than %g or a smaller --width, or leave --width out",
            s.n_occupied, s.n_cells, left, lowest, s.cell);
    if (!status && (4 * s.n_occupied < 3 * s.n_cells || gsl_stats_min(x, 1, n) < 0.0 ||
                    (!ang_pile_find(n, x, y, (double[]){0.0, o->width}, pile) && pile->n_flanks == 2)))
        cli_say("repose angle slope: a box leaves out x < 0, its empty cells have height 0, and it has one "
                "flank; without --width the pile is found wherever it is");
    *pile = (ang_pile){.n = s.n_cells, .n_flanks = 1, .n_flank = {s.n_occupied}};
    return status ? status : ang_slopes(s.n, s.column, s.h, s.cell, options.parabola, pile->flank[0]);
}

static rp_status slope_of_table(cli_call *call, rp_table *table, const void *values)
{
    const slope_options *o = values;
    const bool box = o->width > 0.0;
    double *block = NULL, cell = NAN;
    const char *origin = "";
    bool with_r = false;
    ang_pile pile;
    if (table->n_rows == 0) return rp_fail(RP_BAD_INPUT, "%s: no grains", table->path);
    if (box ? cli_given(call, "from") || cli_given(call, "to")
            : cli_given(call, "cell") || cli_given(call, "empty") || cli_given(call, "parabola"))
        return rp_fail(RP_USAGE,
                       "--cell, --empty and --parabola need --width, --from and --to are without it");
    RP_TRY(rp_table_one_step(table));
    RP_TRY(read_grains(call->arena, table, o, &with_r, &block));
    const size_t n = table->n_rows;
    if (box) RP_TRY(choose_cell(o, table, block, with_r, &cell, &origin));
    /* a height above the ground instead of a row of a picture */
    const double lowest = gsl_stats_max(block + n, 1, n), above = box ? 0.5 * cell : 0.0;
    for (size_t i = n; i < 2 * n && o->y_axis; i++) block[i] = lowest - block[i] + above;
    for (size_t i = 0; i < n && !box && o->height == ANG_TOP; i++) block[n + i] += block[2 * n + i];
    rp_status status = box ? slope_of_box(n, block, with_r, o, cell, &pile)
                           : ang_pile_find(n, block, block + n, (double[]){o->from, o->to}, &pile);
    if (!status && pile.n_flanks == 2 && pile.flank[0][1].slope > 0.0 && !cli_given(call, "y-axis"))
        status = rp_fail(RP_NO_RESULT,
                         "a valley, two flanks that fall inwards: y counts downward, as the rows of a "
                         "picture do (--y-axis down), or not (--y-axis up tells so)");
    rp_prefix(status, "%s: %s", table->path, box ? "" : "choose a flank by --from and --to: ");
    if (status && status != RP_NO_RESULT) return status;
    cli_table(call, call->out);
    if (box) rp_table_note_number(call->out, "cell", cell, origin);
    rp_table_header(call->out, call->units,
                    "method, slope, theta_deg [deg], theta_se_deg [deg], n_cells, n_occupied, status");
    if (status) {
        const bool sparse = box && pile.n_flank[0] >= ANG_MIN_OCCUPIED;
        print_slopes(call, pile.n, pile.n_flank[0], NULL, sparse ? "sparse" : "no_pile");
    } else if (pile.n_flanks == 1) {
        print_slopes(call, pile.n, pile.n_flank[0], pile.flank[0], "ok");
        warn_negative(call, pile.flank[0]);
    } else {
        print_slopes(call, pile.n, pile.n_flank[0], pile.flank[0], "ok_left");
        print_slopes(call, pile.n, pile.n_flank[1], pile.flank[1], "ok_right");
        print_slopes(call, pile.n, pile.n_flank[0] + pile.n_flank[1], pile.mean, "ok_mean");
    }
    return status;
}

const cli_command cmd_angle_slope = {
    "angle slope",
    "slope of a table of grains by three methods",
    "FILE [options]",
    "Slope of a pile's surface h(x), positive where it falls to the right, by the methods of Lee & Herrmann "
    "1993: 1 first to last cell, 2 straight line, 3 parabola through the running sum of h. The standard "
    "error is propagated from the scatter of h about its straight line. FILE (- for standard input): one row "
    "a grain or a point of an outline, columns x y r (or X Y R) by name, otherwise the first three; r is "
    "needed for --height top only. For points in pixels, whose y is the row of a picture, give --y-axis "
    "down. The pile is found wherever it is, on any ground. A point that lies below another by more than 57 "
    "degrees is inside; n_cells points are left as the surface. A flank is what lies between the lowest and "
    "the highest tenth of the surface, n_occupied points. Two flanks have their rows, ok_left and ok_right, "
    "and as "
    "ok_mean the mean of their steepness. Otherwise: no_pile, and exit status 1. With --width the surface is "
    "that of a box, with its ground at y = 0: the highest grain of each cell. A cell is as wide as the mean "
    "diameter of the grains, or --cell. Fewer than 5 filled cells: no_pile; no more than half of the cells, "
    "none at x = 0, or grains below y = 0: sparse; both have exit status 1.",
    "repose angle slope pile.tsv --y-axis down",
    slope_params,
    .refuses = "Grains of several steps: choose one by --where step=N.\n"
               "--height top without radii; a radius that is not positive.\n"
               "Other than one or two flanks: choose by --from and --to.\n"
               "A valley, unless --y-axis tells which way is up.\n"
               "Without --width: --cell, --empty and --parabola; with it: --from and --to.",
    .on_table = slope_of_table};
